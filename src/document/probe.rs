//! The least turns of joints that bring a point to its target where nobody can say beforehand what a turn does to it.
//!
//! A little turn of each joint about each axis is tried: the ways that the point goes are the columns of a matrix, and
//! damped least squares take the steps from there, none longer than the last ones bear out. What a step really does
//! corrects the matrix (C. Broyden, 1965), so that little turns are tried again only where it did not foretell the step.

use glam::{DMat3, DQuat, DVec3};

use crate::sync::side_by_side;

/// A little turn, radians: large enough for what it does to stand out from how exactly the offset is searched. Where a
/// shorter step was too long, as long as the next one.
const LITTLE: f64 = 0.01;
/// A step turns no joint farther than this, radians; one shorter than the other is none.
const LARGEST_STEP: f64 = 0.2;
const LEAST_STEP: f64 = 1e-4;
/// Damping λ², squared body heights: well below what a bent chain answers with.
const DAMPING: f64 = 1e-7;
/// A step that leaves more than this share of what was missing was not foretold well.
const FORETOLD: f64 = 0.5;
/// So many steps in a row that come nearer by less than this share of what was missing are the last.
const POOR_STEPS: usize = 3;
const LEAST_GAIN: f64 = 0.01;

/// A pose that was tried.
#[derive(Clone)]
pub(super) struct Tried<T> {
    /// Where it has the point, world.
    pub(super) at: DVec3,
    /// What it is.
    pub(super) pose: T,
}

/// What is known of a point and the joints that move it.
pub(super) struct Probe {
    n_joints: usize,
    /// Body height.
    height: f64,
    /// How many turns it tried.
    n_tried: usize,
    /// The way of the point, per radian, three for each joint; empty where nothing is known yet.
    ways: Vec<DVec3>,
}

impl Probe {
    pub(super) fn new(n_joints: usize, height: f64) -> Self {
        Self { n_joints, height, n_tried: 0, ways: Vec::new() }
    }

    /// Returns how many turns it tried.
    pub(super) fn n_tried(&self) -> usize {
        self.n_tried
    }

    /// Tells whether anything was learned so far.
    pub(super) fn knows(&self) -> bool {
        !self.ways.is_empty()
    }

    /// Returns a pose that has the point at its target, nearer than an accuracy, or as near as so many tries get it.
    ///
    /// `turned` tries turns of the joints, one for each, on the right of their local rotations; none where they cannot
    /// be made. What is not known is found out, and one step tried, however few tries there are.
    pub(super) fn nearest<T: Send + Sync>(
        &mut self,
        from: Tried<T>,
        target: DVec3,
        accuracy: f64,
        most_tries: usize,
        turned: impl Fn(&T, &[DQuat]) -> Option<Tried<T>> + Sync,
    ) -> Tried<T> {
        let mut best = from;
        let mut radius = LARGEST_STEP;
        let mut is_fresh = false;
        let mut n_poor = 0;
        let mut n_left = most_tries;
        while n_left > 0 && radius > LEAST_STEP && best.at.distance(target) > accuracy {
            if !self.knows() {
                n_left = n_left.saturating_sub(3 * self.n_joints);
                is_fresh = true;
                if !self.learn_all(&best, radius, &turned) {
                    break;
                }
            }
            // And take a step before it and one after.
            let can_learn_all = n_left > 3 * self.n_joints + 1;
            n_left = n_left.saturating_sub(1);
            let missing = best.at.distance(target);
            let step = self.step(target - best.at, radius);
            let tried = turned(&best.pose, &rotations(&step));
            self.n_tried += 1;
            if let Some(tried) = &tried {
                self.learn(&step, tried.at - best.at);
            }
            let left = tried.as_ref().map_or(f64::INFINITY, |tried| tried.at.distance(target));
            if let Some(nearer) = tried.filter(|_| left < missing) {
                best = nearer;
                n_poor = if is_fresh && left > (1.0 - LEAST_GAIN) * missing { n_poor + 1 } else { 0 };
                if n_poor == POOR_STEPS {
                    break;
                }
                radius = (2.0 * longest(&step)).clamp(radius, LARGEST_STEP);
            } else if is_fresh || !can_learn_all {
                radius = 0.25 * longest(&step);
                if radius > LITTLE || !can_learn_all {
                    continue;
                }
            }
            if left > FORETOLD * missing && can_learn_all {
                self.ways.clear();
            }
            is_fresh = false;
        }
        best
    }

    /// Tries a little turn, no longer than a step's radius, of each joint about each axis; returns whether they can be
    /// made.
    fn learn_all<T: Send + Sync>(
        &mut self,
        from: &Tried<T>,
        radius: f64,
        turned: impl Fn(&T, &[DQuat]) -> Option<Tried<T>> + Sync,
    ) -> bool {
        let little = radius.min(LITTLE);
        let joint_axes: Vec<_> = (0..self.n_joints).flat_map(|joint| DVec3::AXES.map(|axis| (joint, axis))).collect();
        let way = |&(joint, axis): &(usize, DVec3)| {
            let mut turns = vec![DQuat::IDENTITY; self.n_joints];
            turns[joint] = DQuat::from_axis_angle(axis, little);
            Some((turned(&from.pose, &turns)?.at - from.at) / little)
        };
        let ways = side_by_side(&joint_axes, way);
        self.n_tried += joint_axes.len();
        self.ways = ways.into_iter().collect::<Option<_>>().unwrap_or_default();
        self.knows()
    }

    /// Learns what turns do around a pose, unless something is known already.
    pub(super) fn look_around<T: Send + Sync>(
        &mut self,
        from: &Tried<T>,
        turned: impl Fn(&T, &[DQuat]) -> Option<Tried<T>> + Sync,
    ) {
        if !self.knows() {
            self.learn_all(from, LITTLE, turned);
        }
    }

    /// Returns the least turns, as rotation vectors, that take the point some way; none longer than a radius.
    fn step(&self, way: DVec3, radius: f64) -> Vec<DVec3> {
        let columns = self.ways.iter().map(|&w| DMat3::from_cols(w * w.x, w * w.y, w * w.z));
        let square: DMat3 = columns.fold(DMat3::ZERO, |sum, square| sum + square);
        let mut damping = DAMPING * self.height * self.height;
        loop {
            let pull = (square + DMat3::from_diagonal(DVec3::splat(damping))).inverse() * way;
            let step: Vec<DVec3> =
                self.ways.chunks_exact(3).map(|w| DVec3::new(w[0].dot(pull), w[1].dot(pull), w[2].dot(pull))).collect();
            if longest(&step) <= radius {
                return step;
            }
            damping *= 2.0;
        }
    }

    /// Learns what a step did.
    fn learn(&mut self, step: &[DVec3], went: DVec3) {
        let square: f64 = step.iter().map(|turn| turn.length_squared()).sum();
        if square == 0.0 {
            return;
        }
        let by = step.iter().flat_map(|turn| turn.to_array());
        let foretold: DVec3 = self.ways.iter().zip(by.clone()).map(|(&way, by)| way * by).sum();
        let wrong = (went - foretold) / square;
        self.ways.iter_mut().zip(by).for_each(|(way, by)| *way += wrong * by);
    }
}

fn longest(turns: &[DVec3]) -> f64 {
    turns.iter().map(|turn| turn.length()).fold(0.0, f64::max)
}

fn rotations(turns: &[DVec3]) -> Vec<DQuat> {
    turns.iter().map(|&turn| DQuat::from_scaled_axis(turn)).collect()
}

#[cfg(test)]
mod tests {
    use std::sync::atomic::{AtomicUsize, Ordering};

    use super::*;

    /// A limb of two bones whose top gives way: by a share of where the point is, against it.
    #[derive(Clone, Copy)]
    struct Limb {
        turns: [DQuat; 2],
        gives_way: f64,
    }

    impl Limb {
        fn new(gives_way: f64) -> Self {
            Self { turns: [DQuat::from_rotation_z(0.3), DQuat::from_rotation_z(-0.8)], gives_way }
        }

        fn tried(self) -> Tried<Self> {
            let [upper, lower] = self.turns;
            let at = upper * (DVec3::NEG_Y + lower * DVec3::NEG_Y);
            Tried { at: at * (1.0 - self.gives_way * DVec3::new(1.0, 0.2, 0.5)), pose: self }
        }

        fn turned(&self, by: &[DQuat]) -> Option<Tried<Self>> {
            Some(Self { turns: [self.turns[0] * by[0], self.turns[1] * by[1]], ..*self }.tried())
        }
    }

    fn angle(turn: DQuat) -> f64 {
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    }

    #[test]
    fn a_target_is_reached_whatever_answers_the_turns() {
        // A point that goes on, stays behind, and goes the other way.
        for gives_way in [0.0, 0.9, 1.5, 3.0] {
            let from = Limb::new(gives_way).tried();
            for way in [DVec3::X, DVec3::Y, DVec3::Z, DVec3::new(-0.5, -0.3, 0.4)] {
                let target = from.at + 0.05 * way;
                let mut probe = Probe::new(2, 2.0);
                let found = probe.nearest(from.clone(), target, 1e-8, 60, Limb::turned);
                let off = found.at.distance(target);
                assert!(off < 1e-8 && probe.knows(), "{gives_way} {way}: {off}");
            }
        }
    }

    #[test]
    fn turns_are_small_and_nothing_turns_where_the_point_is() {
        let from = Limb::new(0.5).tried();
        let mut probe = Probe::new(2, 2.0);
        let found = probe.nearest(from.clone(), from.at + DVec3::X * 0.01, 1e-8, 60, Limb::turned);
        for (is, was) in found.pose.turns.iter().zip(from.pose.turns) {
            assert!(angle(was.conjugate() * *is) < 0.03);
        }
        let stays = Probe::new(2, 2.0).nearest(from.clone(), from.at, 1e-8, 60, |_, _| unreachable!());
        assert_eq!(stays.pose.turns, from.pose.turns);
    }

    #[test]
    fn what_is_out_of_reach_is_approached_and_few_tries_do_no_harm() {
        let from = Limb::new(0.0).tried();
        let target = DVec3::new(0.5, -3.0, 1.0);
        let found = Probe::new(2, 2.0).nearest(from.clone(), target, 1e-8, 200, Limb::turned);
        let nearest = target.length() - 2.0;
        assert!(found.at.distance(target) < nearest + 0.03, "{} for {nearest}", found.at.distance(target));
        for most_tries in 0..20 {
            let tried = AtomicUsize::new(0);
            let count = |limb: &Limb, by: &[DQuat]| {
                tried.fetch_add(1, Ordering::Relaxed);
                limb.turned(by)
            };
            let found = Probe::new(2, 2.0).nearest(from.clone(), target, 1e-8, most_tries, count);
            assert!(found.at.distance(target) <= from.at.distance(target));
            let n_tried = tried.into_inner();
            assert!(n_tried <= most_tries.max(7), "{n_tried} for {most_tries}");
        }
        // Where no turn can be made nothing is.
        assert_eq!(Probe::new(2, 2.0).nearest(from.clone(), target, 1e-8, 60, |_, _| None).at, from.at);
    }
}
