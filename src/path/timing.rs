//! Speed along the new path: which frame of the clip stands where (METHOD 5).

use super::{Integrator, NewPath, OriginalPath, PathFrame, original::parameter};
use crate::curve::Chords;

/// A frame counts as on the path when its arc length is within this share of the path's.
const END_SLACK: f64 = 1e-9;
/// A cycle shorter than this share of the body height is not repeated.
const SHORTEST_PERIOD: f64 = 0.05;
/// A result of more frames than this is not cycled.
const MAX_FRAMES: f64 = 1e6;

/// `timing.cycling`.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Cycling {
    /// The clip ends.
    #[default]
    Off,
    /// The thesis's: the clip starts again where it ended.
    Plain,
    /// The clip has been joined to itself (METHOD 7), so that it lasts as long as the path; to timing the same as `Off`.
    Blended,
}

/// How the new path is timed.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct TimingOptions {
    /// Frame `f` stands at the arc length it has on the original path; else at its share of the parameter.
    pub arc_length: bool,
    /// How arc length is integrated.
    pub integrator: Integrator,
    /// Euler step, share of the parameter range.
    pub step: f64,
    /// What happens on a path longer than the clip.
    pub cycling: Cycling,
}

/// Where each edited frame stands.
#[derive(Clone, Debug)]
pub struct Timing {
    /// Frame of the clip that each edited frame shows, without rest frames; never empty.
    pub source_frames: Vec<u32>,
    /// Arc length along the path walked at each edited frame, by the integrator in use, the clip's unit.
    pub arc_lengths: Vec<f64>,
    /// Path frame at each edited frame: `M1`, or `M0` while the path edit is off.
    pub frames: Vec<PathFrame>,
    /// Edited frames that begin another cycle.
    pub seams: Vec<usize>,
    /// Length of the path walked, by the integrator in use, the clip's unit.
    pub path_length: f64,
    /// The frames stand at their arc lengths exactly; Euler steps only come near.
    pub is_exact: bool,
    /// The path is shorter than the clip, so the clip ends where the path does.
    pub ends_early: bool,
    /// What could not be done as wished, one line each.
    pub warnings: Vec<String>,
}

impl Timing {
    /// Times a clip along a new path.
    ///
    /// `progress` is the arc length of each frame on the original path; `height` is `H` in the clip's unit.
    pub fn along(path: &NewPath, progress: &[f64], height: f64, options: &TimingOptions) -> Self {
        let chords =
            (options.integrator == Integrator::Euler).then(|| Chords::new(options.step, |u| path.spline().point(u)));
        let path_length = chords.as_ref().map_or(path.length(), Chords::length);
        if !options.arc_length {
            return Self::by_parameter(path, progress.len(), path_length, chords.as_ref(), options.cycling);
        }

        let end = path_length * (1.0 + END_SLACK);
        let period = progress[progress.len() - 1];
        let mut warnings = Vec::new();
        let cycles = options.cycling == Cycling::Plain
            && period < path_length * (1.0 - END_SLACK)
            && may_cycle(period, path_length / period, progress.len(), height, &mut warnings);

        let mut source_frames = Vec::with_capacity(progress.len());
        let mut arc_lengths = Vec::with_capacity(progress.len());
        let mut seams = Vec::new();
        let mut start = 0.0;
        loop {
            let n_on_path = progress.partition_point(|&s| start + s <= end).max(1);
            source_frames.extend(0..n_on_path as u32);
            arc_lengths.extend(progress[..n_on_path].iter().map(|&s| start + s));
            // Counted up by multiplication, so that a thousand cycles are as exact as one.
            start = (seams.len() + 1) as f64 * period;
            // A cycle that would begin at the very end of the path has nowhere to go.
            if !cycles || n_on_path < progress.len() || start >= path_length * (1.0 - END_SLACK) {
                break;
            }
            seams.push(source_frames.len());
        }
        let frames = match &chords {
            None => path.frames_along(&arc_lengths),
            Some(chords) => {
                let parameters: Vec<f64> = arc_lengths.iter().map(|&s| chords.parameter_at(s)).collect();
                path.frames_at_parameters(&parameters)
            }
        };
        let ends_early = source_frames.len() < progress.len();
        Self {
            source_frames,
            arc_lengths,
            frames,
            seams,
            path_length,
            is_exact: chords.is_none(),
            ends_early,
            warnings,
        }
    }

    /// Leaves the clip on its own path.
    pub fn of_original(original: &OriginalPath, progress: &[f64]) -> Self {
        Self {
            source_frames: (0..progress.len() as u32).collect(),
            arc_lengths: progress.to_vec(),
            frames: original.frames().to_vec(),
            seams: Vec::new(),
            path_length: progress[progress.len() - 1],
            is_exact: true,
            ends_early: false,
            warnings: Vec::new(),
        }
    }

    /// Uses the whole path, frame by frame of its parameter: speeds change.
    fn by_parameter(path: &NewPath, n: usize, path_length: f64, chords: Option<&Chords>, cycling: Cycling) -> Self {
        let parameters: Vec<f64> = (0..n).map(|f| parameter(f, n)).collect();
        let arc_lengths = match chords {
            None => path.lengths_at(&parameters),
            Some(chords) => parameters.iter().map(|&u| chords.length_at(u)).collect(),
        };
        let warnings = match cycling {
            Cycling::Off => Vec::new(),
            Cycling::Plain | Cycling::Blended => vec!["not cycled: timing.cycling needs timing.arc_length".to_owned()],
        };
        Self {
            source_frames: (0..n as u32).collect(),
            arc_lengths,
            frames: path.frames_at_parameters(&parameters),
            seams: Vec::new(),
            path_length,
            is_exact: chords.is_none(),
            ends_early: false,
            warnings,
        }
    }

    /// Returns the number of edited frames.
    pub fn n_frames(&self) -> usize {
        self.source_frames.len()
    }
}

/// Tells whether a clip may be repeated `n_cycles` times along a longer path; says why not.
///
/// `period` is the way that the `n_frames` of one cycle walk and `height` the body's, both in the clip's unit.
pub fn may_cycle(period: f64, n_cycles: f64, n_frames: usize, height: f64, warnings: &mut Vec<String>) -> bool {
    if period < SHORTEST_PERIOD * height {
        warnings.push(format!("not cycled: one cycle walks less than {SHORTEST_PERIOD} body heights"));
        return false;
    }
    if n_cycles * n_frames as f64 > MAX_FRAMES {
        warnings.push("not cycled: the result would have more than a million frames".to_owned());
        return false;
    }
    true
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::curve::BSpline;
    use glam::DVec3;

    fn line(length: f64) -> NewPath {
        let points = (0..8).map(|i| DVec3::Z * (length * i as f64 / 7.0)).collect();
        NewPath::new(BSpline::new(3, points), 0.5, 0.0)
    }

    /// Eleven frames over ten units.
    fn progress() -> Vec<f64> {
        (0..=10).map(f64::from).collect()
    }

    const OPTIONS: TimingOptions =
        TimingOptions { arc_length: true, integrator: Integrator::Gauss, step: 1e-4, cycling: Cycling::Off };

    fn plain() -> TimingOptions {
        TimingOptions { cycling: Cycling::Plain, ..OPTIONS }
    }

    #[test]
    fn the_clip_ends_where_the_path_ends() {
        for (length, n) in [(20.0, 11), (10.0, 11), (9.999, 10), (4.0, 5), (3.5, 4), (0.0, 1)] {
            let timing = Timing::along(&line(length), &progress(), 1.0, &OPTIONS);
            assert_eq!(timing.n_frames(), n, "length {length}");
            assert_eq!(timing.ends_early, n < 11);
            for (f, frame) in timing.frames.iter().enumerate() {
                assert!(frame.point.abs_diff_eq(DVec3::Z * f as f64, 1e-8));
            }
        }
    }

    #[test]
    fn plain_cycles_start_again_where_the_last_one_ended() {
        let timing = Timing::along(&line(25.0), &progress(), 1.0, &plain());
        assert_eq!(timing.seams, [11, 22]);
        assert_eq!(timing.n_frames(), 11 + 11 + 6);
        assert_eq!(timing.arc_lengths[10..13], [10.0, 10.0, 11.0], "the stutter is the thesis's");
        assert_eq!(timing.source_frames[22..], [0, 1, 2, 3, 4, 5]);
        assert_eq!(timing.arc_lengths[27], 25.0);
    }

    #[test]
    fn no_cycle_begins_at_the_very_end() {
        assert_eq!(Timing::along(&line(20.0), &progress(), 1.0, &plain()).n_frames(), 22);
        assert_eq!(Timing::along(&line(10.0), &progress(), 1.0, &plain()).n_frames(), 11);
        assert_eq!(Timing::along(&line(7.0), &progress(), 1.0, &plain()).n_frames(), 8);
    }

    #[test]
    fn tiny_and_endless_cycles_are_refused_with_words() {
        let tiny: Vec<f64> = progress().iter().map(|s| s * 1e-3).collect();
        let timing = Timing::along(&line(20.0), &tiny, 1.0, &plain());
        assert_eq!((timing.n_frames(), timing.warnings.len()), (11, 1));
        let timing = Timing::along(&line(1e6), &progress(), 1.0, &plain());
        assert_eq!((timing.n_frames(), timing.warnings.len()), (11, 1));
        let standing = Timing::along(&line(5.0), &[0.0; 4], 1.0, &plain());
        assert_eq!((standing.n_frames(), standing.warnings.len()), (4, 1));
    }

    #[test]
    fn without_arc_length_the_whole_path_is_used() {
        let points = [0.0, 0.0, 0.0, 9.0].map(|z| DVec3::Z * z).to_vec();
        let path = NewPath::new(BSpline::new(3, points), 0.5, 0.0);
        let options = TimingOptions { arc_length: false, ..OPTIONS };
        let timing = Timing::along(&path, &progress(), 1.0, &options);
        assert_eq!(timing.n_frames(), 11);
        for (f, frame) in timing.frames.iter().enumerate() {
            let expected = 9.0 * (f as f64 / 10.0).powi(3);
            assert!((frame.point.z - expected).abs() < 1e-12 && (timing.arc_lengths[f] - expected).abs() < 1e-9);
        }
        let one = Timing::along(&path, &[0.0], 1.0, &options);
        assert_eq!((one.n_frames(), one.frames[0].point.z), (1, 0.0));
    }

    #[test]
    fn euler_comes_close_to_gauss() {
        let points = [(0.0, 0.0), (0.0, 9.0), (9.0, 9.0), (9.0, -3.0)].map(|(x, z)| DVec3::new(x, 0.0, z)).to_vec();
        let path = NewPath::new(BSpline::new(3, points), 0.5, 0.0);
        let worst = |step: f64| {
            let options = TimingOptions { integrator: Integrator::Euler, step, ..OPTIONS };
            let euler = Timing::along(&path, &progress(), 1.0, &options);
            let gauss = Timing::along(&path, &progress(), 1.0, &OPTIONS);
            euler.frames.iter().zip(&gauss.frames).map(|(a, b)| a.point.distance(b.point)).fold(0.0, f64::max)
        };
        assert!(worst(1e-2) > worst(1e-3) && worst(1e-3) > worst(1e-4));
        assert!(worst(1e-4) < 1e-6, "{}", worst(1e-4));
    }
}
