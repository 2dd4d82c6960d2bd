//! A scene as instances: what the passes draw, relative to the scene's origin, in f32 and linear light.

use bytemuck::{Pod, Zeroable};
use glam::DVec3;

use super::{
    camera::Bounds,
    footprint,
    listed::{Listed, Part},
    shadow::Caster,
    wire,
};
use crate::scene::{Body, Curve, Ground, Mark, Now, Object, Objects, Role, Still, Stroke};

/// A capsule, a sphere (both ends equal) or a cube (both ends equal).
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Solid {
    from: [f32; 3],
    radius: f32,
    to: [f32; 3],
    unused: f32,
    colour: [f32; 4],
}

/// One piece of a curve.
#[derive(Clone, Copy, Debug, PartialEq, Pod, Zeroable)]
#[repr(C)]
pub(super) struct Segment {
    a: [f32; 3],
    along_a: f32,
    b: [f32; 3],
    along_b: f32,
    colour: [f32; 4],
    /// Relative to the picture's line width.
    width: f32,
    /// Length of a dash with its gap, world; 0: unbroken.
    dash: f32,
}

/// Solids, by mesh.
#[derive(Debug, Default)]
pub(super) struct Solids {
    /// Limbs and spheres.
    pub(super) capsules: Listed<Solid>,
    /// Trackers.
    pub(super) cubes: Listed<Solid>,
}

/// The part of a scene that stays, ready for the device.
#[derive(Debug)]
pub(super) struct StillBatch {
    /// What positions are relative to.
    pub(super) origin: DVec3,
    pub(super) solids: Solids,
    pub(super) segments: Listed<Segment>,
    pub(super) bounds: Bounds,
}

/// The part of a scene that moves, ready for the device.
#[derive(Debug)]
pub(super) struct NowBatch {
    pub(super) solids: Solids,
    /// Edges of bodies.
    pub(super) segments: Listed<Segment>,
    /// Bodies and moving marks, relative to the origin, and what they are of.
    pub(super) casters: Vec<(Part, Caster)>,
    pub(super) bounds: Bounds,
}

/// Length of a dash with its gap, in body heights.
const DASH_HEIGHTS: f64 = 0.14;
/// Every so many grid lines one is stronger; `view.wgsl` knows it too.
pub(super) const GRID_STEP: f64 = 5.0;

impl StillBatch {
    /// Gathers what stays. `now` only serves to find an origin when nothing stays.
    pub(super) fn new(still: &Still, now: &Now) -> Self {
        let mut bounds = Bounds::EMPTY;
        for p in still.curves.iter().flat_map(|c| &c.points) {
            bounds.add(*p, 0.0);
        }
        for print in &still.footprints {
            bounds.add(print.at, print.length);
        }
        for mark in &still.marks {
            bounds.add(mark.at, mark.radius);
        }
        if let Some(ground) = &still.ground {
            let middle = DVec3::new(ground.centre.x, ground.height, ground.centre.z);
            for corner in [-ground.half_extent, ground.half_extent] {
                bounds.add(middle + DVec3::new(corner, 0.0, corner), 0.0);
            }
        }
        let first_point = || now.actors.iter().flatten().copied().find(|p| p.is_finite());
        let origin = bounds.middle().or_else(first_point).unwrap_or(DVec3::ZERO);
        let mut segments = Listed::default();
        for curve in still.ground.iter().flat_map(axes) {
            add_curve(&mut segments, Part::of(curve.role), &curve, 0.5, origin, still.body_height);
        }
        for curve in still.footprints.iter().flat_map(footprint::curves) {
            add_curve(&mut segments, Part::of(curve.role), &curve, width(curve.role), origin, still.body_height);
        }
        for curve in &still.curves {
            add_curve(&mut segments, Part::of(curve.role), curve, width(curve.role), origin, still.body_height);
        }
        for ring in still.marks.iter().filter(|m| m.role == Role::SelectedControlPoint).map(ring) {
            add_curve(&mut segments, Part::of(ring.role), &ring, 0.8, origin, still.body_height);
        }
        let mut solids = Solids::default();
        for mark in &still.marks {
            solids.add_mark(mark, origin);
        }
        Self { origin, solids, segments, bounds }
    }
}

impl NowBatch {
    /// Gathers what moves. A limb of a point that is not there is not drawn.
    pub(super) fn new(still: &Still, now: &Now, origin: DVec3) -> Self {
        let mut batch =
            Self { solids: Solids::default(), segments: Listed::default(), casters: Vec::new(), bounds: Bounds::EMPTY };
        for (body, points) in still.bodies.iter().zip(&now.actors) {
            batch.add_body(body, points, origin, still.body_height);
        }
        for mark in &now.marks {
            batch.solids.add_mark(mark, origin);
            batch.add_caster(Part::of(mark.role), mark.at, mark.radius, origin);
        }
        batch
    }

    /// Returns what casts shadows in a view: the same for views in which the same does.
    pub(super) fn casting(&self, shows: Objects) -> Objects {
        let casting = self.casters.iter().map(|(part, _)| *part).filter(|part| part.is_shown(shows));
        let objects = casting.map(Part::object).collect::<Objects>();
        // It says how bodies are seen, too.
        if shows.contains(Object::Wireframe) { objects.with(Object::Wireframe) } else { objects }
    }

    fn add_body(&mut self, body: &Body, points: &[DVec3], origin: DVec3, body_height: f64) {
        for limb in &body.limbs {
            let (Some(&from), Some(&to)) = (points.get(limb.from as usize), points.get(limb.to as usize)) else {
                continue;
            };
            let mut part = Part::of(body.role);
            if body.wireframe {
                // Which of the two is seen is the view's to say.
                for edge in wire::edges(limb, from, to) {
                    add_curve(&mut self.segments, part.as_edges(), &edge, width(limb.role), origin, body_height);
                }
                part = part.as_solids();
            }
            self.solids.capsules.push(part, solid(from, to, limb.radius, limb.role, origin));
            self.add_caster(part, from, limb.radius, origin);
            self.add_caster(part, to, limb.radius, origin);
        }
    }

    fn add_caster(&mut self, part: Part, centre: DVec3, radius: f64, origin: DVec3) {
        self.casters.push((part, (centre - origin, radius)));
        self.bounds.add(centre, radius);
    }
}

impl Solids {
    fn add_mark(&mut self, mark: &Mark, origin: DVec3) {
        let list = if is_cube(mark.role) { &mut self.cubes } else { &mut self.capsules };
        list.push(Part::of(mark.role), solid(mark.at, mark.at, mark.radius, mark.role, origin));
    }
}

fn solid(from: DVec3, to: DVec3, radius: f64, role: Role, origin: DVec3) -> Solid {
    Solid { from: near(from, origin), radius: radius as f32, to: near(to, origin), unused: 0.0, colour: colour(role) }
}

/// Trackers are cubes, everything else is round, so that they differ in more than colour.
fn is_cube(role: Role) -> bool {
    matches!(role, Role::OriginalTracker | Role::NewTracker)
}

/// Width of a curve relative to the picture's line width.
fn width(role: Role) -> f32 {
    match role {
        Role::NewPath | Role::Strain => 1.0,
        Role::OriginalPath => 0.85,
        Role::Footprint | Role::MissedFootprint => 0.7,
        _ => 0.55,
    }
}

fn add_curve(list: &mut Listed<Segment>, part: Part, curve: &Curve, width: f32, origin: DVec3, body_height: f64) {
    let dash = match curve.stroke {
        Stroke::Solid => 0.0,
        Stroke::Dashed => (body_height * DASH_HEIGHTS) as f32,
    };
    let mut along = 0.0;
    for pair in curve.points.windows(2) {
        let start = along;
        along += pair[0].distance(pair[1]);
        let segment = Segment {
            a: near(pair[0], origin),
            along_a: start as f32,
            b: near(pair[1], origin),
            along_b: along as f32,
            colour: colour(curve.role),
            width,
            dash,
        };
        list.push(part, segment);
    }
}

/// Two lines across the ground, so that it is seen from the side too, where the plane itself has no height.
fn axes(ground: &Ground) -> [Curve; 2] {
    // Short of where the ground has faded away.
    let reach = ground.half_extent * 0.6;
    // On the strong grid lines nearest to the middle.
    let large = ground.cell * GRID_STEP;
    let on_line = |v: f64| if large > 0.0 { (v / large).round() * large } else { v };
    let middle = DVec3::new(on_line(ground.centre.x), ground.height, on_line(ground.centre.z));
    [DVec3::X, DVec3::Z].map(|along| Curve {
        role: Role::Ground,
        stroke: Stroke::Solid,
        points: vec![middle - along * reach, middle + along * reach],
    })
}

/// A level circle round a mark: the selected control point is not told by its colour alone.
fn ring(mark: &Mark) -> Curve {
    const SIDES: u32 = 48;
    let point = |i: u32| {
        let (sin, cos) = (f64::from(i) / f64::from(SIDES) * std::f64::consts::TAU).sin_cos();
        mark.at + DVec3::new(cos, 0.0, sin) * (mark.radius * 2.0)
    };
    Curve { role: mark.role, stroke: Stroke::Solid, points: (0..=SIDES).map(point).collect() }
}

fn near(p: DVec3, origin: DVec3) -> [f32; 3] {
    (p - origin).as_vec3().to_array()
}

/// Returns a role's colour in linear light, opaque.
pub(super) fn colour(role: Role) -> [f32; 4] {
    let [r, g, b] = role.rgb().map(linear);
    [r, g, b, 1.0]
}

/// sRGB byte to linear light (IEC 61966-2-1).
fn linear(byte: u8) -> f32 {
    let c = f32::from(byte) / 255.0;
    if c <= 0.04045 { c / 12.92 } else { ((c + 0.055) / 1.055).powf(2.4) }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Limb;

    fn still() -> Still {
        Still {
            revision: 1,
            body_height: 2.0,
            bodies: vec![Body {
                role: Role::NewSkeleton,
                limbs: vec![
                    Limb { role: Role::NewSkeleton, from: 0, to: 1, radius: 0.1 },
                    Limb { role: Role::SelectedJoint, from: 1, to: 9, radius: 0.1 },
                ],
                wireframe: false,
            }],
            curves: vec![Curve {
                role: Role::NewPath,
                stroke: Stroke::Dashed,
                points: vec![DVec3::ZERO, DVec3::X * 3.0, DVec3::new(3.0, 4.0, 0.0)],
            }],
            footprints: vec![],
            marks: vec![Mark { role: Role::ControlPoint, at: DVec3::ONE, radius: 0.1 }],
            labels: vec![],
            ground: None,
        }
    }

    fn now(actor: Vec<DVec3>) -> Now {
        let tracker = Mark { role: Role::NewTracker, at: DVec3::Y, radius: 0.2 };
        Now { actors: vec![actor], marks: vec![tracker], labels: vec![], views: vec![], caption: String::new() }
    }

    #[test]
    fn positions_are_relative_to_an_origin_near_the_scene() {
        let far = DVec3::new(4.0e6, 0.0, -7.0e6);
        let mut still = still();
        for p in &mut still.curves[0].points {
            *p += far;
        }
        still.marks[0].at += far;
        let batch = StillBatch::new(&still, &now(vec![]));
        let a = DVec3::from_array(batch.segments.items[1].a.map(f64::from)) + batch.origin;
        assert!((a - still.curves[0].points[1]).length() < 1e-5, "f32 alone would be off by up to 0.5");
    }

    #[test]
    fn dashes_run_on_over_segments() {
        let batch = StillBatch::new(&still(), &now(vec![]));
        let [first, second] = batch.segments.items[..] else { panic!("two segments") };
        assert_eq!((first.along_a, first.along_b), (0.0, 3.0));
        assert_eq!((second.along_a, second.along_b), (3.0, 7.0));
        assert!(first.dash > 0.0);
    }

    #[test]
    fn trackers_are_cubes_and_control_points_are_round() {
        assert_eq!(StillBatch::new(&still(), &now(vec![])).solids.cubes.items.len(), 0);
        assert_eq!(NowBatch::new(&still(), &now(vec![]), DVec3::ZERO).solids.cubes.items.len(), 1);
    }

    #[test]
    fn limbs_without_points_are_left_out() {
        let batch = |points: Vec<DVec3>| NowBatch::new(&still(), &now(points), DVec3::ZERO);
        assert_eq!(batch(vec![]).solids.capsules.items.len(), 0);
        assert_eq!(batch(vec![DVec3::ZERO, DVec3::Y]).solids.capsules.items.len(), 1);
    }

    #[test]
    fn wireframe_bodies_are_lines_without_shadows_or_solids_by_what_a_view_shows() {
        let mut still = still();
        still.bodies[0].wireframe = true;
        let batch = NowBatch::new(&still, &now(vec![DVec3::ZERO, DVec3::Y]), DVec3::ZERO);
        let drawn = |shows: Objects| {
            let casters = batch.casters.iter().filter(|(part, _)| part.is_shown(shows)).count();
            (batch.solids.capsules.count(shows), batch.segments.count(shows), casters)
        };
        assert_eq!(drawn(Objects::ALL), (0, 12, 1), "the tracker casts a shadow");
        assert_eq!(drawn(Objects::ALL.without(Object::Wireframe)), (1, 0, 3));
        assert_eq!(drawn(Objects::ALL.without(Object::NewSkeleton)), (0, 0, 1));
        let mut edges = batch.segments.items.iter();
        assert!(edges.all(|s| s.dash == 0.0 && s.colour == colour(Role::NewSkeleton)));
    }

    #[test]
    fn a_selected_control_point_wears_a_ring() {
        let mut still = still();
        let before = StillBatch::new(&still, &now(vec![])).segments.items.len();
        still.marks[0].role = Role::SelectedControlPoint;
        assert!(StillBatch::new(&still, &now(vec![])).segments.items.len() > before);
    }

    #[test]
    fn colours_are_linear_light() {
        assert_eq!(linear(0), 0.0);
        assert_eq!(linear(255), 1.0);
        assert!((linear(188) - 0.502_886_5).abs() < 1e-5);
    }
}
