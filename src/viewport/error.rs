//! Why there is no picture, in words that say what would bring it.

use ash::vk;

/// A reason that Vulkan cannot draw.
#[derive(Debug, thiserror::Error)]
pub enum GpuError {
    /// The Vulkan loader library is not installed.
    #[error("there is no Vulkan loader on this machine; install libvulkan1 (Debian, Ubuntu) or vulkan-loader ({0})")]
    NoLoader(String),
    /// The loader is there, but no driver works.
    #[error(
        "there is no Vulkan driver on this machine; install the graphics card's, or mesa-vulkan-drivers, which also \
         draws without a card"
    )]
    NoDriver,
    /// There are devices, but none can do what is needed.
    #[error("no Vulkan device will do: {}; a newer driver may help", .0.join(", "))]
    NoDevice(
        /// Each device with what it lacks.
        Vec<String>,
    ),
    /// The surface has none of the colour formats that a picture can be copied to.
    #[error("the window's surface offers no 8-bit sRGB format; another display server or driver may")]
    NoSurfaceFormat,
    /// A picture with no pixels or with more than the device can draw.
    #[error("a picture of {width}×{height} pixels cannot be drawn; each side must be from 1 to {limit}")]
    BadSize {
        /// Width asked for.
        width: u32,
        /// Height asked for.
        height: u32,
        /// The longest side that the device can draw.
        limit: u32,
    },
    /// The device is out of memory.
    #[error("the graphics device has no memory left for {0}; a smaller picture may fit")]
    NoMemory(&'static str),
    /// The device stopped working, or was taken away.
    #[error("the graphics device stopped working")]
    DeviceLost,
    /// The window's surface is gone.
    #[error("the window's surface was lost")]
    SurfaceLost,
    /// Any other failure, by the name of what was tried.
    #[error("the graphics driver failed to {what}: {result}")]
    Failed {
        /// What was tried, in words.
        what: &'static str,
        /// What the driver answered.
        result: vk::Result,
    },
}

/// Returns a function that says what was tried when Vulkan answers with an error.
pub(super) fn failed_to(what: &'static str) -> impl FnOnce(vk::Result) -> GpuError {
    move |result| match result {
        vk::Result::ERROR_DEVICE_LOST => GpuError::DeviceLost,
        vk::Result::ERROR_SURFACE_LOST_KHR => GpuError::SurfaceLost,
        vk::Result::ERROR_OUT_OF_DEVICE_MEMORY | vk::Result::ERROR_OUT_OF_HOST_MEMORY => GpuError::NoMemory(what),
        result => GpuError::Failed { what, result },
    }
}
