//! walkabout makes captured motion walk any path.
//!
//! A clip as loaded ([`document::Source`]) and one small value the user edits ([`document::Edits`]) go into a pure
//! function ([`document::solve()`]) whose result ([`document::Solved`]) is shown by a terminal front end, a Vulkan
//! preview and a command line, none of which can change anything except by a command.
//!
//! # Layers
//!
//! A module names modules of lower layers only, never a neighbour of its own layer; `tests/layers.rs` keeps it so.
//!
//! | layer | modules | one responsibility |
//! | --- | --- | --- |
//! | 8 | [`app`], [`cli`] | the event loop, its threads and its preview process · headless runs |
//! | 7 | [`tui`], [`viewport`], [`link`] | editor → cells, terminal events → keys · scene → pixels, window events → keys · scenes and events over a byte stream |
//! | 6 | [`editor`] | commands, keymap, view state; builds the scene; knows no terminal and no GPU |
//! | 5 | [`document`], [`scene`] | edits, undo, the solve, project files · a picture as plain data that can travel |
//! | 4 | [`constrain`], [`cycle`], [`measure`] | feet that stay planted · loop finder and joined cycles · quality numbers |
//! | 3 | [`path`], [`contact`], [`displace`] | path out of and into a clip · plant detection · displacement maps |
//! | 2 | [`motion`] | clips, poses, kinematics; conversion from and to BVH |
//! | 1 | [`curve`], [`bvh`], [`skeleton`] | polynomial fit, B-spline, arc length · the file as it is, losslessly · joint tree |
//! | 0 | [`math`], [`sync`], [`key`] | what glam and the linear algebra library lack · newest-value mailbox, work that can be given up, work by halves · one name for a key press |
//!
//! # The flow of one change
//!
//! `+` on *control points*: terminal bytes → [`key::Key`] → keymap → [`editor::Command`] → the next
//! [`document::Edits`] → [`document::solve()`] → `Arc<Solved>` → [`scene::Scene`] → the terminal draws, and the link
//! hands the scene to the preview process. Each arrow points down once; nothing comes back up.
//!
//! # Spaces and units
//!
//! Everything between [`motion`]'s two conversions is y-up, in the clip's own length unit, in radians and seconds and
//! in f64. Degrees and the file's own axes exist in [`bvh`], in [`motion`]'s conversions and in text for people;
//! f32 begins in [`viewport`].

pub mod app;
pub mod bvh;
pub mod cli;
pub mod constrain;
pub mod contact;
pub mod curve;
pub mod cycle;
pub mod displace;
pub mod document;
pub mod editor;
pub mod key;
pub mod link;
pub mod math;
pub mod measure;
pub mod motion;
pub mod path;
pub mod scene;
pub mod skeleton;
pub mod sync;
pub mod tui;
pub mod viewport;
