//! `Join`: a longer clip that repeats a range of another.

use std::sync::Arc;

use glam::{DQuat, DVec3};

use super::{
    LoopRange,
    along::Along,
    spread::{Jump, Shares, Window},
};
use crate::{
    contact::GroundSlope,
    math::{Rigid, heading_rotation},
    motion::{Clip, EditedClip, TurnedJoint},
    path::{PathFrame, ResidualFrame},
    skeleton::JointId,
};

/// A clip, the range of it to repeat, and how.
#[derive(Clone, Copy, Debug)]
pub struct Join<'a> {
    /// The clip; one whose path can be edited.
    pub clip: &'a Arc<Clip>,
    /// Its carrier, world.
    pub carrier: &'a [Rigid],
    /// Frames of the path fitted to it.
    pub path: &'a [PathFrame],
    /// Arc length of each frame on that path, the clip's unit.
    pub progress: &'a [f64],
    /// How the ground under the clip slopes.
    pub ground: GroundSlope,
    /// The range; two frames at least.
    pub range: LoopRange,
    /// Time on each side of a seam over which its mismatch is spread, seconds; at most half of the range is taken.
    pub blend_secs: f64,
    /// How often the range is shown again after the first time.
    pub n_cycles: usize,
}

/// A clip joined to itself.
#[derive(Clone, Debug)]
pub struct Joined {
    /// The long clip, rest frames included.
    pub clip: Arc<Clip>,
    /// Frame of the original clip that each frame shows.
    pub source_frames: Vec<u32>,
    /// The long clip's carrier, world.
    pub carrier: Vec<Rigid>,
    /// The original path's frames carried on, world.
    pub path: Vec<PathFrame>,
    /// Arc length of each frame on that path, the clip's unit; never falls.
    pub progress: Vec<f64>,
    /// Joints below the carrier that turn otherwise than in the frames they show.
    pub turned: Vec<TurnedJoint>,
    /// First frame of each new cycle.
    pub seams: Vec<usize>,
    /// Frames on each side of a seam over which its mismatch is spread.
    pub n_spread: usize,
}

impl Join<'_> {
    /// Returns the arc length of one cycle, the clip's unit.
    pub fn period(&self) -> f64 {
        let along = Along::new(self.path, self.progress);
        along.progress(self.range.end) - along.progress(self.range.first)
    }

    /// Joins the clip; without cycles it is the clip itself.
    ///
    /// Frames do not depend on how many cycles follow them.
    ///
    /// # Panics
    ///
    /// When the lists have not the clip's frames, the range has fewer than two frames or ends beyond the clip, or there
    /// are cycles and the clip's path cannot be edited.
    pub fn joined(&self) -> Joined {
        let n_frames = self.clip.n_frames();
        assert!(self.carrier.len() == n_frames && self.path.len() == n_frames, "the clip's frames");
        if self.n_cycles == 0 {
            return Joined {
                clip: Arc::clone(self.clip),
                source_frames: (0..n_frames as u32).collect(),
                carrier: self.carrier.to_vec(),
                path: self.path.to_vec(),
                progress: self.progress.to_vec(),
                turned: Vec::new(),
                seams: Vec::new(),
                n_spread: 0,
            };
        }
        let LoopRange { first, end } = self.range;
        assert!(first + 2 <= end && end <= n_frames, "a range of two frames within the clip");
        let shown: Vec<Shown> = (0..=self.n_cycles).flat_map(|copy| self.shown(copy)).collect();
        let (path, progress) = self.carried_on(&shown);
        let carrier = self.carried_along(&shown, &path);
        let turned: Vec<TurnedJoint> = (self.joints_to_spread())
            .map(|joint| TurnedJoint { joint, rotations: self.rotations(joint, &shown) })
            .collect();
        let source_frames: Vec<u32> = shown.iter().map(|at| at.frame as u32).collect();
        let as_edit = EditedClip { clip: Arc::clone(self.clip), source_frames, carrier_world: carrier, turned };
        let clip = Arc::new(Clip::rearranged(&as_edit));
        let EditedClip { source_frames, carrier_world: carrier, turned, .. } = as_edit;
        let seams = (0..self.n_cycles).map(|copy| end + copy * self.range.n_frames()).collect();
        let n_spread = self.window().n_frames;
        Joined { clip, source_frames, carrier, path, progress, turned, seams, n_spread }
    }

    /// Lists the frames of one copy; copy 0 is the clip up to the range's end.
    fn shown(&self, copy: usize) -> impl Iterator<Item = Shown> + use<> {
        let LoopRange { first, end } = self.range;
        let window = self.window();
        (if copy == 0 { 0 } else { first }..end).map(move |frame| {
            // The halves of a cycle are near different seams, so a frame takes on shares of one at most.
            let before = window.at(frame as i64 - end as i64);
            let shares = if copy == 0 { before } else { before.or(window.at(frame as i64 - first as i64)) };
            Shown { copy, frame, shares }
        })
    }

    fn window(&self) -> Window {
        let n_frames = (self.blend_secs / self.clip.frame_time_secs).round().max(0.0) as usize;
        Window { n_frames: n_frames.min(self.range.n_frames() / 2) }
    }

    /// Returns what a signal does at the seam: before it, where the range ends, and after it, where it begins.
    fn ends<T: Copy>(&self, at: impl Fn(usize) -> T, go_on: impl Fn(T, T) -> T) -> [[T; 2]; 2] {
        let n_frames = self.clip.n_frames();
        let pair = |frame: usize| match frame {
            0 => [go_on(at(1), at(0)), at(0)],
            f if f < n_frames => [at(f - 1), at(f)],
            f => [at(f - 1), go_on(at(f - 2), at(f - 1))],
        };
        [pair(self.range.end), pair(self.range.first)]
    }

    fn jump(&self, at: impl Fn(usize) -> f64) -> Jump<f64> {
        let [before, after] = self.ends(at, |from, to| 2.0 * to - from);
        Jump { value: after[1] - before[1], rate: (after[1] - after[0]) - (before[1] - before[0]) }
    }

    /// Carries path and arc lengths on: copies chained so that each begins in the path frame in which the one before
    /// ends, with the jumps in speed, in turning and in slope spread.
    ///
    /// In height each begins where the ground has it. A fitted path rises and falls with the body and wavers; what it does
    /// so over one cycle would lift every copy higher than the one before. That jump is spread as well.
    fn carried_on(&self, shown: &[Shown]) -> (Vec<PathFrame>, Vec<f64>) {
        let along = Along::new(self.path, self.progress);
        let LoopRange { first, end } = self.range;
        let [from, to] = [first, end].map(|frame| along.frame(frame));
        let (period, turn) = (self.period(), to.heading_rad - from.heading_rad);
        let speed = Jump { value: 0.0, ..self.jump(|f| self.progress[f]) };
        let turning = Jump { value: 0.0, ..self.jump(|f| self.path[f].heading_rad) };
        let slope = self.jump(|f| self.path[f].slope_rad);
        let [before, after] = self.ends(|f| self.path[f].point, |from, to| 2.0 * to - from);
        let level = |at: PathFrame, step: DVec3| heading_rotation(-at.heading_rad) * step;
        let velocity: Jump<DVec3> =
            Jump { value: DVec3::ZERO, rate: level(from, after[1] - after[0]) - level(to, before[1] - before[0]) };

        let climb = self.ground.climb(to.point - from.point);
        let height = Jump { value: from.point.y + climb - to.point.y, rate: 0.0 };

        // Where copy `c` of the first frame's path frame stands: each where the one before has the range's end.
        let mut points = vec![from.point];
        for copy in 0..self.n_cycles {
            let way = (to.point - from.point).with_y(climb);
            points.push(points[copy] + heading_rotation(copy as f64 * turn) * way);
        }
        let mut furthest = 0.0f64;
        let carried = |&Shown { copy, frame, shares }: &Shown| {
            let at = self.path[frame];
            let turned = copy as f64 * turn;
            let mut on = PathFrame {
                point: points[copy] + heading_rotation(turned) * (at.point - from.point),
                heading_rad: at.heading_rad + turned,
                slope_rad: at.slope_rad,
            };
            let mut progress = self.progress[frame] + copy as f64 * period;
            if copy == 0 {
                on.point = at.point;
            }
            if let Some(shares) = shares {
                let at_seam = if shares.value > 0.0 { to.heading_rad } else { from.heading_rad };
                on.point += heading_rotation(at_seam + turned) * velocity.share(shares);
                on.point.y += height.share(shares);
                on.heading_rad += turning.share(shares);
                on.slope_rad += slope.share(shares);
                progress += speed.share(shares);
            }
            furthest = furthest.max(progress);
            (on, furthest)
        };
        shown.iter().map(carried).unzip()
    }

    /// Carries the residual of each frame shown along the path, with its jumps spread.
    fn carried_along(&self, shown: &[Shown], path: &[PathFrame]) -> Vec<Rigid> {
        let residual = |f: usize| self.path[f].rigid(ResidualFrame::Heading).inverse() * self.carrier[f];
        let [before, after] = self.ends(|f| residual(f).translation, |from, to| 2.0 * to - from);
        let places = Jump::of_places(before, after);
        let [before, after] = self.ends(|f| residual(f).rotation, turn_on);
        let turns = Jump::of_rotations(before, after);
        let carried = |(&Shown { copy, frame, shares }, on): (&Shown, &PathFrame)| {
            if copy == 0 && shares.is_none() {
                return self.carrier[frame];
            }
            let mut residual = residual(frame);
            if let Some(shares) = shares {
                residual.translation += places.share(shares);
                residual.rotation = turned(residual.rotation, turns.share(shares));
            }
            on.rigid(ResidualFrame::Heading) * residual
        };
        shown.iter().zip(path).map(carried).collect()
    }

    /// Lists the joints whose mismatch can be spread: below the carrier, and free to turn.
    fn joints_to_spread(&self) -> impl Iterator<Item = JointId> {
        let carrier = self.clip.facts.carrier.value;
        let within = self.clip.skeleton.subtree(carrier);
        let free =
            move |&joint: &JointId| joint != carrier && within[joint.idx()] && self.clip.turns_freely(joint.idx());
        self.clip.skeleton.ids().filter(free)
    }

    fn rotations(&self, joint: JointId, shown: &[Shown]) -> Vec<DQuat> {
        let local = |f: usize| self.clip.rotations(f)[joint.idx()];
        let [before, after] = self.ends(local, turn_on);
        let jump = Jump::of_rotations(before, after);
        let rotation = |at: &Shown| match at.shares {
            Some(shares) => turned(local(at.frame), jump.share(shares)),
            None => local(at.frame),
        };
        shown.iter().map(rotation).collect()
    }
}

/// A frame of the joined clip.
#[derive(Clone, Copy, Debug)]
struct Shown {
    /// How many cycles lie before it.
    copy: usize,
    /// The clip's frame.
    frame: usize,
    /// What it takes on of the jumps at the seam nearby.
    shares: Option<Shares>,
}

fn turned(rotation: DQuat, vector: DVec3) -> DQuat {
    (rotation * DQuat::from_scaled_axis(vector)).normalize()
}

/// Turns on as from one rotation to the next.
fn turn_on(from: DQuat, to: DQuat) -> DQuat {
    (to * (from.conjugate() * to)).normalize()
}
