//! The mathematics of a view: where it lies in the picture, what it maps where, and what lies under a pixel.

use glam::{
    DMat4, DVec2, DVec3,
    dcamera::rh::{proj::vulkan, view},
};

use crate::scene::{Camera, Projection, Ray, View};

/// A rectangle of a picture in pixels from its top left.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Tile {
    pub(super) x: u32,
    pub(super) y: u32,
    pub(super) width: u32,
    pub(super) height: u32,
}

impl Tile {
    /// Returns the width divided by the height.
    pub(super) fn aspect(self) -> f64 {
        f64::from(self.width) / f64::from(self.height)
    }

    /// Returns whether a point in pixels lies inside.
    pub(super) fn contains(self, pixel: DVec2) -> bool {
        let (x, y) = (f64::from(self.x), f64::from(self.y));
        (x..x + f64::from(self.width)).contains(&pixel.x) && (y..y + f64::from(self.height)).contains(&pixel.y)
    }

    /// Returns a point's place in the tile, −1 to 1 from left to right and from top to bottom.
    fn normalised(self, pixel: DVec2) -> DVec2 {
        let size = DVec2::new(f64::from(self.width), f64::from(self.height));
        (pixel - DVec2::new(f64::from(self.x), f64::from(self.y))) / size * 2.0 - 1.0
    }
}

/// Returns where each of `n` views lies: one fills the picture, two lie side by side, four in a square.
///
/// A gap of `gap` pixels is between neighbours. A picture too small for gaps and all views has tiles of at least one
/// pixel, which may then overlap.
pub(super) fn tiles(n: usize, width: u32, height: u32, gap: u32) -> Vec<Tile> {
    let columns = (1..).find(|c| c * c >= n).unwrap_or(1);
    let rows = n.div_ceil(columns.max(1));
    let span = |index: usize, of: usize, length: u32| {
        let (index, of) = (index as u64, of as u64);
        let (length, gap) = (u64::from(length), u64::from(gap));
        let start = (length + gap) * index / of;
        let end = ((length + gap) * (index + 1) / of).saturating_sub(gap);
        let start = start.min(length - 1);
        (start as u32, end.clamp(start + 1, length) as u32 - start as u32)
    };
    (0..n)
        .map(|i| {
            let (x, width) = span(i % columns, columns, width);
            let (y, height) = span(i / columns, rows, height);
            Tile { x, y, width, height }
        })
        .collect()
}

/// Returns the gap between views in pixels for a picture of this size.
pub(super) fn gap(width: u32, height: u32) -> u32 {
    (width.min(height) / 360).clamp(1, 4)
}

/// A box round everything that is drawn.
#[derive(Clone, Copy, Debug)]
pub(super) struct Bounds {
    pub(super) low: DVec3,
    pub(super) high: DVec3,
}

impl Bounds {
    /// A box with nothing in it.
    pub(super) const EMPTY: Self = Self { low: DVec3::INFINITY, high: DVec3::NEG_INFINITY };

    /// Grows the box to hold a ball; a ball that is not finite is left out.
    pub(super) fn add(&mut self, centre: DVec3, radius: f64) {
        if centre.is_finite() && radius.is_finite() {
            self.low = self.low.min(centre - radius);
            self.high = self.high.max(centre + radius);
        }
    }

    /// Returns the middle; none when the box is empty.
    pub(super) fn middle(&self) -> Option<DVec3> {
        (self.low.x <= self.high.x).then(|| (self.low + self.high) * 0.5)
    }

    /// Returns the corners; the origin's when the box is empty.
    fn corners(&self) -> [DVec3; 8] {
        let (low, high) = if self.low.x <= self.high.x { (self.low, self.high) } else { (DVec3::ZERO, DVec3::ZERO) };
        std::array::from_fn(|i| {
            let pick = |bit: usize, low: f64, high: f64| if i & bit == 0 { low } else { high };
            DVec3::new(pick(1, low.x, high.x), pick(2, low.y, high.y), pick(4, low.z, high.z))
        })
    }
}

/// A camera made ready for one tile.
#[derive(Clone, Copy, Debug)]
pub(super) struct Lens {
    pub(super) eye: DVec3,
    /// Unit direction of sight.
    pub(super) forward: DVec3,
    right: DVec3,
    up: DVec3,
    projection: Projection,
    aspect: f64,
}

impl Lens {
    /// Makes a lens; a camera whose eye, target or up direction is impossible looks along −z with y up.
    pub(super) fn new(camera: &Camera, aspect: f64) -> Self {
        let forward = (camera.target - camera.eye).try_normalize().unwrap_or(DVec3::NEG_Z);
        let right = forward.cross(camera.up).try_normalize().unwrap_or_else(|| forward.any_orthonormal_vector());
        let eye = if camera.eye.is_finite() { camera.eye } else { DVec3::ZERO };
        Self { eye, forward, right, up: right.cross(forward), projection: camera.projection, aspect }
    }

    /// Returns whether lines of sight meet at the eye.
    pub(super) fn is_perspective(&self) -> bool {
        matches!(self.projection, Projection::Perspective { .. })
    }

    /// Returns half the view's width and height as vectors: at distance 1 in perspective, else in the world.
    fn half_view(&self) -> (DVec3, DVec3) {
        let half_height = match self.projection {
            Projection::Perspective { fov_y_rad } => (sane_fov(fov_y_rad) * 0.5).tan(),
            Projection::Orthographic { height } => sane_height(height) * 0.5,
        };
        (self.right * half_height * self.aspect, self.up * half_height)
    }

    /// Returns what to add to `forward` to reach the right and the upper edge of the view; zero where sight is
    /// parallel.
    pub(super) fn spread(&self) -> (DVec3, DVec3) {
        if self.is_perspective() { self.half_view() } else { (DVec3::ZERO, DVec3::ZERO) }
    }

    /// Returns the matrix to clip space (y down, depth 0 to 1) from positions relative to `origin`.
    ///
    /// The near and the far plane hold `bounds` as tightly as sight allows: in perspective the near plane is at least
    /// a fiftieth of the body height away, so that a 32-bit depth serves.
    pub(super) fn matrix(&self, origin: DVec3, bounds: &Bounds, body_height: f64) -> DMat4 {
        let depth = |p: DVec3| (p - self.eye).dot(self.forward);
        let (low, high) = bounds
            .corners()
            .into_iter()
            .map(depth)
            .fold((f64::INFINITY, f64::NEG_INFINITY), |(low, high), d| (low.min(d), high.max(d)));
        let margin = body_height * 0.02;
        let projection = match self.projection {
            Projection::Perspective { fov_y_rad } => {
                let near = (low - margin).max(margin);
                let far = (high + margin).max(near * 2.0);
                vulkan::perspective(sane_fov(fov_y_rad), self.aspect, near, far)
            }
            Projection::Orthographic { height } => {
                let half_height = sane_height(height) * 0.5;
                let half_width = half_height * self.aspect;
                vulkan::orthographic(-half_width, half_width, -half_height, half_height, low - margin, high + margin)
            }
        };
        projection * view::look_to_mat4(self.eye - origin, self.forward, self.up)
    }

    /// Returns where a point appears, −1 to 1 from left to right and from top to bottom, and its distance along the
    /// line of sight; none when it is not before the eye.
    pub(super) fn project(&self, point: DVec3) -> Option<(DVec2, f64)> {
        let (half_right, half_up) = self.half_view();
        let offset = point - self.eye;
        let depth = offset.dot(self.forward);
        let scale = if self.is_perspective() { depth } else { 1.0 };
        let at = DVec2::new(
            offset.dot(half_right) / half_right.length_squared(),
            -offset.dot(half_up) / half_up.length_squared(),
        ) / scale;
        (at.is_finite() && (depth > 0.0 || !self.is_perspective())).then_some((at, depth))
    }

    /// Returns origin and unit direction of the line of sight through a place in the view (−1 to 1, y down).
    fn sight(&self, at: DVec2) -> (DVec3, DVec3) {
        let (right, up) = self.half_view();
        let across = right * at.x - up * at.y;
        if self.is_perspective() {
            (self.eye, (self.forward + across).normalize())
        } else {
            (self.eye + across, self.forward)
        }
    }
}

/// A field of view that has a projection.
fn sane_fov(fov_y_rad: f64) -> f64 {
    fov_y_rad.clamp(0.01, 3.1)
}

/// A height of view that has a projection.
fn sane_height(height: f64) -> f64 {
    height.abs().clamp(1e-9, 1e12)
}

/// Returns the ray through a pixel of a picture of these views; none between views and outside.
///
/// Pixels are counted from the top left corner, so the middle of the first is (0.5, 0.5).
pub fn pick(views: &[View], width: u32, height: u32, x: f64, y: f64) -> Option<Ray> {
    let pixel = DVec2::new(x, y);
    let tiles = placed(views.len(), width, height);
    let view = tiles.iter().position(|t| t.contains(pixel))?;
    Some(ray(&views[view], view, tiles[view], pixel))
}

/// Returns the ray of one view through a pixel, which may lie outside of the view: a drag that has left it goes on.
pub(super) fn ray_through(views: &[View], view: usize, width: u32, height: u32, x: f64, y: f64) -> Option<Ray> {
    let tile = *placed(views.len(), width, height).get(view)?;
    Some(ray(views.get(view)?, view, tile, DVec2::new(x, y)))
}

fn placed(n: usize, width: u32, height: u32) -> Vec<Tile> {
    if width == 0 || height == 0 { Vec::new() } else { tiles(n, width, height, gap(width, height)) }
}

fn ray(view: &View, index: usize, tile: Tile, pixel: DVec2) -> Ray {
    let (origin, direction) = Lens::new(&view.camera, tile.aspect()).sight(tile.normalised(pixel));
    Ray { view: index as u32, origin, direction }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::scene::Objects;

    fn camera(projection: Projection) -> Camera {
        Camera { eye: DVec3::new(3.0, 2.0, 5.0), target: DVec3::new(0.5, 1.0, 0.0), up: DVec3::Y, projection }
    }

    fn view(projection: Projection) -> View {
        View { camera: camera(projection), title: String::new(), shows: Objects::ALL, focused: false }
    }

    const BOTH: [Projection; 2] =
        [Projection::Perspective { fov_y_rad: 0.8 }, Projection::Orthographic { height: 4.0 }];

    #[test]
    fn views_tile_the_picture() {
        assert_eq!(tiles(1, 640, 360, 2), [Tile { x: 0, y: 0, width: 640, height: 360 }]);
        let two = tiles(2, 640, 360, 2);
        assert_eq!(two[0], Tile { x: 0, y: 0, width: 319, height: 360 });
        assert_eq!(two[1], Tile { x: 321, y: 0, width: 319, height: 360 });
        let four = tiles(4, 640, 360, 2);
        assert_eq!(four[3], Tile { x: 321, y: 181, width: 319, height: 179 });
        assert_eq!(tiles(0, 640, 360, 2), []);
    }

    #[test]
    fn tiles_are_never_empty_nor_outside() {
        for n in 1..=9 {
            for (width, height) in [(1, 1), (2, 3), (5, 1), (7, 100), (640, 360)] {
                for t in tiles(n, width, height, gap(width, height)) {
                    assert!(t.width > 0 && t.height > 0, "{n} in {width}×{height}: {t:?}");
                    assert!(t.x + t.width <= width && t.y + t.height <= height, "{n} in {width}×{height}: {t:?}");
                }
            }
        }
    }

    #[test]
    fn matrix_and_projection_agree() {
        let mut bounds = Bounds::EMPTY;
        bounds.add(DVec3::ZERO, 6.0);
        let origin = DVec3::new(100.0, -3.0, 7.0);
        for projection in BOTH {
            let lens = Lens::new(&camera(projection), 1.6);
            let matrix = lens.matrix(origin, &bounds, 1.7);
            for p in [DVec3::ZERO, DVec3::new(1.0, 2.0, 0.5), DVec3::new(-1.0, 0.2, -3.0)] {
                let clip = matrix.project_point3(p - origin);
                let (at, _) = lens.project(p).expect("before the eye");
                assert!((clip.truncate() - at).length() < 1e-9, "{p}: {clip} and {at}");
                assert!(clip.z > 0.0 && clip.z < 1.0, "{p} lies between the planes: {clip}");
            }
        }
    }

    #[test]
    fn a_ray_through_a_points_pixel_hits_the_point() {
        for projection in BOTH {
            let view = view(projection);
            let views = [view.clone(), view.clone(), view.clone(), view];
            let tile = tiles(4, 800, 600, gap(800, 600))[2];
            let p = DVec3::new(0.3, 1.2, -0.4);
            let (at, _) = Lens::new(&views[2].camera, tile.aspect()).project(p).expect("before the eye");
            let x = f64::from(tile.x) + (at.x + 1.0) * 0.5 * f64::from(tile.width);
            let y = f64::from(tile.y) + (at.y + 1.0) * 0.5 * f64::from(tile.height);
            let ray = pick(&views, 800, 600, x, y).expect("inside");
            assert_eq!(ray.view, 2);
            let miss = (p - ray.origin).reject_from(ray.direction).length();
            assert!(miss < 1e-9, "missed by {miss}");
            assert!((p - ray.origin).dot(ray.direction) > 0.0);
        }
    }

    #[test]
    fn nothing_is_picked_outside_and_between() {
        let view = view(BOTH[0]);
        let views = [view.clone(), view];
        assert_eq!(pick(&views, 640, 360, 319.5, 100.0), None, "in the gap");
        assert_eq!(pick(&views, 640, 360, -1.0, 100.0), None);
        assert_eq!(pick(&views, 640, 360, 10.0, 360.0), None);
        assert_eq!(pick(&views, 0, 0, 0.0, 0.0), None);
        assert_eq!(pick(&[], 640, 360, 10.0, 10.0), None);
    }

    #[test]
    fn impossible_cameras_stay_finite() {
        let here = DVec3::ONE;
        let cases = [(here, here, DVec3::Y), (here, here + DVec3::Y, DVec3::Y), (DVec3::NAN, here, DVec3::Y)];
        for (eye, target, up) in cases {
            let lens = Lens::new(&Camera { eye, target, up, projection: BOTH[0] }, 1.0);
            assert!(lens.matrix(DVec3::ZERO, &Bounds::EMPTY, 1.0).is_finite(), "{eye} {target} {up}");
        }
    }

    #[test]
    fn what_is_behind_the_eye_does_not_appear() {
        let lens = Lens::new(&camera(BOTH[0]), 1.0);
        assert!(lens.project(lens.eye - lens.forward).is_none());
    }
}
