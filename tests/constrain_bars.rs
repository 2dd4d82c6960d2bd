//! Held feet, end to end: the bars they are kept under, and what must not change the result.
//!
//! The bench `hold` prints the same numbers for every captured clip and shape.

#[allow(dead_code, reason = "shared by two programs; neither uses all of it")]
mod hold_numbers;

use std::sync::OnceLock;

use glam::{DQuat, DVec3};
use hold_numbers::{Numbers, Plain, SHAPES, Subject, measure};
use proptest::prelude::*;
use walkabout::{
    bvh::Bvh,
    constrain::{Ground, Held, Prepared, hold},
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

/// Checks what every held edit keeps to; `offset` and `acceleration` are bounds that depend on the clip.
#[track_caller]
fn check(what: &str, n: &Numbers, acceleration: f64, offset: f64) {
    let told = format!("{what}: {n:?}");
    assert!(n.planted_speed <= 1.02 && n.slip <= 1.05, "{told}");
    assert!(n.clearance >= 0.9, "{told}");
    assert!(n.bones <= 1e-6, "{told}");
    assert!(n.jerk <= 1.3 && n.acceleration <= acceleration && n.offset <= offset, "{told}");
    assert!(n.knee_back_deg > -0.1, "{told}");
    assert_eq!(n.n_missed, 0, "{told}");
}

#[test]
fn the_built_in_walk_keeps_its_feet() {
    let subject = Subject::built_in();
    for kind in SHAPES {
        let plain = Plain::bent(&subject, kind, 13, 0.5);
        let before = measure(&subject, &plain.unheld());
        assert!(before.planted_speed > 3.0, "plain path editing slides: {before:?}");
        check(kind.name(), &measure(&subject, &plain.held(&subject, &subject.feet)), 2.0, 0.06);
        let clean = measure(&subject, &plain.held(&subject, &subject.with_mode(PlantMode::Clean)));
        assert!(clean.slip < 0.1 && clean.planted_speed < 0.1, "{}: {clean:?}", kind.name());
    }
}

#[test]
fn captured_walks_keep_their_feet() {
    let Some(dir) = clips() else { return };
    for (name, offset) in [("walk01", 0.06), ("cmu_12_03_walk", 0.06), ("zombie_turns_z_up", 0.2)] {
        let subject = Subject::read(&dir, name);
        for kind in [ShapeKind::Circle, ShapeKind::Zigzag, ShapeKind::Eight] {
            for degree in [5, 13] {
                let plain = Plain::bent(&subject, kind, degree, 0.5);
                let numbers = measure(&subject, &plain.held(&subject, &subject.feet));
                check(&format!("{name} {} {degree}", kind.name()), &numbers, 2.0, offset);
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
            let prepared = Prepared::new(&subject.clip, &subject.feet);
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
        prop_assert!(!held.missed.is_empty() || ramp || (numbers.slip < 1.05 && numbers.planted_speed < 1.02), "{numbers:?}");
    }
}
