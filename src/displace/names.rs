//! Names of joints in maps. A file may give two joints one name: the second is `NAME#2`, and so on.

use crate::skeleton::{JointId, Skeleton};

/// Returns the name of a joint in maps: its own, or `NAME#2` for the second joint of that name.
pub fn joint_name(skeleton: &Skeleton, id: JointId) -> String {
    let name = &skeleton.joint(id).name;
    let count = skeleton.ids().take_while(|&other| other <= id).filter(|&o| skeleton.joint(o).name == *name).count();
    if count > 1 { format!("{name}#{count}") } else { name.clone() }
}

/// Returns the joint of this name in maps; a joint that really has the name goes before a count.
pub fn find_joint(skeleton: &Skeleton, name: &str) -> Option<JointId> {
    let counted = || {
        let (name, count) = name.rsplit_once('#')?;
        let nth = count.parse::<usize>().ok()?.checked_sub(1)?;
        skeleton.ids().filter(|&id| skeleton.joint(id).name == name).nth(nth)
    };
    skeleton.find(name).or_else(counted)
}

#[cfg(test)]
mod tests {
    use glam::DVec3;

    use super::*;
    use crate::skeleton::Joint;

    #[test]
    fn every_joint_has_a_name_of_its_own() {
        let joint = |(idx, name): (u32, &str)| Joint {
            name: name.to_owned(),
            parent: idx.checked_sub(1).map(JointId),
            offset: DVec3::Y,
            end_site: None,
        };
        let skeleton = Skeleton::new((0..).zip(["Hips", "Bone", "Bone", "a#1", "Bone"]).map(joint).collect());
        let names: Vec<_> = skeleton.ids().map(|id| joint_name(&skeleton, id)).collect();
        assert_eq!(names, ["Hips", "Bone", "Bone#2", "a#1", "Bone#3"]);
        for id in skeleton.ids() {
            assert_eq!(find_joint(&skeleton, &names[id.idx()]), Some(id));
        }
        for unknown in ["Hip", "Bone#4", "Bone#0", "#", ""] {
            assert_eq!(find_joint(&skeleton, unknown), None, "{unknown}");
        }
    }
}
