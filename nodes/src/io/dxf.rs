//! Layout drawing as DXF R2000. Written by hand: the format needs about a hundred fixed lines of tables, while the
//! `dxf` crate brings a date, an id generator and 400 entity types, and stamps every file with the time.

use super::blocks::Blocks;
use super::drawing::{Drawing, DrawnPiece};
use std::fmt::{Display, Write as _};
use tenon_geometry::DVec2;

/// Layers: name, AutoCAD colour, line type.
const LAYERS: [(&str, u8, &str); 9] = [
    ("0", 7, "CONTINUOUS"),
    ("BOARD", 7, "CONTINUOUS"),
    ("USABLE", 8, "DASHED"),
    ("UPPER", 1, "CONTINUOUS"),
    ("LOWER", 5, "DASHED"),
    ("CLEARED", 9, "CONTINUOUS"),
    ("HOLES", 3, "CONTINUOUS"),
    ("CUTS", 30, "CONTINUOUS"),
    ("TEXT", 6, "CONTINUOUS"),
];

/// Handles of the objects that others refer to; entities follow after the last one.
mod handle {
    pub const BLOCK_TABLE: u32 = 1;
    pub const LAYER_TABLE: u32 = 2;
    pub const STYLE_TABLE: u32 = 3;
    pub const LINE_TYPE_TABLE: u32 = 4;
    pub const VIEW_TABLE: u32 = 5;
    pub const UCS_TABLE: u32 = 6;
    pub const VIEWPORT_TABLE: u32 = 7;
    pub const APP_TABLE: u32 = 8;
    pub const DIMENSION_TABLE: u32 = 9;
    pub const ROOT: u32 = 0xA;
    pub const GROUPS: u32 = 0xB;
    pub const MODEL: u32 = 0xC;
    pub const PAPER: u32 = 0xD;
    pub const FIRST_FREE: u32 = 0x20;
}

/// Writes the drawing as ASCII DXF R2000 (AC1015), millimetres, boards side by side along X with a gap of a tenth of
/// their width. Lengths have 4 decimals. Layers: BOARD, USABLE (board less margin), UPPER and LOWER (outlines of both
/// faces), CLEARED (what tools sweep), HOLES (circle of the hole's diameter at its mouth, line to its tip), CUTS, TEXT.
/// Cost O(corners + holes). Stops early, and what there is then is of no use, when `go` says no.
#[must_use]
pub fn write_dxf(drawing: &Drawing, go: &dyn Fn() -> bool) -> Vec<u8> {
    let mut body = Dxf { text: Blocks::default(), next: handle::FIRST_FREE };
    for board in (0..drawing.boards).take_while(|_| go()) {
        body.board(drawing, board);
    }
    for piece in drawing.pieces.iter().take_while(|_| go()) {
        body.piece(piece, board_origin(drawing, piece.placement.board));
    }
    let entities = std::mem::take(&mut body.text);
    let mut tables = Dxf { text: Blocks::default(), next: body.next };
    tables.tables();
    let mut out = Dxf { text: Blocks::default(), next: 0 };
    out.header(tables.next, extent(drawing));
    out.text.append(tables.text);
    out.pair(0, "SECTION").pair(2, "ENTITIES");
    out.text.append(entities);
    out.pair(0, "ENDSEC");
    out.objects();
    out.pair(0, "EOF");
    out.text.into_bytes()
}

/// Where a board's lower left corner lies in the drawing.
pub(super) fn board_origin(drawing: &Drawing, board: u32) -> DVec2 {
    DVec2::new(f64::from(board) * drawing.board.size.x * 1.1, 0.0)
}

fn extent(drawing: &Drawing) -> DVec2 {
    board_origin(drawing, drawing.boards.saturating_sub(1)) + drawing.board.size
}

struct Dxf {
    text: Blocks,
    next: u32,
}

impl Dxf {
    fn pair(&mut self, code: u16, value: impl Display) -> &mut Self {
        let _ = writeln!(self.text, "{code}\n{value}");
        self
    }

    fn length(&mut self, code: u16, value: f64) -> &mut Self {
        // Rounded first so that a tiny negative number does not become -0.0000.
        let value = (value * 1e4).round() / 1e4 + 0.0;
        self.pair(code, format_args!("{value:.4}"))
    }

    fn point(&mut self, code: u16, p: DVec2) -> &mut Self {
        self.length(code, p.x).length(code + 10, p.y).length(code + 20, 0.0)
    }

    fn own_handle(&mut self) -> &mut Self {
        let h = self.next;
        self.next += 1;
        self.pair(5, format_args!("{h:X}"))
    }

    fn owner(&mut self, owner: u32) -> &mut Self {
        self.pair(330, format_args!("{owner:X}"))
    }

    fn entity(&mut self, kind: &str, layer: &str, class: &str) -> &mut Self {
        self.pair(0, kind).own_handle().owner(handle::MODEL).pair(100, "AcDbEntity").pair(8, layer).pair(100, class)
    }

    fn polygon(&mut self, layer: &str, line: &[DVec2], origin: DVec2) {
        if line.len() < 2 {
            return;
        }
        self.entity("LWPOLYLINE", layer, "AcDbPolyline").pair(90, line.len()).pair(70, 1);
        for p in line {
            let p = *p + origin;
            self.length(10, p.x).length(20, p.y);
        }
    }

    fn label(&mut self, origin: DVec2, turn: f64, height: f64, text: &str) {
        let text: String = text.chars().map(|c| if (' '..='~').contains(&c) { c } else { '?' }).collect();
        self.entity("TEXT", "TEXT", "AcDbText").point(10, origin).length(40, height).pair(1, text);
        self.length(50, turn.to_degrees()).pair(7, "STANDARD").pair(100, "AcDbText");
    }

    fn board(&mut self, drawing: &Drawing, board: u32) {
        let (size, margin) = (drawing.board.size, drawing.board.margin);
        let origin = board_origin(drawing, board);
        let rectangle =
            |m: f64| [DVec2::splat(m), DVec2::new(size.x - m, m), size - DVec2::splat(m), DVec2::new(m, size.y - m)];
        self.polygon("BOARD", &rectangle(0.0), origin);
        self.polygon("USABLE", &rectangle(margin), origin);
        let height = 0.03 * size.x;
        let (x, y, t) = (size.x, size.y, drawing.board.thickness);
        let title = format!("Board {} of {}: {x} x {y} x {t} mm", board + 1, drawing.boards);
        self.label(origin + DVec2::new(0.0, size.y + height), 0.0, height, &title);
    }

    fn piece(&mut self, piece: &DrawnPiece, origin: DVec2) {
        self.polygon("CLEARED", &piece.cleared, origin);
        self.polygon("LOWER", &piece.lower, origin);
        self.polygon("UPPER", &piece.upper, origin);
        for cut in &piece.cuts {
            self.polygon("CUTS", cut, origin);
        }
        for hole in &piece.holes {
            self.entity("CIRCLE", "HOLES", "AcDbCircle").point(10, hole.mouth + origin).length(40, 0.5 * hole.diameter);
            if hole.mouth.distance(hole.tip) > 1e-3 {
                self.entity("LINE", "HOLES", "AcDbLine").point(10, hole.mouth + origin).point(11, hole.tip + origin);
            }
        }
        // One text per piece: the engraved one, else the address.
        let texts = if piece.engraved.is_empty() { std::slice::from_ref(&piece.label) } else { &piece.engraved };
        for t in texts {
            self.label(t.origin + origin, t.turn, t.height, &t.text);
        }
    }

    fn header(&mut self, seed: u32, max: DVec2) {
        self.pair(0, "SECTION").pair(2, "HEADER").pair(9, "$ACADVER").pair(1, "AC1015");
        self.pair(9, "$DWGCODEPAGE").pair(3, "ANSI_1252").pair(9, "$HANDSEED").pair(5, format_args!("{seed:X}"));
        // 4: millimetres; 1: metric.
        self.pair(9, "$INSUNITS").pair(70, 4).pair(9, "$MEASUREMENT").pair(70, 1);
        self.pair(9, "$EXTMIN").point(10, DVec2::ZERO).pair(9, "$EXTMAX").point(10, max).pair(0, "ENDSEC");
    }

    fn table(&mut self, name: &str, table: u32, entries: usize) -> &mut Self {
        self.pair(0, "TABLE").pair(2, name).pair(5, format_args!("{table:X}")).owner(0);
        self.pair(100, "AcDbSymbolTable").pair(70, entries)
    }

    fn record(&mut self, kind: &str, table: u32, class: &str, name: &str) -> &mut Self {
        self.pair(0, kind).own_handle().owner(table).pair(100, "AcDbSymbolTableRecord").pair(100, class).pair(2, name)
    }

    fn tables(&mut self) {
        self.pair(0, "SECTION").pair(2, "TABLES");
        self.table("VPORT", handle::VIEWPORT_TABLE, 0).pair(0, "ENDTAB");
        self.table("LTYPE", handle::LINE_TYPE_TABLE, 4);
        for name in ["BYBLOCK", "BYLAYER", "CONTINUOUS"] {
            self.record("LTYPE", handle::LINE_TYPE_TABLE, "AcDbLinetypeTableRecord", name);
            self.pair(70, 0).pair(3, "").pair(72, 65).pair(73, 0).length(40, 0.0);
        }
        self.record("LTYPE", handle::LINE_TYPE_TABLE, "AcDbLinetypeTableRecord", "DASHED");
        self.pair(70, 0).pair(3, "__ __ __").pair(72, 65).pair(73, 2).length(40, 18.0);
        self.length(49, 12.0).pair(74, 0).length(49, -6.0).pair(74, 0).pair(0, "ENDTAB");
        self.table("LAYER", handle::LAYER_TABLE, LAYERS.len());
        for (name, colour, line) in LAYERS {
            self.record("LAYER", handle::LAYER_TABLE, "AcDbLayerTableRecord", name);
            self.pair(70, 0).pair(62, colour).pair(6, line);
        }
        self.pair(0, "ENDTAB").table("STYLE", handle::STYLE_TABLE, 1);
        self.record("STYLE", handle::STYLE_TABLE, "AcDbTextStyleTableRecord", "STANDARD");
        self.pair(70, 0).length(40, 0.0).length(41, 1.0).length(50, 0.0).pair(71, 0).length(42, 2.5);
        self.pair(3, "txt").pair(4, "").pair(0, "ENDTAB");
        self.table("VIEW", handle::VIEW_TABLE, 0).pair(0, "ENDTAB");
        self.table("UCS", handle::UCS_TABLE, 0).pair(0, "ENDTAB");
        self.table("APPID", handle::APP_TABLE, 1);
        self.record("APPID", handle::APP_TABLE, "AcDbRegAppTableRecord", "ACAD").pair(70, 0).pair(0, "ENDTAB");
        self.table("DIMSTYLE", handle::DIMENSION_TABLE, 0).pair(100, "AcDbDimStyleTable").pair(0, "ENDTAB");
        self.table("BLOCK_RECORD", handle::BLOCK_TABLE, 2);
        let blocks = [("*MODEL_SPACE", handle::MODEL), ("*PAPER_SPACE", handle::PAPER)];
        for (name, block) in blocks {
            self.pair(0, "BLOCK_RECORD").pair(5, format_args!("{block:X}")).owner(handle::BLOCK_TABLE);
            self.pair(100, "AcDbSymbolTableRecord").pair(100, "AcDbBlockTableRecord").pair(2, name);
        }
        self.pair(0, "ENDTAB").pair(0, "ENDSEC").pair(0, "SECTION").pair(2, "BLOCKS");
        for (name, block) in blocks {
            self.pair(0, "BLOCK").own_handle().owner(block).pair(100, "AcDbEntity").pair(8, "0");
            self.pair(100, "AcDbBlockBegin").pair(2, name).pair(70, 0).point(10, DVec2::ZERO).pair(3, name).pair(1, "");
            self.pair(0, "ENDBLK").own_handle().owner(block).pair(100, "AcDbEntity").pair(8, "0");
            self.pair(100, "AcDbBlockEnd");
        }
        self.pair(0, "ENDSEC");
    }

    fn objects(&mut self) {
        self.pair(0, "SECTION").pair(2, "OBJECTS");
        self.pair(0, "DICTIONARY").pair(5, format_args!("{:X}", handle::ROOT)).owner(0).pair(100, "AcDbDictionary");
        self.pair(281, 1).pair(3, "ACAD_GROUP").pair(350, format_args!("{:X}", handle::GROUPS));
        self.pair(0, "DICTIONARY").pair(5, format_args!("{:X}", handle::GROUPS)).owner(handle::ROOT);
        self.pair(100, "AcDbDictionary").pair(281, 1).pair(0, "ENDSEC");
    }
}

#[cfg(test)]
mod tests {
    use super::super::{draw, fixture};
    use super::*;

    /// Pairs of group code and value.
    fn pairs(dxf: &[u8]) -> Vec<(u16, String)> {
        let text = String::from_utf8(dxf.to_vec()).unwrap();
        let lines: Vec<_> = text.lines().collect();
        assert_eq!(lines.len() % 2, 0);
        lines.chunks(2).map(|p| (p[0].parse().unwrap(), p[1].to_owned())).collect()
    }

    #[test]
    fn holds_what_the_layout_holds_under_unique_handles() {
        let dxf = write_dxf(&draw(&fixture::parts(), &fixture::layout()).unwrap(), &|| true);
        let pairs = pairs(&dxf);
        let count = |kind: &str| pairs.iter().filter(|p| p.0 == 0 && p.1 == kind).count();
        // 2 boards × 2 rectangles, 2 pieces × 3 outlines, 1 slot.
        assert_eq!(count("LWPOLYLINE"), 11);
        assert_eq!((count("CIRCLE"), count("LINE")), (2, 1));
        // Titles, engraved address, address of the piece without one.
        assert_eq!(count("TEXT"), 4);
        let mut handles: Vec<_> =
            pairs.iter().filter(|p| p.0 == 5).map(|p| u32::from_str_radix(&p.1, 16).unwrap()).collect();
        let seed = handles.remove(0);
        assert!(handles.iter().all(|h| *h < seed && *h > 0));
        handles.sort_unstable();
        handles.windows(2).for_each(|w| assert_ne!(w[0], w[1]));
        // Board 2 lies 440 to the right; the turned piece's first corner there at (150, 40).
        let at = pairs.windows(2).any(|w| w[0] == (10, "590.0000".into()) && w[1] == (20, "40.0000".into()));
        assert!(at, "{}", String::from_utf8_lossy(&dxf));
    }
}
