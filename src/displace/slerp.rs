//! Rotations between keys: spherical linear interpolation the short way, constant outside.
//!
//! A rotation is two quaternions, q and −q. Every key is taken the short way, by half a turn at most: so a share of a map
//! passes its keys at that share of them. Between two keys whose way is no longer that holds throughout, and the share is
//! one of what is between them; a way that passes a half turn goes from one key's share to the other's.

use std::ops::Range;

use glam::DQuat;

use super::keys::{Key, Piece, pieces};

/// A turn this near to a half turn (in w) has no shorter way; it goes the way its axis decides.
const HALF_TURN: f64 = 1e-12;

/// Frames that are reached by multiplying one step after the other before the next exact value.
const STRIDE: usize = 32;

/// Keys, each of them the short way.
pub(super) struct Turns(Vec<Key<DQuat>>);

impl Turns {
    pub(super) fn new(keys: &[Key<DQuat>]) -> Self {
        Self(keys.iter().map(|key| Key { value: short_way(key.value), ..*key }).collect())
    }

    /// Calls `visit` with each frame of the file and a share of the map's value there.
    ///
    /// # Panics
    ///
    /// When there is no key.
    pub(super) fn visit(&self, share: f64, frames: Range<usize>, mut visit: impl FnMut(usize, DQuat)) {
        let Self(keys) = self;
        let shared = |turn: DQuat| if share == 1.0 { turn } else { power(turn, share) };
        for (piece, run) in pieces(keys, frames) {
            match piece {
                Piece::Constant(key) => {
                    let value = shared(keys[key].value);
                    run.for_each(|frame| visit(frame, value));
                }
                Piece::Between(key) => {
                    let ends = [keys[key], keys[key + 1]];
                    if ends[0].value.dot(ends[1].value) >= -HALF_TURN {
                        between(ends, run, |frame, value| visit(frame, shared(value)));
                    } else {
                        between(ends.map(|key| Key { value: shared(key.value), ..key }), run, &mut visit);
                    }
                }
            }
        }
    }

    /// Returns the map's value at a frame of the file.
    pub(super) fn at(&self, frame: usize) -> DQuat {
        let mut found = DQuat::IDENTITY;
        self.visit(1.0, frame..frame + 1, |_, value| found = value);
        found
    }
}

/// Calls `visit` with each of some frames between two keys and the value there.
fn between([from, to]: [Key<DQuat>; 2], frames: Range<usize>, mut visit: impl FnMut(usize, DQuat)) {
    // Of two ways that are as long, the one by which no turn gets larger than a half one.
    let turn = from.value.conjugate() * to.value;
    let turn = if turn.w < -HALF_TURN { -turn } else { turn };
    let share = |n_frames: usize| power(turn, n_frames as f64 / (to.frame - from.frame) as f64);
    let step = share(1);
    // Strides are counted from the key: what a frame gets does not depend on which others are asked for.
    let first = from.frame + (frames.start - from.frame) / STRIDE * STRIDE;
    for start in (first..frames.end).step_by(STRIDE) {
        let mut value = from.value * share(start - from.frame);
        for frame in start..frames.end.min(start + STRIDE) {
            if frame >= frames.start {
                visit(frame, value);
            }
            value *= step;
        }
    }
}

/// Tells whether a quaternion stands for the long way of its rotation; of the two of a half turn one does.
fn is_long_way(turn: DQuat) -> bool {
    if turn.w.abs() > HALF_TURN {
        turn.w < 0.0
    } else {
        // A unit vector has a component of more than a half; the first such one tells the two apart.
        turn.xyz().to_array().into_iter().find(|c| c.abs() > 0.5).is_some_and(|c| c < 0.0)
    }
}

/// Returns the quaternion of a rotation that stands for its short way.
pub(super) fn short_way(turn: DQuat) -> DQuat {
    if is_long_way(turn) { -turn } else { turn }
}

/// Returns a power of a rotation: its angle times `exponent`.
pub(super) fn power(turn: DQuat, exponent: f64) -> DQuat {
    let sine = turn.xyz().length();
    if sine == 0.0 {
        return DQuat::IDENTITY;
    }
    let (s, c) = (exponent * sine.atan2(turn.w)).sin_cos();
    let axis = turn.xyz() * (s / sine);
    DQuat::from_xyzw(axis.x, axis.y, axis.z, c)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::PI;

    use proptest::prelude::*;

    use glam::DVec3;

    use super::*;
    use crate::math::rotation_vector;

    fn values(keys: &[(usize, DQuat)], frames: Range<usize>) -> Vec<DQuat> {
        shares(keys, 1.0, frames)
    }

    fn shares(keys: &[(usize, DQuat)], share: f64, frames: Range<usize>) -> Vec<DQuat> {
        let keys: Vec<_> = keys.iter().map(|&(frame, value)| Key { frame, value }).collect();
        let mut out = Vec::new();
        Turns::new(&keys).visit(share, frames, |_, value| out.push(value));
        out
    }

    fn off(a: DQuat, b: DQuat) -> f64 {
        let turn = a.conjugate() * b;
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    }

    fn any_turn() -> impl Strategy<Value = DQuat> {
        prop::array::uniform4(-1.0..1.0f64)
            .prop_map(DQuat::from_array)
            .prop_filter("has a direction", |q| q.length() > 0.1)
            .prop_map(DQuat::normalize)
    }

    proptest! {
        #[test]
        fn between_keys_it_is_slerp_the_short_way(a in any_turn(), b in any_turn(), n in 1..2000usize) {
            let all = values(&[(3, a), (3 + n, b)], 0..n + 6);
            for (frame, &value) in all.iter().enumerate() {
                let share = (frame.saturating_sub(3) as f64 / n as f64).min(1.0);
                // glam's own slerp takes the short way too, but is linear for small angles: within 1e-4 of one.
                let want = if a.dot(b).abs() > 0.999 { a * power(short_way(a.conjugate() * b), share) } else { a.slerp(b, share) };
                prop_assert!(off(value, want) < 1e-9, "frame {frame}: off by {:e}", off(value, want));
                prop_assert!((value.length() - 1.0).abs() < 1e-13);
            }
            let whole = off(a, b);
            prop_assert!(whole <= PI + 1e-9);
            for pair in all.windows(2) {
                prop_assert!(off(pair[0], pair[1]) <= whole / n as f64 + 1e-9, "even steps, never the long way");
            }
        }

        #[test]
        fn the_signs_of_the_keys_do_not_matter(turns in prop::collection::vec(any_turn(), 1..6)) {
            let keys: Vec<_> = turns.iter().enumerate().map(|(i, &q)| (i * 7, q)).collect();
            let flipped: Vec<_> = keys.iter().map(|&(f, q)| (f, if f % 2 == 1 { -q } else { q })).collect();
            for (a, b) in values(&keys, 0..40).into_iter().zip(values(&flipped, 0..40)) {
                prop_assert!(a.abs_diff_eq(b, 1e-12));
            }
        }
    }

    #[test]
    fn a_half_turn_goes_one_way_whatever_its_rounding() {
        for axis in [DVec3::X, DVec3::NEG_Z, DVec3::new(1.0, -1.0, 1.0).normalize()] {
            let mut middles = Vec::new();
            for noise in [0.0, 1e-15, -1e-15] {
                for sign in [1.0, -1.0] {
                    let half = DQuat::from_axis_angle(axis * sign, PI + noise);
                    let all = values(&[(0, DQuat::IDENTITY), (100, half)], 0..101);
                    assert!(all.iter().all(|q| q.is_finite()));
                    for pair in all.windows(2) {
                        assert!((off(pair[0], pair[1]) - PI / 100.0).abs() < 1e-12);
                    }
                    middles.push(all[50]);
                }
            }
            assert!(middles.iter().all(|&m| off(m, middles[0]) < 1e-12), "{axis}");
        }
    }

    /// A share of a whole turn's last key was once the whole of nothing, in one frame from half a turn on; one of a half
    /// turn's way back, too.
    #[test]
    fn a_share_passes_its_keys_and_leaps_nowhere() {
        let about = |axis: DVec3, degrees: f64| DQuat::from_axis_angle(axis, degrees.to_radians());
        let around = [0.0, 120.0, 240.0, 0.0].map(|degrees| about(DVec3::Y, degrees));
        let back = [0.0, 180.0, 0.0, -180.0].map(|degrees| about(DVec3::NEG_X, degrees));
        let nearly = [0.0, 180.0 - 1e-11, 1e-11, 179.0].map(|degrees| about(DVec3::Z, degrees));
        let mixed = [about(DVec3::X, 170.0), about(DVec3::Y, 175.0), about(DVec3::Z, -170.0), about(DVec3::X, -170.0)];
        for turns in [around, back, nearly, mixed] {
            let keys: Vec<_> = (0..4).map(|i| (50 * i + 5, turns[i])).collect();
            for weight in [0.25, 0.5, 0.7, 0.999] {
                let all = shares(&keys, weight, 0..170);
                for &(frame, turn) in &keys {
                    let off = off(all[frame], power(short_way(turn), weight));
                    assert!(off < 1e-9, "{turns:?}: {weight} at {frame} off by {off}");
                }
                for (frame, pair) in all.windows(2).enumerate() {
                    let step = off(pair[0], pair[1]);
                    assert!(step < 0.3, "{turns:?}: {weight}, {step} from {frame} on");
                }
            }
        }
        assert_eq!(power(DQuat::IDENTITY, 0.3), DQuat::IDENTITY);
    }

    #[test]
    fn tiny_turns_keep_their_digits() {
        let tiny = DQuat::from_rotation_x(1e-9);
        let all = values(&[(0, DQuat::IDENTITY), (10, tiny)], 0..11);
        assert!((2.0 * all[3].x - 3e-10).abs() < 1e-24, "{:e}", all[3].x);
        assert!(rotation_vector(all[3]).abs_diff_eq(3e-10 * DVec3::X, 1e-24));
        assert!(values(&[(0, tiny), (10, tiny)], 0..11).iter().all(|q| *q == tiny));
    }
}
