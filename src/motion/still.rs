//! Stationary clips: what a file without motion of its own, with one frame or none, is read as.
//!
//! One pose lasts for a chosen number of frames, so that displacement maps have frames to put keys on. A file without
//! frames stands in its rest pose: every channel is 0.

use super::ClipOptions;

/// Frames of a stationary clip whose length nobody chose.
pub const DEFAULT_LENGTH: usize = 120;

/// Most frames a stationary clip can be given.
pub const MAX_LENGTH: usize = 100_000;

/// Most joints × frames of a stationary clip: its memory follows from the user's number and the file's joints together.
const MOST_TRANSFORMS: usize = 20_000_000;

/// Where a clip's number of frames comes from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Length {
    /// The file's own: it has two frames at least.
    Own,
    /// [`DEFAULT_LENGTH`]: the file has one frame or none, and nobody chose.
    Default,
    /// The user's: `clip.length`.
    Chosen,
}

impl Length {
    /// Decides how many frames a file is read as, of its own number of frames; says what is not as it seems.
    pub(super) fn decide(
        n_file_frames: usize,
        n_joints: usize,
        options: &ClipOptions,
        warnings: &mut Vec<String>,
    ) -> (Self, usize) {
        if n_file_frames > 1 {
            if let Some(asked) = options.length {
                warnings
                    .push(format!("clip.length {asked} is not used: the file has {n_file_frames} frames of its own"));
            }
            return (Self::Own, n_file_frames);
        }
        let asked = options.length.unwrap_or(DEFAULT_LENGTH).clamp(1, MAX_LENGTH);
        let n_frames = asked.min(MOST_TRANSFORMS / n_joints.max(1)).max(1);
        if n_frames < asked {
            warnings.push(format!("{asked} frames of {n_joints} joints are too many; the clip has {n_frames}"));
        }
        if options.length.is_some() {
            return (Self::Chosen, n_frames);
        }
        let what = if n_file_frames == 0 { "no frames; its rest pose" } else { "one frame, which" };
        warnings.push(format!("the file has {what} stands for {n_frames} (clip.length)"));
        (Self::Default, n_frames)
    }
}
