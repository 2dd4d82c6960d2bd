//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints are moved in the pose that is seen. Where legs that are held hang on them, holding has the last word, and what
//! it does is corrected after a look at it. What a held leg's own joints do is seen only after its foot has been held, so
//! a leg is moved where holding takes it from, on the original path, towards the place that holding takes to the target.
//!
//! Such an edit is tried on a [`Piece`] of the clip, and the whole clip follows it once. What the piece was off by is
//! known from the pose that is seen already, so the whole clip seldom has to be asked again.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{
    Edits, LayerRefusal, Solved,
    layers::editable,
    piece::{Piece, Seen},
    solve::draft,
};
use crate::{
    displace::{
        Stack, can_turn,
        ik::{self, JointTurn, Reach},
        joint_name,
    },
    math::Rigid,
    motion::Leg,
    skeleton::JointId,
};

/// A point that is nearer to its target than this share of the body height is there.
const THERE: f64 = 7e-5;
/// On a piece of the clip, where to be nearer costs next to nothing.
const THERE_ON_PIECE: f64 = 1e-5;
/// How often the whole clip follows an edit, at most.
const DRAFTS: usize = 5;
/// Corrections of a foot that is held, on a piece, at most.
const CORRECTIONS: usize = 12;
/// Corrections of what holding the feet does to a hand, on a piece, at most: two do for all but a body that turns over.
const BODY_CORRECTIONS: usize = 8;

/// What is wanted of a pose. World positions and axes are y-up, in the clip's unit.
#[derive(Clone, Debug, PartialEq)]
pub enum PoseChange {
    /// A point goes somewhere; of the selected joints those between it and the root turn.
    Reach {
        /// Index of the point: joints, then end sites.
        point: usize,
        /// The joints that may turn.
        joints: Vec<JointId>,
        /// Where it goes.
        to: DVec3,
    },
    /// A joint turns about an axis through itself.
    Turn {
        /// The joint.
        joint: JointId,
        /// Unit axis, world.
        axis: DVec3,
        /// By this much.
        angle_rad: f64,
    },
    /// The carrier moves.
    MoveCarrier {
        /// By this much, world.
        by: DVec3,
    },
}

/// Makes a pose, at an edited frame, what is wanted; the keys go into a layer. Returns a draft of what follows from the
/// edits where that had to be found out.
///
/// # Errors
///
/// When the layer cannot show it or nothing can move.
pub(super) fn change(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    change: &PoseChange,
) -> Result<Option<Solved>, LayerRefusal> {
    editable(edits, layer_idx)?;
    match change {
        PoseChange::Reach { point, joints, to } => {
            let chain = ik::chain(&solved.clip, *point, joints);
            if chain.is_empty() {
                return Err(LayerRefusal::NothingSelected);
            }
            let wish = Wish { solved, layer_idx, frame_idx, point: *point, chain };
            match wish.holding() {
                Holding::None => {
                    let turns = wish.turns(&wish.chain, &pose(solved, frame_idx), *to);
                    key_turns(solved, edits, layer_idx, frame_idx, &turns)?;
                }
                Holding::Beside => return wish.reach_beside(edits, *to).map(Some),
                Holding::OfPoint => return wish.reach_held(edits, *to).map(Some),
            }
        }
        PoseChange::Turn { joint, axis, angle_rad } => {
            let clip = &*solved.clip;
            if !can_turn(clip, *joint) {
                return Err(LayerRefusal::Stiff(joint_name(&clip.skeleton, *joint)));
            }
            let world = pose(solved, frame_idx)[joint.idx()].rotation;
            let turn = ik::turn_about(world, *axis, *angle_rad);
            key_turns(solved, edits, layer_idx, frame_idx, &[JointTurn { joint: *joint, turn }])?;
        }
        PoseChange::MoveCarrier { by } => {
            let to = carrier_at(solved, &pose(solved, frame_idx)) + *by;
            move_carrier(solved, edits, layer_idx, frame_idx, *by)?;
            if solved.holding.is_some() {
                return carry_on(solved, edits, layer_idx, frame_idx, to).map(Some);
            }
        }
    }
    Ok(None)
}

/// Returns the world motions of all joints as they are seen.
fn pose(solved: &Solved, frame_idx: usize) -> Vec<Rigid> {
    let mut world = Vec::new();
    solved.edited.world_rigids(frame_idx, &mut world);
    world
}

/// A point that is to go somewhere at a frame.
struct Wish<'a> {
    solved: &'a Solved,
    layer_idx: usize,
    frame_idx: usize,
    point: usize,
    chain: Vec<JointId>,
}

/// What holding feet has to do with the joints that turn.
enum Holding {
    /// Nothing.
    None,
    /// Legs that are held hang on some of them, and the point on none of those legs.
    Beside,
    /// The point hangs on a leg that is held.
    OfPoint,
}

impl Wish<'_> {
    fn holding(&self) -> Holding {
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
    fn is_free(&self, joint: JointId) -> bool {
        self.solved.holding.is_none() || self.solved.posed.is_free(joint)
    }

    /// Returns how joints turn so that the point of a pose gets to a target.
    fn turns(&self, chain: &[JointId], world: &[Rigid], target: DVec3) -> Vec<JointTurn> {
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
    fn at(&self, world: &[Rigid]) -> DVec3 {
        ik::point_position(&self.solved.clip.skeleton, world, self.point)
    }

    /// Keys turns of joints at the frame.
    fn key(&self, edits: &mut Edits, turns: &[JointTurn]) -> Result<(), LayerRefusal> {
        key_turns(self.solved, edits, self.layer_idx, self.frame_idx, turns)
    }

    /// Moves the point by joints of which some bear legs that are held; returns what follows.
    ///
    /// What the piece finds is good for the clip but for a little, which is left to the joints that bear no leg: they
    /// move no foot, so it is exact. Only what they cannot do is done by all once more.
    fn reach_beside(&self, edits: &mut Edits, to: DVec3) -> Result<Solved, LayerRefusal> {
        let near = THERE * self.height();
        let piece = Piece::around(self.solved, self.frame_idx);
        let mut on_piece = piece.with(&self.solved.edits);
        let mut made = None::<Solved>;
        for _ in 0..DRAFTS {
            let now = made.as_ref().unwrap_or(self.solved);
            let off = self.at(&on_piece.held) - self.at(&pose(now, self.frame_idx));
            on_piece = self.body_on_piece(&piece, on_piece, edits, to + off)?;
            let drafted = draft(&Arc::new(edits.clone()), now);
            let world = pose(&drafted, self.frame_idx);
            let nearest = self.after(&world, &self.turns(&self.chain, &world, to));
            if self.at(&world).distance(nearest) < near {
                return Ok(drafted);
            }
            let free = self.turns(&self.free(), &world, to);
            if self.after(&world, &free).distance(nearest) < near {
                self.key(edits, &free)?;
                return Ok(draft(&Arc::new(edits.clone()), &drafted));
            }
            made = Some(drafted);
        }
        Ok(made.expect("a draft is made at least once"))
    }

    /// Moves the point of a piece, which is as seen, by all joints of the chain; returns what is seen then.
    ///
    /// All joints turn in the pose that is seen. Holding the feet then takes the carrier a little elsewhere, which is
    /// corrected.
    fn body_on_piece(&self, piece: &Piece, mut seen: Seen, edits: &mut Edits, to: DVec3) -> Result<Seen, LayerRefusal> {
        let near = THERE_ON_PIECE * self.height();
        let (mut least, mut best) = (f64::INFINITY, None);
        for _ in 0..BODY_CORRECTIONS {
            let turns = self.turns(&self.chain, &seen.held, to);
            if self.at(&seen.held).distance(self.after(&seen.held, &turns)) < near {
                break;
            }
            self.key(edits, &turns)?;
            seen = piece.with(edits);
            let off = self.at(&seen.held).distance(to);
            if off < least {
                (least, best) = (off, Some((edits.clone(), seen.clone())));
            }
        }
        // Out of reach, a try may be further off than one before it.
        if let Some((nearest, of_nearest)) = best
            && least < self.at(&seen.held).distance(to)
        {
            (*edits, seen) = (nearest, of_nearest);
        }
        Ok(seen)
    }

    /// Returns the joints of the chain that bear no leg that is held.
    fn free(&self) -> Vec<JointId> {
        self.chain.iter().copied().filter(|&joint| self.is_free(joint)).collect()
    }

    fn height(&self) -> f64 {
        self.solved.clip.facts.height.value
    }

    /// Moves the point of a leg that is held; returns what follows.
    ///
    /// The whole clip follows what the piece finds until it is as near as the piece has it, or no nearer than before.
    fn reach_held(&self, edits: &mut Edits, to: DVec3) -> Result<Solved, LayerRefusal> {
        let near = THERE * self.height();
        let piece = Piece::around(self.solved, self.frame_idx);
        let mut on_piece = piece.with(&self.solved.edits);
        let (mut least, mut best) = (f64::INFINITY, None::<Solved>);
        for _ in 0..DRAFTS {
            let now = best.as_ref().unwrap_or(self.solved);
            let off = self.at(&on_piece.held) - self.at(&pose(now, self.frame_idx));
            let begin = if best.is_none() { &*edits } else { &*now.edits };
            let (tried, seen) = self.foot_on_piece(&piece, on_piece, begin.clone(), to + off)?;
            let made = draft(&Arc::new(tried), now);
            let missing = self.at(&pose(&made, self.frame_idx)).distance(to);
            if missing >= least {
                break;
            }
            let expected = self.at(&seen.held).distance(to + off);
            (least, best, on_piece) = (missing, Some(made), seen);
            if missing < near.max(expected) {
                break;
            }
        }
        let made = best.expect("the first try is the best so far");
        edits.clone_from(&made.edits);
        Ok(made)
    }

    /// Moves the point of a leg that is held on a piece, which is as seen; returns the edits and what is seen then.
    ///
    /// What is missing after a try is tried again from there; a try that comes no nearer is made again, half as far.
    fn foot_on_piece(&self, piece: &Piece, seen: Seen, edits: Edits, to: DVec3) -> Result<(Edits, Seen), LayerRefusal> {
        let skeleton = &self.solved.clip.skeleton;
        // Holding moves a foot as one rigid body.
        let end = match self.point.checked_sub(skeleton.n_joints()) {
            None => self.point,
            Some(site) => skeleton.end_sites()[site].idx(),
        };
        let near = THERE_ON_PIECE * self.height();
        let mut least = self.at(&seen.held).distance(to);
        let (mut best, mut share) = ((edits, seen), 1.0);
        for _ in 0..CORRECTIONS {
            let (edits, seen) = &best;
            let back = seen.before_holding[end] * seen.held[end].inverse();
            let aim = self.at(&seen.held).lerp(to, share);
            let turns = self.turns(&self.chain, &seen.before_holding, back.point(aim));
            let mut tried = edits.clone();
            self.key(&mut tried, &turns)?;
            let made = piece.with(&tried);
            let off = self.at(&made.held).distance(to);
            if off >= least {
                share *= 0.5;
                continue;
            }
            (least, best, share) = (off, (tried, made), (2.0f64 * share).min(1.0));
            if off < near {
                break;
            }
        }
        Ok(best)
    }
}

/// Returns where the carrier is in a pose.
fn carrier_at(solved: &Solved, world: &[Rigid]) -> DVec3 {
    world[solved.clip.facts.carrier.value.idx()].translation
}

/// Moves a carrier on that holding the feet keeps from where it is to go; returns what follows.
///
/// Edits have it moved all the way; what holding takes off that is found on a piece and added.
fn carry_on(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    to: DVec3,
) -> Result<Solved, LayerRefusal> {
    let height = solved.clip.facts.height.value;
    let piece = Piece::around(solved, frame_idx);
    let was_on_piece = carrier_at(solved, &piece.with(&solved.edits).held);
    let mut off = was_on_piece - carrier_at(solved, &pose(solved, frame_idx));
    let mut made = None::<Solved>;
    for _ in 0..DRAFTS {
        let (mut least, mut best, mut on_piece) = (f64::INFINITY, edits.clone(), to + off);
        for _ in 0..CORRECTIONS {
            let at = carrier_at(solved, &piece.with(edits).held);
            let missing = to + off - at;
            if missing.length() >= least {
                break;
            }
            (least, best, on_piece) = (missing.length(), edits.clone(), at);
            if least < THERE_ON_PIECE * height {
                break;
            }
            move_carrier(solved, edits, layer_idx, frame_idx, missing)?;
        }
        *edits = best;
        let drafted = draft(&Arc::new(edits.clone()), made.as_ref().unwrap_or(solved));
        let at = carrier_at(solved, &pose(&drafted, frame_idx));
        off = on_piece - at;
        let is_there = at.distance(to) < THERE * height;
        made = Some(drafted);
        // What the piece cannot reach the whole clip cannot either.
        if is_there || least > THERE * height {
            break;
        }
    }
    Ok(made.expect("a draft is made at least once"))
}

/// Keys turns of joints on the right of their local rotations.
fn key_turns(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    turns: &[JointTurn],
) -> Result<(), LayerRefusal> {
    let clip = &*solved.clip;
    let frame = solved.source_frame(frame_idx);
    let file_frame = clip.file_frame(frame);
    let mut layer = editable(edits, layer_idx)?.clone();
    let stack = Stack { clip, base: &solved.posed.base.joints, layers: &edits.layers };
    for JointTurn { joint, turn } in turns {
        let seen: DQuat = stack.rotation(*joint, frame) * *turn;
        let key = stack.rotation_key(layer_idx, *joint, frame, seen);
        let key = key.ok_or_else(|| cannot_show(&layer))?;
        layer.set_rotation(&joint_name(&clip.skeleton, *joint), file_frame, key);
    }
    edits.layers[layer_idx] = layer;
    Ok(())
}

fn move_carrier(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    by: DVec3,
) -> Result<(), LayerRefusal> {
    let clip = &*solved.clip;
    if !clip.facts.path_editable {
        return Err(LayerRefusal::CarrierStays);
    }
    let frame = solved.source_frame(frame_idx);
    let stack = Stack { clip, base: &solved.posed.base.joints, layers: &edits.layers };
    let path_frame = solved.new_frame(frame_idx).rotation;
    let seen = stack.offset(frame) + path_frame.conjugate() * by;
    let key = stack.position_key(layer_idx, frame, seen).ok_or_else(|| cannot_show(&edits.layers[layer_idx]))?;
    edits.layers[layer_idx].position.set(clip.file_frame(frame), key);
    Ok(())
}

fn cannot_show(layer: &crate::displace::Layer) -> LayerRefusal {
    if layer.on { LayerRefusal::Weight(layer.name.clone()) } else { LayerRefusal::Off(layer.name.clone()) }
}
