//! The document: a source, the user's edits with their history, and what follows from them.

mod edits;
mod solve;
mod solved;

pub use crate::path::Cycling;
pub use edits::{ClipEdits, Edits, HeadingEdits, OriginalEdits, PathEdits, ResidualEdits, TimingEdits};
pub use solve::solve;
pub use solved::{Solved, Source};
