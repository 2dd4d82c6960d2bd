//! How long displacement maps take on a long clip: `cargo bench --bench displace`.
//!
//! 10,000 frames of 31 joints, eight keys on each joint that has any; best and median of the runs, milliseconds.

use std::{hint::black_box, time::Instant};

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    displace::{
        Interpolation, InterpolationKeys, Layer, Stack,
        ik::{Reach, chain, point_position},
        interpolated_joints,
    },
    motion::{Clip, ClipOptions},
    skeleton::JointId,
};

const RUNS: usize = 30;
const N_JOINTS: usize = 31;
const N_FRAMES: usize = 10_000;

fn main() {
    let bvh = Bvh::parse(made_up().into_bytes(), "made up").expect("it is a BVH");
    let clip = Clip::from_bvh(&bvh, &ClipOptions { rest_frames: Some(0), ..ClipOptions::default() });
    println!("{N_FRAMES} frames × {N_JOINTS} joints; ms, best (median) of {RUNS} runs");
    for n_joints in [1, 3, N_JOINTS] {
        for interpolation in Interpolation::ALL {
            for weight in [1.0, 0.5] {
                let layers = [layer(n_joints, interpolation, weight)];
                let stack = Stack { clip: &clip, base: &[], layers: &layers };
                let name = format!("{n_joints} joints, {interpolation:?}, weight {weight}");
                time(&name, || _ = black_box(stack.displaced()));
            }
        }
    }
    for interpolation in Interpolation::ALL {
        let layers = [layer(N_JOINTS, interpolation, 1.0)];
        let earlier = Stack { clip: &clip, base: &[], layers: &layers };
        let made = earlier.displaced();
        let mut changed = layers.clone();
        changed[0].set_rotation("j9", 17, DQuat::from_rotation_x(0.5));
        let stack = Stack { layers: &changed, ..earlier };
        let name = format!("{N_JOINTS} joints, one key changed, {interpolation:?}");
        time(&name, || _ = black_box(stack.displaced_again(&earlier, &made, 0..clip.n_frames())));
    }
    for interpolation in Interpolation::ALL {
        let layers = [layer(1, interpolation, 1.0)];
        let stack = Stack { clip: &clip, base: &[], layers: &layers };
        let key = || _ = black_box(stack.rotation_key(0, JointId(1), 5_555, DQuat::from_rotation_x(0.3)));
        time(&format!("one key to edit, {interpolation:?}"), key);
    }
    for interpolation in [Interpolation::Quaternion, Interpolation::EulerLinear] {
        let keys = InterpolationKeys { first: 100, last: 9_900 };
        let name = format!("interpolation keys, {interpolation:?}");
        time(&name, || _ = black_box(interpolated_joints(&clip, keys, interpolation)));
    }
    let (mut world, every) = (Vec::new(), clip.skeleton.ids().collect::<Vec<_>>());
    clip.world_rigids(77, &mut world);
    for length in [2, 5, 10] {
        let end = length;
        let chain = chain(&clip, end, &every);
        let point = point_position(&clip.skeleton, &world, end);
        let target = point + DVec3::new(0.7, -1.0, 0.4);
        let reach = Reach { world: &world, chain: &chain, point, target, hinge: None };
        time(&format!("inverse kinematics, {} joints", chain.len()), || _ = black_box(reach.turns()));
    }
}

fn time(name: &str, run: impl Fn()) {
    let mut times: Vec<f64> = (0..RUNS)
        .map(|_| {
            let start = Instant::now();
            run();
            start.elapsed().as_secs_f64() * 1e3
        })
        .collect();
    times.sort_by(f64::total_cmp);
    println!("{name:45} {:8.3} ({:.3})", times[0], times[RUNS / 2]);
}

fn layer(n_joints: usize, interpolation: Interpolation, weight: f64) -> Layer {
    let mut layer = Layer { interpolation, weight, ..Layer::new("made up") };
    for key in 0..8 {
        let frame = key * 1_300 + 17;
        layer.position.set(frame, DVec3::new(key as f64, 1.0, -0.5));
        for joint in 0..n_joints {
            let angle = 0.3 + 0.2 * (key + joint) as f64;
            layer.set_rotation(
                &format!("j{joint}"),
                frame,
                DQuat::from_rotation_y(angle) * DQuat::from_rotation_z(0.2),
            );
        }
    }
    layer
}

/// Three limbs of ten joints on a root.
fn made_up() -> String {
    let mut text = "HIERARCHY\nROOT j0\n{\nOFFSET 0 0 0\n\
        CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        .to_owned();
    for joint in 1..N_JOINTS {
        text += &format!("JOINT j{joint}\n{{\nOFFSET 0 1 0.2\nCHANNELS 3 Zrotation Xrotation Yrotation\n");
        if joint % 10 == 0 {
            text += &format!("End Site\n{{\nOFFSET 0 1 0\n}}\n{}", "}\n".repeat(10));
        }
    }
    text += &format!("}}\nMOTION\nFrames: {N_FRAMES}\nFrame Time: 0.008333\n");
    for frame in 0..N_FRAMES {
        for channel in 0..3 + 3 * N_JOINTS {
            let phase = frame as f64 * 0.01 * (1.0 + channel as f64 * 0.01);
            text += &format!("{:.4} ", 40.0 * phase.sin());
        }
        text += "\n";
    }
    text
}
