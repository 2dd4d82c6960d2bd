//! Lines that frame the screen: a status line with two ends, and a row of tabs.

use ratatui::{buffer::Buffer, layout::Rect, style::Style, widgets::Widget};

use super::{colour::Palette, text};

/// One line with a text at each end; the right one yields where there is not room for both.
#[derive(Clone, Copy, Debug)]
pub struct StatusLine<'a> {
    /// Text at the left end.
    pub left: &'a str,
    /// Text at the right end.
    pub right: &'a str,
    /// Look of the whole line.
    pub style: Style,
}

impl Widget for &StatusLine<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let line = Rect { height: 1, ..area };
        buf.set_style(line, self.style);
        let used = text::put(buf, line, 0, 0, self.left, self.style);
        if text::width(self.right) < usize::from(line.width - used.min(line.width)) {
            text::put_right(buf, line, 0, self.right, self.style);
        }
    }
}

/// A row of titles, one of them open. The open one is always in sight.
#[derive(Clone, Copy, Debug)]
pub struct Tabs<'a> {
    /// Titles from left to right.
    pub titles: &'a [&'a str],
    /// Index of the open one.
    pub selected: usize,
    /// Colours.
    pub palette: Palette,
}

impl Widget for &Tabs<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let line = Rect { height: 1, ..area };
        let width = |titles: &[&str]| titles.iter().map(|title| text::width(title) + 2).sum::<usize>();
        let open = self.selected.min(self.titles.len().saturating_sub(1));
        // As many titles as fit stand before the open one; the rest are reached by going there.
        let reach = usize::from(line.width).saturating_sub(usize::from(open + 1 < self.titles.len()));
        let first = (0..=open).find(|&first| {
            width(&self.titles[first..(open + 1).min(self.titles.len())]) + usize::from(first > 0) <= reach
        });
        let first = first.unwrap_or(open);
        let mut x = if first > 0 { text::put(buf, line, 0, 0, "‹", self.palette.key()) } else { 0 };
        for (i, title) in self.titles.iter().enumerate().skip(first) {
            let last = i + 1 == self.titles.len();
            if i > open && usize::from(x) + width(&[title]) + usize::from(!last) > usize::from(line.width) {
                text::put(buf, Rect { x: line.right() - 1, width: 1, ..line }, 0, 0, "›", self.palette.key());
                break;
            }
            x = if i == open {
                let style = self.palette.title().patch(self.palette.selected());
                text::put(buf, line, x, 0, &format!("[{title}]"), style)
            } else {
                text::put(buf, line, x, 0, &format!(" {title} "), self.palette.text())
            };
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::{
        Depth,
        test_screen::{every_size, screen},
    };

    fn status(left: &str, right: &str, width: u16) -> String {
        screen(width, 1, |area, buf| (&StatusLine { left, right, style: Style::new() }).render(area, buf)).concat()
    }

    fn tabs(selected: usize, width: u16) -> String {
        let titles = ["Path", "Timing", "Camera", "Show"];
        let palette = Palette::new(Depth::Monochrome);
        screen(width, 1, |area, buf| (&Tabs { titles: &titles, selected, palette }).render(area, buf)).concat()
    }

    #[test]
    fn the_right_text_yields() {
        assert_eq!(status("saved", "? help", 14), "saved   ? help");
        assert_eq!(status("saved", "? help", 11), "saved      ");
        assert_eq!(status("saved", "? help", 4), "sav…");
    }

    #[test]
    fn the_open_tab_is_in_sight() {
        assert_eq!(tabs(0, 30), "[Path] Timing  Camera  Show   ");
        assert_eq!(tabs(1, 30), " Path [Timing] Camera  Show   ");
        assert_eq!(tabs(0, 18), "[Path] Timing    ›");
        assert_eq!(tabs(2, 18), "‹ Timing [Camera]›");
        assert_eq!(tabs(3, 18), "‹ Camera [Show]   ");
        assert!(tabs(3, 12).contains("[Show]"));
        assert!(tabs(3, 7).contains("[Show]"));
    }

    #[test]
    fn any_size_draws() {
        for selected in [0, 2, 9] {
            let palette = Palette::new(Depth::True);
            every_size(|area, buf| (&Tabs { titles: &["Path", "歩く"], selected, palette }).render(area, buf));
            every_size(|area, buf| (&Tabs { titles: &[], selected, palette }).render(area, buf));
        }
        every_size(|area, buf| (&StatusLine { left: "歩く", right: "x", style: Style::new() }).render(area, buf));
    }
}
