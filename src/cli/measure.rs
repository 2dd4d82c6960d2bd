//! `walkabout measure`: the quality numbers of METHOD 9, source beside edited.

use std::fmt::Write as _;

use serde_json::json;

use super::{Failure, args::Clip, info::shown_file, limits::Limit};
use crate::{
    contact::FootPlants,
    document::{Document, Solved},
    measure::{FootNumbers, Pair},
};

pub(super) fn run(clip: &Clip, as_json: bool, limits: &[Limit]) -> Result<(), Failure> {
    let document = super::open_loudly(clip)?;
    if as_json {
        super::print_json(&report(clip, &document))?
    } else {
        super::print(&text(document.solved()))?
    }
    let broken: Vec<String> = limits.iter().flat_map(|limit| limit.broken_by(document.solved())).collect();
    if broken.is_empty() { Ok(()) } else { Err(Failure::Limit(broken.join("\nwalkabout: "))) }
}

fn report(clip: &Clip, document: &Document) -> serde_json::Value {
    let solved = document.solved();
    let measures = &solved.measures;
    let rms = solved.residual_rms() / solved.clip.facts.height.value;
    let seam: Vec<_> = measures
        .seam
        .iter()
        .map(|s| {
            json!({
                "frame": s.frame + solved.clip.rest_frames(),
                "position": s.position,
                "rotation": s.rotation,
                "velocity": s.velocity,
            })
        })
        .collect();
    json!({
        "file": shown_file(clip, document),
        "frames": { "source": solved.source.bvh.n_frames(), "edited": solved.n_exported_frames() },
        "frame_time": solved.clip.frame_time_secs,
        "height": { "source": measures.height.source, "edited": measures.height.edited },
        "unit": solved.clip.facts.unit.value,
        "path_length": { "source": measures.path_length.source, "edited": measures.path_length.edited },
        "original_degree": solved.original.degree(),
        "feet": feet(solved),
        "residual_rms": { "x": rms.x, "y": rms.y, "z": rms.z },
        "jerk_ratio": measures.jerk_ratio,
        "path_error": measures.path_error,
        "seam": seam,
        "warnings": solved.warnings.iter().cloned().chain(solved.missed_plants()).collect::<Vec<_>>(),
    })
}

fn feet(solved: &Solved) -> Vec<serde_json::Value> {
    let pair = |pair: Option<Pair>| pair.map(|p| json!({ "source": p.source, "edited": p.edited }));
    let feet = solved.feet.plants.iter().zip(solved.foot_numbers.iter());
    let foot = |(foot, numbers): (&FootPlants, &FootNumbers)| {
        json!({
            "joint": solved.clip.skeleton.joint(foot.leg.ankle).name,
            "plants": numbers.plants,
            "planted_speed": pair(numbers.planted_speed),
            "slip_p90": pair(numbers.slip_p90),
            "clearance": pair(numbers.clearance),
        })
    };
    feet.map(foot).collect()
}

fn text(solved: &Solved) -> String {
    let measures = &solved.measures;
    let rms = solved.residual_rms() / solved.clip.facts.height.value;
    let mut out = String::new();
    let mut line = |name: &str, value: String, unit: &str| {
        writeln!(out, "{name:<16} {value:<28} {unit}").expect("writing to a String");
    };
    let number = |n: Option<f64>| n.map_or_else(|| "–".to_owned(), |n| format!("{n:.6}"));
    let pair = |source: f64, edited: f64| format!("{source:.4} → {edited:.4}");
    line("frames", format!("{} → {}", solved.source.bvh.n_frames(), solved.n_exported_frames()), "source → edited");
    line("height", pair(measures.height.source, measures.height.edited), "clip unit");
    line("path length", pair(measures.path_length.source, measures.path_length.edited), "clip unit");
    line("original degree", solved.original.degree().to_string(), "");
    line("residual RMS", format!("{:.5} {:.5} {:.5}", rms.x, rms.y, rms.z), "H, along the clip's x y z");
    line("jerk ratio", number(measures.jerk_ratio), "edited over source");
    line("path error", number(measures.path_error), "H");
    for (foot, numbers) in solved.feet.plants.iter().zip(solved.foot_numbers.iter()) {
        let joint = &solved.clip.skeleton.joint(foot.leg.ankle).name;
        let plants = if numbers.plants == 1 { "plant" } else { "plants" };
        line(joint, format!("{} {plants}", numbers.plants), "of those the edited clip shows");
        let rows = [
            ("planted speed", numbers.planted_speed, speed_units(solved, numbers.planted_speed)),
            ("slip p90", numbers.slip_p90, "H".to_owned()),
            ("swing clearance", numbers.clearance, "H".to_owned()),
        ];
        for (name, numbers, unit) in rows {
            let value = numbers.map_or_else(|| "–".to_owned(), |p| format!("{:.5} → {:.5}", p.source, p.edited));
            line(&format!("  {name}"), value, &unit);
        }
    }
    for strain in solved.strains.iter() {
        let rest = solved.clip.rest_frames();
        let frames = format!("frames {} to {}", strain.frames.start + rest, strain.frames.end - 1 + rest);
        line(&format!("too much {}", strain.cause.word()), frames, &solved.strain(strain));
    }
    for s in &measures.seam {
        line(
            &format!("seam at {}", s.frame + solved.clip.rest_frames()),
            format!("{:.5} {:.5} {:.5}  {:.2} ×", s.position, s.rotation, s.velocity, s.position_share()),
            "position, rotation, velocity step; position over the steps beside it",
        );
    }
    out
}

/// Names the unit of a planted speed, and says the same in the clip's own as exactly.
fn speed_units(solved: &Solved, speed: Option<Pair>) -> String {
    let Some(pair) = speed else { return "H/s".to_owned() };
    let (height, unit) = (solved.clip.facts.height.value, solved.clip.facts.unit_word());
    let decimals = (5.0 - height.log10()).round().clamp(0.0, 9.0) as usize;
    let [source, edited] = [pair.source, pair.edited].map(|speed| format!("{:.decimals$}", speed * height));
    format!("H/s; {source} → {edited} {unit}/s")
}
