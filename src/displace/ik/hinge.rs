//! The axis about which a chain of two bends.

use glam::{DQuat, DVec3};

use crate::{
    math::{Rigid, straight_hinge},
    motion::{Clip, Side, find_legs},
    skeleton::JointId,
};

/// Weight of the usual hinge over what the pose shows, as the sine of a bend: a limb that is nearly straight shows more
/// noise than hinge.
const USUAL: f64 = 0.02;

/// A bend whose sine is smaller shows nothing.
const NO_BEND: f64 = 1e-6;

/// A leg whose mean bend is smaller than this sine, a degree, shows how its offsets happen to lie and no hinge.
const STRAIGHT_LEG: f64 = 0.017;

/// Poses of the clip that are looked at, evenly spread; the usual hinge is a mean and needs no more.
const POSES: usize = 256;

/// Returns the axis, in the upper joint's own space, about which a chain of two joints usually bends in a clip.
///
/// `point` is what the chain moves: a joint, or an end site. None for other chains and where the clip shows no bend; a
/// leg that it never bends takes its knee to where the foot points.
pub fn usual_hinge(clip: &Clip, chain: &[JointId], point: usize) -> Option<DVec3> {
    let &[upper, lower] = chain else { return None };
    let step = clip.n_frames().div_ceil(POSES);
    let frames = (0..clip.n_frames()).step_by(step);
    let n_poses = frames.len() as f64;
    let bend = |frame: usize| {
        let (middle, end) = (below(clip, frame, upper, lower.idx()), below(clip, frame, upper, point));
        middle.normalize_or_zero().cross((end - middle).normalize_or_zero())
    };
    let sum: DVec3 = frames.map(bend).sum();
    if sum.length() < STRAIGHT_LEG * n_poses
        && let Some(hinge) = knee(clip, upper, lower)
    {
        return Some(hinge);
    }
    sum.try_normalize().filter(|_| sum.length() > NO_BEND * n_poses)
}

/// Returns where a point is in the space of a joint above it.
fn below(clip: &Clip, frame: usize, top: JointId, point: usize) -> DVec3 {
    let skeleton = &clip.skeleton;
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
}

/// Returns the hinge of a straight knee in the thigh's own space, as the first frame has the foot; none for other joints.
fn knee(clip: &Clip, upper: JointId, lower: JointId) -> Option<DVec3> {
    let legs = find_legs(clip, &[], &mut Vec::new()).value;
    let leg = legs.iter().find(|leg| (leg.hip, leg.knee) == (upper, lower))?;
    let foot = below(clip, 0, upper, leg.toe) - below(clip, 0, upper, leg.ankle.idx());
    // The hips lie on either side of what they hang on.
    let hip = clip.local(0, upper.idx());
    let outwards = hip.rotation.conjugate() * hip.translation;
    let left = if leg.side == Side::Left { outwards } else { -outwards };
    Some(straight_hinge(below(clip, 0, upper, lower.idx()), foot, left))
}

/// Returns the unit axis about which the lower bone bends further: what the pose shows, or the usual one where it shows
/// nothing; with neither, any axis across the bones.
pub(super) fn across(upper: DVec3, lower: DVec3, usual: Option<DVec3>) -> DVec3 {
    let along = (upper.normalize_or_zero() + lower.normalize_or_zero()).try_normalize();
    let shown = upper.normalize_or_zero().cross(lower.normalize_or_zero());
    let usual = usual.map_or(DVec3::ZERO, |axis| along.map_or(axis, |along| axis.reject_from_normalized(along)));
    let mixed = shown + USUAL * usual.normalize_or_zero();
    if mixed.length() > NO_BEND { mixed.normalize() } else { upper.normalize().any_orthonormal_vector() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bvh::Bvh,
        motion::{ClipOptions, gait},
    };

    #[test]
    fn a_leg_that_is_straight_throughout_bends_as_in_a_walk() {
        let (text, _) = gait::built_in();
        let (head, _) = text.split_once("MOTION").expect("a motion section");
        let still = format!("{head}MOTION\nFrames: 1\nFrame Time: 0.02\n0 97 0{}\n", " 0".repeat(63));
        let [walk, still] = [&text, &still].map(|text| {
            let bvh = Bvh::parse(text.clone().into_bytes(), "made").expect("a valid file");
            Clip::from_bvh(&bvh, &ClipOptions::default())
        });
        for leg in find_legs(&walk, &[], &mut Vec::new()).value {
            let chain = [leg.hip, leg.knee];
            let [shown, made] = [&walk, &still].map(|clip| usual_hinge(clip, &chain, leg.ankle.idx()));
            let (shown, made) = (shown.expect("a walk bends knees"), made.expect("a leg"));
            assert!(made.x > 0.98 && made.y.abs() < 1e-12, "{made}");
            assert!(made.angle_between(shown).to_degrees() < 12.0, "{made} {shown}");
        }
        let [elbow, wrist] = ["LeftElbow", "LeftWrist"].map(|name| still.skeleton.find(name).expect("a joint"));
        let shoulder = still.skeleton.joint(elbow).parent.expect("a shoulder");
        assert_eq!(usual_hinge(&still, &[shoulder, elbow], wrist.idx()), None, "an arm shows nothing");
    }
}
