//! To be written.

pub mod signals;
