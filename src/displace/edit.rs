//! From a wanted pose to the key that gives it, and from a map to the key that changes nothing.
//!
//! Frames here are the clip's. What is wanted is what is to be *seen*, with all layers; the key goes into one of them,
//! so what lies above it is taken off first. A layer that is off cannot show an edit, and one with little weight
//! cannot show a large one: in quaternion mode beyond half a turn over the weight, in Euler modes where the offsets
//! that it takes are not the ones nearest the base any more.

use std::ops::Range;

use glam::{DMat3, DQuat, DVec3};

use super::{Curve, Interpolation, Layer, Stack, joint_name, slerp, spline};
use crate::{math::rotation_vector, skeleton::JointId};

/// A pose that is nearer than this, radians, is the wanted one.
const SAME: f64 = 1e-9;

/// Most steps of Newton's method; from a pose nearby three or four are enough.
const ROUNDS: usize = 16;

/// Turn, radians, by which derivatives are taken.
const PROBE: f64 = 1e-6;

/// A step of Newton's method turns a key no further, radians.
const LARGEST_STEP: f64 = 0.5;

impl Stack<'_> {
    /// Returns a joint's local rotation as it is seen; of the carrier, as it would be without the path edit.
    pub fn rotation(&self, joint: JointId, frame: usize) -> DQuat {
        let has_maps = self.base.iter().any(|turned| turned.joint == joint) || self.maps_of(joint).next().is_some();
        if has_maps && super::can_turn(self.clip, joint) {
            let maps = self.maps_of(joint).map(|(_, layer, keys)| (layer, keys));
            self.track(joint, maps, frame..frame + 1).rotation(frame)
        } else {
            self.clip.rotations(frame)[joint.idx()]
        }
    }

    /// Returns the offset of the carrier as it is seen, with all layers.
    pub fn offset(&self, frame: usize) -> DVec3 {
        let of = |layer: &Layer| layer.effect() * self.layer_offset(layer, frame);
        self.layers.iter().filter(|layer| self.moves(layer)).map(of).sum()
    }

    /// Returns the rotation that a layer's map of a joint holds at a frame: a key of it changes no pose at that frame.
    ///
    /// Where an Euler layer has too little weight to show it, the key is what the map holds, and the pose may change.
    ///
    /// # Panics
    ///
    /// When the joint does not [turn freely](crate::motion::Clip::turns_freely).
    pub fn rotation_here(&self, layer_idx: usize, joint: JointId, frame: usize) -> DQuat {
        let layer = &self.layers[layer_idx];
        let own = self.maps_of(joint).find(|&(idx, ..)| idx == layer_idx);
        let Some((_, _, keys)) = own else { return DQuat::IDENTITY };
        let value = self.below(layer_idx, joint, frame..frame + 1).value(layer.interpolation, keys, frame);
        if layer.effect() == 0.0 {
            return value;
        }
        self.settled(layer_idx, joint, frame, value, self.rotation(joint, frame)).unwrap_or(value)
    }

    /// Returns what a layer adds to a joint's rotation channels, weight included: degrees at the clip's frames, in the
    /// order of [the joint's channels](crate::motion::RotationOrder::axes).
    ///
    /// None in quaternion mode, and for a joint that cannot have a map.
    pub fn channel_offsets(&self, layer_idx: usize, joint: JointId) -> Option<Vec<DVec3>> {
        let layer = &self.layers[layer_idx];
        let curve = layer.interpolation.curve()?;
        if !super::can_turn(self.clip, joint) {
            return None;
        }
        let Some((_, _, keys)) = self.maps_of(joint).find(|&(idx, ..)| idx == layer_idx) else {
            return Some(vec![DVec3::ZERO; self.clip.n_frames()]);
        };
        let mut offsets = self.below(layer_idx, joint, 0..self.clip.n_frames()).channel_offsets(curve, keys);
        offsets.iter_mut().for_each(|offset| *offset *= layer.effect());
        Some(offsets)
    }

    /// Returns the offset that a layer's position map holds at a frame: a key of it changes nothing there.
    pub fn position_here(&self, layer_idx: usize, frame: usize) -> DVec3 {
        self.layer_offset(&self.layers[layer_idx], frame)
    }

    /// Returns the key that makes a joint's local rotation, as it is seen, this one.
    ///
    /// None when the layer cannot show it: off, without weight, or with too little of it for so large a turn.
    ///
    /// # Panics
    ///
    /// When the joint does not [turn freely](crate::motion::Clip::turns_freely).
    pub fn rotation_key(&self, layer_idx: usize, joint: JointId, frame: usize, seen: DQuat) -> Option<DQuat> {
        let layer = &self.layers[layer_idx];
        if layer.effect() == 0.0 {
            return None;
        }
        // What lies above turns the joint by this much, as long as it does not follow what is below it.
        let on_top = self.through(layer_idx, joint, frame).conjugate() * self.rotation(joint, frame);
        let key = self.own_key(layer_idx, joint, frame, seen * on_top.conjugate())?;
        self.settled(layer_idx, joint, frame, key, seen)
    }

    /// Returns the key that makes the carrier's offset, as it is seen, this one; none when the layer cannot show it.
    pub fn position_key(&self, layer_idx: usize, frame: usize, seen: DVec3) -> Option<DVec3> {
        let layer = &self.layers[layer_idx];
        let effect = layer.effect();
        let is_possible = effect > 0.0 && self.clip.facts.path_editable;
        is_possible.then(|| self.layer_offset(layer, frame) + (seen - self.offset(frame)) / effect)
    }

    /// Returns the key nearby that makes the joint's rotation, as it is seen, this one; `key` itself if it does.
    ///
    /// Euler layers read the poses below them at their own keys, so a key may change what they add; Newton's method
    /// finds what that asks for. None when it finds nothing.
    fn settled(&self, layer_idx: usize, joint: JointId, frame: usize, key: DQuat, seen: DQuat) -> Option<DQuat> {
        let name = joint_name(&self.clip.skeleton, joint);
        let mut layers = self.layers.to_vec();
        let mut error = |key: DQuat| {
            layers[layer_idx].set_rotation(&name, self.clip.file_frame(frame), key.normalize());
            let reached = Stack { layers: &layers, ..*self }.rotation(joint, frame);
            rotation_vector(slerp::short_way(seen.conjugate() * reached))
        };
        let mut key = key;
        for _ in 0..ROUNDS {
            let off = error(key);
            if off.length() < SAME {
                return Some(slerp::short_way(key));
            }
            let column = |axis: DVec3| (error(key * DQuat::from_scaled_axis(PROBE * axis)) - off) / PROBE;
            let [x, y, z] = DVec3::AXES.map(column);
            let step = DMat3::from_cols(x, y, z).inverse() * off;
            if !step.is_finite() {
                return None;
            }
            key = (key * DQuat::from_scaled_axis(-step.clamp_length_max(LARGEST_STEP))).normalize();
        }
        None
    }

    fn layer_offset(&self, layer: &Layer, frame: usize) -> DVec3 {
        let file_frame = self.clip.file_frame(frame);
        if layer.position.is_empty() {
            return DVec3::ZERO;
        }
        spline::values(&layer.position, Curve::Cubic, file_frame..file_frame + 1)[0]
    }

    /// Returns the joint with all layers below one, at some frames.
    fn below(&self, layer_idx: usize, joint: JointId, frames: Range<usize>) -> super::track::Track<'_> {
        let place = self.in_order().position(|(idx, _)| idx == layer_idx).expect("the layer is in the list");
        let lower: Vec<usize> = self.in_order().take(place).map(|(idx, _)| idx).collect();
        let maps = self.maps_of(joint).filter(|(idx, ..)| lower.contains(idx));
        self.track(joint, maps.map(|(_, layer, keys)| (layer, keys)), frames)
    }

    /// Returns the joint's rotation with all layers up to one, that one included.
    fn through(&self, layer_idx: usize, joint: JointId, frame: usize) -> DQuat {
        let mut track = self.below(layer_idx, joint, frame..frame + 1);
        if let Some((_, layer, keys)) = self.maps_of(joint).find(|&(idx, ..)| idx == layer_idx) {
            track.lay(layer, keys);
        }
        track.rotation(frame)
    }

    /// Returns the key that makes a joint's rotation with all layers up to one this one.
    fn own_key(&self, layer_idx: usize, joint: JointId, frame: usize, wanted: DQuat) -> Option<DQuat> {
        let layer = &self.layers[layer_idx];
        let mut below = self.below(layer_idx, joint, frame..frame + 1);
        let turn = slerp::short_way(below.rotation(frame).conjugate() * wanted).normalize();
        let key = match layer.interpolation {
            Interpolation::Quaternion => {
                let angle = 2.0 * turn.xyz().length().atan2(turn.w);
                let is_possible = angle / layer.effect() <= std::f64::consts::PI;
                return is_possible.then(|| slerp::power(turn, 1.0 / layer.effect()));
            }
            Interpolation::EulerLinear | Interpolation::EulerCubic => {
                let offset = below.offset_of_turn(frame, turn) / layer.effect();
                below.turn_of_offset(frame, offset)
            }
        };
        Some(key)
    }
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::displace::sample::{FREE, Sample};

    fn turn(angles: [f64; 3]) -> DQuat {
        DQuat::from_scaled_axis(DVec3::from_array(angles))
    }

    fn angle_between(a: DQuat, b: DQuat) -> f64 {
        let turn = a.conjugate() * b;
        2.0 * turn.xyz().length().atan2(turn.w.abs())
    }

    fn any_layer(swing: f64) -> impl Strategy<Value = Layer> {
        let keys = prop::collection::vec((0..130usize, prop::array::uniform3(-swing..swing)), 0..5);
        (keys, 0..3usize, 0.8..=1.0f64).prop_map(|(keys, mode, weight)| {
            let mut layer = Layer { interpolation: Interpolation::ALL[mode], weight, ..Layer::new("any") };
            for (frame, angles) in keys {
                layer.set_rotation("Arm", frame, turn(angles));
                layer.position.set(frame, DVec3::from_array(angles));
            }
            layer
        })
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(32))]

        #[test]
        fn a_key_gives_the_wanted_pose_under_any_layers(
            layers in prop::collection::vec(any_layer(0.3), 1..4),
            pick in 0..3usize,
            frame in 0..120usize,
            angles in prop::array::uniform3(-0.3..0.3f64),
        ) {
            let clip = Sample { swing: 10.0, ..Sample::default() }.clip();
            let (arm, pick) = (FREE[2], pick % layers.len());
            let stack = Stack { clip: &clip, base: &[], layers: &layers };
            let seen = stack.rotation(arm, frame) * turn(angles);
            let offset = stack.offset(frame) + DVec3::from_array(angles);
            let key = stack.rotation_key(pick, arm, frame, seen).expect("enough weight");
            let position = stack.position_key(pick, frame, offset).expect("enough weight");
            let mut edited = layers.clone();
            edited[pick].set_rotation("Arm", clip.file_frame(frame), key);
            edited[pick].position.set(clip.file_frame(frame), position);
            let stack = Stack { layers: &edited, ..stack };
            prop_assert!(angle_between(stack.rotation(arm, frame), seen) < 1e-8);
            prop_assert!(stack.offset(frame).abs_diff_eq(offset, 1e-12));
            let displaced = stack.displaced();
            prop_assert!(displaced.offsets[frame].abs_diff_eq(offset, 1e-12));
            let turned = displaced.turned.iter().find(|t| t.joint == arm);
            prop_assert!(turned.is_none_or(|t| angle_between(t.rotations[frame], seen) < 1e-8));
        }

        #[test]
        fn a_key_of_what_is_there_changes_no_pose_at_its_frame(
            layers in prop::collection::vec(any_layer(0.3), 1..4),
            pick in 0..3usize,
            frame in 0..120usize,
        ) {
            let clip = Sample::default().clip();
            let (arm, pick) = (FREE[2], pick % layers.len());
            let stack = Stack { clip: &clip, base: &[], layers: &layers };
            let mut edited = layers.clone();
            edited[pick].set_rotation("Arm", clip.file_frame(frame), stack.rotation_here(pick, arm, frame));
            edited[pick].position.set(clip.file_frame(frame), stack.position_here(pick, frame));
            let after = Stack { layers: &edited, ..stack };
            prop_assert!(angle_between(after.rotation(arm, frame), stack.rotation(arm, frame)) < 1e-8);
            prop_assert!(after.offset(frame).abs_diff_eq(stack.offset(frame), 1e-12));
            if layers.iter().all(|l| l.interpolation == Interpolation::Quaternion) {
                for other in 0..120 {
                    prop_assert!(angle_between(after.rotation(arm, other), stack.rotation(arm, other)) < 1e-7);
                }
            }
        }
    }

    #[test]
    fn a_layer_that_cannot_show_an_edit_says_so() {
        let clip = Sample::default().clip();
        let half = turn([3.0, 0.0, 0.0]);
        for (layer, possible) in [
            (Layer::new("on"), true),
            (Layer { on: false, ..Layer::new("off") }, false),
            (Layer { weight: 0.0, ..Layer::new("weightless") }, false),
            (Layer { weight: 0.5, ..Layer::new("light") }, false),
        ] {
            let layers = [layer];
            let stack = Stack { clip: &clip, base: &[], layers: &layers };
            let seen = stack.rotation(FREE[1], 7) * half;
            assert_eq!(stack.rotation_key(0, FREE[1], 7, seen).is_some(), possible, "{}", layers[0].name);
            let moves = layers[0].effect() > 0.0;
            assert_eq!(stack.position_key(0, 7, DVec3::X).is_some(), moves, "{}", layers[0].name);
        }
    }
}
