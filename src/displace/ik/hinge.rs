//! The axis about which a chain of two bends.

use glam::{DQuat, DVec3};

use crate::{math::Rigid, motion::Clip, skeleton::JointId};

/// Weight of the usual hinge over what the pose shows, as the sine of a bend: a limb that is nearly straight shows more
/// noise than hinge.
const USUAL: f64 = 0.02;

/// A bend whose sine is smaller shows nothing.
const NO_BEND: f64 = 1e-6;

/// Poses of the clip that are looked at, evenly spread; the usual hinge is a mean and needs no more.
const POSES: usize = 256;

/// Returns the axis, in the upper joint's own space, about which a chain of two joints usually bends in a clip.
///
/// `point` is what the chain moves: a joint, or an end site. None for other chains and where the clip shows no bend.
pub fn usual_hinge(clip: &Clip, chain: &[JointId], point: usize) -> Option<DVec3> {
    let &[upper, lower] = chain else { return None };
    let skeleton = &clip.skeleton;
    let step = clip.n_frames().div_ceil(POSES);
    let bend = |frame: usize| {
        let below = |point: usize, top: JointId| {
            let (mut at, mut from_top) = match point.checked_sub(skeleton.n_joints()) {
                None => (point, Rigid::IDENTITY),
                Some(site) => {
                    let joint = skeleton.end_sites()[site];
                    let offset = skeleton.joint(joint).end_site.expect("listed as one that has it");
                    (joint.idx(), Rigid::new(DQuat::IDENTITY, offset))
                }
            };
            while at != top.idx() {
                from_top = clip.local(frame, at) * from_top;
                at = skeleton.point_parent(at).expect("the chain lies above the point");
            }
            from_top.translation
        };
        let (middle, end) = (below(lower.idx(), upper), below(point, upper));
        middle.normalize_or_zero().cross((end - middle).normalize_or_zero())
    };
    let sum: DVec3 = (0..clip.n_frames()).step_by(step).map(bend).sum();
    let n_poses = clip.n_frames().div_ceil(step) as f64;
    sum.try_normalize().filter(|_| sum.length() > NO_BEND * n_poses)
}

/// Returns the unit axis about which the lower bone bends further: what the pose shows, or the usual one where it shows
/// nothing; with neither, any axis across the bones.
pub(super) fn across(upper: DVec3, lower: DVec3, usual: Option<DVec3>) -> DVec3 {
    let along = (upper.normalize_or_zero() + lower.normalize_or_zero()).try_normalize();
    let shown = upper.normalize_or_zero().cross(lower.normalize_or_zero());
    let usual = usual.map_or(DVec3::ZERO, |axis| along.map_or(axis, |along| axis.reject_from_normalized(along)));
    let mixed = shown + USUAL * usual.normalize_or_zero();
    if mixed.length() > NO_BEND { mixed.normalize() } else { upper.any_orthonormal_vector() }
}
