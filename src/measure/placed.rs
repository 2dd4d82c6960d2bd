//! Where an edit puts the body: in pieces, each of which moves as one rigid body away from where it is in the source.
//!
//! The first piece is the carrier's subtree. Every joint that turns otherwise than in the source begins a piece of its
//! own, which ends where the next one begins. So an edit is measured from source positions that are computed once,
//! without going through the skeleton again.

use std::{ops::Range, panic::resume_unwind, thread};

use glam::DQuat;

use super::Body;
use crate::{
    math::Rigid,
    motion::{Clip, EditedClip, PointTracks, TurnedJoint},
    skeleton::JointId,
};

/// A move is upright when x and z of its quaternion are below this: then no joint is off by more than 1e-10 body
/// heights.
const UPRIGHT: f64 = 1e-11;

/// Fewer frames are not worth another thread.
const WORTH_A_THREAD: usize = 2048;

/// Joints that an edit may turn, with what that takes of the source.
#[derive(Clone, Debug, Default)]
pub struct Turning {
    /// Parents first.
    joints: Vec<TurningJoint>,
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

/// A body where an edit has it.
#[derive(Clone, Debug)]
pub struct Placed<'a> {
    /// Source frame of each edited frame.
    pub(super) source_frames: &'a [u32],
    /// Piece that each point is part of; none for one that stays.
    pub(super) piece_of: Vec<Option<usize>>,
    pub(super) pieces: Vec<Piece>,
}

/// Moves of a piece, one per edited frame.
#[derive(Clone, Debug)]
pub(super) struct Piece {
    pub(super) moves: Vec<Rigid>,
    /// All of them are turns about up and shifts.
    pub(super) upright: bool,
}

/// A joint at which one piece hangs on another.
struct Hinge<'a> {
    /// The piece it hangs on.
    above: usize,
    turned: &'a TurnedJoint,
    source: &'a TurningJoint,
}

/// Does work on frames, on two cores where there are many: `work` gets the first half, and the second half with
/// `overlap` frames before it. Returns what it made, in order. Halves depend on the number of frames alone.
pub(super) fn halves<T: Send>(n_frames: usize, overlap: usize, work: impl Fn(Range<usize>) -> T + Sync) -> Vec<T> {
    if n_frames < WORTH_A_THREAD {
        return vec![work(0..n_frames)];
    }
    let middle = n_frames / 2;
    thread::scope(|scope| {
        let second = scope.spawn(|| work(middle - overlap..n_frames));
        let first = work(0..middle);
        vec![first, second.join().unwrap_or_else(|panic| resume_unwind(panic))]
    })
}

impl Turning {
    /// Prepares joints of a clip; a pass over its frames for each. No root is among them.
    pub fn of(clip: &Clip, joints: impl IntoIterator<Item = JointId>) -> Self {
        let mut joints: Vec<JointId> = joints.into_iter().collect();
        joints.sort_unstable_by_key(|joint| joint.idx());
        joints.dedup();
        let turning = joints.into_iter().map(|joint| {
            let parent = clip.skeleton.joint(joint).parent.expect("no root");
            let parent: Vec<DQuat> = clip.joint_track(parent).iter().map(|rigid| rigid.rotation).collect();
            let own = parent.iter().enumerate().map(|(f, &above)| above * clip.rotations(f)[joint.idx()]);
            TurningJoint { joint, undone: own.map(|rotation| rotation.conjugate()).collect(), parent }
        });
        Self { joints: turning.collect() }
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

impl Piece {
    pub(super) fn new(moves: Vec<Rigid>) -> Self {
        let upright = moves.iter().all(|m| m.rotation.x.abs().max(m.rotation.z.abs()) < UPRIGHT);
        Self { moves, upright }
    }
}

impl Body {
    /// Puts the body where an edit of its clip has it. `turning` has every joint that the edit turns.
    ///
    /// # Panics
    ///
    /// When it has not.
    pub fn placed<'a>(&self, edited: &'a EditedClip, turning: &Turning) -> Placed<'a> {
        let (clip, frames) = (&edited.clip, &edited.source_frames[..]);
        let skeleton = &clip.skeleton;
        // Piece that turns with a joint, and the one that its place belongs to.
        let mut piece_of_joint: Vec<Option<usize>> = Vec::with_capacity(skeleton.n_joints());
        let mut piece_of = Vec::with_capacity(self.follows.len());
        let mut hinges = Vec::with_capacity(edited.turned.len());
        for (idx, joint) in skeleton.joints().iter().enumerate() {
            let above = joint.parent.and_then(|parent| piece_of_joint[parent.idx()]);
            let place = if self.follows[idx] { above.or(Some(0)) } else { None };
            piece_of.push(place);
            let turned = edited.turned.iter().find(|turned| turned.joint.idx() == idx);
            piece_of_joint.push(match (place, turned) {
                (Some(above), Some(turned)) => {
                    hinges.push(Hinge { above, turned, source: turning.joint(turned.joint) });
                    Some(hinges.len())
                }
                _ => place,
            });
        }
        piece_of.extend(skeleton.end_sites().iter().map(|joint| piece_of_joint[joint.idx()]));
        let mut parts = halves(frames.len(), 0, |range| self.moves(edited, &hinges, range)).into_iter();
        let mut moves = parts.next().expect("at least one part");
        for part in parts {
            moves.iter_mut().zip(part).for_each(|(moves, more)| moves.extend(more));
        }
        Placed { source_frames: frames, piece_of, pieces: moves.into_iter().map(Piece::new).collect() }
    }

    /// Returns the moves of all pieces over some edited frames, the carrier's piece first.
    fn moves(&self, edited: &EditedClip, hinges: &[Hinge], range: Range<usize>) -> Vec<Vec<Rigid>> {
        let frames = &edited.source_frames[range.clone()];
        let whole = if edited.carrier_world.is_empty() {
            vec![Rigid::IDENTITY; frames.len()]
        } else {
            let moved = edited.carrier_world[range.clone()].iter().zip(frames);
            moved.map(|(&to, &f)| to * self.to_origin[f as usize]).collect()
        };
        let mut pieces = vec![whole];
        for Hinge { above, turned, source } in hinges {
            let turn = |((above, &f), &rotation): ((&Rigid, &u32), &DQuat)| {
                let f = f as usize;
                let rotation = above.rotation * (source.parent[f] * rotation * source.undone[f]);
                let pivot = self.tracks.position(turned.joint.idx(), f);
                Rigid::new(rotation, above.point(pivot) - rotation * pivot)
            };
            let turns = &turned.rotations[range.clone()];
            pieces.push(pieces[*above].iter().zip(frames).zip(turns).map(turn).collect());
        }
        pieces
    }

    /// Returns the world positions of some points of a placed body.
    pub fn points(&self, points: &[usize], placed: &Placed) -> PointTracks {
        PointTracks::from_fn(points.len(), placed.source_frames.len(), |idx, frame| {
            let at = self.tracks.position(points[idx], placed.source_frames[frame] as usize);
            match placed.piece_of[points[idx]] {
                Some(piece) => placed.pieces[piece].moves[frame].point(at),
                None => at,
            }
        })
    }
}
