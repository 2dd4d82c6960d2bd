//! The live score: what the feet do while they stand, source → now, beside the editor's state.
//!
//! It is said as fully as the line has room for: with slips, per body height, in the clip's unit. `…` after it: the edits
//! have changed since and are being measured.

use super::text;
use crate::{
    contact::FootPlants,
    document::Solved,
    editor::Editor,
    measure::{FootNumbers, Pair},
    motion::Side,
};

/// Returns the two ends of the status line: the score and the state, the fullest pair that fits.
pub(super) fn fitting(editor: &Editor, width: usize) -> (String, String) {
    let solved = editor.document().solved();
    let mut scores = scores(solved);
    let is_of_feet = !solved.feet.plants.is_empty();
    if !(if is_of_feet { solved.has_feet_measured() } else { solved.is_measured() }) {
        scores.iter_mut().for_each(|score| score.push_str(" …"));
    }
    let states = [state(editor), playback(editor), sign(editor).to_owned()];
    let pairs = scores.iter().flat_map(|score| states.iter().map(move |state| (score, state)));
    let fits = |(score, state): &(&String, &String)| text::width(score) + text::width(state) < width;
    let (score, state) = pairs.clone().find(fits).or_else(|| pairs.last()).expect("there is a score");
    (score.clone(), state.clone())
}

/// One letter for the side of a foot.
pub(super) fn side(foot: &FootPlants) -> &'static str {
    if foot.leg.side == Side::Left { "L" } else { "R" }
}

/// Returns the score, fullest first.
fn scores(solved: &Solved) -> Vec<String> {
    let facts = &solved.clip.facts;
    let (height, unit) = (facts.height.value, facts.unit_word());
    let speeds = |scale| all_feet(solved, |n| n.planted_speed, scale);
    if speeds(1.0).is_empty() {
        let jerk = solved.measures.jerk_ratio.map_or_else(|| "–".to_owned(), |r| format!("{r:.3}"));
        return vec![format!("jerk ratio {jerk}")];
    }
    let slips = |scale| all_feet(solved, |n| n.slip_p90, scale);
    let missed = match solved.holding.as_ref().map_or(0, |holding| holding.missed.len()) {
        0 => String::new(),
        n => format!(" · {n} missed"),
    };
    let short = format!("feet {} H/s{missed}", speeds(1.0));
    let slip = format!("slip {} H{missed}", slips(1.0));
    vec![
        format!(
            "feet {} H/s, {} {unit}/s · slip {} H, {} {unit}{missed}",
            speeds(1.0),
            speeds(height),
            slips(1.0),
            slips(height)
        ),
        format!("feet {} H/s · {slip}", speeds(1.0)),
        format!("{} H/s · {slip}", speeds(1.0)),
        short,
    ]
}

/// Returns a number of each foot that has it, source → edited, times a scale.
fn all_feet(solved: &Solved, number: impl Fn(&FootNumbers) -> Option<Pair>, scale: f64) -> String {
    let feet = solved.feet.plants.iter().zip(solved.foot_numbers.iter());
    let decimals = if scale.abs() < 10.0 { 3 } else { 1 };
    let told: Vec<String> = feet
        .filter_map(|(foot, numbers)| Some((foot, number(numbers)?)))
        .map(|(foot, Pair { source, edited })| {
            format!("{} {:.decimals$}→{:.decimals$}", side(foot), source * scale, edited * scale)
        })
        .collect();
    told.join(" ")
}

fn state(editor: &Editor) -> String {
    let view = editor.view();
    let pending: String = editor.pending().iter().map(ToString::to_string).collect();
    let (point, camera) = (view.point_idx + 1, view.camera_idx + 1);
    format!("{pending}  point {point}  {}camera {camera}  {}", editor.view_in_focus(), playback(editor))
}

fn playback(editor: &Editor) -> String {
    let view = editor.view();
    let solved = editor.document().solved();
    let rest = solved.clip.rest_frames();
    format!("frame {}/{}  {}", view.frame_idx + rest, solved.edited.n_frames() + rest - 1, sign(editor))
}

fn sign(editor: &Editor) -> &'static str {
    match (editor.view().playing, editor.view().slow_motion) {
        (true, false) => "▶ playing",
        (true, true) => "▶ slow",
        (false, false) => "‖ paused",
        (false, true) => "‖ slow",
    }
}
