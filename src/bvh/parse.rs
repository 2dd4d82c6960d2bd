//! Bytes to [`Bvh`]: the tree, the two lines that open the motion, the rows.

use std::{ops::Range, sync::Arc};

use super::{
    Bvh, ParseError,
    cursor::Cursor,
    error::{Expected, Failure, WarningKind, locate},
    hierarchy::{Hierarchy, header_number, hierarchy},
    rows::{Rows, rows},
};

impl Bvh {
    /// Reads a file's bytes; `file_name` is for messages only.
    ///
    /// What is odd but leaves no doubt is read and listed in [`Bvh::warnings`]. Depth, counts and lengths that the
    /// file claims cost nothing until the bytes for them are there.
    ///
    /// # Errors
    ///
    /// The first place where the text cannot be read, or could be read in two ways.
    pub fn parse(bytes: impl Into<Arc<[u8]>>, file_name: &str) -> Result<Self, ParseError> {
        let text: Arc<[u8]> = bytes.into();
        match read(&text) {
            Ok(parts) => Ok(parts.with_text(text)),
            Err(failure) => Err(failure.in_file(file_name, &text)),
        }
    }
}

/// All that is read, before it is joined with its text.
struct Parts {
    hierarchy: Hierarchy,
    motion: MotionHeader,
    rows: Rows,
    warnings: Vec<(usize, WarningKind)>,
}

impl Parts {
    fn with_text(self, text: Arc<[u8]>) -> Bvh {
        Bvh {
            warnings: locate(self.warnings, &text),
            text,
            joints: self.hierarchy.joints,
            n_channels: self.hierarchy.n_channels,
            declared_frames: self.motion.declared,
            frame_count_span: self.motion.frame_count_span,
            frame_time_secs: self.motion.frame_time_secs,
            rows_from: self.motion.end,
            values: Arc::new(self.rows.values),
            row_spans: self.rows.spans,
        }
    }
}

fn read(text: &[u8]) -> Result<Parts, Failure> {
    let mut cursor = Cursor::new(text);
    let mut warnings = Vec::new();
    let hierarchy = hierarchy(&mut cursor, &mut warnings)?;
    if !hierarchy.has_motion {
        warnings.push((text.len(), WarningKind::NoMotion));
        return Ok(Parts { hierarchy, motion: MotionHeader::default(), rows: Rows::default(), warnings });
    }
    let motion = motion_header(&mut cursor, &mut warnings)?;
    let rows = rows(&mut cursor, hierarchy.n_channels, motion.declared, &mut warnings)?;
    Ok(Parts { hierarchy, motion, rows, warnings })
}

/// `Frames:` and `Frame Time:`.
#[derive(Default)]
struct MotionHeader {
    /// None when it is no count.
    declared: Option<u64>,
    /// The number after `Frames:` in the text.
    frame_count_span: Range<usize>,
    frame_time_secs: f64,
    /// Where the later of the two numbers ends.
    end: usize,
}

/// Reads the two keys in either order.
fn motion_header(cursor: &mut Cursor<'_>, warnings: &mut Vec<(usize, WarningKind)>) -> Result<MotionHeader, Failure> {
    let mut header = MotionHeader::default();
    let (mut has_frames, mut has_time) = (false, false);
    while !(has_frames && has_time) {
        if !has_frames && cursor.take_prefix("Frames") {
            take_colon(cursor);
            header.frame_count(cursor, warnings)?;
            has_frames = true;
        } else if !has_time && cursor.take_prefix("Frame") {
            if !cursor.take_prefix("Time") {
                return Err(Failure::at_word(cursor, Expected::Keyword("Time:")));
            }
            take_colon(cursor);
            header.frame_time(cursor, warnings)?;
            has_time = true;
        } else {
            cursor.skip_space();
            let expected = match (has_frames, has_time) {
                (false, false) => Expected::MotionKey,
                (true, _) => Expected::Keyword("Frame Time:"),
                (_, true) => Expected::Keyword("Frames:"),
            };
            return Err(Failure::at_word(cursor, expected));
        }
    }
    header.end = cursor.at;
    Ok(header)
}

/// Nothing else can follow, so a missing colon leaves no doubt.
fn take_colon(cursor: &mut Cursor<'_>) {
    cursor.take_prefix(":");
}

impl MotionHeader {
    fn frame_count(
        &mut self,
        cursor: &mut Cursor<'_>,
        warnings: &mut Vec<(usize, WarningKind)>,
    ) -> Result<(), Failure> {
        cursor.skip_space();
        let at = cursor.at;
        let value = header_number(cursor)?;
        self.frame_count_span = at..cursor.at;
        if value >= 0.0 && value.fract() == 0.0 {
            // Saturates, as no text is that long.
            self.declared = Some(value as u64);
        } else {
            let written = String::from_utf8_lossy(&cursor.text[at..cursor.at]).into_owned();
            warnings.push((at, WarningKind::FrameCount { written }));
        }
        Ok(())
    }

    fn frame_time(&mut self, cursor: &mut Cursor<'_>, warnings: &mut Vec<(usize, WarningKind)>) -> Result<(), Failure> {
        cursor.skip_space();
        let at = cursor.at;
        self.frame_time_secs = header_number(cursor)?;
        if self.frame_time_secs <= 0.0 {
            warnings.push((at, WarningKind::FrameTime));
        }
        Ok(())
    }
}
