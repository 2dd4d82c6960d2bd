//! A picture as plain data: what is to be seen now, with no handle on where it came from.
//!
//! The editor builds a [`Scene`], the terminal's plan view and the Vulkan viewport draw it, the link carries it to
//! another process. World space is y-up, right-handed, in the clip's length unit, f64.
//!
//! A scene has two parts: [`Still`] changes when the document does and is sent when its revision changed; [`Now`]
//! changes with the playhead and the camera and is a few kilobytes.

mod object;

use std::sync::Arc;

use glam::DVec3;
use serde::{Deserialize, Serialize};

use crate::{key::Key, motion::Side};
pub use object::{Object, Objects};

/// The most views in a picture: one for each camera preset.
pub const MAX_VIEWS: usize = 4;

/// The most steps of a pointer's wheel in one event: far more than a hand turns at once, few enough to zoom by.
pub const MAX_WHEEL_STEPS: i32 = 100;

/// What a drawn thing is; front ends choose its look by this, and [`Role::rgb`] gives the colour they share.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, Serialize, Deserialize)]
pub enum Role {
    /// The actor as captured.
    OriginalSkeleton,
    /// The actor on the new path.
    NewSkeleton,
    /// The actor with all rotations zero.
    NormalSkeleton,
    /// The path fitted to the clip.
    OriginalPath,
    /// The path the user draws.
    NewPath,
    /// A stretch of the new path that asks too much of a body.
    Strain,
    /// A control point of the new path, and the polygon through them.
    ControlPoint,
    /// The control point that keys act on.
    SelectedControlPoint,
    /// The block that walks the original path.
    OriginalTracker,
    /// The block that walks the new path.
    NewTracker,
    /// A trail left by a point of the skeleton, and where on it the point is.
    Trace,
    /// A footprint.
    Footprint,
    /// The footprint of a plant that could not be reached.
    MissedFootprint,
    /// A joint that keys act on, and the limbs it turns.
    SelectedJoint,
    /// The joint that keys move, selected or not.
    ActiveJoint,
    /// The ground and its grid.
    Ground,
}

impl Role {
    /// Returns the role's colour as sRGB bytes (the thesis's colours; trackers and traces are lighter kin of theirs).
    pub fn rgb(self) -> [u8; 3] {
        match self {
            Self::OriginalSkeleton => [214, 69, 65],
            Self::NewSkeleton => [72, 187, 98],
            Self::NormalSkeleton => [90, 200, 205],
            Self::OriginalPath | Self::NewPath => [240, 240, 240],
            Self::Strain | Self::MissedFootprint => [240, 150, 50],
            Self::ControlPoint => [155, 89, 214],
            Self::SelectedControlPoint => [255, 120, 200],
            Self::OriginalTracker => [236, 145, 120],
            Self::NewTracker => [150, 225, 160],
            Self::Trace => [230, 190, 90],
            Self::Footprint => [110, 170, 230],
            Self::SelectedJoint => [200, 80, 255],
            Self::ActiveJoint => [232, 190, 255],
            Self::Ground => [70, 74, 82],
        }
    }
}

/// How a curve is drawn, so that two of one colour can be told apart.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub enum Stroke {
    /// An unbroken line.
    Solid,
    /// A dashed line.
    Dashed,
}

/// A polyline in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Curve {
    /// What it is.
    pub role: Role,
    /// How it is drawn.
    pub stroke: Stroke,
    /// Points, world.
    pub points: Vec<DVec3>,
}

/// A small solid mark at a point, a sphere or a cube by role.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Mark {
    /// What it is.
    pub role: Role,
    /// Centre, world.
    pub at: DVec3,
    /// Radius (half the edge of a cube), in the clip's length unit.
    pub radius: f64,
}

/// A footprint on the ground.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Footprint {
    /// What it is: reached or missed.
    pub role: Role,
    /// Left or right foot.
    pub foot: Side,
    /// Middle of the sole, world.
    pub at: DVec3,
    /// Where the toes point, about up, radians; 0 is +z.
    pub heading_rad: f64,
    /// Upright of the ground under it, unit, world.
    pub normal: DVec3,
    /// From heel to toes, clip's length unit; positive.
    pub length: f64,
}

/// A line of text with a place in the world.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Label {
    /// What it names.
    pub role: Role,
    /// Where it stands, world.
    pub at: DVec3,
    /// The text, one line.
    pub text: String,
}

/// One limb of a body: a capsule between two of the actor's points.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Limb {
    /// What it is: its body's role, or that of a selected joint which turns it.
    pub role: Role,
    /// Index of the point it begins at.
    pub from: u32,
    /// Index of the point it ends at.
    pub to: u32,
    /// Radius in the clip's length unit.
    pub radius: f64,
}

/// A body: which points are joined by limbs. Where the points are is in [`Now::actors`], by the same index.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Body {
    /// What it is.
    pub role: Role,
    /// Limbs to draw.
    pub limbs: Vec<Limb>,
    /// They are drawn as edges, not as solids, in views that show [`Object::Wireframe`].
    pub wireframe: bool,
}

/// The ground plane with its grid.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ground {
    /// Height of the plane, world.
    pub height: f64,
    /// Centre of the drawn patch; its height is ignored.
    pub centre: DVec3,
    /// Half the edge of the drawn patch.
    pub half_extent: f64,
    /// Distance between grid lines.
    pub cell: f64,
}

/// The part of a scene that stays while a clip plays.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Still {
    /// Changes whenever anything in this part does; two parts of one session with equal revision are equal.
    pub revision: u64,
    /// Body height of the clip, the yardstick for line widths and clip planes; positive.
    pub body_height: f64,
    /// Bodies, drawn at [`Now::actors`].
    pub bodies: Vec<Body>,
    /// Paths, polygons, traces.
    pub curves: Vec<Curve>,
    /// Where feet stand.
    pub footprints: Vec<Footprint>,
    /// Control points and other marks that do not move in time.
    pub marks: Vec<Mark>,
    /// Texts that do not move in time.
    pub labels: Vec<Label>,
    /// The ground, if shown.
    pub ground: Option<Ground>,
}

/// How a camera maps depth.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub enum Projection {
    /// Perspective with this vertical field of view, radians.
    Perspective {
        /// Vertical field of view, radians.
        fov_y_rad: f64,
    },
    /// Orthographic, showing this world height from bottom to top of the view.
    Orthographic {
        /// World height of the view.
        height: f64,
    },
}

/// A camera, fully resolved: following has already been applied.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Camera {
    /// Eye point, world.
    pub eye: DVec3,
    /// Point looked at, world; never equal to `eye`.
    pub target: DVec3,
    /// Up direction; never parallel to the line of sight.
    pub up: DVec3,
    /// How depth is mapped.
    pub projection: Projection,
}

/// One view of the picture. Several views tile the image: two side by side, four in a square.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct View {
    /// Where it is seen from.
    pub camera: Camera,
    /// Name in the view's corner, e.g. `1 three-quarter`.
    pub title: String,
    /// Which of the scene's objects are seen in it.
    pub shows: Objects,
    /// Whether keys act on this one of several views; its title is marked.
    pub focused: bool,
}

/// The part of a scene that changes with the playhead and the camera.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Now {
    /// World positions of each body's points, in the order of [`Still::bodies`]; a body with no points is not drawn.
    pub actors: Vec<Vec<DVec3>>,
    /// Marks that move in time: trackers, joints, ends of trails.
    pub marks: Vec<Mark>,
    /// Texts that move in time.
    pub labels: Vec<Label>,
    /// The views to draw; at least one, at most [`MAX_VIEWS`].
    pub views: Vec<View>,
    /// One line at the foot of the picture: frame, time, state.
    pub caption: String,
}

/// An immutable description of a picture.
#[derive(Clone, Debug, PartialEq)]
pub struct Scene {
    /// What stays while the clip plays.
    pub still: Arc<Still>,
    /// What moves.
    pub now: Now,
}

/// What the editor asks of a preview.
#[derive(Clone, Debug, PartialEq)]
pub enum ToPreview {
    /// Show this from now on.
    Scene(Scene),
    /// Headless previews only: draw frames of this size in pixels from now on.
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// Close and exit.
    Close,
}

/// What a preview tells the editor.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum FromPreview {
    /// The preview draws; the texts name the Vulkan device and driver.
    Ready {
        /// Device name as the driver gives it.
        device: String,
        /// Driver name and version.
        driver: String,
    },
    /// A key was pressed in the window.
    Key(Key),
    /// The pointer was pressed in a view at this ray.
    Pick(Ray),
    /// The pointer moved with its button down, from the last ray to this one.
    Drag(Ray),
    /// The pointer's button was released.
    Release,
    /// The pointer's wheel was turned over a view.
    Wheel {
        /// Index of the view.
        view: u32,
        /// Steps away from the user, which is nearer; never 0, at most [`MAX_WHEEL_STEPS`] either way.
        steps: i32,
    },
    /// A headless preview's finished frame.
    Frame(Picture),
    /// The user closed the window.
    Closed,
    /// The preview cannot go on; the text says why and what would help, in one line.
    Failed(String),
}

/// A half-line from the eye through a pixel, world.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Ray {
    /// Index of the view it goes through.
    pub view: u32,
    /// Where it starts.
    pub origin: DVec3,
    /// Unit direction.
    pub direction: DVec3,
}

/// A finished image, rows from the top.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Picture {
    /// Width in pixels.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
    /// `width · height · 3` bytes, sRGB red, green, blue.
    pub rgb: Vec<u8>,
}
