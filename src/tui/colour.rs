//! Colours for every terminal, and the styles all widgets share.
//!
//! A widget names what it draws (a [`Role`], or a style such as [`Palette::selected`]) and the [`Palette`] says how
//! that looks at this terminal's colour depth. Every style but the plain ones carries a cue that is not a colour:
//! bold, underlined, reversed or dim, so that a terminal without colours shows as much.

use ratatui::style::{Color, Modifier, Style};

use crate::scene::Role;

/// How many colours a terminal shows.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub enum Depth {
    /// None at all, by wish or by nature.
    Monochrome,
    /// The 16 of ANSI, whose exact look is the user's.
    Sixteen,
    /// xterm's 256.
    Indexed,
    /// 24 bits.
    True,
}

impl Depth {
    /// Reads the depth from this process's environment.
    pub fn from_env() -> Self {
        Self::detect(|name| std::env::var(name).ok())
    }

    /// Decides the depth from `NO_COLOR`, `TERM` and `COLORTERM`, in this order of precedence.
    pub fn detect(var: impl Fn(&str) -> Option<String>) -> Self {
        let term = var("TERM").unwrap_or_default();
        let colorterm = var("COLORTERM").unwrap_or_default();
        if var("NO_COLOR").is_some_and(|v| !v.is_empty()) || term == "dumb" {
            Self::Monochrome
        } else if matches!(colorterm.as_str(), "truecolor" | "24bit") || term.ends_with("-direct") {
            Self::True
        } else if term.contains("256color") {
            Self::Indexed
        } else {
            Self::Sixteen
        }
    }
}

/// How everything looks at one colour depth.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub struct Palette {
    /// How many colours there are.
    pub depth: Depth,
}

impl Palette {
    /// Makes the palette of a depth.
    pub const fn new(depth: Depth) -> Self {
        Self { depth }
    }

    /// Returns the colour nearest to these sRGB bytes.
    pub fn rgb(self, rgb: [u8; 3]) -> Color {
        match self.depth {
            Depth::Monochrome => Color::Reset,
            Depth::Sixteen => Color::Indexed(nearest_of_16(rgb)),
            Depth::Indexed => Color::Indexed(nearest_of_256(rgb)),
            Depth::True => Color::Rgb(rgb[0], rgb[1], rgb[2]),
        }
    }

    /// Returns the look of a thing in the scene.
    pub fn role(self, role: Role) -> Style {
        let colour = if self.depth == Depth::Sixteen { role_of_16(role) } else { self.rgb(role.rgb()) };
        let style = Style::new().fg(colour);
        match role {
            Role::SelectedControlPoint | Role::MissedFootprint | Role::ActiveJoint => {
                style.add_modifier(Modifier::BOLD)
            }
            Role::Ground => style.add_modifier(Modifier::DIM),
            _ => style,
        }
    }

    /// Titles and headings.
    pub fn title(self) -> Style {
        self.fg([140, 190, 250]).add_modifier(Modifier::BOLD)
    }

    /// Plain text.
    pub fn text(self) -> Style {
        Style::new()
    }

    /// Things less important than the rest: units, frames of axes, hints.
    pub fn dim(self) -> Style {
        self.fg([140, 145, 155]).add_modifier(Modifier::DIM)
    }

    /// The name of a key.
    pub fn key(self) -> Style {
        self.fg([240, 200, 110]).add_modifier(Modifier::BOLD)
    }

    /// A value as it is by default.
    pub fn value(self) -> Style {
        self.fg([190, 215, 235])
    }

    /// A value the user changed.
    pub fn changed(self) -> Style {
        self.fg([240, 200, 110]).add_modifier(Modifier::BOLD)
    }

    /// Something that went wrong or needs attention.
    pub fn warning(self) -> Style {
        self.fg([240, 130, 90]).add_modifier(Modifier::BOLD.union(Modifier::UNDERLINED))
    }

    /// The row, tab or item that keys act on. Laid over other styles it makes one bar of them.
    pub fn selected(self) -> Style {
        Style::new().fg(Color::Reset).add_modifier(Modifier::REVERSED).remove_modifier(Modifier::DIM)
    }

    /// The playhead.
    pub fn playhead(self) -> Style {
        self.fg([255, 220, 120]).add_modifier(Modifier::BOLD)
    }

    fn fg(self, rgb: [u8; 3]) -> Style {
        Style::new().fg(self.rgb(rgb))
    }
}

/// The roles' colours among 16: chosen by hand, because nearness makes pink a grey and the ground black.
fn role_of_16(role: Role) -> Color {
    match role {
        Role::OriginalSkeleton => Color::Red,
        Role::NewSkeleton => Color::Green,
        Role::NormalSkeleton => Color::Cyan,
        Role::OriginalPath | Role::NewPath => Color::White,
        Role::ControlPoint => Color::Magenta,
        // Purple is all used up among 16; signs tell joints from control points.
        Role::SelectedControlPoint | Role::SelectedJoint | Role::ActiveJoint => Color::LightMagenta,
        Role::OriginalTracker => Color::LightRed,
        Role::NewTracker => Color::LightGreen,
        Role::Strain | Role::MissedFootprint => Color::LightYellow,
        Role::Trace => Color::Yellow,
        Role::Footprint => Color::LightBlue,
        Role::Ground => Color::DarkGray,
    }
}

/// Levels of the 6×6×6 cube in xterm's 256 colours.
const CUBE: [u8; 6] = [0, 95, 135, 175, 215, 255];

/// xterm's first 16 colours.
const ANSI: [[u8; 3]; 16] = [
    [0, 0, 0],
    [205, 0, 0],
    [0, 205, 0],
    [205, 205, 0],
    [0, 0, 238],
    [205, 0, 205],
    [0, 205, 205],
    [229, 229, 229],
    [127, 127, 127],
    [255, 0, 0],
    [0, 255, 0],
    [255, 255, 0],
    [92, 92, 255],
    [255, 0, 255],
    [0, 255, 255],
    [255, 255, 255],
];

/// Returns the nearest of xterm's cube and grey ramp (16–255); the first 16 are the user's to change.
fn nearest_of_256(rgb: [u8; 3]) -> u8 {
    let level = |v: u8| (0..6).min_by_key(|&i| CUBE[i].abs_diff(v)).unwrap_or(0);
    let [r, g, b] = rgb.map(level);
    // The grey nearest by this distance is the one nearest to the weighted mean.
    let mean = (3 * u32::from(rgb[0]) + 4 * u32::from(rgb[1]) + 2 * u32::from(rgb[2])) / 9;
    let step = (mean.saturating_sub(3) / 10).min(23) as u8;
    let grey = 8 + 10 * step;
    if distance(rgb, [grey; 3]) < distance(rgb, [CUBE[r], CUBE[g], CUBE[b]]) {
        232 + step
    } else {
        (16 + 36 * r + 6 * g + b) as u8
    }
}

fn nearest_of_16(rgb: [u8; 3]) -> u8 {
    (0..16).min_by_key(|&i| distance(rgb, ANSI[usize::from(i)])).unwrap_or(7)
}

/// Returns the squared distance, with the channels weighted about as the eye does.
fn distance(a: [u8; 3], b: [u8; 3]) -> u32 {
    let square = |i: usize| u32::from(a[i].abs_diff(b[i])).pow(2);
    3 * square(0) + 4 * square(1) + 2 * square(2)
}

#[cfg(test)]
mod tests {
    use super::*;

    const ROLES: [Role; 16] = [
        Role::NormalSkeleton,
        Role::OriginalSkeleton,
        Role::NewSkeleton,
        Role::OriginalPath,
        Role::NewPath,
        Role::Strain,
        Role::ControlPoint,
        Role::SelectedControlPoint,
        Role::OriginalTracker,
        Role::NewTracker,
        Role::Trace,
        Role::Footprint,
        Role::MissedFootprint,
        Role::SelectedJoint,
        Role::ActiveJoint,
        Role::Ground,
    ];

    fn depth(vars: &[(&str, &str)]) -> Depth {
        Depth::detect(|name| vars.iter().find(|(n, _)| *n == name).map(|(_, v)| (*v).to_owned()))
    }

    #[test]
    fn the_environment_decides_the_depth() {
        for (vars, expected) in [
            (&[("TERM", "xterm")][..], Depth::Sixteen),
            (&[], Depth::Sixteen),
            (&[("TERM", "xterm-256color")], Depth::Indexed),
            (&[("TERM", "screen-256color-bce")], Depth::Indexed),
            (&[("TERM", "xterm-256color"), ("COLORTERM", "truecolor")], Depth::True),
            (&[("TERM", "foot"), ("COLORTERM", "24bit")], Depth::True),
            (&[("TERM", "xterm-direct")], Depth::True),
            (&[("TERM", "dumb"), ("COLORTERM", "truecolor")], Depth::Monochrome),
            (&[("TERM", "xterm-256color"), ("NO_COLOR", "1")], Depth::Monochrome),
            (&[("TERM", "xterm-256color"), ("NO_COLOR", "")], Depth::Indexed),
        ] {
            assert_eq!(depth(vars), expected, "{vars:?}");
        }
    }

    #[test]
    fn palette_colours_map_to_themselves() {
        for (i, rgb) in (16..=255).map(|i: u8| (i, xterm(i))) {
            assert_eq!(xterm(nearest_of_256(rgb)), rgb, "{i}");
        }
        for (i, rgb) in ANSI.into_iter().enumerate() {
            assert_eq!(usize::from(nearest_of_16(rgb)), i);
        }
    }

    #[test]
    fn the_nearest_of_256_beats_all_others() {
        for n in 0..4096_u32 {
            let rgb = [(n >> 8) * 17, (n >> 4 & 15) * 17, (n & 15) * 17].map(|v| v as u8);
            let best = (16..=255).map(|i| distance(rgb, xterm(i))).min().expect("not empty");
            assert_eq!(distance(rgb, xterm(nearest_of_256(rgb))), best, "{rgb:?}");
        }
    }

    fn xterm(i: u8) -> [u8; 3] {
        match i {
            0..16 => ANSI[usize::from(i)],
            16..232 => [(i - 16) / 36, (i - 16) / 6 % 6, (i - 16) % 6].map(|l| CUBE[usize::from(l)]),
            232.. => [8 + 10 * (i - 232); 3],
        }
    }

    #[test]
    fn roles_stay_apart_where_there_are_colours() {
        for depth in [Depth::Sixteen, Depth::Indexed, Depth::True] {
            let mut seen: Vec<Color> = Vec::new();
            for role in ROLES {
                let colour = Palette::new(depth).role(role).fg.expect("roles have a colour");
                let is_shared = matches!(role, Role::NewPath | Role::MissedFootprint)
                    || (depth == Depth::Sixteen && matches!(role, Role::SelectedJoint | Role::ActiveJoint));
                if !is_shared {
                    assert!(!seen.contains(&colour), "{role:?} at {depth:?}");
                }
                seen.push(colour);
            }
        }
    }

    #[test]
    fn without_colours_the_styles_still_differ() {
        let palette = Palette::new(Depth::Monochrome);
        for style in [palette.title(), palette.key(), palette.changed(), palette.warning(), palette.playhead()] {
            assert_ne!(style.add_modifier, palette.text().add_modifier);
        }
        assert_ne!(palette.warning().add_modifier, palette.changed().add_modifier);
        assert_ne!(palette.selected().add_modifier, palette.text().add_modifier);
        assert_eq!(palette.role(Role::NewSkeleton).fg, Some(Color::Reset));
    }
}
