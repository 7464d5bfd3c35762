//! Machining features: what is to be cut into a panel, said without saying how.

use glam::DVec3;
use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// A machining feature in the coordinates of its panel set.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub enum Machining {
    /// A round hole.
    Drill {
        /// Where the hole's axis enters the designed panel.
        entry: DVec3,
        /// Unit direction of drilling, into the wood.
        axis: DVec3,
        /// From `entry` to the deepest point of the hole along `axis`, mm.
        depth: f64,
        /// Diameter, mm.
        diameter: f64,
    },
    /// A slot of rectangular section along a line, open at the surface it lies on.
    Slot {
        /// Start of the slot's floor line.
        from: DVec3,
        /// End of the slot's floor line.
        to: DVec3,
        /// Unit direction from the surface into the wood.
        axis: DVec3,
        /// Width across the line, mm.
        width: f64,
        /// Depth along `axis`, mm.
        depth: f64,
    },
    /// A pocket with flat floor and planar outline.
    Pocket {
        /// Outline on the surface, counter-clockwise seen against `axis`.
        outline: Vec<DVec3>,
        /// Unit direction into the wood.
        axis: DVec3,
        /// Depth, mm.
        depth: f64,
    },
    /// A cut along a polyline, as deep as the stock.
    Contour {
        /// The line on the surface.
        line: Vec<DVec3>,
        /// Unit direction into the wood.
        axis: DVec3,
    },
    /// Text engraved in single strokes.
    Engraving {
        /// Lower left corner of the first glyph on the surface.
        origin: DVec3,
        /// Unit reading direction.
        along: DVec3,
        /// Unit direction into the wood.
        axis: DVec3,
        /// Glyph height, mm.
        height: f64,
        /// Depth of the stroke, mm.
        depth: f64,
        /// The text; see `motion::glyph` for the characters that can be engraved.
        text: String,
    },
}

/// One feature on one panel.
#[derive(Clone, Debug, PartialEq, Serialize, Deserialize)]
pub struct Feature {
    /// Panel index in the set.
    pub panel: u32,
    /// Edge it belongs to, if any.
    pub edge: Option<u32>,
    /// Joint number shared by the features that must meet in space; `None` for a feature that stands alone.
    pub joint: Option<u32>,
    /// What it is for: "toe screw", "toe dowel", "screw", "dowel", "fixing", "address".
    pub purpose: Cow<'static, str>,
    /// The shape.
    pub machining: Machining,
}

/// Purchased parts by name.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Hardware {
    /// Trade name with size, as on the piece list.
    pub name: String,
    /// How many.
    pub count: u64,
}

/// Features of a panel set, ordered by panel, with the hardware that they take and those left to be made by hand.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct FeatureSet {
    /// All features that the machine makes.
    pub features: Vec<Feature>,
    /// Features that the machine cannot reach and that are made by hand.
    pub by_hand: Vec<Feature>,
    /// Purchased parts.
    pub hardware: Vec<Hardware>,
}

impl FeatureSet {
    /// Several sets on the same panels as one, ordered by panel, then set. Joint numbers stay apart, equal hardware adds
    /// up. O(n log n).
    #[must_use]
    pub fn merged<'a>(sets: impl IntoIterator<Item = &'a Self>) -> Self {
        let mut all = Self::default();
        let mut next_joint = 0;
        for set in sets {
            let first = next_joint;
            let renumbered = |f: &Feature| Feature { joint: f.joint.map(|j| j + first), ..f.clone() };
            all.features.extend(set.features.iter().map(renumbered));
            all.by_hand.extend(set.by_hand.iter().map(renumbered));
            let joints = set.features.iter().chain(&set.by_hand).filter_map(|f| f.joint);
            next_joint += joints.max().map_or(0, |j| j + 1);
            for h in &set.hardware {
                match all.hardware.iter_mut().find(|known| known.name == h.name) {
                    Some(known) => known.count += h.count,
                    None => all.hardware.push(h.clone()),
                }
            }
        }
        all.features.sort_by_key(|f| f.panel);
        all.by_hand.sort_by_key(|f| f.panel);
        all
    }
}
