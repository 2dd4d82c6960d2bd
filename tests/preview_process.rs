//! A preview process that misbehaves in every way we could think of, seen from the editor's side.
//!
//! The processes are shell scripts that stand in for a preview; `preview_window.rs` has the real one.

mod link_sample;

use std::{
    fs,
    io::Write as _,
    path::Path,
    sync::{
        Arc,
        mpsc::{self, Receiver},
    },
    time::{Duration, Instant},
};

use glam::DVec3;
use link_sample::{now, scene, still};
use walkabout::{
    app::preview::{Preview, PreviewProgram},
    link::EventWriter,
    scene::{FromPreview, Scene},
};

/// Long enough for a busy machine; reached only when a test fails.
const LONG: Duration = Duration::from_secs(20);

/// A script that stands in for a preview. `$GREETING` is a file with a hello and a `Ready`; `$PID` a file for its number.
struct Fake {
    preview: Preview,
    events: Receiver<FromPreview>,
    directory: tempfile::TempDir,
}

impl Fake {
    fn start(script: &str) -> Self {
        let directory = tempfile::tempdir().expect("a place for the script's files");
        let greeting = directory.path().join("greeting");
        let file = fs::File::create(&greeting).expect("a new file");
        EventWriter::new(file).and_then(|mut w| w.send(&ready()).map_err(std::io::Error::other)).expect("written");
        let pid = directory.path().join("pid");
        let script = format!("GREETING='{}'; echo $$ > '{}'; {script}", greeting.display(), pid.display());
        let program = PreviewProgram { program: "/bin/sh".into(), args: vec!["-c".into(), script.into()] };
        let (sender, events) = mpsc::channel();
        let preview = Preview::start(&program, move |event| drop(sender.send(event))).expect("a shell starts");
        Self { preview, events, directory }
    }

    fn next(&self) -> FromPreview {
        self.events.recv_timeout(LONG).expect("an event comes")
    }

    /// Waits for the last event and makes sure that it is the last and that no process is left.
    fn last(&self) -> FromPreview {
        let last = self.next();
        assert!(!self.preview.is_running());
        assert!(!exists(self.pid()), "a process is left");
        assert!(self.events.recv_timeout(LONG).is_err(), "nothing comes after the last event");
        last
    }

    fn failure(&self) -> String {
        match self.last() {
            FromPreview::Failed(text) => text,
            event => panic!("{event:?} is no failure"),
        }
    }

    fn pid(&self) -> u32 {
        read_pid(&self.directory.path().join("pid"))
    }
}

fn ready() -> FromPreview {
    FromPreview::Ready { device: "none".to_owned(), driver: "none".to_owned() }
}

fn read_pid(file: &Path) -> u32 {
    let start = Instant::now();
    loop {
        if let Some(pid) = fs::read_to_string(file).ok().and_then(|text| text.trim().parse().ok()) {
            return pid;
        }
        assert!(start.elapsed() < LONG, "the script does not start");
        std::thread::sleep(Duration::from_millis(2));
    }
}

/// Tells whether a process is there, be it as a zombie.
fn exists(pid: u32) -> bool {
    Path::new("/proc").join(pid.to_string()).exists()
}

fn kill(pid: u32) {
    let pid = rustix::process::Pid::from_raw(pid as i32).expect("a process number");
    rustix::process::kill_process(pid, rustix::process::Signal::KILL).expect("ours to kill");
}

#[test]
fn a_preview_that_listens_closes_when_asked() {
    let fake = Fake::start("cat \"$GREETING\"; cat >/dev/null");
    assert_eq!(fake.next(), ready());
    fake.preview.show(scene(1, 0));
    assert!(fake.preview.is_running());
    fake.preview.close();
    assert_eq!(fake.last(), FromPreview::Closed);
    fake.preview.show(scene(1, 1));
    fake.preview.close();
}

#[test]
fn dropping_the_handle_leaves_no_process_even_a_stubborn_one() {
    let fake = Fake::start("trap '' TERM INT HUP; cat \"$GREETING\"; while :; do sleep 1; done");
    assert_eq!(fake.next(), ready());
    let pid = fake.pid();
    let start = Instant::now();
    drop(fake.preview);
    assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    assert!(!exists(pid), "a process is left");
    assert_eq!(fake.events.recv_timeout(LONG), Ok(FromPreview::Closed));
    assert!(fake.events.recv_timeout(LONG).is_err());
}

#[test]
fn a_killed_preview_says_by_what_and_another_can_be_started() {
    let fake = Fake::start("cat \"$GREETING\"; exec cat >/dev/null");
    assert_eq!(fake.next(), ready());
    kill(fake.pid());
    let text = fake.failure();
    assert!(text.starts_with("the preview ended with signal 9"), "{text}");

    let another = Fake::start("cat \"$GREETING\"; cat >/dev/null");
    assert_eq!(another.next(), ready());
}

#[test]
fn a_preview_that_dies_at_once_gives_its_last_line() {
    let fake = Fake::start("echo starting >&2; printf 'no \\033[1mdriver\\n' >&2; exit 3");
    assert_eq!(fake.failure(), "the preview ended with exit status 3: no [1mdriver");
}

#[test]
fn a_preview_that_ends_without_a_word_has_failed() {
    assert_eq!(Fake::start("exit 0").failure(), "the preview ended with exit status 0");
}

#[test]
fn a_preview_that_dies_inside_a_message_gives_its_exit_not_the_cut() {
    let fake = Fake::start("head -c 20 \"$GREETING\"; echo out of memory >&2; exit 1");
    assert_eq!(fake.failure(), "the preview ended with exit status 1: out of memory");
}

#[test]
fn garbage_ends_the_preview_with_words() {
    let fake = Fake::start("echo hello world; exec sleep 1000");
    assert_eq!(fake.failure(), "the preview's link is bad: what speaks on the link is not walkabout");
    let fake = Fake::start("cat \"$GREETING\"; head -c 1000 /dev/zero; exec sleep 1000");
    assert_eq!(fake.next(), ready());
    assert_eq!(fake.failure(), "the preview's link is bad: a message of unknown kind 0");
    // What the editor sends, sent back.
    let fake = Fake::start("exec cat");
    fake.preview.show(scene(1, 0));
    assert_eq!(fake.failure(), "the preview's link is bad: a message of unknown kind 1");
}

#[test]
fn complaints_without_end_are_read_and_forgotten() {
    let fake = Fake::start("i=0; while [ $i -lt 20000 ]; do i=$((i+1)); echo complaint $i; done >&2; exit 1");
    assert_eq!(fake.failure(), "the preview ended with exit status 1: complaint 20000");
}

#[test]
fn a_preview_that_never_reads_does_not_hold_the_editor_up() {
    let fake = Fake::start("cat \"$GREETING\"; exec sleep 1000");
    assert_eq!(fake.next(), ready());
    // The still part alone is more than a pipe holds, so the writing thread waits on the first scene.
    let mut still = still(1);
    still.curves[0].points = vec![DVec3::ONE; 100_000];
    let still = Arc::new(still);
    let scenes: Vec<_> = (0..1000).map(|frame| Scene { still: Arc::clone(&still), now: now(frame) }).collect();
    let start = Instant::now();
    for scene in scenes {
        fake.preview.resize(120, 80);
        fake.preview.show(scene);
    }
    let took = start.elapsed();
    assert!(took < Duration::from_secs(1), "1000 scenes took {took:?}");
    fake.preview.close();
    assert_eq!(fake.last(), FromPreview::Closed);
}

#[test]
fn a_scene_too_large_to_send_is_said() {
    let fake = Fake::start("cat \"$GREETING\"; cat >/dev/null");
    assert_eq!(fake.next(), ready());
    let mut large = scene(1, 0);
    large.now.caption = "a".repeat(2 << 20);
    fake.preview.show(large);
    let text = fake.failure();
    assert!(text.starts_with("the preview's link is bad: a now message of 2"), "{text}");
}

#[test]
fn a_program_that_is_not_there_is_an_error_and_no_event() {
    let program = PreviewProgram { program: "/nonexistent/walkabout".into(), args: vec![] };
    let error = Preview::start(&program, |event| panic!("{event:?}")).expect_err("there is no such program");
    assert!(error.to_string().starts_with("cannot start the preview /nonexistent/walkabout: "), "{error}");
}

#[test]
fn what_a_preview_says_last_is_what_the_editor_hears() {
    let directory = tempfile::tempdir().expect("a place");
    let file = directory.path().join("events");
    for last in [FromPreview::Closed, FromPreview::Failed("no Vulkan driver".to_owned())] {
        let mut bytes = Vec::new();
        let mut writer = EventWriter::new(&mut bytes).expect("memory takes everything");
        for event in [&FromPreview::Release, &last, &FromPreview::Release] {
            writer.send(event).expect("sent");
        }
        fs::File::create(&file).and_then(|mut f| f.write_all(&bytes)).expect("written");
        let fake = Fake::start(&format!("cat '{}'; exec sleep 1000", file.display()));
        assert_eq!(fake.next(), FromPreview::Release);
        assert_eq!(fake.last(), last);
    }
}
