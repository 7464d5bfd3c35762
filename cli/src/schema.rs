//! `tenon schema`: the JSON Schema of graph files.

use crate::End;
use crate::args::SchemaArgs;
use crate::words::{Wrong, print_json};

/// Prints the schema of every graph file, or of those that use only the installed node types.
pub fn schema(args: &SchemaArgs) -> Result<End, Wrong> {
    let schema = match args.nodes {
        true => tenon_engine::schema_with_nodes(&tenon_nodes::registry()),
        false => tenon_engine::schema(),
    };
    print_json(&schema)?;
    Ok(End::Done)
}
