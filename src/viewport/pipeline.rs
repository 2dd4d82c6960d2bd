//! Shaders, the layouts they share, and graphics pipelines.

use std::{ffi::CStr, io::Cursor, rc::Rc};

use ash::vk;

use super::{
    device::Device,
    error::{GpuError, failed_to},
    target,
};

/// Bytes of push constants that the layouts without a view offer: one matrix.
const PUSH_SIZE: u32 = 64;

/// The two pipeline layouts.
pub(super) struct Layouts {
    /// Binding 0: the view's block, at a dynamic offset; with shadows, 1 and 2: their map and its sampler.
    pub(super) view_set: vk::DescriptorSetLayout,
    /// For what is drawn in a view.
    pub(super) view: vk::PipelineLayout,
    /// For what needs one matrix or less.
    pub(super) pushed: vk::PipelineLayout,
    device: Rc<Device>,
}

impl Layouts {
    /// Makes them, with or without the bindings for shadows. They are not left empty, which Vulkan allows: lavapipe
    /// 22.3 reads bindings that no shader uses.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>, shadowed: bool) -> Result<Self, GpuError> {
        let mut layouts = Self {
            view_set: vk::DescriptorSetLayout::null(),
            view: vk::PipelineLayout::null(),
            pushed: vk::PipelineLayout::null(),
            device: Rc::clone(device),
        };
        let binding = |index, kind, stages| {
            vk::DescriptorSetLayoutBinding::default()
                .binding(index)
                .descriptor_type(kind)
                .descriptor_count(1)
                .stage_flags(stages)
        };
        let both = vk::ShaderStageFlags::VERTEX | vk::ShaderStageFlags::FRAGMENT;
        let bindings = [
            binding(0, vk::DescriptorType::UNIFORM_BUFFER_DYNAMIC, both),
            binding(1, vk::DescriptorType::SAMPLED_IMAGE, vk::ShaderStageFlags::FRAGMENT),
            binding(2, vk::DescriptorType::SAMPLER, vk::ShaderStageFlags::FRAGMENT),
        ];
        let set =
            vk::DescriptorSetLayoutCreateInfo::default().bindings(if shadowed { &bindings } else { &bindings[..1] });
        let push =
            [vk::PushConstantRange::default().stage_flags(vk::ShaderStageFlags::VERTEX).offset(0).size(PUSH_SIZE)];
        let pushed = vk::PipelineLayoutCreateInfo::default().push_constant_ranges(&push);
        let what = "set up its pipelines";
        // SAFETY: the device is alive, and all pointers are to locals that outlive the calls.
        unsafe {
            layouts.view_set = device.handle.create_descriptor_set_layout(&set, None).map_err(failed_to(what))?;
            layouts.pushed = device.handle.create_pipeline_layout(&pushed, None).map_err(failed_to(what))?;
            let sets = [layouts.view_set];
            let view = vk::PipelineLayoutCreateInfo::default().set_layouts(&sets);
            layouts.view = device.handle.create_pipeline_layout(&view, None).map_err(failed_to(what))?;
        }
        Ok(layouts)
    }
}

impl Drop for Layouts {
    fn drop(&mut self) {
        // SAFETY: pipelines do not need their layouts after creation, and the owner has waited for the device;
        // destroying nothing is allowed.
        unsafe {
            self.device.handle.destroy_pipeline_layout(self.view, None);
            self.device.handle.destroy_pipeline_layout(self.pushed, None);
            self.device.handle.destroy_descriptor_set_layout(self.view_set, None);
        }
    }
}

/// A vertex attribute: its location in the shader, its format and its offset.
pub(super) type Attribute = (u32, vk::Format, u32);

/// One vertex buffer of a pipeline.
pub(super) struct VertexBuffer<'a> {
    pub(super) stride: usize,
    pub(super) rate: vk::VertexInputRate,
    pub(super) attributes: &'a [Attribute],
}

/// What a pass decides about its pipeline; the rest is the same for all.
pub(super) struct PipelineSpec<'a> {
    /// SPIR-V of the module with both entry points.
    pub(super) code: &'a [u8],
    pub(super) vertex: &'a CStr,
    /// None: depth only.
    pub(super) fragment: Option<&'a CStr>,
    pub(super) layout: vk::PipelineLayout,
    pub(super) buffers: &'a [VertexBuffer<'a>],
    pub(super) topology: vk::PrimitiveTopology,
    pub(super) samples: vk::SampleCountFlags,
    /// Leaves out faces seen from behind.
    pub(super) cull: bool,
    pub(super) depth: Depth,
    /// Lays the colour over what is there by its opacity.
    pub(super) blend: bool,
}

/// What a pass does with the depth image.
#[derive(Clone, Copy, PartialEq, Eq)]
pub(super) enum Depth {
    /// There is no depth image.
    Absent,
    Ignore,
    Test,
    TestAndWrite,
}

/// A graphics pipeline; destroyed with its owner, who sees to it that the device has finished with it.
pub(super) struct Pipeline {
    pub(super) handle: vk::Pipeline,
    device: Rc<Device>,
}

impl Pipeline {
    /// Makes a pipeline.
    ///
    /// # Errors
    ///
    /// When the driver refuses the shaders or memory has run out.
    pub(super) fn new(device: &Rc<Device>, spec: &PipelineSpec<'_>) -> Result<Self, GpuError> {
        let what = "set up its pipelines";
        let code = ash::util::read_spv(&mut Cursor::new(spec.code)).expect("the build script writes whole words");
        let module_info = vk::ShaderModuleCreateInfo::default().code(&code);
        // SAFETY: the code was made by naga, which validated it.
        let module = unsafe { device.handle.create_shader_module(&module_info, None) }.map_err(failed_to(what))?;
        let stage = |stage, name| vk::PipelineShaderStageCreateInfo::default().stage(stage).module(module).name(name);
        let stages: Vec<_> = std::iter::once(stage(vk::ShaderStageFlags::VERTEX, spec.vertex))
            .chain(spec.fragment.map(|name| stage(vk::ShaderStageFlags::FRAGMENT, name)))
            .collect();
        let (bindings, attributes) = vertex_input(spec.buffers);
        let vertex_input = vk::PipelineVertexInputStateCreateInfo::default()
            .vertex_binding_descriptions(&bindings)
            .vertex_attribute_descriptions(&attributes);
        let assembly = vk::PipelineInputAssemblyStateCreateInfo::default().topology(spec.topology);
        let viewport = vk::PipelineViewportStateCreateInfo::default().viewport_count(1).scissor_count(1);
        // Meshes run counterclockwise seen from outside, and the projection keeps what the viewer sees.
        let raster = vk::PipelineRasterizationStateCreateInfo::default()
            .polygon_mode(vk::PolygonMode::FILL)
            .cull_mode(if spec.cull { vk::CullModeFlags::BACK } else { vk::CullModeFlags::NONE })
            .front_face(vk::FrontFace::COUNTER_CLOCKWISE)
            .line_width(1.0);
        let multisample = vk::PipelineMultisampleStateCreateInfo::default().rasterization_samples(spec.samples);
        let depth = vk::PipelineDepthStencilStateCreateInfo::default()
            .depth_test_enable(matches!(spec.depth, Depth::Test | Depth::TestAndWrite))
            .depth_write_enable(spec.depth == Depth::TestAndWrite)
            .depth_compare_op(vk::CompareOp::LESS_OR_EQUAL);
        let attachments = [blend_state(spec.blend)];
        let blend = vk::PipelineColorBlendStateCreateInfo::default().attachments(if spec.fragment.is_some() {
            &attachments
        } else {
            &[]
        });
        let dynamic = vk::PipelineDynamicStateCreateInfo::default()
            .dynamic_states(&[vk::DynamicState::VIEWPORT, vk::DynamicState::SCISSOR]);
        let colours = [target::COLOUR_FORMAT];
        let mut formats = vk::PipelineRenderingCreateInfo::default()
            .color_attachment_formats(if spec.fragment.is_some() { &colours } else { &[] })
            .depth_attachment_format(match spec.depth {
                Depth::Absent => vk::Format::UNDEFINED,
                _ => target::DEPTH_FORMAT,
            });
        let info = vk::GraphicsPipelineCreateInfo::default()
            .stages(&stages)
            .vertex_input_state(&vertex_input)
            .input_assembly_state(&assembly)
            .viewport_state(&viewport)
            .rasterization_state(&raster)
            .multisample_state(&multisample)
            .depth_stencil_state(&depth)
            .color_blend_state(&blend)
            .dynamic_state(&dynamic)
            .layout(spec.layout)
            .push_next(&mut formats);
        // SAFETY: everything `info` points to is alive; the module is not needed once the pipeline is made.
        let made = unsafe {
            let made = device.handle.create_graphics_pipelines(vk::PipelineCache::null(), &[info], None);
            device.handle.destroy_shader_module(module, None);
            made
        };
        let handle = made.map_err(|(_, result)| failed_to(what)(result))?[0];
        Ok(Self { handle, device: Rc::clone(device) })
    }
}

impl Drop for Pipeline {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device.
        unsafe { self.device.handle.destroy_pipeline(self.handle, None) };
    }
}

fn vertex_input(
    buffers: &[VertexBuffer<'_>],
) -> (Vec<vk::VertexInputBindingDescription>, Vec<vk::VertexInputAttributeDescription>) {
    let mut bindings = Vec::new();
    let mut attributes = Vec::new();
    for (buffer, binding) in buffers.iter().zip(0..) {
        bindings.push(vk::VertexInputBindingDescription {
            binding,
            stride: buffer.stride as u32,
            input_rate: buffer.rate,
        });
        attributes.extend(buffer.attributes.iter().map(|&(location, format, offset)| {
            vk::VertexInputAttributeDescription { location, binding, format, offset }
        }));
    }
    (bindings, attributes)
}

fn blend_state(over: bool) -> vk::PipelineColorBlendAttachmentState {
    vk::PipelineColorBlendAttachmentState::default()
        .blend_enable(over)
        .src_color_blend_factor(vk::BlendFactor::SRC_ALPHA)
        .dst_color_blend_factor(vk::BlendFactor::ONE_MINUS_SRC_ALPHA)
        .color_blend_op(vk::BlendOp::ADD)
        .src_alpha_blend_factor(vk::BlendFactor::ZERO)
        .dst_alpha_blend_factor(vk::BlendFactor::ONE)
        .alpha_blend_op(vk::BlendOp::ADD)
        .color_write_mask(vk::ColorComponentFlags::RGBA)
}
