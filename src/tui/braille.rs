//! Lines in cells: a canvas of dots, 2 wide and 4 high to a cell, drawn as braille characters.
//!
//! ```text
//!  one cell    bit of each dot       a cell is about twice as high as wide,
//!   0  3       0x01 0x08             so a dot is about square and a circle of
//!   1  4       0x02 0x10             dots looks round
//!   2  5       0x04 0x20
//!   6  7       0x40 0x80
//! ```
//!
//! A cell has one style: the last line through it decides. A font without braille, such as the Linux console's, shows
//! placeholders; there is no plainer drawing for it yet.

use ratatui::{buffer::Buffer, layout::Rect, style::Style};

/// Dots of a dash and of the gap after it.
const DASH: (f64, f64) = (4.0, 3.0);

/// A drawing of dots that fills an area of cells.
#[derive(Clone, Debug)]
pub struct Canvas {
    columns: usize,
    rows: usize,
    /// Dots and style of each cell, row after row; the length is `columns · rows`.
    cells: Vec<(u8, Style)>,
}

/// How a line runs.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Line {
    /// Without gaps.
    Solid,
    /// With gaps.
    Dashed,
}

impl Canvas {
    /// Makes an empty canvas of this many cells.
    pub fn new(columns: u16, rows: u16) -> Self {
        let (columns, rows) = (usize::from(columns), usize::from(rows));
        Self { columns, rows, cells: vec![(0, Style::new()); columns * rows] }
    }

    /// Returns the width in dots.
    pub fn width(&self) -> f64 {
        (self.columns * 2) as f64
    }

    /// Returns the height in dots.
    pub fn height(&self) -> f64 {
        (self.rows * 4) as f64
    }

    /// Sets the dot under a point, dots from the top left; outside the canvas, nothing.
    pub fn dot(&mut self, x: f64, y: f64, style: Style) {
        if !(x >= 0.0 && y >= 0.0 && x < self.width() && y < self.height()) {
            return;
        }
        let (x, y) = (x as usize, y as usize);
        let bit = [[0x01, 0x08], [0x02, 0x10], [0x04, 0x20], [0x40, 0x80]][y % 4][x % 2];
        let cell = &mut self.cells[y / 4 * self.columns + x / 2];
        *cell = (cell.0 | bit, style);
    }

    /// Draws a line through points, dots from the top left. A point that is not finite breaks it.
    pub fn polyline(&mut self, points: impl IntoIterator<Item = (f64, f64)>, line: Line, style: Style) {
        let mut last = None;
        let mut drawn = 0.0;
        for point in points {
            if !(point.0.is_finite() && point.1.is_finite()) {
                last = None;
                continue;
            }
            if let Some(from) = last.replace(point) {
                drawn = self.segment(from, point, line, style, drawn);
            }
        }
    }

    /// Draws one segment whose dashes began `drawn` dots ago; returns that distance at its end.
    fn segment(&mut self, a: (f64, f64), b: (f64, f64), line: Line, style: Style, drawn: f64) -> f64 {
        let (dx, dy) = (b.0 - a.0, b.1 - a.1);
        let length = dx.hypot(dy);
        if let Some((from, to)) = self.clip(a, (dx, dy)) {
            // One sample per dot of the longer extent leaves no holes.
            let steps = ((to - from) * dx.abs().max(dy.abs())).ceil().max(1.0);
            for i in 0..=steps as usize {
                let t = from + (to - from) * i as f64 / steps;
                let inked = match line {
                    Line::Solid => true,
                    Line::Dashed => (drawn + t * length).rem_euclid(DASH.0 + DASH.1) < DASH.0,
                };
                if inked {
                    self.dot(a.0 + t * dx, a.1 + t * dy, style);
                }
            }
        }
        drawn + length
    }

    /// Returns the part of a segment that lies on the canvas, as shares of its length (Liang and Barsky).
    fn clip(&self, a: (f64, f64), d: (f64, f64)) -> Option<(f64, f64)> {
        let (mut from, mut to) = (0.0_f64, 1.0_f64);
        for (p, q) in [(-d.0, a.0), (d.0, self.width() - a.0), (-d.1, a.1), (d.1, self.height() - a.1)] {
            if p == 0.0 {
                if q < 0.0 {
                    return None;
                }
            } else if p < 0.0 {
                from = from.max(q / p);
            } else {
                to = to.min(q / p);
            }
        }
        (from <= to).then_some((from, to))
    }

    /// Tells whether a cell, counted from the top left, has dots.
    pub fn is_inked(&self, column: u16, row: u16) -> bool {
        let (column, row) = (usize::from(column), usize::from(row));
        column < self.columns && row < self.rows && self.cells[row * self.columns + column].0 != 0
    }

    /// Puts the cells that have dots into the buffer.
    pub fn paint(&self, area: Rect, buf: &mut Buffer) {
        for y in 0..area.height.min(self.rows as u16) {
            for x in 0..area.width.min(self.columns as u16) {
                let (dots, style) = self.cells[usize::from(y) * self.columns + usize::from(x)];
                if dots != 0 {
                    let c = char::from_u32(0x2800 + u32::from(dots)).unwrap_or(' ');
                    buf[(area.x + x, area.y + y)].set_char(c).set_style(style);
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::test_screen::screen;

    fn drawn(columns: u16, rows: u16, line: Line, points: &[(f64, f64)]) -> Vec<String> {
        screen(columns, rows, |area, buf| {
            let mut canvas = Canvas::new(columns, rows);
            canvas.polyline(points.iter().copied(), line, Style::new());
            canvas.paint(area, buf);
        })
    }

    #[test]
    fn lines_become_braille() {
        assert_eq!(drawn(4, 1, Line::Solid, &[(0.0, 0.0), (7.9, 3.9)]), ["⠉⠒⠤⣀"]);
        assert_eq!(drawn(2, 2, Line::Solid, &[(0.0, 0.0), (0.0, 7.0), (3.0, 7.0)]), ["⡇ ", "⣇⣀"]);
        assert_eq!(drawn(7, 1, Line::Dashed, &[(0.0, 0.0), (13.0, 0.0)]), ["⠉⠉ ⠈⠉⠁ "]);
    }

    #[test]
    fn dashes_run_on_over_corners() {
        let straight = drawn(8, 1, Line::Dashed, &[(0.0, 0.0), (15.0, 0.0)]);
        let in_two = drawn(8, 1, Line::Dashed, &[(0.0, 0.0), (6.0, 0.0), (15.0, 0.0)]);
        assert_eq!(straight, in_two);
    }

    #[test]
    fn far_and_undefined_points_draw_what_is_inside() {
        let all = [(-1e12, 2.0), (1e12, 2.0), (f64::NAN, 0.0), (0.0, f64::INFINITY), (3.0, 1e300)];
        assert_eq!(drawn(3, 1, Line::Solid, &all), ["⠤⠤⠤"]);
        assert_eq!(drawn(2, 1, Line::Solid, &[(-5.0, -5.0), (-1.0, 9.0)]), ["  "]);
    }
}
