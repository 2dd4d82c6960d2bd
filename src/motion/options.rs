//! How a file is to be read: the user's word, and what it may say.

use glam::{DQuat, DVec3};
use serde::{Deserialize, Serialize};

use super::LegNames;

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
    /// `clip.length`: frames of a file that has no motion of its own, one frame or none; ignored by all others.
    pub length: Option<usize>,
    /// `clip.rest_frames`: leading frames to leave alone.
    pub rest_frames: Option<usize>,
    /// `clip.legs`: the legs by name; empty: guess. Reading the file does not need them, [`super::find_legs`] does.
    pub legs: Vec<LegNames>,
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
    /// Returns the up direction in the file's axes.
    pub fn direction(self) -> DVec3 {
        match self {
            Self::Y => DVec3::Y,
            Self::Z => DVec3::Z,
        }
    }

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

    /// Returns the rotation that does what [`UpAxis::to_world`] does.
    pub fn world_rotation(self) -> DQuat {
        use std::f64::consts::FRAC_1_SQRT_2;
        match self {
            Self::Y => DQuat::IDENTITY,
            Self::Z => DQuat::from_xyzw(-FRAC_1_SQRT_2, 0.0, 0.0, FRAC_1_SQRT_2),
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

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn up_axes_turn_there_and_back() {
        let v = DVec3::new(1.0, 2.0, 3.0);
        for up in [UpAxis::Y, UpAxis::Z] {
            assert_eq!(up.to_file(up.to_world(v)), v);
            assert_eq!(up.to_world(up.direction()), DVec3::Y);
            assert!((up.world_rotation() * v).abs_diff_eq(up.to_world(v), 1e-15));
        }
    }
}
