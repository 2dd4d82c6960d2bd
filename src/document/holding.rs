//! The stage that carries the clip along the path and holds its feet.
//!
//! Feet are held over whole cycles on a path carried on along its end, and only then is the result cut where the path
//! ends: so a path's length does not move a foot (METHOD 6).

use std::{borrow::Cow, ops::Range, sync::Arc};

use super::Posed;
use crate::{
    constrain::{Footprint, Ground, Held, HeldFoot, Job, Missed, hold},
    math::Rigid,
    motion::{Clip, EditedClip, TurnedJoint},
    path::{NewPath, PathFrame, Timing},
    skeleton::JointId,
    sync::listed,
};

/// What holding the feet did, beside the clip it made. Frames are edited frames.
#[derive(Clone, Debug, Default)]
pub struct Holding {
    /// Where the foot of each leg that can be held is, at least as many frames as are shown. None where several cycles
    /// were held one by one, or nothing had to be.
    pub(super) feet: Vec<HeldFoot>,
    /// Where the feet stand, cycle by cycle and leg by leg.
    pub footprints: Vec<Footprint>,
    /// Plants that could not be reached.
    pub missed: Vec<Missed>,
    /// Largest distance of the carrier from where plain path editing puts it, the clip's unit.
    pub largest_offset: f64,
}

/// What carries a clip along the path.
#[derive(Clone, Copy)]
pub(super) struct Carriage<'a> {
    /// What walks.
    pub(super) clip: &'a Arc<Clip>,
    /// The same with its layers.
    pub(super) posed: &'a Posed,
    /// The original path's frame at each of its frames.
    pub(super) original: &'a [PathFrame],
    /// Arc length of each frame on the original path.
    pub(super) progress: &'a [f64],
    pub(super) new_path: &'a NewPath,
    pub(super) timing: &'a Timing,
    /// Edited frames at which it starts again from its first frame.
    pub(super) restarts: &'a [usize],
}

impl Carriage<'_> {
    /// Carries the clip as METHOD 3 to 5 have it; the feet slide.
    pub(super) fn plain(&self) -> EditedClip {
        let (shown, path) = (&self.timing.source_frames, &self.timing.frames);
        EditedClip {
            clip: Arc::clone(self.clip),
            source_frames: self.timing.source_frames.clone(),
            carrier_world: listed(path.len(), |frames| frames.map(|f| self.posed.carrier(shown[f] as usize, &path[f]))),
            turned: Vec::new(),
        }
    }

    /// Carries the clip with its feet held.
    pub(super) fn held(&self, ground: Ground) -> (EditedClip, Holding) {
        let n = self.timing.n_frames();
        let mut edited = EditedClip {
            clip: Arc::clone(self.clip),
            source_frames: self.timing.source_frames.clone(),
            carrier_world: Vec::with_capacity(n),
            turned: Vec::new(),
        };
        let mut holding = Holding::default();
        let starts = std::iter::once(0).chain(self.restarts.iter().copied());
        let ends = self.restarts.iter().copied().chain([n]);
        for (first, end) in starts.zip(ends) {
            let path = self.whole_cycle(first, end);
            let carrier: Vec<Rigid> = listed(path.len(), |frames| frames.map(|f| self.posed.carrier(f, &path[f])));
            let own = self.posed.own_carrier(&path);
            let job = Job { carrier: &carrier, own: &own, path: &path, original: self.original, ground };
            append(&mut edited, &mut holding, hold(&self.posed.prepared, &job), first, end, &self.posed.legs);
        }
        (edited, holding)
    }

    /// Returns the path frames of all the clip's frames in the cycle that is shown from `first` to `end`.
    fn whole_cycle(&self, first: usize, end: usize) -> Cow<'_, [PathFrame]> {
        let mut path = Cow::Borrowed(&self.timing.frames[first..end]);
        let beyond = end - first..self.progress.len();
        if !beyond.is_empty() {
            path.to_mut().extend(frames_beyond(self.new_path, self.timing, self.progress, first, beyond));
        }
        path
    }
}

/// Returns the path's frames at frames of what walks that a cycle, shown from `first` on, has no more room for: on the path
/// carried on along its end.
pub(super) fn frames_beyond(
    new_path: &NewPath,
    timing: &Timing,
    progress: &[f64],
    first: usize,
    frames: Range<usize>,
) -> Vec<PathFrame> {
    let start = timing.arc_lengths[first] - progress[0];
    // Beyond the end the path is straight, so what an integrator makes of its length is only a shift.
    let shift = new_path.length() - timing.path_length;
    let beyond: Vec<f64> = progress[frames].iter().map(|s| start + s + shift).collect();
    new_path.frames_along(&beyond)
}

/// Appends a held cycle, cut to the frames that are shown. `posed` has the poses where nothing is turned.
fn append(edited: &mut EditedClip, holding: &mut Holding, held: Held, first: usize, end: usize, posed: &EditedClip) {
    let n = end - first;
    if first == 0 {
        (edited.carrier_world, edited.turned, holding.feet) = (held.carrier, held.turned, held.feet);
        edited.carrier_world.truncate(n);
        edited.turned.iter_mut().for_each(|turned| turned.rotations.truncate(n));
    } else {
        edited.carrier_world.extend_from_slice(&held.carrier[..n]);
        append_turned(edited, held.turned, first..end, posed);
        holding.feet.clear();
    }
    let shown = |frame: usize| first + frame.min(n - 1);
    holding.footprints.extend((held.footprints.into_iter()).filter(|print| print.first < n).map(|print| Footprint {
        first: shown(print.first),
        last: shown(print.last),
        ..print
    }));
    holding.missed.extend((held.missed.into_iter()).filter(|missed| missed.frame < n).map(|missed| Missed {
        first: shown(missed.first),
        last: shown(missed.last),
        frame: shown(missed.frame),
        ..missed
    }));
    holding.largest_offset = holding.largest_offset.max(held.largest_offset);
}

/// Appends the turned joints of another cycle. Either may have none, where nothing had to be held.
fn append_turned(edited: &mut EditedClip, more: Vec<TurnedJoint>, frames: Range<usize>, posed: &EditedClip) {
    let shown = edited.source_frames.clone();
    let own = |joint: JointId, frames: Range<usize>| {
        shown[frames].iter().map(|&f| posed.rotation(f as usize, joint)).collect::<Vec<_>>()
    };
    if edited.turned.is_empty() {
        let joints = more.iter().map(|turned| turned.joint);
        edited.turned = joints.map(|joint| TurnedJoint { joint, rotations: own(joint, 0..frames.start) }).collect();
    }
    for turned in &mut edited.turned {
        match more.iter().find(|more| more.joint == turned.joint) {
            Some(more) => turned.rotations.extend_from_slice(&more.rotations[..frames.len()]),
            None => turned.rotations.extend(own(turned.joint, frames.clone())),
        }
    }
}
