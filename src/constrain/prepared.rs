//! `Prepared`: what holding needs of the source, once per clip and plants.

use glam::{DQuat, DVec3};

use crate::{
    contact::{FootPlants, Plant, PlantMode},
    math::Rigid,
    motion::{Clip, Leg},
    skeleton::Skeleton,
};

/// Weight of a leg's usual hinge against the one its bend shows, as the sine of a bend: a knee bent less than this
/// takes the usual one.
const USUAL_HINGE: f64 = 0.05;

/// A leg shorter than this share of the body height is none.
const SHORTEST_LEG: f64 = 1e-3;

/// A source clip with its legs and plants, ready to be held on any path.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub(super) n_frames: usize,
    pub(super) frame_time_secs: f64,
    /// Body height `H`, clip's unit.
    pub(super) height: f64,
    pub(super) carrier: Vec<Rigid>,
    pub(super) legs: Vec<PreparedLeg>,
}

/// One leg of the source.
#[derive(Clone, Debug)]
pub(super) struct PreparedLeg {
    pub(super) leg: Leg,
    pub(super) plants: Vec<PreparedPlant>,
    pub(super) frames: Vec<LegFrame>,
}

/// A plant of the source.
#[derive(Clone, Debug)]
pub(super) struct PreparedPlant {
    pub(super) plant: Plant,
    /// Taken off the foot at each frame of the plant so that it stands still, world, horizontal; empty when its own
    /// slide is kept.
    pub(super) slide: Vec<DVec3>,
    /// Mean place of the foot, world.
    pub(super) foot: DVec3,
}

/// One leg at one frame. Positions and rotations in the carrier's space unless they say world.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegFrame {
    pub(super) hip: DVec3,
    /// From hip to knee.
    pub(super) thigh: DVec3,
    /// From knee to ankle.
    pub(super) shin: DVec3,
    /// Unit axis of the knee.
    pub(super) hinge: DVec3,
    /// Distance from hip to ankle.
    pub(super) reach: f64,
    /// Length of thigh and shin together.
    pub(super) length: f64,
    /// Of the joint above the hip.
    pub(super) hip_parent: DQuat,
    /// Of the hip itself.
    pub(super) hip_rotation: DQuat,
    pub(super) knee_parent: DQuat,
    pub(super) knee_rotation: DQuat,
    pub(super) ankle_parent: DQuat,
    /// World, source.
    pub(super) ankle_world: Rigid,
    /// World, source.
    pub(super) toe_world: DVec3,
}

impl Prepared {
    /// Prepares a clip; one pass over its frames.
    ///
    /// `feet` are the legs to hold with their plants. Legs without plants, legs whose joints do not hang below the
    /// carrier or cannot be turned, and legs without length are left out.
    pub fn new(clip: &Clip, feet: &[FootPlants]) -> Self {
        let n_frames = clip.n_frames();
        let height = clip.facts.height.value;
        let held: Vec<&FootPlants> = feet.iter().filter(|foot| can_be_held(clip, foot)).collect();
        let mut legs: Vec<PreparedLeg> = held
            .iter()
            .map(|foot| PreparedLeg { leg: foot.leg, plants: Vec::new(), frames: Vec::with_capacity(n_frames) })
            .collect();
        let carrier_idx = clip.facts.carrier.value.idx();
        let mut carrier = Vec::with_capacity(n_frames);
        let mut rigids = Vec::new();
        for frame in 0..n_frames {
            clip.world_rigids(frame, &mut rigids);
            let back = rigids[carrier_idx].inverse();
            carrier.push(rigids[carrier_idx]);
            for leg in &mut legs {
                leg.frames.push(LegFrame::new(&clip.skeleton, &leg.leg, &rigids, &back));
            }
        }
        for (leg, foot) in legs.iter_mut().zip(held) {
            set_hinges(&mut leg.frames);
            leg.plants = (foot.plants.iter())
                .filter(|plant| plant.first < n_frames)
                .map(|&plant| PreparedPlant::new(Plant { last: plant.last.min(n_frames - 1), ..plant }, &leg.frames))
                .collect();
        }
        legs.retain(|leg| !leg.plants.is_empty() && leg.frames.iter().all(|f| f.length > SHORTEST_LEG * height));
        Self { n_frames, frame_time_secs: clip.frame_time_secs, height, carrier, legs }
    }

    /// Returns the number of frames of the clip.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Returns the length of thigh and shin together, the clip's unit; of the first leg at the first frame.
    pub fn leg_length(&self) -> Option<f64> {
        self.legs.first().and_then(|leg| leg.frames.first()).map(|frame| frame.length)
    }

    /// Returns where a leg's foot stands in the source, plant by plant, intended slides left out; world.
    pub fn footprints(&self, leg_idx: usize) -> impl Iterator<Item = DVec3> + '_ {
        let held = self.legs[leg_idx].plants.iter().filter(|plant| plant.plant.mode != PlantMode::Slide);
        held.map(|plant| plant.foot)
    }

    /// Returns the legs that are held, in the order of what a result says of legs.
    pub fn legs(&self) -> impl ExactSizeIterator<Item = Leg> + '_ {
        self.legs.iter().map(|leg| leg.leg)
    }
}

fn can_be_held(clip: &Clip, foot: &FootPlants) -> bool {
    let Leg { hip, knee, ankle, .. } = foot.leg;
    let carrier = clip.facts.carrier.value;
    let free = |joint: crate::skeleton::JointId| {
        joint != carrier && clip.skeleton.is_within(joint, carrier) && clip.turns_freely(joint.idx())
    };
    !foot.plants.is_empty() && [hip, knee, ankle].into_iter().all(free)
}

impl LegFrame {
    /// Takes a leg out of a pose; the hinge is what the bend shows, of the length of its sine.
    fn new(skeleton: &Skeleton, leg: &Leg, world: &[Rigid], back: &Rigid) -> Self {
        let rotation = |joint: usize| back.rotation * world[joint].rotation;
        let parent = |joint: usize| rotation(skeleton.joints()[joint].parent.expect("below the carrier").idx());
        let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| back.point(world[joint.idx()].translation));
        let (thigh, shin) = (knee - hip, ankle - knee);
        let toe_world = match leg.toe.checked_sub(skeleton.n_joints()) {
            None => world[leg.toe].translation,
            Some(site) => {
                let joint = skeleton.end_sites()[site];
                world[joint.idx()].point(skeleton.joint(joint).end_site.expect("listed as one that has it"))
            }
        };
        Self {
            hip,
            thigh,
            shin,
            hinge: thigh.normalize_or_zero().cross(shin.normalize_or_zero()),
            reach: hip.distance(ankle),
            length: thigh.length() + shin.length(),
            hip_parent: parent(leg.hip.idx()),
            hip_rotation: rotation(leg.hip.idx()),
            knee_parent: parent(leg.knee.idx()),
            knee_rotation: rotation(leg.knee.idx()),
            ankle_parent: parent(leg.ankle.idx()),
            ankle_world: world[leg.ankle.idx()],
            toe_world,
        }
    }
}

/// Makes the hinges unit axes: what the bend shows where there is one, what is usual for the thigh where there is none.
fn set_hinges(frames: &mut [LegFrame]) {
    let sum: DVec3 = frames.iter().map(|f| f.hip_rotation.conjugate() * f.hinge).sum();
    // A leg that never bends may bend about anything that is across it.
    let across = |f: &LegFrame| f.hip_rotation.conjugate() * f.thigh.any_orthonormal_vector();
    let usual = sum.try_normalize().unwrap_or_else(|| across(&frames[0]));
    for frame in frames {
        let usual = frame.hip_rotation * usual;
        let shown = if frame.hinge.dot(usual) > 0.0 { frame.hinge } else { DVec3::ZERO };
        frame.hinge = (shown + USUAL_HINGE * usual).normalize();
    }
}

impl PreparedPlant {
    fn new(plant: Plant, frames: &[LegFrame]) -> Self {
        let stands = &frames[plant.first..=plant.last];
        let sum: DVec3 = stands.iter().map(|f| 0.5 * (f.ankle_world.translation + f.toe_world)).sum();
        let slide = if plant.mode == PlantMode::Clean { slide(stands) } else { Vec::new() };
        Self { plant, slide, foot: sum / stands.len() as f64 }
    }
}

/// Returns how far the contact point, ankle or toe, whichever moves less in each step, has slid; 0 in the mean.
fn slide(stands: &[LegFrame]) -> Vec<DVec3> {
    let flat = |v: DVec3| DVec3 { y: 0.0, ..v };
    let mut slid = vec![DVec3::ZERO];
    for pair in stands.windows(2) {
        let ankle = flat(pair[1].ankle_world.translation - pair[0].ankle_world.translation);
        let toe = flat(pair[1].toe_world - pair[0].toe_world);
        let step = if toe.length_squared() < ankle.length_squared() { toe } else { ankle };
        slid.push(slid[slid.len() - 1] + step);
    }
    let mean = slid.iter().sum::<DVec3>() / slid.len() as f64;
    slid.iter().map(|&s| s - mean).collect()
}
