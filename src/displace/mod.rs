//! Displacement maps: keyed offsets on top of a clip, so that all of the capture's detail stays (METHOD 8).
//!
//! A [`Layer`] holds keys: position offsets of the carrier and, joint by joint, rotations Δ with
//! `edited(f) = source(f) · Δ(f)`. A [`Stack`] lays layers on a clip: [`Stack::displaced`] gives what turns and moves
//! at every frame, and its other methods turn a wanted pose into keys. [`ik`] finds such poses. Nothing here knows of
//! paths: position offsets are in the axes of whatever frame the caller carries the clip with.
//!
//! ```text
//! clip ─▶ merged layers ─▶ layer 1 ─▶ layer 2 … ─▶ Displaced { turned, carrier turns, offsets }
//! ```
//!
//! Keys sit at file frames, rest frames counted; everything else counts the clip's frames.

mod between;
mod edit;
mod euler;
pub mod ik;
mod keys;
mod layer;
mod names;
#[cfg(test)]
mod sample;
mod selection;
mod slerp;
mod spline;
mod stack;
mod track;

pub use between::{InterpolationKeys, interpolated_joints, interpolated_motions};
pub use keys::{Key, Keys, MapValue};
pub use layer::{Interpolation, Layer, merge};
pub use names::{find_joint, joint_name};
pub use selection::{MapPoint, PointValue, Selection};
pub use stack::{Displaced, Stack, can_turn};

use spline::Curve;
