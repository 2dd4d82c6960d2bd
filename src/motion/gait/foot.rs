//! One foot through the whole walk.
//!
//! On the ground it rolls over Perry's three rockers: it lands on the heel and turns about it until it is flat, stands,
//! then turns about the toe joint while the toes stay flat. In the air ankle, foot angle and toes follow quintics that
//! take over position, velocity and acceleration from the ground at both ends, so nothing tells where the air begins.
//!
//! ```text
//!  forward →   strike          flat           push-off
//!                 o/            o                o
//!                ⟋ ⟋           / \__            / \
//!  ground ─────●──────────────●───●──────────────●──   ● does not move
//! ```

use glam::{DMat3, DVec2, DVec3};

use super::{
    Side,
    course::forward,
    curves::{Quintic, State},
    figure::{ANKLE_HEIGHT, ANKLE_TO_TOE, HEEL_BEHIND_ANKLE},
    steps::{Footprint, Steps},
};

/// Toes up at heel strike (Perry & Burnfield: about 25°, less in slower walks).
const STRIKE_PITCH_RAD: f64 = 0.36;

/// Heel up at toe-off (Perry & Burnfield: about 65° at the metatarsal joints).
const PUSH_PITCH_RAD: f64 = 1.02;

/// How fast the foot falls at heel strike, as a share of its mean speed until it is flat.
const STRIKE_SLOPE: f64 = 0.4;

/// How fast the heel rises at toe-off, as a share of its mean speed since heel-off.
const PUSH_SLOPE: f64 = 2.0;

/// Lift above the straight swing, for the toes to clear the ground.
const LIFT: f64 = 5.0;

/// The leg pulls the ankle ahead at toe-off, in centimetres a frame squared; it takes hold at once.
const PULL: f64 = 0.5;

/// The leg brakes the ankle before heel strike, in centimetres a frame squared; the ground takes over at once.
const BRAKE: f64 = 0.95;

/// The foot stops pointing down after toe-off, in radians a frame squared.
const LEVEL: f64 = 0.018;

/// A foot at a moment.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootPose {
    /// World.
    pub(super) ankle: DVec3,
    /// World orientation of the foot.
    pub(super) rotation: DMat3,
    /// Toes up against the foot.
    pub(super) toe_pitch_rad: f64,
    pub(super) yaw_rad: f64,
}

/// One foot's motion.
pub(super) struct Foot {
    prints: Vec<Footprint>,
}

impl Foot {
    /// Takes one foot's footprints.
    pub(super) fn new(steps: &Steps, side: Side) -> Self {
        Self { prints: steps.of(side).copied().collect() }
    }

    /// Returns the foot at a frame.
    pub(super) fn at(&self, frame: usize) -> FootPose {
        let next = self.prints.partition_point(|print| print.strike <= frame);
        let print = &self.prints[next - 1];
        match self.prints.get(next) {
            Some(next) if frame > print.toe_off => swing(print, next, frame),
            _ => {
                let pitch = pitch_on(print, frame).value;
                let ankle = roll(print, State::rest(pitch)).value;
                FootPose {
                    ankle,
                    rotation: rotation(print.yaw_rad, pitch),
                    toe_pitch_rad: (-pitch).max(0.0),
                    yaw_rad: print.yaw_rad,
                }
            }
        }
    }
}

/// Toes-up angle of a foot on the ground.
fn pitch_on(print: &Footprint, frame: usize) -> State<f64> {
    if frame < print.flat_from {
        let duration = (print.flat_from - print.strike) as f64;
        let pitch = STRIKE_PITCH_RAD * print.vigour[0];
        let strike = State { value: pitch, velocity: -STRIKE_SLOPE * pitch / duration, acceleration: 0.0 };
        Quintic::new(strike, State::rest(0.0), duration).at((frame - print.strike) as f64)
    } else if frame > print.flat_to {
        let duration = (print.toe_off - print.flat_to) as f64;
        let pitch = -PUSH_PITCH_RAD * print.vigour[1];
        let toe_off = State { value: pitch, velocity: PUSH_SLOPE * pitch / duration, acceleration: 0.0 };
        Quintic::new(State::rest(0.0), toe_off, duration).at((frame - print.flat_to) as f64)
    } else {
        State::rest(0.0)
    }
}

/// The ankle of a foot that turns about its heel or its toe joint.
fn roll(print: &Footprint, pitch: State<f64>) -> State<DVec3> {
    let (toe_ahead, toe_down) = ANKLE_TO_TOE;
    // Sagittal: forward and up from under the ankle of the flat foot.
    let ankle = DVec2::new(0.0, ANKLE_HEIGHT);
    let pivot = if pitch.value > 0.0 {
        DVec2::new(-HEEL_BEHIND_ANKLE, 0.0)
    } else {
        DVec2::new(toe_ahead, ANKLE_HEIGHT - toe_down)
    };
    let arm = DVec2::from_angle(pitch.value).rotate(ankle - pivot);
    let to_world = |v: DVec2| print.world(v.x, v.y) - print.ground;
    State {
        value: print.ground + to_world(pivot + arm),
        velocity: to_world(arm.perp() * pitch.velocity),
        acceleration: to_world(arm.perp() * pitch.acceleration - arm * pitch.velocity * pitch.velocity),
    }
}

/// A foot in the air between two footprints.
fn swing(from: &Footprint, to: &Footprint, frame: usize) -> FootPose {
    let duration = (to.strike - from.toe_off) as f64;
    let time = (frame - from.toe_off) as f64;
    let (mut pitch_from, pitch_to) = (pitch_on(from, from.toe_off), pitch_on(to, to.strike));
    let (mut ankle_from, mut ankle_to) = (roll(from, pitch_from), roll(to, pitch_to));
    pitch_from.acceleration += LEVEL * from.vigour[1];
    ankle_from.acceleration += PULL * from.vigour[1] * forward(from.yaw_rad);
    ankle_to.acceleration -= BRAKE * to.vigour[0] * forward(to.yaw_rad);
    let pitch = Quintic::new(pitch_from, pitch_to, duration).at(time).value;
    let toe_from =
        State { value: -pitch_from.value, velocity: -pitch_from.velocity, acceleration: -pitch_from.acceleration };
    let toe_pitch_rad = Quintic::new(toe_from, State::rest(0.0), duration).at(time).value;
    let yaw_rad = Quintic::new(State::rest(from.yaw_rad), State::rest(to.yaw_rad), duration).at(time).value;
    let ankle = Quintic::new(ankle_from, ankle_to, duration).at(time).value;
    let lift = LIFT * early_bump(time / duration);
    FootPose { ankle: ankle + lift * DVec3::Y, rotation: rotation(yaw_rad, pitch), toe_pitch_rad, yaw_rad }
}

/// Rises from 0 to 1 and falls back to 0 as `x` goes from 0 to 1, highest at 3/8, smooth at both ends.
fn early_bump(x: f64) -> f64 {
    let shape = |x: f64| x.powi(3) * (1.0 - x).powi(5);
    shape(x) / shape(0.375)
}

/// Orientation of a foot that points along its yaw with its toes up by `pitch`.
fn rotation(yaw_rad: f64, pitch_rad: f64) -> DMat3 {
    DMat3::from_rotation_y(yaw_rad) * DMat3::from_rotation_x(-pitch_rad)
}
