//! Displacement maps on whole clips: laid on, posed by inverse kinematics, written and read again.
//!
//! Captured clips are not part of the project; `WALKABOUT_CLIPS` names their directory.

use std::{fs, path::PathBuf, sync::Arc};

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    displace::{
        Displaced, Interpolation, Layer, Stack, can_turn,
        ik::{Reach, chain, point_position, usual_hinge},
        joint_name,
    },
    motion::{Clip, ClipOptions, EditedClip, gait, to_bvh},
    skeleton::JointId,
};

/// Frames that a test looks at in long clips.
const LOOKS: usize = 150;

/// The built-in clip and, where they are, the captured ones that have frames.
fn clips() -> Vec<(String, Bvh, Arc<Clip>)> {
    let mut texts = vec![("built in".to_owned(), gait::built_in().0.into_bytes())];
    match std::env::var_os("WALKABOUT_CLIPS").map(|dir| PathBuf::from(dir).join("real")) {
        Some(dir) => {
            let files =
                fs::read_dir(dir).expect("the folder is there").map(|entry| entry.expect("it can be read").path());
            let files = files.filter(|path| path.extension().is_some_and(|e| e == "bvh"));
            texts.extend(files.map(|path| (path.display().to_string(), fs::read(&path).expect("it can be read"))));
        }
        None => {
            assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS is not set");
            eprintln!("SKIPPED: WALKABOUT_CLIPS is not set, no captured clip was tested");
        }
    }
    let read = |(name, text): (String, Vec<u8>)| {
        let bvh = Bvh::parse(text, &name).ok().filter(|bvh| bvh.n_frames() > 0)?;
        let clip = Arc::new(Clip::from_bvh(&bvh, &ClipOptions::default()));
        Some((name, bvh, clip))
    };
    texts.into_iter().filter_map(read).collect()
}

/// Carries a displaced clip where the clip itself is.
fn edited(clip: &Arc<Clip>, displaced: &Displaced) -> EditedClip {
    let mut edited = EditedClip::unedited(Arc::clone(clip));
    edited.turned = displaced.shown(&edited.source_frames);
    if displaced.moves_carrier() {
        let place = |frame| displaced.carrier(frame, clip.carrier_world(frame), || DQuat::IDENTITY);
        edited.carrier_world = (0..clip.n_frames()).map(place).collect();
    }
    edited
}

/// Some joints that have maps, the carrier among them where it can be moved.
fn some_joints(clip: &Clip) -> Vec<JointId> {
    let carrier = clip.facts.carrier.value;
    let free =
        clip.skeleton.ids().filter(|&j| j != carrier && can_turn(clip, j) && clip.skeleton.is_within(j, carrier));
    let free: Vec<_> = free.collect();
    let step = free.len().div_ceil(5).max(1);
    let carrier = clip.facts.path_editable.then_some(carrier);
    carrier.into_iter().chain(free.into_iter().step_by(step)).collect()
}

/// Makes a layer of five keys over the clip.
fn layer(clip: &Clip, interpolation: Interpolation) -> Layer {
    let mut layer = Layer { interpolation, ..Layer::new("test") };
    for key in 0..5 {
        let frame = clip.file_frame(key * (clip.n_frames() - 1) / 4);
        for joint in some_joints(clip) {
            let angle = 0.2 + 0.15 * key as f64 + 0.05 * f64::from(joint.0);
            let turn = DQuat::from_scaled_axis(DVec3::new(angle.sin(), (3.0 * angle).cos(), (5.0 * angle).sin()) * 0.4);
            layer.set_rotation(&joint_name(&clip.skeleton, joint), frame, turn);
        }
        let height = clip.facts.height.value;
        layer.position.set(frame, DVec3::new(0.1, -0.05, 0.2 * key as f64) * height);
    }
    layer
}

/// Reads a written file as the clip was read.
fn again(clip: &Clip, bytes: Vec<u8>) -> Clip {
    let facts = &clip.facts;
    let options = ClipOptions {
        carrier: Some(clip.skeleton.joint(facts.carrier.value).name.clone()),
        up: Some(facts.up.value),
        root_offset: Some(facts.root_offset.value),
        joint_offsets: Some(facts.joint_offsets.value),
        rest_frames: Some(facts.rest_frames.value),
        ..ClipOptions::default()
    };
    Clip::from_bvh(&Bvh::parse(bytes, "written").expect("what is written can be read"), &options)
}

fn looked_at(clip: &Clip) -> impl Iterator<Item = usize> {
    (0..clip.n_frames()).step_by(clip.n_frames().div_ceil(LOOKS))
}

#[test]
fn no_displacement_writes_the_file_and_one_is_read_as_it_was_shown() {
    for (name, bvh, clip) in clips() {
        let still = Layer { weight: 0.0, ..layer(&clip, Interpolation::EulerCubic) };
        let none = Stack { clip: &clip, base: &[], layers: &[still] }.displaced();
        assert!(to_bvh(&bvh, &edited(&clip, &none)) == bvh.text().to_vec(), "{name}: not the file, byte for byte");
        for interpolation in Interpolation::ALL {
            let layers = [layer(&clip, interpolation)];
            let displaced = Stack { clip: &clip, base: &[], layers: &layers }.displaced();
            let edited = edited(&clip, &displaced);
            let read = again(&clip, to_bvh(&bvh, &edited));
            let (mut shown, mut found) = (Vec::new(), Vec::new());
            for frame in looked_at(&clip) {
                edited.world_points(frame, &mut shown);
                read.world_points(frame, &mut found);
                for (shown, found) in shown.iter().zip(&found) {
                    let off = shown.distance(*found) / clip.facts.height.value;
                    assert!(off < 1e-6, "{name}, {interpolation:?}, frame {frame}: off by {off:e} H");
                }
            }
        }
    }
}

#[test]
fn no_mode_makes_a_joint_jump() {
    for (name, _, clip) in clips() {
        for interpolation in Interpolation::ALL {
            let layers = [layer(&clip, interpolation)];
            for turned in (Stack { clip: &clip, base: &[], layers: &layers }).displaced().turned {
                let channels = clip.rotation_degrees(turned.joint.idx());
                for frame in 1..clip.n_frames() {
                    // A pose changes by no more than its channels do together, near gimbal lock by much less.
                    let source: f64 = (0..3).map(|i| (channels[frame][i] - channels[frame - 1][i]).abs()).sum();
                    let edited = turned.rotations[frame - 1].angle_between(turned.rotations[frame]);
                    let map = 6.0 / clip.n_frames().min(100) as f64;
                    assert!(
                        edited < source.to_radians() + map,
                        "{name}, {interpolation:?}, joint {}, frame {frame}: {edited} for {source}°",
                        turned.joint.0
                    );
                }
            }
        }
    }
}

#[test]
fn a_pose_by_inverse_kinematics_is_what_its_keys_show() {
    for (name, _, clip) in clips() {
        let height = clip.facts.height.value;
        let frame = clip.n_frames() / 2;
        let mut layers = vec![layer(&clip, Interpolation::Quaternion), Layer::new("edit")];
        for n_chain in [1, 2, 4] {
            let sites = clip.skeleton.n_joints()..clip.skeleton.n_points();
            for point in sites.step_by(3) {
                layers[1] = Layer::new("edit");
                let stack = Stack { clip: &clip, base: &[], layers: &layers };
                let before = edited(&clip, &stack.displaced());
                let mut world = Vec::new();
                before.world_rigids(frame, &mut world);
                let every: Vec<_> = clip.skeleton.ids().filter(|&id| id != clip.facts.carrier.value).collect();
                let mut chain = chain(&clip, point, &every);
                chain.drain(..chain.len().saturating_sub(n_chain));
                let at = point_position(&clip.skeleton, &world, point);
                let target = at + DVec3::new(0.03, 0.04, -0.02) * height;
                let hinge = usual_hinge(&clip, &chain, point);
                let turns = Reach { world: &world, chain: &chain, point: at, target, hinge }.turns();

                let mut keyed = layers.clone();
                for turn in &turns {
                    let seen = stack.rotation(turn.joint, frame) * turn.turn;
                    let key = stack.rotation_key(1, turn.joint, frame, seen).expect("a layer that shows it");
                    keyed[1].set_rotation(&joint_name(&clip.skeleton, turn.joint), clip.file_frame(frame), key);
                }
                let stack = Stack { layers: &keyed, ..stack };
                let after = edited(&clip, &stack.displaced());
                let mut moved = Vec::new();
                after.world_rigids(frame, &mut moved);
                let reached = point_position(&clip.skeleton, &moved, point);
                let Some(&top) = chain.first() else { continue };
                let top = world[top.idx()].translation;
                let mut places: Vec<_> = chain.iter().map(|joint| world[joint.idx()].translation).collect();
                places.push(at);
                let bones: Vec<f64> = places.windows(2).map(|pair| pair[0].distance(pair[1])).collect();
                let (length, longest) = (bones.iter().sum::<f64>(), bones.iter().copied().fold(0.0, f64::max));
                let wanted = top.distance(target);
                let least = (wanted - wanted.clamp((2.0 * longest - length).max(0.0), length)).abs();
                let off = reached.distance(target) - least;
                assert!(off < 1e-4 * height, "{name}, {n_chain} joints to point {point}: {:e} H away", off / height);
                for joint in clip.skeleton.ids().filter(|joint| !chain.contains(joint)) {
                    if joint != clip.facts.carrier.value {
                        assert_eq!(after.rotation(frame, joint), before.rotation(frame, joint), "not selected");
                    }
                }
            }
        }
    }
}
