//! Spreading the mismatch at a seam over a window on both sides of it.
//!
//! Two pieces of a signal meet at a seam: `u` before, `v` from the seam on. Where they meet, the value jumps by `d0` and
//! the rate by `d1` per frame. Each side gives way by half of both, less and less away from the seam:
//!
//! ```text
//! before  u + ½ d0 S(τ) − ½ d1 w V(τ)       S(τ) = 1 − 10 τ³ + 15 τ⁴ − 6 τ⁵
//! after   v − ½ d0 S(τ) − ½ d1 w V(τ)       V(τ) = τ − 6 τ³ + 8 τ⁴ − 3 τ⁵        τ = |frames from the seam| / w
//! ```
//!
//! `S` and `V` are the quintic Hermite functions of a value and of a slope at 0; both end at 1 without value, slope and
//! curvature. So both sides pass the seam at the mean value and the mean rate, and nothing outside the window changes.

use glam::{DQuat, DVec3};

use crate::math::rotation_vector_between;

/// A window on both sides of a seam.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Window {
    /// Frames on each side; 0 spreads nothing.
    pub(super) n_frames: usize,
}

/// Shares of a jump that a frame takes on.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct Shares {
    /// Of the jump in value.
    pub(super) value: f64,
    /// Of the jump in rate per frame.
    pub(super) rate: f64,
}

/// How far two pieces are apart where they meet.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub(super) struct Jump<T> {
    /// After less before.
    pub(super) value: T,
    /// The same of the rates, per frame.
    pub(super) rate: T,
}

impl Window {
    /// Returns the shares of a frame this many frames after the seam, before it when negative; none outside.
    pub(super) fn at(self, offset: i64) -> Option<Shares> {
        let n_frames = self.n_frames as f64;
        let t = offset.unsigned_abs() as f64 / n_frames;
        let within = self.n_frames > 0 && t < 1.0;
        within.then(|| {
            let cube = t * t * t;
            let value = 0.5 * (1.0 - cube * (10.0 - t * (15.0 - 6.0 * t)));
            let rate = -0.5 * n_frames * (t - cube * (6.0 - t * (8.0 - 3.0 * t)));
            Shares { value: if offset < 0 { value } else { -value }, rate }
        })
    }
}

impl Jump<f64> {
    /// Returns what a frame is changed by.
    pub(super) fn share(&self, shares: Shares) -> f64 {
        shares.value * self.value + shares.rate * self.rate
    }
}

impl Jump<DVec3> {
    /// Returns what a frame is changed by; of rotations a rotation vector, applied first.
    pub(super) fn share(&self, shares: Shares) -> DVec3 {
        shares.value * self.value + shares.rate * self.rate
    }

    /// Returns the jump between rotations: each side's rotation at the seam and one frame earlier.
    pub(super) fn of_rotations(before: [DQuat; 2], after: [DQuat; 2]) -> Self {
        Self {
            value: rotation_vector_between(before[1], after[1]),
            rate: rotation_vector_between(after[0], after[1]) - rotation_vector_between(before[0], before[1]),
        }
    }

    /// Returns the jump between places: each side's place at the seam and one frame earlier.
    pub(super) fn of_places(before: [DVec3; 2], after: [DVec3; 2]) -> Self {
        Self { value: after[1] - before[1], rate: (after[1] - after[0]) - (before[1] - before[0]) }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Joins two straight lines at frame 0 and returns frames −20 to 19.
    fn joined(jump: Jump<f64>, n_frames: usize) -> Vec<f64> {
        let window = Window { n_frames };
        (-20..20)
            .map(|k| {
                let t = k as f64;
                let line = if k < 0 { 3.0 + 0.5 * t } else { 3.0 + jump.value + (0.5 + jump.rate) * t };
                line + window.at(k).map_or(0.0, |shares| jump.share(shares))
            })
            .collect()
    }

    #[test]
    fn two_lines_meet_in_the_middle_and_are_untouched_outside() {
        for (value, rate) in [(1.0, 0.0), (0.0, 0.3), (-2.0, 0.7)] {
            let x = joined(Jump { value, rate }, 12);
            assert!((x[20] - (3.0 + 0.5 * value)).abs() < 1e-12);
            for k in 0..8 {
                let t = k as f64 - 20.0;
                assert_eq!(x[k], 3.0 + 0.5 * t, "before the window");
                let t = 19.0 - k as f64;
                assert_eq!(x[39 - k], 3.0 + value + (0.5 + rate) * t, "after the window");
            }
        }
    }

    /// The shares are Hermite's: found by finite differences in time, each with its jump at the seam.
    #[test]
    fn values_and_rates_pass_the_seam_in_the_middle() {
        const STEPS: usize = 4000;
        let window = Window { n_frames: STEPS };
        let side = |offsets: [i64; 3]| offsets.map(|k| window.at(k).unwrap_or(Shares { value: 0.0, rate: 0.0 }));
        let slope = |[a, _, c]: [f64; 3]| 0.5 * (c - a) * STEPS as f64;
        let curvature = |[a, b, c]: [f64; 3]| (a - 2.0 * b + c) * (STEPS * STEPS) as f64;
        let (end, w) = (STEPS as i64, STEPS as f64);
        // Before the seam, just within both ends of the window, in units of the window.
        for (at, value, rate) in [(-2, (0.5, 0.0), (0.0, 0.5)), (1 - end, (0.0, 0.0), (0.0, 0.0))] {
            let shares = side([at - 1, at, at + 1]);
            let (of_value, of_rate) = (shares.map(|s| s.value), shares.map(|s| s.rate / w));
            assert!((of_value[1] - value.0).abs() < 1e-3 && (slope(of_value) - value.1).abs() < 1e-2);
            assert!((of_rate[1] - rate.0).abs() < 1e-3 && (slope(of_rate) - rate.1).abs() < 1e-2);
            assert!(curvature(of_value).abs() < 0.1 && curvature(of_rate).abs() < 0.1);
        }
        // After it the same with the value the other way.
        for k in 1..end {
            let (before, after) = (window.at(-k).expect("within"), window.at(k).expect("within"));
            assert_eq!((before.value, before.rate), (-after.value, after.rate));
        }
    }

    #[test]
    fn no_window_spreads_nothing() {
        assert_eq!(Window { n_frames: 0 }.at(0), None);
        assert_eq!(Window { n_frames: 3 }.at(3), None);
        assert_eq!(Window { n_frames: 3 }.at(0), Some(Shares { value: -0.5, rate: 0.0 }));
    }
}
