//! What must hold of a scene or an event that came from outside before anyone draws it or acts on it.

use std::f64::consts::PI;

use glam::DVec3;

use crate::{
    key::{Code, Key},
    scene::{
        Camera, FromPreview, Ground, Label, MAX_VIEWS, MAX_WHEEL_STEPS, Mark, Now, Picture, Projection, Ray, Still,
    },
};

/// The largest picture a preview may be asked for or send: width and height in pixels, DCI 4K wide and UHD high.
pub const MAX_PICTURE: [u32; 2] = [4096, 2160];

/// The most grid lines across the ground in one direction, so that a tiny cell cannot keep a preview busy for ever.
pub const MAX_GRID_LINES: f64 = 10_000.0;

/// The largest coordinate that can be drawn: its square is far enough below f32's largest (3e38) for a matrix's sums.
const LARGEST: f64 = 1e15;

/// The smallest length that can be divided by: its square is far above f32's smallest (1e-38).
const SMALLEST: f64 = 1e-15;

/// The smallest angle that leaves digits over f32's rounding (6e-8): of a field of view, which must also be this far
/// from a half turn, and between a camera's up and its line of sight.
const SMALLEST_ANGLE_RAD: f64 = 1e-6;

/// What is wrong with a scene or an event.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Fault {
    /// A number is not finite, too large to draw, or not of the sign it must have.
    #[error("{part} {index} holds a number that cannot be drawn")]
    Number {
        /// What holds it, in words.
        part: &'static str,
        /// Which one of its list, from 0.
        index: usize,
    },
    /// The bodies and their points do not pair up.
    #[error("{bodies} bodies but points for {actors}")]
    Actors {
        /// Bodies of the still part.
        bodies: usize,
        /// Point lists of the moving part.
        actors: usize,
    },
    /// A limb names a point that its actor does not have.
    #[error("body {body} has a limb at point {point}, but only {points} points")]
    Limb {
        /// Which body, from 0.
        body: usize,
        /// The point named.
        point: u32,
        /// Points there are.
        points: usize,
    },
    /// There is no view, or there are too many.
    #[error("{0} views, from 1 to {MAX_VIEWS} can be shown")]
    Views(usize),
    /// A camera looks nowhere: its eye is its target, or its up is along its line of sight.
    #[error("the camera of view {0} looks nowhere")]
    Camera(usize),
    /// A view shows objects that there are not.
    #[error("view {0} shows objects that there are not")]
    Objects(usize),
    /// The ground's grid is finer than can be drawn.
    #[error("the ground's grid has more than {MAX_GRID_LINES} lines")]
    Grid,
    /// A picture has no pixels or too many.
    #[error("a picture of {width}×{height} pixels, from 1×1 to {}×{} can be shown", MAX_PICTURE[0], MAX_PICTURE[1])]
    Size {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
    },
    /// A picture's bytes are not those of its size.
    #[error("a picture of {width}×{height} pixels in {bytes} bytes")]
    Pixels {
        /// Width in pixels.
        width: u32,
        /// Height in pixels.
        height: u32,
        /// Bytes there are.
        bytes: usize,
    },
    /// A key that no keyboard has.
    #[error("a key that no keyboard has")]
    Key,
    /// A ray that is not one.
    #[error("a pointer's ray that leads nowhere")]
    Ray,
    /// A wheel over no view, or turned by nothing or without end.
    #[error("a pointer's wheel turned over no view or without end")]
    Wheel,
}

/// Checks a still part by itself.
pub(super) fn check_still(still: &Still) -> Result<(), Fault> {
    number("the body height", 0, is_length(still.body_height))?;
    for (index, body) in still.bodies.iter().enumerate() {
        number("the limbs of body", index, body.limbs.iter().all(|limb| is_radius(limb.radius)))?;
    }
    for (index, curve) in still.curves.iter().enumerate() {
        number("curve", index, curve.points.iter().all(|&p| is_point(p)))?;
    }
    for (index, print) in still.footprints.iter().enumerate() {
        let stands = print.heading_rad.is_finite() && print.normal.is_normalized();
        let good = is_point(print.at) && stands && is_length(print.length);
        number("footprint", index, good)?;
    }
    check_marks("still mark", &still.marks)?;
    check_labels("still label", &still.labels)?;
    still.ground.as_ref().map_or(Ok(()), check_ground)
}

/// Checks a moving part against the still part it goes with, which is good by itself.
pub(super) fn check_now(still: &Still, now: &Now) -> Result<(), Fault> {
    if now.actors.len() != still.bodies.len() {
        return Err(Fault::Actors { bodies: still.bodies.len(), actors: now.actors.len() });
    }
    for (body, (points, limbs)) in now.actors.iter().zip(still.bodies.iter().map(|b| &b.limbs)).enumerate() {
        number("the points of body", body, points.iter().all(|&p| is_point(p)))?;
        let mut ends = limbs.iter().flat_map(|limb| [limb.from, limb.to]);
        if !points.is_empty()
            && let Some(point) = ends.find(|&point| point as usize >= points.len())
        {
            return Err(Fault::Limb { body, point, points: points.len() });
        }
    }
    check_marks("mark", &now.marks)?;
    check_labels("label", &now.labels)?;
    if !(1..=MAX_VIEWS).contains(&now.views.len()) {
        return Err(Fault::Views(now.views.len()));
    }
    now.views.iter().enumerate().try_for_each(|(index, view)| {
        check_camera(index, &view.camera)?;
        if view.shows.has_unknown() { Err(Fault::Objects(index)) } else { Ok(()) }
    })
}

/// Checks the size of the pictures wanted.
pub(super) fn check_size(width: u32, height: u32) -> Result<(), Fault> {
    let fits = |length: u32, most: u32| (1..=most).contains(&length);
    if fits(width, MAX_PICTURE[0]) && fits(height, MAX_PICTURE[1]) {
        Ok(())
    } else {
        Err(Fault::Size { width, height })
    }
}

/// Checks a picture's size against the bytes there are.
pub(super) fn check_picture(width: u32, height: u32, bytes: usize) -> Result<(), Fault> {
    check_size(width, height)?;
    if bytes == width as usize * height as usize * 3 { Ok(()) } else { Err(Fault::Pixels { width, height, bytes }) }
}

/// Checks an event. Texts may hold anything; making them fit to show is not checking.
pub(super) fn check_event(event: &FromPreview) -> Result<(), Fault> {
    match event {
        FromPreview::Key(key) if !is_key(*key) => Err(Fault::Key),
        FromPreview::Pick(ray) | FromPreview::Drag(ray) if !is_ray(ray) => Err(Fault::Ray),
        &FromPreview::Wheel { view, steps } if view as usize >= MAX_VIEWS || !is_turn(steps) => Err(Fault::Wheel),
        FromPreview::Frame(Picture { width, height, rgb }) => check_picture(*width, *height, rgb.len()),
        _ => Ok(()),
    }
}

fn check_marks(part: &'static str, marks: &[Mark]) -> Result<(), Fault> {
    let mut marks = marks.iter().enumerate();
    marks.try_for_each(|(index, mark)| number(part, index, is_point(mark.at) && is_radius(mark.radius)))
}

fn check_labels(part: &'static str, labels: &[Label]) -> Result<(), Fault> {
    labels.iter().enumerate().try_for_each(|(index, label)| number(part, index, is_point(label.at)))
}

fn check_ground(ground: &Ground) -> Result<(), Fault> {
    let lengths = [ground.half_extent, ground.cell];
    let good = is_number(ground.height) && is_point(ground.centre) && lengths.into_iter().all(is_length);
    number("the ground", 0, good)?;
    if 2.0 * ground.half_extent > MAX_GRID_LINES * ground.cell { Err(Fault::Grid) } else { Ok(()) }
}

fn check_camera(index: usize, camera: &Camera) -> Result<(), Fault> {
    let lens = match camera.projection {
        Projection::Perspective { fov_y_rad } => (SMALLEST_ANGLE_RAD..=PI - SMALLEST_ANGLE_RAD).contains(&fov_y_rad),
        Projection::Orthographic { height } => is_length(height),
    };
    let good = [camera.eye, camera.target, camera.up].into_iter().all(is_point) && lens;
    number("the camera of view", index, good)?;
    let sight = camera.target - camera.eye;
    let sine = sight.normalize_or_zero().cross(camera.up.normalize_or_zero()).length();
    if is_length(sight.length()) && sine >= SMALLEST_ANGLE_RAD { Ok(()) } else { Err(Fault::Camera(index)) }
}

fn number(part: &'static str, index: usize, good: bool) -> Result<(), Fault> {
    if good { Ok(()) } else { Err(Fault::Number { part, index }) }
}

fn is_number(x: f64) -> bool {
    x.abs() <= LARGEST
}

fn is_point(p: DVec3) -> bool {
    p.to_array().into_iter().all(is_number)
}

/// A radius may be nothing.
fn is_radius(x: f64) -> bool {
    (0.0..=LARGEST).contains(&x)
}

/// A length that something is divided by may not.
fn is_length(x: f64) -> bool {
    (SMALLEST..=LARGEST).contains(&x)
}

/// Keys keep the promises that printing them relies on.
fn is_key(key: Key) -> bool {
    match key.code {
        Code::Char(c) => !c.is_control() && !key.shift,
        Code::F(n) => (1..=12).contains(&n),
        _ => true,
    }
}

/// Steps of a wheel between two looks at it.
fn is_turn(steps: i32) -> bool {
    (1..=MAX_WHEEL_STEPS as u32).contains(&steps.unsigned_abs())
}

fn is_ray(ray: &Ray) -> bool {
    /// A direction that was made of f32 is this close to a unit one.
    const UNIT_ACCURACY: f64 = 1e-3;
    let unit = (ray.direction.length() - 1.0).abs() <= UNIT_ACCURACY;
    (ray.view as usize) < MAX_VIEWS && is_point(ray.origin) && unit
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        motion::Side,
        scene::{Body, Curve, Footprint, Limb, Objects, Role, Stroke, View},
    };

    const UP: DVec3 = DVec3::Y;

    fn still() -> Still {
        Still {
            revision: 1,
            body_height: 1.7,
            bodies: vec![Body {
                role: Role::NewSkeleton,
                limbs: vec![
                    Limb { role: Role::NewSkeleton, from: 0, to: 1, radius: 0.1 },
                    Limb { role: Role::SelectedJoint, from: 1, to: 2, radius: 0.0 },
                ],
                wireframe: false,
            }],
            curves: vec![Curve { role: Role::NewPath, stroke: Stroke::Solid, points: vec![DVec3::ZERO, DVec3::ONE] }],
            footprints: vec![Footprint {
                role: Role::Footprint,
                foot: Side::Left,
                at: DVec3::ONE,
                heading_rad: 1.0,
                normal: DVec3::Y,
                length: 0.2,
            }],
            marks: vec![Mark { role: Role::ControlPoint, at: DVec3::ONE, radius: 0.1 }],
            labels: vec![Label { role: Role::ControlPoint, at: DVec3::ONE, text: "1".to_owned() }],
            ground: Some(Ground { height: 0.0, centre: DVec3::ZERO, half_extent: 10.0, cell: 1.0 }),
        }
    }

    fn now() -> Now {
        let camera = Camera {
            eye: DVec3::new(0.0, 1.0, 5.0),
            target: UP,
            up: UP,
            projection: Projection::Perspective { fov_y_rad: 0.8 },
        };
        Now {
            actors: vec![vec![DVec3::ZERO, UP, DVec3::ONE]],
            marks: vec![],
            labels: vec![],
            views: vec![View { camera, title: "1".to_owned(), shows: Objects::ALL, focused: false }],
            caption: String::new(),
        }
    }

    /// Spoils a good scene and returns what is found wrong with it.
    fn fault(spoil: impl FnOnce(&mut Still, &mut Now)) -> Option<Fault> {
        let (mut still, mut now) = (still(), now());
        spoil(&mut still, &mut now);
        check_still(&still).and_then(|()| check_now(&still, &now)).err()
    }

    #[test]
    fn a_good_scene_passes() {
        assert_eq!(fault(|_, _| {}), None);
        assert_eq!(fault(|_, now| now.actors[0].clear()), None, "a body with no points is not drawn");
    }

    #[test]
    fn numbers_that_cannot_be_drawn_are_found_wherever_they_are() {
        let found = |part, index| Some(Fault::Number { part, index });
        assert_eq!(fault(|s, _| s.body_height = 0.0), found("the body height", 0));
        assert_eq!(fault(|s, _| s.body_height = f64::NAN), found("the body height", 0));
        assert_eq!(fault(|s, _| s.bodies[0].limbs[1].radius = -1.0), found("the limbs of body", 0));
        assert_eq!(fault(|s, _| s.curves[0].points[1].z = f64::NAN), found("curve", 0));
        assert_eq!(fault(|s, _| s.footprints[0].heading_rad = f64::NAN), found("footprint", 0));
        assert_eq!(fault(|s, _| s.footprints[0].normal = DVec3::ZERO), found("footprint", 0));
        assert_eq!(fault(|s, _| s.footprints[0].length = 0.0), found("footprint", 0));
        assert_eq!(fault(|s, _| s.footprints[0].at.y = 1e300), found("footprint", 0));
        assert_eq!(fault(|s, _| s.marks[0].at.x = f64::INFINITY), found("still mark", 0));
        assert_eq!(fault(|s, _| s.labels[0].at.y = 1e300), found("still label", 0));
        assert_eq!(fault(|s, _| s.ground.as_mut().unwrap().cell = 0.0), found("the ground", 0));
        assert_eq!(fault(|_, n| n.actors[0][2].y = f64::NAN), found("the points of body", 0));
        assert_eq!(fault(|_, n| n.views[0].camera.eye.x = f64::NAN), found("the camera of view", 0));
    }

    #[test]
    fn indices_and_counts_fit_each_other() {
        assert_eq!(fault(|_, n| n.actors.clear()), Some(Fault::Actors { bodies: 1, actors: 0 }));
        assert_eq!(fault(|_, n| n.actors.push(vec![])), Some(Fault::Actors { bodies: 1, actors: 2 }));
        assert_eq!(fault(|s, _| s.bodies[0].limbs[1].to = 3), Some(Fault::Limb { body: 0, point: 3, points: 3 }));
        assert_eq!(
            fault(|s, _| s.bodies[0].limbs[0].from = u32::MAX),
            Some(Fault::Limb { body: 0, point: u32::MAX, points: 3 })
        );
        assert_eq!(fault(|_, n| n.views.clear()), Some(Fault::Views(0)));
        assert_eq!(fault(|_, n| n.views = vec![n.views[0].clone(); 5]), Some(Fault::Views(5)));
        assert_eq!(fault(|s, _| s.ground.as_mut().unwrap().cell = 1e-6), Some(Fault::Grid));
    }

    #[test]
    fn views_show_what_there_is() {
        assert_eq!(fault(|_, n| n.views[0].shows = Objects::NONE), None);
        assert_eq!(fault(|_, n| n.views[0].shows = Objects::from_bits(u32::MAX)), Some(Fault::Objects(0)));
    }

    #[test]
    fn cameras_look_somewhere() {
        assert_eq!(fault(|_, n| n.views[0].camera.eye = n.views[0].camera.target), Some(Fault::Camera(0)));
        assert_eq!(fault(|_, n| n.views[0].camera.up = DVec3::NEG_Z), Some(Fault::Camera(0)));
        assert_eq!(fault(|_, n| n.views[0].camera.up = DVec3::ZERO), Some(Fault::Camera(0)));
        let lens = |projection| fault(|_, n| n.views[0].camera.projection = projection);
        for fov_y_rad in [0.0, 1e-300, -1.0, PI, f64::NAN] {
            assert!(lens(Projection::Perspective { fov_y_rad }).is_some(), "{fov_y_rad}");
        }
        for height in [0.0, -1.0, f64::INFINITY, f64::NAN] {
            assert!(lens(Projection::Orthographic { height }).is_some(), "{height}");
        }
    }

    #[test]
    fn events_are_fit_to_act_on() {
        let key = |code, shift| FromPreview::Key(Key { code, ctrl: false, alt: false, shift });
        assert_eq!(check_event(&key(Code::F(12), true)), Ok(()));
        assert_eq!(check_event(&key(Code::F(13), false)), Err(Fault::Key));
        assert_eq!(check_event(&key(Code::Char('\u{1b}'), false)), Err(Fault::Key));
        assert_eq!(check_event(&key(Code::Char('A'), true)), Err(Fault::Key));
        let ray = |view, direction| FromPreview::Pick(Ray { view, origin: DVec3::ZERO, direction });
        assert_eq!(check_event(&ray(3, UP)), Ok(()));
        assert_eq!(check_event(&ray(4, UP)), Err(Fault::Ray));
        assert_eq!(check_event(&ray(0, DVec3::ZERO)), Err(Fault::Ray));
        assert_eq!(check_event(&ray(0, DVec3::NAN)), Err(Fault::Ray));
        let wheel = |view, steps| check_event(&FromPreview::Wheel { view, steps });
        assert_eq!([wheel(3, 1), wheel(0, -MAX_WHEEL_STEPS)], [Ok(()), Ok(())]);
        for (view, steps) in [(4, 1), (0, 0), (0, MAX_WHEEL_STEPS + 1), (0, i32::MIN)] {
            assert_eq!(wheel(view, steps), Err(Fault::Wheel), "{view} {steps}");
        }
    }

    #[test]
    fn pictures_have_the_bytes_of_their_size() {
        assert_eq!(check_picture(4096, 2160, 4096 * 2160 * 3), Ok(()));
        assert_eq!(check_picture(2, 2, 11), Err(Fault::Pixels { width: 2, height: 2, bytes: 11 }));
        for (width, height) in [(0, 4), (4, 0), (4097, 1), (1, 2161), (u32::MAX, u32::MAX)] {
            assert_eq!(check_picture(width, height, 0), Err(Fault::Size { width, height }));
        }
    }
}
