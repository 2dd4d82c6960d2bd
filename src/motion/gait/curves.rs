//! Curves over time: quintics that meet position, velocity and acceleration, and averages that smooth what has corners.

use std::ops::{Add, Mul};

/// A value with its first and second derivative by frame.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) struct State<T> {
    pub(super) value: T,
    pub(super) velocity: T,
    pub(super) acceleration: T,
}

impl<T: Default> State<T> {
    /// Stands still.
    pub(super) fn rest(value: T) -> Self {
        Self { value, velocity: T::default(), acceleration: T::default() }
    }
}

/// The polynomial of degree five from one state to another.
#[derive(Clone, Copy, Debug)]
pub(super) struct Quintic<T> {
    from: State<T>,
    to: State<T>,
    duration: f64,
}

impl<T> Quintic<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    /// Goes from `from` to `to` in `duration` frames.
    pub(super) fn new(from: State<T>, to: State<T>, duration: f64) -> Self {
        Self { from, to, duration }
    }

    /// Value, velocity and acceleration `time` frames after the start; times outside are held at the ends.
    pub(super) fn at(&self, time: f64) -> State<T> {
        let x = (time / self.duration).clamp(0.0, 1.0);
        let basis = hermite_basis(x);
        let d = self.duration;
        let mix = |derivative: usize| {
            let h = |i: usize| basis[i][derivative] / d.powi(derivative as i32);
            self.from.value * h(0)
                + self.from.velocity * (d * h(1))
                + self.from.acceleration * (d * d * h(2))
                + self.to.value * h(5)
                + self.to.velocity * (d * h(4))
                + self.to.acceleration * (d * d * h(3))
        };
        State { value: mix(0), velocity: mix(1), acceleration: mix(2) }
    }
}

/// The six quintic Hermite polynomials with their first two derivatives at `x` in [0, 1].
///
/// In the order value, slope and curvature at 0, curvature, slope and value at 1.
fn hermite_basis(x: f64) -> [[f64; 3]; 6] {
    const COEFFICIENTS: [[f64; 6]; 6] = [
        [1.0, 0.0, 0.0, -10.0, 15.0, -6.0],
        [0.0, 1.0, 0.0, -6.0, 8.0, -3.0],
        [0.0, 0.0, 0.5, -1.5, 1.5, -0.5],
        [0.0, 0.0, 0.0, 0.5, -1.0, 0.5],
        [0.0, 0.0, 0.0, -4.0, 7.0, -3.0],
        [0.0, 0.0, 0.0, 10.0, -15.0, 6.0],
    ];
    COEFFICIENTS.map(|c| {
        let mut values = [0.0; 3];
        for (power, &c) in c.iter().enumerate().rev() {
            let p = power as f64;
            values[0] += c * x.powi(power as i32);
            values[1] += if power >= 1 { c * p * x.powi(power as i32 - 1) } else { 0.0 };
            values[2] += if power >= 2 { c * p * (p - 1.0) * x.powi(power as i32 - 2) } else { 0.0 };
        }
        values
    })
}

/// Goes from 0 to 1 as `x` does, at rest at both ends; held outside.
pub(super) fn smoothstep(x: f64) -> f64 {
    Quintic::new(State::rest(0.0), State::rest(1.0), 1.0).at(x).value
}

/// Averages over windows of these many frames, one after another; each must be even. Ends are held.
///
/// A window as long as a period leaves nothing of what repeats with it.
pub(super) fn smoothed<T>(mut samples: Vec<T>, windows: &[usize]) -> Vec<T>
where
    T: Copy + Add<Output = T> + Mul<f64, Output = T>,
{
    for &window in windows {
        assert!(window.is_multiple_of(2), "the window is centred on a frame");
        let half = window as isize / 2;
        let last = samples.len() as isize - 1;
        let at = |i: isize| samples[i.clamp(0, last) as usize];
        samples = (0..=last)
            .map(|i| {
                let ends = (at(i - half) + at(i + half)) * 0.5;
                let inside = (i - half + 1..i + half).map(at);
                inside.fold(ends, |sum, sample| sum + sample) * (1.0 / window as f64)
            })
            .collect();
    }
    samples
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_quintic_meets_both_states() {
        let from = State { value: 1.0, velocity: -2.0, acceleration: 0.5 };
        let to = State { value: 4.0, velocity: 3.0, acceleration: -1.0 };
        let curve = Quintic::new(from, to, 7.0);
        for (time, expected) in [(0.0, from), (7.0, to)] {
            let found = curve.at(time);
            assert!((found.value - expected.value).abs() < 1e-12);
            assert!((found.velocity - expected.velocity).abs() < 1e-12);
            assert!((found.acceleration - expected.acceleration).abs() < 1e-12);
        }
        let step = 1e-5;
        let slope = (curve.at(3.0 + step).value - curve.at(3.0 - step).value) / (2.0 * step);
        assert!((slope - curve.at(3.0).velocity).abs() < 1e-8);
    }

    #[test]
    fn a_window_of_one_period_leaves_the_mean() {
        let wave: Vec<f64> = (0..100).map(|i| 3.0 + f64::from(i % 10)).collect();
        let flat = smoothed(wave, &[10]);
        for value in &flat[5..95] {
            assert!((value - 7.5).abs() < 1e-12, "{value}");
        }
    }
}
