//! `OriginalPath`: the smooth path a carrier follows, fitted to it (METHOD 2).

use glam::DVec3;

use super::{Degree, Headings, Integrator, PathFrame, heading::tangent_directions};
use crate::{
    curve::{ArcLength, Cursor, PolynomialFit, euler_lengths},
    math::{Rigid, twist_rad},
};

/// Highest degree of the polynomials.
pub const MAX_DEGREE: u32 = 60;
/// `Degree::Auto` takes the first degree whose horizontal residual RMS is under this share of the body height.
const AUTO_RMS: f64 = 0.05;
/// A path none of whose points is farther from its first than this share of the body height goes nowhere.
const NOWHERE: f64 = 0.1;
/// A tangent shorter than this share of the mean one has no direction.
const SHORTEST_TANGENT: f64 = 1e-9;
/// Panels of the arc length table at least; a polynomial of a higher degree gets one for each.
const MIN_PANELS: usize = 8;

/// Returns the largest degree that makes sense on this many frames: high degrees on few samples oscillate.
pub fn degree_cap(n_frames: usize) -> usize {
    n_frames.saturating_sub(1).min((2.0 * (n_frames as f64).sqrt()) as usize)
}

/// The path fitted to a clip: polynomials against time, with headings and arc length.
#[derive(Clone, Debug)]
pub struct OriginalPath {
    fit: PolynomialFit,
    asked: Degree,
    arc: ArcLength,
    frames: Vec<PathFrame>,
    height: f64,
    goes_nowhere: bool,
}

impl OriginalPath {
    /// Fits a path to a carrier, one motion per frame without rest frames.
    ///
    /// `window_heights` is `heading.window` in body heights, `height` is `H` in the clip's unit.
    ///
    /// # Panics
    ///
    /// When there is no frame.
    pub fn fit(carrier: &[Rigid], degree: Degree, window_heights: f64, height: f64) -> Self {
        let positions: Vec<DVec3> = carrier.iter().map(|c| c.translation).collect();
        let cap = degree_cap(carrier.len());
        let fit = match degree {
            Degree::Auto => PolynomialFit::fit(&positions, 1, cap.min(MAX_DEGREE as usize), |rms| {
                rms.x.hypot(rms.z) < AUTO_RMS * height
            }),
            Degree::Fixed(d) => {
                let degree = cap.min(d.clamp(1, MAX_DEGREE) as usize);
                PolynomialFit::fit(&positions, degree, degree, |_| true)
            }
        };
        let points: Vec<DVec3> = positions.iter().zip(fit.residuals()).map(|(&p, &r)| p - r).collect();
        let goes_nowhere = points.iter().all(|p| p.distance(points[0]) < NOWHERE * height);
        let arc = ArcLength::new(fit.degree().max(MIN_PANELS), |u| velocity(&fit, u));

        let window = window_heights * height;
        let facing = twist_rad(carrier[0].rotation);
        let headings = if goes_nowhere && (window <= 0.0 || arc.length() < 2.0 * window) {
            Headings::Constant { heading_rad: facing, slope_rad: 0.0 }
        } else {
            let mut cursor = Cursor::default();
            Headings::along(arc.length(), window, facing, |s| point(&fit, arc.parameter_near(s, &mut cursor)))
        };
        let frames = path_frames(&fit, &arc, &headings, points, facing);
        Self { fit, asked: degree, arc, frames, height, goes_nowhere }
    }

    /// Returns the degree in use, after the rule of `auto` and the cap.
    pub fn degree(&self) -> usize {
        self.fit.degree()
    }

    /// Returns the degree that was asked for when the number of frames does not allow it.
    pub fn refused_degree(&self) -> Option<u32> {
        match self.asked {
            Degree::Fixed(d) if d as usize > self.degree() => Some(d),
            _ => None,
        }
    }

    /// Returns the arc length of the whole path, the clip's unit.
    pub fn length(&self) -> f64 {
        self.arc.length()
    }

    /// Returns the path frame `M0` of each frame.
    pub fn frames(&self) -> &[PathFrame] {
        &self.frames
    }

    /// Returns what the path leaves over, carrier minus path point, world axes, for each frame.
    pub fn deviations(&self) -> &[DVec3] {
        self.fit.residuals()
    }

    /// Returns the root mean square of the deviations, world axes.
    pub fn deviation_rms(&self) -> DVec3 {
        self.fit.rms()
    }

    /// Tells whether no point of the path is farther than a tenth of the body height from its first one.
    pub fn goes_nowhere(&self) -> bool {
        self.goes_nowhere
    }

    /// Returns the body height the path was made with.
    pub fn height(&self) -> f64 {
        self.height
    }

    /// Returns the point at an arc length, clamped to the path.
    pub fn point_at(&self, arc_length: f64) -> DVec3 {
        point(&self.fit, self.arc.parameter_at(arc_length))
    }

    /// Returns `n` points along the path, evenly in arc length, both ends included.
    pub fn polyline(&self, n: usize) -> Vec<DVec3> {
        let mut cursor = Cursor::default();
        (0..n)
            .map(|i| self.length() * i as f64 / (n.max(2) - 1) as f64)
            .map(|s| point(&self.fit, self.arc.parameter_near(s, &mut cursor)))
            .collect()
    }

    /// Returns the arc length of each frame, `s(f)` of METHOD 5; never falls.
    ///
    /// `step` is the Euler step, a share of the parameter range.
    pub fn progress(&self, integrator: Integrator, step: f64) -> Vec<f64> {
        let parameters: Vec<f64> = (0..self.frames.len()).map(|f| parameter(f, self.frames.len())).collect();
        match integrator {
            Integrator::Gauss => {
                let mut cursor = Cursor::default();
                let mut lengths: Vec<f64> = parameters.iter().map(|&u| self.arc.length_near(u, &mut cursor)).collect();
                // Where the path stands still, rounding may step back.
                for f in 1..lengths.len() {
                    lengths[f] = lengths[f].max(lengths[f - 1]);
                }
                lengths
            }
            Integrator::Euler => euler_lengths(step, &parameters, |u| velocity(&self.fit, u).length()),
        }
    }
}

/// Returns the parameter of a frame, in [0, 1].
pub(super) fn parameter(frame_idx: usize, n_frames: usize) -> f64 {
    frame_idx as f64 / (n_frames.max(2) - 1) as f64
}

/// Returns the path point at a parameter in [0, 1].
fn point(fit: &PolynomialFit, u: f64) -> DVec3 {
    fit.at(2.0 * u - 1.0).0
}

/// Returns the derivative of the path by the parameter in [0, 1].
fn velocity(fit: &PolynomialFit, u: f64) -> DVec3 {
    2.0 * fit.at(2.0 * u - 1.0).1
}

fn path_frames(
    fit: &PolynomialFit,
    arc: &ArcLength,
    headings: &Headings,
    points: Vec<DVec3>,
    fallback_rad: f64,
) -> Vec<PathFrame> {
    let n = points.len();
    let directions = if *headings == Headings::Tangent {
        let tangents = (0..n).map(|f| velocity(fit, parameter(f, n)));
        tangent_directions(tangents, SHORTEST_TANGENT * arc.length(), fallback_rad)
    } else {
        let mut cursor = Cursor::default();
        let lengths = (0..n).map(|f| arc.length_near(parameter(f, n), &mut cursor));
        lengths.map(|s| headings.at(s).expect("not the tangent's")).collect()
    };
    points
        .into_iter()
        .zip(directions)
        .map(|(point, (heading_rad, slope_rad))| PathFrame { point, heading_rad, slope_rad })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DQuat;
    use std::f64::consts::{PI, TAU};

    fn track(positions: impl Iterator<Item = DVec3>) -> Vec<Rigid> {
        positions.map(|p| Rigid::new(DQuat::from_rotation_y(0.3), p)).collect()
    }

    fn circle(n: usize, radius: f64) -> Vec<Rigid> {
        track((0..n).map(|f| {
            let angle = TAU * f as f64 / (n - 1) as f64;
            DVec3::new(radius * (1.0 - angle.cos()), 1.0, radius * angle.sin())
        }))
    }

    #[test]
    fn the_degree_is_capped_by_the_frames() {
        for (n, cap) in [(1, 0), (2, 1), (3, 2), (5, 4), (9, 6), (100, 20), (900, 60), (10_000, 200)] {
            assert_eq!(degree_cap(n), cap, "{n} frames");
        }
        let path = OriginalPath::fit(&circle(100, 2.0), Degree::Fixed(45), 0.5, 1.7);
        assert_eq!((path.degree(), path.refused_degree()), (20, Some(45)));
        let path = OriginalPath::fit(&circle(900, 2.0), Degree::Fixed(99), 0.5, 1.7);
        assert_eq!(path.degree(), 60);
    }

    #[test]
    fn auto_takes_the_smallest_degree_that_does() {
        let walk = circle(600, 3.0);
        let auto = OriginalPath::fit(&walk, Degree::Auto, 0.5, 1.7);
        let horizontal = |p: &OriginalPath| p.deviation_rms().x.hypot(p.deviation_rms().z);
        assert!(horizontal(&auto) < 0.05 * 1.7);
        let below = OriginalPath::fit(&walk, Degree::Fixed(auto.degree() as u32 - 1), 0.5, 1.7);
        assert!(horizontal(&below) >= 0.05 * 1.7);
    }

    #[test]
    fn a_circle_has_the_length_and_headings_of_a_circle() {
        let path = OriginalPath::fit(&circle(800, 3.0), Degree::Fixed(20), 0.5, 1.7);
        assert!((path.length() - 3.0 * TAU).abs() < 1e-6, "{}", path.length());
        let lengths = path.progress(Integrator::Gauss, 0.001);
        for (f, frame) in path.frames().iter().enumerate().skip(60).take(680) {
            let angle = TAU * f as f64 / 799.0;
            assert!((frame.heading_rad - angle).abs() < 1e-4, "{f}: {} {angle}", frame.heading_rad);
            assert!((lengths[f] - 3.0 * angle).abs() < 1e-5);
        }
        let plain = OriginalPath::fit(&circle(800, 3.0), Degree::Fixed(20), 0.0, 1.7);
        for (f, frame) in plain.frames().iter().enumerate().skip(10).take(780) {
            assert!((frame.heading_rad - TAU * f as f64 / 799.0).abs() < 1e-5);
        }
    }

    #[test]
    fn euler_progress_converges_to_gauss_at_first_order() {
        // Speeds up along the way, so that Euler is wrong at first order.
        let walk = track((0..300).map(|f| {
            let u = f as f64 / 299.0;
            DVec3::new(4.0 * u * u, 0.0, 3.0 * u + u * u * u)
        }));
        let path = OriginalPath::fit(&walk, Degree::Fixed(5), 0.5, 1.7);
        let exact = path.progress(Integrator::Gauss, 0.0);
        let error = |step| {
            let lengths = path.progress(Integrator::Euler, step);
            lengths.iter().zip(&exact).map(|(a, b)| (a - b).abs()).fold(0.0, f64::max)
        };
        let ratio = error(1e-2) / error(1e-3);
        assert!((ratio - 10.0).abs() < 0.5, "{ratio}");
        assert!(error(1e-4) < 1e-3);
    }

    #[test]
    fn clips_that_go_nowhere_face_as_the_actor_does() {
        let sway = |n: usize| track((0..n).map(|f| DVec3::new(0.02 * (f as f64 * 0.1).sin(), 1.0, 0.0)));
        for walk in [sway(1), sway(2), sway(3), sway(300), track((0..50).map(|_| DVec3::ONE))] {
            for window in [0.0, 0.5, 3.0] {
                let path = OriginalPath::fit(&walk, Degree::Auto, window, 1.7);
                assert!(path.goes_nowhere());
                for frame in path.frames() {
                    assert!(frame.point.is_finite() && (frame.heading_rad - 0.3).abs() < 1e-12);
                }
                let lengths = path.progress(Integrator::Euler, 0.01);
                assert!(lengths.iter().all(|l| l.is_finite()));
            }
        }
    }

    #[test]
    fn a_vertical_path_keeps_one_heading() {
        let climb = track((0..200).map(|f| DVec3::new(0.0, f as f64 * 0.05, 0.0)));
        for window in [0.0, 0.5] {
            let path = OriginalPath::fit(&climb, Degree::Fixed(3), window, 1.7);
            assert!(!path.goes_nowhere());
            assert!((path.length() - 199.0 * 0.05).abs() < 1e-9);
            for frame in path.frames() {
                assert_eq!(frame.heading_rad, path.frames()[0].heading_rad);
                assert!((frame.slope_rad - PI / 2.0).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn standing_still_at_the_ends_does_not_turn_the_heading() {
        let noisy = |f: usize| 1e-3 * ((f * 7919 % 97) as f64 / 97.0 - 0.5);
        let walk = track((0..900).map(|f| {
            let going = ((f as f64 - 300.0) / 300.0).clamp(0.0, 1.0);
            DVec3::new(noisy(f), 1.0, 4.0 * going + noisy(f + 31))
        }));
        let path = OriginalPath::fit(&walk, Degree::Fixed(30), 0.5, 1.7);
        let turns = path.frames().windows(2).map(|w| (w[1].heading_rad - w[0].heading_rad).abs());
        assert!(turns.fold(0.0, f64::max) < 0.02);
        assert!(path.frames().iter().all(|f| f.heading_rad.abs() < 0.1));
    }
}
