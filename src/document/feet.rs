//! The feet of a clip: its legs, when they stand, and how well the edited clip keeps them standing.

use crate::{
    constrain::Prepared,
    contact::{Detection, FootPlants, PlantMode, Thresholds},
    measure::{Body, FootMeasure, FootNumbers, FootTracks, Placed, Turning},
    motion::{Clip, ClipOptions, Decided, EditedClip, Leg, legs::find_legs},
};

/// The feet of the source clip.
#[derive(Clone, Debug)]
pub struct Feet {
    /// The legs, left ones first, and why these.
    pub legs: Decided<Vec<Leg>>,
    /// When each foot stands, in the order of the legs; clip frames.
    pub plants: Vec<FootPlants>,
    /// What could not be read as asked, one line each.
    pub warnings: Vec<String>,
}

impl Feet {
    /// Finds legs and plants.
    pub(super) fn of(clip: &Clip, asked: &ClipOptions, body: &Body, thresholds: Thresholds) -> Self {
        let mut warnings = Vec::new();
        let legs = find_legs(clip, &asked.legs, &mut warnings);
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

    /// Prepares the legs to be held; `clean` removes the feet's own slide from plants that are only to be held.
    pub(super) fn prepared(&self, clip: &Clip, clean: bool) -> Prepared {
        let mut feet = self.plants.clone();
        for plant in feet.iter_mut().flat_map(|foot| &mut foot.plants) {
            if clean && plant.mode == PlantMode::Hold {
                plant.mode = PlantMode::Clean;
            }
        }
        Prepared::new(clip, &feet)
    }

    /// Prepares the joints that holding turns to be measured.
    pub(super) fn turning(clip: &Clip, prepared: &Prepared) -> Turning {
        Turning::of(clip, prepared.legs().flat_map(|leg| [leg.hip, leg.knee, leg.ankle]))
    }

    /// Measures each foot, source beside edited, in the order of the legs.
    pub(super) fn numbers(&self, clip: &Clip, body: &Body, placed: &Placed, edited: &EditedClip) -> Vec<FootNumbers> {
        let points: Vec<usize> = self.legs.value.iter().flat_map(|leg| [leg.ankle.idx(), leg.toe]).collect();
        let moved = body.points(&points, placed);
        let source = body.tracks();
        let measure = |(idx, foot): (usize, &FootPlants)| {
            FootMeasure {
                source: FootTracks { ankle: source.track(foot.leg.ankle.idx()), toe: source.track(foot.leg.toe) },
                edited: FootTracks { ankle: moved.track(2 * idx), toe: moved.track(2 * idx + 1) },
                source_frames: &edited.source_frames,
                plants: &foot.plants,
                frame_time_secs: clip.frame_time_secs,
                height: clip.facts.height.value,
            }
            .numbers()
        };
        self.plants.iter().enumerate().map(measure).collect()
    }
}
