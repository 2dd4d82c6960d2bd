//! The carrier's offset: the smooth way to give in so that both legs keep the performer's reach.
//!
//! The offset is a cubic B-spline over time, so it is smooth by construction and has few unknowns. Its control points
//! solve one least-squares problem over the whole clip, a few times over (Gauss–Newton): keep each leg's distance from
//! hip to ankle near the source's, the more so the faster the knee turns per unit of reach; keep planted legs within
//! reach, at any price; else move little and smoothly.

use glam::DVec3;

use super::banded::Banded;

/// Time between the frames that the problem is set up with, seconds; what is smooth needs no more.
const SAMPLE_SECS: f64 = 0.025;

/// Time between knots, seconds.
const KNOT_SECS: f64 = 0.1;

/// Price of the offset's third derivative squared, seconds⁶ per squared length.
const SMOOTHNESS: f64 = 1e-6;

/// Price of the offset itself.
const NEARNESS: f64 = 0.2;

/// Price of a leg's excess over its limit.
const LIMIT_PRICE: f64 = 1e5;

/// Share of that price in the first steps: which legs are too long is not known at once.
const LIMIT_PRICES: [f64; 4] = [1e-3, 1e-2, 1e-1, 1.0];

/// How far within its limit an overlong leg is brought, share of the limit.
const LIMIT_MARGIN: f64 = 2e-4;

/// Most Gauss–Newton steps.
const MOST_STEPS: usize = 20;

/// A step that moves the carrier less than this share of a leg ends the search.
const STEP_ACCURACY: f64 = 5e-5;

/// Scalars before an element in the band: four control points of three axes.
const WIDTH: usize = 12;

/// What one leg asks of the carrier at one frame.
#[derive(Clone, Copy, Debug)]
pub(super) struct Wish {
    /// From the ankle's target to the hip without offset, world.
    pub(super) leg: DVec3,
    /// Distance from hip to ankle to be kept.
    pub(super) reach: f64,
    /// Price of differing from it.
    pub(super) weight: f64,
    /// Distance not to be exceeded; infinite for a leg in swing.
    pub(super) limit: f64,
}

/// Returns the offset at each frame, world. `wishes` has one list per leg, all as long as the clip.
pub(super) fn offsets(wishes: &[Vec<Wish>], frame_time_secs: f64) -> Vec<DVec3> {
    let n = wishes.first().map_or(0, Vec::len);
    if n == 0 {
        return Vec::new();
    }
    let spline = Spline::new(n, frame_time_secs);
    let mut points = vec![0.0; 3 * spline.n_points];
    let mut offsets = vec![DVec3::ZERO; n];
    for step in 0..MOST_STEPS {
        let limit_price = LIMIT_PRICE * LIMIT_PRICES[step.min(LIMIT_PRICES.len() - 1)];
        let (matrix, mut rhs) = spline.equations(wishes, &offsets, limit_price, frame_time_secs);
        matrix.solve(&mut rhs);
        points.copy_from_slice(&rhs);
        let moved = spline.fill(&points, &mut offsets);
        let leg = wishes[0][0].reach;
        if step >= LIMIT_PRICES.len() && moved < STEP_ACCURACY * leg {
            break;
        }
    }
    offsets
}

/// A cubic B-spline with a knot every few frames.
struct Spline {
    n_frames: usize,
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
        Self { n_frames, stride, interval, n_points: (n_frames - 1) / interval + 4, basis }
    }

    /// Sets up the normal equations, linear about the offsets as they are.
    fn equations(
        &self,
        wishes: &[Vec<Wish>],
        offsets: &[DVec3],
        limit_price: f64,
        frame_time_secs: f64,
    ) -> (Banded<WIDTH>, Vec<f64>) {
        let mut matrix = Banded::<WIDTH>::zeros(3 * self.n_points);
        let mut rhs = vec![0.0; 3 * self.n_points];
        for (interval, first) in (0..self.n_frames).step_by(self.interval).enumerate() {
            let mut pairs = [[0.0; 6]; 10];
            let mut sums = [DVec3::ZERO; 4];
            for frame in first..(first + self.interval).min(self.n_frames) {
                // Wishes are smooth and looked at now and then; limits are not.
                let share = if (frame - first).is_multiple_of(self.stride) { self.stride as f64 } else { 0.0 };
                let (mut square, mut pull) = ([0.0; 6], DVec3::ZERO);
                let mut asked = false;
                for leg in wishes {
                    asked |= leg[frame].add_to(offsets[frame], share, limit_price, &mut square, &mut pull);
                }
                if !asked {
                    continue;
                }
                let basis = &self.basis[frame - first];
                let mut pair = 0;
                for k in 0..4 {
                    sums[k] += basis[k] * pull;
                    for l in 0..=k {
                        let product = basis[k] * basis[l];
                        for (sum, value) in pairs[pair].iter_mut().zip(&square) {
                            *sum += product * value;
                        }
                        pair += 1;
                    }
                }
            }
            scatter(interval, &pairs, &sums, frame_time_secs, &mut matrix, &mut rhs);
        }
        self.add_smoothness(self.interval as f64 * frame_time_secs, &mut matrix);
        (matrix, rhs)
    }

    fn add_smoothness(&self, knot_secs: f64, matrix: &mut Banded<WIDTH>) {
        const THIRD: [f64; 4] = [-1.0, 3.0, -3.0, 1.0];
        let price = SMOOTHNESS / knot_secs.powi(5);
        for first in 0..self.n_points - 3 {
            for (k, row_share) in THIRD.into_iter().enumerate() {
                for (l, column_share) in THIRD.into_iter().enumerate().take(k + 1) {
                    for axis in 0..3 {
                        let (row, column) = (3 * (first + k) + axis, 3 * (first + l) + axis);
                        matrix.add(row, column, price * row_share * column_share);
                    }
                }
            }
        }
        for row in 0..3 * self.n_points {
            matrix.add(row, row, NEARNESS * knot_secs);
        }
    }

    /// Evaluates the spline at every frame; returns the largest change.
    fn fill(&self, points: &[f64], offsets: &mut [DVec3]) -> f64 {
        let mut moved = 0.0f64;
        for (interval, frames) in offsets.chunks_mut(self.interval).enumerate() {
            let point = |k: usize| DVec3::from_slice(&points[3 * (interval + k)..]);
            let four = [point(0), point(1), point(2), point(3)];
            for (offset, basis) in frames.iter_mut().zip(&self.basis) {
                let now = four[0] * basis[0] + four[1] * basis[1] + four[2] * basis[2] + four[3] * basis[3];
                moved = moved.max(now.distance_squared(*offset));
                *offset = now;
            }
        }
        moved.sqrt()
    }
}

impl Wish {
    /// Adds this wish, linear about an offset, to the normal equations of one frame, and tells whether there is one.
    ///
    /// `share` multiplies the wish to keep the reach, not the limit.
    fn add_to(&self, offset: DVec3, share: f64, limit_price: f64, square: &mut [f64; 6], pull: &mut DVec3) -> bool {
        let leg = self.leg + offset;
        let bound = self.limit * (1.0 - 2.0 * LIMIT_MARGIN);
        let length_squared = leg.length_squared();
        let is_long = length_squared > bound * bound;
        if !is_long && share == 0.0 {
            return false;
        }
        let length = length_squared.sqrt();
        let along = leg / length.max(1e-9 * self.reach.max(f64::MIN_POSITIVE));
        let mut weight = share * self.weight;
        let mut wanted = weight * self.reach;
        if is_long {
            weight += limit_price;
            wanted += limit_price * self.limit * (1.0 - LIMIT_MARGIN);
        }
        let scaled = along * weight;
        square[0] += scaled.x * along.x;
        square[1] += scaled.y * along.x;
        square[2] += scaled.y * along.y;
        square[3] += scaled.z * along.x;
        square[4] += scaled.z * along.y;
        square[5] += scaled.z * along.z;
        *pull += along * (weight * (along.dot(offset) - length) + wanted);
        true
    }
}

/// Adds what one interval's frames ask to the equations of its four control points.
fn scatter(
    interval: usize,
    pairs: &[[f64; 6]; 10],
    sums: &[DVec3; 4],
    scale: f64,
    matrix: &mut Banded<WIDTH>,
    rhs: &mut [f64],
) {
    /// Where element (row, column) of a symmetric 3 × 3 matrix is.
    const AT: [[usize; 3]; 3] = [[0, 1, 3], [1, 2, 4], [3, 4, 5]];
    let mut pair = 0;
    for k in 0..4 {
        for l in 0..=k {
            for axis in 0..3 {
                let row = 3 * (interval + k) + axis;
                for other in 0..if l == k { axis + 1 } else { 3 } {
                    matrix.add(row, 3 * (interval + l) + other, scale * pairs[pair][AT[axis][other]]);
                }
            }
            pair += 1;
        }
        for axis in 0..3 {
            rhs[3 * (interval + k) + axis] += scale * sums[k][axis];
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
        Wish { leg, reach, weight: 10.0, limit }
    }

    #[test]
    fn legs_that_are_right_move_nothing() {
        let legs = vec![vec![wish(DVec3::new(0.1, 0.8, 0.0), DVec3::new(0.1, 0.8, 0.0).length(), 0.9); 100]; 2];
        assert!(offsets(&legs, DT).iter().all(|o| o.length() < 1e-12));
        assert!(offsets(&[], DT).is_empty());
        assert_eq!(offsets(&legs.iter().map(|l| l[..1].to_vec()).collect::<Vec<_>>(), DT).len(), 1);
    }

    #[test]
    fn an_overlong_leg_is_brought_within_its_limit_smoothly() {
        let long = |f: usize| if (40..60).contains(&f) { 0.03 } else { 0.0 };
        let leg: Vec<Wish> = (0..100).map(|f| wish(DVec3::new(0.0, 0.88 + long(f), 0.1), 0.88, 0.9)).collect();
        let found = offsets(std::slice::from_ref(&leg), DT);
        for (wish, offset) in leg.iter().zip(&found) {
            assert!((wish.leg + offset).length() <= wish.limit, "{}", (wish.leg + offset).length());
        }
        let jerk = |w: &[DVec3]| (w[3] - 3.0 * w[2] + 3.0 * w[1] - w[0]).length();
        assert!(found.windows(4).map(jerk).fold(0.0, f64::max) < 0.005);
        assert!(found[0].length() < 0.005 && found[99].length() < 0.005, "it ends with its cause");
    }

    #[test]
    fn basis_functions_add_up_to_one() {
        for phase in 0..10 {
            assert!((basis(f64::from(phase) / 10.0).iter().sum::<f64>() - 1.0).abs() < 1e-15);
        }
    }
}
