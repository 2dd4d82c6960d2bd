//! The background: the smallest pass, and the pattern of the others.

use std::rc::Rc;

use ash::vk;

use super::{
    device::Device,
    error::GpuError,
    pipeline::{Depth, Layouts, Pipeline, PipelineSpec},
};

/// Draws the background of a view.
pub(super) struct SkyPass {
    pipeline: Pipeline,
    device: Rc<Device>,
}

impl SkyPass {
    /// Makes the pass.
    ///
    /// # Errors
    ///
    /// When the driver cannot make the pipeline.
    pub(super) fn new(device: &Rc<Device>, layouts: &Layouts, samples: vk::SampleCountFlags) -> Result<Self, GpuError> {
        let spec = PipelineSpec {
            code: include_bytes!(concat!(env!("OUT_DIR"), "/sky.spv")),
            vertex: c"vertex",
            fragment: Some(c"fragment"),
            layout: layouts.view,
            buffers: &[],
            topology: vk::PrimitiveTopology::TRIANGLE_LIST,
            samples,
            cull: false,
            depth: Depth::Ignore,
            blend: false,
        };
        Ok(Self { pipeline: Pipeline::new(device, &spec)?, device: Rc::clone(device) })
    }

    /// Records the drawing; a view is bound.
    pub(super) fn draw(&self, commands: vk::CommandBuffer) {
        let device = &self.device.handle;
        // SAFETY: recorded inside rendering to the format and samples that the pipeline was made for.
        unsafe {
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline.handle);
            device.cmd_draw(commands, 3, 1, 0, 0);
        }
    }
}
