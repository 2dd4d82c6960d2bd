//! The timeline: a bar from the first frame to the last, the playhead on it, rows of intervals under it.
//!
//! ```text
//! frame 50 of 199   1.67 s of 6.63 s
//!        ━━━━━━━┃────────[────────────]──
//! left     ▄▄▄▄   ▄▄▄▄▄    ▄▄▄▄
//!        0 s       2 s       4 s      6 s
//! ```
//!
//! What an interval is shows without colour too: `▄▄▄` was found and `███` is the user's, `~~~` is to be left alone, a
//! `c` at its start says that it is cleaned, a `!` at its end that it was missed, and `◆` that keys act on it.

use std::ops::RangeInclusive;

use ratatui::{buffer::Buffer, layout::Rect, style::Style, widgets::Widget};

use super::{chart::column, colour::Palette, text};
use crate::{contact::PlantMode, scene::Role};

/// Labels of seconds are at least this many cells apart.
const TICK_CELLS: f64 = 9.0;

/// A frame with a sign on the bar, such as the start of a loop.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct TimelineMark {
    /// Where it stands.
    pub frame: usize,
    /// What it looks like; one cell wide.
    pub symbol: char,
}

/// A row of intervals under the bar, such as a foot's plants.
#[derive(Clone, Copy, Debug)]
pub struct TimelineRow<'a> {
    /// What the intervals are, short.
    pub label: &'a str,
    /// In order of time.
    pub intervals: &'a [Interval],
}

/// An interval and what is to be seen of it.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Interval {
    /// First and last frame.
    pub frames: RangeInclusive<usize>,
    /// What is done with it.
    pub mode: PlantMode,
    /// The user's, not found.
    pub edited: bool,
    /// Could not be done as wished.
    pub missed: bool,
    /// Keys act on it.
    pub chosen: bool,
}

impl Interval {
    /// Returns what fills it, and the signs at its start, at its end and in its middle.
    fn symbols(&self) -> (char, [Option<char>; 3]) {
        let fill = match (self.mode, self.edited) {
            (PlantMode::Slide, _) => '~',
            (_, true) => '█',
            (_, false) => '▄',
        };
        let clean = self.mode == PlantMode::Clean;
        (fill, [clean.then_some('c'), self.missed.then_some('!'), self.chosen.then_some('◆')])
    }

    fn style(&self, palette: Palette) -> Style {
        if self.missed {
            palette.role(Role::MissedFootprint)
        } else if self.edited {
            palette.changed()
        } else {
            palette.value()
        }
    }
}

/// Where the clip is.
#[derive(Clone, Copy, Debug)]
pub struct Timeline<'a> {
    /// Length of the clip.
    pub n_frames: usize,
    /// Frame shown now.
    pub playhead: usize,
    /// Seconds from one frame to the next.
    pub frame_time_secs: f64,
    /// Signs on the bar.
    pub marks: &'a [TimelineMark],
    /// Intervals under the bar; those for which there is no line are left out.
    pub rows: &'a [TimelineRow<'a>],
    /// Colours.
    pub palette: Palette,
}

impl Widget for &Timeline<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let head = u16::from(area.height >= 2);
        let n_rows = (self.rows.len() as u16).min(area.height - 1 - head);
        let rows = &self.rows[..usize::from(n_rows)];
        let widest = rows.iter().map(|row| text::width(row.label) as u16 + 1).max().unwrap_or(0);
        let gutter = widest.min(area.width / 3);
        let line = |y: u16| Rect { y: area.y + y, height: 1, ..area };
        let plot = |y: u16| Rect { x: area.x + gutter, width: area.width - gutter, ..line(y) };
        if head == 1 {
            text::put(buf, line(0), 0, 0, &self.headline(), self.palette.text());
        }
        self.draw_bar(plot(head), buf);
        for (row, y) in rows.iter().zip(head + 1..) {
            let label = Rect { width: gutter.saturating_sub(1), ..line(y) };
            text::put(buf, label, 0, 0, row.label, self.palette.dim());
            self.draw_row(row, plot(y), buf);
        }
        let ticks = head + 1 + n_rows;
        if ticks < area.height {
            self.draw_ticks(plot(ticks), buf);
        }
    }
}

impl Timeline<'_> {
    fn headline(&self) -> String {
        let last = self.n_frames.saturating_sub(1);
        let seconds = |frame: usize| frame as f64 * self.frame_time_secs;
        format!("frame {} of {last}   {:.2} s of {:.2} s", self.playhead, seconds(self.playhead), seconds(last))
    }

    fn draw_bar(&self, plot: Rect, buf: &mut Buffer) {
        let playhead = self.column(self.playhead, plot);
        for x in plot.left()..plot.right() {
            let (symbol, style) =
                if x < playhead { ('━', self.palette.value()) } else { ('─', self.palette.dim()) };
            buf[(x, plot.y)].set_char(symbol).set_style(style);
        }
        for mark in self.marks.iter().filter(|mark| mark.frame < self.n_frames) {
            buf[(self.column(mark.frame, plot), plot.y)].set_char(mark.symbol).set_style(self.palette.title());
        }
        buf[(playhead, plot.y)].set_char('┃').set_style(self.palette.playhead());
    }

    fn draw_row(&self, row: &TimelineRow<'_>, plot: Rect, buf: &mut Buffer) {
        let seen = |i: &&Interval| !i.frames.is_empty() && *i.frames.start() < self.n_frames;
        for interval in row.intervals.iter().filter(seen) {
            let [first, last] = [interval.frames.start(), interval.frames.end()].map(|&f| self.column(f, plot));
            let (fill, signs) = interval.symbols();
            for x in first..=last {
                buf[(x, plot.y)].set_char(fill).set_style(interval.style(self.palette));
            }
            // The later sign wins where there is room for one only.
            for (sign, x) in signs.into_iter().zip([first, last, first + (last - first) / 2]) {
                if let Some(sign) = sign {
                    buf[(x, plot.y)].set_char(sign);
                }
            }
            if interval.chosen {
                let bar = Rect { x: first, width: last - first + 1, ..plot };
                buf.set_style(bar, self.palette.role(Role::SelectedControlPoint));
            }
        }
        let cell = &mut buf[(self.column(self.playhead, plot), plot.y)];
        if cell.symbol() == " " {
            cell.set_char('┃');
        }
        cell.set_style(self.palette.playhead());
    }

    fn draw_ticks(&self, plot: Rect, buf: &mut Buffer) {
        let seconds = self.n_frames.saturating_sub(1) as f64 * self.frame_time_secs;
        let least = seconds * TICK_CELLS / f64::from(plot.width);
        if !(least > 0.0 && least.is_finite()) {
            return;
        }
        let step = text::round_up(least);
        let mut free_from = 0;
        // `step` is at least `least`, so there are no more ticks than cells.
        for i in 0..=(seconds / step).floor() as u32 {
            let at = f64::from(i) * step;
            let label = format!("{} s", text::number(at, step));
            let x = (at / seconds * f64::from(plot.width - 1)).round() as u16;
            let x = x.min(plot.width.saturating_sub(text::width(&label) as u16));
            if x >= free_from {
                free_from = text::put(buf, plot, x, 0, &label, self.palette.dim()) + 1;
            }
        }
    }

    /// Returns the buffer's column of a frame.
    fn column(&self, frame: usize, plot: Rect) -> u16 {
        plot.x + column(frame, self.n_frames, plot.width)
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::{
        Depth,
        test_screen::{every_size, screen},
    };

    const MARKS: [TimelineMark; 2] =
        [TimelineMark { frame: 100, symbol: '[' }, TimelineMark { frame: 180, symbol: ']' }];

    fn timeline<'a>(n_frames: usize, playhead: usize, rows: &'a [TimelineRow<'a>]) -> Timeline<'a> {
        let palette = Palette::new(Depth::True);
        Timeline { n_frames, playhead, frame_time_secs: 1.0 / 30.0, marks: &MARKS, rows, palette }
    }

    fn found(frames: RangeInclusive<usize>) -> Interval {
        Interval { frames, mode: PlantMode::Hold, edited: false, missed: false, chosen: false }
    }

    #[test]
    fn what_an_interval_is_shows_without_colour() {
        let draw = |intervals: &[Interval]| {
            let rows = [TimelineRow { label: "", intervals }];
            screen(24, 3, |area, buf| (&Timeline { marks: &[], ..timeline(23, 22, &rows) }).render(area, buf))[2]
                .clone()
        };
        let edited = |frames| Interval { edited: true, ..found(frames) };
        let mode = |mode, frames| Interval { mode, ..edited(frames) };
        assert_eq!(
            draw(&[found(0..=4), edited(6..=9), mode(PlantMode::Slide, 11..=14), mode(PlantMode::Clean, 16..=19)]),
            " ▄▄▄▄▄ ████ ~~~~ c███  ┃"
        );
        let missed = |interval| Interval { missed: true, ..interval };
        let chosen = |interval| Interval { chosen: true, ..interval };
        assert_eq!(
            draw(&[missed(found(0..=4)), chosen(found(6..=10)), missed(chosen(edited(12..=14)))]),
            " ▄▄▄▄! ▄▄◆▄▄ █◆!       ┃"
        );
        assert_eq!(
            draw(&[missed(chosen(found(3..=3)))]),
            "    ◆                  ┃",
            "in one cell the chosen one is seen"
        );
    }

    #[test]
    fn the_bar_has_a_playhead_marks_rows_and_seconds() {
        let rows = [TimelineRow { label: "left", intervals: &[found(10..=30), found(60..=199)] }];
        let drawn = screen(40, 4, |area, buf| (&timeline(200, 50, &rows)).render(area, buf));
        assert_eq!(
            drawn,
            [
                "frame 50 of 199   1.67 s of 6.63 s      ",
                "     ━━━━━━━━━┃───────[─────────────]───",
                "left   ▄▄▄▄   ┃▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄▄",
                "     0 s       2 s        4 s       6 s ",
            ]
        );
    }

    #[test]
    fn one_line_is_the_bar() {
        assert_eq!(screen(8, 1, |area, buf| (&timeline(8, 7, &[])).render(area, buf)), ["━━━━━━━┃"]);
        assert_eq!(screen(8, 1, |area, buf| (&timeline(8, 0, &[])).render(area, buf)), ["┃───────"]);
    }

    #[test]
    fn any_length_and_any_size_draw() {
        #[expect(clippy::reversed_empty_ranges, reason = "an interval that is none")]
        let rows = [
            TimelineRow { label: "left foot", intervals: &[found(0..=0), found(5..=2), found(3..=usize::MAX)] },
            TimelineRow { label: "", intervals: &[] },
        ];
        for (n_frames, playhead) in [(0, 0), (1, 0), (2, 9), (200, 199), (usize::MAX, 3)] {
            every_size(|area, buf| (&timeline(n_frames, playhead, &rows)).render(area, buf));
        }
        let still = Timeline { frame_time_secs: 0.0, ..timeline(10, 1, &[]) };
        every_size(|area, buf| (&still).render(area, buf));
        let undefined = Timeline { frame_time_secs: f64::NAN, ..timeline(10, 1, &[]) };
        every_size(|area, buf| (&undefined).render(area, buf));
    }
}
