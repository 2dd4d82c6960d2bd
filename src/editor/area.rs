//! What the plan and the camera presets frame: everything that moves, and the control points.

use std::sync::Arc;

use glam::DVec3;

use crate::document::Solved;

/// Frames of each way that are looked at for framing.
const FRAMED_FRAMES: usize = 64;

/// Everything that moves, as a box and as points: what the plan and the camera presets frame.
#[derive(Clone, Debug, PartialEq)]
pub struct PlanArea {
    /// Centre of the box, world.
    pub centre: DVec3,
    /// Half its edges, world; positive.
    pub half_extents: DVec3,
    /// Feet and heads along both carriers' ways, and the control points, world.
    pub(super) points: Arc<[DVec3]>,
}

impl PlanArea {
    /// Keeps this box while it still frames the other one well, so that views stay still under small edits.
    pub(super) fn keep_or(&self, needed: Self) -> Self {
        let outside = (needed.centre - self.centre).abs() + needed.half_extents - self.half_extents;
        let too_large = self.half_extents.max_element() > 2.0 * needed.half_extents.max_element();
        if outside.max_element() > 0.0 || too_large { needed } else { self.clone() }
    }
}

/// Returns what there is to frame of both carriers' ways, the control points and a body walking there.
pub(super) fn area(solved: &Solved) -> PlanArea {
    let height = solved.clip.facts.height.value;
    let up = solved.clip.facts.up.value;
    let floor = solved.clip.facts.floor;
    let originals = sampled(solved.clip.n_frames()).map(|f| solved.carrier_track[f].translation);
    let edited = sampled(solved.edited.n_frames()).map(|f| solved.carrier(f).translation);
    // The carrier is about half way up the body.
    let bodies = originals.chain(edited).flat_map(|p| [0.6, -0.6].map(|h| p + DVec3::Y * h * height));
    let points: Arc<[DVec3]> = bodies.chain(solved.control_points().into_iter().map(|p| up.to_world(p))).collect();
    let (mut low, mut high) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
    for &p in points.iter() {
        low = low.min(p);
        high = high.max(p);
    }
    let margin = DVec3::new(0.4, 0.0, 0.4) * height;
    low = (low - margin).with_y(low.y.min(floor));
    high += margin;
    PlanArea { centre: low.midpoint(high), half_extents: 0.5 * (high - low), points }
}

/// Returns some frames from the first to the last.
fn sampled(n_frames: usize) -> impl Iterator<Item = usize> {
    (0..n_frames).step_by(n_frames.div_ceil(FRAMED_FRAMES).max(1)).chain([n_frames - 1])
}
