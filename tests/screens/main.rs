//! Whole screens without a terminal: every size draws, the start screen and the pages made from tables are as committed.
//!
//! `WALKABOUT_BLESS=1` writes `start.txt` beside this file and what stands in `docs` anew, to be looked at and committed.

mod svg;

use std::{env, fs, path::Path, process::Command};

use ratatui::{Terminal, backend::TestBackend, buffer::Buffer, layout::Position};
use walkabout::{
    document::{self, Document},
    editor::{Editor, Message, TABS, Tab},
    scene::Picture,
    tui::{self, Depth, Drawn, Palette, Surroundings},
};

const AROUND: Surroundings<'_> = Surroundings {
    palette: Palette::new(Depth::True),
    window_line: "window closed; w opens it",
    picture: None,
    pane_open: false,
};

/// Sizes that people have, and some that nobody should have.
const SIZES: [(u16, u16); 12] =
    [(80, 24), (120, 40), (200, 60), (120, 36), (36, 8), (10, 3), (37, 5), (300, 2), (3, 100), (1, 1), (2, 7), (0, 0)];

fn start() -> Editor {
    let opened = document::open(None).expect("the built-in clip opens");
    Editor::new(Document::new(opened), Vec::new())
}

fn after(keys: &str) -> Editor {
    let mut editor = start();
    editor.keys(keys);
    editor
}

/// Draws a screen; returns it with the place of the cursor, if it is shown, and what drawing found out.
fn drawn(editor: &Editor, around: &Surroundings<'_>, (width, height): (u16, u16)) -> (Buffer, Position, Drawn) {
    let mut terminal = Terminal::new(TestBackend::new(width, height)).expect("no terminal to fail");
    let scene = editor.scene();
    let mut found = Drawn::default();
    terminal.draw(|frame| found = tui::draw(frame, editor, &scene, around)).expect("no terminal to fail");
    let cursor = terminal.get_cursor_position().expect("no terminal to fail");
    (terminal.backend().buffer().clone(), cursor, found)
}

fn lines(buf: &Buffer) -> Vec<String> {
    let rows = buf.content.chunks(usize::from(buf.area.width).max(1));
    rows.map(|row| row.iter().map(|cell| cell.symbol()).collect::<String>().trim_end().to_owned()).collect()
}

fn screen(keys: &str, size: (u16, u16)) -> Vec<String> {
    lines(&drawn(&after(keys), &AROUND, size).0)
}

/// Compares a text with a committed file, or writes the file.
#[track_caller]
fn check_file(file: &str, text: &str) {
    let path = Path::new(env!("CARGO_MANIFEST_DIR")).join(file);
    if env::var_os("WALKABOUT_BLESS").is_some() {
        fs::create_dir_all(path.parent().expect("a file in a folder")).expect("a folder to write to");
        fs::write(&path, text).expect("written");
        return;
    }
    let committed = fs::read_to_string(&path).unwrap_or_default();
    assert!(
        committed == text,
        "{file} is out of date; `cargo xtask bless screens` writes it anew. It would be:\n{text}"
    );
}

#[test]
fn every_screen_draws_in_every_size() {
    let start = start();
    let keys = [
        "?",
        "?jjj<pagedown>",
        ":",
        ":path.degree=x<enter>",
        "c",
        "scq",
        "S",
        "s",
        "a",
        "v",
        "m",
        "lmcl8lmx",
        "s!",
        "<space>",
        "2",
        "3",
        "4",
    ];
    let mut editors: Vec<_> = keys
        .into_iter()
        .map(String::from)
        .chain((0..TABS.len()).map(|i| "<tab>".repeat(i)))
        .map(|keys| {
            let mut editor = start.clone();
            editor.keys(&keys);
            editor
        })
        .collect();
    let mut long = start.clone();
    long.say(Message::error("a line that is too long for any screen ".repeat(20)));
    editors.push(long);
    let picture = Picture { width: 64, height: 48, rgb: (0..64 * 48 * 3).map(|i| (i % 251) as u8).collect() };
    for depth in [Depth::Monochrome, Depth::Sixteen, Depth::True] {
        let palette = Palette::new(depth);
        let with_pane = Surroundings { palette, pane_open: true, picture: Some(&picture), ..AROUND };
        for around in [Surroundings { palette, ..AROUND }, Surroundings { picture: None, ..with_pane }, with_pane] {
            for size in SIZES {
                for editor in &editors {
                    let (buf, cursor, _) = drawn(editor, &around, size);
                    assert!(cursor.x < size.0.max(1) && cursor.y < size.1.max(1), "{cursor:?} at {size:?}");
                    assert_eq!((buf.area.width, buf.area.height), size);
                }
            }
        }
    }
}

#[test]
fn everything_stands_in_its_place() {
    let start = screen("", (80, 24));
    assert!(
        start[0].starts_with("walkabout · built-in walk ") && start[0].ends_with(AROUND.window_line),
        "{}",
        start[0]
    );
    assert!(start[1].contains(" [path] original  timing  feet ") && start[1].ends_with("›"), "{}", start[1]);
    assert_eq!(start[17], "frame 0 of 569   0.00 s of 9.48 s");
    assert_eq!(start[18], format!("  ┃{}", "─".repeat(77)));
    assert!(start[19].starts_with("L ▄") && start[20].starts_with("R ▄"), "{} {}", start[19], start[20]);
    assert!(start[23].starts_with("? keys  space play  tab panel "), "{}", start[23]);
    assert!(screen("x", (80, 24))[0].starts_with("walkabout · built-in walk · unsaved "));
}

#[test]
fn the_score_is_said_in_full_at_every_width() {
    let lower = |screen: &[String], n_rows: usize| screen[screen.len() - 1 - n_rows..screen.len() - 1].to_vec();
    for width in [80, 100, 120, 179] {
        let rows = lower(&screen("", (width, 24)), 2);
        assert!(rows[0].starts_with("planted  L 0.") && rows[0].contains(" H/s, L "), "{rows:?}");
        assert!(rows[0].contains("→") && rows[0].contains(" R ") && rows[0].ends_with(" cm/s"), "{rows:?}");
        assert!(rows[1].starts_with("slip p90 L 0.") && rows[1].contains(" H, L "), "{rows:?}");
        assert!(rows[1].contains(" cm   ") && rows[1].ends_with("‖ paused"), "{rows:?}");
    }
    assert!(lower(&screen("", (120, 40)), 1)[0].ends_with("  point 1  camera 1  frame 0/569  ‖ paused"));
    let wide = lower(&screen("", (180, 40)), 2);
    assert!(wide[0].starts_with("R ▄") && wide[1].starts_with("feet L 0."), "one row has room for all: {wide:?}");
    assert!(wide[1].contains(" cm/s · slip L 0.") && wide[1].contains(" cm   "), "{wide:?}");
    let low = lower(&screen("", (80, 23)), 2);
    assert!(low[0].starts_with("R ▄"), "the picture needs the row: {low:?}");
    assert!(low[1].starts_with("L 0.") && low[1].contains(" H/s · slip L 0."), "{low:?}");
    assert!(low[1].ends_with(" H    ‖ paused"), "{low:?}");
    let told = lower(&screen("f", (80, 24)), 2);
    assert!(told[0].starts_with("planted  L 0.") && told[1].contains("follow"), "a message takes one row: {told:?}");
    // A foot that is to stand for ever: it is missed, and that is said too.
    let missed = lower(&screen(":plant=[{foot=\"left\",first=0,last=300,mode=\"clean\"}]<enter><esc>", (80, 24)), 2);
    assert!(missed[0].ends_with(" cm/s") && missed[1].contains(" cm · "), "{missed:?}");
    assert!(missed[1].contains(" missed  "), "{missed:?}");
}

#[test]
fn one_row_is_marked_as_selected() {
    for (keys, row) in [("", "path.edited"), ("jj", "path.points"), ("<tab>", "original.degree"), ("nn", "◆ point 3")]
    {
        let screen = screen(keys, (80, 24));
        let marked: Vec<_> = screen.iter().filter_map(|line| line.split_once("▸ ")).collect();
        assert!(matches!(marked[..], [(_, name)] if name.starts_with(row)), "after {keys}: {marked:?}");
    }
}

#[test]
fn each_state_says_what_it_is() {
    for (keys, text) in [
        ("?", "Play or pause."),
        ("s", "A figure eight."),
        ("s!", "s! does nothing here; ? shows the keys"),
        ("c", "point 1 x y z: "),
        ("xq", "quit without saving the project? (y/n)"),
        ("<space>", "▶ playing"),
        ("<s-tab>", "path error"),
        ("<s-tab><s-tab>", "RMS x "),
        ("<s-tab><s-tab>", "original degree "),
        ("<s-tab><s-tab><s-tab>", "[camera]"),
        ("2", "camera 2"),
        ("m", "Split it at the playhead."),
        ("<tab><tab><tab>", "[feet]"),
        ("<tab><tab><tab>l", "◆ plant 2"),
        ("l6l6", "█◆█"),
        ("lmc", "c███◆███"),
        ("lms", "~~◆~~"),
        ("g", "Select its chain to the root, or not."),
        ("gcgcgr", "Chest, selected; 3 selected"),
        ("<tab><tab><tab><tab>gtiD250<enter>0", "─◆─"),
        ("<tab><tab><tab><tab>gtiD250<enter>0", "*◆ 2 keys"),
        ("<tab><tab><tab><tab>", "gt gr select"),
        ("I", "I at another frame sets the second"),
    ] {
        let with = |keys| screen(keys, (120, 40)).join("\n");
        assert!(with(keys).contains(text) && !with("").contains(text), "after {keys}:\n{}", with(keys));
    }
    let waiting = Surroundings { pane_open: true, ..AROUND };
    assert_eq!(lines(&drawn(&start(), &waiting, (80, 24)).0)[1].find("the first picture is on its way"), Some(0));
}

#[test]
fn a_line_being_typed_has_the_cursor_and_the_picture_is_wanted_in_the_size_of_its_place() {
    let (buf, cursor, found) = drawn(&after(":ab"), &AROUND, (120, 40));
    assert_eq!(lines(&buf)[38], "set NAME=VALUE: ab");
    assert_eq!(cursor, Position::new(18, 38));
    assert_eq!(found, Drawn { picture_size: (72, 64), help_end: 0 });
}

#[test]
fn the_joints_tab_says_how_to_move_a_joint() {
    let joints = "<tab><tab><tab><tab>";
    for (keys, words) in [("", "XYZ move it along"), ("eGG", "XYZ turn it about its parent's")] {
        // A narrow panel leaves the rest to the line below.
        for (size, panel, end) in [((80, 24), 45, "; e turn"), ((120, 40), 73, "{ } step, c type.")] {
            let screen = screen(&format!("{joints}{keys}"), size);
            let lines: Vec<String> = screen.iter().map(|line| line.chars().skip(panel).collect()).collect();
            let text = lines.iter().map(|line| line.trim()).collect::<Vec<_>>().join(" ");
            assert!(text.contains("gr selects its chain, gt it; xyz"), "{text}");
            assert!(text.contains(words) && text.contains(end), "{text}");
        }
    }
}

#[test]
fn the_maps_tab_shows_what_keys_hold_at_every_width() {
    let built_in = document::open(None).expect("the built-in clip opens").source.bvh.text().to_vec();
    let long = "skeleton:LeftUpperChestOfALongName";
    let text = String::from_utf8(built_in).expect("text").replace("Chest", long);
    let folder = tempfile::tempdir().expect("a folder");
    let file = folder.path().join("long.bvh");
    fs::write(&file, text).expect("written");
    let mut editor = Editor::new(Document::new(document::open(Some(&file)).expect("a clip")), Vec::new());
    editor.keys(":");
    editor.paste(&format!(
        "layer=[{{name='nod', position=[{{frame=20,value=[-12.345,-0.0,100.5]}}], rotation={{\
         '{long}'=[{{frame=120,value=[0.9,0,0,0.1]}}], Hips=[{{frame=120,value=[0.1,0.57,0.57,-0.57]}}]}}}}]"
    ));
    let maps = TABS.iter().position(|tab| *tab == Tab::Maps).expect("a tab");
    editor.keys(&format!("<enter>ga{}", "<tab>".repeat(maps)));
    for size in [(80, 24), (100, 30), (120, 40), (200, 50)] {
        let shown = lines(&drawn(&editor, &AROUND, size).0);
        for (value, name) in [
            ("  20 -12.35 0.00 100.50", "position"),
            ("120 97.24 97.24 -97.24°", "Hips"),
            ("120 0.00 0.00 12.68°", "skelet"),
        ] {
            let has = |line: &&String| line.split_once(value).is_some_and(|(_, rest)| rest.trim().starts_with(name));
            assert!(shown.iter().any(|line| has(&line)), "{size:?} {value}:\n{}", shown.join("\n"));
        }
        let in_full = "position: lateral -12.3450 up";
        assert!(shown.iter().any(|line| line.contains(in_full)), "{size:?}:\n{}", shown.join("\n"));
    }
}

#[test]
fn help_scrolls_to_its_end_and_no_farther() {
    let mut editor = after("?");
    let shown = |editor: &mut Editor| {
        let (buf, _, found) = drawn(editor, &AROUND, (80, 24));
        editor.end_help_at(found.help_end);
        lines(&buf)
    };
    let start = shown(&mut editor);
    editor.keys(&"<pagedown>".repeat(40));
    let end = shown(&mut editor);
    assert!(start != end && end.iter().any(|line| line.contains("Quit; asks")), "{}", end.join("\n"));
    editor.keys("j");
    assert_eq!(shown(&mut editor), end);
    editor.keys("k");
    assert_ne!(shown(&mut editor), end, "one line back is one line back");
    editor.keys("q?");
    assert_eq!(shown(&mut editor), start);
    let (_, _, found) = drawn(&editor, &AROUND, (300, 100));
    assert_eq!(found.help_end, 0, "all of it is shown");
}

#[test]
fn the_degree_is_changed_where_its_residuals_are_charted() {
    let residuals = "<tab>".repeat(TABS.iter().position(|tab| *tab == Tab::Residuals).expect("a tab"));
    for (keys, row) in [("", "▸ original.degree  auto"), ("]", "▸ original.degree *")] {
        let shown = screen(&format!("{residuals}{keys}"), (80, 24)).join("\n");
        assert!(shown.contains(row) && shown.contains("RMS x "), "{shown}");
    }
    let mut editor = after(&residuals);
    let before = editor.document().solved().residual_rms();
    editor.keys("]");
    assert!(editor.document().solved().residual_rms().length() < before.length());
}

#[test]
fn the_plan_leaves_out_what_the_view_in_focus_does() {
    let plan = |keys: &str| {
        screen(keys, (80, 24)).iter().map(|line| line.chars().take(40).collect()).collect::<Vec<String>>().join("\n")
    };
    assert!(plan("V2").contains('●') && !plan("V2vc").contains('●'), "{}", plan("V2vc"));
    assert!(plan("V2vcVn4").contains('●'), "the other view shows them");
    assert!(!plan("V2vcV1").contains('●') && plan("V2vcV1vc").contains('●'), "alone it leaves them out until told");
}

#[test]
fn the_start_screen_is_as_committed() {
    check_file("tests/screens/start.txt", &(screen("", (120, 40)).join("\n") + "\n"));
}

#[test]
fn the_joint_tree_is_as_committed() {
    // The left arm down to the elbow and all above it, the right wrist, with keys at two frames; the clip is replaced
    // from the second on; keys have lifted the right elbow.
    let keys = "2<tab><tab><tab><tab>gcgcgcgsgcgcgrgmgcgtgpgtiD250<enter>I$I0yy";
    check_file("tests/screens/joints.txt", &(screen(keys, (120, 40)).join("\n") + "\n"));
}

#[test]
fn the_tab_in_use_is_in_sight_at_every_width() {
    for (tab_idx, tab) in TABS.iter().enumerate() {
        for width in [80, 100, 120, 200] {
            let tabs = &screen(&"<tab>".repeat(tab_idx), (width, 24))[1];
            assert!(tabs.contains(&format!("[{}]", tab.title())), "{width}: {tabs}");
        }
    }
}

#[test]
fn the_picture_of_the_terminal_is_as_committed() {
    let mut editor = after("sc<space>");
    editor.advance(4.0);
    check_file("docs/terminal.svg", &svg::picture(&drawn(&editor, &AROUND, (120, 36)).0));
}

#[test]
fn the_tables_in_the_documentation_are_those_of_the_program() {
    for (verb, title) in [("keys", "Keys"), ("params", "Parameters")] {
        let output = Command::new(env!("CARGO_BIN_EXE_walkabout")).arg(verb).output().expect("the program starts");
        assert!(output.status.success(), "{output:?}");
        let table = String::from_utf8(output.stdout).expect("UTF-8");
        assert!(table.lines().count() > 40, "{table}");
        check_file(&format!("docs/{verb}.md"), &format!("# {title}\n\n{table}"));
    }
}
