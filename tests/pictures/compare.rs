//! A picture against its golden file.
//!
//! Goldens are drawn on the processor. Machines of one kind agree to the byte; between kinds of processors a fraction
//! of a per cent of the pixels differs by a shade, and a pixel on an edge by more. The tolerance lets that pass and
//! nothing else.

use std::{
    fs,
    path::{Path, PathBuf},
};

use walkabout::scene::Picture;

/// A pixel that is off by more than this in any channel counts.
const SHADE: u8 = 2;
/// Share of the pixels that may count.
const SHARE: f64 = 0.001;
/// No pixel may be off by more.
const WORST: u8 = 32;
/// Mean of the absolute differences over all channels.
const MEAN: f64 = 0.05;

/// Checks a picture against `tests/pictures/NAME.png`, or writes that file when `WALKABOUT_BLESS` is set.
///
/// # Panics
///
/// When they differ by more than the tolerance; the actual picture and the difference are then in `target/pictures`.
pub(crate) fn check(name: &str, actual: &Picture) {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let golden_file = root.join("tests/pictures").join(name).with_extension("png");
    if std::env::var_os("WALKABOUT_BLESS").is_some() {
        write(&golden_file, actual);
        return;
    }
    if !golden_file.exists() {
        let kept = keep(root, name, actual);
        panic!("{} is missing; the picture is {}", golden_file.display(), kept.display());
    }
    let golden = read(&golden_file);
    if let Err(why) = within_tolerance(&golden, actual) {
        let kept = keep(root, name, actual);
        let mut text = format!("{name} is not as {}: {why}; the picture is {}", golden_file.display(), kept.display());
        if let Some(difference) = difference(&golden, actual) {
            let file = keep(root, &format!("{name}.difference"), &difference);
            text += &format!(", the difference (×8) {}", file.display());
        }
        panic!("{text}; if this is right, WALKABOUT_BLESS=1 rewrites the golden");
    }
}

/// Compares two pictures; the error says by how much they differ.
fn within_tolerance(golden: &Picture, actual: &Picture) -> Result<(), String> {
    if (golden.width, golden.height) != (actual.width, actual.height) {
        return Err(format!("{}×{} pixels instead of {}×{}", actual.width, actual.height, golden.width, golden.height));
    }
    let off: Vec<u8> = golden.rgb.iter().zip(&actual.rgb).map(|(g, a)| g.abs_diff(*a)).collect();
    let n_off = off.chunks(3).filter(|p| p.iter().any(|d| *d > SHADE)).count();
    let share = n_off as f64 / (off.len() / 3) as f64;
    let worst = off.iter().copied().max().unwrap_or(0);
    let mean = off.iter().map(|d| f64::from(*d)).sum::<f64>() / off.len() as f64;
    if share <= SHARE && worst <= WORST && mean <= MEAN {
        Ok(())
    } else {
        Err(format!("{:.3} % of the pixels differ, the worst by {worst}, the mean by {mean:.3}", share * 100.0))
    }
}

/// The differences, eight times as strong; none when the sizes differ.
fn difference(golden: &Picture, actual: &Picture) -> Option<Picture> {
    let same = (golden.width, golden.height) == (actual.width, actual.height);
    let rgb = golden.rgb.iter().zip(&actual.rgb).map(|(g, a)| g.abs_diff(*a).saturating_mul(8)).collect();
    same.then_some(Picture { rgb, ..*golden })
}

/// Writes a picture where a person finds it.
fn keep(root: &Path, name: &str, picture: &Picture) -> PathBuf {
    let folder = root.join("target/pictures");
    fs::create_dir_all(&folder).expect("the target folder is writable");
    let file = folder.join(format!("{name}.png"));
    write(&file, picture);
    file
}

fn write(path: &Path, picture: &Picture) {
    let file = fs::File::create(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut encoder = png::Encoder::new(std::io::BufWriter::new(file), picture.width, picture.height);
    encoder.set_color(png::ColorType::Rgb);
    encoder.set_depth(png::BitDepth::Eight);
    encoder.set_compression(png::Compression::High);
    let mut writer = encoder.write_header().expect("a valid header");
    writer.write_image_data(&picture.rgb).expect("three bytes a pixel");
}

fn read(path: &Path) -> Picture {
    let file = fs::File::open(path).unwrap_or_else(|e| panic!("{}: {e}", path.display()));
    let mut reader = png::Decoder::new(std::io::BufReader::new(file)).read_info().expect("a PNG file");
    let mut rgb = vec![0; reader.output_buffer_size().expect("a size that fits into memory")];
    let info = reader.next_frame(&mut rgb).expect("an image");
    assert_eq!(info.color_type, png::ColorType::Rgb, "{}", path.display());
    Picture { width: info.width, height: info.height, rgb }
}

/// A grey picture of 100×100 pixels with some changed.
fn changed(n: usize, by: u8) -> Picture {
    let mut rgb = vec![100; 100 * 100 * 3];
    for pixel in rgb.chunks_mut(3).take(n) {
        pixel[1] += by;
    }
    Picture { width: 100, height: 100, rgb }
}

#[test]
fn the_tolerance_lets_shades_pass_and_nothing_else() {
    let golden = changed(0, 0);
    for (n, by, passes) in [(0, 0, true), (500, 2, true), (10, 32, true), (11, 3, false), (1, 33, false)] {
        assert_eq!(within_tolerance(&golden, &changed(n, by)).is_ok(), passes, "{n} pixels by {by}");
    }
    assert!(within_tolerance(&golden, &changed(1000, 2)).is_err(), "too many shades");
    assert!(within_tolerance(&golden, &Picture { width: 50, height: 200, ..changed(0, 0) }).is_err());
}
