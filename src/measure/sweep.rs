//! One look at every joint of every frame: how jerky they move and how tall the body is.
//!
//! Frames are taken in stretches short enough to stay in the nearest cache. For a stretch the carrier's motions are
//! spread into twelve arrays, and each point runs through them four frames at a time:
//!
//! ```text
//! point p of stretch:  relative x y z ──carrier──▶ world x y z ──third difference──▶ sum of norms
//!                                                        └─ lowest and highest y per frame
//! ```

use glam::DMat3;
use wide::f64x4;

use crate::{
    math::Rigid,
    motion::{CarrierRelative, Clip, carrier_relative},
};

/// Frames in a stretch; a multiple of four.
const STRETCH: usize = 256;
/// A third difference spans four frames, so stretches share three; rounded up to whole lanes.
const BUFFER: usize = STRETCH + LANES;
const LANES: usize = 4;
/// Frames before a third difference's last one.
const SPAN: usize = 3;

/// A clip's body, ready to be measured wherever its carrier goes.
#[derive(Clone, Debug)]
pub struct Body {
    relative: CarrierRelative,
    n_joints: usize,
    /// World tracks of the points outside the carrier's subtree, which no edit moves.
    outside: Vec<Track>,
    source: Sweep,
}

/// What a look at all frames gives.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Sweep {
    /// Mean norm of the third difference over joints and frames, the clip's unit; none for fewer than four frames.
    pub mean_jerk: Option<f64>,
    /// Median over frames of the highest minus the lowest point along up, the clip's unit.
    pub height: f64,
}

/// World positions of one point over the clip's frames.
#[derive(Clone, Debug)]
struct Track {
    is_joint: bool,
    axes: [Vec<f64>; 3],
}

impl Body {
    /// Prepares a clip; one pass over all its frames. `carriers` is the clip's own carrier track.
    pub fn of(clip: &Clip, carriers: &[Rigid]) -> Self {
        let relative = carrier_relative(clip);
        let n_joints = clip.skeleton.n_joints();
        let mut body = Self {
            outside: outside_tracks(clip, &relative),
            relative,
            n_joints,
            source: Sweep { mean_jerk: None, height: 0.0 },
        };
        let frames: Vec<u32> = (0..carriers.len() as u32).collect();
        body.source = body.sweep(carriers, &frames);
        body
    }

    /// Returns what was found for the clip as loaded.
    pub fn source(&self) -> Sweep {
        self.source
    }

    /// Looks at all frames of the clip with its carrier elsewhere: frame `i` shows the clip's frame `frames[i]`.
    pub fn sweep(&self, carriers: &[Rigid], frames: &[u32]) -> Sweep {
        let n = frames.len();
        let mut sum = 0.0;
        let mut heights = Vec::with_capacity(n);
        let mut stretch = Stretch::new();
        let mut from = 0;
        while from < n {
            // The frames of the last third difference, counted again with the next stretch.
            let end = (from + STRETCH).min(n);
            stretch.begin(&carriers[from..end], &frames[from..end]);
            for (point, &skeleton_point) in self.relative.points.iter().enumerate() {
                let tracks = &self.relative.tracks;
                stretch.place([tracks.x(point), tracks.y(point), tracks.z(point)]);
                sum += stretch.look(skeleton_point < self.n_joints);
            }
            for track in &self.outside {
                stretch.copy([&track.axes[0], &track.axes[1], &track.axes[2]]);
                sum += stretch.look(track.is_joint);
            }
            let overlap = if end < n { SPAN } else { 0 };
            heights.extend(stretch.heights().take(end - from - overlap));
            from = end - overlap;
        }
        let n_jerks = n.saturating_sub(SPAN) * self.n_joints;
        Sweep { mean_jerk: (n_jerks > 0).then(|| sum / n_jerks as f64), height: median(&mut heights) }
    }
}

fn outside_tracks(clip: &Clip, relative: &CarrierRelative) -> Vec<Track> {
    let n_points = clip.skeleton.n_points();
    if relative.points.len() == n_points {
        return Vec::new();
    }
    let world = clip.world_tracks();
    (0..n_points)
        .filter(|point| !relative.points.contains(point))
        .map(|point| Track {
            is_joint: point < clip.skeleton.n_joints(),
            axes: [world.x(point).to_vec(), world.y(point).to_vec(), world.z(point).to_vec()],
        })
        .collect()
}

/// A stretch of frames and what one point does in it.
struct Stretch<'a> {
    frames: &'a [u32],
    /// The clip's frames follow one another, so a track can be read in place.
    in_place: bool,
    /// Carrier's rotation by rows, then its translation.
    motion: [[f64; BUFFER]; 12],
    /// World position of the point in hand.
    world: [[f64; BUFFER]; 3],
    gathered: [[f64; BUFFER]; 3],
    low: [f64; BUFFER],
    high: [f64; BUFFER],
}

impl<'a> Stretch<'a> {
    fn new() -> Self {
        Self {
            frames: &[],
            in_place: true,
            motion: [[0.0; BUFFER]; 12],
            world: [[0.0; BUFFER]; 3],
            gathered: [[0.0; BUFFER]; 3],
            low: [0.0; BUFFER],
            high: [0.0; BUFFER],
        }
    }

    fn begin(&mut self, carriers: &[Rigid], frames: &'a [u32]) {
        self.frames = frames;
        self.in_place = frames.windows(2).all(|w| w[1] == w[0] + 1);
        self.low.fill(f64::INFINITY);
        self.high.fill(f64::NEG_INFINITY);
        for (i, carrier) in carriers.iter().enumerate() {
            let columns = DMat3::from_quat(carrier.rotation);
            let rows = columns.transpose();
            let rows = [rows.x_axis, rows.y_axis, rows.z_axis].map(|r| r.to_array());
            for (slot, value) in rows.as_flattened().iter().chain(&carrier.translation.to_array()).enumerate() {
                self.motion[slot][i] = *value;
            }
        }
    }

    /// Brings a track, relative to the carrier, into the world.
    fn place(&mut self, track: [&[f64]; 3]) {
        let n = self.frames.len();
        if self.in_place && n > 0 {
            let first = self.frames[0] as usize;
            carry(&self.motion, track.map(|axis| &axis[first..first + n]), &mut self.world);
        } else {
            for (gathered, axis) in self.gathered.iter_mut().zip(track) {
                gather(gathered, axis, self.frames);
            }
            let gathered = self.gathered.each_ref().map(|axis| &axis[..n]);
            carry(&self.motion, gathered, &mut self.world);
        }
    }

    /// Takes a track that is in the world already.
    fn copy(&mut self, track: [&[f64]; 3]) {
        for (world, axis) in self.world.iter_mut().zip(track) {
            gather(world, axis, self.frames);
        }
    }

    /// Takes note of the point's height and returns its sum of third differences, 0 for a point that is no joint.
    fn look(&mut self, is_joint: bool) -> f64 {
        for ((low, high), y) in self.low.iter_mut().zip(&mut self.high).zip(&self.world[1]) {
            *low = if *y < *low { *y } else { *low };
            *high = if *y > *high { *y } else { *high };
        }
        if is_joint { jerk_sum(&self.world, self.frames.len()) } else { 0.0 }
    }

    fn heights(&self) -> impl Iterator<Item = f64> + '_ {
        self.high.iter().zip(&self.low).map(|(high, low)| high - low)
    }
}

fn gather(to: &mut [f64; BUFFER], axis: &[f64], frames: &[u32]) {
    for (to, &f) in to.iter_mut().zip(frames) {
        *to = axis[f as usize];
    }
}

/// Carries a point through the stretch's motions.
fn carry(motion: &[[f64; BUFFER]; 12], [x, y, z]: [&[f64]; 3], world: &mut [[f64; BUFFER]; 3]) {
    let n = x.len();
    let (x, y, z) = (&x[..n], &y[..n], &z[..n]);
    for (axis, world) in world.iter_mut().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|column| &motion[3 * axis + column][..n]);
        let (t, world) = (&motion[9 + axis][..n], &mut world[..n]);
        for i in 0..n {
            world[i] = a[i] * x[i] + b[i] * y[i] + c[i] * z[i] + t[i];
        }
    }
}

/// Returns the sum of the norms of the third differences of a track of `n` frames.
fn jerk_sum(world: &[[f64; BUFFER]; 3], n: usize) -> f64 {
    let n_jerks = n.saturating_sub(SPAN);
    let whole = n_jerks - n_jerks % LANES;
    let three = f64x4::splat(3.0);
    let mut sums = f64x4::splat(0.0);
    for at in (0..whole).step_by(LANES) {
        let squares = world.each_ref().map(|axis| {
            let lanes = |k: usize| f64x4::new(axis[at + k..at + k + LANES].try_into().expect("four lanes"));
            let third = (lanes(3) - lanes(0)) + three * (lanes(1) - lanes(2));
            third * third
        });
        sums += (squares[0] + squares[1] + squares[2]).sqrt();
    }
    let rest: f64 = (whole..n_jerks)
        .map(|at| {
            let third = |axis: &[f64; BUFFER]| (axis[at + 3] - axis[at]) + 3.0 * (axis[at + 1] - axis[at + 2]);
            world.iter().map(|axis| third(axis).powi(2)).sum::<f64>().sqrt()
        })
        .sum();
    sums.reduce_add() + rest
}

fn median(values: &mut [f64]) -> f64 {
    if values.is_empty() {
        return 0.0;
    }
    let middle = ((values.len() - 1) as f64 * 0.5).round() as usize;
    *values.select_nth_unstable_by(middle, f64::total_cmp).1
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{bvh::Bvh, motion::ClipOptions};
    use glam::{DQuat, DVec3};

    /// A root that stays, a carrier below it and an arm with an end site.
    fn clip(n_frames: usize) -> Clip {
        let mut text = String::from(
            "HIERARCHY\nROOT Base\n{\nOFFSET 0 0 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nJOINT Hips\n{\n\
             OFFSET 0 0 0\nCHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation\nJOINT Arm\n{\n\
             OFFSET 1 5 0\nCHANNELS 3 Zrotation Xrotation Yrotation\nEnd Site\n{\nOFFSET 0 2 1\n}\n}\n}\n}\n",
        );
        text += &format!("MOTION\nFrames: {n_frames}\nFrame Time: 0.01\n");
        for f in 0..n_frames {
            let u = f as f64;
            text += &format!("0 0 0 {} {} {u} {} 10 {} 5 {} 0\n", (0.1 * u).sin(), u * u * 1e-3, u, 2.0 * u, u % 7.0);
        }
        let bvh = Bvh::parse(text.into_bytes(), "test").expect("a valid file");
        Clip::from_bvh(&bvh, &ClipOptions { carrier: Some("Hips".to_owned()), ..ClipOptions::default() })
    }

    /// The same numbers by the plainest means.
    fn plainly(clip: &Clip, carriers: &[Rigid], frames: &[u32]) -> (f64, f64) {
        let edited = crate::motion::EditedClip {
            clip: std::sync::Arc::new(clip.clone()),
            source_frames: frames.to_vec(),
            carrier_world: carriers.to_vec(),
            turned: Vec::new(),
        };
        let worlds: Vec<Vec<DVec3>> = (0..frames.len())
            .map(|f| {
                let mut points = Vec::new();
                edited.world_points(f, &mut points);
                points
            })
            .collect();
        let n_joints = clip.skeleton.n_joints();
        let mut jerks = Vec::new();
        for w in worlds.windows(4) {
            for (j, last) in w[3][..n_joints].iter().enumerate() {
                jerks.push((*last - w[2][j] * 3.0 + w[1][j] * 3.0 - w[0][j]).length());
            }
        }
        let mut heights: Vec<f64> = worlds
            .iter()
            .map(|w| {
                let y = |pick: fn(f64, f64) -> f64, start| w.iter().map(|p| p.y).fold(start, pick);
                y(f64::max, f64::NEG_INFINITY) - y(f64::min, f64::INFINITY)
            })
            .collect();
        (jerks.iter().sum::<f64>() / jerks.len() as f64, median(&mut heights))
    }

    fn elsewhere(n: usize) -> Vec<Rigid> {
        (0..n)
            .map(|f| {
                let u = f as f64 * 0.1;
                Rigid::new(DQuat::from_rotation_y(u) * DQuat::from_rotation_x(0.3), DVec3::new(u.cos(), u, 0.1 * u * u))
            })
            .collect()
    }

    #[test]
    fn the_sweep_is_what_plain_kinematics_says() {
        // Around the length of a stretch, where the pieces are joined.
        for n in [4, 7, 255, 256, 257, 259, 260, 512, 700] {
            let clip = clip(n);
            let body = Body::of(&clip, &clip.carrier_track());
            let (jerk, height) = plainly(&clip, &clip.carrier_track(), &(0..n as u32).collect::<Vec<_>>());
            assert!((body.source().mean_jerk.expect("four frames") / jerk - 1.0).abs() < 1e-9, "{n} frames");
            assert!((body.source().height - height).abs() < 1e-12);
            assert!((body.source().height - clip.facts.height.value).abs() < 1e-12);

            let frames: Vec<u32> = (0..n as u32).chain(0..n as u32 / 2).collect();
            let carriers = elsewhere(frames.len());
            let sweep = body.sweep(&carriers, &frames);
            let (jerk, height) = plainly(&clip, &carriers, &frames);
            assert!((sweep.mean_jerk.expect("four frames") / jerk - 1.0).abs() < 1e-9, "{n} frames");
            assert!((sweep.height - height).abs() < 1e-12);
        }
    }

    #[test]
    fn three_frames_have_no_jerk() {
        for n in 1..4 {
            let clip = clip(n);
            assert_eq!(Body::of(&clip, &clip.carrier_track()).source().mean_jerk, None);
        }
    }
}
