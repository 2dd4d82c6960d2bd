//! One name for a key press, wherever it came from.
//!
//! crossterm's and winit's events are converted to [`Key`] at the door; the keymap, the help and the tests use its
//! text form: a character stands for itself, anything else is in angle brackets, modifiers first: `j`, `+`, `<tab>`,
//! `<c-r>`, `<s-left>`, `<a-x>`, `<lt>` for `<`. A sequence is key texts one after another: `jj+<tab>u`.

use std::{fmt, str::FromStr};

use serde::{Deserialize, Serialize};

/// What was pressed, without modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub enum Code {
    /// A printable character, shift already applied.
    Char(char),
    /// Return.
    Enter,
    /// Escape.
    Esc,
    /// Tab.
    Tab,
    /// Backspace.
    Backspace,
    /// Delete.
    Delete,
    /// Insert.
    Insert,
    /// Arrow left.
    Left,
    /// Arrow right.
    Right,
    /// Arrow up.
    Up,
    /// Arrow down.
    Down,
    /// Home.
    Home,
    /// End.
    End,
    /// Page up.
    PageUp,
    /// Page down.
    PageDown,
    /// Function key 1 to 12.
    F(u8),
}

/// A key press with its modifiers.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
pub struct Key {
    /// What was pressed.
    pub code: Code,
    /// Control held.
    pub ctrl: bool,
    /// Alt held.
    pub alt: bool,
    /// Shift held; always false for characters, whose case and shape say it.
    pub shift: bool,
}

/// A key text that does not parse.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
#[error("`{0}` is not a key")]
pub struct BadKey(pub String);

const NAMED: &[(&str, Code)] = &[
    ("enter", Code::Enter),
    ("esc", Code::Esc),
    ("tab", Code::Tab),
    ("backspace", Code::Backspace),
    ("delete", Code::Delete),
    ("insert", Code::Insert),
    ("left", Code::Left),
    ("right", Code::Right),
    ("up", Code::Up),
    ("down", Code::Down),
    ("home", Code::Home),
    ("end", Code::End),
    ("pageup", Code::PageUp),
    ("pagedown", Code::PageDown),
    ("space", Code::Char(' ')),
    ("lt", Code::Char('<')),
    ("gt", Code::Char('>')),
    ("f1", Code::F(1)),
    ("f2", Code::F(2)),
    ("f3", Code::F(3)),
    ("f4", Code::F(4)),
    ("f5", Code::F(5)),
    ("f6", Code::F(6)),
    ("f7", Code::F(7)),
    ("f8", Code::F(8)),
    ("f9", Code::F(9)),
    ("f10", Code::F(10)),
    ("f11", Code::F(11)),
    ("f12", Code::F(12)),
];

impl Key {
    /// Makes a key press; shift on a character is dropped, because the character says it.
    pub fn new(code: Code, ctrl: bool, alt: bool, shift: bool) -> Self {
        let shift = shift && !matches!(code, Code::Char(_));
        Self { code, ctrl, alt, shift }
    }

    /// Makes a key press without modifiers.
    pub const fn plain(code: Code) -> Self {
        Self { code, ctrl: false, alt: false, shift: false }
    }

    /// Makes the key press of a character.
    pub const fn char(c: char) -> Self {
        Self::plain(Code::Char(c))
    }

    /// Parses a sequence of key texts.
    ///
    /// # Errors
    ///
    /// When a bracketed name is unknown or not closed.
    pub fn parse_sequence(text: &str) -> Result<Vec<Self>, BadKey> {
        let mut keys = Vec::new();
        let mut rest = text;
        while let Some(first) = rest.chars().next() {
            let len = if first == '<' {
                rest.find('>').ok_or_else(|| BadKey(rest.to_owned()))? + 1
            } else {
                first.len_utf8()
            };
            keys.push(rest[..len].parse()?);
            rest = &rest[len..];
        }
        Ok(keys)
    }
}

impl FromStr for Key {
    type Err = BadKey;

    fn from_str(text: &str) -> Result<Self, BadKey> {
        let bad = || BadKey(text.to_owned());
        let mut chars = text.chars();
        if let (Some(c), None) = (chars.next(), chars.next())
            && c != '<'
            && !c.is_control()
        {
            return Ok(Self::char(c));
        }
        let mut name = text.strip_prefix('<').and_then(|t| t.strip_suffix('>')).ok_or_else(bad)?;
        let (mut ctrl, mut alt, mut shift) = (false, false, false);
        while let Some((modifier, rest)) = name.split_once('-')
            && !rest.is_empty()
        {
            match modifier {
                "c" => ctrl = true,
                "a" => alt = true,
                "s" => shift = true,
                _ => return Err(bad()),
            }
            name = rest;
        }
        let mut chars = name.chars();
        let code = match (NAMED.iter().find(|(n, _)| *n == name), chars.next(), chars.next()) {
            (Some(&(_, code)), ..) => code,
            (None, Some(c), None) if ctrl || alt => Code::Char(c),
            _ => return Err(bad()),
        };
        Ok(Self::new(code, ctrl, alt, shift))
    }
}

impl fmt::Display for Key {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let named = NAMED.iter().find(|(_, code)| *code == self.code).map(|(name, _)| *name);
        if let (Code::Char(c), None, false, false) = (self.code, named, self.ctrl, self.alt) {
            return write!(f, "{c}");
        }
        f.write_str("<")?;
        for (held, letter) in [(self.ctrl, "c-"), (self.alt, "a-"), (self.shift, "s-")] {
            if held {
                f.write_str(letter)?;
            }
        }
        match (named, self.code) {
            (Some(name), _) => f.write_str(name)?,
            (None, Code::Char(c)) => write!(f, "{c}")?,
            (None, code) => unreachable!("{code:?} has a name"),
        }
        f.write_str(">")
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn keys_print_what_they_parse() {
        for text in [
            "j",
            "+",
            "é",
            "<tab>",
            "<c-r>",
            "<s-left>",
            "<a-x>",
            "<lt>",
            "<gt>",
            "<space>",
            "<f12>",
            "<c-a-s-home>",
            "<c-->",
        ] {
            assert_eq!(text.parse::<Key>().map(|k| k.to_string()), Ok(text.to_owned()));
        }
    }

    #[test]
    fn sequences_split_into_keys() {
        let keys = Key::parse_sequence("jj+<tab>u").expect("parses");
        let texts: Vec<_> = keys.iter().map(ToString::to_string).collect();
        assert_eq!(texts, ["j", "j", "+", "<tab>", "u"]);
    }

    #[test]
    fn nonsense_is_refused() {
        for text in ["", "<", "<nope>", "<x-a>", "ab", "<a", "<\u{1}>"] {
            assert!(text.parse::<Key>().is_err(), "{text}");
        }
    }

    #[test]
    fn shift_is_dropped_on_characters() {
        assert_eq!(Key::new(Code::Char('A'), false, false, true), Key::char('A'));
    }
}
