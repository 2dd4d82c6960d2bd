//! Buffers that the processor writes or reads: plain mapped memory, one allocation each.

use std::rc::Rc;

use ash::vk;
use bytemuck::Pod;

use super::{
    device::Device,
    error::{GpuError, failed_to},
};

/// Memory that stays mapped, seen by both sides without flushing.
const WRITTEN: &[vk::MemoryPropertyFlags] = &[
    vk::MemoryPropertyFlags::from_raw(
        vk::MemoryPropertyFlags::DEVICE_LOCAL.as_raw()
            | vk::MemoryPropertyFlags::HOST_VISIBLE.as_raw()
            | vk::MemoryPropertyFlags::HOST_COHERENT.as_raw(),
    ),
    SHARED,
];
const READ: &[vk::MemoryPropertyFlags] =
    &[vk::MemoryPropertyFlags::from_raw(SHARED.as_raw() | vk::MemoryPropertyFlags::HOST_CACHED.as_raw()), SHARED];
const SHARED: vk::MemoryPropertyFlags = vk::MemoryPropertyFlags::from_raw(
    vk::MemoryPropertyFlags::HOST_VISIBLE.as_raw() | vk::MemoryPropertyFlags::HOST_COHERENT.as_raw(),
);

/// A mapped buffer; freed with its owner, who sees to it that the device has finished with it.
pub(super) struct Buffer {
    pub(super) handle: vk::Buffer,
    memory: vk::DeviceMemory,
    mapped: *mut u8,
    /// Size in bytes; `mapped` points to this many.
    size: usize,
    device: Rc<Device>,
}

impl Buffer {
    /// Makes a buffer that the processor writes, of at least one byte.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn written(device: &Rc<Device>, size: usize, usage: vk::BufferUsageFlags) -> Result<Self, GpuError> {
        Self::new(device, size, usage, WRITTEN)
    }

    /// Makes a buffer that the device copies into and the processor reads.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn read_back(device: &Rc<Device>, size: usize) -> Result<Self, GpuError> {
        Self::new(device, size, vk::BufferUsageFlags::TRANSFER_DST, READ)
    }

    fn new(
        device: &Rc<Device>,
        size: usize,
        usage: vk::BufferUsageFlags,
        kinds: &[vk::MemoryPropertyFlags],
    ) -> Result<Self, GpuError> {
        let size = size.max(1);
        let info = vk::BufferCreateInfo::default().size(size as u64).usage(usage);
        // SAFETY: the device is alive, and `info` is a plain exclusive buffer.
        let handle = unsafe { device.handle.create_buffer(&info, None) }.map_err(failed_to("a buffer"))?;
        let mut buffer = Self {
            handle,
            memory: vk::DeviceMemory::null(),
            mapped: std::ptr::null_mut(),
            size,
            device: Rc::clone(device),
        };
        // SAFETY: the buffer was made from this device.
        let needs = unsafe { device.handle.get_buffer_memory_requirements(handle) };
        buffer.memory = device.allocate(needs, kinds, "a buffer")?;
        // SAFETY: the memory is new, fits the buffer's needs, is host visible by `kinds` and is mapped once.
        unsafe {
            device.handle.bind_buffer_memory(handle, buffer.memory, 0).map_err(failed_to("a buffer"))?;
            let mapped = device.handle.map_memory(buffer.memory, 0, vk::WHOLE_SIZE, vk::MemoryMapFlags::empty());
            buffer.mapped = mapped.map_err(failed_to("a buffer"))?.cast();
        }
        Ok(buffer)
    }

    /// Writes values at an offset in bytes.
    ///
    /// # Panics
    ///
    /// When they do not fit.
    pub(super) fn write<T: Pod>(&mut self, offset: usize, values: &[T]) {
        let bytes: &[u8] = bytemuck::cast_slice(values);
        assert!(offset + bytes.len() <= self.size, "{} bytes at {offset} in {}", bytes.len(), self.size);
        // SAFETY: `mapped` points to `size` bytes, the range is inside them, and `&mut self` with one frame in flight
        // means that the device is not reading.
        unsafe { std::ptr::copy_nonoverlapping(bytes.as_ptr(), self.mapped.add(offset), bytes.len()) };
    }

    /// Returns the bytes; the caller has waited for the device to finish writing them.
    pub(super) fn bytes(&self) -> &[u8] {
        // SAFETY: `mapped` points to `size` bytes, which the device initialised before the caller's wait.
        unsafe { std::slice::from_raw_parts(self.mapped, self.size) }
    }

    /// Returns the size in bytes.
    pub(super) fn size(&self) -> usize {
        self.size
    }
}

impl Drop for Buffer {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device; freeing unmaps, and freeing nothing is allowed.
        unsafe {
            self.device.handle.destroy_buffer(self.handle, None);
            self.device.handle.free_memory(self.memory, None);
        }
    }
}

/// Instances that change in number: a buffer that grows and never shrinks.
pub(super) struct Instances {
    buffer: Buffer,
    count: u32,
}

impl Instances {
    /// Makes an empty list.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        Ok(Self { buffer: Buffer::written(device, 4096, vk::BufferUsageFlags::VERTEX_BUFFER)?, count: 0 })
    }

    /// Replaces the list; the device must not be reading it.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set<T: Pod>(&mut self, values: &[T]) -> Result<(), GpuError> {
        let size = size_of_val(values);
        if size > self.buffer.size() {
            let device = Rc::clone(&self.buffer.device);
            self.buffer = Buffer::written(&device, size.next_power_of_two(), vk::BufferUsageFlags::VERTEX_BUFFER)?;
        }
        self.buffer.write(0, values);
        self.count = values.len() as u32;
        Ok(())
    }

    /// Returns the buffer.
    pub(super) fn handle(&self) -> vk::Buffer {
        self.buffer.handle
    }

    /// Returns how many there are.
    pub(super) fn count(&self) -> u32 {
        self.count
    }
}
