//! The stage that lays displacement maps on what walks (METHOD 8), and what holding its feet needs of the result.
//!
//! ```text
//! clip as loaded ─▶ own data cleared ─▶ interpolation keys ─▶ layers ─▶ the same on what walks ─▶ legs
//! ```
//!
//! Layers are laid on the clip as loaded, where their keys are; what they turn a joint by goes on to every frame that
//! shows the clip's. None of it moves a path: the original path is fitted to the clip as loaded, and what is changed of
//! the carrier is what that path leaves over.

use std::{ops::Range, sync::Arc};

use glam::{DQuat, DVec3};

use super::{Edits, Solved, Walked, feet, solve::reuse, walked::Loaded};
use crate::{
    constrain::Prepared,
    displace::{Displaced, Interpolation, Stack, can_turn, interpolated_joints, interpolated_motions},
    math::Rigid,
    measure::Turning,
    motion::{Clip, EditedClip, TurnedJoint},
    path::{PathFrame, Residuals},
    skeleton::JointId,
    sync::listed,
};

/// `clip.clear_position` and `clip.clear_rotation`: which of the clip's own data take no part.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct Cleared {
    /// The carrier does not leave its path; where no path is walked it stays where it begins.
    pub position: bool,
    /// Every joint is as the file has it with all rotations zero.
    pub rotation: bool,
}

/// The clip as layers find it: as loaded, but for what was cleared or lies between interpolation keys.
#[derive(Clone, Debug, Default)]
pub struct Base {
    /// Joints that turn otherwise than in the clip, at its frames.
    pub joints: Vec<TurnedJoint>,
    /// The carrier's motions in place of the clip's own: residuals where a path is walked, else in the world; empty when
    /// it moves as in the clip.
    motions: Vec<Rigid>,
    /// Frames of the clip at which it may move otherwise.
    moved: Range<usize>,
}

/// What walks, with displacement maps on it. Frames are those of what walks.
#[derive(Clone, Debug)]
pub struct Posed {
    /// What layers find.
    pub base: Arc<Base>,
    /// What layers make of the clip as loaded, at its frames.
    pub of_clip: Arc<Displaced>,
    /// The same at the frames of what walks.
    pub displaced: Arc<Displaced>,
    /// What the path carries.
    pub residuals: Arc<Residuals>,
    /// Whether anything of it bears on a leg.
    bears: bool,
    /// What walks, with its layers, on the original path, as far as its legs are concerned: joints that no leg hangs on
    /// are as they walk.
    pub legs: Arc<EditedClip>,
    /// The legs that can be held, ready to be.
    pub prepared: Arc<Prepared>,
    /// The joints that holding and layers turn, ready to be measured.
    pub turning: Arc<Turning>,
    /// What in the layers and interpolation keys means nothing for this clip, one line each.
    pub warnings: Vec<String>,
}

impl Posed {
    /// Lays the user's layers on what walks. `walks`: it is carried along a new path.
    pub(super) fn of(edits: &Edits, loaded: &Loaded, walked: &Walked, walks: bool, previous: Option<&Solved>) -> Self {
        let same_clip = previous.filter(|p| Arc::ptr_eq(&p.clip, loaded.clip));
        let same_base = same_clip.filter(|p| {
            (p.edits.cleared, p.edits.interpolation_keys) == (edits.cleared, edits.interpolation_keys)
                && p.walks_new_path() == walks
                && Arc::ptr_eq(&p.residuals, loaded.residuals)
        });
        let base = reuse(same_base, |p| &p.posed.base, || Base::of(edits, loaded, walks));

        let stack = Stack { clip: loaded.clip, base: &base.joints, layers: &edits.layers };
        let same_layers = same_base.filter(|p| p.edits.layers == edits.layers);
        let of_clip = reuse(
            same_layers,
            |p| &p.posed.of_clip,
            || match same_clip {
                Some(p) => {
                    let earlier = Stack { clip: &p.clip, base: &p.posed.base.joints, layers: &p.edits.layers };
                    stack.displaced_again(&earlier, &p.posed.of_clip, 0..loaded.clip.n_frames())
                }
                None => stack.displaced(),
            },
        );

        let same_walk = previous.filter(|p| Arc::ptr_eq(&p.walked.clip, &walked.clip));
        let same_joints = same_walk.filter(|p| Arc::ptr_eq(&p.posed.of_clip, &of_clip));
        let displaced = match &walked.joined {
            None => Arc::clone(&of_clip),
            Some(joined) => reuse(
                same_joints,
                |p| &p.posed.displaced,
                || carried_over(&of_clip, loaded.clip, 0, &walked.clip, &joined.source_frames),
            ),
        };
        let residuals = if base.motions.is_empty() || !walks {
            Arc::clone(&walked.residuals)
        } else {
            let same = same_joints
                .filter(|p| Arc::ptr_eq(&p.posed.base, &base) && Arc::ptr_eq(&p.walked.residuals, &walked.residuals));
            reuse(same, |p| &p.posed.residuals, || base.residuals(walked))
        };

        // Arms and heads may do what they like: the legs are prepared anew only where something bears on them.
        let is_leg =
            |joint: JointId| (walked.plants.iter()).any(|foot| loaded.clip.skeleton.is_within(foot.leg.ankle, joint));
        let bears = displaced.moves_carrier()
            || !base.motions.is_empty()
            || displaced.turned.iter().any(|turned| is_leg(turned.joint));
        let same_on_path = same_walk.filter(|p| p.posed.bears == bears).filter(|p| {
            !bears
                || (Arc::ptr_eq(&p.posed.base, &base)
                    && Arc::ptr_eq(&p.posed.residuals, &residuals)
                    && Arc::ptr_eq(&p.original, loaded.original)
                    && p.posed.displaced.moves_as(&displaced)
                    && p.posed.displaced.turns_as(&displaced, is_leg))
        });
        let legs = reuse(
            same_on_path,
            |p| &p.posed.legs,
            || match bears {
                false => EditedClip::unedited(Arc::clone(&walked.clip)),
                true => {
                    let path = walked.path(loaded.original);
                    legs_posed(&walked.clip, &displaced, &residuals, path, base.moves_otherwise(), is_leg)
                }
            },
        );
        let same_legs = previous.filter(|p| {
            Arc::ptr_eq(&p.posed.legs, &legs)
                && p.walked.plants == walked.plants
                && p.edits.plants.clean == edits.plants.clean
        });
        let prepared = reuse(
            same_legs,
            |p| &p.posed.prepared,
            || {
                let path = walked.path(loaded.original);
                let own_carrier = own_carrier(&displaced, &residuals, path);
                let earlier = previous.map(|p| &*p.posed.prepared);
                let ground = feet::ground(&walked.body, &walked.plants, walked.clip.facts.height.value);
                feet::prepared(&legs, &own_carrier, &walked.plants, edits.plants.clean, earlier).on_ground(ground)
            },
        );
        let joints = turning_joints(&walked.clip, &prepared, &displaced);
        let same_turning = same_walk.filter(|p| p.posed.turning.joints().eq(joints.iter().copied()));
        let turning = reuse(
            same_turning,
            |p| &p.posed.turning,
            || Turning::of(&walked.clip, &walked.body, joints.iter().copied()),
        );
        let mut warnings = stack.warnings();
        warnings.extend(edits.interpolation_keys.and_then(|keys| keys.warning(loaded.clip)));
        Self { base, of_clip, displaced, residuals, bears, legs, prepared, turning, warnings }
    }

    /// Lays other layers on what walks. Its legs, and all that is prepared of them, stay as they were.
    pub(super) fn relaid(&self, solved: &Solved, edits: &Edits) -> Self {
        let (clip, base) = (&*solved.clip, &self.base.joints);
        let stack = Stack { clip, base, layers: &edits.layers };
        let earlier = Stack { clip, base, layers: &solved.edits.layers };
        let of_clip = Arc::new(stack.displaced_again(&earlier, &self.of_clip, 0..clip.n_frames()));
        let displaced = match &solved.walked.joined {
            None => Arc::clone(&of_clip),
            Some(joined) => Arc::new(carried_over(&of_clip, clip, 0, &solved.walked.clip, &joined.source_frames)),
        };
        Self { of_clip, displaced, ..self.clone() }
    }

    /// Tells whether a joint bears no leg that can be held.
    pub(super) fn is_free(&self, joint: JointId) -> bool {
        let skeleton = &self.legs.clip.skeleton;
        !self.prepared.legs().any(|leg| skeleton.is_within(leg.ankle, joint))
    }

    /// Returns where the carrier is at a frame of what walks, `at` being the path's frame there.
    pub(super) fn carrier(&self, frame: usize, at: &PathFrame) -> Rigid {
        self.displaced.carrier(frame, self.residuals.apply(frame, at), || at.rotation(self.residuals.frame))
    }

    /// Returns where the carrier would be, from frame 0 of what walks on, if layers did not move it; empty if they do not.
    pub(super) fn own_carrier(&self, path: &[PathFrame]) -> Vec<Rigid> {
        own_carrier(&self.displaced, &self.residuals, path)
    }

    /// Takes the layers' part out of where a carrier is.
    pub(super) fn undisplaced(&self, frame: usize, carrier: Rigid, at: &PathFrame) -> Rigid {
        self.displaced.undisplaced_carrier(frame, carrier, at.rotation(self.residuals.frame))
    }

    /// Returns the clip as loaded with its layers, where no new path is walked.
    pub(super) fn standing(&self, loaded: &Loaded) -> EditedClip {
        let mut edited = EditedClip::unedited(Arc::clone(loaded.clip));
        if self.displaced.moves_carrier() || !self.base.motions.is_empty() {
            let own = if self.base.motions.is_empty() { loaded.carrier } else { &self.base.motions };
            let frames = own.iter().zip(loaded.original.frames()).enumerate();
            let place = |(f, (&own, at)): (usize, (&Rigid, &PathFrame))| {
                self.displaced.carrier(f, own, || at.rotation(self.residuals.frame))
            };
            edited.carrier_world = frames.map(place).collect();
        }
        edited
    }

    /// Turns the joints that layers turn and that are not turned already.
    pub(super) fn laid_on(&self, walk: &Arc<EditedClip>) -> Arc<EditedClip> {
        let is_held = |turned: &TurnedJoint| walk.turned.iter().any(|held| held.joint == turned.joint);
        if self.displaced.turned.iter().all(is_held) {
            return Arc::clone(walk);
        }
        let mut laid = (**walk).clone();
        let shown = self.displaced.shown(&walk.source_frames).into_iter();
        laid.turned.extend(shown.filter(|turned| !is_held(turned)));
        Arc::new(laid)
    }
}

impl Base {
    /// Tells whether the carrier has motions of its own in place of the clip's.
    pub(super) fn moves_otherwise(&self) -> bool {
        !self.motions.is_empty()
    }

    fn of(edits: &Edits, loaded: &Loaded, walks: bool) -> Self {
        let clip = &**loaded.clip;
        let (cleared, keys) = (edits.cleared, edits.interpolation_keys);
        let joints = if cleared.rotation {
            let turned = clip.skeleton.ids().filter(|&id| id != clip.facts.carrier.value && can_turn(clip, id));
            turned
                .map(|joint| TurnedJoint { joint, rotations: vec![rest_rotation(clip, joint); clip.n_frames()] })
                .collect()
        } else {
            keys.map_or_else(Vec::new, |keys| interpolated_joints(clip, keys, Interpolation::Quaternion))
        };
        let replaced = keys.map_or(0..0, |keys| keys.frames(clip));
        let is_cleared = cleared.position || cleared.rotation;
        if !clip.facts.path_editable || (replaced.is_empty() && !is_cleared) {
            return Self { joints, ..Self::default() };
        }
        let mut motions = if walks { loaded.residuals.motions.clone() } else { loaded.carrier.to_vec() };
        if let Some(keys) = keys {
            interpolated_motions(clip, keys, &mut motions);
        }
        if cleared.position {
            let still = if walks { DVec3::ZERO } else { motions[0].translation };
            motions.iter_mut().for_each(|motion| motion.translation = still);
        }
        if cleared.rotation {
            let rest = clip.facts.up.value.world_rotation();
            motions.iter_mut().for_each(|motion| motion.rotation = rest);
        }
        Self { joints, motions, moved: if is_cleared { 0..clip.n_frames() } else { replaced } }
    }

    /// Returns what the path carries of what walks.
    fn residuals(&self, walked: &Walked) -> Residuals {
        let motions = walked.residuals.motions.iter().enumerate();
        let motion = |(frame, &own): (usize, &Rigid)| {
            let source = walked.joined.as_ref().map_or(frame, |joined| joined.source_frames[frame] as usize);
            if self.moved.contains(&source) { self.motions[source] } else { own }
        };
        Residuals { frame: walked.residuals.frame, motions: motions.map(motion).collect() }
    }
}

/// Returns a joint's local rotation where all its channels are zero.
fn rest_rotation(clip: &Clip, joint: JointId) -> DQuat {
    let is_root = clip.skeleton.joint(joint).parent.is_none();
    if is_root { clip.facts.up.value.world_rotation() } else { DQuat::IDENTITY }
}

/// Turns the joints of a clip joined to itself by what layers turn those of the clip by, which begins at a frame of it.
pub(super) fn carried_over(
    of_clip: &Displaced,
    clip: &Clip,
    first: usize,
    joined: &Clip,
    source_frames: &[u32],
) -> Displaced {
    let turned = |turned: &TurnedJoint| {
        let idx = turned.joint.idx();
        let own = |(frame, &source): (usize, &u32)| {
            let source = source as usize;
            let (from, to) = (clip.rotations(source)[idx], turned.rotations[source - first]);
            let at = joined.rotations(frame)[idx];
            if at == from { to } else { at * (from.conjugate() * to) }
        };
        TurnedJoint { joint: turned.joint, rotations: source_frames.iter().enumerate().map(own).collect() }
    };
    Displaced {
        turned: of_clip.turned.iter().map(turned).collect(),
        carrier_turns: repeated(&of_clip.carrier_turns, first, source_frames),
        offsets: repeated(&of_clip.offsets, first, source_frames),
    }
}

fn repeated<T: Copy>(values: &[T], first: usize, source_frames: &[u32]) -> Vec<T> {
    let value = |&frame: &u32| values[frame as usize - first];
    if values.is_empty() { Vec::new() } else { source_frames.iter().map(value).collect() }
}

/// Returns where the carrier would be on a path if layers did not move it; empty if they do not.
pub(super) fn own_carrier(displaced: &Displaced, residuals: &Residuals, path: &[PathFrame]) -> Vec<Rigid> {
    if !displaced.moves_carrier() {
        return Vec::new();
    }
    listed(path.len(), |range| range.map(|frame| residuals.apply(frame, &path[frame])))
}

/// Returns what walks as layers have it, on the original path; of the joints only those that legs hang on.
/// `moves_otherwise`: the residuals are not its own.
pub(super) fn legs_posed(
    clip: &Arc<Clip>,
    displaced: &Displaced,
    residuals: &Residuals,
    path: &[PathFrame],
    moves_otherwise: bool,
    is_leg: impl Fn(JointId) -> bool,
) -> EditedClip {
    let place = |frame: usize| {
        let at = &path[frame];
        displaced.carrier(frame, residuals.apply(frame, at), || at.rotation(residuals.frame))
    };
    let is_placed = clip.facts.path_editable && (displaced.moves_carrier() || moves_otherwise);
    EditedClip {
        carrier_world: if is_placed { listed(path.len(), |range| range.map(place)) } else { Vec::new() },
        turned: displaced.turned.iter().filter(|turned| is_leg(turned.joint)).cloned().collect(),
        ..EditedClip::unedited(Arc::clone(clip))
    }
}

/// Returns the joints below the carrier that holding or layers may turn, in the skeleton's order.
fn turning_joints(clip: &Clip, prepared: &Prepared, displaced: &Displaced) -> Vec<JointId> {
    let carrier = clip.facts.carrier.value;
    let held = prepared.legs().flat_map(|leg| [leg.hip, leg.knee, leg.ankle]);
    let moves_along = |&joint: &JointId| joint != carrier && clip.skeleton.is_within(joint, carrier);
    let laid = displaced.turned.iter().map(|turned| turned.joint).filter(moves_along);
    let mut joints: Vec<JointId> = held.chain(laid).collect();
    joints.sort_unstable();
    joints.dedup();
    joints
}
