//! A scene of the size people work on: two 31-joint actors on a path with eight control points, seen from four sides.

use std::sync::Arc;

use glam::DVec3;
use walkabout::scene::{
    Body, Camera, Curve, Ground, Label, Limb, Mark, Now, Object, Objects, Projection, Role, Scene, Still, Stroke, View,
};

/// Joints of each actor.
pub(crate) const JOINTS: u32 = 31;

/// Makes the part that stays, under a revision.
pub(crate) fn still(revision: u64) -> Still {
    let limbs = |role| (1..JOINTS).map(|to| Limb { role, from: to - 1, to, radius: 0.04 }).collect();
    let path = (0..200).map(|i| DVec3::new(f64::from(i) * 0.05, 0.0, (f64::from(i) * 0.1).sin())).collect::<Vec<_>>();
    let points = (0..8).map(|i| DVec3::new(f64::from(i), 0.0, 0.3));
    Still {
        revision,
        body_height: 1.7,
        bodies: [Role::OriginalSkeleton, Role::NewSkeleton]
            .map(|role| Body { role, limbs: limbs(role), wireframe: false })
            .to_vec(),
        curves: vec![
            Curve { role: Role::OriginalPath, stroke: Stroke::Dashed, points: path.clone() },
            Curve { role: Role::NewPath, stroke: Stroke::Solid, points: path },
        ],
        footprints: vec![],
        marks: points.clone().map(|at| Mark { role: Role::ControlPoint, at, radius: 0.05 }).collect(),
        labels: points.map(|at| Label { role: Role::ControlPoint, at, text: "3".to_owned() }).collect(),
        ground: Some(Ground { height: 0.0, centre: DVec3::ZERO, half_extent: 20.0, cell: 1.0 }),
    }
}

/// Makes the part that moves, for a frame.
pub(crate) fn now(frame: u32) -> Now {
    let step = f64::from(frame) * 0.02;
    let actor = (0..JOINTS).map(|j| DVec3::new(step, f64::from(j) * 0.05, 0.1 * (step + f64::from(j)).cos()));
    let camera = |eye| Camera {
        eye,
        target: DVec3::new(step, 0.9, 0.0),
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y_rad: 0.7 },
    };
    let eyes = [DVec3::new(4.0, 3.0, 5.0), DVec3::new(step, 1.0, 6.0), DVec3::new(9.0, 1.0, 0.0)];
    let mut views: Vec<_> = eyes
        .iter()
        .zip(["1 three-quarter", "2 front", "3 side"])
        .map(|(&eye, title)| view(camera(eye), title))
        .collect();
    let top = Projection::Orthographic { height: 12.0 };
    let above = Camera { up: DVec3::NEG_Z, projection: top, ..camera(DVec3::new(step, 30.0, 0.0)) };
    views.push(view(above, "4 top"));
    Now {
        actors: vec![actor.clone().collect(), actor.map(|p| p + DVec3::Z).collect()],
        marks: vec![
            Mark { role: Role::OriginalTracker, at: DVec3::new(step, 0.0, 0.0), radius: 0.1 },
            Mark { role: Role::NewTracker, at: DVec3::new(step, 0.0, 1.0), radius: 0.1 },
        ],
        labels: vec![],
        views,
        caption: format!("frame {frame} of 1000 · {:.2} s · playing", step),
    }
}

/// Makes a whole scene.
pub(crate) fn scene(revision: u64, frame: u32) -> Scene {
    Scene { still: Arc::new(still(revision)), now: now(frame) }
}

fn view(camera: Camera, title: &str) -> View {
    let hidden = if title == "3 side" { Object::Traces } else { Object::Labels };
    View { camera, title: title.to_owned(), shows: Objects::ALL.without(hidden), focused: title == "2 front" }
}
