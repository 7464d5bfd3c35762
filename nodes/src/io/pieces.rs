//! Piece list: what every panel is and where it lies, as CSV for people's tables and JSON for programs.

use super::blocks::Blocks;
use super::drawing::{DrawingError, by_part};
use super::lines::{document, json};
use serde::Serialize;
use std::borrow::Cow;
use std::fmt::Write as _;
use tenon_engine::stop;
use tenon_geometry::DVec3;
use tenon_geometry::board::{Layout, PartSet, Placement};
use tenon_geometry::joint::{Feature, FeatureSet, Hardware, Machining};
use tenon_geometry::panel::{PanelSet, Side};

#[derive(Serialize)]
struct Head {
    format: &'static str,
    version: u32,
    units: &'static str,
    boards: u32,
    thickness: f64,
    total: Total,
    hardware: Vec<Count>,
}

/// Sums over all pieces.
#[derive(Default, Serialize)]
struct Total {
    pieces: u64,
    placed: u64,
    area: f64,
    volume: f64,
    holes: u64,
    by_hand: u64,
}

#[derive(Serialize)]
struct Count {
    name: String,
    count: u64,
}

#[derive(Serialize)]
struct Piece {
    address: String,
    part: u32,
    board: Option<u32>,
    x: Option<f64>,
    y: Option<f64>,
    turn_deg: Option<f64>,
    thickness: f64,
    area: f64,
    volume: f64,
    edges: Vec<Edge>,
    holes: Vec<Hole>,
}

#[derive(Serialize)]
struct Edge {
    side: &'static str,
    length: f64,
    back_length: f64,
    chamfer_deg: f64,
    neighbour: Option<String>,
}

#[derive(Serialize)]
struct Hole {
    purpose: Cow<'static, str>,
    diameter: f64,
    depth: f64,
    entry: DVec3,
    axis: DVec3,
    edge: Option<u32>,
    joint: Option<u32>,
    by_hand: bool,
}

/// Every panel that could be made, in the set's order.
fn list(parts: &PartSet, layout: &Layout) -> Result<Vec<Piece>, DrawingError> {
    let panels = &parts.panels;
    let n = panels.len();
    let mut places: Vec<Option<&Placement>> = vec![None; n];
    for (placement, p) in layout.placements.iter().enumerate() {
        let (part, board) = (p.part, p.board);
        *places.get_mut(part as usize).ok_or(DrawingError::NoSuchPlace {
            placement,
            part,
            board,
            parts: n,
            boards: layout.boards,
        })? = Some(p);
    }
    let made = by_part(&parts.features.features, n)?;
    let by_hand = by_part(&parts.features.by_hand, n)?;
    let pieces = (0..n).inspect(|_| stop::check()).filter(|&i| panels.is_valid(i)).map(|i| {
        let place = places[i];
        let machine = made[i].iter().filter_map(|f| hole(f, false));
        Piece {
            address: panels.address[i].to_string(),
            part: i as u32,
            board: place.map(|p| p.board),
            x: place.map(|p| p.offset.x),
            y: place.map(|p| p.offset.y),
            turn_deg: place.map(|p| p.turn.to_degrees()),
            thickness: panels.thickness,
            area: panels.front_area(i),
            volume: panels.volume(i),
            edges: edges(panels, i),
            holes: machine.chain(by_hand[i].iter().filter_map(|f| hole(f, true))).collect(),
        }
    });
    Ok(pieces.collect())
}

fn edges(panels: &PanelSet, i: usize) -> Vec<Edge> {
    let range = panels.corners(i);
    let edge = |c: usize| {
        let next = if c + 1 == range.end { range.start } else { c + 1 };
        let lean = panels.chamfer[c].normal.dot(panels.normal[i]).clamp(-1.0, 1.0).asin();
        Edge {
            side: match panels.side[c] {
                Side::Bottom => "bottom",
                Side::Right => "right",
                Side::Top => "top",
                Side::Left => "left",
                Side::Other => "other",
            },
            length: panels.front[c].distance(panels.front[next]),
            back_length: panels.back_start[c].distance(panels.back_end[c]),
            chamfer_deg: lean.to_degrees(),
            neighbour: panels.neighbour[c]
                .get()
                .and_then(|e| panels.address.get(e.panel as usize))
                .map(ToString::to_string),
        }
    };
    range.clone().map(edge).collect()
}

fn hole(f: &Feature, by_hand: bool) -> Option<Hole> {
    let Machining::Drill { entry, axis, depth, diameter } = f.machining else { return None };
    Some(Hole { purpose: f.purpose.clone(), diameter, depth, entry, axis, edge: f.edge, joint: f.joint, by_hand })
}

/// Writes the piece list as JSON, one piece a line, shortest round-trip numbers; mm, mm², mm³, degrees.
///
/// Per piece: `address`, `part` (index), `board` (from 0), `x`, `y`, `turn_deg` (null where it found no place),
/// `thickness`, `area` (front face), `volume` (holes not taken off), `edges` (`side`, `length` on the front,
/// `back_length`, `chamfer_deg`, address of the `neighbour`), `holes` in the part's frame. `chamfer_deg` is the cut's
/// lean from square, positive where the back is the larger face. The head has totals and hardware. Cost O(corners +
/// features).
///
/// # Errors
/// [`DrawingError`] when layout and parts do not belong together.
pub fn write_pieces_json(parts: &PartSet, layout: &Layout) -> Result<Vec<u8>, DrawingError> {
    let pieces = list(parts, layout)?;
    let mut total = Total::default();
    for p in &pieces {
        total.pieces += 1;
        total.placed += u64::from(p.board.is_some());
        total.area += p.area;
        total.volume += p.volume;
        total.holes += p.holes.iter().filter(|h| !h.by_hand).count() as u64;
        total.by_hand += p.holes.iter().filter(|h| h.by_hand).count() as u64;
    }
    let count = |h: &Hardware| Count { name: h.name.clone(), count: h.count };
    let head = Head {
        format: "tenon-pieces",
        version: 1,
        units: "mm",
        boards: layout.boards,
        thickness: parts.panels.thickness,
        total,
        hardware: parts.features.hardware.iter().map(count).collect(),
    };
    Ok(document(&head, "pieces", pieces.iter().inspect(|_| stop::check()).map(json)))
}

/// Writes the piece list as CSV (RFC 4180, a header line, points as decimal marks). Lengths have 3 decimals (mm), areas
/// and volumes 1 (mm², mm³), angles 3 (degrees). Columns with one entry per edge hold them parted by spaces, in the
/// order of `sides`; a border edge has the neighbour `-`. Boards count from 1, as in the drawings and program names.
/// Cost O(corners + features).
///
/// # Errors
/// [`DrawingError`] when layout and parts do not belong together.
pub fn write_pieces_csv(parts: &PartSet, layout: &Layout) -> Result<Vec<u8>, DrawingError> {
    let mut out = Blocks::default();
    out.push_str(
        "address,board,x,y,turn_deg,thickness,area,volume,sides,lengths,chamfers_deg,neighbours,holes,by_hand\r\n",
    );
    for p in list(parts, layout)? {
        stop::check();
        let place = match (p.board, p.x, p.y, p.turn_deg) {
            (Some(b), Some(x), Some(y), Some(t)) => format!("{},{},{},{}", b + 1, fixed(x), fixed(y), fixed(t)),
            _ => ",,,".to_owned(),
        };
        let each = |column: &dyn Fn(&Edge) -> String| p.edges.iter().map(column).collect::<Vec<_>>().join(" ");
        let by_hand = p.holes.iter().filter(|h| h.by_hand).count();
        let _ = write!(
            out,
            "{},{place},{},{:.1},{:.1},{},{},{},{},{},{by_hand}\r\n",
            p.address,
            fixed(p.thickness),
            p.area,
            p.volume,
            each(&|e| e.side.to_owned()),
            each(&|e| fixed(e.length)),
            each(&|e| fixed(e.chamfer_deg)),
            each(&|e| e.neighbour.clone().unwrap_or_else(|| "-".to_owned())),
            p.holes.len() - by_hand,
        );
    }
    Ok(out.into_bytes())
}

/// Writes the purchased parts as CSV: name, count.
#[must_use]
pub fn write_hardware_csv(features: &FeatureSet) -> Vec<u8> {
    let mut out = String::from("name,count\r\n");
    for h in &features.hardware {
        let _ = write!(out, "\"{}\",{}\r\n", h.name.replace('"', "\"\""), h.count);
    }
    out.into_bytes()
}

/// Three decimals, never `-0.000`.
fn fixed(value: f64) -> String {
    format!("{:.3}", (value * 1e3).round() / 1e3 + 0.0)
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    #[test]
    fn json_lists_what_was_made() {
        let (parts, layout) = (fixture::parts(), fixture::layout());
        let json: serde_json::Value = serde_json::from_slice(&write_pieces_json(&parts, &layout).unwrap()).unwrap();
        let pieces = json["pieces"].as_array().unwrap();
        assert_eq!(pieces.len(), 2, "the panel that could not be made is no piece");
        assert_eq!(pieces[0]["area"], 16_000.0);
        assert_eq!(pieces[0]["edges"][1]["neighbour"], "3.2");
        assert!(pieces[0]["edges"][0]["neighbour"].is_null());
        let lean = pieces[0]["edges"][0]["chamfer_deg"].as_f64().unwrap();
        assert!((lean - 0.2_f64.atan().to_degrees()).abs() < 1e-12);
        assert_eq!(pieces[0]["holes"].as_array().unwrap().len(), 2);
        assert_eq!(pieces[1]["holes"][0]["by_hand"], true);
        assert_eq!(json["total"]["by_hand"], 1);
        assert_eq!(json["hardware"][0]["count"], 7);
        let volume: f64 = pieces.iter().map(|p| p["volume"].as_f64().unwrap()).sum();
        assert_eq!(json["total"]["volume"].as_f64().unwrap(), volume);
    }

    #[test]
    fn csv_has_one_line_per_piece() {
        let (parts, mut layout) = (fixture::parts(), fixture::layout());
        layout.placements.pop();
        let csv = String::from_utf8(write_pieces_csv(&parts, &layout).unwrap()).unwrap();
        let rows: Vec<Vec<&str>> = csv.lines().map(|l| l.split(',').collect()).collect();
        assert_eq!(rows.len(), 3);
        assert!(rows.iter().all(|r| r.len() == rows[0].len()));
        assert_eq!(rows[1][..6], ["3.0", "1", "40.000", "50.000", "0.000", "10.000"]);
        assert_eq!(
            rows[1][8..12],
            ["bottom right top left", "200.000 82.462 200.000 82.462", "11.310 -5.711 16.699 0.000", "- 3.2 - -"]
        );
        assert_eq!(rows[2][..5], ["3.2", "", "", "", ""], "no place found");
    }

    #[test]
    fn hardware_names_keep_their_commas_and_quotes() {
        let csv = write_hardware_csv(&fixture::parts().features);
        assert_eq!(String::from_utf8_lossy(&csv), "name,count\r\n\"Screw 3.5 x 40, \"\"toe\"\"\",7\r\n");
    }
}
