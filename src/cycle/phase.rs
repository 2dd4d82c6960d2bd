//! Where a foot is in its step: a number that goes round once from one plant to the next.
//!
//! 0 at the first frame of a plant, ½ at the first frame of a swing. A plant or swing longer than usual is a foot that
//! rests: it keeps to the middle until its end is as near as it usually is. So standing is one phase, however long.

use crate::contact::FootPlants;

/// The phase of one foot at each frame of a clip, and one frame beyond.
#[derive(Clone, Debug)]
pub(super) struct Phase {
    /// In [0, 1).
    by_frame: Vec<f64>,
}

impl Phase {
    /// Takes the phase from a foot's plants.
    pub(super) fn of(foot: &FootPlants, n_frames: usize) -> Self {
        let ends: Vec<usize> = foot.plants.iter().flat_map(|plant| [plant.first, plant.last + 1]).collect();
        let usual = [0, 1].map(|swing| usual(&ends, swing, n_frames));
        let by_frame = (0..=n_frames)
            .map(|frame| {
                // Ends up to the frame: an odd number while it is in a plant.
                let passed = ends.partition_point(|&end| end <= frame);
                // What the clip's end cuts off goes on.
                let in_plant = passed % 2 == 1 || (passed > 0 && frame == n_frames && ends[passed - 1] == n_frames);
                let passed = if in_plant && passed % 2 == 0 { passed - 1 } else { passed };
                let usual = usual[usize::from(!in_plant)];
                let since = match passed.checked_sub(1).map(|before| ends[before]) {
                    Some(begin) if begin > 0 => (frame - begin) as f64 / usual,
                    _ => f64::INFINITY,
                };
                let until = match ends.get(passed) {
                    Some(&end) if end < n_frames => (end - frame) as f64 / usual,
                    _ => f64::INFINITY,
                };
                let half = 0.5 * share(since, until);
                if in_plant { half } else { (0.5 + half) % 1.0 }
            })
            .collect();
        Self { by_frame }
    }

    /// Returns the phase as an angle of a whole turn, radians.
    pub(super) fn angle(&self, frame: usize) -> f64 {
        self.by_frame[frame] * std::f64::consts::TAU
    }

    /// Returns how far two frames are apart, 0 for the same phase and 1 for opposite ones.
    pub(super) fn distance(&self, a: usize, b: usize) -> f64 {
        let apart = (self.by_frame[a] - self.by_frame[b]).abs();
        2.0 * apart.min(1.0 - apart)
    }
}

/// Returns the share of a plant or swing that is over, from the time since it began and until it ends in units of the
/// usual length; infinite where the clip does not show it.
fn share(since: f64, until: f64) -> f64 {
    // A short one is over sooner.
    let length = (since + until).min(1.0);
    match (since / length, until / length) {
        (since, until) if since < 0.5 && since <= until => since,
        (_, until) if until < 0.5 => 1.0 - until,
        _ => 0.5,
    }
}

/// Returns the median length of plants (`swing` 0) or swings (1) that the clip shows whole; its own length without any.
fn usual(ends: &[usize], swing: usize, n_frames: usize) -> f64 {
    let whole = ends.windows(2).skip(swing).step_by(2).filter(|pair| pair[0] > 0 && pair[1] < n_frames);
    let mut lengths: Vec<usize> = whole.map(|pair| pair[1] - pair[0]).collect();
    lengths.sort_unstable();
    lengths.get(lengths.len() / 2).copied().unwrap_or(n_frames).max(1) as f64
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        contact::Plant,
        motion::{Leg, Side},
        skeleton::JointId,
    };

    /// Checks phases at frames of a clip of 100 frames.
    #[track_caller]
    fn check(plants: &[(usize, usize)], wanted: &[(usize, f64)]) {
        let leg = Leg { side: Side::Left, hip: JointId(0), knee: JointId(1), ankle: JointId(2), toe: 3 };
        let plants = plants.iter().map(|&(first, last)| Plant::new(first, last)).collect();
        let phase = Phase::of(&FootPlants { leg, plants }, 100);
        for &(frame, wanted) in wanted {
            let found = phase.by_frame[frame];
            assert!((found - wanted).abs() < 1e-12, "frame {frame}: {found}, not {wanted}");
        }
    }

    #[test]
    fn plants_are_the_first_half_and_swings_the_second() {
        check(
            &[(10, 29), (40, 59), (70, 89)],
            &[(10, 0.0), (15, 0.125), (20, 0.25), (25, 0.375), (30, 0.5), (35, 0.75), (40, 0.0), (65, 0.75)],
        );
    }

    #[test]
    fn what_the_clip_cuts_off_is_of_the_usual_length() {
        // Plants of 20, swings of 10; the first plant begins before the clip and the last ends after it.
        check(&[(0, 9), (20, 39), (50, 69), (80, 99)], &[(0, 0.25), (5, 0.375), (10, 0.5), (85, 0.125), (99, 0.25)]);
        check(&[(0, 9), (20, 39), (50, 69), (80, 99)], &[(100, 0.25)]);
        check(&[(20, 39), (50, 69)], &[(15, 0.75), (18, 0.9), (0, 0.75), (72, 0.6), (100, 0.75)]);
    }

    #[test]
    fn a_foot_that_rests_has_one_phase() {
        check(&[(0, 24), (35, 54), (65, 99)], &[(0, 0.25), (15, 0.25), (20, 0.375), (65, 0.0), (75, 0.25), (99, 0.25)]);
        check(&[], &[(0, 0.75), (100, 0.75)]);
    }
}
