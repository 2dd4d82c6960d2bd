//! Rows of channels → local transforms, in the file's own axes.
//!
//! Local transform = translation · the channels' rotations in file order (METHOD 1). What a position channel does to
//! OFFSET is not decided here: the caller names a meaning for the roots and one for the other joints.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use wide::f64x4;

use super::{OffsetMeaning, poses::Poses};
use crate::{
    bvh::{Bvh, Channel},
    math::lanes::{FARTHEST_DEGREES, LANES, QuatLanes, half_sin_cos_of_degrees},
    skeleton::{Joint, JointId, Skeleton},
};

/// Largest magnitude that is taken for a number; beyond it cubes of distances would overflow.
const LARGEST: f64 = 1e100;

/// Where a joint's channels lie in a row.
#[derive(Clone, Debug, PartialEq)]
pub(super) struct JointChannels {
    /// Axis (0 x, 1 y, 2 z) and column of each rotation channel, in file order.
    pub(super) rotations: Vec<(usize, usize)>,
    /// Column of the position channel of each axis.
    pub(super) positions: [Option<usize>; 3],
}

impl JointChannels {
    /// Finds the channels of a joint whose first one is in column `first`; of two for one position axis the last counts.
    pub(super) fn new(channels: &[Channel], first: usize) -> Self {
        let mut found = Self { rotations: Vec::new(), positions: [None; 3] };
        for (column, channel) in (first..).zip(channels) {
            match channel {
                Channel::Xposition => found.positions[0] = Some(column),
                Channel::Yposition => found.positions[1] = Some(column),
                Channel::Zposition => found.positions[2] = Some(column),
                Channel::Xrotation => found.rotations.push((0, column)),
                Channel::Yrotation => found.rotations.push((1, column)),
                Channel::Zrotation => found.rotations.push((2, column)),
            }
        }
        found
    }

    /// Tells whether there are three position channels and one rotation channel about each axis.
    pub(super) fn moves_freely(&self) -> bool {
        self.turns_freely() && self.positions.iter().all(Option::is_some)
    }

    /// Tells whether there is one rotation channel about each axis.
    pub(super) fn turns_freely(&self) -> bool {
        self.free_rotations().is_some()
    }

    /// Returns the rotation channels where there is one about each axis.
    pub(super) fn free_rotations(&self) -> Option<[(usize, usize); 3]> {
        let channels: [(usize, usize); 3] = self.rotations.as_slice().try_into().ok()?;
        let mut axes = channels.map(|(axis, _)| axis);
        axes.sort_unstable();
        (axes == [0, 1, 2]).then_some(channels)
    }

    /// Tells whether the joint has any position channel.
    pub(super) fn has_position(&self) -> bool {
        self.positions.iter().any(Option::is_some)
    }

    /// Returns OFFSET where a position channel exists and 0 elsewhere: what tells replacing from adding.
    pub(super) fn covered(&self, offset: DVec3) -> DVec3 {
        DVec3::from_array(std::array::from_fn(|axis| if self.positions[axis].is_some() { offset[axis] } else { 0.0 }))
    }
}

/// A file's motion as numbers that can be trusted: finite, with a skeleton in the file's axes.
#[derive(Debug)]
pub(super) struct FileMotion {
    pub(super) skeleton: Skeleton,
    pub(super) channels: Vec<JointChannels>,
    /// At least 1; more than there are rows when the one row stands for all frames.
    pub(super) n_frames: usize,
    pub(super) n_channels: usize,
    /// Rows × channels; the file's own where all of them are numbers. One row: of every frame.
    pub(super) values: Arc<Vec<f64>>,
}

impl FileMotion {
    /// Reads the file's numbers; those that are none are replaced, with a warning. A file without rows gets one of zeros.
    ///
    /// `n_frames` is the number of rows, or any where there is one row or none.
    pub(super) fn new(bvh: &Bvh, n_frames: usize, warnings: &mut Vec<String>) -> Self {
        let channels: Vec<JointChannels> =
            bvh.joints().iter().map(|j| JointChannels::new(&j.channels, j.first_channel)).collect();
        let skeleton = skeleton(bvh, warnings);
        let read = if bvh.n_frames() == 0 { Arc::new(vec![0.0; bvh.n_channels()]) } else { bvh.shared_values() };
        let values = finite(read, bvh.n_channels(), &channels, warnings);
        Self { skeleton, channels, n_frames, n_channels: bvh.n_channels(), values }
    }

    /// Returns the channel values of a frame.
    fn row(&self, frame: usize) -> &[f64] {
        let is_only_row = self.values.len() == self.n_channels;
        &self.values[if is_only_row { 0 } else { frame * self.n_channels }..][..self.n_channels]
    }

    /// Returns a joint's channel values over the frames, one column.
    pub(super) fn column(&self, column: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().copied().skip(column).step_by(self.n_channels.max(1))
    }

    /// Returns the position channels' values of a joint at a frame; 0 on an axis without channel.
    pub(super) fn position(&self, frame: usize, joint: usize) -> DVec3 {
        let row = self.row(frame);
        let positions = self.channels[joint].positions;
        DVec3::from_array(std::array::from_fn(|axis| positions[axis].map_or(0.0, |column| row[column])))
    }

    /// Computes the local transforms of all frames.
    pub(super) fn poses(&self, root: OffsetMeaning, joints: OffsetMeaning) -> Poses {
        let n_joints = self.skeleton.n_joints();
        let offsets: Vec<DVec3> = self.skeleton.joints().iter().map(|j| j.offset).collect();
        let moving: Vec<usize> = (0..n_joints).filter(|&j| self.channels[j].has_position()).collect();
        let mut columns = vec![None; n_joints];
        for (column, &joint) in moving.iter().enumerate() {
            columns[joint] = Some(column);
        }
        let base: Vec<DVec3> = (moving.iter())
            .map(|&joint| {
                let is_root = self.skeleton.joints()[joint].parent.is_none();
                match if is_root { root } else { joints } {
                    OffsetMeaning::Replace => offsets[joint] - self.channels[joint].covered(offsets[joint]),
                    OffsetMeaning::Add => offsets[joint],
                }
            })
            .collect();
        let mut translations = Vec::with_capacity(self.n_frames * moving.len());
        for frame in 0..self.n_frames {
            translations.extend(moving.iter().zip(&base).map(|(&joint, &base)| base + self.position(frame, joint)));
        }
        let mut rotations = Vec::new();
        self.rotations(&mut rotations);
        Poses {
            n_joints,
            n_frames: self.n_frames,
            rotations,
            columns,
            fixed: offsets,
            n_columns: moving.len(),
            translations,
        }
    }

    /// Fills `out` with the local rotations, frames × joints.
    fn rotations(&self, out: &mut Vec<DQuat>) {
        let n_joints = self.skeleton.n_joints();
        out.clear();
        out.reserve(self.n_frames * n_joints);
        for group in (0..self.n_frames).step_by(LANES) {
            let rows: [&[f64]; LANES] = std::array::from_fn(|lane| self.row((group + lane).min(self.n_frames - 1)));
            let n_lanes = LANES.min(self.n_frames - group);
            out.resize(out.len() + n_lanes * n_joints, DQuat::IDENTITY);
            let written = &mut out[group * n_joints..];
            for (joint, channels) in self.channels.iter().enumerate() {
                let lanes = local_rotation(&channels.rotations, rows).lanes();
                for (row, &rotation) in written.chunks_exact_mut(n_joints).zip(&lanes) {
                    row[joint] = rotation;
                }
            }
        }
    }
}

/// Fills `out` with the local rotations a file's channels stand for, frames × joints, in the file's own axes.
///
/// This is the costly half of reading a clip; [`super::Clip::from_bvh`] does it and all the rest.
pub fn local_rotations(bvh: &Bvh, out: &mut Vec<DQuat>) {
    FileMotion::new(bvh, bvh.n_frames(), &mut Vec::new()).rotations(out);
}

/// Multiplies a joint's rotation channels in file order, four frames at once.
#[inline(always)]
fn local_rotation(channels: &[(usize, usize)], rows: [&[f64]; LANES]) -> QuatLanes {
    let half = |column: usize| half_sin_cos_of_degrees(f64x4::new(rows.map(|row| row[column])));
    match channels {
        [] => QuatLanes::splat(DQuat::IDENTITY),
        [(axis, column)] => QuatLanes::about(*axis, half(*column)),
        [(a, column_a), (b, column_b), rest @ ..] => {
            let first = QuatLanes::about_two(*a, half(*column_a), *b, half(*column_b));
            rest.iter().fold(first, |q, &(axis, column)| q.turned(axis, half(column)))
        }
    }
}

fn skeleton(bvh: &Bvh, warnings: &mut Vec<String>) -> Skeleton {
    let mut n_bad = 0;
    let mut offset = |offset: [f64; 3]| {
        let v = DVec3::from_array(offset);
        let ok = v.abs().max_element() <= LARGEST;
        n_bad += usize::from(!ok);
        if ok { v } else { DVec3::ZERO }
    };
    let joints = (bvh.joints().iter())
        .map(|j| Joint {
            name: j.name.clone(),
            parent: j.parent.map(|p| JointId(p as u32)),
            offset: offset(j.offset),
            end_site: j.end_site.map(&mut offset),
        })
        .collect();
    if n_bad > 0 {
        warnings.push(format!("{n_bad} OFFSETs hold values that are no numbers; read as 0 0 0"));
    }
    Skeleton::new(joints)
}

/// Replaces what is not a number by the frame before, 0 in the first frame, and takes whole turns off far angles.
fn finite(
    values: Arc<Vec<f64>>,
    n_channels: usize,
    channels: &[JointChannels],
    warnings: &mut Vec<String>,
) -> Arc<Vec<f64>> {
    // Counted rather than searched for, which takes several values at a time.
    let n_near = values.iter().filter(|v| v.abs() <= FARTHEST_DEGREES).count();
    if n_near == values.len() {
        return values;
    }
    let mut values = values.as_ref().clone();
    let mut n_bad = 0;
    for at in 0..values.len() {
        let is_number = values[at].abs() <= LARGEST;
        if !is_number {
            values[at] = if at < n_channels { 0.0 } else { values[at - n_channels] };
            n_bad += 1;
        }
    }
    if n_bad > 0 {
        warnings.push(format!("{n_bad} channel values are no numbers; the frame before stands in for them"));
    }
    let turning: Vec<usize> = channels.iter().flat_map(|c| &c.rotations).map(|&(_, column)| column).collect();
    for row in values.chunks_exact_mut(n_channels) {
        for &column in &turning {
            if row[column].abs() > FARTHEST_DEGREES {
                row[column] %= 360.0;
            }
        }
    }
    Arc::new(values)
}
