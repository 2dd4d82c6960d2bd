//! Keys of displacement maps under the playhead: added, deleted, walked, moved and copied; and the two interpolation
//! keys between which the clip is replaced.
//!
//! They sit at file frames, those of the frame of the clip that is seen. Commands are about the selected maps of the
//! layer in use, or about the active joint's while nothing is selected; the carrier as a joint has two.

use toml::Value;

use super::{Asking, Editor, Effect, Handle, Message, Prompt, maps, panel::counted};
use crate::{
    displace::{Layer, Selection, joint_name},
    document::{Change, KeyChange, LayerRefusal},
};

impl Editor {
    /// Returns the layer that keys act on; none before there is one.
    pub fn layer(&self) -> Option<&Layer> {
        self.document.edits().layers.get(self.view.layer_idx)
    }

    /// Returns the file frames of the keys that are walked, rising.
    pub fn key_frames(&self) -> Vec<usize> {
        self.layer().map_or_else(Vec::new, |layer| layer.key_frames(&self.map_selection()))
    }

    /// Returns the file frame under the playhead.
    fn file_frame(&self) -> usize {
        let solved = self.document.solved();
        solved.clip.file_frame(solved.source_frame(self.view.frame_idx))
    }
}

/// Adds keys at the playhead that change no pose.
pub(super) fn add(editor: &mut Editor, command: &'static str) -> Effect {
    let frame = editor.file_frame();
    change(editor, command, KeyChange::Add { frame });
    Effect::None
}

/// Deletes the keys at the playhead.
pub(super) fn delete(editor: &mut Editor, command: &'static str) -> Effect {
    let frame = editor.file_frame();
    change(editor, command, KeyChange::Delete { frame });
    Effect::None
}

/// Asks for the frame that the keys at the playhead move to.
pub(super) fn ask_move(editor: &mut Editor) -> Effect {
    ask(editor, |from| Asking::MoveKeys { from })
}

/// Asks for the frame that the keys at the playhead are copied to.
pub(super) fn ask_copy(editor: &mut Editor) -> Effect {
    ask(editor, |from| Asking::CopyKeys { from })
}

fn ask(editor: &mut Editor, asking: fn(usize) -> Asking) -> Effect {
    let from = editor.file_frame();
    if editor.key_frames().contains(&from) {
        editor.prompt = Some(Prompt::new(asking(from), &from.to_string()));
    } else {
        editor.say(Message::note(LayerRefusal::NoKey(from).to_string()));
    }
    Effect::None
}

/// Makes a change of keys of which the user typed the frame it goes to, and shows that frame.
pub(super) fn typed_frame(editor: &mut Editor, text: &str, what: impl Fn(usize) -> KeyChange) {
    let Ok(to) = text.trim().parse::<usize>() else {
        editor.say(Message::error(format!("expected a frame of the file, found `{text}`")));
        return;
    };
    let before = editor.document.depth();
    change(editor, "type", what(to));
    if editor.document.depth() != before {
        go_to(editor, to);
        tell(editor);
    }
}

/// Walks to the next key, round at the end.
pub(super) fn next(editor: &mut Editor) -> Effect {
    walk(editor, |frames, at| frames.iter().find(|&&frame| frame > at).or(frames.first()).copied())
}

/// Walks to the key before, round at the start.
pub(super) fn previous(editor: &mut Editor) -> Effect {
    walk(editor, |frames, at| frames.iter().rfind(|&&frame| frame < at).or(frames.last()).copied())
}

fn walk(editor: &mut Editor, choose: fn(&[usize], usize) -> Option<usize>) -> Effect {
    match choose(&editor.key_frames(), editor.file_frame()) {
        Some(frame) => {
            go_to(editor, frame);
            tell(editor);
        }
        None => editor.say(Message::note("there are no keys to walk to".to_owned())),
    }
    Effect::None
}

/// Shows a frame of the file.
fn go_to(editor: &mut Editor, file_frame: usize) {
    editor.view.playing = false;
    maps::go_to(editor, file_frame);
}

fn change(editor: &mut Editor, command: &'static str, change: KeyChange) {
    let selection = editor.map_selection();
    editor.view.playing = false;
    editor.change(command, &Change::Keys { layer_idx: editor.view.layer_idx, selection, change });
    editor.end_step();
    if editor.view.message.is_none() {
        tell(editor);
    }
}

/// Says how many of the selected maps have a key at the playhead.
pub(super) fn tell(editor: &mut Editor) {
    let selection = editor.map_selection();
    tell_of(editor, &selection);
}

/// Says how many of these maps have a key at the playhead.
pub(super) fn tell_of(editor: &mut Editor, maps: &Selection) {
    let Some(layer) = editor.layer() else { return };
    let frame = editor.file_frame();
    let points = layer.map_points(maps);
    let here = points.iter().filter(|point| point.frame == frame).count();
    let here = counted(here, "key");
    let mut text = format!("{}: {here} at file frame {frame}, {} in all", layer.name, points.len());
    let of_layer = layer.position.len() + layer.rotation.values().map(|keys| keys.len()).sum::<usize>();
    if of_layer > points.len() {
        text += &format!(" of what is selected, {of_layer} in the layer");
    }
    editor.say(Message::note(text));
}

/// Says how many keys a handle has in the layer in use, with a `◆` when one is under the playhead; none for none.
pub(super) fn count(editor: &Editor, handle: Handle) -> Option<String> {
    let layer = editor.layer()?;
    let frames: Vec<usize> = match handle {
        Handle::Position => layer.position.iter().map(|key| key.frame).collect(),
        Handle::Joint(id) => {
            let keys = layer.rotation.get(&joint_name(&editor.document.solved().clip.skeleton, id))?;
            keys.iter().map(|key| key.frame).collect()
        }
    };
    let sign = if frames.contains(&editor.file_frame()) { "◆ " } else { "" };
    (!frames.is_empty()).then(|| format!("{sign}{}", counted(frames.len(), "key")))
}

/// Sets an interpolation key at the playhead; the second one makes a range.
pub(super) fn interpolate(editor: &mut Editor, command: &'static str) -> Effect {
    let here = editor.file_frame();
    editor.view.playing = false;
    match editor.view.interpolated_from.take() {
        Some(from) if from != here => {
            let frames = [from.min(here), from.max(here)].map(|frame| Value::Integer(frame as i64));
            editor.set(command, "interpolation_keys", Value::Array(frames.to_vec()));
            editor.end_step();
            if editor.view.message.is_none() {
                let text = format!("interpolated between file frames {} and {}", frames[0], frames[1]);
                editor.say(Message::note(text));
            }
        }
        Some(_) => editor.say(Message::note("no interpolation key: two at one frame are none".to_owned())),
        None => {
            editor.view.interpolated_from = Some(here);
            editor.view.interpolated_behind = editor.document.depth().0;
            let text = format!("an interpolation key at file frame {here}; I at another frame sets the second");
            editor.say(Message::note(text));
        }
    }
    Effect::None
}

/// Takes the first of two interpolation keys back while nothing was done after it; returns what that was.
pub(super) fn take_back(editor: &mut Editor) -> Option<String> {
    let frame = editor.view.interpolated_from?;
    if editor.document.depth().0 != editor.view.interpolated_behind {
        return None;
    }
    editor.view.interpolated_from = None;
    Some(format!("interpolation key at file frame {frame}"))
}

/// Tells whether there is an interpolation key.
pub(super) fn is_interpolated(editor: &Editor) -> bool {
    editor.view.interpolated_from.is_some() || editor.document.edits().interpolation_keys.is_some()
}

/// Deletes the interpolation keys.
pub(super) fn uninterpolate(editor: &mut Editor, command: &'static str) -> Effect {
    editor.view.interpolated_from = None;
    if editor.document.edits().interpolation_keys.is_some() {
        editor.set(command, "interpolation_keys", Value::Array(Vec::new()));
        editor.end_step();
    }
    if editor.view.message.is_none() {
        editor.say(Message::note("no interpolation keys: the clip is as it was".to_owned()));
    }
    Effect::None
}
