//! Small files read as clips: closed forms, odd files, the user's word, and what is written back.

use std::{fmt::Write as _, sync::Arc};

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    math::Rigid,
    motion::{Clip, ClipOptions, EditedClip, OffsetMeaning, TurnedJoint, UpAxis, carrier_relative, to_bvh},
};

const XYZ: &str = "Xposition Yposition Zposition";

/// Puts a hierarchy and rows together.
fn file(hierarchy: &str, rows: &[&[f64]]) -> Bvh {
    let mut text = format!("HIERARCHY\n{hierarchy}\nMOTION\nFrames: {}\nFrame Time: 0.04\n", rows.len());
    for row in rows {
        row.iter().for_each(|v| write!(text, "{v} ").expect("writing to memory"));
        text += "\n";
    }
    Bvh::parse(text.into_bytes(), "test").unwrap_or_else(|e| panic!("{e}"))
}

fn read(bvh: &Bvh) -> Clip {
    Clip::from_bvh(bvh, &ClipOptions::default())
}

fn points(clip: &Clip, frame: usize) -> Vec<DVec3> {
    let mut points = Vec::new();
    clip.world_points(frame, &mut points);
    points
}

fn assert_near(found: &[DVec3], expected: &[[f64; 3]]) {
    assert_eq!(found.len(), expected.len());
    for (found, &expected) in found.iter().zip(expected) {
        assert!(found.abs_diff_eq(DVec3::from_array(expected), 1e-12), "{found} is not {expected:?}");
    }
}

fn as_asked() -> ClipOptions {
    ClipOptions {
        carrier: None,
        up: Some(UpAxis::Y),
        root_offset: Some(OffsetMeaning::Replace),
        joint_offsets: Some(OffsetMeaning::Replace),
        length: None,
        rest_frames: Some(0),
        legs: Vec::new(),
    }
}

/// A root, an arm one along x, a hand one along y, its tip one along z.
fn arm(root_channels: &str, arm_channels: &str) -> String {
    format!(
        "ROOT Root {{ OFFSET 0 0 0\n CHANNELS {}\n JOINT Arm {{ OFFSET 1 0 0\n CHANNELS {}\n \
         JOINT Hand {{ OFFSET 0 1 0\n CHANNELS 1 Xrotation\n End Site {{ OFFSET 0 0 1 }} }} }} }}",
        root_channels, arm_channels
    )
}

#[test]
fn a_chain_ends_where_the_hand_says() {
    let bvh = file(
        &arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"),
        // The root a quarter turn about z; then also the arm one about y; then also the hand one about x.
        &[
            &[10.0, 20.0, 30.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0],
            &[10.0, 20.0, 30.0, 90.0, 0.0, 0.0, 0.0, 90.0, 0.0, 0.0],
            &[10.0, 20.0, 30.0, 90.0, 0.0, 0.0, 0.0, 90.0, 0.0, 90.0],
            // In file order: z first turns what x then turns.
            &[0.0, 0.0, 0.0, 90.0, 90.0, 0.0, 0.0, 0.0, 0.0, 0.0],
        ],
    );
    let clip = Clip::from_bvh(&bvh, &as_asked());
    let root = [10.0, 20.0, 30.0];
    assert_near(&points(&clip, 0), &[root, [10.0, 21.0, 30.0], [9.0, 21.0, 30.0], [9.0, 21.0, 31.0]]);
    assert_near(&points(&clip, 1), &[root, [10.0, 21.0, 30.0], [9.0, 21.0, 30.0], [9.0, 22.0, 30.0]]);
    // Hand's z axis goes to −y of the hand, which is the arm's −y, which is +x of the world.
    assert_near(&points(&clip, 2), &[root, [10.0, 21.0, 30.0], [9.0, 21.0, 30.0], [10.0, 21.0, 30.0]]);
    // Rz(90)·Rx(90): x → y, y → z, z → x.
    assert_near(&points(&clip, 3), &[[0.0; 3], [0.0, 1.0, 0.0], [0.0, 1.0, 1.0], [1.0, 1.0, 1.0]]);
}

#[test]
fn a_channels_place_in_the_row_does_not_matter_to_translation() {
    let last = file(
        &arm("6 Zrotation Xrotation Yrotation Zposition Yposition Xposition", "0"),
        &[&[30.0, 40.0, 50.0, 3.0, 2.0, 1.0, 7.0]],
    );
    let first =
        file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "0"), &[&[1.0, 2.0, 3.0, 30.0, 40.0, 50.0, 7.0]]);
    assert_eq!(points(&read(&last), 0), points(&read(&first), 0));
}

#[test]
fn the_body_in_the_carriers_space_gives_the_world_back() {
    let rows: Vec<Vec<f64>> =
        (0..9).map(|f| (0..10).map(|c| 7.0 * f64::from(f) + 13.0 * f64::from(c)).collect()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"), &rows);
    let clip = read(&bvh);
    let relative = carrier_relative(&clip);
    assert_eq!(relative.points[0], clip.facts.carrier.value.idx());
    assert_eq!(clip.carrier_track().len(), clip.n_frames());
    for (frame, carrier) in clip.carrier_track().into_iter().enumerate() {
        let world = points(&clip, frame);
        for (i, &point) in relative.points.iter().enumerate() {
            let p = carrier.point(relative.tracks.position(i, frame));
            assert!(p.abs_diff_eq(world[point], 1e-11), "point {point}, frame {frame}");
        }
    }
    let mut n_seen = 0;
    clip.visit_world(|frames, tracks| {
        n_seen += frames.len();
        for (i, frame) in frames.enumerate() {
            assert!(tracks.position(3, i).abs_diff_eq(points(&clip, frame)[3], 1e-11));
        }
    });
    assert_eq!(n_seen, clip.n_frames());
}

/// A body that stands: head above feet along `up`, at rest with every rotation 0.
fn body(up: UpAxis, root: &str, root_offset: f64) -> String {
    let along = |v: f64| match up {
        UpAxis::Y => format!("0 {v} 0"),
        UpAxis::Z => format!("0 0 {v}"),
    };
    let joint = "CHANNELS 3 Zrotation Xrotation Yrotation";
    format!(
        "ROOT Hips {{ OFFSET {}\n CHANNELS {root}\n JOINT Leg {{ OFFSET {}\n {joint}\n JOINT Foot {{ OFFSET {}\n {joint}\n \
         End Site {{ OFFSET 0 0 0 }} }} }} JOINT Spine {{ OFFSET {}\n {joint}\n JOINT Head {{ OFFSET {}\n {joint}\n \
         End Site {{ OFFSET {} }} }} }} }}",
        along(root_offset),
        along(-1.0),
        along(-39.0),
        along(20.0),
        along(20.0),
        along(10.0)
    )
}

/// Rows of a body that walks along x, its hips 40 above the floor, its joints swinging by `swing` degrees a frame.
fn walk(up: UpAxis, n_frames: usize, hips: f64, swing: impl Fn(usize) -> f64) -> Vec<Vec<f64>> {
    (0..n_frames)
        .map(|f| {
            let x = 3.0 * f as f64;
            let mut row = match up {
                UpAxis::Y => vec![x, hips, 0.0],
                UpAxis::Z => vec![x, 0.0, hips],
            };
            row.extend([0.0; 3]);
            row.extend([swing(f); 12]);
            row
        })
        .collect()
}

fn walking(up: UpAxis, root_offset: f64, hips: f64, swing: impl Fn(usize) -> f64) -> Clip {
    let rows = walk(up, 40, hips, swing);
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    read(&file(&body(up, &format!("6 {XYZ} Zrotation Xrotation Yrotation"), root_offset), &rows))
}

#[test]
fn up_is_where_the_head_is() {
    for up in [UpAxis::Y, UpAxis::Z] {
        let clip = walking(up, 0.0, 40.0, |f| (f as f64 * 0.5).sin());
        assert_eq!(clip.facts.up.value, up, "{}", clip.facts.up.why);
        assert!((clip.facts.height.value - 90.0).abs() < 1.0);
        assert!(clip.facts.floor.abs() < 1.0);
        let stands = points(&clip, 0);
        assert_near(&stands[..3], &[[0.0, 40.0, 0.0], [0.0, 39.0, 0.0], [0.0, 0.0, 0.0]]);
    }
}

#[test]
fn up_is_where_the_floor_is_when_names_tell_nothing() {
    let nameless = |up| {
        body(up, &format!("6 {XYZ} Zrotation Xrotation Yrotation"), 0.0)
            .replace("Hips", "a")
            .replace("Leg", "b")
            .replace("Foot", "c")
            .replace("Spine", "d")
            .replace("Head", "e")
    };
    for (up, travels) in [(UpAxis::Y, 2), (UpAxis::Z, 1)] {
        let mut rows = walk(up, 40, 40.0, |_| 0.0);
        for (f, row) in rows.iter_mut().enumerate() {
            row[travels] += 4.0 * f as f64;
        }
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let clip = read(&file(&nameless(up), &rows));
        assert_eq!(clip.facts.up.value, up, "{}", clip.facts.up.why);
    }
}

#[test]
fn the_floor_tells_what_root_channels_do() {
    let swing = |f: usize| (f as f64 * 0.5).sin();
    assert_eq!(walking(UpAxis::Y, 40.0, 40.0, swing).facts.root_offset.value, OffsetMeaning::Replace);
    let adds = walking(UpAxis::Z, 40.0, 0.0, swing);
    assert_eq!(adds.facts.root_offset.value, OffsetMeaning::Add);
    assert!(adds.facts.floor.abs() < 1.0 && (points(&adds, 0)[0].y - 40.0).abs() < 1e-12);
    assert_eq!(walking(UpAxis::Y, 0.0, 40.0, swing).facts.root_offset.value, OffsetMeaning::Replace);
}

#[test]
fn rest_frames_are_found_and_only_those() {
    let walk = |f: usize| 20.0 * (f as f64 * 0.05).sin() - 15.0;
    for n in 1..=3 {
        let clip = walking(UpAxis::Y, 0.0, 40.0, |f| if f < n { 30.0 } else { walk(f) });
        assert_eq!((clip.rest_frames(), clip.n_frames()), (n, 40 - n), "{}", clip.facts.rest_frames.why);
        assert_eq!((clip.file_frame(0), clip.translation(0, 0).x), (n, 3.0 * n as f64));
    }
    // Walking at once, standing still, and one that starts fast and comes to rest.
    assert_eq!(walking(UpAxis::Y, 0.0, 40.0, walk).rest_frames(), 0);
    assert_eq!(walking(UpAxis::Y, 0.0, 40.0, |_| 0.0).rest_frames(), 0);
    assert_eq!(walking(UpAxis::Y, 0.0, 40.0, |f| 60.0 * 0.8f64.powi(f as i32)).rest_frames(), 0);
}

/// Hips that hang on a root which stays where it is, turned.
fn hips_below_root(hips_offset: &str) -> String {
    let six = format!("6 {XYZ} Yrotation Xrotation Zrotation");
    let inner = body(UpAxis::Y, &six, 0.0).replacen(
        "ROOT Hips { OFFSET 0 0 0",
        &format!("JOINT Hips {{ OFFSET {hips_offset}"),
        1,
    );
    format!("ROOT World {{ OFFSET 0 0 0\n CHANNELS {six}\n {inner} }}")
}

#[test]
fn the_carrier_is_the_joint_that_moves() {
    let rows: Vec<Vec<f64>> = walk(UpAxis::Y, 30, 40.0, |_| 1.0)
        .into_iter()
        .map(|row| [&[5.0, 0.0, -3.0, 40.0, 0.0, 0.0], &row[..]].concat())
        .collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&hips_below_root("0 0 0"), &rows);
    let clip = read(&bvh);
    assert_eq!(clip.skeleton.joint(clip.facts.carrier.value).name, "Hips", "{}", clip.facts.carrier.why);
    let named = Clip::from_bvh(&bvh, &ClipOptions { carrier: Some("World".to_owned()), ..ClipOptions::default() });
    assert_eq!(named.facts.carrier.value.idx(), 0);
    let unknown = Clip::from_bvh(&bvh, &ClipOptions { carrier: Some("Nobody".to_owned()), ..ClipOptions::default() });
    assert_eq!(unknown.facts.carrier.value, clip.facts.carrier.value);
    assert!(unknown.warnings.iter().any(|w| w.contains("Nobody")));
    check_moved(&bvh, &clip, 30);

    // The same walk with OFFSET 0 40 0 that channels of height 0 add to: only the floor can tell.
    let adding: Vec<Vec<f64>> = rows
        .iter()
        .map(|row| {
            let mut row = row.to_vec();
            row[7] = 0.0;
            row
        })
        .collect();
    let adding: Vec<&[f64]> = adding.iter().map(Vec::as_slice).collect();
    let bvh = file(&hips_below_root("0 40 0"), &adding);
    let clip = read(&bvh);
    assert_eq!(clip.facts.joint_offsets.value, OffsetMeaning::Add, "{}", clip.facts.joint_offsets.why);
    check_moved(&bvh, &clip, 30);
}

/// Turns the carrier a little more every frame, writes, reads, compares.
fn check_moved(bvh: &Bvh, clip: &Clip, n_frames: usize) {
    assert_eq!(clip.n_frames(), n_frames);
    let turn = |f: usize| DQuat::from_rotation_y(0.11 * f as f64) * DQuat::from_rotation_x(0.07 * f as f64);
    let carrier_world = (0..n_frames)
        .map(|f| Rigid::new(turn(f), DVec3::new(1.0 / 3.0, 0.1, f as f64)) * clip.carrier_world(f))
        .collect();
    let edited = EditedClip { carrier_world, ..EditedClip::unedited(Arc::new(clip.clone())) };
    let again = Bvh::parse(to_bvh(bvh, &edited), "again").unwrap_or_else(|e| panic!("{e}"));
    let facts = &clip.facts;
    let again = Clip::from_bvh(
        &again,
        &ClipOptions {
            carrier: None,
            up: Some(facts.up.value),
            root_offset: Some(facts.root_offset.value),
            joint_offsets: Some(facts.joint_offsets.value),
            length: None,
            rest_frames: Some(clip.rest_frames()),
            legs: Vec::new(),
        },
    );
    let mut want = Vec::new();
    for frame in 0..n_frames {
        edited.world_points(frame, &mut want);
        for (want, got) in want.iter().zip(points(&again, frame)) {
            let off = want.distance(got) / facts.height.value;
            assert!(off <= 1e-6, "frame {frame} is off by {off:e} H");
        }
    }
}

#[test]
fn every_rotation_order_is_written_as_it_was_read() {
    for order in ["XYZ", "XZY", "YXZ", "YZX", "ZXY", "ZYX"] {
        let rotations: Vec<String> = order.chars().map(|axis| format!("{axis}rotation")).collect();
        for channels in [format!("6 {XYZ} {}", rotations.join(" ")), format!("6 {} {XYZ}", rotations.join(" "))] {
            let rows: Vec<Vec<f64>> =
                (0..12).map(|f| (0..18).map(|c| f64::from(f) * 1.7 + f64::from(c)).collect()).collect();
            let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
            let bvh = file(&body(UpAxis::Y, &channels, 0.0), &rows);
            check_moved(&bvh, &Clip::from_bvh(&bvh, &as_asked()), 12);
        }
    }
}

#[test]
fn sizes_of_any_unit_are_written_with_digits_enough() {
    for scale in [1e-6, 1e-3, 1.0, 1e3, 1e7] {
        let rows: Vec<Vec<f64>> = (0..12).map(|f| (0..10).map(|c| f64::from(f) + f64::from(c)).collect()).collect();
        let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
        let hierarchy = arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation")
            .replace("OFFSET 1 0 0", &format!("OFFSET {scale} 0 0"))
            .replace("OFFSET 0 1 0", &format!("OFFSET 0 {scale} 0"))
            .replace("OFFSET 0 0 1", &format!("OFFSET 0 0 {scale}"));
        let bvh = file(&hierarchy, &rows);
        check_moved(&bvh, &Clip::from_bvh(&bvh, &as_asked()), 12);
    }
}

#[test]
fn written_angles_go_on_where_the_source_was() {
    // The source stores more than a whole turn; the edit spins on for three turns through every wrap.
    let rows: Vec<Vec<f64>> = (0..200).map(|_| [&[0.0; 3], &[10.0, 0.0, 725.0], &[0.0; 4][..]].concat()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"), &rows);
    let clip = Clip::from_bvh(&bvh, &as_asked());
    let spin = |f: usize| Rigid::new(DQuat::from_rotation_y(-(f as f64) * 5.4f64.to_radians()), DVec3::ZERO);
    let carrier_world = (0..200).map(|f| spin(f) * clip.carrier_world(f)).collect();
    let edited = EditedClip { carrier_world, ..EditedClip::unedited(Arc::new(clip)) };
    let again = Bvh::parse(to_bvh(&bvh, &edited), "again").unwrap_or_else(|e| panic!("{e}"));
    assert_eq!(again.frame(0), bvh.frame(0), "the first frame was not turned");
    for f in 1..200 {
        for channel in 3..6 {
            let step = (again.frame(f)[channel] - again.frame(f - 1)[channel]).abs();
            assert!(step < 12.0, "frame {f}, channel {channel}: a step of {step}°");
        }
    }
}

/// Written angles were once continuous in themselves, and met the file's own by a leap of a whole turn.
#[test]
fn written_angles_meet_those_of_the_source_as_they_come_back() {
    // Once around and back to −180° again and again, and now and then on the other triple of the same pose.
    let arm_degrees = |f: usize| match (20.0 * f as f64 + 175.0) % 360.0 - 180.0 {
        z if f % 11 == 5 => [z - 180.0, 150.0, -170.0],
        z => [z, 30.0, 10.0],
    };
    let rows: Vec<Vec<f64>> = (0..60).map(|f| [&[0.0; 6][..], &arm_degrees(f), &[0.0]].concat()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"), &rows);
    let clip = Arc::new(Clip::from_bvh(&bvh, &as_asked()));
    let joint = clip.skeleton.find("Arm").expect("there is one");
    let pi = std::f64::consts::PI;
    let swell = |f: usize| 0.5 * ((f as f64 - 7.0) / 43.0 * pi).sin();
    // A half turn, from which two ways lead back.
    let back = |f: usize| pi * (1.0 - f as f64 / 31.0);
    for (range, turn) in [(7..50, &swell as &dyn Fn(usize) -> f64), (0..31, &back)] {
        let turn = |f: usize| if range.contains(&f) { turn(f) } else { 0.0 };
        let rotations = (0..60).map(|f| DQuat::from_rotation_z(turn(f)) * clip.rotations(f)[joint.idx()]).collect();
        let turned = vec![TurnedJoint { joint, rotations }];
        let edited = EditedClip { turned, ..EditedClip::unedited(Arc::clone(&clip)) };
        let again = Bvh::parse(to_bvh(&bvh, &edited), "again").unwrap_or_else(|e| panic!("{e}"));
        let added = |f: usize, channel: usize| again.frame(f)[channel] - bvh.frame(f)[channel];
        for (f, channel) in (1..60).flat_map(|f| (6..9).map(move |channel| (f, channel))) {
            let step = (added(f, channel) - added(f - 1, channel)).abs();
            assert!(step < 20.0, "{range:?}, frame {f}, channel {channel}: {step}° more");
        }
        assert!((range.end..60).all(|f| again.frame(f) == bvh.frame(f)), "{range:?}");
    }
}

#[test]
fn only_what_moved_is_written_anew() {
    let rows: Vec<Vec<f64>> = (0..4).map(|f| (0..10).map(|c| 0.1 + f64::from(f * 10 + c)).collect()).collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"), &rows);
    let clip = Clip::from_bvh(&bvh, &as_asked());
    let mut carrier_world = clip.carrier_track();
    carrier_world[2].translation.y += 1.0;
    let edited = EditedClip { carrier_world, ..EditedClip::unedited(Arc::new(clip)) };
    let written = String::from_utf8(to_bvh(&bvh, &edited)).expect("it is text");
    let source = String::from_utf8(bvh.text().to_vec()).expect("it is text");
    assert_eq!(written.replace("22.1000000", "21.1"), source);
}

/// A joint that is turned at some frames only keeps its characters at all others, also where the file wraps and changes
/// from one triple of a pose to the other.
#[test]
fn a_turned_joint_keeps_the_characters_of_frames_at_which_it_is_not_turned() {
    let arm_degrees = |f: usize| match f % 3 {
        0 => [170.0 + f as f64, 30.0, 15.0],
        1 => [-189.0 + f as f64, 29.5, 15.5],
        _ => [-10.0 + f as f64, 150.0, -165.0],
    };
    let rows: Vec<Vec<f64>> = (0..30)
        .map(|f| [&[0.1 + f as f64, 2.0, 3.0, 10.0, 20.0, 30.0][..], &arm_degrees(f), &[0.25]].concat())
        .collect();
    let rows: Vec<&[f64]> = rows.iter().map(Vec::as_slice).collect();
    let bvh = file(&arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation"), &rows);
    let clip = Arc::new(Clip::from_bvh(&bvh, &as_asked()));
    let joint = clip.skeleton.find("Arm").expect("there is one");
    let own: Vec<DQuat> = (0..30).map(|f| clip.rotations(f)[joint.idx()]).collect();
    let line = |text: &[u8], frame: usize| {
        let (_, motion) = str::from_utf8(text).expect("text").split_once("Frame Time: 0.04\n").expect("a header");
        motion.lines().nth(frame).expect("the frame").to_owned()
    };

    let same = vec![TurnedJoint { joint, rotations: own.iter().map(|&q| -q).collect() }];
    let edited = EditedClip { turned: same, ..EditedClip::unedited(Arc::clone(&clip)) };
    assert!(to_bvh(&bvh, &edited) == **bvh.text(), "turned to where it is at every frame");

    for turns in [&[4][..], &[0, 1, 2, 17], &[28, 29]] {
        let mut rotations = own.clone();
        turns.iter().for_each(|&f| rotations[f] *= DQuat::from_rotation_x(0.2));
        let turned = vec![TurnedJoint { joint, rotations }];
        let edited = EditedClip { turned, ..EditedClip::unedited(Arc::clone(&clip)) };
        let written = to_bvh(&bvh, &edited);
        for frame in 0..30 {
            let (source, found) = (line(bvh.text(), frame), line(&written, frame));
            let pairs = source.split_whitespace().zip(found.split_whitespace());
            let differ: Vec<usize> = pairs.enumerate().filter(|(_, (a, b))| a != b).map(|(i, _)| i).collect();
            if turns.contains(&frame) {
                assert!(differ.contains(&8) && differ.iter().all(|i| (6..9).contains(i)), "{frame}: {differ:?}");
            } else {
                assert_eq!(found, source, "frame {frame}");
            }
        }
    }
}

#[test]
fn what_a_file_lacks_becomes_a_warning() {
    let six = format!("6 {XYZ} Zrotation Xrotation Yrotation");
    let none = read(&file(&body(UpAxis::Y, &six, 40.0), &[]));
    assert_eq!((none.n_frames(), none.n_file_frames(), none.facts.path_editable), (120, 120, true));
    assert!(none.warnings[0].contains("no frames; its rest pose stands for 120"), "{}", none.warnings[0]);
    assert_near(&points(&none, 0)[..2], &[[0.0, 40.0, 0.0], [0.0, 39.0, 0.0]]);

    let row: &[f64] = &[1.0, 2.0, 3.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0];
    let hierarchy = arm(&six, "3 Zrotation Yrotation Xrotation");
    let one =
        Clip::from_bvh(&file(&hierarchy, &[row]), &ClipOptions { rest_frames: Some(5), length: Some(1), ..as_asked() });
    assert_eq!((one.n_frames(), one.rest_frames()), (1, 0));
    assert!(one.warnings.iter().any(|w| w.contains("5 rest frames")), "{:?}", one.warnings);

    let turning = read(&file(&arm("3 Zrotation Xrotation Yrotation", "0"), &[&[10.0; 4], &[20.0; 4]]));
    assert!(!turning.facts.path_editable);
    assert!(turning.warnings.iter().any(|w| w.contains("cannot be edited")), "{:?}", turning.warnings);

    let still = read(&file("ROOT Root { OFFSET 0 0 0\n CHANNELS 0 }", &[]));
    assert_eq!((still.facts.height.value, still.facts.floor, still.facts.path_editable), (1.0, 0.0, false));
    assert_eq!(points(&still, 0), [DVec3::ZERO]);

    let text = String::from_utf8(file(&hierarchy, &[row]).text().to_vec()).expect("it is text");
    let no_time = text.replace("Frame Time: 0.04", "Frame Time: 0");
    let no_time = read(&Bvh::parse(no_time.into_bytes(), "test").unwrap_or_else(|e| panic!("{e}")));
    assert_eq!(no_time.frame_time_secs, 1.0 / 30.0);
    assert!(no_time.warnings.iter().any(|w| w.contains("frame time")));
}

#[test]
fn numbers_beyond_reason_do_no_harm() {
    let hierarchy = arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "3 Zrotation Yrotation Xrotation");
    let row = [1.0; 10];
    let mut far = row;
    (far[0], far[3], far[6]) = (1e300, 1e50, -1e15);
    let clip = read(&file(&hierarchy, &[&row, &far, &row]));
    for frame in 0..3 {
        assert!(points(&clip, frame).iter().all(|p| p.is_finite()));
        assert!(clip.rotations(frame).iter().all(|q| (q.length() - 1.0).abs() < 1e-12));
    }
    assert_eq!(clip.translation(1, 0), clip.translation(0, 0), "the frame before stands in");
    assert!(clip.warnings.iter().any(|w| w.contains("no numbers")));
}

#[test]
fn two_roots_make_one_clip() {
    let one = arm(&format!("6 {XYZ} Zrotation Xrotation Yrotation"), "0");
    let two = format!("{one}\n{}", one.replace("Root", "Second"));
    let row = [0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 0.0, 9.0, 0.0, 0.0, 90.0, 0.0, 0.0, 0.0];
    let clip = Clip::from_bvh(&file(&two, &[&row]), &as_asked());
    let found = points(&clip, 0);
    assert_near(
        &found[..6],
        &[[0.0; 3], [1.0, 0.0, 0.0], [1.0, 1.0, 0.0], [9.0, 0.0, 0.0], [9.0, 1.0, 0.0], [8.0, 1.0, 0.0]],
    );
}
