//! Row packing (000 §7.2.2), corrected and made shape-aware: within a row every part slides along the row until it
//! touches, then down onto the rows before it.

use super::convex::{Chains, bounds, clearance, inflate};
use super::pack::{Bounds, Goods, Grain, PackError, Packed, Packer, usable};
use super::part::{Board, Layout, Placement};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::sync::atomic::{AtomicUsize, Ordering};

/// The row method of the thesis. Parts go row by row; a row that is full starts the next one on what stands below,
/// a board that is full (its current row counted) starts the next board. Several orders of the parts and both
/// directions of rows are tried and the best layout kept: fewest boards, then least used of the last one.
///
/// O(n · k) for `n` parts and `k` parts per board, times the number of ways tried.
#[derive(Clone, Copy, Debug, Default, PartialEq, Eq)]
pub struct RowPacker {
    /// Keep the goods' order instead of sorting by size.
    pub keep_order: bool,
}

/// What rounding may add to a sum of board coordinates, mm: a part exactly as large as the board must fit.
const ROUNDING: f64 = 1e-9;

/// Order in which a way takes the parts.
#[derive(Clone, Copy, PartialEq)]
enum Sort {
    Given,
    /// Greatest extent across the rows first.
    Across,
    /// Greatest extent along the rows first.
    Along,
}

/// A part in one of its turns. Coordinates are (along the row, across the rows).
struct Good {
    part: u32,
    turn: f64,
    /// Of what must stay inside.
    low: DVec2,
    high: DVec2,
    /// Of the outline that is cleared, with the gap.
    cleared_low: DVec2,
    cleared_high: DVec2,
    piece: [Chains; 2],
    cleared: [Chains; 2],
}

/// A placed good.
#[derive(Clone, Copy)]
struct Put {
    good: usize,
    board: u32,
    at: DVec2,
}

impl Packer for RowPacker {
    fn pack(&self, goods: &Goods, board: &Board, progress: &(dyn Fn(f64) -> bool + Sync)) -> Result<Packed, PackError> {
        let (lo, hi) = usable(board);
        if !(lo.is_finite() && hi.is_finite() && board.margin >= 0.0 && lo.cmplt(hi).all()) {
            return Err(PackError::NoArea { board: *board });
        }
        if !(goods.gap >= 0.0 && goods.gap.is_finite()) {
            return Err(PackError::Gap { gap: goods.gap });
        }
        let parts: Vec<u32> = goods.order.iter().copied().filter(|i| goods.is_there(*i as usize)).collect();
        let finite = |i: &&u32| {
            let i = **i as usize;
            !goods.piece[i].iter().chain(&goods.cleared[i]).all(|p| p.is_finite())
        };
        if let Some(&part) = parts.iter().find(finite) {
            return Err(PackError::NotFinite { part });
        }
        let ways: Vec<(bool, Sort)> = [false, true]
            .into_iter()
            .flat_map(|flip| [Sort::Given, Sort::Across, Sort::Along].map(|sort| (flip, sort)))
            .filter(|way| !self.keep_order || way.1 == Sort::Given)
            .collect();
        let done = AtomicUsize::new(0);
        let total = ways.len() * parts.len().max(1);
        let tick = || progress(done.fetch_add(1, Ordering::Relaxed) as f64 / total as f64);
        let tried: Vec<Option<Way>> = ways
            .par_iter()
            .map(|&(flip, sort)| {
                let flipped = |p: DVec2| if flip { DVec2::new(p.y, p.x) } else { p };
                Way::try_rows(goods, &parts, flipped(lo), flipped(hi), flip, sort, &tick)
            })
            .collect();
        let mut best: Option<(Way, bool)> = None;
        for (way, (flip, _)) in tried.into_iter().zip(ways) {
            let way = way.ok_or(PackError::Cancelled)?;
            if best.as_ref().is_none_or(|(b, _)| way.score() < b.score()) {
                best = Some((way, flip));
            }
        }
        let Some((way, flip)) = best else { return Err(PackError::NoArea { board: *board }) };
        let placements = way
            .puts
            .iter()
            .map(|p| Placement {
                part: way.goods[p.good].part,
                board: p.board,
                offset: if flip { DVec2::new(p.at.y, p.at.x) } else { p.at },
                turn: way.goods[p.good].turn,
            })
            .collect();
        let layout = Layout {
            board: *board,
            boards: way.boards,
            placements,
            piece: goods.piece.clone(),
            cleared: goods.cleared.clone(),
        };
        Ok(Packed { layout, left_out: way.left_out })
    }
}

/// One way of filling the boards.
struct Way {
    goods: Vec<Good>,
    puts: Vec<Put>,
    boards: u32,
    last_height: f64,
    left_out: Vec<PackError>,
}

impl Way {
    /// Boards, then used extent of the last one.
    fn score(&self) -> (u32, f64) {
        (self.boards, self.last_height)
    }

    /// Fills boards row by row; `None` when cancelled.
    fn try_rows(
        goods: &Goods,
        parts: &[u32],
        lo: DVec2,
        hi: DVec2,
        flip: bool,
        sort: Sort,
        tick: &(dyn Fn() -> bool + Sync),
    ) -> Option<Self> {
        let mut way = Self { goods: Vec::new(), puts: Vec::new(), boards: 0, last_height: 0.0, left_out: Vec::new() };
        // Turns of each part that fit on an empty board, as ranges of `way.goods`.
        let mut choices = Vec::with_capacity(parts.len());
        for &part in parts {
            let from = way.goods.len();
            let mut least = (f64::INFINITY, DVec2::ZERO);
            for turn in turns(goods, part) {
                let good = Good::new(goods, part, turn, flip);
                let size = good.high - good.low;
                let over = (size - (hi - lo)).max_element();
                if over <= ROUNDING {
                    way.goods.push(good);
                } else if over < least.0 {
                    least = (over, size);
                }
            }
            if way.goods.len() == from {
                let back = |p: DVec2| if flip { DVec2::new(p.y, p.x) } else { p };
                let (needed, room) = (back(least.1), back(hi - lo));
                way.left_out.push(PackError::TooLarge {
                    part,
                    needed_x: needed.x,
                    needed_y: needed.y,
                    usable_x: room.x,
                    usable_y: room.y,
                });
            } else {
                choices.push(from..way.goods.len());
            }
        }
        let extent = |c: &std::ops::Range<usize>| way.goods[c.start].high - way.goods[c.start].low;
        match sort {
            Sort::Given => {}
            Sort::Across => choices.sort_by(|a, b| extent(b).y.total_cmp(&extent(a).y)),
            Sort::Along => choices.sort_by(|a, b| extent(b).x.total_cmp(&extent(a).x)),
        }
        // Indices into `puts` where the current board and the current row start.
        let (mut board_start, mut row_start) = (0, 0);
        way.boards = u32::from(!choices.is_empty());
        for choice in choices {
            if !tick() {
                return None;
            }
            loop {
                if let Some((good, at)) = way.best_place(choice.clone(), board_start, row_start, lo, hi) {
                    way.puts.push(Put { good, board: way.boards - 1, at });
                    break;
                }
                if row_start < way.puts.len() {
                    row_start = way.puts.len();
                } else {
                    // Not even at the start of a new row, all rows counted: this board is full. An empty board
                    // always has room, since only turns that fit on it are choices.
                    way.boards += 1;
                    board_start = way.puts.len();
                }
            }
        }
        way.last_height = way.puts[board_start..].iter().map(|p| p.at.y + way.goods[p.good].high.y).fold(0.0, f64::max);
        Some(way)
    }

    /// The turn and place in the current row that ends first; `None` if the row or the board is full.
    fn best_place(
        &self,
        choice: std::ops::Range<usize>,
        board_start: usize,
        row_start: usize,
        lo: DVec2,
        hi: DVec2,
    ) -> Option<(usize, DVec2)> {
        let (below, row) = (&self.puts[board_start..row_start], &self.puts[row_start..]);
        let mut best: Option<(f64, usize, DVec2)> = None;
        for good in choice {
            let g = &self.goods[good];
            let mut at = lo - g.low;
            // Pushing along the row may move the part over higher ground, dropping may bring it beside other parts of
            // the row; both only ever push away, so this settles.
            for _ in 0..64 {
                let x = row.iter().fold(at.x, |x, p| x.max(self.push(p, g, at, 0).unwrap_or(x)));
                at.y =
                    below.iter().fold(lo.y - g.low.y, |y, p| y.max(self.push(p, g, DVec2::new(x, y), 1).unwrap_or(y)));
                let settled = row.iter().all(|p| self.push(p, g, DVec2::new(x, at.y), 0).is_none_or(|v| v <= x));
                at.x = x;
                if settled || at.x + g.high.x > hi.x + ROUNDING {
                    let end = at.x + g.high.x;
                    let fits = settled && (at + g.high).cmple(hi + ROUNDING).all();
                    if fits && best.is_none_or(|b| end < b.0) {
                        best = Some((end, good, at));
                    }
                    break;
                }
            }
        }
        best.map(|(_, good, at)| (good, at))
    }

    /// Least coordinate along `axis` at which `g`, its other coordinate that of `at`, lies beyond the placed good.
    fn push(&self, placed: &Put, g: &Good, at: DVec2, axis: usize) -> Option<f64> {
        let p = &self.goods[placed.good];
        let across = 1 - axis;
        if placed.at[across] + p.cleared_high[across] <= at[across] + g.cleared_low[across]
            || placed.at[across] + p.cleared_low[across] >= at[across] + g.cleared_high[across]
            || placed.at[axis] + p.cleared_high[axis] <= at[axis] + g.cleared_low[axis]
        {
            return None;
        }
        let one = |high: &Chains, low: &Chains| clearance(&high.high, placed.at[across], &low.low, at[across]);
        let a = one(&p.piece[axis], &g.cleared[axis]);
        let b = one(&p.cleared[axis], &g.piece[axis]);
        let shift = match (a, b) {
            (Some(a), Some(b)) => a.max(b),
            (a, b) => a.or(b)?,
        };
        Some(placed.at[axis] + shift)
    }
}

impl Good {
    fn new(goods: &Goods, part: u32, turn: f64, flip: bool) -> Self {
        let spin = Placement { part, board: 0, offset: DVec2::ZERO, turn };
        let seen = |polygon: &[DVec2]| -> Vec<DVec2> {
            let turned = polygon.iter().map(|p| spin.point(p.extend(0.0)).truncate());
            turned.map(|p| if flip { DVec2::new(p.y, p.x) } else { p }).collect()
        };
        let raw = &goods.cleared[part as usize];
        let piece = seen(&goods.piece[part as usize]);
        let cleared = seen(&inflate(raw, goods.gap));
        let span = |p: &[DVec2]| bounds(p).unwrap_or((DVec2::ZERO, DVec2::ZERO));
        let (low, high) = match goods.inside {
            Bounds::Cleared => span(&seen(raw)),
            Bounds::Piece => span(&piece),
        };
        let (cleared_low, cleared_high) = span(&cleared);
        // Along axis 0 (x) the boundaries are functions of y, along axis 1 (y) functions of x.
        let chains = |p: &[DVec2]| [Chains::over_y(p), Chains::over_x(p)];
        Self { part, turn, low, high, cleared_low, cleared_high, piece: chains(&piece), cleared: chains(&cleared) }
    }
}

/// Turns worth trying: as mapped, by half-turns, and without grain by quarters from the longest side along x.
fn turns(goods: &Goods, part: u32) -> Vec<f64> {
    match goods.grain {
        Grain::Directed => vec![0.0],
        Grain::Axis => vec![0.0, PI],
        Grain::Free => {
            let p = &goods.piece[part as usize];
            let longest = (0..p.len())
                .map(|k| p[(k + 1) % p.len()] - p[k])
                .fold(DVec2::ZERO, |best, e| if e.length_squared() > best.length_squared() { e } else { best });
            let base = -longest.to_angle();
            [0.0, 1.0, 2.0, 3.0].into_iter().flat_map(|q| [q * FRAC_PI_2, base + q * FRAC_PI_2]).collect()
        }
    }
}
