//! The running editor: its threads and its preview process.

pub mod preview;
pub mod preview_main;
pub mod signals;
