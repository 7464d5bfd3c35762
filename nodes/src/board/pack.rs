//! `pack`: parts onto boards.

use crate::post::MachineFile;
use crate::value::{V, with_address};
use tenon_engine::{Call, Fail, NodeType, Port, Text, Unit};
use tenon_geometry::DVec2;
use tenon_geometry::board::{Board, Bounds, Goods, Grain, Layout, PackError, Packer, PartSet, RowPacker};
use tenon_geometry::motion::PartPaths;

pub(super) fn node() -> NodeType {
    NodeType::new("pack", 1)
        .name("Pack")
        .category("Board")
        .doc(
            "Lays parts on boards in rows: no part lies in what tools clear for another one, and what tools clear stays on \
             the board. Outlines come from the real tools and bevels. (000 §7.2)",
        )
        .keywords(&["nest", "layout", "boards", "rows"])
        .slow()
        .input(Port::item::<V<PartSet>>("parts").doc("The mapped parts."))
        .input(Port::item::<V<MachineFile>>("machine").doc("The machine with its tools."))
        .input(Port::item::<V<PartPaths>>("paths").doc("Their tool paths: what tools sweep is kept clear."))
        .input(Port::item::<f64>("board_x").unit(Unit::Length).range(1.0, 1e5).default(1500.0).doc("Length of a board along X."))
        .input(Port::item::<f64>("board_y").unit(Unit::Length).range(1.0, 1e5).default(3000.0).doc("Length of a board along Y."))
        .input(Port::item::<f64>("margin").unit(Unit::Length).range(0.0, 1e4).default(10.0).doc("Border of the board that stays free."))
        .input(Port::item::<f64>("gap").unit(Unit::Length).range(0.0, 1e4).default(0.5).doc("Least distance between a part and what is cleared for another."))
        .input(Port::item::<Text>("turns").choices(&["none", "half", "free"]).default("none").doc("How parts may be turned: not at all (the grain has a direction), by half-turns (it has an axis), or freely."))
        .input(Port::item::<Text>("inside").choices(&["cleared", "piece"]).default("cleared").doc("What must stay inside the margin: all that tools clear, or the pieces only."))
        .input(Port::item::<bool>("keep_order").default(false).doc("Keep the order of the parts instead of sorting them by size."))
        .output(Port::item::<V<Layout>>("layout").doc("Which part lies where."))
        .output(Port::item::<i64>("boards").unit(Unit::Count).doc("Number of boards."))
        .output(Port::item::<f64>("use").unit(Unit::Ratio).doc("Share of the boards' area that becomes parts."))
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let parts = c.item::<V<PartSet>>("parts")?;
    let machine = &c.item::<V<MachineFile>>("machine")?.machine;
    let monitor = c.monitor();
    let mut goods = Goods::of_parts(parts, c.item::<V<PartPaths>>("paths")?, machine, &|| !monitor.cancelled());
    goods.gap = c.number("gap")?;
    goods.grain = match c.text("turns")? {
        "half" => Grain::Axis,
        "free" => Grain::Free,
        _ => Grain::Directed,
    };
    goods.inside = if c.text("inside")? == "piece" { Bounds::Piece } else { Bounds::Cleared };
    let board = Board {
        size: DVec2::new(c.number("board_x")?, c.number("board_y")?),
        thickness: parts.panels.thickness,
        margin: c.number("margin")?,
    };
    let packer = RowPacker { keep_order: c.boolean("keep_order")? };
    let packed = packer.pack(&goods, &board, &|f| monitor.progress(f)).map_err(|e| pack_fail(parts, &e))?;
    for error in &packed.left_out {
        c.report(pack_fail(parts, error));
    }
    let layout = packed.layout;
    let used: f64 =
        layout.placements.iter().map(|p| tenon_geometry::board::convex::area(&layout.piece[p.part as usize])).sum();
    let area = f64::from(layout.boards) * board.size.x * board.size.y;
    c.set("boards", i64::from(layout.boards));
    c.set("use", if area > 0.0 { used / area } else { 0.0 });
    c.set("layout", V::new(layout));
    Ok(())
}

fn pack_fail(parts: &PartSet, error: &PackError) -> Fail {
    match error {
        PackError::TooLarge { part, .. } => {
            Fail::new("part-larger-than-board", with_address(&parts.panels, *part, error))
                .port("parts")
                .item(*part as usize)
        }
        PackError::NoArea { .. } => Fail::new("board-no-area", error.to_string()).port("margin"),
        PackError::Gap { .. } => Fail::new("out-of-range", error.to_string()).port("gap"),
        PackError::NotFinite { .. } => Fail::new("not-finite", error.to_string()).port("parts"),
        PackError::Cancelled => Fail::cancelled(),
    }
}
