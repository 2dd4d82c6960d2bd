//! Writes docs/feet.md and docs/feet.svg: what holding the feet does on captured clips, clip by clip and shape by shape.
//!
//! `cargo xtask report` runs it. The numbers are the program's own ([`solve`]), as `walkabout measure` prints them;
//! shapes are made so large that no bend is tighter than half a body height, and the clip ends where the path does.

use std::{
    fmt::Write as _,
    path::{Path, PathBuf},
    process::ExitCode,
    sync::Arc,
};

use glam::DVec3;
use plotters::prelude::*;
use walkabout::{
    bvh::Bvh,
    document::{Edits, Solved, Source, built_in, solve},
    measure::Pair,
    path::{Degree, NewPath, Shape, ShapeKind, shape_points},
};

/// Captured clips in which somebody walks, runs, jumps or dances along.
const CLIPS: [&str; 9] = [
    "cmu_02_01_walk",
    "cmu_08_01_brisk_walk",
    "cmu_12_03_walk",
    "cmu_131_01_start_walk_stop",
    "figure8_walk",
    "walk01",
    "zombie_turns_z_up",
    "cmu_01_01_jumps",
    "cmu_61_09_salsa_metres",
];
const SHAPES: [ShapeKind; 5] = [ShapeKind::Circle, ShapeKind::Zigzag, ShapeKind::Eight, ShapeKind::U, ShapeKind::S];
const DEGREES: [u32; 2] = [5, 13];
/// Least radius of the shapes in the table, body heights.
const RADIUS: f64 = 0.5;
/// Least radii of the circles in the plot, body heights.
const RADII: [f64; 9] = [0.25, 0.35, 0.5, 0.7, 1.0, 1.4, 2.0, 2.8, 4.0];
/// Clips in the plot.
const PLOTTED: [&str; 3] = ["built-in walk", "walk01", "cmu_12_03_walk"];

fn main() -> ExitCode {
    let Ok(clips) = std::env::var("WALKABOUT_CLIPS") else {
        eprintln!("WALKABOUT_CLIPS must name the folder of captured clips");
        return ExitCode::FAILURE;
    };
    let mut sources = vec![Arc::new(built_in())];
    sources.extend(CLIPS.iter().map(|name| read(Path::new(&clips), name)));
    let docs = PathBuf::from(env!("CARGO_MANIFEST_DIR")).join("docs");
    let (table, summary) = table(&sources);
    std::fs::write(docs.join("feet.md"), page(&table, &summary)).expect("docs can be written");
    let plotted: Vec<_> = sources.iter().filter(|source| PLOTTED.contains(&source.name.as_str())).collect();
    plot(&docs.join("feet.svg"), &plotted).expect("the plot can be drawn");
    print!("{summary}");
    ExitCode::SUCCESS
}

fn read(clips: &Path, name: &str) -> Arc<Source> {
    let bytes = std::fs::read(clips.join("real").join(name).with_extension("bvh")).expect("the clip is there");
    Arc::new(Source { name: name.to_owned(), file: None, bvh: Bvh::parse(bytes, name).expect("a valid file") })
}

/// An edit of a clip without holding, with it, and with the feet's own slide removed.
struct Bent {
    plain: Solved,
    held: Solved,
    clean: Solved,
}

impl Bent {
    /// Bends a clip onto the smallest version of a shape, full size or larger, whose least radius is `radius` body
    /// heights.
    fn new(straight: &Solved, kind: ShapeKind, radius: f64, from_size: f64) -> Self {
        let height = straight.clip.facts.height.value;
        let mut size = from_size;
        let points = loop {
            let points = shape_points(Shape { kind, size }, &straight.original, 8, 3);
            let path = NewPath::new(walkabout::curve::BSpline::new(3, points.clone()), 0.5 * height, 0.0);
            if least_radius(&path) >= radius * height || size > 500.0 {
                break points;
            }
            size *= 1.02;
        };
        let up = straight.clip.facts.up.value;
        let mut edits = (*straight.edits).clone();
        edits.path.points = points.len();
        edits.path.control_points = Some(points.into_iter().map(|p| up.to_file(p)).collect());
        let solved = |edits: &Edits| solve(&straight.source, &Arc::new(edits.clone()), Some(straight));
        let held = solved(&edits);
        edits.plants.clean = true;
        let clean = solved(&edits);
        edits.plants.hold = false;
        Self { plain: solved(&edits), held, clean }
    }
}

impl Bent {
    /// Returns how far the carrier is at most from where plain path editing has it, the original path's own rise and fall
    /// given back, body heights.
    fn offset(&self) -> f64 {
        let (held, plain, original) = (&self.held, &self.plain, self.held.original.frames());
        let rise = |f: usize| (original[f].point.y - original[0].point.y) * DVec3::Y;
        let offset = |f: usize| held.carrier(f).translation.distance(plain.carrier(f).translation + rise(f));
        (0..held.edited.n_frames()).map(offset).fold(0.0, f64::max) / held.clip.facts.height.value
    }
}

fn straight(source: &Arc<Source>, degree: u32) -> Solved {
    let mut edits = Edits::default();
    edits.original.degree = Degree::Fixed(degree);
    solve(source, &Arc::new(edits), None)
}

fn least_radius(path: &NewPath) -> f64 {
    const N: usize = 1500;
    let points = path.polyline(N);
    let step = path.length() / (N - 1) as f64;
    let angles = points.windows(3).map(|w| (w[1] - w[0]).angle_between(w[2] - w[1]));
    angles.fold(f64::INFINITY, |least, angle| least.min(step / angle.max(1e-12)))
}

/// The worse foot's number: source and edited.
fn worse(solved: &Solved, number: impl Fn(&walkabout::measure::FootNumbers) -> Option<Pair>) -> Option<Pair> {
    solved.foot_numbers.iter().filter_map(number).max_by(|a, b| a.edited.total_cmp(&b.edited))
}

/// Largest ratio of a number over both feet, edited over source.
fn ratio(solved: &Solved, number: impl Fn(&walkabout::measure::FootNumbers) -> Option<Pair>) -> Option<f64> {
    solved.foot_numbers.iter().filter_map(number).map(|p| p.edited / p.source).max_by(f64::total_cmp)
}

/// Makes the table, one row per clip and shape at degree 13, and the summary over all edits.
fn table(sources: &[Arc<Source>]) -> (String, String) {
    let mut table = String::from(
        "| clip | shape | speed H/s: source | plain | held | clean | slip p90 H: source | plain | held | clean | jerk ratio: plain | held | clean | offset H | missed |\n\
         | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- | --- |\n",
    );
    let mut ratios: [Vec<f64>; 8] = Default::default();
    let mut n_missed = 0;
    let mut n_edits = 0;
    for source in sources {
        for degree in DEGREES {
            let straight = straight(source, degree);
            for kind in SHAPES {
                let bent = Bent::new(&straight, kind, RADIUS, 1.0);
                let all = [&bent.plain, &bent.held, &bent.clean];
                n_edits += 1;
                n_missed += usize::from(bent.held.holding.as_ref().is_some_and(|h| !h.missed.is_empty()));
                for (list, solved) in ratios.iter_mut().zip(all) {
                    list.extend(ratio(solved, |n| n.planted_speed));
                }
                for (list, solved) in ratios[3..].iter_mut().zip(all) {
                    list.extend(ratio(solved, |n| n.slip_p90));
                }
                ratios[6].extend(bent.held.measures.jerk_ratio);
                ratios[7].push(bent.offset());
                if degree == DEGREES[1] {
                    row(&mut table, kind, &bent);
                }
            }
        }
        println!("{}", source.name);
    }
    let names = [
        "planted speed, plain",
        "planted speed, held",
        "planted speed, clean",
        "slip p90, plain",
        "slip p90, held",
        "slip p90, clean",
        "jerk, held",
        "carrier's offset, held, body heights",
    ];
    let mut summary = String::from("| over the source's | median | 95 % | largest |\n| --- | --- | --- | --- |\n");
    for (name, list) in names.iter().zip(&mut ratios) {
        list.sort_by(f64::total_cmp);
        let at = |share: f64| list[((list.len() - 1) as f64 * share).round() as usize];
        writeln!(summary, "| {name} | {:.3} | {:.3} | {:.3} |", at(0.5), at(0.95), at(1.0)).expect("into a String");
    }
    writeln!(
        summary,
        "\n{n_edits} edits; in {n_missed} of them some plant could not be reached and is reported as missed."
    )
    .expect("into a String");
    (table, summary)
}

fn row(table: &mut String, kind: ShapeKind, bent: &Bent) {
    let all = [&bent.plain, &bent.held, &bent.clean];
    write!(table, "| {} | {} ", bent.held.source.name, kind.name()).expect("into a String");
    let number = |n: Option<f64>, digits: usize| n.map_or_else(|| "–".to_owned(), |n| format!("{n:.digits$}"));
    let numbers: [fn(&walkabout::measure::FootNumbers) -> Option<Pair>; 2] = [|n| n.planted_speed, |n| n.slip_p90];
    for of in numbers {
        let source = worse(all[0], of).map(|_| {
            let sources = all[0].foot_numbers.iter().filter_map(of).map(|pair| pair.source);
            sources.fold(0.0, f64::max)
        });
        write!(table, "| {} ", number(source, 4)).expect("into a String");
        for solved in all {
            write!(table, "| {} ", number(worse(solved, of).map(|p| p.edited), 4)).expect("into a String");
        }
    }
    for solved in all {
        write!(table, "| {} ", number(solved.measures.jerk_ratio, 3)).expect("into a String");
    }
    writeln!(table, "| {:.3} | {} |", bent.offset(), bent.held.holding.as_ref().map_or(0, |h| h.missed.len()))
        .expect("into a String");
}

/// Draws slip against the radius of circles, plain and held.
fn plot(file: &Path, sources: &[&Arc<Source>]) -> Result<(), Box<dyn std::error::Error>> {
    const COLOURS: [RGBColor; 3] = [RGBColor(200, 60, 55), RGBColor(40, 120, 180), RGBColor(60, 150, 80)];
    let root = SVGBackend::new(file, (840, 480)).into_drawing_area();
    root.fill(&WHITE)?;
    let mut chart = ChartBuilder::on(&root)
        .margin(14)
        .x_label_area_size(44)
        .y_label_area_size(64)
        .build_cartesian_2d((0.25..4.0).log_scale(), (0.005..0.3).log_scale())?;
    chart
        .configure_mesh()
        .x_desc("radius of the circle, body heights")
        .y_desc("slip p90 of the worse foot, body heights")
        .draw()?;
    for (source, colour) in sources.iter().zip(COLOURS) {
        let straight = straight(source, DEGREES[1]);
        // Small circles are made smaller than the clip's own path: the clip then ends early.
        let points: Vec<_> = RADII
            .iter()
            .filter_map(|&radius| {
                let bent = Bent::new(&straight, ShapeKind::Circle, radius, 0.02);
                let slip = |solved: &Solved| worse(solved, |n| n.slip_p90).map(|p| p.edited);
                Some((radius, slip(&bent.plain)?, slip(&bent.held)?))
            })
            .collect();
        let plain = points.iter().map(|&(radius, plain, _)| (radius, plain));
        let held = points.iter().map(|&(radius, _, held)| (radius, held));
        chart
            .draw_series(DashedLineSeries::new(plain, 8, 5, colour.stroke_width(2)))?
            .label(format!("{}, plain", source.name))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 8, y)], colour.stroke_width(2)));
        chart
            .draw_series(LineSeries::new(held, colour.stroke_width(3)))?
            .label(format!("{}, held", source.name))
            .legend(move |(x, y)| PathElement::new([(x, y), (x + 20, y)], colour.stroke_width(3)));
    }
    let place = SeriesLabelPosition::UpperRight;
    chart
        .configure_series_labels()
        .position(place)
        .background_style(WHITE.mix(0.85))
        .border_style(BLACK.mix(0.3))
        .draw()?;
    root.present()?;
    Ok(())
}

fn page(table: &str, summary: &str) -> String {
    format!(
        "# How well feet are held\n\n\
         Written by `cargo xtask report`, not by hand. *Plain* is path editing as the thesis has it (`plants.hold = false`), *held* is the\n\
         default, *clean* has `plants.clean = true`. Shapes are made so large that no bend is tighter than half a body height; the\n\
         clip ends where the path does. Numbers are those of `walkabout measure`, of the worse foot. *Offset* is how far the carrier is at\n\
         most from where plain path editing has it, the original path's own rise and fall given back.\n\n\
         ## Over all edits, original degrees 5 and 13\n\n{summary}\n\
         ![slip against the radius of a circle](feet.svg)\n\n\
         ## Clip by clip, original degree 13\n\n{table}"
    )
}
