//! `tenon explain`: what a diagnostic's code means and what helps.

use crate::End;
use crate::args::ExplainArgs;
use crate::words::{Wrong, print, print_json};
use tenon_engine::{Code, Json, nearest};

/// All codes: the engine's, the nodes', the command line's.
fn all() -> impl Iterator<Item = &'static Code> {
    tenon_engine::CODES.iter().chain(tenon_nodes::CODES).chain(crate::codes::CODES)
}

/// Explains one code, or lists them all.
pub fn explain(args: &ExplainArgs) -> Result<End, Wrong> {
    let json = |c: &Code| serde_json::json!({ "code": c.name, "means": c.means, "help": c.help });
    let Some(name) = &args.code else {
        let mut codes: Vec<&Code> = all().collect();
        codes.sort_by_key(|c| c.name);
        if args.json {
            print_json(&Json::Array(codes.into_iter().map(json).collect()))?;
        } else {
            let width = codes.iter().map(|c| c.name.len()).max().unwrap_or(0);
            print(&codes.iter().map(|c| format!("{:width$}  {}\n", c.name, c.means)).collect::<String>())?;
        }
        return Ok(End::Done);
    };
    // As it stands in a message: error[cycle].
    let plain = name.split_once('[').map_or(name.as_str(), |(_, rest)| rest).trim_end_matches(']');
    let Some(code) = all().find(|c| c.name == plain) else {
        let wrong = Wrong::new("unknown-code", format!("there is no diagnostic of the code \"{plain}\""));
        return Err(match nearest(plain, all().map(|c| c.name)) {
            Some(near) => wrong.hint(format!("did you mean \"{near}\"?")),
            None => wrong.hint("tenon explain lists them all"),
        });
    };
    if args.json {
        print_json(&json(code))?;
    } else {
        print(&format!("{}\n\n{}\n{}\n", code.name, code.means, code.help))?;
    }
    Ok(End::Done)
}
