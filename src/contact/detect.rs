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

/// A foot that moves between two plants without leaving this circle, body heights …
const STEP_LENGTH: f64 = 0.05;

/// … and without being lifted by this, body heights, pivots or settles: no step, one plant.
const STEP_HEIGHT: f64 = 0.03;

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
        self.keep_standing(&mut found, &joints);
        self.join_pivots(&mut found, &joints);
        let mut plants: Vec<Plant> = found.into_iter().map(|run| self.trimmed(run, leg, slow_below)).collect();
        plants.retain(|plant| plant.n_frames() >= n_shortest);
        plants
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
    fn keep_standing(&self, runs: &mut Vec<Range<usize>>, joints: &[Joint; 2]) {
        let heights: Vec<f64> = runs.iter().map(|run| lowest_in(joints, run.clone())).collect();
        let (shortest, least) = (self.n_frames_in(PAUSE_SECS), PAUSE_HEIGHT * self.height);
        let mut idx = 0usize;
        runs.retain(|run| {
            let around = idx.checked_sub(1).and_then(|before| heights.get(before)).zip(heights.get(idx + 1));
            let rests = around.is_some_and(|(before, after)| heights[idx] > before.max(*after) + least);
            idx += 1;
            !(rests && run.len() < shortest)
        });
    }

    /// Joins runs between which the foot neither goes anywhere nor is lifted.
    fn join_pivots(&self, runs: &mut Vec<Range<usize>>, joints: &[Joint; 2]) {
        let goes = |from: usize, to: usize| {
            let ways = joints.iter().map(|joint| self.tracks.track(joint.point).flat_distance(from, to));
            ways.fold(f64::INFINITY, f64::min) > STEP_LENGTH * self.height
        };
        let lifted_above = STEP_HEIGHT * self.height;
        // Each with the least that the foot is above its floor in it.
        let mut joined: Vec<(Range<usize>, f64)> = Vec::with_capacity(runs.len());
        for run in runs.drain(..) {
            let lowest = lowest_in(joints, run.clone());
            if let Some((before, lowest_before)) = joined.last_mut() {
                let lifted = |frame| above_floor(joints, frame) > lowest.max(*lowest_before) + lifted_above;
                let (last, mut hole) = (before.end - 1, before.end..run.start);
                if !goes(last, run.start) && !hole.any(|frame| goes(last, frame) || lifted(frame)) {
                    (before.end, *lowest_before) = (run.end, lowest.min(*lowest_before));
                    continue;
                }
            }
            joined.push((run, lowest));
        }
        runs.extend(joined.into_iter().map(|(run, _)| run));
    }

    /// Takes off a run's ends the few frames that are slow only by the looser bound or over several frames;
    /// what the clip's own ends cut off stays. When a foot stops and starts is known to a frame, so what is left is
    /// given back a frame where that makes it long enough for a plant.
    fn trimmed(&self, run: Range<usize>, leg: &Leg, slow_below: &[f64]) -> Plant {
        let Range { mut start, mut end } = run.clone();
        let fast = |from: usize| {
            let step = |point| self.tracks.position(point, from).distance(self.tracks.position(point, from + 1));
            step(leg.ankle.idx()).min(step(leg.toe)) >= slow_below[from] * self.frame_time_secs
        };
        for _ in 0..self.span() {
            if 0 < start && start + 1 < end && fast(start) {
                start += 1;
            }
            if end < slow_below.len() && start + 1 < end && fast(end - 2) {
                end -= 1;
            }
        }
        if end - start + 1 == self.n_frames_in(SHORTEST_SECS) {
            if end < run.end {
                end += 1;
            } else {
                start -= 1;
            }
        }
        Plant::new(start, end - 1)
    }

    /// Returns a joint's speed at every frame: the smaller of those just before and just after, so that a foot counts
    /// as slow from the frame at which it stops to the frame at which it starts.
    fn speeds(&self, point: usize) -> Vec<f64> {
        let n_frames = self.tracks.n_frames();
        let span = self.span();
        let (x, y, z) = (self.tracks.x(point), self.tracks.y(point), self.tracks.z(point));
        // One frame is no motion: its foot stands still.
        let per_sec = 1.0 / (span.max(1) as f64 * self.frame_time_secs);
        let after: Vec<f64> = (0..n_frames - span)
            .map(|f| {
                let (dx, dy, dz) = (x[f + span] - x[f], y[f + span] - y[f], z[f + span] - z[f]);
                per_sec * (dx * dx + dy * dy + dz * dz).sqrt()
            })
            .collect();
        let at = |f: Option<usize>| f.and_then(|f| after.get(f)).copied().unwrap_or(f64::INFINITY);
        (0..n_frames).map(|f| at(Some(f)).min(at(f.checked_sub(span)))).collect()
    }

    /// Returns the number of frames over which a speed is taken; 0 for a clip of one frame.
    fn span(&self) -> usize {
        ((SPEED_SECS / self.frame_time_secs).round().max(1.0) as usize).min(self.tracks.n_frames() - 1)
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

/// Returns how far the foot is above its floor at a frame: the lower of its joints.
fn above_floor(joints: &[Joint; 2], frame: usize) -> f64 {
    joints.iter().map(|joint| joint.heights[frame] - joint.floor).fold(f64::INFINITY, f64::min)
}

/// Returns the least that the foot is above its floor in a run.
fn lowest_in(joints: &[Joint; 2], run: Range<usize>) -> f64 {
    run.map(|frame| above_floor(joints, frame)).fold(f64::INFINITY, f64::min)
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

#[cfg(test)]
mod tests {
    use std::f64::consts::{PI, TAU};

    use glam::DQuat;

    use super::*;
    use crate::{motion::Side, skeleton::JointId};

    const HEIGHT: f64 = 1.7;

    const LEGS: [Leg; 2] = [
        Leg { side: Side::Left, hip: JointId(0), knee: JointId(0), ankle: JointId(1), toe: 2 },
        Leg { side: Side::Right, hip: JointId(0), knee: JointId(0), ankle: JointId(3), toe: 4 },
    ];

    /// A made-up motion: when each foot stands, and where.
    struct Motion {
        fps: f64,
        n_frames: usize,
        /// Seconds from one contact of a foot to its next.
        cycle: f64,
        /// Share of the cycle in which the foot stands.
        stands: f64,
        /// When the right foot is where the left is, share of the cycle: 0.5 in walks, 0 in jumps.
        right_after: f64,
        /// Body heights per second along z.
        speed: f64,
        /// Height gained per cycle, body heights.
        climb: f64,
        /// Radians per second; feet and body turn about the origin.
        turn: f64,
    }

    const WALK: Motion = Motion {
        fps: 60.0,
        n_frames: 400,
        cycle: 1.1,
        stands: 0.62,
        right_after: 0.5,
        speed: 0.75,
        climb: 0.0,
        turn: 0.0,
    };

    impl Motion {
        /// Returns how many contacts were begun at a frame, and how far the current one and the swing after it are.
        fn phase(&self, foot: usize, frame: usize) -> (f64, f64) {
            let cycles = frame as f64 / self.fps / self.cycle + if foot == 0 { 0.0 } else { self.right_after };
            (cycles.floor(), cycles.fract())
        }

        /// Returns the plants as they were made.
        fn truth(&self, foot: usize) -> Vec<(usize, usize)> {
            let stands: Vec<bool> = (0..self.n_frames).map(|f| self.phase(foot, f).1 <= self.stands).collect();
            runs(&stands, true).into_iter().map(|run| (run.start, run.end - 1)).collect()
        }

        fn position(&self, point: usize, frame: usize) -> DVec3 {
            let secs = frame as f64 / self.fps;
            let turned = |angle: f64, p: DVec3| HEIGHT * (DQuat::from_rotation_y(angle) * p);
            if point == 0 {
                let height = 0.5 + self.climb * secs / self.cycle;
                return turned(self.turn * secs, DVec3::new(0.0, height, self.speed * secs));
            }
            let (foot, is_toe) = ((point - 1) / 2, point.is_multiple_of(2));
            let (n_begun, phase) = self.phase(foot, frame);
            let swing = ((phase - self.stands) / (1.0 - self.stands)).max(0.0);
            let walked = n_begun + 0.5 * (1.0 - (PI * swing).cos()) - if foot == 0 { 0.0 } else { self.right_after };
            let lift = 0.1 * (PI * swing).sin() + self.climb * walked;
            // The heel comes up over the last third of the contact, about the toe, and comes down again in the swing.
            let rolled = ((phase / self.stands - 0.67) / 0.33).clamp(0.0, 1.0) * (1.0 - swing);
            let heel = DQuat::from_rotation_x(0.7 * rolled) * DVec3::new(0.0, 0.03, -0.08);
            let x = if foot == 0 { 0.06 } else { -0.06 };
            let toe = DVec3::new(x, 0.02 + lift, 0.04 + self.speed * self.cycle * walked);
            turned(self.turn * self.cycle * walked, if is_toe { toe } else { toe + heel })
        }

        fn tracks(&self) -> PointTracks {
            PointTracks::from_fn(5, self.n_frames, |point, frame| self.position(point, frame))
        }

        fn plants(&self, tracks: &PointTracks) -> Vec<Vec<(usize, usize)>> {
            found(tracks, 1.0 / self.fps, HEIGHT)
        }

        /// Checks that every contact is found, within 2 frames or 1/30 s at each end, and nothing else.
        #[track_caller]
        fn check(&self, name: &str) {
            let tolerance = (self.fps / 30.0).max(2.0);
            for (foot, plants) in self.plants(&self.tracks()).into_iter().enumerate() {
                let truth = self.truth(foot);
                assert_eq!(plants.len(), truth.len(), "{name}, foot {foot}: {plants:?} instead of {truth:?}");
                for (found, made) in plants.iter().zip(&truth) {
                    let off = found.0.abs_diff(made.0).max(found.1.abs_diff(made.1));
                    assert!(off as f64 <= tolerance, "{name}, foot {foot}: {found:?} instead of {made:?}");
                }
            }
        }
    }

    fn found(tracks: &PointTracks, frame_time_secs: f64, height: f64) -> Vec<Vec<(usize, usize)>> {
        let thresholds = Thresholds::default();
        let detection = Detection { tracks, carrier: 0, legs: &LEGS, frame_time_secs, height, thresholds };
        let ranges = |foot: &FootPlants| foot.plants.iter().map(|plant| (plant.first, plant.last)).collect();
        detection.plants().iter().map(ranges).collect()
    }

    #[test]
    fn walks_runs_and_jumps_are_found_at_any_frame_rate() {
        for fps in [24.0, 30.0, 60.0, 100.0, 120.0, 240.0] {
            let walk = Motion { fps, n_frames: (6.0 * fps) as usize, ..WALK };
            walk.check(&format!("walk at {fps}"));
            Motion { speed: -0.5, ..walk }.check(&format!("walk backwards at {fps}"));
            Motion { speed: 0.0, turn: 1.5, ..walk }.check(&format!("turn on the spot at {fps}"));
            Motion { speed: 0.0, ..walk }.check(&format!("steps on the spot at {fps}"));
            Motion { speed: 2.1, cycle: 0.72, stands: 0.32, ..walk }.check(&format!("run at {fps}"));
            if fps >= 60.0 {
                Motion { speed: 4.0, cycle: 0.5, stands: 0.24, ..walk }.check(&format!("sprint at {fps}"));
            }
            Motion { speed: 0.9, cycle: 1.3, stands: 0.6, right_after: 0.0, ..walk }.check(&format!("jumps at {fps}"));
        }
    }

    #[test]
    fn stairs_and_slopes_are_found() {
        for climb in [0.2, -0.2, 0.05, -0.05] {
            // No contact is cut off by the clip's ends: what is left of one might be too short to tell.
            let stairs = Motion { climb, speed: 0.4, n_frames: 390, right_after: 0.7, ..WALK };
            stairs.check(&format!("climbing {climb} a cycle"));
        }
    }

    #[test]
    fn a_foot_held_up_does_not_stand() {
        // The left foot is lifted at frame 60, kept still in the air and put down at frame 240.
        let position = |point: usize, frame: usize| {
            let lifted =
                ((frame as f64 - 60.0) / 20.0).clamp(0.0, 1.0) - ((frame as f64 - 220.0) / 20.0).clamp(0.0, 1.0);
            let up = if point == 1 || point == 2 { 0.25 * HEIGHT * lifted } else { 0.0 };
            DVec3::new(point as f64, up, 0.0)
        };
        let tracks = PointTracks::from_fn(5, 300, position);
        let [left, right] = &found(&tracks, 1.0 / 60.0, HEIGHT)[..] else { panic!("two feet") };
        assert_eq!(right, &[(0, 299)]);
        let [(0, up), (down, 299)] = left[..] else { panic!("{left:?}") };
        assert!(up.abs_diff(60) <= 2 && down.abs_diff(240) <= 2, "{left:?}");
    }

    #[test]
    fn a_foot_that_rests_in_mid_swing_does_not_stand() {
        let walk = Motion { fps: 120.0, n_frames: 700, ..WALK };
        let truth = walk.truth(0);
        // Half of the swing after the second contact is spent at one low place.
        let (from, to) = (truth[1].1 + 12, truth[2].0 - 12);
        assert!(to - from > 15 && to - from < 30);
        let position = |point: usize, frame: usize| {
            let resting = (1..=2).contains(&point) && (from..=to).contains(&frame);
            let p = walk.position(point, if resting { from } else { frame });
            if resting { DVec3 { y: (if point == 1 { 0.1 } else { 0.06 }) * HEIGHT, ..p } } else { p }
        };
        let resting = PointTracks::from_fn(5, walk.n_frames, position);
        assert_eq!(walk.plants(&resting), walk.plants(&walk.tracks()));
    }

    #[test]
    fn a_pivot_is_no_step_and_a_step_is() {
        // Both feet stand; at frame 100 the left one turns by a radian about a point a little outside its toe. Then the
        // right one is put down elsewhere, close to the ground.
        let moved = |frame: usize, from: f64| 0.5 - 0.5 * (PI * ((frame as f64 - from) / 15.0).clamp(0.0, 1.0)).cos();
        let position = |point: usize, frame: usize| {
            let foot = DVec3::new(0.0, 0.03, if point.is_multiple_of(2) { 0.03 } else { -0.08 });
            HEIGHT
                * match point {
                    0 => DVec3::Y,
                    1 | 2 => DVec3::X + DQuat::from_rotation_y(moved(frame, 100.0)) * foot,
                    _ => DVec3::Z * 0.12 * moved(frame, 200.0) + foot,
                }
        };
        let tracks = PointTracks::from_fn(5, 300, position);
        let plants = found(&tracks, 1.0 / 60.0, HEIGHT);
        assert_eq!(plants[0], [(0, 299)]);
        assert_eq!(plants[1].len(), 2, "{plants:?}");
    }

    #[test]
    fn trembling_does_not_break_plants() {
        // Steps of 0.0013 H in any direction, 0.16 H/s at this rate.
        let walk = Motion { fps: 120.0, n_frames: 700, ..WALK };
        let noise = |seed: usize| ((seed as f64 * 12.9898).sin() * 43758.5453).fract() - 0.5;
        let trembling = PointTracks::from_fn(5, walk.n_frames, |point, frame| {
            let seed = 3 * (point * walk.n_frames + frame);
            walk.position(point, frame) + 0.002 * HEIGHT * DVec3::new(noise(seed), noise(seed + 1), noise(seed + 2))
        });
        for (plants, truth) in walk.plants(&trembling).iter().zip([walk.truth(0), walk.truth(1)]) {
            assert_eq!(plants.len(), truth.len(), "{plants:?} instead of {truth:?}");
        }
    }

    #[test]
    fn what_trimming_leaves_lasts_or_is_no_plant() {
        let fps = 120.0;
        // Both feet sweep over the floor, slowest at frame 150; speeds in body heights per second.
        let plants = |slowest: f64, slower_a_frame: f64| {
            let speed = |frame: usize| slowest + slower_a_frame * (frame as f64 - 150.0).abs();
            let gone = |frame: usize| HEIGHT / fps * (0..=frame).map(speed).sum::<f64>();
            let place = |point: usize, frame| match point {
                0 => HEIGHT * DVec3::Y,
                _ => DVec3::new(point as f64, 0.0, gone(frame)),
            };
            found(&PointTracks::from_fn(5, 300, place), 1.0 / fps, HEIGHT)
        };
        // Slow over several frames for 12 of them, from frame to frame for 6, which is 50 ms.
        assert_eq!(plants(0.1, 0.03), [[], []]);
        // For 14 and for 8, 67 ms.
        assert_eq!(plants(0.08, 0.025), [[(146, 153)], [(146, 153)]]);
    }

    #[test]
    fn plants_do_not_depend_on_place_direction_and_size() {
        let walk = Motion { turn: 0.3, ..WALK };
        let tracks = walk.tracks();
        let plants = walk.plants(&tracks);
        let (turn, shift, size) = (DQuat::from_rotation_y(0.25 * TAU + 0.3), DVec3::new(30.0, -7.0, 4.0), 57.0);
        let moved = PointTracks::from_fn(5, walk.n_frames, |p, f| size * (turn * tracks.position(p, f)) + shift);
        assert_eq!(found(&moved, 1.0 / walk.fps, size * HEIGHT), plants);
    }

    #[test]
    fn standing_and_very_short_clips_are_no_trouble() {
        for n_frames in [1, 2, 3, 30] {
            let still = PointTracks::from_fn(5, n_frames, |point, _| DVec3::new(point as f64, 0.0, 0.0));
            let plants = if n_frames == 30 { vec![(0, 29)] } else { Vec::new() };
            assert_eq!(found(&still, 0.01, HEIGHT), [plants.clone(), plants]);
            assert_eq!(found(&still, 1e-9, HEIGHT).len(), 2, "no time passes");
            assert_eq!(found(&still, 1e9, HEIGHT), [[(0, n_frames - 1)], [(0, n_frames - 1)]], "ages pass");
        }
    }
}
