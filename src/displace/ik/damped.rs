//! Longer chains: damped least squares along the way to the target.
//!
//! One step solves `Δω_i = r_i × (J Jᵀ + λ²)⁻¹ e`, where `r_i` leads from joint `i` to the point and `e` from the point to
//! its next place: the least turns that get there, by a system of three equations however long the chain is. The way is
//! gone in a fixed number of steps about the top of the chain, never outside its reach, so the result is a smooth
//! function of the target. After S. Buss, *Introduction to Inverse Kinematics with Jacobian Transpose, Pseudoinverse and
//! Damped Least Squares methods*, 2004.

use glam::{DMat3, DQuat, DVec3};

use super::{NEAR, chain::Chain};
use crate::math::shortest_arc;

/// Damping λ as a share of the chain's length: well below what a bent chain answers with, well above rounding.
const DAMPING: f64 = 1e-3;

/// Steps along the way.
const STEPS: usize = 32;

/// Corrections after each step.
const CORRECTIONS: usize = 2;

/// Corrections at the end. Near full reach each one halves the bend that is left over, less of a bone that is short.
const LAST_CORRECTIONS: usize = 32;

/// Corrections at the very most, where those leave more than this share of the chain's length.
const MOST_CORRECTIONS: usize = 1024;
const THERE: f64 = 1e-9;

/// A correction turns no joint further than this, radians.
const LARGEST_TURN: f64 = 0.2;

/// Bend that is given to the joints of a straight chain that has to become shorter, radians.
const SEED: f64 = 1e-3;

/// Goes all the way to a target in reach.
pub(super) fn reach(chain: &mut Chain, target: DVec3, hinge: Option<DVec3>) {
    let (from, to) = (chain.tip() - chain.top, target - chain.top);
    let (near, far) = (from.length(), to.length());
    if (far - near).abs() > NEAR * chain.length() {
        seed(chain, hinge);
    }
    // About the top: a straight way would lead through places that are out of reach.
    let start = from.try_normalize().or_else(|| to.try_normalize()).unwrap_or(DVec3::Y);
    let turn = if far > 0.0 { shortest_arc(start, to).to_scaled_axis() } else { DVec3::ZERO };
    for step in 1..=STEPS {
        let share = step as f64 / STEPS as f64;
        let direction = DQuat::from_scaled_axis(turn * share) * start;
        let place = chain.top + direction * (near + share * (far - near));
        for _ in 0..CORRECTIONS {
            correct(chain, place);
        }
    }
    settle(chain, target);
}

/// Takes what is left of the way to a target.
pub(super) fn settle(chain: &mut Chain, target: DVec3) {
    for n in 0..MOST_CORRECTIONS {
        if n >= LAST_CORRECTIONS && chain.tip().distance(target) < THERE * chain.length() {
            break;
        }
        correct(chain, target);
    }
}

fn correct(chain: &mut Chain, target: DVec3) {
    let error = target - chain.tip();
    let mut levers = Vec::with_capacity(chain.bones().len());
    chain.levers(&mut levers);
    let damping = (DAMPING * chain.length()).powi(2);
    let mut matrix = DMat3::from_diagonal(DVec3::splat(damping));
    for &r in &levers {
        matrix += DMat3::from_diagonal(DVec3::splat(r.length_squared())) - DMat3::from_cols(r * r.x, r * r.y, r * r.z);
    }
    let y = matrix.inverse() * error;
    let largest = levers.iter().map(|r| r.cross(y).length()).fold(0.0, f64::max);
    let scale = if largest > LARGEST_TURN { LARGEST_TURN / largest } else { 1.0 };
    levers.iter_mut().for_each(|r| *r = r.cross(y) * scale);
    chain.turn_each(&levers);
}

/// Gives a chain whose joints lie on one line a bend to start from: on a line no turn changes the distance at first.
fn seed(chain: &mut Chain, hinge: Option<DVec3>) {
    let length = chain.length();
    let line = chain.bones().iter().copied().max_by(|a, b| a.length().total_cmp(&b.length())).unwrap_or(DVec3::Y);
    let is_straight = chain.bones().iter().all(|bone| bone.cross(line).length() <= NEAR * length * line.length());
    let Some(line) = line.try_normalize().filter(|_| is_straight) else { return };
    let axis = hinge.map_or(DVec3::ZERO, |axis| axis.reject_from_normalized(line)).try_normalize();
    let axis = axis.unwrap_or_else(|| line.any_orthonormal_vector());
    for bone in 1..chain.bones().len() {
        chain.turn_all(bone, DQuat::from_axis_angle(axis, SEED));
    }
}
