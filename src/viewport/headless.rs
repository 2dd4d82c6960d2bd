//! Pictures for the terminal pane: scenes in, frames out, no window.

use super::{GpuError, Renderer, RendererOptions};
use crate::{
    scene::{FromPreview, Scene},
    sync::Mailbox,
};

/// A picture that is wanted.
#[derive(Clone, Debug, PartialEq)]
pub struct Request {
    /// What is to be seen.
    pub scene: Scene,
    /// Width in pixels; a request without an area is passed over.
    pub width: u32,
    /// Height in pixels.
    pub height: u32,
}

/// Draws the newest request again and again until the mailbox is closed.
///
/// Sends [`FromPreview::Ready`] with the first frame, a [`FromPreview::Frame`] for each request that is not overtaken
/// by a newer one, and when drawing is impossible [`FromPreview::Failed`] as the last event. A lost device is opened
/// anew once.
pub fn run(options: &RendererOptions, requests: &Mailbox<Request>, mut events: impl FnMut(FromPreview)) {
    if let Err(why) = serve(options, requests, &mut events) {
        events(FromPreview::Failed(why.to_string()));
    }
}

fn serve(
    options: &RendererOptions,
    requests: &Mailbox<Request>,
    events: &mut impl FnMut(FromPreview),
) -> Result<(), GpuError> {
    let mut renderer = Renderer::new(options)?;
    let (mut ready, mut reopened) = (false, false);
    while let Some(Request { scene, width, height }) = requests.wait() {
        if width == 0 || height == 0 {
            continue;
        }
        let picture = match renderer.render(&scene, width, height) {
            Err(GpuError::DeviceLost) if !reopened => {
                reopened = true;
                renderer = Renderer::new(options)?;
                renderer.render(&scene, width, height)?
            }
            drawn => drawn?,
        };
        if !ready {
            ready = true;
            events(FromPreview::Ready { device: renderer.device_name(), driver: renderer.driver().to_owned() });
        }
        events(FromPreview::Frame(picture));
    }
    Ok(())
}
