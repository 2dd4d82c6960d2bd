//! `hold`: from a plain path edit to one whose feet stay where they stand.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::{
    Prepared,
    feet::{self, FootPlan, smootherstep},
    offset::{Wish, offsets},
    prepared::{LegFrame, PreparedLeg},
};
use crate::{
    math::{Rigid, TwoBone, twist_rad},
    motion::TurnedJoint,
    path::PathFrame,
};

/// A planted leg is held within this share of its length, unless the source's own is longer.
const LIMIT: f64 = 0.9995;

/// A leg's wish counts no more than this, although a knee turns ever faster towards full extension.
const MOST_WEIGHT: f64 = 50.0;

/// Weight of a leg in swing over one that stands.
const SWING_WEIGHT: f64 = 0.3;

/// Time over which easing sets in after a plant and ends before one, seconds.
const EASE_SECS: f64 = 0.1;

/// A leg in swing is eased over this share of its length before it is straight.
const EASE_SHARE: f64 = 0.02;

/// A plant is missed when its foot is off by more than this share of the body height.
const MISSED: f64 = 1e-4;

/// `plants.ground`: how planted feet stand on a path that climbs.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ground {
    /// As in the source: each footprint is as level as the performer's was.
    #[default]
    Steps,
    /// Tilted with the slope of the path.
    Ramp,
}

/// A plain path edit to be held.
///
/// Its frames are the clip's from the first one on, one to one: cut neither where the path ends nor by cycling, with
/// the new path carried on along its end.
#[derive(Clone, Copy, Debug)]
pub struct Job<'a> {
    /// Where plain path editing puts the carrier, world; at most as many frames as the clip has.
    pub carrier: &'a [Rigid],
    /// Frame of the new path at each frame, `M1`.
    pub path: &'a [PathFrame],
    /// Frame of the original path at each frame, `M0`.
    pub original: &'a [PathFrame],
    /// How planted feet stand on a slope.
    pub ground: Ground,
}

/// An edit whose feet stay where they stand.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Held {
    /// Where the carrier is at each frame, world.
    pub carrier: Vec<Rigid>,
    /// Local rotations of hip, knee and ankle of every leg held, by frame.
    pub turned: Vec<TurnedJoint>,
    /// Where the feet stand, leg by leg in order of time.
    pub footprints: Vec<Footprint>,
    /// Plants that could not be reached.
    pub missed: Vec<Missed>,
    /// Largest distance by which the carrier gave way, clip's unit.
    pub largest_offset: f64,
}

/// Where a foot stands.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Index of the leg in [`Prepared::legs`].
    pub leg: usize,
    /// First frame of the plant.
    pub first: usize,
    /// Last frame of the plant.
    pub last: usize,
    /// The middle between ankle and toe in the mean over the plant, world.
    pub place: DVec3,
    /// Direction from ankle to toe, about up, radians.
    pub heading_rad: f64,
}

/// A plant that could not be reached.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Missed {
    /// Index of the leg in [`Prepared::legs`].
    pub leg: usize,
    /// First frame of the plant.
    pub first: usize,
    /// Last frame of the plant.
    pub last: usize,
    /// Frame at which most is missing.
    pub frame: usize,
    /// How much, clip's unit.
    pub by: f64,
}

/// Holds the plants of a clip on a path. Linear in the number of frames.
///
/// Cannot fail: a plant that cannot be reached is approached as far as its leg is long and reported.
///
/// # Panics
///
/// When the job's lists differ in length or have more frames than the clip.
pub fn hold(prepared: &Prepared, job: &Job) -> Held {
    let n = job.carrier.len();
    assert!(n <= prepared.n_frames && job.path.len() == n && job.original.len() == n, "the clip's frames, one to one");
    let dt = prepared.frame_time_secs;
    let passage: Vec<Rigid> =
        job.carrier.iter().zip(&prepared.carrier).map(|(plain, source)| *plain * source.inverse()).collect();
    let plans: Vec<FootPlan> = prepared.legs.iter().map(|leg| feet::plan(leg, job, &passage, dt)).collect();
    let eases: Vec<Vec<f64>> = plans.iter().map(|plan| eases(&plan.plant, dt)).collect();
    let wishes: Vec<Vec<Wish>> = (prepared.legs.iter().zip(&plans).zip(&eases))
        .map(|((leg, plan), ease)| wishes(leg, plan, ease, job.carrier))
        .collect();
    let offsets = offsets(&wishes, dt);
    let mut held = Held { carrier: job.carrier.to_vec(), ..Held::default() };
    for (carrier, offset) in held.carrier.iter_mut().zip(&offsets) {
        carrier.translation += offset;
    }
    held.largest_offset = offsets.iter().map(|o| o.length_squared()).fold(0.0, f64::max).sqrt();
    for (idx, ((leg, plan), ease)) in prepared.legs.iter().zip(&plans).zip(&eases).enumerate() {
        held.bend(idx, leg, plan, ease, prepared.height);
        held.footprints.extend(plan.motions.iter().map(|(plant, motion)| footprint(idx, leg, *plant, motion)));
    }
    held
}

/// Returns what a leg asks of the carrier at every frame.
fn wishes(leg: &PreparedLeg, plan: &FootPlan, ease: &[f64], carrier: &[Rigid]) -> Vec<Wish> {
    (carrier.iter().zip(&leg.frames).zip(&plan.ankle).zip(ease))
        .map(|(((carrier, frame), ankle), &ease)| {
            let share = frame.reach / frame.length;
            let weight = (1.0 / (1.0 - share * share)).clamp(1.0, MOST_WEIGHT);
            Wish {
                leg: carrier.point(frame.hip) - ankle.translation,
                reach: frame.reach,
                weight: weight * (1.0 + ease * (SWING_WEIGHT - 1.0)),
                // Nor may a leg be too long just before it is planted and just after, where it cannot be eased yet.
                limit: if ease < 1.0 { frame.limit() } else { f64::INFINITY },
            }
        })
        .collect()
}

impl LegFrame {
    /// Returns the distance from hip to ankle that a planted leg keeps to.
    fn limit(&self) -> f64 {
        (LIMIT * self.length).max(self.reach)
    }
}

fn footprint(idx: usize, leg: &PreparedLeg, plant_idx: u32, motion: &Rigid) -> Footprint {
    let prepared = &leg.plants[plant_idx as usize];
    let (first, last) = (prepared.plant.first, prepared.plant.last);
    let along = (leg.frames[first..=last].iter()).map(|f| f.toe_world - f.ankle_world.translation).sum::<DVec3>();
    let heading_rad = crate::math::heading_rad(motion.rotation * along).unwrap_or(twist_rad(motion.rotation));
    Footprint { leg: idx, first, last, place: motion.point(prepared.foot), heading_rad }
}

impl Held {
    /// Bends a leg to its foot's plan.
    fn bend(&mut self, idx: usize, leg: &PreparedLeg, plan: &FootPlan, ease: &[f64], height: f64) {
        let n = self.carrier.len();
        let [mut hips, mut knees, mut ankles] = [0; 3].map(|_| Vec::with_capacity(n));
        for (frame, &ease) in ease.iter().enumerate().take(n) {
            let (source, carrier) = (&leg.frames[frame], &self.carrier[frame]);
            let back = carrier.rotation.conjugate();
            let wanted = back * (plan.ankle[frame].translation - carrier.translation) - source.hip;
            let target = eased(source, wanted, ease);
            let turns = TwoBone { thigh: source.thigh, shin: source.shin, hinge: source.hinge, target }.solve();
            let local = |parent: DQuat, world: DQuat| parent.conjugate() * world;
            hips.push(local(source.hip_parent, turns.hip * source.hip_rotation));
            knees.push(local(source.knee_parent, turns.knee * source.knee_rotation));
            let shin = turns.hip * turns.knee * source.ankle_parent;
            ankles.push(local(shin, back * plan.ankle[frame].rotation));
            if let Some(plant) = plan.plant[frame] {
                let by = wanted.distance(turns.reached);
                if by > MISSED * height {
                    self.miss(idx, leg, plant, frame, by);
                }
            }
        }
        for (joint, rotations) in [(leg.leg.hip, hips), (leg.leg.knee, knees), (leg.leg.ankle, ankles)] {
            self.turned.push(TurnedJoint { joint, rotations });
        }
    }

    fn miss(&mut self, leg_idx: usize, leg: &PreparedLeg, plant: u32, frame: usize, by: f64) {
        let plant = leg.plants[plant as usize].plant;
        match self.missed.last_mut() {
            Some(last) if (last.leg, last.first) == (leg_idx, plant.first) => {
                if by > last.by {
                    (last.frame, last.by) = (frame, by);
                }
            }
            _ => self.missed.push(Missed { leg: leg_idx, first: plant.first, last: plant.last, frame, by }),
        }
    }
}

/// Returns the target of a leg in swing, drawn in so that the leg comes near its full length but slowly; the target
/// itself where that is near enough. No leg that is shorter than in the source is changed.
fn eased(source: &LegFrame, target: DVec3, ease: f64) -> DVec3 {
    let free = (source.limit() - ease * EASE_SHARE * source.length).max(source.reach);
    let room = source.length - free;
    let wanted_squared = target.length_squared();
    if ease == 0.0 || wanted_squared <= free * free || room <= 0.0 {
        return target;
    }
    let wanted = wanted_squared.sqrt();
    target * ((free + room * (1.0 - ((free - wanted) / room).exp())) / wanted)
}

/// Returns how much a foot is eased at each frame: not in plants, fully well away from them.
fn eases(plant: &[Option<u32>], frame_time_secs: f64) -> Vec<f64> {
    let n_frames = (EASE_SECS / frame_time_secs).max(1.0);
    let n = plant.len();
    let mut distance = vec![f64::INFINITY; n];
    let mut since = f64::INFINITY;
    for f in 0..n {
        since = if plant[f].is_some() { 0.0 } else { since + 1.0 };
        distance[f] = since;
    }
    since = f64::INFINITY;
    for f in (0..n).rev() {
        since = if plant[f].is_some() { 0.0 } else { since + 1.0 };
        distance[f] = smootherstep(distance[f].min(since) / n_frames);
    }
    distance
}
