//! The walkabout program: reads the command line and starts the editor, a preview or a headless run.

use std::process::ExitCode;

use clap::Parser as _;
use walkabout::{
    app::{
        self,
        preview_main::{self, Mode},
    },
    cli::{self, Args, Verb},
    editor::{Editor, Window},
};

fn main() -> ExitCode {
    let args = Args::parse();
    match &args.verb {
        None => match cli::open(&args.clip) {
            Ok((document, warnings)) => app::edit(Editor::new(document, warnings)),
            Err(failure) => cli::finish(Err(failure)),
        },
        Some(Verb::Preview { headless, second }) => preview_main::run(match (headless, second) {
            (true, _) => Mode::Headless,
            (false, true) => Mode::Window(Window::Second),
            (false, false) => Mode::Window(Window::First),
        }),
        Some(verb) => cli::run(verb),
    }
}
