//! `measure --fail NAME=LIMIT`: quality numbers that a script does not accept.
//!
//! A number that cannot be measured is not accepted either: a script that asks for feet that stand must hear that none
//! was looked at.

use std::{fmt, str::FromStr};

use crate::{
    contact::FootPlants,
    document::Solved,
    measure::{FootNumbers, Pair, Seam},
};

/// A bound on one quality number.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Limit {
    number: &'static Number,
    bound: f64,
}

/// A number that can be bounded.
#[derive(Debug)]
struct Number {
    name: &'static str,
    /// What it is, with its unit.
    doc: &'static str,
    /// A value below the bound fails; else one above it.
    at_least: bool,
    /// Its values.
    values: fn(&Solved) -> Values,
}

/// What each value is of, and the value, none where that one cannot be measured; or why there is no value at all.
type Values = Result<Vec<(String, Option<f64>)>, &'static str>;

impl PartialEq for Number {
    fn eq(&self, other: &Self) -> bool {
        self.name == other.name
    }
}

static NUMBERS: [Number; 10] = [
    Number {
        name: "planted_speed",
        doc: "each foot's edited speed in plants, H/s",
        at_least: false,
        values: |s| feet(s, |n| n.planted_speed.map(|p| p.edited)),
    },
    Number {
        name: "planted_speed_ratio",
        doc: "the same over the source's",
        at_least: false,
        values: |s| feet(s, |n| n.planted_speed.map(ratio)),
    },
    Number {
        name: "slip",
        doc: "each foot's edited slip p90, H",
        at_least: false,
        values: |s| feet(s, |n| n.slip_p90.map(|p| p.edited)),
    },
    Number {
        name: "slip_ratio",
        doc: "the same over the source's",
        at_least: false,
        values: |s| feet(s, |n| n.slip_p90.map(ratio)),
    },
    Number {
        name: "clearance_ratio",
        doc: "each foot's swing clearance over the source's, at least",
        at_least: true,
        values: |s| feet(s, |n| n.clearance.map(ratio)),
    },
    Number {
        name: "jerk_ratio",
        doc: "mean jerk over the source's",
        at_least: false,
        values: |s| Ok(vec![("the body".to_owned(), s.measures.jerk_ratio)]),
    },
    Number {
        name: "path_error",
        doc: "distance of the carrier from the path, H",
        at_least: false,
        values: |s| Ok(vec![("the carrier".to_owned(), s.measures.path_error)]),
    },
    Number {
        name: "seam_ratio",
        doc: "each seam's position step over its neighbours'",
        at_least: false,
        values: |s| {
            let rest = s.clip.rest_frames();
            let value = |seam: &Seam| (format!("frame {}", seam.frame + rest), Some(seam.position_share()));
            some(s.measures.seam.iter().map(value).collect(), "no cycle joins another")
        },
    },
    Number {
        name: "missed",
        doc: "plants that could not be reached",
        at_least: false,
        values: |s| Ok(vec![("the clip".to_owned(), Some(s.holding.as_ref().map_or(0, |h| h.missed.len()) as f64))]),
    },
    Number {
        name: "strains",
        doc: "stretches that ask too much of a body",
        at_least: false,
        values: |s| Ok(vec![("the clip".to_owned(), Some(s.strains.len() as f64))]),
    },
];

/// Returns a number of every foot that stands.
fn feet(solved: &Solved, number: impl Fn(&FootNumbers) -> Option<f64>) -> Values {
    let name = |foot: &FootPlants| solved.clip.skeleton.joint(foot.leg.ankle).name.clone();
    let feet = solved.feet.plants.iter().zip(solved.foot_numbers.iter()).filter(|(_, numbers)| numbers.plants > 0);
    let why_none = if solved.feet.plants.is_empty() { "no legs are known" } else { "no foot stands" };
    some(feet.map(|(foot, numbers)| (name(foot), number(numbers))).collect(), why_none)
}

/// Returns the values, or why there are none.
fn some(values: Vec<(String, Option<f64>)>, why_none: &'static str) -> Values {
    if values.is_empty() { Err(why_none) } else { Ok(values) }
}

/// Edited over source; 1 where both are nothing.
fn ratio(pair: Pair) -> f64 {
    if pair.edited == pair.source { 1.0 } else { pair.edited / pair.source }
}

impl FromStr for Limit {
    type Err = String;

    fn from_str(text: &str) -> Result<Self, String> {
        let names = || NUMBERS.iter().map(|number| number.name).collect::<Vec<_>>().join(", ");
        let (name, bound) =
            text.split_once('=').ok_or_else(|| format!("expected NAME=LIMIT, NAME one of {}", names()))?;
        let number = NUMBERS.iter().find(|number| number.name == name.trim());
        let number = number.ok_or_else(|| format!("there is no number `{}`; there are {}", name.trim(), names()))?;
        let bound = bound.trim().parse().ok().filter(|bound: &f64| bound.is_finite());
        let bound = bound.ok_or_else(|| format!("expected a number behind `{}=`", number.name))?;
        Ok(Self { number, bound })
    }
}

impl fmt::Display for Limit {
    fn fmt(&self, f: &mut fmt::Formatter<'_>) -> fmt::Result {
        write!(f, "{}={}", self.number.name, self.bound)
    }
}

impl Limit {
    /// Lists the numbers that can be bounded, for the help.
    pub(super) fn help() -> String {
        let mut text = String::from("Numbers that --fail bounds (H is the body height):\n");
        for number in &NUMBERS {
            text += &format!("  {:<20} {}\n", number.name, number.doc);
        }
        text + "\nA number that cannot be measured is beyond every limit, and the status is 1: those of feet\n\
                where no foot stands, seam_ratio where no cycle joins another. Without plants missed is 0.\n"
    }

    /// Says what of an edit is beyond the limit, one line each. What cannot be measured is beyond every limit.
    pub(super) fn broken_by(&self, solved: &Solved) -> Vec<String> {
        let Number { name, at_least, .. } = self.number;
        let (word, bound) = (if *at_least { "less" } else { "more" }, self.bound);
        let broken = |(of, value): (String, Option<f64>)| match value {
            None => Some(format!("{name} of {of} cannot be measured")),
            Some(v) if (*at_least && v < bound) || (!at_least && v > bound) || v.is_nan() => {
                Some(format!("{name} of {of} is {v:.4}, {word} than {bound}"))
            }
            Some(_) => None,
        };
        match (self.number.values)(solved) {
            Ok(values) => values.into_iter().filter_map(broken).collect(),
            Err(why) => vec![format!("{name} cannot be measured: {why}")],
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn limits_are_read_or_refused_in_words() {
        let limit: Limit = "slip=0.02".parse().expect("a limit");
        assert_eq!((limit.number.name, limit.bound, limit.to_string().as_str()), ("slip", 0.02, "slip=0.02"));
        for (text, why) in [
            ("slip", "expected NAME=LIMIT"),
            ("slop=1", "there is no number `slop`"),
            ("slip=wide", "expected a number behind `slip=`"),
            ("slip=nan", "expected a number behind `slip=`"),
        ] {
            let error = text.parse::<Limit>().expect_err(text);
            assert!(error.starts_with(why), "{error}");
        }
    }
}
