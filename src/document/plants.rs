//! The user's plants: one key press changes a foot's plants as they are seen, and what then differs from the found
//! ones is recorded in the edits.

use super::{Edits, Solved, feet::file_frames};
use crate::{
    contact::{FootPlants, PlantChange, recorded},
    motion::Side,
};

/// A change of plants that cannot be made.
#[derive(Clone, Copy, Debug, PartialEq, Eq, thiserror::Error)]
pub enum PlantRefusal {
    /// The clip has no such foot.
    #[error("the clip has no leg on that side; `clip.legs` names the legs")]
    NoFoot,
    /// An end of a plant is at the plant's other end, next to another plant or at an end of the clip.
    #[error("that end of the plant cannot move further")]
    NoRoom,
    /// The frame is not inside a plant.
    #[error("a plant is split at a frame between its first and its last; move the playhead there")]
    NotInside,
    /// There is no plant after this one.
    #[error("there is no next plant to join")]
    NoNext,
    /// There is no such plant.
    #[error("there is no such plant")]
    NoPlant,
    /// The foot stands already.
    #[error("the foot stands here already, or in the frame before or after")]
    Taken,
    /// The user has changed nothing there.
    #[error("nothing to take back: the plants here are as found")]
    AsFound,
}

/// Changes a foot's plants.
///
/// # Errors
///
/// When there is nothing to change or no room for it.
pub(super) fn change(solved: &Solved, edits: &mut Edits, foot: Side, change: PlantChange) -> Result<(), PlantRefusal> {
    let [found, now] = found_and_now(solved, foot)?;
    let wanted = change.apply(&now.plants, solved.clip.n_frames());
    let wanted = match (wanted, change) {
        (Some(wanted), _) => wanted,
        // A mode that the plant has already is no failure.
        (None, PlantChange::SetMode { plant, .. }) if plant < now.plants.len() => return Ok(()),
        (None, PlantChange::MoveFirst { .. } | PlantChange::MoveLast { .. }) => return Err(PlantRefusal::NoRoom),
        (None, PlantChange::Split { .. }) => return Err(PlantRefusal::NotInside),
        (None, PlantChange::Join { .. }) => return Err(PlantRefusal::NoNext),
        (None, PlantChange::Add { .. }) => return Err(PlantRefusal::Taken),
        (None, PlantChange::Delete { .. } | PlantChange::SetMode { .. }) => return Err(PlantRefusal::NoPlant),
    };
    edits.edited_plants = recorded(&edits.edited_plants, foot, &found.plants, &wanted, file_frames(&solved.clip));
    Ok(())
}

/// Takes back what the user did to one plant of a foot, or to all.
///
/// # Errors
///
/// When there is nothing to take back.
pub(super) fn as_found(
    solved: &Solved,
    edits: &mut Edits,
    foot: Side,
    plant: Option<usize>,
) -> Result<(), PlantRefusal> {
    let [_, now] = found_and_now(solved, foot)?;
    let range = match plant {
        Some(plant) => file_frames(&solved.clip).of(now.plants.get(plant).ok_or(PlantRefusal::NoPlant)?),
        None => [0, usize::MAX],
    };
    let before = edits.edited_plants.len();
    edits.edited_plants.retain(|edit| edit.foot != foot || edit.last < range[0] || range[1] < edit.first);
    if edits.edited_plants.len() == before { Err(PlantRefusal::AsFound) } else { Ok(()) }
}

/// Returns a foot's plants as found and as they are now.
fn found_and_now(solved: &Solved, foot: Side) -> Result<[&FootPlants; 2], PlantRefusal> {
    let idx = solved.feet.foot_idx(foot).ok_or(PlantRefusal::NoFoot)?;
    Ok([&solved.feet.found.plants[idx], &solved.feet.plants[idx]])
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{
        contact::{PlantEdit, PlantEditMode, PlantMode},
        document::{Change, Document, open},
    };

    fn document() -> Document {
        Document::new(open(None).expect("the built-in clip"))
    }

    fn left(document: &Document) -> Vec<(usize, usize, PlantMode)> {
        let feet = &document.solved().feet;
        let foot = &feet.plants[feet.foot_idx(Side::Left).expect("a left leg")];
        foot.plants.iter().map(|p| (p.first, p.last, p.mode)).collect()
    }

    fn apply(document: &mut Document, change: PlantChange) {
        document.apply(&Change::Plant { foot: Side::Left, change }, false).expect("a change of plants");
    }

    #[test]
    fn the_users_plants_survive_every_later_edit_and_undo_takes_them_back() {
        let mut document = document();
        let found = left(&document);
        apply(&mut document, PlantChange::MoveFirst { plant: 1, by: 2 });
        apply(&mut document, PlantChange::SetMode { plant: 1, mode: PlantMode::Clean });
        apply(&mut document, PlantChange::Delete { plant: 3 });
        let (first, last, _) = found[1];
        let mut wanted = found.clone();
        wanted[1] = (first + 2, last, PlantMode::Clean);
        wanted.remove(3);
        assert_eq!(left(&document), wanted);
        let set = |name: &str, value: toml::Value| Change::Set { values: vec![(name.to_owned(), value)], shape: None };
        for change in [
            set("plants.height", 0.07.into()),
            set("original.degree", 7.into()),
            set("path.points", 12.into()),
            set("path.edited", false.into()),
            Change::Set { values: Vec::new(), shape: Some("s".parse().expect("a shape")) },
        ] {
            document.apply(&change, false).expect("a change");
            assert_eq!(left(&document)[1], wanted[1], "after {change:?}");
            assert_eq!(left(&document).len(), wanted.len(), "after {change:?}");
        }
        while document.undo() {}
        assert_eq!(left(&document), found);
    }

    #[test]
    fn what_the_user_did_is_taken_back_plant_by_plant_or_for_the_foot() {
        let mut document = document();
        let found = left(&document);
        apply(&mut document, PlantChange::MoveFirst { plant: 1, by: 2 });
        apply(&mut document, PlantChange::Delete { plant: 3 });
        let right = PlantEdit { foot: Side::Right, first: 0, last: 3, mode: PlantEditMode::Slide };
        let mut edits = document.edits().edited_plants.clone();
        assert_eq!(edits.len(), 2);
        edits.push(right);
        let value = crate::document::parameter("plant").expect("a row");
        let mut with_right = (**document.edits()).clone();
        with_right.edited_plants = edits;
        let set = Change::Set { values: vec![("plant".to_owned(), value.get(&with_right))], shape: None };
        document.apply(&set, false).expect("a list of plants");
        let back = |plant| Change::PlantsAsFound { foot: Side::Left, plant };
        document.apply(&back(Some(1)), false).expect("taken back");
        assert_eq!(left(&document)[1], found[1]);
        assert_eq!(document.apply(&back(Some(1)), false), Err(PlantRefusal::AsFound.into()));
        document.apply(&back(None), false).expect("taken back");
        assert_eq!(left(&document), found);
        assert_eq!(document.edits().edited_plants, [right], "the other foot's stay");
    }

    #[test]
    fn what_cannot_be_done_is_said_and_nothing_changes() {
        let mut document = document();
        let (first, last, mode) = left(&document)[1];
        let n = left(&document).len();
        for (change, refusal) in [
            (PlantChange::Split { frame: first }, PlantRefusal::NotInside),
            (PlantChange::Join { plant: n - 1 }, PlantRefusal::NoNext),
            (PlantChange::Delete { plant: n }, PlantRefusal::NoPlant),
            (PlantChange::Add { first: last + 1, last: last + 9 }, PlantRefusal::Taken),
            (PlantChange::MoveFirst { plant: 0, by: -1 }, PlantRefusal::NoRoom),
        ] {
            let change = Change::Plant { foot: Side::Left, change };
            assert_eq!(document.apply(&change, false), Err(refusal.into()), "{change:?}");
        }
        apply(&mut document, PlantChange::SetMode { plant: 1, mode });
        assert_eq!(document.depth(), (0, 0), "a mode that it has already is no step");
    }
}
