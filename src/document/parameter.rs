//! A parameter: its name, its kind and so its range, its unit, one line of help, and its place in the [`Edits`].
//!
//! Values travel as TOML values. The rows themselves are in the table, [`super::PARAMETERS`].

use toml::Value;

use super::{
    Edits, entries,
    table_pictures::objects,
    value::{as_number, as_vector, vector, word},
};
pub use crate::path::MAX_POINTS;
use crate::{displace::Layer, motion::LegNames};

/// What values a parameter takes.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Kind {
    /// On or off.
    Switch,
    /// One of these words.
    Choice(&'static [&'static str]),
    /// A whole number in a range, or the word `auto` if that is allowed.
    Count {
        /// Smallest value.
        min: i64,
        /// Largest value.
        max: i64,
        /// Change of one key press; ten times that for a big step.
        step: i64,
        /// Whether the word `auto` is a value.
        auto: bool,
    },
    /// One of these numbers.
    OneOf(&'static [i64]),
    /// A real number in a range.
    Real {
        /// Smallest value.
        min: f64,
        /// Largest value.
        max: f64,
        /// How one key press changes it.
        step: Step,
    },
    /// The name of a joint, or `auto`.
    Joint,
    /// A point or direction `[x, y, z]`, or `auto`.
    Vector,
    /// A list of points `[[x, y, z], …]`, or `auto`.
    Points,
    /// A list of legs `[{ side, hip, knee, ankle, toe }, …]`, or `auto`.
    Legs,
    /// A list of drawn objects by their names under `show`, or one name alone.
    Objects,
    /// A list of plants edited by hand `[{ foot, first, last, mode }, …]`, or `auto`.
    Plants,
    /// A list of displacement maps `[{ name, on, weight, interpolation, merged, position, rotation }, …]`, or `auto`.
    Layers,
    /// Two file frames `[first, last]`, or `[]` for none.
    Frames,
}

/// How one key press changes a real number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Step {
    /// By this much; ten times that for a big step.
    Add(f64),
    /// By this factor; its cube for a big step.
    Times(f64),
}

/// One row of the table.
pub struct Parameter {
    /// The name that panels, `--set` and project files share.
    pub name: &'static str,
    /// What values it takes.
    pub kind: Kind,
    /// Unit for people; empty for none.
    pub unit: &'static str,
    /// What it does, one line.
    pub doc: &'static str,
    pub(super) get: fn(&Edits) -> Value,
    pub(super) set: fn(&mut Edits, &Value),
}

/// A value that a parameter does not take.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum SetError {
    /// No row has this name.
    #[error("there is no parameter `{name}`{}", did_you_mean(.near.as_deref()))]
    Unknown {
        /// The name as given.
        name: String,
        /// A known name that is nearly it.
        near: Option<&'static str>,
    },
    /// The value is not one of this parameter's.
    #[error("`{name}` takes {expected}, found `{found}`")]
    Value {
        /// The parameter.
        name: &'static str,
        /// What it takes, in words.
        expected: String,
        /// The value as given.
        found: String,
    },
    /// An entry of a list is not one of this parameter's.
    #[error("`{name}` entry {number}: {problem}")]
    Entry {
        /// The parameter.
        name: &'static str,
        /// Which entry, from 1.
        number: usize,
        /// What is wrong with it.
        problem: String,
    },
    /// No joint of the clip has this name.
    #[error(transparent)]
    NoJoint(Box<NoJoint>),
    /// Control points were given, but not enough for the degree.
    #[error("a path of degree {degree} needs at least {} control points, found {found}", degree + 1)]
    TooFewPoints {
        /// `path.degree`.
        degree: usize,
        /// How many were given.
        found: usize,
    },
}

/// A joint's name that no joint of the clip has.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error(
    "`{name}` takes {}, found `{found}`{} (the joints are {})",
    Kind::Joint.in_words(),
    did_you_mean(.near.as_deref()),
    .joints.join(", ")
)]
pub struct NoJoint {
    /// The parameter.
    pub name: &'static str,
    /// The name as given.
    pub found: String,
    /// A joint whose name is nearly it.
    pub near: Option<String>,
    /// Names of the clip's joints.
    pub joints: Vec<String>,
}

fn did_you_mean(near: Option<&str>) -> String {
    near.map(|n| format!("; did you mean `{n}`?")).unwrap_or_default()
}

impl Parameter {
    /// Returns the value in these edits.
    pub fn get(&self, edits: &Edits) -> Value {
        (self.get)(edits)
    }

    /// Returns the default value.
    pub fn default_value(&self) -> Value {
        self.get(&Edits::default())
    }

    /// Puts a value into these edits. Rules between parameters are the caller's (see [`super::Change`]).
    ///
    /// # Errors
    ///
    /// When the value is not of this parameter's kind or outside its range.
    pub fn set(&self, edits: &mut Edits, value: &Value) -> Result<(), SetError> {
        let value = self.kind.admit(value).ok_or_else(|| self.refusal(value))?;
        (self.set)(edits, &value);
        Ok(())
    }

    /// Says why a value is none of this parameter's.
    fn refusal(&self, value: &Value) -> SetError {
        let wrong_entry = value.as_array().and_then(|items| match self.kind {
            Kind::Legs => entries::read::<LegNames>(items).err(),
            Kind::Plants => entries::read_plants(items).err(),
            Kind::Layers => entries::read::<Layer>(items).err(),
            _ => None,
        });
        match wrong_entry {
            Some((idx, problem)) => SetError::Entry { name: self.name, number: idx + 1, problem },
            None => SetError::Value { name: self.name, expected: self.kind.in_words(), found: show_value(value) },
        }
    }

    /// Returns the value that `n` key presses make of the present one: switches flip, choices go round, numbers step
    /// within their range; none where a key press has no meaning. A count that is `auto` steps from the number in use,
    /// [`super::Solved::in_use`]; without one it becomes its least.
    pub fn stepped(&self, edits: &Edits, in_use: Option<i64>, n: i64, big: bool) -> Option<Value> {
        let now = self.get(edits);
        match self.kind {
            Kind::Switch => Some(Value::Boolean(!now.as_bool()?)),
            Kind::Choice(words) => {
                let at = words.iter().position(|w| Some(*w) == now.as_str())? as i64;
                let next = (at + n.signum()).rem_euclid(words.len() as i64);
                Some(word(words[next as usize]))
            }
            Kind::OneOf(numbers) => {
                let at = numbers.iter().position(|m| Some(*m) == now.as_integer())? as i64;
                Some(Value::Integer(numbers[(at + n.signum()).rem_euclid(numbers.len() as i64) as usize]))
            }
            Kind::Count { min, max, step, auto } => {
                let Some(now) = now.as_integer().or(in_use) else { return Some(Value::Integer(min)) };
                let next = now + n * if big { 10 * step } else { step };
                Some(if auto && next < min { word("auto") } else { Value::Integer(next.clamp(min, max)) })
            }
            Kind::Real { min, max, step } => {
                let now = now.as_float()?;
                let next = match step {
                    Step::Add(by) => now + n as f64 * if big { 10.0 * by } else { by },
                    Step::Times(by) => now * by.powi(n as i32 * if big { 3 } else { 1 }),
                };
                // Steps print as they are meant: 0.30000000000000004 is 0.3.
                Some(Value::Float(round_to_digits(next, 9).clamp(min, max)))
            }
            Kind::Joint
            | Kind::Vector
            | Kind::Points
            | Kind::Legs
            | Kind::Objects
            | Kind::Plants
            | Kind::Layers
            | Kind::Frames => None,
        }
    }

    /// Returns the text that stands for a value in panels: short, with what `[x, y, z]` lists need.
    pub fn display(&self, edits: &Edits) -> String {
        match self.get(edits) {
            Value::Array(items) if self.kind == Kind::Points => format!("{} points", items.len()),
            Value::Array(items) if self.kind == Kind::Objects && items.is_empty() => "nothing".to_owned(),
            Value::Array(items) if self.kind == Kind::Legs => format!("{} named", items.len()),
            Value::Array(items) if self.kind == Kind::Layers => format!("{} layers", items.len()),
            Value::Boolean(on) => (if on { "on" } else { "off" }).to_owned(),
            value => show_value(&value),
        }
    }

    /// Returns the place the panel and the project file keep it under: the part of the name before the last dot.
    pub fn section(&self) -> &'static str {
        self.name.rsplit_once('.').map_or("", |(section, _)| section)
    }
}

impl Kind {
    /// Returns the value in its normal form if it is one of this kind's.
    fn admit(self, value: &Value) -> Option<Value> {
        let auto = value.as_str() == Some("auto");
        match self {
            Self::Switch => match value.as_str() {
                Some("on") => Some(Value::Boolean(true)),
                Some("off") => Some(Value::Boolean(false)),
                _ => value.as_bool().map(Value::Boolean),
            },
            Self::Choice(words) => words.iter().find(|w| Some(**w) == value.as_str()).map(|w| word(w)),
            Self::Count { auto: allowed, .. } if auto => allowed.then(|| word("auto")),
            Self::Count { min, max, .. } => {
                let n = as_number(value).filter(|n| n.fract() == 0.0)?;
                (min as f64 <= n && n <= max as f64).then_some(Value::Integer(n as i64))
            }
            Self::OneOf(numbers) => {
                let n = as_number(value)?;
                numbers.iter().find(|m| **m as f64 == n).map(|m| Value::Integer(*m))
            }
            Self::Real { min, max, .. } => as_number(value).filter(|n| (min..=max).contains(n)).map(Value::Float),
            Self::Joint => value.as_str().filter(|s| !s.is_empty()).map(word),
            Self::Vector | Self::Points | Self::Legs | Self::Plants | Self::Layers if auto => Some(word("auto")),
            Self::Vector => as_vector(value).map(vector),
            Self::Points => {
                let points: Option<Vec<_>> = value.as_array()?.iter().map(as_vector).collect();
                let points = points.filter(|p| (2..=MAX_POINTS).contains(&p.len()))?;
                Some(Value::Array(points.into_iter().map(vector).collect()))
            }
            Self::Objects => {
                let alone = [value.clone()];
                let names = value.as_array().map_or(&alone[..], Vec::as_slice);
                let known = |name: &Value| objects().any(|object| Some(object) == name.as_str());
                names.iter().all(known).then(|| Value::Array(names.to_vec()))
            }
            Self::Legs => entries::read::<LegNames>(value.as_array()?).ok().map(|legs| entries::value(&legs)),
            Self::Plants => entries::read_plants(value.as_array()?).ok().map(|plants| entries::value(&plants)),
            Self::Layers => entries::read::<Layer>(value.as_array()?).ok().map(|layers| entries::value(&layers)),
            Self::Frames => {
                let frames: Option<Vec<i64>> = value.as_array()?.iter().map(Value::as_integer).collect();
                let is_range = frames.is_some_and(|f| f.is_empty() || (f.len() == 2 && 0 <= f[0] && f[0] < f[1]));
                is_range.then(|| value.clone())
            }
        }
    }

    /// Says what values it takes, e.g. `a whole number from 1 to 60 or "auto"`.
    pub fn in_words(self) -> String {
        match self {
            Self::Switch => "true or false".to_owned(),
            Self::Choice(words) => words.join(", "),
            Self::Count { min, max, auto, .. } => {
                format!("a whole number from {min} to {max}{}", if auto { " or auto" } else { "" })
            }
            Self::OneOf(numbers) => numbers.iter().map(ToString::to_string).collect::<Vec<_>>().join(", "),
            Self::Real { min, max, .. } => format!("a number from {min} to {max}"),
            Self::Joint => "a joint's name or auto".to_owned(),
            Self::Vector => "[x, y, z] or auto".to_owned(),
            Self::Points => format!("a list of 2 to {MAX_POINTS} points [[x, y, z], …] or auto"),
            Self::Legs => "a list of legs [{ side, hip, knee, ankle, toe }, …] or auto".to_owned(),
            Self::Objects => "a list of names under show., e.g. [\"ground\", \"traces\"]".to_owned(),
            Self::Plants => "a list of plants [{ foot, first, last, mode }, …] or auto".to_owned(),
            Self::Layers => {
                "a list of layers [{ name, on, weight, interpolation, merged, position, rotation }, …] or auto"
                    .to_owned()
            }
            Self::Frames => "two frames [first, last], the first before the last, or []".to_owned(),
        }
    }
}

/// Splits `NAME=VALUE` and reads the value as TOML; a bare word is a string.
///
/// # Errors
///
/// When there is no `=`, with a sentence for the user.
pub fn parse_assignment(text: &str) -> Result<(String, Value), String> {
    let (name, value) = text.split_once('=').ok_or_else(|| format!("expected NAME=VALUE, found `{text}`"))?;
    let value = value.trim();
    // A document of one key reads any TOML value; what is none (a bare word) is taken as the string it looks like.
    let parsed = format!("value = {value}").parse::<toml::Table>().ok().filter(|t| t.len() == 1);
    let value = parsed.and_then(|mut t| t.remove("value")).unwrap_or_else(|| word(value));
    Ok((name.trim().to_owned(), value))
}

/// Returns a value as TOML text.
pub fn show_value(value: &Value) -> String {
    match value {
        Value::String(s) => s.clone(),
        Value::Float(f) => show_number(*f),
        Value::Table(entry) => entries::inline(entry),
        // Texts alone need no quotes; in a list they are written as they are read.
        Value::Array(items) => {
            let text = |item: &Value| if item.is_str() { item.to_string() } else { show_value(item) };
            format!("[{}]", items.iter().map(text).collect::<Vec<_>>().join(", "))
        }
        other => other.to_string(),
    }
}

fn show_number(n: f64) -> String {
    format!("{}", round_to_digits(n, 9))
}

/// Rounds to this many significant digits.
fn round_to_digits(n: f64, digits: usize) -> f64 {
    format!("{n:.*e}", digits.saturating_sub(1)).parse().expect("a printed number parses")
}
