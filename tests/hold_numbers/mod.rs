//! The numbers a held edit is judged by, source beside edited; for the bench that prints them and the tests that
//! bound them.

use std::sync::Arc;

use glam::{DQuat, DVec3};
use walkabout::{
    bvh::Bvh,
    constrain::{Ground, Held, Job, Prepared, hold},
    contact::{Detection, FootPlants, PlantMode, Thresholds},
    math::Rigid,
    measure::{FootMeasure, FootTracks, PlantSteps},
    motion::{Clip, ClipOptions, EditedClip, PointTracks, find_legs, gait},
    path::{
        Degree, Integrator, NewPath, OriginalPath, PathFrame, ResidualFrame, Residuals, Shape, ShapeKind, shape_points,
    },
};

/// Bent shapes.
pub(crate) const SHAPES: [ShapeKind; 5] =
    [ShapeKind::Circle, ShapeKind::Zigzag, ShapeKind::Eight, ShapeKind::U, ShapeKind::S];

/// A clip with its plants.
pub(crate) struct Subject {
    pub(crate) name: String,
    pub(crate) clip: Arc<Clip>,
    pub(crate) tracks: PointTracks,
    pub(crate) carrier: Vec<Rigid>,
    pub(crate) feet: Vec<FootPlants>,
}

/// The numbers of an edit, over those of the source where they are ratios.
#[derive(Clone, Debug)]
pub(crate) struct Numbers {
    pub(crate) planted_speed: f64,
    pub(crate) slip: f64,
    pub(crate) clearance: f64,
    pub(crate) jerk: f64,
    pub(crate) acceleration: f64,
    /// Largest step of a knee near full extension; over the source's largest there, or in the same step if that is more.
    pub(crate) knee_step: f64,
    /// Largest change of a leg joint's turn from step to step where a plant begins or ends, over the clip's largest.
    pub(crate) end_jump: f64,
    /// Largest turn of a planted foot against the motion of its plant, radians.
    pub(crate) foot_turn: f64,
    /// Least bend about the source's hinge, degrees; negative for a knee that bends backwards further than the source's.
    pub(crate) knee_back_deg: f64,
    /// Largest change of a bone's length, body heights.
    pub(crate) bones: f64,
    /// Body heights.
    pub(crate) offset: f64,
    pub(crate) n_missed: usize,
    /// Body heights.
    pub(crate) missed_by: f64,
}

impl Subject {
    /// Reads a captured clip.
    pub(crate) fn read(dir: &str, name: &str) -> Self {
        let bytes = std::fs::read(format!("{dir}/real/{name}.bvh")).expect("the clip is there");
        Self::new(name, &Bvh::parse(bytes, name).expect("a valid file"))
    }

    /// Returns the clip as it is, ready to be prepared.
    pub(crate) fn posed(&self) -> Arc<EditedClip> {
        Arc::new(EditedClip::unedited(Arc::clone(&self.clip)))
    }

    /// Takes the built-in clip.
    pub(crate) fn built_in() -> Self {
        Self::new("built-in", &Bvh::parse(gait::built_in().0.into_bytes(), "built-in").expect("a valid file"))
    }

    pub(crate) fn new(name: &str, bvh: &Bvh) -> Self {
        let clip = Arc::new(Clip::from_bvh(bvh, &ClipOptions::default()));
        let tracks = clip.world_tracks();
        let legs = find_legs(&clip, &[], &mut Vec::new()).value;
        let feet = Detection {
            tracks: &tracks,
            carrier: clip.facts.carrier.value.idx(),
            legs: &legs,
            frame_time_secs: clip.frame_time_secs,
            height: clip.facts.height.value,
            thresholds: Thresholds::default(),
        }
        .plants();
        Self { name: name.to_owned(), carrier: clip.carrier_track(), clip, tracks, feet }
    }

    /// Returns the same subject with all plants in a mode.
    pub(crate) fn with_mode(&self, mode: PlantMode) -> Vec<FootPlants> {
        let mut feet = self.feet.clone();
        feet.iter_mut().flat_map(|foot| &mut foot.plants).for_each(|plant| plant.mode = mode);
        feet
    }
}

/// A plain path edit, whole.
pub(crate) struct Plain {
    pub(crate) carrier: Vec<Rigid>,
    pub(crate) path: Vec<PathFrame>,
    pub(crate) original: Vec<PathFrame>,
}

impl Plain {
    /// Bends a clip onto a shape whose smallest radius is `radius` body heights at least.
    pub(crate) fn bent(subject: &Subject, kind: ShapeKind, degree: u32, radius: f64) -> Self {
        let height = subject.clip.facts.height.value;
        let original = OriginalPath::fit(&subject.carrier, Degree::Fixed(degree), 0.5, height);
        let fallback_rad = original.frames()[0].heading_rad;
        let mut size = 1.0;
        let new_path = loop {
            let points = shape_points(Shape { kind, size }, &original, 8, 3);
            let path = NewPath::new(walkabout::curve::BSpline::new(3, points), 0.5 * height, fallback_rad);
            if smallest_radius(&path) >= radius * height || size > 500.0 {
                break path;
            }
            size *= 1.1;
        };
        Self::along(subject, &original, &new_path)
    }

    pub(crate) fn along(subject: &Subject, original: &OriginalPath, new_path: &NewPath) -> Self {
        let residuals = Residuals::of(&subject.carrier, original.frames(), ResidualFrame::Heading);
        let path = new_path.frames_along(&original.progress(Integrator::Gauss, 0.01));
        let carrier = path.iter().enumerate().map(|(f, at)| residuals.apply(f, at)).collect();
        Self { carrier, path, original: original.frames().to_vec() }
    }

    pub(crate) fn job(&self, ground: Ground) -> Job<'_> {
        Job { carrier: &self.carrier, own: &[], path: &self.path, original: &self.original, ground }
    }

    pub(crate) fn unheld(&self) -> Held {
        Held { carrier: self.carrier.clone(), ..Held::default() }
    }

    pub(crate) fn held(&self, subject: &Subject, feet: &[FootPlants]) -> Held {
        hold(&Prepared::new(&subject.posed(), &[], feet, None), &self.job(Ground::Steps))
    }
}

fn smallest_radius(path: &NewPath) -> f64 {
    const N: usize = 1500;
    let points = path.polyline(N);
    let step = path.length() / (N - 1) as f64;
    points
        .windows(3)
        .map(|w| (w[1] - w[0]).angle_between(w[2] - w[1]))
        .fold(f64::INFINITY, |least, angle| least.min(step / angle.max(1e-12)))
}

/// Returns an edited clip of a held edit.
pub(crate) fn edited(subject: &Subject, held: &Held) -> EditedClip {
    EditedClip {
        carrier_world: held.carrier.clone(),
        turned: held.turned.clone(),
        ..EditedClip::unedited(Arc::clone(&subject.clip))
    }
}

/// Returns all points of an edited clip.
pub(crate) fn tracks(edited: &EditedClip) -> PointTracks {
    let frames: Vec<Vec<DVec3>> = (0..edited.n_frames())
        .map(|f| {
            let mut points = Vec::new();
            edited.world_points(f, &mut points);
            points
        })
        .collect();
    PointTracks::from_fn(edited.clip.skeleton.n_points(), frames.len(), |p, f| frames[f][p])
}

/// Measures an edit.
pub(crate) fn measure(subject: &Subject, held: &Held) -> Numbers {
    let (clip, source) = (&subject.clip, &subject.tracks);
    let height = clip.facts.height.value;
    let edited = edited(subject, held);
    let now = tracks(&edited);
    let mut numbers = Numbers {
        planted_speed: 0.0,
        slip: 0.0,
        clearance: f64::INFINITY,
        jerk: jerk(&now, clip) / jerk(source, clip),
        acceleration: acceleration(&now, clip) / acceleration(source, clip),
        knee_step: 0.0,
        end_jump: 0.0,
        foot_turn: 0.0,
        knee_back_deg: f64::INFINITY,
        bones: bones(subject, &now) / height,
        offset: held.largest_offset / height,
        n_missed: held.missed.len(),
        missed_by: held.missed.iter().map(|m| m.by).fold(0.0, f64::max) / height,
    };
    for foot in &subject.feet {
        let (ankle, toe) = (foot.leg.ankle.idx(), foot.leg.toe);
        let of = |t| FootTracks { ankle: PointTracks::track(t, ankle), toe: PointTracks::track(t, toe) };
        let found = FootMeasure {
            source: of(source),
            edited: of(&now),
            source_frames: &edited.source_frames,
            plants: &foot.plants,
            source_steps: &PlantSteps::of(&of(source), &foot.plants),
            is_joined: false,
            frame_time_secs: clip.frame_time_secs,
            height,
        }
        .numbers();
        if let (Some(speed), Some(slip)) = (found.planted_speed, found.slip_p90) {
            numbers.planted_speed = numbers.planted_speed.max(speed.edited / speed.source);
            numbers.slip = numbers.slip.max(slip.edited / slip.source);
        }
        if let Some(clearance) = found.clearance {
            numbers.clearance = numbers.clearance.min(clearance.edited / clearance.source);
        }
        let (was, is) = (Knee::of(source, foot, 0.95), Knee::of(&now, foot, 0.97));
        numbers.knee_step = numbers.knee_step.max(is.largest_step_over(&was));
        numbers.end_jump = numbers.end_jump.max(end_jump(&edited, foot));
        numbers.foot_turn = numbers.foot_turn.max(foot_turn(&edited, foot));
        numbers.knee_back_deg = numbers.knee_back_deg.min(knee_back(&edited, foot).to_degrees());
    }
    numbers
}

/// Bends of a knee and where the leg is stretched beyond a share of its length.
struct Knee {
    bend: Vec<f64>,
    stretched: Vec<bool>,
}

impl Knee {
    fn of(tracks: &PointTracks, foot: &FootPlants, share: f64) -> Self {
        let at = |joint: usize, f| tracks.position(joint, f);
        let (mut bend, mut stretched) = (Vec::new(), Vec::new());
        for f in 0..tracks.n_frames() {
            let (hip, knee, ankle) =
                (at(foot.leg.hip.idx(), f), at(foot.leg.knee.idx(), f), at(foot.leg.ankle.idx(), f));
            bend.push((knee - hip).angle_between(ankle - knee));
            stretched.push(hip.distance(ankle) > share * (hip.distance(knee) + knee.distance(ankle)));
        }
        Self { bend, stretched }
    }

    /// Largest step among frames near full extension here, over the source's largest near full extension or, where that
    /// is more, over the source's own step.
    fn largest_step_over(&self, source: &Self) -> f64 {
        let step = |knee: &Self, f: usize| (knee.bend[f] - knee.bend[f - 1]).abs();
        let frames = 1..self.bend.len();
        let usual = frames.clone().filter(|&f| source.stretched[f]).map(|f| step(source, f)).fold(1e-9, f64::max);
        frames.filter(|&f| self.stretched[f]).map(|f| step(self, f) / usual.max(step(source, f))).fold(0.0, f64::max)
    }
}

/// Returns the largest change from one step of a leg joint's rotation to the next, at the ends of plants, over the
/// largest in the whole source.
fn end_jump(edited: &EditedClip, foot: &FootPlants) -> f64 {
    let n = edited.n_frames();
    let mut worst = 0.0f64;
    for joint in [foot.leg.hip, foot.leg.knee, foot.leg.ankle] {
        let change = |rotation: &dyn Fn(usize) -> DQuat, f: usize| {
            let step = |f: usize| turn(rotation(f - 1).conjugate() * rotation(f));
            (step(f + 1) - step(f)).length()
        };
        let was = |f: usize| edited.clip.rotations(f)[joint.idx()];
        let is = |f: usize| edited.rotation(f, joint);
        let usual = (1..n - 1).map(|f| change(&was, f)).fold(1e-9, f64::max);
        // Where the clip begins and ends, a plant only seems to.
        for end in foot.plants.iter().flat_map(|p| [p.first, p.last]).filter(|&end| end > 2 && end + 3 < n) {
            for f in end - 1..=end + 1 {
                worst = worst.max(change(&is, f) / usual);
            }
        }
    }
    worst
}

/// Returns the largest turn of a planted foot against the motion that its plant has at its first frame.
fn foot_turn(edited: &EditedClip, foot: &FootPlants) -> f64 {
    let (mut was, mut is) = (Vec::new(), Vec::new());
    let mut motion = |f: usize| {
        edited.clip.world_rigids(f, &mut was);
        edited.world_rigids(f, &mut is);
        let ankle = foot.leg.ankle.idx();
        is[ankle].rotation * was[ankle].rotation.conjugate()
    };
    let mut worst = 0.0f64;
    for plant in &foot.plants {
        let first = motion(plant.first);
        for f in plant.first..=plant.last {
            worst = worst.max(turn(first.conjugate() * motion(f)).length());
        }
    }
    worst
}

/// Returns a rotation as a vector, for small ones axis times angle.
fn turn(rotation: DQuat) -> DVec3 {
    2.0 * rotation.xyz() * rotation.w.signum()
}

/// Returns the least bend about the source's mean hinge in the thigh's space, where the source bends forwards.
fn knee_back(edited: &EditedClip, foot: &FootPlants) -> f64 {
    let leg = foot.leg;
    let clip = &edited.clip;
    let bend = |rigids: &[Rigid]| {
        let [hip, knee, ankle] = [leg.hip, leg.knee, leg.ankle].map(|j| rigids[j.idx()]);
        let (u, v) = (knee.translation - hip.translation, ankle.translation - knee.translation);
        (hip.rotation.conjugate() * u.normalize().cross(v.normalize()), u.angle_between(v))
    };
    let n = edited.n_frames();
    let mut rigids = Vec::new();
    let mut was = Vec::new();
    for f in 0..n {
        clip.world_rigids(f, &mut rigids);
        was.push(bend(&rigids));
    }
    let usual = was.iter().map(|(axis, _)| *axis).sum::<DVec3>().normalize_or_zero();
    (0..n)
        .map(|f| {
            edited.world_rigids(f, &mut rigids);
            let (axis, _) = bend(&rigids);
            let (now, then) = (axis.dot(usual), was[f].0.dot(usual).min(0.0));
            now - then
        })
        .fold(f64::INFINITY, f64::min)
}

fn bones(subject: &Subject, now: &PointTracks) -> f64 {
    let skeleton = &subject.clip.skeleton;
    let mut worst = 0.0f64;
    for point in 0..skeleton.n_points() {
        // The carrier's own offset from what it hangs on is what an edit changes.
        let Some(parent) = skeleton.point_parent(point).filter(|_| point != subject.clip.facts.carrier.value.idx())
        else {
            continue;
        };
        for f in 0..now.n_frames() {
            let length = |t: &PointTracks| t.position(point, f).distance(t.position(parent, f));
            worst = worst.max((length(now) - length(&subject.tracks)).abs());
        }
    }
    worst
}

fn jerk(tracks: &PointTracks, clip: &Clip) -> f64 {
    let (n, joints) = (tracks.n_frames(), clip.skeleton.n_joints());
    let mut sum = 0.0;
    for joint in 0..joints {
        let at = |f| tracks.position(joint, f);
        sum += (3..n).map(|f| (at(f) - 3.0 * at(f - 1) + 3.0 * at(f - 2) - at(f - 3)).length()).sum::<f64>();
    }
    sum
}

fn acceleration(tracks: &PointTracks, clip: &Clip) -> f64 {
    let mut worst = 0.0f64;
    for joint in 0..clip.skeleton.n_joints() {
        let at = |f| tracks.position(joint, f);
        worst = (2..tracks.n_frames()).map(|f| (at(f) - 2.0 * at(f - 1) + at(f - 2)).length()).fold(worst, f64::max);
    }
    worst
}
