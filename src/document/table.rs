//! The parameter table: every number, choice and switch of [`super::Edits`] by the name that panels, `--set` and project
//! files share.
//!
//! Adding a parameter is one row here, one line in the stage that reads it, one test.

use toml::Value;

use super::{
    Axes, Edits, entries,
    parameter::{Kind, MAX_POINTS, NoJoint, Parameter, SetError, Step},
    table_pictures::{CAMERAS, SHOW, WINDOWS},
    value::{admitted, as_vector, choice_of, count, float, frame, switch, vector, word, word_of},
};
use crate::{
    constrain::Ground,
    displace::InterpolationKeys,
    motion::{MAX_LENGTH, OffsetMeaning, UpAxis},
    path::{Cycling, Degree, Integrator, ResidualFrame},
};

/// All parameters: the edits in the order of work, then what is drawn, then the cameras and the windows' views.
pub static PARAMETERS: Table =
    Table { groups: [&EDITS, &SHOW, &CAMERAS[0], &CAMERAS[1], &CAMERAS[2], &CAMERAS[3], &WINDOWS[0], &WINDOWS[1]] };

/// The parameter table.
pub struct Table {
    groups: [&'static [Parameter]; 8],
}

impl Table {
    /// Returns all rows in order.
    pub fn iter(&self) -> impl Iterator<Item = &'static Parameter> + use<> {
        self.groups.into_iter().flatten()
    }
}

/// Returns the row of this name.
///
/// # Errors
///
/// When there is none; the error names a near one.
pub fn parameter(name: &str) -> Result<&'static Parameter, SetError> {
    PARAMETERS.iter().find(|p| p.name == name).ok_or_else(|| SetError::Unknown {
        name: name.to_owned(),
        near: nearest(name, PARAMETERS.iter().map(|p| p.name)),
    })
}

/// Checks that the carrier asked for is one of the clip's joints.
///
/// # Errors
///
/// When it is none; the error names a near one and lists them all.
pub(super) fn check_carrier(edits: &Edits, joints: &[&str]) -> Result<(), SetError> {
    match &edits.clip.carrier {
        Some(name) if !joints.contains(&name.as_str()) => Err(SetError::NoJoint(Box::new(NoJoint {
            name: "clip.carrier",
            found: name.clone(),
            near: nearest(name, joints.iter().copied()).map(str::to_owned),
            joints: joints.iter().map(ToString::to_string).collect(),
        }))),
        _ => Ok(()),
    }
}

/// Returns the name that is nearly this one.
fn nearest<'a>(name: &str, names: impl Iterator<Item = &'a str>) -> Option<&'a str> {
    let distances = names.map(|known| (edit_distance(name, known), known));
    distances.filter(|(distance, _)| *distance <= 3).min().map(|(_, near)| near)
}

const CYCLING: &[(&str, Cycling)] = &[("off", Cycling::Off), ("plain", Cycling::Plain), ("blended", Cycling::Blended)];
const GROUNDS: &[(&str, Ground)] = &[("steps", Ground::Steps), ("ramp", Ground::Ramp)];
const FRAMES: &[(&str, ResidualFrame)] =
    &[("heading", ResidualFrame::Heading), ("tangent", ResidualFrame::Tangent), ("absolute", ResidualFrame::Absolute)];
const AXES: &[(&str, Axes)] =
    &[("world", Axes::World), ("view", Axes::View), ("parent", Axes::Parent), ("own", Axes::Own)];
const INTEGRATORS: &[(&str, Integrator)] = &[("gauss", Integrator::Gauss), ("euler", Integrator::Euler)];
const UPS: &[(&str, Option<UpAxis>)] = &[("auto", None), ("y", Some(UpAxis::Y)), ("z", Some(UpAxis::Z))];
const OFFSETS: &[(&str, Option<OffsetMeaning>)] =
    &[("auto", None), ("replace", Some(OffsetMeaning::Replace)), ("add", Some(OffsetMeaning::Add))];
const EDITS: [Parameter; 37] = [
    Parameter {
        name: "clip.carrier",
        kind: Kind::Joint,
        unit: "",
        doc: "Joint whose position channels carry the walk.",
        get: |e| word(e.clip.carrier.as_deref().unwrap_or("auto")),
        set: |e, v| e.clip.carrier = v.as_str().filter(|name| *name != "auto").map(str::to_owned),
    },
    Parameter {
        name: "clip.up",
        kind: Kind::Choice(&["auto", "y", "z"]),
        unit: "",
        doc: "Which axis of the file points up.",
        get: |e| word_of(UPS, &e.clip.up),
        set: |e, v| e.clip.up = choice_of(UPS, v),
    },
    Parameter {
        name: "clip.root_offset",
        kind: Kind::Choice(&["auto", "replace", "add"]),
        unit: "",
        doc: "What the root's position channels do to its OFFSET.",
        get: |e| word_of(OFFSETS, &e.clip.root_offset),
        set: |e, v| e.clip.root_offset = choice_of(OFFSETS, v),
    },
    Parameter {
        name: "clip.joint_offsets",
        kind: Kind::Choice(&["auto", "replace", "add"]),
        unit: "",
        doc: "What the other joints' position channels do to their OFFSET.",
        get: |e| word_of(OFFSETS, &e.clip.joint_offsets),
        set: |e, v| e.clip.joint_offsets = choice_of(OFFSETS, v),
    },
    Parameter {
        name: "clip.length",
        kind: Kind::Count { min: 1, max: MAX_LENGTH as i64, step: 1, auto: true },
        unit: "frames",
        doc: "How long a file with one frame or none stands still, for keys to make a motion of; auto is 120 frames.",
        get: |e| frame(e.clip.length),
        set: |e, v| e.clip.length = count(v),
    },
    Parameter {
        name: "clip.rest_frames",
        kind: Kind::Count { min: 0, max: 1_000_000, step: 1, auto: true },
        unit: "frames",
        doc: "Leading frames to leave alone (a T-pose before the motion).",
        get: |e| frame(e.clip.rest_frames),
        set: |e, v| e.clip.rest_frames = count(v),
    },
    Parameter {
        name: "clip.legs",
        kind: Kind::Legs,
        unit: "",
        doc: "The legs by the names of their joints, when the guess is wrong.",
        get: |e| entries::value(&e.clip.legs),
        set: |e, v| e.clip.legs = v.as_array().map_or_else(Vec::new, |legs| admitted(entries::read(legs))),
    },
    Parameter {
        name: "clip.clear_position",
        kind: Kind::Switch,
        unit: "",
        doc: "The clip's own position data takes no part: the carrier keeps to its path, or stands where it begins.",
        get: |e| Value::Boolean(e.cleared.position),
        set: |e, v| e.cleared.position = switch(v),
    },
    Parameter {
        name: "clip.clear_rotation",
        kind: Kind::Switch,
        unit: "",
        doc: "The clip's own rotation data takes no part: every joint is as with all its rotations zero.",
        get: |e| Value::Boolean(e.cleared.rotation),
        set: |e, v| e.cleared.rotation = switch(v),
    },
    Parameter {
        name: "original.degree",
        kind: Kind::Count { min: 1, max: 60, step: 1, auto: true },
        unit: "",
        doc: "Degree of the polynomials fitted to the clip; higher follows it more closely.",
        get: |e| match e.original.degree {
            Degree::Auto => word("auto"),
            Degree::Fixed(d) => Value::Integer(d.into()),
        },
        set: |e, v| e.original.degree = v.as_integer().map_or(Degree::Auto, |d| Degree::Fixed(d as u32)),
    },
    Parameter {
        name: "residual.frame",
        kind: Kind::Choice(&["heading", "tangent", "absolute"]),
        unit: "",
        doc: "Frame that carries the motion: upright, tilting with the slope, or fixed in the world.",
        get: |e| word_of(FRAMES, &e.residual.frame),
        set: |e, v| e.residual.frame = choice_of(FRAMES, v),
    },
    Parameter {
        name: "heading.window",
        kind: Kind::Real { min: 0.0, max: 3.0, step: Step::Add(0.05) },
        unit: "body heights",
        doc: "Half the chord that gives a path its heading; 0 is the plain tangent.",
        get: |e| Value::Float(e.heading.window),
        set: |e, v| e.heading.window = float(v),
    },
    Parameter {
        name: "path.edited",
        kind: Kind::Switch,
        unit: "",
        doc: "Walk the new path; off: the clip's own.",
        get: |e| Value::Boolean(e.path.edited),
        set: |e, v| e.path.edited = switch(v),
    },
    Parameter {
        name: "path.degree",
        kind: Kind::Count { min: 1, max: 9, step: 1, auto: false },
        unit: "",
        doc: "Degree of the new path's B-spline; 1 is straight pieces.",
        get: |e| Value::Integer(e.path.degree as i64),
        set: |e, v| e.path.degree = count(v).expect("admitted as a count"),
    },
    Parameter {
        name: "path.points",
        kind: Kind::Count { min: 2, max: MAX_POINTS as i64, step: 1, auto: false },
        unit: "points",
        doc: "Number of control points; changing it keeps the path's shape.",
        get: |e| Value::Integer(e.path.points as i64),
        set: |e, v| e.path.points = count(v).expect("admitted as a count"),
    },
    Parameter {
        name: "path.control_points",
        kind: Kind::Points,
        unit: "clip unit",
        doc: "The control points in the clip's axes; auto is the straight line.",
        get: |e| match &e.path.control_points {
            None => word("auto"),
            Some(points) => Value::Array(points.iter().copied().map(vector).collect()),
        },
        set: |e, v| {
            e.path.control_points = v.as_array().map(|a| a.iter().filter_map(as_vector).collect());
            if let Some(points) = &e.path.control_points {
                e.path.points = points.len();
            }
        },
    },
    Parameter {
        name: "path.nudge",
        kind: Kind::Real { min: 0.001, max: 10.0, step: Step::Times(std::f64::consts::SQRT_2) },
        unit: "body heights",
        doc: "How far one key press moves a control point.",
        get: |e| Value::Float(e.path.nudge),
        set: |e, v| e.path.nudge = float(v),
    },
    Parameter {
        name: "timing.arc_length",
        kind: Kind::Switch,
        unit: "",
        doc: "Keep the walker's speed along the path; off: use the whole path whatever the speed.",
        get: |e| Value::Boolean(e.timing.arc_length),
        set: |e, v| e.timing.arc_length = switch(v),
    },
    Parameter {
        name: "timing.integrator",
        kind: Kind::Choice(&["gauss", "euler"]),
        unit: "",
        doc: "How arc length is integrated: exactly, or in the thesis's steps.",
        get: |e| word_of(INTEGRATORS, &e.timing.integrator),
        set: |e, v| e.timing.integrator = choice_of(INTEGRATORS, v),
    },
    Parameter {
        name: "timing.step",
        kind: Kind::Real { min: 1e-6, max: 0.1, step: Step::Times(2.0) },
        unit: "of the range",
        doc: "Size of an Euler step, a share of the parameter range.",
        get: |e| Value::Float(e.timing.step),
        set: |e, v| e.timing.step = float(v),
    },
    Parameter {
        name: "timing.cycling",
        kind: Kind::Choice(&["off", "plain", "blended"]),
        unit: "",
        doc: "On a path longer than the clip: end, start the clip again where it ended, or repeat a loop without a seam.",
        get: |e| word_of(CYCLING, &e.timing.cycling),
        set: |e, v| e.timing.cycling = choice_of(CYCLING, v),
    },
    Parameter {
        name: "timing.speed",
        kind: Kind::Real { min: 0.05, max: 4.0, step: Step::Times(std::f64::consts::SQRT_2) },
        unit: "times",
        doc: "Playback rate; the exported clip keeps its own time.",
        get: |e| Value::Float(e.timing.speed),
        set: |e, v| e.timing.speed = float(v),
    },
    Parameter {
        name: "loop.start",
        kind: Kind::Count { min: 0, max: 1_000_000, step: 1, auto: true },
        unit: "file frame",
        doc: "First frame of the loop that blended cycling repeats; auto takes the best loop found.",
        get: |e| frame(e.loops.start),
        set: |e, v| e.loops.start = count(v),
    },
    Parameter {
        name: "loop.end",
        kind: Kind::Count { min: 0, max: 1_000_000, step: 1, auto: true },
        unit: "file frame",
        doc: "Frame after the loop's last one; auto takes the best loop found.",
        get: |e| frame(e.loops.end),
        set: |e, v| e.loops.end = count(v),
    },
    Parameter {
        name: "loop.blend",
        kind: Kind::Real { min: 0.0, max: 2.0, step: Step::Add(0.05) },
        unit: "seconds",
        doc: "Time on each side of the loop's seam over which its mismatch is spread; 0 is a hard cut.",
        get: |e| Value::Float(e.loops.blend),
        set: |e, v| e.loops.blend = float(v),
    },
    Parameter {
        name: "plants.hold",
        kind: Kind::Switch,
        unit: "",
        doc: "Planted feet stay where they stand on the new path.",
        get: |e| Value::Boolean(e.plants.hold),
        set: |e, v| e.plants.hold = switch(v),
    },
    Parameter {
        name: "plants.clean",
        kind: Kind::Switch,
        unit: "",
        doc: "Planted feet stand wholly still: their own slide is removed too.",
        get: |e| Value::Boolean(e.plants.clean),
        set: |e, v| e.plants.clean = switch(v),
    },
    Parameter {
        name: "plants.ground",
        kind: Kind::Choice(&["steps", "ramp"]),
        unit: "",
        doc: "On a path that climbs: feet level as on stairs, or tilted with the slope.",
        get: |e| word_of(GROUNDS, &e.plants.ground),
        set: |e, v| e.plants.ground = choice_of(GROUNDS, v),
    },
    Parameter {
        name: "plants.speed",
        kind: Kind::Real { min: 0.0, max: 3.0, step: Step::Add(0.01) },
        unit: "body heights a second",
        doc: "Slower than this, and low, a foot stands.",
        get: |e| Value::Float(e.plants.detection.speed),
        set: |e, v| e.plants.detection.speed = float(v),
    },
    Parameter {
        name: "plants.speed_share",
        kind: Kind::Real { min: 0.0, max: 1.0, step: Step::Add(0.01) },
        unit: "of the carrier's speed",
        doc: "The same as a share of the carrier's speed, whichever is more.",
        get: |e| Value::Float(e.plants.detection.speed_share),
        set: |e, v| e.plants.detection.speed_share = float(v),
    },
    Parameter {
        name: "plants.height",
        kind: Kind::Real { min: 0.0, max: 0.5, step: Step::Add(0.01) },
        unit: "body heights",
        doc: "Lower than this above its floor, and slow, a foot stands.",
        get: |e| Value::Float(e.plants.detection.height),
        set: |e, v| e.plants.detection.height = float(v),
    },
    Parameter {
        name: "plant",
        kind: Kind::Plants,
        unit: "file frames",
        doc: "Plants edited by hand; mode is hold, clean, slide, or none where the foot does not stand.",
        get: |e| entries::value(&e.edited_plants),
        set: |e, v| {
            e.edited_plants = v.as_array().map_or_else(Vec::new, |plants| admitted(entries::read_plants(plants)));
        },
    },
    Parameter {
        name: "interpolation_keys",
        kind: Kind::Frames,
        unit: "file frames",
        doc: "Between these the clip is replaced by the interpolation of their two poses; exported when asked for.",
        get: |e| {
            let frames = e.interpolation_keys.map_or_else(Vec::new, |keys| vec![keys.first, keys.last]);
            Value::Array(frames.into_iter().map(|frame| Value::Integer(frame as i64)).collect())
        },
        set: |e, v| {
            let frames: Vec<usize> = v.as_array().into_iter().flatten().filter_map(count).collect();
            e.interpolation_keys = match frames[..] {
                [first, last] => Some(InterpolationKeys { first, last }),
                _ => None,
            };
        },
    },
    Parameter {
        name: "pose.nudge",
        kind: Kind::Real { min: 0.0001, max: 10.0, step: Step::Times(1.25) },
        unit: "body heights",
        doc: "How far one key press moves a joint.",
        get: |e| Value::Float(e.pose.nudge),
        set: |e, v| e.pose.nudge = float(v),
    },
    Parameter {
        name: "pose.turn",
        kind: Kind::Real { min: 0.01, max: 90.0, step: Step::Times(1.25) },
        unit: "degrees",
        doc: "How far one key press turns a joint.",
        get: |e| Value::Float(e.pose.turn),
        set: |e, v| e.pose.turn = float(v),
    },
    Parameter {
        name: "pose.axes",
        kind: Kind::Choice(&["world", "view", "parent", "own"]),
        unit: "",
        doc: "Axes along which joints move and about which they turn: the clip's, the view's, the parent's, their own.",
        get: |e| word_of(AXES, &e.pose.axes),
        set: |e, v| e.pose.axes = choice_of(AXES, v),
    },
    Parameter {
        name: "layer",
        kind: Kind::Layers,
        unit: "file frames",
        doc: "Displacement maps, bottom to top; rotations [w, x, y, z], positions [lateral, up, forward] of the path.",
        get: |e| entries::value(&e.layers),
        set: |e, v| e.layers = v.as_array().map_or_else(Vec::new, |layers| admitted(entries::read(layers))),
    },
];

/// Number of single-letter changes between two names.
fn edit_distance(a: &str, b: &str) -> usize {
    let b: Vec<char> = b.chars().collect();
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, ca) in a.chars().enumerate() {
        let mut diagonal = std::mem::replace(&mut row[0], i + 1);
        for (j, cb) in b.iter().enumerate() {
            let changed = diagonal + usize::from(ca != *cb);
            diagonal = row[j + 1];
            row[j + 1] = changed.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::document::{parse_assignment, show_value};

    fn check(text: &str, expected: Result<&str, &str>) {
        let (name, value) = parse_assignment(text).expect("an assignment");
        let mut edits = Edits::default();
        let got = parameter(&name).and_then(|p| {
            p.set(&mut edits, &value)?;
            Ok(show_value(&p.get(&edits)))
        });
        let got = got.map_err(|e| e.to_string());
        assert_eq!(got.as_deref().map_err(String::as_str), expected, "{text}");
    }

    #[test]
    fn values_are_read_as_people_write_them() {
        check("original.degree=13", Ok("13"));
        check("original.degree=auto", Ok("auto"));
        check("path.nudge = 2", Ok("2"));
        check("timing.cycling=plain", Ok("plain"));
        check("timing.cycling=\"plain\"", Ok("plain"));
        check("path.edited=off", Ok("false"));
        check("clip.carrier=Hips", Ok("Hips"));
        check("clip.carrier=mixamorig:Hips", Ok("mixamorig:Hips"));
        check("camera.2.eye=[1, 2.5, -3]", Ok("[1, 2.5, -3]"));
        check(
            "plant=[{first=3, last=9, foot=\"left\"}]",
            Ok("[{ foot = \"left\", first = 3, last = 9, mode = \"hold\" }]"),
        );
        check("plant=[]", Ok("auto"));
        check(
            "clip.legs=[{side='left', ankle='a b', knee='k', hip='h'}]",
            Ok("[{ side = \"left\", hip = \"h\", knee = \"k\", ankle = \"a b\" }]"),
        );
        check("view.layout=4", Ok("4"));
        check("second.3.camera=1", Ok("1"));
        check("view.2.hide=ground", Ok("[\"ground\"]"));
        check("view.2.hide=[\"traces\", \"ground\", \"traces\"]", Ok("[\"ground\", \"traces\"]"));
        check("view.2.hide=[]", Ok("[]"));
        check(
            "path.control_points=[[0,0,0],[1,0,0],[2,0,0],[3,0,1]]",
            Ok("[[0, 0, 0], [1, 0, 0], [2, 0, 0], [3, 0, 1]]"),
        );
    }

    #[test]
    fn values_out_of_range_are_refused_in_words() {
        check("original.degree=61", Err("`original.degree` takes a whole number from 1 to 60 or auto, found `61`"));
        check("path.degree=2.5", Err("`path.degree` takes a whole number from 1 to 9, found `2.5`"));
        check("timing.step=nan", Err("`timing.step` takes a number from 0.000001 to 0.1, found `NaN`"));
        check(
            "plant=[{foot=\"left\", first=-3, last=9}]",
            Err("`plant` entry 1: expected a whole number from 0 on, found `-3`"),
        );
        check(
            "plant=none",
            Err("`plant` takes a list of plants [{ foot, first, last, mode }, …] or auto, found `none`"),
        );
        check("path.edited=maybe", Err("`path.edited` takes true or false, found `maybe`"));
        check("path.pionts=3", Err("there is no parameter `path.pionts`; did you mean `path.points`?"));
        check("view.layout=3", Err("`view.layout` takes 1, 2, 4, found `3`"));
        check("view.4.camera=5", Err("`view.4.camera` takes a whole number from 1 to 4, found `5`"));
        check(
            "view.1.hide=[\"floor\"]",
            Err("`view.1.hide` takes a list of names under show., e.g. [\"ground\", \"traces\"], found `[\"floor\"]`"),
        );
        check("nonsense=3", Err("there is no parameter `nonsense`"));
    }

    #[test]
    fn every_row_takes_its_own_default_and_steps_within_its_range() {
        let names: Vec<_> = PARAMETERS.iter().map(|p| p.name).collect();
        for p in PARAMETERS.iter() {
            let mut edits = Edits::default();
            assert_eq!(names.iter().filter(|n| **n == p.name).count(), 1, "{} stands once", p.name);
            p.set(&mut edits, &p.default_value()).expect("the default is a value");
            assert_eq!(edits, Edits::default(), "{}", p.name);
            assert!(p.doc.ends_with('.'), "{}", p.name);
            for (n, big) in [(1, false), (-1, false), (1, true), (-1, true), (1000, true), (-1000, true)] {
                if let Some(value) = p.stepped(&edits, None, n, big) {
                    p.set(&mut edits, &value).unwrap_or_else(|e| panic!("{e}"));
                }
            }
        }
    }

    #[test]
    fn steps_do_what_keys_promise() {
        let edits = Edits::default();
        let from = |name: &str, in_use, n, big| {
            parameter(name).expect("a row").stepped(&edits, in_use, n, big).map(|v| show_value(&v))
        };
        let step = |name: &str, n, big| from(name, None, n, big);
        assert_eq!(step("path.points", 1, false).as_deref(), Some("9"));
        assert_eq!(step("path.points", -1, true).as_deref(), Some("2"));
        assert_eq!(step("original.degree", 1, false).as_deref(), Some("1"));
        assert_eq!(from("original.degree", Some(7), 1, false).as_deref(), Some("8"));
        assert_eq!(from("original.degree", Some(7), -1, true).as_deref(), Some("auto"));
        assert_eq!(from("path.points", Some(20), 1, false).as_deref(), Some("9"), "only auto has another in use");
        assert_eq!(step("heading.window", 1, false).as_deref(), Some("0.55"));
        assert_eq!(step("timing.cycling", -1, false).as_deref(), Some("blended"));
        assert_eq!(step("show.ground", 1, false).as_deref(), Some("false"));
        assert_eq!(step("clip.carrier", 1, false), None);
        assert_eq!(step("view.layout", 1, false).as_deref(), Some("2"));
        assert_eq!(step("view.layout", -1, true).as_deref(), Some("4"));
    }
}
