//! Ports: name, item type, access, unit, range, default and choices of one input or output; and what they accept.

use crate::diagnostic::{Fail, did_you_mean};
use crate::expression::{Dimension, Expression, Quantity};
use crate::stop::Stoppable;
use crate::value::item::kind_of;
use crate::value::{Column, Item, Json, Text, Tree};
use std::any::TypeId;
use std::borrow::Cow;

/// How a node sees what arrives at a port.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Access {
    /// One item at a time; the engine iterates.
    Item,
    /// One branch at a time.
    List,
    /// Everything at once.
    Tree,
}

/// What a number measures. Inside everything is mm and radians except [`Unit::Angle`], which is degrees at this surface for people.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub enum Unit {
    /// No unit.
    #[default]
    None,
    /// mm
    Length,
    /// degrees
    Angle,
    /// mm²
    Area,
    /// mm³
    Volume,
    /// mm/min
    Feed,
    /// rev/min
    Speed,
    /// 1
    Ratio,
    /// pieces
    Count,
}

impl Unit {
    /// The unit's sign; empty where there is none.
    #[must_use]
    pub fn symbol(self) -> &'static str {
        match self {
            Self::None | Self::Ratio | Self::Count => "",
            Self::Length => "mm",
            Self::Angle => "deg",
            Self::Area => "mm2",
            Self::Volume => "mm3",
            Self::Feed => "mm/min",
            Self::Speed => "rev/min",
        }
    }

    /// What it measures.
    pub(crate) fn dimension(self) -> Dimension {
        match self {
            Self::None | Self::Ratio | Self::Count => Dimension::default(),
            Self::Length => Dimension::length(1),
            Self::Angle => Dimension::ANGLE,
            Self::Area => Dimension::length(2),
            Self::Volume => Dimension::length(3),
            Self::Feed => Dimension::FEED,
            Self::Speed => Dimension::SPEED,
        }
    }
}

/// What a name in a formula stands for, or why it stands for nothing.
pub(crate) type Names<'a> = &'a dyn Fn(&str) -> Result<Quantity, String>;

/// A column, or which item is wrong and why.
type Parsed = Result<Column, (usize, String)>;

/// The type of the items at a port.
#[derive(Clone, Copy)]
pub(crate) struct ItemType {
    pub name: &'static str,
    /// `None`: any type.
    pub id: Option<TypeId>,
    parse: fn(&[Option<Json>]) -> Parsed,
    pub empty: fn() -> Column,
}

impl ItemType {
    pub fn of<T: Item>() -> Self {
        Self {
            name: T::TYPE,
            id: Some(TypeId::of::<T>()),
            parse: parse_items::<T>,
            empty: || Column::new::<T>(Vec::new()),
        }
    }

    pub fn any() -> Self {
        Self { name: "any", id: None, parse: parse_any, empty: || Column::new::<f64>(Vec::new()) }
    }

    pub fn accepts(&self, other: &Self) -> bool {
        self.id.is_none() || other.id.is_none() || self.id == other.id
    }
}

fn parse_items<T: Item>(items: &[Option<Json>]) -> Parsed {
    let parsed: Result<Vec<Option<T>>, _> =
        items.iter().enumerate().map(|(i, j)| j.as_ref().map(T::from_json).transpose().map_err(|e| (i, e))).collect();
    parsed.map(Column::with_gaps)
}

fn parse_any(items: &[Option<Json>]) -> Parsed {
    match items.iter().flatten().next() {
        Some(Json::String(_)) => parse_items::<Text>(items),
        Some(Json::Bool(_)) => parse_items::<bool>(items),
        Some(Json::Number(n)) if n.is_i64() && items.iter().flatten().all(Json::is_i64) => parse_items::<i64>(items),
        None | Some(Json::Number(_)) => parse_items::<f64>(items),
        Some(other) => Err((0, format!("cannot tell the type of {}", kind_of(other)))),
    }
}

/// Description of one input or output of a node type.
#[derive(Clone)]
pub struct Port {
    pub(crate) name: Cow<'static, str>,
    pub(crate) item_type: ItemType,
    pub(crate) access: Access,
    pub(crate) unit: Unit,
    pub(crate) range: Option<(f64, f64)>,
    pub(crate) default: Option<Json>,
    pub(crate) choices: Vec<Cow<'static, str>>,
    pub(crate) optional: bool,
    pub(crate) file: bool,
    pub(crate) doc: Cow<'static, str>,
}

impl Port {
    pub(crate) fn new(name: impl Into<Cow<'static, str>>, item_type: ItemType, access: Access) -> Self {
        Self {
            name: name.into(),
            item_type,
            access,
            unit: Unit::None,
            range: None,
            default: None,
            choices: Vec::new(),
            optional: false,
            file: false,
            doc: Cow::Borrowed(""),
        }
    }

    /// A port that sees one item at a time.
    #[must_use]
    pub fn item<T: Item>(name: impl Into<Cow<'static, str>>) -> Self {
        Self::new(name, ItemType::of::<T>(), Access::Item)
    }

    /// A port that sees one branch at a time; many wires append in the order of `from`.
    #[must_use]
    pub fn list<T: Item>(name: impl Into<Cow<'static, str>>) -> Self {
        Self::new(name, ItemType::of::<T>(), Access::List)
    }

    /// A port that sees the whole tree.
    #[must_use]
    pub fn tree<T: Item>(name: impl Into<Cow<'static, str>>) -> Self {
        Self::new(name, ItemType::of::<T>(), Access::Tree)
    }

    /// A port that takes or gives items of any type, for plumbing (pick, merge, view).
    #[must_use]
    pub fn any(name: impl Into<Cow<'static, str>>, access: Access) -> Self {
        Self::new(name, ItemType::any(), access)
    }

    /// What the port means.
    #[must_use]
    pub fn doc(mut self, doc: impl Into<Cow<'static, str>>) -> Self {
        self.doc = doc.into();
        self
    }

    /// What its numbers measure.
    #[must_use]
    pub fn unit(mut self, unit: Unit) -> Self {
        self.unit = unit;
        self
    }

    /// Smallest and largest number accepted, both included.
    #[must_use]
    pub fn range(mut self, min: f64, max: f64) -> Self {
        self.range = Some((min, max));
        self
    }

    /// The literal used without wire and parameter.
    #[must_use]
    pub fn default(mut self, default: impl Into<Json>) -> Self {
        self.default = Some(default.into());
        self
    }

    /// The texts accepted.
    #[must_use]
    pub fn choices<S: Into<Cow<'static, str>> + Clone>(mut self, choices: &[S]) -> Self {
        self.choices = choices.iter().cloned().map(Into::into).collect();
        self
    }

    /// The node runs without it.
    #[must_use]
    pub fn optional(mut self) -> Self {
        self.optional = true;
        self
    }

    /// The text is a path; the engine reads the file through the host and its content's digest counts as input.
    #[must_use]
    pub fn file(mut self) -> Self {
        self.file = true;
        self
    }

    /// Its name.
    #[must_use]
    pub fn name(&self) -> &str {
        &self.name
    }

    /// Name of its item type, `"any"` for any.
    #[must_use]
    pub fn type_name(&self) -> &'static str {
        self.item_type.name
    }

    /// How the node sees it.
    #[must_use]
    pub fn access(&self) -> Access {
        self.access
    }

    /// The port as documented JSON.
    #[must_use]
    pub fn describe(&self) -> Json {
        let mut o = serde_json::Map::new();
        o.insert("name".into(), Json::from(&*self.name));
        o.insert("type".into(), Json::from(self.item_type.name));
        let access = match self.access {
            Access::Item => "item",
            Access::List => "list",
            Access::Tree => "tree",
        };
        o.insert("access".into(), access.into());
        if !self.unit.symbol().is_empty() {
            o.insert("unit".into(), self.unit.symbol().into());
        }
        if let Some((min, max)) = self.range {
            o.insert("min".into(), min.to_json());
            o.insert("max".into(), max.to_json());
        }
        if let Some(default) = &self.default {
            o.insert("default".into(), default.clone());
        }
        if !self.choices.is_empty() {
            o.insert("choices".into(), self.choices.iter().map(|c| Json::from(&**c)).collect());
        }
        if self.optional {
            o.insert("optional".into(), true.into());
        }
        if self.file {
            o.insert("file".into(), true.into());
        }
        o.insert("doc".into(), Json::from(&*self.doc));
        Json::Object(o)
    }

    /// The tree that a literal stands for where no names are known, see [`Port::literal_with`].
    pub(crate) fn literal(&self, json: &Json) -> Result<Tree, Fail> {
        self.literal_with(json, &|name| Err(format!("expected a number, found \"{name}\"")))
    }

    /// The tree that a literal stands for, checked: numbers may carry a unit (`"12 mm"`, `{"value": 12, "unit": "mm"}`) and be
    /// formulas over names (`"thickness * 2"`), a JSON list is a list of items unless the type itself is written as a
    /// list, `null` in it is a gap.
    pub(crate) fn literal_with(&self, json: &Json, names: Names) -> Result<Tree, Fail> {
        let fail = |m: String| Fail::new("bad-literal", m).port(self.name.to_string());
        let column = match json {
            Json::Null => {
                return Err(fail(format!("null is no {}; leave the parameter out instead", self.item_type.name)));
            }
            Json::Array(items) => {
                let whole =
                    if self.access == Access::Item { self.parse(&[Some(json.clone())], names).ok() } else { None };
                match whole {
                    Some(column) => column,
                    None => {
                        let items: Vec<Option<Json>> =
                            items.iter().map(|j| (!j.is_null()).then(|| j.clone())).collect();
                        match self.parse(&items, names) {
                            Ok(column) => column,
                            // A list port given one item whose own form is a list, such as a point.
                            Err((i, why)) => match self.parse(&[Some(json.clone())], names) {
                                Ok(column) => column,
                                Err((_, alone)) if items.is_empty() => return Err(fail(alone)),
                                Err(_) => return Err(fail(why).item(i)),
                            },
                        }
                    }
                }
            }
            one => self.parse(&[Some(one.clone())], names).map_err(|(_, why)| fail(why))?,
        };
        if self.access == Access::Item && column.is_empty() {
            return Err(fail(format!("an empty list is no {}", self.item_type.name)));
        }
        if let Some(fail) = self.check(&column).told.into_iter().next() {
            return Err(fail);
        }
        Ok(Tree::column(column))
    }

    pub(crate) fn is_numeric(&self) -> bool {
        self.item_type.id == Some(TypeId::of::<f64>()) || self.item_type.id == Some(TypeId::of::<i64>())
    }

    /// The names that a literal's formulas use; none if it is no formula, or none that can be read.
    pub(crate) fn names_in(&self, json: &Json) -> Vec<String> {
        let items = match json {
            Json::Array(items) => items.as_slice(),
            one => std::slice::from_ref(one),
        };
        let texts = items.iter().filter(|_| self.is_numeric()).filter_map(Json::as_str);
        let formulas = texts.filter_map(|text| Expression::parse(text).ok());
        let mut names: Vec<String> = formulas.flat_map(|formula| formula.names().to_vec()).collect();
        names.sort_unstable();
        names.dedup();
        names
    }

    fn parse(&self, items: &[Option<Json>], names: Names) -> Parsed {
        if self.is_numeric() && items.iter().flatten().any(|j| !j.is_number()) {
            let converted: Result<Vec<Option<Json>>, _> = items
                .iter()
                .enumerate()
                .map(|(i, j)| j.as_ref().map(|j| self.evaluate(j, names)).transpose().map_err(|e| (i, e)))
                .collect();
            return (self.item_type.parse)(&converted?);
        }
        (self.item_type.parse)(items)
    }

    /// A number with a unit or a formula as a number of this port's unit; a number without a unit is taken to be in it.
    fn evaluate(&self, json: &Json, names: Names) -> Result<Json, String> {
        let quantity = match json {
            Json::String(text) => {
                let found = Expression::parse(text).and_then(|formula| formula.evaluate(names));
                found.map_err(|e| format!("\"{}\", {e}", shortened(text)))?
            }
            Json::Object(o) => match (o.get("value").and_then(Json::as_f64), o.get("unit").and_then(Json::as_str)) {
                (Some(value), Some("")) if o.len() == 2 => Quantity::plain(value),
                (Some(value), Some(sign)) if o.len() == 2 => {
                    let unit = Quantity::unit(sign).ok_or_else(|| match self.unit.symbol() {
                        "" => format!("\"{sign}\" is no unit that is known here"),
                        own => format!("\"{sign}\" cannot be turned into {own}"),
                    })?;
                    Quantity { value: value * unit.value, ..unit }
                }
                _ => return Err("expected a number or {\"value\": number, \"unit\": unit}".into()),
            },
            other => return Ok(other.clone()),
        };
        let (found, wanted) = (quantity.dimension, self.unit.dimension());
        if !found.is_plain() && found != wanted {
            return Err(format!("{json} is in {found}, but {} takes {wanted}", self.name));
        }
        Ok(Json::from(quantity.value))
    }

    /// True if [`Port::check`] can find anything at all.
    pub(crate) fn is_checked(&self) -> bool {
        self.item_type.id == Some(TypeId::of::<f64>()) || self.range.is_some() || !self.choices.is_empty()
    }

    /// The least and the greatest number that it accepts, if it takes numbers one at a time.
    pub(crate) fn number_bounds(&self) -> Option<(f64, f64)> {
        let numbers = self.access == Access::Item && self.item_type.id == Some(TypeId::of::<f64>());
        (numbers && self.choices.is_empty()).then(|| self.range.unwrap_or((f64::MIN, f64::MAX)))
    }

    /// True if [`Port::check`] finds nothing.
    pub(crate) fn accepts_all(&self, column: &Column) -> bool {
        match column.slice::<f64>() {
            Some(&[v]) if self.range.is_none() && !column.has_gaps() => v.is_finite(),
            _ => self.check(column).places.is_empty(),
        }
    }

    /// Items that the port does not accept: not finite, out of range, not among the choices. O(n).
    pub(crate) fn check(&self, column: &Column) -> Bad {
        let mut bad = Bad::default();
        if let Some(numbers) = column.slice::<f64>() {
            let (min, max) = self.range.unwrap_or((f64::MIN, f64::MAX));
            for (i, v) in numbers.iter().stoppable().enumerate() {
                // NaN fails this comparison too.
                if !(*v >= min && *v <= max) && column.is_valid(i) {
                    let why = || if v.is_finite() { self.out_of_range(*v, min, max) } else { self.not_finite(*v) };
                    bad.push(i, why);
                }
            }
        } else if let (Some(numbers), Some((min, max))) = (column.slice::<i64>(), self.range) {
            for (i, v) in numbers.iter().stoppable().enumerate() {
                if !(*v as f64 >= min && *v as f64 <= max) && column.is_valid(i) {
                    bad.push(i, || self.out_of_range(*v as f64, min, max));
                }
            }
        } else if let (Some(texts), false) = (column.slice::<Text>(), self.choices.is_empty()) {
            for (i, v) in texts.iter().stoppable().enumerate() {
                if column.is_valid(i) && !self.choices.iter().any(|c| **c == *v.0) {
                    bad.push(i, || {
                        let message = format!("\"{v}\" is not one of {}", self.choices.join(", "));
                        let hint = did_you_mean(&v.0, self.choices.iter().map(|c| &**c));
                        let fail = Fail::new("not-a-choice", message).port(self.name.to_string());
                        hint.into_iter().fold(fail, Fail::hint)
                    });
                }
            }
        }
        bad
    }

    fn not_finite(&self, v: f64) -> Fail {
        Fail::new("not-finite", format!("{v} is not a finite number")).port(self.name.to_string())
    }

    fn out_of_range(&self, v: f64, min: f64, max: f64) -> Fail {
        let unit = self.unit.symbol();
        let space = if unit.is_empty() { "" } else { " " };
        Fail::new("out-of-range", format!("{v}{space}{unit} is outside {min} to {max}{space}{unit}"))
            .port(self.name.to_string())
            .hint(format!("the nearest that works is {}", v.clamp(min, max)))
    }
}

/// A text as one quotes it: its start, if it is long.
fn shortened(text: &str) -> Cow<'_, str> {
    match text.char_indices().nth(80) {
        Some((end, _)) => format!("{} ...", &text[..end]).into(),
        None => text.into(),
    }
}

/// Items that a port does not accept.
#[derive(Default)]
pub(crate) struct Bad {
    /// Where they are.
    pub places: Vec<usize>,
    /// Why, of the first of them: nobody reads millions.
    pub told: Vec<Fail>,
}

impl Bad {
    /// So many are told.
    const MOST: usize = 10_000;

    fn push(&mut self, place: usize, why: impl FnOnce() -> Fail) {
        self.places.push(place);
        if self.told.len() < Self::MOST {
            self.told.push(why());
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    fn number() -> Port {
        Port::item::<f64>("t").unit(Unit::Length).range(0.0, 100.0)
    }

    fn literal(port: &Port, json: Json) -> Result<Json, String> {
        port.literal(&json).map(|t| t.to_json()["branches"]["{0}"].clone()).map_err(|e| e.to_string())
    }

    #[test]
    fn literals_carry_units_and_lists() {
        assert_eq!(literal(&number(), json!("1.2 cm")), Ok(json!([12.0])));
        assert_eq!(literal(&number(), json!({"value": 2, "unit": "in"})), Ok(json!([50.8])));
        assert_eq!(literal(&number(), json!([1, null, "3 mm"])), Ok(json!([1.0, null, 3.0])));
        assert_eq!(literal(&Port::item::<f64>("a").unit(Unit::Angle), json!("0 rad")), Ok(json!([0.0])));
        assert_eq!(literal(&Port::list::<i64>("a"), json!([])), Ok(json!([])));
        assert!(literal(&number(), json!("1 kg")).is_err_and(|e| e.contains("mm")));
        assert!(literal(&number(), json!("wide")).is_err());
        assert!(literal(&number(), json!([])).is_err());
        assert!(literal(&Port::item::<i64>("n"), json!(1.5)).is_err());
    }

    #[test]
    fn range_and_choices_say_what_would_work() {
        let e = number().literal(&json!(120)).map_err(|e| e.at(crate::Severity::Error, "n").to_string());
        assert_eq!(
            e.err().as_deref(),
            Some("error[out-of-range] n.t: 120 mm is outside 0 to 100 mm (the nearest that works is 100)")
        );
        let border = Port::item::<Text>("border").choices(&["square", "plane"]);
        assert!(literal(&border, json!("sqare")).is_err_and(|e| e.contains("square, plane")));
        assert!(number().check(&Column::new(vec![f64::NAN, 1.0, f64::INFINITY])).places == [0, 2]);
    }
}
