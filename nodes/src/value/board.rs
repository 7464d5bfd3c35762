//! Mapped parts and layouts. JSON of parts: the panels in their part frames, the frames and the features; JSON of a
//! layout: the board, the placements and both outlines per part.

use super::{Carried, digest_points};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::DVec2;
use tenon_geometry::board::{Layout, PartSet, Up};

impl Carried for PartSet {
    const TYPE: &'static str = "parts";
    fn digest(&self, d: &mut Digester) {
        Carried::digest(&self.panels, d);
        Carried::digest(&self.features, d);
        d.u8(self.up as u8);
        for f in &self.frame {
            digest_points(d, &[f.matrix3.x_axis, f.matrix3.y_axis, f.matrix3.z_axis, f.translation]);
        }
    }
    fn heap_bytes(&self) -> usize {
        Carried::heap_bytes(&self.panels) + Carried::heap_bytes(&self.features) + self.frame.len() * 96
    }
    fn to_json(&self) -> Json {
        json!({
            "up": match self.up { Up::Front => "front", Up::Back => "back" },
            "frames": self.frame.iter().map(|f| f.to_cols_array()).collect::<Vec<_>>(),
            "panels": Carried::to_json(&self.panels),
            "features": Carried::to_json(&self.features),
        })
    }
    fn summary(&self) -> String {
        format!("{} mapped, {}", Carried::summary(&self.panels), Carried::summary(&self.features))
    }
}

impl Carried for Layout {
    const TYPE: &'static str = "layout";
    fn digest(&self, d: &mut Digester) {
        for x in [self.board.size.x, self.board.size.y, self.board.thickness, self.board.margin] {
            d.f64(x);
        }
        d.u32(self.boards);
        d.u64(self.placements.len() as u64);
        for p in &self.placements {
            d.u32(p.part);
            d.u32(p.board);
            d.f64(p.offset.x);
            d.f64(p.offset.y);
            d.f64(p.turn);
        }
        for outline in self.piece.iter().chain(&self.cleared) {
            d.u64(outline.len() as u64);
            for p in outline {
                d.f64(p.x);
                d.f64(p.y);
            }
        }
    }
    fn heap_bytes(&self) -> usize {
        let corners: usize = self.piece.iter().chain(&self.cleared).map(Vec::len).sum();
        self.placements.len() * 40 + corners * 16
    }
    fn to_json(&self) -> Json {
        let outlines = |o: &[Vec<DVec2>]| -> Vec<Vec<[f64; 2]>> {
            o.iter().map(|o| o.iter().map(|p| p.to_array()).collect()).collect()
        };
        let placements: Vec<Json> = self
            .placements
            .iter()
            .map(|p| json!({ "part": p.part, "board": p.board, "x": p.offset.x, "y": p.offset.y, "turn": p.turn.to_degrees() }))
            .collect();
        json!({
            "board": { "x": self.board.size.x, "y": self.board.size.y, "thickness": self.board.thickness, "margin": self.board.margin },
            "boards": self.boards,
            "placements": placements,
            "piece": outlines(&self.piece),
            "cleared": outlines(&self.cleared),
        })
    }
    fn summary(&self) -> String {
        format!(
            "{} parts on {} boards of {} × {} mm",
            self.placements.len(),
            self.boards,
            self.board.size.x,
            self.board.size.y
        )
    }
}
