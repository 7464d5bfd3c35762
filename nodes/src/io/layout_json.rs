//! The layout as JSON: boards, placements, outlines and frames, for programs that check or draw it.

use super::drawing::{Drawing, DrawnPiece};
use super::lines::{document, json};
use serde::Serialize;
use tenon_geometry::{DAffine3, DVec2};

#[derive(Serialize)]
struct Head<'a> {
    format: &'a str,
    version: u32,
    units: &'a str,
    size: DVec2,
    thickness: f64,
    margin: f64,
    boards: u32,
}

#[derive(Serialize)]
struct Piece<'a> {
    address: &'a str,
    part: u32,
    board: u32,
    offset: DVec2,
    turn_deg: f64,
    frame: [[f64; 4]; 3],
    upper: &'a [DVec2],
    lower: &'a [DVec2],
    piece: &'a [DVec2],
    cleared: &'a [DVec2],
}

/// Writes the layout, one piece a line, shortest round-trip numbers, mm.
///
/// `size`, `thickness`, `margin` are the board's, `boards` how many there are (pieces count them from 0). Per piece:
/// `frame` = 3 × 4 matrix model → part frame, then `offset` and `turn_deg` part frame → board frame; `upper`, `lower`
/// (faces), `piece` (`P_i`) and `cleared` (`C_i`) are polygons in the board's frame. Cost O(corners). Stops early, and what
/// there is then is of no use, when `go` says no.
#[must_use]
pub fn write_layout_json(drawing: &Drawing, go: &dyn Fn() -> bool) -> Vec<u8> {
    let board = drawing.board;
    let head = Head {
        format: "tenon-layout",
        version: 1,
        units: "mm",
        size: board.size,
        thickness: board.thickness,
        margin: board.margin,
        boards: drawing.boards,
    };
    let pieces = drawing.pieces.iter().take_while(|_| go());
    document(&head, "pieces", pieces.map(|p| json(&record(p))))
}

fn record(p: &DrawnPiece) -> Piece<'_> {
    Piece {
        address: &p.address,
        part: p.part,
        board: p.placement.board,
        offset: p.placement.offset,
        turn_deg: p.placement.turn.to_degrees(),
        frame: rows(&p.frame),
        upper: &p.upper,
        lower: &p.lower,
        piece: &p.piece,
        cleared: &p.cleared,
    }
}

fn rows(frame: &DAffine3) -> [[f64; 4]; 3] {
    [0, 1, 2].map(|r| {
        let m = frame.matrix3.row(r);
        [m.x, m.y, m.z, frame.translation[r]]
    })
}

#[cfg(test)]
mod tests {
    use super::super::{draw, fixture};
    use super::*;

    #[test]
    fn says_where_everything_lies() {
        let json = write_layout_json(&draw(&fixture::parts(), &fixture::layout()).unwrap(), &|| true);
        let json: serde_json::Value = serde_json::from_slice(&json).unwrap();
        assert_eq!(json["size"], serde_json::json!([400.0, 300.0]));
        let second = &json["pieces"][1];
        assert_eq!((&second["address"], &second["board"]), (&"3.2".into(), &1.into()));
        assert_eq!(second["turn_deg"], 90.0);
        assert_eq!(second["frame"][1], serde_json::json!([0.0, 1.0, 0.0, 2.0]));
        assert_eq!(second["piece"].as_array().unwrap().len(), 4);
    }
}
