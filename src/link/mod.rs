//! Scenes down to a preview and its events back up, over any byte stream: a pipe, a Unix socket, TCP.
//!
//! This is the format and its two ends. It starts no process, makes no thread and holds no state but what the stream
//! itself needs; `app` does the rest.
//!
//! ```text
//! stream   hello message*
//! hello    "walkabout" version:u16
//! message  length:u32 kind:u8 payload:[u8; length]        (integers little-endian)
//! ```
//!
//! | kind | goes | payload |
//! | --- | --- | --- |
//! | still | down | postcard of [`Still`](crate::scene::Still), only when its revision is not the one last sent |
//! | now | down | postcard of [`Now`](crate::scene::Now), once per scene |
//! | size | down | postcard of width and height |
//! | close | down | nothing |
//! | event | up | postcard of [`FromPreview`](crate::scene::FromPreview) |
//! | picture | up | postcard of width and height, then the pixels as they are |
//!
//! The one idea: what arrives is **never trusted**. Each kind has its longest length ([`Kind::longest`]); memory grows
//! with the bytes that came, never with a number that was claimed; and what a reader hands out has been checked
//! ([`Fault`]), so that whoever draws it may index and divide without looking. After an error a reader has lost its
//! place in the stream and is of no more use.

mod check;
mod event;
mod message;
mod scene;
mod text;

pub use check::{Fault, MAX_GRID_LINES, MAX_PICTURE};
pub use event::{EventReader, EventWriter};
pub use message::{Kind, VERSION};
pub use scene::{SceneReader, SceneWriter, check_scene};
pub use text::one_line;

/// Why a link cannot go on.
#[derive(Debug, thiserror::Error)]
pub enum Error {
    /// The stream itself failed.
    #[error("the link broke: {0}")]
    Io(#[from] std::io::Error),
    /// The stream ended inside a hello or a message.
    #[error("the link ended inside a message, {found} of {expected} bytes in")]
    Truncated {
        /// Bytes that the part should have.
        expected: usize,
        /// Bytes that came.
        found: usize,
    },
    /// The other end is no walkabout.
    #[error("what speaks on the link is not walkabout")]
    Foreign,
    /// The other end is another walkabout.
    #[error("the link speaks version {theirs}, this program version {VERSION}")]
    Version {
        /// The version it greeted with.
        theirs: u16,
    },
    /// No message of this kind goes in this direction.
    #[error("a message of unknown kind {0}")]
    UnknownKind(u8),
    /// A message is longer than its kind may be.
    #[error("a {kind} message of {length} bytes, the most is {}", kind.longest())]
    Oversized {
        /// What it is.
        kind: Kind,
        /// The length it has or claims.
        length: usize,
    },
    /// A payload is not what its kind says.
    #[error("a {0} message that does not decode")]
    Malformed(Kind),
    /// Bytes are left over after a payload.
    #[error("a {kind} message with {extra} bytes too many")]
    Trailing {
        /// What it is.
        kind: Kind,
        /// Bytes left over.
        extra: usize,
    },
    /// A moving part came before any still part.
    #[error("a scene's moving part before its still part")]
    NowBeforeStill,
    /// A payload decodes, but cannot be shown or acted on.
    #[error(transparent)]
    Fault(#[from] Fault),
}
