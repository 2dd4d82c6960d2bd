//! What the rows of the command table do that no other part of the editor does: the playhead, the panel's rows, control
//! points, cameras, undo and files.

use glam::DVec3;
use toml::Value;

use super::{
    Asking, Editor, Effect, Message, Prompt, RowKind, TABS, Tab,
    camera::{self, Move},
    feet, layers, loops, map_keys, maps, pose, views,
};
use crate::{
    document::{Change, parameter},
    path::{Shape, ShapeKind},
};

fn selected_row(editor: &Editor) -> Option<super::Row> {
    editor.rows().into_iter().find(|row| row.selected)
}

pub(super) fn steps(editor: &Editor) -> bool {
    match selected_row(editor).map(|r| r.kind) {
        Some(RowKind::Parameter(name)) => stepped(editor, name, 1, false).is_some(),
        Some(RowKind::Plant { .. } | RowKind::Layer { .. }) => true,
        Some(
            RowKind::MapPoint { .. } | RowKind::Point { .. } | RowKind::Loop { .. } | RowKind::Joint(_) | RowKind::Fact,
        )
        | None => false,
    }
}

pub(super) fn types(editor: &Editor) -> bool {
    use RowKind::{Layer, Loop, Parameter, Point};
    selected_row(editor).is_some_and(|r| matches!(r.kind, Parameter(_) | Point { .. } | Loop { .. } | Layer { .. }))
}

/// Says what is too much at the playhead; where nothing is, goes to the next frame at which something begins.
pub(super) fn why(editor: &mut Editor) -> Effect {
    let solved = std::sync::Arc::clone(editor.document.solved());
    let here = editor.view.frame_idx;
    let reasons = solved.why(here);
    if !reasons.is_empty() {
        editor.say(Message::note(reasons.join("; ")));
        return Effect::None;
    }
    let begins = || solved.strains.iter().map(|strain| strain.frames.start);
    match begins().filter(|&first| first > here).min().or_else(|| begins().min()) {
        None => {
            editor.say(Message::note("nothing is too much: bends, strides and reach are what a body can do".to_owned()))
        }
        Some(next) => {
            jump(editor, next);
            let frame = next + solved.clip.rest_frames();
            editor.say(Message::note(format!("frame {frame}: {}", solved.why(next).join("; "))));
        }
    }
    Effect::None
}

pub(super) fn jump(editor: &mut Editor, frame_idx: usize) -> Effect {
    let last = editor.document.solved().edited.n_frames().saturating_sub(1);
    editor.view.jump(frame_idx.min(last));
    Effect::None
}

pub(super) fn step_frame(editor: &mut Editor, by: i64) -> Effect {
    editor.view.playing = false;
    let n_frames = editor.document.solved().edited.n_frames() as i64;
    let next = (editor.view.frame_idx as i64 + by).rem_euclid(n_frames);
    jump(editor, next as usize)
}

pub(super) fn turn_tab(editor: &mut Editor, by: usize) -> Effect {
    editor.view.tab_idx = (editor.view.tab_idx + by) % TABS.len();
    Effect::None
}

pub(super) fn move_row(editor: &mut Editor, by: i64) -> Effect {
    let rows = editor.rows();
    let now = rows.iter().position(|row| row.selected).unwrap_or(0);
    let row = (now as i64 + by).max(0) as usize;
    editor.view.select_row(&rows, row);
    match rows.get(row).map(|row| row.kind) {
        Some(RowKind::Plant { plant_idx }) => feet::go_to(editor, plant_idx),
        Some(RowKind::MapPoint { frame, .. }) => maps::go_to(editor, frame),
        _ => {}
    }
    editor.follow_document();
    Effect::None
}

pub(super) fn step_value(editor: &mut Editor, command: &'static str, name: &str, n: i64, big: bool) -> Effect {
    if name.starts_with("show.") && views::decides(editor, name) {
        return views::toggle(editor, command, name);
    }
    if let Some(value) = stepped(editor, name, n, big) {
        editor.set(command, name, value);
        if editor.view.message.is_none() {
            tell_value(editor, name);
        }
    }
    Effect::None
}

/// Says what a parameter is now: in words, its name in brackets.
fn tell_value(editor: &mut Editor, name: &str) {
    let row = parameter(name).expect("commands name parameters of the table");
    let edits = editor.document.edits();
    let value = match row.get(edits) {
        // Steps of a factor have many digits, of which the first ones are heard.
        Value::Float(number) => format!("{number:.2e}").parse::<f64>().expect("a printed number parses").to_string(),
        _ => row.display(edits),
    };
    let value = if row.unit.is_empty() { value } else { format!("{value} {}", row.unit) };
    editor.say(Message::note(format!("{}: {value} ({name})", in_words(name))));
}

/// Returns what a parameter is called where its section is no part of the name.
fn in_words(name: &str) -> String {
    match name {
        "path.edited" => "walks the new path".to_owned(),
        "path.nudge" | "pose.nudge" | "pose.turn" => "step".to_owned(),
        _ => name.rsplit('.').next().expect("a name has a last part").replace('_', " "),
    }
}

pub(super) fn step_row(editor: &mut Editor, command: &'static str, n: i64, big: bool) -> Effect {
    match selected_row(editor).map(|r| r.kind) {
        Some(RowKind::Parameter(name)) => {
            if let Some(value) = stepped(editor, name, n, big) {
                editor.set(command, name, value);
            }
            Effect::None
        }
        Some(RowKind::Plant { .. }) => feet::step_mode(editor, command, n),
        Some(RowKind::Layer { .. }) => layers::weigh(editor, command, n, big),
        _ => Effect::None,
    }
}

fn stepped(editor: &Editor, name: &str, n: i64, big: bool) -> Option<Value> {
    let parameter = parameter(name).expect("rows and commands name parameters of the table");
    parameter.stepped(editor.document.edits(), editor.document.solved().in_use(name), n, big)
}

pub(super) fn default_row(editor: &mut Editor, command: &'static str) -> Effect {
    match selected_row(editor).map(|r| r.kind) {
        Some(RowKind::Parameter(name)) => {
            let default = parameter(name).expect("rows name parameters of the table").default_value();
            editor.set(command, name, default);
            editor.end_step();
            Effect::None
        }
        Some(RowKind::Plant { .. }) => feet::plant_as_found(editor, command),
        Some(RowKind::Layer { .. }) => layers::whole_weight(editor, command),
        _ => Effect::None,
    }
}

pub(super) fn ask(editor: &mut Editor, asking: Asking, offered: &str) -> Effect {
    editor.prompt = Some(Prompt::new(asking, offered));
    Effect::None
}

pub(super) fn type_row(editor: &mut Editor) -> Effect {
    match selected_row(editor).map(|r| (r.kind, r.value)) {
        Some((RowKind::Parameter(name), value)) => {
            // A list is offered whole, not as the count that the panel shows.
            let whole = parameter(name).expect("rows name parameters of the table").get(editor.document.edits());
            let offered = if whole.is_array() { crate::document::show_value(&whole) } else { value };
            ask(editor, Asking::Value { name }, &offered)
        }
        Some((RowKind::Point { .. }, _)) => type_point(editor),
        Some((RowKind::Loop { loop_idx }, _)) => loops::take(editor, "loop.take", loop_idx),
        Some((RowKind::Layer { .. }, _)) => layers::ask_name(editor),
        _ => Effect::None,
    }
}

pub(super) fn type_point(editor: &mut Editor) -> Effect {
    let point_idx = editor.view.point_idx;
    let p = editor.document.solved().control_points()[point_idx];
    let offered = editor.offered_place(p);
    ask(editor, Asking::Coordinates { point_idx }, &offered)
}

pub(super) fn choose_point(editor: &mut Editor, by: i64) -> Effect {
    let n_points = editor.document.solved().control_points().len() as i64;
    editor.view.point_idx = (editor.view.point_idx as i64 + by).rem_euclid(n_points) as usize;
    show_point_row(editor);
    editor.follow_document();
    Effect::None
}

/// Moves the panel's selection to the selected point's row, where the panel shows points.
fn show_point_row(editor: &mut Editor) {
    if TABS[editor.view.tab_idx] == Tab::Path {
        let wanted = RowKind::Point { point_idx: editor.view.point_idx };
        if let Some(row) = editor.rows().iter().position(|r| r.kind == wanted) {
            editor.view.rows[editor.view.tab_idx] = row;
        }
    }
}

pub(super) fn nudge(editor: &mut Editor, command: &'static str, direction: DVec3) -> Effect {
    if pose::is_open(editor) { pose::step(editor, command, direction) } else { nudge_point(editor, command, direction) }
}

pub(super) fn nudge_name(editor: &Editor) -> &'static str {
    if pose::is_open(editor) { pose::step_name(editor) } else { "path.nudge" }
}

fn nudge_point(editor: &mut Editor, command: &'static str, direction: DVec3) -> Effect {
    let solved = editor.document.solved();
    let point_idx = editor.view.point_idx;
    let step = editor.document.edits().path.nudge * solved.clip.facts.height.value;
    let to = solved.control_points()[point_idx] + step * direction;
    editor.change(command, &Change::PlacePoint { point_idx, to });
    show_point_row(editor);
    Effect::None
}

pub(super) fn insert_point(editor: &mut Editor, command: &'static str) -> Effect {
    let before = editor.document.solved().control_points().len();
    editor.change(command, &Change::InsertPoint { after_idx: editor.view.point_idx });
    if editor.document.solved().control_points().len() > before {
        editor.view.point_idx += 1;
        show_point_row(editor);
        editor.follow_document();
    }
    editor.end_step();
    Effect::None
}

pub(super) fn delete_point(editor: &mut Editor, command: &'static str) -> Effect {
    editor.change(command, &Change::DeletePoint { point_idx: editor.view.point_idx });
    editor.end_step();
    Effect::None
}

pub(super) fn shape(editor: &mut Editor, command: &'static str, kind: ShapeKind) -> Effect {
    editor.change(command, &Change::Set { values: Vec::new(), shape: Some(Shape { kind, size: 1.0 }) });
    editor.end_step();
    Effect::None
}

pub(super) fn set_camera(editor: &mut Editor, command: &'static str, field: &str, value: Value) -> Effect {
    let name = format!("camera.{}.{field}", editor.view.camera_idx + 1);
    editor.set(command, &name, value);
    views::tell_moved(editor, &format!(" ({name})"));
    Effect::None
}

pub(super) fn toggle_follow(editor: &mut Editor, command: &'static str) -> Effect {
    camera::toggle_follow(editor, command);
    let camera_idx = editor.view.camera_idx;
    let stands = if editor.document.edits().view.cameras[camera_idx].follow { "" } else { ", standing still" };
    views::tell_moved(editor, &format!("{stands} (camera.{}.follow)", camera_idx + 1));
    Effect::None
}

pub(super) fn move_camera(editor: &mut Editor, command: &'static str, by: Move) -> Effect {
    camera::change(editor, command, by);
    views::tell_moved(editor, &format!(": {}", camera::in_words(by)));
    Effect::None
}

/// Undoes a step.
pub(super) fn undo(editor: &mut Editor) -> Effect {
    if let Some(what) = map_keys::take_back(editor) {
        editor.say(Message::note(format!("undone: {what}; set again with I")));
        return Effect::None;
    }
    let what = editor.document.undoable().map(str::to_owned);
    editor.document.undo();
    travelled(editor, "undo", what)
}

/// Does a step again.
pub(super) fn redo(editor: &mut Editor) -> Effect {
    let what = editor.document.redoable().map(str::to_owned);
    editor.document.redo();
    travelled(editor, "redo", what)
}

/// Says what was undone or done again, and how far one can go on.
fn travelled(editor: &mut Editor, verb: &str, what: Option<String>) -> Effect {
    let (back, forward) = editor.document.depth();
    editor.say(Message::note(match what {
        Some(what) => format!("{verb}ne: {what} ({back} behind, {forward} ahead)"),
        None => format!("nothing to {verb}"),
    }));
    editor.follow_document();
    Effect::None
}

pub(super) fn project_name(editor: &Editor) -> String {
    let source = &editor.document.solved().source;
    let named = editor.document.project().map(|p| p.display().to_string());
    named.unwrap_or_else(|| match &source.file {
        Some(file) => file.with_extension("toml").display().to_string(),
        None => "walk.toml".to_owned(),
    })
}

pub(super) fn export_name(editor: &Editor) -> String {
    let source = &editor.document.solved().source;
    match &source.file {
        Some(file) => {
            let stem = file.file_stem().map_or_else(|| "walk".into(), |s| s.to_string_lossy());
            file.with_file_name(format!("{stem}_edited.bvh")).display().to_string()
        }
        None => "walk_edited.bvh".to_owned(),
    }
}

pub(super) fn save(editor: &mut Editor) -> Effect {
    match editor.document.project().map(std::path::Path::to_owned) {
        Some(file) => {
            editor.save_to(&file);
            Effect::None
        }
        None => {
            let offered = project_name(editor);
            ask(editor, Asking::Save, &offered)
        }
    }
}
