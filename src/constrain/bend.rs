//! The legs follow: from where a foot should be and where the carrier is to the turns of hip, knee and ankle.
//!
//! A planted foot goes where its plan has it. A leg in swing need not: where its foot would be so far away that the leg
//! came nearer to its full length than the performer's does, the foot is drawn in, smoothly over time. Knees turn ever
//! faster towards full extension, and a swing that leaves it out is not seen.

use glam::{DQuat, DVec3};

use super::{
    feet::{Planned, smootherstep},
    prepared::{LegFrame, PreparedLeg},
};
use crate::{
    math::{Rigid, TwoBone},
    motion::TurnedJoint,
};

/// A planted leg is held within this share of its length, unless the source's own is longer.
const LIMIT: f64 = 0.9995;

/// A leg in swing is held within this share of its length, unless the source's own is longer.
const SWING_LIMIT: f64 = 0.975;

/// Half the time before and after over which a foot is drawn in, seconds.
const DRAW_SECS: f64 = 0.04;

/// Time after a plant and before one over which a foot becomes free to be drawn in, seconds.
const FREE_SECS: f64 = 0.1;

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

/// How a leg turns and what it could not do.
pub(super) struct Bent {
    /// Local rotations of hip, knee and ankle.
    pub(super) turned: [TurnedJoint; 3],
    /// Frames of plants at which the foot is not where it should be: plant, frame, distance.
    pub(super) missed: Vec<(u32, usize, f64)>,
}

impl Bend<'_> {
    /// Bends the leg. A plant is missed when its foot is off by more than `accuracy`.
    pub(super) fn solve(&self, accuracy: f64) -> Bent {
        let n = self.carrier.len();
        let wanted: Vec<DVec3> = (0..n).map(|frame| self.wanted(frame)).collect();
        let drawn_in = self.drawn_in(&wanted);
        let [mut hips, mut knees, mut ankles] = [0; 3].map(|_| Vec::with_capacity(n));
        let mut missed = Vec::new();
        for (frame, &wanted) in wanted.iter().enumerate() {
            let (source, foot) = (&self.leg.frames[frame], &self.feet[frame]);
            let by = drawn_in.get(frame).copied().unwrap_or(0.0);
            let target = if by > 0.0 { wanted * (1.0 - by / wanted.length().max(by)) } else { wanted };
            let turns = TwoBone { thigh: source.thigh, shin: source.shin, hinge: source.hinge, target }.solve();
            let local = |parent: DQuat, rotation: DQuat| parent.conjugate() * rotation;
            hips.push(local(source.hip_parent, turns.hip * source.hip_rotation));
            knees.push(local(source.knee_parent, turns.knee * source.knee_rotation));
            let shin = turns.hip * turns.knee * source.ankle_parent;
            ankles.push(local(shin, self.carrier[frame].rotation.conjugate() * foot.ankle.rotation));
            if let Some(plant) = foot.plant {
                let off = wanted.distance(turns.reached);
                if off > accuracy {
                    missed.push((plant, frame, off));
                }
            }
        }
        let joints = self.leg.leg;
        let turned = [(joints.hip, hips), (joints.knee, knees), (joints.ankle, ankles)]
            .map(|(joint, rotations)| TurnedJoint { joint, rotations });
        Bent { turned, missed }
    }

    /// Returns where the ankle should be as seen from the hip, in the carrier's space.
    fn wanted(&self, frame: usize) -> DVec3 {
        let (foot, carrier) = (&self.feet[frame], &self.carrier[frame]);
        let ankle = foot.ankle.translation + foot.follows * self.offsets[frame];
        carrier.rotation.conjugate() * (ankle - carrier.translation) - self.leg.frames[frame].hip
    }

    /// Returns by how much the foot is drawn in towards the hip at each frame; nothing where it never is.
    ///
    /// What is too much is carried to the frames around it and blurred over fewer, so that every frame is drawn in by
    /// at least its own excess.
    fn drawn_in(&self, wanted: &[DVec3]) -> Vec<f64> {
        let n = wanted.len();
        let half = (DRAW_SECS / self.frame_time_secs).round().max(1.0) as usize;
        let mut drawn_in = Vec::new();
        for (frame, (wanted, source)) in wanted.iter().zip(&self.leg.frames).enumerate() {
            let most = source.reach.max(SWING_LIMIT * source.length);
            if self.free[frame] == 0.0 || wanted.length_squared() <= most * most {
                continue;
            }
            drawn_in.resize(n, 0.0f64);
            let excess = wanted.length() - most;
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
    let n_frames = (FREE_SECS / frame_time_secs).max(1.0);
    let mut free = Vec::with_capacity(feet.len());
    let mut since = f64::INFINITY;
    for foot in feet {
        since = if foot.plant.is_some() { 0.0 } else { since + 1.0 };
        free.push(since);
    }
    let mut until = f64::INFINITY;
    for (free, foot) in free.iter_mut().zip(feet).rev() {
        until = if foot.plant.is_some() { 0.0 } else { until + 1.0 };
        *free = smootherstep(free.min(until) / n_frames);
    }
    free
}

impl LegFrame {
    /// Returns the distance from hip to ankle that a planted leg keeps to.
    pub(super) fn limit(&self) -> f64 {
        (LIMIT * self.length).max(self.reach)
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
    fn a_foot_is_free_only_away_from_plants() {
        let planned = |plant| Planned { ankle: Rigid::IDENTITY, follows: DVec3::ZERO, plant };
        let feet: Vec<Planned> = (0..40).map(|f| planned((10..20).contains(&f).then_some(0))).collect();
        let free = freedom(&feet, 0.025);
        assert!(free[10..20].iter().all(|&f| f == 0.0));
        assert!(free[9] > 0.0 && free[9] < 0.2 && free[8] > free[9] && free[6] == 1.0 && free[0] == 1.0);
        assert_eq!((free[9], free[8]), (free[20], free[21]));
        assert!(freedom(&[planned(None)], 0.025) == [1.0] && freedom(&[], 0.025).is_empty());
    }
}
