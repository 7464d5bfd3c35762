//! Parameters as people set them: which widget an input without a wire gets, and what a typed text becomes in the file.

use super::catalog::PortInfo;
use tenon_engine::{InterfaceInput, Json};

/// How an input without a wire is edited.
#[derive(Clone, Debug, PartialEq)]
pub enum Widget {
    /// A number between two ends.
    Slider(Slider),
    /// A number without known ends.
    Number {
        /// It.
        value: f64,
        /// Whole numbers only.
        integer: bool,
    },
    /// True or false.
    Toggle(bool),
    /// One of several texts.
    Choice(String),
    /// A text or a formula.
    Text(String),
    /// Anything else, in one line; edited as JSON.
    Other(String),
    /// Nothing stands there.
    Empty,
}

/// A number between two ends.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Slider {
    /// The number.
    pub value: f64,
    /// Its smallest value.
    pub min: f64,
    /// Its largest value.
    pub max: f64,
    /// Whole numbers only.
    pub integer: bool,
}

impl Slider {
    /// The value at a place along the slider, 0 to 1, rounded to a step that people like.
    #[must_use]
    pub fn at(&self, along: f64) -> f64 {
        let value = self.min + along.clamp(0.0, 1.0) * (self.max - self.min);
        let step = if self.integer { 1.0 } else { round_step((self.max - self.min) / 200.0) };
        ((value / step).round() * step).clamp(self.min, self.max)
    }

    /// How far along the value lies, 0 to 1.
    #[must_use]
    pub fn along(&self) -> f64 {
        if self.max > self.min { ((self.value - self.min) / (self.max - self.min)).clamp(0.0, 1.0) } else { 0.0 }
    }
}

/// The largest of 1, 2, 5 times a power of ten that is not larger.
#[must_use]
pub fn round_step(step: f64) -> f64 {
    if !(step.is_finite() && step > 0.0) {
        return 1.0;
    }
    let ten = 10f64.powf(step.log10().floor());
    [5.0, 2.0, 1.0].into_iter().map(|m| m * ten).find(|s| *s <= step * (1.0 + 1e-9)).unwrap_or(ten)
}

/// Ranges wider than this get no slider: nothing could be hit on it.
const WIDEST: f64 = 20_000.0;

/// The widget of an input: its parameter, else its default. An interface input that is bound to it narrows the range.
#[must_use]
pub fn widget(port: &PortInfo, param: Option<&Json>, bound: Option<&InterfaceInput>) -> Widget {
    let Some(json) = param.or(port.default.as_ref()) else { return Widget::Empty };
    let integer = port.type_name == "integer";
    let plain = matches!(port.type_name.as_str(), "number" | "integer" | "any");
    match json {
        Json::Number(n) if plain => {
            let value = n.as_f64().unwrap_or_default();
            let (low, high) = port.range.unzip();
            let min = bound.and_then(|b| b.min).or(low);
            let max = bound.and_then(|b| b.max).or(high);
            match min.zip(max) {
                Some((min, max)) if max - min <= WIDEST && (min..=max).contains(&value) && hits(value, min, max) => {
                    Widget::Slider(Slider { value, min, max, integer })
                }
                _ => Widget::Number { value, integer },
            }
        }
        Json::Bool(b) => Widget::Toggle(*b),
        Json::String(s) if !port.choices.is_empty() => Widget::Choice(s.clone()),
        Json::String(s) => Widget::Text(s.clone()),
        other => Widget::Other(in_short(other)),
    }
}

/// Whether a slider between two ends can be set to about a value: it must not lie within the first step.
fn hits(value: f64, min: f64, max: f64) -> bool {
    value == min || value - min >= (max - min) / 400.0
}

/// A value in a few words: long lists by their number of entries.
fn in_short(json: &Json) -> String {
    match json {
        Json::Array(list) if list.iter().all(Json::is_array) && !list.is_empty() => match list.len() {
            1 => "1 point".into(),
            n => format!("{n} points"),
        },
        Json::Array(list) if list.len() > 3 => format!("{} values", list.len()),
        other => other.to_string(),
    }
}

/// A number as the file should have it: whole ones without a point.
#[must_use]
pub fn number(value: f64) -> Json {
    if value.fract() == 0.0 && value.abs() < 1e15 { Json::from(value as i64) } else { Json::from(value) }
}

/// A number as people read it: at most four decimals, no trailing zeros.
#[must_use]
pub fn shown(value: f64) -> String {
    if value != 0.0 && value.abs() < 1e-3 {
        return format!("{value:e}");
    }
    let text = format!("{value:.4}");
    let text = text.trim_end_matches('0').trim_end_matches('.');
    if text == "-0" { "0".into() } else { text.into() }
}

/// The text by which a value is edited.
#[must_use]
pub fn to_text(json: Option<&Json>) -> String {
    match json {
        None => String::new(),
        Some(Json::String(s)) => s.clone(),
        Some(Json::Number(n)) => {
            n.as_f64().map_or_else(|| n.to_string(), |v| if v.fract() == 0.0 { shown(v) } else { n.to_string() })
        }
        Some(other) => other.to_string(),
    }
}

/// What a typed text becomes: nothing is the default again; at text inputs the text as it stands, at others what it is as
/// JSON, and what is not JSON, such as `12 mm`, as text.
#[must_use]
pub fn from_text(port: &PortInfo, text: &str) -> Option<Json> {
    if text.trim().is_empty() {
        return None;
    }
    if port.type_name == "text" && port.access == tenon_engine::Access::Item {
        return Some(Json::from(text));
    }
    Some(serde_json::from_str(text.trim()).unwrap_or_else(|_| Json::from(text.trim())))
}

#[cfg(test)]
mod tests {
    use super::super::catalog::Catalog;
    use super::*;
    use serde_json::json;

    fn port(range: Option<(f64, f64)>) -> PortInfo {
        PortInfo { type_name: "number".into(), range, default: Some(json!(10)), ..Catalog::unknown_port("x") }
    }

    #[test]
    fn a_range_makes_a_slider_and_the_interface_narrows_it() {
        let mut bound = InterfaceInput::default();
        (bound.min, bound.max) = (Some(4.0), Some(30.0));
        let slider = |w| match w {
            Widget::Slider(s) => Some((s.value, s.min, s.max)),
            _ => None,
        };
        assert_eq!(slider(widget(&port(Some((0.0, 100.0))), None, None)), Some((10.0, 0.0, 100.0)));
        assert_eq!(slider(widget(&port(Some((0.0, 100.0))), Some(&json!(12)), Some(&bound))), Some((12.0, 4.0, 30.0)));
        assert_eq!(widget(&port(None), None, None), Widget::Number { value: 10.0, integer: false });
        let tiny = widget(&port(Some((0.0, 1000.0))), Some(&json!(1e-6)), None);
        assert_eq!(tiny, Widget::Number { value: 1e-6, integer: false }, "a slider could not hit it");
        assert_eq!(widget(&port(None), Some(&json!("2 cm")), None), Widget::Text("2 cm".into()));
    }

    #[test]
    fn sliders_land_on_round_numbers() {
        let s = Slider { value: 10.0, min: 4.0, max: 30.0, integer: false };
        assert_eq!((s.at(0.0), s.at(1.0), s.at(0.5)), (4.0, 30.0, 17.0));
        assert_eq!((shown(s.at(0.123)).as_str(), shown(1e-6).as_str(), shown(0.0).as_str()), ("7.2", "1e-6", "0"));
        assert_eq!(Slider { integer: true, ..s }.at(0.49), 17.0);
    }

    #[test]
    fn typed_texts_become_numbers_formulas_or_texts() {
        assert_eq!(from_text(&port(None), "12"), Some(json!(12)));
        assert_eq!(from_text(&port(None), "12 mm"), Some(json!("12 mm")));
        assert_eq!(from_text(&port(None), " "), None);
        let text = PortInfo { type_name: "text".into(), access: tenon_engine::Access::Item, ..port(None) };
        assert_eq!(from_text(&text, "12"), Some(json!("12")));
    }
}
