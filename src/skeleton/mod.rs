//! The joint tree: names, parents and rest offsets; nothing that changes from frame to frame.
//!
//! Joints are stored parents first, so one forward pass over them is a walk from the root to the leaves. A file with
//! several ROOTs gives a forest. Points are what kinematics produces: one per joint, then one per end site, so that a
//! point index below [`Skeleton::n_joints`] is also a joint index.

mod mirror;

use glam::DVec3;

/// Index of a joint in its [`Skeleton`].
#[derive(Clone, Copy, Debug, PartialEq, Eq, Hash, PartialOrd, Ord)]
pub struct JointId(pub u32);

impl JointId {
    /// Returns the index for use with slices that run over joints.
    pub fn idx(self) -> usize {
        self.0 as usize
    }
}

/// One joint: its name, its parent and where it sits when nothing moves.
#[derive(Clone, Debug, PartialEq)]
pub struct Joint {
    /// Name as in the file; names need not be unique.
    pub name: String,
    /// Parent joint, always of a smaller index; none for a root.
    pub parent: Option<JointId>,
    /// Rest position in the parent's space, in the clip's length unit.
    pub offset: DVec3,
    /// Offset of the end site in this joint's space, if the joint has one.
    pub end_site: Option<DVec3>,
}

/// A joint tree, parents before children.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Skeleton {
    /// Invariant: each parent's index is smaller than its child's.
    joints: Vec<Joint>,
    /// Joint that carries end site `i`, in joint order.
    end_sites: Vec<JointId>,
}

impl Skeleton {
    /// Builds a skeleton from joints in parents-first order.
    ///
    /// # Panics
    ///
    /// When a parent does not come before its child.
    pub fn new(joints: Vec<Joint>) -> Self {
        let mut end_sites = Vec::new();
        for (idx, joint) in joints.iter().enumerate() {
            assert!(joint.parent.is_none_or(|p| p.idx() < idx), "parents come before children");
            if joint.end_site.is_some() {
                end_sites.push(JointId(idx as u32));
            }
        }
        Self { joints, end_sites }
    }

    /// Returns the number of joints, end sites not counted.
    pub fn n_joints(&self) -> usize {
        self.joints.len()
    }

    /// Returns the number of points: joints, then end sites.
    pub fn n_points(&self) -> usize {
        self.joints.len() + self.end_sites.len()
    }

    /// Returns all joints, parents first.
    pub fn joints(&self) -> &[Joint] {
        &self.joints
    }

    /// Returns the joint with this index.
    pub fn joint(&self, id: JointId) -> &Joint {
        &self.joints[id.idx()]
    }

    /// Returns the ids of all joints, parents first.
    pub fn ids(&self) -> impl DoubleEndedIterator<Item = JointId> + use<> {
        (0..self.joints.len() as u32).map(JointId)
    }

    /// Returns the joint that a point is, or whose end site it is; points are joints, then end sites.
    pub fn joint_of_point(&self, point: usize) -> JointId {
        match point.checked_sub(self.n_joints()) {
            None => JointId(point as u32),
            Some(site) => self.end_sites()[site],
        }
    }

    /// Returns the joints that carry an end site; the end site `i` of this list is point `n_joints() + i`.
    pub fn end_sites(&self) -> &[JointId] {
        &self.end_sites
    }

    /// Returns the point that `point` hangs on, none for a root.
    pub fn point_parent(&self, point: usize) -> Option<usize> {
        match point.checked_sub(self.joints.len()) {
            None => self.joints[point].parent.map(JointId::idx),
            Some(site) => Some(self.end_sites[site].idx()),
        }
    }

    /// Returns the first joint of this name.
    pub fn find(&self, name: &str) -> Option<JointId> {
        self.joints.iter().position(|j| j.name == name).map(|i| JointId(i as u32))
    }

    /// Returns the children of a joint.
    pub fn children(&self, id: JointId) -> impl Iterator<Item = JointId> + '_ {
        self.ids().filter(move |&c| self.joint(c).parent == Some(id))
    }

    /// Tells for every joint whether it is `top` or hangs below it.
    pub fn subtree(&self, top: JointId) -> Vec<bool> {
        let mut within = vec![false; self.joints.len()];
        within[top.idx()] = true;
        for idx in top.idx() + 1..self.joints.len() {
            within[idx] = self.joints[idx].parent.is_some_and(|p| within[p.idx()]);
        }
        within
    }

    /// Tells whether `id` is `ancestor` or hangs below it.
    pub fn is_within(&self, id: JointId, ancestor: JointId) -> bool {
        let mut at = Some(id);
        while let Some(j) = at {
            if j == ancestor {
                return true;
            }
            at = self.joint(j).parent;
        }
        false
    }
}
