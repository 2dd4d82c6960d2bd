//! The pose that is seen at a frame, and the keys of a layer that make it another.

use glam::{DQuat, DVec3};

use super::{Edits, LayerRefusal, Solved, layers::editable};
use crate::{
    displace::{Layer, Stack, ik::JointTurn, joint_name},
    math::Rigid,
};

/// Returns the world motions of all joints as they are seen.
pub(super) fn pose(solved: &Solved, frame_idx: usize) -> Vec<Rigid> {
    let mut world = Vec::new();
    solved.edited.world_rigids(frame_idx, &mut world);
    world
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

/// Keys the carrier's way, world.
pub(super) fn move_carrier(
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

fn cannot_show(layer: &Layer) -> LayerRefusal {
    if layer.on { LayerRefusal::Weight(layer.name.clone()) } else { LayerRefusal::Off(layer.name.clone()) }
}
