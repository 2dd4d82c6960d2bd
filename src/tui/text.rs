//! Text into cells: never outside the area, never half a wide character, an ellipsis where something was cut.

use ratatui::{buffer::Buffer, layout::Rect, style::Style, text::Span};

/// Returns how many cells a text takes.
pub fn width(text: &str) -> usize {
    Span::raw(text).width()
}

/// Returns the text, or its beginning and `…` when it takes more than `cells`.
pub fn fit(text: &str, cells: usize) -> String {
    if width(text) <= cells {
        return text.to_owned();
    }
    let mut cut = String::new();
    for c in text.chars() {
        cut.push(c);
        if width(&cut) + 1 > cells {
            cut.pop();
            break;
        }
    }
    if cells > 0 {
        cut.push('…');
    }
    cut
}

/// Writes a text at column `x` and row `y` of `area`, cut at its right edge; returns the column after it.
pub fn put(buf: &mut Buffer, area: Rect, x: u16, y: u16, text: &str, style: Style) -> u16 {
    if x >= area.width || y >= area.height {
        return x;
    }
    let text = fit(text, usize::from(area.width - x));
    buf.set_stringn(area.x + x, area.y + y, &text, usize::from(area.width - x), style).0 - area.x
}

/// Writes a text that ends at the right edge of `area`; returns the column it begins at.
pub fn put_right(buf: &mut Buffer, area: Rect, y: u16, text: &str, style: Style) -> u16 {
    let text = fit(text, usize::from(area.width));
    let x = area.width - width(&text).min(usize::from(area.width)) as u16;
    put(buf, area, x, y, &text, style);
    x
}

/// Breaks a text into lines of at most `cells`, at spaces where there are any.
pub fn wrap(text: &str, cells: usize) -> Vec<String> {
    let mut lines = Vec::new();
    if cells == 0 {
        return lines;
    }
    let mut line = String::new();
    for word in text.split_whitespace() {
        let gap = usize::from(!line.is_empty());
        if gap > 0 && width(&line) + gap + width(word) > cells {
            lines.push(std::mem::take(&mut line));
        }
        if !line.is_empty() {
            line.push(' ');
        }
        line.push_str(&fit(word, cells));
    }
    if !line.is_empty() {
        lines.push(line);
    }
    lines
}

/// Returns a number as people write it: no more digits than `step` tells apart, no trailing zeros.
pub fn number(value: f64, step: f64) -> String {
    let digits = if step > 0.0 && step.is_finite() { (-step.log10().floor()).clamp(0.0, 9.0) as usize } else { 3 };
    let text = format!("{value:.digits$}");
    let text = if text.contains('.') { text.trim_end_matches('0').trim_end_matches('.') } else { &text };
    if text == "-0" { "0".to_owned() } else { text.to_owned() }
}

/// Returns the smallest of 1, 2, 5, 10, 20, … (and their tenths) that is not below `x`; `x` is positive.
pub fn round_up(x: f64) -> f64 {
    let tens = 10_f64.powf(x.log10().floor());
    [1.0, 2.0, 5.0].into_iter().map(|m| m * tens).find(|&v| v >= x).unwrap_or(10.0 * tens)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn texts_are_cut_with_an_ellipsis() {
        for (text, cells, expected) in [
            ("walk", 4, "walk"),
            ("walks", 4, "wal…"),
            ("walk", 1, "…"),
            ("walk", 0, ""),
            ("歩く人", 4, "歩…"),
            ("", 0, ""),
        ] {
            assert_eq!(fit(text, cells), expected);
        }
    }

    #[test]
    fn words_wrap() {
        assert_eq!(wrap("a step of one key press", 9), ["a step of", "one key", "press"]);
        assert_eq!(wrap("unbreakable word", 6), ["unbre…", "word"]);
        assert!(wrap("any", 0).is_empty());
    }

    #[test]
    fn round_numbers_are_not_below() {
        for (x, expected) in [(1.0, 1.0), (1.1, 2.0), (4.0, 5.0), (5.1, 10.0), (730.0, 1000.0), (0.03, 0.05)] {
            assert!((round_up(x) - expected).abs() < 1e-12 * expected, "{x}");
        }
    }

    #[test]
    fn numbers_have_the_digits_their_step_tells_apart() {
        for (value, step, expected) in [
            (1.0, 0.1, "1"),
            (1.25, 0.1, "1.2"),
            (-0.001, 0.1, "0"),
            (120.0, 20.0, "120"),
            (0.034_56, 0.000_5, "0.0346"),
            (f64::NAN, 1.0, "NaN"),
        ] {
            assert_eq!(number(value, step), expected);
        }
    }
}
