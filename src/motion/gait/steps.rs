//! When and where the feet stand: twelve steps, their footprints and the weight on them.
//!
//! Frames are numbered from the clip's start. Step `i` begins with toe-off at `first_toe_off + i · STEP` and ends with
//! heel strike `SWING` frames later; the six frames to the next toe-off are double support.

use glam::DVec3;

use super::{
    Plant, Side,
    course::{Course, forward, left},
    curves::{Quintic, State, smoothed, smoothstep},
    figure::{ANKLE_HEIGHT, ANKLE_TO_TOE},
};

/// A dozen, the one that begins and the one that closes the feet included.
const N_STEPS: usize = 12;

/// Frames from one toe-off to the next: 112.5 steps a minute (Perry & Burnfield: 113).
pub(super) const STEP: usize = 32;

/// Frames in the air: 41 % of the 64 of a stride (Perry & Burnfield: 40 %).
const SWING: usize = 26;

/// Length of a full step: 0.40 of the stature, a walk at 1.31 m/s.
pub(super) const STEP_LENGTH: f64 = 70.0;

/// The first foot goes ahead by this, and the last before the feet close.
const SHORT_STEP_LENGTH: f64 = 56.0;

/// Frames of standing still at both ends, at the least.
const STILL: usize = 32;

/// Frames in which weight goes to one leg before the first step, and back to both after the last.
const WEIGHT_SHIFT: usize = 16;

/// Frames by which smoothing makes the body move ahead of the feet, and settle after them: half of all its windows.
const ANTICIPATION: usize = (CARRIED_WINDOWS[0] + CARRIED_WINDOWS[1] + CARRIED_WINDOWS[2] + CARRIED_WINDOWS[3]) / 2;

/// Windows of [`Steps::carried`].
const CARRIED_WINDOWS: [usize; 4] = [STEP, STEP, STEP / 2, STEP / 2];

/// Frames from heel strike to the foot lying flat: 9 % of a stride.
const LOADING: usize = 6;

/// Frames from heel-off to toe-off: heel-off at a third of a stride (Perry & Burnfield: 31 %).
const PUSH_OFF: usize = 16;

/// From the centre line to the ankle, walking: a stride width of 9 cm.
const HALF_WIDTH: f64 = 4.5;

/// The same, standing.
const HALF_WIDTH_STANDING: f64 = 7.0;

/// Feet point outwards by this (Murray et al.: about 7°).
const TOE_OUT_RAD: f64 = 0.11;

/// From the ankle forward to where a foot carries its share, on average over a step …
const ANKLE_TO_LOAD: f64 = 8.5;

/// … and standing.
const ANKLE_TO_LOAD_STANDING: f64 = 4.5;

/// One footprint and how the foot comes and goes.
#[derive(Clone, Copy, Debug)]
pub(super) struct Footprint {
    pub(super) side: Side,
    /// Arc length of the ankle along the course.
    pub(super) s: f64,
    /// Under the ankle, on the ground.
    pub(super) ground: DVec3,
    pub(super) heading_rad: f64,
    pub(super) yaw_rad: f64,
    /// From the ankle forward to where the weight is.
    pub(super) load_ahead: f64,
    /// Heel strike; the clip's first frame for a foot that stands there from the start.
    pub(super) strike: usize,
    /// Toe-off; the clip's last frame for a foot that stays.
    pub(super) toe_off: usize,
    /// First frame flat on the ground.
    pub(super) flat_from: usize,
    /// Last frame flat on the ground.
    pub(super) flat_to: usize,
    /// Share of a full step's foot angles with which it lands, and leaves.
    pub(super) vigour: [f64; 2],
}

impl Footprint {
    /// Turns sagittal coordinates, forward and up from under the ankle, into the world.
    pub(super) fn world(&self, ahead: f64, up: f64) -> DVec3 {
        self.ground + ahead * forward(self.yaw_rad) + up * DVec3::Y
    }

    /// What the caller of the generator is told.
    pub(super) fn truth(&self) -> Plant {
        let (ahead, down) = ANKLE_TO_TOE;
        Plant {
            side: self.side,
            contact: self.strike..=self.toe_off,
            flat: self.flat_from..=self.flat_to,
            toe_still: self.flat_from..=self.toe_off,
            ankle_world: self.world(0.0, ANKLE_HEIGHT),
            toe_world: self.world(ahead, ANKLE_HEIGHT - down),
        }
    }
}

/// The whole walk's footprints and weights.
pub(super) struct Steps {
    pub(super) n_frames: usize,
    /// In the order of their heel strikes; the two that stand at the start first.
    pub(super) plants: Vec<Footprint>,
    /// Share of the weight on the left foot, by frame.
    pub(super) left_load: Vec<f64>,
}

impl Steps {
    /// Lays the steps along a course, right foot first.
    pub(super) fn laid_along(course: &Course) -> Self {
        let first_toe_off = STILL + ANTICIPATION + WEIGHT_SHIFT;
        let last_strike = first_toe_off + (N_STEPS - 1) * STEP + SWING;
        let n_frames = last_strike + WEIGHT_SHIFT + ANTICIPATION + STILL;
        let toe_off = |step: usize| first_toe_off + step * STEP;
        let last_frame = n_frames - 1;

        let print = |side: Side, s: f64, stands: bool, frames: [usize; 2], vigour: [f64; 2]| {
            let heading_rad = course.heading_rad(s);
            let (half_width, load_ahead) =
                if stands { (HALF_WIDTH_STANDING, ANKLE_TO_LOAD_STANDING) } else { (HALF_WIDTH, ANKLE_TO_LOAD) };
            Footprint {
                side,
                s,
                ground: course.point(s) + side.sign() * half_width * left(heading_rad),
                heading_rad,
                yaw_rad: heading_rad + side.sign() * TOE_OUT_RAD,
                load_ahead,
                strike: frames[0],
                toe_off: frames[1],
                flat_from: if frames[0] == 0 { 0 } else { frames[0] + LOADING },
                flat_to: if frames[1] == last_frame { last_frame } else { frames[1] - PUSH_OFF },
                vigour,
            }
        };
        let mut plants = vec![
            print(Side::Right, 0.0, true, [0, toe_off(0)], [0.0, 0.55]),
            print(Side::Left, 0.0, true, [0, toe_off(1)], [0.0, 0.9]),
        ];
        let mut s = 0.0;
        for step in 0..N_STEPS {
            let side = if step % 2 == 0 { Side::Right } else { Side::Left };
            let closes = step == N_STEPS - 1;
            let stays = step + 2 >= N_STEPS;
            let is_short = step == 0 || step + 2 == N_STEPS;
            if !closes {
                s += if is_short { SHORT_STEP_LENGTH } else { STEP_LENGTH };
            }
            let leaves = if stays { last_frame } else { toe_off(step + 2) };
            // The foot that closes is set down nearly flat after a short push.
            let vigour = [if closes { 0.2 } else { 1.0 }, if step + 3 == N_STEPS { 0.75 } else { 1.0 }];
            plants.push(print(side, s, stays, [toe_off(step) + SWING, leaves], vigour));
        }
        let left_load = left_load(n_frames, first_toe_off);
        Self { n_frames, plants, left_load }
    }

    /// The footprints of one foot in order.
    pub(super) fn of(&self, side: Side) -> impl Iterator<Item = &Footprint> {
        self.plants.iter().filter(move |plant| plant.side == side)
    }

    /// The footprint that a foot stands on, or has last stood on.
    pub(super) fn last_of(&self, side: Side, frame: usize) -> &Footprint {
        let stood_on = self.of(side).take_while(|plant| plant.strike <= frame);
        stood_on.last().expect("both feet stand at the start")
    }

    /// How far the right foot is ahead of the left along the course, by frame, in steps.
    pub(super) fn stagger(&self) -> Vec<f64> {
        let progress = |side, frame| {
            let from = self.last_of(side, frame);
            let next = self.of(side).find(|plant| plant.strike > from.toe_off);
            next.map_or(from.s, |to| {
                let (start, end) = (State::rest(from.s), State::rest(to.s));
                let swing = Quintic::new(start, end, (to.strike - from.toe_off) as f64);
                swing.at(frame as f64 - from.toe_off as f64).value
            })
        };
        let ahead = |frame| (progress(Side::Right, frame) - progress(Side::Left, frame)) / STEP_LENGTH;
        (0..self.n_frames).map(ahead).collect()
    }

    /// Averages what the loaded footprints say, by weight, and smooths it the way a body moves over its feet.
    ///
    /// The first two windows are one step long: what repeats with every step leaves no trace, so that the middle of
    /// the walk is perfectly even. What alternates from foot to foot is cut to a third, about as much as in an inverted
    /// pendulum of a person's height that swings from one foot to the other.
    pub(super) fn carried<T>(&self, of: impl Fn(&Footprint) -> T) -> Vec<T>
    where
        T: Copy + std::ops::Add<Output = T> + std::ops::Mul<f64, Output = T>,
    {
        let carried = |frame: usize| {
            let load = self.left_load[frame];
            of(self.last_of(Side::Left, frame)) * load + of(self.last_of(Side::Right, frame)) * (1.0 - load)
        };
        smoothed((0..self.n_frames).map(carried).collect(), &CARRIED_WINDOWS)
    }
}

/// Half on each foot, on one leg while the other swings, half on each again.
fn left_load(n_frames: usize, first_toe_off: usize) -> Vec<f64> {
    let shift =
        |frame: usize, start: usize, duration: usize| smoothstep((frame as f64 - start as f64) / duration as f64);
    let load = |frame: usize| {
        let mut load = 0.5 + 0.5 * shift(frame, first_toe_off - WEIGHT_SHIFT, WEIGHT_SHIFT);
        for step in 1..N_STEPS {
            let to_left = if step % 2 == 0 { 1.0 } else { -1.0 };
            let double_support = STEP - SWING;
            load += to_left * shift(frame, first_toe_off + step * STEP - double_support, double_support);
        }
        let last_strike = first_toe_off + (N_STEPS - 1) * STEP + SWING;
        let last_side = if N_STEPS.is_multiple_of(2) { 0.5 } else { -0.5 };
        load + last_side * shift(frame, last_strike, WEIGHT_SHIFT)
    };
    (0..n_frames).map(load).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn weight_is_only_on_feet_that_stand() {
        let steps = Steps::laid_along(&Course::BUILT_IN);
        assert_eq!(steps.plants.len(), N_STEPS + 2);
        for frame in 0..steps.n_frames {
            let load = steps.left_load[frame];
            assert!((-1e-12..=1.0 + 1e-12).contains(&load), "{frame}: {load}");
            for (side, load) in [(Side::Left, load), (Side::Right, 1.0 - load)] {
                let stands = steps.of(side).any(|plant| (plant.strike..=plant.toe_off).contains(&frame));
                assert!(stands || load.abs() < 1e-12, "{frame} {side:?}: {load}");
            }
        }
    }
}
