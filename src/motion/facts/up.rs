//! The up axis, from the pose: heads are above feet.
//!
//! Extents mislead: a T-pose can be wider than high, a dancer's split longer. Where names do not tell head from foot,
//! the floor does: a walker's lowest point stays at one height and travels along the other axes.

use glam::DVec3;

use super::{Decided, height::percentile};
use crate::{
    motion::{UpAxis, kinematics, kinematics::Walk, poses::Poses},
    skeleton::Skeleton,
};

/// Words in names of what is low in a body, lowest first; the first group with a joint counts.
const LOW: [&[&str]; 3] = [&["foot", "feet", "toe", "ankle"], &["knee", "shin", "calf", "leg"], &["hip", "pelvis"]];

/// Words in names of what is high in a body, highest first.
const HIGH: [&[&str]; 3] = [&["head"], &["neck"], &["chest", "spine", "shoulder", "clavicle", "collar"]];

/// Decides from poses in the file's axes.
pub(super) fn from_pose(skeleton: &Skeleton, poses: &Poses) -> Decided<UpAxis> {
    from_names(skeleton, poses)
        .or_else(|| from_floor(skeleton, poses))
        .unwrap_or_else(|| Decided::new(UpAxis::Y, "nothing tells head from feet"))
}

fn from_names(skeleton: &Skeleton, poses: &Poses) -> Option<Decided<UpAxis>> {
    let low = LOW.iter().map(|words| named(skeleton, words)).find(|found| !found.is_empty())?;
    let high = HIGH.iter().map(|words| named(skeleton, words)).find(|found| !found.is_empty())?;
    let mut mean = DVec3::ZERO;
    let mut rigids = Vec::new();
    // 64 frames, evenly spread, are plenty for a mean direction.
    for frame in (0..poses.n_frames).step_by(poses.n_frames.div_ceil(64)) {
        kinematics::world_rigids(skeleton, poses, frame, &mut rigids);
        let centre =
            |joints: &[usize]| joints.iter().map(|&j| rigids[j].translation).sum::<DVec3>() / joints.len() as f64;
        mean += (centre(&high) - centre(&low)).normalize_or_zero();
    }
    let mean = mean.try_normalize()?;
    let up = if mean.z > mean.y { UpAxis::Z } else { UpAxis::Y };
    let (low, high) = (&skeleton.joints()[low[0]].name, &skeleton.joints()[high[0]].name);
    Some(Decided::new(up, format!("from {low} to {high} is y {:.2}, z {:.2} on average", mean.y, mean.z)))
}

/// Decides by the axis along which the lowest point keeps its height.
fn from_floor(skeleton: &Skeleton, poses: &Poses) -> Option<Decided<UpAxis>> {
    /// One axis's floor is even when it varies by less than this share of the other's.
    const EVEN: f64 = 0.25;
    let (mut y, mut z) = (Vec::new(), Vec::new());
    Walk::whole(skeleton).visit(poses, 0..poses.n_frames, |stretch, tracks| {
        for frame in 0..stretch.len() {
            let low = (0..tracks.n_points()).fold(DVec3::INFINITY, |low, p| low.min(tracks.position(p, frame)));
            y.push(low.y);
            z.push(low.z);
        }
    });
    let spread = |lows: &[f64]| percentile(lows, 0.9) - percentile(lows, 0.1);
    let (y, z) = (spread(&y), spread(&z));
    if y < EVEN * z {
        Some(Decided::new(UpAxis::Y, "the lowest point keeps its height along y and travels along z"))
    } else if z < EVEN * y {
        Some(Decided::new(UpAxis::Z, "the lowest point keeps its height along z and travels along y"))
    } else {
        None
    }
}

/// Returns the joints whose name holds one of these words.
fn named(skeleton: &Skeleton, words: &[&str]) -> Vec<usize> {
    let holds = |name: &str| {
        let name = name.to_lowercase();
        words.iter().any(|word| name.contains(word))
    };
    (0..skeleton.n_joints()).filter(|&j| holds(&skeleton.joints()[j].name)).collect()
}
