//! `NewPath`: the B-spline the user draws, walked by arc length (METHOD 4 and 5).

use glam::DVec3;

use super::{Headings, PathFrame, heading::tangent_directions};
use crate::{
    curve::{ArcLength, BSpline, Cursor},
    math::heading_rotation,
    sync::listed,
};

/// A tangent shorter than this share of the mean one has no direction.
const SHORTEST_TANGENT: f64 = 1e-9;

/// The path to walk.
#[derive(Clone, Debug)]
pub struct NewPath {
    spline: BSpline,
    arc: ArcLength,
    headings: Headings,
    window: f64,
    fallback_rad: f64,
}

impl NewPath {
    /// Makes a path of a spline.
    ///
    /// `window` is the heading window in the clip's unit; `fallback_rad` is the heading of a path that has none, such
    /// as a vertical one.
    pub fn new(spline: BSpline, window: f64, fallback_rad: f64) -> Self {
        let arc = ArcLength::new(spline.n_spans(), |u| spline.derivative(u));
        let mut cursor = Cursor::default();
        let headings =
            Headings::along(arc.length(), window, fallback_rad, |s| spline.point(arc.parameter_near(s, &mut cursor)));
        Self { spline, arc, headings, window, fallback_rad }
    }

    /// Returns the curve.
    pub fn spline(&self) -> &BSpline {
        &self.spline
    }

    /// Returns the heading window it was made with, the clip's unit.
    pub fn window(&self) -> f64 {
        self.window
    }

    /// Returns the heading it has where it has none.
    pub fn fallback_rad(&self) -> f64 {
        self.fallback_rad
    }

    /// Returns the arc length of the whole path, the clip's unit.
    pub fn length(&self) -> f64 {
        self.arc.length()
    }

    /// Returns the arc lengths up to parameters in [0, 1].
    pub fn lengths_at(&self, parameters: &[f64]) -> Vec<f64> {
        let mut cursor = Cursor::default();
        parameters.iter().map(|&u| self.arc.length_near(u, &mut cursor)).collect()
    }

    /// Returns control points of a path of the same shape with another number of them and another degree.
    ///
    /// # Panics
    ///
    /// When the degree is 0 or not below the number of points.
    pub fn refit(&self, n_points: usize, degree: usize) -> Vec<DVec3> {
        self.spline.refit(degree, n_points).control_points().to_vec()
    }

    /// Returns `n` points along the path, evenly in arc length, both ends included.
    pub fn polyline(&self, n: usize) -> Vec<DVec3> {
        let mut cursor = Cursor::default();
        (0..n)
            .map(|i| self.length() * i as f64 / (n.max(2) - 1) as f64)
            .map(|s| self.spline.point(self.arc.parameter_near(s, &mut cursor)))
            .collect()
    }

    /// Returns the path frame at an arc length; beyond its ends the path goes straight on.
    pub fn frame_at(&self, arc_length: f64) -> PathFrame {
        self.frames_along(&[arc_length])[0]
    }

    /// Returns the path frames at arc lengths; beyond its ends the path goes straight on. Quickest in rising order.
    pub fn frames_along(&self, arc_lengths: &[f64]) -> Vec<PathFrame> {
        if self.headings == Headings::Tangent {
            let mut cursor = Cursor::default();
            let parameters: Vec<f64> = arc_lengths.iter().map(|&s| self.arc.parameter_near(s, &mut cursor)).collect();
            let mut frames = self.tangent_frames(&parameters);
            for (frame, &s) in frames.iter_mut().zip(arc_lengths) {
                self.carry_on(frame, s);
            }
            return frames;
        }
        listed(arc_lengths.len(), |range| {
            let mut cursor = Cursor::default();
            let at = move |&s: &f64| {
                let mut frame = self.windowed_frame(self.arc.parameter_near(s, &mut cursor), s);
                self.carry_on(&mut frame, s);
                frame
            };
            arc_lengths[range].iter().map(at)
        })
    }

    /// Returns the path frames at parameters in [0, 1].
    pub fn frames_at_parameters(&self, parameters: &[f64]) -> Vec<PathFrame> {
        if self.headings == Headings::Tangent {
            return self.tangent_frames(parameters);
        }
        let mut cursor = Cursor::default();
        parameters.iter().map(|&u| self.windowed_frame(u, self.arc.length_near(u, &mut cursor))).collect()
    }

    fn windowed_frame(&self, u: f64, arc_length: f64) -> PathFrame {
        let (heading_rad, slope_rad) = self.headings.at(arc_length).expect("not the tangent's");
        PathFrame { point: self.spline.point(u), heading_rad, slope_rad }
    }

    fn tangent_frames(&self, parameters: &[f64]) -> Vec<PathFrame> {
        let tangents = parameters.iter().map(|&u| self.spline.derivative(u));
        tangent_directions(tangents, SHORTEST_TANGENT * self.length(), self.fallback_rad)
            .into_iter()
            .zip(parameters)
            .map(|((heading_rad, slope_rad), &u)| PathFrame { point: self.spline.point(u), heading_rad, slope_rad })
            .collect()
    }

    /// Moves a frame at an end of the path straight on to an arc length beyond it.
    fn carry_on(&self, frame: &mut PathFrame, arc_length: f64) {
        let beyond = arc_length - arc_length.clamp(0.0, self.length());
        if beyond != 0.0 {
            let (rise, run) = frame.slope_rad.sin_cos();
            let ahead = heading_rotation(frame.heading_rad) * DVec3::new(0.0, rise, run);
            frame.point += ahead * beyond;
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn path(points: Vec<DVec3>, window: f64) -> NewPath {
        NewPath::new(BSpline::new(3.min(points.len() - 1), points), window, 0.7)
    }

    fn bend() -> Vec<DVec3> {
        [(0.0, 0.0), (0.0, 3.0), (4.0, 3.0), (4.0, 0.0), (8.0, 1.0)].map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec()
    }

    #[test]
    fn a_straight_path_is_walked_evenly() {
        let points = (0..8).map(|i| DVec3::Z * i as f64).collect();
        let path = path(points, 0.5);
        assert!((path.length() - 7.0).abs() < 1e-12);
        for i in 0..=70 {
            let s = i as f64 * 0.1;
            let frame = path.frame_at(s);
            assert!(frame.point.abs_diff_eq(DVec3::Z * s, 1e-9), "{s}: {}", frame.point);
            assert!(frame.heading_rad.abs() < 1e-12);
        }
    }

    #[test]
    fn steps_along_the_path_are_as_long_as_the_arc() {
        let path = path(bend(), 0.5);
        let step = path.length() / 5000.0;
        let arc_lengths: Vec<f64> = (0..=5000).map(|i| i as f64 * step).collect();
        for pair in path.frames_along(&arc_lengths).windows(2) {
            let chord = pair[0].point.distance(pair[1].point);
            assert!((chord / step - 1.0).abs() < 1e-4, "{chord} {step}");
        }
    }

    #[test]
    fn beyond_its_ends_the_path_goes_straight_on() {
        for window in [0.0, 0.5, 99.0] {
            let path = path(bend(), window);
            let length = path.length();
            let (end, beyond) = (path.frame_at(length), path.frame_at(length + 2.0));
            assert!((beyond.point.distance(end.point) - 2.0).abs() < 1e-9);
            assert_eq!(beyond.heading_rad, end.heading_rad);
            let ahead = heading_rotation(end.heading_rad) * DVec3::Z;
            assert!((beyond.point - end.point).normalize().abs_diff_eq(ahead, 1e-9));
            assert!((path.frame_at(-1.0).point.distance(path.frame_at(0.0).point) - 1.0).abs() < 1e-9);
        }
    }

    #[test]
    fn parameters_and_arc_lengths_name_the_same_places() {
        for window in [0.0, 0.5] {
            let path = path(bend(), window);
            let parameters: Vec<f64> = (0..=20).map(|i| i as f64 / 20.0).collect();
            let arc_lengths = path.lengths_at(&parameters);
            for (a, b) in path.frames_at_parameters(&parameters).iter().zip(path.frames_along(&arc_lengths)) {
                assert!(a.point.abs_diff_eq(b.point, 1e-9));
                assert!((a.heading_rad - b.heading_rad).abs() < 1e-6);
            }
        }
    }

    #[test]
    fn coincident_points_and_vertical_paths_keep_the_fallback_heading() {
        for points in [vec![DVec3::ONE; 8], (0..6).map(|i| DVec3::Y * i as f64).collect()] {
            for window in [0.0, 0.5] {
                let path = path(points.clone(), window);
                for i in 0..10 {
                    let frame = path.frame_at(path.length() * i as f64 / 9.0);
                    assert!(frame.point.is_finite() && frame.heading_rad == 0.7);
                }
            }
        }
    }

    proptest! {
        #[test]
        fn any_control_points_give_finite_slow_headings(
            points in prop::collection::vec(prop::array::uniform3(-2i32..3), 4..12),
        ) {
            let points: Vec<DVec3> = points.into_iter().map(|p| DVec3::from_array(p.map(f64::from))).collect();
            let window = 0.25;
            let path = path(points, window);
            let arc_lengths: Vec<f64> = (0..=400).map(|i| path.length() * i as f64 / 400.0).collect();
            let frames = path.frames_along(&arc_lengths);
            let step = path.length() / 400.0;
            for pair in frames.windows(2) {
                prop_assert!(pair[1].point.is_finite());
                // Two grid steps is the shortest hairpin: half a turn over them, with room for the cubic between.
                let bound = 1.6 * std::f64::consts::PI * step / (window / 8.0) + 1e-9;
                prop_assert!((pair[1].heading_rad - pair[0].heading_rad).abs() <= bound);
            }
        }
    }
}
