//! Editing a pose: keys and the pointer move or turn the active joint, and the edit becomes keys of a layer.
//!
//! What is moved is the joint as it is seen at the playhead. The selected joints above it turn so that it goes there;
//! the carrier just moves. What is turned is the active joint alone.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use super::{
    Asking, Editor, Effect, Handle, Message, Prompt, Severity, TABS, camera,
    joints::{self, Tool},
    map_keys, prompt,
};
use crate::{
    displace::joint_name,
    document::{Axes, Change, Document, PoseChange, Solved, parameter},
    math::Rigid,
    skeleton::JointId,
};

/// A joint farther from where it is wanted than this share of the body height has not reached it.
const REACHED: f64 = 1e-4;

/// Tells whether keys are about joints: a tab of theirs is in use.
pub(super) fn is_open(editor: &Editor) -> bool {
    TABS[editor.view.tab_idx].is_of_joints()
}

/// Changes what keys do with the active joint.
pub(super) fn change_tool(editor: &mut Editor) -> Effect {
    editor.view.joints.tool = match editor.view.joints.tool {
        Tool::Move => Tool::Turn,
        Tool::Turn => Tool::Move,
    };
    editor.say(Message::note(step_in_words(editor)));
    Effect::None
}

/// Returns the name of the parameter that holds the step in use.
pub(super) fn step_name(editor: &Editor) -> &'static str {
    match editor.view.joints.tool {
        Tool::Move => "pose.nudge",
        Tool::Turn => "pose.turn",
    }
}

/// Says what one key press does.
pub(super) fn step_in_words(editor: &Editor) -> String {
    let edits = editor.document.edits();
    let step = parameter(step_name(editor)).expect("the table has both steps").display(edits);
    let axes = match edits.pose.axes {
        Axes::World => "the clip's axes",
        Axes::View => "the view's axes",
        Axes::Parent => "its parent's axes",
        Axes::Own => "its own axes",
    };
    match editor.view.joints.tool {
        Tool::Move => format!("move it along {axes} by {step} body heights"),
        Tool::Turn => format!("turn it about {axes} by {step} degrees"),
    }
}

/// Moves the active joint a step along an axis, or turns it a step about it.
///
/// `direction` is a unit vector along an axis in use.
pub(super) fn step(editor: &mut Editor, command: &'static str, direction: DVec3) -> Effect {
    // What it goes on from is where things are.
    editor.settle_unless_held(command);
    let pose = editor.document.edits().pose;
    let along = axes(editor) * direction;
    match editor.view.joints.tool {
        Tool::Move => {
            let by = along * pose.nudge * editor.document.solved().clip.facts.height.value;
            let to = place(editor.document.solved(), editor.view.frame_idx, editor.view.joints.active) + by;
            move_to(editor, command, to);
        }
        Tool::Turn => turn(editor, command, along, pose.turn.to_radians()),
    }
    Effect::None
}

/// Asks where the active joint goes, or by which angles it turns.
pub(super) fn ask(editor: &mut Editor) -> Effect {
    editor.document.settle();
    editor.follow_document();
    let solved = editor.document.solved();
    let name = joints::name(&solved.clip, editor.view.joints.active);
    editor.prompt = Some(match editor.view.joints.tool {
        Tool::Move => {
            let at = place(solved, editor.view.frame_idx, editor.view.joints.active);
            let at = solved.clip.facts.up.value.to_file(at);
            Prompt::new(Asking::MoveJoint { name }, &editor.offered_place(at))
        }
        Tool::Turn => Prompt::new(Asking::TurnJoint { name }, "0 0 0"),
    });
    Effect::None
}

/// Moves the active joint to where the user typed, in the clip's axes and unit.
pub(super) fn typed_place(editor: &mut Editor, text: &str) {
    match prompt::parse_coordinates(text) {
        Some(to) => {
            let to = editor.document.solved().clip.facts.up.value.to_world(to);
            move_to(editor, "type", to);
        }
        None => editor.say(Message::error(format!("expected three numbers x y z, found `{text}`"))),
    }
}

/// Turns the active joint by the angles the user typed: about x, then y, then z of the axes in use, degrees.
pub(super) fn typed_angles(editor: &mut Editor, text: &str) {
    let Some(angles) = prompt::parse_coordinates(text) else {
        editor.say(Message::error(format!("expected three angles x y z, found `{text}`")));
        return;
    };
    let [x, y, z] = angles.to_array().map(f64::to_radians);
    let turned = DQuat::from_rotation_z(z) * DQuat::from_rotation_y(y) * DQuat::from_rotation_x(x);
    let (axis, angle) = turned.to_axis_angle();
    turn(editor, "type", axes(editor) * axis, angle);
}

/// Turns the active joint about a world axis.
fn turn(editor: &mut Editor, command: &'static str, axis: DVec3, angle_rad: f64) {
    let joint = joint_of(editor.document.solved(), editor.view.joints.active);
    change(editor, command, PoseChange::Turn { joint, axis, angle_rad });
}

/// Moves the active joint to a place in the world, and says so when it does not get there.
fn move_to(editor: &mut Editor, command: &'static str, to: DVec3) {
    let handle = editor.view.joints.active;
    let frame_idx = editor.view.frame_idx;
    let clip = Arc::clone(&editor.document.solved().clip);
    let point = joint_of(editor.document.solved(), handle).idx();
    change(editor, command, wanted(editor, point, to));
    let depth = editor.document.depth();
    tell_short(editor, Wanted { name: joints::name(&clip, handle), point, frame_idx, to, depth });
}

/// Where a point was wanted.
#[derive(Clone, Debug)]
pub(super) struct Wanted {
    /// What the point is called.
    pub(super) name: String,
    /// The point of the skeleton.
    pub(super) point: usize,
    pub(super) frame_idx: usize,
    pub(super) to: DVec3,
    /// How many steps could be undone and redone then.
    pub(super) depth: (usize, usize),
}

impl Wanted {
    /// Tells whether no other step was made since, nor this one undone.
    pub(super) fn is_last(&self, document: &Document) -> bool {
        self.depth == document.depth()
    }
}

/// Says by how much a point is short of where it was wanted, if it is, as soon as that is known and unless there is
/// something to warn of.
pub(super) fn tell_short(editor: &mut Editor, wanted: Wanted) {
    let solved = editor.document.solved();
    if !editor.document.is_settled() {
        editor.wanted = Some(wanted);
        return;
    }
    let Wanted { name, point, frame_idx, to, .. } = wanted;
    let mut points = Vec::new();
    solved.edited.world_points(frame_idx, &mut points);
    let facts = &solved.clip.facts;
    let (off, unit) = (points[point].distance(to), facts.unit_word());
    let may_tell = editor.view.message.as_ref().is_none_or(|message| message.severity == Severity::Note);
    if may_tell && off > REACHED * facts.height.value {
        editor.say(Message::note(format!("{name} reaches no farther: {off:.2} {unit} short")));
    }
}

/// Returns the change that takes a point to a place in the world: of the carrier the carrier moves, of any other the
/// selected joints above it turn.
pub(super) fn wanted(editor: &Editor, point: usize, to: DVec3) -> PoseChange {
    if point == editor.document.solved().clip.facts.carrier.value.idx() {
        PoseChange::PlaceCarrier { to }
    } else {
        PoseChange::Reach { point, joints: editor.view.joints.ids().collect(), to }
    }
}

/// Makes a pose at the playhead what is wanted.
fn change(editor: &mut Editor, command: &'static str, change: PoseChange) {
    editor.view.playing = false;
    let (layer_idx, frame_idx) = (editor.view.layer_idx, editor.view.frame_idx);
    // What is moved or turned need not be selected, but it is what the user waits to hear of.
    let mut maps = editor.map_selection();
    match &change {
        PoseChange::PlaceCarrier { .. } => maps.position = true,
        &PoseChange::Turn { joint, .. } => {
            maps.joints.insert(joint_name(&editor.document.solved().clip.skeleton, joint));
        }
        PoseChange::Reach { .. } => {}
    }
    editor.change(command, &Change::Pose { layer_idx, frame_idx, change });
    if editor.view.message.is_none() {
        map_keys::tell_of(editor, &maps);
    }
}

/// Returns the joint that a handle is of.
pub(super) fn joint_of(solved: &Solved, handle: Handle) -> JointId {
    match handle {
        Handle::Position => solved.clip.facts.carrier.value,
        Handle::Joint(id) => id,
    }
}

/// Returns where a handle's joint is seen, world.
fn place(solved: &Solved, frame_idx: usize, handle: Handle) -> DVec3 {
    world(solved, frame_idx)[joint_of(solved, handle).idx()].translation
}

fn world(solved: &Solved, frame_idx: usize) -> Vec<Rigid> {
    let mut world = Vec::new();
    solved.edited.world_rigids(frame_idx, &mut world);
    world
}

/// Returns the rotation from the axes in use to the world.
fn axes(editor: &Editor) -> DQuat {
    let solved = editor.document.solved();
    let frame_idx = editor.view.frame_idx;
    let joint = joint_of(solved, editor.view.joints.active);
    let of_clip = solved.clip.facts.up.value.world_rotation();
    match editor.document.edits().pose.axes {
        Axes::World => of_clip,
        Axes::View => camera::of(editor).axes(),
        Axes::Own => world(solved, frame_idx)[joint.idx()].rotation,
        // What the carrier hangs on is the path.
        Axes::Parent if joint == solved.clip.facts.carrier.value => solved.new_frame(frame_idx).rotation,
        Axes::Parent => match solved.clip.skeleton.joint(joint).parent {
            Some(parent) => world(solved, frame_idx)[parent.idx()].rotation,
            None => of_clip,
        },
    }
}

impl camera::Preset {
    /// Returns the rotation from right, up and towards the eye to the world.
    fn axes(&self) -> DQuat {
        let back = (self.eye - self.target).normalize();
        let right = self.up.cross(back).normalize();
        DQuat::from_mat3(&DMat3::from_cols(right, back.cross(right), back))
    }
}
