//! Bodies to draw: which points of a skeleton are joined, and how thick.

use crate::{
    motion::Clip,
    scene::{Body, Limb, Role},
    skeleton::JointId,
};

/// Radius of a limb, as a share of its length and within bounds of the body height.
const RADIUS_SHARE: f64 = 0.16;
const RADIUS_MIN: f64 = 0.005;
const RADIUS_MAX: f64 = 0.038;
/// Limbs shorter than this share of the body height are helper joints and not drawn.
const SHORTEST: f64 = 0.002;

/// Returns the body of a clip's skeleton: a limb from each point to its parent.
///
/// What lies above the carrier does not move with the body and is not drawn.
pub(super) fn body(clip: &Clip, role: Role, wireframe: bool) -> Body {
    let skeleton = &clip.skeleton;
    let height = clip.facts.height.value;
    let carrier = clip.facts.carrier.value;
    let mut points = Vec::new();
    clip.world_points(0, &mut points);
    let joint_of = |point: usize| skeleton.ids().nth(point);
    let limbs = (0..skeleton.n_points())
        .filter_map(|to| Some((skeleton.point_parent(to)?, to)))
        .filter(|&(from, _)| joint_of(from).is_some_and(|joint| skeleton.is_within(joint, carrier)))
        .filter_map(|(from, to)| {
            let length = points[from].distance(points[to]);
            let radius = (RADIUS_SHARE * length).clamp(RADIUS_MIN * height, RADIUS_MAX * height);
            (length > SHORTEST * height).then_some(Limb { role, from: from as u32, to: to as u32, radius })
        })
        .collect();
    Body { role, limbs, wireframe }
}

/// Marks the limbs that these joints turn as theirs.
pub(super) fn mark_selected(body: &mut Body, is_selected: impl Fn(JointId) -> bool) {
    for limb in body.limbs.iter_mut().filter(|limb| is_selected(JointId(limb.from))) {
        limb.role = Role::SelectedJoint;
    }
}
