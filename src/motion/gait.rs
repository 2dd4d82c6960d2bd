//! The built-in clip: a made-up walk whose footprints, plants and path are known exactly.
//!
//! It is what a user sees first and what tests measure against, so it has to look like a person and leave nothing to
//! guess. The one idea: *footprints first, body after*. Steps are laid along a course; the feet follow from the steps,
//! the pelvis from where the feet carry the weight, the knees from hip and ankle by the cosine rule, trunk, head and
//! arms from the pelvis and the feet. A foot on the ground is never touched again.
//!
//! Sizes and timing are an average adult's: D. A. Winter, *Biomechanics and Motor Control of Human Movement* (4th ed.,
//! 2009), figure 4.1 (segment lengths); J. Perry and J. M. Burnfield, *Gait Analysis* (2nd ed., 2010), chapters 1, 3
//! and 7 (113 steps a minute, 40 % swing, heel, ankle and forefoot rockers, pelvis and trunk turns); M. P. Murray,
//! A. B. Drought and R. C. Kory, "Walking Patterns of Normal Men", *J. Bone Joint Surg.* 46-A (1964) (foot angle,
//! stride width, about 5 cm of vertical and 4 cm of lateral pelvis travel; 3 cm each here, as the steps are short and
//! even). They are rounded, and not one performer's.
//!
//! Lengths are centimetres, y is up, the walk sets out along +z and left is +x; 60 frames a second. The same text comes
//! out every time.

mod body;
mod carriage;
mod course;
mod curves;
mod figure;
mod foot;
mod steps;

use std::ops::RangeInclusive;

use glam::DVec3;

use body::Body;
use carriage::Carriage;
use course::Course;
use foot::Foot;
use steps::Steps;

/// What is known about the built-in clip because it was made, not measured.
#[derive(Clone, Debug, PartialEq)]
pub struct Truth {
    /// All foot plants, in the order in which they begin.
    pub plants: Vec<Plant>,
    /// The point of the walk's centre line under the body at each frame, world, height 0; the root stays within 5 cm of
    /// it.
    pub path: Vec<DVec3>,
    /// Frames at both ends in which nothing moves.
    pub still: [RangeInclusive<usize>; 2],
    /// Height of the top of the head when the figure stands, in centimetres.
    pub stature: f64,
}

/// One foot on the ground, from heel strike to toe-off.
#[derive(Clone, Debug, PartialEq)]
pub struct Plant {
    /// Which foot.
    pub side: Side,
    /// Frames in which some point of the foot stands still: heel, whole foot or toes.
    pub contact: RangeInclusive<usize>,
    /// Frames in which the whole foot stands still, ankle and toe joint included.
    pub flat: RangeInclusive<usize>,
    /// Frames in which the toe joint stands still, the foot turning about it at the end.
    pub toe_still: RangeInclusive<usize>,
    /// Where the ankle is while the foot is flat, world.
    pub ankle_world: DVec3,
    /// Where the toe joint is while it stands still, world.
    pub toe_world: DVec3,
}

/// A side of the body.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Side {
    /// +x of a figure that looks along +z.
    Left,
    /// −x of a figure that looks along +z.
    Right,
}

impl Side {
    /// Both, left first.
    const BOTH: [Self; 2] = [Self::Left, Self::Right];

    /// 1 on the left, −1 on the right.
    fn sign(self) -> f64 {
        match self {
            Self::Left => 1.0,
            Self::Right => -1.0,
        }
    }
}

/// Makes the built-in clip: its BVH text and what is known about it.
///
/// Twelve steps from standing to standing: straight on, 45° to the left along an arc of 5 m, straight on.
pub fn built_in() -> (String, Truth) {
    let course = Course::BUILT_IN;
    let steps = Steps::laid_along(&course);
    let feet = Side::BOTH.map(|side| Foot::new(&steps, side));
    let carriage = Carriage::over(&steps);
    let rows: Vec<_> = (0..steps.n_frames)
        .map(|frame| Body::at(&carriage.at(frame), [feet[0].at(frame), feet[1].at(frame)]).channels())
        .collect();

    let truth = Truth {
        plants: steps.plants.iter().map(|plant| plant.truth()).collect(),
        path: carriage.path(&course),
        still: [0..=carriage.first_moving - 1, carriage.last_moving + 1..=steps.n_frames - 1],
        stature: figure::STATURE,
    };
    (figure::text(&rows), truth)
}

#[cfg(test)]
mod tests {
    use glam::DMat3;

    use super::*;
    use crate::{
        bvh::Bvh,
        math::Rigid,
        motion::{Clip, ClipOptions},
    };

    /// A planted point may move by this: a millionth of the stature.
    const STILL_ENOUGH: f64 = figure::STATURE * 1e-6;

    /// The built-in clip as the rest of the program reads it.
    struct Read {
        truth: Truth,
        bvh: Bvh,
        clip: Clip,
        /// Joints and end sites, by frame.
        points: Vec<Vec<DVec3>>,
    }

    fn read() -> Read {
        let (text, truth) = built_in();
        let bvh = Bvh::parse(text.into_bytes(), "built-in").unwrap();
        let clip = Clip::from_bvh(&bvh, &ClipOptions::default());
        assert_eq!(clip.rest_frames(), 0);
        let world = |frame| {
            let mut points = Vec::new();
            clip.world_points(frame, &mut points);
            points
        };
        let points = (0..clip.n_frames()).map(world).collect();
        Read { truth, bvh, points, clip }
    }

    impl Read {
        fn joint(&self, side: Side, name: &str) -> usize {
            self.clip.skeleton.find(&format!("{side:?}{name}")).unwrap().idx()
        }

        fn point(&self, frame: usize, side: Side, name: &str) -> DVec3 {
            self.points[frame][self.joint(side, name)]
        }
    }

    #[test]
    fn the_clip_is_a_sound_file_that_stands_walks_and_stands() {
        let read = read();
        assert!(read.bvh.warnings().is_empty(), "{:?}", read.bvh.warnings());
        assert_eq!(read.bvh.joints().len(), 21);
        assert!(read.clip.warnings.is_empty(), "{:?}", read.clip.warnings);
        assert!(read.clip.facts.path_editable);
        assert_eq!(read.clip.facts.unit.value, Some("cm"));
        let height = read.clip.facts.height.value;
        assert!((height / read.truth.stature - 1.0).abs() < 0.03, "{height}");

        let [before, after] = &read.truth.still;
        let (first_end, last_start) = (*before.end(), *after.start());
        assert!(first_end >= 30 && after.end() - last_start >= 30 && after.end() + 1 == read.bvh.n_frames());
        assert!(before.clone().all(|f| read.bvh.frame(f) == read.bvh.frame(0)));
        assert!(after.clone().all(|f| read.bvh.frame(f) == read.bvh.frame(last_start)));
        assert_eq!(built_in().0.as_bytes(), &read.bvh.text()[..], "the same text comes out every time");
    }

    #[test]
    fn planted_feet_stand_exactly_where_the_truth_says() {
        let read = read();
        assert_eq!(read.truth.plants.len(), 14);
        for plant in &read.truth.plants {
            assert!(plant.flat.clone().count() >= 15 && plant.toe_still.end() == plant.contact.end());
            for frame in plant.flat.clone() {
                let slip = read.point(frame, plant.side, "Ankle") - plant.ankle_world;
                assert!(slip.length() < STILL_ENOUGH, "{:?} ankle at {frame}: {slip}", plant.side);
            }
            for frame in plant.toe_still.clone() {
                let slip = read.point(frame, plant.side, "Toe") - plant.toe_world;
                assert!(slip.length() < STILL_ENOUGH, "{:?} toe at {frame}: {slip}", plant.side);
            }
        }
        for side in Side::BOTH {
            let plants: Vec<_> = read.truth.plants.iter().filter(|plant| plant.side == side).collect();
            for pair in plants.windows(2) {
                let middle = (pair[0].contact.end() + pair[1].contact.start()) / 2;
                let step = read.point(middle, side, "Ankle") - read.point(middle - 1, side, "Ankle");
                assert!(step.length() > 2.0, "{side:?} swings at {middle}");
            }
        }
    }

    #[test]
    fn the_heel_stands_while_the_foot_comes_down() {
        let read = read();
        let mut rigids: Vec<Rigid> = Vec::new();
        for plant in read.truth.plants.iter().filter(|plant| *plant.contact.start() > 0) {
            let heel_world = plant.ankle_world.with_y(0.0) - figure::HEEL_BEHIND_ANKLE * ahead(plant);
            for frame in *plant.contact.start()..*plant.flat.start() {
                read.clip.world_rigids(frame, &mut rigids);
                let ankle = rigids[read.joint(plant.side, "Ankle")];
                let heel = DVec3::new(0.0, -figure::ANKLE_HEIGHT, -figure::HEEL_BEHIND_ANKLE);
                let slip = ankle.translation + ankle.rotation * heel - heel_world;
                assert!(slip.length() < STILL_ENOUGH, "{:?} heel at {frame}: {slip}", plant.side);
            }
        }
    }

    /// Where the toes of a planted foot point.
    fn ahead(plant: &Plant) -> DVec3 {
        (plant.toe_world - plant.ankle_world).with_y(0.0).normalize()
    }

    #[test]
    fn every_ankle_is_where_its_foot_was_put() {
        let read = read();
        let steps = Steps::laid_along(&Course::BUILT_IN);
        for side in Side::BOTH {
            let foot = Foot::new(&steps, side);
            for frame in 0..read.bvh.n_frames() {
                let off = read.point(frame, side, "Ankle") - foot.at(frame).ankle;
                assert!(off.length() < STILL_ENOUGH, "{side:?} at {frame}: {off}");
            }
        }
    }

    #[test]
    fn knees_are_hinges_that_never_bend_backwards_or_lock() {
        let read = read();
        for side in Side::BOTH {
            let first = read.bvh.joints()[read.joint(side, "Knee")].first_channel;
            for frame in 0..read.bvh.n_frames() {
                let [z, x, y] = read.bvh.frame(frame)[first..first + 3] else { unreachable!("three channels") };
                assert_eq!((z, y), (0.0, 0.0));
                assert!((5.0..70.0).contains(&x), "{side:?} knee at {frame}: {x}°");
            }
        }
    }

    #[test]
    fn nothing_pops_and_nothing_sinks_into_the_ground() {
        let read = read();
        for frame in 1..read.bvh.n_frames() {
            for (channel, (now, before)) in read.bvh.frame(frame).iter().zip(read.bvh.frame(frame - 1)).enumerate() {
                assert!((now - before).abs() < 10.0, "channel {channel} at {frame}: {before} to {now}");
            }
        }
        let mut worst = 0.0_f64;
        for (frame, four) in read.points.windows(4).enumerate() {
            for (point, p) in four[3].iter().enumerate() {
                assert!(p.y > 0.3, "point {point} at {frame}: {p}");
                let third = *p - 3.0 * four[2][point] + 3.0 * four[1][point] - four[0][point];
                worst = worst.max(third.length());
                assert!(third.length() < 1.5, "point {point} at {frame}: third difference {third}");
            }
        }
        println!("largest third difference: {worst:.3} cm");
    }

    #[test]
    fn the_body_follows_the_course_and_bobs_and_sways_as_people_do() {
        let read = read();
        let mut worst = 0.0_f64;
        for (frame, path) in read.truth.path.iter().enumerate() {
            let off = read.points[frame][0].with_y(0.0) - *path;
            worst = worst.max(off.length());
        }
        println!("largest distance of the root from the course: {worst:.2} cm");
        assert!(worst < 5.0, "{worst}");

        let extent = |values: &dyn Fn(usize) -> f64| {
            let stride = (250..250 + 2 * steps::STEP).map(values);
            stride.clone().fold(f64::MIN, f64::max) - stride.fold(f64::MAX, f64::min)
        };
        let bob = extent(&|frame| read.points[frame][0].y);
        let sway = extent(&|frame| {
            let ahead = (read.truth.path[frame + 1] - read.truth.path[frame]).normalize();
            (read.points[frame][0] - read.truth.path[frame]).dot(DVec3::Y.cross(ahead))
        });
        println!("bob {bob:.2} cm, sway {sway:.2} cm");
        assert!((2.5..5.5).contains(&bob) && (2.5..5.5).contains(&sway), "{bob} {sway}");

        let path = &read.truth.path;
        let speed = |frame: usize| path[frame + 1].distance(path[frame]) * 60.0;
        for frame in 190..380 {
            assert!((speed(frame) - 131.25).abs() < 0.05, "{frame}: {}", speed(frame));
        }
        let turn = Course::BUILT_IN.heading_rad(1e9);
        let end = path[path.len() - 1] - path[path.len() - 20];
        assert!(end.length() < 1e-9, "it stands at the end");
        let direction = path[450] - path[440];
        assert!(direction.normalize().distance(DMat3::from_rotation_y(turn) * DVec3::Z) < 1e-9);
    }
}
