//! A file without rows gets one, so that rows can be written: every channel 0.

use std::{io::Write as _, sync::Arc};

use super::{
    Bvh,
    cursor::{Cursor, DOS_END_OF_FILE},
    write::ends_line,
};

impl Bvh {
    /// Returns the file with one row of zeros in place of the none it has; a MOTION section is added where there is
    /// none, with this frame time.
    ///
    /// Everything before the row is kept, but for the number after `Frames:`. What follows `Frame Time:` and is no row
    /// (rows that `Frames: 0` declares away, the beginning of a row) is left out. Nothing can be written to a file
    /// without channels: none.
    ///
    /// # Panics
    ///
    /// When the file has rows.
    pub fn with_row_of_zeros(&self, frame_time_secs: f64) -> Option<Self> {
        assert!(self.row_spans.is_empty(), "only a file without rows gets one");
        if self.n_channels == 0 {
            return None;
        }
        let line_end = self.line_end_mark();
        let mut text = Vec::with_capacity(self.text.len() + 2 * self.n_channels + 64);
        let (frame_count_at, rows_from);
        let frame_time_secs = if self.has_motion() {
            frame_count_at = self.frame_count_span.start;
            text.extend_from_slice(&self.text[..frame_count_at]);
            text.push(b'1');
            text.extend_from_slice(&self.text[self.frame_count_span.end..self.rows_from]);
            rows_from = text.len();
            text.extend_from_slice(self.rest_of_header_line());
            self.frame_time_secs
        } else {
            text.extend_from_slice(self.without_end_mark());
            if !ends_line(&text) {
                text.extend_from_slice(line_end);
            }
            text.extend_from_slice(b"MOTION");
            text.extend_from_slice(line_end);
            text.extend_from_slice(b"Frames: ");
            frame_count_at = text.len();
            text.push(b'1');
            text.extend_from_slice(line_end);
            write!(text, "Frame Time: {frame_time_secs}").expect("writing to memory");
            rows_from = text.len();
            frame_time_secs
        };
        text.extend_from_slice(line_end);
        let row_start = text.len();
        text.extend_from_slice("0 ".repeat(self.n_channels).trim_end().as_bytes());
        let row_end = text.len();
        text.extend_from_slice(line_end);
        Some(Self {
            text: Arc::from(text),
            joints: self.joints.clone(),
            n_channels: self.n_channels,
            declared_frames: Some(1),
            frame_count_span: frame_count_at..frame_count_at + 1,
            frame_time_secs,
            rows_from,
            values: Arc::new(vec![0.0; self.n_channels]),
            row_spans: std::iter::once(row_start..row_end).collect(),
            warnings: Vec::new(),
        })
    }

    /// The line of the later of `Frames:` and `Frame Time:`, after its number: blanks or a comment, but no values.
    fn rest_of_header_line(&self) -> &[u8] {
        let after = Cursor { text: &self.text, at: self.rows_from };
        if after.has_more_on_line() {
            return &[];
        }
        let rest = &self.text[self.rows_from..after.line_end()];
        let end = rest.iter().position(|&b| b == DOS_END_OF_FILE);
        &rest[..end.unwrap_or(rest.len())]
    }

    /// The text up to the mark that ended old DOS files, if there is one at the end.
    fn without_end_mark(&self) -> &[u8] {
        let is_padding = |b: &u8| matches!(*b, DOS_END_OF_FILE | 0);
        let end = self.text.iter().rposition(|b| !is_padding(b) && !b.is_ascii_whitespace()).map_or(0, |at| at + 1);
        let padding = self.text[end..].iter().position(is_padding);
        &self.text[..padding.map_or(self.text.len(), |at| end + at)]
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Checks what a file without rows becomes, and that it is read as what it is taken for.
    fn check(motion: &str, expected: &str) {
        let head = "HIERARCHY\nROOT a\n{\nOFFSET 0 1 0\nCHANNELS 2 Xposition Yrotation\n}";
        let bvh = Bvh::parse(format!("{head}{motion}").into_bytes(), "zeros").unwrap_or_else(|e| panic!("{e}"));
        let made = bvh.with_row_of_zeros(0.025).expect("it has channels");
        assert_eq!(String::from_utf8_lossy(made.text()), format!("{head}{expected}"), "{motion:?}");
        let read = Bvh::parse(Arc::clone(made.text()), "made").unwrap_or_else(|e| panic!("{motion:?}: {e}"));
        assert_eq!((read.values(), &read.row_spans), (made.values(), &made.row_spans));
        assert_eq!((read.rows_from, &read.frame_count_span), (made.rows_from, &made.frame_count_span));
        assert_eq!((read.declared_frames, read.frame_time_secs), (made.declared_frames, made.frame_time_secs));
        assert!(read.warnings().is_empty() || read.frame_time_secs <= 0.0, "{:?}", read.warnings());
    }

    #[test]
    fn what_is_missing_is_added_and_the_rest_stays() {
        check("", "\nMOTION\nFrames: 1\nFrame Time: 0.025\n0 0\n");
        check("\n# end\n\n\x1a\0", "\n# end\n\nMOTION\nFrames: 1\nFrame Time: 0.025\n0 0\n");
        check("\nMOTION\nFrames: 0\nFrame Time: 0.5\n", "\nMOTION\nFrames: 1\nFrame Time: 0.5\n0 0\n");
        check("\nMOTION\nFrame Time: .5\nFrames:\t00", "\nMOTION\nFrame Time: .5\nFrames:\t1\n0 0\n");
        check("\nMOTION\nFrames: 0\nFrame Time: 0\n1 2\n3 4\n", "\nMOTION\nFrames: 1\nFrame Time: 0\n0 0\n");
        check("\nMOTION\nFrames: 0\nFrame Time: 1 # s\x1a", "\nMOTION\nFrames: 1\nFrame Time: 1 # s\n0 0\n");
        check("\nMOTION\nFrames: 7\nFrame Time: 1 3", "\nMOTION\nFrames: 1\nFrame Time: 1\n0 0\n");
    }

    #[test]
    fn without_channels_there_is_no_row() {
        let bvh = Bvh::parse(b"HIERARCHY\nROOT a\n{\nOFFSET 0 1 0\n}".to_vec(), "none").expect("it reads");
        assert!(bvh.with_row_of_zeros(0.1).is_none());
    }
}
