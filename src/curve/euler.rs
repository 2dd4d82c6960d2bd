//! The thesis's integrators: Euler steps for the length of the original path, chords for the new one (METHOD 5).
//!
//! Both step through the parameter range by a fixed share `h`. They are kept to be compared with [`super::ArcLength`].

use glam::DVec3;

/// Integrates a speed from parameter 0 to each of the given parameters, which must not fall, by Euler steps of `step`.
///
/// Each step takes the speed at its start; a last partial step reaches each parameter. One pass for all of them.
pub fn euler_lengths(step: f64, parameters: &[f64], speed: impl Fn(f64) -> f64) -> Vec<f64> {
    let mut n_steps = 0_u64;
    let (mut at, mut length, mut pace) = (0.0, 0.0, speed(0.0));
    let mut lengths = Vec::with_capacity(parameters.len());
    for &u in parameters {
        while at + step <= u {
            length += step * pace;
            n_steps += 1;
            at = n_steps as f64 * step;
            pace = speed(at);
        }
        lengths.push(length + (u - at).max(0.0) * pace);
    }
    lengths
}

/// A curve measured by chords over even steps of its parameter.
#[derive(Clone, Debug, PartialEq)]
pub struct Chords {
    /// Share of the parameter range, positive.
    step: f64,
    /// Length up to parameter `i · step`, the last entry up to 1; never falls, never empty.
    lengths: Vec<f64>,
}

impl Chords {
    /// Measures a curve over [0, 1].
    ///
    /// # Panics
    ///
    /// When the step is not positive.
    pub fn new(step: f64, point: impl Fn(f64) -> DVec3) -> Self {
        assert!(step > 0.0, "a step is positive");
        let n_steps = (1.0 / step).ceil() as usize;
        let mut from = point(0.0);
        let mut length = 0.0;
        let mut lengths = Vec::with_capacity(n_steps + 1);
        lengths.push(0.0);
        for i in 1..=n_steps {
            let to = point((i as f64 * step).min(1.0));
            length += from.distance(to);
            lengths.push(length);
            from = to;
        }
        Self { step, lengths }
    }

    /// Returns the length of all chords.
    pub fn length(&self) -> f64 {
        self.lengths[self.lengths.len() - 1]
    }

    /// Returns the parameter at a length, evenly within a chord; clamped to [0, 1].
    pub fn parameter_at(&self, length: f64) -> f64 {
        let chord = self.lengths.partition_point(|&l| l <= length).clamp(1, self.lengths.len().max(2) - 1);
        let Some((&from, &to)) = self.lengths.get(chord - 1).zip(self.lengths.get(chord)) else { return 0.0 };
        let share = if to > from { ((length - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
        let start = (chord - 1) as f64 * self.step;
        start + share * ((chord as f64 * self.step).min(1.0) - start)
    }

    /// Returns the length up to a parameter in [0, 1].
    pub fn length_at(&self, u: f64) -> f64 {
        let last = self.lengths.len() - 1;
        let chord = ((u.clamp(0.0, 1.0) / self.step) as usize).min(last.max(1) - 1);
        let (start, end) = (chord as f64 * self.step, ((chord + 1) as f64 * self.step).min(1.0));
        let share = ((u - start) / (end - start)).clamp(0.0, 1.0);
        self.lengths[chord] + share * (self.lengths[chord + 1] - self.lengths[chord])
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn euler_converges_at_first_order() {
        // Speed 2u: length u². Euler's error is proportional to the step.
        let parameters = [0.0, 0.31, 0.77, 1.0];
        let error = |step: f64| (euler_lengths(step, &parameters, |u| 2.0 * u)[3] - 1.0).abs();
        for step in [0.1, 0.01, 0.001] {
            assert!((error(step) / step - 1.0).abs() < 0.02, "{}", error(step) / step);
        }
        let fine = euler_lengths(1e-5, &parameters, |u| 2.0 * u);
        for (length, u) in fine.iter().zip(parameters) {
            assert!((length - u * u).abs() < 1e-4);
        }
    }

    #[test]
    fn steps_longer_than_a_frame_are_partial_steps() {
        let lengths = euler_lengths(0.1, &[0.0, 0.05, 0.1, 0.15], |_| 4.0);
        for (length, expected) in lengths.iter().zip([0.0, 0.2, 0.4, 0.6]) {
            assert!((length - expected).abs() < 1e-12);
        }
    }

    #[test]
    fn chords_of_a_quarter_circle_come_close_and_invert() {
        let quarter =
            |u: f64| DVec3::new((u * std::f64::consts::FRAC_PI_2).cos(), 0.0, (u * std::f64::consts::FRAC_PI_2).sin());
        let chords = Chords::new(0.003, quarter);
        assert!((chords.length() - std::f64::consts::FRAC_PI_2).abs() < 1e-5);
        for i in 0..=20 {
            let u = i as f64 / 20.0;
            assert!((chords.parameter_at(chords.length_at(u)) - u).abs() < 1e-9);
        }
        assert_eq!(chords.parameter_at(-1.0), 0.0);
        assert_eq!(chords.parameter_at(9.0), 1.0);
    }

    #[test]
    fn a_point_has_no_length() {
        let chords = Chords::new(0.1, |_| DVec3::ONE);
        assert_eq!((chords.length(), chords.length_at(0.5)), (0.0, 0.0));
        assert!(chords.parameter_at(0.0).is_finite());
    }
}
