//! Quality numbers of an edited clip beside its source (METHOD 9).
//!
//! Those of feet need plants and are taken apart ([`FootMeasure`]).
//!
//! What costs most is looking at every joint of every frame. That is done once for the source ([`Body`], kept with
//! the clip) and once for each result ([`Body::look`]), from where the source's points are: an edit moves them in few
//! rigid pieces.

mod feet;
mod placed;
mod seam;
mod sweep;

use glam::DVec3;

pub use feet::{FootMeasure, FootNumbers, FootTracks, PlantSteps};
pub use placed::Turning;
pub use seam::Seam;
pub use sweep::{Body, Sweep};

use crate::{
    math::Rigid,
    motion::EditedClip,
    path::{NewPath, OriginalPath, Residuals, Timing},
};

/// A source of less mean jerk than this, body heights per second cubed, moves too evenly to be compared with. People
/// who stand still in captured clips have 1.9, who walk 30 and more.
const LEAST_JERK: f64 = 0.5;

/// A mean third difference below this share of the body height is rounding, not motion.
const ROUNDING: f64 = 1e-9;

/// A number of the source and of the edited clip.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pair {
    /// Of the clip as loaded.
    pub source: f64,
    /// Of the edited clip.
    pub edited: f64,
}

/// Quality numbers; what cannot be measured is none.
#[derive(Clone, Debug, PartialEq)]
pub struct Measures {
    /// Body height: median over frames of the highest minus the lowest point, the clip's unit.
    pub height: Pair,
    /// Length of the original path and of the path walked, by the integrator in use, the clip's unit.
    pub path_length: Pair,
    /// Root mean square of what the original path leaves over, body heights, y-up world axes.
    pub residual_rms: DVec3,
    /// Mean norm of the third difference of all joints' world positions, edited over source; none for fewer than four
    /// frames on either side and for a source next to without any (below 0.5 H/s³).
    pub jerk_ratio: Option<f64>,
    /// Largest distance between the edited carrier with its residual removed and the path at the same arc length,
    /// body heights; none while the path is not edited.
    pub path_error: Option<f64>,
    /// Steps where a cycle meets the next one.
    pub seam: Vec<Seam>,
}

/// What the numbers are taken from.
#[derive(Clone, Copy, Debug)]
pub struct Measured<'a> {
    /// The body of the clip as loaded.
    pub source: &'a Body,
    /// What a look at the edited clip gave.
    pub sweep: Sweep,
    /// The edited clip.
    pub edited: &'a EditedClip,
    /// Its carrier without what layers do; none while no new path is walked.
    pub carried: Option<&'a [Rigid]>,
    /// The path fitted to the clip.
    pub original: &'a OriginalPath,
    /// What it leaves over.
    pub residuals: &'a Residuals,
    /// Arc length of each frame of the clip as loaded on the original path.
    pub progress: &'a [f64],
    /// The new path.
    pub new_path: &'a NewPath,
    /// Where the edited frames stand on it.
    pub timing: &'a Timing,
}

impl Measured<'_> {
    /// Takes the numbers.
    pub fn measures(&self) -> Measures {
        let height = self.original.height();
        let source = self.source.source();
        // Without an edit the frames are the source's, and so are the numbers.
        let is_source = self.edited.carrier_world.is_empty() && self.edited.turned.is_empty();
        let sweep = if is_source { source } else { self.sweep };
        let least_jerk = height * (LEAST_JERK * self.edited.clip.frame_time_secs.powi(3)).max(ROUNDING);
        let jerk_ratio = match (sweep.mean_jerk, source.mean_jerk) {
            (Some(edited), Some(source)) if source > least_jerk => Some(edited / source),
            _ => None,
        };
        Measures {
            height: Pair { source: source.height, edited: sweep.height },
            path_length: Pair { source: self.progress[self.progress.len() - 1], edited: self.timing.path_length },
            residual_rms: self.original.deviation_rms() / height,
            jerk_ratio,
            path_error: self.carried.map(|carried| self.path_error(carried) / height),
            seam: seam::seams(self.edited, &self.timing.seams, height),
        }
    }

    /// Returns the largest distance from the path, the clip's unit.
    fn path_error(&self, carriers: &[Rigid]) -> f64 {
        let exact;
        let on_path = if self.timing.is_exact {
            &self.timing.frames
        } else {
            exact = self.new_path.frames_along(&self.timing.arc_lengths);
            &exact
        };
        carriers
            .iter()
            .zip(&self.edited.source_frames)
            .zip(on_path)
            .map(|((carrier, &f), at)| self.residuals.removed(f as usize, carrier).distance_squared(at.point))
            .fold(0.0, f64::max)
            .sqrt()
    }
}
