//! Legs by the names of joints, in the styles that motion capture and animation programs write.
//!
//! `mixamorig:LeftUpLeg`, `thigh.L`, `UpperLeg_L`, `Bip01 L Thigh`, `lThigh`, `l_hip`, `LHipJoint`: a name is cut into
//! words; one of them is the side, the others tell the part. The same word names different parts in different styles
//! (`LeftLeg` is the shin, or the thigh where there is a `LeftKnee`), so parts are chosen together, along one chain.

use super::{Leg, Side, rest_places, toe_below};
use crate::skeleton::{JointId, Skeleton};

/// What a name may stand for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Part {
    Toe,
    Thigh,
    Knee,
    Ankle,
    Foot,
    Hip,
    Leg,
}

/// Words and their parts, the first that fits wins: `upleg` is looked for before `leg`.
const WORDS: &[(&str, Part)] = &[
    ("toe", Part::Toe),
    ("ball", Part::Toe),
    ("thigh", Part::Thigh),
    ("upleg", Part::Thigh),
    ("upperleg", Part::Thigh),
    ("legupper", Part::Thigh),
    ("femur", Part::Thigh),
    ("knee", Part::Knee),
    ("shin", Part::Knee),
    ("calf", Part::Knee),
    ("lowerleg", Part::Knee),
    ("leglower", Part::Knee),
    ("lowleg", Part::Knee),
    ("loleg", Part::Knee),
    ("tibia", Part::Knee),
    ("ankle", Part::Ankle),
    ("foot", Part::Foot),
    ("hip", Part::Hip),
    ("leg", Part::Leg),
];

/// Words in names of joints that are no part of a leg, though they come in pairs and may hang low.
const ARM_WORDS: [&str; 13] =
    ["arm", "hand", "shoulder", "shldr", "elbow", "wrist", "finger", "thumb", "clavicle", "collar", "腕", "手", "肩"];

/// Tells whether a joint has the name of a part of an arm.
pub(super) fn is_arm(name: &str) -> bool {
    // Exporters name whole skeletons `Armature`.
    let text = words(name).concat().replace("armature", "");
    ARM_WORDS.iter().any(|word| text.contains(word))
}

/// Tells whether a joint is called a toe.
pub(super) fn is_toe(name: &str) -> bool {
    part(&words(name).concat()) == Some(Part::Toe)
}

/// Returns the legs that are named, at most one a side.
pub(super) fn legs(skeleton: &Skeleton) -> Vec<Leg> {
    let parts: Vec<Option<(Side, Part)>> = skeleton.joints().iter().map(|j| side_and_part(&j.name)).collect();
    [Side::Left, Side::Right].into_iter().filter_map(|side| leg(skeleton, &parts, side)).collect()
}

/// Finds one side's leg: the first foot with a knee and a hip of the same side above it.
fn leg(skeleton: &Skeleton, parts: &[Option<(Side, Part)>], side: Side) -> Option<Leg> {
    let of_side = |part: Part| move |id: &JointId| parts[id.idx()] == Some((side, part));
    let feet = skeleton.ids().filter(of_side(Part::Ankle)).chain(skeleton.ids().filter(of_side(Part::Foot)));
    for ankle in feet {
        // From the body down to the foot.
        let mut above: Vec<JointId> =
            std::iter::successors(skeleton.joint(ankle).parent, |&id| skeleton.joint(id).parent)
                .filter(|id| parts[id.idx()].is_some_and(|(s, _)| s == side))
                .collect();
        above.reverse();
        if let Some((hip, knee)) = hip_and_knee(skeleton, parts, &above, ankle) {
            return Some(Leg { side, hip, knee, ankle, toe: toe_below(skeleton, ankle) });
        }
    }
    None
}

/// Chooses hip and knee among the side's joints `above` the ankle, body first.
fn hip_and_knee(
    skeleton: &Skeleton,
    parts: &[Option<(Side, Part)>],
    above: &[JointId],
    ankle: JointId,
) -> Option<(JointId, JointId)> {
    let places = rest_places(skeleton);
    let called = |id: &JointId, part: Part| parts[id.idx()].is_some_and(|(_, p)| p == part);
    let all = |part: Part| -> Vec<JointId> { above.iter().copied().filter(|id| called(id, part)).collect() };
    let hips_among = |candidates: Vec<JointId>, knee: JointId| -> Option<JointId> {
        let shin = places[knee.idx()].distance(places[ankle.idx()]);
        let thigh = |id: JointId| places[id.idx()].distance(places[knee.idx()]);
        // A helper above the hip makes the thigh too long; joints at one place: the lowest turns what hangs below.
        let unlikely = |id: JointId| (thigh(id) / shin).ln().abs();
        let is_helper = |id: JointId| skeleton.joint(id).offset == glam::DVec3::ZERO;
        let proper: Vec<JointId> = candidates.iter().copied().filter(|&id| !is_helper(id)).collect();
        (if proper.is_empty() { candidates } else { proper })
            .into_iter()
            .filter(|&id| id != knee && skeleton.is_within(knee, id) && unlikely(id).is_finite())
            .min_by(|&a, &b| unlikely(a).total_cmp(&unlikely(b)))
    };
    let legs = all(Part::Leg);
    let knees = all(Part::Knee);
    if let Some(&knee) = knees.first() {
        let hip = [Part::Thigh, Part::Hip, Part::Leg].into_iter().find_map(|part| hips_among(all(part), knee));
        return hip.map(|hip| (hip, knee));
    }
    for part in [Part::Thigh, Part::Hip] {
        let knee = legs.iter().find(|&&leg| all(part).iter().any(|&hip| hip != leg && skeleton.is_within(leg, hip)));
        if let Some(&knee) = knee
            && let Some(hip) = hips_among(all(part), knee)
        {
            return Some((hip, knee));
        }
    }
    match legs[..] {
        [hip, knee, ..] => hips_among(vec![hip], knee).map(|hip| (hip, knee)),
        _ => None,
    }
}

/// Returns the part a side's joint stands for; none for joints without side or of other parts.
fn side_and_part(name: &str) -> Option<(Side, Part)> {
    let mut words = words(name);
    let side = take_side(&mut words)?;
    Some((side, part(&words.concat())?))
}

fn part(text: &str) -> Option<Part> {
    WORDS.iter().find(|(word, _)| text.contains(word)).map(|&(_, part)| part)
}

/// Cuts a name into lower-case words at separators, changes of case and digits; a namespace before `:` is left out.
fn words(name: &str) -> Vec<String> {
    let name = name.rsplit(':').next().unwrap_or_default();
    let chars: Vec<char> = name.chars().collect();
    let mut words = vec![String::new()];
    for (at, &c) in chars.iter().enumerate() {
        let last = at.checked_sub(1).map(|before| chars[before]);
        let next_is_lower = chars.get(at + 1).is_some_and(|n| n.is_lowercase());
        let starts = match last {
            Some(last) if c.is_uppercase() => last.is_lowercase() || (last.is_uppercase() && next_is_lower),
            _ => false,
        };
        if starts || !c.is_alphabetic() {
            words.push(String::new());
        }
        if c.is_alphabetic() {
            words.last_mut().expect("never empty").extend(c.to_lowercase());
        }
    }
    words.retain(|word| !word.is_empty());
    words
}

/// Takes the word that tells the side out of a name's words.
fn take_side(words: &mut Vec<String>) -> Option<Side> {
    const SPELLED: [(&str, Side); 2] = [("left", Side::Left), ("right", Side::Right)];
    const SHORT: [(&str, Side); 2] = [("l", Side::Left), ("r", Side::Right)];
    for (spelled, side) in SPELLED.into_iter().chain(SHORT) {
        if let Some(at) = words.iter().position(|word| word == spelled) {
            words.remove(at);
            return Some(side);
        }
    }
    for word in words.iter_mut() {
        for (spelled, side) in SPELLED.into_iter().chain(SHORT) {
            // `leftfoot`, `footright`; a single letter only before a whole part's name, as in `lfoot`.
            let rest = word.strip_prefix(spelled).or_else(|| word.strip_suffix(spelled).filter(|_| spelled.len() > 1));
            let telling =
                |rest: &&str| WORDS.iter().any(|(w, _)| if spelled.len() > 1 { rest.contains(w) } else { rest == w });
            if let Some(rest) = rest.filter(telling) {
                *word = rest.to_owned();
                return Some(side);
            }
        }
    }
    None
}
