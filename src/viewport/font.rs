//! Characters as 8×8 bits.

use font8x8::unicode::{BASIC_UNICODE, BLOCK_UNICODE, BOX_UNICODE, GREEK_UNICODE, LATIN_UNICODE};

/// Pixels along each side of a character.
pub(super) const SIDE: u32 = 8;

/// Characters that the font lacks and people write; rows from the top, the lowest bit on the left.
const OURS: &[(char, [u8; 8])] = &[
    ('…', [0, 0, 0, 0, 0, 0, 0xDB, 0]),
    ('→', [0, 0x08, 0x18, 0x3F, 0x18, 0x08, 0, 0]),
    ('←', [0, 0x08, 0x0C, 0x7E, 0x0C, 0x08, 0, 0]),
    ('↑', [0x08, 0x1C, 0x3E, 0x08, 0x08, 0x08, 0, 0]),
    ('↓', [0x08, 0x08, 0x08, 0x3E, 0x1C, 0x08, 0, 0]),
    ('−', [0, 0, 0, 0x3F, 0, 0, 0, 0]),
    ('–', [0, 0, 0, 0x3F, 0, 0, 0, 0]),
    ('—', [0, 0, 0, 0xFF, 0, 0, 0, 0]),
];

/// Returns the bits of a character, rows 0–3 and rows 4–7, the lowest bit of each byte on the left; those of `?` for a
/// character without a picture.
pub(super) fn bits(c: char) -> [u32; 2] {
    let rows = rows(c).or_else(|| rows('?')).unwrap_or_default();
    let [a, b, c, d, e, f, g, h] = rows;
    [u32::from_le_bytes([a, b, c, d]), u32::from_le_bytes([e, f, g, h])]
}

fn rows(c: char) -> Option<[u8; 8]> {
    let ours = OURS.iter().find(|(known, _)| *known == c).map(|&(_, rows)| rows);
    ours.or_else(|| {
        let tables: [&[font8x8::FontUnicode]; 5] =
            [&BASIC_UNICODE, &LATIN_UNICODE, &GREEK_UNICODE, &BOX_UNICODE, &BLOCK_UNICODE];
        tables.into_iter().flatten().find(|f| f.char() == c).map(font8x8::FontUnicode::byte_array)
    })
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn letters_have_their_rows_from_the_top() {
        // The font's `L`: a stem on the left, a foot at the bottom, an empty last row.
        let [upper, lower] = bits('L');
        assert_eq!(upper.to_le_bytes(), [0x0F, 0x06, 0x06, 0x06]);
        assert_eq!(lower.to_le_bytes(), [0x46, 0x66, 0x7F, 0x00]);
    }

    #[test]
    fn unknown_characters_show_as_question_marks() {
        assert_eq!(bits('\u{1F600}'), bits('?'));
        for c in "az09·°×é…→−".chars() {
            assert_ne!(bits(c), bits('?'), "{c}");
        }
        assert_eq!(bits(' '), [0, 0]);
    }
}
