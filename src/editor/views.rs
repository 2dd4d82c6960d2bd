//! Windows and their views: which of them keys act on, and what each shows.
//!
//! A window shows one, two or four views (`view.*`, for the second window `second.*`). Keys act on one of them, the view
//! in focus of the window used last. What a view leaves out counts where there are several; a window of one view shows
//! what `show.*` says.

use toml::Value;

use super::{Editor, Effect, Message, camera, view::ViewState};
use crate::{
    document::{Document, OneViewEdits, ProjectionKind, Show, WindowEdits, parameter},
    scene::{Object, Objects, View},
};

/// A window of the preview.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Window {
    /// The one that opens with the editor.
    First,
    /// The one that is opened beside it.
    Second,
}

impl Window {
    /// Both.
    pub const BOTH: [Self; 2] = [Self::First, Self::Second];

    pub(super) fn idx(self) -> usize {
        self as usize
    }

    /// Returns where the parameters of the window's views stand.
    fn section(self) -> &'static str {
        match self {
            Self::First => "view",
            Self::Second => "second",
        }
    }
}

impl Editor {
    /// Returns the window that keys act on.
    pub fn window(&self) -> Window {
        self.view.window
    }

    /// Has keys act on a window from now on.
    pub fn use_window(&mut self, window: Window) {
        self.view.window = window;
        self.view.follow_views(&self.document);
    }

    /// Has keys act on a view of the window in use; one that the window does not show is none.
    pub fn focus_view(&mut self, view_idx: usize) {
        if view_idx < edits(&self.document, self.view.window).layout {
            self.view.focus[self.view.window.idx()] = view_idx;
            self.view.follow_views(&self.document);
        }
    }

    /// Zooms the view in focus by steps of a wheel, positive is nearer.
    pub fn wheel(&mut self, steps: i32) {
        // What is held was taken through the camera as it was.
        self.grab = None;
        camera::change(self, "wheel", camera::Move::Zoom(steps));
    }

    /// Says which view keys act on, e.g. `view 2 `; nothing in the first window while it has one view.
    pub fn view_in_focus(&self) -> String {
        let window = if self.view.window == Window::Second { "second window " } else { "" };
        let view = if are_several(self) { format!("view {} ", self.view.focused() + 1) } else { String::new() };
        format!("{window}{view}")
    }
}

impl ViewState {
    /// Returns the index of the view that keys act on.
    pub(super) fn focused(&self) -> usize {
        self.focus[self.window.idx()]
    }

    /// Keeps the focus within each window's views, and the camera in use with the focus.
    pub(super) fn follow_views(&mut self, document: &Document) {
        for window in Window::BOTH {
            let focus = &mut self.focus[window.idx()];
            *focus = (*focus).min(edits(document, window).layout - 1);
        }
        self.camera_idx = edits(document, self.window).views[self.focused()].camera_idx;
    }
}

fn edits(document: &Document, window: Window) -> &WindowEdits {
    &document.edits().view.windows[window.idx()]
}

/// Returns the section of the view in focus and the window's own: `view.2` and `view`.
pub(super) fn sections(view: &ViewState) -> (String, &'static str) {
    let window = view.window.section();
    (format!("{window}.{}", view.focused() + 1), window)
}

/// Tells whether the window in use has several views.
pub(super) fn are_several(editor: &Editor) -> bool {
    edits(&editor.document, editor.view.window).layout > 1
}

/// Divides the window in use into views.
pub(super) fn divide(editor: &mut Editor, command: &'static str, layout: i64) -> Effect {
    let window = editor.view.window;
    let name = format!("{}.layout", window.section());
    editor.set(command, &name, Value::Integer(layout));
    let whose = if window == Window::Second { "second window: " } else { "" };
    let views = if layout == 1 { "view" } else { "views" };
    editor.say(Message::note(format!("{whose}{layout} {views} ({name})")));
    Effect::None
}

/// Moves the focus to the next view.
pub(super) fn next(editor: &mut Editor) -> Effect {
    let layout = edits(&editor.document, editor.view.window).layout;
    editor.focus_view((editor.view.focused() + 1) % layout);
    editor.say(Message::note(editor.view_in_focus().trim_end().to_owned()));
    Effect::None
}

/// Has the view in focus seen from a camera preset.
pub(super) fn use_camera(editor: &mut Editor, command: &'static str, camera_idx: usize) -> Effect {
    let (view, _) = sections(&editor.view);
    editor.set(command, &format!("{view}.camera"), Value::Integer(camera_idx as i64 + 1));
    tell_camera(editor, "");
    Effect::None
}

/// Says what was done to the camera of the view in focus, which the plan does not show.
pub(super) fn tell_moved(editor: &mut Editor, done: &str) {
    if editor.view.message.is_none() {
        tell_camera(editor, done);
        if let Some(message) = &mut editor.view.message {
            message.hint = "; the window (w) and the picture (b) show it";
        }
    }
}

/// Says which camera the view in focus is seen from, unless there is something to tell already.
fn tell_camera(editor: &mut Editor, more: &str) {
    if editor.view.message.is_none() {
        let views = views(&editor.document, &editor.view, editor.view.window);
        let title = &views[editor.view.focused()].title;
        let view = editor.view_in_focus();
        editor.say(Message::note(format!("{view}camera {title}{more}")));
    }
}

/// Tells whether showing what `name` (a row of `show.*`) draws is up to the view in focus: it is one of several, or of the
/// second window, or leaves it out already.
pub(super) fn decides(editor: &Editor, name: &str) -> bool {
    let (view, _) = sections(&editor.view);
    are_several(editor) || editor.view.window == Window::Second || hides(editor, &format!("{view}.hide"), object(name))
}

/// Returns the name of what a row of `show.*` draws.
fn object(name: &str) -> &str {
    name.rsplit('.').next().expect("a name has a last part")
}

/// Shows what `name` (a row of `show.*`) draws in the view in focus, or leaves it out there; all other views stay as
/// they are.
pub(super) fn toggle(editor: &mut Editor, command: &'static str, name: &str) -> Effect {
    let object = object(name);
    let (view, _) = sections(&editor.view);
    let hide = format!("{view}.hide");
    let drawn = value(editor, name) == Value::Boolean(true);
    let shows = drawn && !hides(editor, &hide, object);
    let mut values = vec![hiding(editor, &hide, object, shows)];
    if !drawn {
        // Drawn from now on, but nowhere else.
        values.push((name.to_owned(), Value::Boolean(true)));
        let all = Window::BOTH.iter().flat_map(|w| (1..=4).map(move |n| format!("{}.{n}.hide", w.section())));
        values.extend(all.filter(|other| *other != hide).map(|other| hiding(editor, &other, object, true)));
    }
    editor.change(command, &crate::document::Change::Set { values, shape: None });
    let (seen, object) = (editor.view_in_focus(), object.replace('_', " "));
    editor.say(Message::note(format!("{seen}{} {object} ({hide})", if shows { "hides" } else { "shows" })));
    Effect::None
}

fn value(editor: &Editor, name: &str) -> Value {
    parameter(name).expect("every view and object has its row").get(editor.document.edits())
}

fn hides(editor: &Editor, hide: &str, object: &str) -> bool {
    value(editor, hide).as_array().is_some_and(|names| names.iter().any(|name| name.as_str() == Some(object)))
}

/// Returns a view's list of what it leaves out, with an object or without it.
fn hiding(editor: &Editor, hide: &str, object: &str, hidden: bool) -> (String, Value) {
    let mut names = value(editor, hide).as_array().cloned().unwrap_or_default();
    names.retain(|name| name.as_str() != Some(object));
    if hidden {
        names.push(Value::String(object.to_owned()));
    }
    (hide.to_owned(), Value::Array(names))
}

/// Builds a window's views.
pub(super) fn views(document: &Document, view: &ViewState, window: Window) -> Vec<View> {
    let WindowEdits { layout, views } = edits(document, window);
    let up = document.solved().clip.facts.up.value;
    let build = |(idx, &OneViewEdits { camera_idx, shows }): (usize, &OneViewEdits)| {
        let preset = camera::preset(document, &view.area, camera_idx, *layout);
        let kind = match preset.projection {
            ProjectionKind::Perspective => "perspective",
            ProjectionKind::Orthographic => "orthographic",
        };
        let follows = if preset.follow { ", following" } else { "" };
        let several = *layout > 1;
        View {
            camera: preset.camera(camera::follow_offset(document, view.frame_idx)),
            title: format!("{} {}, {kind}{follows}", camera_idx + 1, preset.name(camera_idx, up)),
            shows: objects(shows),
            focused: several && idx == view.focus[window.idx()],
        }
    };
    views[..*layout].iter().enumerate().map(build).collect()
}

/// Returns the set that a view's switches make.
fn objects(shows: Show) -> Objects {
    let Show {
        original_skeleton,
        new_skeleton,
        original_path,
        new_path,
        control_points,
        original_tracker,
        new_tracker,
        ground,
        footprints,
        traces,
        labels,
        wireframe,
        normal_skeleton,
    } = shows;
    let switches = [
        (original_skeleton, Object::OriginalSkeleton),
        (new_skeleton, Object::NewSkeleton),
        (original_path, Object::OriginalPath),
        (new_path, Object::NewPath),
        (control_points, Object::ControlPoints),
        (original_tracker, Object::OriginalTracker),
        (new_tracker, Object::NewTracker),
        (ground, Object::Ground),
        (footprints, Object::Footprints),
        (traces, Object::Traces),
        (labels, Object::Labels),
        (wireframe, Object::Wireframe),
        (normal_skeleton, Object::NormalSkeleton),
    ];
    switches.into_iter().filter(|(on, _)| *on).map(|(_, object)| object).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn each_switch_is_an_object_of_its_own() {
        assert_eq!(objects(Show::ALL), Objects::ALL);
        let nothing_but_ground = objects(Show { traces: false, ..Show::ALL });
        assert_eq!(nothing_but_ground, Objects::ALL.without(Object::Traces));
    }
}
