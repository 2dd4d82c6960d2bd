//! The pointer in a preview: which point of the body is under it, and where a drag takes it.
//!
//! A preview knows pixels and cameras, so what comes here are rays. How near is near is measured in shares of the
//! height of the view, whose pixels nobody here knows.

use std::sync::Arc;

use glam::DVec3;

use super::{
    Editor, Message,
    joints::{self, Handle},
    pose,
};
use crate::{
    document::{Change, Solved},
    scene::{Camera, Object, Projection, Ray, Role, Scene, View},
    skeleton::JointId,
};

/// A point is under the pointer within this share of the window's height: 14 pixels of 720.
const NEAR: f64 = 0.02;

/// Points this near to each other are at one place in the view, and the one before the other is taken.
const SAME: f64 = 0.004;

/// The pointer may move by this share of the view's height and still make a click.
const STILL: f64 = 0.006;

/// A place that was taken in a view.
#[derive(Clone, Copy, Debug, PartialEq)]
struct Hold {
    /// The place, world.
    at: DVec3,
    /// Where the ray that took it meets the plane through it that faces the camera.
    met: DVec3,
    camera: Camera,
}

/// The point that the pointer holds.
#[derive(Clone, Debug)]
pub(super) struct Grab {
    /// The joint that the point is, or whose end site it is.
    joint: JointId,
    /// The point of the skeleton.
    point: usize,
    /// Where it was when it was taken.
    hold: Hold,
    /// What was seen then, and at which edited frame: each step of a drag begins there.
    from: Arc<Solved>,
    frame_idx: usize,
    /// Whether the pointer has moved more than a click does.
    is_drag: bool,
    /// Whether the drag has made a step of undo, which the rest of it joins.
    made_step: bool,
}

impl Hold {
    /// Takes a place by a ray; none where the ray does not come to it.
    fn new(at: DVec3, camera: Camera, ray: &Ray) -> Option<Self> {
        Some(Self { at, met: meet(&camera, at, ray)?, camera })
    }

    /// Returns where a ray takes the place: along with the pointer in the plane that faces the camera. None where the
    /// ray does not meet the plane.
    fn target(&self, ray: &Ray) -> Option<DVec3> {
        Some(self.at + meet(&self.camera, self.at, ray)? - self.met)
    }

    /// Tells whether a target is farther than a click goes.
    fn is_away(&self, target: DVec3) -> bool {
        target.distance(self.at) > STILL * view_height(&self.camera, self.at)
    }
}

impl Editor {
    /// Acts on the pointer pressed in a preview that shows a scene: takes the point of the body that is under it.
    pub fn press(&mut self, scene: &Scene, ray: &Ray) {
        self.grab = self.under(scene, ray);
    }

    /// Acts on the pointer moved with its button down: a selected joint follows it.
    pub fn drag(&mut self, ray: &Ray) {
        let Some(mut grab) = self.grab.take() else { return };
        if let Some(target) = grab.hold.target(ray)
            && (grab.is_drag || grab.hold.is_away(target))
        {
            grab.is_drag = true;
            self.drag_to(&mut grab, target);
        }
        self.grab = Some(grab);
    }

    /// Acts on the pointer's button released: a click on a joint toggles the chain from it to the root.
    pub fn release(&mut self) {
        let Some(grab) = self.grab.take() else { return };
        self.end_step();
        if !grab.is_drag {
            self.view.message = None;
            joints::activate(self, Handle::Joint(grab.joint));
            joints::toggle_chain_from(self, grab.joint);
        }
    }

    fn drag_to(&mut self, grab: &mut Grab, target: DVec3) {
        let handle = Handle::Joint(grab.joint);
        let is_carrier = grab.joint == grab.from.clip.facts.carrier.value;
        let joints = &self.view.joints;
        let is_selected = joints.is_selected(handle) || (is_carrier && joints.is_selected(Handle::Position));
        if !is_selected {
            let name = joints::name(&grab.from.clip, handle);
            self.say(Message::note(format!("{name} is not selected: click on it first")));
            return;
        }
        joints::activate(self, handle);
        self.view.playing = false;
        self.view.jump(grab.frame_idx);
        let change = pose::wanted(self, grab.point, target);
        let change = Change::Pose { layer_idx: self.view.layer_idx, frame_idx: grab.frame_idx, change };
        let is_made = self.change_from(&grab.from, &change, grab.made_step);
        grab.made_step |= is_made;
        if is_made {
            let clip = &self.document.solved().clip;
            let name = joints::name(clip, handle);
            let name = if grab.point < clip.skeleton.n_joints() { name } else { format!("the end of {name}") };
            let (point, frame_idx) = (grab.point, grab.frame_idx);
            let depth = self.document.depth();
            pose::tell_short(self, pose::Wanted { name, point, frame_idx, to: target, depth });
        }
    }

    /// Returns what the pointer takes at a ray; none where no point of the body is near.
    fn under(&self, scene: &Scene, ray: &Ray) -> Option<Grab> {
        let &View { camera, shows, .. } = scene.now.views.get(ray.view as usize)?;
        if !shows.contains(Object::NewSkeleton) {
            return None;
        }
        let body = scene.still.bodies.iter().position(|body| body.role == Role::NewSkeleton)?;
        let points = scene.now.actors.get(body)?;
        let clip = &self.document.solved().clip;
        let moves = clip.skeleton.subtree(clip.facts.carrier.value);
        let joint_of = |point: usize| clip.skeleton.joint_of_point(point);
        let drawn = points.iter().enumerate().filter(|&(point, _)| moves[joint_of(point).idx()]);
        // Of four views each has half the window's height.
        let near = if scene.now.views.len() > 2 { 2.0 * NEAR } else { NEAR };
        let point = nearest(drawn.map(|(point, &at)| (point, at)), &camera, ray, near)?;
        Some(Grab {
            joint: joint_of(point),
            point,
            hold: Hold::new(points[point], camera, ray)?,
            from: Arc::clone(self.document.solved()),
            frame_idx: self.view.frame_idx,
            is_drag: false,
            made_step: false,
        })
    }
}

/// Returns which of these points a ray goes through, `near` as a share of the view's height: the nearest in the view, of those at one place there the
/// one nearest to the eye, of those at one place in the world the last.
fn nearest(points: impl Iterator<Item = (usize, DVec3)>, camera: &Camera, ray: &Ray, near: f64) -> Option<usize> {
    let mut found: Option<(f64, f64, usize)> = None;
    for (point, at) in points {
        let way = at - ray.origin;
        let depth = way.dot(ray.direction);
        let off = way.reject_from_normalized(ray.direction).length() / view_height(camera, at);
        // Where sight is parallel the eye is no place: what is behind it is seen too.
        let is_seen = depth > 0.0 || matches!(camera.projection, Projection::Orthographic { .. });
        let place = (off / SAME).floor();
        if is_seen && off <= near && found.is_none_or(|(p, d, _)| place < p || (place == p && depth <= d)) {
            found = Some((place, depth, point));
        }
    }
    found.map(|(.., point)| point)
}

/// Returns how much of the world a view shows from bottom to top, as far away as a point is.
fn view_height(camera: &Camera, at: DVec3) -> f64 {
    match camera.projection {
        Projection::Perspective { fov_y_rad } => {
            2.0 * (at - camera.eye).dot(forward(camera)).abs() * (0.5 * fov_y_rad).tan()
        }
        Projection::Orthographic { height } => height,
    }
}

/// Returns where a ray meets the plane through a point that faces the camera; none where it does not.
fn meet(camera: &Camera, at: DVec3, ray: &Ray) -> Option<DVec3> {
    let normal = forward(camera);
    let along = (at - ray.origin).dot(normal) / ray.direction.dot(normal);
    let met = ray.origin + along * ray.direction;
    let is_before = along > 0.0 || matches!(camera.projection, Projection::Orthographic { .. });
    (is_before && met.is_finite()).then_some(met)
}

fn forward(camera: &Camera) -> DVec3 {
    (camera.target - camera.eye).normalize_or(DVec3::NEG_Z)
}

#[cfg(test)]
mod tests {
    use super::*;

    const BOTH: [Projection; 2] =
        [Projection::Perspective { fov_y_rad: 0.8 }, Projection::Orthographic { height: 4.0 }];

    fn camera(projection: Projection) -> Camera {
        Camera { eye: DVec3::new(3.0, 2.0, 5.0), target: DVec3::new(0.5, 1.0, 0.0), up: DVec3::Y, projection }
    }

    /// A ray of a camera towards a point.
    fn ray(camera: &Camera, to: DVec3) -> Ray {
        let (origin, direction) = match camera.projection {
            Projection::Perspective { .. } => (camera.eye, (to - camera.eye).normalize()),
            Projection::Orthographic { .. } => (to - 7.0 * forward(camera), forward(camera)),
        };
        Ray { view: 0, origin, direction }
    }

    fn found(points: &[DVec3], camera: &Camera, to: DVec3) -> Option<usize> {
        nearest(points.iter().copied().enumerate(), camera, &ray(camera, to), NEAR)
    }

    #[test]
    fn the_nearest_point_within_reach_is_taken() {
        for camera in BOTH.map(camera) {
            let right = forward(&camera).cross(DVec3::Y).normalize();
            let at = DVec3::new(0.4, 1.2, 0.3);
            let height = view_height(&camera, at);
            let points = [at, at + 0.03 * height * right];
            let aside = |share: f64| at + share * height * right;
            assert_eq!(found(&points, &camera, at), Some(0));
            assert_eq!(found(&points, &camera, aside(0.008)), Some(0));
            assert_eq!(found(&points, &camera, aside(0.022)), Some(1));
            assert_eq!(found(&points, &camera, aside(0.049)), Some(1));
            assert_eq!(found(&points, &camera, aside(0.052)), None);
            assert_eq!(found(&points, &camera, aside(-0.022)), None);
            assert_eq!(found(&[], &camera, at), None);
        }
    }

    #[test]
    fn of_points_behind_one_another_the_first_is_taken_and_of_joints_at_one_place_the_lowest() {
        for camera in BOTH.map(camera) {
            let at = DVec3::new(0.4, 1.2, 0.3);
            let sight = ray(&camera, at).direction;
            let points = [at + sight, at - sight, at - sight, at + 2.0 * sight];
            assert_eq!(found(&points, &camera, at), Some(2));
        }
    }

    #[test]
    fn what_is_behind_the_eye_is_not_taken_in_perspective() {
        let camera = camera(BOTH[0]);
        let behind = camera.eye - 2.0 * forward(&camera);
        assert_eq!(found(&[behind], &camera, camera.target), None);
    }

    #[test]
    fn a_drag_keeps_the_point_under_the_pointer_in_the_plane_that_faces_the_camera() {
        for camera in BOTH.map(camera) {
            let at = DVec3::new(0.4, 1.2, 0.3);
            let up = forward(&camera).cross(DVec3::Y).cross(forward(&camera)).normalize();
            let hold = Hold::new(at, camera, &ray(&camera, at + 0.01 * up)).expect("the place is before the eye");
            let target = |to: DVec3| hold.target(&ray(&camera, to)).expect("the plane is before the eye");
            assert!(target(at + 0.01 * up).abs_diff_eq(at, 1e-12), "nothing jumps at the press");
            let moved = target(at + 0.51 * up);
            assert!(moved.abs_diff_eq(at + 0.5 * up, 1e-12), "{moved}");
            assert!((moved - at).dot(forward(&camera)).abs() < 1e-12);
            assert!(hold.is_away(moved) && !hold.is_away(target(at + 0.012 * up)));
        }
    }

    #[test]
    fn a_ray_along_the_plane_leads_nowhere() {
        let camera = camera(BOTH[0]);
        let across = Ray { view: 0, origin: camera.eye, direction: forward(&camera).any_orthonormal_vector() };
        assert_eq!(meet(&camera, DVec3::ZERO, &across), None);
    }
}
