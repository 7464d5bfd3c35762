//! Machining settings and tool paths. JSON of settings: one key per setting, mm; JSON of paths: one object per operation with its moves as rows `[kind, x, y, z, ax, ay, az, feed]`.

use super::{Carried, digest_points};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::motion::{MoveKind, PartPaths, PathParams, Purpose, ToolPaths};

impl Carried for ToolPaths {
    const TYPE: &'static str = "tool_paths";
    fn digest(&self, d: &mut Digester) {
        d.u64(self.operations.len() as u64);
        for o in &self.operations {
            d.u8(o.purpose as u8);
            d.u32(o.board);
            d.u32(o.part);
            d.u32(o.tool);
            d.u32(o.moves.start);
            d.u32(o.moves.end);
        }
        self.kind.iter().for_each(|k| d.u8(*k as u8));
        digest_points(d, &self.tip);
        digest_points(d, &self.axis);
        d.f64s(&self.feed);
    }
    fn heap_bytes(&self) -> usize {
        self.operations.len() * 24 + self.tip.len() * (1 + 24 + 24 + 8)
    }
    fn to_json(&self) -> Json {
        let operation = |o: &tenon_geometry::motion::Operation| {
            let moves: Vec<Json> = (o.moves.start as usize..o.moves.end as usize)
                .map(|k| {
                    let (t, a) = (self.tip[k], self.axis[k]);
                    json!([kind_text(self.kind[k]), t.x, t.y, t.z, a.x, a.y, a.z, self.feed[k]])
                })
                .collect();
            json!({ "purpose": purpose_text(o.purpose), "board": o.board, "part": o.part, "tool": o.tool, "moves": moves })
        };
        json!({ "operations": self.operations.iter().map(operation).collect::<Vec<_>>() })
    }
    fn summary(&self) -> String {
        format!("{} operations, {} moves", self.operations.len(), self.tip.len())
    }
}

fn kind_text(kind: MoveKind) -> &'static str {
    match kind {
        MoveKind::Rapid => "rapid",
        MoveKind::Approach => "approach",
        MoveKind::Plunge => "plunge",
        MoveKind::Cut => "cut",
        MoveKind::Lift => "lift",
    }
}

fn purpose_text(purpose: Purpose) -> &'static str {
    match purpose {
        Purpose::Fixing => "fixing",
        Purpose::Engraving => "engraving",
        Purpose::Drilling => "drilling",
        Purpose::Contour => "contour",
    }
}

impl Carried for PathParams {
    const TYPE: &'static str = "machining";
    fn digest(&self, d: &mut Digester) {
        d.u64(self.contour_tool.map_or(0, |t| u64::from(t) + 1));
        d.f64s(&[self.overrun, self.corner_overrun, self.max_step, self.clearance, self.through]);
        d.f64(self.peck.unwrap_or(0.0));
    }
    fn heap_bytes(&self) -> usize {
        0
    }
    fn to_json(&self) -> Json {
        json!({
            "contour_tool": self.contour_tool, "overrun": self.overrun, "corner_overrun": self.corner_overrun,
            "max_step": self.max_step, "clearance": self.clearance, "through": self.through, "peck": self.peck,
        })
    }
    fn summary(&self) -> String {
        format!("passes of {} mm, {} mm overrun", self.max_step, self.overrun)
    }
}

impl Carried for PartPaths {
    const TYPE: &'static str = "part_paths";
    fn digest(&self, d: &mut Digester) {
        Carried::digest(&self.paths, d);
        self.operation_start.iter().for_each(|o| d.u32(*o));
        self.failed.iter().for_each(|f| d.bool(*f));
        d.f64(self.clearance);
    }
    fn heap_bytes(&self) -> usize {
        Carried::heap_bytes(&self.paths) + self.operation_start.len() * 5
    }
    fn to_json(&self) -> Json {
        Carried::to_json(&self.paths)
    }
    fn summary(&self) -> String {
        let failed = self.failed.iter().filter(|f| **f).count();
        let lost = if failed > 0 { format!(", {failed} parts cannot be cut out") } else { String::new() };
        format!("{} of {} parts{lost}", Carried::summary(&self.paths), self.failed.len())
    }
}
