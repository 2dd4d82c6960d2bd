//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints turn and the carrier moves in the pose that is seen. Where feet are held, holding has the last word, and what
//! it does is found out on a [`Piece`] of the clip before the whole clip follows; of points that are to go somewhere
//! [`Wish`] knows how.

use std::sync::Arc;

use glam::{DMat3, DVec3};

use super::{
    Edits, LayerRefusal, Solved,
    layers::editable,
    piece::{AROUND_SECS, CORRECTIONS, DRAFTS, Follows, Piece, THERE, THERE_ON_PIECE},
    pose_keys::{key_turns, move_carrier, pose},
    probe::Tried,
    reaching::{Holding, Wish},
    solve::draft,
};
use crate::{
    displace::{
        can_turn,
        ik::{self, JointTurn},
        joint_name,
    },
    math::Rigid,
    skeleton::JointId,
};

/// A carrier is moved no farther at once than so many times the way that it has to go.
const FARTHEST: f64 = 4.0;
/// One that follows a move by less than this share of it is held back by its legs.
const LEAST_FOLLOWS: f64 = 0.1;
/// And moved by this share of that as long as it is.
const SHORTER: f64 = 0.4;

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
    /// The carrier goes somewhere.
    PlaceCarrier {
        /// Where it goes.
        to: DVec3,
    },
}

impl PoseChange {
    /// Tells whether the same wish once more is no other: it says where something is to be, not how to go on.
    pub(super) fn is_a_place(&self) -> bool {
        !matches!(self, Self::Turn { .. })
    }
}

/// Makes a pose, at an edited frame, what is wanted; the keys go into a layer. Returns a draft of what follows from the
/// edits where that had to be found out, as far as the clip is to follow.
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
    follows: Follows<'_>,
) -> Result<Option<Solved>, LayerRefusal> {
    editable(edits, layer_idx)?;
    match change {
        PoseChange::Reach { point, joints, to } => {
            let chain = ik::chain(&solved.clip, *point, joints);
            if chain.is_empty() {
                return Err(LayerRefusal::NothingSelected);
            }
            let wish = Wish { solved, layer_idx, frame_idx, point: *point, chain, follows };
            match wish.holding() {
                // What holding makes of their turns is no way to move it.
                _ if wish.has_no_length() => {
                    let skeleton = &solved.clip.skeleton;
                    return Err(LayerRefusal::AtOnePlace(joint_name(skeleton, skeleton.joint_of_point(*point))));
                }
                Holding::None => {
                    let turns = wish.turns(&wish.chain, &pose(solved, frame_idx), *to);
                    key_turns(solved, edits, layer_idx, frame_idx, &turns)?;
                }
                // A target that was reached is not reached anew, some other way.
                _ if wish.is_there(*to) => {}
                holding => return wish.reach(&holding, edits, *to).map(Some),
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
            if follows.is_nearby() && solved.holding.is_some() && !solved.posed.is_free(*joint) {
                let piece = Piece::around(solved, frame_idx, AROUND_SECS[0]);
                let made = Arc::new(edits.clone());
                return Ok(Some(piece.shown(&piece.with(&solved.edits), &piece.with(&made), &made)));
            }
        }
        PoseChange::PlaceCarrier { to } => {
            let by = *to - carrier_at(solved, &pose(solved, frame_idx));
            if solved.holding.is_none() {
                move_carrier(solved, edits, layer_idx, frame_idx, by)?;
            } else if by.length() > THERE * solved.clip.facts.height.value {
                return carry_on(solved, edits, layer_idx, frame_idx, *to, follows).map(Some);
            }
        }
    }
    Ok(None)
}

/// Returns where the carrier is in a pose.
fn carrier_at(solved: &Solved, world: &[Rigid]) -> DVec3 {
    world[solved.clip.facts.carrier.value.idx()].translation
}

/// Moves a carrier whose feet are held; returns what follows.
///
/// It is moved all the way; what holding takes off that is found on a piece and added. Over legs that are nearly
/// straight a carrier follows far less than it is moved: what moves do is learned from those before (C. Broyden, 1965).
/// One that hardly follows at all is as far as its legs let it go, and moved no farther.
fn carry_on(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    to: DVec3,
    follows: Follows<'_>,
) -> Result<Solved, LayerRefusal> {
    let height = solved.clip.facts.height.value;
    let piece = Piece::around(solved, frame_idx, AROUND_SECS[0]);
    let on_piece = |edits: Edits| {
        let seen = piece.with(&edits);
        Tried { at: carrier_at(solved, &seen.held), pose: (edits, seen) }
    };
    let moved = |edits: &Edits, by: DVec3| {
        let mut edits = edits.clone();
        move_carrier(solved, &mut edits, layer_idx, frame_idx, by)?;
        Ok(on_piece(edits))
    };
    let begin = on_piece(edits.clone());
    let mut now = begin.clone();
    let mut off = now.at - carrier_at(solved, &pose(solved, frame_idx));
    // Where it would be if no legs held it, and how far it was moved since.
    let free = solved.posed.carrier(solved.walk.source_frame(frame_idx), &solved.timing.frames[frame_idx]).translation;
    let mut moved_by = DVec3::ZERO;
    let mut answers = DMat3::IDENTITY;
    let mut made = None::<Solved>;
    for _ in 0..DRAFTS {
        let aim = to + off;
        let (mut longest, mut may_begin_anew) = (f64::INFINITY, true);
        for _ in 0..CORRECTIONS {
            let missing = aim - now.at;
            if missing.length() < THERE_ON_PIECE * height || longest < THERE * height {
                break;
            }
            let by = Some(answers.inverse() * missing).filter(|by| by.is_finite()).unwrap_or(missing);
            let by = by.clamp_length_max(longest.min(FARTHEST * missing.length()));
            let next = moved(&now.pose.0, by)?;
            let went = next.at - now.at;
            let wrong = (went - answers * by) / by.length_squared();
            answers += DMat3::from_cols(wrong * by.x, wrong * by.y, wrong * by.z);
            let is_nearer = next.at.distance(aim) < missing.length();
            if is_nearer && went.dot(by) > LEAST_FOLLOWS * by.length_squared() {
                (now, moved_by) = (next, moved_by + by);
                continue;
            }
            longest = SHORTER * by.length();
            // Moved against its legs before, it may come back from there another way.
            if std::mem::take(&mut may_begin_anew) {
                let by = to - free - moved_by;
                let next = moved(&now.pose.0, by)?;
                if next.at.distance(aim) < missing.length() {
                    (now, moved_by, answers, longest) = (next, to - free, DMat3::IDENTITY, f64::INFINITY);
                }
            }
        }
        let (found, seen) = &now.pose;
        edits.clone_from(found);
        if follows.is_nearby() {
            return Ok(piece.shown(&begin.pose.1, seen, &Arc::new(edits.clone())));
        }
        let drafted = draft(&Arc::new(edits.clone()), made.as_ref().unwrap_or(solved));
        let in_clip = carrier_at(solved, &pose(&drafted, frame_idx));
        off = now.at - in_clip;
        made = Some(drafted);
        // What the piece cannot reach the whole clip cannot either.
        if in_clip.distance(to) < THERE * height || now.at.distance(aim) > THERE * height {
            break;
        }
    }
    Ok(made.expect("a draft is made at least once"))
}
