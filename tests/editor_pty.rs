//! The whole program in a real terminal: what a user types, what the terminal shows, how everything ends.
//!
//! No test here has a display, so no window opens. Tests of the picture in the terminal need a Vulkan driver; without one
//! they are skipped with a loud line, and fail where `CI` is set or `VK_DRIVER_FILES` names a driver.

#[path = "pty/children.rs"]
mod children;
mod pty;

use std::{
    collections::HashSet,
    env, fs,
    path::Path,
    thread,
    time::{Duration, Instant},
};

use children::{await_gone, previews_of};
use portable_pty::CommandBuilder;
use pty::{Host, PATIENCE, assert_ends_within_two_seconds};
use rustix::process::{Signal, kill_process};
use vt100::Color;

const BINARY: &str = env!("CARGO_BIN_EXE_walkabout");
const SIZE: (u16, u16) = (120, 40);

/// What would change how the editor looks or bring a window.
const UNSET: [&str; 6] = ["DISPLAY", "WAYLAND_DISPLAY", "WAYLAND_SOCKET", "SSH_CONNECTION", "NO_COLOR", "COLORTERM"];

fn editor() -> CommandBuilder {
    let mut command = CommandBuilder::new(BINARY);
    for name in UNSET {
        command.env_remove(name);
    }
    command.env("TERM", "xterm-256color");
    command
}

/// Starts the editor on the built-in clip and waits for its first screen.
fn start(command: &CommandBuilder) -> Host {
    let host = Host::start(command, SIZE);
    host.await_text("‖ paused");
    host
}

/// Starts the editor and opens the picture in the terminal; none on a machine where nothing draws it.
fn with_picture() -> Option<Host> {
    let mut host = start(&editor());
    host.send(b"b");
    host.await_that("a picture, or why there is none", |screen| half_blocks(screen) > 0 || complaint(screen).is_some());
    let Some(why) = host.on_screen(complaint) else { return Some(host) };
    let is_due = ["CI", "VK_DRIVER_FILES"].into_iter().any(|name| env::var_os(name).is_some());
    assert!(!is_due, "no picture in the terminal: {why}");
    eprintln!("\n*** SKIPPED: no picture in the terminal: {why} ***\n");
    None
}

fn line(screen: &vt100::Screen, row_from_below: usize) -> String {
    let (rows, columns) = screen.size();
    let row = usize::from(rows.get()) - row_from_below;
    screen.rows(0, columns.get()).nth(row).unwrap_or_default()
}

/// Returns the warning in the status line.
fn complaint(screen: &vt100::Screen) -> Option<String> {
    line(screen, 2).strip_prefix("! ").map(str::to_owned)
}

fn half_blocks(screen: &vt100::Screen) -> usize {
    screen.contents().matches('▀').count()
}

/// Counts cells with braille dots, which the plan is drawn with.
fn dotted(screen: &vt100::Screen) -> usize {
    screen.contents().chars().filter(|c| ('\u{2801}'..='\u{28ff}').contains(c)).count()
}

/// Returns the frame that the timeline names.
fn frame(screen: &vt100::Screen) -> Option<usize> {
    let lines = screen.rows(0, screen.size().1.get());
    lines.filter_map(|line| line.strip_prefix("frame ")?.split(" of ").next()?.parse().ok()).next()
}

/// Returns the colours of all cells.
fn colours(screen: &vt100::Screen) -> HashSet<String> {
    let (rows, columns) = screen.size();
    let cells = (0..rows.get()).flat_map(|row| (0..columns.get()).map(move |column| (row, column)));
    let colours = cells.filter_map(|(row, column)| screen.cell(row, column)).flat_map(|c| [c.fgcolor(), c.bgcolor()]);
    colours.filter(|colour| *colour != Color::Default).map(|colour| format!("{colour:?}")).collect()
}

#[track_caller]
fn assert_leaves(mut host: Host, keys: &[u8]) {
    host.send(keys);
    assert_eq!(host.await_end().0, 0);
    host.assert_given_back();
}

#[test]
fn it_opens_without_a_display_and_says_why_there_is_no_window() {
    let host = start(&editor());
    host.assert_taken();
    host.on_screen(|screen| {
        let title = line(screen, 40);
        assert!(title.starts_with("walkabout · "), "{title}");
        assert!(title.contains("no window: there is no display"), "{title}");
        assert!(screen.contents().contains("[path]"), "{}", screen.contents());
        assert!(dotted(screen) > 20, "{}", screen.contents());
        assert_eq!(frame(screen), Some(0));
    });
    assert_leaves(host, b"q");
}

#[test]
fn a_circle_is_walked_and_left_unsaved_only_after_a_question() {
    let mut host = start(&editor());
    assert!(!host.contents().contains("point 9"));
    host.send(b"s");
    host.await_text("A figure eight.");
    host.send(b"c");
    host.await_text("unsaved");
    host.await_text("point 9");
    host.send(b" ");
    host.await_that("a later frame", |screen| frame(screen) > Some(2));
    host.send(b" ");
    host.await_text("‖ paused");
    host.send(b"?");
    host.await_text("Play or pause.");
    host.send(b"??");
    host.await_text("Play or pause.");
    host.send(b"?q");
    host.await_text("quit without saving the project? (y/n)");
    assert!(!host.on_screen(vt100::Screen::hide_cursor), "a line is being typed");
    host.send(b"n");
    host.await_text("‖ paused");
    host.assert_taken();
    assert_leaves(host, b"qy");
}

#[test]
fn resizing_lays_the_screen_out_anew() {
    let host = start(&editor());
    for size in [(80, 24), (36, 8), (10, 3), (1, 1), (200, 60), (80, 24)] {
        host.resize(size);
        if size.0 >= 80 {
            host.await_that("the new layout", |screen| {
                line(screen, size.1.into()).starts_with("walkabout") && line(screen, 2).contains("‖ paused")
            });
            host.on_screen(|screen| assert_eq!(frame(screen), Some(0), "{}", screen.contents()));
        }
    }
    assert_leaves(host, b"q");
}

#[test]
fn signals_end_it_while_it_plays() {
    for (signal, status) in [(Signal::TERM, 143), (Signal::HUP, 129), (Signal::INT, 130)] {
        let mut host = start(&editor());
        host.send(b" ");
        host.await_that("a later frame", |screen| frame(screen) > Some(0));
        host.signal(signal);
        assert_eq!(host.await_end().0, status);
        host.assert_given_back();
    }
}

#[test]
fn a_closed_terminal_ends_it_paused_or_playing() {
    for keys in [&b""[..], b" "] {
        let mut host = start(&editor());
        host.send(keys);
        assert_ends_within_two_seconds(host.close());
    }
}

#[test]
fn a_closed_terminal_ends_the_picture_too() {
    let Some(host) = with_picture() else { return };
    let previews = previews_of(host.pid());
    assert_eq!(previews.len(), 1);
    assert_ends_within_two_seconds(host.close());
    await_gone(previews[0]);
}

#[test]
fn ctrl_z_gives_the_terminal_to_the_shell_and_fg_takes_it_back() {
    let mut host = Host::shell(&[("EDITOR_EXE", BINARY.as_ref())], SIZE);
    host.send(format!("unset {}; \"$EDITOR_EXE\"\n", UNSET.join(" ")).as_bytes());
    host.await_text("‖ paused");
    host.send(b".");
    host.await_that("frame 1", |screen| frame(screen) == Some(1));
    host.send(b"\x1a");
    host.await_text("Stopped");
    assert!(!host.on_screen(vt100::Screen::alternate_screen));
    assert!(!host.on_screen(vt100::Screen::hide_cursor));
    host.send(b"fg\n");
    host.await_that("frame 1 again", |screen| screen.alternate_screen() && frame(screen) == Some(1));
    host.assert_taken();
    host.send(b".");
    host.await_that("frame 2", |screen| frame(screen) == Some(2));
    host.send(b"q");
    host.await_that("the shell", |screen| !screen.alternate_screen());
    host.send(b"echo left with $?\n");
    host.await_text("left with 0");
    host.send(b"exit\n");
    host.await_end();
    host.assert_given_back();
}

#[test]
fn colours_are_only_those_the_terminal_has() {
    let mut plain = editor();
    plain.env("NO_COLOR", "1");
    let host = start(&plain);
    assert_eq!(host.on_screen(colours), HashSet::new());
    assert_leaves(host, b"q");

    let mut sixteen = editor();
    sixteen.env("TERM", "xterm-16color");
    let host = start(&sixteen);
    let ansi: HashSet<_> = (0..16).map(|i| format!("{:?}", Color::Idx(i))).collect();
    let used = host.on_screen(colours);
    assert!(used.len() > 2 && used.is_subset(&ansi), "{used:?}");
    assert_leaves(host, b"q");

    let host = start(&editor());
    assert!(!host.on_screen(colours).is_subset(&ansi), "there are 256 colours to choose from");
    assert_leaves(host, b"q");
}

#[test]
fn a_bad_file_is_told_with_its_place_before_the_terminal_is_touched() {
    let folder = tempfile::tempdir().expect("a folder");
    fs::write(folder.path().join("bad.bvh"), "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n}\n").expect("written");
    let mut command = CommandBuilder::new("sh");
    command.args(["-c", "exec \"$0\" bad.bvh 2>stderr", BINARY]);
    command.cwd(folder.path());
    let mut host = Host::start(&command, SIZE);
    assert_eq!(host.await_end().0, 1);
    let told = fs::read_to_string(folder.path().join("stderr")).expect("told");
    assert!(told.contains("bad.bvh:4:12: "), "{told}");
    assert_eq!(told.lines().count(), 1, "{told}");
    assert_eq!(host.bytes(), b"", "nothing is written to the terminal");
    host.assert_given_back();
}

#[test]
fn a_missing_file_is_told_too() {
    let mut command = editor();
    command.arg(Path::new("no such clip.bvh"));
    let mut host = Host::start(&command, SIZE);
    assert_eq!(host.await_end().0, 1);
    host.await_text("no such clip.bvh");
    assert!(!host.bytes().windows(8).any(|bytes| bytes == b"\x1b[?1049h"), "the alternate screen is not entered");
}

#[test]
fn without_a_driver_the_picture_says_why_and_the_plan_stays() {
    let mut command = editor();
    for name in ["VK_DRIVER_FILES", "VK_ICD_FILENAMES"] {
        command.env(name, "/dev/null");
    }
    let mut host = start(&command);
    host.send(b"b");
    host.await_that("why there is no picture", |screen| complaint(screen).is_some());
    assert!(host.on_screen(dotted) > 20, "{}", host.contents());
    assert_leaves(host, b"q");
}

#[test]
fn the_picture_comes_to_the_terminal_once_and_goes() {
    let Some(mut host) = with_picture() else { return };
    // What is read may end in the middle of a picture.
    host.await_that("the whole picture", |screen| half_blocks(screen) > 1000 && colours(screen).len() > 12);
    // A still scene is drawn once: the terminal falls silent.
    let waited = Instant::now();
    let mut before = 0;
    while host.bytes().len() > before {
        assert!(waited.elapsed() < PATIENCE, "the picture is sent again and again");
        before = host.bytes().len();
        thread::sleep(Duration::from_secs(1));
    }
    let previews = previews_of(host.pid());
    host.resize((100, 30));
    host.await_that("a smaller picture", |screen| {
        half_blocks(screen) > 500 && frame(screen) == Some(0) && screen.contents().contains("[path]")
    });
    host.send(b"b");
    host.await_that("the plan", |screen| half_blocks(screen) == 0 && dotted(screen) > 20);
    previews.into_iter().for_each(await_gone);
    assert_leaves(host, b"q");
}

#[test]
fn the_picture_in_the_terminal_has_the_window_s_views() {
    let Some(mut host) = with_picture() else { return };
    // Of two views side by side in 72 cells the gap is the 36th: dark from top to bottom, as nothing beside it is.
    let gap = |screen: &vt100::Screen| {
        let colour = |row, column| screen.cell(row, column).map(|cell| (cell.fgcolor(), cell.bgcolor()));
        let dark = colour(5, 35);
        (5..30).all(|row| colour(row, 35) == dark && colour(row, 34) != dark && colour(row, 36) != dark)
    };
    assert!(!host.on_screen(gap));
    host.send(b"V2");
    host.await_that("two views", gap);
    host.send(b"V1");
    host.await_that("one view", |screen| !gap(screen));
    assert_leaves(host, b"qy");
}

#[test]
fn a_picture_opened_right_after_another_stays() {
    let mut host = start(&editor());
    host.send(b"bbb");
    host.await_that("a picture, or why there is none", |screen| half_blocks(screen) > 0 || complaint(screen).is_some());
    assert_leaves(host, b"q");
}

#[test]
fn the_editor_survives_its_killed_preview() {
    let Some(mut host) = with_picture() else { return };
    for preview in previews_of(host.pid()) {
        kill_process(preview, Signal::KILL).expect("it runs");
    }
    host.await_text("the preview ended with signal 9");
    host.await_that("the plan", |screen| half_blocks(screen) == 0 && dotted(screen) > 20);
    host.send(b".");
    host.await_that("frame 1", |screen| frame(screen) == Some(1));
    host.send(b"b");
    host.await_that("another picture", |screen| half_blocks(screen) > 0);
    assert_leaves(host, b"q");
}
