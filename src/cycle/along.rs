//! A clip on its original path, one frame longer than it is.

use crate::path::PathFrame;

/// A range of frames to repeat: shown again as soon as it ends.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash)]
pub struct LoopRange {
    /// First frame.
    pub first: usize,
    /// The frame after the last one; at most the number of the clip's frames.
    pub end: usize,
}

impl LoopRange {
    /// Returns the number of frames of one cycle.
    pub fn n_frames(self) -> usize {
        self.end - self.first
    }

    /// Returns the share of frames in common with another range, of those in either.
    pub(super) fn overlap(self, other: Self) -> f64 {
        let both = self.end.min(other.end).saturating_sub(self.first.max(other.first));
        both as f64 / (self.n_frames() + other.n_frames() - both) as f64
    }
}

/// A path and the arc lengths of its frames, carried on by one frame so that a range may end with the clip.
#[derive(Clone, Copy, Debug)]
pub(super) struct Along<'a> {
    path: &'a [PathFrame],
    progress: &'a [f64],
    beyond: (PathFrame, f64),
}

impl<'a> Along<'a> {
    /// Carries a path of at least one frame on as it went from the last frame but one to the last.
    pub(super) fn new(path: &'a [PathFrame], progress: &'a [f64]) -> Self {
        assert!(!path.is_empty() && path.len() == progress.len(), "a path frame and an arc length for each frame");
        let last = path.len() - 1;
        let (from, to) = (path[last.saturating_sub(1)], path[last]);
        let beyond = PathFrame {
            point: 2.0 * to.point - from.point,
            heading_rad: 2.0 * to.heading_rad - from.heading_rad,
            slope_rad: 2.0 * to.slope_rad - from.slope_rad,
        };
        let step = progress[last] - progress[last.saturating_sub(1)];
        Self { path, progress, beyond: (beyond, progress[last] + step) }
    }

    /// Returns the number of frames, the one beyond not counted.
    pub(super) fn n_frames(&self) -> usize {
        self.path.len()
    }

    /// Returns the path's frame, also one frame beyond the end.
    pub(super) fn frame(&self, frame: usize) -> PathFrame {
        self.path.get(frame).copied().unwrap_or(self.beyond.0)
    }

    /// Returns the arc length, also one frame beyond the end.
    pub(super) fn progress(&self, frame: usize) -> f64 {
        self.progress.get(frame).copied().unwrap_or(self.beyond.1)
    }
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;

    #[test]
    fn a_path_goes_on_as_it_ended() {
        let at = |z: f64| PathFrame { point: DVec3::new(0.0, 1.0, z), heading_rad: 0.125 * z, slope_rad: 0.0 };
        let (path, progress) = ([at(0.0), at(1.0), at(3.0)], [0.0, 1.0, 3.0]);
        let along = Along::new(&path, &progress);
        assert_eq!((along.frame(2), along.progress(2)), (at(3.0), 3.0));
        assert_eq!((along.frame(3), along.progress(3)), (at(5.0), 5.0), "as it turned");
        assert_eq!(Along::new(&[at(7.0)], &[0.0]).frame(1), at(7.0), "one frame stands still");
    }

    #[test]
    fn ranges_overlap_by_what_they_share() {
        let range = |first, end| LoopRange { first, end };
        assert_eq!(range(0, 10).overlap(range(5, 15)), 1.0 / 3.0);
        assert_eq!(range(0, 10).overlap(range(10, 15)), 0.0);
        assert_eq!(range(3, 10).overlap(range(3, 10)), 1.0);
    }
}
