//! Cameras, views, windows and what they show, by key.

use glam::DVec3;
use walkabout::{
    document::{self, Document},
    editor::{COMMANDS, Editor, Effect, Window},
    link::check_scene,
    scene::{Object, Role},
};

fn editor() -> Editor {
    let opened = document::open(None).expect("the built-in clip opens");
    Editor::new(Document::new(opened), Vec::new())
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
fn a_view_is_labelled_by_where_it_is_seen_from_and_camera_keys_say_so() {
    for (keys, title) in [
        ("ax", "1 along x, orthographic"),
        ("ay", "1 along y, orthographic"),
        ("az", "1 along z, orthographic"),
        ("azo", "1 along z, perspective"),
        ("<pageup><a-left>", "1 three-quarter, perspective"),
        ("H", "1 turned, perspective"),
        ("HL", "1 three-quarter, perspective"),
        ("Har", "1 three-quarter, perspective"),
        ("2", "2 front, orthographic"),
        ("2ax", "2 along x, orthographic"),
        ("2axaz", "2 front, orthographic"),
        ("3f", "3 side, orthographic, following"),
        ("4K", "4 turned, orthographic"),
    ] {
        let mut e = editor();
        e.keys(keys);
        assert_eq!(e.scene().now.views[0].title, title, "after {keys}");
        assert!(message(&e).starts_with(&format!("camera {title}")), "after {keys}: {}", message(&e));
        let hint = e.view().message.as_ref().map_or("", |message| message.hint);
        let moved = !keys.ends_with('2');
        assert_eq!(hint.contains("the window (w) and the picture (b) show"), moved, "after {keys}");
        let caption = e.scene().now.caption;
        assert!(caption.contains(&message(&e)) && !caption.contains("(w)"), "who sees the picture knows: {caption}");
    }
}

#[test]
fn camera_keys_say_what_they_did() {
    for (keys, told) in [
        (")", "camera 1 three-quarter, perspective: zoomed in ×1.14"),
        ("2(", "camera 2 front, orthographic: zoomed out ×0.88"),
        ("<a-left>", "camera 1 three-quarter, perspective: panned left"),
        ("<a-down>", "camera 1 three-quarter, perspective: panned down"),
        ("L", "camera 1 turned, perspective: orbited right"),
        ("K", "camera 1 turned, perspective: orbited up"),
        ("az", "camera 1 along z, orthographic: looks along z"),
        ("t", "camera 1 three-quarter, perspective: looks at the carrier"),
        ("Lar", "camera 1 three-quarter, perspective: as it came"),
        ("o", "camera 1 three-quarter, orthographic (camera.1.projection)"),
        ("3f", "camera 3 side, orthographic, following (camera.3.follow)"),
        ("ff", "camera 1 three-quarter, perspective, standing still (camera.1.follow)"),
        ("V2Vn)", "view 2 camera 2 front, orthographic: zoomed in ×1.14"),
    ] {
        let mut e = editor();
        e.keys(keys);
        assert_eq!(message(&e), told, "after {keys}");
    }
}

#[test]
fn toggles_answer_in_words_and_with_the_name_to_set_it_by() {
    for (keys, told) in [
        ("vr", "traces: on (show.traces)"),
        ("vo", "original skeleton: off (show.original_skeleton)"),
        ("P", "walks the new path: off (path.edited)"),
        ("C", "cycling: plain (timing.cycling)"),
        ("<gt>", "speed: 1.41 times (timing.speed)"),
        ("G", "axes: view (pose.axes)"),
        ("}", "step: 0.141 body heights (path.nudge)"),
        ("V4", "4 views (view.layout)"),
        ("V2vg", "view 1 hides ground (view.1.hide)"),
        ("V2VnvTvT", "view 2 shows original tracker (view.2.hide)"),
        ("BP", "the clip's own position data: cleared (clip.clear_position)"),
        ("BRBR", "the clip's own rotation data: in use again (clip.clear_rotation)"),
    ] {
        let mut e = editor();
        // Axes are those of the joints tab.
        e.keys(if keys == "G" { "<tab><tab><tab><tab>" } else { "" });
        e.keys(keys);
        assert_eq!(message(&e), told, "after {keys}");
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
    assert_eq!(message(&e), "view 2 hides ground (view.2.hide)");
    let shows = |e: &Editor, object| e.scene().now.views.iter().map(|v| v.shows.contains(object)).collect::<Vec<_>>();
    assert_eq!(shows(&e, Object::Ground), [true, false]);
    assert!(e.document().edits().view.show.ground);
    e.keys("VnV1vg");
    assert!(!e.document().edits().view.show.ground, "one view shows what show.* says");
    e.keys("vgVnV2V1");
    assert_eq!(shows(&e, Object::Ground), [true]);
}

#[test]
fn what_comes_into_one_window_comes_into_no_other() {
    let in_window = |e: &Editor, window| -> Vec<bool> {
        e.scene_in(window).now.views.iter().map(|view| view.shows.contains(Object::Traces)).collect()
    };
    for keys in ["vr", "V2vr"] {
        let mut e = editor();
        e.use_window(Window::Second);
        e.keys(keys);
        assert!(in_window(&e, Window::Second)[0], "{keys}");
        assert_eq!(in_window(&e, Window::First), [false], "{keys}");
        // There they can be shown as well, and are no more when pressed again.
        e.use_window(Window::First);
        e.keys("vr");
        assert_eq!(in_window(&e, Window::First), [true], "{keys}");
        assert!(in_window(&e, Window::Second)[0], "{keys}");
    }
}

#[test]
fn a_picture_of_all_shows_all_from_every_side_until_it_is_zoomed() {
    let height = |e: &Editor| match e.scene().now.views[0].camera.projection {
        walkabout::scene::Projection::Orthographic { height } => height,
        walkabout::scene::Projection::Perspective { .. } => panic!("looking along an axis is orthographic"),
    };
    let mut e = editor();
    e.keys("sc4");
    let top = height(&e);
    e.keys("1ay");
    assert!((height(&e) / top - 1.0).abs() < 1e-9, "{} {top}", height(&e));
    e.keys("ax");
    let side = height(&e);
    e.keys("3");
    assert!((height(&e) / side - 1.0).abs() < 1e-9);
    // What is zoomed keeps its scale.
    e.keys("1)");
    let zoomed = height(&e);
    e.keys("ay");
    assert!((height(&e) / zoomed - 1.0).abs() < 1e-9);
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
fn the_still_part_is_new_only_when_it_changes() {
    let mut e = editor();
    let first = e.scene().still;
    e.keys("...1234<tab>");
    assert!(std::sync::Arc::ptr_eq(&first, &e.scene().still));
    e.keys("x");
    assert_ne!(first.revision, e.scene().still.revision);
}

fn message(editor: &Editor) -> String {
    editor.view().message.as_ref().map_or_else(String::new, |m| m.text.clone())
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
    let view = e.view();
    assert_eq!((view.tab_idx, view.point_idx, view.frame_idx, view.camera_idx), (0, 0, 0, 0));
    assert_eq!(e.document().depth(), (depth.0 + 1, 0));
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
