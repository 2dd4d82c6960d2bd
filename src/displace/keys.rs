//! The keys of one map: values at file frames, sorted, one to a frame.
//!
//! In project files a map is a list of `{ frame, value }`; a rotation's value is `[w, x, y, z]`.

use std::{fmt, marker::PhantomData, ops::Range};

use glam::{DQuat, DVec3};
use serde::{
    Deserialize, Deserializer, Serialize, Serializer,
    de::{DeserializeSeed, Error as _, MapAccess, SeqAccess, Visitor, value::MapAccessDeserializer},
};

/// A quaternion whose squared length is this near to 1 is left as it is, so that what is read is what was written.
const UNIT: f64 = 1e-12;

/// A value at a frame.
#[derive(Clone, Copy, Debug, PartialEq, Serialize)]
pub struct Key<T> {
    /// Frame of the file, rest frames counted.
    pub frame: usize,
    /// The map's value there.
    pub value: T,
}

/// What a map can hold, and how files write it.
pub trait MapValue: Copy {
    /// What files write, for people.
    const WORDS: &'static str;
    /// The numbers in a file.
    type Numbers: Serialize;
    /// Returns the numbers to write.
    fn numbers(self) -> Self::Numbers;
    /// Reads numbers; none when they are no such value.
    fn from_numbers(numbers: &[f64]) -> Option<Self>;
}

impl MapValue for DVec3 {
    const WORDS: &'static str = "an offset [x, y, z]";
    type Numbers = [f64; 3];

    fn numbers(self) -> [f64; 3] {
        // Adding 0 takes the sign off a zero.
        self.to_array().map(|n| n + 0.0)
    }

    fn from_numbers(numbers: &[f64]) -> Option<Self> {
        Some(Self::from_array(numbers.try_into().ok()?)).filter(|v| v.is_finite())
    }
}

impl MapValue for DQuat {
    const WORDS: &'static str = "a rotation [w, x, y, z], not all of them zero";
    type Numbers = [f64; 4];

    fn numbers(self) -> [f64; 4] {
        [self.w, self.x, self.y, self.z].map(|n| n + 0.0)
    }

    fn from_numbers(numbers: &[f64]) -> Option<Self> {
        let [w, x, y, z] = numbers.try_into().ok()?;
        let q = Self::from_xyzw(x, y, z, w);
        let length_squared = q.length_squared();
        let is_rotation = length_squared.is_finite() && length_squared > 0.0;
        let is_unit = (length_squared - 1.0).abs() <= UNIT;
        is_rotation.then(|| if is_unit { q } else { q.normalize() })
    }
}

/// The keys of one map, sorted by frame, at most one to a frame.
#[derive(Clone, Debug, PartialEq)]
pub struct Keys<T> {
    /// Invariant: frames rise.
    keys: Vec<Key<T>>,
}

impl<T> Default for Keys<T> {
    fn default() -> Self {
        Self { keys: Vec::new() }
    }
}

impl<T> std::ops::Deref for Keys<T> {
    type Target = [Key<T>];

    fn deref(&self) -> &[Key<T>] {
        &self.keys
    }
}

impl<T: Copy> Keys<T> {
    /// Returns the value of the key at a frame, if there is one.
    pub fn get(&self, frame: usize) -> Option<T> {
        self.place(frame).ok().map(|at| self.keys[at].value)
    }

    /// Sets the key at a frame, in the place of one that is there.
    pub fn set(&mut self, frame: usize, value: T) {
        match self.place(frame) {
            Ok(at) => self.keys[at].value = value,
            Err(at) => self.keys.insert(at, Key { frame, value }),
        }
    }

    /// Takes the key at a frame away and returns its value.
    pub fn remove(&mut self, frame: usize) -> Option<T> {
        self.place(frame).ok().map(|at| self.keys.remove(at).value)
    }

    /// Tells whether there is no key.
    pub fn is_empty(&self) -> bool {
        self.keys.is_empty()
    }

    fn place(&self, frame: usize) -> Result<usize, usize> {
        self.keys.binary_search_by_key(&frame, |key| key.frame)
    }
}

impl<T: Copy> FromIterator<(usize, T)> for Keys<T> {
    /// Of two values for one frame the later one counts.
    fn from_iter<I: IntoIterator<Item = (usize, T)>>(keys: I) -> Self {
        let mut made = Self::default();
        keys.into_iter().for_each(|(frame, value)| made.set(frame, value));
        made
    }
}

impl<T: MapValue> Serialize for Keys<T> {
    fn serialize<S: Serializer>(&self, serializer: S) -> Result<S::Ok, S::Error> {
        serializer.collect_seq(self.keys.iter().map(|key| Key { frame: key.frame, value: key.value.numbers() }))
    }
}

impl<'de, T: MapValue> Deserialize<'de> for Keys<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        deserializer.deserialize_seq(List(PhantomData))
    }
}

/// Reads a list of keys. What is wrong is found where it stands, so that an error can name its place.
struct List<T>(PhantomData<T>);

impl<'de, T: MapValue> Visitor<'de> for List<T> {
    type Value = Keys<T>;

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a list of keys { frame, value }")
    }

    fn visit_seq<A: SeqAccess<'de>>(self, mut items: A) -> Result<Keys<T>, A::Error> {
        let mut keys = Keys::default();
        while items.next_element_seed(Next(&mut keys))?.is_some() {}
        Ok(keys)
    }
}

/// Reads one key more.
struct Next<'a, T>(&'a mut Keys<T>);

impl<'de, T: MapValue> DeserializeSeed<'de> for Next<'_, T> {
    type Value = ();

    fn deserialize<D: Deserializer<'de>>(self, deserializer: D) -> Result<(), D::Error> {
        deserializer.deserialize_map(self)
    }
}

impl<'de, T: MapValue> Visitor<'de> for Next<'_, T> {
    type Value = ();

    fn expecting(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str("a key { frame, value }")
    }

    fn visit_map<A: MapAccess<'de>>(self, map: A) -> Result<(), A::Error> {
        let Written { frame, value: Wanted(value) } = Written::deserialize(MapAccessDeserializer::new(map))?;
        if self.0.get(frame).is_some() {
            return Err(A::Error::custom(format!("two keys at frame {frame}")));
        }
        self.0.set(frame, value);
        Ok(())
    }
}

/// A key as files have it.
#[derive(Deserialize)]
#[serde(deny_unknown_fields, bound = "T: MapValue")]
struct Written<T> {
    frame: usize,
    value: Wanted<T>,
}

struct Wanted<T>(T);

impl<'de, T: MapValue> Deserialize<'de> for Wanted<T> {
    fn deserialize<D: Deserializer<'de>>(deserializer: D) -> Result<Self, D::Error> {
        let numbers = Vec::<f64>::deserialize(deserializer)?;
        let value = T::from_numbers(&numbers);
        value.map(Self).ok_or_else(|| D::Error::custom(format!("expected {}, found {numbers:?}", T::WORDS)))
    }
}

/// What a map does over a run of frames.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) enum Piece {
    /// Holds the value of this key: before the first key and from the last one on.
    Constant(usize),
    /// Goes from this key to the next.
    Between(usize),
}

/// Divides frames of the file into the pieces of a map that has keys.
pub(super) fn pieces<T>(keys: &[Key<T>], frames: Range<usize>) -> impl Iterator<Item = (Piece, Range<usize>)> + '_ {
    let last = keys.len() - 1;
    let before = std::iter::once((Piece::Constant(0), 0..keys[0].frame));
    let between = (0..last).map(|i| (Piece::Between(i), keys[i].frame..keys[i + 1].frame));
    let after = std::iter::once((Piece::Constant(last), keys[last].frame..usize::MAX));
    before.chain(between).chain(after).filter_map(move |(piece, run)| {
        let run = run.start.max(frames.start)..run.end.min(frames.end);
        (!run.is_empty()).then_some((piece, run))
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_are_sorted_and_one_to_a_frame() {
        let mut keys: Keys<DVec3> = [(9, DVec3::X), (2, DVec3::Y), (9, DVec3::Z)].into_iter().collect();
        assert_eq!(keys.iter().map(|k| k.frame).collect::<Vec<_>>(), [2, 9]);
        assert_eq!(keys.get(9), Some(DVec3::Z));
        assert_eq!((keys.remove(2), keys.remove(2), keys.len()), (Some(DVec3::Y), None, 1));
    }

    #[test]
    fn pieces_cover_the_frames_once() {
        let keys: Keys<DVec3> = [(3, DVec3::X), (4, DVec3::Y), (8, DVec3::Z)].into_iter().collect();
        let of = |frames| pieces(&keys, frames).collect::<Vec<_>>();
        use Piece::{Between, Constant};
        assert_eq!(of(1..10), [(Constant(0), 1..3), (Between(0), 3..4), (Between(1), 4..8), (Constant(2), 8..10)]);
        assert_eq!(of(5..7), [(Between(1), 5..7)]);
        assert_eq!(of(0..2), [(Constant(0), 0..2)]);
        assert_eq!(of(20..21), [(Constant(2), 20..21)]);
    }

    #[test]
    fn numbers_that_are_no_rotation_are_refused_and_others_keep_their_bits() {
        assert_eq!(DQuat::from_numbers(&[0.0; 4]), None);
        assert_eq!(DQuat::from_numbers(&[1.0; 5]), None);
        assert_eq!(DQuat::from_numbers(&[f64::NAN, 0.0, 0.0, 1.0]), None);
        assert_eq!(DVec3::from_numbers(&[f64::INFINITY, 0.0, 0.0]), None);
        assert_eq!(DVec3::from_numbers(&[1.0; 2]), None);
        assert_eq!(DQuat::from_numbers(&[2.0, 0.0, 0.0, 0.0]), Some(DQuat::IDENTITY));
        let q = DQuat::from_euler(glam::EulerRot::XYZ, 0.1, 0.7, -2.0);
        assert_eq!(DQuat::from_numbers(&q.numbers()), Some(q));
    }
}
