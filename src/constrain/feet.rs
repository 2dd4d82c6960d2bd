//! Where a foot should be: one rigid motion per plant, blended over the swings between them (METHOD 6, steps 2 to 4).
//!
//! In a swing the foot lets go of one plant's motion, follows the body for a while and takes up the next one's: the
//! shares of the two motions fall and rise smoothly, what is left of them is the body's own.

use glam::{DMat3, DQuat, DVec2, DVec3, DVec4};

use super::{
    Ground, Job,
    give::Passing,
    passage::Passage,
    prepared::{PreparedLeg, PreparedPlant},
    slide::Slide,
};
use crate::{
    contact::{GroundSlope, PlantMode, ground_share},
    math::{Rigid, heading_rotation, smootherstep},
};

/// Longest time over which a foot lets go of a plant's motion or takes it up, seconds.
const LONGEST_FADE_SECS: f64 = 0.5;

/// Between two plants further apart than this the foot has time to follow the body's height too, seconds.
const LONGEST_SWING_SECS: f64 = 1.5;

/// Share of a swing over which it does.
const FADE_SHARE: f64 = 0.7;

/// Plants of a foot with shorter gaps between them have one motion: the foot hardly leaves the ground, seconds.
const SHORTEST_SWING_SECS: f64 = 0.2;

/// As long as all of them together are no longer than this, seconds.
const LONGEST_GROUP_SECS: f64 = 2.5;

/// A foot's plan.
pub(super) struct FootPlan {
    /// Where the foot should be at each frame.
    pub(super) feet: Vec<Planned>,
    /// Motion of each plant that is held, by its index in the leg's list.
    pub(super) motions: Vec<(u32, Rigid)>,
}

/// Where a foot should be at one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Planned {
    /// The ankle, world, where the carrier has no offset.
    pub(super) ankle: Rigid,
    /// Share of the carrier's offset that the ankle takes part in, by axis: 0 in a plant.
    pub(super) follows: DVec3,
    /// Index of the plant, in the leg's list, that holds the foot.
    pub(super) plant: Option<u32>,
}

/// A plant at whose ends something else begins.
struct Stand<'a> {
    idx: u32,
    plant: &'a PreparedPlant,
    /// None for an intended slide, which is the body's own.
    motion: Option<Motion>,
    /// What tilting the foot with a slope makes of its roll: that is no slide of the performer's. World.
    tilted: Slide,
}

/// The motion of a plant.
#[derive(Clone, Copy)]
struct Motion {
    rigid: Rigid,
    /// Its rotation.
    turn: DMat3,
    /// The same without a tilt.
    upright: DQuat,
}

/// How fast a plant's motion comes and goes, along and up: what a frame is of the whole.
#[derive(Clone, Copy)]
struct Fade([f64; 2]);

/// Times as numbers of frames; and that of one, seconds.
struct Times {
    frame_secs: f64,
    longest_fade: f64,
    longest_swing: f64,
    shortest_swing: usize,
    longest_group: usize,
}

impl Times {
    fn new(frame_time_secs: f64) -> Self {
        let frames_in = |secs: f64| (secs / frame_time_secs).ceil().max(1.0);
        Self {
            frame_secs: frame_time_secs,
            longest_fade: frames_in(LONGEST_FADE_SECS),
            longest_swing: frames_in(LONGEST_SWING_SECS),
            shortest_swing: frames_in(SHORTEST_SWING_SECS) as usize,
            longest_group: frames_in(LONGEST_GROUP_SECS) as usize,
        }
    }

    /// Returns how a plant's motion fades in a swing of this many frames; none for one that only begins or ends.
    fn fade(&self, swing: Option<usize>) -> Fade {
        let fades = match swing.map(|swing| swing as f64) {
            Some(swing) if swing < self.shortest_swing as f64 => [swing; 2],
            Some(swing) if swing < self.longest_swing => [(FADE_SHARE * swing).min(self.longest_fade), swing],
            _ => [self.longest_fade; 2],
        };
        Fade(fades.map(f64::recip))
    }
}

impl Fade {
    /// Returns the shares of a plant's motion this many frames from its end.
    fn shares(self, distance: usize) -> [f64; 2] {
        self.0.map(|per_frame| 1.0 - smootherstep(distance as f64 * per_frame))
    }
}

/// Plans a foot. `source` is the slope of the ground in the source, `passage` is of the frames to be planned.
pub(super) fn plan(
    leg: &PreparedLeg,
    job: &Job,
    source: GroundSlope,
    passage: &Passage,
    frame_time_secs: f64,
) -> FootPlan {
    let body = &passage.body[..];
    let n = body.len();
    let times = Times::new(frame_time_secs);
    let stands = stands(leg, job, source, passage, &times);
    let mut feet = Vec::with_capacity(n);
    let mut before: Option<&Stand> = None;
    for after in stands.iter().map(Some).chain([None]) {
        let end = after.map_or(n, |s| s.plant.plant.first);
        let swing = before.zip(after).map(|(b, a)| a.plant.plant.first.saturating_sub(b.plant.plant.last));
        let fade = times.fade(swing);
        let begin = feet.len();
        for (f, passage) in (begin..end).zip(&body[begin..]) {
            let from = before.map(|b| (b, fade.shares(f - b.plant.plant.last)));
            let to = after.map(|a| (a, fade.shares(a.plant.plant.first - f)));
            feet.push(between(from, to, &leg.feet[f].ankle, passage, f));
        }
        let Some(stand) = after else { break };
        let begin = feet.len();
        for (f, passage) in (begin..=stand.plant.plant.last).zip(&body[begin..]) {
            let ankle = &leg.feet[f].ankle;
            feet.push(match stand.moved(ankle, f) {
                Some(ankle) => Planned { ankle, follows: DVec3::ZERO, plant: Some(stand.idx) },
                None => Planned { ankle: *passage * *ankle, follows: DVec3::ONE, plant: None },
            });
        }
        before = after;
    }
    FootPlan { feet, motions: stands.iter().filter_map(|s| Some((s.idx, s.motion?.rigid))).collect() }
}

/// Returns where a foot in swing should be: by two plants' motions with their shares, for the rest by the body's.
fn between(
    from: Option<(&Stand, [f64; 2])>,
    to: Option<(&Stand, [f64; 2])>,
    ankle: &Rigid,
    passage: &Rigid,
    frame: usize,
) -> Planned {
    let (mut rotation, mut translation) = (DVec4::ZERO, DVec3::ZERO);
    let mut follows = DVec3::ONE;
    for (stand, [along, up]) in [from, to].into_iter().flatten() {
        let Some(motion) = &stand.motion else { continue };
        if (along, up) == (0.0, 0.0) {
            continue;
        }
        let turn = motion.rigid.rotation;
        let alike = if passage.rotation.dot(turn) < 0.0 { -along } else { along };
        let shares = DVec3::new(along, up, along);
        rotation += alike * DVec4::from(turn);
        translation += shares * stand.place(motion, ankle, frame);
        follows -= shares;
    }
    let follows = follows.max(DVec3::ZERO);
    rotation += follows.x * DVec4::from(passage.rotation);
    translation += follows * passage.point(ankle.translation);
    let turn = DQuat::from_vec4(rotation.try_normalize().unwrap_or(DVec4::from(passage.rotation)));
    Planned { ankle: Rigid::new(turn * ankle.rotation, translation), follows, plant: None }
}

/// Lists the plants of a leg with their motions.
fn stands<'a>(
    leg: &'a PreparedLeg,
    job: &Job,
    source: GroundSlope,
    passage: &Passage,
    times: &Times,
) -> Vec<Stand<'a>> {
    let n_shown = leg.plants.partition_point(|p| p.plant.first < passage.body.len());
    let is_held = |p: &PreparedPlant| p.plant.mode != PlantMode::Slide;
    let together = |a: &PreparedPlant, b: &PreparedPlant| {
        is_held(a) && is_held(b) && b.plant.first.saturating_sub(a.plant.last) < times.shortest_swing
    };
    let mut stands = Vec::with_capacity(n_shown);
    while stands.len() < n_shown {
        let idx = stands.len();
        let first = leg.plants[idx].plant.first;
        let mut end = idx + 1;
        while end < n_shown
            && together(&leg.plants[end - 1], &leg.plants[end])
            && leg.plants[end].plant.last - first <= times.longest_group
        {
            end += 1;
        }
        let group = &leg.plants[idx..end];
        let motion = is_held(&group[0]).then(|| {
            let passing = Passing { leg, plants: group, carrier: job.carrier, frame_time_secs: times.frame_secs };
            motion_of(&passing, (job, source), passage)
        });
        stands.extend((idx as u32..).zip(group).map(|(idx, plant)| {
            let tilted = motion.map_or_else(Slide::default, |motion| motion.tilted(leg, plant, times.frame_secs));
            Stand { idx, plant, motion, tilted }
        }));
    }
    stands
}

impl Stand<'_> {
    /// Returns where the ankle of a frame is by this plant's motion, if it has one; also for frames outside it.
    fn moved(&self, ankle: &Rigid, frame: usize) -> Option<Rigid> {
        let motion = self.motion.as_ref()?;
        Some(Rigid::new(motion.rigid.rotation * ankle.rotation, self.place(motion, ankle, frame)))
    }

    /// Returns where a motion of this plant has the ankle of a frame.
    fn place(&self, motion: &Motion, ankle: &Rigid, frame: usize) -> DVec3 {
        motion.point(ankle.translation - self.plant.slid(frame)) - self.tilted.at(frame)
    }
}

impl Motion {
    /// Returns how far a plant slides because its foot is tilted.
    fn tilted(&self, leg: &PreparedLeg, plant: &PreparedPlant, frame_time_secs: f64) -> Slide {
        let rotation = self.rigid.rotation;
        if rotation == self.upright {
            return Slide::default();
        }
        let step = |from: usize, to: usize| {
            let (was, is) = (&leg.feet[from], &leg.feet[to]);
            let way = leg.contacts[to].way(was, is) - (plant.slid(to) - plant.slid(from));
            (rotation * way - self.upright * way).with_y(0.0)
        };
        Slide::new(&plant.plant, leg.feet.len(), frame_time_secs, step)
    }

    fn point(&self, p: DVec3) -> DVec3 {
        self.turn * p + self.rigid.translation
    }
}

/// Returns the one motion of plants: the mean turn of plain path editing about up, and where it puts the foot that
/// stands on average, as near to that as the leg allows; on a ramp also the slope's tilt.
fn motion_of(passing: &Passing, (job, source): (&Job, GroundSlope), passage: &Passage) -> Motion {
    let (mut place, mut foot, mut yaw, mut heading) = (DVec3::ZERO, DVec3::ZERO, 0.0, 0.0);
    let (mut over_path, mut over_ground, mut rise_source) = (0.0, 0.0, 0.0);
    let mut n = 0.0;
    for f in passing.plants.iter().flat_map(|p| p.plant.first..=p.plant.last.min(passage.body.len() - 1)) {
        let mid = passing.leg.feet[f].middle();
        foot += mid;
        place += passage.standing(f).point(mid);
        yaw += job.path[f].heading_rad - job.original[f].heading_rad;
        over_path += job.path[f].slope_rad - job.original[f].slope_rad;
        let ground_rad = source.in_heading_rad(job.original[f].heading_rad);
        rise_source += ground_rad;
        over_ground += job.path[f].slope_rad - ground_rad;
        heading += job.path[f].heading_rad;
        n += 1.0;
    }
    let (place, foot) = (place / n, foot / n);
    let upright = heading_rotation(yaw / n);
    let mut rotation = upright;
    let tilt_rad = tilt(over_path / n, over_ground / n);
    if job.ground == Ground::Ramp && tilt_rad != 0.0 {
        let along = heading_rotation(heading / n);
        // A turn about X takes Z down, so a slope up is a negative one.
        rotation = along * DQuat::from_rotation_x(-tilt_rad) * along.conjugate() * upright;
    }
    let mut motion = Rigid::new(rotation, place - rotation * foot);
    let way = passing.gives_way(&motion);
    let ground_rad = steeper(over_path / n, over_ground / n) + rise_source / n;
    let rise = ground_rad.tan() * way.dot(DVec2::from((heading / n).sin_cos()));
    motion.translation += DVec3::new(way.x, rise, way.y);
    Motion { rigid: motion, turn: DMat3::from_quat(rotation), upright }
}

/// Returns how much steeper the ground is than the source's where the new path is steeper than the original one, and than
/// the source's ground, by this, radians: the lesser of the two, because a fitted path also falls where the body crouches.
fn steeper(over_path_rad: f64, over_ground_rad: f64) -> f64 {
    match over_path_rad * over_ground_rad > 0.0 {
        true => over_path_rad.signum() * over_path_rad.abs().min(over_ground_rad.abs()),
        false => 0.0,
    }
}

/// Returns how far a foot tilts on such ground: not at all for the little by which a path rises and falls with the body.
fn tilt(over_path_rad: f64, over_ground_rad: f64) -> f64 {
    let slope_rad = steeper(over_path_rad, over_ground_rad);
    slope_rad * ground_share(slope_rad)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn feet_tilt_with_ramps_and_not_with_the_bob_of_a_body() {
        let alike = |slope: f64| tilt(slope, slope);
        assert_eq!((alike(0.0), alike(0.05), alike(-0.05)), (0.0, 0.0, 0.0));
        assert_eq!((alike(0.2), alike(-0.2)), (0.2, -0.2));
        assert!(alike(0.08) > 0.0 && alike(0.08) < 0.08);
        // A crouch on a level path, and the same path again, crouch and all.
        assert_eq!((tilt(0.2, 0.0), tilt(0.0, -0.2), tilt(0.2, -0.2), tilt(-0.2, -0.3)), (0.0, 0.0, 0.0, -0.2));
    }
}
