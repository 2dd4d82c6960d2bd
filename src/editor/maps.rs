//! The maps tab: what layers do to the joint that keys act on, over all frames, and the keys of the selection.
//!
//! All layers together turn a joint about some axis. A layer that goes from key to key by Euler angles is charted alone
//! and as it is: by what it adds to each of the joint's channels.

use std::collections::BTreeSet;

use glam::{DQuat, DVec3};

use super::{Editor, Handle, Row, RowKind, TABS, Tab, panel};
use crate::{
    displace::{MapPoint, PointValue, Selection, Stack, find_joint, joint_name},
    math::rotation_vector_between,
    motion::Clip,
    skeleton::JointId,
};

/// What layers do to one joint or to the carrier's place, frame by frame of the clip.
#[derive(Clone, Debug, PartialEq)]
pub struct MapSeries {
    /// What it is of, for people.
    pub title: String,
    /// Names of the three components.
    pub names: [&'static str; 3],
    /// Degrees about the joint's own x, y, z, or added to its channels in their order; or the offset along the path's
    /// axes in the clip's unit.
    pub values: [Vec<f64>; 3],
    /// Unit of the values.
    pub unit: String,
}

impl Editor {
    /// Returns what layers do to the joint of the selected key; while none is listed, to the handle that keys act on.
    pub fn map_series(&self) -> MapSeries {
        if let Handle::Joint(id) = self.charted()
            && let Some(series) = self.channel_series(id)
        {
            return series;
        }
        let solved = self.document.solved();
        let clip = &solved.clip;
        let displaced = &solved.posed.of_clip;
        let n_frames = clip.n_frames();
        let handle = self.charted();
        let title = super::joints::name(clip, handle);
        let (values, names, unit): (Vec<DVec3>, _, _) = match handle {
            Handle::Position => {
                let by = |frame: usize| displaced.offsets.get(frame).copied().unwrap_or(DVec3::ZERO);
                let unit = clip.facts.unit_word().to_owned();
                ((0..n_frames).map(by).collect(), ["lateral", "up", "forward"], unit)
            }
            Handle::Joint(id) => {
                let turned = displaced.turned.iter().find(|turned| turned.joint == id);
                let carrier_turns = if id == clip.facts.carrier.value { &displaced.carrier_turns[..] } else { &[] };
                let turn = |frame: usize| match (turned, carrier_turns.get(frame)) {
                    (Some(turned), _) => {
                        rotation_vector_between(clip.rotations(frame)[id.idx()], turned.rotations[frame])
                    }
                    (None, Some(&turn)) => rotation_vector_between(DQuat::IDENTITY, turn),
                    (None, None) => DVec3::ZERO,
                };
                let degrees = |frame| turn(frame).map(f64::to_degrees);
                ((0..n_frames).map(degrees).collect(), ["x", "y", "z"], "°".to_owned())
            }
        };
        MapSeries { title, names, values: components(&values), unit }
    }

    /// Returns what the layer in use adds to a joint's channels; none when it does not go by them.
    fn channel_series(&self, id: JointId) -> Option<MapSeries> {
        let solved = self.document.solved();
        let clip = &solved.clip;
        let stack = Stack { clip, base: &solved.posed.base.joints, layers: &self.document.edits().layers };
        let layer = self.layer()?;
        let values = stack.channel_offsets(self.view.layer_idx, id)?;
        let axes = clip.rotation_order(id.idx())?.axes();
        Some(MapSeries {
            title: format!("{}, channels · {}", super::joints::name(clip, Handle::Joint(id)), layer.name),
            names: axes.map(|axis| ["x", "y", "z"][axis]),
            values: components(&values),
            unit: "°".to_owned(),
        })
    }

    fn charted(&self) -> Handle {
        let tab_idx = TABS.iter().position(|&tab| tab == Tab::Maps).expect("the tab is in the list");
        let rows = panel::rows_of(self, Tab::Maps);
        let row = rows.get(self.view.rows[tab_idx].min(rows.len().saturating_sub(1)));
        match row.map(|row| row.kind) {
            Some(RowKind::MapPoint { handle, .. }) => handle,
            _ => self.view.joints.active,
        }
    }

    /// Returns the maps that key commands act on: those selected, or of the handle that keys act on when none is. The
    /// carrier as a joint has both its maps, for it is moved by the one and turned by the other.
    pub fn map_selection(&self) -> Selection {
        let joints = &self.view.joints;
        let clip = &self.document.solved().clip;
        if joints.selected.is_empty() {
            selection(clip, &[joints.active].into())
        } else {
            selection(clip, &joints.selected)
        }
    }
}

/// Returns the maps of some handles.
fn selection(clip: &Clip, handles: &BTreeSet<Handle>) -> Selection {
    let joint = |&handle: &Handle| match handle {
        Handle::Position => None,
        Handle::Joint(id) => Some(joint_name(&clip.skeleton, id)),
    };
    let carrier = Handle::Joint(clip.facts.carrier.value);
    Selection {
        position: handles.contains(&Handle::Position) || handles.contains(&carrier),
        joints: handles.iter().filter_map(joint).collect(),
    }
}

fn components(values: &[DVec3]) -> [Vec<f64>; 3] {
    [0, 1, 2].map(|axis| values.iter().map(|value| value[axis]).collect())
}

/// Returns the map points of the selection, a row for each: what the key holds comes before the map's name, so that a
/// narrow panel cuts the name.
pub(super) fn rows(editor: &Editor) -> Vec<Row> {
    let Some(layer) = editor.document.edits().layers.get(editor.view.layer_idx) else { return Vec::new() };
    let points = layer.map_points(&editor.map_selection());
    let clip = &editor.document.solved().clip;
    let (skeleton, decimals) = (&clip.skeleton, panel::decimals(clip.facts.height.value) + 1);
    let widest = |text: &dyn Fn(&MapPoint) -> String| points.iter().map(|p| text(p).chars().count()).max().unwrap_or(0);
    let frames = widest(&|point| point.frame.to_string());
    let values = widest(&|point| point.value.short(decimals));
    let handle = |value: &PointValue| match value {
        PointValue::Position(_) => Handle::Position,
        PointValue::Rotation(name, _) => find_joint(skeleton, name).map_or(editor.view.joints.active, Handle::Joint),
    };
    let row = |(point_idx, point): (usize, &MapPoint)| {
        let MapPoint { frame, value } = point;
        Row {
            kind: RowKind::MapPoint { point_idx, frame: *frame, handle: handle(value) },
            label: format!("{frame:>frames$} {:<values$} {}", value.short(decimals), value.map_name()),
            value: String::new(),
            unit: "",
            changed: false,
            selected: false,
            help: format!("{}: {value}; j and k walk the keys of {} with the playhead.", value.map_name(), layer.name),
        }
    };
    points.iter().enumerate().map(row).collect()
}

/// Takes the playhead to the frame of a key; where the edited clip ends before it, stays.
pub(super) fn go_to(editor: &mut Editor, file_frame: usize) {
    let solved = editor.document.solved();
    let frame = file_frame.checked_sub(solved.clip.rest_frames()).and_then(|frame| solved.edited_frame(frame));
    if let Some(frame) = frame {
        editor.view.jump(frame);
    }
}
