//! Blended cycling as a user has it: from the parameter to the exported file.

use std::sync::Arc;

use glam::DVec3;
use walkabout::{
    bvh::Bvh,
    cycle::LoopRange,
    document::{self, Cycling, Edits, Solved, Source, solve},
    measure::Seam,
    motion::{Clip, ClipOptions},
    path::{Degree, Shape, ShapeKind, shape_points},
};

/// Reads a captured clip; says so loudly when there is none.
fn captured(name: &str) -> Option<Arc<Source>> {
    let Ok(dir) = std::env::var("WALKABOUT_CLIPS") else {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS must be set in CI");
        println!("SKIPPED: {name}, because WALKABOUT_CLIPS is not set");
        return None;
    };
    let bytes = std::fs::read(format!("{dir}/real/{name}.bvh")).expect("the clip is there");
    let bvh = Bvh::parse(bytes, name).expect("a valid file");
    Some(Arc::new(Source { name: name.to_owned(), file: None, bvh }))
}

fn built_in() -> Arc<Source> {
    Arc::new(document::built_in())
}

/// Solves with a change on top of an earlier solve's edits.
fn after(source: &Arc<Source>, previous: Option<&Solved>, change: impl FnOnce(&mut Edits)) -> Solved {
    let mut edits = previous.map_or_else(Edits::default, |p| (*p.edits).clone());
    change(&mut edits);
    solve(source, &Arc::new(edits), previous)
}

/// Bends a clip onto a shape some times as long as its path and cycles it along.
fn cycled(source: &Arc<Source>, kind: ShapeKind, size: f64) -> Solved {
    let start = after(source, None, |_| {});
    let up = start.clip.facts.up.value;
    let points = shape_points(Shape { kind, size }, &start.original, 8, 3).into_iter().map(|p| up.to_file(p)).collect();
    after(source, Some(&start), |edits| {
        edits.path.control_points = Some(points);
        edits.timing.cycling = Cycling::Blended;
    })
}

fn points(solved: &Solved, frame: usize) -> Vec<DVec3> {
    let mut points = Vec::new();
    solved.edited.world_points(frame, &mut points);
    points
}

/// Tells and checks what a blended cycle has to keep to.
fn check(name: &str, solved: &Solved) {
    let seams = &solved.measures.seam;
    assert!(!seams.is_empty(), "{name} is cycled: {:?}", solved.warnings);
    let worst = seams.iter().map(Seam::position_share).fold(0.0, f64::max);
    println!(
        "{name}: {:?}, {} frames, worst step over a seam {worst:.2}",
        solved.walked.repeat,
        solved.edited.n_frames()
    );
    assert!(worst <= Seam::BAR, "{name}: {seams:?}");
    // To the end of the path, but for less than the next frame's step.
    let left = solved.new_path.length() - solved.end_arc_length();
    let step = solved.end_arc_length() / solved.edited.n_frames() as f64;
    assert!(left > -1e-6 * step && left < 5.0 * step, "{name}: {left} left, {step} a frame");
    for (numbers, foot) in solved.foot_numbers.iter().zip(&solved.feet.plants) {
        if let (Some(speed), Some(slip)) = (numbers.planted_speed, numbers.slip_p90) {
            println!(
                "  {:?}: {} plants, planted speed {:.4} → {:.4} H/s, slip {:.4} → {:.4} H",
                foot.leg.side, numbers.plants, speed.source, speed.edited, slip.source, slip.edited
            );
            assert!(speed.edited <= 1.02 * speed.source && slip.edited <= 1.05 * slip.source, "{name}: {numbers:?}");
        }
    }
    assert!(solved.holding.as_ref().is_none_or(|holding| holding.missed.is_empty()), "{name}: {:?}", solved.holding);
    let floors = floors(solved);
    let (low, high) =
        floors.iter().fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), &y| (low.min(y), high.max(y)));
    println!("  floors of the cycles {low:.3} to {high:.3} H");
    assert!(high - low < 0.03, "{name}: who walks on level ground neither climbs nor sinks, {floors:?}");
}

/// Returns the lowest height of any point in each cycle, body heights.
fn floors(solved: &Solved) -> Vec<f64> {
    let seams = solved.measures.seam.iter().map(|seam| seam.frame);
    let cuts: Vec<usize> = std::iter::once(0).chain(seams).chain([solved.edited.n_frames()]).collect();
    // The last cycle may end with a foot in the air.
    let whole = cuts.windows(2).take(cuts.len() - 2);
    let lowest = |cut: &[usize]| {
        let ys = (cut[0]..cut[1]).step_by(3).flat_map(|frame| points(solved, frame)).map(|point| point.y);
        ys.fold(f64::INFINITY, f64::min) / solved.clip.facts.height.value
    };
    whole.map(lowest).collect()
}

#[test]
fn the_built_in_walk_goes_on_to_the_end_of_a_long_path() {
    for (kind, size) in [(ShapeKind::Circle, 2.5), (ShapeKind::Line, 5.0), (ShapeKind::Eight, 4.0)] {
        let solved = cycled(&built_in(), kind, size);
        check(&format!("built-in {} {size}", kind.name()), &solved);
        assert!(Arc::ptr_eq(&solved.edited.clip, &solved.clip), "edits are of the clip as loaded");
        let mut walk = Vec::new();
        for frame in (0..solved.edited.n_frames()).step_by(7) {
            solved.walk.world_points(frame, &mut walk);
            for (edited, walk) in points(&solved, frame).iter().zip(&walk) {
                assert!(edited.distance(*walk) < 1e-9, "{frame}: what walks is what is edited");
            }
        }
    }
}

#[test]
fn captured_walks_go_on_to_the_end_of_a_long_path() {
    for name in ["walk01", "cmu_12_03_walk", "cmu_08_01_brisk_walk", "figure8_walk"] {
        let Some(source) = captured(name) else { return };
        for (kind, size) in [(ShapeKind::Circle, 3.0), (ShapeKind::Line, 4.0)] {
            check(&format!("{name} {} {size}", kind.name()), &cycled(&source, kind, size));
        }
    }
    // Its ends are far apart, so that its last cycle ends otherwise than the clip although none follows.
    let Some(source) = captured("figure8_walk") else { return };
    let whole = after(&source, Some(&cycled(&source, ShapeKind::Circle, 3.0)), |edits| {
        (edits.loops.start, edits.loops.end) = (Some(0), Some(source.bvh.n_frames()));
    });
    check("figure8_walk as a whole", &whole);
}

#[test]
fn a_written_cycle_reads_as_it_was() {
    for source in [Some(built_in()), captured("walk01"), captured("cmu_12_03_walk")].into_iter().flatten() {
        for hold in [true, false] {
            let solved = cycled(&source, ShapeKind::Circle, 2.0);
            let solved = after(&source, Some(&solved), |edits| edits.plants.hold = hold);
            let written = Bvh::parse(solved.to_bvh(), "written").expect("what is written can be read");
            let options = ClipOptions { rest_frames: Some(solved.clip.rest_frames()), ..ClipOptions::default() };
            let again = Clip::from_bvh(&written, &options);
            assert_eq!(again.n_file_frames(), solved.n_exported_frames());
            let mut read = Vec::new();
            let height = solved.clip.facts.height.value;
            for frame in 0..solved.edited.n_frames() {
                again.world_points(frame, &mut read);
                for (read, was) in read.iter().zip(points(&solved, frame)) {
                    let off = read.distance(was) / height;
                    assert!(off < 1e-6, "{} frame {frame}: {off}", source.name);
                }
            }
        }
    }
}

#[test]
fn dragging_the_path_leaves_the_joined_clip() {
    let source = built_in();
    let start = cycled(&source, ShapeKind::Circle, 2.5);
    let dragged = after(&source, Some(&start), |edits| {
        edits.path.control_points.as_mut().expect("given")[3].x += 5.0;
    });
    let [before, now] = [&start, &dragged].map(|solved| solved.walked.joined.as_ref().expect("cycled"));
    assert!(Arc::ptr_eq(before, now) && Arc::ptr_eq(&start.posed.prepared, &dragged.posed.prepared));
    assert!(Arc::ptr_eq(start.loops.as_ref().expect("cycled"), dragged.loops.as_ref().expect("cycled")));
}

/// Whatever came before, equal edits give equal results.
#[test]
fn the_result_does_not_depend_on_what_came_before() {
    let source = built_in();
    let mut solved = cycled(&source, ShapeKind::Circle, 2.5);
    let changes: [fn(&mut Edits); 11] = [
        |edits| edits.loops.start = Some(178),
        |edits| edits.loops.end = Some(242),
        |edits| edits.loops.blend = 0.1,
        |edits| edits.plants.clean = true,
        |edits| edits.plants.detection.speed = 0.2,
        |edits| edits.plants.hold = false,
        |edits| edits.original.degree = Degree::Fixed(13),
        |edits| edits.timing.cycling = Cycling::Plain,
        |edits| edits.timing.cycling = Cycling::Blended,
        |edits| edits.path.edited = false,
        |edits| edits.path.edited = true,
    ];
    for (nth, change) in changes.into_iter().enumerate() {
        solved = after(&source, Some(&solved), change);
        let afresh = solve(&source, &solved.edits, None);
        assert_eq!(solved.edited.carrier_world, afresh.edited.carrier_world, "change {nth}");
        assert_eq!(solved.edited.turned, afresh.edited.turned, "change {nth}");
        assert_eq!(solved.edited.source_frames, afresh.edited.source_frames, "change {nth}");
        assert_eq!((&solved.measures, &solved.foot_numbers), (&afresh.measures, &afresh.foot_numbers), "change {nth}");
        assert_eq!(solved.warnings, afresh.warnings, "change {nth}");
    }
}

#[test]
fn a_path_no_longer_than_the_clip_is_walked_once() {
    let source = built_in();
    let solved = after(&source, None, |edits| edits.timing.cycling = Cycling::Blended);
    assert_eq!(solved.walked.repeat, None);
    let off = after(&source, None, |_| {});
    assert_eq!(solved.edited.carrier_world, off.edited.carrier_world);
    assert!(solved.measures.seam.is_empty());
    assert!(!solved.loops.expect("listed all the same").best.is_empty());
}

#[test]
fn loops_are_taken_as_asked() {
    let source = built_in();
    let start = cycled(&source, ShapeKind::Line, 3.0);
    let range = |solved: &Solved| solved.walked.repeat.map(|repeat| repeat.range);
    let best = range(&start).expect("cycled");
    let from = |first, end| after(&source, Some(&start), |edits| (edits.loops.start, edits.loops.end) = (first, end));
    assert_eq!(range(&from(Some(100), Some(300))), Some(LoopRange { first: 100, end: 300 }));
    assert_eq!(range(&from(Some(best.first), None)), Some(best));
    assert_eq!(range(&from(None, Some(best.end))), Some(best));
    let whole = from(Some(0), Some(9999));
    assert_eq!(range(&whole), Some(LoopRange { first: 0, end: 570 }));
    let bad = from(Some(100), Some(130));
    assert!(bad.warnings.iter().any(|w| w.starts_with("the ends of the loop are far apart")), "{:?}", bad.warnings);
    let short = from(Some(100), Some(101));
    assert_eq!(short.warnings, ["not cycled: a loop from file frame 100 to 101 is too short"]);
    assert!(short.measures.seam.is_empty());
}

/// Frame numbers, the timeline and the picture of the source go by the clip as loaded.
#[test]
fn edited_frames_tell_the_clips_frame_they_show() {
    let solved = cycled(&built_in(), ShapeKind::Line, 3.0);
    let LoopRange { first, end } = solved.walked.repeat.expect("cycled").range;
    assert_eq!(solved.source_frame(end - 1), end - 1);
    assert_eq!(solved.source_frame(end), first);
    assert_eq!(solved.edited_frame(first), Some(first));
    assert_eq!(solved.edited_frame(end), None, "frames after the loop are not shown");
}
