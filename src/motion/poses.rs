//! Local transforms of every joint at every frame.
//!
//! Rotations are frames × joints, frame-major. Translations are kept only for the joints whose position channels can
//! change them, frames × moving joints; the others stand at their OFFSET for good.

use glam::{DQuat, DVec3};

use crate::math::Rigid;

/// Local transforms, joints in the skeleton's order. Frames here are file frames.
#[derive(Clone, Debug)]
pub(super) struct Poses {
    pub(super) n_joints: usize,
    /// At least 1.
    pub(super) n_frames: usize,
    /// Frames × joints.
    pub(super) rotations: Vec<DQuat>,
    /// Column of a joint in `translations`; none for a joint that stays at its offset.
    pub(super) columns: Vec<Option<usize>>,
    /// Translation of the joints without a column; for the others what they have where the file is silent.
    pub(super) fixed: Vec<DVec3>,
    /// Number of columns.
    pub(super) n_columns: usize,
    /// Frames × columns.
    pub(super) translations: Vec<DVec3>,
}

impl Poses {
    /// Returns one frame's rotations, one per joint.
    pub(super) fn rotations(&self, frame: usize) -> &[DQuat] {
        &self.rotations[frame * self.n_joints..][..self.n_joints]
    }

    /// Returns where a joint stands in its parent's space.
    pub(super) fn translation(&self, frame: usize, joint: usize) -> DVec3 {
        match self.columns[joint] {
            Some(column) => self.translations[frame * self.n_columns + column],
            None => self.fixed[joint],
        }
    }

    /// Returns the local transform of a joint.
    pub(super) fn local(&self, frame: usize, joint: usize) -> Rigid {
        Rigid::new(self.rotations[frame * self.n_joints + joint], self.translation(frame, joint))
    }

    /// Returns the same joints with these frames, one after the other.
    pub(super) fn rearranged(&self, frames: impl Iterator<Item = usize>) -> Self {
        let mut poses = Self {
            n_frames: 0,
            rotations: Vec::new(),
            translations: Vec::new(),
            columns: self.columns.clone(),
            fixed: self.fixed.clone(),
            ..*self
        };
        for frame in frames {
            poses.n_frames += 1;
            poses.rotations.extend_from_slice(self.rotations(frame));
            poses.translations.extend_from_slice(&self.translations[frame * self.n_columns..][..self.n_columns]);
        }
        poses
    }

    /// Turns a joint at one frame.
    pub(super) fn set_rotation(&mut self, frame: usize, joint: usize, rotation: DQuat) {
        self.rotations[frame * self.n_joints + joint] = rotation;
    }

    /// Moves a joint at one frame.
    ///
    /// # Panics
    ///
    /// When the joint has no position channel.
    pub(super) fn set_translation(&mut self, frame: usize, joint: usize, translation: DVec3) {
        let column = self.columns[joint].expect("a joint that moves has position channels");
        self.translations[frame * self.n_columns + column] = translation;
    }

    /// Applies a rotation after a joint's local transform, at every frame.
    pub(super) fn premultiply(&mut self, joint: usize, rotation: DQuat) {
        for row in self.rotations.chunks_exact_mut(self.n_joints) {
            row[joint] = rotation * row[joint];
        }
        self.map_translations(joint, |t| rotation * t);
    }

    /// Changes a joint's translation at every frame.
    pub(super) fn map_translations(&mut self, joint: usize, map: impl Fn(DVec3) -> DVec3) {
        self.fixed[joint] = map(self.fixed[joint]);
        if let Some(column) = self.columns[joint] {
            for row in self.translations.chunks_exact_mut(self.n_columns) {
                row[column] = map(row[column]);
            }
        }
    }
}
