//! Clips for the tests of this module: every joint has another rotation order, and one cannot be turned.

use crate::{
    bvh::Bvh,
    motion::{Clip, ClipOptions, UpAxis},
    skeleton::JointId,
};

/// What a test clip is like.
#[derive(Clone, Copy, Debug)]
pub(super) struct Sample {
    pub(super) n_frames: usize,
    pub(super) rest_frames: usize,
    pub(super) up: UpAxis,
    /// Angles are stored within half a turn, and by the triple whose middle angle is within a quarter.
    pub(super) wraps: bool,
    /// Degrees by which the joints swing.
    pub(super) swing: f64,
}

impl Default for Sample {
    fn default() -> Self {
        Self { n_frames: 120, rest_frames: 2, up: UpAxis::Y, wraps: false, swing: 25.0 }
    }
}

/// Joints that turn freely, carrier first.
pub(super) const FREE: [JointId; 5] = [JointId(1), JointId(2), JointId(3), JointId(4), JointId(5)];

/// The joint with two rotation channels.
pub(super) const STIFF: JointId = JointId(6);

const ORDERS: [&str; 7] = ["", "ZXY", "XYZ", "YZX", "XZY", "ZYX", "XY"];

impl Sample {
    /// Makes the clip: a root at the origin, the carrier below it, and one limb with an end site.
    pub(super) fn clip(self) -> Clip {
        let names = ["Root", "Hips", "Spine", "Arm", "Elbow", "Wrist", "Hand"];
        let mut text = "HIERARCHY\n".to_owned();
        for (joint, (name, order)) in names.iter().zip(ORDERS).enumerate() {
            let kind = if joint == 0 { "ROOT" } else { "JOINT" };
            let positions = if joint == 1 { "Xposition Yposition Zposition " } else { "" };
            let rotations: Vec<_> = order.chars().map(|axis| format!("{axis}rotation")).collect();
            let n = rotations.len() + if joint == 1 { 3 } else { 0 };
            text += &format!("{kind} {name}\n{{\nOFFSET {} 1 0.{joint}\n", joint % 2);
            text += &format!("CHANNELS {n} {positions}{}\n", rotations.join(" "));
        }
        text += "End Site\n{\nOFFSET 0 0.5 0\n}\n}\n}\n}\n}\n}\n}\n}\n";
        text += &format!("MOTION\nFrames: {}\nFrame Time: 0.01\n", self.n_frames + self.rest_frames);
        for frame in 0..self.n_frames + self.rest_frames {
            let t = frame as f64 * 0.05;
            text += &format!("{} {} {}", 0.1 * t.sin(), 5.0 + 0.05 * (3.0 * t).sin(), t);
            for (joint, order) in ORDERS.iter().enumerate() {
                let angle = |channel: usize| {
                    let phase = (joint * 3 + channel) as f64;
                    let slow = (t * 0.7 + phase).sin() + 0.3 * phase.cos();
                    self.swing * (slow + 0.04 * (t * 19.0 + phase).sin())
                };
                for angle in self.stored((0..order.len()).map(angle).collect()) {
                    text += &format!(" {angle:.9}");
                }
            }
            text += "\n";
        }
        let bvh = Bvh::parse(text.into_bytes(), "sample.bvh").expect("a good file");
        let rest_frames = Some(self.rest_frames);
        let options =
            ClipOptions { carrier: Some("Hips".to_owned()), up: Some(self.up), rest_frames, ..ClipOptions::default() };
        Clip::from_bvh(&bvh, &options)
    }

    fn stored(self, mut angles: Vec<f64>) -> Vec<f64> {
        let wrap = |angle: f64| angle - 360.0 * (angle / 360.0).round();
        if self.wraps {
            if angles.len() == 3 && wrap(angles[1]).abs() > 90.0 {
                angles = vec![angles[0] + 180.0, 180.0 - angles[1], angles[2] + 180.0];
            }
            angles.iter_mut().for_each(|angle| *angle = wrap(*angle));
        }
        angles
    }
}
