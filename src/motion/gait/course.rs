//! The line that is walked along: straight, an arc to the left, straight again.

use glam::DVec3;

/// A line on the ground by arc length; begins at the origin along +z and goes on straight at both ends.
pub(super) struct Course {
    /// Length of the first straight.
    lead_in: f64,
    radius: f64,
    turn_rad: f64,
}

impl Course {
    /// 2 m ahead, then 45° with a radius of 5 m.
    pub(super) const BUILT_IN: Self = Self { lead_in: 200.0, radius: 500.0, turn_rad: std::f64::consts::FRAC_PI_4 };

    /// Heading at arc length `s`, from +z towards +x.
    pub(super) fn heading_rad(&self, s: f64) -> f64 {
        ((s - self.lead_in) / self.radius).clamp(0.0, self.turn_rad)
    }

    /// Point at arc length `s`.
    pub(super) fn point(&self, s: f64) -> DVec3 {
        let heading = self.heading_rad(s);
        let on_arc = self.radius * DVec3::new(1.0 - heading.cos(), 0.0, heading.sin());
        let on_straights = s - self.lead_in - self.radius * heading;
        let lead_in = DVec3::Z * self.lead_in;
        lead_in + on_arc + on_straights * forward(heading)
    }
}

/// Direction of a heading.
pub(super) fn forward(heading_rad: f64) -> DVec3 {
    DVec3::new(heading_rad.sin(), 0.0, heading_rad.cos())
}

/// Direction to the left of a heading.
pub(super) fn left(heading_rad: f64) -> DVec3 {
    DVec3::new(heading_rad.cos(), 0.0, -heading_rad.sin())
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn arc_length_is_arc_length_and_heading_is_the_tangent() {
        let course = Course::BUILT_IN;
        let step = 1e-3;
        for i in -100..900 {
            let s = f64::from(i);
            let chord = course.point(s + step) - course.point(s - step);
            assert!((chord.length() - 2.0 * step).abs() < 1e-9, "{s}");
            // The heading has a corner where the arc begins and ends; there the chord is off by up to this.
            assert!((chord / (2.0 * step) - forward(course.heading_rad(s))).length() < 2e-6, "{s}");
        }
        assert_eq!(course.point(0.0), DVec3::ZERO);
    }
}
