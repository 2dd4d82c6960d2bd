//! How the body is carried: what takes each frame's world in the source to where it goes.
//!
//! Feet in swing go with the body, wherever path and layers take it. Feet that stand take part in less of it where layers
//! move the carrier: they go along the ground with it, but neither sink nor rise, because the ground does not. So a body is
//! brought down to a crouch over feet that stay where they are.

use glam::DVec3;

use super::{Job, Prepared};
use crate::{math::Rigid, sync::listed};

/// Motions that differ by less, as a share of the body height and in half radians, are one: paths are walked no more
/// exactly.
const SAME: f64 = 1e-6;

/// What takes the source's world at each frame to where plain path editing and layers have it.
pub(super) struct Passage {
    /// The body.
    pub(super) body: Vec<Rigid>,
    /// Feet that stand; empty where layers do not move the carrier, and they go with the body.
    standing: Vec<Rigid>,
}

impl Passage {
    pub(super) fn new(prepared: &Prepared, job: &Job) -> Self {
        let body = |carrier: &Rigid, to_origin: &Rigid| *carrier * *to_origin;
        let of_body = listed(job.carrier.len(), |frames| {
            let pairs = job.carrier[frames.clone()].iter().zip(&prepared.to_origin[frames]);
            pairs.map(|(carrier, to_origin)| body(carrier, to_origin))
        });
        let stands = |(own, passage): (&Rigid, &Rigid), carrier: &Rigid| {
            let risen = (carrier.translation - own.translation) - along_ground(own, carrier);
            Rigid { translation: passage.translation - risen, ..*passage }
        };
        let standing = job.own.iter().zip(&of_body).zip(job.carrier);
        Self { standing: standing.map(|(own, carrier)| stands(own, carrier)).collect(), body: of_body }
    }

    /// Returns what takes a foot that stands at a frame.
    pub(super) fn standing(&self, frame: usize) -> &Rigid {
        self.standing.get(frame).unwrap_or(&self.body[frame])
    }

    /// Tells whether the whole clip moves as one rigid body: then no foot slides that did not.
    pub(super) fn moves_as_one(&self, height: f64) -> bool {
        let Some((first, others)) = self.body.split_first() else { return true };
        self.standing.is_empty()
            && others.iter().all(|by| {
                let turn = first.rotation.conjugate() * by.rotation;
                turn.xyz().length() < SAME && first.translation.distance(by.translation) < SAME * height
            })
    }
}

/// Returns how far along the ground layers move a carrier away from its own place.
pub(super) fn along_ground(own: &Rigid, carrier: &Rigid) -> DVec3 {
    (carrier.translation - own.translation).with_y(0.0)
}
