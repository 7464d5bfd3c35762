//! Panel sets. JSON: one object per panel with its address, loops, chamfers and neighbours; `null` for a failed panel.

use super::{Carried, digest_points, mesh::digest_addresses, xyz};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::panel::{PanelSet, Side};

impl Carried for PanelSet {
    const TYPE: &'static str = "panels";
    fn digest(&self, d: &mut Digester) {
        d.f64(self.thickness);
        digest_addresses(d, &self.address);
        digest_points(d, &self.normal);
        self.corner_start.iter().for_each(|i| d.u32(*i));
        digest_points(d, &self.front);
        self.vertex.iter().for_each(|i| d.u32(*i));
        for plane in &self.chamfer {
            digest_points(d, &[plane.normal]);
            d.f64(plane.offset);
        }
        for n in self.neighbour.iter().map(|n| n.get()) {
            d.u32(n.map_or(u32::MAX, |n| n.panel));
            d.u32(n.map_or(u32::MAX, |n| n.edge));
        }
        self.side.iter().for_each(|s| d.u8(*s as u8));
        digest_points(d, &self.back_start);
        digest_points(d, &self.back_end);
        self.voided.iter().for_each(|v| d.bool(*v));
    }
    fn heap_bytes(&self) -> usize {
        self.len() * (12 + 24 + 4) + self.front.len() * (24 * 3 + 4 + 32 + 12 + 1 + 1)
    }
    fn to_json(&self) -> Json {
        let panel = |i: usize| {
            if !self.is_valid(i) {
                return Json::Null;
            }
            let edges: Vec<Json> = self
                .corners(i)
                .map(|k| {
                    json!({
                        "side": side_text(self.side[k]),
                        "front": xyz(self.front[k]),
                        "back": [xyz(self.back_start[k]), xyz(self.back_end[k])],
                        "chamfer": xyz(self.chamfer[k].normal),
                        "neighbour": self.neighbour[k].get().map(|n| self.address[n.panel as usize].to_string()),
                        "voided": self.voided[k],
                    })
                })
                .collect();
            json!({ "address": self.address[i].to_string(), "normal": xyz(self.normal[i]), "edges": edges })
        };
        json!({ "thickness": self.thickness, "panels": (0..self.len()).map(panel).collect::<Vec<_>>() })
    }
    fn summary(&self) -> String {
        let failed = (0..self.len()).filter(|i| !self.is_valid(*i)).count();
        let lost = if failed > 0 { format!(", {failed} failed") } else { String::new() };
        format!("{} panels, {} mm thick{lost}", self.len(), self.thickness)
    }
}

/// `message` with the address of panel `i` behind it, by which people know it in the structure and on the board.
pub(crate) fn with_address(panels: &PanelSet, i: u32, message: &impl ToString) -> String {
    let message = message.to_string();
    match panels.address.get(i as usize) {
        Some(address) => format!("{message} [address {address}]"),
        None => message,
    }
}

/// A side's name in files.
pub(crate) fn side_text(side: Side) -> &'static str {
    match side {
        Side::Bottom => "bottom",
        Side::Right => "right",
        Side::Top => "top",
        Side::Left => "left",
        Side::Other => "other",
    }
}
