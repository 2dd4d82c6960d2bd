//! What can be wrong with a file, and where: errors that refuse it and warnings that come with it.

use std::fmt;

use thiserror::Error;

use super::cursor::{Cursor, is_space};

/// A word of the file is shown up to this many characters.
const MAX_SHOWN: usize = 32;

/// Why a file was refused, with the place.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("{file}:{line}:{column}: expected {expected}, found {found}")]
pub struct ParseError {
    /// Name of the file as the caller gave it.
    pub file: String,
    /// Line, from 1; LF, CRLF and a lone CR end lines.
    pub line: usize,
    /// Column, from 1, in characters.
    pub column: usize,
    /// What would have been right there.
    pub expected: Expected,
    /// What stands there.
    pub found: Found,
}

/// What a reader looked for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Expected {
    /// One keyword or sign.
    Keyword(&'static str),
    /// A root joint or the motion section.
    RootOrMotion,
    /// A line of a joint's block, or its end.
    JointPart {
        /// Whether OFFSET may still come.
        offset: bool,
        /// Whether CHANNELS may still come; not after a child, as its values would come first.
        channels: bool,
    },
    /// A line of an end site's block, or its end.
    EndSitePart,
    /// `Frames:` or `Frame Time:`.
    MotionKey,
    /// A decimal number.
    Number,
    /// A number that is neither infinite nor `nan`.
    FiniteNumber,
    /// How many there are of something.
    Count,
    /// One of the six channel names.
    ChannelName,
    /// One more value of a row.
    Value {
        /// Row, from 1.
        row: usize,
        /// Value within the row, from 1.
        value: usize,
        /// Values a row has.
        n_channels: usize,
    },
    /// A new line after a complete row.
    EndOfRow {
        /// Row, from 1.
        row: usize,
        /// Values a row has.
        n_channels: usize,
    },
}

impl fmt::Display for Expected {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Keyword(word) => write!(f, "`{word}`"),
            Self::RootOrMotion => f.write_str("`ROOT` or `MOTION`"),
            Self::JointPart { offset, channels } => {
                let offset = if *offset { "`OFFSET`, " } else { "" };
                let channels = if *channels { "`CHANNELS`, " } else { "" };
                write!(f, "{offset}{channels}`JOINT`, `End Site` or `}}`")
            }
            Self::EndSitePart => f.write_str("`OFFSET` or `}`"),
            Self::MotionKey => f.write_str("`Frames:` or `Frame Time:`"),
            Self::Number => f.write_str("a number"),
            Self::FiniteNumber => f.write_str("a finite number"),
            Self::Count => f.write_str("a count"),
            Self::ChannelName => f.write_str("a channel name"),
            Self::Value { row, value, n_channels } => write!(f, "value {value} of {n_channels} in row {row}"),
            Self::EndOfRow { row, n_channels } => write!(f, "a new line after the {n_channels} values of row {row}"),
        }
    }
}

/// What a reader met instead.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Found {
    /// A word, cut to a bearable length.
    Word(String),
    /// The end of a line.
    EndOfLine,
    /// The end of the file.
    EndOfFile,
}

impl fmt::Display for Found {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        match self {
            Self::Word(word) => write!(f, "`{word}`"),
            Self::EndOfLine => f.write_str("the end of the line"),
            Self::EndOfFile => f.write_str("the end of the file"),
        }
    }
}

/// Something odd that did not keep the file from being read.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
#[error("line {line}: {kind}")]
pub struct Warning {
    /// Line, from 1.
    pub line: usize,
    /// What is odd there and what was made of it.
    pub kind: WarningKind,
}

/// What is odd about a file and what was made of it.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum WarningKind {
    /// The first keyword is missing.
    #[error("`HIERARCHY` is missing")]
    NoHierarchy,
    /// A second tree.
    #[error("another ROOT, `{name}`: the file holds several trees")]
    AnotherRoot {
        /// Name of that root.
        name: String,
    },
    /// A joint without a name.
    #[error("a joint has no name")]
    NoName,
    /// A name in another encoding.
    #[error("the name `{name}` is not UTF-8 and was read as Latin-1")]
    NameNotUtf8 {
        /// Name as it was read.
        name: String,
    },
    /// A name that an earlier joint has.
    #[error("another joint is named `{name}`")]
    SameName {
        /// The name they share.
        name: String,
    },
    /// A joint or end site without OFFSET.
    #[error("`{name}` or its end site has no OFFSET: zero is used")]
    NoOffset {
        /// Name of the joint.
        name: String,
    },
    /// A joint without CHANNELS.
    #[error("`{name}` has no CHANNELS: it does not move")]
    NoChannels {
        /// Name of the joint.
        name: String,
    },
    /// The number after CHANNELS is not the number of names.
    #[error("CHANNELS of `{name}` says {written}, but {named} are named: the names are used")]
    ChannelCount {
        /// Name of the joint.
        name: String,
        /// What the file says.
        written: u64,
        /// How many names follow.
        named: usize,
    },
    /// A second end site of one joint.
    #[error("another End Site of `{name}` is kept in the file but not shown")]
    AnotherEndSite {
        /// Name of the joint.
        name: String,
    },
    /// The file ends after the tree.
    #[error("the file has no MOTION section")]
    NoMotion,
    /// A frame count that is no count.
    #[error("`Frames:` says {written}: the rows are counted instead")]
    FrameCount {
        /// What the file says.
        written: String,
    },
    /// A frame time no clip can play with.
    #[error("`Frame Time:` is not positive")]
    FrameTime,
    /// The file ends early.
    #[error("`Frames:` says {declared}, but there are {rows} rows")]
    FewerRows {
        /// What the file says.
        declared: u64,
        /// Rows that are complete.
        rows: usize,
    },
    /// The file ends inside a row.
    #[error("the last row has {values} of {n_channels} values and is left out")]
    IncompleteRow {
        /// Values that are there.
        values: usize,
        /// Values a row has.
        n_channels: usize,
    },
    /// More follows than `Frames:` says.
    #[error("text after the {rows} rows that `Frames:` declares is kept but not read")]
    TextAfterRows {
        /// Rows that were read.
        rows: usize,
    },
    /// Rows are broken over lines.
    #[error("rows go on over several lines")]
    WrappedRows,
    /// Lines hold several rows.
    #[error("a line holds several rows")]
    RowsShareLine,
}

/// Why reading stopped, before lines are counted.
#[derive(Debug)]
pub(super) struct Failure {
    pub(super) at: usize,
    pub(super) expected: Expected,
    pub(super) found: Found,
}

impl Failure {
    /// Reports the word at the cursor, which must not be blank space.
    pub(super) fn at_word(cursor: &Cursor<'_>, expected: Expected) -> Self {
        let span = cursor.word_span();
        let found = if span.is_empty() { Found::EndOfFile } else { Found::Word(shown(&cursor.text[span])) };
        Self { at: cursor.at, expected, found }
    }

    /// Reports the word at the cursor where a number should be; braces do not end it.
    pub(super) fn at_number(cursor: &Cursor<'_>) -> Self {
        let rest = &cursor.text[cursor.at..];
        let word = &rest[..rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len())];
        let found = if word.is_empty() { Found::EndOfFile } else { Found::Word(shown(word)) };
        let is_float = fast_float2::parse::<f64, _>(word).is_ok();
        let expected = if is_float { Expected::FiniteNumber } else { Expected::Number };
        Self { at: cursor.at, expected, found }
    }

    /// Adds the file's name and turns the offset into a line and a column.
    pub(super) fn in_file(self, file: &str, text: &[u8]) -> ParseError {
        let (line, column) = line_and_column(text, self.at);
        ParseError { file: file.to_owned(), line, column, expected: self.expected, found: self.found }
    }
}

/// Makes a word of any bytes fit for a message.
fn shown(word: &[u8]) -> String {
    // No character is longer than four bytes.
    let text = String::from_utf8_lossy(&word[..word.len().min(4 * MAX_SHOWN)]);
    let mut shown: String = text.chars().take(MAX_SHOWN).flat_map(char::escape_debug).collect();
    if text.chars().nth(MAX_SHOWN).is_some() {
        shown.push('…');
    }
    shown
}

/// Returns the line and column, both from 1, of a byte offset.
fn line_and_column(text: &[u8], at: usize) -> (usize, usize) {
    let before = &text[..at.min(text.len())];
    let line_start = before.iter().rposition(|b| matches!(b, b'\n' | b'\r')).map_or(0, |i| i + 1);
    let line = &before[line_start..];
    let line = line.strip_prefix(b"\xef\xbb\xbf").unwrap_or(line);
    let column = line.iter().filter(|&&b| b & 0xc0 != 0x80).count() + 1;
    (count_line_ends(before) + 1, column)
}

/// Counts LF, CRLF and lone CR.
fn count_line_ends(text: &[u8]) -> usize {
    let returns = text.iter().filter(|&&b| b == b'\r').count();
    let line_feeds = text.iter().enumerate().filter(|&(i, &b)| b == b'\n' && (i == 0 || text[i - 1] != b'\r')).count();
    returns + line_feeds
}

/// Gives each warning its line; one pass over the text, however many there are.
pub(super) fn locate(mut warnings: Vec<(usize, WarningKind)>, text: &[u8]) -> Vec<Warning> {
    warnings.sort_by_key(|&(at, _)| at);
    let mut line = 1;
    let mut counted_to = 0;
    warnings
        .into_iter()
        .map(|(at, kind)| {
            // A CRLF is never split: warnings stand at words or at the end.
            line += count_line_ends(&text[counted_to..at]);
            counted_to = at;
            Warning { line, kind }
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_and_columns_count_from_one_in_characters() {
        let text = "\u{feff}é b\r\nc\rd\ne".as_bytes();
        let of = |needle: u8| line_and_column(text, text.iter().position(|&b| b == needle).unwrap());
        assert_eq!((of(b'b'), of(b'c'), of(b'd'), of(b'e')), ((1, 3), (2, 1), (3, 1), (4, 1)));
    }

    #[test]
    fn words_are_shown_short_and_printable() {
        assert_eq!(shown(b"a\x1b\xff"), "a\\u{1b}\u{fffd}");
        assert_eq!(shown("ä".repeat(99).as_bytes()), format!("{}…", "ä".repeat(32)));
    }
}
