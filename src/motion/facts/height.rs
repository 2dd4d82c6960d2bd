//! Body height, the floor under it, and the unit of length a human of that height suggests.

use std::ops::RangeInclusive;

use glam::DVec3;

use super::Decided;
use crate::{
    motion::{UpAxis, kinematics::Walk, poses::Poses},
    skeleton::Skeleton,
};

/// Lowest and highest point of every frame along up, rest frames not included.
pub(super) struct Extents {
    lows: Vec<f64>,
    heights: Vec<f64>,
}

impl Extents {
    /// Measures a clip in the file's axes.
    pub(super) fn along(up: UpAxis, walk: &Walk, poses: &Poses, rest_frames: usize) -> Self {
        let (mut lows, mut heights) = (Vec::new(), Vec::new());
        walk.visit(poses, rest_frames..poses.n_frames, |stretch, tracks| {
            let mut low = vec![f64::INFINITY; stretch.len()];
            let mut high = vec![f64::NEG_INFINITY; stretch.len()];
            for point in 0..tracks.n_points() {
                let track = match up {
                    UpAxis::Y => tracks.y(point),
                    UpAxis::Z => tracks.z(point),
                };
                for ((low, high), &v) in low.iter_mut().zip(&mut high).zip(track) {
                    *low = low.min(v);
                    *high = high.max(v);
                }
            }
            heights.extend(high.iter().zip(&low).map(|(high, low)| high - low));
            lows.extend(low);
        });
        Self { lows, heights }
    }

    /// Returns `H`, the median height; 1 for a clip without extent.
    pub(super) fn height(&self) -> Decided<f64> {
        let height = percentile(&self.heights, 0.5);
        if height > 0.0 {
            Decided::new(height, "median over frames of the highest minus the lowest point")
        } else {
            Decided::new(1.0, "the clip has no extent along up")
        }
    }

    /// Returns the height of the floor: a low percentile of the lowest point, so that jumps do not lift it and a
    /// single slip of a marker does not sink it.
    pub(super) fn floor(&self) -> f64 {
        percentile(&self.lows, 0.05)
    }
}

/// Returns the value below which this share of the values lies.
pub(super) fn percentile(values: &[f64], share: f64) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let mut values = values.to_vec();
    let at = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}

/// Returns the distance of the joint farthest from its root with nothing turned; 1 for a skeleton without extent.
pub(super) fn rest_size(skeleton: &Skeleton) -> f64 {
    let mut places = vec![DVec3::ZERO; skeleton.n_joints()];
    let mut size = 0.0f64;
    for (idx, joint) in skeleton.joints().iter().enumerate() {
        if let Some(parent) = joint.parent {
            places[idx] = places[parent.idx()] + joint.offset;
        }
        let end = places[idx] + joint.end_site.unwrap_or(DVec3::ZERO);
        size = size.max(places[idx].length()).max(end.length());
    }
    if size > 0.0 { size } else { 1.0 }
}

/// Units of length in metres.
const UNITS: [(&str, f64); 6] =
    [("m", 1.0), ("dm", 0.1), ("cm", 0.01), ("mm", 0.001), ("inch", 0.0254), ("CMU 5.6444 cm", 0.056444)];

/// Guesses the unit in which a body this high is a human one.
///
/// `H` is less than a person's stature: it ends at the last joint of the head and follows bent knees and backs.
pub(super) fn unit(height: f64) -> Decided<Option<&'static str>> {
    /// Usual `H` of an adult, metres; captured clips in known units lie between 1.1 and 1.8.
    const USUAL: f64 = 1.5;
    /// Heights taken for human, metres.
    const HUMAN: RangeInclusive<f64> = 1.05..=2.1;
    let surprise = |metres: f64| (metres * height / USUAL).ln().abs();
    let nearest = UNITS.into_iter().min_by(|a, b| surprise(a.1).total_cmp(&surprise(b.1)));
    let (name, metres) = nearest.expect("there are units");
    if HUMAN.contains(&(metres * height)) {
        Decided::new(Some(name), format!("the body would be {:.2} m high", metres * height))
    } else {
        Decided::new(None, "no usual unit makes the body as high as a human")
    }
}
