//! Footprints as curves: the outline of a sole on the ground, crossed out where the plant was missed.

use glam::{DQuat, DVec3};

use crate::{
    math::heading_rotation,
    motion::Side,
    scene::{Curve, Footprint, Role, Stroke},
};

/// The sole of a left foot: outwards from its middle line and forwards from its middle, as shares of its length.
const SOLE: [[f64; 2]; 16] = [
    [0.0, -0.5],
    [0.11, -0.47],
    [0.15, -0.38],
    [0.14, -0.2],
    [0.15, 0.0],
    [0.19, 0.2],
    [0.17, 0.34],
    [0.08, 0.45],
    [-0.05, 0.5],
    [-0.15, 0.46],
    [-0.19, 0.32],
    [-0.17, 0.16],
    [-0.08, 0.0],
    [-0.08, -0.2],
    [-0.14, -0.38],
    [-0.11, -0.47],
];

/// Corners of the sole that a missed print's cross joins, two and two.
const CROSS: [[usize; 2]; 2] = [[2, 10], [14, 6]];

/// Returns the curves of a footprint.
pub(super) fn curves(print: &Footprint) -> Vec<Curve> {
    let turn = DQuat::from_rotation_arc(DVec3::Y, print.normal) * heading_rotation(print.heading_rad);
    // A body that faces +z has +x on its left.
    let outwards = if print.foot == Side::Left { 1.0 } else { -1.0 };
    let point = |corner: usize| {
        let [across, along] = SOLE[corner % SOLE.len()];
        print.at + turn * DVec3::new(outwards * across, 0.0, along) * print.length
    };
    let curve = |points: Vec<DVec3>| Curve { role: print.role, stroke: Stroke::Solid, points };
    let mut curves = vec![curve((0..=SOLE.len()).map(point).collect())];
    if print.role == Role::MissedFootprint {
        curves.extend(CROSS.map(|corners| curve(corners.map(point).to_vec())));
    }
    curves
}

#[cfg(test)]
mod tests {
    use super::*;

    fn print(foot: Side, heading_rad: f64) -> Footprint {
        let at = DVec3::new(5.0, 1.0, -2.0);
        Footprint { role: Role::Footprint, foot, at, heading_rad, normal: DVec3::Y, length: 2.0 }
    }

    #[test]
    fn the_outline_is_closed_flat_and_as_long_as_the_foot_wherever_it_points() {
        for heading in [0.0, 1.0, -2.5] {
            let print = print(Side::Left, heading);
            let ahead = DVec3::new(heading.sin(), 0.0, heading.cos());
            let outline = &curves(&print)[0].points;
            assert_eq!(outline.first(), outline.last());
            assert!(outline.iter().all(|p| p.y == 1.0));
            let along = outline.iter().map(|p| (*p - print.at).dot(ahead));
            assert!((along.clone().fold(f64::MIN, f64::max) - 1.0).abs() < 1e-12);
            assert!((along.fold(f64::MAX, f64::min) + 1.0).abs() < 1e-12);
        }
    }

    #[test]
    fn the_outline_leans_with_the_ground() {
        let normal = DVec3::new(0.3, 0.9, -0.2).normalize();
        let print = Footprint { normal, ..print(Side::Right, 0.7) };
        let outline = &curves(&print)[0].points;
        assert!(outline.iter().all(|p| (*p - print.at).dot(normal).abs() < 1e-12));
        assert!((outline[8].distance(outline[0]) - print.length).abs() < 0.01 * print.length, "as long as before");
    }

    #[test]
    fn left_and_right_mirror_each_other_and_a_missed_print_is_crossed_out() {
        let [left, right] = [Side::Left, Side::Right].map(|foot| print(foot, 0.0));
        for (l, r) in curves(&left)[0].points.iter().zip(&curves(&right)[0].points) {
            assert!((l.x + r.x - 2.0 * left.at.x).abs() < 1e-12 && l.z == r.z);
        }
        let toe = curves(&left)[0].points[8];
        assert!(toe.x < left.at.x, "the big toe is on the inner side, which is the left foot's right");
        assert_eq!(curves(&Footprint { role: Role::MissedFootprint, ..left }).len(), 3);
    }
}
