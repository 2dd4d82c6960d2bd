//! The shadow map: what the light sees, fitted to what casts shadows.

use std::rc::Rc;

use ash::vk;
use glam::{
    DMat4, DVec2, DVec3,
    dcamera::rh::{proj::vulkan, view},
};

use super::{
    device::Device,
    error::{GpuError, failed_to},
    image::{Image, ImageSpec},
    target::DEPTH_FORMAT,
};

/// Pixels along each side of the map; `ground.wgsl` knows it too.
pub(super) const SIDE: u32 = 1024;

/// Direction to the light, unit: high, from the left of the front and three-quarter cameras, so that shadows fall beside
/// the actors and not behind them.
pub(super) const TO_LIGHT: DVec3 = DVec3::new(-0.48, 0.768, 0.424);

/// The map and how shaders look into it.
pub(super) struct ShadowMap {
    pub(super) image: Image,
    pub(super) sampler: vk::Sampler,
    device: Rc<Device>,
}

impl ShadowMap {
    /// Makes the map.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        let spec = ImageSpec {
            extent: vk::Extent2D { width: SIDE, height: SIDE },
            format: DEPTH_FORMAT,
            samples: vk::SampleCountFlags::TYPE_1,
            usage: vk::ImageUsageFlags::DEPTH_STENCIL_ATTACHMENT | vk::ImageUsageFlags::SAMPLED,
            aspect: vk::ImageAspectFlags::DEPTH,
        };
        let filter = filter(device);
        let info = vk::SamplerCreateInfo::default()
            .mag_filter(filter)
            .min_filter(filter)
            .address_mode_u(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .address_mode_v(vk::SamplerAddressMode::CLAMP_TO_EDGE)
            .compare_enable(true)
            .compare_op(vk::CompareOp::LESS_OR_EQUAL);
        let image = Image::new(device, &spec, "shadows")?;
        // SAFETY: the device is alive and the description is complete.
        let sampler = unsafe { device.handle.create_sampler(&info, None) }.map_err(failed_to("shadows"))?;
        Ok(Self { image, sampler, device: Rc::clone(device) })
    }
}

impl Drop for ShadowMap {
    fn drop(&mut self) {
        // SAFETY: the owner has waited for the device.
        unsafe { self.device.handle.destroy_sampler(self.sampler, None) };
    }
}

/// Smoothing between neighbours where the device can do it for depth.
fn filter(device: &Device) -> vk::Filter {
    // SAFETY: `physical` came from this instance.
    let format = unsafe { device.instance.handle.get_physical_device_format_properties(device.physical, DEPTH_FORMAT) };
    if format.optimal_tiling_features.contains(vk::FormatFeatureFlags::SAMPLED_IMAGE_FILTER_LINEAR) {
        vk::Filter::LINEAR
    } else {
        vk::Filter::NEAREST
    }
}

/// A ball that casts a shadow: centre and radius.
pub(super) type Caster = (DVec3, f64);

/// Returns the matrix from the world to the shadow map, for casters over a ground at a height.
///
/// Only the ground receives shadows, so the map covers the casters seen from the light, and in depth reaches to where
/// their shadows fall. Its size grows in steps and it moves by whole pixels, so that the edges of shadows do not
/// shimmer while actors walk. Without casters it covers a unit square.
pub(super) fn light_matrix(casters: &[Caster], ground_height: f64) -> DMat4 {
    let turn = view::look_to_mat4(DVec3::ZERO, -TO_LIGHT, DVec3::X);
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &(centre, radius) in casters {
        // In the light's eyes, z grows towards it.
        let at = turn.transform_point3(centre);
        let fall = ((centre.y - ground_height) / TO_LIGHT.y).max(0.0);
        low = low.min(at - radius).min(at - DVec3::Z * (fall + 2.0 * radius));
        high = high.max(at + radius);
    }
    if !(low.is_finite() && high.is_finite()) {
        (low, high) = (DVec3::splat(-0.5), DVec3::splat(0.5));
    }
    // A margin of four pixels for the smoothing.
    let needed = (high - low).truncate().max_element().max(1e-9) * (1.0 + 8.0 / f64::from(SIDE));
    let side = ((needed.log2() * STEPS_PER_DOUBLING).ceil() / STEPS_PER_DOUBLING).exp2();
    let pixel = side / f64::from(SIDE);
    let middle: DVec2 = ((low + high).truncate() * 0.5 / pixel).round() * pixel;
    let slack = (high.z - low.z) * 0.01 + 1e-9;
    // The middle is moved by hand: glam 0.34.2 does not turn it over with y when the bounds are not symmetric.
    let half = side * 0.5;
    let projection = vulkan::orthographic(-half, half, -half, half, -(high.z + slack), -(low.z - slack));
    projection * DMat4::from_translation(-middle.extend(0.0)) * turn
}

/// The map's side grows by a factor of 2^(1/this).
const STEPS_PER_DOUBLING: f64 = 4.0;

#[cfg(test)]
mod tests {
    use super::*;

    /// Where a point lands in the map.
    fn landed(matrix: DMat4, p: DVec3) -> DVec3 {
        matrix.project_point3(p)
    }

    #[test]
    fn the_light_direction_is_unit() {
        assert!((TO_LIGHT.length() - 1.0).abs() < 1e-3);
    }

    #[test]
    fn casters_and_their_shadows_are_inside() {
        let casters = [(DVec3::new(3.0, 1.7, -2.0), 0.1), (DVec3::new(-40.0, 0.05, 9.0), 0.05), (DVec3::ZERO, 0.2)];
        let matrix = light_matrix(&casters, 0.0);
        for (p, _) in casters {
            let shadow = p - TO_LIGHT * (p.y / TO_LIGHT.y);
            for q in [p, shadow] {
                let at = landed(matrix, q);
                assert!(at.x.abs() < 1.0 && at.y.abs() < 1.0 && at.z > 0.0 && at.z < 1.0, "{q} at {at}");
            }
            assert!(landed(matrix, p).z <= landed(matrix, shadow).z, "the light sees {p} before its shadow");
        }
    }

    #[test]
    fn a_small_step_moves_the_map_by_whole_pixels() {
        let matrix = |x: f64| light_matrix(&[(DVec3::new(x, 1.0, 0.0), 0.9)], 0.0);
        let moved = (landed(matrix(0.0), DVec3::ZERO) - landed(matrix(0.0123), DVec3::ZERO)) * 0.5 * f64::from(SIDE);
        assert!(moved.truncate().length() > 0.5, "{moved}");
        assert!((moved.truncate() - moved.truncate().round()).length() < 1e-6, "{moved}");
    }

    #[test]
    fn no_casters_give_a_finite_matrix() {
        assert!(light_matrix(&[], 0.0).is_finite());
        assert!(light_matrix(&[(DVec3::NAN, 1.0)], 0.0).is_finite());
    }
}
