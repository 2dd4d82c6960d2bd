//! Least-squares polynomials through evenly spaced samples, in a basis orthogonal on the samples themselves.
//!
//! The basis is the discrete Chebyshev (Gram) polynomials: on `N` even samples of [-1, 1] they obey a three-term
//! recurrence whose coefficients are known in closed form, so a fit of degree `d` costs `N · d` and needs no matrix.
//! Powers of `t` would lose all digits long before degree 45. (A. Gil, J. Segura, N. Temme, Numerical Methods for
//! Special Functions, SIAM 2007, section 3 for recurrences; the closed form is classical.)

use glam::DVec3;

/// Three polynomials of one degree, x, y and z against `t` in [-1, 1], fitted to even samples.
///
/// Oscillates between few samples when the degree is far above twice the square root of their number; the caller caps.
#[derive(Clone, Debug, PartialEq)]
pub struct PolynomialFit {
    /// Weight of each basis polynomial, degree 0 first; never empty.
    coefficients: Vec<DVec3>,
    /// Recurrence coefficients: `t · p[k] = ladder[k + 1] · p[k + 1] + ladder[k] · p[k - 1]`; entry 0 unused, 0.
    ladder: Vec<f64>,
    /// Value of the constant basis polynomial.
    constant: f64,
    /// Samples minus fit, one per sample.
    residuals: Vec<DVec3>,
    /// Root mean square of the residuals, per axis.
    rms: DVec3,
}

impl PolynomialFit {
    /// Fits polynomials of the smallest degree, from `min_degree` up, of which `enough(rms per axis)` holds.
    ///
    /// Stops at `max_degree` and at one less than the number of samples, which interpolates.
    ///
    /// # Panics
    ///
    /// When there are no samples.
    pub fn fit(samples: &[DVec3], min_degree: usize, max_degree: usize, enough: impl Fn(DVec3) -> bool) -> Self {
        assert!(!samples.is_empty(), "a fit needs a sample");
        let n = samples.len();
        let max_degree = max_degree.min(n - 1);
        let ladder: Vec<f64> = (0..=max_degree).map(|k| ladder(k, n)).collect();
        let constant = (n as f64).sqrt().recip();

        // Each basis polynomial's share is taken from what the lower ones left (modified Gram–Schmidt).
        let mut residuals = samples.to_vec();
        let mut coefficients = Vec::with_capacity(max_degree + 1);
        let mut lower = vec![0.0; n];
        let mut basis = vec![constant; n];
        let mut rms;
        loop {
            let degree = coefficients.len();
            coefficients.push(take_share(&basis, &mut residuals));
            rms = (residuals.iter().map(|&r| r * r).sum::<DVec3>() / n as f64).map(f64::sqrt);
            if degree >= max_degree || (degree >= min_degree && enough(rms)) {
                break;
            }
            let (down, up) = (ladder[degree], ladder[degree + 1]);
            for (i, (b, l)) in basis.iter().zip(&mut lower).enumerate() {
                *l = (frame_t(i, n) * b - down * *l) / up;
            }
            std::mem::swap(&mut basis, &mut lower);
        }
        Self { coefficients, ladder, constant, residuals, rms }
    }

    /// Returns the degree that was fitted.
    pub fn degree(&self) -> usize {
        self.coefficients.len() - 1
    }

    /// Returns sample minus fit for each sample.
    pub fn residuals(&self) -> &[DVec3] {
        &self.residuals
    }

    /// Returns the root mean square of the residuals, per axis.
    pub fn rms(&self) -> DVec3 {
        self.rms
    }

    /// Returns value and derivative by `t`; any `t`, though the fit means little outside [-1, 1].
    pub fn at(&self, t: f64) -> (DVec3, DVec3) {
        let (mut lower, mut lower_slope) = (0.0, 0.0);
        let (mut basis, mut slope) = (self.constant, 0.0);
        let mut value = self.coefficients[0] * basis;
        let mut derivative = DVec3::ZERO;
        for k in 1..self.coefficients.len() {
            let (down, up) = (self.ladder[k - 1], self.ladder[k].recip());
            let next = (t * basis - down * lower) * up;
            let next_slope = (basis + t * slope - down * lower_slope) * up;
            (lower, lower_slope) = (basis, slope);
            (basis, slope) = (next, next_slope);
            value += self.coefficients[k] * basis;
            derivative += self.coefficients[k] * slope;
        }
        (value, derivative)
    }
}

/// Returns where sample `i` of `n` stands in [-1, 1]; a single sample stands at -1.
pub fn frame_t(i: usize, n: usize) -> f64 {
    2.0 * i as f64 / (n.max(2) - 1) as f64 - 1.0
}

/// Returns recurrence coefficient `k` of the orthonormal discrete Chebyshev polynomials on `n` even samples of [-1, 1].
fn ladder(k: usize, n: usize) -> f64 {
    let (k, n) = (k as f64, n as f64);
    if k == 0.0 { 0.0 } else { k / (n - 1.0) * ((n * n - k * k) / (4.0 * k * k - 1.0)).sqrt() }
}

/// Takes the part along `basis` out of the residuals and returns its weight.
fn take_share(basis: &[f64], residuals: &mut [DVec3]) -> DVec3 {
    let share: DVec3 = basis.iter().zip(&*residuals).map(|(&b, &r)| r * b).sum();
    for (b, r) in basis.iter().zip(residuals) {
        *r -= share * *b;
    }
    share
}

#[cfg(test)]
mod tests {
    use super::*;

    fn fixed(samples: &[DVec3], degree: usize) -> PolynomialFit {
        PolynomialFit::fit(samples, degree, degree, |_| true)
    }

    /// A polynomial of degree 45 with no small coefficients in the Chebyshev sense: cos(45 acos t) and friends.
    fn chebyshev(t: f64) -> DVec3 {
        let angle = t.clamp(-1.0, 1.0).acos();
        DVec3::new((45.0 * angle).cos(), (31.0 * angle).cos() + 100.0, (7.0 * angle).cos() - (45.0 * angle).cos())
    }

    #[test]
    fn a_polynomial_of_degree_45_is_recovered() {
        let n = 900;
        let samples: Vec<DVec3> = (0..n).map(|i| chebyshev(frame_t(i, n))).collect();
        let fit = fixed(&samples, 45);
        assert!(fit.rms().max_element() < 1e-11, "{:?}", fit.rms());
        for i in 0..=1000 {
            let t = i as f64 / 500.0 - 1.0;
            assert!(fit.at(t).0.abs_diff_eq(chebyshev(t), 1e-8), "at {t}: {} {}", fit.at(t).0, chebyshev(t));
        }
        assert!(fixed(&samples, 44).rms().x > 1e-3, "one degree less cannot do it");
    }

    #[test]
    fn the_basis_stays_orthogonal_at_degree_60() {
        let n = 900;
        let samples: Vec<DVec3> = (0..n).map(|i| DVec3::splat((i * 7919 % 101) as f64)).collect();
        let fit = fixed(&samples, 60);
        for k in 0..=60 {
            let mut unit = fit.clone();
            unit.coefficients = (0..=60).map(|j| if j == k { DVec3::ONE } else { DVec3::ZERO }).collect();
            let norm: f64 = (0..n).map(|i| unit.at(frame_t(i, n)).0.x.powi(2)).sum();
            assert!((norm - 1.0).abs() < 1e-9, "degree {k}: {norm}");
        }
    }

    #[test]
    fn value_at_a_sample_is_sample_minus_residual() {
        let samples: Vec<DVec3> = (0..50).map(|i| DVec3::new((i as f64 * 0.3).sin(), i as f64, 0.0)).collect();
        let fit = fixed(&samples, 9);
        for (i, sample) in samples.iter().enumerate() {
            let value = fit.at(frame_t(i, samples.len())).0;
            assert!(value.abs_diff_eq(*sample - fit.residuals()[i], 1e-12));
        }
    }

    #[test]
    fn the_derivative_agrees_with_finite_differences() {
        let samples: Vec<DVec3> = (0..400).map(|i| DVec3::new((i as f64 * 0.05).sin(), (i % 9) as f64, 1.0)).collect();
        let fit = fixed(&samples, 25);
        for i in 0..50 {
            let t = i as f64 / 25.5 - 0.97;
            let h = 1e-5;
            let difference = (fit.at(t + h).0 - fit.at(t - h).0) / (2.0 * h);
            assert!(fit.at(t).1.abs_diff_eq(difference, 1e-4), "{} {difference}", fit.at(t).1);
        }
    }

    #[test]
    fn the_smallest_sufficient_degree_is_taken() {
        let samples: Vec<DVec3> = (0..100).map(|i| DVec3::splat(frame_t(i, 100).powi(6))).collect();
        assert_eq!(PolynomialFit::fit(&samples, 1, 40, |rms| rms.x < 1e-9).degree(), 6);
        assert_eq!(PolynomialFit::fit(&samples, 1, 4, |rms| rms.x < 1e-9).degree(), 4);
    }

    #[test]
    fn one_and_two_samples_are_met_exactly() {
        let one = fixed(&[DVec3::new(3.0, 2.0, 1.0)], 5);
        assert_eq!((one.degree(), one.at(0.3).1), (0, DVec3::ZERO));
        assert!(one.at(0.3).0.abs_diff_eq(DVec3::new(3.0, 2.0, 1.0), 1e-15));
        let two = fixed(&[DVec3::ZERO, DVec3::splat(4.0)], 5);
        assert_eq!(two.degree(), 1);
        assert!(two.at(0.0).0.abs_diff_eq(DVec3::splat(2.0), 1e-14));
        assert!(two.at(0.0).1.abs_diff_eq(DVec3::splat(2.0), 1e-14));
    }
}
