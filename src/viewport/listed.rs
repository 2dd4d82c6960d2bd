//! Instances of several objects in one buffer, of which each view draws the objects it shows.
//!
//! ```text
//! instances  g g f f f f p p p p p p c c c     in drawing order
//! runs       └g┘ └──f──┘ └────p────┘ └─c─┘     one object each
//! ```
//!
//! A view draws the runs of its objects; runs that follow each other are drawn as one, so a view of everything is a
//! single draw.

use std::{ops::Range, rc::Rc};

use ash::vk;
use bytemuck::Pod;

use super::{buffer::Instances, device::Device, error::GpuError};
use crate::scene::{Object, Objects, Role};

/// What an instance is a part of, and for the limbs of a wireframe body which of its two looks.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub(super) struct Part {
    object: Object,
    look: Option<Look>,
}

/// The two looks of a wireframe body: edges where a view shows [`Object::Wireframe`], else solids.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
enum Look {
    Edges,
    Solids,
}

impl Part {
    /// Returns the part that things of a role are.
    pub(super) fn of(role: Role) -> Self {
        Self { object: role.object(), look: None }
    }

    /// Returns the part as seen where bodies are edges.
    pub(super) fn as_edges(self) -> Self {
        Self { look: Some(Look::Edges), ..self }
    }

    /// Returns the part as seen where bodies are solids, though they could be edges.
    pub(super) fn as_solids(self) -> Self {
        Self { look: Some(Look::Solids), ..self }
    }

    /// Returns the object.
    pub(super) fn object(self) -> Object {
        self.object
    }

    /// Tells whether it is seen in a view that shows these objects.
    pub(super) fn is_shown(self, shown: Objects) -> bool {
        let has_look = match self.look {
            None => true,
            Some(Look::Edges) => shown.contains(Object::Wireframe),
            Some(Look::Solids) => !shown.contains(Object::Wireframe),
        };
        has_look && shown.contains(self.object)
    }
}

/// A list of instances in drawing order that knows what each is a part of.
#[derive(Clone, Debug)]
pub(super) struct Listed<T> {
    pub(super) items: Vec<T>,
    /// What each run is of and the index after its last item; the ends grow.
    runs: Vec<(Part, u32)>,
}

impl<T> Default for Listed<T> {
    fn default() -> Self {
        Self { items: Vec::new(), runs: Vec::new() }
    }
}

impl<T> Listed<T> {
    /// Adds an instance at the end.
    pub(super) fn push(&mut self, part: Part, item: T) {
        self.items.push(item);
        let end = self.items.len() as u32;
        match self.runs.last_mut() {
            Some((last, run_end)) if *last == part => *run_end = end,
            _ => self.runs.push((part, end)),
        }
    }
}

#[cfg(test)]
impl<T> Listed<T> {
    /// Counts the instances that a view draws.
    pub(super) fn count(&self, shown: Objects) -> usize {
        ranges(&self.runs, shown).into_iter().map(|range| range.len()).sum()
    }
}

/// Returns the ranges of instances that are shown, as few as there can be.
fn ranges(runs: &[(Part, u32)], shown: Objects) -> Vec<Range<u32>> {
    let mut ranges: Vec<Range<u32>> = Vec::new();
    let mut start = 0;
    for &(part, end) in runs {
        if part.is_shown(shown) {
            match ranges.last_mut() {
                Some(last) if last.end == start => last.end = end,
                _ => ranges.push(start..end),
            }
        }
        start = end;
    }
    ranges
}

/// A listed list on the device.
pub(super) struct ListedInstances {
    instances: Instances,
    runs: Vec<(Part, u32)>,
}

impl ListedInstances {
    /// Makes an empty list.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn new(device: &Rc<Device>) -> Result<Self, GpuError> {
        Ok(Self { instances: Instances::new(device)?, runs: Vec::new() })
    }

    /// Replaces the list; the device must not be reading it.
    ///
    /// # Errors
    ///
    /// When memory has run out.
    pub(super) fn set<T: Pod>(&mut self, list: &Listed<T>) -> Result<(), GpuError> {
        self.instances.set(&list.items)?;
        self.runs.clone_from(&list.runs);
        Ok(())
    }

    /// Returns the buffer.
    pub(super) fn handle(&self) -> vk::Buffer {
        self.instances.handle()
    }

    /// Returns the ranges of instances to draw, none of them empty nor beyond the buffer.
    pub(super) fn ranges(&self, shown: Objects) -> Vec<Range<u32>> {
        ranges(&self.runs, shown)
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Lists as many items as characters, `g` of the ground, `f` of footprints, `t` of traces, and returns what of them
    /// is drawn when the ground and the traces are shown.
    fn drawn(objects: &str) -> Vec<(u32, u32)> {
        let mut list = Listed::default();
        for c in objects.chars() {
            let role = match c {
                'g' => Role::Ground,
                'f' => Role::Footprint,
                _ => Role::Trace,
            };
            list.push(Part::of(role), c);
        }
        assert_eq!(list.items.iter().collect::<String>(), objects);
        let shown = Objects::NONE.with(Object::Ground).with(Object::Traces);
        ranges(&list.runs, shown).into_iter().map(|range| (range.start, range.end)).collect()
    }

    #[test]
    fn shown_runs_are_drawn_and_neighbours_at_once() {
        assert_eq!(drawn(""), []);
        assert_eq!(drawn("ff"), []);
        assert_eq!(drawn("ggfft"), [(0, 2), (4, 5)]);
        assert_eq!(drawn("fggttgff"), [(1, 6)]);
        assert_eq!(drawn("ggg"), [(0, 3)]);
    }
}
