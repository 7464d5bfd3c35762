//! `post`: tool paths in the machine's words.

use crate::post::{MachineFile, PostError, PostParams, post};
use crate::value::{Program, Standing, V};
use std::sync::Arc;
use tenon_engine::{Fail, NodeType, Port, Text};
use tenon_geometry::board::PartSet;
use tenon_geometry::motion::ToolPaths;

pub(super) fn node() -> NodeType {
    NodeType::new("post", 1)
        .name("Post")
        .category("Machine")
        .doc("Writes one program per board in the machine's words, angles within its limits. (000 §7.3.4)")
        .keywords(&["g-code", "nc", "program", "maka"])
        .input(Port::item::<V<ToolPaths>>("paths").doc("Tool paths of all boards."))
        .input(Port::item::<V<PartSet>>("parts").doc("The parts, for their addresses."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine with its words."))
        .input(Port::item::<Text>("name").default("board").doc("Programs are called name-1, name-2 and so on."))
        .output(Port::list::<Program>("programs").doc("One program per board, not yet proven."))
        .run(|c| {
            let machine = c.item::<V<MachineFile>>("machine")?;
            let params = PostParams {
                name: c.text("name")?,
                addresses: &c.item::<V<PartSet>>("parts")?.panels.address,
                header: &[],
            };
            let posted = post(c.item::<V<ToolPaths>>("paths")?, &machine.machine, &machine.words, &params)
                .map_err(|e| post_fail(&e))?;
            let programs =
                posted.into_iter().map(|p| Program { posted: Arc::new(p), standing: Standing::Unproven }).collect();
            c.set_list("programs", programs);
            Ok(())
        })
}

fn post_fail(error: &PostError) -> Fail {
    let code = match error {
        PostError::Limit { .. } | PostError::Orientation { .. } => "axis-limit",
        PostError::Turn { .. } => "turn-at-feed",
        PostError::NoTool { .. } => "no-such-tool",
        PostError::NotANumber { .. } => "not-finite",
    };
    Fail::new(code, error.to_string()).port("paths")
}
