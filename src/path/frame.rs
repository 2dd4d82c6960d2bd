//! The moving frame of a path and the residuals kept in it (METHOD 2 and 3).

use glam::{DQuat, DVec3};

use super::ResidualFrame;
use crate::math::{Rigid, heading_rotation};

/// Where a path is and which way it goes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PathFrame {
    /// Point of the path, world, clip's unit.
    pub point: DVec3,
    /// Heading about up, unwrapped along the path.
    pub heading_rad: f64,
    /// Slope above the horizontal, −π/2 to π/2.
    pub slope_rad: f64,
}

impl PathFrame {
    /// Returns the frame's orientation: Z along the path, X horizontal; tilted with the slope only in `Tangent`.
    #[inline]
    pub fn rotation(&self, frame: ResidualFrame) -> DQuat {
        let turn = heading_rotation(self.heading_rad);
        match frame {
            ResidualFrame::Heading | ResidualFrame::Absolute => turn,
            // A turn about X takes Z down, so a slope up is a negative one.
            ResidualFrame::Tangent => turn * DQuat::from_rotation_x(-self.slope_rad),
        }
    }

    /// Returns the frame as a motion from path space to the world: the pose of a block that tracks the path.
    pub fn rigid(&self, frame: ResidualFrame) -> Rigid {
        Rigid::new(self.rotation(frame), self.point)
    }
}

/// What the original path does not say of a motion, frame by frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Residuals {
    /// The frame they are kept in.
    pub frame: ResidualFrame,
    /// One per frame: orientation in the path frame; translation in the path frame, or along the world's axes when
    /// the frame is `Absolute`.
    pub motions: Vec<Rigid>,
}

impl Residuals {
    /// Takes the path out of a motion.
    pub fn of(carrier: &[Rigid], path: &[PathFrame], frame: ResidualFrame) -> Self {
        let motions = carrier
            .iter()
            .zip(path)
            .map(|(world, at)| {
                let back = at.rotation(frame).conjugate();
                let offset = world.translation - at.point;
                let translation = if frame == ResidualFrame::Absolute { offset } else { back * offset };
                Rigid::new(back * world.rotation, translation)
            })
            .collect();
        Self { frame, motions }
    }

    /// Carries the residual of a frame along a path.
    #[inline]
    pub fn apply(&self, frame_idx: usize, at: &PathFrame) -> Rigid {
        let residual = &self.motions[frame_idx];
        let turn = at.rotation(self.frame);
        let offset =
            if self.frame == ResidualFrame::Absolute { residual.translation } else { turn * residual.translation };
        Rigid::new(turn * residual.rotation, at.point + offset)
    }

    /// Returns where the path must have been for a carrier to be where it is: the inverse of [`Self::apply`].
    #[inline]
    pub fn removed(&self, frame_idx: usize, carrier: &Rigid) -> DVec3 {
        let residual = &self.motions[frame_idx];
        if self.frame == ResidualFrame::Absolute {
            carrier.translation - residual.translation
        } else {
            // The path frame's orientation is the carrier's without the residual one.
            let turn = carrier.rotation * residual.rotation.conjugate();
            carrier.translation - turn * residual.translation
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    const FRAMES: [ResidualFrame; 3] = [ResidualFrame::Heading, ResidualFrame::Tangent, ResidualFrame::Absolute];

    fn carrier() -> Rigid {
        Rigid::new(DQuat::from_rotation_y(0.4) * DQuat::from_rotation_x(1.0), DVec3::new(1.0, 2.0, -3.0))
    }

    fn at(heading_rad: f64, slope_rad: f64) -> PathFrame {
        PathFrame { point: DVec3::new(0.5, 0.0, 9.0), heading_rad, slope_rad }
    }

    #[test]
    fn a_residual_applied_where_it_was_taken_gives_the_motion_back() {
        for frame in FRAMES {
            let path = at(0.9, 0.3);
            let residuals = Residuals::of(&[carrier()], &[path], frame);
            let back = residuals.apply(0, &path);
            assert!(back.translation.abs_diff_eq(carrier().translation, 1e-14));
            assert!(back.rotation.abs_diff_eq(carrier().rotation, 1e-14));
            let elsewhere = at(-2.0, -0.4);
            let removed = residuals.removed(0, &residuals.apply(0, &elsewhere));
            assert!(removed.abs_diff_eq(elsewhere.point, 1e-13));
        }
    }

    #[test]
    fn only_the_tangent_frame_tilts() {
        let uphill = at(0.7, 0.5);
        let forward = |frame| uphill.rotation(frame) * DVec3::Z;
        let (sin, cos) = (0.5f64.sin(), 0.5f64.cos());
        let expected = DVec3::new(cos * 0.7f64.sin(), sin, cos * 0.7f64.cos());
        assert!(forward(ResidualFrame::Tangent).abs_diff_eq(expected, 1e-14));
        assert!(forward(ResidualFrame::Heading).y.abs() < 1e-15);
        assert!((uphill.rotation(ResidualFrame::Tangent) * DVec3::X).y.abs() < 1e-15, "the side stays level");
    }

    #[test]
    fn absolute_residuals_keep_their_place_in_the_world() {
        let residuals = Residuals::of(&[carrier()], &[at(0.0, 0.0)], ResidualFrame::Absolute);
        let moved = residuals.apply(0, &at(2.0, 0.0));
        assert!(moved.translation.abs_diff_eq(carrier().translation, 1e-15));
    }
}
