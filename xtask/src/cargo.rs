//! Calling cargo again, from within cargo.

use std::{
    env,
    path::PathBuf,
    process::{Command, ExitCode},
};

/// Returns the folder of the workspace.
///
/// # Panics
///
/// When the program was not started by `cargo xtask`, which says where this package lies.
pub(crate) fn workspace() -> PathBuf {
    let package = env::var_os("CARGO_MANIFEST_DIR").expect("started as `cargo xtask`");
    let mut folder = PathBuf::from(package);
    folder.pop();
    folder
}

/// Returns the cargo that started this program, about to work in the current folder.
pub(crate) fn cargo() -> Command {
    Command::new(env::var_os("CARGO").unwrap_or_else(|| "cargo".into()))
}

/// Returns the cargo that started this program, about to work in the workspace's folder.
pub(crate) fn cargo_in_workspace() -> Command {
    let mut command = cargo();
    command.current_dir(workspace());
    command
}

/// Runs a command to its end. False when it failed or could not be started, which is then said.
pub(crate) fn succeeds(command: &mut Command) -> bool {
    match command.status() {
        Ok(status) => status.success(),
        Err(error) => {
            eprintln!("could not start {}: {error}", command.get_program().display());
            false
        }
    }
}

/// Turns success into exit status 0 and failure into 1.
pub(crate) fn exit(success: bool) -> ExitCode {
    if success { ExitCode::SUCCESS } else { ExitCode::FAILURE }
}
