//! Rest frames: one to three leading T-pose frames, then a jump.

use glam::DVec3;

use super::{Decided, height::percentile};
use crate::{
    motion::{kinematics::Walk, poses::Poses},
    skeleton::{JointId, Skeleton},
};

/// At most this many leading frames are rest frames.
const MOST: usize = 3;

/// A jump is at least this many median steps.
const JUMP: f64 = 9.0;

/// Returns the number of leading rest frames.
pub(super) fn leading(skeleton: &Skeleton, poses: &Poses, carrier: JointId) -> Decided<usize> {
    let steps = steps(skeleton, poses, carrier);
    let none = |why: &str| Decided::new(0, why);
    if steps.len() < 4 * MOST {
        return none("the clip is too short to tell");
    }
    let median = percentile(&steps[MOST..], 0.5);
    let (jump_at, jump) = (0..MOST).map(|at| (at, steps[at])).max_by(|a, b| a.1.total_cmp(&b.1)).expect("MOST > 0");
    if jump > JUMP * median {
        let times = jump / median.max(f64::MIN_POSITIVE);
        return Decided::new(jump_at + 1, format!("then the joints jump by {times:.0} times their median step"));
    }
    none("no jump in the first frames")
}

/// Returns the mean step of the points in the carrier's space, from each frame to the next.
fn steps(skeleton: &Skeleton, poses: &Poses, carrier: JointId) -> Vec<f64> {
    let walk = Walk::below(skeleton, carrier);
    let mut steps = Vec::with_capacity(poses.n_frames);
    let mut last: Vec<DVec3> = Vec::new();
    walk.visit(poses, 0..poses.n_frames, |stretch, tracks| {
        for frame in 0..stretch.len() {
            let points: Vec<DVec3> = (0..tracks.n_points()).map(|p| tracks.position(p, frame)).collect();
            if !last.is_empty() {
                let sum: f64 = points.iter().zip(&last).map(|(a, b)| a.distance(*b)).sum();
                steps.push(sum / points.len() as f64);
            }
            last = points;
        }
    });
    steps
}
