//! `Prepared`: what holding needs of the source, once per clip and plants.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use wide::f64x4;

use super::{
    cost::bend,
    passage::along_ground,
    slide::{Contact, Slide},
};
use crate::{
    contact::{FootPlants, GroundSlope, Plant, PlantMode},
    math::{
        Hinged, Limbs, Rigid,
        lanes::{LANES, QuatLanes, RigidLanes, VecLanes, by_lane, four},
        straight_hinge,
    },
    motion::{Clip, EditedClip, Leg, Side},
    skeleton::{JointId, Skeleton},
    sync::{each, halves, listed},
};

/// Weight of a leg's usual hinge against the one its bend shows, as the sine of a bend: a knee bent less than this
/// takes the usual one.
const USUAL_HINGE: f64 = 0.05;

/// A clip whose knee never bends by more than this sine shows no hinge: what a straight leg has of one is rounding, or
/// how its offsets happen to lie.
const SHOWN_HINGE: f64 = 0.1;

/// A leg shorter than this share of the body height is none.
const SHORTEST_LEG: f64 = 1e-3;

/// A leg that layers lengthen is to be no longer than this share of its length, unless it is in the source.
const LONGEST: f64 = 0.98;

/// A source clip with its legs and plants, ready to be held on any path.
#[derive(Clone, Debug)]
pub struct Prepared {
    posed: Arc<EditedClip>,
    pub(super) n_frames: usize,
    pub(super) frame_time_secs: f64,
    /// Body height `H`, clip's unit.
    pub(super) height: f64,
    /// What takes the carrier of each frame to the origin, where layers do not move but turn it.
    pub(super) to_origin: Vec<Rigid>,
    pub(super) legs: Vec<PreparedLeg>,
    /// Of the ground in the source.
    pub(super) slope: GroundSlope,
}

/// One leg of the source.
#[derive(Clone, Debug)]
pub(super) struct PreparedLeg {
    pub(super) leg: Leg,
    pub(super) shape: Arc<LegShape>,
    /// The shape's, but for how long the leg is to be: where layers move the carrier it is as long as from there to a
    /// foot that stands.
    pub(super) frames: Arc<Vec<LegFrame>>,
    /// Where its foot is where layers do not move but turn the carrier, as many frames.
    pub(super) feet: Vec<FootAt>,
    /// What it stands on in the step to each frame, as the clip has it without layers: where a step of ankle and toe is
    /// alike, a pose that is dragged would have it jump from one to the other.
    pub(super) contacts: Arc<Vec<Contact>>,
    pub(super) plants: Vec<PreparedPlant>,
}

/// A leg as the clip bends it, wherever the carrier is: in the carrier's space throughout.
#[derive(Debug)]
pub(super) struct LegShape {
    pub(super) frames: Arc<Vec<LegFrame>>,
    /// Where its foot is.
    feet: Vec<FootAt>,
    /// The whole leg, four frames by four.
    pub(super) poses: Vec<LegPoses>,
}

/// Where a foot of the source is at one frame: world, unless said otherwise.
#[derive(Clone, Copy, Debug)]
pub(super) struct FootAt {
    pub(super) ankle: Rigid,
    pub(super) toe: DVec3,
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

/// What holding asks of one leg at one frame, in the carrier's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegFrame {
    pub(super) hip: DVec3,
    /// Distance from hip to ankle.
    pub(super) reach: f64,
    /// How far the knee is bent by that.
    pub(super) bend: f64,
    /// Length of thigh and shin together.
    pub(super) length: f64,
}

/// How one leg is bent at four frames, the last ones of a clip repeated; in the carrier's space.
#[derive(Clone, Copy, Debug)]
pub(super) struct LegPoses {
    pub(super) limbs: Limbs,
    pub(super) hip: VecLanes,
    /// Rotation of the joint above the hip.
    pub(super) hip_parent: QuatLanes,
    /// Of the hip itself.
    pub(super) hip_rotation: QuatLanes,
    /// Local rotation of the knee.
    pub(super) knee: Hinged,
    /// Rotation of the joint above the ankle.
    pub(super) ankle_parent: Hinged,
    /// From ankle to toe, in the ankle's own space.
    pub(super) toe: VecLanes,
}

/// The same with all rotations in the carrier's space, before it is known what the knee's hinge is.
#[derive(Clone, Copy)]
struct LegBones {
    thigh: VecLanes,
    shin: VecLanes,
    /// What the bend shows of it, of the length of its sine.
    hinge: VecLanes,
    hip: VecLanes,
    hip_parent: QuatLanes,
    hip_rotation: QuatLanes,
    knee_parent: QuatLanes,
    knee_rotation: QuatLanes,
    ankle_parent: QuatLanes,
    toe: VecLanes,
}

impl Prepared {
    /// Prepares what is to be carried and held, at every frame of its clip; one pass over them.
    ///
    /// `feet` are the legs to hold with their plants. Legs without plants, legs whose joints do not hang below the
    /// carrier or cannot be turned, and legs without length are left out.
    ///
    /// `own_carrier` is where the carrier would be if layers neither moved nor turned it, at every frame; empty if they
    /// do not. A carrier that layers move takes its feet along the ground to where they stand and one that they turn
    /// takes them with it, but neither lets them slide.
    ///
    /// `earlier` lends the legs that are bent as they were; the result is the same without it.
    pub fn new(posed: &Arc<EditedClip>, own_carrier: &[Rigid], feet: &[FootPlants], earlier: Option<&Self>) -> Self {
        let clip = &*posed.clip;
        let n_frames = clip.n_frames();
        let height = clip.facts.height.value;
        let held: Vec<&FootPlants> = feet.iter().filter(|foot| can_be_held(clip, foot)).collect();
        let to_origin = listed(n_frames, |frames| frames.map(|frame| turned(posed, own_carrier, frame).inverse()));
        let mut legs = each(&held, n_frames, |_, foot| {
            let known = earlier.filter(|earlier| Arc::ptr_eq(&earlier.posed.clip, &posed.clip));
            let shape = known.and_then(|known| known.shape_of(&foot.leg, posed));
            let shape = shape.unwrap_or_else(|| Arc::new(LegShape::of(posed, &foot.leg)));
            let contacts = known.and_then(|known| Some(Arc::clone(&known.leg(&foot.leg)?.contacts)));
            let contacts = contacts.unwrap_or_else(|| Arc::new(contacts_of(posed, &foot.leg, &shape)));
            PreparedLeg::new(foot, shape, contacts, posed, own_carrier)
        });
        legs.retain(|leg| !leg.plants.is_empty() && leg.shape.frames.iter().all(|f| f.length > SHORTEST_LEG * height));
        let feet: Vec<DVec3> = legs.iter().flat_map(|leg| &leg.plants).map(|plant| plant.foot).collect();
        let slope = GroundSlope::under(&feet, height);
        let frame_time_secs = clip.frame_time_secs;
        Self { posed: Arc::clone(posed), n_frames, frame_time_secs, height, to_origin, legs, slope }
    }

    fn leg(&self, leg: &Leg) -> Option<&PreparedLeg> {
        self.legs.iter().find(|known| known.leg == *leg)
    }

    /// Returns a leg's shape if another edit of the clip bends the leg as this one does.
    fn shape_of(&self, leg: &Leg, posed: &EditedClip) -> Option<Arc<LegShape>> {
        let known = self.leg(leg)?;
        let joints = joints_of(&posed.clip.skeleton, leg, posed.clip.facts.carrier.value);
        let is_same = |&joint: &JointId| self.posed.turned(joint) == posed.turned(joint);
        joints.iter().all(is_same).then(|| Arc::clone(&known.shape))
    }

    /// Returns how the ground slopes that the clip was walked on.
    pub fn ground(&self) -> GroundSlope {
        self.slope
    }

    /// Takes the ground to slope like this, and not as the feet stand: a pose that lifts a foot tilts no ground.
    #[must_use]
    pub fn on_ground(self, slope: GroundSlope) -> Self {
        Self { slope, ..self }
    }

    /// Returns the number of frames of the clip.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Returns the length of thigh and shin together, the clip's unit; of the first leg at the first frame.
    pub fn leg_length(&self) -> Option<f64> {
        self.legs.first().and_then(|leg| leg.shape.frames.first()).map(|frame| frame.length)
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

impl PreparedLeg {
    fn new(
        foot: &FootPlants,
        shape: Arc<LegShape>,
        contacts: Arc<Vec<Contact>>,
        posed: &EditedClip,
        own_carrier: &[Rigid],
    ) -> Self {
        let clip = &*posed.clip;
        let n_frames = shape.frames.len();
        let stands = |(f, foot): (usize, &FootAt)| foot.moved(&turned(posed, own_carrier, f));
        let feet: Vec<FootAt> = shape.feet.iter().enumerate().map(stands).collect();
        let is_turned = (0..).zip(own_carrier).any(|(f, own)| posed.carrier(f).rotation != own.rotation);
        let unturned = if is_turned { own_carrier } else { &[] };
        let own_feet: Vec<FootAt> = shape.feet.iter().zip(unturned).map(|(foot, own)| foot.moved(own)).collect();
        let frames = if own_carrier.is_empty() {
            Arc::clone(&shape.frames)
        } else {
            let moved = |(f, leg): (usize, &LegFrame)| {
                let carrier = posed.carrier(f);
                let stands = feet[f].ankle.translation + along_ground(&own_carrier[f], &carrier);
                leg.as_long_as(carrier.point(leg.hip).distance(stands))
            };
            Arc::new(shape.frames.iter().enumerate().map(moved).collect())
        };
        let plants = (foot.plants.iter())
            .filter(|plant| plant.first < n_frames)
            .map(|&plant| Plant { last: plant.last.min(n_frames - 1), ..plant })
            .map(|plant| PreparedPlant::new(plant, &feet, &contacts, clip.frame_time_secs, &own_feet))
            .collect();
        Self { leg: foot.leg, shape, frames, feet, contacts, plants }
    }

    /// Tells whether the foot slides in its plants as it did.
    pub(super) fn keeps_its_slides(&self) -> bool {
        self.plants.iter().all(|plant| plant.slide.is_none())
    }
}

impl LegShape {
    /// Takes a leg out of an edit of its clip.
    fn of(posed: &EditedClip, leg: &Leg) -> Self {
        let skeleton = &posed.clip.skeleton;
        let joints = joints_of(skeleton, leg, posed.clip.facts.carrier.value);
        let n_frames = posed.n_frames();
        let parts = halves(n_frames, 0, |range| {
            // The first part takes the other up.
            let room = if range.start == 0 { n_frames } else { range.len() };
            let groups = room.div_ceil(LANES);
            let mut part = (Vec::with_capacity(room), Vec::with_capacity(room), Vec::with_capacity(groups));
            let mut rigids = vec![RigidLanes::identity(); skeleton.n_joints()];
            for at in range.clone().step_by(LANES) {
                posed.rigids_in_carrier(by_lane(|lane| (at + lane).min(n_frames - 1)), &joints, &mut rigids);
                let (frames, feet, poses) = taken(skeleton, leg, &rigids);
                let n = LANES.min(range.end - at);
                part.0.extend(&frames[..n]);
                part.1.extend(&feet[..n]);
                part.2.push(poses);
            }
            part
        });
        let mut parts = parts.into_iter();
        let (mut frames, mut feet, mut poses) = parts.next().expect("at least one part");
        for (more_frames, more_feet, more_poses) in parts {
            frames.extend(more_frames);
            feet.extend(more_feet);
            poses.extend(more_poses);
        }
        let usual = usual_hinge(&poses, &feet, leg.side);
        let poses = poses.iter().map(|bones: &LegBones| bones.hinged(usual)).collect();
        Self { frames: Arc::new(frames), feet, poses }
    }
}

impl LegFrame {
    /// Returns the same with the leg to be as long as this, or as nearly so as one leaves a knee its bend.
    fn as_long_as(&self, reach: f64) -> Self {
        let reach = reach.min(self.reach.max(LONGEST * self.length));
        Self { reach, bend: bend(reach, self.length), ..*self }
    }
}

/// Returns what a leg stands on in the step to each frame of its clip without layers; `shape` is that of the leg as they
/// have it.
fn contacts_of(posed: &EditedClip, leg: &Leg, shape: &LegShape) -> Vec<Contact> {
    let plain = EditedClip::unedited(Arc::clone(&posed.clip));
    let turned = joints_of(&posed.clip.skeleton, leg, posed.clip.facts.carrier.value);
    let is_plain = turned.iter().all(|&joint| posed.turned(joint).is_none());
    let own = if is_plain { None } else { Some(LegShape::of(&plain, leg)) };
    let feet = own.as_ref().map_or(&shape.feet, |own| &own.feet).iter().enumerate();
    let feet: Vec<FootAt> = feet.map(|(f, foot)| foot.moved(&plain.carrier(f))).collect();
    let steps = feet.windows(2).map(|step| Contact::of(&step[0], &step[1]));
    std::iter::once(Contact::Ankle).chain(steps).collect()
}

/// Returns where the carrier of a frame would be if layers did not move but turn it.
fn turned(posed: &EditedClip, own_carrier: &[Rigid], frame: usize) -> Rigid {
    let carrier = posed.carrier(frame);
    own_carrier.get(frame).map_or(carrier, |own| Rigid { translation: own.translation, ..carrier })
}

fn can_be_held(clip: &Clip, foot: &FootPlants) -> bool {
    let Leg { hip, knee, ankle, .. } = foot.leg;
    let carrier = clip.facts.carrier.value;
    let free =
        |joint: JointId| joint != carrier && clip.skeleton.is_within(joint, carrier) && clip.turns_freely(joint.idx());
    !foot.plants.is_empty() && [hip, knee, ankle].into_iter().all(free)
}

/// Returns the joints below the carrier that a leg's foot hangs on or is, parents first.
fn joints_of(skeleton: &Skeleton, leg: &Leg, carrier: JointId) -> Vec<JointId> {
    let ends = [leg.ankle, skeleton.joint_of_point(leg.toe)];
    let is_needed = |&id: &JointId| {
        id != carrier && skeleton.is_within(id, carrier) && ends.iter().any(|&end| skeleton.is_within(end, id))
    };
    skeleton.ids().filter(is_needed).collect()
}

/// Takes a leg out of four poses in the carrier's space.
fn taken(skeleton: &Skeleton, leg: &Leg, rigids: &[RigidLanes]) -> ([LegFrame; LANES], [FootAt; LANES], LegBones) {
    let rotation = |joint: usize| rigids[joint].rotation;
    let parent = |joint: usize| rotation(skeleton.joints()[joint].parent.expect("below the carrier").idx());
    let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|joint| rigids[joint.idx()].translation);
    let (thigh, shin) = (knee.minus(hip), ankle.minus(knee));
    let ankle_rotation = rotation(leg.ankle.idx());
    let toe = match leg.toe.checked_sub(skeleton.n_joints()) {
        None => rigids[leg.toe].translation,
        Some(site) => {
            let joint = skeleton.end_sites()[site];
            let offset = skeleton.joint(joint).end_site.expect("listed as one that has it");
            rigids[joint.idx()].point(VecLanes::splat(offset))
        }
    };
    let reach = hip.minus(ankle).length().to_array();
    let length = (thigh.length() + shin.length()).to_array();
    let (hips, ankles, toes, ankle_rotations) = (hip.lanes(), ankle.lanes(), toe.lanes(), ankle_rotation.lanes());
    let frames = by_lane(|lane| LegFrame {
        hip: hips[lane],
        reach: reach[lane],
        bend: bend(reach[lane], length[lane]),
        length: length[lane],
    });
    let feet = by_lane(|lane| FootAt { ankle: Rigid::new(ankle_rotations[lane], ankles[lane]), toe: toes[lane] });
    let bones = LegBones {
        thigh,
        shin,
        hinge: thigh.normalized().cross(shin.normalized()),
        hip,
        hip_parent: parent(leg.hip.idx()),
        hip_rotation: rotation(leg.hip.idx()),
        knee_parent: parent(leg.knee.idx()),
        knee_rotation: rotation(leg.knee.idx()),
        ankle_parent: parent(leg.ankle.idx()),
        toe: ankle_rotation.conjugate().rotate(toe.minus(ankle)),
    };
    (frames, feet, bones)
}

/// Returns the hinge, in the thigh's own space, that a clip's frames usually have: of a leg that shows none, by where its
/// foot points in the mean.
fn usual_hinge(poses: &[LegBones], feet: &[FootAt], side: Side) -> DVec3 {
    let shown = poses.iter().flat_map(|bones| bones.in_thigh(bones.hinge)).take(feet.len());
    let (mut sum, mut most) = (DVec3::ZERO, 0.0f64);
    for hinge in shown {
        sum += hinge;
        most = most.max(hinge.length());
    }
    let is_shown = most > SHOWN_HINGE && sum.length() > SHOWN_HINGE;
    if is_shown { sum.normalize() } else { hinge_of_straight(poses, feet, side) }
}

/// Returns the hinge, in the thigh's own space, of a leg that shows none: by where its foot points in the mean.
fn hinge_of_straight(poses: &[LegBones], feet: &[FootAt], side: Side) -> DVec3 {
    let (mut thigh, mut foot, mut outwards) = (DVec3::ZERO, DVec3::ZERO, DVec3::ZERO);
    for (n, bones) in poses.iter().enumerate() {
        let feet = four(feet, n * LANES);
        let feet = VecLanes::gather(|lane| feet[lane].toe - feet[lane].ankle.translation);
        for (sum, way) in [(&mut thigh, bones.thigh), (&mut foot, feet), (&mut outwards, bones.hip)] {
            *sum += bones.in_thigh(way).iter().sum::<DVec3>();
        }
    }
    // The hips lie on either side of the carrier.
    let left = if side == Side::Left { outwards } else { -outwards };
    straight_hinge(thigh, foot, left)
}

impl LegBones {
    /// Takes vectors from the carrier's space to the thigh's own.
    fn in_thigh(&self, vectors: VecLanes) -> [DVec3; LANES] {
        self.hip_rotation.conjugate().rotate(vectors).lanes()
    }

    /// Returns the poses with a unit axis for a hinge: what the bend shows where there is one, what is usual, in the
    /// thigh's own space, where there is none.
    fn hinged(&self, usual: DVec3) -> LegPoses {
        let usual = self.hip_rotation.rotate(VecLanes::splat(usual));
        let is_shown = self.hinge.dot(usual).simd_gt(f64x4::ZERO);
        let shown = self.hinge.scaled(is_shown.bitselect(f64x4::ONE, f64x4::ZERO));
        let hinge = shown.plus(usual.scaled(f64x4::splat(USUAL_HINGE))).normalized();
        LegPoses {
            limbs: Limbs::new(self.thigh, self.shin, hinge),
            hip: self.hip,
            hip_parent: self.hip_parent,
            hip_rotation: self.hip_rotation,
            knee: Hinged::new(self.knee_parent.conjugate(), hinge, self.knee_rotation),
            ankle_parent: Hinged::new(QuatLanes::splat(DQuat::IDENTITY), hinge, self.ankle_parent),
            toe: self.toe,
        }
    }
}

impl FootAt {
    /// Returns where a motion takes it.
    fn moved(&self, by: &Rigid) -> Self {
        Self { ankle: *by * self.ankle, toe: by.point(self.toe) }
    }

    /// Returns the middle between ankle and toe.
    pub(super) fn middle(&self) -> DVec3 {
        0.5 * (self.ankle.translation + self.toe)
    }
}

impl PreparedPlant {
    /// `own_feet` is where the carrier has the foot that layers do not turn; empty if they do not.
    fn new(plant: Plant, feet: &[FootAt], contacts: &[Contact], frame_time_secs: f64, own_feet: &[FootAt]) -> Self {
        let stands = &feet[plant.first..=plant.last];
        let sum: DVec3 = stands.iter().map(FootAt::middle).sum();
        let along: DVec3 = stands.iter().map(|at| at.toe - at.ankle.translation).sum();
        let own = |from: usize, to: usize| contacts[to].step(&feet[from], &feet[to]);
        let slide = match plant.mode {
            PlantMode::Clean => Slide::new(&plant, feet.len(), frame_time_secs, own),
            PlantMode::Hold if !own_feet.is_empty() => {
                // What the carrier that is not turned makes of the same step is the foot's own slide.
                let kept = |from: usize, to: usize| contacts[to].step(&own_feet[from], &own_feet[to]);
                Slide::new(&plant, feet.len(), frame_time_secs, |from, to| own(from, to) - kept(from, to))
            }
            PlantMode::Hold | PlantMode::Slide => Slide::default(),
        };
        let n = stands.len() as f64;
        Self { plant, slide, foot: sum / n, along: along / n }
    }

    /// Returns how far the foot has slid at a frame, also outside the plant; 0 when its own slide is kept.
    pub(super) fn slid(&self, frame: usize) -> DVec3 {
        self.slide.at(frame)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bvh::Bvh,
        motion::{ClipOptions, find_legs, gait},
    };

    /// Returns the built-in clip, or its skeleton alone with no joint turned: its knees are dead straight.
    fn posed(straight: bool) -> EditedClip {
        let (text, _) = gait::built_in();
        let (head, _) = text.split_once("MOTION").expect("a motion section");
        let row = format!("0 97 0{}", " 0".repeat(63));
        let still = format!("{head}MOTION\nFrames: 2\nFrame Time: 0.02\n{row}\n{row}\n");
        let bvh = Bvh::parse(if straight { still } else { text }.into_bytes(), "made").expect("a valid file");
        EditedClip::unedited(Arc::new(Clip::from_bvh(&bvh, &ClipOptions::default())))
    }

    fn legs(posed: &EditedClip) -> Vec<Leg> {
        find_legs(&posed.clip, &[], &mut Vec::new()).value
    }

    /// Returns a leg's hinges in the thigh's own space, frame by frame.
    fn hinges(posed: &EditedClip, leg: &Leg) -> Vec<DVec3> {
        let shape = LegShape::of(posed, leg);
        let in_thigh = |pose: &LegPoses| pose.hip_rotation.conjugate().rotate(pose.ankle_parent.hinge()).lanes();
        shape.poses.iter().flat_map(in_thigh).collect()
    }

    #[test]
    fn a_straight_knee_bends_forward_as_in_a_walk() {
        let (still, walk) = (posed(true), posed(false));
        for leg in legs(&still) {
            let hinges = hinges(&still, &leg);
            assert!(hinges.iter().all(|hinge| hinge.abs_diff_eq(DVec3::X, 0.2) && hinge.y.abs() < 1e-12), "{hinges:?}");
            let walked: DVec3 = self::hinges(&walk, &leg).iter().sum();
            let angle = walked.angle_between(hinges[0]).to_degrees();
            assert!(angle < 12.0, "{:?}: the walk's own hinge is {angle}° off", leg.side);
        }
    }

    #[test]
    fn a_foot_that_points_along_the_leg_leaves_the_hinge_to_the_side_of_the_body() {
        let still = posed(true);
        for leg in legs(&still) {
            // Without a toe.
            let leg = Leg { toe: leg.ankle.idx(), ..leg };
            let hinges = hinges(&still, &leg);
            assert!(hinges.iter().all(|hinge| hinge.abs_diff_eq(DVec3::X, 1e-9)), "{:?}: {hinges:?}", leg.side);
        }
    }
}
