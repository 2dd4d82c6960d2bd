//! Curves: polynomials fitted to samples, clamped B-splines, and arc length along either (METHOD 2, 4 and 5).
//!
//! Nothing here knows of clips or paths. A curve is a function of a parameter in [0, 1] (or of `t` in [-1, 1] for
//! polynomials, whose basis lives there), in whatever unit of length its points have.

mod arc_length;
mod bspline;
mod euler;
mod polynomial;

pub use arc_length::{ArcLength, Cursor};
pub use bspline::BSpline;
pub use euler::{Chords, euler_lengths};
pub use polynomial::{PolynomialFit, frame_t};
