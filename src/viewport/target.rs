//! What a picture is drawn into: colour and depth of one size.

use std::rc::Rc;

use ash::vk;

use super::{
    device::Device,
    error::GpuError,
    image::{Image, ImageSpec, Use, barrier},
};

/// Format of every picture: eight bits a channel, written as linear light and stored as sRGB.
pub(super) const COLOUR_FORMAT: vk::Format = vk::Format::R8G8B8A8_SRGB;
/// Format of every depth image.
pub(super) const DEPTH_FORMAT: vk::Format = vk::Format::D32_SFLOAT;

/// The images of a picture.
pub(super) struct Target {
    pub(super) extent: vk::Extent2D,
    /// The finished picture, one sample a pixel.
    pub(super) picture: Image,
    /// What is drawn into when there are several samples a pixel.
    multisampled: Option<Image>,
    depth: Image,
}

impl Target {
    /// Makes the images.
    ///
    /// # Errors
    ///
    /// When a side is zero or longer than the device can draw, or memory has run out.
    pub(super) fn new(
        device: &Rc<Device>,
        extent: vk::Extent2D,
        samples: vk::SampleCountFlags,
    ) -> Result<Self, GpuError> {
        let limits = &device.properties.limits;
        let limit = limits.max_image_dimension2_d.min(limits.max_framebuffer_width).min(limits.max_framebuffer_height);
        if extent.width.min(extent.height) == 0 || extent.width.max(extent.height) > limit {
            return Err(GpuError::BadSize { width: extent.width, height: extent.height, limit });
        }
        let drawn = vk::ImageUsageFlags::COLOR_ATTACHMENT;
        let colour = ImageSpec {
            extent,
            format: COLOUR_FORMAT,
            samples: vk::SampleCountFlags::TYPE_1,
            usage: drawn | vk::ImageUsageFlags::TRANSFER_SRC,
            aspect: vk::ImageAspectFlags::COLOR,
        };
        let multisampled = ImageSpec { samples, usage: drawn, ..colour };
        let depth = ImageSpec {
            format: DEPTH_FORMAT,
            samples,
            usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT,
            aspect: vk::ImageAspectFlags::DEPTH,
            ..colour
        };
        let several = samples != vk::SampleCountFlags::TYPE_1;
        Ok(Self {
            extent,
            picture: Image::new(device, &colour, "the picture")?,
            multisampled: several.then(|| Image::new(device, &multisampled, "the picture")).transpose()?,
            depth: Image::new(device, &depth, "the picture")?,
        })
    }

    /// Returns the barriers before drawing; what the images held is forgotten.
    pub(super) fn before_drawing(&self) -> Vec<vk::ImageMemoryBarrier2<'static>> {
        let colour = vk::ImageAspectFlags::COLOR;
        // The last picture may still be being copied away.
        let copied = Use::discard(Use::COPIED.stage);
        let drawn = Use::discard(Use::COLOUR.stage);
        let tested = Use { layout: vk::ImageLayout::UNDEFINED, ..Use::DEPTH };
        let mut barriers = vec![
            barrier(self.picture.handle, colour, copied, Use::COLOUR),
            barrier(self.depth.handle, vk::ImageAspectFlags::DEPTH, tested, Use::DEPTH),
        ];
        barriers.extend(self.multisampled.iter().map(|m| barrier(m.handle, colour, drawn, Use::COLOUR)));
        barriers
    }

    /// Returns the colour attachment, cleared to a colour in linear light.
    pub(super) fn colour_attachment(&self, clear: [f32; 4]) -> vk::RenderingAttachmentInfo<'static> {
        let attachment = vk::RenderingAttachmentInfo::default()
            .image_layout(Use::COLOUR.layout)
            .load_op(vk::AttachmentLoadOp::CLEAR)
            .clear_value(vk::ClearValue { color: vk::ClearColorValue { float32: clear } });
        match &self.multisampled {
            Some(many) => attachment
                .image_view(many.view)
                .store_op(vk::AttachmentStoreOp::DONT_CARE)
                .resolve_mode(vk::ResolveModeFlags::AVERAGE)
                .resolve_image_view(self.picture.view)
                .resolve_image_layout(Use::COLOUR.layout),
            None => attachment.image_view(self.picture.view).store_op(vk::AttachmentStoreOp::STORE),
        }
    }

    /// Returns the finished picture as an attachment, to be drawn over.
    pub(super) fn finished_attachment(&self) -> vk::RenderingAttachmentInfo<'static> {
        vk::RenderingAttachmentInfo::default()
            .image_view(self.picture.view)
            .image_layout(Use::COLOUR.layout)
            .load_op(vk::AttachmentLoadOp::LOAD)
            .store_op(vk::AttachmentStoreOp::STORE)
    }

    /// Returns the depth attachment, cleared to the far plane.
    pub(super) fn depth_attachment(&self) -> vk::RenderingAttachmentInfo<'static> {
        depth_attachment(&self.depth, vk::AttachmentStoreOp::DONT_CARE)
    }
}

/// Returns a depth attachment that starts at the far plane.
pub(super) fn depth_attachment(image: &Image, store: vk::AttachmentStoreOp) -> vk::RenderingAttachmentInfo<'static> {
    vk::RenderingAttachmentInfo::default()
        .image_view(image.view)
        .image_layout(Use::DEPTH.layout)
        .load_op(vk::AttachmentLoadOp::CLEAR)
        .store_op(store)
        .clear_value(vk::ClearValue { depth_stencil: vk::ClearDepthStencilValue { depth: 1.0, stencil: 0 } })
}
