//! `LoopFinder`: the ranges of a clip that can be repeated.
//!
//! Two frames are alike when the body stands, moves and steps alike as seen from the path's frame. Comparing every frame
//! with every other would be quadratic, so there are two passes. The first takes at most a thousand frames evenly over
//! the clip, each reduced to a short list of numbers by a fixed projection with random signs, which keeps distances
//! nearly (W. B. Johnson and J. Lindenstrauss, *Extensions of Lipschitz mappings into a Hilbert space*, 1984). The second
//! walks from the best pairs of those to the best pair of frames nearby, on the whole bodies.

use glam::DVec3;

use super::{LoopRange, along::Along, phase::Phase};
use crate::{
    contact::FootPlants,
    math::heading_rotation,
    motion::{Clip, PointTracks},
    path::PathFrame,
};

/// Shortest range, seconds.
const SHORTEST_SECS: f64 = 0.4;

/// A range walks this far at least, body heights.
const SHORTEST_PERIOD: f64 = 0.3;

/// A difference in velocity counts as the difference in pose it makes over this time, seconds.
const VELOCITY_SECS: f64 = 0.1;

/// Opposite phases of the feet count as this difference in pose, body heights.
const PHASE_WEIGHT: f64 = 0.1;

/// A range over which the path stands still counts as this difference in pose, body heights.
const PAUSE_WEIGHT: f64 = 0.1;

/// The path stands still where it is slower than this share of the speed that it reaches in a quarter of the frames.
const PAUSE_SPEED: f64 = 0.3;

/// Frames compared in the first pass at most.
const MOST_SAMPLES: usize = 1000;

/// Numbers that stand for a body in the first pass.
const N_PROJECTED: usize = 16;

/// Pairs that the second pass begins from.
const MOST_STARTS: usize = 64;

/// Ranges found at most.
const MOST_FOUND: usize = 8;

/// Ranges that share more of their frames than this are one.
const SAME: f64 = 0.8;

/// A range that may be repeated, and how well its ends meet.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Loop {
    /// The range.
    pub range: LoopRange,
    /// How far its ends are apart.
    pub mismatch: Mismatch,
}

/// How far the frame after a range is from its first one, once the path is taken out.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Mismatch {
    /// Root mean square distance of the joints, body heights.
    pub pose: f64,
    /// The same of their velocities, body heights per second.
    pub velocity: f64,
    /// Of the foot that is further off in its step, 0 to 1; none without plants.
    pub phase: Option<f64>,
}

impl std::fmt::Display for Mismatch {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "pose {:.3} H, velocity {:.2} H/s", self.pose, self.velocity)?;
        self.phase.map_or(Ok(()), |phase| write!(f, ", phase {phase:.2}"))
    }
}

/// Everything that loops are found in.
#[derive(Clone, Copy, Debug)]
pub struct LoopFinder<'a> {
    /// The clip; its carrier's subtree is looked at.
    pub clip: &'a Clip,
    /// World positions of the clip's points.
    pub tracks: &'a PointTracks,
    /// Frames of the path fitted to the clip.
    pub path: &'a [PathFrame],
    /// Arc length of each frame on that path, the clip's unit.
    pub progress: &'a [f64],
    /// The clip's plants; none for a clip without legs.
    pub feet: &'a [FootPlants],
}

impl LoopFinder<'_> {
    /// Finds the best ranges, the best first; none in a clip too short to repeat anything.
    ///
    /// Frames up to a thousand cost quadratically, all more of them linearly.
    pub fn best(&self) -> Vec<Loop> {
        let bodies = Bodies::new(self);
        let mut found: Vec<(f64, LoopRange)> =
            bodies.starts().into_iter().map(|start| bodies.improved(start)).collect();
        found.sort_by(|a, b| a.0.total_cmp(&b.0).then(a.1.first.cmp(&b.1.first)).then(a.1.end.cmp(&b.1.end)));
        let mut best: Vec<Loop> = Vec::new();
        for (_, range) in found {
            if best.len() < MOST_FOUND && best.iter().all(|other| other.range.overlap(range) <= SAME) {
                best.push(Loop { range, mismatch: bodies.mismatch(range) });
            }
        }
        best
    }

    /// Finds the best end of a range that begins at a frame; none where no range can begin. Linear in frames.
    pub fn best_end(&self, first: usize) -> Option<usize> {
        let ends = first + 1..=self.clip.n_frames();
        Bodies::new(self).best_of(ends.map(|end| LoopRange { first, end })).map(|range| range.end)
    }

    /// Finds the best first frame of a range that ends before a frame; none where no range can end. Linear in frames.
    pub fn best_first(&self, end: usize) -> Option<usize> {
        Bodies::new(self).best_of((0..end).map(|first| LoopRange { first, end })).map(|range| range.first)
    }

    /// Tells how far the ends of a range are apart.
    ///
    /// # Panics
    ///
    /// When the range is empty or ends beyond the clip.
    pub fn mismatch(&self, range: LoopRange) -> Mismatch {
        assert!(range.first < range.end && range.end <= self.clip.n_frames(), "a range within the clip");
        Bodies::new(self).mismatch(range)
    }
}

/// What the passes share.
struct Bodies<'a> {
    tracks: &'a PointTracks,
    along: Along<'a>,
    /// Points that go where the carrier goes, joints only.
    points: Vec<usize>,
    phases: Vec<Phase>,
    /// Number of frames before each at which the path stands still; one more than frames.
    paused: Vec<u32>,
    frame_time_secs: f64,
    height: f64,
    /// Fewest frames of a range.
    shortest: usize,
}

impl<'a> Bodies<'a> {
    fn new(finder: &LoopFinder<'a>) -> Self {
        let LoopFinder { clip, tracks, path, progress, feet } = *finder;
        let within = clip.skeleton.subtree(clip.facts.carrier.value);
        let stands = |foot: &&FootPlants| !foot.plants.is_empty();
        Self {
            tracks,
            along: Along::new(path, progress),
            points: (0..within.len()).filter(|&joint| within[joint]).collect(),
            phases: feet.iter().filter(stands).map(|foot| Phase::of(foot, tracks.n_frames())).collect(),
            paused: paused(progress),
            frame_time_secs: clip.frame_time_secs,
            height: clip.facts.height.value,
            shortest: ((SHORTEST_SECS / clip.frame_time_secs).ceil() as usize).max(4),
        }
    }

    /// Tells whether a range is long enough, in time and on the path, and within the clip.
    fn admits(&self, range: LoopRange) -> bool {
        range.end <= self.along.n_frames()
            && range.first + self.shortest <= range.end
            && self.along.progress(range.end) - self.along.progress(range.first) >= SHORTEST_PERIOD * self.height
    }

    /// Returns where a point is as the path's frame `seen_from` sees it, and its velocity, the clip's unit.
    fn seen(&self, point: usize, frame: usize) -> (DVec3, DVec3) {
        let last = self.tracks.n_frames() - 1;
        // Beyond the end the body goes on as it went.
        let step = |frame: usize| self.tracks.position(point, frame) - self.tracks.position(point, frame - 1);
        let (place, velocity) = match frame {
            0 => (self.tracks.position(point, 0), step(1)),
            f if f < last => {
                let (before, after) = (self.tracks.position(point, f - 1), self.tracks.position(point, f + 1));
                (self.tracks.position(point, f), 0.5 * (after - before))
            }
            f if f == last => (self.tracks.position(point, f), step(f)),
            _ => (self.tracks.position(point, last) + step(last), step(last)),
        };
        let at = self.along.frame(frame);
        let back = heading_rotation(-at.heading_rad);
        (back * (place - at.point), back * velocity / self.frame_time_secs)
    }

    fn mismatch(&self, range: LoopRange) -> Mismatch {
        let (mut pose, mut velocity) = (0.0, 0.0);
        for &point in &self.points {
            let (a, b) = (self.seen(point, range.first), self.seen(point, range.end));
            pose += a.0.distance_squared(b.0);
            velocity += a.1.distance_squared(b.1);
        }
        let rms = |sum: f64| (sum / self.points.len() as f64).sqrt() / self.height;
        let phases = self.phases.iter().map(|phase| phase.distance(range.first, range.end));
        Mismatch { pose: rms(pose), velocity: rms(velocity), phase: phases.reduce(f64::max) }
    }

    /// Returns what a range costs, body heights.
    fn cost(&self, range: LoopRange) -> f64 {
        let Mismatch { pose, velocity, phase } = self.mismatch(range);
        let apart = pose.hypot(VELOCITY_SECS * velocity).hypot(PHASE_WEIGHT * phase.unwrap_or(0.0));
        apart + PAUSE_WEIGHT * self.paused_share(range)
    }

    fn paused_share(&self, range: LoopRange) -> f64 {
        f64::from(self.paused[range.end] - self.paused[range.first]) / range.n_frames() as f64
    }

    fn best_of(&self, ranges: impl Iterator<Item = LoopRange>) -> Option<LoopRange> {
        let costs = ranges.filter(|&range| self.admits(range)).map(|range| (self.cost(range), range));
        costs.min_by(|a, b| a.0.total_cmp(&b.0)).map(|(_, range)| range)
    }

    /// First pass: the best ranges among frames evenly over the clip, their frames and the step from one to the next.
    fn starts(&self) -> Vec<(LoopRange, usize)> {
        let n_frames = self.along.n_frames();
        if n_frames <= self.shortest {
            return Vec::new();
        }
        let step = (n_frames + 1).div_ceil(MOST_SAMPLES);
        // Evenly back from the end, so that the whole rest of the clip can be a range.
        let mut frames: Vec<usize> = (0..=n_frames).rev().step_by(step).collect();
        frames.reverse();
        let projected: Vec<Projected> = frames.iter().map(|&frame| self.projected(frame)).collect();
        let n = frames.len();
        let mut costs = vec![f32::INFINITY; n * n];
        for (i, &first) in frames.iter().enumerate() {
            for (j, &end) in frames.iter().enumerate().skip(i + 1) {
                let range = LoopRange { first, end };
                if self.admits(range) {
                    let apart = projected[i].distance(&projected[j]);
                    costs[i * n + j] = apart + (PAUSE_WEIGHT * self.paused_share(range)) as f32;
                }
            }
        }
        let mut lowest: Vec<(f32, LoopRange)> = Vec::new();
        for i in 0..n {
            for j in i + 1..n {
                let cost = costs[i * n + j];
                let around =
                    (i.saturating_sub(1)..(i + 2).min(n)).flat_map(|k| &costs[k * n + j - 1..k * n + (j + 2).min(n)]);
                if cost.is_finite() && around.into_iter().all(|&other| cost <= other) {
                    lowest.push((cost, LoopRange { first: frames[i], end: frames[j] }));
                }
            }
        }
        lowest.sort_by(|a, b| a.0.total_cmp(&b.0));
        lowest.truncate(MOST_STARTS);
        lowest.into_iter().map(|(_, range)| (range, step)).collect()
    }

    /// Second pass: walks to the best range nearby, by ever smaller steps.
    fn improved(&self, (mut range, step): (LoopRange, usize)) -> (f64, LoopRange) {
        let mut cost = self.cost(range);
        let mut step = step;
        loop {
            let around = [(-1, -1), (-1, 0), (-1, 1), (0, -1), (0, 1), (1, -1), (1, 0), (1, 1)];
            let moved = around.into_iter().filter_map(|(first, end)| {
                let first = range.first.checked_add_signed(first * step as isize)?;
                let end = range.end.checked_add_signed(end * step as isize)?;
                Some(LoopRange { first, end }).filter(|&range| self.admits(range))
            });
            let best = moved.map(|range| (self.cost(range), range)).min_by(|a, b| a.0.total_cmp(&b.0));
            match best {
                Some((lower, better)) if lower < cost => (cost, range) = (lower, better),
                _ if step == 1 => return (cost, range),
                _ => step /= 2,
            }
        }
    }

    /// Reduces a body to a few numbers whose differences are nearly those of the bodies.
    fn projected(&self, frame: usize) -> Projected {
        let mut numbers = [0.0; N_PROJECTED];
        let mut signs = Signs::new();
        let weight = 1.0 / (self.height * ((self.points.len() * N_PROJECTED) as f64).sqrt());
        for &point in &self.points {
            let (place, velocity) = self.seen(point, frame);
            for value in [place, VELOCITY_SECS * velocity].into_iter().flat_map(|v| v.to_array()) {
                for number in &mut numbers {
                    *number += signs.next() * weight * value;
                }
            }
        }
        // On a circle of this radius small differences in phase are as far apart as they cost.
        let radius = PHASE_WEIGHT / std::f64::consts::PI;
        let mut phases = [0.0; 4];
        for (pair, phase) in phases.chunks_exact_mut(2).zip(&self.phases) {
            let (sin, cos) = phase.angle(frame).sin_cos();
            pair.copy_from_slice(&[radius * cos, radius * sin]);
        }
        Projected { numbers: numbers.map(|n| n as f32), phases: phases.map(|n| n as f32) }
    }
}

/// A body and the phases of two feet as a few numbers, body heights.
struct Projected {
    numbers: [f32; N_PROJECTED],
    phases: [f32; 4],
}

impl Projected {
    fn distance(&self, other: &Self) -> f32 {
        let squares = |a: &[f32], b: &[f32]| a.iter().zip(b).map(|(a, b)| (a - b) * (a - b)).sum::<f32>();
        (squares(&self.numbers, &other.numbers) + squares(&self.phases, &other.phases)).sqrt()
    }
}

/// A fixed sequence of random signs (xorshift; G. Marsaglia, *Xorshift RNGs*, 2003).
struct Signs(u64);

impl Signs {
    fn new() -> Self {
        Self(0x9E37_79B9_7F4A_7C15)
    }

    fn next(&mut self) -> f64 {
        self.0 ^= self.0 << 13;
        self.0 ^= self.0 >> 7;
        self.0 ^= self.0 << 17;
        if self.0 >> 63 == 0 { 1.0 } else { -1.0 }
    }
}

/// Counts the frames before each, and before the end, at which the path stands still.
fn paused(progress: &[f64]) -> Vec<u32> {
    let mut steps: Vec<f64> = progress.windows(2).map(|pair| pair[1] - pair[0]).collect();
    steps.push(steps.last().copied().unwrap_or(0.0));
    let three_quarters = 3 * (steps.len() - 1) / 4;
    let usual = *steps.clone().select_nth_unstable_by(three_quarters, f64::total_cmp).1;
    let mut counts = Vec::with_capacity(steps.len() + 1);
    counts.push(0);
    for (frame, &step) in steps.iter().enumerate() {
        counts.push(counts[frame] + u32::from(step < PAUSE_SPEED * usual));
    }
    counts
}
