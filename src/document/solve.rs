//! `solve`: from a source and edits to everything that follows, in stages.
//!
//! ```text
//! clip ─┬─▶ original path ─┬─▶ residuals ──────────────┐
//!       │                  ├─▶ progress ─▶ timing ─▶ edited clip, feet held ─▶ measures
//!       │                  └─▶ new path ─▶ ┘           │                      │
//!       ├─▶ feet ─▶ legs prepared ─────────────────────┘                      │
//!       └─▶ body ─────────────────────────────────────────────────────────────┘
//! ```
//!
//! A stage whose input equals its previous input hands its previous output on, so equality of inputs is all there is
//! to it: upstream stages are compared by pointer, settings by value.

use std::{panic::resume_unwind, sync::Arc, thread};

use glam::DVec3;

use super::{Edits, Feet, Solved, Source, holding::Carriage, strain::Asked};
use crate::{
    curve::BSpline,
    math::Rigid,
    measure::{Body, Measured},
    motion::{Clip, EditedClip},
    path::{Integrator, MAX_POINTS, NewPath, OriginalPath, Residuals, Timing, TimingOptions, straight_line},
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
    let before = previous.filter(|p| Arc::ptr_eq(&p.source, source) && p.edits.clip == edits.clip);
    let (clip, carrier_track, body) = match before {
        Some(p) => (Arc::clone(&p.clip), Arc::clone(&p.carrier_track), Arc::clone(&p.body)),
        None => read(source, edits),
    };

    let same_feet = before.filter(|p| p.edits.plants.detection == edits.plants.detection);
    let feet = reuse(same_feet, |p| &p.feet, || Feet::of(&clip, &edits.clip, &body, edits.plants.detection));
    let same_legs = same_feet.filter(|p| p.edits.plants.clean == edits.plants.clean);
    let prepared = reuse(same_legs, |p| &p.prepared, || feet.prepared(&clip, edits.plants.clean));
    let turning = reuse(same_legs, |p| &p.turning, || Feet::turning(&clip, &prepared));

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
    let same_timing = same_integrator.filter(|p| {
        p.walks_new_path() == walks
            && (!walks || (Arc::ptr_eq(&p.new_path, &new_path) && timing_options(&p.edits) == options))
    });
    let timing = reuse(
        same_timing,
        |p| &p.timing,
        || {
            if walks {
                Timing::along(&new_path, &progress, height, &options)
            } else {
                Timing::of_original(&original, &progress)
            }
        },
    );

    let holds = walks && edits.plants.hold && prepared.legs().len() > 0;
    let same_edit = same_timing.filter(|p| {
        (!walks || Arc::ptr_eq(&p.residuals, &residuals))
            && p.holding.is_some() == holds
            && (!holds || (Arc::ptr_eq(&p.prepared, &prepared) && p.edits.plants.ground == edits.plants.ground))
    });
    let (edited, holding) = match same_edit {
        Some(p) => (Arc::clone(&p.edited), p.holding.clone()),
        None => {
            let carriage = Carriage {
                clip: &clip,
                residuals: &residuals,
                original: &original,
                progress: &progress,
                new_path: &new_path,
                timing: &timing,
            };
            if holds {
                let (edited, holding) = carriage.held(&prepared, edits.plants.ground);
                (Arc::new(edited), Some(Arc::new(holding)))
            } else {
                let edited = if walks { carriage.plain() } else { EditedClip::unedited(Arc::clone(&clip)) };
                (Arc::new(edited), None)
            }
        }
    };

    let strains = reuse(
        same_edit,
        |p| &p.strains,
        || {
            let holding = holding.as_deref();
            let asked = Asked { clip: &clip, new_path: &new_path, timing: &timing, prepared: &prepared, holding };
            if walks { asked.strains() } else { Vec::new() }
        },
    );

    let same_steps = same_edit.filter(|p| Arc::ptr_eq(&p.feet, &feet));
    let (measures, foot_numbers) = match (same_edit, same_steps) {
        (Some(_), Some(p)) => (Arc::clone(&p.measures), Arc::clone(&p.foot_numbers)),
        _ => {
            let placed = body.placed(&edited, &turning);
            let measured = Measured {
                body: &body,
                placed: &placed,
                edited: &edited,
                original: &original,
                residuals: &residuals,
                progress: &progress,
                new_path: &new_path,
                timing: &timing,
            };
            // The feet's numbers take half as long as the whole body's: a second core hides them.
            thread::scope(|scope| {
                let numbers = scope.spawn(|| Arc::new(feet.numbers(&clip, &body, &placed, &edited)));
                let measures = reuse(same_edit, |p| &p.measures, || measured.measures());
                (measures, numbers.join().unwrap_or_else(|panic| resume_unwind(panic)))
            })
        }
    };

    let mut warnings: Vec<_> = source.bvh.warnings().iter().map(ToString::to_string).collect();
    warnings.extend(clip.warnings.iter().cloned());
    warnings.extend(feet.warnings.iter().cloned());
    warnings.extend(original_warnings(&original));
    warnings.extend(plan.warnings);
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
        prepared,
        turning,
        edited,
        holding,
        strains,
        measures,
        feet,
        foot_numbers,
        warnings,
    }
}

/// Hands on a stage's previous output if there is a previous solve with the same input, else makes it.
fn reuse<T>(same: Option<&Solved>, stage: impl Fn(&Solved) -> &Arc<T>, make: impl FnOnce() -> T) -> Arc<T> {
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
