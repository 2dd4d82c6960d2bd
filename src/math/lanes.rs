//! Four frames at once: the few vector and quaternion operations that work on whole clips is made of.
//!
//! A lane is a frame. Everything is branch-free, so that four frames cost little more than one.

use glam::{DQuat, DVec3};
use wide::f64x4;

/// Frames in a group.
pub(crate) const LANES: usize = 4;

/// Makes one of each lane. (What an array's own `map` makes goes by way of memory, in a call of its own.)
#[inline(always)]
pub(crate) fn by_lane<T>(make: impl Fn(usize) -> T) -> [T; LANES] {
    [make(0), make(1), make(2), make(3)]
}

/// Returns four values of a list from one on, the last of the list in place of what is beyond it.
#[inline(always)]
pub(crate) fn four<T>(list: &[T], at: usize) -> [&T; LANES] {
    match list.get(at..at + LANES) {
        Some(values) => by_lane(|lane| &values[lane]),
        None => by_lane(|lane| &list[(at + lane).min(list.len() - 1)]),
    }
}

/// Four vectors.
#[derive(Clone, Copy, Debug)]
pub(crate) struct VecLanes {
    pub(crate) x: f64x4,
    pub(crate) y: f64x4,
    pub(crate) z: f64x4,
}

impl VecLanes {
    pub(crate) fn splat(v: DVec3) -> Self {
        Self { x: f64x4::splat(v.x), y: f64x4::splat(v.y), z: f64x4::splat(v.z) }
    }

    #[inline(always)]
    pub(crate) fn gather(lane: impl Fn(usize) -> DVec3) -> Self {
        let [a, b, c, d] = by_lane(lane);
        Self {
            x: f64x4::new([a.x, b.x, c.x, d.x]),
            y: f64x4::new([a.y, b.y, c.y, d.y]),
            z: f64x4::new([a.z, b.z, c.z, d.z]),
        }
    }

    #[inline(always)]
    pub(crate) fn lanes(self) -> [DVec3; LANES] {
        let (x, y, z) = (self.x.to_array(), self.y.to_array(), self.z.to_array());
        by_lane(|lane| DVec3::new(x[lane], y[lane], z[lane]))
    }

    #[inline(always)]
    pub(crate) fn plus(self, o: Self) -> Self {
        Self { x: self.x + o.x, y: self.y + o.y, z: self.z + o.z }
    }

    #[inline(always)]
    pub(crate) fn minus(self, o: Self) -> Self {
        Self { x: self.x - o.x, y: self.y - o.y, z: self.z - o.z }
    }

    #[inline(always)]
    pub(crate) fn scaled(self, by: f64x4) -> Self {
        Self { x: self.x * by, y: self.y * by, z: self.z * by }
    }

    /// Returns the products axis by axis.
    #[inline(always)]
    pub(crate) fn times(self, o: Self) -> Self {
        Self { x: self.x * o.x, y: self.y * o.y, z: self.z * o.z }
    }

    #[inline(always)]
    pub(crate) fn dot(self, o: Self) -> f64x4 {
        self.x * o.x + self.y * o.y + self.z * o.z
    }

    #[inline(always)]
    pub(crate) fn cross(self, o: Self) -> Self {
        Self { x: self.y * o.z - self.z * o.y, y: self.z * o.x - self.x * o.z, z: self.x * o.y - self.y * o.x }
    }

    #[inline(always)]
    pub(crate) fn length_squared(self) -> f64x4 {
        self.dot(self)
    }

    #[inline(always)]
    pub(crate) fn length(self) -> f64x4 {
        self.length_squared().sqrt()
    }

    /// Returns unit vectors; no length stays none.
    #[inline(always)]
    pub(crate) fn normalized(self) -> Self {
        let length = self.length();
        self.scaled(length.simd_gt(f64x4::ZERO).bitselect(f64x4::ONE / length, f64x4::ZERO))
    }
}

/// Four quaternions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct QuatLanes {
    pub(crate) x: f64x4,
    pub(crate) y: f64x4,
    pub(crate) z: f64x4,
    pub(crate) w: f64x4,
}

impl QuatLanes {
    pub(crate) fn splat(q: DQuat) -> Self {
        Self { x: f64x4::splat(q.x), y: f64x4::splat(q.y), z: f64x4::splat(q.z), w: f64x4::splat(q.w) }
    }

    #[inline(always)]
    pub(crate) fn gather(lane: impl Fn(usize) -> DQuat) -> Self {
        let [a, b, c, d] = by_lane(lane);
        Self {
            x: f64x4::new([a.x, b.x, c.x, d.x]),
            y: f64x4::new([a.y, b.y, c.y, d.y]),
            z: f64x4::new([a.z, b.z, c.z, d.z]),
            w: f64x4::new([a.w, b.w, c.w, d.w]),
        }
    }

    #[inline(always)]
    pub(crate) fn lanes(self) -> [DQuat; LANES] {
        let ([x, y], [z, w]) = ([self.x.to_array(), self.y.to_array()], [self.z.to_array(), self.w.to_array()]);
        by_lane(|lane| DQuat::from_xyzw(x[lane], y[lane], z[lane], w[lane]))
    }

    /// Returns the rotation about axis 0 (x), 1 (y) or 2 (z) with this sine and cosine of half its angle.
    #[inline(always)]
    pub(crate) fn about(axis: usize, (s, c): (f64x4, f64x4)) -> Self {
        let o = f64x4::splat(0.0);
        match axis {
            0 => Self { x: s, y: o, z: o, w: c },
            1 => Self { x: o, y: s, z: o, w: c },
            _ => Self { x: o, y: o, z: s, w: c },
        }
    }

    /// Returns `about(a, half_a) · about(b, half_b)`; for two different axes that is four products.
    #[inline(always)]
    pub(crate) fn about_two(a: usize, half_a: (f64x4, f64x4), b: usize, half_b: (f64x4, f64x4)) -> Self {
        let ((sa, ca), (sb, cb)) = (half_a, half_b);
        let (w, along_a, along_b, across) = (ca * cb, sa * cb, ca * sb, sa * sb);
        match (a, b) {
            (0, 1) => Self { x: along_a, y: along_b, z: across, w },
            (1, 2) => Self { x: across, y: along_a, z: along_b, w },
            (2, 0) => Self { x: along_b, y: across, z: along_a, w },
            (1, 0) => Self { x: along_b, y: along_a, z: -across, w },
            (2, 1) => Self { x: -across, y: along_b, z: along_a, w },
            (0, 2) => Self { x: along_a, y: -across, z: along_b, w },
            _ => Self::about(a, half_a).turned(b, half_b),
        }
    }

    /// Returns `self · about(axis, half)`.
    #[inline(always)]
    pub(crate) fn turned(self, axis: usize, (s, c): (f64x4, f64x4)) -> Self {
        let Self { x, y, z, w } = self;
        match axis {
            0 => Self { x: x * c + w * s, y: y * c + z * s, z: z * c - y * s, w: w * c - x * s },
            1 => Self { x: x * c - z * s, y: y * c + w * s, z: z * c + x * s, w: w * c - y * s },
            _ => Self { x: x * c + y * s, y: y * c - x * s, z: z * c + w * s, w: w * c - z * s },
        }
    }

    #[inline(always)]
    pub(crate) fn conjugate(self) -> Self {
        Self { x: -self.x, y: -self.y, z: -self.z, w: self.w }
    }

    /// Returns `self · o`: `o` first.
    #[inline(always)]
    pub(crate) fn times(self, o: Self) -> Self {
        let Self { x, y, z, w } = self;
        Self {
            x: w * o.x + x * o.w + y * o.z - z * o.y,
            y: w * o.y - x * o.z + y * o.w + z * o.x,
            z: w * o.z + x * o.y - y * o.x + z * o.w,
            w: w * o.w - x * o.x - y * o.y - z * o.z,
        }
    }

    /// Rotates vectors: `v + w t + u × t` with `t = 2 u × v`, `u` the vector part.
    #[inline(always)]
    pub(crate) fn rotate(self, v: VecLanes) -> VecLanes {
        let Self { x, y, z, w } = self;
        let (tx, ty, tz) = (y * v.z - z * v.y, z * v.x - x * v.z, x * v.y - y * v.x);
        let (tx, ty, tz) = (tx + tx, ty + ty, tz + tz);
        VecLanes {
            x: v.x + w * tx + (y * tz - z * ty),
            y: v.y + w * ty + (z * tx - x * tz),
            z: v.z + w * tz + (x * ty - y * tx),
        }
    }
}

/// Four rigid motions.
#[derive(Clone, Copy, Debug)]
pub(crate) struct RigidLanes {
    pub(crate) rotation: QuatLanes,
    pub(crate) translation: VecLanes,
}

impl RigidLanes {
    /// Move nothing.
    pub(crate) fn identity() -> Self {
        Self { rotation: QuatLanes::splat(DQuat::IDENTITY), translation: VecLanes::splat(DVec3::ZERO) }
    }

    /// Moves points.
    #[inline(always)]
    pub(crate) fn point(self, p: VecLanes) -> VecLanes {
        self.rotation.rotate(p).plus(self.translation)
    }
}

/// Largest angle [`half_sin_cos_of_degrees`] takes, degrees.
pub(crate) const FARTHEST_DEGREES: f64 = (1u64 << 40) as f64;

/// Returns sine and cosine of half of each angle, up to a common sign per lane (the same rotation).
///
/// Whole turns are taken off in degrees, where that is exact; then the angle's quarter is at most π/4, where its sine
/// is a short series, the cosine follows from the sine, and one doubling leads to the half. Within 1e-15 of the true
/// values; the cosine is at least 0 but for rounding. Angles beyond [`FARTHEST_DEGREES`] give nonsense.
#[inline(always)]
pub(crate) fn half_sin_cos_of_degrees(degrees: f64x4) -> (f64x4, f64x4) {
    // Adding this and taking it away again leaves the nearest whole number; every processor has an addition.
    const ROUND: f64 = 1.5 * (1u64 << 52) as f64;
    let one = f64x4::splat(1.0);
    let turns = (degrees * f64x4::splat(1.0 / 360.0) + f64x4::splat(ROUND)) - f64x4::splat(ROUND);
    let quarter_rad = (degrees - turns * f64x4::splat(360.0)) * f64x4::splat(std::f64::consts::PI / 720.0);
    let s = sin_to_quarter_pi(quarter_rad);
    let ss = s * s;
    // 1 − s² is at least a half here, so the root loses nothing; it keeps the processor's divider busy instead of its
    // multipliers, which a series for the cosine would need as much as the sine's.
    let c = (one - ss).sqrt();
    let sc = s * c;
    (sc + sc, one - (ss + ss))
}

/// Taylor series for |x| ≤ π/4; the first term left out is below 5e-17.
#[inline(always)]
fn sin_to_quarter_pi(x: f64x4) -> f64x4 {
    // 1/n! with the series' signs, highest power first.
    const TERMS: [f64; 7] = [
        -1.0 / 1_307_674_368_000.0,
        1.0 / 6_227_020_800.0,
        -1.0 / 39_916_800.0,
        1.0 / 362_880.0,
        -1.0 / 5_040.0,
        1.0 / 120.0,
        -1.0 / 6.0,
    ];
    let xx = x * x;
    let sum = TERMS[1..].iter().fold(f64x4::splat(TERMS[0]), |sum, &term| sum * xx + f64x4::splat(term));
    x + x * xx * sum
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn half_angles_agree_with_libm() {
        let mut worst = 0.0f64;
        let mut degrees = -1e4;
        while degrees <= 1e4 {
            let (s, c) = half_sin_cos_of_degrees(f64x4::splat(degrees));
            let (s, c) = (s.to_array()[0], c.to_array()[0]);
            // libm is given the angle without its whole turns: as radians, 1e4 degrees are off by 2e-14 themselves.
            let within = degrees - 360.0 * (degrees / 360.0).round();
            let (ls, lc) = (within / 2.0).to_radians().sin_cos();
            let sign = if s * ls + c * lc < 0.0 { -1.0 } else { 1.0 };
            worst = worst.max((s - sign * ls).abs()).max((c - sign * lc).abs());
            degrees += 0.137;
        }
        assert!(worst < 1e-15, "off by {worst:e}");
    }

    #[test]
    fn far_angles_keep_their_digits() {
        let turns = FARTHEST_DEGREES - FARTHEST_DEGREES % 360.0;
        let (s, c) = half_sin_cos_of_degrees(f64x4::new([turns - 270.0, 90.0 - turns, -turns, turns]));
        for (s, half) in s.to_array().into_iter().zip([0.5f64.sqrt(), 0.5f64.sqrt(), 0.0, 0.0]) {
            assert!((s - half).abs() < 1e-15);
        }
        for (c, half) in c.to_array().into_iter().zip([0.5f64.sqrt(), 0.5f64.sqrt(), 1.0, 1.0]) {
            assert!((c - half).abs() < 1e-15);
        }
    }

    #[test]
    fn lanes_do_what_glam_does() {
        let q = DQuat::from_xyzw(0.1, -0.5, 0.3, 0.8).normalize();
        let o = DQuat::from_xyzw(-0.7, 0.2, 0.4, -0.1).normalize();
        let v = DVec3::new(1.0, -2.0, 0.5);
        let (ql, ol) = (QuatLanes::splat(q), QuatLanes::gather(|_| o));
        assert!(ql.times(ol).lanes()[3].abs_diff_eq(q * o, 1e-15));
        let turned = ql.rotate(VecLanes::gather(|_| v));
        let turned = DVec3::new(turned.x.to_array()[2], turned.y.to_array()[2], turned.z.to_array()[2]);
        assert!(turned.abs_diff_eq(q * v, 1e-14));
        for axis in 0..3 {
            let half = half_sin_cos_of_degrees(f64x4::splat(50.0));
            let want = q * DQuat::from_axis_angle(DVec3::AXES[axis], 50f64.to_radians());
            assert!(ql.turned(axis, half).lanes()[0].abs_diff_eq(want, 1e-15));
            assert!(ql.times(QuatLanes::about(axis, half)).lanes()[1].abs_diff_eq(want, 1e-15));
            for before in 0..3 {
                let other = half_sin_cos_of_degrees(f64x4::splat(-130.0));
                let want = QuatLanes::about(before, other).times(QuatLanes::about(axis, half)).lanes()[0];
                assert!(QuatLanes::about_two(before, other, axis, half).lanes()[0].abs_diff_eq(want, 1e-15));
            }
        }
    }
}
