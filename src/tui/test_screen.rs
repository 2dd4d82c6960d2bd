//! What the widgets' tests share: small screens as text, and many sizes.

use ratatui::{buffer::Buffer, layout::Rect};

/// Draws on a screen of this size and returns its lines as text.
pub(super) fn screen(width: u16, height: u16, draw: impl FnOnce(Rect, &mut Buffer)) -> Vec<String> {
    let area = Rect::new(0, 0, width, height);
    let mut buf = Buffer::empty(area);
    draw(area, &mut buf);
    lines(&buf)
}

/// Returns a buffer's lines as text.
pub(super) fn lines(buf: &Buffer) -> Vec<String> {
    let width = usize::from(buf.area.width).max(1);
    let mut lines = Vec::new();
    for row in buf.content.chunks(width) {
        // The cell after a wide character is covered by it.
        let mut covered = 0;
        let mut line = String::new();
        for cell in row {
            if covered == 0 {
                line.push_str(cell.symbol());
                covered = super::text::width(cell.symbol()).max(1);
            }
            covered -= 1;
        }
        lines.push(line);
    }
    lines
}

/// Draws into areas of many sizes, the empty one and the single cell among them, and fails when a cell outside the
/// area changes.
pub(super) fn every_size(mut draw: impl FnMut(Rect, &mut Buffer)) {
    let widths = (0..=24).chain([31, 40, 57, 80, 99, 120, 200]);
    for width in widths {
        for height in (0..=14).chain([24, 40, 60]) {
            let area = Rect::new(1, 1, width, height);
            let mut buf = Buffer::empty(Rect::new(0, 0, width + 2, height + 2));
            draw(area, &mut buf);
            let blank = ratatui::buffer::Cell::default();
            for position in buf.area.positions().filter(|p| !area.contains(*p)) {
                assert_eq!(buf[position], blank, "{position:?} is outside {area:?}");
            }
        }
    }
}
