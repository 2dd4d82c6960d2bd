//! Where things of the world lie in the plan: its direction, what it frames, its scale, grid and scale bar.

use glam::DVec3;
use ratatui::layout::{Position, Rect};

use super::text;
use crate::{motion::UpAxis, scene::Scene};

/// Room left around what [`Extent::of`] frames, as a share of its size.
const MARGIN: f64 = 0.06;

/// Grid points nearer than this many dots would only be noise.
const MIN_GRID_DOTS: f64 = 8.0;

/// Where the scene is looked at from.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Direction {
    /// From above: world x to the right, world z down.
    Top,
    /// From +z: world x to the right, up is up.
    Front,
    /// From +x: world z to the left, up is up.
    Side,
}

impl Direction {
    /// Projects a world point to lengths towards the right and down.
    pub fn project(self, p: DVec3) -> (f64, f64) {
        match self {
            Self::Top => (p.x, p.z),
            Self::Front => (p.x, -p.y),
            Self::Side => (-p.z, -p.y),
        }
    }

    /// Names the axes of the clip's file in this view.
    pub(super) fn compass(self, up: UpAxis) -> &'static str {
        match (self, up) {
            (Self::Top, UpAxis::Y) => "→x ↓z",
            (Self::Top, UpAxis::Z) => "→x ↑y",
            (Self::Front, UpAxis::Y) => "→x ↑y",
            (Self::Front, UpAxis::Z) => "→x ↑z",
            (Self::Side, UpAxis::Y) => "←z ↑y",
            (Self::Side, UpAxis::Z) => "→y ↑z",
        }
    }
}

/// The part of the world a view shows, at least: the longer side of the area shows more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Extent {
    /// Middle of the view, world.
    pub centre: DVec3,
    /// Half the width shown, in the clip's length unit; positive.
    pub half_width: f64,
    /// Half the height shown, in the clip's length unit; positive.
    pub half_height: f64,
}

impl Extent {
    /// Frames everything the scene's still part draws and its actors now, never less than one body height.
    pub fn of(scene: &Scene, direction: Direction) -> Self {
        let still = &scene.still;
        let points = (still.curves.iter().flat_map(|c| &c.points))
            .chain(still.marks.iter().map(|m| &m.at))
            .chain(scene.now.actors.iter().flatten())
            .filter(|p| p.is_finite());
        let (mut min, mut max) = (DVec3::INFINITY, DVec3::NEG_INFINITY);
        for &p in points {
            (min, max) = (min.min(p), max.max(p));
        }
        if min.x > max.x {
            (min, max) = (DVec3::ZERO, DVec3::ZERO);
        }
        let least = 0.5 * still.body_height;
        let (a, b) = (direction.project(min), direction.project(max));
        let half = |a: f64, b: f64| (0.5 * (b - a).abs() * (1.0 + 2.0 * MARGIN)).max(least);
        Self { centre: 0.5 * (min + max), half_width: half(a.0, b.0), half_height: half(a.1, b.1) }
    }
}

/// From the world to dots from the area's top left.
pub(super) struct Map {
    pub(super) direction: Direction,
    pub(super) area: Rect,
    centre: (f64, f64),
    pub(super) dots_per_unit: f64,
}

impl Map {
    pub(super) fn new(direction: Direction, extent: Extent, area: Rect) -> Self {
        let (half_width, half_height) = (f64::from(area.width), f64::from(area.height) * 2.0);
        // A dot is about square, so one scale serves both directions.
        let dots_per_unit = (half_width / extent.half_width).min(half_height / extent.half_height);
        Self { direction, area, centre: direction.project(extent.centre), dots_per_unit }
    }

    pub(super) fn dots(&self, p: DVec3) -> (f64, f64) {
        let (right, down) = self.direction.project(p);
        (
            f64::from(self.area.width) + (right - self.centre.0) * self.dots_per_unit,
            f64::from(self.area.height) * 2.0 + (down - self.centre.1) * self.dots_per_unit,
        )
    }

    /// Returns the cell of a point, if it is in the area.
    pub(super) fn cell(&self, p: DVec3) -> Option<Position> {
        let (x, y) = self.dots(p);
        let (x, y) = ((x / 2.0).floor(), (y / 4.0).floor());
        let inside = x >= 0.0 && y >= 0.0 && x < f64::from(self.area.width) && y < f64::from(self.area.height);
        inside.then(|| Position::new(self.area.x + x as u16, self.area.y + y as u16))
    }

    /// Returns the cell next to one, the way a world direction points most; none outside the area.
    pub(super) fn cell_beside(&self, cell: Position, towards: DVec3) -> Option<Position> {
        let (right, down) = self.direction.project(towards);
        let (dx, dy) = if right.abs() >= down.abs() { (right.signum(), 0.0) } else { (0.0, down.signum()) };
        let beside = Position::new(cell.x.checked_add_signed(dx as i16)?, cell.y.checked_add_signed(dy as i16)?);
        self.area.contains(beside).then_some(beside)
    }

    /// Returns the smallest and the largest projected lengths the area shows.
    pub(super) fn visible(&self) -> ((f64, f64), (f64, f64)) {
        let half_width = f64::from(self.area.width) / self.dots_per_unit;
        let half_height = f64::from(self.area.height) * 2.0 / self.dots_per_unit;
        (
            (self.centre.0 - half_width, self.centre.1 - half_height),
            (self.centre.0 + half_width, self.centre.1 + half_height),
        )
    }
}

/// Returns the grid's cell, or the multiple of it whose points are far enough apart to be seen as points.
pub(super) fn grid_step(cell: f64, dots_per_unit: f64) -> Option<f64> {
    let wanted = MIN_GRID_DOTS / dots_per_unit;
    if !(cell > 0.0 && cell.is_finite() && wanted.is_finite()) {
        return None;
    }
    Some(if cell >= wanted { cell } else { text::round_up(wanted / cell) * cell })
}

/// Returns the scale bar with its length, a round number.
pub(super) fn scale_bar(map: &Map, unit: &str) -> Option<String> {
    let units_per_cell = 2.0 / map.dots_per_unit;
    if !(units_per_cell > 0.0 && units_per_cell.is_finite()) {
        return None;
    }
    // A round length between 4 and 10 cells.
    let length = text::round_up(4.0 * units_per_cell);
    let bar = "─".repeat(((length / units_per_cell).round() as usize).saturating_sub(2));
    let bar = format!("├{bar}┤ {} {unit}", text::number(length, length));
    Some(bar.trim_end().to_owned())
}
