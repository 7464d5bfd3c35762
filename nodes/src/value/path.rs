//! Machining settings and tool paths. JSON of settings: one key per setting, mm; JSON of paths: one object per operation
//! with its moves as rows `[kind, x, y, z, ax, ay, az, feed]` in the part's frame.

use super::{Carried, digest_points};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::motion::{MoveKind, Operation, PartPaths, PathParams, Purpose};

/// What every part's tool paths are on the wire; post puts them on boards.
impl Carried for PartPaths {
    const TYPE: &'static str = "tool_paths";
    fn digest(&self, d: &mut Digester) {
        let p = &self.paths;
        d.u64(p.operations.len() as u64);
        for o in &p.operations {
            d.u8(o.purpose as u8);
            d.u32(o.part);
            d.u32(o.tool);
            d.u32(o.moves.end);
        }
        p.kind.iter().for_each(|k| d.u8(*k as u8));
        digest_points(d, &p.tip);
        digest_points(d, &p.axis);
        d.f64s(&p.feed);
        self.failed.iter().for_each(|f| d.bool(*f));
        d.f64(self.clearance);
    }
    fn heap_bytes(&self) -> usize {
        self.paths.operations.len() * 24 + self.paths.tip.len() * (1 + 24 + 24 + 8) + self.operation_start.len() * 5
    }
    fn to_json(&self) -> Json {
        let p = &self.paths;
        let operation = |o: &Operation| {
            let moves: Vec<Json> = (o.moves.start as usize..o.moves.end as usize)
                .map(|k| {
                    let (t, a) = (p.tip[k], p.axis[k]);
                    json!([kind_text(p.kind[k]), t.x, t.y, t.z, a.x, a.y, a.z, p.feed[k]])
                })
                .collect();
            json!({ "purpose": purpose_text(o.purpose), "part": o.part, "tool": o.tool, "moves": moves })
        };
        json!({ "operations": p.operations.iter().map(operation).collect::<Vec<_>>() })
    }
    fn summary(&self) -> String {
        let failed = self.failed.iter().filter(|f| **f).count();
        let lost = if failed > 0 { format!(", {failed} parts cannot be cut out") } else { String::new() };
        format!(
            "{} operations, {} moves of {} parts{lost}",
            self.paths.operations.len(),
            self.paths.tip.len(),
            self.failed.len()
        )
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
