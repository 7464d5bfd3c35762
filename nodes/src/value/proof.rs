//! Proofs. JSON: per program whether it passed and why not; per part its largest gouge and leftover.

use super::Carried;
use serde_json::json;
use tenon_engine::{Digester, Json, stop};
use tenon_geometry::proof::ProofReport;

impl Carried for ProofReport {
    const TYPE: &'static str = "proof";
    fn digest(&self, d: &mut Digester) {
        for p in &self.programs {
            d.str(&p.name);
            d.u32(p.board);
            d.bool(p.passed);
            d.u64(p.motions as u64);
            d.u64(p.omitted as u64);
            p.reasons.iter().for_each(|r| d.str(&r.to_string()));
        }
        for p in &self.parts {
            d.bool(p.is_some());
            if let Some(p) = p {
                d.u32(p.board);
                d.f64s(&[p.gouge, p.leftover]);
            }
        }
    }
    fn heap_bytes(&self) -> usize {
        self.parts.len() * 160 + self.programs.iter().map(|p| 96 + p.reasons.len() * 160).sum::<usize>()
    }
    fn to_json(&self) -> Json {
        let programs: Vec<Json> = self
            .programs
            .iter()
            .inspect(|_| stop::check())
            .map(|p| {
                json!({
                    "name": p.name, "board": p.board, "pass": p.passed, "motions": p.motions,
                    "reasons": p.reasons.iter().map(ToString::to_string).collect::<Vec<_>>(), "omitted": p.omitted,
                })
            })
            .collect();
        let parts: Vec<Json> = self
            .parts
            .iter()
            .inspect(|_| stop::check())
            .map(|p| match p {
                Some(p) => json!({
                    "part": p.part, "board": p.board, "pass": p.passed,
                    "gouge": p.gouge, "gouge_line": p.gouge_line, "gouge_at": p.gouge_at.to_array(),
                    "leftover": p.leftover, "leftover_face": p.leftover_face.map(|f| f.to_string()),
                    "leftover_at": p.leftover_at.to_array(),
                }),
                None => Json::Null,
            })
            .collect();
        json!({
            "pass": self.passed(), "gouge": self.gouge(), "leftover": self.leftover(), "programs": programs,
            "panels": parts,
        })
    }
    fn summary(&self) -> String {
        let passed = self.programs.iter().filter(|p| p.passed).count();
        format!(
            "{passed} of {} programs passed, largest gouge {:.4} mm, largest leftover {:.4} mm",
            self.programs.len(),
            self.gouge(),
            self.leftover()
        )
    }
}
