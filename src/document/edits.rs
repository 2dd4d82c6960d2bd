//! `Edits`: everything the user has decided, as one value.

use glam::DVec3;

use super::Cleared;
use crate::{
    constrain::Ground,
    contact::{PlantEdit, Thresholds},
    displace::{InterpolationKeys, Layer},
    motion::ClipOptions,
    path::{Cycling, Degree, Integrator, ResidualFrame},
};

/// Everything the user has decided about a clip. Equal edits of equal sources give equal results.
///
/// Vectors are in the clip's own axes and unit, as people and project files write them; the solve turns them y-up.
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
    /// What blended cycling repeats.
    pub loops: LoopEdits,
    /// How foot plants are found and held.
    pub plants: PlantsEdits,
    /// Plants edited by hand (`plant`), in file frames.
    pub edited_plants: Vec<PlantEdit>,
    /// Displacement maps, bottom to top (`layer`).
    pub layers: Vec<Layer>,
    /// Frames between which the clip's own motion is replaced (`interpolation_keys`).
    pub interpolation_keys: Option<InterpolationKeys>,
    /// Which of the clip's own data take no part.
    pub cleared: Cleared,
    /// How keys move and turn joints.
    pub pose: PoseEdits,
    /// What is drawn and from where; saved with a project, outside undo.
    pub view: ViewEdits,
}

impl Edits {
    /// Tells whether nothing but layers is other than in others.
    pub(super) fn differ_in_layers(&self, others: &Self) -> bool {
        self.layers != others.layers && *self == Self { layers: self.layers.clone(), ..others.clone() }
    }

    /// Returns the edits without what only says how one looks at them: what is drawn, from where, and how fast it plays.
    pub(super) fn work(&self) -> Self {
        let timing = TimingEdits { speed: TimingEdits::default().speed, ..self.timing };
        Self { view: ViewEdits::default(), timing, ..self.clone() }
    }
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
    /// Control points in the clip's axes and unit; none: the straight line.
    pub control_points: Option<Vec<DVec3>>,
    /// Step of one key press, body heights.
    pub nudge: f64,
}

impl Default for PathEdits {
    fn default() -> Self {
        Self { edited: true, degree: 3, points: 8, control_points: None, nudge: 0.1 }
    }
}

/// `plants.*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PlantsEdits {
    /// How plants are found.
    pub detection: Thresholds,
    /// Feet stay where they stand on the new path.
    pub hold: bool,
    /// The foot's own slide in a plant is removed, but for plants whose mode was chosen.
    pub clean: bool,
    /// How planted feet stand on a path that climbs.
    pub ground: Ground,
}

impl Default for PlantsEdits {
    fn default() -> Self {
        Self { detection: Thresholds::default(), hold: true, clean: false, ground: Ground::Ramp }
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

/// `loop.*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct LoopEdits {
    /// First file frame of the loop; none: the best one found.
    pub start: Option<usize>,
    /// File frame after the loop's last one; none: the best one found.
    pub end: Option<usize>,
    /// Time on each side of a seam over which its mismatch is spread, seconds, 0 to 2.
    pub blend: f64,
}

impl Default for LoopEdits {
    fn default() -> Self {
        Self { start: None, end: None, blend: 0.2 }
    }
}

/// `pose.*`.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct PoseEdits {
    /// How far one key press moves a joint, body heights.
    pub nudge: f64,
    /// How far one key press turns a joint, degrees.
    pub turn: f64,
    /// Along and about what.
    pub axes: Axes,
}

impl Default for PoseEdits {
    fn default() -> Self {
        Self { nudge: 0.02, turn: 5.0, axes: Axes::World }
    }
}

/// `pose.axes`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Axes {
    /// The clip's.
    #[default]
    World,
    /// The view's: right, up, towards the eye.
    View,
    /// Those of the joint's parent.
    Parent,
    /// The joint's own.
    Own,
}

/// `show.*`, `camera.*`, `view.*` and `second.*`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ViewEdits {
    /// What is drawn.
    pub show: Show,
    /// The four camera presets.
    pub cameras: [CameraEdits; 4],
    /// How the preview's window and its second window are divided.
    pub windows: [WindowEdits; 2],
}

/// `view.*`, and `second.*` for the second window: into which views a window is divided.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct WindowEdits {
    /// How many of `views` it shows: 1, 2 or 4.
    pub layout: usize,
    /// Its views, those that are not shown too.
    pub views: [OneViewEdits; 4],
}

impl Default for WindowEdits {
    fn default() -> Self {
        Self { layout: 1, views: [0, 1, 2, 3].map(|camera_idx| OneViewEdits { camera_idx, shows: Show::ALL }) }
    }
}

/// `view.N.*`: one view of a window.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct OneViewEdits {
    /// Camera preset it is seen from, 0 to 3.
    pub camera_idx: usize,
    /// What it shows of what `show.*` draws; what it does not is its `hide`.
    pub shows: Show,
}

/// `show.*`: each drawn object, on or off.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Show {
    /// The actor as captured.
    pub original_skeleton: bool,
    /// The actor on the new path.
    pub new_skeleton: bool,
    /// The path fitted to the clip.
    pub original_path: bool,
    /// The new path.
    pub new_path: bool,
    /// The control points and the polygon through them.
    pub control_points: bool,
    /// The block that walks the original path.
    pub original_tracker: bool,
    /// The block that walks the new path.
    pub new_tracker: bool,
    /// The ground and its grid.
    pub ground: bool,
    /// Where the feet stand.
    pub footprints: bool,
    /// Trails of the new actor's end effectors.
    pub traces: bool,
    /// Bones are drawn as their edges.
    pub wireframe: bool,
    /// The actor with all rotations zero.
    pub normal_skeleton: bool,
    /// Names in the picture.
    pub labels: bool,
}

impl Show {
    /// Everything.
    pub const ALL: Self = Self {
        original_skeleton: true,
        new_skeleton: true,
        original_path: true,
        new_path: true,
        control_points: true,
        original_tracker: true,
        new_tracker: true,
        ground: true,
        footprints: true,
        traces: true,
        labels: true,
        wireframe: true,
        normal_skeleton: true,
    };
}

impl Default for Show {
    fn default() -> Self {
        let mut show = Self::ALL;
        (show.traces, show.wireframe, show.normal_skeleton) = (false, false, false);
        show
    }
}

/// `camera.N.*`: what the user changed of a preset; what is not given frames the whole motion.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct CameraEdits {
    /// Eye point, the clip's axes and unit.
    pub eye: Option<DVec3>,
    /// Point looked at, the clip's axes and unit.
    pub target: Option<DVec3>,
    /// Up direction, the clip's axes.
    pub up: Option<DVec3>,
    /// Vertical field of view, degrees, 5 to 120.
    pub fov: f64,
    /// How depth is mapped; none: the preset's own.
    pub projection: Option<ProjectionKind>,
    /// Eye and target move along with the carrier.
    pub follow: bool,
}

impl Default for CameraEdits {
    fn default() -> Self {
        Self { eye: None, target: None, up: None, fov: 40.0, projection: None, follow: false }
    }
}

/// `camera.N.projection`.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ProjectionKind {
    /// Far things are smaller.
    Perspective,
    /// Parallel lines stay parallel.
    Orthographic,
}
