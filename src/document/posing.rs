//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints are moved in the pose that is seen, on its path and with its feet held. A foot that stands is carried by its
//! plant after that, so such a move is corrected by how far the foot then misses: a few solves, none for other joints.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{Edits, LayerRefusal, Solved, layers::editable, solve};
use crate::{
    displace::{
        Stack, can_turn,
        ik::{self, JointTurn, Reach},
        joint_name,
    },
    math::Rigid,
    skeleton::JointId,
};

/// A point that is nearer to its target than this share of the body height is there.
const THERE: f64 = 1e-5;
/// Corrections of a foot that stands, at most.
const CORRECTIONS: usize = 4;

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

/// Makes a pose, at an edited frame, what is wanted; the keys go into a layer.
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
) -> Result<(), LayerRefusal> {
    editable(edits, layer_idx)?;
    match change {
        PoseChange::Reach { point, joints, to } => reach(solved, edits, layer_idx, frame_idx, (*point, joints, *to)),
        PoseChange::Turn { joint, axis, angle_rad } => {
            let clip = &*solved.clip;
            if !can_turn(clip, *joint) {
                return Err(LayerRefusal::Stiff(joint_name(&clip.skeleton, *joint)));
            }
            let world = pose(solved, frame_idx)[joint.idx()].rotation;
            let turn = ik::turn_about(world, *axis, *angle_rad);
            key_turns(solved, edits, layer_idx, frame_idx, &[JointTurn { joint: *joint, turn }])
        }
        PoseChange::MoveCarrier { by } => move_carrier(solved, edits, layer_idx, frame_idx, *by),
    }
}

/// Returns the world motions of all joints as they are seen.
fn pose(solved: &Solved, frame_idx: usize) -> Vec<Rigid> {
    let mut world = Vec::new();
    solved.edited.world_rigids(frame_idx, &mut world);
    world
}

fn reach(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    frame_idx: usize,
    (point, joints, to): (usize, &[JointId], DVec3),
) -> Result<(), LayerRefusal> {
    let clip = &*solved.clip;
    let chain = ik::chain(clip, point, joints);
    if chain.is_empty() {
        return Err(LayerRefusal::NothingSelected);
    }
    let world = pose(solved, frame_idx);
    let at = |world: &[Rigid]| ik::point_position(&clip.skeleton, world, point);
    let (from, hinge) = (at(&world), ik::usual_hinge(clip, &chain, point));
    let turns = |target| Reach { world: &world, chain: &chain, point: from, target, hinge }.turns();
    let wanted = at(&ik::turned_world(&clip.skeleton, &world, &turns(to)));
    let untouched = edits.clone();
    key_turns(solved, edits, layer_idx, frame_idx, &turns(to))?;

    let legs: Vec<JointId> = solved.posed.prepared.legs().map(|leg| leg.ankle).collect();
    let is_held = solved.holding.is_some()
        && legs.iter().any(|&ankle| chain.iter().any(|&joint| clip.skeleton.is_within(ankle, joint)));
    if !is_held {
        return Ok(());
    }
    let near = THERE * clip.facts.height.value;
    let (mut target, mut least) = (wanted, f64::INFINITY);
    let mut best = edits.clone();
    for _ in 0..CORRECTIONS {
        let made = solve(&solved.source, &Arc::new(edits.clone()), Some(solved));
        let off = at(&pose(&made, frame_idx)) - wanted;
        if off.length() < least {
            (least, best) = (off.length(), edits.clone());
        } else {
            break;
        }
        if least < near {
            break;
        }
        target -= off;
        edits.clone_from(&untouched);
        if key_turns(solved, edits, layer_idx, frame_idx, &turns(target)).is_err() {
            break;
        }
    }
    *edits = best;
    Ok(())
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
