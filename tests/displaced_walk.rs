//! Displacement maps as a user has them: from a key press's change to the exported file.

#[allow(dead_code, reason = "shared by two programs; neither uses all of it")]
mod walking;

use std::{f64::consts::PI, sync::Arc};

use glam::{DQuat, DVec3};
use walkabout::{
    displace::{Interpolation, InterpolationKeys, Layer, Selection, joint_name},
    document::{self, Change, Document, KeyChange, LayerChange, Opened, PoseChange, Solved, open, parse_assignment},
};
use walking::{apart, apply, carrier_moved, joint, opened, reach, set, turn, world};

#[test]
fn zero_displacement_changes_nothing_byte_for_byte() {
    for (sets, shape) in [(&["path.edited=false"][..], None), (&[], Some("circle")), (&["plants.hold=off"], Some("s"))]
    {
        let mut document = opened(sets, shape);
        let before = document.solved().to_bvh();
        apply(&mut document, Change::Layer(LayerChange::Add { name: String::new() }));
        let clip = Arc::clone(&document.solved().clip);
        let selection = Selection {
            position: true,
            joints: clip.skeleton.ids().map(|id| joint_name(&clip.skeleton, id)).collect(),
        };
        for frame in [3, 200, 400] {
            let change = KeyChange::Add { frame };
            apply(&mut document, Change::Keys { layer_idx: 0, selection: selection.clone(), change });
        }
        assert_eq!(document.edits().layers[0].key_frames(&selection), [3, 200, 400]);
        assert!(document.solved().to_bvh() == before, "{sets:?}: the bytes differ");
    }
}

#[test]
fn what_is_added_is_the_map_and_nothing_else() {
    let mut document = opened(&[], Some("circle"));
    let before = Arc::clone(document.solved());
    let elbow = joint(&before, "LeftElbow");
    let (axis, angle) = (DVec3::new(0.6, 0.0, 0.8), 0.7);
    let turns = [(100, DQuat::IDENTITY), (140, DQuat::from_axis_angle(axis, angle)), (200, DQuat::IDENTITY)];
    let mut layer = Layer::new("bend");
    turns.iter().for_each(|&(frame, turn)| layer.set_rotation("LeftElbow", frame, turn));
    set(
        &mut document,
        &[&format!("layer={}", toml::Value::Array(vec![toml::Value::try_from(&layer).expect("a value")]))],
        None,
    );
    assert_eq!(document.edits().layers, [layer]);
    let after = document.solved();
    let rest = after.clip.rest_frames();
    for frame in 0..after.edited.n_frames() {
        let file_frame = after.source_frame(frame) + rest;
        let share = match file_frame {
            100..140 => (file_frame - 100) as f64 / 40.0,
            140..200 => (200 - file_frame) as f64 / 60.0,
            _ => 0.0,
        };
        let map = before.edited.rotation(frame, elbow).conjugate() * after.edited.rotation(frame, elbow);
        let expected = DQuat::from_axis_angle(axis, share * angle);
        assert!(map.dot(expected).abs() > 1.0 - 1e-15, "frame {frame}: {map} for {expected}");
        for id in after.clip.skeleton.ids().filter(|&id| id != elbow) {
            assert_eq!(before.edited.rotation(frame, id), after.edited.rotation(frame, id), "frame {frame}");
        }
    }
    // Nothing that bears on a leg has changed, so nothing was carried or held anew.
    assert!(Arc::ptr_eq(&before.carried, &after.carried) && Arc::ptr_eq(&before.foot_numbers, &after.foot_numbers));
    assert!(!Arc::ptr_eq(&before.measures, &after.measures));
    assert!(document.undo());
    assert!(Arc::ptr_eq(&document.solved().carried, &before.carried) && document.solved().to_bvh() == before.to_bvh());
}

#[test]
fn feet_stand_where_a_carrier_that_layers_move_takes_them() {
    let mut document = opened(&[], Some("circle"));
    let solved = Arc::clone(document.solved());
    let hips = joint(&solved, "Hips");
    for (frame, angle) in [(60, 0.25), (150, -0.2), (300, 0.3), (450, -0.25)] {
        apply(&mut document, turn(frame, hips, DVec3::new(0.0, 0.6, 0.8), angle));
        let by = solved.clip.facts.height.value * 0.04 * DVec3::new(angle.signum(), -0.5, 0.3);
        let moved = carrier_moved(document.solved(), frame, by);
        apply(&mut document, moved);
    }
    let solved = document.solved();
    assert_eq!(solved.missed_plants().count(), 0);
    for numbers in solved.foot_numbers.iter() {
        let (speed, slip) = (numbers.planted_speed.expect("it stands"), numbers.slip_p90.expect("it stands"));
        println!("speed {:.4} → {:.4}, slip {:.4} → {:.4}", speed.source, speed.edited, slip.source, slip.edited);
        assert!(speed.edited < 1.02 * speed.source + 1e-9 && slip.edited < 1.05 * slip.source + 1e-9);
    }
}

#[test]
fn a_body_crouches_over_feet_that_stay_where_they_stand() {
    for (shape, keys) in [("circle", &[(60, 0.0), (100, -0.1), (140, 0.0)][..]), ("original", &[(0, -0.08)])] {
        let mut document = opened(&[], Some(shape));
        let before = Arc::clone(document.solved());
        let height = before.clip.facts.height.value;
        let mut layer = Layer::new("crouch");
        keys.iter().for_each(|&(frame, by)| layer.position.set(frame, DVec3::new(0.0, by * height, 0.0)));
        let layer = toml::Value::Array(vec![toml::Value::try_from(&layer).expect("a value")]);
        set(&mut document, &[&format!("layer={layer}")], None);
        let after = document.solved();
        assert_eq!(after.missed_plants().count(), 0);
        let mut lowest = 0.0f64;
        for frame in 0..after.edited.n_frames() {
            let [was, is] = [&before, after].map(|solved| world(solved, frame));
            lowest = lowest.min((is[0].translation.y - was[0].translation.y) / height);
            for foot in &after.walked.plants {
                if foot.plants.iter().any(|plant| (plant.first..=plant.last).contains(&frame)) {
                    let ankle = foot.leg.ankle.idx();
                    let off = is[ankle].translation.distance(was[ankle].translation) / height;
                    assert!(off < 1e-6, "{shape}, frame {frame}: the foot moves by {off} body heights");
                    let turned = is[ankle].rotation.conjugate() * was[ankle].rotation;
                    assert!(turned.xyz().length() < 1e-6, "{shape}, frame {frame}: the foot turns");
                }
            }
        }
        let asked = keys.iter().map(|key| key.1).fold(0.0, f64::min);
        assert!((lowest - asked).abs() < 0.01, "{shape}: the carrier is down by {lowest} of {asked} body heights");
    }
}

#[test]
fn merged_layers_come_back_from_the_file() {
    let folder = tempfile::tempdir().expect("a folder");
    let mut document = opened(&[], Some("eight"));
    let solved = Arc::clone(document.solved());
    let height = solved.clip.facts.height.value;
    for (frame, name, angle) in [(50, "Chest", 0.3), (120, "LeftKnee", -0.2), (260, "Chest", -0.4), (300, "Hips", 0.2)]
    {
        apply(&mut document, turn(frame, joint(&solved, name), DVec3::new(0.0, 0.6, 0.8), angle));
    }
    let moved = carrier_moved(document.solved(), 90, DVec3::Y * 0.03);
    apply(&mut document, moved);
    set(&mut document, &["path.nudge=0.2"], None);
    let unmerged = Arc::clone(document.solved());
    apply(&mut document, Change::Layer(LayerChange::Merge { layer_idx: 0 }));
    assert!(document.edits().layers[0].merged);
    assert!(apart(&unmerged, document.solved()) == 0.0, "merging changes no pose");
    let refused = document.apply(&turn(50, joint(&solved, "Chest"), DVec3::X, 0.1), false).expect_err("it is frozen");
    assert!(refused.to_string().contains("merged into the motion"), "{refused}");

    let file = folder.path().join("merged.bvh");
    document.export(&file, false).expect("written");
    let mut again = Document::new(open(Some(&file)).expect("a clip"));
    set(&mut again, &["path.edited=false"], None);
    let off = apart(&unmerged, again.solved());
    println!("merged, exported, read: off by {:e} body heights", off / height);
    assert!(off < 1e-6 * height, "off by {off}");

    // The project comes back the same, byte for byte.
    let project = folder.path().join("walk.toml");
    document.save(&project).expect("saved");
    let text = std::fs::read_to_string(&project).expect("written");
    let opened = open(Some(&project)).expect("opens");
    assert_eq!(opened.edits, **document.edits());
    Document::new(opened).save(&project).expect("saved again");
    assert_eq!(std::fs::read_to_string(&project).expect("written"), text);
    assert!(
        text.contains("[[layer]]\nname = \"layer 1\"\non = true\n")
            && text.contains("\nrotation.Chest = [\n    { frame = "),
        "{text}"
    );
}

#[test]
fn keys_repeat_with_every_cycle_and_seams_stay_closed() {
    let mut document = opened(&["timing.cycling=blended"], Some("circle:3"));
    let before = Arc::clone(document.solved());
    let range = before.walked.repeat.expect("it is cycled").range;
    let frame = range.first + range.n_frames() / 2;
    let again = frame + range.n_frames();
    assert_eq!(before.source_frame(frame), before.source_frame(again));
    apply(&mut document, turn(frame, joint(&before, "Neck"), DVec3::Y, 0.5));
    let after = document.solved();
    let neck = joint(after, "Neck");
    let map = |frame| before.edited.rotation(frame, neck).conjugate() * after.edited.rotation(frame, neck);
    assert!(map(frame).dot(map(again)).abs() > 1.0 - 1e-12 && map(frame).w < 0.99);
    let worst = |solved: &Solved| solved.measures.seam.iter().map(|seam| seam.position_share()).fold(0.0, f64::max);
    assert!(worst(after) < worst(&before) + 0.05, "{} after {}", worst(after), worst(&before));
}

#[test]
fn interpolation_keys_are_played_and_exported_when_asked() {
    for (sets, shape) in [(&["path.edited=false"][..], None), (&[], Some("circle"))] {
        let mut document = opened(sets, shape);
        let own = document.solved().to_bvh();
        let before = Arc::clone(document.solved());
        set(&mut document, &["interpolation_keys=[100, 160]"], None);
        assert_eq!(document.edits().interpolation_keys, Some(InterpolationKeys { first: 100, last: 160 }));
        let solved = document.solved();
        assert!(solved.to_bvh() == own, "unasked, the clip's own motion is written");
        assert!(solved.to_bvh_interpolated() != own);
        let rest = solved.clip.rest_frames();
        let elbow = joint(solved, "RightElbow");
        let [a, b] = [100, 160].map(|f| before.edited.rotation(f - rest, elbow));
        let middle = solved.edited.rotation(130 - rest, elbow);
        assert!(middle.dot(a.slerp(b, 0.5)).abs() > 1.0 - 1e-12);
        for frame in [50, 100 - rest, 160 - rest, 300] {
            let off = world(solved, frame)
                .into_iter()
                .zip(world(&before, frame))
                .map(|(a, b)| a.translation.distance(b.translation));
            let off = off.fold(0.0, f64::max);
            // Feet are held anew where a neighbouring plant has changed.
            let bar = if shape.is_none() { 1e-12 } else { 0.02 };
            assert!(off < bar * before.clip.facts.height.value, "frame {frame}: {off}");
        }
        set(&mut document, &["interpolation_keys=[]"], None);
        assert!(document.solved().to_bvh() == own);
    }
}

#[test]
fn the_clips_own_data_can_be_cleared_and_the_path_stays() {
    for shape in [None, Some("circle")] {
        let sets: &[&str] = if shape.is_some() { &["plants.hold=off"] } else { &["path.edited=false"] };
        let mut document = opened(sets, shape);
        let before = Arc::clone(document.solved());
        set(&mut document, &["clip.clear_position=true"], None);
        let solved = Arc::clone(document.solved());
        assert!(Arc::ptr_eq(&solved.original, &before.original) && Arc::ptr_eq(&solved.new_path, &before.new_path));
        for frame in [0, 100, 400] {
            let expected =
                if shape.is_some() { solved.new_frame(frame).translation } else { before.carrier(0).translation };
            assert!(solved.carrier(frame).translation.distance(expected) < 1e-12);
            assert!(solved.carrier(frame).rotation.dot(before.carrier(frame).rotation).abs() > 1.0 - 1e-12);
        }
        set(&mut document, &["clip.clear_position=false", "clip.clear_rotation=true"], None);
        let solved = document.solved();
        for id in solved.clip.skeleton.ids().filter(|&id| id != solved.clip.facts.carrier.value) {
            assert_eq!(solved.edited.rotation(200, id), DQuat::IDENTITY);
        }
        // Keys make a motion on what is left.
        let hips = joint(solved, "Hips");
        apply(&mut document, turn(200, hips, DVec3::Y, PI / 2.0));
        assert!(document.solved().to_bvh() != before.to_bvh());
        set(&mut document, &["clip.clear_rotation=false", "layer=[]"], None);
        assert!(document.solved().to_bvh() == before.to_bvh());
    }
}

#[test]
fn the_result_does_not_depend_on_the_way() {
    let mut document = opened(&[], Some("circle"));
    let solved = Arc::clone(document.solved());
    let steps: Vec<Change> = vec![
        turn(40, joint(&solved, "Chest"), DVec3::Y, 0.4),
        turn(80, joint(&solved, "LeftHip"), DVec3::X, 0.2),
        Change::Layer(LayerChange::Interpolate { layer_idx: 0, interpolation: Interpolation::EulerCubic }),
        carrier_moved(&solved, 70, DVec3::Y * -0.02),
        Change::Layer(LayerChange::Weigh { layer_idx: 0, weight: 0.7 }),
        Change::Layer(LayerChange::Add { name: "arms".to_owned() }),
        Change::Pose {
            layer_idx: 1,
            frame_idx: 60,
            change: PoseChange::Turn { joint: joint(&solved, "LeftShoulder"), axis: DVec3::Z, angle_rad: 0.6 },
        },
        Change::Layer(LayerChange::Move { layer_idx: 1, up: false }),
        Change::Layer(LayerChange::Switch { layer_idx: 1, on: false }),
        Change::Layer(LayerChange::Rename { layer_idx: 0, name: "wave".to_owned() }),
        Change::Layer(LayerChange::ClearPosition { layer_idx: 1 }),
        Change::Layer(LayerChange::Switch { layer_idx: 1, on: true }),
    ];
    for step in steps {
        apply(&mut document, step.clone());
        let at_once = document::solve(&document.solved().source, document.edits(), None);
        assert!(apart(&at_once, document.solved()) < 1e-12, "after {step:?}");
        assert_eq!(at_once.to_bvh(), document.solved().to_bvh(), "after {step:?}");
        assert_eq!(at_once.measures, document.solved().measures, "after {step:?}");
        assert_eq!(at_once.foot_numbers, document.solved().foot_numbers, "after {step:?}");
    }
    while document.undo() {}
    let fresh = Document::new(Opened { edits: (**document.edits()).clone(), ..open(None).expect("the built-in clip") });
    assert!(fresh.solved().to_bvh() == document.solved().to_bvh());
}

#[test]
fn what_cannot_be_done_is_said() {
    let mut document = opened(&[], None);
    let solved = Arc::clone(document.solved());
    let selection = Selection { position: false, joints: ["Chest".to_owned()].into() };
    let keys = |layer_idx, change| Change::Keys { layer_idx, selection: selection.clone(), change };
    let mut refused = |change: Change, words: &str| {
        let edits = Arc::clone(document.edits());
        let error = document.apply(&change, false).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(**document.edits(), *edits, "nothing is half done");
    };
    refused(keys(3, KeyChange::Add { frame: 10 }), "no such layer");
    refused(keys(0, KeyChange::Delete { frame: 10 }), "no");
    refused(keys(0, KeyChange::Add { frame: 100_000 }), "outside the clip");
    refused(
        reach(10, joint(&solved, "LeftWrist"), vec![joint(&solved, "LeftKnee")], DVec3::ZERO),
        "nothing is selected",
    );
    refused(Change::Layer(LayerChange::Delete { layer_idx: 0 }), "no such layer");
    apply(&mut document, Change::Layer(LayerChange::Add { name: String::new() }));
    apply(&mut document, Change::Layer(LayerChange::Switch { layer_idx: 0, on: false }));
    let edits = Arc::clone(document.edits());
    for (change, words) in [
        (turn(10, joint(&solved, "Chest"), DVec3::X, 0.1), "is off"),
        (Change::Layer(LayerChange::Merge { layer_idx: 0 }), "is off"),
        (Change::Layer(LayerChange::Move { layer_idx: 0, up: true }), "cannot move"),
    ] {
        let error = document.apply(&change, false).expect_err(words).to_string();
        assert!(error.contains(words), "{error}");
        assert_eq!(**document.edits(), *edits);
    }
    for (setting, words) in [
        ("interpolation_keys=[100, 100000]", "interpolation_keys: 100000 is beyond the clip's end"),
        (
            "layer=[{name = \"far\", position = [{frame = 100000, value = [0, 1, 0]}]}]",
            "far has keys from file frame 100000",
        ),
        (
            "layer=[{name = \"far\", rotation = {Chest = [{frame = 99999, value = [1, 0, 0, 0]}]}}]",
            "from file frame 99999",
        ),
    ] {
        set(&mut document, &[setting], None);
        let warnings = &document.solved().warnings;
        assert!(warnings.iter().any(|w| w.contains(words)), "{warnings:?}");
    }
    let nameless = parse_assignment("layer=[{name = \" \"}]").expect("an assignment");
    let refused = document.apply(&Change::Set { values: vec![nameless], shape: None }, false).expect_err("no name");
    assert!(refused.to_string().contains("a layer needs a name"), "{refused}");
    set(
        &mut document,
        &["interpolation_keys=[]", "layer=[{name = \"a\", rotation = {Nobody = [{frame = 3, value = [1, 0, 0, 0]}]}}]"],
        None,
    );
    assert!(document.solved().warnings.iter().any(|w| w.contains("there is no joint Nobody")));
}
