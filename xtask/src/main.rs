//! Project tasks, started as `cargo xtask TASK`.
//!
//! One task to a file. [`needs`] decides what is missing on a machine from the description in [`system`]; [`setup`]
//! acts on that decision; [`mod@run`], [`mod@test`], [`mod@bench`] and [`mod@bless`] are what people type. Only the standard library
//! is used, so that the first command on a bare machine answers within seconds.

use std::process::ExitCode;

mod apt;
mod bench;
mod bless;
mod cargo;
mod needs;
mod run;
mod setup;
mod shaders;
mod system;
mod tally;
mod test;

const USAGE: &str = "\
cargo xtask TASK

  run [--yes] [--debug] [ARGS...]   install what is missing, build, and start walkabout with ARGS
  test [--yes]                      install what is missing, then run every check
  bench [NAME...]                   run the benchmarks, all or those named
  report                            write docs/feet.md and its plot: what holding the feet does on captured clips
  bless [TEST...]                   write the golden files of these tests anew (all, where none is named)
  setup [--yes]                     install what running and testing need, and nothing else

--yes installs without asking. In CI (the variable CI is set) it is implied, and what stays missing is a failure.
";

/// Exit status of a wrong command line, as walkabout's own.
const WRONG_USAGE: u8 = 2;

fn main() -> ExitCode {
    let args: Vec<String> = match std::env::args_os().skip(1).map(|arg| arg.into_string()).collect() {
        Ok(args) => args,
        Err(arg) => return wrong_usage(&format!("{} is not UTF-8", arg.display())),
    };
    let Some((task, args)) = args.split_first() else {
        return wrong_usage("which task?");
    };
    match task.as_str() {
        "run" => run::run(args),
        "test" => test::test(args),
        "bench" => bench::bench(args),
        "report" => bench::report(),
        "bless" => bless::bless(args),
        "setup" => setup::setup(args),
        "help" | "--help" | "-h" => {
            print!("{USAGE}");
            ExitCode::SUCCESS
        }
        other => wrong_usage(&format!("there is no task `{other}`")),
    }
}

/// Says what is wrong with the command line, and how it should look.
fn wrong_usage(problem: &str) -> ExitCode {
    eprint!("{problem}\n\n{USAGE}");
    ExitCode::from(WRONG_USAGE)
}
