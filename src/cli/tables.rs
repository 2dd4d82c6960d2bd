//! `walkabout params` and `walkabout keys`: the tables, as Markdown.

use std::fmt::Write as _;

use crate::{
    document::{PARAMETERS, show_value},
    editor::COMMANDS,
};

/// Returns the parameter table.
pub(super) fn params() -> String {
    let mut out = "| name | values | unit | default | what it does |\n| --- | --- | --- | --- | --- |\n".to_owned();
    for p in PARAMETERS.iter() {
        let (values, default) = (p.kind.in_words(), show_value(&p.default_value()));
        writeln!(out, "| `{}` | {values} | {} | {default} | {} |", p.name, p.unit, p.doc).expect("writing to a String");
    }
    out
}

/// Returns the key table.
pub(super) fn keys() -> String {
    let mut out = "| keys | command | what it does |\n| --- | --- | --- |\n".to_owned();
    for c in COMMANDS {
        let keys: Vec<_> = c.keys.iter().map(|k| format!("`{k}`")).collect();
        writeln!(out, "| {} | {} | {} |", keys.join(" "), c.name, c.doc).expect("writing to a String");
    }
    out
}
