//! walkabout.

use std::process::ExitCode;

use walkabout::app::preview_main::{self, Mode};

fn main() -> ExitCode {
    let args: Vec<_> = std::env::args_os().skip(1).collect();
    match args.iter().map(|arg| arg.to_str()).collect::<Vec<_>>()[..] {
        [Some("preview")] => preview_main::run(Mode::Window),
        [Some("preview"), Some("--headless")] => preview_main::run(Mode::Headless),
        _ => {
            eprintln!("usage: walkabout preview [--headless]");
            ExitCode::from(2)
        }
    }
}
