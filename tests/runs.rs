//! Runs, end to end: contacts that are known are found, held on every bend, and go on across a seam.
//!
//! The runs are made up ([`made_run`]): jogs and sprints from standing to standing, on heel or ball, with the trembling and
//! the slip of captures.

#[allow(dead_code, reason = "shared by several programs; none uses all of it")]
mod hold_numbers;
mod made_run;

use std::sync::Arc;

use hold_numbers::{Plain, SHAPES, Subject, measure};
use made_run::{Landing, Run};
use proptest::prelude::*;
use walkabout::{
    bvh::Bvh,
    contact::PlantMode,
    document::{Cycling, Edits, Solved, Source, solve},
    measure::Seam,
    path::{Shape, ShapeKind, shape_points},
};

/// Jogs to sprints: statures per second, seconds of a contact, seconds in the air.
const GAITS: [(f64, f64, f64); 7] = [
    (1.5, 0.30, 0.05),
    (1.5, 0.20, 0.10),
    (2.0, 0.22, 0.09),
    (2.5, 0.18, 0.10),
    (3.5, 0.13, 0.12),
    (5.0, 0.10, 0.13),
    (5.0, 0.09, 0.12),
];

const LANDINGS: [Landing; 2] = [Landing::Heel, Landing::Forefoot];

/// Nobody takes more steps than this a second.
const MOST_STEPS: f64 = 5.2;

/// Twice the acceleration of gravity, statures per second squared: no runner leans further into a bend.
const MOST_TURN: f64 = 2.0 * 981.0 / made_run::STATURE;

fn gaits(fps: f64, noise: f64, slip: f64) -> impl Iterator<Item = Run> {
    GAITS.into_iter().flat_map(move |(speed, contact_secs, flight_secs)| {
        LANDINGS.map(|landing| Run { fps, speed, contact_secs, flight_secs, landing, noise, slip, seed: 1 })
    })
}

fn bvh(run: &Run) -> Bvh {
    Bvh::parse(run.text().into_bytes(), "run").expect("a valid file")
}

/// Tells how many frames a found end is off at most; all contacts and no others must be found.
fn worst_end(run: &Run) -> Result<usize, String> {
    let subject = Subject::new("run", &bvh(run));
    let mut worst = 0;
    for (foot, made) in subject.feet.iter().zip(run.contacts()) {
        let found: Vec<_> = foot.plants.iter().map(|plant| (plant.first, plant.last)).collect();
        if found.len() != made.len() {
            return Err(format!("{run:?} {:?}: {found:?} instead of {made:?}", foot.leg.side));
        }
        let off = |(a, b): (&(usize, usize), &(usize, usize))| a.0.abs_diff(b.0).max(a.1.abs_diff(b.1));
        worst = found.iter().zip(&made).map(off).fold(worst, usize::max);
    }
    Ok(worst)
}

/// Clips have no heel: where a foot lands on it, the plant begins when ankle or toe stop as well, a little later.
#[test]
fn every_contact_is_found() {
    for (fps, on_heel, on_ball) in [(24.0, 1, 1), (30.0, 1, 1), (60.0, 3, 2), (120.0, 6, 2)] {
        let mut worst = [0; 2];
        for run in gaits(fps, 0.0, 0.0) {
            let off = worst_end(&run).unwrap_or_else(|told| panic!("{told}"));
            let on_heel_here = run.landing == Landing::Heel;
            assert!(off <= if on_heel_here { on_heel } else { on_ball }, "{run:?}: an end is off by {off} frames");
            let worst = &mut worst[usize::from(!on_heel_here)];
            *worst = off.max(*worst);
        }
        println!("{fps} frames a second: ends are off by {} at most on heels, {} on balls", worst[0], worst[1]);
    }
}

proptest! {
    #![proptest_config(ProptestConfig { cases: 96, ..ProptestConfig::default() })]

    #[test]
    fn every_contact_of_any_run_is_found(
        fps in prop::sample::select(vec![24.0, 30.0, 60.0, 100.0, 120.0]),
        speed in 1.5..5.0f64,
        contact in 0.0..1.0f64,
        flight in 0.0..1.0f64,
        heel in any::<bool>(),
        noise in 0.0..0.2f64,
        slip in 0.0..1.0f64,
        seed in any::<u32>(),
    ) {
        let between = |from: f64, to: f64, at: f64| from + (to.max(from) - from) * at;
        // No leg reaches further than half a stature from touch-down to toe-off.
        let contact_secs = between(0.09, (0.5 / speed).min(0.3), contact);
        let flight_secs = between((1.0 / MOST_STEPS - contact_secs).max(0.03), 0.17, flight);
        let landing = LANDINGS[usize::from(!heel)];
        let run = Run { fps, speed, contact_secs, flight_secs, landing, noise, slip, seed };
        let off = worst_end(&run).map_err(TestCaseError::fail)?;
        // Where a foot lands on its heel, and trembles from frame to frame, no more than 1/13 s was missed in 20,000 runs.
        prop_assert!(off as f64 <= (fps / 12.0).max(2.0), "{run:?}: an end is off by {off} frames");
    }
}

/// Bends a run as hard as it can be run: half a stature, or where that would throw the runner over, less.
fn bent(subject: &Subject, run: &Run, kind: ShapeKind, degree: u32) -> Plain {
    Plain::bent(subject, kind, degree, (run.speed.powi(2) / MOST_TURN).max(0.5))
}

#[test]
fn runs_keep_their_feet() {
    let mut jerks = Vec::new();
    for fps in [30.0, 60.0, 120.0] {
        for run in gaits(fps, 0.1, 0.5) {
            let subject = Subject::new("run", &bvh(&run));
            for degree in [5, 13] {
                for kind in SHAPES {
                    let plain = bent(&subject, &run, kind, degree);
                    for mode in [PlantMode::Hold, PlantMode::Clean] {
                        let n = measure(&subject, &plain.held(&subject, &subject.with_mode(mode)));
                        let told = format!("{} {degree} {mode:?} {run:?}: {n:?}", kind.name());
                        let (speed, slip) = if mode == PlantMode::Clean { (0.1, 0.1) } else { (1.02, 1.05) };
                        assert!(n.n_missed == 0 && n.planted_speed <= speed && n.slip <= slip, "{told}");
                        assert!(n.foot_turn < 1e-9 && n.bones <= 1e-6 && n.clearance >= 0.9, "{told}");
                        assert!(n.acceleration <= 2.0 && n.knee_back_deg > -0.1 && n.knee_step <= 2.0, "{told}");
                        let (jerk, end_jump) = if mode == PlantMode::Clean { (1.4, 1.45) } else { (1.37, 1.35) };
                        assert!(n.jerk <= jerk && n.end_jump <= end_jump, "{told}");
                        if mode == PlantMode::Hold {
                            jerks.push(n.jerk);
                        }
                    }
                }
            }
        }
    }
    jerks.sort_by(f64::total_cmp);
    let at = |share: f64| jerks[(share * (jerks.len() - 1) as f64) as usize];
    println!("jerk over the source's: median {:.3}, 95 % {:.3}, most {:.3}", at(0.5), at(0.95), at(1.0));
    assert!(at(0.5) <= 1.08 && at(0.95) <= 1.3);
}

/// Bends a run onto a shape longer than its path and runs on to its end.
fn cycled(run: &Run, kind: ShapeKind, size: f64) -> Solved {
    let source = Arc::new(Source { name: "run".to_owned(), file: None, bvh: bvh(run) });
    let start = solve(&source, &Arc::new(Edits::default()), None);
    let mut edits = (*start.edits).clone();
    edits.path.control_points = Some(shape_points(Shape { kind, size }, &start.original, 8, 3));
    edits.timing.cycling = Cycling::Blended;
    solve(&source, &Arc::new(edits), Some(&start))
}

#[test]
fn runs_go_on_across_seams() {
    for fps in [30.0, 60.0, 120.0] {
        for run in gaits(fps, 0.1, 0.5) {
            let solved = cycled(&run, ShapeKind::Circle, 2.5);
            let range = solved.walked.repeat.map(|repeat| repeat.range);
            let seams = &solved.measures.seam;
            assert!(!seams.is_empty(), "{run:?} is cycled: {:?}", solved.warnings);
            let worst = seams.iter().map(Seam::position_share).fold(0.0, f64::max);
            println!("{run:?}: {range:?}, {} seams, worst step {worst:.2}", seams.len());
            assert!(worst <= Seam::BAR, "{run:?} {range:?}: {seams:?}");
            for numbers in solved.foot_numbers.iter() {
                let (Some(speed), Some(slip)) = (numbers.planted_speed, numbers.slip_p90) else { panic!("plants") };
                // A stride is no whole number of frames: what is left of a frame's way is spread over the seam. And steps
                // at full speed, which slip most, come again and again.
                let left = 0.1 * run.speed / fps;
                let slides = speed.edited > 1.02 * speed.source || slip.edited > 1.4 * slip.source + left;
                assert!(!slides, "{run:?} {range:?}: {numbers:?}");
            }
            assert!(solved.holding.as_ref().is_none_or(|holding| holding.missed.is_empty()), "{run:?}");
        }
    }
}
