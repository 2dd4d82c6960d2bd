//! The scene: what is to be seen now, built from the document and the view state.
//!
//! The still part is made anew only when what it shows has changed, and then gets the next revision number; the
//! moving part is made for every frame.

use std::{collections::BTreeSet, sync::Arc};

use glam::DVec3;

use super::{
    body::{body, mark_selected},
    joints::Handle,
    panel::TABS,
    view::ViewState,
    views::{Window, views},
};
use crate::{
    document::{self, Document, Edits, Show, Solved},
    scene::{Curve, Footprint, Ground, Label, Mark, Now, Role, Scene, Still, Stroke},
    skeleton::Skeleton,
};

/// Points a drawn curve is sampled at.
const CURVE_POINTS: usize = 400;
/// Marks and trackers, body heights.
const POINT_RADIUS: f64 = 0.035;
const TRACKER_RADIUS: f64 = 0.06;
/// Marks of selected joints and of the one that keys move, body heights: thicker than any limb.
const JOINT_RADIUS: f64 = 0.042;
const ACTIVE_RADIUS: f64 = 0.05;
/// Marks on trails, body heights.
const TRAIL_RADIUS: f64 = 0.03;
/// Footprints that lie deeper in the ground, in body heights, are hidden by it.
const SUNK: f64 = 0.06;
/// Length of a footprint, body heights: about a person's.
const FOOT_LENGTH: f64 = 0.15;

/// The still part in use and what it was made from.
#[derive(Clone, Debug)]
pub(super) struct Stills {
    still: Arc<Still>,
    made_from: Option<MadeFrom>,
}

/// What the still part shows, apart from parameters, which are part of what is solved.
#[derive(Clone, Debug)]
struct MadeFrom {
    solved: Arc<Solved>,
    point_idx: usize,
    selected: BTreeSet<Handle>,
    area: Arc<[DVec3]>,
}

impl MadeFrom {
    fn new(solved: &Arc<Solved>, view: &ViewState) -> Self {
        Self {
            solved: Arc::clone(solved),
            point_idx: view.point_idx,
            selected: view.joints.selected.clone(),
            area: Arc::clone(&view.area.points),
        }
    }

    fn is_of(&self, solved: &Arc<Solved>, view: &ViewState) -> bool {
        draw_the_same(&self.solved, solved)
            && self.point_idx == view.point_idx
            && self.selected == view.joints.selected
            && Arc::ptr_eq(&self.area, &view.area.points)
    }
}

impl Default for Stills {
    fn default() -> Self {
        let still = Still {
            revision: 0,
            body_height: 1.0,
            bodies: Vec::new(),
            curves: Vec::new(),
            footprints: Vec::new(),
            marks: Vec::new(),
            labels: Vec::new(),
            ground: None,
        };
        Self { still: Arc::new(still), made_from: None }
    }
}

impl Stills {
    pub(super) fn still(&self) -> &Arc<Still> {
        &self.still
    }

    /// Makes the still part anew if what it shows has changed.
    pub(super) fn follow(&mut self, document: &Document, view: &ViewState) {
        let solved = document.solved();
        if !self.made_from.as_ref().is_some_and(|made| made.is_of(solved, view)) {
            self.still = Arc::new(still_scene(solved, view, self.still.revision + 1));
        }
        self.made_from = Some(MadeFrom::new(solved, view));
    }
}

/// Tells whether two results make the same still part, as they do when only cameras and views have changed between them.
fn draw_the_same(old: &Arc<Solved>, new: &Arc<Solved>) -> bool {
    // A change is of the views or of the rest, so the rest is compared only where it is likely to be equal.
    let seen_otherwise = || {
        let (old_view, view) = (&old.edits.view, &new.edits.view);
        old_view != view
            && old_view.show == view.show
            && *old.edits == Edits { view: old_view.clone(), ..(*new.edits).clone() }
    };
    // What only has been measured since looks the same.
    let same_stages = || {
        Arc::ptr_eq(&old.edits, &new.edits)
            && Arc::ptr_eq(&old.edited, &new.edited)
            && Arc::ptr_eq(&old.strains, &new.strains)
    };
    Arc::ptr_eq(old, new) || same_stages() || seen_otherwise()
}

/// Builds the part of the picture that stays while the clip plays.
fn still_scene(solved: &Solved, view: &ViewState, revision: u64) -> Still {
    let ViewState { point_idx, area, joints, .. } = view;
    let show = solved.edits.view.show;
    let height = solved.clip.facts.height.value;
    let up = solved.clip.facts.up.value;
    let controls: Vec<DVec3> = solved.control_points().into_iter().map(|p| up.to_world(p)).collect();
    let mut curves = Vec::new();
    let mut strains = Vec::new();
    let mut curve = |role, stroke, points: Vec<DVec3>| curves.push(Curve { role, stroke, points });
    if show.original_path {
        curve(Role::OriginalPath, Stroke::Dashed, solved.original_polyline(CURVE_POINTS));
    }
    if show.new_path {
        // Told apart without colour too: what asks too much is dashed.
        for (cause, points) in solved.new_path_pieces(CURVE_POINTS) {
            match cause {
                None => curve(Role::NewPath, Stroke::Solid, points),
                Some(cause) => {
                    let middle = points[points.len() / 2];
                    strains.push((middle, cause.word()));
                    curve(Role::Strain, Stroke::Dashed, points);
                }
            }
        }
    }
    if show.control_points {
        curve(Role::ControlPoint, Stroke::Dashed, controls.clone());
    }
    if show.traces {
        for trace in traces(solved) {
            curve(Role::Trace, Stroke::Solid, trace);
        }
    }
    let mark = |(idx, &at): (usize, &DVec3)| Mark {
        role: if idx == *point_idx { Role::SelectedControlPoint } else { Role::ControlPoint },
        at,
        radius: if idx == *point_idx { 1.5 * POINT_RADIUS * height } else { POINT_RADIUS * height },
    };
    let marks = if show.control_points { controls.iter().enumerate().map(mark).collect() } else { Vec::new() };
    let label = |(idx, &at): (usize, &DVec3)| Label {
        role: if idx == *point_idx { Role::SelectedControlPoint } else { Role::ControlPoint },
        at: at + DVec3::Y * 2.0 * POINT_RADIUS * height,
        text: (idx + 1).to_string(),
    };
    let mut labels: Vec<Label> =
        if show.control_points && show.labels { controls.iter().enumerate().map(label).collect() } else { Vec::new() };
    if show.labels {
        labels.extend(strains.into_iter().map(|(at, word)| Label { role: Role::Strain, at, text: word.to_owned() }));
    }
    let body = |role| body(&solved.clip, role, show.wireframe);
    let mut new_body = body(Role::NewSkeleton);
    mark_selected(&mut new_body, |id| joints.is_selected(Handle::Joint(id)));
    Still {
        revision,
        body_height: height,
        bodies: vec![body(Role::OriginalSkeleton), new_body, body(Role::NormalSkeleton)],
        curves,
        footprints: if show.footprints { footprints(solved) } else { Vec::new() },
        marks,
        labels,
        ground: show.ground.then(|| Ground {
            height: solved.clip.facts.floor,
            centre: area.centre,
            half_extent: 2.0 * area.half_extents.x.max(area.half_extents.z) + 2.0 * height,
            cell: cell(height),
        }),
    }
}

/// Where the feet stand.
fn footprints(solved: &Solved) -> Vec<Footprint> {
    let height = solved.clip.facts.height.value;
    let length = FOOT_LENGTH * height;
    let (show_ground, floor) = (solved.edits.view.show.ground, solved.clip.facts.floor);
    // A path that lies a little lower than the body walked takes its feet into the ground, and their prints out of sight.
    let seen = |place: DVec3| {
        let sunk = show_ground && (floor - SUNK * height..floor).contains(&place.y);
        if sunk { place.with_y(floor) } else { place }
    };
    let print = |print: document::Footprint| Footprint {
        role: if print.missed_by.is_some() { Role::MissedFootprint } else { Role::Footprint },
        foot: solved.feet.plants[print.foot_idx].leg.side,
        at: seen(print.place),
        heading_rad: print.heading_rad,
        normal: print.normal,
        length,
    };
    solved.footprints().into_iter().map(print).collect()
}

/// Grid cell: the power of ten, or twice or five times it, nearest below half a body height.
fn cell(height: f64) -> f64 {
    let half = 0.5 * height;
    let decade = 10f64.powf(half.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * decade).find(|&c| c <= half).unwrap_or(decade)
}

/// Points at the ends of limbs: end sites, and joints on which nothing hangs.
fn end_effectors(skeleton: &Skeleton) -> Vec<usize> {
    let mut is_end = vec![true; skeleton.n_points()];
    for parent in (0..skeleton.n_points()).filter_map(|point| skeleton.point_parent(point)) {
        is_end[parent] = false;
    }
    (0..skeleton.n_points()).filter(|&point| is_end[point]).collect()
}

/// Trails of the end effectors of the new actor through the whole clip.
fn traces(solved: &Solved) -> Vec<Vec<DVec3>> {
    let ends = end_effectors(&solved.clip.skeleton);
    let n_frames = solved.edited.n_frames();
    let stride = n_frames.div_ceil(4 * CURVE_POINTS).max(1);
    let mut trails = vec![Vec::new(); ends.len()];
    let mut points = Vec::new();
    for frame_idx in (0..n_frames).step_by(stride) {
        solved.edited.world_points(frame_idx, &mut points);
        for (trail, &end) in trails.iter_mut().zip(&ends) {
            trail.push(points[end]);
        }
    }
    trails
}

/// Fills in where both actors' points are.
fn poses(solved: &Solved, show: Show, frame_idx: usize, original: &mut Vec<DVec3>, edited: &mut Vec<DVec3>) {
    if show.original_skeleton {
        solved.clip.world_points(solved.source_frame(frame_idx), original);
    }
    if show.new_skeleton {
        solved.edited.world_points(frame_idx, edited);
    }
}

/// Fills in the points of the actor with all rotations zero, its carrier where the edited clip's is.
fn normal_skeleton(solved: &Solved, frame_idx: usize, points: &mut Vec<DVec3>) {
    solved.clip.unturned_points(solved.source_frame(frame_idx), points);
    let by = solved.carrier(frame_idx).translation - points[solved.clip.facts.carrier.value.idx()];
    points.iter_mut().for_each(|point| *point += by);
}

/// Builds the picture of this moment in a window.
pub(super) fn scene(document: &Document, view: &ViewState, window: Window, still: Arc<Still>) -> Scene {
    let solved = document.solved();
    let show = document.edits().view.show;
    let height = solved.clip.facts.height.value;
    let frame_idx = view.frame_idx;
    let (mut original, mut edited) = (Vec::new(), Vec::new());
    if let Some(file_frame) = view.rest_frame {
        // Before the motion begins both stand as the file has them.
        for (shown, points) in [(show.original_skeleton, &mut original), (show.new_skeleton, &mut edited)] {
            if shown {
                solved.clip.world_points_of_file(file_frame, points);
            }
        }
    } else {
        poses(solved, show, frame_idx, &mut original, &mut edited);
    }
    let mut marks = Vec::new();
    let mut tracker = |role, at| marks.push(Mark { role, at, radius: TRACKER_RADIUS * height });
    if show.original_tracker {
        tracker(Role::OriginalTracker, solved.original_frame(frame_idx).translation);
    }
    if show.new_tracker {
        tracker(Role::NewTracker, solved.new_frame(frame_idx).translation);
    }
    marks.extend(joint_marks(solved, view, &edited));
    if show.traces && view.rest_frame.is_none() {
        let mut points = Vec::new();
        solved.edited.world_points(frame_idx, &mut points);
        let ends = end_effectors(&solved.clip.skeleton).into_iter();
        marks.extend(ends.map(|end| Mark { role: Role::Trace, at: points[end], radius: TRAIL_RADIUS * height }));
    }
    let mut normal = Vec::new();
    if show.normal_skeleton {
        normal_skeleton(solved, frame_idx, &mut normal);
    }
    let mut labels = Vec::new();
    if show.labels {
        let names = [
            (Role::OriginalSkeleton, &original, "original"),
            (Role::NewSkeleton, &edited, "new"),
            (Role::NormalSkeleton, &normal, "normal"),
        ];
        for (role, points, text) in names {
            if let Some(top) = points.iter().copied().max_by(|a, b| a.y.total_cmp(&b.y)) {
                labels.push(Label { role, at: top + DVec3::Y * 0.08 * height, text: text.to_owned() });
            }
        }
    }
    Scene {
        still,
        now: Now {
            actors: vec![original, edited, normal],
            marks,
            labels,
            views: views(document, view, window),
            caption: caption(solved, view),
        },
    }
}

/// Returns marks at the selected joints of a body and, where a tab of theirs is in use, at the one that keys move.
fn joint_marks<'a>(solved: &'a Solved, view: &'a ViewState, points: &'a [DVec3]) -> impl Iterator<Item = Mark> + 'a {
    let facts = &solved.clip.facts;
    let active = TABS[view.tab_idx].is_of_joints().then_some(view.joints.active);
    let roles = [(Role::SelectedJoint, JOINT_RADIUS), (Role::ActiveJoint, ACTIVE_RADIUS)];
    let selected = view.joints.selected.iter().filter(move |&&handle| Some(handle) != active);
    let marked = selected.map(move |&handle| (handle, roles[0])).chain(active.map(|handle| (handle, roles[1])));
    marked.filter_map(move |(handle, (role, radius))| {
        let joint = match handle {
            Handle::Position => facts.carrier.value,
            Handle::Joint(id) => id,
        };
        Some(Mark { role, at: *points.get(joint.idx())?, radius: radius * facts.height.value })
    })
}

fn caption(solved: &Solved, view: &ViewState) -> String {
    // Frame numbers people see count what would be exported.
    let rest = solved.clip.rest_frames();
    format!(
        "{}  frame {} of {}  {:.2} s  {}",
        solved.source.name,
        view.rest_frame.unwrap_or(view.frame_idx + rest),
        solved.edited.n_frames() + rest - 1,
        view.frame_idx as f64 * solved.clip.frame_time_secs,
        match (view.playing, view.slow_motion) {
            (true, false) => "playing",
            (true, true) => "playing slowly",
            (false, _) => "paused",
        },
    )
}
