//! The live score: what the feet do while they stand, source → now, beside the editor's state.
//!
//! It says planted speed and slip, per body height and in the clip's unit: in one row where the screen is wide, in two
//! where it is high enough. Where there is room for neither it says as much as there is room for. `…` after it: the edits
//! have changed since and are being measured.

use ratatui::layout::Size;

use super::text;
use crate::{
    contact::FootPlants,
    document::Solved,
    editor::Editor,
    measure::{FootNumbers, Pair},
    motion::Side,
};

/// From this many columns on one row has room for all of the score. It does not depend on the numbers, so that no row
/// comes and goes while they change.
const WIDE: u16 = 180;

/// From this many rows on a narrower screen has a second one for the score.
const HIGH: u16 = 24;

/// Returns how many rows of the screen the score and the state take.
pub(super) fn n_rows(editor: &Editor, screen: Size) -> u16 {
    let needs_two = screen.width < WIDE && has_feet(editor.document().solved());
    if needs_two && screen.height >= HIGH { 2 } else { 1 }
}

/// Returns the two ends of each of so many status lines, the uppermost first: the score and the state, the fullest that
/// fit.
pub(super) fn lines(editor: &Editor, width: usize, n_rows: u16) -> Vec<(String, String)> {
    let solved = editor.document().solved();
    let mut scores = if n_rows > 1 { vec![speeds(solved), slips(solved)] } else { vec![scores(solved)] };
    // Without feet the score is of the whole body.
    if !(if has_feet(solved) { solved.has_feet_measured() } else { solved.is_measured() }) {
        scores.iter_mut().flatten().for_each(|score| score.push_str(" …"));
    }
    let lower = scores.pop().expect("there is a row");
    let sign = sign(editor);
    let mut states = vec![state(editor), playback(editor), sign.to_owned()];
    if n_rows > 1 {
        // Shorter rather than less of a score that is said in full.
        states.push(sign.chars().take(1).collect());
    }
    let mut lines: Vec<_> = scores.iter().map(|upper| fitting(upper, &[String::new()], width)).collect();
    lines.push(fitting(&lower, &states, width));
    lines
}

/// Returns the first score with the first state that fits beside it; the last of both where nothing does.
fn fitting(scores: &[String], states: &[String], width: usize) -> (String, String) {
    let pairs = scores.iter().flat_map(|score| states.iter().map(move |state| (score, state)));
    let fits = |(score, state): &(&String, &String)| text::width(score) + text::width(state) < width;
    let (score, state) = pairs.clone().find(fits).or_else(|| pairs.last()).expect("there is a score");
    (score.clone(), state.clone())
}

/// One letter for the side of a foot.
pub(super) fn side(foot: &FootPlants) -> &'static str {
    if foot.leg.side == Side::Left { "L" } else { "R" }
}

fn has_feet(solved: &Solved) -> bool {
    !all_feet(solved, |n| n.planted_speed, 1.0).is_empty()
}

/// Returns the score in one row, fullest first.
fn scores(solved: &Solved) -> Vec<String> {
    if !has_feet(solved) {
        let jerk = solved.measures.jerk_ratio.map_or_else(|| "–".to_owned(), |r| format!("{r:.3}"));
        return vec![format!("jerk ratio {jerk}")];
    }
    let (height, unit) = (solved.clip.facts.height.value, solved.clip.facts.unit_word());
    let missed = missed(solved);
    let [speed, speed_in_unit] = [1.0, height].map(|scale| all_feet(solved, |n| n.planted_speed, scale));
    let [slip, slip_in_unit] = [1.0, height].map(|scale| all_feet(solved, |n| n.slip_p90, scale));
    vec![
        format!("feet {speed} H/s, {speed_in_unit} {unit}/s · slip {slip} H, {slip_in_unit} {unit}{missed}"),
        format!("feet {speed} H/s · slip {slip} H{missed}"),
        format!("{speed} H/s · slip {slip} H{missed}"),
        format!("feet {speed} H/s{missed}"),
    ]
}

/// Returns the upper of two rows, fullest first.
fn speeds(solved: &Solved) -> Vec<String> {
    let (height, unit) = (solved.clip.facts.height.value, solved.clip.facts.unit_word());
    let [speed, speed_in_unit] = [1.0, height].map(|scale| all_feet(solved, |n| n.planted_speed, scale));
    vec![format!("planted  {speed} H/s, {speed_in_unit} {unit}/s"), format!("planted  {speed} H/s")]
}

/// Returns the lower of two rows, fullest first.
fn slips(solved: &Solved) -> Vec<String> {
    let (height, unit) = (solved.clip.facts.height.value, solved.clip.facts.unit_word());
    let [slip, slip_in_unit] = [1.0, height].map(|scale| all_feet(solved, |n| n.slip_p90, scale));
    let missed = missed(solved);
    vec![
        format!("slip p90 {slip} H, {slip_in_unit} {unit}{missed}"),
        format!("slip {slip} H, {slip_in_unit} {unit}{missed}"),
        format!("slip {slip} H{missed}"),
    ]
}

/// Says how many plants were not reached, if any.
fn missed(solved: &Solved) -> String {
    match solved.holding.as_ref().map_or(0, |holding| holding.missed.len()) {
        0 => String::new(),
        n => format!(" · {n} missed"),
    }
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
