//! The terminal: what the editor shows as cells, what is typed as keys.
//!
//! [`terminal`] takes the terminal over and gives it back exactly as it was found, [`input`] turns its bytes into
//! [`Key`](crate::key::Key)s on a thread of its own. Nothing here decides.

pub mod input;
pub mod screen;
pub mod terminal;

pub use input::{InputEvent, InputThread};
pub use screen::{Screen, ScreenError, leave_on_panic};
pub use terminal::Terminal;
