//! Parameters as people set them: which widget an input without a wire gets, and what a typed text becomes in the file.

use super::catalog::PortInfo;
use tenon_engine::{InterfaceInput, Json, Literal, Node};

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
    /// By how much it slides, from the smallest value on; 0: by round parts of the whole way.
    pub step: f64,
}

impl Slider {
    /// The value at a place along the slider, 0 to 1, rounded to a step that people like.
    #[must_use]
    pub fn at(&self, along: f64) -> f64 {
        let value = self.min + along.clamp(0.0, 1.0) * (self.max - self.min);
        let (from, step) = if self.step > 0.0 { (self.min, self.step) } else { (0.0, self.by()) };
        (from + ((value - from) / step).round() * step).clamp(self.min, self.max)
    }

    /// By how much it slides.
    #[must_use]
    pub fn by(&self) -> f64 {
        match self.step {
            step if step > 0.0 => step,
            _ if self.integer => 1.0,
            _ => round_step((self.max - self.min) / 200.0),
        }
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
pub const WIDEST: f64 = 20_000.0;

/// An input as its node and an interface input that is bound to it make it: ends, step and unit that a person has set, the
/// entries of a value list.
#[must_use]
pub fn at(node: &Node, port: &PortInfo, bound: Option<&InterfaceInput>) -> PortInfo {
    let mut port = port.clone();
    let number = |name: &str, unset: f64| match node.params.get(name).map(Literal::json).as_deref() {
        Some(json) => json.as_f64(),
        None => Some(unset),
    };
    match (node.type_name.as_str(), port.name.as_str()) {
        ("slider" | "integer_slider", "value") => {
            port.range = number("min", 0.0).zip(number("max", 10.0));
            port.chosen = port.range.is_some();
            port.step = number("step", 0.0).unwrap_or_default();
            let unit = node.params.get("unit").map(Literal::to_json);
            port.unit = unit.as_ref().and_then(Json::as_str).unwrap_or_default().to_owned();
        }
        ("value_list", "chosen") => {
            let names =
                node.params.get("names").map(Literal::to_json).unwrap_or_else(|| ["one", "two", "three"].into());
            let names = names.as_array().map_or(&[][..], Vec::as_slice);
            port.choices = names.iter().filter_map(Json::as_str).map(str::to_owned).collect();
            port.default = port.choices.first().map(|name| Json::from(name.as_str()));
        }
        _ => {}
    }
    if let Some(bound) = bound {
        let (low, high) = port.range.unzip();
        port.chosen |= bound.min.is_some() && bound.max.is_some();
        port.range = bound.min.or(low).zip(bound.max.or(high));
        port.step = bound.step.unwrap_or(port.step);
        if let Some(unit) = bound.unit.as_ref().filter(|_| port.unit.is_empty()) {
            port.unit.clone_from(unit);
        }
    }
    port
}

/// The widget of an input as [`at`] makes it: its parameter, else its default.
#[must_use]
pub fn widget(port: &PortInfo, param: Option<&Json>) -> Widget {
    let Some(json) = param.or(port.default.as_ref()) else { return Widget::Empty };
    let integer = port.type_name == "integer";
    let plain = matches!(port.type_name.as_str(), "number" | "integer" | "any");
    match json {
        Json::Number(n) if plain => {
            let value = n.as_f64().unwrap_or_default();
            let fits = |min, max| max - min <= WIDEST && (min..=max).contains(&value) && hits(value, min, max);
            match port.range {
                Some((min, max)) if max > min && (port.chosen || fits(min, max)) => {
                    Widget::Slider(Slider { value, min, max, integer, step: port.step })
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

/// A slider that was typed: `5`, `0..10`, `0..5..10`, `0<5<10`, each with a unit behind it if it has one.
#[derive(Clone, Debug, PartialEq)]
pub struct Typed {
    /// Its ends, value and step.
    pub slider: Slider,
    /// Sign of its unit; empty for a plain number.
    pub unit: String,
}

impl Typed {
    /// What was typed, if it is a slider. Whole numbers slide by 1, others by one in the last place that was typed.
    #[must_use]
    pub fn read(text: &str) -> Option<Self> {
        let text = text.trim();
        let figure = |c: char| c.is_ascii_digit() || matches!(c, '.' | '<' | '-' | '+' | ' ');
        let end = text.char_indices().find(|(_, c)| !figure(*c)).map_or(text.len(), |(i, _)| i);
        let (figures, unit) = text.split_at(end);
        let parts: Vec<&str> = figures.split('<').flat_map(|p| p.split("..")).map(str::trim).collect();
        let numbers: Vec<f64> =
            parts.iter().map(|p| p.parse().ok().filter(|v: &f64| v.is_finite())).collect::<Option<_>>()?;
        let (min, value, max) = match numbers[..] {
            [value] => {
                let far = 10f64.powf(value.abs().max(1.0).log10().ceil()).max(10.0);
                (if value < 0.0 { -far } else { 0.0 }, value, far)
            }
            [min, max] => (min, min, max),
            [min, value, max] => (min, value, max),
            _ => return None,
        };
        let places = parts.iter().map(|p| p.split_once('.').map_or(0, |(_, places)| places.len())).max();
        let step = 10f64.powi(-i32::try_from(places.unwrap_or(0)).ok()?);
        let known = unit.is_empty() || tenon_engine::Quantity::unit(unit).is_some();
        let slider = Slider { value, min, max, integer: false, step };
        (known && min < max && (min..=max).contains(&value)).then(|| Self { slider, unit: unit.to_owned() })
    }

    /// The type of the node that is this: one for whole numbers fits inputs of either kind.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        let s = &self.slider;
        let whole = [s.value, s.min, s.max, s.step].iter().all(|v| v.fract() == 0.0);
        if whole && self.unit.is_empty() { "integer_slider" } else { "slider" }
    }

    /// The parameters of a node of that type that is this.
    #[must_use]
    pub fn params(&self) -> Vec<(&'static str, Json)> {
        let Slider { value, min, max, step, .. } = self.slider;
        let mut all: Vec<(&'static str, Json)> =
            [("value", value), ("min", min), ("max", max), ("step", step)].map(|(port, v)| (port, number(v))).into();
        if !self.unit.is_empty() {
            all.push(("unit", Json::from(self.unit.as_str())));
        }
        all
    }
}

/// A number as the file should have it: whole ones without a point.
#[must_use]
pub fn number(value: f64) -> Json {
    if value.fract() == 0.0 && value.abs() < 1e15 { Json::from(value as i64) } else { Json::from(value) }
}

/// A number that a hand has set by sliding: rounded to six decimals, as far as it has any.
#[must_use]
pub fn slid(value: f64) -> f64 {
    let rounded = (value * 1e6).round() / 1e6;
    if rounded.is_finite() { rounded } else { value }
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
        (bound.min, bound.max, bound.unit) = (Some(4.0), Some(30.0), Some("mm".into()));
        let narrowed = at(&Node::new("thicken"), &port(Some((0.0, 100.0))), Some(&bound));
        assert_eq!(narrowed.unit, "mm");
        let slider = |w| match w {
            Widget::Slider(s) => Some((s.value, s.min, s.max)),
            _ => None,
        };
        assert_eq!(slider(widget(&port(Some((0.0, 100.0))), None)), Some((10.0, 0.0, 100.0)));
        assert_eq!(slider(widget(&narrowed, Some(&json!(12)))), Some((12.0, 4.0, 30.0)));
        assert_eq!(widget(&port(None), None), Widget::Number { value: 10.0, integer: false });
        let tiny = widget(&port(Some((0.0, 1000.0))), Some(&json!(1e-6)));
        assert_eq!(tiny, Widget::Number { value: 1e-6, integer: false }, "a slider could not hit it");
        assert_eq!(widget(&port(None), Some(&json!("2 cm"))), Widget::Text("2 cm".into()));
    }

    #[test]
    fn sliders_land_on_round_numbers() {
        let s = Slider { value: 10.0, min: 4.0, max: 30.0, integer: false, step: 0.0 };
        assert_eq!((s.at(0.0), s.at(1.0), s.at(0.5)), (4.0, 30.0, 17.0));
        assert_eq!((shown(s.at(0.123)).as_str(), shown(1e-6).as_str(), shown(0.0).as_str()), ("7.2", "1e-6", "0"));
        assert_eq!(Slider { integer: true, ..s }.at(0.49), 17.0);
    }

    #[test]
    fn a_slider_is_typed_in_a_few_signs() {
        let read =
            |text| Typed::read(text).map(|t| (t.slider.min, t.slider.value, t.slider.max, t.slider.step, t.unit));
        let some = |min, value, max, step, unit: &str| Some((min, value, max, step, unit.to_owned()));
        assert_eq!(read("5"), some(0.0, 5.0, 10.0, 1.0, ""));
        assert_eq!(read("120"), some(0.0, 120.0, 1000.0, 1.0, ""));
        assert_eq!(read("-2.5"), some(-10.0, -2.5, 10.0, 0.1, ""));
        assert_eq!(read("0..5..10"), some(0.0, 5.0, 10.0, 1.0, ""));
        assert_eq!(read("0<0.25<1 cm"), some(0.0, 0.25, 1.0, 0.01, "cm"));
        assert_eq!(read("4 .. 30 mm"), some(4.0, 4.0, 30.0, 1.0, "mm"));
        for not in ["", "thicken", "5 apples", "9<5<10", "5..5", "1<2<3<4", "mm"] {
            assert_eq!(read(not), None, "{not}");
        }
        let types = ["5", "5.0", "5 mm"].map(|text| Typed::read(text).unwrap().type_name());
        assert_eq!(types, ["integer_slider", "slider", "slider"]);
        let slider = Typed::read("0..4..10").unwrap().slider;
        assert_eq!((slider.at(0.53), slider.by()), (5.0, 1.0));
        let threes = Slider { value: 1.0, min: 1.0, max: 10.0, integer: false, step: 3.0 };
        assert_eq!((threes.at(0.3), threes.at(0.5)), (4.0, 7.0), "steps begin at the smallest value");
    }

    #[test]
    fn nodes_say_how_their_inputs_are_set() {
        let slider = Node::new("slider").param("max", 40).param("unit", "cm");
        let value = at(&slider, &PortInfo { name: "value".into(), ..port(None) }, None);
        assert_eq!((value.range, value.unit.as_str(), value.chosen), (Some((0.0, 40.0)), "cm", true));
        assert!(matches!(widget(&value, Some(&json!(1e-6))), Widget::Slider(_)), "a person wants it to be one");
        let list = Node::new("value_list").param("names", json!(["thin", "thick"]));
        let chosen = at(&list, &PortInfo { name: "chosen".into(), default: None, ..port(None) }, None);
        assert_eq!(widget(&chosen, None), Widget::Choice("thin".into()));
        assert_eq!([slid(0.123_456_78), slid(1e305), slid(-f64::MAX)], [0.123_457, 1e305, -f64::MAX]);
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
