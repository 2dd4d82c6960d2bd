//! Which joints are legs: by name where names speak, by shape where they do not.
//!
//! Names say that a joint belongs to a leg, and to which one; topology says in what order its parts must hang on each
//! other; positions tell a hip from the helper joint above it. Where no leg is named, two mirrored chains that hang
//! from the pelvis and end lowest are the legs, and the side follows from where the feet point; where one is, the chain
//! that mirrors it is the other. Joints may stand between the ones named here (twist joints): a [`Leg`] lists where the
//! leg bends.

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

impl Side {
    /// Returns `left` or `right`.
    pub fn name(self) -> &'static str {
        match self {
            Self::Left => "left",
            Self::Right => "right",
        }
    }
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
    let mut why = "by the joints' names";
    match legs[..] {
        [] => {
            legs = shape::legs(clip);
            why = if legs.is_empty() {
                "no leg is named, and no two mirrored chains reach from the pelvis to the ground"
            } else {
                "the two mirrored chains that end lowest; sides by where the feet point"
            };
        }
        [named] => {
            let other = shape::other_side(clip, &named);
            why = match other {
                Some(_) => "one by the joints' names, the other is the chain that mirrors it",
                None => "by the joints' names; no chain mirrors it",
            };
            legs.extend(other);
        }
        _ => {}
    }
    legs.sort_by_key(|leg| leg.side);
    Decided { value: legs, why: why.to_owned() }
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

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::{bvh::Bvh, motion::ClipOptions, skeleton::Joint};

    /// Builds a skeleton from lines of depth, name and offset; a line `end` is an end site.
    fn skeleton(lines: &[(usize, &str, [f64; 3])]) -> Skeleton {
        let mut joints: Vec<Joint> = Vec::new();
        let mut chain: Vec<JointId> = Vec::new();
        for &(depth, name, offset) in lines {
            let offset = DVec3::from_array(offset);
            chain.truncate(depth);
            if name == "end" {
                joints[chain[depth - 1].idx()].end_site = Some(offset);
                continue;
            }
            let parent = chain.last().copied();
            chain.push(JointId(joints.len() as u32));
            joints.push(Joint { name: name.to_owned(), parent, offset, end_site: None });
        }
        Skeleton::new(joints)
    }

    /// Offsets of hip, knee, ankle, toe and tip on the left.
    const LEG: [[f64; 3]; 5] =
        [[1.0, 0.0, 0.0], [0.0, -4.0, 0.1], [0.0, -4.0, -0.2], [0.0, -0.6, 1.2], [0.0, 0.0, 0.5]];

    /// A body with legs named in a style: names of hip, knee, ankle and toe, left then right; no toe where it is empty.
    fn body(left: [&'static str; 4], right: [&'static str; 4]) -> Skeleton {
        let mut lines = vec![
            (0, "Hips", [0.0, 9.0, 0.0]),
            (1, "Spine", [0.0, 2.0, 0.0]),
            (2, "LeftArm", [1.5, 2.0, 0.0]),
            (3, "LeftForeArm", [3.0, 0.0, 0.0]),
            (4, "LeftHand", [3.0, 0.0, 0.0]),
            (5, "end", [1.0, 0.0, 0.0]),
        ];
        for (names, sign) in [(right, -1.0), (left, 1.0)] {
            let mirrored = LEG.map(|[x, y, z]| [sign * x, y, z]);
            let names: Vec<&str> = names.into_iter().filter(|name| !name.is_empty()).chain(["end"]).collect();
            lines.extend((1..).zip(names).zip(mirrored).map(|((depth, name), offset)| (depth, name, offset)));
        }
        skeleton(&lines)
    }

    fn leg_names(skeleton: &Skeleton, leg: &Leg) -> [String; 4] {
        [leg.hip.idx(), leg.knee.idx(), leg.ankle.idx(), leg.toe].map(|point| point_name(skeleton, point))
    }

    #[test]
    fn legs_are_recognised_in_every_style_of_names() {
        type Names = [&'static str; 4];
        let styles: &[(&str, Names, Names)] = &[
            (
                "CMU",
                ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"],
                ["RightUpLeg", "RightLeg", "RightFoot", "RightToeBase"],
            ),
            (
                "LAFAN1",
                ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToe"],
                ["RightUpLeg", "RightLeg", "RightFoot", "RightToe"],
            ),
            (
                "Mixamo",
                ["mixamorig:LeftUpLeg", "mixamorig:LeftLeg", "mixamorig:LeftFoot", "mixamorig:LeftToeBase"],
                ["mixamorig:RightUpLeg", "mixamorig:RightLeg", "mixamorig:RightFoot", "mixamorig:RightToeBase"],
            ),
            (
                "Axis Neuron with a prefix",
                ["Robot_LeftUpLeg", "Robot_LeftLeg", "Robot_LeftFoot", ""],
                ["Robot_RightUpLeg", "Robot_RightLeg", "Robot_RightFoot", ""],
            ),
            (
                "Bandai",
                ["UpperLeg_L", "LowerLeg_L", "Foot_L", "Toes_L"],
                ["UpperLeg_R", "LowerLeg_R", "Foot_R", "Toes_R"],
            ),
            ("Blender", ["thigh.L", "shin.L", "foot.L", "toe.L"], ["thigh.R", "shin.R", "foot.R", "toe.R"]),
            (
                "Rigify",
                ["DEF-thigh.L.001", "DEF-shin.L", "DEF-foot.L", "DEF-toe.L"],
                ["DEF-thigh.R.001", "DEF-shin.R", "DEF-foot.R", "DEF-toe.R"],
            ),
            (
                "ours",
                ["LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"],
                ["RightHip", "RightKnee", "RightAnkle", "RightToe"],
            ),
            (
                "Biped",
                ["Bip01 L Thigh", "Bip01 L Calf", "Bip01 L Foot", "Bip01 L Toe0"],
                ["Bip01 R Thigh", "Bip01 R Calf", "Bip01 R Foot", "Bip01 R Toe0"],
            ),
            ("Poser", ["lThigh", "lShin", "lFoot", "lToe"], ["rThigh", "rShin", "rFoot", "rToe"]),
            ("Unreal", ["thigh_l", "calf_l", "foot_l", "ball_l"], ["thigh_r", "calf_r", "foot_r", "ball_r"]),
            (
                "VRM",
                ["J_Bip_L_UpperLeg", "J_Bip_L_LowerLeg", "J_Bip_L_Foot", "J_Bip_L_ToeBase"],
                ["J_Bip_R_UpperLeg", "J_Bip_R_LowerLeg", "J_Bip_R_Foot", "J_Bip_R_ToeBase"],
            ),
            ("SMPL", ["L_Hip", "L_Knee", "L_Ankle", "L_Foot"], ["R_Hip", "R_Knee", "R_Ankle", "R_Foot"]),
            ("MakeHuman", ["UpLeg_L", "LoLeg_L", "Foot_L", "Toe_L"], ["UpLeg_R", "LoLeg_R", "Foot_R", "Toe_R"]),
            (
                "VRChat",
                ["Left leg", "Left knee", "Left ankle", "Left toe"],
                ["Right leg", "Right knee", "Right ankle", "Right toe"],
            ),
            (
                "without capitals",
                ["leftupleg", "leftleg", "leftfoot", "lefttoe"],
                ["rightupleg", "rightleg", "rightfoot", "righttoe"],
            ),
            ("letters only", ["lhip", "lknee", "lfoot", "ltoe"], ["rhip", "rknee", "rfoot", "rtoe"]),
        ];
        for &(style, left, right) in styles {
            let body = body(left, right);
            let legs = names::legs(&body);
            assert_eq!(legs.iter().map(|leg| leg.side).collect::<Vec<_>>(), [Side::Left, Side::Right], "{style}");
            for (leg, mut names) in legs.iter().zip([left.map(str::to_owned), right.map(str::to_owned)]) {
                if names[3].is_empty() {
                    names[3] = format!("{} end site", names[2]);
                }
                assert_eq!(leg_names(&body, leg), names, "{style}");
            }
        }
    }

    #[test]
    fn helper_and_twist_joints_are_passed_over() {
        let zero = [0.0; 3];
        let check = |lines: &[(usize, &str, [f64; 3])], wanted: [&str; 4]| {
            let skeleton = skeleton(lines);
            let legs = names::legs(&skeleton);
            assert_eq!(legs.len(), 1, "{lines:?}");
            assert_eq!(leg_names(&skeleton, &legs[0]), wanted);
        };
        let [hip, knee, ankle, toe, tip] = LEG;
        check(
            &[
                (0, "Hips", zero),
                (1, "LHipJoint", zero),
                (2, "LeftHip", hip),
                (3, "LeftKnee", knee),
                (4, "LeftAnkle", ankle),
                (5, "LeftToe", toe),
                (6, "end", tip),
            ],
            ["LeftHip", "LeftKnee", "LeftAnkle", "LeftToe"],
        );
        let middle = [0.0, -0.8, 0.0];
        check(
            &[
                (0, "Root", zero),
                (1, "__UpLeg_L", middle),
                (2, "UpLeg_L", hip),
                (3, "LoLeg_L", knee),
                (4, "Foot_L", ankle),
                (5, "end", toe),
            ],
            ["UpLeg_L", "LoLeg_L", "Foot_L", "Foot_L end site"],
        );
        let half = |v: [f64; 3]| v.map(|v| 0.5 * v);
        check(
            &[
                (0, "root", zero),
                (1, "pelvis.L", [0.5, 0.0, 0.0]),
                (2, "upperleg01.L", hip),
                (3, "upperleg02.L", half(knee)),
                (4, "lowerleg01.L", half(knee)),
                (5, "lowerleg02.L", half(ankle)),
                (6, "foot.L", half(ankle)),
                (7, "toe1-1.L", [-0.3, -0.6, 1.2]),
                (7, "toe3-1.L", [0.0, -0.6, 1.2]),
                (7, "toe5-1.L", [0.3, -0.6, 1.2]),
                (7, "heel.L", [0.0, -0.6, -0.5]),
            ],
            ["upperleg01.L", "lowerleg01.L", "foot.L", "toe3-1.L"],
        );
        check(
            &[
                (0, "Hips", zero),
                (1, "LeftUpLeg", hip),
                (2, "LeftLeg", knee),
                (3, "LeftFoot", ankle),
                (4, "LeftFootHelper", zero),
                (5, "end", toe),
            ],
            ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftFootHelper end site"],
        );
        check(
            &[(0, "Hips", zero), (1, "LeftUpLeg", hip), (2, "LeftLeg", knee), (3, "LeftFoot", ankle), (4, "end", zero)],
            ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftFoot"],
        );
    }

    #[test]
    fn names_that_are_not_legs_are_not_taken() {
        let zero = [0.0; 3];
        let arms =
            skeleton(&[(0, "Bigfoot_Hips", zero), (1, "Bigfoot_LeftArm", LEG[0]), (2, "Bigfoot_LeftHand", LEG[1])]);
        assert_eq!(names::legs(&arms), []);
        let target =
            skeleton(&[(0, "Root", zero), (1, "foot_ik.L", LEG[0]), (1, "thigh.L", LEG[0]), (2, "shin.L", LEG[1])]);
        assert_eq!(names::legs(&target), []);
    }

    /// One frame of a skeleton that stands as it rests, its root at the origin.
    fn standing(skeleton: &Skeleton) -> Clip {
        fn write(skeleton: &Skeleton, id: JointId, text: &mut String) {
            let joint = skeleton.joint(id);
            let (keyword, DVec3 { x, y, z }) = (if joint.parent.is_some() { "JOINT" } else { "ROOT" }, joint.offset);
            let name = &joint.name;
            *text += &format!("{keyword} {name}\n{{\nOFFSET {x} {y} {z}\nCHANNELS 3 Zrotation Xrotation Yrotation\n");
            for child in skeleton.children(id) {
                write(skeleton, child, text);
            }
            if let Some(DVec3 { x, y, z }) = joint.end_site {
                *text += &format!("End Site\n{{\nOFFSET {x} {y} {z}\n}}\n");
            }
            *text += "}\n";
        }
        let mut text = "HIERARCHY\n".to_owned();
        write(skeleton, JointId(0), &mut text);
        text += "MOTION\nFrames: 1\nFrame Time: 0.01\n";
        text += &"0 ".repeat(3 * skeleton.n_joints());
        let bvh = Bvh::parse(text.into_bytes(), "made up").expect("a file");
        Clip::from_bvh(&bvh, &ClipOptions::default())
    }

    #[test]
    fn without_names_shape_tells_legs_and_sides() {
        let named = body(["a", "b", "c", "d"], ["e", "f", "g", "h"]);
        let clip = standing(&named);
        let found = find_legs(&clip, &[], &mut Vec::new());
        let names: Vec<_> = found.value.iter().map(|leg| (leg.side, leg_names(&named, leg))).collect();
        let wanted = |names: [&str; 4]| names.map(str::to_owned);
        assert_eq!(
            names,
            [(Side::Left, wanted(["a", "b", "c", "d"])), (Side::Right, wanted(["e", "f", "g", "h"]))],
            "{}",
            found.why
        );
    }

    /// A trunk with arms that hang, longer below the neck than above it; its joints are named `names`, then `arm`.
    fn torso(names: [&'static str; 3], arm: [&'static str; 3]) -> Vec<(usize, &'static str, [f64; 3])> {
        let mut lines = vec![(0, names[0], [0.0; 3]), (1, names[1], [0.0, 2.5, 0.0]), (2, names[2], [0.0, 2.5, 0.1])];
        for sign in [1.0, -1.0] {
            lines.extend([
                (3, arm[0], [1.5 * sign, -0.2, 0.0]),
                (4, arm[1], [0.1 * sign, -3.0, 0.0]),
                (5, arm[2], [0.1 * sign, -2.5, 0.0]),
                (6, "end", [0.0, -0.8, 0.1]),
            ]);
        }
        lines.extend([(3, "top", [0.0, 0.8, 0.0]), (4, "end", [0.0, 1.5, 0.0])]);
        lines
    }

    #[test]
    fn arms_are_no_legs_even_where_legs_are_missing() {
        let none = |lines: &[(usize, &str, [f64; 3])]| {
            let found = find_legs(&standing(&skeleton(lines)), &[], &mut Vec::new());
            assert_eq!(found.value, [], "{lines:?}");
        };
        // By where they part.
        none(&torso(["a", "b", "c"], ["d", "e", "f"]));
        // By name, though the carrier is beside them.
        for arm in [["UpperArm", "LowerArm", "Hand"], ["腕", "ひじ", "手首"], ["x", "y", "LHand"]] {
            none(
                &torso(["a", "b", "c"], arm)
                    .split_off(2)
                    .into_iter()
                    .map(|(d, n, o)| (d - 2, n, o))
                    .collect::<Vec<_>>(),
            );
        }
        // Chains of that shape that part at the carrier are legs, in a skeleton that is called an armature too.
        let legs = torso(["a", "b", "c"], ["Armature_1", "Armature_2", "Armature_3"]).split_off(2);
        let legs = skeleton(&legs.into_iter().map(|(depth, name, o)| (depth - 2, name, o)).collect::<Vec<_>>());
        assert_eq!(find_legs(&standing(&legs), &[], &mut Vec::new()).value.len(), 2);
    }

    #[test]
    fn a_carrier_on_the_floor_has_the_pelvis_above_it() {
        let body = body(["a", "b", "c", "d"], ["e", "f", "g", "h"]);
        let mut joints = vec![Joint { name: "ground".to_owned(), parent: None, offset: DVec3::ZERO, end_site: None }];
        joints.extend(body.joints().iter().map(|joint| Joint {
            parent: Some(joint.parent.map_or(JointId(0), |p| JointId(p.0 + 1))),
            ..joint.clone()
        }));
        let clip = standing(&Skeleton::new(joints));
        assert_eq!(clip.facts.carrier.value, JointId(0));
        assert_eq!(find_legs(&clip, &[], &mut Vec::new()).value.len(), 2);
    }

    #[test]
    fn a_leg_without_a_name_is_the_one_that_mirrors_the_named_leg() {
        let named = ["LeftUpLeg", "LeftLeg", "LeftFoot", "LeftToeBase"];
        for (other, has_toe) in [(["x", "y", "z", "t"], true), (["x", "y", "z", ""], false)] {
            let body = body(named, other);
            let found = find_legs(&standing(&body), &[], &mut Vec::new());
            assert_eq!(found.value.iter().map(|leg| leg.side).collect::<Vec<_>>(), [Side::Left, Side::Right]);
            assert_eq!(leg_names(&body, &found.value[0]), named);
            let toe = if has_toe { "t" } else { "z end site" };
            assert_eq!(leg_names(&body, &found.value[1]), ["x", "y", "z", toe]);
        }
        let one = find_legs(&standing(&body(named, [""; 4])), &[], &mut Vec::new());
        assert_eq!((one.value.len(), one.value[0].side), (1, Side::Left), "{}", one.why);
    }

    #[test]
    fn a_clip_without_legs_says_so() {
        let snake = skeleton(&[
            (0, "head", [0.0; 3]),
            (1, "neck", [0.0, 0.0, 1.0]),
            (2, "tail", [0.0, 0.0, 3.0]),
            (3, "end", [0.0, 0.0, 1.0]),
        ]);
        let found = find_legs(&standing(&snake), &[], &mut Vec::new());
        assert_eq!(found.value, []);
        assert!(found.why.contains("no leg is named"), "{}", found.why);
    }

    fn asked(names: [&str; 4]) -> LegNames {
        let [hip, knee, ankle, toe] = names.map(str::to_owned);
        LegNames { side: Side::Left, hip, knee, ankle, toe: (!toe.is_empty()).then_some(toe) }
    }

    #[test]
    fn asked_legs_are_taken_or_refused_with_words() {
        let clip = standing(&body(["a", "b", "c", "d"], ["e", "f", "g", "h"]));
        let find = |asked: &[LegNames]| {
            let mut warnings = Vec::new();
            let found = find_legs(&clip, asked, &mut warnings);
            (found, warnings.join("\n"))
        };
        for (toe, wanted) in [("", "h"), ("h", "h"), ("h end site", "h end site"), ("g", "g")] {
            let (found, warnings) = find(&[asked(["e", "f", "g", toe])]);
            assert_eq!(found.why, "as asked", "{warnings}");
            assert_eq!((found.value.len(), found.value[0].side), (1, Side::Left));
            assert_eq!(point_name(&clip.skeleton, found.value[0].toe), wanted);
        }
        let refused: [(&[LegNames], &str); 5] = [
            (&[asked(["x", "f", "g", ""])], "there is no joint \"x\" to be the left hip"),
            (&[asked(["e", "f", "g", "y"])], "there is no joint \"y\" to be the left toe"),
            (&[asked(["e", "b", "c", ""])], "\"b\" does not hang below \"e\""),
            (&[asked(["e", "f", "g", "d"])], "\"d\" does not hang below \"g\""),
            (&[asked(["e", "f", "g", ""]), asked(["e", "f", "g", ""])], "\"e\" is part of two legs"),
        ];
        for (names, words) in refused {
            let (found, warnings) = find(names);
            assert!(warnings.contains(words), "{warnings}");
            assert_eq!(found.value.len(), 2, "guessed instead");
        }
    }
}
