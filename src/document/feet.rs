//! The feet of a clip: its legs, when they stand, and how well the edited clip keeps them standing.

use std::sync::Arc;

use glam::DVec3;

use super::{
    Edits,
    footprint::{Footprint, SourcePrint, footprints},
};
use crate::{
    constrain::Prepared,
    contact::{
        Detection, FileFrames, FootPlants, GroundSlope, Plant, PlantEdit, PlantEditMode, PlantMode, Thresholds,
        with_edits,
    },
    math::Rigid,
    measure::{Body, FootMeasure, FootNumbers, FootTracks, PlantSteps},
    motion::{Clip, ClipOptions, Decided, EditedClip, Leg, PointTracks, Side, legs::find_legs},
};

/// What is said of a clip without legs.
pub const NO_LEGS: &str = "no legs found: edited without holding; clip.legs names them";

/// What is found of feet in the source clip, before the user's own plants.
#[derive(Clone, Debug)]
pub struct FoundFeet {
    /// The legs, left ones first, and why these.
    pub legs: Decided<Vec<Leg>>,
    /// When each foot stands, in the order of the legs; clip frames.
    pub plants: Vec<FootPlants>,
    /// What could not be read as asked, one line each.
    warnings: Vec<String>,
}

impl FoundFeet {
    /// Finds legs and plants.
    fn of(clip: &Clip, asked: &ClipOptions, body: &Body, thresholds: Thresholds) -> Self {
        let mut warnings = Vec::new();
        let legs = find_legs(clip, &asked.legs, &mut warnings);
        match legs.value[..] {
            [] => warnings.push(NO_LEGS.to_owned()),
            // Who names one leg means one.
            [Leg { side, .. }] if asked.legs.is_empty() => warnings.push(format!(
                "no leg found beside the {} one: edited without holding the other foot; clip.legs names legs",
                side.name()
            )),
            _ => {}
        }
        let plants = Detection {
            tracks: body.tracks(),
            carrier: clip.facts.carrier.value.idx(),
            legs: &legs.value,
            frame_time_secs: clip.frame_time_secs,
            height: clip.facts.height.value,
            thresholds,
        }
        .plants();
        Self { legs, plants, warnings }
    }
}

/// The feet of the source clip.
#[derive(Clone, Debug)]
pub struct Feet {
    /// Legs and plants as found.
    pub found: Arc<FoundFeet>,
    /// When each foot stands, the user's plants among the found ones, in the order of the legs; clip frames.
    pub plants: Vec<FootPlants>,
    /// Which of `plants` are the user's, foot by foot.
    edited: Vec<Vec<bool>>,
    /// Where the feet stand in the source, foot by foot, as many as `plants`.
    pub prints: Vec<Vec<SourcePrint>>,
    /// How the ground under them slopes.
    pub slope: GroundSlope,
    /// What could not be read as asked, one line each.
    pub warnings: Vec<String>,
}

impl Feet {
    /// Puts the user's plants among the found ones; `found` is what an earlier solve found with the same thresholds.
    pub(super) fn of(clip: &Clip, edits: &Edits, body: &Body, found: Option<&Arc<FoundFeet>>) -> Self {
        let found =
            found.map_or_else(|| Arc::new(FoundFeet::of(clip, &edits.clip, body, edits.plants.detection)), Arc::clone);
        let mut warnings = found.warnings.clone();
        let frames = file_frames(clip);
        let plants = with_edits(found.plants.clone(), &edits.edited_plants, frames, &mut warnings);
        let by_user = |foot: &FootPlants| {
            let is_edited = |plant: &Plant| touches(&edits.edited_plants, foot.leg.side, frames.of(plant));
            foot.plants.iter().map(is_edited).collect()
        };
        let edited = plants.iter().map(by_user).collect();
        let prints = footprints(body.tracks(), &plants, clip.facts.floor);
        let mut feet = Self { found, plants, edited, prints, slope: GroundSlope::default(), warnings };
        let places: Vec<DVec3> = feet.standing_prints().map(|print| print.place).collect();
        feet.slope = GroundSlope::under(&places, clip.facts.height.value);
        feet
    }

    /// Returns the index of a side's foot, the first of several; none without such a leg.
    pub fn foot_idx(&self, side: Side) -> Option<usize> {
        self.plants.iter().position(|foot| foot.leg.side == side)
    }

    /// Tells whether a plant is the user's.
    pub fn is_edited(&self, foot_idx: usize, plant_idx: usize) -> bool {
        self.edited[foot_idx][plant_idx]
    }

    /// Returns where the feet stand in the source, without intended slides.
    pub(super) fn standing_prints(&self) -> impl Iterator<Item = Footprint> {
        let plants = self.plants.iter().flat_map(|foot| &foot.plants);
        let stands = |(print, plant): (&SourcePrint, &Plant)| (plant.mode != PlantMode::Slide).then_some(print.print);
        self.prints.iter().flatten().zip(plants).filter_map(stands)
    }
}

/// Prepares the legs of a clip to be held; `clean` removes the feet's own slide from plants that are only to be held.
pub(super) fn prepared(
    posed: &Arc<EditedClip>,
    own_carrier: &[Rigid],
    plants: &[FootPlants],
    clean: bool,
    earlier: Option<&Prepared>,
) -> Prepared {
    let mut feet = plants.to_vec();
    for plant in feet.iter_mut().flat_map(|foot| &mut foot.plants) {
        if clean && plant.mode == PlantMode::Hold {
            plant.mode = PlantMode::Clean;
        }
    }
    Prepared::new(posed, own_carrier, &feet, earlier)
}

/// Returns how the ground slopes under the feet of what walks, without its layers; `height` is the body's.
pub(super) fn ground(body: &Body, plants: &[FootPlants], height: f64) -> GroundSlope {
    let tracks = body.tracks();
    let places = plants.iter().flat_map(|foot| {
        let middle =
            |frame: usize| 0.5 * (tracks.position(foot.leg.ankle.idx(), frame) + tracks.position(foot.leg.toe, frame));
        foot.plants.iter().filter(|plant| plant.first < tracks.n_frames()).map(move |plant| {
            let frames = plant.first..(plant.last + 1).min(tracks.n_frames());
            let n = frames.len() as f64;
            frames.map(middle).sum::<DVec3>() / n
        })
    });
    GroundSlope::under(&places.collect::<Vec<_>>(), height)
}

/// Returns the points that are measured: ankle and toe of each leg.
pub(super) fn measured_points(plants: &[FootPlants]) -> Vec<usize> {
    plants.iter().flat_map(|foot| [foot.leg.ankle.idx(), foot.leg.toe]).collect()
}

/// Returns the feet among tracks of [`measured_points`].
pub(super) fn measured_feet(tracks: &PointTracks) -> Vec<FootTracks<'_>> {
    let foot = |ankle: usize| FootTracks { ankle: tracks.track(ankle), toe: tracks.track(ankle + 1) };
    (0..tracks.n_points()).step_by(2).map(foot).collect()
}

/// Measures each foot, source beside edited, in the order of the plants.
///
/// `edited` is where the edit has the feet; each frame shows the clip's frame of that index in `source_frames`,
/// and `is_joined` tells whether those are joined to one another where they do not follow on.
pub(super) fn numbers(
    (clip, body, steps): (&Clip, &Body, &[Vec<PlantSteps>]),
    plants: &[FootPlants],
    edited: &[FootTracks],
    source_frames: &[u32],
    is_joined: bool,
) -> Vec<FootNumbers> {
    let source = body.tracks();
    let measure = |(idx, foot): (usize, &FootPlants)| {
        FootMeasure {
            source: tracks_of(&foot.leg, source),
            edited: edited[idx],
            source_frames,
            plants: &foot.plants,
            source_steps: &steps[idx],
            is_joined,
            frame_time_secs: clip.frame_time_secs,
            height: clip.facts.height.value,
        }
        .numbers()
    };
    plants.iter().enumerate().map(measure).collect()
}

/// Returns what feet do in their plants where a clip has them, foot by foot.
pub(super) fn steps(body: &Body, plants: &[FootPlants]) -> Vec<Vec<PlantSteps>> {
    plants.iter().map(|foot| PlantSteps::of(&tracks_of(&foot.leg, body.tracks()), &foot.plants)).collect()
}

fn tracks_of<'a>(leg: &Leg, tracks: &'a PointTracks) -> FootTracks<'a> {
    FootTracks { ankle: tracks.track(leg.ankle.idx()), toe: tracks.track(leg.toe) }
}

/// Returns where a clip's frames lie in its file.
pub(super) fn file_frames(clip: &Clip) -> FileFrames {
    FileFrames { rest: clip.rest_frames(), n_frames: clip.n_frames() }
}

/// Tells whether the user made a plant of a foot somewhere in a range of file frames.
fn touches(edits: &[PlantEdit], foot: Side, [first, last]: [usize; 2]) -> bool {
    (edits.iter()).any(|e| e.foot == foot && e.mode != PlantEditMode::None && e.first <= last && first <= e.last)
}
