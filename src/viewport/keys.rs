//! winit's key presses under the names that the terminal gives them.

use winit::keyboard::{Key as Pressed, ModifiersState, NamedKey};

use crate::key::{Code, Key};

/// Converts a press; none for bare modifiers, dead keys, media keys and what is held for the desktop (super).
///
/// As in a terminal, control makes no difference between upper and lower case.
pub(super) fn key(pressed: &Pressed, held: ModifiersState) -> Option<Key> {
    if held.super_key() {
        return None;
    }
    let code = match pressed {
        Pressed::Named(name) => named(*name)?,
        Pressed::Character(text) => Code::Char(only_char(text)?),
        Pressed::Dead(_) | Pressed::Unidentified(_) => return None,
    };
    let code = match code {
        Code::Char(c) if held.control_key() => Code::Char(c.to_ascii_lowercase()),
        other => other,
    };
    Some(Key::new(code, held.control_key(), held.alt_key(), held.shift_key()))
}

fn only_char(text: &str) -> Option<char> {
    let mut chars = text.chars();
    let first = chars.next().filter(|c| !c.is_control());
    first.filter(|_| chars.next().is_none())
}

fn named(name: NamedKey) -> Option<Code> {
    Some(match name {
        NamedKey::Enter => Code::Enter,
        NamedKey::Escape => Code::Esc,
        NamedKey::Tab => Code::Tab,
        NamedKey::Space => Code::Char(' '),
        NamedKey::Backspace => Code::Backspace,
        NamedKey::Delete => Code::Delete,
        NamedKey::Insert => Code::Insert,
        NamedKey::ArrowLeft => Code::Left,
        NamedKey::ArrowRight => Code::Right,
        NamedKey::ArrowUp => Code::Up,
        NamedKey::ArrowDown => Code::Down,
        NamedKey::Home => Code::Home,
        NamedKey::End => Code::End,
        NamedKey::PageUp => Code::PageUp,
        NamedKey::PageDown => Code::PageDown,
        NamedKey::F1 => Code::F(1),
        NamedKey::F2 => Code::F(2),
        NamedKey::F3 => Code::F(3),
        NamedKey::F4 => Code::F(4),
        NamedKey::F5 => Code::F(5),
        NamedKey::F6 => Code::F(6),
        NamedKey::F7 => Code::F(7),
        NamedKey::F8 => Code::F(8),
        NamedKey::F9 => Code::F(9),
        NamedKey::F10 => Code::F(10),
        NamedKey::F11 => Code::F(11),
        NamedKey::F12 => Code::F(12),
        _ => return None,
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    fn text(pressed: &Pressed, held: ModifiersState) -> Option<String> {
        key(pressed, held).map(|k| k.to_string())
    }

    fn check(pressed: Pressed, held: ModifiersState, expected: &str) {
        assert_eq!(text(&pressed, held).as_deref(), Some(expected), "{pressed:?}");
    }

    fn typed(text: &str) -> Pressed {
        Pressed::Character(text.into())
    }

    const NONE: ModifiersState = ModifiersState::empty();

    #[test]
    fn names_are_the_terminals() {
        check(typed("j"), NONE, "j");
        check(typed("+"), ModifiersState::SHIFT, "+");
        check(typed("G"), ModifiersState::SHIFT, "G");
        check(typed("r"), ModifiersState::CONTROL, "<c-r>");
        check(typed("R"), ModifiersState::CONTROL | ModifiersState::SHIFT, "<c-r>");
        check(typed("x"), ModifiersState::ALT, "<a-x>");
        check(typed("<"), ModifiersState::SHIFT, "<lt>");
        check(Pressed::Named(NamedKey::Space), NONE, "<space>");
        check(Pressed::Named(NamedKey::Tab), NONE, "<tab>");
        check(Pressed::Named(NamedKey::Tab), ModifiersState::SHIFT, "<s-tab>");
        check(Pressed::Named(NamedKey::ArrowLeft), ModifiersState::SHIFT, "<s-left>");
        check(Pressed::Named(NamedKey::F12), NONE, "<f12>");
    }

    #[test]
    fn what_is_no_key_of_ours_is_left_out() {
        for pressed in [
            Pressed::Named(NamedKey::Shift),
            Pressed::Named(NamedKey::Control),
            Pressed::Named(NamedKey::AudioVolumeUp),
            Pressed::Dead(Some('^')),
            typed("\u{7f}"),
            typed("ab"),
            typed(""),
        ] {
            assert_eq!(text(&pressed, NONE), None, "{pressed:?}");
        }
        assert_eq!(text(&typed("l"), ModifiersState::SUPER), None);
    }
}
