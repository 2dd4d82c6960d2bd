//! A scene becomes pixels, and what happens in a window becomes events.
//!
//! The viewport sees a [`Scene`](crate::scene::Scene) and nothing else: no document, no clip. The one idea: there is
//! one way from a scene to pixels, [`Renderer`], which draws into an image of its own; a picture file reads that image
//! back, a window copies it onto its surface, a terminal pane gets it over the link. So the pictures that tests compare are
//! what users see.
//!
//! Vulkan is loaded at run time: no loader and no driver are ordinary errors ([`GpuError`]) that say what would help.
//!
//! | files | noun |
//! | --- | --- |
//! | `instance`, `device`, `buffer`, `image`, `pipeline`, `commands` | Vulkan's objects, each destroyed by its owner |
//! | `target`, `shadow` | what is drawn into |
//! | `camera`, `view_block` | a view's mathematics, and what the shaders get of it |
//! | `pass_sky`, `pass_solids`, `pass_ground`, `pass_ribbons`, `pass_text` | one kind of thing on screen each, in drawing order |
//! | `batch`, `listed`, `text`, `font` | the scene as instances of what the passes draw |
//! | `renderer` | the recipe of a picture |
//! | `surface`, `swapchain`, [`window`], [`headless`], `keys` | where pictures go and what comes back |
//!
//! GPU objects stay in the thread that made them. Every owner holds its parents by `Rc`, so nothing outlives what it
//! was made from: image and buffer → device → instance; swapchain → surface → instance.
//!
//! f32 begins here: positions are taken relative to an origin near the scene in f64 before they are rounded.

mod batch;
mod buffer;
mod camera;
mod commands;
mod device;
mod error;
mod font;
mod footprint;
pub mod headless;
mod image;
mod instance;
mod keys;
mod listed;
mod pass_ground;
mod pass_ribbons;
mod pass_sky;
mod pass_solids;
mod pass_text;
mod pipeline;
mod renderer;
mod shadow;
mod surface;
mod swapchain;
mod target;
mod text;
mod view_block;
pub mod window;
mod wire;

pub use camera::pick;
pub use device::DeviceChoice;
pub use error::GpuError;
pub use instance::ValidationLog;
pub use renderer::{Quality, Renderer, RendererOptions};
