//! Arc length along a curve and its inverse, exact to a billionth of the length whatever the curve (METHOD 5).
//!
//! The parameter range is cut into leaves on which the speed is a polynomial of degree 7 as far as anybody can tell:
//! it is taken at the eight Gauss–Legendre nodes, integrated as a polynomial (over a whole leaf that is the Gauss rule)
//! and checked at other places; a leaf that fails is halved. At a kink or where the curve stands still the leaves
//! shrink until what they could get wrong no longer counts. After that a length costs one Horner pass, and an inverse
//! another, through a few inverses found beforehand, and a Newton step or two kept inside their leaf.

use glam::DVec3;

/// Largest error of the speed inside a leaf, relative to the mean speed over the curve.
const SPEED_ACCURACY: f64 = 1e-10;
/// Error of length that a leaf may have whatever its speed does, relative to the whole length.
const LEAF_ACCURACY: f64 = 1e-13;
/// Error of length at which an inverse is found, relative to the whole length.
const INVERSE_ACCURACY: f64 = 1e-12;
/// Error of length, relative to a leaf's, after which one Newton step is the last.
const LAST_STEP: f64 = 1e-6;
/// Halvings after which a leaf is taken as it is; by then it is shorter than any error that counts.
const MAX_DEPTH: u32 = 44;
/// Newton or bisection steps after which an inverse is as near as numbers allow.
const MAX_STEPS: usize = 60;

const N: usize = 8;
/// Nodes of the Gauss–Legendre rule with eight points on [-1, 1].
const NODES: [f64; N] = [
    -0.960_289_856_497_536_3,
    -0.796_666_477_413_626_7,
    -0.525_532_409_916_329,
    -0.183_434_642_495_649_8,
    0.183_434_642_495_649_8,
    0.525_532_409_916_329,
    0.796_666_477_413_626_7,
    0.960_289_856_497_536_3,
];
/// Weights of the same rule.
const WEIGHTS: [f64; N] = [
    0.101_228_536_290_376_26,
    0.222_381_034_453_374_48,
    0.313_706_645_877_887_3,
    0.362_683_783_378_362,
    0.362_683_783_378_362,
    0.313_706_645_877_887_3,
    0.222_381_034_453_374_48,
    0.101_228_536_290_376_26,
];
/// Where a leaf's polynomial is checked: between the nodes and at the ends.
const CHECKS: [f64; 5] = [-1.0, -0.66, 0.0, 0.66, 1.0];

/// Arc length of a curve over its parameter in [0, 1].
#[derive(Clone, Debug, PartialEq)]
pub struct ArcLength {
    /// In order of the parameter, without gaps; never empty.
    leaves: Vec<Leaf>,
    length: f64,
}

/// A stretch of the parameter with the length along it as a polynomial.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Leaf {
    /// Parameter at the middle.
    middle: f64,
    /// Half the extent in the parameter.
    half: f64,
    /// Length up to the start of the leaf.
    start: f64,
    /// Length along the leaf.
    length: f64,
    /// About where a share of the length is, over the share in [-1, 1]: coefficients of `x` likewise.
    places: [f64; N],
    /// Length since the start of the leaf, over `x` in [-1, 1]: coefficients of 1, x, x², …
    series: [f64; N + 1],
}

/// Where the last query fell, so that a nearby one is found without a search.
#[derive(Clone, Copy, Debug, Default)]
pub struct Cursor {
    leaf: usize,
}

impl ArcLength {
    /// Measures a curve by its velocity, smooth between breaks at `i / n_panels` and anything finite elsewhere.
    ///
    /// # Panics
    ///
    /// When there is no panel.
    pub fn new(n_panels: usize, velocity: impl Fn(f64) -> DVec3) -> Self {
        assert!(n_panels > 0, "a curve has at least one panel");
        let from_nodes = speed_series();
        // Ends of a panel belong to it, not to its neighbour, whose speed may be another.
        let speed =
            |panel: usize, u: f64| velocity(u.clamp(inside(panel, n_panels, 0), inside(panel, n_panels, 1))).length();
        let half = 0.5 / n_panels as f64;
        let middle = |panel: usize| (panel as f64 + 0.5) / n_panels as f64;
        let rough: f64 = (0..n_panels)
            .map(|panel| {
                NODES.iter().zip(WEIGHTS).map(|(x, w)| w * speed(panel, middle(panel) + half * x)).sum::<f64>() * half
            })
            .sum();

        let mut leaves = Vec::with_capacity(4 * n_panels);
        let mut length = 0.0;
        let mut waiting = Vec::new();
        for panel in 0..n_panels {
            waiting.push((middle(panel), half, 0));
            while let Some((middle, half, depth)) = waiting.pop() {
                let at = |x: f64| speed(panel, middle + half * x);
                let (leaf, error) = Leaf::new(middle, half, length, &from_nodes, at);
                let exact = error <= SPEED_ACCURACY * rough || error * half <= LEAF_ACCURACY * rough;
                // A speed that is not a number would never be exact.
                if exact || depth == MAX_DEPTH || !error.is_finite() {
                    length += leaf.length;
                    leaves.push(leaf);
                } else {
                    waiting.push((middle + 0.5 * half, 0.5 * half, depth + 1));
                    waiting.push((middle - 0.5 * half, 0.5 * half, depth + 1));
                }
            }
        }
        Self { leaves, length }
    }

    /// Returns the length of the whole curve.
    pub fn length(&self) -> f64 {
        self.length
    }

    /// Returns the length up to a parameter, clamped to [0, 1].
    pub fn length_at(&self, u: f64) -> f64 {
        let leaf = self.leaves.partition_point(|leaf| leaf.middle + leaf.half < u);
        self.length_near(u, &mut Cursor { leaf })
    }

    /// Returns the length up to a parameter, clamped to [0, 1]; quick when the last query of the cursor was near.
    pub fn length_near(&self, u: f64, cursor: &mut Cursor) -> f64 {
        let leaf = self.leaf_near(cursor, |leaf| leaf.middle - leaf.half <= u);
        leaf.start + leaf.length_and_slope(((u - leaf.middle) / leaf.half).clamp(-1.0, 1.0)).0
    }

    /// Returns the parameter at a length, clamped to the curve.
    pub fn parameter_at(&self, length: f64) -> f64 {
        let leaf = self.leaves.partition_point(|leaf| leaf.start + leaf.length < length);
        self.parameter_near(length, &mut Cursor { leaf })
    }

    /// Returns the parameter at a length, clamped to the curve; quick when the last query of the cursor was near.
    pub fn parameter_near(&self, length: f64, cursor: &mut Cursor) -> f64 {
        let leaf = self.leaf_near(cursor, |leaf| leaf.start <= length);
        leaf.middle + leaf.half * leaf.place_of(length - leaf.start, INVERSE_ACCURACY * self.length)
    }

    /// Moves a cursor to the last leaf that has begun, the first if none has, and returns it.
    fn leaf_near(&self, cursor: &mut Cursor, has_begun: impl Fn(&Leaf) -> bool) -> &Leaf {
        let mut idx = cursor.leaf.min(self.leaves.len() - 1);
        while idx + 1 < self.leaves.len() && has_begun(&self.leaves[idx + 1]) {
            idx += 1;
        }
        while idx > 0 && !has_begun(&self.leaves[idx]) {
            idx -= 1;
        }
        cursor.leaf = idx;
        &self.leaves[idx]
    }
}

impl Leaf {
    /// Makes a leaf and returns the largest error of its speed that was seen.
    fn new(middle: f64, half: f64, start: f64, from_nodes: &[[f64; N]; N], speed: impl Fn(f64) -> f64) -> (Self, f64) {
        let values = NODES.map(&speed);
        let speeds = from_nodes.map(|row| row.iter().zip(values).map(|(m, v)| m * v).sum::<f64>());
        let error = CHECKS
            .map(|x| (speeds.iter().rev().fold(0.0, |sum, c| sum * x + c) - speed(x)).abs())
            .into_iter()
            .fold(0.0, |worst, e| if e <= worst { worst } else { e });
        let mut series = [0.0; N + 1];
        for (j, c) in speeds.iter().enumerate() {
            series[j + 1] = half * c / (j + 1) as f64;
        }
        // Length is counted from x = -1.
        series[0] = -series.iter().rev().fold(0.0, |sum, c| c - sum);
        let length = series.iter().sum::<f64>().max(0.0);
        let mut leaf = Self { middle, half, start, length, places: [0.0; N], series };
        let end_slopes = [-1.0, 1.0].map(|x| leaf.length_and_slope(x).1);
        let places = NODES.map(|share| {
            let share = 0.5 * (1.0 + share);
            leaf.place_from(leaf.guess(share, end_slopes), share * length, INVERSE_ACCURACY * length)
        });
        leaf.places = from_nodes.map(|row| row.iter().zip(places).map(|(m, x)| m * x).sum());
        (leaf, error)
    }

    /// Returns the length from the start of the leaf to `x`, and its derivative by `x`.
    ///
    /// Even and odd powers apart: four short chains of multiplications that a processor runs side by side.
    fn length_and_slope(&self, x: f64) -> (f64, f64) {
        let [c0, c1, c2, c3, c4, c5, c6, c7, c8] = self.series;
        let xx = x * x;
        let even = c0 + xx * (c2 + xx * (c4 + xx * (c6 + xx * c8)));
        let odd = c1 + xx * (c3 + xx * (c5 + xx * c7));
        let even_slope = 2.0 * c2 + xx * (4.0 * c4 + xx * (6.0 * c6 + xx * (8.0 * c8)));
        let odd_slope = c1 + xx * (3.0 * c3 + xx * (5.0 * c5 + xx * (7.0 * c7)));
        (even + x * odd, odd_slope + x * even_slope)
    }

    /// Returns the `x` in [-1, 1] at a length from the start of the leaf.
    fn place_of(&self, length: f64, accuracy: f64) -> f64 {
        let share = 2.0 * (length / self.length) - 1.0;
        let square = share * share;
        let [c0, c1, c2, c3, c4, c5, c6, c7] = self.places;
        let even = c0 + square * (c2 + square * (c4 + square * c6));
        let odd = c1 + square * (c3 + square * (c5 + square * c7));
        self.place_from((even + share * odd).clamp(-1.0, 1.0), length, accuracy)
    }

    /// The same, from a guess on (bracketed Newton).
    fn place_from(&self, guess: f64, length: f64, accuracy: f64) -> f64 {
        if length <= 0.0 || self.length <= 0.0 {
            return -1.0;
        }
        if length >= self.length {
            return 1.0;
        }
        let (mut low, mut high) = (-1.0, 1.0);
        let mut x = guess;
        for _ in 0..MAX_STEPS {
            let (value, slope) = self.length_and_slope(x);
            let error = value - length;
            if error.abs() <= accuracy {
                break;
            }
            if error < 0.0 {
                low = x
            } else {
                high = x
            }
            let newton = x - error / slope;
            let inside = newton > low && newton < high;
            x = if inside { newton } else { 0.5 * (low + high) };
            // Newton squares an error this small away, where the speed is not far below its mean.
            if inside && error.abs() < LAST_STEP * self.length && slope > 0.25 * self.length {
                break;
            }
        }
        x
    }

    /// Returns about where a share of the leaf's length is: a cubic with the right ends and, within reason, slopes.
    fn guess(&self, share: f64, end_slopes: [f64; 2]) -> f64 {
        // Beyond three times the mean slope a cubic turns back.
        let [from, to] = end_slopes.map(|slope| (self.length / slope).clamp(0.0, 6.0));
        let bend = 6.0 - 2.0 * from - to;
        let twist = from + to - 4.0;
        share * (from + share * (bend + share * twist)) - 1.0
    }
}

/// Returns a parameter just inside an end (0 or 1) of a panel, so that what is read there is the panel's own.
fn inside(panel: usize, n_panels: usize, end: usize) -> f64 {
    let edge = (panel + end) as f64 / n_panels as f64;
    if end == 0 { edge * (1.0 + f64::EPSILON) } else { edge * (1.0 - f64::EPSILON) }
}

/// Returns the matrix that turns a leaf's speeds at the nodes into coefficients of 1, x, x², …
///
/// By way of Legendre polynomials `P`: coefficient `j` of a function is `(2j + 1) / 2 · Σ w · P_j(x) · f(x)` over the
/// nodes, exactly so up to degree 7.
fn speed_series() -> [[f64; N]; N] {
    let mut legendre = [[0.0; N]; N];
    legendre[0][0] = 1.0;
    legendre[1][1] = 1.0;
    for j in 2..N {
        for power in 0..=j {
            let raised = if power > 0 { legendre[j - 1][power - 1] } else { 0.0 };
            let (a, b) = ((2 * j - 1) as f64, (j - 1) as f64);
            legendre[j][power] = (a * raised - b * legendre[j - 2][power]) / j as f64;
        }
    }
    let mut matrix = [[0.0; N]; N];
    for row in &legendre {
        let j = row.iter().rposition(|&c| c != 0.0).expect("no Legendre polynomial is zero");
        for (node, (x, w)) in NODES.iter().zip(WEIGHTS).enumerate() {
            let value = row.iter().rev().fold(0.0, |sum, c| sum * x + c);
            for (power, c) in row.iter().enumerate() {
                matrix[power][node] += c * (j as f64 + 0.5) * w * value;
            }
        }
    }
    matrix
}

#[cfg(test)]
mod tests {
    use super::super::BSpline;
    use super::*;
    use proptest::prelude::*;

    fn of_spline(spline: &BSpline) -> ArcLength {
        ArcLength::new(spline.n_spans(), |u| spline.derivative(u))
    }

    /// Length of y = a x² from 0 to x, in closed form.
    fn parabola_length(a: f64, x: f64) -> f64 {
        let r = (1.0 + 4.0 * a * a * x * x).sqrt();
        0.5 * x * r + (2.0 * a * x).asinh() / (4.0 * a)
    }

    #[test]
    fn a_parabola_has_its_closed_form_length_everywhere() {
        for a in [0.01, 1.0, 30.0, 1000.0] {
            // The Bézier curve of y = a x², x in [0, 1], whose parameter is x.
            let spline = BSpline::new(2, vec![DVec3::ZERO, DVec3::new(0.5, 0.0, 0.0), DVec3::new(1.0, a, 0.0)]);
            let arc = of_spline(&spline);
            let total = parabola_length(a, 1.0);
            assert!((arc.length() / total - 1.0).abs() < 1e-12, "a {a}: {} {total}", arc.length());
            for i in 0..=100 {
                let x = i as f64 / 100.0;
                assert!((arc.length_at(x) - parabola_length(a, x)).abs() < 1e-10 * total);
                let u = arc.parameter_at(parabola_length(a, x));
                assert!(spline.point(u).distance(spline.point(x)) < 1e-9 * total, "a {a} x {x} u {u}");
            }
        }
    }

    #[test]
    fn a_circle_has_the_length_of_a_circle() {
        use std::f64::consts::TAU;
        let arc = ArcLength::new(1, |u| DVec3::new(-(TAU * u).sin(), 0.0, (TAU * u).cos()) * (3.0 * TAU));
        assert!((arc.length() - 3.0 * TAU).abs() < 1e-11);
        assert!((arc.parameter_at(0.75 * TAU) - 0.25).abs() < 1e-11);
    }

    #[test]
    fn the_curve_may_stand_still_turn_back_and_bend_at_once() {
        // There and back along x with a cusp: position (u - 1/2)³ has speed 3 (u - 1/2)²; position (u - 1/2)² turns.
        let still = ArcLength::new(1, |u| DVec3::X * (3.0 * (u - 0.5_f64).powi(2)));
        assert!((still.length() - 0.25).abs() < 1e-13);
        assert!((still.parameter_at(0.125 + 1e-3) - 0.6).abs() < 1e-9);
        let cusp = ArcLength::new(1, |u| DVec3::X * (2.0 * (u - 0.3)));
        let expected = 0.3 * 0.3 + 0.7 * 0.7;
        assert!((cusp.length() - expected).abs() < 1e-11);
        assert!((cusp.length_at(0.3) - 0.09).abs() < 1e-11);
        assert!((cusp.parameter_at(0.09 + 0.04) - 0.5).abs() < 1e-9);
    }

    #[test]
    fn corners_of_a_polygon_are_exact() {
        let corners = vec![DVec3::ZERO, DVec3::X, DVec3::X, DVec3::new(1.0, 0.0, 3.0), DVec3::new(1.0, 0.0, 1.0)];
        let spline = BSpline::new(1, corners);
        let arc = of_spline(&spline);
        assert!((arc.length() - 6.0).abs() < 1e-12);
        assert!(spline.point(arc.parameter_at(1.0 + 3.0)).abs_diff_eq(DVec3::new(1.0, 0.0, 3.0), 1e-9));
        assert!(spline.point(arc.parameter_at(5.0)).abs_diff_eq(DVec3::new(1.0, 0.0, 2.0), 1e-9));
    }

    #[test]
    fn a_curve_without_length_stays_at_its_start() {
        let arc = of_spline(&BSpline::new(3, vec![DVec3::ONE; 8]));
        assert_eq!(arc.length(), 0.0);
        for s in [-1.0, 0.0, 1.0] {
            assert!((0.0..=1.0).contains(&arc.parameter_at(s)));
        }
        assert_eq!(arc.length_at(0.5), 0.0);
    }

    #[test]
    fn a_cursor_finds_what_a_search_finds() {
        let points = (0..20).map(|i| DVec3::new((i * i % 7) as f64, 0.0, i as f64)).collect();
        let spline = BSpline::new(3, points);
        let arc = of_spline(&spline);
        let mut cursor = Cursor::default();
        for i in [0, 1, 2, 50, 51, 49, 3, 99, 100, 0] {
            let s = arc.length() * i as f64 / 100.0;
            assert!((arc.parameter_near(s, &mut cursor) - arc.parameter_at(s)).abs() < 1e-11);
        }
    }

    proptest! {
        #[test]
        fn lengths_invert_on_any_spline(
            degree in 1usize..=9,
            points in prop::collection::vec(prop::array::uniform3(-3i32..3), 10..16),
            share in 0.0f64..=1.0,
        ) {
            let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let arc = of_spline(&BSpline::new(degree, points));
            let s = share * arc.length();
            prop_assert!((arc.length_at(arc.parameter_at(s)) - s).abs() <= 1e-10 * arc.length());
            // A fine sum of chords of the same curve never exceeds the length, and comes close.
            prop_assert!(arc.leaves.len() < 20_000);
        }

        #[test]
        fn the_length_is_that_of_fine_chords(
            points in prop::collection::vec(prop::array::uniform3(-3i32..3), 4..9),
        ) {
            let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let spline = BSpline::new(3, points);
            let chords = super::super::Chords::new(1e-4, |u| spline.point(u)).length();
            prop_assert!((of_spline(&spline).length() - chords).abs() <= 1e-5 * (1e-9 + chords));
        }
    }
}
