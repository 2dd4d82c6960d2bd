//! walkabout.
fn main() {}
