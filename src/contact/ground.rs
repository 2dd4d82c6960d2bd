//! How the ground that a clip was walked on slopes: as the plane that its footprints lie in.
//!
//! A fitted path is the body's, and falls where the body crouches; the ground does not.

use glam::{DMat2, DVec2, DVec3};

use crate::math::smootherstep;

/// A slope up to the first of these is the capture's or the body's and none of the ground; from the second on it is all
/// the ground's: 3° and 6°.
const SLOPES_RAD: [f64; 2] = [0.052, 0.105];

/// Footprints spread less than this, in body heights, say little of a slope.
const SPREAD: f64 = 0.1;

/// Slopes of the ground along x and z.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct GroundSlope(DVec2);

impl GroundSlope {
    /// Fits a plane to footprints, least squares, held level where they do not spread; `height` is the body's. A slope so
    /// little that it is the capture's rather than the ground's is none.
    pub fn under(feet: &[DVec3], height: f64) -> Self {
        let n = feet.len().max(1) as f64;
        let mean = feet.iter().sum::<DVec3>() / n;
        let mut spread = DMat2::from_diagonal(DVec2::splat(n * (SPREAD * height).powi(2)));
        let mut rise = DVec2::ZERO;
        for d in feet.iter().map(|foot| *foot - mean) {
            let flat = DVec2::new(d.x, d.z);
            spread += DMat2::from_cols(flat * flat.x, flat * flat.y);
            rise += flat * d.y;
        }
        let slope = spread.inverse() * rise;
        Self(slope * ground_share(slope.length().atan()))
    }

    /// Returns how far the ground rises over a way, clip's unit.
    pub fn climb(self, by: DVec3) -> f64 {
        self.0.dot(DVec2::new(by.x, by.z))
    }

    /// Returns the slope in a heading, radians.
    pub fn in_heading_rad(self, heading_rad: f64) -> f64 {
        // Most ground is level, and every frame asks.
        if self == Self::default() { 0.0 } else { self.0.dot(DVec2::from(heading_rad.sin_cos())).atan() }
    }
}

/// Returns the share of a slope that counts as the ground's.
pub fn ground_share(slope_rad: f64) -> f64 {
    let [none, whole] = SLOPES_RAD;
    smootherstep((slope_rad.abs() - none) / (whole - none))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn footprints_on_a_hill_give_its_slope() {
        let hill = |x: f64, z: f64| DVec3::new(x, 3.0 + 0.1 * x - 0.2 * z, z);
        let feet: Vec<DVec3> = (0..40).map(|i| hill(f64::from(i % 7), f64::from(i))).collect();
        let slope = GroundSlope::under(&feet, 0.1);
        assert!((slope.in_heading_rad(0.0) - (-0.2f64).atan()).abs() < 1e-4, "{slope:?}");
        assert!((slope.in_heading_rad(std::f64::consts::FRAC_PI_2) - 0.1f64.atan()).abs() < 1e-4, "{slope:?}");
    }

    #[test]
    fn few_footprints_lie_level() {
        let near = [DVec3::ZERO, DVec3::new(0.01, 0.02, 0.0)];
        assert!(GroundSlope::under(&near, 1.7).in_heading_rad(1.0).abs() < 0.01);
        assert_eq!(GroundSlope::under(&[], 1.7).in_heading_rad(1.0), 0.0);
        let line: Vec<DVec3> = (0..9).map(|i| DVec3::new(0.0, 0.0, f64::from(i))).collect();
        assert_eq!(GroundSlope::under(&line, 1.7).in_heading_rad(1.5), 0.0);
    }
}
