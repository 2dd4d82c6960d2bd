//! How well feet are held, and how fast: `cargo bench --bench hold [-- PART OF A CLIP'S NAME]`.
//!
//! One row per clip and shape, for the degrees 5 and 13 of the original path: plain path editing, held, and held with
//! the feet's own slide removed; then the time that longer clips take. Ratios are over the source. Captured clips are found through `WALKABOUT_CLIPS`.

#[path = "../hold_numbers/mod.rs"]
#[allow(dead_code, reason = "shared by two programs; neither uses all of it")]
mod hold_numbers;

use std::time::Instant;

use hold_numbers::{Numbers, Plain, SHAPES, Subject, measure};
use walkabout::{
    bvh::Bvh,
    constrain::{Ground, Prepared, hold},
    contact::PlantMode,
    motion::gait,
    path::ShapeKind,
};

const CLIPS: [&str; 9] = [
    "cmu_02_01_walk",
    "cmu_08_01_brisk_walk",
    "cmu_12_03_walk",
    "cmu_131_01_start_walk_stop",
    "cmu_01_01_jumps",
    "figure8_walk",
    "walk01",
    "zombie_turns_z_up",
    "cmu_61_09_salsa_metres",
];

fn main() {
    let mut wanted = std::env::args().skip(1).filter(|a| !a.starts_with('-'));
    let name_part = wanted.next().unwrap_or_default();
    let mut subjects = vec![Subject::built_in()];
    match std::env::var("WALKABOUT_CLIPS") {
        Ok(dir) => subjects.extend(CLIPS.iter().map(|name| Subject::read(&dir, name))),
        Err(_) => println!("WALKABOUT_CLIPS is not set: the built-in clip only"),
    }
    println!(
        "{:<28}{:>3} {:<7}{:<6}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>8}{:>7}{:>5}{:>8}{:>6}{:>8}{:>8}",
        "clip",
        "deg",
        "shape",
        "",
        "speed",
        "slip",
        "clear",
        "jerk",
        "accel",
        "knee",
        "back°",
        "bones",
        "offset",
        "miss",
        "by",
        "end",
        "turn",
        "µs"
    );
    let (mut held_rows, mut clean_rows): (Vec<Numbers>, Vec<Numbers>) = Default::default();
    for subject in subjects.iter().filter(|s| s.name.contains(&name_part)) {
        let kept = Prepared::new(&subject.posed(), &[], &subject.feet, None);
        let clean = Prepared::new(&subject.posed(), &[], &subject.with_mode(PlantMode::Clean), None);
        for degree in [5, 13] {
            for kind in SHAPES {
                let plain = Plain::bent(subject, kind, degree, 0.5);
                let row = |what: &str, numbers: &Numbers, micros: f64| {
                    println!(
                        "{:<28}{degree:>3} {:<7}{what:<6}{}{micros:>8.0}",
                        subject.name,
                        kind.name(),
                        cells(numbers)
                    );
                };
                row("plain", &measure(subject, &plain.unheld()), 0.0);
                for (what, prepared) in [("held", &kept), ("clean", &clean)] {
                    let begun = Instant::now();
                    let held = hold(prepared, &plain.job(Ground::Steps));
                    let micros = begun.elapsed().as_secs_f64() * 1e6;
                    let numbers = measure(subject, &held);
                    row(what, &numbers, micros);
                    if what == "held" { &mut held_rows } else { &mut clean_rows }.push(numbers);
                }
            }
        }
    }
    for (what, all) in [("held", &held_rows), ("clean", &clean_rows)] {
        println!("{what}");
        summary("planted speed", all, |n| n.planted_speed);
        summary("slip p90", all, |n| n.slip);
        summary("swing clearance", all, |n| n.clearance);
        summary("jerk", all, |n| n.jerk);
        summary("largest acceleration", all, |n| n.acceleration);
        summary("knee step, stretched", all, |n| n.knee_step);
        summary("jump at plants' ends", all, |n| n.end_jump);
        summary("turn in plants, rad", all, |n| n.foot_turn);
        summary("offset", all, |n| n.offset);
        summary("missed by", all, |n| n.missed_by);
    }
    for n_frames in [1_000, 10_000, 100_000] {
        timed(n_frames);
    }
}

/// Prints how long one edit takes of the built-in walk, walked again and again from where it ended.
fn timed(n_frames: usize) {
    let text = gait::built_in().0;
    let (head, motion) = text.split_once("MOTION").expect("a BVH file");
    let is_row = |row: &&str| row.starts_with(|c: char| c == '-' || c.is_ascii_digit());
    let numbers = |row: &str| row.split_whitespace().map(|n| n.parse().expect("a number")).collect::<Vec<f64>>();
    let rows: Vec<Vec<f64>> = motion.lines().filter(is_row).map(numbers).collect();
    let time = motion.lines().find(|line| line.starts_with("Frame Time")).expect("a BVH file");
    let mut longer = format!("{head}MOTION\nFrames: {n_frames}\n{time}\n");
    for frame in 0..n_frames {
        let (time, row) = ((frame / rows.len()) as f64, &rows[frame % rows.len()]);
        for (channel, value) in row.iter().enumerate() {
            let gone = if channel < 3 { time * (rows[rows.len() - 1][channel] - rows[0][channel]) } else { 0.0 };
            longer += &format!("{:.4} ", value + gone);
        }
        longer += "\n";
    }
    let subject = Subject::new("longer", &Bvh::parse(longer.into_bytes(), "longer").expect("a valid file"));
    let plain = Plain::bent(&subject, ShapeKind::Circle, 13, 0.5);
    let prepared = Prepared::new(&subject.posed(), &[], &subject.feet, None);
    let mut fastest = f64::INFINITY;
    for _ in 0..9 {
        let begun = Instant::now();
        std::hint::black_box(hold(&prepared, &plain.job(Ground::Steps)));
        fastest = fastest.min(begun.elapsed().as_secs_f64());
    }
    println!("{} frames in {:.2} ms", subject.clip.n_frames(), 1e3 * fastest);
}

fn cells(n: &Numbers) -> String {
    format!(
        "{:>7.3}{:>7.3}{:>7.3}{:>7.3}{:>7.2}{:>7.2}{:>7.1}{:>8.0e}{:>7.3}{:>5}{:>8.4}{:>6.2}{:>8.0e}",
        n.planted_speed,
        n.slip,
        n.clearance,
        n.jerk,
        n.acceleration,
        n.knee_step,
        n.knee_back_deg,
        n.bones,
        n.offset,
        n.n_missed,
        n.missed_by,
        n.end_jump,
        n.foot_turn
    )
}

fn summary(name: &str, all: &[Numbers], value: impl Fn(&Numbers) -> f64) {
    let mut values: Vec<f64> = all.iter().map(value).collect();
    values.sort_by(f64::total_cmp);
    if let Some(last) = values.len().checked_sub(1) {
        let at = |share: f64| values[(share * last as f64).round() as usize];
        println!("{name:<24} least {:.4}  median {:.4}  95 % {:.4}  most {:.4}", at(0.0), at(0.5), at(0.95), at(1.0));
    }
}
