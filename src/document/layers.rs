//! What is done to the list of layers and to their keys.

use super::{Edits, Solved};
use crate::displace::{Interpolation, Layer, Selection, Stack, find_joint, merge};

/// Something done to the list of layers. Layers are named by their place in the list, bottom to top.
#[derive(Clone, Debug, PartialEq)]
pub enum LayerChange {
    /// A new layer above all others; an empty name takes the next free `layer N`.
    Add {
        /// Its name.
        name: String,
    },
    /// A layer is taken out of the list.
    Delete {
        /// Which.
        layer_idx: usize,
    },
    /// A layer gets another name.
    Rename {
        /// Which.
        layer_idx: usize,
        /// The name.
        name: String,
    },
    /// A layer is switched on or off.
    Switch {
        /// Which.
        layer_idx: usize,
        /// On or off.
        on: bool,
    },
    /// A layer takes effect by another share.
    Weigh {
        /// Which.
        layer_idx: usize,
        /// The share; brought to 0 to 1.
        weight: f64,
    },
    /// A layer's rotations go from key to key in another way.
    Interpolate {
        /// Which.
        layer_idx: usize,
        /// The way.
        interpolation: Interpolation,
    },
    /// A layer changes places with the one above or below it; merged ones keep theirs, below all others.
    Move {
        /// Which.
        layer_idx: usize,
        /// Above or below.
        up: bool,
    },
    /// A layer becomes part of the motion, with all that is in effect below it.
    Merge {
        /// Which.
        layer_idx: usize,
    },
    /// All position keys of a layer are taken away.
    ClearPosition {
        /// Which.
        layer_idx: usize,
    },
    /// All rotation keys of a layer are taken away.
    ClearRotations {
        /// Which.
        layer_idx: usize,
    },
}

/// Something done to the selected maps' keys of a layer. Frames are those of the file.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum KeyChange {
    /// Keys that change no pose at the frame; keys that are there stay.
    Add {
        /// Where.
        frame: usize,
    },
    /// Keys are taken away.
    Delete {
        /// Where.
        frame: usize,
    },
    /// Keys are copied, over those that are there.
    Copy {
        /// From where.
        from: usize,
        /// To where.
        to: usize,
    },
    /// Keys are moved, over those that are there.
    Move {
        /// From where.
        from: usize,
        /// To where.
        to: usize,
    },
}

/// A change of layers, keys or poses that cannot be made.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum LayerRefusal {
    /// The list has no such layer.
    #[error("there is no such layer")]
    NoLayer,
    /// The layer is part of the motion; others lie above it.
    #[error("layer `{0}` is merged into the motion; edit a layer above it")]
    Merged(String),
    /// The layer is part of the motion, and so are all others.
    #[error("layer `{0}` is merged into the motion; edits need a new layer above it")]
    AllMerged(String),
    /// The layer is off and cannot be merged or show an edit.
    #[error("layer `{0}` is off; switch it on first")]
    Off(String),
    /// The layer has too little weight to show what is wanted.
    #[error("layer `{0}` has too little weight to show that; raise its weight")]
    Weight(String),
    /// There is nothing above or below.
    #[error("the layer cannot move further")]
    NoRoom,
    /// The layer is part of the motion where it lies.
    #[error("layer `{0}` is merged into the motion and keeps its place")]
    Fixed(String),
    /// The layer would change places with one that is part of the motion.
    #[error("layer `{0}` is merged into the motion: no other layer changes places with it")]
    InTheWay(String),
    /// None of the selected maps has a key at the frame.
    #[error("none of the selected maps has a key at file frame {0}")]
    NoKey(usize),
    /// Nothing that can be displaced is selected.
    #[error("nothing is selected that can be moved or turned: select joints first")]
    NothingSelected,
    /// The frame is outside the clip.
    #[error("file frame {frame} is outside the clip, which has {first} to {last}")]
    Outside {
        /// The frame.
        frame: usize,
        /// First frame that can have keys.
        first: usize,
        /// Last one.
        last: usize,
    },
    /// A joint that no map can turn.
    #[error("{0} cannot be turned: it lacks rotation channels, or the carrier hangs below it")]
    Stiff(String),
    /// All joints that may turn are where the joint is that is to move.
    #[error("turning the selected joints does not move {0}: they are where it is")]
    AtOnePlace(String),
    /// The carrier cannot be moved.
    #[error("the carrier cannot be moved: it lacks position channels")]
    CarrierStays,
}

/// Changes the list of layers. A merged layer keeps what it does: it gets another name or goes as a whole.
///
/// # Errors
///
/// When there is no such layer or it cannot be done.
pub(super) fn change(edits: &mut Edits, change: &LayerChange) -> Result<(), LayerRefusal> {
    let layers = &mut edits.layers;
    match change {
        LayerChange::Add { name } => {
            let name = if name.is_empty() { free_name(layers) } else { name.clone() };
            layers.push(Layer::new(name));
        }
        LayerChange::Delete { layer_idx } => {
            at(layers, *layer_idx)?;
            layers.remove(*layer_idx);
        }
        LayerChange::Rename { layer_idx, name } => at(layers, *layer_idx)?.name.clone_from(name),
        LayerChange::Switch { layer_idx, on } => unmerged(layers, *layer_idx)?.on = *on,
        LayerChange::Weigh { layer_idx, weight } => unmerged(layers, *layer_idx)?.weight = weight.clamp(0.0, 1.0),
        LayerChange::Interpolate { layer_idx, interpolation } => {
            unmerged(layers, *layer_idx)?.interpolation = *interpolation;
        }
        LayerChange::Move { layer_idx, up } => {
            let layer = at(layers, *layer_idx)?;
            if layer.merged {
                return Err(LayerRefusal::Fixed(layer.name.clone()));
            }
            let other = if *up { Some(layer_idx + 1) } else { layer_idx.checked_sub(1) };
            let other = other.filter(|&other| other < layers.len()).ok_or(LayerRefusal::NoRoom)?;
            if layers[other].merged {
                return Err(LayerRefusal::InTheWay(layers[other].name.clone()));
            }
            layers.swap(*layer_idx, other);
        }
        LayerChange::Merge { layer_idx } => {
            let name = unmerged(layers, *layer_idx)?.name.clone();
            if !merge(layers, *layer_idx) {
                return Err(LayerRefusal::Off(name));
            }
        }
        LayerChange::ClearPosition { layer_idx } => unmerged(layers, *layer_idx)?.clear_position(),
        LayerChange::ClearRotations { layer_idx } => unmerged(layers, *layer_idx)?.clear_rotations(),
    }
    Ok(())
}

/// Changes keys of a layer; one that does not exist yet is made for the first keys.
///
/// # Errors
///
/// When there are none, or the layer cannot be edited.
pub(super) fn change_keys(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    selection: &Selection,
    change: KeyChange,
) -> Result<(), LayerRefusal> {
    let frames = match change {
        KeyChange::Add { frame } => [frame; 2],
        KeyChange::Delete { frame } => return delete_keys(edits, layer_idx, selection, frame),
        KeyChange::Copy { from, to } | KeyChange::Move { from, to } => [from, to],
    };
    let clip = &solved.clip;
    let (first, last) = (clip.rest_frames(), clip.n_file_frames() - 1);
    if let Some(frame) = frames.into_iter().find(|frame| !(first..=last).contains(frame)) {
        return Err(LayerRefusal::Outside { frame, first, last });
    }
    match change {
        KeyChange::Add { frame } => add_keys(solved, edits, layer_idx, selection, frame),
        KeyChange::Copy { from, to } => had_keys(editable(edits, layer_idx)?.copy_keys(selection, from, to), from),
        KeyChange::Move { from, to } => had_keys(editable(edits, layer_idx)?.move_keys(selection, from, to), from),
        KeyChange::Delete { frame } => delete_keys(edits, layer_idx, selection, frame),
    }
}

fn delete_keys(edits: &mut Edits, layer_idx: usize, selection: &Selection, frame: usize) -> Result<(), LayerRefusal> {
    had_keys(editable(edits, layer_idx)?.delete_keys(selection, frame), frame)
}

fn had_keys(any: bool, frame: usize) -> Result<(), LayerRefusal> {
    if any { Ok(()) } else { Err(LayerRefusal::NoKey(frame)) }
}

/// Adds keys that hold what the selected maps hold at a frame anyway.
fn add_keys(
    solved: &Solved,
    edits: &mut Edits,
    layer_idx: usize,
    selection: &Selection,
    file_frame: usize,
) -> Result<(), LayerRefusal> {
    editable(edits, layer_idx)?;
    let clip = &*solved.clip;
    let stack = Stack { clip, base: &solved.posed.base.joints, layers: &edits.layers };
    let frame = file_frame - clip.rest_frames();
    let mut layer = edits.layers[layer_idx].clone();
    let mut any = false;
    for name in &selection.joints {
        let Some(joint) = find_joint(&clip.skeleton, name).filter(|&joint| crate::displace::can_turn(clip, joint))
        else {
            continue;
        };
        any = true;
        if layer.rotation.get(name).and_then(|keys| keys.get(file_frame)).is_none() {
            layer.set_rotation(name, file_frame, stack.rotation_here(layer_idx, joint, frame));
        }
    }
    if selection.position && clip.facts.path_editable {
        any = true;
        if layer.position.get(file_frame).is_none() {
            layer.position.set(file_frame, stack.position_here(layer_idx, frame));
        }
    }
    if !any {
        return Err(LayerRefusal::NothingSelected);
    }
    edits.layers[layer_idx] = layer;
    Ok(())
}

/// Returns a layer whose keys may be changed; the first one is made when there is none yet.
pub(super) fn editable(edits: &mut Edits, layer_idx: usize) -> Result<&mut Layer, LayerRefusal> {
    if edits.layers.is_empty() && layer_idx == 0 {
        edits.layers.push(Layer::new(free_name(&[])));
    }
    unmerged(&mut edits.layers, layer_idx)
}

/// Returns a layer that is not part of the motion.
fn unmerged(layers: &mut [Layer], layer_idx: usize) -> Result<&mut Layer, LayerRefusal> {
    let all_merged = layers.iter().all(|layer| layer.merged);
    let layer = at(layers, layer_idx)?;
    match (layer.merged, all_merged) {
        (false, _) => Ok(layer),
        (true, false) => Err(LayerRefusal::Merged(layer.name.clone())),
        (true, true) => Err(LayerRefusal::AllMerged(layer.name.clone())),
    }
}

fn at(layers: &mut [Layer], layer_idx: usize) -> Result<&mut Layer, LayerRefusal> {
    layers.get_mut(layer_idx).ok_or(LayerRefusal::NoLayer)
}

fn free_name(layers: &[Layer]) -> String {
    let names = (1..).map(|n| format!("layer {n}"));
    names.into_iter().find(|name| layers.iter().all(|layer| layer.name != *name)).expect("numbers do not end")
}
