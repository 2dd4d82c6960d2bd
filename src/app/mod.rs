//! The running editor: its event loop, its threads and its preview processes.
//!
//! One enum of events and one `match`: whatever can wake the program is in `Event`. This thread alone writes the
//! document, solves and draws the terminal; the input, signal and preview threads only send.

pub mod preview;
pub mod preview_main;
pub mod signals;

use std::{
    io::{self, Write as _},
    process::ExitCode,
    sync::mpsc::{self, Receiver, RecvTimeoutError, Sender},
    time::{Duration, Instant},
};

use crate::{
    editor::{Editor, Effect, Message},
    scene::{FromPreview, Picture, Scene},
    tui::{self, InputEvent, InputThread, Palette, Screen, Surroundings, Terminal},
};
use preview::{Preview, PreviewProgram, display_available};
use signals::SignalEvent;

/// Shortest time between two drawn frames while playing.
const FRAME: Duration = Duration::from_millis(33);
/// The same over SSH, where bytes are dear.
const FRAME_OVER_SSH: Duration = Duration::from_millis(66);

/// The exit status after the terminal went away, as for SIGHUP.
const HANGUP_STATUS: u8 = 129;
/// The exit status after a panic, as Rust's own.
const PANIC_STATUS: u8 = 101;

/// Whatever can wake the program.
#[derive(Debug)]
enum Event {
    Input(InputEvent),
    Signal(SignalEvent),
    Preview(Kind, FromPreview),
    /// Another thread panicked. The terminal is given back already.
    Panicked,
}

/// The two kinds of preview.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Window,
    /// A pane has a number, because one that was closed may have events under way when the next one is open.
    Pane(u32),
}

/// Runs the editor until the user leaves; returns the exit status.
pub fn edit(editor: Editor) -> ExitCode {
    match run(editor) {
        Ok(status) => ExitCode::from(status),
        Err(error) => {
            eprintln!("walkabout: {error}");
            ExitCode::FAILURE
        }
    }
}

fn run(editor: Editor) -> Result<u8, tui::ScreenError> {
    let (sender, events) = mpsc::channel();
    // Whoever may have to give the terminal back knows it before it is taken.
    let screen = Screen::open()?;
    tui::leave_on_panic(screen.clone(), {
        let sender = sender.clone();
        move || drop(sender.send(Event::Panicked))
    });
    let mut send_signal = forward(&sender, Event::Signal);
    signals::watch(screen.clone(), move |signal| {
        send_signal(signal);
    })?;
    let terminal = Terminal::take(screen.clone())?;
    let _input = InputThread::start(screen, forward(&sender, Event::Input))?;
    let mut app = App::new(editor, terminal, sender);
    app.open_window_if_possible();
    // Drawing fails only when the terminal is gone.
    let status = app.run(&events).unwrap_or(HANGUP_STATUS);
    let App { editor, terminal, .. } = app;
    drop(terminal);
    if status != 0 {
        rescue(&editor);
    }
    Ok(status)
}

/// Keeps unsaved edits when it was not the user who chose to leave.
fn rescue(editor: &Editor) {
    let told = match editor.document().rescue() {
        Ok(Some(file)) => format!("unsaved edits are in {}", file.display()),
        Ok(None) => return,
        Err(error) => format!("unsaved edits are lost: {error}"),
    };
    // A terminal that is gone cannot be told, and that is no reason to panic.
    let _ = writeln!(io::stderr(), "walkabout: {told}");
}

/// Returns a function that sends what it is given as an event; false when nobody listens any more.
fn forward<T>(sender: &Sender<Event>, event: fn(T) -> Event) -> impl FnMut(T) -> bool + Send + 'static
where
    T: Send + 'static,
{
    let sender = sender.clone();
    move |value| sender.send(event(value)).is_ok()
}

/// What to do after an event.
enum Next {
    Go,
    Leave(u8),
}

struct App {
    editor: Editor,
    terminal: Terminal,
    palette: Palette,
    sender: Sender<Event>,
    window: Option<Preview>,
    /// One line about the window: what draws it, or why there is none.
    window_line: String,
    pane: Option<Preview>,
    /// The number of the pane that is open, or of the next one.
    pane_number: u32,
    /// The pane's newest picture, and the size it was asked for.
    picture: Option<Picture>,
    pane_size: (u32, u32),
    /// The scene the previews were given last; none when one of them has yet to be given its first.
    given: Option<Scene>,
    frame: Duration,
}

impl App {
    fn new(editor: Editor, terminal: Terminal, sender: Sender<Event>) -> Self {
        let over_ssh = std::env::var_os("SSH_CONNECTION").is_some();
        Self {
            editor,
            terminal,
            palette: Palette::new(tui::Depth::from_env()),
            sender,
            window: None,
            window_line: String::new(),
            pane: None,
            pane_number: 0,
            picture: None,
            pane_size: (0, 0),
            given: None,
            frame: if over_ssh { FRAME_OVER_SSH } else { FRAME },
        }
    }

    fn run(&mut self, events: &Receiver<Event>) -> io::Result<u8> {
        let mut last = Instant::now();
        self.show()?;
        loop {
            let event = if self.editor.view().playing {
                match events.recv_timeout(self.frame.saturating_sub(last.elapsed())) {
                    Err(RecvTimeoutError::Timeout) => None,
                    other => other.ok(),
                }
            } else {
                events.recv().ok()
            };
            let secs = last.elapsed().as_secs_f64();
            last = Instant::now();
            let mut changed = self.editor.advance(secs);
            // What has piled up is acted on before anything is drawn.
            let mut waiting = event.into_iter().chain(events.try_iter()).peekable();
            while let Some(event) = waiting.next() {
                // Of a pointer's way only its end counts.
                let is_drag = |event: &Event| matches!(event, Event::Preview(_, FromPreview::Drag(_)));
                if is_drag(&event) && waiting.peek().is_some_and(is_drag) {
                    continue;
                }
                changed = true;
                if let Next::Leave(status) = self.act(event)? {
                    return Ok(status);
                }
            }
            if changed {
                self.show()?;
            }
        }
    }

    fn act(&mut self, event: Event) -> io::Result<Next> {
        match event {
            Event::Input(InputEvent::Key(key)) | Event::Preview(_, FromPreview::Key(key)) => {
                let effect = self.editor.key(key);
                return self.effect(effect);
            }
            Event::Input(InputEvent::Paste(text)) => self.editor.paste(&text),
            Event::Input(InputEvent::Resize(..)) => self.terminal.forget()?,
            Event::Input(InputEvent::Hangup) => return Ok(Next::Leave(HANGUP_STATUS)),
            Event::Signal(SignalEvent::Terminate { exit_code }) => return Ok(Next::Leave(exit_code)),
            Event::Signal(SignalEvent::Suspend) => self.suspend(),
            Event::Signal(SignalEvent::Resume) => signals::resume(&mut self.terminal)?,
            Event::Preview(kind, event) => self.preview_event(kind, event),
            Event::Panicked => return Ok(Next::Leave(PANIC_STATUS)),
        }
        Ok(Next::Go)
    }

    fn effect(&mut self, effect: Effect) -> io::Result<Next> {
        match effect {
            Effect::None => {}
            Effect::Quit => return Ok(Next::Leave(0)),
            Effect::Suspend => self.suspend(),
            Effect::ToggleWindow => self.toggle_window(),
            Effect::TogglePane => self.toggle_pane(),
            Effect::Redraw => self.terminal.forget()?,
        }
        Ok(Next::Go)
    }

    /// Stops the job; being continued comes back as an event.
    fn suspend(&mut self) {
        if !signals::suspend(self.terminal.screen()) {
            self.editor.say(Message::warning("there is no shell to come back from".to_owned()));
        }
    }

    fn preview_event(&mut self, kind: Kind, event: FromPreview) {
        if matches!(kind, Kind::Pane(number) if number != self.pane_number) {
            return;
        }
        match (kind, event) {
            (Kind::Window, FromPreview::Ready { device, driver }) => {
                self.window_line = format!("window: {device}, {driver}");
            }
            (Kind::Pane(_), FromPreview::Frame(picture)) => self.picture = Some(picture),
            (Kind::Window, FromPreview::Closed) => {
                self.window = None;
                self.window_line = "window closed; w opens it".to_owned();
            }
            (Kind::Window, FromPreview::Failed(why)) => {
                self.window = None;
                self.window_line = why.clone();
                self.editor.say(Message::warning(why));
            }
            (Kind::Pane(_), FromPreview::Closed) => self.close_pane(),
            (Kind::Pane(_), FromPreview::Failed(why)) => {
                self.close_pane();
                self.editor.say(Message::warning(why));
            }
            (_, FromPreview::Pick(ray)) => {
                // What was clicked on is what the preview was given.
                if let Some(scene) = &self.given {
                    self.editor.press(scene, &ray);
                }
            }
            (_, FromPreview::Drag(ray)) => self.editor.drag(&ray),
            (_, FromPreview::Release) => self.editor.release(),
            // A window sends no frames.
            (_, FromPreview::Key(_) | FromPreview::Ready { .. } | FromPreview::Frame(_)) => {}
        }
    }

    fn open_window_if_possible(&mut self) {
        match display_available() {
            Ok(()) => self.open_window(),
            Err(why) => self.window_line = why,
        }
    }

    fn open_window(&mut self) {
        self.window_line = "window: opening".to_owned();
        match self.start(Kind::Window, PreviewProgram::window()) {
            Ok(preview) => self.window = Some(preview),
            Err(why) => self.window_line = why,
        }
    }

    fn toggle_window(&mut self) {
        match self.window.take() {
            // It ends by itself; its last event tells so.
            Some(preview) => {
                preview.close();
                self.window = Some(preview);
            }
            None => {
                self.open_window_if_possible();
                if self.window.is_none() {
                    self.editor.say(Message::warning(self.window_line.clone()));
                }
            }
        }
    }

    fn toggle_pane(&mut self) {
        if self.pane.is_some() {
            self.close_pane();
        } else {
            match self.start(Kind::Pane(self.pane_number), PreviewProgram::headless()) {
                Ok(preview) => self.pane = Some(preview),
                Err(why) => self.editor.say(Message::warning(why)),
            }
        }
    }

    fn close_pane(&mut self) {
        self.pane = None;
        self.pane_number += 1;
        self.picture = None;
        self.pane_size = (0, 0);
    }

    fn start(&mut self, kind: Kind, program: io::Result<PreviewProgram>) -> Result<Preview, String> {
        let program = program.map_err(|e| format!("no preview: {e}"))?;
        self.given = None;
        let sender = self.sender.clone();
        Preview::start(&program, move |event| {
            // Nobody listens any more only when the editor is leaving.
            let _ = sender.send(Event::Preview(kind, event));
        })
        .map_err(|e| format!("no preview: {e}"))
    }

    /// Draws the terminal and hands the scene to the previews, if it is not the one they have: a preview draws what it
    /// is given, and its picture comes back here as an event.
    fn show(&mut self) -> io::Result<()> {
        let scene = self.editor.scene();
        let surroundings = Surroundings {
            palette: self.palette,
            window_line: &self.window_line,
            picture: self.picture.as_ref(),
            pane_open: self.pane.is_some(),
        };
        let mut view_size = (0, 0);
        self.terminal.draw(|frame| view_size = tui::draw(frame, &self.editor, &scene, &surroundings))?;
        if let Some(pane) = &self.pane
            && self.pane_size != view_size
            && view_size.0 > 0
            && view_size.1 > 0
        {
            self.pane_size = view_size;
            pane.resize(view_size.0, view_size.1);
        }
        let is_given = |given: &Scene| given.still.revision == scene.still.revision && given.now == scene.now;
        if !self.given.as_ref().is_some_and(is_given) {
            for preview in [&self.pane, &self.window].into_iter().flatten() {
                preview.show(scene.clone());
            }
            self.given = Some(scene);
        }
        Ok(())
    }
}
