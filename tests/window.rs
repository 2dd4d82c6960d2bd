//! A real window on a real X server: it opens, draws, is resized, sends keys and the pointer, and closes.
//!
//! winit wants the main thread of a process and one event loop in it, so this test has no harness: the program starts
//! itself again as the preview, with an Xvfb of its own, and plays the user and the display manager by X11 requests.
//! Without Xvfb or a Vulkan driver what needs them is skipped with a loud line, and fails where the variable `CI` is
//! set.

#[cfg(target_os = "linux")]
#[path = "window/desktop.rs"]
#[allow(dead_code, reason = "the test of two windows uses the rest")]
mod desktop;
#[cfg(target_os = "linux")]
#[path = "window/preview.rs"]
mod preview;

#[cfg(not(target_os = "linux"))]
fn main() {
    eprintln!("SKIPPED: the window is tested on Linux only");
}

#[cfg(target_os = "linux")]
fn main() {
    if preview::is_child() {
        return preview::child();
    }
    let arguments: Vec<String> = std::env::args().skip(1).collect();
    let tests: [(&str, fn()); 6] = [
        ("no_display_is_said_in_words", tests::no_display_is_said_in_words),
        ("no_display_server_is_said_in_words", tests::no_display_server_is_said_in_words),
        ("no_driver_is_said_in_words", tests::no_driver_is_said_in_words),
        ("a_window_lives", tests::a_window_lives),
        ("the_editor_closes_the_window", tests::the_editor_closes_the_window),
        ("a_lost_display_ends_the_preview", tests::a_lost_display_ends_the_preview),
    ];
    if arguments.iter().any(|a| a == "--list") {
        for (name, _) in tests {
            println!("{name}: test");
        }
        return;
    }
    let filters: Vec<_> = arguments.iter().filter(|a| !a.starts_with('-')).collect();
    let mut n_passed = 0;
    for (name, test) in tests {
        if filters.is_empty() || filters.iter().any(|f| name.contains(f.as_str())) {
            // A failure is a panic, which ends the process with an error.
            test();
            println!("test {name} ... ok");
            n_passed += 1;
        }
    }
    // As cargo's own test programs say it, for those who count results.
    println!("\ntest result: ok. {n_passed} passed; 0 failed; {} filtered out", tests.len() - n_passed);
}

#[cfg(target_os = "linux")]
mod tests {
    use walkabout::{
        scene::{Picture, Scene},
        viewport::{DeviceChoice, Renderer, RendererOptions},
    };

    use super::{
        desktop::{Desktop, X11Window},
        preview::{Preview, scene},
    };

    pub(super) fn no_display_is_said_in_words() {
        let preview = Preview::start("window", &[("DISPLAY", None), ("WAYLAND_DISPLAY", None)]);
        preview.expect("failed there is no display");
        preview.ends_well();
    }

    pub(super) fn no_display_server_is_said_in_words() {
        let preview = Preview::start("window", &[("DISPLAY", Some(":7391")), ("WAYLAND_DISPLAY", None)]);
        let text = preview.expect("failed the display cannot be opened");
        assert!(text.contains("libxcursor1"), "{text}");
        assert!(!text.contains(".rs:"), "a user has no use for a place in winit's source: {text}");
        preview.ends_well();
    }

    pub(super) fn no_driver_is_said_in_words() {
        let nowhere = Some("/nonexistent.json");
        let preview = Preview::start("headless", &[("VK_DRIVER_FILES", nowhere), ("VK_ICD_FILENAMES", nowhere)]);
        let text = preview.expect("failed there is no Vulkan");
        assert!(text.contains("install"), "{text}");
        preview.ends_well();
    }

    /// The desktop and a renderer for comparison; none when something is missing and this is not CI.
    fn equipment() -> Option<(Desktop, Renderer)> {
        let skip = |why: String| {
            assert!(std::env::var_os("CI").is_none(), "{why}");
            eprintln!("SKIPPED: no window was opened, because {why}");
        };
        let options = RendererOptions { device: DeviceChoice::Processor, ..RendererOptions::default() };
        let renderer = Renderer::new(&options).map_err(|e| skip(e.to_string())).ok()?;
        let desktop = Desktop::start().map_err(skip).ok()?;
        Some((desktop, renderer))
    }

    /// Starts a preview that shows scene `number` on the desktop.
    fn open<'a>(desktop: &'a Desktop, number: u32) -> (Preview, X11Window<'a>) {
        let display = desktop.display();
        let mut preview = Preview::start("window", &[("DISPLAY", Some(&display)), ("WAYLAND_DISPLAY", None)]);
        preview.say(&format!("scene {number}"));
        let ready = preview.expect("ready");
        assert!(ready.contains("llvmpipe"), "the device is named: {ready}");
        let window = desktop.window_named("walkabout — test.bvh");
        (preview, window)
    }

    /// Waits until the window shows exactly what the renderer draws of the scene in this size.
    fn shows(window: &X11Window<'_>, renderer: &mut Renderer, scene: &Scene, size: (u32, u32)) {
        let expected = renderer.render(scene, size.0, size.1).expect("draws");
        window.eventually(&format!("shows the scene in {size:?}"), |seen: &Picture| *seen == expected);
    }

    pub(super) fn a_window_lives() {
        let Some((desktop, mut renderer)) = equipment() else { return };
        let (mut preview, window) = open(&desktop, 1);
        shows(&window, &mut renderer, &scene(1), (960, 600));

        for size in [(500, 400), (1200, 300), (1, 1), (640, 360)] {
            window.resize(size.0, size.1);
            shows(&window, &mut renderer, &scene(1), size);
        }
        window.hide();
        window.show();
        shows(&window, &mut renderer, &scene(1), (640, 360));

        for number in 2..20 {
            preview.say(&format!("scene {number}"));
        }
        shows(&window, &mut renderer, &scene(19), (640, 360));

        window.focus();
        for (pressed, name) in [
            (&["j"][..], "j"),
            (&["Shift_L", "g"], "G"),
            (&["Control_L", "r"], "<c-r>"),
            (&["Tab"], "<tab>"),
            (&["Shift_L", "Left"], "<s-left>"),
            (&["space"], "<space>"),
        ] {
            window.press(pressed);
            assert_eq!(preview.expect("key"), format!("key {name}"), "no event for bare modifiers and releases");
        }

        // The middle of the picture is where the camera looks.
        window.point(320, 180);
        window.button(true);
        let pick = preview.expect("pick");
        let miss: f64 = pick.rsplit(' ').next().and_then(|n| n.parse().ok()).expect("a number");
        assert!(miss < 0.02, "the ray passes the target at {miss}: {pick}");
        window.point(400, 180);
        preview.expect("drag");
        window.button(false);
        preview.expect("release");

        // Of a button that is no wheel's axis, which is all that a test has, winit tells both press and release.
        for (away, told) in [(true, "wheel 1 in view 0"), (false, "wheel -1 in view 0")] {
            window.wheel(away);
            assert_eq!([preview.expect("wheel"), preview.expect("wheel")], [told, told]);
        }

        window.close();
        preview.expect("closed");
        preview.expect("validation []");
        preview.ends_well();
    }

    pub(super) fn the_editor_closes_the_window() {
        let Some((desktop, _)) = equipment() else { return };
        let (mut preview, _) = open(&desktop, 1);
        preview.say("close");
        // With no event before: the editor knows.
        preview.expect("validation []");
        preview.ends_well();
    }

    pub(super) fn a_lost_display_ends_the_preview() {
        let Some((mut desktop, _)) = equipment() else { return };
        let display = desktop.display();
        let mut preview = Preview::start("window", &[("DISPLAY", Some(&display)), ("WAYLAND_DISPLAY", None)]);
        preview.say("scene 1");
        preview.expect("ready");
        desktop.stop();
        preview.ends();
    }
}
