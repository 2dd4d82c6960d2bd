//! Ready paths: the straight line a new path starts as, and the shapes of `--shape` (METHOD 4).
//!
//! Every shape starts at the original path's first point. All but `chord` and `original` lie flat, set out along the
//! original path's heading there and are as long as asked, exactly: a shape is fitted at some size and then scaled by
//! the arc length of the spline that came out.

use std::{f64::consts::PI, fmt, str::FromStr};

use glam::DVec3;

use super::{OriginalPath, original::parameter};
use crate::{
    curve::{ArcLength, BSpline},
    math::{heading_rad, heading_rotation},
};

/// A net displacement under this share of the path's length gives no direction for the straight line.
const SHORTEST_NET: f64 = 0.1;
/// Largest distance of the shape `original` from the original path, in body heights, if enough points can reach it.
const ORIGINAL_ACCURACY: f64 = 0.02;
/// Most control points a path has: of a straight line, and of a shape that takes more than it was given.
pub const MAX_POINTS: usize = 64;
/// Samples that a shape is fitted to.
const N_SAMPLES: usize = 1024;
/// Legs of a zig-zag.
const N_LEGS: usize = 6;
/// Largest size that can be asked for.
const MAX_SIZE: f64 = 1000.0;

/// Kinds of ready paths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShapeKind {
    /// Straight ahead.
    Line,
    /// The thesis's: from the original path's first point to its last; `size` multiplies that distance.
    Chord,
    /// The original path's own shape, fitted.
    Original,
    /// Once round to the left.
    Circle,
    /// Straight legs with right-angled turns, left and right.
    Zigzag,
    /// Round to the left, then round to the right.
    Eight,
    /// There, half round to the left, and back.
    U,
    /// Half round to the left, half round to the right.
    S,
}

impl ShapeKind {
    /// All kinds with their names.
    pub const ALL: [(Self, &'static str); 8] = [
        (Self::Line, "line"),
        (Self::Chord, "chord"),
        (Self::Original, "original"),
        (Self::Circle, "circle"),
        (Self::Zigzag, "zigzag"),
        (Self::Eight, "eight"),
        (Self::U, "u"),
        (Self::S, "s"),
    ];

    /// Returns the name, as `--shape` takes it.
    pub fn name(self) -> &'static str {
        Self::ALL.iter().find(|(kind, _)| *kind == self).expect("all kinds are listed").1
    }
}

/// A ready path and its size.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Shape {
    /// Which one.
    pub kind: ShapeKind,
    /// Length over the original path's (for `Chord`: over the chord's); positive.
    pub size: f64,
}

/// A text that names no shape.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum ShapeError {
    /// The name is none of a shape.
    #[error("`{0}` is no shape; expected line, chord, original, circle, zigzag, eight, u or s")]
    Name(String),
    /// The size is not a positive number.
    #[error("`{0}` is no size; expected a number above 0, up to 1000")]
    Size(String),
}

impl FromStr for Shape {
    type Err = ShapeError;

    /// Reads `circle` or `circle:1.5`.
    fn from_str(text: &str) -> Result<Self, ShapeError> {
        let (name, size) = text.split_once(':').unwrap_or((text, "1"));
        let (kind, _) = ShapeKind::ALL
            .into_iter()
            .find(|(_, known)| *known == name.trim())
            .ok_or_else(|| ShapeError::Name(name.to_owned()))?;
        let parsed = size.trim().parse().ok().filter(|s: &f64| *s > 0.0 && *s <= MAX_SIZE);
        Ok(Self { kind, size: parsed.ok_or_else(|| ShapeError::Size(size.to_owned()))? })
    }
}

impl fmt::Display for Shape {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(self.kind.name())?;
        if self.size == 1.0 { Ok(()) } else { write!(f, ":{}", self.size) }
    }
}

impl Shape {
    /// Returns how many control points the shape needs to be itself; `Original` may take more.
    pub fn min_points(&self, degree: usize) -> usize {
        let enough = match self.kind {
            ShapeKind::Line | ShapeKind::Chord | ShapeKind::Original => 0,
            ShapeKind::Circle => [25, 13, 9][degree.clamp(1, 3) - 1],
            ShapeKind::Zigzag => N_LEGS + 1,
            ShapeKind::Eight => [33, 21, 15][degree.clamp(1, 3) - 1],
            ShapeKind::U => [21, 15, 11][degree.clamp(1, 3) - 1],
            ShapeKind::S => [21, 13, 11][degree.clamp(1, 3) - 1],
        };
        enough.max(degree + 1)
    }
}

/// Returns the control points a new path has before it is edited: evenly on a straight line, `n` of them.
///
/// From the original path's first point along its net direction, or along its first heading where it comes back, as
/// long as the original path; one body height ahead where the clip goes nowhere.
pub fn straight_line(original: &OriginalPath, n: usize) -> Vec<DVec3> {
    let frames = original.frames();
    let net = frames[frames.len() - 1].point - frames[0].point;
    let direction = if original.goes_nowhere() || net.length() < SHORTEST_NET * original.length() {
        ahead(original)
    } else {
        net.normalize_or(DVec3::Z)
    };
    even_line(frames[0].point, direction * own_length(original), n)
}

/// Returns the control points of a ready path: `n_points`, or more where the shape needs more.
pub fn shape_points(shape: Shape, original: &OriginalPath, n_points: usize, degree: usize) -> Vec<DVec3> {
    let n = n_points.max(shape.min_points(degree));
    let frames = original.frames();
    let start = frames[0].point;
    let length = shape.size * own_length(original);
    match shape.kind {
        ShapeKind::Line => even_line(start, ahead(original) * length, n),
        // A clip that goes nowhere has no chord worth the name.
        ShapeKind::Chord if original.goes_nowhere() => even_line(start, ahead(original) * length, n),
        ShapeKind::Chord => even_line(start, (frames[frames.len() - 1].point - start) * shape.size, n),
        ShapeKind::Original => {
            let spline = fitted_original(original, n, degree);
            scaled(start, spline.control_points(), degree, shape.size * original.length())
        }
        ShapeKind::Zigzag => laid_out(original, zigzag(n), degree, length),
        ShapeKind::Circle => laid_out(original, fitted(circle, n, degree), degree, length),
        ShapeKind::Eight => laid_out(original, fitted(eight, n, degree), degree, length),
        ShapeKind::U => laid_out(original, fitted(u, n, degree), degree, length),
        ShapeKind::S => laid_out(original, fitted(s, n, degree), degree, length),
    }
}

/// Returns the length that size 1 means: the original path's, or one body height where that goes nowhere.
fn own_length(original: &OriginalPath) -> f64 {
    if original.goes_nowhere() { original.height() } else { original.length() }
}

/// Returns the horizontal direction the original path sets out in.
fn ahead(original: &OriginalPath) -> DVec3 {
    heading_rotation(original.frames()[0].heading_rad) * DVec3::Z
}

fn even_line(start: DVec3, along: DVec3, n: usize) -> Vec<DVec3> {
    (0..n).map(|i| start + along * (i as f64 / (n.max(2) - 1) as f64)).collect()
}

/// Fits the original path's shape with as many points as it takes: exactly where its polynomials are of a degree that
/// the spline can be, else evenly in arc length.
fn fitted_original(original: &OriginalPath, n: usize, degree: usize) -> BSpline {
    let frames = original.frames();
    if original.degree() <= degree && frames.len() >= 2 * n {
        // Over time, as the polynomials are, a spline of their degree is the polynomials.
        let parameters: Vec<f64> = (0..frames.len()).map(|f| parameter(f, frames.len())).collect();
        let points: Vec<DVec3> = frames.iter().map(|frame| frame.point).collect();
        return BSpline::fit(degree, n, &parameters, &points);
    }
    let samples = original.polyline(N_SAMPLES);
    let parameters: Vec<f64> = (0..N_SAMPLES).map(|i| i as f64 / (N_SAMPLES - 1) as f64).collect();
    let mut n = n;
    loop {
        let spline = BSpline::fit(degree, n, &parameters, &samples);
        let worst = parameters.iter().zip(&samples).map(|(&u, p)| spline.point(u).distance(*p)).fold(0.0, f64::max);
        if worst <= ORIGINAL_ACCURACY * original.height() || n >= MAX_POINTS {
            return spline;
        }
        n = (n + n / 2).min(MAX_POINTS);
    }
}

/// Fits a flat shape that is given as (left, ahead) over its arc length in [0, 1].
fn fitted(shape: impl Fn(f64) -> (f64, f64), n: usize, degree: usize) -> Vec<DVec3> {
    let parameters: Vec<f64> = (0..N_SAMPLES).map(|i| i as f64 / (N_SAMPLES - 1) as f64).collect();
    let samples: Vec<DVec3> = parameters.iter().map(|&l| shape(l)).map(|(x, z)| DVec3::new(x, 0.0, z)).collect();
    BSpline::fit(degree, n, &parameters, &samples).control_points().to_vec()
}

/// Turns a flat shape that starts at the origin along +Z to the original path's start and heading, at a length.
fn laid_out(original: &OriginalPath, flat: Vec<DVec3>, degree: usize, length: f64) -> Vec<DVec3> {
    let first = &original.frames()[0];
    // A fit sets out a little aslant; the shape is turned so that its first leg is the heading exactly.
    let aslant = heading_rad(flat[1] - flat[0]).unwrap_or(0.0);
    let turn = heading_rotation(first.heading_rad - aslant);
    let points: Vec<DVec3> = flat.into_iter().map(|p| first.point + turn * p).collect();
    scaled(first.point, &points, degree, length)
}

/// Scales control points about the first so that their spline has this length.
fn scaled(start: DVec3, points: &[DVec3], degree: usize, length: f64) -> Vec<DVec3> {
    let spline = BSpline::new(degree, points.to_vec());
    let found = ArcLength::new(spline.n_spans(), |u| spline.derivative(u)).length();
    let scale = if found > 0.0 { length / found } else { 1.0 };
    points.iter().map(|&p| start + (p - start) * scale).collect()
}

/// Corners of the legs, the other points evenly between them.
fn zigzag(n: usize) -> Vec<DVec3> {
    let corner = |i: usize| DVec3::new((i / 2) as f64, 0.0, i.div_ceil(2) as f64);
    // Each corner takes the even point nearest to it, so that a corner is a corner at any number of points.
    let mut along: Vec<f64> = (0..n).map(|i| (N_LEGS * i) as f64 / (n - 1) as f64).collect();
    for leg in 1..N_LEGS {
        along[(leg * (n - 1) + N_LEGS / 2) / N_LEGS] = leg as f64;
    }
    along
        .into_iter()
        .map(|l| {
            let leg = (l as usize).min(N_LEGS - 1);
            corner(leg).lerp(corner(leg + 1), l - leg as f64)
        })
        .collect()
}

/// An arc of radius 1 that sets out along +Z to the left (+X) and has gone round by `angle`.
fn arc(angle: f64) -> (f64, f64) {
    (1.0 - angle.cos(), angle.sin())
}

fn circle(l: f64) -> (f64, f64) {
    arc(2.0 * PI * l)
}

fn eight(l: f64) -> (f64, f64) {
    let (left, ahead) = arc(4.0 * PI * l);
    if l < 0.5 { (left, ahead) } else { (-left, ahead) }
}

fn s(l: f64) -> (f64, f64) {
    let (left, ahead) = arc(2.0 * PI * l);
    if l < 0.5 { (left, ahead) } else { (4.0 - left, ahead) }
}

fn u(l: f64) -> (f64, f64) {
    // Legs as long as the bend.
    let along = 3.0 * PI * l;
    if along < PI {
        (0.0, along)
    } else if along < 2.0 * PI {
        let (left, ahead) = arc(along - PI);
        (left, PI + ahead)
    } else {
        (2.0, 3.0 * PI - along)
    }
}

#[cfg(test)]
mod tests {
    use super::super::Degree;
    use super::*;
    use crate::math::Rigid;
    use glam::DQuat;

    fn walk(to: impl Fn(f64) -> DVec3) -> OriginalPath {
        let carrier: Vec<Rigid> = (0..400).map(|f| Rigid::new(DQuat::IDENTITY, to(f as f64 / 399.0))).collect();
        OriginalPath::fit(&carrier, Degree::Fixed(13), 0.5, 1.7)
    }

    fn curvy() -> OriginalPath {
        walk(|u| DVec3::new(3.0 + 2.0 * (4.0 * u).sin(), 1.0 + 0.2 * u, 6.0 * u))
    }

    fn length(points: &[DVec3], degree: usize) -> f64 {
        let spline = BSpline::new(degree, points.to_vec());
        ArcLength::new(spline.n_spans(), |u| spline.derivative(u)).length()
    }

    #[test]
    fn shapes_read_and_print_as_text() {
        for (text, kind, size) in [("circle", ShapeKind::Circle, 1.0), ("u:1.5", ShapeKind::U, 1.5)] {
            let shape: Shape = text.parse().expect("a shape");
            assert_eq!(shape, Shape { kind, size });
            assert_eq!(shape.to_string(), text);
        }
        assert_eq!("ring".parse::<Shape>(), Err(ShapeError::Name("ring".to_owned())));
        for size in ["", "0", "-1", "nan", "inf", "two"] {
            assert_eq!(format!("circle:{size}").parse::<Shape>(), Err(ShapeError::Size(size.to_owned())));
        }
    }

    #[test]
    fn every_shape_is_as_long_as_asked_and_sets_out_ahead() {
        let original = curvy();
        for (kind, name) in ShapeKind::ALL {
            for degree in 1..=9 {
                for size in [0.5, 1.0, 3.0] {
                    let points = shape_points(Shape { kind, size }, &original, 8, degree);
                    assert!(points.len() >= Shape { kind, size }.min_points(degree) && points.len() <= MAX_POINTS);
                    assert!(points[0].abs_diff_eq(original.frames()[0].point, 1e-12), "{name}");
                    let own = match kind {
                        ShapeKind::Chord => original.frames()[399].point.distance(original.frames()[0].point),
                        _ => original.length(),
                    };
                    let found = length(&points, degree);
                    assert!((found / (own * size) - 1.0).abs() < 1e-9, "{name} {degree} {size}: {found}");
                    if !matches!(kind, ShapeKind::Chord | ShapeKind::Original) {
                        let out = (points[1] - points[0]).normalize();
                        assert!(out.abs_diff_eq(ahead(&original), 1e-9), "{name} {degree}: {out}");
                        assert!(points.iter().all(|p| (p.y - points[0].y).abs() < 1e-9), "{name} is flat");
                    }
                }
            }
        }
    }

    #[test]
    fn a_circle_is_round_and_closed() {
        let original = curvy();
        for degree in 1..=9 {
            let points = shape_points(Shape { kind: ShapeKind::Circle, size: 1.0 }, &original, 4, degree);
            assert!(points[points.len() - 1].abs_diff_eq(points[0], 1e-9));
            let spline = BSpline::new(degree, points);
            let radius = original.length() / (2.0 * PI);
            let around: Vec<DVec3> = (0..360).map(|i| spline.point(i as f64 / 360.0)).collect();
            let middle = around.iter().sum::<DVec3>() / 360.0;
            for p in around {
                assert!((p.distance(middle) / radius - 1.0).abs() < 0.03, "degree {degree}");
            }
        }
    }

    #[test]
    fn an_s_goes_round_to_the_left_and_then_to_the_right_without_a_corner() {
        for degree in 2..=9 {
            let original = walk(|u| DVec3::new(0.0, 1.0, 6.0 * u));
            let points = shape_points(Shape { kind: ShapeKind::S, size: 1.0 }, &original, 4, degree);
            let spline = BSpline::new(degree, points);
            let headings: Vec<f64> =
                (0..=400).map(|i| heading_rad(spline.derivative(f64::from(i) / 400.0)).expect("it goes on")).collect();
            let turns: Vec<f64> = headings.windows(2).map(|w| (w[1] - w[0] + PI).rem_euclid(2.0 * PI) - PI).collect();
            assert!(turns.iter().all(|turn| turn.abs() < 0.1), "degree {degree}: {turns:?}");
            let (there, back) = turns.split_at(200);
            let [there, back]: [f64; 2] = [there, back].map(|turns| turns.iter().sum());
            assert!((there - PI).abs() < 0.2 && (back + PI).abs() < 0.2, "degree {degree}: {there} {back}");
        }
    }

    #[test]
    fn the_original_shape_follows_the_original_path() {
        let original = curvy();
        let points = shape_points(Shape { kind: ShapeKind::Original, size: 1.0 }, &original, 8, 3);
        let spline = BSpline::new(3, points);
        for (i, p) in original.polyline(101).into_iter().enumerate() {
            assert!(spline.point(i as f64 / 100.0).distance(p) < 0.03 * original.height());
        }
    }

    #[test]
    fn the_straight_line_goes_where_the_walk_goes() {
        let straight = walk(|u| DVec3::new(4.0 * u, 1.0, 3.0 * u));
        let line = straight_line(&straight, 8);
        assert!(line[7].abs_diff_eq(DVec3::new(4.0, 1.0, 3.0), 1e-9));
        let round = walk(|u| DVec3::new(2.0 - 2.0 * (6.2 * u).cos(), 0.0, 2.0 * (6.2 * u).sin()));
        let line = straight_line(&round, 8);
        assert!((line[7].distance(line[0]) - round.length()).abs() < 1e-9);
        assert!((line[7] - line[0]).normalize().abs_diff_eq(ahead(&round), 1e-12));
        let still = walk(|_| DVec3::ONE);
        let line = straight_line(&still, 5);
        assert!(line[4].abs_diff_eq(DVec3::ONE + DVec3::Z * 1.7, 1e-12), "one body height ahead");
    }

    #[test]
    fn a_clip_that_goes_nowhere_has_every_shape() {
        let still = walk(|_| DVec3::ONE);
        for (kind, _) in ShapeKind::ALL {
            let points = shape_points(Shape { kind, size: 2.0 }, &still, 8, 3);
            assert!(points.iter().all(|p| p.is_finite()));
        }
    }
}
