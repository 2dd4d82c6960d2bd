//! The input thread: waits for the terminal, turns bytes into keys, sends them on. It decides nothing.
//!
//! It polls the keyboard itself, because a terminal that goes away must end the wait: a hang-up is an event like a
//! key. The second thing it polls is a socket that SIGWINCH and [`InputThread`]'s drop write to. Nothing wakes it
//! otherwise, except once after each burst of bytes, to tell a lone Escape from the beginning of a longer sequence.

use std::{
    io::{self, Read, Write},
    os::{fd::AsFd, unix::net::UnixStream},
    sync::{
        Arc,
        atomic::{AtomicBool, Ordering},
    },
    thread,
    time::Duration,
};

use rustix::{
    event::{PollFd, PollFlags, Timespec},
    io::Errno,
};
use signal_hook::{SigId, consts::SIGWINCH, low_level};
use termina::event::{KeyCode, KeyEventKind, Modifiers};

use super::screen::Screen;
use crate::key::{Code, Key};

/// After this long without another byte, an Escape was the Escape key.
const ESCAPE_WAIT: Duration = Duration::from_millis(50);

/// How often a job in the background looks whether it has the keyboard again.
const BACKGROUND_WAIT: Duration = Duration::from_millis(20);

/// What the terminal tells us.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum InputEvent {
    /// A key was pressed, or repeats while held.
    Key(Key),
    /// Text was pasted; it is text, not key presses.
    Paste(String),
    /// The terminal has a new size in columns and rows.
    Resize(u16, u16),
    /// The terminal is gone; nothing follows.
    Hangup,
}

/// The running input thread. Dropping it tells the thread to end, and does not wait for it.
#[derive(Debug)]
pub struct InputThread {
    stop: Arc<AtomicBool>,
    wake: UnixStream,
    resized: SigId,
}

impl InputThread {
    /// Starts reading `screen`'s keyboard; `send` is called on the new thread with each event, and ends the thread by
    /// returning false.
    ///
    /// # Errors
    ///
    /// When the system has no socket, signal or thread left.
    pub fn start(screen: Screen, send: impl FnMut(InputEvent) -> bool + Send + 'static) -> io::Result<Self> {
        let (woken, wake) = UnixStream::pair()?;
        woken.set_nonblocking(true)?;
        wake.set_nonblocking(true)?;
        let resized = low_level::pipe::register(SIGWINCH, wake.try_clone()?)?;
        let stop = Arc::new(AtomicBool::new(false));
        let reader = Reader { screen, woken, stop: Arc::clone(&stop), parser: termina::Parser::default(), send };
        thread::Builder::new().name("input".to_owned()).spawn(move || reader.run())?;
        Ok(Self { stop, wake, resized })
    }
}

impl Drop for InputThread {
    fn drop(&mut self) {
        low_level::unregister(self.resized);
        self.stop.store(true, Ordering::Relaxed);
        // A full socket is a wake-up already under way.
        let _ = self.wake.write(&[0]);
    }
}

struct Reader<F> {
    screen: Screen,
    woken: UnixStream,
    stop: Arc<AtomicBool>,
    parser: termina::Parser,
    send: F,
}

impl<F: FnMut(InputEvent) -> bool> Reader<F> {
    fn run(mut self) {
        // Not the size of now: the first frame may have been drawn before a change that we have yet to be woken for.
        let mut size = (0, 0);
        let mut may_be_escape = false;
        loop {
            let (keyboard, woken) = match wait(&self.screen, &self.woken, may_be_escape.then_some(ESCAPE_WAIT)) {
                Ok(ready) => ready,
                Err(Errno::INTR) => continue,
                Err(_) => return self.hang_up(),
            };
            if woken.intersects(PollFlags::IN) {
                drain(&mut self.woken);
                let now = self.screen.size().unwrap_or(size);
                if now != std::mem::replace(&mut size, now) && !(self.send)(InputEvent::Resize(now.0, now.1)) {
                    return;
                }
            }
            if self.stop.load(Ordering::Relaxed) {
                return;
            }
            if keyboard == PollFlags::IN && !self.screen.in_foreground() {
                // Continued in the background: the bytes are the shell's, and reading them would stop the process
                // before it hears why it was continued.
                thread::sleep(BACKGROUND_WAIT);
            } else if keyboard.intersects(PollFlags::IN) {
                match self.read() {
                    Ok(true) => may_be_escape = true,
                    Ok(false) => return self.hang_up(),
                    Err(Errno::INTR | Errno::AGAIN) => {}
                    Err(_) => return self.hang_up(),
                }
            } else if keyboard.intersects(PollFlags::HUP | PollFlags::ERR | PollFlags::NVAL) {
                return self.hang_up();
            } else if may_be_escape && woken.is_empty() {
                self.parser.parse(&[], false);
                may_be_escape = false;
            }
            while let Some(event) = self.parser.pop() {
                if let Some(event) = convert(event)
                    && !(self.send)(event)
                {
                    return;
                }
            }
        }
    }

    /// Reads what is there; false at the end of input.
    fn read(&mut self) -> Result<bool, Errno> {
        let mut bytes = [0; 4096];
        let n = rustix::io::read(self.screen.keyboard(), &mut bytes)?;
        self.parser.parse(&bytes[..n], true);
        Ok(n > 0)
    }

    fn hang_up(mut self) {
        (self.send)(InputEvent::Hangup);
    }
}

/// Waits for the keyboard or the socket and returns what each has to say.
fn wait(screen: &Screen, woken: &UnixStream, timeout: Option<Duration>) -> Result<(PollFlags, PollFlags), Errno> {
    let mut fds = [
        PollFd::from_borrowed_fd(screen.keyboard(), PollFlags::IN),
        PollFd::from_borrowed_fd(woken.as_fd(), PollFlags::IN),
    ];
    let timeout = timeout.map(|t| Timespec { tv_sec: 0, tv_nsec: t.subsec_nanos().into() });
    rustix::event::poll(&mut fds, timeout.as_ref())?;
    Ok((fds[0].revents(), fds[1].revents()))
}

fn drain(socket: &mut UnixStream) {
    let mut bytes = [0; 64];
    while socket.read(&mut bytes).is_ok_and(|n| n > 0) {}
}

/// Converts what the parser found; none for releases, lone modifiers, mouse reports and answers nobody asked for.
fn convert(event: termina::Event) -> Option<InputEvent> {
    match event {
        termina::Event::Key(key) if key.kind != KeyEventKind::Release => {
            let back_tab = key.code == KeyCode::BackTab;
            let held = |modifier| key.modifiers.contains(modifier);
            let shift = back_tab || held(Modifiers::SHIFT);
            Some(InputEvent::Key(Key::new(code(key.code)?, held(Modifiers::CONTROL), held(Modifiers::ALT), shift)))
        }
        termina::Event::Paste(text) => Some(InputEvent::Paste(text)),
        _ => None,
    }
}

fn code(code: KeyCode) -> Option<Code> {
    Some(match code {
        KeyCode::Char(c) if c.is_control() => return None,
        KeyCode::Char(c) => Code::Char(c),
        KeyCode::Enter => Code::Enter,
        KeyCode::Escape => Code::Esc,
        KeyCode::Tab | KeyCode::BackTab => Code::Tab,
        KeyCode::Backspace => Code::Backspace,
        KeyCode::Delete => Code::Delete,
        KeyCode::Insert => Code::Insert,
        KeyCode::Left => Code::Left,
        KeyCode::Right => Code::Right,
        KeyCode::Up => Code::Up,
        KeyCode::Down => Code::Down,
        KeyCode::Home => Code::Home,
        KeyCode::End => Code::End,
        KeyCode::PageUp => Code::PageUp,
        KeyCode::PageDown => Code::PageDown,
        KeyCode::Function(n @ 1..=12) => Code::F(n),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Feeds bytes as one read followed by silence and returns the keys' texts and the pastes.
    fn typed(bytes: &[u8]) -> Vec<String> {
        let mut parser = termina::Parser::default();
        parser.parse(bytes, true);
        parser.parse(&[], false);
        std::iter::from_fn(|| parser.pop())
            .filter_map(convert)
            .map(|event| match event {
                InputEvent::Key(key) => key.to_string(),
                other => format!("{other:?}"),
            })
            .collect()
    }

    #[test]
    fn bytes_become_keys() {
        for (bytes, keys) in [
            (&b"jJ+"[..], &["j", "J", "+"][..]),
            ("é<".as_bytes(), &["é", "<lt>"]),
            (b"\t\x1b[Z", &["<tab>", "<s-tab>"]),
            (b"\r\x7f\x1b", &["<enter>", "<backspace>", "<esc>"]),
            (b"\x03\x1a", &["<c-c>", "<c-z>"]),
            (b"\x1bx\x1bX", &["<a-x>", "<a-X>"]),
            (b"\x1b[A\x1bOB\x1b[1;2C\x1b[1;5D", &["<up>", "<down>", "<s-right>", "<c-left>"]),
            (
                b"\x1b[5~\x1b[6~\x1b[3~\x1b[2~\x1b[H\x1b[F",
                &["<pageup>", "<pagedown>", "<delete>", "<insert>", "<home>", "<end>"],
            ),
            (b"\x1bOP\x1b[24~", &["<f1>", "<f12>"]),
            (b"\x1b[200~q j\n\x1b[201~q", &["Paste(\"q j\\n\")", "q"]),
            // A mouse report, a focus report and an answer about the terminal are no keys.
            (b"\x1b[<0;3;4M\x1b[I\x1b[?1;2cz", &["z"]),
            // kitty's release of `a` is no key; its repeat is.
            (b"\x1b[97;1:3u\x1b[97;1:2u", &["a"]),
        ] {
            assert_eq!(typed(bytes), keys, "{}", bytes.escape_ascii());
        }
    }

    #[test]
    fn a_sequence_in_two_reads_is_one_key() {
        let mut parser = termina::Parser::default();
        parser.parse(b"\x1b", true);
        assert_eq!(parser.pop(), None);
        parser.parse(b"[A", true);
        assert_eq!(parser.pop().and_then(convert), Some(InputEvent::Key(Key::plain(Code::Up))));
    }

    #[test]
    fn no_bytes_panic() {
        let mut state = 1_u64;
        let mut random = move || {
            // Knuth's MMIX generator: a seeded stream is all that is needed here.
            state = state.wrapping_mul(6_364_136_223_846_793_005).wrapping_add(1_442_695_040_888_963_407);
            (state >> 33) as usize
        };
        let alphabet = b"\x1b\x1b\x1b[[[]OP<>?;;:0123456789~uMRcnyqAZ\x00\x07\x7f\\\xc3\xa9\xff\xf0a";
        for _ in 0..20_000 {
            let bytes: Vec<u8> = (0..random() % 12).map(|_| alphabet[random() % alphabet.len()]).collect();
            typed(&bytes);
        }
    }
}
