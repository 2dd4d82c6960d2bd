//! The running editor: its event loop, its threads and its preview processes.
//!
//! One enum of events and one `match`: whatever can wake the program is in `Event`. This thread alone writes the
//! document, solves and draws the terminal; the input, signal and preview threads only send. What changes is shown at once,
//! with the numbers of the feet where it moves along the path, and measured wholly once nothing has come in for a moment;
//! a search that something comes in upon is given up and made again later.

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
    editor::{Editor, Effect, Message, Window},
    scene::{FromPreview, Picture, Scene},
    tui::{self, Drawn, InputEvent, InputThread, Palette, Screen, Surroundings, Terminal},
};
use preview::{Preview, PreviewProgram, display_available};
use signals::SignalEvent;

/// Shortest time between two drawn frames while playing.
const FRAME: Duration = Duration::from_millis(33);
/// The same over SSH, where bytes are dear.
const FRAME_OVER_SSH: Duration = Duration::from_millis(66);

/// What is shown is measured once nothing has happened for this long: longer than from one step of a held key to the next.
const REST: Duration = Duration::from_millis(80);

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

/// The kinds of preview.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Kind {
    Window(Window),
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
    let mut send_input = forward(&sender, Event::Input);
    let hurry = editor.document().hurry();
    let _input = InputThread::start(screen, move |event| {
        hurry.raise();
        send_input(event)
    })?;
    let mut app = App::new(editor, terminal, sender);
    if let Err(why) = app.open_window(Window::First) {
        app.window_line = why;
    }
    // Drawing fails only when the terminal is gone.
    let status = app.run(&events).unwrap_or(HANGUP_STATUS);
    app.close_previews();
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
    /// The windows that are open, by [`Window`].
    windows: [Option<Shown>; 2],
    /// One line about the first window: what draws it, or why there is none.
    window_line: String,
    pane: Option<Shown>,
    /// The number of the pane that is open, or of the next one.
    pane_number: u32,
    /// The pane's newest picture, and the size it was asked for.
    picture: Option<Picture>,
    pane_size: (u32, u32),
    frame: Duration,
}

/// A preview and what it has to show.
struct Shown {
    preview: Preview,
    /// The scene it was given last.
    given: Option<Scene>,
}

impl Shown {
    /// Hands a scene over, if it is not the one the preview has: it draws what it is given, and a picture of the pane
    /// comes back as an event.
    fn show(&mut self, scene: &Scene) {
        let is_given = |given: &Scene| given.still.revision == scene.still.revision && given.now == scene.now;
        if !self.given.as_ref().is_some_and(is_given) {
            self.preview.show(scene.clone());
            self.given = Some(scene.clone());
        }
    }
}

impl App {
    fn new(mut editor: Editor, terminal: Terminal, sender: Sender<Event>) -> Self {
        editor.show_drafts();
        let over_ssh = std::env::var_os("SSH_CONNECTION").is_some();
        Self {
            editor,
            terminal,
            palette: Palette::new(tui::Depth::from_env()),
            sender,
            windows: [None, None],
            window_line: String::new(),
            pane: None,
            pane_number: 0,
            picture: None,
            pane_size: (0, 0),
            frame: if over_ssh { FRAME_OVER_SSH } else { FRAME },
        }
    }

    fn run(&mut self, events: &Receiver<Event>) -> io::Result<u8> {
        let mut last = Instant::now();
        self.show()?;
        loop {
            let is_measured = self.editor.document().solved().is_measured();
            let patience = match self.editor.view().playing {
                true => Some(self.frame.saturating_sub(last.elapsed())),
                false => (!is_measured).then_some(REST),
            };
            let event = match patience.map(|patience| events.recv_timeout(patience)) {
                Some(Err(RecvTimeoutError::Timeout)) => None,
                Some(other) => other.ok(),
                None => events.recv().ok(),
            };
            let secs = last.elapsed().as_secs_f64();
            last = Instant::now();
            let mut changed = self.editor.advance(secs);
            if event.is_none() {
                self.editor.document().hurry().lower();
                changed |= self.editor.measure();
            }
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
            Event::Input(InputEvent::Key(key)) => {
                let effect = self.editor.key(key);
                return self.effect(effect, None);
            }
            Event::Preview(Kind::Window(window), FromPreview::Key(key)) => {
                self.editor.use_window(window);
                let effect = self.editor.key(key);
                return self.effect(effect, Some(window));
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

    /// Does what the editor asks for; `pressed_in` is the window that the key was pressed in, none for the terminal.
    fn effect(&mut self, effect: Effect, pressed_in: Option<Window>) -> io::Result<Next> {
        match effect {
            Effect::None => {}
            Effect::Quit => return Ok(Next::Leave(0)),
            Effect::Suspend => self.suspend(),
            Effect::ToggleWindow => self.toggle_window(pressed_in.unwrap_or(Window::First)),
            Effect::ToggleSecondWindow => self.toggle_window(Window::Second),
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
            (Kind::Window(Window::First), FromPreview::Ready { device, driver }) => {
                self.window_line = format!("window: {device}, {driver}");
            }
            (Kind::Pane(_), FromPreview::Frame(picture)) => self.picture = Some(picture),
            (Kind::Window(window), FromPreview::Closed) => {
                self.window_is_gone(window, "window closed; w opens it".to_owned());
            }
            (Kind::Window(window), FromPreview::Failed(why)) => {
                self.window_is_gone(window, why.clone());
                self.editor.say(Message::warning(why));
            }
            (Kind::Pane(_), FromPreview::Closed) => self.close_pane(),
            (Kind::Pane(_), FromPreview::Failed(why)) => {
                self.close_pane();
                self.editor.say(Message::warning(why));
            }
            (Kind::Window(window), FromPreview::Pick(ray)) => {
                self.editor.use_window(window);
                self.editor.focus_view(ray.view as usize);
                // What was clicked on is what the window was given.
                if let Some(Shown { given: Some(scene), .. }) = &self.windows[window as usize] {
                    self.editor.press(scene, &ray);
                }
            }
            (Kind::Window(window), FromPreview::Wheel { view, steps }) => {
                self.editor.use_window(window);
                self.editor.focus_view(view as usize);
                self.editor.wheel(steps);
            }
            (Kind::Window(_), FromPreview::Drag(ray)) => self.editor.drag(&ray),
            (Kind::Window(_), FromPreview::Release) => self.editor.release(),
            // A window sends no frames, a pane nothing else.
            (_, FromPreview::Pick(_) | FromPreview::Drag(_) | FromPreview::Release | FromPreview::Wheel { .. }) => {}
            (_, FromPreview::Key(_) | FromPreview::Ready { .. } | FromPreview::Frame(_)) => {}
        }
    }

    /// Forgets a window that has ended; keys act on the one that is left, else on the first.
    fn window_is_gone(&mut self, window: Window, line: String) {
        self.windows[window as usize] = None;
        if window == Window::First {
            self.window_line = line;
        }
        if self.editor.window() == window {
            let left = Window::BOTH.into_iter().find(|other| self.windows[*other as usize].is_some());
            self.editor.use_window(left.unwrap_or(Window::First));
        }
    }

    /// Opens a window; the error is one line that says why there is none.
    fn open_window(&mut self, window: Window) -> Result<(), String> {
        display_available()?;
        let shown = self.start(Kind::Window(window), PreviewProgram::window(window))?;
        self.windows[window as usize] = Some(shown);
        if window == Window::First {
            self.window_line = "window: opening".to_owned();
        }
        Ok(())
    }

    fn toggle_window(&mut self, window: Window) {
        match &self.windows[window as usize] {
            // It ends by itself; its last event tells so.
            Some(shown) => shown.preview.close(),
            None => match self.open_window(window) {
                Ok(()) => self.editor.use_window(window),
                Err(why) => {
                    self.window_is_gone(window, why.clone());
                    self.editor.say(Message::warning(why));
                }
            },
        }
    }

    fn toggle_pane(&mut self) {
        if self.pane.is_some() {
            self.close_pane();
        } else {
            match self.start(Kind::Pane(self.pane_number), PreviewProgram::headless()) {
                Ok(shown) => self.pane = Some(shown),
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

    /// Asks all previews to close, so that dropping them waits for all at once.
    fn close_previews(&self) {
        for shown in self.windows.iter().chain([&self.pane]).flatten() {
            shown.preview.close();
        }
    }

    fn start(&self, kind: Kind, program: io::Result<PreviewProgram>) -> Result<Shown, String> {
        let program = program.map_err(|e| format!("no preview: {e}"))?;
        let (sender, hurry) = (self.sender.clone(), self.editor.document().hurry());
        let preview = Preview::start(&program, move |event| {
            // A picture that was asked for is nothing new.
            if !matches!(event, FromPreview::Frame(_)) {
                hurry.raise();
            }
            // Nobody listens any more only when the editor is leaving.
            let _ = sender.send(Event::Preview(kind, event));
        });
        Ok(Shown { preview: preview.map_err(|e| format!("no preview: {e}"))?, given: None })
    }

    /// Draws the terminal and hands each preview its scene: a window that of its own views, the pane that of the window
    /// in use.
    fn show(&mut self) -> io::Result<()> {
        let scene = self.editor.scene();
        let surroundings = Surroundings {
            palette: self.palette,
            window_line: match self.windows {
                [None, Some(_)] => "second window open; w opens the first",
                _ => &self.window_line,
            },
            picture: self.picture.as_ref(),
            pane_open: self.pane.is_some(),
        };
        let mut drawn = Drawn::default();
        self.terminal.draw(|frame| drawn = tui::draw(frame, &self.editor, &scene, &surroundings))?;
        self.editor.end_help_at(drawn.help_end);
        let view_size = drawn.picture_size;
        if let Some(pane) = &mut self.pane {
            if self.pane_size != view_size && view_size.0 > 0 && view_size.1 > 0 {
                self.pane_size = view_size;
                pane.preview.resize(view_size.0, view_size.1);
            }
            pane.show(&scene);
        }
        for (window, shown) in Window::BOTH.into_iter().zip(&mut self.windows) {
            if let Some(shown) = shown {
                shown.show(&self.editor.scene_in(window));
            }
        }
        Ok(())
    }
}
