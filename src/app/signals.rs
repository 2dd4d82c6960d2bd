//! Signals as events, and what Ctrl-Z means to a job.
//!
//! A thread waits for signals and sends them to the event loop, which ends or stops the program in its own order. A
//! loop that does not come round in time, or a second request to end, gets no more say: the thread itself gives the
//! terminal back and exits.
//!
//! Stopping is in two halves. [`suspend`] gives the terminal back and stops the whole job, as the terminal's driver
//! would have done; [`resume`] runs when SIGCONT arrives as an event, by which time any signal that ends the program
//! has been seen.

use std::{io, thread, time::Duration};

use rustix::process::{Signal, getpgrp, getsid, kill_current_process_group};
use signal_hook::{
    consts::{SIGCONT, SIGHUP, SIGINT, SIGTERM, SIGTSTP},
    iterator::Signals,
    low_level,
};

use crate::tui::{Screen, Terminal};

/// How long the event loop has to end after the first request.
const GRACE: Duration = Duration::from_millis(800);

/// How long after SIGCONT a signal sent before it may still be on its way.
const SETTLE: Duration = Duration::from_millis(10);

/// What a signal asks for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum SignalEvent {
    /// End with this exit status: SIGINT 130, SIGTERM 143, SIGHUP 129.
    Terminate {
        /// The status a shell expects.
        exit_code: u8,
    },
    /// Stop until continued: SIGTSTP from outside. The key comes as a key.
    Suspend,
    /// The job was continued: SIGCONT.
    Resume,
}

/// Starts the signal thread; `send` is called on it.
///
/// # Errors
///
/// When the system has no socket, signal or thread left.
pub fn watch(screen: Screen, mut send: impl FnMut(SignalEvent) + Send + 'static) -> io::Result<()> {
    let mut signals = Signals::new([SIGINT, SIGTERM, SIGHUP, SIGTSTP, SIGCONT])?;
    thread::Builder::new().name("signals".to_owned()).spawn(move || {
        let mut ending = false;
        loop {
            let mut events: Vec<_> = signals.wait().filter_map(event).collect();
            // A stopped job is killed by SIGTERM and SIGCONT together, which may arrive on two threads: it must neither
            // take the terminal nor stop again first.
            if events.contains(&SignalEvent::Resume) {
                thread::sleep(SETTLE);
                events.extend(signals.pending().filter_map(event));
            }
            events.sort_by_key(|event| !matches!(event, SignalEvent::Terminate { .. }));
            for event in events {
                if let SignalEvent::Terminate { exit_code } = event {
                    if ending {
                        exit(&screen, exit_code);
                    }
                    ending = true;
                    end_after_grace(screen.clone(), exit_code);
                }
                send(event);
            }
        }
    })?;
    Ok(())
}

/// Gives the terminal back and stops this job until it is continued; [`SignalEvent::Resume`] follows. Returns false,
/// and does nothing, when no shell is there to continue it.
pub fn suspend(screen: &Screen) -> bool {
    // A session leader's own group has no shell above it. Stopped, nobody could wake it.
    if getsid(None).is_ok_and(|leader| leader == getpgrp()) {
        return false;
    }
    screen.leave();
    // The whole group, because a parent in it (`cargo run`) is what the shell waits for. SIGSTOP, because our own
    // SIGTSTP handler would only send another event.
    kill_current_process_group(Signal::STOP).is_ok()
}

/// Takes the terminal over again after SIGCONT; continued in the background, stops again rather than touch it.
///
/// # Errors
///
/// When the terminal is gone.
pub fn resume(terminal: &mut Terminal) -> io::Result<()> {
    if terminal.screen().in_foreground() {
        return terminal.resume();
    }
    suspend(terminal.screen());
    Ok(())
}

fn event(signal: i32) -> Option<SignalEvent> {
    match signal {
        SIGINT => Some(SignalEvent::Terminate { exit_code: 130 }),
        SIGTERM => Some(SignalEvent::Terminate { exit_code: 143 }),
        SIGHUP => Some(SignalEvent::Terminate { exit_code: 129 }),
        SIGTSTP => Some(SignalEvent::Suspend),
        SIGCONT => Some(SignalEvent::Resume),
        _ => None,
    }
}

fn end_after_grace(screen: Screen, exit_code: u8) {
    let late = thread::Builder::new().name("grace".to_owned());
    let started = late.spawn({
        let screen = screen.clone();
        move || {
            thread::sleep(GRACE);
            exit(&screen, exit_code);
        }
    });
    // Without a thread to wait in there is no grace.
    if started.is_err() {
        exit(&screen, exit_code);
    }
}

/// Ends the process without running anything else that could hang.
fn exit(screen: &Screen, exit_code: u8) -> ! {
    screen.leave();
    low_level::exit(exit_code.into())
}
