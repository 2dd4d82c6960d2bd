//! Interpolation keys: the clip's own motion between two frames replaced by the interpolation of the two poses.
//!
//! What is replaced lies below all layers, so the layers' detail stays. The carrier is no joint here: its motion, most
//! naturally what the path leaves over of it, is interpolated by [`interpolated_motions`].

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::{Curve, Interpolation, can_turn, keys::Key, slerp, spline};
use crate::{
    math::Rigid,
    motion::{Clip, TurnedJoint},
    skeleton::JointId,
};

/// Two frames between which the clip is replaced (`interpolation_keys` of a project).
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct InterpolationKeys {
    /// The earlier frame of the file.
    pub first: usize,
    /// The later frame of the file.
    pub last: usize,
}

impl InterpolationKeys {
    /// Returns the clip's frames that are replaced; empty when the keys leave nothing between them in the clip.
    pub fn frames(self, clip: &Clip) -> Range<usize> {
        match self.ends(clip) {
            Some([first, last]) => first + 1..last,
            None => 0..0,
        }
    }

    /// Says what of the keys a clip does not have.
    pub fn warning(self, clip: &Clip) -> Option<String> {
        let end = clip.n_file_frames() - 1;
        let used = if self.first < end { "the end is used" } else { "nothing lies between them" };
        (self.last > end)
            .then(|| format!("interpolation_keys: {} is beyond the clip's end at {end}; {used}", self.last))
    }

    /// Returns both frames as the clip counts them, brought into the clip; none when they are out of order or one.
    fn ends(self, clip: &Clip) -> Option<[usize; 2]> {
        let within = |frame: usize| frame.saturating_sub(clip.rest_frames()).min(clip.n_frames() - 1);
        let [first, last] = [self.first, self.last].map(within);
        (first < last).then_some([first, last])
    }
}

/// Returns the joints' local rotations with the clip between the keys replaced, for [`super::Stack::base`].
///
/// The carrier and joints that [cannot turn](super::can_turn) are left out, and positions of joints that have position
/// channels stay the clip's. With two keys the cubic is the straight line. Joints at rest are left out too.
pub fn interpolated_joints(clip: &Clip, keys: InterpolationKeys, interpolation: Interpolation) -> Vec<TurnedJoint> {
    let Some([first, last]) = keys.ends(clip) else { return Vec::new() };
    let carrier = clip.facts.carrier.value;
    let turns = |&joint: &JointId| {
        let own = |frame: usize| clip.rotations(frame)[joint.idx()];
        joint != carrier && can_turn(clip, joint) && (first..last).any(|frame| own(frame) != own(last))
    };
    let turned = |joint: JointId| {
        let mut rotations: Vec<DQuat> = (0..clip.n_frames()).map(|frame| clip.rotations(frame)[joint.idx()]).collect();
        let ends = [first, last].map(|frame| Key { frame, value: rotations[frame] });
        if interpolation == Interpolation::Quaternion {
            slerp::Turns::new(&ends).visit(1.0, first + 1..last, |frame, rotation| rotations[frame] = rotation);
        } else {
            let order = clip.rotation_order(joint.idx()).expect("it turns freely");
            let from = clip.rotation_degrees(joint.idx())[first];
            let degrees = [from, order.nearest_degrees(ends[1].value, from)].map(DVec3::from_array);
            let ends = [0, 1].map(|end| Key { frame: ends[end].frame, value: degrees[end] });
            let between = spline::values(&ends, Curve::Linear, first + 1..last);
            let between: Vec<[f64; 3]> = between.into_iter().map(|degrees| degrees.to_array()).collect();
            rotations[first + 1..last].copy_from_slice(&order.rotations(&between));
        }
        TurnedJoint { joint, rotations }
    };
    clip.skeleton.ids().filter(turns).map(turned).collect()
}

/// Replaces motions between the keys: positions along a straight line, orientations the short way.
///
/// `motions` has one for each frame of the clip: the carrier's residuals on its path, or its world motions.
pub fn interpolated_motions(clip: &Clip, keys: InterpolationKeys, motions: &mut [Rigid]) {
    let Some([first, last]) = keys.ends(clip) else { return };
    let ends = [first, last];
    let rotations = slerp::Turns::new(&ends.map(|frame| Key { frame, value: motions[frame].rotation }));
    let positions = ends.map(|frame| Key { frame, value: motions[frame].translation });
    let positions = spline::values(&positions, Curve::Linear, first + 1..last);
    rotations.visit(1.0, first + 1..last, |frame, rotation| {
        motions[frame] = Rigid::new(rotation, positions[frame - first - 1]);
    });
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::displace::{
        Layer, Stack,
        sample::{FREE, STIFF, Sample},
    };

    const KEYS: InterpolationKeys = InterpolationKeys { first: 22, last: 62 };

    fn off(a: DQuat, b: DQuat) -> f64 {
        let turn = a.conjugate() * b;
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    }

    #[test]
    fn between_the_keys_poses_are_interpolated_and_elsewhere_the_clips_own() {
        let clip = Sample { wraps: true, swing: 60.0, ..Sample::default() }.clip();
        for interpolation in Interpolation::ALL {
            let turned = interpolated_joints(&clip, KEYS, interpolation);
            let joints: Vec<_> = turned.iter().map(|t| t.joint).collect();
            assert_eq!(joints, FREE[1..], "all but the carrier and what cannot turn");
            for TurnedJoint { joint, rotations } in &turned {
                let own = |frame: usize| clip.rotations(frame)[joint.idx()];
                for frame in (0..=20).chain(60..clip.n_frames()) {
                    assert_eq!(rotations[frame], own(frame));
                }
                if interpolation == Interpolation::Quaternion {
                    assert!(off(rotations[30], own(20).slerp(own(60), 0.25)) < 1e-12);
                } else {
                    let order = clip.rotation_order(joint.idx()).expect("free");
                    let from = clip.rotation_degrees(joint.idx())[20];
                    let to = order.nearest_degrees(own(60), from);
                    let want = std::array::from_fn(|i| 0.75 * from[i] + 0.25 * to[i]);
                    assert!(off(rotations[30], order.rotation(want)) < 1e-12);
                }
                for pair in rotations[20..=60].windows(2) {
                    assert!(off(pair[0], pair[1]) < 0.2, "no jump");
                }
            }
        }
        assert!(!can_turn(&clip, STIFF));
    }

    #[test]
    fn layers_lie_on_what_is_interpolated() {
        let clip = Sample::default().clip();
        let base = interpolated_joints(&clip, KEYS, Interpolation::Quaternion);
        let turn = DQuat::from_rotation_x(0.3);
        for interpolation in Interpolation::ALL {
            let mut layer = Layer { interpolation, ..Layer::new("on top") };
            layer.set_rotation("Arm", 40, turn);
            let stack = Stack { clip: &clip, base: &base, layers: &[layer] };
            let displaced = stack.displaced();
            assert_eq!(displaced.turned.len(), base.len());
            let of =
                |turned: &[TurnedJoint]| turned.iter().find(|t| t.joint == FREE[2]).expect("it turns").rotations[38];
            assert!(off(of(&displaced.turned), of(&base) * turn) < 1e-8);
            assert_eq!(stack.rotation(FREE[2], 38), of(&displaced.turned));
        }
    }

    #[test]
    fn motions_go_straight_and_turn_the_short_way() {
        let clip = Sample::default().clip();
        let motion = |frame: usize| {
            let angle = frame as f64 * 0.1;
            Rigid::new(DQuat::from_rotation_y(angle), DVec3::new(angle.sin(), 1.0, angle))
        };
        let own: Vec<Rigid> = (0..clip.n_frames()).map(motion).collect();
        let mut motions = own.clone();
        interpolated_motions(&clip, KEYS, &mut motions);
        assert_eq!((&motions[..=20], &motions[60..]), (&own[..=20], &own[60..]));
        assert!(motions[40].translation.abs_diff_eq((own[20].translation + own[60].translation) / 2.0, 1e-12));
        // Four radians one way are 2.28 the other.
        let back = DQuat::from_rotation_y(2.0 - (std::f64::consts::TAU - 4.0) / 2.0);
        assert!(off(motions[40].rotation, back) < 1e-12);
    }

    #[test]
    fn keys_beyond_the_end_are_told() {
        let clip = Sample::default().clip();
        let end = clip.n_file_frames() - 1;
        let warning = |first, last| InterpolationKeys { first, last }.warning(&clip);
        assert_eq!((warning(3, end), warning(end, end)), (None, None));
        assert!(warning(3, end + 1).is_some_and(|w| w.contains(&format!("{} is beyond", end + 1))));
        assert!(warning(end, end + 5).is_some_and(|w| w.ends_with("nothing lies between them")));
    }

    #[test]
    fn keys_with_nothing_between_replace_nothing() {
        let clip = Sample::default().clip();
        for (first, last) in [(9, 9), (30, 20), (0, 1), (500, 900)] {
            let keys = InterpolationKeys { first, last };
            assert!(keys.frames(&clip).is_empty());
            let turned = interpolated_joints(&clip, keys, Interpolation::EulerLinear);
            let same =
                |t: &TurnedJoint| (0..clip.n_frames()).all(|f| t.rotations[f] == clip.rotations(f)[t.joint.idx()]);
            assert!(turned.iter().all(same));
        }
        assert_eq!(KEYS.frames(&clip), 21..60);
    }
}
