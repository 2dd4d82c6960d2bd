//! Where an edit puts the body: in pieces, each of which moves as one rigid body away from where it is in the source.
//!
//! The first piece is the carrier's subtree. Every joint that turns otherwise than in the source begins a piece of its
//! own, which ends where the next one begins. So an edit is measured from source positions that are computed once,
//! without going through the skeleton again. Moves are made for a stretch of frames at a time, four frames at once, and
//! never kept.

use std::ops::Range;

use glam::DQuat;
use wide::f64x4;

use super::Body;
use crate::{
    math::{
        Rigid,
        lanes::{LANES, QuatLanes, VecLanes},
    },
    motion::{Clip, EditedClip, PointTracks},
    skeleton::{JointId, Skeleton},
};

/// Frames in a stretch; a multiple of four.
pub(super) const STRETCH: usize = 128;

/// A move is upright when x and z of its quaternion are below this: then no joint is off by more than 1e-10 body
/// heights.
const UPRIGHT: f64 = 1e-11;

/// One value per frame of a stretch.
pub(super) type Column = [f64; STRETCH];

/// Joints that an edit may turn, with what that takes of the source.
#[derive(Clone, Debug)]
pub struct Turning {
    /// Parents first.
    joints: Vec<TurningJoint>,
    /// Of the points that follow the carrier whatever these joints do.
    extents: Extents,
}

/// A joint that may turn, at each source frame.
#[derive(Clone, Debug)]
struct TurningJoint {
    joint: JointId,
    /// World rotation of its parent.
    parent: Vec<DQuat>,
    /// Inverse of its own world rotation.
    undone: Vec<DQuat>,
}

/// How low and how high some points are in the source.
#[derive(Clone, Debug)]
pub(super) struct Extents {
    /// Which points.
    pub(super) of: Vec<bool>,
    /// Lowest of them at each frame; infinite without any.
    pub(super) low: Vec<f64>,
    /// Highest of them at each frame; infinitely low without any.
    pub(super) high: Vec<f64>,
}

/// A body where an edit has it.
pub(super) struct Placed<'a> {
    /// Source frame of each edited frame.
    pub(super) source_frames: &'a [u32],
    /// Piece that each point is part of; none for one that stays.
    pub(super) piece_of: Vec<Option<usize>>,
    /// Where the carrier is; none where it is as in the source.
    carriers: Option<&'a [Rigid]>,
    /// Where each piece after the first hangs.
    hinges: Vec<Hinge<'a>>,
    /// Of points that are part of the first piece.
    pub(super) extents: &'a Extents,
}

/// A joint at which one piece hangs on another.
struct Hinge<'a> {
    joint: usize,
    /// The piece it hangs on.
    above: usize,
    /// The joint's parent is the one that the piece above begins with.
    is_next: bool,
    /// Local rotation at each edited frame.
    rotations: &'a [DQuat],
    source: &'a TurningJoint,
}

/// Moves of a piece over a stretch.
pub(super) struct Moves {
    pub(super) rotation: [Column; 4],
    pub(super) translation: [Column; 3],
    /// World rotation of the joint that the piece begins with; not for the first piece.
    joint: [Column; 4],
    /// All of them are turns about up and shifts.
    pub(super) upright: bool,
}

impl Turning {
    /// Prepares joints of a clip; a pass over its frames for each. No root is among them.
    pub fn of(clip: &Clip, body: &Body, joints: impl IntoIterator<Item = JointId>) -> Self {
        let mut joints: Vec<JointId> = joints.into_iter().collect();
        joints.sort_unstable_by_key(|joint| joint.idx());
        joints.dedup();
        let turns_along = below(&clip.skeleton, &joints);
        let still = body.follows.iter().zip(&turns_along).map(|(follows, turns)| *follows && !turns).collect();
        let turning = joints.into_iter().map(|joint| {
            let parent = clip.skeleton.joint(joint).parent.expect("no root");
            let parent: Vec<DQuat> = clip.joint_track(parent).iter().map(|rigid| rigid.rotation).collect();
            let own = parent.iter().enumerate().map(|(f, &above)| above * clip.rotations(f)[joint.idx()]);
            TurningJoint { joint, undone: own.map(|rotation| rotation.conjugate()).collect(), parent }
        });
        Self { joints: turning.collect(), extents: Extents::new(&body.tracks, still) }
    }

    /// Returns the joints, in the skeleton's order.
    pub fn joints(&self) -> impl Iterator<Item = JointId> + '_ {
        self.joints.iter().map(|turning| turning.joint)
    }

    fn joint(&self, joint: JointId) -> &TurningJoint {
        let at = self.joints.binary_search_by_key(&joint.idx(), |turning| turning.joint.idx());
        &self.joints[at.expect("every turned joint is prepared")]
    }
}

/// Tells of each point whether it moves when one of these joints turns.
fn below(skeleton: &Skeleton, joints: &[JointId]) -> Vec<bool> {
    let mut turns: Vec<bool> = Vec::with_capacity(skeleton.n_joints());
    let mut moves = Vec::new();
    for (idx, joint) in skeleton.joints().iter().enumerate() {
        let above = joint.parent.is_some_and(|parent| turns[parent.idx()]);
        moves.push(above);
        turns.push(above || joints.iter().any(|joint| joint.idx() == idx));
    }
    moves.extend(skeleton.end_sites().iter().map(|joint| turns[joint.idx()]));
    moves
}

impl Extents {
    pub(super) fn new(tracks: &PointTracks, of: Vec<bool>) -> Self {
        let (mut low, mut high) = (vec![f64::INFINITY; tracks.n_frames()], vec![f64::NEG_INFINITY; tracks.n_frames()]);
        for point in (0..of.len()).filter(|&point| of[point]) {
            note(&mut low, &mut high, tracks.y(point));
        }
        Self { of, low, high }
    }
}

/// Takes heights of a point into the lowest and highest ones.
pub(super) fn note(low: &mut [f64], high: &mut [f64], y: &[f64]) {
    for ((low, high), y) in low.iter_mut().zip(high).zip(y) {
        *low = if *y < *low { *y } else { *low };
        *high = if *y > *high { *y } else { *high };
    }
}

impl<'a> Placed<'a> {
    /// Leaves a body where it is in the source.
    pub(super) fn as_it_was(body: &'a Body, frames: &'a [u32]) -> Self {
        let piece_of = vec![None; body.follows.len()];
        Self { source_frames: frames, piece_of, carriers: None, hinges: Vec::new(), extents: &body.extents }
    }

    /// Puts a body where an edit of its clip has it. `turning` has every joint that the edit turns.
    ///
    /// # Panics
    ///
    /// When it has not.
    pub(super) fn new(body: &'a Body, edited: &'a EditedClip, turning: &'a Turning) -> Self {
        let skeleton = &edited.clip.skeleton;
        // Piece that turns with a joint, and the one that its place belongs to.
        let mut piece_of_joint: Vec<Option<usize>> = Vec::with_capacity(skeleton.n_joints());
        let mut piece_of = Vec::with_capacity(body.follows.len());
        let mut hinges: Vec<Hinge> = Vec::with_capacity(edited.turned.len());
        for (idx, joint) in skeleton.joints().iter().enumerate() {
            let above = joint.parent.and_then(|parent| piece_of_joint[parent.idx()]);
            let place = if body.follows[idx] { above.or(Some(0)) } else { None };
            piece_of.push(place);
            let turned = edited.turned.iter().find(|turned| turned.joint.idx() == idx);
            piece_of_joint.push(match (place, turned) {
                (Some(above), Some(turned)) => {
                    let begins = above.checked_sub(1).map(|hinge| hinges[hinge].joint);
                    hinges.push(Hinge {
                        joint: idx,
                        above,
                        is_next: begins.is_some() && begins == joint.parent.map(JointId::idx),
                        rotations: &turned.rotations,
                        source: turning.joint(turned.joint),
                    });
                    Some(hinges.len())
                }
                _ => place,
            });
        }
        piece_of.extend(skeleton.end_sites().iter().map(|joint| piece_of_joint[joint.idx()]));
        let carriers = (!edited.carrier_world.is_empty()).then_some(&edited.carrier_world[..]);
        let extents = if hinges.is_empty() { &body.extents } else { &turning.extents };
        Self { source_frames: &edited.source_frames, piece_of, carriers, hinges, extents }
    }

    /// Returns room for the moves of all pieces.
    pub(super) fn no_moves(&self) -> Vec<Moves> {
        (0..=self.hinges.len()).map(|_| Moves::NONE).collect()
    }

    /// Fills in the moves of all pieces over a stretch of edited frames, the carrier's piece first.
    pub(super) fn moves(&self, body: &Body, stretch: Range<usize>, out: &mut [Moves]) {
        let frames = &self.source_frames[stretch.clone()];
        let last = frames.len() - 1;
        if let Some(carriers) = self.carriers {
            let carriers = &carriers[stretch.clone()];
            for at in (0..frames.len()).step_by(LANES) {
                let to = |lane: usize| &carriers[(at + lane).min(last)];
                let from = |lane: usize| &body.to_origin[frames[(at + lane).min(last)] as usize];
                let turn = QuatLanes::gather(|lane| to(lane).rotation);
                let shift = VecLanes::gather(|lane| to(lane).translation);
                let rotation = turn.times(QuatLanes::gather(|lane| from(lane).rotation));
                let translation = turn.rotate(VecLanes::gather(|lane| from(lane).translation)).plus(shift);
                out[0].set(at, rotation, translation);
            }
        }
        out[0].find_upright(frames.len());
        for (idx, hinge) in self.hinges.iter().enumerate() {
            let (before, piece) = out.split_at_mut(idx + 1);
            piece[0].hang(hinge, &before[hinge.above], body, frames, stretch.start);
        }
    }
}

impl Moves {
    /// Move nothing.
    const NONE: Self = Self {
        rotation: [[0.0; STRETCH], [0.0; STRETCH], [0.0; STRETCH], [1.0; STRETCH]],
        translation: [[0.0; STRETCH]; 3],
        joint: [[0.0; STRETCH]; 4],
        upright: true,
    };

    /// Makes the moves of a piece that hangs on another.
    fn hang(&mut self, hinge: &Hinge, above: &Self, body: &Body, frames: &[u32], first: usize) {
        let last = frames.len() - 1;
        let rotations = &hinge.rotations[first..first + frames.len()];
        for at in (0..frames.len()).step_by(LANES) {
            let frame = |lane: usize| frames[(at + lane).min(last)] as usize;
            let above_turn = quats(&above.rotation, at);
            let parent = match hinge.is_next {
                true => quats(&above.joint, at),
                false => above_turn.times(QuatLanes::gather(|lane| hinge.source.parent[frame(lane)])),
            };
            let joint = parent.times(QuatLanes::gather(|lane| rotations[(at + lane).min(last)]));
            let rotation = joint.times(QuatLanes::gather(|lane| hinge.source.undone[frame(lane)]));
            let pivot = VecLanes::gather(|lane| body.tracks.position(hinge.joint, frame(lane)));
            let pivot_now = above_turn.rotate(pivot).plus(vectors(&above.translation, at));
            self.set(at, rotation, pivot_now.minus(rotation.rotate(pivot)));
            for (column, lanes) in self.joint.iter_mut().zip([joint.x, joint.y, joint.z, joint.w]) {
                column[at..at + LANES].copy_from_slice(&lanes.to_array());
            }
        }
        self.find_upright(frames.len());
    }

    fn set(&mut self, at: usize, rotation: QuatLanes, translation: VecLanes) {
        let QuatLanes { x, y, z, w } = rotation;
        for (column, lanes) in self.rotation.iter_mut().zip([x, y, z, w]) {
            column[at..at + LANES].copy_from_slice(&lanes.to_array());
        }
        let VecLanes { x, y, z } = translation;
        for (column, lanes) in self.translation.iter_mut().zip([x, y, z]) {
            column[at..at + LANES].copy_from_slice(&lanes.to_array());
        }
    }

    fn find_upright(&mut self, n: usize) {
        let [x, _, z, _] = &self.rotation;
        self.upright = x[..n].iter().zip(z).all(|(x, z)| x.abs().max(z.abs()) < UPRIGHT);
    }
}

/// Takes four values out of a column.
#[inline(always)]
pub(super) fn lanes(column: &Column, at: usize) -> f64x4 {
    f64x4::new(column[at..at + LANES].try_into().expect("four lanes"))
}

#[inline(always)]
pub(super) fn quats(columns: &[Column; 4], at: usize) -> QuatLanes {
    let [x, y, z, w] = columns.each_ref().map(|column| lanes(column, at));
    QuatLanes { x, y, z, w }
}

#[inline(always)]
fn vectors(columns: &[Column; 3], at: usize) -> VecLanes {
    let [x, y, z] = columns.each_ref().map(|column| lanes(column, at));
    VecLanes { x, y, z }
}
