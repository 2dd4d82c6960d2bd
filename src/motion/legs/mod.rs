//! Which joints are legs: by name where names speak, by shape where they do not.
//!
//! Names say that a joint belongs to a leg, and to which one; topology says in what order its parts must hang on each
//! other; positions tell a hip from the helper joint above it. Where no leg is named, two mirrored chains that end
//! lowest are the legs, and the side follows from where the feet point. Joints may stand between the ones named here
//! (twist joints): a [`Leg`] lists where the leg bends.

mod names;
mod shape;

use serde::{Deserialize, Serialize};
use thiserror::Error;

use super::{Clip, Decided};
use crate::skeleton::{JointId, Skeleton};

/// A side of the body, its own left and right.
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Side {
    /// The body's left.
    Left,
    /// The body's right.
    Right,
}

/// A leg: the joints at which it bends, each below the one before it.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Leg {
    /// The body's own left or right.
    pub side: Side,
    /// Turns the thigh.
    pub hip: JointId,
    /// Turns the shin.
    pub knee: JointId,
    /// Turns the foot.
    pub ankle: JointId,
    /// Point of the skeleton ([`Skeleton::n_points`]) at the ball or tip of the foot: a joint or an end site below the
    /// ankle; the ankle itself where nothing hangs below it.
    pub toe: usize,
}

/// `clip.legs`: a leg as the user names it.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
#[serde(deny_unknown_fields)]
pub struct LegNames {
    /// The body's own left or right.
    pub side: Side,
    /// Name of the joint that turns the thigh.
    pub hip: String,
    /// Name of the joint that turns the shin.
    pub knee: String,
    /// Name of the joint that turns the foot.
    pub ankle: String,
    /// Name of the point at the ball or tip of the foot; without it, what hangs below the ankle. An end site is named
    /// as [`point_name`] does.
    #[serde(default, skip_serializing_if = "Option::is_none")]
    pub toe: Option<String>,
}

/// What is wrong with legs the user named.
#[derive(Clone, Debug, PartialEq, Eq, Error)]
pub enum LegNameError {
    /// No joint of this name.
    #[error("there is no joint {name:?} to be the {side} {part}")]
    Missing {
        /// Name that was given.
        name: String,
        /// `left` or `right`.
        side: &'static str,
        /// `hip`, `knee`, `ankle` or `toe`.
        part: &'static str,
    },
    /// The lower part does not hang on the upper one.
    #[error("{lower:?} does not hang below {upper:?}, so they are no parts of one leg")]
    NotBelow {
        /// The part nearer the body.
        upper: String,
        /// The part that should hang on it.
        lower: String,
    },
    /// Two parts at one place.
    #[error("{lower:?} is at the same place as {upper:?}, so nothing can turn between them")]
    NoLength {
        /// The part nearer the body.
        upper: String,
        /// The part at the same place.
        lower: String,
    },
    /// Two legs share a part.
    #[error("{name:?} is part of two legs")]
    Shared {
        /// The joint named twice.
        name: String,
    },
}

/// Finds the legs of a clip: as `asked` (`clip.legs`), else as guessed; left ones first.
///
/// An empty list comes with the reason why no leg was recognised. When the names asked for cannot be legs, a warning
/// says so and the legs are guessed.
pub fn find_legs(clip: &Clip, asked: &[LegNames], warnings: &mut Vec<String>) -> Decided<Vec<Leg>> {
    if !asked.is_empty() {
        match named_legs(&clip.skeleton, asked) {
            Ok(value) => return Decided { value, why: "as asked".to_owned() },
            Err(error) => warnings.push(format!("clip.legs: {error}; the legs are guessed")),
        }
    }
    let mut legs = names::legs(&clip.skeleton);
    let mut why = "by the joints' names".to_owned();
    if legs.is_empty() {
        legs = shape::legs(clip);
        why = if legs.is_empty() {
            "no leg is named, and no two mirrored chains reach from the body to the ground".to_owned()
        } else {
            "the two mirrored chains that end lowest; sides by where the feet point".to_owned()
        };
    }
    legs.sort_by_key(|leg| leg.side);
    Decided { value: legs, why }
}

/// Returns the name of a point for people: a joint's name, `NAME end site` for the end site of a joint.
pub fn point_name(skeleton: &Skeleton, point: usize) -> String {
    match point.checked_sub(skeleton.n_joints()) {
        None => skeleton.joints()[point].name.clone(),
        Some(site) => format!("{} end site", skeleton.joint(skeleton.end_sites()[site]).name),
    }
}

/// Looks up legs by name.
fn named_legs(skeleton: &Skeleton, asked: &[LegNames]) -> Result<Vec<Leg>, LegNameError> {
    let mut legs = Vec::new();
    for names in asked {
        legs.push(named_leg(skeleton, names)?);
    }
    let mut parts: Vec<JointId> = legs.iter().flat_map(|leg| [leg.hip, leg.knee, leg.ankle]).collect();
    parts.sort_unstable();
    if let Some(twice) = parts.windows(2).find(|pair| pair[0] == pair[1]) {
        return Err(LegNameError::Shared { name: skeleton.joint(twice[0]).name.clone() });
    }
    legs.sort_by_key(|leg| leg.side);
    Ok(legs)
}

fn named_leg(skeleton: &Skeleton, names: &LegNames) -> Result<Leg, LegNameError> {
    let side = names.side;
    let missing = |name: &str, part| LegNameError::Missing {
        name: name.to_owned(),
        side: match side {
            Side::Left => "left",
            Side::Right => "right",
        },
        part,
    };
    let joint = |name: &str, part| skeleton.find(name).ok_or_else(|| missing(name, part));
    let hip = joint(&names.hip, "hip")?;
    let knee = joint(&names.knee, "knee")?;
    let ankle = joint(&names.ankle, "ankle")?;
    let toe = match &names.toe {
        None => toe_below(skeleton, ankle),
        Some(name) => {
            let point = (0..skeleton.n_points()).find(|&p| point_name(skeleton, p) == *name);
            point.ok_or_else(|| missing(name, "toe"))?
        }
    };
    let places = rest_places(skeleton);
    for (upper, lower) in [(hip, knee), (knee, ankle)] {
        let name = |id: JointId| skeleton.joint(id).name.clone();
        if upper == lower || !skeleton.is_within(lower, upper) {
            return Err(LegNameError::NotBelow { upper: name(upper), lower: name(lower) });
        }
        if places[upper.idx()] == places[lower.idx()] {
            return Err(LegNameError::NoLength { upper: name(upper), lower: name(lower) });
        }
    }
    let carrier =
        if toe < skeleton.n_joints() { JointId(toe as u32) } else { skeleton.end_sites()[toe - skeleton.n_joints()] };
    if !skeleton.is_within(carrier, ankle) {
        return Err(LegNameError::NotBelow { upper: names.ankle.clone(), lower: point_name(skeleton, toe) });
    }
    Ok(Leg { side, hip, knee, ankle, toe })
}

/// Returns where all points are in the rest pose, each root at its OFFSET.
fn rest_places(skeleton: &Skeleton) -> Vec<glam::DVec3> {
    let mut places = Vec::with_capacity(skeleton.n_points());
    for joint in skeleton.joints() {
        let above = joint.parent.map_or(glam::DVec3::ZERO, |p| places[p.idx()]);
        places.push(above + joint.offset);
    }
    for &id in skeleton.end_sites() {
        let site = skeleton.joint(id).end_site.expect("end_sites lists joints that have one");
        places.push(places[id.idx()] + site);
    }
    places
}

/// Returns the point at the ball or tip of the foot: the joint below the ankle (of several the one called a toe, then
/// the middle one), else the ankle's end site, else the ankle itself. What has no length is passed over.
fn toe_below(skeleton: &Skeleton, ankle: JointId) -> usize {
    let below: Vec<JointId> =
        skeleton.children(ankle).filter(|&c| skeleton.joint(c).offset != glam::DVec3::ZERO).collect();
    let toes: Vec<JointId> = below.iter().copied().filter(|&c| names::is_toe(&skeleton.joint(c).name)).collect();
    let candidates = if toes.is_empty() { below } else { toes };
    let offset = |c: JointId| skeleton.joint(c).offset;
    let middle = candidates.iter().map(|&c| offset(c)).sum::<glam::DVec3>() / candidates.len().max(1) as f64;
    let nearest = (candidates.iter())
        .min_by(|&&a, &&b| offset(a).distance_squared(middle).total_cmp(&offset(b).distance_squared(middle)));
    if let Some(&toe) = nearest {
        return toe.idx();
    }
    let site = skeleton.end_sites().iter().position(|&id| id == ankle);
    match site {
        Some(site) if skeleton.joint(ankle).end_site != Some(glam::DVec3::ZERO) => skeleton.n_joints() + site,
        _ => match skeleton.children(ankle).next() {
            Some(helper) => match toe_below(skeleton, helper) {
                point if point == helper.idx() => ankle.idx(),
                point => point,
            },
            None => ankle.idx(),
        },
    }
}
