//! The path taken out of a clip and the motion carried along another one (METHOD 2 to 5).
//!
//! [`OriginalPath`] is fitted to the carrier, [`NewPath`] is drawn by the user, and both carry a moving frame, the
//! [`PathFrame`]. [`Residuals`] are what the original path leaves over; [`Timing`] says where along the new path each
//! edited frame stands; a residual applied in a new path's frame is the edited carrier. Everything here takes plain
//! slices, y-up, in the clip's unit; nothing knows of joints.

mod frame;
mod heading;
mod new_path;
mod original;
mod shapes;
mod timing;

pub use frame::{PathFrame, Residuals};
pub use heading::Headings;
pub use new_path::NewPath;
pub use original::{MAX_DEGREE, OriginalPath, degree_cap};
pub use shapes::{MAX_POINTS, Shape, ShapeError, ShapeKind, shape_points, straight_line};
pub use timing::{Cycling, Timing, TimingOptions, may_cycle};

/// Degree of the original path's polynomials.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Degree {
    /// The smallest degree whose horizontal residual RMS is under 0.05 H.
    #[default]
    Auto,
    /// This degree, 1 to 60, capped by the number of frames.
    Fixed(u32),
}

/// `residual.frame`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum ResidualFrame {
    /// Y up, Z along the horizontal heading.
    #[default]
    Heading,
    /// Z along the tangent, tilting with the slope.
    Tangent,
    /// Translation residual in world axes, orientation as in `Heading`.
    Absolute,
}

/// `timing.integrator`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Integrator {
    /// Gauss–Legendre per frame.
    #[default]
    Gauss,
    /// The thesis's Euler steps.
    Euler,
}
