//! The real preview process of the built binary: on a Vulkan driver without a window, and with one under Xvfb.
//!
//! Where a driver or Xvfb is missing these tests say loudly that they were skipped; with `CI` set they fail.

mod link_sample;

use std::{
    env,
    ffi::OsString,
    io::{BufRead, BufReader},
    process::{Child, Command, Stdio},
    sync::mpsc::{self, Receiver},
    time::{Duration, Instant},
};

use link_sample::scene;
use walkabout::{
    app::preview::{Preview, PreviewProgram},
    scene::{FromPreview, Picture},
};

/// Long enough for a driver's first frame on a busy machine; reached only when a test fails.
const LONG: Duration = Duration::from_secs(60);

const BINARY: &str = env!("CARGO_BIN_EXE_walkabout");

struct Real {
    preview: Preview,
    events: Receiver<FromPreview>,
}

impl Real {
    fn start(program: &PreviewProgram) -> Self {
        let (sender, events) = mpsc::channel();
        let preview = Preview::start(program, move |event| drop(sender.send(event))).expect("the binary is built");
        Self { preview, events }
    }

    fn next(&self) -> FromPreview {
        self.events.recv_timeout(LONG).expect("an event comes")
    }

    /// Shows a first scene and waits until the preview draws it; none when this machine cannot have one.
    fn ready(self) -> Option<Self> {
        self.preview.resize(96, 64);
        self.preview.show(scene(1, 0));
        match self.next() {
            FromPreview::Ready { device, driver } => {
                assert!(!device.is_empty() && !driver.is_empty());
                Some(self)
            }
            FromPreview::Failed(why) => {
                skip(&why);
                None
            }
            event => panic!("{event:?} before the preview was ready"),
        }
    }

    /// Waits for a frame of this size.
    fn frame(&self, size: (u32, u32)) -> Picture {
        loop {
            match self.next() {
                FromPreview::Frame(picture) if (picture.width, picture.height) == size => return picture,
                FromPreview::Frame(_) => {}
                event => panic!("{event:?} is no frame"),
            }
        }
    }

    fn last(&self) -> FromPreview {
        loop {
            if let event @ (FromPreview::Closed | FromPreview::Failed(_)) = self.next() {
                assert!(!self.preview.is_running());
                assert!(self.events.recv_timeout(LONG).is_err(), "nothing comes after the last event");
                return event;
            }
        }
    }
}

fn skip(why: &str) {
    assert!(env::var_os("CI").is_none(), "no preview on this machine: {why}");
    eprintln!("\n*** SKIPPED: no preview on this machine: {why} ***\n");
}

fn headless() -> PreviewProgram {
    PreviewProgram { program: BINARY.into(), args: vec!["preview".into(), "--headless".into()] }
}

/// A preview with a window on that X display, whatever display the tests run on.
fn window_on(display: &str) -> PreviewProgram {
    let display = format!("DISPLAY={display}");
    let words = ["-u", "WAYLAND_DISPLAY", "-u", "WAYLAND_SOCKET", &display, BINARY, "preview"];
    PreviewProgram { program: "/usr/bin/env".into(), args: words.map(OsString::from).to_vec() }
}

/// An X server without a screen, gone with this value.
struct Xvfb {
    server: Child,
    display: String,
}

impl Xvfb {
    fn start() -> Option<Self> {
        let args = ["-displayfd", "1", "-screen", "0", "1280x800x24", "-nolisten", "tcp"];
        let server = Command::new("Xvfb").args(args).stdout(Stdio::piped()).stderr(Stdio::null()).spawn();
        let mut server = server.map_err(|e| skip(&format!("Xvfb does not start: {e}"))).ok()?;
        let mut number = String::new();
        BufReader::new(server.stdout.take().expect("piped")).read_line(&mut number).expect("Xvfb names its display");
        Some(Self { server, display: format!(":{}", number.trim()) })
    }
}

impl Drop for Xvfb {
    fn drop(&mut self) {
        let _ = self.server.kill();
        let _ = self.server.wait();
    }
}

#[test]
fn a_headless_preview_sends_frames_and_closes() {
    let Some(real) = Real::start(&headless()).ready() else { return };
    let first = real.frame((96, 64));
    assert!(first.rgb.chunks_exact(3).any(|pixel| pixel != &first.rgb[..3]), "the picture shows something");

    real.preview.show(scene(1, 400));
    let mut later = real.frame((96, 64));
    while later == first {
        later = real.frame((96, 64));
    }
    real.preview.resize(48, 40);
    real.frame((48, 40));

    real.preview.close();
    assert_eq!(real.last(), FromPreview::Closed);
}

#[test]
fn a_preview_ends_when_its_editor_does() {
    // What the system does to a preview when its editor is killed: the pipes end.
    let mut child = Command::new(BINARY)
        .args(["preview", "--headless"])
        .stdin(Stdio::piped())
        .stdout(Stdio::piped())
        .stderr(Stdio::null())
        .spawn()
        .expect("the binary is built");
    drop(child.stdin.take());
    drop(child.stdout.take());
    let start = Instant::now();
    while child.try_wait().expect("ours to wait for").is_none() {
        assert!(start.elapsed() < LONG, "the preview outlives its editor");
        std::thread::sleep(Duration::from_millis(5));
    }
}

#[test]
fn a_preview_refuses_foreign_bytes_with_words() {
    let program = format!("(printf 'GET / HTTP/1.1'; cat) | '{BINARY}' preview --headless");
    let real = Real::start(&PreviewProgram { program: "/bin/sh".into(), args: vec!["-c".into(), program.into()] });
    let FromPreview::Failed(text) = real.last() else { panic!("foreign bytes were taken") };
    if !text.contains("is not walkabout") {
        skip(&text);
    }
}

#[test]
fn a_window_opens_and_closes_and_outlives_nothing() {
    let Some(xvfb) = Xvfb::start() else { return };
    let Some(real) = Real::start(&window_on(&xvfb.display)).ready() else { return };
    for frame in 1..5 {
        real.preview.show(scene(1, frame));
    }
    real.preview.close();
    assert_eq!(real.last(), FromPreview::Closed);
}

#[test]
fn a_vanished_x_server_takes_the_window_but_not_the_editor() {
    let Some(xvfb) = Xvfb::start() else { return };
    let program = window_on(&xvfb.display);
    let Some(real) = Real::start(&program).ready() else { return };
    drop(xvfb);
    let FromPreview::Failed(text) = real.last() else { panic!("the window closed without its display") };
    assert!(!text.is_empty() && !text.contains('\n'), "{text}");

    let again = Real::start(&program);
    again.preview.show(scene(1, 0));
    let FromPreview::Failed(text) = again.last() else { panic!("there is no display to open a window on") };
    assert!(!text.is_empty(), "{text}");
}
