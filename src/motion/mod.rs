//! Clips: a skeleton and its poses in y-up world space; conversion from and to BVH.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use crate::{
    math::Rigid,
    skeleton::{JointId, Skeleton},
};

/// The user's word on how a file is to be read; `None` means: decide from the numbers.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct ClipOptions {
    /// `clip.carrier`: name of the joint that carries the locomotion.
    pub carrier: Option<String>,
    /// `clip.up`: the file's up axis.
    pub up: Option<UpAxis>,
    /// `clip.root_offset`: what the root's position channels do to its OFFSET.
    pub root_offset: Option<OffsetMeaning>,
    /// `clip.joint_offsets`: what the other joints' position channels do to their OFFSET.
    pub joint_offsets: Option<OffsetMeaning>,
    /// `clip.rest_frames`: leading frames to leave alone.
    pub rest_frames: Option<usize>,
}

/// The file's up axis.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum UpAxis {
    /// +Y up.
    Y,
    /// +Z up.
    Z,
}

impl UpAxis {
    /// Turns a vector of the file's axes into y-up world axes.
    pub fn to_world(self, v: DVec3) -> DVec3 {
        match self {
            Self::Y => v,
            Self::Z => DVec3::new(v.x, v.z, -v.y),
        }
    }

    /// Turns a vector of y-up world axes into the file's axes.
    pub fn to_file(self, v: DVec3) -> DVec3 {
        match self {
            Self::Y => v,
            Self::Z => DVec3::new(v.x, -v.z, v.y),
        }
    }
}

/// What position channels do to OFFSET.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum OffsetMeaning {
    /// Position channels stand in the place of OFFSET.
    Replace,
    /// Position channels are added to OFFSET.
    Add,
}

/// A decision about the clip and the reason for it, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided<T> {
    /// What was decided.
    pub value: T,
    /// Why, in one sentence without a period; says `as asked` when the user's option decided.
    pub why: String,
}

/// What was found out about a clip (METHOD 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// The joint whose position channels carry the locomotion.
    pub carrier: Decided<JointId>,
    /// Whether the carrier has three position and three rotation channels; without them the path cannot be edited.
    pub path_editable: bool,
    /// The file's up axis.
    pub up: Decided<UpAxis>,
    /// Meaning of the root's position channels.
    pub root_offset: Decided<OffsetMeaning>,
    /// Meaning of the other joints' position channels.
    pub joint_offsets: Decided<OffsetMeaning>,
    /// Leading rest frames.
    pub rest_frames: Decided<usize>,
    /// Body height `H` in the clip's unit; positive (1 for a clip without extent).
    pub height: Decided<f64>,
    /// Guessed unit of length: `m`, `cm`, `inch`, `dm`, `CMU 5.6444 cm`, …; none when no guess is near.
    pub unit: Decided<Option<&'static str>>,
    /// Height of the floor under the feet, world, clip's unit (the feet's low percentile).
    pub floor: f64,
}

/// A skeleton and its poses, y-up, without end.
#[derive(Clone, Debug)]
pub struct Clip {
    /// The joint tree; offsets in y-up axes for roots, in joint space below.
    pub skeleton: Skeleton,
    /// Seconds from one frame to the next; positive.
    pub frame_time_secs: f64,
    /// What was found out.
    pub facts: Facts,
    /// What deserves the user's eye, one line each.
    pub warnings: Vec<String>,
    /// Local rotations, frames × joints, frame-major, rest frames included.
    rotations: Vec<DQuat>,
    /// Local translations, frames × joints, frame-major, rest frames included.
    translations: Vec<DVec3>,
}

/// A clip along another path: which frame of the clip each frame shows, and where its carrier is.
///
/// Everything not named here is the clip's own. Frames are those that would be exported, rest frames not included.
#[derive(Clone, Debug)]
pub struct EditedClip {
    /// The clip as loaded.
    pub clip: Arc<Clip>,
    /// Clip frame shown at each edited frame, counted without rest frames.
    pub source_frames: Vec<u32>,
    /// World motion of the carrier at each edited frame; empty when the path edit is off or impossible (source poses).
    pub carrier_world: Vec<Rigid>,
}
