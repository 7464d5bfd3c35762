//! `machining`: how contours and holes are cut.

use crate::value::V;
use tenon_engine::{NodeType, Port, Unit};
use tenon_geometry::motion::PathParams;

pub(super) fn node() -> NodeType {
    let d = PathParams::default();
    let length = |name: &'static str, default: f64, doc: &'static str| {
        Port::item::<f64>(name).unit(Unit::Length).range(0.0, 1e3).default(default).doc(doc)
    };
    NodeType::new("machining", 1)
        .name("Machining")
        .category("Machine")
        .doc("How contours and holes are cut. (000 §7.3)")
        .keywords(&["strategy", "passes", "overrun", "feeds"])
        .input(
            Port::item::<i64>("contour_tool")
                .range(0.0, 1e6)
                .default(0)
                .doc("Number of the end mill for contours; 0: the widest one."),
        )
        .input(length("overrun", d.overrun, "How far a contour cut reaches below the part along the tool axis."))
        .input(length(
            "corner_overrun",
            d.corner_overrun,
            "How far a contour cut goes on beyond the ends of its chamfer.",
        ))
        .input(
            Port::item::<f64>("max_step")
                .unit(Unit::Length)
                .range(0.01, 1e3)
                .default(d.max_step)
                .doc("Greatest depth of one pass."),
        )
        .input(length("clearance", d.clearance, "Distance kept above the board by approaches, holder and spindle."))
        .input(length("through", d.through, "How far through holes go into the sacrificial layer."))
        .input(length("peck", 0.0, "Greatest depth of drilling between two lifts; 0: in one go."))
        .output(Port::item::<V<PathParams>>("machining").doc("The settings."))
        .run(|c| {
            let params = PathParams {
                contour_tool: u32::try_from(c.integer("contour_tool")?).ok().filter(|t| *t > 0),
                overrun: c.number("overrun")?,
                corner_overrun: c.number("corner_overrun")?,
                max_step: c.number("max_step")?,
                clearance: c.number("clearance")?,
                through: c.number("through")?,
                peck: Some(c.number("peck")?).filter(|p| *p > 0.0),
            };
            c.set("machining", V::new(params));
            Ok(())
        })
}
