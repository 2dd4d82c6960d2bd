//! The BVH file as it is: parsed without losing a byte, written back without changing one that was not edited.
//!
//! Angles here are degrees, positions the file's own unit and axes; [`crate::motion`] turns both into poses. The
//! source text is kept, so that writing is copying: only rows and channels that changed are printed anew.

/// What one channel number does to its joint.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub enum Channel {
    /// Position along the file's x axis.
    Xposition,
    /// Position along the file's y axis.
    Yposition,
    /// Position along the file's z axis.
    Zposition,
    /// Rotation about the joint's x axis, degrees.
    Xrotation,
    /// Rotation about the joint's y axis, degrees.
    Yrotation,
    /// Rotation about the joint's z axis, degrees.
    Zrotation,
}

/// One joint as the header declares it.
#[derive(Clone, Debug, PartialEq)]
pub struct BvhJoint {
    /// Name as written; may hold spaces and need not be unique.
    pub name: String,
    /// Index of the parent joint, always smaller than this joint's; none for a ROOT.
    pub parent: Option<usize>,
    /// OFFSET, in the file's unit and axes.
    pub offset: [f64; 3],
    /// Channels in the order of the file.
    pub channels: Vec<Channel>,
    /// Index of this joint's first channel in a frame's row.
    pub first_channel: usize,
    /// OFFSET of the End Site, if there is one.
    pub end_site: Option<[f64; 3]>,
}

/// A parsed file: its text, its tree and its numbers.
#[derive(Clone, Debug)]
pub struct Bvh {
    // text, row spans, warnings … private
    joints: Vec<BvhJoint>,
    n_channels: usize,
    frame_time_secs: f64,
    /// frames × channels, frame-major.
    values: Vec<f64>,
}

impl Bvh {
    /// Returns the joints, parents first, in the order of the file.
    pub fn joints(&self) -> &[BvhJoint] {
        &self.joints
    }

    /// Returns the number of channels of a frame.
    pub fn n_channels(&self) -> usize {
        self.n_channels
    }

    /// Returns the number of frames that were read.
    pub fn n_frames(&self) -> usize {
        self.values.len().checked_div(self.n_channels).unwrap_or(0)
    }

    /// Returns the seconds from one frame to the next, as written.
    pub fn frame_time_secs(&self) -> f64 {
        self.frame_time_secs
    }

    /// Returns one frame's channel values.
    pub fn frame(&self, frame_idx: usize) -> &[f64] {
        &self.values[frame_idx * self.n_channels..][..self.n_channels]
    }

    /// Returns all values, frames × channels, frame-major.
    pub fn values(&self) -> &[f64] {
        &self.values
    }
}
