//! `Stack`: layers on a clip, and what comes of them at every frame.

use std::{collections::BTreeMap, ops::Range};

use glam::{DQuat, DVec3};

use super::{
    Interpolation, Keys, Layer, find_joint,
    spline::{self, Curve},
    track::Track,
};
use crate::{
    math::Rigid,
    motion::{Clip, TurnedJoint},
    skeleton::JointId,
};

/// A joint's rotation map and the layer that it is of.
pub(super) type Map<'a> = (&'a Layer, &'a Keys<DQuat>);

/// Layers on a clip: merged ones first, then the others, each in the order of the list.
#[derive(Clone, Copy, Debug)]
pub struct Stack<'a> {
    /// The clip as loaded.
    pub clip: &'a Clip,
    /// Joints that turn otherwise than in the clip before any layer is laid on it; not the carrier, at the clip's
    /// frames. [`super::interpolated_joints`] makes such.
    pub base: &'a [TurnedJoint],
    /// All layers, bottom to top.
    pub layers: &'a [Layer],
}

/// What layers make of a clip, at the clip's frames.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Displaced {
    /// Joints that turn otherwise than in the clip, the carrier apart. A joint that no layer turns and that is in no
    /// base is left out.
    pub turned: Vec<TurnedJoint>,
    /// Turn on the right of the carrier's rotation, wherever the carrier is; empty when no layer turns it.
    pub carrier_turns: Vec<DQuat>,
    /// Offset of the carrier, [lateral, up, forward] of the path frame in use; empty when no layer moves it.
    pub offsets: Vec<DVec3>,
}

impl Displaced {
    /// Tells whether nothing is displaced.
    pub fn is_empty(&self) -> bool {
        self.turned.is_empty() && !self.moves_carrier()
    }

    /// Tells whether the carrier is anywhere else than where it is carried to.
    pub fn moves_carrier(&self) -> bool {
        !self.carrier_turns.is_empty() || !self.offsets.is_empty()
    }

    /// Tells whether the carrier goes where it goes in another.
    pub fn moves_as(&self, other: &Self) -> bool {
        self.carrier_turns == other.carrier_turns && self.offsets == other.offsets
    }

    /// Tells whether some joints turn as they do in another.
    pub fn turns_as(&self, other: &Self, is_meant: impl Fn(JointId) -> bool) -> bool {
        let meant = |turned: &&TurnedJoint| is_meant(turned.joint);
        self.turned.iter().filter(meant).eq(other.turned.iter().filter(meant))
    }

    /// Returns where the carrier is at a frame of the clip.
    ///
    /// `carried` is where it would be without layers, `path_frame` the orientation of the path frame there: of the
    /// new path's, or of the original path's while the path edit is off.
    pub fn carrier(&self, frame: usize, carried: Rigid, path_frame: impl FnOnce() -> DQuat) -> Rigid {
        let turn = self.carrier_turns.get(frame).filter(|turn| **turn != DQuat::IDENTITY);
        let offset = self.offsets.get(frame).filter(|offset| **offset != DVec3::ZERO);
        Rigid {
            rotation: turn.map_or(carried.rotation, |&turn| carried.rotation * turn),
            translation: offset.map_or(carried.translation, |&by| carried.translation + path_frame() * by),
        }
    }

    /// Returns where a carrier that is displaced would be without layers: [`Displaced::carrier`] the other way round.
    pub fn undisplaced_carrier(&self, frame: usize, carrier: Rigid, path_frame: DQuat) -> Rigid {
        let turn = self.carrier_turns.get(frame).copied().unwrap_or(DQuat::IDENTITY);
        let offset = self.offsets.get(frame).copied().unwrap_or(DVec3::ZERO);
        Rigid::new(carrier.rotation * turn.conjugate(), carrier.translation - path_frame * offset)
    }

    /// Returns the turned joints at the frames that are shown: each shows this frame of the clip.
    pub fn shown(&self, source_frames: &[u32]) -> Vec<TurnedJoint> {
        let shown = |turned: &TurnedJoint| TurnedJoint {
            joint: turned.joint,
            rotations: source_frames.iter().map(|&frame| turned.rotations[frame as usize]).collect(),
        };
        self.turned.iter().map(shown).collect()
    }
}

/// Tells whether a joint can have a rotation map: the file can give it any rotation, and the carrier does not hang
/// below it, because where the carrier is follows from the path. The carrier itself can if it can be placed at all.
pub fn can_turn(clip: &Clip, joint: JointId) -> bool {
    let carrier = clip.facts.carrier.value;
    let is_placed = if joint == carrier { clip.facts.path_editable } else { !clip.skeleton.is_within(carrier, joint) };
    clip.turns_freely(joint.idx()) && is_placed
}

impl<'a> Stack<'a> {
    /// Computes what the layers make of the clip.
    pub fn displaced(&self) -> Displaced {
        self.displaced_again(self, &Displaced::default(), 0..self.clip.n_frames())
    }

    /// Computes what the layers make of some frames of the clip, which are the result's from 0 on; joints whose maps are
    /// those of an earlier stack are copied from what that one made of the whole clip. The result does not depend on it.
    pub fn displaced_again(&self, earlier: &Stack, made: &Displaced, frames: Range<usize>) -> Displaced {
        let carrier = self.clip.facts.carrier.value;
        let mut out = Displaced { offsets: self.offsets(frames.clone()), ..Displaced::default() };
        let earlier_maps = if std::ptr::eq(self.clip, earlier.clip) { earlier.maps() } else { BTreeMap::new() };
        for (joint, maps) in self.maps() {
            let is_same = earlier_maps.get(&joint).is_some_and(|other| has_equal_effect(&maps, other))
                && self.base_of(joint) == earlier.base_of(joint);
            let is_carrier = joint == carrier;
            let kept = made.turned.iter().find(|turned| is_same && turned.joint == joint);
            if is_same && is_carrier && !made.carrier_turns.is_empty() {
                out.carrier_turns = made.carrier_turns[frames.clone()].to_vec();
            } else if let Some(kept) = kept {
                out.turned.push(TurnedJoint { joint, rotations: kept.rotations[frames.clone()].to_vec() });
            } else if let Some(rotations) =
                self.track(joint, maps.into_iter(), frames.clone()).into_rotations(frames.clone())
            {
                if is_carrier {
                    out.carrier_turns = self.turns_of(joint, &rotations, frames.start);
                } else {
                    out.turned.push(TurnedJoint { joint, rotations });
                }
            }
        }
        out
    }

    /// Says what in the layers means nothing for this clip, one line each.
    pub fn warnings(&self) -> Vec<String> {
        let mut warnings = Vec::new();
        let end = self.clip.n_file_frames() - 1;
        for (idx, layer) in self.layers.iter().enumerate() {
            let namesake = |other: &Layer| other.name == layer.name;
            let n_before = self.layers[..idx].iter().filter(|other| namesake(other)).count();
            let is_last = !self.layers[idx + 1..].iter().any(namesake);
            if n_before > 0 && is_last {
                warnings.push(format!("{} layers are called {}; rename all but one", n_before + 1, layer.name));
            }
            if layer.merged
                && let Some(below) = self.layers[..idx].iter().find(|below| !below.merged)
            {
                warnings.push(format!(
                    "layer {} is merged into the motion, so it lies below layer {}, whatever their order in the list",
                    layer.name, below.name
                ));
            }
            if let Some(frame) = layer.frames().filter(|&frame| frame > end).min() {
                let name = &layer.name;
                warnings.push(format!("{name} has keys from file frame {frame} on; the clip ends at {end}"));
            }
            let find = |name: &str| find_joint(&self.clip.skeleton, name);
            for name in layer.rotation.keys() {
                let problem = match find(name) {
                    None => format!("there is no joint {name}"),
                    Some(joint) if !self.clip.turns_freely(joint.idx()) => {
                        format!("{name} lacks a rotation channel about each axis")
                    }
                    Some(joint) if joint == self.clip.facts.carrier.value && !self.clip.facts.path_editable => {
                        format!("the carrier {name} cannot be placed anew")
                    }
                    Some(joint) if !can_turn(self.clip, joint) => format!("the carrier hangs below {name}"),
                    Some(joint) => match layer.rotation.keys().find(|other| find(other) == Some(joint)) {
                        Some(first) if first != name => format!("{name} is {first} once more"),
                        _ => continue,
                    },
                };
                warnings.push(format!("layer {}: {problem}; its keys are kept and not used", layer.name));
            }
            if !layer.position.is_empty() && !self.clip.facts.path_editable {
                warnings
                    .push(format!("layer {}: the carrier cannot be moved; its position keys are not used", layer.name));
            }
        }
        warnings
    }

    /// Returns the layers from the lowest to the highest, with their places in the list.
    pub(super) fn in_order(&self) -> impl Iterator<Item = (usize, &'a Layer)> + use<'a> {
        let layers = self.layers;
        let with = move |merged: bool| layers.iter().enumerate().filter(move |(_, layer)| layer.merged == merged);
        with(true).chain(with(false))
    }

    /// Returns the maps of a joint from the lowest layer to the highest.
    pub(super) fn maps_of(&self, joint: JointId) -> impl Iterator<Item = (usize, &'a Layer, &'a Keys<DQuat>)> {
        let skeleton = &self.clip.skeleton;
        self.in_order().filter_map(move |(layer_idx, layer)| {
            let own = |(name, _): &(&String, &Keys<DQuat>)| find_joint(skeleton, name) == Some(joint);
            layer.rotation.iter().find(own).map(|(_, keys)| (layer_idx, layer, keys))
        })
    }

    /// Lays maps on a joint, at some frames of the clip at least.
    pub(super) fn track(&self, joint: JointId, maps: impl Iterator<Item = Map<'a>>, frames: Range<usize>) -> Track<'a> {
        // Angles go on from frame to frame.
        let has_angles = self.layers.iter().any(|layer| layer.interpolation != Interpolation::Quaternion);
        let frames = if has_angles { 0..self.clip.n_frames() } else { frames };
        let base = self.base_of(joint).map(|base| base[frames.clone()].to_vec());
        let mut track = Track::new(self.clip, joint, base, frames);
        maps.for_each(|(layer, keys)| track.lay(layer, keys));
        track
    }

    fn base_of(&self, joint: JointId) -> Option<&'a [DQuat]> {
        self.base.iter().find(|turned| turned.joint == joint).map(|turned| &*turned.rotations)
    }

    /// Returns the sum of the layers' position maps over frames of the clip; empty when no layer moves the carrier.
    fn offsets(&self, frames: Range<usize>) -> Vec<DVec3> {
        let mut sum = Vec::new();
        let frames = self.clip.file_frame(frames.start)..self.clip.file_frame(frames.end);
        for layer in self.layers.iter().filter(|layer| self.moves(layer)) {
            let values = spline::values(&layer.position, Curve::Cubic, frames.clone());
            sum.resize(values.len(), DVec3::ZERO);
            for (sum, value) in sum.iter_mut().zip(values) {
                *sum += layer.effect() * value;
            }
        }
        sum
    }

    /// Tells whether a layer moves the carrier at any frame.
    pub(super) fn moves(&self, layer: &Layer) -> bool {
        let any = layer.position.iter().any(|key| key.value != DVec3::ZERO);
        any && layer.effect() > 0.0 && self.clip.facts.path_editable
    }

    /// Returns all joints that turn, each with its maps from the lowest layer to the highest.
    fn maps(&self) -> BTreeMap<JointId, Vec<Map<'a>>> {
        let mut maps: BTreeMap<_, Vec<_>> = self.base.iter().map(|turned| (turned.joint, Vec::new())).collect();
        for (_, layer) in self.in_order() {
            for (name, keys) in &layer.rotation {
                let joint = find_joint(&self.clip.skeleton, name).filter(|&joint| can_turn(self.clip, joint));
                let Some(joint) = joint else { continue };
                let of_joint: &mut Vec<Map> = maps.entry(joint).or_default();
                // A joint that a layer calls by two names has the map of the first.
                if !of_joint.last().is_some_and(|(last, _)| std::ptr::eq(*last, layer)) {
                    of_joint.push((layer, keys));
                }
            }
        }
        maps
    }

    /// Returns the turns on the right that take the clip's rotations of a joint, from a frame on, to these.
    fn turns_of(&self, joint: JointId, rotations: &[DQuat], first: usize) -> Vec<DQuat> {
        let own = |frame: usize| self.clip.rotations(frame)[joint.idx()];
        let turn = |(frame, &rotation): (usize, &DQuat)| match own(frame) {
            own if own == rotation => DQuat::IDENTITY,
            own => own.conjugate() * rotation,
        };
        (first..).zip(rotations).map(turn).collect()
    }
}

/// Tells whether two joints' maps, laid on the same rotations, give the same.
fn has_equal_effect(maps: &[Map], other: &[Map]) -> bool {
    let is_equal = |((a, a_keys), (b, b_keys)): (&Map, &Map)| {
        a.effect() == b.effect() && a.interpolation == b.interpolation && a_keys == b_keys
    };
    maps.len() == other.len() && maps.iter().zip(other).all(is_equal)
}

#[cfg(test)]
mod tests {
    use std::f64::consts::TAU;

    use glam::DVec3;
    use proptest::prelude::*;

    use super::*;
    use crate::{
        displace::{
            Interpolation,
            sample::{FREE, STIFF, Sample},
        },
        motion::UpAxis,
    };

    const UPS: [UpAxis; 2] = [UpAxis::Y, UpAxis::Z];

    fn name(clip: &Clip, joint: JointId) -> String {
        clip.skeleton.joint(joint).name.clone()
    }

    /// Makes a layer of keys (file frame, turn) on one joint.
    fn layer(clip: &Clip, joint: JointId, interpolation: Interpolation, keys: &[(usize, DQuat)]) -> Layer {
        let mut layer = Layer { interpolation, ..Layer::new("test") };
        for &(frame, turn) in keys {
            layer.set_rotation(&name(clip, joint), frame, turn);
        }
        layer
    }

    fn displaced(clip: &Clip, layers: &[Layer]) -> Displaced {
        Stack { clip, base: &[], layers }.displaced()
    }

    /// Returns a joint's local rotations with these layers, the carrier's among them.
    fn rotations(clip: &Clip, layers: &[Layer], joint: JointId) -> Vec<DQuat> {
        let displaced = displaced(clip, layers);
        let own = |frame: usize| clip.rotations(frame)[joint.idx()];
        if joint == clip.facts.carrier.value {
            let turns = &displaced.carrier_turns;
            return (0..clip.n_frames()).map(|f| own(f) * turns.get(f).copied().unwrap_or(DQuat::IDENTITY)).collect();
        }
        let turned = displaced.turned.into_iter().find(|turned| turned.joint == joint);
        turned.map_or_else(|| (0..clip.n_frames()).map(own).collect(), |turned| turned.rotations)
    }

    fn off(a: DQuat, b: DQuat) -> f64 {
        let turn = a.conjugate() * b;
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    }

    fn turn(angles: [f64; 3]) -> DQuat {
        DQuat::from_scaled_axis(DVec3::from_array(angles))
    }

    /// Returns the size of each frequency of a series, up to half the sampling rate.
    fn spectrum(series: &[f64]) -> Vec<f64> {
        let n = series.len();
        let bin = |k: usize| {
            let wave = |(f, x): (usize, &f64)| {
                DVec3::new((TAU * (k * f) as f64 / n as f64).cos(), (TAU * (k * f) as f64 / n as f64).sin(), 0.0) * *x
            };
            series.iter().enumerate().map(wave).sum::<DVec3>().length() / n as f64
        };
        (0..n / 2).map(bin).collect()
    }

    #[test]
    fn nothing_displaced_is_nothing_at_all() {
        let clip = Sample::default().clip();
        let mut zero =
            layer(&clip, FREE[2], Interpolation::EulerCubic, &[(5, DQuat::IDENTITY), (50, -DQuat::IDENTITY)]);
        zero.position.set(9, DVec3::ZERO);
        let real = layer(&clip, FREE[2], Interpolation::EulerLinear, &[(5, turn([0.3, 0.0, 0.1]))]);
        let off = Layer { on: false, ..real.clone() };
        let weightless = Layer { weight: 0.0, ..real };
        assert!(displaced(&clip, &[]).is_empty());
        assert!(displaced(&clip, &[zero, off, weightless]).is_empty());
    }

    #[test]
    fn frames_without_a_turn_keep_their_bits() {
        let clip = Sample::default().clip();
        for interpolation in Interpolation::ALL {
            let keys =
                [(0, DQuat::IDENTITY), (40, DQuat::IDENTITY), (60, turn([0.5, 0.2, 0.0])), (80, DQuat::IDENTITY)];
            let layers = [layer(&clip, FREE[1], interpolation, &keys), Layer::new("empty")];
            let seen = rotations(&clip, &layers, FREE[1]);
            // The cubic swings out between the keys beside one that is none.
            let quiet = if interpolation == Interpolation::EulerCubic { 78..118 } else { 0..38 };
            for frame in quiet {
                assert_eq!(seen[frame], clip.rotations(frame)[FREE[1].idx()], "{interpolation:?} {frame}");
            }
            assert!(off(seen[58], clip.rotations(58)[FREE[1].idx()]) > 0.4);
        }
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(24))]

        #[test]
        fn in_quaternion_mode_the_difference_is_slerp(
            turns in prop::collection::vec(prop::array::uniform3(-1.8..1.8f64), 2..5),
            joint in 0..5usize,
            up in 0..2usize,
        ) {
            let clip = Sample { up: UPS[up], ..Sample::default() }.clip();
            let keys: Vec<_> = turns.iter().enumerate().map(|(i, &t)| (10 + 30 * i, turn(t))).collect();
            let seen = rotations(&clip, &[layer(&clip, FREE[joint], Interpolation::Quaternion, &keys)], FREE[joint]);
            let mut errors = [vec![], vec![], vec![]];
            for (frame, seen) in seen.iter().enumerate() {
                let file_frame = clip.file_frame(frame);
                let at = keys.iter().rposition(|key| key.0 <= file_frame).unwrap_or(0);
                let next = (at + 1).min(keys.len() - 1);
                let share = (file_frame.max(keys[at].0) - keys[at].0) as f64 / 30.0;
                let map = keys[at].1.slerp(keys[next].1, share);
                let found = clip.rotations(frame)[FREE[joint].idx()].conjugate() * *seen;
                prop_assert!(off(found, map) < 1e-9);
                let error = (map.conjugate() * found).to_scaled_axis();
                (0..3).for_each(|i| errors[i].push(error[i].rem_euclid(TAU).min((-error[i]).rem_euclid(TAU))));
            }
            for series in errors {
                prop_assert!(spectrum(&series).into_iter().all(|size| size < 1e-10), "at every frequency");
            }
        }

        #[test]
        fn in_euler_modes_the_channels_get_the_interpolated_offsets(
            turns in prop::collection::vec(prop::array::uniform3(-1.2..1.2f64), 2..5),
            joint in 0..5usize,
            up in 0..2usize,
            cubic in any::<bool>(),
        ) {
            let clip = Sample { up: UPS[up], ..Sample::default() }.clip();
            let joint = FREE[joint];
            let keys: Vec<_> = turns.iter().enumerate().map(|(i, &t)| (10 + 30 * i, turn(t))).collect();
            let interpolation = if cubic { Interpolation::EulerCubic } else { Interpolation::EulerLinear };
            let seen = rotations(&clip, &[layer(&clip, joint, interpolation, &keys)], joint);
            let order = clip.rotation_order(joint.idx()).expect("free");
            let source = clip.rotation_degrees(joint.idx());
            // Offsets at the keys by hand: the triple nearest the source's that gives the pose.
            let offsets: Vec<_> = keys.iter().map(|&(frame, turn)| {
                let own = frame - clip.rest_frames();
                let pose = clip.rotations(own)[joint.idx()] * turn;
                let nearest = order.nearest_degrees(pose, source[own]);
                super::super::Key { frame, value: DVec3::from_array(nearest) - DVec3::from_array(source[own]) }
            }).collect();
            let curve = if cubic { Curve::Cubic } else { Curve::Linear };
            let map = spline::values(&offsets, curve, clip.rest_frames()..clip.n_file_frames());
            let (mut edited, mut detail) = (Vec::new(), Vec::new());
            for (frame, map) in map.iter().enumerate() {
                let sum = (DVec3::from_array(source[frame]) + *map).to_array();
                let channels = order.nearest_degrees(seen[frame], sum);
                prop_assert!((0..3).all(|i| (channels[i] - sum[i]).abs() < 1e-6), "frame {frame}");
                edited.push(channels[0] - map[0]);
                detail.push(source[frame][0]);
            }
            for (edited, source) in spectrum(&edited).into_iter().zip(spectrum(&detail)) {
                prop_assert!((edited - source).abs() < 1e-7, "all of the capture's frequencies stay");
            }
        }

        #[test]
        fn every_mode_passes_through_the_same_poses_at_the_keys(
            turns in prop::collection::vec(prop::array::uniform3(-3.0..3.0f64), 1..5),
            joint in 0..5usize,
            wraps in any::<bool>(),
        ) {
            let clip = Sample { wraps, swing: 80.0, ..Sample::default() }.clip();
            let joint = FREE[joint];
            let keys: Vec<_> = turns.iter().enumerate().map(|(i, &t)| (10 + 30 * i, turn(t))).collect();
            for interpolation in Interpolation::ALL {
                let seen = rotations(&clip, &[layer(&clip, joint, interpolation, &keys)], joint);
                for &(frame, turn) in keys.iter().filter(|key| key.0 < clip.n_file_frames()) {
                    let own = frame - clip.rest_frames();
                    prop_assert!(off(seen[own], clip.rotations(own)[joint.idx()] * turn) < 1e-8);
                }
            }
        }
    }

    #[test]
    fn angles_that_wrap_or_change_the_triple_make_no_jump() {
        let clip = Sample { wraps: true, swing: 150.0, ..Sample::default() }.clip();
        let smooth = Sample { wraps: false, swing: 150.0, ..Sample::default() }.clip();
        for joint in FREE {
            for interpolation in Interpolation::ALL {
                let keys = [(20, turn([0.4, -0.3, 0.2])), (60, turn([-0.5, 0.9, 0.3])), (95, turn([0.1, 0.0, -0.6]))];
                let layers = [layer(&clip, joint, interpolation, &keys)];
                let (seen, want) = (rotations(&clip, &layers, joint), rotations(&smooth, &layers, joint));
                for (seen, want) in seen.iter().zip(&want) {
                    assert!(off(*seen, *want) < 1e-7, "{interpolation:?} is not what the continuous file gives");
                }
            }
        }
    }

    #[test]
    fn layers_lie_on_one_another_with_their_weights_merged_ones_lowest() {
        let clip = Sample::default().clip();
        let joint = FREE[3];
        let (a, b, c) = (turn([0.9, 0.2, -0.3]), turn([-0.4, 0.8, 0.1]), turn([0.1, 0.3, 1.0]));
        let of = |turn, weight, merged| Layer {
            weight,
            merged,
            ..layer(&clip, joint, Interpolation::Quaternion, &[(40, turn)])
        };
        let layers = [of(a, 0.5, false), of(b, 1.0, false), of(c, 0.25, true)];
        let share = |turn: DQuat, weight: f64| DQuat::from_scaled_axis(turn.to_scaled_axis() * weight);
        for (frame, seen) in rotations(&clip, &layers, joint).into_iter().enumerate() {
            let want = clip.rotations(frame)[joint.idx()] * share(c, 0.25) * share(a, 0.5) * b;
            assert!(off(seen, want) < 1e-12);
        }
        // In Euler angles, too, the upper layer adds to what the lower one gives.
        let euler: Vec<_> =
            layers.iter().map(|l| Layer { interpolation: Interpolation::EulerLinear, ..l.clone() }).collect();
        let below = rotations(&clip, &[euler[2].clone(), euler[0].clone()], joint);
        let whole = rotations(&clip, &euler, joint);
        let frame = 40 - clip.rest_frames();
        assert!(off(whole[frame], below[frame] * b) < 1e-8);
    }

    #[test]
    fn merging_changes_no_pose() {
        let clip = Sample::default().clip();
        let mut layers: Vec<Layer> = (0..4)
            .map(|i| {
                let keys = [(10 + i, turn([0.3, 0.1 * i as f64, -0.2])), (70, turn([0.2, -0.5, 0.1 * i as f64]))];
                let mut layer = layer(&clip, FREE[i], Interpolation::ALL[i % 3], &keys);
                layer.set_rotation(&name(&clip, FREE[2]), 30, turn([0.1, 0.2 * i as f64, 0.4]));
                layer.position.set(30, DVec3::new(0.1, 0.2, i as f64));
                Layer { on: i != 1, weight: 0.9, ..layer }
            })
            .collect();
        let before = displaced(&clip, &layers);
        assert!(crate::displace::merge(&mut layers, 2));
        assert_eq!(displaced(&clip, &layers), before);
    }

    #[test]
    fn the_carrier_turns_about_itself_and_moves_with_the_path() {
        let clip = Sample::default().clip();
        let carrier = clip.facts.carrier.value;
        assert_eq!(carrier, FREE[0]);
        let mut moved = layer(&clip, carrier, Interpolation::EulerCubic, &[(30, turn([0.0, 0.4, 0.2]))]);
        moved.weight = 0.5;
        moved.position.set(20, DVec3::new(0.0, 0.0, 2.0));
        moved.position.set(40, DVec3::new(1.0, 0.0, 4.0));
        let displaced = displaced(&clip, &[moved.clone(), moved]);
        assert!(displaced.turned.is_empty() && displaced.moves_carrier());
        let frame = 30 - clip.rest_frames();
        assert!(displaced.offsets[frame].abs_diff_eq(DVec3::new(0.5, 0.0, 3.0), 1e-12));
        assert_eq!(displaced.offsets[0], DVec3::new(0.0, 0.0, 2.0), "constant outside the keys");
        let quarter = DQuat::from_rotation_y(std::f64::consts::FRAC_PI_2);
        let carried = Rigid::new(turn([0.3, 0.2, 0.1]), DVec3::new(5.0, 6.0, 7.0));
        let placed = displaced.carrier(frame, carried, || quarter);
        assert!(placed.translation.abs_diff_eq(DVec3::new(8.0, 6.0, 6.5), 1e-12), "forward is +X here");
        assert_eq!(placed.rotation, carried.rotation * displaced.carrier_turns[frame]);
        let back = displaced.undisplaced_carrier(frame, placed, quarter);
        assert!(back.rotation.angle_between(carried.rotation) < 1e-7);
        assert!(back.translation.distance(carried.translation) < 1e-12);
        assert_eq!(Displaced::default().carrier(frame, carried, || quarter), carried);
    }

    #[test]
    fn keys_that_mean_nothing_here_are_told() {
        let clip = Sample::default().clip();
        let mut odd = Layer::new("odd");
        for joint in ["Hips", "Tail", "Hand", "Root"] {
            odd.set_rotation(joint, 3, turn([0.1, 0.2, 0.3]));
        }
        let stack = Stack { clip: &clip, base: &[], layers: &[odd] };
        let warnings = stack.warnings();
        assert_eq!(warnings.len(), 3, "{warnings:?}");
        for word in ["Tail", "Hand", "Root"] {
            assert!(warnings.iter().any(|w| w.starts_with("layer odd: ") && w.contains(word)), "{warnings:?}");
        }
        assert!(stack.displaced().turned.is_empty() && !can_turn(&clip, STIFF));
    }

    #[test]
    fn a_joint_called_by_two_names_turns_once() {
        let clip = Sample::default().clip();
        let own = name(&clip, FREE[2]);
        let once = layer(&clip, FREE[2], Interpolation::Quaternion, &[(5, turn([0.3, 0.0, 0.1]))]);
        let mut twice = once.clone();
        twice.set_rotation(&format!("{own}#1"), 5, turn([0.4, 0.0, 0.0]));
        assert_eq!(displaced(&clip, std::slice::from_ref(&twice)), displaced(&clip, &[once]));
        let warnings = Stack { clip: &clip, base: &[], layers: &[twice] }.warnings();
        assert_eq!(warnings, [format!("layer test: {own}#1 is {own} once more; its keys are kept and not used")]);
    }

    #[test]
    fn layers_that_are_easily_mistaken_are_told() {
        let clip = Sample::default().clip();
        let merged = |name: &str| Layer { merged: true, ..Layer::new(name) };
        let check = |layers: &[Layer], expected: &[&str]| {
            assert_eq!(Stack { clip: &clip, base: &[], layers }.warnings(), expected);
        };
        let rename = "3 layers are called wave; rename all but one";
        check(&["wave", "arms", "wave", "legs", "wave"].map(Layer::new), &[rename]);
        check(&[merged("a"), merged("b"), Layer::new("c")], &[]);
        let below =
            "layer c is merged into the motion, so it lies below layer b, whatever their order in the list".to_owned();
        check(&[merged("a"), Layer::new("b"), merged("c")], &[&below]);
    }

    #[test]
    fn what_an_earlier_stack_made_changes_nothing() {
        let clip = Sample::default().clip();
        let other_clip = Sample { swing: 9.0, ..Sample::default() }.clip();
        let layers: Vec<Layer> = (0..3)
            .map(|i| {
                layer(
                    &clip,
                    FREE[i],
                    Interpolation::ALL[i],
                    &[(20, turn([0.1, 0.2, 0.3])), (60, turn([0.5, 0.0, 0.1]))],
                )
            })
            .collect();
        let base = [TurnedJoint { joint: FREE[1], rotations: vec![DQuat::from_rotation_x(1.0); clip.n_frames()] }];
        let mut changed = layers.clone();
        changed[1].set_rotation("Spine", 40, turn([0.0, 0.2, 0.0]));
        changed[0].weight = 0.5;
        let fewer = layers[1..].to_vec();
        let mut stacks = Vec::new();
        for clip in [&clip, &other_clip] {
            for base in [&base[..], &[]] {
                for layers in [&layers[..], &changed, &fewer, &[]] {
                    stacks.push(Stack { clip, base, layers });
                }
            }
        }
        for earlier in &stacks {
            let made = earlier.displaced();
            for stack in &stacks {
                let whole = stack.displaced();
                assert_eq!(stack.displaced_again(earlier, &made, 0..clip.n_frames()), whole);
                for frames in [0..1, 30..47, 50..clip.n_frames()] {
                    let some = stack.displaced_again(earlier, &made, frames.clone());
                    let shown: Vec<u32> = frames.clone().map(|frame| frame as u32).collect();
                    assert_eq!(some.turned, whole.shown(&shown), "{frames:?}");
                    assert_eq!(some.offsets, whole.offsets.get(frames.clone()).unwrap_or_default(), "{frames:?}");
                    assert_eq!(some.carrier_turns, whole.carrier_turns.get(frames).unwrap_or_default());
                }
            }
        }
    }

    #[test]
    fn a_carrier_without_position_channels_is_left_where_it_is() {
        let text = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n\
            End Site\n{\nOFFSET 0 1 0\n}\n}\nMOTION\nFrames: 2\nFrame Time: 0.1\n1 2 3\n4 5 6\n";
        let bvh = crate::bvh::Bvh::parse(text.as_bytes(), "still.bvh").expect("a good file");
        let clip = Clip::from_bvh(&bvh, &crate::motion::ClipOptions::default());
        let mut moved = layer(&clip, JointId(0), Interpolation::EulerLinear, &[(1, turn([0.1, 0.2, 0.3]))]);
        moved.position.set(0, DVec3::X);
        let stack = Stack { clip: &clip, base: &[], layers: &[moved] };
        assert!(stack.displaced().is_empty());
        assert_eq!(stack.warnings().len(), 2, "{:?}", stack.warnings());
        assert_eq!(stack.position_key(0, 1, DVec3::Y), None);
    }

    #[test]
    fn shown_frames_may_repeat_and_be_left_out() {
        let clip = Sample::default().clip();
        let layers = [layer(&clip, FREE[4], Interpolation::Quaternion, &[(30, turn([0.0, 0.4, 0.2]))])];
        let displaced = displaced(&clip, &layers);
        let shown = displaced.shown(&[7, 8, 7]);
        let all = &displaced.turned[0].rotations;
        assert_eq!(shown[0].rotations, [all[7], all[8], all[7]]);
    }
}
