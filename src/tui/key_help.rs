//! The key help: what each key does now, in as many columns as fit.
//!
//! Lines run down a column and go on in the next. All columns are of one height, [`KeyHelp::n_lines`], and scroll
//! together where the area is lower than that.

use ratatui::{buffer::Buffer, layout::Rect, widgets::Widget};

use super::{colour::Palette, text};

/// Cells between columns.
const GAP: usize = 3;

/// Keys that belong together.
#[derive(Clone, Debug)]
pub struct KeyGroup<'a> {
    /// What they are about.
    pub title: &'a str,
    /// Key texts and what they do.
    pub keys: Vec<(String, &'a str)>,
}

/// What each key does.
#[derive(Clone, Copy, Debug)]
pub struct KeyHelp<'a> {
    /// The groups, in order.
    pub groups: &'a [KeyGroup<'a>],
    /// Lines scrolled down; more than there are shows the end.
    pub scroll: u16,
    /// Colours.
    pub palette: Palette,
}

enum HelpLine<'a> {
    Title(&'a str),
    Key(&'a str, &'a str),
    Blank,
}

impl Widget for &KeyHelp<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let layout = self.layout(area.width);
        let n_lines = layout.columns.iter().map(Vec::len).max().unwrap_or(0) as u16;
        let scroll = self.scroll.min(n_lines.saturating_sub(area.height));
        for (column, left) in layout.columns.iter().zip((0_u16..).step_by(layout.width + GAP)) {
            let width = area.width.saturating_sub(left).min(layout.width as u16);
            let place = Rect { x: area.x + left.min(area.width), width, ..area };
            for (line, y) in column.iter().skip(usize::from(scroll)).zip(0..area.height) {
                self.draw_line(line, layout.key_width, Rect { y: area.y + y, height: 1, ..place }, buf);
            }
        }
        let edge = Rect { x: area.right() - 1, width: 1, ..area };
        if scroll > 0 {
            text::put(buf, edge, 0, 0, "▲", self.palette.key());
        }
        if n_lines - scroll > area.height {
            text::put(buf, edge, 0, area.height - 1, "▼", self.palette.key());
        }
    }
}

struct Layout<'a> {
    /// Cells of a column.
    width: usize,
    /// Cells of its keys.
    key_width: usize,
    columns: Vec<Vec<HelpLine<'a>>>,
}

impl<'a> KeyHelp<'a> {
    /// Returns how many lines the help takes in an area of this width.
    pub fn n_lines(&self, width: u16) -> u16 {
        self.layout(width).columns.iter().map(Vec::len).max().unwrap_or(0) as u16
    }

    fn layout(&self, width: u16) -> Layout<'a> {
        let width = usize::from(width);
        let keys = || self.groups.iter().flat_map(|group| &group.keys);
        let key_width = keys().map(|(key, _)| text::width(key)).max().unwrap_or(0);
        let doc_width = keys().map(|(_, doc)| text::width(doc)).max().unwrap_or(0);
        let titles = self.groups.iter().map(|group| text::width(group.title)).max().unwrap_or(0);
        let column = (key_width + 2 + doc_width).max(titles).clamp(1, width.max(1));
        let n_columns = ((width + GAP) / (column + GAP)).max(1);
        let total: usize = self.groups.iter().map(|group| group.keys.len() + 2).sum();
        // From the even distribution upwards, the first height at which everything fits.
        let columns =
            (total.div_ceil(n_columns)..=total).map(|height| self.flow(height)).find(|c| c.len() <= n_columns);
        Layout { width: column, key_width, columns: columns.unwrap_or_default() }
    }

    /// Distributes the lines over columns of this height; a title never ends a column, a blank line never begins one.
    fn flow(&self, height: usize) -> Vec<Vec<HelpLine<'a>>> {
        let mut columns: Vec<Vec<HelpLine<'a>>> = Vec::new();
        for group in self.groups {
            let lines = std::iter::once(HelpLine::Title(group.title))
                .chain(group.keys.iter().map(|(key, doc)| HelpLine::Key(key, doc)));
            for line in lines {
                let begins = matches!(line, HelpLine::Title(_));
                let room = if begins { 3 } else { 1 };
                match columns.last_mut() {
                    Some(column) if column.len() + room <= height => {
                        if begins {
                            column.push(HelpLine::Blank);
                        }
                        column.push(line);
                    }
                    _ => columns.push(vec![line]),
                }
            }
        }
        columns
    }

    fn draw_line(&self, line: &HelpLine<'_>, key_width: usize, place: Rect, buf: &mut Buffer) {
        match line {
            HelpLine::Title(title) => {
                text::put(buf, place, 0, 0, title, self.palette.title());
            }
            HelpLine::Key(key, doc) => {
                text::put(buf, place, (key_width - text::width(key)) as u16, 0, key, self.palette.key());
                text::put(buf, place, key_width as u16 + 2, 0, doc, self.palette.text());
            }
            HelpLine::Blank => {}
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

    fn groups() -> Vec<KeyGroup<'static>> {
        vec![
            KeyGroup {
                title: "Playing",
                keys: vec![("<space>".to_owned(), "play or pause"), (".".to_owned(), "next frame")],
            },
            KeyGroup { title: "Program", keys: vec![("?".to_owned(), "this help"), ("q".to_owned(), "quit")] },
        ]
    }

    fn drawn(width: u16, height: u16, scroll: u16) -> Vec<String> {
        let groups = groups();
        let palette = Palette::new(Depth::True);
        screen(width, height, |area, buf| (&KeyHelp { groups: &groups, scroll, palette }).render(area, buf))
    }

    #[test]
    fn groups_fill_columns() {
        assert_eq!(
            drawn(50, 3, 0),
            [
                "Playing                  Program                  ",
                "<space>  play or pause         ?  this help       ",
                "      .  next frame            q  quit            ",
            ]
        );
    }

    #[test]
    fn a_narrow_help_scrolls() {
        assert_eq!(
            drawn(26, 4, 0),
            [
                "Playing                   ",
                "<space>  play or pause    ",
                "      .  next frame       ",
                "                         ▼",
            ]
        );
        assert_eq!(
            drawn(26, 4, 99),
            [
                "                         ▲",
                "Program                   ",
                "      ?  this help        ",
                "      q  quit             ",
            ]
        );
    }

    #[test]
    fn any_size_draws() {
        let palette = Palette::new(Depth::Sixteen);
        for groups in [groups(), Vec::new(), vec![KeyGroup { title: "empty", keys: Vec::new() }]] {
            for scroll in [0, 2, u16::MAX] {
                every_size(|area, buf| (&KeyHelp { groups: &groups, scroll, palette }).render(area, buf));
            }
        }
    }
}
