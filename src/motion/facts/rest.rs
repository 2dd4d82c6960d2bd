//! Rest frames: one to three leading T-pose frames, then a jump.
//!
//! The carrier itself may not jump at all, so what is watched are the joints in its space.

use glam::DVec3;

use super::{Decided, height::percentile};
use crate::{
    motion::{kinematics::Walk, poses::Poses},
    skeleton::{JointId, Skeleton},
};

/// At most this many leading frames are rest frames.
const MOST: usize = 3;

/// A jump is at least this many median steps; the captured clips that have one jump by 31 to 83 of them.
const JUMP: f64 = 9.0;

/// A jump is at least this many times each of the steps around it: a performer who starts fast is not at rest.
const ALONE: f64 = 3.0;

/// Steps around a jump that are looked at.
const AROUND: usize = 8;

/// Returns the number of leading rest frames.
pub(super) fn leading(skeleton: &Skeleton, poses: &Poses, carrier: JointId) -> Decided<usize> {
    let steps = steps(skeleton, poses, carrier);
    if steps.len() < MOST + AROUND {
        return Decided::new(0, "the clip is too short to tell");
    }
    let median = percentile(&steps[MOST..], 0.5);
    let (jump_at, jump) = (0..MOST).map(|at| (at, steps[at])).max_by(|a, b| a.1.total_cmp(&b.1)).expect("MOST > 0");
    let is_alone = (0..MOST + AROUND).all(|at| at == jump_at || jump >= ALONE * steps[at]);
    if jump > JUMP * median && median > 0.0 && is_alone {
        return Decided::new(
            jump_at + 1,
            format!("after it the joints jump by {:.0} times their median step", jump / median),
        );
    }
    Decided::new(0, "no jump in the first frames")
}

/// Returns the mean step of the points in the carrier's space, from each frame to the next.
fn steps(skeleton: &Skeleton, poses: &Poses, carrier: JointId) -> Vec<f64> {
    let walk = Walk::below(skeleton, carrier);
    let mut steps = Vec::with_capacity(poses.n_frames);
    let mut last = vec![DVec3::ZERO; walk.points.len()];
    walk.visit(poses, 0..poses.n_frames, |stretch, tracks| {
        for frame in 0..stretch.len() {
            let mut sum = 0.0;
            for (point, last) in last.iter_mut().enumerate() {
                let position = tracks.position(point, frame);
                sum += position.distance(*last);
                *last = position;
            }
            if stretch.start + frame > 0 {
                steps.push(sum / tracks.n_points() as f64);
            }
        }
    });
    steps
}
