//! A layer: keyed position offsets of the carrier and keyed rotations of joints.

use std::collections::BTreeMap;

use glam::{DQuat, DVec3};
use serde::{Deserialize, Deserializer, Serialize, de::Error as _};

use super::{Curve, Keys};

/// How rotations go from key to key. Positions always follow the cubic.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
#[serde(rename_all = "snake_case")]
pub enum Interpolation {
    /// Spherical linear interpolation, the short way.
    #[default]
    Quaternion,
    /// Linear in the joint's own rotation channels.
    EulerLinear,
    /// The cubic of METHOD 8 in the joint's own rotation channels.
    EulerCubic,
}

impl Interpolation {
    /// All of them, in the order in which they are offered.
    pub const ALL: [Self; 3] = [Self::Quaternion, Self::EulerLinear, Self::EulerCubic];

    /// Returns its name for people.
    pub fn words(self) -> &'static str {
        match self {
            Self::Quaternion => "quaternion",
            Self::EulerLinear => "Euler linear",
            Self::EulerCubic => "Euler cubic",
        }
    }

    /// Returns the curve that channel offsets follow from key to key; none where rotations do not go by channels.
    pub(super) fn curve(self) -> Option<Curve> {
        match self {
            Self::Quaternion => None,
            Self::EulerLinear => Some(Curve::Linear),
            Self::EulerCubic => Some(Curve::Cubic),
        }
    }
}

/// A displacement map for a whole body (`[[layer]]` of a project).
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct Layer {
    /// Name to show.
    #[serde(deserialize_with = "read_name")]
    pub name: String,
    /// Whether it has any effect.
    #[serde(default = "default_on")]
    pub on: bool,
    /// Share of it that takes effect, 0 to 1; what is outside counts as the nearest of the two.
    #[serde(default = "default_weight", deserialize_with = "read_weight")]
    pub weight: f64,
    /// How rotations go from key to key.
    #[serde(default)]
    pub interpolation: Interpolation,
    /// Whether it is part of the motion for good: below the layers that can be edited, whatever its place in the list.
    #[serde(default, skip_serializing_if = "std::ops::Not::not")]
    pub merged: bool,
    /// Offsets of the carrier: [lateral, up, forward] of the path frame in use, the clip's unit.
    #[serde(default, skip_serializing_if = "Keys::is_empty")]
    pub position: Keys<DVec3>,
    /// Rotations Δ by joint, on the right of the joint's local rotation; names as [`super::joint_name`] has them.
    #[serde(default, skip_serializing_if = "BTreeMap::is_empty")]
    pub rotation: BTreeMap<String, Keys<DQuat>>,
}

fn default_on() -> bool {
    true
}

fn default_weight() -> f64 {
    1.0
}

fn read_name<'de, D: Deserializer<'de>>(deserializer: D) -> Result<String, D::Error> {
    let name = String::deserialize(deserializer)?;
    if name.trim().is_empty() { Err(D::Error::custom("a layer needs a name")) } else { Ok(name) }
}

fn read_weight<'de, D: Deserializer<'de>>(deserializer: D) -> Result<f64, D::Error> {
    let weight = f64::deserialize(deserializer)?;
    if (0.0..=1.0).contains(&weight) {
        return Ok(weight);
    }
    Err(D::Error::custom(format!("weight is 0 to 1, found {weight}")))
}

impl Layer {
    /// Makes a layer that changes nothing yet: on, with all of its weight.
    pub fn new(name: impl Into<String>) -> Self {
        Self {
            name: name.into(),
            on: default_on(),
            weight: default_weight(),
            interpolation: Interpolation::default(),
            merged: false,
            position: Keys::default(),
            rotation: BTreeMap::new(),
        }
    }

    /// Returns the share of it that takes effect: 0 while it is off.
    pub fn effect(&self) -> f64 {
        if self.on { self.weight.clamp(0.0, 1.0) } else { 0.0 }
    }

    /// Returns the file frames of all its keys, map by map.
    pub fn frames(&self) -> impl Iterator<Item = usize> + '_ {
        let of_rotations = self.rotation.values().flat_map(|keys| keys.iter().map(|key| key.frame));
        self.position.iter().map(|key| key.frame).chain(of_rotations)
    }

    /// Sets a rotation key; of the two quaternions of the rotation the one with w ≥ 0 is kept.
    ///
    /// # Panics
    ///
    /// When `turn` is no unit quaternion.
    pub fn set_rotation(&mut self, joint: &str, frame: usize, turn: DQuat) {
        assert!(turn.is_normalized(), "a key is a rotation");
        let turn = if turn.w < 0.0 { -turn } else { turn };
        self.rotation.entry(joint.to_owned()).or_default().set(frame, turn);
    }

    /// Takes all position keys away.
    pub fn clear_position(&mut self) {
        self.position = Keys::default();
    }

    /// Takes all rotation keys away.
    pub fn clear_rotations(&mut self) {
        self.rotation.clear();
    }
}

/// Freezes a layer, together with all that is in effect below it, and tells whether it could be.
///
/// Rotations do not commute, so a layer can only be part of the motion if what is below it is; layers below that are
/// off stay what they are and come to lie above. No pose changes. A layer that is off cannot be merged.
pub fn merge(layers: &mut [Layer], layer_idx: usize) -> bool {
    if !layers[layer_idx].on {
        return false;
    }
    let below = if layers[layer_idx].merged { 0..0 } else { 0..layer_idx + 1 };
    for layer in &mut layers[below] {
        layer.merged |= layer.on;
    }
    layers.sort_by_key(|layer| !layer.merged);
    true
}

#[cfg(test)]
mod tests {
    use super::*;

    #[derive(Serialize, Deserialize, Debug, PartialEq)]
    struct File {
        layer: Vec<Layer>,
    }

    const TEXT: &str = r#"[[layer]]
name = "wave"
on = true
weight = 0.5
interpolation = "euler_cubic"
merged = true
position = [{ frame = 3, value = [1.0, 0.25, -2.0] }, { frame = 7, value = [0, 0, 0] }]

[layer.rotation]
LeftArm = [{ frame = 3, value = [1, 0, 0, 0] }]
"Left Hand" = [{ frame = 4, value = [0, 0, 1.0, 0.0] }, { frame = 12, value = [0.6, 0.8, 0.0, 0.0] }]

[[layer]]
name = "empty"
"#;

    #[test]
    fn files_say_it_as_the_design_has_it() {
        let file: File = toml::from_str(TEXT).expect("it reads");
        let wave = &file.layer[0];
        assert_eq!(wave.interpolation, Interpolation::EulerCubic);
        assert!(wave.merged && wave.on && wave.weight == 0.5);
        assert_eq!(wave.position.get(3), Some(DVec3::new(1.0, 0.25, -2.0)));
        assert_eq!(wave.rotation["Left Hand"].get(4), Some(DQuat::from_xyzw(0.0, 1.0, 0.0, 0.0)));
        assert_eq!(file.layer[1], Layer::new("empty"));
        let written = toml::to_string(&file).expect("it writes");
        assert_eq!(toml::from_str::<File>(&written).expect("it reads again"), file);
        assert_eq!(written, toml::to_string(&file).expect("same bytes"));
    }

    #[test]
    fn what_a_file_must_not_say_is_an_error_with_words() {
        for (from, to, words) in [
            ("weight = 0.5", "weight = 1.5", "weight is 0 to 1"),
            ("frame = 12", "frame = 4", "two keys at frame 4"),
            ("[1, 0, 0, 0]", "[0, 0, 0, 0]", "expected a rotation [w, x, y, z]"),
            ("merged = true", "frozen = true", "frozen"),
            ("[0, 0, 0] }", "[0, 0] }", "expected an offset [x, y, z]"),
        ] {
            let error = toml::from_str::<File>(&TEXT.replacen(from, to, 1)).expect_err(to).to_string();
            assert!(error.contains(words), "{error}");
        }
    }

    #[test]
    fn merging_takes_along_what_is_below_and_in_effect() {
        let layer = |name: &str, on| Layer { on, ..Layer::new(name) };
        let mut layers = vec![layer("a", true), layer("b", false), layer("c", true), layer("d", true)];
        assert!(!merge(&mut layers, 1), "a layer that is off has nothing to freeze");
        assert!(merge(&mut layers, 2));
        let order: Vec<_> = layers.iter().map(|l| (l.name.as_str(), l.merged)).collect();
        assert_eq!(order, [("a", true), ("c", true), ("b", false), ("d", false)]);
        let before = layers.clone();
        assert!(merge(&mut layers, 0));
        assert_eq!(layers, before, "merging again changes nothing");
    }
}
