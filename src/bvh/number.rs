//! Decimal text to f64, the same value that `str::parse` gives, several times faster.
//!
//! Nearly all numbers in a clip have a handful of digits, so their digits fit in 53 bits and their power of ten is
//! exact in f64; one division of two exact values is then correctly rounded (W. D. Clinger, "How to Read Floating
//! Point Numbers Accurately", PLDI 1990). The rest goes to `fast_float2`.

use super::cursor::is_space;

/// The powers of ten that f64 holds exactly.
const POWERS_OF_TEN: [f64; 23] = [
    1e0, 1e1, 1e2, 1e3, 1e4, 1e5, 1e6, 1e7, 1e8, 1e9, 1e10, 1e11, 1e12, 1e13, 1e14, 1e15, 1e16, 1e17, 1e18, 1e19, 1e20,
    1e21, 1e22,
];

/// Up to this, every integer is an f64.
const LAST_EXACT_INTEGER: u64 = 1 << 53;

/// Up to this many digits cannot overflow a u64.
const MAX_DIGITS: usize = 19;

/// Reads the number that is the whole word at `at`; returns it and where the word ends.
///
/// None when the word is empty, not a number, or not a finite one.
#[inline]
pub(super) fn number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let negative = text.get(at) == Some(&b'-');
    let first = at + usize::from(negative);
    let (whole, mut end) = digits(text, first, 0);
    let mut mantissa = whole;
    let mut n_digits = end - first;
    let mut n_decimals = 0;
    if text.get(end) == Some(&b'.') {
        let point = end;
        (mantissa, end) = digits(text, point + 1, whole);
        n_decimals = end - point - 1;
        n_digits += n_decimals;
    }
    let is_simple = (1..=MAX_DIGITS).contains(&n_digits)
        && mantissa <= LAST_EXACT_INTEGER
        && text.get(end).is_none_or(|&b| is_space(b));
    if !is_simple {
        return any_number(text, at);
    }
    let magnitude = mantissa as f64 / POWERS_OF_TEN[n_decimals];
    Some((if negative { -magnitude } else { magnitude }, end))
}

/// Appends the decimal digits from `at` on to `mantissa`, which wraps when there are too many.
#[inline]
fn digits(text: &[u8], mut at: usize, mut mantissa: u64) -> (u64, usize) {
    while let Some(digit) = text.get(at).map(|b| b.wrapping_sub(b'0')).filter(|&d| d < 10) {
        mantissa = mantissa.wrapping_mul(10).wrapping_add(u64::from(digit));
        at += 1;
    }
    (mantissa, at)
}

/// Exponents, very long numbers, and words that are no numbers.
#[cold]
fn any_number(text: &[u8], at: usize) -> Option<(f64, usize)> {
    let rest = text.get(at..)?;
    let len = rest.iter().position(|&b| is_space(b)).unwrap_or(rest.len());
    let value: f64 = fast_float2::parse(&rest[..len]).ok()?;
    value.is_finite().then_some((value, at + len))
}

#[cfg(test)]
mod tests {
    use proptest::prelude::*;

    use super::*;

    /// Reads one word and compares the bits with the standard library's.
    fn check(word: &str) {
        let expected = word.parse::<f64>().ok().filter(|v| v.is_finite()).map(f64::to_bits);
        let text = format!("{word} 7");
        let found = number(text.as_bytes(), 0);
        assert_eq!(found.map(|(v, _)| v.to_bits()), expected, "{word}");
        if let Some((_, end)) = found {
            assert_eq!(end, word.len());
        }
        assert_eq!(number(word.as_bytes(), 0), found, "{word} at the end of the text");
    }

    #[test]
    fn corner_cases_equal_std() {
        for word in [
            "0",
            "-0",
            "-0.0000",
            "+1.5",
            "1.",
            ".5",
            "-.5",
            ".",
            "-",
            "+",
            "--1",
            "1.2.3",
            "1e5",
            "1E-7",
            "1e",
            "nan",
            "inf",
            "-inf",
            "1e400",
            "1e-400",
            "5e-324",
            "9007199254740992",
            "9007199254740993",
            "9007199254740993.5",
            "0.0000000000000000000000000001",
            "12345678901234567890123",
            "0.1234567890123456789",
            "1.7976931348623157e308",
            "00000000000000000000000000012.5",
            "3,5",
            "0x10",
            "1_0",
            "abc",
            "18446744073709551616.0",
        ] {
            check(word);
        }
    }

    #[test]
    fn many_written_numbers_equal_std() {
        let mut state = 0x243f_6a88_85a3_08d3_u64;
        for _ in 0..200_000 {
            state = state.wrapping_mul(6364136223846793005).wrapping_add(1442695040888963407);
            let value = (state >> 11) as f64 / 2f64.powi(20 + (state % 40) as i32) - 300.0;
            check(&format!("{value:.*}", (state >> 7) as usize % 9));
        }
    }

    proptest! {
        #[test]
        fn random_words_equal_std(word in "[-+]?[0-9]{0,22}(\\.[0-9]{0,26})?([eE][-+]?[0-9]{0,3})?") {
            prop_assume!(!word.is_empty());
            check(&word);
        }

        #[test]
        fn random_floats_equal_std(value in any::<f64>()) {
            check(&format!("{value}"));
            check(&format!("{value:e}"));
        }
    }
}
