//! The least place of a cost of few unknowns that bends sharply or has many least places, which steps downhill end short in.
//!
//! A cloud of points is drawn at random, moves to the better half of them and takes their shape, so that it grows along
//! valleys and shrinks across them. Only the order of the costs matters. CMA-ES after N. Hansen, *The CMA Evolution Strategy:
//! A Tutorial*, 2016, whose names and usual parameters are those below. The same is drawn every time.

use nalgebra::{DMatrix, DVector, SymmetricEigen};

use crate::sync::side_by_side;

/// The least variance along an axis of the cloud, of the largest one about.
const LEAST_VARIANCE: f64 = 1e-20;

/// Returns the best point that was drawn; none where none has a cost.
///
/// `n` unknowns begin at 0, spread by about `spread`; about `most_tries` points are tried, fewer once one costs no more
/// than `enough`.
pub(super) fn least(
    n: usize,
    spread: f64,
    most_tries: usize,
    enough: f64,
    cost: impl Fn(&[f64]) -> Option<f64> + Sync,
) -> Option<Vec<f64>> {
    let mut cloud = Cloud::new(n, spread);
    let mut best: Option<(f64, DVector<f64>)> = None;
    for _ in 0..most_tries / cloud.lambda {
        let drawn = cloud.drawn();
        let points: Vec<DVector<f64>> = drawn.iter().map(|y| &cloud.mean + cloud.sigma * y).collect();
        let costs = side_by_side(&points, |x| cost(x.as_slice()));
        let mut ranked: Vec<(f64, usize)> = (0..).zip(costs).filter_map(|(i, cost)| Some((cost?, i))).collect();
        if ranked.len() < cloud.weights.len() {
            break;
        }
        ranked.sort_by(|a, b| a.0.total_cmp(&b.0));
        let (least, first) = ranked[0];
        if best.as_ref().is_none_or(|(known, _)| least < *known) {
            best = Some((least, points[first].clone()));
        }
        if least <= enough {
            break;
        }
        cloud.follow(ranked.iter().map(|&(_, i)| &drawn[i]));
    }
    best.map(|(_, x)| x.as_slice().to_vec())
}

/// A normal distribution that follows the better half of what is drawn from it.
struct Cloud {
    n: f64,
    lambda: usize,
    /// Of the better half, the best first.
    weights: Vec<f64>,
    mu_eff: f64,
    mean: DVector<f64>,
    sigma: f64,
    covariance: DMatrix<f64>,
    /// Axes of the covariance and the spread along each.
    axes: DMatrix<f64>,
    spreads: DVector<f64>,
    path: DVector<f64>,
    sigma_path: DVector<f64>,
    noise: Noise,
}

impl Cloud {
    fn new(n: usize, sigma: f64) -> Self {
        let lambda = 2 * (4 + n.div_ceil(2)).max(8);
        let mu = lambda / 2;
        let raw: Vec<f64> = (0..mu).map(|i| (mu as f64 + 0.5).ln() - (i as f64 + 1.0).ln()).collect();
        let sum: f64 = raw.iter().sum();
        let weights: Vec<f64> = raw.iter().map(|w| w / sum).collect();
        Self {
            n: n as f64,
            lambda,
            mu_eff: weights.iter().map(|w| w * w).sum::<f64>().recip(),
            weights,
            mean: DVector::zeros(n),
            sigma,
            covariance: DMatrix::identity(n, n),
            axes: DMatrix::identity(n, n),
            spreads: DVector::from_element(n, 1.0),
            path: DVector::zeros(n),
            sigma_path: DVector::zeros(n),
            noise: Noise(1),
        }
    }

    /// Draws points, seen from the mean and in units of sigma.
    fn drawn(&mut self) -> Vec<DVector<f64>> {
        let n = self.mean.len();
        let mut draw = || {
            let z = DVector::from_fn(n, |_, _| self.noise.normal());
            &self.axes * self.spreads.component_mul(&z)
        };
        (0..self.lambda).map(|_| draw()).collect()
    }

    /// Moves to what was drawn, the best first.
    fn follow<'a>(&mut self, ranked: impl Iterator<Item = &'a DVector<f64>>) {
        let (n, mu_eff) = (self.n, self.mu_eff);
        let best: Vec<&DVector<f64>> = ranked.take(self.weights.len()).collect();
        let step = self.weights.iter().zip(&best).fold(DVector::zeros(self.mean.len()), |sum, (&w, &y)| sum + w * y);
        self.mean += self.sigma * &step;

        let c_sigma = (mu_eff + 2.0) / (n + mu_eff + 5.0);
        let whitened = &self.axes * (self.axes.transpose() * &step).component_div(&self.spreads);
        self.sigma_path = (1.0 - c_sigma) * &self.sigma_path + (c_sigma * (2.0 - c_sigma) * mu_eff).sqrt() * whitened;
        // The length that a normal vector has in the mean.
        let usual = n.sqrt() * (1.0 - 1.0 / (4.0 * n) + 1.0 / (21.0 * n * n));
        let longer = self.sigma_path.norm() / usual;

        let c_path = (4.0 + mu_eff / n) / (n + 4.0 + 2.0 * mu_eff / n);
        let goes_on = if longer < 1.4 + 2.0 / (n + 1.0) { (c_path * (2.0 - c_path) * mu_eff).sqrt() } else { 0.0 };
        self.path = (1.0 - c_path) * &self.path + goes_on * &step;

        let c_1 = 2.0 / ((n + 1.3).powi(2) + mu_eff);
        let c_mu = (1.0 - c_1).min(2.0 * (mu_eff - 2.0 + 1.0 / mu_eff) / ((n + 2.0).powi(2) + mu_eff));
        self.covariance *= 1.0 - c_1 - c_mu;
        self.covariance += c_1 * &self.path * self.path.transpose();
        for (&w, &y) in self.weights.iter().zip(&best) {
            self.covariance += c_mu * w * y * y.transpose();
        }
        let damping = 1.0 + 2.0 * (((mu_eff - 1.0) / (n + 1.0)).sqrt() - 1.0).max(0.0) + c_sigma;
        self.sigma *= (c_sigma / damping * (longer - 1.0)).exp();

        let SymmetricEigen { eigenvectors, eigenvalues } = SymmetricEigen::new(self.covariance.clone());
        self.axes = eigenvectors;
        self.spreads = eigenvalues.map(|variance| variance.max(LEAST_VARIANCE).sqrt());
    }
}

/// Numbers that look random (SplitMix64, S. Vigna).
struct Noise(u64);

impl Noise {
    /// From 0 to 1, 0 excluded.
    fn uniform(&mut self) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        (((z ^ (z >> 31)) >> 11) as f64 + 1.0) / (1u64 << 53) as f64
    }

    /// By G. Box and M. Muller, 1958.
    fn normal(&mut self) -> f64 {
        (-2.0 * self.uniform().ln()).sqrt() * (std::f64::consts::TAU * self.uniform()).cos()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Rosenbrock's valley: narrow, curved, least at 1 everywhere.
    fn valley(x: &[f64]) -> f64 {
        x.windows(2).map(|p| 100.0 * (p[1] - p[0] * p[0]).powi(2) + (1.0 - p[0]).powi(2)).sum()
    }

    #[test]
    fn a_curved_valley_is_followed_to_its_end() {
        for n in [2, 3, 6] {
            let found = least(n, 0.5, 20_000, 1e-12, |x| Some(valley(x))).expect("a point");
            assert!(found.iter().all(|x| (x - 1.0).abs() < 1e-4), "{found:?}");
        }
    }

    #[test]
    fn ripples_do_not_hold_it() {
        let rippled =
            |x: &[f64]| x.iter().map(|x| (x - 0.7) * (x - 0.7) + 0.05 * (1.0 - (40.0 * (x - 0.7)).cos())).sum::<f64>();
        let found = least(4, 0.5, 4000, 1e-9, |x| Some(rippled(x))).expect("a point");
        assert!(found.iter().all(|x| (x - 0.7).abs() < 1e-3), "{found:?}");
    }

    #[test]
    fn where_nothing_has_a_cost_nothing_is_found() {
        assert_eq!(least(3, 0.1, 100, 0.0, |_| None), None);
        assert_eq!(least(3, 0.1, 0, 0.0, |x| Some(x[0])), None);
    }
}
