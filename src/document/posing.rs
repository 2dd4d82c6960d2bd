//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints are moved in the pose that is seen. What a leg's joints do is seen only after its foot has been held, so a leg is
//! moved where holding takes it from, on the original path, towards the place that holding takes to the target; what is
//! still missing after that solve is corrected.

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
const THERE: f64 = 5e-5;
/// Corrections of a foot that is held, at most.
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

/// Makes a pose, at an edited frame, what is wanted; the keys go into a layer. Returns what follows from the edits where
/// that had to be found out.
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
            if wish.is_held() {
                return wish.reach_held(edits, *to).map(Some);
            }
            key_turns(solved, edits, layer_idx, frame_idx, &wish.turns(&pose(solved, frame_idx), *to))?;
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
        PoseChange::MoveCarrier { by } => move_carrier(solved, edits, layer_idx, frame_idx, *by)?,
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

impl Wish<'_> {
    /// Tells whether the joints that turn are those of a leg that is held.
    fn is_held(&self) -> bool {
        let skeleton = &self.solved.clip.skeleton;
        let bears = |ankle: JointId| self.chain.iter().any(|&joint| skeleton.is_within(ankle, joint));
        self.solved.holding.is_some() && self.solved.posed.prepared.legs().any(|leg| bears(leg.ankle))
    }

    /// Returns how the joints turn so that the point of a pose gets to a target.
    fn turns(&self, world: &[Rigid], target: DVec3) -> Vec<JointTurn> {
        let clip = &*self.solved.clip;
        let point = ik::point_position(&clip.skeleton, world, self.point);
        let hinge = ik::usual_hinge(clip, &self.chain, self.point);
        Reach { world, chain: &self.chain, point, target, hinge }.turns()
    }

    /// Returns where the point is in a pose.
    fn at(&self, world: &[Rigid]) -> DVec3 {
        ik::point_position(&self.solved.clip.skeleton, world, self.point)
    }

    /// Moves the point of a leg that is held; returns what follows.
    fn reach_held(&self, edits: &mut Edits, to: DVec3) -> Result<Solved, LayerRefusal> {
        let (solved, clip) = (self.solved, &*self.solved.clip);
        let seen = pose(solved, self.frame_idx);
        // Out of reach it is the nearest place that is wanted.
        let wanted = self.at(&ik::turned_world(&clip.skeleton, &seen, &self.turns(&seen, to)));
        let mut source = Vec::new();
        solved.posed.legs.world_rigids(self.walk_frame(), &mut source);
        // Holding moves a foot as one rigid body.
        let end = match self.point.checked_sub(clip.skeleton.n_joints()) {
            None => self.point,
            Some(site) => clip.skeleton.end_sites()[site].idx(),
        };
        let back = source[end] * seen[end].inverse();
        let untouched = edits.clone();
        let near = THERE * clip.facts.height.value;
        let (mut target, mut best) = (wanted, None::<(f64, Edits, Solved)>);
        for _ in 0..=CORRECTIONS {
            edits.clone_from(&untouched);
            let turns = self.turns(&source, back.point(target));
            if let Err(refusal) = key_turns(solved, edits, self.layer_idx, self.frame_idx, &turns) {
                if best.is_none() {
                    return Err(refusal);
                }
                break;
            }
            let made = solve(&solved.source, &Arc::new(edits.clone()), Some(solved));
            let off = self.at(&pose(&made, self.frame_idx)) - wanted;
            let is_better = best.as_ref().is_none_or(|(least, ..)| off.length() < *least);
            if is_better {
                best = Some((off.length(), edits.clone(), made));
            }
            if !is_better || off.length() < near {
                break;
            }
            target -= off;
        }
        let (_, keyed, made) = best.expect("the first try is the best so far");
        *edits = keyed;
        Ok(made)
    }

    /// Returns the frame of what walks that the edited frame shows.
    fn walk_frame(&self) -> usize {
        self.solved.walk.source_frame(self.frame_idx)
    }
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
