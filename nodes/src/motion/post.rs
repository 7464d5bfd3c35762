//! `post`: tool paths on their boards, in the machine's words.

use super::issue_fail;
use crate::post::{MachineFile, PostError, PostParams, post_parts};
use crate::value::{Program, Standing, V};
use std::sync::Arc;
use tenon_engine::{Fail, NodeType, Port, Text};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::motion::PartPaths;

pub(super) fn node() -> NodeType {
    NodeType::new("post", 1)
        .name("Post")
        .category("Machine")
        .doc("Puts the tool paths of all parts on their boards, fixing holes first and contours last, and writes one program per \
             board in the machine's words, angles within its limits. (000 §7.3.4)")
        .keywords(&["g-code", "nc", "program", "maka"])
        .input(Port::item::<V<PartPaths>>("paths").doc("Tool paths of all parts."))
        .input(Port::item::<V<Layout>>("layout").doc("Where the parts lie."))
        .input(Port::item::<V<PartSet>>("parts").doc("The parts, for their addresses."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine with its words."))
        .input(Port::item::<Text>("name").default("board").doc("Programs are called name-1, name-2 and so on."))
        .output(Port::list::<Program>("programs").doc("One program per board, not yet proven."))
        .run(|c| {
            let machine = c.item::<V<MachineFile>>("machine")?;
            let parts = c.item::<V<PartSet>>("parts")?;
            let params = PostParams {
                name: c.text("name")?,
                addresses: &parts.panels.address,
                header: &[],
            };
            let monitor = c.monitor();
            let go = || !monitor.cancelled();
            let (paths, layout) = (c.item::<V<PartPaths>>("paths")?, c.item::<V<Layout>>("layout")?);
            let (posted, issues) = post_parts((paths, layout), &machine.machine, &machine.words, &params, &go);
            if c.cancelled() {
                return Err(Fail::cancelled());
            }
            for issue in &issues {
                c.report(issue_fail(parts, issue));
            }
            let posted = posted.map_err(|e| post_fail(&e))?;
            let programs =
                posted.into_iter().map(|p| Program { posted: Arc::new(p), standing: Standing::Unproven }).collect();
            c.set_list("programs", programs);
            Ok(())
        })
}

fn post_fail(error: &PostError) -> Fail {
    let code = match error {
        PostError::Cancelled => return Fail::cancelled(),
        PostError::Limit { .. } | PostError::Orientation { .. } => "axis-limit",
        PostError::Turn { .. } => "turn-at-feed",
        PostError::NoTool { .. } => "no-such-tool",
        PostError::NotANumber { .. } => "not-finite",
    };
    Fail::new(code, error.to_string()).port("paths")
}
