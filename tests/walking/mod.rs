//! A clip that walks with its feet held, changed as a user changes it, and where its joints are then.

use glam::DVec3;
use walkabout::{
    document::{Change, Document, PoseChange, Solved, open, parse_assignment},
    math::Rigid,
    skeleton::JointId,
};

/// Opens the built-in clip, with parameters set.
pub(crate) fn opened(sets: &[&str], shape: Option<&str>) -> Document {
    let mut document = Document::new(open(None).expect("the built-in clip"));
    set(&mut document, sets, shape);
    document
}

pub(crate) fn set(document: &mut Document, sets: &[&str], shape: Option<&str>) {
    let values = sets.iter().map(|text| parse_assignment(text).expect("an assignment")).collect();
    let shape = shape.map(|text| text.parse().expect("a shape"));
    document.apply(&Change::Set { values, shape }, false).expect("a change that can be made");
}

pub(crate) fn apply(document: &mut Document, change: Change) {
    document.apply(&change, false).expect("a change that can be made");
}

pub(crate) fn joint(solved: &Solved, name: &str) -> JointId {
    solved.clip.skeleton.find(name).expect("the built-in clip has it")
}

pub(crate) fn joints(solved: &Solved, names: &[&str]) -> Vec<JointId> {
    names.iter().map(|name| joint(solved, name)).collect()
}

pub(crate) fn world(solved: &Solved, frame: usize) -> Vec<Rigid> {
    let mut rigids = Vec::new();
    solved.edited.world_rigids(frame, &mut rigids);
    rigids
}

pub(crate) fn place(solved: &Solved, frame: usize, name: &str) -> DVec3 {
    world(solved, frame)[joint(solved, name).idx()].translation
}

pub(crate) fn turn(frame_idx: usize, joint: JointId, axis: DVec3, angle_rad: f64) -> Change {
    Change::Pose { layer_idx: 0, frame_idx, change: PoseChange::Turn { joint, axis, angle_rad } }
}

pub(crate) fn reach(frame_idx: usize, point: JointId, joints: Vec<JointId>, to: DVec3) -> Change {
    Change::Pose { layer_idx: 0, frame_idx, change: PoseChange::Reach { point: point.idx(), joints, to } }
}

/// The carrier goes on from where it is by some way, world.
pub(crate) fn carrier_moved(solved: &Solved, frame_idx: usize, by: DVec3) -> Change {
    let to = solved.carrier(frame_idx).translation + by;
    Change::Pose { layer_idx: 0, frame_idx, change: PoseChange::PlaceCarrier { to } }
}

/// The largest distance between what two documents show, over all joints and every tenth frame.
pub(crate) fn apart(a: &Solved, b: &Solved) -> f64 {
    assert_eq!(a.edited.n_frames(), b.edited.n_frames());
    let frames = (0..a.edited.n_frames()).step_by(10);
    let pairs = frames.flat_map(|frame| world(a, frame).into_iter().zip(world(b, frame)));
    pairs.map(|(a, b)| a.translation.distance(b.translation)).fold(0.0, f64::max)
}

/// Returns where a captured clip is; says so and returns none where no captured clips are.
pub(crate) fn captured(name: &str) -> Option<std::path::PathBuf> {
    let Some(clips) = std::env::var_os("WALKABOUT_CLIPS") else {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS is not set");
        eprintln!("SKIPPED: WALKABOUT_CLIPS is not set, nothing of {name} was moved");
        return None;
    };
    Some(std::path::PathBuf::from(clips).join(format!("real/{name}.bvh")))
}
