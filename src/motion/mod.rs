//! Clips: a skeleton and its poses in y-up world space; conversion from and to BVH.
//!
//! Angles are degrees and axes the file's own only in the conversions here; what comes out is y-up, in radians and in
//! the clip's length unit. A clip never changes: an [`EditedClip`] says how it is to be shown instead.

mod angles;
mod channels;
mod clip;
mod edited;
mod euler;
mod facts;
mod from_bvh;
pub mod gait;
mod kinematics;
pub mod legs;
mod options;
mod poses;
mod still;
mod to_bvh;
mod tracks;

pub use angles::RotationOrder;
pub use channels::local_rotations;
pub use clip::{CarrierRelative, Clip, carrier_relative};
pub use edited::{EditedClip, TurnedJoint};
pub use facts::{Decided, Facts};
pub use legs::{Leg, LegNames, Side, find_legs};
pub use options::{ClipOptions, OffsetMeaning, UpAxis};
pub use still::{DEFAULT_LENGTH, Length, MAX_LENGTH};
pub use to_bvh::{n_written_frames, to_bvh};
pub use tracks::{PointTracks, Track};
