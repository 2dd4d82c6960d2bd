//! The solve on captured clips, found through `WALKABOUT_CLIPS`.

use std::{fs, path::PathBuf, sync::Arc};

use walkabout::{
    bvh::Bvh,
    document::{Edits, Solved, Source, solve},
    path::{Degree, Shape, ShapeKind, shape_points},
};

/// Folder of the captured clips; none, loudly, where there is none.
fn clips(test: &str) -> Option<PathBuf> {
    match std::env::var_os("WALKABOUT_CLIPS") {
        Some(folder) => Some(PathBuf::from(folder).join("real")),
        None if std::env::var_os("CI").is_some() => panic!("{test} needs WALKABOUT_CLIPS"),
        None => {
            eprintln!("SKIPPED: {test} needs WALKABOUT_CLIPS");
            None
        }
    }
}

fn load(file: &std::path::Path) -> Arc<Source> {
    let name = file.display().to_string();
    let bvh = Bvh::parse(fs::read(file).expect("a readable clip"), &name).expect("a valid clip");
    Arc::new(Source { name, file: Some(file.to_owned()), bvh })
}

fn with(source: &Arc<Source>, previous: Option<&Solved>, change: impl FnOnce(&mut Edits)) -> Solved {
    let mut edits = Edits::default();
    change(&mut edits);
    solve(source, &Arc::new(edits), previous)
}

#[test]
fn residuals_of_the_figure_eight_fall_with_the_degree() {
    let Some(folder) = clips("residuals_of_the_figure_eight_fall_with_the_degree") else { return };
    let source = load(&folder.join("figure8_walk.bvh"));
    let mut before = [f64::INFINITY; 3];
    let mut before_norm = f64::INFINITY;
    for degree in [2, 4, 13, 45] {
        let solved = with(&source, None, |e| e.original.degree = Degree::Fixed(degree));
        assert_eq!(solved.original.degree(), degree as usize);
        let rms = solved.residual_rms();
        println!("degree {degree}: {rms:.4} RMS, the clip's unit; H {:.4}", solved.original.height());
        for (now, before) in rms.to_array().into_iter().zip(&mut before) {
            assert!(now <= *before, "degree {degree}: {now} after {before}");
            *before = now;
        }
        assert!(rms.length() < before_norm);
        before_norm = rms.length();
    }
}

#[test]
fn every_clip_walks_every_shape() {
    let Some(folder) = clips("every_clip_walks_every_shape") else { return };
    let mut files: Vec<PathBuf> =
        fs::read_dir(folder).expect("a folder").map(|entry| entry.expect("an entry").path()).collect();
    files.retain(|file| file.extension().is_some_and(|e| e == "bvh"));
    files.sort();
    assert!(!files.is_empty());
    for file in files {
        let source = load(&file);
        let start = with(&source, None, |_| {});
        let height = start.clip.facts.height.value;
        for (kind, name) in ShapeKind::ALL {
            let points = shape_points(Shape { kind, size: 1.0 }, &start.original, 8, 3);
            let up = start.clip.facts.up.value;
            let solved = with(&source, Some(&start), |e| {
                e.path.control_points = Some(points.into_iter().map(|p| up.to_file(p)).collect());
            });
            let n = solved.edited.n_frames();
            let place = format!("{} {name}", file.display());
            assert!(
                (0..n).all(|f| solved.carrier(f).translation.is_finite() && solved.carrier(f).rotation.is_finite())
            );
            if solved.walks_new_path() {
                let measures = &solved.measures;
                // Held feet make the carrier give way, by what the result says.
                let given = solved.holding.as_ref().map_or(0.0, |holding| holding.largest_offset) / height;
                assert!(measures.path_error.expect("edited") < given + 1e-9, "{place}");
                let whole = !matches!(kind, ShapeKind::Chord) && !solved.original.goes_nowhere();
                if whole {
                    let height = measures.height.edited / measures.height.source;
                    // Held legs bend a little otherwise, so the lowest toe is not quite where it was.
                    let slack = if solved.holding.is_some() { 0.03 } else { 1e-9 };
                    assert!((height - 1.0).abs() < slack, "{place}: {height}");
                    assert_eq!(n, solved.clip.n_frames(), "{place}: as long as the original path");
                    let length = solved.new_path.length() / solved.original.length();
                    assert!((length - 1.0).abs() < 1e-9, "{place}: {length}");
                }
                let jerk = measures.jerk_ratio.unwrap_or(1.0);
                println!("{place}: {n} frames, jerk ratio {jerk:.3}, degree {}", solved.original.degree());
                // A handful of frames moved evenly has hardly any jerk of its own to compare with.
                assert!(jerk < 2.0 || n < 30, "{place}: jerk ratio {jerk}");
            } else {
                assert_eq!(n, solved.clip.n_frames(), "{place}");
            }
            assert!((solved.measures.height.source / height - 1.0).abs() < 1e-9, "{place}");
        }
    }
}

/// Standing at both ends, the plain tangent is noise there; the windowed chord is not.
#[test]
fn a_window_calms_a_walk_that_starts_and_stops() {
    let Some(folder) = clips("a_window_calms_a_walk_that_starts_and_stops") else { return };
    let source = load(&folder.join("cmu_131_01_start_walk_stop.bvh"));
    let jerk = |window: f64, degree: u32| {
        let change = |e: &mut Edits| {
            e.original.degree = Degree::Fixed(degree);
            e.heading.window = window;
        };
        with(&source, None, change).measures.jerk_ratio.expect("a walk")
    };
    for degree in [5, 13] {
        let (plain, windowed) = (jerk(0.0, degree), jerk(0.5, degree));
        println!("degree {degree}: jerk ratio {plain:.3} with the tangent, {windowed:.3} with half a body height");
        assert!(windowed < 1.1 && windowed < plain);
    }
}

/// A path that the new path's degree can be, walked again, changes nothing, whether feet are held or not.
#[test]
fn a_clip_on_its_own_path_stays_what_it_is() {
    let Some(folder) = clips("a_clip_on_its_own_path_stays_what_it_is") else { return };
    for name in ["walk01", "cmu_12_03_walk", "figure8_walk", "cmu_131_01_start_walk_stop", "zombie_turns_z_up"] {
        let source = load(&folder.join(name).with_extension("bvh"));
        for (original, degree) in [(1, 3), (3, 3), (4, 5)] {
            let start = with(&source, None, |e| e.original.degree = Degree::Fixed(original));
            let (up, height) = (start.clip.facts.up.value, start.clip.facts.height.value);
            let shape = Shape { kind: ShapeKind::Original, size: 1.0 };
            let points = shape_points(shape, &start.original, 8, degree);
            for hold in [false, true] {
                let solved = with(&source, Some(&start), |e| {
                    e.original.degree = Degree::Fixed(original);
                    e.path.degree = degree;
                    e.path.control_points = Some(points.iter().map(|&p| up.to_file(p)).collect());
                    e.plants.hold = hold;
                });
                assert!(solved.walks_new_path() && solved.edited.n_frames() == solved.clip.n_frames(), "{name}");
                let (mut now, mut then) = (Vec::new(), Vec::new());
                let mut worst = (0.0, 0, 0);
                for f in 0..solved.edited.n_frames() {
                    solved.edited.world_points(f, &mut now);
                    solved.clip.world_points(f, &mut then);
                    for (point, (now, then)) in now.iter().zip(&then).enumerate() {
                        let off = now.distance(*then) / height;
                        if off > worst.0 {
                            worst = (off, f, point);
                        }
                    }
                }
                assert!(worst.0 < 1e-6, "{name} {original} on {degree}, held {hold}: off by {worst:?}");
            }
        }
    }
}

/// A first cycle that needs no holding and a second one that does.
#[test]
fn cycles_are_held_one_by_one() {
    let Some(folder) = clips("cycles_are_held_one_by_one") else { return };
    let source = load(&folder.join("cmu_12_03_walk.bvh"));
    let start = with(&source, None, |e| e.original.degree = Degree::Fixed(1));
    let up = start.clip.facts.up.value;
    let frames = start.original.frames();
    let along = frames[frames.len() - 1].point - frames[0].point;
    let aside = glam::DVec3::new(along.z, 0.0, -along.x);
    let corner = frames[0].point + 1.5 * along;
    let points = [frames[0].point, corner, corner + aside].map(|p| up.to_file(p)).to_vec();
    let solved = with(&source, Some(&start), |e| {
        e.original.degree = Degree::Fixed(1);
        e.path.degree = 1;
        e.path.control_points = Some(points);
        e.timing.cycling = walkabout::document::Cycling::Plain;
    });
    let n = solved.edited.n_frames();
    assert!(solved.timing.seams.len() == 2 && n > 2 * solved.clip.n_frames(), "{:?}", solved.timing.seams);
    assert!(solved.edited.turned.len() == 6 && solved.edited.turned.iter().all(|t| t.rotations.len() == n));
    let (mut now, mut then) = (Vec::new(), Vec::new());
    for f in 0..solved.timing.seams[0] {
        solved.edited.world_points(f, &mut now);
        solved.clip.world_points(f, &mut then);
        let height = solved.clip.facts.height.value;
        assert!(now.iter().zip(&then).all(|(now, then)| now.distance(*then) < 1e-6 * height), "frame {f}");
    }
    for numbers in solved.foot_numbers.iter() {
        let speed = numbers.planted_speed.expect("feet stand");
        assert!(speed.edited < 1.02 * speed.source, "{numbers:?}");
    }
}
