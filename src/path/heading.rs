//! Headings along a path that stay defined, continuous and slow (METHOD 2).
//!
//! The heading at arc length `s` is that of the horizontal chord between the path points `w` before and after. It is
//! computed on an even grid of `s`, and a spline is laid through it. So it is a function of the place on the path alone:
//! somebody who stands still does not turn, and neighbouring grid chords differ by so little that unwrapping cannot go
//! wrong.
//!
//! ```text
//!  s:   -w ………………… 0 … h … 2h ………………… L ………………… L+w
//!        ╰─ first chord ─╯╰─ the path itself ─╯╰─ last chord ─╯
//! ```

use glam::DVec3;

use crate::{
    math::{heading_rad, wrap_rad},
    sync::listed,
};

/// Grid steps in one window: both ends of every chord are points of the grid.
const STEPS_PER_WINDOW: usize = 16;
/// A chord shorter than this share of its full length (twice the window) is a hairpin's and has no heading.
const SHORTEST_CHORD: f64 = 0.2;
/// The window is at least this share of the path, which bounds the grid.
const SHORTEST_WINDOW: f64 = 1.0 / 4096.0;
/// A turn this near half a turn goes left, whatever rounding makes of it.
const HALF_TURN_SLACK: f64 = 1e-6;

/// Heading and slope of a path at any arc length.
#[derive(Clone, Debug, PartialEq)]
pub enum Headings {
    /// The same all along: the path is too short for its window.
    Constant {
        /// Heading about up.
        heading_rad: f64,
        /// Slope above the horizontal.
        slope_rad: f64,
    },
    /// By the windowed chord.
    Windowed {
        /// Arc length of the whole path.
        length: f64,
        /// Arc length from one grid point to the next; the first is at 0, the last not before the path's end.
        spacing: f64,
        /// Unwrapped headings, as control values of a spline over the grid.
        headings_rad: Vec<f64>,
        /// Slopes, likewise.
        slopes_rad: Vec<f64>,
    },
    /// The thesis's plain tangent (window 0), taken where it is needed.
    Tangent,
}

impl Headings {
    /// Computes headings along a path of this length.
    ///
    /// `window` is in the clip's unit, 0 for the plain tangent. `fallback_rad` is the heading of a path that has
    /// none. `point_at` is asked for arc lengths in [0, length], most of them in rising order.
    pub fn along(length: f64, window: f64, fallback_rad: f64, mut point_at: impl FnMut(f64) -> DVec3) -> Self {
        if window <= 0.0 {
            return Self::Tangent;
        }
        if length < 2.0 * window {
            return Self::constant(point_at(length) - point_at(0.0), SHORTEST_CHORD * length, fallback_rad);
        }
        let window = window.max(SHORTEST_WINDOW * length);
        let spacing = window / STEPS_PER_WINDOW as f64;
        let n_nodes = (length / spacing).ceil() as usize + 1;
        let points = Grid::new(length, spacing, n_nodes + STEPS_PER_WINDOW, &mut point_at);

        let shortest = SHORTEST_CHORD * 2.0 * window;
        let directions = listed(n_nodes, |nodes| nodes.map(|node| directions(points.chord(node), shortest)));
        let (mut headings, slopes): (Vec<_>, Vec<_>) = directions.into_iter().unzip();
        unwrap_known(&mut headings);
        let [headings_rad, slopes_rad] = [filled(headings, fallback_rad), filled(slopes, 0.0)].map(control_values);
        Self::Windowed { length, spacing, headings_rad, slopes_rad }
    }

    /// Returns the one heading of a path with this net displacement, if that is long enough to have one.
    fn constant(net: DVec3, shortest: f64, fallback_rad: f64) -> Self {
        let long = |l: f64| l > 0.0 && l >= shortest;
        Self::Constant {
            heading_rad: heading_rad(net).filter(|_| long(flat_length(net))).unwrap_or(fallback_rad),
            slope_rad: if long(net.length()) { slope_rad(net) } else { 0.0 },
        }
    }

    /// Returns heading and slope at an arc length, held beyond the ends; none when the tangent decides.
    pub fn at(&self, arc_length: f64) -> Option<(f64, f64)> {
        match self {
            Self::Constant { heading_rad, slope_rad } => Some((*heading_rad, *slope_rad)),
            Self::Windowed { length, spacing, headings_rad, slopes_rad } => {
                let along = arc_length.clamp(0.0, *length) / spacing;
                Some((interpolated(headings_rad, along), interpolated(slopes_rad, along)))
            }
            Self::Tangent => None,
        }
    }
}

/// Returns heading and slope of each tangent, the last defined ones held where a tangent has none (window 0).
///
/// `shortest` is the length under which a tangent says nothing. Before the first defined heading that one holds; with
/// none at all, `fallback_rad`.
pub(super) fn tangent_directions(
    tangents: impl Iterator<Item = DVec3>,
    shortest: f64,
    fallback_rad: f64,
) -> Vec<(f64, f64)> {
    let long = |l: f64| l > shortest && l.is_finite();
    let (mut headings, slopes): (Vec<_>, Vec<_>) = tangents
        .map(|t| {
            let heading = if long(flat_length(t)) { heading_rad(t) } else { None };
            (heading, long(t.length()).then(|| slope_rad(t)))
        })
        .unzip();
    unwrap_known(&mut headings);
    held(headings, fallback_rad).into_iter().zip(held(slopes, 0.0)).collect()
}

/// Returns the slope of a direction above the horizontal.
fn slope_rad(direction: DVec3) -> f64 {
    direction.y.atan2(flat_length(direction))
}

fn flat_length(direction: DVec3) -> f64 {
    (direction.x * direction.x + direction.z * direction.z).sqrt()
}

/// Returns heading and slope of a chord, where it is long enough to have them.
fn directions(chord: DVec3, shortest: f64) -> (Option<f64>, Option<f64>) {
    let heading = if flat_length(chord) < shortest { None } else { heading_rad(chord) };
    (heading, (chord.length() >= shortest).then(|| slope_rad(chord)))
}

/// Points of a path that is carried on along its first and last chord of one window's length.
struct Grid {
    /// From the start of the path on.
    points: Vec<DVec3>,
    /// Along the first chord: shorter than a step where the path bends, so that a hairpin's chord stays a short one.
    first_step: DVec3,
}

impl Grid {
    fn new(length: f64, spacing: f64, n_points: usize, point_at: &mut impl FnMut(f64) -> DVec3) -> Self {
        let window = spacing * STEPS_PER_WINDOW as f64;
        let end = point_at(length);
        let last = (end - point_at(length - window)) / window;
        let points: Vec<DVec3> = (0..n_points)
            .map(|i| i as f64 * spacing)
            .map(|s| if s > length { end + last * (s - length) } else { point_at(s) })
            .collect();
        let first_step = (points[STEPS_PER_WINDOW] - points[0]) / STEPS_PER_WINDOW as f64;
        Self { points, first_step }
    }

    /// Returns the chord about a point, from one window before to one after it.
    fn chord(&self, node: usize) -> DVec3 {
        let ahead = self.points[node + STEPS_PER_WINDOW];
        let behind = match node.checked_sub(STEPS_PER_WINDOW) {
            Some(behind) => self.points[behind],
            None => self.points[0] - self.first_step * (STEPS_PER_WINDOW - node) as f64,
        };
        ahead - behind
    }
}

/// Adds whole turns so that each known heading is within half a turn of the known one before it.
fn unwrap_known(headings: &mut [Option<f64>]) {
    let mut before: Option<f64> = None;
    for heading in headings.iter_mut().flatten() {
        if let Some(before) = before {
            let turn = wrap_rad(*heading - before);
            let left = turn < HALF_TURN_SLACK - std::f64::consts::PI;
            *heading = before + if left { turn + std::f64::consts::TAU } else { turn };
        }
        before = Some(*heading);
    }
}

/// Interpolates over gaps; the first and last known value hold beyond them, `fallback` when nothing is known.
fn filled(values: Vec<Option<f64>>, fallback: f64) -> Vec<f64> {
    let mut filled = vec![fallback; values.len()];
    let mut known: Option<(usize, f64)> = None;
    for (i, value) in values.iter().enumerate() {
        let Some(value) = *value else { continue };
        match known {
            None => filled[..i].fill(value),
            Some((from, start)) => {
                for (k, gap) in filled[from + 1..i].iter_mut().enumerate() {
                    *gap = start + (value - start) * (k + 1) as f64 / (i - from) as f64;
                }
            }
        }
        filled[i] = value;
        known = Some((i, value));
    }
    if let Some((last, value)) = known {
        filled[last..].fill(value);
    }
    filled
}

/// Holds the last known value through gaps, the first known one before it, `fallback` when nothing is known.
fn held(values: Vec<Option<f64>>, fallback: f64) -> Vec<f64> {
    let mut last = values.iter().copied().flatten().next().unwrap_or(fallback);
    values.into_iter().map(|value| *value.inspect(|&v| last = v).get_or_insert(last)).collect()
}

/// Turns values on an even grid into control values of the uniform cubic B-spline through them, straight at both ends.
///
/// Its bends go over into one another without a jump, and so does the turning of who walks along: a spline whose bend
/// jumps from one grid point to the next is a jerk at every one of them.
fn control_values(values: Vec<f64>) -> Vec<f64> {
    // Between the ends (before + 4 · it + after) / 6 is the value. What a control value is off from its value by solves a
    // band of equations, forth and back; it is nothing where values run straight.
    let last = values.len() - 1;
    let (mut shares, mut offsets) = (vec![0.0; values.len()], vec![0.0; values.len()]);
    for i in 1..last {
        shares[i] = 1.0 / (4.0 - shares[i - 1]);
        let bend = (values[i - 1] - values[i]) + (values[i + 1] - values[i]);
        offsets[i] = -(bend + offsets[i - 1]) * shares[i];
    }
    for i in (1..last).rev() {
        offsets[i] -= shares[i] * offsets[i + 1];
    }
    values.iter().zip(offsets).map(|(value, offset)| value + offset).collect()
}

/// Returns the value of the spline with these control values, `along` grid steps from its start.
fn interpolated(control: &[f64], along: f64) -> f64 {
    let last = control.len() - 1;
    let i = (along as usize).min(last.saturating_sub(1));
    let x = along - i as f64;
    let (b, c) = (control[i], control[(i + 1).min(last)]);
    let a = if i > 0 { control[i - 1] } else { 2.0 * b - c };
    let d = if i + 2 <= last { control[i + 2] } else { 2.0 * c - b };
    let (slope, bend) = (0.5 * (c - a), 0.5 * (a + c) - b);
    let twist = (d - a) / 6.0 + 0.5 * (b - c);
    b + bend / 3.0 + x * (slope + x * (bend + x * twist))
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::{PI, TAU};

    fn circle(radius: f64) -> impl FnMut(f64) -> DVec3 {
        move |s| DVec3::new(radius * (1.0 - (s / radius).cos()), 0.0, radius * (s / radius).sin())
    }

    fn hairpin(length: f64) -> impl FnMut(f64) -> DVec3 {
        move |s| DVec3::new(0.0, 0.0, length / 2.0 - (s - length / 2.0).abs())
    }

    fn heading(headings: &Headings, s: f64) -> f64 {
        headings.at(s).expect("windowed").0
    }

    #[test]
    fn a_circle_turns_evenly_and_the_ends_follow_their_chords() {
        let headings = Headings::along(2.0 * TAU, 0.5, 0.0, circle(1.0));
        for i in 0..=100 {
            // Where the first whole chord begins the heading has a corner, which is felt a few grid steps beyond.
            let s = 0.65 + (2.0 * TAU - 1.3) * i as f64 / 100.0;
            assert!((heading(&headings, s) - s).abs() < 1e-5, "at {s}: {}", heading(&headings, s));
        }
        // The first chord of a circle is turned by half its arc.
        assert!((heading(&headings, 0.0) - 0.25).abs() < 1e-9);
        assert_eq!(heading(&headings, -3.0), heading(&headings, 0.0));
        assert_eq!(heading(&headings, 99.0), heading(&headings, 2.0 * TAU));
    }

    #[test]
    fn a_hairpin_turns_no_faster_than_its_stretch_allows() {
        let window = 0.5;
        let headings = Headings::along(8.0, window, 0.0, hairpin(8.0));
        assert!((heading(&headings, 0.0)).abs() < 1e-12);
        assert!((heading(&headings, 8.0).abs() - PI).abs() < 1e-12);
        // On a straight fold the chord is too short over 0.2 windows on each side: half a turn over 0.4 windows.
        let mut fastest = 0.0f64;
        for i in 0..8000 {
            let s = i as f64 * 1e-3;
            fastest = fastest.max((heading(&headings, s + 1e-3) - heading(&headings, s)).abs() / 1e-3);
        }
        assert!(fastest < 1.5 * PI / (0.4 * window), "{fastest}");
    }

    #[test]
    fn a_fold_turns_the_same_way_whatever_its_direction() {
        for i in 0..100 {
            let direction = crate::math::heading_rotation(i as f64 * 0.37) * DVec3::Z;
            let mut along = hairpin(8.0);
            let headings = Headings::along(8.0, 0.5, 0.0, |s| direction * along(s).z);
            assert!((heading(&headings, 8.0) - heading(&headings, 0.0) - PI).abs() < 1e-9);
        }
    }

    #[test]
    fn short_vertical_and_still_paths_have_one_heading() {
        let short = Headings::along(0.9, 0.5, 7.0, |s| DVec3::new(s, 0.0, 0.0));
        assert_eq!(short.at(0.3), Some((PI / 2.0, 0.0)));
        let still = Headings::along(0.0, 0.5, 7.0, |_| DVec3::ONE);
        assert_eq!(still.at(0.0), Some((7.0, 0.0)));
        let vertical = Headings::along(5.0, 0.5, 7.0, |s| DVec3::new(0.0, s, 0.0));
        assert_eq!(vertical.at(2.0), Some((7.0, PI / 2.0)));
    }

    #[test]
    fn a_vertical_stretch_keeps_the_heading_through() {
        // Along z, straight up, along z again.
        let path = |s: f64| match s {
            s if s < 2.0 => DVec3::new(0.0, 0.0, s),
            s if s < 6.0 => DVec3::new(0.0, s - 2.0, 2.0),
            s => DVec3::new(0.0, 4.0, s - 4.0),
        };
        let headings = Headings::along(8.0, 0.5, 7.0, path);
        for i in 0..=80 {
            assert!(heading(&headings, i as f64 * 0.1).abs() < 1e-12);
        }
        assert!((headings.at(4.0).expect("windowed").1 - PI / 2.0).abs() < 1e-9);
    }

    #[test]
    fn a_window_of_zero_holds_the_last_tangent() {
        let tangents = [DVec3::ZERO, DVec3::X, DVec3::Y, DVec3::ZERO, DVec3::NEG_Z];
        let directions = tangent_directions(tangents.into_iter(), 1e-9, 7.0);
        let headings: Vec<f64> = directions.iter().map(|d| d.0).collect();
        assert_eq!(headings, [PI / 2.0, PI / 2.0, PI / 2.0, PI / 2.0, PI]);
        assert_eq!(directions[3].1, PI / 2.0, "the slope is held too");
        assert_eq!(tangent_directions([DVec3::ZERO].into_iter(), 1e-9, 7.0), [(7.0, 0.0)]);
    }

    #[test]
    fn the_spline_goes_through_its_values_and_its_bends_do_not_jump() {
        const H: f64 = 1e-3;
        let values: Vec<f64> = (0..40).map(|i| (f64::from(i * i) * 0.37).sin()).collect();
        let control = control_values(values.clone());
        let at = |along: f64| interpolated(&control, along);
        let bend = |along: f64| (at(along - H) - 2.0 * at(along) + at(along + H)) / (H * H);
        for (i, value) in values.iter().enumerate() {
            assert!((at(i as f64) - value).abs() < 1e-12, "at {i}");
        }
        for i in 1..39 {
            let (before, after) = (bend(f64::from(i) - 2.0 * H), bend(f64::from(i) + 2.0 * H));
            assert!((before - after).abs() < 0.2, "at {i}: {before} {after}");
        }
        assert!((1..39).any(|i| bend(f64::from(i)).abs() > 2.0), "there are bends to jump");
        assert_eq!(control_values(vec![0.3; 5]), [0.3; 5]);
        assert_eq!((control_values(vec![7.0]), control_values(vec![7.0, 8.0])), (vec![7.0], vec![7.0, 8.0]));
    }

    #[test]
    fn gaps_are_interpolated_and_ends_held() {
        let filled = filled(vec![None, Some(1.0), None, None, Some(4.0), None], 9.0);
        assert_eq!(filled, [1.0, 1.0, 2.0, 3.0, 4.0, 4.0]);
    }
}
