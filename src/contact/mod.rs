//! Foot plants: when each foot stands on the ground (METHOD 6.1).
//!
//! Plants are found on the source clip ([`Detection`]), before any edit; the user's own plants ([`PlantEdit`]) replace
//! what they overlap. A key press changes a list of plants by a [`PlantChange`]; [`recorded`] turns the list back into
//! edits. Where the feet stand tells how the ground slopes ([`GroundSlope`]). Frames here are the clip's, rest frames not
//! counted, unless a name says `file`.

mod change;
mod detect;
mod edits;
mod ground;

use serde::{Deserialize, Serialize};

use crate::motion::Leg;

pub use change::PlantChange;
pub use detect::{Detection, Thresholds};
pub use edits::{FileFrames, PlantEdit, PlantEditMode, merged, recorded, with_edits};
pub use ground::{GroundSlope, ground_share};

/// What is to be done with a plant.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum PlantMode {
    /// Carried as one rigid piece: the foot slides as in the source, no more.
    #[default]
    Hold,
    /// Carried, and the foot's own slide inside the plant removed.
    Clean,
    /// An intended slide: left to plain path editing and out of the measures.
    Slide,
}

/// A stretch of frames over which a foot stands.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Plant {
    /// First frame.
    pub first: usize,
    /// Last frame, at least `first`.
    pub last: usize,
    /// What is to be done with it.
    pub mode: PlantMode,
}

impl Plant {
    /// Makes a plant that is held.
    pub const fn new(first: usize, last: usize) -> Self {
        Self { first, last, mode: PlantMode::Hold }
    }

    /// Returns the number of frames, at least 1.
    pub fn n_frames(&self) -> usize {
        self.last - self.first + 1
    }

    /// Tells whether the frame lies in the plant.
    pub fn contains(&self, frame: usize) -> bool {
        (self.first..=self.last).contains(&frame)
    }
}

/// The plants of one foot.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct FootPlants {
    /// The foot's leg.
    pub leg: Leg,
    /// In order of time, with at least one frame between two of them.
    pub plants: Vec<Plant>,
}

impl FootPlants {
    /// Returns the index of the plant that holds the frame.
    pub fn at(&self, frame: usize) -> Option<usize> {
        let after = self.plants.partition_point(|plant| plant.first <= frame);
        after.checked_sub(1).filter(|&idx| self.plants[idx].contains(frame))
    }
}
