//! `tenon schema`: the JSON Schema of graph files, and of reports.

use crate::End;
use crate::args::SchemaArgs;
use crate::words::{Wrong, print, print_json};

/// What stands in a report; the engine makes a part of it and the program the rest.
const REPORT: &str = include_str!("../../docs/report.schema.json");

/// Prints the schema of every graph file, or of those that use only the installed node types, or of reports.
pub fn schema(args: &SchemaArgs) -> Result<End, Wrong> {
    if args.report {
        print(REPORT)?;
        return Ok(End::Done);
    }
    let schema = match args.nodes {
        true => tenon_engine::schema_with_nodes(&crate::plugins::registry()?),
        false => tenon_engine::schema(),
    };
    print_json(&schema)?;
    Ok(End::Done)
}
