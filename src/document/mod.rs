//! The document: a source, the user's edits with their history, and what follows from them.
//!
//! A [`Change`] makes the next [`Edits`], [`solve`] makes [`Solved`] of them; nothing else does. [`PARAMETERS`] is
//! the single source of names for panels, help, `--set` and project files.

mod change;
mod edits;
mod history;
mod parameter;
mod project;
mod solve;
mod solved;
mod source;

use std::{path::Path, path::PathBuf, sync::Arc};

pub use crate::path::Cycling;
pub use change::{Change, ChangeError};
pub use edits::{
    CameraEdits, ClipEdits, Edits, HeadingEdits, OriginalEdits, PathEdits, ProjectionKind, ResidualEdits, Show,
    TimingEdits, ViewEdits,
};
pub use history::History;
pub use parameter::{Kind, MAX_POINTS, PARAMETERS, Parameter, SetError, Step, parameter, parse_assignment, show_value};
pub use project::{EXTENSION, FORMAT, Opened, Problem, Project, ProjectError, open, write_file};
pub use solve::solve;
pub use solved::{Solved, Source};
pub use source::{BUILT_IN, OpenError, built_in};

/// A source being edited: its history and its newest result.
#[derive(Clone, Debug)]
pub struct Document {
    history: History,
    solved: Arc<Solved>,
    /// The edits as last saved or opened.
    saved: Arc<Edits>,
    project: Option<PathBuf>,
}

impl Document {
    /// Begins editing what was opened.
    pub fn new(opened: Opened) -> Self {
        let history = History::new(opened.edits);
        let edits = Arc::clone(history.edits());
        let solved = Arc::new(solve(&opened.source, &edits, None));
        Self { history, solved, saved: edits, project: opened.project }
    }

    /// Returns the edits in use.
    pub fn edits(&self) -> &Arc<Edits> {
        self.history.edits()
    }

    /// Returns what follows from the edits in use.
    pub fn solved(&self) -> &Arc<Solved> {
        &self.solved
    }

    /// Returns how many steps can be undone and redone.
    pub fn depth(&self) -> (usize, usize) {
        self.history.depth()
    }

    /// Returns the project file, if there is one yet.
    pub fn project(&self) -> Option<&Path> {
        self.project.as_deref()
    }

    /// Tells whether there are edits that no project file has.
    pub fn is_modified(&self) -> bool {
        *self.saved != **self.edits()
    }

    /// Makes a change and solves; with `joins` it is one step with the one before. Returns warnings of the change.
    ///
    /// # Errors
    ///
    /// When the change cannot be made; then nothing has changed.
    pub fn apply(&mut self, change: &Change, joins: bool) -> Result<Vec<String>, ChangeError> {
        let (edits, warnings) = change::next(&self.solved, change)?;
        self.history.push(edits, joins);
        self.resolve();
        Ok(warnings)
    }

    /// Goes back one step; false at the first.
    pub fn undo(&mut self) -> bool {
        let moved = self.history.undo();
        self.resolve();
        moved
    }

    /// Goes forward one step; false at the last.
    pub fn redo(&mut self) -> bool {
        let moved = self.history.redo();
        self.resolve();
        moved
    }

    /// Saves the project to a file, which becomes this document's.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn save(&mut self, file: &Path) -> Result<(), OpenError> {
        let source = &self.solved.source;
        let project = Project {
            clip_file: source.file.as_ref().map(|clip| project::clip_reference(file, clip)),
            blake3: source.file.as_ref().map(|_| source.blake3()),
            edits: (**self.edits()).clone(),
        };
        project::save(&project, file)?;
        self.saved = Arc::clone(self.edits());
        self.project = Some(file.to_owned());
        Ok(())
    }

    /// Writes the edited clip to a BVH file.
    ///
    /// # Errors
    ///
    /// When the file cannot be written.
    pub fn export(&self, file: &Path) -> Result<(), OpenError> {
        write_file(file, &self.solved.to_bvh())
    }

    fn resolve(&mut self) {
        if !Arc::ptr_eq(&self.solved.edits, self.history.edits()) {
            self.solved = Arc::new(solve(&self.solved.source, self.history.edits(), Some(&self.solved)));
        }
    }
}
