//! One change to a foot's list of plants, as a value.

use super::{Plant, PlantMode};

/// What a user does to a foot's plants. Plants are named by their index in the list.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PlantChange {
    /// Moves a plant's first frame, as far as there is room.
    MoveFirst {
        /// Index of the plant.
        plant: usize,
        /// Frames, later is positive.
        by: isize,
    },
    /// Moves a plant's last frame, as far as there is room.
    MoveLast {
        /// Index of the plant.
        plant: usize,
        /// Frames, later is positive.
        by: isize,
    },
    /// Cuts the plant that holds this frame in two; the frame itself is in neither.
    Split {
        /// Frame inside a plant, neither its first nor its last.
        frame: usize,
    },
    /// Makes one plant of this one and the next, with the mode of this one.
    Join {
        /// Index of the first of the two.
        plant: usize,
    },
    /// Takes a plant away.
    Delete {
        /// Index of the plant.
        plant: usize,
    },
    /// Puts a plant where the foot has none; it ends where it would touch another.
    Add {
        /// First frame, in no plant and next to none.
        first: usize,
        /// Last frame.
        last: usize,
    },
    /// Changes what is done with a plant.
    SetMode {
        /// Index of the plant.
        plant: usize,
        /// From now on.
        mode: PlantMode,
    },
}

impl PlantChange {
    /// Returns the changed list; none when there is nothing to change: no such plant, no room, no difference.
    ///
    /// Every list keeps order and at least one free frame between two plants, so that a foot has time to swing.
    pub fn apply(self, plants: &[Plant], n_frames: usize) -> Option<Vec<Plant>> {
        let mut changed = plants.to_vec();
        match self {
            Self::MoveFirst { plant, by } => {
                let room = room(plants, plant, n_frames)?;
                let moved = &mut changed[plant];
                moved.first = moved.first.saturating_add_signed(by).clamp(room.0, moved.last);
            }
            Self::MoveLast { plant, by } => {
                let room = room(plants, plant, n_frames)?;
                let moved = &mut changed[plant];
                moved.last = moved.last.saturating_add_signed(by).clamp(moved.first, room.1);
            }
            Self::Split { frame } => {
                let at = plants.iter().position(|p| p.first < frame && frame < p.last)?;
                changed[at].last = frame - 1;
                changed.insert(at + 1, Plant { first: frame + 1, ..plants[at] });
            }
            Self::Join { plant } => {
                changed.get_mut(plant)?.last = plants.get(plant + 1)?.last;
                changed.remove(plant + 1);
            }
            Self::Delete { plant } => {
                plants.get(plant)?;
                changed.remove(plant);
            }
            Self::Add { first, last } => {
                let at = plants.partition_point(|p| p.first <= first);
                changed.insert(at, Plant::new(first, first));
                let room = room(&changed, at, n_frames)?;
                if first < room.0 || first > room.1 {
                    return None;
                }
                changed[at].last = last.clamp(first, room.1);
            }
            Self::SetMode { plant, mode } => changed.get_mut(plant)?.mode = mode,
        }
        (changed != plants).then_some(changed)
    }
}

/// Returns the earliest first and the latest last frame a plant may have; none without such a plant.
fn room(plants: &[Plant], plant: usize, n_frames: usize) -> Option<(usize, usize)> {
    plants.get(plant)?;
    let earliest = plant.checked_sub(1).map_or(0, |before| plants[before].last + 2);
    let latest = match plants.get(plant + 1) {
        Some(after) => after.first.checked_sub(2)?,
        None => n_frames.checked_sub(1)?,
    };
    Some((earliest, latest))
}

#[cfg(test)]
mod tests {
    use super::*;

    /// Frames of the clip in these tests.
    const N_FRAMES: usize = 100;

    /// Applies a change to plants 10–20, 30–40 and 60–80 and compares the ranges.
    #[track_caller]
    fn check(change: PlantChange, wanted: Option<&[(usize, usize)]>) {
        let plants = [Plant::new(10, 20), Plant::new(30, 40), Plant::new(60, 80)];
        let changed = change.apply(&plants, N_FRAMES);
        let ranges: Option<Vec<_>> = changed.map(|plants| plants.iter().map(|p| (p.first, p.last)).collect());
        assert_eq!(ranges.as_deref(), wanted, "{change:?}");
    }

    #[test]
    fn ends_move_as_far_as_there_is_room() {
        use PlantChange::{MoveFirst, MoveLast};
        check(MoveFirst { plant: 1, by: 1 }, Some(&[(10, 20), (31, 40), (60, 80)]));
        check(MoveFirst { plant: 1, by: -100 }, Some(&[(10, 20), (22, 40), (60, 80)]));
        check(MoveFirst { plant: 1, by: 100 }, Some(&[(10, 20), (40, 40), (60, 80)]));
        check(MoveFirst { plant: 0, by: -100 }, Some(&[(0, 20), (30, 40), (60, 80)]));
        check(MoveLast { plant: 1, by: -2 }, Some(&[(10, 20), (30, 38), (60, 80)]));
        check(MoveLast { plant: 1, by: 100 }, Some(&[(10, 20), (30, 58), (60, 80)]));
        check(MoveLast { plant: 2, by: 100 }, Some(&[(10, 20), (30, 40), (60, 99)]));
        check(MoveLast { plant: 2, by: -100 }, Some(&[(10, 20), (30, 40), (60, 60)]));
        check(MoveLast { plant: 2, by: 0 }, None);
        check(MoveLast { plant: 3, by: 1 }, None);
    }

    #[test]
    fn plants_are_split_and_joined() {
        use PlantChange::{Join, Split};
        check(Split { frame: 35 }, Some(&[(10, 20), (30, 34), (36, 40), (60, 80)]));
        for outside in [30, 40, 50, 99] {
            check(Split { frame: outside }, None);
        }
        check(Join { plant: 0 }, Some(&[(10, 40), (60, 80)]));
        check(Join { plant: 2 }, None);
        check(Join { plant: 7 }, None);
    }

    #[test]
    fn plants_come_and_go() {
        use PlantChange::{Add, Delete};
        check(Delete { plant: 1 }, Some(&[(10, 20), (60, 80)]));
        check(Delete { plant: 3 }, None);
        check(Add { first: 45, last: 50 }, Some(&[(10, 20), (30, 40), (45, 50), (60, 80)]));
        check(Add { first: 45, last: 70 }, Some(&[(10, 20), (30, 40), (45, 58), (60, 80)]));
        check(Add { first: 90, last: 500 }, Some(&[(10, 20), (30, 40), (60, 80), (90, 99)]));
        check(Add { first: 0, last: 3 }, Some(&[(0, 3), (10, 20), (30, 40), (60, 80)]));
        for taken in [9, 15, 21, 41, 59, 81, 100] {
            check(Add { first: taken, last: taken + 1 }, None);
        }
    }

    #[test]
    fn modes_change_and_survive_a_split() {
        let plants = [Plant::new(10, 20)];
        let slide = PlantChange::SetMode { plant: 0, mode: PlantMode::Slide };
        let sliding = slide.apply(&plants, N_FRAMES).expect("a new mode");
        assert_eq!(slide.apply(&sliding, N_FRAMES), None, "the same again is no change");
        let halves = PlantChange::Split { frame: 15 }.apply(&sliding, N_FRAMES).expect("two halves");
        assert!(halves.iter().all(|p| p.mode == PlantMode::Slide));
        assert_eq!(PlantChange::SetMode { plant: 1, mode: PlantMode::Clean }.apply(&plants, N_FRAMES), None);
    }
}
