//! Held feet, end to end: the bars they are kept under, and what must not change the result.
//!
//! The bench `hold` prints the same numbers for every captured clip and shape.

#[allow(dead_code, reason = "shared by two programs; neither uses all of it")]
mod hold_numbers;

use std::sync::OnceLock;

use glam::{DQuat, DVec3};
use hold_numbers::{Plain, SHAPES, Subject, measure};
use proptest::prelude::*;
use walkabout::{
    bvh::Bvh,
    constrain::{Footprint, Ground, Held, Prepared, hold},
    contact::PlantMode,
    curve::BSpline,
    math::Rigid,
    motion::gait,
    path::{Degree, NewPath, OriginalPath, ShapeKind},
};

/// Names the folder of captured clips; says so loudly when there is none.
fn clips() -> Option<String> {
    let dir = std::env::var("WALKABOUT_CLIPS").ok();
    if dir.is_none() {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS must be set in CI");
        println!("SKIPPED: WALKABOUT_CLIPS is not set");
    }
    dir
}

/// Checks what every held edit keeps to, its feet as they are or clean.
///
/// `offset` bounds the carrier's offset in body heights. The bar is 0.06 on captured walks. On the built-in one it is more:
/// a polynomial of a low degree swings out where the clip ends standing, and plain path editing with it, further than
/// plants may give way.
#[track_caller]
fn check(what: &str, subject: &Subject, plain: &Plain, offset: f64) {
    for mode in [PlantMode::Hold, PlantMode::Clean] {
        let held = plain.held(subject, &subject.with_mode(mode));
        let n = measure(subject, &held);
        let gave_way = gave_way(subject, plain, &held);
        let told = format!("{} {what} {mode:?}: {n:?}", subject.name);
        let (speed, slip, jerk) = if mode == PlantMode::Clean { (0.1, 0.1, 1.4) } else { (1.02, 1.05, 1.33) };
        assert_eq!(n.n_missed, 0, "{told}");
        assert!(n.planted_speed <= speed && n.slip <= slip && n.foot_turn < 1e-9, "{told}");
        assert!(n.clearance >= 0.9 && n.bones <= 1e-6, "{told}");
        assert!(n.jerk <= jerk && n.acceleration <= 2.0 && n.end_jump <= 1.4, "{told}");
        assert!(n.knee_back_deg > -0.1 && n.knee_step <= 2.0, "{told}");
        assert!(gave_way <= offset, "{gave_way} {told}");
    }
}

/// Returns how far the carrier of a level path is from where plain path editing has it, but for the original path's own
/// rise and fall, which plain path editing takes off the whole body and holding does not; body heights.
fn gave_way(subject: &Subject, plain: &Plain, held: &Held) -> f64 {
    let rise = |f: usize| (plain.original[f].point.y - plain.original[0].point.y) * DVec3::Y;
    let away = (held.carrier.iter().zip(&plain.carrier).enumerate())
        .map(|(f, (held, plain))| held.translation.distance(plain.translation + rise(f)));
    away.fold(0.0, f64::max) / subject.clip.facts.height.value
}

#[test]
fn the_built_in_walk_keeps_its_feet() {
    let subject = Subject::built_in();
    for kind in SHAPES {
        for (degree, offset) in [(5, 0.095), (13, 0.04)] {
            let plain = Plain::bent(&subject, kind, degree, 0.5);
            let before = measure(&subject, &plain.unheld());
            assert!(before.planted_speed > 3.0, "plain path editing slides: {before:?}");
            check(&format!("{} {degree}", kind.name()), &subject, &plain, offset);
        }
    }
}

#[test]
fn captured_clips_keep_their_feet() {
    const CLIPS: [(&str, f64); 6] = [
        ("walk01", 0.035),
        ("cmu_12_03_walk", 0.045),
        ("figure8_walk", 0.06),
        ("zombie_turns_z_up", 0.06),
        ("cmu_131_01_start_walk_stop", 0.06),
        ("cmu_01_01_jumps", 0.06),
    ];
    let Some(dir) = clips() else { return };
    for (name, offset) in CLIPS {
        let subject = Subject::read(&dir, name);
        for kind in [ShapeKind::Circle, ShapeKind::Zigzag, ShapeKind::Eight] {
            for degree in [5, 13] {
                let plain = Plain::bent(&subject, kind, degree, 0.5);
                check(&format!("{} {degree}", kind.name()), &subject, &plain, offset);
            }
        }
    }
}

#[test]
fn a_clip_on_its_own_path_is_left_alone() {
    let subject = Subject::built_in();
    let original = OriginalPath::fit(&subject.carrier, Degree::Fixed(13), 0.5, subject.clip.facts.height.value);
    let frames = original.frames().to_vec();
    let plain = Plain { carrier: subject.carrier.clone(), path: frames.clone(), original: frames };
    let held = plain.held(&subject, &subject.feet);
    assert!(held.largest_offset < 1e-9 && held.missed.is_empty(), "{}", held.largest_offset);
    for turned in &held.turned {
        for (f, rotation) in turned.rotations.iter().enumerate() {
            let source = subject.clip.rotations(f)[turned.joint.idx()];
            let turn = (source.conjugate() * *rotation).xyz().length();
            assert!(turn < 1e-8, "joint {:?} frame {f}: {turn}", turned.joint);
        }
    }
}

#[test]
fn turning_and_moving_the_path_turns_and_moves_the_result() {
    let subject = Subject::built_in();
    let plain = Plain::bent(&subject, ShapeKind::S, 13, 0.5);
    let moved = Rigid::new(DQuat::from_rotation_y(2.2), DVec3::new(300.0, 40.0, -700.0));
    let elsewhere = Plain {
        carrier: plain.carrier.iter().map(|c| moved * *c).collect(),
        path: plain
            .path
            .iter()
            .map(|p| walkabout::path::PathFrame { point: moved.point(p.point), heading_rad: p.heading_rad + 2.2, ..*p })
            .collect(),
        original: plain.original.clone(),
    };
    let (here, there) = (plain.held(&subject, &subject.feet), elsewhere.held(&subject, &subject.feet));
    for (a, b) in here.carrier.iter().zip(&there.carrier) {
        assert!(moved.point(a.translation).distance(b.translation) < 1e-5);
    }
    assert_same_pose(&here, &there);
}

#[test]
fn a_clip_of_another_size_is_held_alike() {
    const SCALE: f64 = 0.01;
    let subject = Subject::built_in();
    let mut text = String::new();
    for line in gait::built_in().0.lines() {
        let scaled = |words: &str, n: usize| -> String {
            let all = words.split_whitespace().enumerate();
            all.map(|(i, w)| {
                if i < n { format!("{:.9} ", SCALE * w.parse::<f64>().expect("a number")) } else { format!("{w} ") }
            })
            .collect()
        };
        match line.trim().strip_prefix("OFFSET ") {
            Some(offset) => text += &format!("OFFSET {}\n", scaled(offset, 3)),
            None if line.trim().starts_with(|c: char| c == '-' || c.is_ascii_digit()) => {
                text += &format!("{}\n", scaled(line, 3));
            }
            None => text += &format!("{line}\n"),
        }
    }
    let small = Subject::new("small", &Bvh::parse(text.into_bytes(), "small").expect("a valid file"));
    let of = |s: &Subject| Plain::bent(s, ShapeKind::Circle, 13, 0.5).held(s, &s.feet);
    let (large, small) = (of(&subject), of(&small));
    for (a, b) in large.carrier.iter().zip(&small.carrier) {
        assert!(a.translation.distance(b.translation / SCALE) < 1e-2, "centimetres");
    }
}

#[track_caller]
fn assert_same_pose(a: &Held, b: &Held) {
    for (a, b) in a.turned.iter().zip(&b.turned) {
        let pairs = a.rotations.iter().zip(&b.rotations);
        let turn = pairs.map(|(a, b)| (a.conjugate() * *b).xyz().length()).fold(0.0, f64::max);
        assert!(a.joint == b.joint && turn < 1e-4, "{turn}");
    }
}

#[test]
fn footprints_stand_where_the_feet_do() {
    let subject = Subject::built_in();
    let plain = Plain::bent(&subject, ShapeKind::Eight, 13, 0.5);
    let held = plain.held(&subject, &subject.feet);
    let now = hold_numbers::tracks(&hold_numbers::edited(&subject, &held));
    assert_eq!(held.footprints.len(), subject.feet.iter().map(|f| f.plants.len()).sum::<usize>());
    for print in &held.footprints {
        let leg = subject.feet[print.leg].leg;
        let n = (print.last - print.first + 1) as f64;
        let mid = |f| 0.5 * (now.position(leg.ankle.idx(), f) + now.position(leg.toe, f));
        let mean = (print.first..=print.last).map(mid).sum::<DVec3>() / n;
        assert!(mean.distance(print.place) < 1e-6, "{print:?} {mean}");
    }
}

#[test]
fn on_a_level_path_feet_stand_as_high_as_they_stood() {
    let mut subjects = vec![Subject::built_in()];
    let names = ["cmu_131_01_start_walk_stop", "figure8_walk", "cmu_02_01_walk"];
    subjects.extend(clips().iter().flat_map(|dir| names.map(|name| Subject::read(dir, name))));
    for subject in &subjects {
        for degree in [5, 13] {
            let plain = Plain::bent(subject, ShapeKind::Circle, degree, 0.5);
            let held = plain.held(subject, &subject.feet);
            assert!(held.footprints.len() > 4);
            for print in &held.footprints {
                let leg = subject.feet[print.leg].leg;
                let mid =
                    |f| 0.5 * (subject.tracks.position(leg.ankle.idx(), f).y + subject.tracks.position(leg.toe, f).y);
                let n = (print.last - print.first + 1) as f64;
                let stood = (print.first..=print.last).map(mid).sum::<f64>() / n;
                let height = subject.clip.facts.height.value;
                assert!((print.place.y - stood).abs() < 1e-6 * height, "{} {degree}: {print:?} {stood}", subject.name);
            }
        }
    }
}

/// A straight path that climbs at this slope, bent a little, long enough for a clip.
fn climbing(subject: &Subject, slope_deg: f64) -> (OriginalPath, NewPath) {
    let height = subject.clip.facts.height.value;
    let original = OriginalPath::fit(&subject.carrier, Degree::Fixed(13), 0.5, height);
    let (start, length) = (original.frames()[0].point, 1.3 * original.length());
    let rise = slope_deg.to_radians().tan();
    let points = (0..8)
        .map(|i| {
            let along = length * f64::from(i) / 7.0;
            start + DVec3::new(0.1 * length * (0.6 * f64::from(i)).sin(), rise * along, along)
        })
        .collect();
    (original, NewPath::new(BSpline::new(3, points), 0.5 * height, 0.0))
}

#[test]
fn feet_climb_and_the_body_follows_smoothly() {
    let mut subjects = vec![Subject::built_in()];
    subjects.extend(clips().iter().flat_map(|dir| ["walk01", "cmu_12_03_walk"].map(|name| Subject::read(dir, name))));
    for subject in &subjects {
        let height = subject.clip.facts.height.value;
        let prepared = Prepared::new(&subject.posed(), &[], &subject.feet, None);
        for slope_deg in [10.0, 20.0] {
            let (original, path) = climbing(subject, slope_deg);
            let plain = Plain::along(subject, &original, &path);
            for ground in [Ground::Steps, Ground::Ramp] {
                let held = hold(&prepared, &plain.job(ground));
                let numbers = measure(subject, &held);
                let told = format!("{} {slope_deg}° {ground:?}: {numbers:?}", subject.name);
                assert!(held.missed.is_empty() && numbers.knee_back_deg > -0.1, "{told}");
                // The body follows smoothly.
                assert!(numbers.offset < 0.09 && numbers.jerk < 1.6, "{told}");
                // A tilted foot may stand on its other end for longer.
                assert!(numbers.planted_speed <= 1.02 && numbers.slip <= 1.06, "{told}");
                for print in &held.footprints {
                    let off = print.place.y - height_at(&path, print.place) - height_over(subject, &original, print);
                    assert!(off.abs() < 0.05 * height, "{told}: {print:?} {off}");
                }
            }
        }
    }
}

/// Returns the height of a path where it passes a place nearest.
fn height_at(path: &NewPath, place: DVec3) -> f64 {
    let away = |p: &DVec3| (p.x - place.x).hypot(p.z - place.z);
    let nearest = path.polyline(2000).into_iter().min_by(|a, b| away(a).total_cmp(&away(b)));
    nearest.expect("a path has points").y
}

/// Returns how far above the original path's begin the foot of a plant is in the source, on average.
fn height_over(subject: &Subject, original: &OriginalPath, print: &Footprint) -> f64 {
    let leg = subject.feet[print.leg].leg;
    let height = |point: usize, f: usize| subject.tracks.position(point, f).y;
    let over = |f: usize| 0.5 * (height(leg.ankle.idx(), f) + height(leg.toe, f)) - original.frames()[0].point.y;
    (print.first..=print.last).map(over).sum::<f64>() / (print.last - print.first + 1) as f64
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 24, ..ProptestConfig::default() })]

    #[test]
    fn any_path_gives_feet_that_do_not_slide(
        points in prop::collection::vec((-900.0..900.0f64, -30.0..30.0f64, -900.0..900.0f64), 4..9),
        ramp in any::<bool>(),
    ) {
        static SUBJECT: OnceLock<(Subject, Prepared)> = OnceLock::new();
        let (subject, prepared) = SUBJECT.get_or_init(|| {
            let subject = Subject::built_in();
            let prepared = Prepared::new(&subject.posed(), &[], &subject.feet, None);
            (subject, prepared)
        });
        let height = subject.clip.facts.height.value;
        let original = OriginalPath::fit(&subject.carrier, Degree::Fixed(13), 0.5, height);
        let points = points.into_iter().map(|(x, y, z)| DVec3::new(x, y, z)).collect();
        let path = NewPath::new(BSpline::new(3, points), 0.5 * height, 0.0);
        let plain = Plain::along(subject, &original, &path);
        let ground = if ramp { Ground::Ramp } else { Ground::Steps };
        let held = hold(prepared, &plain.job(ground));
        prop_assert!(held.carrier.iter().all(|c| c.translation.is_finite()));
        prop_assert!(held.turned.iter().flat_map(|t| &t.rotations).all(|r| r.is_normalized()));
        let numbers = measure(subject, &held);
        prop_assert!(numbers.bones < 1e-9, "{numbers:?}");
        // A path of any sharpness may ask too much of the legs; then it is said.
        prop_assert!(!held.missed.is_empty() || (numbers.slip < 1.05 && numbers.planted_speed < 1.02), "{numbers:?}");
    }
}
