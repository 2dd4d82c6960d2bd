//! What a clip's numbers mean, decided from the numbers, each with its reason (METHOD 1).
//!
//! The decisions lean on each other (the carrier on the body height, the height on the up axis, all of them on what
//! position channels do), so they are made in one order: with a provisional carrier first, then once more with the
//! carrier that came out. Everything here is in the file's own axes.

mod carrier;
mod height;
mod offsets;
mod rest;
mod up;

use super::{ClipOptions, OffsetMeaning, UpAxis, channels::FileMotion, kinematics::Walk, poses::Poses};
use crate::skeleton::JointId;

/// A decision about the clip and the reason for it, for people.
#[derive(Clone, Debug, PartialEq)]
pub struct Decided<T> {
    /// What was decided.
    pub value: T,
    /// Why, in one sentence without a period; says `as asked` when the user's option decided.
    pub why: String,
}

impl<T> Decided<T> {
    fn new(value: T, why: impl Into<String>) -> Self {
        Self { value, why: why.into() }
    }

    fn as_asked(value: T) -> Self {
        Self::new(value, "as asked")
    }
}

/// What was found out about a clip (METHOD 1).
#[derive(Clone, Debug, PartialEq)]
pub struct Facts {
    /// The joint whose position channels carry the locomotion.
    pub carrier: Decided<JointId>,
    /// Whether the carrier has three position and three rotation channels; without them the path cannot be edited.
    pub path_editable: bool,
    /// The file's up axis.
    pub up: Decided<UpAxis>,
    /// Meaning of the root's position channels.
    pub root_offset: Decided<OffsetMeaning>,
    /// Meaning of the other joints' position channels.
    pub joint_offsets: Decided<OffsetMeaning>,
    /// Leading rest frames; fewer than the file's frames.
    pub rest_frames: Decided<usize>,
    /// Body height `H` in the clip's unit; positive (1 for a clip without extent).
    pub height: Decided<f64>,
    /// Guessed unit of length: `m`, `cm`, `inch`, `dm`, `CMU 5.6444 cm`, …; none when no guess is near.
    pub unit: Decided<Option<&'static str>>,
    /// Height of the floor under the feet, world, clip's unit (the feet's low percentile).
    pub floor: f64,
}

impl Facts {
    /// Returns the word that stands behind a length in the clip's unit: the unit's, where its guess is a plain one.
    pub fn unit_word(&self) -> &'static str {
        self.unit.value.filter(|unit| !unit.contains(' ')).unwrap_or("units")
    }
}

/// Decides everything and returns the poses read that way, still in the file's axes.
pub(super) fn decide(motion: &FileMotion, options: &ClipOptions, warnings: &mut Vec<String>) -> (Facts, Poses) {
    let asked_carrier = options.carrier.as_ref().and_then(|name| carrier::named(&motion.skeleton, name, warnings));
    let size = height::rest_size(&motion.skeleton);
    let provisional = carrier::first_that_moves(motion, 0, size);
    let carrier = asked_carrier.clone().unwrap_or(provisional);
    let first = Reading::new(motion, options, carrier);
    let settled =
        asked_carrier.unwrap_or_else(|| carrier::first_that_moves(motion, first.rest_frames.value, first.height.value));
    let reading = if settled.value == first.carrier.value {
        Reading { carrier: settled, ..first }
    } else {
        Reading::new(motion, options, settled)
    };
    reading.finish(motion, options, warnings)
}

/// The clip read with one carrier in mind.
struct Reading {
    carrier: Decided<JointId>,
    joint_offsets: Decided<OffsetMeaning>,
    up: Decided<UpAxis>,
    rest_frames: Decided<usize>,
    height: Decided<f64>,
    /// Floor when the root's position channels replace OFFSET.
    floor: f64,
    /// Read with replacing root channels.
    poses: Poses,
}

impl Reading {
    fn new(motion: &FileMotion, options: &ClipOptions, carrier: Decided<JointId>) -> Self {
        let by_bones = match options.joint_offsets {
            Some(meaning) => Some(Decided::as_asked(meaning)),
            None => offsets::by_bones(motion, carrier.value),
        };
        let undecided = Decided::new(OffsetMeaning::Replace, offsets::UNDECIDED);
        let read = |joint_offsets| Self::with_offsets(motion, options, carrier.clone(), joint_offsets);
        // A carrier below the root that is alone with its position channels leaves no bone to judge by.
        let is_alone = by_bones.is_none() && motion.skeleton.joint(carrier.value).parent.is_some();
        let replacing = read(by_bones.unwrap_or(undecided));
        if !is_alone {
            return replacing;
        }
        let adding = read(Decided::new(OffsetMeaning::Add, offsets::UNDECIDED));
        let decided = offsets::by_floor(replacing.floor, adding.floor, replacing.height.value);
        let reading = if decided.value == OffsetMeaning::Add { adding } else { replacing };
        Self { joint_offsets: decided, ..reading }
    }

    fn with_offsets(
        motion: &FileMotion,
        options: &ClipOptions,
        carrier: Decided<JointId>,
        joint_offsets: Decided<OffsetMeaning>,
    ) -> Self {
        let poses = motion.poses(OffsetMeaning::Replace, joint_offsets.value);
        let up = match options.up {
            Some(up) => Decided::as_asked(up),
            None => up::from_pose(&motion.skeleton, &poses),
        };
        let rest_frames = match options.rest_frames {
            Some(n) => Decided::as_asked(n.min(poses.n_frames - 1)),
            None => rest::leading(&motion.skeleton, &poses, carrier.value),
        };
        let extents = height::Extents::along(up.value, &Walk::whole(&motion.skeleton), &poses, rest_frames.value);
        let (height, floor) = (extents.height(), extents.floor());
        Self { carrier, joint_offsets, up, rest_frames, height, floor, poses }
    }

    fn finish(mut self, motion: &FileMotion, options: &ClipOptions, warnings: &mut Vec<String>) -> (Facts, Poses) {
        if let Some(n) = options.rest_frames.filter(|&n| n != self.rest_frames.value) {
            let all = self.poses.n_frames;
            warnings
                .push(format!("{n} rest frames asked for, the file has {all} frames; all but the last are left alone"));
        }
        let root_offset = match options.root_offset {
            Some(meaning) => Decided::as_asked(meaning),
            None => {
                let adding = self.floor + offsets::floor_shift(motion, self.up.value);
                offsets::by_floor(self.floor, adding, self.height.value)
            }
        };
        let mut floor = self.floor;
        if root_offset.value == OffsetMeaning::Add {
            for (joint, added) in offsets::added_to_roots(motion) {
                self.poses.map_translations(joint, |t| t + added);
            }
            floor += offsets::floor_shift(motion, self.up.value);
        }
        let carrier_channels = &motion.channels[self.carrier.value.idx()];
        let path_editable = carrier_channels.moves_freely();
        if !path_editable {
            let name = &motion.skeleton.joint(self.carrier.value).name;
            warnings
                .push(format!("{name} lacks three position and three rotation channels; its path cannot be edited"));
        }
        let unit = height::unit(self.height.value);
        let Self { carrier, joint_offsets, up, rest_frames, height, poses, .. } = self;
        let facts = Facts { carrier, path_editable, up, root_offset, joint_offsets, rest_frames, height, unit, floor };
        (facts, poses)
    }
}
