//! The previews of an editor as the system sees them: which run, and when they are gone.

use std::{
    fs, thread,
    time::{Duration, Instant},
};

use rustix::process::Pid;

use crate::pty::PATIENCE;

/// Returns the previews that a process has started and not reaped.
pub(crate) fn previews_of(parent: Pid) -> Vec<Pid> {
    let processes = fs::read_dir("/proc").expect("the list of processes").filter_map(|entry| {
        let pid: i32 = entry.ok()?.file_name().to_str()?.parse().ok()?;
        let (_, its_parent) = state_and_parent(pid)?;
        (its_parent == parent.as_raw_nonzero().get()).then(|| Pid::from_raw(pid))?
    });
    processes.collect()
}

fn state_and_parent(pid: i32) -> Option<(String, i32)> {
    let stat = fs::read_to_string(format!("/proc/{pid}/stat")).ok()?;
    // The name in parentheses may hold anything.
    let mut words = stat.rsplit_once(')')?.1.split_whitespace();
    Some((words.next()?.to_owned(), words.next()?.parse().ok()?))
}

/// Waits until a process runs no more; whether anybody has reaped it is not ours to say.
pub(crate) fn await_gone(pid: Pid) {
    let waited = Instant::now();
    while state_and_parent(pid.as_raw_nonzero().get()).is_some_and(|(state, _)| state != "Z") {
        assert!(waited.elapsed() < PATIENCE, "process {pid:?} stays");
        thread::sleep(Duration::from_millis(5));
    }
}
