//! Joined cycles, end to end: the bar that seams are kept under, and what must not change the result.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    contact::{Detection, FootPlants, GroundSlope, Thresholds},
    cycle::{Join, Joined, Loop, LoopFinder, LoopRange},
    math::{Rigid, heading_rotation},
    measure::Seam,
    motion::{Clip, ClipOptions, EditedClip, PointTracks, find_legs, gait},
    path::{Degree, Integrator, OriginalPath, PathFrame, ResidualFrame},
};

const BLEND_SECS: f64 = 0.2;

/// A clip with everything that loops are found in.
struct Subject {
    name: String,
    clip: Arc<Clip>,
    tracks: PointTracks,
    carrier: Vec<Rigid>,
    feet: Vec<FootPlants>,
    path: Vec<PathFrame>,
    progress: Vec<f64>,
}

impl Subject {
    fn new(name: &str, clip: Clip) -> Self {
        let clip = Arc::new(clip);
        let tracks = clip.world_tracks();
        let height = clip.facts.height.value;
        let legs = find_legs(&clip, &[], &mut Vec::new()).value;
        let feet = Detection {
            tracks: &tracks,
            carrier: clip.facts.carrier.value.idx(),
            legs: &legs,
            frame_time_secs: clip.frame_time_secs,
            height,
            thresholds: Thresholds::default(),
        }
        .plants();
        let carrier = clip.carrier_track();
        let original = OriginalPath::fit(&carrier, Degree::Auto, 0.5, height);
        let progress = original.progress(Integrator::Gauss, 0.01);
        Self { name: name.to_owned(), carrier, clip, tracks, feet, path: original.frames().to_vec(), progress }
    }

    fn read(name: &str, bytes: Vec<u8>) -> Self {
        Self::new(name, Clip::from_bvh(&Bvh::parse(bytes, name).expect("a valid file"), &ClipOptions::default()))
    }

    fn built_in() -> Self {
        Self::read("built-in", gait::built_in().0.into_bytes())
    }

    /// Reads a captured clip; says so loudly when there is none.
    fn captured(name: &str) -> Option<Self> {
        let Ok(dir) = std::env::var("WALKABOUT_CLIPS") else {
            assert!(std::env::var_os("CI").is_none(), "WALKABOUT_CLIPS must be set in CI");
            println!("SKIPPED: {name}, because WALKABOUT_CLIPS is not set");
            return None;
        };
        Some(Self::read(name, std::fs::read(format!("{dir}/real/{name}.bvh")).expect("the clip is there")))
    }

    fn height(&self) -> f64 {
        self.clip.facts.height.value
    }

    fn loops(&self) -> Vec<Loop> {
        LoopFinder {
            clip: &self.clip,
            tracks: &self.tracks,
            path: &self.path,
            progress: &self.progress,
            feet: &self.feet,
        }
        .best()
    }

    fn joined(&self, range: LoopRange, blend_secs: f64, n_cycles: usize) -> Joined {
        Join {
            clip: &self.clip,
            carrier: &self.carrier,
            path: &self.path,
            progress: &self.progress,
            ground: GroundSlope::default(),
            range,
            blend_secs,
            n_cycles,
        }
        .joined()
    }
}

/// Measures all seams of a joined clip as it is, on its own path.
fn seams(joined: &Joined, height: f64) -> Vec<Seam> {
    let edited = EditedClip::unedited(Arc::clone(&joined.clip));
    joined.seams.iter().map(|&frame| Seam::at(&edited, frame, height)).collect()
}

/// Joins every range that is found and holds its seams against the bar; tells what was measured.
fn check_seams(subject: &Subject) {
    let loops = subject.loops();
    assert!(!loops.is_empty(), "{}: no loop found", subject.name);
    for (nth, found) in loops.iter().enumerate() {
        let joined = subject.joined(found.range, BLEND_SECS, 2);
        let (seams, cut) =
            (seams(&joined, subject.height()), seams(&subject.joined(found.range, 0.0, 2), subject.height()));
        println!(
            "{} {nth}: frames {}..{}, pose {:.4} H, velocity {:.3} H/s, phase {:.3}; step over the seam {:.2}, unblended {:.2}",
            subject.name,
            found.range.first,
            found.range.end,
            found.mismatch.pose,
            found.mismatch.velocity,
            found.mismatch.phase.unwrap_or(f64::NAN),
            seams[0].position_share(),
            cut[0].position_share(),
        );
        for seam in &seams {
            assert!(seam.position_share() <= Seam::BAR, "{}: {:?} {seam:?}", subject.name, found.range);
        }
        // The two seams are one another's images; the clip turns and moves between them.
        assert!((seams[0].position - seams[1].position).abs() < 1e-9);
    }
    let best = loops[0].mismatch;
    assert!(
        best.pose < 0.05 && best.velocity < 0.3 && best.phase.is_none_or(|p| p < 0.1),
        "{}: {best:?}",
        subject.name
    );
}

#[test]
fn seams_of_the_built_in_walk_pass_the_bar() {
    check_seams(&Subject::built_in());
}

#[test]
fn seams_of_captured_walks_pass_the_bar() {
    for name in
        ["walk01", "cmu_12_03_walk", "cmu_02_01_walk", "cmu_08_01_brisk_walk", "figure8_walk", "zombie_turns_z_up"]
    {
        if let Some(subject) = Subject::captured(name) {
            check_seams(&subject);
        }
    }
}

/// The figure eight closes: after one lap the walker is where it was, and walks on.
#[test]
fn a_lap_of_the_figure_eight_can_be_walked_again() {
    let Some(subject) = Subject::captured("figure8_walk") else { return };
    let laps = subject.loops().into_iter().filter(|found| found.range.n_frames() > 400).map(|found| found.range);
    let laps: Vec<LoopRange> = laps.chain([LoopRange { first: 0, end: subject.clip.n_frames() }]).collect();
    assert!(laps.len() > 1);
    for range in laps {
        for seam in seams(&subject.joined(range, BLEND_SECS, 2), subject.height()) {
            println!("frames {}..{}: step over the seam {:.2}", range.first, range.end, seam.position_share());
            assert!(seam.position_share() <= Seam::BAR, "{range:?} {seam:?}");
        }
    }
}

#[test]
fn without_cycles_the_clip_is_itself() {
    let subject = Subject::built_in();
    let joined = subject.joined(LoopRange { first: 100, end: 200 }, BLEND_SECS, 0);
    assert!(Arc::ptr_eq(&joined.clip, &subject.clip));
    assert_eq!((joined.carrier, joined.path, joined.progress), (subject.carrier, subject.path, subject.progress));
    assert!(joined.seams.is_empty() && joined.turned.is_empty());
}

#[test]
fn frames_away_from_seams_are_the_clips_own_moved_as_one() {
    let subject = Subject::built_in();
    let range = subject.loops()[0].range;
    let joined = subject.joined(range, BLEND_SECS, 3);
    let n_spread = joined.n_spread;
    assert_eq!(n_spread, 12);
    for f in 0..=range.end - n_spread {
        assert_eq!((joined.carrier[f], joined.path[f]), (subject.carrier[f], subject.path[f]), "frame {f}");
        assert_eq!(joined.progress[f], subject.progress[f]);
        assert_eq!(joined.clip.rotations(f)[1..], subject.clip.rotations(f)[1..]);
    }
    let at = |f: usize| subject.path[f].rigid(ResidualFrame::Heading);
    let mut chain = at(range.end) * at(range.first).inverse();
    // On level ground, whatever the fitted path rises over a cycle.
    assert!(chain.translation.y.abs() > 1e-6);
    chain.translation.y = 0.0;
    let period = subject.progress[range.end] - subject.progress[range.first];
    let mut moved = chain;
    for (copy, seam) in (1..).zip(&joined.seams) {
        for k in n_spread..range.n_frames() - n_spread {
            let (f, g) = (range.first + k, seam + k);
            assert_eq!(joined.source_frames[g] as usize, f);
            let expected = moved * subject.carrier[f];
            assert!(joined.carrier[g].translation.abs_diff_eq(expected.translation, 1e-9));
            assert!(joined.carrier[g].rotation.angle_between(expected.rotation) < 1e-7);
            assert!((joined.progress[g] - subject.progress[f] - f64::from(copy) * period).abs() < 1e-9);
        }
        moved = chain * moved;
    }
    // The long clip's poses are what its lists say.
    for (f, carrier) in joined.clip.carrier_track().iter().enumerate() {
        assert!(carrier.translation.abs_diff_eq(joined.carrier[f].translation, 1e-9));
        for turned in &joined.turned {
            assert_eq!(joined.clip.rotations(f)[turned.joint.idx()], turned.rotations[f]);
        }
    }
}

#[test]
fn frames_do_not_depend_on_how_many_cycles_follow() {
    let subject = Subject::built_in();
    let range = LoopRange { first: 120, end: 247 };
    let (few, many) = (subject.joined(range, 0.3, 1), subject.joined(range, 0.3, 4));
    let n = few.source_frames.len();
    assert_eq!(few.carrier[..], many.carrier[..n]);
    assert_eq!((&few.path[..], &few.progress[..]), (&many.path[..n], &many.progress[..n]));
    for (few, many) in few.turned.iter().zip(&many.turned) {
        assert_eq!(few.rotations[..], many.rotations[..n]);
    }
    assert_eq!(few.seams[..], many.seams[..1]);
}

#[test]
fn a_clip_turned_and_moved_is_joined_alike() {
    let subject = Subject::built_in();
    let moved = Rigid::new(DQuat::from_rotation_y(2.2), DVec3::new(300.0, 40.0, -700.0));
    let elsewhere = EditedClip {
        carrier_world: subject.carrier.iter().map(|&carrier| moved * carrier).collect(),
        ..EditedClip::unedited(Arc::clone(&subject.clip))
    };
    let elsewhere = Subject::new("elsewhere", Clip::rearranged(&elsewhere));
    let (here, there) = (subject.loops(), elsewhere.loops());
    for (here, there) in here.iter().zip(&there) {
        assert_eq!(here.range, there.range);
        assert!((here.mismatch.pose - there.mismatch.pose).abs() < 1e-9);
    }
    let [a, b] = [&subject, &elsewhere].map(|subject| subject.joined(here[0].range, BLEND_SECS, 2));
    for f in 0..a.carrier.len() {
        let expected = moved * a.carrier[f];
        assert!(expected.translation.distance(b.carrier[f].translation) < 1e-6, "frame {f}");
        assert!(expected.rotation.angle_between(b.carrier[f].rotation) < 1e-6);
        assert!((a.progress[f] - b.progress[f]).abs() < 1e-6);
    }
}

/// A walk that is periodic on its path goes on as it would have gone on, with and without blending.
#[test]
fn a_periodic_walk_is_carried_on_exactly() {
    const PERIOD: usize = 40;
    let turn_per_frame = 0.01;
    let path_at = |f: usize| {
        let heading_rad = 0.3 + turn_per_frame * f as f64;
        // Steps of a circle, so that each is the one before turned.
        let point = (0..f).map(|k| heading_rotation(0.3 + turn_per_frame * k as f64) * DVec3::Z).sum();
        PathFrame { point, heading_rad, slope_rad: 0.0 }
    };
    let carrier_at = |f: usize| {
        let phase = std::f64::consts::TAU * (f % PERIOD) as f64 / PERIOD as f64;
        let sway =
            Rigid::new(DQuat::from_rotation_x(0.2 * phase.sin()), DVec3::new(phase.cos(), 90.0, 0.5 * phase.sin()));
        path_at(f).rigid(ResidualFrame::Heading) * sway
    };
    let built_in = Subject::built_in();
    let n = 130;
    let still: Vec<Rigid> = (0..n).map(carrier_at).collect();
    let clip = Clip::rearranged(&EditedClip {
        source_frames: vec![0; n],
        carrier_world: still.clone(),
        ..EditedClip::unedited(built_in.clip)
    });
    let (path, progress): (Vec<_>, Vec<_>) = (0..n).map(|f| (path_at(f), f as f64)).unzip();
    for (range, blend_secs) in [((30, 70), 0.0), ((30, 70), 0.2), ((0, 80), 0.3), ((5, 125), 0.5)] {
        let range = LoopRange { first: range.0, end: range.1 };
        let join = Join {
            clip: &Arc::new(clip.clone()),
            carrier: &still,
            path: &path,
            progress: &progress,
            ground: GroundSlope::default(),
            range,
            blend_secs,
            n_cycles: 3,
        };
        assert!((join.period() - range.n_frames() as f64).abs() < 1e-12);
        // At the clip's first frame rates are those of the frame after it, which here differ a little.
        let slack = if range.first == 0 { 0.05 } else { 1e-9 };
        let joined = join.joined();
        for f in 0..joined.carrier.len() {
            let expected = carrier_at(f);
            let off = expected.translation.distance(joined.carrier[f].translation);
            assert!(off < slack, "{range:?} {blend_secs} frame {f}: {off}");
            assert!(expected.rotation.angle_between(joined.carrier[f].rotation) < slack.max(1e-7));
            assert!((joined.progress[f] - f as f64).abs() < 1e-9);
        }
    }
}

/// A range that ends with the clip is carried on by one frame, so no frame is shown twice and none left out.
#[test]
fn the_whole_clip_is_a_range() {
    let subject = Subject::built_in();
    let n = subject.clip.n_frames();
    let joined = subject.joined(LoopRange { first: 0, end: n }, BLEND_SECS, 1);
    assert_eq!(joined.source_frames, (0..2 * n as u32).map(|f| f % n as u32).collect::<Vec<_>>());
    let step = subject.progress[n - 1] - subject.progress[n - 2];
    assert!((joined.progress[n] - subject.progress[n - 1] - step).abs() < 1e-9);
    let seam = seams(&joined, subject.height())[0];
    assert!(seam.position_share() <= Seam::BAR, "{seam:?}");
}

#[test]
fn plants_go_on_across_the_seam() {
    let subject = Subject::built_in();
    let range = subject.loops()[0].range;
    let joined = subject.joined(range, BLEND_SECS, 3);
    let found = Detection {
        tracks: &joined.clip.world_tracks(),
        carrier: joined.clip.facts.carrier.value.idx(),
        legs: &subject.feet.iter().map(|foot| foot.leg).collect::<Vec<_>>(),
        frame_time_secs: joined.clip.frame_time_secs,
        height: subject.height(),
        thresholds: Thresholds::default(),
    }
    .plants();
    for (told, found) in joined.plants(&subject.feet).iter().zip(&found) {
        assert_eq!(told.plants.len(), found.plants.len(), "{:?} {:?}", told.plants, found.plants);
        for (told, found) in told.plants.iter().zip(&found.plants) {
            assert!(told.first.abs_diff(found.first) <= 2 && told.last.abs_diff(found.last) <= 2, "{told:?} {found:?}");
        }
    }
}
