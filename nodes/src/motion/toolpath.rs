//! `toolpath`: all moves of all boards.

use super::{issue_fail, path_fail};
use crate::post::MachineFile;
use crate::value::V;
use tenon_engine::{NodeType, Port};
use tenon_geometry::board::{Layout, PartSet};
use tenon_geometry::motion::{PathParams, Place, ToolPaths, tool_paths};

pub(super) fn node() -> NodeType {
    NodeType::new("toolpath", 1)
        .name("Tool paths")
        .category("Machine")
        .doc(
            "Per board: fixing holes, address engraving, fastener drilling, then chamfers and node facets in passes with a \
             flat end mill. (000 §7.3.3)",
        )
        .keywords(&["cam", "milling", "contour", "drilling", "engraving"])
        .input(Port::item::<V<PartSet>>("parts").doc("The mapped parts."))
        .input(Port::item::<V<Layout>>("layout").doc("Where they lie."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine with its tools."))
        .input(Port::item::<V<PathParams>>("machining").doc("How contours and holes are cut."))
        .output(Port::item::<V<ToolPaths>>("paths").doc("Operations and moves of all boards."))
        .run(|c| {
            let parts = c.item::<V<PartSet>>("parts")?;
            let layout = c.item::<V<Layout>>("layout")?;
            let machine = &c.item::<V<MachineFile>>("machine")?.machine;
            let monitor = c.monitor();
            let (paths, issues) =
                tool_paths(parts, layout, machine, c.item::<V<PathParams>>("machining")?, &|f| monitor.progress(f))
                    .map_err(|e| path_fail(&e))?;
            // Parts that cannot be cut out are not in the layout: pack has named them.
            for issue in issues.iter().filter(|i| !matches!(i.place, Place::Facet(_))) {
                c.report(issue_fail(issue));
            }
            c.set("paths", V::new(paths));
            Ok(())
        })
}
