//! Limbs as edges: a slim octahedron from end to end, widest near where the limb begins, so that its direction is seen.

use glam::DVec3;

use crate::scene::{Curve, Limb, Stroke};

/// Where the octahedron is widest, as a share of the limb from its beginning.
const WAIST: f64 = 0.2;

/// Returns the edges of a limb between these points as three unbroken lines: round the waist, and twice over both ends.
pub(super) fn edges(limb: &Limb, from: DVec3, to: DVec3) -> [Curve; 3] {
    // A limb without length is a ball.
    let is_ball = from.distance(to) < limb.radius * 1e-3;
    let ends = if is_ball { [from - DVec3::Y * limb.radius, from + DVec3::Y * limb.radius] } else { [from, to] };
    let waist = if is_ball { from } else { from.lerp(to, WAIST) };
    let [from, to] = ends;
    let (x, z) = (to - from).normalize_or(DVec3::Y).any_orthonormal_pair();
    let [a, b, c, d] = [x, z, -x, -z].map(|across| waist + across * limb.radius);
    let line = |points: Vec<DVec3>| Curve { role: limb.role, stroke: Stroke::Solid, points };
    [line(vec![a, b, c, d, a]), line(vec![from, a, to, c, from]), line(vec![from, b, to, d, from])]
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Role;

    fn check(from: DVec3, to: DVec3) -> Vec<DVec3> {
        let limb = Limb { role: Role::NewSkeleton, from: 0, to: 1, radius: 0.1 };
        let points: Vec<DVec3> = edges(&limb, from, to).into_iter().flat_map(|curve| curve.points).collect();
        assert!(points.iter().all(|p| p.is_finite()), "{points:?}");
        points
    }

    #[test]
    fn edges_reach_both_ends_and_are_as_wide_as_the_limb() {
        for to in [DVec3::Y, DVec3::NEG_Y, DVec3::new(0.3, -2.0, 1.0), DVec3::X] {
            let points = check(DVec3::ZERO, to);
            assert!(points.contains(&DVec3::ZERO) && points.contains(&to));
            let far = |p: &DVec3| (*p - to * (p.dot(to) / to.length_squared())).length();
            assert!((points.iter().map(far).fold(0.0, f64::max) - 0.1).abs() < 1e-12);
        }
    }

    #[test]
    fn a_limb_without_length_is_as_wide_as_high() {
        let points = check(DVec3::ONE, DVec3::ONE);
        assert!(points.iter().all(|p| (p.distance(DVec3::ONE) - 0.1).abs() < 1e-12));
    }
}
