//! Rotation keys as offsets of the joint's own rotation channels.
//!
//! A key is a rotation Δ. In the Euler modes it becomes the channel-wise differences that give the same pose at the
//! key, on the branch nearest the base's angles there; those differences are interpolated and added to the base's
//! angles. So every mode passes through the same poses at the keys.

use glam::{DQuat, DVec3};

use super::keys::Key;
use crate::motion::RotationOrder;

/// Returns the channel offset, degrees, that turns `base` by `turn`; exactly 0 for no turn.
pub(super) fn offset(order: RotationOrder, base_degrees: [f64; 3], base: DQuat, turn: DQuat) -> DVec3 {
    if turn.xyz() == DVec3::ZERO {
        return DVec3::ZERO;
    }
    DVec3::from_array(order.nearest_degrees(base * turn, base_degrees)) - DVec3::from_array(base_degrees)
}

/// Returns the angles with a share of an offset added.
pub(super) fn added(degrees: [f64; 3], offset: DVec3, share: f64) -> [f64; 3] {
    (DVec3::from_array(degrees) + share * offset).to_array()
}

/// Turns rotation keys into channel offsets, degrees; `base` gives angles and rotation of the joint at a file frame.
pub(super) fn offsets(
    order: RotationOrder,
    keys: &[Key<DQuat>],
    base: impl Fn(usize) -> ([f64; 3], DQuat),
) -> Vec<Key<DVec3>> {
    let of = |key: &Key<DQuat>| {
        let (degrees, rotation) = base(key.frame);
        Key { frame: key.frame, value: offset(order, degrees, rotation, key.value) }
    };
    keys.iter().map(of).collect()
}
