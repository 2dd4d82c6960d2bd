//! `hold`: from a plain path edit to one whose feet stay where they stand.

use glam::DVec3;
use serde::{Deserialize, Serialize};

use super::{
    Prepared,
    bend::{Bend, HeldFoot, freedom},
    cost::Wish,
    feet::{self, FootPlan},
    level::lifts,
    offset::Problem,
    passage::Passage,
    prepared::PreparedLeg,
};
use crate::{
    contact::GroundSlope,
    math::{Rigid, twist_rad},
    motion::TurnedJoint,
    path::PathFrame,
    sync::{each, listed},
};

/// Weight of a leg in swing over one that stands.
const SWING_WEIGHT: f64 = 0.5;

/// A plant is missed when its foot is off by more than this share of the body height.
const MISSED: f64 = 1e-4;

/// `plants.ground`: how planted feet stand on a path that climbs.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Ground {
    /// As in the source: each footprint is as level as the performer's was.
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
    /// Where plain path editing puts the carrier with its layers, world; at most as many frames as the clip has.
    pub carrier: &'a [Rigid],
    /// The same where layers do not move the carrier; empty if they do not. They move feet that stand along the ground,
    /// but neither lift nor sink them.
    pub own: &'a [Rigid],
    /// Frame of the new path at each frame, `M1`.
    pub path: &'a [PathFrame],
    /// Frame of the original path at each frame, `M0`.
    pub original: &'a [PathFrame],
    /// How planted feet stand on a slope.
    pub ground: Ground,
}

/// An edit whose feet stay where they stand.
#[derive(Clone, Debug, Default)]
pub struct Held {
    /// Where the carrier is at each frame, world.
    pub carrier: Vec<Rigid>,
    /// Local rotations of hip, knee and ankle of every leg held, by frame.
    pub turned: Vec<TurnedJoint>,
    /// Where that has ankle and toe of every leg held, world.
    pub feet: Vec<HeldFoot>,
    /// Where the feet stand, leg by leg in order of time.
    pub footprints: Vec<Footprint>,
    /// Plants that could not be reached.
    pub missed: Vec<Missed>,
    /// Largest distance of the carrier from where plain path editing puts it, clip's unit.
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
    /// Upright of the ground it stands on, unit, world; leans where the foot is tilted with a ramp.
    pub normal: DVec3,
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
    assert!(job.own.is_empty() || job.own.len() == n, "the clip's frames, one to one");
    let dt = prepared.frame_time_secs;
    let lifts = lifts(job.path, job.original, prepared.slope);
    let lift = |(plain, by): (&Rigid, &f64)| Rigid { translation: plain.translation + *by * DVec3::Y, ..*plain };
    let mut carrier = listed(n, |frames| job.carrier[frames.clone()].iter().zip(&lifts[frames]).map(lift));
    let own: Vec<Rigid> = job.own.iter().zip(&lifts).map(lift).collect();
    let job = &Job { carrier: &carrier, own: &own, ..*job };
    let passage = Passage::new(prepared, job);
    let asks = each(&prepared.legs, n, |_, leg| Ask::new(leg, job, prepared.slope, &passage, dt));
    if passage.moves_as_one(prepared.height) && prepared.legs.iter().all(PreparedLeg::keeps_its_slides) {
        let footprints = footprints(prepared, &asks);
        let largest_offset = largest(lifts.iter().map(|by| *by * DVec3::Y));
        return Held { carrier, footprints, largest_offset, ..Held::default() };
    }
    let wishes: Vec<&[Wish]> = asks.iter().map(|ask| &ask.wishes[..]).collect();
    let offsets = Problem { wishes: &wishes, frame_time_secs: dt, height: prepared.height }.offsets();
    for (carrier, offset) in carrier.iter_mut().zip(&offsets) {
        carrier.translation += offset;
    }
    let mut held = Held { carrier, ..Held::default() };
    held.largest_offset = largest(offsets.iter().zip(&lifts).map(|(offset, by)| *offset + *by * DVec3::Y));
    let bent = each(&prepared.legs, n, |idx, leg| {
        let Ask { plan, free, .. } = &asks[idx];
        let (carrier, offsets) = (&held.carrier, &offsets);
        Bend { leg, feet: &plan.feet, free, carrier, offsets, frame_time_secs: dt }.solve(MISSED * prepared.height)
    });
    for (idx, (leg, bent)) in prepared.legs.iter().zip(bent).enumerate() {
        held.turned.extend(bent.turned);
        held.feet.push(bent.foot);
        for (plant, frame, by) in bent.missed {
            held.miss(idx, leg, plant, frame, by);
        }
    }
    held.footprints = footprints(prepared, &asks);
    held
}

fn largest(ways: impl Iterator<Item = DVec3>) -> f64 {
    ways.map(|way| way.length_squared()).fold(0.0, f64::max).sqrt()
}

fn footprints(prepared: &Prepared, asks: &[Ask]) -> Vec<Footprint> {
    let legs = prepared.legs.iter().zip(asks).enumerate();
    legs.flat_map(|(idx, (leg, ask))| {
        ask.plan.motions.iter().map(move |(plant, motion)| footprint(idx, leg, *plant, motion))
    })
    .collect()
}

/// What a leg asks for: where its foot should be, and that of the carrier.
struct Ask {
    plan: FootPlan,
    /// How free the foot is at each frame.
    free: Vec<f64>,
    wishes: Vec<Wish>,
}

impl Ask {
    fn new(leg: &PreparedLeg, job: &Job, source: GroundSlope, passage: &Passage, frame_time_secs: f64) -> Self {
        let plan = feet::plan(leg, job, source, passage, frame_time_secs);
        let free = freedom(&plan.feet, frame_time_secs);
        let wishes = (job.carrier.iter().zip(&*leg.frames).zip(&plan.feet).zip(&free))
            .map(|(((carrier, frame), foot), &free)| Wish {
                leg: carrier.point(frame.hip) - foot.ankle.translation,
                moves: DVec3::ONE - foot.follows,
                bend: frame.bend,
                length: frame.length,
                weight: 1.0 + free * (SWING_WEIGHT - 1.0),
                // Nor may a leg be too long just before it is planted and just after, where it is not free yet.
                limit: frame.limit_when(free),
            })
            .collect();
        Self { plan, free, wishes }
    }
}

fn footprint(idx: usize, leg: &PreparedLeg, plant_idx: u32, motion: &Rigid) -> Footprint {
    let prepared = &leg.plants[plant_idx as usize];
    let (first, last) = (prepared.plant.first, prepared.plant.last);
    let heading_rad = crate::math::heading_rad(motion.rotation * prepared.along).unwrap_or(twist_rad(motion.rotation));
    let normal = motion.rotation * DVec3::Y;
    Footprint { leg: idx, first, last, place: motion.point(prepared.foot), heading_rad, normal }
}

impl Held {
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
