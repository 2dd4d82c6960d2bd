//! `solve`: from a source and edits to everything that follows, in stages.
//!
//! ```text
//! clip ─┬─▶ original path ─┬─▶ residuals ─┐
//!       │                  ├─▶ progress ──┤
//!       ├─▶ feet ──────────┼──────────────┼─▶ what walks ─┬─▶ layers on it ─▶ walk, feet held ─▶ measures
//!       └─▶ body ──────────┼──────────────┘               │                    ▲
//!                          └─▶ new path ──────────────────┴─▶ timing ──────────┘
//! ```
//!
//! What walks is the clip, or the clip joined to itself so that it lasts as long as the new path.
//!
//! A stage whose input equals its previous input hands its previous output on, so equality of inputs is all there is
//! to it: upstream stages are compared by pointer, settings by value.

use std::sync::Arc;

use glam::DVec3;

use super::{
    Edits, Feet, Posed, Solved, Source, feet,
    holding::Carriage,
    strain::Asked,
    walked::{Loaded, repeat},
};
use crate::{
    curve::BSpline,
    math::Rigid,
    measure::{Body, FootTracks, Measured},
    motion::Clip,
    path::{Cycling, Integrator, MAX_POINTS, NewPath, OriginalPath, Residuals, Timing, TimingOptions, straight_line},
    sync::{both, pooled},
};

/// Degrees a new path may have.
const DEGREES: std::ops::RangeInclusive<usize> = 1..=9;
/// Euler steps as a share of the parameter range.
const STEPS: std::ops::RangeInclusive<f64> = 1e-6..=0.1;

/// Computes everything that follows from a source and edits.
///
/// Pure: equal inputs give equal results, whatever `previous` is; it only lends the stages that did not change.
/// Cannot fail: what cannot be done as wished is done as well as possible and said in `warnings`.
pub fn solve(source: &Arc<Source>, edits: &Arc<Edits>, previous: Option<&Solved>) -> Solved {
    pooled(source.bvh.n_frames(), || solve_stages(source, edits, previous, Extent::All))
}

/// Computes what is to be seen of edits while they are still being changed: as [`solve()`], but what is measured of the
/// whole body stays that of the solve before, see [`Solved::is_measured`]. What is shown live, the numbers of the feet, is
/// of these edits.
pub fn solve_live(edits: &Arc<Edits>, previous: &Solved) -> Solved {
    solve_on(edits, previous, Extent::Feet)
}

/// Computes the poses that follow from edits of a source that is solved already with other layers: to be shown, or a
/// step on the way to others. What is measured of poses takes as long again and stays that of the solve before.
pub(super) fn draft(edits: &Arc<Edits>, previous: &Solved) -> Solved {
    solve_on(edits, previous, Extent::Poses)
}

fn solve_on(edits: &Arc<Edits>, previous: &Solved, extent: Extent) -> Solved {
    let source = &previous.source;
    pooled(source.bvh.n_frames(), || solve_stages(source, edits, Some(previous), extent))
}

/// How far a solve goes; each goes as far as those before it, and further. What it leaves out is that of the solve before.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub(super) enum Extent {
    /// Poses and strains.
    Poses,
    /// The numbers of the feet.
    Feet,
    /// The numbers of the whole body.
    All,
}

fn solve_stages(source: &Arc<Source>, edits: &Arc<Edits>, previous: Option<&Solved>, wanted: Extent) -> Solved {
    let previous = previous.map(Solved::whole);
    let before = previous.filter(|p| Arc::ptr_eq(&p.source, source) && p.edits.clip == edits.clip);
    let (clip, carrier_track, body) = match before {
        Some(p) => (Arc::clone(&p.clip), Arc::clone(&p.carrier_track), Arc::clone(&p.body)),
        None => read(source, edits),
    };

    let same_found = before.filter(|p| p.edits.plants.detection == edits.plants.detection);
    let same_feet = same_found.filter(|p| p.edits.edited_plants == edits.edited_plants);
    let feet = reuse(same_feet, |p| &p.feet, || Feet::of(&clip, edits, &body, same_found.map(|p| &p.feet.found)));

    let before = before.filter(|p| p.edits.original == edits.original && p.edits.heading == edits.heading);
    let height = clip.facts.height.value;
    let original = reuse(
        before,
        |p| &p.original,
        || OriginalPath::fit(&carrier_track, edits.original.degree, edits.heading.window.max(0.0), height),
    );

    let same_frame = before.filter(|p| p.edits.residual == edits.residual);
    let residuals =
        reuse(same_frame, |p| &p.residuals, || Residuals::of(&carrier_track, original.frames(), edits.residual.frame));

    let options = timing_options(edits);
    let same_integrator = before.filter(|p| {
        let then = timing_options(&p.edits);
        (then.integrator, then.step) == (options.integrator, options.step)
    });
    let progress = reuse(same_integrator, |p| &p.progress, || original.progress(options.integrator, options.step));

    let plan = PathPlan::new(edits, &clip, &original);
    let new_path = reuse(previous.filter(|p| plan.is_of(&p.new_path)), |p| &p.new_path, || plan.path());

    let walks = edits.path.edited && clip.facts.path_editable;
    let blends = walks && edits.timing.cycling == Cycling::Blended && edits.timing.arc_length;
    let loaded = Loaded {
        clip: &clip,
        carrier: &carrier_track,
        body: &body,
        feet: &feet,
        original: &original,
        residuals: &residuals,
        progress: &progress,
    };
    let loops = blends.then(|| loaded.loops(edits.loops, previous));
    let mut cycle_warnings = loops.as_ref().map_or_else(Vec::new, |loops| loops.warnings.clone());
    let range = loops.as_ref().and_then(|loops| loops.used).map(|used| used.range);
    let repeat = range.and_then(|range| {
        let blend_secs = edits.loops.blend.max(0.0);
        repeat(range, blend_secs, &progress, (new_path.length(), height), &mut cycle_warnings)
    });
    let walked = loaded.walked(repeat, previous);
    let posed = Posed::of(edits, &loaded, &walked, walks, previous);

    let same_timing = same_integrator.filter(|p| {
        p.walks_new_path() == walks
            && p.walked.repeat == repeat
            && (!walks || (Arc::ptr_eq(&p.new_path, &new_path) && timing_options(&p.edits) == options))
    });
    let timing = reuse(
        same_timing,
        |p| &p.timing,
        || {
            if repeat.is_some() {
                let timing = Timing::along(&new_path, &walked.progress, height, &options);
                let seams = walked.seams(timing.n_frames());
                Timing { seams, ends_early: timing.n_frames() < clip.n_frames(), ..timing }
            } else if walks {
                Timing::along(&new_path, &progress, height, &options)
            } else {
                Timing::of_original(&original, &progress)
            }
        },
    );

    let holds = walks && edits.plants.hold && posed.prepared.legs().len() > 0;
    let same_carriage = same_timing.filter(|p| {
        (!walks || Arc::ptr_eq(&p.posed.residuals, &posed.residuals))
            && (walks || Arc::ptr_eq(&p.posed.base, &posed.base))
            && p.posed.displaced.moves_as(&posed.displaced)
            && p.holding.is_some() == holds
            && (!holds
                || (Arc::ptr_eq(&p.posed.prepared, &posed.prepared) && p.edits.plants.ground == edits.plants.ground))
    });
    let (carried, holding) = match same_carriage {
        Some(p) => (Arc::clone(&p.carried), p.holding.clone()),
        None => {
            let carriage = Carriage {
                clip: &walked.clip,
                posed: &posed,
                original: walked.path(&original),
                progress: &walked.progress,
                new_path: &new_path,
                timing: &timing,
                restarts: if repeat.is_some() { &[] } else { &timing.seams },
            };
            if holds {
                let (edited, holding) = carriage.held(edits.plants.ground);
                (Arc::new(edited), Some(Arc::new(holding)))
            } else {
                let edited = if walks { carriage.plain() } else { posed.standing(&loaded) };
                (Arc::new(edited), None)
            }
        }
    };
    let same_edit = same_carriage.filter(|p| Arc::ptr_eq(&p.posed.displaced, &posed.displaced));
    // The walk shows frames of what walks; the edit says the same of the clip as loaded.
    let walk = same_edit.map_or_else(|| posed.laid_on(&carried), |p| Arc::clone(&p.walk));
    let edited = match same_edit {
        Some(p) => Arc::clone(&p.edited),
        None => walked.as_edit_of(&clip, &walk),
    };

    let strains = || {
        let asked = || {
            let holding = holding.as_deref();
            let asked = Asked { clip: &clip, new_path: &new_path, timing: &timing, prepared: &posed.prepared, holding };
            if walks { asked.strains() } else { Vec::new() }
        };
        reuse(same_carriage, |p| &p.strains, asked)
    };

    // What no foot hangs on does not change the feet's numbers.
    let same_steps = same_carriage
        .filter(|p| p.extent >= Extent::Feet)
        .filter(|p| Arc::ptr_eq(&p.feet, &feet) && Arc::ptr_eq(&p.posed.legs, &posed.legs));
    let same_edit = same_edit.filter(|p| p.extent == Extent::All);
    // What was shown live is where holding says the feet are; what stays is where the joints have them.
    let same_numbers = same_steps.filter(|p| p.extent >= wanted);
    let foot_numbers = |moved: &[FootTracks]| {
        reuse(same_numbers, |p| &p.foot_numbers, || walked.foot_numbers(&loaded, moved, &walk, &edited))
    };
    let points = feet::measured_points(&walked.plants);
    let is_all_held =
        Arc::ptr_eq(&walk, &carried) && posed.prepared.legs().eq(walked.plants.iter().map(|foot| foot.leg));
    let held_feet = holding.as_ref().filter(|_| is_all_held).map_or(&[][..], |holding| &holding.feet);
    let (measures, foot_numbers, strains, extent) = match (same_edit, same_steps, wanted) {
        (Some(_), Some(p), _) => (Arc::clone(&p.measures), Arc::clone(&p.foot_numbers), strains(), Extent::All),
        (_, _, Extent::Poses) => {
            let p = previous.expect("poses alone are solved for on the way from one solve to the next");
            (Arc::clone(&p.measures), Arc::clone(&p.foot_numbers), strains(), wanted)
        }
        (_, _, Extent::Feet) => {
            let p = previous.expect("the body is left out on the way from one solve to the next");
            let by_joints;
            let moved = match held_feet {
                [] => {
                    by_joints = walked.body.moved(&walk, &posed.turning, &points);
                    feet::measured_feet(&by_joints)
                }
                held => held.iter().map(|foot| FootTracks { ankle: foot.ankle(), toe: foot.toe() }).collect(),
            };
            // A second core hides the feet's numbers.
            let (strains, numbers) = both(walk.n_frames(), strains, || foot_numbers(&moved));
            (Arc::clone(&p.measures), numbers, strains, wanted)
        }
        (_, _, Extent::All) => {
            let (sweep, moved) = walked.body.look(&walk, &posed.turning, &points);
            let own =
                |(f, carrier): (usize, &Rigid)| posed.undisplaced(walk.source_frame(f), *carrier, &timing.frames[f]);
            let undisplaced: Vec<Rigid> = if walks && posed.displaced.moves_carrier() {
                walk.carrier_world.iter().enumerate().map(own).collect()
            } else {
                Vec::new()
            };
            let carried = if posed.displaced.moves_carrier() { &undisplaced } else { &walk.carrier_world };
            let measured = Measured {
                source: &body,
                sweep,
                edited: &walk,
                carried: walks.then_some(carried),
                original: &original,
                residuals: &posed.residuals,
                progress: &progress,
                new_path: &new_path,
                timing: &timing,
            };
            let ((measures, strains), numbers) = both(
                walk.n_frames(),
                || (reuse(same_edit, |p| &p.measures, || measured.measures()), strains()),
                || foot_numbers(&feet::measured_feet(&moved)),
            );
            (measures, numbers, strains, wanted)
        }
    };

    let mut warnings: Vec<_> = source.bvh.warnings().iter().map(ToString::to_string).collect();
    warnings.extend(clip.warnings.iter().cloned());
    warnings.extend(feet.warnings.iter().cloned());
    warnings.extend(original_warnings(&original));
    warnings.extend(plan.warnings);
    warnings.extend(cycle_warnings);
    warnings.extend(posed.warnings.iter().cloned());
    warnings.extend(timing.warnings.iter().cloned());
    Solved {
        source: Arc::clone(source),
        edits: Arc::clone(edits),
        clip,
        carrier_track,
        body,
        original,
        residuals,
        progress,
        new_path,
        timing,
        loops,
        walked,
        posed,
        carried,
        walk,
        edited,
        holding,
        strains,
        measures,
        feet,
        foot_numbers,
        warnings,
        extent,
        whole: None,
    }
}

/// Hands on a stage's previous output if there is a previous solve with the same input, else makes it.
pub(super) fn reuse<T>(same: Option<&Solved>, stage: impl Fn(&Solved) -> &Arc<T>, make: impl FnOnce() -> T) -> Arc<T> {
    same.map_or_else(|| Arc::new(make()), |p| Arc::clone(stage(p)))
}

fn read(source: &Source, edits: &Edits) -> (Arc<Clip>, Arc<Vec<Rigid>>, Arc<Body>) {
    let clip = Clip::from_bvh(&source.bvh, &edits.clip);
    let carrier_track = clip.carrier_track();
    let body = Body::of(&clip, &carrier_track);
    (Arc::new(clip), Arc::new(carrier_track), Arc::new(body))
}

/// Returns the timing settings that matter, so that equal ones give equal results: Gauss knows no step.
fn timing_options(edits: &Edits) -> TimingOptions {
    let timing = &edits.timing;
    let step = match timing.integrator {
        Integrator::Gauss => *STEPS.end(),
        Integrator::Euler => timing.step.clamp(*STEPS.start(), *STEPS.end()),
    };
    TimingOptions { arc_length: timing.arc_length, integrator: timing.integrator, step, cycling: timing.cycling }
}

fn original_warnings(original: &OriginalPath) -> impl Iterator<Item = String> {
    let refused = original.refused_degree().map(|asked| {
        let (degree, n) = (original.degree(), original.frames().len());
        format!("original.degree {asked} is more than {n} frames allow; {degree} is used")
    });
    let still = original
        .goes_nowhere()
        .then(|| "the clip goes nowhere; shapes take one body height for its path's length".to_owned());
    refused.into_iter().chain(still)
}

/// What a new path is made of.
struct PathPlan {
    degree: usize,
    /// World axes.
    points: Vec<DVec3>,
    window: f64,
    fallback_rad: f64,
    warnings: Vec<String>,
}

impl PathPlan {
    fn new(edits: &Edits, clip: &Clip, original: &OriginalPath) -> Self {
        let mut warnings = Vec::new();
        let asked = edits.path.degree.clamp(*DEGREES.start(), *DEGREES.end());
        let up = clip.facts.up.value;
        let points: Vec<DVec3> = match &edits.path.control_points {
            Some(points) if points.len() >= 2 => points.iter().map(|&p| up.to_world(p)).collect(),
            Some(points) if !points.is_empty() => {
                warnings.push("path.control_points needs two points at least; the path stays at one".to_owned());
                vec![up.to_world(points[0]); 2]
            }
            _ => straight_line(original, edits.path.points.clamp(asked + 1, MAX_POINTS)),
        };
        let degree = asked.min(points.len() - 1);
        if degree < asked {
            let n = points.len();
            warnings.push(format!(
                "path.degree {asked} needs {} control points, there are {n}; {degree} is used",
                asked + 1
            ));
        }
        Self {
            degree,
            points,
            window: edits.heading.window.max(0.0) * original.height(),
            fallback_rad: original.frames()[0].heading_rad,
            warnings,
        }
    }

    /// Tells whether a path was made of exactly this.
    fn is_of(&self, path: &NewPath) -> bool {
        path.spline().degree() == self.degree
            && path.spline().control_points() == self.points
            && (path.window(), path.fallback_rad()) == (self.window, self.fallback_rad)
    }

    fn path(&self) -> NewPath {
        NewPath::new(BSpline::new(self.degree, self.points.clone()), self.window, self.fallback_rad)
    }
}
