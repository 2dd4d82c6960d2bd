//! Edited clip → BVH: the source's characters, but for the channels of the carrier where it moved and of the joints
//! that turn otherwise.
//!
//! Values are written in the meaning they were read in (OFFSET replaced or added to), in the file's axes, in the
//! joint's own rotation order and on a branch of angles that goes on from frame to frame: where the source's characters
//! come back, the branch on which the difference from them goes on, so that angles meet theirs as they come back.

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
        let sources: Vec<Source> = (0..edited.n_frames())
            .map(|frame| {
                let frame = edited.source_frame(frame);
                let row_idx = row_of(clip.file_frame(frame));
                Source { frame, row_idx, row: bvh.frame(row_idx) }
            })
            .collect();
        let carrier = (!edited.carrier_world.is_empty()).then(|| CarrierWriter::new(bvh, edited, digits, &sources));
        let turned: Vec<Angles> = (edited.turned.iter())
            .map(|t| Angles::new(bvh, clip, t.joint, digits, &sources, |frame| t.rotations[frame]))
            .collect();
        for (frame, source) in sources.iter().enumerate() {
            let first = changes.len();
            if let Some(carrier) = &carrier {
                carrier.write(source.row, frame, edited.carrier_local(frame), &mut changes);
            }
            turned.iter().for_each(|angles| angles.write(source.row, frame, &mut changes));
            changes[first..].sort_unstable_by_key(|&(column, _)| column);
            rows.push((source.row_idx, first..changes.len()));
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

/// What an edited frame is written over.
struct Source<'a> {
    /// The clip's frame.
    frame: usize,
    /// The file's row.
    row_idx: usize,
    row: &'a [f64],
}

/// The carrier's local transforms as its channels.
struct CarrierWriter {
    angles: Angles,
    positions: [usize; 3],
    up: UpAxis,
    /// Added to the position channels on reading.
    base: DVec3,
    digits: Digits,
}

impl CarrierWriter {
    fn new(bvh: &Bvh, edited: &EditedClip, digits: Digits, sources: &[Source]) -> Self {
        let clip = &*edited.clip;
        assert!(clip.facts.path_editable, "only a carrier with six channels is moved");
        let id = clip.facts.carrier.value;
        let (joint, own) = (clip.skeleton.joint(id), &bvh.joints()[id.idx()]);
        let up = file_up(clip, id);
        let meaning = if joint.parent.is_none() { &clip.facts.root_offset } else { &clip.facts.joint_offsets };
        let base = match meaning.value {
            OffsetMeaning::Replace => DVec3::ZERO,
            OffsetMeaning::Add => up.to_file(joint.offset),
        };
        let positions = JointChannels::new(&own.channels, own.first_channel).positions;
        Self {
            angles: Angles::new(bvh, clip, id, digits, sources, |frame| edited.carrier_local(frame).rotation),
            positions: positions.map(|column| column.expect("the carrier has three position channels")),
            up,
            base,
            digits,
        }
    }

    /// Appends the channels of one frame that differ from the source row.
    fn write(&self, row: &[f64], frame: usize, local: Rigid, changes: &mut Vec<(usize, f64)>) {
        let position = self.up.to_file(local.translation) - self.base;
        append(row, self.positions, position.to_array(), self.digits.position_decimals, changes);
        self.angles.write(row, frame, changes);
    }
}

/// A joint's local rotations as its channels.
struct Angles {
    columns: [usize; 3],
    /// Degrees at each edited frame; none where the source's characters stay.
    degrees: Vec<Option<[f64; 3]>>,
    decimals: usize,
}

impl Angles {
    fn new(
        bvh: &Bvh,
        clip: &Clip,
        id: JointId,
        digits: Digits,
        sources: &[Source],
        rotation: impl Fn(usize) -> DQuat,
    ) -> Self {
        assert!(clip.turns_freely(id.idx()), "only a joint with a channel about each axis is turned");
        let joint = &bvh.joints()[id.idx()];
        let channels = JointChannels::new(&joint.channels, joint.first_channel).rotations;
        let (axes, columns) = (std::array::from_fn(|i| channels[i].0), std::array::from_fn(|i| channels[i].1));
        let to_file = file_up(clip, id).world_rotation().conjugate();
        let decimals = digits.rotation_decimals;
        let is_kept = |(frame, source): (usize, &Source)| {
            let turned = angle_between(clip.rotations(source.frame)[id.idx()], rotation(frame));
            turned.to_degrees() <= half_a_digit(decimals)
                && columns.iter().all(|&column| source.row[column].is_finite())
        };
        let kept: Vec<bool> = sources.iter().enumerate().map(is_kept).collect();
        let own = |frame: usize| {
            columns.map(|column| Some(sources[frame].row[column]).filter(|d| d.is_finite()).unwrap_or(0.0))
        };
        let mut degrees: Vec<Option<[f64; 3]>> = vec![None; sources.len()];
        let mut end = 0;
        for run in kept.chunk_by(|a, b| a == b) {
            let start = end;
            end += run.len();
            if run[0] {
                continue;
            }
            // The source's angles are met at this run's end: so they are, but for their own leaps, if the difference from
            // them goes on; from whichever end there is one to go on from.
            let is_met = end < sources.len();
            let is_backward = is_met && start == 0;
            for n in 0..run.len() {
                let frame = if is_backward { end - 1 - n } else { start + n };
                let beside = if is_backward { Some(frame + 1) } else { frame.checked_sub(1) };
                let near = beside.map_or_else(
                    || own(frame),
                    |beside| {
                        let at = degrees[beside].unwrap_or_else(|| own(beside));
                        let goes_on = is_met && sources[frame].frame.abs_diff(sources[beside].frame) == 1;
                        let (is, was) = (own(frame), own(beside));
                        std::array::from_fn(|i| if goes_on { at[i] + (is[i] - was[i]) } else { at[i] })
                    },
                );
                degrees[frame] = Some(nearest_degrees(axes, to_file * rotation(frame), near));
            }
        }
        Self { columns, degrees, decimals }
    }

    /// Appends the channels of one frame that differ from the source row.
    fn write(&self, row: &[f64], frame: usize, changes: &mut Vec<(usize, f64)>) {
        if let Some(degrees) = self.degrees[frame] {
            append(row, self.columns, degrees, self.decimals, changes);
        }
    }
}

/// Appends the values that differ from those of a row by more than can be written. What is no number there always does.
fn append(row: &[f64], columns: [usize; 3], values: [f64; 3], decimals: usize, changes: &mut Vec<(usize, f64)>) {
    let unseen = half_a_digit(decimals);
    for (column, value) in columns.into_iter().zip(values) {
        let is_kept = (value - row[column]).abs() <= unseen;
        if !is_kept {
            changes.push((column, value));
        }
    }
}

/// Returns the up axis that a joint's channels are in: the file's for a root, none below.
fn file_up(clip: &Clip, id: JointId) -> UpAxis {
    if clip.skeleton.joint(id).parent.is_none() { clip.facts.up.value } else { UpAxis::Y }
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
