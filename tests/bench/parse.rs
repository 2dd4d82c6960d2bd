//! Reading speed beside the fastest other reader measured, in one run: `cargo bench --bench parse`.
//!
//! Reads the captured clips where `WALKABOUT_CLIPS` names them, a made-up file elsewhere. Each figure is the best of
//! several rounds, since other programs can only slow a round down.

use std::{env, fs, hint::black_box, path::Path, sync::Arc, thread::available_parallelism, time::Instant};

use walkabout::bvh::Bvh;

const N_ROUNDS: usize = 15;

fn main() {
    let files = files();
    let n_cores = available_parallelism().map_or(1, usize::from);
    println!("one core of {n_cores}; best of {N_ROUNDS} rounds");
    println!("{:<34} {:>8} {:>10} {:>10} {:>7}", "file", "MB", "MB/s", "bvh_anim", "ratio");
    let mut total = (0.0, 0.0, 0.0);
    for (name, bytes) in &files {
        let megabytes = bytes.len() as f64 / 1e6;
        let ours = best_secs(|| drop(black_box(Bvh::parse(Arc::clone(bytes), name).expect("a sound file"))));
        let theirs = best_secs(|| drop(black_box(bvh_anim::from_bytes(&bytes[..]).expect("a sound file"))));
        print_line(name, megabytes, ours, theirs);
        total = (total.0 + megabytes, total.1 + ours, total.2 + theirs);
    }
    print_line("all", total.0, total.1, total.2);
}

fn print_line(name: &str, megabytes: f64, ours: f64, theirs: f64) {
    let (our_rate, their_rate) = (megabytes / ours, megabytes / theirs);
    println!("{name:<34} {megabytes:>8.2} {our_rate:>10.0} {their_rate:>10.0} {:>7.2}", our_rate / their_rate);
}

fn best_secs(mut work: impl FnMut()) -> f64 {
    let rounds = (0..N_ROUNDS).map(|_| {
        let start = Instant::now();
        work();
        start.elapsed().as_secs_f64()
    });
    rounds.fold(f64::INFINITY, f64::min)
}

/// Captured clips of at least 100 kB that both readers take, or one made-up file.
fn files() -> Vec<(String, Arc<[u8]>)> {
    let Some(clips) = env::var_os("WALKABOUT_CLIPS") else {
        println!("WALKABOUT_CLIPS does not name the folder of clips: a made-up file is read");
        return vec![("made up, 31 joints".to_owned(), made_up().into_bytes().into())];
    };
    let folder = fs::read_dir(Path::new(&clips).join("real")).expect("captured clips");
    let mut paths: Vec<_> = folder.map(|entry| entry.expect("an entry").path()).collect();
    paths.sort();
    let read = |path: &Path| (path.file_stem().unwrap_or_default().to_string_lossy().into_owned(), fs::read(path));
    let files = paths.iter().map(|path| read(path)).map(|(name, bytes)| (name, Arc::from(bytes.expect("a clip"))));
    files.filter(|(_, b): &(_, Arc<[u8]>)| b.len() > 100_000 && bvh_anim::from_bytes(&b[..]).is_ok()).collect()
}

/// A chain of 31 joints over 10,000 frames, four decimals.
fn made_up() -> String {
    let (n_joints, n_frames) = (31, 10_000);
    let mut text = String::from("HIERARCHY\nROOT j0\n{\nOFFSET 0 0 0\n");
    text += "CHANNELS 6 Xposition Yposition Zposition Zrotation Yrotation Xrotation\n";
    for joint in 1..n_joints {
        text += &format!("JOINT j{joint}\n{{\nOFFSET 0 1 0\nCHANNELS 3 Zrotation Yrotation Xrotation\n");
    }
    text += "End Site\n{\nOFFSET 0 1 0\n}\n";
    text += &"}\n".repeat(n_joints);
    text += &format!("MOTION\nFrames: {n_frames}\nFrame Time: 0.0083333\n");
    let n_channels = 3 + 3 * n_joints;
    for i in 0..n_frames * n_channels {
        let value = 90.0 * ((i % n_channels) as f64 + i as f64 * 1e-3).sin();
        text += &format!("{value:.4}{}", if (i + 1) % n_channels == 0 { '\n' } else { ' ' });
    }
    text
}
