//! Editing a pose: what is wanted of it at one frame becomes keys of a layer.
//!
//! Joints are moved in the pose that is seen. Where legs that are held hang on them, holding has the last word, and what
//! it does is corrected after a solve. What a held leg's own joints do is seen only after its foot has been held, so a
//! leg is moved where holding takes it from, on the original path, towards the place that holding takes to the target.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{Edits, LayerRefusal, Solved, layers::editable, solve, solve::draft};
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
const THERE: f64 = 5e-5;
/// Corrections of a foot that is held, at most.
const CORRECTIONS: usize = 4;
/// Corrections of what holding the feet does to a hand, at most: two do for all but a body that turns over.
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
        let skeleton = &self.solved.clip.skeleton;
        let mut legs = self.solved.posed.prepared.legs();
        self.solved.holding.is_none() || !legs.any(|leg| skeleton.is_within(leg.ankle, joint))
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

    /// Moves the point by joints of which some bear legs that are held; returns what follows.
    ///
    /// All joints turn in the pose that is seen. Holding the feet then takes the carrier a little elsewhere, and what is
    /// missing is left to the joints that bear no leg: they move no foot, so it is exact. Only what they cannot do is
    /// done by all once more.
    fn reach_beside(&self, edits: &mut Edits, to: DVec3) -> Result<Solved, LayerRefusal> {
        let near = THERE * self.solved.clip.facts.height.value;
        let free: Vec<JointId> = self.chain.iter().copied().filter(|&joint| self.is_free(joint)).collect();
        let turns = self.turns(&self.chain, &pose(self.solved, self.frame_idx), to);
        key_turns(self.solved, edits, self.layer_idx, self.frame_idx, &turns)?;
        let mut made = draft(&Arc::new(edits.clone()), self.solved);
        for _ in 0..BODY_CORRECTIONS {
            let world = pose(&made, self.frame_idx);
            let turns = self.turns(&self.chain, &world, to);
            let nearest = self.after(&world, &turns);
            if self.at(&world).distance(nearest) < near {
                break;
            }
            let free_turns = self.turns(&free, &world, to);
            if self.after(&world, &free_turns).distance(nearest) < near {
                key_turns(&made, edits, self.layer_idx, self.frame_idx, &free_turns)?;
                break;
            }
            key_turns(&made, edits, self.layer_idx, self.frame_idx, &turns)?;
            made = draft(&Arc::new(edits.clone()), &made);
        }
        Ok(solve(&made.source, &Arc::new(edits.clone()), Some(&made)))
    }

    /// Returns where the point is in a pose.
    fn at(&self, world: &[Rigid]) -> DVec3 {
        ik::point_position(&self.solved.clip.skeleton, world, self.point)
    }

    /// Moves the point of a leg that is held; returns what follows.
    ///
    /// What is missing after a try is tried again from there.
    fn reach_held(&self, edits: &mut Edits, to: DVec3) -> Result<Solved, LayerRefusal> {
        let skeleton = &self.solved.clip.skeleton;
        // Holding moves a foot as one rigid body.
        let end = match self.point.checked_sub(skeleton.n_joints()) {
            None => self.point,
            Some(site) => skeleton.end_sites()[site].idx(),
        };
        let near = THERE * self.solved.clip.facts.height.value;
        let (mut least, mut best) = (f64::INFINITY, None::<Solved>);
        for _ in 0..=CORRECTIONS {
            let now = best.as_ref().unwrap_or(self.solved);
            let seen = pose(now, self.frame_idx);
            let mut source = Vec::new();
            now.posed.legs.world_rigids(now.walk.source_frame(self.frame_idx), &mut source);
            let back = source[end] * seen[end].inverse();
            let turns = self.turns(&self.chain, &source, back.point(to));
            let mut tried = (*now.edits).clone();
            if best.is_none() {
                tried.clone_from(edits);
            }
            key_turns(now, &mut tried, self.layer_idx, self.frame_idx, &turns)?;
            let made = draft(&Arc::new(tried), now);
            let off = self.at(&pose(&made, self.frame_idx)).distance(to);
            if off >= least {
                break;
            }
            (least, best) = (off, Some(made));
            if off < near {
                break;
            }
        }
        let made = best.expect("the first try is the best so far");
        edits.clone_from(&made.edits);
        Ok(solve(&made.source, &made.edits, Some(&made)))
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
