//! The user's plants beside the found ones.
//!
//! A project keeps only what the user changed: ranges of file frames, each with what the foot does there. An edited
//! range replaces every found plant that it overlaps, whole; found plants elsewhere stay and follow the thresholds. A
//! range in which the foot is said not to stand (`none`) is how a found plant is deleted.
//!
//! ```text
//! found       ▐███▌   ▐██████▌    ▐████▌
//! edited                ▐███▌     (none)
//! merged      ▐███▌     ▐███▌
//! ```

use serde::{Deserialize, Serialize};

use super::{FootPlants, Plant, PlantMode};
use crate::motion::Side;

/// What the user says about a foot over a range of frames (`[[plant]]` of a project).
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct PlantEdit {
    /// Side of the leg; of several legs of one side the first is meant.
    pub foot: Side,
    /// First file frame.
    pub first: usize,
    /// Last file frame.
    pub last: usize,
    /// What the foot does from `first` to `last`.
    #[serde(default)]
    pub mode: PlantEditMode,
}

/// What the user says a foot does over a range of frames.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlantEditMode {
    /// Stands, and is to be held.
    #[default]
    Hold,
    /// Stands, and is to be held without the slide it has.
    Clean,
    /// Slides, and is to be left alone.
    Slide,
    /// Does not stand: a found plant is deleted.
    None,
}

impl PlantEditMode {
    /// Returns the mode of the plant; none where there is to be no plant.
    pub fn plant(self) -> Option<PlantMode> {
        match self {
            Self::Hold => Some(PlantMode::Hold),
            Self::Clean => Some(PlantMode::Clean),
            Self::Slide => Some(PlantMode::Slide),
            Self::None => None,
        }
    }
}

impl From<PlantMode> for PlantEditMode {
    fn from(mode: PlantMode) -> Self {
        match mode {
            PlantMode::Hold => Self::Hold,
            PlantMode::Clean => Self::Clean,
            PlantMode::Slide => Self::Slide,
        }
    }
}

/// Where the clip's frames lie in the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct FileFrames {
    /// Leading rest frames.
    pub rest: usize,
    /// Frames of the clip, rest frames not counted; at least 1.
    pub n_frames: usize,
}

impl FileFrames {
    /// Returns a plant's first and last frame in the file.
    pub fn of(self, plant: &Plant) -> [usize; 2] {
        [plant.first + self.rest, plant.last + self.rest]
    }

    /// Returns the part of an edit's range that lies in the clip, in the clip's frames.
    fn within(self, edit: &PlantEdit) -> Option<Range> {
        let last = edit.last.checked_sub(self.rest)?.min(self.n_frames - 1);
        let first = edit.first.saturating_sub(self.rest);
        (edit.first <= edit.last && first <= last).then_some(Range { first, last })
    }
}

/// Frames of the clip, both ends included.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
struct Range {
    first: usize,
    last: usize,
}

impl Range {
    fn of(plant: &Plant) -> Self {
        Self { first: plant.first, last: plant.last }
    }

    fn overlaps(self, other: Self) -> bool {
        self.first <= other.last && other.first <= self.last
    }
}

/// Merges the user's edits into the found plants of all feet; edits that mean nothing here become warnings.
pub fn with_edits(
    mut found: Vec<FootPlants>,
    edits: &[PlantEdit],
    frames: FileFrames,
    warnings: &mut Vec<String>,
) -> Vec<FootPlants> {
    for side in [Side::Left, Side::Right] {
        let of_side: Vec<PlantEdit> = edits.iter().copied().filter(|edit| edit.foot == side).collect();
        let outside = of_side.iter().filter(|edit| frames.within(edit).is_none()).count();
        match found.iter_mut().find(|foot| foot.leg.side == side) {
            Some(foot) => foot.plants = merged(&foot.plants, &of_side, frames),
            None if of_side.is_empty() => {}
            None => warnings.push(format!("edited plants of a foot that the clip lacks: {}", of_side.len())),
        }
        if outside > 0 {
            warnings.push(format!("edited plants that lie outside the clip: {outside}"));
        }
    }
    found
}

/// Merges edits of one foot into its found plants.
///
/// Found plants that overlap an edited range are left out. Of edits that overlap each other the later in the list
/// counts. Where two plants would touch, the found one, else the later one, begins or ends a frame farther off.
pub fn merged(found: &[Plant], edits: &[PlantEdit], frames: FileFrames) -> Vec<Plant> {
    let mut counting: Vec<(Range, PlantEditMode)> = Vec::new();
    for edit in edits {
        if let Some(range) = frames.within(edit) {
            counting.retain(|(earlier, _)| !earlier.overlaps(range));
            counting.push((range, edit.mode));
        }
    }
    counting.sort_by_key(|(range, _)| range.first);

    let edited = (counting.iter())
        .filter_map(|&(Range { first, last }, mode)| mode.plant().map(|mode| (Plant { first, last, mode }, true)));
    // Both lists are in order of time, so one pass finds the plants that keep clear of all edits.
    let mut at = 0;
    let kept = found.iter().filter(|plant| {
        while counting.get(at).is_some_and(|(range, _)| range.last < plant.first) {
            at += 1;
        }
        counting.get(at).is_none_or(|(range, _)| range.first > plant.last)
    });
    let mut all: Vec<(Plant, bool)> = kept.map(|&plant| (plant, false)).chain(edited).collect();
    all.sort_by_key(|(plant, _)| plant.first);
    parted(&all)
}

/// Leaves a free frame between plants; those told as `true` are the user's and give way last.
fn parted(plants: &[(Plant, bool)]) -> Vec<Plant> {
    let mut parted: Vec<(Plant, bool)> = Vec::with_capacity(plants.len());
    for &(mut plant, by_user) in plants {
        if let Some((before, before_by_user)) = parted.last_mut()
            && before.last + 1 >= plant.first
        {
            let before_gives_way = by_user && !*before_by_user;
            match before_gives_way {
                true if before.first < before.last => before.last -= 1,
                true => drop(parted.pop()),
                false => plant.first += 1,
            }
        }
        if plant.first <= plant.last {
            parted.push((plant, by_user));
        }
    }
    parted.into_iter().map(|(plant, _)| plant).collect()
}

/// Returns the edits after which the plants of `foot` are `wanted`: `merged(found, …)` gives `wanted`.
///
/// Edits of the other foot stay as they are. Plants that are as found are not recorded, unless they were before; what
/// the user deleted stays deleted, also where nothing is found at present.
pub fn recorded(
    edits: &[PlantEdit],
    foot: Side,
    found: &[Plant],
    wanted: &[Plant],
    frames: FileFrames,
) -> Vec<PlantEdit> {
    let edit_of =
        |range: Range, mode| PlantEdit { foot, first: range.first + frames.rest, last: range.last + frames.rest, mode };
    let clear_of_wanted = |range: Range| !wanted.iter().any(|plant| Range::of(plant).overlaps(range));
    let (mine, mut next): (Vec<PlantEdit>, Vec<PlantEdit>) = edits.iter().partition(|edit| edit.foot == foot);

    let plants: Vec<PlantEdit> = (wanted.iter())
        .map(|plant| (plant, edit_of(Range::of(plant), plant.mode.into())))
        .filter(|(plant, edit)| mine.contains(edit) || !found.contains(plant))
        .map(|(_, edit)| edit)
        .collect();
    let deleted_before = mine.iter().filter(|edit| {
        let stays = frames.within(edit).is_none_or(clear_of_wanted);
        edit.mode == PlantEditMode::None && stays
    });
    next.extend(deleted_before.copied());
    next.extend(&plants);
    for plant in found.iter().filter(|plant| !wanted.contains(plant)) {
        let replaced = (next.iter())
            .filter(|edit| edit.foot == foot)
            .filter_map(|edit| frames.within(edit))
            .any(|range| range.overlaps(Range::of(plant)));
        if !replaced {
            next.push(edit_of(Range::of(plant), PlantEditMode::None));
        }
    }
    next.sort_by_key(|edit| (edit.foot, edit.first, edit.last));
    next
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::{super::PlantChange, *};

    const FRAMES: FileFrames = FileFrames { rest: 1, n_frames: 100 };

    fn edit(first: usize, last: usize, mode: PlantEditMode) -> PlantEdit {
        PlantEdit { foot: Side::Left, first, last, mode }
    }

    /// Merges edits, in file frames of a clip with one rest frame, into found plants 10–20, 30–40 and 60–80.
    #[track_caller]
    fn check(edits: &[PlantEdit], wanted: &[(usize, usize)]) {
        let found = [Plant::new(10, 20), Plant::new(30, 40), Plant::new(60, 80)];
        let ranges: Vec<_> = merged(&found, edits, FRAMES).iter().map(|p| (p.first, p.last)).collect();
        assert_eq!(ranges, wanted, "{edits:?}");
    }

    #[test]
    fn edited_plants_replace_what_they_overlap() {
        use PlantEditMode::{Clean, Hold, None, Slide};
        check(&[], &[(10, 20), (30, 40), (60, 80)]);
        check(&[edit(36, 36, Hold)], &[(10, 20), (35, 35), (60, 80)]);
        check(&[edit(16, 71, Clean)], &[(15, 70)]);
        check(&[edit(46, 51, Slide)], &[(10, 20), (30, 40), (45, 50), (60, 80)]);
        check(&[edit(35, 36, None)], &[(10, 20), (60, 80)]);
    }

    #[test]
    fn edits_are_kept_within_the_clip_and_apart() {
        use PlantEditMode::Hold;
        check(&[edit(0, 6, Hold), edit(91, 900, Hold)], &[(0, 5), (10, 20), (30, 40), (60, 80), (90, 99)]);
        check(&[edit(0, 0, Hold), edit(101, 110, Hold), edit(50, 48, Hold)], &[(10, 20), (30, 40), (60, 80)]);
        check(&[edit(22, 26, Hold)], &[(10, 19), (21, 25), (30, 40), (60, 80)]);
        check(&[edit(24, 30, Hold)], &[(10, 20), (23, 29), (31, 40), (60, 80)]);
        check(&[edit(46, 50, Hold), edit(51, 55, Hold)], &[(10, 20), (30, 40), (45, 49), (51, 54), (60, 80)]);
        check(&[edit(46, 50, Hold), edit(48, 55, Hold)], &[(10, 20), (30, 40), (47, 54), (60, 80)]);
    }

    #[test]
    fn edits_of_feet_and_frames_that_are_not_there_are_told() {
        let mut warnings = Vec::new();
        let edits = [edit(200, 300, PlantEditMode::Hold)];
        assert!(with_edits(Vec::new(), &edits, FRAMES, &mut warnings).is_empty());
        assert_eq!(
            warnings,
            ["edited plants of a foot that the clip lacks: 1", "edited plants that lie outside the clip: 1"]
        );
    }

    #[test]
    fn a_project_spells_edits_as_designed() {
        let text = "foot = \"left\"\nfirst = 3\nlast = 9\nmode = \"clean\"\n";
        let read: PlantEdit = toml::from_str(text).expect("an edit");
        assert_eq!(read, edit(3, 9, PlantEditMode::Clean));
        assert_eq!(toml::to_string(&read).expect("its text"), text);
        assert!(toml::from_str::<PlantEdit>("foot = \"left\"\nfirst = 3\nlast = 9\nmod = \"hold\"").is_err());
    }

    fn changes() -> impl Strategy<Value = PlantChange> {
        let mode = prop_oneof![Just(PlantMode::Hold), Just(PlantMode::Clean), Just(PlantMode::Slide)];
        prop_oneof![
            (0..5usize, -30..30isize).prop_map(|(plant, by)| PlantChange::MoveFirst { plant, by }),
            (0..5usize, -30..30isize).prop_map(|(plant, by)| PlantChange::MoveLast { plant, by }),
            (0..100usize).prop_map(|frame| PlantChange::Split { frame }),
            (0..5usize).prop_map(|plant| PlantChange::Join { plant }),
            (0..5usize).prop_map(|plant| PlantChange::Delete { plant }),
            (0..100usize, 0..20usize).prop_map(|(first, n)| PlantChange::Add { first, last: first + n }),
            (0..5usize, mode).prop_map(|(plant, mode)| PlantChange::SetMode { plant, mode }),
        ]
    }

    fn apart(plants: &[Plant]) -> bool {
        plants.windows(2).all(|pair| pair[0].last + 1 < pair[1].first)
            && plants.iter().all(|p| p.first <= p.last && p.last < FRAMES.n_frames)
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// However the user got there, what is recorded gives the same plants again, also from other found ones.
        #[test]
        fn what_is_recorded_is_what_was_wanted(changes in prop::collection::vec(changes(), 1..12), other_last in 20..28usize) {
            let found = [Plant::new(10, 20), Plant::new(30, 40), Plant::new(60, 80)];
            let others = [PlantEdit { foot: Side::Right, ..edit(3, 4, PlantEditMode::Hold) }];
            let mut edits = others.to_vec();
            let mut plants = found.to_vec();
            for change in changes {
                if let Some(changed) = change.apply(&plants, FRAMES.n_frames) {
                    edits = recorded(&edits, Side::Left, &found, &changed, FRAMES);
                    plants = changed;
                }
                let mine: Vec<_> = edits.iter().copied().filter(|e| e.foot == Side::Left).collect();
                prop_assert_eq!(&merged(&found, &mine, FRAMES), &plants);
                prop_assert!(apart(&plants));
                prop_assert!(edits.contains(&others[0]));

                let found_otherwise = [Plant::new(9, other_last), Plant::new(58, 59), Plant::new(61, 79)];
                prop_assert!(apart(&merged(&found_otherwise, &mine, FRAMES)));
            }
        }
    }
}
