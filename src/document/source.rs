//! `Source`: a clip as loaded, from a file or from the program itself.

use std::{fs, path::Path};

use super::{Source, project::ProjectError};
use crate::{
    bvh::{Bvh, ParseError},
    motion::gait,
};

/// The name the built-in clip goes by.
pub const BUILT_IN: &str = "built-in walk";

/// A file that could not be opened or written.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum OpenError {
    /// The file cannot be read.
    #[error("{file}: {why}")]
    Read {
        /// The file.
        file: String,
        /// The system's words.
        why: String,
    },
    /// The file cannot be written.
    #[error("{file}: cannot be written: {why}")]
    Write {
        /// The file.
        file: String,
        /// The system's words.
        why: String,
    },
    /// The file is no BVH.
    #[error(transparent)]
    Bvh(#[from] ParseError),
    /// The file is no project.
    #[error(transparent)]
    Project(#[from] ProjectError),
}

/// Reads a BVH file.
///
/// # Errors
///
/// When the file cannot be read or is no BVH.
pub(super) fn read(file: &Path) -> Result<Source, OpenError> {
    let shown = file.display().to_string();
    let bytes = fs::read(file).map_err(|e| OpenError::Read { file: shown.clone(), why: e.to_string() })?;
    let bvh = Bvh::parse(bytes, &shown)?;
    let name = file.file_name().map_or(shown, |n| n.to_string_lossy().into_owned());
    Ok(Source { name, file: Some(file.to_owned()), bvh })
}

/// Reads a text file.
///
/// # Errors
///
/// When the file cannot be read or is not UTF-8.
pub(super) fn read_text(file: &Path) -> Result<String, OpenError> {
    fs::read_to_string(file).map_err(|e| OpenError::Read { file: file.display().to_string(), why: e.to_string() })
}

/// Returns the built-in clip.
pub fn built_in() -> Source {
    let (text, _) = gait::built_in();
    let bvh = Bvh::parse(text.into_bytes(), BUILT_IN).expect("the built-in clip is a valid file");
    Source { name: BUILT_IN.to_owned(), file: None, bvh }
}

impl Source {
    /// Returns the hash of the file's bytes, as project files keep it.
    pub fn blake3(&self) -> String {
        blake3::hash(self.bvh.text()).to_hex().to_string()
    }
}
