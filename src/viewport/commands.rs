//! One frame in flight: a command buffer and the fence that says it is done.

use std::rc::Rc;

use ash::vk;

use super::{
    device::Device,
    error::{GpuError, failed_to},
};

/// How long a frame may take before the device counts as lost; a processor draws the largest pictures in seconds.
const PATIENCE_NANOS: u64 = 60_000_000_000;

/// The one command buffer; its owner waits before anything it uses is changed or freed.
pub(super) struct Commands {
    pool: vk::CommandPool,
    pub(super) buffer: vk::CommandBuffer,
    done: vk::Fence,
    device: Rc<Device>,
}

/// A semaphore to wait for, and the stage that waits.
pub(super) type WaitFor = (vk::Semaphore, vk::PipelineStageFlags2);

impl Commands {
    /// Makes them; nothing is in flight.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        let what = "set up its commands";
        let mut commands = Self {
            pool: vk::CommandPool::null(),
            buffer: vk::CommandBuffer::null(),
            done: vk::Fence::null(),
            device: Rc::clone(device),
        };
        let pool = vk::CommandPoolCreateInfo::default().queue_family_index(device.queue_family);
        let fence = vk::FenceCreateInfo::default().flags(vk::FenceCreateFlags::SIGNALED);
        // SAFETY: the device is alive and the queue family is its own.
        unsafe {
            commands.pool = device.handle.create_command_pool(&pool, None).map_err(failed_to(what))?;
            commands.done = device.handle.create_fence(&fence, None).map_err(failed_to(what))?;
        }
        let info = vk::CommandBufferAllocateInfo::default().command_pool(commands.pool).command_buffer_count(1);
        // SAFETY: the pool was just made.
        commands.buffer = unsafe { device.handle.allocate_command_buffers(&info) }.map_err(failed_to(what))?[0];
        Ok(commands)
    }

    /// Waits for the frame in flight, if there is one.
    ///
    /// # Errors
    ///
    /// When the device is lost.
    pub(super) fn wait(&self) -> Result<(), GpuError> {
        // SAFETY: the fence is this device's.
        let waited = unsafe { self.device.handle.wait_for_fences(&[self.done], true, PATIENCE_NANOS) };
        waited.map_err(|result| match result {
            vk::Result::TIMEOUT => GpuError::DeviceLost,
            other => failed_to("draw")(other),
        })
    }

    /// Starts recording; the frame before has been waited for.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn begin(&self) -> Result<vk::CommandBuffer, GpuError> {
        let info = vk::CommandBufferBeginInfo::default().flags(vk::CommandBufferUsageFlags::ONE_TIME_SUBMIT);
        // SAFETY: the caller has waited, so the pool's only buffer is not in use.
        unsafe {
            self.device
                .handle
                .reset_command_pool(self.pool, vk::CommandPoolResetFlags::empty())
                .map_err(failed_to("draw"))?;
            self.device.handle.begin_command_buffer(self.buffer, &info).map_err(failed_to("draw"))?;
        }
        Ok(self.buffer)
    }

    /// Ends recording and hands the frame to the device.
    ///
    /// # Errors
    ///
    /// When the device is lost.
    pub(super) fn submit(&self, wait: Option<WaitFor>, signal: Option<vk::Semaphore>) -> Result<(), GpuError> {
        let buffers = [vk::CommandBufferSubmitInfo::default().command_buffer(self.buffer)];
        let waits: Vec<_> = wait
            .iter()
            .map(|&(semaphore, stage)| vk::SemaphoreSubmitInfo::default().semaphore(semaphore).stage_mask(stage))
            .collect();
        let signals: Vec<_> = signal
            .iter()
            .map(|&semaphore| {
                vk::SemaphoreSubmitInfo::default()
                    .semaphore(semaphore)
                    .stage_mask(vk::PipelineStageFlags2::ALL_COMMANDS)
            })
            .collect();
        let info = vk::SubmitInfo2::default()
            .command_buffer_infos(&buffers)
            .wait_semaphore_infos(&waits)
            .signal_semaphore_infos(&signals);
        let device = &self.device.handle;
        // SAFETY: the buffer was recorded, what it uses is kept until `wait`, and the fence is not in use. It is reset
        // only here, so that a frame which was never submitted is never waited for.
        unsafe {
            device.end_command_buffer(self.buffer).map_err(failed_to("draw"))?;
            device.reset_fences(&[self.done]).map_err(failed_to("draw"))?;
            device.queue_submit2(self.device.queue, &[info], self.done).map_err(failed_to("draw"))
        }
    }
}

impl Drop for Commands {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device; the buffer goes with its pool.
        unsafe {
            self.device.handle.destroy_fence(self.done, None);
            self.device.handle.destroy_command_pool(self.pool, None);
        }
    }
}
