//! Joints and poses: what keys, clicks and drags select and move, as key triples.

use glam::{DQuat, DVec3};
use walkabout::{
    displace::{InterpolationKeys, PointValue, Selection},
    document::{self, Document},
    editor::{Editor, Handle, TABS, Tab},
    link::check_scene,
    math::Rigid,
    scene::{Ray, Role, Scene},
    skeleton::JointId,
};

fn editor() -> Editor {
    let opened = document::open(None).expect("the built-in clip opens");
    Editor::new(Document::new(opened), Vec::new())
}

fn message(editor: &Editor) -> String {
    editor.view().message.as_ref().map_or_else(String::new, |m| m.text.clone())
}

/// Which joints keys act on, as one line: the one that keys move, then the selected ones.
fn joints(editor: &Editor) -> String {
    let skeleton = &editor.document().solved().clip.skeleton;
    let name = |handle: Handle| match handle {
        Handle::Position => "position".to_owned(),
        Handle::Joint(id) => skeleton.joint(id).name.clone(),
    };
    let joints = &editor.view().joints;
    let selected: Vec<_> = joints.selected.iter().map(|&handle| name(handle)).collect();
    format!("{}: {}", name(joints.active), selected.join(" "))
}

#[track_caller]
fn check_joints(keys: &str, expected: &str) {
    let mut editor = editor();
    editor.keys(keys);
    assert_eq!(joints(&editor), expected, "after {keys}");
    assert_eq!(editor.document().depth(), (0, 0), "what is selected is not history");
}

#[test]
fn the_joint_tree_is_walked() {
    check_joints("", "Hips: ");
    check_joints("gc", "Spine: ");
    check_joints("gcgp", "Hips: ");
    check_joints("gp", "Hips: ");
    check_joints("gs", "Hips: ");
    check_joints("gcgs", "LeftHip: ");
    check_joints("gcgsgm", "RightHip: ");
    check_joints("gcgsgmgcgcgm", "LeftAnkle: ");
    check_joints("gcgS", "RightHip: ");
    check_joints("gcgsgsgs", "Spine: ");
    check_joints("gcgm", "Spine: ");
    check_joints("gcgcgcgcgc", "Head: ");
    let mut editor = editor();
    editor.keys("gp");
    assert_eq!(editor.view().message.as_ref().map(|m| m.text.as_str()), Some("there is no joint above Hips"));
}

#[test]
fn joints_are_selected() {
    check_joints("gt", "Hips: Hips");
    check_joints("gtgt", "Hips: ");
    check_joints("gcgcgr", "Chest: Hips Spine Chest");
    check_joints("gcgcgrgr", "Chest: ");
    check_joints("gcgcgtgr", "Chest: Hips Spine Chest");
    check_joints("gcgcgrgpgt", "Spine: Hips Chest");
    check_joints("gcgcgrgn", "Chest: ");
    let mut editor = editor();
    editor.keys("ga");
    let n_joints = editor.document().solved().clip.skeleton.n_joints();
    assert_eq!(editor.view().joints.selected.len(), n_joints + 1, "the carrier's position too");
    editor.keys("gcgcgtgi");
    assert_eq!(joints(&editor), "Chest: Chest");
    editor.keys("gngi");
    assert_eq!(editor.view().joints.selected.len(), n_joints + 1);
}

#[test]
fn the_joints_tab_and_the_joint_that_keys_move_go_together() {
    let row = |e: &Editor| e.rows().into_iter().find(|r| r.selected).map(|r| r.label.trim().to_owned());
    let mut e = editor();
    e.keys("<tab><tab><tab><tab>");
    assert_eq!((TABS[e.view().tab_idx].title(), row(&e).as_deref()), ("joints", Some("○ Hips")));
    e.keys("jjgt");
    assert_eq!((joints(&e).as_str(), row(&e).as_deref()), ("Chest: Chest", Some("◉ Chest")));
    e.keys("kkkgt");
    assert_eq!((joints(&e).as_str(), row(&e).as_deref()), ("position: position Chest", Some("◉ position of Hips")));
    e.keys("k");
    assert_eq!(row(&e).as_deref(), Some("◉ position of Hips"), "the first row");
    e.keys("<tab>gcgc<s-tab>");
    assert_eq!(row(&e).as_deref(), Some("◉ Chest"), "walked to from another tab");
}

#[test]
fn the_selection_is_seen_in_the_scene() {
    let count = |e: &Editor| {
        let scene = e.scene();
        check_scene(&scene).expect("a scene that can be shown");
        let limbs = scene.still.bodies.iter().flat_map(|b| &b.limbs).filter(|l| l.role == Role::SelectedJoint).count();
        let marks = |role| scene.now.marks.iter().filter(|m| m.role == role).count();
        (limbs, marks(Role::SelectedJoint), marks(Role::ActiveJoint))
    };
    let mut e = editor();
    assert_eq!(count(&e), (0, 0, 0));
    e.keys("gcgsgcgt");
    assert_eq!(count(&e), (1, 1, 0), "the left shin");
    let revision = e.scene().still.revision;
    e.keys("<tab><tab><tab><tab>");
    assert_eq!(count(&e), (1, 0, 1), "where joints are edited the one that keys move is seen too");
    e.keys("gc");
    assert_eq!(count(&e), (1, 1, 1));
    assert_eq!(e.scene().still.revision, revision, "walking makes nothing anew that stays");
    let skeleton = &e.document().solved().clip.skeleton;
    let knee = skeleton.find("LeftKnee").expect("a joint of the built-in walk");
    let scene = e.scene();
    let mark = scene.now.marks.iter().find(|m| m.role == Role::SelectedJoint).expect("just counted");
    assert_eq!(mark.at, scene.now.actors[1][knee.idx()]);
    e.keys("gn");
    assert_eq!(count(&e), (0, 0, 1));
}

/// Returns the ray of the view through a point of the new actor, moved by a share of the body height to the right.
fn ray_to(scene: &Scene, point: usize, aside: f64) -> Ray {
    let camera = scene.now.views[0].camera;
    let right = (camera.target - camera.eye).cross(camera.up).normalize();
    let to = scene.now.actors[1][point] + aside * scene.still.body_height * right;
    Ray { view: 0, origin: camera.eye, direction: (to - camera.eye).normalize() }
}

#[test]
fn a_click_on_a_joint_toggles_the_chain_from_it_to_the_root() {
    let mut e = editor();
    e.keys("f");
    let skeleton = e.document().solved().clip.skeleton.clone();
    let click = |e: &mut Editor, point: usize, aside: f64, away: f64| {
        let scene = e.scene();
        e.press(&scene, &ray_to(&scene, point, aside));
        e.drag(&ray_to(&scene, point, aside + away));
        e.release();
    };
    let knee = skeleton.find("LeftKnee").expect("a joint of the built-in walk").idx();
    click(&mut e, knee, 0.0, 0.0);
    assert_eq!(joints(&e), "LeftKnee: Hips LeftHip LeftKnee");
    click(&mut e, knee, 0.01, 0.002);
    assert_eq!(joints(&e), "LeftKnee: ", "again, a hand that trembles a little");
    click(&mut e, knee, 0.0, 0.2);
    assert_eq!(joints(&e), "LeftKnee: ", "a drag is no click");
    click(&mut e, knee, 2.0, 0.0);
    assert_eq!(joints(&e), "LeftKnee: ", "nothing is there");
    let toe =
        skeleton.end_sites().iter().position(|&id| skeleton.joint(id).name == "LeftToe").expect("has an end site");
    click(&mut e, skeleton.n_joints() + toe, 0.0, 0.0);
    assert_eq!(joints(&e), "LeftToe: Hips LeftHip LeftKnee LeftAnkle LeftToe");
    e.release();
    e.drag(&ray_to(&e.scene(), knee, 0.0));
    assert_eq!(joints(&e), "LeftToe: Hips LeftHip LeftKnee LeftAnkle LeftToe", "without a press");
    let scene = e.scene();
    e.press(&scene, &Ray { view: 3, ..ray_to(&scene, knee, 0.0) });
    e.release();
    assert_eq!(e.view().joints.selected.len(), 5, "a view that is not there");
    let ray = ray_to(&e.scene(), 0, 0.0);
    e.keys("vn");
    let hidden = e.scene();
    e.press(&hidden, &ray);
    e.release();
    assert_eq!(e.view().joints.selected.len(), 5, "what is not seen is not clicked on");
    e.keys("vnV2vn");
    let scene = e.scene();
    e.press(&scene, &ray_to(&scene, 0, 0.0));
    e.release();
    assert_eq!(e.view().joints.selected.len(), 5, "nor what this view hides");
}

/// An editor with the joints tab in use, after keys.
fn posing(keys: &str) -> Editor {
    let mut e = editor();
    e.keys("<tab><tab><tab><tab>");
    e.keys(keys);
    e
}

/// Keys that select the left shoulder and elbow and go to the wrist, from the hips.
const ARM: &str = "gcgcgcgsgcgtgcgtgc";

/// The same, and lift the wrist, so that the arm is bent and has room all round.
const BENT: &str = "gcgcgcgsgcgtgcgtgc<tab><tab><tab><tab>yyyyyygtgt";

fn rigids(e: &Editor) -> Vec<Rigid> {
    let mut rigids = Vec::new();
    e.document().solved().edited.world_rigids(e.view().frame_idx, &mut rigids);
    rigids
}

fn joint_idx(e: &Editor, name: &str) -> usize {
    e.document().solved().clip.skeleton.find(name).expect("a joint of the built-in walk").idx()
}

fn place_of(e: &Editor, name: &str) -> DVec3 {
    rigids(e)[joint_idx(e, name)].translation
}

fn height(e: &Editor) -> f64 {
    e.document().solved().clip.facts.height.value
}

/// The keys of the first layer as one line: frames and maps.
fn maps(e: &Editor) -> String {
    let Some(layer) = e.document().edits().layers.first() else { return "no layer".to_owned() };
    let points = layer.map_points(&Selection::all(layer)).into_iter().map(|point| match point.value {
        PointValue::Position(_) => format!("{} position", point.frame),
        PointValue::Rotation(joint, _) => format!("{} {joint}", point.frame),
    });
    points.collect::<Vec<_>>().join(", ")
}

#[test]
fn keys_move_a_joint_and_turn_only_selected_joints_above_it() {
    for (key, axis) in [("x", DVec3::X), ("X", DVec3::NEG_X), ("y", DVec3::Y), ("Y", DVec3::NEG_Y), ("Z", DVec3::NEG_Z)]
    {
        let mut e = editor();
        e.keys("..");
        e.keys(BENT);
        let (before, at) = (rigids(&e), place_of(&e, "LeftWrist"));
        e.keys(key);
        let by = 0.02 * height(&e) * axis;
        let off = place_of(&e, "LeftWrist").distance(at + by);
        assert!(off < 1e-4 * height(&e), "{key}: off by {off}");
        assert_eq!(maps(&e), "2 LeftElbow, 2 LeftShoulder");
        let turned = ["LeftShoulder", "LeftElbow", "LeftWrist"].map(|name| joint_idx(&e, name));
        for (idx, (before, after)) in before.iter().zip(rigids(&e)).enumerate() {
            assert!(turned.contains(&idx) || *before == after, "{key}: joint {idx}");
        }
        e.keys("u");
        assert_eq!(place_of(&e, "LeftWrist"), at);
    }
    let mut held = posing(ARM);
    held.keys("zzz");
    assert_eq!(held.document().depth(), (1, 0), "held keys are one step");
}

#[test]
fn what_is_shown_before_it_is_measured_says_so_and_looks_the_same_after() {
    let mut e = editor();
    e.keys("..");
    e.keys(BENT);
    let mut scripted = e.clone();
    e.show_drafts();
    e.keys("xx");
    scripted.keys("xx");
    assert!(!e.document().solved().is_measured() && scripted.document().solved().is_measured());
    assert_eq!(rigids(&e), rigids(&scripted));
    let told = |e: &Editor| format!("{:?} {:?}", e.document().solved().measures, e.document().solved().foot_numbers);
    let quality = |e: &mut Editor| {
        let tab_idx = e.view().tab_idx;
        let quality = TABS.iter().position(|&tab| tab == Tab::Quality).expect("a tab");
        e.keys(&"<tab>".repeat((quality + TABS.len() - tab_idx) % TABS.len()));
        e.rows().into_iter().filter(|row| row.value.ends_with('…')).count()
    };
    let drawn = e.scene().still.revision;
    assert!(quality(&mut e.clone()) > 0 && quality(&mut scripted) == 0);
    assert!(e.measure() && !e.measure());
    assert_eq!(told(&e), told(&scripted));
    assert_eq!(quality(&mut e.clone()), 0);
    assert_eq!(e.scene().still.revision, drawn, "nothing is drawn anew");
}

#[test]
fn what_cannot_be_moved_is_told() {
    let mut e = posing("gcgcgcgsgcgc");
    e.keys("x");
    assert!(message(&e).ends_with("select joints first, gr the chain to the root"), "{}", message(&e));
    assert_eq!((e.document().depth(), maps(&e).as_str()), ((0, 0), "no layer"));
    let mut e = posing(ARM);
    e.keys(":pose.nudge=1<enter>x");
    assert!(message(&e).contains("LeftWrist reaches no farther: "), "{}", message(&e));
}

#[test]
fn the_carrier_moves_with_its_position_or_its_joint_active() {
    for keys in ["", "k"] {
        let mut e = posing(keys);
        let at = place_of(&e, "Hips");
        e.keys("YY");
        assert!(place_of(&e, "Hips").abs_diff_eq(at - 0.04 * height(&e) * DVec3::Y, 1e-4 * height(&e)));
        assert_eq!(maps(&e), "0 position");
        assert_eq!(message(&e), "layer 1: 1 key at file frame 0, 1 in all");
        e.keys("..h");
        assert_eq!(e.view().frame_idx, 0, "keys walk to what the carrier was moved by");
        e.keys("d");
        assert_eq!(maps(&e), "");
    }
    for (keys, told) in [
        // A chain is selected that ends with the carrier.
        ("gcgrgpx", "layer 1: 1 key at file frame 0, 1 in all"),
        // What is turned is not selected.
        ("gtgcex", "layer 1: 1 key at file frame 0, 1 in all"),
    ] {
        assert_eq!(message(&posing(keys)), told, "after {keys}");
    }
}

#[test]
fn axes_are_the_clips_the_views_the_parents_or_the_joints_own() {
    let moved = |keys: &str| {
        let mut e = editor();
        e.keys(BENT);
        e.keys(keys);
        let (before, joints) = (place_of(&e, "LeftWrist"), rigids(&e));
        e.keys("x");
        let way = (place_of(&e, "LeftWrist") - before) / (0.02 * height(&e));
        (way, joints[joint_idx(&e, "LeftElbow")].rotation, joints[joint_idx(&e, "LeftWrist")].rotation)
    };
    let near = |a: DVec3, b: DVec3| assert!(a.distance(b) < 0.01, "{a} is not {b}");
    near(moved("").0, DVec3::X);
    // The camera at the side looks along −x, so its right is −z.
    near(moved("3G").0, DVec3::NEG_Z);
    let (way, parent, _) = moved("GG");
    near(way, parent * DVec3::X);
    let (way, _, own) = moved("GGG");
    near(way, own * DVec3::X);
    near(moved("GGGG").0, DVec3::X);
}

#[test]
fn keys_turn_a_joint_about_itself() {
    let mut e = posing("gcgcgcgsgc");
    let (before, at) = (rigids(&e), place_of(&e, "LeftShoulder"));
    e.keys("eyy");
    let turn =
        rigids(&e)[joint_idx(&e, "LeftShoulder")].rotation * before[joint_idx(&e, "LeftShoulder")].rotation.conjugate();
    assert!(turn.abs_diff_eq(DQuat::from_rotation_y(10f64.to_radians()), 1e-9), "{turn}");
    assert!(place_of(&e, "LeftShoulder").abs_diff_eq(at, 1e-9 * height(&e)));
    assert_eq!(maps(&e), "0 LeftShoulder");
    e.keys("eG");
    assert!(message(&e).contains("view"), "{}", message(&e));
}

#[test]
fn steps_and_values_are_typed_and_stepped() {
    let mut e = posing(ARM);
    e.keys("}");
    assert!((e.document().edits().pose.nudge - 0.025).abs() < 1e-12);
    e.keys("e{");
    assert!((e.document().edits().pose.turn - 4.0).abs() < 1e-12);
    assert!((e.document().edits().path.nudge - 0.1).abs() < 1e-12, "the control points' own step stays");
    e.keys("e");
    let to = place_of(&e, "LeftWrist") + 0.1 * height(&e) * DVec3::new(0.2, 0.3, -0.1);
    e.keys(&format!("c{}<space>{}<space>{}<enter>", to.x, to.y, to.z));
    assert!(place_of(&e, "LeftWrist").distance(to) < 1e-4 * height(&e));
    let before = rigids(&e)[joint_idx(&e, "LeftWrist")].rotation;
    e.keys("ec0<space>30<space>0<enter>");
    let turn = rigids(&e)[joint_idx(&e, "LeftWrist")].rotation * before.conjugate();
    assert!(turn.abs_diff_eq(DQuat::from_rotation_y(30f64.to_radians()), 1e-9), "{turn}");
    e.keys("cx<enter>");
    assert!(e.prompt().is_some() && message(&e).contains("expected three angles"), "{}", message(&e));
}

#[test]
fn while_the_carrier_is_selected_keys_act_on_both_its_maps() {
    for select in ["gt", "gr", "gcgcgrgpgp"] {
        let mut e = posing(select);
        e.keys("....z");
        assert_eq!(
            (message(&e).as_str(), maps(&e).as_str()),
            ("layer 1: 1 key at file frame 4, 1 in all", "4 position")
        );
        e.keys("d");
        assert_eq!(maps(&e), "", "{select}: {}", message(&e));
        e.keys("0i");
        assert!(maps(&e).starts_with("0 position, 0 ") && maps(&e).contains("0 Hips"), "{select}: {}", maps(&e));
        e.keys("....zD9<enter>");
        assert!(maps(&e).contains("4 position") && maps(&e).contains("9 position"), "{select}: {}", maps(&e));
        e.keys("d0d");
        assert_eq!(
            (message(&e).as_str(), maps(&e).as_str()),
            ("layer 1: 0 keys at file frame 0, 1 in all", "4 position")
        );
    }
    // A joint that is selected while the carrier is not is all that keys act on.
    let mut e = posing("gcgtgpgci");
    assert_eq!(maps(&e), "0 Spine");
    e.keys("gpd");
    assert_eq!(maps(&e), "");
}

#[test]
fn map_points_are_added_deleted_walked_moved_and_copied() {
    let mut e = posing("....gcgt");
    let before = e.document().solved().to_bvh();
    e.keys("i");
    assert_eq!(maps(&e), "4 Spine");
    e.keys("......gpkgti");
    assert_eq!(maps(&e), "4 Spine, 10 position, 10 Spine");
    assert!(e.document().solved().to_bvh() == before, "no pose has changed");
    let frame = |e: &mut Editor, keys: &str| {
        e.keys(keys);
        e.view().frame_idx
    };
    assert_eq!([frame(&mut e, "l"), frame(&mut e, "l"), frame(&mut e, "h"), frame(&mut e, "h")], [4, 10, 4, 10]);
    assert_eq!([frame(&mut e, "gt"), frame(&mut e, "h"), frame(&mut e, "h")], [10, 4, 10]);
    e.keys("M20<enter>");
    assert_eq!((maps(&e).as_str(), e.view().frame_idx), ("4 Spine, 10 position, 20 Spine", 20));
    e.keys("D30<enter>");
    assert_eq!((maps(&e).as_str(), e.view().frame_idx), ("4 Spine, 10 position, 20 Spine, 30 Spine", 30));
    e.keys("hd");
    assert_eq!(maps(&e), "4 Spine, 10 position, 30 Spine");
    e.keys("d");
    assert!(message(&e).contains("none of the selected maps has a key at file frame 20"), "{}", message(&e));
    e.keys("lM99999<enter>");
    assert!(e.prompt().is_some() && message(&e).contains("outside the clip"), "{}", message(&e));
    e.keys("<esc>gnl");
    assert_eq!(e.view().frame_idx, 10, "while nothing is selected it is about the active joint, here the position");
    e.keys("..i");
    assert_eq!(maps(&e), "4 Spine, 10 position, 12 position, 30 Spine");
    e.keys("uuuuuu");
    assert_eq!(maps(&e), "no layer");
}

#[test]
fn the_joints_tab_shows_keys() {
    let e = posing("....gti,");
    let rows = e.rows();
    let value = |label: &str| rows.iter().find(|r| r.label.trim() == label).map(|r| (r.value.as_str(), r.changed));
    assert_eq!(value("◉ Hips"), Some(("1 key", true)));
    assert_eq!(value("○ Spine"), Some(("", false)));
    let here = posing("....gti");
    assert!(here.rows().iter().any(|r| r.value == "◆ 1 key"));
}

#[test]
fn two_interpolation_keys_replace_the_clip_between_them() {
    let mut e = editor();
    e.keys("....I");
    assert_eq!((e.view().interpolated_from, e.document().depth()), (Some(4), (0, 0)));
    e.keys("I");
    assert_eq!((e.view().interpolated_from, e.document().depth()), (None, (0, 0)), "one frame is no range");
    // One alone is taken back like a step, after what was done later.
    e.keys("Ixu");
    assert_eq!((e.view().interpolated_from, e.document().depth()), (Some(4), (0, 1)));
    e.keys("u");
    assert_eq!((e.view().interpolated_from, e.document().depth()), (None, (0, 1)));
    assert!(message(&e).starts_with("undone: interpolation key at file frame 4"), "{}", message(&e));
    e.keys("Uu");
    assert_eq!(e.document().depth(), (0, 1));
    e.keys("I$I");
    let last = e.view().frame_idx;
    assert_eq!(e.document().edits().interpolation_keys, Some(InterpolationKeys { first: 4, last }));
    assert_eq!(e.document().depth(), (1, 0));
    e.keys("O");
    assert_eq!((e.document().edits().interpolation_keys, e.document().depth()), (None, (2, 0)));
    e.keys("O");
    assert!(message(&e).contains("does nothing here"), "{}", message(&e));
}

#[test]
fn dragging_a_selected_joint_moves_it_in_the_views_plane() {
    let mut e = editor();
    e.keys("f......");
    e.keys(BENT);
    e.keys("gt");
    let wrist = joint_idx(&e, "LeftWrist");
    let scene = e.scene();
    let camera = scene.now.views[0].camera;
    let (before, at) = (rigids(&e), place_of(&e, "LeftWrist"));
    e.press(&scene, &ray_to(&scene, wrist, 0.0));
    for aside in [0.02, 0.06, -0.03, 0.05] {
        e.drag(&ray_to(&scene, wrist, aside));
        let right = (camera.target - camera.eye).cross(camera.up).normalize();
        let to = at + aside * height(&e) * right;
        let off = place_of(&e, "LeftWrist").distance(to);
        assert!(off < 1e-4 * height(&e), "{aside}: off by {off}");
    }
    e.release();
    assert_eq!((e.document().depth(), maps(&e).as_str()), ((2, 0), "6 LeftElbow, 6 LeftShoulder"));
    assert!(e.view().joints.is_selected(Handle::Joint(JointId(wrist as u32))), "a drag is no click");
    let mut direct = editor();
    direct.keys("f......");
    direct.keys(BENT);
    direct.keys("gt");
    direct.press(&scene, &ray_to(&scene, wrist, 0.0));
    direct.drag(&ray_to(&scene, wrist, 0.05));
    assert_eq!(rigids(&direct), rigids(&e), "where it ends does not depend on the way");
    e.keys("u");
    assert_eq!(rigids(&e), before);

    e.keys("gn");
    e.press(&scene, &ray_to(&scene, wrist, 0.0));
    e.drag(&ray_to(&scene, wrist, 0.05));
    e.release();
    assert!(message(&e).contains("LeftWrist is not selected"), "{}", message(&e));
    assert_eq!(rigids(&e), before);
}

#[test]
fn a_drag_beyond_reach_says_by_how_much_it_is_short() {
    let mut e = editor();
    e.keys("f......");
    e.keys(BENT);
    e.keys("gt");
    let scene = e.scene();
    let wrist = joint_idx(&e, "LeftWrist");
    let camera = scene.now.views[0].camera;
    let right = (camera.target - camera.eye).cross(camera.up).normalize();
    let to = place_of(&e, "LeftWrist") + 2.0 * height(&e) * right;
    e.press(&scene, &ray_to(&scene, wrist, 0.0));
    e.drag(&ray_to(&scene, wrist, 2.0));
    let short = format!("LeftWrist reaches no farther: {:.2} cm short", place_of(&e, "LeftWrist").distance(to));
    assert_eq!(message(&e), short);
    assert!(e.scene().now.caption.contains(&short), "it is said where the pointer is");
    e.drag(&ray_to(&scene, wrist, 0.02));
    assert_eq!(message(&e), "", "and no longer once it is reached");
    e.drag(&ray_to(&scene, wrist, 2.0));
    e.release();
    assert_eq!(message(&e), short);
}

#[test]
fn a_key_ends_a_drag() {
    let mut e = editor();
    e.keys("gt");
    let scene = e.scene();
    e.press(&scene, &ray_to(&scene, 0, 0.0));
    e.drag(&ray_to(&scene, 0, 0.1));
    assert_eq!(maps(&e), "0 position");
    e.keys("u");
    e.drag(&ray_to(&scene, 0, 0.2));
    e.release();
    assert_eq!((e.document().depth(), joints(&e).as_str()), ((0, 1), "Hips: Hips"));
}
