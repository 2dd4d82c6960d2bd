//! View state: the playhead, what is selected, which tab and camera are in use. None of it is history.

use super::{
    area::{self, PlanArea},
    joints::Joints,
    panel::{Row, RowKind, TABS},
    playback::{Pace, Playback},
    views::Window,
};
use crate::{
    document::{Document, Solved},
    motion::Side,
};

/// How much a message matters.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Severity {
    /// Something was done.
    Note,
    /// Something was done, but not quite as wished.
    Warning,
    /// Something could not be done.
    Error,
}

/// A line for the user, gone with the next key.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// How much it matters.
    pub severity: Severity,
    /// The line.
    pub text: String,
    /// What comes after it in the terminal; pictures do without.
    pub hint: &'static str,
}

impl Message {
    /// Makes a note.
    pub fn note(text: String) -> Self {
        Self { severity: Severity::Note, text, hint: "" }
    }

    /// Makes a warning.
    pub fn warning(text: String) -> Self {
        Self { severity: Severity::Warning, text, hint: "" }
    }

    /// Makes an error.
    pub fn error(text: String) -> Self {
        Self { severity: Severity::Error, text, hint: "" }
    }
}

/// What the user looks at.
#[derive(Clone, Debug)]
pub struct ViewState {
    /// Edited frame shown.
    pub frame_idx: usize,
    /// Rest frame of the file shown in place of `frame_idx`; only pictures asked for by number show one.
    pub rest_frame: Option<usize>,
    /// Whether the playhead moves by itself.
    pub playing: bool,
    /// Whether it then moves in slow motion.
    pub slow_motion: bool,
    /// Time since the shown frame began, in clip time, seconds.
    carried_secs: f64,
    /// Index into [`TABS`].
    pub tab_idx: usize,
    /// Selected row of each tab.
    pub rows: [usize; TABS.len()],
    /// Selected control point.
    pub point_idx: usize,
    /// Side of the foot whose plants keys act on.
    pub foot: Side,
    /// Joints that keys act on.
    pub joints: Joints,
    /// Layer that poses and keys go into, its place in the list.
    pub layer_idx: usize,
    /// File frame of the first of two interpolation keys, until the second is set.
    pub interpolated_from: Option<usize>,
    /// How many steps there were to undo when it was set.
    pub(super) interpolated_behind: usize,
    /// The window that keys act on.
    pub(super) window: Window,
    /// The view of each window that keys act on.
    pub(super) focus: [usize; 2],
    /// Camera preset of the view in focus, 0 to 3.
    pub camera_idx: usize,
    /// The area the plan and the presets frame.
    pub area: PlanArea,
    /// First help line shown; none: help is closed.
    pub help: Option<usize>,
    /// A line for the user.
    pub message: Option<Message>,
}

impl ViewState {
    pub(super) fn new(solved: &Solved) -> Self {
        Self {
            frame_idx: 0,
            rest_frame: None,
            playing: false,
            slow_motion: false,
            carried_secs: 0.0,
            tab_idx: 0,
            rows: [0; TABS.len()],
            point_idx: 0,
            foot: Side::Left,
            joints: Joints::new(&solved.clip),
            layer_idx: 0,
            interpolated_from: None,
            interpolated_behind: 0,
            window: Window::First,
            focus: [0; 2],
            camera_idx: 0,
            area: area::area(solved),
            help: None,
            message: None,
        }
    }

    /// Keeps everything within the document: indices in range, the framed area around what there is.
    pub(super) fn follow(&mut self, document: &Document) {
        let solved = document.solved();
        self.frame_idx = self.frame_idx.min(solved.edited.n_frames().saturating_sub(1));
        self.point_idx = self.point_idx.min(solved.control_points().len().saturating_sub(1));
        self.joints.follow(&solved.clip);
        self.layer_idx = self.layer_idx.min(document.edits().layers.len().saturating_sub(1));
        self.area = self.area.keep_or(area::area(solved));
        self.follow_views(document);
    }

    /// Keeps the selected row within the tab's rows, and the selected point or the active joint with a selected row of one.
    pub(super) fn select_row(&mut self, rows: &[Row], row: usize) {
        let row = row.min(rows.len().saturating_sub(1));
        self.rows[self.tab_idx] = row;
        match rows.get(row).map(|row| row.kind) {
            Some(RowKind::Point { point_idx }) => self.point_idx = point_idx,
            Some(RowKind::Joint(handle)) => self.joints.active = handle,
            Some(RowKind::Layer { layer_idx }) => self.layer_idx = layer_idx,
            _ => {}
        }
    }

    pub(super) fn advance(&mut self, secs: f64, document: &Document) -> bool {
        let solved = document.solved();
        let n_frames = solved.edited.n_frames();
        if !self.playing || n_frames < 2 {
            return false;
        }
        let playback = Playback {
            n_frames,
            frame_secs: solved.clip.frame_time_secs,
            pace: self.pace(document),
            source_frame: &|frame| solved.source_frame(frame),
        };
        let before = self.frame_idx;
        let elapsed_secs = self.carried_secs + secs * document.edits().timing.speed;
        (self.frame_idx, self.carried_secs) = playback.after(before, elapsed_secs);
        self.frame_idx != before
    }

    /// How fast the playhead goes.
    fn pace(&self, document: &Document) -> Pace {
        if !self.slow_motion {
            return Pace::Own;
        }
        let between = document.edits().interpolation_keys.map(|keys| keys.frames(&document.solved().clip));
        // From the first key's own frame on.
        Pace::EveryFrame(between.map_or(0..0, |frames| frames.start.saturating_sub(1)..frames.end))
    }

    /// Shows another frame and stays there.
    pub(super) fn jump(&mut self, frame_idx: usize) {
        self.frame_idx = frame_idx;
        self.rest_frame = None;
        self.carried_secs = 0.0;
    }
}
