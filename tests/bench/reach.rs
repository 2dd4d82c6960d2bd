//! How near points of a pose get to where they are wanted while feet are held, counted over random presses:
//! `cargo bench --bench reach [-- FROM COUNT]`, the numbers of the first set-up and how many.
//!
//! A set-up is a clip on a path, a frame, a point and joints that may turn; up to four presses follow one another. Every
//! other target is known to be within reach: it is where the point gets to when the same joints are turned at random. The
//! others lie any way. Where a press ends off its target, random turns of the same joints look for a nearer place.

#[allow(dead_code, reason = "shared with tests")]
#[path = "../walking/mod.rs"]
mod walking;

use std::{sync::Arc, time::Instant};

use glam::DVec3;
use walkabout::{
    document::{Document, Solved, open},
    skeleton::JointId,
};
use walking::{captured, opened, reach, set, turn, world};

/// Clips, how they are cycled, and shapes of their paths; no name for the built-in clip.
const WALKS: [(&str, &str, &str); 10] = [
    ("", "plain", "circle"),
    ("", "blended", "circle:2"),
    ("cmu_08_01_brisk_walk", "plain", "zigzag"),
    ("cmu_08_01_brisk_walk", "plain", "eight"),
    ("figure8_walk", "plain", "circle"),
    ("walk01", "blended", "circle:3"),
    ("walk01", "plain", "zigzag"),
    ("cmu_131_01_start_walk_stop", "blended", "circle:2"),
    ("cmu_131_01_start_walk_stop", "plain", "eight"),
    ("cmu_02_01_walk", "plain", "eight"),
];
/// Joints that are moved, by the names that clips give them.
const POINTS: [&str; 16] = [
    "Head",
    "Chest",
    "Spine",
    "Spine1",
    "Neck",
    "LeftKnee",
    "RightKnee",
    "LeftLeg",
    "RightLeg",
    "LeftFoot",
    "RightFoot",
    "LeftAnkle",
    "RightAnkle",
    "LeftHand",
    "RightWrist",
    "LeftForeArm",
];
/// How far targets are, body heights.
const WAYS: std::ops::Range<f64> = 0.02..0.2;
/// A point this near to its target is there, body heights.
const THERE: f64 = 1e-4;
/// A place nearer to a target by more than this is a better one, body heights.
const NEARER: f64 = 1e-3;
/// Random turns that look for a nearer place.
const LOOKS: usize = 24;

fn main() {
    let mut numbers = std::env::args().skip(1).filter_map(|arg| arg.parse::<usize>().ok());
    let (from, count) = (numbers.next().unwrap_or(0), numbers.next().unwrap_or(60));
    let mut documents: Vec<Option<Document>> = vec![None; WALKS.len()];
    let mut counts = Counts::default();
    for setup in from..from + count {
        let walk = WALKS[setup % WALKS.len()];
        let slot = &mut documents[setup % WALKS.len()];
        if slot.is_none() {
            *slot = document(walk);
        }
        let Some(document) = slot else { continue };
        if let Some(pressed) = SetUp::draw(document.clone(), setup) {
            pressed.press(&mut counts, &format!("{setup}: {} {} {}", walk.0, walk.1, walk.2));
        }
    }
    counts.print();
}

fn document((clip, cycling, shape): (&str, &str, &str)) -> Option<Document> {
    let cycling = format!("timing.cycling={cycling}");
    if clip.is_empty() {
        return Some(opened(&[&cycling], Some(shape)));
    }
    let mut document = Document::new(open(Some(&captured(clip)?)).expect("a clip"));
    set(&mut document, &[&cycling], Some(shape));
    Some(document)
}

/// What became of all presses.
#[derive(Default)]
struct Counts {
    /// Presses whose target is known to be within reach, and how many of them ended off it.
    within: [usize; 2],
    /// Presses any way; how many ended off their target; and how many of these off a place that random turns found.
    any_way: [usize; 3],
    /// Presses that ended farther from their target than they were.
    farther: usize,
    /// How long each press took, and which it was.
    millis: Vec<(f64, String)>,
}

impl Counts {
    fn print(mut self) {
        self.millis.sort_by(|a, b| a.0.total_cmp(&b.0));
        let at = |share: f64| &self.millis[((self.millis.len() - 1) as f64 * share) as usize];
        println!("targets known to be within reach: {}, missed {}", self.within[0], self.within[1]);
        let [all, off, nearer] = self.any_way;
        println!("targets any way: {all}, not reached {off}, nearer places found for {nearer} of these");
        println!("presses that ended farther from their target than they were: {}", self.farther);
        let [half, most, (longest, name)] = [0.5, 0.9, 1.0].map(at);
        println!(
            "ms a press, search included: median {:.0}, 9 of 10 within {:.0}, most {longest:.0} ({name})",
            half.0, most.0
        );
    }
}

/// A point of a clip that walks, and joints that may turn.
struct SetUp {
    document: Document,
    frame: usize,
    point: JointId,
    chain: Vec<JointId>,
    noise: Noise,
}

impl SetUp {
    fn draw(document: Document, number: usize) -> Option<Self> {
        let mut noise = Noise(number as u64 * 7919 + 1);
        let solved = Arc::clone(document.solved());
        assert!(solved.holding.is_some(), "feet are held");
        let skeleton = &solved.clip.skeleton;
        let points: Vec<JointId> = POINTS.iter().filter_map(|name| skeleton.find(name)).collect();
        let point = points[noise.below(points.len())];
        let frame = noise.below(solved.edited.n_frames());
        let mut chain: Vec<JointId> =
            skeleton.ids().filter(|&id| id != point && skeleton.is_within(point, id)).collect();
        match noise.below(20) {
            0..9 => {}
            9..13 if chain.len() > 1 => drop(chain.remove(0)),
            13..16 => chain = vec![chain[noise.below(chain.len())]],
            _ => chain.retain(|_| noise.between(0.0..1.0) < 0.6),
        }
        (!chain.is_empty()).then_some(Self { document, frame, point, chain, noise })
    }

    fn at(&self, solved: &Solved) -> DVec3 {
        world(solved, self.frame)[self.point.idx()].translation
    }

    /// Returns where the point gets to when the joints turn at random, by about some angle; none where they cannot.
    fn turned(&mut self, angle: f64) -> Option<DVec3> {
        let mut document = self.document.clone();
        for &joint in &self.chain.clone() {
            let by = self.noise.direction() * angle * self.noise.between(0.0..1.0);
            document.apply(&turn(self.frame, joint, by.normalize(), by.length()), false).ok()?;
        }
        Some(self.at(document.solved()))
    }

    /// Draws a target that the joints can bring the point to.
    fn target_within(&mut self) -> Option<DVec3> {
        let height = self.document.solved().clip.facts.height.value;
        let was = self.at(self.document.solved());
        (0..12).find_map(|_| {
            let angle = self.noise.log_between(0.03..1.0);
            self.turned(angle).filter(|to| WAYS.contains(&(to.distance(was) / height)))
        })
    }

    fn press(mut self, counts: &mut Counts, name: &str) {
        for press in 0..=self.noise.below(4) {
            let solved = Arc::clone(self.document.solved());
            let height = solved.clip.facts.height.value;
            let was = self.at(&solved);
            let is_within = press % 2 == 0;
            let target = match is_within {
                true => self.target_within(),
                false => Some(was + self.noise.direction() * self.noise.log_between(WAYS) * height),
            };
            let Some(to) = target else { continue };
            let begun = Instant::now();
            if self.document.apply(&reach(self.frame, self.point, self.chain.clone(), to), false).is_err() {
                return;
            }
            counts.millis.push((begun.elapsed().as_secs_f64() * 1e3, format!("{name}, press {press}")));
            let off = self.at(self.document.solved()).distance(to) / height;
            let way = was.distance(to) / height;
            let is_off = off > THERE;
            let mut nearest = if is_within { 0.0 } else { off };
            if is_off && !is_within {
                for _ in 0..LOOKS {
                    let angle = self.noise.log_between(0.003..1.0);
                    nearest = self.turned(angle).map_or(nearest, |at| nearest.min(at.distance(to) / height));
                }
            }
            let is_missed = is_off && nearest < off - NEARER;
            let tally = |counts: &mut [usize], what: &[bool]| {
                counts.iter_mut().zip(what).for_each(|(count, &is)| *count += usize::from(is));
            };
            match is_within {
                true => tally(&mut counts.within, &[true, is_off]),
                false => tally(&mut counts.any_way, &[true, is_off, is_missed]),
            }
            counts.farther += usize::from(off > way + 1e-9);
            if is_off && is_within || is_missed || off > way + 1e-9 {
                let name_of = |id: JointId| solved.clip.skeleton.joint(id).name.as_str();
                let chain: Vec<&str> = self.chain.iter().map(|&id| name_of(id)).collect();
                println!(
                    "{name}, press {press}, frame {}, {} by {} goes {:.10}: {off:.1e} off, {nearest:.1e} at least",
                    self.frame,
                    name_of(self.point),
                    chain.join(" "),
                    (to - was) / height,
                );
            }
        }
    }
}

/// Numbers that look random (SplitMix64, S. Vigna).
struct Noise(u64);

impl Noise {
    fn between(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.0 = self.0.wrapping_add(0x9E37_79B9_7F4A_7C15);
        let mut z = self.0;
        z = (z ^ (z >> 30)).wrapping_mul(0xBF58_476D_1CE4_E5B9);
        z = (z ^ (z >> 27)).wrapping_mul(0x94D0_49BB_1331_11EB);
        let unit = ((z ^ (z >> 31)) >> 11) as f64 / (1u64 << 53) as f64;
        range.start + (range.end - range.start) * unit
    }

    fn log_between(&mut self, range: std::ops::Range<f64>) -> f64 {
        self.between(range.start.ln()..range.end.ln()).exp()
    }

    fn below(&mut self, n: usize) -> usize {
        self.between(0.0..n as f64) as usize
    }

    /// A unit vector, any way alike.
    fn direction(&mut self) -> DVec3 {
        loop {
            let way = DVec3::from_array(std::array::from_fn(|_| self.between(-1.0..1.0)));
            if (0.1..1.0).contains(&way.length()) {
                return way.normalize();
            }
        }
    }
}
