//! What an offset of the carrier costs at one frame, with the derivatives that the search for the least cost needs.
//!
//! Each cost is a spring along one direction: its force is the slope of half the cost, and its stiffness along and
//! across that direction is never negative, so that the sum of all springs has one least point.

use glam::DVec3;

/// Price of the offset itself.
const NEARNESS: f64 = 0.2;

/// Price of an offset's excess over [`MOST_OFFSET`].
const FAR_PRICE: f64 = 200.0;

/// An offset up to this share of the body height costs little.
const MOST_OFFSET: f64 = 0.045;

/// How far within its limit an overlong leg is brought, share of the limit.
const LIMIT_MARGIN: f64 = 2e-4;

/// Added to the share by which a leg is short of straight, so that no knee turns infinitely fast.
const STRAIGHT: f64 = 2e-3;

/// Returns how far the knee of a leg of this length is bent when its hip and ankle are that far apart: about twice this
/// is the angle, because it is the root of half the share by which a leg is short of straight.
#[inline]
pub(super) fn bend(reach: f64, length: f64) -> f64 {
    (1.0 - reach / length + STRAIGHT).max(0.5 * STRAIGHT).sqrt()
}

/// Returns how far apart hip and ankle of a leg of this length are whose knee is bent that far, [`straight`] at most.
fn reach(bend: f64, length: f64) -> f64 {
    length * (1.0 + STRAIGHT - bend * bend)
}

/// Returns how far apart hip and ankle of a leg of this length are from which on its knee bends no less.
fn straight(length: f64) -> f64 {
    length * (1.0 + 0.5 * STRAIGHT)
}

/// What one leg asks of the carrier at one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    /// From the ankle's target to the hip without offset, world.
    pub(super) leg: DVec3,
    /// Share of the offset that lengthens the leg, by axis: less than 1 where the foot follows.
    pub(super) moves: DVec3,
    /// How far the knee is to be bent, [`bend`].
    pub(super) bend: f64,
    /// Length of thigh and shin together.
    pub(super) length: f64,
    /// Price of turning the knee.
    pub(super) weight: f64,
    /// Distance not to be exceeded; infinite for a leg well within its swing.
    pub(super) limit: f64,
}

/// Cost of the offset of one frame.
#[derive(Clone, Copy, Debug, Default)]
pub(super) struct Cost {
    pub(super) value: f64,
    /// Where it pulls the offset.
    pub(super) force: DVec3,
    /// xx, xy, yy, xz, yz, zz.
    pub(super) stiffness: [f64; 6],
}

impl Cost {
    /// Adds a spring; `force` is against the direction.
    #[inline]
    fn add(&mut self, direction: DVec3, stiffness: f64, across: f64, force: f64) {
        let scaled = direction * (stiffness - across);
        self.stiffness[0] += scaled.x * direction.x + across;
        self.stiffness[1] += scaled.y * direction.x;
        self.stiffness[2] += scaled.y * direction.y + across;
        self.stiffness[3] += scaled.z * direction.x;
        self.stiffness[4] += scaled.z * direction.y;
        self.stiffness[5] += scaled.z * direction.z + across;
        self.force -= direction * force;
    }

    /// Adds the price of an offset.
    #[inline]
    pub(super) fn add_offset(&mut self, offset: DVec3, height: f64, share: f64) {
        let near = share * NEARNESS;
        self.add(DVec3::ZERO, 0.0, near, 0.0);
        self.force -= near * offset;
        self.value += near * offset.length_squared();
        let most = MOST_OFFSET * height;
        if offset.length_squared() > most * most {
            let far = share * FAR_PRICE;
            let length = offset.length();
            let excess = length - most;
            self.add(offset / length, far, far * excess / length, far * excess);
            self.value += far * excess * excess;
        }
    }
}

impl Wish {
    /// Returns whether an offset makes the leg longer than it may be.
    pub(super) fn is_long(&self, offset: DVec3) -> bool {
        let bound = self.bound();
        (self.leg + self.moves * offset).length_squared() > bound * bound
    }

    /// Returns how long an offset must be at least to make the leg longer than it may be.
    pub(super) fn slack(&self) -> f64 {
        self.bound() - self.leg.length()
    }

    fn bound(&self) -> f64 {
        self.limit * (1.0 - LIMIT_MARGIN)
    }

    /// Adds the price of turning the knee, `w (√2 l (b₀ − b))²`.
    #[inline]
    pub(super) fn add_knee(&self, offset: DVec3, share: f64, cost: &mut Cost) {
        let (along, length, inverse) = self.stretched(offset);
        let is = bend(length, self.length);
        // Past straight the force stays as it is there; where it were not the slope of its cost, no step would be right and
        // the search stop.
        let past = (length - straight(self.length)).max(0.0);
        let slope = 1.0 / is;
        let weight = share * self.weight;
        // On the way to straight a knee turns ever faster. Where that doubles the spring's stiffness, the spring alone would
        // have every step come back farther than it went. Past straight it is as long as it takes to where it is at rest.
        let faster = self.bend * slope - 1.0;
        let force = weight * self.length * faster;
        let stiffness = if past > 0.0 {
            force / (length - reach(self.bend, self.length))
        } else {
            0.5 * weight * slope * slope * if faster > 1.0 { 1.0 + faster } else { 1.0 }
        };
        let across = self.moves.x * self.moves.x * force.max(0.0) * inverse;
        cost.add(self.moves * along, stiffness, across, force);
        let turn = self.length * (self.bend - is);
        cost.value += 2.0 * weight * turn * (turn + slope * past);
    }

    /// Adds the price of a leg that is too long.
    pub(super) fn add_limit(&self, offset: DVec3, price: f64, cost: &mut Cost) {
        let (along, length, inverse) = self.stretched(offset);
        let excess = length - self.bound();
        let across = self.moves.x * self.moves.x * price * excess * inverse;
        cost.add(self.moves * along, price, across, price * excess);
        cost.value += price * excess * excess;
    }

    /// Returns the leg's direction, its length and one over that; a length of 0 is made a small one.
    #[inline]
    fn stretched(&self, offset: DVec3) -> (DVec3, f64, f64) {
        let leg = self.leg + self.moves * offset;
        let length = leg.length().max(1e-9 * self.length);
        let inverse = 1.0 / length;
        (inverse * leg, length, inverse)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const OFFSET: DVec3 = DVec3::new(0.03, -0.02, 0.05);

    fn wish() -> Wish {
        let leg = DVec3::new(0.1, 0.85, -0.12);
        Wish { leg, moves: DVec3::new(0.7, 0.9, 0.7), bend: bend(0.8, 0.9), length: 0.9, weight: 0.6, limit: 0.82 }
    }

    /// Checks that the force is half the slope of the cost, downhill, by finite differences.
    #[track_caller]
    fn check(cost_at: impl Fn(DVec3) -> Cost) {
        const STEP: f64 = 1e-6;
        let force = cost_at(OFFSET).force;
        for axis in DVec3::AXES {
            let slope = (cost_at(OFFSET + STEP * axis).value - cost_at(OFFSET - STEP * axis).value) / (2.0 * STEP);
            assert!((force.dot(axis) + 0.5 * slope).abs() < 1e-6 * (1.0 + slope.abs()), "{force} {slope}");
        }
    }

    #[test]
    fn forces_are_the_slopes_of_the_costs() {
        let of = |add: &dyn Fn(&mut Cost)| {
            let mut cost = Cost::default();
            add(&mut cost);
            cost
        };
        check(|o| of(&|c| wish().add_knee(o, 3.0, c)));
        let overlong = Wish { length: 0.8, bend: bend(0.7, 0.8), ..wish() };
        check(|o| of(&|c| overlong.add_knee(o, 3.0, c)));
        check(|o| of(&|c| wish().add_limit(o, 100.0, c)));
        check(|o| of(&|c| c.add_offset(o, 1.0, 3.0)));
        check(|o| of(&|c| c.add_offset(o, 100.0, 3.0)));
    }

    #[test]
    fn a_nearly_straight_leg_is_as_stiff_as_its_force_grows() {
        const STEP: f64 = 1e-6;
        let leg = Wish { moves: DVec3::ONE, length: 0.88, ..wish() };
        let along = leg.leg.normalize();
        let at = |far: f64| {
            let mut cost = Cost::default();
            leg.add_knee(far * along, 1.0, &mut cost);
            cost
        };
        let [xx, xy, yy, xz, yz, zz] = at(0.0).stiffness;
        let stiff =
            DVec3::new(xx, xy, xz) * along.x + DVec3::new(xy, yy, yz) * along.y + DVec3::new(xz, yz, zz) * along.z;
        let grows = (at(-STEP).force - at(STEP).force).dot(along) / (2.0 * STEP);
        assert!((stiff.dot(along) / grows - 1.0).abs() < 1e-6, "{stiff} {grows}");
    }

    #[test]
    fn a_leg_that_is_right_pulls_nowhere_and_a_leg_of_no_length_gives_no_nan() {
        let right = Wish { bend: bend(wish().leg.length(), wish().length), ..wish() };
        let mut cost = Cost::default();
        right.add_knee(DVec3::ZERO, 1.0, &mut cost);
        assert!(cost.force.length() < 1e-12 && cost.value < 1e-24);
        let none = Wish { leg: DVec3::ZERO, ..wish() };
        none.add_knee(DVec3::ZERO, 1.0, &mut cost);
        assert!(cost.force.is_finite() && cost.stiffness.iter().all(|s| s.is_finite()));
    }
}
