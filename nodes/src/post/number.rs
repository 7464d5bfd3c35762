//! Numbers of programs: fixed decimals, written without the general formatter, which would take most of a post's time.

/// 10^n.
const POWER: [i64; 10] = [1, 10, 100, 1_000, 10_000, 100_000, 1_000_000, 10_000_000, 100_000_000, 1_000_000_000];

/// `value` in units of the last of `decimals` decimals (9 at most), rounded half away from zero; `None` if it is not
/// finite or has more digits than fit.
#[must_use]
pub fn to_units(value: f64, decimals: u32) -> Option<i64> {
    let scaled = (value * *POWER.get(decimals as usize)? as f64).round();
    (scaled.abs() < 9e15).then_some(scaled as i64)
}

/// Appends `units` with `decimals` decimals: 12500 and 3 give `12.500`.
pub fn push_units(text: &mut String, units: i64, decimals: u32) {
    if units < 0 {
        text.push('-');
    }
    let power = POWER.get(decimals as usize).copied().unwrap_or(1).unsigned_abs();
    let digits = units.unsigned_abs();
    push_digits(text, digits / power, 1);
    if decimals > 0 {
        text.push('.');
        push_digits(text, digits % power, decimals as usize);
    }
}

fn push_digits(text: &mut String, mut value: u64, width: usize) {
    let mut digits = [b'0'; 20];
    let mut at = digits.len();
    while value > 0 {
        at -= 1;
        digits[at] = b'0' + (value % 10) as u8;
        value /= 10;
    }
    at = at.min(digits.len() - width);
    // Digits are ASCII; a slice at once is several times faster than characters one by one.
    text.push_str(std::str::from_utf8(&digits[at..]).unwrap_or_default());
}

/// `value` with up to three decimals and no trailing zeros, for feeds and speeds.
#[must_use]
pub fn short(value: f64) -> String {
    let mut text = String::new();
    match to_units(value, 3) {
        Some(units) => push_units(&mut text, units, 3),
        None => return format!("{value}"),
    }
    let end = text.trim_end_matches('0').trim_end_matches('.').len();
    text.truncate(end);
    text
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn fixed(value: f64, decimals: u32) -> String {
        let mut text = String::new();
        push_units(&mut text, to_units(value, decimals).unwrap(), decimals);
        text
    }

    #[test]
    fn numbers_read_as_expected() {
        assert_eq!(fixed(12.5, 3), "12.500");
        assert_eq!(fixed(-0.0004, 3), "0.000");
        assert_eq!(fixed(-0.0006, 3), "-0.001");
        assert_eq!(fixed(-1234.5678, 2), "-1234.57");
        assert_eq!(fixed(7.0, 0), "7");
        assert_eq!(short(1500.0), "1500");
        assert_eq!(short(0.25), "0.25");
        assert_eq!(to_units(f64::NAN, 3), None);
        assert_eq!(to_units(1e300, 3), None);
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(256))]

        #[test]
        fn the_text_is_within_half_a_unit(value in -1e6..1e6f64, decimals in 0u32..6) {
            let back: f64 = fixed(value, decimals).parse().unwrap();
            prop_assert!((back - value).abs() <= 0.5000001 / POWER[decimals as usize] as f64);
        }
    }
}
