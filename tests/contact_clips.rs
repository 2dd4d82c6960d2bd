//! Legs and foot plants of captured clips, and of the built-in one, whose plants are known.

use std::{env, fs, path::PathBuf};

use walkabout::{
    bvh::Bvh,
    contact::{Detection, FootPlants, Plant, Thresholds},
    motion::{
        Clip, ClipOptions, Leg, Side, find_legs,
        gait::{self, built_in},
        legs::point_name,
    },
    skeleton::{Joint, Skeleton},
};

/// Returns the folder of captured clips; without it the test says that it was skipped, and fails where CI runs it.
fn clips() -> Option<PathBuf> {
    let found = env::var_os("WALKABOUT_CLIPS").map(|folder| PathBuf::from(folder).join("real"));
    if found.is_none() {
        assert!(env::var_os("CI").is_none(), "WALKABOUT_CLIPS must name the folder of clips");
        eprintln!("SKIPPED: WALKABOUT_CLIPS does not name the folder of clips");
    }
    found
}

fn clip(bytes: Vec<u8>, name: &str) -> Clip {
    let bvh = Bvh::parse(bytes, name).unwrap_or_else(|error| panic!("{error}"));
    Clip::from_bvh(&bvh, &ClipOptions::default())
}

fn legs(clip: &Clip) -> Vec<Leg> {
    let mut warnings = Vec::new();
    let legs = find_legs(clip, &[], &mut warnings).value;
    assert!(warnings.is_empty(), "{warnings:?}");
    legs
}

fn plants(clip: &Clip) -> Vec<FootPlants> {
    let detection = Detection {
        tracks: &clip.world_tracks(),
        carrier: clip.facts.carrier.value.idx(),
        legs: &legs(clip),
        frame_time_secs: clip.frame_time_secs,
        height: clip.facts.height.value,
        thresholds: Thresholds::default(),
    };
    detection.plants()
}

/// A clip's left leg, toe last, and how many plants its left and right foot have, if that was counted.
///
/// Counted from plots of the height and speed of ankles and toes, and once more by a rule of its own: stretches in
/// which ankle and toe are both faster than 0.6 H/s for 60 ms part the plants of a walk. Plants cut off by the clip's
/// ends count when they are longer than 60 ms.
struct Known {
    file: &'static str,
    leg: [&'static str; 4],
    plants: Option<[usize; 2]>,
}

const fn known(file: &'static str, leg: [&'static str; 4], plants: Option<[usize; 2]>) -> Known {
    Known { file, leg, plants }
}

const CMU: [&str; 4] = ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"];

const CMU_OTHER: [&str; 4] = ["LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"];

const FOOT_END: [&str; 4] = ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftFoot end site"];

const KNOWN: [Known; 17] = [
    known("cmu_02_01_walk", CMU, Some([3, 3])),
    known("cmu_08_01_brisk_walk", CMU, Some([3, 3])),
    known("cmu_12_03_walk", CMU, Some([4, 4])),
    known("figure8_walk", CMU, Some([10, 9])),
    known("walk01", FOOT_END, Some([4, 4])),
    known("zombie_turns_z_up", CMU, Some([15, 16])),
    // Ten jumps with both feet; steps to turn around: one and one on the left, two and one on the right.
    known("cmu_01_01_jumps", CMU, Some([13, 14])),
    // Stands on the left foot and turns on it for the first half: only the right one steps cleanly.
    known("cmu_131_01_start_walk_stop", CMU_OTHER, None),
    // Twelve hops on the spot, three side kicks of the right foot, two of the left.
    known("cmu_14_14_long", CMU_OTHER, Some([15, 16])),
    // Stands all the time.
    known("reactidle_003_mixed_offsets", ["thigh.L", "shin.L", "foot.L", "foot.L end site"], Some([1, 1])),
    // The right foot takes one step.
    known("axis_neuron_354_channels", FOOT_END, Some([1, 2])),
    // On the spot: the feet slide back all the time.
    known("makehuman_walk_in_place_z_up", ["UpLeg_L", "LoLeg_L", "Foot_L", "Toe_L"], Some([0, 0])),
    // One pose: it stands still for as long as the clip is made to last.
    known("makehuman_pose_891_channels", ["upperleg01.L", "lowerleg01.L", "foot.L", "toe3-1.L"], Some([1, 1])),
    known("boxing_one_extra_row", ["LeftHip", "LeftKnee", "LeftAnkle", "LeftToes"], None),
    known("cmu_61_09_salsa_metres", ["lThigh", "lShin", "lFoot", "lFoot end site"], None),
    known("rokoko_dance", CMU, None),
    known("four_rotation_orders", CMU, None),
];

#[test]
fn captured_clips_have_the_legs_and_plants_that_were_counted() {
    let Some(folder) = clips() else { return };
    for Known { file, leg, plants: counted } in KNOWN {
        let bytes = fs::read(folder.join(file).with_extension("bvh")).expect(file);
        let clip = clip(bytes, file);
        let feet = plants(&clip);
        assert_eq!(feet.iter().map(|foot| foot.leg.side).collect::<Vec<_>>(), [Side::Left, Side::Right], "{file}");
        let left = &feet[0].leg;
        let points = [left.hip.idx(), left.knee.idx(), left.ankle.idx(), left.toe];
        assert_eq!(points.map(|point| point_name(&clip.skeleton, point)), leg, "{file}");

        let found = [feet[0].plants.len(), feet[1].plants.len()];
        println!("{file}: {found:?} plants");
        assert!(counted.is_none_or(|counted| counted == found), "{file}: {feet:?}");
        for plants in feet.iter().map(|foot| &foot.plants) {
            assert!(plants.iter().all(|plant| plant.first <= plant.last && plant.last < clip.n_frames()), "{file}");
            assert!(plants.windows(2).all(|pair| pair[0].last + 1 < pair[1].first), "{file}");
            let lasts = |plant: &Plant| plant.n_frames() as f64 * clip.frame_time_secs;
            let short: Vec<_> = plants.iter().filter(|plant| lasts(plant) < 0.06).collect();
            assert!(short.is_empty(), "{file}: shorter than 60 ms: {short:?}");
        }
    }
}

#[test]
fn legs_without_names_are_the_same_legs() {
    let Some(folder) = clips() else { return };
    for Known { file, .. } in KNOWN {
        let bytes = fs::read(folder.join(file).with_extension("bvh")).expect(file);
        let mut clip = clip(bytes, file);
        let named = legs(&clip);
        let anonymous = clip.skeleton.joints().iter().map(|joint| Joint { name: "joint".to_owned(), ..joint.clone() });
        clip.skeleton = Skeleton::new(anonymous.collect());
        let found = legs(&clip);
        if file == "makehuman_pose_891_channels" {
            // Its thighs and shins are of two joints each; only names tell.
            assert!(found.is_empty(), "{found:?}");
        } else {
            assert_eq!(found, named, "{file}");
        }
    }
}

#[test]
fn a_leg_without_names_is_found_beside_the_named_one() {
    let Some(folder) = clips() else { return };
    for Known { file, .. } in KNOWN {
        let bytes = fs::read(folder.join(file).with_extension("bvh")).expect(file);
        let clip = clip(bytes, file);
        let named = legs(&clip);
        for forgotten in &named {
            let mut clip = clip.clone();
            let of_leg = clip.skeleton.subtree(forgotten.hip);
            let joints = clip.skeleton.joints().iter().zip(of_leg);
            let joints = joints.map(|(joint, of_leg)| Joint {
                name: if of_leg { "joint".to_owned() } else { joint.name.clone() },
                ..joint.clone()
            });
            clip.skeleton = Skeleton::new(joints.collect());
            let found = legs(&clip);
            assert_eq!(found.len(), 2, "{file} without the {} leg's names", forgotten.side.name());
            for (found, named) in found.iter().zip(&named) {
                let bends = |leg: &Leg| (leg.side, leg.hip, leg.knee, leg.ankle);
                assert_eq!(bends(found), bends(named), "{file} without the {} leg's names", forgotten.side.name());
            }
        }
    }
}

#[test]
fn a_clip_with_half_a_body_has_no_legs() {
    let Some(folder) = clips() else { return };
    let bytes = fs::read(folder.join("rotation_first_root.bvh")).expect("a clip");
    let clip = clip(bytes, "rotation_first_root.bvh");
    assert!(plants(&clip).is_empty());
}

/// The bar is two frames at each end of every contact, heel strike to toe-off.
#[test]
fn plants_of_the_built_in_clip_are_the_known_ones() {
    let (text, truth) = built_in();
    let clip = clip(text.into_bytes(), "built in");
    for (foot, side) in plants(&clip).iter().zip([gait::Side::Left, gait::Side::Right]) {
        let known: Vec<_> = truth.plants.iter().filter(|plant| plant.side == side).map(|p| &p.contact).collect();
        assert_eq!(foot.plants.len(), known.len(), "{side:?}: {:?} instead of {known:?}", foot.plants);
        for (plant, contact) in foot.plants.iter().zip(known) {
            let off = plant.first.abs_diff(*contact.start()).max(plant.last.abs_diff(*contact.end()));
            assert!(off <= 2, "{side:?}: {plant:?} instead of {contact:?}");
        }
    }
}
