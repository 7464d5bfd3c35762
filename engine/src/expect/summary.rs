//! Values condensed to what a person can read and a later run can be compared with, and that comparison.

use crate::value::{Json, Tree};
use serde_json::{Map, json};
use std::collections::BTreeMap;

/// Longer lists are told by their count and what their items come to.
const SHORT: usize = 16;
/// Longest item whose places are told one by one: points and quaternions.
const TUPLE: usize = 4;
/// A list with more different texts than this is told by how many there are.
const KINDS: usize = 8;
/// No more differences of one value are told than this.
const MOST_FAILURES: usize = 20;

/// How far a number may be from what is expected: `abs`, or `rel` times the expected number, whichever is more.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Tolerance {
    /// In the unit of the number.
    pub abs: f64,
    /// As a fraction of the expected number.
    pub rel: f64,
}

impl Default for Tolerance {
    fn default() -> Self {
        Self { abs: 1e-6, rel: 1e-6 }
    }
}

impl Tolerance {
    fn accepts(self, expected: f64, found: f64) -> bool {
        (expected - found).abs() <= self.abs.max(self.rel * expected.abs())
    }
}

/// A tree as an expectation holds it: `type`, `items`, `branches` if not one, `gaps` if any, `digest` if `exact`, and
/// `value`: the only item, else the condensed lists of all branches one after another. O(size of the tree's JSON).
pub(super) fn summary(tree: &Tree, exact: bool) -> Map<String, Json> {
    let mut all = Vec::with_capacity(tree.len());
    for (_, column) in tree.branches() {
        if let Json::Array(items) = column.to_json() {
            all.extend(items);
        }
    }
    let mut out = Map::new();
    out.insert("type".into(), tree.type_name().into());
    out.insert("items".into(), all.len().into());
    if tree.branches().len() != 1 {
        out.insert("branches".into(), tree.branches().len().into());
    }
    let gaps = all.iter().filter(|i| i.is_null()).count();
    if gaps > 0 {
        out.insert("gaps".into(), gaps.into());
    }
    if exact {
        out.insert("digest".into(), format!("{:032x}", tree.digest()).into());
    } else if tree.type_name() == "file" {
        // Bytes that may differ in the last digit of a number must not be compared by digest.
        all.iter_mut().filter_map(Json::as_object_mut).for_each(|file| drop(file.remove("digest")));
    }
    let value = match <[Json; 1]>::try_from(all) {
        Ok([one]) => condense(one),
        Err(many) => condense(Json::Array(many)),
    };
    out.insert("value".into(), value);
    out
}

/// Long lists become `{"count"}` with: of numbers `min`, `max`, `mean`; of texts and booleans how many of each kind
/// (or how many kinds); of points and objects `each`, place by place; of lists `all`, their items in one list.
/// Recursion is as deep as the value's own JSON.
fn condense(json: Json) -> Json {
    match json {
        Json::Array(items) if items.len() > SHORT => long(items),
        Json::Array(items) => items.into_iter().map(condense).collect(),
        Json::Object(map) => map.into_iter().map(|(key, v)| (key, condense(v))).collect(),
        plain => plain,
    }
}

fn long(items: Vec<Json>) -> Json {
    let count = items.len();
    let items: Vec<Json> = items.into_iter().filter(|i| !i.is_null()).collect();
    let width = items.first().and_then(Json::as_array).map(Vec::len);
    if let Some(numbers) = items.iter().map(Json::as_f64).collect::<Option<Vec<f64>>>().filter(|n| !n.is_empty()) {
        let (min, max) = numbers.iter().fold((f64::MAX, f64::MIN), |(a, b), v| (a.min(*v), b.max(*v)));
        let mean = numbers.iter().sum::<f64>() / numbers.len() as f64;
        return json!({ "count": count, "min": min, "max": max, "mean": mean });
    }
    if items.iter().all(Json::is_object) {
        let mut places: BTreeMap<String, Vec<Json>> = BTreeMap::new();
        for item in items {
            if let Json::Object(map) = item {
                map.into_iter().for_each(|(key, v)| places.entry(key).or_default().push(v));
            }
        }
        let each: Map<String, Json> =
            places.into_iter().map(|(key, list)| (key, condense(Json::Array(list)))).collect();
        return json!({ "count": count, "each": each });
    }
    if items.iter().all(Json::is_array) {
        let lists = items.into_iter().filter_map(|i| if let Json::Array(list) = i { Some(list) } else { None });
        if let Some(width) = width.filter(|w| (1..=TUPLE).contains(w)) {
            let mut places = vec![Vec::with_capacity(count); width];
            let mut rest = Vec::new();
            for list in lists {
                if list.len() == width {
                    places.iter_mut().zip(list).for_each(|(place, v)| place.push(v));
                } else {
                    rest.extend(list);
                }
            }
            if rest.is_empty() {
                let each: Vec<Json> = places.into_iter().map(|list| condense(Json::Array(list))).collect();
                return json!({ "count": count, "each": each });
            }
            let all = places.into_iter().flatten().chain(rest).collect();
            return json!({ "count": count, "all": condense(Json::Array(all)) });
        }
        return json!({ "count": count, "all": condense(Json::Array(lists.flatten().collect())) });
    }
    let mut kinds: BTreeMap<String, usize> = BTreeMap::new();
    for item in &items {
        let name = item.as_str().map_or_else(|| item.to_string(), str::to_owned);
        *kinds.entry(name).or_default() += 1;
    }
    match kinds.len() {
        ..=KINDS => json!({ "count": count, "kinds": kinds }),
        many => json!({ "count": count, "kinds": many }),
    }
}

/// Where `found` is not what is `expected`, one sentence each. Whole numbers must be equal, others within the
/// tolerance; members of an object that `expected` does not name may be anything.
pub(super) fn differences(expected: &Json, found: &Json, tolerance: Tolerance) -> Vec<String> {
    let mut failures = Vec::new();
    differ("", expected, found, tolerance, &mut failures);
    failures.truncate(MOST_FAILURES);
    failures
}

fn differ(at: &str, expected: &Json, found: &Json, tolerance: Tolerance, failures: &mut Vec<String>) {
    let below = |key: &str| if at.is_empty() { key.to_owned() } else { format!("{at}.{key}") };
    match (expected, found) {
        (Json::Object(e), Json::Object(f)) => {
            for (key, value) in e {
                differ(&below(key), value, f.get(key).unwrap_or(&Json::Null), tolerance, failures);
            }
        }
        (Json::Array(e), Json::Array(f)) if e.len() == f.len() => {
            for (i, (e, f)) in e.iter().zip(f).enumerate() {
                differ(&format!("{at}[{i}]"), e, f, tolerance, failures);
            }
        }
        _ => {
            let whole = expected.is_i64() && found.is_i64();
            let near = match (expected.as_f64(), found.as_f64()) {
                (Some(e), Some(f)) if !whole => Some((tolerance.accepts(e, f), (e - f).abs())),
                _ => None,
            };
            match near {
                Some((true, _)) => {}
                Some((false, off)) => {
                    failures.push(format!("{at}: expected {expected}, found {found}, off by {off:.3e}"));
                }
                None if expected == found => {}
                None => failures.push(format!("{at}: expected {}, found {}", short(expected), short(found))),
            }
        }
    }
}

fn short(json: &Json) -> String {
    match json {
        Json::Null => "nothing".into(),
        Json::Array(list) => format!("a list of {}", list.len()),
        Json::Object(_) => "an object".into(),
        plain => plain.to_string(),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn long_lists_are_told_by_what_they_come_to() {
        let numbers: Vec<f64> = (0..20).map(f64::from).collect();
        assert_eq!(condense(json!(numbers)), json!({ "count": 20, "min": 0.0, "max": 19.0, "mean": 9.5 }));
        let points: Vec<[f64; 2]> = (0..20).map(|i| [f64::from(i), 1.0]).collect();
        assert_eq!(condense(json!(points))["each"][1], json!({ "count": 20, "min": 1.0, "max": 1.0, "mean": 1.0 }));
        let objects: Vec<Json> = (0..20).map(|i| json!({ "pass": i < 15, "side": "top" })).collect();
        let each = &condense(json!(objects))["each"];
        assert_eq!(each["pass"]["kinds"], json!({ "false": 5, "true": 15 }));
        assert_eq!(each["side"]["kinds"], json!({ "top": 20 }));
        let ragged: Vec<Vec<usize>> = (0..20).map(|i| vec![i; i % 3]).collect();
        assert_eq!(condense(json!(ragged))["all"]["count"], 20 / 3 * 3 + 1);
    }

    #[test]
    fn numbers_differ_by_more_than_the_tolerance_only() {
        let t = Tolerance { abs: 0.1, rel: 0.01 };
        let differ = |e: Json, f: Json| differences(&e, &f, t).len();
        assert_eq!(differ(json!(1.0), json!(1.09)), 0);
        assert_eq!(differ(json!(1.0), json!(1.2)), 1);
        assert_eq!(differ(json!(1000.0), json!(1009.0)), 0, "relative");
        assert_eq!(differ(json!(3), json!(4)), 1, "whole numbers are exact");
        assert_eq!(differ(json!({ "a": 1 }), json!({ "a": 1, "b": 2 })), 0, "only what is named counts");
        assert_eq!(differ(json!({ "a": 1 }), json!({})), 1);
        assert_eq!(differ(json!([1, 2]), json!([1])), 1);
        assert_eq!(differ(json!("a"), json!("b")), 1);
    }
}
