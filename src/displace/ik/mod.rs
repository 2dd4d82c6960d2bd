//! Inverse kinematics for one pose: selected joints turn so that a point goes where it is wanted.
//!
//! ```text
//! chain:   top ──── … ──── last ──── point ┄┄▶ target      joints between that are not selected are stiff
//! ```
//!
//! Only positions matter here: a chain is its joints' places and the point's. One joint points at the target; two bend
//! the lower one about its hinge and turn the upper one, in closed form; more share the way by damped least squares.
//! A target that is out of reach is brought to the nearest place in reach, seen from the top of the chain.
//!
//! What comes out are turns on the right of local rotations, so they serve for the carrier too, which the path puts
//! where it is, and add up with displacement maps: `seen · turn` is the rotation to key.

mod chain;
mod damped;
mod hinge;

use glam::{DQuat, DVec3};

use chain::Chain;
pub use chain::{chain, point_position};
use hinge::across;
pub use hinge::usual_hinge;

use crate::{
    math::{Rigid, TwoBone, shortest_arc},
    skeleton::{JointId, Skeleton},
};

/// Bones shorter than this share of the chain are no bones: turning about their joints tells nothing.
const NO_BONE: f64 = 1e-6;

/// A share of the chain's length that is as good as nothing.
const NEAR: f64 = 1e-7;

/// A turn of a joint on the right of its local rotation.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct JointTurn {
    /// The joint.
    pub joint: JointId,
    /// Local rotation afterwards = local rotation before · this.
    pub turn: DQuat,
}

/// A point to be brought to a target by turning a chain of joints.
#[derive(Clone, Copy, Debug)]
pub struct Reach<'a> {
    /// World motions of all joints: the pose to start from. A drag starts each of its steps from the same pose, so that
    /// where it ends does not depend on the way.
    pub world: &'a [Rigid],
    /// Joints that may turn, top first, each below the one before; [`chain()`] finds them.
    pub chain: &'a [JointId],
    /// Where the point is in the world.
    pub point: DVec3,
    /// Where it should be in the world.
    pub target: DVec3,
    /// Axis in the upper joint's own space about which a chain of two usually bends ([`usual_hinge`]); it decides where
    /// the pose shows no bend.
    pub hinge: Option<DVec3>,
}

impl Reach<'_> {
    /// Returns how the joints turn, top first; empty when nothing can or need be done.
    pub fn turns(&self) -> Vec<JointTurn> {
        let mut chain = Chain::new(self);
        let length = chain.length();
        if chain.is_empty() || self.point == self.target || !self.target.is_finite() {
            return Vec::new();
        }
        let target = chain.within_reach(self.target);
        let hinge = self.hinge.map(|axis| self.world[self.chain[0].idx()].rotation * axis);
        match chain.bones() {
            [bone] => chain.turn_all(0, shortest_arc(*bone, target - chain.top)),
            &[upper, lower] => {
                let short = NO_BONE * length;
                if upper.length() > short && lower.length() > short {
                    bend(&mut chain, upper, lower, hinge, target);
                } else {
                    chain.turn_all(0, shortest_arc(upper + lower, target - chain.top));
                }
                // A hinge that is not quite across its bones cannot stretch them quite; the rest is shared.
                if chain.tip().distance(target) > NEAR * length {
                    damped::settle(&mut chain, target);
                }
            }
            _ => damped::reach(&mut chain, target, hinge),
        }
        chain.turns(self)
    }
}

/// Bends two bones at the joint between them and turns both about the top.
fn bend(chain: &mut Chain, upper: DVec3, lower: DVec3, usual: Option<DVec3>, target: DVec3) {
    let hinge = across(upper, lower, usual);
    let turns = TwoBone { thigh: upper, shin: lower, hinge, target: target - chain.top }.solve();
    chain.turn_all(1, turns.knee);
    chain.turn_all(0, turns.hip);
}

/// Returns the world motions of all joints after turns; joints that nothing above them turns keep every bit.
pub fn turned_world(skeleton: &Skeleton, world: &[Rigid], turns: &[JointTurn]) -> Vec<Rigid> {
    let mut out: Vec<Rigid> = Vec::with_capacity(world.len());
    for (idx, joint) in skeleton.joints().iter().enumerate() {
        let mut moved = match joint.parent.map(JointId::idx) {
            Some(parent) if out[parent] != world[parent] => out[parent] * (world[parent].inverse() * world[idx]),
            _ => world[idx],
        };
        if let Some(turn) = turns.iter().find(|turn| turn.joint.idx() == idx) {
            moved.rotation *= turn.turn;
        }
        out.push(moved);
    }
    out
}

/// Returns the turn, on the right of a joint's local rotation, that turns it about an axis through itself.
///
/// `world` is the joint's world rotation, `axis` a unit axis in the world: for the joint's own axes rotate them by
/// `world` first, for its parent's by the parent's world rotation.
pub fn turn_about(world: DQuat, axis: DVec3, angle_rad: f64) -> DQuat {
    DQuat::from_axis_angle((world.conjugate() * axis).normalize(), angle_rad)
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;
    use crate::{
        displace::sample::{FREE, STIFF, Sample},
        skeleton::Joint,
    };

    /// A limb of joints one below the other, posed; the point is the end site of the last one.
    #[derive(Clone, Debug)]
    struct Limb {
        skeleton: Skeleton,
        world: Vec<Rigid>,
    }

    impl Limb {
        fn new(offsets: &[DVec3], turns: &[DQuat]) -> Self {
            let n = turns.len();
            let joint = |idx: usize| Joint {
                name: format!("j{idx}"),
                parent: idx.checked_sub(1).map(|parent| JointId(parent as u32)),
                offset: offsets[idx],
                end_site: (idx + 1 == n).then_some(offsets[n]),
            };
            let skeleton = Skeleton::new((0..n).map(joint).collect());
            let mut world: Vec<Rigid> = Vec::new();
            for idx in 0..n {
                let parent = world.last().copied().unwrap_or(Rigid::IDENTITY);
                world.push(parent * Rigid::new(turns[idx], offsets[idx]));
            }
            Self { skeleton, world }
        }

        fn straight(bones: &[f64]) -> Self {
            let offsets: Vec<_> = std::iter::once(0.0).chain(bones.iter().copied()).map(|b| DVec3::X * b).collect();
            Self::new(&offsets, &vec![DQuat::IDENTITY; bones.len()])
        }

        fn place(&self, world: &[Rigid]) -> DVec3 {
            point_position(&self.skeleton, world, self.skeleton.n_joints())
        }

        fn places(&self, chain: &[JointId]) -> Vec<DVec3> {
            let joints = chain.iter().map(|joint| self.world[joint.idx()].translation);
            joints.chain([self.place(&self.world)]).collect()
        }

        fn turns(&self, chain: &[JointId], target: DVec3) -> Vec<JointTurn> {
            Reach { world: &self.world, chain, point: self.place(&self.world), target, hinge: None }.turns()
        }

        /// Solves, checks what must hold whatever is asked, and returns where the point ended up.
        #[track_caller]
        fn check(&self, chain: &[JointId], target: DVec3) -> DVec3 {
            let turns = self.turns(chain, target);
            assert!(turns.iter().all(|turn| chain.contains(&turn.joint)), "only what is selected turns");
            assert!(turns.iter().all(|turn| turn.turn.is_finite() && (turn.turn.length() - 1.0).abs() < 1e-12));
            let places = self.places(chain);
            let bones: Vec<f64> = places.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
            let length: f64 = bones.iter().sum();
            let longest = bones.iter().copied().fold(0.0, f64::max);
            let way = target - places[0];
            let reached = self.place(&turned_world(&self.skeleton, &self.world, &turns));
            let nearest = way.length().clamp((2.0 * longest - length).max(0.0), length);
            let left = reached.distance(target);
            let least = (nearest - way.length()).abs();
            assert!(left <= least + 1e-5 * length, "{left:e} away, {least:e} would do, length {length}");
            reached
        }
    }

    fn ids(joints: &[u32]) -> Vec<JointId> {
        joints.iter().copied().map(JointId).collect()
    }

    fn vector(size: f64) -> impl Strategy<Value = DVec3> {
        prop::array::uniform3(-size..size).prop_map(DVec3::from_array)
    }

    fn any_limb() -> impl Strategy<Value = (Limb, Vec<JointId>)> {
        let joint = (vector(1.0), vector(3.0), any::<bool>(), prop::sample::select(vec![0.0, 1e-9, 1.0, 1.0, 1.0]));
        (prop::collection::vec(joint, 1..8), vector(1.0)).prop_map(|(joints, site)| {
            let offsets: Vec<_> = joints.iter().map(|j| j.0 * j.3).chain([site]).collect();
            let turns: Vec<_> = joints.iter().map(|j| DQuat::from_scaled_axis(j.1)).collect();
            let chain = (0..).zip(&joints).filter(|(_, j)| j.2).map(|(idx, _)| JointId(idx)).collect();
            (Limb::new(&offsets, &turns), chain)
        })
    }

    proptest! {
        #[test]
        fn a_point_gets_to_its_target_or_as_near_as_can_be((limb, chain) in any_limb(), target in vector(4.0)) {
            if !chain.is_empty() {
                limb.check(&chain, target);
            }
        }

        #[test]
        fn small_moves_are_small_turns((limb, chain) in any_limb(), by in vector(1e-4)) {
            let places = limb.places(&chain);
            let length: f64 = places.windows(2).map(|pair| pair[0].distance(pair[1])).sum();
            // Near full reach, or on one line, a small move takes a turn that goes with its root.
            let is_bent = places.windows(3).any(|p| (p[1] - p[0]).cross(p[2] - p[1]).length() > 0.05);
            if chain.len() > 1 && is_bent && length > 0.5 {
                for turn in limb.turns(&chain, places[places.len() - 1] + by) {
                    prop_assert!(turn.turn.xyz().length() < 0.1, "{}", turn.turn);
                }
            }
        }
    }

    #[test]
    fn the_same_under_any_world() {
        let offsets =
            [[0.0; 3], [0.1, -1.0, 0.2], [0.0, -0.9, -0.3], [0.2, -0.8, 0.1], [0.0, -0.3, 0.4]].map(DVec3::from_array);
        let turns = [0.3, -0.4, 0.5, 0.2].map(|angle| DQuat::from_scaled_axis(DVec3::new(angle, 0.5 * angle, -0.1)));
        let limb = Limb::new(&offsets, &turns);
        for chain in [ids(&[0]), ids(&[1, 2]), ids(&[0, 3]), ids(&[0, 1, 3]), ids(&[0, 1, 2, 3])] {
            for target in [[0.5, -1.5, 0.5], [0.1, -0.4, 0.0], [3.0, 3.0, 3.0]].map(DVec3::from_array) {
                let expected = limb.turns(&chain, target);
                for (yaw, tilt, at) in
                    [(1.0, 0.0, 3.0), (0.0, 2.0, -5.0), (-2.5, 0.7, 1e3), (3.1, 3.1, 0.0), (4.0, -1.2, 7.0)]
                {
                    let rotation = DQuat::from_rotation_y(yaw) * DQuat::from_rotation_x(tilt);
                    let world = Rigid::new(rotation, DVec3::new(at, -at, 0.5 * at));
                    let moved = Limb { world: limb.world.iter().map(|&r| world * r).collect(), ..limb.clone() };
                    for (turn, want) in moved.turns(&chain, world.point(target)).iter().zip(&expected) {
                        assert!((turn.turn.dot(want.turn).abs() - 1.0).abs() < 1e-9, "{chain:?} {target}");
                    }
                }
            }
        }
    }

    #[test]
    fn a_target_that_goes_past_full_reach_gives_smooth_turns() {
        const STEP: f64 = 1e-3;
        let bent = |n: usize| {
            let offsets: Vec<_> =
                std::iter::once(DVec3::ZERO).chain(std::iter::repeat_n(DVec3::X / n as f64, n)).collect();
            let turns: Vec<_> =
                (0..n).map(|i| DQuat::from_rotation_z(if i == 0 { -0.5 } else { 1.0 / n as f64 })).collect();
            Limb::new(&offsets, &turns)
        };
        for n in [1, 2, 3, 4, 7] {
            let (limb, chain) = (bent(n), (0..n as u32).map(JointId).collect::<Vec<_>>());
            let mut before: Option<Vec<JointTurn>> = None;
            let mut jitter = 0.0f64;
            let mut last_steps: Vec<Option<f64>> = vec![None; n];
            for i in 0..600u32 {
                // Out through full reach at 1, past it, and to the side there.
                let out = 0.8 + STEP * f64::from(i.min(400));
                let aside = STEP * f64::from(i.saturating_sub(400));
                let turns = limb.turns(&chain, DVec3::new(out, 0.0, aside));
                if let Some(before) = before {
                    for (joint, (a, b)) in before.iter().zip(&turns).enumerate() {
                        let step = 2.0 * (a.turn.conjugate() * b.turn).xyz().length();
                        // A chain straightens with the root of what is left, two of its bones sometimes for all.
                        assert!(step < 6.0 * STEP.sqrt(), "{n} joints: joint {joint} jumps by {step} at {out} {aside}");
                        if let Some(last) = last_steps[joint].filter(|_| !(0.99..1.01).contains(&out)) {
                            jitter = jitter.max((step - last).abs());
                        }
                        last_steps[joint] = Some(step);
                    }
                }
                before = Some(turns);
            }
            assert!(jitter < 2e-3, "{n} joints: {jitter:e}");
        }
    }

    #[test]
    fn a_straight_limb_bends_about_its_usual_hinge_and_is_left_alone_at_its_place() {
        for bones in [&[1.0, 0.8][..], &[2.3, 1.9], &[0.5, 0.4, 0.6], &[0.3, 0.0, 0.4, 0.5]] {
            let limb = Limb::straight(bones);
            let chain: Vec<_> = limb.skeleton.ids().collect();
            let point = limb.place(&limb.world);
            assert_eq!(limb.turns(&chain, point), []);
            limb.check(&chain, point * 0.7);
            limb.check(&chain, DVec3::new(0.1, 0.2, -0.9));
            limb.check(&chain, -point);
            for side in [1.0, -1.0] {
                let hinge = Some(DVec3::Y * side);
                let turns = Reach { world: &limb.world, chain: &chain, point, target: point * 0.8, hinge }.turns();
                let world = turned_world(&limb.skeleton, &limb.world, &turns);
                assert!(limb.place(&world).distance(point * 0.8) < 1e-6);
                assert!(world.iter().all(|joint| joint.translation.y.abs() < 1e-9), "it bends in its plane");
                // A turn about Y takes what follows from X to −Z, so the elbow goes to the other side.
                let elbow = world
                    .iter()
                    .map(|joint| joint.translation.z)
                    .fold(0.0, |a: f64, b| if b.abs() > a.abs() { b } else { a });
                assert!(elbow * side > 0.1, "{bones:?} {side}: {elbow}");
            }
        }
    }

    /// It was left with a bend that took too many corrections to go.
    #[test]
    fn a_limb_with_a_short_bone_is_stretched_in_full() {
        let offsets =
            [[0.0; 3], [0.0; 3], [-0.815_925_8, 0.0, 0.187_309_8], [0.0, 0.0, -0.045_386_2], [0.0, -0.776_132_8, 0.0]];
        let mut limb = Limb::new(&offsets.map(DVec3::from_array), &[DQuat::IDENTITY; 4]);
        let turned = |x, y, z, w| DQuat::from_xyzw(x, y, z, w).normalize();
        let (first, last) =
            (turned(0.7470786, 0.0, 0.0, 0.6647358), turned(-0.2006917, -0.5384341, 0.4790880, 0.6635407));
        limb.world[1].rotation = first;
        for (idx, rotation) in [(2, last), (3, last)] {
            let above = limb.world[idx - 1];
            limb.world[idx] = Rigid::new(rotation, above.point(DVec3::from_array(offsets[idx])));
        }
        for far in [1.5, 1.6, 1.65, 1.6589, 2.64, 50.0] {
            limb.check(&ids(&[1, 2, 3]), DVec3::Z * far);
        }
    }

    #[test]
    fn joints_in_one_place_share_and_do_not_jitter() {
        let offsets = [DVec3::ZERO, DVec3::ZERO, DVec3::X, DVec3::ZERO, DVec3::X, DVec3::ZERO];
        let turns = [0.2, 0.1, 0.4, -0.2, 0.3].map(DQuat::from_rotation_z);
        let limb = Limb::new(&offsets, &turns);
        for chain in [ids(&[0, 1]), ids(&[0, 1, 2, 3, 4]), ids(&[2, 3]), ids(&[3, 4]), ids(&[4])] {
            let mut before: Option<Vec<JointTurn>> = None;
            for i in 0..200 {
                let angle = 0.3 + 0.005 * i as f64;
                let target = DVec3::new(1.4 * angle.cos(), 1.4 * angle.sin(), 0.3);
                if chain[0] != JointId(4) {
                    limb.check(&chain, target);
                }
                let turns = limb.turns(&chain, target);
                if let Some(before) = before {
                    for (a, b) in before.iter().zip(&turns) {
                        assert!((a.turn.conjugate() * b.turn).xyz().length() < 0.02, "{chain:?} at {angle}");
                    }
                }
                before = Some(turns);
            }
        }
        assert_eq!(limb.turns(&ids(&[4]), DVec3::Y), [], "nothing hangs on it");
        assert_eq!(limb.turns(&[], DVec3::Y), []);
    }

    #[test]
    fn a_knee_keeps_its_plane() {
        let clip = Sample::default().clip();
        let mut world = Vec::new();
        clip.world_rigids(30, &mut world);
        let elbow = chain(&clip, 5, &[FREE[2], FREE[3], FREE[4]]);
        assert_eq!(elbow, [FREE[2], FREE[3]], "the wrist does not move itself");
        let point = point_position(&clip.skeleton, &world, 5);
        let target = point + DVec3::new(0.1, -0.2, 0.05);
        let hinge = usual_hinge(&clip, &elbow, 5);
        assert!(hinge.is_some_and(|axis| axis.is_normalized()));
        let turns = Reach { world: &world, chain: &elbow, point, target, hinge }.turns();
        let after = turned_world(&clip.skeleton, &world, &turns);
        assert!(after[5].translation.distance(target) < 1e-6);
        // The lower joint turns about the normal of the plane that both bones were in, as its usual hinge tilts it.
        let normal = (world[4].translation - world[3].translation).cross(point - world[4].translation).normalize();
        let axis = (world[4].rotation * turns[1].turn.xyz()).normalize();
        assert!(axis.dot(normal).abs() > 0.99, "{axis} {normal}");
        // What is above the chain or beside it keeps every bit.
        assert_eq!(after[..3], world[..3]);
    }

    #[test]
    fn chains_leave_out_what_cannot_turn() {
        let clip = Sample::default().clip();
        let every: Vec<JointId> = clip.skeleton.ids().collect();
        let site = clip.skeleton.n_joints();
        assert_eq!(chain(&clip, site, &every), FREE, "neither the root above the carrier nor the stiff joint");
        assert_eq!(chain(&clip, STIFF.idx(), &[FREE[0], FREE[4]]), [FREE[0], FREE[4]]);
        assert_eq!(chain(&clip, FREE[0].idx(), &every), []);
        assert_eq!(usual_hinge(&clip, &every, site), None);
    }

    #[test]
    fn turning_about_world_and_own_axes() {
        let world = DQuat::from_rotation_z(0.7) * DQuat::from_rotation_x(0.4);
        let about_up = world * turn_about(world, DVec3::Y, 0.5);
        assert!(about_up.abs_diff_eq(DQuat::from_rotation_y(0.5) * world, 1e-14));
        let about_own = turn_about(world, world * DVec3::X, 0.5);
        assert!(about_own.abs_diff_eq(DQuat::from_rotation_x(0.5), 1e-14));
    }
}
