//! The loops that blended cycling can repeat: their list, and the keys that take one.

use toml::Value;

use super::{
    Editor, Effect, Message, Row, RowKind,
    panel::{counted, fact},
};
use crate::{document::Change, path::Cycling};

/// Returns the loops that were found, the best first, once there is something to repeat.
pub(super) fn rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let Some(loops) = &solved.loops else { return Vec::new() };
    let rest = solved.clip.rest_frames();
    let in_use = solved.walked.repeat.map_or_else(
        || "the path is no longer than the clip".to_owned(),
        |_| counted(solved.measures.seam.len(), "seam"),
    );
    let in_use = fact("repeated", in_use, "How often the loop begins again before the path ends.".to_owned());
    let found = loops.best.iter().enumerate().map(|(loop_idx, found)| {
        let (range, mismatch) = (found.range, found.mismatch);
        let used = loops.used.is_some_and(|used| used.range == range);
        let secs = range.n_frames() as f64 * solved.clip.frame_time_secs;
        let phase = mismatch.phase.map_or_else(|| "–".to_owned(), |phase| format!("{phase:.2}"));
        let (first, end) = (range.first + rest, range.end + rest);
        Row {
            kind: RowKind::Loop { loop_idx },
            label: format!("{} loop {first}–{end}", if used { '◆' } else { '○' }),
            value: format!("{secs:.2} s  {:.3} {:.2} {phase}", mismatch.pose, mismatch.velocity),
            unit: "",
            changed: false,
            selected: false,
            help: format!(
                "enter repeats file frames {first} to {end}. Its ends differ by {mismatch} (0 the same, 1 opposite steps)."
            ),
        }
    });
    std::iter::once(in_use).chain(found).collect()
}

/// Turns blended cycling on; once it is, takes the loop after the one in use.
pub(super) fn next(editor: &mut Editor, command: &'static str) -> Effect {
    if editor.document.edits().timing.cycling != Cycling::Blended {
        editor.set(command, "timing.cycling", Value::String("blended".to_owned()));
        editor.end_step();
        if editor.view.message.is_none() {
            tell(editor);
        }
        return Effect::None;
    }
    let Some(loops) = editor.document.solved().loops.clone() else {
        editor.say(Message::note("loops are for the new path walked by arc length".to_owned()));
        return Effect::None;
    };
    let used = loops.best.iter().position(|found| loops.used.is_some_and(|used| used.range == found.range));
    match loops.best.len() {
        0 => editor.say(Message::note("no loop was found; the whole clip is repeated".to_owned())),
        n => return take(editor, command, used.map_or(0, |idx| (idx + 1) % n)),
    }
    Effect::None
}

/// Repeats one of the loops that were found.
pub(super) fn take(editor: &mut Editor, command: &'static str, loop_idx: usize) -> Effect {
    let solved = editor.document.solved();
    let rest = solved.clip.rest_frames();
    let Some(range) = solved.loops.as_ref().and_then(|loops| loops.best.get(loop_idx)).map(|found| found.range) else {
        return Effect::None;
    };
    let frame = |frame: usize| Value::Integer((frame + rest) as i64);
    let values = vec![("loop.start".to_owned(), frame(range.first)), ("loop.end".to_owned(), frame(range.end))];
    editor.change(command, &Change::Set { values, shape: None });
    editor.end_step();
    if editor.view.message.is_none() {
        tell(editor);
    }
    Effect::None
}

/// Says which loop is in use and how its ends meet.
fn tell(editor: &mut Editor) {
    let solved = editor.document.solved();
    let rest = solved.clip.rest_frames();
    let Some(used) = solved.loops.as_ref().and_then(|loops| loops.used) else { return };
    let (first, end) = (used.range.first + rest, used.range.end + rest);
    let secs = used.range.n_frames() as f64 * solved.clip.frame_time_secs;
    let idle = if solved.walked.repeat.is_none() { "; the path is no longer than the clip" } else { "" };
    editor.say(Message::note(format!(
        "loop: file frames {first} to {end}, {secs:.2} s, ends differ by {}{idle}",
        used.mismatch
    )));
}
