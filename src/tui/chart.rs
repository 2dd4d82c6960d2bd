//! Values over frames: a strip for each series, one above the other, so that nothing needs telling apart.
//!
//! Each strip has its own range, written beside it with the value under the playhead. Where there are more frames than
//! dots, a column shows everything from its least to its greatest value: a spike of one frame is never lost.

use ratatui::{buffer::Buffer, layout::Rect, widgets::Widget};

use super::{
    braille::{Canvas, Line},
    colour::Palette,
    text,
};

/// Values that differ by no more than this share of the largest of a chart are one.
const FLAT: f64 = 1e-9;

/// One value for each frame.
#[derive(Clone, Copy, Debug)]
pub struct Series<'a> {
    /// Its name, short: it stands beside the strip.
    pub name: &'a str,
    /// Values, one a frame; what is not finite is left out.
    pub values: &'a [f64],
}

/// Series over frames in stacked strips.
#[derive(Clone, Copy, Debug)]
pub struct Chart<'a> {
    /// What is shown, from top to bottom.
    pub series: &'a [Series<'a>],
    /// Frame under the playhead.
    pub playhead: usize,
    /// Unit of all values; may be empty.
    pub unit: &'a str,
    /// Colours.
    pub palette: Palette,
}

impl Widget for &Chart<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() || self.series.is_empty() {
            return;
        }
        let n = self.series.len() as u16;
        let axis = u16::from(area.height > n);
        let values = self.series.iter().flat_map(|series| series.values);
        let size = values.map(|v| v.abs()).filter(|v| v.is_finite()).fold(0.0, f64::max);
        let labels: Vec<Labels> = self.series.iter().map(|series| Labels::new(series, self.playhead, size)).collect();
        let widest = labels.iter().map(Labels::width).max().unwrap_or(0).max(text::width(self.unit));
        let gutter = (widest as u16 + 1).min(area.width / 2);
        let strips = area.height - axis;
        for (i, (series, labels)) in (0_u16..).zip(self.series.iter().zip(&labels)) {
            let (top, bottom) = (strips * i / n, strips * (i + 1) / n);
            let strip = Rect { y: area.y + top, height: bottom - top, ..area };
            let plot = Rect { x: strip.x + gutter, width: strip.width - gutter, ..strip };
            self.draw_labels(labels, Rect { width: gutter.saturating_sub(1), ..strip }, buf);
            self.draw_strip(series, labels, plot, buf);
        }
        if axis == 1 {
            let line = Rect { y: area.bottom() - 1, height: 1, ..area };
            self.draw_axis(line, gutter, buf);
        }
    }
}

impl Chart<'_> {
    fn draw_labels(&self, labels: &Labels, area: Rect, buf: &mut Buffer) {
        if area.is_empty() {
            return;
        }
        let bottom = area.height - 1;
        if area.height >= 3 {
            text::put_right(buf, area, area.height / 2, &labels.now, self.palette.value());
        }
        if area.height >= 2 {
            text::put_right(buf, area, 0, &labels.max, self.palette.dim());
            text::put_right(buf, area, bottom, &labels.min, self.palette.dim());
        } else {
            text::put_right(buf, area, 0, &labels.now, self.palette.value());
        }
        text::put(buf, area, 0, 0, labels.name, self.palette.title());
    }

    fn draw_strip(&self, series: &Series<'_>, labels: &Labels<'_>, plot: Rect, buf: &mut Buffer) {
        if plot.is_empty() || series.values.is_empty() {
            return;
        }
        let mut canvas = Canvas::new(plot.width, plot.height);
        let (low, high) = labels.range;
        let to_y = |value: f64| (high - value) / (high - low) * (canvas.height() - 1.0);
        let zero = to_y(0.0);
        let last = canvas.width() - 1.0;
        let points = points(series.values, canvas.width() as usize);
        let points: Vec<_> = points.into_iter().map(|(x, value)| (x, to_y(value))).collect();
        if low < 0.0 && high > 0.0 {
            for x in (0..=last as usize).step_by(4) {
                canvas.dot(x as f64, zero, self.palette.dim());
            }
        }
        if let [(x, y)] = points[..] {
            canvas.dot(x, y, self.palette.value());
        }
        canvas.polyline(points, Line::Solid, self.palette.value());
        canvas.paint(plot, buf);
        let x = plot.x + column(self.playhead, series.values.len(), plot.width);
        for y in plot.top()..plot.bottom() {
            let cell = &mut buf[(x, y)];
            if cell.symbol() == " " {
                cell.set_char('│');
            }
            cell.set_style(self.palette.playhead());
        }
    }

    fn draw_axis(&self, line: Rect, gutter: u16, buf: &mut Buffer) {
        let style = self.palette.dim();
        let n_frames = self.series.iter().map(|series| series.values.len()).max().unwrap_or(0);
        text::put(buf, Rect { width: gutter, ..line }, 0, 0, self.unit, style);
        let plot = Rect { x: line.x + gutter, width: line.width - gutter, ..line };
        let end = text::put_right(buf, plot, 0, &n_frames.saturating_sub(1).to_string(), style);
        text::put(buf, plot, 0, 0, if end > 1 { "0" } else { "" }, style);
        let at = column(self.playhead, n_frames, plot.width);
        for now in [format!(" frame {} ", self.playhead), format!(" {} ", self.playhead)] {
            let width = text::width(&now) as u16;
            let x = at.saturating_sub(width / 2).max(1);
            if x + width <= end {
                text::put(buf, plot, x, 0, &now, self.palette.playhead());
                break;
            }
        }
    }
}

/// The texts beside a strip, and the range they name.
struct Labels<'a> {
    name: &'a str,
    min: String,
    now: String,
    max: String,
    /// Least and greatest value shown; the second is greater.
    range: (f64, f64),
}

impl<'a> Labels<'a> {
    /// `size` is that of the largest value of all series of a chart.
    fn new(series: &Series<'a>, playhead: usize, size: f64) -> Self {
        let finite = || series.values.iter().copied().filter(|v| v.is_finite());
        let (min, max) = (finite().fold(f64::INFINITY, f64::min), finite().fold(f64::NEG_INFINITY, f64::max));
        // What is constant but for rounding is.
        let is_flat = max - min <= FLAT * size;
        let write = |v: f64| {
            let v = if v.abs() <= FLAT * size { 0.0 } else { v };
            if v.is_finite() { text::number(v, (max - min).max(max.abs() * 1e-3) / 100.0) } else { "–".to_owned() }
        };
        // A constant series runs through the middle; the room around it only has to be positive.
        let room = if is_flat { 1.0_f64.max(max.abs()) } else { 0.0 };
        let range = if min <= max { (min - room, max + room) } else { (-1.0, 1.0) };
        let now = series.values.get(playhead).map_or_else(|| "–".to_owned(), |&v| write(v));
        Self { name: series.name, min: write(min), now, max: write(max), range }
    }

    fn width(&self) -> usize {
        let number = [&self.min, &self.now, &self.max].map(|text| text::width(text)).into_iter().max().unwrap_or(0);
        text::width(self.name) + 1 + number
    }
}

/// Returns the line to draw: dot column and value, each frame's where there is room, else each column's extremes.
fn points(values: &[f64], width: usize) -> Vec<(f64, f64)> {
    let n = values.len();
    if n <= width {
        let step = (width - 1) as f64 / n.saturating_sub(1).max(1) as f64;
        return values.iter().enumerate().map(|(i, &v)| (i as f64 * step, v)).collect();
    }
    let extremes = |x: usize| {
        let frames = values[x * n / width..(x + 1) * n / width].iter().filter(|v| v.is_finite());
        let (low, high) = frames.fold((f64::INFINITY, f64::NEG_INFINITY), |(l, h), &v| (l.min(v), h.max(v)));
        [(x as f64, low), (x as f64, high)]
    };
    (0..width).flat_map(extremes).collect()
}

/// Returns the cell of a frame when `n_frames` fill `width` cells from the first to the last.
pub(super) fn column(frame: usize, n_frames: usize, width: u16) -> u16 {
    let (last_frame, last_cell) = (n_frames.saturating_sub(1).max(1), width.saturating_sub(1));
    (frame.min(last_frame) as f64 / last_frame as f64 * f64::from(last_cell)).round() as u16
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::tui::{
        Depth,
        test_screen::{every_size, screen},
    };

    fn chart<'a>(series: &'a [Series<'a>], playhead: usize) -> Chart<'a> {
        Chart { series, playhead, unit: "m", palette: Palette::new(Depth::True) }
    }

    #[test]
    fn strips_stack() {
        let x: Vec<f64> = (0..200).map(|i| (f64::from(i) * 0.1).sin() * 0.02).collect();
        let z: Vec<f64> = (0..200).map(|i| f64::from(i) * 0.5).collect();
        let series = [Series { name: "x", values: &x }, Series { name: "z", values: &z }];
        assert_eq!(
            screen(40, 7, |area, buf| (&chart(&series, 50)).render(area, buf)),
            [
                "x    0.02 ⢠⠎⠉⢳⡄  │  ⡔⠉⠹⣆     ⣠⠊⠉⢷⡀    ⢀⡜",
                "  -0.0192 ⠃ ⠂ ⠻⣄⠂│⢂⡞⠂ ⠂⠘⣧ ⠂ ⡲⠃⠂ ⠂⢻⡂ ⠂⢀⠎ ",
                "    -0.02      ⠙⠦⠤⠎     ⠈⠳⢤⠼⠁     ⠙⠦⠴⠋  ",
                "z    99.5        │           ⣀⣀⣠⠤⠤⠔⠒⠒⠋⠉⠉",
                "       25        │⣀⣀⣀⠤⠤⠴⠒⠒⠋⠉⠉⠁          ",
                "        0 ⡤⠤⠴⠒⠒⠚⠉⠉⠁                     ",
                "m         0  frame 50                199",
            ]
        );
    }

    #[test]
    fn a_spike_of_one_frame_is_seen() {
        let mut values = vec![0.0; 10_000];
        values[5_000] = 1.0;
        let points = points(&values, 60);
        assert_eq!(points.iter().filter(|(_, v)| *v == 1.0).count(), 1);
    }

    #[test]
    fn what_is_constant_but_for_rounding_is_a_straight_line() {
        let noisy: Vec<f64> = (0..200).map(|i| -4.98027 - f64::from(i % 3) * 1e-13).collect();
        let drawn = |values: &[f64]| {
            let series = [Series { name: "x", values }];
            screen(40, 7, |area, buf| (&chart(&series, 50)).render(area, buf))
        };
        assert_eq!(drawn(&noisy), drawn(&[-4.98027; 200]));

        // Beside a value that turns by ten degrees, what turns by 1e-15 stands still.
        let noisy: Vec<f64> = (0..200).map(|i| f64::from(i % 3) * 1e-15).collect();
        let drawn = |values: &[f64]| {
            let series = [Series { name: "x", values }, Series { name: "z", values: &[10.0; 200] }];
            screen(40, 7, |area, buf| (&chart(&series, 50)).render(area, buf))
        };
        assert_eq!(drawn(&noisy), drawn(&[0.0; 200]));
    }

    #[test]
    fn odd_series_and_any_size_draw() {
        let odd: [&[f64]; 6] =
            [&[], &[1.0], &[f64::NAN; 3], &[0.0, f64::INFINITY, 1.0], &[5.0; 9], &[-1e308, 1e308, 0.0]];
        for values in odd {
            let series = [Series { name: "x", values }, Series { name: "歩", values: &[1.0, 2.0] }];
            every_size(|area, buf| (&chart(&series, 7)).render(area, buf));
        }
        every_size(|area, buf| (&chart(&[], 0)).render(area, buf));
    }
}
