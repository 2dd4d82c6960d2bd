//! How long one change takes to solve, on 10,000 frames × 31 joints: `cargo bench --bench solve [-- PART OF A NAME]`.
//!
//! The target is 12 ms for a moved control point, feet held and the live score included: [`solve_live`], as a key does it
//! in the editor. All other rows are of the whole [`solve`], stages that the change does not touch handed on.

use std::{fmt::Write as _, sync::Arc, time::Instant};

use glam::DVec3;
use walkabout::{
    bvh::Bvh,
    document::{Cycling, Document, Edits, Opened, Solved, Source, solve, solve_live},
    editor::{Editor, TABS, Tab},
    motion::{ClipOptions, gait},
    path::{Degree, Integrator, ResidualFrame, Shape, ShapeKind, shape_points},
};

const N_FRAMES: usize = 10_000;
const N_JOINTS: usize = 31;
const RUNS: usize = 31;

type Edit = fn(&mut Edits);

fn main() {
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let source = source(N_FRAMES);
    let mut edits = Edits::default();
    let first = solve(&source, &Arc::new(edits.clone()), None);
    let eight = Shape { kind: ShapeKind::Eight, size: 1.0 };
    let up = first.clip.facts.up.value;
    let points = shape_points(eight, &first.original, 16, 3);
    edits.path.points = points.len();
    edits.path.control_points = Some(points.into_iter().map(|p| up.to_file(p)).collect());
    let start = solve(&source, &Arc::new(edits.clone()), Some(&first));

    let (n_joints, n_plants) =
        (start.clip.skeleton.n_joints(), start.feet.plants.iter().map(|foot| foot.plants.len()).sum::<usize>());
    assert_eq!(n_joints, N_JOINTS);
    println!(
        "{N_FRAMES} frames × {N_JOINTS} joints, {n_plants} foot plants, {n_cores} cores; long clips are held and measured on two"
    );
    println!(
        "original degree {}, length {:.1} body heights, {} control points, {} edited frames\n",
        start.original.degree(),
        start.original.length() / start.original.height(),
        start.new_path.spline().control_points().len(),
        start.edited.n_frames(),
    );
    println!("{:<50} {:>9} {:>9}", "change", "median ms", "least ms");
    let changes: [(&str, Edit); 21] = [
        ("a control point moved, the whole body measured", move_point),
        ("the same, plants.hold = false", |e| {
            move_point(e);
            e.plants.hold = false;
        }),
        ("plants.clean = true", |e| e.plants.clean = true),
        ("plants.speed = 0.2", |e| e.plants.detection.speed = 0.2),
        ("path.control_points = the straight line", |e| e.path.control_points = None),
        ("path.degree = 5", |e| e.path.degree = 5),
        ("path.edited = false", |e| e.path.edited = false),
        ("original.degree = 5", |e| e.original.degree = Degree::Fixed(5)),
        ("original.degree = 13", |e| e.original.degree = Degree::Fixed(13)),
        ("original.degree = 45", |e| e.original.degree = Degree::Fixed(45)),
        ("original.degree = 60", |e| e.original.degree = Degree::Fixed(60)),
        ("residual.frame = tangent", |e| e.residual.frame = ResidualFrame::Tangent),
        ("residual.frame = absolute", |e| e.residual.frame = ResidualFrame::Absolute),
        ("heading.window = 0.1", |e| e.heading.window = 0.1),
        ("heading.window = 0", |e| e.heading.window = 0.0),
        ("timing.arc_length = false", |e| e.timing.arc_length = false),
        ("timing.integrator = euler, step 1e-3", |e| e.timing.integrator = Integrator::Euler),
        ("timing.integrator = euler, step 1e-5", |e| {
            e.timing.integrator = Integrator::Euler;
            e.timing.step = 1e-5;
        }),
        ("timing.cycling = plain on a path 3 times as long", |e| {
            e.timing.cycling = Cycling::Plain;
            for p in e.path.control_points.as_mut().expect("given") {
                *p *= 3.0;
            }
        }),
        ("timing.cycling = blended, the same path", |e| {
            e.timing.cycling = Cycling::Blended;
            for p in e.path.control_points.as_mut().expect("given") {
                *p *= 3.0;
            }
        }),
        ("clip.carrier = Hips", |e| {
            e.clip = ClipOptions { carrier: Some("Hips".to_owned()), ..ClipOptions::default() };
        }),
    ];
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    let live = "a control point moved, live score";
    if live.contains(&wanted) {
        let mut edits = (*start.edits).clone();
        move_point(&mut edits);
        let edits = Arc::new(edits);
        print_row(live, &timed(|| drop(solve_live(&edits, &start))));
    }
    for (name, change) in changes.into_iter().filter(|(name, _)| name.contains(&wanted)) {
        let mut edits = (*start.edits).clone();
        change(&mut edits);
        report(name, &start, edits);
    }
    if wanted.is_empty() || "linear in frames".contains(&wanted) {
        linear();
    }
    poses(&start, &wanted);
    if wanted.is_empty() {
        let times = timed(|| {
            solve(&source, &start.edits, None);
        });
        print_row("everything from the file's numbers", &times);
    }
}

/// Prints how long it takes from a key that edits a pose to the scene that shows it, whose target is 16 ms: pressed now and
/// then, and held down. Then how long the rest takes, all of the clip following and measured, which the editor does when
/// nothing has been pressed for a moment; and how long both take together as a script waits for them.
fn poses(start: &Solved, wanted: &str) {
    let arm = "gcgcgcgsgcgtgcgtgc";
    let body = "gcgcgcgsgcgcgcgr";
    let leg = "gcgsgtgcgtgc";
    let keyed = "gai..........<lt>i<end>i<home>gn";
    for (name, keys) in [
        ("a key moves a hand", arm.to_owned()),
        ("a key moves a hand, all joints have keys", format!("{keyed}{arm}")),
        ("a key moves a hand, the whole chain to the root", body.to_owned()),
        ("a key moves a foot that is held", leg.to_owned()),
        ("a key moves a foot, the whole chain to the root", "gcgsgcgcgr".to_owned()),
        ("a key moves a foot at its leg's full length", format!("gcgsgcgcgr{}", "Y".repeat(20))),
        ("a key turns the chest", "gcgce".to_owned()),
        ("a key moves the carrier", String::new()),
        ("a key moves a hand, Euler cubic, all keyed", format!("{keyed}BiBi{arm}")),
    ] {
        if !"poses".contains(wanted) && !name.contains(wanted) {
            continue;
        }
        let source = Source { name: String::new(), file: None, bvh: start.source.bvh.clone() };
        let edits = (*start.edits).clone();
        let opened = Opened { source: Arc::new(source), edits, project: None, warnings: Vec::new() };
        let mut editor = Editor::new(Document::new(opened), Vec::new());
        let tab_idx = TABS.iter().position(|&tab| tab == Tab::Joints).expect("a tab");
        editor.keys(&"<tab>".repeat(tab_idx));
        editor.keys("......................................................................");
        editor.keys(&keys);
        editor.keys("x");
        assert!(!editor.document().edits().layers.is_empty(), "{name}: {:?}", editor.view().message);
        let mut key = ["x", "X"].into_iter().cycle();
        let mut scripted = editor.clone();
        editor.show_drafts();
        let (mut shown, mut rest) = (Vec::new(), Vec::new());
        for _ in 0..RUNS {
            shown.push(once(|| {
                editor.keys(key.next().expect("without end"));
                std::hint::black_box(editor.scene());
            }));
            rest.push(once(|| {
                editor.measure();
                std::hint::black_box(editor.scene());
            }));
        }
        print_row(name, &sorted(shown));
        let mut held = ["x", "x", "x", "X", "X", "X"].into_iter().cycle();
        let times = timed(|| {
            editor.keys(held.next().expect("without end"));
            std::hint::black_box(editor.scene());
        });
        print_row("    held down", &times);
        print_row("    the whole clip follows and is measured", &sorted(rest));
        let times = timed(|| {
            scripted.keys(key.next().expect("without end"));
            std::hint::black_box(scripted.scene());
        });
        print_row("    as a script waits for it", &times);
    }
}

/// Prints how a moved control point's time grows with the clip, live score included.
fn linear() {
    for n_frames in [1_000, 10_000, 100_000] {
        let start = solve(&source(n_frames), &Arc::new(Edits::default()), None);
        let mut edits = (*start.edits).clone();
        let mut points = start.control_points();
        points[3] += DVec3::new(30.0, 0.0, 10.0);
        edits.path.control_points = Some(points);
        let edits = Arc::new(edits);
        print_row(&format!("live score, {n_frames} frames"), &timed(|| drop(solve_live(&edits, &start))));
    }
}

fn move_point(edits: &mut Edits) {
    edits.path.control_points.as_mut().expect("given")[5] += DVec3::new(0.3, 0.0, 0.1);
}

fn report(name: &str, start: &Solved, edits: Edits) {
    let edits = Arc::new(edits);
    let times = timed(|| {
        solve(&start.source, &edits, Some(start));
    });
    print_row(name, &times);
}

fn timed(mut work: impl FnMut()) -> Vec<f64> {
    sorted((0..RUNS).map(|_| once(&mut work)).collect())
}

/// Returns how long something takes, milliseconds.
fn once(work: impl FnOnce()) -> f64 {
    let begun = Instant::now();
    work();
    begun.elapsed().as_secs_f64() * 1e3
}

fn sorted(mut times: Vec<f64>) -> Vec<f64> {
    times.sort_by(f64::total_cmp);
    times
}

fn print_row(name: &str, times: &[f64]) {
    println!("{name:<50} {:>9.2} {:>9.2}", times[times.len() / 2], times[0]);
}

/// A winding walk: the built-in clip's steady stride again and again, led along a figure eight with its feet held.
fn source(n_frames: usize) -> Arc<Source> {
    let straight = as_source(repeated_strides(n_frames + n_frames / 50));
    let mut edits = Edits::default();
    let plain = solve(&straight, &Arc::new(edits.clone()), None);
    let up = plain.clip.facts.up.value;
    let eight = shape_points(Shape { kind: ShapeKind::Eight, size: 1.0 }, &plain.original, 24, 3);
    edits.path.points = eight.len();
    edits.path.control_points = Some(eight.into_iter().map(|p| up.to_file(p)).collect());
    let walked = Bvh::parse(solve(&straight, &Arc::new(edits), None).to_bvh(), "winding").expect("our own export");
    let text = String::from_utf8(walked.text().to_vec()).expect("a text");
    let rows_at = text.find("Frames:").expect("a motion section");
    let rows: Vec<&str> = text[rows_at..].lines().skip(2).take(n_frames).collect();
    assert_eq!(rows.len(), n_frames, "the walk is long enough");
    as_source(format!("{}Frames: {n_frames}\nFrame Time: 0.0083333\n{}\n", &text[..rows_at], rows.join("\n")))
}

fn as_source(text: String) -> Arc<Source> {
    let bvh = Bvh::parse(text.into_bytes(), "walk").expect("a valid file");
    Arc::new(Source { name: "walk".to_owned(), file: None, bvh })
}

/// Frames of one stride of the built-in clip, walking straight on.
const STRIDE: std::ops::Range<usize> = 150..214;

/// Returns a walk straight on, with fingers enough for [`N_JOINTS`].
fn repeated_strides(n_frames: usize) -> String {
    let (text, _) = gait::built_in();
    let bvh = Bvh::parse(text.clone().into_bytes(), "built-in").expect("a valid file");
    let n_fingers = (N_JOINTS - bvh.joints().len()) / 2;
    let mut out = String::new();
    let mut hand = false;
    for line in text.lines().take_while(|line| !line.starts_with("Frames:")) {
        writeln!(out, "{line}").expect("into a String");
        hand |= line.contains("JOINT") && line.contains("Wrist");
        if hand && line.contains("CHANNELS") {
            hand = false;
            for finger in 0..n_fingers {
                writeln!(
                    out,
                    "JOINT Finger{finger}At{}\n{{\nOFFSET 0 -8 {finger}\nCHANNELS 3 Zrotation Xrotation Yrotation\n\
                     End Site\n{{\nOFFSET 0 -8 0\n}}\n}}",
                    out.len()
                )
                .expect("into a String");
            }
        }
    }
    let hands: Vec<usize> = (bvh.joints().iter().filter(|joint| joint.name.contains("Wrist")))
        .map(|hand| hand.first_channel + hand.channels.len())
        .collect();
    assert_eq!(hands.len(), 2);
    let step = bvh.frame(STRIDE.end)[2] - bvh.frame(STRIDE.start)[2];
    writeln!(out, "Frames: {n_frames}\nFrame Time: 0.0083333").expect("into a String");
    for frame in 0..n_frames {
        let row = bvh.frame(STRIDE.start + frame % STRIDE.len());
        for (channel, value) in row.iter().enumerate() {
            if hands.contains(&channel) {
                out += &"10 5 0 ".repeat(n_fingers);
            }
            let gone = if channel == 2 { step * (frame / STRIDE.len()) as f64 } else { 0.0 };
            write!(out, "{:.6} ", value + gone).expect("into a String");
        }
        out.push('\n');
    }
    out
}
