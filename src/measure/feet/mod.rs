//! What feet do in their plants and between them, source beside edited (METHOD 9).
//!
//! The plants are those found on the source. Both clips are measured over the same steps, those that the edited clip
//! shows, so that a clip that ends early or is cycled is compared with what it repeats. A step is from one frame to the
//! next; the contact point is ankle or toe, whichever moves less over the ground in that step of that clip.

mod diameter;

use std::ops::Range;

use diameter::diameter;

use super::Pair;
use crate::{
    contact::{Plant, PlantMode},
    motion::Track,
};

/// The two points of a foot that may stand, world, over the frames of one clip.
#[derive(Clone, Copy, Debug)]
pub struct FootTracks<'a> {
    /// The ankle.
    pub ankle: Track<'a>,
    /// Ball or tip of the foot; as many frames.
    pub toe: Track<'a>,
}

/// One foot's numbers, source (over what the edited clip shows) beside edited; none where there is nothing to measure.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FootNumbers {
    /// Plants measured: those of the edited clip, intended slides not counted. A plant cycled twice counts twice.
    pub plants: usize,
    /// Mean horizontal speed of the contact point in plants, body heights per second.
    pub planted_speed: Option<Pair>,
    /// Per plant the largest horizontal distance between two places of the same joint while it is the contact point
    /// without a break; of these the 90th percentile over plants, body heights.
    pub slip_p90: Option<Pair>,
    /// Mean height of the toe over its floor between plants, body heights. The floor under a frame lies on the straight
    /// line, over time, between the toe's lowest heights in the plants before and after.
    pub clearance: Option<Pair>,
}

/// Everything the numbers of a foot are made of.
#[derive(Clone, Copy, Debug)]
pub struct FootMeasure<'a> {
    /// The foot in the source.
    pub source: FootTracks<'a>,
    /// The foot in the edited clip.
    pub edited: FootTracks<'a>,
    /// Source frame that each edited frame shows.
    pub source_frames: &'a [u32],
    /// The foot's plants, source frames, in order of time.
    pub plants: &'a [Plant],
    /// The source's steps in these plants, as [`PlantSteps::of`] has them.
    pub source_steps: &'a [PlantSteps],
    /// Whether the source is joined to itself: a plant that is shown in part is then a part of a longer one, and counts
    /// whole in the source's slip.
    pub is_joined: bool,
    /// Seconds from frame to frame; positive.
    pub frame_time_secs: f64,
    /// Body height, clip's unit; positive.
    pub height: f64,
}

impl FootNumbers {
    /// Returns these numbers with another's as the source's, where it has any.
    pub fn beside(self, source: &Self) -> Self {
        let pair = |own: Option<Pair>, other: Option<Pair>| {
            own.map(|own| Pair { source: other.map_or(own.source, |other| other.source), ..own })
        };
        Self {
            planted_speed: pair(self.planted_speed, source.planted_speed),
            slip_p90: pair(self.slip_p90, source.slip_p90),
            clearance: pair(self.clearance, source.clearance),
            ..self
        }
    }
}

impl FootMeasure<'_> {
    /// Measures the foot. Linear in the number of edited frames, and fast enough for every key press.
    pub fn numbers(&self) -> FootNumbers {
        let stands = self.stands();
        let measured: Vec<&Stand> = stands.iter().filter(|stand| stand.mode != PlantMode::Slide).collect();
        let mut slips = [Vec::with_capacity(measured.len()), Vec::with_capacity(measured.len())];
        let (mut lengths, mut n_steps) = ([0.0; 2], 0);
        for stand in &measured {
            n_steps += stand.edited.len() - 1;
            let [(source, shown), (edited, frames)] = self.both(stand.edited.clone());
            let whole = self.source_steps[stand.plant_idx];
            let plant = &self.plants[stand.plant_idx];
            let is_whole = plant.last + 1 - plant.first == shown.len();
            let source = if is_whole { whole } else { PlantSteps::new(source, shown) };
            for (clip, steps) in [source, PlantSteps::new(edited, frames)].into_iter().enumerate() {
                lengths[clip] += steps.length;
                slips[clip].push(steps.slip);
            }
            if self.is_joined {
                *slips[0].last_mut().expect("pushed above") = whole.slip;
            }
        }
        let secs = n_steps as f64 * self.frame_time_secs;
        let pair = |values: [f64; 2]| Pair { source: values[0] / self.height, edited: values[1] / self.height };
        FootNumbers {
            plants: measured.len(),
            planted_speed: (n_steps > 0).then(|| pair(lengths.map(|length| length / secs))),
            slip_p90: (!measured.is_empty()).then(|| pair(slips.map(percentile_90))),
            clearance: self.clearance(&stands),
        }
    }

    /// Finds the stretches of edited frames that show a plant without a break.
    fn stands(&self) -> Vec<Stand> {
        let mut stands = Vec::new();
        let mut first = 0;
        for run in self.source_frames.chunk_by(|&a, &b| a + 1 == b) {
            let shown = run[0] as usize..run[0] as usize + run.len();
            let from = self.plants.partition_point(|plant| plant.last < shown.start);
            for (plant_idx, plant) in
                (from..).zip(&self.plants[from..]).take_while(|(_, plant)| plant.first < shown.end)
            {
                let edited = |frame: usize| first + frame - shown.start;
                let frames = plant.first.max(shown.start)..(plant.last + 1).min(shown.end);
                stands.push(Stand { edited: edited(frames.start)..edited(frames.end), plant_idx, mode: plant.mode });
            }
            first += run.len();
        }
        stands
    }

    /// Returns the foot in the source and in the edited clip, each with the frames that these edited frames are.
    fn both(&self, edited: Range<usize>) -> [(&FootTracks<'_>, Range<usize>); 2] {
        let first = self.source_frames[edited.start] as usize;
        [(&self.source, first..first + edited.len()), (&self.edited, edited)]
    }

    /// Returns the mean clearance over the frames between two plants that the edited clip shows in one piece.
    fn clearance(&self, stands: &[Stand]) -> Option<Pair> {
        let (mut sums, mut n_frames) = ([0.0; 2], 0);
        for pair in stands.windows(2) {
            let [before, after] = [pair[0].edited.clone(), pair[1].edited.clone()];
            let whole = before.start..after.end;
            let n_shown =
                (self.source_frames[whole.end - 1] as usize).wrapping_sub(self.source_frames[whole.start] as usize);
            if n_shown.wrapping_add(1) != whole.len() {
                continue;
            }
            let swing = before.end..after.start;
            n_frames += swing.len();
            for (clip, (tracks, frames)) in self.both(whole.clone()).into_iter().enumerate() {
                let y = &tracks.toe.y[frames];
                let lowest = |part: Range<usize>| y[part].iter().copied().fold(f64::INFINITY, f64::min);
                let from = lowest(0..before.len());
                let to = lowest(y.len() - after.len()..y.len());
                let span = (swing.len() + 1) as f64;
                for (at, y) in (1..).zip(&y[before.len()..][..swing.len()]) {
                    sums[clip] += y - (from + (to - from) * f64::from(at) / span);
                }
            }
        }
        let mean = |sum: f64| sum / n_frames as f64 / self.height;
        (n_frames > 0).then(|| Pair { source: mean(sums[0]), edited: mean(sums[1]) })
    }
}

/// A plant as far as the edited clip shows it without a break.
struct Stand {
    /// Edited frames, at least one.
    edited: Range<usize>,
    plant_idx: usize,
    mode: PlantMode,
}

/// The steps of one foot in one plant of one clip.
#[derive(Clone, Copy, Debug)]
pub struct PlantSteps {
    /// Sum of the contact point's horizontal steps, clip's unit.
    length: f64,
    /// Largest distance between places of one joint while it is the contact point, clip's unit.
    slip: f64,
}

impl PlantSteps {
    /// Returns a foot's steps in each of its plants, as far as it has frames.
    pub fn of(foot: &FootTracks, plants: &[Plant]) -> Vec<Self> {
        let n_frames = foot.ankle.x.len();
        plants.iter().map(|plant| Self::new(foot, plant.first.min(n_frames)..(plant.last + 1).min(n_frames))).collect()
    }

    fn new(foot: &FootTracks, frames: Range<usize>) -> Self {
        let mut steps = Self { length: 0.0, slip: 0.0 };
        // Whether the toe is in contact, the first frame of that run, and the way gone in it.
        let mut run = (false, frames.start, 0.0);
        for frame in frames.start + 1..frames.end {
            let [ankle, toe] = [&foot.ankle, &foot.toe].map(|track| track.flat_distance_squared(frame - 1, frame));
            let (is_toe, step) = (toe < ankle, ankle.min(toe).sqrt());
            if is_toe != run.0 {
                steps.end_run(foot, run, frame - 1);
                run = (is_toe, frame - 1, 0.0);
            }
            run.2 += step;
            steps.length += step;
        }
        if !frames.is_empty() {
            steps.end_run(foot, run, frames.end - 1);
        }
        steps
    }

    /// Takes a run of one contact point into the slip, unless it is too short a way to matter.
    fn end_run(&mut self, foot: &FootTracks, (is_toe, first, way): (bool, usize, f64), last: usize) {
        if way > self.slip {
            let track = if is_toe { &foot.toe } else { &foot.ankle };
            self.slip = self.slip.max(diameter(&track.x[first..=last], &track.z[first..=last]));
        }
    }
}

/// Returns the 90th percentile, between values on a straight line.
///
/// # Panics
///
/// When there are no values.
fn percentile_90(mut values: Vec<f64>) -> f64 {
    values.sort_unstable_by(f64::total_cmp);
    let last = values.len() - 1;
    let at = 0.9 * last as f64;
    let below = at.floor() as usize;
    let above = (below + 1).min(last);
    values[below] + (at - below as f64) * (values[above] - values[below])
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::motion::PointTracks;

    const DT: f64 = 0.01;
    const HEIGHT: f64 = 2.0;

    fn foot(tracks: &PointTracks) -> FootTracks<'_> {
        FootTracks { ankle: tracks.track(0), toe: tracks.track(1) }
    }

    fn measure(source: &PointTracks, edited: &PointTracks, frames: &[u32], plants: &[Plant]) -> FootNumbers {
        let measure = FootMeasure {
            source: foot(source),
            edited: foot(edited),
            source_frames: frames,
            plants,
            source_steps: &PlantSteps::of(&foot(source), plants),
            is_joined: false,
            frame_time_secs: DT,
            height: HEIGHT,
        };
        measure.numbers()
    }

    fn all(tracks: &PointTracks) -> Vec<u32> {
        (0..tracks.n_frames() as u32).collect()
    }

    #[track_caller]
    fn check(found: Option<Pair>, source: f64, edited: f64) {
        let found = found.expect("there is something to measure");
        assert!((found.source - source).abs() < 1e-12, "source {} instead of {source}", found.source);
        assert!((found.edited - edited).abs() < 1e-12, "edited {} instead of {edited}", found.edited);
    }

    /// The ankle swings by; the toe slides along x by `step` a frame and is lifted to `lift` outside frames 10–20 and
    /// 40–60, over ground that rises by `slope` a frame.
    fn sliding(step: f64, lift: f64, slope: f64) -> PointTracks {
        PointTracks::from_fn(2, 80, |point, frame| {
            let f = frame as f64;
            let stands = (10..=20).contains(&frame) || (40..=60).contains(&frame);
            match point {
                0 => DVec3::new(0.0, 0.1, f),
                _ => DVec3::new(step * f, slope * f + if stands { 0.0 } else { lift }, 0.0),
            }
        })
    }

    const PLANTS: [Plant; 2] = [Plant::new(10, 20), Plant::new(40, 60)];

    #[test]
    fn a_foot_that_slides_is_measured_in_body_heights() {
        let (source, edited) = (sliding(0.02, 0.3, 0.0), sliding(0.06, 0.2, 0.0));
        let numbers = measure(&source, &edited, &all(&source), &PLANTS);
        assert_eq!(numbers.plants, 2);
        check(numbers.planted_speed, 0.02 / DT / HEIGHT, 0.06 / DT / HEIGHT);
        // Slips of 10 and 20 steps: a tenth of the way down from the larger.
        check(numbers.slip_p90, 19.0 * 0.02 / HEIGHT, 19.0 * 0.06 / HEIGHT);
        check(numbers.clearance, 0.3 / HEIGHT, 0.2 / HEIGHT);
    }

    #[test]
    fn the_floor_between_plants_follows_their_levels() {
        // The lowest toe is at the plants' first frames, 10 and 40; the floor goes from the first to the second while
        // the frames go from 20 to 40.
        let (flat, rising) = (sliding(0.02, 0.3, 0.0), sliding(0.02, 0.3, 0.01));
        let numbers = measure(&flat, &rising, &all(&flat), &PLANTS);
        check(numbers.clearance, 0.3 / HEIGHT, (0.3 + 0.01 * (30.0 - 25.0)) / HEIGHT);
    }

    #[test]
    fn only_what_the_edited_clip_shows_is_measured() {
        let source = sliding(0.02, 0.3, 0.0);
        let cut: Vec<u32> = (0..45).collect();
        let numbers = measure(&source, &source, &cut, &PLANTS);
        assert_eq!(numbers.plants, 2);
        check(numbers.slip_p90, (4.0 + 0.9 * 6.0) * 0.02 / HEIGHT, (4.0 + 0.9 * 6.0) * 0.02 / HEIGHT);

        // Frames 15–44 twice: the break is neither a step nor a swing.
        let twice: Vec<u32> = (15..45).chain(15..45).collect();
        let edited = PointTracks::from_fn(2, 60, |point, frame| {
            source.position(point, twice[frame] as usize) + DVec3::X * if frame < 30 { 0.0 } else { 7.0 }
        });
        let numbers = measure(&source, &edited, &twice, &PLANTS);
        assert_eq!(numbers.plants, 4);
        check(numbers.planted_speed, 0.02 / DT / HEIGHT, 0.02 / DT / HEIGHT);
        check(numbers.slip_p90, 5.0 * 0.02 / HEIGHT, 5.0 * 0.02 / HEIGHT);
        check(numbers.clearance, 0.3 / HEIGHT, 0.3 / HEIGHT);
    }

    #[test]
    fn a_plant_that_a_joined_clip_shows_in_part_counts_whole() {
        let source = sliding(0.02, 0.3, 0.0);
        let twice: Vec<u32> = (15..50).chain(15..50).collect();
        let moved = PointTracks::from_fn(2, 70, |point, frame| source.position(point, twice[frame] as usize));
        let measure = FootMeasure {
            source: foot(&source),
            edited: foot(&moved),
            source_frames: &twice,
            plants: &PLANTS,
            source_steps: &PlantSteps::of(&foot(&source), &PLANTS),
            is_joined: true,
            frame_time_secs: DT,
            height: HEIGHT,
        };
        // Parts of 5 and 9 steps, of plants of 10 and 20.
        check(measure.numbers().slip_p90, 20.0 * 0.02 / HEIGHT, 9.0 * 0.02 / HEIGHT);
    }

    #[test]
    fn the_contact_point_changes_and_each_joint_slips_for_itself() {
        // The ankle moves a little while the toe comes down, then the toe moves a little while the ankle goes up.
        let tracks = PointTracks::from_fn(2, 21, |point, frame| {
            let (early, late) = (frame.min(10) as f64, frame.saturating_sub(10) as f64);
            DVec3::X * if point == 0 { 0.01 * early + late } else { early + 0.02 * late }
        });
        let numbers = measure(&tracks, &tracks, &all(&tracks), &[Plant::new(0, 20)]);
        check(numbers.planted_speed, 0.015 / DT / HEIGHT, 0.015 / DT / HEIGHT);
        check(numbers.slip_p90, 0.2 / HEIGHT, 0.2 / HEIGHT);
        assert_eq!(numbers.clearance, None);
    }

    #[test]
    fn intended_slides_and_feet_without_plants_are_not_measured() {
        let source = sliding(0.02, 0.3, 0.0);
        let slide = Plant { mode: PlantMode::Slide, ..PLANTS[1] };
        let numbers = measure(&source, &source, &all(&source), &[PLANTS[0], slide]);
        assert_eq!(numbers.plants, 1);
        check(numbers.slip_p90, 10.0 * 0.02 / HEIGHT, 10.0 * 0.02 / HEIGHT);
        check(numbers.clearance, 0.3 / HEIGHT, 0.3 / HEIGHT);

        let none = FootNumbers { plants: 0, planted_speed: None, slip_p90: None, clearance: None };
        assert_eq!(measure(&source, &source, &all(&source), &[]), none);
        assert_eq!(measure(&source, &source, &[], &PLANTS), none);
    }
}
