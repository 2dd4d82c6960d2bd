//! One message after another on a byte stream: the hello, the head, the payload.
//!
//! The payload's meaning is the business of [`super::scene`] and [`super::event`].

use std::{
    fmt,
    io::{self, BufReader, Read, Write},
};

use serde::{Serialize, de::DeserializeOwned};

use super::{Error, check::MAX_PICTURE};

/// The link's version; the two ends must agree exactly, for they are the same binary.
pub const VERSION: u16 = 4;

const MAGIC: [u8; 9] = *b"walkabout";
const HELLO_LEN: usize = MAGIC.len() + 2;
const HEAD_LEN: usize = 5;

/// What a message holds.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Kind {
    /// The still part of a scene.
    Still,
    /// The moving part of a scene.
    Now,
    /// The size of the pictures wanted.
    Size,
    /// The wish to close.
    Close,
    /// An event of the preview.
    Event,
    /// A finished picture.
    Picture,
}

impl Kind {
    const ALL: [Self; 6] = [Self::Still, Self::Now, Self::Size, Self::Close, Self::Event, Self::Picture];

    /// Returns the most bytes a payload of this kind may have.
    ///
    /// A picture is bounded by [`MAX_PICTURE`], 26.5 MB of pixels. A still part is given as much: curves for 1.3
    /// million points, which is ten traces over a 130,000-frame clip. A moving part holds two bodies' points, 24 bytes
    /// each: 1 MiB is two bodies of 21,000 joints. The rest are a few numbers or a line of text.
    pub fn longest(self) -> usize {
        match self {
            Self::Still => 32 << 20,
            Self::Picture => MAX_PICTURE[0] as usize * MAX_PICTURE[1] as usize * 3 + 16,
            Self::Now => 1 << 20,
            Self::Event => 16 << 10,
            Self::Size => 16,
            Self::Close => 0,
        }
    }

    fn byte(self) -> u8 {
        match self {
            Self::Still => 1,
            Self::Now => 2,
            Self::Size => 3,
            Self::Close => 4,
            Self::Event => 65,
            Self::Picture => 66,
        }
    }
}

impl fmt::Display for Kind {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        f.write_str(match self {
            Self::Still => "still",
            Self::Now => "now",
            Self::Size => "size",
            Self::Close => "close",
            Self::Event => "event",
            Self::Picture => "picture",
        })
    }
}

/// The sending end of a stream.
#[derive(Debug)]
pub(super) struct Outgoing<W> {
    stream: W,
    /// The message being made, head included; kept for its memory.
    message: Vec<u8>,
}

impl<W: Write> Outgoing<W> {
    /// Greets the other end.
    pub(super) fn new(mut stream: W) -> io::Result<Self> {
        let mut hello = [0; HELLO_LEN];
        hello[..MAGIC.len()].copy_from_slice(&MAGIC);
        hello[MAGIC.len()..].copy_from_slice(&VERSION.to_le_bytes());
        stream.write_all(&hello)?;
        stream.flush()?;
        Ok(Self { stream, message: Vec::new() })
    }

    /// Sends one message: a value, then bytes as they are. Nothing is written when it is too long for its kind.
    pub(super) fn send(&mut self, kind: Kind, value: &impl Serialize, raw: &[u8]) -> Result<(), Error> {
        self.message.clear();
        self.message.resize(HEAD_LEN, 0);
        postcard::to_io(value, &mut self.message).expect("plain data encodes into memory");
        self.message.extend_from_slice(raw);
        let length = self.message.len() - HEAD_LEN;
        if length > kind.longest() {
            return Err(Error::Oversized { kind, length });
        }
        let claimed = u32::try_from(length).expect("every kind's longest fits");
        self.message[..4].copy_from_slice(&claimed.to_le_bytes());
        self.message[4] = kind.byte();
        self.stream.write_all(&self.message)?;
        self.stream.flush()?;
        Ok(())
    }
}

/// The receiving end of a stream, which blocks.
#[derive(Debug)]
pub(super) struct Incoming<R> {
    stream: BufReader<R>,
    greeted: bool,
    /// Kinds that go in this direction.
    kinds: &'static [Kind],
    /// The payload last read; kept for its memory.
    payload: Vec<u8>,
}

impl<R: Read> Incoming<R> {
    pub(super) fn new(stream: R, kinds: &'static [Kind]) -> Self {
        Self { stream: BufReader::new(stream), greeted: false, kinds, payload: Vec::new() }
    }

    /// Reads the next message; none when the stream ends between two messages or before the first byte.
    pub(super) fn next(&mut self) -> Result<Option<(Kind, &[u8])>, Error> {
        if !self.greeted {
            let mut hello = [0; HELLO_LEN];
            let found = fill(&mut self.stream, &mut hello)?;
            if found == 0 {
                return Ok(None);
            }
            check_hello(&hello, found)?;
            self.greeted = true;
        }
        let mut head = [0; HEAD_LEN];
        match fill(&mut self.stream, &mut head)? {
            0 => return Ok(None),
            HEAD_LEN => {}
            found => return Err(Error::Truncated { expected: HEAD_LEN, found }),
        }
        let [length @ .., kind_byte] = head;
        let length = u32::from_le_bytes(length) as usize;
        let kind = Kind::ALL
            .into_iter()
            .find(|k| k.byte() == kind_byte && self.kinds.contains(k))
            .ok_or(Error::UnknownKind(kind_byte))?;
        if length > kind.longest() {
            return Err(Error::Oversized { kind, length });
        }
        self.payload.clear();
        let found = self.stream.by_ref().take(length as u64).read_to_end(&mut self.payload)?;
        if found < length {
            return Err(Error::Truncated { expected: length, found });
        }
        Ok(Some((kind, &self.payload)))
    }
}

/// Decodes a payload that is one value and nothing else.
pub(super) fn decode<T: DeserializeOwned>(kind: Kind, payload: &[u8]) -> Result<T, Error> {
    match decode_first(kind, payload)? {
        (value, []) => Ok(value),
        (_, rest) => Err(Error::Trailing { kind, extra: rest.len() }),
    }
}

/// Decodes the value a payload begins with, and returns the bytes after it.
pub(super) fn decode_first<T: DeserializeOwned>(kind: Kind, payload: &[u8]) -> Result<(T, &[u8]), Error> {
    postcard::take_from_bytes(payload).map_err(|_| Error::Malformed(kind))
}

fn check_hello(hello: &[u8; HELLO_LEN], found: usize) -> Result<(), Error> {
    let (magic, version) = hello.split_at(MAGIC.len());
    let seen = found.min(MAGIC.len());
    if magic[..seen] != MAGIC[..seen] {
        return Err(Error::Foreign);
    }
    if found < HELLO_LEN {
        return Err(Error::Truncated { expected: HELLO_LEN, found });
    }
    match u16::from_le_bytes([version[0], version[1]]) {
        VERSION => Ok(()),
        theirs => Err(Error::Version { theirs }),
    }
}

/// Reads until the buffer is full or the stream ends, and returns how many bytes came.
fn fill(stream: &mut impl Read, buffer: &mut [u8]) -> io::Result<usize> {
    let mut found = 0;
    while found < buffer.len() {
        match stream.read(&mut buffer[found..]) {
            Ok(0) => break,
            Ok(n) => found += n,
            Err(e) if e.kind() == io::ErrorKind::Interrupted => {}
            Err(e) => return Err(e),
        }
    }
    Ok(found)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn stream_of(head: [u8; HEAD_LEN], payload: &[u8]) -> Vec<u8> {
        let mut bytes = Vec::new();
        Outgoing::new(&mut bytes).expect("memory takes everything");
        bytes.extend_from_slice(&head);
        bytes.extend_from_slice(payload);
        bytes
    }

    #[test]
    fn memory_follows_the_bytes_that_came_not_the_claimed_length() {
        let claimed = u32::try_from(Kind::Still.longest()).expect("fits").to_le_bytes();
        let bytes = stream_of([claimed[0], claimed[1], claimed[2], claimed[3], Kind::Still.byte()], b"abc");
        let mut incoming = Incoming::new(&bytes[..], &[Kind::Still]);
        assert!(matches!(incoming.next(), Err(Error::Truncated { found: 3, .. })));
        assert!(incoming.payload.capacity() <= 64 << 10, "{}", incoming.payload.capacity());
    }

    #[test]
    fn a_length_over_the_kind_s_longest_is_refused_before_anything_is_read() {
        for kind in Kind::ALL {
            let length = u32::try_from(kind.longest() + 1).expect("fits").to_le_bytes();
            let bytes = stream_of([length[0], length[1], length[2], length[3], kind.byte()], &[0; 40]);
            let mut incoming = Incoming::new(&bytes[..], &Kind::ALL);
            assert!(matches!(incoming.next(), Err(Error::Oversized { kind: k, .. }) if k == kind));
            assert_eq!(incoming.payload.capacity(), 0);
        }
    }

    #[test]
    fn a_kind_of_the_other_direction_is_unknown() {
        let bytes = stream_of([0, 0, 0, 0, Kind::Close.byte()], &[]);
        let mut incoming = Incoming::new(&bytes[..], &[Kind::Event]);
        assert!(matches!(incoming.next(), Err(Error::UnknownKind(4))));
    }

    #[test]
    fn a_message_too_long_for_its_kind_is_not_sent() {
        let mut bytes = Vec::new();
        let mut outgoing = Outgoing::new(&mut bytes).expect("memory takes everything");
        let error = outgoing.send(Kind::Size, &(), &[0; 17]).expect_err("too long");
        assert!(matches!(error, Error::Oversized { kind: Kind::Size, length: 17 }));
        assert_eq!(bytes.len(), HELLO_LEN);
    }
}
