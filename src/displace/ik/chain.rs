//! A chain as inverse kinematics sees it: places, bones between them, and how far it reaches.

use glam::{DQuat, DVec3};

use super::{JointTurn, NO_BONE, Reach};
use crate::{
    displace::can_turn,
    math::Rigid,
    motion::Clip,
    skeleton::{JointId, Skeleton},
};

/// Returns the joints that may turn to move a point (a joint, or an end site): the selected ones above it, top first.
///
/// A joint does not move itself, so it is in the chain only for its own end site. Left out are joints to which the file
/// cannot give any rotation and those above the carrier.
pub fn chain(clip: &Clip, point: usize, selected: &[JointId]) -> Vec<JointId> {
    let skeleton = &clip.skeleton;
    let mut found = Vec::new();
    let mut at = skeleton.point_parent(point);
    while let Some(joint) = at {
        let id = JointId(joint as u32);
        if selected.contains(&id) && can_turn(clip, id) {
            found.push(id);
        }
        at = skeleton.point_parent(joint);
    }
    found.reverse();
    found
}

/// Returns where a point (a joint, or an end site) is, given the world motions of all joints.
pub fn point_position(skeleton: &Skeleton, world: &[Rigid], point: usize) -> DVec3 {
    match point.checked_sub(skeleton.n_joints()) {
        None => world[point].translation,
        Some(site) => {
            let joint = skeleton.end_sites()[site];
            world[joint.idx()].point(skeleton.joint(joint).end_site.expect("listed as one that has it"))
        }
    }
}

/// Bones that turn; positions relative to the world.
pub(super) struct Chain {
    /// Where the top joint is.
    pub(super) top: DVec3,
    /// From each joint to the next, the last one to the point.
    bones: Vec<DVec3>,
    /// How each bone has turned so far, in the world.
    turned: Vec<DQuat>,
    /// Length of all bones.
    length: f64,
    /// Nearest and farthest place from the top that the bones allow.
    reach: [f64; 2],
}

impl Chain {
    /// Takes a chain out of a pose; joints at the very end that the point does not feel are left out.
    pub(super) fn new(reach: &Reach) -> Self {
        let mut places: Vec<DVec3> = reach.chain.iter().map(|joint| reach.world[joint.idx()].translation).collect();
        places.push(reach.point);
        let mut bones: Vec<DVec3> = places.windows(2).map(|pair| pair[1] - pair[0]).collect();
        let length: f64 = bones.iter().map(|bone| bone.length()).sum();
        while bones.last().is_some_and(|bone| bone.length() <= NO_BONE * length) {
            bones.pop();
        }
        let longest = bones.iter().map(|bone| bone.length()).fold(0.0, f64::max);
        let turned = vec![DQuat::IDENTITY; bones.len()];
        Self { top: places[0], bones, turned, length, reach: [(2.0 * longest - length).max(0.0), length] }
    }

    pub(super) fn is_empty(&self) -> bool {
        self.bones.is_empty()
    }

    pub(super) fn length(&self) -> f64 {
        self.length
    }

    pub(super) fn bones(&self) -> &[DVec3] {
        &self.bones
    }

    pub(super) fn tip(&self) -> DVec3 {
        self.top + self.bones.iter().sum::<DVec3>()
    }

    /// Returns the place in reach nearest to a target.
    pub(super) fn within_reach(&self, target: DVec3) -> DVec3 {
        let way = target - self.top;
        let distance = way.length();
        let [least, most] = self.reach;
        let allowed = distance.clamp(least, most);
        if allowed == distance {
            return target;
        }
        // Seen from the very top of the chain all places are as near; the one where the point is now is kept.
        let direction = way.try_normalize().or_else(|| (self.tip() - self.top).try_normalize());
        self.top + allowed * direction.unwrap_or(DVec3::Y)
    }

    /// Turns the bones from one on, in the world, about the joint where it begins.
    pub(super) fn turn_all(&mut self, from: usize, turn: DQuat) {
        for (bone, turned) in self.bones[from..].iter_mut().zip(&mut self.turned[from..]) {
            *bone = turn * *bone;
            *turned = turn * *turned;
        }
    }

    /// Turns each joint by a rotation vector in the world, all as they are now.
    pub(super) fn turn_each(&mut self, turns: &[DVec3]) {
        let mut whole = DQuat::IDENTITY;
        for ((bone, turned), &turn) in self.bones.iter_mut().zip(&mut self.turned).zip(turns) {
            whole = (whole * DQuat::from_scaled_axis(turn)).normalize();
            *bone = whole * *bone;
            *turned = (whole * *turned).normalize();
        }
    }

    /// Fills `levers` with the way from each joint to the tip.
    pub(super) fn levers(&self, levers: &mut Vec<DVec3>) {
        levers.clear();
        levers.extend(self.bones.iter().rev().scan(DVec3::ZERO, |way, bone| {
            *way += *bone;
            Some(*way)
        }));
        levers.reverse();
    }

    /// Returns the turns of the joints, on the right of their local rotations.
    pub(super) fn turns(&self, reach: &Reach) -> Vec<JointTurn> {
        let mut above = DQuat::IDENTITY;
        let turn = |(&joint, &turned): (&JointId, &DQuat)| {
            let world = reach.world[joint.idx()].rotation;
            let own = above.conjugate() * turned;
            above = turned;
            JointTurn { joint, turn: (world.conjugate() * own * world).normalize() }
        };
        reach.chain.iter().zip(&self.turned).map(turn).collect()
    }
}
