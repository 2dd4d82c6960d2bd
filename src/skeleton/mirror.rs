//! The joint on the other side of the body: by name where names tell sides, by its place in the tree where they do not.

use glam::DVec3;

use super::{JointId, Skeleton};

/// Words that tell a side, with their other side; letters only count where a word begins.
const SIDES: [(&str, &str); 4] = [("left", "right"), ("right", "left"), ("l", "r"), ("r", "l")];

/// Offsets mirror each other when they differ by at most this share of their length: people measured are not even.
const MIRRORED: f64 = 0.1;

impl Skeleton {
    /// Returns the joint on the other side of the body; none for a joint in the middle.
    ///
    /// Names win: `LeftArm` and `RightArm`, `arm.L` and `arm.R`, `Arm_l` and `Arm_r`, `lArm` and `rArm`, of joints of
    /// one name the first, the second and so on. Where no joint has such a name, the highest joint on the way from the
    /// root that has a sibling of mirrored shape leads the same way down on the other side.
    pub fn mirror(&self, id: JointId) -> Option<JointId> {
        self.mirror_by_name(id).or_else(|| self.mirror_by_place(id))
    }

    fn mirror_by_name(&self, id: JointId) -> Option<JointId> {
        let name = self.joint(id).name.as_str();
        let of_name = |wanted: &str| -> Vec<JointId> {
            let wanted = wanted.to_owned();
            self.ids().filter(|&other| self.joint(other).name == wanted).collect()
        };
        let ordinal = of_name(name).iter().position(|&other| other == id)?;
        other_names(name).find_map(|other| of_name(&other).get(ordinal).copied())
    }

    fn mirror_by_place(&self, id: JointId) -> Option<JointId> {
        let mut way: Vec<JointId> = std::iter::successors(Some(id), |&at| self.joint(at).parent).collect();
        way.reverse();
        way.iter().enumerate().find_map(|(depth, &top)| {
            let parent = self.joint(top).parent;
            let beside = self.ids().filter(|&other| other != top && self.joint(other).parent == parent);
            let mut other = beside.into_iter().find(|&other| self.is_mirrored(top, other))?;
            for pair in way[depth..].windows(2) {
                let nth = self.children(pair[0]).position(|child| child == pair[1])?;
                other = self.children(other).nth(nth)?;
            }
            Some(other)
        })
    }

    /// Tells whether two joints and all below them are each other's mirror image along one axis.
    fn is_mirrored(&self, a: JointId, b: JointId) -> bool {
        let (mut pairs, mut at) = (vec![(a, b)], 0);
        while let Some(&(a, b)) = pairs.get(at) {
            let (below_a, below_b): (Vec<_>, Vec<_>) = (self.children(a).collect(), self.children(b).collect());
            if below_a.len() != below_b.len() {
                return false;
            }
            pairs.extend(below_a.into_iter().zip(below_b));
            at += 1;
        }
        let offsets: Vec<_> = pairs.iter().map(|&(a, b)| (self.joint(a).offset, self.joint(b).offset)).collect();
        DVec3::AXES.into_iter().any(|axis| {
            let near = |a: DVec3, b: DVec3| a.distance(b) <= 0.5 * MIRRORED * (a.length() + b.length());
            let all = offsets.iter().all(|&(a, b)| near(a, b - 2.0 * b.dot(axis) * axis));
            // What has no width is mirrored by anything.
            all && offsets.iter().any(|&(a, b)| !near(a, b))
        })
    }
}

/// Returns the names a joint's other side may have, the likeliest first.
fn other_names(name: &str) -> impl Iterator<Item = String> + '_ {
    let lower = name.to_ascii_lowercase();
    SIDES.into_iter().flat_map(move |(word, other)| {
        let places: Vec<usize> = lower.match_indices(word).map(|(at, _)| at).collect();
        let places = places.into_iter().filter(move |&at| word.len() > 1 || begins_word(name, at));
        places.map(move |at| {
            let end = at + word.len();
            format!("{}{}{}", &name[..at], in_case_of(&name[at..end], other), &name[end..])
        })
    })
}

/// Tells whether a letter begins a word of a name.
fn begins_word(name: &str, at: usize) -> bool {
    let is_large = name[at..].starts_with(char::is_uppercase);
    let before = name[..at].chars().next_back();
    before.is_none_or(|c| !c.is_alphabetic() || (c.is_lowercase() && is_large))
}

/// Writes a word in small letters as another is written: `RIGHT` as `LEFT`, `Right` as `Left`.
fn in_case_of(model: &str, word: &str) -> String {
    let is_large = |c: char| c.is_ascii_uppercase();
    if model.chars().all(is_large) {
        return word.to_ascii_uppercase();
    }
    let (first, rest) = word.split_at(1);
    if model.starts_with(is_large) { format!("{}{rest}", first.to_ascii_uppercase()) } else { word.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::skeleton::Joint;

    /// Builds a skeleton from lines of depth, name and offset along x.
    fn skeleton(lines: &[(usize, &str, f64)]) -> Skeleton {
        let mut chain: Vec<JointId> = Vec::new();
        let mut joints = Vec::new();
        for &(depth, name, x) in lines {
            chain.truncate(depth);
            let parent = chain.last().copied();
            chain.push(JointId(joints.len() as u32));
            joints.push(Joint { name: name.to_owned(), parent, offset: DVec3::new(x, 1.0, 0.1), end_site: None });
        }
        Skeleton::new(joints)
    }

    fn mirror<'a>(skeleton: &'a Skeleton, name: &str) -> Option<&'a str> {
        let id = skeleton.find(name).expect("a joint of the sample");
        let other = skeleton.mirror(id)?;
        assert_eq!(skeleton.mirror(other), Some(id), "{name}: and back");
        Some(&skeleton.joint(other).name)
    }

    #[test]
    fn names_in_every_style_have_their_other_side() {
        for (left, right) in [
            ("LeftArm", "RightArm"),
            ("leftarm", "rightarm"),
            ("LEFT_ARM", "RIGHT_ARM"),
            ("Arm_Left", "Arm_Right"),
            ("mixamorig:LeftUpLeg", "mixamorig:RightUpLeg"),
            ("Left arm", "Right arm"),
            ("arm.L", "arm.R"),
            ("DEF-thigh.L.001", "DEF-thigh.R.001"),
            ("Collar_L", "Collar_R"),
            ("thigh_l", "thigh_r"),
            ("L_Hip", "R_Hip"),
            ("LHipJoint", "RHipJoint"),
            ("lShldr", "rShldr"),
            ("lshldr", "rshldr"),
            ("Bip01 L Thigh", "Bip01 R Thigh"),
            ("J_Bip_L_UpperLeg", "J_Bip_R_UpperLeg"),
            ("EyeL", "EyeR"),
        ] {
            // Lengths that do not mirror leave only the names.
            let skeleton = skeleton(&[(0, "Hips", 0.0), (1, left, 1.0), (1, right, -3.0)]);
            assert_eq!((mirror(&skeleton, left), mirror(&skeleton, "Hips")), (Some(right), None));
        }
    }

    #[test]
    fn letters_inside_of_words_tell_no_side() {
        let skeleton =
            skeleton(&[(0, "Hips", 0.0), (1, "tail1", 0.0), (1, "tair1", 0.5), (1, "belly", 2.0), (1, "berry", 0.0)]);
        for joint in ["tail1", "belly"] {
            assert_eq!(mirror(&skeleton, joint), None, "{joint}");
        }
    }

    #[test]
    fn joints_of_one_name_go_by_their_count() {
        let lines = [
            (0, "Hips", 0.0),
            (1, "LeftBone", 1.0),
            (1, "RightBone", 7.0),
            (2, "LeftBone", 1.0),
            (2, "RightBone", 3.0),
        ];
        let skeleton = skeleton(&lines);
        assert_eq!(skeleton.mirror(JointId(1)), Some(JointId(2)));
        assert_eq!(skeleton.mirror(JointId(3)), Some(JointId(4)));
    }

    #[test]
    fn without_names_the_mirrored_place_in_the_tree_is_the_other_side() {
        let skeleton = skeleton(&[
            (0, "a", 0.0),
            (1, "b", 0.0),
            (2, "c", 2.0),
            (3, "d", 2.0),
            // Two fingers, which are each other's mirror image too.
            (4, "e", 0.5),
            (4, "f", -0.5),
            (2, "g", -2.1),
            (3, "h", -2.0),
            (4, "i", -0.5),
            (4, "j", 0.5),
            (2, "k", 0.0),
        ]);
        for (left, right) in [("c", "g"), ("d", "h"), ("e", "i"), ("f", "j")] {
            assert_eq!(mirror(&skeleton, left), Some(right));
        }
        for middle in ["a", "b", "k"] {
            assert_eq!(mirror(&skeleton, middle), None);
        }
    }
}
