//! A place in the text that moves forward over words, braces, blank space and comments.
//!
//! A comment runs from a word that begins with `#` or `//` to the end of its line; joint names are taken as whole
//! lines before comments are looked for, so a name may hold either. Line ends are LF, CRLF and a lone CR, mixed at
//! will. DOS's end-of-file mark at the very end counts as the end.

use std::ops::Range;

/// Ends old DOS text files.
pub(super) const DOS_END_OF_FILE: u8 = 0x1a;

/// The next byte to look at.
#[derive(Clone, Copy, Debug)]
pub(super) struct Cursor<'a> {
    pub(super) text: &'a [u8],
    pub(super) at: usize,
}

impl<'a> Cursor<'a> {
    /// Starts at the first byte after a byte-order mark, if there is one.
    pub(super) fn new(text: &'a [u8]) -> Self {
        let at = if text.starts_with(b"\xef\xbb\xbf") { 3 } else { 0 };
        Self { text, at }
    }

    /// Moves to the next word, over blank space, line ends and comments; tells whether a line ended on the way.
    #[inline]
    pub(super) fn skip_space(&mut self) -> bool {
        let mut line_ended = false;
        while let Some(&byte) = self.text.get(self.at) {
            match byte {
                b' ' | b'\t' | 0x0b | 0x0c => self.at += 1,
                b'\n' | b'\r' => {
                    line_ended = true;
                    self.at += 1;
                }
                b'#' => self.at = self.line_end(),
                b'/' if self.text.get(self.at + 1) == Some(&b'/') => self.at = self.line_end(),
                DOS_END_OF_FILE if self.only_padding_follows() => self.at = self.text.len(),
                _ => break,
            }
        }
        line_ended
    }

    /// Tells whether nothing but blank space and comments was left.
    pub(super) fn is_at_end(&self) -> bool {
        self.at >= self.text.len()
    }

    /// Returns where the current line's end mark begins, or the end of the text.
    pub(super) fn line_end(&self) -> usize {
        let rest = &self.text[self.at..];
        self.at + rest.iter().position(|b| matches!(b, b'\n' | b'\r')).unwrap_or(rest.len())
    }

    /// Returns the word at the cursor without moving: a brace, or all up to blank space or a brace; empty at the end.
    pub(super) fn word_span(&self) -> Range<usize> {
        let rest = &self.text[self.at..];
        let len = match rest.first() {
            Some(b'{' | b'}') => 1,
            _ => rest.iter().position(|&b| is_space(b) || matches!(b, b'{' | b'}')).unwrap_or(rest.len()),
        };
        self.at..self.at + len
    }

    /// Moves over all that is not blank space.
    pub(super) fn skip_number(&mut self) {
        let rest = &self.text[self.at..];
        self.at += rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
    }

    /// Tells whether something other than a comment follows on this line.
    pub(super) fn has_more_on_line(mut self) -> bool {
        !self.skip_space() && !self.is_at_end()
    }

    /// Skips blank space and returns the word there without taking it.
    pub(super) fn peek(&mut self) -> &'a [u8] {
        self.skip_space();
        &self.text[self.word_span()]
    }

    /// Takes the word at the cursor if it is `keyword` in any case.
    pub(super) fn take(&mut self, keyword: &str) -> bool {
        let found = self.peek().eq_ignore_ascii_case(keyword.as_bytes());
        if found {
            self.at += keyword.len();
        }
        found
    }

    /// Takes `prefix` in any case if the next word begins with it.
    pub(super) fn take_prefix(&mut self, prefix: &str) -> bool {
        let found = self.peek().get(..prefix.len()).is_some_and(|p| p.eq_ignore_ascii_case(prefix.as_bytes()));
        if found {
            self.at += prefix.len();
        }
        found
    }

    /// Takes what stands between here and the opening brace or the end of the line, blanks at both ends left out.
    ///
    /// Blank lines before it are skipped, comments are not looked for.
    pub(super) fn take_name(&mut self) -> &'a [u8] {
        while self.text.get(self.at).is_some_and(|&b| is_space(b)) {
            self.at += 1;
        }
        let line = &self.text[self.at..self.line_end()];
        let len = line.iter().position(|&b| b == b'{').unwrap_or(line.len());
        self.at += len;
        line[..len].trim_ascii_end()
    }

    fn only_padding_follows(&self) -> bool {
        self.text[self.at..].iter().all(|&b| is_space(b) || matches!(b, DOS_END_OF_FILE | 0))
    }
}

/// Tells whether a byte separates words.
#[inline]
pub(super) fn is_space(byte: u8) -> bool {
    matches!(byte, b' ' | b'\t' | b'\n' | b'\r' | 0x0b | 0x0c)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn comments_and_line_ends_are_space() {
        let mut cursor = Cursor::new(b"\xef\xbb\xbf# one\r// two\r\n \t ROOT");
        assert!(cursor.skip_space());
        assert_eq!(cursor.peek(), b"ROOT");
    }

    #[test]
    fn dos_end_of_file_ends_only_the_end() {
        let mut cursor = Cursor::new(b" \x1a\r\n\x1a\0");
        cursor.skip_space();
        assert!(cursor.is_at_end());
        let mut cursor = Cursor::new(b" \x1a 1.0");
        cursor.skip_space();
        assert_eq!(cursor.at, 1);
    }

    #[test]
    fn a_name_ends_at_its_line_or_brace() {
        let mut cursor = Cursor::new(b" Left # Leg\t{ OFFSET");
        assert_eq!(cursor.take_name(), b"Left # Leg");
        assert_eq!(cursor.peek(), b"{");
        let mut cursor = Cursor::new(b"\n  Hips \r\n{");
        assert_eq!(cursor.take_name(), b"Hips");
    }
}
