//! Rotations as channel angles: what a clip's rotation channels hold, and how such angles turn a joint.
//!
//! Poses are quaternions everywhere else. Whoever adds to channels (displacement maps in Euler angles) needs the
//! angles themselves, on one continuous branch: stored angles wrap, and a file may change from one triple of a pose to
//! the other between two frames, where adding the same offsets would give two different poses.

use std::{ops::Range, sync::Arc};

use glam::{DQuat, DVec3};
use wide::f64x4;

use super::{UpAxis, channels::FileMotion, euler};
use crate::math::lanes::{LANES, QuatLanes, half_sin_cos_of_degrees};

/// How three rotation channels, one about each axis, turn a joint.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct RotationOrder {
    /// Axes of the channels (0 x, 1 y, 2 z) in the file's order: the first is the outermost.
    axes: [usize; 3],
    /// Applied after the channels: into y-up axes for a root, nothing below.
    into_world: DQuat,
}

impl RotationOrder {
    /// Returns the axes of the channels (0 x, 1 y, 2 z), in the file's order.
    pub fn axes(&self) -> [usize; 3] {
        self.axes
    }

    /// Returns the local rotation that these angles, degrees, stand for.
    pub fn rotation(&self, degrees: [f64; 3]) -> DQuat {
        (self.axes.iter().zip(degrees)).fold(self.into_world, |rotation, (&axis, degrees)| {
            rotation * DQuat::from_axis_angle(DVec3::AXES[axis], degrees.to_radians())
        })
    }

    /// Returns the local rotations that triples of angles, degrees, stand for; four at once.
    pub fn rotations(&self, degrees: &[[f64; 3]]) -> Vec<DQuat> {
        let [a, b, c] = self.axes;
        let into_world = QuatLanes::splat(self.into_world);
        let mut out = Vec::with_capacity(degrees.len());
        for group in degrees.chunks(LANES) {
            let half = |channel: usize| {
                let lane = |lane: usize| group[lane.min(group.len() - 1)][channel];
                half_sin_cos_of_degrees(f64x4::new([lane(0), lane(1), lane(2), lane(3)]))
            };
            let turned = QuatLanes::about_two(a, half(0), b, half(1)).turned(c, half(2));
            out.extend_from_slice(&into_world.times(turned).lanes()[..group.len()]);
        }
        out
    }

    /// Returns the angles, degrees, that give a local rotation and lie nearest to `near`, in the sum of squares.
    pub fn nearest_degrees(&self, rotation: DQuat, near: [f64; 3]) -> [f64; 3] {
        euler::nearest_degrees(self.axes, self.into_world.conjugate() * rotation, near)
    }
}

/// The rotation channels of a clip's joints. Frames here are file frames.
#[derive(Clone, Debug)]
pub(super) struct Angles {
    /// By joint: order and columns; none without one channel about each axis.
    joints: Vec<Option<(RotationOrder, [usize; 3])>>,
    n_channels: usize,
    /// Rows × channels, shared with the file; one row: of every frame.
    values: Arc<Vec<f64>>,
    /// The frames are no longer the file's, so angles have to be read from poses.
    rearranged: bool,
}

impl Angles {
    pub(super) fn new(motion: &FileMotion, up: UpAxis) -> Self {
        let joints = (motion.channels.iter().zip(motion.skeleton.joints()))
            .map(|(channels, joint)| {
                let channels = channels.free_rotations()?;
                let into_world = if joint.parent.is_none() { up.world_rotation() } else { DQuat::IDENTITY };
                let order = RotationOrder { axes: channels.map(|(axis, _)| axis), into_world };
                Some((order, channels.map(|(_, column)| column)))
            })
            .collect();
        Self { joints, n_channels: motion.n_channels, values: Arc::clone(&motion.values), rearranged: false }
    }

    /// Returns the same joints' channels for frames that are not the file's.
    pub(super) fn of_other_frames(&self) -> Self {
        Self { joints: self.joints.clone(), n_channels: self.n_channels, values: Arc::default(), rearranged: true }
    }

    /// Tells whether the values are those of the clip's own frames.
    pub(super) fn are_of_these_frames(&self) -> bool {
        !self.rearranged
    }

    pub(super) fn order(&self, joint: usize) -> Option<RotationOrder> {
        self.joints[joint].map(|(order, _)| order)
    }

    /// Returns a joint's angles over the frames, continuous.
    pub(super) fn degrees(&self, joint: usize, frames: Range<usize>) -> Vec<[f64; 3]> {
        let (_, columns) = self.joints[joint].expect("the joint turns freely");
        let last_row = self.values.len() / self.n_channels - 1;
        let mut before: Option<[f64; 3]> = None;
        frames
            .map(|frame| {
                let row = &self.values[frame.min(last_row) * self.n_channels..][..self.n_channels];
                let stored = columns.map(|column| row[column]);
                let continued = before.map_or(stored, |before| continued(stored, before));
                before = Some(continued);
                continued
            })
            .collect()
    }
}

/// Returns the triple of the same pose that lies nearest to the one before.
fn continued(stored: [f64; 3], before: [f64; 3]) -> [f64; 3] {
    // Both outer angles of the other triple are half a turn away, so within a quarter nothing else is nearer.
    if (0..3).all(|i| (stored[i] - before[i]).abs() < 90.0) {
        return stored;
    }
    let near = |triple: [f64; 3]| -> [f64; 3] {
        std::array::from_fn(|i| triple[i] + 360.0 * ((before[i] - triple[i]) / 360.0).round())
    };
    let distance = |triple: [f64; 3]| (0..3).map(|i| (triple[i] - before[i]).powi(2)).sum::<f64>();
    let same = near(stored);
    let other = near([stored[0] + 180.0, 180.0 - stored[1], stored[2] + 180.0]);
    if distance(other) < distance(same) { other } else { same }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        bvh::Bvh,
        motion::{Clip, ClipOptions},
    };

    fn clip(rows: &[[f64; 6]], up: UpAxis) -> Clip {
        let mut text = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n\
            CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n\
            JOINT Knee\n{\nOFFSET 0 -1 0\nCHANNELS 3 Yrotation Zrotation Xrotation\nEnd Site\n{\nOFFSET 0 -1 0\n}\n}\n}\n"
            .to_owned();
        text += &format!("MOTION\nFrames: {}\nFrame Time: 0.1\n", rows.len());
        for row in rows {
            text += "0 5 0";
            row.iter().for_each(|value| text += &format!(" {value}"));
            text += "\n";
        }
        let options = ClipOptions { up: Some(up), rest_frames: Some(0), ..ClipOptions::default() };
        Clip::from_bvh(&Bvh::parse(text.into_bytes(), "angles.bvh").expect("a good file"), &options)
    }

    /// Checks that the angles are those of the poses and never jump.
    fn check(clip: &Clip) {
        for joint in 0..2 {
            let order = clip.rotation_order(joint).expect("it turns freely");
            let degrees = clip.rotation_degrees(joint);
            let rotations = order.rotations(&degrees);
            assert_eq!(rotations.len(), clip.n_frames());
            for (frame, (&degrees, rotation)) in degrees.iter().zip(rotations).enumerate() {
                let want = clip.rotations(frame)[joint];
                assert!(rotation.dot(want).abs() > 1.0 - 1e-14, "joint {joint}, frame {frame}");
                assert!(order.rotation(degrees).dot(want).abs() > 1.0 - 1e-14);
                let back = order.nearest_degrees(want, degrees);
                assert!((0..3).all(|i| (back[i] - degrees[i]).abs() < 1e-6), "{back:?} {degrees:?}");
            }
            for pair in degrees.windows(2) {
                assert!((0..3).all(|i| (pair[1][i] - pair[0][i]).abs() < 30.0), "{pair:?}");
            }
        }
    }

    #[test]
    fn angles_follow_one_another_where_the_file_wraps_or_changes_the_triple() {
        // The first joint wraps; the second changes to the other triple of its pose and back.
        let rows = [
            [170.0, 10.0, 0.0, 10.0, 80.0, 20.0],
            [-175.0, 20.0, 340.0, -160.0, 88.0, -150.0],
            [-160.0, 30.0, -35.0, 40.0, 85.0, 35.0],
            [-140.0, 20.0, -40.0, 45.0, 80.0, 30.0],
            [580.0, 20.0, -40.0, 45.0, 80.0, 30.0],
        ];
        for up in [UpAxis::Y, UpAxis::Z] {
            let clip = clip(&rows, up);
            check(&clip);
            assert_eq!(clip.rotation_degrees(0)[0], [170.0, 10.0, 0.0], "the first frame is the file's");
        }
    }
}
