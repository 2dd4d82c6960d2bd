//! `Prepared`: what holding needs of the source, once per clip and plants.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::feet::smootherstep;
use super::ground::GroundSlope;
use crate::{
    contact::{FootPlants, Plant, PlantMode},
    math::Rigid,
    motion::{Clip, EditedClip, Leg},
    skeleton::{JointId, Skeleton},
    sync::halves,
};

/// Weight of a leg's usual hinge against the one its bend shows, as the sine of a bend: a knee bent less than this
/// takes the usual one.
const USUAL_HINGE: f64 = 0.05;

/// Time before and after a clean plant over which the foot comes to rest and sets off, seconds.
const REST_SECS: f64 = 0.1;

/// A leg shorter than this share of the body height is none.
const SHORTEST_LEG: f64 = 1e-3;

/// A source clip with its legs and plants, ready to be held on any path.
#[derive(Clone, Debug)]
pub struct Prepared {
    pub(super) n_frames: usize,
    pub(super) frame_time_secs: f64,
    /// Body height `H`, clip's unit.
    pub(super) height: f64,
    /// What takes the carrier of each frame to the origin.
    pub(super) to_origin: Vec<Rigid>,
    pub(super) legs: Vec<PreparedLeg>,
    /// Of the ground in the source.
    pub(super) slope: GroundSlope,
}

/// One leg of the source.
#[derive(Clone, Debug)]
pub(super) struct PreparedLeg {
    pub(super) leg: Leg,
    pub(super) plants: Vec<PreparedPlant>,
    pub(super) frames: Vec<LegFrame>,
    /// As many.
    pub(super) poses: Vec<LegPose>,
}

/// A plant of the source.
#[derive(Clone, Debug)]
pub(super) struct PreparedPlant {
    pub(super) plant: Plant,
    /// Taken off the foot so that it stands still; nothing when its own slide is kept.
    slide: Slide,
    /// Mean place of the foot, world.
    pub(super) foot: DVec3,
    /// Mean way from ankle to toe, world.
    pub(super) along: DVec3,
}

/// Where one leg is at one frame. Positions in the carrier's space unless they say world.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegFrame {
    pub(super) hip: DVec3,
    /// Distance from hip to ankle.
    pub(super) reach: f64,
    /// Length of thigh and shin together.
    pub(super) length: f64,
    /// World, source.
    pub(super) ankle_world: Rigid,
    /// World, source.
    pub(super) toe_world: DVec3,
}

/// How one leg is bent at one frame; in the carrier's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegPose {
    /// From hip to knee.
    pub(super) thigh: DVec3,
    /// From knee to ankle.
    pub(super) shin: DVec3,
    /// Unit axis of the knee.
    pub(super) hinge: DVec3,
    /// Of the joint above the hip.
    pub(super) hip_parent: DQuat,
    /// Of the hip itself.
    pub(super) hip_rotation: DQuat,
    pub(super) knee_parent: DQuat,
    pub(super) knee_rotation: DQuat,
    pub(super) ankle_parent: DQuat,
}

impl Prepared {
    /// Prepares what is to be carried and held, at every frame of its clip; one pass over them.
    ///
    /// `feet` are the legs to hold with their plants. Legs without plants, legs whose joints do not hang below the
    /// carrier or cannot be turned, and legs without length are left out.
    ///
    /// `own_carrier` is where the carrier would be if layers did not move it, at every frame; empty if they do not. A
    /// carrier that layers move takes its feet along to where they stand, but does not let them slide.
    pub fn new(posed: &EditedClip, own_carrier: &[Rigid], feet: &[FootPlants]) -> Self {
        let clip = &*posed.clip;
        let n_frames = clip.n_frames();
        let height = clip.facts.height.value;
        let held: Vec<&FootPlants> = feet.iter().filter(|foot| can_be_held(clip, foot)).collect();
        let mut parts = halves(n_frames, 0, |range| legs_of(posed, &held, range)).into_iter();
        let (mut to_origin, first) = parts.next().expect("at least one part");
        let mut legs: Vec<PreparedLeg> = (held.iter().zip(first))
            .map(|(foot, (frames, poses))| PreparedLeg { leg: foot.leg, plants: Vec::new(), frames, poses })
            .collect();
        for (more, part) in parts {
            to_origin.extend(more);
            for (leg, (frames, poses)) in legs.iter_mut().zip(part) {
                leg.frames.extend(frames);
                leg.poses.extend(poses);
            }
        }
        let moved_back: Vec<Rigid> = own_carrier.iter().zip(&to_origin).map(|(&own, &back)| own * back).collect();
        for (leg, foot) in legs.iter_mut().zip(held) {
            set_hinges(&mut leg.poses);
            leg.plants = (foot.plants.iter())
                .filter(|plant| plant.first < n_frames)
                .map(|&plant| Plant { last: plant.last.min(n_frames - 1), ..plant })
                .map(|plant| PreparedPlant::new(plant, &leg.frames, clip.frame_time_secs, &moved_back))
                .collect();
        }
        legs.retain(|leg| !leg.plants.is_empty() && leg.frames.iter().all(|f| f.length > SHORTEST_LEG * height));
        let feet: Vec<DVec3> = legs.iter().flat_map(|leg| &leg.plants).map(|plant| plant.foot).collect();
        let slope = GroundSlope::under(&feet, height);
        Self { n_frames, frame_time_secs: clip.frame_time_secs, height, to_origin, legs, slope }
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

impl LegFrame {
    /// Returns the same elsewhere in the world.
    fn moved(&self, by: &Rigid) -> Self {
        Self { ankle_world: *by * self.ankle_world, toe_world: by.point(self.toe_world), ..*self }
    }
}

impl PreparedLeg {
    /// Tells whether the foot slides in its plants as it did.
    pub(super) fn keeps_its_slides(&self) -> bool {
        self.plants.iter().all(|plant| plant.slide.slid.is_empty())
    }
}

fn can_be_held(clip: &Clip, foot: &FootPlants) -> bool {
    let Leg { hip, knee, ankle, .. } = foot.leg;
    let carrier = clip.facts.carrier.value;
    let free =
        |joint: JointId| joint != carrier && clip.skeleton.is_within(joint, carrier) && clip.turns_freely(joint.idx());
    !foot.plants.is_empty() && [hip, knee, ankle].into_iter().all(free)
}

/// Returns what takes the carrier to the origin, and the legs, at some frames.
#[expect(clippy::type_complexity, reason = "two lists for each leg, taken apart at once")]
fn legs_of(
    posed: &EditedClip,
    feet: &[&FootPlants],
    range: Range<usize>,
) -> (Vec<Rigid>, Vec<(Vec<LegFrame>, Vec<LegPose>)>) {
    let skeleton = &posed.clip.skeleton;
    let carrier = posed.clip.facts.carrier.value;
    let ends = feet.iter().flat_map(|foot| [foot.leg.ankle, toe_joint(skeleton, &foot.leg)]).chain([carrier]);
    let ends: Vec<JointId> = ends.collect();
    let needed: Vec<JointId> =
        skeleton.ids().filter(|&id| ends.iter().any(|&end| skeleton.is_within(end, id))).collect();
    // The first part takes the others up.
    let room = if range.start == 0 { posed.n_frames() } else { range.len() };
    let mut to_origin = Vec::with_capacity(room);
    let mut legs: Vec<_> = feet.iter().map(|_| (Vec::with_capacity(room), Vec::with_capacity(room))).collect();
    let mut rigids = vec![Rigid::IDENTITY; skeleton.n_joints()];
    for frame in range {
        posed.some_world_rigids(frame, &needed, &mut rigids);
        let back = rigids[carrier.idx()].inverse();
        to_origin.push(back);
        for ((frames, poses), foot) in legs.iter_mut().zip(feet) {
            let (frame, pose) = taken(skeleton, &foot.leg, &rigids, &back);
            frames.push(frame);
            poses.push(pose);
        }
    }
    (to_origin, legs)
}

/// Returns the joint that a leg's toe is, or whose end site it is.
fn toe_joint(skeleton: &Skeleton, leg: &Leg) -> JointId {
    match leg.toe.checked_sub(skeleton.n_joints()) {
        None => JointId(leg.toe as u32),
        Some(site) => skeleton.end_sites()[site],
    }
}

/// Takes a leg out of a pose; the hinge is what the bend shows, of the length of its sine.
fn taken(skeleton: &Skeleton, leg: &Leg, world: &[Rigid], back: &Rigid) -> (LegFrame, LegPose) {
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
    let frame = LegFrame {
        hip,
        reach: hip.distance(ankle),
        length: thigh.length() + shin.length(),
        ankle_world: world[leg.ankle.idx()],
        toe_world,
    };
    let pose = LegPose {
        thigh,
        shin,
        hinge: thigh.normalize_or_zero().cross(shin.normalize_or_zero()),
        hip_parent: parent(leg.hip.idx()),
        hip_rotation: rotation(leg.hip.idx()),
        knee_parent: parent(leg.knee.idx()),
        knee_rotation: rotation(leg.knee.idx()),
        ankle_parent: parent(leg.ankle.idx()),
    };
    (frame, pose)
}

/// Makes the hinges unit axes: what the bend shows where there is one, what is usual for the thigh where there is none.
fn set_hinges(poses: &mut [LegPose]) {
    let sum: DVec3 = poses.iter().map(|p| p.hip_rotation.conjugate() * p.hinge).sum();
    // A leg that never bends may bend about anything that is across it.
    let across = |p: &LegPose| p.hip_rotation.conjugate() * p.thigh.any_orthonormal_vector();
    let usual = sum.try_normalize().unwrap_or_else(|| across(&poses[0]));
    for pose in poses {
        let usual = pose.hip_rotation * usual;
        let shown = if pose.hinge.dot(usual) > 0.0 { pose.hinge } else { DVec3::ZERO };
        pose.hinge = (shown + USUAL_HINGE * usual).normalize();
    }
}

impl LegFrame {
    /// Returns the middle between ankle and toe, world.
    pub(super) fn foot(&self) -> DVec3 {
        0.5 * (self.ankle_world.translation + self.toe_world)
    }
}

impl PreparedPlant {
    /// `moved_back` takes each frame to where the carrier's own motion has it; empty when it is there.
    fn new(plant: Plant, frames: &[LegFrame], frame_time_secs: f64, moved_back: &[Rigid]) -> Self {
        let stands = &frames[plant.first..=plant.last];
        let sum: DVec3 = stands.iter().map(LegFrame::foot).sum();
        let along: DVec3 = stands.iter().map(|f| f.toe_world - f.ankle_world.translation).sum();
        let slide = match plant.mode {
            PlantMode::Clean => {
                let own = |from: usize, to: usize| {
                    let by_toe = is_by_toe(&frames[from], &frames[to]);
                    point_step(&frames[from], &frames[to], by_toe)
                };
                Slide::new(&plant, frames.len(), frame_time_secs, own)
            }
            PlantMode::Hold if !moved_back.is_empty() => {
                // What the carrier's own motion made of the same step is the foot's own slide.
                let added = |from: usize, to: usize| {
                    let own = [from, to].map(|frame| frames[frame].moved(&moved_back[frame]));
                    let by_toe = is_by_toe(&own[0], &own[1]);
                    point_step(&frames[from], &frames[to], by_toe) - point_step(&own[0], &own[1], by_toe)
                };
                Slide::new(&plant, frames.len(), frame_time_secs, added)
            }
            PlantMode::Hold | PlantMode::Slide => Slide::default(),
        };
        let n = stands.len() as f64;
        Self { plant, slide, foot: sum / n, along: along / n }
    }

    /// Returns how far the foot has slid at a frame, also outside the plant; 0 when its own slide is kept.
    pub(super) fn slid(&self, frame: usize) -> DVec3 {
        let Slide { first, slid } = &self.slide;
        slid.get(frame.saturating_sub(*first)).or(slid.last()).copied().unwrap_or(DVec3::ZERO)
    }
}

/// How far the contact point, ankle or toe, whichever moves less in each step, has slid: world, horizontal, 0 in the
/// mean over the plant.
///
/// It goes on for a moment before and after the plant, ever less of it, so that the foot comes to rest and sets off
/// smoothly.
#[derive(Clone, Debug, Default)]
struct Slide {
    /// Frame of the first value; before it that one holds, after the last one the last.
    first: usize,
    slid: Vec<DVec3>,
}

impl Slide {
    /// Adds up the steps of a plant; `step` is how far the foot slides from one frame to the next.
    fn new(plant: &Plant, n_frames: usize, frame_time_secs: f64, step: impl Fn(usize, usize) -> DVec3) -> Self {
        let rest = (REST_SECS / frame_time_secs).ceil().max(1.0);
        let first = plant.first.saturating_sub(rest as usize);
        let last = (plant.last + rest as usize).min(n_frames - 1);
        let mut slid = vec![DVec3::ZERO];
        for to in first + 1..=last {
            // Outside the plant, what its first or last step was.
            let like = if plant.first < plant.last { to.clamp(plant.first + 1, plant.last) } else { to };
            let share = 1.0 - smootherstep(to.abs_diff(like) as f64 / rest);
            slid.push(slid[slid.len() - 1] + share * step(like - 1, like));
        }
        let stands = &slid[plant.first - first..=plant.last - first];
        let mean = stands.iter().sum::<DVec3>() / stands.len() as f64;
        slid.iter_mut().for_each(|s| *s -= mean);
        Self { first, slid }
    }
}

/// Tells whether the foot stands on its toe from one frame to another: that moves less than the ankle.
fn is_by_toe(from: &LegFrame, to: &LegFrame) -> bool {
    point_step(from, to, true).length_squared() < point_step(from, to, false).length_squared()
}

/// Returns the horizontal step of the toe or of the ankle.
fn point_step(from: &LegFrame, to: &LegFrame, of_toe: bool) -> DVec3 {
    let step = match of_toe {
        true => to.toe_world - from.toe_world,
        false => to.ankle_world.translation - from.ankle_world.translation,
    };
    step.with_y(0.0)
}
