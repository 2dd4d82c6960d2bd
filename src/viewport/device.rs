//! The Vulkan device: which one is chosen, its queue and its memory.

use std::{ffi::CStr, rc::Rc};

use ash::{khr, vk};

use super::{
    error::{GpuError, failed_to},
    instance::Instance,
    surface::Surface,
};

/// Which kind of Vulkan device to draw with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum DeviceChoice {
    /// A graphics card, else integrated graphics, else the processor.
    #[default]
    Best,
    /// The processor (lavapipe), whatever else there is: the same pictures on every machine.
    Processor,
}

/// A device and its one queue; destroyed with its last owner.
pub(super) struct Device {
    pub(super) handle: ash::Device,
    pub(super) physical: vk::PhysicalDevice,
    pub(super) queue: vk::Queue,
    pub(super) queue_family: u32,
    pub(super) properties: vk::PhysicalDeviceProperties,
    /// Driver name and version in words.
    pub(super) driver: String,
    memory: vk::PhysicalDeviceMemoryProperties,
    pub(super) instance: Rc<Instance>,
}

/// A device that would do, before it is opened.
struct Candidate {
    physical: vk::PhysicalDevice,
    queue_family: u32,
    properties: vk::PhysicalDeviceProperties,
    driver: String,
}

impl Device {
    /// Opens the device of choice.
    ///
    /// # Errors
    ///
    /// When there is none, or none that offers Vulkan 1.3, a graphics queue and, if asked, a way to the surface.
    pub(super) fn new(
        instance: Rc<Instance>,
        choice: DeviceChoice,
        present: Option<&Surface>,
    ) -> Result<Rc<Self>, GpuError> {
        let chosen = choose(&instance, choice, present)?;
        let queues =
            [vk::DeviceQueueCreateInfo::default().queue_family_index(chosen.queue_family).queue_priorities(&[1.0])];
        let mut features = vk::PhysicalDeviceVulkan13Features::default().dynamic_rendering(true).synchronization2(true);
        let extensions = [khr::swapchain::NAME.as_ptr()];
        let info = vk::DeviceCreateInfo::default()
            .queue_create_infos(&queues)
            .enabled_extension_names(if present.is_some() { &extensions } else { &[] })
            .push_next(&mut features);
        // SAFETY: `physical` came from this instance, and `info` points to locals that outlive the call.
        let handle = unsafe { instance.handle.create_device(chosen.physical, &info, None) }
            .map_err(failed_to("open its device"))?;
        // SAFETY: the device was made with one queue in this family.
        let queue = unsafe { handle.get_device_queue(chosen.queue_family, 0) };
        // SAFETY: `physical` came from this instance.
        let memory = unsafe { instance.handle.get_physical_device_memory_properties(chosen.physical) };
        Ok(Rc::new(Self {
            handle,
            physical: chosen.physical,
            queue,
            queue_family: chosen.queue_family,
            properties: chosen.properties,
            driver: chosen.driver,
            memory,
            instance,
        }))
    }

    /// Returns the device's name as the driver gives it.
    pub(super) fn name(&self) -> String {
        text(self.properties.device_name_as_c_str())
    }

    /// Allocates memory for a resource, of the first kind in `wishes` that the device has.
    ///
    /// # Errors
    ///
    /// When memory has run out, which names `what`.
    pub(super) fn allocate(
        &self,
        needs: vk::MemoryRequirements,
        wishes: &[vk::MemoryPropertyFlags],
        what: &'static str,
    ) -> Result<vk::DeviceMemory, GpuError> {
        let types = self.memory.memory_types_as_slice();
        let find = |wish: &vk::MemoryPropertyFlags| {
            let fits = |i: usize| needs.memory_type_bits & (1 << i) != 0 && types[i].property_flags.contains(*wish);
            (0..types.len()).find(|&i| fits(i))
        };
        let index = wishes.iter().find_map(find).ok_or(GpuError::NoMemory(what))?;
        let info = vk::MemoryAllocateInfo::default().allocation_size(needs.size).memory_type_index(index as u32);
        // SAFETY: the memory type index is one of the device's.
        unsafe { self.handle.allocate_memory(&info, None) }.map_err(failed_to(what))
    }

    /// Returns the sample count to draw with: 4 where colour and depth both offer it, else 1.
    pub(super) fn samples(&self) -> vk::SampleCountFlags {
        let limits = &self.properties.limits;
        let both = limits.framebuffer_color_sample_counts & limits.framebuffer_depth_sample_counts;
        if both.contains(vk::SampleCountFlags::TYPE_4) {
            vk::SampleCountFlags::TYPE_4
        } else {
            vk::SampleCountFlags::TYPE_1
        }
    }

    /// Waits until the device has nothing left to do. A lost device has nothing left to do either.
    pub(super) fn wait_idle(&self) {
        // SAFETY: the queue is used by this thread only, because `Rc` keeps the device in it.
        let _ = unsafe { self.handle.device_wait_idle() };
    }
}

impl Drop for Device {
    fn drop(&mut self) {
        // SAFETY: everything made from the device holds it by `Rc` and so is gone.
        unsafe { self.handle.destroy_device(None) };
    }
}

fn choose(instance: &Instance, choice: DeviceChoice, present: Option<&Surface>) -> Result<Candidate, GpuError> {
    // SAFETY: the instance is alive.
    let devices = unsafe { instance.handle.enumerate_physical_devices() }.map_err(failed_to("list its devices"))?;
    if devices.is_empty() {
        return Err(GpuError::NoDriver);
    }
    let mut refused = Vec::new();
    let mut candidates = Vec::new();
    for physical in devices {
        match examine(instance, physical, choice, present) {
            Ok(candidate) => candidates.push(candidate),
            Err(why) => refused.push(why),
        }
    }
    // The first of the best kind: the loader's order is the user's preference.
    candidates.into_iter().min_by_key(|c| rank(c.properties.device_type)).ok_or(GpuError::NoDevice(refused))
}

fn rank(kind: vk::PhysicalDeviceType) -> u32 {
    match kind {
        vk::PhysicalDeviceType::DISCRETE_GPU => 0,
        vk::PhysicalDeviceType::INTEGRATED_GPU => 1,
        vk::PhysicalDeviceType::VIRTUAL_GPU => 2,
        vk::PhysicalDeviceType::CPU => 3,
        _ => 4,
    }
}

/// Looks at one device; the error names it and says what it lacks.
fn examine(
    instance: &Instance,
    physical: vk::PhysicalDevice,
    choice: DeviceChoice,
    present: Option<&Surface>,
) -> Result<Candidate, String> {
    // SAFETY: `physical` came from this instance, as it does in the calls below.
    let properties = unsafe { instance.handle.get_physical_device_properties(physical) };
    let name = text(properties.device_name_as_c_str());
    if choice == DeviceChoice::Processor && properties.device_type != vk::PhysicalDeviceType::CPU {
        return Err(format!("{name} is not the processor"));
    }
    let (major, minor) = (vk::api_version_major(properties.api_version), vk::api_version_minor(properties.api_version));
    if (major, minor) < (1, 3) {
        return Err(format!("{name} offers Vulkan {major}.{minor} and 1.3 is needed"));
    }
    let mut driver = vk::PhysicalDeviceDriverProperties::default();
    let mut more = vk::PhysicalDeviceProperties2::default().push_next(&mut driver);
    // SAFETY: both structures are of Vulkan 1.2, which the device offers.
    unsafe { instance.handle.get_physical_device_properties2(physical, &mut more) };
    let driver = format!("{} {}", text(driver.driver_name_as_c_str()), text(driver.driver_info_as_c_str()));
    if present.is_some() && !has_extension(instance, physical, khr::swapchain::NAME) {
        return Err(format!("{name} cannot draw in windows"));
    }
    // SAFETY: as above.
    let families = unsafe { instance.handle.get_physical_device_queue_family_properties(physical) };
    let presents = |family: u32| present.is_none_or(|surface| surface.takes_from(physical, family));
    let queue_family = families
        .iter()
        .zip(0..)
        .find(|&(f, i)| f.queue_flags.contains(vk::QueueFlags::GRAPHICS) && presents(i))
        .map(|(_, i)| i)
        .ok_or_else(|| format!("{name} has no graphics queue for this display"))?;
    Ok(Candidate { physical, queue_family, properties, driver: driver.trim().to_owned() })
}

fn has_extension(instance: &Instance, physical: vk::PhysicalDevice, name: &CStr) -> bool {
    // SAFETY: `physical` came from this instance.
    let all = unsafe { instance.handle.enumerate_device_extension_properties(physical) }.unwrap_or_default();
    all.iter().any(|e| e.extension_name_as_c_str() == Ok(name))
}

fn text<E>(c_text: Result<&CStr, E>) -> String {
    c_text.map_or_else(|_| "unnamed".to_owned(), |t| t.to_string_lossy().into_owned())
}
