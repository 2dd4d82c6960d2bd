//! Writing is copying: only channels that changed are printed anew.
//!
//! Between the characters of two rows stands a *gap*: the first row's tail up to its line end, blank lines, and the
//! second row's lead. Rows that follow each other in the source keep their whole gap; where the order changes, the
//! tail of one and the lead of the other are put together.

use std::{fmt::Write as _, io::Write as _, ops::Range};

use super::{
    Bvh, Channel,
    cursor::{Cursor, DOS_END_OF_FILE},
};

/// One row to write: the source row it copies, and what is different.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RowEdit<'a> {
    /// Row of the file, from 0.
    pub source_row: usize,
    /// Channels with their new values (degrees, the file's unit), in rising order of channel. A value equal to the
    /// source's leaves the source's characters.
    pub changed: &'a [(usize, f64)],
}

/// Decimals of the numbers that are printed anew.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Digits {
    /// Decimals of positions.
    pub position_decimals: usize,
    /// Decimals of rotations.
    pub rotation_decimals: usize,
}

impl Bvh {
    /// Writes the file with these rows in the place of its own.
    ///
    /// All source rows in order and unchanged give the source's bytes. The number after `Frames:` changes only when
    /// the number of rows does. Rows may repeat, be left out or change places; text after the last row is kept only
    /// when each row stands where it stood.
    ///
    /// # Panics
    ///
    /// When a row or a channel does not exist, channels are out of order, or a value is not finite.
    pub fn write_rows(&self, rows: &[RowEdit<'_>], digits: Digits) -> Vec<u8> {
        let mut out = Vec::with_capacity(self.text.len());
        if rows.len() == self.n_frames() {
            out.extend_from_slice(&self.text[..self.rows_start()]);
        } else {
            out.extend_from_slice(&self.text[..self.frame_count_span.start]);
            write!(out, "{}", rows.len()).expect("writing to memory");
            out.extend_from_slice(&self.text[self.frame_count_span.end..self.rows_start()]);
        }
        let in_place = rows.len() == self.n_frames() && rows.iter().enumerate().all(|(i, row)| row.source_row == i);
        let decimals = self.channel_decimals(digits);
        for (i, row) in rows.iter().enumerate() {
            let source_row = row.source_row;
            if i == 0 {
                out.extend_from_slice(&self.text[self.lead(source_row)]);
            }
            self.write_row(&mut out, row, &decimals);
            match rows.get(i + 1) {
                None if in_place => out.extend_from_slice(&self.text[self.row_spans[source_row].end..]),
                None => self.write_last_tail(&mut out, source_row),
                Some(next) if in_place || self.is_followed_by(source_row, next.source_row) => {
                    out.extend_from_slice(&self.text[self.gap_after(source_row)]);
                }
                Some(next) => {
                    self.write_ended_tail(&mut out, source_row);
                    out.extend_from_slice(&self.text[self.lead(next.source_row)]);
                }
            }
        }
        out
    }

    /// The row's own characters, with the changed values in their places.
    fn write_row(&self, out: &mut Vec<u8>, row: &RowEdit<'_>, decimals: &[usize]) {
        let source = self.frame(row.source_row);
        let span = self.row_spans[row.source_row].clone();
        let mut words = Words { cursor: Cursor { text: &self.text[..span.end], at: span.start }, n_taken: 0 };
        let mut copied_to = span.start;
        let mut number = String::new();
        for &(channel, value) in row.changed {
            assert!(value.is_finite(), "a channel is a finite number");
            let word = words.nth_channel(channel);
            if value.to_bits() == source[channel].to_bits() {
                continue;
            }
            out.extend_from_slice(&self.text[copied_to..word.start]);
            print(&mut number, value, decimals[channel]);
            out.extend_from_slice(number.as_bytes());
            copied_to = word.end;
        }
        out.extend_from_slice(&self.text[copied_to..span.end]);
    }

    /// Ends the last row as the file ends its last row.
    fn write_last_tail(&self, out: &mut Vec<u8>, row: usize) {
        if ends_line(&self.text[self.tail(self.n_frames() - 1)]) {
            self.write_ended_tail(out, row);
        } else {
            out.extend_from_slice(trim_line_end(&self.text[self.tail(row)]));
        }
    }

    /// The row's tail, with a line end if it has none, so that the next row begins a line.
    fn write_ended_tail(&self, out: &mut Vec<u8>, row: usize) {
        let tail = &self.text[self.tail(row)];
        out.extend_from_slice(tail);
        if !ends_line(tail) {
            out.extend_from_slice(self.line_end_mark());
        }
    }

    /// Tells whether `next` comes after `row` in the source, on a line of its own.
    fn is_followed_by(&self, row: usize, next: usize) -> bool {
        next == row + 1 && ends_line(&self.text[self.tail(row)])
    }

    fn channel_decimals(&self, digits: Digits) -> Vec<usize> {
        let of = |channel: &Channel| {
            if channel.is_position() { digits.position_decimals } else { digits.rotation_decimals }
        };
        // Joints are in the order of the header, and so are their channels.
        self.joints.iter().flat_map(|joint| &joint.channels).map(of).collect()
    }

    /// Where the lead of the first row begins; the end of the text when there are no rows.
    fn rows_start(&self) -> usize {
        if self.row_spans.is_empty() { self.text.len() } else { self.lead(0).start }
    }

    /// Between a row and its successor in the source.
    fn gap_after(&self, row: usize) -> Range<usize> {
        self.row_spans[row].end..self.row_spans[row + 1].start
    }

    /// From the line's start to the row's first value; empty when an earlier row is on that line.
    fn lead(&self, row: usize) -> Range<usize> {
        let start = self.row_spans[row].start;
        let from = if row == 0 { self.rows_from } else { self.row_spans[row - 1].end };
        let line_end = self.text[from..start].iter().rposition(|b| matches!(b, b'\n' | b'\r'));
        line_end.map_or(start, |i| from + i + 1)..start
    }

    /// From the row's last value to the end of its line, the line end included, or to the next word on that line.
    fn tail(&self, row: usize) -> Range<usize> {
        let end = self.row_spans[row].end;
        let mut next_word = Cursor { text: &self.text, at: end };
        if !next_word.skip_space() && !next_word.is_at_end() {
            return end..next_word.at;
        }
        let line_end = Cursor { text: &self.text, at: end }.line_end();
        if let Some(mark) = self.text[end..line_end].iter().position(|&b| b == DOS_END_OF_FILE) {
            return end..end + mark;
        }
        let mark_len = match self.text[line_end..] {
            [b'\r', b'\n', ..] => 2,
            [_, ..] => 1,
            [] => 0,
        };
        end..line_end + mark_len
    }

    /// The line end that the file uses first.
    pub(super) fn line_end_mark(&self) -> &[u8] {
        let start = Cursor { text: &self.text, at: 0 }.line_end();
        match self.text[start..] {
            [b'\r', b'\n', ..] => b"\r\n",
            [b'\r', ..] => b"\r",
            _ => b"\n",
        }
    }
}

/// The words of one row, taken from left to right.
struct Words<'a> {
    cursor: Cursor<'a>,
    n_taken: usize,
}

impl Words<'_> {
    /// Returns where channel `channel` stands; each call must ask for a later one.
    fn nth_channel(&mut self, channel: usize) -> Range<usize> {
        assert!(channel >= self.n_taken, "changed channels are in rising order");
        loop {
            self.cursor.skip_space();
            let start = self.cursor.at;
            assert!(!self.cursor.is_at_end(), "the row has that channel");
            self.cursor.skip_number();
            self.n_taken += 1;
            if self.n_taken > channel {
                return start..self.cursor.at;
            }
        }
    }
}

pub(super) fn ends_line(tail: &[u8]) -> bool {
    matches!(tail.last(), Some(b'\n' | b'\r'))
}

fn trim_line_end(tail: &[u8]) -> &[u8] {
    tail.strip_suffix(b"\r\n").or(tail.strip_suffix(b"\n")).or(tail.strip_suffix(b"\r")).unwrap_or(tail)
}

/// Prints with a fixed number of decimals; what rounds to zero has no sign.
fn print(out: &mut String, value: f64, decimals: usize) {
    out.clear();
    write!(out, "{value:.decimals$}").expect("writing to memory");
    if out.starts_with('-') && out.bytes().all(|b| matches!(b, b'-' | b'0' | b'.')) {
        out.remove(0);
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zero_has_no_sign() {
        let mut out = String::new();
        for (value, decimals, expected) in
            [(-0.0, 6, "0.000000"), (-4e-7, 6, "0.000000"), (-6e-7, 6, "-0.000001"), (-0.4, 0, "0"), (1.5, 2, "1.50")]
        {
            print(&mut out, value, decimals);
            assert_eq!(out, expected);
        }
    }
}
