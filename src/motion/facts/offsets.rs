//! What position channels do to OFFSET: for the roots by the floor, for the other joints by bone lengths.

use glam::DVec3;

use super::Decided;
use crate::{
    motion::{OffsetMeaning, UpAxis, channels::FileMotion},
    skeleton::JointId,
};

/// Differences below this share of what is compared tell nothing apart.
const TELLING: f64 = 1e-3;

/// What is said when both readings are as good.
pub(super) const UNDECIDED: &str = "nothing tells replacing from adding";

/// Decides for the joints below the roots, the carrier excluded: the reading that keeps bones as long as their
/// OFFSETs; none when bones do not tell.
pub(super) fn by_bones(motion: &FileMotion, carrier: JointId) -> Option<Decided<OffsetMeaning>> {
    let (mut replacing, mut adding, mut bones) = (0.0, 0.0, 0.0);
    for (idx, joint) in motion.skeleton.joints().iter().enumerate() {
        let channels = &motion.channels[idx];
        if joint.parent.is_none() || idx == carrier.idx() || !channels.has_position() {
            continue;
        }
        let silent = joint.offset - channels.covered(joint.offset);
        for frame in sample(motion.n_frames) {
            let position = motion.position(frame, idx);
            let length = joint.offset.length();
            replacing += ((silent + position).length() - length).abs();
            adding += ((joint.offset + position).length() - length).abs();
            bones += length;
        }
    }
    if (replacing - adding).abs() <= TELLING * (replacing + adding).max(bones) {
        return None;
    }
    let percent = |error: f64| 100.0 * error / bones.max(f64::MIN_POSITIVE);
    let errors = format!("(off by {:.1} % replacing, {:.1} % adding)", percent(replacing), percent(adding));
    Some(if replacing < adding {
        Decided::new(OffsetMeaning::Replace, format!("replacing OFFSET keeps the bones' lengths {errors}"))
    } else {
        Decided::new(OffsetMeaning::Add, format!("adding to OFFSET keeps the bones' lengths {errors}"))
    })
}

/// Decides by the floor: the reading under which it lies nearer 0.
pub(super) fn by_floor(replacing: f64, adding: f64, height: f64) -> Decided<OffsetMeaning> {
    let (replacing, adding) = (replacing / height, adding / height);
    if (replacing.abs() - adding.abs()).abs() <= TELLING {
        return Decided::new(OffsetMeaning::Replace, UNDECIDED);
    }
    let floors = format!("(at {replacing:.2} H replacing, {adding:.2} H adding)");
    if replacing.abs() < adding.abs() {
        Decided::new(OffsetMeaning::Replace, format!("replacing OFFSET brings the floor nearer 0 {floors}"))
    } else {
        Decided::new(OffsetMeaning::Add, format!("adding to OFFSET brings the floor nearer 0 {floors}"))
    }
}

/// Returns the roots with position channels and what adding puts on top of replacing, file axes.
pub(super) fn added_to_roots<'a>(motion: &'a FileMotion) -> impl Iterator<Item = (usize, DVec3)> + use<'a> {
    (motion.skeleton.joints().iter().enumerate())
        .filter(|(idx, joint)| joint.parent.is_none() && motion.channels[*idx].has_position())
        .map(|(idx, joint)| (idx, motion.channels[idx].covered(joint.offset)))
}

/// Returns how much higher the floor lies when the first root's channels add to OFFSET.
pub(super) fn floor_shift(motion: &FileMotion, up: UpAxis) -> f64 {
    added_to_roots(motion).next().map_or(0.0, |(_, added)| added.dot(up.direction()))
}

/// Returns up to 64 frames, evenly spread.
fn sample(n_frames: usize) -> impl Iterator<Item = usize> {
    (0..n_frames).step_by(n_frames.div_ceil(64).max(1))
}
