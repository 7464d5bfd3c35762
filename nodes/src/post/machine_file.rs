//! Machine files: JSON to geometry and words, with errors that name the key and say what would work.

use super::Words;
use serde::de::DeserializeOwned;
use serde::{Deserialize, Serialize};
use serde_json::{Map, Value};
use tenon_geometry::machine::Machine;

/// A machine with its dialect: all that a machine file says.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct MachineFile {
    /// Geometry: axes, limits, table, tools.
    #[serde(flatten)]
    pub machine: Machine,
    /// Words.
    pub words: Words,
}

/// What is wrong with a machine file.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum MachineFileError {
    /// Not JSON.
    #[error("the machine file is not JSON: {problem}")]
    NotJson {
        /// What the reader met, with line and column.
        problem: String,
    },
    /// A key is missing, unknown or has a value that cannot be.
    #[error("machine file, {at}: {problem}")]
    Key {
        /// Path of the key, such as `tools[2].kind`.
        at: String,
        /// What is wrong and what would work.
        problem: String,
    },
    /// No built-in machine has this name.
    #[error("there is no built-in machine \"{name}\"; there are {}", known.join(", "))]
    UnknownPreset {
        /// The name asked for.
        name: String,
        /// Names that there are.
        known: Vec<&'static str>,
    },
}

/// Built-in machines: name and file.
const PRESETS: [(&str, &str); 2] = [
    ("maka-mm7s", include_str!("../../machines/maka-mm7s.json")),
    ("linuxcnc-xyzbc", include_str!("../../machines/linuxcnc-xyzbc.json")),
];

const KEYS: [&str; 12] = [
    "name",
    "linear",
    "primary",
    "secondary",
    "tip_control",
    "pivot",
    "safe_height",
    "headroom",
    "table",
    "clamps",
    "spindle",
    "tools",
];

fn key(at: impl Into<String>, problem: impl Into<String>) -> MachineFileError {
    MachineFileError::Key { at: at.into(), problem: problem.into() }
}

/// Names of the built-in machines.
pub fn machine_presets() -> impl Iterator<Item = &'static str> {
    PRESETS.iter().map(|(name, _)| *name)
}

/// A built-in machine by name; "maka-mm7s" is the machine of 000 §7.3.1.
///
/// # Errors
/// An unknown name, with those that there are.
pub fn machine_preset(name: &str) -> Result<MachineFile, MachineFileError> {
    match PRESETS.iter().find(|(n, _)| *n == name) {
        Some((_, text)) => read_machine(text.as_bytes()),
        None => Err(MachineFileError::UnknownPreset { name: name.to_owned(), known: machine_presets().collect() }),
    }
}

/// Reads a machine file. O(bytes).
///
/// # Errors
/// Not JSON (line, column); a key missing, unknown or with a value that cannot be (names its path, and what would work).
pub fn read_machine(bytes: &[u8]) -> Result<MachineFile, MachineFileError> {
    let value: Value =
        serde_json::from_slice(bytes).map_err(|e| MachineFileError::NotJson { problem: e.to_string() })?;
    let Value::Object(map) = value else {
        return Err(key("the whole file", format!("must be an object with the keys {}, words", KEYS.join(", "))));
    };
    if let Some(unknown) = map.keys().find(|k| !KEYS.contains(&k.as_str()) && *k != "words" && *k != "doc") {
        let problem = format!("unknown key; known are {}, words, doc", KEYS.join(", "));
        return Err(key(unknown, problem));
    }
    let machine = Machine {
        name: field(&map, "name", "")?,
        linear: array(list(&map, "linear", "")?)?,
        primary: field(&map, "primary", "")?,
        secondary: field(&map, "secondary", "")?,
        tip_control: field(&map, "tip_control", "")?,
        pivot: field(&map, "pivot", "")?,
        safe_height: field(&map, "safe_height", "")?,
        headroom: field(&map, "headroom", "")?,
        table: field(&map, "table", "")?,
        clamps: list(&map, "clamps", "")?,
        spindle: list(&map, "spindle", "")?,
        tools: list(&map, "tools", "")?,
    };
    machine.check().map_err(|e| key(e.at, e.problem))?;
    let words: Words = field(&map, "words", "")?;
    words.check().map_err(|(at, problem)| key(format!("words.{at}"), problem))?;
    Ok(MachineFile { machine, words })
}

fn array<T>(axes: Vec<T>) -> Result<[T; 3], MachineFileError> {
    let count = axes.len();
    axes.try_into().map_err(|_| key("linear", format!("must list the axes X, Y, Z; it lists {count}")))
}

fn get<'a>(map: &'a Map<String, Value>, name: &str, at: &str) -> Result<&'a Value, MachineFileError> {
    map.get(name).ok_or_else(|| key(format!("{at}{name}"), "is missing"))
}

fn list<T: DeserializeOwned + Serialize>(
    map: &Map<String, Value>,
    name: &str,
    at: &str,
) -> Result<Vec<T>, MachineFileError> {
    let Value::Array(items) = get(map, name, at)? else {
        return Err(key(format!("{at}{name}"), "must be a list"));
    };
    items.iter().enumerate().map(|(k, v)| typed(v, &format!("{at}{name}[{k}]"))).collect()
}

fn field<T: DeserializeOwned + Serialize>(
    map: &Map<String, Value>,
    name: &str,
    at: &str,
) -> Result<T, MachineFileError> {
    typed(get(map, name, at)?, &format!("{at}{name}"))
}

/// One value of the file as its type. A key that the type does not know would be lost on writing it back: that is how
/// unknown keys are found at any depth, without a second list of names.
fn typed<T: DeserializeOwned + Serialize>(value: &Value, at: &str) -> Result<T, MachineFileError> {
    let read: T = serde_json::from_value(value.clone()).map_err(|e| key(at, e.to_string()))?;
    let written = serde_json::to_value(&read).map_err(|e| key(at, e.to_string()))?;
    same_keys(value, &written, at)?;
    Ok(read)
}

/// Depth is bounded by the JSON reader's own limit (128).
fn same_keys(given: &Value, known: &Value, at: &str) -> Result<(), MachineFileError> {
    match (given, known) {
        (Value::Object(given), Value::Object(known)) => {
            for (name, value) in given {
                let Some(other) = known.get(name) else {
                    let names: Vec<&str> = known.keys().map(String::as_str).collect();
                    return Err(key(format!("{at}.{name}"), format!("unknown key; known are {}", names.join(", "))));
                };
                same_keys(value, other, &format!("{at}.{name}"))?;
            }
            Ok(())
        }
        (Value::Array(given), Value::Array(known)) => {
            given.iter().zip(known).enumerate().try_for_each(|(k, (g, n))| same_keys(g, n, &format!("{at}[{k}]")))
        }
        _ => Ok(()),
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn maka() -> Value {
        serde_json::from_str(PRESETS[0].1).unwrap()
    }

    fn refused(change: impl FnOnce(&mut Value)) -> String {
        let mut file = maka();
        change(&mut file);
        read_machine(file.to_string().as_bytes()).unwrap_err().to_string()
    }

    #[test]
    fn every_preset_reads_and_reaches_45_degrees_over_a_board() {
        for name in machine_presets() {
            let file = machine_preset(name).unwrap();
            assert_eq!(file.machine.table.sacrificial, 19.0);
            for tool in &file.machine.tools {
                let body = file.machine.body(tool);
                for r in body.holder.iter().chain(&body.spindle) {
                    let (s, c) = 45f64.to_radians().sin_cos();
                    for (h, radius) in [(r.from, r.radius_from), (r.to, r.radius_to)] {
                        assert!(h * c - radius * s > 21.0, "{name} T{} at {h} mm", tool.number);
                    }
                }
            }
        }
        assert!(machine_preset("maka").unwrap_err().to_string().contains("maka-mm7s"));
    }

    #[test]
    fn a_wrong_key_is_named_with_what_would_work() {
        let missing = refused(|v| {
            v["primary"].as_object_mut().unwrap().remove("about");
        });
        assert!(missing.contains("primary") && missing.contains("`about`"), "{missing}");
        let unknown = refused(|v| v["tools"][2]["feeds"]["cutt"] = 3.into());
        assert!(unknown.contains("tools[2].feeds.cutt") && unknown.contains("known are"), "{unknown}");
        let top = refused(|v| v["spinlde"] = 3.into());
        assert!(top.contains("spinlde") && top.contains("spindle"), "{top}");
        let kind = refused(|v| v["tools"][0]["kind"] = "saw".into());
        assert!(kind.contains("tools[0]") && kind.contains("end_mill"), "{kind}");
        let words = refused(|v| v["words"]["tool_change"] = serde_json::json!(["M6"]));
        assert!(words.contains("words.tool_change") && words.contains("{tool}"), "{words}");
        let sense = refused(|v| v["secondary"]["sign"] = 2.into());
        assert!(sense.contains("secondary.sign"), "{sense}");
        assert!(read_machine(b"{\"name\": ").unwrap_err().to_string().contains("line 1"));
        assert!(read_machine(b"[]").unwrap_err().to_string().contains("primary"));
        let deep = "[".repeat(100_000);
        assert!(matches!(read_machine(deep.as_bytes()), Err(MachineFileError::NotJson { .. })));
    }
}
