//! Headless runs: every `walkabout` command that ends by itself.
//!
//! Results go to stdout or to the file named by `-o`, messages to stderr. Exit status: 0 done, 1 the file is bad or
//! the work failed, 2 wrong usage.

mod args;
mod doctor;
mod export;
mod info;
mod limits;
mod maps;
mod measure;
mod render;
mod tables;

use std::{
    fmt,
    io::{self, Write as _},
    path::Path,
    process::ExitCode,
};

pub use args::{Args, Clip, Verb};

use crate::document::{self, Change, ChangeError, Document, OpenError};

/// A headless run that failed.
#[derive(Debug, thiserror::Error)]
pub enum Failure {
    /// A file could not be opened or written.
    #[error(transparent)]
    Open(#[from] OpenError),
    /// A `--set` or `--shape` that cannot be made.
    #[error(transparent)]
    Change(#[from] ChangeError),
    /// Words that the command line does not take.
    #[error("{0}")]
    Usage(String),
    /// The output file exists.
    #[error("{0} exists; --force replaces it")]
    Exists(String),
    /// The picture could not be made.
    #[error(transparent)]
    Gpu(#[from] crate::viewport::GpuError),
    /// A quality number is beyond its `--fail` limit.
    #[error("{0}")]
    Limit(String),
    /// The output could not be written.
    #[error("cannot write the output: {0}")]
    Output(#[from] io::Error),
}

impl Failure {
    /// Returns the exit status.
    fn status(&self) -> u8 {
        match self {
            Self::Usage(_) | Self::Change(ChangeError::Parameter(_)) => 2,
            _ => 1,
        }
    }
}

/// Runs a command and returns the exit status.
pub fn run(verb: &Verb) -> ExitCode {
    let result = match verb {
        Verb::Info { clip, json } => info::run(clip, *json),
        Verb::Export { clip, output, interpolated } => export::run(clip, output, *interpolated),
        Verb::Render { clip, output, picture } => render::run(clip, output, picture),
        Verb::Maps { clip, joint, position, json } => maps::run(clip, joint, *position, *json),
        Verb::Measure { clip, json, fail } => measure::run(clip, *json, fail),
        Verb::Doctor => doctor::run(),
        Verb::Params => print(&tables::params()),
        Verb::Keys => print(&tables::keys()),
        Verb::Preview { .. } => unreachable!("main starts previews"),
    };
    finish(result)
}

/// Turns a result into an exit status; a failure is told on stderr.
pub fn finish(result: Result<(), Failure>) -> ExitCode {
    match result {
        Ok(()) => ExitCode::SUCCESS,
        // A reader that has seen enough is no failure.
        Err(Failure::Output(error)) if error.kind() == io::ErrorKind::BrokenPipe => ExitCode::SUCCESS,
        Err(failure) => {
            eprintln!("walkabout: {failure}");
            ExitCode::from(failure.status())
        }
    }
}

/// Opens a clip or project and applies `--set` and `--shape` as one edit; returns what deserves the user's eye too.
///
/// # Errors
///
/// When the file does not open or the edit cannot be made.
pub fn open(clip: &Clip) -> Result<(Document, Vec<String>), Failure> {
    let change = change(clip)?;
    let opened = document::open(clip.file.as_deref())?;
    let mut warnings = opened.warnings.clone();
    let mut document = Document::new(opened);
    if let Some(change) = change {
        warnings.extend(document.apply(&change, false)?);
    }
    Ok((document, warnings))
}

/// Opens as [`open`] does and tells the warnings on stderr.
fn open_loudly(clip: &Clip) -> Result<Document, Failure> {
    let (document, warnings) = open(clip)?;
    let solved = document.solved();
    for warning in warnings.into_iter().chain(solved.warnings.iter().cloned()).chain(solved.missed_plants()) {
        eprintln!("walkabout: warning: {warning}");
    }
    Ok(document)
}

/// Reads `--set` and `--shape` as one change, none if neither was given.
///
/// # Errors
///
/// When a `--set` is not `NAME=VALUE`.
fn change(clip: &Clip) -> Result<Option<Change>, Failure> {
    let values: Result<Vec<_>, _> = clip.set.iter().map(|text| document::parse_assignment(text)).collect();
    let values = values.map_err(Failure::Usage)?;
    Ok((!values.is_empty() || clip.shape.is_some()).then_some(Change::Set { values, shape: clip.shape }))
}

/// Refuses to overwrite a file that is not to be forced.
fn check_free(output: &Path, force: bool) -> Result<(), Failure> {
    if output.exists() && !force { Err(Failure::Exists(output.display().to_string())) } else { Ok(()) }
}

/// Prints to stdout.
fn print(text: &impl fmt::Display) -> Result<(), Failure> {
    let mut out = io::stdout().lock();
    write!(out, "{text}")?;
    out.flush()?;
    Ok(())
}

/// Prints a value as JSON with a final newline.
fn print_json(value: &impl serde::Serialize) -> Result<(), Failure> {
    let text = serde_json::to_string_pretty(value).expect("reports have only text keys");
    print(&format!("{text}\n"))
}
