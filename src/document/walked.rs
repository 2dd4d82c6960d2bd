//! What walks the new path: the clip, or the clip joined to itself so that it lasts (METHOD 7).
//!
//! Everything after this stage takes its frames from here and knows nothing of cycles. The number of cycles follows from
//! the new path's length, rounded up to few values: while a control point is dragged the joined clip stays the same.

use std::sync::Arc;

use super::{Feet, LoopEdits, Solved, feet, solve::reuse};
use crate::{
    contact::FootPlants,
    cycle::{Join, Joined, Loop, LoopFinder, LoopRange, Mismatch},
    math::Rigid,
    measure::{Body, FootNumbers, FootTracks, PlantSteps},
    motion::{Clip, EditedClip, TurnedJoint},
    path::{OriginalPath, PathFrame, Residuals, may_cycle},
};

/// Ends further apart than this are told: pose in body heights, velocity in body heights a second, phase.
const FAR: Mismatch = Mismatch { pose: 0.1, velocity: 1.0, phase: Some(0.25) };
/// A path is longer than the clip when it is by more than this share.
const END_SLACK: f64 = 1e-9;

/// What is repeated, and how.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Repeat {
    /// Frames that are repeated.
    pub range: LoopRange,
    /// Time on each side of a seam over which its mismatch is spread, seconds.
    pub blend_secs: f64,
    /// How often the range is shown again at most.
    pub n_cycles: usize,
}

/// What walks the path. Frames are its own: those of the clip, or of the clip joined to itself.
#[derive(Clone, Debug)]
pub struct Walked {
    /// What is repeated; none for the clip itself.
    pub repeat: Option<Repeat>,
    /// The clip joined to itself; none for the clip itself.
    pub joined: Option<Arc<Joined>>,
    /// Its poses.
    pub clip: Arc<Clip>,
    /// Its body, ready to be measured anywhere.
    pub body: Arc<Body>,
    /// What the original path, carried on, leaves over.
    pub residuals: Arc<Residuals>,
    /// Arc length of each frame on the original path, carried on.
    pub progress: Arc<Vec<f64>>,
    /// When each of its feet stands, in the order of the legs.
    pub plants: Vec<FootPlants>,
    /// What its feet do in them, foot by foot.
    pub(super) steps: Arc<Vec<Vec<PlantSteps>>>,
}

impl Walked {
    /// Returns the frames of the original path, carried on.
    pub(super) fn path<'a>(&'a self, original: &'a OriginalPath) -> &'a [PathFrame] {
        self.joined.as_ref().map_or(original.frames(), |joined| &joined.path)
    }

    /// Returns the seams before which a frame of the first `n_frames` stands.
    pub(super) fn seams(&self, n_frames: usize) -> Vec<usize> {
        let seams = self.joined.iter().flat_map(|joined| &joined.seams);
        seams.copied().filter(|&seam| seam < n_frames).collect()
    }

    /// Measures the feet on a walk that has them there; `edited` is the same as an edit of the clip as loaded.
    ///
    /// Beside a joined clip's numbers stand those of the clip as loaded: joining moves feet, too.
    pub(super) fn foot_numbers(
        &self,
        loaded: &Loaded,
        moved: &[FootTracks],
        walk: &EditedClip,
        edited: &EditedClip,
    ) -> Vec<FootNumbers> {
        let source = (&*self.clip, &*self.body, &self.steps[..]);
        let numbers = feet::numbers(source, &self.plants, moved, &walk.source_frames, false);
        if self.joined.is_none() {
            return numbers;
        }
        let steps = feet::steps(loaded.body, &loaded.feet.plants);
        let (source, frames) = ((&**loaded.clip, &**loaded.body, &steps[..]), &edited.source_frames);
        let source = feet::numbers(source, &loaded.feet.plants, moved, frames, true);
        numbers.into_iter().zip(&source).map(|(numbers, source)| numbers.beside(source)).collect()
    }

    /// Says what a walk is as an edit of the clip as loaded.
    pub(super) fn as_edit_of(&self, clip: &Arc<Clip>, walk: &Arc<EditedClip>) -> Arc<EditedClip> {
        let Some(joined) = &self.joined else { return Arc::clone(walk) };
        let n = walk.n_frames();
        let is_held = |turned: &&TurnedJoint| walk.turned.iter().any(|held| held.joint == turned.joint);
        let spread = joined.turned.iter().filter(|turned| !is_held(turned));
        let spread =
            spread.map(|turned| TurnedJoint { joint: turned.joint, rotations: turned.rotations[..n].to_vec() });
        Arc::new(EditedClip {
            clip: Arc::clone(clip),
            source_frames: joined.source_frames[..n].to_vec(),
            carrier_world: walk.carrier_world.clone(),
            turned: walk.turned.iter().cloned().chain(spread).collect(),
        })
    }
}

/// The stages of the clip as loaded that a walk is made of.
#[derive(Clone, Copy)]
pub(super) struct Loaded<'a> {
    pub(super) clip: &'a Arc<Clip>,
    pub(super) carrier: &'a [Rigid],
    pub(super) body: &'a Arc<Body>,
    pub(super) feet: &'a Arc<Feet>,
    pub(super) original: &'a Arc<OriginalPath>,
    pub(super) residuals: &'a Arc<Residuals>,
    pub(super) progress: &'a Arc<Vec<f64>>,
}

impl Loaded<'_> {
    /// Returns what walks the path.
    pub(super) fn walked(&self, repeat: Option<Repeat>, previous: Option<&Solved>) -> Walked {
        let (joined, clip, body, residuals, progress, plants) = match repeat {
            Some(repeat) => {
                let same = previous.filter(|p| {
                    p.walked.repeat == Some(repeat) && self.is_path_of(p) && p.feet.slope == self.feet.slope
                });
                let (joined, body, progress) = match same {
                    Some(p) => (p.walked.joined.clone(), Arc::clone(&p.walked.body), Arc::clone(&p.walked.progress)),
                    None => self.joined(&repeat),
                };
                let long = joined.as_ref().expect("what repeats is joined");
                let same_residuals = same.filter(|p| Arc::ptr_eq(&p.residuals, self.residuals));
                let residuals = reuse(
                    same_residuals,
                    |p| &p.walked.residuals,
                    || Residuals::of(&long.carrier, &long.path, self.residuals.frame),
                );
                let (clip, plants) = (Arc::clone(&long.clip), long.plants(&self.feet.plants));
                (joined, clip, body, residuals, progress, plants)
            }
            None => (
                None,
                Arc::clone(self.clip),
                Arc::clone(self.body),
                Arc::clone(self.residuals),
                Arc::clone(self.progress),
                self.feet.plants.clone(),
            ),
        };
        let same_feet = previous.filter(|p| Arc::ptr_eq(&p.walked.body, &body) && p.walked.plants == plants);
        let steps = reuse(same_feet, |p| &p.walked.steps, || feet::steps(&body, &plants));
        Walked { repeat, joined, clip, body, residuals, progress, plants, steps }
    }

    /// Tells whether an earlier solve has the same clip on the same path.
    fn is_path_of(&self, earlier: &Solved) -> bool {
        Arc::ptr_eq(&earlier.clip, self.clip)
            && Arc::ptr_eq(&earlier.original, self.original)
            && Arc::ptr_eq(&earlier.progress, self.progress)
    }

    fn joined(&self, repeat: &Repeat) -> (Option<Arc<Joined>>, Arc<Body>, Arc<Vec<f64>>) {
        let joined = Join {
            clip: self.clip,
            carrier: self.carrier,
            path: self.original.frames(),
            progress: self.progress,
            ground: self.feet.slope,
            range: repeat.range,
            blend_secs: repeat.blend_secs,
            n_cycles: repeat.n_cycles,
        }
        .joined();
        let body = Body::of(&joined.clip, &joined.carrier);
        let progress = joined.progress.clone();
        (Some(Arc::new(joined)), Arc::new(body), Arc::new(progress))
    }

    /// Returns the clip's loops and the one in use.
    pub(super) fn loops(&self, asked: LoopEdits, previous: Option<&Solved>) -> Arc<Loops> {
        let same = previous.filter(|p| self.is_path_of(p) && Arc::ptr_eq(&p.feet, self.feet));
        let earlier = same.and_then(|p| p.loops.as_ref());
        if let (Some(loops), Some(p)) = (earlier, same)
            && (p.edits.loops.start, p.edits.loops.end) == (asked.start, asked.end)
        {
            return Arc::clone(loops);
        }
        let finder = LoopFinder {
            clip: self.clip,
            tracks: self.body.tracks(),
            path: self.original.frames(),
            progress: self.progress,
            feet: &self.feet.plants,
        };
        let best = earlier.map_or_else(|| Arc::new(finder.best()), |loops| Arc::clone(&loops.best));
        Arc::new(Loops::new(best, &finder, asked))
    }
}

/// The loops of a clip.
#[derive(Clone, Debug)]
pub struct Loops {
    /// The best ones, the best first.
    pub best: Arc<Vec<Loop>>,
    /// The one in use: as asked, and the best one where nothing is; none where no loop can be made.
    pub used: Option<Loop>,
    /// What could not be done as wished, one line each.
    pub warnings: Vec<String>,
}

impl Loops {
    /// Takes the loop that is asked for; what is not asked for is the best.
    pub(super) fn new(best: Arc<Vec<Loop>>, finder: &LoopFinder, asked: LoopEdits) -> Self {
        let mut warnings = Vec::new();
        let used = used(&best, finder, asked, &mut warnings);
        if let Some(Loop { mismatch, .. }) = used
            && (mismatch.pose > FAR.pose || mismatch.velocity > FAR.velocity || mismatch.phase > FAR.phase)
        {
            warnings.push(format!("the ends of the loop are far apart: {mismatch}"));
        }
        Self { best, used, warnings }
    }
}

fn used(best: &[Loop], finder: &LoopFinder, asked: LoopEdits, warnings: &mut Vec<String>) -> Option<Loop> {
    let (n_frames, rest) = (finder.clip.n_frames(), finder.clip.rest_frames());
    let within = |frame: Option<usize>| frame.map(|frame| frame.saturating_sub(rest).min(n_frames));
    let (first, end) = match (within(asked.start), within(asked.end)) {
        (None, None) => match best.first() {
            Some(&best) => return Some(best),
            None => (0, n_frames),
        },
        (Some(first), Some(end)) => (first, end),
        (Some(first), None) => (first, finder.best_end(first).unwrap_or(n_frames)),
        (None, Some(end)) => (finder.best_first(end).unwrap_or(0), end),
    };
    if first + 2 > end || n_frames < 3 {
        let [first, end] = [first, end].map(|frame| frame + rest);
        warnings.push(format!("not cycled: a loop from file frame {first} to {end} is too short"));
        return None;
    }
    let range = LoopRange { first, end };
    Some(Loop { range, mismatch: finder.mismatch(range) })
}

/// Decides what is repeated so that a clip lasts along a path of a length, in the clip's unit; none where it does
/// anyway or cannot be repeated. Says what could not be done as wished.
pub(super) fn repeat(
    range: LoopRange,
    blend_secs: f64,
    progress: &[f64],
    (length, height): (f64, f64),
    warnings: &mut Vec<String>,
) -> Option<Repeat> {
    let last = progress.len() - 1;
    if length <= progress[last] * (1.0 + END_SLACK) {
        return None;
    }
    let end = progress.get(range.end).copied().unwrap_or(2.0 * progress[last] - progress[last - 1]);
    let period = end - progress[range.first];
    let n_cycles = ((length - end) / period + END_SLACK).ceil().max(1.0);
    may_cycle(period, n_cycles, range.n_frames(), height, warnings).then(|| Repeat {
        range,
        blend_secs,
        n_cycles: rounded_up(n_cycles as usize),
    })
}

/// Rounds a number of cycles up to 1, 2, 3, 4, 6, 8, 12, 16, …
fn rounded_up(n_cycles: usize) -> usize {
    let power = n_cycles.next_power_of_two();
    if 3 * power / 4 >= n_cycles && power >= 4 { 3 * power / 4 } else { power }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn cycles_are_rounded_up_to_few_numbers() {
        let rounded: Vec<usize> = (1..=17).map(rounded_up).collect();
        assert_eq!(rounded, [1, 2, 3, 4, 6, 6, 8, 8, 12, 12, 12, 12, 16, 16, 16, 16, 24]);
    }
}
