//! `cargo xtask run`: from a bare machine to an open editor.
//!
//! Whatever could not be installed, walkabout is built and started: without a display or a Vulkan driver the editor
//! works and says what would bring the window.

use std::process::{Command, ExitCode};

use crate::{
    cargo::{cargo, workspace},
    needs::Purpose,
    setup::{self, Consent},
};

/// What stands between `run` and walkabout's own arguments.
#[derive(Debug, Default, PartialEq, Eq)]
struct Options<'a> {
    yes: bool,
    debug: bool,
    /// For walkabout.
    rest: &'a [String],
}

/// Installs what is missing if it may, then becomes walkabout.
pub(crate) fn run(args: &[String]) -> ExitCode {
    let options = parse(args);
    setup::set_up(Purpose::Run, Consent::given(options.yes));
    let mut command = cargo();
    command.args(["run", "--package", "walkabout", "--bin", "walkabout", "--manifest-path"]);
    command.arg(workspace().join("Cargo.toml"));
    if !options.debug {
        command.arg("--release");
    }
    command.arg("--").args(options.rest);
    replace_self_with(command)
}

/// Reads our own options, which come first; the first word that is not one begins walkabout's arguments.
fn parse(args: &[String]) -> Options<'_> {
    let mut options = Options { rest: args, ..Options::default() };
    while let Some((first, rest)) = options.rest.split_first() {
        match first.as_str() {
            "--yes" => options.yes = true,
            "--debug" => options.debug = true,
            "--" => return Options { rest, ..options },
            _ => return options,
        }
        options.rest = rest;
    }
    options
}

/// Becomes the command, so that job control and signals reach the editor with nobody between.
#[cfg(unix)]
fn replace_self_with(mut command: Command) -> ExitCode {
    use std::os::unix::process::CommandExt;
    let error = command.exec();
    eprintln!("could not start {}: {error}", command.get_program().display());
    ExitCode::FAILURE
}

/// Runs the command and waits for it; this system cannot replace a process.
#[cfg(not(unix))]
fn replace_self_with(mut command: Command) -> ExitCode {
    crate::cargo::exit(crate::cargo::succeeds(&mut command))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks how a command line is split: yes, debug, what walkabout gets.
    #[track_caller]
    fn check(line: &str, yes: bool, debug: bool, rest: &str) {
        let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
        let args = words(line);
        assert_eq!(parse(&args), Options { yes, debug, rest: &words(rest) }, "{line}");
    }

    #[test]
    fn own_options_come_first_and_the_rest_is_walkabouts() {
        check("", false, false, "");
        check("clip.bvh", false, false, "clip.bvh");
        check("--yes --debug clip.bvh", true, true, "clip.bvh");
        check("--debug info clip.bvh --json", false, true, "info clip.bvh --json");
        check("--yes -- --help", true, false, "--help");
        check("clip.bvh --yes", false, false, "clip.bvh --yes");
        check("--help", false, false, "--help");
    }
}
