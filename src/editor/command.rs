//! The command table: everything a key can do, with its name, its keys and one line of help.
//!
//! The keymap, the help, `walkabout keys` and the manual read this table. Adding a command is one row and one test.

use glam::DVec3;
use toml::Value;

use super::{
    Asking, Editor, Effect, TABS,
    actions::{
        ask, choose_point, default_row, delete_point, export_name, insert_point, jump, move_camera, move_row, nudge,
        nudge_name, project_name, redo, save, set_camera, shape, step_frame, step_row, step_value, steps,
        toggle_follow, turn_tab, type_point, type_row, types, undo, why,
    },
    camera::{self, Move},
    feet, joints, layers, look, loops, map_keys, pose, views,
};
use crate::{
    contact::PlantMode,
    document::{CameraEdits, Change, ProjectionKind},
    path::ShapeKind,
};

/// Headings the help puts commands under.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Group {
    /// Play and step.
    Play,
    /// The panel and its values.
    Panel,
    /// Control points.
    Points,
    /// Ready shapes.
    Shapes,
    /// Foot plants.
    Feet,
    /// Joints: which are selected.
    Joints,
    /// Layers of displacement maps.
    Layers,
    /// Cameras.
    Camera,
    /// What is drawn.
    Show,
    /// Windows and their views.
    Views,
    /// Files, undo, windows.
    File,
}

impl Group {
    /// Returns the heading.
    pub fn title(self) -> &'static str {
        match self {
            Self::Play => "play",
            Self::Panel => "panel",
            Self::Points => "control points; joints on their tab",
            Self::Shapes => "ready shapes",
            Self::Feet => "feet",
            Self::Joints => "joints",
            Self::Layers => "layers",
            Self::Camera => "camera",
            Self::Show => "show",
            Self::Views => "views",
            Self::File => "file, undo, window",
        }
    }
}

/// One row of the table.
pub struct Command {
    /// Name, lower case with dots.
    pub name: &'static str,
    /// Key sequences that run it, as texts.
    pub keys: &'static [&'static str],
    /// What it does, one line.
    pub doc: &'static str,
    /// Heading it stands under.
    pub group: Group,
    /// Whether it can do anything now.
    pub works: fn(&Editor) -> bool,
    /// Does it; is told its own name.
    pub(super) run: fn(&mut Editor, &'static str) -> Effect,
}

const fn row(
    group: Group,
    name: &'static str,
    keys: &'static [&'static str],
    doc: &'static str,
    works: fn(&Editor) -> bool,
    run: fn(&mut Editor, &'static str) -> Effect,
) -> Command {
    Command { name, keys, doc, group, works, run }
}

fn always(_: &Editor) -> bool {
    true
}

fn has_motion(editor: &Editor) -> bool {
    editor.document.solved().edited.n_frames() > 1
}

fn path_editable(editor: &Editor) -> bool {
    editor.document.solved().clip.facts.path_editable
}

/// Tells whether there is something that x, y and z move: a control point, or a joint where its tab is in use.
fn places(editor: &Editor) -> bool {
    pose::is_open(editor) || path_editable(editor)
}

/// All commands, by group.
pub const COMMANDS: &[Command] = &[
    row(Group::Play, "play", &["<space>"], "Play or pause.", has_motion, |e, _| {
        e.view.playing = !e.view.playing;
        Effect::None
    }),
    row(Group::Play, "frame.next", &["."], "One frame forward.", has_motion, |e, _| step_frame(e, 1)),
    row(Group::Play, "frame.previous", &[","], "One frame back.", has_motion, |e, _| step_frame(e, -1)),
    row(Group::Play, "frame.start", &["<home>", "0"], "Jump to the start.", has_motion, |e, _| jump(e, 0)),
    row(Group::Play, "frame.end", &["<end>", "$"], "Jump to the end.", has_motion, |e, _| jump(e, usize::MAX)),
    row(Group::Play, "why", &["W"], "What is too much here, or at the next such frame.", path_editable, |e, _| why(e)),
    row(Group::Play, "speed.down", &["<lt>"], "Play slower.", always, |e, c| {
        step_value(e, c, "timing.speed", -1, false)
    }),
    row(Group::Play, "speed.up", &["<gt>"], "Play faster.", always, |e, c| step_value(e, c, "timing.speed", 1, false)),
    row(
        Group::Play,
        "slow_motion",
        &["T"],
        "Slow motion: each frame, ten times slower between two I keys.",
        has_motion,
        |e, _| look::slow_motion(e),
    ),
    row(Group::Panel, "tab.next", &["<tab>"], "Next tab.", always, |e, _| turn_tab(e, 1)),
    row(Group::Panel, "tab.previous", &["<s-tab>"], "Previous tab.", always, |e, _| turn_tab(e, TABS.len() - 1)),
    row(Group::Panel, "row.next", &["j", "<down>"], "Next row.", always, |e, _| move_row(e, 1)),
    row(Group::Panel, "row.previous", &["k", "<up>"], "Previous row.", always, |e, _| move_row(e, -1)),
    row(Group::Panel, "value.up", &["+", "=", "<right>"], "Increase the value, or the next choice.", steps, |e, c| {
        step_row(e, c, 1, false)
    }),
    row(Group::Panel, "value.down", &["-", "<left>"], "Decrease the value, or the choice before.", steps, |e, c| {
        step_row(e, c, -1, false)
    }),
    row(Group::Panel, "value.up_big", &["]"], "A big step up.", steps, |e, c| step_row(e, c, 1, true)),
    row(Group::Panel, "value.down_big", &["["], "A big step down.", steps, |e, c| step_row(e, c, -1, true)),
    row(Group::Panel, "value.type", &["<enter>"], "Type a value or coordinates, take a loop.", types, |e, _| {
        type_row(e)
    }),
    row(Group::Panel, "value.default", &["<backspace>"], "Back to the default.", steps, default_row),
    row(Group::Panel, "set", &[":"], "Set any parameter: NAME=VALUE.", always, |e, _| ask(e, Asking::Assignment, "")),
    row(Group::Points, "point.next", &["n"], "Next control point.", path_editable, |e, _| choose_point(e, 1)),
    row(Group::Points, "point.previous", &["p"], "Previous control point.", path_editable, |e, _| choose_point(e, -1)),
    row(
        Group::Points,
        "point.x_up",
        &["x"],
        "Move the point along +x, or the joint while its tab is open.",
        places,
        |e, c| nudge(e, c, DVec3::X),
    ),
    row(Group::Points, "point.x_down", &["X"], "The same along or about −x.", places, |e, c| {
        nudge(e, c, DVec3::NEG_X)
    }),
    row(Group::Points, "point.y_up", &["y"], "The same along or about +y.", places, |e, c| nudge(e, c, DVec3::Y)),
    row(Group::Points, "point.y_down", &["Y"], "The same along or about −y.", places, |e, c| {
        nudge(e, c, DVec3::NEG_Y)
    }),
    row(Group::Points, "point.z_up", &["z"], "The same along or about +z.", places, |e, c| nudge(e, c, DVec3::Z)),
    row(Group::Points, "point.z_down", &["Z"], "The same along or about −z.", places, |e, c| {
        nudge(e, c, DVec3::NEG_Z)
    }),
    row(Group::Points, "nudge.up", &["}"], "A larger step of these keys.", always, |e, c| {
        step_value(e, c, nudge_name(e), 1, false)
    }),
    row(Group::Points, "nudge.down", &["{"], "A smaller step.", always, |e, c| {
        step_value(e, c, nudge_name(e), -1, false)
    }),
    row(
        Group::Points,
        "point.type",
        &["c"],
        "Type the point's coordinates, or the joint's or its angles.",
        places,
        |e, _| if pose::is_open(e) { pose::ask(e) } else { type_point(e) },
    ),
    row(
        Group::Points,
        "point.insert",
        &["i"],
        "Insert a point after this one; keys of the selected joints.",
        places,
        |e, c| if pose::is_open(e) { map_keys::add(e, c) } else { insert_point(e, c) },
    ),
    row(
        Group::Points,
        "point.delete",
        &["d", "<delete>"],
        "Delete the point; the selected joints' keys here.",
        places,
        |e, c| if pose::is_open(e) { map_keys::delete(e, c) } else { delete_point(e, c) },
    ),
    row(Group::Points, "path.reset", &["r"], "Back to the straight line.", path_editable, |e, c| {
        e.change(c, &Change::Straighten);
        Effect::None
    }),
    row(Group::Points, "path.edited", &["P"], "Walk the new path, or the clip's own.", path_editable, |e, c| {
        step_value(e, c, "path.edited", 1, false)
    }),
    row(Group::Points, "cycling", &["C"], "Next way of cycling on a longer path.", path_editable, |e, c| {
        step_value(e, c, "timing.cycling", 1, false)
    }),
    row(
        Group::Points,
        "loop.next",
        &["R"],
        "Cycle without a seam: the best loop, then the next best.",
        path_editable,
        loops::next,
    ),
    row(Group::Shapes, "shape.line", &["sl"], "A straight line.", path_editable, |e, c| shape(e, c, ShapeKind::Line)),
    row(Group::Shapes, "shape.chord", &["sh"], "From the first point to the last.", path_editable, |e, c| {
        shape(e, c, ShapeKind::Chord)
    }),
    row(Group::Shapes, "shape.original", &["so"], "The original path's own shape.", path_editable, |e, c| {
        shape(e, c, ShapeKind::Original)
    }),
    row(Group::Shapes, "shape.circle", &["sc"], "A circle.", path_editable, |e, c| shape(e, c, ShapeKind::Circle)),
    row(Group::Shapes, "shape.zigzag", &["sz"], "A zig-zag.", path_editable, |e, c| shape(e, c, ShapeKind::Zigzag)),
    row(Group::Shapes, "shape.eight", &["se", "s8"], "A figure eight.", path_editable, |e, c| {
        shape(e, c, ShapeKind::Eight)
    }),
    row(Group::Shapes, "shape.u", &["su"], "A U.", path_editable, |e, c| shape(e, c, ShapeKind::U)),
    row(Group::Shapes, "shape.s", &["ss"], "An S.", path_editable, |e, c| shape(e, c, ShapeKind::S)),
    row(
        Group::Feet,
        "plant.next",
        &["l"],
        "To the foot's next plant; on the joints tab to the next key.",
        |e| pose::is_open(e) || feet::has_plant(e),
        |e, _| if pose::is_open(e) { map_keys::next(e) } else { feet::next(e) },
    ),
    row(
        Group::Feet,
        "plant.previous",
        &["h"],
        "To the plant, or the key, before.",
        |e| pose::is_open(e) || feet::has_plant(e),
        |e, _| if pose::is_open(e) { map_keys::previous(e) } else { feet::previous(e) },
    ),
    row(Group::Feet, "plant.foot", &["F"], "Choose the other foot.", feet::has_feet, |e, _| feet::choose_other(e)),
    row(Group::Feet, "plant.first_earlier", &["5"], "The plant begins a frame earlier.", feet::has_plant, |e, c| {
        feet::move_first(e, c, -1)
    }),
    row(Group::Feet, "plant.first_later", &["6"], "It begins a frame later.", feet::has_plant, |e, c| {
        feet::move_first(e, c, 1)
    }),
    row(Group::Feet, "plant.last_earlier", &["7"], "It ends a frame earlier.", feet::has_plant, |e, c| {
        feet::move_last(e, c, -1)
    }),
    row(Group::Feet, "plant.last_later", &["8"], "It ends a frame later.", feet::has_plant, |e, c| {
        feet::move_last(e, c, 1)
    }),
    row(Group::Feet, "plant.hold", &["mh"], "Hold it: the foot's own slide stays.", feet::has_plant, |e, c| {
        feet::set_mode(e, c, PlantMode::Hold)
    }),
    row(Group::Feet, "plant.clean", &["mc"], "Pin it: its own slide goes too.", feet::has_plant, |e, c| {
        feet::set_mode(e, c, PlantMode::Clean)
    }),
    row(Group::Feet, "plant.slide", &["ms"], "An intended slide: leave it alone.", feet::has_plant, |e, c| {
        feet::set_mode(e, c, PlantMode::Slide)
    }),
    row(Group::Feet, "plant.split", &["mx"], "Split it at the playhead.", feet::has_plant, feet::split),
    row(Group::Feet, "plant.join", &["mj"], "Join it with the next.", feet::has_plant, feet::join),
    row(Group::Feet, "plant.add", &["ma"], "Add a plant at the playhead.", feet::has_foot, feet::add),
    row(Group::Feet, "plant.delete", &["md"], "Delete it.", feet::has_plant, feet::delete),
    row(Group::Feet, "plant.found", &["mr"], "All plants of the foot as found.", feet::has_foot, feet::foot_as_found),
    row(Group::Joints, "joint.parent", &["gp"], "To the joint above.", always, |e, _| joints::parent(e)),
    row(Group::Joints, "joint.child", &["gc"], "To the first joint below.", always, |e, _| joints::child(e)),
    row(Group::Joints, "joint.next", &["gs"], "To the next joint beside.", always, |e, _| joints::next_sibling(e)),
    row(Group::Joints, "joint.previous", &["gS"], "To the joint beside before.", always, |e, _| {
        joints::previous_sibling(e)
    }),
    row(Group::Joints, "joint.mirror", &["gm"], "To the joint on the other side.", always, |e, _| {
        joints::other_side(e)
    }),
    row(Group::Joints, "joint.toggle", &["gt"], "Select the joint, or not.", always, |e, _| joints::toggle(e)),
    row(Group::Joints, "joint.chain", &["gr"], "Select its chain to the root, or not.", always, |e, _| {
        joints::toggle_chain(e)
    }),
    row(Group::Joints, "joint.all", &["ga"], "Select all joints.", always, |e, _| joints::select_all(e)),
    row(Group::Joints, "joint.none", &["gn"], "Select no joint.", always, |e, _| joints::select_none(e)),
    row(Group::Joints, "joint.invert", &["gi"], "Select the other joints.", always, |e, _| joints::invert(e)),
    row(Group::Joints, "pose.tool", &["e"], "Turn the joint with x y z, or move it.", pose::is_open, |e, _| {
        pose::change_tool(e)
    }),
    row(Group::Joints, "pose.axes", &["G"], "Next axes: world, view, parent, own.", pose::is_open, |e, c| {
        step_value(e, c, "pose.axes", 1, false)
    }),
    row(Group::Joints, "keys.move", &["M"], "Move the keys here to another frame.", pose::is_open, |e, _| {
        map_keys::ask_move(e)
    }),
    row(Group::Joints, "keys.copy", &["D"], "Copy the keys here to another frame.", pose::is_open, |e, _| {
        map_keys::ask_copy(e)
    }),
    row(
        Group::Joints,
        "interpolation.set",
        &["I"],
        "Set an interpolation key; between two the clip is replaced.",
        has_motion,
        map_keys::interpolate,
    ),
    row(
        Group::Joints,
        "interpolation.delete",
        &["O"],
        "Delete the interpolation keys.",
        map_keys::is_interpolated,
        map_keys::uninterpolate,
    ),
    row(Group::Layers, "layer.add", &["Bn"], "A new layer above all others.", always, layers::add),
    row(Group::Layers, "layer.next", &["Bb"], "Use the next higher layer.", layers::any, |e, _| layers::next(e)),
    row(Group::Layers, "layer.switch", &["Bo"], "Switch the layer on or off.", layers::any, layers::switch),
    row(
        Group::Layers,
        "layer.interpolation",
        &["Bi"],
        "Next way to go from key to key.",
        layers::any,
        layers::interpolate,
    ),
    row(Group::Layers, "layer.heavier", &["B+", "B="], "More weight.", layers::any, |e, c| {
        layers::weigh(e, c, 1, false)
    }),
    row(Group::Layers, "layer.lighter", &["B-"], "Less weight.", layers::any, |e, c| layers::weigh(e, c, -1, false)),
    row(Group::Layers, "layer.up", &["Bk"], "The layer one higher.", layers::any, |e, c| layers::shift(e, c, true)),
    row(Group::Layers, "layer.down", &["Bj"], "The layer one lower.", layers::any, |e, c| layers::shift(e, c, false)),
    row(Group::Layers, "layer.name", &["B<enter>"], "Name the layer.", layers::any, |e, _| layers::ask_name(e)),
    row(
        Group::Layers,
        "layer.merge",
        &["Bm"],
        "Make it, and what is below, part of the motion.",
        layers::any,
        layers::merge,
    ),
    row(Group::Layers, "layer.delete", &["Bd"], "Delete the layer.", layers::any, layers::delete),
    row(Group::Layers, "layer.clear_position", &["Bp"], "Take the layer's position keys away.", layers::any, |e, c| {
        layers::clear(e, c, true)
    }),
    row(
        Group::Layers,
        "layer.clear_rotations",
        &["Br"],
        "Take the layer's rotation keys away.",
        layers::any,
        |e, c| layers::clear(e, c, false),
    ),
    row(
        Group::Layers,
        "clip.clear_position",
        &["BP"],
        "Clear the clip's own position data, or bring it back.",
        always,
        |e, c| layers::clear_clip(e, c, "clip.clear_position"),
    ),
    row(
        Group::Layers,
        "clip.clear_rotation",
        &["BR"],
        "Clear the clip's own rotation data, or bring it back.",
        always,
        |e, c| layers::clear_clip(e, c, "clip.clear_rotation"),
    ),
    row(Group::Camera, "camera.1", &["1"], "Camera 1, three-quarter.", always, |e, c| views::use_camera(e, c, 0)),
    row(Group::Camera, "camera.2", &["2"], "Camera 2, front.", always, |e, c| views::use_camera(e, c, 1)),
    row(Group::Camera, "camera.3", &["3"], "Camera 3, side.", always, |e, c| views::use_camera(e, c, 2)),
    row(Group::Camera, "camera.4", &["4"], "Camera 4, top.", always, |e, c| views::use_camera(e, c, 3)),
    row(Group::Camera, "orbit.left", &["<s-left>", "H"], "Orbit left.", always, |e, c| {
        move_camera(e, c, Move::Orbit(-1, 0))
    }),
    row(Group::Camera, "orbit.right", &["<s-right>", "L"], "Orbit right.", always, |e, c| {
        move_camera(e, c, Move::Orbit(1, 0))
    }),
    row(Group::Camera, "orbit.up", &["<s-up>", "K"], "Orbit up.", always, |e, c| move_camera(e, c, Move::Orbit(0, 1))),
    row(Group::Camera, "orbit.down", &["<s-down>", "J"], "Orbit down.", always, |e, c| {
        move_camera(e, c, Move::Orbit(0, -1))
    }),
    row(Group::Camera, "pan.left", &["<a-left>", "<a-h>"], "Pan left.", always, |e, c| {
        move_camera(e, c, Move::Pan(-1, 0))
    }),
    row(Group::Camera, "pan.right", &["<a-right>", "<a-l>"], "Pan right.", always, |e, c| {
        move_camera(e, c, Move::Pan(1, 0))
    }),
    row(Group::Camera, "pan.up", &["<a-up>", "<a-k>"], "Pan up.", always, |e, c| move_camera(e, c, Move::Pan(0, 1))),
    row(Group::Camera, "pan.down", &["<a-down>", "<a-j>"], "Pan down.", always, |e, c| {
        move_camera(e, c, Move::Pan(0, -1))
    }),
    row(Group::Camera, "zoom.in", &["<pageup>", ")"], "Zoom in.", always, |e, c| move_camera(e, c, Move::Zoom(1))),
    row(Group::Camera, "zoom.out", &["<pagedown>", "("], "Zoom out.", always, |e, c| move_camera(e, c, Move::Zoom(-1))),
    row(Group::Camera, "look.x", &["ax"], "Look along x, orthographic.", always, |e, c| {
        move_camera(e, c, Move::Along(0))
    }),
    row(Group::Camera, "look.y", &["ay"], "Look along y, orthographic.", always, |e, c| {
        move_camera(e, c, Move::Along(1))
    }),
    row(Group::Camera, "look.z", &["az"], "Look along z, orthographic.", always, |e, c| {
        move_camera(e, c, Move::Along(2))
    }),
    row(Group::Camera, "projection", &["o"], "Perspective or orthographic.", always, |e, c| {
        let kind = camera::of(e).projection;
        let next = match kind {
            ProjectionKind::Perspective => "orthographic",
            ProjectionKind::Orthographic => "perspective",
        };
        set_camera(e, c, "projection", Value::String(next.to_owned()))
    }),
    row(Group::Camera, "follow", &["f"], "Follow the carrier, or stand still.", always, toggle_follow),
    row(Group::Camera, "target", &["t"], "Look at the carrier.", always, |e, c| move_camera(e, c, Move::Target)),
    row(Group::Camera, "up", &["au"], "Next up direction of the camera: y, z, x.", always, look::next_up),
    row(
        Group::Camera,
        "view.reset",
        &["aR"],
        "Cameras, what is drawn, speed, playhead, tabs as they came.",
        always,
        look::reset,
    ),
    row(Group::Camera, "camera.reset", &["ar"], "The preset as it came.", always, |e, c| {
        camera::put(e, c, CameraEdits::default());
        views::tell_moved(e, ": as it came");
        Effect::None
    }),
    row(Group::Show, "show.original_skeleton", &["vo"], "The actor as captured.", always, |e, c| {
        step_value(e, c, "show.original_skeleton", 1, false)
    }),
    row(Group::Show, "show.new_skeleton", &["vn"], "The actor on the new path.", always, |e, c| {
        step_value(e, c, "show.new_skeleton", 1, false)
    }),
    row(Group::Show, "show.original_path", &["vO"], "The path fitted to the clip.", always, |e, c| {
        step_value(e, c, "show.original_path", 1, false)
    }),
    row(Group::Show, "show.new_path", &["vN"], "The new path.", always, |e, c| {
        step_value(e, c, "show.new_path", 1, false)
    }),
    row(Group::Show, "show.control_points", &["vc"], "The control points.", always, |e, c| {
        step_value(e, c, "show.control_points", 1, false)
    }),
    row(Group::Show, "show.original_tracker", &["vT"], "The block on the original path.", always, |e, c| {
        step_value(e, c, "show.original_tracker", 1, false)
    }),
    row(Group::Show, "show.new_tracker", &["vt"], "The block on the new path.", always, |e, c| {
        step_value(e, c, "show.new_tracker", 1, false)
    }),
    row(Group::Show, "show.ground", &["vg"], "The ground.", always, |e, c| step_value(e, c, "show.ground", 1, false)),
    row(Group::Show, "show.footprints", &["vf"], "The footprints.", always, |e, c| {
        step_value(e, c, "show.footprints", 1, false)
    }),
    row(Group::Show, "show.traces", &["vr"], "The trails of hands, feet and head.", always, |e, c| {
        step_value(e, c, "show.traces", 1, false)
    }),
    row(Group::Show, "show.wireframe", &["vw"], "Bones as edges, or solid.", always, |e, c| {
        step_value(e, c, "show.wireframe", 1, false)
    }),
    row(Group::Show, "show.normal_skeleton", &["vz"], "The actor with all rotations zero.", always, |e, c| {
        step_value(e, c, "show.normal_skeleton", 1, false)
    }),
    row(Group::Show, "show.labels", &["vl"], "The names in the picture.", always, |e, c| {
        step_value(e, c, "show.labels", 1, false)
    }),
    row(Group::Views, "views.1", &["V1"], "One view in the window.", always, |e, c| views::divide(e, c, 1)),
    row(Group::Views, "views.2", &["V2"], "Two views side by side.", always, |e, c| views::divide(e, c, 2)),
    row(Group::Views, "views.4", &["V4"], "Four views.", always, |e, c| views::divide(e, c, 4)),
    row(Group::Views, "views.next", &["Vn"], "Keys act on the next view.", views::are_several, |e, _| views::next(e)),
    row(Group::Views, "window.second", &["Vw"], "Open or close the second window.", always, |_, _| {
        Effect::ToggleSecondWindow
    }),
    row(Group::File, "help", &["?", "<f1>"], "The keys that work now.", always, |e, _| {
        e.view.help = Some(0);
        Effect::None
    }),
    row(Group::File, "undo", &["u"], "Undo.", always, |e, _| undo(e)),
    row(Group::File, "redo", &["U", "<c-r>"], "Redo.", always, |e, _| redo(e)),
    row(Group::File, "window", &["w"], "Open the window, or close the one it is pressed in.", always, |_, _| {
        Effect::ToggleWindow
    }),
    row(Group::File, "pane", &["b"], "The rendered picture in the terminal, or the plan.", always, |_, _| {
        Effect::TogglePane
    }),
    row(Group::File, "save", &["S", "<c-s>"], "Save the project.", always, |e, _| save(e)),
    row(Group::File, "save_as", &["A"], "Save the project under another name.", always, |e, _| {
        let offered = project_name(e);
        ask(e, Asking::Save, &offered)
    }),
    row(Group::File, "export", &["E"], "Export the edited clip as BVH.", always, |e, _| {
        let offered = export_name(e);
        ask(e, Asking::Export { interpolated: false }, &offered)
    }),
    row(
        Group::File,
        "export.interpolated",
        &["<c-e>"],
        "Export as it is played, replaced between interpolation keys.",
        |e| e.document.edits().interpolation_keys.is_some(),
        |e, _| {
            let offered = export_name(e);
            ask(e, Asking::Export { interpolated: true }, &offered)
        },
    ),
    row(Group::File, "redraw", &["<c-l>"], "Draw everything anew.", always, |_, _| Effect::Redraw),
    row(Group::File, "suspend", &["<c-z>"], "Stop until the shell continues us.", always, |_, _| Effect::Suspend),
    row(Group::File, "quit", &["q", "<c-c>"], "Quit; asks when the project is not saved.", always, |e, _| {
        if e.document.is_modified() { ask(e, Asking::Quit, "") } else { Effect::Quit }
    }),
];
