//! `walkabout doctor`: what was found on this machine, and what would bring what is missing.

use std::{env, fmt::Write as _, io::IsTerminal as _};

use super::Failure;
use crate::{
    tui::Depth,
    viewport::{Renderer, RendererOptions},
};

pub(super) fn run() -> Result<(), Failure> {
    let mut out = String::new();
    let mut line = |name: &str, value: String| writeln!(out, "{name:<16} {value}").expect("writing to a String");
    let var = |name: &str| env::var(name).ok().filter(|v| !v.is_empty());
    let terminal = if std::io::stdout().is_terminal() {
        let size = crossterm::terminal::size().map_or_else(|e| e.to_string(), |(w, h)| format!("{w}×{h} cells"));
        format!("{}, {size}", var("TERM").unwrap_or_else(|| "TERM not set".to_owned()))
    } else {
        "standard output is not a terminal".to_owned()
    };
    line("walkabout", env!("CARGO_PKG_VERSION").to_owned());
    line("terminal", terminal);
    line("colours", colours(Depth::from_env()).to_owned());
    line("image protocol", "none is used; pictures are drawn in half blocks (key b)".to_owned());
    match Renderer::new(&RendererOptions::default()) {
        Ok(renderer) => {
            line("vulkan device", renderer.device_name().to_owned());
            line("vulkan driver", renderer.driver().to_owned());
        }
        Err(error) => line("vulkan", format!("none: {error}")),
    }
    let display = ["WAYLAND_DISPLAY", "DISPLAY"].into_iter().find_map(|name| Some(format!("{name}={}", var(name)?)));
    line(
        "display",
        display.unwrap_or_else(|| "none: the editor runs without a window (key b draws in the terminal)".to_owned()),
    );
    line("config files", "none are read; settings live in project files".to_owned());
    line("cores", std::thread::available_parallelism().map_or_else(|e| e.to_string(), |n| n.to_string()));
    super::print(&out)
}

fn colours(depth: Depth) -> &'static str {
    match depth {
        Depth::Monochrome => "none (NO_COLOR or a terminal without)",
        Depth::Sixteen => "16",
        Depth::Indexed => "256",
        Depth::True => "24 bits (COLORTERM)",
    }
}
