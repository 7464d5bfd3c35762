//! The values of `--vary NAME=VALUES`: a list `a,b,c` or a range `start:end:count`.

use crate::words::Wrong;
use tenon_engine::Json;

/// The most values that one input may have.
const MOST: usize = 1_000_000;

/// The values that `text` names, in its order; `literal` says what each of a list's texts stands for.
///
/// # Errors
/// No value, or a range that is not one.
pub fn values(text: &str, literal: impl Fn(&str) -> Json) -> Result<Vec<Json>, Wrong> {
    if let Some(range) = range(text)? {
        return Ok(range);
    }
    let parts = split(text);
    if parts.iter().any(|p| p.is_empty()) {
        let wrong = Wrong::new("vary", format!("\"{text}\" has an empty value"));
        return Err(wrong.hint("write values between commas, such as 12,15,18, or a range such as 12:18:3"));
    }
    Ok(parts.into_iter().map(literal).collect())
}

/// `start:end:count`, or nothing if these are not three numbers.
fn range(text: &str) -> Result<Option<Vec<Json>>, Wrong> {
    let parts: Vec<&str> = text.split(':').map(str::trim).collect();
    let [start, end, count] = parts[..] else { return Ok(None) };
    let (Ok(start), Ok(end), Ok(count)) = (start.parse::<f64>(), end.parse::<f64>(), count.parse::<f64>()) else {
        return Ok(None);
    };
    let whole = count.fract() == 0.0 && count >= 2.0 && count <= MOST as f64;
    if !(start.is_finite() && end.is_finite() && whole) {
        let message = format!("\"{text}\" is not a range: it takes two finite numbers and a count of 2 to {MOST}");
        return Err(Wrong::new("vary", message).hint("10:20:3 stands for 10,15,20"));
    }
    let last = count as usize - 1;
    // Both ends exactly, whatever the rounding between them.
    let at = |i: usize| {
        let t = i as f64 / last as f64;
        if i == last { end } else { start * (1.0 - t) + end * t }
    };
    Ok(Some((0..=last).map(|i| number(at(i))).collect()))
}

/// Whole numbers as such, so that inputs which count take them.
fn number(v: f64) -> Json {
    if v.fract() == 0.0 && v.abs() < 9e15 { Json::from(v as i64) } else { Json::from(v) }
}

/// Splits at the commas outside brackets and quotes.
fn split(text: &str) -> Vec<&str> {
    let (mut depth, mut quoted, mut escaped, mut start) = (0_usize, false, false, 0);
    let mut parts = Vec::new();
    for (i, c) in text.char_indices() {
        match c {
            _ if escaped => escaped = false,
            '\\' if quoted => escaped = true,
            '"' => quoted = !quoted,
            '[' | '{' if !quoted => depth += 1,
            ']' | '}' if !quoted => depth = depth.saturating_sub(1),
            ',' if !quoted && depth == 0 => {
                parts.push(text[start..i].trim());
                start = i + 1;
            }
            _ => {}
        }
    }
    parts.push(text[start..].trim());
    parts
}

#[cfg(test)]
mod tests {
    use super::*;

    fn of(text: &str) -> String {
        let literal = |t: &str| serde_json::from_str(t).unwrap_or_else(|_| Json::from(t));
        Json::from(values(text, literal).unwrap()).to_string()
    }

    #[test]
    fn lists_and_ranges() {
        assert_eq!(of("12,15.5,\"a,b\""), r#"[12,15.5,"a,b"]"#);
        assert_eq!(of("[0,0,1], [1,2,3]"), "[[0,0,1],[1,2,3]]");
        assert_eq!(of("12 mm,1 cm"), r#"["12 mm","1 cm"]"#);
        assert_eq!(of("10:20:3"), "[10,15,20]");
        assert_eq!(of("1:0:5"), "[1,0.75,0.5,0.25,0]");
        assert_eq!(of("0.1:0.3:3"), "[0.1,0.2,0.3]");
        assert_eq!(of("a:b:c"), r#"["a:b:c"]"#);
        assert_eq!(of("x"), r#"["x"]"#);
    }

    #[test]
    fn what_is_no_value_is_refused() {
        for text in ["", "1,,2", "1,", "0:1:1", "0:1:2.5", "0:inf:3", "0:1:1e12", "0:1:-3", "0:1:nan"] {
            assert_eq!(values(text, |t| Json::from(t)).unwrap_err().code, "vary", "{text}");
        }
    }
}
