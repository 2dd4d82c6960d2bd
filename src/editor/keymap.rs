//! From key presses to commands: whole sequences are matched, unfinished ones wait and show what may follow.

use super::{COMMANDS, Command, Editor, Effect, Message, TABS, command::Group, feet, pose};
use crate::key::{Code, Key};

/// What helps where nothing more is known.
const ANY_KEY: &str = "? shows the keys";

/// One line of the help: keys that work now and what they do.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Hint {
    /// Heading the line stands under.
    pub group: Group,
    /// Key texts, the rest of the sequence if one has begun.
    pub keys: Vec<String>,
    /// What they do, one line.
    pub doc: &'static str,
}

/// Acts on a key outside a prompt.
pub(super) fn press(editor: &mut Editor, key: Key) -> Effect {
    if let Some(scroll) = editor.view.help {
        editor.view.help = match key.code {
            Code::Down | Code::Char('j') => Some(scroll + 1),
            Code::Up | Code::Char('k') => Some(scroll.saturating_sub(1)),
            Code::PageDown | Code::Char(' ') => Some(scroll + 10),
            Code::PageUp => Some(scroll.saturating_sub(10)),
            _ => None,
        };
        return Effect::None;
    }
    editor.pending.push(key);
    let pending = std::mem::take(&mut editor.pending);
    let mut unfinished = false;
    for command in COMMANDS.iter().filter(|c| (c.works)(editor)) {
        for keys in sequences(command) {
            if keys == pending {
                return run(editor, command);
            }
            unfinished |= keys.starts_with(&pending);
        }
    }
    // The rest of a sequence that does nothing here must not be taken for keys of its own.
    let begins = |command| sequences(command).any(|keys| keys.starts_with(&pending) && keys != pending);
    let swallows = !unfinished && COMMANDS.iter().any(begins);
    if unfinished {
        editor.pending = pending;
    } else if key.code != Code::Esc {
        let text: String = pending.iter().map(ToString::to_string).collect();
        let meant = |command: &&Command| sequences(command).any(|keys| keys.starts_with(&pending));
        let why = COMMANDS.iter().find(meant).map(|command| why_idle(editor, command));
        let why = why.unwrap_or_else(|| ANY_KEY.to_owned());
        editor.say(Message::note(format!("{text} does nothing here; {why}")));
        if swallows {
            editor.pending = pending;
        }
    }
    Effect::None
}

/// Says why a command does nothing now.
fn why_idle(editor: &Editor, command: &Command) -> String {
    let is_of_poses = command.name.starts_with("pose.") || command.name.starts_with("keys.");
    match (command.group, command.name) {
        (Group::Feet, _) => feet::why_idle(editor),
        (Group::Layers, _) => "there is no layer yet; Bn makes one".to_owned(),
        (_, "export.interpolated" | "interpolation.delete") => {
            "there are no interpolation keys; I sets them".to_owned()
        }
        _ if is_of_poses && !pose::is_open(editor) => "it does on the joints tab".to_owned(),
        _ => ANY_KEY.to_owned(),
    }
}

/// Runs a command; one that made no step ends the joining of steps.
fn run(editor: &mut Editor, command: &'static Command) -> Effect {
    editor.made_step = false;
    let effect = (command.run)(editor, command.name);
    if !editor.made_step {
        editor.end_step();
    }
    effect
}

fn sequences(command: &Command) -> impl Iterator<Item = Vec<Key>> + '_ {
    command.keys.iter().map(|text| Key::parse_sequence(text).expect("the command table's keys parse"))
}

/// Returns the keys that work now.
pub(super) fn hints(editor: &Editor) -> Vec<Hint> {
    // What the open tab is about comes first.
    let about = TABS[editor.view.tab_idx].groups();
    let mut commands: Vec<_> = COMMANDS.iter().filter(|c| (c.works)(editor)).collect();
    commands.sort_by_key(|c| about.iter().position(|group| *group == c.group).unwrap_or(about.len()));
    commands
        .into_iter()
        .filter_map(|command| {
            let rest = sequences(command).filter_map(|keys| {
                let rest = keys.strip_prefix(editor.pending.as_slice())?;
                Some(rest.iter().map(ToString::to_string).collect::<String>())
            });
            let keys: Vec<_> = rest.filter(|k| !k.is_empty()).collect();
            (!keys.is_empty()).then_some(Hint { group: command.group, keys, doc: command.doc })
        })
        .collect()
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::collections::HashMap;

    #[test]
    fn no_sequence_is_taken_twice_or_hides_another() {
        let mut taken: HashMap<Vec<Key>, &str> = HashMap::new();
        for command in COMMANDS {
            for keys in sequences(command) {
                for (other, name) in &taken {
                    let clash = keys.starts_with(other) || other.starts_with(&keys);
                    assert!(!clash, "{} and {name} share keys", command.name);
                }
                taken.insert(keys, command.name);
            }
        }
    }
}
