//! How well feet are held, and how fast: `cargo bench --bench hold [-- PART OF A CLIP'S NAME]`.
//!
//! One row per clip and shape, for the degrees 5 and 13 of the original path: plain path editing, held, and held with
//! the feet's own slide removed. Ratios are over the source. Captured clips are found through `WALKABOUT_CLIPS`.

#[path = "../hold_numbers/mod.rs"]
#[allow(dead_code, reason = "shared by two programs; neither uses all of it")]
mod hold_numbers;

use std::time::Instant;

use hold_numbers::{Numbers, Plain, SHAPES, Subject, measure};
use walkabout::{
    constrain::{Ground, Prepared, hold},
    contact::PlantMode,
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
        "{:<28}{:>3} {:<7}{:<6}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>7}{:>8}{:>7}{:>5}{:>8}{:>8}",
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
        "µs"
    );
    let mut all: Vec<Numbers> = Vec::new();
    for subject in subjects.iter().filter(|s| s.name.contains(&name_part)) {
        let kept = Prepared::new(&subject.clip, &subject.feet);
        let clean = Prepared::new(&subject.clip, &subject.with_mode(PlantMode::Clean));
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
                    if what == "held" {
                        all.push(numbers);
                    }
                }
            }
        }
    }
    summary("planted speed", &all, |n| n.planted_speed);
    summary("slip p90", &all, |n| n.slip);
    summary("swing clearance", &all, |n| n.clearance);
    summary("jerk", &all, |n| n.jerk);
    summary("largest acceleration", &all, |n| n.acceleration);
    summary("knee step, stretched", &all, |n| n.knee_step);
    summary("offset", &all, |n| n.offset);
    summary("missed by", &all, |n| n.missed_by);
}

fn cells(n: &Numbers) -> String {
    format!(
        "{:>7.3}{:>7.3}{:>7.3}{:>7.3}{:>7.2}{:>7.2}{:>7.1}{:>8.0e}{:>7.3}{:>5}{:>8.4}",
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
        n.missed_by
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
