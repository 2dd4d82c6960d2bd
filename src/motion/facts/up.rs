//! The up axis, from the pose: heads are above feet.

use glam::DVec3;

use super::Decided;
use crate::{
    motion::{UpAxis, kinematics, poses::Poses},
    skeleton::Skeleton,
};

/// Decides from poses in the file's axes.
pub(super) fn from_pose(skeleton: &Skeleton, poses: &Poses) -> Decided<UpAxis> {
    let feet = named(skeleton, &["foot", "toe", "ankle"]);
    let heads = named(skeleton, &["head", "neck"]);
    if feet.is_empty() || heads.is_empty() {
        return Decided::new(UpAxis::Y, "no head and feet to tell by name");
    }
    let mut mean = DVec3::ZERO;
    let (mut rigids, mut points) = (Vec::new(), Vec::new());
    for frame in (0..poses.n_frames).step_by(poses.n_frames.div_ceil(64)) {
        kinematics::world_rigids(skeleton, poses, frame, None, &mut rigids);
        kinematics::points(skeleton, &rigids, &mut points);
        let centre = |joints: &[usize]| joints.iter().map(|&j| points[j]).sum::<DVec3>() / joints.len() as f64;
        mean += (centre(&heads) - centre(&feet)).normalize_or_zero();
    }
    let mean = mean.normalize_or_zero();
    let up = if mean.z > mean.y { UpAxis::Z } else { UpAxis::Y };
    Decided::new(up, format!("from feet to head is mostly that way ({:.2} of y, {:.2} of z)", mean.y, mean.z))
}

/// Returns the joints whose name holds one of these words.
fn named(skeleton: &Skeleton, words: &[&str]) -> Vec<usize> {
    let holds = |name: &str| words.iter().any(|word| name.to_lowercase().contains(word));
    (0..skeleton.n_joints()).filter(|&j| holds(&skeleton.joints()[j].name)).collect()
}
