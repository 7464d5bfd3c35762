//! The packing problem (000 §7.2, METHODS §7): goods, the interface that every packer implements, and the check that
//! a layout is valid.

use super::convex::{bounds, separation};
use super::facet::piece_outline;
use super::outline::cleared_outlines;
use super::part::{Board, Layout, PartSet, Placement};
use crate::machine::Machine;
use crate::motion::PartPaths;
use glam::DVec2;

/// How parts may be turned on the board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Grain {
    /// The grain has a direction: translations only.
    Directed,
    /// The grain has an axis: half-turns too.
    Axis,
    /// No grain: any turn.
    Free,
}

/// What must stay inside the usable board.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Bounds {
    /// The cleared outlines: no tool passes over the border.
    Cleared,
    /// The work pieces only: tools may cut over the board's edge.
    Piece,
}

/// What is to be packed, as columns by part.
#[derive(Clone, Debug, PartialEq)]
pub struct Goods {
    /// Work-piece outlines `P_i`, part frame, convex, counter-clockwise; empty: nothing to pack.
    pub piece: Vec<Vec<DVec2>>,
    /// Cleared outlines `C_i ⊇ P_i`, part frame, convex, counter-clockwise; empty: nothing to pack.
    pub cleared: Vec<Vec<DVec2>>,
    /// Part indices in the order in which they should be packed, as far as the packer keeps an order.
    pub order: Vec<u32>,
    /// Allowed turns.
    pub grain: Grain,
    /// What must stay inside the usable board.
    pub inside: Bounds,
    /// Least distance between any `P_i` and any other `C_j`, mm.
    pub gap: f64,
}

impl Goods {
    /// Goods in the order of their indices, translations only, cleared outlines inside, 0.5 mm apart.
    #[must_use]
    pub fn new(piece: Vec<Vec<DVec2>>, cleared: Vec<Vec<DVec2>>) -> Self {
        let order = (0..piece.len().min(cleared.len()) as u32).collect();
        Self { piece, cleared, order, grain: Grain::Directed, inside: Bounds::Cleared, gap: 0.5 }
    }

    /// The goods of a part set and its tool paths: work pieces and what is cleared to make them, a part that cannot
    /// be cut out left empty. O(moves).
    /// Stops early when `go` says no, and what there is then is of no use.
    #[must_use]
    pub fn of_parts(parts: &PartSet, paths: &PartPaths, machine: &Machine, go: &(dyn Fn() -> bool + Sync)) -> Self {
        let failed = |i: usize| paths.failed.get(i).copied().unwrap_or(true);
        let outline = |i| if failed(i) || !go() { Vec::new() } else { piece_outline(&parts.panels, i) };
        let piece: Vec<Vec<DVec2>> = (0..parts.panels.len()).map(outline).collect();
        let cleared = cleared_outlines(&piece, paths, machine, parts.panels.thickness + paths.clearance, go);
        Self::new(piece, cleared)
    }

    /// Whether part `i` has outlines.
    #[must_use]
    pub fn is_there(&self, i: usize) -> bool {
        self.piece.get(i).is_some_and(|p| p.len() > 2) && self.cleared.get(i).is_some_and(|c| c.len() > 2)
    }
}

/// Why packing failed.
#[derive(Clone, Debug, PartialEq, thiserror::Error)]
pub enum PackError {
    /// A part does not fit on an empty board; it is left out.
    #[error(
        "part {part} is larger than the board: with its tools it needs {needed_x:.1} × {needed_y:.1} mm, the usable \
         board is {usable_x:.1} × {usable_y:.1} mm"
    )]
    TooLarge {
        /// Part index.
        part: u32,
        /// Extent along x in the turn that fits best, mm.
        needed_x: f64,
        /// Extent along y, mm.
        needed_y: f64,
        /// Usable extent, mm.
        usable_x: f64,
        /// Usable extent, mm.
        usable_y: f64,
    },
    /// The board has no usable area.
    #[error("a board of {} × {} mm with a margin of {} mm has no usable area", board.size.x, board.size.y, board.margin)]
    NoArea {
        /// The board.
        board: Board,
    },
    /// The gap is negative or no number.
    #[error("the gap between parts is {gap} mm; it must be 0 or more")]
    Gap {
        /// Given gap, mm.
        gap: f64,
    },
    /// An outline has a coordinate that is no number.
    #[error("the outline of part {part} has a coordinate that is not finite")]
    NotFinite {
        /// Part index.
        part: u32,
    },
    /// The caller cancelled.
    #[error("cancelled")]
    Cancelled,
}

/// A layout and the parts that had to be left out of it.
#[derive(Clone, Debug, PartialEq)]
pub struct Packed {
    /// The layout of all others.
    pub layout: Layout,
    /// One error per part that was left out.
    pub left_out: Vec<PackError>,
}

/// A way of laying goods on boards. Deterministic: same goods, same layout.
pub trait Packer {
    /// Packs all goods that are there. A valid layout keeps `P_i ∩ C_j = ∅` for all i ≠ j on a board and what
    /// `goods.inside` names within the usable board.
    ///
    /// # Errors
    /// A board without area, bad numbers, or cancellation; a part that is too large is left out and reported in
    /// [`Packed::left_out`].
    fn pack(&self, goods: &Goods, board: &Board, progress: &(dyn Fn(f64) -> bool + Sync)) -> Result<Packed, PackError>;
}

/// A fault of a layout.
#[derive(Clone, Copy, Debug, PartialEq, thiserror::Error)]
pub enum LayoutFault {
    /// A tool that makes one part enters another.
    #[error("making part {cleared} clears {depth:.3} mm of part {piece} on board {board}")]
    Overlap {
        /// Board.
        board: u32,
        /// Part that is entered.
        piece: u32,
        /// Part whose tools enter.
        cleared: u32,
        /// Depth of the overlap, mm.
        depth: f64,
    },
    /// A part leaves the usable board.
    #[error("part {part} on board {board} stands {by:.3} mm out of the usable board")]
    Outside {
        /// Board.
        board: u32,
        /// Part.
        part: u32,
        /// By how much, mm.
        by: f64,
    },
}

/// Checks a layout from its outlines alone, by another method than packers use: separating axes of every pair whose
/// boxes meet. Tolerance: `slack` mm. O(p log p + pairs of meeting boxes).
#[must_use]
pub fn check_layout(layout: &Layout, inside: Bounds, slack: f64) -> Vec<LayoutFault> {
    let mut faults = Vec::new();
    let (lo, hi) = usable(&layout.board);
    let outline = |p: &Placement, of: &[Vec<DVec2>]| -> Vec<DVec2> {
        of[p.part as usize].iter().map(|v| p.point(v.extend(0.0)).truncate()).collect()
    };
    for board in 0..layout.boards {
        let mut placed: Vec<_> = layout
            .placements
            .iter()
            .filter(|p| p.board == board)
            .filter_map(|p| {
                let (piece, cleared) = (outline(p, &layout.piece), outline(p, &layout.cleared));
                let span = bounds(&[piece.clone(), cleared.clone()].concat())?;
                Some((p.part, piece, cleared, span))
            })
            .collect();
        placed.sort_by(|a, b| a.3.0.x.total_cmp(&b.3.0.x));
        for (k, (part, piece, cleared, span)) in placed.iter().enumerate() {
            let kept = if inside == Bounds::Cleared { cleared } else { piece };
            if let Some((a, b)) = bounds(kept) {
                let by = (lo - a).max(b - hi).max_element();
                if by > slack {
                    faults.push(LayoutFault::Outside { board, part: *part, by });
                }
            }
            for (other, other_piece, other_cleared, other_span) in &placed[k + 1..] {
                if other_span.0.x > span.1.x {
                    break;
                }
                for (pp, p, cp, c) in [(part, piece, other, other_cleared), (other, other_piece, part, cleared)] {
                    let apart = separation(p, c);
                    if apart < -slack {
                        faults.push(LayoutFault::Overlap { board, piece: *pp, cleared: *cp, depth: -apart });
                    }
                }
            }
        }
    }
    faults
}

/// Corners of the usable board: the board without its margin.
pub(super) fn usable(board: &Board) -> (DVec2, DVec2) {
    (DVec2::splat(board.margin), board.size - DVec2::splat(board.margin))
}
