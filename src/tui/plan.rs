//! The scene in cells: an orthographic view from above, from the front or from the side.
//!
//! Curves and limbs are braille lines, things with a place are single characters on top of them, texts go where they
//! cover neither. What a thing is shows without colour too: the original path is dashed, the original actor's hips
//! are `o` and its tracker `□`, the new one's `O` and `■`, the normal skeleton's hips `n`; control points are `●`, the selected one `◆` with its
//! number; `•` is where a point is on its trail; selected joints are `◉`, the one that keys move is `◎`. A footprint is an arrow the way the toes point, `↓`
//! for a left foot and `⇓` for a right one, `!` where the plant was missed; from the side all are `▁`.

use std::collections::HashSet;

use glam::DVec3;
use ratatui::{
    buffer::Buffer,
    layout::{Position, Rect},
    widgets::Widget,
};

use super::{
    braille::{Canvas, Line},
    colour::Palette,
    cover::Cover,
    plan_map::{Direction, Extent, Map, grid_step, scale_bar},
    text,
};
use crate::{
    math::heading_rotation,
    motion::{Side, UpAxis},
    scene::{Body, Footprint, Label, Mark, Object, Objects, Role, Scene, Stroke},
};

/// The end of a limb is a foot when it is in this lowest share of the body's height.
const FOOT_SHARE: f64 = 0.3;

/// The scene seen along an axis.
#[derive(Clone, Copy, Debug)]
pub struct PlanView<'a> {
    /// What is seen.
    pub scene: &'a Scene,
    /// Where it is seen from.
    pub direction: Direction,
    /// The part of the world that is seen.
    pub extent: Extent,
    /// Which of the scene's objects are seen.
    pub shows: Objects,
    /// The clip's up axis, which decides the names of the axes.
    pub up: UpAxis,
    /// Name of the clip's length unit; may be empty.
    pub unit: &'a str,
    /// Colours.
    pub palette: Palette,
}

impl Widget for &PlanView<'_> {
    fn render(self, area: Rect, buf: &mut Buffer) {
        let area = area.intersection(buf.area);
        if area.is_empty() {
            return;
        }
        let map = Map::new(self.direction, self.extent, area);
        let mut ground = Canvas::new(area.width, area.height);
        self.draw_ground(&map, &mut ground);
        ground.paint(area, buf);
        let mut ink = Canvas::new(area.width, area.height);
        self.draw_curves(&map, &mut ink);
        self.draw_limbs(&map, &mut ink);
        ink.paint(area, buf);
        self.put_footprints(&map, buf);
        let mut cover = Cover { area, ink, taken: Vec::new() };
        self.put_symbols(&map, &mut cover, buf);
        self.put_labels(&map, &mut cover, buf);
        self.put_frame_of_reference(&map, &cover, buf);
    }
}

impl PlanView<'_> {
    fn draw_ground(&self, map: &Map, canvas: &mut Canvas) {
        let Some(ground) = self.scene.still.ground.filter(|_| self.shows.contains(Object::Ground)) else { return };
        let style = self.palette.role(Role::Ground);
        if self.direction != Direction::Top {
            let edge = DVec3::splat(ground.half_extent);
            let ends = [ground.centre - edge, ground.centre + edge].map(|p| map.dots(p.with_y(ground.height)));
            canvas.polyline(ends, Line::Dashed, style);
            return;
        }
        let Some(step) = grid_step(ground.cell, map.dots_per_unit) else { return };
        let (min, max) = map.visible();
        let lines = |centre: f64, min: f64, max: f64| {
            let first = (min.max(centre - ground.half_extent) / step).ceil();
            let last = (max.min(centre + ground.half_extent) / step).floor();
            // An empty or undefined range counts none; the visible part bounds the rest.
            (0..=(last - first).max(-1.0) as i64)
                .take_while(move |_| last >= first)
                .map(move |i| (first + i as f64) * step)
        };
        for x in lines(ground.centre.x, min.0, max.0) {
            for z in lines(ground.centre.z, min.1, max.1) {
                let (x, y) = map.dots(DVec3::new(x, ground.height, z));
                canvas.dot(x, y, style);
            }
        }
    }

    fn draw_curves(&self, map: &Map, canvas: &mut Canvas) {
        let mut curves: Vec<_> = self.scene.still.curves.iter().filter(|curve| self.sees(curve.role)).collect();
        curves.sort_by_key(|curve| rank(curve.role));
        for curve in curves {
            let line = match curve.stroke {
                Stroke::Solid => Line::Solid,
                Stroke::Dashed => Line::Dashed,
            };
            canvas.polyline(curve.points.iter().map(|&p| map.dots(p)), line, self.palette.role(curve.role));
        }
    }

    fn draw_limbs(&self, map: &Map, canvas: &mut Canvas) {
        for (body, points) in self.bodies() {
            // Limbs of selected joints come last, over those that they cross.
            let mut limbs: Vec<_> = body.limbs.iter().collect();
            limbs.sort_by_key(|limb| limb.role != body.role);
            for limb in limbs {
                let style = self.palette.role(limb.role);
                let ends = [limb.from, limb.to].map(|i| points.get(i as usize).map(|&p| map.dots(p)));
                canvas.polyline(ends.into_iter().flatten(), Line::Solid, style);
            }
        }
    }

    /// Puts footprints over lines; symbols and labels go over them. One that would be under a mark that stays, or over
    /// another print, is put a cell farther out on the foot's own side.
    fn put_footprints(&self, map: &Map, buf: &mut Buffer) {
        let marks = self.scene.still.marks.iter().filter(|mark| self.sees(mark.role));
        let mut taken: HashSet<Position> = marks.filter_map(|mark| map.cell(mark.at)).collect();
        for print in self.scene.still.footprints.iter().filter(|print| self.sees(print.role)) {
            let Some(own) = map.cell(print.at) else { continue };
            let beside = map.cell_beside(own, outwards(print));
            let cell = if taken.contains(&own) { beside.filter(|c| !taken.contains(c)).unwrap_or(own) } else { own };
            let symbol = footprint_symbol(print, self.direction);
            buf[cell].set_char(symbol).set_style(self.palette.role(print.role));
            taken.insert(cell);
        }
    }

    fn put_symbols(&self, map: &Map, cover: &mut Cover, buf: &mut Buffer) {
        let mut symbols = Vec::new();
        for (body, points) in self.bodies() {
            let style = self.palette.role(body.role);
            let (hips, foot) = match body.role {
                Role::OriginalSkeleton => ('o', '▫'),
                Role::NormalSkeleton => ('n', '▫'),
                _ => ('O', '▪'),
            };
            let (root, feet) = landmarks(body, points);
            symbols.extend(feet.into_iter().map(|p| (p, foot, style)));
            symbols.extend(root.map(|p| (p, hips, style)));
        }
        let marks = self.scene.still.marks.iter().chain(&self.scene.now.marks);
        let mut marks: Vec<&Mark> = marks.filter(|mark| self.sees(mark.role)).collect();
        marks.sort_by_key(|mark| rank(mark.role));
        symbols.extend(marks.into_iter().map(|mark| (mark.at, mark_symbol(mark.role), self.palette.role(mark.role))));
        for (at, symbol, style) in symbols {
            if let Some(cell) = map.cell(at) {
                buf[cell].set_char(symbol).set_style(style);
                cover.taken.push(Rect::new(cell.x, cell.y, 1, 1));
            }
        }
    }

    /// Puts texts where they cover no other text and no symbol; the selected control point's text is put in any case,
    /// others are left out where there is no room.
    fn put_labels(&self, map: &Map, cover: &mut Cover, buf: &mut Buffer) {
        let number = self.selected_number();
        let mut labels: Vec<&Label> = self.labels().chain(&number).collect();
        labels.sort_by_key(|label| std::cmp::Reverse(rank(label.role)));
        for label in labels {
            let Some(cell) = map.cell(label.at) else { continue };
            let width = text::width(&label.text).min(usize::from(cover.area.width)) as u16;
            let must = label.role == Role::SelectedControlPoint;
            let Some(place) = cover.place_beside(cell, width, must) else { continue };
            text::put(buf, place, 0, 0, &label.text, self.palette.role(label.role));
            cover.taken.push(place);
        }
    }

    /// Puts the scale bar and the names of the axes into the corners at the bottom or, where something is drawn there,
    /// at the top.
    fn put_frame_of_reference(&self, map: &Map, cover: &Cover, buf: &mut Buffer) {
        let area = cover.area;
        let compass = self.direction.compass(self.up);
        let bar = scale_bar(map, self.unit).unwrap_or_default();
        let widths = [&bar, compass].map(|text| text::width(text) as u16);
        if area.height < 3 || widths[0] + widths[1] >= area.width {
            return;
        }
        for (text, width, x) in [(bar.as_str(), widths[0], area.x), (compass, widths[1], area.right() - widths[1])] {
            let places = [area.bottom() - 1, area.y].map(|y| Rect { x, y, width, height: 1 });
            let place = places.into_iter().find(|place| cover.is_blank(*place));
            let place = place.or_else(|| places.into_iter().find(|place| cover.is_free(*place)));
            if let Some(place) = place {
                text::put(buf, place, 0, 0, text, self.palette.dim());
            }
        }
    }

    /// Tells whether things of a role are seen.
    fn sees(&self, role: Role) -> bool {
        self.shows.contains(role.object())
    }

    /// Returns the scene's texts that are seen.
    fn labels(&self) -> impl Iterator<Item = &Label> {
        let labels = self.scene.still.labels.iter().chain(&self.scene.now.labels);
        labels.filter(|label| self.shows.contains(Object::Labels) && self.sees(label.role))
    }

    /// Returns the bodies that are there now, the new one last.
    fn bodies(&self) -> impl Iterator<Item = (&Body, &[DVec3])> {
        let mut bodies: Vec<_> = self.scene.still.bodies.iter().zip(self.scene.now.actors.iter()).collect();
        bodies.retain(|(body, _)| self.sees(body.role));
        bodies.sort_by_key(|(body, _)| rank(body.role));
        bodies.into_iter().map(|(body, points)| (body, points.as_slice()))
    }

    /// Returns the selected control point's number, counted from 1, unless the scene labels it itself.
    fn selected_number(&self) -> Option<Label> {
        let role = Role::SelectedControlPoint;
        if !self.sees(role) || self.labels().any(|label| label.role == role) {
            return None;
        }
        let points =
            self.scene.still.marks.iter().filter(|m| matches!(m.role, Role::ControlPoint | Role::SelectedControlPoint));
        let (idx, selected) = points.enumerate().find(|(_, mark)| mark.role == role)?;
        Some(Label { role, at: selected.at, text: (idx + 1).to_string() })
    }
}

/// What is drawn over what: the larger rank on top.
fn rank(role: Role) -> u8 {
    match role {
        Role::Ground => 0,
        Role::Trace => 1,
        Role::Footprint | Role::MissedFootprint => 2,
        Role::OriginalPath => 3,
        Role::NewPath => 4,
        Role::Strain => 5,
        Role::ControlPoint => 6,
        Role::NormalSkeleton | Role::OriginalSkeleton => 7,
        Role::NewSkeleton => 8,
        Role::OriginalTracker => 9,
        Role::NewTracker => 10,
        Role::SelectedControlPoint => 11,
        Role::SelectedJoint => 12,
        Role::ActiveJoint => 13,
    }
}

fn mark_symbol(role: Role) -> char {
    match role {
        Role::ControlPoint => '●',
        Role::SelectedControlPoint => '◆',
        Role::OriginalTracker => '□',
        Role::NewTracker => '■',
        Role::SelectedJoint => '◉',
        Role::ActiveJoint => '◎',
        _ => '•',
    }
}

/// Returns the direction from a body's middle to a foot's own side, world.
fn outwards(print: &Footprint) -> DVec3 {
    // A body that faces +z has +x on its left.
    let left = heading_rotation(print.heading_rad) * DVec3::X;
    if print.foot == Side::Left { left } else { -left }
}

fn footprint_symbol(print: &Footprint, seen: Direction) -> char {
    // From above, +z is down and +x to the right; a heading turns from the one to the other.
    const LEFT: [char; 8] = ['↓', '↘', '→', '↗', '↑', '↖', '←', '↙'];
    const RIGHT: [char; 8] = ['⇓', '⇘', '⇒', '⇗', '⇑', '⇖', '⇐', '⇙'];
    if print.role == Role::MissedFootprint {
        return '!';
    }
    if seen != Direction::Top {
        return '▁';
    }
    let eighth = (print.heading_rad / std::f64::consts::FRAC_PI_4).round().rem_euclid(8.0);
    let arrows = if print.foot == Side::Left { LEFT } else { RIGHT };
    // An undefined heading is 0; the cast saturates.
    arrows[eighth as usize % 8]
}

/// Returns the root of a body and the ends of limbs that are low enough to be feet.
fn landmarks(body: &Body, points: &[DVec3]) -> (Option<DVec3>, Vec<DVec3>) {
    let point = |i: u32| points.get(i as usize).copied();
    let root = body.limbs.iter().find(|limb| body.limbs.iter().all(|other| other.to != limb.from));
    let heights = || points.iter().map(|p| p.y).filter(|y| y.is_finite());
    let (low, high) = (heights().fold(f64::INFINITY, f64::min), heights().fold(f64::NEG_INFINITY, f64::max));
    let feet = (body.limbs.iter())
        .filter(|limb| body.limbs.iter().all(|other| other.from != limb.to))
        .filter_map(|limb| point(limb.to))
        .filter(|p| p.y <= low + FOOT_SHARE * (high - low))
        .collect();
    (root.and_then(|limb| point(limb.from)), feet)
}

#[cfg(test)]
mod tests {
    use std::{f64::consts::TAU, sync::Arc};

    use ratatui::style::Style;

    use super::*;
    use crate::{
        scene::{Curve, Ground, Limb, Now, Still},
        tui::{
            Depth,
            test_screen::{every_size, screen},
        },
    };

    /// A person of 1.8 units at a place, with one foot lifted a little and hands at the hips' height.
    fn person(x: f64, z: f64) -> Vec<DVec3> {
        [(0.0, 0.95, 0.0), (0.0, 1.8, 0.0), (-0.35, 1.0, 0.1), (0.35, 1.0, -0.1), (-0.15, 0.0, 0.3), (0.15, 0.2, -0.3)]
            .map(|(dx, y, dz)| DVec3::new(x + dx, y, z + dz))
            .to_vec()
    }

    fn body(role: Role) -> Body {
        let limb = |from, to| Limb { role, from, to, radius: 0.05 };
        Body { role, limbs: vec![limb(0, 1), limb(1, 2), limb(1, 3), limb(0, 4), limb(0, 5)], wireframe: false }
    }

    fn curve(role: Role, stroke: Stroke, points: Vec<DVec3>) -> Curve {
        Curve { role, stroke, points }
    }

    /// A straight original path along z, a new path that is half a circle, five control points on it.
    fn scene() -> Scene {
        let on_circle = |turn: f64| DVec3::new(4.0 + 4.0 * (turn * TAU).cos(), 0.0, -4.0 * (turn * TAU).sin());
        let half: Vec<DVec3> = (0..=60).map(|i| on_circle(0.5 * f64::from(i) / 60.0)).collect();
        let straight: Vec<DVec3> = (0..=10).map(|i| DVec3::new(-2.0, 0.0, f64::from(i) - 6.0)).collect();
        let controls: Vec<DVec3> = (0..5).map(|i| on_circle(0.125 * f64::from(i))).collect();
        let mark = |(i, &at): (usize, &DVec3)| {
            let role = if i == 2 { Role::SelectedControlPoint } else { Role::ControlPoint };
            Mark { role, at, radius: 0.1 }
        };
        let still = Still {
            revision: 1,
            body_height: 1.8,
            bodies: vec![body(Role::OriginalSkeleton), body(Role::NewSkeleton)],
            footprints: Vec::new(),
            marks: controls.iter().enumerate().map(mark).collect(),
            curves: vec![
                curve(Role::OriginalPath, Stroke::Dashed, straight),
                curve(Role::NewPath, Stroke::Solid, half),
            ],
            labels: vec![Label {
                role: Role::OriginalPath,
                at: DVec3::new(-2.0, 0.0, 4.0),
                text: "as walked".to_owned(),
            }],
            ground: Some(Ground { height: 0.0, centre: DVec3::ZERO, half_extent: 20.0, cell: 1.0 }),
        };
        let tracker = |role, x, z| Mark { role, at: DVec3::new(x, 0.0, z), radius: 0.2 };
        let now = Now {
            actors: vec![person(-2.0, 1.0), person(6.0, -3.0)],
            marks: vec![tracker(Role::OriginalTracker, -2.0, 2.5), tracker(Role::NewTracker, 4.0, 0.0)],
            labels: Vec::new(),
            views: Vec::new(),
            caption: String::new(),
        };
        Scene { still: Arc::new(still), now }
    }

    fn view(scene: &Scene, direction: Direction) -> PlanView<'_> {
        let extent = Extent::of(scene, direction);
        let (shows, palette) = (Objects::ALL, Palette::new(Depth::True));
        PlanView { scene, direction, extent, shows, up: UpAxis::Y, unit: "m", palette }
    }

    fn drawn(scene: &Scene, direction: Direction, width: u16, height: u16) -> Vec<String> {
        screen(width, height, |area, buf| (&view(scene, direction)).render(area, buf))
    }

    #[test]
    fn from_above_a_small_terminal_shows_it_all() {
        assert_eq!(
            drawn(&scene(), Direction::Top, 40, 12),
            [
                " ⠄   ⠄   ⢠   ⠠    ⠄   ⠠   ⠠    ⠄   ⠄   ⠠",
                "         ⠸            3                 ",
                " ⡀   ⡀   ⢠   ⢀    ⡀⢀⣀⣀◆⣀⣀⡀⢀    ⡀   ⡀   ⢀",
                "         ⠈      ⢀⠔⠒⠁     ⠈O▪⡀           ",
                " ⡀   ⡀   ⢰   ⢀ ⡴● ⡀   ⢀   ▪ ●⢦ ⡀   ⡀   ⢀",
                "              ⡼               ⢣         ",
                "         ⢸   ⢠⠃               ⠘⡄        ",
                " ⠁   ⠁   ▫   ●    ⠁   ■   ⠈    ●   ⠁   ⠈",
                "        ⠐o⠁                             ",
                " ⠁   ⠁   □   ⠈    ⠁   ⠈   ⠈    ⠁   ⠁   ⠈",
                "         ⠘                              ",
                "├──┤ 2 m ⠘as walked   ⠐   ⠐    ⠂   →x ↓z",
            ]
        );
    }

    #[test]
    fn from_the_front_and_the_side_people_stand() {
        let mut scene = scene();
        scene.now.actors[0].clear();
        let shown = view(&scene, Direction::Front);
        let extent = Extent { centre: DVec3::new(6.0, 0.9, -3.0), half_width: 1.2, half_height: 1.1 };
        let front = PlanView { extent, ..shown };
        let side = PlanView { extent, direction: Direction::Side, up: UpAxis::Z, ..shown };
        assert_eq!(
            screen(24, 10, |area, buf| (&front).render(area, buf)),
            [
                "├───┤ 0.5 m ⡀      →x ↑y",
                "           ⡜⣧           ",
                "          ⡸ ⡇⢇          ",
                "         ⡰⠁ ⡇⠈⢆         ",
                "        ⠠⠃  O ⠘⠄        ",
                "           ⢸⡇           ",
                "           ⡎⢸           ",
                "           ⡇⠈⡆          ",
                "          ⢸  ▪          ",
                "⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉▪⠉⠉⠉⠉⠉⠉⠉⠉●⠉⠉⠉⠉",
            ]
        );
        assert_eq!(
            screen(24, 10, |area, buf| (&side).render(area, buf)),
            [
                "├───┤ 0.5 m ⡀      →y ↑z",
                "           ⢸⡇           ",
                "           ⢸⡇           ",
                "           ⡇⣿           ",
                "           ⠇O           ",
                "           ⡜⢣           ",
                "          ⢰⠁ ⢣          ",
                "          ⡇  ⠈⢆         ",
                "         ⡸    ▪         ",
                "⠉⠉⠉⠉⠉⠉⠉⠉⠉▪●⠉⠉⠉⠉⠉⠉⠉⠉⠉⠉◆3⠈",
            ]
        );
    }

    #[test]
    fn footprints_point_where_the_toes_do_and_tell_left_from_right() {
        let mut scene = scene();
        let quarter = 0.25 * TAU;
        let print = |role, foot, x: f64, turns: f64| Footprint {
            role,
            foot,
            at: DVec3::new(x, 0.0, 0.0),
            heading_rad: turns * quarter,
            normal: DVec3::Y,
            length: 0.3,
        };
        let mut prints: Vec<Footprint> =
            (0..8).map(|i| print(Role::Footprint, Side::Left, f64::from(i) - 4.0, 0.5 * f64::from(i))).collect();
        prints.extend((0..4).map(|i| print(Role::Footprint, Side::Right, f64::from(i) + 4.0, -f64::from(i) - 0.1)));
        prints.push(print(Role::MissedFootprint, Side::Right, 8.0, 0.0));
        *Arc::make_mut(&mut scene.still) = Still {
            footprints: prints,
            curves: vec![],
            marks: vec![],
            ground: None,
            labels: Vec::new(),
            ..Still::clone(&scene.still)
        };
        scene.now.actors.clear();
        scene.now.marks.clear();
        let extent = Extent { centre: DVec3::new(2.0, 0.0, 0.0), half_width: 8.0, half_height: 0.4 };
        let row = |direction| {
            let view = PlanView { extent, ..view(&scene, direction) };
            screen(16, 1, |area, buf| (&view).render(area, buf))[0].clone()
        };
        assert_eq!(row(Direction::Top), "  ↓↘→↗↑↖←↙⇓⇐⇑⇒! ");
        assert_eq!(row(Direction::Front), "  ▁▁▁▁▁▁▁▁▁▁▁▁! ");
    }

    #[test]
    fn a_footprint_is_not_lost_under_a_mark_or_another_print() {
        let mut scene = scene();
        let print = |foot, heading_rad| Footprint {
            role: Role::Footprint,
            foot,
            at: DVec3::ZERO,
            heading_rad,
            normal: DVec3::Y,
            length: 0.3,
        };
        let still = Arc::make_mut(&mut scene.still);
        still.footprints = vec![print(Side::Left, 0.0), print(Side::Right, 0.0), print(Side::Left, 0.25 * TAU)];
        still.marks = vec![Mark { role: Role::ControlPoint, at: DVec3::ZERO, radius: 0.1 }];
        (still.curves, still.labels, still.ground) = (Vec::new(), Vec::new(), None);
        scene.now.actors.clear();
        scene.now.marks.clear();
        let extent = Extent { centre: DVec3::ZERO, half_width: 2.5, half_height: 2.5 };
        let view = PlanView { extent, ..view(&scene, Direction::Top) };
        assert_eq!(screen(5, 3, |area, buf| (&view).render(area, buf)), ["  →  ", " ⇓●↓ ", "     "]);
    }

    #[test]
    fn a_circle_is_round() {
        let mut scene = scene();
        let circle = (0..=90).map(|i| f64::from(i) / 90.0 * TAU).map(|a| DVec3::new(a.cos(), 0.0, a.sin())).collect();
        let still = Arc::make_mut(&mut scene.still);
        *still = Still {
            curves: vec![curve(Role::NewPath, Stroke::Solid, circle)],
            footprints: Vec::new(),
            marks: Vec::new(),
            labels: Vec::new(),
            ground: None,
            ..still.clone()
        };
        scene.now.actors.clear();
        scene.now.marks.clear();
        let extent = Extent { centre: DVec3::ZERO, half_width: 1.01, half_height: 1.01 };
        let round = PlanView { extent, ..view(&scene, Direction::Top) };
        let map = Map::new(Direction::Top, extent, Rect::new(0, 0, 40, 12));
        let (left, right) = (map.dots(DVec3::NEG_X), map.dots(DVec3::X));
        let (top, bottom) = (map.dots(DVec3::NEG_Z), map.dots(DVec3::Z));
        assert!(((right.0 - left.0) - (bottom.1 - top.1)).abs() < 1e-9);
        assert_eq!(
            screen(12, 6, |area, buf| (&round).render(area, buf)),
            [" ⢀⡤⠊⠉⠉⠉⠉⠑⢤⡀ ", "⣰⠃        ⠘⣆", "⡇          ⢸", "⡇          ⢸", "⠹⡄        ⢠⠏", " ⠈⠓⢄⣀⣀⣀⣀⡠⠚⠁ ",]
        );
    }

    #[test]
    fn the_selected_number_is_shown_unless_the_scene_labels_it() {
        let mut scene = scene();
        assert_eq!(view(&scene, Direction::Top).selected_number().map(|label| label.text), Some("3".to_owned()));
        let label = Label { role: Role::SelectedControlPoint, at: DVec3::ZERO, text: "P2".to_owned() };
        Arc::make_mut(&mut scene.still).labels.push(label);
        assert_eq!(view(&scene, Direction::Top).selected_number(), None);
    }

    #[test]
    fn labels_do_not_cover_one_another() {
        let area = Rect::new(0, 0, 10, 3);
        let at = Position::new(4, 1);
        let mut ink = Canvas::new(10, 3);
        ink.dot(12.0, 6.0, Style::new());
        let mut cover = Cover { area, ink, taken: vec![Rect::new(4, 1, 1, 1)] };
        let mut places = Vec::new();
        while let Some(place) = cover.place_beside(at, 3, false) {
            places.push((place.x, place.y));
            cover.taken.push(place);
        }
        assert_eq!(places, [(1, 1), (4, 0), (4, 2), (5, 1)], "the line on the right is covered last");
        assert_eq!(cover.place_beside(at, 3, true), Some(Rect::new(5, 1, 3, 1)));
        assert_eq!(cover.place_beside(at, 11, true), None);
    }

    #[test]
    fn odd_scenes_and_any_size_draw() {
        let full = scene();
        let mut odd = scene();
        let still = Arc::make_mut(&mut odd.still);
        still.curves[0].points = vec![DVec3::NAN, DVec3::splat(1e300), DVec3::splat(-1e300), DVec3::ZERO];
        still.ground = Some(Ground { height: f64::NAN, centre: DVec3::ZERO, half_extent: f64::INFINITY, cell: 1e-9 });
        odd.now.actors[0].truncate(2);
        let mut empty = scene();
        *Arc::make_mut(&mut empty.still) = Still {
            bodies: Vec::new(),
            curves: Vec::new(),
            footprints: Vec::new(),
            marks: Vec::new(),
            labels: Vec::new(),
            ..empty.still.as_ref().clone()
        };
        empty.now.actors.clear();
        for scene in [full, odd, empty] {
            for direction in [Direction::Top, Direction::Front, Direction::Side] {
                every_size(|area, buf| (&view(&scene, direction)).render(area, buf));
                let extent = Extent { centre: DVec3::NAN, half_width: 0.0, half_height: f64::INFINITY };
                every_size(|area, buf| (&PlanView { extent, ..view(&scene, direction) }).render(area, buf));
            }
        }
    }
}
