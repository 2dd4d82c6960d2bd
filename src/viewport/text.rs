//! Where text goes: view titles, the caption and labels, laid out in pixels.
//!
//! A font pixel is a whole number of picture pixels, so letters stay crisp. A label stands over its point and gives way
//! upwards to text that is already there, and is left out where there is no room; nearer labels go first.

use bytemuck::{Pod, Zeroable};
use glam::DVec2;

use super::{
    batch,
    camera::{Lens, Tile},
    font,
};
use crate::scene::{Label, Object, Scene, View};

/// A character, the dark rim round one, or a box; the `Glyph` of `shaders/text.wgsl`.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Glyph {
    /// Left, top, width, height in pixels.
    place: [f32; 4],
    colour: [f32; 4],
    bits: [u32; 2],
    rim: u32,
    unused: u32,
}

const TITLE: [f32; 4] = [0.62, 0.66, 0.74, 1.0];
const FOCUSED: [f32; 4] = [1.0, 1.0, 1.0, 1.0];
const CAPTION: [f32; 4] = [0.78, 0.80, 0.84, 1.0];
const RIM: [f32; 4] = [0.004, 0.004, 0.006, 0.8];
const STRIP: [f32; 4] = [0.004, 0.004, 0.006, 0.55];

/// A picture smaller than this shows no text: it would cover what it names.
const SMALLEST: (u32, u32) = (200, 150);
/// How often a label gives way before it is left out.
const TRIES: u32 = 5;

/// Lays out all text of a picture; `views` are its tiles with their lenses, in the order of the scene's views.
pub(super) fn layout(scene: &Scene, views: &[(Tile, Lens)], width: u32, height: u32) -> Vec<Glyph> {
    if width < SMALLEST.0 || height < SMALLEST.1 {
        return Vec::new();
    }
    let mut page = Page { scale: scale(width, height), glyphs: Vec::new(), taken: Vec::new() };
    page.caption(&scene.now.caption, width, height);
    for ((tile, _), view) in views.iter().zip(&scene.now.views) {
        page.title(view, *tile);
    }
    for ((tile, lens), view) in views.iter().zip(&scene.now.views) {
        if !view.shows.contains(Object::Labels) {
            continue;
        }
        let mut labels: Vec<_> = scene
            .still
            .labels
            .iter()
            .chain(&scene.now.labels)
            .filter(|label| view.shows.contains(label.role.object()))
            .filter_map(|label| {
                let (at, depth) = lens.project(label.at)?;
                let shown = at.abs().max_element() <= 1.0 && !label.text.is_empty();
                shown.then_some((at, depth, label))
            })
            .collect();
        labels.sort_by(|a, b| a.1.total_cmp(&b.1));
        for (at, _, label) in labels {
            page.label(label, at, *tile);
        }
    }
    page.glyphs
}

/// Picture pixels to a font pixel.
pub(super) fn scale(width: u32, height: u32) -> u32 {
    (width / 640).min(height / 360).max(1)
}

/// A rectangle with text in it: left, top, right, bottom, in pixels.
type Taken = [i64; 4];

struct Page {
    scale: u32,
    glyphs: Vec<Glyph>,
    taken: Vec<Taken>,
}

impl Page {
    fn em(&self) -> i64 {
        i64::from(self.scale * font::SIDE)
    }

    /// Space between text and an edge.
    fn margin(&self) -> i64 {
        i64::from(self.scale) * 4
    }

    fn caption(&mut self, text: &str, width: u32, height: u32) {
        if text.is_empty() {
            return;
        }
        let (width, height) = (i64::from(width), i64::from(height));
        let top = height - self.em() - 2 * self.margin();
        self.glyphs.push(Glyph {
            place: [0, top, width, height - top].map(|v| v as f32),
            colour: STRIP,
            bits: [u32::MAX; 2],
            rim: 0,
            unused: 0,
        });
        self.taken.push([0, top, width, height]);
        let text = self.cut(text, width - 2 * self.margin());
        self.write(&text, self.margin(), top + self.margin(), CAPTION);
    }

    /// Writes a view's title; the one that keys act on has an arrow before it, and is brighter.
    fn title(&mut self, view: &View, tile: Tile) {
        let (left, top) = (i64::from(tile.x) + self.margin(), i64::from(tile.y) + self.margin());
        let (mark, colour) = if view.focused { ("→ ", FOCUSED) } else { ("", TITLE) };
        let text = self.cut(&format!("{mark}{}", view.title), i64::from(tile.width) - 2 * self.margin());
        let right = left + self.em() * text.chars().count() as i64;
        self.taken.push([left, top, right, top + self.em()]);
        self.write(&text, left, top, colour);
    }

    fn label(&mut self, label: &Label, at: DVec2, tile: Tile) {
        let text = self.cut(&label.text, i64::from(tile.width) - 2 * self.margin());
        let width = self.em() * text.chars().count() as i64;
        let size = DVec2::new(f64::from(tile.width), f64::from(tile.height));
        let pixel = (at * 0.5 + 0.5) * size;
        let (first, last) = (i64::from(tile.x), i64::from(tile.x + tile.width) - width);
        let left = (i64::from(tile.x) + pixel.x as i64 - width / 2).clamp(first, last.max(first));
        let mut top = i64::from(tile.y) + pixel.y as i64 - self.em() - self.margin() * 2;
        for _ in 0..TRIES {
            let place = [left, top, left + width, top + self.em()];
            let Some(other) = self.taken.iter().find(|t| overlap(t, &place)) else { break };
            top = other[1] - self.em() - i64::from(self.scale) * 2;
        }
        top = top.max(i64::from(tile.y));
        let place = [left, top, left + width, top + self.em()];
        // Two texts on one place can neither be read.
        if self.taken.iter().any(|taken| overlap(taken, &place)) {
            return;
        }
        self.taken.push(place);
        let [r, g, b, _] = batch::colour(label.role).map(|c| c + (1.0 - c) * 0.35);
        self.write(&text, left, top, [r, g, b, 1.0]);
    }

    /// Shortens a text to a width in pixels; the ellipsis says so.
    fn cut(&self, text: &str, width: i64) -> String {
        let room = (width / self.em()).max(0) as usize;
        let mut chars: Vec<char> = text.chars().map(|c| if c.is_control() { ' ' } else { c }).collect();
        if chars.len() > room {
            chars.truncate(room);
            if let Some(last) = chars.last_mut() {
                *last = '…';
            }
        }
        chars.into_iter().collect()
    }

    /// Writes one line with a dark rim, its left top corner given; the rims first, so that none covers a neighbour.
    fn write(&mut self, text: &str, left: i64, top: i64, colour: [f32; 4]) {
        for (rim, colour) in [(1, RIM), (0, colour)] {
            for (c, i) in text.chars().zip(0..) {
                if c == ' ' {
                    continue;
                }
                let place = [left + i * self.em(), top, self.em(), self.em()].map(|v| v as f32);
                self.glyphs.push(Glyph { place, colour, bits: font::bits(c), rim, unused: 0 });
            }
        }
    }
}

fn overlap(a: &Taken, b: &Taken) -> bool {
    a[0] < b[2] && b[0] < a[2] && a[1] < b[3] && b[1] < a[3]
}

#[cfg(test)]
mod tests {
    use std::sync::Arc;

    use glam::DVec3;

    use super::*;
    use crate::scene::{Camera, Now, Objects, Projection, Role, Still};

    /// A scene seen from the front, 2 high, with labels at these points.
    fn scene(labels: &[(&str, DVec3)], title: &str, caption: &str) -> Scene {
        let camera = Camera {
            eye: DVec3::Z * 10.0,
            target: DVec3::ZERO,
            up: DVec3::Y,
            projection: Projection::Orthographic { height: 2.0 },
        };
        let label = |&(text, at): &(&str, DVec3)| Label { role: Role::NewPath, at, text: text.to_owned() };
        Scene {
            still: Arc::new(Still {
                revision: 0,
                body_height: 1.0,
                bodies: vec![],
                curves: vec![],
                footprints: vec![],
                marks: vec![],
                labels: labels.iter().map(label).collect(),
                ground: None,
            }),
            now: Now {
                actors: vec![],
                marks: vec![],
                labels: vec![],
                views: vec![View { camera, title: title.to_owned(), shows: Objects::ALL, focused: false }],
                caption: caption.to_owned(),
            },
        }
    }

    fn glyphs(scene: &Scene, width: u32, height: u32) -> Vec<Glyph> {
        let tile = Tile { x: 0, y: 0, width, height };
        layout(scene, &[(tile, Lens::new(&scene.now.views[0].camera, tile.aspect()))], width, height)
    }

    /// Left and top of the characters themselves.
    fn places(glyphs: &[Glyph]) -> Vec<(f32, f32)> {
        glyphs.iter().filter(|g| g.rim == 0 && g.colour[3] == 1.0).map(|g| (g.place[0], g.place[1])).collect()
    }

    #[test]
    fn a_label_stands_centred_over_its_point() {
        let at = places(&glyphs(&scene(&[("ab", DVec3::ZERO)], "", ""), 640, 360));
        assert_eq!(at, [(312.0, 164.0), (320.0, 164.0)]);
    }

    #[test]
    fn letters_grow_in_whole_steps() {
        assert_eq!(
            [scale(100, 100), scale(640, 360), scale(1279, 720), scale(1280, 720), scale(1920, 1080)],
            [1, 1, 1, 2, 3]
        );
    }

    #[test]
    fn labels_give_way_to_nearer_ones() {
        let at = places(&glyphs(&scene(&[("far", DVec3::ZERO), ("near", DVec3::Z)], "", ""), 640, 360));
        let near = (304.0, 164.0);
        assert_eq!(at[0], near, "the nearer one stands at its point");
        assert_eq!(at[4].1, 154.0, "the farther one above it");
    }

    #[test]
    fn labels_without_room_are_left_out() {
        let crowd: Vec<_> = (0..20).map(|i| ("x", DVec3::Z * f64::from(i) * 0.01)).collect();
        for at in [DVec3::ZERO, DVec3::Y * 0.9] {
            let crowd: Vec<_> = crowd.iter().map(|&(text, off)| (text, at + off)).collect();
            let places = places(&glyphs(&scene(&crowd, "", ""), 640, 360));
            let apart = |a: &(f32, f32), b: &(f32, f32)| (a.1 - b.1).abs() >= 8.0 || (a.0 - b.0).abs() >= 8.0;
            assert!((1..20).contains(&places.len()), "{places:?}");
            for (i, a) in places.iter().enumerate() {
                assert!(places[i + 1..].iter().all(|b| apart(a, b)), "{places:?}");
            }
        }
    }

    #[test]
    fn labels_outside_the_view_are_left_out_and_those_at_its_edge_moved_in() {
        let labels = [("outside", DVec3::X * 3.0), ("edge", DVec3::new(1.77, 0.99, 0.0))];
        let at = places(&glyphs(&scene(&labels, "", ""), 640, 360));
        assert_eq!(at, [(608.0, 0.0), (616.0, 0.0), (624.0, 0.0), (632.0, 0.0)]);
    }

    #[test]
    fn long_text_is_cut() {
        let long = "x".repeat(200);
        let at = places(&glyphs(&scene(&[], &long, &long), 320, 200));
        assert_eq!(at.len(), 2 * (320 - 8) / 8);
        assert!(at.iter().all(|p| p.0 + 8.0 <= 320.0));
    }

    #[test]
    fn the_title_of_the_view_in_focus_is_marked() {
        let mut scene = scene(&[], "front", "");
        let plain = glyphs(&scene, 640, 360);
        scene.now.views[0].focused = true;
        let focused = glyphs(&scene, 640, 360);
        assert_eq!(places(&focused).len(), places(&plain).len() + 1, "an arrow more");
        assert_ne!(plain.last().map(|g| g.colour), focused.last().map(|g| g.colour));
    }

    #[test]
    fn labels_that_a_view_leaves_out_are_not_written() {
        let written = |shows| {
            let mut scene = scene(&[("new", DVec3::ZERO)], "", "");
            scene.now.views[0].shows = shows;
            places(&glyphs(&scene, 640, 360)).len()
        };
        assert_eq!(written(Objects::ALL.without(Object::Traces)), 3);
        assert_eq!(written(Objects::ALL.without(Object::NewPath)), 0, "the label goes with what it names");
        assert_eq!(written(Objects::ALL.without(Object::Labels)), 0);
    }

    #[test]
    fn small_pictures_have_no_text() {
        assert_eq!(glyphs(&scene(&[("a", DVec3::ZERO)], "t", "c"), 120, 80), []);
    }
}
