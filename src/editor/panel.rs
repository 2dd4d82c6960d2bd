//! The panel: tabs of rows, read from the parameter table.

use super::{Editor, Group, Handle, ViewState, feet, joints, layers, loops, maps, views};
use crate::{
    document::{PARAMETERS, Parameter},
    math::fixed,
    measure::Pair,
};

/// One tab of the panel.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Tab {
    /// The new path and its control points.
    Path,
    /// The path fitted to the clip and what is carried.
    Original,
    /// Speed along the path.
    Timing,
    /// How plants are found and held, and the chosen foot's plants.
    Feet,
    /// The joint tree.
    Joints,
    /// What the file holds.
    Clip,
    /// What is drawn.
    Show,
    /// The view in focus and its camera preset.
    Camera,
    /// Layers of displacement maps, and how keys move joints.
    Layers,
    /// What the layers do to the joint that keys act on, and the selection's keys.
    Maps,
    /// Residuals over time, and the degree they belong to.
    Residuals,
    /// Quality numbers.
    Quality,
}

/// The tabs in order.
pub const TABS: [Tab; 12] = [
    Tab::Path,
    Tab::Original,
    Tab::Timing,
    Tab::Feet,
    Tab::Joints,
    Tab::Layers,
    Tab::Maps,
    Tab::Clip,
    Tab::Show,
    Tab::Camera,
    Tab::Residuals,
    Tab::Quality,
];

impl Tab {
    /// Returns the tab's title.
    pub fn title(self) -> &'static str {
        match self {
            Self::Path => "path",
            Self::Original => "original",
            Self::Timing => "timing",
            Self::Feet => "feet",
            Self::Joints => "joints",
            Self::Clip => "clip",
            Self::Show => "show",
            Self::Camera => "camera",
            Self::Layers => "layers",
            Self::Maps => "maps",
            Self::Residuals => "residuals",
            Self::Quality => "quality",
        }
    }

    /// Tells whether keys are about joints here, not about control points and plants.
    pub fn is_of_joints(self) -> bool {
        matches!(self, Self::Joints | Self::Layers | Self::Maps)
    }

    /// Returns the headings of the keys that it is about.
    pub(super) fn groups(self) -> &'static [Group] {
        match self {
            Self::Feet => &[Group::Feet],
            Self::Joints | Self::Maps => &[Group::Joints, Group::Points, Group::Layers],
            Self::Layers => &[Group::Layers, Group::Joints, Group::Points],
            Self::Show => &[Group::Show, Group::Views],
            Self::Camera => &[Group::Camera, Group::Views],
            // The rest is about what the table begins with.
            _ => &[],
        }
    }

    fn holds(self, parameter: &Parameter, view: &ViewState) -> bool {
        let section = parameter.section();
        match self {
            // The points are rows of their own.
            Self::Path => section == "path" && parameter.name != "path.control_points",
            Self::Original => ["original", "residual", "heading"].contains(&section),
            Self::Timing => ["timing", "loop"].contains(&section),
            Self::Clip => section == "clip",
            Self::Show => section == "show",
            Self::Camera => {
                let camera = ["camera.1", "camera.2", "camera.3", "camera.4"][view.camera_idx];
                let (focused, window) = views::sections(view);
                section == camera || section == window || section == focused
            }
            Self::Feet => section == "plants",
            Self::Layers => section == "pose" || parameter.name == "interpolation_keys",
            Self::Residuals => parameter.name == "original.degree",
            Self::Joints | Self::Maps | Self::Quality => false,
        }
    }
}

/// One row of the panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Row {
    /// What the row is.
    pub kind: RowKind,
    /// Name at the left.
    pub label: String,
    /// Value at the right.
    pub value: String,
    /// Unit after the value; empty for none.
    pub unit: &'static str,
    /// Whether the value differs from the default.
    pub changed: bool,
    /// Whether keys act on this row.
    pub selected: bool,
    /// One line of help, the range included.
    pub help: String,
}

/// What a row stands for.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum RowKind {
    /// A parameter.
    Parameter(&'static str),
    /// A control point.
    Point {
        /// Index of the point.
        point_idx: usize,
    },
    /// A loop that was found.
    Loop {
        /// Its place in the list, the best first.
        loop_idx: usize,
    },
    /// A plant of the chosen foot.
    Plant {
        /// Index of the plant.
        plant_idx: usize,
    },
    /// What a displacement map can move.
    Joint(Handle),
    /// A layer of displacement maps.
    Layer {
        /// Its place in the list, the lowest first.
        layer_idx: usize,
    },
    /// A key of a selected map of the layer in use.
    MapPoint {
        /// Its place in the list.
        point_idx: usize,
        /// File frame.
        frame: usize,
        /// What it moves.
        handle: Handle,
    },
    /// Something to read.
    Fact,
}

/// Returns the rows of the tab in use.
pub(super) fn rows(editor: &Editor) -> Vec<Row> {
    let mut rows = rows_of(editor, TABS[editor.view.tab_idx]);
    if let Some(row) = selected_idx(editor, &rows) {
        rows[row].selected = true;
    }
    rows
}

/// Returns the rows of a tab, none of them selected.
pub(super) fn rows_of(editor: &Editor, tab: Tab) -> Vec<Row> {
    let view = &editor.view;
    let edits = editor.document.edits();
    let mut rows: Vec<Row> = PARAMETERS
        .iter()
        .filter(|p| tab.holds(p, view))
        .map(|p| Row {
            kind: RowKind::Parameter(p.name),
            label: p.name.to_owned(),
            value: p.display(edits),
            unit: p.unit,
            changed: p.get(edits) != p.default_value(),
            selected: false,
            help: format!("{} Takes {}.", p.doc, p.kind.in_words()),
        })
        .collect();
    match tab {
        Tab::Path => rows.extend(point_rows(editor)),
        Tab::Clip => rows.extend(fact_rows(editor)),
        Tab::Original => rows.extend(original_rows(editor)),
        Tab::Timing => {
            rows.extend(timing_rows(editor));
            rows.extend(loops::rows(editor));
        }
        Tab::Feet => rows.extend(feet_rows(editor)),
        Tab::Joints => rows.extend(joints::rows(editor)),
        Tab::Layers => _ = rows.splice(0..0, layers::rows(editor)),
        Tab::Maps => rows.extend(maps::rows(editor)),
        Tab::Quality => rows.extend(quality_rows(editor)),
        Tab::Show | Tab::Camera | Tab::Residuals => {}
    }
    rows
}

/// Returns the index of the selected row; among plants and joints it is the one that keys act on, wherever the playhead
/// or a click went.
fn selected_idx(editor: &Editor, rows: &[Row]) -> Option<usize> {
    let kept = editor.view.rows[editor.view.tab_idx].min(rows.len().checked_sub(1)?);
    let kind = match rows[kept].kind {
        RowKind::Plant { .. } => RowKind::Plant { plant_idx: editor.chosen_plant()?.1 },
        RowKind::Joint(_) => RowKind::Joint(editor.view.joints.active),
        RowKind::Layer { .. } => RowKind::Layer { layer_idx: editor.view.layer_idx },
        _ => return Some(kept),
    };
    rows.iter().position(|row| row.kind == kind)
}

/// Says how many there are of something.
pub(super) fn counted(n: usize, what: &str) -> String {
    format!("{n} {what}{}", if n == 1 { "" } else { "s" })
}

pub(super) fn fact(label: &str, value: String, help: String) -> Row {
    Row { kind: RowKind::Fact, label: label.to_owned(), value, unit: "", changed: false, selected: false, help }
}

fn point_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let given = editor.document.edits().path.control_points.is_some();
    let points = solved.control_points();
    let digits = decimals(solved.clip.facts.height.value);
    points
        .iter()
        .enumerate()
        .map(|(point_idx, p)| Row {
            kind: RowKind::Point { point_idx },
            label: format!("{} point {}", if point_idx == editor.view.point_idx { '◆' } else { '●' }, point_idx + 1),
            value: p.to_array().map(|n| fixed(n, digits)).join(" "),
            unit: "",
            changed: given,
            selected: false,
            help: "x X y Y z Z move it by path.nudge, enter types its coordinates (the clip's axes).".to_owned(),
        })
        .collect()
}

/// Decimals that show a thousandth of a body height.
pub(super) fn decimals(height: f64) -> usize {
    (3.0 - height.log10()).ceil().clamp(0.0, 6.0) as usize
}

fn fact_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let (clip, facts) = (&solved.clip, &solved.clip.facts);
    let digits = decimals(facts.height.value);
    vec![
        fact("file", solved.source.name.clone(), "The clip as loaded.".to_owned()),
        fact("frames", clip.n_file_frames().to_string(), "Frames in the file, rest frames included.".to_owned()),
        fact("frame time", format!("{:.6} s", clip.frame_time_secs), "Seconds from one frame to the next.".to_owned()),
        fact("joints", clip.skeleton.n_joints().to_string(), "Joints, end sites not counted.".to_owned()),
        fact("carrier", clip.skeleton.joint(facts.carrier.value).name.clone(), sentence(&facts.carrier.why)),
        fact("up", format!("{:?}", facts.up.value).to_lowercase(), sentence(&facts.up.why)),
        fact("root offset", format!("{:?}", facts.root_offset.value).to_lowercase(), sentence(&facts.root_offset.why)),
        fact(
            "joint offsets",
            format!("{:?}", facts.joint_offsets.value).to_lowercase(),
            sentence(&facts.joint_offsets.why),
        ),
        fact("rest frames", facts.rest_frames.value.to_string(), sentence(&facts.rest_frames.why)),
        fact("height", format!("{:.digits$}", facts.height.value), sentence(&facts.height.why)),
        fact("unit", facts.unit.value.unwrap_or("unknown").to_owned(), sentence(&facts.unit.why)),
    ]
}

fn sentence(why: &str) -> String {
    let mut chars = why.chars();
    chars.next().map_or_else(String::new, |first| format!("{}{}.", first.to_uppercase(), chars.as_str()))
}

fn original_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let digits = decimals(solved.clip.facts.height.value);
    let rms = solved.residual_rms();
    vec![
        fact("degree in use", solved.original.degree().to_string(), "After the rule of auto and the cap.".to_owned()),
        fact(
            "length",
            format!("{:.digits$}", solved.original.length()),
            "Arc length of the original path, the clip's unit.".to_owned(),
        ),
        fact(
            "residual RMS",
            format!("{:.digits$} {:.digits$} {:.digits$}", rms.x, rms.y, rms.z),
            "What the path leaves over along x, y, z of the clip's axes, the clip's unit.".to_owned(),
        ),
    ]
}

fn timing_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let digits = decimals(solved.clip.facts.height.value);
    let secs = |n: usize| format!("{n} frames, {:.2} s", n as f64 * solved.clip.frame_time_secs);
    vec![
        fact("clip", secs(solved.clip.n_frames()), "The clip without its rest frames.".to_owned()),
        fact("edited", secs(solved.edited.n_frames()), "What would be exported, without rest frames.".to_owned()),
        fact(
            "path length",
            format!("{:.digits$}", solved.new_path.length()),
            "Arc length of the new path, the clip's unit.".to_owned(),
        ),
    ]
}

fn feet_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let legs = &solved.feet.found.legs;
    let named = legs.value.iter().map(|leg| solved.clip.skeleton.joint(leg.ankle).name.as_str());
    let named = named.collect::<Vec<_>>().join(", ");
    let why = format!("{} clip.legs names the legs when the guess is wrong.", sentence(&legs.why));
    let mut rows = vec![fact("legs", if named.is_empty() { "none".to_owned() } else { format!("to {named}") }, why)];
    let Some(foot_idx) = editor.chosen_foot() else { return rows };
    let foot = &solved.feet.plants[foot_idx];
    let chosen = editor.chosen_plant();
    let keys = "Frames of the file. 5 6 move its first, 7 8 its last; + - choose the mode, backspace is as found.";
    let help = |plant_idx| match solved.missed(foot_idx, plant_idx) {
        Some(missed) => sentence(&solved.missed_plant(missed)),
        None => keys.to_owned(),
    };
    rows.push(fact(
        "foot",
        format!("{}, {}", foot.leg.side.name(), counted(foot.plants.len(), "plant")),
        "F chooses the other foot, h and l walk from plant to plant, m begins what is done with one.".to_owned(),
    ));
    rows.extend((0..foot.plants.len()).map(|plant_idx| Row {
        kind: RowKind::Plant { plant_idx },
        label: format!("{} plant {}", if chosen == Some((foot_idx, plant_idx)) { '◆' } else { '●' }, plant_idx + 1),
        value: feet::text(solved, foot_idx, plant_idx),
        unit: "",
        changed: solved.feet.is_edited(foot_idx, plant_idx),
        selected: false,
        help: help(plant_idx),
    }));
    rows
}

fn quality_rows(editor: &Editor) -> Vec<Row> {
    let solved = editor.document.solved();
    let measures = &solved.measures;
    // Numbers that are being measured anew.
    let sign = |is_new: bool| if is_new { "" } else { " …" };
    let (old, old_feet) = (sign(solved.is_measured()), sign(solved.has_feet_measured()));
    let number = |n: Option<f64>| n.map_or_else(|| "–".to_owned(), |n| format!("{n:.4}{old}"));
    let rms = solved.residual_rms() / solved.clip.facts.height.value;
    let mut rows = vec![
        fact(
            "jerk ratio",
            number(measures.jerk_ratio),
            "Mean third difference of all joints, edited over source; 1 is as smooth as the performer.".to_owned(),
        ),
        fact(
            "path error",
            number(measures.path_error),
            "Largest distance of the carrier, residual removed, from the new path; body heights.".to_owned(),
        ),
        fact(
            "residual RMS",
            format!("{:.4} {:.4} {:.4}", rms.x, rms.y, rms.z),
            "What the original path leaves over along x, y, z; body heights.".to_owned(),
        ),
    ];
    let pair = |pair: Option<Pair>| {
        pair.map_or_else(|| "–".to_owned(), |p| format!("{:.4} → {:.4}{old_feet}", p.source, p.edited))
    };
    for (foot, numbers) in solved.feet.plants.iter().zip(solved.foot_numbers.iter()) {
        let joint = &solved.clip.skeleton.joint(foot.leg.ankle).name;
        rows.push(fact(
            &format!("{joint} speed"),
            pair(numbers.planted_speed),
            "Mean speed of the foot while it stands, source → edited; body heights a second.".to_owned(),
        ));
        rows.push(fact(
            &format!("{joint} slip"),
            pair(numbers.slip_p90),
            "How far the foot slips in nine plants of ten, source → edited; body heights.".to_owned(),
        ));
    }
    rows.extend(solved.strains.iter().map(|strain| {
        let rest = solved.clip.rest_frames();
        fact(
            &format!("{} is too much", strain.cause.word()),
            format!("{} to {}", strain.frames.start + rest, strain.frames.end - 1 + rest),
            sentence(&solved.strain(strain)),
        )
    }));
    rows.extend(measures.seam.iter().map(|seam| {
        fact(
            &format!("seam at {}", seam.frame),
            format!("{:.3} {:.3} {:.3}{old}", seam.position, seam.rotation, seam.velocity),
            "Largest step of any joint at the seam: position in body heights, rotation in radians, velocity in body heights a second.".to_owned(),
        )
    }));
    rows
}
