//! The document: a source, the user's edits with their history, and what follows from them.

mod edits;
mod solved;

pub use edits::{ClipEdits, Edits, HeadingEdits, OriginalEdits, PathEdits, ResidualEdits, TimingEdits};
pub use solved::{Solved, Source};
