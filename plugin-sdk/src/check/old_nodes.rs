//! What a plugin makes of nodes of its older versions, and of what is none.

use crate::load::PluginNode;

/// What is wrong with what came of an old node.
fn bad_node(node: &PluginNode, came: &Result<String, String>) -> Option<String> {
    match came {
        Ok(text) => match serde_json::from_str::<serde_json::Value>(text) {
            Ok(json) if json["type"] == node.id.as_str() => None,
            Ok(json) => Some(format!("what comes is no node of its type: {json}")),
            Err(why) => Some(format!("what comes is no JSON: {why}")),
        },
        Err(why) if why.trim().is_empty() => Some("it fails without a word".into()),
        Err(_) => None,
    }
}

pub(super) fn old_nodes(node: &PluginNode) -> Option<String> {
    (node.migrate_from..node.version).find_map(|from| {
        let text = serde_json::json!({ "type": node.id, "v": from }).to_string();
        let came = node.migrate(from, &text);
        let again = if node.migrate(from, &text) == came { None } else { Some("it gives another text".to_owned()) };
        bad_node(node, &came).or(again).map(|why| format!("from version {from}: {why}"))
    })
}

pub(super) fn strange_nodes(node: &PluginNode) -> Option<String> {
    let long = format!("{{\"type\":\"{}\",\"note\":\"{}\"}}", node.id, "x".repeat(1 << 20));
    let texts = ["", "{", "[]", "null", "{\"params\":7}", "{\"type\":\"\u{1f332}\"}", &long];
    (node.migrate_from..node.version).find_map(|from| {
        texts.iter().find_map(|text| match node.migrate(from, text) {
            // Garbage may come of garbage: the host sees that it is no node.
            Ok(_) => None,
            Err(why) => why.trim().is_empty().then(|| format!("from version {from}: it fails without a word")),
        })
    })
}
