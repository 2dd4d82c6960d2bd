//! Edited clip → BVH: the source's characters, but for the channels of the carrier where it moved and of the joints
//! that turn otherwise.
//!
//! Values are written in the meaning they were read in (OFFSET replaced or added to), in the file's axes, in the
//! joint's own rotation order and on the branch of angles that continues the frame before.

use std::{borrow::Cow, ops::Range};

use glam::{DQuat, DVec3};

use super::{
    Clip, EditedClip, Length, OffsetMeaning, TurnedJoint, UpAxis, carrier_relative, channels::JointChannels,
    euler::nearest_degrees, from_bvh::DEFAULT_FRAME_TIME_SECS,
};
use crate::{
    bvh::{Bvh, Digits, RowEdit},
    math::Rigid,
    skeleton::JointId,
};

/// No joint moves by more than this share of the body height when the written file is read again.
const ACCURACY: f64 = 1e-6;

/// Writes an edited clip as BVH: the rest frames as they were, then every edited frame.
///
/// `bvh` is the file the clip was read from. Without an edit the result is the file, byte for byte.
///
/// A stationary clip whose length nobody chose is written as one frame while it still stands still, wherever that is;
/// without an edit it is the file, too. A chosen length is always written. A file without channels comes back as it is.
///
/// # Panics
///
/// When the clip was not read from `bvh`, or its carrier is moved although its path cannot be edited, or a joint is
/// turned that has not one rotation channel about each axis.
pub fn to_bvh(bvh: &Bvh, edited: &EditedClip) -> Vec<u8> {
    let Some(with_rows) = with_rows(bvh) else { return bvh.text().to_vec() };
    let written = Written::new(&with_rows, edited);
    let n_frames = written.n_needed(edited.clip.length, bvh.n_frames());
    if n_frames == 0 {
        return bvh.text().to_vec();
    }
    let rows: Vec<RowEdit> = (0..n_frames)
        .map(|frame| RowEdit { source_row: written.rows[frame].0, changed: written.changes(frame) })
        .collect();
    with_rows.write_rows(&rows, written.digits)
}

/// Returns the number of frames that [`to_bvh`] writes, rest frames counted. As costly where the clip is stationary.
///
/// # Panics
///
/// As [`to_bvh`] does.
pub fn n_written_frames(bvh: &Bvh, edited: &EditedClip) -> usize {
    let n_frames = edited.clip.rest_frames() + edited.n_frames();
    if edited.clip.length == Length::Own {
        return n_frames;
    }
    with_rows(bvh).map_or(0, |with_rows| Written::new(&with_rows, edited).n_needed(edited.clip.length, bvh.n_frames()))
}

/// Returns the file, or the file with a row of zeros where it has no row; none where it cannot have one.
fn with_rows(bvh: &Bvh) -> Option<Cow<'_, Bvh>> {
    if bvh.n_frames() > 0 {
        return Some(Cow::Borrowed(bvh));
    }
    bvh.with_row_of_zeros(DEFAULT_FRAME_TIME_SECS).map(Cow::Owned)
}

/// What is written: rows of the file, each with the values that are new.
struct Written {
    /// The file's row, and which of the changes are made to it.
    rows: Vec<(usize, Range<usize>)>,
    /// Channels and their new values.
    changes: Vec<(usize, f64)>,
    digits: Digits,
}

impl Written {
    fn new(bvh: &Bvh, edited: &EditedClip) -> Self {
        let clip = &*edited.clip;
        let n_rows = if clip.length == Length::Own { clip.n_file_frames() } else { 1 };
        assert_eq!(bvh.n_frames(), n_rows, "the clip was read from this file");
        // The one row of a stationary clip stands for all of its frames.
        let row_of = |file_frame: usize| file_frame.min(n_rows - 1);
        let mut changes: Vec<(usize, f64)> = Vec::new();
        let mut rows: Vec<(usize, Range<usize>)> = (0..clip.rest_frames()).map(|frame| (row_of(frame), 0..0)).collect();
        let is_edited = !edited.carrier_world.is_empty() || !edited.turned.is_empty();
        let digits = if is_edited { digits(edited) } else { Digits { position_decimals: 6, rotation_decimals: 6 } };
        let mut carrier = (!edited.carrier_world.is_empty()).then(|| CarrierWriter::new(bvh, clip, digits));
        let mut turned: Vec<_> =
            edited.turned.iter().map(|t| (RotationWriter::new(bvh, clip, t.joint, digits), &t.rotations)).collect();
        for frame in 0..edited.n_frames() {
            let source_frame = edited.source_frame(frame);
            let source_row = row_of(clip.file_frame(source_frame));
            let first = changes.len();
            if let Some(writer) = &mut carrier {
                writer.write(bvh.frame(source_row), source_frame, edited.carrier_local(frame), &mut changes);
            }
            for (writer, rotations) in &mut turned {
                writer.write(bvh.frame(source_row), source_frame, rotations[frame], &mut changes);
            }
            changes[first..].sort_unstable_by_key(|&(column, _)| column);
            rows.push((source_row, first..changes.len()));
        }
        Self { rows, changes, digits }
    }

    /// Returns the channels of a frame that are new, with their values.
    fn changes(&self, frame: usize) -> &[(usize, f64)] {
        &self.changes[self.rows[frame].1.clone()]
    }

    /// Returns how many of the frames have to be written so that a file of so many says it all.
    fn n_needed(&self, length: Length, n_file_frames: usize) -> usize {
        if length != Length::Default {
            self.rows.len()
        } else if self.changes.is_empty() {
            n_file_frames
        } else if (1..self.rows.len()).all(|frame| self.is_first_again(frame)) {
            1
        } else {
            self.rows.len()
        }
    }

    /// Tells whether a frame differs from the first by less than can be written.
    fn is_first_again(&self, frame: usize) -> bool {
        let unseen = half_a_digit(self.digits.position_decimals.max(self.digits.rotation_decimals));
        let (first, again) = (self.changes(0), self.changes(frame));
        let is_same = |(a, b): (&(usize, f64), &(usize, f64))| a.0 == b.0 && (a.1 - b.1).abs() <= unseen;
        first.len() == again.len() && first.iter().zip(again).all(is_same)
    }
}

/// Turns the carrier's local transforms into its channels, frame after frame.
struct CarrierWriter<'a> {
    rotation: RotationWriter<'a>,
    /// Added to the position channels on reading.
    base: DVec3,
}

impl<'a> CarrierWriter<'a> {
    fn new(bvh: &Bvh, clip: &'a Clip, digits: Digits) -> Self {
        assert!(clip.facts.path_editable, "only a carrier with six channels is moved");
        let rotation = RotationWriter::new(bvh, clip, clip.facts.carrier.value, digits);
        let joint = clip.skeleton.joint(rotation.joint);
        let meaning = if joint.parent.is_none() { &clip.facts.root_offset } else { &clip.facts.joint_offsets };
        let base = match meaning.value {
            OffsetMeaning::Replace => DVec3::ZERO,
            OffsetMeaning::Add => rotation.up.to_file(joint.offset),
        };
        Self { rotation, base }
    }

    /// Appends the channels of one frame that differ from the source row.
    fn write(&mut self, row: &[f64], source_frame: usize, local: Rigid, changes: &mut Vec<(usize, f64)>) {
        let position = self.rotation.up.to_file(local.translation) - self.base;
        let unseen = half_a_digit(self.rotation.digits.position_decimals);
        for (axis, column) in self.rotation.channels.positions.iter().enumerate() {
            let column = column.expect("the carrier has three position channels");
            // What is no number in the source is never within a digit, so it is written anew.
            let is_kept = (position[axis] - row[column]).abs() <= unseen;
            if !is_kept {
                changes.push((column, position[axis]));
            }
        }
        self.rotation.write(row, source_frame, local.rotation, changes);
    }
}

/// Turns a joint's local rotations into its channels, frame after frame.
struct RotationWriter<'a> {
    clip: &'a Clip,
    joint: JointId,
    channels: JointChannels,
    /// Axes of the three rotation channels, in file order.
    axes: [usize; 3],
    /// Up axis to undo: the file's for a root, none below.
    up: UpAxis,
    digits: Digits,
    /// Rotation channels of the frame written last.
    last_degrees: Option<[f64; 3]>,
}

impl<'a> RotationWriter<'a> {
    fn new(bvh: &Bvh, clip: &'a Clip, id: JointId, digits: Digits) -> Self {
        assert!(clip.turns_freely(id.idx()), "only a joint with a channel about each axis is turned");
        let joint = &bvh.joints()[id.idx()];
        let channels = JointChannels::new(&joint.channels, joint.first_channel);
        let axes = std::array::from_fn(|i| channels.rotations[i].0);
        let up = if joint.parent.is_none() { clip.facts.up.value } else { UpAxis::Y };
        Self { clip, joint: id, channels, axes, up, digits, last_degrees: None }
    }

    /// Appends the channels of one frame that differ from the source row.
    fn write(&mut self, row: &[f64], source_frame: usize, rotation: DQuat, changes: &mut Vec<(usize, f64)>) {
        let source = self.clip.rotations(source_frame)[self.joint.idx()];
        let columns: [usize; 3] = std::array::from_fn(|i| self.channels.rotations[i].1);
        let source_degrees = columns.map(|column| row[column]);
        let unseen = half_a_digit(self.digits.rotation_decimals);
        let is_source = angle_between(source, rotation).to_degrees() <= unseen;
        if is_source && source_degrees.iter().all(|d| d.is_finite()) {
            self.last_degrees = Some(source_degrees);
            return;
        }
        let near = self.last_degrees.unwrap_or(source_degrees).map(|d| if d.is_finite() { d } else { 0.0 });
        let degrees = nearest_degrees(self.axes, self.up.world_rotation().conjugate() * rotation, near);
        for ((column, value), source) in columns.into_iter().zip(degrees).zip(source_degrees) {
            let is_kept = (value - source).abs() <= unseen;
            if !is_kept {
                changes.push((column, value));
            }
        }
        self.last_degrees = Some(degrees);
    }
}

/// Returns how many decimals keep every joint within [`ACCURACY`].
///
/// A third of it is for positions and a third for rotations; a channel that keeps its source characters because it
/// changed by less than half a digit is off as much as one that is rounded, so it is within the same bounds. Joints that
/// turn above one another add up.
fn digits(edited: &EditedClip) -> Digits {
    let clip = &*edited.clip;
    let share = ACCURACY * clip.facts.height.value / 3.0;
    let relative = carrier_relative(clip).tracks;
    let reach = (0..relative.n_points())
        .flat_map(|point| relative.x(point).iter().zip(relative.y(point)).zip(relative.z(point)))
        .map(|((x, y), z)| x * x + y * y + z * z)
        .fold(0.0, f64::max)
        .sqrt();
    // The three axes together are off by √3 times half a digit, the three angles by 3 times half a digit at most.
    let position = share / (3f64.sqrt() / 2.0);
    let rotation = (share / reach.max(share) / 1.5 / longest_turned_chain(edited) as f64).to_degrees();
    Digits { position_decimals: decimals(position), rotation_decimals: decimals(rotation) }
}

/// Returns how many written joints lie on the way from the carrier to any joint, the carrier counted.
fn longest_turned_chain(edited: &EditedClip) -> usize {
    let skeleton = &edited.clip.skeleton;
    let above = |turned: &TurnedJoint| {
        edited.turned.iter().filter(|other| skeleton.is_within(turned.joint, other.joint)).count()
    };
    1 + edited.turned.iter().map(above).max().unwrap_or(0)
}

/// Returns the decimals whose last digit is worth no more than `size`.
fn decimals(size: f64) -> usize {
    // f64 has no more to give, whatever the body's size.
    const MOST: f64 = 17.0;
    (-size.log10()).ceil().clamp(0.0, MOST) as usize
}

fn half_a_digit(decimals: usize) -> f64 {
    0.5 * 10f64.powi(-(decimals as i32))
}

/// Returns the angle of the rotation from one orientation to the other, radians; exact for small angles too.
fn angle_between(a: DQuat, b: DQuat) -> f64 {
    let turn = a.conjugate() * b;
    2.0 * turn.xyz().length().atan2(turn.w.abs())
}
