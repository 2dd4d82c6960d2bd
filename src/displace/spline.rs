//! Values between keys by straight lines or by the cubic of METHOD 8; constant outside.
//!
//! With keys (x1, y1) … (x4, y4) the cubic between 2 and 3 is the Hermite curve with the slopes
//! `(y3 − y1)/(x3 − x1)` at 2 and `(y4 − y2)/(x4 − x2)` at 3, one-sided at the first and last key.

use std::ops::Range;

use glam::DVec3;

use super::keys::{Key, Piece, pieces};

/// The curve between keys.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Curve {
    Linear,
    Cubic,
}

/// Returns a map's value at each frame of the file.
///
/// # Panics
///
/// When there is no key.
pub(super) fn values(keys: &[Key<DVec3>], curve: Curve, frames: Range<usize>) -> Vec<DVec3> {
    let mut out = Vec::with_capacity(frames.len());
    for (piece, run) in pieces(keys, frames) {
        match piece {
            Piece::Constant(key) => out.extend(std::iter::repeat_n(keys[key].value, run.len())),
            Piece::Between(key) => {
                let span = Span::new(keys, key, curve);
                out.extend(run.map(|frame| span.at(frame)));
            }
        }
    }
    out
}

/// The curve from one key to the next.
struct Span {
    start: usize,
    length: f64,
    from: DVec3,
    /// From the first key's value to the second's.
    change: DVec3,
    /// Slopes at both ends, less that of the straight line, over the span's length; 0 for a line.
    bend: [DVec3; 2],
}

impl Span {
    fn new(keys: &[Key<DVec3>], key: usize, curve: Curve) -> Self {
        let [from, to] = [keys[key], keys[key + 1]];
        let length = (to.frame - from.frame) as f64;
        let change = to.value - from.value;
        let slope = |a: Key<DVec3>, b: Key<DVec3>| (b.value - a.value) / (b.frame - a.frame) as f64;
        let before = if key > 0 { keys[key - 1] } else { from };
        let after = *keys.get(key + 2).unwrap_or(&to);
        let bend = match curve {
            Curve::Linear => [DVec3::ZERO; 2],
            Curve::Cubic => [slope(before, to), slope(from, after)].map(|slope| slope * length - change),
        };
        Self { start: from.frame, length, from: from.value, change, bend }
    }

    fn at(&self, frame: usize) -> DVec3 {
        let t = (frame - self.start) as f64 / self.length;
        let [first, second] = self.bend;
        self.from + t * self.change + t * (1.0 - t) * ((1.0 - t) * first - t * second)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// The four-point formula as it is written down: Hermite's basis with the two slopes.
    fn four_points(keys: &[Key<DVec3>], frame: usize) -> DVec3 {
        let first = keys.iter().rposition(|k| k.frame <= frame).unwrap_or(0);
        if frame < keys[0].frame || first + 1 == keys.len() {
            return keys[first].value;
        }
        let point = |i: usize| (keys[i].frame as f64, keys[i].value);
        let ((x2, y2), (x3, y3)) = (point(first), point(first + 1));
        let (x1, y1) = point(first.saturating_sub(1));
        let (x4, y4) = point((first + 2).min(keys.len() - 1));
        let (h, t) = (x3 - x2, (frame as f64 - x2) / (x3 - x2));
        let (m2, m3) = ((y3 - y1) / (x3 - x1), (y4 - y2) / (x4 - x2));
        let (t2, t3) = (t * t, t * t * t);
        (2.0 * t3 - 3.0 * t2 + 1.0) * y2
            + (t3 - 2.0 * t2 + t) * h * m2
            + (3.0 * t2 - 2.0 * t3) * y3
            + (t3 - t2) * h * m3
    }

    fn keys() -> impl Strategy<Value = Vec<Key<DVec3>>> {
        let steps = prop::collection::vec((1..40usize, prop::array::uniform3(-1.0..1.0f64)), 1..8);
        steps.prop_map(|steps| {
            let mut frame = 0;
            let key = |(step, value)| {
                frame += step;
                Key { frame, value: DVec3::from_array(value) }
            };
            steps.into_iter().map(key).collect()
        })
    }

    proptest! {
        #[test]
        fn the_cubic_is_the_four_point_formula(keys in keys()) {
            for (frame, value) in values(&keys, Curve::Cubic, 0..330).into_iter().enumerate() {
                prop_assert!(value.abs_diff_eq(four_points(&keys, frame), 1e-12));
            }
        }

        #[test]
        fn both_curves_go_through_the_keys_and_lines_are_lines(keys in keys()) {
            for curve in [Curve::Linear, Curve::Cubic] {
                let all = values(&keys, curve, 0..330);
                for key in &keys {
                    prop_assert_eq!(all[key.frame], key.value);
                }
            }
            let all = values(&keys, Curve::Linear, keys[0].frame..330);
            for pair in keys.windows(2) {
                let middle = (pair[0].frame + pair[1].frame) / 2;
                let share = (middle - pair[0].frame) as f64 / (pair[1].frame - pair[0].frame) as f64;
                let want = pair[0].value.lerp(pair[1].value, share);
                prop_assert!(all[middle - keys[0].frame].abs_diff_eq(want, 1e-14));
            }
        }
    }

    #[test]
    fn a_parabola_through_even_keys_is_a_parabola() {
        // Central differences of a parabola are its slopes, so inside the end spans the cubic is exact.
        let keys: Vec<_> = [0, 10, 20, 30].map(|x| Key { frame: x, value: DVec3::splat((x * x) as f64) }).to_vec();
        for (frame, value) in (10..20).zip(values(&keys, Curve::Cubic, 10..20)) {
            assert!((value.x - (frame * frame) as f64).abs() < 1e-12);
        }
    }

    #[test]
    fn zero_between_zeros_is_zero() {
        let keys = [3, 9].map(|frame| Key { frame, value: DVec3::ZERO });
        for curve in [Curve::Linear, Curve::Cubic] {
            assert!(values(&keys, curve, 0..12).iter().all(|v| *v == DVec3::ZERO));
        }
    }
}
