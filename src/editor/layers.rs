//! Layers of displacement maps: their list, and the keys that change it.
//!
//! The list stands as it is laid, the uppermost layer first. One of its layers is in use: poses and keys go into it.

use super::{Asking, COMMANDS, Editor, Effect, Message, Prompt, Row, RowKind, TABS, Tab, panel::counted};
use crate::{
    displace::{Interpolation, Layer},
    document::{Change, ChangeError, LayerChange, LayerRefusal},
};

/// Change of a weight by one key press; a big step is ten times that.
const WEIGHT_STEP: f64 = 0.05;

/// What is shown of a layer's keys: three lines of the panel at most.
const HELP: &str = "+ - [ ] weight, enter name; after B: o on or off, i interpolation, k j higher or lower, m merge, \
                    p r clear its maps, n new, d delete.";

/// The same of a layer that is part of the motion.
const MERGED_HELP: &str = "Part of the motion, below the others: enter names it; after B: d deletes it, n makes a new \
                           layer for edits.";

/// Returns the rows of the list.
pub(super) fn rows(editor: &Editor) -> Vec<Row> {
    let layers = editor.document.edits().layers.iter().enumerate().rev();
    let row = |(layer_idx, layer): (usize, &Layer)| {
        let in_use = layer_idx == editor.view.layer_idx;
        let sign = match (layer.merged, in_use, layer.on) {
            (true, _, true) => '■',
            (true, _, false) => '□',
            (_, true, _) => '◆',
            (_, _, true) => '●',
            (_, _, false) => '○',
        };
        let state = if layer.merged && layer.on { "merged" } else { on_off(layer.on) };
        let merged = if layer.merged && !layer.on { ", merged" } else { "" };
        let (way, keys) = (layer.interpolation.words(), keys_in_words(layer));
        Row {
            kind: RowKind::Layer { layer_idx },
            label: format!("{sign} {}", layer.name),
            value: format!("{state}{merged} {:.2} {way}, {keys}", layer.weight),
            unit: "",
            changed: layer.merged || !layer.on || layer.weight != 1.0,
            selected: false,
            help: if layer.merged { MERGED_HELP } else { HELP }.to_owned(),
        }
    };
    layers.map(row).collect()
}

fn on_off(on: bool) -> &'static str {
    if on { "on" } else { "off" }
}

/// Says how many keys a layer has.
fn keys_in_words(layer: &Layer) -> String {
    counted(layer.frames().count(), "key")
}

/// Says why a change cannot be made, and the key that helps.
pub(super) fn refusal(error: &ChangeError) -> String {
    match error {
        ChangeError::Layer(LayerRefusal::AllMerged(_)) => format!("{error}: {} makes one", key("layer.add")),
        ChangeError::Layer(LayerRefusal::NothingSelected) => {
            format!("{error}, {} the chain to the root", key("joint.chain"))
        }
        _ => error.to_string(),
    }
}

/// Returns the first key of a command.
fn key(name: &str) -> &'static str {
    COMMANDS.iter().find(|command| command.name == name).expect("a row of the table").keys[0]
}

/// Tells whether there is a layer in use.
pub(super) fn any(editor: &Editor) -> bool {
    !editor.document.edits().layers.is_empty()
}

/// Makes a layer above all others and takes it into use.
pub(super) fn add(editor: &mut Editor, command: &'static str) -> Effect {
    if change(editor, command, LayerChange::Add { name: String::new() }) {
        take(editor, editor.document.edits().layers.len() - 1);
    }
    Effect::None
}

/// Takes the next higher layer into use, round at the top.
pub(super) fn next(editor: &mut Editor) -> Effect {
    let n = editor.document.edits().layers.len();
    take(editor, (editor.view.layer_idx + 1) % n.max(1));
    Effect::None
}

/// Takes a layer into use and says so.
fn take(editor: &mut Editor, layer_idx: usize) {
    editor.view.layer_idx = layer_idx;
    show_row(editor);
    tell(editor);
}

/// Selects the row of the layer in use.
fn show_row(editor: &mut Editor) {
    let tab_idx = TABS.iter().position(|&tab| tab == Tab::Layers).expect("the tab is in the list");
    editor.view.rows[tab_idx] = editor.document.edits().layers.len().saturating_sub(1 + editor.view.layer_idx);
}

/// Says what the layer in use is.
fn tell(editor: &mut Editor) {
    if let Some(layer) = editor.document.edits().layers.get(editor.view.layer_idx) {
        let merged = if layer.merged { ", merged" } else { "" };
        let (on, way) = (on_off(layer.on), layer.interpolation.words());
        let keys = keys_in_words(layer);
        let text = format!("{}: {on}, weight {:.2}, {way}, {keys}{merged}", layer.name, layer.weight);
        editor.say(Message::note(text));
    }
}

/// Takes the layer in use out.
pub(super) fn delete(editor: &mut Editor, command: &'static str) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let name = editor.document.edits().layers.get(layer_idx).map_or_else(String::new, |layer| layer.name.clone());
    if change(editor, command, LayerChange::Delete { layer_idx }) {
        show_row(editor);
        editor.say(Message::note(format!("{name} is deleted; u takes it back")));
    }
    Effect::None
}

/// Switches the layer in use on or off.
pub(super) fn switch(editor: &mut Editor, command: &'static str) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let on = editor.document.edits().layers.get(layer_idx).is_some_and(|layer| !layer.on);
    and_tell(editor, command, LayerChange::Switch { layer_idx, on })
}

/// Lets the layer in use interpolate in the next way.
pub(super) fn interpolate(editor: &mut Editor, command: &'static str) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let Some(layer) = editor.document.edits().layers.get(layer_idx) else { return Effect::None };
    let all = Interpolation::ALL;
    let at = all.iter().position(|way| *way == layer.interpolation).expect("all ways are listed");
    and_tell(editor, command, LayerChange::Interpolate { layer_idx, interpolation: all[(at + 1) % all.len()] })
}

/// Changes the weight of the layer in use.
pub(super) fn weigh(editor: &mut Editor, command: &'static str, n: i64, big: bool) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let Some(layer) = editor.document.edits().layers.get(layer_idx) else { return Effect::None };
    let step = n as f64 * WEIGHT_STEP * if big { 10.0 } else { 1.0 };
    // Weights are whole hundredths, so that they print as they are meant.
    let weight = ((layer.weight + step) * 100.0).round() / 100.0;
    and_tell(editor, command, LayerChange::Weigh { layer_idx, weight })
}

/// Gives the layer in use all of its weight.
pub(super) fn whole_weight(editor: &mut Editor, command: &'static str) -> Effect {
    let layer_idx = editor.view.layer_idx;
    and_tell(editor, command, LayerChange::Weigh { layer_idx, weight: 1.0 })
}

/// Lets the layer in use change places with the one above or below.
pub(super) fn shift(editor: &mut Editor, command: &'static str, up: bool) -> Effect {
    let layer_idx = editor.view.layer_idx;
    if change(editor, command, LayerChange::Move { layer_idx, up }) {
        take(editor, if up { layer_idx + 1 } else { layer_idx - 1 });
    }
    Effect::None
}

/// Makes the layer in use part of the motion.
pub(super) fn merge(editor: &mut Editor, command: &'static str) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let name = editor.document.edits().layers.get(layer_idx).map(|layer| layer.name.clone());
    if change(editor, command, LayerChange::Merge { layer_idx }) {
        // Merged layers go to the bottom of the list.
        let layers = &editor.document.edits().layers;
        let at = layers.iter().rposition(|layer| layer.merged).unwrap_or(0);
        editor.view.layer_idx = at;
        show_row(editor);
        let name = name.unwrap_or_default();
        editor.say(Message::note(format!("{name} and what is in effect below it are part of the motion now")));
    }
    Effect::None
}

/// Takes all position keys, or all rotation keys, of the layer in use away.
pub(super) fn clear(editor: &mut Editor, command: &'static str, position: bool) -> Effect {
    let layer_idx = editor.view.layer_idx;
    let clear =
        if position { LayerChange::ClearPosition { layer_idx } } else { LayerChange::ClearRotations { layer_idx } };
    and_tell(editor, command, clear)
}

/// Clears the clip's own data, or brings it back.
pub(super) fn clear_clip(editor: &mut Editor, command: &'static str, name: &'static str) -> Effect {
    let cleared = editor.document.edits().cleared;
    let is_cleared = if name == "clip.clear_position" { cleared.position } else { cleared.rotation };
    editor.set(command, name, toml::Value::Boolean(!is_cleared));
    editor.end_step();
    if editor.view.message.is_none() {
        let data = if name == "clip.clear_position" { "position" } else { "rotation" };
        let how = if is_cleared { "in use again" } else { "cleared" };
        editor.say(Message::note(format!("the clip's own {data} data: {how} ({name})")));
    }
    Effect::None
}

/// Asks for the name of the layer in use.
pub(super) fn ask_name(editor: &mut Editor) -> Effect {
    let layer_idx = editor.view.layer_idx;
    if let Some(layer) = editor.document.edits().layers.get(layer_idx) {
        editor.prompt = Some(Prompt::new(Asking::LayerName { layer_idx }, &layer.name));
    }
    Effect::None
}

/// Names a layer.
pub(super) fn rename(editor: &mut Editor, layer_idx: usize, name: &str) {
    match name.trim() {
        "" => editor.say(Message::error("a layer needs a name".to_owned())),
        name => {
            let was = editor.document.edits().layers.get(layer_idx).map(|layer| layer.name.clone());
            let renamed = LayerChange::Rename { layer_idx, name: name.to_owned() };
            if change(editor, "layer.rename", renamed) {
                editor.say(Message::note(format!("{} is called {name} now", was.unwrap_or_default())));
            }
        }
    }
}

fn and_tell(editor: &mut Editor, command: &'static str, done: LayerChange) -> Effect {
    if change(editor, command, done) {
        tell(editor);
    }
    Effect::None
}

/// Changes the list; a weight that goes on changing is one step of undo. Tells whether it could be done without a word.
fn change(editor: &mut Editor, command: &'static str, change: LayerChange) -> bool {
    let is_weight = matches!(change, LayerChange::Weigh { .. });
    editor.change(command, &Change::Layer(change));
    if !is_weight {
        editor.end_step();
    }
    editor.view.message.is_none()
}
