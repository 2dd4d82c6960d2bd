//! The command line.

use std::path::PathBuf;

use super::limits::Limit;
use crate::path::Shape;

/// Makes captured motion walk any path.
#[derive(Debug, clap::Parser)]
#[command(name = "walkabout", version, args_conflicts_with_subcommands = true, max_term_width = 100)]
pub struct Args {
    /// The command; none opens the editor.
    #[command(subcommand)]
    pub verb: Option<Verb>,
    /// What the editor opens.
    #[command(flatten)]
    pub clip: Clip,
}

/// A clip and the edits named on the command line.
#[derive(Clone, Debug, clap::Args)]
pub struct Clip {
    /// A BVH clip or a project (.toml); none is the built-in clip.
    pub file: Option<PathBuf>,
    /// Sets a parameter (`walkabout params` lists them); may be given often, all applied as one edit.
    #[arg(long, value_name = "NAME=VALUE")]
    pub set: Vec<String>,
    /// A ready path: line, chord, original, circle, zigzag, eight, u or s, with :SIZE in lengths of the original path.
    #[arg(long, value_name = "SHAPE[:SIZE]")]
    pub shape: Option<Shape>,
}

/// Where a result goes.
#[derive(Clone, Debug, clap::Args)]
pub struct Output {
    /// The file to write; never left half written.
    #[arg(short, long, value_name = "OUT")]
    pub output: PathBuf,
    /// Replaces the file if it exists.
    #[arg(long)]
    pub force: bool,
}

/// Which picture to render.
#[derive(Clone, Debug, clap::Args)]
pub struct Picture {
    /// Frame, counted in what would be exported; default: the first after the rest frames.
    #[arg(long, value_name = "N")]
    pub frame: Option<usize>,
    /// Views: one, two side by side, four in a square; default: as the project has them (view.layout).
    #[arg(long, value_name = "1|2|4")]
    pub views: Option<u8>,
    /// Camera preset of the first view, which is the only one unless --views says otherwise.
    #[arg(long, value_name = "1..4", value_parser = clap::value_parser!(u8).range(1..=4))]
    pub camera: Option<u8>,
    /// Size in pixels.
    #[arg(long, value_name = "WxH", default_value = "1280x720", value_parser = parse_size)]
    pub size: (u32, u32),
}

/// A command that ends by itself.
#[derive(Debug, clap::Subcommand)]
pub enum Verb {
    /// Says what the file holds and why it is read so.
    Info {
        /// What to look at.
        #[command(flatten)]
        clip: Clip,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Writes the edited clip as BVH.
    Export {
        /// What to export.
        #[command(flatten)]
        clip: Clip,
        /// Where to.
        #[command(flatten)]
        output: Output,
        /// Between interpolation keys writes what is played: the interpolation of their poses.
        #[arg(long)]
        interpolated: bool,
    },
    /// Renders one frame to PNG without a window.
    Render {
        /// What to render.
        #[command(flatten)]
        clip: Clip,
        /// Where to.
        #[command(flatten)]
        output: Output,
        /// Which picture.
        #[command(flatten)]
        picture: Picture,
    },
    /// Prints the quality numbers, source beside edited.
    #[command(after_help = Limit::help())]
    Measure {
        /// What to measure.
        #[command(flatten)]
        clip: Clip,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
        /// Exits with status 1 when a number is beyond a limit or cannot be measured; may be given often.
        #[arg(long, value_name = "NAME=LIMIT")]
        fail: Vec<Limit>,
    },
    /// Prints the keys of displacement maps, layer by layer.
    Maps {
        /// Whose.
        #[command(flatten)]
        clip: Clip,
        /// Only this joint's; may be given often.
        #[arg(long, value_name = "NAME")]
        joint: Vec<String>,
        /// Only the carrier's position, beside the joints named.
        #[arg(long)]
        position: bool,
        /// Prints JSON.
        #[arg(long)]
        json: bool,
    },
    /// Says what was found: terminal, colours, Vulkan driver, display.
    Doctor,
    /// Prints the parameter table.
    Params,
    /// Prints the key table.
    Keys,
    /// The preview process; started by the editor.
    #[command(hide = true)]
    Preview {
        /// Sends frames in place of opening a window.
        #[arg(long)]
        headless: bool,
        /// Opens the second window.
        #[arg(long, conflicts_with = "headless")]
        second: bool,
    },
}

/// Largest edge of a rendered picture, pixels; every Vulkan 1.3 device takes at least 4096.
const MAX_EDGE: u32 = 8192;

fn parse_size(text: &str) -> Result<(u32, u32), String> {
    let parsed = text.split_once(['x', 'X']).and_then(|(w, h)| Some((w.parse().ok()?, h.parse().ok()?)));
    parsed
        .filter(|(w, h)| (1..=MAX_EDGE).contains(w) && (1..=MAX_EDGE).contains(h))
        .ok_or_else(|| format!("expected WIDTHxHEIGHT, each from 1 to {MAX_EDGE}"))
}

#[cfg(test)]
mod tests {
    use super::*;
    use clap::{CommandFactory as _, Parser as _};

    #[test]
    fn the_command_line_is_consistent() {
        Args::command().debug_assert();
    }

    #[test]
    fn a_file_or_a_command() {
        let args = Args::parse_from(["walkabout", "walk.bvh", "--set", "path.degree=2"]);
        assert!(args.verb.is_none());
        assert_eq!(args.clip.set, ["path.degree=2"]);
        assert!(matches!(Args::parse_from(["walkabout", "info", "walk.bvh"]).verb, Some(Verb::Info { .. })));
    }

    #[test]
    fn sizes_have_bounds() {
        assert_eq!(parse_size("640x360"), Ok((640, 360)));
        for text in ["0x1", "640", "x", "99999x1", "-1x5"] {
            assert!(parse_size(text).is_err(), "{text}");
        }
    }
}
