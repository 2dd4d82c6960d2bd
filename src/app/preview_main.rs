//! The preview's side of the link: what runs in the child process, with a window or without.
//!
//! The main thread belongs to the viewport. One thread reads scenes into a newest-wins mailbox, one writes events. When
//! the link ends, in whatever way, so does the process: nobody is left to show anything to.
//!
//! Standard output is the link. It is taken away at the start, so that whatever a driver prints lands with the complaints
//! on standard error, where the editor finds it.

use std::{
    fs::File,
    io::{self, IsTerminal},
    os::fd::AsFd,
    panic,
    process::ExitCode,
    sync::mpsc::{self, Receiver, SyncSender},
    thread,
    time::Duration,
};

use rustix::process::{Signal, getpid, kill_process};

use crate::{
    editor::Window,
    link::{self, EventWriter, SceneReader, one_line},
    scene::{FromPreview, ToPreview},
    sync::Mailbox,
    viewport::{
        RendererOptions,
        headless::{self, Request},
        window,
    },
};

/// How long the process may go on once its link has ended, should the driver or the display hold it.
const GRACE: Duration = Duration::from_secs(2);

/// Events on their way to the editor. An editor that leaves this many unread is stopped, and misses what follows.
const EVENTS: usize = 1024;

/// What a preview draws on.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Mode {
    /// A window.
    Window(Window),
    /// Pictures that go back over the link.
    Headless,
}

/// Runs the preview process: scenes from standard input, events to standard output, until one of the two sides ends it.
///
/// Must be called on the main thread, before anything is printed.
pub fn run(mode: Mode) -> ExitCode {
    panic::set_hook(Box::new(|info| eprintln!("{}", one_line(&info.to_string()))));
    if io::stdin().is_terminal() || io::stdout().is_terminal() {
        eprintln!("`walkabout preview` talks to the editor that starts it, not to a terminal");
        return ExitCode::from(2);
    }
    match take_stdio() {
        Ok((input, output)) => serve(mode, input, output),
        Err(e) => {
            eprintln!("the preview cannot take its link: {e}");
            ExitCode::FAILURE
        }
    }
}

/// Takes standard input and output for the link; what others read is empty, what others print is a complaint.
fn take_stdio() -> io::Result<(File, File)> {
    let input = io::stdin().as_fd().try_clone_to_owned()?;
    let output = io::stdout().as_fd().try_clone_to_owned()?;
    rustix::stdio::dup2_stdin(File::open("/dev/null")?)?;
    rustix::stdio::dup2_stdout(io::stderr())?;
    Ok((input.into(), output.into()))
}

fn serve(mode: Mode, input: File, output: File) -> ExitCode {
    let (events, outbox) = mpsc::sync_channel(EVENTS);
    let writer = thread::spawn(move || write_events(output, &outbox));
    let mut last = FromPreview::Closed;
    let options = RendererOptions::default();
    let on_event = |event| match event {
        FromPreview::Closed | FromPreview::Failed(_) => last = event,
        event => pass_on(&events, event),
    };
    let broken = match mode {
        Mode::Window(which) => {
            let title = match which {
                Window::First => "walkabout",
                Window::Second => "walkabout, second window",
            };
            let scenes = Mailbox::default();
            let broken = read_into(scenes.clone(), input, |message| match message {
                ToPreview::Scene(scene) => Some(scene),
                ToPreview::Size { .. } | ToPreview::Close => None,
            });
            window::run(title, &options, &scenes, on_event);
            broken
        }
        Mode::Headless => {
            let requests = Mailbox::default();
            let broken = read_into(requests.clone(), input, requests_of_messages());
            headless::run(&options, &requests, on_event);
            broken
        }
    };
    if let Ok(e) = broken.try_recv() {
        last = FromPreview::Failed(e.to_string());
    }
    let code = if last == FromPreview::Closed { ExitCode::SUCCESS } else { ExitCode::FAILURE };
    // Nothing arrives when the editor has gone, which is no failure of the preview's.
    let _ = events.send(last);
    drop(events);
    let _ = writer.join();
    code
}

/// Hands an event to the writing thread. Pictures wait for their turn, which holds back drawing and nothing else; a
/// window must go on whatever the editor does.
fn pass_on(events: &SyncSender<FromPreview>, event: FromPreview) {
    let _ = match event {
        FromPreview::Frame(_) => events.send(event).is_ok(),
        event => events.try_send(event).is_ok(),
    };
}

/// Makes requests of what comes down the link: the newest scene in the newest size.
fn requests_of_messages() -> impl FnMut(ToPreview) -> Option<Request> {
    let (mut newest, mut size) = (None, None);
    move |message| {
        match message {
            ToPreview::Scene(scene) => newest = Some(scene),
            ToPreview::Size { width, height } => size = Some((width, height)),
            ToPreview::Close => {}
        }
        let (width, height) = size?;
        Some(Request { scene: newest.clone()?, width, height })
    }
}

/// Starts the thread that reads the link into a mailbox. When the link breaks, the reason is sent before the mailbox is
/// closed.
fn read_into<T: Send + 'static>(
    mailbox: Mailbox<T>,
    input: File,
    mut make: impl FnMut(ToPreview) -> Option<T> + Send + 'static,
) -> Receiver<link::Error> {
    let (broken, reasons) = mpsc::channel();
    thread::spawn(move || {
        let leaving = Leaving(mailbox);
        let mut reader = SceneReader::new(input);
        loop {
            match reader.read() {
                Ok(Some(ToPreview::Close) | None) => return,
                Ok(Some(message)) => {
                    if let Some(value) = make(message) {
                        leaving.0.put(value);
                    }
                }
                Err(e) => {
                    let _ = broken.send(e);
                    return;
                }
            }
        }
    });
    reasons
}

/// Ends the process when the reading thread ends, even by a panic: first by asking, then by force.
struct Leaving<T>(Mailbox<T>);

impl<T> Drop for Leaving<T> {
    fn drop(&mut self) {
        self.0.close();
        thread::sleep(GRACE);
        // Not `exit`, which runs what libraries registered and can hang in a driver that already does.
        let _ = kill_process(getpid(), Signal::KILL);
    }
}

fn write_events(output: File, outbox: &Receiver<FromPreview>) -> Result<(), link::Error> {
    let mut writer = EventWriter::new(output)?;
    outbox.iter().try_for_each(|event| writer.send(&event))
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::scene::{Now, Scene, Still};

    fn scene(revision: u64) -> Scene {
        let still = Still {
            revision,
            body_height: 1.0,
            bodies: vec![],
            curves: vec![],
            footprints: vec![],
            marks: vec![],
            labels: vec![],
            ground: None,
        };
        let now = Now { actors: vec![], marks: vec![], labels: vec![], views: vec![], caption: String::new() };
        Scene { still: Arc::new(still), now }
    }

    #[test]
    fn requests_take_the_newest_scene_and_the_newest_size() {
        let mut make = requests_of_messages();
        assert_eq!(make(ToPreview::Scene(scene(1))), None);
        let size = |width| ToPreview::Size { width, height: 9 };
        let request = |revision, width| Some(Request { scene: scene(revision), width, height: 9 });
        assert_eq!(make(size(16)), request(1, 16));
        assert_eq!(make(size(32)), request(1, 32));
        assert_eq!(make(ToPreview::Scene(scene(2))), request(2, 32));
    }
}
