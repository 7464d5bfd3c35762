//! `write_proof`: the proof as data.

use super::{set_file, writer};
use crate::io::Blocks;
use crate::value::V;
use tenon_engine::{Fail, Item, NodeType, Port};
use tenon_geometry::proof::ProofReport;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        writer("write_proof", "Write proof", "proof.json")
            .doc("Writes the verdicts per program and per part as JSON.")
            .keywords(&["report", "json", "export"])
            .input(Port::item::<V<ProofReport>>("report").doc("The report from prove."))
            .run(|c| {
                let json = c.item::<V<ProofReport>>("report")?.to_json();
                let mut text = Blocks::default();
                serde_json::to_writer_pretty(&mut text, &json)
                    .map_err(|e| Fail::new("cannot-write", e.to_string()).port("report"))?;
                set_file(c, text.into_bytes())
            }),
    ]
}
