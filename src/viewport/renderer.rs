//! The recipe of a picture: what is uploaded, in which order passes draw, and where the result goes.

use std::rc::Rc;

use ash::vk;
use glam::DMat4;

use super::{
    DeviceChoice,
    batch::{NowBatch, StillBatch},
    buffer::Buffer,
    camera::{self, Bounds, Lens, Tile},
    commands::{Commands, WaitFor},
    device::Device,
    error::GpuError,
    image::{Image, Use, barrier, colour_layers, transition},
    instance::{Instance, ValidationLog},
    pass_ground::GroundPass,
    pass_ribbons::RibbonPass,
    pass_sky::SkyPass,
    pass_solids::SolidPass,
    pass_text::TextPass,
    pipeline::Layouts,
    shadow::{self, ShadowMap},
    target::{Target, depth_attachment},
    text,
    view_block::{Common, ViewBlock, ViewBlocks},
};
use crate::scene::{MAX_VIEWS, Object, Objects, Picture, Scene, View};

/// How much care a picture is drawn with.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Quality {
    /// Four samples a pixel where the device offers them, and shadows.
    #[default]
    Full,
    /// One sample a pixel, no shadows.
    Draft,
}

/// How a renderer is made.
#[derive(Clone, Debug, Default)]
pub struct RendererOptions {
    /// Which kind of device draws.
    pub device: DeviceChoice,
    /// How much care is taken.
    pub quality: Quality,
    /// Switches the validation layer on, if it is installed, and collects what it says.
    pub validation: Option<ValidationLog>,
}

/// Draws scenes. Stays in the thread that made it.
///
/// Fields are dropped in order, after the device has been waited for; each keeps the device alive.
pub struct Renderer {
    commands: Commands,
    read_back: Option<Buffer>,
    target: Option<Target>,
    passes: Passes,
    views: ViewBlocks,
    /// One for each view that may need its own; none in a draft.
    shadows: Vec<ShadowMap>,
    layouts: Layouts,
    samples: vk::SampleCountFlags,
    /// Uploaded last, with its revision.
    still: Option<(u64, StillBatch)>,
    pub(super) device: Rc<Device>,
}

struct Passes {
    sky: SkyPass,
    solids: SolidPass,
    ground: GroundPass,
    ribbons: RibbonPass,
    text: TextPass,
}

/// What recording needs to know of the uploaded scene.
struct Prepared {
    views: Vec<PreparedView>,
    lights: Vec<Light>,
    has_ground: bool,
}

struct PreparedView {
    tile: Tile,
    shows: Objects,
    /// Index into [`Prepared::lights`].
    light_idx: usize,
}

/// What one shadow map shows: views that show the same of what casts shadows share it.
struct Light {
    casting: Objects,
    matrix: DMat4,
}

/// Between views, in linear light.
const GAP_COLOUR: [f32; 4] = [0.002, 0.002, 0.003, 1.0];

impl Renderer {
    /// Loads Vulkan and makes a renderer of pictures.
    ///
    /// # Errors
    ///
    /// When there is no loader, no driver or no device that will do; the text says what would help.
    pub fn new(options: &RendererOptions) -> Result<Self, GpuError> {
        let instance = Instance::new(&[], options.validation.as_ref())?;
        Self::on_device(Device::new(instance, options.device, None)?, options.quality)
    }

    /// Makes a renderer on an open device.
    ///
    /// # Errors
    ///
    /// When memory has run out or the driver refuses a shader.
    pub(super) fn on_device(device: Rc<Device>, quality: Quality) -> Result<Self, GpuError> {
        let full = quality == Quality::Full;
        let samples = if full { device.samples() } else { vk::SampleCountFlags::TYPE_1 };
        let layouts = Layouts::new(&device, full)?;
        let n_shadows = if full { MAX_VIEWS } else { 0 };
        let shadows = (0..n_shadows).map(|_| ShadowMap::new(&device)).collect::<Result<Vec<_>, _>>()?;
        Ok(Self {
            commands: Commands::new(&device)?,
            read_back: None,
            target: None,
            passes: Passes {
                sky: SkyPass::new(&device, &layouts, samples)?,
                solids: SolidPass::new(&device, &layouts, samples, full)?,
                ground: GroundPass::new(&device, &layouts, samples, full)?,
                ribbons: RibbonPass::new(&device, &layouts, samples)?,
                text: TextPass::new(&device, &layouts)?,
            },
            views: ViewBlocks::new(&device, &layouts, &shadows)?,
            shadows,
            layouts,
            samples,
            still: None,
            device,
        })
    }

    /// Returns the name of the device that draws.
    pub fn device_name(&self) -> String {
        self.device.name()
    }

    /// Returns the driver's name and version.
    pub fn driver(&self) -> &str {
        &self.device.driver
    }

    /// Draws a picture and reads it back. Equal scenes give equal bytes on one machine.
    ///
    /// The part of the scene that stays is uploaded when its revision differs from the last picture's.
    ///
    /// # Errors
    ///
    /// When the size is impossible, memory has run out or the device is lost.
    pub fn render(&mut self, scene: &Scene, width: u32, height: u32) -> Result<Picture, GpuError> {
        let size = width as usize * height as usize * 4;
        self.draw(scene, vk::Extent2D { width, height }, None, None, |renderer, commands, picture| {
            if renderer.read_back.as_ref().is_none_or(|b| b.size() < size) {
                renderer.read_back = Some(Buffer::read_back(&renderer.device, size)?);
            }
            let buffer = renderer.read_back.as_ref().map_or(vk::Buffer::null(), |b| b.handle);
            let region = vk::BufferImageCopy::default().image_subresource(colour_layers()).image_extent(vk::Extent3D {
                width,
                height,
                depth: 1,
            });
            let seen = vk::MemoryBarrier2::default()
                .src_stage_mask(vk::PipelineStageFlags2::ALL_TRANSFER)
                .src_access_mask(vk::AccessFlags2::TRANSFER_WRITE)
                .dst_stage_mask(vk::PipelineStageFlags2::HOST)
                .dst_access_mask(vk::AccessFlags2::HOST_READ);
            let seen = [seen];
            let visible = vk::DependencyInfo::default().memory_barriers(&seen);
            let device = &renderer.device.handle;
            // SAFETY: the picture is in the layout copied from, and the buffer holds four bytes a pixel of it.
            unsafe {
                device.cmd_copy_image_to_buffer(commands, picture, Use::COPIED.layout, buffer, &[region]);
                device.cmd_pipeline_barrier2(commands, &visible);
            }
            Ok(())
        })?;
        self.commands.wait()?;
        let bytes = self.read_back.as_ref().expect("recording made the buffer").bytes();
        let rgb = bytes[..size].chunks_exact(4).flat_map(|p| [p[0], p[1], p[2]]).collect();
        Ok(Picture { width, height, rgb })
    }

    /// Draws a picture into the renderer's own image and lets `finish` record what happens to it, which it finds in
    /// [`Use::COPIED`].
    ///
    /// Waits for the frame before, not for this one.
    ///
    /// # Errors
    ///
    /// When the size is impossible, memory has run out or the device is lost.
    pub(super) fn draw(
        &mut self,
        scene: &Scene,
        extent: vk::Extent2D,
        wait: Option<WaitFor>,
        signal: Option<vk::Semaphore>,
        finish: impl FnOnce(&mut Self, vk::CommandBuffer, vk::Image) -> Result<(), GpuError>,
    ) -> Result<(), GpuError> {
        self.commands.wait()?;
        if self.target.as_ref().is_none_or(|t| t.extent != extent) {
            // The old images go first, so that both need not fit into memory.
            self.target = None;
            self.target = Some(Target::new(&self.device, extent, self.samples)?);
        }
        let prepared = self.prepare(scene, extent)?;
        let commands = self.commands.begin()?;
        let target = self.target.take().expect("made above");
        self.record(commands, &target, &prepared);
        let finished = finish(self, commands, target.picture.handle);
        self.target = Some(target);
        finished?;
        self.commands.submit(wait, signal)
    }

    /// Waits for the frame in flight.
    ///
    /// # Errors
    ///
    /// When the device is lost.
    pub(super) fn wait(&self) -> Result<(), GpuError> {
        self.commands.wait()
    }

    /// Uploads the scene. Nothing is in flight.
    fn prepare(&mut self, scene: &Scene, extent: vk::Extent2D) -> Result<Prepared, GpuError> {
        let (width, height) = (extent.width, extent.height);
        if self.still.as_ref().is_none_or(|(revision, _)| *revision != scene.still.revision) {
            let batch = StillBatch::new(&scene.still, &scene.now);
            self.passes.solids.set_still(&batch.solids)?;
            self.passes.ribbons.set_still(&batch.segments)?;
            self.still = Some((scene.still.revision, batch));
        }
        let (_, still) = self.still.as_ref().expect("uploaded above");
        let now = NowBatch::new(&scene.still, &scene.now, still.origin);
        self.passes.solids.set_moving(&now.solids)?;
        self.passes.ribbons.set_moving(&now.segments)?;
        let ground = scene.still.ground.as_ref();
        let bounds = Bounds { low: still.bounds.low.min(now.bounds.low), high: still.bounds.high.max(now.bounds.high) };
        let common = Common {
            origin: still.origin,
            bounds: &bounds,
            body_height: sane_height(scene.still.body_height),
            ground,
            line_width: line_width(height),
        };
        let n_views = scene.now.views.len().min(MAX_VIEWS);
        let tiles = camera::tiles(n_views, width, height, camera::gap(width, height));
        let seen: Vec<_> = tiles
            .iter()
            .zip(&scene.now.views)
            .map(|(tile, view)| (*tile, Lens::new(&view.camera, tile.aspect())))
            .collect();
        let mut lights = Vec::new();
        let views: Vec<_> = tiles
            .iter()
            .zip(&scene.now.views)
            .map(|(&tile, &View { shows, .. })| {
                let ground_height = ground.map_or(0.0, |g| g.height) - still.origin.y;
                PreparedView { tile, shows, light_idx: light(&mut lights, &now, shows, ground_height) }
            })
            .collect();
        let blocks: Vec<_> = seen
            .iter()
            .zip(&views)
            .map(|((tile, lens), view)| ViewBlock::new(&common, lens, *tile, lights[view.light_idx].matrix))
            .collect();
        self.views.set(&blocks);
        self.passes.text.set(&text::layout(scene, &seen, width, height))?;
        Ok(Prepared { views, lights, has_ground: ground.is_some() })
    }

    /// Records the picture; afterwards it is ready to be copied from.
    fn record(&self, commands: vk::CommandBuffer, target: &Target, prepared: &Prepared) {
        for (map, light) in self.shadows.iter().zip(&prepared.lights) {
            self.record_shadow(commands, map, light);
        }
        transition(&self.device, commands, &target.before_drawing());
        let colour = [target.colour_attachment(GAP_COLOUR)];
        let depth = target.depth_attachment();
        let area: vk::Rect2D = target.extent.into();
        let info = vk::RenderingInfo::default()
            .render_area(area)
            .layer_count(1)
            .color_attachments(&colour)
            .depth_attachment(&depth);
        let device = &self.device.handle;
        // SAFETY: the attachments are in their layouts by the barriers above and outlive the frame.
        unsafe { device.cmd_begin_rendering(commands, &info) };
        for (i, &PreparedView { tile, shows, light_idx }) in prepared.views.iter().enumerate() {
            let area = vk::Rect2D {
                offset: vk::Offset2D { x: tile.x as i32, y: tile.y as i32 },
                extent: vk::Extent2D { width: tile.width, height: tile.height },
            };
            self.look_through(commands, area);
            self.views.bind(commands, &self.layouts, i, light_idx);
            self.passes.sky.draw(commands);
            self.passes.solids.draw(commands, shows);
            if prepared.has_ground && shows.contains(Object::Ground) {
                self.passes.ground.draw(commands);
            }
            self.passes.ribbons.draw(commands, shows);
        }
        // SAFETY: begun above.
        unsafe { device.cmd_end_rendering(commands) };
        if !self.passes.text.is_empty() {
            self.record_text(commands, target);
        }
        let done = barrier(target.picture.handle, vk::ImageAspectFlags::COLOR, Use::COLOUR, Use::COPIED);
        transition(&self.device, commands, &[done]);
    }

    /// Records the text over the finished picture.
    fn record_text(&self, commands: vk::CommandBuffer, target: &Target) {
        let (picture, colour) = (target.picture.handle, vk::ImageAspectFlags::COLOR);
        transition(&self.device, commands, &[barrier(picture, colour, Use::COLOUR, Use::COLOUR)]);
        let attachment = [target.finished_attachment()];
        let area: vk::Rect2D = target.extent.into();
        let info = vk::RenderingInfo::default().render_area(area).layer_count(1).color_attachments(&attachment);
        // SAFETY: the picture is in its layout and outlives the frame.
        unsafe { self.device.handle.cmd_begin_rendering(commands, &info) };
        self.look_through(commands, area);
        self.passes.text.draw(commands, target.extent);
        // SAFETY: begun above.
        unsafe { self.device.handle.cmd_end_rendering(commands) };
    }

    fn record_shadow(&self, commands: vk::CommandBuffer, map: &ShadowMap, light: &Light) {
        let (image, aspect): (&Image, _) = (&map.image, vk::ImageAspectFlags::DEPTH);
        // The last frame may still be reading the map.
        let before = Use::discard(Use::SAMPLED.stage | Use::DEPTH.stage);
        transition(&self.device, commands, &[barrier(image.handle, aspect, before, Use::DEPTH)]);
        let depth = depth_attachment(image, vk::AttachmentStoreOp::STORE);
        let area: vk::Rect2D = vk::Extent2D { width: shadow::SIDE, height: shadow::SIDE }.into();
        let info = vk::RenderingInfo::default().render_area(area).layer_count(1).depth_attachment(&depth);
        // SAFETY: the map is in its layout by the barrier above and outlives the frame.
        unsafe { self.device.handle.cmd_begin_rendering(commands, &info) };
        self.look_through(commands, area);
        self.passes.solids.draw_shadow(commands, light.matrix, light.casting);
        // SAFETY: begun above.
        unsafe { self.device.handle.cmd_end_rendering(commands) };
        transition(&self.device, commands, &[barrier(image.handle, aspect, Use::DEPTH, Use::SAMPLED)]);
    }

    /// Records that drawing goes to a rectangle and nowhere else.
    fn look_through(&self, commands: vk::CommandBuffer, area: vk::Rect2D) {
        let viewport = vk::Viewport {
            x: area.offset.x as f32,
            y: area.offset.y as f32,
            width: area.extent.width as f32,
            height: area.extent.height as f32,
            min_depth: 0.0,
            max_depth: 1.0,
        };
        // SAFETY: the command buffer is being recorded.
        unsafe {
            self.device.handle.cmd_set_viewport(commands, 0, &[viewport]);
            self.device.handle.cmd_set_scissor(commands, 0, &[area]);
        }
    }
}

impl Drop for Renderer {
    fn drop(&mut self) {
        self.device.wait_idle();
    }
}

/// Returns the index of the light that a view needs, which is made unless another view has one alike.
fn light(lights: &mut Vec<Light>, now: &NowBatch, shows: Objects, ground_height: f64) -> usize {
    let casting = now.casting(shows);
    lights.iter().position(|light| light.casting == casting).unwrap_or_else(|| {
        let casters: Vec<_> =
            now.casters.iter().filter(|(part, _)| part.is_shown(casting)).map(|(_, caster)| *caster).collect();
        lights.push(Light { casting, matrix: shadow::light_matrix(&casters, ground_height) });
        lights.len() - 1
    })
}

/// Width of a path in pixels: two in a small picture, more in a large one.
fn line_width(height: u32) -> f64 {
    (f64::from(height) / 240.0).clamp(1.5, 8.0)
}

/// A body height that lengths can be measured in.
fn sane_height(height: f64) -> f64 {
    if height.is_finite() && height > 0.0 { height } else { 1.0 }
}
