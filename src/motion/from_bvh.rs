//! BVH → clip: the file's numbers, what they mean, and the one turn into y-up world space.

use super::{Clip, ClipOptions, Length, UpAxis, angles::Angles, channels::FileMotion, facts};
use crate::{
    bvh::Bvh,
    skeleton::{Joint, Skeleton},
};

/// Stands in for a frame time that is none.
pub(super) const DEFAULT_FRAME_TIME_SECS: f64 = 1.0 / 30.0;

impl Clip {
    /// Reads a file as a clip; what cannot be taken as it is becomes a warning.
    ///
    /// A file with one frame or none gives a stationary clip (see [`super::Length`]). Values that are no numbers repeat the frame before; a frame
    /// time that is not positive becomes 1/30 s; options that cannot be met are ignored.
    ///
    /// # Panics
    ///
    /// When the file has no joint, which the parser refuses.
    pub fn from_bvh(bvh: &Bvh, options: &ClipOptions) -> Self {
        let mut warnings = Vec::new();
        let (length, n_frames) = Length::decide(bvh.n_frames(), bvh.joints().len(), options, &mut warnings);
        let motion = FileMotion::new(bvh, n_frames, &mut warnings);
        // A file that says nothing of time has nothing wrong.
        let told = if bvh.has_motion() { bvh.frame_time_secs() } else { DEFAULT_FRAME_TIME_SECS };
        let frame_time_secs = frame_time_secs(told, &mut warnings);
        let (facts, mut poses) = facts::decide(&motion, options, &mut warnings);
        let up = facts.up.value;
        for (idx, joint) in motion.skeleton.joints().iter().enumerate() {
            if up != UpAxis::Y && joint.parent.is_none() {
                poses.premultiply(idx, up.world_rotation());
            }
        }
        let angles = Angles::new(&motion, up);
        Self { skeleton: in_world(&motion.skeleton, up), frame_time_secs, facts, length, warnings, poses, angles }
    }
}

fn frame_time_secs(read: f64, warnings: &mut Vec<String>) -> f64 {
    if read > 0.0 && read.is_finite() {
        return read;
    }
    warnings.push(format!("frame time {read} s is not positive; 1/30 s is used"));
    DEFAULT_FRAME_TIME_SECS
}

/// Turns the roots' offsets into y-up axes.
fn in_world(skeleton: &Skeleton, up: UpAxis) -> Skeleton {
    let turned = |j: &Joint| match j.parent {
        None => Joint { offset: up.to_world(j.offset), ..j.clone() },
        Some(_) => j.clone(),
    };
    Skeleton::new(skeleton.joints().iter().map(turned).collect())
}
