//! Text over the whole finished picture: it lies on whole pixels, so it needs neither several samples nor depth.

use std::rc::Rc;

use ash::vk;

use super::{
    buffer::Instances,
    device::Device,
    error::GpuError,
    pipeline::{Depth, Layouts, Pipeline, PipelineSpec, VertexBuffer},
    text::Glyph,
};

/// Draws glyphs and boxes in pixels.
pub(super) struct TextPass {
    pipeline: Pipeline,
    layout: vk::PipelineLayout,
    glyphs: Instances,
    device: Rc<Device>,
}

impl TextPass {
    /// Makes the pass; the layouts outlive it.
    ///
    /// # Errors
    ///
    /// When the driver cannot make the pipeline or memory has run out.
    pub(super) fn new(device: &Rc<Device>, layouts: &Layouts) -> Result<Self, GpuError> {
        let glyph = VertexBuffer {
            stride: size_of::<Glyph>(),
            rate: vk::VertexInputRate::INSTANCE,
            attributes: &[
                (0, vk::Format::R32G32B32A32_SFLOAT, 0),
                (1, vk::Format::R32G32B32A32_SFLOAT, 16),
                (2, vk::Format::R32G32_UINT, 32),
                (3, vk::Format::R32_UINT, 40),
            ],
        };
        let spec = PipelineSpec {
            code: include_bytes!(concat!(env!("OUT_DIR"), "/text.spv")),
            vertex: c"vertex",
            fragment: Some(c"fragment"),
            layout: layouts.pushed,
            buffers: &[glyph],
            topology: vk::PrimitiveTopology::TRIANGLE_STRIP,
            samples: vk::SampleCountFlags::TYPE_1,
            cull: false,
            depth: Depth::Absent,
            blend: true,
        };
        let pipeline = Pipeline::new(device, &spec)?;
        Ok(Self { pipeline, layout: layouts.pushed, glyphs: Instances::new(device)?, device: Rc::clone(device) })
    }

    /// Replaces the text; the device must not be drawing it.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set(&mut self, glyphs: &[Glyph]) -> Result<(), GpuError> {
        self.glyphs.set(glyphs)
    }

    /// Returns whether there is nothing to draw.
    pub(super) fn is_empty(&self) -> bool {
        self.glyphs.count() == 0
    }

    /// Records the drawing; viewport and scissor are the whole picture.
    pub(super) fn draw(&self, commands: vk::CommandBuffer, picture: vk::Extent2D) {
        let size = [picture.width as f32, picture.height as f32];
        let device = &self.device.handle;
        // SAFETY: recorded inside rendering to the format and samples that the pipeline was made for; the buffer holds
        // `count` instances of the stride it was told; the layout offers more bytes than are pushed.
        unsafe {
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline.handle);
            device.cmd_push_constants(
                commands,
                self.layout,
                vk::ShaderStageFlags::VERTEX,
                0,
                bytemuck::cast_slice(&size),
            );
            device.cmd_bind_vertex_buffers(commands, 0, &[self.glyphs.handle()], &[0]);
            device.cmd_draw(commands, 4, self.glyphs.count(), 0, 0);
        }
    }
}
