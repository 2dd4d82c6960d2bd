//! What the plan has drawn already, so that texts find places of their own.

use ratatui::layout::{Position, Rect};

use super::braille::Canvas;

/// What is drawn already.
pub(super) struct Cover {
    pub(super) area: Rect,
    /// Lines.
    pub(super) ink: Canvas,
    /// Symbols and texts.
    pub(super) taken: Vec<Rect>,
}

impl Cover {
    /// Tells whether a place has no symbol and no text.
    pub(super) fn is_free(&self, place: Rect) -> bool {
        !self.taken.iter().any(|taken| taken.intersects(place))
    }

    /// Tells whether a place, one cell high, has no line either.
    pub(super) fn is_blank(&self, place: Rect) -> bool {
        let row = place.y - self.area.y;
        let inked = (place.left()..place.right()).any(|x| self.ink.is_inked(x - self.area.x, row));
        !inked && self.is_free(place)
    }

    /// Returns where a text beside a cell covers no text or symbol, and no line if that can be: right, left, above,
    /// below. A text that must be put covers what it has to.
    pub(super) fn place_beside(&self, cell: Position, width: u16, must: bool) -> Option<Rect> {
        let (x, y) = (i32::from(cell.x), i32::from(cell.y));
        let places: Vec<Rect> = [(x + 1, y), (x - i32::from(width), y), (x, y - 1), (x, y + 1)]
            .into_iter()
            .filter_map(|(x, y)| Some(Rect::new(u16::try_from(x).ok()?, u16::try_from(y).ok()?, width, 1)))
            .filter(|place| place.intersection(self.area) == *place)
            .collect();
        let blank = places.iter().find(|place| self.is_blank(**place));
        let free = blank.or_else(|| places.iter().find(|place| self.is_free(**place)));
        free.or(if must { places.first() } else { None }).copied()
    }
}
