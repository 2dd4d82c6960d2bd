//! What is shown of a pose whose feet are held as soon as a key is pressed, and what becomes of it when the keys rest.

mod walking;

use std::sync::Arc;

use glam::DVec3;
use walkabout::{
    document::{Change, Document, Solved, open},
    editor::Editor,
    skeleton::JointId,
};
use walking::{apart, apply, captured, carrier_moved, joint, joints, opened, place, reach, set, turn, world};

const HAND_CHAIN: &[&str] = &["Hips", "Spine", "Chest", "LeftShoulder", "LeftElbow"];
const FOOT_CHAIN: &[&str] = &["Hips", "LeftHip", "LeftKnee"];

/// A document that shows drafts.
fn drafting(sets: &[&str], shape: &str) -> Document {
    let mut document = opened(sets, Some(shape));
    document.show_drafts();
    document
}

/// Changes of a pose on which held feet bear: the joint that each is about, and where it is to be.
fn changes(solved: &Solved, frame: usize) -> Vec<(&'static str, Change, Option<DVec3>)> {
    let height = solved.clip.facts.height.value;
    let by = |name: &str, way: [f64; 3]| place(solved, frame, name) + height * DVec3::from_array(way);
    let moved = |point, chain: &[&str], way| {
        let to = by(point, way);
        (point, reach(frame, joint(solved, point), joints(solved, chain), to), Some(to))
    };
    let down = [0.01, -0.02, 0.01];
    vec![
        moved("LeftWrist", HAND_CHAIN, [0.02, 0.01, -0.02]),
        moved("LeftAnkle", &FOOT_CHAIN[1..], [0.0, 0.02, 0.01]),
        moved("LeftAnkle", FOOT_CHAIN, [0.01, 0.02, 0.0]),
        ("Hips", carrier_moved(solved, frame, height * DVec3::from_array(down)), Some(by("Hips", down))),
        ("Hips", turn(frame, joint(solved, "Hips"), DVec3::Y, 0.1), None),
    ]
}

/// The largest distance between what two solves show at a frame, body heights.
fn apart_at(a: &Solved, b: &Solved, frame: usize) -> f64 {
    let pairs = world(a, frame).into_iter().zip(world(b, frame));
    pairs.map(|(a, b)| a.translation.distance(b.translation)).fold(0.0, f64::max) / a.clip.facts.height.value
}

/// The largest step from frame to frame of a cycle by which the way of a joint from one solve to the other changes, body
/// heights.
fn largest_jump(a: &Solved, b: &Solved) -> f64 {
    let ways: Vec<Vec<DVec3>> = (0..a.edited.n_frames())
        .map(|frame| world(a, frame).iter().zip(world(b, frame)).map(|(a, b)| b.translation - a.translation).collect())
        .collect();
    let pairs = ways.windows(2).enumerate().filter(|(frame, _)| !a.timing.seams.contains(&(frame + 1)));
    let jumps = pairs.flat_map(|(_, pair)| pair[0].iter().zip(&pair[1]).map(|(a, b)| a.distance(*b)));
    jumps.fold(0.0, f64::max) / a.clip.facts.height.value
}

#[test]
fn a_pose_is_seen_at_once_and_the_whole_clip_follows_when_keys_rest() {
    let [plain, blended] = ["timing.cycling=plain", "timing.cycling=blended"].map(|set| [set]);
    for (sets, shape, frames) in
        [(&[][..], "circle", &[0, 200, 479][..]), (&blended[..], "circle:3", &[700]), (&plain, "circle:3", &[720])]
    {
        for &frame in frames {
            let names = drafting(sets, shape);
            for (idx, (name, ..)) in changes(names.solved(), frame).into_iter().enumerate() {
                let case = format!("{shape} {sets:?} frame {frame} {name} {idx}");
                let mut document = drafting(sets, shape);
                let before = Arc::clone(document.solved());
                let (_, change, target) = changes(&before, frame).swap_remove(idx);
                apply(&mut document, change);
                let seen = Arc::clone(document.solved());
                assert!(!seen.is_whole() && !seen.is_measured(), "{case}");
                assert!(document.measure() && !document.measure(), "{case}");
                let all = Arc::clone(document.solved());
                assert!(all.is_whole() && all.is_measured() && document.depth() == (2, 0), "{case}");

                let off = |solved: &Solved| {
                    target.map_or(0.0, |to| place(solved, frame, name).distance(to) / before.clip.facts.height.value)
                };
                let (moved, settles) = (apart_at(&before, &all, frame), apart_at(&seen, &all, frame));
                let [jump, later] = [&seen, &all].map(|solved| largest_jump(&before, solved));
                println!(
                    "{case}: moved {moved:.4}, seen {:.1e} off, {settles:.1e} to come, jump {jump:.1e} and {later:.1e}, then {:.1e} off",
                    off(&seen),
                    off(&all)
                );
                assert!(moved > 0.005, "{case}: it is seen");
                // At the clip's ends holding is harder to foresee, and what is searched for is not found at once.
                let [near, far] = if [0, 479].contains(&frame) { [1e-2, 2e-2] } else { [1e-4, 2e-3] };
                assert!(off(&seen) < near && settles < far, "{case}: {} off, {settles} to come", off(&seen));
                assert!(off(&all) < 1e-4, "{case}: {} off", off(&all));
                assert!(jump < 1.2 * later + 0.05 * moved, "{case}: what is shown jumps by {jump}");
            }
        }
    }
}

#[test]
fn frames_far_from_the_pose_wait_for_the_keys_to_rest() {
    let mut document = drafting(&["timing.cycling=blended"], "circle:3");
    let before = Arc::clone(document.solved());
    let (_, change, _) = changes(&before, 300).swap_remove(3);
    apply(&mut document, change);
    let seen = Arc::clone(document.solved());
    document.measure();
    // One key moves the carrier everywhere.
    for frame in [0, 30, before.edited.n_frames() - 1] {
        assert_eq!(apart_at(&before, &seen, frame), 0.0, "frame {frame}");
        assert!(apart_at(&before, document.solved(), frame) > 0.005, "frame {frame}");
    }
}

#[test]
fn what_needs_the_whole_clip_gets_it_without_waiting() {
    let folder = tempfile::tempdir().expect("a folder");
    let pressed = || {
        let mut document = drafting(&[], "circle");
        let (_, change, _) = changes(&Arc::clone(document.solved()), 200).swap_remove(0);
        apply(&mut document, change);
        assert!(!document.solved().is_whole());
        document
    };
    let mut rested = pressed();
    rested.measure();
    let edits = Arc::clone(rested.edits());

    let mut exported = pressed();
    let file = folder.path().join("walk.bvh");
    exported.export(&file, false).expect("written");
    assert_eq!(std::fs::read(&file).expect("readable"), rested.solved().to_bvh());

    let mut saved = pressed();
    let file = folder.path().join("walk.toml");
    saved.save(&file).expect("written");
    assert_eq!(open(Some(&file)).expect("opens").edits, *edits);

    let mut undone = pressed();
    assert!(undone.undo() && undone.redo());
    assert_eq!((undone.edits(), undone.solved().is_whole()), (&edits, true));

    let mut changed = pressed();
    let (_, change, _) = changes(&Arc::clone(changed.solved()), 100).swap_remove(0);
    apply(&mut changed, change);
    assert!(changed.undo());
    assert_eq!(changed.edits(), &edits, "a step that another follows is settled");
}

#[test]
fn steps_of_a_held_key_add_up_and_end_where_they_are_wanted() {
    let mut document = drafting(&[], "circle");
    let before = Arc::clone(document.solved());
    let height = before.clip.facts.height.value;
    let (wrist, chain) = (joint(&before, "LeftWrist"), joints(&before, HAND_CHAIN));
    let mut to = place(&before, 200, "LeftWrist");
    for n in 0..10 {
        to = place(document.solved(), 200, "LeftWrist") + 0.01 * height * DVec3::new(0.5, -0.4, 0.7);
        document.apply(&reach(200, wrist, chain.clone(), to), n > 0).expect("a change that can be made");
        assert!(!document.solved().is_whole());
    }
    document.measure();
    assert_eq!(document.depth(), (2, 0), "a shape and a step");
    let at = place(document.solved(), 200, "LeftWrist");
    assert!(at.distance(to) < 1e-4 * height, "{} off", at.distance(to) / height);
    let way = 0.1 * height * DVec3::new(0.5, -0.4, 0.7);
    let off = at.distance(place(&before, 200, "LeftWrist") + way) / height;
    assert!(off < 5e-3, "ten steps are ten times one: {off}");
    // What did not turn is as it was.
    let own = |solved: &Solved, name: &str| solved.edited.rotation(200, joint(solved, name));
    assert_eq!(own(document.solved(), "RightElbow"), own(&before, "RightElbow"));
    assert!(document.undo());
    assert_eq!(document.solved().to_bvh(), before.to_bvh());
}

#[test]
fn undo_and_redo_go_to_and_fro_without_solving_anew() {
    let mut document = drafting(&[], "circle");
    let before = Arc::clone(document.solved());
    let (_, change, _) = changes(&before, 200).swap_remove(0);
    apply(&mut document, change);
    document.measure();
    let after = Arc::clone(document.solved());
    for _ in 0..3 {
        assert!(document.undo());
        let now = document.solved();
        assert!(now.is_measured() && Arc::ptr_eq(&now.carried, &before.carried) && now.to_bvh() == before.to_bvh());
        assert!(Arc::ptr_eq(&now.measures, &before.measures) && !Arc::ptr_eq(&now.measures, &after.measures));
        assert!(document.redo());
        let now = document.solved();
        assert!(now.is_measured() && Arc::ptr_eq(&now.carried, &after.carried) && now.to_bvh() == after.to_bvh());
        assert!(Arc::ptr_eq(&now.measures, &after.measures));
    }
    // What was left longer ago is solved for.
    assert!(document.undo() && document.undo());
    let plain = opened(&[], None);
    assert_eq!(document.edits(), plain.edits());
    assert_eq!(document.solved().to_bvh(), plain.solved().to_bvh());
    assert!(document.redo() && document.redo() && document.measure());
    assert_eq!(document.solved().to_bvh(), after.to_bvh());
}

#[test]
fn a_point_that_does_not_get_there_is_told_when_that_is_known() {
    let mut e = Editor::new(opened(&[], Some("circle")), Vec::new());
    // A foot, its whole chain, far below the ground.
    e.keys("<tab><tab><tab><tab>gcgsgcgcgr:pose.nudge=0.3<enter>");
    e.show_drafts();
    let is_told = |e: &Editor| e.view().message.as_ref().is_some_and(|m| m.text.contains("reaches no farther: "));
    e.keys("Y");
    assert!(!e.document().solved().is_whole() && !is_told(&e), "{:?}", e.view().message);
    assert!(e.measure() && is_told(&e), "{:?}", e.view().message);
    // It is told once.
    e.keys("<esc>");
    assert!(!e.measure() && !is_told(&e));
}

#[test]
fn keys_pressed_in_a_hurry_do_what_they_do_at_leisure() {
    // A hand with its whole chain, and then at another frame, along another axis, of another joint, undone.
    for more in ["<end>y", "<home>Z", "y", "gpx", "gtx", "uy", "<tab><tab><s-tab><s-tab>X"] {
        let [hurried, leisurely] = [false, true].map(|rests| {
            let mut e = Editor::new(opened(&[], Some("circle")), Vec::new());
            e.keys("<tab><tab><tab><tab>gcgcgcgsgcgcgr............................................................");
            e.show_drafts();
            e.keys("xxxxx");
            if rests {
                e.measure();
            }
            e.keys(more);
            e.measure();
            e
        });
        assert_eq!(hurried.document().edits().layers, leisurely.document().edits().layers, "{more}");
    }
}

#[test]
fn a_search_is_given_up_in_a_hurry_and_made_another_time() {
    // A foot, its whole chain, far away.
    let mut document = drafting(&[], "circle");
    let before = Arc::clone(document.solved());
    let to = place(&before, 200, "LeftAnkle") + before.clip.facts.height.value * DVec3::new(0.1, -0.2, 0.0);
    let pull = reach(200, joint(&before, "LeftAnkle"), joints(&before, FOOT_CHAIN), to);
    apply(&mut document, pull.clone());
    let mut at_leisure = document.clone();
    assert!(at_leisure.measure());
    let seen = (Arc::clone(document.solved()), Arc::clone(document.edits()));
    let hurry = document.hurry();
    hurry.raise();
    assert!(!document.measure() && !document.solved().is_whole());
    assert!(Arc::ptr_eq(document.solved(), &seen.0) && Arc::ptr_eq(document.edits(), &seen.1));
    hurry.lower();
    assert!(document.measure() && document.solved().is_measured());
    assert_eq!(document.edits(), at_leisure.edits());

    // Whoever needs the result has no hurry.
    let mut saved = drafting(&[], "circle");
    apply(&mut saved, pull);
    saved.hurry().raise();
    let folder = tempfile::tempdir().expect("a folder");
    saved.save(&folder.path().join("walk.toml")).expect("written");
    assert!(saved.solved().is_whole());
    assert_eq!(saved.edits(), at_leisure.edits());
}

#[test]
fn a_turned_hip_turns_once() {
    let mut document = drafting(&[], "circle");
    let mut scripted = opened(&[], Some("circle"));
    let hips: JointId = joint(document.solved(), "Hips");
    for document in [&mut document, &mut scripted] {
        apply(document, turn(200, hips, DVec3::X, 0.1));
        document.measure();
    }
    assert_eq!(document.edits().layers, scripted.edits().layers);
    assert_eq!(apart(document.solved(), scripted.solved()), 0.0);
}

#[test]
fn a_captured_foot_ends_where_a_script_has_it() {
    let Some(file) = captured("cmu_08_01_brisk_walk") else { return };
    for frame in [120, 200, 276] {
        let [drafted, scripted] = [true, false].map(|drafts| {
            let mut document = Document::new(open(Some(&file)).expect("a clip"));
            set(&mut document, &[], Some("eight"));
            if drafts {
                document.show_drafts();
            }
            let before = Arc::clone(document.solved());
            let to = place(&before, frame, "LeftFoot") + 0.02 * before.clip.facts.height.value * DVec3::ONE;
            let chain = joints(&before, &["Hips", "LeftUpLeg", "LeftLeg"]);
            apply(&mut document, reach(frame, joint(&before, "LeftFoot"), chain, to));
            document.measure();
            (place(document.solved(), frame, "LeftFoot").distance(to) / before.clip.facts.height.value, document)
        });
        let height = drafted.1.solved().clip.facts.height.value;
        let apart = apart(drafted.1.solved(), scripted.1.solved()) / height;
        println!("frame {frame}: {:.1e} and {:.1e} off, {apart:.1e} apart", drafted.0, scripted.0);
        assert!(drafted.0 < 1e-4 && scripted.0 < 1e-4, "frame {frame}: {} and {} off", drafted.0, scripted.0);
    }
}

/// Whoever looked where a point is before its target had been searched for was left with what a few steps had found, up to
/// 0.1 body heights short.
#[test]
fn what_is_looked_at_too_soon_is_searched_for_all_the_same() {
    let Some(file) = captured("cmu_131_01_start_walk_stop") else { return };
    let clip = Document::new(open(Some(&file)).expect("a clip"));
    let mut document = clip.clone();
    set(&mut document, &[], Some("circle"));
    document.show_drafts();
    let before = Arc::clone(document.solved());
    let height = before.clip.facts.height.value;
    let frame = before.edited.n_frames() - 1;
    let chain = joints(&before, &["Hips", "LHipJoint", "LeftHip"]);
    let to = DVec3::new(10.17, 6.8, -42.6);
    let off = |document: &Document| place(document.solved(), frame, "LeftKnee").distance(to) / height;

    apply(&mut document, reach(frame, joint(&before, "LeftKnee"), chain, to));
    document.settle();
    assert!(document.solved().is_whole() && !document.is_settled());
    assert!(off(&document) > 1e-3, "a few steps are not enough: {}", off(&document));
    let mut exported = document.clone();
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.bvh");
    exported.export(&out, false).expect("can be written");
    assert!(document.measure() && document.is_settled() && !document.measure());
    assert!(off(&document) < 1e-4 && document.depth() == (2, 0), "{}", off(&document));
    assert!(std::fs::read(&out).expect("written") == document.solved().to_bvh(), "files have all of it");

    // What is undone is not searched for.
    let mut undone = exported;
    assert!(undone.undo());
    undone.measure();
    assert!(undone.edits().layers.is_empty() && undone.depth() == (1, 1));
}

#[test]
fn how_much_is_missing_is_told_also_to_whoever_pressed_another_key_meanwhile() {
    let mut editor = Editor::new(opened(&[], Some("circle")), Vec::new());
    editor.show_drafts();
    editor.keys("<tab><tab><tab><tab>gcgsgcgcgr");
    for _ in 0..3 {
        editor.keys("c<c-u>0 500 0<enter>");
        assert!(editor.view().message.as_ref().is_none_or(|m| !m.text.contains("no farther")));
        editor.keys("]");
        editor.measure();
        let message = editor.view().message.as_ref().map_or("", |message| &message.text);
        assert!(message.contains("reaches no farther"), "{message}");
        editor.keys("c<c-u>0 500 0<enter>u");
        editor.measure();
        let message = editor.view().message.as_ref().map_or("", |message| &message.text);
        assert!(!message.contains("reaches no farther"), "undone: {message}");
    }
}
