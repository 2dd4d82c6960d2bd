//! Key commands on the selected maps of a layer: walk, delete, move, copy, list.

use std::{collections::BTreeSet, fmt};

use glam::{DQuat, DVec3};

use super::{Keys, Layer, slerp};
use crate::math::{fixed, rotation_vector};

/// A number from here on is written with a power of ten.
const TOO_LONG: f64 = 1e9;

/// Decimals of an angle where there is little room, degrees.
const DEGREE_DECIMALS: usize = 2;

/// Which maps of a layer a command is about.
#[derive(Clone, Debug, Default, PartialEq, Eq)]
pub struct Selection {
    /// The carrier's position map.
    pub position: bool,
    /// Rotation maps, by the joint's name in maps.
    pub joints: BTreeSet<String>,
}

/// One key as it is printed.
#[derive(Clone, Debug, PartialEq)]
pub struct MapPoint {
    /// Frame of the file.
    pub frame: usize,
    /// What the key holds.
    pub value: PointValue,
}

/// What a key holds, and of which map it is.
#[derive(Clone, Debug, PartialEq)]
pub enum PointValue {
    /// Offset of the carrier: lateral, up, forward; the clip's unit.
    Position(DVec3),
    /// Rotation Δ of a joint.
    Rotation(String, DQuat),
}

impl PointValue {
    /// Returns the name of the map it is of: the joint's, or `position`.
    pub fn map_name(&self) -> &str {
        match self {
            Self::Position(_) => "position",
            Self::Rotation(joint, _) => joint,
        }
    }

    /// Writes what it holds in little room: lateral, up and forward with so many decimals, or degrees about the joint's
    /// own x, y and z.
    pub fn short(&self, decimals: usize) -> String {
        match self {
            Self::Position(by) => by.to_array().map(|n| number(n, decimals)).join(" "),
            Self::Rotation(_, turn) => {
                let degrees = rotation_vector(slerp::short_way(*turn)).map(f64::to_degrees);
                format!("{}°", degrees.to_array().map(|n| fixed(n, DEGREE_DECIMALS)).join(" "))
            }
        }
    }
}

impl fmt::Display for PointValue {
    /// For people: offsets in the clip's unit, turns in degrees about an axis of the joint's own space.
    fn fmt(&self, f: &mut fmt::Formatter) -> fmt::Result {
        match self {
            Self::Position(by) => {
                let [lateral, up, forward] = by.to_array().map(|n| number(n, 4));
                write!(f, "lateral {lateral}  up {up}  forward {forward}")
            }
            Self::Rotation(_, turn) => {
                let vector = rotation_vector(slerp::short_way(*turn));
                let (axis, angle) = (vector.normalize_or_zero(), vector.length().to_degrees());
                let [x, y, z] = axis.to_array().map(|n| fixed(n, 3));
                write!(f, "{angle:.3}° about [{x}, {y}, {z}]")
            }
        }
    }
}

/// Writes a number with so many decimals; one too large for them to mean anything with a power of ten.
fn number(n: f64, decimals: usize) -> String {
    if n.abs() < TOO_LONG { fixed(n, decimals) } else { format!("{n:.decimals$e}") }
}

impl Selection {
    /// Selects every map that a layer has.
    pub fn all(layer: &Layer) -> Self {
        Self { position: true, joints: layer.rotation.keys().cloned().collect() }
    }
}

impl Layer {
    /// Returns the frames of the selected maps' keys, rising, each once.
    pub fn key_frames(&self, selection: &Selection) -> Vec<usize> {
        let frames: BTreeSet<usize> = self.map_points(selection).iter().map(|point| point.frame).collect();
        frames.into_iter().collect()
    }

    /// Returns the first key frame after a frame.
    pub fn next_key(&self, selection: &Selection, frame: usize) -> Option<usize> {
        self.key_frames(selection).into_iter().find(|&key| key > frame)
    }

    /// Returns the last key frame before a frame.
    pub fn previous_key(&self, selection: &Selection, frame: usize) -> Option<usize> {
        self.key_frames(selection).into_iter().rev().find(|&key| key < frame)
    }

    /// Lists the keys of the selected maps by frame: position first, then joints by name.
    pub fn map_points(&self, selection: &Selection) -> Vec<MapPoint> {
        let positions = self.position.iter().filter(|_| selection.position);
        let positions = positions.map(|key| MapPoint { frame: key.frame, value: PointValue::Position(key.value) });
        let joints = self.rotation.iter().filter(|(joint, _)| selection.joints.contains(*joint));
        let rotations = joints.flat_map(|(joint, keys)| {
            keys.iter().map(|key| MapPoint { frame: key.frame, value: PointValue::Rotation(joint.clone(), key.value) })
        });
        let mut points: Vec<_> = positions.chain(rotations).collect();
        points.sort_by_key(|point| point.frame);
        points
    }

    /// Deletes the selected maps' keys at a frame; tells whether there was one.
    pub fn delete_keys(&mut self, selection: &Selection, frame: usize) -> bool {
        let mut any = false;
        self.change(selection, |map| any |= map.delete(frame));
        any
    }

    /// Copies the selected maps' keys from one frame to another, over keys that are there; tells whether there was one.
    pub fn copy_keys(&mut self, selection: &Selection, from: usize, to: usize) -> bool {
        let mut any = false;
        self.change(selection, |map| any |= map.copy(from, to));
        any
    }

    /// Moves the selected maps' keys from one frame to another, over keys that are there; tells whether there was one.
    pub fn move_keys(&mut self, selection: &Selection, from: usize, to: usize) -> bool {
        let any = self.copy_keys(selection, from, to);
        if from != to {
            self.delete_keys(selection, from);
        }
        any
    }

    /// Changes the selected maps; a rotation map without keys is none.
    fn change(&mut self, selection: &Selection, mut change: impl FnMut(&mut dyn Map)) {
        if selection.position {
            change(&mut self.position);
        }
        for (_, keys) in self.rotation.iter_mut().filter(|(joint, _)| selection.joints.contains(*joint)) {
            change(keys);
        }
        self.rotation.retain(|_, keys| !keys.is_empty());
    }
}

/// What commands do to a map, whatever it holds.
trait Map {
    fn delete(&mut self, frame: usize) -> bool;
    fn copy(&mut self, from: usize, to: usize) -> bool;
}

impl<T: Copy> Map for Keys<T> {
    fn delete(&mut self, frame: usize) -> bool {
        self.remove(frame).is_some()
    }

    fn copy(&mut self, from: usize, to: usize) -> bool {
        let value = self.get(from);
        if let Some(value) = value {
            self.set(to, value);
        }
        value.is_some()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Writes a layer's keys as one line: `p` for position, joints by their names.
    fn shown(layer: &Layer) -> String {
        let points = layer.map_points(&Selection::all(layer));
        let words = points.iter().map(|point| match &point.value {
            PointValue::Position(v) => format!("p{}={}", point.frame, v.x),
            PointValue::Rotation(joint, q) => format!("{joint}{}={:.1}", point.frame, q.to_axis_angle().1),
        });
        words.collect::<Vec<_>>().join(" ")
    }

    fn layer() -> Layer {
        let mut layer = Layer::new("test");
        for (frame, x) in [(5, 1.0), (20, 2.0)] {
            layer.position.set(frame, DVec3::X * x);
        }
        for (joint, frame, angle) in [("a", 5, 0.1), ("a", 9, 0.2), ("b", 9, 0.3)] {
            layer.set_rotation(joint, frame, DQuat::from_rotation_x(angle));
        }
        layer
    }

    /// The triple of these tests: selected maps, a command, the keys that are left.
    #[track_caller]
    fn check(position: bool, joints: &str, command: impl Fn(&mut Layer, &Selection) -> bool, expected: (bool, &str)) {
        let selection = Selection { position, joints: joints.split_whitespace().map(str::to_owned).collect() };
        let mut layer = layer();
        let any = command(&mut layer, &selection);
        assert_eq!((any, shown(&layer).as_str()), expected);
    }

    #[test]
    fn commands_do_what_they_say_to_the_selected_maps_only() {
        const UNTOUCHED: &str = "p5=1 a5=0.1 a9=0.2 b9=0.3 p20=2";
        check(true, "a b", |l, s| l.delete_keys(s, 5), (true, "a9=0.2 b9=0.3 p20=2"));
        check(false, "a b", |l, s| l.delete_keys(s, 9), (true, "p5=1 a5=0.1 p20=2"));
        check(true, "b", |l, s| l.delete_keys(s, 6), (false, UNTOUCHED));
        check(true, "a", |l, s| l.move_keys(s, 5, 20), (true, "a9=0.2 b9=0.3 p20=1 a20=0.1"));
        check(true, "a", |l, s| l.move_keys(s, 5, 5), (true, UNTOUCHED));
        check(true, "a", |l, s| l.move_keys(s, 6, 5), (false, UNTOUCHED));
        check(false, "a", |l, s| l.copy_keys(s, 5, 0), (true, "a0=0.1 p5=1 a5=0.1 a9=0.2 b9=0.3 p20=2"));
        check(false, "c", |l, s| l.copy_keys(s, 5, 0), (false, UNTOUCHED));
    }

    #[test]
    fn walking_from_key_to_key_sees_the_selected_maps() {
        let layer = layer();
        let all = Selection::all(&layer);
        assert_eq!(layer.key_frames(&all), [5, 9, 20]);
        assert_eq!((layer.next_key(&all, 5), layer.previous_key(&all, 5)), (Some(9), None));
        assert_eq!((layer.next_key(&all, 20), layer.previous_key(&all, 19)), (None, Some(9)));
        let position = Selection { position: true, joints: BTreeSet::new() };
        assert_eq!(layer.next_key(&position, 5), Some(20));
        assert_eq!(layer.next_key(&Selection::default(), 0), None);
    }

    #[test]
    fn the_two_quaternions_of_a_rotation_are_one_key() {
        let mut layer = layer();
        layer.set_rotation("a", 5, -DQuat::from_rotation_x(0.1));
        assert_eq!(layer, self::layer());
    }
}
