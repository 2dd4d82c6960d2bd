//! Positions of points over frames, laid out for loops over frames.
//!
//! ```text
//! x: | point 0: frame 0 … F−1, pad | point 1: frame 0 … F−1, pad | …      y, z alike
//! ```

use glam::DVec3;

/// Positions of one point over frames.
#[derive(Clone, Copy, Debug)]
pub struct Track<'a> {
    /// By frame.
    pub x: &'a [f64],
    /// By frame, as many as `x`.
    pub y: &'a [f64],
    /// By frame, as many as `x`.
    pub z: &'a [f64],
}

impl Track<'_> {
    /// Returns the position at a frame.
    pub fn at(&self, frame: usize) -> DVec3 {
        DVec3::new(self.x[frame], self.y[frame], self.z[frame])
    }

    /// Returns the horizontal distance from a frame's position to another's.
    pub fn flat_distance(&self, from: usize, to: usize) -> f64 {
        self.flat_distance_squared(from, to).sqrt()
    }

    /// Returns the square of [`Self::flat_distance`].
    pub fn flat_distance_squared(&self, from: usize, to: usize) -> f64 {
        let (dx, dz) = (self.x[to] - self.x[from], self.z[to] - self.z[from]);
        dx * dx + dz * dz
    }
}

/// Positions, points × frames, point-major, one array per axis.
#[derive(Clone, Debug, Default)]
pub struct PointTracks {
    n_points: usize,
    n_frames: usize,
    /// Distance from one point to the next; an odd number of cache lines, so that the points of one frame do not
    /// compete for the same few places of the cache.
    stride: usize,
    pub(super) x: Vec<f64>,
    pub(super) y: Vec<f64>,
    pub(super) z: Vec<f64>,
}

impl PointTracks {
    /// Makes tracks with every position at the origin.
    pub fn new(n_points: usize, n_frames: usize) -> Self {
        const CACHE_LINE: usize = 8;
        let stride = (n_frames.div_ceil(CACHE_LINE) | 1) * CACHE_LINE;
        let axis = || vec![0.0; n_points * stride];
        Self { n_points, n_frames, stride, x: axis(), y: axis(), z: axis() }
    }

    /// Makes tracks from a position per point and frame.
    pub fn from_fn(n_points: usize, n_frames: usize, position: impl Fn(usize, usize) -> DVec3) -> Self {
        let mut tracks = Self::new(n_points, n_frames);
        for point in 0..n_points {
            for frame in 0..n_frames {
                let (at, p) = (tracks.at(point, frame), position(point, frame));
                (tracks.x[at], tracks.y[at], tracks.z[at]) = (p.x, p.y, p.z);
            }
        }
        tracks
    }

    /// Puts in the positions of a point from a frame on, axis by axis.
    pub fn put(&mut self, point: usize, first_frame: usize, positions: [&[f64]; 3]) {
        assert!(first_frame + positions[0].len() <= self.n_frames, "frames of the clip");
        let at = self.at(point, first_frame);
        for (axis, values) in [&mut self.x, &mut self.y, &mut self.z].into_iter().zip(positions) {
            axis[at..at + values.len()].copy_from_slice(values);
        }
    }

    /// Returns the index of a position in the three arrays.
    #[inline]
    pub(super) fn at(&self, point: usize, frame: usize) -> usize {
        point * self.stride + frame
    }

    /// Returns the number of points.
    pub fn n_points(&self) -> usize {
        self.n_points
    }

    /// Returns the number of frames.
    pub fn n_frames(&self) -> usize {
        self.n_frames
    }

    /// Returns a point's x over all frames.
    pub fn x(&self, point: usize) -> &[f64] {
        &self.x[point * self.stride..][..self.n_frames]
    }

    /// Returns a point's y over all frames.
    pub fn y(&self, point: usize) -> &[f64] {
        &self.y[point * self.stride..][..self.n_frames]
    }

    /// Returns a point's z over all frames.
    pub fn z(&self, point: usize) -> &[f64] {
        &self.z[point * self.stride..][..self.n_frames]
    }

    /// Returns a point's positions over all frames.
    pub fn track(&self, point: usize) -> Track<'_> {
        Track { x: self.x(point), y: self.y(point), z: self.z(point) }
    }

    /// Returns one position.
    #[inline]
    pub fn position(&self, point: usize, frame: usize) -> DVec3 {
        assert!(frame < self.n_frames, "frame {frame} of {}", self.n_frames);
        let at = self.at(point, frame);
        DVec3::new(self.x[at], self.y[at], self.z[at])
    }
}
