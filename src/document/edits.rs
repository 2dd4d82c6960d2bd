//! `Edits`: everything the user has decided, as one value.

use glam::DVec3;

use crate::{
    motion::ClipOptions,
    path::{Cycling, Degree, Integrator, ResidualFrame},
};

/// Everything the user has decided about a clip. Equal edits of equal sources give equal results.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Edits {
    /// How the file is read.
    pub clip: ClipEdits,
    /// The path fitted to the clip.
    pub original: OriginalEdits,
    /// What is carried along the path.
    pub residual: ResidualEdits,
    /// How headings are taken from paths.
    pub heading: HeadingEdits,
    /// The new path.
    pub path: PathEdits,
    /// Speed along the new path.
    pub timing: TimingEdits,
}

/// `clip.*`.
pub type ClipEdits = ClipOptions;

/// `original.*`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct OriginalEdits {
    /// Degree of the fitted polynomials.
    pub degree: Degree,
}

/// `residual.*`.
#[derive(Clone, Copy, Debug, Default, PartialEq)]
pub struct ResidualEdits {
    /// Frame in which residuals are kept.
    pub frame: ResidualFrame,
}

/// `heading.*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct HeadingEdits {
    /// Half the chord that defines a heading, in body heights, 0 to 3.
    pub window: f64,
}

impl Default for HeadingEdits {
    fn default() -> Self {
        Self { window: 0.5 }
    }
}

/// `path.*`.
#[derive(Clone, Debug, PartialEq)]
pub struct PathEdits {
    /// Off: the source's own path.
    pub edited: bool,
    /// Degree of the B-spline, 1 to 9.
    pub degree: usize,
    /// Number of control points, `degree + 1` to 64; equals the length of `control_points` when those are given.
    pub points: usize,
    /// Control points in y-up world axes, the clip's unit; none: the straight line.
    pub control_points: Option<Vec<DVec3>>,
    /// Step of one key press, body heights.
    pub nudge: f64,
}

impl Default for PathEdits {
    fn default() -> Self {
        Self { edited: true, degree: 3, points: 8, control_points: None, nudge: 0.1 }
    }
}

/// `timing.*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingEdits {
    /// Arc-length reparameterization.
    pub arc_length: bool,
    /// How arc length is integrated.
    pub integrator: Integrator,
    /// Euler step, share of the parameter range, 1e-6 to 0.1.
    pub step: f64,
    /// What happens on a path longer than the clip.
    pub cycling: Cycling,
    /// Playback rate, 0.05 to 4.
    pub speed: f64,
}

impl Default for TimingEdits {
    fn default() -> Self {
        Self { arc_length: true, integrator: Integrator::Gauss, step: 0.001, cycling: Cycling::Off, speed: 1.0 }
    }
}
