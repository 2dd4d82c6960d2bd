//! The whole screen: which widget stands where, and what of the editor it shows.
//!
//! ```text
//! walkabout · clip · unsaved                       window
//! plan, or the rendered picture  │ tabs
//!                                │ rows of the tab, or charts
//!                                │ help of the selected row
//! timeline
//! what planted feet do, where the row below has no room for it
//! message, line being typed, or state
//! keys to start with
//! ```

use std::borrow::Cow;

use ratatui::{
    Frame,
    buffer::Buffer,
    layout::{Constraint, Layout, Position, Rect},
    widgets::{Clear, Widget},
};

use super::{
    Chart, Direction, Extent, Interval, KeyGroup, KeyHelp, Palette, ParameterList, ParameterRow, PictureView, PlanView,
    Series, StatusLine, Tabs, Timeline, TimelineMark, TimelineRow,
    score::{self, side},
    text,
};
use crate::{
    document::ShownPlant,
    editor::{Editor, Hint, RowKind, Severity, TABS, Tab},
    scene::{Objects, Picture, Role, Scene},
};

/// Widest panel, cells.
const PANEL_MAX: u16 = 52;
/// Narrowest panel, cells.
const PANEL_MIN: u16 = 36;
/// Lines of the rows below the residuals, with their help.
const RESIDUAL_ROWS: u16 = 6;
/// The keys the foot line shows, in this order, as far as there is room.
const FIRST_KEYS: &str = "? keys  space play  tab panel  j k row  + - value  n p point  xyz XYZ move  s shape  h l plant  1-4 view  u undo  q quit";

/// The same on the tabs of joints, layers and maps.
const FIRST_KEYS_OF_JOINTS: &str = "? keys  space play  tab panel  j k joint  gt gr select  xyz XYZ move  e turn  i d key  h l key  1-4 view  u undo  q quit";

/// What the screen shows beside the editor.
#[derive(Clone, Copy, Debug)]
pub struct Surroundings<'a> {
    /// Colours.
    pub palette: Palette,
    /// One line about the preview window.
    pub window_line: &'a str,
    /// The newest picture for the pane.
    pub picture: Option<&'a Picture>,
    /// Whether the pane shows the rendered picture in place of the plan.
    pub pane_open: bool,
}

/// The parts of the screen.
struct Parts {
    title: Rect,
    view: Rect,
    panel: Rect,
    timeline: Rect,
    status: Rect,
    keys: Rect,
}

impl Parts {
    fn of(area: Rect, n_status_rows: u16) -> Self {
        let [title, body, timeline, status, keys] = Layout::vertical([
            Constraint::Length(1),
            Constraint::Fill(1),
            Constraint::Length(4),
            Constraint::Length(n_status_rows),
            Constraint::Length(1),
        ])
        .areas(area);
        let panel_width = (area.width * 2 / 5).clamp(PANEL_MIN, PANEL_MAX).min(area.width);
        let [view, gap_and_panel] =
            Layout::horizontal([Constraint::Fill(1), Constraint::Length(panel_width)]).areas(body);
        let panel = Rect {
            x: gap_and_panel.x + 1.min(gap_and_panel.width),
            width: gap_and_panel.width.saturating_sub(1),
            ..gap_and_panel
        };
        Self { title, view, panel, timeline, status, keys }
    }
}

/// What drawing found out about its places.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Drawn {
    /// The size in pixels at which a rendered picture fits its place.
    pub picture_size: (u32, u32),
    /// The first line of the help when its end is shown; 0 while it is closed.
    pub help_end: usize,
}

/// Draws the editor.
pub fn draw(frame: &mut Frame<'_>, editor: &Editor, scene: &Scene, around: &Surroundings<'_>) -> Drawn {
    let parts = Parts::of(frame.area(), score::n_rows(editor, frame.area().as_size()));
    let buf = frame.buffer_mut();
    draw_title(buf, parts.title, editor, around);
    draw_view(buf, parts.view, editor, scene, around);
    draw_panel(buf, parts.panel, editor, around.palette);
    draw_timeline(buf, parts.timeline, editor, around.palette);
    let cursor = draw_status(buf, parts.status, editor, around.palette);
    let first_keys = if TABS[editor.view().tab_idx].is_of_joints() { FIRST_KEYS_OF_JOINTS } else { FIRST_KEYS };
    text::put(buf, parts.keys, 0, 0, first_keys, around.palette.dim());
    let mut help_end = 0;
    if let Some(scroll) = editor.view().help {
        let body = parts.view.union(parts.panel);
        help_end = draw_hints(buf, body, &editor.hints(), scroll, around.palette);
    } else if !editor.pending().is_empty() {
        let hints = editor.hints();
        let height = (hints.len() as u16 + 2).min(parts.view.height);
        let corner = Rect { y: parts.view.bottom() - height, height, ..parts.view };
        draw_hints(buf, corner, &hints, 0, around.palette);
    }
    if let Some(cursor) = cursor {
        frame.set_cursor_position(cursor);
    }
    Drawn { picture_size: PictureView::pixels(parts.view.as_size()), help_end }
}

fn draw_title(buf: &mut Buffer, area: Rect, editor: &Editor, around: &Surroundings<'_>) {
    let document = editor.document();
    let unsaved = if document.is_modified() { " · unsaved" } else { "" };
    let left = format!("walkabout · {}{unsaved}", document.solved().source.name);
    // What the window is about matters on narrow terminals too: it is cut short rather than left out.
    let room = usize::from(area.width).saturating_sub(text::width(&left) + 2);
    StatusLine { left: &left, right: &text::fit(around.window_line, room), style: around.palette.title() }
        .render(area, buf);
}

fn draw_view(buf: &mut Buffer, area: Rect, editor: &Editor, scene: &Scene, around: &Surroundings<'_>) {
    let palette = around.palette;
    match (around.pane_open, around.picture) {
        (true, Some(picture)) => PictureView { picture, palette }.render(area, buf),
        (true, None) => {
            text::put(buf, area, 0, 0, "the first picture is on its way", palette.dim());
        }
        (false, _) => {
            let clip = &editor.document().solved().clip;
            let direction = match editor.view().camera_idx {
                1 => Direction::Front,
                2 => Direction::Side,
                _ => Direction::Top,
            };
            // The plan is the view in focus in its own way: it leaves out what that view does.
            let views = &scene.now.views;
            let seen = views.iter().find(|view| view.focused).or(views.first());
            let framed = &editor.view().area;
            let half = framed.half_extents;
            let (half_width, half_height) = match direction {
                Direction::Top => (half.x, half.z),
                Direction::Front => (half.x, half.y),
                Direction::Side => (half.z, half.y),
            };
            let plan = PlanView {
                scene,
                direction,
                extent: Extent { centre: framed.centre, half_width, half_height },
                shows: seen.map_or(Objects::ALL, |view| view.shows),
                up: clip.facts.up.value,
                unit: clip.facts.unit.value.unwrap_or(""),
                palette,
            };
            plan.render(area, buf);
        }
    }
}

fn draw_panel(buf: &mut Buffer, area: Rect, editor: &Editor, palette: Palette) {
    let [tabs, body] = Layout::vertical([Constraint::Length(1), Constraint::Fill(1)]).areas(area);
    let titles = TABS.map(Tab::title);
    Tabs { titles: &titles, selected: editor.view().tab_idx, palette }.render(tabs, buf);
    let tab = TABS[editor.view().tab_idx];
    let (above, below) = match tab {
        Tab::Maps => (Constraint::Fill(1), Constraint::Fill(1)),
        Tab::Residuals => (Constraint::Fill(1), Constraint::Length(RESIDUAL_ROWS)),
        _ => (Constraint::Length(0), Constraint::Fill(1)),
    };
    let [chart, body] = Layout::vertical([above, below]).areas(body);
    match tab {
        Tab::Maps => draw_maps(buf, chart, editor, palette),
        Tab::Residuals => draw_residuals(buf, chart, editor, palette),
        _ => {}
    }
    let rows = editor.rows();
    let help = rows.iter().find(|row| row.selected).map_or("", |row| row.help.as_str());
    let rows: Vec<_> = rows
        .iter()
        .map(|row| ParameterRow {
            name: Cow::Borrowed(&row.label),
            value: Cow::Borrowed(&row.value),
            unit: Cow::Borrowed(row.unit),
            changed: row.changed,
            selected: row.selected,
            role: match row.kind {
                RowKind::Joint(handle) => editor.view().joints.is_selected(handle).then_some(Role::SelectedJoint),
                _ => None,
            },
        })
        .collect();
    ParameterList { rows: &rows, help, palette }.render(body, buf);
}

/// Charts what layers do to the joint that keys act on.
fn draw_maps(buf: &mut Buffer, area: Rect, editor: &Editor, palette: Palette) {
    let [line, charts] = Layout::vertical([Constraint::Length(1), Constraint::Fill(1)]).areas(area);
    let map = editor.map_series();
    text::put(buf, line, 0, 0, &map.title, palette.dim());
    let series: Vec<_> = map.names.iter().zip(&map.values).map(|(name, values)| Series { name, values }).collect();
    let playhead = editor.document().solved().source_frame(editor.view().frame_idx);
    Chart { series: &series, playhead, unit: &map.unit, palette }.render(charts, buf);
}

fn draw_residuals(buf: &mut Buffer, area: Rect, editor: &Editor, palette: Palette) {
    let [line, charts] = Layout::vertical([Constraint::Length(2), Constraint::Fill(1)]).areas(area);
    let solved = editor.document().solved();
    let rms = solved.residual_rms();
    let number = |v: f64| text::number(v, 1e-3 * solved.clip.facts.height.value);
    let degree = format!("original degree {}", solved.original.degree());
    let rms_line = format!("RMS x {}  y {}  z {}", number(rms.x), number(rms.y), number(rms.z));
    text::put(buf, line, 0, 0, &degree, palette.dim());
    text::put(buf, line, 0, 1, &rms_line, palette.value());
    let residuals = solved.residual_series();
    let axes = [0, 1, 2].map(|axis| residuals.iter().map(|r| r[axis]).collect::<Vec<_>>());
    let names = ["x", "y", "z"];
    let series: Vec<_> = names.iter().zip(&axes).map(|(name, values)| Series { name, values }).collect();
    let chart = Chart {
        series: &series,
        playhead: solved.source_frame(editor.view().frame_idx),
        unit: solved.clip.facts.unit.value.unwrap_or(""),
        palette,
    };
    chart.render(charts, buf);
}

fn draw_timeline(buf: &mut Buffer, area: Rect, editor: &Editor, palette: Palette) {
    let solved = editor.document().solved();
    let rest = solved.clip.rest_frames();
    let chosen = editor.chosen_plant();
    let of_foot = |foot_idx: usize| {
        let interval = |ShownPlant { plant_idx, first, last }| Interval {
            frames: first + rest..=last + rest,
            mode: solved.feet.plants[foot_idx].plants[plant_idx].mode,
            edited: solved.feet.is_edited(foot_idx, plant_idx),
            missed: solved.missed(foot_idx, plant_idx).is_some(),
            chosen: chosen == Some((foot_idx, plant_idx)),
        };
        solved.shown_plants(foot_idx).map(interval).collect()
    };
    let intervals: Vec<Vec<Interval>> = (0..solved.walked.plants.len()).map(of_foot).collect();
    let feet = solved.walked.plants.iter().zip(&intervals);
    let rows: Vec<_> = feet.map(|(foot, intervals)| TimelineRow { label: side(foot), intervals }).collect();
    let timeline = Timeline {
        n_frames: solved.edited.n_frames() + rest,
        playhead: editor.view().frame_idx + rest,
        frame_time_secs: solved.clip.frame_time_secs,
        marks: &marks(editor),
        rows: &rows,
        palette,
    };
    timeline.render(area, buf);
}

/// Returns signs on the timeline where keys of displacement maps and interpolation keys are, and where a loop begins and
/// begins again.
fn marks(editor: &Editor) -> Vec<TimelineMark> {
    let solved = editor.document().solved();
    let rest = solved.clip.rest_frames();
    let key = |(file_frame, symbol): (usize, char)| {
        let frame = solved.edited_frame(file_frame.checked_sub(rest)?)? + rest;
        Some(TimelineMark { frame, symbol })
    };
    let pair = editor.document().edits().interpolation_keys;
    let ends = pair.into_iter().flat_map(|keys| [(keys.first, '{'), (keys.last, '}')]);
    let ends = ends.chain(editor.view().interpolated_from.map(|frame| (frame, '{')));
    let keys = editor.key_frames().into_iter().map(|frame| (frame, '◆')).chain(ends);
    let start = solved.walked.repeat.map(|repeat| TimelineMark { frame: repeat.range.first + rest, symbol: '[' });
    let again = solved.timing.seams.iter().map(|seam| TimelineMark { frame: seam + rest, symbol: '╂' });
    keys.filter_map(key).chain(start).chain(again).collect()
}

/// Draws the line being typed, the message or the state; returns where the cursor stands while typing. The score's row
/// above them stays.
fn draw_status(buf: &mut Buffer, area: Rect, editor: &Editor, palette: Palette) -> Option<Position> {
    let view = editor.view();
    let mut lines = score::lines(editor, usize::from(area.width), area.height);
    let (left, right) = lines.pop().expect("there is a line");
    if let Some((above, right)) = lines.first() {
        StatusLine { left: above, right, style: palette.text() }.render(area, buf);
    }
    let area = Rect { y: area.y + lines.len() as u16, height: area.height.saturating_sub(lines.len() as u16), ..area };
    if let Some(prompt) = editor.prompt() {
        let title = prompt.title();
        let why = view.message.as_ref().map_or("", |m| m.text.as_str());
        let line = format!("{title} {}", prompt.text);
        StatusLine { left: &line, right: why, style: palette.key() }.render(area, buf);
        let before: String = prompt.text.chars().take(prompt.cursor).collect();
        let column = (text::width(&title) + 1 + text::width(&before)) as u16;
        return (column < area.width && area.height > 0).then_some(Position::new(area.x + column, area.y));
    }
    match &view.message {
        Some(message) => {
            let (sign, style) = match message.severity {
                Severity::Note => ("", palette.text()),
                Severity::Warning => ("! ", palette.warning()),
                Severity::Error => ("✗ ", palette.warning()),
            };
            // A message may need the whole line; the state can be read again with the next key.
            let told = format!("{sign}{}{}", message.text, message.hint);
            StatusLine { left: &told, right: "", style }.render(area, buf);
        }
        None => {
            StatusLine { left: &left, right: &right, style: palette.text() }.render(area, buf);
        }
    }
    None
}

/// Draws help from a line on; returns the first line when its end is shown.
fn draw_hints(buf: &mut Buffer, area: Rect, hints: &[Hint], scroll: usize, palette: Palette) -> usize {
    let mut groups: Vec<KeyGroup<'_>> = Vec::new();
    for hint in hints {
        let title = hint.group.title();
        if groups.last().is_none_or(|g| g.title != title) {
            groups.push(KeyGroup { title, keys: Vec::new() });
        }
        let group = groups.last_mut().expect("just pushed");
        group.keys.push((hint.keys.join(" "), hint.doc));
    }
    Clear.render(area, buf);
    let scroll = u16::try_from(scroll).unwrap_or(u16::MAX);
    let help = KeyHelp { groups: &groups, scroll, palette };
    help.render(area, buf);
    usize::from(help.n_lines(area.width).saturating_sub(area.height))
}
