//! What is taken off a planted foot: how far its contact point slides that should not.

use glam::DVec3;

use super::prepared::FootAt;
use crate::{contact::Plant, math::smootherstep};

/// Time before and after a clean plant over which the foot comes to rest and sets off, seconds.
const REST_SECS: f64 = 0.1;

/// How far the contact point, ankle or toe, whichever moves less in each step of the clip, has slid: world, horizontal, 0 in the
/// mean over the plant.
///
/// It goes on for a moment before and after the plant, ever less of it, so that the foot comes to rest and sets off
/// smoothly.
#[derive(Clone, Debug, Default)]
pub(super) struct Slide {
    /// Frame of the first value; before it that one holds, after the last one the last.
    first: usize,
    slid: Vec<DVec3>,
}

impl Slide {
    /// Adds up the steps of a plant; `step` is how far the foot slides from one frame to the next.
    pub(super) fn new(
        plant: &Plant,
        n_frames: usize,
        frame_time_secs: f64,
        step: impl Fn(usize, usize) -> DVec3,
    ) -> Self {
        let rest = (REST_SECS / frame_time_secs).ceil().max(1.0);
        let first = plant.first.saturating_sub(rest as usize);
        let last = (plant.last + rest as usize).min(n_frames - 1);
        let mut slid = vec![DVec3::ZERO];
        for to in first + 1..=last {
            // Outside the plant, what its first or last step was.
            let like = if plant.first < plant.last { to.clamp(plant.first + 1, plant.last) } else { to };
            let share = 1.0 - smootherstep(to.abs_diff(like) as f64 / rest);
            slid.push(slid[slid.len() - 1] + share * step(like - 1, like));
        }
        let stands = &slid[plant.first - first..=plant.last - first];
        let mean = stands.iter().sum::<DVec3>() / stands.len() as f64;
        slid.iter_mut().for_each(|s| *s -= mean);
        Self { first, slid }
    }

    /// Tells whether nothing slides.
    pub(super) fn is_none(&self) -> bool {
        self.slid.is_empty()
    }

    /// Returns how far it has slid at a frame, also outside the plant.
    pub(super) fn at(&self, frame: usize) -> DVec3 {
        self.slid.get(frame.saturating_sub(self.first)).or(self.slid.last()).copied().unwrap_or(DVec3::ZERO)
    }
}

/// The point a foot stands on in a step: ankle or toe, whichever moves less.
#[derive(Clone, Copy, Debug)]
pub(super) enum Contact {
    Ankle,
    Toe,
}

impl Contact {
    /// Finds it for a step.
    pub(super) fn of(from: &FootAt, to: &FootAt) -> Self {
        let moves = |contact: Self| contact.step(from, to).length_squared();
        if moves(Self::Toe) < moves(Self::Ankle) { Self::Toe } else { Self::Ankle }
    }

    /// Returns its horizontal step.
    pub(super) fn step(self, from: &FootAt, to: &FootAt) -> DVec3 {
        self.way(from, to).with_y(0.0)
    }

    /// Returns its step in space.
    pub(super) fn way(self, from: &FootAt, to: &FootAt) -> DVec3 {
        match self {
            Self::Ankle => to.ankle.translation - from.ankle.translation,
            Self::Toe => to.toe - from.toe,
        }
    }
}
