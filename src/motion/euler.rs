//! Rotations as three channel angles, on the branch that continues the values around them.
//!
//! A rotation has two triples of angles for every rotation order of three different axes, each up to whole turns, and
//! a circle of triples where the middle angle is ±90° (gimbal lock). All are the same pose; what tells them apart is
//! which continues the frame before.

use glam::{DMat3, DQuat};

/// Below this cosine of the middle angle the outer two cannot be told apart; treating them as locked turns the joint
/// by no more than that, in radians.
const LOCKED: f64 = 1e-9;

/// Returns the angles, degrees, that turn about `axes` in this order to `rotation` and lie nearest to `near`.
///
/// `axes` are three different ones of 0 (x), 1 (y) and 2 (z), applied as the channels of a file are: the first is the
/// outermost. Nearest is meant in the sum of squares.
pub(super) fn nearest_degrees(axes: [usize; 3], rotation: DQuat, near: [f64; 3]) -> [f64; 3] {
    let near = near.map(|degrees| if degrees.abs() < 1e9 { degrees } else { degrees % 360.0 }.to_radians());
    let turn = Turn::new(axes, rotation);
    let found = match turn.first_angle() {
        Some(first) => turn.nearer(near, [first, first + std::f64::consts::PI]),
        None => {
            // The last angle would have to make up for all of the change; let the first take half of it.
            let [first, _, last] = turn.angles(near[0], near);
            let half = (last - near[2]) / 2.0;
            turn.nearer(near, [first + half, first - half])
        }
    };
    found.map(f64::to_degrees)
}

/// A rotation to be taken apart as `R_i(first) · R_j(middle) · R_k(last)`.
struct Turn {
    axes: [usize; 3],
    /// 1 for an even order (xyz, yzx, zxy), −1 for an odd one.
    sign: f64,
    matrix: DMat3,
}

impl Turn {
    fn new(axes: [usize; 3], rotation: DQuat) -> Self {
        let sign = if (axes[0] + 1) % 3 == axes[1] { 1.0 } else { -1.0 };
        Self { axes, sign, matrix: DMat3::from_quat(rotation) }
    }

    /// Returns one of the two possible first angles; none in gimbal lock, where any is possible.
    fn first_angle(&self) -> Option<f64> {
        let [_, j, k] = self.axes;
        let column = self.matrix.col(k);
        (column[j].hypot(column[k]) > LOCKED).then(|| (-self.sign * column[j]).atan2(column[k]))
    }

    /// Returns the triple with this first angle, each angle within half a turn of `near`.
    ///
    /// Taking the first angle off before the others are read keeps the pose exact however near the lock is: what the
    /// first angle misses, the last one makes up for.
    fn angles(&self, first: f64, near: [f64; 3]) -> [f64; 3] {
        let [i, j, k] = self.axes;
        let (sin, cos) = first.sin_cos();
        // Rows j and k of R_i(-first) · matrix.
        let row_j = |c: usize| cos * self.matrix.col(c)[j] + self.sign * sin * self.matrix.col(c)[k];
        let row_k = |c: usize| cos * self.matrix.col(c)[k] - self.sign * sin * self.matrix.col(c)[j];
        let middle = (self.sign * self.matrix.col(k)[i]).atan2(row_k(k));
        let last = (self.sign * row_j(i)).atan2(row_j(j));
        let mut angles = [first, middle, last];
        for (angle, near) in angles.iter_mut().zip(near) {
            *angle += std::f64::consts::TAU * ((near - *angle) / std::f64::consts::TAU).round();
        }
        angles
    }

    fn nearer(&self, near: [f64; 3], firsts: [f64; 2]) -> [f64; 3] {
        let distance = |angles: [f64; 3]| angles.iter().zip(near).map(|(a, n)| (a - n) * (a - n)).sum::<f64>();
        let [a, b] = firsts.map(|first| self.angles(first, near));
        if distance(b) < distance(a) { b } else { a }
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;

    const ORDERS: [[usize; 3]; 6] = [[0, 1, 2], [0, 2, 1], [1, 0, 2], [1, 2, 0], [2, 0, 1], [2, 1, 0]];

    fn rotation(axes: [usize; 3], degrees: [f64; 3]) -> DQuat {
        (axes.iter().zip(degrees))
            .fold(DQuat::IDENTITY, |q, (&axis, d)| q * DQuat::from_axis_angle(DVec3::AXES[axis], d.to_radians()))
    }

    /// Takes a rotation apart and checks that the angles make the same rotation.
    fn check(axes: [usize; 3], q: DQuat, near: [f64; 3]) -> [f64; 3] {
        let found = nearest_degrees(axes, q, near);
        let off = (rotation(axes, found).conjugate() * q).to_scaled_axis();
        let off = off.length().min((std::f64::consts::TAU - off.length()).abs());
        assert!(off < 3e-9, "{axes:?} near {near:?}: {found:?} is off by {off:e} rad");
        found
    }

    fn distance(a: [f64; 3], b: [f64; 3]) -> f64 {
        a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f64>().sqrt()
    }

    proptest! {
        #[test]
        fn every_order_comes_back(
            angles in prop::array::uniform3(-720.0..720.0f64),
            near in prop::array::uniform3(-900.0..900.0f64),
        ) {
            for axes in ORDERS {
                let found = check(axes, rotation(axes, angles), near);
                // Nothing equivalent is nearer: not the other triple, not another turn.
                let other = [found[0] + 180.0, 180.0 - found[1], found[2] + 180.0];
                for triple in [found, other] {
                    for channel in 0..3 {
                        let off = triple[channel] - near[channel];
                        let best = off - 360.0 * (off / 360.0).round();
                        prop_assert!(triple != found || (off - best).abs() < 1e-6);
                    }
                }
                let best_other: f64 = (0..3).map(|c| {
                    let off = other[c] - near[c];
                    (off - 360.0 * (off / 360.0).round()).powi(2)
                }).sum::<f64>().sqrt();
                prop_assert!(distance(found, near) <= best_other + 1e-6);
            }
        }

        #[test]
        fn poles_come_back_and_stay_near(
            outer in prop::array::uniform2(-180.0..180.0f64),
            pole in prop::sample::select(vec![90.0, -90.0, 270.0, -450.0]),
            exponent in 1..18i32,
            sign in prop::sample::select(vec![-1.0, 0.0, 1.0]),
        ) {
            for axes in ORDERS {
                let angles = [outer[0], pole + sign * 10f64.powi(-exponent), outer[1]];
                let q = rotation(axes, angles);
                let found = check(axes, q, angles);
                // Unless it is so near the pole that rounding hides the angles, the same triple comes back.
                if exponent <= 4 && sign != 0.0 {
                    prop_assert!(distance(found, angles) < 1e-6, "{:?} {:?}", found, angles);
                }
                // A locked pose near other angles moves as little as it can.
                let near = [outer[0] + 3.0, pole, outer[1] + 3.0];
                let found = check(axes, rotation(axes, [outer[0], pole, outer[1]]), near);
                prop_assert!(distance(found, near) < 4.3, "{:?} {:?}", found, near);
            }
        }
    }

    #[test]
    fn whole_turns_of_the_neighbour_are_kept() {
        let found = check([2, 0, 1], rotation([2, 0, 1], [10.0, 20.0, 30.0]), [370.5, 19.0, -691.0]);
        assert!(distance(found, [370.0, 20.0, -690.0]) < 1e-9);
        assert!(nearest_degrees([0, 1, 2], DQuat::IDENTITY, [1e300, 0.0, 0.0]).iter().all(|d| d.is_finite()));
    }
}
