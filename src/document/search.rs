//! A search on a piece of a clip for turns of joints that bear held legs, which bring a point to a target or as near as can
//! be.
//!
//! Only what the joints do that bear a leg has to be found out: the others move no foot, and turn as far as is missing.
//! What holding does may bend sharply between one turn and the next, and far turns may do what near ones do not. So three
//! things are tried, each where the one before ends short: steps downhill ([`Probe`]); the same from where larger turns of
//! the pose that was seen bring the point nearest, and from larger turns of what that finds, while it gets nearer; and clouds
//! of poses ([`cloud`]) around the pose that was seen.

use glam::{DQuat, DVec3};

use super::{
    Edits, cloud,
    piece::{Piece, Seen, THERE_ON_PIECE},
    probe::Probe,
    reaching::{OnPiece, Wish},
};
use crate::{
    displace::ik::{self, JointTurn},
    skeleton::JointId,
    sync::side_by_side,
};

/// Tries of a search on a piece: in all, about; from where corrections ended; and from a pose that larger turns lead to.
const SEARCH_TRIES: usize = 1500;
const FIRST_TRIES: usize = 60;
const START_TRIES: usize = 90;
/// Steps of a search whose result is only to be seen for a moment, beside what it takes to find out what joints do.
const FEW_STEPS: usize = 4;
/// Poses whose joints are nearer to each other than this, radians, are taken to lead to the same place: of up to two
/// joints, and of more.
const APART: [f64; 2] = [0.7, 0.2];
/// So many poses of more joints are gone on from at most: there is more to be had from where the best of them leads.
const MOST_STARTS: usize = 4;
/// Larger turns that are tried of each joint that bears a leg, radians; of several joints the middle ones, or just one.
const LARGER_TURNS: [f64; 4] = [0.1, 0.25, 0.5, 0.9];
/// Turns that clouds of poses begin with, radians; and about how many poses each tries: some, and more for each joint.
const CLOUD_SPREADS: [f64; 2] = [0.1, 0.3];
const CLOUD_TRIES: [usize; 2] = [500, 100];
/// What is farther than this from its target after all else, body heights, is held to be out of reach.
const CLOUDS_HELP: f64 = 0.03;
/// What is so near to its target, body heights, is gone on from by smaller turns.
const NEARLY: f64 = 1e-3;
const NEARLY_SPREAD: f64 = 0.02;
/// Larger turns are gone on from while they bring the point nearer by this share of what was missing.
const GOES_ON: f64 = 0.1;

/// A search for one point's way to one target.
pub(super) struct Search<'a> {
    wish: &'a Wish<'a>,
    piece: &'a Piece<'a>,
    /// The joints of the chain that bear a leg that is held.
    bearing: Vec<JointId>,
    to: DVec3,
}

impl<'a> Search<'a> {
    pub(super) fn new(wish: &'a Wish<'a>, piece: &'a Piece<'a>, to: DVec3) -> Self {
        let bearing = wish.chain.iter().copied().filter(|&joint| !wish.is_free(joint)).collect();
        Self { wish, piece, bearing, to }
    }

    /// Returns the best that is found: from `begin` on, where corrections ended, and then around `seen`, from where they
    /// began. A search that is brief takes steps downhill alone, a few.
    pub(super) fn best(&self, seen: &OnPiece, begin: &OnPiece) -> OnPiece {
        if self.wish.follows.is_brief() {
            return self.downhill(begin, 3 * self.bearing.len() + FEW_STEPS).0;
        }
        let (best, n_tried) = self.downhill(begin, FIRST_TRIES);
        let best = self.by_larger_turns(seen, best, SEARCH_TRIES.saturating_sub(n_tried));
        self.by_clouds(seen, best)
    }

    fn near(&self) -> f64 {
        THERE_ON_PIECE * self.wish.height()
    }

    fn missing(&self, tried: &OnPiece) -> f64 {
        tried.at.distance(self.to)
    }

    /// Tells whether there is nothing left to be searched for, or nobody who waits for it.
    fn is_done(&self, best: &OnPiece) -> bool {
        self.missing(best) < self.near() || self.wish.follows.is_given_up()
    }

    /// Takes steps downhill; returns where they end, and how many turns were tried.
    fn downhill(&self, begin: &OnPiece, most_tries: usize) -> (OnPiece, usize) {
        let mut probe = Probe::new(self.bearing.len(), self.wish.height());
        let turned = |now: &(Edits, Seen), turns: &[DQuat]| self.turned(now, turns);
        let found = probe.nearest(begin.clone(), self.to, self.near(), most_tries, turned);
        (found, probe.n_tried())
    }

    /// Goes on from larger turns of the pose that was seen, then of what was found.
    fn by_larger_turns(&self, seen: &OnPiece, mut best: OnPiece, mut n_left: usize) -> OnPiece {
        let mut from = seen.clone();
        let mut missing = f64::INFINITY;
        let turns = larger_turns(self.bearing.len());
        while !self.is_done(&best) && n_left > turns.len() {
            let tried = side_by_side(&turns, |turns| self.turned(&from.pose, turns));
            n_left = n_left.saturating_sub(turns.len());
            for starts in self.nearest_apart(tried.into_iter().flatten().collect()).chunks(2) {
                if n_left <= 3 * self.bearing.len() || self.missing(&best) < self.near() {
                    break;
                }
                for (found, n_tried) in side_by_side(starts, |start| self.downhill(start, START_TRIES)) {
                    n_left = n_left.saturating_sub(n_tried);
                    best = self.nearer(best, found);
                }
            }
            if self.missing(&best) > (1.0 - GOES_ON) * missing {
                break;
            }
            missing = self.missing(&best);
            from = best.clone();
        }
        best
    }

    /// Goes on from the best of clouds of poses around the one that was seen, or around one that is nearly there.
    fn by_clouds(&self, seen: &OnPiece, mut best: OnPiece) -> OnPiece {
        let n_joints = self.bearing.len();
        for spread in CLOUD_SPREADS {
            let missing = self.missing(&best) / self.wish.height();
            if self.is_done(&best) || missing > CLOUDS_HELP {
                break;
            }
            let (from, spread) = if missing < NEARLY { (best.clone(), NEARLY_SPREAD) } else { (seen.clone(), spread) };
            let drawn = |x: &[f64]| {
                let turns: Vec<_> = x.chunks_exact(3).map(DVec3::from_slice).map(DQuat::from_scaled_axis).collect();
                self.turned(&from.pose, &turns)
            };
            let n_tries = CLOUD_TRIES[0] + CLOUD_TRIES[1] * n_joints;
            let cost = |x: &[f64]| Some(self.missing(&drawn(x)?));
            let least = cloud::least(3 * n_joints, spread, n_tries, self.near(), cost);
            if let Some(start) = least.and_then(|x| drawn(&x)) {
                best = self.nearer(best, self.downhill(&start, START_TRIES).0);
            }
        }
        best
    }

    fn nearer(&self, best: OnPiece, found: OnPiece) -> OnPiece {
        if self.missing(&found) < self.missing(&best) { found } else { best }
    }

    /// Returns poses in the order of how near they have the point to a target, without those that turn joints much as a
    /// nearer one does.
    fn nearest_apart(&self, mut tried: Vec<OnPiece>) -> Vec<OnPiece> {
        let joints = &self.bearing;
        let (apart, most) = if joints.len() > 2 { (APART[1], MOST_STARTS) } else { (APART[0], tried.len()) };
        tried.sort_by(|a, b| self.missing(a).total_cmp(&self.missing(b)));
        let rotation = |of: &OnPiece, joint: &JointId| of.pose.1.held[joint.idx()].rotation;
        let is_apart = |a: &OnPiece, b: &OnPiece| {
            joints.iter().any(|joint| rotation(a, joint).angle_between(rotation(b, joint)) > apart)
        };
        let mut kept = Vec::<OnPiece>::new();
        for one in tried {
            if kept.len() == most {
                break;
            }
            if kept.iter().all(|nearer| is_apart(nearer, &one)) {
                kept.push(one);
            }
        }
        kept
    }

    /// Turns the joints of the chain that bear a leg, and then the others, which move no foot, as far as is missing; none
    /// where they cannot be turned, or nobody waits for it any more.
    fn turned(&self, now: &(Edits, Seen), turns: &[DQuat]) -> Option<OnPiece> {
        let wish = self.wish;
        if wish.follows.is_given_up() {
            return None;
        }
        let turns: Vec<_> = self.bearing.iter().zip(turns).map(|(&joint, &turn)| JointTurn { joint, turn }).collect();
        let mut tried = wish.turned_on_piece(self.piece, now, &turns).ok()?;
        let free = wish.free();
        if !free.is_empty() {
            let (edits, seen) = &mut tried.pose;
            let turns = wish.turns(&free, &seen.held, self.to);
            wish.key(edits, &turns).ok()?;
            seen.held = ik::turned_world(&wish.solved.clip.skeleton, &seen.held, &turns);
            tried.at = wish.at(&seen.held);
        }
        Some(tried)
    }
}

/// Lists larger turns of each joint about its axes and between them, the others still.
fn larger_turns(n_joints: usize) -> Vec<Vec<DQuat>> {
    let angles = match n_joints {
        1 => &LARGER_TURNS[..],
        2 => &LARGER_TURNS[1..3],
        _ => &LARGER_TURNS[1..2],
    };
    let between = [(1.0, 1.0), (1.0, -1.0), (-1.0, 1.0), (-1.0, -1.0)].map(|(y, z)| DVec3::new(1.0, y, z).normalize());
    let axes: Vec<DVec3> = DVec3::AXES.into_iter().chain(between).flat_map(|axis| [axis, -axis]).collect();
    let turns = angles.iter().flat_map(|&angle| axes.iter().map(move |&axis| DQuat::from_axis_angle(axis, angle)));
    let of_joint = |joint: usize| {
        turns
            .clone()
            .map(move |turn| (0..n_joints).map(|of| if of == joint { turn } else { DQuat::IDENTITY }).collect())
    };
    (0..n_joints).flat_map(of_joint).collect()
}
