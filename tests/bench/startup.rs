//! How long a user waits: from start to the first terminal frame, and for one rendered picture.
//!
//! Whole processes are timed from outside: the release binary in a pseudo-terminal on a clip of 1,000 frames or more
//! made from the built-in one, and `walkabout render` at 1280×720 on whatever Vulkan driver is there.

use std::{
    io::Read as _,
    path::Path,
    process::Command,
    time::{Duration, Instant},
};

use portable_pty::{CommandBuilder, PtySize, native_pty_system};

const PROGRAM: &str = env!("CARGO_BIN_EXE_walkabout");
const RUNS: usize = 9;
/// Printed by the last line of the editor's first frame.
const LAST_LINE: &[u8] = b"q quit";

fn main() {
    let cores = std::thread::available_parallelism().map_or(1, |n| n.get());
    let folder = tempfile::tempdir().expect("a folder");
    let clip = folder.path().join("long.bvh");
    let made = Command::new(PROGRAM)
        .args(["export", "--shape", "line:2", "--set", "timing.cycling=plain", "-o"])
        .arg(&clip)
        .output()
        .expect("the program starts");
    assert!(made.status.success(), "{}", String::from_utf8_lossy(&made.stderr));
    let text = std::fs::read_to_string(&clip).expect("exported");
    let frames = text.lines().find(|l| l.starts_with("Frames:")).expect("a frame count").to_owned();

    println!("{cores} cores, {RUNS} runs each, whole processes");
    report(&format!("first terminal frame, {frames}"), 100.0, || first_frame(&clip));
    let picture = folder.path().join("out.png");
    report("render 1280x720", 1000.0, || {
        let start = Instant::now();
        let output = Command::new(PROGRAM)
            .args(["render", "--force", "--size", "1280x720", "-o"])
            .arg(&picture)
            .output()
            .expect("the program starts");
        assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
        start.elapsed()
    });
}

/// Prints the best and the median of some runs beside the goal.
fn report(what: &str, goal_ms: f64, run: impl Fn() -> Duration) {
    let mut times: Vec<f64> = (0..RUNS).map(|_| run().as_secs_f64() * 1e3).collect();
    times.sort_by(f64::total_cmp);
    println!("{what:<40} best {:7.1} ms, median {:7.1} ms, goal {goal_ms:.0} ms", times[0], times[RUNS / 2]);
}

/// Starts the editor in a terminal and returns the time until its last line is there.
fn first_frame(clip: &Path) -> Duration {
    let size = PtySize { rows: 40, cols: 160, pixel_width: 0, pixel_height: 0 };
    let pair = native_pty_system().openpty(size).expect("a pseudo-terminal");
    let mut command = CommandBuilder::new(PROGRAM);
    command.arg(clip);
    command.env("TERM", "xterm-256color");
    command.env_remove("DISPLAY");
    command.env_remove("WAYLAND_DISPLAY");
    let start = Instant::now();
    let mut child = pair.slave.spawn_command(command).expect("the program starts");
    let mut reader = pair.master.try_clone_reader().expect("a reader");
    let mut seen = Vec::new();
    let mut chunk = [0; 65536];
    while !seen.windows(LAST_LINE.len()).any(|w| w == LAST_LINE) {
        let n = reader.read(&mut chunk).expect("the editor draws");
        assert!(n > 0, "the editor ended: {}", String::from_utf8_lossy(&seen));
        seen.extend_from_slice(&chunk[..n]);
    }
    let elapsed = start.elapsed();
    child.kill().expect("the editor runs");
    child.wait().expect("the editor ends");
    elapsed
}
