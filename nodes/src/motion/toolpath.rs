//! `toolpath`: all moves of every part.

use super::{issue_fail, path_fail};
use crate::post::MachineFile;
use crate::value::V;
use tenon_engine::{NodeType, Port};
use tenon_geometry::board::PartSet;
use tenon_geometry::motion::{PartPaths, PathParams, cut_parts};

pub(super) fn node() -> NodeType {
    NodeType::new("toolpath", 1)
        .name("Tool paths")
        .category("Machine")
        .doc(
            "Per part: fixing holes, address engraving, fastener drilling, then chamfers and node facets in passes with a \
             flat end mill. What tools sweep here is what pack keeps clear. (000 §7.3.3)",
        )
        .keywords(&["cam", "milling", "contour", "drilling", "engraving"])
        .input(Port::item::<V<PartSet>>("parts").doc("The mapped parts."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine with its tools."))
        .input(Port::item::<V<PathParams>>("machining").doc("How contours and holes are cut."))
        .output(Port::item::<V<PartPaths>>("paths").doc("Operations and moves of every part, in its own frame."))
        .run(|c| {
            let machine = &c.item::<V<MachineFile>>("machine")?.machine;
            let (parts, machining) = (c.item::<V<PartSet>>("parts")?, c.item::<V<PathParams>>("machining")?);
            let monitor = c.monitor();
            let paths = cut_parts(parts, machine, machining, &|f| monitor.progress(f)).map_err(|e| path_fail(&e))?;
            for issue in &paths.issues {
                c.report(issue_fail(parts, issue));
            }
            c.set("paths", V::new(paths));
            Ok(())
        })
}
