//! `walkabout export`: the edited clip as BVH.

use super::{
    Failure,
    args::{Clip, Output},
};

pub(super) fn run(clip: &Clip, output: &Output, interpolated: bool) -> Result<(), Failure> {
    super::check_free(&output.output, output.force)?;
    let mut document = super::open_loudly(clip)?;
    document.export(&output.output, interpolated)?;
    Ok(())
}
