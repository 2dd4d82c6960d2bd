//! What glam and the linear algebra library lack: rigid motions, angles about up, limbs of two bones, four frames at once.
//!
//! World space is y-up and right-handed; a heading of 0 looks along +Z and grows towards +X.

pub(crate) mod lanes;
mod two_bone;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

pub(crate) use two_bone::{Hinged, Limbs, straight_hinge};
pub use two_bone::{Turns, TwoBone, shortest_arc};

/// A rotation followed by a translation.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Rigid {
    /// Unit quaternion.
    pub rotation: DQuat,
    /// Applied after the rotation.
    pub translation: DVec3,
}

impl Rigid {
    /// Changes nothing.
    pub const IDENTITY: Self = Self { rotation: DQuat::IDENTITY, translation: DVec3::ZERO };

    /// Makes a rigid motion.
    pub const fn new(rotation: DQuat, translation: DVec3) -> Self {
        Self { rotation, translation }
    }

    /// Maps a point.
    #[inline]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.rotation * p + self.translation
    }

    /// Returns the motion that undoes this one.
    #[inline]
    pub fn inverse(&self) -> Self {
        let rotation = self.rotation.conjugate();
        Self { rotation, translation: -(rotation * self.translation) }
    }
}

impl std::ops::Mul for Rigid {
    type Output = Self;

    /// `a * b` applies `b` first.
    #[inline]
    fn mul(self, b: Self) -> Self {
        Self { rotation: self.rotation * b.rotation, translation: self.point(b.translation) }
    }
}

/// Returns the heading of a direction, radians in (−π, π]; none where it has no horizontal part.
pub fn heading_rad(direction: DVec3) -> Option<f64> {
    let DVec3 { x, z, .. } = direction;
    ((x != 0.0 || z != 0.0) && x.is_finite() && z.is_finite()).then(|| x.atan2(z))
}

/// Returns the rotation about up that turns +Z to this heading.
pub fn heading_rotation(heading_rad: f64) -> DQuat {
    DQuat::from_rotation_y(heading_rad)
}

/// Returns the twist of a rotation about up, radians in (−π, π] (swing and twist); 0 where the twist is undefined.
pub fn twist_rad(rotation: DQuat) -> f64 {
    if rotation.y == 0.0 && rotation.w == 0.0 { 0.0 } else { wrap_rad(2.0 * rotation.y.atan2(rotation.w)) }
}

/// Returns a rotation's axis times its angle, radians, up to a whole turn; glam's own takes small angles for none.
pub fn rotation_vector(turn: DQuat) -> DVec3 {
    let sine = turn.xyz().length();
    if sine == 0.0 { DVec3::ZERO } else { turn.xyz() * (2.0 * sine.atan2(turn.w) / sine) }
}

/// Returns the rotation vector, in the space of `from`, that takes one rotation to the other the short way.
pub fn rotation_vector_between(from: DQuat, to: DQuat) -> DVec3 {
    let turn = from.conjugate() * to;
    rotation_vector(if turn.w < 0.0 { -turn } else { turn })
}

/// Brings an angle into (−π, π].
pub fn wrap_rad(angle: f64) -> f64 {
    use std::f64::consts::{PI, TAU};
    if -PI < angle && angle <= PI {
        return angle;
    }
    let wrapped = (angle + PI).rem_euclid(TAU) - PI;
    if wrapped <= -PI { wrapped + TAU } else { wrapped }
}

/// Adds whole turns so that each angle is within half a turn of the one before it.
pub fn unwrap_rad(angles: &mut [f64]) {
    for i in 1..angles.len() {
        angles[i] = angles[i - 1] + wrap_rad(angles[i] - angles[i - 1]);
    }
}

/// Writes a number with so many decimals; where they show nothing it is 0, without a sign.
pub fn fixed(n: f64, decimals: usize) -> String {
    let text = format!("{n:.decimals$}");
    match text.strip_prefix('-') {
        Some(digits) if digits.chars().all(|c| matches!(c, '0' | '.')) => digits.to_owned(),
        _ => text,
    }
}

/// Goes from 0 to 1 over [0, 1] with no velocity and no acceleration at either end.
pub fn smootherstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_rigid_motion_and_its_inverse_cancel() {
        let a = Rigid::new(DQuat::from_rotation_x(0.7) * DQuat::from_rotation_y(-2.0), DVec3::new(1.0, -2.0, 3.0));
        let p = DVec3::new(0.3, 0.2, 0.1);
        assert!((a.inverse() * a).point(p).abs_diff_eq(p, 1e-14));
    }

    #[test]
    fn heading_and_its_rotation_agree() {
        for heading in [-3.0, -1.0, 0.0, 0.5, 3.1] {
            let direction = heading_rotation(heading) * DVec3::Z;
            assert!((heading_rad(direction).expect("horizontal") - heading).abs() < 1e-14);
            assert!((twist_rad(heading_rotation(heading)) - heading).abs() < 1e-14);
        }
        assert_eq!(heading_rad(DVec3::Y), None);
        assert_eq!(twist_rad(DQuat::from_rotation_x(std::f64::consts::PI)).abs(), 0.0);
    }

    #[test]
    fn nothing_is_written_without_a_sign() {
        for (n, decimals, expected) in
            [(-0.0, 3, "0.000"), (-4e-4, 3, "0.000"), (-6e-4, 3, "-0.001"), (-0.4, 0, "0"), (-10.0, 1, "-10.0")]
        {
            assert_eq!(fixed(n, decimals), expected);
        }
    }

    #[test]
    fn unwrapping_removes_whole_turns() {
        let mut angles = [3.0, -3.0, 3.0, 0.1];
        unwrap_rad(&mut angles);
        for pair in angles.windows(2) {
            assert!((pair[1] - pair[0]).abs() <= std::f64::consts::PI);
        }
    }

    #[test]
    fn a_turn_is_a_rotation_vector_the_short_way() {
        let from = DQuat::from_rotation_x(0.8);
        for v in [DVec3::ZERO, DVec3::new(1e-14, 0.0, 0.0), DVec3::new(0.3, -2.0, 1.0), DVec3::new(0.0, 3.1, 0.0)] {
            let found = rotation_vector_between(from, from * DQuat::from_scaled_axis(v));
            assert!(found.abs_diff_eq(v, 1e-12), "{v} {found}");
            assert!(rotation_vector_between(from, -(from * DQuat::from_scaled_axis(v))).abs_diff_eq(v, 1e-12));
        }
    }

    #[test]
    fn a_smoother_step_begins_and_ends_at_rest() {
        const STEP: f64 = 1e-4;
        assert_eq!((smootherstep(-1.0), smootherstep(0.0), smootherstep(1.0), smootherstep(2.0)), (0.0, 0.0, 1.0, 1.0));
        assert!(smootherstep(STEP) < 1e-10 && 1.0 - smootherstep(1.0 - STEP) < 1e-10);
        assert!((smootherstep(0.5) - 0.5).abs() < 1e-15);
    }
}
