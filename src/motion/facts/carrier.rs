//! The carrier: the joint whose position channels carry the locomotion.

use glam::DVec3;

use super::Decided;
use crate::{
    motion::channels::FileMotion,
    skeleton::{JointId, Skeleton},
};

/// A joint moves when its position channels move by more than this share of the body height.
const MOVES: f64 = 0.01;

/// Finds the joint the user named.
pub(super) fn named(skeleton: &Skeleton, name: &str, warnings: &mut Vec<String>) -> Option<Decided<JointId>> {
    let n_found = skeleton.joints().iter().filter(|j| j.name == name).count();
    if n_found == 0 {
        warnings.push(format!("there is no joint {name:?} to be the carrier; it is guessed"));
    }
    if n_found > 1 {
        warnings.push(format!("{n_found} joints are called {name:?}; the first is the carrier"));
    }
    skeleton.find(name).map(Decided::as_asked)
}

/// Returns the first joint, walking down from the root, that moves by more than 0.01 H; else the root.
///
/// Walking down is by depth, then in file order. A joint that holds less than half of the body (a finger with position
/// channels of its own) carries nobody and is passed over. `height` need only be right to within a factor.
pub(super) fn first_that_moves(motion: &FileMotion, rest_frames: usize, height: f64) -> Decided<JointId> {
    let skeleton = &motion.skeleton;
    let (depths, sizes) = (depths(skeleton), subtree_sizes(skeleton));
    let mut candidates: Vec<usize> = (0..skeleton.n_joints())
        .filter(|&j| motion.channels[j].has_position() && 2 * sizes[j] >= skeleton.n_joints())
        .collect();
    candidates.sort_by_key(|&j| depths[j]);
    for joint in candidates {
        let moved = moved(motion, joint, rest_frames) / height;
        if moved > MOVES {
            let name = &skeleton.joints()[joint].name;
            return Decided::new(
                JointId(joint as u32),
                format!(
                    "{name} is the first joint from the root whose position moves by more than {MOVES} H (by {moved:.2} H)"
                ),
            );
        }
    }
    Decided::new(JointId(0), format!("no joint's position moves by more than {MOVES} H, so it is the root"))
}

/// Returns the diagonal of the box a joint's position channels stay in.
fn moved(motion: &FileMotion, joint: usize, rest_frames: usize) -> f64 {
    let range = |column: Option<usize>| {
        let Some(column) = column else { return 0.0 };
        let bounds = (f64::INFINITY, f64::NEG_INFINITY);
        let (low, high) =
            motion.column(column).skip(rest_frames).fold(bounds, |(low, high), v| (low.min(v), high.max(v)));
        (high - low).max(0.0)
    };
    DVec3::from_array(motion.channels[joint].positions.map(range)).length()
}

fn depths(skeleton: &Skeleton) -> Vec<usize> {
    let mut depths = vec![0; skeleton.n_joints()];
    for (idx, joint) in skeleton.joints().iter().enumerate() {
        depths[idx] = joint.parent.map_or(0, |p| depths[p.idx()] + 1);
    }
    depths
}

fn subtree_sizes(skeleton: &Skeleton) -> Vec<usize> {
    let mut sizes = vec![1; skeleton.n_joints()];
    for (idx, joint) in skeleton.joints().iter().enumerate().rev() {
        if let Some(parent) = joint.parent {
            sizes[parent.idx()] += sizes[idx];
        }
    }
    sizes
}
