//! How long a picture of one, two and four views takes: `cargo bench --bench views`.
//!
//! The built-in clip on a circle at the size of a new window, drawn on the processor, so that machines without a GPU tell
//! what users without one get; best and median of the runs, milliseconds, the copy back to memory included.

use std::time::Instant;

use walkabout::{
    document::{self, Document},
    editor::Editor,
    viewport::{DeviceChoice, Quality, Renderer, RendererOptions},
};

const RUNS: usize = 30;
/// Pictures not counted: the driver compiles shaders for the first ones.
const WARM_UP: usize = 4;
const SIZE: (u32, u32) = (960, 600);

/// Views of one picture, as keys.
const LAYOUTS: [(&str, &str); 4] = [
    ("one view", "V1"),
    ("two views", "V2"),
    ("four views", "V4"),
    ("four views, each with shadows of its own", "V4voVnvnVnvovn"),
];

fn main() {
    let opened = document::open(None).expect("the built-in clip opens");
    let mut editor = Editor::new(Document::new(opened), Vec::new());
    editor.keys("sc");
    println!("{}×{} pixels; ms, best (median) of {RUNS} runs", SIZE.0, SIZE.1);
    for quality in [Quality::Full, Quality::Draft] {
        let options = RendererOptions { device: DeviceChoice::Processor, quality, validation: None };
        let mut renderer = match Renderer::new(&options) {
            Ok(renderer) => renderer,
            Err(why) => return println!("nothing was drawn: {why}"),
        };
        for (name, keys) in LAYOUTS {
            let mut editor = editor.clone();
            editor.keys(keys);
            time(&format!("{quality:?}, {name}"), &mut editor, &mut renderer);
        }
    }
}

/// Draws frame after frame, as playing does.
fn time(name: &str, editor: &mut Editor, renderer: &mut Renderer) {
    let mut runs = Vec::new();
    for run in 0..WARM_UP + RUNS {
        editor.keys(".");
        let scene = editor.scene();
        let begin = Instant::now();
        renderer.render(&scene, SIZE.0, SIZE.1).expect("draws");
        if run >= WARM_UP {
            runs.push(begin.elapsed().as_secs_f64() * 1e3);
        }
    }
    runs.sort_by(f64::total_cmp);
    println!("{name:<60} {:8.2} ({:.2})", runs[0], runs[RUNS / 2]);
}
