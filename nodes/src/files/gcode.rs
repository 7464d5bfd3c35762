//! `write_gcode`: programs as files, withheld until proven.

use crate::value::Program;
use tenon_engine::{File, NodeType, Port, stop};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![
        NodeType::new("write_gcode", 1)
            .name("Write G-code")
            .category("Files")
            .doc(
                "One file per program. A program whose proof failed or was left out is withheld: the host does not give it \
                 its final name unless it is told to.",
            )
            .keywords(&["nc", "ngc", "export", "program"])
            .input(Port::list::<Program>("programs").doc("Programs, proven ones from prove."))
            .output(Port::list::<File>("files").doc("The files."))
            .writer()
            .run(|c| {
                let file = |p: &Program| File {
                    name: p.posted.file_name().into(),
                    bytes: p.posted.text.as_bytes().into(),
                    withheld: p.standing.withheld(),
                };
                let files = c.list::<Program>("programs")?.iter().inspect(|_| stop::check()).map(file).collect();
                c.set_list("files", files);
                Ok(())
            }),
    ]
}
