//! Layers by key: the list, what is done with them, and the tab that charts their maps.

use std::sync::Arc;

use walkabout::{
    displace::Interpolation,
    document::{Document, open},
    editor::{Editor, RowKind, TABS, Tab},
    tui::text,
};

/// The built-in clip with two layers: `low` bends the chest, `high` nods.
fn editor() -> Editor {
    let mut editor = Editor::new(Document::new(open(None).expect("the built-in clip")), Vec::new());
    editor.keys(":");
    editor.paste(
        "layer=[{name='low', rotation={Chest=[{frame=10,value=[0.9,0.1,0,0]},{frame=90,value=[1,0,0,0]}]}, \
         position=[{frame=20,value=[0,2,0]}]}, {name='high', rotation={Neck=[{frame=40,value=[0.9,0,0.2,0]}]}}]",
    );
    editor.keys("<enter>");
    assert_eq!(names(&editor), ["low", "high"], "{:?}", editor.view().message);
    editor
}

fn names(editor: &Editor) -> Vec<String> {
    editor.document().edits().layers.iter().map(|layer| layer.name.clone()).collect()
}

fn go_to(editor: &mut Editor, tab: Tab) {
    while TABS[editor.view().tab_idx] != tab {
        editor.keys("<tab>");
    }
}

fn message(editor: &Editor) -> &str {
    editor.view().message.as_ref().map_or("", |message| &message.text)
}

#[test]
fn layers_are_made_named_moved_and_taken_out() {
    let mut e = editor();
    e.keys("Bn");
    assert_eq!((names(&e), e.view().layer_idx), (vec!["low".into(), "high".into(), "layer 1".into()], 2));
    e.keys("B<enter><c-u>");
    e.paste("waving");
    e.keys("<enter>");
    assert_eq!(message(&e), "layer 1 is called waving now");
    assert_eq!(names(&e), ["low", "high", "waving"]);
    e.keys("Bj");
    assert_eq!((names(&e), e.view().layer_idx), (vec!["low".into(), "waving".into(), "high".into()], 1));
    e.keys("BjBj");
    assert_eq!((names(&e), e.view().layer_idx), (vec!["waving".into(), "low".into(), "high".into()], 0));
    assert_eq!(message(&e), "the layer cannot move further");
    e.keys("BkBbBb");
    assert_eq!((names(&e), e.view().layer_idx), (vec!["low".into(), "waving".into(), "high".into()], 0));
    e.keys("BbBd");
    assert_eq!((names(&e), message(&e)), (vec!["low".into(), "high".into()], "waving is deleted; u takes it back"));
    e.keys("u");
    assert_eq!(names(&e), ["low", "waving", "high"]);
}

#[test]
fn a_layer_is_weighed_switched_and_interpolated_otherwise_at_once() {
    let mut e = editor();
    let shown = |e: &Editor| e.document().solved().to_bvh();
    let mut seen = vec![shown(&e)];
    for (keys, weight) in [("B-", 0.95), ("B-", 0.9), ("B+", 0.95)] {
        e.keys(keys);
        assert_eq!(e.document().edits().layers[0].weight, weight);
        assert!(!seen.contains(&shown(&e)) || keys == "B+");
        seen.push(shown(&e));
    }
    let depth = e.document().depth().0;
    for expected in [Interpolation::EulerLinear, Interpolation::EulerCubic, Interpolation::Quaternion] {
        e.keys("Bi");
        assert_eq!(e.document().edits().layers[0].interpolation, expected);
        assert!(message(&e).contains(expected.words()), "{}", message(&e));
    }
    e.keys("Bo");
    assert!(!e.document().edits().layers[0].on && message(&e).starts_with("low: off"), "{}", message(&e));
    assert_eq!(e.document().depth().0, depth + 4, "each is a step of its own");
    e.keys("Bm");
    assert_eq!(message(&e), "layer `low` is off; switch it on first");
    e.keys("BoBm");
    assert!(e.document().edits().layers[0].merged);
    e.keys("BbBpBr");
    assert!(e.document().edits().layers[1].rotation.is_empty());
    assert_eq!(e.document().edits().layers[0].rotation.len(), 1, "only the layer in use is cleared");
}

#[test]
fn a_merged_layer_keeps_what_it_does() {
    let mut e = editor();
    go_to(&mut e, Tab::Layers);
    e.keys("Bm");
    let merged = Arc::clone(e.document().edits());
    assert!(merged.layers[0].merged && !merged.layers[1].merged);
    let above = "layer `low` is merged into the motion; edit a layer above it";
    for keys in ["Bo", "B-", "B+", "-", "]", "<backspace>", "Bi", "Bp", "Br", "Bm"] {
        e.keys(keys);
        assert_eq!((message(&e), &**e.document().edits()), (above, &*merged), "{keys}");
    }
    go_to(&mut e, Tab::Joints);
    e.keys("gcgc");
    for keys in ["d", "i", "x"] {
        e.keys(keys);
        assert_eq!((message(&e), &**e.document().edits()), (above, &*merged), "{keys}");
    }
    // Nothing lies above: a new layer does.
    e.keys("BbBmBo");
    let new = "layer `high` is merged into the motion; edits need a new layer above it: Bn makes one";
    assert_eq!(message(&e), new);
    e.keys("x");
    assert_eq!(message(&e), new);
    // Its name and whether it is there at all are the user's.
    let shown = e.document().solved().to_bvh();
    e.keys("B<enter><c-u>");
    e.paste("nod");
    e.keys("<enter>");
    assert_eq!(names(&e), ["low", "nod"]);
    assert!(e.document().solved().to_bvh() == shown);
    e.keys("Bd");
    assert_eq!(names(&e), ["low"]);
    e.keys("uuu");
    assert_eq!(e.document().edits().layers, merged.layers);
}

#[test]
fn what_is_merged_keeps_its_place_below_all_else() {
    let mut e = editor();
    // Both turn one joint, so that their order is seen.
    let layers = |merged: [bool; 3]| {
        let turns = ["[0.9,0.3,0,0]", "[0.9,0,0.3,0]", "[0.9,0,0,0.3]"];
        let layer = |n: usize| {
            let (name, merged) = (["low", "mid", "high"][n], merged[n]);
            format!("{{name='{name}', merged={merged}, rotation={{Neck=[{{frame=40,value={}}}]}}}}", turns[n])
        };
        format!("layer=[{}]", [0, 1, 2].map(layer).join(", "))
    };
    let fixed = |name: &str| format!("layer `{name}` is merged into the motion and keeps its place");
    let in_the_way =
        |name: &str| format!("layer `{name}` is merged into the motion: no other layer changes places with it");
    for (merged, layer_idx, keys, told) in [
        ([true, true, false], 0, "Bk", fixed("low")),
        ([true, true, false], 1, "Bj", fixed("mid")),
        ([true, true, false], 1, "Bk", fixed("mid")),
        ([true, true, false], 2, "Bj", in_the_way("mid")),
        ([true, false, false], 0, "Bk", fixed("low")),
        // A project may have them in any order; those that are merged lie below nevertheless.
        ([false, true, false], 0, "Bk", in_the_way("mid")),
        ([false, true, false], 1, "Bj", fixed("mid")),
        ([false, true, false], 2, "Bj", in_the_way("mid")),
        ([false, false, false], 2, "Bk", "the layer cannot move further".to_owned()),
    ] {
        e.keys(":");
        e.paste(&layers(merged));
        e.keys("<enter>");
        while e.view().layer_idx != layer_idx {
            e.keys("Bb");
        }
        let before = (Arc::clone(e.document().edits()), e.document().solved().to_bvh());
        e.keys(keys);
        assert_eq!(message(&e), told, "{merged:?} {keys}");
        assert!((Arc::clone(e.document().edits()), e.document().solved().to_bvh()) == before, "{merged:?} {keys}");
    }
    e.keys("Bj");
    assert_eq!(names(&e), ["low", "high", "mid"]);
}

#[test]
fn rows_of_layers_say_what_they_are_in_the_room_there_is() {
    let mut e = editor();
    go_to(&mut e, Tab::Layers);
    e.keys(":");
    e.paste(
        "layer=[{name='a', merged=true, on=false, weight=0.5, position=[{frame=20,value=[0,2,0]}]}, \
         {name='b', merged=true}, {name='c'}]",
    );
    e.keys("<enter>");
    let rows = e.rows();
    let layers: Vec<_> = rows.iter().filter(|row| matches!(row.kind, RowKind::Layer { .. })).collect();
    let shown: Vec<_> = layers.iter().map(|row| (row.label.as_str(), row.value.as_str())).collect();
    assert_eq!(
        shown,
        [
            ("● c", "on 1.00 quaternion, 0 keys"),
            ("■ b", "merged 1.00 quaternion, 0 keys"),
            ("□ a", "off, merged 0.50 quaternion, 1 key")
        ]
    );
    for row in layers {
        assert!(text::wrap(&row.help, 47).len() <= 3, "{:?}", text::wrap(&row.help, 47));
    }
    e.keys("BbBb");
    assert!(message(&e).contains(", 1 key, merged") || message(&e).contains(", 0 keys"), "{}", message(&e));
}

#[test]
fn the_clips_own_data_is_cleared_and_comes_back() {
    let mut e = editor();
    let before = Arc::clone(e.document().solved());
    e.keys("BP");
    assert!(
        e.document().edits().cleared.position && message(&e).contains("position data: cleared (clip."),
        "{}",
        message(&e)
    );
    e.keys("BR");
    assert!(e.document().edits().cleared.rotation);
    assert!(Arc::ptr_eq(&before.original, &e.document().solved().original), "the path is the clip's as loaded");
    e.keys("BPBR");
    assert!(e.document().solved().to_bvh() == before.to_bvh());
    e.keys("uuuu");
    assert_eq!(e.document().edits(), &before.edits);
}

#[test]
fn the_tab_lists_layers_as_they_lie() {
    let mut e = editor();
    go_to(&mut e, Tab::Layers);
    let rows = e.rows();
    let layers: Vec<_> = rows.iter().filter(|row| matches!(row.kind, RowKind::Layer { .. })).collect();
    assert_eq!(layers.iter().map(|row| row.label.as_str()).collect::<Vec<_>>(), ["● high", "◆ low"]);
    assert_eq!(layers[1].value, "on 1.00 quaternion, 3 keys");
    e.keys("k-");
    assert_eq!(e.document().edits().layers[1].weight, 0.95, "keys act on the row that is selected");
    assert_eq!(e.view().layer_idx, 1);
    e.keys("[<backspace>");
    assert_eq!(e.document().edits().layers[1].weight, 1.0);
    e.keys("<enter><c-u>");
    e.paste(" ");
    e.keys("<enter>");
    assert_eq!((message(&e), e.prompt().is_some()), ("a layer needs a name", true));
    e.keys("<esc>");
    e.keys("jj");
    assert!(matches!(e.rows().iter().find(|row| row.selected).map(|row| row.kind), Some(RowKind::Parameter(_))));
}

#[test]
fn the_maps_tab_charts_what_layers_do_and_walks_the_keys() {
    let mut e = editor();
    go_to(&mut e, Tab::Maps);
    e.keys("gn");
    while !e.map_series().title.contains("Chest") {
        e.keys("gc");
    }
    let series = e.map_series();
    let file_frame = e.document().solved().clip.rest_frames();
    let expected = 2.0 * (0.1f64 / 0.9).atan().to_degrees();
    assert!((series.values[0][10 - file_frame] - expected).abs() < 1e-9 && series.values[1][10 - file_frame] == 0.0);
    assert!((series.values[0][50 - file_frame] - 0.5 * expected).abs() < 1e-6);
    assert_eq!((series.values[0][200], series.unit.as_str()), (0.0, "°"));
    let rows = e.rows();
    let listed: Vec<_> = rows.iter().map(|row| row.label.as_str()).collect();
    assert_eq!(listed, [format!("10 {expected:.2} 0.00 0.00° Chest"), "90 0.00 0.00 0.00°  Chest".to_owned()]);
    assert!(e.rows()[1].help.starts_with("Chest: 0.000° about [0.000, 0.000, 0.000]; "), "{}", e.rows()[1].help);
    e.keys("j");
    assert_eq!(e.view().frame_idx + file_frame, 90);
    e.keys("k");
    assert_eq!(e.view().frame_idx + file_frame, 10);
}

#[test]
fn an_euler_layer_is_charted_by_what_it_adds_to_the_channels() {
    let mut e = editor();
    e.keys(":");
    e.paste(
        "layer=[{name='below', rotation={Chest=[{frame=5,value=[0.8,0.2,0.3,0.1]}]}}, {name='bend', weight=0.5, \
         rotation={Chest=[{frame=10,value=[0.9,0.1,0.2,-0.1]},{frame=90,value=[0.8,0,-0.3,0.2]}]}}]",
    );
    e.keys("<enter>Bb");
    go_to(&mut e, Tab::Maps);
    e.keys("gn");
    while !e.map_series().title.contains("Chest") {
        e.keys("gc");
    }
    assert_eq!((e.map_series().title.as_str(), e.map_series().names), ("Chest", ["x", "y", "z"]));
    e.keys("Bi");
    assert_eq!(e.document().edits().layers[1].interpolation, Interpolation::EulerLinear);
    let series = e.map_series();
    assert_eq!(series.title, "Chest, channels · bend");
    // The built-in clip's channels are Zrotation Xrotation Yrotation.
    assert_eq!((series.names, series.unit.as_str()), (["z", "x", "y"], "°"));
    let solved = Arc::clone(e.document().solved());
    let (clip, rest) = (&solved.clip, solved.clip.rest_frames());
    let chest = clip.skeleton.find("Chest").expect("a chest");
    let turned = solved.posed.of_clip.turned.iter().find(|turned| turned.joint == chest).expect("it turns");
    let order = clip.rotation_order(chest.idx()).expect("three channels");
    for values in &series.values {
        let at = |file_frame: usize| values[file_frame - rest];
        for file_frame in 10..=90 {
            let line = at(10) + (at(90) - at(10)) * (file_frame - 10) as f64 / 80.0;
            assert!((at(file_frame) - line).abs() < 1e-9, "frame {file_frame} is off the line between the keys");
        }
        assert!((at(10) - at(90)).abs() > 1.0, "every channel changes");
    }
    // Adding it to the channels of what lies below is the pose that is seen.
    e.keys("Bo");
    let solved = e.document().solved();
    let below = solved.posed.of_clip.turned.iter().find(|turned| turned.joint == chest).expect("it turns");
    for frame in [10 - rest, 37, 90 - rest, 150] {
        let degrees = order.nearest_degrees(below.rotations[frame], [0.0; 3]);
        let sum = [0, 1, 2].map(|axis| degrees[axis] + series.values[axis][frame]);
        assert!(order.rotation(sum).angle_between(turned.rotations[frame]) < 1e-6, "frame {frame}");
    }
    assert!(e.map_series().values.iter().flatten().all(|&value| value == 0.0), "a layer that is off adds nothing");
}
