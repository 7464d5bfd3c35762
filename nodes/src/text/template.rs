//! Texts with places for values: `Panel {a}: {b:.1} mm`, `{a:03}`; `{{` and `}}` stand for the braces themselves.

use tenon_engine::{Column, Text};

/// Widths and decimals beyond this are slips.
const WIDEST: usize = 100;

/// Fills the places of `template`; `value` gives the column whose first item stands for a name. O(text).
pub(super) fn fill(template: &str, value: impl Fn(&str) -> Option<Column>) -> Result<String, String> {
    let mut out = String::with_capacity(template.len());
    let mut rest = template;
    while let Some(at) = rest.find(['{', '}']) {
        let (before, brace) = rest.split_at(at);
        out.push_str(before);
        if let Some(after) = brace.strip_prefix("{{").or_else(|| brace.strip_prefix("}}")) {
            out.push_str(&brace[..1]);
            rest = after;
            continue;
        }
        let place = brace.strip_prefix('{').ok_or("a } stands alone; write }} for the brace itself")?;
        let (place, after) = place.split_once('}').ok_or("a { is never closed; write {{ for the brace itself")?;
        let (name, spec) = place.split_once(':').unwrap_or((place, ""));
        let column = value(name.trim()).ok_or_else(|| format!("{{{place}}} stands for an input that has no value"))?;
        out.push_str(&show(&column, spec)?);
        rest = after;
    }
    out.push_str(rest);
    Ok(out)
}

/// The first item as `[0][width][.decimals]` says.
fn show(column: &Column, spec: &str) -> Result<String, String> {
    let wrong = || format!("\":{spec}\" is not [0][width][.decimals] with numbers up to {WIDEST}");
    let number = |text: &str| match text.parse::<usize>() {
        Ok(n) if n <= WIDEST && text.bytes().all(|b| b.is_ascii_digit()) => Ok(n),
        _ => Err(wrong()),
    };
    let (width, decimals) = match spec.split_once('.') {
        Some((width, decimals)) => (width, Some(number(decimals)?)),
        None => (spec, None),
    };
    let zeros = width.starts_with('0');
    let width = if width.is_empty() { 0 } else { number(width)? };
    let float = column.get::<f64>(0).copied();
    let whole = column.get::<i64>(0).copied();
    let text = match (decimals, float, whole) {
        (Some(d), Some(v), _) => unsigned_zero(format!("{v:.d$}")),
        (Some(d), None, Some(v)) if d > 0 => format!("{v}.{:0<d$}", ""),
        (_, None, Some(v)) => v.to_string(),
        (None, Some(v), _) => v.to_string(),
        (Some(_), None, None) => return Err(format!("a {} has no decimals", column.type_name())),
        (None, None, None) => column.get::<Text>(0).map_or_else(|| column.summary(0), ToString::to_string),
    };
    if zeros && (float.is_some() || whole.is_some()) {
        let (sign, digits) = text.strip_prefix('-').map_or(("", &*text), |digits| ("-", digits));
        return Ok(format!("{sign}{digits:0>0$}", width.saturating_sub(sign.len())));
    }
    Ok(format!("{text:>width$}"))
}

/// "-0.00" is not what anybody wants to read.
fn unsigned_zero(text: String) -> String {
    match text.strip_prefix('-') {
        Some(digits) if digits.bytes().all(|b| b == b'0' || b == b'.') => digits.to_owned(),
        _ => text,
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use proptest::prelude::*;

    fn filled(template: &str) -> Result<String, String> {
        fill(template, |name| match name {
            "a" => Some(Column::new(vec![7i64])),
            "b" => Some(Column::new(vec![-2.345])),
            "c" => Some(Column::new(vec![Text::from("oak")])),
            "d" => Some(Column::new(vec![-0.001])),
            _ => None,
        })
    }

    #[test]
    fn places_take_values_as_asked() {
        for (template, expected) in [
            ("Panel {a}: {b} of {c}", "Panel 7: -2.345 of oak"),
            ("{a:03}|{a:3}|{a:.2}|{a:.0}", "007|  7|7.00|7"),
            ("{b:.1}|{b:08.2}|{d:.2}", "-2.3|-0002.35|0.00"),
            ("{c:5}|{{a}}", "  oak|{a}"),
            ("", ""),
        ] {
            assert_eq!(filled(template).as_deref(), Ok(expected), "{template}");
        }
    }

    #[test]
    fn slips_are_told() {
        for (template, told) in [
            ("{a", "never closed"),
            ("a}", "stands alone"),
            ("{x}", "no value"),
            ("{a:x}", "width"),
            ("{c:.1}", "decimals"),
        ] {
            assert!(filled(template).is_err_and(|e| e.contains(told)), "{template}");
        }
        assert!(filled("{a:999999999999}").is_err() && filled("{b:.101}").is_err() && filled("{b:+1}").is_err());
    }

    proptest! {
        #[test]
        fn no_template_can_do_harm(template in "[{}abc:.0-9é ]{0,30}") {
            let _ = filled(&template);
        }

        #[test]
        fn text_without_braces_stays(text in "[^{}]{0,40}") {
            prop_assert_eq!(filled(&text), Ok(text));
        }
    }
}
