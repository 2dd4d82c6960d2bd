//! Images that live on the device.

use std::rc::Rc;

use ash::vk;

use super::{
    device::Device,
    error::{GpuError, failed_to},
};

/// What an image is made for.
pub(super) struct ImageSpec {
    pub(super) extent: vk::Extent2D,
    pub(super) format: vk::Format,
    pub(super) samples: vk::SampleCountFlags,
    pub(super) usage: vk::ImageUsageFlags,
    pub(super) aspect: vk::ImageAspectFlags,
}

/// A two-dimensional image with its memory and its one view; freed with its owner, who sees to it that the device has
/// finished with it.
pub(super) struct Image {
    pub(super) handle: vk::Image,
    pub(super) view: vk::ImageView,
    memory: vk::DeviceMemory,
    device: Rc<Device>,
}

impl Image {
    /// Makes an image of undefined content.
    ///
    /// # Errors
    ///
    /// When memory has run out, which names `what`.
    pub(super) fn new(device: &Rc<Device>, spec: &ImageSpec, what: &'static str) -> Result<Self, GpuError> {
        let info = vk::ImageCreateInfo::default()
            .image_type(vk::ImageType::TYPE_2D)
            .format(spec.format)
            .extent(spec.extent.into())
            .mip_levels(1)
            .array_layers(1)
            .samples(spec.samples)
            .tiling(vk::ImageTiling::OPTIMAL)
            .usage(spec.usage);
        // SAFETY: the device is alive; formats and usages used here are required of every device.
        let handle = unsafe { device.handle.create_image(&info, None) }.map_err(failed_to(what))?;
        let mut image =
            Self { handle, view: vk::ImageView::null(), memory: vk::DeviceMemory::null(), device: Rc::clone(device) };
        // SAFETY: the image was made from this device.
        let needs = unsafe { device.handle.get_image_memory_requirements(handle) };
        let kinds = [vk::MemoryPropertyFlags::DEVICE_LOCAL, vk::MemoryPropertyFlags::empty()];
        image.memory = device.allocate(needs, &kinds, what)?;
        let view = vk::ImageViewCreateInfo::default()
            .image(handle)
            .view_type(vk::ImageViewType::TYPE_2D)
            .format(spec.format)
            .subresource_range(whole(spec.aspect));
        // SAFETY: the memory is new and fits the image's needs; the view is of the image's own format.
        unsafe {
            device.handle.bind_image_memory(handle, image.memory, 0).map_err(failed_to(what))?;
            image.view = device.handle.create_image_view(&view, None).map_err(failed_to(what))?;
        }
        Ok(image)
    }
}

impl Drop for Image {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device; destroying nothing is allowed.
        unsafe {
            self.device.handle.destroy_image_view(self.view, None);
            self.device.handle.destroy_image(self.handle, None);
            self.device.handle.free_memory(self.memory, None);
        }
    }
}

/// Returns the range that covers an image of one level and one layer.
pub(super) fn whole(aspect: vk::ImageAspectFlags) -> vk::ImageSubresourceRange {
    vk::ImageSubresourceRange::default().aspect_mask(aspect).level_count(1).layer_count(1)
}

/// Returns the layers that a copy of such an image reads or writes.
pub(super) fn colour_layers() -> vk::ImageSubresourceLayers {
    vk::ImageSubresourceLayers::default().aspect_mask(vk::ImageAspectFlags::COLOR).layer_count(1)
}

/// One side of an image barrier: where in the pipeline, what kind of access, in which layout.
#[derive(Clone, Copy)]
pub(super) struct Use {
    pub(super) stage: vk::PipelineStageFlags2,
    pub(super) access: vk::AccessFlags2,
    pub(super) layout: vk::ImageLayout,
}

impl Use {
    /// The content before is of no interest; what was done at `stage` is waited for.
    pub(super) fn discard(stage: vk::PipelineStageFlags2) -> Self {
        Self { stage, access: vk::AccessFlags2::NONE, layout: vk::ImageLayout::UNDEFINED }
    }

    /// Drawn into and over.
    pub(super) const COLOUR: Self = Self {
        stage: vk::PipelineStageFlags2::COLOR_ATTACHMENT_OUTPUT,
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::COLOR_ATTACHMENT_READ.as_raw() | vk::AccessFlags2::COLOR_ATTACHMENT_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::COLOR_ATTACHMENT_OPTIMAL,
    };

    /// Tested against and drawn into.
    pub(super) const DEPTH: Self = Self {
        stage: vk::PipelineStageFlags2::from_raw(
            vk::PipelineStageFlags2::EARLY_FRAGMENT_TESTS.as_raw()
                | vk::PipelineStageFlags2::LATE_FRAGMENT_TESTS.as_raw(),
        ),
        access: vk::AccessFlags2::from_raw(
            vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_READ.as_raw()
                | vk::AccessFlags2::DEPTH_STENCIL_ATTACHMENT_WRITE.as_raw(),
        ),
        layout: vk::ImageLayout::DEPTH_ATTACHMENT_OPTIMAL,
    };

    /// Read by a fragment shader.
    pub(super) const SAMPLED: Self = Self {
        stage: vk::PipelineStageFlags2::FRAGMENT_SHADER,
        access: vk::AccessFlags2::SHADER_SAMPLED_READ,
        layout: vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL,
    };

    /// Copied from.
    pub(super) const COPIED: Self = Self {
        stage: vk::PipelineStageFlags2::ALL_TRANSFER,
        access: vk::AccessFlags2::TRANSFER_READ,
        layout: vk::ImageLayout::TRANSFER_SRC_OPTIMAL,
    };

    /// Copied into.
    pub(super) const OVERWRITTEN: Self = Self {
        stage: vk::PipelineStageFlags2::ALL_TRANSFER,
        access: vk::AccessFlags2::TRANSFER_WRITE,
        layout: vk::ImageLayout::TRANSFER_DST_OPTIMAL,
    };

    /// Handed to the display; a semaphore does the waiting.
    pub(super) const PRESENTED: Self = Self {
        stage: vk::PipelineStageFlags2::NONE,
        access: vk::AccessFlags2::NONE,
        layout: vk::ImageLayout::PRESENT_SRC_KHR,
    };
}

/// Returns the barrier between two uses of an image.
pub(super) fn barrier(
    image: vk::Image,
    aspect: vk::ImageAspectFlags,
    before: Use,
    after: Use,
) -> vk::ImageMemoryBarrier2<'static> {
    vk::ImageMemoryBarrier2::default()
        .image(image)
        .subresource_range(whole(aspect))
        .src_stage_mask(before.stage)
        .src_access_mask(before.access)
        .old_layout(before.layout)
        .dst_stage_mask(after.stage)
        .dst_access_mask(after.access)
        .new_layout(after.layout)
}

/// Records barriers.
pub(super) fn transition(device: &Device, commands: vk::CommandBuffer, barriers: &[vk::ImageMemoryBarrier2<'_>]) {
    let info = vk::DependencyInfo::default().image_memory_barriers(barriers);
    // SAFETY: the command buffer is being recorded, outside of rendering, and the images outlive its execution.
    unsafe { device.handle.cmd_pipeline_barrier2(commands, &info) };
}
