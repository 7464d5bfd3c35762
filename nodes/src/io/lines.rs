//! JSON documents that people can read and compare: a head on the first line, then lists with one record a line.

use serde::Serialize;

/// A value as one line. No record of this folder can fail: their keys are strings.
pub(super) fn json(value: &impl Serialize) -> String {
    serde_json::to_string(value).unwrap_or_default()
}

/// The head's object with lists added: `{ head, "key": [ one line each ], … }`.
pub(super) fn document<const N: usize>(head: &impl Serialize, lists: [(&str, Vec<String>); N]) -> Vec<u8> {
    let head = json(head);
    let mut out = head.strip_suffix('}').unwrap_or(&head).to_owned();
    for (key, lines) in lists {
        out.push_str(",\"");
        out.push_str(key);
        out.push_str("\":[\n");
        out.push_str(&lines.join(",\n"));
        out.push_str("\n]");
    }
    out.push_str("}\n");
    out.into_bytes()
}
