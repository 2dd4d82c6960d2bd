//! The document: a source, the user's edits with their history, and what follows from them.
//!
//! A [`Change`] makes the next [`Edits`], [`solve()`] makes [`Solved`] of them; nothing else does. [`PARAMETERS`] is
//! the single source of names for panels, help, `--set` and project files.

mod change;
mod cloud;
mod edits;
mod entries;
mod feet;
mod files;
mod footprint;
mod history;
mod holding;
mod layers;
mod parameter;
mod piece;
mod plants;
mod pose_keys;
mod posed;
mod posing;
mod probe;
mod project;
mod reaching;
mod search;
mod solve;
mod solved;
mod source;
mod strain;
mod table;
mod table_pictures;
mod value;
mod walked;

use std::{collections::VecDeque, path::Path, path::PathBuf, sync::Arc};

pub use crate::path::Cycling;
use crate::sync::Hurry;
pub use change::{Change, ChangeError};
pub use edits::{
    Axes, CameraEdits, ClipEdits, Edits, HeadingEdits, LoopEdits, OneViewEdits, OriginalEdits, PathEdits, PlantsEdits,
    PoseEdits, ProjectionKind, ResidualEdits, Show, TimingEdits, ViewEdits, WindowEdits,
};
pub use feet::{Feet, FoundFeet, NO_LEGS};
pub use files::{EXTENSION, OpenError, Opened, open, write_file};
pub use footprint::{Footprint, SourcePrint};
pub use history::History;
pub use holding::Holding;
pub use layers::{KeyChange, LayerChange, LayerRefusal};
pub use parameter::{Kind, MAX_POINTS, NoJoint, Parameter, SetError, Step, parse_assignment, show_value};
use piece::Follows;
pub use plants::PlantRefusal;
pub use posed::{Base, Cleared, Posed};
pub use posing::PoseChange;
pub use project::{FORMAT, Problem, Project, ProjectError};
use solve::draft;
pub use solve::{solve, solve_live};
pub use solved::{ShownPlant, Solved, Source};
pub use source::{BUILT_IN, built_in};
pub use strain::{Cause, Strain};
pub use table::{PARAMETERS, parameter};
pub use walked::{Loops, Repeat, Walked};

/// So many solves are remembered of revisions that were left: enough to go to and fro.
const REMEMBERED: usize = 2;

/// A source being edited: its history and its newest result.
#[derive(Clone, Debug)]
pub struct Document {
    history: History,
    solved: Arc<Solved>,
    /// Whether what changes is shown before all of it is measured.
    drafts: bool,
    /// The change of a pose that feet follow near its frame alone so far, or whose target was not searched for yet.
    unsettled: Option<Change>,
    /// Raised by whoever cannot wait for the rest of the clip.
    hurry: Hurry,
    /// What was solved at the revisions left last, newest last: there undo and redo find it.
    left: VecDeque<Arc<Solved>>,
    /// The edits as last saved or opened.
    saved: Arc<Edits>,
    project: Option<PathBuf>,
}

impl Document {
    /// Begins editing what was opened.
    pub fn new(opened: Opened) -> Self {
        let history = History::new(opened.edits);
        let edits = Arc::clone(history.edits());
        let solved = Arc::new(solve(&opened.source, &edits, None));
        Self {
            history,
            solved,
            drafts: false,
            unsettled: None,
            hurry: Hurry::default(),
            left: VecDeque::new(),
            saved: edits,
            project: opened.project,
        }
    }

    /// Returns the edits in use.
    pub fn edits(&self) -> &Arc<Edits> {
        self.history.edits()
    }

    /// Returns what follows from the edits in use. After [`Document::show_drafts`] its numbers may be those of the edits
    /// before; see [`Solved::is_measured`].
    pub fn solved(&self) -> &Arc<Solved> {
        &self.solved
    }

    /// From now on a change is there to be shown before all of it is measured: layers alone before anything is, all else
    /// before what the feet do not tell. Of a pose whose feet are held even they follow only nearby, and a search for it
    /// is cut short. [`Document::measure`] does the rest, and so does what needs it. For whoever shows documents to a
    /// person and has time between the keys; nobody else sees a number too old.
    pub fn show_drafts(&mut self) {
        self.drafts = true;
    }

    /// Has all of the clip follow the edits and measures it; false when that is done already, or was given up in a hurry.
    pub fn measure(&mut self) -> bool {
        self.settle_as_far(Follows::Everywhere(&self.hurry.clone()));
        if !self.is_settled() {
            return false;
        }
        let is_due = !self.solved.is_measured();
        if is_due {
            self.solved = Arc::new(solve(&self.solved.source, self.history.edits(), Some(&self.solved)));
        }
        is_due
    }

    /// Has all of the clip follow a change of a pose; what that puts elsewhere than it was wanted is put there, as part of
    /// the same step, if that takes no long search. For whoever is about to ask where something is, to go on from there.
    /// Unless that is with another change, what is missing is searched for by the next [`Document::measure`].
    pub fn settle(&mut self) {
        self.settle_as_far(Follows::Briefly);
    }

    /// Returns what gives up a [`Document::measure`] under way where it is raised, on whatever thread: all stays as it was
    /// and can be measured another time. Whoever measures lowers it before.
    pub fn hurry(&self) -> Hurry {
        self.hurry.clone()
    }

    /// Tells whether all of the clip follows a change of a pose, and what it wants was searched for.
    pub fn is_settled(&self) -> bool {
        self.solved.is_whole() && self.unsettled.is_none()
    }

    fn settle_as_far(&mut self, follows: Follows<'_>) {
        if self.is_settled() || (self.solved.is_whole() && follows.is_brief()) {
            return;
        }
        let mut settled = draft(self.edits(), &self.solved);
        if let Some(change) = &self.unsettled
            && let Ok(change::Next { edits, draft: Some(draft), .. }) = change::next(&settled, change, follows)
        {
            if follows.is_given_up() {
                return;
            }
            self.history.push(edits, true, change.to_string());
            settled = draft;
        }
        if !follows.is_brief() {
            self.unsettled = None;
        }
        self.take(Solved { edits: Arc::clone(self.edits()), ..settled });
    }

    /// Returns how many steps can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        self.history.depth()
    }

    /// Returns what the step was that undo takes back, for people.
    pub fn undoable(&self) -> Option<&str> {
        self.history.undoable()
    }

    /// Returns what the step was that redo makes again, for people.
    pub fn redoable(&self) -> Option<&str> {
        self.history.redoable()
    }

    /// Returns the project file, if there is one yet.
    pub fn project(&self) -> Option<&Path> {
        self.project.as_deref()
    }

    /// Tells whether there are edits that no project file has and that matter: what is looked at, from where and how
    /// fast is saved with them, but is no work to lose.
    pub fn is_modified(&self) -> bool {
        let now = self.edits();
        **now != *self.saved && now.work() != self.saved.work()
    }

    /// Makes a change and solves; with `joins` it is one step with the one before. Returns warnings of the change.
    ///
    /// # Errors
    ///
    /// When the change cannot be made; then nothing has changed.
    pub fn apply(&mut self, change: &Change, joins: bool) -> Result<Vec<String>, ChangeError> {
        self.settle_before(change, joins);
        let solved = Arc::clone(&self.solved);
        self.apply_to(&solved, change, joins)
    }

    /// Makes a change of an earlier state of this document, in place of what was done since: a drag begins each of its
    /// steps where it began, so that where it ends does not depend on the way.
    ///
    /// # Errors
    ///
    /// When the change cannot be made; then nothing has changed.
    pub fn apply_to(&mut self, from: &Solved, change: &Change, joins: bool) -> Result<Vec<String>, ChangeError> {
        self.settle_before(change, joins);
        let at_leisure = Hurry::default();
        let follows = if self.drafts { Follows::Nearby } else { Follows::Everywhere(&at_leisure) };
        let change::Next { edits, warnings, draft } = change::next(from, change, follows)?;
        self.unsettled = None;
        let depth = self.depth();
        match change {
            Change::ResetView => self.history.push_view(edits, change.to_string()),
            _ => self.history.push(edits, joins, change.to_string()),
        }
        if self.depth() != depth {
            self.leave();
        }
        match draft.filter(|draft| draft.edits == *self.edits()) {
            Some(draft) => {
                let is_place = matches!(change, Change::Pose { change, .. } if change.is_a_place());
                self.unsettled = (is_place && !draft.is_whole()).then(|| change.clone());
                self.take(Solved { edits: Arc::clone(self.edits()), ..draft });
            }
            None => self.resolve(),
        }
        Ok(warnings)
    }

    /// Settles what is not, unless a change goes on with it: every step that can be undone to is settled.
    fn settle_before(&mut self, change: &Change, joins: bool) {
        if !joins || !matches!(change, Change::Pose { .. }) {
            self.settle();
        }
    }

    /// Goes back one step; false at the first.
    pub fn undo(&mut self) -> bool {
        self.settle();
        self.unsettled = None;
        let moved = self.history.undo();
        self.revisit();
        moved
    }

    /// Goes forward one step; false at the last.
    pub fn redo(&mut self) -> bool {
        self.settle();
        self.unsettled = None;
        let moved = self.history.redo();
        self.revisit();
        moved
    }

    /// Saves the project to a file, which becomes this document's.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn save(&mut self, file: &Path) -> Result<(), OpenError> {
        self.settle_as_far(Follows::Everywhere(&Hurry::default()));
        files::save(&self.as_project(file), file)?;
        self.saved = Arc::clone(self.edits());
        self.project = Some(file.to_owned());
        Ok(())
    }

    /// Saves unsaved edits to a new file beside the project or the clip and returns its name; none when all is saved.
    ///
    /// # Errors
    ///
    /// When the folder cannot be written.
    pub fn rescue(&self) -> Result<Option<PathBuf>, OpenError> {
        if !self.is_modified() {
            return Ok(None);
        }
        let own = self.project.as_deref().or(self.solved.source.file.as_deref()).unwrap_or(Path::new("walk.bvh"));
        let names = (1..).map(|n| own.with_extension(format!("rescued-{n}.{EXTENSION}")));
        let file = names.into_iter().find(|name| !name.exists()).expect("numbers do not end");
        files::save(&self.as_project(&file), &file)?;
        Ok(Some(file))
    }

    fn as_project(&self, file: &Path) -> Project {
        let source = &self.solved.source;
        Project {
            clip_file: source.file.as_ref().map(|clip| project::clip_reference(file, clip)),
            blake3: source.file.as_ref().map(|_| source.blake3()),
            edits: (**self.edits()).clone(),
        }
    }

    /// Writes the edited clip to a BVH file, with what interpolation keys replace or, `interpolated`, as it is played.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn export(&mut self, file: &Path, interpolated: bool) -> Result<(), OpenError> {
        self.settle_as_far(Follows::Everywhere(&Hurry::default()));
        let solved = &self.solved;
        write_file(file, &if interpolated { solved.to_bvh_interpolated() } else { solved.to_bvh() })
    }

    /// Remembers what is solved when another revision is gone to.
    fn leave(&mut self) {
        if self.left.len() == REMEMBERED {
            self.left.pop_front();
        }
        self.left.push_back(Arc::clone(&self.solved));
    }

    /// Solves for a revision that may have been left a moment ago.
    fn revisit(&mut self) {
        if Arc::ptr_eq(&self.solved.edits, self.history.edits()) {
            return;
        }
        let work = self.edits().work();
        let known = self.left.iter().rev().find(|left| left.is_measured() && left.edits.work() == work).map(Arc::clone);
        self.leave();
        match known {
            Some(known) => self.solved = Arc::new(solve_live(self.edits(), &known)),
            None => self.resolve(),
        }
    }

    fn resolve(&mut self) {
        let edits = self.history.edits();
        if Arc::ptr_eq(&self.solved.edits, edits) {
            return;
        }
        let (last, was) = (&self.solved, &self.solved.edits);
        // Without feet the score is of the whole body.
        let may_wait = self.drafts && !last.feet.plants.is_empty() && edits.clip == was.clip;
        if self.drafts && edits.differ_in_layers(was) {
            self.take(draft(edits, last));
        } else if may_wait {
            self.solved = Arc::new(solve_live(edits, last));
        } else {
            self.solved = Arc::new(solve(&last.source, edits, Some(last)));
        }
    }

    /// Takes a draft of the edits in use. Until it is measured it has the numbers measured last, also when it was made of an
    /// earlier solve, as every step of a drag is.
    fn take(&mut self, draft: Solved) {
        let last = &self.solved;
        self.solved = Arc::new(match Arc::ptr_eq(&draft.feet, &last.feet) {
            true => {
                Solved { measures: Arc::clone(&last.measures), foot_numbers: Arc::clone(&last.foot_numbers), ..draft }
            }
            false => draft,
        });
        if !self.drafts {
            self.measure();
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn unsaved_edits_are_rescued_beside_the_project_and_never_over_a_file() {
        let folder = tempfile::tempdir().expect("a folder");
        let mut document = Document::new(open(None).expect("the built-in clip"));
        document.save(&folder.path().join("walk.toml")).expect("saved");
        assert_eq!(document.rescue(), Ok(None));
        document.apply(&Change::InsertPoint { after_idx: 0 }, false).expect("a point");
        for n in 1..3 {
            let file = folder.path().join(format!("walk.rescued-{n}.toml"));
            assert_eq!(document.rescue(), Ok(Some(file.clone())));
            assert_eq!(open(Some(&file)).expect("opens").edits, **document.edits());
        }
    }

    #[test]
    fn a_path_keeps_its_shape_when_its_degree_or_points_change() {
        let mut document = Document::new(open(None).expect("the built-in clip"));
        let set = |values: &[(&str, i64)], shape: Option<&str>| Change::Set {
            values: values.iter().map(|(name, v)| ((*name).to_owned(), toml::Value::Integer(*v))).collect(),
            shape: shape.map(|s| s.parse().expect("a shape")),
        };
        document.apply(&set(&[], Some("s")), false).expect("a shape");
        let before = document.solved().new_path_polyline(50);
        let height = document.solved().clip.facts.height.value;
        for values in [&[("path.points", 24)][..], &[("path.degree", 5)], &[("path.points", 30), ("path.degree", 2)]] {
            document.apply(&set(values, None), false).expect("a refit");
            let after = document.solved().new_path_polyline(50);
            let off = before.iter().zip(&after).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(off < 0.05 * height, "{values:?}: off by {off}");
        }
        let warnings = document.apply(&set(&[("path.points", 3), ("path.degree", 9)], None), false).expect("raised");
        assert_eq!(warnings, ["path.points raised to 10, which path.degree 9 needs"]);
        assert_eq!(document.solved().control_points().len(), 10);
    }

    /// Everything that a user or a script can read of a solve as numbers.
    fn told(solved: &Solved) -> String {
        let Solved { measures, foot_numbers, strains, warnings, .. } = solved;
        format!(
            "{measures:?} {foot_numbers:?} {strains:?} {warnings:?} {:?}",
            solved.missed_plants().collect::<Vec<_>>()
        )
    }

    /// The built-in walk on an eight, with its feet held.
    fn walking() -> Document {
        let mut document = Document::new(open(None).expect("the built-in clip"));
        let eight = Change::Set { values: Vec::new(), shape: Some("eight".parse().expect("a shape")) };
        document.apply(&eight, false).expect("a shape");
        document
    }

    /// Changes of poses, keys and layers of every kind, each so large that the walk's numbers show it.
    fn changes(solved: &Solved) -> Vec<Change> {
        let (skeleton, height) = (&solved.clip.skeleton, solved.clip.facts.height.value);
        let joint = |name: &str| skeleton.find(name).expect("a joint of the built-in walk");
        let pose = |change| Change::Pose { layer_idx: 0, frame_idx: 90, change };
        let mut world = Vec::new();
        solved.edited.world_rigids(90, &mut world);
        let reach = |name: &str, by: glam::DVec3| {
            let point = joint(name).idx();
            PoseChange::Reach { point, joints: skeleton.ids().collect(), to: world[point].translation + by * height }
        };
        vec![
            pose(PoseChange::Turn { joint: joint("LeftHip"), axis: glam::DVec3::X, angle_rad: 0.4 }),
            pose(reach("LeftWrist", glam::DVec3::new(0.1, 0.05, 0.1))),
            pose(reach("RightAnkle", glam::DVec3::new(0.02, 0.05, 0.04))),
            pose(PoseChange::PlaceCarrier { to: solved.carrier(90).translation - glam::DVec3::Y * 0.3 * height }),
            Change::Layer(LayerChange::Weigh { layer_idx: 0, weight: 0.5 }),
            Change::Layer(LayerChange::Switch { layer_idx: 0, on: false }),
        ]
    }

    #[test]
    fn only_who_asks_for_drafts_sees_one_and_measuring_makes_it_what_others_see() {
        let (mut plain, mut drafting) = (walking(), walking());
        drafting.show_drafts();
        let fresh = |document: &Document| solve(&document.solved().source, document.edits(), None);
        // Whether the numbers are those of the edits; the poses are, unless feet follow nearby alone.
        let same = |document: &Document| {
            let (a, b) = (fresh(document), document.solved());
            if b.is_whole() {
                assert!(a.to_bvh() == b.to_bvh(), "a draft's poses are the poses");
                assert_eq!(format!("{:?}", a.strains), format!("{:?}", b.strains));
            }
            told(&a) == told(b)
        };
        let (mut n_stale, mut n_whole) = (0, 0);
        for change in changes(plain.solved()) {
            plain.apply(&change, false).expect("a change");
            assert!(plain.solved().is_measured() && same(&plain), "{change:?}");
            drafting.apply(&change, false).expect("a change");
            assert!(!drafting.solved().is_measured(), "{change:?}");
            n_stale += usize::from(!same(&drafting));
            n_whole += usize::from(drafting.solved().is_whole());
        }
        assert!(n_stale >= 4, "the numbers of drafts are old ones, or this test shows nothing");
        assert_eq!(n_whole, 2, "feet follow a layer at once");
        assert!(drafting.measure() && !drafting.measure());
        assert!(drafting.solved().is_measured() && same(&drafting), "nothing is left of the drafts on the way");

        // Whatever else is changed has the numbers of its feet at once, a draft before it or not.
        assert!(drafting.undo());
        assert!(!drafting.solved().has_feet_measured());
        let moved = Change::PlacePoint { point_idx: 2, to: glam::DVec3::new(120.0, 80.0, 60.0) };
        let clean = Change::Set { values: vec![("plants.clean".to_owned(), true.into())], shape: None };
        for change in [moved, clean] {
            let measures = Arc::clone(&drafting.solved().measures);
            let feet = |solved: &Solved| format!("{:?}", solved.foot_numbers);
            let before = feet(drafting.solved());
            drafting.apply(&change, false).expect("a change");
            let now = drafting.solved();
            assert!(now.has_feet_measured() && !now.is_measured(), "{change:?}");
            assert!(Arc::ptr_eq(&now.measures, &measures), "the body waits");
            assert!(feet(now) == feet(&fresh(&drafting)) && feet(now) != before, "{change:?}");
            assert!(!same(&drafting), "{change:?}");
        }
        assert!(drafting.measure() && same(&drafting));

        // Another reading of the clip is another body.
        let values = vec![("clip.up".to_owned(), toml::Value::String("z".to_owned()))];
        drafting.apply(&Change::Set { values, shape: None }, false).expect("a setting");
        assert!(drafting.solved().is_measured());
    }

    #[test]
    fn feet_are_measured_live_where_the_joints_have_them() {
        let document = walking();
        let base = document.solved();
        let changed = |change: &dyn Fn(&mut Edits)| {
            let mut edits = (**document.edits()).clone();
            change(&mut edits);
            Arc::new(edits)
        };
        let points = |by: f64| base.control_points().iter().map(|p| *p * by).collect::<Vec<_>>();
        let n_frames = base.clip.n_frames();
        let mut seen = Vec::new();
        for (name, edits) in [
            ("shorter", changed(&|e| e.path.control_points = Some(points(0.7)))),
            ("longer", changed(&|e| e.path.control_points = Some(points(1.5)))),
            ("clean", changed(&|e| e.plants.clean = true)),
            ("not held", changed(&|e| e.plants.hold = false)),
            (
                "again and again",
                changed(&|e| {
                    e.path.control_points = Some(points(2.5));
                    e.timing.cycling = Cycling::Plain;
                }),
            ),
            (
                "joined",
                changed(&|e| {
                    e.path.control_points = Some(points(2.5));
                    e.timing.cycling = Cycling::Blended;
                }),
            ),
        ] {
            let live = solve_live(&edits, base);
            let all = solve(&base.source, &edits, Some(&live));
            assert!(!Arc::ptr_eq(&live.foot_numbers, &all.foot_numbers), "{name}: measured again");
            seen.push(live.edited.n_frames().cmp(&n_frames));
            let numbers = |solved: &Solved| -> Vec<f64> {
                let pairs = |n: &crate::measure::FootNumbers| {
                    [n.planted_speed, n.slip_p90, n.clearance].map(|p| p.expect("measured"))
                };
                solved.foot_numbers.iter().flat_map(pairs).flat_map(|p| [p.source, p.edited]).collect()
            };
            let (live, all) = (numbers(&live), numbers(&all));
            assert!(
                live.len() == 12 && live.iter().zip(&all).all(|(a, b)| (a - b).abs() < 1e-9),
                "{name}: {live:?} {all:?}"
            );
        }
        assert!(seen.contains(&std::cmp::Ordering::Less) && seen.contains(&std::cmp::Ordering::Greater));
    }

    #[test]
    fn a_step_of_a_drag_has_the_numbers_measured_last() {
        let mut document = walking();
        document.show_drafts();
        let grabbed = Arc::clone(document.solved());
        let [first, second] = [-0.1, -0.2].map(|y| Change::Pose {
            layer_idx: 0,
            frame_idx: 90,
            change: PoseChange::PlaceCarrier {
                to: grabbed.carrier(90).translation + glam::DVec3::Y * y * grabbed.clip.facts.height.value,
            },
        });
        document.apply_to(&grabbed, &first, false).expect("a step");
        assert!(document.measure());
        let measured = Arc::clone(document.solved());
        assert_ne!(format!("{:?}", measured.measures), format!("{:?}", grabbed.measures));
        document.apply_to(&grabbed, &second, true).expect("another step");
        let now = document.solved();
        assert!(!now.is_measured() && Arc::ptr_eq(&now.measures, &measured.measures));
        assert!(Arc::ptr_eq(&now.foot_numbers, &measured.foot_numbers));
    }

    #[test]
    fn a_shape_takes_the_points_it_needs_and_says_so_only_to_who_asked_for_fewer() {
        let mut document = Document::new(open(None).expect("the built-in clip"));
        let mut shape = |values: &[(&str, i64)]| {
            let values = values.iter().map(|(name, v)| ((*name).to_owned(), toml::Value::Integer(*v))).collect();
            document.apply(&Change::Set { values, shape: Some("circle".parse().expect("a shape")) }, false)
        };
        assert_eq!(shape(&[]), Ok(Vec::new()));
        let raised = "path.points raised to 9, which the shape needs".to_owned();
        assert_eq!(shape(&[("path.points", 5)]), Ok(vec![raised]));
        assert_eq!(shape(&[("path.points", 12)]), Ok(Vec::new()));
    }

    #[test]
    fn a_carrier_is_one_of_the_clips_joints() {
        let mut document = Document::new(open(None).expect("the built-in clip"));
        let mut carrier = |name: &str| {
            let values = vec![("clip.carrier".to_owned(), toml::Value::String(name.to_owned()))];
            document.apply(&Change::Set { values, shape: None }, false).map_err(|error| error.to_string())
        };
        let words = carrier("Hisp").expect_err("no joint");
        let expected =
            "`clip.carrier` takes a joint's name or auto, found `Hisp`; did you mean `Hips`? (the joints are Hips, ";
        assert!(words.starts_with(expected) && words.contains(", Chest, "), "{words}");
        assert_eq!(carrier("Hips"), Ok(Vec::new()));
        assert_eq!(carrier("auto"), Ok(Vec::new()));
    }
}
