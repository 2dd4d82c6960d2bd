//! The editor: what the user sees and does, without a terminal and without a GPU.
//!
//! Keys come in as [`Key`], become [`Command`]s by the table [`COMMANDS`], and change the [`Document`] or the
//! [`ViewState`]; front ends read both and the [`Scene`] built from them. What the editor cannot do itself (quit, open
//! a window) it returns as an [`Effect`].

mod actions;
mod area;
mod body;
mod camera;
mod command;
mod feet;
mod joints;
mod keymap;
mod layers;
mod look;
mod loops;
mod map_keys;
mod maps;
mod panel;
mod pick;
mod picture;
mod playback;
mod pose;
mod prompt;
mod view;
mod views;

use std::{
    path::{Path, PathBuf},
    sync::Arc,
};

use glam::DVec3;

use crate::{
    document::{Change, Document, EXTENSION, KeyChange, Solved, parse_assignment},
    key::Key,
    scene::Scene,
};

pub use area::PlanArea;
pub use camera::{PRESET_NAMES, Preset, preset};
pub use command::{COMMANDS, Command, Group};
pub use joints::{Handle, Joints, Tool};
pub use keymap::Hint;
pub use maps::MapSeries;
pub use panel::{Row, RowKind, TABS, Tab};
pub use prompt::{Asking, Prompt};
pub use view::{Message, Severity, ViewState};
pub use views::Window;

/// Steps of one command within this time are one step of undo.
const HELD_SECS: f64 = 0.7;

/// Places nearer to each other than this, body heights, are offered as the same.
const SAME_PLACE: f64 = 1e-9;

/// What the editor asks of the program around it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Effect {
    /// Nothing.
    None,
    /// Leave the program.
    Quit,
    /// Stop until the user's shell continues us.
    Suspend,
    /// Open the preview window, or close it; close the window that the key was pressed in.
    ToggleWindow,
    /// Open the second window, or close it.
    ToggleSecondWindow,
    /// Show the preview's picture in the terminal in place of the plan, or the plan again.
    TogglePane,
    /// Draw everything anew.
    Redraw,
}

/// The editor.
#[derive(Clone, Debug)]
pub struct Editor {
    document: Document,
    view: ViewState,
    prompt: Option<Prompt>,
    /// Keys of a sequence that is not finished.
    pending: Vec<Key>,
    /// Seconds since the editor began, as told by [`Editor::advance`].
    clock_secs: f64,
    /// The command that made the newest step, and when; none once another command came between.
    last_step: Option<(&'static str, f64)>,
    /// Whether the command being run has made a step.
    made_step: bool,
    stills: picture::Stills,
    /// The point of the body that the pointer holds.
    grab: Option<pick::Grab>,
    /// Where a point was wanted that has not been told short of it only because nobody knows yet.
    wanted: Option<pose::Wanted>,
}

impl Editor {
    /// Begins editing a document; the warnings are told first.
    pub fn new(document: Document, mut warnings: Vec<String>) -> Self {
        warnings.extend(document.solved().warnings.iter().cloned());
        let mut editor = Self {
            view: ViewState::new(document.solved()),
            document,
            prompt: None,
            pending: Vec::new(),
            clock_secs: 0.0,
            last_step: None,
            made_step: false,
            stills: picture::Stills::default(),
            grab: None,
            wanted: None,
        };
        editor.view.message = (!warnings.is_empty()).then(|| Message::warning(warnings.join("; ")));
        editor.follow_document();
        editor
    }

    /// Returns the document.
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// Returns the view state.
    pub fn view(&self) -> &ViewState {
        &self.view
    }

    /// Returns the line being typed, if one is.
    pub fn prompt(&self) -> Option<&Prompt> {
        self.prompt.as_ref()
    }

    /// Returns the keys of a sequence that is not finished.
    pub fn pending(&self) -> &[Key] {
        &self.pending
    }

    /// Returns the rows of the tab in use.
    pub fn rows(&self) -> Vec<Row> {
        panel::rows(self)
    }

    /// Returns the picture of this moment in the window that keys act on.
    pub fn scene(&self) -> Scene {
        self.scene_in(self.view.window)
    }

    /// Returns the picture of this moment in a window.
    pub fn scene_in(&self, window: Window) -> Scene {
        let mut scene = picture::scene(&self.document, &self.view, window, Arc::clone(self.stills.still()));
        // Keys may come from the window, so what they ask or say is seen there too.
        if let Some(prompt) = &self.prompt {
            scene.now.caption = format!("{} {}_", prompt.title(), prompt.text);
        } else if let Some(message) = &self.view.message {
            scene.now.caption = format!("{}  {}", scene.now.caption, message.text);
        }
        scene
    }

    /// Returns the keys that work now, or after the keys already pressed of a sequence.
    pub fn hints(&self) -> Vec<Hint> {
        keymap::hints(self)
    }

    /// Keeps the help's first line within what there is to scroll to, which only who draws it knows.
    pub fn end_help_at(&mut self, last: usize) {
        self.view.help = self.view.help.map(|line| line.min(last));
    }

    /// Lets time pass: moves the playhead while playing. Returns whether anything to be seen changed.
    pub fn advance(&mut self, secs: f64) -> bool {
        self.clock_secs += secs;
        self.view.advance(secs, &self.document)
    }

    /// From now on what changes is shown before all of it is measured; see [`Document::show_drafts`].
    pub fn show_drafts(&mut self) {
        self.document.show_drafts();
    }

    /// Has all of the clip follow what is shown and measures it; false when that is done already.
    pub fn measure(&mut self) -> bool {
        let was_due = self.document.measure();
        if was_due {
            self.follow_document();
        }
        if let Some(wanted) = self.wanted.take().filter(|wanted| wanted.is_last(&self.document)) {
            pose::tell_short(self, wanted);
        }
        was_due
    }

    /// Acts on a key.
    pub fn key(&mut self, key: Key) -> Effect {
        self.view.message = None;
        // A key may change what is dragged or when; the pointer takes hold anew.
        self.grab = None;
        match self.prompt.take() {
            Some(prompt) => self.prompt_key(prompt, key),
            None => keymap::press(self, key),
        }
    }

    /// Acts on keys given as text, e.g. `jj+<tab>u`; for tests and scripts.
    ///
    /// # Panics
    ///
    /// When the text is not a key sequence.
    pub fn keys(&mut self, text: &str) -> Effect {
        let keys = Key::parse_sequence(text).expect("a key sequence");
        keys.into_iter().map(|key| self.key(key)).last().unwrap_or(Effect::None)
    }

    /// Puts text into the line being typed; without one, text means nothing.
    pub fn paste(&mut self, text: &str) {
        if let Some(prompt) = &mut self.prompt {
            prompt.insert(text);
        }
    }

    /// Shows a frame, counted in what would be exported: rest frames first.
    pub fn show_exported_frame(&mut self, frame_idx: usize) {
        let rest = self.document.solved().clip.rest_frames();
        self.view.jump(frame_idx.saturating_sub(rest));
        self.view.rest_frame = (frame_idx < rest).then_some(frame_idx);
        self.follow_document();
    }

    /// Shows a line to the user until the next key.
    pub fn say(&mut self, message: Message) {
        self.view.message = Some(message);
    }

    /// Makes a change under the name of a command; steps of a held key are one step of undo.
    fn change(&mut self, command: &'static str, change: &Change) {
        let held = self.settle_unless_held(command);
        self.made_step = true;
        let solved = Arc::clone(self.document.solved());
        if self.change_from(&solved, change, held) {
            self.last_step = Some((command, self.clock_secs));
        }
    }

    /// Tells whether a command is a step of a held key; before any other all of the clip follows what was done.
    fn settle_unless_held(&mut self, command: &'static str) -> bool {
        let held = self.last_step.is_some_and(|(name, at)| name == command && self.clock_secs - at < HELD_SECS);
        if !held {
            self.document.settle();
        }
        held
    }

    /// Makes a change of an earlier state in place of what was done since; tells whether it could be made.
    fn change_from(&mut self, from: &Solved, change: &Change, joins: bool) -> bool {
        let known = self.document.solved().warnings.clone();
        let made = self.document.apply_to(from, change, joins);
        match &made {
            Ok(warnings) => {
                let new = self.document.solved().warnings.iter().filter(|w| !known.contains(w));
                let warnings: Vec<_> = warnings.iter().chain(new).cloned().collect();
                self.view.message = (!warnings.is_empty()).then(|| Message::warning(warnings.join("; ")));
            }
            Err(error) => self.say(Message::error(layers::refusal(error))),
        }
        self.follow_document();
        made.is_ok()
    }

    /// Sets one parameter under the name of a command.
    fn set(&mut self, command: &'static str, name: &str, value: toml::Value) {
        self.change(command, &Change::Set { values: vec![(name.to_owned(), value)], shape: None });
    }

    /// Writes a place, in the clip's axes and unit, to be offered: what it leaves out is nothing that can be seen.
    fn offered_place(&self, at: DVec3) -> String {
        prompt::coordinates(at, SAME_PLACE * self.document.solved().clip.facts.height.value)
    }

    /// Ends the joining of steps: the next one is its own.
    fn end_step(&mut self) {
        self.last_step = None;
    }

    /// Brings the view and the still picture in line with the document.
    fn follow_document(&mut self) {
        self.view.follow(&self.document);
        self.stills.follow(&self.document, &self.view);
    }

    fn prompt_key(&mut self, mut prompt: Prompt, key: Key) -> Effect {
        match prompt.key(key) {
            prompt::Answer::Typing => self.prompt = Some(prompt),
            prompt::Answer::Left => {}
            prompt::Answer::Given(text) => return self.answer(prompt, &text),
        }
        Effect::None
    }

    /// Acts on a finished line; one that cannot be used stays open with the reason.
    fn answer(&mut self, prompt: Prompt, text: &str) -> Effect {
        self.end_step();
        if prompt.keeps() {
            return Effect::None;
        }
        match &prompt.asking {
            Asking::Quit => return if text.starts_with('y') { Effect::Quit } else { Effect::None },
            Asking::Value { name } => {
                let name = *name;
                match parse_assignment(&format!("{name}={text}")) {
                    Ok((_, value)) => self.set("type", name, value),
                    Err(error) => self.say(Message::error(error)),
                }
            }
            Asking::Assignment => match parse_assignment(text) {
                Ok((name, value)) => self.set("type", &name, value),
                Err(error) => self.say(Message::error(error)),
            },
            Asking::Coordinates { point_idx } => match prompt::parse_coordinates(text) {
                Some(to) => self.change("type", &Change::PlacePoint { point_idx: *point_idx, to }),
                None => self.say(Message::error(format!("expected three numbers x y z, found `{text}`"))),
            },
            Asking::LayerName { layer_idx } => layers::rename(self, *layer_idx, text),
            Asking::MoveJoint { .. } => pose::typed_place(self, text),
            Asking::TurnJoint { .. } => pose::typed_angles(self, text),
            &Asking::MoveKeys { from } => map_keys::typed_frame(self, text, |to| KeyChange::Move { from, to }),
            &Asking::CopyKeys { from } => map_keys::typed_frame(self, text, |to| KeyChange::Copy { from, to }),
            Asking::Save => self.ask_or(&as_project_name(text), Asking::OverwriteSave, Self::save_to),
            Asking::Export { interpolated } => {
                let interpolated = *interpolated;
                let overwrite = |file| Asking::OverwriteExport { file, interpolated };
                self.ask_or(text, overwrite, |editor, file| editor.export_to(file, interpolated));
            }
            Asking::OverwriteSave(file) if text.starts_with('y') => self.save_to(&file.clone()),
            Asking::OverwriteExport { file, interpolated } if text.starts_with('y') => {
                self.export_to(&file.clone(), *interpolated);
            }
            Asking::OverwriteSave(_) | Asking::OverwriteExport { .. } => {
                self.say(Message::note("not written".to_owned()));
            }
        }
        if self.view.message.as_ref().is_some_and(|m| m.severity == Severity::Error) && self.prompt.is_none() {
            self.prompt = Some(prompt.again());
        }
        Effect::None
    }

    /// Writes to the named file; one that exists and is not this document's own is asked about first.
    fn ask_or(&mut self, text: &str, overwrite: impl Fn(PathBuf) -> Asking, write: impl Fn(&mut Self, &Path)) {
        let file = PathBuf::from(text.trim());
        if file.exists() && self.document.project() != Some(file.as_path()) {
            self.prompt = Some(Prompt::new(overwrite(file), ""));
        } else {
            write(self, &file);
        }
    }

    fn save_to(&mut self, file: &Path) {
        match self.document.save(file) {
            Ok(()) => self.say(Message::note(format!("saved {}", file.display()))),
            Err(error) => self.say(Message::error(error.to_string())),
        }
    }

    fn export_to(&mut self, file: &Path, interpolated: bool) {
        match self.document.export(file, interpolated) {
            Ok(()) => {
                let n = self.document.solved().n_exported_frames();
                let frames = if n == 1 { "frame" } else { "frames" };
                self.say(Message::note(format!("exported {n} {frames} to {}", file.display())));
            }
            Err(error) => self.say(Message::error(error.to_string())),
        }
    }
}

/// Gives a project's file name the ending that opens it again.
fn as_project_name(text: &str) -> String {
    let name = text.trim();
    let ending = Path::new(name).extension().is_some_and(|e| e.eq_ignore_ascii_case(EXTENSION));
    if ending || name.is_empty() { name.to_owned() } else { format!("{name}.{EXTENSION}") }
}
