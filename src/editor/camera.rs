//! The four camera presets: three-quarter, front, side and top, framing the whole motion until the user edits them.

use std::borrow::Cow;

use glam::{DQuat, DVec3};

use super::{Editor, area::PlanArea};
use crate::{
    document::{CameraEdits, Change, Document, ProjectionKind, Solved, parameter},
    motion::UpAxis,
    scene::{Camera, Projection},
};

/// Names of the presets.
pub const PRESET_NAMES: [&str; 4] = ["three-quarter", "front", "side", "top"];

/// Turn of one orbit step, radians.
const ORBIT_STEP: f64 = std::f64::consts::PI / 18.0;
/// Pan of one step, a share of the distance to the target.
const PAN_STEP: f64 = 0.08;
/// Zoom of one step.
const ZOOM_STEP: f64 = 0.88;
/// The line of sight keeps this angle from the up direction, radians, so that up stays defined.
const POLE_GAP: f64 = 0.02;
/// Views that look from directions nearer to each other than this, radians, go by one name.
const SAME_DIRECTION: f64 = 1e-3;
/// A following preset frames this many body heights around the carrier, each way.
const FOLLOW_HEIGHTS: f64 = 0.9;
/// Presets frame for pictures at least this wide for their height; of two views side by side each is half as wide.
const ASPECT: f64 = 1.5;
/// A camera within this share of its distance from where it would show all shows all.
const FITTED: f64 = 1e-6;
/// Room left around what is framed.
const ROOM: f64 = 1.2;

/// A preset in world space, at rest: following not yet applied.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Preset {
    /// Eye point, world.
    pub eye: DVec3,
    /// Point looked at, world.
    pub target: DVec3,
    /// Up direction, world.
    pub up: DVec3,
    /// Vertical field of view, radians.
    pub fov_y_rad: f64,
    /// How depth is mapped.
    pub projection: ProjectionKind,
    /// Whether it moves along with the carrier.
    pub follow: bool,
}

/// What moves a camera.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Move {
    /// Steps about up, and towards up.
    Orbit(i32, i32),
    /// Steps to the right, and up.
    Pan(i32, i32),
    /// Steps nearer.
    Zoom(i32),
    /// Look along this axis of the clip (0 x, 1 y, 2 z), orthographic.
    Along(usize),
    /// Look at the carrier.
    Target,
}

/// Resolves a preset for a window of so many views: what the user changed, on top of a frame around the motion.
pub fn preset(document: &Document, area: &PlanArea, camera_idx: usize, layout: usize) -> Preset {
    let solved = document.solved();
    let edits = &document.edits().view.cameras[camera_idx];
    let to_world = |v: DVec3| solved.clip.facts.up.value.to_world(v);
    let direction = own_direction(camera_idx);
    let own_projection = if camera_idx == 0 { ProjectionKind::Perspective } else { ProjectionKind::Orthographic };
    let height = solved.clip.facts.height.value;
    let (centre, framed) = framed(solved, area, edits.follow);
    // A view straight down has the clip's far side at the top.
    let own_up = if camera_idx == 3 { DVec3::NEG_Z } else { DVec3::Y };
    let projection = edits.projection.unwrap_or(own_projection);
    let target = edits.target.map_or(centre, to_world);
    let fov_y_rad = edits.fov.to_radians();
    let eye = edits.eye.map_or_else(
        || {
            let frame = Frame { direction, up: own_up, fov_y_rad, projection, aspect: aspect(layout) };
            target + direction * frame.distance(centre, &framed)
        },
        to_world,
    );
    let mut preset =
        Preset { eye, target, up: edits.up.map_or(own_up, to_world), fov_y_rad, projection, follow: edits.follow };
    preset.mend(height);
    preset
}

/// Returns what a camera shows that nobody has moved: the middle and what is around it.
fn framed<'a>(solved: &Solved, area: &'a PlanArea, follow: bool) -> (DVec3, Cow<'a, [DVec3]>) {
    if !follow {
        return (area.centre, Cow::Borrowed(&area.points));
    }
    let centre = followed(solved, 0);
    let way = FOLLOW_HEIGHTS * solved.clip.facts.height.value;
    let sides = [DVec3::X, DVec3::NEG_X, DVec3::Y, DVec3::NEG_Y].map(|side| centre + side * way);
    (centre, Cow::Owned(sides.to_vec()))
}

/// Returns where a preset as it came looks from: the direction from what is looked at to the eye, unit.
fn own_direction(camera_idx: usize) -> DVec3 {
    let direction = match camera_idx {
        0 => DVec3::new(0.62, 0.42, 0.66),
        1 => DVec3::Z,
        2 => DVec3::X,
        _ => DVec3::Y,
    };
    direction.normalize()
}

/// Returns how wide for its height a view is, at least, in a window of so many.
fn aspect(layout: usize) -> f64 {
    if layout == 2 { 0.5 * ASPECT } else { ASPECT }
}

/// How a picture is framed, but for where from.
struct Frame {
    /// From what is looked at to the eye, unit.
    direction: DVec3,
    up: DVec3,
    fov_y_rad: f64,
    projection: ProjectionKind,
    aspect: f64,
}

impl Frame {
    /// Returns how far from the centre all points are in the picture.
    fn distance(&self, centre: DVec3, points: &[DVec3]) -> f64 {
        let right = self.up.cross(self.direction).normalize();
        let screen_up = self.direction.cross(right);
        let slope = (0.5 * self.fov_y_rad).tan();
        let needed = points.iter().map(|&point| {
            let p = point - centre;
            let across = p.dot(screen_up).abs().max(p.dot(right).abs() / self.aspect) / slope;
            match self.projection {
                ProjectionKind::Perspective => across + p.dot(self.direction),
                ProjectionKind::Orthographic => across,
            }
        });
        ROOM * needed.fold(0.0, f64::max)
    }
}

impl Preset {
    /// Makes any numbers a user can type a camera: an eye apart from its target, an up across the line of sight.
    fn mend(&mut self, height: f64) {
        if self.eye.distance(self.target) < 1e-6 * height {
            self.eye = self.target + height * DVec3::Z;
        }
        let sight = (self.target - self.eye).normalize();
        self.up = self.up.try_normalize().unwrap_or(DVec3::Y);
        if self.up.cross(sight).length() < 1e-3 {
            self.up = if sight.y.abs() > 0.9 { DVec3::NEG_Z } else { DVec3::Y };
        }
    }

    /// Says where it looks from: the preset's own name while it does so from there, else along an axis of the clip.
    pub(super) fn name(&self, camera_idx: usize, up: UpAxis) -> &'static str {
        let from = (self.eye - self.target).normalize();
        let is_from = |direction: DVec3| from.angle_between(direction) < SAME_DIRECTION;
        let along = [
            (DVec3::X, "along x"),
            (DVec3::Y, "along y"),
            (DVec3::Z, "along z"),
            (DVec3::NEG_X, "along −x"),
            (DVec3::NEG_Y, "along −y"),
            (DVec3::NEG_Z, "along −z"),
        ];
        if is_from(own_direction(camera_idx)) {
            return PRESET_NAMES[camera_idx];
        }
        along.into_iter().find(|(axis, _)| is_from(up.to_world(*axis))).map_or("turned", |(_, name)| name)
    }

    /// Returns the camera of this moment.
    pub(super) fn camera(&self, offset: DVec3) -> Camera {
        let offset = if self.follow { offset } else { DVec3::ZERO };
        let distance = self.eye.distance(self.target);
        Camera {
            eye: self.eye + offset,
            target: self.target + offset,
            up: self.up,
            projection: match self.projection {
                ProjectionKind::Perspective => Projection::Perspective { fov_y_rad: self.fov_y_rad },
                // As high as the perspective picture is at the target.
                ProjectionKind::Orthographic => {
                    Projection::Orthographic { height: 2.0 * distance * (0.5 * self.fov_y_rad).tan() }
                }
            },
        }
    }
}

/// The point a following camera follows: the new path under the playhead.
fn followed(solved: &Solved, frame_idx: usize) -> DVec3 {
    solved.new_frame(frame_idx).translation
}

/// Returns how far the carrier has come since the first frame: what a following camera moves by.
pub(super) fn follow_offset(document: &Document, frame_idx: usize) -> DVec3 {
    followed(document.solved(), frame_idx) - followed(document.solved(), 0)
}

/// Returns the preset of the view in focus.
pub(super) fn of(editor: &Editor) -> Preset {
    let window = &editor.document.edits().view.windows[editor.view.window.idx()];
    preset(&editor.document, &editor.view.area, editor.view.camera_idx, window.layout)
}

/// Returns the preset of the view in focus after a move, as edits.
fn moved(editor: &Editor, by: Move) -> CameraEdits {
    let solved = editor.document.solved();
    let up_axis = solved.clip.facts.up.value;
    let mut edits = editor.document.edits().view.cameras[editor.view.camera_idx];
    let mut preset = of(editor);
    let arm = preset.eye - preset.target;
    let right = preset.up.cross(arm).normalize();
    let screen_up = arm.cross(right).normalize();
    match by {
        Move::Orbit(around, over) => {
            let turned = DQuat::from_axis_angle(preset.up, f64::from(around) * ORBIT_STEP) * arm;
            let axis = preset.up.cross(turned).normalize();
            let polar = preset.up.angle_between(turned);
            let wanted = polar - f64::from(over) * ORBIT_STEP;
            let polar_step = wanted.clamp(POLE_GAP, std::f64::consts::PI - POLE_GAP) - polar;
            preset.eye = preset.target + DQuat::from_axis_angle(axis, polar_step) * turned;
        }
        Move::Pan(across, along) => {
            let step = (f64::from(across) * right + f64::from(along) * screen_up) * arm.length() * PAN_STEP;
            preset.eye += step;
            preset.target += step;
        }
        Move::Zoom(nearer) => preset.eye = preset.target + arm * ZOOM_STEP.powi(nearer),
        Move::Along(axis) => {
            let direction = up_axis.to_world([DVec3::X, DVec3::Y, DVec3::Z][axis]);
            let up = if direction.y.abs() > 0.5 { DVec3::NEG_Z } else { DVec3::Y };
            let (centre, points) = framed(solved, &editor.view.area, preset.follow);
            let layout = editor.document.edits().view.windows[editor.view.window.idx()].layout;
            let fit = |direction: DVec3, up: DVec3, projection: ProjectionKind| {
                let frame = Frame { direction, up, fov_y_rad: preset.fov_y_rad, projection, aspect: aspect(layout) };
                frame.distance(centre, &points)
            };
            // A picture that shows all goes on to do so; one that was zoomed or panned keeps what it looks at.
            let fitted = fit(arm.normalize(), preset.up, preset.projection);
            let near = FITTED * fitted;
            let shows_all = preset.target.distance(centre) < near && (arm.length() - fitted).abs() < near;
            let distance = if shows_all { fit(direction, up, ProjectionKind::Orthographic) } else { arm.length() };
            preset.eye = preset.target + direction * distance;
            preset.up = up;
            edits.projection = Some(ProjectionKind::Orthographic);
        }
        Move::Target => {
            let offset =
                if preset.follow { follow_offset(&editor.document, editor.view.frame_idx) } else { DVec3::ZERO };
            let step = solved.carrier(editor.view.frame_idx).translation - offset - preset.target;
            preset.eye += step;
            preset.target += step;
        }
    }
    CameraEdits {
        eye: Some(up_axis.to_file(preset.eye)),
        target: Some(up_axis.to_file(preset.target)),
        up: Some(up_axis.to_file(preset.up)),
        ..edits
    }
}

/// Says what a move does to a camera.
pub(super) fn in_words(by: Move) -> String {
    let way = |n: i32, forth, back| if n > 0 { forth } else { back };
    match by {
        Move::Orbit(0, over) => format!("orbited {}", way(over, "up", "down")),
        Move::Orbit(around, _) => format!("orbited {}", way(around, "right", "left")),
        Move::Pan(0, along) => format!("panned {}", way(along, "up", "down")),
        Move::Pan(across, _) => format!("panned {}", way(across, "right", "left")),
        Move::Zoom(nearer) => format!("zoomed {} ×{:.2}", way(nearer, "in", "out"), ZOOM_STEP.powi(-nearer)),
        Move::Along(axis) => format!("looks along {}", ["x", "y", "z"][axis]),
        Move::Target => "looks at the carrier".to_owned(),
    }
}

/// Moves the camera of the view in focus.
pub(super) fn change(editor: &mut Editor, command: &'static str, by: Move) {
    let moved = moved(editor, by);
    put(editor, command, moved);
}

/// Makes the camera of the view in focus follow the carrier or stand still. A camera that was moved goes on from the
/// picture as it is; one that was not frames what it is to show.
pub(super) fn toggle_follow(editor: &mut Editor, command: &'static str) {
    let edits = editor.document.edits().view.cameras[editor.view.camera_idx];
    let mut camera = CameraEdits { follow: !edits.follow, ..edits };
    if edits.eye.is_some() || edits.target.is_some() {
        let up_axis = editor.document.solved().clip.facts.up.value;
        let come = follow_offset(&editor.document, editor.view.frame_idx);
        let by = if camera.follow { -come } else { come };
        let preset = of(editor);
        camera.eye = Some(up_axis.to_file(preset.eye + by));
        camera.target = Some(up_axis.to_file(preset.target + by));
    }
    put(editor, command, camera);
}

/// Sets the camera of the view in focus.
pub(super) fn put(editor: &mut Editor, command: &'static str, camera: CameraEdits) {
    let prefix = format!("camera.{}", editor.view.camera_idx + 1);
    let mut edits = (**editor.document.edits()).clone();
    edits.view.cameras[editor.view.camera_idx] = camera;
    let fields = ["eye", "target", "up", "fov", "projection", "follow"].map(|field| format!("{prefix}.{field}"));
    let values = fields.map(|name| {
        let value = parameter(&name).expect("the table has every camera field").get(&edits);
        (name, value)
    });
    editor.change(command, &Change::Set { values: values.to_vec(), shape: None });
}
