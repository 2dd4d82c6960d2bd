//! Limbs as lit capsules, marks as spheres and cubes, and the shadows of both.
//!
//! Two unit meshes share one vertex and one index buffer, and every solid is an instance of one of them. What stays
//! and what moves are separate lists, so that playing a clip uploads only the latter.

use std::{f64::consts::FRAC_PI_2, f64::consts::TAU, rc::Rc};

use ash::vk;
use bytemuck::{Pod, Zeroable};
use glam::{DMat4, Vec3};

use super::{
    batch::{Solid, Solids},
    buffer::Buffer,
    device::Device,
    error::GpuError,
    listed::ListedInstances,
    pipeline::{Depth, Layouts, Pipeline, PipelineSpec, VertexBuffer},
};
use crate::scene::Objects;

/// Vertices round a capsule.
const SIDES: u16 = 20;
/// Rings of faces from a capsule's pole to its equator.
const RINGS: u16 = 5;

/// Draws the solids of a view, and of the shadow map.
pub(super) struct SolidPass {
    pipeline: Pipeline,
    shadow: Option<Pipeline>,
    layout_of_shadow: vk::PipelineLayout,
    meshes: Meshes,
    still: Lists,
    moving: Lists,
    device: Rc<Device>,
}

/// Instances by mesh.
struct Lists {
    capsules: ListedInstances,
    cubes: ListedInstances,
}

impl SolidPass {
    /// Makes the pass, with the pipeline for the shadow map if there is one; the layouts outlive it.
    ///
    /// # Errors
    ///
    /// When the driver cannot make the pipelines or memory has run out.
    pub(super) fn new(
        device: &Rc<Device>,
        layouts: &Layouts,
        samples: vk::SampleCountFlags,
        shadowed: bool,
    ) -> Result<Self, GpuError> {
        let float3 = vk::Format::R32G32B32_SFLOAT;
        let float4 = vk::Format::R32G32B32A32_SFLOAT;
        let vertices = VertexBuffer {
            stride: size_of::<Vertex>(),
            rate: vk::VertexInputRate::VERTEX,
            attributes: &[(0, float3, 0), (1, float3, 12), (2, vk::Format::R32_SFLOAT, 24)],
        };
        let instances = VertexBuffer {
            stride: size_of::<Solid>(),
            rate: vk::VertexInputRate::INSTANCE,
            attributes: &[(3, float4, 0), (4, float4, 16), (5, float4, 32)],
        };
        let spec = PipelineSpec {
            code: include_bytes!(concat!(env!("OUT_DIR"), "/solids.spv")),
            vertex: c"vertex",
            fragment: Some(c"fragment"),
            layout: layouts.view,
            buffers: &[vertices, instances],
            topology: vk::PrimitiveTopology::TRIANGLE_LIST,
            samples,
            cull: true,
            depth: Depth::TestAndWrite,
            blend: false,
        };
        let shadow_spec = PipelineSpec {
            vertex: c"vertex_shadow",
            fragment: None,
            layout: layouts.pushed,
            samples: vk::SampleCountFlags::TYPE_1,
            ..spec
        };
        Ok(Self {
            pipeline: Pipeline::new(device, &spec)?,
            shadow: shadowed.then(|| Pipeline::new(device, &shadow_spec)).transpose()?,
            layout_of_shadow: layouts.pushed,
            meshes: Meshes::new(device)?,
            still: Lists::new(device)?,
            moving: Lists::new(device)?,
            device: Rc::clone(device),
        })
    }

    /// Replaces what stays; the device must not be drawing it.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set_still(&mut self, solids: &Solids) -> Result<(), GpuError> {
        self.still.set(solids)
    }

    /// Replaces what moves; the device must not be drawing it.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set_moving(&mut self, solids: &Solids) -> Result<(), GpuError> {
        self.moving.set(solids)
    }

    /// Records the drawing of what is shown; a view is bound.
    pub(super) fn draw(&self, commands: vk::CommandBuffer, shown: Objects) {
        // SAFETY: recorded inside rendering to the format and samples that the pipeline was made for.
        unsafe {
            self.device.handle.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, self.pipeline.handle);
        }
        self.draw_lists(commands, &[&self.still, &self.moving], shown);
    }

    /// Records the drawing of what moves and is shown into the shadow map; nothing when made without shadows.
    pub(super) fn draw_shadow(&self, commands: vk::CommandBuffer, light: DMat4, shown: Objects) {
        let Some(pipeline) = &self.shadow else { return };
        let matrix = light.as_mat4().to_cols_array();
        // SAFETY: recorded inside rendering to the depth format that the pipeline was made for; one matrix fits the
        // layout's push constants.
        unsafe {
            let device = &self.device.handle;
            device.cmd_bind_pipeline(commands, vk::PipelineBindPoint::GRAPHICS, pipeline.handle);
            device.cmd_push_constants(
                commands,
                self.layout_of_shadow,
                vk::ShaderStageFlags::VERTEX,
                0,
                bytemuck::cast_slice(&matrix),
            );
        }
        self.draw_lists(commands, &[&self.moving], shown);
    }

    fn draw_lists(&self, commands: vk::CommandBuffer, lists: &[&Lists], shown: Objects) {
        let device = &self.device.handle;
        let meshes = &self.meshes;
        // SAFETY: a pipeline of this pass is bound; the buffers hold as many vertices, indices and instances as drawn.
        unsafe {
            device.cmd_bind_index_buffer(commands, meshes.indices.handle, 0, vk::IndexType::UINT16);
            for list in lists {
                for (instances, mesh) in [(&list.capsules, meshes.capsule), (&list.cubes, meshes.cube)] {
                    let buffers = [meshes.vertices.handle, instances.handle()];
                    device.cmd_bind_vertex_buffers(commands, 0, &buffers, &[0, 0]);
                    for drawn in instances.ranges(shown) {
                        let count = drawn.end - drawn.start;
                        device.cmd_draw_indexed(commands, mesh.count, count, mesh.first, 0, drawn.start);
                    }
                }
            }
        }
    }
}

impl Lists {
    fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        Ok(Self { capsules: ListedInstances::new(device)?, cubes: ListedInstances::new(device)? })
    }

    fn set(&mut self, solids: &Solids) -> Result<(), GpuError> {
        self.capsules.set(&solids.capsules)?;
        self.cubes.set(&solids.cubes)
    }
}

/// A vertex of a unit mesh; see `shaders/solids.wgsl`.
#[derive(Clone, Copy, Debug, Pod, Zeroable)]
#[repr(C)]
struct Vertex {
    offset: [f32; 3],
    normal: [f32; 3],
    end: f32,
}

/// Indices of one mesh.
#[derive(Clone, Copy)]
struct Range {
    first: u32,
    count: u32,
}

/// Both unit meshes.
struct Meshes {
    vertices: Buffer,
    indices: Buffer,
    capsule: Range,
    cube: Range,
}

impl Meshes {
    fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        let (mut vertices, mut indices) = capsule();
        let capsule = Range { first: 0, count: indices.len() as u32 };
        let (more, faces) = cube();
        let base = vertices.len() as u16;
        let cube = Range { first: capsule.count, count: faces.len() as u32 };
        vertices.extend(more);
        indices.extend(faces.into_iter().map(|i| i + base));
        let mut meshes = Self {
            vertices: Buffer::written(device, size_of_val(vertices.as_slice()), vk::BufferUsageFlags::VERTEX_BUFFER)?,
            indices: Buffer::written(device, size_of_val(indices.as_slice()), vk::BufferUsageFlags::INDEX_BUFFER)?,
            capsule,
            cube,
        };
        meshes.vertices.write(0, &vertices);
        meshes.indices.write(0, &indices);
        Ok(meshes)
    }
}

/// A capsule along y: rows of vertices from the first end's pole to the second end's.
fn capsule() -> (Vec<Vertex>, Vec<u16>) {
    let mut vertices = Vec::new();
    for (end, first_latitude) in [(0.0, -FRAC_PI_2), (1.0, 0.0)] {
        for ring in 0..=RINGS {
            let (y, across) = (first_latitude + FRAC_PI_2 * f64::from(ring) / f64::from(RINGS)).sin_cos();
            for side in 0..SIDES {
                let (sin, cos) = (TAU * f64::from(side) / f64::from(SIDES)).sin_cos();
                let offset = [across * cos, y, across * sin].map(|v| v as f32);
                vertices.push(Vertex { offset, normal: offset, end });
            }
        }
    }
    let mut indices = Vec::new();
    let n_rows = 2 * (RINGS + 1);
    for row in 0..n_rows - 1 {
        for side in 0..SIDES {
            let next = (side + 1) % SIDES;
            let [a, b] = [side, next].map(|s| row * SIDES + s);
            let [above_a, above_b] = [a + SIDES, b + SIDES];
            // At a pole the row's vertices coincide, and one of the two triangles has no area.
            if row > 0 {
                indices.extend([a, above_a, b]);
            }
            if row < n_rows - 2 {
                indices.extend([b, above_a, above_b]);
            }
        }
    }
    (vertices, indices)
}

/// A cube of half edge 1.
fn cube() -> (Vec<Vertex>, Vec<u16>) {
    let mut vertices = Vec::new();
    let mut indices = Vec::new();
    for axis in 0..3 {
        for sign in [-1.0, 1.0] {
            let normal = Vec3::AXES[axis] * sign;
            let u = Vec3::AXES[(axis + 1) % 3];
            let v = normal.cross(u);
            let base = vertices.len() as u16;
            for (a, b) in [(-1.0, -1.0), (1.0, -1.0), (1.0, 1.0), (-1.0, 1.0)] {
                let offset = (normal + u * a + v * b).to_array();
                vertices.push(Vertex { offset, normal: normal.to_array(), end: 0.0 });
            }
            indices.extend([0, 1, 2, 0, 2, 3].map(|i| base + i));
        }
    }
    (vertices, indices)
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Every face runs counterclockwise seen from outside, has an area, and the mesh is closed.
    fn check(mesh: (Vec<Vertex>, Vec<u16>), stretch: f32) {
        let (vertices, indices) = mesh;
        let at = |i: u16| {
            let v = vertices[usize::from(i)];
            Vec3::from(v.offset) + Vec3::Y * (v.end - 0.5) * stretch
        };
        let mut edges = std::collections::HashMap::new();
        let key = |p: Vec3| p.to_array().map(|v| (v * 1000.0).round() as i32);
        for face in indices.chunks(3) {
            let [a, b, c] = [face[0], face[1], face[2]].map(at);
            let normal = (b - a).cross(c - a);
            assert!(normal.length() > 1e-6, "{face:?} has an area");
            assert!(normal.dot(a + b + c) > 0.0, "{face:?} looks outwards");
            for (p, q) in [(a, b), (b, c), (c, a)] {
                *edges.entry((key(p), key(q))).or_insert(0) += 1;
            }
        }
        for (p, q) in edges.keys() {
            assert_eq!(edges.get(&(*q, *p)), Some(&1), "the edge from {p:?} to {q:?} has one neighbour");
        }
    }

    #[test]
    fn meshes_are_closed_and_look_outwards() {
        check(capsule(), 2.0);
        check(cube(), 0.0);
    }
}
