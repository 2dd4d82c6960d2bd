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
use wide::f64x4;

use super::lanes::{LANES, QuatLanes, VecLanes};

/// A cosine this near to the one opposite has no axis.
const OPPOSITE: f64 = 1e-12;

/// What lies along a thigh but for this sine says nothing of where the knee goes.
const ALONG: f64 = 0.1;

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

/// Four legs as they are bent, and what of the turns does not hang on where they should end.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Limbs {
    thigh: VecLanes,
    shin: VecLanes,
    /// `n × v`.
    across: VecLanes,
    /// `(v·n) n`.
    along: VecLanes,
    /// `(|u|² + |v|²) / 2 + A`.
    longest: f64x4,
    /// One over the radius of B and C; 0 where no bend changes the length.
    inverse: f64x4,
    /// Cosine and sine of the bend as it is.
    cos_was: f64x4,
    sin_was: f64x4,
}

/// Four of [`Turns`].
pub(crate) struct TurnLanes {
    pub(crate) knee: HalfTurns,
    pub(crate) hip: QuatLanes,
    pub(crate) reached: VecLanes,
}

/// Cosine and sine of half of each angle.
#[derive(Clone, Copy)]
pub(crate) struct HalfTurns {
    cos: f64x4,
    sin: f64x4,
}

/// Four rotations into which a turn about a hinge is put: its unit quaternion being `cos + sin n`, they are sums of two.
#[derive(Clone, Copy, Debug)]
pub(crate) struct Hinged {
    still: QuatLanes,
    turned: QuatLanes,
}

impl Hinged {
    /// Takes `before · turn · after`.
    pub(crate) fn new(before: QuatLanes, hinge: VecLanes, after: QuatLanes) -> Self {
        let VecLanes { x, y, z } = hinge;
        let half_turn = QuatLanes { x, y, z, w: f64x4::ZERO };
        Self { still: before.times(after), turned: before.times(half_turn.times(after)) }
    }

    /// Returns the hinge, where nothing was to come before the turn.
    #[cfg(test)]
    pub(crate) fn hinge(&self) -> VecLanes {
        let QuatLanes { x, y, z, .. } = self.turned.times(self.still.conjugate());
        VecLanes { x, y, z }
    }

    /// Returns the rotations for these turns.
    #[inline(always)]
    pub(crate) fn turned(&self, by: HalfTurns) -> QuatLanes {
        let (s, t) = (self.still, self.turned);
        let sum = |still: f64x4, turned: f64x4| still * by.cos + turned * by.sin;
        QuatLanes { x: sum(s.x, t.x), y: sum(s.y, t.y), z: sum(s.z, t.z), w: sum(s.w, t.w) }
    }
}

impl TwoBone {
    /// Finds the turns; a target out of reach is approached as far as the leg is long.
    pub fn solve(&self) -> Turns {
        let [thigh, shin, hinge, target] = [self.thigh, self.shin, self.hinge, self.target].map(VecLanes::splat);
        let turns = Limbs::new(thigh, shin, hinge).reach(target);
        let still = QuatLanes::splat(DQuat::IDENTITY);
        let knee = Hinged::new(still, hinge, still).turned(turns.knee);
        Turns { knee: knee.lanes()[0], hip: turns.hip.lanes()[0], reached: turns.reached.lanes()[0] }
    }
}

impl Limbs {
    /// Takes legs as in [`TwoBone`].
    pub(crate) fn new(thigh: VecLanes, shin: VecLanes, hinge: VecLanes) -> Self {
        let across = hinge.cross(shin);
        let along = hinge.scaled(shin.dot(hinge));
        let a = thigh.dot(along);
        let (b, c) = (thigh.dot(shin) - a, thigh.dot(across));
        let radius = (b * b + c * c).sqrt();
        let inverse = radius.simd_gt(f64x4::ZERO).bitselect(f64x4::ONE / radius, f64x4::ZERO);
        let longest = f64x4::splat(0.5) * (thigh.length_squared() + shin.length_squared()) + a;
        Self { thigh, shin, across, along, longest, inverse, cos_was: b * inverse, sin_was: -c * inverse }
    }

    /// Finds the turns that take the legs' ends to these places, seen from the hips.
    #[inline(always)]
    pub(crate) fn reach(&self, target: VecLanes) -> TurnLanes {
        let Self { cos_was, sin_was, .. } = *self;
        let (zero, one) = (f64x4::ZERO, f64x4::ONE);
        let bends = self.inverse.simd_gt(zero);
        let wanted = f64x4::splat(0.5) * target.length_squared() - self.longest;
        let cos = (wanted * self.inverse).fast_max(-one).fast_min(one);
        let sin = (one - cos * cos).sqrt();
        let cos_turn = bends.bitselect(cos * cos_was + sin * sin_was, one);
        let sin_turn = bends.bitselect(sin * cos_was - cos * sin_was, zero);
        let on_hinge = self.along.scaled(one - cos_turn);
        let turned = self.shin.scaled(cos_turn).plus(self.across.scaled(sin_turn)).plus(on_hinge);
        let reached = self.thigh.plus(turned);
        let hip = shortest_arcs(reached, target);
        TurnLanes { knee: half_turns(cos_turn, sin_turn), hip, reached: hip.rotate(reached) }
    }
}

/// Returns the unit hinge of a knee that is straight and shows none, all in one space, lengths of no account.
///
/// It is across the thigh, so that the knee goes where the foot points, from ankle to toe; where that is along the leg,
/// towards the body's left (`left`); where that is, any axis across.
pub(crate) fn straight_hinge(thigh: DVec3, foot: DVec3, left: DVec3) -> DVec3 {
    let [along, foot, left] = [thigh, foot, left].map(DVec3::normalize_or_zero);
    let forward = foot.cross(along);
    let lateral = left.reject_from(along);
    let known = [forward, lateral].into_iter().find(|axis| axis.length() > ALONG);
    known.map_or_else(|| along.try_normalize().unwrap_or(DVec3::Y).any_orthonormal_vector(), DVec3::normalize)
}

/// Returns the halves of turns with these cosines and sines.
#[inline(always)]
fn half_turns(cos: f64x4, sin: f64x4) -> HalfTurns {
    // Half angles without trigonometry, each from the larger of the two expressions.
    let (zero, half) = (f64x4::ZERO, f64x4::splat(0.5));
    let larger = (half * (f64x4::ONE + cos.abs())).sqrt();
    let smaller = half * sin / larger;
    let is_far = cos.simd_lt(zero);
    let backwards = is_far & sin.simd_lt(zero);
    HalfTurns {
        cos: is_far.bitselect(smaller.abs(), larger),
        sin: is_far.bitselect(backwards.bitselect(-larger, larger), smaller),
    }
}

/// Returns the least rotations that take directions to others; none for vectors without direction.
#[inline(always)]
fn shortest_arcs(from: VecLanes, to: VecLanes) -> QuatLanes {
    let scale = (from.length_squared() * to.length_squared()).sqrt();
    let w = scale + from.dot(to);
    let v = from.cross(to);
    let inverse = f64x4::ONE / (v.length_squared() + w * w).sqrt();
    let VecLanes { x, y, z } = v.scaled(inverse);
    let turns = QuatLanes { x, y, z, w: w * inverse };
    if !w.simd_le(scale * f64x4::splat(OPPOSITE)).any() {
        return turns;
    }
    let (from, to) = (from.lanes(), to.lanes());
    let one_by_one: [DQuat; LANES] = std::array::from_fn(|lane| shortest_arc(from[lane], to[lane]));
    QuatLanes::gather(|lane| one_by_one[lane])
}

/// Returns the least rotation that takes one direction to another; none for vectors without direction.
pub fn shortest_arc(from: DVec3, to: DVec3) -> DQuat {
    let scale = (from.length_squared() * to.length_squared()).sqrt();
    let w = scale + from.dot(to);
    if w <= OPPOSITE * scale {
        let aside = from.try_normalize().filter(|_| scale > 0.0).map(DVec3::any_orthonormal_vector);
        return aside.map_or(DQuat::IDENTITY, |aside| DQuat::from_xyzw(aside.x, aside.y, aside.z, 0.0));
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
    fn a_straight_knee_goes_where_the_foot_points() {
        let (thigh, shin) = (DVec3::NEG_Y, DVec3::NEG_Y);
        for (foot, left, knee) in [
            (DVec3::new(0.0, -0.4, 1.0), DVec3::ZERO, Some(DVec3::Z)),
            (DVec3::X, DVec3::X, Some(DVec3::X)),
            (DVec3::new(0.0, -1.0, 1e-3), DVec3::X, Some(DVec3::Z)),
            (DVec3::ZERO, DVec3::new(-0.2, 0.3, 0.0), Some(DVec3::NEG_Z)),
            (DVec3::NEG_Y, DVec3::Y, None),
            (DVec3::ZERO, DVec3::ZERO, None),
        ] {
            for parent in parents() {
                let [thigh, shin, foot, left] = [thigh, shin, foot, left].map(|v| parent.rotation * v);
                let hinge = straight_hinge(thigh, foot, left);
                assert!(hinge.is_normalized() && hinge.dot(thigh).abs() < 1e-12, "{foot} {left}: {hinge}");
                let turns = TwoBone { thigh, shin, hinge, target: 1.6 * thigh }.solve();
                let way = parent.rotation.conjugate() * (turns.hip * thigh).reject_from(thigh).normalize();
                assert!(knee.is_none_or(|knee| way.abs_diff_eq(knee, 1e-9)), "{foot} {left}: {way}");
            }
        }
        assert!(straight_hinge(DVec3::ZERO, DVec3::X, DVec3::X).is_normalized(), "no thigh at all");
    }

    #[test]
    fn nothing_to_turn_gives_no_nan() {
        for target in [DVec3::ZERO, DVec3::Y] {
            let turns = TwoBone { thigh: DVec3::ZERO, shin: DVec3::ZERO, hinge: DVec3::X, target }.solve();
            assert!(turns.knee.is_finite() && turns.hip.is_finite());
        }
    }
}
