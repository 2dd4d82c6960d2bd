//! Two-bone IK about the knee's own hinge: bend the knee until the leg is as long as asked, then turn it about the hip.
//!
//! The knee turns about the hinge that the source pose shows, never about an axis made up from the target, so a leg
//! keeps its plane and its side; a straight leg takes the hinge it usually has. The law of cosines is used in the form
//! that holds for a hinge which is not quite at right angles to the leg:
//!
//! ```text
//! |u + R(n, δ) v|² = |u|² + |v|² + 2 (A + B cos δ + C sin δ)
//! A = (u·n)(v·n)    B = u·v − A    C = u·(n × v)
//! ```

use glam::{DQuat, DVec3};

/// A leg, or any limb of two bones, and where its end should be, all in one space.
#[derive(Clone, Copy, Debug)]
pub struct TwoBone {
    /// From hip to knee.
    pub thigh: DVec3,
    /// From knee to ankle.
    pub shin: DVec3,
    /// Unit axis about which the shin turns further into the bend.
    pub hinge: DVec3,
    /// From hip to the place the ankle should be at.
    pub target: DVec3,
}

/// How a leg has to turn.
#[derive(Clone, Copy, Debug)]
pub struct Turns {
    /// Of the shin, about the knee; first.
    pub knee: DQuat,
    /// Of the whole leg, about the hip; second.
    pub hip: DQuat,
    /// From hip to ankle, as it comes out.
    pub reached: DVec3,
}

impl TwoBone {
    /// Finds the turns; a target out of reach is approached as far as the leg is long.
    pub fn solve(&self) -> Turns {
        let Self { thigh: u, shin: v, hinge: n, target } = *self;
        let along = u.dot(n) * v.dot(n);
        let (b, c) = (u.dot(v) - along, u.dot(n.cross(v)));
        let radius = (b * b + c * c).sqrt();
        let wanted = 0.5 * (target.length_squared() - u.length_squared() - v.length_squared());
        let (mut knee, mut reached) = (DQuat::IDENTITY, u + v);
        if radius > 0.0 {
            // cos and sin of the bend as it is and as it has to be.
            let (cos_was, sin_was) = (b / radius, -c / radius);
            let cos = ((wanted - along) / radius).clamp(-1.0, 1.0);
            let sin = (1.0 - cos * cos).sqrt();
            let (cos_turn, sin_turn) = (cos * cos_was + sin * sin_was, sin * cos_was - cos * sin_was);
            knee = about(n, cos_turn, sin_turn);
            reached = u + turned(n, cos_turn, sin_turn, v);
        }
        let hip = shortest_arc(reached, target);
        Turns { knee, hip, reached: hip * reached }
    }
}

/// Returns the rotation about a unit axis with this cosine and sine.
fn about(axis: DVec3, cos: f64, sin: f64) -> DQuat {
    // Half angles without trigonometry, each from the larger of the two expressions.
    let (half_cos, half_sin) = if cos >= 0.0 {
        let half_cos = (0.5 * (1.0 + cos)).sqrt();
        (half_cos, 0.5 * sin / half_cos)
    } else {
        let half_sin = (0.5 * (1.0 - cos)).sqrt().copysign(sin);
        (0.5 * sin / half_sin, half_sin)
    };
    let v = axis * half_sin;
    DQuat::from_xyzw(v.x, v.y, v.z, half_cos)
}

fn turned(axis: DVec3, cos: f64, sin: f64, v: DVec3) -> DVec3 {
    v * cos + axis.cross(v) * sin + axis * (axis.dot(v) * (1.0 - cos))
}

/// Returns the least rotation that takes one direction to another; none for vectors without direction.
pub fn shortest_arc(from: DVec3, to: DVec3) -> DQuat {
    let scale = (from.length_squared() * to.length_squared()).sqrt();
    let w = scale + from.dot(to);
    if w <= 1e-12 * scale {
        let aside = from.any_orthonormal_vector();
        return if scale > 0.0 { DQuat::from_xyzw(aside.x, aside.y, aside.z, 0.0) } else { DQuat::IDENTITY };
    }
    let v = from.cross(to);
    DQuat::from_xyzw(v.x, v.y, v.z, w).normalize()
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use super::*;
    use crate::math::Rigid;

    /// Solves under a parent transform and checks where the ankle is, bone lengths and the side of the knee.
    #[track_caller]
    fn check(leg: TwoBone, parent: Rigid) {
        let moved = TwoBone {
            thigh: parent.rotation * leg.thigh,
            shin: parent.rotation * leg.shin,
            hinge: parent.rotation * leg.hinge,
            target: parent.rotation * leg.target,
        };
        let turns = moved.solve();
        let hip = parent.point(DVec3::new(0.1, 0.9, -0.2));
        let knee = hip + turns.hip * moved.thigh;
        let ankle = knee + turns.hip * turns.knee * moved.shin;
        let (a, b) = (leg.thigh.length(), leg.shin.length());
        assert!((knee.distance(hip) - a).abs() < 1e-12 && (ankle.distance(knee) - b).abs() < 1e-12);
        let length = leg.target.length().clamp((a - b).abs(), a + b);
        let place = hip + moved.target.normalize() * length;
        assert!(ankle.distance(place) < 1e-7 * (a + b), "{} off", ankle.distance(place));
        assert!((ankle - hip).distance(turns.reached) < 1e-12);
        let bend = (knee - hip).cross(ankle - knee).dot(turns.hip * moved.hinge);
        assert!(bend > -1e-9, "the knee bends backwards");
    }

    const PARENTS: [(f64, f64, [f64; 3]); 6] = [
        (0.0, 0.0, [0.0; 3]),
        (1.0, 0.0, [3.0, 0.0, -1.0]),
        (0.0, 2.0, [0.0, -5.0, 0.0]),
        (-2.5, 0.7, [1e3, 2.0, 3.0]),
        (PI, PI, [0.0, 0.0, 1.0]),
        (4.0, -1.2, [-7.0, 0.1, 0.2]),
    ];

    fn parents() -> impl Iterator<Item = Rigid> {
        PARENTS.iter().map(|&(yaw, tilt, at)| {
            let rotation = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(tilt);
            Rigid::new(rotation, DVec3::from_array(at))
        })
    }

    #[test]
    fn the_ankle_is_where_it_should_be_under_any_parent() {
        let bent = (DVec3::new(0.02, -0.4, 0.15), DVec3::new(-0.01, -0.38, -0.12));
        let straight = (DVec3::new(0.0, -0.42, 0.0), DVec3::new(0.0, -0.4, 0.0));
        for parent in parents() {
            for (thigh, shin) in [bent, straight] {
                for target in [[0.1, -0.7, 0.1], [0.0, -0.5, 0.4], [0.0, -0.78, 0.0], [0.3, 0.2, 0.0], [0.0, -2.0, 0.5]]
                {
                    let target = DVec3::from_array(target);
                    let hinge = thigh.cross(shin).try_normalize().unwrap_or(DVec3::X);
                    check(TwoBone { thigh, shin, hinge, target }, parent);
                }
            }
        }
    }

    #[test]
    fn a_leg_that_is_right_is_left_alone() {
        let (thigh, shin) = (DVec3::new(0.02, -0.4, 0.15), DVec3::new(-0.01, -0.38, -0.12));
        let turns = TwoBone { thigh, shin, hinge: thigh.cross(shin).normalize(), target: thigh + shin }.solve();
        assert!(turns.knee.angle_between(DQuat::IDENTITY) < 1e-7 && turns.hip.angle_between(DQuat::IDENTITY) < 1e-7);
    }

    #[test]
    fn nothing_to_turn_gives_no_nan() {
        for target in [DVec3::ZERO, DVec3::Y] {
            let turns = TwoBone { thigh: DVec3::ZERO, shin: DVec3::ZERO, hinge: DVec3::X, target }.solve();
            assert!(turns.knee.is_finite() && turns.hip.is_finite());
        }
    }
}
