//! The playhead's way through time: at the clip's own pace, or in slow motion.
//!
//! Slow motion is for looking at what keys did. Between two interpolation keys it is ten times slower; without them no
//! frame is left out, however short frames are beside the time between two drawn pictures.

use std::ops::Range;

/// How much slower slow motion is between interpolation keys.
const SLOWER: f64 = 10.0;

/// How fast the playhead goes.
#[derive(Clone, Debug, PartialEq, Eq)]
pub(super) enum Pace {
    /// As the clip does.
    Own,
    /// At most one frame at a time, and slower while it shows these frames of the clip.
    EveryFrame(Range<usize>),
}

/// A clip that plays.
pub(super) struct Playback<'a> {
    /// Number of edited frames; at least 2.
    pub(super) n_frames: usize,
    /// Seconds from one frame to the next, as they are to be seen; positive.
    pub(super) frame_secs: f64,
    /// How fast the playhead goes.
    pub(super) pace: Pace,
    /// The clip's frame that an edited frame shows.
    pub(super) source_frame: &'a dyn Fn(usize) -> usize,
}

impl Playback<'_> {
    /// Returns the frame after some time, round at the end, and the time since that frame began.
    ///
    /// `elapsed_secs` counts from when `frame` began.
    pub(super) fn after(&self, frame: usize, elapsed_secs: f64) -> (usize, f64) {
        match &self.pace {
            Pace::Own => {
                let steps = (elapsed_secs / self.frame_secs).floor();
                // The remainder of a huge pause is what counts; the cast saturates.
                let next = (frame + steps as usize % self.n_frames) % self.n_frames;
                (next, elapsed_secs - steps * self.frame_secs)
            }
            Pace::EveryFrame(slow) => {
                let lasts = self.frame_secs * if slow.contains(&(self.source_frame)(frame)) { SLOWER } else { 1.0 };
                if elapsed_secs < lasts {
                    return (frame, elapsed_secs);
                }
                ((frame + 1) % self.n_frames, (elapsed_secs - lasts).min(self.frame_secs))
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Plays ten frames of 0.1 s from frame 0, in ticks; returns the frames seen.
    fn played(pace: Pace, tick_secs: f64, n_ticks: usize) -> Vec<usize> {
        let playback = Playback { n_frames: 10, frame_secs: 0.1, pace, source_frame: &|frame| frame };
        let (mut frame, mut carried) = (0, 0.0);
        let tick = |_| {
            (frame, carried) = playback.after(frame, carried + tick_secs);
            frame
        };
        (0..n_ticks).map(tick).collect()
    }

    #[test]
    fn at_its_own_pace_a_clip_takes_its_own_time() {
        assert_eq!(played(Pace::Own, 0.1 + 1e-9, 12), [1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2]);
        assert_eq!(played(Pace::Own, 0.25 + 1e-9, 4), [2, 5, 7, 0]);
        assert!(played(Pace::Own, 1e12, 3).iter().all(|&frame| frame < 10));
    }

    #[test]
    fn no_frame_is_skipped_where_none_may_be() {
        assert_eq!(played(Pace::EveryFrame(0..0), 0.25, 12), [1, 2, 3, 4, 5, 6, 7, 8, 9, 0, 1, 2]);
        assert_eq!(played(Pace::EveryFrame(0..0), 1e12, 3), [1, 2, 3]);
        assert_eq!(
            played(Pace::EveryFrame(0..0), 0.05 + 1e-9, 6),
            [0, 1, 1, 2, 2, 3],
            "but it is not faster than the clip"
        );
    }

    #[test]
    fn between_the_keys_it_is_ten_times_slower() {
        let frames = played(Pace::EveryFrame(3..5), 0.1 + 1e-9, 28);
        let seen = |frame: usize| frames.iter().filter(|&&f| f == frame).count();
        assert_eq!([1, 2, 3, 4, 5, 6].map(seen), [1, 1, 10, 10, 1, 1]);
        // Seen so seldom that frames elsewhere would be skipped, they are not.
        let coarse = played(Pace::EveryFrame(3..5), 0.5 + 1e-9, 9);
        assert_eq!(coarse, [1, 2, 3, 3, 4, 4, 5, 6, 7]);
    }
}
