//! The walkabout program: reads the command line and starts the editor, a preview or a headless run.

use std::process::ExitCode;

use clap::Parser as _;
use walkabout::{
    app::{
        self,
        preview_main::{self, Mode},
    },
    cli::{self, Args, Verb},
    editor::Editor,
};

fn main() -> ExitCode {
    let args = Args::parse();
    match &args.verb {
        None => match cli::open(&args.clip) {
            Ok((document, warnings)) => app::edit(Editor::new(document, warnings)),
            Err(failure) => cli::finish(Err(failure)),
        },
        Some(Verb::Preview { headless }) => preview_main::run(if *headless { Mode::Headless } else { Mode::Window }),
        Some(verb) => cli::run(verb),
    }
}
