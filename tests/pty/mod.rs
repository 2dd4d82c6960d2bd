//! A program in a pseudo-terminal, looked at from outside: what it writes, what a terminal shows of it, how it ends.

use std::{
    ffi::OsStr,
    io::{Read, Write},
    num::NonZeroU16,
    sync::{
        Arc, Mutex,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::{Duration, Instant},
};

use portable_pty::{Child, CommandBuilder, MasterPty, PtySize, native_pty_system};
use rustix::process::{Pid, Signal, kill_process};

/// How long anything may take before it counts as never.
pub(crate) const PATIENCE: Duration = Duration::from_secs(60);

/// A pseudo-terminal with a program in it.
pub(crate) struct Host {
    master: Box<dyn MasterPty + Send>,
    writer: Box<dyn Write + Send>,
    child: Box<dyn Child + Send + Sync>,
    /// Everything the program wrote, and what a terminal shows of it.
    seen: Arc<Mutex<(Vec<u8>, vt100::Parser)>>,
    /// While false, nobody reads.
    pub(crate) reading: Arc<AtomicBool>,
    reader: thread::JoinHandle<()>,
    /// The terminal's settings before the program, as text: their type belongs to a library we do not name.
    found: String,
}

impl Host {
    /// Starts a program in a terminal of this many columns and rows.
    pub(crate) fn start(command: &CommandBuilder, size: (u16, u16)) -> Self {
        let pty = native_pty_system().openpty(pty_size(size)).expect("a pseudo-terminal");
        let found = settings(pty.master.as_ref());
        let child = pty.slave.spawn_command(command.clone()).expect("the program starts");
        let seen = Arc::new(Mutex::new((Vec::new(), vt100::Parser::new(cells(size.1), cells(size.0), 0))));
        let reading = Arc::new(AtomicBool::new(true));
        let mut from = pty.master.try_clone_reader().expect("a reader");
        let reader = thread::spawn({
            let (seen, reading) = (Arc::clone(&seen), Arc::clone(&reading));
            move || {
                let mut bytes = [0; 4096];
                while let Ok(n @ 1..) = from.read(&mut bytes) {
                    let mut seen = seen.lock().expect("not poisoned");
                    seen.0.extend_from_slice(&bytes[..n]);
                    seen.1.process(&bytes[..n]);
                    drop(seen);
                    if !reading.load(Ordering::SeqCst) {
                        return;
                    }
                }
            }
        });
        let writer = pty.master.take_writer().expect("a writer");
        Self { master: pty.master, writer, child, seen, reading, reader, found }
    }

    /// Starts a shell with job control that has these variables too, and waits for its prompt.
    pub(crate) fn shell(variables: &[(&str, &OsStr)], size: (u16, u16)) -> Self {
        let mut command = CommandBuilder::new("sh");
        command.arg("-i");
        command.env("PS1", "prompt> ");
        command.env("ENV", "");
        for (name, value) in variables {
            command.env(name, value);
        }
        let host = Self::start(&command, size);
        host.await_text("prompt>");
        host
    }

    pub(crate) fn send(&mut self, bytes: &[u8]) {
        self.writer.write_all(bytes).expect("the terminal takes keys");
        self.writer.flush().expect("the terminal takes keys");
    }

    pub(crate) fn pid(&self) -> Pid {
        Pid::from_raw(self.child.process_id().expect("running") as i32).expect("a process id")
    }

    pub(crate) fn signal(&self, signal: Signal) {
        kill_process(self.pid(), signal).expect("the program runs");
    }

    /// Changes the terminal's size, as a user who drags its corner.
    pub(crate) fn resize(&self, size: (u16, u16)) {
        self.seen.lock().expect("not poisoned").1.screen_mut().set_size(cells(size.1), cells(size.0));
        self.master.resize(pty_size(size)).expect("resizes");
    }

    /// Returns all that the program wrote.
    pub(crate) fn bytes(&self) -> Vec<u8> {
        self.seen.lock().expect("not poisoned").0.clone()
    }

    pub(crate) fn on_screen<T>(&self, look: impl FnOnce(&vt100::Screen) -> T) -> T {
        look(self.seen.lock().expect("not poisoned").1.screen())
    }

    pub(crate) fn contents(&self) -> String {
        self.on_screen(vt100::Screen::contents)
    }

    pub(crate) fn await_text(&self, text: &str) {
        self.await_that(text, |screen| screen.contents().contains(text));
    }

    /// Waits until the screen is as wanted; `what` says for the failure what that is.
    pub(crate) fn await_that(&self, what: &str, is_so: impl Fn(&vt100::Screen) -> bool) {
        let waited = Instant::now();
        while !self.on_screen(&is_so) {
            assert!(waited.elapsed() < PATIENCE, "`{what}` never came; the screen shows:\n{}", self.contents());
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Waits for the end and returns the exit status and how long it took.
    pub(crate) fn await_end(&mut self) -> (u32, Duration) {
        let waited = Instant::now();
        loop {
            if let Some(status) = self.child.try_wait().expect("can be asked") {
                return (status.exit_code(), waited.elapsed());
            }
            assert!(waited.elapsed() < PATIENCE, "the program never ended; the screen shows:\n{}", self.contents());
            thread::sleep(Duration::from_millis(5));
        }
    }

    /// Asserts that the terminal is as it was before the program.
    pub(crate) fn assert_given_back(&self) {
        // What was written last may not have been read yet.
        let waited = Instant::now();
        while self.on_screen(vt100::Screen::alternate_screen) && waited.elapsed() < PATIENCE {
            thread::sleep(Duration::from_millis(5));
        }
        assert!(!self.on_screen(vt100::Screen::alternate_screen), "the alternate screen is left");
        assert!(!self.on_screen(vt100::Screen::hide_cursor), "the cursor is shown");
        assert!(!self.on_screen(vt100::Screen::bracketed_paste), "bracketed paste is off");
        self.assert_settings_given_back();
    }

    /// Asserts that the terminal's settings are as they were, whatever its screen shows.
    pub(crate) fn assert_settings_given_back(&self) {
        assert_eq!(settings(self.master.as_ref()), self.found);
    }

    /// Asserts that the terminal is the program's.
    pub(crate) fn assert_taken(&self) {
        assert!(self.on_screen(vt100::Screen::alternate_screen));
        assert!(self.on_screen(vt100::Screen::hide_cursor));
        assert!(self.on_screen(vt100::Screen::bracketed_paste));
        assert_ne!(settings(self.master.as_ref()), self.found);
    }

    /// Closes the terminal, as a dropped connection does.
    pub(crate) fn close(mut self) -> Box<dyn Child + Send + Sync> {
        self.reading.store(false, Ordering::SeqCst);
        // The answer to this key wakes the reader a last time.
        self.send(b"x");
        self.reader.join().expect("the reader ends");
        self.child
    }
}

/// Asserts that a program whose terminal is gone goes too.
pub(crate) fn assert_ends_within_two_seconds(mut child: Box<dyn Child + Send + Sync>) {
    let waited = Instant::now();
    let status = loop {
        if let Some(status) = child.try_wait().expect("can be asked") {
            break status;
        }
        if waited.elapsed() > Duration::from_secs(2) {
            child.kill().expect("can be killed");
            panic!("the program outlived its terminal");
        }
        thread::sleep(Duration::from_millis(5));
    };
    assert_eq!(status.exit_code(), 129);
}

fn settings(master: &(dyn MasterPty + Send)) -> String {
    format!("{:?}", master.get_termios().expect("settings"))
}

fn pty_size((cols, rows): (u16, u16)) -> PtySize {
    PtySize { rows, cols, pixel_width: 0, pixel_height: 0 }
}

fn cells(n: u16) -> NonZeroU16 {
    NonZeroU16::new(n).expect("not zero")
}
