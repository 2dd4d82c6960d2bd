//! Files: clips and projects opened, projects and exports written all or nothing. Nothing below opens a file.

use std::{
    fs,
    io::Write as _,
    path::{Path, PathBuf},
    sync::Arc,
};

use super::{
    Edits, Source,
    project::{Project, ProjectError, check_joints, parse, print},
    source::built_in,
};
use crate::bvh::{Bvh, ParseError};

/// The file names that are opened as projects.
pub const EXTENSION: &str = "toml";

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

/// Something opened: a clip to edit, from its own file or through a project.
#[derive(Clone, Debug)]
pub struct Opened {
    /// The clip.
    pub source: Arc<Source>,
    /// The project's edits, or the defaults.
    pub edits: Edits,
    /// The project file, if that is what was opened.
    pub project: Option<PathBuf>,
    /// What deserves the user's eye.
    pub warnings: Vec<String>,
}

/// Opens a clip or a project, told apart by the file's name; none opens the built-in clip.
///
/// # Errors
///
/// When a file cannot be read or does not parse, with its place.
pub fn open(file: Option<&Path>) -> Result<Opened, OpenError> {
    let plain =
        |source| Opened { source: Arc::new(source), edits: Edits::default(), project: None, warnings: Vec::new() };
    let Some(file) = file else { return Ok(plain(built_in())) };
    if file.extension().is_none_or(|e| !e.eq_ignore_ascii_case(EXTENSION)) {
        return Ok(plain(read(file)?));
    }
    let text = read_text(file)?;
    let project = parse(&text, &file.display().to_string())?;
    let source = match &project.clip_file {
        None => built_in(),
        Some(clip) => read(&file.parent().unwrap_or(Path::new("")).join(clip))?,
    };
    let joints: Vec<&str> = source.bvh.joints().iter().map(|joint| joint.name.as_str()).collect();
    check_joints(&project, &joints, &text, &file.display().to_string())?;
    let mut warnings = Vec::new();
    if project.blake3.as_deref().is_some_and(|hash| hash != source.blake3()) {
        warnings.push(format!("{} has changed since the project was saved", source.name));
    }
    Ok(Opened { source: Arc::new(source), edits: project.edits, project: Some(file.to_owned()), warnings })
}

/// Writes the project beside its name, then renames: all or nothing.
///
/// # Errors
///
/// When the folder cannot be written.
pub(super) fn save(project: &Project, file: &Path) -> Result<(), OpenError> {
    write_file(file, print(project).as_bytes())
}

/// Writes a file beside its name, then renames it, so that nobody sees half of it.
///
/// # Errors
///
/// When the folder cannot be written.
pub fn write_file(file: &Path, bytes: &[u8]) -> Result<(), OpenError> {
    let fail = |source: std::io::Error| OpenError::Write { file: file.display().to_string(), why: source.to_string() };
    let folder = file.parent().filter(|p| !p.as_os_str().is_empty()).unwrap_or(Path::new("."));
    if !folder.is_dir() {
        let why = format!("there is no folder {}", folder.display());
        return Err(OpenError::Write { file: file.display().to_string(), why });
    }
    let mut builder = tempfile::Builder::new();
    // A temporary file is private by default; this one becomes the user's, with the mode any new file gets.
    #[cfg(unix)]
    builder.permissions(std::os::unix::fs::PermissionsExt::from_mode(0o666));
    let mut beside = builder.tempfile_in(folder).map_err(fail)?;
    beside.write_all(bytes).map_err(fail)?;
    beside.as_file().sync_all().map_err(fail)?;
    if let Ok(old) = fs::metadata(file) {
        beside.as_file().set_permissions(old.permissions()).map_err(fail)?;
    }
    beside.persist(file).map_err(|e| fail(e.error))?;
    Ok(())
}

/// Reads a BVH file.
///
/// # Errors
///
/// When the file cannot be read or is no BVH.
fn read(file: &Path) -> Result<Source, OpenError> {
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
fn read_text(file: &Path) -> Result<String, OpenError> {
    fs::read_to_string(file).map_err(|e| OpenError::Read { file: file.display().to_string(), why: e.to_string() })
}
