//! The parameter panel: names and values in rows, the selected one kept in sight, its help below.
//!
//! A changed value is bold with a `*` before it; the selected row is reversed with a `▸` before it; `▲` and `▼` at the
//! right edge say that there is more.

use std::borrow::Cow;

use ratatui::{buffer::Buffer, layout::Rect, widgets::Widget};

use super::{colour::Palette, text};
use crate::scene::Role;

/// Lines of help shown at most.
const HELP_LINES: usize = 3;

/// One parameter.
#[derive(Clone, Debug, Default)]
pub struct ParameterRow<'a> {
    /// Its name.
    pub name: Cow<'a, str>,
    /// Its value as text.
    pub value: Cow<'a, str>,
    /// Unit of the value; may be empty.
    pub unit: Cow<'a, str>,
    /// Differs from the default.
    pub changed: bool,
    /// Keys act on it.
    pub selected: bool,
    /// What it stands for in the picture, if its name is to have that colour.
    pub role: Option<Role>,
}

/// Parameters in rows.
#[derive(Clone, Copy, Debug)]
pub struct ParameterList<'a> {
    /// The rows, from top to bottom.
    pub rows: &'a [ParameterRow<'a>],
    /// What the selected parameter does; may be empty.
    pub help: &'a str,
    /// Colours.
    pub palette: Palette,
}

impl Widget for &ParameterList<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let mut help = text::wrap(self.help, usize::from(area.width));
        let most = HELP_LINES.min(usize::from(area.height) / 3);
        if help.len() > most {
            let rest = help.split_off(most.saturating_sub(1)).join(" ");
            help.extend((most > 0).then(|| text::fit(&rest, usize::from(area.width))));
        }
        let help_height = if help.is_empty() { 0 } else { help.len() as u16 + 1 };
        let list = Rect { height: area.height - help_height, ..area };
        self.draw_rows(list, buf);
        for (line, y) in help.iter().zip(list.height + 1..) {
            text::put(buf, area, 0, y, line, self.palette.text());
        }
        if !help.is_empty() {
            text::put(buf, area, 0, list.height, &"─".repeat(usize::from(area.width)), self.palette.dim());
        }
    }
}

impl ParameterList<'_> {
    fn draw_rows(&self, list: Rect, buf: &mut Buffer) {
        let height = usize::from(list.height);
        let selected = self.rows.iter().position(|row| row.selected).unwrap_or(0);
        let first = first_in_sight(self.rows.len(), selected, height);
        let names = self.rows.iter().map(|row| text::width(&row.name)).max().unwrap_or(0) as u16;
        let names = names.min(list.width / 2);
        for (row, y) in self.rows.iter().skip(first).take(height).zip(0..) {
            self.draw_row(row, names, Rect { y: list.y + y, height: 1, ..list }, buf);
        }
        let edge = Rect { x: list.right() - 1, width: 1, ..list };
        if first > 0 {
            text::put(buf, edge, 0, 0, "▲", self.palette.key());
        }
        if first + height < self.rows.len() && height > 0 {
            text::put(buf, edge, 0, list.height - 1, "▼", self.palette.key());
        }
    }

    fn draw_row(&self, row: &ParameterRow<'_>, names: u16, line: Rect, buf: &mut Buffer) {
        if row.selected {
            text::put(buf, line, 0, 0, "▸", self.palette.key());
        }
        // A name without a value has the line to itself.
        let room = line.width.saturating_sub(2);
        let width = if row.value.is_empty() { room } else { names.min(room) };
        let name = Rect { x: line.x + 2.min(line.width), width, ..line };
        let style = row.role.map_or_else(|| self.palette.text(), |role| self.palette.role(role));
        text::put(buf, name, 0, 0, &row.name, style);
        let x = 2 + names + 1;
        let style = if row.changed { self.palette.changed() } else { self.palette.value() };
        if row.changed {
            text::put(buf, line, x, 0, "*", style);
        }
        let x = text::put(buf, line, x + 1, 0, &row.value, style);
        text::put(buf, line, x + 1, 0, &row.unit, self.palette.dim());
        if row.selected {
            buf.set_style(line, self.palette.selected());
        }
    }
}

/// Returns the first of `n` rows to show so that the selected one is in the middle, as far as the ends allow.
pub(super) fn first_in_sight(n: usize, selected: usize, height: usize) -> usize {
    selected.saturating_sub(height / 2).min(n.saturating_sub(height))
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::{
        Depth,
        test_screen::{every_size, screen},
    };

    fn row(name: &'static str, value: &'static str, unit: &'static str) -> ParameterRow<'static> {
        ParameterRow { name: name.into(), value: value.into(), unit: unit.into(), ..ParameterRow::default() }
    }

    fn rows() -> Vec<ParameterRow<'static>> {
        let mut rows =
            vec![row("degree", "3", ""), row("points", "8", ""), row("nudge", "0.1", "H"), row("step", "0.001", "")];
        rows[1].changed = true;
        rows[2].selected = true;
        rows
    }

    fn drawn(rows: &[ParameterRow<'_>], help: &str, width: u16, height: u16) -> Vec<String> {
        let palette = Palette::new(Depth::Monochrome);
        screen(width, height, |area, buf| (&ParameterList { rows, help, palette }).render(area, buf))
    }

    #[test]
    fn rows_and_help() {
        assert_eq!(
            drawn(&rows(), "Step of one key press", 20, 7),
            [
                "  degree  3         ",
                "  points *8         ",
                "▸ nudge   0.1 H     ",
                "  step    0.001     ",
                "────────────────────",
                "Step of one key     ",
                "press               ",
            ]
        );
    }

    #[test]
    fn help_that_is_too_long_is_cut_with_an_ellipsis() {
        let drawn = drawn(&rows(), "Step of one key press, in body heights of the clip", 20, 7);
        assert_eq!(drawn[5..], ["Step of one key     ", "press, in body heig…"]);
    }

    #[test]
    fn the_selected_row_stays_in_sight() {
        assert_eq!(drawn(&rows(), "", 16, 2), ["  points *8    ▲", "▸ nudge   0.1 H▼"]);
        assert_eq!(first_in_sight(100, 0, 10), 0);
        assert_eq!(first_in_sight(100, 50, 10), 45);
        assert_eq!(first_in_sight(100, 99, 10), 90);
        assert_eq!(first_in_sight(3, 2, 10), 0);
    }

    #[test]
    fn any_size_draws() {
        for rows in [rows(), Vec::new(), vec![row("歩く人の長い名前", "とても長い値", "センチ")]] {
            let palette = Palette::new(Depth::Indexed);
            every_size(|area, buf| (&ParameterList { rows: &rows, help: "What it does", palette }).render(area, buf));
        }
    }
}
