//! Between TOML values and the edits' own types, for values that a parameter's kind lets through.

use glam::DVec3;
use toml::Value;

/// A word as a value.
pub(super) fn word(text: &str) -> Value {
    Value::String(text.to_owned())
}

/// Reads a finite number.
pub(super) fn as_number(value: &Value) -> Option<f64> {
    value.as_float().or_else(|| value.as_integer().map(|i| i as f64)).filter(|n| n.is_finite())
}

/// Reads `[x, y, z]` of finite numbers.
pub(super) fn as_vector(value: &Value) -> Option<DVec3> {
    let numbers: Option<Vec<f64>> = value.as_array()?.iter().map(as_number).collect();
    <[f64; 3]>::try_from(numbers?).ok().map(DVec3::from)
}

/// `[x, y, z]` as a value.
pub(super) fn vector(v: DVec3) -> Value {
    // Adding 0 takes the sign off a zero.
    Value::Array(v.to_array().map(|n| Value::Float(n + 0.0)).to_vec())
}

/// `[x, y, z]` or `auto`.
pub(super) fn optional_vector(v: Option<DVec3>) -> Value {
    v.map_or_else(|| word("auto"), vector)
}

/// The word for a choice.
pub(super) fn word_of<T: PartialEq>(words: &[(&str, T)], choice: &T) -> Value {
    word(words.iter().find(|(_, c)| c == choice).expect("every choice has a word").0)
}

/// The choice for a word that [`super::Kind::admit`] let through.
pub(super) fn choice_of<T: Copy>(words: &[(&str, T)], value: &Value) -> T {
    words.iter().find(|(w, _)| Some(*w) == value.as_str()).expect("the table's words are the choices").1
}

/// The entries of a list that [`super::Kind::admit`] let through.
pub(super) fn admitted<T>(entries: Result<Vec<T>, (usize, String)>) -> Vec<T> {
    entries.expect("admitted as a list of entries")
}

/// A number that was let through.
pub(super) fn float(value: &Value) -> f64 {
    value.as_float().expect("admitted as a number")
}

/// A switch that was let through.
pub(super) fn switch(value: &Value) -> bool {
    value.as_bool().expect("admitted as a switch")
}

/// A whole number that was let through; none for `auto`.
pub(super) fn count(value: &Value) -> Option<usize> {
    value.as_integer().map(|n| n as usize)
}

/// A frame as a value, or `auto`.
pub(super) fn frame(given: Option<usize>) -> Value {
    given.map_or_else(|| word("auto"), |frame| Value::Integer(frame as i64))
}
