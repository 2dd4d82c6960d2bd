//! Where an edit asks more than a body can do: a bend too tight for the speed, a stride too long, a foot out of reach.
//!
//! These are bounds on what people do, not on what the solve can do; nothing is changed because of them. They colour
//! the path and answer `why`.

use std::ops::Range;

use glam::{DVec2, DVec3};

use super::Holding;
use crate::{
    constrain::Prepared,
    motion::{Clip, Leg},
    path::{NewPath, Timing},
};

/// Sideways acceleration a bend may ask for, of gravity: a lean of 27°.
const LEAN: f64 = 0.5;

/// A bend that is too tight by less than this share is just feasible.
const BARELY: f64 = 0.01;

/// Gravity, body heights per second squared, for a body of average stature (9.81 m/s², 1.72 m).
const GRAVITY: f64 = 9.81 / 1.72;

/// No bend is tighter than this share of a leg's length, however slowly it is walked.
const TIGHTEST: f64 = 0.25;

/// Bends are looked at over pieces of this share of a leg's length: sharper corners are cut by a step anyway.
const SCALE: f64 = 0.5;

/// A path is looked at in no more places than this.
const MOST_SAMPLES: f64 = 4000.0;

/// A stride may be this much longer than the longest of the clip.
const LONGER: f64 = 1.25;

/// A stretch of the path that asks too much. Lengths in the clip's unit.
#[derive(Clone, Debug, PartialEq)]
pub struct Strain {
    /// Edited frames that walk it, at least one.
    pub frames: Range<usize>,
    /// What it asks.
    pub cause: Cause,
}

/// What asks too much. Lengths in the clip's unit.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Cause {
    /// The path bends too tightly for how fast it is walked.
    Bend {
        /// Least radius in the stretch.
        radius: f64,
        /// Least radius that this speed allows there.
        feasible: f64,
        /// Speed there, clip's unit per second.
        speed: f64,
    },
    /// One foot's next footprint is too far away.
    Stride {
        /// The leg.
        leg: Leg,
        /// Between the footprints.
        length: f64,
        /// The longest stride of the same foot in the source.
        longest: f64,
    },
    /// A plant is out of reach: the index of it in [`Holding::missed`].
    Reach {
        /// Index in the list.
        missed: usize,
    },
}

/// What strains are looked for in.
pub(super) struct Asked<'a> {
    pub(super) clip: &'a Clip,
    pub(super) new_path: &'a NewPath,
    pub(super) timing: &'a Timing,
    pub(super) prepared: &'a Prepared,
    pub(super) holding: Option<&'a Holding>,
}

impl Asked<'_> {
    /// Finds all strains, in the order bends, strides, reach.
    pub(super) fn strains(&self) -> Vec<Strain> {
        let mut strains = self.bends();
        strains.extend(self.strides());
        let missed = self.holding.iter().flat_map(|holding| holding.missed.iter().enumerate());
        strains
            .extend(missed.map(|(idx, m)| Strain { frames: m.first..m.last + 1, cause: Cause::Reach { missed: idx } }));
        strains
    }

    /// Finds the stretches whose radius is below what the speed there allows.
    fn bends(&self) -> Vec<Strain> {
        let height = self.clip.facts.height.value;
        let leg = self.prepared.leg_length().unwrap_or(0.5 * height);
        let (spacing, radii) = radii(self.new_path, SCALE * leg);
        let arcs = &self.timing.arc_lengths;
        let n = arcs.len();
        // Speed over a second, so that the sway of single steps is not taken for speed.
        let half = ((0.5 / self.clip.frame_time_secs).round() as usize).max(1);
        let bend = |frame: usize| {
            let (first, last) = (frame.saturating_sub(half), (frame + half).min(n - 1));
            let secs = (last - first) as f64 * self.clip.frame_time_secs;
            let speed = if secs > 0.0 { (arcs[last] - arcs[first]) / secs } else { 0.0 };
            let feasible = (speed * speed / (LEAN * GRAVITY * height)).max(TIGHTEST * leg);
            let radius = radii[((arcs[frame] / spacing).round() as usize).min(radii.len() - 1)];
            (radius < (1.0 - BARELY) * feasible).then_some((radius, Cause::Bend { radius, feasible, speed }))
        };
        let mut strains: Vec<Strain> = Vec::new();
        let mut least = f64::INFINITY;
        for frame in 0..n {
            let Some((radius, cause)) = bend(frame) else { continue };
            match strains.last_mut() {
                Some(last) if last.frames.end == frame => {
                    last.frames.end = frame + 1;
                    if radius < least {
                        (least, last.cause) = (radius, cause);
                    }
                }
                _ => {
                    least = radius;
                    strains.push(Strain { frames: frame..frame + 1, cause });
                }
            }
        }
        strains
    }

    /// Finds the strides that are much longer than any of the source.
    fn strides(&self) -> Vec<Strain> {
        let mut strains = Vec::new();
        let Some(holding) = self.holding else { return strains };
        for (idx, leg) in self.prepared.legs().enumerate() {
            let source: Vec<DVec3> = self.prepared.footprints(idx).collect();
            let longest = source.windows(2).map(|pair| flat_distance(pair[0], pair[1])).fold(0.0, f64::max);
            let prints: Vec<_> = holding.footprints.iter().filter(|print| print.leg == idx).collect();
            for pair in prints.windows(2) {
                let length = flat_distance(pair[0].place, pair[1].place);
                if longest > 0.0 && length > LONGER * longest {
                    let frames = pair[0].last..pair[1].first + 1;
                    strains.push(Strain { frames, cause: Cause::Stride { leg, length, longest } });
                }
            }
        }
        strains
    }
}

/// Returns the radius of a path's bend at places evenly along it, and how far these are apart; each looks `scale` to
/// either side.
fn radii(path: &NewPath, scale: f64) -> (f64, Vec<f64>) {
    let n = (path.length() / (0.5 * scale)).ceil().clamp(1.0, MOST_SAMPLES) as usize + 1;
    let spacing = path.length() / (n - 1) as f64;
    let aside = (scale / spacing).round().clamp(1.0, n as f64) as usize;
    let points: Vec<DVec2> = path.polyline(n).into_iter().map(|p| DVec2::new(p.x, p.z)).collect();
    let at = |i: usize| {
        let (before, after) = (i.checked_sub(aside)?, points.get(i + aside)?);
        Some(circumradius(points[before], points[i], *after))
    };
    // Nearer to an end than `scale` the path is taken as straight.
    (spacing.max(f64::MIN_POSITIVE), (0..n).map(|i| at(i).unwrap_or(f64::INFINITY)).collect())
}

fn flat_distance(a: DVec3, b: DVec3) -> f64 {
    DVec2::new(b.x - a.x, b.z - a.z).length()
}

/// Returns the radius of the circle through three points; infinite on a straight line.
fn circumradius(a: DVec2, b: DVec2, c: DVec2) -> f64 {
    let (u, v) = (b - a, c - b);
    let double_area = u.perp_dot(v).abs();
    // Turning back on the spot lies on a line too, but is as tight as can be.
    if u.dot(v) < 0.0 && double_area < 1e-12 * u.length_squared().max(v.length_squared()) {
        return 0.0;
    }
    u.length() * v.length() * (c - a).length() / (2.0 * double_area)
}

impl Cause {
    /// Says in a word what asks too much.
    pub fn word(&self) -> &'static str {
        match self {
            Self::Bend { .. } => "bend",
            Self::Stride { .. } => "stride",
            Self::Reach { .. } => "reach",
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::BSpline;

    #[test]
    fn three_points_on_a_circle_tell_its_radius() {
        for radius in [0.3, 2.0, 500.0] {
            let at = |angle: f64| DVec2::from_angle(angle) * radius + DVec2::new(7.0, -3.0);
            assert!((circumradius(at(0.1), at(0.4), at(0.9)) / radius - 1.0).abs() < 1e-9);
        }
        assert_eq!(circumradius(DVec2::ZERO, DVec2::X, 2.0 * DVec2::X), f64::INFINITY);
        assert_eq!(circumradius(DVec2::ZERO, DVec2::X, DVec2::ZERO), 0.0);
        assert!(circumradius(DVec2::ZERO, DVec2::ZERO, DVec2::X).is_nan(), "no piece of path at all");
    }

    #[test]
    fn a_path_tells_the_radius_of_its_corner_on_the_scale_of_a_step() {
        let corner = [(0.0, 0.0), (0.0, 10.0), (10.0, 10.0)].map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec();
        let path = NewPath::new(BSpline::new(1, corner), 0.0, 0.0);
        let (spacing, radii) = radii(&path, 0.5);
        let at = |s: f64| radii[(s / spacing).round() as usize];
        assert!(at(5.0) > 1e6 && at(15.0) > 1e6 && at(0.0).is_infinite() && at(20.0).is_infinite());
        // Three points half a unit apart around a right angle.
        assert!((at(10.0) - 0.5 * 0.5_f64.sqrt()).abs() < 1e-3, "{}", at(10.0));
        let point = NewPath::new(BSpline::new(1, vec![DVec3::X; 2]), 0.0, 0.0);
        assert_eq!(super::radii(&point, 0.5).1.len(), 2);
    }
}
