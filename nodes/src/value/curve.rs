//! Curves. JSON `{ "points": [[x, y, z]…], "weights": [w…], "strips": [first point of each strip…, points], "closed" }`;
//! segment names as a list of words such as `1/1221`.

use super::{Carried, xyz};
use serde::{Deserialize, Serialize};
use serde_json::json;
use tenon_engine::{Digester, Json};
use tenon_geometry::ifs::{Curve, Words};

impl Carried for Curve {
    const TYPE: &'static str = "curve";
    fn digest(&self, d: &mut Digester) {
        d.u64(self.points.len() as u64);
        for p in &self.points {
            d.f64s(&p.to_array());
        }
        self.strip_start.iter().for_each(|s| d.u32(*s));
        d.bool(self.closed);
        digest_words(&self.words, d);
    }
    fn heap_bytes(&self) -> usize {
        self.points.len() * 32 + self.strip_start.len() * 4
    }
    fn to_json(&self) -> Json {
        json!({
            "points": self.projected().into_iter().map(xyz).collect::<Vec<_>>(),
            "weights": self.points.iter().map(|p| p.w).collect::<Vec<_>>(),
            "strips": self.strip_start,
            "closed": self.closed,
        })
    }
    fn summary(&self) -> String {
        let kind = if self.closed { "closed curve" } else { "curve" };
        format!("{kind} of {} points in {} strips", self.points.len(), self.strip_count())
    }
}

/// The names of a curve's segments, in drawing order; printed when asked for, never stored.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct SegmentNames {
    /// How segments are named.
    pub words: Words,
    /// Number of segments.
    pub count: usize,
}

impl Carried for SegmentNames {
    const TYPE: &'static str = "addresses";
    fn digest(&self, d: &mut Digester) {
        digest_words(&self.words, d);
        d.u64(self.count as u64);
    }
    fn heap_bytes(&self) -> usize {
        self.words.traversal.letters.len() * 5
    }
    fn to_json(&self) -> Json {
        (0..self.count).map(|s| Json::from(self.words.word(s).to_string())).collect()
    }
    fn summary(&self) -> String {
        format!("{} words of {} letters out of {}", self.count, self.words.digits, self.words.base)
    }
}

fn digest_words(words: &Words, d: &mut Digester) {
    d.u32(words.base);
    d.u32(words.digits);
    d.u32(words.parts);
    words.traversal.letters.iter().for_each(|l| d.u32(*l));
    words.traversal.reversed.iter().for_each(|r| d.bool(*r));
}
