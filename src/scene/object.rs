//! What a view can show or leave out: the drawn objects as users name them, and sets of them.

use serde::{Deserialize, Serialize};

use super::Role;

/// A drawn object: all that one `show.*` switches on or off. Several roles can be one object.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Object {
    /// The actor as captured.
    OriginalSkeleton,
    /// The actor on the new path.
    NewSkeleton,
    /// The path fitted to the clip.
    OriginalPath,
    /// The new path, with the stretches that ask too much.
    NewPath,
    /// The control points and the polygon through them.
    ControlPoints,
    /// The block that walks the original path.
    OriginalTracker,
    /// The block that walks the new path.
    NewTracker,
    /// The ground and its grid.
    Ground,
    /// Where the feet stand.
    Footprints,
    /// The trails.
    Traces,
    /// All texts with a place in the world, whatever else they belong to.
    Labels,
    /// Bodies drawn as edges: in a view that leaves it out a [wireframe](super::Body::wireframe) body is solid.
    Wireframe,
    /// The actor with all rotations zero.
    NormalSkeleton,
}

impl Object {
    /// All of them, in the order of their bits.
    const EVERY: [Self; 13] = [
        Self::OriginalSkeleton,
        Self::NewSkeleton,
        Self::OriginalPath,
        Self::NewPath,
        Self::ControlPoints,
        Self::OriginalTracker,
        Self::NewTracker,
        Self::Ground,
        Self::Footprints,
        Self::Traces,
        Self::Labels,
        Self::Wireframe,
        Self::NormalSkeleton,
    ];

    fn bit(self) -> u32 {
        1 << self as u32
    }
}

impl Role {
    /// Returns the object that things of this role belong to.
    pub fn object(self) -> Object {
        match self {
            Self::OriginalSkeleton => Object::OriginalSkeleton,
            // Joints are selected on the new actor.
            Self::NewSkeleton | Self::SelectedJoint | Self::ActiveJoint => Object::NewSkeleton,
            Self::NormalSkeleton => Object::NormalSkeleton,
            Self::OriginalPath => Object::OriginalPath,
            Self::NewPath | Self::Strain => Object::NewPath,
            Self::ControlPoint | Self::SelectedControlPoint => Object::ControlPoints,
            Self::OriginalTracker => Object::OriginalTracker,
            Self::NewTracker => Object::NewTracker,
            Self::Trace => Object::Traces,
            Self::Footprint | Self::MissedFootprint => Object::Footprints,
            Self::Ground => Object::Ground,
        }
    }
}

/// A set of objects, one bit each.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Objects(u32);

impl Objects {
    /// No object.
    pub const NONE: Self = Self(0);
    /// Every object.
    pub const ALL: Self = Self((1 << Object::EVERY.len()) - 1);

    /// Makes a set of its bits as they come from elsewhere; bits of no object are kept and mean nothing.
    pub const fn from_bits(bits: u32) -> Self {
        Self(bits)
    }

    /// Tells whether an object is in the set.
    pub const fn contains(self, object: Object) -> bool {
        self.0 & (1 << object as u32) != 0
    }

    /// Tells whether the set has bits of no object.
    pub const fn has_unknown(self) -> bool {
        self.0 & !Self::ALL.0 != 0
    }

    /// Returns the set with an object.
    #[must_use]
    pub fn with(self, object: Object) -> Self {
        Self(self.0 | object.bit())
    }

    /// Returns the set without an object.
    #[must_use]
    pub fn without(self, object: Object) -> Self {
        Self(self.0 & !object.bit())
    }

    /// Returns what is in both sets.
    #[must_use]
    pub fn and(self, other: Self) -> Self {
        Self(self.0 & other.0)
    }
}

impl FromIterator<Object> for Objects {
    fn from_iter<T: IntoIterator<Item = Object>>(objects: T) -> Self {
        objects.into_iter().fold(Self::NONE, Self::with)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_object_has_a_bit_of_its_own() {
        assert_eq!(Object::EVERY.into_iter().collect::<Objects>(), Objects::ALL);
        for object in Object::EVERY {
            assert!(Objects::NONE.with(object).contains(object) && !Objects::ALL.without(object).contains(object));
            for other in Object::EVERY.into_iter().filter(|other| *other != object) {
                assert!(!Objects::NONE.with(object).contains(other), "{object:?} and {other:?}");
            }
        }
    }

    #[test]
    fn bits_of_no_object_are_noticed() {
        assert!(!Objects::ALL.has_unknown());
        assert!(Objects::from_bits(1 << Object::EVERY.len()).has_unknown());
    }
}
