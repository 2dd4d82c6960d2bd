//! The carrier's offset: the smooth way to give in so that both legs keep the performer's reach.
//!
//! The offset is a cubic B-spline over time, so it is smooth by construction and has few unknowns. Its control points
//! make the sum of costs over the whole clip least: turn each knee no further than the performer's, keep planted legs
//! within reach, at any price, stay near plain path editing, and be smooth. The search is Newton's: in each step the
//! costs are replaced by springs ([`Cost`]), and the springs' equations form a band matrix. A step that would raise the
//! cost is taken again, damped.

use glam::DVec3;

use super::{
    banded::Banded,
    cost::{Cost, Wish},
};

/// Time between the frames that the problem is set up with, seconds; what is smooth needs no more.
const SAMPLE_SECS: f64 = 0.025;

/// Time between knots, seconds.
const KNOT_SECS: f64 = 0.1;

/// Price of the offset's third derivative squared, seconds⁶ per squared length.
const SMOOTHNESS: f64 = 1e-6;

/// Price of a leg's excess over its limit.
const LIMIT_PRICE: f64 = 1e5;

/// Share of that price and most steps with it: which legs are too long is not known at once.
const STAGES: [(f64, usize); 4] = [(1e-3, 2), (1e-2, 2), (1e-1, 2), (1.0, 30)];

/// A step that moves the carrier less than this share of a leg ends a stage.
const STEP_ACCURACY: f64 = 5e-5;

/// A cost that grows by less than this share has not grown.
const COST_ACCURACY: f64 = 1e-9;

/// Damping after a step that raised the cost, price of moving; it grows and falls by a factor of 4.
const FIRST_DAMPING: f64 = 1.0;

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

/// A guess at the control points, with the offsets and the springs there.
struct Guess {
    points: Vec<f64>,
    offsets: Vec<DVec3>,
    cost: f64,
    stiffness: Banded<WIDTH>,
    force: Vec<f64>,
    /// Whether any leg is too long.
    any_long: bool,
}

impl Problem<'_> {
    /// Returns the offset at each frame, world.
    pub(super) fn offsets(&self) -> Vec<DVec3> {
        let n = self.wishes.first().map_or(0, |leg| leg.len());
        if n == 0 {
            return Vec::new();
        }
        let spline = Spline::new(n, self.frame_time_secs);
        let accuracy = STEP_ACCURACY * self.wishes[0][0].length;
        let mut points = vec![0.0; 3 * spline.n_points];
        for (share, most_steps) in STAGES {
            let mut guess = self.guess(&spline, points, LIMIT_PRICE * share);
            let mut damping = 0.0;
            let mut moved = f64::INFINITY;
            for _ in 0..most_steps {
                let next = self.guess(&spline, guess.stepped(damping * spline.knot_secs()), LIMIT_PRICE * share);
                moved = farthest(&guess.offsets, &next.offsets);
                if next.cost <= guess.cost * (1.0 + COST_ACCURACY) {
                    guess = next;
                    damping = if damping > FIRST_DAMPING { 0.25 * damping } else { 0.0 };
                } else {
                    damping = FIRST_DAMPING.max(4.0 * damping);
                }
                if moved < accuracy {
                    break;
                }
            }
            if share == 1.0 || (moved < accuracy && !guess.any_long) {
                return guess.offsets;
            }
            points = guess.points;
        }
        unreachable!("the last stage has the whole price")
    }

    /// Sets up the springs about a guess.
    fn guess(&self, spline: &Spline, points: Vec<f64>, limit_price: f64) -> Guess {
        let offsets = spline.at_frames(&points);
        let mut stiffness = Banded::<WIDTH>::zeros(points.len());
        let mut force = vec![0.0; points.len()];
        let (mut cost, mut any_long) = (0.0, false);
        for (interval, first) in (0..spline.n_frames).step_by(spline.interval).enumerate() {
            let mut sums = Sums::default();
            for frame in first..(first + spline.interval).min(spline.n_frames) {
                let offset = offsets[frame];
                // Wishes are smooth and looked at now and then; limits are not.
                let is_sample = (frame - first).is_multiple_of(spline.stride);
                let is_long = self.wishes.iter().any(|leg| leg[frame].is_long(offset));
                if !is_sample && !is_long {
                    continue;
                }
                let mut at = Cost::default();
                if is_sample {
                    let share = spline.stride as f64;
                    self.wishes.iter().for_each(|leg| leg[frame].add_knee(offset, share, &mut at));
                    at.add_offset(offset, self.height, share);
                }
                if is_long {
                    any_long = true;
                    let long = self.wishes.iter().map(|leg| &leg[frame]).filter(|wish| wish.is_long(offset));
                    long.for_each(|wish| wish.add_limit(offset, limit_price, &mut at));
                }
                cost += at.value;
                sums.add(&at, &spline.basis[frame - first]);
            }
            sums.scatter(interval, self.frame_time_secs, &mut stiffness, &mut force);
        }
        cost = cost * self.frame_time_secs + spline.add_smoothness(&points, &mut stiffness, &mut force);
        Guess { points, offsets, cost, stiffness, force, any_long }
    }
}

impl Guess {
    /// Returns the control points at which the springs are at rest, damped.
    fn stepped(&self, damping: f64) -> Vec<f64> {
        let mut stiffness = self.stiffness.clone();
        if damping > 0.0 {
            (0..self.points.len()).for_each(|row| stiffness.add(row, row, damping));
        }
        let mut step = self.force.clone();
        stiffness.solve(&mut step);
        step.iter_mut().zip(&self.points).for_each(|(step, point)| *step += point);
        step
    }
}

/// Returns the largest distance between two lists.
fn farthest(a: &[DVec3], b: &[DVec3]) -> f64 {
    a.iter().zip(b).map(|(a, b)| a.distance_squared(*b)).fold(0.0, f64::max).sqrt()
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

impl Spline {
    fn new(n_frames: usize, frame_time_secs: f64) -> Self {
        let stride = (SAMPLE_SECS / frame_time_secs).floor().max(1.0) as usize;
        let interval = stride * (KNOT_SECS / (stride as f64 * frame_time_secs)).round().max(1.0) as usize;
        let basis = (0..interval).map(|phase| basis(phase as f64 / interval as f64)).collect();
        Self { n_frames, frame_time_secs, stride, interval, n_points: (n_frames - 1) / interval + 4, basis }
    }

    fn knot_secs(&self) -> f64 {
        self.interval as f64 * self.frame_time_secs
    }

    /// Adds the springs of smoothness about control points; returns its cost.
    fn add_smoothness(&self, points: &[f64], stiffness: &mut Banded<WIDTH>, force: &mut [f64]) -> f64 {
        const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
        let price = SMOOTHNESS / self.knot_secs().powi(5);
        let mut cost = 0.0;
        for first in 0..3 * (self.n_points - 3) {
            let at = |k: usize| first + 3 * k;
            let third: f64 = (0..4).map(|k| THIRD[k] * points[at(k)]).sum();
            cost += price * third * third;
            for k in 0..4 {
                force[at(k)] -= price * third * THIRD[k];
                for l in 0..=k {
                    stiffness.add(at(k), at(l), price * THIRD[k] * THIRD[l]);
                }
            }
        }
        cost
    }

    /// Evaluates the spline at every frame.
    fn at_frames(&self, points: &[f64]) -> Vec<DVec3> {
        let mut offsets = Vec::with_capacity(self.n_frames + self.interval);
        for interval in 0..self.n_frames.div_ceil(self.interval) {
            let four = [0, 1, 2, 3].map(|k| DVec3::from_slice(&points[3 * (interval + k)..]));
            offsets
                .extend(self.basis.iter().map(|b| four[0] * b[0] + four[1] * b[1] + four[2] * b[2] + four[3] * b[3]));
        }
        offsets.truncate(self.n_frames);
        offsets
    }
}

/// What the frames of one interval add up to, as seen by its four control points.
#[derive(Default)]
struct Sums {
    /// By pair of control points, the second one not after the first.
    stiffness: [[f64; 6]; 10],
    force: [DVec3; 4],
}

impl Sums {
    fn add(&mut self, cost: &Cost, basis: &[f64; 4]) {
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

    /// Adds these sums to the equations.
    fn scatter(&self, interval: usize, scale: f64, stiffness: &mut Banded<WIDTH>, force: &mut [f64]) {
        /// Where element (row, column) of a symmetric 3 × 3 matrix is.
        const AT: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
        let mut pair = 0;
        for k in 0..4 {
            for l in 0..=k {
                for axis in 0..3 {
                    let row = 3 * (interval + k) + axis;
                    for other in 0..if l == k { axis + 1 } else { 3 } {
                        stiffness.add(row, 3 * (interval + l) + other, scale * self.stiffness[pair][AT[axis][other]]);
                    }
                }
                pair += 1;
            }
            for axis in 0..3 {
                force[3 * (interval + k) + axis] += scale * self.force[k][axis];
            }
        }
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

    const DT: f64 = 1.0 / 60.0;

    fn wish(leg: DVec3, reach: f64, limit: f64) -> Wish {
        Wish { leg, moves: DVec3::ONE, reach, length: 0.91, weight: 1.0, limit }
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
