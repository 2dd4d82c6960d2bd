//! Where a window takes pictures.

use std::rc::Rc;

use ash::{khr, vk};
use raw_window_handle::{RawDisplayHandle, RawWindowHandle};

use super::{
    error::{GpuError, failed_to},
    instance::Instance,
};

/// A window's surface; destroyed with its owner, and before the window.
pub(super) struct Surface {
    pub(super) handle: vk::SurfaceKHR,
    functions: khr::surface::Instance,
    /// Kept alive for the surface.
    _instance: Rc<Instance>,
}

impl Surface {
    /// Makes the surface of a window.
    ///
    /// # Errors
    ///
    /// When the display server and the driver do not go together.
    ///
    /// # Safety
    ///
    /// Display and window are alive and outlive the surface.
    pub(super) unsafe fn new(
        instance: &Rc<Instance>,
        display: RawDisplayHandle,
        window: RawWindowHandle,
    ) -> Result<Self, GpuError> {
        // SAFETY: the instance was made with the extensions for this display; the caller answers for the handles.
        let handle = unsafe { ash_window::create_surface(&instance.entry, &instance.handle, display, window, None) }
            .map_err(failed_to("reach the window"))?;
        let functions = khr::surface::Instance::new(&instance.entry, &instance.handle);
        Ok(Self { handle, functions, _instance: Rc::clone(instance) })
    }

    /// Returns whether a queue family of a device can show pictures here.
    pub(super) fn takes_from(&self, physical: vk::PhysicalDevice, family: u32) -> bool {
        // SAFETY: the surface is alive, and the caller took device and family from this surface's instance.
        unsafe { self.functions.get_physical_device_surface_support(physical, family, self.handle) }.unwrap_or(false)
    }

    /// Returns what the surface can do with a device, in which formats and in which ways.
    ///
    /// # Errors
    ///
    /// When the surface is lost.
    pub(super) fn abilities(&self, physical: vk::PhysicalDevice) -> Result<Abilities, GpuError> {
        let what = "fit the window";
        // SAFETY: the surface is alive, and the caller took the device from this surface's instance.
        unsafe {
            let f = &self.functions;
            Ok((
                f.get_physical_device_surface_capabilities(physical, self.handle).map_err(failed_to(what))?,
                f.get_physical_device_surface_formats(physical, self.handle).map_err(failed_to(what))?,
                f.get_physical_device_surface_present_modes(physical, self.handle).map_err(failed_to(what))?,
            ))
        }
    }
}

impl Drop for Surface {
    fn drop(&mut self) {
        // SAFETY: the swapchain holds the surface and so is gone.
        unsafe { self.functions.destroy_surface(self.handle, None) };
    }
}

/// What a surface can do: sizes and usages, formats, ways to present.
pub(super) type Abilities = (vk::SurfaceCapabilitiesKHR, Vec<vk::SurfaceFormatKHR>, Vec<vk::PresentModeKHR>);
