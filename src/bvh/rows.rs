//! Reads the rows of numbers after `Frame Time:`.
//!
//! Values are taken in order, a row being as many as there are channels. In a sound file each row is one line. Rows
//! that run over lines, and lines that hold several rows, are read as well where the line ends leave no doubt; a line
//! with a value too many or too few is refused, because everything after it would be read shifted.
//!
//! ```text
//! … Frame Time: 0.0333⏎   1.0 2.0 3.0 ⏎   4.0 5.0 6.0⏎   and what follows
//!                         └── row 0 ─┘    └── row 1 ─┘└────── tail ──────
//! ```

use std::ops::Range;

use super::{
    cursor::Cursor,
    error::{Expected, Failure, Found, WarningKind},
    number::number,
};

/// Values and where their rows stand in the text.
#[derive(Default)]
pub(super) struct Rows {
    /// Rows × channels.
    pub(super) values: Vec<f64>,
    /// From a row's first value to its last, in bytes.
    pub(super) spans: Vec<Range<usize>>,
}

/// Reads as many rows as are declared, or all that there are, and warns of what is odd.
pub(super) fn rows(
    cursor: &mut Cursor<'_>,
    n_channels: usize,
    declared: Option<u64>,
    warnings: &mut Vec<(usize, WarningKind)>,
) -> Result<Rows, Failure> {
    let start = *cursor;
    let mut rows = Rows::with_room(cursor.text.len() - start.at, n_channels, declared);
    let layout = rows.read(cursor, n_channels, declared)?;

    let after_rows = Cursor { text: cursor.text, at: rows.spans.last().map_or(start.at, |row| row.end) };
    let line_goes_on = !rows.spans.is_empty() && after_rows.has_more_on_line();
    if layout.row_inside_line.is_some() || line_goes_on {
        let lines = Lines { start, end: after_rows.line_end(), n_channels };
        if let Err(failure) = lines.check() {
            let fits = declared == Some(rows.spans.len() as u64) && !line_goes_on && !lines.any_is_a_row();
            if !fits {
                return Err(failure);
            }
        }
    }
    if let Some(at) = layout.row_inside_line {
        warnings.push((at, WarningKind::RowsShareLine));
    }
    if let Some(at) = layout.line_end_inside_row {
        warnings.push((at, WarningKind::WrappedRows));
    }
    if layout.left_over > 0 {
        warnings.push((cursor.text.len(), WarningKind::IncompleteRow { values: layout.left_over, n_channels }));
    }
    warn_of_count(after_rows, rows.spans.len(), declared, warnings);
    Ok(rows)
}

/// What the first pass noticed.
#[derive(Default)]
struct Layout {
    /// First value of a row that does not begin its line.
    row_inside_line: Option<usize>,
    /// First value of a line that does not begin its row.
    line_end_inside_row: Option<usize>,
    /// Values of a row that the end of the file cut short.
    left_over: usize,
}

impl Rows {
    /// Reserves for what is declared, but never more than the bytes there could hold: two for each value.
    fn with_room(n_bytes: usize, n_channels: usize, declared: Option<u64>) -> Self {
        let most_rows = (n_bytes / 2 + 1).checked_div(n_channels).unwrap_or(0);
        let n_rows = declared.and_then(|d| usize::try_from(d).ok()).map_or(most_rows, |d| d.min(most_rows));
        Self { values: Vec::with_capacity(n_rows * n_channels), spans: Vec::with_capacity(n_rows) }
    }

    fn read(&mut self, cursor: &mut Cursor<'_>, n_channels: usize, declared: Option<u64>) -> Result<Layout, Failure> {
        let mut layout = Layout::default();
        if n_channels == 0 {
            return Ok(layout);
        }
        while declared.is_none_or(|d| (self.spans.len() as u64) < d) {
            let begins_line = cursor.skip_space() || self.spans.is_empty();
            let row_start = cursor.at;
            if !begins_line && !cursor.is_at_end() {
                layout.row_inside_line.get_or_insert(row_start);
            }
            let n_read = self.read_row(cursor, n_channels, &mut layout)?;
            if n_read < n_channels {
                self.values.truncate(self.spans.len() * n_channels);
                layout.left_over = n_read;
                break;
            }
            self.spans.push(row_start..cursor.at);
        }
        Ok(layout)
    }

    /// Reads one row's values; returns how many there were before the text ended.
    #[inline]
    fn read_row(&mut self, cursor: &mut Cursor<'_>, n_channels: usize, layout: &mut Layout) -> Result<usize, Failure> {
        for n_read in 0..n_channels {
            let line_ended = cursor.skip_space();
            if cursor.is_at_end() {
                return Ok(n_read);
            }
            if line_ended {
                layout.line_end_inside_row.get_or_insert(cursor.at);
            }
            let (value, end) = number(cursor.text, cursor.at).ok_or_else(|| Failure::at_number(cursor))?;
            self.values.push(value);
            cursor.at = end;
        }
        Ok(n_channels)
    }
}

/// Adds what is to be said about the number of rows.
fn warn_of_count(
    mut after_rows: Cursor<'_>,
    rows: usize,
    declared: Option<u64>,
    warnings: &mut Vec<(usize, WarningKind)>,
) {
    let Some(declared) = declared else { return };
    if (rows as u64) < declared {
        warnings.push((after_rows.text.len(), WarningKind::FewerRows { declared, rows }));
        return;
    }
    after_rows.skip_space();
    if !after_rows.is_at_end() {
        warnings.push((after_rows.at, WarningKind::TextAfterRows { rows }));
    }
}

/// The lines that rows were read from, looked at again when rows and lines do not agree.
#[derive(Clone, Copy)]
struct Lines<'a> {
    start: Cursor<'a>,
    end: usize,
    n_channels: usize,
}

impl<'a> Lines<'a> {
    /// Returns, for each line that holds any, the first bytes of its words.
    fn words(self) -> impl Iterator<Item = Vec<usize>> + use<'a> {
        let mut cursor = self.start;
        std::iter::from_fn(move || {
            let mut words = Vec::new();
            while (!cursor.skip_space() || words.is_empty()) && cursor.at < self.end {
                words.push(cursor.at);
                cursor.skip_number();
            }
            (!words.is_empty()).then_some(words)
        })
    }

    /// Checks that each line holds whole rows, or that several lines together hold one.
    fn check(self) -> Result<(), Failure> {
        let n_channels = self.n_channels;
        let mut rows_done = 0;
        let mut pending = 0;
        let mut previous_line_end = self.start.at;
        for words in self.words() {
            let n_words = words.len();
            if pending > 0 && pending + n_words > n_channels {
                let expected = Expected::Value { row: rows_done + 1, value: pending + 1, n_channels };
                return Err(Failure { at: previous_line_end, expected, found: Found::EndOfLine });
            }
            if pending == 0 && n_words > n_channels && n_words % n_channels != 0 {
                let n_rows = n_words / n_channels;
                let extra = Cursor { text: self.start.text, at: words[n_rows * n_channels] };
                let expected = Expected::EndOfRow { row: rows_done + n_rows, n_channels };
                return Err(Failure::at_word(&extra, expected));
            }
            rows_done += (pending + n_words) / n_channels;
            pending = (pending + n_words) % n_channels;
            previous_line_end = Cursor { text: self.start.text, at: words[n_words - 1] }.line_end();
        }
        Ok(())
    }

    /// Tells whether any line holds exactly one row, so that in this file a line means a row.
    fn any_is_a_row(self) -> bool {
        self.words().any(|words| words.len() == self.n_channels)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Reads rows of three values; gives them with the warnings, or the error, as text.
    fn check(text: &str, declared: Option<u64>, expected: &str) {
        let mut warnings = Vec::new();
        let mut cursor = Cursor::new(text.as_bytes());
        let found = match rows(&mut cursor, 3, declared, &mut warnings) {
            Ok(rows) => {
                let warnings: Vec<_> = warnings.iter().map(|(_, kind)| format!("; {kind}")).collect();
                format!("{} rows{}", rows.spans.len(), warnings.concat())
            }
            Err(failure) => format!("{}: expected {}, found {}", failure.at, failure.expected, failure.found),
        };
        assert_eq!(found, expected, "{text:?}");
    }

    #[test]
    fn lines_mean_rows_where_any_line_is_one() {
        check("\n1 2 3\n4 5 6\n", Some(2), "2 rows");
        check("1 2 3\n4 5 6 7\n7 8 9\n", Some(3), "12: expected a new line after the 3 values of row 2, found `7`");
        check("1 2 3\n4 5\n7 8 9\n", Some(3), "9: expected value 3 of 3 in row 2, found the end of the line");
        check("1 2 3\n4 5 6 7", Some(2), "12: expected a new line after the 3 values of row 2, found `7`");
        check("1 2 3\n4 5 6 7\n8 9\n", Some(3), "12: expected a new line after the 3 values of row 2, found `7`");
    }

    #[test]
    fn rows_wrap_where_line_ends_leave_no_doubt() {
        check("1 2\n3\n4\n5 6\n", Some(2), "2 rows; rows go on over several lines");
        check("1 2 3 4 5 6\n7 8 9", Some(3), "3 rows; a line holds several rows");
        let both = "3 rows; a line holds several rows; rows go on over several lines";
        check("1 2 3 4\n5 6 7 8\n9\n", Some(3), both);
        check("1 2 3 4\n5 6 7 8\n9\n", None, "6: expected a new line after the 3 values of row 1, found `4`");
    }

    #[test]
    fn counts_that_differ_from_the_declared_one_are_told() {
        let fewer = "1 rows; the last row has 2 of 3 values and is left out; `Frames:` says 9, but there are 1 rows";
        check("1 2 3\n4 5", Some(9), fewer);
        let more = "1 rows; text after the 1 rows that `Frames:` declares is kept but not read";
        check("1 2 3\n4 5 6", Some(1), more);
        check("1 2 3\nword", Some(1), more);
        check("1 2 3\nword", Some(2), "6: expected a number, found `word`");
        check("1 2 3 # note\n\x1a", Some(1), "1 rows");
    }

    #[test]
    fn a_huge_count_reserves_no_more_than_the_text_could_hold() {
        let rows = Rows::with_room(100, 3, Some(u64::MAX));
        assert!(rows.values.capacity() < 200, "{}", rows.values.capacity());
    }
}
