//! Fields for numbers, in the unit that they show: what is typed may have another one, as everywhere in a graph.

use eframe::egui::DragValue;
use eframe::egui::emath::format_with_decimals_in_range;
use std::cell::RefCell;
use std::rc::Rc;
use tenon_engine::Quantity;

/// A field for a number that measures something in `unit` (`mm`, `deg`, or nothing). What is typed and is no finite number of
/// that kind, such as `inf`, `1e999` and `3 deg` of a length, is not taken. What is left as it was shown stays as it is,
/// however many digits it has that are not shown.
pub fn figure<'a>(value: &'a mut f64, unit: &str) -> DragValue<'a> {
    let unit = Quantity::unit(unit);
    let shown = Rc::new(RefCell::new((String::new(), 0.0)));
    let before = shown.clone();
    DragValue::new(value)
        .custom_formatter(move |value, decimals| {
            let text = format_with_decimals_in_range(value, decimals);
            *shown.borrow_mut() = (text.clone(), value);
            text
        })
        .custom_parser(move |text| {
            let (shown, value) = &*before.borrow();
            if text == shown { Some(*value) } else { read(text, unit) }
        })
}

/// Reads a number, with a unit or in that of the field: blanks do not count, and minus is written in either way.
pub(super) fn read(text: &str, unit: Option<Quantity>) -> Option<f64> {
    let plain: String = text.chars().filter(|c| !c.is_whitespace()).map(|c| if c == '−' { '-' } else { c }).collect();
    let number = |text: &str| text.parse().ok().filter(|v: &f64| v.is_finite());
    let with_unit = || {
        let mut ends = plain.char_indices().map(|(at, _)| plain.split_at(at));
        let (text, typed) = ends.find_map(|(text, sign)| Some((text, Quantity::unit(sign)?)))?;
        let unit = unit.filter(|u| u.dimension == typed.dimension)?;
        number(text).map(|v| v * typed.value / unit.value).filter(|v| v.is_finite())
    };
    number(&plain).or_else(with_unit)
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn numbers_are_read_in_the_unit_of_the_field_or_in_their_own() {
        let (mm, deg) = (Quantity::unit("mm"), Quantity::unit("deg"));
        for (text, value) in [("12", 12.0), ("12 mm", 12.0), ("1.2 m", 1200.0), ("−3cm", -30.0), ("1 e2 in", 2540.0)]
        {
            assert_eq!(read(text, mm), Some(value), "{text}");
        }
        assert_eq!((read("90 °", deg), read("12", None)), (Some(90.0), Some(12.0)));
        for text in ["3 deg", "3 mm2", "m", "inf", "NaN", "1e999", "1e300 m", "3 apples", ""] {
            assert_eq!(read(text, mm).filter(|v| v.is_finite() && *v < 1e300), None, "{text}");
        }
        assert_eq!(read("12 mm", None), None);
    }
}
