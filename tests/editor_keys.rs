//! Key triples: a clip, keys, the state that follows.

use std::collections::HashSet;

use glam::DVec3;
use walkabout::{
    document::{self, Change, Document},
    editor::{COMMANDS, Command, Editor, Effect, Group, RowKind, TABS},
};

fn editor() -> Editor {
    let opened = document::open(None).expect("the built-in clip opens");
    Editor::new(Document::new(opened), Vec::new())
}

/// The state as one line: tab, selected row, point, frame, camera, undo depth.
fn state(editor: &Editor) -> String {
    let view = editor.view();
    let row = editor.rows().into_iter().find(|r| r.selected);
    let (behind, ahead) = editor.document().depth();
    format!(
        "{} | {} | point {} | frame {} | camera {} | undo {behind} redo {ahead}",
        TABS[view.tab_idx].title(),
        row.map_or_else(String::new, |r| format!("{} {}", r.label, r.value)),
        view.point_idx + 1,
        view.frame_idx,
        view.camera_idx + 1,
    )
}

#[track_caller]
fn check(keys: &str, expected: &str) {
    let mut editor = editor();
    editor.keys(keys);
    assert_eq!(state(&editor), expected, "after {keys}");
}

#[test]
fn rows_are_chosen_and_stepped() {
    check("", "path | path.edited on | point 1 | frame 0 | camera 1 | undo 0 redo 0");
    check("j", "path | path.degree 3 | point 1 | frame 0 | camera 1 | undo 0 redo 0");
    check("j+", "path | path.degree 4 | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("jj+", "path | path.points 9 | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("jj+<tab>u", "original | original.degree auto | point 1 | frame 0 | camera 1 | undo 0 redo 1");
    let auto = editor().document().solved().original.degree();
    for (keys, degree) in [("<tab>+", auto + 1), ("<tab>]", auto + 10), ("<tab>++-", auto + 1)] {
        let mut e = editor();
        e.keys(keys);
        assert_eq!(e.document().solved().original.degree(), degree, "{keys}: auto steps from the degree in use");
    }
    check("jj]", "path | path.points 18 | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("j<backspace>", "path | path.degree 3 | point 1 | frame 0 | camera 1 | undo 0 redo 0");
    check("+", "path | path.edited off | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("kk", "path | path.edited on | point 1 | frame 0 | camera 1 | undo 0 redo 0");
}

#[test]
fn held_keys_are_one_step_and_another_key_ends_it() {
    check("jj+++u", "path | path.points 8 | point 1 | frame 0 | camera 1 | undo 0 redo 1");
    check("jj++-+u", "path | path.points 9 | point 1 | frame 0 | camera 1 | undo 2 redo 1");
    check("jj++kj+uu", "path | path.points 8 | point 1 | frame 0 | camera 1 | undo 0 redo 2");
    let mut slow = editor();
    slow.keys("jj+");
    slow.advance(5.0);
    slow.keys("+");
    assert_eq!(slow.document().depth(), (2, 0), "presses far apart are steps of their own");
}

#[test]
fn undo_and_redo_reach_everything() {
    check("jj+<tab>j+uuUU", "original | residual.frame tangent | point 1 | frame 0 | camera 1 | undo 2 redo 0");
    check("uU", "path | path.edited on | point 1 | frame 0 | camera 1 | undo 0 redo 0");
}

#[test]
fn undo_and_redo_say_what_they_did() {
    let message = |e: &Editor| e.view().message.as_ref().map_or(String::new(), |message| message.text.clone());
    for (keys, what) in [
        ("x", "control point moved"),
        ("i", "control point inserted"),
        ("d", "control point deleted"),
        ("sc", "shape circle"),
        ("jj+", "path.points"),
        ("lmc", "left plant mode"),
        ("Bn", "layer added"),
        ("<tab><tab><tab><tab>gci", "keys added"),
        ("vgaR", "view as it came"),
    ] {
        let mut e = editor();
        e.keys(keys);
        e.keys("u");
        assert_eq!(message(&e), format!("undone: {what} (0 behind, 1 ahead)"), "after {keys}");
        e.keys("U");
        assert_eq!(message(&e), format!("redone: {what} (1 behind, 0 ahead)"), "after {keys}");
    }
    let mut e = editor();
    e.keys("u");
    assert_eq!(message(&e), "nothing to undo");
    e.keys("U");
    assert_eq!(message(&e), "nothing to redo");
}

#[test]
fn coordinates_are_offered_short_and_kept_to_the_last_digit() {
    let mut e = editor();
    e.keys("c0.1 0.2 0.3<enter>");
    e.keys("xx");
    let (before, height) = (e.document().solved().control_points()[0], e.document().solved().clip.facts.height.value);
    e.keys("c");
    let offered = e.prompt().expect("it asks").text.clone();
    assert!(offered.len() < 40 && offered.split(' ').all(|number| number.len() <= 13), "{offered}");
    let read: Vec<f64> = offered.split(' ').map(|number| number.parse().expect("a number")).collect();
    assert!((DVec3::from_slice(&read) - before).abs().max_element() <= 1e-9 * height);
    let edits = e.document().edits().clone();
    e.keys("<enter>");
    assert_eq!(e.document().edits(), &edits, "what is confirmed stays as it is");
    e.keys("c<left><right><enter>");
    assert_eq!(e.document().edits(), &edits);
    // The list of the points is offered with nine digits; what it leaves out is kept as well.
    e.keys(":path.nudge=0.12345678912345<enter>");
    let edits = e.document().edits().clone();
    e.keys("kkkkkkkkkkkkkkkkkkkkjjj");
    assert!(e.rows().iter().any(|row| row.selected && row.label == "path.nudge"));
    e.keys("<enter><enter>");
    assert_eq!(e.document().edits(), &edits);
}

#[test]
fn values_are_typed() {
    check("j<enter>7<enter>", "path | path.degree 7 | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("j<enter>7<esc>", "path | path.degree 3 | point 1 | frame 0 | camera 1 | undo 0 redo 0");
    check(
        ":original.degree=13<enter><tab>",
        "original | original.degree 13 | point 1 | frame 0 | camera 1 | undo 1 redo 0",
    );
    let mut carrier = editor();
    carrier.keys(":clip.carrier=Hisp<enter>");
    assert!(carrier.prompt().is_some(), "a wrong name can be corrected");
    assert!(carrier.view().message.as_ref().is_some_and(|m| m.text.contains("did you mean `Hips`? (the joints are ")));
    assert_eq!(carrier.document().edits().clip.carrier, None);
    let mut wrong = editor();
    wrong.keys("j<enter>99<enter>");
    assert!(wrong.prompt().is_some(), "a wrong value can be corrected");
    assert!(wrong.view().message.as_ref().is_some_and(|m| m.text.contains("1 to 9")));
    wrong.keys("<backspace><enter>");
    assert_eq!(wrong.document().edits().path.degree, 9);
}

#[test]
fn points_are_chosen_moved_typed_inserted_and_deleted() {
    let mut e = editor();
    let before = e.document().solved().control_points();
    let step = 0.1 * e.document().solved().clip.facts.height.value;
    e.keys("nn");
    assert_eq!(e.view().point_idx, 2);
    e.keys("xxY");
    let after = e.document().solved().control_points();
    let moved = after[2] - before[2];
    assert!((moved - DVec3::new(2.0 * step, -step, 0.0)).length() < 1e-9 * step, "{moved}");
    assert_eq!(e.document().depth(), (2, 0));
    e.keys("c1 2 -3.5<enter>");
    assert_eq!(e.document().solved().control_points()[2], DVec3::new(1.0, 2.0, -3.5));
    e.keys("i");
    assert_eq!((e.document().solved().control_points().len(), e.view().point_idx), (9, 3));
    e.keys("dd");
    assert_eq!(e.document().solved().control_points().len(), 7);
    e.keys("dddddd");
    assert_eq!(e.document().solved().control_points().len(), 4);
    assert!(e.view().message.as_ref().is_some_and(|m| m.text.contains("at least 4")));
    e.keys("r");
    assert_eq!(e.document().edits().path.control_points, None);
}

#[test]
fn selecting_a_point_row_selects_the_point() {
    check(
        "jjjjjj",
        "path | ◆ point 3 0.00 0.00 0.00 | point 3 | frame 0 | camera 1 | undo 0 redo 0"
            .replace("0.00 0.00 0.00", &point_text(2))
            .as_str(),
    );
    check("n", &format!("path | ◆ point 2 {} | point 2 | frame 0 | camera 1 | undo 0 redo 0", point_text(1)));
}

fn point_text(point_idx: usize) -> String {
    let e = editor();
    let label = format!("point {}", point_idx + 1);
    e.rows().into_iter().find(|r| r.label.ends_with(&label)).expect("a row for each point").value
}

#[test]
fn ready_shapes_take_two_keys() {
    for keys in ["sl", "sh", "so", "sc", "sz", "se", "su", "ss"] {
        let mut e = editor();
        e.keys(keys);
        assert!(e.document().edits().path.control_points.is_some(), "{keys}");
        assert_eq!(e.document().depth(), (1, 0), "{keys}");
        let original = e.document().solved().original.length();
        let length = e.document().solved().new_path.length();
        // The chord joins the ends, `original` is a fit; the others are exactly as long as the original path.
        if !["sh", "so"].contains(&keys) {
            assert!((length / original - 1.0).abs() < 1e-9, "{keys}: {length} against {original}");
        }
    }
}

#[test]
fn a_key_cycles_without_a_seam_and_goes_through_the_loops() {
    let mut document = Document::new(document::open(None).expect("the built-in clip opens"));
    let long = Change::Set { values: Vec::new(), shape: Some("circle:3".parse().expect("a shape")) };
    document.apply(&long, false).expect("a change");
    let mut e = Editor::new(document, Vec::new());
    let said = |e: &Editor| e.view().message.as_ref().map_or_else(String::new, |m| m.text.clone());
    let range = |e: &Editor| e.document().solved().walked.repeat.map(|r| (r.range.first, r.range.end));
    assert_eq!(range(&e), None);
    e.keys("R");
    let best: Vec<_> = (e.document().solved().loops.as_ref().expect("found").best.iter())
        .map(|found| (found.range.first, found.range.end))
        .collect();
    assert!(best.len() > 2);
    assert_eq!(range(&e), Some(best[0]));
    assert!(said(&e).starts_with(&format!("loop: file frames {} to {}, ", best[0].0, best[0].1)), "{}", said(&e));
    e.keys("R");
    assert_eq!(range(&e), Some(best[1]));
    assert_eq!(e.document().depth(), (3, 0), "the shape, cycling, a loop");
    e.keys(&"R".repeat(best.len() - 1));
    assert_eq!(range(&e), Some(best[0]), "after the last one the best again");
    e.keys("u<c-r>uu");
    assert_eq!(range(&e), Some(best[best.len() - 2]));

    // The same from the list.
    e.keys("<tab><tab>");
    let wanted = RowKind::Loop { loop_idx: 2 };
    let down = e.rows().iter().position(|row| row.kind == wanted).expect("listed");
    e.keys(&format!("{}<enter>", "j".repeat(down)));
    assert_eq!(range(&e), Some(best[2]));
    assert!(e.rows().iter().any(|row| row.kind == wanted && row.label.starts_with('◆') && row.selected));
    // A short path needs no cycle, and says so.
    e.keys("scR");
    assert_eq!(range(&e), None);
    assert!(said(&e).ends_with("the path is no longer than the clip"), "{}", said(&e));
}

#[test]
fn unfinished_sequences_wait_and_nonsense_is_told() {
    let mut e = editor();
    e.keys("s");
    assert_eq!(e.pending().len(), 1);
    assert!(e.hints().iter().any(|h| h.keys == ["c"] && h.doc.contains("circle")));
    e.keys("<esc>");
    assert_eq!(e.pending().len(), 0);
    e.keys("s!");
    assert!(e.view().message.as_ref().is_some_and(|m| m.text.starts_with("s! does nothing")));
    for (keys, why) in [
        ("s!", "s! does nothing here; ? shows the keys"),
        ("e", "e does nothing here; it does on the joints tab"),
        ("D", "D does nothing here; it does on the joints tab"),
        ("O", "O does nothing here; there are no interpolation keys; I sets them"),
        ("Bm", "Bm does nothing here; there is no layer yet; Bn makes one"),
    ] {
        let mut e = editor();
        e.keys(keys);
        assert_eq!(e.view().message.as_ref().map(|m| m.text.as_str()), Some(why));
    }
}

#[test]
fn help_begins_with_what_the_open_tab_is_about() {
    for (tab, group) in
        [("path", Group::Play), ("feet", Group::Feet), ("joints", Group::Joints), ("layers", Group::Layers)]
    {
        let mut e = editor();
        let tab_idx = TABS.iter().position(|t| t.title() == tab).expect("a tab");
        e.keys(&"<tab>".repeat(tab_idx));
        let hints = e.hints();
        assert_eq!(hints[0].group, group, "{tab}");
        let n_groups = 1 + hints.windows(2).filter(|pair| pair[0].group != pair[1].group).count();
        let different: HashSet<&str> = hints.iter().map(|hint| hint.group.title()).collect();
        assert_eq!(n_groups, different.len(), "{tab}: each group stands together");
    }
}

#[test]
fn help_is_read_whole_on_a_narrow_terminal() {
    let width = |text: &str| text.chars().count();
    let keys = |command: &Command| width(&command.keys.join(" "));
    let longest = COMMANDS.iter().map(keys).max().expect("commands");
    for command in COMMANDS {
        // The last column is for the sign that there is more.
        assert!(longest + 2 + width(command.doc) < 80, "{}: {}", command.name, command.doc);
    }
}

#[test]
fn the_playhead_steps_jumps_and_plays() {
    let n = editor().document().solved().edited.n_frames();
    let frame = |keys: &str| {
        let mut e = editor();
        e.keys(keys);
        e.view().frame_idx
    };
    assert_eq!(frame("..,"), 1);
    assert_eq!(frame(","), n - 1, "stepping back from the start goes to the end");
    assert_eq!(frame("$"), n - 1);
    assert_eq!(frame("$0"), 0);
    let mut e = editor();
    let dt = e.document().solved().clip.frame_time_secs;
    e.keys("<space>");
    assert!(e.view().playing);
    e.advance(10.25 * dt);
    assert_eq!(e.view().frame_idx, 10);
    e.keys("<lt><lt>");
    e.advance(4.0 * dt);
    assert_eq!(e.view().frame_idx, 12, "half speed");
    e.advance(1e12);
    assert!(e.view().frame_idx < n);
}

#[test]
fn quitting_asks_only_when_there_is_something_to_lose() {
    assert_eq!(editor().keys("q"), Effect::Quit);
    let mut e = editor();
    assert_eq!(e.keys("xq"), Effect::None);
    assert!(e.prompt().is_some());
    assert_eq!(e.keys("n"), Effect::None);
    assert!(e.prompt().is_none());
    assert_eq!(e.keys("qy"), Effect::Quit);
    assert_eq!(e.keys("uq"), Effect::Quit);
    for looking in ["2", "H", "<pageup>", "ax", "f", "vg", "V4", "<lt>", "T"] {
        let mut e = editor();
        e.keys(looking);
        assert!(!e.document().is_modified(), "{looking}");
        assert_eq!(e.keys("q"), Effect::Quit, "{looking} is no work to lose");
        assert_eq!(editor().keys(&format!("x{looking}q")), Effect::None, "{looking}");
    }
}

#[test]
fn projects_and_clips_are_written_and_never_overwritten_unasked() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("walk.toml");
    let clip = folder.path().join("out.bvh");
    let type_name = |file: &std::path::Path| file.display().to_string().replace('<', "<lt>");
    let mut e = editor();
    e.keys("scS");
    e.keys(&format!("{}<enter>", type_name(&project)));
    assert!(!e.document().is_modified());
    e.keys(&format!("E{}<enter>", type_name(&clip)));
    let bytes = std::fs::read(&clip).expect("exported");
    assert_eq!(bytes, e.document().solved().to_bvh());

    let bare = folder.path().join("bare");
    e.keys(&format!("A{}<enter>", type_name(&bare)));
    assert_eq!(e.document().project(), Some(folder.path().join("bare.toml").as_path()), "it opens again as a project");
    e.keys(&format!("A{}<enter>y", type_name(&project)));

    let opened = document::open(Some(&project)).expect("the project opens");
    assert_eq!(opened.edits, **e.document().edits());

    e.keys(&format!("xE{}<enter>", type_name(&clip)));
    assert!(e.prompt().is_some(), "an existing file is asked about");
    e.keys("n");
    assert_eq!(std::fs::read(&clip).expect("still there"), bytes);
    e.keys(&format!("E{}<enter>y", type_name(&clip)));
    assert_ne!(std::fs::read(&clip).expect("replaced"), bytes);
    e.keys("S");
    assert!(!e.document().is_modified(), "the document's own project is saved without a question");
}
