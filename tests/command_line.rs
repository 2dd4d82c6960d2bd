//! The program from the command line, on every captured clip: info, measure, export, render, and what it refuses.
//!
//! Captured clips are found through `WALKABOUT_CLIPS`; without it those tests say loudly that they were skipped, and
//! fail in CI.

use std::{
    path::{Path, PathBuf},
    process::{Command, Output},
};

use serde_json::Value;
use walkabout::bvh::Bvh;

fn walkabout(args: &[&str]) -> Output {
    let mut command = Command::new(env!("CARGO_BIN_EXE_walkabout"));
    command.args(args).output().expect("the program starts")
}

#[track_caller]
fn done(args: &[&str]) -> String {
    let output = walkabout(args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert!(output.status.success(), "{args:?} ended with {}: {errors}", output.status);
    String::from_utf8(output.stdout).expect("UTF-8")
}

#[track_caller]
fn refused(args: &[&str], status: i32, words: &str) {
    let output = walkabout(args);
    let errors = String::from_utf8_lossy(&output.stderr);
    assert_eq!(output.status.code(), Some(status), "{args:?}: {errors}");
    assert!(errors.contains(words), "{args:?} said: {errors}");
    assert!(!errors.contains("panicked"), "{args:?}: {errors}");
}

fn json(args: &[&str]) -> Value {
    serde_json::from_str(&done(args)).expect("JSON")
}

/// The captured clips, or none with a loud word; in CI they must be there.
fn real_clips() -> Vec<PathBuf> {
    let Some(folder) = std::env::var_os("WALKABOUT_CLIPS") else {
        assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS is not set");
        eprintln!("SKIPPED: WALKABOUT_CLIPS is not set, so no captured clip was tried");
        return Vec::new();
    };
    let files = std::fs::read_dir(Path::new(&folder).join("real")).expect("the folder of captured clips");
    let mut clips: Vec<_> = files.map(|f| f.expect("a file").path()).collect();
    clips.retain(|f| f.extension().is_some_and(|e| e == "bvh"));
    clips.sort();
    assert!(!clips.is_empty(), "there are captured clips");
    clips
}

fn text(path: &Path) -> &str {
    path.to_str().expect("UTF-8")
}

#[test]
fn info_and_measure_say_what_scripts_expect() {
    let info_keys = [
        "file",
        "frames",
        "frame_time",
        "joints",
        "channels",
        "carrier",
        "up",
        "offsets",
        "rest_frames",
        "height",
        "unit",
        "path_length",
        "legs",
        "plants",
        "warnings",
    ];
    let measure_keys = [
        "file",
        "frames",
        "frame_time",
        "height",
        "unit",
        "path_length",
        "original_degree",
        "feet",
        "residual_rms",
        "jerk_ratio",
        "path_error",
        "seam",
        "warnings",
    ];
    for clip in real_clips() {
        for (verb, keys) in [("info", &info_keys[..]), ("measure", &measure_keys[..])] {
            let report = json(&[verb, text(&clip), "--json"]);
            let found: Vec<_> = report.as_object().expect("an object").keys().collect();
            assert!(keys.iter().all(|k| report.get(k).is_some()), "{verb} {}: {found:?}", clip.display());
            assert_eq!(found.len(), keys.len(), "{verb} {}: {found:?}", clip.display());
            assert!(done(&[verb, text(&clip)]).lines().count() > 5);
        }
    }
}

#[test]
fn maps_prints_the_keys_of_a_project() {
    let layer = "layer=[{name='wave', weight=0.5, interpolation='euler_cubic', position=[{frame=7, value=[0.25,0,-1]}], \
                 rotation={LeftElbow=[{frame=3, value=[0.5,0.5,0.5,0.5]}], Neck=[{frame=3, value=[1,0,0,0]}]}}]";
    let all = done(&["maps", "--set", layer, "--set", "interpolation_keys=[10, 20]"]);
    assert_eq!(
        all,
        "wave: on, weight 0.5, Euler cubic\n  frame      3  LeftElbow  120.000° about [0.577, 0.577, 0.577]\n  \
         frame      3  Neck  0.000° about [0.000, 0.000, 0.000]\n  \
         frame      7  position  lateral 0.2500  up 0.0000  forward -1.0000\ninterpolated between frames 10 and 20\n"
    );
    let far = "layer=[{name='far', position=[{frame=7, value=[1e300,-2.5e9,123456.78]}]}]";
    let far = done(&["maps", "--set", far]);
    assert!(far.ends_with("lateral 1.0000e300  up -2.5000e9  forward 123456.7800\n"), "{far}");
    let neck = done(&["maps", "--set", layer, "--joint", "Neck"]);
    assert_eq!(neck.lines().count(), 2, "{neck}");
    let value = json(&["maps", "--json", "--position", "--set", layer]);
    assert_eq!(
        value["layers"][0]["points"],
        serde_json::json!([{ "frame": 7, "map": "position", "value": [0.25, 0.0, -1.0] }])
    );
    assert_eq!(value["layers"][0]["interpolation"], "euler_cubic");
    let zeros = "layer=[{name='zeros', position=[{frame=7, value=[-0.0,-0.00001,1]}], \
                 rotation={Neck=[{frame=3, value=[0.5,-0.0,-1,-1]}]}}]";
    let printed = done(&["maps", "--set", zeros]);
    assert!(
        printed.contains("lateral 0.0000  up 0.0000  forward") && printed.contains("[0.000, -0.707, "),
        "{printed}"
    );
    let printed = done(&["maps", "--json", "--set", zeros]);
    assert!(!printed.contains("-0.0,") && !printed.contains("-0.0\n"), "{printed}");
    let merged = "layer=[{name='a', merged=true, on=false}, {name='b', merged=true, weight=0.5}]";
    let merged = done(&["maps", "--set", merged]);
    let [a, _, b, _] = merged.lines().collect::<Vec<_>>()[..] else { panic!("{merged}") };
    assert_eq!([a, b], ["a: off, merged, weight 1, quaternion", "b: merged, weight 0.5, quaternion"]);
    assert_eq!(done(&["maps"]), "no layers\n");
    refused(&["maps", "--joint", "Nobody"], 2, "there is no joint Nobody");
    refused(&["maps", "--set", "layer=[{name='a', weight=2}]"], 2, "weight is 0 to 1");
}

#[test]
fn plants_and_feet_are_told_with_the_source_beside_the_edited_clip() {
    let info = json(&["info", "--json"]);
    assert_eq!(info["legs"].as_array().map(Vec::len), Some(2));
    assert_eq!(info["legs"][0]["side"], "left");
    assert_eq!(["left", "right"].map(|side| info["plants"][side].as_array().map(Vec::len)), [Some(7); 2]);
    let speeds = |args: &[&str]| {
        let report = json(&[&["measure", "--json"], args].concat());
        let of = |foot: usize, which: &str| report["feet"][foot]["planted_speed"][which].as_f64().expect("a speed");
        [0, 1].map(|foot| (of(foot, "source"), of(foot, "edited")))
    };
    let report = json(&["measure", "--json", "--shape", "circle", "--set", "plants.hold=false"]);
    let height = report["height"]["source"].as_f64().expect("a height");
    let text = done(&["measure", "--shape", "circle", "--set", "plants.hold=false"]);
    let mut told = text.lines().filter(|line| line.trim_start().starts_with("planted speed"));
    for foot in 0..2 {
        let of = |which: &str| report["feet"][foot]["planted_speed"][which].as_f64().expect("a speed");
        let (source, edited) = (of("source"), of("edited"));
        let words: Vec<&str> = told.next().expect("a line for each foot").split_whitespace().collect();
        let (source_cm, edited_cm) = (source * height, edited * height);
        assert_eq!(words[2..5], [&format!("{source:.5}"), "→", &format!("{edited:.5}")]);
        assert_eq!(words[5..], ["H/s;", &format!("{source_cm:.3}"), "→", &format!("{edited_cm:.3}"), "cm/s"]);
    }
    for (source, edited) in speeds(&["--set", "path.edited=false"]) {
        assert!((edited - source).abs() < 1e-9, "{source} {edited}");
    }
    for (source, edited) in speeds(&["--shape", "circle"]) {
        assert!((edited / source - 1.0).abs() < 0.02, "held, feet slide as the performer's do: {source} {edited}");
    }
    for (source, edited) in speeds(&["--shape", "circle", "--set", "plants.clean=true"]) {
        assert!(edited < 0.1 * source, "cleaned, they stand still: {source} {edited}");
    }
    for (source, edited) in speeds(&["--shape", "circle", "--set", "plants.hold=false"]) {
        assert!(edited > 1.5 * source, "carried rigidly, feet slide: {source} {edited}");
    }
}

#[test]
fn scripts_can_refuse_an_edit_by_its_numbers() {
    let held = ["measure", "--shape", "circle", "--fail", "slip_ratio=1.05", "--fail", "missed=0", "--json"];
    let output = walkabout(&held);
    assert!(output.status.success(), "{}", String::from_utf8_lossy(&output.stderr));
    let slides =
        ["measure", "--shape", "circle", "--set", "plants.hold=false", "--fail", "slip=0.02", "--fail", "missed=0"];
    let output = walkabout(&slides);
    assert_eq!(output.status.code(), Some(1));
    let told = String::from_utf8_lossy(&output.stderr);
    assert!(told.contains("slip of LeftAnkle is 0.") && told.contains(", more than 0.02"), "{told}");
    assert!(!output.stdout.is_empty(), "the numbers are printed all the same");
    assert_eq!(walkabout(&["measure", "--fail", "slop=1"]).status.code(), Some(2));
}

/// A torso that glides along a straight line at one speed.
fn torso() -> String {
    let joint = |name: &str, offset: &str| {
        format!("JOINT {name}\n{{\nOFFSET {offset}\nCHANNELS 3 Zrotation Xrotation Yrotation\n")
    };
    let mut text = "HIERARCHY\nROOT Hips\n{\nOFFSET 0 0 0\n\
                    CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\n"
        .to_owned();
    text += &(joint("Spine", "0 20 0") + &joint("Chest", "0 25 0"));
    for (side, x) in [("Left", 1), ("Right", -1)] {
        text += &joint(&format!("{side}Arm"), &format!("{} 0 0", 15 * x));
        text += &joint(&format!("{side}ForeArm"), "0 -30 0");
        text += &(joint(&format!("{side}Hand"), "0 -27 0") + "End Site\n{\nOFFSET 0 -10 0\n}\n}\n}\n}\n");
    }
    text += &(joint("Head", "0 15 0") + "End Site\n{\nOFFSET 0 20 0\n}\n}\n}\n}\n}\n");
    text += "MOTION\nFrames: 60\nFrame Time: 0.0333333\n";
    (0..60).for_each(|frame| text += &format!("{} 100 {} {}\n", 2 * frame, 3 * frame, "0 ".repeat(30)));
    text
}

#[test]
fn a_clip_without_legs_says_so_wherever_it_is_read() {
    let folder = tempfile::tempdir().expect("a folder");
    let (clip, out) = (folder.path().join("torso.bvh"), folder.path().join("out.bvh"));
    std::fs::write(&clip, torso()).expect("written");
    let clip = text(&clip);
    let warning = "no legs found: edited without holding; clip.legs names them";
    for args in [&["info", clip][..], &["measure", clip, "--json"], &["export", clip, "-o", text(&out)]] {
        let told = walkabout(args).stderr;
        assert!(String::from_utf8_lossy(&told).contains(warning), "{args:?}");
    }
    let bent = json(&["measure", clip, "--shape", "circle", "--json"]);
    assert_eq!(bent["warnings"], serde_json::json!([warning]));
    assert_eq!(bent["jerk_ratio"], Value::Null, "there is no jerk to compare with");
    assert!(done(&["measure", clip, "--shape", "circle"]).contains("jerk ratio       –"));
}

#[test]
fn what_cannot_be_measured_is_beyond_every_limit() {
    let folder = tempfile::tempdir().expect("a folder");
    let clip = folder.path().join("torso.bvh");
    std::fs::write(&clip, torso()).expect("written");
    let clip = text(&clip);
    done(&["measure", clip, "--fail", "missed=0"]);
    refused(&["measure", clip, "--fail", "slip=9", "--fail", "missed=0"], 1, "slip cannot be measured: no legs");
    refused(&["measure", "--fail", "seam_ratio=9"], 1, "seam_ratio cannot be measured: no cycle joins another");
    let never = [
        "measure",
        "--set",
        "plant=[{foot='left', first=0, last=9999, mode='none'}, {foot='right', first=0, last=9999, mode='none'}]",
    ];
    for number in ["planted_speed", "planted_speed_ratio", "slip", "slip_ratio"] {
        let limit = format!("{number}=9");
        refused(&[&never[..], &["--fail", &limit]].concat(), 1, "cannot be measured: no foot stands");
    }
    refused(&[&never[..], &["--fail", "clearance_ratio=0"]].concat(), 1, "cannot be measured: no foot stands");
    done(&[&never[..], &["--fail", "missed=0"]].concat());
    let help = done(&["measure", "--help"]);
    assert!(help.contains("A number that cannot be measured is beyond every limit"), "{help}");
}

#[test]
fn every_clip_that_moves_walks_every_shape() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.bvh");
    for clip in real_clips() {
        let frames = json(&["info", text(&clip), "--json"])["frames"].as_u64().expect("a count") as usize;
        for shape in ["line", "chord", "original", "circle", "zigzag", "eight:2", "u:0.5", "s"] {
            let args = ["export", text(&clip), "--shape", shape, "-o", text(&out), "--force"];
            let output = walkabout(&args);
            assert!(output.status.success(), "{args:?}: {}", String::from_utf8_lossy(&output.stderr));
            let bytes = std::fs::read(&out).expect("exported");
            let bvh = Bvh::parse(bytes, "out.bvh").expect("an export is a clip");
            assert!(bvh.n_frames() <= frames && bvh.n_frames() > 0, "{} {shape}", clip.display());
            assert!(bvh.values().iter().all(|v| v.is_finite()), "{} {shape}", clip.display());
        }
    }
}

#[test]
fn with_the_path_edit_off_the_export_is_the_source() {
    let folder = tempfile::tempdir().expect("a folder");
    let out = folder.path().join("out.bvh");
    for clip in real_clips() {
        done(&["export", text(&clip), "--set", "path.edited=false", "-o", text(&out), "--force"]);
        let same = std::fs::read(&out).expect("exported") == std::fs::read(&clip).expect("the source");
        assert!(same, "{}", clip.display());
    }
}

#[test]
fn residuals_fall_with_the_degree_as_in_the_thesis() {
    let Some(clip) = real_clips().into_iter().find(|c| c.ends_with("figure8_walk.bvh")) else { return };
    let rms = |degree: u32| {
        let report = json(&["measure", text(&clip), "--json", "--set", &format!("original.degree={degree}")]);
        assert_eq!(report["original_degree"], degree);
        ["x", "y", "z"].map(|axis| report["residual_rms"][axis].as_f64().expect("a number"))
    };
    let falling = [2, 4, 13, 45].map(rms);
    for pair in falling.windows(2) {
        assert!(pair[1].iter().zip(&pair[0]).all(|(next, last)| *next <= last * (1.0 + 1e-9)), "{falling:?}");
        assert!(pair[1][0] < pair[0][0] && pair[1][2] < pair[0][2], "{falling:?}");
    }
}

#[test]
fn given_control_points_are_final_whatever_the_order() {
    let points = "path.control_points=[[0,0,0],[0,0,100],[50,0,200],[0,0,300],[0,0,400]]";
    let expected = json(&["measure", "--json", "--set", points])["path_length"]["edited"].clone();
    for order in [["path.degree=3", points, "path.points=20"], [points, "path.points=20", "path.degree=3"]] {
        let sets: Vec<&str> = order.iter().flat_map(|s| ["--set", s]).collect();
        let args = [&["measure", "--json", "--shape", "circle"], &sets[..]].concat();
        assert_eq!(json(&args)["path_length"]["edited"], expected, "{order:?}");
    }
}

#[test]
fn a_shape_is_as_long_as_it_says() {
    let original = json(&["measure", "--json"])["path_length"]["source"].as_f64().expect("a length");
    for (shape, size) in [("circle", 1.0), ("eight:2", 2.0), ("zigzag:0.5", 0.5), ("line:3", 3.0)] {
        let edited =
            json(&["measure", "--json", "--shape", shape])["path_length"]["edited"].as_f64().expect("a length");
        assert!((edited / original / size - 1.0).abs() < 1e-9, "{shape}: {edited} against {original}");
    }
}

#[test]
fn projects_open_as_clips_do() {
    let folder = tempfile::tempdir().expect("a folder");
    let project = folder.path().join("walk.toml");
    let (from_shape, from_project) = (folder.path().join("a.bvh"), folder.path().join("b.bvh"));
    done(&["export", "-o", text(&from_shape), "--set", "timing.cycling=plain", "--set", "path.degree=2"]);
    std::fs::write(&project, "format = 1\n\n[path]\ndegree = 2\n\n[timing]\ncycling = \"plain\"\n").expect("written");
    done(&["export", text(&project), "-o", text(&from_project)]);
    assert_eq!(std::fs::read(&from_shape).expect("a"), std::fs::read(&from_project).expect("b"));
}

#[test]
fn wrong_words_and_bad_files_are_refused_with_their_place() {
    let folder = tempfile::tempdir().expect("a folder");
    let bad = folder.path().join("bad.bvh");
    std::fs::write(&bad, "HIERARCHY\nROOT Hips\n{\n  OFFSET 0 zero 0\n").expect("written");
    let project = folder.path().join("bad.toml");
    std::fs::write(&project, "format = 1\n[path]\nshape = 3\n").expect("written");
    let kept = folder.path().join("kept.bvh");
    std::fs::write(&kept, "mine").expect("written");

    refused(&["info", text(&bad)], 1, "bad.bvh:4:12");
    refused(&["info", text(&project)], 1, "bad.toml:3:1");
    let carried = folder.path().join("carried.toml");
    std::fs::write(&carried, "format = 1\n\n[clip]\nup = \"y\"\ncarrier = \"Hip\"\n").expect("written");
    let joints =
        "`clip.carrier` takes a joint's name or auto, found `Hip`; did you mean `Hips`? (the joints are Hips, ";
    refused(&["info", text(&carried)], 1, &format!("carried.toml:5:1: {joints}"));
    refused(&["info", "--set", "clip.carrier=Hip"], 2, joints);
    refused(&["info", "no such file.bvh"], 1, "no such file.bvh");
    refused(&["export", "-o", text(&kept)], 1, "--force");
    assert_eq!(std::fs::read(&kept).expect("kept"), b"mine");
    refused(&["export", "-o", "/no/such/folder/out.bvh"], 1, "there is no folder /no/such/folder");
    refused(&["info", "--set", "path.degree"], 2, "NAME=VALUE");
    refused(&["info", "--set", "path.degree=99"], 2, "from 1 to 9");
    refused(&["info", "--set", "path.control_points=[[0,0,0],[1,0,0]]"], 2, "at least 4 control points");
    refused(&["info", "--set", "path.degre=3"], 2, "did you mean `path.degree`");
    refused(&["info", "--shape", "heart"], 2, "heart");
    refused(&["export"], 2, "--output");
    refused(&["render", "-o", "x.png", "--camera", "5"], 2, "5");
    refused(&["render", "-o", "a/x.jpg"], 2, "a/x.jpg: pictures are written as PNG; name it a/x.png");
    refused(&["render", "-o", "x.png", "--views", "3"], 2, "1, 2, 4");
    refused(&["render", "-o", "x.png", "--frame", "999999"], 2, "--frame");
    refused(&["dance", "--now"], 2, "--now");
    refused(&["--set", "a=b"], 2, "there is no parameter");
}

#[test]
fn the_tables_are_printed() {
    assert!(done(&["params"]).contains("| `path.degree` |"));
    assert!(done(&["keys"]).contains("`sc`"));
    assert!(done(&["doctor"]).contains("colours"));
}

#[test]
fn one_frame_renders_the_same_twice() {
    let has_driver = done(&["doctor"]).contains("vulkan device");
    if !has_driver {
        assert!(std::env::var_os("CI").is_none(), "there is no Vulkan driver");
        eprintln!("SKIPPED: there is no Vulkan driver, so nothing was rendered");
        return;
    }
    let folder = tempfile::tempdir().expect("a folder");
    let picture = |name: &str, args: &[&str]| {
        let out = folder.path().join(name);
        done(&[&["render", "-o", text(&out), "--size", "320x180"], args].concat());
        std::fs::read(out).expect("rendered")
    };
    let first = picture("a.png", &["--frame", "100"]);
    assert_eq!(first, picture("b.png", &["--frame", "100"]));
    assert_ne!(first, picture("c.png", &["--frame", "200"]));
    let top = picture("d.png", &["--frame", "100", "--camera", "4"]);
    assert_ne!(first, top);
    let project = folder.path().join("walk.toml");
    std::fs::write(&project, "format = 1\n[view]\nlayout = 4\n[view.3]\nhide = [\"ground\"]\n").expect("written");
    let four = picture("e.png", &[text(&project), "--frame", "100"]);
    let asked = &["--frame", "100", "--views", "4", "--set", "view.3.hide=ground"];
    assert_eq!(four, picture("f.png", asked), "the project's views, unless others are asked for");
    assert_eq!(first, picture("g.png", &[text(&project), "--frame", "100", "--views", "1"]));
    assert_eq!(top, picture("h.png", &[text(&project), "--frame", "100", "--camera", "4"]));
    for (idx, clip) in real_clips().iter().enumerate() {
        if clip.ends_with("cmu_02_01_walk.bvh") {
            let [rest, first] = ["0", "1"].map(|n| picture(&format!("rest{n}.png"), &[text(clip), "--frame", n]));
            assert_ne!(rest, first, "the rest frame is the first of what would be exported");
        }
        picture(&format!("{idx}.png"), &[text(clip), "--shape", "circle"]);
    }
}

/// A blended cycle goes to the end of a longer path, tells its seams and comes back from its project.
#[test]
fn blended_cycles_are_set_measured_and_exported() {
    let folder = tempfile::tempdir().expect("a folder");
    let clip = folder.path().join("walk.bvh");
    std::fs::write(&clip, walkabout::motion::gait::built_in().0).expect("the clip is written");
    let long =
        ["--shape", "line:3", "--set", "timing.cycling=blended", "--set", "loop.start=178", "--set", "loop.end=242"];
    let args = |command: &'static str| [&[command, text(&clip)], &long[..]].concat();
    let report = json(&[&args("measure")[..], &["--json"]].concat());
    let seams = report["seam"].as_array().expect("seams");
    assert!(seams.len() > 5 && report["frames"]["edited"].as_u64() > Some(1000), "{report}");
    assert_eq!(seams[0]["frame"], 242);
    for seam in seams {
        assert!(["position", "rotation", "velocity"].iter().all(|key| seam[key].as_f64().is_some()), "{seam}");
    }
    done(&[&args("measure")[..], &["--fail", "seam_ratio=1.5"]].concat());

    let out = folder.path().join("long.bvh");
    done(&[&args("export")[..], &["-o", text(&out)]].concat());
    let written = Bvh::parse(std::fs::read(&out).expect("written"), "long.bvh").expect("a valid file");
    assert_eq!(written.n_frames() as u64, report["frames"]["edited"].as_u64().expect("a count"));

    let project = folder.path().join("walk.toml");
    let toml = "format = 1\n\n[clip]\nfile = \"walk.bvh\"\n\n[timing]\ncycling = \"blended\"\n\n[loop]\nstart = 178\nend = 242\n";
    std::fs::write(&project, toml).expect("the project is written");
    let again = json(&["measure", text(&project), "--shape", "line:3", "--json"]);
    assert_eq!(again["seam"], report["seam"]);
}
