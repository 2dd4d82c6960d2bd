//! Lists of entries as values: legs by name (`clip.legs`), plants edited by hand (`plant`), layers (`layer`).
//!
//! An entry is a TOML table; the types it reads into say which keys it has. Tables forget the order of their keys, so
//! it is kept here: as people would say it, and the same for equal entries.

use serde::{Serialize, de::DeserializeOwned};
use toml::{Table, Value};

use super::value::word;
use crate::contact::PlantEdit;

/// The keys of all entries in the order they are written.
const KEYS: [&str; 18] = [
    "side",
    "foot",
    "hip",
    "knee",
    "ankle",
    "toe",
    "first",
    "last",
    "mode",
    "name",
    "on",
    "weight",
    "interpolation",
    "merged",
    "position",
    "rotation",
    "frame",
    "value",
];

/// Reads a list of entries.
///
/// # Errors
///
/// When one cannot be read: its index and why.
pub(super) fn read<T: DeserializeOwned>(items: &[Value]) -> Result<Vec<T>, (usize, String)> {
    let entry = |(idx, item): (usize, &Value)| {
        item.clone().try_into().map_err(|e: toml::de::Error| (idx, in_words(e.message().trim_end())))
    };
    items.iter().enumerate().map(entry).collect()
}

/// Says what a reader of TOML says as this program's other errors say it: what is expected before what was found, and
/// no types of a programming language.
fn in_words(message: &str) -> String {
    let mistaken = ["invalid type: ", "invalid value: "].iter().find_map(|start| message.strip_prefix(start));
    let Some((found, expected)) = mistaken.and_then(|rest| rest.split_once(", expected ")) else {
        return message.replace("unknown variant ", "unknown word ");
    };
    let expected = match expected {
        "usize" => "a whole number from 0 on",
        "f64" => "a number",
        "a boolean" => "true or false",
        "a string" => "a text in quotes",
        "string or table" | "string only" => "a word in quotes",
        "a sequence" => "a list",
        "a map" => "a table",
        other => other.strip_prefix("struct ").map_or(other, |_| "a table"),
    };
    let found = match found {
        // Its reader does not tell what it was.
        "unit variant" => return format!("expected {expected}"),
        "sequence" => "a list".to_owned(),
        "map" => "a table".to_owned(),
        other => other.replacen("floating point ", "", 1).replacen("integer ", "", 1).replacen("string ", "", 1),
    };
    format!("expected {expected}, found {found}")
}

/// Reads a list of edited plants.
///
/// # Errors
///
/// When one cannot be read or ends before it begins: its index and why.
pub(super) fn read_plants(items: &[Value]) -> Result<Vec<PlantEdit>, (usize, String)> {
    let plants: Vec<PlantEdit> = read(items)?;
    match plants.iter().position(|plant| plant.last < plant.first) {
        Some(idx) => Err((idx, format!("it ends at {} before it begins at {}", plants[idx].last, plants[idx].first))),
        None => Ok(plants),
    }
}

/// Returns entries as a value; an empty list is the word `auto`.
pub(super) fn value<T: Serialize>(entries: &[T]) -> Value {
    if entries.is_empty() { word("auto") } else { Value::Array(tables(entries).map(Value::Table).collect()) }
}

/// Returns each entry as a table.
pub(super) fn tables<T: Serialize>(entries: &[T]) -> impl Iterator<Item = Table> {
    entries.iter().map(|entry| Table::try_from(entry).expect("an entry's fields are words and numbers that TOML holds"))
}

/// Returns an entry's keys with their values' texts, in the order they are written.
pub(super) fn lines(entry: &Table) -> Vec<(&str, String)> {
    let mut lines: Vec<_> = entry.iter().map(|(key, value)| (key.as_str(), value.to_string())).collect();
    lines.sort_by_key(|(key, _)| KEYS.iter().position(|k| k == key).unwrap_or(KEYS.len()));
    lines
}

/// Returns an entry on one line.
pub(super) fn inline(entry: &Table) -> String {
    let pairs: Vec<_> = lines(entry).into_iter().map(|(key, value)| format!("{key} = {value}")).collect();
    format!("{{ {} }}", pairs.join(", "))
}
