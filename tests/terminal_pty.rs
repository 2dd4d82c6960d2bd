//! The terminal layer in a real terminal: a pseudo-terminal that is read, resized, signalled and closed.
//!
//! This executable starts itself again inside the pseudo-terminal as the *guest*: the terminal layer around a trivial
//! screen, with keys to make it panic, hang or flood. Whatever ends the guest, the terminal must come back as it was.

mod pty;

use std::{
    panic::{AssertUnwindSafe, catch_unwind},
    process::{Command, ExitCode, Stdio},
    sync::{atomic::Ordering, mpsc},
    thread,
    time::{Duration, Instant},
};

use portable_pty::CommandBuilder;
use pty::{Host, PATIENCE, assert_ends_within_two_seconds};
use ratatui::widgets::Paragraph;
use rustix::process::Signal;
use walkabout::{
    app::signals::{self, SignalEvent},
    tui::{InputEvent, InputThread, Screen, Terminal, leave_on_panic},
};

/// Set in the guest's environment: what it leaves out, or `all`.
const GUEST: &str = "WALKABOUT_TERMINAL_GUEST";

fn main() -> ExitCode {
    if let Ok(mode) = std::env::var(GUEST) {
        return guest(&mode);
    }
    let filters: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    let tests: &[(&str, fn())] = &[
        ("the_screen_is_taken_and_given_back", the_screen_is_taken_and_given_back),
        ("keys_and_pastes_arrive", keys_and_pastes_arrive),
        ("many_keys_at_once_arrive", many_keys_at_once_arrive),
        ("resizing_redraws", resizing_redraws),
        ("a_key_right_after_a_resize_arrives", a_key_right_after_a_resize_arrives),
        ("a_panic_restores_before_its_message", a_panic_restores_before_its_message),
        ("a_panic_in_another_thread_restores", a_panic_in_another_thread_restores),
        ("signals_restore", signals_restore),
        ("a_hanging_loop_is_ended", a_hanging_loop_is_ended),
        ("a_second_signal_ends_at_once", a_second_signal_ends_at_once),
        ("a_terminal_nobody_reads_is_left", a_terminal_nobody_reads_is_left),
        ("a_closed_terminal_ends_the_guest", a_closed_terminal_ends_the_guest),
        ("a_closed_terminal_ends_the_guest_that_hears_no_signals", a_closed_terminal_ends_the_deaf_guest),
        ("ctrl_z_suspends_and_fg_resumes", ctrl_z_suspends_and_fg_resumes),
        ("a_suspended_guest_can_be_killed", a_suspended_guest_can_be_killed),
        ("without_a_shell_ctrl_z_does_nothing", without_a_shell_ctrl_z_does_nothing),
        ("a_stop_from_outside_resumes", a_stop_from_outside_resumes),
        ("a_pipe_is_refused", a_pipe_is_refused),
    ];
    let (mut n_passed, mut n_failed) = (0, 0);
    for (name, test) in tests.iter().filter(|(name, _)| filters.is_empty() || filters.iter().any(|f| name.contains(f)))
    {
        let passed = catch_unwind(AssertUnwindSafe(test)).is_ok();
        println!("test {name} ... {}", if passed { "ok" } else { "FAILED" });
        if passed {
            n_passed += 1;
        } else {
            n_failed += 1;
        }
    }
    // As cargo's own test programs say it, for those who count results.
    let word = if n_failed == 0 { "ok" } else { "FAILED" };
    let n_left_out = tests.len() - n_passed - n_failed;
    println!("\ntest result: {word}. {n_passed} passed; {n_failed} failed; {n_left_out} filtered out");
    if n_failed == 0 { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}

// The guest: runs inside the pseudo-terminal.

enum Event {
    Input(InputEvent),
    Signal(SignalEvent),
    Panicked,
}

/// Runs the terminal layer as the editor does: one loop, one list of what can wake it.
fn guest(mode: &str) -> ExitCode {
    let screen = match Screen::open() {
        Ok(screen) => screen,
        Err(error) => {
            eprintln!("guest: {error}");
            return ExitCode::FAILURE;
        }
    };
    let (sender, events) = mpsc::channel();
    leave_on_panic(screen.clone(), {
        let sender = sender.clone();
        move || drop(sender.send(Event::Panicked))
    });
    if mode != "deaf" {
        let sender = sender.clone();
        signals::watch(screen.clone(), move |event| drop(sender.send(Event::Signal(event)))).expect("signals");
    }
    let mut terminal = Terminal::take(screen.clone()).expect("terminal");
    let _input = InputThread::start(screen, move |event| sender.send(Event::Input(event)).is_ok()).expect("input");
    let mut heard = String::from("ready");
    let mut n_heard = 0;
    loop {
        let text = format!("{heard} #{n_heard}");
        let drawn = terminal.draw(|frame| {
            let line = format!("guest {}x{} {text}", frame.area().width, frame.area().height);
            frame.render_widget(line.as_str(), frame.area());
        });
        if drawn.is_err() {
            return ExitCode::from(129);
        }
        n_heard += 1;
        match events.recv().expect("the input thread holds a sender") {
            Event::Input(InputEvent::Key(key)) => {
                heard = key.to_string();
                match heard.as_str() {
                    "q" => return ExitCode::SUCCESS,
                    "p" => panic!("the guest panics"),
                    "t" => drop(thread::spawn(|| panic!("a thread of the guest panics"))),
                    "h" => thread::sleep(Duration::from_secs(3600)),
                    "f" => flood(&mut terminal),
                    "<c-z>" => drop(signals::suspend(terminal.screen())),
                    _ => {}
                }
            }
            Event::Input(InputEvent::Paste(text)) => heard = format!("{text:?}"),
            Event::Input(InputEvent::Resize(width, height)) => heard = format!("resize {width}x{height}"),
            Event::Input(InputEvent::Hangup) => return ExitCode::from(129),
            Event::Signal(SignalEvent::Terminate { exit_code }) => return ExitCode::from(exit_code),
            Event::Signal(SignalEvent::Suspend) => drop(signals::suspend(terminal.screen())),
            Event::Signal(SignalEvent::Resume) => {
                heard = "resumed".to_owned();
                if signals::resume(&mut terminal).is_err() {
                    return ExitCode::from(129);
                }
            }
            Event::Panicked => return ExitCode::from(101),
        }
    }
}

/// Draws without end, until the terminal takes no more.
fn flood(terminal: &mut Terminal) {
    for c in ('a'..='z').cycle() {
        let drawn = terminal.draw(|frame| {
            let line = c.to_string().repeat(usize::from(frame.area().width));
            let lines = vec![line; usize::from(frame.area().height)].join("\n");
            frame.render_widget(Paragraph::new(lines), frame.area());
        });
        if drawn.is_err() {
            return;
        }
    }
}

// The host: looks at the guest from outside.

const SIZE: (u16, u16) = (80, 24);

fn start() -> Host {
    Host::start(&guest_command("all"), SIZE)
}

fn guest_command(mode: &str) -> CommandBuilder {
    let mut command = CommandBuilder::new(std::env::current_exe().expect("this program"));
    command.env(GUEST, mode);
    command
}

fn find(bytes: &[u8], what: &[u8]) -> Option<usize> {
    bytes.windows(what.len()).position(|w| w == what)
}

fn the_screen_is_taken_and_given_back() {
    let mut host = start();
    host.await_text("guest 80x24 ready");
    host.assert_taken();
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
    host.assert_given_back();
    assert_eq!(host.contents().trim(), "");
}

fn keys_and_pastes_arrive() {
    let mut host = start();
    host.await_text("ready");
    for (bytes, text) in [
        (&b"j"[..], "j #1"),
        (b"\x1b", "<esc> #2"),
        (b"\x1b[1;2D", "<s-left> #3"),
        (b"\x03", "<c-c> #4"),
        (b"\x1b[200~q\x1b[201~", "\"q\" #5"),
    ] {
        host.send(bytes);
        host.await_text(text);
    }
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
}

fn many_keys_at_once_arrive() {
    let mut host = start();
    host.await_text("ready");
    host.send(&[b'j'; 3000]);
    host.await_text("j #3000");
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
}

fn resizing_redraws() {
    let mut host = start();
    host.await_text("80x24");
    for (cols, rows) in [(100, 30), (40, 12), (1, 1), (200, 60)] {
        host.resize((cols, rows));
        if cols > 20 {
            host.await_text(&format!("guest {cols}x{rows} resize {cols}x{rows}"));
        }
    }
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
}

fn a_key_right_after_a_resize_arrives() {
    let mut host = start();
    host.await_text("ready");
    for i in 1..=20 {
        host.resize((80 + i, 24));
        host.send(b"j");
        host.await_text(&format!("#{}", 2 * i));
    }
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
}

fn a_panic_restores_before_its_message() {
    let mut host = start();
    host.await_text("ready");
    host.send(b"p");
    assert_eq!(host.await_end().0, 101);
    host.assert_given_back();
    host.await_text("the guest panics");
    let bytes = host.bytes();
    assert!(find(&bytes, b"\x1b[?1049l") < find(&bytes, b"the guest panics"));
}

fn a_panic_in_another_thread_restores() {
    let mut host = start();
    host.await_text("ready");
    host.send(b"t");
    assert_eq!(host.await_end().0, 101);
    host.assert_given_back();
    host.await_text("a thread of the guest panics");
}

fn signals_restore() {
    for (signal, status) in [(Signal::INT, 130), (Signal::TERM, 143), (Signal::HUP, 129)] {
        let mut host = start();
        host.await_text("ready");
        host.signal(signal);
        assert_eq!(host.await_end().0, status);
        host.assert_given_back();
    }
}

fn a_hanging_loop_is_ended() {
    let mut host = start();
    host.await_text("ready");
    host.send(b"h");
    thread::sleep(Duration::from_millis(100));
    host.signal(Signal::TERM);
    let (status, took) = host.await_end();
    assert_eq!(status, 143);
    assert!(took > Duration::from_millis(500), "it had its grace: {took:?}");
    host.assert_given_back();
}

fn a_second_signal_ends_at_once() {
    let mut host = start();
    host.await_text("ready");
    host.send(b"h");
    thread::sleep(Duration::from_millis(100));
    host.signal(Signal::TERM);
    thread::sleep(Duration::from_millis(100));
    host.signal(Signal::INT);
    let (status, took) = host.await_end();
    // The status tells which of the two ended it: the grace period would have ended it with 143.
    assert_eq!(status, 130, "after {took:?}");
    host.assert_given_back();
}

fn a_terminal_nobody_reads_is_left() {
    let mut host = start();
    host.await_text("ready");
    host.reading.store(false, Ordering::SeqCst);
    host.send(b"f");
    thread::sleep(Duration::from_millis(300));
    host.signal(Signal::TERM);
    let (status, took) = host.await_end();
    assert_eq!(status, 143);
    assert!(took < Duration::from_secs(3), "{took:?}");
    // Nobody reads, so only the settings can have come back.
    host.assert_settings_given_back();
}

fn a_closed_terminal_ends_the_guest() {
    let host = start();
    host.await_text("ready");
    assert_ends_within_two_seconds(host.close());
}

fn a_closed_terminal_ends_the_deaf_guest() {
    let exe = std::env::current_exe().expect("this program");
    let mut command = CommandBuilder::new("sh");
    command.args(["-c", "trap '' HUP; exec \"$0\""]);
    command.arg(exe);
    command.env(GUEST, "deaf");
    let host = Host::start(&command, SIZE);
    host.await_text("ready");
    assert_ends_within_two_seconds(host.close());
}

/// Starts a shell with job control and the guest as its job.
fn guest_under_a_shell() -> Host {
    let exe = std::env::current_exe().expect("this program");
    let mut host = Host::shell(&[("GUEST_EXE", exe.as_os_str())], SIZE);
    host.send(format!("{GUEST}=all \"$GUEST_EXE\"\n").as_bytes());
    host.await_text("guest 80x24 ready");
    host
}

fn ctrl_z_suspends_and_fg_resumes() {
    let mut host = guest_under_a_shell();
    host.send(b"\x1a");
    // The shell's own line discipline may differ from the one found, so only the screen is looked at here.
    host.await_text("Stopped");
    assert!(!host.on_screen(vt100::Screen::alternate_screen));
    assert!(!host.on_screen(vt100::Screen::hide_cursor));
    host.send(b"echo shell is $((40 + 2))\n");
    host.await_text("shell is 42");
    host.send(b"fg\n");
    host.await_text("resumed");
    host.assert_taken();
    host.send(b"j");
    host.await_text("j #");
    host.send(b"q");
    host.await_text("shell is 42");
    host.send(b"exit\n");
    host.await_end();
    host.assert_given_back();
}

fn a_suspended_guest_can_be_killed() {
    let mut host = guest_under_a_shell();
    host.send(b"\x1a");
    host.await_text("Stopped");
    // As bash's own `kill` does with a stopped job; other shells leave the second signal to the user.
    host.send(b"kill %1; kill -CONT %1\n");
    let waited = Instant::now();
    while !host.contents().contains("143") {
        assert!(waited.elapsed() < PATIENCE, "it did not end; the screen shows:\n{}", host.contents());
        host.send(b"jobs\n");
        thread::sleep(Duration::from_millis(100));
    }
    assert!(!host.on_screen(vt100::Screen::alternate_screen));
    host.send(b"exit\n");
    host.await_end();
}

fn without_a_shell_ctrl_z_does_nothing() {
    let mut host = start();
    host.await_text("ready");
    host.send(b"\x1a");
    host.await_text("<c-z> #1");
    host.assert_taken();
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
}

fn a_stop_from_outside_resumes() {
    let mut host = start();
    host.await_text("ready");
    host.signal(Signal::STOP);
    thread::sleep(Duration::from_millis(100));
    host.signal(Signal::CONT);
    host.await_text("resumed #1");
    host.assert_taken();
    host.send(b"q");
    assert_eq!(host.await_end().0, 0);
    host.assert_given_back();
}

fn a_pipe_is_refused() {
    let exe = std::env::current_exe().expect("this program");
    let output = Command::new(exe).env(GUEST, "all").stdin(Stdio::null()).output().expect("the guest starts");
    assert_eq!(output.status.code(), Some(1));
    assert_eq!(String::from_utf8_lossy(&output.stderr), "guest: standard output is not a terminal\n");
    assert!(output.stdout.is_empty());
}
