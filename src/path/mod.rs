//! The path taken out of a clip and the motion carried along another one (METHOD 2 to 5).

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

/// The path fitted to a clip; to be written.
#[derive(Clone, Debug)]
pub struct OriginalPath {}

/// The path to walk; to be written.
#[derive(Clone, Debug)]
pub struct NewPath {}
