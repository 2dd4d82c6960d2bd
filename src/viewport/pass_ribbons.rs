//! Curves of constant width on the screen.
//!
//! One instance is one segment, expanded to a quad by the vertex shader. Drawn after everything solid, tested against
//! depth but not written to it, so that the smooth edges of neighbours do not cut into each other.

use std::rc::Rc;

use ash::vk;

use super::{
    batch::Segment,
    device::Device,
    error::GpuError,
    listed::{Listed, ListedInstances},
    pipeline::{Depth, Layouts, Pipeline, PipelineSpec, VertexBuffer},
};
use crate::scene::Objects;

/// Draws the curves of a view.
pub(super) struct RibbonPass {
    pipeline: Pipeline,
    still: ListedInstances,
    moving: ListedInstances,
    device: Rc<Device>,
}

impl RibbonPass {
    /// Makes the pass.
    ///
    /// # Errors
    ///
    /// When the driver cannot make the pipeline or memory has run out.
    pub(super) fn new(device: &Rc<Device>, layouts: &Layouts, samples: vk::SampleCountFlags) -> Result<Self, GpuError> {
        let segment = VertexBuffer {
            stride: size_of::<Segment>(),
            rate: vk::VertexInputRate::INSTANCE,
            attributes: &[
                (0, vk::Format::R32G32B32A32_SFLOAT, 0),
                (1, vk::Format::R32G32B32A32_SFLOAT, 16),
                (2, vk::Format::R32G32B32A32_SFLOAT, 32),
                (3, vk::Format::R32G32_SFLOAT, 48),
            ],
        };
        let spec = PipelineSpec {
            code: include_bytes!(concat!(env!("OUT_DIR"), "/ribbons.spv")),
            vertex: c"vertex",
            fragment: Some(c"fragment"),
            layout: layouts.view,
            buffers: &[segment],
            topology: vk::PrimitiveTopology::TRIANGLE_STRIP,
            samples,
            cull: false,
            depth: Depth::Test,
            blend: true,
        };
        let pipeline = Pipeline::new(device, &spec)?;
        let (still, moving) = (ListedInstances::new(device)?, ListedInstances::new(device)?);
        Ok(Self { pipeline, still, moving, device: Rc::clone(device) })
    }

    /// Replaces the curves that stay; the device must not be drawing them.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set_still(&mut self, segments: &Listed<Segment>) -> Result<(), GpuError> {
        self.still.set(segments)
    }

    /// Replaces the curves that move; the device must not be drawing them.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set_moving(&mut self, segments: &Listed<Segment>) -> Result<(), GpuError> {
        self.moving.set(segments)
    }

    /// Records the drawing of what is shown; a view is bound.
    pub(super) fn draw(&self, commands: vk::CommandBuffer, shown: Objects) {
        self.draw_list(commands, &self.still, shown);
        self.draw_list(commands, &self.moving, shown);
    }

    fn draw_list(&self, commands: vk::CommandBuffer, segments: &ListedInstances, shown: Objects) {
        let device = &self.device.handle;
        // SAFETY: recorded inside rendering to the format and samples that the pipeline was made for; the buffer holds
        // the instances of the ranges, of the stride it was told.
        unsafe {
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline.handle);
            device.cmd_bind_vertex_buffers(commands, 0, &[segments.handle()], &[0]);
            for drawn in segments.ranges(shown) {
                device.cmd_draw(commands, 4, drawn.end - drawn.start, 0, drawn.start);
            }
        }
    }
}
