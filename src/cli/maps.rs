//! `walkabout maps`: the keys of a project's displacement maps.

use std::fmt::Write as _;

use serde_json::{Value, json};

use super::{Failure, args::Clip};
use crate::{
    displace::{Layer, MapPoint, MapValue, PointValue, Selection, find_joint, joint_name},
    document::Document,
};

/// Prints the keys of all maps, or only of the joints named and of the carrier's position.
pub(super) fn run(clip: &Clip, joints: &[String], position: bool, as_json: bool) -> Result<(), Failure> {
    let document = super::open_loudly(clip)?;
    let skeleton = &document.solved().clip.skeleton;
    let named = |name: &String| {
        document.edits().layers.iter().any(|layer| layer.rotation.contains_key(name))
            || find_joint(skeleton, name).is_some()
    };
    if let Some(unknown) = joints.iter().find(|name| !named(name)) {
        let known: Vec<String> = skeleton.ids().map(|id| joint_name(skeleton, id)).collect();
        return Err(Failure::Usage(format!("there is no joint {unknown} (the joints are {})", known.join(", "))));
    }
    let selected = |layer: &Layer| {
        let all = joints.is_empty() && !position;
        if all { Selection::all(layer) } else { Selection { position, joints: joints.iter().cloned().collect() } }
    };
    if as_json {
        let layers: Vec<Value> = document.edits().layers.iter().map(|layer| report(layer, &selected(layer))).collect();
        return super::print_json(&json!({
            "file": super::info::shown_file(clip, &document),
            "layers": layers,
            "interpolation_keys": document.edits().interpolation_keys.map(|keys| [keys.first, keys.last]),
            "warnings": document.solved().warnings,
        }));
    }
    super::print(&text(&document, selected))
}

fn report(layer: &Layer, selection: &Selection) -> Value {
    let point = |point: MapPoint| match point.value {
        PointValue::Position(by) => json!({ "frame": point.frame, "map": "position", "value": by.numbers() }),
        PointValue::Rotation(joint, turn) => {
            json!({ "frame": point.frame, "map": "rotation", "joint": joint, "value": turn.numbers() })
        }
    };
    json!({
        "name": layer.name,
        "on": layer.on,
        "weight": layer.weight,
        "interpolation": layer.interpolation,
        "merged": layer.merged,
        "points": layer.map_points(selection).into_iter().map(point).collect::<Vec<_>>(),
    })
}

fn text(document: &Document, selected: impl Fn(&Layer) -> Selection) -> String {
    let mut out = String::new();
    if document.edits().layers.is_empty() {
        out.push_str("no layers\n");
    }
    for layer in &document.edits().layers {
        let state = match (layer.merged, layer.on) {
            (true, true) => "merged",
            (true, false) => "off, merged",
            (false, true) => "on",
            (false, false) => "off",
        };
        let (name, weight, way) = (&layer.name, layer.weight, layer.interpolation.words());
        writeln!(out, "{name}: {state}, weight {weight}, {way}").expect("into a String");
        let points = layer.map_points(&selected(layer));
        if points.is_empty() {
            out.push_str("  no keys\n");
        }
        for point in points {
            let (frame, map, value) = (point.frame, point.value.map_name(), &point.value);
            writeln!(out, "  frame {frame:>6}  {map}  {value}").expect("into a String");
        }
    }
    if let Some(keys) = document.edits().interpolation_keys {
        writeln!(out, "interpolated between frames {} and {}", keys.first, keys.last).expect("into a String");
    }
    out
}
