//! `Source` and `Solved`: what goes into the solve and what comes out.

use std::sync::Arc;

use super::Edits;
use crate::{
    bvh::Bvh,
    motion::{Clip, EditedClip},
    path::{NewPath, OriginalPath},
};

/// A clip as loaded; never changes.
#[derive(Debug)]
pub struct Source {
    /// Name to show, usually the file's.
    pub name: String,
    /// The file as it is.
    pub bvh: Bvh,
}

/// Everything that follows from a source and edits; stages that did not change are shared with the previous solve.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The source.
    pub source: Arc<Source>,
    /// The edits.
    pub edits: Arc<Edits>,
    /// The source as a clip.
    pub clip: Arc<Clip>,
    /// Original path, its frames, residuals and arc length.
    pub original: Arc<OriginalPath>,
    /// The new path.
    pub new_path: Arc<NewPath>,
    /// The edited clip.
    pub edited: Arc<EditedClip>,
    /// What could not be done as wished, one line each; also the clip's own warnings.
    pub warnings: Vec<String>,
}
