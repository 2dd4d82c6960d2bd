//! The carrier's offset: the smooth way to give in so that both legs keep the performer's reach.
//!
//! The offset is a cubic B-spline over time, so it is smooth by construction and has few unknowns. Its control points
//! make the sum of costs over the whole clip least: turn each knee no further than the performer's, keep planted legs
//! within reach, at any price, stay near plain path editing, and be smooth. The search is Newton's: in each step the
//! costs are replaced by springs ([`Cost`]), and the springs' equations form a band matrix. A step that would raise the
//! cost is taken again, damped. Stretches of the clip that are as they should be are left out of the next steps.
//!
//! The halves of a long clip are searched side by side, each on into the other; what they have in common is far enough
//! from either's end for both to agree, and is blended. Where both offsets keep a leg within reach, so does a blend.

use std::ops::Range;

use glam::DVec3;

use super::{
    banded::Banded,
    cost::{Cost, Wish},
};
use crate::{math::smootherstep, sync::halves};

/// Time between the frames that the problem is set up with, seconds; what is smooth needs no more.
const SAMPLE_SECS: f64 = 0.034;

/// Time between knots, seconds.
const KNOT_SECS: f64 = 0.1;

/// Price of the offset's third derivative squared, seconds⁶ per squared length.
const SMOOTHNESS: f64 = 1e-6;

/// Price of a leg's excess over its limit.
const LIMIT_PRICE: f64 = 1e5;

/// Share of that price and most steps with it: which legs are too long is not known at once.
const STAGES: [(f64, usize); 4] = [(1e-3, 2), (1e-2, 2), (1e-1, 2), (1.0, 30)];

/// A control point that has moved less than this share of a leg stays where it is …
const STEP_ACCURACY: f64 = 2e-4;

/// … unless one of so many on either side of it has moved more.
const MARGIN: usize = 5;

/// A cost that grows by less than this share has not grown.
const COST_ACCURACY: f64 = 1e-9;

/// Damping after a step that raised the cost, price of moving; it grows and falls by a factor of 4, down to none below the
/// least.
const FIRST_DAMPING: f64 = 1.0;
const LEAST_DAMPING: f64 = 0.1;

/// Time that both halves of a long clip have in common, seconds. They are blended over its middle third.
const COMMON_SECS: f64 = 3.0;

/// Scalars before an element in the band: four control points of three axes.
const WIDTH: usize = 12;

/// What the offsets at every frame are to be found for.
pub(super) struct Problem<'a> {
    /// One list per leg, all as long as the clip.
    pub(super) wishes: &'a [&'a [Wish]],
    /// Seconds from frame to frame.
    pub(super) frame_time_secs: f64,
    /// Body height.
    pub(super) height: f64,
}

/// Control points that are being searched for, with what the frames ask of them where they are.
struct Search<'a> {
    problem: &'a Problem<'a>,
    spline: Spline,
    /// Price of a leg's excess over its limit.
    limit_price: f64,
    points: Vec<DVec3>,
    intervals: Vec<Interval>,
    /// By how much an offset may lengthen any leg in each interval before one is too long.
    slacks: Vec<f64>,
    /// Points that may still have to move.
    active: Vec<bool>,
    /// Of the step that moves a point next.
    damping: Vec<f64>,
}

impl Problem<'_> {
    /// Returns the offset at each frame, world.
    pub(super) fn offsets(&self) -> Vec<DVec3> {
        let n = self.wishes.first().map_or(0, |leg| leg.len());
        if n == 0 {
            return Vec::new();
        }
        let common = (COMMON_SECS / self.frame_time_secs).ceil() as usize;
        let parts = halves(n, common.min(n / 4), |frames| {
            let wishes: Vec<&[Wish]> = self.wishes.iter().map(|leg| &leg[frames.clone()]).collect();
            Problem { wishes: &wishes, ..*self }.searched()
        });
        parts.into_iter().reduce(|first, second| joined(first, &second, n)).expect("at least one part")
    }

    /// Returns the offset at each frame, all found at once.
    fn searched(&self) -> Vec<DVec3> {
        let n = self.wishes[0].len();
        let mut search = Search::new(self, Spline::new(n, self.frame_time_secs));
        for (share, most_steps) in STAGES {
            search.set_limit_price(LIMIT_PRICE * share);
            for _ in 0..most_steps {
                if !search.step() {
                    break;
                }
            }
        }
        search.spline.at_frames(&search.points)
    }

    /// Returns by how much an offset may lengthen any leg before one is too long, for the frames from knot to knot.
    fn slacks(&self, spline: &Spline) -> Vec<f64> {
        let mut slacks = vec![f64::INFINITY; spline.n_points - 3];
        for leg in self.wishes {
            for (slack, wishes) in slacks.iter_mut().zip(leg.chunks(spline.interval)) {
                *slack = wishes.iter().map(Wish::slack).fold(*slack, f64::min);
            }
        }
        slacks
    }
}

/// Joins the offsets of two halves to those of `n_frames`, blended in the middle of what both have.
fn joined(mut first: Vec<DVec3>, second: &[DVec3], n_frames: usize) -> Vec<DVec3> {
    let n_common = first.len() + second.len() - n_frames;
    let (common, more) = second.split_at(n_common);
    let begin = first.len() - n_common;
    for (f, (is, other)) in first[begin..].iter_mut().zip(common).enumerate() {
        let share = smootherstep(3.0 * (f as f64 + 0.5) / n_common as f64 - 1.0);
        *is += share * (*other - *is);
    }
    first.extend_from_slice(more);
    first
}

impl<'a> Search<'a> {
    fn new(problem: &'a Problem<'a>, spline: Spline) -> Self {
        let n = spline.n_points;
        let mut search = Self {
            problem,
            spline,
            limit_price: 0.0,
            points: vec![DVec3::ZERO; n],
            intervals: Vec::new(),
            slacks: Vec::new(),
            active: vec![true; n],
            damping: vec![0.0; n],
        };
        search.slacks = problem.slacks(&search.spline);
        search.intervals = search.looked_at(0..n - 3, &search.points);
        search
    }

    /// Sets the price of overlong legs; points near them may have to move again.
    fn set_limit_price(&mut self, price: f64) {
        self.limit_price = price;
        for interval in 0..self.intervals.len() {
            if self.intervals[interval].any_long {
                self.intervals[interval] = self.interval(interval, &self.points, 0);
                self.activate(interval..interval + 4);
            }
        }
    }

    fn activate(&mut self, points: Range<usize>) {
        let end = (points.end + MARGIN).min(self.active.len());
        self.active[points.start.saturating_sub(MARGIN)..end].fill(true);
    }

    /// Moves all active points once; returns whether any is still active.
    fn step(&mut self) -> bool {
        let runs: Vec<Range<usize>> = runs(&self.active);
        self.active.fill(false);
        for run in &runs {
            self.step_run(run.clone());
        }
        !runs.is_empty()
    }

    /// Moves a run of points to where its springs are at rest, unless that raises the cost.
    fn step_run(&mut self, run: Range<usize>) {
        let touched = run.start.saturating_sub(3)..run.end.min(self.intervals.len());
        let damping = self.damping[run.clone()].iter().copied().fold(0.0, f64::max);
        let steps = self.rest(run.clone(), touched.clone(), damping * self.spline.knot_secs());
        let accuracy = STEP_ACCURACY * self.problem.wishes[0][0].length;
        let moved = |step: &DVec3| step.length_squared() > accuracy * accuracy;

        // The points that the touched intervals see, moved.
        let seen = touched.start..(touched.end + 3).min(self.points.len());
        let mut points = self.points[seen.clone()].to_vec();
        for (point, step) in points[run.start - seen.start..].iter_mut().zip(&steps) {
            *point += *step;
        }
        let intervals: Vec<Interval> =
            touched.clone().map(|interval| self.interval(interval, &points, seen.start)).collect();
        let sum = |intervals: &[Interval]| intervals.iter().map(|i| i.sums.value).sum::<f64>();
        let dt = self.problem.frame_time_secs;
        let was = dt * sum(&self.intervals[touched.clone()]) + self.spline.roughness(&self.points[seen.clone()]);
        let is = dt * sum(&intervals) + self.spline.roughness(&points);
        if is > was * (1.0 + COST_ACCURACY) {
            if steps.iter().any(moved) {
                self.damping[run.clone()].fill(FIRST_DAMPING.max(4.0 * damping));
                self.active[run].fill(true);
            }
            return;
        }
        self.damping[run.clone()].fill(if damping > LEAST_DAMPING { 0.25 * damping } else { 0.0 });
        if damping > 0.0 {
            // A damped step is short for that alone.
            self.active[run.clone()].fill(true);
        }
        self.points[seen].copy_from_slice(&points);
        self.intervals.splice(touched, intervals);
        for (point, _) in (run.start..).zip(&steps).filter(|(_, step)| moved(step)) {
            self.activate(point..point + 1);
        }
    }

    /// Returns the steps that take a run of points to where the springs are at rest, all other points held.
    fn rest(&self, run: Range<usize>, touched: Range<usize>, damping: f64) -> Vec<DVec3> {
        let mut equations = Equations::new(run);
        for interval in touched.clone() {
            equations.add(interval, &self.intervals[interval].sums, self.problem.frame_time_secs);
            equations.add_smoothness(interval, &self.points, self.spline.smoothness());
        }
        equations.solved(damping)
    }

    /// Looks at the frames of some intervals.
    fn looked_at(&self, intervals: Range<usize>, points: &[DVec3]) -> Vec<Interval> {
        intervals.map(|interval| self.interval(interval, points, 0)).collect()
    }

    /// Looks at the frames of one interval; `points` begin with control point `from`.
    fn interval(&self, interval: usize, points: &[DVec3], from: usize) -> Interval {
        let spline = &self.spline;
        let four = &points[interval - from..][..4];
        // The offset lies within the control points' hull: it is no longer than the longest of them.
        let farthest = four.iter().map(|point| point.length_squared()).fold(0.0, f64::max).sqrt();
        let may_be_long = farthest > self.slacks[interval];
        let first = interval * spline.interval;
        let mut found = Interval::default();
        for (phase, frame) in (first..(first + spline.interval).min(spline.n_frames)).enumerate() {
            // Wishes are smooth and looked at now and then; limits are not.
            let is_sample = phase.is_multiple_of(spline.stride);
            if !is_sample && !may_be_long {
                continue;
            }
            let basis = &spline.basis[phase];
            let offset = four[0] * basis[0] + four[1] * basis[1] + four[2] * basis[2] + four[3] * basis[3];
            let is_long = may_be_long && self.problem.wishes.iter().any(|leg| leg[frame].is_long(offset));
            if !is_sample && !is_long {
                continue;
            }
            let mut at = Cost::default();
            if is_sample {
                let share = spline.stride as f64;
                self.problem.wishes.iter().for_each(|leg| leg[frame].add_knee(offset, share, &mut at));
                at.add_offset(offset, self.problem.height, share);
            }
            if is_long {
                found.any_long = true;
                let long = self.problem.wishes.iter().map(|leg| &leg[frame]).filter(|wish| wish.is_long(offset));
                long.for_each(|wish| wish.add_limit(offset, self.limit_price, &mut at));
            }
            found.sums.add(&at, basis);
        }
        found
    }
}

/// Returns the runs of true values.
fn runs(values: &[bool]) -> Vec<Range<usize>> {
    let mut at = 0;
    let mut runs = Vec::new();
    for run in values.chunk_by(|a, b| a == b) {
        if run[0] {
            runs.push(at..at + run.len());
        }
        at += run.len();
    }
    runs
}

/// Returns the number of frames from one that is looked at to the next.
fn stride(frame_time_secs: f64) -> usize {
    (SAMPLE_SECS / frame_time_secs).floor().max(1.0) as usize
}

/// Returns the number of frames from knot to knot of the carrier's offset, the first knot being at the first frame: what
/// is cut out of a clip from a knot on is held more nearly as the clip is.
pub fn knot_frames(frame_time_secs: f64) -> usize {
    let stride = stride(frame_time_secs);
    stride * (KNOT_SECS / (stride as f64 * frame_time_secs)).round().max(1.0) as usize
}

/// A cubic B-spline with a knot every few frames.
struct Spline {
    n_frames: usize,
    frame_time_secs: f64,
    /// Frames from one that is looked at to the next.
    stride: usize,
    /// Frames from knot to knot, a multiple of the stride.
    interval: usize,
    n_points: usize,
    /// Values of the four basis functions at each frame of an interval.
    basis: Vec<[f64; 4]>,
}

/// Third difference of four control points.
const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];

impl Spline {
    fn new(n_frames: usize, frame_time_secs: f64) -> Self {
        let (stride, interval) = (stride(frame_time_secs), knot_frames(frame_time_secs));
        let basis = (0..interval).map(|phase| basis(phase as f64 / interval as f64)).collect();
        Self { n_frames, frame_time_secs, stride, interval, n_points: (n_frames - 1) / interval + 4, basis }
    }

    fn knot_secs(&self) -> f64 {
        self.interval as f64 * self.frame_time_secs
    }

    /// Returns the price of a third difference squared.
    fn smoothness(&self) -> f64 {
        SMOOTHNESS / self.knot_secs().powi(5)
    }

    /// Returns the price of control points not being smooth.
    fn roughness(&self, points: &[DVec3]) -> f64 {
        self.smoothness() * points.windows(4).map(|four| third(four).length_squared()).sum::<f64>()
    }

    /// Evaluates the spline at every frame.
    fn at_frames(&self, points: &[DVec3]) -> Vec<DVec3> {
        let mut offsets = Vec::with_capacity(self.n_frames + self.interval);
        for four in points.windows(4) {
            offsets
                .extend(self.basis.iter().map(|b| four[0] * b[0] + four[1] * b[1] + four[2] * b[2] + four[3] * b[3]));
        }
        offsets.truncate(self.n_frames);
        offsets
    }
}

fn third(four: &[DVec3]) -> DVec3 {
    four[0] * THIRD[0] + four[1] * THIRD[1] + four[2] * THIRD[2] + four[3] * THIRD[3]
}

/// What the frames from one knot to the next ask.
#[derive(Default)]
struct Interval {
    sums: Sums,
    any_long: bool,
}

/// What the frames of one interval add up to, as seen by its four control points.
#[derive(Default)]
struct Sums {
    value: f64,
    force: [DVec3; 4],
    /// By pair of control points, the second one not after the first.
    stiffness: [[f64; 6]; 10],
}

impl Sums {
    fn add(&mut self, cost: &Cost, basis: &[f64; 4]) {
        self.value += cost.value;
        let mut pair = 0;
        for k in 0..4 {
            self.force[k] += basis[k] * cost.force;
            for l in 0..=k {
                let product = basis[k] * basis[l];
                for (sum, value) in self.stiffness[pair].iter_mut().zip(&cost.stiffness) {
                    *sum += product * value;
                }
                pair += 1;
            }
        }
    }
}

/// The springs' equations for a run of control points.
struct Equations {
    run: Range<usize>,
    stiffness: Banded<WIDTH>,
    force: Vec<f64>,
}

impl Equations {
    fn new(run: Range<usize>) -> Self {
        let n = 3 * run.len();
        Self { run, stiffness: Banded::zeros(n), force: vec![0.0; n] }
    }

    /// Returns the row of a control point's first axis; none for a point that is held.
    fn row(&self, point: usize) -> Option<usize> {
        self.run.contains(&point).then(|| 3 * (point - self.run.start))
    }

    /// Adds what the frames of an interval ask.
    fn add(&mut self, interval: usize, sums: &Sums, scale: f64) {
        /// Where element (row, column) of a symmetric 3 × 3 matrix is.
        const AT: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
        for k in 0..4 {
            let Some(row) = self.row(interval + k) else { continue };
            for l in 0..=k {
                let Some(column) = self.row(interval + l) else { continue };
                let square = &sums.stiffness[k * (k + 1) / 2 + l];
                for (axis, at) in AT.iter().enumerate() {
                    let n_columns = if l == k { axis + 1 } else { 3 };
                    for (other, &at) in at[..n_columns].iter().enumerate() {
                        self.stiffness.add(row + axis, column + other, scale * square[at]);
                    }
                }
            }
            for (force, sum) in self.force[row..row + 3].iter_mut().zip(sums.force[k].to_array()) {
                *force += scale * sum;
            }
        }
    }

    /// Adds what smoothness asks of an interval's control points.
    fn add_smoothness(&mut self, interval: usize, points: &[DVec3], price: f64) {
        let third = third(&points[interval..][..4]).to_array();
        for (k, row_share) in THIRD.into_iter().enumerate() {
            let Some(row) = self.row(interval + k) else { continue };
            for (force, third) in self.force[row..].iter_mut().zip(third) {
                *force -= price * row_share * third;
            }
            for (l, column_share) in THIRD.into_iter().enumerate().take(k + 1) {
                let Some(column) = self.row(interval + l) else { continue };
                for axis in 0..3 {
                    self.stiffness.add(row + axis, column + axis, price * row_share * column_share);
                }
            }
        }
    }

    /// Solves for the steps of the run's points.
    fn solved(mut self, damping: f64) -> Vec<DVec3> {
        if damping > 0.0 {
            (0..self.force.len()).for_each(|row| self.stiffness.add(row, row, damping));
        }
        self.stiffness.solve(self.force).chunks_exact(3).map(DVec3::from_slice).collect()
    }
}

/// Returns the four cubic basis functions at a phase in [0, 1).
fn basis(t: f64) -> [f64; 4] {
    let s = 1.0 - t;
    [s * s * s, 4.0 - 6.0 * t * t + 3.0 * t * t * t, 4.0 - 6.0 * s * s + 3.0 * s * s * s, t * t * t].map(|b| b / 6.0)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::constrain::cost::bend;

    const DT: f64 = 1.0 / 60.0;

    fn wish(leg: DVec3, reach: f64, limit: f64) -> Wish {
        Wish { leg, moves: DVec3::ONE, bend: bend(reach, 0.91), length: 0.91, weight: 1.0, limit }
    }

    fn offsets(legs: &[&[Wish]]) -> Vec<DVec3> {
        Problem { wishes: legs, frame_time_secs: DT, height: 1.7 }.offsets()
    }

    #[test]
    fn legs_that_are_right_move_nothing() {
        let leg = [wish(DVec3::new(0.1, 0.8, 0.0), DVec3::new(0.1, 0.8, 0.0).length(), 0.9); 100];
        assert!(offsets(&[&leg, &leg]).iter().all(|o| o.length() < 1e-12));
        assert!(offsets(&[]).is_empty());
        assert_eq!(offsets(&[&leg[..1], &leg[..1]]).len(), 1);
    }

    #[test]
    fn an_overlong_leg_is_brought_within_its_limit_smoothly() {
        let long = |f: usize| if (40..60).contains(&f) { 0.03 } else { 0.0 };
        let leg: Vec<Wish> = (0..100).map(|f| wish(DVec3::new(0.0, 0.88 + long(f), 0.1), 0.88, 0.9)).collect();
        let found = offsets(&[&leg]);
        for (wish, offset) in leg.iter().zip(&found) {
            assert!((wish.leg + offset).length() <= wish.limit, "{}", (wish.leg + offset).length());
        }
        let jerk = |w: &[DVec3]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).length();
        assert!(found.windows(4).map(jerk).fold(0.0, f64::max) < 0.005);
        let ends = found[0].length().max(found[99].length());
        assert!(ends < 0.25 * found[50].length(), "it ends with its cause: {ends} {}", found[50].length());
    }

    /// A foot in swing may be anywhere, also where no leg reaches: what a step does there was once foretold wrong, and the
    /// search ended somewhere else with the next nudge.
    #[test]
    fn what_changes_a_little_changes_the_offset_a_little() {
        const NUDGE: f64 = 1e-3;
        let stands = [wish(DVec3::new(0.1, 0.86, 0.1), 0.84, 0.9); 100];
        let found = |nudge: f64| {
            let far = |f: usize| if (30..60).contains(&f) { 0.3 * (f as f64 - 45.0) / 15.0 } else { 0.0 };
            let swings: Vec<Wish> = (0..100)
                .map(|f| Wish { weight: 0.5, ..wish(DVec3::new(-0.1, 0.88, nudge + far(f)), 0.8, f64::INFINITY) })
                .collect();
            offsets(&[&stands, &swings])
        };
        let all: Vec<Vec<DVec3>> = (0..200).map(|n| found(NUDGE * f64::from(n))).collect();
        let apart = |two: &[Vec<DVec3>]| two[0].iter().zip(&two[1]).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
        let most = all.windows(2).map(apart).fold(0.0, f64::max);
        assert!(all[0].iter().any(|offset| offset.length() > 10.0 * NUDGE) && most < 1.5 * NUDGE, "{most}");
    }

    #[test]
    fn halves_of_a_long_clip_agree_with_the_whole() {
        let stretch = |f: usize| 0.86 + 0.03 * (f as f64 * 0.11).sin() + 0.02 * (f as f64 * 0.013).cos();
        let leg: Vec<Wish> = (0..5000).map(|f| wish(DVec3::new(0.05, stretch(f), 0.1), 0.86, 0.88)).collect();
        let problem = Problem { wishes: &[&leg], frame_time_secs: DT, height: 1.7 };
        let (found, whole) = (problem.offsets(), problem.searched());
        assert_eq!(found.len(), leg.len());
        for (wish, offset) in leg.iter().zip(&found) {
            assert!((wish.leg + offset).length() <= wish.limit);
        }
        let apart: Vec<f64> = found.iter().zip(&whole).map(|(a, b)| a.distance(*b)).collect();
        assert!(apart.iter().copied().fold(0.0, f64::max) < 1e-4, "{apart:?}");
        assert!(whole.iter().any(|offset| offset.length() > 0.01));
    }

    #[test]
    fn a_foot_that_follows_asks_nothing() {
        let leg = [Wish { moves: DVec3::ZERO, ..wish(DVec3::new(0.0, 0.7, 0.0), 0.8, f64::INFINITY) }; 50];
        assert!(offsets(&[&leg]).iter().all(|o| o.length() < 1e-12));
    }

    #[test]
    fn basis_functions_add_up_to_one() {
        for phase in 0..10 {
            assert!((basis(f64::from(phase) / 10.0).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
