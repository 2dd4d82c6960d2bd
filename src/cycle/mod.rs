//! Cycles that do not pop: ranges of a clip that can be repeated, and the clip that repeats one (METHOD 7).
//!
//! [`LoopFinder`] looks for ranges `[first, end)` whose ends are alike once the path is taken out: same pose, same
//! velocities, same phase of the feet. [`Join`] makes a longer clip of one: the frames before `end`, then the range again
//! and again. Copies are chained along the original path, but each as high as the ground has it, and what is left of the
//! mismatch is spread over a window on both sides of each seam:
//!
//! ```text
//! clip      0 ······ first ─────────── end ······ F
//! joined    0 ······ first ─────────── end│first ─────────── end│first ── …
//!                                    ▔▔▔▔▔▔▔▔▔                 seams, each with its window
//! ```
//!
//! The joined clip is a clip like any other, with a path and arc lengths of its own: plants are found on it, and it
//! walks a new path without any cycling of its own. Frames do not count rest frames.

mod along;
mod find;
mod join;
mod phase;
mod plants;
mod spread;

pub use along::LoopRange;
pub use find::{Loop, LoopFinder, Mismatch};
pub use join::{Join, Joined};
