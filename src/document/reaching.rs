//! Moving a point of a pose while feet are held: which turns of the chain bring it there.
//!
//! Joints are moved in the pose that is seen. Where legs that are held hang on them, holding has the last word, and what
//! it does is corrected after a look at it. What a held leg's own joints do is seen only after its foot has been held, so
//! a leg is moved where holding takes it from, on the original path, towards the place that holding takes to the target.
//! That is no way where holding answers: near a leg's full length it moves the carrier, and with it the foot, back by as
//! much as a turn took it on. Then what turns do is found out by trying ([`Search`]).
//!
//! All of it is tried on a [`Piece`] of the clip, and the whole clip follows it once. What the piece was off by is known
//! from the pose that is seen already, so the whole clip seldom has to be asked again; where it does not do what the piece
//! did, a larger piece is tried. Where the clip is to follow nearby alone it is not asked at all, and nothing is searched for
//! long.

use std::sync::Arc;

use glam::{DMat3, DQuat, DVec3};

use super::{
    Edits, LayerRefusal, Solved,
    piece::{AROUND_SECS, CORRECTIONS, DRAFTS, Follows, Piece, Seen, THERE, THERE_ON_PIECE},
    pose_keys::{key_turns, pose},
    probe::{Probe, Tried},
    search::Search,
    solve::draft,
};
use crate::{
    displace::ik::{self, JointTurn, Reach},
    math::Rigid,
    motion::Leg,
    skeleton::JointId,
};

/// A correction that leaves more than this share of what was missing does not take the point on.
const TAKES_ON: f64 = 0.8;
/// A foot is aimed at most so many times as far as it is to go.
const MOST_AHEAD: f64 = 4.0;
/// A foot that goes on by less than this share of where it is aimed says nothing of how to aim it.
const LEAST_GOES_ON: f64 = 0.05;
/// A chain shorter than this share of the body height is none.
const NO_LENGTH: f64 = 1e-9;
/// Holding takes a point no farther than this, body heights: what is farther out of reach is not searched for.
const HOLDING_HELPS: f64 = 0.3;
/// A target farther than this from what a straight chain reaches, body heights, is taken to be just as far.
const MOST_HELP: f64 = 0.1;
/// A press that leaves a point off its target brings it nearer by this at least, body heights, or by this share of what
/// was missing: the body is not moved about for less.
const LEAST_GAIN: f64 = 1e-3;
const LEAST_SHARE: f64 = 0.1;
/// The clip has a point that does not get to its target where the piece had it if it is this near, body heights.
const AS_FOUND: f64 = 1e-3;
/// How often the whole clip is asked again, at most, where there is time.
const MOST_DRAFTS: usize = 12;
/// Corrections of what holding the feet does to a hand, on a piece, at most: two do for all but a body that turns over.
const BODY_CORRECTIONS: usize = 8;

/// A point that is to go somewhere at a frame.
pub(super) struct Wish<'a> {
    pub(super) solved: &'a Solved,
    pub(super) layer_idx: usize,
    pub(super) frame_idx: usize,
    pub(super) point: usize,
    /// The joints that turn, top first.
    pub(super) chain: Vec<JointId>,
    pub(super) follows: Follows<'a>,
}

/// What holding feet has to do with the joints that turn.
pub(super) enum Holding {
    /// Nothing.
    None,
    /// Legs that are held hang on some of them, and the point on none of those legs.
    Beside,
    /// The point hangs on a leg that is held.
    OfPoint,
}

/// What came of moving a point.
enum Reached {
    /// The clip as it is shown for a moment.
    Shown(Solved),
    /// Nothing: it was given up.
    Nothing,
    /// The clip followed what was found on a piece.
    Followed {
        made: Solved,
        /// And has the point at its target, or where the piece had it.
        is_as_found: bool,
    },
}

/// Edits tried on a piece.
pub(super) type OnPiece = Tried<(Edits, Seen)>;

impl Wish<'_> {
    pub(super) fn holding(&self) -> Holding {
        let skeleton = &self.solved.clip.skeleton;
        // A joint does not move itself.
        let borne_by = match self.point.checked_sub(skeleton.n_joints()) {
            None => skeleton.joints()[self.point].parent,
            Some(site) => Some(skeleton.end_sites()[site]),
        };
        let is_of = |leg: Leg| borne_by.is_some_and(|joint| skeleton.is_within(joint, leg.hip));
        if self.chain.iter().all(|&joint| self.is_free(joint)) {
            Holding::None
        } else if self.solved.posed.prepared.legs().any(is_of) {
            Holding::OfPoint
        } else {
            Holding::Beside
        }
    }

    /// Tells whether no leg that is held hangs on a joint.
    pub(super) fn is_free(&self, joint: JointId) -> bool {
        self.solved.holding.is_none() || self.solved.posed.is_free(joint)
    }

    /// Returns how joints turn so that the point of a pose gets to a target.
    pub(super) fn turns(&self, chain: &[JointId], world: &[Rigid], target: DVec3) -> Vec<JointTurn> {
        let clip = &*self.solved.clip;
        let point = ik::point_position(&clip.skeleton, world, self.point);
        let hinge = ik::usual_hinge(clip, chain, self.point);
        Reach { world, chain, point, target, hinge }.turns()
    }

    /// Returns where the point of a pose gets to when joints turn.
    fn after(&self, world: &[Rigid], turns: &[JointTurn]) -> DVec3 {
        self.at(&ik::turned_world(&self.solved.clip.skeleton, world, turns))
    }

    /// Returns where the point is in a pose.
    pub(super) fn at(&self, world: &[Rigid]) -> DVec3 {
        ik::point_position(&self.solved.clip.skeleton, world, self.point)
    }

    /// Keys turns of joints at the frame.
    pub(super) fn key(&self, edits: &mut Edits, turns: &[JointTurn]) -> Result<(), LayerRefusal> {
        key_turns(self.solved, edits, self.layer_idx, self.frame_idx, turns)
    }

    /// Moves the point by joints of which some bear legs that are held; returns what follows.
    ///
    /// Where the clip does not get there although the piece did, a larger piece is tried.
    pub(super) fn reach(&self, holding: &Holding, edits: &mut Edits, target: DVec3) -> Result<Solved, LayerRefusal> {
        let mut nearest = None::<Solved>;
        for secs in AROUND_SECS {
            let piece = Piece::around(self.solved, self.frame_idx, secs);
            let reached = match holding {
                Holding::OfPoint => self.reach_held(&piece, edits, target)?,
                Holding::None | Holding::Beside => self.reach_beside(&piece, edits, target)?,
            };
            let (made, is_as_found) = match reached {
                Reached::Shown(shown) => return Ok(shown),
                Reached::Nothing => return Ok(self.solved.clone()),
                Reached::Followed { made, is_as_found } => (made, is_as_found),
            };
            if nearest.as_ref().is_none_or(|nearest| self.missing(&made, target) < self.missing(nearest, target)) {
                nearest = Some(made);
            }
            if is_as_found || piece.is_whole() {
                break;
            }
        }
        Ok(self.kept_if_nearer(edits, nearest.expect("a piece is tried at least"), target))
    }

    /// The same by what a piece finds, where some of the joints bear legs and the point is on none of them.
    ///
    /// What the piece finds is good for the clip but for a little, which is left to the joints that bear no leg: they
    /// move no foot, so it is exact. Only what they cannot do is done by all once more.
    fn reach_beside(&self, piece: &Piece, edits: &mut Edits, to: DVec3) -> Result<Reached, LayerRefusal> {
        let near = THERE * self.height();
        let mut probe = Probe::new(self.chain.len(), self.height());
        let mut on_piece = self.on_piece(piece, edits.clone());
        let mut made = None::<Solved>;
        let mut place = to;
        for _ in 0..DRAFTS {
            let now = made.as_ref().unwrap_or(self.solved);
            let off = on_piece.at - self.at(&pose(now, self.frame_idx));
            let begin = on_piece;
            on_piece = self.body_on_piece(piece, begin.clone(), to + off, &mut probe)?;
            if self.follows.is_nearby() {
                return Ok(Reached::Shown(self.shown(piece, edits, &begin, on_piece, to + off)));
            }
            if self.follows.is_given_up() {
                return Ok(Reached::Nothing);
            }
            place = on_piece.at - off;
            if probe.knows() {
                let expected = place.distance(to);
                made = Some(self.followed(piece, on_piece, expected, to, probe));
                break;
            }
            let drafted = draft(&Arc::new(on_piece.pose.0.clone()), now);
            let world = pose(&drafted, self.frame_idx);
            let nearest = self.after(&world, &self.turns(&self.chain, &world, to));
            let free = self.turns(&self.free(), &world, to);
            let is_there = self.at(&world).distance(nearest) < near;
            if !is_there && self.after(&world, &free).distance(nearest) < near {
                self.key(&mut on_piece.pose.0, &free)?;
                made = Some(draft(&Arc::new(on_piece.pose.0), &drafted));
                break;
            }
            made = Some(drafted);
            if is_there {
                break;
            }
        }
        Ok(self.as_found(made.expect("a draft is made at least once"), place, to))
    }

    /// Takes over edits found on a piece, unless they are not worth moving the body; returns what is shown of them.
    fn shown(&self, piece: &Piece, edits: &mut Edits, begin: &OnPiece, found: OnPiece, target: DVec3) -> Solved {
        let is_worth = self.is_worth(found.at.distance(target), begin.at.distance(target));
        let best = if is_worth { found } else { begin.clone() };
        let ((made, is), (_, was)) = (best.pose, &begin.pose);
        edits.clone_from(&made);
        piece.shown(was, &is, &Arc::new(made))
    }

    /// Tells whether a point that is this far off its target, and was so far off it, is there or nearer by what is worth
    /// moving the body.
    fn is_worth(&self, is: f64, was: f64) -> bool {
        let least = (LEAST_GAIN * self.height()).min(LEAST_SHARE * was);
        is <= THERE * self.height() || was - is >= least
    }

    /// Tells of what followed from an edit that had the point at a place on a piece.
    fn as_found(&self, made: Solved, place: DVec3, to: DVec3) -> Reached {
        let near = THERE * self.height();
        let (missing, is_reached) = (self.missing(&made, to), place.distance(to) < near);
        let is_as_found = missing < near || (!is_reached && self.missing(&made, place) < AS_FOUND * self.height());
        Reached::Followed { made, is_as_found: is_as_found || self.follows.is_brief() }
    }

    /// Returns how far the point is from a target.
    fn missing(&self, solved: &Solved, target: DVec3) -> f64 {
        self.at(&pose(solved, self.frame_idx)).distance(target)
    }

    /// Takes over the edits of what was made, unless they are not worth moving the body; returns what follows.
    fn kept_if_nearer(&self, edits: &mut Edits, made: Solved, target: DVec3) -> Solved {
        if !self.is_worth(self.missing(&made, target), self.missing(self.solved, target)) {
            return draft(&Arc::new(edits.clone()), &made);
        }
        edits.clone_from(&made.edits);
        made
    }

    /// Moves the point of a piece by all joints of the chain.
    ///
    /// All joints turn in the pose that is seen. Holding the feet then takes the carrier a little elsewhere, which is
    /// corrected. A target that is out of reach by no more than holding may help is searched for.
    fn body_on_piece(
        &self,
        piece: &Piece,
        begin: OnPiece,
        to: DVec3,
        probe: &mut Probe,
    ) -> Result<OnPiece, LayerRefusal> {
        let near = THERE_ON_PIECE * self.height();
        let mut now = begin.clone();
        // Out of reach, a try may be further off than one before it.
        let mut best = None::<OnPiece>;
        for _ in 0..BODY_CORRECTIONS {
            let turns = self.turns(&self.chain, &now.pose.1.held, to);
            if now.at.distance(self.after(&now.pose.1.held, &turns)) < near {
                break;
            }
            now = self.turned_on_piece(piece, &now.pose, &turns)?;
            if best.as_ref().is_none_or(|best| now.at.distance(to) < best.at.distance(to)) {
                best = Some(now.clone());
            }
        }
        let best = best.filter(|best| best.at.distance(to) < now.at.distance(to)).unwrap_or(now);
        let from = if begin.at.distance(to) < best.at.distance(to) { &begin } else { &best };
        let missing = from.at.distance(to) / self.height();
        if (THERE_ON_PIECE..HOLDING_HELPS).contains(&missing) {
            return Ok(self.searched(piece, [&begin, from], to, probe));
        }
        Ok(best)
    }

    /// Returns the joints of the chain that bear no leg that is held.
    pub(super) fn free(&self) -> Vec<JointId> {
        self.chain.iter().copied().filter(|&joint| self.is_free(joint)).collect()
    }

    pub(super) fn height(&self) -> f64 {
        self.solved.clip.facts.height.value
    }

    /// The same, too, where the point is on a leg that is held.
    fn reach_held(&self, piece: &Piece, edits: &mut Edits, target: DVec3) -> Result<Reached, LayerRefusal> {
        let now = pose(self.solved, self.frame_idx);
        let to = self.within_reach(&now, target);
        let mut probe = Probe::new(self.chain.len(), self.height());
        let begin = self.on_piece(piece, edits.clone());
        let off = begin.at - self.at(&now);
        let aim = to + off;
        let found = self.foot_on_piece(piece, begin.clone(), aim, &mut probe)?;
        if self.follows.is_nearby() {
            return Ok(Reached::Shown(self.shown(piece, edits, &begin, found, aim)));
        }
        if self.follows.is_given_up() {
            return Ok(Reached::Nothing);
        }
        let place = found.at - off;
        let made = self.followed(piece, found, place.distance(to), to, probe);
        Ok(self.as_found(made, place, to))
    }

    /// Tells whether the point is where a target is already.
    pub(super) fn is_there(&self, target: DVec3) -> bool {
        self.missing(self.solved, target) < THERE * self.height()
    }

    /// Tells whether all of the chain is where the point is.
    pub(super) fn has_no_length(&self) -> bool {
        self.top_and_length(&pose(self.solved, self.frame_idx)).1 < NO_LENGTH * self.height()
    }

    /// Returns where the chain begins and how long it is when it is straight.
    fn top_and_length(&self, world: &[Rigid]) -> (DVec3, f64) {
        let joints = self.chain.iter().map(|joint| world[joint.idx()].translation);
        let places: Vec<DVec3> = joints.chain([self.at(world)]).collect();
        (places[0], places.windows(2).map(|pair| pair[0].distance(pair[1])).sum())
    }

    /// Returns the place nearest to a target that the chain reaches, as far as holding may help it.
    fn within_reach(&self, world: &[Rigid], target: DVec3) -> DVec3 {
        let (top, length) = self.top_and_length(world);
        top + (target - top).clamp_length_max(length + MOST_HELP * self.height())
    }

    /// Has the whole clip follow what was found on a piece; what it is off by more than the piece was is corrected.
    ///
    /// `expected` is how far the piece was off its target.
    fn followed(&self, piece: &Piece, found: OnPiece, expected: f64, to: DVec3, mut probe: Probe) -> Solved {
        let near = THERE * self.height();
        let in_clip = |edits: &Edits, now: &Solved| {
            let made = draft(&Arc::new(edits.clone()), now);
            Tried { at: self.at(&pose(&made, self.frame_idx)), pose: made }
        };
        let made = in_clip(&found.pose.0, self.solved);
        let enough = near + expected;
        if made.at.distance(to) < enough || self.follows.is_given_up() {
            return made.pose;
        }
        probe.look_around(&found, |now, turns| self.turned_on_piece(piece, now, &self.joint_turns(turns)).ok());
        let most_drafts = if self.follows.is_brief() { DRAFTS } else { MOST_DRAFTS };
        let corrected = probe.nearest(made, to, enough, most_drafts, |now, turns| {
            let mut edits = (*now.edits).clone();
            self.key(&mut edits, &self.joint_turns(turns)).ok()?;
            Some(in_clip(&edits, now))
        });
        corrected.pose
    }

    /// Moves the point of a leg that is held on a piece.
    ///
    /// What is missing after a try is tried again from there, as long as that takes the point on. It does not where
    /// holding answers a turn by moving the carrier as far the other way; then what turns do is found out by trying.
    fn foot_on_piece(
        &self,
        piece: &Piece,
        begin: OnPiece,
        to: DVec3,
        probe: &mut Probe,
    ) -> Result<OnPiece, LayerRefusal> {
        let skeleton = &self.solved.clip.skeleton;
        // Holding moves a foot as one rigid body.
        let end = skeleton.joint_of_point(self.point).idx();
        let mut best = begin.clone();
        // How much farther than it is to go the point has to be aimed, by all that holding did so far (C. Broyden, 1965).
        let mut ahead = DMat3::IDENTITY;
        for _ in 0..CORRECTIONS {
            let seen = &best.pose.1;
            let back = seen.before_holding[end] * seen.held[end].inverse();
            let missing = to - best.at;
            let step = (ahead * missing).clamp_length_max(MOST_AHEAD * missing.length());
            let turns = self.turns(&self.chain, &seen.before_holding, back.point(best.at + step));
            let tried = self.turned_on_piece(piece, &best.pose, &turns)?;
            let went = tried.at - best.at;
            let row = ahead.transpose() * step;
            let along = row.dot(went);
            if along.abs() > LEAST_GOES_ON * step.length_squared() {
                let wrong = (step - ahead * went) / along;
                ahead += DMat3::from_cols(wrong * row.x, wrong * row.y, wrong * row.z);
            }
            let (was, is) = (best.at.distance(to), tried.at.distance(to));
            if is < was {
                best = tried;
            }
            if is < THERE_ON_PIECE * self.height() {
                return Ok(best);
            }
            if is > TAKES_ON * was {
                break;
            }
        }
        Ok(self.searched(piece, [&begin, &best], to, probe))
    }

    /// Searches a piece, and finds out what all joints do around what is found.
    fn searched(&self, piece: &Piece, [seen, begin]: [&OnPiece; 2], to: DVec3, probe: &mut Probe) -> OnPiece {
        let best = Search::new(self, piece, to).best(seen, begin);
        if !self.follows.is_brief() && !self.follows.is_given_up() {
            probe.look_around(&best, |now, turns| self.turned_on_piece(piece, now, &self.joint_turns(turns)).ok());
        }
        best
    }

    fn joint_turns(&self, turns: &[DQuat]) -> Vec<JointTurn> {
        self.chain.iter().zip(turns).map(|(&joint, &turn)| JointTurn { joint, turn }).collect()
    }

    pub(super) fn turned_on_piece(
        &self,
        piece: &Piece,
        (edits, _): &(Edits, Seen),
        turns: &[JointTurn],
    ) -> Result<OnPiece, LayerRefusal> {
        let mut edits = edits.clone();
        self.key(&mut edits, turns)?;
        Ok(self.on_piece(piece, edits))
    }

    fn on_piece(&self, piece: &Piece, edits: Edits) -> OnPiece {
        let seen = piece.with(&edits);
        Tried { at: self.at(&seen.held), pose: (edits, seen) }
    }
}
