//! How hard a cycle meets the next one (METHOD 9).

use glam::DVec3;

use crate::{math::Rigid, motion::EditedClip};

/// Frames read before and after a seam: enough for a velocity step that does not touch it on either side.
const REACH: usize = 4;

/// A step shorter than this, body heights, is rounding.
const LEAST_STEP: f64 = 1e-9;

/// Steps over a seam: the largest over all joints, in the world.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Seam {
    /// First edited frame of the new cycle, rest frames not counted.
    pub frame: usize,
    /// Distance from the frame before, body heights.
    pub position: f64,
    /// Rotation from the frame before, radians.
    pub rotation: f64,
    /// Change of velocity across the seam, body heights per second.
    pub velocity: f64,
    /// Larger of the position steps just before and just after the seam, body heights.
    pub neighbour_position: f64,
    /// Larger of the rotations just before and just after the seam, radians.
    pub neighbour_rotation: f64,
    /// Larger of the changes of velocity just before and just after the seam, body heights per second.
    pub neighbour_velocity: f64,
}

/// Measures every seam; `height` is `H` in the clip's unit.
pub(super) fn seams(edited: &EditedClip, seams: &[usize], height: f64) -> Vec<Seam> {
    seams.iter().map(|&frame| Seam::at(edited, frame, height)).collect()
}

impl Seam {
    /// A seam is not seen when no joint moves further into it than this many times its largest step nearby.
    pub const BAR: f64 = 1.5;

    /// Measures the seam before a frame; `height` is `H` in the clip's unit.
    ///
    /// Steps that would reach beyond the clip count as none.
    pub fn at(edited: &EditedClip, frame: usize, height: f64) -> Self {
        let first = frame.saturating_sub(REACH);
        let poses: Vec<Vec<Rigid>> = (first..(frame + REACH).min(edited.n_frames()))
            .map(|f| {
                let mut pose = Vec::new();
                edited.world_rigids(f, &mut pose);
                pose
            })
            .collect();
        let at = frame - first;
        let per_sec = edited.clip.frame_time_secs.recip();
        let larger = |a: Option<f64>, b: Option<f64>| a.unwrap_or(0.0).max(b.unwrap_or(0.0));
        let velocity = |k: usize| velocity_step(&poses, k).map(|step| step * per_sec / height);
        let position = |k: usize| position_step(&poses, k).map(|step| step / height);
        Self {
            frame,
            position: position(at).unwrap_or(0.0),
            rotation: rotation_step(&poses, at).unwrap_or(0.0),
            velocity: velocity(at).unwrap_or(0.0),
            neighbour_position: larger(at.checked_sub(1).and_then(position), position(at + 1)),
            neighbour_rotation: larger(
                at.checked_sub(1).and_then(|k| rotation_step(&poses, k)),
                rotation_step(&poses, at + 1),
            ),
            // Two frames off, so that none of the four frames of a velocity step lies across the seam.
            neighbour_velocity: larger(at.checked_sub(2).and_then(velocity), velocity(at + 2)),
        }
    }

    /// Returns the step over the seam, over the larger of those beside it: at most [`Self::BAR`] for one that is not
    /// seen.
    pub fn position_share(&self) -> f64 {
        // Where nothing moves, a step that is rounding is no step.
        self.position / self.neighbour_position.max(LEAST_STEP)
    }
}

/// Returns the largest distance a joint moves into frame `k`.
fn position_step(poses: &[Vec<Rigid>], k: usize) -> Option<f64> {
    let (from, to) = (poses.get(k.checked_sub(1)?)?, poses.get(k)?);
    Some(from.iter().zip(to).map(|(a, b)| a.translation.distance(b.translation)).fold(0.0, f64::max))
}

/// Returns the largest angle a joint turns into frame `k`, radians.
fn rotation_step(poses: &[Vec<Rigid>], k: usize) -> Option<f64> {
    let (from, to) = (poses.get(k.checked_sub(1)?)?, poses.get(k)?);
    Some(from.iter().zip(to).map(|(a, b)| a.rotation.angle_between(b.rotation)).fold(0.0, f64::max))
}

/// Returns the largest change, over joints, between the step out of frame `k` and the step into the frame before.
fn velocity_step(poses: &[Vec<Rigid>], k: usize) -> Option<f64> {
    let frames = poses.get(k.checked_sub(2)?..k + 2)?;
    let step = |i: usize, joint: usize| -> DVec3 { frames[i + 1][joint].translation - frames[i][joint].translation };
    Some((0..frames[0].len()).map(|joint| step(2, joint).distance(step(0, joint))).fold(0.0, f64::max))
}
