//! Footprints stand at the path's height: what of the original path's height is the body's, and not the ground's.
//!
//! A fitted path goes through the body, so it sinks where the performer crouches, wavers as polynomials do and drifts
//! with the capture. Plain path editing takes all of that off whatever walks a level path, and the feet with the body
//! would stand in the air. Only where the new path has the same waver as the original one, because it was made of it,
//! is taking it off right. The waver is looked at in two parts, its straight trend and the rest, and of each part the
//! share that the new path does not repeat is given back.

use super::Prepared;
use crate::{contact::GroundSlope, path::PathFrame, sync::both};

impl Prepared {
    /// Returns what holding adds to plain path editing's height at each frame on such a path, clip's unit.
    pub fn lifts(&self, new: &[PathFrame], original: &[PathFrame]) -> Vec<f64> {
        lifts(new, original, self.slope)
    }
}

/// Returns what is to be added to plain path editing's height at each frame, clip's unit.
///
/// Nothing at the first frame, so that a path set out at the original one's start leaves the feet where they stood.
pub(super) fn lifts(new: &[PathFrame], original: &[PathFrame], ground: GroundSlope) -> Vec<f64> {
    let Some(first) = original.first() else { return Vec::new() };
    let climb = |at: &PathFrame| ground.climb(at.point - first.point);
    let (own, other) = both(
        original.len(),
        || Parts::of(original.iter().map(|at| at.point.y - climb(at))),
        || Parts::of(new.iter().zip(original).map(|(at, was)| at.point.y - climb(was))),
    );
    let (trend, waver) = own.not_in(&other);
    let lift = |frame: usize| trend * own.trend * frame as f64 + waver * own.waver[frame];
    let begin = lift(0);
    (0..original.len()).map(|frame| lift(frame) - begin).collect()
}

/// A height over the frames, as a straight line and what that leaves over.
struct Parts {
    /// Rise from frame to frame.
    trend: f64,
    waver: Vec<f64>,
}

impl Parts {
    /// Takes a height apart, least squares.
    fn of(heights: impl Iterator<Item = f64>) -> Self {
        let mut waver: Vec<f64> = heights.collect();
        let n = waver.len() as f64;
        let (mean, middle) = (waver.iter().sum::<f64>() / n, 0.5 * (n - 1.0));
        let along: f64 = waver.iter().enumerate().map(|(f, y)| (f as f64 - middle) * y).sum();
        let trend = if waver.len() > 1 { 12.0 * along / (n * (n * n - 1.0)) } else { 0.0 };
        for (frame, y) in waver.iter_mut().enumerate() {
            *y -= mean + trend * (frame as f64 - middle);
        }
        Self { trend, waver }
    }

    /// Returns the shares of both parts that another height does not repeat.
    fn not_in(&self, other: &Self) -> (f64, f64) {
        let dot = |a: &[f64], b: &[f64]| a.iter().zip(b).map(|(a, b)| a * b).sum::<f64>();
        let (own, its) = (dot(&self.waver, &self.waver), dot(&other.waver, &other.waver));
        let waver = missing(dot(&self.waver, &other.waver), own, its);
        (missing(self.trend * other.trend, self.trend.powi(2), other.trend.powi(2)), waver)
    }
}

/// Returns the share of one part that is missing in another, by their products with each other and with themselves:
/// none in the same, all of it in one that has nothing of it or is far larger and so something else.
fn missing(product: f64, own: f64, other: f64) -> f64 {
    let larger = own.max(other);
    if larger > 0.0 { 1.0 - (product / larger).clamp(0.0, 1.0) } else { 0.0 }
}

#[cfg(test)]
mod tests {
    use super::*;
    use glam::DVec3;

    const N: usize = 200;

    fn path(height: impl Fn(f64) -> f64) -> Vec<PathFrame> {
        let at = |f: usize| PathFrame {
            point: DVec3::new(0.0, height(f as f64), 0.02 * f as f64),
            heading_rad: 0.0,
            slope_rad: 0.0,
        };
        (0..N).map(at).collect()
    }

    fn most(values: impl Iterator<Item = f64>) -> f64 {
        values.map(f64::abs).fold(0.0, f64::max)
    }

    fn crouch(f: f64) -> f64 {
        0.9 - 0.2 * (-(f - 90.0).powi(2) / 800.0).exp() + 1e-4 * f
    }

    #[test]
    fn a_level_path_leaves_heights_alone() {
        let lifts = lifts(&path(|_| 0.7), &path(crouch), GroundSlope::default());
        assert!(most((0..N).map(|f| lifts[f] - (crouch(f as f64) - crouch(0.0)))) < 1e-12);
    }

    #[test]
    fn a_path_made_of_the_original_one_has_its_waver_already() {
        let own = path(crouch);
        assert!(lifts(&own, &own, GroundSlope::default()).iter().all(|lift| *lift == 0.0));
        let raised = lifts(&path(|f| crouch(f) + 0.4), &own, GroundSlope::default());
        assert!(most(raised.into_iter()) < 1e-12);
    }

    #[test]
    fn a_path_that_climbs_has_none_of_it() {
        let lifts = lifts(&path(|f| 0.05 * f), &path(crouch), GroundSlope::default());
        assert!((lifts[90] - (crouch(90.0) - crouch(0.0))).abs() < 0.01 && lifts[0] == 0.0, "{}", lifts[90]);
        assert!(super::lifts(&[], &[], GroundSlope::default()).is_empty());
        assert_eq!(super::lifts(&path(|_| 0.0)[..1], &path(crouch)[..1], GroundSlope::default()), [0.0]);
    }

    #[test]
    fn ground_that_slopes_is_left_behind() {
        // Footprints on a slope of 0.3 along z; the original path rises with it, the new one is level.
        let feet: Vec<DVec3> =
            (0..40).map(|i| DVec3::new(f64::from(i % 5), 0.3 * f64::from(i), f64::from(i))).collect();
        let slope = GroundSlope::under(&feet, 0.01);
        let lifts = lifts(&path(|_| 0.0), &path(|f| 0.3 * 0.02 * f), slope);
        assert!(most(lifts.into_iter()) < 1e-4);
    }
}
