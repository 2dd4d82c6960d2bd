//! Where a foot should be: one rigid motion per plant, blended over the swings between them (METHOD 6, steps 2 to 4).
//!
//! Time is cut into *stretches* over which one motion holds: a plant's own motion, or plain path editing. In the gaps
//! between two stretches the foot is a blend of what both would make of it.

use glam::{DQuat, DVec3};

use super::{
    Ground, Job,
    prepared::{LegFrame, PreparedLeg, PreparedPlant},
};
use crate::{
    contact::PlantMode,
    math::{Rigid, heading_rotation},
};

/// Time over which a foot goes from plain path editing to a plant or back, seconds.
const TO_PLAIN_SECS: f64 = 0.5;

/// Two plants further apart than this have plain path editing between them, seconds.
const LONGEST_SWING_SECS: f64 = 1.5;

/// Plants of a foot with shorter gaps between them have one motion: the foot hardly leaves the ground, seconds.
const SHORTEST_SWING_SECS: f64 = 0.2;

/// As long as all of them together are no longer than this, seconds.
const LONGEST_GROUP_SECS: f64 = 2.5;

/// A foot's plan.
pub(super) struct FootPlan {
    /// Where the ankle should be at each frame, world.
    pub(super) ankle: Vec<Rigid>,
    /// Index of the plant, in the leg's list, that holds the foot at each frame.
    pub(super) plant: Vec<Option<u32>>,
    /// Motion of each plant that is held, by its index.
    pub(super) motions: Vec<(u32, Rigid)>,
}

/// Frames over which one motion holds; those of plain path editing may begin before the clip or end after it.
struct Stretch<'a> {
    first: i64,
    last: i64,
    /// None for plain path editing.
    held: Option<Hold<'a>>,
}

/// A plant and its motion.
#[derive(Clone, Copy)]
struct Hold<'a> {
    idx: u32,
    plant: &'a PreparedPlant,
    motion: Rigid,
}

/// Plans a foot. `passage` takes the source's world at each frame to where plain path editing has it.
pub(super) fn plan(leg: &PreparedLeg, job: &Job, passage: &[Rigid], frame_time_secs: f64) -> FootPlan {
    let n = passage.len();
    let stretches = stretches(leg, job, passage, frame_time_secs);
    let mut plan = FootPlan {
        ankle: Vec::with_capacity(n),
        plant: vec![None; n],
        motions: stretches.iter().filter_map(|s| s.held.map(|h| (h.idx, h.motion))).collect(),
    };
    let mut at = 0;
    for (idx, stretch) in stretches.iter().enumerate() {
        while (at as i64) <= stretch.last && at < n {
            let ankle = &leg.frames[at].ankle_world;
            plan.ankle.push(stretch.moved(ankle, &passage[at], at));
            plan.plant[at] = stretch.held.map(|h| h.idx);
            at += 1;
        }
        let Some(next) = stretches.get(idx + 1) else { break };
        while (at as i64) < next.first && at < n {
            let ankle = &leg.frames[at].ankle_world;
            let from = stretch.moved(ankle, &passage[at], at);
            let to = next.moved(ankle, &passage[at], at);
            let share = (at as i64 - stretch.last) as f64 / (next.first - stretch.last) as f64;
            plan.ankle.push(blend(&from, &to, smootherstep(share)));
            at += 1;
        }
    }
    plan
}

/// Cuts time into stretches: they cover the clip but for the gaps between them.
fn stretches<'a>(leg: &'a PreparedLeg, job: &Job, passage: &[Rigid], frame_time_secs: f64) -> Vec<Stretch<'a>> {
    let n = passage.len();
    let frames_in = |secs: f64| (secs / frame_time_secs).ceil().max(1.0) as i64;
    let to_plain = frames_in(TO_PLAIN_SECS);
    let longest = frames_in(LONGEST_SWING_SECS).max(2 * to_plain);
    let (shortest, group) = (frames_in(SHORTEST_SWING_SECS), frames_in(LONGEST_GROUP_SECS));
    let together = |a: &PreparedPlant, b: &PreparedPlant| {
        let is_held = |p: &PreparedPlant| p.plant.mode != PlantMode::Slide;
        is_held(a) && is_held(b) && ((b.plant.first - a.plant.last) as i64) < shortest
    };
    let plain = |first, last| Stretch { first, last, held: None };
    let mut stretches: Vec<Stretch> = Vec::with_capacity(2 * leg.plants.len() + 1);
    let n_shown = leg.plants.partition_point(|p| p.plant.first < n);
    let mut group_end = 0;
    let mut motion = Rigid::IDENTITY;
    for (idx, plant) in leg.plants[..n_shown].iter().enumerate() {
        let (first, last) = (plant.plant.first as i64, plant.plant.last as i64);
        if plant.plant.mode == PlantMode::Slide {
            stretches.push(plain(first, last));
            continue;
        }
        if idx >= group_end {
            group_end = idx + 1;
            while group_end < n_shown
                && together(&leg.plants[group_end - 1], &leg.plants[group_end])
                && leg.plants[group_end].plant.last as i64 - first <= group
            {
                group_end += 1;
            }
            motion = motion_of(&leg.plants[idx..group_end], &leg.frames, job, passage);
        }
        let before = stretches.last().map_or(i64::MIN / 2, |s: &Stretch| s.last);
        let after_plant = stretches.last().is_some_and(|s| s.held.is_some());
        if first - before > longest {
            stretches.push(plain(if after_plant { before + to_plain } else { before }, first - to_plain));
        }
        stretches.push(Stretch { first, last, held: Some(Hold { idx: idx as u32, plant, motion }) });
    }
    let last = stretches.last().map_or(i64::MIN / 2, |s| s.last + to_plain);
    stretches.push(plain(last, i64::MAX));
    stretches
}

impl Stretch<'_> {
    /// Returns where the ankle of a frame is by this stretch's motion; also for frames outside it.
    fn moved(&self, ankle: &Rigid, passage: &Rigid, frame: usize) -> Rigid {
        let Some(hold) = &self.held else { return *passage * *ankle };
        if hold.plant.slide.is_empty() {
            return hold.motion * *ankle;
        }
        let slide = &hold.plant.slide;
        let at = (frame as i64 - self.first).clamp(0, slide.len() as i64 - 1) as usize;
        hold.motion * Rigid::new(ankle.rotation, ankle.translation - slide[at])
    }
}

/// Returns the one motion of plants: the mean turn of plain path editing about up, and where it puts the foot on
/// average; on a ramp also the slope's tilt.
fn motion_of(plants: &[PreparedPlant], frames: &[LegFrame], job: &Job, passage: &[Rigid]) -> Rigid {
    let (mut place, mut foot, mut yaw, mut slope, mut heading) = (DVec3::ZERO, DVec3::ZERO, 0.0, 0.0, 0.0);
    let mut n = 0.0;
    for f in plants.iter().flat_map(|p| p.plant.first..=p.plant.last.min(passage.len() - 1)) {
        let mid = 0.5 * (frames[f].ankle_world.translation + frames[f].toe_world);
        foot += mid;
        place += passage[f].point(mid);
        yaw += job.path[f].heading_rad - job.original[f].heading_rad;
        slope += job.path[f].slope_rad - job.original[f].slope_rad;
        heading += job.path[f].heading_rad;
        n += 1.0;
    }
    let (place, foot) = (place / n, foot / n);
    let mut rotation = heading_rotation(yaw / n);
    if job.ground == Ground::Ramp {
        let along = heading_rotation(heading / n);
        // A turn about X takes Z down, so a slope up is a negative one.
        rotation = along * DQuat::from_rotation_x(-slope / n) * along.conjugate() * rotation;
    }
    Rigid::new(rotation, place - rotation * foot)
}

/// Returns a motion between two, `share` of the way.
fn blend(from: &Rigid, to: &Rigid, share: f64) -> Rigid {
    let to_rotation = if from.rotation.dot(to.rotation) < 0.0 { -to.rotation } else { to.rotation };
    let rotation = (from.rotation * (1.0 - share) + to_rotation * share).normalize();
    Rigid::new(rotation, from.translation.lerp(to.translation, share))
}

/// Goes from 0 to 1 over [0, 1] with no velocity and no acceleration at either end.
pub(super) fn smootherstep(x: f64) -> f64 {
    let x = x.clamp(0.0, 1.0);
    x * x * x * (10.0 + x * (6.0 * x - 15.0))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_swing_begins_and_ends_at_rest() {
        const STEP: f64 = 1e-4;
        assert_eq!((smootherstep(-1.0), smootherstep(0.0), smootherstep(1.0), smootherstep(2.0)), (0.0, 0.0, 1.0, 1.0));
        assert!(smootherstep(STEP) < 1e-10 && 1.0 - smootherstep(1.0 - STEP) < 1e-10);
        assert!((smootherstep(0.5) - 0.5).abs() < 1e-15);
    }
}
