//! The rows of the parameter table that say what pictures show and from where.

use glam::DVec3;
use toml::Value;

use super::{
    Edits, ProjectionKind, Show,
    parameter::{Kind, Parameter, Step},
    value::{as_vector, choice_of, count, float, optional_vector, switch, word, word_of},
};

const PROJECTIONS: &[(&str, Option<ProjectionKind>)] = &[
    ("auto", None),
    ("perspective", Some(ProjectionKind::Perspective)),
    ("orthographic", Some(ProjectionKind::Orthographic)),
];

macro_rules! show_row {
    ($field:ident, $doc:literal) => {
        Parameter {
            name: concat!("show.", stringify!($field)),
            kind: Kind::Switch,
            unit: "",
            doc: $doc,
            get: |e| Value::Boolean(e.view.show.$field),
            set: |e, v| e.view.show.$field = switch(v),
        }
    };
}

macro_rules! camera_rows {
    ($n:literal) => {
        [
            Parameter {
                name: concat!("camera.", $n, ".eye"),
                kind: Kind::Vector,
                unit: "clip unit",
                doc: "Where the camera stands; auto frames the whole motion.",
                get: |e| optional_vector(e.view.cameras[$n - 1].eye),
                set: |e, v| e.view.cameras[$n - 1].eye = as_vector(v),
            },
            Parameter {
                name: concat!("camera.", $n, ".target"),
                kind: Kind::Vector,
                unit: "clip unit",
                doc: "What the camera looks at; auto is the middle of the motion.",
                get: |e| optional_vector(e.view.cameras[$n - 1].target),
                set: |e, v| e.view.cameras[$n - 1].target = as_vector(v),
            },
            Parameter {
                name: concat!("camera.", $n, ".up"),
                kind: Kind::Vector,
                unit: "",
                doc: "Which way is up in the picture; auto is the clip's up.",
                get: |e| optional_vector(e.view.cameras[$n - 1].up),
                set: |e, v| e.view.cameras[$n - 1].up = as_vector(v).filter(|up| *up != DVec3::ZERO),
            },
            Parameter {
                name: concat!("camera.", $n, ".fov"),
                kind: Kind::Real { min: 5.0, max: 120.0, step: Step::Add(5.0) },
                unit: "degrees",
                doc: "Vertical field of view.",
                get: |e| Value::Float(e.view.cameras[$n - 1].fov),
                set: |e, v| e.view.cameras[$n - 1].fov = float(v),
            },
            Parameter {
                name: concat!("camera.", $n, ".projection"),
                kind: Kind::Choice(&["auto", "perspective", "orthographic"]),
                unit: "",
                doc: "Perspective, or orthographic along the line of sight.",
                get: |e| word_of(PROJECTIONS, &e.view.cameras[$n - 1].projection),
                set: |e, v| e.view.cameras[$n - 1].projection = choice_of(PROJECTIONS, v),
            },
            Parameter {
                name: concat!("camera.", $n, ".follow"),
                kind: Kind::Switch,
                unit: "",
                doc: "The camera moves along with the carrier on the new path.",
                get: |e| Value::Boolean(e.view.cameras[$n - 1].follow),
                set: |e, v| e.view.cameras[$n - 1].follow = switch(v),
            },
        ]
    };
}

macro_rules! view_camera_row {
    ($window:literal, $window_idx:literal, $n:literal) => {
        Parameter {
            name: concat!($window, ".", $n, ".camera"),
            kind: Kind::Count { min: 1, max: 4, step: 1, auto: false },
            unit: "",
            doc: "Camera preset that this view is seen from.",
            get: |e| Value::Integer(e.view.windows[$window_idx].views[$n - 1].camera_idx as i64 + 1),
            set: |e, v| {
                e.view.windows[$window_idx].views[$n - 1].camera_idx = count(v).expect("admitted as a count") - 1;
            },
        }
    };
}

macro_rules! view_hide_row {
    ($window:literal, $window_idx:literal, $n:literal) => {
        Parameter {
            name: concat!($window, ".", $n, ".hide"),
            kind: Kind::Objects,
            unit: "",
            doc: "What show.* draws and this view leaves out.",
            get: |e| hidden(e.view.windows[$window_idx].views[$n - 1].shows),
            set: |e, v| e.view.windows[$window_idx].views[$n - 1].shows = shown(v),
        }
    };
}

macro_rules! window_rows {
    ($window:literal, $window_idx:literal, $doc:literal) => {
        [
            Parameter {
                name: concat!($window, ".layout"),
                kind: Kind::OneOf(&[1, 2, 4]),
                unit: "views",
                doc: $doc,
                get: |e| Value::Integer(e.view.windows[$window_idx].layout as i64),
                set: |e, v| e.view.windows[$window_idx].layout = count(v).expect("admitted as a count"),
            },
            view_camera_row!($window, $window_idx, 1),
            view_hide_row!($window, $window_idx, 1),
            view_camera_row!($window, $window_idx, 2),
            view_hide_row!($window, $window_idx, 2),
            view_camera_row!($window, $window_idx, 3),
            view_hide_row!($window, $window_idx, 3),
            view_camera_row!($window, $window_idx, 4),
            view_hide_row!($window, $window_idx, 4),
        ]
    };
}

pub(super) const SHOW: [Parameter; 13] = [
    show_row!(original_skeleton, "Draw the actor as captured."),
    show_row!(new_skeleton, "Draw the actor on the new path."),
    show_row!(original_path, "Draw the path fitted to the clip."),
    show_row!(new_path, "Draw the new path."),
    show_row!(control_points, "Draw the control points and the polygon through them."),
    show_row!(original_tracker, "Draw a block that walks the original path."),
    show_row!(new_tracker, "Draw a block that walks the new path."),
    show_row!(ground, "Draw the ground and its grid."),
    show_row!(footprints, "Draw where the feet stand; crossed out where a plant could not be reached."),
    show_row!(traces, "Draw the trails of hands, feet and head on the new path, with a mark where they are."),
    show_row!(wireframe, "Draw bones as edges in place of solids."),
    show_row!(normal_skeleton, "Draw the actor with all rotations zero, where the carrier is."),
    show_row!(labels, "Draw names in the picture."),
];

pub(super) const CAMERAS: [[Parameter; 6]; 4] = [camera_rows!(1), camera_rows!(2), camera_rows!(3), camera_rows!(4)];

pub(super) const WINDOWS: [[Parameter; 9]; 2] = [
    window_rows!("view", 0, "Views of the preview window: one, two side by side, four in a square."),
    window_rows!("second", 1, "Views of the second window: one, two side by side, four in a square."),
];

/// Returns the names of the drawn objects, which are those of `show.*`.
pub(super) fn objects() -> impl Iterator<Item = &'static str> {
    SHOW.iter().map(|p| p.name.rsplit('.').next().expect("a name has a last part"))
}

/// The names of what a view leaves out, in the order of the table.
fn hidden(shows: Show) -> Value {
    let mut edits = Edits::default();
    edits.view.show = shows;
    let left_out = SHOW.iter().zip(objects()).filter(|(p, _)| !switch(&p.get(&edits)));
    Value::Array(left_out.map(|(_, name)| word(name)).collect())
}

/// What a view shows when it leaves out what [`Kind::admit`] let through.
fn shown(hidden: &Value) -> Show {
    let mut edits = Edits::default();
    let hidden = hidden.as_array().expect("admitted as a list of objects");
    for (p, name) in SHOW.iter().zip(objects()) {
        (p.set)(&mut edits, &Value::Boolean(!hidden.iter().any(|h| h.as_str() == Some(name))));
    }
    edits.view.show
}
