//! Scenes of literal numbers: no clip, no solver, no sine from the machine's mathematics library.

use std::sync::Arc;

use glam::DVec3;
use walkabout::motion::Side;
use walkabout::scene::{
    Body, Camera, Curve, Footprint, Ground, Label, Limb, Mark, Now, Object, Objects, Projection, Role, Scene, Still,
    Stroke, View,
};

/// A walking pose, metres, at the origin, facing +z; x is to the left.
const POSE: [[f64; 3]; 19] = [
    [0.0, 0.95, 0.0],
    [0.0, 1.10, 0.01],
    [0.0, 1.28, 0.02],
    [0.0, 1.47, 0.03],
    [0.0, 1.63, 0.06],
    [0.09, 0.92, 0.0],
    [0.10, 0.52, 0.12],
    [0.10, 0.09, 0.30],
    [0.11, 0.04, 0.45],
    [-0.09, 0.92, 0.0],
    [-0.10, 0.50, -0.06],
    [-0.10, 0.16, -0.38],
    [-0.11, 0.04, -0.25],
    [0.19, 1.42, 0.02],
    [0.24, 1.14, -0.11],
    [0.25, 0.91, -0.10],
    [-0.19, 1.42, 0.02],
    [-0.23, 1.15, 0.08],
    [-0.23, 0.98, 0.27],
];

/// Limbs of the pose: from, to, radius.
const LIMBS: [(u32, u32, f64); 19] = [
    (0, 1, 0.085),
    (1, 2, 0.09),
    (2, 3, 0.055),
    (3, 4, 0.095),
    (0, 5, 0.075),
    (0, 9, 0.075),
    (5, 6, 0.065),
    (6, 7, 0.05),
    (7, 8, 0.04),
    (9, 10, 0.065),
    (10, 11, 0.05),
    (11, 12, 0.04),
    (2, 13, 0.06),
    (2, 16, 0.06),
    (13, 14, 0.042),
    (14, 15, 0.035),
    (16, 17, 0.042),
    (17, 18, 0.035),
    (4, 4, 0.11),
];

/// The pose's points at a place, turned so that it faces (`sin`, `cos`).
fn actor(x: f64, z: f64, (sin, cos): (f64, f64)) -> Vec<DVec3> {
    POSE.iter().map(|&[px, py, pz]| DVec3::new(x + px * cos + pz * sin, py, z - px * sin + pz * cos)).collect()
}

fn body(role: Role) -> Body {
    Body {
        role,
        limbs: LIMBS.iter().map(|&(from, to, radius)| Limb { role, from, to, radius }).collect(),
        wireframe: false,
    }
}

fn at(x: f64, y: f64, z: f64) -> DVec3 {
    DVec3::new(x, y, z)
}

/// A curve over the ground: x and z are cubic in t from 0 to 1.
fn cubic(role: Role, stroke: Stroke, x: [f64; 4], z: [f64; 4]) -> Curve {
    let value = |c: [f64; 4], t: f64| c[0] + t * (c[1] + t * (c[2] + t * c[3]));
    let point = |i: u32| {
        let t = f64::from(i) / 64.0;
        at(value(x, t), 0.0, value(z, t))
    };
    Curve { role, stroke, points: (0..=64).map(point).collect() }
}

fn label(role: Role, text: &str, at: DVec3) -> Label {
    Label { role, at, text: text.to_owned() }
}

/// Cameras as the presets have them: three-quarter, front, side, top.
pub(crate) fn cameras() -> [View; 4] {
    let view = |title: &str, eye, target, up, projection| View {
        camera: Camera { eye, target, up, projection },
        title: title.to_owned(),
        shows: Objects::ALL,
        focused: false,
    };
    let perspective = Projection::Perspective { fov_y_rad: 0.7 };
    let parallel = Projection::Orthographic { height: 5.2 };
    let middle = at(0.0, 0.8, 2.6);
    [
        view("1 three-quarter", at(5.4, 2.7, 8.6), at(0.3, 0.65, 2.6), DVec3::Y, perspective),
        view("2 front", at(0.0, 0.8, 20.0), middle, DVec3::Y, parallel),
        view("3 side", at(20.0, 0.8, 2.6), middle, DVec3::Y, parallel),
        view("4 top", at(0.0, 20.0, 2.6), middle, DVec3::NEG_Z, Projection::Orthographic { height: 7.5 }),
    ]
}

/// The cameras' views, each with something left out, the second one in focus: the original actor with its path and
/// tracker, so without its shadow too; both actors and the texts; the ground; both actors, the points and a tracker.
pub(crate) fn different_views() -> [View; 4] {
    let mut views = cameras();
    let hidden: [&[Object]; 4] = [
        &[Object::OriginalSkeleton, Object::OriginalPath, Object::OriginalTracker],
        &[Object::OriginalSkeleton, Object::NewSkeleton, Object::Labels],
        &[Object::Ground],
        &[Object::OriginalSkeleton, Object::NewSkeleton, Object::ControlPoints, Object::NewTracker],
    ];
    for (view, hidden) in views.iter_mut().zip(hidden) {
        view.shows = hidden.iter().fold(Objects::ALL, |shows, object| shows.without(*object));
    }
    views[1].focused = true;
    views
}

/// Two actors, both paths, control points with their polygon, trackers, labels and ground.
pub(crate) fn full() -> Scene {
    let control = [at(0.0, 0.0, -0.6), at(-2.6, 0.0, 1.0), at(2.9, 0.35, 3.2), at(0.4, 0.0, 5.4)];
    let mark = |role, at, radius| Mark { role, at, radius };
    Scene {
        still: Arc::new(Still {
            revision: 1,
            body_height: 1.75,
            bodies: vec![body(Role::OriginalSkeleton), body(Role::NewSkeleton)],
            curves: vec![
                cubic(Role::OriginalPath, Stroke::Dashed, [0.0, 0.2, -0.1, 0.0], [-0.6, 6.0, 0.0, 0.0]),
                cubic(Role::NewPath, Stroke::Solid, [0.0, -7.8, 19.5, -11.3], [-0.6, 4.8, 1.8, -0.6]),
                Curve { role: Role::ControlPoint, stroke: Stroke::Solid, points: control.to_vec() },
            ],
            footprints: vec![],
            marks: vec![
                mark(Role::ControlPoint, control[0], 0.08),
                mark(Role::ControlPoint, control[1], 0.08),
                mark(Role::SelectedControlPoint, control[2], 0.09),
                mark(Role::ControlPoint, control[3], 0.08),
            ],
            labels: vec![
                label(Role::ControlPoint, "2", control[1] + DVec3::Y * 0.1),
                label(Role::SelectedControlPoint, "3 selected", control[2] + DVec3::Y * 0.1),
            ],
            ground: Some(Ground { height: 0.0, centre: at(0.0, 0.0, 2.4), half_extent: 14.0, cell: 0.5 }),
        }),
        now: Now {
            actors: vec![actor(0.064, 1.8, (0.0, 1.0)), actor(0.52, 4.41, (0.13, 0.9915))],
            marks: vec![
                mark(Role::OriginalTracker, at(0.064, 0.07, 1.8), 0.07),
                mark(Role::NewTracker, at(0.52, 0.07, 4.41), 0.07),
            ],
            labels: vec![
                label(Role::OriginalSkeleton, "original", at(0.064, 1.78, 1.8)),
                label(Role::NewSkeleton, "new", at(0.52, 1.78, 4.41)),
            ],
            views: vec![cameras()[0].clone()],
            caption: "frame 212 of 480 · 1.77 s · 1.00×".to_owned(),
        },
    }
}

/// Feet from near by: they stand on the ground and cast shadows that touch them.
pub(crate) fn feet() -> Scene {
    let mut scene = full();
    scene.now.views[0].title = "feet".to_owned();
    scene.now.views[0].camera = Camera {
        eye: at(2.1, 0.8, 5.6),
        target: at(0.6, 0.25, 4.3),
        up: DVec3::Y,
        projection: Projection::Perspective { fov_y_rad: 0.6 },
    };
    scene.now.caption = String::new();
    scene
}

/// An arm of the new actor selected from the chest to the wrist, from near by; keys move the elbow.
pub(crate) fn selected() -> Scene {
    let mut scene = full();
    let still = Arc::make_mut(&mut scene.still);
    still.revision = 5;
    // The joints that turn the arm's limbs: chest, shoulder, elbow.
    for limb in still.bodies[1].limbs.iter_mut().filter(|limb| [2, 13, 14].contains(&limb.from)) {
        limb.role = Role::SelectedJoint;
    }
    let points = &scene.now.actors[1];
    let mark = |(role, point, radius): (Role, usize, f64)| Mark { role, at: points[point], radius };
    scene.now.marks = [
        (Role::SelectedJoint, 2, 0.0735),
        (Role::SelectedJoint, 13, 0.0735),
        (Role::SelectedJoint, 15, 0.0735),
        (Role::ActiveJoint, 14, 0.0875),
    ]
    .map(mark)
    .to_vec();
    scene.now.labels.clear();
    scene.now.views[0] = View {
        camera: Camera {
            eye: at(2.9, 1.9, 7.2),
            target: at(0.55, 1.1, 4.4),
            up: DVec3::Y,
            projection: Projection::Perspective { fov_y_rad: 0.6 },
        },
        title: "selected".to_owned(),
        shows: Objects::ALL,
        focused: false,
    };
    scene.now.caption = String::new();
    scene
}

/// Footprints of both feet on the ground and on a step, from above and near by; the last one was missed.
pub(crate) fn footprints() -> Scene {
    let mut scene = feet();
    let print = |role, foot, at, heading_rad| Footprint { role, foot, at, heading_rad, normal: DVec3::Y, length: 0.27 };
    let still = Arc::make_mut(&mut scene.still);
    still.revision = 4;
    still.marks.clear();
    still.labels.clear();
    still.footprints = vec![
        print(Role::Footprint, Side::Left, at(0.75, 0.0, 3.9), 0.0),
        print(Role::Footprint, Side::Right, at(0.5, 0.0, 4.2), 0.3),
        print(Role::Footprint, Side::Left, at(0.95, 0.15, 4.4), 0.6),
        print(Role::MissedFootprint, Side::Right, at(0.9, 0.0, 4.8), 0.9),
    ];
    scene.now.actors.iter_mut().for_each(Vec::clear);
    scene.now.marks.clear();
    scene.now.labels.clear();
    scene.now.views[0].title = "footprints".to_owned();
    scene
}

/// Both bodies as edges, a limb without length among them, and a selected one.
pub(crate) fn wireframe() -> Scene {
    let mut scene = full();
    let still = Arc::make_mut(&mut scene.still);
    still.revision = 5;
    still.bodies.iter_mut().for_each(|body| body.wireframe = true);
    still.bodies[1].limbs[6].role = Role::SelectedJoint;
    scene.now.views[0].title = "wireframe".to_owned();
    scene
}

/// Trails of both hands with a mark where the hands are, and the normal skeleton at the new actor's place.
pub(crate) fn trails() -> Scene {
    let mut scene = full();
    let hands = [15, 18].map(|point| scene.now.actors[1][point]);
    let still = Arc::make_mut(&mut scene.still);
    still.revision = 6;
    for (hand, side) in hands.into_iter().zip([0.5, -0.5]) {
        // Swinging forward and back as it walks.
        let point = |i: i32| {
            let t = f64::from(i) / 16.0;
            hand + at(side * t * t * 0.4, 0.15 * (t - t.floor()) * (t.floor() + 1.0 - t), t * 1.1)
        };
        still.curves.push(Curve { role: Role::Trace, stroke: Stroke::Solid, points: (-32..=24).map(point).collect() });
        scene.now.marks.push(Mark { role: Role::Trace, at: hand, radius: 0.055 });
    }
    still.bodies.push(body(Role::NormalSkeleton));
    // All limbs straight, as far apart as their lengths say.
    let mut normal = actor(0.52, 4.41, (0.0, 1.0));
    for (parent, child, _) in LIMBS.iter().filter(|limb| (5..=12).contains(&limb.1) && limb.0 != 0) {
        let length = DVec3::from_array(POSE[*parent as usize]).distance(DVec3::from_array(POSE[*child as usize]));
        normal[*child as usize] = normal[*parent as usize] - DVec3::Y * length;
    }
    scene.now.actors.push(normal);
    scene.now.labels.push(label(Role::NormalSkeleton, "normal", at(0.52, 1.9, 4.41)));
    scene.now.views[0].title = "trails".to_owned();
    scene
}

/// Ribbons at their worst: a sharp zig-zag, a long dash behind the eye, points that coincide, one point alone.
pub(crate) fn ribbons() -> Scene {
    let curve = |role, stroke, points: Vec<DVec3>| Curve { role, stroke, points };
    let zigzag = (0..9).map(|i| at(f64::from(i) * 0.5 - 2.0, f64::from(i % 2) * 0.8 + 0.4, 0.0)).collect();
    Scene {
        still: Arc::new(Still {
            revision: 2,
            body_height: 1.75,
            bodies: vec![],
            curves: vec![
                curve(Role::NewPath, Stroke::Solid, zigzag),
                curve(Role::OriginalPath, Stroke::Dashed, vec![at(-0.5, 0.1, -30.0), at(0.3, 0.1, 30.0)]),
                curve(Role::Trace, Stroke::Solid, vec![at(1.0, 1.6, 0.0); 3]),
                curve(Role::Trace, Stroke::Solid, vec![at(1.5, 1.6, 0.0)]),
                curve(Role::Footprint, Stroke::Dashed, vec![at(-2.0, 1.7, 0.0), at(2.0, 1.7, 0.0)]),
            ],
            footprints: vec![],
            marks: vec![],
            labels: vec![],
            ground: None,
        }),
        now: Now {
            actors: vec![],
            marks: vec![],
            labels: vec![],
            views: vec![View {
                camera: Camera {
                    eye: at(0.4, 1.2, 5.0),
                    target: at(0.0, 0.8, 0.0),
                    up: DVec3::Y,
                    projection: Projection::Perspective { fov_y_rad: 0.6 },
                },
                title: String::new(),
                shows: Objects::ALL,
                focused: false,
            }],
            caption: String::new(),
        },
    }
}

/// Nothing to see: no bodies, no ground, no curves; only sky and a title.
pub(crate) fn nothing() -> Scene {
    let mut scene = ribbons();
    let still = Arc::make_mut(&mut scene.still);
    still.revision = 3;
    still.curves.clear();
    scene.now.views[0].title = "nothing".to_owned();
    scene
}
