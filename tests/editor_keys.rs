//! Key triples: a clip, keys, the state that follows.

use glam::DVec3;
use walkabout::{
    contact::{PlantEditMode, PlantMode},
    document::{self, Change, Document},
    editor::{COMMANDS, Editor, Effect, RowKind, TABS, Window},
    link::check_scene,
    scene::{Object, Role},
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
fn values_are_typed() {
    check("j<enter>7<enter>", "path | path.degree 7 | point 1 | frame 0 | camera 1 | undo 1 redo 0");
    check("j<enter>7<esc>", "path | path.degree 3 | point 1 | frame 0 | camera 1 | undo 0 redo 0");
    check(
        ":original.degree=13<enter><tab>",
        "original | original.degree 13 | point 1 | frame 0 | camera 1 | undo 1 redo 0",
    );
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
fn cameras_are_chosen_moved_and_reset() {
    let mut e = editor();
    e.keys("3");
    assert_eq!(e.view().camera_idx, 2);
    let eye = |e: &Editor| e.scene().now.views[0].camera.eye;
    let start = eye(&e);
    e.keys("LLL");
    assert!(eye(&e).distance(start) > 0.0);
    assert_eq!(e.document().depth(), (0, 0), "cameras are not history");
    e.keys("1");
    let three_quarter = eye(&e);
    e.keys("3");
    assert!(eye(&e).distance(start) > 0.0, "an edited preset is kept");
    e.keys("ar");
    assert_eq!(eye(&e), start);
    e.keys("1");
    assert_eq!(eye(&e), three_quarter);
    for keys in ["H", "J", "K", "<a-left>", "<a-up>", ")", "(", "ax", "ay", "az", "o", "f", "t"] {
        let mut e = editor();
        e.keys(&keys.repeat(40));
        let camera = e.scene().now.views[0].camera;
        let sight = (camera.target - camera.eye).normalize();
        assert!(sight.is_finite() && camera.up.cross(sight).length() > 1e-3, "{keys}: {camera:?}");
    }
}

#[test]
fn every_drawn_object_can_be_hidden() {
    let full = editor().scene();
    for (keys, same) in [
        ("vo", 0),
        ("vn", 0),
        ("vO", 0),
        ("vN", 0),
        ("vc", 0),
        ("vT", 0),
        ("vt", 0),
        ("vg", 0),
        ("vl", 0),
        ("vr", 0),
        ("vf", 0),
    ] {
        let mut e = editor();
        e.keys(keys);
        let scene = e.scene();
        assert_eq!(usize::from(scene.still == full.still && scene.now == full.now), same, "{keys} changes the picture");
    }
}

/// The views of the window in use: camera and hidden objects of each, the one in focus in brackets.
fn views(e: &Editor) -> String {
    let window = ["view", "second"][usize::from(e.window() == Window::Second)];
    let text =
        |name: String| document::show_value(&document::parameter(&name).expect("a row").get(e.document().edits()));
    let views = e.scene().now.views;
    let one = |n: usize| {
        let (camera, hide) = (text(format!("{window}.{n}.camera")), text(format!("{window}.{n}.hide")));
        let view = format!("{camera} {}", hide.replace(['"', ','], ""));
        if views[n - 1].focused { format!("[{view}]") } else { view }
    };
    (1..=views.len()).map(one).collect::<Vec<_>>().join(" | ")
}

#[track_caller]
fn check_views(keys: &str, expected: &str) {
    let mut e = editor();
    e.keys(keys);
    assert_eq!(views(&e), expected, "after {keys}");
    assert_eq!(e.document().depth(), (0, 0), "views are not history");
}

#[test]
fn a_window_is_divided_and_the_focus_goes_round() {
    check_views("", "1 []");
    check_views("V2", "[1 []] | 2 []");
    check_views("V4", "[1 []] | 2 [] | 3 [] | 4 []");
    check_views("V4VnVn", "1 [] | 2 [] | [3 []] | 4 []");
    check_views("V4VnVnVnVn", "[1 []] | 2 [] | 3 [] | 4 []");
    check_views("V4VnVnVnV2", "1 [] | [2 []]");
    check_views("V4VnV1", "1 []");
    let mut e = editor();
    e.keys("Vn");
    assert!(message(&e).starts_with("Vn does nothing"), "{}", message(&e));
    e.keys("V2Vn");
    assert_eq!(message(&e), "view 2");
}

#[test]
fn cameras_are_those_of_the_view_in_focus() {
    check_views("3", "3 []");
    check_views("V2Vn4", "1 [] | [4 []]");
    let mut e = editor();
    e.keys("V4Vn");
    let eyes = |e: &Editor| e.scene().now.views.iter().map(|v| v.camera.eye).collect::<Vec<_>>();
    for keys in ["L", "<a-left>", ")", "o", "f", "."] {
        let before = e.scene().now.views;
        e.keys(keys);
        let after = e.scene().now.views;
        let changed: Vec<_> = (0..4).filter(|&n| before[n] != after[n]).collect();
        // A frame later only the camera that follows is elsewhere.
        assert_eq!(changed, [1], "{keys}");
    }
    let other = eyes(&e)[2];
    e.keys("3");
    assert_eq!(eyes(&e)[1], other, "two views may share a camera");
    e.keys("Vn)");
    assert_eq!(eyes(&e)[1], eyes(&e)[2], "and then both see it move");
}

#[test]
fn following_begins_and_ends_with_the_picture_as_it_is() {
    let mut e = editor();
    let camera = |e: &Editor| e.scene().now.views[0].camera;
    e.keys("....................t");
    let (seen, frame) = (camera(&e), e.view().frame_idx);
    e.keys("f");
    assert!(camera(&e).eye.distance(seen.eye) < 1e-9 && camera(&e).target.distance(seen.target) < 1e-9);
    e.keys("....................");
    assert!(camera(&e).eye.distance(seen.eye) > 1.0, "it goes along");
    let gone = camera(&e);
    e.keys("f");
    assert!(e.view().frame_idx > frame && camera(&e).eye.distance(gone.eye) < 1e-9);
}

#[test]
fn a_view_hides_and_shows_for_itself() {
    check_views("V4Vnvg", "1 [] | [2 [ground]] | 3 [] | 4 []");
    check_views("V4Vnvgvovg", "1 [] | [2 [original_skeleton]] | 3 [] | 4 []");
    // Traces are drawn nowhere at first: they come into this view, and into no other.
    check_views("V2Vnvr", "1 [traces] | [2 []]");
    check_views("V2VnvrVnvr", "[1 []] | 2 []");
    let mut e = editor();
    e.keys("V2Vnvg");
    assert_eq!(message(&e), "view.2 hides ground");
    let shows = |e: &Editor, object| e.scene().now.views.iter().map(|v| v.shows.contains(object)).collect::<Vec<_>>();
    assert_eq!(shows(&e, Object::Ground), [true, false]);
    assert!(e.document().edits().view.show.ground);
    e.keys("VnV1vg");
    assert!(!e.document().edits().view.show.ground, "one view shows what show.* says");
    e.keys("vgVnV2V1");
    assert_eq!(shows(&e, Object::Ground), [true]);
}

#[test]
fn every_drawn_object_can_be_hidden_in_a_view() {
    for command in COMMANDS.iter().filter(|c| c.name.starts_with("show.")) {
        let mut e = editor();
        e.keys(&format!("V4VnVn{}", command.keys[0]));
        let shows: Vec<_> = e.scene().now.views.iter().map(|v| v.shows).collect();
        let (changed, others) = (shows[2], [shows[0], shows[1], shows[3]]);
        assert!(others.iter().all(|other| *other == others[0]) && changed != others[0], "{}: {shows:?}", command.name);
        let still = e.scene().still;
        e.keys("V1");
        assert!(std::sync::Arc::ptr_eq(&still, &e.scene().still), "views are no part of it");
    }
}

#[test]
fn each_window_has_views_of_its_own() {
    let mut e = editor();
    e.keys("V4Vn");
    e.use_window(Window::Second);
    assert_eq!(views(&e), "1 []");
    assert_eq!(e.view_in_focus(), "second window ");
    e.keys("V23vt");
    assert_eq!(views(&e), "[3 [new_tracker]] | 2 []");
    e.focus_view(1);
    e.focus_view(3);
    assert_eq!(e.view_in_focus(), "second window view 2 ", "there is no fourth view");
    let camera = |e: &Editor, window| e.scene_in(window).now.views[1].camera;
    let before = camera(&e, Window::First);
    e.wheel(3);
    assert_ne!(camera(&e, Window::Second).eye, before.eye, "the wheel zooms");
    e.use_window(Window::First);
    assert_eq!(views(&e), "1 [] | [2 []] | 3 [] | 4 []");
    e.keys("x");
    let seen = |window| e.scene_in(window);
    assert!(std::sync::Arc::ptr_eq(&seen(Window::First).still, &seen(Window::Second).still), "both follow edits");
    assert_eq!(seen(Window::First).now.actors, seen(Window::Second).now.actors);
    assert_eq!(e.keys("Vw"), Effect::ToggleSecondWindow);
    assert_eq!(e.keys("w"), Effect::ToggleWindow);
}

#[test]
fn two_views_side_by_side_hold_the_whole_motion_though_each_is_narrow() {
    let mut e = editor();
    // The widest path, seen from the front.
    e.keys("scV22");
    let distance = |e: &Editor| {
        let camera = e.scene().now.views[0].camera;
        camera.eye.distance(camera.target)
    };
    let narrow = distance(&e);
    e.keys("V4");
    let wide = distance(&e);
    assert!(narrow > 1.5 * wide, "{narrow} and {wide}");
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

#[test]
fn the_still_part_is_new_only_when_it_changes() {
    let mut e = editor();
    let first = e.scene().still;
    e.keys("...1234<tab>");
    assert!(std::sync::Arc::ptr_eq(&first, &e.scene().still));
    e.keys("x");
    assert_ne!(first.revision, e.scene().still.revision);
}

/// A foot's plants: first and last frame, and mode.
type Plants = Vec<(usize, usize, PlantMode)>;

/// The chosen foot's plants; the chosen one's index first.
fn plants(editor: &Editor) -> (usize, Plants) {
    let (foot_idx, plant_idx) = editor.chosen_plant().expect("the built-in clip has plants");
    let plants = &editor.document().solved().feet.plants[foot_idx].plants;
    (plant_idx, plants.iter().map(|p| (p.first, p.last, p.mode)).collect())
}

fn selected_row(editor: &Editor) -> walkabout::editor::Row {
    editor.rows().into_iter().find(|r| r.selected).expect("a selected row")
}

fn message(editor: &Editor) -> String {
    editor.view().message.as_ref().map_or_else(String::new, |m| m.text.clone())
}

#[test]
fn plants_are_walked_and_the_playhead_follows() {
    let mut e = editor();
    let (chosen, left) = plants(&e);
    assert_eq!((chosen, left[0].0), (0, 0), "it stands when the clip begins");
    for idx in 1..left.len() {
        e.keys("l");
        assert_eq!((e.view().frame_idx, plants(&e).0), (left[idx].0, idx));
        assert!(message(&e).starts_with(&format!("left plant {} of {}: ", idx + 1, left.len())), "{}", message(&e));
    }
    e.keys("l");
    assert_eq!(e.view().frame_idx, 0, "round at the end");
    e.keys("hh");
    assert_eq!(plants(&e).0, left.len() - 2);
    // Between two plants the next and the one before are the neighbours.
    e.keys("0l,,");
    assert_eq!(e.view().frame_idx, left[1].0 - 2);
    e.keys("h");
    assert_eq!(e.view().frame_idx, left[0].0);
    e.keys("l,,l");
    assert_eq!(e.view().frame_idx, left[1].0);
    e.keys("F");
    assert_eq!(e.view().frame_idx, left[1].0, "choosing a foot leaves the playhead");
    let right = plants(&e).1;
    assert_ne!(right, left);
    e.keys("0l");
    assert_eq!(e.view().frame_idx, right[1].0);
    e.keys("FF");
    assert_eq!(plants(&e).1, right);
    assert_eq!(e.document().depth(), (0, 0), "looking is no edit");
}

#[test]
fn ends_of_plants_move_by_frames_and_are_shown() {
    let mut e = editor();
    e.keys("ll");
    let (_, before) = plants(&e);
    let (first, last, mode) = before[2];
    let now = |e: &Editor| plants(e).1[2];
    e.keys("5");
    assert_eq!((now(&e), e.view().frame_idx), ((first - 1, last, mode), first - 1));
    e.keys("666");
    assert_eq!((now(&e), e.view().frame_idx), ((first + 2, last, mode), first + 2));
    e.keys("8");
    assert_eq!((now(&e), e.view().frame_idx), ((first + 2, last + 1, mode), last + 1));
    e.keys("777");
    assert_eq!((now(&e), e.view().frame_idx), ((first + 2, last - 2, mode), last - 2));
    assert_eq!(e.document().depth(), (4, 0), "a held key is one step");
    e.keys("u");
    assert_eq!(now(&e), (first + 2, last + 1, mode));
    e.keys("uuu");
    assert_eq!(plants(&e).1, before);
    assert!(e.document().edits().edited_plants.is_empty());
    e.keys("5");
    e.keys(&"5".repeat(400));
    assert_eq!(now(&e).0, before[1].1 + 2, "a frame stays free between two plants");
    assert_eq!(message(&e), "that end of the plant cannot move further");
}

#[test]
fn plants_are_split_joined_deleted_and_added_and_undone() {
    let start = editor();
    let before = plants(&start).1;
    let n = before.len();
    let (first, last, mode) = before[1];
    let check = |keys: &str, expected: &dyn Fn(&mut Plants)| {
        let mut e = start.clone();
        e.keys(keys);
        let mut wanted = before.clone();
        expected(&mut wanted);
        assert_eq!(plants(&e).1, wanted, "after {keys}: {}", message(&e));
        assert_eq!(e.document().depth().0, 1, "after {keys}");
        e.keys("u");
        assert_eq!(plants(&e).1, before, "undone: {keys}");
    };
    check("l...mx", &|p| {
        p[1].1 = first + 2;
        p.insert(2, (first + 4, last, mode));
    });
    check("lmj", &|p| p[1].1 = p.remove(2).1);
    check("lmd", &|p| {
        p.remove(1);
    });
    check("l,,,,,,ma", &|p| p.insert(1, (first - 6, first - 2, mode)));
    let refused = |keys: &str, why: &str| {
        let mut e = start.clone();
        e.keys(keys);
        assert!(message(&e).contains(why), "after {keys}: {}", message(&e));
        assert_eq!((plants(&e).1.len(), e.document().depth()), (n, (0, 0)));
    };
    refused("lmx", "split at a frame between");
    refused("hmj", "no next plant");
    refused("lma", "stands here already");
    refused("mr", "as found");
}

#[test]
fn modes_are_set_by_keys_and_on_the_panel_and_taken_back() {
    let mode = |keys: &str| {
        let mut e = editor();
        e.keys("l");
        e.keys(keys);
        plants(&e).1[1].2
    };
    assert_eq!(mode("mc"), PlantMode::Clean);
    assert_eq!(mode("ms"), PlantMode::Slide);
    assert_eq!(mode("msmh"), PlantMode::Hold);
    assert_eq!(mode("mcu"), PlantMode::Hold);
    let mut e = editor();
    e.keys("<tab><tab><tab>");
    assert_eq!(TABS[e.view().tab_idx].title(), "feet");
    assert_eq!(selected_row(&e).label, "plants.hold");
    let selected = selected_row;
    while !selected(&e).label.ends_with("plant 2") {
        e.keys("j");
    }
    assert_eq!(e.view().frame_idx, plants(&e).1[1].0, "the playhead goes to the selected plant");
    assert_eq!(selected(&e).label, "◆ plant 2");
    e.keys("+");
    assert!(selected(&e).value.ends_with(" clean") && selected(&e).changed, "{:?}", selected(&e));
    e.keys("-8");
    assert!(selected(&e).value.ends_with(" hold") && selected(&e).changed, "{:?}", selected(&e));
    e.keys("l");
    assert_eq!(selected(&e).label, "◆ plant 3", "the selection goes along");
    e.keys("h<backspace>");
    assert!(!selected(&e).changed, "as found");
    e.keys("0kkkkkkkkkk");
    assert_eq!(selected(&e).label, "plants.hold");
    e.keys("l");
    assert_eq!(selected(&e).label, "◆ plant 2", "walking goes to the plant's row");
    e.keys("lmdmr");
    assert!(e.document().edits().edited_plants.is_empty() && e.rows().iter().all(|r| !r.changed));
    e.keys("md");
    assert_eq!(e.document().edits().edited_plants[0].mode, PlantEditMode::None);
}

#[test]
fn edited_plants_are_saved_and_come_back() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("walk.toml");
    let mut e = editor();
    e.keys("lmcl8Flmdsc");
    e.keys(&format!("S{}<enter>", project.display()));
    assert_eq!(e.document().edits().edited_plants.len(), 3);
    let text = std::fs::read_to_string(&project).expect("saved");
    assert_eq!(text.matches("[[plant]]\nfoot = ").count(), 3, "{text}");
    let opened = document::open(Some(&project)).expect("the project opens");
    assert_eq!(opened.edits, **e.document().edits());
    let again = Editor::new(Document::new(opened), Vec::new());
    assert_eq!(again.document().solved().feet.plants, e.document().solved().feet.plants);
}

#[test]
fn legs_are_typed_whole_and_wrong_ones_are_told() {
    let mut e = editor();
    let legs = "[{ side = \"left\", hip = \"RightHip\", knee = \"RightKnee\", ankle = \"Nowhere\" }]";
    e.keys(&format!(":clip.legs={}<enter>", legs.replace(' ', "<space>")));
    assert!(message(&e).contains("\"Nowhere\""), "{}", message(&e));
    let clip = TABS.iter().position(|tab| tab.title() == "clip").expect("a tab");
    e.keys(&"<tab>".repeat(clip));
    let row = e.rows().iter().position(|r| r.label == "clip.legs").expect("a row");
    e.keys(&"j".repeat(row));
    e.keys("<enter>");
    assert_eq!(e.prompt().expect("typing").text, legs, "the list is offered, not its length");
}

#[test]
fn the_up_direction_goes_round_and_the_camera_still_orbits() {
    let mut e = editor();
    let up = |e: &Editor| e.scene().now.views[0].camera.up;
    let eye = |e: &Editor| e.scene().now.views[0].camera.eye;
    let seen: Vec<DVec3> = (0..3).map(|_| (e.keys("au"), up(&e)).1).collect();
    assert_eq!(seen, [DVec3::Z, DVec3::X, DVec3::Y]);
    // From the front z is along the line of sight, from above y is.
    e.keys("2");
    let seen: Vec<DVec3> = (0..2).map(|_| (e.keys("au"), up(&e)).1).collect();
    assert_eq!(seen, [DVec3::X, DVec3::Y]);
    e.keys("4");
    let seen: Vec<DVec3> = (0..2).map(|_| (e.keys("au"), up(&e)).1).collect();
    assert_eq!(seen, [DVec3::X, DVec3::Z]);
    for keys in ["1au", "1auau", "4auK", "2au"] {
        let mut e = editor();
        e.keys(keys);
        let (up, before) = (up(&e), eye(&e));
        e.keys(&"L".repeat(9));
        let target = e.scene().now.views[0].camera.target;
        let turned = (before - target).reject_from(up).angle_between((eye(&e) - target).reject_from(up));
        assert!((turned - std::f64::consts::FRAC_PI_2).abs() < 1e-9, "{keys}: a quarter round up, not {turned}");
        e.keys(&"L".repeat(27));
        assert!(eye(&e).distance(before) < 1e-9 * before.length(), "{keys}");
        e.keys(&"K".repeat(40));
        assert_eq!((self::up(&e), check_scene(&e.scene())), (up, Ok(())), "{keys}");
        assert!((eye(&e) - target).angle_between(up) < 0.03, "{keys}: over the pole it stops");
    }
}

fn up(editor: &Editor) -> DVec3 {
    editor.scene().now.views[0].camera.up
}

#[test]
fn in_slow_motion_no_frame_is_skipped_and_between_keys_it_is_slower() {
    let mut e = editor();
    let frame_secs = e.document().solved().clip.frame_time_secs;
    let played = |e: &mut Editor, n: usize, secs: f64| -> Vec<usize> {
        (0..n).map(|_| (e.advance(secs), e.view().frame_idx).1).collect()
    };
    e.keys("T<space>");
    assert!(e.scene().now.caption.contains("slow"));
    assert_eq!(played(&mut e, 4, 5.0 * frame_secs), [1, 2, 3, 4]);
    e.keys("T<home>");
    assert_eq!(played(&mut e, 2, 5.0 * frame_secs), [5, 10]);
    e.keys(":interpolation_keys=[2, 4]<enter><home>T");
    assert!(e.view().message.as_ref().is_some_and(|m| m.text.contains("interpolation keys")));
    let frames = played(&mut e, 23, 1.000001 * frame_secs);
    let seen = |frame: usize| frames.iter().filter(|&&f| f == frame).count();
    assert_eq!([1, 2, 3, 4].map(seen), [1, 10, 10, 1]);
}

#[test]
fn bones_trails_and_the_normal_skeleton_are_shown_when_asked() {
    let mut e = editor();
    let plain = e.scene();
    assert!(plain.now.actors[2].is_empty() && plain.still.bodies.iter().all(|body| !body.wireframe));
    e.keys("vw");
    assert!(e.scene().still.bodies.iter().all(|body| body.wireframe));
    assert_ne!(e.scene().still.revision, plain.still.revision, "a preview is told");
    e.keys("vwvr.........");
    let scene = e.scene();
    let trails: Vec<_> = scene.still.curves.iter().filter(|c| c.role == Role::Trace).collect();
    let marks: Vec<_> = scene.now.marks.iter().filter(|m| m.role == Role::Trace).collect();
    assert_eq!((trails.len(), marks.len()), (5, 5), "hands, feet and head");
    for (trail, mark) in trails.iter().zip(&marks) {
        assert_eq!(trail.points[9], mark.at, "the mark is at the playhead");
    }
    e.keys("vz");
    let scene = e.scene();
    let solved = e.document().solved();
    let carrier = solved.clip.facts.carrier.value.idx();
    let normal = &scene.now.actors[2];
    assert!(normal[carrier].distance(scene.now.actors[1][carrier]) < 1e-9);
    for id in solved.clip.skeleton.ids() {
        let joint = solved.clip.skeleton.joint(id);
        if let Some(parent) = joint.parent {
            let bone = normal[id.idx()] - normal[parent.idx()];
            assert!(bone.distance(joint.offset) < 1e-9, "{} hangs as its OFFSET says", joint.name);
        }
    }
    assert!(scene.now.labels.iter().any(|label| label.text == "normal"));
    assert_eq!(check_scene(&scene), Ok(()));
}

#[test]
fn the_view_is_reset_in_one_step_that_can_be_undone() {
    let mut e = editor();
    let camera = |e: &Editor| e.scene().now.views[0].camera;
    let came = camera(&e);
    e.keys("aR");
    assert_eq!(e.document().depth(), (0, 0), "there is nothing to reset");
    e.keys("sc<gt>vgHHHnn2f<tab>jj.....T");
    let (moved, depth) = (e.document().edits().view.clone(), e.document().depth());
    e.keys("aR");
    assert_eq!(
        state(&e),
        format!("path | path.edited on | point 1 | frame 0 | camera 1 | undo {} redo 0", depth.0 + 1)
    );
    assert!(!e.view().slow_motion && e.document().edits().view.show.ground);
    assert_eq!((e.document().edits().timing.speed, e.document().edits().path.points > 8), (1.0, true));
    e.keys("rvlvl");
    e.keys("u");
    let framed = camera(&e);
    assert_ne!(framed, came, "the circle is framed");
    e.keys("u");
    assert_eq!((&e.document().edits().view, e.document().depth().0), (&moved, depth.0));
    assert!(e.document().edits().timing.speed > 1.0);
    e.keys("U");
    assert_eq!(camera(&e), framed);
}

/// Opens a clip of a spine that glides along.
fn without_legs() -> Editor {
    let channels = "CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation";
    let mut text = format!("HIERARCHY\nROOT Hips\n{{\nOFFSET 0 0 0\n{channels}\nEnd Site\n{{\nOFFSET 0 60 0\n}}\n}}\n");
    text += "MOTION\nFrames: 30\nFrame Time: 0.04\n";
    (0..30).for_each(|frame| text += &format!("{} 90 0 0 0 0\n", 3 * frame));
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("spine.bvh");
    std::fs::write(&file, text).expect("written");
    Editor::new(Document::new(document::open(Some(&file)).expect("a clip")), Vec::new())
}

#[test]
fn keys_of_feet_say_why_there_is_nothing_to_do() {
    let said = |e: &Editor| e.view().message.as_ref().expect("a message").text.clone();
    let no_legs = "no legs found: edited without holding; clip.legs names them";
    assert_eq!(said(&without_legs()), no_legs, "told when the clip is opened");
    for keys in ["l", "h", "5", "8", "m", "F"] {
        let mut e = without_legs();
        e.keys(keys);
        assert_eq!(said(&e), format!("{keys} does nothing here; {no_legs}"));
    }
    let none = |foot: &str| format!("{{foot='{foot}', first=0, last=9999, mode='none'}}");
    let plants = document::parse_assignment(&format!("plant=[{}, {}]", none("left"), none("right")));
    let mut document = Document::new(document::open(None).expect("the built-in clip opens"));
    let deleted = Change::Set { values: vec![plants.expect("plants")], shape: None };
    document.apply(&deleted, false).expect("a list of plants");
    let mut e = Editor::new(document, Vec::new());
    e.keys("l");
    assert_eq!(said(&e), "l does nothing here; the left foot has no plants; ma adds one");
    e.keys("maF");
    assert!(said(&e).contains("right"), "{}", said(&e));
    e.keys("m");
    e.keys("!");
    assert_eq!(said(&e), "m! does nothing here; ? shows the keys");
}
