//! `walkabout info`: what a file holds, each decision with its reason.

use std::fmt::Write as _;

use serde_json::json;

use super::{Failure, args::Clip};
use crate::{
    document::{Document, Solved},
    motion::{Leg, Length, legs::point_name},
};

pub(super) fn run(clip: &Clip, as_json: bool) -> Result<(), Failure> {
    let document = super::open_loudly(clip)?;
    if as_json { super::print_json(&report(clip, &document)) } else { super::print(&text(document.solved())) }
}

fn lower(debug: impl std::fmt::Debug) -> String {
    format!("{debug:?}").to_lowercase()
}

/// The file's name as given on the command line.
pub(super) fn shown_file(clip: &Clip, document: &Document) -> String {
    clip.file.as_ref().map_or_else(|| document.solved().source.name.clone(), |f| f.display().to_string())
}

fn report(clip: &Clip, document: &Document) -> serde_json::Value {
    let solved = document.solved();
    let facts = &solved.clip.facts;
    json!({
        "file": shown_file(clip, document),
        "frames": solved.source.bvh.n_frames(),
        "frame_time": solved.clip.frame_time_secs,
        "joints": solved.clip.skeleton.n_joints(),
        "channels": solved.source.bvh.n_channels(),
        "carrier": solved.clip.skeleton.joint(facts.carrier.value).name,
        "up": lower(facts.up.value),
        "offsets": { "root": lower(facts.root_offset.value), "joints": lower(facts.joint_offsets.value) },
        "rest_frames": facts.rest_frames.value,
        "height": facts.height.value,
        "unit": facts.unit.value,
        "path_length": solved.original.length(),
        "legs": legs(solved),
        "plants": plants(solved),
        "warnings": solved.warnings,
    })
}

fn legs(solved: &Solved) -> Vec<serde_json::Value> {
    let skeleton = &solved.clip.skeleton;
    let name = |id| &skeleton.joint(id).name;
    let leg = |leg: &Leg| {
        json!({
            "side": leg.side,
            "hip": name(leg.hip),
            "knee": name(leg.knee),
            "ankle": name(leg.ankle),
            "toe": point_name(skeleton, leg.toe),
        })
    };
    solved.feet.found.legs.value.iter().map(leg).collect()
}

/// Plants by side, as frames of the file, last inclusive.
fn plants(solved: &Solved) -> serde_json::Value {
    let mut sides = json!({ "left": [], "right": [] });
    for foot in &solved.feet.plants {
        let side = foot.leg.side.name();
        let frames =
            foot.plants.iter().map(|p| json!([solved.clip.file_frame(p.first), solved.clip.file_frame(p.last)]));
        sides[side].as_array_mut().expect("made above").extend(frames);
    }
    sides
}

fn text(solved: &Solved) -> String {
    let (clip, facts) = (&solved.clip, &solved.clip.facts);
    let bvh = &solved.source.bvh;
    let mut out = String::new();
    let mut line = |name: &str, value: String, why: &str| {
        let because = if why.is_empty() { String::new() } else { format!("  ({why})") };
        writeln!(out, "{name:<14} {value}{because}").expect("writing to a String");
    };
    let secs = clip.n_file_frames() as f64 * clip.frame_time_secs;
    let stands = match clip.length {
        Length::Own => String::new(),
        _ => format!("{} in the file, standing still for clip.length", bvh.n_frames()),
    };
    line("file", solved.source.name.clone(), "");
    line("frames", format!("{} at {:.6} s, {secs:.2} s in all", clip.n_file_frames(), clip.frame_time_secs), &stands);
    line("joints", format!("{}, {} channels", clip.skeleton.n_joints(), bvh.n_channels()), "");
    line("carrier", clip.skeleton.joint(facts.carrier.value).name.clone(), &facts.carrier.why);
    line("up", lower(facts.up.value), &facts.up.why);
    line("root offset", lower(facts.root_offset.value), &facts.root_offset.why);
    line("joint offsets", lower(facts.joint_offsets.value), &facts.joint_offsets.why);
    line("rest frames", facts.rest_frames.value.to_string(), &facts.rest_frames.why);
    line("height", format!("{:.4}", facts.height.value), &facts.height.why);
    line("unit", facts.unit.value.unwrap_or("unknown").to_owned(), &facts.unit.why);
    let found = &solved.feet.found.legs;
    let feet: Vec<_> = found.value.iter().map(|leg| clip.skeleton.joint(leg.ankle).name.as_str()).collect();
    line("legs", if feet.is_empty() { "none".to_owned() } else { format!("to {}", feet.join(", ")) }, &found.why);
    for foot in &solved.feet.plants {
        let frames = foot.plants.iter().map(|p| format!("{}–{}", clip.file_frame(p.first), clip.file_frame(p.last)));
        let frames: Vec<_> = frames.collect();
        line(&format!("{:?} plants", foot.leg.side), format!("{}: {}", frames.len(), frames.join(" ")), "");
    }
    let in_heights = solved.original.length() / facts.height.value;
    line("path length", format!("{:.4}, {in_heights:.2} body heights", solved.original.length()), "");
    line("path degree", solved.original.degree().to_string(), "");
    if !facts.path_editable {
        line("path editing", "no".to_owned(), "the carrier lacks three position and three rotation channels");
    }
    out
}
