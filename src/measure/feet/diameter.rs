//! The largest distance between two points of a plane, fast for many points.
//!
//! The two points that lie farthest apart are corners of the convex hull. Most points are thrown out first, those
//! inside the polygon of the points farthest out in eight directions (S. G. Akl and G. T. Toussaint, "A fast convex
//! hull algorithm", *Information Processing Letters* 7, 1978), so that little is left to sort.

/// Up to this many points every pair is looked at.
const FEW: usize = 8;

/// Returns the largest distance between two of the points (`x[i]`, `z[i]`); 0 for fewer than two.
pub(super) fn diameter(x: &[f64], z: &[f64]) -> f64 {
    if x.len() <= FEW {
        let points: Vec<[f64; 2]> = x.iter().zip(z).map(|(&x, &z)| [x, z]).collect();
        return farthest_pair(&points);
    }
    farthest_pair(&hull(outer(x, z)))
}

fn farthest_pair(points: &[[f64; 2]]) -> f64 {
    let mut largest = 0.0f64;
    for (at, a) in points.iter().enumerate() {
        for b in &points[at + 1..] {
            let (dx, dz) = (a[0] - b[0], a[1] - b[1]);
            largest = largest.max(dx * dx + dz * dz);
        }
    }
    largest.sqrt()
}

/// Returns the points that may be corners of the hull.
fn outer(x: &[f64], z: &[f64]) -> Vec<[f64; 2]> {
    // Eight directions, counterclockwise: (1, 0), (1, 1), …
    let along = |at: usize| [x[at], x[at] + z[at], z[at], z[at] - x[at]];
    let mut farthest = [0; 8];
    let mut extents = [f64::NEG_INFINITY; 8];
    for at in 0..x.len() {
        for (direction, v) in along(at).into_iter().enumerate() {
            if v > extents[direction] {
                (extents[direction], farthest[direction]) = (v, at);
            }
            if -v > extents[direction + 4] {
                (extents[direction + 4], farthest[direction + 4]) = (-v, at);
            }
        }
    }
    let corners = farthest.map(|at| [x[at], z[at]]);
    let inside = |p: [f64; 2]| {
        (0..8).all(|i| {
            let (a, b) = (corners[i], corners[(i + 1) % 8]);
            // An edge of no length bounds nothing.
            a == b || turn(a, b, p) > 0.0
        })
    };
    let is_polygon = corners.iter().any(|corner| *corner != corners[0]);
    let mut outer: Vec<_> = x.iter().zip(z).map(|(&x, &z)| [x, z]).filter(|&p| !(is_polygon && inside(p))).collect();
    outer.sort_unstable_by(|a, b| a[0].total_cmp(&b[0]).then(a[1].total_cmp(&b[1])));
    outer
}

/// Returns the corners of the convex hull of sorted points (A. M. Andrew's monotone chain, 1979).
fn hull(sorted: Vec<[f64; 2]>) -> Vec<[f64; 2]> {
    let mut corners: Vec<[f64; 2]> = Vec::new();
    let mut chain = |points: &mut dyn Iterator<Item = [f64; 2]>| {
        let from = corners.len();
        for p in points {
            while corners.len() >= from + 2 && turn(corners[corners.len() - 2], corners[corners.len() - 1], p) <= 0.0 {
                corners.pop();
            }
            corners.push(p);
        }
        corners.pop();
    };
    chain(&mut sorted.iter().copied());
    chain(&mut sorted.iter().rev().copied());
    corners
}

/// Returns a positive number where `c` lies to the left of the way from `a` to `b`.
fn turn(a: [f64; 2], b: [f64; 2], c: [f64; 2]) -> f64 {
    (b[0] - a[0]) * (c[1] - a[1]) - (b[1] - a[1]) * (c[0] - a[0])
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    #[test]
    fn few_or_equal_points_have_no_diameter() {
        assert_eq!(diameter(&[], &[]), 0.0);
        assert_eq!(diameter(&[1.0], &[2.0]), 0.0);
        assert_eq!(diameter(&[3.0; 50], &[4.0; 50]), 0.0);
    }

    #[test]
    fn points_on_a_line_are_as_far_apart_as_its_ends() {
        let x: Vec<f64> = (0..50).map(|i| f64::from((i * 7) % 50)).collect();
        let z: Vec<f64> = x.iter().map(|x| 2.0 * x + 1.0).collect();
        assert!((diameter(&x, &z) - 49.0 * 5f64.sqrt()).abs() < 1e-12);
    }

    proptest! {
        #![proptest_config(ProptestConfig { failure_persistence: None, ..ProptestConfig::default() })]

        /// Against every pair; few different values, so that points coincide and lie on lines.
        #[test]
        fn the_diameter_is_the_farthest_pair(points in prop::collection::vec((-5..5i32, -5..5i32), 0..60), share in 0.0..1.0f64) {
            let x: Vec<f64> = points.iter().map(|p| f64::from(p.0) + share * f64::from(p.1)).collect();
            let z: Vec<f64> = points.iter().map(|p| f64::from(p.1)).collect();
            let all: Vec<[f64; 2]> = x.iter().zip(&z).map(|(&x, &z)| [x, z]).collect();
            prop_assert!((diameter(&x, &z) - farthest_pair(&all)).abs() < 1e-12);
        }
    }
}
