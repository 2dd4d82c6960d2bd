//! The terminal: what the editor shows as cells, what is typed as keys.
//!
//! Two doors and many widgets. [`terminal`] takes the terminal over and gives it back exactly as it was found,
//! [`input`] turns its bytes into [`Key`](crate::key::Key)s on a thread of its own. Everything else is a widget: a
//! struct of plain fields that draws itself into an area of cells and keeps nothing.
//!
//! Nothing here decides: no widget knows a command, no widget changes anything. Colours go through one
//! [`Palette`], and no meaning hangs on a colour alone.

pub mod braille;
pub mod chart;
pub mod colour;
mod cover;
mod draw;
pub mod input;
pub mod key_help;
pub mod parameters;
pub mod picture;
pub mod plan;
mod plan_map;
pub mod score;
mod screen;
pub mod status;
pub mod terminal;
#[cfg(test)]
mod test_screen;
pub mod text;
pub mod timeline;

pub use chart::{Chart, Series};
pub use colour::{Depth, Palette};
pub use draw::{Drawn, Surroundings, draw};
pub use input::{InputEvent, InputThread};
pub use key_help::{KeyGroup, KeyHelp};
pub use parameters::{ParameterList, ParameterRow};
pub use picture::PictureView;
pub use plan::PlanView;
pub use plan_map::{Direction, Extent};
pub use screen::{Screen, ScreenError, leave_on_panic};
pub use status::{StatusLine, Tabs};
pub use terminal::Terminal;
pub use timeline::{Interval, Timeline, TimelineMark, TimelineRow};
