//! Plants give way: a foot that its leg could not reach stands a little elsewhere.
//!
//! Plain path editing may carry the body further over a plant than a leg is long: a polynomial of a low degree sways
//! where its clip stands still. Most of such a plant's frames lie at one end of the way, so that the place which is right
//! on average is far too far at the other. The plant is moved to where the longest reaches are as even as can be. Within
//! what the carrier's offset makes up for, nothing moves.

use glam::{DMat2, DMat3, DVec2, DVec3};

use super::{
    bend::{LIMIT, free_at},
    prepared::{PreparedLeg, PreparedPlant},
};
use crate::{contact::Plant, math::Rigid};

/// What a leg may be too long by, share of its length, before its plant gives way: the carrier's offset makes up for it.
const LEFT_TO_OFFSET: f64 = 0.05;

/// Furthest that a plant is moved, share of the leg's length.
const FURTHEST: f64 = 0.3;

/// Time from one frame that is looked at to the next, seconds.
const SAMPLE_SECS: f64 = 0.017;

/// Time before and after a plant at which the leg's length counts too, seconds.
const AROUND_SECS: f64 = 0.1;

/// Stiffness that holds a plant where it is, beside the mean fourth power of excesses; lengths in legs.
const STIFFNESS: f64 = 1e-6;

/// Most steps of the search, and the share of a leg under which a step is its last.
const MOST_STEPS: usize = 16;
const STEP_ACCURACY: f64 = 2e-4;

/// The way of the body over plants of one leg.
pub(super) struct Passing<'a> {
    pub(super) leg: &'a PreparedLeg,
    /// Plants that share one motion.
    pub(super) plants: &'a [PreparedPlant],
    /// Where plain path editing puts the carrier, world.
    pub(super) carrier: &'a [Rigid],
    pub(super) frame_time_secs: f64,
}

/// A leg at one frame.
struct Leg {
    /// From the ankle to the hip; y is up.
    way: DVec3,
    /// Length beyond which the plant gives way.
    bound: f64,
}

impl Passing<'_> {
    /// Returns how far plants with this motion give way, level; nothing where the leg is long enough.
    pub(super) fn gives_way(&self, motion: &Rigid) -> DVec2 {
        if self.ways(motion).all(|(f, _, way)| way.length_squared() <= self.least_bound(f).powi(2)) {
            return DVec2::ZERO;
        }
        let legs: Vec<Leg> = self.ways(motion).map(|(f, away, way)| Leg { way, bound: self.bound(f, away) }).collect();
        let unit = self.leg.frames[self.plants[0].plant.first].length;
        let way = evened(&legs, unit);
        // Falls behind what is asked for smoothly, so that nothing jumps while a path is dragged.
        way / (1.0 + (way.length() / (FURTHEST * unit)).powi(4)).powf(0.25)
    }

    /// Lists the ways from ankle to hip at some frames of the plants and around them, each with its frame and with how
    /// many frames that is away from the plant.
    fn ways(&self, motion: &Rigid) -> impl Iterator<Item = (usize, usize, DVec3)> {
        let (turn, shift) = (DMat3::from_quat(motion.rotation), motion.translation);
        let frames_in = |secs: f64| (secs / self.frame_time_secs).round() as usize;
        let (around, stride) = (frames_in(AROUND_SECS), frames_in(SAMPLE_SECS).max(1));
        let end = self.carrier.len() - 1;
        self.plants.iter().flat_map(move |stood| {
            let Plant { first, last, .. } = stood.plant;
            (first.saturating_sub(around)..=(last + around).min(end)).step_by(stride).map(move |f| {
                let ankle = turn * (self.leg.feet[f].ankle.translation - stood.slid(f)) + shift;
                let away = first.saturating_sub(f).max(f.saturating_sub(last));
                (f, away, self.carrier[f].point(self.leg.frames[f].hip) - ankle)
            })
        })
    }

    /// Returns the length beyond which a leg makes its plant give way, so many frames away from that.
    fn bound(&self, frame: usize, away: usize) -> f64 {
        let leg = &self.leg.frames[frame];
        leg.limit_when(free_at(away as f64, self.frame_time_secs)) + LEFT_TO_OFFSET * leg.length
    }

    /// Returns a length that is never beyond it, whatever the distance from the plant.
    fn least_bound(&self, frame: usize) -> f64 {
        let leg = &self.leg.frames[frame];
        (LIMIT + LEFT_TO_OFFSET) * leg.length
    }
}

/// Returns how far the ankles must move so that the mean fourth power of excesses is least: nearly the least of the
/// largest, without its corners. Newton's method; the sum is convex.
fn evened(legs: &[Leg], unit: f64) -> DVec2 {
    let stiffness = STIFFNESS * legs.len() as f64;
    let mut moved = DVec2::ZERO;
    for _ in 0..MOST_STEPS {
        let mut force = -stiffness * moved / unit;
        let mut stiff = DMat2::from_diagonal(DVec2::splat(stiffness));
        for leg in legs {
            let way = leg.way - DVec3::new(moved.x, 0.0, moved.y);
            if way.length_squared() <= leg.bound * leg.bound {
                continue;
            }
            let length = way.length();
            let along = DVec2::new(way.x, way.z) / length;
            let excess = (length - leg.bound) / unit;
            let across = excess.powi(3) * unit / length;
            force += excess.powi(3) * along;
            stiff += (3.0 * excess * excess - across) * DMat2::from_cols(along * along.x, along * along.y)
                + DMat2::from_diagonal(DVec2::splat(across));
        }
        let step = stiff.inverse() * force * unit;
        moved += step;
        if step.length() < STEP_ACCURACY * unit {
            break;
        }
    }
    moved
}

#[cfg(test)]
mod tests {
    use super::*;

    fn leg(x: f64, z: f64) -> Leg {
        Leg { way: DVec3::new(x, 0.8, z), bound: 1.0 }
    }

    fn longest(legs: &[Leg], moved: DVec2) -> f64 {
        legs.iter().map(|leg| (leg.way - DVec3::new(moved.x, 0.0, moved.y)).length() - leg.bound).fold(0.0, f64::max)
    }

    #[test]
    fn the_longest_reaches_are_made_even() {
        // The body stands long at one end of its way and is soon at the other: the mean is no measure.
        let legs: Vec<Leg> = (0..50).map(|_| leg(0.0, -0.1)).chain([leg(0.0, 1.0), leg(0.0, -0.6)]).collect();
        let moved = evened(&legs, 1.0);
        let (was, is) = (longest(&legs, DVec2::ZERO), longest(&legs, moved));
        assert!((moved - DVec2::new(0.0, 0.2)).length() < 1e-2 && is < was - 0.1, "{moved} {was} {is}");
        for other in [DVec2::X, DVec2::Y, -DVec2::X, -DVec2::Y] {
            assert!(longest(&legs, moved + 0.1 * other) > is, "{other}");
        }
    }

    #[test]
    fn one_long_reach_is_followed_until_it_is_short_enough() {
        let moved = evened(&[leg(0.0, 0.0), leg(0.0, 0.7)], 1.0);
        assert!(moved.x.abs() < 1e-9 && moved.y > 0.05 && moved.y <= 0.1 + 1e-3, "{moved}");
        assert_eq!(evened(&[leg(0.0, 0.5)], 1.0), DVec2::ZERO);
    }

    #[test]
    fn size_changes_nothing() {
        let legs = |scale: f64| {
            [(0.3, 0.9), (-0.2, -0.4)].map(|(x, z)| Leg { way: scale * DVec3::new(x, 0.8, z), bound: scale })
        };
        let (one, hundred) = (evened(&legs(1.0), 1.0), evened(&legs(100.0), 100.0));
        assert!((100.0 * one - hundred).length() < 1e-6 && one.length() > 0.05, "{one} {hundred}");
    }
}
