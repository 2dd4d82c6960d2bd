//! The BVH file as it is: parsed without losing a byte, written back without changing one that was not edited.
//!
//! Angles here are degrees, positions the file's own unit and axes; [`crate::motion`] turns both into poses. The
//! source text is kept, so that writing is copying: only rows and channels that changed are printed anew.

mod cursor;
mod error;
mod hierarchy;
mod number;
mod parse;
mod row_of_zeros;
mod rows;
mod write;

use std::{ops::Range, sync::Arc};

pub use error::{Expected, Found, ParseError, Warning, WarningKind};
pub use write::{Digits, RowEdit};

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

impl Channel {
    /// Names as the format has them, in the order of the variants.
    const NAMES: [(&'static str, Self); 6] = [
        ("Xposition", Self::Xposition),
        ("Yposition", Self::Yposition),
        ("Zposition", Self::Zposition),
        ("Xrotation", Self::Xrotation),
        ("Yrotation", Self::Yrotation),
        ("Zrotation", Self::Zrotation),
    ];

    /// Returns the channel of this name, in any case.
    fn from_name(name: &[u8]) -> Option<Self> {
        let (_, channel) = Self::NAMES.iter().find(|(n, _)| name.eq_ignore_ascii_case(n.as_bytes()))?;
        Some(*channel)
    }

    /// Tells whether the channel moves its joint rather than turning it.
    pub fn is_position(self) -> bool {
        matches!(self, Self::Xposition | Self::Yposition | Self::Zposition)
    }
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
    text: Arc<[u8]>,
    joints: Vec<BvhJoint>,
    n_channels: usize,
    /// None without MOTION, and when the number is no count.
    declared_frames: Option<u64>,
    /// The number after `Frames:`; empty at 0 without MOTION.
    frame_count_span: Range<usize>,
    frame_time_secs: f64,
    /// Where the motion's two opening lines have been read to; rows begin after it.
    rows_from: usize,
    /// Frames × channels, frame-major.
    values: Arc<Vec<f64>>,
    /// One for each frame, rising: where its values stand in the text.
    row_spans: Vec<Range<usize>>,
    warnings: Vec<Warning>,
}

impl Bvh {
    /// Returns the file's bytes, as they were read.
    pub fn text(&self) -> &Arc<[u8]> {
        &self.text
    }

    /// Returns what is odd about the file, in the order of its lines.
    pub fn warnings(&self) -> &[Warning] {
        &self.warnings
    }

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
        self.row_spans.len()
    }

    /// Returns the number after `Frames:`; none when the file has no such count.
    pub fn declared_frames(&self) -> Option<u64> {
        self.declared_frames
    }

    /// Tells whether the file has a MOTION section.
    pub fn has_motion(&self) -> bool {
        !self.frame_count_span.is_empty()
    }

    /// Returns the seconds from one frame to the next, as written: not always positive, and 0 without MOTION.
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

    /// Returns all values for someone who keeps them.
    pub fn shared_values(&self) -> Arc<Vec<f64>> {
        Arc::clone(&self.values)
    }
}
