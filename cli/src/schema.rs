//! `tenon schema`: the JSON Schema of graph files, of reports and of expectations.

use crate::End;
use crate::args::SchemaArgs;
use crate::words::{Wrong, print, print_json};

/// What stands in a report; the engine makes a part of it and the program the rest.
const REPORT: &str = include_str!("../../docs/report.schema.json");

/// Files of expectations; the engine reads and writes them.
const EXPECT: &str = include_str!("../../docs/expect.schema.json");

/// Prints the schema of every graph file, or of those that use only the installed node types, or of reports or expectations.
pub fn schema(args: &SchemaArgs) -> Result<End, Wrong> {
    if args.report || args.expect {
        print(if args.report { REPORT } else { EXPECT })?;
        return Ok(End::Done);
    }
    let schema = match args.nodes {
        true => tenon_engine::schema_with_nodes(&crate::plugins::registry()?),
        false => tenon_engine::schema(),
    };
    print_json(&schema)?;
    Ok(End::Done)
}
