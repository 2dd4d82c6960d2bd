//! Project files: TOML to be read and diffed, holding a clip's name and what differs from the defaults.
//!
//! Same project and clip, same bytes out. An unknown key or a value out of range is an error with a place; a clip
//! that has changed since is a warning. `[clip] file` is relative to the project; without it the project is about
//! the built-in clip.

use std::path::{Path, PathBuf};

use serde::de::DeserializeOwned;
use toml::{
    Spanned, Value,
    de::{DeTable, DeValue, ValueDeserializer},
};

use super::{
    Edits, entries,
    parameter::{Kind, Parameter, SetError, show_value},
    table::{PARAMETERS, check_carrier, parameter},
};
use crate::{contact::PlantEdit, displace::Layer, motion::LegNames};

/// The project format this program writes; every smaller one still opens.
pub const FORMAT: i64 = 1;

/// A project file that does not read.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
#[error("{file}:{line}:{column}: {problem}")]
pub struct ProjectError {
    /// The project file.
    pub file: String,
    /// Line, from 1.
    pub line: usize,
    /// Column in characters, from 1.
    pub column: usize,
    /// What is wrong.
    pub problem: Problem,
}

/// What is wrong in a project file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum Problem {
    /// Not TOML.
    #[error("{0}")]
    Syntax(String),
    /// `format` is missing or not one of ours.
    #[error("expected `format` from 1 to {FORMAT}, found {0}; a newer walkabout may open it")]
    Format(String),
    /// A value or a name that the parameter table does not take.
    #[error(transparent)]
    Parameter(#[from] SetError),
    /// A key of the right name with a value of the wrong type.
    #[error("`{0}` is a text")]
    NotText(&'static str),
}

/// What a project file says.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Project {
    /// `[clip] file` as written; none for the built-in clip.
    pub clip_file: Option<String>,
    /// `[clip] blake3` as written; none: the clip is not checked.
    pub blake3: Option<String>,
    /// The edits.
    pub edits: Edits,
}

/// Reads a project from its text; `file` is for messages.
///
/// # Errors
///
/// When the text is not a project, with the place.
pub(super) fn parse(text: &str, file: &str) -> Result<Project, ProjectError> {
    let fail = |offset: usize, problem| {
        let (line, column) = place(text, offset);
        ProjectError { file: file.to_owned(), line, column, problem }
    };
    let table = DeTable::parse(text)
        .map_err(|e| fail(e.span().map_or(0, |s| s.start), Problem::Syntax(e.message().trim_end().to_owned())))?;
    let format = table.get_ref().get("format");
    let number = format.and_then(|f| text[f.span()].parse::<i64>().ok());
    if !number.is_some_and(|n| (1..=FORMAT).contains(&n)) {
        let (at, found) = format.map_or((0, "none".to_owned()), |f| (f.span().start, text[f.span()].to_owned()));
        return Err(fail(at, Problem::Format(found)));
    }

    let mut project = Project::default();
    let mut assignments = Vec::new();
    let mut tables = vec![(String::new(), table.get_ref())];
    while let Some((prefix, table)) = tables.pop() {
        for (key, value) in table {
            let name = format!("{prefix}{}", key.get_ref());
            let at = key.span().start;
            let text_value =
                |what| value.get_ref().as_str().map(str::to_owned).ok_or_else(|| fail(at, Problem::NotText(what)));
            match (name.as_str(), value.get_ref()) {
                ("format", _) => {}
                ("clip.file", _) => project.clip_file = Some(text_value("clip.file")?),
                ("clip.blake3", _) => project.blake3 = Some(text_value("clip.blake3")?),
                (_, DeValue::Table(inner)) => tables.push((format!("{name}."), inner)),
                _ => assignments.push((at, name, value)),
            }
        }
    }
    // In table order, so that what one parameter does to another does not depend on the order in the file.
    assignments.sort_by_key(|(_, name, _)| PARAMETERS.iter().position(|p| p.name == name));
    for (at, name, value) in &assignments {
        let read = read_value(text, value).map_err(|(at, message)| fail(at, Problem::Syntax(message)))?;
        let set = parameter(name).and_then(|p| p.set(&mut project.edits, &read));
        set.map_err(|error| fail(entry_place(name, value, &error).unwrap_or(*at), error.into()))?;
    }
    let path = &project.edits.path;
    if path.control_points.as_ref().is_some_and(|p| p.len() <= path.degree) {
        let at = assignments.iter().find(|(_, name, _)| name == "path.control_points").map_or(0, |(at, ..)| *at);
        let problem = SetError::TooFewPoints { degree: path.degree, found: path.points };
        return Err(fail(at, problem.into()));
    }
    project.edits.path.points = path.points.max(path.degree + 1);
    Ok(project)
}

/// Checks what a project says about the clip's joints, which its text alone does not tell.
///
/// # Errors
///
/// When `clip.carrier` is none of them, with the place.
pub(super) fn check_joints(project: &Project, names: &[&str], text: &str, file: &str) -> Result<(), ProjectError> {
    let Err(error) = check_carrier(&project.edits, names) else { return Ok(()) };
    let table = DeTable::parse(text).ok();
    let at = table.as_ref().and_then(|table| {
        let (key, _) = table.get_ref().get("clip")?.get_ref().as_table()?.get_key_value("carrier")?;
        Some(key.span().start)
    });
    let (line, column) = place(text, at.unwrap_or(0));
    Err(ProjectError { file: file.to_owned(), line, column, problem: error.into() })
}

/// Returns the project's text.
pub(super) fn print(project: &Project) -> String {
    let mut out = format!("format = {FORMAT}\n");
    let defaults = Edits::default();
    let differs = |parameter: &Parameter| parameter.get(&project.edits) != parameter.get(&defaults);
    let own_tables = |parameter: &Parameter| [Kind::Plants, Kind::Layers].contains(&parameter.kind);
    // What is in no table comes before the first one.
    for parameter in PARAMETERS.iter().filter(|p| p.section().is_empty() && !own_tables(p) && differs(p)) {
        out.push_str(&format!("{} = {}\n", parameter.name, print_value(&parameter.get(&project.edits))));
    }
    let mut section = "";
    let mut begin = |out: &mut String, next: &'static str| {
        if section != next {
            section = next;
            out.push_str(&format!("\n[{next}]\n"));
        }
    };
    for (key, value) in [("file", &project.clip_file), ("blake3", &project.blake3)] {
        if let Some(value) = value {
            begin(&mut out, "clip");
            out.push_str(&format!("{key} = {}\n", Value::String(value.clone())));
        }
    }
    let given_points = project.edits.path.control_points.is_some();
    for parameter in PARAMETERS.iter().filter(|p| !p.section().is_empty() && differs(p)) {
        let implied = parameter.name == "path.points" && given_points;
        if !implied {
            begin(&mut out, parameter.section());
            let key = parameter.name.rsplit('.').next().expect("a name has a last part");
            out.push_str(&format!("{key} = {}\n", print_value(&parameter.get(&project.edits))));
        }
    }
    for plant in entries::tables(&project.edits.edited_plants) {
        out.push_str("\n[[plant]]\n");
        entries::lines(&plant).iter().for_each(|(key, value)| out.push_str(&format!("{key} = {value}\n")));
    }
    for layer in entries::tables(&project.edits.layers) {
        out.push_str("\n[[layer]]\n");
        for (key, _) in entries::lines(&layer) {
            match &layer[key] {
                Value::Table(maps) => maps.iter().for_each(|(joint, keys)| {
                    out.push_str(&format!("{key}.{} = {}\n", key_text(joint), print_value(keys)));
                }),
                value => out.push_str(&format!("{key} = {}\n", print_value(value))),
            }
        }
    }
    out
}

/// Returns the way from a project to its clip: relative where both are in or below one folder, else absolute.
pub(super) fn clip_reference(project: &Path, clip: &Path) -> String {
    let absolute = |p: &Path| std::path::absolute(p).unwrap_or_else(|_| p.to_owned());
    let (project, clip) = (absolute(project), absolute(clip));
    let folder = project.parent().unwrap_or(Path::new("/"));
    let mut up = PathBuf::new();
    for ancestor in folder.ancestors() {
        if let Ok(rest) = clip.strip_prefix(ancestor)
            && ancestor.parent().is_some()
        {
            return up.join(rest).display().to_string();
        }
        up.push("..");
    }
    clip.display().to_string()
}

/// Reads one value out of the text; lists of tables may be spread over it, so only what is in them has its own text.
/// Fails with the place and in words where a number is none that fits.
fn read_value(text: &str, value: &Spanned<DeValue<'_>>) -> Result<Value, (usize, String)> {
    match value.get_ref() {
        DeValue::Array(items) => {
            items.iter().map(|item| read_value(text, item)).collect::<Result<_, _>>().map(Value::Array)
        }
        DeValue::Table(table) => {
            let entries = table.iter().map(|(key, value)| Ok((key.get_ref().to_string(), read_value(text, value)?)));
            entries.collect::<Result<_, _>>().map(Value::Table)
        }
        _ => {
            let own = &text[value.span()];
            let table: Result<toml::Table, _> = format!("value = {own}").parse();
            let table =
                table.map_err(|error| (value.span().start, format!("`{own}`: {}", error.message().trim_end())))?;
            Ok(table.into_iter().next().expect("one key").1)
        }
    }
}

/// Returns where in the file stands what an error in an entry of a list is about: its key, its value, or else the entry.
fn entry_place(name: &str, value: &Spanned<DeValue<'_>>, error: &SetError) -> Option<usize> {
    let SetError::Entry { number, .. } = error else { return None };
    let entry = value.get_ref().as_array()?.get(number - 1)?;
    let inside = match parameter(name).ok()?.kind {
        Kind::Legs => wrong_place::<LegNames>(entry),
        Kind::Plants => wrong_place::<PlantEdit>(entry),
        Kind::Layers => wrong_place::<Layer>(entry),
        _ => None,
    };
    Some(inside.unwrap_or(entry.span().start))
}

/// Returns where reading an entry in its place in the file fails, if it does.
fn wrong_place<T: DeserializeOwned>(entry: &Spanned<DeValue<'_>>) -> Option<usize> {
    let error = T::deserialize(ValueDeserializer::from(entry.clone())).err()?;
    Some(error.span()?.start)
}

/// Returns a name as a key: bare where it can be.
fn key_text(name: &str) -> String {
    let is_bare = !name.is_empty() && name.chars().all(|c| c.is_ascii_alphanumeric() || c == '_' || c == '-');
    if is_bare { name.to_owned() } else { Value::String(name.to_owned()).to_string() }
}

fn print_value(value: &Value) -> String {
    match value {
        Value::Array(items) if items.iter().all(|item| item.is_array() || item.is_table()) => {
            let rows: String = items.iter().map(|item| format!("    {},\n", print_value(item))).collect();
            format!("[\n{rows}]")
        }
        Value::Array(items) => format!("[{}]", items.iter().map(print_value).collect::<Vec<_>>().join(", ")),
        Value::Float(f) => format!("{f:?}"),
        Value::String(_) => value.to_string(),
        other => show_value(other),
    }
}

/// Line and column, from 1, of a byte offset.
fn place(text: &str, offset: usize) -> (usize, usize) {
    let before = &text[..offset.min(text.len())];
    let line_start = before.rfind('\n').map_or(0, |i| i + 1);
    (before.matches('\n').count() + 1, before[line_start..].chars().count() + 1)
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::{contact::PlantEditMode, motion::Side, path::Degree};
    use glam::{DQuat, DVec3};

    fn check_error(text: &str, expected: &str) {
        assert_eq!(parse(text, "p.toml").map_err(|e| e.to_string()), Err(expected.to_owned()));
    }

    #[test]
    fn what_is_written_reads_back() {
        let mut project = Project { clip_file: Some("walks/a \"b\".bvh".to_owned()), ..Project::default() };
        project.blake3 = Some("00ff".to_owned());
        project.edits.original.degree = Degree::Fixed(13);
        project.edits.path.control_points = Some((0..5).map(|i| DVec3::new(f64::from(i) / 3.0, 1e-7, -1e10)).collect());
        project.edits.path.points = 5;
        project.edits.view.show.ground = false;
        project.edits.view.windows[0].layout = 4;
        project.edits.view.windows[0].views[2].camera_idx = 0;
        project.edits.view.windows[1].views[3].shows.ground = false;
        project.edits.view.cameras[2].eye = Some(DVec3::new(1.0, 2.0, 3.0));
        project.edits.view.cameras[2].up = Some(DVec3::new(-0.0, -0.0, 1.0));
        let mut layer = Layer::new("nod");
        layer.position.set(4, DVec3::new(-0.0, 1.0, 2.0));
        layer.set_rotation("Neck", 4, DQuat::from_xyzw(-0.0, 0.6, -0.0, 0.8));
        project.edits.layers = vec![layer];
        project.edits.clip.carrier = Some("Hips".to_owned());
        let name = |part: &str| format!("left \"{part}\"");
        project.edits.clip.legs =
            vec![LegNames { side: Side::Left, hip: name("hip"), knee: name("knee"), ankle: name("ankle"), toe: None }];
        project.edits.edited_plants = vec![
            PlantEdit { foot: Side::Left, first: 3, last: 9, mode: PlantEditMode::Clean },
            PlantEdit { foot: Side::Right, first: 0, last: 0, mode: PlantEditMode::None },
        ];
        let text = print(&project);
        assert!(text.contains("\n[view]\nlayout = 4\n\n[view.3]\ncamera = 1\n"), "{text}");
        assert!(text.contains("\n[second.4]\nhide = [\"ground\"]\n"), "{text}");
        assert!(text.contains("\n[[plant]]\nfoot = \"left\"\nfirst = 3\nlast = 9\nmode = \"clean\"\n"), "{text}");
        assert!(text.contains("\nup = [0.0, 0.0, 1.0]\n") && !text.contains("-0.0"), "{text}");
        assert_eq!(parse(&text, "p.toml"), Ok(project.clone()));
        assert_eq!(print(&parse(&text, "p.toml").expect("parses")), text);
    }

    #[test]
    fn defaults_are_not_written() {
        assert_eq!(print(&Project::default()), "format = 1\n");
    }

    #[test]
    fn errors_name_the_place() {
        check_error("", "p.toml:1:1: expected `format` from 1 to 1, found none; a newer walkabout may open it");
        check_error("format = 9", "p.toml:1:10: expected `format` from 1 to 1, found 9; a newer walkabout may open it");
        check_error(
            "format = 1\n[path]\ndegre = 3\n",
            "p.toml:3:1: there is no parameter `path.degre`; did you mean `path.degree`?",
        );
        check_error(
            "format = 1\n[path]\ndegree = 30\n",
            "p.toml:3:1: `path.degree` takes a whole number from 1 to 9, found `30`",
        );
        check_error(
            "format = 1\npath.control_points = [[0, 0, 0], [1, 0, 0]]\n",
            "p.toml:2:6: a path of degree 3 needs at least 4 control points, found 2",
        );
        check_error("format = 1\n[clip]\nfile = 3\n", "p.toml:3:1: `clip.file` is a text");
        for (text, place, number) in [
            ("[path]\npoints = 99999999999999999999\n", "3:10", "99999999999999999999"),
            ("interpolation_keys = [1, 99999999999999999999]\n", "2:26", "99999999999999999999"),
            ("[path]\nnudge = 1e999\n", "3:9", "1e999"),
        ] {
            let error = parse(&format!("format = 1\n{text}"), "p.toml").expect_err("a number that is none").to_string();
            assert!(error.starts_with(&format!("p.toml:{place}: `{number}`: ")), "{error}");
        }
        assert!(parse("format = 1\n[path\n", "p.toml").is_err());
        for (from, to, place, words) in [
            ("weight = 0.5", "weight = 1.5", "5:10", "weight is 0 to 1, found 1.5"),
            ("weight", "wieght", "5:1", "unknown field `wieght`"),
            ("\"euler_linear\"", "\"euler\"", "6:17", "unknown word `euler`, expected one of `quaternion`"),
            ("\"euler_linear\"", "3", "6:17", "expected a word in quotes"),
            ("[1, 0, 0, 0]", "[1, 0, 0]", "9:26", "expected a rotation [w, x, y, z], not all of them zero, found [1"),
            ("[0, 1, 0, 0]", "[0, 1, 0, 0, 0]", "10:26", "expected a rotation [w, x, y, z], not all of them zero"),
            ("[1, 0, 0, 0]", "[1, 0, \"0\", 0]", "9:33", "expected a number, found \"0\""),
            ("[0, 1, 0, 0]", "\"x\"", "10:26", "expected a list, found \"x\""),
            ("[0, 1, 0, 0]", "[0, 0, 0, 0]", "10:26", "expected a rotation [w, x, y, z], not all of them zero, found"),
            ("[0, 1, 0, 0]", "[nan, 1, 0, 0]", "10:26", "expected a rotation [w, x, y, z], not all of them zero"),
            ("frame = 7", "frame = 7.5", "10:15", "expected a whole number from 0 on, found `7.5`"),
            ("frame = 7", "frame = -7", "10:15", "expected a whole number from 0 on, found `-7`"),
            ("frame = 7", "frame = \"7\"", "10:15", "expected a whole number from 0 on, found \"7\""),
            ("frame = 7, ", "", "10:5", "missing field `frame`"),
            ("{ frame = 7, value = [0, 1, 0, 0] }", "7", "10:5", "expected a key { frame, value }, found `7`"),
            ("frame = 7", "frame = 3", "10:5", "two keys at frame 3"),
            ("name = \"wave\"", "name = 7", "4:8", "expected a text in quotes, found `7`"),
            ("weight", "on = 1\nweight", "5:6", "expected true or false, found `1`"),
            ("weight", "position = 1\nweight", "5:12", "expected a list of keys { frame, value }, found `1`"),
            (
                "weight",
                "position = [\n    { frame = 3, value = [1, 0, 0] },\n    { frame = 4, value = [1, 0] },\n]\nweight",
                "7:26",
                "expected an offset [x, y, z], found [1.0, 0.0]",
            ),
            ("frame = 7", "farme = 7", "10:7", "unknown field `farme`"),
            ("name = \"wave\"", "on = true", "3:1", "missing field `name`"),
            ("name = \"wave\"", "name = \" \"", "4:8", "a layer needs a name"),
        ] {
            let good = "format = 1\n\n[[layer]]\nname = \"wave\"\nweight = 0.5\ninterpolation = \"euler_linear\"\n\
                [layer.rotation]\nNeck = [\n    { frame = 3, value = [1, 0, 0, 0] },\n    { frame = 7, value = [0, 1, 0, 0] },\n]\n";
            assert!(parse(good, "p.toml").is_ok());
            assert!(good.contains(from), "{from}");
            let error = parse(&good.replacen(from, to, 1), "p.toml").expect_err(to).to_string();
            assert!(error.starts_with(&format!("p.toml:{place}: `layer` entry 1: {words}")), "{error}");
        }
        let two = "format = 1\n[[plant]]\nfoot = \"left\"\nfirst = 3\nlast = 9\n[[plant]]\n";
        check_error(
            &format!("{two}foot = \"right\"\nfirst = 9\nlast = 3\n"),
            "p.toml:6:1: `plant` entry 2: it ends at 3 before it begins at 9",
        );
        check_error(
            &format!("{two}foot = \"right\"\nfirst = 9\nlast = 30\nmod = \"hold\"\n"),
            "p.toml:10:1: `plant` entry 2: unknown field `mod`, expected one of `foot`, `first`, `last`, `mode`",
        );
        check_error(
            "format = 1\n[clip]\nlegs = [\n    { side = \"left\", hip = \"h\", knee = \"k\" },\n]\n",
            "p.toml:4:5: `clip.legs` entry 1: missing field `ankle`",
        );
    }

    #[test]
    fn clips_are_named_from_the_project() {
        let check = |project: &str, clip: &str, expected: &str| {
            assert_eq!(clip_reference(Path::new(project), Path::new(clip)), expected);
        };
        check("/a/b/p.toml", "/a/b/c.bvh", "c.bvh");
        check("/a/b/p.toml", "/a/x/c.bvh", "../x/c.bvh");
        check("/a/b/p.toml", "/other/c.bvh", "/other/c.bvh");
    }
}
