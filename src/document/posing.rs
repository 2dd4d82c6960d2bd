//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints turn and the carrier moves in the pose that is seen. Where feet are held, holding has the last word, and what
//! it does is found out on a [`Piece`] of the clip before the whole clip follows; of points that are to go somewhere
//! [`Wish`] knows how.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{
    Edits, LayerRefusal, Solved,
    layers::editable,
    piece::Piece,
    reaching::{Holding, Wish},
    solve::draft,
};
use crate::{
    displace::{
        Stack, can_turn,
        ik::{self, JointTurn},
        joint_name,
    },
    math::Rigid,
    skeleton::JointId,
};

/// A point that is nearer to its target than this share of the body height is there.
pub(super) const THERE: f64 = 7e-5;
/// On a piece of the clip, where to be nearer costs next to nothing.
pub(super) const THERE_ON_PIECE: f64 = 1e-5;
/// How often the whole clip follows an edit, at most.
pub(super) const DRAFTS: usize = 5;
/// Corrections of what holding does to a foot or the carrier, on a piece, at most.
pub(super) const CORRECTIONS: usize = 12;

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
pub(super) fn pose(solved: &Solved, frame_idx: usize) -> Vec<Rigid> {
    let mut world = Vec::new();
    solved.edited.world_rigids(frame_idx, &mut world);
    world
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
pub(super) fn key_turns(
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
