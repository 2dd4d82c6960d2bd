//! Scenes drawn on the processor, compared with the pictures beside this file; see `compare.rs` for the tolerance.
//!
//! `WALKABOUT_BLESS=1` rewrites the pictures. Without a Vulkan driver for the processor the tests are skipped with a
//! loud line, and fail where the variable `CI` is set. Every message of the validation layer fails the test.

mod compare;
mod scenes;

use std::{sync::Arc, thread};

use walkabout::{
    scene::{FromPreview, Object, Objects, Picture, Scene},
    sync::Mailbox,
    viewport::{DeviceChoice, Quality, Renderer, RendererOptions, ValidationLog, headless},
};

/// A renderer on the processor with its validation log, or none when there is no such driver and this is not CI.
fn renderer(quality: Quality) -> Option<(Renderer, ValidationLog)> {
    let log = ValidationLog::default();
    let options = RendererOptions { device: DeviceChoice::Processor, quality, validation: Some(log.clone()) };
    match Renderer::new(&options) {
        Ok(renderer) => Some((renderer, log)),
        Err(why) if std::env::var_os("CI").is_some() => panic!("{why}"),
        Err(why) => {
            eprintln!("SKIPPED: no picture was drawn, because {why}");
            None
        }
    }
}

/// Fails on messages of the validation layer; everything that it listens to is gone, so leaks are among them.
fn silent(log: &ValidationLog) {
    match log.messages() {
        Some(messages) => assert!(messages.is_empty(), "the validation layer says:\n{}", messages.join("\n\n")),
        None if std::env::var_os("CI").is_some() => panic!("the Vulkan validation layer is not installed"),
        None => eprintln!("SKIPPED: drawn without the Vulkan validation layer, which is not installed"),
    }
}

fn check(name: &str, scene: &Scene, quality: Quality, width: u32, height: u32) {
    let Some((mut renderer, log)) = renderer(quality) else { return };
    let picture = renderer.render(scene, width, height).unwrap_or_else(|e| panic!("{e}"));
    drop(renderer);
    silent(&log);
    compare::check(name, &picture);
}

#[test]
fn a_full_scene() {
    check("full", &scenes::full(), Quality::Full, 640, 360);
}

#[test]
fn a_full_scene_in_high_definition() {
    check("full-1280x720", &scenes::full(), Quality::Full, 1280, 720);
}

#[test]
fn a_draft() {
    check("draft", &scenes::full(), Quality::Draft, 640, 360);
}

#[test]
fn four_views() {
    let mut scene = scenes::full();
    scene.now.views = scenes::cameras().to_vec();
    check("four-views", &scene, Quality::Full, 960, 600);
}

#[test]
fn four_views_that_show_different_things() {
    let mut scene = scenes::full();
    scene.now.views = scenes::different_views().to_vec();
    check("different-views", &scene, Quality::Full, 960, 600);
}

/// Draws a scene in four equal views, then the same with something left out of the last one, then a scene without it:
/// the last view must be as of that, and the others as ever.
fn check_left_out(whole: &Scene, object: Object, without: &Scene) {
    let Some((mut renderer, log)) = renderer(Quality::Full) else { return };
    let mut draw = |scene: &Scene, shows: Objects| {
        let mut scene = scene.clone();
        scene.now.views = vec![scenes::cameras()[0].clone(); 4];
        scene.now.views[3].shows = shows;
        renderer.render(&scene, 640, 400).expect("draws")
    };
    let mixed = draw(whole, Objects::ALL.without(object));
    let whole = draw(whole, Objects::ALL);
    let without = draw(without, Objects::ALL);
    // The gap is one pixel wide here.
    let quarter = |picture: &Picture, right: bool, below: bool| -> Vec<u8> {
        let rows = if below { 202..400 } else { 0..199 };
        let columns = if right { 322 * 3..640 * 3 } else { 0..318 * 3 };
        rows.flat_map(|row| picture.rgb[row * 640 * 3..][columns.clone()].to_vec()).collect()
    };
    for (right, below) in [(false, false), (true, false), (false, true)] {
        let same = quarter(&mixed, right, below) == quarter(&whole, right, below);
        assert!(same, "{object:?}: right {right}, below {below}");
    }
    assert!(quarter(&mixed, true, true) != quarter(&whole, true, true), "{object:?}");
    assert!(quarter(&mixed, true, true) == quarter(&without, true, true), "{object:?}: with its shadow and its name");
    drop(renderer);
    silent(&log);
}

#[test]
fn a_view_leaves_out_what_the_others_show() {
    let mut without = scenes::full();
    without.now.actors[0].clear();
    without.now.labels.remove(0);
    check_left_out(&scenes::full(), Object::OriginalSkeleton, &without);
}

#[test]
fn bodies_are_edges_in_some_views_and_solid_in_others() {
    let mut solid = scenes::wireframe();
    let still = Arc::make_mut(&mut solid.still);
    still.bodies.iter_mut().for_each(|body| body.wireframe = false);
    check_left_out(&scenes::wireframe(), Object::Wireframe, &solid);
}

#[test]
fn two_views() {
    let mut scene = scenes::full();
    scene.now.views = scenes::cameras()[..2].to_vec();
    check("two-views", &scene, Quality::Full, 640, 360);
}

#[test]
fn feet_on_the_ground() {
    check("feet", &scenes::feet(), Quality::Full, 640, 360);
}

#[test]
fn selected_joints() {
    check("selected", &scenes::selected(), Quality::Full, 640, 360);
}

#[test]
fn footprints_on_the_ground() {
    check("footprints", &scenes::footprints(), Quality::Full, 640, 360);
}

#[test]
fn awkward_ribbons() {
    check("ribbons", &scenes::ribbons(), Quality::Full, 640, 360);
}

#[test]
fn nothing_but_sky() {
    check("nothing", &scenes::nothing(), Quality::Full, 320, 200);
}

/// The size of a terminal pane of 120×40 cells: no text.
#[test]
fn a_terminal_pane() {
    check("pane", &scenes::full(), Quality::Full, 120, 80);
}

#[test]
fn one_renderer_draws_what_fresh_ones_draw() {
    let Some((mut shared, log)) = renderer(Quality::Full) else { return };
    let mut fresh = |scene: &Scene, width, height| -> Picture {
        let (mut renderer, _) = renderer(Quality::Full).expect("there was one before");
        let picture = renderer.render(scene, width, height).expect("draws");
        assert!(picture == shared.render(scene, width, height).expect("draws"), "at {width}×{height}");
        picture
    };
    let first = fresh(&scenes::full(), 320, 180);
    let moved = {
        let mut scene = scenes::full();
        scene.now.actors.swap(0, 1);
        fresh(&scene, 320, 180)
    };
    assert!(first != moved, "actors are read anew for every picture");
    fresh(&scenes::ribbons(), 320, 180);
    fresh(&scenes::full(), 500, 301);
    assert!(first == fresh(&scenes::full(), 320, 180), "the same scene gives the same bytes");
    drop(shared);
    silent(&log);
}

#[test]
fn what_stays_is_uploaded_when_its_revision_changes() {
    let Some((mut renderer, log)) = renderer(Quality::Draft) else { return };
    let mut draw = |scene: &Scene| renderer.render(scene, 320, 180).expect("draws");
    let before = draw(&scenes::full());
    let mut scene = scenes::full();
    let still = Arc::make_mut(&mut scene.still);
    still.marks.clear();
    still.curves.clear();
    assert!(draw(&scene) == before, "an equal revision promises an equal content");
    Arc::make_mut(&mut scene.still).revision = 77;
    assert!(draw(&scene) != before);
    drop(renderer);
    silent(&log);
}

#[test]
fn impossible_sizes_are_refused_in_words() {
    let Some((mut renderer, log)) = renderer(Quality::Draft) else { return };
    for (width, height) in [(0, 100), (100, 0), (1_000_000, 10)] {
        let why = renderer.render(&scenes::full(), width, height).expect_err("cannot be drawn").to_string();
        assert!(why.contains(&format!("{width}×{height}")), "{why}");
    }
    renderer.render(&scenes::full(), 1, 1).expect("one pixel is a picture");
    drop(renderer);
    silent(&log);
}

#[test]
fn numbers_that_are_none_do_no_harm() {
    let Some((mut renderer, log)) = renderer(Quality::Full) else { return };
    let mut scene = scenes::full();
    scene.now.actors[0][7] = glam::DVec3::NAN;
    scene.now.views[0].camera.eye = glam::DVec3::splat(f64::INFINITY);
    scene.now.views.push(scenes::cameras()[1].clone());
    let still = Arc::make_mut(&mut scene.still);
    still.body_height = f64::NAN;
    still.curves[0].points[3].x = f64::NAN;
    if let Some(ground) = &mut still.ground {
        ground.cell = 0.0;
    }
    renderer.render(&scene, 320, 180).expect("draws");
    scene.now.views.clear();
    renderer.render(&scene, 320, 180).expect("draws no views");
    drop(renderer);
    silent(&log);
}

#[test]
fn a_headless_preview_sends_frames() {
    let Some((mut renderer, _)) = renderer(Quality::Draft) else { return };
    let options = RendererOptions { device: DeviceChoice::Processor, quality: Quality::Draft, validation: None };
    let requests = Mailbox::default();
    let (send, events) = std::sync::mpsc::channel();
    let preview = thread::spawn({
        let requests = requests.clone();
        move || headless::run(&options, &requests, |event| send.send(event).expect("the test listens"))
    });
    let mut scene = scenes::full();
    requests.put(headless::Request { scene: scene.clone(), width: 0, height: 80 });
    requests.put(headless::Request { scene: scene.clone(), width: 120, height: 80 });
    assert!(matches!(events.recv(), Ok(FromPreview::Ready { .. })));
    let first = renderer.render(&scene, 120, 80).expect("draws");
    assert!(events.recv().expect("a frame") == FromPreview::Frame(first));
    scene.now.actors.swap(0, 1);
    requests.put(headless::Request { scene: scene.clone(), width: 60, height: 40 });
    let second = renderer.render(&scene, 60, 40).expect("draws");
    assert!(events.recv().expect("a frame") == FromPreview::Frame(second));
    requests.close();
    preview.join().expect("ends without panic");
    assert!(events.recv().is_err(), "no event after the last frame");
}

#[test]
fn bones_as_edges() {
    check("wireframe", &scenes::wireframe(), Quality::Full, 640, 360);
}

#[test]
fn trails_with_the_playhead_and_the_normal_skeleton() {
    check("trails", &scenes::trails(), Quality::Full, 640, 360);
}
