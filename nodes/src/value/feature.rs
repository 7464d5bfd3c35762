//! Machining features. JSON: lists of features by machine and by hand, and the hardware they take.

use super::{Carried, digest_points, xyz};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::joint::{Feature, FeatureSet, Machining};

impl Carried for FeatureSet {
    const TYPE: &'static str = "features";
    fn digest(&self, d: &mut Digester) {
        for (list, features) in [(0, &self.features), (1, &self.by_hand)] {
            d.u8(list);
            d.u64(features.len() as u64);
            features.iter().for_each(|f| digest_feature(f, d));
        }
        d.u64(self.hardware.len() as u64);
        for h in &self.hardware {
            d.str(&h.name);
            d.u64(h.count);
        }
    }
    fn heap_bytes(&self) -> usize {
        (self.features.len() + self.by_hand.len()) * size_of::<Feature>() + self.hardware.len() * 64
    }
    fn to_json(&self) -> Json {
        json!({
            "features": self.features.iter().map(feature_json).collect::<Vec<_>>(),
            "by_hand": self.by_hand.iter().map(feature_json).collect::<Vec<_>>(),
            "hardware": self.hardware.iter().map(|h| json!({ "name": h.name, "count": h.count })).collect::<Vec<_>>(),
        })
    }
    fn summary(&self) -> String {
        let mut text = format!("{} features", self.features.len());
        if !self.by_hand.is_empty() {
            text += &format!(", {} by hand", self.by_hand.len());
        }
        for h in &self.hardware {
            text += &format!(", {} × {}", h.count, h.name);
        }
        text
    }
}

fn digest_feature(f: &Feature, d: &mut Digester) {
    d.u32(f.panel);
    d.u32(f.edge.unwrap_or(u32::MAX));
    d.u32(f.joint.unwrap_or(u32::MAX));
    d.str(&f.purpose);
    match &f.machining {
        Machining::Drill { entry, axis, depth, diameter } => {
            d.u8(0);
            digest_points(d, &[*entry, *axis]);
            d.f64(*depth);
            d.f64(*diameter);
        }
        Machining::Slot { from, to, axis, width, depth } => {
            d.u8(1);
            digest_points(d, &[*from, *to, *axis]);
            d.f64(*width);
            d.f64(*depth);
        }
        Machining::Pocket { outline, axis, depth } => {
            d.u8(2);
            digest_points(d, outline);
            digest_points(d, &[*axis]);
            d.f64(*depth);
        }
        Machining::Contour { line, axis } => {
            d.u8(3);
            digest_points(d, line);
            digest_points(d, &[*axis]);
        }
        Machining::Engraving { origin, along, axis, height, depth, text } => {
            d.u8(4);
            digest_points(d, &[*origin, *along, *axis]);
            d.f64(*height);
            d.f64(*depth);
            d.str(text);
        }
    }
}

fn feature_json(f: &Feature) -> Json {
    let shape = match &f.machining {
        Machining::Drill { entry, axis, depth, diameter } => {
            json!({ "kind": "drill", "entry": xyz(*entry), "axis": xyz(*axis), "depth": depth, "diameter": diameter })
        }
        Machining::Slot { from, to, axis, width, depth } => json!({
            "kind": "slot", "from": xyz(*from), "to": xyz(*to), "axis": xyz(*axis), "width": width, "depth": depth
        }),
        Machining::Pocket { outline, axis, depth } => json!({
            "kind": "pocket", "outline": outline.iter().map(|p| xyz(*p)).collect::<Vec<_>>(), "axis": xyz(*axis), "depth": depth
        }),
        Machining::Contour { line, axis } => json!({
            "kind": "contour", "line": line.iter().map(|p| xyz(*p)).collect::<Vec<_>>(), "axis": xyz(*axis)
        }),
        Machining::Engraving { origin, along, axis, height, depth, text } => json!({
            "kind": "engraving", "origin": xyz(*origin), "along": xyz(*along), "axis": xyz(*axis), "height": height,
            "depth": depth, "text": text
        }),
    };
    json!({ "panel": f.panel, "edge": f.edge, "joint": f.joint, "purpose": f.purpose, "shape": shape })
}
