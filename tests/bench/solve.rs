//! How long one change takes to solve, on 10,000 frames × 31 joints: `cargo bench --bench solve [-- PART OF A NAME]`.
//!
//! The target is 5 ms for a moved control point, measures included. Times are of the whole [`solve`], stages that the
//! change does not touch handed on.

use std::{fmt::Write as _, sync::Arc, time::Instant};

use glam::DVec3;
use walkabout::{
    bvh::Bvh,
    document::{Cycling, Edits, Solved, Source, solve},
    motion::ClipOptions,
    path::{Degree, Integrator, ResidualFrame, Shape, ShapeKind, shape_points},
};

const N_FRAMES: usize = 10_000;
const N_JOINTS: usize = 31;
const RUNS: usize = 31;

type Edit = fn(&mut Edits);

fn main() {
    let n_cores = std::thread::available_parallelism().map_or(1, usize::from);
    let source = source();
    let mut edits = Edits::default();
    let first = solve(&source, &Arc::new(edits.clone()), None);
    let eight = Shape { kind: ShapeKind::Eight, size: 1.0 };
    let up = first.clip.facts.up.value;
    let points = shape_points(eight, &first.original, 16, 3);
    edits.path.points = points.len();
    edits.path.control_points = Some(points.into_iter().map(|p| up.to_file(p)).collect());
    let start = solve(&source, &Arc::new(edits.clone()), Some(&first));

    println!("{N_FRAMES} frames × {N_JOINTS} joints, {n_cores} cores, one used");
    println!(
        "original degree {}, length {:.1} body heights, {} control points, {} edited frames\n",
        start.original.degree(),
        start.original.length() / start.original.height(),
        start.new_path.spline().control_points().len(),
        start.edited.n_frames(),
    );
    println!("{:<44} {:>9} {:>9}", "change", "median ms", "least ms");
    let changes: [(&str, Edit); 17] = [
        ("a control point moved", |e| {
            e.path.control_points.as_mut().expect("given")[5] += DVec3::new(0.3, 0.0, 0.1);
        }),
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
        ("clip.carrier = Hips", |e| {
            e.clip = ClipOptions { carrier: Some("Hips".to_owned()), ..ClipOptions::default() };
        }),
    ];
    let wanted = std::env::args().skip(1).find(|a| !a.starts_with('-')).unwrap_or_default();
    for (name, change) in changes.into_iter().filter(|(name, _)| name.contains(&wanted)) {
        let mut edits = (*start.edits).clone();
        change(&mut edits);
        report(name, &start, edits);
    }
    if wanted.is_empty() {
        let times = timed(|| {
            solve(&source, &start.edits, None);
        });
        print_row("everything from the file's numbers", &times);
    }
}

fn report(name: &str, start: &Solved, edits: Edits) {
    let edits = Arc::new(edits);
    let times = timed(|| {
        solve(&start.source, &edits, Some(start));
    });
    print_row(name, &times);
}

fn timed(mut work: impl FnMut()) -> Vec<f64> {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let begun = Instant::now();
            work();
            begun.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    times
}

fn print_row(name: &str, times: &[f64]) {
    println!("{name:<44} {:>9.2} {:>9.2}", times[times.len() / 2], times[0]);
}

/// A body of five chains that walks a winding way.
fn source() -> Arc<Source> {
    let mut text = String::from("HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n");
    text += "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n";
    for chain in 0..5 {
        for link in 0..(N_JOINTS - 1) / 5 {
            let down = if chain < 2 { -0.15 } else { 0.12 };
            let aside = 0.1 * (f64::from(chain) - 2.0) / (1.0 + link as f64);
            write!(text, "JOINT Chain{chain}Link{link}\n{{\nOFFSET {aside:.3} {down} 0\n").expect("into a String");
            text += "CHANNELS 3 Zrotation Xrotation Yrotation\n";
        }
        text += "End Site\n{\nOFFSET 0 -0.1 0.1\n}\n";
        text += &"}\n".repeat((N_JOINTS - 1) / 5);
    }
    write!(text, "}}\nMOTION\nFrames: {N_FRAMES}\nFrame Time: 0.0083333\n").expect("into a String");
    for f in 0..N_FRAMES {
        let t = f as f64 / 120.0;
        let turn = 0.8 * (0.21 * t).sin() + 0.5 * (0.047 * t).cos();
        let (x, z) = (6.0 * (0.17 * t).sin() + 0.02 * (6.0 * t).sin(), 9.0 * (0.11 * t).cos());
        write!(text, "{x:.5} {:.5} {z:.5} 0.5 1.5 {:.4}", 0.9 + 0.03 * (12.0 * t).sin(), turn.to_degrees())
            .expect("into a String");
        for joint in 1..N_JOINTS {
            let swing = 20.0 * (6.0 * t + joint as f64).sin();
            write!(text, " {:.4} {swing:.4} {:.4}", 0.2 * swing, -0.1 * swing).expect("into a String");
        }
        text.push('\n');
    }
    let bvh = Bvh::parse(text.into_bytes(), "synthetic").expect("a valid file");
    Arc::new(Source { name: "synthetic".to_owned(), file: None, bvh })
}
