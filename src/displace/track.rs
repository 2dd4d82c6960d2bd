//! One joint over the clip or a few of its frames, while layers are laid on it.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::{
    Interpolation, Keys, Layer, euler, slerp,
    spline::{self, Curve},
};
use crate::{
    motion::{Clip, RotationOrder},
    skeleton::JointId,
};

/// A joint's local rotations at frames of the clip, and its channel angles where they are known.
pub(super) struct Track<'a> {
    clip: &'a Clip,
    joint: usize,
    order: RotationOrder,
    /// The clip's frames that it has; all of them where angles are asked for.
    frames: Range<usize>,
    /// None: still the clip's own.
    rotations: Option<Vec<DQuat>>,
    /// Angles of the rotations, degrees, continuous; none: not asked for yet.
    degrees: Option<Vec<[f64; 3]>>,
}

impl<'a> Track<'a> {
    /// Begins at some frames with rotations, or with the clip's own.
    ///
    /// # Panics
    ///
    /// When the joint does not turn freely.
    pub(super) fn new(clip: &'a Clip, joint: JointId, rotations: Option<Vec<DQuat>>, frames: Range<usize>) -> Self {
        let joint = joint.idx();
        let order = clip.rotation_order(joint).expect("only joints that turn freely have maps");
        Self { clip, joint, order, frames, rotations, degrees: None }
    }

    /// Returns the rotation at a frame of the clip.
    pub(super) fn rotation(&self, frame: usize) -> DQuat {
        match &self.rotations {
            Some(rotations) => rotations[frame - self.frames.start],
            None => self.clip.rotations(frame)[self.joint],
        }
    }

    /// Returns the rotations at some of its frames, if they may differ from the clip's own.
    pub(super) fn into_rotations(self, frames: Range<usize>) -> Option<Vec<DQuat>> {
        let mut rotations = self.rotations?;
        rotations.truncate(frames.end - self.frames.start);
        rotations.drain(..frames.start - self.frames.start);
        Some(rotations)
    }

    /// Lays a layer's map on the joint; frames at which it is no turn keep their bits.
    pub(super) fn lay(&mut self, layer: &Layer, keys: &Keys<DQuat>) {
        let weight = layer.effect();
        if weight == 0.0 || keys.iter().all(|key| key.value.xyz() == DVec3::ZERO) {
            return;
        }
        match layer.interpolation.curve() {
            None => self.turn(keys, weight),
            Some(curve) => self.offset(keys, curve, weight),
        }
    }

    /// Returns the map's value, without weight, at a frame of the clip: what a key there has to hold to change nothing.
    pub(super) fn value(&mut self, interpolation: Interpolation, keys: &Keys<DQuat>, frame: usize) -> DQuat {
        let file_frame = self.clip.file_frame(frame);
        if let Some(value) = keys.get(file_frame) {
            return value;
        }
        if keys.is_empty() {
            return DQuat::IDENTITY;
        }
        let Some(curve) = interpolation.curve() else { return slerp::Turns::new(keys).at(file_frame) };
        let offset = spline::values(&self.offsets(keys), curve, file_frame..file_frame + 1)[0];
        self.turn_of_offset(frame, offset)
    }

    /// Returns a map's channel offsets, degrees and without weight, at the clip's frames.
    pub(super) fn channel_offsets(&mut self, curve: Curve, keys: &Keys<DQuat>) -> Vec<DVec3> {
        if keys.is_empty() {
            return vec![DVec3::ZERO; self.clip.n_frames()];
        }
        spline::values(&self.offsets(keys), curve, self.clip.rest_frames()..self.clip.n_file_frames())
    }

    /// Returns the turn, on the right, that adding an offset to the channels is at a frame of the clip.
    pub(super) fn turn_of_offset(&mut self, frame: usize, offset: DVec3) -> DQuat {
        if offset == DVec3::ZERO {
            return DQuat::IDENTITY;
        }
        let degrees = euler::added(self.degrees()[frame], offset, 1.0);
        slerp::short_way(self.rotation(frame).conjugate() * self.order.rotation(degrees)).normalize()
    }

    /// Returns the channel offset of a turn at a frame of the clip, degrees.
    pub(super) fn offset_of_turn(&mut self, frame: usize, turn: DQuat) -> DVec3 {
        let degrees = self.degrees()[frame];
        euler::offset(self.order, degrees, self.rotation(frame), turn)
    }

    fn turn(&mut self, keys: &Keys<DQuat>, weight: f64) {
        let (clip, joint, frames) = (self.clip, self.joint, self.frames.clone());
        let own = || frames.clone().map(|frame| clip.rotations(frame)[joint]).collect();
        let rotations = self.rotations.get_or_insert_with(own);
        let (first, end) = (clip.file_frame(frames.start), clip.file_frame(frames.end));
        let multiply = |frame: usize, turn: DQuat| {
            if turn.xyz() != DVec3::ZERO {
                let rotation = &mut rotations[frame - first];
                *rotation *= turn;
            }
        };
        slerp::Turns::new(keys).visit(weight, first..end, multiply);
        self.degrees = None;
    }

    fn offset(&mut self, keys: &Keys<DQuat>, curve: Curve, weight: f64) {
        let offsets = self.channel_offsets(curve, keys);
        let sums = self.degrees().iter().zip(&offsets).map(|(&degrees, &by)| euler::added(degrees, by, weight));
        let sums: Vec<[f64; 3]> = sums.collect();
        let mut rotations = self.order.rotations(&sums);
        for (frame, _) in offsets.iter().enumerate().filter(|(_, by)| **by == DVec3::ZERO) {
            rotations[frame] = self.rotation(frame);
        }
        self.rotations = Some(rotations);
        self.degrees = Some(sums);
    }

    /// Returns the keys as channel offsets; a key outside the clip is read at the clip's nearest frame.
    fn offsets(&mut self, keys: &Keys<DQuat>) -> Vec<super::Key<DVec3>> {
        self.degrees();
        let degrees = self.degrees.as_ref().expect("just made");
        let (rest, last) = (self.clip.rest_frames(), self.clip.n_frames() - 1);
        euler::offsets(self.order, keys, |file_frame| {
            let frame = file_frame.saturating_sub(rest).min(last);
            (degrees[frame], self.rotation(frame))
        })
    }

    /// Returns the angles of the rotations; the first frame's are the nearest to the file's own.
    fn degrees(&mut self) -> &[[f64; 3]] {
        assert_eq!(self.frames.len(), self.clip.n_frames(), "whoever needs angles has the whole clip");
        let (clip, joint, order) = (self.clip, self.joint, self.order);
        let rotations = &self.rotations;
        self.degrees.get_or_insert_with(|| {
            let own = clip.rotation_degrees(joint);
            let Some(rotations) = rotations else { return own };
            let mut near = own[0];
            let continued = rotations.iter().map(|&rotation| {
                near = order.nearest_degrees(rotation, near);
                near
            });
            continued.collect()
        })
    }
}
