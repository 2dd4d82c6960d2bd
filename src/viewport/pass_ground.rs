//! The ground patch with its grid and the shadows on it. Drawn after the solids, so that what they hide costs nothing.

use std::rc::Rc;

use ash::vk;

use super::{
    device::Device,
    error::GpuError,
    pipeline::{Depth, Layouts, Pipeline, PipelineSpec},
};

/// Draws the ground of a view.
pub(super) struct GroundPass {
    pipeline: Pipeline,
    device: Rc<Device>,
}

impl GroundPass {
    /// Makes the pass, with shadows or without: two shaders, since a processor pays for both sides of a branch.
    ///
    /// # Errors
    ///
    /// When the driver cannot make the pipeline.
    pub(super) fn new(
        device: &Rc<Device>,
        layouts: &Layouts,
        samples: vk::SampleCountFlags,
        shadowed: bool,
    ) -> Result<Self, GpuError> {
        let spec = PipelineSpec {
            code: include_bytes!(concat!(env!("OUT_DIR"), "/ground.spv")),
            vertex: c"vertex",
            fragment: Some(if shadowed { c"fragment_shadowed" } else { c"fragment_plain" }),
            layout: layouts.view,
            buffers: &[],
            topology: vk::PrimitiveTopology::TRIANGLE_STRIP,
            samples,
            cull: false,
            depth: Depth::TestAndWrite,
            blend: true,
        };
        Ok(Self { pipeline: Pipeline::new(device, &spec)?, device: Rc::clone(device) })
    }

    /// Records the drawing; a view is bound whose block has a ground.
    pub(super) fn draw(&self, commands: vk::CommandBuffer) {
        let device = &self.device.handle;
        // SAFETY: recorded inside rendering to the format and samples that the pipeline was made for.
        unsafe {
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline.handle);
            device.cmd_draw(commands, 4, 1, 0, 0);
        }
    }
}
