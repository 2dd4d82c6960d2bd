//! A screen as an SVG picture that looks the same everywhere: letters are text, each word as wide as its cells; what fonts
//! draw differently or not at all (braille, lines, half blocks) becomes shapes.

use std::{
    collections::BTreeMap,
    fmt::{self, Write as _},
};

use ratatui::{
    buffer::{Buffer, Cell},
    style::{Color, Modifier},
};

/// Width of a cell, in the picture's units.
const CELL_WIDTH: u32 = 9;
const CELL_HEIGHT: u32 = 18;
/// Room around the cells.
const MARGIN: u32 = 14;
const FOREGROUND: Rgb = Rgb([214, 219, 228]);
const BACKGROUND: Rgb = Rgb([20, 22, 28]);
const FONTS: &str = "ui-monospace,SFMono-Regular,Menlo,Consolas,'DejaVu Sans Mono',monospace";

#[derive(Clone, Copy, PartialEq, Eq, PartialOrd, Ord)]
struct Rgb([u8; 3]);

impl fmt::Display for Rgb {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        let [r, g, b] = self.0;
        write!(f, "#{r:02x}{g:02x}{b:02x}")
    }
}

/// How a cell looks, with nothing left to a terminal.
#[derive(Clone, Copy, PartialEq, Eq)]
struct Look {
    ink: Rgb,
    paper: Rgb,
    bold: bool,
    underlined: bool,
}

impl Look {
    fn of(cell: &Cell) -> Self {
        let (mut ink, mut paper) = (rgb(cell.fg, FOREGROUND), rgb(cell.bg, BACKGROUND));
        if cell.modifier.contains(Modifier::REVERSED) {
            std::mem::swap(&mut ink, &mut paper);
        }
        if cell.modifier.contains(Modifier::DIM) {
            let mix = |i: usize| ((3 * u16::from(ink.0[i]) + u16::from(paper.0[i])) / 4) as u8;
            ink = Rgb([mix(0), mix(1), mix(2)]);
        }
        let [bold, underlined] = [Modifier::BOLD, Modifier::UNDERLINED].map(|m| cell.modifier.contains(m));
        Self { ink, paper, bold, underlined }
    }
}

fn rgb(colour: Color, default: Rgb) -> Rgb {
    match colour {
        Color::Rgb(r, g, b) => Rgb([r, g, b]),
        Color::Reset => default,
        other => panic!("{other:?} looks different in each terminal; pictures take 24-bit colours"),
    }
}

/// What a cell is drawn as.
#[derive(Clone, Copy, PartialEq, Eq)]
enum Shape {
    Blank,
    Dots,
    /// Bars: left, top, width and height in a cell.
    Bars(&'static [[u32; 4]]),
    Letter,
}

impl Shape {
    fn of(cell: &Cell) -> Self {
        match cell.symbol() {
            " " => Self::Blank,
            "─" => Self::Bars(&[[0, 9, 9, 1]]),
            "━" => Self::Bars(&[[0, 8, 9, 3]]),
            "│" => Self::Bars(&[[4, 0, 1, 18]]),
            "┃" => Self::Bars(&[[3, 0, 3, 18]]),
            "├" => Self::Bars(&[[4, 0, 1, 18], [4, 9, 5, 1]]),
            "┤" => Self::Bars(&[[4, 0, 1, 18], [0, 9, 5, 1]]),
            "▀" => Self::Bars(&[[0, 0, 9, 9]]),
            "▄" => Self::Bars(&[[0, 9, 9, 9]]),
            symbol if braille_dots(symbol) != 0 => Self::Dots,
            _ => Self::Letter,
        }
    }
}

/// Returns the bits of a braille character's dots, 0 for any other.
fn braille_dots(symbol: &str) -> u32 {
    symbol.chars().next().map_or(0, u32::from).checked_sub(0x2800).filter(|&dots| dots < 256).unwrap_or(0)
}

/// Draws a screen.
pub(crate) fn picture(buf: &Buffer) -> String {
    let (columns, rows) = (u32::from(buf.area.width), u32::from(buf.area.height));
    let (width, height) = (columns * CELL_WIDTH + 2 * MARGIN, rows * CELL_HEIGHT + 2 * MARGIN);
    let mut out = String::new();
    let mut dots = BTreeMap::new();
    line(
        &mut out,
        format_args!(
            r#"<svg xmlns="http://www.w3.org/2000/svg" viewBox="0 0 {width} {height}" font-family="{FONTS}" font-size="15">"#
        ),
    );
    line(&mut out, format_args!(r#"<rect width="{width}" height="{height}" rx="8" fill="{BACKGROUND}"/>"#));
    for (cells, row) in buf.content.chunks(columns.max(1) as usize).zip(0..) {
        let mut column = 0;
        for run in cells.chunk_by(|a, b| Shape::of(a) == Shape::of(b) && Look::of(a) == Look::of(b)) {
            draw_run(&mut out, &mut dots, run, MARGIN + column * CELL_WIDTH, MARGIN + row * CELL_HEIGHT);
            column += run.len() as u32;
        }
    }
    for (ink, path) in dots {
        // A line without a length, with round ends, is a dot.
        line(&mut out, format_args!(r#"<path stroke="{ink}" stroke-width="3" stroke-linecap="round" d="{path}"/>"#));
    }
    out.push_str("</svg>\n");
    out
}

/// Draws cells that are equal but for their letters, from a place at the top left.
fn draw_run(out: &mut String, dots: &mut BTreeMap<Rgb, String>, run: &[Cell], x: u32, y: u32) {
    let Look { ink, paper, bold, underlined } = Look::of(&run[0]);
    let width = run.len() as u32 * CELL_WIDTH;
    if paper != BACKGROUND {
        rect(out, [x, y, width, CELL_HEIGHT], paper);
    }
    match Shape::of(&run[0]) {
        Shape::Blank => {}
        // One as wide as the cell goes on in the next.
        Shape::Bars(&[[_, top, CELL_WIDTH, height]]) => rect(out, [x, y + top, width, height], ink),
        Shape::Bars(bars) => {
            for x in (x..x + width).step_by(CELL_WIDTH as usize) {
                for [left, top, width, height] in bars {
                    rect(out, [x + left, y + top, *width, *height], ink);
                }
            }
        }
        Shape::Dots => {
            let path = dots.entry(ink).or_default();
            for (cell, x) in run.iter().zip((x..).step_by(CELL_WIDTH as usize)) {
                draw_dots(path, braille_dots(cell.symbol()), f64::from(x), f64::from(y));
            }
        }
        Shape::Letter => {
            let text: String = run.iter().map(Cell::symbol).collect();
            let text = text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;");
            let bold = if bold { r#" font-weight="bold""# } else { "" };
            let underlined = if underlined { r#" text-decoration="underline""# } else { "" };
            let y = y + 13;
            line(
                out,
                format_args!(
                    r#"<text x="{x}" y="{y}" textLength="{width}" fill="{ink}"{bold}{underlined}>{text}</text>"#
                ),
            );
        }
    }
}

fn draw_dots(path: &mut String, dots: u32, x: f64, y: f64) {
    const PLACES: [(u8, u8); 8] = [(0, 0), (0, 1), (0, 2), (1, 0), (1, 1), (1, 2), (0, 3), (1, 3)];
    for (bit, (column, row)) in PLACES.into_iter().enumerate() {
        if dots >> bit & 1 == 1 {
            let (x, y) = (x + 2.25 + 4.5 * f64::from(column), y + 2.25 + 4.5 * f64::from(row));
            write!(path, "M{x} {y}h0").expect("writing to a String");
        }
    }
}

fn rect(out: &mut String, [x, y, width, height]: [u32; 4], fill: Rgb) {
    line(out, format_args!(r#"<rect x="{x}" y="{y}" width="{width}" height="{height}" fill="{fill}"/>"#));
}

fn line(out: &mut String, text: fmt::Arguments<'_>) {
    writeln!(out, "{text}").expect("writing to a String");
}
