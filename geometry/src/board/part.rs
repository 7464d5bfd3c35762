//! Parts in the machine plane and their places on boards.
//!
//! Part frame: the board's underside is z = 0, its upper side z = thickness; a part's designed faces lie in those two
//! planes. Board frame: origin at the board's lower left corner on the sacrificial layer, x along `Board::size.x`.

use crate::joint::FeatureSet;
use crate::panel::PanelSet;
use glam::{DAffine3, DVec2, DVec3};
use serde::{Deserialize, Serialize};

/// Which face of the panels lies up on the machine.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq, Serialize, Deserialize)]
pub enum Up {
    /// The front face (the designed surface).
    Front,
    /// The back face (thesis: addresses are engraved there).
    #[default]
    Back,
}

/// Panels mapped to the machine plane, one by one: `panels` holds every panel in its own part frame, so that only
/// columns of the same panel may be compared. `panels.neighbour` still tells who meets whom in the model.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct PartSet {
    /// The panels in part frames.
    pub panels: PanelSet,
    /// Features in part frames: fasteners, fixing holes, addresses.
    pub features: FeatureSet,
    /// Rigid motion of determinant +1 per panel, model → part frame.
    pub frame: Vec<DAffine3>,
    /// Which face is up.
    pub up: Up,
}

impl PartSet {
    /// Moves features, by their indices, from the machine's list to the hand-work list, which keeps its order by panel.
    /// Indices that are none are passed over. O(features log features).
    pub fn leave_to_hand(&mut self, features: impl IntoIterator<Item = u32>) {
        let given: std::collections::BTreeSet<u32> = features.into_iter().collect();
        let all = std::mem::take(&mut self.features.features);
        for (k, feature) in all.into_iter().enumerate() {
            let by_hand = given.contains(&(k as u32));
            if by_hand { &mut self.features.by_hand } else { &mut self.features.features }.push(feature);
        }
        self.features.by_hand.sort_by_key(|f| f.panel);
    }
}

/// Raw material on the machine table.
#[derive(Clone, Copy, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Board {
    /// Extent in x and y, mm.
    pub size: DVec2,
    /// Thickness, mm: that of the parts.
    pub thickness: f64,
    /// Border that no part may enter, mm.
    pub margin: f64,
}

/// Where one part lies: `board point = offset + Rz(turn) · part point`.
#[derive(Clone, Copy, Debug, PartialEq, Serialize, Deserialize)]
pub struct Placement {
    /// Part (panel) index.
    pub part: u32,
    /// Board number, from 0.
    pub board: u32,
    /// Translation in the board's plane, mm.
    pub offset: DVec2,
    /// Turn about Z, radians; 0 where the grain matters.
    pub turn: f64,
}

impl Placement {
    /// A point of the part frame in the board frame.
    #[must_use]
    pub fn point(&self, p: DVec3) -> DVec3 {
        self.vector(p) + self.offset.extend(0.0)
    }

    /// A direction of the part frame in the board frame.
    #[must_use]
    pub fn vector(&self, v: DVec3) -> DVec3 {
        if self.turn == 0.0 {
            return v;
        }
        let (s, c) = self.turn.sin_cos();
        DVec3::new(c * v.x - s * v.y, s * v.x + c * v.y, v.z)
    }
}

/// Parts placed on equal boards.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Layout {
    /// The board, the same for all.
    pub board: Board,
    /// Number of boards used.
    pub boards: u32,
    /// Placed parts, ordered by board, then in machining order.
    pub placements: Vec<Placement>,
    /// Work-piece outline `P_i` per part in its part frame (empty for a part that failed), counter-clockwise.
    pub piece: Vec<Vec<DVec2>>,
    /// Cleared outline `C_i` per part in its part frame: all that tools and holders sweep for it.
    pub cleared: Vec<Vec<DVec2>>,
}
