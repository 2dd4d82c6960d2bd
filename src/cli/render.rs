//! `walkabout render`: one frame to PNG, without a window.

use std::{io::BufWriter, path::Path};

use super::{
    Failure,
    args::{Clip, Output, Picture},
};
use crate::{
    document::write_file,
    editor::Editor,
    scene,
    viewport::{Renderer, RendererOptions},
};

pub(super) fn run(clip: &Clip, output: &Output, picture: &Picture) -> Result<(), Failure> {
    check_is_png(&output.output)?;
    super::check_free(&output.output, output.force)?;
    let document = super::open_loudly(&with_views(clip, picture))?;
    let n_frames = document.solved().n_shown_frames();
    let frame = picture.frame.unwrap_or(document.solved().clip.rest_frames());
    if frame >= n_frames {
        return Err(Failure::Usage(format!("--frame takes 0 to {} here, found {frame}", n_frames - 1)));
    }
    let mut editor = Editor::new(document, Vec::new());
    editor.show_exported_frame(frame);
    let (width, height) = picture.size;
    let mut scene = editor.scene();
    // No key is pressed in a picture.
    scene.now.views.iter_mut().for_each(|view| view.focused = false);
    let rendered = Renderer::new(&RendererOptions::default())?.render(&scene, width, height)?;
    write_file(&output.output, &png_bytes(&rendered)?)?;
    Ok(())
}

/// Refuses a file name that promises another format.
fn check_is_png(output: &Path) -> Result<(), Failure> {
    match output.extension() {
        Some(extension) if !extension.eq_ignore_ascii_case("png") => {
            let (file, png) = (output.display(), output.with_extension("png"));
            Err(Failure::Usage(format!("{file}: pictures are written as PNG; name it {}", png.display())))
        }
        _ => Ok(()),
    }
}

/// Returns what to open with the views asked for: they are parameters like others.
fn with_views(clip: &Clip, picture: &Picture) -> Clip {
    let mut clip = clip.clone();
    // Who asks for a camera and no more wants to see through that one alone.
    if let Some(layout) = picture.views.or(picture.camera.map(|_| 1)) {
        clip.set.push(format!("view.layout={layout}"));
    }
    if let Some(camera) = picture.camera {
        clip.set.push(format!("view.1.camera={camera}"));
    }
    clip
}

/// Encodes a picture as PNG.
fn png_bytes(picture: &scene::Picture) -> Result<Vec<u8>, Failure> {
    let mut bytes = Vec::new();
    let mut encoder = png::Encoder::new(BufWriter::new(&mut bytes), picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_source_srgb(png::SrgbRenderingIntent::Perceptual);
    encoder.set_compression(png::Compression::Fast);
    let mut writer = encoder.write_header().map_err(std::io::Error::from)?;
    writer.write_image_data(&picture.rgb).map_err(std::io::Error::from)?;
    writer.finish().map_err(std::io::Error::from)?;
    Ok(bytes)
}
