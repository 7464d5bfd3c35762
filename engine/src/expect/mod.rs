//! Expectations: what a graph's outputs should come to, recorded once and checked at every later run.

mod summary;

pub use summary::Tolerance;

use crate::diagnostic::{Diagnostic, Severity};
use crate::evaluate::report::Report;
use crate::evaluate::session::Session;
use crate::value::Json;
use serde_json::{Map, json};
use std::collections::BTreeMap;

/// What is expected of one graph: the content of `NAME.expect.json`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Expectations {
    /// Inputs to set before the run, by the names that [`Session::set`] takes.
    pub set: BTreeMap<String, Json>,
    /// For outputs that have none of their own.
    pub tolerance: Tolerance,
    /// Errors and warnings by code; `None`: any.
    pub diagnostics: Option<BTreeMap<String, usize>>,
    /// By interface output or `node.port`: `type`, `items`, `branches`, `gaps`, `digest`, `value`, `tolerance`, each
    /// of which may be left out.
    pub outputs: BTreeMap<String, Map<String, Json>>,
}

/// Whether one expectation was met.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Outcome {
    /// The output, or `diagnostics`.
    pub name: String,
    /// One sentence each; none: it was met.
    pub failures: Vec<String>,
}

fn bad(what: impl std::fmt::Display) -> Diagnostic {
    Diagnostic::error("bad-expectations", what.to_string())
}

fn tolerance(json: &Json, or: Tolerance) -> Result<Tolerance, Diagnostic> {
    let number = |key: &str, or: f64| match &json[key] {
        Json::Null => Ok(or),
        v => v
            .as_f64()
            .filter(|v| *v >= 0.0)
            .ok_or_else(|| bad(format!("\"{key}\" of a tolerance is {v}, no number from 0"))),
    };
    Ok(Tolerance { abs: number("abs", or.abs)?, rel: number("rel", or.rel)? })
}

impl Expectations {
    /// Reads the file.
    ///
    /// # Errors
    /// Says what is wrong with its form.
    pub fn from_slice(bytes: &[u8]) -> Result<Self, Diagnostic> {
        let json: Json = serde_json::from_slice(bytes).map_err(bad)?;
        if json["format"] != "tenon-expectations" || json["version"] != 1 {
            return Err(bad(
                "this is no file of expectations: \"format\": \"tenon-expectations\", \"version\": 1 is missing",
            ));
        }
        let object = |key: &str| match &json[key] {
            Json::Null => Ok(None),
            Json::Object(map) => Ok(Some(map.clone())),
            _ => Err(bad(format!("\"{key}\" must be an object"))),
        };
        let mut outputs = BTreeMap::new();
        let default = tolerance(&json["tolerance"], Tolerance::default())?;
        for (name, output) in object("outputs")?.unwrap_or_default() {
            let Json::Object(output) = output else { return Err(bad(format!("\"{name}\" must be an object"))) };
            tolerance(output.get("tolerance").unwrap_or(&Json::Null), default)?;
            outputs.insert(name, output);
        }
        let count = |(code, n): (String, Json)| match n.as_u64() {
            Some(n) => Ok((code, n as usize)),
            None => Err(bad(format!("\"{code}\" must be how many there are, not {n}"))),
        };
        let diagnostics = object("diagnostics")?.map(|map| map.into_iter().map(count).collect()).transpose()?;
        let set = object("set")?.unwrap_or_default().into_iter().collect();
        Ok(Self { set, tolerance: default, diagnostics, outputs })
    }

    /// The file's content.
    #[must_use]
    pub fn to_json(&self) -> Json {
        let mut json = json!({
            "format": "tenon-expectations",
            "version": 1,
            "tolerance": { "abs": self.tolerance.abs, "rel": self.tolerance.rel },
        });
        if !self.set.is_empty() {
            json["set"] = json!(self.set);
        }
        if let Some(diagnostics) = &self.diagnostics {
            json["diagnostics"] = json!(diagnostics);
        }
        json["outputs"] = json!(self.outputs);
        json
    }

    /// What is to be evaluated: all interface outputs and whatever else is expected.
    #[must_use]
    pub fn targets(&self, session: &Session) -> Vec<String> {
        let mut targets: Vec<String> = session.document().outputs.keys().chain(self.outputs.keys()).cloned().collect();
        targets.retain(|name| session.knows(name).is_ok());
        targets.sort();
        targets.dedup();
        targets
    }

    /// These expectations with the values of this run. Tolerances, inputs and outputs that are `node.port`s stay;
    /// outputs get a digest if they had one, all of them if `exact`. Outputs without a value are left out.
    #[must_use]
    pub fn record(&self, session: &Session, report: &Report, exact: bool) -> Self {
        let mut outputs = BTreeMap::new();
        for name in self.targets(session) {
            let Some(tree) = session.value(&name) else { continue };
            let old = self.outputs.get(&name);
            let mut summary = summary::summary(&tree, exact || old.is_some_and(|o| o.contains_key("digest")));
            if let Some(own) = old.and_then(|o| o.get("tolerance")) {
                summary.insert("tolerance".into(), own.clone());
            }
            outputs.insert(name, summary);
        }
        Self { diagnostics: Some(counts(report)), outputs, ..self.clone() }
    }

    /// Compares a run with what is expected, one outcome per output and one for the diagnostics.
    #[must_use]
    pub fn check(&self, session: &Session, report: &Report) -> Vec<Outcome> {
        let mut outcomes = Vec::with_capacity(self.outputs.len() + 1);
        if let Some(expected) = &self.diagnostics {
            let found = counts(report);
            let failures =
                expected.keys().chain(found.keys().filter(|c| !expected.contains_key(*c))).filter_map(|code| {
                    let (e, f) = (expected.get(code).copied().unwrap_or(0), found.get(code).copied().unwrap_or(0));
                    (e != f).then(|| format!("{code}: expected {e}, found {f}"))
                });
            outcomes.push(Outcome { name: "diagnostics".into(), failures: failures.collect() });
        }
        for (name, expected) in &self.outputs {
            let failures = match (session.knows(name), session.value(name)) {
                (Err(unknown), _) => vec![unknown.message.to_string()],
                (Ok(()), None) => vec!["it has no value".to_owned()],
                (Ok(()), Some(tree)) => {
                    let own = expected.get("tolerance").unwrap_or(&Json::Null);
                    let allowed = tolerance(own, self.tolerance).unwrap_or(self.tolerance);
                    let mut expected = expected.clone();
                    expected.remove("tolerance");
                    let mut found = summary::summary(&tree, expected.contains_key("digest"));
                    // What a summary leaves out because it goes without saying.
                    for (key, value) in [("branches", 1), ("gaps", 0)] {
                        found.entry(key).or_insert_with(|| value.into());
                        expected.entry(key).or_insert_with(|| value.into());
                    }
                    summary::differences(&Json::Object(expected), &Json::Object(found), allowed)
                }
            };
            outcomes.push(Outcome { name: name.clone(), failures });
        }
        outcomes
    }
}

/// Errors and warnings by code.
fn counts(report: &Report) -> BTreeMap<String, usize> {
    let mut counts = BTreeMap::new();
    for d in report.diagnostics.iter().filter(|d| d.severity != Severity::Note) {
        *counts.entry(d.code.to_string()).or_default() += 1;
    }
    counts
}
