//! `walkabout render`: one frame to PNG, without a window.

use std::io::BufWriter;

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
    super::check_free(&output.output, output.force)?;
    let document = super::open_loudly(clip)?;
    let n_frames = document.solved().n_shown_frames();
    let frame = picture.frame.unwrap_or(document.solved().clip.rest_frames());
    if frame >= n_frames {
        return Err(Failure::Usage(format!("--frame takes 0 to {} here, found {frame}", n_frames - 1)));
    }
    let mut editor = Editor::new(document, Vec::new());
    editor.show_exported_frame(frame);
    editor.use_camera(usize::from(picture.camera) - 1);
    let (width, height) = picture.size;
    let rendered = Renderer::new(&RendererOptions::default())?.render(&editor.scene(), width, height)?;
    write_file(&output.output, &png_bytes(&rendered)?)?;
    Ok(())
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
