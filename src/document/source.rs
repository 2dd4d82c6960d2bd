//! The clip that comes with the program, and how projects tell that a clip has changed.

use super::Source;
use crate::{bvh::Bvh, motion::gait};

/// The name the built-in clip goes by.
pub const BUILT_IN: &str = "built-in walk";

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
