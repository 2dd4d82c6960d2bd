//! `Clip`: a skeleton and its poses in y-up world space.
//!
//! Frames count from the first frame after the rest frames unless a name says `file`.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::{
    EditedClip,
    angles::{Angles, RotationOrder},
    facts::Facts,
    kinematics::{self, Walk},
    poses::Poses,
    still::Length,
    tracks::PointTracks,
};
use crate::{
    math::Rigid,
    skeleton::{JointId, Skeleton},
};

/// A skeleton and its poses, y-up, in the clip's length unit, at least one frame, without NaN.
#[derive(Clone, Debug)]
pub struct Clip {
    /// The joint tree; offsets in y-up axes for roots, in joint space below.
    pub skeleton: Skeleton,
    /// Seconds from one frame to the next; positive.
    pub frame_time_secs: f64,
    /// What was found out.
    pub facts: Facts,
    /// Where the number of frames comes from.
    pub length: Length,
    /// What deserves the user's eye, one line each.
    pub warnings: Vec<String>,
    /// Rest frames included. Invariant: more frames than `facts.rest_frames`.
    pub(super) poses: Poses,
    pub(super) angles: Angles,
}

impl Clip {
    /// Makes a clip of what an edited clip shows: the same skeleton and facts, rest frames as they were, then its frames.
    pub fn rearranged(edited: &EditedClip) -> Self {
        let clip = &*edited.clip;
        Self {
            skeleton: clip.skeleton.clone(),
            frame_time_secs: clip.frame_time_secs,
            facts: clip.facts.clone(),
            length: clip.length,
            warnings: clip.warnings.clone(),
            poses: edited.poses(),
            angles: clip.angles.of_other_frames(),
        }
    }

    /// Returns the number of frames, rest frames not counted; at least 1.
    pub fn n_frames(&self) -> usize {
        self.poses.n_frames - self.rest_frames()
    }

    /// Returns the number of leading rest frames.
    pub fn rest_frames(&self) -> usize {
        self.facts.rest_frames.value
    }

    /// Returns the number of frames with the rest frames; at least 1. For a file without motion of its own they are as
    /// many as [`Length`] says, else the file's.
    pub fn n_file_frames(&self) -> usize {
        self.poses.n_frames
    }

    /// Returns the frame's index in the file.
    pub fn file_frame(&self, frame: usize) -> usize {
        frame + self.rest_frames()
    }

    /// Tells whether the file can give a joint any rotation: it has one channel about each axis.
    pub fn turns_freely(&self, joint_idx: usize) -> bool {
        self.angles.order(joint_idx).is_some()
    }

    /// Returns how a joint's three rotation channels turn it; none unless it [turns freely](Self::turns_freely).
    pub fn rotation_order(&self, joint_idx: usize) -> Option<RotationOrder> {
        self.angles.order(joint_idx)
    }

    /// Returns a joint's rotation channels at every frame, degrees, in the file's order and continuous over the frames.
    ///
    /// The first frame's are the file's own. From there on each frame has the file's values up to whole turns, or the
    /// other triple of the same pose where the file changes from one to the other: values that follow one another can
    /// be interpolated, filtered and added to.
    ///
    /// # Panics
    ///
    /// When the joint does not [turn freely](Self::turns_freely).
    pub fn rotation_degrees(&self, joint_idx: usize) -> Vec<[f64; 3]> {
        if let Some(order) = self.angles.order(joint_idx).filter(|_| !self.angles.are_of_these_frames()) {
            let mut near = [0.0; 3];
            return (0..self.n_frames())
                .map(|frame| {
                    near = order.nearest_degrees(self.rotations(frame)[joint_idx], near);
                    near
                })
                .collect();
        }
        self.angles.degrees(joint_idx, self.rest_frames()..self.n_file_frames())
    }

    /// Returns the local rotations of all joints at a frame.
    pub fn rotations(&self, frame: usize) -> &[DQuat] {
        self.poses.rotations(self.file_frame(frame))
    }

    /// Returns where a joint stands in its parent's space at a frame.
    pub fn translation(&self, frame: usize, joint_idx: usize) -> DVec3 {
        self.poses.translation(self.file_frame(frame), joint_idx)
    }

    /// Returns a joint's local transform at a frame.
    pub fn local(&self, frame: usize, joint_idx: usize) -> Rigid {
        self.poses.local(self.file_frame(frame), joint_idx)
    }

    /// Fills `out` with the world motions of all joints at a frame.
    pub fn world_rigids(&self, frame: usize, out: &mut Vec<Rigid>) {
        kinematics::world_rigids(&self.skeleton, &self.poses, self.file_frame(frame), out);
    }

    /// Fills `out` with the world positions of all points at a frame: joints, then end sites.
    pub fn world_points(&self, frame: usize, out: &mut Vec<DVec3>) {
        let mut rigids = Vec::with_capacity(self.skeleton.n_joints());
        self.world_rigids(frame, &mut rigids);
        kinematics::points(&self.skeleton, &rigids, out);
    }

    /// Fills `out` with the world positions of all points at a frame of the file, rest frames counted.
    pub fn world_points_of_file(&self, file_frame: usize, out: &mut Vec<DVec3>) {
        let mut rigids = Vec::with_capacity(self.skeleton.n_joints());
        kinematics::world_rigids(&self.skeleton, &self.poses, file_frame, &mut rigids);
        kinematics::points(&self.skeleton, &rigids, out);
    }

    /// Fills `out` with the world positions of all points at a frame with every rotation channel 0: the normal skeleton,
    /// its joints apart as at that frame.
    pub fn unturned_points(&self, frame: usize, out: &mut Vec<DVec3>) {
        let mut rigids = Vec::with_capacity(self.skeleton.n_joints());
        let roots = self.facts.up.value.world_rotation();
        kinematics::world_rigids_unturned(&self.skeleton, &self.poses, self.file_frame(frame), roots, &mut rigids);
        kinematics::points(&self.skeleton, &rigids, out);
    }

    /// Returns where the carrier is at a frame, in the world.
    pub fn carrier_world(&self, frame: usize) -> Rigid {
        kinematics::world_of(&self.skeleton, &self.poses, self.file_frame(frame), self.facts.carrier.value)
    }

    /// Returns where the carrier is at every frame, in the world.
    pub fn carrier_track(&self) -> Vec<Rigid> {
        self.joint_track(self.facts.carrier.value)
    }

    /// Returns where a joint is at every frame, in the world.
    pub fn joint_track(&self, joint: JointId) -> Vec<Rigid> {
        Walk::chain(&self.skeleton, joint).last_rigids(&self.poses, self.rest_frames()..self.n_file_frames())
    }

    /// Calls `visit` with the world positions of all points, one stretch of frames after the other, in order.
    ///
    /// A whole clip in the memory of one stretch: the way to reduce positions to something smaller. Each call gets the
    /// stretch's frames; frame `i` of its tracks is the `i`-th of them.
    pub fn visit_world(&self, mut visit: impl FnMut(Range<usize>, &PointTracks)) {
        let rest = self.rest_frames();
        Walk::whole(&self.skeleton).visit(&self.poses, rest..self.n_file_frames(), |frames, tracks| {
            visit(frames.start - rest..frames.end - rest, tracks);
        });
    }

    /// Returns the world positions of all points at every frame.
    pub fn world_tracks(&self) -> PointTracks {
        Walk::whole(&self.skeleton).tracks(&self.poses, self.rest_frames()..self.n_file_frames())
    }
}

/// The body as its carrier sees it: every point of the carrier's subtree, in the carrier's own space, at every frame.
///
/// An edited clip moves the carrier and leaves this alone, so `carrier_world.point(relative)` is all there is to its
/// points.
#[derive(Clone, Debug)]
pub struct CarrierRelative {
    /// Skeleton's point index of each point here; the carrier comes first.
    pub points: Vec<usize>,
    /// Positions in the carrier's space, by the order of `points`.
    pub tracks: PointTracks,
}

/// Computes the carrier's body in the carrier's space. One pass over the clip; keep the result.
pub fn carrier_relative(clip: &Clip) -> CarrierRelative {
    let walk = Walk::below(&clip.skeleton, clip.facts.carrier.value);
    let tracks = walk.tracks(&clip.poses, clip.rest_frames()..clip.n_file_frames());
    CarrierRelative { points: walk.points, tracks }
}
