//! `Source` and `Solved`: what goes into the solve and what comes out.

use std::{path::PathBuf, sync::Arc};

use glam::DVec3;

use super::{Cause, Edits, Feet, Footprint, Holding, Loops, Posed, Strain, Walked, solve, solve::Extent};
use crate::{
    bvh::Bvh,
    constrain::{self, Missed},
    math::Rigid,
    measure::{Body, FootNumbers, Measures},
    motion::{Clip, EditedClip, n_written_frames, to_bvh},
    path::{NewPath, OriginalPath, Residuals, Timing},
};

/// A clip as loaded; never changes.
#[derive(Debug)]
pub struct Source {
    /// Name to show, usually the file's.
    pub name: String,
    /// The file it was read from; none for the built-in clip.
    pub file: Option<PathBuf>,
    /// The file as it is.
    pub bvh: Bvh,
}

/// Everything that follows from a source and edits; stages that did not change are shared with the previous solve.
///
/// Positions are y-up world, the clip's unit, unless a method says otherwise. Frames do not count rest frames.
#[derive(Clone, Debug)]
pub struct Solved {
    /// The source.
    pub source: Arc<Source>,
    /// The edits.
    pub edits: Arc<Edits>,
    /// The source as a clip.
    pub clip: Arc<Clip>,
    /// World motion of the clip's carrier at each frame.
    pub carrier_track: Arc<Vec<Rigid>>,
    /// The clip's body, ready to be measured anywhere.
    pub body: Arc<Body>,
    /// The path fitted to the clip.
    pub original: Arc<OriginalPath>,
    /// What that path leaves over.
    pub residuals: Arc<Residuals>,
    /// Arc length of each frame on the original path, by the integrator in use.
    pub progress: Arc<Vec<f64>>,
    /// The new path; also while the path edit is off.
    pub new_path: Arc<NewPath>,
    /// Where each edited frame stands.
    pub timing: Arc<Timing>,
    /// The clip's loops; none unless cycling is blended.
    pub loops: Option<Arc<Loops>>,
    /// What walks the path: the clip, or the clip joined to itself.
    pub walked: Walked,
    /// The same with displacement maps on it.
    pub posed: Posed,
    /// The edited clip, of what walks, its feet held; joints that no leg hangs on as they walk, without layers.
    pub carried: Arc<EditedClip>,
    /// The edited clip, of what walks.
    pub walk: Arc<EditedClip>,
    /// The edited clip, of the clip as loaded.
    pub edited: Arc<EditedClip>,
    /// What holding the feet did; none while they are not held.
    pub holding: Option<Arc<Holding>>,
    /// Where the edit asks more than a body can do.
    pub strains: Arc<Vec<Strain>>,
    /// Quality numbers.
    pub measures: Arc<Measures>,
    /// Legs and foot plants of the source.
    pub feet: Arc<Feet>,
    /// Quality numbers of each foot, in the order of the legs.
    pub foot_numbers: Arc<Vec<FootNumbers>>,
    /// What could not be done as wished, one line each; also the clip's own warnings.
    pub warnings: Vec<String>,
    /// How far this was solved: numbers beyond that are those of the solve before, and no later one takes them.
    pub(super) extent: Extent,
    /// Where feet follow a pose near its frame alone, the last solve in which they followed everywhere: later ones take
    /// nothing but from that one.
    pub(super) whole: Option<Arc<Solved>>,
}

/// Where the edited clip shows a plant.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct ShownPlant {
    /// Index of the plant among its foot's.
    pub plant_idx: usize,
    /// First edited frame.
    pub first: usize,
    /// Last edited frame.
    pub last: usize,
}

impl Solved {
    /// Tells whether `measures` and `foot_numbers` are of these edits. Only a [`super::Document`] that shows drafts
    /// and [`super::solve_live`] have results of which they are not.
    pub fn is_measured(&self) -> bool {
        self.extent == Extent::All
    }

    /// Returns this solve, or the last one in which feet followed everywhere.
    pub(super) fn whole(&self) -> &Self {
        self.whole.as_deref().unwrap_or(self)
    }

    /// Tells whether the feet follow the edits everywhere, not only near a pose that was changed. Only a
    /// [`super::Document`] that shows drafts has results in which they do not.
    pub fn is_whole(&self) -> bool {
        self.whole.is_none()
    }

    /// Tells whether `foot_numbers` are of these edits.
    pub fn has_feet_measured(&self) -> bool {
        self.extent >= Extent::Feet
    }

    /// Returns the number in use of a parameter that may be `auto`; none for any other.
    pub fn in_use(&self, name: &str) -> Option<i64> {
        let rest = self.clip.rest_frames();
        let repeated = self.walked.repeat.map(|repeat| repeat.range);
        let number = match name {
            "clip.length" => self.clip.n_file_frames(),
            "clip.rest_frames" => rest,
            "original.degree" => self.original.degree(),
            "loop.start" => repeated.map_or(0, |range| range.first) + rest,
            "loop.end" => repeated.map_or(self.clip.n_frames(), |range| range.end) + rest,
            _ => return None,
        };
        i64::try_from(number).ok()
    }

    /// Tells whether the clip walks the new path: asked for, and possible.
    pub fn walks_new_path(&self) -> bool {
        self.edits.path.edited && self.clip.facts.path_editable
    }

    /// Returns the new path's control points, the clip's axes.
    pub fn control_points(&self) -> Vec<DVec3> {
        let up = self.clip.facts.up.value;
        self.new_path.spline().control_points().iter().map(|&p| up.to_file(p)).collect()
    }

    /// Returns the root mean square of what the original path leaves over, the clip's axes and unit.
    pub fn residual_rms(&self) -> DVec3 {
        self.clip.facts.up.value.to_file(self.original.deviation_rms()).abs()
    }

    /// Returns what the original path leaves over at each frame, the clip's axes; in world axes it is
    /// [`OriginalPath::deviations`].
    pub fn residual_series(&self) -> Vec<DVec3> {
        let up = self.clip.facts.up.value;
        self.original.deviations().iter().map(|&d| up.to_file(d)).collect()
    }

    /// Returns `n` points along the original path, evenly in arc length.
    pub fn original_polyline(&self, n: usize) -> Vec<DVec3> {
        self.original.polyline(n)
    }

    /// Returns `n` points along the new path, evenly in arc length.
    pub fn new_path_polyline(&self, n: usize) -> Vec<DVec3> {
        self.new_path.polyline(n)
    }

    /// Returns the clip's frame that an edited frame shows.
    ///
    /// # Panics
    ///
    /// When there is no such edited frame, as everywhere below.
    pub fn source_frame(&self, edited_frame: usize) -> usize {
        self.edited.source_frame(edited_frame)
    }

    /// Returns the first edited frame that shows a frame of the clip; none where the clip ends before it.
    pub fn edited_frame(&self, source_frame: usize) -> Option<usize> {
        // The first cycle begins at the clip's first frame and leaves none out up to its end.
        let n_shown = self.walked.repeat.map_or(self.clip.n_frames(), |repeat| repeat.range.end);
        (source_frame < self.edited.n_frames().min(n_shown)).then_some(source_frame)
    }

    /// Returns the edited frame nearest to `at` that shows a frame of the clip, or what is shown nearest to it.
    pub fn edited_frame_near(&self, source_frame: usize, at: usize) -> usize {
        let away = |frame: &usize| (self.source_frame(*frame).abs_diff(source_frame), frame.abs_diff(at));
        (0..self.edited.n_frames()).min_by_key(away).expect("a clip has frames")
    }

    /// Returns where the carrier is at an edited frame.
    pub fn carrier(&self, edited_frame: usize) -> Rigid {
        match self.edited.carrier_world.get(edited_frame) {
            Some(&carrier) => carrier,
            None => self.carrier_track[self.source_frame(edited_frame)],
        }
    }

    /// Returns the original path's frame at an edited frame, as the pose of a block that tracks the path.
    pub fn original_frame(&self, edited_frame: usize) -> Rigid {
        self.original.frames()[self.source_frame(edited_frame)].rigid(self.residuals.frame)
    }

    /// Returns the frame of the path walked at an edited frame, as the pose of a block that tracks the path.
    pub fn new_frame(&self, edited_frame: usize) -> Rigid {
        self.timing.frames[edited_frame].rigid(self.residuals.frame)
    }

    /// Returns where the feet stand: on the new path while they are held there, else in the source. A plant that is an
    /// intended slide has no print.
    pub fn footprints(&self) -> Vec<Footprint> {
        match &self.holding {
            Some(holding) => holding.footprints.iter().filter_map(|print| self.held_print(holding, print)).collect(),
            None => self.feet.standing_prints().collect(),
        }
    }

    fn held_print(&self, holding: &Holding, print: &constrain::Footprint) -> Option<Footprint> {
        let (foot_idx, plant_idx) = self.held_plant(print.leg, print.first)?;
        let missed = holding.missed.iter().find(|missed| (missed.leg, missed.first) == (print.leg, print.first));
        Some(Footprint {
            foot_idx,
            plant_idx,
            place: print.place - print.normal * self.feet.prints[foot_idx][plant_idx].clearance,
            heading_rad: print.heading_rad,
            normal: print.normal,
            missed_by: missed.map(|missed| missed.by),
        })
    }

    /// Returns which plant of which foot holding means by a leg and an edited frame.
    fn held_plant(&self, leg: usize, edited_frame: usize) -> Option<(usize, usize)> {
        let leg = self.posed.prepared.legs().nth(leg)?;
        let foot_idx = self.feet.plants.iter().position(|foot| foot.leg == leg)?;
        Some((foot_idx, self.feet.plants[foot_idx].at(self.source_frame(edited_frame))?))
    }

    /// Lists where the edited clip shows a foot's plants, in order of time. Those of a blended cycle go on with it; others
    /// stand where they are first shown.
    pub fn shown_plants(&self, foot_idx: usize) -> impl Iterator<Item = ShownPlant> {
        let last_shown = self.edited.n_frames().min(self.walked.clip.n_frames()) - 1;
        let shown = self.walked.plants[foot_idx].plants.iter().take_while(move |plant| plant.first <= last_shown);
        shown.filter_map(move |plant| {
            let plant_idx = self.feet.plants[foot_idx].at(self.source_frame(plant.first))?;
            Some(ShownPlant { plant_idx, first: plant.first, last: plant.last.min(last_shown) })
        })
    }

    /// Returns how a plant was missed, in the first cycle in which it was; none: it was reached, or is not held.
    pub fn missed(&self, foot_idx: usize, plant_idx: usize) -> Option<&Missed> {
        let is_it = |missed: &&Missed| self.held_plant(missed.leg, missed.first) == Some((foot_idx, plant_idx));
        self.holding.as_ref()?.missed.iter().find(is_it)
    }

    /// Returns the arc length along the path walked at which the edited clip ends.
    pub fn end_arc_length(&self) -> f64 {
        self.timing.arc_lengths[self.timing.n_frames() - 1]
    }

    /// Returns the number of frames that can be shown: rest frames, then edited frames; at least 1.
    pub fn n_shown_frames(&self) -> usize {
        self.clip.rest_frames() + self.edited.n_frames()
    }

    /// Returns the number of frames an export has: those that can be shown, but for a stationary clip whose length nobody
    /// chose: while it stands still it is exported as one frame, and as the file it is while nothing was done to it.
    pub fn n_exported_frames(&self) -> usize {
        n_written_frames(&self.source.bvh, &self.edited)
    }

    /// Says of every plant that could not be reached which it is and by how much, one line each. Frames are those of an
    /// export, counted from 0.
    pub fn missed_plants(&self) -> impl Iterator<Item = String> + '_ {
        let missed = self.holding.iter().flat_map(|holding| &holding.missed);
        missed.map(|missed| self.missed_plant(missed))
    }

    /// The same of one plant.
    pub fn missed_plant(&self, missed: &Missed) -> String {
        let rest = self.clip.rest_frames();
        let facts = &self.clip.facts;
        let side = self.posed.prepared.legs().nth(missed.leg).expect("a leg that is held").side.name();
        let [first, last, frame] = [missed.first, missed.last, missed.frame].map(|frame| frame + rest);
        format!(
            "the {side} foot cannot reach where it stands in frames {first} to {last}: {:.2} {} short at frame {frame} ({:.4} body heights)",
            missed.by,
            facts.unit_word(),
            missed.by / facts.height.value,
        )
    }

    /// Says what a strain is and by how much, in words.
    pub fn strain(&self, strain: &Strain) -> String {
        let facts = &self.clip.facts;
        let (height, unit) = (facts.height.value, facts.unit_word());
        let length = |l: f64| format!("{l:.2} {unit} ({:.2} body heights)", l / height);
        match strain.cause {
            Cause::Bend { radius, feasible, speed } => format!(
                "the path bends with a radius of {}; walked at {speed:.2} {unit}/s it takes {feasible:.2} {unit}",
                length(radius)
            ),
            Cause::Stride { leg, length: stride, longest } => format!(
                "a stride of the {} foot is {} long; the clip's own longest is {longest:.2} {unit}",
                leg.side.name(),
                length(stride)
            ),
            Cause::Reach { missed } => {
                let holding = self.holding.as_ref().expect("only held feet are out of reach");
                self.missed_plant(&holding.missed[missed])
            }
        }
    }

    /// Says what is too much at an edited frame, one line each.
    pub fn why(&self, edited_frame: usize) -> Vec<String> {
        let here = self.strains.iter().filter(|strain| strain.frames.contains(&edited_frame));
        here.map(|strain| self.strain(strain)).collect()
    }

    /// Returns the new path in pieces for drawing, `n` points over its whole length: what asks too much of a body, and
    /// the rest. Neighbouring pieces share a point.
    pub fn new_path_pieces(&self, n: usize) -> Vec<(Option<Cause>, Vec<DVec3>)> {
        let points = self.new_path.polyline(n);
        let spacing = self.new_path.length() / (n.max(2) - 1) as f64;
        let mut asked: Vec<Option<Cause>> = vec![None; points.len() - 1];
        for strain in self.strains.iter() {
            let arc = |frame: usize| self.timing.arc_lengths[frame.min(self.timing.n_frames() - 1)];
            let (from, to) = (arc(strain.frames.start), arc(strain.frames.end - 1));
            let first = ((from / spacing).floor() as usize).min(asked.len() - 1);
            let last = ((to / spacing).ceil() as usize).clamp(first + 1, asked.len());
            asked[first..last].fill(Some(strain.cause));
        }
        let mut pieces: Vec<(Option<Cause>, Vec<DVec3>)> = Vec::new();
        for (pair, cause) in points.windows(2).zip(asked) {
            match pieces.last_mut() {
                Some((last, piece)) if *last == cause => piece.push(pair[1]),
                _ => pieces.push((cause, pair.to_vec())),
            }
        }
        pieces
    }

    /// Returns the edited clip as a BVH file, as it is without interpolation keys.
    pub fn to_bvh(&self) -> Vec<u8> {
        if self.edits.interpolation_keys.is_none() {
            return self.to_bvh_interpolated();
        }
        let edits = Edits { interpolation_keys: None, ..(*self.edits).clone() };
        solve(&self.source, &Arc::new(edits), Some(self)).to_bvh_interpolated()
    }

    /// Returns the edited clip as a BVH file, as it is played: between interpolation keys their interpolation.
    pub fn to_bvh_interpolated(&self) -> Vec<u8> {
        to_bvh(&self.source.bvh, &self.edited)
    }
}
