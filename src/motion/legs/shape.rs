//! Legs by shape: two mirrored chains that hang from the pelvis and end lowest, or the one that mirrors a known leg.
//!
//! Arms are mirrored chains too, and where legs are missing they end lowest. What tells them apart is where they part:
//! legs part at the carrier or beside it, arms a trunk's length above it. And arms are often named.

use glam::DVec3;

use super::{Leg, Side, names, toe_below};
use crate::{
    motion::Clip,
    skeleton::{JointId, Skeleton},
};

/// Mirrored bones differ in length by at most this share.
const MIRRORED: f64 = 0.1;

/// Thigh and shin together are at least this share of the body height.
const SHORTEST: f64 = 0.2;

/// Legs part at most this far above the carrier, thigh and shin together being 1: arms part farther up the trunk.
const TRUNK: f64 = 0.25;

/// At their lowest, legs end at most this far above the body's lowest point, thigh and shin together being 1.
const LOWEST: f64 = 0.25;

/// A carrier that rides on the floor is at most this far above it, body heights.
const ON_FLOOR: f64 = 0.1;

/// How many of the lowest tips are looked at.
const MOST_TIPS: usize = 16;

/// Frames looked at, evenly spread.
const MOST_FRAMES: usize = 64;

/// Returns the two legs, or none.
pub(super) fn legs(clip: &Clip) -> Vec<Leg> {
    let skeleton = &clip.skeleton;
    let frames = sample(clip);
    let mean_height = |point: usize| mean_height(&frames, point);
    let lowest = |point: usize| frames.iter().map(|points| points[point].y).fold(f64::INFINITY, f64::min);
    let ground = (0..skeleton.n_points()).map(lowest).fold(f64::INFINITY, f64::min);
    let mut tips = tips(skeleton);
    tips.sort_by(|&a, &b| mean_height(a).total_cmp(&mean_height(b)));
    tips.truncate(MOST_TIPS);

    let mut found: Option<(f64, [Bends; 2])> = None;
    for (at, &a) in tips.iter().enumerate() {
        for &b in &tips[at + 1..] {
            let Some((parting, pair)) = mirrored(skeleton, &frames[0], a, b) else { continue };
            let reach = 0.5 * (pair[0].reach + pair[1].reach);
            let is_arm = [a, b].iter().any(|&tip| is_arm(skeleton, tip, parting));
            if is_arm || !hangs_from_pelvis(clip, &frames, parting, reach) {
                continue;
            }
            let long_enough = pair.iter().all(|leg| leg.reach >= SHORTEST * clip.facts.height.value);
            let lands = lowest(a).min(lowest(b)) < ground + LOWEST * reach;
            let hangs = |leg: &Bends| mean_height(leg.hip.idx()) - mean_height(leg.ankle.idx()) > 0.5 * leg.reach;
            let ends_at: f64 = pair.iter().map(|leg| mean_height(leg.ankle.idx())).sum();
            if long_enough
                && lands
                && pair.iter().all(hangs)
                && found.as_ref().is_none_or(|(lowest, _)| ends_at < *lowest)
            {
                found = Some((ends_at, pair));
            }
        }
    }
    let Some((_, pair)) = found else { return Vec::new() };
    let [a, b] = pair.map(|leg| (leg, toe_below(skeleton, leg.ankle)));
    let sides = if first_is_left(&frames, a, b) { [Side::Left, Side::Right] } else { [Side::Right, Side::Left] };
    [(sides[0], a), (sides[1], b)]
        .into_iter()
        .map(|(side, (leg, toe))| Leg { side, hip: leg.hip, knee: leg.knee, ankle: leg.ankle, toe })
        .collect()
}

/// Returns the leg that mirrors a known one, if there is one.
///
/// It parts from the known leg's way to the root, has bones as long, bends as many bones below, and ends as low.
pub(super) fn other_side(clip: &Clip, known: &Leg) -> Option<Leg> {
    let skeleton = &clip.skeleton;
    let frames = sample(clip);
    let off_known = |ankle: JointId| !skeleton.is_within(ankle, known.hip) && !skeleton.is_within(known.ankle, ankle);
    let ends_at = mean_height(&frames, known.ankle.idx());
    let off_level = |ankle: JointId| (mean_height(&frames, ankle.idx()) - ends_at).abs();
    let chain_of = |ankle: JointId| {
        let (parting, own, other) = parted(skeleton, &frames[0], known.ankle.idx(), ankle.idx())?;
        if !alike(&own, &other) || is_arm(skeleton, ankle.idx(), parting) {
            return None;
        }
        // A bend is known by how many bones hang above it; what has no length is on the bone above.
        let n_above =
            |joint| own.iter().take_while(|bone| skeleton.is_within(joint, JointId(bone.lower as u32))).count();
        let bend = |joint| other.get(n_above(joint)).map(|bone| JointId(bone.upper as u32));
        let (hip, knee) = (bend(known.hip)?, bend(known.knee)?);
        let reach: f64 = own[n_above(known.hip)..].iter().map(|bone| bone.length).sum();
        (off_level(ankle) < LOWEST * reach).then_some((hip, knee, ankle))
    };
    let found = skeleton.ids().filter(|&ankle| off_known(ankle)).filter_map(chain_of);
    let (hip, knee, ankle) = found.min_by(|a, b| off_level(a.2).total_cmp(&off_level(b.2)))?;
    let side = match known.side {
        Side::Left => Side::Right,
        Side::Right => Side::Left,
    };
    Some(Leg { side, hip, knee, ankle, toe: toe_below(skeleton, ankle) })
}

/// Returns a point's mean height over the frames.
fn mean_height(frames: &[Vec<DVec3>], point: usize) -> f64 {
    frames.iter().map(|points| points[point].y).sum::<f64>() / frames.len() as f64
}

/// Tells whether chains of this `reach` that part at a joint may be legs: the joint is the carrier, above it in the
/// tree, or below it in the tree but not far up the body. Above a carrier on the floor the body begins with its child.
fn hangs_from_pelvis(clip: &Clip, frames: &[Vec<DVec3>], parting: usize, reach: f64) -> bool {
    let skeleton = &clip.skeleton;
    let (carrier, parting) = (clip.facts.carrier.value, JointId(parting as u32));
    if skeleton.is_within(carrier, parting) {
        return true;
    }
    let height = |joint: JointId| mean_height(frames, joint.idx());
    let rides_on_floor = height(carrier) < clip.facts.floor + ON_FLOOR * clip.facts.height.value;
    let child = std::iter::successors(Some(parting), |&id| skeleton.joint(id).parent)
        .find(|&id| skeleton.joint(id).parent == Some(carrier));
    child.is_some_and(|child| {
        let pelvis = if rides_on_floor { child } else { carrier };
        height(parting) < height(pelvis) + TRUNK * reach
    })
}

/// Tells whether a joint on the way from a tip up to where its chain parts has the name of a part of an arm.
fn is_arm(skeleton: &Skeleton, tip: usize, parting: usize) -> bool {
    std::iter::successors(Some(tip), |&point| skeleton.point_parent(point))
        .take_while(|&point| point != parting)
        .any(|point| skeleton.joints().get(point).is_some_and(|joint| names::is_arm(&joint.name)))
}

/// Where a chain bends.
#[derive(Clone, Copy, Debug)]
struct Bends {
    hip: JointId,
    knee: JointId,
    ankle: JointId,
    /// Thigh and shin together, clip's unit.
    reach: f64,
}

/// Returns up to [`MOST_FRAMES`] frames' world points.
fn sample(clip: &Clip) -> Vec<Vec<DVec3>> {
    let step = clip.n_frames().div_ceil(MOST_FRAMES);
    (0..clip.n_frames())
        .step_by(step)
        .map(|frame| {
            let mut points = Vec::new();
            clip.world_points(frame, &mut points);
            points
        })
        .collect()
}

/// Returns the points on which nothing hangs.
fn tips(skeleton: &Skeleton) -> Vec<usize> {
    let mut is_tip = vec![true; skeleton.n_points()];
    for point in 0..skeleton.n_points() {
        if let Some(parent) = skeleton.point_parent(point) {
            is_tip[parent] = false;
        }
    }
    (0..skeleton.n_points()).filter(|&point| is_tip[point]).collect()
}

/// A bone of a chain: from a point to one that hangs on it.
#[derive(Clone, Copy, Debug)]
struct Bone {
    upper: usize,
    lower: usize,
    /// Clip's unit, positive.
    length: f64,
}

/// Returns the joint at which the ways to two points part, and the bones from there down to each, without bones of no
/// length; none for points of two trees.
fn parted(skeleton: &Skeleton, points: &[DVec3], a: usize, b: usize) -> Option<(usize, Vec<Bone>, Vec<Bone>)> {
    let up = |point: usize| -> Vec<usize> {
        std::iter::successors(Some(point), |&point| skeleton.point_parent(point)).collect()
    };
    let (mut a, mut b) = (up(a), up(b));
    let mut parting = None;
    while a.last() == b.last() && !a.is_empty() {
        parting = a.pop();
        b.pop();
    }
    let bones = |chain: &[usize]| -> Vec<Bone> {
        (chain.windows(2).rev())
            .map(|pair| Bone { upper: pair[1], lower: pair[0], length: points[pair[1]].distance(points[pair[0]]) })
            .filter(|bone| bone.length > 0.0)
            .collect()
    };
    Some((parting?, bones(&a), bones(&b)))
}

/// Tells whether two chains have bones of the same lengths.
fn alike(a: &[Bone], b: &[Bone]) -> bool {
    let alike = |(a, b): (&Bone, &Bone)| (a.length - b.length).abs() <= MIRRORED * a.length.max(b.length);
    a.len() == b.len() && a.iter().zip(b).all(alike)
}

/// Returns where the chains to two tips part and where they bend, if they mirror each other.
fn mirrored(skeleton: &Skeleton, points: &[DVec3], a: usize, b: usize) -> Option<(usize, [Bends; 2])> {
    let (parting, a, b) = parted(skeleton, points, a, b)?;
    if !alike(&a, &b) {
        return None;
    }
    // Thigh and shin: the two neighbours of which the shorter is longest.
    let shorter = |at: usize| a[at - 1].length.min(a[at].length);
    let at = (1..a.len()).max_by(|&i, &j| shorter(i).total_cmp(&shorter(j)))?;
    let bends = |bones: &[Bone]| {
        let (thigh, shin) = (bones[at - 1], bones[at]);
        (shin.lower < skeleton.n_joints()).then_some(Bends {
            hip: JointId(thigh.upper as u32),
            knee: JointId(shin.upper as u32),
            ankle: JointId(shin.lower as u32),
            reach: thigh.length + shin.length,
        })
    };
    Some((parting, [bends(&a)?, bends(&b)?]))
}

/// Tells whether the first leg is the left one: feet point forward, and where they say nothing, knees do.
fn first_is_left(frames: &[Vec<DVec3>], a: (Bends, usize), b: (Bends, usize)) -> bool {
    let forward_of = |points: &[DVec3], (leg, toe): (Bends, usize)| {
        let foot = points[toe] - points[leg.ankle.idx()];
        let knee = points[leg.knee.idx()] - 0.5 * (points[leg.hip.idx()] + points[leg.ankle.idx()]);
        if foot.x.hypot(foot.z) > 0.0 { foot } else { knee }
    };
    let score: f64 = (frames.iter())
        .map(|points| {
            let forward = forward_of(points, a) + forward_of(points, b);
            // Where the legs are as a whole: hips may be turned against the feet, feet may cross.
            let place = |leg: Bends| points[leg.hip.idx()] + points[leg.ankle.idx()];
            DVec3::Y.cross(forward).dot(place(a.0) - place(b.0))
        })
        .sum();
    score > 0.0
}
