//! Legs by shape: two mirrored chains that end lowest.

use glam::DVec3;

use super::{Leg, Side, toe_below};
use crate::{
    motion::Clip,
    skeleton::{JointId, Skeleton},
};

/// Mirrored bones differ in length by at most this share.
const MIRRORED: f64 = 0.1;

/// Thigh and shin together are at least this share of the body height.
const SHORTEST: f64 = 0.2;

/// How many of the lowest tips are looked at.
const MOST_TIPS: usize = 16;

/// Frames looked at, evenly spread.
const MOST_FRAMES: usize = 64;

/// Returns the two legs, or none.
pub(super) fn legs(clip: &Clip) -> Vec<Leg> {
    let skeleton = &clip.skeleton;
    let frames = sample(clip);
    let mean_height = |point: usize| frames.iter().map(|points| points[point].y).sum::<f64>() / frames.len() as f64;
    let mut tips = tips(skeleton);
    tips.sort_by(|&a, &b| mean_height(a).total_cmp(&mean_height(b)));
    tips.truncate(MOST_TIPS);

    let mut found: Option<(f64, [Bends; 2])> = None;
    for (at, &a) in tips.iter().enumerate() {
        for &b in &tips[at + 1..] {
            let Some(pair) = mirrored(skeleton, &frames[0], a, b) else { continue };
            let long_enough = pair.iter().all(|leg| leg.reach >= SHORTEST * clip.facts.height.value);
            let hangs = |leg: &Bends| mean_height(leg.hip.idx()) - mean_height(leg.ankle.idx()) > 0.5 * leg.reach;
            let ends_at: f64 = pair.iter().map(|leg| mean_height(leg.ankle.idx())).sum();
            if long_enough && pair.iter().all(hangs) && found.as_ref().is_none_or(|(lowest, _)| ends_at < *lowest) {
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

/// Returns the bends of the chains from where they part to two tips, if the chains mirror each other.
fn mirrored(skeleton: &Skeleton, points: &[DVec3], a: usize, b: usize) -> Option<[Bends; 2]> {
    let up = |tip: usize| -> Vec<usize> {
        std::iter::successors(Some(tip), |&point| skeleton.point_parent(point)).collect()
    };
    let (mut a, mut b) = (up(a), up(b));
    while a.last() == b.last() && !a.is_empty() {
        a.pop();
        b.pop();
    }
    let bones = |chain: &[usize]| -> Vec<(usize, usize, f64)> {
        // From the body down, without bones of no length.
        (chain.windows(2).rev().map(|pair| (pair[1], pair[0], points[pair[1]].distance(points[pair[0]]))))
            .filter(|bone| bone.2 > 0.0)
            .collect()
    };
    let (a, b) = (bones(&a), bones(&b));
    let alike = |x: f64, y: f64| (x - y).abs() <= MIRRORED * x.max(y);
    if a.len() != b.len() || !a.iter().zip(&b).all(|(x, y)| alike(x.2, y.2)) {
        return None;
    }
    // Thigh and shin: the two neighbours of which the shorter is longest.
    let at = (1..a.len()).max_by(|&i, &j| a[i - 1].2.min(a[i].2).total_cmp(&a[j - 1].2.min(a[j].2)))?;
    let bends = |bones: &[(usize, usize, f64)]| {
        let (hip, knee, ankle) = (bones[at - 1].0, bones[at].0, bones[at].1);
        (ankle < skeleton.n_joints()).then(|| Bends {
            hip: JointId(hip as u32),
            knee: JointId(knee as u32),
            ankle: JointId(ankle as u32),
            reach: bones[at - 1].2 + bones[at].2,
        })
    };
    Some([bends(&a)?, bends(&b)?])
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
            DVec3::Y.cross(forward).dot(points[a.0.hip.idx()] - points[b.0.hip.idx()])
        })
        .sum();
    score > 0.0
}
