//! The solve as its callers see it: what is shared, what moves along, what holds for clips that hardly move.

use std::{fmt::Write as _, sync::Arc};

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    document::{Cycling, Edits, Solved, Source, solve},
    math::Rigid,
    motion::UpAxis,
    path::{Degree, Integrator, ResidualFrame, Shape, ShapeKind, shape_points},
};

/// A carrier with one joint and an end site, at places and headings (degrees).
fn source(places: impl IntoIterator<Item = (DVec3, f64)>) -> Arc<Source> {
    let rows: Vec<(DVec3, f64)> = places.into_iter().collect();
    let mut text = String::from(
        "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Yrotation Xrotation Zrotation\n\
         JOINT Leg\n{\nOFFSET 0.1 -0.9 0\nCHANNELS 3 Zrotation Xrotation Yrotation\n\
         End Site\n{\nOFFSET 0 -0.1 0.2\n}\n}\n}\n",
    );
    write!(text, "MOTION\nFrames: {}\nFrame Time: 0.01\n", rows.len()).expect("into a String");
    for (f, (p, heading)) in rows.iter().enumerate() {
        let swing = 20.0 * (f as f64 * 0.2).sin();
        writeln!(text, "{:?} {:?} {:?} {heading:?} 3 1 0 {swing:?} 0", p.x, p.y, p.z).expect("into a String");
    }
    let bvh = Bvh::parse(text.into_bytes(), "test").expect("a valid file");
    Arc::new(Source { name: "test".to_owned(), file: None, bvh })
}

/// A walk with a bend, a stop in the middle and some bounce.
fn walk() -> Arc<Source> {
    source((0..400).map(|f| {
        let going = f as f64 / 100.0 - (f as f64 / 50.0).sin() * 0.3;
        let bounce = 0.02 * (f as f64 * 0.4).sin();
        (DVec3::new(0.8 * (0.9 * going).sin(), 1.0 + bounce, 1.4 * going), 40.0 * (0.9 * going).cos())
    }))
}

fn solved(source: &Arc<Source>, change: impl FnOnce(&mut Edits), previous: Option<&Solved>) -> Solved {
    let mut edits = previous.map_or_else(Edits::default, |p| (*p.edits).clone());
    // Two joints are too little of a body to tell up from.
    edits.clip.up = Some(UpAxis::Y);
    change(&mut edits);
    solve(source, &Arc::new(edits), previous)
}

/// Which stages two solves share, in order: clip, original, residuals, progress, new path, timing, edited, measures.
fn shared(a: &Solved, b: &Solved) -> String {
    let marks = [
        Arc::ptr_eq(&a.clip, &b.clip) && Arc::ptr_eq(&a.body, &b.body),
        Arc::ptr_eq(&a.original, &b.original),
        Arc::ptr_eq(&a.residuals, &b.residuals),
        Arc::ptr_eq(&a.progress, &b.progress),
        Arc::ptr_eq(&a.new_path, &b.new_path),
        Arc::ptr_eq(&a.timing, &b.timing),
        Arc::ptr_eq(&a.edited, &b.edited),
        Arc::ptr_eq(&a.measures, &b.measures),
    ];
    marks.iter().zip("corpntem".chars()).map(|(&kept, name)| if kept { name } else { '.' }).collect()
}

fn bend(solved: &Solved) -> Vec<DVec3> {
    let mut points = solved.control_points();
    points[3].x += 0.7;
    points
}

#[test]
fn a_change_leaves_the_stages_it_does_not_touch() {
    let source = walk();
    let start = solved(&source, |_| {}, None);
    let points = bend(&start);
    let start = solved(&source, |e| e.path.control_points = Some(points), None);
    type Case = (&'static str, fn(&mut Edits), &'static str);
    let cases: [Case; 16] = [
        ("nothing", |_| {}, "corpntem"),
        ("nudge", |e| e.path.nudge = 0.3, "corpntem"),
        ("speed", |e| e.timing.speed = 2.0, "corpntem"),
        ("count beside given points", |e| e.path.points = 12, "corpntem"),
        ("a point", |e| e.path.control_points.as_mut().expect("given")[2].z += 0.1, "corp...."),
        ("path degree", |e| e.path.degree = 2, "corp...."),
        ("path off", |e| e.path.edited = false, "corpn..."),
        ("original degree", |e| e.original.degree = Degree::Fixed(3), "c......."),
        ("window", |e| e.heading.window = 0.2, "c......."),
        ("residual frame", |e| e.residual.frame = ResidualFrame::Tangent, "co.pnt.."),
        ("arc length", |e| e.timing.arc_length = false, "corpn..."),
        ("euler", |e| e.timing.integrator = Integrator::Euler, "cor.n..."),
        ("a step gauss does not take", |e| e.timing.step = 0.01, "corpntem"),
        ("cycling", |e| e.timing.cycling = Cycling::Plain, "corpn..."),
        ("rest frames", |e| e.clip.rest_frames = Some(3), "........"),
        ("straight", |e| e.path.control_points = None, "corp...."),
    ];
    for (name, change, expected) in cases {
        let next = solved(&source, change, Some(&start));
        let mut found = shared(&start, &next);
        if matches!(name, "original degree" | "window") {
            // A new original path brings a new heading for the new path to fall back on.
            found = found.replace('n', ".");
        }
        assert_eq!(found, expected, "{name}");
        // What was handed on does not show: from nothing the result is the same.
        let afresh = solve(&source, &next.edits, None);
        assert_eq!(next.edited.carrier_world, afresh.edited.carrier_world, "{name}");
        assert_eq!(next.measures, afresh.measures, "{name}");
        assert_eq!(next.warnings, afresh.warnings, "{name}");
    }
    let other = solved(&walk(), |_| {}, None);
    assert_eq!(shared(&start, &solve(&other.source, &start.edits, Some(&start))), "....n...");
}

#[test]
fn with_the_path_off_the_export_is_the_file() {
    let source = walk();
    let off = solved(&source, |e| e.path.edited = false, None);
    assert_eq!(off.to_bvh(), source.bvh.text().to_vec());
    assert_eq!(off.measures.jerk_ratio, Some(1.0));
    assert_eq!(off.measures.path_error, None);
    for f in 0..off.edited.n_frames() {
        assert_eq!(off.new_frame(f), off.original_frame(f));
        assert_eq!(off.carrier(f), off.clip.carrier_world(f));
    }
}

#[test]
fn residuals_along_the_original_path_are_the_source() {
    let source = walk();
    for frame in [ResidualFrame::Heading, ResidualFrame::Tangent, ResidualFrame::Absolute] {
        for window in [0.0, 0.5] {
            let result = solved(
                &source,
                |e| {
                    e.residual.frame = frame;
                    e.heading.window = window;
                },
                None,
            );
            for (f, at) in result.original.frames().iter().enumerate() {
                let (again, was) = (result.residuals.apply(f, at), result.carrier_track[f]);
                let slack = 1e-9 * result.clip.facts.height.value;
                assert!(again.translation.distance(was.translation) < slack, "{frame:?} {window} frame {f}");
                assert!(again.rotation.angle_between(was.rotation) < 1e-7);
            }
        }
    }
}

/// Turning about up and moving the clip together with its control points does the same to the result.
#[test]
fn the_result_turns_and_moves_with_clip_and_path() {
    let turn_degrees = 73.0f64;
    let moved_by = Rigid::new(DQuat::from_rotation_y(turn_degrees.to_radians()), DVec3::new(3.0, 0.5, -2.0));
    let plain = walk();
    let plain_clip = solved(&plain, |_| {}, None);
    let carriers: Vec<(DVec3, f64)> = (0..400)
        .map(|f| {
            let row = plain.bvh.frame(f);
            (moved_by.point(DVec3::new(row[0], row[1], row[2])), row[3] + turn_degrees)
        })
        .collect();
    let moved = source(carriers);
    for kind in [ShapeKind::Eight, ShapeKind::Zigzag, ShapeKind::U] {
        let points = shape_points(Shape { kind, size: 1.2 }, &plain_clip.original, 8, 3);
        let elsewhere: Vec<DVec3> = points.iter().map(|&p| moved_by.point(p)).collect();
        for frame in [ResidualFrame::Heading, ResidualFrame::Tangent, ResidualFrame::Absolute] {
            for window in [0.0, 0.5] {
                let with = |points: &[DVec3]| {
                    let points = points.to_vec();
                    move |e: &mut Edits| {
                        e.path.control_points = Some(points);
                        e.residual.frame = frame;
                        e.heading.window = window;
                    }
                };
                let here = solved(&plain, with(&points), None);
                let there = solved(&moved, with(&elsewhere), None);
                assert_eq!(here.edited.n_frames(), there.edited.n_frames());
                for f in 0..here.edited.n_frames() {
                    let mut expected = moved_by * here.carrier(f);
                    if frame == ResidualFrame::Absolute {
                        // World axes stay behind: what was left over turns with the clip it was taken from.
                        let left_over = there.residuals.motions[there.source_frame(f)].translation;
                        expected.translation = moved_by.point(here.timing.frames[f].point) + left_over;
                    }
                    let found = there.carrier(f);
                    assert!(found.translation.distance(expected.translation) < 1e-6, "{kind:?} {frame:?} {window} {f}");
                    assert!(found.rotation.angle_between(expected.rotation) < 1e-6, "{kind:?} {frame:?} {window} {f}");
                }
            }
        }
    }
}

#[test]
fn the_straight_line_leaves_a_straight_walk_where_it_was() {
    let straight =
        source((0..300).map(|f| (DVec3::new(0.0, 1.0 + 0.02 * (f as f64 * 0.4).sin(), 0.013 * f as f64), 0.0)));
    let result = solved(&straight, |_| {}, None);
    assert_eq!(result.edited.n_frames(), 300);
    for f in 0..300 {
        let (found, was) = (result.carrier(f), result.carrier_track[f]);
        assert!(found.translation.distance(was.translation) < 1e-9);
        assert!(found.rotation.angle_between(was.rotation) < 1e-7);
    }
    let ratio = result.measures.jerk_ratio.expect("many frames");
    assert!((ratio - 1.0).abs() < 1e-6, "{ratio}");
    assert!(result.measures.path_error.expect("edited") < 1e-9);
}

#[test]
fn cycles_are_measured_where_they_meet() {
    let result = solved(
        &walk(),
        |e| {
            e.timing.cycling = Cycling::Plain;
            e.path.control_points = Some((0..8).map(|i| DVec3::new(0.0, 1.0, 3.0 * i as f64)).collect());
        },
        None,
    );
    let cycle = result.clip.n_frames();
    assert_eq!(result.timing.seams, [cycle, 2 * cycle, 3 * cycle]);
    assert_eq!(result.measures.seam.len(), 3);
    for seam in &result.measures.seam {
        // The walk is fast at both ends, so standing on one spot for a frame shows in the velocity.
        assert!(seam.velocity > 2.0 * seam.neighbour_velocity, "{seam:?}");
        assert!(seam.position.is_finite() && seam.rotation > 0.0);
    }
    assert!(result.end_arc_length() <= result.timing.path_length);
}

#[test]
fn clips_that_hardly_move_neither_spin_nor_vanish() {
    let still = DVec3::new(1.0, 1.0, -2.0);
    let clips: [(&str, Arc<Source>); 8] = [
        ("one frame", source([(still, 30.0)])),
        ("two frames", source([(still, 30.0), (still + DVec3::Z, 31.0)])),
        ("three frames in place", source([(still, 0.0); 3])),
        ("standing", source((0..200).map(|_| (still, 10.0)))),
        ("turning on the spot", source((0..200).map(|f| (still, f as f64 * 3.6)))),
        (
            "walking in place",
            source((0..200).map(|f| (still + DVec3::new(0.02 * (f as f64 * 0.2).sin(), 0.03, 0.0), 0.0))),
        ),
        ("climbing", source((0..200).map(|f| (still + DVec3::Y * 0.02 * f as f64, 0.0)))),
        ("there and back", source((0..200).map(|f| (still + DVec3::Z * (2.0 - (f as f64 - 100.0).abs() * 0.02), 0.0)))),
    ];
    for (name, source) in clips {
        let start = solved(&source, |_| {}, None);
        for (kind, shape_name) in ShapeKind::ALL {
            for window in [0.5, 3.0] {
                let points = shape_points(Shape { kind, size: 1.0 }, &start.original, 8, 3);
                let result = solved(
                    &source,
                    |e| {
                        e.path.control_points = Some(points);
                        e.heading.window = window;
                        e.timing.cycling = Cycling::Plain;
                    },
                    Some(&start),
                );
                let n = result.edited.n_frames();
                assert!(n >= 1);
                for f in 0..n {
                    let carrier = result.carrier(f);
                    assert!(carrier.translation.is_finite() && carrier.rotation.is_normalized(), "{name} {shape_name}");
                }
                // Nobody turns faster on the new path than a window's worth of path allows.
                let fastest = (1..n)
                    .filter(|f| !result.timing.seams.contains(f))
                    .map(|f| (result.timing.frames[f].heading_rad - result.timing.frames[f - 1].heading_rad).abs())
                    .fold(0.0, f64::max);
                assert!(fastest < 0.7, "{name} {shape_name} {window}: {fastest}");
                assert!(result.measures.jerk_ratio.is_none_or(f64::is_finite));
            }
        }
        let shown = ["one frame", "three frames in place", "standing", "turning on the spot", "walking in place"];
        assert_eq!(start.original.goes_nowhere(), shown.contains(&name), "{name}");
        assert_eq!(start.warnings.iter().any(|w| w.contains("goes nowhere")), shown.contains(&name), "{name}");
    }
}

#[test]
fn wishes_that_cannot_be_met_are_said() {
    let source = walk();
    let warned = |change: fn(&mut Edits), word: &str| {
        let result = solved(&source, change, None);
        assert!(result.warnings.iter().any(|w| w.contains(word)), "{:?}", result.warnings);
        assert!((0..result.edited.n_frames()).all(|f| result.carrier(f).translation.is_finite()));
    };
    warned(|e| e.original.degree = Degree::Fixed(60), "original.degree 60");
    warned(|e| e.path.control_points = Some(vec![DVec3::ZERO, DVec3::X, DVec3::Z]), "path.degree 3");
    warned(|e| e.path.control_points = Some(vec![DVec3::ONE]), "two points");
    warned(
        |e| {
            e.timing.arc_length = false;
            e.timing.cycling = Cycling::Plain;
        },
        "timing.arc_length",
    );
}

#[test]
fn coincident_control_points_hold_the_clip_in_place() {
    let source = walk();
    for window in [0.0, 0.5] {
        let result = solved(
            &source,
            |e| {
                e.path.control_points = Some(vec![DVec3::ONE; 8]);
                e.heading.window = window;
            },
            None,
        );
        assert_eq!(result.edited.n_frames(), 1, "a path without length ends where it begins");
        let off_speed = solved(&source, |e| e.timing.arc_length = false, Some(&result));
        assert_eq!(off_speed.edited.n_frames(), 400);
        assert!(off_speed.timing.frames.iter().all(|f| f.heading_rad == off_speed.timing.frames[0].heading_rad));
    }
}
