//! `EditedClip`: a clip along another path.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{
    Clip,
    kinematics::{self, Instead},
    poses::Poses,
};
use crate::{
    math::{
        Rigid,
        lanes::{LANES, RigidLanes},
    },
    skeleton::JointId,
};

/// A clip along another path: which frame of the clip each frame shows, and where its carrier is.
///
/// Everything not named here is the clip's own: joints outside the carrier's subtree stay where they are. Frames are
/// those that would be exported, rest frames not included.
#[derive(Clone, Debug)]
pub struct EditedClip {
    /// The clip as loaded.
    pub clip: Arc<Clip>,
    /// Clip frame shown at each edited frame, counted without rest frames.
    pub source_frames: Vec<u32>,
    /// World motion of the carrier at each edited frame; empty when the path edit is off or impossible (source poses).
    pub carrier_world: Vec<Rigid>,
    /// Joints below the carrier that turn otherwise than in the clip, each at most once.
    pub turned: Vec<TurnedJoint>,
}

/// A joint with local rotations of its own.
#[derive(Clone, Debug, PartialEq)]
pub struct TurnedJoint {
    /// The joint; one that [`Clip::turns_freely`].
    pub joint: JointId,
    /// Its local rotation at each edited frame.
    pub rotations: Vec<DQuat>,
}

impl EditedClip {
    /// Makes an edited clip that is the clip itself.
    pub fn unedited(clip: Arc<Clip>) -> Self {
        let source_frames = (0..clip.n_frames() as u32).collect();
        Self { clip, source_frames, carrier_world: Vec::new(), turned: Vec::new() }
    }

    /// Returns the number of edited frames.
    pub fn n_frames(&self) -> usize {
        self.source_frames.len()
    }

    /// Returns the frame of the clip that an edited frame shows.
    pub fn source_frame(&self, frame: usize) -> usize {
        self.source_frames[frame] as usize
    }

    /// Returns where the carrier is, in the world.
    pub fn carrier(&self, frame: usize) -> Rigid {
        match self.carrier_world.get(frame) {
            Some(&world) => world,
            None => self.clip.carrier_world(self.source_frame(frame)),
        }
    }

    /// Returns a joint's local rotations where it turns otherwise than in the clip.
    pub fn turned(&self, joint: JointId) -> Option<&[DQuat]> {
        self.turned.iter().find(|turned| turned.joint == joint).map(|turned| &turned.rotations[..])
    }

    /// Returns a joint's local rotation; not for the carrier, whose rotation follows from where it is.
    pub fn rotation(&self, frame: usize, joint: JointId) -> DQuat {
        match self.turned(joint) {
            Some(rotations) => rotations[frame],
            None => self.clip.rotations(self.source_frame(frame))[joint.idx()],
        }
    }

    /// Fills `out` with the world motions of all joints.
    pub fn world_rigids(&self, frame: usize, out: &mut Vec<Rigid>) {
        let file_frame = self.clip.file_frame(self.source_frame(frame));
        let instead = self.instead(frame);
        kinematics::world_rigids_instead(&self.clip.skeleton, &self.clip.poses, file_frame, &instead, out);
    }

    /// Fills in the motions of some joints below the carrier, in its space, at four frames; `out` has a place for every
    /// joint of the skeleton, and the carrier's own moves nothing.
    ///
    /// `joints` come parents first, each with all joints below the carrier that it hangs on.
    pub(crate) fn rigids_in_carrier(&self, frames: [usize; LANES], joints: &[JointId], out: &mut [RigidLanes]) {
        let file_frames = frames.map(|frame| self.clip.file_frame(self.source_frame(frame)));
        let turned = (&self.turned[..], frames);
        kinematics::fill_rigid_lanes(&self.clip.skeleton, &self.clip.poses, file_frames, turned, joints, out);
    }

    fn instead(&self, frame: usize) -> Instead<'_> {
        Instead {
            placed: self.carrier_world.get(frame).map(|&world| (self.clip.facts.carrier.value, world)),
            turned: &self.turned,
            turned_frame: frame,
        }
    }

    /// Fills `out` with the world positions of all points: joints, then end sites.
    pub fn world_points(&self, frame: usize, out: &mut Vec<DVec3>) {
        let mut rigids = Vec::with_capacity(self.clip.skeleton.n_joints());
        self.world_rigids(frame, &mut rigids);
        kinematics::points(&self.clip.skeleton, &rigids, out);
    }

    /// Returns the carrier's local transform, in its parent's space.
    pub fn carrier_local(&self, frame: usize) -> Rigid {
        let carrier = self.clip.facts.carrier.value;
        let source_frame = self.source_frame(frame);
        let Some(&world) = self.carrier_world.get(frame) else { return self.clip.local(source_frame, carrier.idx()) };
        match self.clip.skeleton.joint(carrier).parent {
            None => world,
            Some(parent) => {
                let file_frame = self.clip.file_frame(source_frame);
                kinematics::world_of(&self.clip.skeleton, &self.clip.poses, file_frame, parent).inverse() * world
            }
        }
    }

    /// Returns the local transforms of the clip's rest frames and of all edited frames.
    pub(super) fn poses(&self) -> Poses {
        let clip = &self.clip;
        let rest = 0..clip.rest_frames();
        let edited = self.source_frames.iter().map(|&frame| clip.file_frame(frame as usize));
        let mut poses = clip.poses.rearranged(rest.chain(edited));
        let carrier = clip.facts.carrier.value.idx();
        for frame in 0..self.n_frames() {
            let file_frame = clip.file_frame(frame);
            for turned in &self.turned {
                poses.set_rotation(file_frame, turned.joint.idx(), turned.rotations[frame]);
            }
            if !self.carrier_world.is_empty() {
                let local = self.carrier_local(frame);
                poses.set_rotation(file_frame, carrier, local.rotation);
                poses.set_translation(file_frame, carrier, local.translation);
            }
        }
        poses
    }
}
