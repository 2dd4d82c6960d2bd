//! The images that go onto a window's surface.
//!
//! Resizing, minimising and images that no longer fit are ordinary results ([`Shown`]), not errors.

use std::rc::Rc;

use ash::{khr, vk};

use super::{
    device::Device,
    error::{GpuError, failed_to},
    image::{Use, barrier, colour_layers, transition},
    renderer::Renderer,
    surface::Surface,
};
use crate::scene::Scene;

/// How long to wait for the display to give an image back; it may keep all of them while a window is covered.
const PATIENCE_NANOS: u64 = 200_000_000;

/// Formats that a picture can be copied to without changing its colours, best first.
const FORMATS: [vk::Format; 3] =
    [vk::Format::B8G8R8A8_SRGB, vk::Format::R8G8B8A8_SRGB, vk::Format::A8B8G8R8_SRGB_PACK32];

/// What became of a picture.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Shown {
    /// It is on its way to the screen.
    Yes,
    /// The window has changed, or the display has no image to spare: draw again soon.
    Again,
    /// The window has no area: draw when it has one again.
    NoArea,
}

/// The images of a surface, made anew when they no longer fit.
pub(super) struct Swapchain {
    functions: khr::swapchain::Device,
    /// The images in use; none before the first picture and while the window has no area.
    chain: Option<Chain>,
    /// Set when the display says that the images no longer fit.
    stale: bool,
    device: Rc<Device>,
    surface: Surface,
}

/// One set of images.
struct Chain {
    handle: vk::SwapchainKHR,
    images: Vec<vk::Image>,
    extent: vk::Extent2D,
    /// Says that the display has given an image back.
    given: vk::Semaphore,
    /// For each image: says that it is drawn. One for each, because the display may still be waiting for the others.
    drawn: Vec<vk::Semaphore>,
}

impl Swapchain {
    /// Makes an empty swapchain for a surface that the device can present to.
    pub(super) fn new(device: &Rc<Device>, surface: Surface) -> Self {
        let functions = khr::swapchain::Device::new(&device.instance.handle, &device.handle);
        Self { functions, chain: None, stale: false, device: Rc::clone(device), surface }
    }

    /// Draws a scene and shows it in a window of this size in pixels.
    ///
    /// # Errors
    ///
    /// When the surface or the device is lost.
    pub(super) fn show(
        &mut self,
        renderer: &mut Renderer,
        scene: &Scene,
        window: vk::Extent2D,
        before_present: impl FnOnce(),
    ) -> Result<Shown, GpuError> {
        // The frame before uses the semaphores and the images.
        renderer.wait()?;
        let fits = self.chain.as_ref().is_some_and(|c| !self.stale && c.extent == window);
        if !fits && !self.rebuild(window)? {
            return Ok(Shown::NoArea);
        }
        let chain = self.chain.as_ref().expect("made above");
        // SAFETY: the swapchain is alive, and nothing waits for `given`: the frame before was waited for.
        let acquired =
            unsafe { self.functions.acquire_next_image(chain.handle, PATIENCE_NANOS, chain.given, vk::Fence::null()) };
        let index = match acquired {
            Ok((index, suboptimal)) => {
                self.stale |= suboptimal;
                index
            }
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.stale = true;
                return Ok(Shown::Again);
            }
            Err(vk::Result::TIMEOUT | vk::Result::NOT_READY) => return Ok(Shown::Again),
            Err(other) => return Err(failed_to("show a picture")(other)),
        };
        let (image, drawn) = (chain.images[index as usize], chain.drawn[index as usize]);
        let extent = chain.extent;
        let wait = (chain.given, Use::OVERWRITTEN.stage);
        renderer.draw(scene, extent, Some(wait), Some(drawn), |renderer, commands, picture| {
            copy(&renderer.device, commands, picture, image, extent);
            Ok(())
        })?;
        before_present();
        let (waits, chains, indices) = ([drawn], [chain.handle], [index]);
        let info = vk::PresentInfoKHR::default().wait_semaphores(&waits).swapchains(&chains).image_indices(&indices);
        // SAFETY: the image was acquired and left in the layout for presenting; the queue is used by this thread only.
        match unsafe { self.functions.queue_present(self.device.queue, &info) } {
            Ok(suboptimal) => self.stale |= suboptimal,
            Err(vk::Result::ERROR_OUT_OF_DATE_KHR) => {
                self.stale = true;
                return Ok(Shown::Again);
            }
            Err(other) => return Err(failed_to("show a picture")(other)),
        }
        // A suboptimal picture was shown; the next one gets new images. Some displays always say so.
        Ok(Shown::Yes)
    }

    /// Makes images that fit the window; false when it has no area.
    fn rebuild(&mut self, window: vk::Extent2D) -> Result<bool, GpuError> {
        let what = "fit the window";
        let (can, formats, modes) = self.surface.abilities(self.device.physical)?;
        let extent = extent(&can, window);
        if extent.width == 0 || extent.height == 0 {
            return Ok(false);
        }
        let format = FORMATS
            .iter()
            .find_map(|wanted| formats.iter().find(|f| f.format == *wanted))
            .ok_or(GpuError::NoSurfaceFormat)?;
        if !can.supported_usage_flags.contains(vk::ImageUsageFlags::TRANSFER_DST) {
            return Err(GpuError::NoSurfaceFormat);
        }
        // Mailbox shows the newest picture without waiting; every device has FIFO.
        let mode = if modes.contains(&vk::PresentModeKHR::MAILBOX) {
            vk::PresentModeKHR::MAILBOX
        } else {
            vk::PresentModeKHR::FIFO
        };
        let most = if can.max_image_count == 0 { u32::MAX } else { can.max_image_count };
        // The old images are not in use, because the frame before was waited for; the display may still show one.
        self.device.wait_idle();
        let old = self.chain.take();
        let info = vk::SwapchainCreateInfoKHR::default()
            .surface(self.surface.handle)
            .min_image_count((can.min_image_count + 1).min(most))
            .image_format(format.format)
            .image_color_space(format.color_space)
            .image_extent(extent)
            .image_array_layers(1)
            .image_usage(vk::ImageUsageFlags::TRANSFER_DST)
            .pre_transform(can.current_transform)
            .composite_alpha(opaque(can.supported_composite_alpha))
            .present_mode(mode)
            .clipped(true)
            .old_swapchain(old.as_ref().map_or(vk::SwapchainKHR::null(), |c| c.handle));
        // SAFETY: the surface is alive, and the description lies within what it can do.
        let made = unsafe { self.functions.create_swapchain(&info, None) };
        if let Some(old) = old {
            self.destroy(&old);
        }
        let mut chain = Chain {
            handle: made.map_err(failed_to(what))?,
            images: Vec::new(),
            extent,
            given: vk::Semaphore::null(),
            drawn: Vec::new(),
        };
        let filled = self.fill(&mut chain);
        self.chain = Some(chain);
        self.stale = false;
        filled.map(|()| true)
    }

    /// Completes a new chain; what was made when this fails is in it.
    fn fill(&self, chain: &mut Chain) -> Result<(), GpuError> {
        let what = "fit the window";
        let semaphore = || {
            // SAFETY: the device is alive.
            unsafe { self.device.handle.create_semaphore(&vk::SemaphoreCreateInfo::default(), None) }
                .map_err(failed_to(what))
        };
        // SAFETY: the swapchain was just made.
        chain.images = unsafe { self.functions.get_swapchain_images(chain.handle) }.map_err(failed_to(what))?;
        chain.given = semaphore()?;
        for _ in &chain.images {
            chain.drawn.push(semaphore()?);
        }
        Ok(())
    }

    fn destroy(&self, chain: &Chain) {
        // SAFETY: the device is idle, so neither semaphores nor images are in use; destroying nothing is allowed.
        unsafe {
            for semaphore in chain.drawn.iter().chain([&chain.given]) {
                self.device.handle.destroy_semaphore(*semaphore, None);
            }
            self.functions.destroy_swapchain(chain.handle, None);
        }
    }
}

impl Drop for Swapchain {
    fn drop(&mut self) {
        self.device.wait_idle();
        if let Some(chain) = self.chain.take() {
            self.destroy(&chain);
        }
    }
}

/// Records the copy of a picture onto an image of the surface, which is then ready to be presented.
fn copy(device: &Device, commands: vk::CommandBuffer, picture: vk::Image, image: vk::Image, extent: vk::Extent2D) {
    let colour = vk::ImageAspectFlags::COLOR;
    let fresh = Use::discard(Use::OVERWRITTEN.stage);
    transition(device, commands, &[barrier(image, colour, fresh, Use::OVERWRITTEN)]);
    let corner = vk::Offset3D { x: extent.width as i32, y: extent.height as i32, z: 1 };
    let region = vk::ImageBlit::default()
        .src_subresource(colour_layers())
        .src_offsets([vk::Offset3D::default(), corner])
        .dst_subresource(colour_layers())
        .dst_offsets([vk::Offset3D::default(), corner]);
    // SAFETY: both images are in their layouts and of this size; blits between 8-bit sRGB formats are required.
    unsafe {
        device.handle.cmd_blit_image(
            commands,
            picture,
            Use::COPIED.layout,
            image,
            Use::OVERWRITTEN.layout,
            &[region],
            vk::Filter::NEAREST,
        );
    }
    transition(device, commands, &[barrier(image, colour, Use::OVERWRITTEN, Use::PRESENTED)]);
}

/// The surface's own size, or the window's where the surface leaves it open (Wayland).
fn extent(can: &vk::SurfaceCapabilitiesKHR, window: vk::Extent2D) -> vk::Extent2D {
    if can.current_extent.width == u32::MAX {
        let (least, most) = (can.min_image_extent, can.max_image_extent);
        vk::Extent2D {
            width: window.width.clamp(least.width.min(most.width), most.width),
            height: window.height.clamp(least.height.min(most.height), most.height),
        }
    } else {
        can.current_extent
    }
}

/// Opaque where that can be said, else whatever the surface does.
fn opaque(offered: vk::CompositeAlphaFlagsKHR) -> vk::CompositeAlphaFlagsKHR {
    use vk::CompositeAlphaFlagsKHR as Alpha;
    [Alpha::OPAQUE, Alpha::INHERIT, Alpha::PRE_MULTIPLIED, Alpha::POST_MULTIPLIED]
        .into_iter()
        .find(|a| offered.contains(*a))
        .unwrap_or(Alpha::OPAQUE)
}
