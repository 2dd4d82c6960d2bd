//! Clamped B-splines of any degree with evenly spaced inner knots (METHOD 4).
//!
//! A spline is its control points. For evaluation each knot span also keeps its polynomial, as a Taylor series about
//! the middle of the span: spans are equally long in the parameter, so finding one is a multiplication and a point
//! costs one Horner pass. The series come from de Boor's algorithm on the derivative splines; fits use the basis
//! functions (Cox–de Boor). (L. Piegl, W. Tiller, The NURBS Book, chapters 2, 3 and 9.)

use glam::DVec3;
use nalgebra::{DMatrix, DVector};

/// Samples taken per knot span when a spline is fitted to another curve.
const SAMPLES_PER_SPAN: usize = 16;

/// Pull of the fit towards points of the curve itself, relative to the strongest control point: far below what a fit
/// can see, enough to decide control points that no sample reaches.
const FIT_RIDGE: f64 = 1e-13;

/// A clamped B-spline; parameter `u` in [0, 1], starts at the first control point and ends at the last.
#[derive(Clone, Debug, PartialEq)]
pub struct BSpline {
    /// At least 1.
    degree: usize,
    /// At least `degree + 1` of them.
    points: Vec<DVec3>,
    /// Taylor coefficients about the middle of each span, in units of one span: spans × (degree + 1).
    pieces: Vec<DVec3>,
}

impl BSpline {
    /// Makes a spline.
    ///
    /// # Panics
    ///
    /// When the degree is 0 or there are not more control points than the degree.
    pub fn new(degree: usize, points: Vec<DVec3>) -> Self {
        assert!(degree >= 1 && points.len() > degree, "a spline of degree k has at least k + 1 control points");
        let pieces = pieces(degree, &points);
        Self { degree, points, pieces }
    }

    /// Fits a spline of `n` control points to samples at parameters in [0, 1], least squares, through the first and
    /// last sample.
    ///
    /// # Panics
    ///
    /// When there are fewer than two samples, no parameter to each sample, or `n` is not above the degree.
    pub fn fit(degree: usize, n: usize, parameters: &[f64], samples: &[DVec3]) -> Self {
        assert!(samples.len() >= 2 && samples.len() == parameters.len() && n > degree);
        let (first, last) = (samples[0], samples[samples.len() - 1]);
        // The unknowns are offsets from a first guess: the samples where each control point has its greatest say.
        let mut points: Vec<DVec3> = (0..n).map(|i| sample_near(greville(degree, n, i), parameters, samples)).collect();
        (points[0], points[n - 1]) = (first, last);
        if n > 2 {
            let (normal, rhs) = normal_equations(degree, &points, parameters, samples);
            let solver = normal.cholesky().expect("the ridge makes the normal equations positive definite");
            let offsets = rhs.map(|axis| solver.solve(&axis));
            for (i, point) in points[1..n - 1].iter_mut().enumerate() {
                *point += DVec3::new(offsets[0][i], offsets[1][i], offsets[2][i]);
            }
        }
        Self::new(degree, points)
    }

    /// Returns a spline of another degree or number of control points that keeps the shape and the speed along it.
    ///
    /// # Panics
    ///
    /// When `n` is not above `degree`, or the degree is 0.
    pub fn refit(&self, degree: usize, n: usize) -> Self {
        if degree == self.degree && n == self.points.len() {
            return self.clone();
        }
        let n_samples = SAMPLES_PER_SPAN * self.n_spans().max(n - degree).max(degree + 1);
        let parameters: Vec<f64> = (0..=n_samples).map(|i| i as f64 / n_samples as f64).collect();
        let samples: Vec<DVec3> = parameters.iter().map(|&u| self.point(u)).collect();
        Self::fit(degree, n, &parameters, &samples)
    }

    /// Returns the degree.
    pub fn degree(&self) -> usize {
        self.degree
    }

    /// Returns the control points.
    pub fn control_points(&self) -> &[DVec3] {
        &self.points
    }

    /// Returns the number of polynomial pieces; they meet at even parameters.
    pub fn n_spans(&self) -> usize {
        self.points.len() - self.degree
    }

    /// Returns all knots, first and last repeated `degree + 1` times.
    pub fn knots(&self) -> Vec<f64> {
        knots(self.degree, self.points.len())
    }

    /// Returns the basis functions that are not zero at `u`, and the index of the first one's control point.
    pub fn basis(degree: usize, n: usize, u: f64) -> (usize, Vec<f64>) {
        let knots = knots(degree, n);
        let span = ((u * (n - degree) as f64) as usize).min(n - degree - 1) + degree;
        let mut values = vec![0.0; degree + 1];
        values[0] = 1.0;
        for k in 1..=degree {
            let mut carried = 0.0;
            for (r, value) in values[..k].iter_mut().enumerate() {
                let (right, left) = (knots[span + r + 1], knots[span + r + 1 - k]);
                let share = *value / (right - left);
                *value = carried + (right - u) * share;
                carried = (u - left) * share;
            }
            values[k] = carried;
        }
        (span - degree, values)
    }

    /// Returns the point at `u`, clamped to [0, 1].
    pub fn point(&self, u: f64) -> DVec3 {
        let (piece, x) = self.piece(u);
        piece.iter().rev().fold(DVec3::ZERO, |sum, &c| sum * x + c)
    }

    /// Returns the derivative by `u` at `u`, clamped to [0, 1].
    pub fn derivative(&self, u: f64) -> DVec3 {
        let (piece, x) = self.piece(u);
        let slope = (1..piece.len()).rev().fold(DVec3::ZERO, |sum, j| sum * x + piece[j] * j as f64);
        slope * self.n_spans() as f64
    }

    /// Returns the series about the middle of the span that holds `u`, and where `u` is in it, -0.5 to 0.5.
    fn piece(&self, u: f64) -> (&[DVec3], f64) {
        let along = u.clamp(0.0, 1.0) * self.n_spans() as f64;
        let span = (along as usize).min(self.n_spans() - 1);
        let stride = self.degree + 1;
        (&self.pieces[span * stride..(span + 1) * stride], along - span as f64 - 0.5)
    }
}

/// Returns the knots of a clamped spline with even inner knots.
fn knots(degree: usize, n: usize) -> Vec<f64> {
    let spans = (n - degree) as f64;
    (0..n + degree + 1).map(|i| (i as f64 - degree as f64).clamp(0.0, spans) / spans).collect()
}

/// Returns the Greville abscissa of control point `i`: the parameter where it has, about, its greatest say.
fn greville(degree: usize, n: usize, i: usize) -> f64 {
    knots(degree, n)[i + 1..=i + degree].iter().sum::<f64>() / degree as f64
}

/// Returns the samples' point at `u`, evenly between two of them.
fn sample_near(u: f64, parameters: &[f64], samples: &[DVec3]) -> DVec3 {
    let after = parameters.partition_point(|&p| p < u).clamp(1, samples.len() - 1);
    let (from, to) = (parameters[after - 1], parameters[after]);
    let share = if to > from { ((u - from) / (to - from)).clamp(0.0, 1.0) } else { 0.0 };
    samples[after - 1].lerp(samples[after], share)
}

/// Returns the normal equations for the offsets of the inner control points, right-hand sides per axis.
fn normal_equations(
    degree: usize,
    guess: &[DVec3],
    parameters: &[f64],
    samples: &[DVec3],
) -> (DMatrix<f64>, [DVector<f64>; 3]) {
    let n = guess.len();
    let mut normal: DMatrix<f64> = DMatrix::zeros(n - 2, n - 2);
    let mut rhs = [DVector::zeros(n - 2), DVector::zeros(n - 2), DVector::zeros(n - 2)];
    for (&u, &sample) in parameters.iter().zip(samples) {
        let (first, basis) = BSpline::basis(degree, n, u);
        let missing = sample - basis.iter().enumerate().map(|(j, &b)| guess[first + j] * b).sum::<DVec3>();
        let inner = |j: usize| (first + j).checked_sub(1).filter(|&i| i < n - 2);
        for (j, &b) in basis.iter().enumerate() {
            let Some(row) = inner(j) else { continue };
            for (axis, value) in rhs.iter_mut().zip(missing.to_array()) {
                axis[row] += b * value;
            }
            for (k, &c) in basis.iter().enumerate() {
                if let Some(column) = inner(k) {
                    normal[(row, column)] += b * c;
                }
            }
        }
    }
    let ridge = FIT_RIDGE * normal.diagonal().max().max(1.0);
    for i in 0..n - 2 {
        normal[(i, i)] += ridge;
    }
    (normal, rhs)
}

/// Returns the Taylor series of each span about its middle, in units of one span: spans × (degree + 1).
fn pieces(degree: usize, points: &[DVec3]) -> Vec<DVec3> {
    let n_spans = points.len() - degree;
    let stride = degree + 1;
    let all_knots = knots(degree, points.len());
    let mut pieces = vec![DVec3::ZERO; n_spans * stride];
    // Control points of the derivative of order `r`; its knots are the spline's without the outer `r` on each side.
    let mut polygon = points.to_vec();
    let mut scale = 1.0;
    for r in 0..=degree {
        let knots = &all_knots[r..all_knots.len() - r];
        for span in 0..n_spans {
            let middle = (span as f64 + 0.5) / n_spans as f64;
            pieces[span * stride + r] = de_boor(degree - r, knots, &polygon, span, middle) * scale;
        }
        scale /= (r + 1) as f64 * n_spans as f64;
        if r < degree {
            let k = degree - r;
            polygon = (0..polygon.len() - 1)
                .map(|i| (polygon[i + 1] - polygon[i]) * (k as f64 / (knots[i + k + 1] - knots[i + 1])))
                .collect();
        }
    }
    pieces
}

/// Returns the point at `u` in span number `span`, counted without the empty spans at the start.
fn de_boor(degree: usize, knots: &[f64], points: &[DVec3], span: usize, u: f64) -> DVec3 {
    let mut d = points[span..=span + degree].to_vec();
    for r in 1..=degree {
        for j in (r..=degree).rev() {
            let (left, right) = (knots[span + j], knots[span + j + degree + 1 - r]);
            let share = (u - left) / (right - left);
            d[j] = d[j - 1].lerp(d[j], share);
        }
    }
    d[degree]
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn wave(n: usize) -> Vec<DVec3> {
        (0..n).map(|i| DVec3::new(i as f64, (i as f64 * 1.3).sin(), (i * i % 5) as f64)).collect()
    }

    fn all_shapes() -> impl Iterator<Item = BSpline> {
        (1..=9).flat_map(|k| [k + 1, k + 2, k + 7].map(|n| BSpline::new(k, wave(n))))
    }

    #[test]
    fn basis_functions_sum_to_one_and_are_not_negative() {
        for (k, n) in [(1, 2), (3, 4), (3, 8), (9, 10), (9, 64), (2, 17)] {
            for i in 0..=200 {
                let u = i as f64 / 200.0;
                let (first, basis) = BSpline::basis(k, n, u);
                assert!(first + basis.len() <= n);
                assert!((basis.iter().sum::<f64>() - 1.0).abs() < 1e-13, "k {k} n {n} u {u}");
                assert!(basis.iter().all(|&b| b >= 0.0));
            }
        }
    }

    #[test]
    fn series_and_basis_functions_agree() {
        for spline in all_shapes() {
            for i in 0..=97 {
                let u = i as f64 / 97.0;
                let (first, basis) = BSpline::basis(spline.degree(), spline.points.len(), u);
                let by_basis: DVec3 = basis.iter().enumerate().map(|(j, &b)| spline.points[first + j] * b).sum();
                assert!(spline.point(u).abs_diff_eq(by_basis, 1e-11), "degree {} u {u}", spline.degree());
            }
        }
    }

    #[test]
    fn the_ends_are_met() {
        for spline in all_shapes() {
            assert!(spline.point(0.0).abs_diff_eq(spline.points[0], 1e-12));
            assert!(spline.point(1.0).abs_diff_eq(*spline.points.last().expect("not empty"), 1e-12));
            assert_eq!(spline.knots().len(), spline.points.len() + spline.degree() + 1);
        }
    }

    #[test]
    fn the_derivative_agrees_with_finite_differences() {
        for spline in all_shapes() {
            for i in 0..20 {
                // Away from the knots, where a spline of degree 1 has no derivative.
                let u = (i as f64 + 0.37) / 20.0;
                let h = 1e-7;
                let difference = (spline.point(u + h) - spline.point(u - h)) / (2.0 * h);
                let slope = spline.derivative(u);
                assert!(slope.abs_diff_eq(difference, 1e-5 * (1.0 + slope.length())), "{slope} {difference}");
            }
        }
    }

    #[test]
    fn a_bezier_curve_is_the_spline_without_inner_knots() {
        let p = wave(4);
        let spline = BSpline::new(3, p.clone());
        let bezier = p[0] * 0.125 + (p[1] + p[2]) * 0.375 + p[3] * 0.125;
        assert!(spline.point(0.5).abs_diff_eq(bezier, 1e-14));
    }

    #[test]
    fn even_points_on_a_line_stay_on_the_line() {
        let points: Vec<DVec3> = (0..8).map(|i| DVec3::new(i as f64, 2.0, 0.0)).collect();
        let spline = BSpline::new(3, points);
        for i in 0..=50 {
            let p = spline.point(i as f64 / 50.0);
            assert!((p.y - 2.0).abs() < 1e-14 && p.z == 0.0 && (-1e-14..=7.0 + 1e-14).contains(&p.x));
        }
    }

    #[test]
    fn a_refit_keeps_the_shape() {
        let spline = BSpline::new(3, wave(6));
        let there = spline.refit(5, 30);
        for i in 0..=100 {
            let u = i as f64 / 100.0;
            assert!(there.point(u).abs_diff_eq(spline.point(u), 1e-2), "{u}");
        }
        assert_eq!(spline.refit(3, 6), spline);
        // A polynomial is in every spline space of its degree or more: nothing is lost there and back.
        let polynomial = BSpline::new(3, wave(4));
        let back = polynomial.refit(7, 20).refit(3, 4);
        for (a, b) in back.points.iter().zip(&polynomial.points) {
            assert!(a.abs_diff_eq(*b, 1e-8), "{a} {b}");
        }
    }

    #[test]
    fn a_fit_to_two_samples_is_a_line() {
        let spline = BSpline::fit(3, 8, &[0.0, 1.0], &[DVec3::ZERO, DVec3::X]);
        assert!(spline.point(0.5).is_finite());
        assert!(spline.point(1.0).abs_diff_eq(DVec3::X, 1e-14));
    }

    proptest! {
        #[test]
        fn any_points_give_a_spline_inside_their_box(
            degree in 1usize..=9,
            points in prop::collection::vec(prop::array::uniform3(-5i32..5), 10..30),
            u in 0.0f64..=1.0,
        ) {
            // Small integers make coincident control points likely.
            let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let p = BSpline::new(degree, points).point(u);
            prop_assert!(p.is_finite() && p.abs().max_element() <= 5.0 + 1e-10);
        }
    }
}
