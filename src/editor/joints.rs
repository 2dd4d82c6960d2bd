//! Joints that keys act on: which are selected, which one keys move, and how to walk from one to another.
//!
//! What can be selected are the maps that a layer can have: the carrier's position, and every joint that can turn. A
//! joint that cannot is walked over but never selected, so commands need not ask.

use std::collections::BTreeSet;

use super::{Editor, Effect, Message, Row, RowKind, TABS, Tab, map_keys, panel, pose};
use crate::{
    displace::{can_turn, joint_name},
    motion::Clip,
    skeleton::{JointId, Skeleton},
};

/// What keys take hold of.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Handle {
    /// Where the carrier is.
    Position,
    /// How a joint turns.
    Joint(JointId),
}

/// What keys do with the active joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tool {
    /// Move it, the selected joints above it turning.
    Move,
    /// Turn it.
    Turn,
}

/// The handles that keys act on. None of it is history.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Joints {
    /// What keys move.
    pub active: Handle,
    /// What is selected.
    pub selected: BTreeSet<Handle>,
    /// What keys do with the active one.
    pub tool: Tool,
}

impl Joints {
    pub(super) fn new(clip: &Clip) -> Self {
        Self { active: Handle::Joint(clip.facts.carrier.value), selected: BTreeSet::new(), tool: Tool::Move }
    }

    /// Tells whether a handle is selected.
    pub fn is_selected(&self, handle: Handle) -> bool {
        self.selected.contains(&handle)
    }

    /// Returns the selected joints, parents first.
    pub fn ids(&self) -> impl Iterator<Item = JointId> + '_ {
        self.selected.iter().filter_map(|&handle| match handle {
            Handle::Position => None,
            Handle::Joint(id) => Some(id),
        })
    }

    /// Leaves out what the clip does not let be edited, after its carrier has changed.
    pub(super) fn follow(&mut self, clip: &Clip) {
        self.selected.retain(|&handle| is_editable(clip, handle));
    }
}

/// Tells whether a layer can have a map of this.
fn is_editable(clip: &Clip, handle: Handle) -> bool {
    match handle {
        Handle::Position => clip.facts.path_editable,
        Handle::Joint(id) => can_turn(clip, id),
    }
}

/// Returns all there is to take hold of, as the panel lists it.
fn handles(clip: &Clip) -> impl Iterator<Item = Handle> + use<> {
    std::iter::once(Handle::Position).chain(clip.skeleton.ids().map(Handle::Joint))
}

/// Returns a handle's name for people.
pub(super) fn name(clip: &Clip, handle: Handle) -> String {
    match handle {
        Handle::Position => format!("position of {}", clip.skeleton.joint(clip.facts.carrier.value).name),
        Handle::Joint(id) => joint_name(&clip.skeleton, id),
    }
}

/// Returns the rows of the joint tree.
pub(super) fn rows(editor: &Editor) -> Vec<Row> {
    let clip = &editor.document.solved().clip;
    let joints = &editor.view.joints;
    let mut depths = Vec::with_capacity(clip.skeleton.n_joints());
    for joint in clip.skeleton.joints() {
        depths.push(joint.parent.map_or(0, |parent| depths[parent.idx()] + 1));
    }
    let step = pose::step_in_words(editor);
    let row = |handle| {
        let keys = map_keys::count(editor, handle);
        let depth = if let Handle::Joint(id) = handle { depths[id.idx()] } else { 0 };
        let sign = if joints.is_selected(handle) { '◉' } else { '○' };
        let help = format!("gr selects its chain, gt it; xyz XYZ {step}; e turn or move, G axes, {{ }} step, c type.");
        Row {
            kind: RowKind::Joint(handle),
            label: format!("{}{sign} {}", " ".repeat(depth), name(clip, handle)),
            changed: keys.is_some(),
            value: if is_editable(clip, handle) { keys.unwrap_or_default() } else { "cannot be edited".to_owned() },
            unit: "",
            selected: false,
            help,
        }
    };
    handles(clip).map(row).collect()
}

/// Walks to the parent.
pub(super) fn parent(editor: &mut Editor) -> Effect {
    walk(editor, "above", |skeleton, id| skeleton.joint(id).parent)
}

/// Walks to the first child.
pub(super) fn child(editor: &mut Editor) -> Effect {
    walk(editor, "below", |skeleton, id| skeleton.children(id).next())
}

/// Walks to the next joint of the same parent, round at the end.
pub(super) fn next_sibling(editor: &mut Editor) -> Effect {
    walk(editor, "beside", |skeleton, id| sibling(skeleton, id, 1))
}

/// Walks to the joint of the same parent before this one, round at the start.
pub(super) fn previous_sibling(editor: &mut Editor) -> Effect {
    walk(editor, "beside", |skeleton, id| sibling(skeleton, id, -1))
}

fn sibling(skeleton: &Skeleton, id: JointId, by: i64) -> Option<JointId> {
    let parent = skeleton.joint(id).parent;
    let all: Vec<JointId> = skeleton.ids().filter(|&other| skeleton.joint(other).parent == parent).collect();
    let at = all.iter().position(|&other| other == id).expect("a joint is among its parent's children") as i64;
    let next = all[(at + by).rem_euclid(all.len() as i64) as usize];
    (next != id).then_some(next)
}

/// Walks to the joint on the other side of the body.
pub(super) fn other_side(editor: &mut Editor) -> Effect {
    walk(editor, "on the other side of", Skeleton::mirror)
}

/// Walks the tree; the carrier's position stands for the carrier.
fn walk(editor: &mut Editor, direction: &str, to: fn(&Skeleton, JointId) -> Option<JointId>) -> Effect {
    let clip = std::sync::Arc::clone(&editor.document.solved().clip);
    let from = match editor.view.joints.active {
        Handle::Position => clip.facts.carrier.value,
        Handle::Joint(id) => id,
    };
    match to(&clip.skeleton, from) {
        Some(id) => {
            activate(editor, Handle::Joint(id));
            tell(editor);
        }
        None => {
            let from = name(&clip, Handle::Joint(from));
            editor.say(Message::note(format!("there is no joint {direction} {from}")));
        }
    }
    Effect::None
}

/// Makes a handle the one that keys move, and its row the selected one.
pub(super) fn activate(editor: &mut Editor, handle: Handle) {
    editor.view.joints.active = handle;
    let tab_idx = TABS.iter().position(|&tab| tab == Tab::Joints).expect("the tab is in the list");
    let row = panel::rows_of(editor, Tab::Joints).iter().position(|row| row.kind == RowKind::Joint(handle));
    editor.view.rows[tab_idx] = row.expect("handles are of this clip");
}

/// Selects the handle that keys move, or takes it out of the selection.
pub(super) fn toggle(editor: &mut Editor) -> Effect {
    toggle_all(editor, &[editor.view.joints.active])
}

/// Selects the chain from the joint that keys move to the root, or takes it out of the selection.
pub(super) fn toggle_chain(editor: &mut Editor) -> Effect {
    match editor.view.joints.active {
        Handle::Position => toggle(editor),
        Handle::Joint(id) => toggle_chain_from(editor, id),
    }
}

/// Selects the chain from a joint to the root, or takes it out of the selection if all of it is selected.
pub(super) fn toggle_chain_from(editor: &mut Editor, id: JointId) -> Effect {
    let skeleton = &editor.document.solved().clip.skeleton;
    let chain = std::iter::successors(Some(id), |&at| skeleton.joint(at).parent);
    let chain: Vec<Handle> = chain.map(Handle::Joint).collect();
    toggle_all(editor, &chain)
}

/// Selects handles, or takes them out of the selection if all of them are selected.
fn toggle_all(editor: &mut Editor, handles: &[Handle]) -> Effect {
    let clip = &editor.document.solved().clip;
    let handles: Vec<Handle> = handles.iter().copied().filter(|&handle| is_editable(clip, handle)).collect();
    if handles.is_empty() {
        let text = format!("{} cannot be edited: {}", name(clip, editor.view.joints.active), reason(clip));
        editor.say(Message::warning(text));
        return Effect::None;
    }
    let selected = &mut editor.view.joints.selected;
    if handles.iter().all(|handle| selected.contains(handle)) {
        selected.retain(|handle| !handles.contains(handle));
    } else {
        selected.extend(handles);
    }
    tell(editor);
    Effect::None
}

/// Says why a handle of the clip may not be editable.
fn reason(clip: &Clip) -> &'static str {
    if clip.facts.path_editable {
        "the file does not give it every rotation, or the carrier hangs below it"
    } else {
        "the file does not let its carrier be placed anew"
    }
}

/// Selects all there is.
pub(super) fn select_all(editor: &mut Editor) -> Effect {
    select(editor, |_| true)
}

/// Selects nothing.
pub(super) fn select_none(editor: &mut Editor) -> Effect {
    select(editor, |_| false)
}

/// Selects what is not selected, and nothing else.
pub(super) fn invert(editor: &mut Editor) -> Effect {
    let before = editor.view.joints.clone();
    select(editor, |handle| !before.is_selected(handle))
}

fn select(editor: &mut Editor, is_wanted: impl Fn(Handle) -> bool) -> Effect {
    let clip = &editor.document.solved().clip;
    editor.view.joints.selected =
        handles(clip).filter(|&handle| is_editable(clip, handle) && is_wanted(handle)).collect();
    tell(editor);
    Effect::None
}

/// Says what keys move and how much is selected.
fn tell(editor: &mut Editor) {
    let clip = &editor.document.solved().clip;
    let joints = &editor.view.joints;
    let here = if joints.is_selected(joints.active) { "selected" } else { "not selected" };
    let text = match joints.selected.len() {
        0 => format!("{}; nothing is selected", name(clip, joints.active)),
        n => format!("{}, {here}; {n} selected", name(clip, joints.active)),
    };
    editor.say(Message::note(text));
    editor.follow_document();
}
