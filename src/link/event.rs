//! What comes up from a preview.

use std::io::{self, Read, Write};

use super::{
    Error,
    check::{check_event, check_picture},
    message::{Incoming, Kind, Outgoing, decode, decode_first},
    text::one_line,
};
use crate::scene::{FromPreview, Picture};

/// The preview's end: sends events and pictures.
#[derive(Debug)]
pub struct EventWriter<W> {
    out: Outgoing<W>,
}

impl<W: Write> EventWriter<W> {
    /// Greets the editor.
    ///
    /// # Errors
    ///
    /// When the stream does not take the bytes.
    pub fn new(stream: W) -> io::Result<Self> {
        Ok(Self { out: Outgoing::new(stream)? })
    }

    /// Sends one event and flushes.
    ///
    /// # Errors
    ///
    /// When the stream does not take the bytes, or the event is longer than [`Kind::longest`]; it is then not sent and
    /// the stream is as good as before.
    pub fn send(&mut self, event: &FromPreview) -> Result<(), Error> {
        match event {
            FromPreview::Frame(Picture { width, height, rgb }) => self.out.send(Kind::Picture, &(width, height), rgb),
            event => self.out.send(Kind::Event, event, &[]),
        }
    }
}

/// The editor's end: receives events and pictures.
#[derive(Debug)]
pub struct EventReader<R> {
    incoming: Incoming<R>,
}

impl<R: Read> EventReader<R> {
    /// Makes a reader; nothing is read yet.
    pub fn new(stream: R) -> Self {
        Self { incoming: Incoming::new(stream, &[Kind::Event, Kind::Picture]) }
    }

    /// Waits for the next event; none when the stream has ended where it may.
    ///
    /// Texts come as one line each, safe to show in a terminal.
    ///
    /// # Errors
    ///
    /// When the stream breaks, or holds anything that is not an event fit to be acted on.
    pub fn read(&mut self) -> Result<Option<FromPreview>, Error> {
        let Some((kind, payload)) = self.incoming.next()? else {
            return Ok(None);
        };
        if kind == Kind::Picture {
            let ((width, height), rgb) = decode_first(kind, payload)?;
            check_picture(width, height, rgb.len())?;
            return Ok(Some(FromPreview::Frame(Picture { width, height, rgb: rgb.to_vec() })));
        }
        let event = decode(kind, payload)?;
        check_event(&event)?;
        Ok(Some(match event {
            FromPreview::Ready { device, driver } => {
                FromPreview::Ready { device: one_line(&device), driver: one_line(&driver) }
            }
            FromPreview::Failed(text) => FromPreview::Failed(one_line(&text)),
            event => event,
        }))
    }
}
