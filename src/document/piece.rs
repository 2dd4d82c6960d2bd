//! A piece of what walks, around one frame: edits of a pose are tried on it before the whole clip follows them.
//!
//! Holding a foot turns a whole clip, but what it does at a frame is decided within a few steps of it. A piece is cut
//! out of the stages of a solve, and layers, legs and holding are run on it alone. What comes of it is nearly what comes
//! of the whole clip: near enough to find an edit by, and the whole clip then tells by how little it was off. Until it does
//! the clip can be shown with what the edit did to the piece.

use std::{ops::Range, sync::Arc};

use glam::DQuat;

use super::{
    Edits, Solved, feet,
    holding::frames_beyond,
    posed::{carried_over, legs_posed, own_carrier},
    solve::Extent,
};
use crate::{
    constrain::{Job, Prepared, hold, knot_frames},
    contact::{FootPlants, Plant},
    displace::{Displaced, Stack},
    math::Rigid,
    motion::{Clip, EditedClip, TurnedJoint},
    path::{PathFrame, Residuals},
    skeleton::JointId,
    sync::Hurry,
};

/// A point that is nearer to its target than this share of the body height is there.
pub(super) const THERE: f64 = 7e-5;
/// On a piece of the clip, where to be nearer costs next to nothing.
pub(super) const THERE_ON_PIECE: f64 = 1e-5;
/// How often the whole clip follows an edit, at most, where somebody may wait for it.
pub(super) const DRAFTS: usize = 5;
/// Corrections of what holding does to a foot or the carrier, on a piece, at most.
pub(super) const CORRECTIONS: usize = 12;

/// Time on either side of the frame, seconds. By the first the carrier's offset has mostly forgotten all but a few
/// thousandths; where somebody stands long it has not, and the clip does not do what the piece did.
pub(super) const AROUND_SECS: [f64; 2] = [1.5, 4.5];
/// Feet that stand this near to the frame, or next before or after, stand in the piece as long as in the clip, seconds.
const NEAR_SECS: f64 = 0.5;
/// Where a piece is shown within the clip, one goes over into the other in this time, seconds.
const FADE_SECS: f64 = 0.5;

/// How far the clip follows an edit of a pose before it is seen.
#[derive(Clone, Copy, Debug)]
pub(super) enum Follows<'a> {
    /// All of it, and what the piece was off by is corrected; unless somebody is in a hurry, and then what comes of it is
    /// worth nothing.
    Everywhere(&'a Hurry),
    /// All of it, too, but nothing is searched for long.
    Briefly,
    /// As the piece does, see [`Piece::shown`], with what is soon found on it.
    Nearby,
}

impl Follows<'_> {
    pub(super) fn is_nearby(self) -> bool {
        matches!(self, Self::Nearby)
    }

    /// Tells whether nothing is to be searched for long.
    pub(super) fn is_brief(self) -> bool {
        matches!(self, Self::Nearby | Self::Briefly)
    }

    /// Tells whether what is being done is to be given up.
    pub(super) fn is_given_up(self) -> bool {
        matches!(self, Self::Everywhere(hurry) if hurry.is_raised())
    }
}

/// A piece of what walks. Its frames count from its first one.
pub(super) struct Piece<'a> {
    solved: &'a Solved,
    /// The frame it is made for.
    frame: usize,
    /// The edited frame that shows the first frame of what walks.
    begin: usize,
    /// Its frames among those of what walks.
    of_walk: Range<usize>,
    /// The new path's frames, carried on where it ends before the piece.
    path: Vec<PathFrame>,
    /// What holding adds to the height of the clip more than to that of a piece by itself.
    lifts: Vec<f64>,
    clip: Arc<Clip>,
    residuals: Residuals,
    plants: Vec<FootPlants>,
    /// The piece without layers, ready to be held: it lends what they do not change.
    plain: Prepared,
}

/// What is seen of a piece.
#[derive(Clone)]
pub(super) struct Seen {
    /// World motions, at the frame that the piece is made for, of the joints that legs hang on: on the original path, the
    /// feet not held.
    pub(super) before_holding: Vec<Rigid>,
    /// The same of all joints, on the new path, the feet held.
    pub(super) held: Vec<Rigid>,
    /// The piece on the new path, the feet held.
    walk: Arc<EditedClip>,
}

impl<'a> Piece<'a> {
    /// Cuts a piece out of a clip that walks with its feet held, so many seconds on either side of an edited frame.
    pub(super) fn around(solved: &'a Solved, edited_frame: usize, secs: f64) -> Self {
        // A cycle that is not joined to the one before begins anew, and so does holding.
        let restarts: &[usize] = if solved.walked.repeat.is_some() { &[] } else { &solved.timing.seams };
        let n_begun = restarts.partition_point(|&restart| restart <= edited_frame);
        let begin = n_begun.checked_sub(1).map_or(0, |last| restarts[last]);
        let n_shown = restarts.get(n_begun).copied().unwrap_or(solved.walk.n_frames()) - begin;
        let frame = edited_frame - begin;

        // Holding looks beyond where a cycle or the path is cut.
        let (walked, timing) = (&solved.walked, &solved.timing);
        let n_frames = walked.clip.n_frames();
        let n_around = |secs: f64| (secs / walked.clip.frame_time_secs).ceil() as usize;
        let around = |secs: f64| frame.saturating_sub(n_around(secs))..(frame + n_around(secs) + 1).min(n_frames);
        let (near, around) = (around(NEAR_SECS), around(secs));
        // A foot in swing comes from the plant before and goes to the one after.
        let moves_foot = |foot: &FootPlants| {
            let begin = foot.plants.partition_point(|plant| plant.last < near.start).saturating_sub(1);
            let end = foot.plants.partition_point(|plant| plant.first < near.end) + 1;
            begin..end.min(foot.plants.len())
        };
        let mut of_walk = around.clone();
        for plant in walked.plants.iter().flat_map(|foot| &foot.plants[moves_foot(foot)]) {
            if plant.first < around.end && around.start <= plant.last {
                of_walk = of_walk.start.min(plant.first)..of_walk.end.max(plant.last + 1).min(n_frames);
            }
        }
        // The carrier's offset is a spline with its knots where the clip's has them.
        of_walk.start -= of_walk.start % knot_frames(walked.clip.frame_time_secs);
        let cut = EditedClip {
            source_frames: of_walk.clone().map(|frame| frame as u32).collect(),
            ..EditedClip::unedited(Arc::clone(&walked.clip))
        };
        let mut path = timing.frames[begin..begin + n_shown].to_vec();
        path.extend(frames_beyond(&solved.new_path, timing, &walked.progress, begin, n_shown..n_frames));
        let (prepared, original) = (&solved.posed.prepared, walked.path(&solved.original));
        // A piece of a path has a trend and a waver of its own.
        let in_clip = prepared.lifts(&path, original);
        path = path[of_walk.clone()].to_vec();
        let own = prepared.lifts(&path, &original[of_walk.clone()]);
        let lifts = in_clip[of_walk.clone()].iter().zip(own).map(|(in_clip, own)| in_clip - own).collect();
        let residuals = &solved.posed.residuals;
        let clip = Arc::new(Clip::rearranged(&cut));
        let plants: Vec<FootPlants> = walked.plants.iter().map(|foot| plants_in(foot, &of_walk)).collect();
        let unedited = Arc::new(EditedClip::unedited(Arc::clone(&clip)));
        Self {
            solved,
            frame: frame - of_walk.start,
            begin,
            plain: feet::prepared(&unedited, &[], &plants, solved.edits.plants.clean, None),
            clip,
            residuals: Residuals { frame: residuals.frame, motions: residuals.motions[of_walk.clone()].to_vec() },
            plants,
            path,
            lifts,
            of_walk,
        }
    }

    /// Tells whether it is all of what walks.
    pub(super) fn is_whole(&self) -> bool {
        self.of_walk == (0..self.solved.walked.clip.n_frames())
    }

    /// Returns what is seen with these edits, which differ from those that are solved for in their layers alone.
    pub(super) fn with(&self, edits: &Edits) -> Seen {
        let displaced = self.displaced(edits);
        let (base, walked) = (&self.solved.posed.base, &self.solved.walked);
        let original = &walked.path(&self.solved.original)[self.of_walk.clone()];
        let path = &self.path[..];
        let carried = |at: usize| {
            displaced.carrier(at, self.residuals.apply(at, &path[at]), || path[at].rotation(self.residuals.frame))
        };

        let is_leg = |joint: JointId| !self.solved.posed.is_free(joint);
        let legs =
            Arc::new(legs_posed(&self.clip, &displaced, &self.residuals, original, base.moves_otherwise(), is_leg));
        let own = |path: &[PathFrame]| own_carrier(&displaced, &self.residuals, path);
        let lifted = |mut carrier: Vec<Rigid>| {
            for (rigid, lift) in carrier.iter_mut().zip(&self.lifts) {
                rigid.translation.y += lift;
            }
            carrier
        };
        let prepared =
            feet::prepared(&legs, &own(original), &self.plants, self.solved.edits.plants.clean, Some(&self.plain))
                .on_ground(self.solved.posed.prepared.ground());
        let carrier = lifted((0..path.len()).map(carried).collect());
        let ground = self.solved.edits.plants.ground;
        let held = hold(&prepared, &Job { carrier: &carrier, own: &lifted(own(path)), path, original, ground });
        let is_held = |joint: JointId| held.turned.iter().any(|held| held.joint == joint);
        let laid: Vec<TurnedJoint> = displaced.turned.into_iter().filter(|turned| !is_held(turned.joint)).collect();
        let edited = EditedClip {
            carrier_world: held.carrier,
            turned: held.turned.into_iter().chain(laid).collect(),
            ..EditedClip::unedited(Arc::clone(&self.clip))
        };

        let mut seen = Seen { before_holding: Vec::new(), held: Vec::new(), walk: Arc::new(edited) };
        legs.world_rigids(self.frame, &mut seen.before_holding);
        seen.walk.world_rigids(self.frame, &mut seen.held);
        seen
    }

    /// Returns the clip as edits have it that differ in their layers alone, with its feet where they were but for the
    /// piece: there it differs by what the edits changed of what is seen of the piece.
    pub(super) fn shown(&self, was: &Seen, is: &Seen, edits: &Arc<Edits>) -> Solved {
        let solved = self.solved;
        let posed = solved.posed.relaid(solved, edits);
        let mut carried = (*solved.carried).clone();
        for joint in posed.prepared.legs().flat_map(|leg| [leg.hip, leg.knee, leg.ankle]) {
            if carried.turned(joint).is_none() {
                let rotations = (0..carried.n_frames()).map(|frame| solved.walk.rotation(frame, joint)).collect();
                carried.turned.push(TurnedJoint { joint, rotations });
            }
        }
        let first = self.begin + self.of_walk.start;
        for frame in 0..self.of_walk.len().min(carried.n_frames() - first) {
            let share = self.share(frame);
            let place = &mut carried.carrier_world[first + frame];
            let [from, to] = [was, is].map(|seen| seen.walk.carrier(frame));
            place.translation += share * (to.translation - from.translation);
            place.rotation = part_of(to.rotation * from.rotation.conjugate(), share) * place.rotation;
            for turned in &mut carried.turned {
                let [from, to] = [was, is].map(|seen| seen.walk.rotation(frame, turned.joint));
                let place = &mut turned.rotations[first + frame];
                *place *= part_of(from.conjugate() * to, share);
            }
        }
        let carried = Arc::new(carried);
        let walk = posed.laid_on(&carried);
        Solved {
            edited: solved.walked.as_edit_of(&solved.clip, &walk),
            edits: Arc::clone(edits),
            posed,
            carried,
            walk,
            extent: Extent::Poses,
            whole: Some(solved.whole.clone().unwrap_or_else(|| Arc::new(solved.clone()))),
            ..solved.clone()
        }
    }

    /// Returns how far a frame is shown as the piece has it, 0 to 1.
    fn share(&self, frame: usize) -> f64 {
        let n_walk = self.solved.walked.clip.n_frames();
        let fade = (FADE_SECS / self.clip.frame_time_secs).ceil();
        let from_start = if self.of_walk.start == 0 { fade } else { frame as f64 };
        let to_end = if self.of_walk.end == n_walk { fade } else { (self.of_walk.len() - 1 - frame) as f64 };
        let t = (from_start.min(to_end) / fade).min(1.0);
        t * t * (3.0 - 2.0 * t)
    }

    /// Lays the layers on the piece.
    fn displaced(&self, edits: &Edits) -> Displaced {
        let Solved { clip, posed, walked, .. } = self.solved;
        let base = &posed.base.joints;
        let stack = Stack { clip, base, layers: &edits.layers };
        let earlier = Stack { clip, base, layers: &self.solved.edits.layers };
        match &walked.joined {
            None => stack.displaced_again(&earlier, &posed.of_clip, self.of_walk.clone()),
            Some(joined) => {
                let sources = &joined.source_frames[self.of_walk.clone()];
                let first = *sources.iter().min().expect("a frame") as usize;
                let last = *sources.iter().max().expect("a frame") as usize;
                let of_clip = stack.displaced_again(&earlier, &posed.of_clip, first..last + 1);
                carried_over(&of_clip, clip, first, &self.clip, sources)
            }
        }
    }
}

/// Returns a rotation by a share of what another rotates by, the short way.
fn part_of(rotation: DQuat, share: f64) -> DQuat {
    if share == 1.0 { rotation } else { DQuat::IDENTITY.slerp(rotation, share) }
}

/// Returns a foot's plants as a range of frames has them.
fn plants_in(foot: &FootPlants, frames: &Range<usize>) -> FootPlants {
    let plants = foot.plants.iter().filter(|plant| plant.first < frames.end && frames.start <= plant.last);
    let cut = |plant: &Plant| Plant {
        first: plant.first.max(frames.start) - frames.start,
        last: plant.last.min(frames.end - 1) - frames.start,
        ..*plant
    };
    FootPlants { plants: plants.map(cut).collect(), ..foot.clone() }
}

#[cfg(test)]
mod tests {
    use glam::{DQuat, DVec3};

    use super::*;
    use crate::{
        displace::Layer,
        document::{open, solve},
        path::{Shape, ShapeKind, shape_points},
    };

    /// The built-in walk along a bent path, solved with some parameters and layers.
    fn solved(cycling: crate::path::Cycling, longer: f64, layers: Vec<Layer>) -> Solved {
        let opened = open(None).expect("the built-in clip");
        let mut edits = opened.edits;
        let plain = solve(&opened.source, &Arc::new(edits.clone()), None);
        let shape = Shape { kind: ShapeKind::Eight, size: 1.0 };
        let points = shape_points(shape, &plain.original, 16, 3);
        edits.path.points = points.len();
        let up = plain.clip.facts.up.value;
        edits.path.control_points = Some(points.into_iter().map(|p| up.to_file(longer * p)).collect());
        edits.timing.cycling = cycling;
        edits.layers = layers;
        solve(&opened.source, &Arc::new(edits), None)
    }

    /// A layer that bends knees, turns the hips and moves the carrier, at every frame.
    fn crouched() -> Layer {
        let mut layer = Layer::new("crouched");
        for (name, axis, angle) in [("LeftKnee", DVec3::X, 0.2), ("LeftHip", DVec3::X, -0.1), ("Hips", DVec3::Y, 0.1)] {
            layer.set_rotation(name, 40, DQuat::from_axis_angle(axis, angle));
            layer.set_rotation(name, 140, DQuat::from_axis_angle(axis, -angle));
        }
        layer.position.set(60, DVec3::new(1.0, -2.0, 0.5));
        layer
    }

    #[test]
    fn a_lifted_foot_tilts_no_ground() {
        let mut lifted = Layer::new("lifted");
        lifted.set_rotation("LeftKnee", 40, DQuat::from_rotation_x(1.2));
        let [was, is] = [Vec::new(), vec![lifted]].map(|layers| solved(crate::path::Cycling::Plain, 1.0, layers));
        let feet = |solved: &Solved| [0, 1].map(|leg| solved.posed.prepared.footprints(leg).next().expect("a print").y);
        let height = was.clip.facts.height.value;
        assert!((feet(&was)[0] - feet(&is)[0]).abs() > 0.05 * height, "{:?} {:?}", feet(&was), feet(&is));
        assert_eq!(was.posed.prepared.ground(), is.posed.prepared.ground());
    }

    #[test]
    fn what_an_edit_moves_on_a_piece_it_moves_in_the_clip() {
        use crate::path::Cycling::{Blended, Plain};
        for (cycling, longer) in [(Plain, 1.0), (Plain, 2.5), (Blended, 2.5)] {
            let before = solved(cycling, longer, Vec::new());
            let after = solved(cycling, longer, vec![crouched()]);
            let height = before.clip.facts.height.value;
            let n = before.edited.n_frames();
            for frame in [0, n / 5, n / 2, 4 * n / 5, n - 1] {
                let piece = Piece::around(&before, frame, AROUND_SECS[0]);
                let [was, is] = [&before, &after].map(|solved| {
                    let mut world = Vec::new();
                    solved.edited.world_rigids(frame, &mut world);
                    (piece.with(&solved.edits), world)
                });
                let mut moved = 0.0f64;
                for joint in 0..before.clip.skeleton.n_joints() {
                    let on_piece = is.0.held[joint].translation - was.0.held[joint].translation;
                    let in_clip = is.1[joint].translation - was.1[joint].translation;
                    moved = moved.max(in_clip.length());
                    let off = on_piece.distance(in_clip) / height;
                    assert!(
                        off < if frame == 0 { 2e-3 } else { 4e-4 },
                        "{cycling:?} {longer} frame {frame} joint {joint}: off by {off}"
                    );
                }
                assert!(moved > 0.01 * height, "the edit is seen at frame {frame}");
            }
        }
    }
}
