//! The editor's side of the preview: a child process that is watched, never waited for.
//!
//! Four threads serve one preview. *In* takes the newest scene from a mailbox and writes it to the child; *out* reads
//! the child's events; *err* keeps the end of what it complains; *watch* alone owns the child, reaps it and speaks to the
//! editor. Whatever happens to the child, the editor hears of it exactly once, as the last event: [`FromPreview::Closed`]
//! or [`FromPreview::Failed`]. By then the process is gone and another preview can be started.
//!
//! The child is the leader of its own process group: Ctrl-C and Ctrl-Z on the terminal go to the editor, which decides.
//! When the editor goes, by SIGKILL too, the child's input ends and the child with it.

use std::{
    env,
    ffi::OsString,
    io::{self, Read},
    os::unix::process::CommandExt,
    path::{Path, PathBuf},
    process::{Child, ChildStderr, ChildStdin, ChildStdout, Command, ExitStatus, Stdio},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
        mpsc::{self, Receiver, Sender, SyncSender},
    },
    thread,
    time::{Duration, Instant},
};

use rustix::process::{Pid, Signal, kill_process_group};

use crate::{
    editor::Window,
    link::{self, EventReader, MAX_PICTURE, SceneWriter, one_line},
    scene::{FromPreview, Scene, ToPreview},
    sync::Mailbox,
};

/// How long a preview may take to close before it is killed.
const PATIENCE: Duration = Duration::from_millis(300);

/// How long a killed preview's end and last words are waited for; a process stuck in its driver may take for ever.
const BURIAL: Duration = Duration::from_millis(200);

/// How often a preview that has said all is looked at until it is gone.
const GLANCE: Duration = Duration::from_millis(2);

/// Events on their way to the editor; more make the preview wait.
const EVENTS: usize = 64;

/// What is kept of the preview's complaints, in bytes.
const LAST_WORDS: usize = 4096;

/// The program to start as a preview, told by the caller so that tests can name another.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct PreviewProgram {
    /// The program.
    pub program: PathBuf,
    /// Its arguments.
    pub args: Vec<OsString>,
}

impl PreviewProgram {
    /// Names this very program as a preview with a window.
    ///
    /// # Errors
    ///
    /// When the system does not know what program this is.
    pub fn window(window: Window) -> io::Result<Self> {
        let args = match window {
            Window::First => vec!["preview".into()],
            Window::Second => vec!["preview".into(), "--second".into()],
        };
        Ok(Self { program: this_program()?, args })
    }

    /// Names this very program as a preview without a window, which sends its pictures back.
    ///
    /// # Errors
    ///
    /// When the system does not know what program this is.
    pub fn headless() -> io::Result<Self> {
        Ok(Self { program: this_program()?, args: vec!["preview".into(), "--headless".into()] })
    }
}

/// A preview that was not started.
#[derive(Debug, thiserror::Error)]
#[error("cannot start the preview {}: {source}", program.display())]
pub struct CannotStart {
    /// The program that was tried.
    program: PathBuf,
    /// What the system says.
    source: io::Error,
}

/// A running preview, or what is left of one.
///
/// Dropping it closes the preview and waits until it is gone, half a second at most.
#[derive(Debug)]
pub struct Preview {
    wanted: Mailbox<Wanted>,
    inbox: SyncSender<News>,
    state: Arc<State>,
    /// Ends when the watching thread does.
    gone: Receiver<()>,
}

/// What the preview should show and has not been told yet; the newest of each.
#[derive(Debug, Default)]
struct Wanted {
    size: Option<(u32, u32)>,
    scene: Option<Scene>,
}

#[derive(Debug, Default)]
struct State {
    /// The editor asked the preview to close.
    closing: AtomicBool,
    /// The last event is out or about to be.
    ended: AtomicBool,
}

/// What wakes the watching thread.
#[derive(Debug)]
enum News {
    Event(FromPreview),
    /// The child's output has ended, or makes no sense.
    OutputEnded(Result<(), link::Error>),
    /// The child's input takes nothing any more, or should have taken what is too large.
    InputFailed(link::Error),
    /// The editor asked to close.
    Closing,
}

impl Preview {
    /// Starts a preview. `on_event` is called from a thread of the preview's own for each event in order, the last of
    /// them `Closed` or `Failed`, and never again; it must not wait for the thread that holds the handle.
    ///
    /// # Errors
    ///
    /// When the program cannot be started; no event comes then.
    pub fn start(
        program: &PreviewProgram,
        on_event: impl FnMut(FromPreview) + Send + 'static,
    ) -> Result<Self, CannotStart> {
        Self::spawn(program, on_event).map_err(|source| CannotStart { program: program.program.clone(), source })
    }

    fn spawn(program: &PreviewProgram, on_event: impl FnMut(FromPreview) + Send + 'static) -> io::Result<Self> {
        let mut child = Command::new(&program.program)
            .args(&program.args)
            .stdin(Stdio::piped())
            .stdout(Stdio::piped())
            .stderr(Stdio::piped())
            .process_group(0)
            .spawn()?;
        let (stdin, stdout, stderr) = (child.stdin.take(), child.stdout.take(), child.stderr.take());
        let (inbox, news) = mpsc::sync_channel(EVENTS);
        let (words, last_words) = mpsc::channel();
        let (gone_sender, gone) = mpsc::channel();
        let preview = Self { wanted: Mailbox::default(), inbox, state: Arc::default(), gone };
        let (wanted, inbox) = (preview.wanted.clone(), preview.inbox.clone());
        spawn("preview in", move || write_scenes(stdin.expect("piped"), &wanted, &inbox))?;
        let inbox = preview.inbox.clone();
        spawn("preview out", move || read_events(stdout.expect("piped"), &inbox))?;
        spawn("preview err", move || read_last_words(stderr.expect("piped"), &words))?;
        let (wanted, state) = (preview.wanted.clone(), Arc::clone(&preview.state));
        let watch = Watch { child, news, last_words, wanted, state, on_event };
        spawn("preview watch", move || {
            watch.run();
            drop(gone_sender);
        })?;
        Ok(preview)
    }

    /// Has this scene shown, as soon as the preview gets to it; never waits. A scene not yet sent is forgotten.
    pub fn show(&self, scene: Scene) {
        self.want(|wanted| wanted.scene = Some(scene));
    }

    /// Has a headless preview draw frames of this size in pixels, kept within what a picture can be; never waits.
    pub fn resize(&self, width: u32, height: u32) {
        let size = (width.clamp(1, MAX_PICTURE[0]), height.clamp(1, MAX_PICTURE[1]));
        self.want(|wanted| wanted.size = Some(size));
    }

    /// Asks the preview to close and does not wait; the last event follows.
    pub fn close(&self) {
        self.state.closing.store(true, Ordering::Release);
        self.wanted.close();
        // A full inbox will wake the watching thread as well, and it looks at `closing` each time.
        let _ = self.inbox.try_send(News::Closing);
    }

    /// Tells whether the last event is still to come.
    pub fn is_running(&self) -> bool {
        !self.state.ended.load(Ordering::Acquire)
    }

    /// Changes what is wanted. The editor is the only one who puts, so what is taken here cannot get lost.
    fn want(&self, change: impl FnOnce(&mut Wanted)) {
        let mut wanted = self.wanted.take().unwrap_or_default();
        change(&mut wanted);
        self.wanted.put(wanted);
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        self.close();
        let _ = self.gone.recv_timeout(PATIENCE + BURIAL);
    }
}

/// Tells whether there is a display to open a window on, without starting anything.
///
/// # Errors
///
/// One line that says why there is no window and what would bring it.
pub fn display_available() -> Result<(), String> {
    display_in(|name| env::var_os(name).is_some_and(|value| !value.is_empty()))
}

fn display_in(is_set: impl Fn(&str) -> bool) -> Result<(), String> {
    if ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"].into_iter().any(&is_set) {
        Ok(())
    } else if is_set("SSH_CONNECTION") {
        Err("no window: this SSH connection carries no display; `ssh -X` would bring one".to_owned())
    } else {
        Err("no window: there is no display; start from a desktop, or set WAYLAND_DISPLAY or DISPLAY".to_owned())
    }
}

/// The file of this program, also after it was replaced by a newer one.
fn this_program() -> io::Result<PathBuf> {
    let own = Path::new("/proc/self/exe");
    if own.exists() { Ok(own.to_owned()) } else { env::current_exe() }
}

fn spawn(name: &str, body: impl FnOnce() + Send + 'static) -> io::Result<()> {
    thread::Builder::new().name(name.to_owned()).spawn(body).map(drop)
}

/// Writes what is wanted until the mailbox is closed, then the wish to close, then ends the child's input.
fn write_scenes(mut stdin: ChildStdin, wanted: &Mailbox<Wanted>, inbox: &SyncSender<News>) {
    if let Err(e) = write_all(&mut stdin, wanted) {
        // Said while the input is still open, so that it is heard before the child's end of it.
        let _ = inbox.send(News::InputFailed(e));
    }
}

fn write_all(stdin: &mut ChildStdin, wanted: &Mailbox<Wanted>) -> Result<(), link::Error> {
    let mut writer = SceneWriter::new(stdin)?;
    while let Some(Wanted { size, scene }) = wanted.wait() {
        if let Some((width, height)) = size {
            writer.send(&ToPreview::Size { width, height })?;
        }
        if let Some(scene) = scene {
            writer.send(&ToPreview::Scene(scene))?;
        }
    }
    writer.send(&ToPreview::Close)
}

fn read_events(stdout: ChildStdout, inbox: &SyncSender<News>) {
    let mut reader = EventReader::new(stdout);
    loop {
        let news = match reader.read() {
            Ok(Some(event)) => News::Event(event),
            Ok(None) => News::OutputEnded(Ok(())),
            Err(e) => News::OutputEnded(Err(e)),
        };
        let is_last = matches!(news, News::OutputEnded(_));
        if inbox.send(news).is_err() || is_last {
            return;
        }
    }
}

/// Reads complaints to their end and passes on the last line.
fn read_last_words(mut stderr: ChildStderr, words: &Sender<String>) {
    let mut tail = Vec::new();
    let mut chunk = [0; LAST_WORDS];
    while let Ok(len @ 1..) = stderr.read(&mut chunk) {
        tail.extend_from_slice(&chunk[..len]);
        tail.drain(..tail.len().saturating_sub(LAST_WORDS));
    }
    let _ = words.send(last_line(&String::from_utf8_lossy(&tail)));
}

/// Returns the last line, and the line it continues when it is indented, as Xlib's last words are.
fn last_line(text: &str) -> String {
    let mut last = String::new();
    for line in text.lines().filter(|line| !line.trim().is_empty()) {
        if !line.starts_with(char::is_whitespace) {
            last.clear();
        }
        last.push_str(line);
        last.push('\n');
    }
    one_line(&last)
}

/// The thread that owns the child.
struct Watch<F> {
    child: Child,
    news: Receiver<News>,
    last_words: Receiver<String>,
    wanted: Mailbox<Wanted>,
    state: Arc<State>,
    on_event: F,
}

/// What is known of a preview that is gone.
#[derive(Debug)]
struct End {
    /// The editor asked for it.
    asked: bool,
    /// The preview's own last event.
    said: Option<FromPreview>,
    /// What went wrong on the link, the first thing if more did.
    link: Option<link::Error>,
    /// How it left; none when it cannot be known.
    status: Option<ExitStatus>,
    /// The last line it complained.
    complaint: String,
}

impl<F: FnMut(FromPreview)> Watch<F> {
    fn run(mut self) {
        let (said, link, deadline) = self.attend();
        let asked = self.state.closing.load(Ordering::Acquire);
        self.wanted.close();
        let status = self.bury(deadline);
        let complaint = self.last_words.recv_timeout(BURIAL).unwrap_or_default();
        self.state.ended.store(true, Ordering::Release);
        (self.on_event)(last_event(End { asked, said, link, status, complaint }));
    }

    /// Passes events on until the child's output ends or its time is up; returns its own last event, what went wrong on
    /// the link and until when it may live.
    fn attend(&mut self) -> (Option<FromPreview>, Option<link::Error>, Instant) {
        let (mut said, mut link, mut deadline) = (None, None, None);
        loop {
            let news = match deadline {
                None => self.news.recv().ok(),
                Some(at) => self.news.recv_timeout(remaining(at)).ok(),
            };
            let is_closing = deadline.is_some() || self.state.closing.load(Ordering::Acquire);
            match news {
                Some(News::Event(event)) if said.is_none() => match event {
                    FromPreview::Closed | FromPreview::Failed(_) => said = Some(event),
                    event if !is_closing => (self.on_event)(event),
                    _ => {}
                },
                Some(News::Event(_) | News::Closing) => {}
                Some(News::InputFailed(e)) => link = link.or(Some(e)),
                Some(News::OutputEnded(Ok(()))) => {
                    return (said, link, deadline.unwrap_or_else(|| Instant::now() + PATIENCE));
                }
                Some(News::OutputEnded(Err(e))) => return (said, link.or(Some(e)), Instant::now()),
                None => return (said, link, Instant::now()),
            }
            if deadline.is_none() && (is_closing || said.is_some() || link.is_some()) {
                self.wanted.close();
                deadline = Some(Instant::now() + PATIENCE);
            }
        }
    }

    /// Waits for the child until the deadline, then kills it and all it started.
    fn bury(&mut self, deadline: Instant) -> Option<ExitStatus> {
        loop {
            match self.child.try_wait() {
                Ok(None) if !remaining(deadline).is_zero() => thread::sleep(GLANCE),
                Ok(None) => break,
                Ok(status) => return status,
                Err(_) => return None,
            }
        }
        // The child is not reaped yet, so its number still names its group and no other.
        if let Some(group) = i32::try_from(self.child.id()).ok().and_then(Pid::from_raw) {
            let _ = kill_process_group(group, Signal::KILL);
        }
        self.child.wait().ok()
    }
}

fn remaining(deadline: Instant) -> Duration {
    deadline.saturating_duration_since(Instant::now())
}

/// Decides what to tell the editor: what the preview itself said is worth most, how it left says least.
fn last_event(end: End) -> FromPreview {
    use link::Error::{Io, Truncated};
    let text = match end {
        End { said: Some(event), .. } => return event,
        End { asked: true, .. } => return FromPreview::Closed,
        // A link that breaks off is how every sudden death looks; how the process left says more.
        End { link: Some(e), .. } if !matches!(e, Io(_) | Truncated { .. }) => {
            format!("the preview's link is bad: {e}")
        }
        End { status: Some(status), complaint, .. } => {
            let status = status.to_string().replacen(": ", " ", 1);
            let colon = if complaint.is_empty() { "" } else { ": " };
            format!("the preview ended with {status}{colon}{complaint}")
        }
        End { complaint, .. } => one_line(&format!("the preview is lost {complaint}")),
    };
    FromPreview::Failed(text)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn without_a_display_one_line_says_what_would_bring_it() {
        for name in ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "DISPLAY"] {
            assert_eq!(display_in(|n| n == name), Ok(()));
        }
        assert!(display_in(|_| false).unwrap_err().contains("set WAYLAND_DISPLAY or DISPLAY"));
        assert!(display_in(|n| n == "SSH_CONNECTION").unwrap_err().contains("`ssh -X`"));
    }

    #[test]
    fn the_last_line_takes_the_line_it_continues_along() {
        assert_eq!(last_line(""), "");
        assert_eq!(last_line("one\ntwo\n\n"), "two");
        assert_eq!(
            last_line("before\nXIO: fatal IO error 11 on X server \":9\"\r\n      after 30 requests\n"),
            "XIO: fatal IO error 11 on X server \":9\" after 30 requests"
        );
    }

    #[test]
    fn the_preview_s_own_last_event_wins() {
        let end = |asked, said| End { asked, said, link: None, status: None, complaint: "why".to_owned() };
        let failed = FromPreview::Failed("no driver".to_owned());
        assert_eq!(last_event(end(true, Some(failed.clone()))), failed);
        assert_eq!(last_event(end(true, None)), FromPreview::Closed);
        assert_eq!(last_event(end(false, None)), FromPreview::Failed("the preview is lost why".to_owned()));
    }
}
