//! A line being typed: a value, coordinates, a file name, a yes or no.

use std::path::PathBuf;

use glam::DVec3;

use crate::key::{Code, Key};

/// Decimals beyond which rounding is not tried: those that a number of size 1 has.
const MOST_DECIMALS: usize = 17;

/// Characters from which on a number is written with a power of ten.
const LONGEST: usize = 24;

/// What is being asked for.
#[derive(Clone, Debug, PartialEq)]
pub enum Asking {
    /// A value for this parameter.
    Value {
        /// The parameter.
        name: &'static str,
    },
    /// `NAME=VALUE` for any parameter.
    Assignment,
    /// `x y z` for a control point.
    Coordinates {
        /// The control point.
        point_idx: usize,
    },
    /// The name of a layer.
    LayerName {
        /// Its place in the list.
        layer_idx: usize,
    },
    /// `x y z` for the joint that keys move.
    MoveJoint {
        /// Its name.
        name: String,
    },
    /// Angles about x, y, z for it.
    TurnJoint {
        /// Its name.
        name: String,
    },
    /// The frame that the selected maps' keys at a frame move to.
    MoveKeys {
        /// File frame where they are.
        from: usize,
    },
    /// The frame that they are copied to.
    CopyKeys {
        /// File frame where they are.
        from: usize,
    },
    /// The project file to save to.
    Save,
    /// The BVH file to export to.
    Export {
        /// As it is played between interpolation keys.
        interpolated: bool,
    },
    /// Whether this file may be replaced by the project.
    OverwriteSave(PathBuf),
    /// Whether this file may be replaced by the clip.
    OverwriteExport {
        /// The file.
        file: PathBuf,
        /// As it is played between interpolation keys.
        interpolated: bool,
    },
    /// Whether to leave with unsaved edits.
    Quit,
}

/// A line being typed, with a cursor.
#[derive(Clone, Debug, PartialEq)]
pub struct Prompt {
    /// What is being asked for.
    pub asking: Asking,
    /// The text so far.
    pub text: String,
    /// Cursor, counted in characters from the start of the text.
    pub cursor: usize,
    /// The text is the one offered; the first character typed replaces it.
    offered: bool,
    /// The text offered first.
    first_offered: String,
}

/// What a key did to the line.
#[derive(Clone, Debug, PartialEq)]
pub(super) enum Answer {
    /// Still typing.
    Typing,
    /// The line was given up.
    Left,
    /// The line is finished.
    Given(String),
}

impl Prompt {
    /// Begins a line with an offered text.
    pub fn new(asking: Asking, offered: &str) -> Self {
        Self {
            asking,
            text: offered.to_owned(),
            cursor: offered.chars().count(),
            offered: !offered.is_empty(),
            first_offered: offered.to_owned(),
        }
    }

    /// Returns what stands before the line.
    pub fn title(&self) -> String {
        match &self.asking {
            Asking::Value { name } => format!("{name} ="),
            Asking::Assignment => "set NAME=VALUE:".to_owned(),
            Asking::Coordinates { point_idx } => format!("point {} x y z:", point_idx + 1),
            Asking::LayerName { .. } => "name of the layer:".to_owned(),
            Asking::MoveJoint { name } => format!("{name} x y z:"),
            Asking::TurnJoint { name } => format!("turn {name} about x y z, degrees:"),
            Asking::MoveKeys { from } => format!("move the keys of file frame {from} to:"),
            Asking::CopyKeys { from } => format!("copy the keys of file frame {from} to:"),
            Asking::Save => "save project as:".to_owned(),
            Asking::Export { interpolated: false } => "export BVH to:".to_owned(),
            Asking::Export { interpolated: true } => "export BVH, interpolation included, to:".to_owned(),
            Asking::OverwriteSave(file) | Asking::OverwriteExport { file, .. } => {
                format!("{} exists; replace it? (y/n)", file.display())
            }
            Asking::Quit => "quit without saving the project? (y/n)".to_owned(),
        }
    }

    /// Returns the line ready to be corrected.
    pub(super) fn again(self) -> Self {
        Self { offered: false, cursor: self.text.chars().count(), ..self }
    }

    /// Tells whether the line is about a value and says what it said when it was offered: then the value stays as it
    /// is, to the last digit.
    pub(super) fn keeps(&self) -> bool {
        let is_value =
            matches!(self.asking, Asking::Value { .. } | Asking::Coordinates { .. } | Asking::MoveJoint { .. });
        is_value && self.text == self.first_offered
    }

    fn is_yes_no(&self) -> bool {
        matches!(self.asking, Asking::Quit | Asking::OverwriteSave(_) | Asking::OverwriteExport { .. })
    }

    pub(super) fn key(&mut self, key: Key) -> Answer {
        let length = self.text.chars().count();
        let offered = std::mem::replace(&mut self.offered, false);
        match key.code {
            Code::Esc => return Answer::Left,
            Code::Char('c' | 'g') if key.ctrl => return Answer::Left,
            Code::Enter => return Answer::Given(self.text.clone()),
            Code::Char(c) if self.is_yes_no() => return Answer::Given(c.to_lowercase().to_string()),
            Code::Char('u') if key.ctrl => (self.text, self.cursor) = (String::new(), 0),
            Code::Char(c) if !key.ctrl && !key.alt => {
                if offered {
                    (self.text, self.cursor) = (String::new(), 0);
                }
                self.insert_char(c);
            }
            Code::Backspace if self.cursor > 0 => {
                self.cursor -= 1;
                self.text.remove(self.byte(self.cursor));
            }
            Code::Delete if self.cursor < length => {
                self.text.remove(self.byte(self.cursor));
            }
            Code::Left => self.cursor = self.cursor.saturating_sub(1),
            Code::Right => self.cursor = (self.cursor + 1).min(length),
            Code::Home => self.cursor = 0,
            Code::End => self.cursor = length,
            _ => {}
        }
        Answer::Typing
    }

    /// Inserts a text at the cursor, its control characters dropped.
    pub(super) fn insert(&mut self, text: &str) {
        self.offered = false;
        text.chars().filter(|c| !c.is_control()).for_each(|c| self.insert_char(c));
    }

    fn insert_char(&mut self, c: char) {
        self.text.insert(self.byte(self.cursor), c);
        self.cursor += 1;
    }

    /// Byte offset of a character index.
    fn byte(&self, char_idx: usize) -> usize {
        self.text.char_indices().nth(char_idx).map_or(self.text.len(), |(at, _)| at)
    }
}

/// Writes `x y z` with as few digits as change no coordinate by more than `tolerance`.
pub(super) fn coordinates(v: DVec3, tolerance: f64) -> String {
    v.to_array().map(|n| shortest(n, tolerance)).join(" ")
}

/// Writes a number that is no farther than this from `n`, in few characters.
fn shortest(n: f64, tolerance: f64) -> String {
    if n.abs() <= tolerance {
        return "0".to_owned();
    }
    let is_near = |text: &String| text.parse::<f64>().is_ok_and(|read| (read - n).abs() <= tolerance);
    let rounded = (0..=MOST_DECIMALS).map(|decimals| format!("{n:.decimals$}")).find(is_near);
    let exact = n.to_string();
    match rounded {
        Some(text) if text.len() < exact.len() => text,
        // All digits before the point are written: hundreds, of huge numbers.
        _ if exact.len() > LONGEST => format!("{n:e}"),
        _ => exact,
    }
}

/// Reads `x y z`, with spaces or commas, with or without brackets.
pub(super) fn parse_coordinates(text: &str) -> Option<DVec3> {
    let text = text.trim().trim_start_matches('[').trim_end_matches(']');
    let mut numbers = text.split([',', ' ', ';']).filter(|t| !t.is_empty()).map(|t| t.parse::<f64>().ok());
    let v = DVec3::new(numbers.next()??, numbers.next()??, numbers.next()??);
    (numbers.next().is_none() && v.is_finite()).then_some(v)
}

#[cfg(test)]
mod tests {
    use super::*;

    fn typed(offered: &str, keys: &str) -> (String, usize) {
        let mut prompt = Prompt::new(Asking::Save, offered);
        for key in Key::parse_sequence(keys).expect("keys") {
            prompt.key(key);
        }
        (prompt.text, prompt.cursor)
    }

    #[test]
    fn typing_edits_at_the_cursor() {
        assert_eq!(typed("", "ac<left>b"), ("abc".to_owned(), 2));
        assert_eq!(typed("", "aé<backspace>"), ("a".to_owned(), 1));
        assert_eq!(typed("", "ab<home><delete>"), ("b".to_owned(), 0));
    }

    #[test]
    fn an_offered_text_is_replaced_or_edited() {
        assert_eq!(typed("walk.toml", "x"), ("x".to_owned(), 1));
        assert_eq!(typed("walk.toml", "<left>x"), ("walk.tomxl".to_owned(), 9));
    }

    #[test]
    fn coordinates_are_offered_with_the_digits_that_matter() {
        let written = |x: f64| coordinates(DVec3::new(x, 0.0, -1e-12), 1e-9);
        for (x, expected) in [
            (0.1 + 0.2, "0.3 0 0"),
            (-17.25, "-17.25 0 0"),
            (100.0 / 3.0, "33.333333333 0 0"),
            (1e20, "100000000000000000000 0 0"),
            (1e300, "1e300 0 0"),
            (-2.5e-300, "0 0 0"),
        ] {
            assert_eq!(written(x), expected);
            let read = parse_coordinates(&written(x)).expect("it reads");
            assert!((read.x - x).abs() <= 1e-9, "{x}");
        }
    }

    #[test]
    fn coordinates_take_what_people_type() {
        for text in ["1 2 -3", "1, 2, -3", "[1,2,-3]", " 1;2;-3e0 "] {
            assert_eq!(parse_coordinates(text), Some(DVec3::new(1.0, 2.0, -3.0)), "{text}");
        }
        for text in ["", "1 2", "1 2 3 4", "1 2 x", "1 2 nan"] {
            assert_eq!(parse_coordinates(text), None, "{text}");
        }
    }
}
