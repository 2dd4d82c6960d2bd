//! Files without motion of their own, with one frame or none: stationary clips of a chosen length, from reading to
//! writing, and through the whole solve.
//!
//! Captured clips are found through `WALKABOUT_CLIPS`; without it those tests say loudly that they were skipped, and
//! fail in CI.

use std::{path::PathBuf, sync::Arc};

use glam::{DQuat, DVec3, Vec3Swizzles};
use walkabout::{
    bvh::Bvh,
    displace::Layer,
    document::{Change, Document, Edits, Opened, Source, parameter, parse_assignment},
    editor::{Editor, TABS, Tab},
    math::Rigid,
    motion::{
        Clip, ClipOptions, DEFAULT_LENGTH, EditedClip, Length, MAX_LENGTH, TurnedJoint, gait, n_written_frames, to_bvh,
    },
    skeleton::JointId,
};

const HEAD: &str = "HIERARCHY\nROOT Hips\n{\n OFFSET 0 40 0\n CHANNELS 6 Xposition Yposition Zposition \
    Zrotation Xrotation Yrotation\n JOINT LeftLeg\n {\n  OFFSET 4 0 0\n  CHANNELS 3 Zrotation Xrotation Yrotation\n  \
    End Site\n  {\n   OFFSET 0 -40 0\n  }\n }\n JOINT Head\n {\n  OFFSET 0 40 0\n  CHANNELS 1 Yrotation\n  End Site\n  \
    {\n   OFFSET 0 10 0\n  }\n }\n}\n";
const ROW: &str = "1.50  40 -2.0\t5e1 6 7.000 8 9 1.0e1 0.125";

fn one_frame() -> Bvh {
    parse(format!("{HEAD}MOTION\nFrames: 1\nFrame Time: .04\n{ROW}\n"))
}

fn no_frames() -> Bvh {
    parse(format!("{HEAD}MOTION\nFrames: 0\nFrame Time: .04\n"))
}

fn no_motion() -> Bvh {
    parse(HEAD.to_owned())
}

fn parse(text: String) -> Bvh {
    Bvh::parse(text.into_bytes(), "test").unwrap_or_else(|e| panic!("{e}"))
}

fn read(bvh: &Bvh, length: Option<usize>) -> Arc<Clip> {
    Arc::new(Clip::from_bvh(bvh, &ClipOptions { length, ..ClipOptions::default() }))
}

/// Returns the rows of a written file, as text.
fn rows(written: &[u8], n_frames: usize) -> Vec<String> {
    let text = str::from_utf8(written).expect("text");
    let (_, motion) = text.split_once("MOTION\n").expect("a motion section");
    let lines: Vec<_> = motion.lines().map(str::to_owned).collect();
    assert_eq!(lines[0], format!("Frames: {n_frames}"));
    assert!(lines[1].starts_with("Frame Time: "), "{}", lines[1]);
    lines[2..].to_vec()
}

fn clips() -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("WALKABOUT_CLIPS").map(PathBuf::from) else {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS is not set");
        eprintln!("SKIPPED: WALKABOUT_CLIPS is not set, so no clip was tried");
        return Vec::new();
    };
    let names = ["quirks/27_zero_frames", "quirks/28_no_motion", "real/makehuman_pose_891_channels"];
    names.map(|name| folder.join(format!("{name}.bvh"))).to_vec()
}

#[test]
fn one_pose_lasts_as_long_as_is_chosen() {
    for (bvh, frame_time) in [(one_frame(), 0.04), (no_frames(), 0.04), (no_motion(), 1.0 / 30.0)] {
        for (asked, n_frames, length) in
            [(None, DEFAULT_LENGTH, Length::Default), (Some(1), 1, Length::Chosen), (Some(7), 7, Length::Chosen)]
        {
            let clip = read(&bvh, asked);
            assert_eq!((clip.n_file_frames(), clip.n_frames(), clip.length), (n_frames, n_frames, length));
            assert_eq!((clip.frame_time_secs, clip.facts.path_editable), (frame_time, true));
            let (mut first, mut last) = (Vec::new(), Vec::new());
            clip.world_points(0, &mut first);
            clip.world_points(n_frames - 1, &mut last);
            assert_eq!(first, last);
            assert_eq!(clip.rotation_degrees(1), vec![clip.rotation_degrees(1)[0]; n_frames]);
        }
    }
    let turned = read(&one_frame(), None).rotation_degrees(1)[50];
    assert_eq!(turned, [8.0, 9.0, 10.0]);
    let mut rest = Vec::new();
    read(&no_motion(), None).world_points(5, &mut rest);
    assert_eq!(rest[0], DVec3::Y * 40.0, "channels that are 0 and add to OFFSET leave it in its rest pose");
}

#[test]
fn a_length_is_for_files_without_motion_only_and_has_bounds() {
    let two = parse(format!("{HEAD}MOTION\nFrames: 2\nFrame Time: .04\n{ROW}\n{ROW}\n"));
    let clip = read(&two, Some(9));
    assert_eq!((clip.n_file_frames(), clip.length), (2, Length::Own));
    assert!(clip.warnings.iter().any(|w| w.contains("clip.length 9 is not used")), "{:?}", clip.warnings);
    assert_eq!(to_bvh(&two, &EditedClip::unedited(clip))[..], two.text()[..]);
    assert_eq!(read(&one_frame(), Some(usize::MAX)).n_frames(), MAX_LENGTH);

    let nest = "JOINT a\n{\nOFFSET 0 1 0\nCHANNELS 0\n".repeat(3000);
    let deep = parse(format!("HIERARCHY\nROOT a\n{{\nOFFSET 0 1 0\nCHANNELS 1 Xposition\n{nest}{}", "}".repeat(3001)));
    let clip = read(&deep, Some(MAX_LENGTH));
    assert!(clip.n_frames() * 3001 <= 20_000_000, "{}", clip.n_frames());
    assert!(clip.warnings.iter().any(|w| w.contains("too many")), "{:?}", clip.warnings);
}

#[test]
fn an_export_is_the_file_until_something_is_done_or_a_length_is_chosen() {
    for bvh in [one_frame(), no_frames(), no_motion(), parse("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}".to_owned())] {
        let clip = read(&bvh, None);
        assert_eq!(to_bvh(&bvh, &EditedClip::unedited(Arc::clone(&clip)))[..], bvh.text()[..]);
        let carrier_world = if clip.facts.path_editable { clip.carrier_track() } else { Vec::new() };
        let placed = EditedClip { carrier_world, ..EditedClip::unedited(clip) };
        assert_eq!(to_bvh(&bvh, &placed)[..], bvh.text()[..], "where it stands already");
    }
    // Elsewhere, but standing still, it is one frame; a file without frames gets one.
    for bvh in [one_frame(), no_frames(), no_motion()] {
        let clip = read(&bvh, None);
        let elsewhere = Rigid::new(DQuat::from_rotation_y(0.2), DVec3::new(1.0, 2.0, 3.0));
        let carrier_world = clip.carrier_track().into_iter().map(|carrier| elsewhere * carrier).collect();
        let edited = EditedClip { carrier_world, ..EditedClip::unedited(clip) };
        assert_eq!((rows(&to_bvh(&bvh, &edited), 1).len(), n_written_frames(&bvh, &edited)), (1, 1));
    }
    let written = to_bvh(&one_frame(), &EditedClip::unedited(read(&one_frame(), Some(3))));
    assert_eq!(rows(&written, 3), [ROW; 3]);
    for bvh in [no_frames(), no_motion()] {
        let written = to_bvh(&bvh, &EditedClip::unedited(read(&bvh, Some(3))));
        assert!(written.starts_with(HEAD.as_bytes()));
        assert_eq!(rows(&written, 3), ["0 0 0 0 0 0 0 0 0 0"; 3]);
    }
    assert_eq!(to_bvh(&one_frame(), &EditedClip::unedited(read(&one_frame(), Some(1))))[..], one_frame().text()[..]);
}

#[test]
fn what_is_turned_at_one_frame_is_written_at_that_frame_alone() {
    let leg = JointId(1);
    for bvh in [one_frame(), no_frames(), no_motion()] {
        let clip = read(&bvh, None);
        let own = clip.rotations(0)[leg.idx()];
        let mut rotations = vec![own; DEFAULT_LENGTH];
        rotations[60] = own * DQuat::from_rotation_x(0.3);
        let mut carrier_world = clip.carrier_track();
        carrier_world[70] = Rigid::new(carrier_world[70].rotation, carrier_world[70].translation + 2.0 * DVec3::X);
        let turned = vec![TurnedJoint { joint: leg, rotations }];
        let edited = EditedClip { carrier_world, turned, ..EditedClip::unedited(Arc::clone(&clip)) };
        let written = to_bvh(&bvh, &edited);
        let rows = rows(&written, DEFAULT_LENGTH);
        let source = if bvh.n_frames() == 1 { ROW } else { "0 0 0 0 0 0 0 0 0 0" };
        for (frame, row) in rows.iter().enumerate() {
            let words = |text: &str| text.split_whitespace().map(str::to_owned).collect::<Vec<_>>();
            let (row, source) = (words(row), words(source));
            let differ: Vec<usize> = (0..source.len()).filter(|&i| row[i] != source[i]).collect();
            match frame {
                60 => assert!(!differ.is_empty() && differ.iter().all(|i| (6..9).contains(i)), "{differ:?}"),
                70 => assert_eq!(differ, [0]),
                _ => assert_eq!(differ, [0; 0], "frame {frame}"),
            }
        }
        let facts = &clip.facts;
        let options = ClipOptions { root_offset: Some(facts.root_offset.value), ..ClipOptions::default() };
        let again = Clip::from_bvh(&Bvh::parse(written, "again").unwrap_or_else(|e| panic!("{e}")), &options);
        assert_eq!((again.length, again.n_frames()), (Length::Own, DEFAULT_LENGTH));
        let (mut want, mut got) = (Vec::new(), Vec::new());
        for frame in 0..DEFAULT_LENGTH {
            edited.world_points(frame, &mut want);
            again.world_points(frame, &mut got);
            let off = want.iter().zip(&got).map(|(a, b)| a.distance(*b)).fold(0.0, f64::max);
            assert!(off <= 1e-6 * facts.height.value, "frame {frame} is off by {off:e}");
        }
    }
}

fn document(bvh: &Bvh, set: &[&str]) -> Document {
    let mut edits = Edits::default();
    for text in set {
        let (name, value) = parse_assignment(text).expect("an assignment");
        parameter(&name).and_then(|p| p.set(&mut edits, &value)).unwrap_or_else(|e| panic!("{e}"));
    }
    let source = Arc::new(Source { name: "still".to_owned(), file: None, bvh: bvh.clone() });
    Document::new(Opened { source, edits, project: None, warnings: Vec::new() })
}

#[test]
fn keys_on_a_stationary_clip_make_a_motion() {
    for (bvh, length) in [(one_frame(), None), (no_frames(), None), (no_motion(), Some(40))] {
        let n_frames = length.unwrap_or(DEFAULT_LENGTH);
        let mut edits = Edits::default();
        edits.clip.length = length;
        let mut layer = Layer::new("wave");
        layer.set_rotation("LeftLeg", 0, DQuat::IDENTITY);
        layer.set_rotation("LeftLeg", n_frames - 1, DQuat::from_rotation_x(1.0));
        edits.layers = vec![layer];
        let source = Arc::new(Source { name: "still".to_owned(), file: None, bvh });
        let document = Document::new(Opened { source, edits, project: None, warnings: Vec::new() });
        let solved = document.solved();
        assert_eq!((solved.n_exported_frames(), solved.n_shown_frames()), (n_frames, n_frames));
        let again = Bvh::parse(solved.to_bvh(), "again").unwrap_or_else(|e| panic!("{e}"));
        let again = Clip::from_bvh(&again, &ClipOptions::default());
        let turn = |frame: usize| {
            let [first, here] = [0, frame].map(|frame| again.rotations(frame)[1]);
            (first.conjugate() * here).to_axis_angle().1
        };
        for frame in 1..n_frames {
            let wanted = frame as f64 / (n_frames - 1) as f64;
            assert!((turn(frame) - wanted).abs() < 1e-6, "frame {frame}: {} {wanted}", turn(frame));
        }
    }
}

/// Checks that a document's knees turn about the axis across the body only, to the back, and little from frame to frame.
#[track_caller]
fn check_knees(document: &Document, what: &str) {
    let solved = document.solved();
    let edited = &solved.edited;
    let mut most = 0.0f64;
    for name in ["LeftKnee", "RightKnee"] {
        let knee = edited.clip.skeleton.find(name).expect("a knee");
        let bend = |frame: usize| edited.rotation(frame, knee).to_scaled_axis();
        for frame in 0..edited.n_frames() {
            let now = bend(frame);
            most = most.max(now.x);
            // Rounding apart; the foot of the built-in figure points outwards a little.
            assert!(now.x > -1e-6 && now.yz().length() < 0.25 * now.x + 1e-6, "{what}: {name} at {frame}: {now}");
            let step = (now - bend(frame.saturating_sub(1))).length().to_degrees();
            assert!(step < 12.0, "{what}: {name} turns by {step}° at {frame}");
        }
    }
    assert!(most > 0.02, "{what}: no knee bends, so nothing was tried");
}

/// A figure whose zero pose has dead straight legs shows no hinge of its own, however often.
#[test]
fn straight_legs_bend_forward() {
    let (text, _) = gait::built_in();
    let (head, _) = text.split_once("MOTION").expect("a motion section");
    let row = format!("0 97.05 0{}", " 0".repeat(63));
    let still = document(&parse(format!("{head}MOTION\nFrames: 1\nFrame Time: .016667\n{row}\n")), &[]);
    let mut editor = Editor::new(still, Vec::new());
    while TABS[editor.view().tab_idx] != Tab::Joints {
        editor.keys("<tab>");
    }
    editor.keys(&format!("gt{}", ".".repeat(60)));
    for keys in ["zz", "YY"] {
        editor.keys(keys);
        assert_eq!(editor.view().frame_idx, 60);
        check_knees(editor.document(), keys);
    }
    let walk = parse(text);
    for set in [&["clip.clear_rotation=true"][..], &["clip.clear_rotation=true", "timing.cycling=blended"]] {
        let mut document = document(&walk, set);
        check_knees(&document, "cleared");
        for shape in ["s", "circle"] {
            let shape = Some(shape.parse().expect("a shape"));
            document.apply(&Change::Set { values: Vec::new(), shape }, false).expect("a shape");
            check_knees(&document, "cleared on a shape");
        }
    }
}

#[test]
fn a_length_that_nobody_chose_is_stepped_from_the_one_in_use() {
    for (keys, expected) in [("+", 121), ("-", 119), ("]", 130), ("[", 110), ("++-", 121)] {
        let mut editor = Editor::new(document(&one_frame(), &[]), Vec::new());
        while TABS[editor.view().tab_idx] != Tab::Clip {
            editor.keys("<tab>");
        }
        editor.keys("jjjj");
        assert!(editor.rows().iter().any(|row| row.selected && row.label == "clip.length"));
        editor.keys(keys);
        assert_eq!(editor.document().edits().clip.length, Some(expected), "{keys}");
        assert_eq!(editor.document().solved().clip.n_frames(), expected, "{keys}");
    }
}

/// Every file in every mode that could trip over a clip that goes nowhere.
#[test]
fn the_whole_program_works_on_them() {
    let mut files =
        vec![one_frame(), no_frames(), no_motion(), parse("HIERARCHY\nROOT a\n{\nOFFSET 0 0 0\n}".to_owned())];
    for file in clips() {
        files.push(Bvh::parse(std::fs::read(&file).expect("the clip"), "clip").expect("it reads"));
    }
    for bvh in &files {
        for (set, as_is) in [
            (&[][..], true),
            (&["path.edited=false"], true),
            (&["clip.length=1"], false),
            (&["clip.length=40", "clip.rest_frames=3"], false),
            (&["timing.cycling=blended", "path.points=9", "clip.length=9"], false),
            (&["timing.cycling=plain"], true),
            (&["timing.arc_length=false"], false),
            (&["timing.integrator=euler", "plants.clean=true", "plants.hold=false", "clip.up=z"], false),
        ] {
            let document = document(bvh, set);
            let solved = document.solved();
            let written = solved.to_bvh();
            if as_is {
                assert!(written[..] == bvh.text()[..], "{set:?}: {}", String::from_utf8_lossy(&written));
            }
            if bvh.n_channels() > 0 {
                let again = Bvh::parse(written, "written").unwrap_or_else(|e| panic!("{set:?}: {e}"));
                assert_eq!(again.n_frames(), solved.n_exported_frames(), "{set:?}");
                assert!(again.values().iter().all(|v| v.is_finite()), "{set:?}");
            }
            let mut editor = Editor::new(document.clone(), Vec::new());
            for keys in ["sc", "sl", "C", "C", "R", "se", "vr", "<end>", "<space>"] {
                editor.keys(keys);
                editor.advance(0.2);
                let solved = editor.document().solved();
                let mut points = Vec::new();
                solved.edited.world_points(solved.edited.n_frames() - 1, &mut points);
                assert!(points.iter().all(|p| p.is_finite()), "{set:?} {keys}");
                let scene = editor.scene();
                assert!(scene.now.actors.iter().flatten().all(|p| p.is_finite()), "{set:?} {keys}");
            }
        }
    }
}
