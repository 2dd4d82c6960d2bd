//! How many frames a second kinematics gets through on one core, from local rotations and from raw channels.
//!
//! `cargo bench --bench kinematics [CLIP.bvh …]`; without a file, on made-up motion of 22 and 31 joints.

use std::{
    hint::black_box,
    time::{Duration, Instant},
};

use walkabout::{
    bvh::Bvh,
    motion::{Clip, ClipOptions, carrier_relative, local_rotations},
};

/// Runs are short, so that on a busy machine some are not interrupted.
const RUNS: usize = 200;

fn main() {
    let cores = std::thread::available_parallelism().map_or(0, |n| n.get());
    println!("one core of {cores}; million frames a second, best (median) of {RUNS} runs");
    println!(
        "{:30} {:>6} {:>6} {:>15} {:>15} {:>15} {:>15}",
        "clip", "joints", "frames", "local → world", "raw → world", "carrier's space", "Clip::from_bvh"
    );
    let files: Vec<String> = std::env::args().skip(1).filter(|arg| !arg.starts_with('-')).collect();
    for file in &files {
        let bytes = std::fs::read(file).expect("the file can be read");
        let name = file.rsplit('/').next().expect("a path has a last part");
        report(name, &Bvh::parse(bytes, name).expect("the file is a BVH"));
    }
    if files.is_empty() {
        for (n_joints, n_frames) in [(22, 2_000), (31, 2_000)] {
            let name = format!("made up, {n_joints} joints");
            report(&name, &Bvh::parse(made_up(n_joints, n_frames).into_bytes(), &name).expect("it is a BVH"));
        }
    }
}

fn report(name: &str, bvh: &Bvh) {
    let clip = Clip::from_bvh(bvh, &ClipOptions::default());
    let rate = |elapsed: Duration| clip.n_file_frames() as f64 / elapsed.as_secs_f64() / 1e6;
    let show = |(best, median): (Duration, Duration)| format!("{:.2} ({:.2})", rate(best), rate(median));
    let world = || clip.visit_world(|_, tracks| _ = black_box(tracks));
    let mut rotations = Vec::new();
    let from_rotations = time(world);
    let from_channels = time(|| {
        local_rotations(bvh, &mut rotations);
        black_box(&rotations);
        world();
    });
    let relative = time(|| _ = black_box(carrier_relative(&clip)));
    let all = time(|| _ = black_box(Clip::from_bvh(bvh, &ClipOptions::default())));
    println!(
        "{name:30} {:>6} {:>6} {:>15} {:>15} {:>15} {:>15}",
        clip.skeleton.n_joints(),
        clip.n_file_frames(),
        show(from_rotations),
        show(from_channels),
        show(relative),
        show(all)
    );
}

/// Returns the best and the median of many runs.
fn time(mut run: impl FnMut()) -> (Duration, Duration) {
    let mut times: Vec<Duration> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed()
        })
        .collect();
    times.sort_unstable();
    (times[0], times[RUNS / 2])
}

/// Writes a clip of five limbs on a root, every channel swinging at its own rate.
fn made_up(n_joints: usize, n_frames: usize) -> String {
    const LIMBS: usize = 5;
    let mut text = String::from(
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n",
    );
    for limb in 0..LIMBS {
        let n = (n_joints - 1 + limb) / LIMBS;
        for joint in 0..n {
            text += &format!(
                "JOINT J{limb}_{joint}\n{{\nOFFSET {limb} -{joint}.5 1\nCHANNELS 3 Zrotation Yrotation Xrotation\n"
            );
        }
        text += "End Site\n{\nOFFSET 0 1 0\n}\n";
        text += &"}\n".repeat(n);
    }
    text += &format!("}}\nMOTION\nFrames: {n_frames}\nFrame Time: 0.008333\n");
    for frame in 0..n_frames {
        for channel in 0..3 * n_joints + 3 {
            text += &format!("{:.4} ", 90.0 * (frame as f64 * 0.01 + channel as f64).sin());
        }
        text += "\n";
    }
    text
}
