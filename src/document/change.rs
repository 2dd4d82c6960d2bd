//! Changes: what turns one [`Edits`] value into the next.
//!
//! A change is a value that can be stored, replayed and tested. Rules between parameters live here: a path keeps its
//! shape when its degree or number of points changes, given control points are final and define the count, a ready
//! shape follows the original path that the same change may have altered.

use std::{fmt, sync::Arc};

use glam::DVec3;
use toml::Value;

use super::{
    Edits, KeyChange, LayerChange, LayerRefusal, PlantRefusal, PoseChange, Solved, Source, TimingEdits, ViewEdits,
    layers,
    parameter::{MAX_POINTS, SetError},
    piece::Follows,
    plants, posing, solve,
    table::{check_carrier, parameter},
};
use crate::{
    contact::PlantChange,
    displace::Selection,
    motion::Side,
    path::{self, Shape},
};

/// One change of the edits.
#[derive(Clone, Debug, PartialEq)]
pub enum Change {
    /// Parameters set and a ready shape taken, all as one whatever their order.
    Set {
        /// Names and values.
        values: Vec<(String, Value)>,
        /// A ready shape, applied after the values; given control points win over it.
        shape: Option<Shape>,
    },
    /// A control point goes somewhere, in the clip's axes and unit.
    PlacePoint {
        /// Index of the point.
        point_idx: usize,
        /// Where it goes.
        to: DVec3,
    },
    /// A new control point after this one, half way to the next (beyond the end: as far again).
    InsertPoint {
        /// Index of the point it follows.
        after_idx: usize,
    },
    /// A control point is taken out.
    DeletePoint {
        /// Index of the point.
        point_idx: usize,
    },
    /// Back to the straight line.
    Straighten,
    /// What is drawn, the cameras and the speed as they came.
    ResetView,
    /// Something is done to a foot's plants.
    Plant {
        /// Side of the foot.
        foot: Side,
        /// What; plants by their index among the foot's, frames of the clip.
        change: PlantChange,
    },
    /// What the user did to a foot's plants is taken back: to one of them, by its index, or to all.
    PlantsAsFound {
        /// Side of the foot.
        foot: Side,
        /// Index of the plant; none: all, the deleted ones too.
        plant: Option<usize>,
    },
    /// Something is done to the list of layers.
    Layer(LayerChange),
    /// Something is done to keys of a layer; the first layer is made when there is none.
    Keys {
        /// The layer's place in the list.
        layer_idx: usize,
        /// Which maps.
        selection: Selection,
        /// What.
        change: KeyChange,
    },
    /// A pose is made what is wanted, by keys of a layer; the first layer is made when there is none.
    Pose {
        /// The layer's place in the list.
        layer_idx: usize,
        /// The edited frame.
        frame_idx: usize,
        /// What is wanted.
        change: PoseChange,
    },
}

impl fmt::Display for Change {
    /// Says what was done, for people: `control point moved`.
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let names = |values: &[(String, Value)]| match values {
            [] => "nothing".to_owned(),
            [(name, _)] => name.clone(),
            [(first, _), (second, _)] => format!("{first} and {second}"),
            [(first, _), more @ ..] => format!("{first} and {} more", more.len()),
        };
        match self {
            Self::Set { shape: Some(shape), .. } => write!(f, "shape {}", shape.kind.name()),
            Self::Set { values, shape: None } => f.write_str(&names(values)),
            Self::PlacePoint { .. } => f.write_str("control point moved"),
            Self::InsertPoint { .. } => f.write_str("control point inserted"),
            Self::DeletePoint { .. } => f.write_str("control point deleted"),
            Self::Straighten => f.write_str("straight line"),
            Self::ResetView => f.write_str("view as it came"),
            Self::Plant { foot, change } => write!(f, "{} plant {}", foot.name(), plant_word(change)),
            Self::PlantsAsFound { foot, plant: Some(_) } => write!(f, "{} plant as found", foot.name()),
            Self::PlantsAsFound { foot, plant: None } => write!(f, "{} plants as found", foot.name()),
            Self::Layer(change) => write!(f, "layer {}", layer_word(change)),
            Self::Keys { change, .. } => write!(f, "keys {}", key_word(*change)),
            Self::Pose { change: PoseChange::PlaceCarrier { .. }, .. } => f.write_str("carrier moved"),
            Self::Pose { change: PoseChange::Reach { .. }, .. } => f.write_str("joint moved"),
            Self::Pose { change: PoseChange::Turn { .. }, .. } => f.write_str("joint turned"),
        }
    }
}

fn plant_word(change: &PlantChange) -> &'static str {
    match change {
        PlantChange::MoveFirst { .. } => "begun elsewhere",
        PlantChange::MoveLast { .. } => "ended elsewhere",
        PlantChange::Split { .. } => "split",
        PlantChange::Join { .. } => "joined",
        PlantChange::Delete { .. } => "deleted",
        PlantChange::Add { .. } => "added",
        PlantChange::SetMode { .. } => "mode",
    }
}

fn layer_word(change: &LayerChange) -> &'static str {
    match change {
        LayerChange::Add { .. } => "added",
        LayerChange::Delete { .. } => "deleted",
        LayerChange::Rename { .. } => "renamed",
        LayerChange::Switch { on: true, .. } => "switched on",
        LayerChange::Switch { on: false, .. } => "switched off",
        LayerChange::Weigh { .. } => "weight",
        LayerChange::Interpolate { .. } => "interpolation",
        LayerChange::Move { .. } => "moved",
        LayerChange::Merge { .. } => "merged",
        LayerChange::ClearPosition { .. } => "position keys cleared",
        LayerChange::ClearRotations { .. } => "rotation keys cleared",
    }
}

fn key_word(change: KeyChange) -> &'static str {
    match change {
        KeyChange::Add { .. } => "added",
        KeyChange::Delete { .. } => "deleted",
        KeyChange::Copy { .. } => "copied",
        KeyChange::Move { .. } => "moved",
    }
}

/// A change that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum ChangeError {
    /// A name or a value that the parameter table does not take.
    #[error(transparent)]
    Parameter(#[from] SetError),
    /// A plant that cannot be changed so.
    #[error(transparent)]
    Plant(#[from] PlantRefusal),
    /// Layers, keys or a pose that cannot be changed so.
    #[error(transparent)]
    Layer(#[from] LayerRefusal),
    /// No more control points fit.
    #[error("a path has at most {MAX_POINTS} control points")]
    TooManyPoints,
    /// The path cannot lose a point.
    #[error("a path of degree {degree} needs at least {} control points; lower path.degree first", degree + 1)]
    LastPoints {
        /// `path.degree`.
        degree: usize,
    },
}

/// What a change leads to.
pub(super) struct Next {
    /// The edits after it.
    pub(super) edits: Edits,
    /// What deserves the user's eye.
    pub(super) warnings: Vec<String>,
    /// A draft of what follows from those edits, where that had to be found out anyway.
    pub(super) draft: Option<Solved>,
}

/// Returns what a change leads to; of a pose, as far as the clip is to follow it.
///
/// # Errors
///
/// When the change cannot be made; nothing is half done.
pub(super) fn next(solved: &Solved, change: &Change, follows: Follows<'_>) -> Result<Next, ChangeError> {
    let mut edits = (*solved.edits).clone();
    let mut warnings = Vec::new();
    let mut draft = None;
    match change {
        Change::Set { values, shape } => warnings = set(solved, &mut edits, values, *shape)?,
        Change::PlacePoint { point_idx, to } => {
            let mut points = solved.control_points();
            points[*point_idx] = *to;
            give(&mut edits, points);
        }
        Change::InsertPoint { after_idx } => {
            let mut points = solved.control_points();
            if points.len() >= MAX_POINTS {
                return Err(ChangeError::TooManyPoints);
            }
            let here = points[*after_idx];
            let new = match points.get(after_idx + 1) {
                Some(&next) => here.midpoint(next),
                None => here + (here - points[after_idx - 1]),
            };
            points.insert(after_idx + 1, new);
            give(&mut edits, points);
        }
        Change::DeletePoint { point_idx } => {
            let mut points = solved.control_points();
            if points.len() <= edits.path.degree + 1 {
                return Err(ChangeError::LastPoints { degree: edits.path.degree });
            }
            points.remove(*point_idx);
            give(&mut edits, points);
        }
        Change::Straighten => edits.path.control_points = None,
        Change::ResetView => {
            edits.view = ViewEdits::default();
            edits.timing.speed = TimingEdits::default().speed;
        }
        Change::Plant { foot, change } => plants::change(solved, &mut edits, *foot, *change)?,
        Change::PlantsAsFound { foot, plant } => plants::as_found(solved, &mut edits, *foot, *plant)?,
        Change::Layer(change) => layers::change(&mut edits, change)?,
        Change::Keys { layer_idx, selection, change } => {
            layers::change_keys(solved, &mut edits, *layer_idx, selection, *change)?;
        }
        Change::Pose { layer_idx, frame_idx, change } => {
            draft = posing::change(solved, &mut edits, *layer_idx, *frame_idx, change, follows)?;
        }
    }
    Ok(Next { edits, warnings, draft })
}

fn give(edits: &mut Edits, points: Vec<DVec3>) {
    edits.path.points = points.len();
    edits.path.control_points = Some(points);
}

fn set(
    solved: &Solved,
    edits: &mut Edits,
    values: &[(String, Value)],
    shape: Option<Shape>,
) -> Result<Vec<String>, ChangeError> {
    let mut warnings = Vec::new();
    let points_name = "path.control_points";
    for (name, value) in values.iter().filter(|(name, _)| name != points_name) {
        parameter(name)?.set(edits, value)?;
    }
    if values.iter().any(|(name, _)| name == "clip.carrier") {
        let joints: Vec<&str> = solved.clip.skeleton.joints().iter().map(|joint| joint.name.as_str()).collect();
        check_carrier(edits, &joints)?;
    }
    let needed = edits.path.degree + 1;
    let given = values.iter().rev().find(|(name, _)| name == points_name);
    if let Some((name, value)) = given {
        parameter(name)?.set(edits, value)?;
        if let Some(points) = &edits.path.control_points {
            if points.len() < needed {
                return Err(SetError::TooFewPoints { degree: edits.path.degree, found: points.len() }.into());
            }
            return Ok(warnings);
        }
    }
    if edits.path.points < needed {
        warnings.push(format!("path.points raised to {needed}, which path.degree {} needs", edits.path.degree));
        edits.path.points = needed;
    }
    if let Some(shape) = shape {
        let original = original_path(&solved.source, edits, solved);
        let raised = edits.path.points.max(shape.min_points(edits.path.degree));
        // What nobody asked for is no wish that is not met.
        if raised > edits.path.points && values.iter().any(|(name, _)| name == "path.points") {
            warnings.push(format!("path.points raised to {raised}, which the shape needs"));
        }
        let points = path::shape_points(shape, &original.original, raised, edits.path.degree);
        give(edits, points.into_iter().map(|p| original.clip.facts.up.value.to_file(p)).collect());
    } else if edits.path.control_points.is_some()
        && (edits.path.points, edits.path.degree) != (solved.edits.path.points, solved.edits.path.degree)
    {
        let up = solved.clip.facts.up.value;
        let points = solved.new_path.refit(edits.path.points, edits.path.degree);
        give(edits, points.into_iter().map(|p| up.to_file(p)).collect());
    }
    Ok(warnings)
}

/// The solve of these edits, for its original path; stages that are the same are shared.
fn original_path(source: &Arc<Source>, edits: &Edits, previous: &Solved) -> Solved {
    solve(source, &Arc::new(edits.clone()), Some(previous))
}
