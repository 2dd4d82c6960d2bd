//! Foot plants under the playhead: which one keys act on, and what they do to it.
//!
//! There is no selection to lose: the plant that keys act on is the chosen foot's plant under the playhead, or the one
//! nearest to it. Walking from plant to plant moves the playhead, and so does moving an end of a plant, so that the
//! foot is seen where it is edited.

use super::{Editor, Effect, Message, RowKind, TABS, Tab};
use crate::{
    contact::{Plant, PlantChange, PlantMode},
    document::{Change, NO_LEGS, ShownPlant, Solved},
    motion::Side,
};

/// Length of a plant that is added, seconds: about how long a foot of a brisk walker stands at the least.
const ADDED_SECS: f64 = 0.3;

/// Modes in the order in which keys go through them.
const MODES: [PlantMode; 3] = [PlantMode::Hold, PlantMode::Clean, PlantMode::Slide];

/// Returns a mode's name, as projects have it.
pub(super) fn mode_name(mode: PlantMode) -> &'static str {
    match mode {
        PlantMode::Hold => "hold",
        PlantMode::Clean => "clean",
        PlantMode::Slide => "slide",
    }
}

impl Editor {
    /// Returns the index of the foot whose plants keys act on; none for a clip without legs.
    pub fn chosen_foot(&self) -> Option<usize> {
        let feet = &self.document.solved().feet;
        feet.foot_idx(self.view.foot).or_else(|| feet.foot_idx(other(self.view.foot)))
    }

    /// Returns the indices of the foot and of its plant that keys act on; none for a foot without plants.
    pub fn chosen_plant(&self) -> Option<(usize, usize)> {
        let foot_idx = self.chosen_foot()?;
        let at = self.source_frame();
        let plants = &self.document.solved().feet.plants[foot_idx].plants;
        let away = |plant: &Plant| plant.first.saturating_sub(at).max(at.saturating_sub(plant.last));
        let nearest = plants.iter().enumerate().min_by_key(|(_, plant)| away(plant))?;
        Some((foot_idx, nearest.0))
    }

    /// Returns the clip's frame under the playhead.
    fn source_frame(&self) -> usize {
        self.document.solved().source_frame(self.view.frame_idx)
    }
}

pub(super) fn has_foot(editor: &Editor) -> bool {
    editor.chosen_foot().is_some()
}

pub(super) fn has_feet(editor: &Editor) -> bool {
    let feet = &editor.document.solved().feet;
    [Side::Left, Side::Right].iter().all(|side| feet.foot_idx(*side).is_some())
}

pub(super) fn has_plant(editor: &Editor) -> bool {
    editor.chosen_plant().is_some()
}

/// Says why a key of feet does nothing now.
pub(super) fn why_idle(editor: &Editor) -> String {
    match (editor.chosen_foot(), editor.chosen_plant()) {
        (None, _) => NO_LEGS.to_owned(),
        (Some(foot_idx), None) => {
            format!("the {} foot has no plants; ma adds one", side(editor.document.solved(), foot_idx).name())
        }
        (Some(_), Some(_)) => "only one leg is known; clip.legs names legs".to_owned(),
    }
}

/// Chooses the foot on the other side.
pub(super) fn choose_other(editor: &mut Editor) -> Effect {
    if let Some(foot_idx) = editor.chosen_foot() {
        editor.view.foot = other(side(editor.document.solved(), foot_idx));
        tell(editor);
    }
    Effect::None
}

/// Walks to the plant after the playhead, of those that the edited clip shows, round at the end.
pub(super) fn next(editor: &mut Editor) -> Effect {
    walk(editor, |shown, at| shown.iter().position(|plant| plant.first > at).unwrap_or(0))
}

/// Walks to the plant before the playhead, of those that the edited clip shows, round at the start.
pub(super) fn previous(editor: &mut Editor) -> Effect {
    walk(editor, |shown, at| shown.iter().rposition(|plant| plant.last < at).unwrap_or(shown.len() - 1))
}

fn walk(editor: &mut Editor, choose: fn(&[ShownPlant], usize) -> usize) -> Effect {
    let Some(foot_idx) = editor.chosen_foot() else { return Effect::None };
    let solved = editor.document.solved();
    let shown: Vec<_> = solved.shown_plants(foot_idx).collect();
    if shown.is_empty() {
        let side = side(solved, foot_idx).name();
        editor.say(Message::warning(format!("the path ends before the first {side} plant")));
        return Effect::None;
    }
    let first = shown[choose(&shown, editor.view.frame_idx)].first;
    editor.view.playing = false;
    editor.view.jump(first);
    show_plant_row(editor);
    tell(editor);
    Effect::None
}

/// Moves the playhead to the first frame of one of the chosen foot's plants.
pub(super) fn go_to(editor: &mut Editor, plant_idx: usize) {
    let Some(foot_idx) = editor.chosen_foot() else { return };
    let solved = editor.document.solved();
    let Some(first) = solved.feet.plants[foot_idx].plants.get(plant_idx).map(|p| p.first) else { return };
    if solved.edited_frame(first).is_none() {
        let (side, frames) = (side(solved, foot_idx).name(), text(solved, foot_idx, plant_idx));
        editor.say(Message::warning(format!("{side} plant {} is not shown on this path: {frames}", plant_idx + 1)));
        return;
    }
    show(editor, first);
    show_plant_row(editor);
    tell(editor);
}

/// Moves the panel's selection to the plant that keys act on, where the panel shows plants.
fn show_plant_row(editor: &mut Editor) {
    let Some((_, plant_idx)) = editor.chosen_plant() else { return };
    if TABS[editor.view.tab_idx] == Tab::Feet
        && let Some(row) = editor.rows().iter().position(|row| row.kind == RowKind::Plant { plant_idx })
    {
        editor.view.rows[editor.view.tab_idx] = row;
    }
}

/// Shows a frame of the clip, or the last one where the path ends before it; in the cycle that is nearest.
fn show(editor: &mut Editor, source_frame: usize) {
    let frame_idx = editor.document.solved().edited_frame_near(source_frame, editor.view.frame_idx);
    editor.view.playing = false;
    editor.view.jump(frame_idx);
}

/// Says which plant keys act on.
fn tell(editor: &mut Editor) {
    let solved = editor.document.solved();
    let text = match editor.chosen_plant() {
        Some((foot_idx, plant_idx)) => {
            let foot = &solved.feet.plants[foot_idx];
            let n = foot.plants.len();
            format!("{} plant {} of {n}: {}", foot.leg.side.name(), plant_idx + 1, text(solved, foot_idx, plant_idx))
        }
        None => format!("no {} plants", editor.chosen_foot().map_or("foot", |f| side(solved, f).name())),
    };
    editor.say(Message::note(text));
}

/// Returns a plant's frames in the file and its mode, a `!` before them when it was missed.
pub(super) fn text(solved: &Solved, foot_idx: usize, plant_idx: usize) -> String {
    let plant = &solved.feet.plants[foot_idx].plants[plant_idx];
    let [first, last] = [plant.first, plant.last].map(|frame| solved.clip.file_frame(frame));
    let missed = if solved.missed(foot_idx, plant_idx).is_some() { "! " } else { "" };
    format!("{missed}{first}–{last} {}", mode_name(plant.mode))
}

/// Moves the plant's first frame.
pub(super) fn move_first(editor: &mut Editor, command: &'static str, by: isize) -> Effect {
    if let Some((foot_idx, plant)) = editor.chosen_plant() {
        change(editor, command, PlantChange::MoveFirst { plant, by });
        let first = editor.document.solved().feet.plants[foot_idx].plants[plant].first;
        show(editor, first);
    }
    Effect::None
}

/// Moves the plant's last frame.
pub(super) fn move_last(editor: &mut Editor, command: &'static str, by: isize) -> Effect {
    if let Some((foot_idx, plant)) = editor.chosen_plant() {
        change(editor, command, PlantChange::MoveLast { plant, by });
        let last = editor.document.solved().feet.plants[foot_idx].plants[plant].last;
        show(editor, last);
    }
    Effect::None
}

/// Cuts the plant in two at the playhead.
pub(super) fn split(editor: &mut Editor, command: &'static str) -> Effect {
    let frame = editor.source_frame();
    step(editor, command, PlantChange::Split { frame })
}

/// Makes one plant of this one and the next.
pub(super) fn join(editor: &mut Editor, command: &'static str) -> Effect {
    of_chosen(editor, command, |plant| PlantChange::Join { plant })
}

/// Takes the plant away.
pub(super) fn delete(editor: &mut Editor, command: &'static str) -> Effect {
    of_chosen(editor, command, |plant| PlantChange::Delete { plant })
}

/// Puts a plant at the playhead.
pub(super) fn add(editor: &mut Editor, command: &'static str) -> Effect {
    let first = editor.source_frame();
    let n_frames = (ADDED_SECS / editor.document.solved().clip.frame_time_secs).round().max(1.0);
    step(editor, command, PlantChange::Add { first, last: first + n_frames as usize - 1 })
}

/// Changes what is done with the plant.
pub(super) fn set_mode(editor: &mut Editor, command: &'static str, mode: PlantMode) -> Effect {
    of_chosen(editor, command, |plant| PlantChange::SetMode { plant, mode })
}

/// Goes on to the next mode of the plant, or back.
pub(super) fn step_mode(editor: &mut Editor, command: &'static str, by: i64) -> Effect {
    let Some((foot_idx, plant_idx)) = editor.chosen_plant() else { return Effect::None };
    let now = editor.document.solved().feet.plants[foot_idx].plants[plant_idx].mode;
    let at = MODES.iter().position(|mode| *mode == now).expect("all modes are listed") as i64;
    let next = (at + by.signum()).rem_euclid(MODES.len() as i64);
    set_mode(editor, command, MODES[next as usize])
}

/// Takes back what the user did to the chosen plant.
pub(super) fn plant_as_found(editor: &mut Editor, command: &'static str) -> Effect {
    let plant = editor.chosen_plant().map(|(_, plant_idx)| plant_idx);
    as_found(editor, command, plant)
}

/// Takes back what the user did to all plants of the chosen foot.
pub(super) fn foot_as_found(editor: &mut Editor, command: &'static str) -> Effect {
    as_found(editor, command, None)
}

fn as_found(editor: &mut Editor, command: &'static str, plant: Option<usize>) -> Effect {
    if let Some(foot_idx) = editor.chosen_foot() {
        let foot = side(editor.document.solved(), foot_idx);
        make(editor, command, &Change::PlantsAsFound { foot, plant });
        editor.end_step();
    }
    Effect::None
}

fn of_chosen(editor: &mut Editor, command: &'static str, what: impl FnOnce(usize) -> PlantChange) -> Effect {
    match editor.chosen_plant() {
        Some((_, plant_idx)) => step(editor, command, what(plant_idx)),
        None => Effect::None,
    }
}

/// Makes a change that is a step of its own.
fn step(editor: &mut Editor, command: &'static str, what: PlantChange) -> Effect {
    change(editor, command, what);
    editor.end_step();
    Effect::None
}

fn change(editor: &mut Editor, command: &'static str, change: PlantChange) {
    if let Some(foot_idx) = editor.chosen_foot() {
        let foot = side(editor.document.solved(), foot_idx);
        make(editor, command, &Change::Plant { foot, change });
    }
}

/// Makes a change at the frame that is shown, and says what became of it. Other plants may make another loop the best one:
/// then the playhead goes where that has the same frame of the clip, so that keys still act on the same plant.
fn make(editor: &mut Editor, command: &'static str, change: &Change) {
    editor.view.playing = false;
    let at = editor.source_frame();
    editor.change(command, change);
    if editor.source_frame() != at {
        show(editor, at);
    }
    show_plant_row(editor);
    if editor.view.message.is_none() {
        tell(editor);
    }
}

fn other(side: Side) -> Side {
    match side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    }
}

fn side(solved: &Solved, foot_idx: usize) -> Side {
    solved.feet.plants[foot_idx].leg.side
}
