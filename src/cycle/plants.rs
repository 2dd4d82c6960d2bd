//! Plants of a joined clip: those of the clip it shows, one where a foot stands across a seam.

use super::Joined;
use crate::contact::{FootPlants, Plant, PlantMode};

/// A foot that leaves the ground for less than this at a seam stands across it; one that stands for less than this
/// because a seam cuts its plant off does not stand. Seconds, as in detection.
const SHORTEST_SECS: f64 = 0.06;

impl Joined {
    /// Returns the joined clip's plants, given those of the clip it shows.
    ///
    /// Plants repeat with every cycle, edited ones too. Where a seam's mismatch is spread over a plant that is to be
    /// held, the spread moves the foot; that plant is cleaned, so that no foot slides more than in the source.
    pub fn plants(&self, feet: &[FootPlants]) -> Vec<FootPlants> {
        feet.iter().map(|foot| FootPlants { leg: foot.leg, plants: self.foot(&foot.plants) }).collect()
    }

    fn foot(&self, plants: &[Plant]) -> Vec<Plant> {
        let shortest = (SHORTEST_SECS / self.clip.frame_time_secs).ceil() as usize;
        let mut joined: Vec<Plant> = Vec::new();
        let starts = std::iter::once(0).chain(self.seams.iter().copied());
        let ends = self.seams.iter().copied().chain([self.source_frames.len()]);
        for (start, end) in starts.zip(ends) {
            let shown = self.source_frames[start] as usize..self.source_frames[end - 1] as usize + 1;
            for plant in plants.iter().filter(|plant| plant.first < shown.end && plant.last >= shown.start) {
                let at = |frame: usize| start + frame.clamp(shown.start, shown.end - 1) - shown.start;
                let piece = Plant { first: at(plant.first), last: at(plant.last), ..*plant };
                match joined.last_mut() {
                    Some(before) if before.last < start && piece.first - before.last <= shortest => {
                        *before = across(*before, piece);
                    }
                    _ => joined.push(piece),
                }
            }
        }
        let is_cut = |frame: usize| self.seams.binary_search(&frame).is_ok();
        joined.retain(|plant| plant.n_frames() >= shortest || !(is_cut(plant.first) || is_cut(plant.last + 1)));
        for plant in &mut joined {
            if plant.mode == PlantMode::Hold && self.is_spread_over(plant) {
                plant.mode = PlantMode::Clean;
            }
        }
        joined
    }

    /// Tells whether a seam's mismatch is spread over some of a plant's frames; the end is one, as if a cycle followed.
    fn is_spread_over(&self, plant: &Plant) -> bool {
        let after = self.seams.partition_point(|&seam| seam + self.n_spread <= plant.first);
        let seam = self.seams.get(after).copied().unwrap_or(self.source_frames.len());
        self.n_spread > 0 && plant.last + self.n_spread > seam
    }
}

/// Makes one plant of two; the longer one's mode counts.
fn across(before: Plant, after: Plant) -> Plant {
    let mode = if after.n_frames() > before.n_frames() { after.mode } else { before.mode };
    Plant { first: before.first, last: after.last, mode }
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use super::*;
    use crate::{
        bvh::Bvh,
        motion::{Clip, ClipOptions, gait},
    };

    /// A joined clip of 60 frames a second that shows 0–49, then 20–49 twice.
    fn joined(n_spread: usize) -> Joined {
        let bvh = Bvh::parse(gait::built_in().0.into_bytes(), "built-in").expect("a valid file");
        Joined {
            clip: Arc::new(Clip::from_bvh(&bvh, &ClipOptions::default())),
            source_frames: (0..50).chain(20..50).chain(20..50).collect(),
            carrier: Vec::new(),
            path: Vec::new(),
            progress: Vec::new(),
            turned: Vec::new(),
            seams: vec![50, 80],
            n_spread,
        }
    }

    #[track_caller]
    fn check(n_spread: usize, plants: &[Plant], wanted: &[Plant]) {
        assert_eq!(joined(n_spread).foot(plants), wanted);
    }

    #[test]
    fn plants_repeat_and_those_at_a_seam_are_one() {
        let p = Plant::new;
        check(0, &[p(5, 15), p(30, 40)], &[p(5, 15), p(30, 40), p(60, 70), p(90, 100)]);
        check(0, &[p(10, 25), p(45, 60)], &[p(10, 25), p(45, 55), p(75, 85), p(105, 109)]);
        check(0, &[p(10, 25), p(35, 48)], &[p(10, 25), p(35, 55), p(65, 85), p(95, 108)]);
        check(0, &[p(0, 90)], &[p(0, 109)]);
    }

    #[test]
    fn what_a_seam_leaves_of_a_plant_counts_when_it_lasts() {
        let p = Plant::new;
        check(0, &[p(10, 21), p(30, 40)], &[p(10, 21), p(30, 40), p(60, 70), p(90, 100)]);
        check(0, &[p(10, 23), p(30, 40)], &[p(10, 23), p(30, 40), p(50, 53), p(60, 70), p(80, 83), p(90, 100)]);
        check(0, &[p(48, 60)], &[p(108, 109)]);
    }

    #[test]
    fn plants_that_a_mismatch_is_spread_over_are_cleaned() {
        let p = Plant::new;
        let clean = |first, last| Plant { mode: PlantMode::Clean, ..p(first, last) };
        check(8, &[p(5, 15), p(30, 44)], &[p(5, 15), clean(30, 44), clean(60, 74), clean(90, 104)]);
        check(8, &[p(27, 40)], &[p(27, 40), clean(57, 70), clean(87, 100)]);
        check(8, &[p(28, 42)], &[p(28, 42), p(58, 72), p(88, 102)]);
        check(8, &[p(25, 42)], &[p(25, 42), clean(55, 72), clean(85, 102)]);
        let slide = Plant { mode: PlantMode::Slide, ..p(45, 49) };
        check(8, &[slide], &[slide, Plant { first: 75, last: 79, ..slide }, Plant { first: 105, last: 109, ..slide }]);
    }
}
