//! Foot plants carried rigidly along a bent path (METHOD 6, steps 2 to 5).
//!
//! Plain path editing turns and moves the whole body frame by frame, so planted feet slide. Here each plant gets *one*
//! rigid motion: the foot is carried as one piece, with the performer's own heel strike, roll and toe-off in it. The
//! legs follow by two-bone IK; where they would become too long or their knees would turn otherwise than the
//! performer's, the carrier gives way by a smooth offset, and a plant that even then could not be reached stands a
//! little elsewhere. On a level path feet stand as high as they stood: what the fitted path rises and falls with the body
//! is given back first.
//!
//! ```text
//! clip, legs, plants ─▶ Prepared ─┐
//! plain path edit ─▶ Job ─▶ level ┴▶ targets of the feet ─▶ offset of the carrier ─▶ two-bone IK ─▶ Held
//! ```
//!
//! [`Prepared`] holds what follows from the source alone; [`hold()`] is made to run on every key press.

mod banded;
mod bend;
mod cost;
mod feet;
mod give;
mod hold;
mod level;
mod offset;
mod passage;
mod prepared;
mod slide;

pub use bend::HeldFoot;
pub use hold::{Footprint, Ground, Held, Job, Missed, hold};
pub use offset::knot_frames;
pub use prepared::Prepared;
