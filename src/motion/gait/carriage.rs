//! How the trunk is carried over the feet: place, height, heading, turns and leans of pelvis and chest.
//!
//! Everything is a smoothed average of what the feet do, so it begins before the first step, ends after the last, and
//! is exactly still before and after.

use glam::DVec3;

use super::{
    course::{Course, forward},
    curves::smoothed,
    figure::STANDING_HIP_HEIGHT,
    steps::{STEP, STEP_LENGTH, Steps},
};

/// The hips sink by this at double support …
const DROP_DOUBLE_SUPPORT: f64 = 4.1;

/// … and by this more all through the walk.
const DROP_WALKING: f64 = 0.7;

/// The pelvis turns with the leg that goes ahead, to either side by this (Perry & Burnfield: 5°).
const PELVIS_TURN_RAD: f64 = 0.087;

/// The pelvis drops on the side in the air (Perry & Burnfield: 4°).
const PELVIS_DROP_RAD: f64 = 0.065;

/// Trunk and pelvis lean forward at full speed.
const LEAN_RAD: f64 = 0.05;

/// The trunk leans into the start and out of the stop: by this at an acceleration of a step length a step squared.
const LEAN_BY_ACCELERATION_RAD: f64 = 0.12;

/// The head looks to where the body will be this many frames later.
const LOOK_AHEAD: usize = STEP / 2;

/// The arms follow the legs this many frames late.
const ARM_DELAY: usize = 2;

/// The trunk at one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct TrunkPose {
    /// Midway between the hip joints, world.
    pub(super) hips_centre: DVec3,
    /// Where the walk goes.
    pub(super) heading_rad: f64,
    /// Where the head looks.
    pub(super) gaze_rad: f64,
    /// Turn of the pelvis against the heading; left is positive, as everywhere.
    pub(super) pelvis_turn_rad: f64,
    /// Left side up.
    pub(super) pelvis_roll_rad: f64,
    /// Forward.
    pub(super) lean_rad: f64,
    /// How far the right foot is ahead, in steps, with the arms' delay; between −1 and 1.
    pub(super) arm_stagger: f64,
    /// 0 standing, 1 at full speed.
    pub(super) speed: f64,
}

/// The trunk over the whole walk.
pub(super) struct Carriage {
    frames: Vec<TrunkPose>,
    /// Arc length of the body along the course, by frame.
    progress: Vec<f64>,
    /// First frame that differs from the one before.
    pub(super) first_moving: usize,
    /// Last frame that differs from the one after.
    pub(super) last_moving: usize,
}

impl Carriage {
    /// Carries the trunk over the feet.
    pub(super) fn over(steps: &Steps) -> Self {
        let support = steps.carried(|print| print.ground + print.load_ahead * forward(print.heading_rad));
        let progress = steps.carried(|print| print.s + print.load_ahead);
        let heading = steps.carried(|print| print.heading_rad);
        let stagger = steps.stagger();
        let spread: Vec<f64> = stagger.iter().map(|s| s * s).collect();
        let turn = smoothed(stagger, &[8, 8, 4]);
        let near_spread = smoothed(spread.clone(), &[10, 6, 4]);
        let far_spread = smoothed(spread, &[STEP, STEP]);
        let roll = smoothed(steps.left_load.iter().map(|load| 2.0 * load - 1.0).collect(), &[12, 8, 4]);

        let last = steps.n_frames - 1;
        let speed: Vec<f64> = (0..=last)
            .map(|i| (progress[(i + 1).min(last)] - progress[i.saturating_sub(1)]) / 2.0 * STEP as f64 / STEP_LENGTH)
            .collect();
        let acceleration = |i: usize| (speed[(i + 1).min(last)] - speed[i.saturating_sub(1)]) / 2.0 * STEP as f64;
        let acceleration = smoothed((0..=last).map(acceleration).collect(), &[8, 8]);
        let frames: Vec<_> = (0..=last)
            .map(|i| {
                let drop = DROP_DOUBLE_SUPPORT * near_spread[(i + 2).min(last)] + DROP_WALKING * far_spread[i];
                TrunkPose {
                    hips_centre: support[i].with_y(STANDING_HIP_HEIGHT - drop),
                    heading_rad: heading[i],
                    gaze_rad: heading[(i + LOOK_AHEAD).min(last)],
                    pelvis_turn_rad: PELVIS_TURN_RAD * turn[i],
                    pelvis_roll_rad: PELVIS_DROP_RAD * roll[i] * speed[i],
                    lean_rad: LEAN_RAD * speed[i] + LEAN_BY_ACCELERATION_RAD * acceleration[i],
                    arm_stagger: turn[i.saturating_sub(ARM_DELAY)],
                    speed: speed[i],
                }
            })
            .collect();
        let first_moving = (1..=last).find(|&i| frames[i].hips_centre != frames[i - 1].hips_centre);
        let last_moving = (0..last).rfind(|&i| frames[i].hips_centre != frames[i + 1].hips_centre);
        let (first_moving, last_moving) = first_moving.zip(last_moving).expect("the body walks");
        Self { frames, progress, first_moving, last_moving }
    }

    /// Returns the trunk at a frame.
    pub(super) fn at(&self, frame: usize) -> TrunkPose {
        self.frames[frame]
    }

    /// Returns the point of the course that each frame's body belongs to.
    pub(super) fn path(&self, course: &Course) -> Vec<DVec3> {
        self.progress.iter().map(|&s| course.point(s)).collect()
    }
}
