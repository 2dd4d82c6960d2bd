//! Two windows on one document, on a real X server: both follow edits, each has views of its own, either closes alone.
//!
//! Without Xvfb or a Vulkan driver the test is skipped with a loud line, and fails where the variable `CI` is set.
#![cfg(target_os = "linux")]

#[path = "pty/children.rs"]
mod children;
#[path = "window/desktop.rs"]
#[allow(dead_code, reason = "the test of one window uses the rest")]
mod desktop;
#[allow(dead_code, reason = "the tests of the terminal use the rest")]
mod pty;

use std::{thread, time::Duration};

use children::{await_gone, previews_of};
use desktop::{Desktop, X11Window};
use portable_pty::CommandBuilder;
use pty::Host;
use rustix::process::{Signal, kill_process};
use walkabout::scene::Picture;

const FIRST: &str = "walkabout";
const SECOND: &str = "walkabout, second window";
/// Of each window, so that both are on the screen side by side.
const SIZE: (u32, u32) = (600, 380);

/// Starts the editor and waits for its window; none when this machine cannot have one.
fn start(desktop: &Desktop) -> Option<Host> {
    let mut command = CommandBuilder::new(env!("CARGO_BIN_EXE_walkabout"));
    for name in ["WAYLAND_DISPLAY", "WAYLAND_SOCKET", "SSH_CONNECTION"] {
        command.env_remove(name);
    }
    command.env("DISPLAY", desktop.display());
    command.env("TERM", "xterm-256color");
    let host = Host::start(&command, (280, 40));
    let title = |screen: &vt100::Screen| screen.contents().lines().next().unwrap_or_default().to_owned();
    host.await_that("a window, or why there is none", |screen| {
        let title = title(screen);
        title.contains("window") && !title.contains("window: opening")
            || title.contains("Vulkan")
            || title.contains("preview")
    });
    let title = host.on_screen(title);
    if title.contains("window: ") {
        return Some(host);
    }
    assert!(std::env::var_os("CI").is_none(), "no window on this machine: {title}");
    eprintln!("\n*** SKIPPED: no window on this machine: {title} ***\n");
    None
}

/// Finds a window and puts it where no other covers it.
fn find<'a>(desktop: &'a Desktop, title: &str) -> X11Window<'a> {
    let window = desktop.window_named(title);
    window.resize(SIZE.0, SIZE.1);
    window.place(if title == FIRST { 0 } else { 640 }, 0);
    window
}

/// Counts the views of a picture by the dark gaps between them; none when it has not the window's size yet.
fn n_views(picture: &Picture) -> Option<usize> {
    let (width, height) = SIZE;
    if (picture.width, picture.height) != SIZE {
        return None;
    }
    let is_dark = |(x, y): (u32, u32)| picture.rgb[(y * width + x) as usize * 3..][..3].iter().all(|c| *c <= 11);
    // Texts may lie across a gap.
    let is_gap = |pixels: Vec<(u32, u32)>| 10 * pixels.iter().filter(|p| is_dark(**p)).count() > 8 * pixels.len();
    let column = is_gap((20..height / 2 - 20).map(|y| (width / 2 - 1, y)).collect());
    let row = is_gap((20..width / 2 - 20).map(|x| (x, height / 2 - 1)).collect());
    Some(match (column, row) {
        (true, true) => 4,
        (true, false) => 2,
        _ => 1,
    })
}

fn await_views(window: &X11Window<'_>, n: usize) -> Picture {
    window.eventually(&format!("has {n} views"), |picture| n_views(picture) == Some(n));
    settled(window)
}

/// Waits until a window has stopped changing, and returns what it shows.
fn settled(window: &X11Window<'_>) -> Picture {
    let mut before = None;
    loop {
        match window.screenshot() {
            Some(picture) if before.as_ref() == Some(&picture) => return picture,
            now => before = now,
        }
        thread::sleep(Duration::from_millis(300));
    }
}

/// Waits until the status line names the view and its camera, in the state or, after a camera key, in the message.
fn await_state(host: &Host, state: &str) {
    let (in_state, in_message) = (format!("  {state}  frame "), format!("{state} "));
    host.await_that(state, |screen| {
        screen.contents().lines().any(|line| line.contains(&in_state) || line.starts_with(&in_message))
    });
}

#[test]
fn two_windows_follow_one_document_and_close_alone() {
    let desktop = match Desktop::start() {
        Ok(desktop) => desktop,
        Err(why) => {
            assert!(std::env::var_os("CI").is_none(), "{why}");
            eprintln!("\n*** SKIPPED: {why} ***\n");
            return;
        }
    };
    let Some(mut host) = start(&desktop) else { return };
    let first = find(&desktop, FIRST);
    await_views(&first, 1);
    host.send(b"Vw");
    let second = find(&desktop, SECOND);
    await_views(&second, 1);
    await_state(&host, "second window camera 1");

    // A key pressed in a window acts on its views, one typed in the terminal on those of the window used last.
    second.focus();
    second.press(&["Shift_L", "v"]);
    second.press(&["2"]);
    await_views(&second, 2);
    host.await_text("2 views (second.layout)");
    host.send(b"V43");
    let in_second = await_views(&second, 4);
    await_state(&host, "second window view 1 camera 3");
    let in_first = await_views(&first, 1);

    // Both follow the playhead and edits.
    for keys in [&b"sc"[..], b"."] {
        let seen = [(&first, settled(&first)), (&second, settled(&second))];
        host.send(keys);
        for (window, seen) in seen {
            window.eventually("shows the change", |picture| *picture != seen);
        }
    }
    assert!(settled(&first) != in_first && settled(&second) != in_second);

    // A click chooses the view it is in, and with it the window.
    second.point(450, 280);
    second.button(true);
    second.button(false);
    await_state(&host, "second window view 4 camera 4");
    first.point(100, 100);
    let seen = settled(&first);
    first.wheel(true);
    first.eventually("is zoomed by the wheel", |picture| *picture != seen);
    await_state(&host, "camera 1");

    // Closed by the window manager, the second leaves the first, and comes back as it was.
    let both = previews_of(host.pid());
    assert_eq!(both.len(), 2);
    second.close();
    let left = || previews_of(host.pid());
    while left().len() > 1 {
        thread::sleep(Duration::from_millis(20));
    }
    let seen = settled(&first);
    host.send(b",");
    first.eventually("goes on alone", |picture| *picture != seen);
    host.send(b"Vw");
    let second = find(&desktop, SECOND);
    await_views(&second, 4);

    // The first closes from the terminal, and the second is used.
    first.focus();
    first.press(&["1"]);
    await_state(&host, "camera 1");
    host.send(b"w");
    host.await_text("second window open; w opens the first");
    await_state(&host, "second window view 4 camera 4");
    let seen = settled(&second);
    host.send(b".");
    second.eventually("goes on alone", |picture| *picture != seen);

    // A crash takes one window and no more.
    let [preview] = previews_of(host.pid())[..] else { panic!("one preview is left") };
    kill_process(preview, Signal::KILL).expect("it runs");
    host.await_text("the preview ended with signal 9");
    host.send(b".");
    await_state(&host, "camera 1");
    host.send(b"wVw");
    let (_, second) = (find(&desktop, FIRST), find(&desktop, SECOND));
    await_views(&second, 4);

    // A window closes itself by key; leaving takes all that are open along.
    second.focus();
    second.press(&["w"]);
    await_state(&host, "camera 1");
    host.send(b"Vw");
    let second = find(&desktop, SECOND);
    await_views(&second, 4);
    let both = previews_of(host.pid());
    assert_eq!(both.len(), 2);
    host.send(b"qy");
    assert_eq!(host.await_end().0, 0);
    host.assert_given_back();
    both.into_iter().for_each(await_gone);
}
