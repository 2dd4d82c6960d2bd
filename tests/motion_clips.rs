//! Captured and odd clips: what is found out about them, and that they come out as they went in.
//!
//! The clips are not part of the project; `WALKABOUT_CLIPS` names their directory.

use std::{fs, path::PathBuf, sync::Arc};

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    math::Rigid,
    motion::{Clip, ClipOptions, EditedClip, to_bvh},
};

/// Returns the clips' directory; a run without them says so and fails where they must be there.
fn clips_dir() -> Option<PathBuf> {
    let dir = std::env::var_os("WALKABOUT_CLIPS").map(PathBuf::from);
    if dir.is_none() {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS is not set");
        eprintln!("SKIPPED: WALKABOUT_CLIPS is not set, no captured clip was tested");
    }
    dir
}

/// Returns name and bytes of every clip of a folder that the parser takes.
fn loadable(folder: &str) -> Vec<(String, Bvh)> {
    let Some(dir) = clips_dir() else { return Vec::new() };
    let mut clips: Vec<(String, Bvh)> = fs::read_dir(dir.join(folder))
        .expect("the folder is there")
        .map(|entry| entry.expect("the folder can be read").path())
        .filter(|path| path.extension().is_some_and(|e| e == "bvh"))
        .filter_map(|path| {
            let name = path.file_stem().expect("a file has a name").to_string_lossy().into_owned();
            let bvh = Bvh::parse(fs::read(&path).expect("the file can be read"), &name).ok()?;
            Some((name, bvh))
        })
        .collect();
    clips.sort_by(|a, b| a.0.cmp(&b.0));
    assert!(!clips.is_empty(), "no clip in {folder}");
    clips
}

/// Name, carrier, up, root offset, joint offsets, rest frames, unit.
const FACTS: &str = "
axis_neuron_354_channels Hips y replace replace 0 cm
boxing_one_extra_row Hips y replace replace 0 cm
cmu_01_01_jumps Hips y replace replace 1 CMU
cmu_02_01_walk Hips y replace replace 1 CMU
cmu_08_01_brisk_walk Hips y replace replace 1 CMU
cmu_12_03_walk Hips y replace replace 1 CMU
cmu_131_01_start_walk_stop Hips y replace replace 0 CMU
cmu_14_14_long Hips y replace replace 0 CMU
cmu_61_09_salsa_metres hip y replace replace 0 m
figure8_walk Hips y replace replace 0 inch
four_rotation_orders Hips z replace replace 0 inch
makehuman_pose_891_channels root z add add 0 dm
makehuman_walk_in_place_z_up Root z add replace 0 dm
reactidle_003_mixed_offsets pelvis y add replace 0 m
rokoko_dance Hips y replace replace 0 cm
rotation_first_root Hips y replace replace 0 ?
walk01 Hips y replace replace 0 cm
zombie_turns_z_up Hips z replace replace 0 inch
";

#[test]
fn facts_of_captured_clips_are_found() {
    let clips = loadable("real");
    for line in FACTS.trim().lines().filter(|_| !clips.is_empty()) {
        let words: Vec<&str> = line.split(' ').collect();
        let (_, bvh) = clips.iter().find(|(name, _)| name == words[0]).expect("the clip is there");
        let clip = Clip::from_bvh(bvh, &ClipOptions::default());
        let facts = &clip.facts;
        let unit = facts.unit.value.unwrap_or("none").split(' ').next().expect("a unit has a name");
        let found = [
            clip.skeleton.joint(facts.carrier.value).name.clone(),
            format!("{:?}", facts.up.value).to_lowercase(),
            format!("{:?}", facts.root_offset.value).to_lowercase(),
            format!("{:?}", facts.joint_offsets.value).to_lowercase(),
            facts.rest_frames.value.to_string(),
            if words[6] == "?" { "?".to_owned() } else { unit.to_owned() },
        ];
        assert_eq!(found, words[1..], "{}: {facts:#?}", words[0]);
        assert!(facts.path_editable, "{}: {:?}", words[0], clip.warnings);
    }
    assert!(clips.is_empty() || clips.len() == FACTS.trim().lines().count(), "the table names every clip");
}

#[test]
fn unedited_clips_come_out_byte_for_byte() {
    for (name, bvh) in loadable("real").into_iter().chain(loadable("quirks")) {
        let clip = Arc::new(Clip::from_bvh(&bvh, &ClipOptions::default()));
        assert!(to_bvh(&bvh, &EditedClip::unedited(clip.clone())) == **bvh.text(), "{name}");
        if clip.facts.path_editable {
            // A carrier moved to where it is changes nothing either.
            let carrier_world = (0..clip.n_frames()).map(|f| clip.carrier_world(f)).collect();
            let edited = EditedClip { carrier_world, ..EditedClip::unedited(clip) };
            assert!(to_bvh(&bvh, &edited) == **bvh.text(), "{name}, carrier put where it is");
        }
    }
}

#[test]
fn moved_clips_read_back_where_they_were_put() {
    for (name, bvh) in loadable("real").into_iter().chain(loadable("quirks")) {
        let clip = Arc::new(Clip::from_bvh(&bvh, &ClipOptions::default()));
        if clip.facts.path_editable {
            check_moved(&name, &bvh, clip);
        }
    }
}

/// Moves and turns the carrier at every frame, exports, reads back, and compares every point of every frame.
fn check_moved(name: &str, bvh: &Bvh, clip: Arc<Clip>) {
    let height = clip.facts.height.value;
    let n_frames = clip.n_frames();
    // Some frames are left out and the clip plays one and a half times, as with cycling.
    let source_frames: Vec<u32> = (0..n_frames + n_frames / 2).map(|f| (f % n_frames) as u32).collect();
    let carrier_world = (source_frames.iter().enumerate())
        .map(|(frame, &source)| motion(frame as f64, height) * clip.carrier_world(source as usize))
        .collect();
    let edited = EditedClip { clip: clip.clone(), source_frames, carrier_world, turned: Vec::new() };
    let written = to_bvh(bvh, &edited);
    let again = Bvh::parse(written, name).unwrap_or_else(|e| panic!("{name}: {e}"));
    // The facts may come out otherwise for the moved clip; the same reading is what is compared.
    let facts = &clip.facts;
    let options = ClipOptions {
        carrier: Some(clip.skeleton.joint(facts.carrier.value).name.clone()),
        up: Some(facts.up.value),
        root_offset: Some(facts.root_offset.value),
        joint_offsets: Some(facts.joint_offsets.value),
        length: None,
        rest_frames: Some(facts.rest_frames.value),
        legs: Vec::new(),
    };
    let again_clip = Clip::from_bvh(&again, &options);
    assert_eq!(again_clip.n_frames(), edited.n_frames(), "{name}");
    let (mut want, mut got) = (Vec::new(), Vec::new());
    let mut worst = 0.0f64;
    for frame in 0..edited.n_frames() {
        edited.world_points(frame, &mut want);
        again_clip.world_points(frame, &mut got);
        for (want, got) in want.iter().zip(&got) {
            worst = worst.max(want.distance(*got) / height);
        }
    }
    assert!(worst <= 1e-6, "{name}: a joint moved by {worst:e} H");
    for row in 0..clip.rest_frames() {
        assert_eq!(again.frame(row), bvh.frame(row), "{name}: rest frame {row}");
    }
    check_channels(name, bvh, &again, &edited);
}

/// Only the carrier's channels differ, and its angles go on smoothly where the rotation does.
fn check_channels(name: &str, bvh: &Bvh, again: &Bvh, edited: &EditedClip) {
    let clip = &edited.clip;
    let joint = &bvh.joints()[clip.facts.carrier.value.idx()];
    let own = joint.first_channel..joint.first_channel + joint.channels.len();
    let zeros = (bvh.n_frames() == 0).then(|| bvh.with_row_of_zeros(0.1).expect("it has channels"));
    let bvh = zeros.as_ref().unwrap_or(bvh);
    for frame in 0..edited.n_frames() {
        // The one row of a stationary clip stands for all of its frames.
        let source = bvh.frame(clip.file_frame(edited.source_frame(frame)).min(bvh.n_frames() - 1));
        let written = again.frame(clip.file_frame(frame));
        for channel in (0..bvh.n_channels()).filter(|c| !own.contains(c)) {
            assert_eq!(
                written[channel].to_bits(),
                source[channel].to_bits(),
                "{name}: frame {frame}, channel {channel}"
            );
        }
        if frame == 0 {
            continue;
        }
        let before = again.frame(clip.file_frame(frame - 1));
        for (channel, kind) in own.clone().zip(&joint.channels) {
            let step = (written[channel] - before[channel]).abs();
            // Of two triples the nearer one never has a channel farther than half a turn; more would be a lost turn.
            assert!(kind.is_position() || step <= 270.0, "{name}: frame {frame}, channel {channel} steps by {step}°");
        }
    }
}

/// A motion that turns about all axes, differently at every frame, in no particular place.
fn motion(frame: f64, height: f64) -> Rigid {
    let axis = DVec3::new((frame * 0.013).sin(), 1.0, (frame * 0.017).cos()).normalize();
    let rotation = DQuat::from_axis_angle(axis, frame * 0.021 + 0.3);
    Rigid::new(rotation, height * DVec3::new((frame * 0.01).sin(), 0.2, -0.004 * frame))
}

#[test]
fn every_clip_gives_finite_points_everywhere() {
    for (name, bvh) in loadable("real").into_iter().chain(loadable("quirks")) {
        let clip = Clip::from_bvh(&bvh, &ClipOptions::default());
        assert!(clip.facts.height.value > 0.0 && clip.facts.floor.is_finite(), "{name}");
        assert!(clip.frame_time_secs > 0.0, "{name}");
        let tracks = clip.world_tracks();
        let (mut points, mut worst) = (Vec::new(), 0.0f64);
        for frame in 0..clip.n_frames() {
            clip.world_points(frame, &mut points);
            assert!(points.iter().all(|p| p.is_finite()), "{name}: frame {frame}");
            for (point, p) in points.iter().enumerate() {
                worst = worst.max(p.distance(tracks.position(point, frame)) / clip.facts.height.value);
            }
        }
        assert!(worst < 1e-12, "{name}: one frame at a time and all at once differ by {worst:e} H");
    }
}
