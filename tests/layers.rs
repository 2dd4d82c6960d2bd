//! Keeps the layers: reads the sources and fails on what the table at the head of `src/lib.rs` forbids.
//!
//! An arrow is a path that names another top-level module, however it is written: `crate::`, `walkabout::`, or enough
//! `super::` to leave the module. It must point to a lower layer. Beside arrows, some words belong to some layers
//! only: `unsafe`, files, clocks and printing. Comments and text do not count, so a doc may link to a higher layer.
//!
//! The reader knows Rust's tokens, not its grammar; a path made by a macro is not seen.

use std::{
    collections::BTreeSet,
    fmt,
    path::{Path, PathBuf},
};

/// Every top-level module with its layer, those of later work included.
const LAYERS: &[(u32, &[&str])] = &[
    (8, &["app", "cli"]),
    (7, &["tui", "viewport", "link"]),
    (6, &["editor"]),
    (5, &["document", "scene"]),
    (4, &["constrain", "cycle", "measure"]),
    (3, &["path", "contact", "displace"]),
    (2, &["motion"]),
    (1, &["curve", "bvh", "skeleton"]),
    (0, &["math", "sync", "key"]),
];

/// The lowest layer that may open files.
const FILES_FROM: u32 = 5;

/// The lowest layer that may read a clock.
const CLOCKS_FROM: u32 = 6;

/// `lib.rs` and `main.rs` see everything.
const ROOTS: &[&str] = &["lib", "main"];

/// What may print to the terminal directly.
const PRINTERS: &[&str] = &["app", "cli", "main"];

#[test]
fn the_sources_keep_the_layers() {
    let src = Path::new(env!("CARGO_MANIFEST_DIR")).join("src");
    let read = |path: &PathBuf| {
        let name = path.strip_prefix(&src).expect("found below src").to_string_lossy().replace('\\', "/");
        Source::new(&name, &std::fs::read_to_string(path).expect("sources are readable"))
    };
    let sources: Vec<_> = rust_files(&src).iter().map(read).collect();
    assert!(sources.len() > 2, "no sources were found in {}", src.display());
    let findings: Vec<_> = check_all(&sources).iter().map(Finding::to_string).collect();
    assert!(findings.is_empty(), "the layers are not kept:\n{}\n", findings.join("\n"));
}

#[test]
fn the_table_in_lib_rs_is_the_table_kept_here() {
    let lib = include_str!("../src/lib.rs");
    let mut documented = BTreeSet::new();
    for row in lib.lines().filter_map(|line| line.strip_prefix("//! | ")) {
        let mut cells = row.split(" | ");
        let Some(layer) = cells.next().and_then(|cell| cell.parse::<u32>().ok()) else { continue };
        for name in cells.next().unwrap_or_default().split(", ") {
            let name = name.trim_matches(['[', ']', '`']);
            assert_eq!(layer_of(name), Some(layer), "`{name}` in the table of src/lib.rs");
            documented.insert(name);
        }
    }
    let modules = lib.lines().filter_map(|line| line.strip_prefix("pub mod ")?.strip_suffix(';'));
    assert_eq!(modules.collect::<BTreeSet<_>>(), documented, "modules and table of src/lib.rs");
}

/// Something that breaks the rules.
struct Finding {
    file: String,
    line: usize,
    what: String,
}

impl fmt::Display for Finding {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "src/{}:{}: {}", self.file, self.line, self.what)
    }
}

/// One file below `src`.
struct Source {
    /// Its name below `src`, with `/`.
    file: String,
    /// The module it is, from the crate's root: empty for `lib.rs`, `["main"]` for `main.rs`.
    module: Vec<String>,
    tokens: Vec<Token>,
}

/// A word or a mark of Rust.
struct Token {
    text: String,
    line: usize,
    /// Inside an item that exists in tests only.
    in_test: bool,
}

/// A path as used, groups spelt out: `use a::{b, c}` makes two. May end in `*`, or in `as` when it is given a name.
struct UsedPath<'a> {
    segments: Vec<&'a str>,
    token: &'a Token,
    /// Modules within the file around it.
    inner: Vec<&'a str>,
}

fn check_all(sources: &[Source]) -> Vec<Finding> {
    let test_modules: BTreeSet<_> = sources.iter().flat_map(Source::test_modules).collect();
    let is_test = |source: &Source| (1..=source.module.len()).any(|n| test_modules.contains(&source.module[..n]));
    sources.iter().flat_map(|source| source.check(is_test(source))).collect()
}

impl Source {
    fn new(file: &str, text: &str) -> Self {
        let mut module: Vec<_> = file.trim_end_matches(".rs").split('/').map(str::to_owned).collect();
        if module.last().is_some_and(|name| name == "mod" || name == "lib") {
            module.pop();
        }
        let mut tokens = tokens(text);
        mark_tests(&mut tokens);
        Self { file: file.to_owned(), module, tokens }
    }

    /// The top-level module, or `lib`.
    fn top(&self) -> &str {
        self.module.first().map_or("lib", String::as_str)
    }

    /// Modules in files of their own that this file declares for tests only.
    fn test_modules(&self) -> Vec<Vec<String>> {
        let declared =
            |w: &[Token]| (w[0].in_test && w[0].text == "mod" && w[2].text == ";").then(|| w[1].text.clone());
        let full = |name| [self.module.clone(), vec![name]].concat();
        self.tokens.windows(3).filter_map(declared).map(full).collect()
    }

    fn check(&self, is_test: bool) -> Vec<Finding> {
        let mut findings = Vec::new();
        let mut found = |line, what: String| findings.push(Finding { file: self.file.clone(), line, what });
        let top = self.top();
        let layer = if ROOTS.contains(&top) { Some(u32::MAX) } else { layer_of(top) };
        let Some(layer) = layer else {
            found(1, format!("`{top}` is not in the table of layers"));
            return findings;
        };
        for pair in self.tokens.windows(2) {
            let (word, line) = (pair[0].text.as_str(), pair[0].line);
            let in_test = is_test || pair[0].in_test;
            if word == "unsafe" && top != "viewport" {
                found(line, format!("`unsafe` in {top}: it lives in viewport"));
            }
            let prints = ["print", "println", "eprint", "eprintln", "dbg"].contains(&word) && pair[1].text == "!";
            if prints && !in_test && !PRINTERS.contains(&top) {
                found(line, format!("`{word}!` in {top}: only {} print", PRINTERS.join(", ")));
            }
        }
        for path in paths(&self.tokens) {
            let line = path.token.line;
            let spelt = path.segments.join("::");
            if layer < FILES_FROM && !is_test && !path.token.in_test && path.opens_files() {
                found(line, format!("`{spelt}` in {top} (layer {layer}): files are opened from layer {FILES_FROM} up"));
            }
            if layer < CLOCKS_FROM && path.reads_clock() {
                found(line, format!("`{spelt}` in {top} (layer {layer}): clocks are read from layer {CLOCKS_FROM} up"));
            }
            if layer != u32::MAX
                && let Some(problem) = self.arrow(&path, layer)
            {
                found(line, format!("`{spelt}`: {problem}"));
            }
        }
        findings
    }

    /// Says what is wrong with a path that leaves the top-level module, if anything is.
    fn arrow(&self, path: &UsedPath, layer: u32) -> Option<String> {
        let target = path.target(&self.module)?;
        let top = self.top();
        if target == top {
            return None;
        }
        if ["*", "as", "self"].contains(&target) {
            return Some(format!("{top} names the crate's root, which hides what it uses"));
        }
        let Some(to) = layer_of(target) else {
            return Some(format!("{top} → {target}, which is not in the table of layers"));
        };
        let direction = if to > layer { "up" } else { "sideways" };
        (to >= layer).then(|| format!("{top} (layer {layer}) → {target} (layer {to}) points {direction}"))
    }
}

impl UsedPath<'_> {
    /// The name below the crate's root where the path ends up; nothing for a path that does not start from there.
    fn target(&self, file_module: &[String]) -> Option<&str> {
        let (first, mut rest) = self.segments.split_first()?;
        if ["crate", "walkabout"].contains(first) {
            return rest.first().copied();
        }
        if !["self", "super"].contains(first) {
            return None;
        }
        let module: Vec<_> = file_module.iter().map(String::as_str).chain(self.inner.iter().copied()).collect();
        let mut depth = module.len().checked_sub(usize::from(*first == "super"))?;
        while rest.first() == Some(&"super") {
            (depth, rest) = (depth.checked_sub(1)?, &rest[1..]);
        }
        // The module itself and the modules around it are no arrows.
        if depth == 0 { rest.first().copied() } else { None }
    }

    fn opens_files(&self) -> bool {
        let opener = |pair: &[&str]| pair == ["std", "fs"] || pair[0] == "File" || pair[0] == "OpenOptions";
        self.segments.windows(2).any(opener) || self.segments[0] == "tempfile"
    }

    fn reads_clock(&self) -> bool {
        self.segments.windows(2).any(|pair| pair == ["Instant", "now"]) || self.segments.contains(&"SystemTime")
    }
}

fn layer_of(module: &str) -> Option<u32> {
    LAYERS.iter().find(|(_, modules)| modules.contains(&module)).map(|(layer, _)| *layer)
}

/// Returns every path in a file, single names included.
fn paths(tokens: &[Token]) -> Vec<UsedPath<'_>> {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut found = Vec::new();
    // Modules around the current place, each with the depth of braces outside it.
    let mut inner: Vec<(&str, usize)> = Vec::new();
    let (mut depth, mut at) = (0, 0);
    while at < tokens.len() {
        match text(at) {
            "{" => depth += 1,
            "}" => {
                depth -= 1;
                inner.pop_if(|(_, outside)| *outside == depth);
            }
            "mod" if text(at + 2) == "{" => inner.push((text(at + 1), depth)),
            word if is_name(word) => {
                let inner: Vec<_> = inner.iter().map(|(name, _)| *name).collect();
                at = use_tree(tokens, at, &[], &inner, &mut found);
                continue;
            }
            _ => {}
        }
        at += 1;
    }
    found
}

/// Reads a path or a `use` tree and returns the place after it.
fn use_tree<'a>(
    tokens: &'a [Token],
    start: usize,
    prefix: &[&'a str],
    inner: &[&'a str],
    found: &mut Vec<UsedPath<'a>>,
) -> usize {
    let text = |at: usize| tokens.get(at).map_or("", |token| token.text.as_str());
    let mut segments = prefix.to_vec();
    let mut at = start;
    while is_name(text(at)) || text(at) == "*" {
        segments.push(text(at));
        at += 1;
        if text(at) != "::" || text(at + 1) == "<" {
            break;
        }
        at += 1;
        if text(at) == "{" {
            at += 1;
            while at < tokens.len() && text(at) != "}" {
                // A comma, or whatever a macro put there.
                at = if is_name(text(at)) || text(at) == "*" {
                    use_tree(tokens, at, &segments, inner, found)
                } else {
                    at + 1
                };
            }
            return at + 1;
        }
    }
    if text(at) == "as" {
        segments.push("as");
        // The new name is no path; the type of a cast is.
        at += if [",", ";", "}"].contains(&text(at + 2)) { 2 } else { 1 };
    }
    found.push(UsedPath { segments, token: &tokens[start], inner: inner.to_vec() });
    at
}

fn is_name(text: &str) -> bool {
    text.starts_with(|c: char| c.is_alphabetic() || c == '_')
}

/// Marks the items under `#[test]` and `#[cfg(test)]`.
fn mark_tests(tokens: &mut [Token]) {
    let mut at = 0;
    while at + 1 < tokens.len() {
        if tokens[at].text != "#" || tokens[at + 1].text != "[" {
            at += 1;
            continue;
        }
        let after = skip(tokens, at + 1);
        let attribute: Vec<_> = tokens[at + 2..after].iter().map(|token| token.text.as_str()).collect();
        let of_tests = match attribute.first() {
            Some(&"test") => true,
            Some(&"cfg") => attribute.contains(&"test") && !attribute.contains(&"not"),
            _ => false,
        };
        if of_tests {
            let mut end = after;
            while end < tokens.len() && ![";", "{"].contains(&tokens[end].text.as_str()) {
                end = skip(tokens, end);
            }
            let end = skip(tokens, end).min(tokens.len());
            tokens[at..end].iter_mut().for_each(|token| token.in_test = true);
        }
        at = after;
    }
}

/// Returns the place after a token, or after the whole group where one opens.
fn skip(tokens: &[Token], start: usize) -> usize {
    let mut depth = 0;
    for (at, token) in tokens.iter().enumerate().skip(start) {
        match token.text.as_str() {
            "(" | "[" | "{" => depth += 1,
            ")" | "]" | "}" => depth -= 1,
            _ => {}
        }
        if depth <= 0 {
            return at + 1;
        }
    }
    tokens.len()
}

/// Splits a source into names and marks; comments, text, numbers and lifetimes are left out.
fn tokens(text: &str) -> Vec<Token> {
    let chars: Vec<char> = text.chars().collect();
    let char_at = |at: usize| chars.get(at).copied().unwrap_or('\0');
    let starts = |at: usize, what: &str| what.chars().enumerate().all(|(i, c)| char_at(at + i) == c);
    let word_end =
        |at: usize| (at..).find(|&end| !(char_at(end).is_alphanumeric() || char_at(end) == '_')).unwrap_or(at);
    let mut found = Vec::new();
    let (mut at, mut line) = (0, 1);
    while at < chars.len() {
        let start = at;
        let mut token = None;
        if starts(at, "//") {
            at = (at..chars.len()).find(|&end| chars[end] == '\n').unwrap_or(chars.len());
        } else if starts(at, "/*") {
            let mut depth = 0;
            while at < chars.len() {
                let step = if starts(at, "/*") {
                    1
                } else if starts(at, "*/") {
                    -1
                } else {
                    0
                };
                depth += step;
                at += if step == 0 { 1 } else { 2 };
                if depth == 0 {
                    break;
                }
            }
        } else if let Some(end) = raw_text_end(&chars, at) {
            at = end;
        } else if char_at(at) == '"' {
            at += 1;
            while at < chars.len() && chars[at] != '"' {
                at += if chars[at] == '\\' { 2 } else { 1 };
            }
            at += 1;
        } else if char_at(at) == '\'' {
            let is_char = char_at(at + 1) == '\\' || char_at(at + 2) == '\'';
            // Skips an escaped quote; the character ends with the next one.
            at = if is_char {
                (at + 3..).find(|&end| end >= chars.len() || chars[end - 1] == '\'').unwrap_or(at)
            } else {
                word_end(at + 1)
            };
        } else if char_at(at).is_numeric() {
            at = word_end(at);
        } else if char_at(at).is_alphabetic() || char_at(at) == '_' {
            at = word_end(at);
            token = Some(chars[start..at].iter().collect());
        } else if starts(at, "::") {
            at += 2;
            token = Some("::".to_owned());
        } else {
            at += 1;
            token = (!char_at(start).is_whitespace()).then(|| char_at(start).to_string());
        }
        let at_end = at.min(chars.len());
        found.extend(token.map(|text| Token { text, line, in_test: false }));
        line += chars[start..at_end].iter().filter(|c| **c == '\n').count();
    }
    found
}

/// Returns the place after a raw string that starts here, if one does.
fn raw_text_end(chars: &[char], start: usize) -> Option<usize> {
    let prefix = chars[start..].iter().take_while(|c| c.is_alphabetic()).count();
    if !["r", "br", "cr"].iter().any(|word| word.chars().eq(chars[start..start + prefix].iter().copied())) {
        return None;
    }
    let hashes = chars[start + prefix..].iter().take_while(|c| **c == '#').count();
    let open = start + prefix + hashes;
    if chars.get(open) != Some(&'"') {
        return None;
    }
    let close: Vec<char> = std::iter::once('"').chain(std::iter::repeat_n('#', hashes)).collect();
    let end = chars[open + 1..].windows(close.len()).position(|window| window == close);
    Some(end.map_or(chars.len(), |end| open + 1 + end + close.len()))
}

fn rust_files(folder: &Path) -> Vec<PathBuf> {
    let mut found = Vec::new();
    for entry in std::fs::read_dir(folder).expect("folders are readable") {
        let path = entry.expect("entries are readable").path();
        if path.is_dir() {
            found.extend(rust_files(&path));
        } else if path.extension().is_some_and(|extension| extension == "rs") {
            found.push(path);
        }
    }
    found.sort();
    found
}

/// Checks what is found in one file.
#[track_caller]
fn check(file: &str, text: &str, expected: &[&str]) {
    let findings: Vec<_> = check_all(&[Source::new(file, text)]).iter().map(Finding::to_string).collect();
    assert_eq!(findings, expected, "{text}");
}

#[test]
fn arrows_that_point_down_are_fine() {
    check("motion/mod.rs", "use crate::{bvh, skeleton::{Joint, JointId}};\nfn f() { crate::math::g() }", &[]);
    check("document/edits.rs", "use super::solved; use crate::document::Source; pub(crate) fn f() {}", &[]);
    check(
        "motion/decode.rs",
        "pub(super) fn f() {} use self::g; mod tests { use super::*; use super::super::h; }",
        &[],
    );
    check("main.rs", "fn main() { walkabout::app::run(); println!(); }", &[]);
    check("lib.rs", "pub use document::Edits;", &[]);
}

#[test]
fn arrows_that_point_up_or_sideways_are_found() {
    check(
        "motion/mod.rs",
        "use std::sync::Arc;\nuse crate::path::Degree;",
        &["src/motion/mod.rs:2: `crate::path::Degree`: motion (layer 2) → path (layer 3) points up"],
    );
    check(
        "tui/mod.rs",
        "fn f() {\n    crate::link::send();\n}",
        &["src/tui/mod.rs:2: `crate::link::send`: tui (layer 7) → link (layer 7) points sideways"],
    );
    check(
        "curve.rs",
        "use walkabout::editor::Editor as E;",
        &["src/curve.rs:1: `walkabout::editor::Editor::as`: curve (layer 1) → editor (layer 6) points up"],
    );
    check(
        "measure/mod.rs",
        "use crate::constrain;",
        &["src/measure/mod.rs:1: `crate::constrain`: measure (layer 4) → constrain (layer 4) points sideways"],
    );
    check(
        "path/mod.rs",
        "mod tests {\n use crate::displace::Layer;\n}",
        &["src/path/mod.rs:2: `crate::displace::Layer`: path (layer 3) → displace (layer 3) points sideways"],
    );
}

#[test]
fn groups_are_looked_into() {
    check(
        "document/edits.rs",
        "use crate::{\n    motion::{Clip, self},\n    scene::Scene,\n    editor::*,\n};",
        &[
            "src/document/edits.rs:3: `crate::scene::Scene`: document (layer 5) → scene (layer 5) points sideways",
            "src/document/edits.rs:4: `crate::editor::*`: document (layer 5) → editor (layer 6) points up",
        ],
    );
}

#[test]
fn super_that_leaves_the_module_is_followed() {
    check(
        "bvh/read/rows.rs",
        "use super::super::super::motion::Clip;",
        &["src/bvh/read/rows.rs:1: `super::super::super::motion::Clip`: bvh (layer 1) → motion (layer 2) points up"],
    );
    check(
        "bvh/read.rs",
        "mod inner {\n    use super::super::header;\n    use self::super::super::super::app;\n}",
        &["src/bvh/read.rs:3: `self::super::super::super::app`: bvh (layer 1) → app (layer 8) points up"],
    );
    // After the inner module has ended, one `super` less leaves the file's module.
    check(
        "bvh/read.rs",
        "mod inner { fn f() {} }\nuse super::super::{motion, math};",
        &["src/bvh/read.rs:2: `super::super::motion`: bvh (layer 1) → motion (layer 2) points up"],
    );
}

#[test]
fn the_crates_root_is_no_way_round() {
    for way in ["crate::*", "crate as root", "crate::{self as root}", "super::*"] {
        let findings = check_all(&[Source::new("key/mod.rs", &format!("use {way};"))]);
        let [finding] = &findings[..] else { panic!("{way} was not found once") };
        assert!(finding.what.ends_with("key names the crate's root, which hides what it uses"), "{}", finding.what);
    }
    check(
        "key/mod.rs",
        "use crate::Shortcut;",
        &["src/key/mod.rs:1: `crate::Shortcut`: key → Shortcut, which is not in the table of layers"],
    );
}

#[test]
fn a_module_outside_the_table_is_found() {
    check("utils/mod.rs", "", &["src/utils/mod.rs:1: `utils` is not in the table of layers"]);
    check("bin/other.rs", "fn main() {}", &["src/bin/other.rs:1: `bin` is not in the table of layers"]);
}

#[test]
fn unsafe_lives_in_viewport() {
    check("link/mod.rs", "// unsafe\nunsafe fn f() {}", &["src/link/mod.rs:2: `unsafe` in link: it lives in viewport"]);
    check("viewport/device.rs", "unsafe fn f() {}", &[]);
    check("cli/mod.rs", "#![forbid(unsafe_code)]", &[]);
}

#[test]
fn files_are_opened_from_document_up() {
    let what = "in bvh (layer 1): files are opened from layer 5 up";
    check("bvh/mod.rs", "use std::{fs, io};", &[&format!("src/bvh/mod.rs:1: `std::fs` {what}")]);
    check("bvh/mod.rs", "fn f() { File::open(p) }", &[&format!("src/bvh/mod.rs:1: `File::open` {what}")]);
    check("bvh/mod.rs", "use tempfile::tempfile;", &[&format!("src/bvh/mod.rs:1: `tempfile::tempfile` {what}")]);
    check("bvh/mod.rs", "use crate::bvh::File; fn f() -> File { File { joints: 1 } }", &[]);
    check("document/project.rs", "use std::fs;", &[]);
}

#[test]
fn tests_may_read_files_and_print() {
    check("bvh/mod.rs", "#[cfg(test)]\nmod tests { use std::fs; fn f(_: [u8; 2]) { println!() } }", &[]);
    check("bvh/mod.rs", "#[cfg(all(test, unix))] #[rustfmt::skip] fn f(_: [u8; 2]) { std::fs::read(p) }", &[]);
    check(
        "bvh/mod.rs",
        "#[cfg(test)] use std::fs;\nfn f() { std::fs::read(p) }",
        &["src/bvh/mod.rs:2: `std::fs::read` in bvh (layer 1): files are opened from layer 5 up"],
    );
    check(
        "bvh/mod.rs",
        "#[cfg(not(test))] fn f() { std::fs::read(p) }",
        &["src/bvh/mod.rs:1: `std::fs::read` in bvh (layer 1): files are opened from layer 5 up"],
    );
    let parent = Source::new("bvh/mod.rs", "#[cfg(test)]\nmod tests;\nmod read;");
    let tests = Source::new("bvh/tests/quirks.rs", "use std::fs;");
    let read = Source::new("bvh/read.rs", "use std::fs;");
    let files: Vec<_> = check_all(&[parent, tests, read]).into_iter().map(|finding| finding.file).collect();
    assert_eq!(files, ["bvh/read.rs"]);
}

#[test]
fn clocks_are_read_from_editor_up() {
    let what = "in scene (layer 5): clocks are read from layer 6 up";
    check("scene/mod.rs", "let t = Instant::now();", &[&format!("src/scene/mod.rs:1: `Instant::now` {what}")]);
    check(
        "scene/mod.rs",
        "use std::time::SystemTime;",
        &[&format!("src/scene/mod.rs:1: `std::time::SystemTime` {what}")],
    );
    check("scene/mod.rs", "use std::time::Duration;", &[]);
    check("editor/mod.rs", "let t = std::time::Instant::now();", &[]);
}

#[test]
fn only_the_program_prints() {
    check(
        "tui/mod.rs",
        "fn f() {\n    eprintln!(\"lost\");\n}",
        &["src/tui/mod.rs:2: `eprintln!` in tui: only app, cli, main print"],
    );
    check("cli/info.rs", "fn f() { println!() }", &[]);
    check("tui/mod.rs", "fn print() {} fn f() { self.print(); write!(f, \"\") }", &[]);
}

#[test]
fn comments_and_text_do_not_count() {
    check("math/mod.rs", "//! [`crate::editor`]\n/* crate::app /* nested */ unsafe */\nfn f() {}", &[]);
    check("math/mod.rs", r####"const A: &str = r#"crate::app " unsafe"#; const B: &str = "\" crate::app";"####, &[]);
    check("math/mod.rs", r"fn f<'a>(c: &'a char) -> bool { ['\'', '\\', '\u{1F600}', '{', 'x'].contains(c) }", &[]);
    // What follows text is read again, on the right line.
    check(
        "math/mod.rs",
        "const A: &str = \"\n\\\"\"; const C: char = '\"';\nuse crate::app; // '",
        &["src/math/mod.rs:3: `crate::app`: math (layer 0) → app (layer 8) points up"],
    );
    check("math/mod.rs", "fn f() { let r = 1; let x = 1.0e-3..2.0; b'\\''; br\"unsafe\" }", &[]);
}
