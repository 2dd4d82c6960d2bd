//! One frame's channels from the trunk and the feet: legs by the cosine rule, arms against the legs.

use glam::{DMat3, DVec3};

use super::{
    Side,
    carriage::TrunkPose,
    course::forward,
    figure::{N_JOINTS, ROOT_TO_HIP, Row, SHANK, THIGH},
    foot::FootPose,
};

/// The chest turns against the pelvis: this share of the pelvis's turn, the other way.
const CHEST_COUNTER_TURN: f64 = 0.9;

/// Of the pelvis's roll this much is left in the chest.
const CHEST_ROLL: f64 = -0.15;

/// Shoulder ahead on average in walking, and to either side of that (Perry & Burnfield: 8° ahead to 24° behind).
const ARM_SWING_RAD: (f64, f64) = (-0.10, 0.28);

/// Arms hang away from the body.
const ARM_OUT_RAD: f64 = 0.10;

/// Forearms turn in.
const ARM_IN_TURN_RAD: f64 = 0.25;

/// Elbow bent standing, more of it walking, and more again when the arm is ahead.
const ELBOW_RAD: (f64, f64, f64) = (0.20, 0.20, 0.18);

/// The head nods down a little, wherever the trunk leans.
const NOD_RAD: f64 = 0.04;

/// All joints' local rotations and the root's place.
pub(super) struct Body {
    root: DVec3,
    /// In the order of the file.
    locals: [DMat3; N_JOINTS],
}

impl Body {
    /// Puts the body between its trunk and its feet, left first.
    pub(super) fn at(trunk: &TrunkPose, feet: [FootPose; 2]) -> Self {
        let pelvis = oriented(trunk.heading_rad + trunk.pelvis_turn_rad, trunk.pelvis_roll_rad, 0.5 * trunk.lean_rad);
        let chest = oriented(
            trunk.heading_rad - CHEST_COUNTER_TURN * trunk.pelvis_turn_rad,
            CHEST_ROLL * trunk.pelvis_roll_rad,
            trunk.lean_rad,
        );
        let head = oriented(trunk.gaze_rad, 0.0, NOD_RAD);
        let root = trunk.hips_centre + pelvis * DVec3::new(0.0, ROOT_TO_HIP.1, 0.0);

        let (spine, neck) = (halfway(pelvis, chest), halfway(chest, head));
        let mut locals = [DMat3::IDENTITY; N_JOINTS];
        locals[0] = pelvis;
        locals[1] = pelvis.transpose() * spine;
        locals[2] = spine.transpose() * chest;
        locals[3] = chest.transpose() * neck;
        locals[4] = neck.transpose() * head;
        for (side, first) in [(Side::Left, 5), (Side::Right, 9)] {
            locals[first + 1..=first + 2].copy_from_slice(&arm(side, trunk));
        }
        for (side, first, foot) in [(Side::Left, 13, &feet[0]), (Side::Right, 17, &feet[1])] {
            let hip = root + pelvis * DVec3::new(side.sign() * ROOT_TO_HIP.0, -ROOT_TO_HIP.1, 0.0);
            let leg = Leg { hip, foot, pelvis, heading_rad: trunk.heading_rad + trunk.pelvis_turn_rad };
            locals[first..first + 4].copy_from_slice(&leg.locals());
        }
        Self { root, locals }
    }

    /// Returns the row of the file: place, then ZXY degrees of each joint.
    pub(super) fn channels(&self) -> Row {
        let mut row = [0.0; 3 + 3 * N_JOINTS];
        row[..3].copy_from_slice(&self.root.to_array());
        for (angles, local) in row[3..].chunks_exact_mut(3).zip(&self.locals) {
            angles.copy_from_slice(&zxy_rad(local).map(f64::to_degrees));
        }
        row
    }
}

/// Turned by a heading, then rolled left side up, then leaned forward.
fn oriented(heading_rad: f64, roll_rad: f64, lean_rad: f64) -> DMat3 {
    DMat3::from_rotation_y(heading_rad) * DMat3::from_rotation_z(roll_rad) * DMat3::from_rotation_x(lean_rad)
}

/// The orientation midway between two.
fn halfway(a: DMat3, b: DMat3) -> DMat3 {
    DMat3::from_quat(glam::DQuat::from_mat3(&a).slerp(glam::DQuat::from_mat3(&b), 0.5))
}

/// Local rotations of shoulder and elbow; each arm goes with the other side's leg.
fn arm(side: Side, trunk: &TrunkPose) -> [DMat3; 2] {
    let ahead = side.sign() * trunk.arm_stagger;
    let (rest, swing) = ARM_SWING_RAD;
    let (standing, walking, bending) = ELBOW_RAD;
    let shoulder = DMat3::from_rotation_z(side.sign() * ARM_OUT_RAD)
        * DMat3::from_rotation_x(-(rest * trunk.speed + swing * ahead))
        * DMat3::from_rotation_y(-side.sign() * ARM_IN_TURN_RAD);
    let elbow = DMat3::from_rotation_x(-(standing + walking * trunk.speed + bending * ahead));
    [shoulder, elbow]
}

/// A leg between a hip and a foot that are where they are.
struct Leg<'a> {
    hip: DVec3,
    foot: &'a FootPose,
    pelvis: DMat3,
    heading_rad: f64,
}

impl Leg<'_> {
    /// Local rotations of hip, knee, ankle and toes.
    ///
    /// The cosine rule gives the angles at hip and ankle of the triangle hip, knee, ankle; the knee lies in the plane
    /// of the leg and the direction midway between pelvis and foot, in front.
    fn locals(&self) -> [DMat3; 4] {
        let down = self.foot.ankle - self.hip;
        let reach = down.length().clamp((THIGH - SHANK).abs() + 1e-9, THIGH + SHANK);
        let up = -down.normalize();
        let side = up.cross(forward(0.5 * (self.heading_rad + self.foot.yaw_rad))).normalize();
        let plane = DMat3::from_cols(side, up, side.cross(up));

        let at_hip = angle_between(THIGH, reach, SHANK);
        let at_ankle = angle_between(SHANK, reach, THIGH);
        let thigh = plane * DMat3::from_rotation_x(-at_hip);
        let shank = plane * DMat3::from_rotation_x(at_ankle);
        [
            self.pelvis.transpose() * thigh,
            DMat3::from_rotation_x(at_hip + at_ankle),
            shank.transpose() * self.foot.rotation,
            DMat3::from_rotation_x(-self.foot.toe_pitch_rad),
        ]
    }
}

/// The angle between two sides of a triangle, opposite the third.
fn angle_between(a: f64, b: f64, opposite: f64) -> f64 {
    ((a * a + b * b - opposite * opposite) / (2.0 * a * b)).clamp(-1.0, 1.0).acos()
}

/// Angles about z, x and y whose product, in this order, is the rotation; x within a right angle.
fn zxy_rad(r: &DMat3) -> [f64; 3] {
    let x = r.y_axis.z.clamp(-1.0, 1.0).asin();
    [(-r.y_axis.x).atan2(r.y_axis.y), x, (-r.x_axis.z).atan2(r.z_axis.z)]
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn zxy_angles_multiply_to_the_rotation() {
        for [z, x, y] in [[0.3, -0.7, 2.0], [-3.0, 1.5, -1.0], [0.0, 0.0, 0.0], [1.0, -1.5, 3.0]] {
            let rotation = DMat3::from_rotation_z(z) * DMat3::from_rotation_x(x) * DMat3::from_rotation_y(y);
            let found = zxy_rad(&rotation);
            for (found, expected) in found.iter().zip([z, x, y]) {
                assert!((found - expected).abs() < 1e-12, "{found} {expected}");
            }
        }
    }
}
