//! One look at every joint of every frame: how jerky they move, how tall the body is and where its feet are.
//!
//! An edit moves the body in pieces, each rigid ([`Placed`]). Frames are taken in stretches short enough to stay in the
//! nearest cache. For a stretch the moves of a piece are spread into arrays, and each of its points runs through them
//! several frames at a time:
//!
//! ```text
//! point p of stretch:  source x y z ──move──▶ edited x y z ──third difference──▶ sum of norms
//!                                                     └─ lowest and highest y per frame
//! ```
//!
//! Most moves are upright: a turn about up and a shift. They need less than half the arithmetic and leave heights
//! alone: the lowest and the highest of all points that move so are known beforehand.

use std::ops::Range;

use wide::f64x4;

use super::placed::{Column, Extents, Moves, Placed, STRETCH, Turning, lanes, note, quats};
use crate::{
    math::{Rigid, lanes::LANES},
    motion::{Clip, EditedClip, PointTracks},
    sync::halves,
};

/// Frames before a third difference's last one.
const SPAN: usize = 3;

/// A clip's body, ready to be measured wherever its carrier goes.
#[derive(Clone, Debug)]
pub struct Body {
    /// World positions of all points in the source.
    pub(super) tracks: PointTracks,
    /// Whether each point goes where the carrier goes.
    pub(super) follows: Vec<bool>,
    n_joints: usize,
    /// What takes the carrier of each frame to the origin.
    pub(super) to_origin: Vec<Rigid>,
    /// Of the points that follow.
    pub(super) extents: Extents,
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

/// What a look at some of the frames gives.
struct Part {
    jerk_sum: f64,
    /// Highest minus lowest point of each frame.
    heights: Vec<f64>,
    /// Positions of the points asked for, axis by axis.
    tracks: Vec<[Vec<f64>; 3]>,
}

impl Body {
    /// Returns the world positions of all points in the source.
    pub fn tracks(&self) -> &PointTracks {
        &self.tracks
    }

    /// Prepares a clip; one pass over all its frames. `carriers` is the clip's own carrier track.
    pub fn of(clip: &Clip, carriers: &[Rigid]) -> Self {
        let skeleton = &clip.skeleton;
        let carrier = clip.facts.carrier.value;
        let within = skeleton.subtree(carrier);
        let sites = skeleton.end_sites().iter().map(|id| within[id.idx()]);
        let follows: Vec<bool> = within.iter().copied().chain(sites).collect();
        let tracks = clip.world_tracks();
        let mut body = Self {
            extents: Extents::new(&tracks, follows.clone()),
            tracks,
            follows,
            n_joints: skeleton.n_joints(),
            to_origin: carriers.iter().map(Rigid::inverse).collect(),
            source: Sweep { mean_jerk: None, height: 0.0 },
        };
        let frames: Vec<u32> = (0..carriers.len() as u32).collect();
        body.source = body.look_at(&Placed::as_it_was(&body, &frames), &[]).0;
        body
    }

    /// Returns what was found for the clip as loaded.
    pub fn source(&self) -> Sweep {
        self.source
    }

    /// Looks at all frames of an edit of the clip, and returns where it has some of the points.
    ///
    /// `turning` has every joint that the edit turns.
    ///
    /// # Panics
    ///
    /// When it has not.
    pub fn look(&self, edited: &EditedClip, turning: &Turning, points: &[usize]) -> (Sweep, PointTracks) {
        self.look_at(&Placed::new(self, edited, turning), points)
    }

    /// Returns where an edit of the clip has some of the points, and looks at nothing else.
    ///
    /// # Panics
    ///
    /// As [`Body::look`].
    pub fn moved(&self, edited: &EditedClip, turning: &Turning, points: &[usize]) -> PointTracks {
        let placed = Placed::new(self, edited, turning);
        let n = placed.source_frames.len();
        let parts = halves(n, 0, |frames| {
            let mut tracks = PointTracks::new(points.len(), frames.len());
            let mut moves = placed.no_moves();
            let mut stretch = Stretch::new();
            for from in frames.clone().step_by(STRETCH) {
                let end = (from + STRETCH).min(frames.end);
                placed.moves(self, from..end, &mut moves);
                stretch.begin(&placed.source_frames[from..end]);
                for (idx, &point) in points.iter().enumerate() {
                    let piece = placed.piece_of[point];
                    if let Some(piece) = piece {
                        stretch.spread(&moves[piece]);
                    }
                    self.place(&mut stretch, point, piece.is_some());
                    tracks.put(idx, from - frames.start, stretch.world.each_ref().map(|axis| &axis[..end - from]));
                }
            }
            tracks
        });
        let mut tracks = PointTracks::new(points.len(), n);
        let mut first = 0;
        for part in &parts {
            for point in 0..points.len() {
                tracks.put(point, first, [part.x(point), part.y(point), part.z(point)]);
            }
            first += part.n_frames();
        }
        tracks
    }

    fn look_at(&self, placed: &Placed, points: &[usize]) -> (Sweep, PointTracks) {
        let n = placed.source_frames.len();
        // The frames of the last third difference before the middle are taken again after it.
        let parts = halves(n, SPAN, |range| self.part(placed, range, points));
        let n_jerks = n.saturating_sub(SPAN) * self.n_joints;
        let jerk_sum: f64 = parts.iter().map(|part| part.jerk_sum).sum();
        let mut heights = Vec::with_capacity(n);
        let mut tracks = PointTracks::new(points.len(), n);
        for (idx, part) in parts.iter().enumerate() {
            let again = if idx > 0 { SPAN } else { 0 };
            for (point, axes) in part.tracks.iter().enumerate() {
                tracks.put(point, heights.len(), axes.each_ref().map(|axis| &axis[again..]));
            }
            heights.extend_from_slice(&part.heights[again..]);
        }
        let mean_jerk = (n_jerks > 0).then(|| jerk_sum / n_jerks as f64);
        (Sweep { mean_jerk, height: median(&mut heights) }, tracks)
    }

    /// Looks at some frames.
    fn part(&self, placed: &Placed, frames: Range<usize>, wanted: &[usize]) -> Part {
        let axis = || Vec::with_capacity(frames.len());
        let mut part =
            Part { jerk_sum: 0.0, heights: axis(), tracks: wanted.iter().map(|_| [axis(), axis(), axis()]).collect() };
        // Points of one piece follow one another, so that its moves are spread once for all of them.
        let mut points: Vec<usize> = (0..self.follows.len()).collect();
        points.sort_by_key(|&point| placed.piece_of[point]);
        let mut moves = placed.no_moves();
        let mut stretch = Stretch::new();
        let mut from = frames.start;
        while from < frames.end {
            let end = (from + STRETCH).min(frames.end);
            // The frames of the last third difference are taken again with the next stretch.
            let overlap = if end < frames.end { SPAN } else { 0 };
            let kept = end - from - overlap;
            placed.moves(self, from..end, &mut moves);
            stretch.begin(&placed.source_frames[from..end]);
            let knows_extents = moves[0].upright;
            if knows_extents {
                stretch.begin_extents(placed.extents, &moves[0]);
            }
            let mut piece = None;
            for &point in &points {
                let is_joint = point < self.n_joints;
                let is_noted = knows_extents && placed.extents.of[point] && placed.piece_of[point] == Some(0);
                if !is_joint && is_noted && !wanted.contains(&point) {
                    continue;
                }
                if placed.piece_of[point] != piece {
                    piece = placed.piece_of[point];
                    if let Some(piece) = piece {
                        stretch.spread(&moves[piece]);
                    }
                }
                self.place(&mut stretch, point, piece.is_some());
                if is_joint {
                    part.jerk_sum += jerk_sum(&stretch.world, end - from);
                }
                if !is_noted {
                    stretch.note_heights();
                }
                for (_, axes) in wanted.iter().zip(&mut part.tracks).filter(|(wanted, _)| **wanted == point) {
                    for (axis, world) in axes.iter_mut().zip(&stretch.world) {
                        axis.extend_from_slice(&world[..kept]);
                    }
                }
            }
            part.heights.extend(stretch.heights().take(kept));
            from = end - overlap;
        }
        part
    }

    /// Brings a point to where the moves that are spread in a stretch have it.
    fn place(&self, stretch: &mut Stretch, point: usize, follows: bool) {
        stretch.place([self.tracks.x(point), self.tracks.y(point), self.tracks.z(point)], follows);
    }
}

/// A stretch of frames and what one point does in it.
struct Stretch<'a> {
    frames: &'a [u32],
    /// The clip's frames follow one another, so a track can be read in place.
    in_place: bool,
    upright: bool,
    /// Rotation by rows, then translation; of an upright move only what [`carry_upright`] reads.
    motion: [Column; 12],
    /// World position of the point in hand.
    world: [Column; 3],
    gathered: [Column; 3],
    low: Column,
    high: Column,
}

impl<'a> Stretch<'a> {
    fn new() -> Self {
        Self {
            frames: &[],
            in_place: true,
            upright: true,
            motion: [[0.0; STRETCH]; 12],
            world: [[0.0; STRETCH]; 3],
            gathered: [[0.0; STRETCH]; 3],
            low: [0.0; STRETCH],
            high: [0.0; STRETCH],
        }
    }

    fn begin(&mut self, frames: &'a [u32]) {
        self.frames = frames;
        self.in_place = frames.windows(2).all(|w| w[1] == w[0] + 1);
        self.low.fill(f64::INFINITY);
        self.high.fill(f64::NEG_INFINITY);
    }

    /// Begins with the heights of points that move upright.
    fn begin_extents(&mut self, extents: &Extents, by: &Moves) {
        let lifts = self.low.iter_mut().zip(&mut self.high).zip(&by.translation[1]);
        for (((low, high), lift), &f) in lifts.zip(self.frames) {
            (*low, *high) = (extents.low[f as usize] + lift, extents.high[f as usize] + lift);
        }
    }

    /// Spreads the moves of a piece into columns.
    fn spread(&mut self, by: &Moves) {
        self.upright = by.upright;
        self.motion[SHIFT..].copy_from_slice(&by.translation);
        for at in (0..self.frames.len()).step_by(LANES) {
            let mut put = |column: usize, value: f64x4| {
                self.motion[column][at..at + LANES].copy_from_slice(&value.to_array());
            };
            let q = quats(&by.rotation, at);
            if by.upright {
                put(COS, q.w * q.w - q.y * q.y);
                put(SIN, (q.w + q.w) * q.y);
                continue;
            }
            let one = f64x4::ONE;
            let (x2, y2, z2) = (q.x + q.x, q.y + q.y, q.z + q.z);
            let (xx, yy, zz) = (q.x * x2, q.y * y2, q.z * z2);
            let (xy, xz, yz) = (q.x * y2, q.x * z2, q.y * z2);
            let (wx, wy, wz) = (q.w * x2, q.w * y2, q.w * z2);
            let rows = [one - (yy + zz), xy - wz, xz + wy, xy + wz, one - (xx + zz), yz - wx];
            let last_row = [xz - wy, yz + wx, one - (xx + yy)];
            rows.into_iter().chain(last_row).enumerate().for_each(|(column, value)| put(column, value));
        }
    }

    /// Brings a track of the source to where the edit has it.
    fn place(&mut self, track: [&[f64]; 3], follows: bool) {
        let n = self.frames.len();
        let first = self.frames[0] as usize;
        let source = if self.in_place {
            track.map(|axis| &axis[first..first + n])
        } else {
            for (to, axis) in self.gathered.iter_mut().zip(track) {
                for (to, &f) in to.iter_mut().zip(self.frames) {
                    *to = axis[f as usize];
                }
            }
            self.gathered.each_ref().map(|axis| &axis[..n])
        };
        match (follows, self.upright) {
            (true, true) => carry_upright(&self.motion, source, &mut self.world),
            (true, false) => carry(&self.motion, source, &mut self.world),
            (false, _) => {
                for (world, axis) in self.world.iter_mut().zip(source) {
                    world[..n].copy_from_slice(axis);
                }
            }
        }
    }

    fn note_heights(&mut self) {
        note(&mut self.low, &mut self.high, &self.world[1]);
    }

    fn heights(&self) -> impl Iterator<Item = f64> + '_ {
        self.high.iter().zip(&self.low).map(|(high, low)| high - low)
    }
}

/// Column of a rotation's cosine when it is about up: row 0, column 0.
const COS: usize = 0;
/// Column of its sine: row 0, column 2.
const SIN: usize = 2;
/// First column of the translation.
const SHIFT: usize = 9;

/// Carries a point through the stretch's moves.
fn carry(motion: &[Column; 12], [x, y, z]: [&[f64]; 3], world: &mut [Column; 3]) {
    let n = x.len();
    let (y, z) = (&y[..n], &z[..n]);
    for (axis, world) in world.iter_mut().enumerate() {
        let [a, b, c] = [0, 1, 2].map(|column| &motion[3 * axis + column][..n]);
        let (t, world) = (&motion[SHIFT + axis][..n], &mut world[..n]);
        for i in 0..n {
            world[i] = a[i] * x[i] + b[i] * y[i] + c[i] * z[i] + t[i];
        }
    }
}

/// Carries a point through moves that turn about up only.
fn carry_upright(motion: &[Column; 12], [x, y, z]: [&[f64]; 3], world: &mut [Column; 3]) {
    let n = x.len();
    let (y, z) = (&y[..n], &z[..n]);
    let [cos, sin, dx, dy, dz] = [COS, SIN, SHIFT, SHIFT + 1, SHIFT + 2].map(|column| &motion[column][..n]);
    let [to_x, to_y, to_z] = world.each_mut().map(|axis| &mut axis[..n]);
    for i in 0..n {
        to_x[i] = cos[i] * x[i] + sin[i] * z[i] + dx[i];
        to_y[i] = y[i] + dy[i];
        to_z[i] = cos[i] * z[i] - sin[i] * x[i] + dz[i];
    }
}

/// Returns the sum of the norms of the third differences of a track of `n` frames.
fn jerk_sum(world: &[Column; 3], n: usize) -> f64 {
    let n_jerks = n.saturating_sub(SPAN);
    let whole = n_jerks - n_jerks % LANES;
    let three = f64x4::splat(3.0);
    let mut sums = f64x4::splat(0.0);
    for at in (0..whole).step_by(LANES) {
        let squares = world.each_ref().map(|axis| {
            let lanes = |k: usize| lanes(axis, at + k);
            let third = (lanes(3) - lanes(0)) + three * (lanes(1) - lanes(2));
            third * third
        });
        sums += (squares[0] + squares[1] + squares[2]).sqrt();
    }
    let rest: f64 = (whole..n_jerks)
        .map(|at| {
            let third = |axis: &Column| (axis[at + 3] - axis[at]) + 3.0 * (axis[at + 1] - axis[at + 2]);
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
    use crate::{
        bvh::Bvh,
        motion::{ClipOptions, EditedClip, TurnedJoint},
    };
    use glam::{DQuat, DVec3};
    use std::sync::Arc;

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
    fn plainly(clip: &Clip, edited: &EditedClip) -> (f64, f64) {
        let frames = &edited.source_frames;
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
        for n in [4, 7, 127, 128, 129, 131, 132, 253, 256, 700, 2100] {
            let clip = Arc::new(clip(n));
            let body = Body::of(&clip, &clip.carrier_track());
            let (jerk, height) = plainly(&clip, &EditedClip::unedited(clip.clone()));
            assert!((body.source().mean_jerk.expect("four frames") / jerk - 1.0).abs() < 1e-9, "{n} frames");
            assert!((body.source().height - height).abs() < 1e-12);
            assert!((body.source().height - clip.facts.height.value).abs() < 1e-12);

            let frames: Vec<u32> = (0..n as u32).chain(0..n as u32 / 2).collect();
            let carriers = elsewhere(frames.len());
            let turned = carriers.iter().zip(&frames).map(|(c, &f)| {
                // Turned and shifted only: the way upright moves go.
                let turn = Rigid::new(DQuat::from_rotation_y(c.translation.x), c.translation);
                turn * clip.carrier_world(f as usize)
            });
            let arm = clip.skeleton.find("Arm").expect("a joint");
            let bent = TurnedJoint { joint: arm, rotations: carriers.iter().map(|c| c.rotation).collect() };
            let turning = Turning::of(&clip, &body, [arm]);
            for (carrier_world, bent) in [
                (carriers.clone(), None),
                (turned.collect(), None),
                (carriers, Some(bent.clone())),
                (Vec::new(), Some(bent)),
            ] {
                let edited = EditedClip {
                    clip: Arc::clone(&clip),
                    source_frames: frames.clone(),
                    carrier_world,
                    turned: bent.into_iter().collect(),
                };
                let points = [clip.skeleton.n_joints(), arm.idx()];
                let (sweep, tracks) = body.look(&edited, &turning, &points);
                let alone = body.moved(&edited, &turning, &points);
                let mut world = Vec::new();
                for f in 0..frames.len() {
                    edited.world_points(f, &mut world);
                    for (idx, &point) in points.iter().enumerate() {
                        assert_eq!(alone.position(idx, f), tracks.position(idx, f));
                        assert!(tracks.position(idx, f).distance(world[point]) < 1e-9, "point {point} of frame {f}");
                    }
                }
                let (jerk, height) = plainly(&clip, &edited);
                assert!((sweep.mean_jerk.expect("four frames") / jerk - 1.0).abs() < 1e-9, "{n} frames");
                assert!((sweep.height - height).abs() < 1e-9);
            }
        }
    }

    #[test]
    fn three_frames_have_no_jerk() {
        for n in 2..4 {
            let clip = clip(n);
            assert_eq!(Body::of(&clip, &clip.carrier_track()).source().mean_jerk, None);
        }
    }
}
