//! JSON documents that people can read and compare: a head on the first line, then lists with one record a line.

use super::blocks::Blocks;
use serde::Serialize;

/// A value as one line. No record of this folder can fail: their keys are strings.
pub(super) fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// The head's object with a list added: `{ head, "key": [ one line each ] }`. Lines are written as they come, so that who
/// makes them can stop.
pub(super) fn document(head: &impl Serialize, key: &str, lines: impl Iterator<Item = String>) -> Vec<u8> {
    let head = json(head);
    let mut out = Blocks::default();
    out.push_str(head.strip_suffix('}').unwrap_or(&head));
    out.push_str(",\"");
    out.push_str(key);
    out.push_str("\":[\n");
    for (i, line) in lines.enumerate() {
        out.push_str(if i > 0 { ",\n" } else { "" });
        out.push_str(&line);
    }
    out.push_str("\n]");
    out.push_str("}\n");
    out.into_bytes()
}
