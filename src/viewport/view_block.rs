//! What the shaders get of each view: a uniform block, written by the processor, read at a dynamic offset.

use std::rc::Rc;

use ash::vk;
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, DVec3};

use super::{
    batch,
    buffer::Buffer,
    camera::{Bounds, Lens, Tile},
    device::Device,
    error::{GpuError, failed_to},
    pipeline::Layouts,
    shadow::{ShadowMap, TO_LIGHT},
};
use crate::scene::{Ground, MAX_VIEWS, Role};

/// The `View` of `shaders/view.wgsl`, field by field.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
pub(super) struct ViewBlock {
    view_proj: [[f32; 4]; 4],
    light_view_proj: [[f32; 4]; 4],
    eye: [f32; 4],
    forward: [f32; 4],
    right: [f32; 4],
    up: [f32; 4],
    light: [f32; 4],
    ground: [f32; 4],
    ground_colour: [f32; 4],
    grid_phase: [f32; 4],
    line: [f32; 4],
}

/// Ribbons are drawn this far before what they lie on, in body heights.
const RIBBON_LIFT_HEIGHTS: f64 = 0.012;

/// What all views of a picture have in common.
pub(super) struct Common<'a> {
    pub(super) origin: DVec3,
    pub(super) bounds: &'a Bounds,
    pub(super) body_height: f64,
    pub(super) ground: Option<&'a Ground>,
    /// Width of a path in pixels.
    pub(super) line_width: f64,
}

impl ViewBlock {
    /// Describes one view; `light` is the matrix from the world to its shadow map.
    pub(super) fn new(common: &Common<'_>, lens: &Lens, tile: Tile, light: DMat4) -> Self {
        let origin = common.origin;
        let height = common.ground.map_or(0.0, |g| g.height) - origin.y;
        let (right, up) = lens.spread();
        let [r, g, b, _] = batch::colour(Role::Ground);
        Self {
            view_proj: lens.matrix(origin, common.bounds, common.body_height).as_mat4().to_cols_array_2d(),
            light_view_proj: light.as_mat4().to_cols_array_2d(),
            eye: vec4(lens.eye - origin, if lens.is_perspective() { 1.0 } else { 0.0 }),
            forward: vec4(lens.forward, common.body_height * RIBBON_LIFT_HEIGHTS),
            right: vec4(right, f64::from(tile.width)),
            up: vec4(up, f64::from(tile.height)),
            light: vec4(TO_LIGHT, height),
            ground: common.ground.map_or([0.0; 4], |g| patch(g, origin)),
            ground_colour: [r, g, b, common.body_height as f32],
            grid_phase: common.ground.map_or([0.0; 4], |g| phase(g, origin)),
            line: [common.line_width as f32, 0.0, 0.0, 0.0],
        }
    }
}

fn vec4(v: DVec3, w: f64) -> [f32; 4] {
    v.extend(w).as_vec4().to_array()
}

fn patch(ground: &Ground, origin: DVec3) -> [f32; 4] {
    let centre = ground.centre - origin;
    [centre.x, centre.z, ground.half_extent, sane_cell(ground)].map(|v| v as f32)
}

/// Where the origin lies in its grid cell and in its larger cell, so that lines are at multiples of the cell's size in
/// the world however far the origin is from the world's.
fn phase(ground: &Ground, origin: DVec3) -> [f32; 4] {
    let (cell, large) = (sane_cell(ground), sane_cell(ground) * batch::GRID_STEP);
    [origin.x.rem_euclid(cell), origin.z.rem_euclid(cell), origin.x.rem_euclid(large), origin.z.rem_euclid(large)]
        .map(|v| v as f32)
}

/// A cell that can be divided by.
fn sane_cell(ground: &Ground) -> f64 {
    if ground.cell > 0.0 { ground.cell } else { ground.half_extent.max(1e-9) }
}

/// The blocks of a picture's views in one buffer, with the descriptor sets that the shaders see them through.
pub(super) struct ViewBlocks {
    buffer: Buffer,
    /// Bytes from one block to the next.
    stride: usize,
    pool: vk::DescriptorPool,
    /// One for each shadow map; one alone when there is none.
    sets: Vec<vk::DescriptorSet>,
    device: Rc<Device>,
}

impl ViewBlocks {
    /// Makes room for as many views as a picture has and binds the shadow maps, if there are any.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>, layouts: &Layouts, shadows: &[ShadowMap]) -> Result<Self, GpuError> {
        let what = "set up its views";
        let n_sets = shadows.len().max(1) as u32;
        let size = |kind| vk::DescriptorPoolSize::default().ty(kind).descriptor_count(n_sets);
        let sizes = [
            size(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC),
            size(vk::DescriptorType::SAMPLED_IMAGE),
            size(vk::DescriptorType::SAMPLER),
        ];
        let info = vk::DescriptorPoolCreateInfo::default().max_sets(n_sets).pool_sizes(&sizes);
        let align = device.properties.limits.min_uniform_buffer_offset_alignment.max(1) as usize;
        let stride = size_of::<ViewBlock>().next_multiple_of(align);
        let buffer = Buffer::written(device, stride * MAX_VIEWS, vk::BufferUsageFlags::UNIFORM_BUFFER)?;
        // SAFETY: the device is alive and `info` points to locals.
        let pool = unsafe { device.handle.create_descriptor_pool(&info, None) }.map_err(failed_to(what))?;
        let mut blocks = Self { buffer, stride, pool, sets: Vec::new(), device: Rc::clone(device) };
        let layout = vec![layouts.view_set; n_sets as usize];
        let info = vk::DescriptorSetAllocateInfo::default().descriptor_pool(pool).set_layouts(&layout);
        // SAFETY: the pool has room for this many sets.
        blocks.sets = unsafe { device.handle.allocate_descriptor_sets(&info) }.map_err(failed_to(what))?;
        for &set in &blocks.sets {
            blocks.bind_buffer(set);
        }
        for (&set, shadow) in blocks.sets.iter().zip(shadows) {
            blocks.bind_shadow(set, shadow);
        }
        Ok(blocks)
    }

    /// Replaces the blocks, [`MAX_VIEWS`] at most; the device must not be reading them.
    pub(super) fn set(&mut self, blocks: &[ViewBlock]) {
        for (i, block) in blocks.iter().enumerate() {
            self.buffer.write(i * self.stride, std::slice::from_ref(block));
        }
    }

    /// Records that what follows is drawn in a view, in the light of a shadow map.
    pub(super) fn bind(&self, commands: vk::CommandBuffer, layouts: &Layouts, view: usize, shadow: usize) {
        let offset = (view * self.stride) as u32;
        // Without shadow maps there is one set, and no shader looks for a shadow.
        let set = self.sets[shadow.min(self.sets.len() - 1)];
        // SAFETY: the command buffer is being recorded, and the set was made for this layout.
        unsafe {
            self.device.handle.cmd_bind_descriptor_sets(
                commands,
                vk::PipelineBindPoint::GRAPHICS,
                layouts.view,
                0,
                &[set],
                &[offset],
            );
        }
    }

    fn bind_buffer(&self, set: vk::DescriptorSet) {
        let buffer =
            [vk::DescriptorBufferInfo::default().buffer(self.buffer.handle).range(size_of::<ViewBlock>() as u64)];
        let write = vk::WriteDescriptorSet::default()
            .dst_set(set)
            .dst_binding(0)
            .descriptor_type(vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC)
            .buffer_info(&buffer);
        // SAFETY: set and buffer are alive, and the device is not using the set.
        unsafe { self.device.handle.update_descriptor_sets(&[write], &[]) };
    }

    fn bind_shadow(&self, set: vk::DescriptorSet, shadow: &ShadowMap) {
        let image = [vk::DescriptorImageInfo::default()
            .image_view(shadow.image.view)
            .image_layout(vk::ImageLayout::SHADER_READ_ONLY_OPTIMAL)];
        let sampler = [vk::DescriptorImageInfo::default().sampler(shadow.sampler)];
        let write =
            |binding, kind| vk::WriteDescriptorSet::default().dst_set(set).dst_binding(binding).descriptor_type(kind);
        let writes = [
            write(1, vk::DescriptorType::SAMPLED_IMAGE).image_info(&image),
            write(2, vk::DescriptorType::SAMPLER).image_info(&sampler),
        ];
        // SAFETY: set, view and sampler are alive, and the device is not using the set.
        unsafe { self.device.handle.update_descriptor_sets(&writes, &[]) };
    }
}

impl Drop for ViewBlocks {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device; the sets go with their pool.
        unsafe { self.device.handle.destroy_descriptor_pool(self.pool, None) };
    }
}
