//! A picture in cells: the upper half block `▀` shows two pixels, one above the other, in one cell.
//!
//! The picture is best rendered at exactly the size of [`PictureView::pixels`]; any other is scaled by taking the
//! nearest pixel, its shape kept. Without colours a cell's brightness becomes a character.

use ratatui::{
    buffer::Buffer,
    layout::{Rect, Size},
    widgets::Widget,
};

use super::colour::{Depth, Palette};
use crate::scene::Picture;

/// From dark to bright.
const RAMP: &[u8] = b" .:-=+*#%@";

/// A picture that fills an area as far as its shape allows.
#[derive(Clone, Copy, Debug)]
pub struct PictureView<'a> {
    /// The picture.
    pub picture: &'a Picture,
    /// Colours.
    pub palette: Palette,
}

impl PictureView<'_> {
    /// Returns the size in pixels of the picture that fits an area without scaling.
    pub fn pixels(area: Size) -> (u32, u32) {
        (u32::from(area.width), u32::from(area.height) * 2)
    }

    /// Returns the pixel at a place of the scaled picture.
    fn pixel(&self, x: u32, y: u32, (width, height): (u32, u32)) -> [u8; 3] {
        let nearest = |at: u32, of: u32, source: u32| (2 * u64::from(at) + 1) * u64::from(source) / (2 * u64::from(of));
        let (column, row) = (nearest(x, width, self.picture.width), nearest(y, height, self.picture.height));
        let start =
            usize::try_from(row * u64::from(self.picture.width) + column).unwrap_or(usize::MAX).saturating_mul(3);
        let rest = self.picture.rgb.get(start..);
        rest.and_then(|rest| rest.first_chunk().copied()).unwrap_or_default()
    }
}

impl Widget for &PictureView<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() || self.picture.width == 0 || self.picture.height == 0 {
            return;
        }
        let (width, height) = scaled((self.picture.width, self.picture.height), PictureView::pixels(area.as_size()));
        let (left, top) = ((u32::from(area.width) - width) / 2, (u32::from(area.height) - height / 2) / 2);
        for y in 0..height / 2 {
            for x in 0..width {
                let [upper, lower] = [2 * y, 2 * y + 1].map(|y| self.pixel(x, y, (width, height)));
                let cell = &mut buf[(area.x + (left + x) as u16, area.y + (top + y) as u16)];
                if self.palette.depth == Depth::Monochrome {
                    cell.set_char(brightness(upper, lower));
                } else {
                    cell.set_char('▀').set_fg(self.palette.rgb(upper)).set_bg(self.palette.rgb(lower));
                }
            }
        }
    }
}

/// Returns the largest size of the picture's shape that fits, its height even and at least 2, its width at least 1.
fn scaled((width, height): (u32, u32), (fit_width, fit_height): (u32, u32)) -> (u32, u32) {
    let (w, h) = (u64::from(width), u64::from(height));
    let (fw, fh) = (u64::from(fit_width), u64::from(fit_height));
    let (w, h) = if fw * h <= fh * w { (fw, fw * h / w) } else { (fh * w / h, fh) };
    (w.clamp(1, fw) as u32, (h.next_multiple_of(2)).clamp(2, fh) as u32)
}

fn brightness(upper: [u8; 3], lower: [u8; 3]) -> char {
    let luma = |[r, g, b]: [u8; 3]| 2 * usize::from(r) + 5 * usize::from(g) + usize::from(b);
    let share = (luma(upper) + luma(lower)) * (RAMP.len() - 1);
    char::from(RAMP[(share + 255 * 8) / (255 * 16)])
}

#[cfg(test)]
mod tests {
    use ratatui::style::Color;

    use super::*;
    use crate::tui::test_screen::{every_size, screen};

    fn quarters() -> Picture {
        let rgb = [[255, 0, 0], [0, 255, 0], [0, 0, 255], [255, 255, 255]].concat();
        Picture { width: 2, height: 2, rgb }
    }

    #[test]
    fn a_cell_shows_two_pixels() {
        let picture = quarters();
        let mut buf = Buffer::empty(Rect::new(0, 0, 2, 1));
        (&PictureView { picture: &picture, palette: Palette::new(Depth::True) }).render(buf.area, &mut buf);
        assert_eq!((buf[(0, 0)].fg, buf[(0, 0)].bg), (Color::Rgb(255, 0, 0), Color::Rgb(0, 0, 255)));
        assert_eq!((buf[(1, 0)].fg, buf[(1, 0)].bg), (Color::Rgb(0, 255, 0), Color::Rgb(255, 255, 255)));
    }

    #[test]
    fn without_colours_brightness_becomes_characters_in_the_middle() {
        let picture = quarters();
        let view = PictureView { picture: &picture, palette: Palette::new(Depth::Monochrome) };
        assert_eq!(screen(6, 1, |area, buf| (&view).render(area, buf)), ["  :#  "]);
    }

    #[test]
    fn any_size_and_any_picture_draw() {
        for (width, height, bytes) in
            [(2, 2, 12), (0, 0, 0), (7, 1, 21), (1, 9, 27), (64, 64, 5), (u32::MAX, u32::MAX, 0)]
        {
            let picture = Picture { width, height, rgb: vec![90; bytes] };
            every_size(|area, buf| {
                (&PictureView { picture: &picture, palette: Palette::new(Depth::Indexed) }).render(area, buf);
            });
        }
    }
}
