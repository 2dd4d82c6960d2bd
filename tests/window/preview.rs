//! The preview under test: this program started again, told what to show on its standard input, line by line, and
//! telling its events on its standard output.

use std::{
    io::{BufRead, BufReader, Write},
    process::{Child, ChildStdin, Command, ExitStatus, Stdio},
    sync::{
        Arc,
        mpsc::{Receiver, RecvTimeoutError, channel},
    },
    thread,
    time::{Duration, Instant},
};

use glam::DVec3;
use walkabout::{
    scene::{Body, Camera, FromPreview, Ground, Limb, Now, Objects, Projection, Role, Scene, Still, View},
    sync::Mailbox,
    viewport::{DeviceChoice, RendererOptions, ValidationLog, headless, window},
};

use crate::desktop::PATIENCE;

/// Says to this program that it is the preview, and which one.
const CHILD: &str = "WALKABOUT_TEST_PREVIEW";

const TARGET: DVec3 = DVec3::new(0.0, 0.6, 0.0);

/// A post on a ground; the number says where it stands.
pub(crate) fn scene(number: u32) -> Scene {
    let x = f64::from(number % 5) * 0.5 - 1.0;
    Scene {
        still: Arc::new(Still {
            revision: 1,
            body_height: 1.5,
            bodies: vec![Body {
                role: Role::NewSkeleton,
                limbs: vec![Limb { role: Role::NewSkeleton, from: 0, to: 1, radius: 0.25 }],
                wireframe: false,
            }],
            curves: vec![],
            footprints: vec![],
            marks: vec![],
            labels: vec![],
            ground: Some(Ground { height: 0.0, centre: DVec3::ZERO, half_extent: 8.0, cell: 0.5 }),
        }),
        now: Now {
            actors: vec![vec![DVec3::new(x, 0.25, 0.0), DVec3::new(x, 1.25, 0.0)]],
            marks: vec![],
            labels: vec![],
            views: vec![View {
                camera: Camera {
                    eye: DVec3::new(2.0, 2.0, 4.0),
                    target: TARGET,
                    up: DVec3::Y,
                    projection: Projection::Perspective { fov_y_rad: 0.8 },
                },
                title: "test".to_owned(),
                shows: Objects::ALL,
                focused: false,
            }],
            caption: format!("scene {number}"),
        },
    }
}

pub(crate) fn is_child() -> bool {
    std::env::var_os(CHILD).is_some()
}

/// The preview's side.
pub(crate) fn child() {
    let log = ValidationLog::default();
    let options = RendererOptions {
        device: DeviceChoice::Processor,
        validation: Some(log.clone()),
        ..RendererOptions::default()
    };
    if std::env::var(CHILD).as_deref() == Ok("headless") {
        return headless::run(&options, &Mailbox::default(), |event| println!("{}", describe(&event)));
    }
    let scenes = Mailbox::default();
    let inbox = scenes.clone();
    thread::spawn(move || {
        for line in std::io::stdin().lines() {
            let line = line.expect("text");
            match line.strip_prefix("scene ") {
                Some(number) => {
                    inbox.put(scene(number.parse().expect("a number")));
                }
                None => inbox.close(),
            }
        }
    });
    window::run("walkabout — test.bvh", &options, &scenes, |event| println!("{}", describe(&event)));
    // Whether a missing layer is a failure is the picture tests' to say.
    println!("validation {:?}", log.messages().unwrap_or_default());
}

fn describe(event: &FromPreview) -> String {
    match event {
        FromPreview::Ready { device, driver } => format!("ready {device}, {driver}"),
        FromPreview::Key(key) => format!("key {key}"),
        FromPreview::Pick(ray) => {
            let miss = (TARGET - ray.origin).reject_from(ray.direction).length();
            format!("pick in view {} misses the target by {miss:.4}", ray.view)
        }
        FromPreview::Drag(_) => "drag".to_owned(),
        FromPreview::Release => "release".to_owned(),
        FromPreview::Wheel { view, steps } => format!("wheel {steps} in view {view}"),
        FromPreview::Frame(picture) => format!("frame {}×{}", picture.width, picture.height),
        FromPreview::Closed => "closed".to_owned(),
        FromPreview::Failed(text) => format!("failed {text}"),
    }
}

/// The test's side.
pub(crate) struct Preview {
    process: Child,
    orders: ChildStdin,
    events: Receiver<String>,
}

impl Preview {
    /// Starts a preview of a kind with changes to its environment; none takes a variable away.
    pub(crate) fn start(kind: &str, environment: &[(&str, Option<&str>)]) -> Self {
        let program = std::env::current_exe().expect("this program has a path");
        let mut command = Command::new(program);
        command.env(CHILD, kind).stdin(Stdio::piped()).stdout(Stdio::piped());
        for (name, value) in environment {
            match value {
                Some(value) => command.env(name, value),
                None => command.env_remove(name),
            };
        }
        let mut process = command.spawn().expect("this program starts again");
        let orders = process.stdin.take().expect("piped");
        let output = BufReader::new(process.stdout.take().expect("piped"));
        let (send, events) = channel();
        thread::spawn(move || output.lines().map_while(Result::ok).try_for_each(|line| send.send(line)));
        Self { process, orders, events }
    }

    pub(crate) fn say(&mut self, order: &str) {
        writeln!(self.orders, "{order}").expect("the preview listens");
    }

    /// Waits for the next event, which must begin like this. Of several drags in a row the last counts.
    pub(crate) fn expect(&self, beginning: &str) -> String {
        loop {
            match self.events.recv_timeout(PATIENCE) {
                Ok(event) if event.starts_with(beginning) => return event,
                Ok(event) if event == "drag" => {}
                Ok(event) => panic!("`{beginning}` was expected and `{event}` came"),
                Err(RecvTimeoutError::Timeout) => panic!("`{beginning}` did not come"),
                Err(RecvTimeoutError::Disconnected) => panic!("the preview ended before `{beginning}`"),
            }
        }
    }

    /// Waits for the process to end.
    pub(crate) fn ends(mut self) -> ExitStatus {
        let begin = Instant::now();
        loop {
            if let Some(status) = self.process.try_wait().expect("a child can be waited for") {
                return status;
            }
            assert!(begin.elapsed() < PATIENCE, "the preview does not end");
            thread::sleep(Duration::from_millis(10));
        }
    }

    /// Waits for the process to end without an error and without an event that was not expected.
    pub(crate) fn ends_well(mut self) {
        // What is still in the pipe, until the process closes it.
        let rest: Vec<_> = std::iter::from_fn(|| self.events.recv_timeout(PATIENCE).ok()).collect();
        let rest: Vec<_> = rest.iter().filter(|line| !line.starts_with("validation []")).collect();
        assert!(rest.is_empty(), "{rest:?}");
        let status = self.process.wait().expect("a child can be waited for");
        assert!(status.success(), "{status}");
    }
}

impl Drop for Preview {
    fn drop(&mut self) {
        // Already gone when the test went well.
        let _ = self.process.kill();
        let _ = self.process.wait();
    }
}
