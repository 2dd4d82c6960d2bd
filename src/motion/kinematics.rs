//! Forward kinematics: from local transforms to the world, one frame at a time or a whole clip at once.
//!
//! One frame is a pass over the joints, parents first. A whole clip is the same pass over groups of four frames, a
//! lane each; the result is laid out by point ([`PointTracks`]), because whoever asks for all frames loops over them.

use std::ops::Range;

use glam::{DQuat, DVec3};

use super::{TurnedJoint, poses::Poses, tracks::PointTracks};
use crate::{
    math::{
        Rigid,
        lanes::{LANES, QuatLanes, RigidLanes, VecLanes},
    },
    skeleton::{JointId, Skeleton},
};

/// What stands or turns otherwise than the poses say, at one frame.
pub(super) struct Instead<'a> {
    /// Where one joint is in the world.
    pub(super) placed: Option<(JointId, Rigid)>,
    /// Joints with local rotations of their own.
    pub(super) turned: &'a [TurnedJoint],
    /// Which of those rotations count.
    pub(super) turned_frame: usize,
}

/// Fills `out` with the world motions of all joints at one frame.
pub(super) fn world_rigids(skeleton: &Skeleton, poses: &Poses, frame: usize, out: &mut Vec<Rigid>) {
    world_rigids_instead(skeleton, poses, frame, &Instead { placed: None, turned: &[], turned_frame: 0 }, out);
}

/// Fills `out` with the world motions of all joints at one frame, some of them otherwise than the poses say.
pub(super) fn world_rigids_instead(
    skeleton: &Skeleton,
    poses: &Poses,
    frame: usize,
    instead: &Instead,
    out: &mut Vec<Rigid>,
) {
    out.clear();
    for (id, joint) in skeleton.ids().zip(skeleton.joints()) {
        let mut local = poses.local(frame, id.idx());
        if let Some(turned) = instead.turned.iter().find(|turned| turned.joint == id) {
            local.rotation = turned.rotations[instead.turned_frame];
        }
        out.push(match (instead.placed, joint.parent) {
            (Some((placed, world)), _) if placed == id => world,
            (_, Some(parent)) => out[parent.idx()] * local,
            (_, None) => local,
        });
    }
}

/// Fills in the motions of some joints at four frames, parents first, each with all that it hangs on below a joint whose
/// space they are in and which is in place. Frame by frame, and joint by joint with those of `turned` at `turned_frames`.
pub(super) fn fill_rigid_lanes(
    skeleton: &Skeleton,
    poses: &Poses,
    frames: [usize; LANES],
    (turned, turned_frames): (&[TurnedJoint], [usize; LANES]),
    joints: &[JointId],
    out: &mut [RigidLanes],
) {
    for &id in joints {
        let above = out[skeleton.joint(id).parent.expect("it hangs on another").idx()];
        let local = match turned.iter().find(|turned| turned.joint == id) {
            Some(turned) => QuatLanes::gather(|lane| turned.rotations[turned_frames[lane]]),
            None => local_rotations(poses, frames, id.idx()),
        };
        out[id.idx()] = RigidLanes {
            rotation: above.rotation.times(local),
            translation: above.point(local_translations(poses, frames, id.idx())),
        };
    }
}

/// Fills `out` with the world motions of all joints at one frame with nothing turned but the roots, all of them by
/// `roots`.
pub(super) fn world_rigids_unturned(
    skeleton: &Skeleton,
    poses: &Poses,
    frame: usize,
    roots: DQuat,
    out: &mut Vec<Rigid>,
) {
    out.clear();
    for (idx, joint) in skeleton.joints().iter().enumerate() {
        let translation = poses.translation(frame, idx);
        out.push(match joint.parent {
            Some(parent) => out[parent.idx()] * Rigid::new(DQuat::IDENTITY, translation),
            None => Rigid::new(roots, translation),
        });
    }
}

/// Fills `out` with all points, joints then end sites, from the joints' world motions.
pub(super) fn points(skeleton: &Skeleton, rigids: &[Rigid], out: &mut Vec<DVec3>) {
    out.clear();
    out.extend(rigids.iter().map(|r| r.translation));
    for &id in skeleton.end_sites() {
        let site = skeleton.joint(id).end_site.expect("end_sites lists joints that have one");
        out.push(rigids[id.idx()].point(site));
    }
}

/// Returns the world motion of one joint at one frame.
pub(super) fn world_of(skeleton: &Skeleton, poses: &Poses, frame: usize, id: JointId) -> Rigid {
    let mut world = poses.local(frame, id.idx());
    let mut at = skeleton.joint(id).parent;
    while let Some(parent) = at {
        world = poses.local(frame, parent.idx()) * world;
        at = skeleton.joint(parent).parent;
    }
    world
}

/// A forward pass prepared for whole clips: which joints, in which order, and what is needed of each.
#[derive(Clone, Debug)]
pub(super) struct Walk {
    steps: Vec<Step>,
    /// Step an end site hangs on, and its offset.
    sites: Vec<(usize, DVec3)>,
    /// Skeleton's point index of each point of the walk: the steps, then the sites.
    pub(super) points: Vec<usize>,
}

#[derive(Clone, Copy, Debug)]
struct Step {
    joint: usize,
    parent: Parent,
    /// Something hangs on this joint, so its orientation is needed.
    turns: bool,
}

#[derive(Clone, Copy, Debug)]
enum Parent {
    /// The joint's local transform is its world transform.
    World,
    /// An earlier step.
    Step(usize),
    /// None: the joint itself is the origin.
    Origin,
}

impl Walk {
    /// Walks all joints; points are numbered as in the skeleton.
    pub(super) fn whole(skeleton: &Skeleton) -> Self {
        Self::new(skeleton, |_| true, None)
    }

    /// Walks a joint and what hangs below it, in that joint's own space.
    pub(super) fn below(skeleton: &Skeleton, origin: JointId) -> Self {
        let within = skeleton.subtree(origin);
        Self::new(skeleton, |joint| within[joint], Some(origin))
    }

    /// Walks the chain from a root to a joint, nothing else.
    pub(super) fn chain(skeleton: &Skeleton, end: JointId) -> Self {
        let mut on_chain = vec![false; skeleton.n_joints()];
        let mut at = Some(end);
        while let Some(id) = at {
            on_chain[id.idx()] = true;
            at = skeleton.joint(id).parent;
        }
        let mut walk = Self::new(skeleton, |joint| on_chain[joint], None);
        walk.points.truncate(walk.steps.len());
        walk.sites.clear();
        walk
    }

    fn new(skeleton: &Skeleton, chosen: impl Fn(usize) -> bool, origin: Option<JointId>) -> Self {
        let mut steps = Vec::new();
        let mut step_of = vec![None; skeleton.n_joints()];
        for (joint, j) in skeleton.joints().iter().enumerate().filter(|&(joint, _)| chosen(joint)) {
            let parent = match j.parent {
                _ if origin.is_some_and(|o| o.idx() == joint) => Parent::Origin,
                Some(parent) => Parent::Step(step_of[parent.idx()].expect("a walk holds every joint's parent")),
                None => Parent::World,
            };
            if let Parent::Step(above) = parent {
                let above: &mut Step = &mut steps[above];
                above.turns = true;
            }
            step_of[joint] = Some(steps.len());
            steps.push(Step { joint, parent, turns: j.end_site.is_some() });
        }
        let mut points: Vec<usize> = steps.iter().map(|s| s.joint).collect();
        let mut sites = Vec::new();
        for (site, id) in skeleton.end_sites().iter().enumerate().filter(|(_, id)| chosen(id.idx())) {
            let step = step_of[id.idx()].expect("the joint is chosen");
            sites.push((step, skeleton.joint(*id).end_site.expect("end_sites lists joints that have one")));
            points.push(skeleton.n_joints() + site);
        }
        Self { steps, sites, points }
    }

    /// Returns the positions of the walk's points over these file frames.
    pub(super) fn tracks(&self, poses: &Poses, frames: Range<usize>) -> PointTracks {
        let mut tracks = PointTracks::new(self.points.len(), frames.len());
        self.fill(poses, frames, &mut tracks);
        tracks
    }

    /// Calls `visit` with the file frames and positions of one stretch of `frames` after the other; a clip of any
    /// length needs the memory of one stretch.
    pub(super) fn visit(&self, poses: &Poses, frames: Range<usize>, mut visit: impl FnMut(Range<usize>, &PointTracks)) {
        const STRETCH: usize = 256;
        let mut tracks = PointTracks::new(self.points.len(), STRETCH);
        for first in frames.clone().step_by(STRETCH) {
            let stretch = first..(first + STRETCH).min(frames.end);
            if stretch.len() < STRETCH {
                tracks = PointTracks::new(self.points.len(), stretch.len());
            }
            self.fill(poses, stretch.clone(), &mut tracks);
            visit(stretch, &tracks);
        }
    }

    fn fill(&self, poses: &Poses, frames: Range<usize>, tracks: &mut PointTracks) {
        let mut worlds = vec![RigidLanes::identity(); self.steps.len()];
        for group in (0..frames.len()).step_by(LANES) {
            // Lanes beyond the end repeat the last frame; the padding between points has room for them.
            let at: [usize; LANES] = std::array::from_fn(|lane| (frames.start + group + lane).min(frames.end - 1));
            for (slot, step) in self.steps.iter().enumerate() {
                let world = step.world(poses, at, &worlds);
                store(tracks, slot, group, world.translation);
                worlds[slot] = world;
            }
            for (site, &(step, offset)) in self.sites.iter().enumerate() {
                let position = worlds[step].point(VecLanes::splat(offset));
                store(tracks, self.steps.len() + site, group, position);
            }
        }
    }

    /// Returns the world motions of the walk's last joint over these file frames.
    pub(super) fn last_rigids(&self, poses: &Poses, frames: Range<usize>) -> Vec<Rigid> {
        let joints: Vec<usize> = self.steps.iter().map(|s| s.joint).collect();
        frames
            .map(|frame| joints.iter().fold(Rigid::IDENTITY, |world, &joint| world * poses.local(frame, joint)))
            .collect()
    }
}

impl Step {
    /// Returns orientation and position; the orientation is only meant where it is needed.
    #[inline(always)]
    fn world(&self, poses: &Poses, at: [usize; LANES], worlds: &[RigidLanes]) -> RigidLanes {
        let local_rotation = || local_rotations(poses, at, self.joint);
        let local_translation = || local_translations(poses, at, self.joint);
        match self.parent {
            Parent::World => RigidLanes { rotation: local_rotation(), translation: local_translation() },
            Parent::Origin => RigidLanes::identity(),
            Parent::Step(parent) => {
                let above = worlds[parent];
                let rotation = if self.turns { above.rotation.times(local_rotation()) } else { above.rotation };
                RigidLanes { rotation, translation: above.point(local_translation()) }
            }
        }
    }
}

#[inline(always)]
fn local_rotations(poses: &Poses, at: [usize; LANES], joint: usize) -> QuatLanes {
    QuatLanes::gather(|lane| poses.rotations[at[lane] * poses.n_joints + joint])
}

#[inline(always)]
fn local_translations(poses: &Poses, at: [usize; LANES], joint: usize) -> VecLanes {
    match poses.columns[joint] {
        Some(column) => VecLanes::gather(|lane| poses.translations[at[lane] * poses.n_columns + column]),
        None => VecLanes::splat(poses.fixed[joint]),
    }
}

/// Writes four frames of one point.
#[inline(always)]
fn store(tracks: &mut PointTracks, point: usize, frame: usize, p: VecLanes) {
    let at = tracks.at(point, frame);
    tracks.x[at..at + LANES].copy_from_slice(&p.x.to_array());
    tracks.y[at..at + LANES].copy_from_slice(&p.y.to_array());
    tracks.z[at..at + LANES].copy_from_slice(&p.z.to_array());
}
