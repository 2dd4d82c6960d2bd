//! `cargo xtask bless`: what the tests compare against is written anew, to be looked at and committed.

use std::process::ExitCode;

use crate::{
    cargo::{exit, succeeds},
    test::cargo_test,
};

/// The tests that keep golden files, by target name.
const KEEP_GOLDENS: &[&str] = &["pictures", "screens"];

/// Runs the tests named, or all that keep golden files, with `WALKABOUT_BLESS=1`, which makes them write.
pub(crate) fn bless(names: &[String]) -> ExitCode {
    let mut command = cargo_test();
    command.args(["--package", "walkabout"]).env("WALKABOUT_BLESS", "1");
    if names.is_empty() {
        command.args(KEEP_GOLDENS.iter().flat_map(|name| ["--test", name]));
    } else {
        command.args(names.iter().flat_map(|name| ["--test", name]));
    }
    exit(succeeds(&mut command))
}
