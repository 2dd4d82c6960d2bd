//! The reader on broken bytes: nothing panics, nothing grows beyond the text, and whatever loads is written back.

use std::{env, fs, sync::Arc};

use proptest::prelude::*;
use walkabout::bvh::{Bvh, Digits, RowEdit};

const DIGITS: Digits = Digits { position_decimals: 6, rotation_decimals: 6 };

/// Small files with the oddities that the reader has a branch for.
const SEEDS: [&str; 6] = [
    "HIERARCHY\nROOT a b\n{\n OFFSET 0 1 0\n CHANNELS 3 Xposition Yrotation zrotation\n End Site\n {\n  OFFSET 0 1 0\n }\n}\nMOTION\nFrames: 3\nFrame Time: 0.1\n1 2 3\n4 5 6\n7 8 9\n",
    "\u{feff}# c\r\nHIERARCHY\r\nROOT a {\r\nOFFSET 0 1 0\r\nCHANNELS 2 Xrotation Yrotation JOINT b { CHANNELS 1 Zrotation } }\r\nMOTION\r\nFrames:4\r\nFrame Time:.1\r\n1e0 2 // x\r\n3\r\n\r\n4 5 6 7 8 9\r\n1 2 3 \x1a",
    "hierarchy root r { offset 0 0 0 channels 1 Xposition } root s { channels 0 } motion frame time: 1 frames: 2 1 2",
    "HIERARCHY\nROOT r\n{\nOFFSET 0 0 0\nCHANNELS 2 Xposition Yrotation\n}\nMOTION\nFrames: 0 # none\nFrame Time: 1 // s\n1\n\x1a",
    "HIERARCHY\r\nROOT r\r\n{\r\nOFFSET 0 0 0\r\nCHANNELS 1 Xposition\r\n} // end\r\n \x1a",
    "HIERARCHY\rROOT r\r{\rOFFSET 0 0 0\rCHANNELS 3 Xposition Yposition Zposition\r}\rMOTION\rFrames: 3\rFrame Time: 1\r1 2 3 4\r5 6 7 8\r9",
];

/// Reads bytes; what loads must fit its text and be written back, whole, in another order and edited.
fn check(bytes: &[u8]) -> bool {
    let bvh = match Bvh::parse(bytes, "x") {
        Ok(bvh) => bvh,
        Err(error) => {
            assert!(error.line >= 1 && error.column >= 1 && !error.to_string().is_empty());
            return false;
        }
    };
    assert!(bvh.values().len() <= bytes.len() && bvh.joints().len() <= bytes.len());
    assert_eq!(bvh.values().len(), bvh.n_frames() * bvh.n_channels());
    let n_frames = bvh.n_frames();
    let rows = |order: &[usize]| -> Vec<RowEdit<'static>> {
        order.iter().map(|&source_row| RowEdit { source_row, changed: &[] }).collect()
    };
    let in_place: Vec<usize> = (0..n_frames).collect();
    assert!(bvh.write_rows(&rows(&in_place), DIGITS) == bytes, "unchanged rows give the source's bytes");

    let reversed: Vec<usize> = (0..n_frames).rev().collect();
    let twice = [&in_place[..], &in_place[..]].concat();
    for order in [&reversed[..], &twice[..], &in_place[n_frames / 2..]] {
        let written = bvh.write_rows(&rows(order), DIGITS);
        let again = Bvh::parse(&written[..], "written").unwrap_or_else(|e| panic!("{e}\n{:?}", lossy(&written)));
        let expected: Vec<u64> = order.iter().flat_map(|&f| bvh.frame(f)).map(|v| v.to_bits()).collect();
        let found: Vec<u64> = again.values().iter().map(|v| v.to_bits()).collect();
        assert!(found == expected, "{:?}\nwritten as\n{:?}", lossy(bytes), lossy(&written));
    }
    if n_frames > 0 {
        let channel = bvh.n_channels() - 1;
        let changed = [(channel, 12.5)];
        let mut edited = rows(&in_place);
        edited[n_frames - 1].changed = &changed;
        let written = bvh.write_rows(&edited, DIGITS);
        let again = Bvh::parse(&written[..], "edited").unwrap_or_else(|e| panic!("{e}\n{:?}", lossy(&written)));
        let mut expected = bvh.values().to_vec();
        expected[n_frames * bvh.n_channels() - 1] = 12.5;
        assert_eq!(again.values(), expected);
    }
    if n_frames == 0 && bvh.n_channels() > 0 {
        check_row_of_zeros(&bvh, bytes);
    }
    true
}

/// A file that loads without rows loads with the row it is given.
fn check_row_of_zeros(bvh: &Bvh, bytes: &[u8]) {
    let made = bvh.with_row_of_zeros(0.04).expect("it has channels");
    let again = Bvh::parse(Arc::clone(made.text()), "zeros").unwrap_or_else(|e| panic!("{e}\n{:?}", lossy(bytes)));
    assert!(again.values() == made.values() && again.joints() == made.joints(), "{:?}", lossy(bytes));
    assert!(again.frame_time_secs() == made.frame_time_secs() && again.n_frames() == 1, "{:?}", lossy(bytes));
    let changed = [(bvh.n_channels() - 1, 2.5)];
    let rows = [0, 1, 2].map(|row| RowEdit { source_row: 0, changed: if row == 1 { &changed[..] } else { &[] } });
    let written = made.write_rows(&rows, DIGITS);
    let again = Bvh::parse(&written[..], "written").unwrap_or_else(|e| panic!("{e}\n{:?}", lossy(&written)));
    assert!(again.n_frames() == 3 && again.values().iter().sum::<f64>() == 2.5, "{:?}", lossy(&written));
}

fn lossy(bytes: &[u8]) -> String {
    String::from_utf8_lossy(bytes).into_owned()
}

/// A small generator, so that a failure comes back with its seed.
struct Random(u64);

impl Random {
    fn below(&mut self, n: usize) -> usize {
        self.0 = self.0.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
        (self.0 >> 33) as usize % n.max(1)
    }

    /// Changes, removes, repeats or inserts something somewhere, a few times over.
    fn mutate(&mut self, bytes: &mut Vec<u8>) {
        const PIECES: [&str; 18] = [
            "{",
            "}",
            "\n",
            "\r",
            " ",
            "#",
            "//",
            "\x1a",
            "-",
            "1e999",
            "ROOT",
            "JOINT x {",
            "End Site {",
            "MOTION",
            "CHANNELS 1 Xposition",
            "99999999999999999999",
            "0.5 ",
            "Frames: 7",
        ];
        for _ in 0..=self.below(3) {
            let at = self.below(bytes.len() + 1);
            let end = (at + self.below(12)).min(bytes.len());
            match self.below(12) {
                0..3 => drop(bytes.drain(at..end)),
                3..6 => drop(bytes.splice(at..at, PIECES[self.below(PIECES.len())].bytes())),
                6..9 => drop(bytes.splice(at..at, bytes[at..end].to_vec())),
                9..11 if at < bytes.len() => bytes[at] = self.below(256) as u8,
                _ => bytes.truncate(bytes.len() - self.below(bytes.len() / 4 + 1)),
            }
        }
    }
}

#[test]
fn mutated_files_load_or_are_refused() {
    let mut seeds: Vec<Vec<u8>> = SEEDS.iter().map(|s| s.as_bytes().to_vec()).collect();
    let n_own = seeds.len();
    assert!(seeds.iter().all(|s| check(s)), "each seed loads");
    if let Some(clips) = env::var_os("WALKABOUT_CLIPS") {
        let folder = fs::read_dir(std::path::Path::new(&clips).join("quirks")).expect("odd files");
        let mut files: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
        files.sort();
        seeds.extend(files.iter().map(|path| fs::read(path).expect("an odd file")).filter(|b| b.len() < 10_000));
    } else {
        assert!(env::var_os("CI").is_none(), "WALKABOUT_CLIPS must name the folder of clips");
        eprintln!("SKIPPED in part: WALKABOUT_CLIPS does not name the folder of clips");
    }
    let mut n_loaded = 0;
    let n_rounds = 40_000;
    for round in 0..n_rounds {
        let mut random = Random(round);
        random.below(2);
        let seed_idx = if round % 3 == 0 { random.below(seeds.len()) } else { random.below(n_own) };
        let mut bytes = seeds[seed_idx].clone();
        random.mutate(&mut bytes);
        n_loaded += usize::from(check(&bytes));
    }
    println!("{n_loaded} of {n_rounds} mutated files loaded");
    assert!(n_loaded > n_rounds as usize / 20, "the mutations leave some files readable: {n_loaded}");
}

proptest! {
    // Failing bytes are printed; there is no file to keep them in.
    #![proptest_config(ProptestConfig { failure_persistence: None, cases: 2000, ..ProptestConfig::default() })]

    #[test]
    fn any_bytes_load_or_are_refused(bytes in prop::collection::vec(any::<u8>(), 0..400)) {
        check(&bytes);
    }

    #[test]
    fn any_words_load_or_are_refused(words in prop::collection::vec(prop::sample::select(vec![
        "HIERARCHY", "ROOT", "JOINT", "a", "{", "}", "OFFSET", "0", "-1.5", "CHANNELS", "3", "Xposition", "Zrotation",
        "End", "Site", "MOTION", "Frames:", "Frame", "Time:", "# x", "\n", "\r\n", "\n",
    ]), 0..60)) {
        check(words.join(" ").as_bytes());
    }
}

#[test]
fn a_deep_chain_needs_no_deep_stack() {
    let n_joints = 20_000;
    let joint = "JOINT j { OFFSET 0 1 0 CHANNELS 1 Zrotation\n";
    let text = ["HIERARCHY ROOT r { OFFSET 0 0 0 CHANNELS 1 Zrotation\n", &joint.repeat(n_joints - 1)].concat()
        + &"}".repeat(n_joints)
        + "\nMOTION\nFrames: 1\nFrame Time: 1\n"
        + &"1 ".repeat(n_joints);
    let on_small_stack = std::thread::Builder::new().stack_size(128 * 1024);
    let bvh = on_small_stack.spawn(move || Bvh::parse(text.into_bytes(), "deep")).unwrap().join().unwrap().unwrap();
    assert_eq!((bvh.joints().len(), bvh.n_frames()), (n_joints, 1));
    assert_eq!(bvh.joints()[n_joints - 1].parent, Some(n_joints - 2));
}
