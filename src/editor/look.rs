//! How things look: the camera's up, slow motion, and everything about the view as it came.

use glam::DVec3;
use toml::Value;

use super::{Editor, Effect, Message, ViewState, actions::set_camera, camera};
use crate::document::Change;

/// The clip's axes that a camera's up goes round, each with its name.
const UPS: [(DVec3, &str); 3] = [(DVec3::Y, "y"), (DVec3::Z, "z"), (DVec3::X, "x")];

/// An axis nearer to the line of sight than this, as the sine of the angle, is no up direction.
const ALONG_SIGHT: f64 = 0.05;

/// Takes the clip's next axis for the camera's up: y, z, x; one along the line of sight is passed over.
pub(super) fn next_up(editor: &mut Editor, command: &'static str) -> Effect {
    let to_file = |v: DVec3| editor.document.solved().clip.facts.up.value.to_file(v);
    let preset = camera::of(editor);
    let (up, sight) = (to_file(preset.up), to_file(preset.target - preset.eye).normalize());
    let now =
        (0..UPS.len()).max_by(|&a, &b| UPS[a].0.dot(up).abs().total_cmp(&UPS[b].0.dot(up).abs())).expect("three axes");
    let following = (1..=UPS.len()).map(|step| UPS[(now + step) % UPS.len()]);
    let (axis, name) =
        following.into_iter().find(|(axis, _)| axis.cross(sight).length() > ALONG_SIGHT).expect("two of three");
    set_camera(editor, command, "up", Value::Array(axis.to_array().map(Value::Float).to_vec()));
    editor.say(Message::note(format!("camera {}: {name} is up", editor.view.camera_idx + 1)));
    Effect::None
}

/// Goes into slow motion, or out of it.
pub(super) fn slow_motion(editor: &mut Editor) -> Effect {
    editor.view.slow_motion = !editor.view.slow_motion;
    let how = match (editor.view.slow_motion, editor.document.edits().interpolation_keys) {
        (false, _) => "slow motion off",
        (true, Some(_)) => "slow motion: ten times slower between the interpolation keys",
        (true, None) => "slow motion: no frame is skipped",
    };
    editor.say(Message::note(how.to_owned()));
    Effect::None
}

/// Puts all that is looked at back to how it came: cameras, what is drawn, speed (one step of undo), playhead, tabs and
/// selections.
pub(super) fn reset(editor: &mut Editor, command: &'static str) -> Effect {
    editor.change(command, &Change::ResetView);
    editor.end_step();
    // Keys go on acting on the window they are pressed in.
    let window = editor.view.window;
    editor.view = ViewState::new(editor.document.solved());
    editor.view.window = window;
    editor.follow_document();
    editor.say(Message::note("the view is as it came; u takes cameras, show and speed back".to_owned()));
    Effect::None
}
