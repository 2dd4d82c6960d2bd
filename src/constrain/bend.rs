//! The legs follow: from where a foot should be and where the carrier is to the turns of hip, knee and ankle.
//!
//! A planted foot goes where its plan has it. A leg in swing need not: where its foot would be so far away that the leg
//! came nearer to its full length than the performer's does, the foot is drawn in, smoothly over time. Knees turn ever
//! faster towards full extension, and a swing that leaves it out is not seen.

use glam::DVec3;
use wide::f64x4;

use super::{
    feet::Planned,
    prepared::{LegFrame, PreparedLeg},
};
use crate::{
    math::{
        Rigid,
        lanes::{LANES, QuatLanes, VecLanes, four},
        smootherstep,
    },
    motion::{Track, TurnedJoint},
};

/// A planted leg is held within this share of its length, unless the source's own is about as long: a knee that comes
/// nearer to straight turns back within a frame or two.
pub(super) const LIMIT: f64 = 0.993;

/// A planted leg may be longer than the source's by this share of its length …
const LONGER: f64 = 0.003;

/// … up to this share.
const STRAIGHT: f64 = 0.999;

/// A leg in swing is held within this share of its length, unless the source's own is longer.
const SWING_LIMIT: f64 = 0.975;

/// Half the time before and after over which a foot is drawn in, seconds.
const DRAW_SECS: f64 = 0.04;

/// Time after a plant and before one over which a foot becomes free to be drawn in, seconds.
const FREE_SECS: f64 = 0.16;

/// A way shorter than this has no direction to be drawn in along, the clip's unit.
const SHORTEST: f64 = 1e-300;

/// Everything the turns of one leg follow from, frame by frame.
pub(super) struct Bend<'a> {
    pub(super) leg: &'a PreparedLeg,
    pub(super) feet: &'a [Planned],
    /// How free the foot is: 0 in a plant, 1 well away from plants.
    pub(super) free: &'a [f64],
    /// The carrier with its offset, world.
    pub(super) carrier: &'a [Rigid],
    /// The offset, world.
    pub(super) offsets: &'a [DVec3],
    pub(super) frame_time_secs: f64,
}

/// Where a held foot is at each frame, world.
#[derive(Clone, Debug, Default)]
pub struct HeldFoot {
    ankle: [Vec<f64>; 3],
    toe: [Vec<f64>; 3],
}

/// How a leg turns and what it could not do.
pub(super) struct Bent {
    /// Local rotations of hip, knee and ankle.
    pub(super) turned: [TurnedJoint; 3],
    pub(super) foot: HeldFoot,
    /// Frames of plants at which the foot is not where it should be: plant, frame, distance.
    pub(super) missed: Vec<(u32, usize, f64)>,
}

impl HeldFoot {
    /// Returns the places of the ankle.
    pub fn ankle(&self) -> Track<'_> {
        let [x, y, z] = &self.ankle;
        Track { x, y, z }
    }

    /// Returns the places of the toe.
    pub fn toe(&self) -> Track<'_> {
        let [x, y, z] = &self.toe;
        Track { x, y, z }
    }

    fn with_capacity(n_frames: usize) -> Self {
        let axes = || [0; 3].map(|_| Vec::with_capacity(n_frames));
        Self { ankle: axes(), toe: axes() }
    }

    #[inline(always)]
    fn push(&mut self, ankle: VecLanes, toe: VecLanes) {
        for (axes, VecLanes { x, y, z }) in [(&mut self.ankle, ankle), (&mut self.toe, toe)] {
            axes.iter_mut().zip([x, y, z]).for_each(|(axis, lanes)| axis.extend(lanes.to_array()));
        }
    }

    fn truncate(&mut self, n_frames: usize) {
        self.ankle.iter_mut().chain(&mut self.toe).for_each(|axis| axis.truncate(n_frames));
    }
}

impl Bend<'_> {
    /// Bends the leg. A plant is missed when its foot is off by more than `accuracy`.
    pub(super) fn solve(&self, accuracy: f64) -> Bent {
        let n = self.carrier.len();
        let wanted: Vec<VecLanes> = (0..n).step_by(LANES).map(|at| self.wanted(at)).collect();
        let drawn_in = self.drawn_in(&wanted);
        let [mut hips, mut knees, mut ankles] = [0; 3].map(|_| Vec::with_capacity(n + LANES));
        let mut held = HeldFoot::with_capacity(n + LANES);
        let mut missed = Vec::new();
        for (at, (pose, &wanted)) in (0..n).step_by(LANES).zip(self.leg.shape.poses.iter().zip(&wanted)) {
            let target = match drawn_in.get(at..(at + LANES).min(n)) {
                Some(by) if by.iter().any(|&by| by > 0.0) => {
                    let by = f64x4::new(four(&drawn_in, at).map(|by| *by));
                    wanted.scaled(f64x4::ONE - by / wanted.length().fast_max(by).fast_max(f64x4::splat(SHORTEST)))
                }
                _ => wanted,
            };
            let turns = pose.limbs.reach(target);
            let hip = pose.hip_parent.conjugate().times(turns.hip.times(pose.hip_rotation));
            let knee = pose.knee.turned(turns.knee);
            let shin = turns.hip.times(pose.ankle_parent.turned(turns.knee));
            let carrier = four(self.carrier, at);
            let turn = QuatLanes::gather(|lane| carrier[lane].rotation);
            let feet = four(self.feet, at);
            let foot = QuatLanes::gather(|lane| feet[lane].ankle.rotation);
            hips.extend(hip.lanes());
            knees.extend(knee.lanes());
            ankles.extend(turn.times(shin).conjugate().times(foot).lanes());
            let place = VecLanes::gather(|lane| carrier[lane].translation);
            let ankle = turn.rotate(pose.hip.plus(turns.reached)).plus(place);
            held.push(ankle, ankle.plus(foot.rotate(pose.toe)));
            let off = wanted.minus(turns.reached).length_squared();
            if off.simd_gt(f64x4::splat(accuracy * accuracy)).any() {
                for (frame, off) in (at..n).zip(off.to_array()) {
                    if let Some(plant) = self.feet[frame].plant
                        && off > accuracy * accuracy
                    {
                        missed.push((plant, frame, off.sqrt()));
                    }
                }
            }
        }
        let joints = self.leg.leg;
        let turned =
            [(joints.hip, hips), (joints.knee, knees), (joints.ankle, ankles)].map(|(joint, mut rotations)| {
                rotations.truncate(n);
                TurnedJoint { joint, rotations }
            });
        held.truncate(n);
        Bent { turned, foot: held, missed }
    }

    /// Returns where the ankle should be as seen from the hip, in the carrier's space, at four frames.
    #[inline(always)]
    fn wanted(&self, at: usize) -> VecLanes {
        let (feet, carrier, offsets) = (four(self.feet, at), four(self.carrier, at), four(self.offsets, at));
        let ankle = VecLanes::gather(|lane| feet[lane].ankle.translation - carrier[lane].translation);
        let offset = VecLanes::gather(|lane| *offsets[lane]);
        let ankle = VecLanes::gather(|lane| feet[lane].follows).times(offset).plus(ankle);
        let back = QuatLanes::gather(|lane| carrier[lane].rotation).conjugate();
        back.rotate(ankle).minus(self.leg.shape.poses[at / LANES].hip)
    }

    /// Returns by how much the foot is drawn in towards the hip at each frame; nothing where it never is.
    ///
    /// What is too much is carried to the frames around it and blurred over fewer, so that every frame is drawn in by
    /// at least its own excess.
    fn drawn_in(&self, wanted: &[VecLanes]) -> Vec<f64> {
        let n = self.carrier.len();
        let half = (DRAW_SECS / self.frame_time_secs).round().max(1.0) as usize;
        let mut drawn_in = Vec::new();
        let squares = wanted.iter().flat_map(|wanted| wanted.length_squared().to_array());
        for (frame, (square, source)) in squares.zip(&self.leg.frames[..n]).enumerate() {
            let most = source.swing_limit();
            if self.free[frame] == 0.0 || square <= most * most {
                continue;
            }
            drawn_in.resize(n, 0.0f64);
            let excess = square.sqrt() - most;
            for around in &mut drawn_in[frame.saturating_sub(2 * half)..(frame + 2 * half + 1).min(n)] {
                *around = around.max(excess);
            }
        }
        if !drawn_in.is_empty() {
            drawn_in = blurred(&blurred(&drawn_in, half), half);
            drawn_in.iter_mut().zip(self.free).for_each(|(by, free)| *by *= free);
        }
        drawn_in
    }
}

/// Returns the means from `half` frames before to `half` after each; ends are held.
fn blurred(values: &[f64], half: usize) -> Vec<f64> {
    let last = values.len() - 1;
    let mut sum = half as f64 * values[0] + (0..=half).map(|i| values[i.min(last)]).sum::<f64>();
    let width = (2 * half + 1) as f64;
    (0..values.len())
        .map(|i| {
            let mean = sum / width;
            sum += values[(i + half + 1).min(last)] - values[i.saturating_sub(half)];
            // Rounding may leave a trace below nothing.
            mean.max(0.0)
        })
        .collect()
}

/// Returns how free a foot is at each frame: 0 in plants, 1 well away from them.
pub(super) fn freedom(feet: &[Planned], frame_time_secs: f64) -> Vec<f64> {
    let mut free = Vec::with_capacity(feet.len());
    let mut since = f64::INFINITY;
    for foot in feet {
        since = if foot.plant.is_some() { 0.0 } else { since + 1.0 };
        free.push(since);
    }
    let mut until = f64::INFINITY;
    for (free, foot) in free.iter_mut().zip(feet).rev() {
        until = if foot.plant.is_some() { 0.0 } else { until + 1.0 };
        *free = free_at(free.min(until), frame_time_secs);
    }
    free
}

/// Returns how free a foot is this many frames from the nearest plant.
pub(super) fn free_at(n_frames: f64, frame_time_secs: f64) -> f64 {
    smootherstep(n_frames / (FREE_SECS / frame_time_secs).max(1.0))
}

impl LegFrame {
    /// Returns the distance from hip to ankle that a leg may ask for, its foot as free as this, so that it is no longer
    /// than a planted leg may be once its foot is drawn in; infinite for a free foot.
    pub(super) fn limit_when(&self, free: f64) -> f64 {
        let near = (self.reach + LONGER * self.length).min(STRAIGHT * self.length);
        let planted = near.max(LIMIT * self.length).max(self.reach);
        match free {
            0.0 => planted,
            1.0 => f64::INFINITY,
            free => (planted - free * self.swing_limit()) / (1.0 - free),
        }
    }

    /// Returns the distance from hip to ankle beyond which a free foot is drawn in.
    fn swing_limit(&self) -> f64 {
        (SWING_LIMIT * self.length).max(self.reach)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn blurring_keeps_what_is_even_and_spreads_the_rest() {
        assert_eq!(blurred(&[2.0; 7], 2), [2.0; 7]);
        assert_eq!(blurred(&[3.0], 4), [3.0]);
        let spread = blurred(&[0.0, 0.0, 0.0, 6.0, 0.0, 0.0, 0.0], 1);
        assert_eq!(spread, [0.0, 0.0, 2.0, 2.0, 2.0, 0.0, 0.0]);
    }

    #[test]
    fn a_leg_may_ask_for_more_the_further_its_foot_is_drawn_in() {
        let frame = |reach| LegFrame { hip: DVec3::ZERO, reach, bend: 0.0, length: 1.0 };
        let bent = frame(0.8);
        assert_eq!((bent.limit_when(0.0), bent.limit_when(1.0)), (LIMIT, f64::INFINITY));
        for free in [0.1, 0.5, 0.9] {
            let asked = bent.limit_when(free);
            let left = asked - free * (asked - SWING_LIMIT);
            assert!((left - LIMIT).abs() < 1e-12, "{free} {asked}");
        }
        // A leg that is straight in the source may stay so, and one that nearly is may be a little straighter.
        assert_eq!((frame(1.0).limit_when(0.0), frame(0.998).limit_when(0.0)), (1.0, STRAIGHT));
    }

    #[test]
    fn a_foot_is_free_only_away_from_plants() {
        let planned = |plant| Planned { ankle: Rigid::IDENTITY, follows: DVec3::ZERO, plant };
        let feet: Vec<Planned> = (0..40).map(|f| planned((10..20).contains(&f).then_some(0))).collect();
        let free = freedom(&feet, 0.05);
        assert!(free[10..20].iter().all(|&f| f == 0.0));
        assert!(free[9] > 0.0 && free[9] < 0.2 && free[8] > free[9] && free[6] == 1.0 && free[0] == 1.0);
        assert_eq!((free[9], free[8]), (free[20], free[21]));
        assert!(freedom(&[planned(None)], 0.05) == [1.0] && freedom(&[], 0.05).is_empty());
    }
}
