//! What goes down to a preview.

use std::{
    io::{self, Read, Write},
    sync::Arc,
};

use super::{
    Error, Fault,
    check::{check_now, check_size, check_still},
    message::{Incoming, Kind, Outgoing, decode},
};
use crate::scene::{Now, Scene, Still, ToPreview};

/// The editor's end: sends what a preview is to show.
#[derive(Debug)]
pub struct SceneWriter<W> {
    out: Outgoing<W>,
    /// Revision of the still part that the other end holds.
    sent: Option<u64>,
}

impl<W: Write> SceneWriter<W> {
    /// Greets the preview.
    ///
    /// # Errors
    ///
    /// When the stream does not take the bytes.
    pub fn new(stream: W) -> io::Result<Self> {
        Ok(Self { out: Outgoing::new(stream)?, sent: None })
    }

    /// Sends one message and flushes. A scene's still part goes with it only when its revision differs from the last one
    /// sent.
    ///
    /// # Errors
    ///
    /// When the stream does not take the bytes, or a part of the scene is longer than [`Kind::longest`]; that part is
    /// then not sent and the stream is as good as before.
    pub fn send(&mut self, message: &ToPreview) -> Result<(), Error> {
        match message {
            ToPreview::Scene(Scene { still, now }) => {
                if self.sent != Some(still.revision) {
                    self.out.send(Kind::Still, still.as_ref(), &[])?;
                    self.sent = Some(still.revision);
                }
                self.out.send(Kind::Now, now, &[])
            }
            &ToPreview::Size { width, height } => self.out.send(Kind::Size, &(width, height), &[]),
            ToPreview::Close => self.out.send(Kind::Close, &(), &[]),
        }
    }
}

/// The preview's end: puts whole scenes together again.
#[derive(Debug)]
pub struct SceneReader<R> {
    incoming: Incoming<R>,
    still: Option<Arc<Still>>,
}

impl<R: Read> SceneReader<R> {
    /// Makes a reader; nothing is read yet.
    pub fn new(stream: R) -> Self {
        let incoming = Incoming::new(stream, &[Kind::Still, Kind::Now, Kind::Size, Kind::Close]);
        Self { incoming, still: None }
    }

    /// Waits for the next message; none when the stream has ended where it may.
    ///
    /// Scenes between two changes of the still part share it.
    ///
    /// # Errors
    ///
    /// When the stream breaks, or holds anything that is not a message fit to be shown.
    pub fn read(&mut self) -> Result<Option<ToPreview>, Error> {
        while let Some((kind, payload)) = self.incoming.next()? {
            let message = match kind {
                Kind::Still => {
                    let still: Still = decode(kind, payload)?;
                    check_still(&still)?;
                    self.still = Some(Arc::new(still));
                    continue;
                }
                Kind::Now => {
                    let still = self.still.clone().ok_or(Error::NowBeforeStill)?;
                    let now: Now = decode(kind, payload)?;
                    check_now(&still, &now)?;
                    ToPreview::Scene(Scene { still, now })
                }
                Kind::Size => {
                    let (width, height) = decode(kind, payload)?;
                    check_size(width, height)?;
                    ToPreview::Size { width, height }
                }
                Kind::Close => {
                    decode::<()>(kind, payload)?;
                    ToPreview::Close
                }
                Kind::Event | Kind::Picture => unreachable!("not among the kinds that go down"),
            };
            return Ok(Some(message));
        }
        Ok(None)
    }
}

/// Checks a scene as its arrival at a preview would, so that a sender's tests can.
///
/// # Errors
///
/// The first fault found.
pub fn check_scene(scene: &Scene) -> Result<(), Fault> {
    check_still(&scene.still)?;
    check_now(&scene.still, &scene.now)
}
