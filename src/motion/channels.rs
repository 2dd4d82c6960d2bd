//! Rows of channels → local transforms, in the file's own axes.
//!
//! Local transform = translation · the channels' rotations in file order (METHOD 1). What a position channel does to
//! OFFSET is not decided here: the caller names a meaning for the roots and one for the other joints.

use std::borrow::Cow;

use glam::{DQuat, DVec3};
use wide::f64x4;

use super::{
    OffsetMeaning,
    lanes::{LANES, QuatLanes, half_sin_cos_of_degrees},
    poses::Poses,
};
use crate::{
    bvh::{Bvh, Channel},
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
        let mut axes: Vec<usize> = self.rotations.iter().map(|&(axis, _)| axis).collect();
        axes.sort_unstable();
        axes == [0, 1, 2] && self.positions.iter().all(Option::is_some)
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
pub(super) struct FileMotion<'a> {
    pub(super) skeleton: Skeleton,
    pub(super) channels: Vec<JointChannels>,
    pub(super) n_frames: usize,
    n_channels: usize,
    /// Frames × channels.
    values: Cow<'a, [f64]>,
}

impl<'a> FileMotion<'a> {
    /// Reads the file's numbers; those that are none are replaced, with a warning.
    pub(super) fn new(bvh: &'a Bvh, warnings: &mut Vec<String>) -> Self {
        let channels = bvh.joints().iter().map(|j| JointChannels::new(&j.channels, j.first_channel)).collect();
        let skeleton = skeleton(bvh, warnings);
        let values = finite(bvh.values(), bvh.n_channels(), warnings);
        Self { skeleton, channels, n_frames: bvh.n_frames(), n_channels: bvh.n_channels(), values }
    }

    /// Returns a joint's channel values over the frames, one column.
    pub(super) fn column(&self, column: usize) -> impl Iterator<Item = f64> + '_ {
        self.values.iter().copied().skip(column).step_by(self.n_channels.max(1))
    }

    /// Returns the position channels' values of a joint at a frame; 0 on an axis without channel.
    pub(super) fn position(&self, frame: usize, joint: usize) -> DVec3 {
        let row = &self.values[frame * self.n_channels..][..self.n_channels];
        let positions = self.channels[joint].positions;
        DVec3::from_array(std::array::from_fn(|axis| positions[axis].map_or(0.0, |column| row[column])))
    }

    /// Computes the local transforms of all frames; a file without frames gives one, in rest pose.
    pub(super) fn poses(&self, root: OffsetMeaning, joints: OffsetMeaning) -> Poses {
        let n_joints = self.skeleton.n_joints();
        let offsets: Vec<DVec3> = self.skeleton.joints().iter().map(|j| j.offset).collect();
        if self.n_frames == 0 {
            return Poses {
                n_joints,
                n_frames: 1,
                rotations: vec![DQuat::IDENTITY; n_joints],
                columns: vec![None; n_joints],
                fixed: offsets,
                n_columns: 0,
                translations: Vec::new(),
            };
        }
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
        Poses {
            n_joints,
            n_frames: self.n_frames,
            rotations: self.rotations(),
            columns,
            fixed: offsets,
            n_columns: moving.len(),
            translations,
        }
    }

    /// Computes the local rotations, frames × joints.
    fn rotations(&self) -> Vec<DQuat> {
        let n_joints = self.skeleton.n_joints();
        let mut rotations = vec![DQuat::IDENTITY; self.n_frames * n_joints];
        for group in (0..self.n_frames).step_by(LANES) {
            let rows: [&[f64]; LANES] = std::array::from_fn(|lane| {
                let frame = (group + lane).min(self.n_frames - 1);
                &self.values[frame * self.n_channels..][..self.n_channels]
            });
            let n_lanes = LANES.min(self.n_frames - group);
            for (joint, channels) in self.channels.iter().enumerate() {
                let lanes = local_rotation(&channels.rotations, rows).lanes();
                for (lane, &rotation) in lanes[..n_lanes].iter().enumerate() {
                    rotations[(group + lane) * n_joints + joint] = rotation;
                }
            }
        }
        rotations
    }
}

/// Multiplies a joint's rotation channels in file order, four frames at once.
#[inline(always)]
fn local_rotation(channels: &[(usize, usize)], rows: [&[f64]; LANES]) -> QuatLanes {
    let half = |column: usize| half_sin_cos_of_degrees(f64x4::new(rows.map(|row| row[column])));
    match channels {
        [] => QuatLanes::splat(DQuat::IDENTITY),
        [(axis, column), rest @ ..] => (rest.iter())
            .fold(QuatLanes::about(*axis, half(*column)), |q, &(axis, column)| q.turned(axis, half(column))),
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

/// Replaces what is not a number by the frame before, 0 in the first frame.
fn finite<'a>(values: &'a [f64], n_channels: usize, warnings: &mut Vec<String>) -> Cow<'a, [f64]> {
    let is_number = |v: f64| v.abs() <= LARGEST;
    let n_bad = values.iter().filter(|&&v| !is_number(v)).count();
    if n_bad == 0 {
        return Cow::Borrowed(values);
    }
    warnings.push(format!("{n_bad} channel values are no numbers; the frame before stands in for them"));
    let mut values = values.to_vec();
    for at in 0..values.len() {
        if !is_number(values[at]) {
            values[at] = if at < n_channels { 0.0 } else { values[at - n_channels] };
        }
    }
    Cow::Owned(values)
}
