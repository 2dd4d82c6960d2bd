//! The reader on files: captured clips, and small odd ones with a manifest that says what a reader should make of them.

use std::{collections::BTreeMap, env, fs, path::PathBuf};

use serde::Deserialize;
use walkabout::bvh::{Bvh, Digits, RowEdit};

/// Returns the folder of clips; without it the test says that it was skipped, and fails where CI runs it.
fn clips() -> Option<PathBuf> {
    let found = env::var_os("WALKABOUT_CLIPS").map(PathBuf::from);
    if found.is_none() {
        assert!(env::var_os("CI").is_none(), "WALKABOUT_CLIPS must name the folder of clips");
        eprintln!("SKIPPED: WALKABOUT_CLIPS does not name the folder of clips");
    }
    found
}

/// Checks that a file comes out as it went in, as a whole and row by row.
fn check_round_trip(bvh: &Bvh, bytes: &[u8], name: &str) {
    assert!(bvh.text()[..] == *bytes, "{name}: the text is kept");
    let mut rows: Vec<_> = (0..bvh.n_frames()).map(|source_row| RowEdit { source_row, changed: &[] }).collect();
    let digits = Digits { position_decimals: 6, rotation_decimals: 6 };
    assert!(bvh.write_rows(&rows, digits) == bytes, "{name}: unchanged rows give the source's bytes");

    let first: Vec<(usize, f64)> = bvh.values().iter().copied().take(bvh.n_channels()).enumerate().collect();
    if let [row, ..] = &mut rows[..] {
        row.changed = &first;
        assert!(bvh.write_rows(&rows, digits) == bytes, "{name}: equal values are no change");
    }
}

#[derive(Deserialize)]
struct Says {
    expect: String,
    frames: usize,
    joints: usize,
    why: String,
}

#[test]
fn odd_files_behave_as_their_manifest_says() {
    let Some(clips) = clips() else { return };
    let folder = clips.join("quirks");
    let manifest = fs::read(folder.join("manifest.json")).expect("the manifest");
    let manifest: BTreeMap<String, Says> = serde_json::from_slice(&manifest).expect("its JSON");
    assert!(manifest.len() > 40);
    for (name, says) in &manifest {
        let bytes = fs::read(folder.join(name)).expect(name);
        match Bvh::parse(bytes.clone(), name) {
            Ok(bvh) => {
                assert_ne!(says.expect, "error", "{name} ({}) loads", says.why);
                assert_eq!((bvh.n_frames(), bvh.joints().len()), (says.frames, says.joints), "{name}");
                check_round_trip(&bvh, &bytes, name);
                for warning in bvh.warnings().iter().take(3) {
                    println!("{name}: {warning}");
                }
            }
            Err(error) => {
                println!("{error}");
                assert_ne!(says.expect, "ok", "{name} ({}) is refused: {error}", says.why);
            }
        }
    }
}

#[test]
fn captured_clips_load_whole() {
    let Some(clips) = clips() else { return };
    let folder = clips.join("real");
    for (name, frames, joints, channels) in [
        ("axis_neuron_354_channels", 422, 59, 354),
        ("boxing_one_extra_row", 3069, 21, 66),
        ("cmu_01_01_jumps", 2752, 31, 96),
        ("cmu_02_01_walk", 344, 31, 96),
        ("cmu_08_01_brisk_walk", 278, 31, 96),
        ("cmu_12_03_walk", 566, 31, 96),
        ("cmu_131_01_start_walk_stop", 994, 31, 96),
        ("cmu_14_14_long", 4653, 31, 96),
        ("cmu_61_09_salsa_metres", 2575, 43, 132),
        ("figure8_walk", 1064, 23, 72),
        ("four_rotation_orders", 75, 24, 75),
        ("makehuman_pose_891_channels", 1, 163, 891),
        ("makehuman_walk_in_place_z_up", 14, 75, 228),
        ("reactidle_003_mixed_offsets", 918, 19, 111),
        ("rokoko_dance", 1007, 60, 183),
        ("rotation_first_root", 4, 4, 15),
        ("walk01", 101, 19, 60),
        ("zombie_turns_z_up", 779, 27, 84),
    ] {
        let bytes = fs::read(folder.join(format!("{name}.bvh"))).expect(name);
        let bvh = Bvh::parse(bytes.clone(), name).unwrap_or_else(|e| panic!("{e}"));
        assert_eq!((bvh.n_frames(), bvh.joints().len(), bvh.n_channels()), (frames, joints, channels), "{name}");
        assert_eq!(bvh.declared_frames(), Some(frames as u64), "{name}");
        check_values(&bvh, &bytes, name);
        check_round_trip(&bvh, &bytes, name);
        for warning in bvh.warnings() {
            println!("{name}: {warning}");
        }
        assert_eq!(!bvh.warnings().is_empty(), name == "boxing_one_extra_row", "{name}");
    }
}

/// Reads the numbers after the frame time a second time, with the standard library.
fn check_values(bvh: &Bvh, bytes: &[u8], name: &str) {
    let text = str::from_utf8(bytes).expect("ASCII");
    let motion = text.split_once("Frame Time:").expect("a frame time").1;
    let mut words = motion.split_ascii_whitespace().map(|word| word.parse::<f64>().expect("a number"));
    assert_eq!(words.next(), Some(bvh.frame_time_secs()), "{name}");
    assert!(words.take(bvh.values().len()).eq(bvh.values().iter().copied()), "{name}");
}
