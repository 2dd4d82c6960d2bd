//! Plants found in a motion: where ankle or toe is slow and on the ground.
//!
//! A foot stands while its ankle or its toe stands: the heel first, then both, then the toe. A joint stands over a
//! stretch of slow frames that is low: near the joint's own floor, or, for clips with stairs and slopes, higher up but
//! with the body on it. Slow and low have hysteresis: a stretch reaches as far as looser bounds allow, and counts when
//! somewhere in it the strict ones hold. Everything is linear in the number of frames.

use std::ops::Range;

use glam::DVec3;

use super::{FootPlants, Plant};
use crate::motion::{Leg, PointTracks};

/// What counts as standing (`plants.speed`, `plants.speed_share`, `plants.height`).
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Thresholds {
    /// A standing joint is slower than this, body heights per second; 0.15 by default.
    pub speed: f64,
    /// Or slower than this share of the carrier's speed over one second; 0.2 by default.
    pub speed_share: f64,
    /// A standing joint is less than this above its own floor, body heights; 0.06 by default.
    pub height: f64,
}

impl Default for Thresholds {
    fn default() -> Self {
        Self { speed: 0.15, speed_share: 0.2, height: 0.06 }
    }
}

/// Shortest plant, and shortest hole between two, seconds.
const SHORTEST_SECS: f64 = 0.06;

/// Time over which a joint's speed is taken, seconds: captured positions tremble from frame to frame.
const SPEED_SECS: f64 = 0.025;

/// Time over which the carrier's speed is taken, seconds.
const CARRIER_SECS: f64 = 1.0;

/// A stretch reaches as far as bounds this many times the strict ones hold.
const LOOSE: f64 = 1.5;

/// A joint's floor is the height below which it is for this share of the frames.
const FLOOR_SHARE: f64 = 0.05;

/// A foot that is slow for less than this, and higher than in the plants before and after, rests in mid-air: seconds.
const PAUSE_SECS: f64 = 0.25;

/// How much higher, body heights.
const PAUSE_HEIGHT: f64 = 0.02;

/// Shortest stretch off the floor, seconds; at the top of a jump feet are slow for 0.05 s.
const SHORTEST_RAISED_SECS: f64 = 0.2;

/// Everything plant detection looks at.
#[derive(Clone, Copy, Debug)]
pub struct Detection<'a> {
    /// World positions of all points, y-up, clip's unit.
    pub tracks: &'a PointTracks,
    /// Point that is the carrier.
    pub carrier: usize,
    /// Legs whose plants are wanted.
    pub legs: &'a [Leg],
    /// Seconds from frame to frame; positive.
    pub frame_time_secs: f64,
    /// Body height, clip's unit; positive.
    pub height: f64,
    /// What counts as standing.
    pub thresholds: Thresholds,
}

/// The joint of a foot that may stand.
struct Joint<'a> {
    point: usize,
    /// Over the frames, clip's unit.
    heights: &'a [f64],
    /// Its height when it stands on the lowest ground.
    floor: f64,
}

impl Detection<'_> {
    /// Finds the plants of every leg, in the order of the legs.
    pub fn plants(&self) -> Vec<FootPlants> {
        if self.legs.is_empty() {
            return Vec::new();
        }
        let slow_below = self.slow_below();
        let lowest = lowest(self.tracks);
        let foot = |&leg: &Leg| FootPlants { leg, plants: self.foot(&leg, &slow_below, &lowest) };
        self.legs.iter().map(foot).collect()
    }

    /// Finds one foot's plants. `slow_below`: strict speed bound at every frame; `lowest`: the body's lowest point.
    fn foot(&self, leg: &Leg, slow_below: &[f64], lowest: &[f64]) -> Vec<Plant> {
        let joints = [leg.ankle.idx(), leg.toe].map(|point| {
            let heights = self.tracks.y(point);
            Joint { point, heights, floor: percentile(heights, FLOOR_SHARE) }
        });
        let mut stands = vec![false; self.tracks.n_frames()];
        for joint in &joints {
            for stretch in self.stretches_of(joint, slow_below, lowest) {
                stands[stretch].fill(true);
            }
        }
        let n_shortest = self.n_frames_in(SHORTEST_SECS);
        for hole in runs(&stands, false) {
            let inside = hole.start > 0 && hole.end < stands.len();
            if inside && hole.len() < n_shortest {
                stands[hole].fill(true);
            }
        }
        let mut found = runs(&stands, true);
        found.retain(|run| run.len() >= n_shortest);
        let found = self.without_pauses(found, &joints);
        found.iter().map(|run| Plant::new(run.start, run.end - 1)).collect()
    }

    /// Finds the stretches over which one joint stands.
    fn stretches_of(&self, joint: &Joint, slow_below: &[f64], lowest: &[f64]) -> Vec<Range<usize>> {
        let &Joint { point, heights, floor } = joint;
        let speeds = self.speeds(point);
        let near = self.thresholds.height * self.height;
        let slow = |frame: usize, loose: f64| speeds[frame] < loose * slow_below[frame];
        let low = |frame: usize, loose: f64| heights[frame] < floor + loose * near;

        let n_frames = heights.len();
        let on_floor = stretches(n_frames, |f| slow(f, LOOSE) && low(f, LOOSE), |f| slow(f, 1.0) && low(f, 1.0));
        let mut stretches = stretches(n_frames, |f| slow(f, LOOSE), |f| slow(f, 1.0));
        stretches.retain(|stretch| {
            let carries = |&f: &usize| heights[f] < lowest[f] + near;
            stretch.len() >= self.n_frames_in(SHORTEST_RAISED_SECS)
                && stretch.clone().all(|f| !low(f, 1.0))
                && stretch.clone().filter(carries).count() >= self.n_frames_in(SHORTEST_SECS)
        });
        stretches.extend(on_floor);
        stretches
    }

    /// Leaves out the runs in which a swinging foot rests in mid-air, not far above the floor.
    fn without_pauses(&self, runs: Vec<Range<usize>>, joints: &[Joint; 2]) -> Vec<Range<usize>> {
        let above_floor = |f: usize| joints.iter().map(|j| j.heights[f] - j.floor).fold(f64::INFINITY, f64::min);
        let heights: Vec<f64> =
            (runs.iter().cloned()).map(|run| run.map(above_floor).fold(f64::INFINITY, f64::min)).collect();
        let most = |idx: usize| PAUSE_HEIGHT * self.height + heights[idx - 1].max(heights[idx + 1]);
        let is_pause = |idx: usize| {
            let inner = idx > 0 && idx + 1 < runs.len();
            inner && runs[idx].len() < self.n_frames_in(PAUSE_SECS) && heights[idx] > most(idx)
        };
        (runs.iter().enumerate()).filter(|&(idx, _)| !is_pause(idx)).map(|(_, run)| run.clone()).collect()
    }

    /// Returns a joint's speed at every frame: the smaller of those just before and just after, so that a foot counts
    /// as slow from the frame at which it stops to the frame at which it starts.
    fn speeds(&self, point: usize) -> Vec<f64> {
        let n_frames = self.tracks.n_frames();
        let span = ((SPEED_SECS / self.frame_time_secs).round().max(1.0) as usize).min(n_frames - 1);
        let (x, y, z) = (self.tracks.x(point), self.tracks.y(point), self.tracks.z(point));
        let per_sec = 1.0 / (span as f64 * self.frame_time_secs);
        let after: Vec<f64> = (0..n_frames - span)
            .map(|f| {
                let (dx, dy, dz) = (x[f + span] - x[f], y[f + span] - y[f], z[f + span] - z[f]);
                per_sec * (dx * dx + dy * dy + dz * dz).sqrt()
            })
            .collect();
        let at = |f: Option<usize>| f.and_then(|f| after.get(f)).copied().unwrap_or(f64::INFINITY);
        (0..n_frames).map(|f| at(Some(f)).min(at(f.checked_sub(span)))).collect()
    }

    /// Returns the strict bound of a slow joint's speed at every frame, clip's unit per second.
    fn slow_below(&self) -> Vec<f64> {
        let n_frames = self.tracks.n_frames();
        let reach = (0.5 * CARRIER_SECS / self.frame_time_secs).round().clamp(1.0, n_frames as f64) as usize;
        let flat = |frame: usize| DVec3 { y: 0.0, ..self.tracks.position(self.carrier, frame) };
        let least = self.thresholds.speed * self.height;
        (0..n_frames)
            .map(|frame| {
                let (from, to) = (frame.saturating_sub(reach), (frame + reach).min(n_frames - 1));
                let secs = (to - from).max(1) as f64 * self.frame_time_secs;
                least.max(self.thresholds.speed_share * flat(from).distance(flat(to)) / secs)
            })
            .collect()
    }

    /// Returns how many frames last at least this long.
    fn n_frames_in(&self, secs: f64) -> usize {
        (secs / self.frame_time_secs).ceil() as usize
    }
}

/// Returns the height of the lowest point at every frame.
fn lowest(tracks: &PointTracks) -> Vec<f64> {
    let mut lowest = vec![f64::INFINITY; tracks.n_frames()];
    for point in 0..tracks.n_points() {
        for (low, &y) in lowest.iter_mut().zip(tracks.y(point)) {
            *low = low.min(y);
        }
    }
    lowest
}

/// Returns the runs of `loose` frames that hold at least one `strict` one.
fn stretches(n_frames: usize, loose: impl Fn(usize) -> bool, strict: impl Fn(usize) -> bool) -> Vec<Range<usize>> {
    let loose: Vec<bool> = (0..n_frames).map(loose).collect();
    runs(&loose, true).into_iter().filter(|run| run.clone().any(&strict)).collect()
}

/// Returns the runs of frames that are `wanted`.
fn runs(frames: &[bool], wanted: bool) -> Vec<Range<usize>> {
    let mut runs = Vec::new();
    let mut at = 0;
    for run in frames.chunk_by(|a, b| a == b) {
        if run[0] == wanted {
            runs.push(at..at + run.len());
        }
        at += run.len();
    }
    runs
}

/// Returns the value below which this share of the values lies.
///
/// # Panics
///
/// When there are no values.
fn percentile(values: &[f64], share: f64) -> f64 {
    let mut values = values.to_vec();
    let at = ((values.len() - 1) as f64 * share).round() as usize;
    *values.select_nth_unstable_by(at, f64::total_cmp).1
}
