//! Single-stroke characters for engraved addresses: digits, capital letters and a few signs on a grid of 4 × 6.

use glam::DVec2;

/// Units of the glyph grid.
const WIDTH: f64 = 4.0;
const HEIGHT: f64 = 6.0;
/// From one glyph's left side to the next one's.
const ADVANCE: f64 = 6.0;

/// Strokes of a character as digit pairs x y, polylines apart by spaces; `None` for a character without a glyph.
fn grid(c: char) -> Option<&'static str> {
    Some(match c.to_ascii_uppercase() {
        ' ' => "",
        '0' => "103041453616050110",
        '1' => "152620 1030",
        '2' => "05163645440040",
        '3' => "0516364544334241301001 3313",
        '4' => "30360242",
        '5' => "460603334241301001",
        '6' => "4536160501103041423303",
        '7' => "064610",
        '8' => "13040516364544331302011030414233",
        '9' => "0110304145361605041343",
        '.' => "2021",
        '-' => "0343",
        '_' => "0040",
        '/' => "0046",
        '+' => "0343 2125",
        'A' => "002640 1333",
        'B' => "00063645443342413000 0333",
        'C' => "4130100105163645",
        'D' => "00062644422000",
        'E' => "40000646 0333",
        'F' => "000646 0333",
        'G' => "45361605011030414323",
        'H' => "0006 4046 0343",
        'I' => "2026 1030 1636",
        'J' => "0110203136",
        'K' => "0006 460340",
        'L' => "060040",
        'M' => "0006234640",
        'N' => "00064046",
        'O' => "20424426040220",
        'P' => "00063645443303",
        'Q' => "20424426040220 2240",
        'R' => "00063645443303 2340",
        'S' => "453616050413334241301001",
        'T' => "0646 2620",
        'U' => "060110304146",
        'V' => "062046",
        'W' => "0610233046",
        'X' => "0046 0640",
        'Y' => "062346 2320",
        'Z' => "06460040",
        _ => return None,
    })
}

/// Width and height of engraved `text` of glyph height `height`, mm.
#[must_use]
pub fn text_size(text: &str, height: f64) -> DVec2 {
    let n = text.chars().count() as f64;
    DVec2::new(if n > 0.0 { (n - 1.0) * ADVANCE + WIDTH } else { 0.0 } * height / HEIGHT, height)
}

/// Polylines of `text`, mm, lower left corner of the first glyph at the origin, reading along +X. Lower-case letters
/// are engraved as capitals.
///
/// # Errors
/// The first character that has no glyph.
pub fn text_strokes(text: &str, height: f64) -> Result<Vec<Vec<DVec2>>, char> {
    let scale = height / HEIGHT;
    let mut out = Vec::new();
    for (i, c) in text.chars().enumerate() {
        let strokes = grid(c).ok_or(c)?;
        let left = DVec2::new(i as f64 * ADVANCE, 0.0);
        for stroke in strokes.split_ascii_whitespace() {
            let point = |pair: &[u8]| {
                let unit = |digit: u8| f64::from(digit - b'0');
                (left + DVec2::new(unit(pair[0]), unit(pair[1]))) * scale
            };
            out.push(stroke.as_bytes().chunks_exact(2).map(point).collect());
        }
    }
    Ok(out)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn every_glyph_stays_in_its_box() {
        for c in "0123456789.-_/+ABCDEFGHIJKLMNOPQRSTUVWXYZ".chars() {
            let code = grid(c).unwrap();
            assert!(code.split(' ').all(|s| s.len() % 2 == 0 && s.len() >= 4), "{c}");
            let strokes = text_strokes(&c.to_string(), 12.0).unwrap();
            let size = text_size("0", 12.0);
            for p in strokes.iter().flatten() {
                assert!(p.x >= 0.0 && p.y >= 0.0 && p.x <= size.x && p.y <= size.y, "{c}");
            }
            assert!(strokes.iter().all(|s| s.windows(2).all(|w| w[0] != w[1])), "{c}");
        }
    }

    #[test]
    fn no_two_glyphs_are_alike() {
        let all: Vec<char> = "0123456789.-_/+ABCDEFGHIJKLMNOPQRSTUVWXYZ".chars().collect();
        for (i, a) in all.iter().enumerate() {
            assert!(all[..i].iter().all(|b| grid(*a) != grid(*b)), "{a}");
        }
    }

    #[test]
    fn text_is_as_wide_as_said_and_unknown_characters_are_named() {
        let strokes = text_strokes("3.12", 6.0).unwrap();
        let right = strokes.iter().flatten().map(|p| p.x).fold(0.0, f64::max);
        assert_eq!(right, text_size("3.12", 6.0).x);
        assert_eq!(text_strokes("3ß", 6.0), Err('ß'));
        assert_eq!(text_size("", 6.0).x, 0.0);
    }
}
