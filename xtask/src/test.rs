//! `cargo xtask test`: the machine made ready, then every check in order, then a summary.
//!
//! All checks run whatever the earlier ones said, so that one run tells everything. The order saves work: tests come
//! after clippy, which is sooner to fail, and what tests built serves shaders and benchmarks.

use std::{
    env,
    io::{self, BufRead, BufReader, Write},
    process::{Command, ExitCode, Stdio},
    time::{Duration, Instant},
};

use crate::{
    cargo::{cargo_in_workspace, exit, succeeds},
    needs::Purpose,
    setup::{self, Consent, in_ci},
    shaders,
    system::System,
    tally::Tally,
    wrong_usage,
};

/// How one check went.
struct Outcome {
    name: &'static str,
    passed: bool,
    took: Duration,
}

/// Runs every check. In CI a machine that could not be made ready fails as a check does.
pub(crate) fn test(args: &[String]) -> ExitCode {
    let consent = match args {
        [] => Consent::given(false),
        [yes] if yes == "--yes" => Consent::given(true),
        _ => return wrong_usage("test knows `--yes` and nothing else"),
    };
    let mut tally = Tally::default();
    let outcomes = [
        timed("set-up", "what is missing is installed", || setup::set_up(Purpose::Test, consent) || !in_ci()),
        timed("format", "cargo fmt --all --check", format),
        timed("clippy", "cargo clippy --workspace --all-targets -- -D warnings", clippy),
        timed("tests", "cargo test --workspace --no-fail-fast", || tests(&mut tally)),
        timed("docs", "cargo doc --workspace --no-deps --document-private-items", docs),
        timed("shaders", "spirv-val on what the build script compiled", shaders::check),
        timed("benchmarks", "cargo build --package walkabout --all-targets", benchmarks),
    ];
    print!("{}", summary(&outcomes, tally));
    exit(outcomes.iter().all(|outcome| outcome.passed))
}

/// Runs one check under a heading.
fn timed(name: &'static str, what: &str, check: impl FnOnce() -> bool) -> Outcome {
    println!("\n==== {name}: {what}");
    let start = Instant::now();
    let passed = check();
    let outcome = Outcome { name, passed, took: start.elapsed() };
    println!("{}", outcome.line());
    outcome
}

impl Outcome {
    fn line(&self) -> String {
        let word = if self.passed { "ok" } else { "FAILED" };
        format!("{:<12}{word:<8}{:>7.1} s", self.name, self.took.as_secs_f64())
    }
}

/// The closing lines. The last one counts tests; a check that failed without a failing test counts as one more, so
/// that it never reads as success when the exit status does not.
fn summary(outcomes: &[Outcome], tally: Tally) -> String {
    let failed_checks = outcomes.iter().filter(|outcome| !outcome.passed);
    let not_counted = failed_checks.filter(|outcome| outcome.name != "tests" || tally.failed == 0).count();
    let total: Duration = outcomes.iter().map(|outcome| outcome.took).sum();
    let lines: String = outcomes.iter().map(|outcome| outcome.line() + "\n").collect();
    let all = Outcome { name: "all", passed: outcomes.iter().all(|outcome| outcome.passed), took: total };
    let failed = tally.failed + not_counted as u64;
    format!("\n==== summary\n{lines}{}\n{} passed, {failed} failed\n", all.line(), tally.passed)
}

fn format() -> bool {
    succeeds(cargo_in_workspace().args(["fmt", "--all", "--check"]))
}

fn clippy() -> bool {
    succeeds(cargo_in_workspace().args(["clippy", "--workspace", "--all-targets", "--", "-D", "warnings"]))
}

/// Builds the documentation. Naming the examples, of which there are none, makes cargo take the features that
/// dev-dependencies ask for, so that what clippy has checked is not checked again without them.
fn docs() -> bool {
    let mut command = cargo_in_workspace();
    command.args(["doc", "--workspace", "--no-deps", "--document-private-items"]);
    command.args(["--lib", "--bin", "xtask", "--examples"]).env("RUSTDOCFLAGS", "-D warnings");
    succeeds(&mut command)
}

/// Builds the benchmarks as tests are built: that they compile and link, without an optimised build.
fn benchmarks() -> bool {
    succeeds(cargo_in_workspace().args(["build", "--package", "walkabout", "--all-targets"]))
}

/// Runs the tests and counts their results as they pass by.
fn tests(tally: &mut Tally) -> bool {
    if env::var_os("WALKABOUT_CLIPS").is_none() {
        println!("WALKABOUT_CLIPS is not set: tests that read captured clips will be SKIPPED");
    }
    let mut command = cargo_test();
    command.args(["--workspace", "--no-fail-fast"]);
    counted(&mut command, &mut io::stdout(), tally).unwrap_or_else(|error| {
        println!("could not run the tests: {error}");
        false
    })
}

/// Returns `cargo test`, about to run in the surroundings tests expect.
///
/// Pictures are compared on lavapipe, so the loader is shown no other driver, and lavapipe chooses its threads.
pub(crate) fn cargo_test() -> Command {
    let mut command = cargo_in_workspace();
    command.arg("test").env_remove("LP_NUM_THREADS");
    match System::look(&[], &[]).lavapipe() {
        Some(manifest) => {
            command.env("VK_DRIVER_FILES", manifest).env("VK_ICD_FILENAMES", manifest);
        }
        None => println!("lavapipe was not found: tests that need Vulkan will be SKIPPED"),
    }
    command
}

/// Runs a command, passes its standard output on line by line and reads the results in it.
fn counted(command: &mut Command, out: &mut impl Write, tally: &mut Tally) -> io::Result<bool> {
    let mut child = command.stdout(Stdio::piped()).spawn()?;
    let mut output = BufReader::new(child.stdout.take().expect("stdout is piped"));
    let mut line = Vec::new();
    while output.read_until(b'\n', &mut line)? > 0 {
        out.write_all(&line)?;
        tally.read(&String::from_utf8_lossy(&line));
        line.clear();
    }
    Ok(child.wait()?.success())
}

#[cfg(test)]
mod tests {
    use super::*;

    fn outcome(name: &'static str, passed: bool) -> Outcome {
        Outcome { name, passed, took: Duration::from_millis(1500) }
    }

    /// Checks the last line of a summary.
    #[track_caller]
    fn check(outcomes: &[Outcome], passed: u64, failed: u64, expected: &str) {
        let text = summary(outcomes, Tally { passed, failed });
        assert_eq!(text.lines().last(), Some(expected), "{text}");
        assert!(text.ends_with('\n'));
    }

    #[test]
    fn the_last_line_counts_tests_and_never_hides_a_failure() {
        check(&[outcome("format", true), outcome("tests", true)], 7, 0, "7 passed, 0 failed");
        check(&[outcome("format", true), outcome("tests", false)], 7, 2, "7 passed, 2 failed");
        check(&[outcome("format", false), outcome("tests", true)], 7, 0, "7 passed, 1 failed");
        check(&[outcome("tests", false)], 0, 0, "0 passed, 1 failed");
        check(&[outcome("tests", false), outcome("docs", false)], 3, 1, "3 passed, 2 failed");
    }

    #[test]
    fn the_summary_names_every_check_with_its_time() {
        let text = summary(&[outcome("format", true), outcome("docs", false)], Tally::default());
        assert!(text.contains("format      ok          1.5 s\n"), "{text}");
        assert!(text.contains("docs        FAILED      1.5 s\n"), "{text}");
        assert!(text.contains("all         FAILED      3.0 s\n"), "{text}");
    }

    #[cfg(unix)]
    #[test]
    fn results_are_counted_while_they_pass_by() {
        let mut tally = Tally::default();
        let mut command = Command::new("sh");
        command.args(["-c", "echo 'test result: ok. 3 passed; 0 failed;'; printf '\\377 no text'; exit 1"]);
        let mut passed_on = Vec::new();
        assert!(!counted(&mut command, &mut passed_on, &mut tally).expect("sh starts"));
        assert_eq!(passed_on, b"test result: ok. 3 passed; 0 failed;\n\xff no text");
        assert_eq!(tally, Tally { passed: 3, failed: 0 });
    }
}
