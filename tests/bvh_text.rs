//! The reader's words and the writer's characters: odd and malformed texts, each beside what comes of it.

use walkabout::bvh::{Bvh, Channel, Digits, RowEdit};

/// Two joints, nine channels, two rows.
const SOUND: &str = "HIERARCHY
ROOT Hips
{
  OFFSET 0 90 0
  CHANNELS 6 Xposition Yposition Zposition Zrotation Xrotation Yrotation
  JOINT Knee
  {
    OFFSET 0 -45 0
    CHANNELS 3 Zrotation Xrotation Yrotation
    End Site
    {
      OFFSET 0 -45 0
    }
  }
}
MOTION
Frames: 2
Frame Time: 0.0333333
0.00 90.5\t1e1  1 2 3 4 5 6\x20
0.25 91 -0.0  +1 2. .3 4 5 6
";

const DIGITS: Digits = Digits { position_decimals: 3, rotation_decimals: 2 };

fn parse(text: impl AsRef<[u8]>) -> Bvh {
    Bvh::parse(text.as_ref(), "walk.bvh").unwrap_or_else(|e| panic!("{e}"))
}

#[test]
fn a_sound_file_is_read_without_a_word() {
    let bvh = parse(SOUND);
    assert!(bvh.warnings().is_empty(), "{:?}", bvh.warnings());
    assert_eq!((bvh.n_frames(), bvh.n_channels(), bvh.frame_time_secs()), (2, 9, 0.0333333));
    assert_eq!(bvh.frame(1), [0.25, 91.0, 0.0, 1.0, 2.0, 0.3, 4.0, 5.0, 6.0]);
    let [hips, knee] = bvh.joints() else { panic!("two joints") };
    assert_eq!((&hips.name[..], hips.parent, hips.offset, hips.end_site), ("Hips", None, [0.0, 90.0, 0.0], None));
    assert_eq!((&knee.name[..], knee.parent, knee.first_channel), ("Knee", Some(0), 6));
    assert_eq!(knee.end_site, Some([0.0, -45.0, 0.0]));
    assert_eq!(knee.channels, [Channel::Zrotation, Channel::Xrotation, Channel::Yrotation]);
}

/// Puts `new` in the place of the first `old` and checks the refusal's exact words.
fn check_refused(old: &str, new: &str, expected: &str) {
    assert!(SOUND.contains(old), "{old:?}");
    let text = SOUND.replacen(old, new, 1);
    let error = Bvh::parse(text.as_bytes(), "walk.bvh").expect_err(new);
    assert_eq!(error.to_string(), format!("walk.bvh:{expected}"), "{text}");
}

#[test]
fn malformed_files_are_refused_with_place_expectation_and_finding() {
    check_refused(SOUND, "", "1:1: expected `HIERARCHY`, found the end of the file");
    check_refused("HIERARCHY", "PK\x03\x04", "1:1: expected `HIERARCHY`, found `PK\\u{3}\\u{4}`");
    check_refused("ROOT", "JOINT", "2:1: expected `ROOT`, found `JOINT`");
    check_refused("Hips\n{", "Hips\n", "4:3: expected `{`, found `OFFSET`");
    check_refused("OFFSET 0 90 0", "OFFSET 0 9O 0", "4:12: expected a number, found `9O`");
    check_refused("OFFSET 0 90 0", "OFFSET 0 90", "5:3: expected a number, found `CHANNELS`");
    check_refused("0 90 0", "0 inf 0", "4:12: expected a finite number, found `inf`");
    check_refused("0 90 0", "0 0,5 0", "4:12: expected a number, found `0,5`");
    check_refused("CHANNELS 6", "CHANNELS six", "5:12: expected a count, found `six`");
    check_refused("6 Xposition", "6 Xscale", "5:14: expected a channel name, found `Xscale`");
    check_refused("JOINT", "BONE", "6:3: expected `JOINT`, `End Site` or `}`, found `BONE`");
    check_refused("  CHANNELS 3", "  OFFSET", "9:5: expected `CHANNELS`, `JOINT`, `End Site` or `}`, found `OFFSET`");
    check_refused("      OFFSET", "      CHANNELS 0", "12:7: expected `OFFSET` or `}`, found `CHANNELS`");
    check_refused("  }\n}\n", "  }\n", "15:1: expected `}`, found `MOTION`");
    check_refused("}\nMOTION", "}\n}\nMOTION", "16:1: expected `ROOT` or `MOTION`, found `}`");
    check_refused("Frames: 2", "2", "17:1: expected `Frames:` or `Frame Time:`, found `2`");
    check_refused("Frames: 2\n", "", "18:1: expected `Frames:`, found `0.00`");
    check_refused("Frame Time: 0.0333333\n", "", "18:1: expected `Frame Time:`, found `0.00`");
    check_refused("Frame Time", "Frame Rate", "18:7: expected `Time:`, found `Rate:`");
    check_refused("Frames: 2", "Frames: many", "17:9: expected a number, found `many`");
    check_refused("90.5", "9°", "19:6: expected a number, found `9°`");
    check_refused("0.25 91", "ä 91", "20:1: expected a number, found `ä`");
    check_refused("4 5 6 \n", "4 5\n", "19:25: expected value 9 of 9 in row 1, found the end of the line");
    check_refused("4 5 6 \n", "4 5 6 7\n", "19:28: expected a new line after the 9 values of row 1, found `7`");
    check_refused("5 6\n", "5 6 7\n", "20:30: expected a new line after the 9 values of row 2, found `7`");
}

/// Puts `new` in the place of the first `old` and checks the warnings' exact words and the number of rows.
fn check_warned(old: &str, new: &str, rows: usize, expected: &[&str]) {
    assert!(SOUND.contains(old), "{old:?}");
    let bvh = parse(SOUND.replacen(old, new, 1));
    let warnings: Vec<_> = bvh.warnings().iter().map(ToString::to_string).collect();
    assert_eq!(
        (bvh.n_frames(), &warnings[..]),
        (rows, &expected.iter().map(ToString::to_string).collect::<Vec<_>>()[..])
    );
}

#[test]
fn odd_files_are_read_with_a_warning() {
    check_warned("HIERARCHY\n", "", 2, &["line 1: `HIERARCHY` is missing"]);
    check_warned("JOINT Knee", "JOINT", 2, &["line 7: a joint has no name"]);
    check_warned("JOINT Knee", "JOINT Hips", 2, &["line 6: another joint is named `Hips`"]);
    check_warned("    OFFSET 0 -45 0\n", "", 2, &["line 6: `Knee` or its end site has no OFFSET: zero is used"]);
    check_warned("      OFFSET 0 -45 0\n", "", 2, &["line 10: `Knee` or its end site has no OFFSET: zero is used"]);
    check_warned("S 3", "S 2", 2, &["line 9: CHANNELS of `Knee` says 2, but 3 are named: the names are used"]);
    check_warned(
        "    }\n",
        "    }\n    End Site { OFFSET 1 0 0 }\n",
        2,
        &["line 14: another End Site of `Knee` is kept in the file but not shown"],
    );
    check_warned(
        "}\nMOTION",
        "}\nROOT Ball { OFFSET 0 0 0 CHANNELS 0 }\nMOTION",
        2,
        &["line 16: another ROOT, `Ball`: the file holds several trees"],
    );
    check_warned(
        "}\nMOTION",
        "}\nROOT Ball { OFFSET 0 0 0 }\nMOTION",
        2,
        &[
            "line 16: another ROOT, `Ball`: the file holds several trees",
            "line 16: `Ball` has no CHANNELS: it does not move",
        ],
    );
    check_warned(
        "Frames: 2",
        "Frames: 1",
        1,
        &["line 20: text after the 1 rows that `Frames:` declares is kept but not read"],
    );
    check_warned(
        "Frames: 2",
        "Frames: 99999999999999999999",
        2,
        &["line 21: `Frames:` says 18446744073709551615, but there are 2 rows"],
    );
    check_warned("Frames: 2", "Frames: 2.5", 2, &["line 17: `Frames:` says 2.5: the rows are counted instead"]);
    check_warned("0.0333333", "-1", 2, &["line 18: `Frame Time:` is not positive"]);
    check_warned(
        "4 5 6\n",
        "4",
        1,
        &["line 20: the last row has 7 of 9 values and is left out", "line 20: `Frames:` says 2, but there are 1 rows"],
    );
    check_warned("1e1", "\n1e1\n", 2, &["line 20: rows go on over several lines"]);
    check_warned("6 \n", "6 ", 2, &["line 19: a line holds several rows"]);
}

#[test]
fn names_are_lines_in_any_encoding() {
    let name = |bytes: &[u8]| {
        let text =
            [SOUND.split("Knee").next().unwrap().as_bytes(), bytes, SOUND.split("Knee").nth(1).unwrap().as_bytes()];
        let bvh = parse(text.concat());
        (bvh.joints()[1].name.clone(), bvh.warnings().first().map(ToString::to_string))
    };
    assert_eq!(name("Left  knee #2 ".as_bytes()), ("Left  knee #2".into(), None));
    assert_eq!(name("Жесть".as_bytes()), ("Жесть".into(), None));
    let latin = "line 6: the name `Knié` is not UTF-8 and was read as Latin-1".to_owned();
    assert_eq!(name(b"Kni\xe9"), ("Knié".into(), Some(latin)));
}

#[test]
fn a_file_on_one_line_is_read() {
    let (tree, motion) = SOUND.split_once("MOTION").unwrap();
    let bvh = parse([&tree.replace('\n', " ").replace("Hips", "Hips "), "MOTION", &motion.replace('\n', " ")].concat());
    assert_eq!((bvh.joints().len(), bvh.n_frames()), (2, 2));
    let reverse = [RowEdit { source_row: 1, changed: &[] }, RowEdit { source_row: 0, changed: &[] }];
    let reversed = parse(bvh.write_rows(&reverse, DIGITS));
    assert_eq!((reversed.frame(0), reversed.frame(1)), (bvh.frame(1), bvh.frame(0)));
}

/// Writes rows of `text` and compares what follows the frame time, and the frame count.
fn check_rows(text: &str, rows: &[RowEdit<'_>], n_frames: &str, expected: &str) {
    let written = String::from_utf8(parse(text).write_rows(rows, DIGITS)).unwrap();
    let (head, tail) = written.split_once("0.0333333").unwrap();
    assert_eq!(tail, expected);
    let source_head = text.split_once("0.0333333").unwrap().0;
    assert_eq!(head, source_head.replace("Frames: 2", n_frames));
}

fn copy(source_row: usize) -> RowEdit<'static> {
    RowEdit { source_row, changed: &[] }
}

const ROW_0: &str = "0.00 90.5\t1e1  1 2 3 4 5 6 \n";
const ROW_1: &str = "0.25 91 -0.0  +1 2. .3 4 5 6\n";

#[test]
fn only_changed_channels_get_new_characters() {
    let changed = [(0, -0.0004), (2, 10.0), (4, 123.456), (8, 7.0)];
    let edited = RowEdit { source_row: 0, changed: &changed };
    check_rows(SOUND, &[edited, copy(1)], "Frames: 2", &format!("\n0.000 90.5\t1e1  1 123.46 3 4 5 7.00 \n{ROW_1}"));
}

#[test]
fn rows_repeat_and_go_with_their_own_blanks() {
    check_rows(SOUND, &[], "Frames: 0", "\n");
    check_rows(SOUND, &[copy(1)], "Frames: 1", &format!("\n{ROW_1}"));
    check_rows(SOUND, &[copy(0)], "Frames: 1", &format!("\n{ROW_0}"));
    check_rows(SOUND, &[copy(1), copy(0)], "Frames: 2", &format!("\n{ROW_1}{ROW_0}"));
    check_rows(SOUND, &[copy(0), copy(1), copy(0)], "Frames: 3", &format!("\n{ROW_0}{ROW_1}{ROW_0}"));
}

#[test]
fn the_end_of_the_file_stays_as_it_was() {
    let unended = SOUND.trim_end();
    check_rows(unended, &[copy(0), copy(1)], "Frames: 2", &format!("\n{ROW_0}{}", ROW_1.trim_end()));
    check_rows(unended, &[copy(1), copy(1)], "Frames: 2", &format!("\n{ROW_1}{}", ROW_1.trim_end()));
    check_rows(unended, &[copy(0)], "Frames: 1", &format!("\n{}", ROW_0.trim_end_matches('\n')));

    let spaced = SOUND.replace("6 \n", "6 # note\n\n \n\t") + "\n7 8 9\nmore";
    let middle = "0.00 90.5\t1e1  1 2 3 4 5 6 # note\n\n \n\t";
    check_rows(&spaced, &[copy(0), copy(1)], "Frames: 2", &format!("\n{middle}{ROW_1}\n7 8 9\nmore"));
    check_rows(&spaced, &[copy(1), copy(0)], "Frames: 2", &format!("\n\t{ROW_1}0.00 90.5\t1e1  1 2 3 4 5 6 # note\n"));

    let windows = SOUND.replace('\n', "\r\n");
    let rows = format!("\r\n{}{}", ROW_1.replace('\n', "\r\n"), ROW_0.replace('\n', "\r\n"));
    check_rows(&windows, &[copy(1), copy(0)], "Frames: 2", &rows);
    let unended = windows.trim_end();
    check_rows(unended, &[copy(1), copy(0)], "Frames: 2", rows.trim_end_matches("\r\n"));
}
