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
    /// Upright of the ground it stands on, unit, world; leans where the foot is tilted with a ramp.
    pub normal: DVec3,
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
        let place = middle.with_y(ground);
        let print = Footprint { foot_idx, plant_idx, place, heading_rad, normal: DVec3::Y, missed_by: None };
        SourcePrint { print, clearance: middle.y - ground }
    }
}

fn frames(plant: &Plant) -> std::ops::RangeInclusive<usize> {
    plant.first..=plant.last
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{Change, Document, Solved, open};

    /// The built-in clip after `NAME=VALUE` settings and a shape.
    fn solved(settings: &[(&str, toml::Value)], shape: Option<&str>) -> Document {
        let mut document = Document::new(open(None).expect("the built-in clip"));
        let values = settings.iter().map(|(name, value)| ((*name).to_owned(), value.clone())).collect();
        let shape = shape.map(|s| s.parse().expect("a shape"));
        document.apply(&Change::Set { values, shape }, false).expect("a change");
        document
    }

    /// Returns the mean of the middle between ankle and toe over a plant of the edited clip.
    fn middle(solved: &Solved, print: &Footprint) -> DVec3 {
        let foot = &solved.feet.plants[print.foot_idx];
        let plant = foot.plants[print.plant_idx];
        let mut points = Vec::new();
        let middles = frames(&plant).map(|frame| {
            solved.edited.world_points(frame, &mut points);
            points[foot.leg.ankle.idx()].midpoint(points[foot.leg.toe])
        });
        middles.sum::<DVec3>() / plant.n_frames() as f64
    }

    /// Compares the footprints with where the feet of the edited clip are.
    #[track_caller]
    fn check(solved: &Solved, level: bool) {
        let height = solved.clip.facts.height.value;
        let prints = solved.footprints();
        assert!(prints.len() >= 12, "{}", prints.len());
        for print in &prints {
            let off = print.place - middle(solved, print);
            assert!(off.with_y(0.0).length() < 0.005 * height, "{print:?} is off by {off}");
            assert!((0.01..0.06).contains(&(-off.y / height)), "{print:?} is under the foot: {off}");
            assert_eq!(level, (print.place.y - solved.clip.facts.floor).abs() < 0.02 * height, "{print:?}");
        }
    }

    #[test]
    fn footprints_are_under_the_feet_where_they_stand_and_where_they_are_held() {
        check(solved(&[("path.edited", false.into())], None).solved(), true);
        check(solved(&[], Some("circle")).solved(), true);
    }

    #[test]
    fn footprints_are_at_the_height_of_the_path() {
        let mut document = solved(&[], Some("line"));
        let raised: Vec<toml::Value> = (document.solved().control_points().iter())
            .map(|p| vec![p.x, p.y + 150.0 + 0.2 * p.z, p.z].into())
            .collect();
        let set = ("path.control_points".to_owned(), toml::Value::Array(raised));
        document.apply(&Change::Set { values: vec![set], shape: None }, false).expect("a path");
        for (ground, slope_rad) in [("ramp", 0.2f64.atan()), ("steps", 0.0)] {
            let set = ("plants.ground".to_owned(), ground.into());
            document.apply(&Change::Set { values: vec![set], shape: None }, false).expect("a ground");
            check(document.solved(), false);
            for print in document.solved().footprints() {
                let leans = print.normal.angle_between(DVec3::Y);
                assert!((leans - slope_rad).abs() < 0.03, "{ground}: {print:?} leans by {leans}");
            }
        }
    }

    #[test]
    fn without_holding_the_source_s_own_are_shown_and_a_slide_has_none() {
        let plain = solved(&[("plants.hold", false.into())], Some("circle"));
        let source = solved(&[("path.edited", false.into())], None);
        assert_eq!(plain.solved().footprints(), source.solved().footprints());
        let slide = "plant = [{ foot = \"left\", first = 0, last = 900, mode = \"slide\" }]";
        let value = slide.parse::<toml::Table>().expect("TOML").remove("plant").expect("a list");
        for hold in [true, false] {
            let sliding = solved(&[("plants.hold", hold.into()), ("plant", value.clone())], Some("circle"));
            let prints = sliding.solved().footprints();
            assert!(!prints.is_empty() && prints.iter().all(|print| print.foot_idx == 1), "holding: {hold}");
        }
    }
}
