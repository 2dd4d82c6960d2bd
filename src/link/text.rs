//! Text from another process as one line that a terminal can show.

/// The longest line made, in characters: two rows of a wide terminal.
const LONGEST: usize = 400;

/// Makes one line of a text: control characters and runs of space become one space, and what is too long ends in `…`.
///
/// Escape sequences lose the byte that makes them act.
pub fn one_line(text: &str) -> String {
    let mut line = String::new();
    let words = text.split(|c: char| c.is_whitespace() || c.is_control()).filter(|word| !word.is_empty());
    for (n, c) in words.flat_map(|word| std::iter::once(' ').chain(word.chars())).skip(1).enumerate() {
        if n == LONGEST {
            line.push('…');
            break;
        }
        line.push(c);
    }
    line
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn lines_are_joined_and_escapes_disarmed() {
        assert_eq!(one_line("  no\r\n\n driver\t\u{1b}[2J here \u{7}"), "no driver [2J here");
        assert_eq!(one_line(" \n"), "");
    }

    #[test]
    fn long_text_is_cut() {
        let line = one_line(&"é".repeat(10_000));
        assert_eq!(line.chars().count(), LONGEST + 1);
        assert!(line.ends_with('…'));
        assert_eq!(one_line(&"é".repeat(LONGEST)).chars().count(), LONGEST);
    }
}
