//! Footprints of the source: where on the ground each foot stands, plant by plant.

use glam::DVec3;

use crate::{
    contact::{FootPlants, Plant},
    math::heading_rad,
    motion::PointTracks,
};

/// A footprint on the ground.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Footprint {
    /// Index of the foot in [`Feet::plants`](super::Feet::plants).
    pub foot_idx: usize,
    /// Index of the plant among that foot's.
    pub plant_idx: usize,
    /// On the ground, under the middle between ankle and toe in the mean over the plant, world.
    pub place: DVec3,
    /// Direction from ankle to toe, about up, radians.
    pub heading_rad: f64,
    /// By how much the plant could not be reached, clip's unit; none: it was.
    pub missed_by: Option<f64>,
}

/// A footprint of the source with what it takes to move it along with the foot.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct SourcePrint {
    /// Where the foot stands in the source.
    pub print: Footprint,
    /// Height of the middle between ankle and toe over the ground, in the mean over the plant; clip's unit.
    pub clearance: f64,
}

/// Returns the footprints of all feet, foot by foot in order of time. `floor` is the height of the lowest ground.
pub(super) fn footprints(tracks: &PointTracks, feet: &[FootPlants], floor: f64) -> Vec<Vec<SourcePrint>> {
    let of_foot = |(foot_idx, foot): (usize, &FootPlants)| {
        let sole = Sole::of(tracks, foot);
        let print = |(plant_idx, plant)| sole.print(foot_idx, plant_idx, plant, floor);
        foot.plants.iter().enumerate().map(print).collect()
    };
    feet.iter().enumerate().map(of_foot).collect()
}

/// The points of a foot that stand, and how high they are when they stand on the lowest ground.
struct Sole<'a> {
    tracks: &'a PointTracks,
    points: [usize; 2],
    lowest: [f64; 2],
}

impl<'a> Sole<'a> {
    fn of(tracks: &'a PointTracks, foot: &FootPlants) -> Self {
        let points = [foot.leg.ankle.idx(), foot.leg.toe];
        let planted = || foot.plants.iter().flat_map(frames);
        let lowest = points.map(|point| planted().map(|f| tracks.y(point)[f]).fold(f64::INFINITY, f64::min));
        Self { tracks, points, lowest }
    }

    fn print(&self, foot_idx: usize, plant_idx: usize, plant: &Plant, floor: f64) -> SourcePrint {
        let [ankle, toe] = self.points.map(|point| {
            frames(plant).map(|f| self.tracks.position(point, f)).sum::<DVec3>() / plant.n_frames() as f64
        });
        // Ankle and toe stand where they come nearest to what they are above the lowest ground.
        let above = |(&point, lowest): (&usize, &f64)| {
            frames(plant).map(|f| self.tracks.y(point)[f] - lowest).fold(f64::INFINITY, f64::min)
        };
        let ground = floor + self.points.iter().zip(&self.lowest).map(above).fold(f64::INFINITY, f64::min);
        let middle = ankle.midpoint(toe);
        let heading_rad = heading_rad(toe - ankle).unwrap_or(0.0);
        let print = Footprint { foot_idx, plant_idx, place: middle.with_y(ground), heading_rad, missed_by: None };
        SourcePrint { print, clearance: middle.y - ground }
    }
}

fn frames(plant: &Plant) -> std::ops::RangeInclusive<usize> {
    plant.first..=plant.last
}
