//! The screen lease: the terminal taken over, and given back exactly as it was found.
//!
//! One idea: whoever holds a [`Screen`] (the drawing thread, the panic hook, the signal thread) can give the terminal
//! back at any moment with [`Screen::leave`], once, without waiting for anybody. The settings found on entry are the
//! flag: while they are held, the terminal is ours; taking them out is leaving. A frame that comes after is dropped.

use std::{
    fs::File,
    io::{self, IsTerminal},
    os::fd::{AsFd, BorrowedFd},
    sync::{Arc, Mutex, PoisonError, TryLockError},
    thread,
    time::{Duration, Instant},
};

use crossterm::{
    cursor, event, queue,
    style::{Attribute, SetAttribute},
    terminal,
};
use rustix::{
    event::{PollFd, PollFlags, Timespec},
    process::getpgrp,
    termios::{OptionalActions, Termios, tcgetattr, tcgetpgrp, tcgetwinsize, tcsetattr},
};

/// How long leaving waits for another thread's frame, and then for the terminal to take bytes. Leaving must end even
/// when nobody reads the other side of the terminal.
const LEAVE_PATIENCE: Duration = Duration::from_millis(100);

/// What is assumed of a terminal that does not know its size.
const FALLBACK_SIZE: (u16, u16) = (80, 24);

/// Why the terminal cannot be taken over.
#[derive(Debug, thiserror::Error)]
pub enum ScreenError {
    /// Standard output is a file or a pipe.
    #[error("standard output is not a terminal")]
    NotATerminal,
    /// The terminal refused.
    #[error("the terminal cannot be used: {0}")]
    Io(#[from] io::Error),
}

/// Where keys come from: standard input, or the controlling terminal when that is a file or a pipe.
#[derive(Debug)]
enum Keyboard {
    Stdin,
    Tty(File),
}

#[derive(Debug)]
struct Inner {
    keyboard: Keyboard,
    /// Settings as found on entry; present exactly while the terminal is ours. Held for a move, never across a call.
    found: Mutex<Option<Termios>>,
    /// Held while bytes go out, so that leaving does not land in the middle of a frame.
    writing: Mutex<()>,
}

/// The terminal, ours between [`enter`](Self::enter) and [`leave`](Self::leave): raw mode, alternate screen, no
/// cursor, bracketed paste. Clones are handles on one lease.
#[derive(Clone, Debug)]
pub struct Screen {
    inner: Arc<Inner>,
}

impl Screen {
    /// Finds the terminal and leaves it as it is, so that the panic hook and the signal thread can have their handles
    /// before anything changes.
    ///
    /// # Errors
    ///
    /// When standard output is not a terminal, or when there is no keyboard.
    pub fn open() -> Result<Self, ScreenError> {
        if !io::stdout().is_terminal() {
            return Err(ScreenError::NotATerminal);
        }
        let keyboard = if io::stdin().is_terminal() { Keyboard::Stdin } else { Keyboard::Tty(File::open("/dev/tty")?) };
        Ok(Self { inner: Arc::new(Inner { keyboard, found: Mutex::new(None), writing: Mutex::new(()) }) })
    }

    /// Takes the terminal over, or puts it back in order when it is ours already but a shell changed it behind our
    /// back (a stop by SIGSTOP). The screen is blank afterwards.
    ///
    /// # Errors
    ///
    /// When the terminal refuses; it is then as it was found.
    pub fn enter(&self) -> io::Result<()> {
        let entered = self.try_enter();
        if entered.is_err() {
            self.leave();
        }
        entered
    }

    fn try_enter(&self) -> io::Result<()> {
        let _writing = self.inner.writing.lock().unwrap_or_else(PoisonError::into_inner);
        let now = tcgetattr(self.keyboard())?;
        let mut raw = self.found().get_or_insert(now).clone();
        raw.make_raw();
        tcsetattr(self.keyboard(), OptionalActions::Now, &raw)?;
        let mut bytes = Vec::new();
        queue!(
            bytes,
            terminal::EnterAlternateScreen,
            terminal::Clear(terminal::ClearType::All),
            cursor::Hide,
            event::EnableBracketedPaste,
        )?;
        write_all(rustix::stdio::stdout(), &bytes)
    }

    /// Gives the terminal back as it was found. Does nothing when it already has been; never fails, never waits long;
    /// may be called from any thread.
    pub fn leave(&self) {
        let Some(found) = self.found().take() else { return };
        let _writing = lock_within(&self.inner.writing, LEAVE_PATIENCE);
        let mut bytes = Vec::new();
        let queued = queue!(
            bytes,
            terminal::EndSynchronizedUpdate,
            SetAttribute(Attribute::Reset),
            event::DisableBracketedPaste,
            cursor::Show,
            terminal::LeaveAlternateScreen,
        );
        let out = rustix::stdio::stdout();
        if queued.is_ok() && takes_bytes_within(out, LEAVE_PATIENCE) {
            // A terminal that is gone needs nothing back.
            let _ = write_all(out, &bytes);
        }
        let _ = tcsetattr(self.keyboard(), OptionalActions::Now, &found);
    }

    /// Tells whether the terminal is ours now.
    pub fn is_entered(&self) -> bool {
        self.found().is_some()
    }

    /// Tells whether the terminal listens to this job; a job continued in the background must not touch it. A terminal
    /// that controls no jobs listens to everybody.
    pub fn in_foreground(&self) -> bool {
        tcgetpgrp(self.keyboard()).map_or(true, |group| group == getpgrp())
    }

    /// Returns the terminal's size in columns and rows, 80×24 when it does not know.
    ///
    /// # Errors
    ///
    /// When the terminal is gone.
    pub fn size(&self) -> io::Result<(u16, u16)> {
        let size = tcgetwinsize(self.keyboard())?;
        Ok(if size.ws_col == 0 || size.ws_row == 0 { FALLBACK_SIZE } else { (size.ws_col, size.ws_row) })
    }

    /// Writes one frame; dropped without a word when the terminal is not ours.
    ///
    /// # Errors
    ///
    /// When the terminal is gone.
    pub(super) fn write_frame(&self, bytes: &[u8]) -> io::Result<()> {
        let _writing = self.inner.writing.lock().unwrap_or_else(PoisonError::into_inner);
        if self.is_entered() { write_all(rustix::stdio::stdout(), bytes) } else { Ok(()) }
    }

    /// Returns the terminal that keys come from.
    pub(super) fn keyboard(&self) -> BorrowedFd<'_> {
        match &self.inner.keyboard {
            Keyboard::Stdin => rustix::stdio::stdin(),
            Keyboard::Tty(file) => file.as_fd(),
        }
    }

    fn found(&self) -> std::sync::MutexGuard<'_, Option<Termios>> {
        self.inner.found.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// Makes every panic, in any thread, give the terminal back before its message prints; then calls `then`.
pub fn leave_on_panic(screen: Screen, then: impl Fn() + Send + Sync + 'static) {
    let previous = std::panic::take_hook();
    std::panic::set_hook(Box::new(move |info| {
        screen.leave();
        previous(info);
        then();
    }));
}

/// Takes a lock, or gives up: better a torn last frame than a terminal that is never given back.
fn lock_within(lock: &Mutex<()>, patience: Duration) -> Option<std::sync::MutexGuard<'_, ()>> {
    let deadline = Instant::now() + patience;
    loop {
        match lock.try_lock() {
            Ok(guard) => return Some(guard),
            Err(TryLockError::Poisoned(poisoned)) => return Some(poisoned.into_inner()),
            Err(TryLockError::WouldBlock) if Instant::now() >= deadline => return None,
            Err(TryLockError::WouldBlock) => thread::sleep(Duration::from_millis(2)),
        }
    }
}

fn takes_bytes_within(out: BorrowedFd<'_>, patience: Duration) -> bool {
    let timeout = Timespec { tv_sec: 0, tv_nsec: patience.subsec_nanos().into() };
    let mut fds = [PollFd::from_borrowed_fd(out, PollFlags::OUT)];
    matches!(rustix::event::poll(&mut fds, Some(&timeout)), Ok(n) if n > 0)
}

/// Writes to the descriptor itself: the standard library's handle has a lock that a blocked thread may hold.
fn write_all(out: BorrowedFd<'_>, mut bytes: &[u8]) -> io::Result<()> {
    while !bytes.is_empty() {
        match rustix::io::write(out, bytes) {
            Ok(0) => return Err(io::ErrorKind::WriteZero.into()),
            Ok(n) => bytes = &bytes[n..],
            Err(rustix::io::Errno::INTR) => {}
            // Another program left the shared description non-blocking: wait until it drains.
            Err(rustix::io::Errno::AGAIN) => {
                rustix::event::poll(&mut [PollFd::from_borrowed_fd(out, PollFlags::OUT)], None)?;
            }
            Err(error) => return Err(error.into()),
        }
    }
    Ok(())
}
