//! Row packing (000 §7.2.2), corrected and made shape-aware: within a row every part slides along the row until it
//! touches, then down onto the rows before it.

use super::convex::{Chains, bounds, clearance, inflate};
use super::pack::{Bounds, Goods, Grain, PackError, Packed, Packer, usable};
use super::part::{Board, Layout, Placement};
use glam::DVec2;
use rayon::prelude::*;
use std::f64::consts::{FRAC_PI_2, PI};
use std::ops::Range;
use std::sync::atomic::{AtomicUsize, Ordering};

/// The row method of the thesis. Parts go row by row; a row that is full starts the next one on what stands below,
/// a board that is full (its current row counted) starts the next board. Several orders of the parts and both
/// directions of rows are tried and the best layout kept: fewest boards, then least used of the last one.
///
/// O(n · (parts per row + rows per board)) for `n` parts, times the number of ways tried (at most 6).
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

/// A part in one of its turns. Arrays are by axis of motion, x then y: a motion along x is stopped by boundaries that
/// are functions of y.
struct Good {
    part: u32,
    turn: f64,
    /// Box of what must stay inside the board.
    low: DVec2,
    high: DVec2,
    /// Box of the cleared outline with the gap.
    cleared_low: DVec2,
    cleared_high: DVec2,
    piece: [Chains; 2],
    cleared: [Chains; 2],
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
        let broken = |i: &&u32| {
            let i = **i as usize;
            !goods.piece[i].iter().chain(&goods.cleared[i]).all(|p| p.is_finite())
        };
        if let Some(&part) = parts.iter().find(broken) {
            return Err(PackError::NotFinite { part });
        }
        let fit = |(i, part): (usize, &u32)| {
            // A callback per part would cost more than the part.
            if i.is_multiple_of(64) && !progress(0.0) { Err(PackError::Cancelled) } else { fit(goods, *part, lo, hi) }
        };
        let fitted: Vec<Result<Vec<Good>, PackError>> = parts.par_iter().enumerate().map(fit).collect();
        let (mut all, mut choices, mut left_out) = (Vec::new(), Vec::with_capacity(parts.len()), Vec::new());
        for result in fitted {
            match result {
                Ok(turns) => {
                    choices.push(all.len()..all.len() + turns.len());
                    all.extend(turns);
                }
                Err(PackError::Cancelled) => return Err(PackError::Cancelled),
                Err(error) => left_out.push(error),
            }
        }
        let ways: Vec<(usize, Sort)> = [0, 1]
            .into_iter()
            .flat_map(|along| [Sort::Given, Sort::Across, Sort::Along].map(|sort| (along, sort)))
            .filter(|way| !self.keep_order || way.1 == Sort::Given)
            .collect();
        let done = AtomicUsize::new(0);
        let total = ways.len() * choices.len().max(1);
        let tick = || progress(done.fetch_add(1, Ordering::Relaxed) as f64 / total as f64);
        let tried: Vec<Option<Way>> =
            ways.par_iter().map(|&(along, sort)| Way::new(&all, along, lo, hi).fill(&choices, sort, &tick)).collect();
        let mut best: Option<Way> = None;
        for way in tried {
            let way = way.ok_or(PackError::Cancelled)?;
            if best.as_ref().is_none_or(|b| way.score() < b.score()) {
                best = Some(way);
            }
        }
        let (puts, boards) = best.map_or((Vec::new(), 0), |way| (way.puts, way.boards));
        let placements = puts
            .iter()
            .map(|p| Placement { part: all[p.good].part, board: p.board, offset: p.at, turn: all[p.good].turn })
            .collect();
        let (piece, cleared) = (goods.piece.clone(), goods.cleared.clone());
        Ok(Packed { layout: Layout { board: *board, boards, placements, piece, cleared }, left_out })
    }
}

/// All turns of a part that fit on an empty board.
fn fit(goods: &Goods, part: u32, lo: DVec2, hi: DVec2) -> Result<Vec<Good>, PackError> {
    let room = hi - lo;
    let all: Vec<Good> = turns(goods, part).into_iter().map(|turn| Good::new(goods, part, turn)).collect();
    let over = |g: &Good| (g.high - g.low - room).max_element();
    let least = all.iter().min_by(|a, b| over(a).total_cmp(&over(b))).map(|g| (over(g), g.high - g.low));
    match least {
        Some((by, size)) if by > ROUNDING => {
            Err(PackError::TooLarge { part, needed_x: size.x, needed_y: size.y, usable_x: room.x, usable_y: room.y })
        }
        _ => Ok(all.into_iter().filter(|g| over(g) <= ROUNDING).collect()),
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

impl Good {
    fn new(goods: &Goods, part: u32, turn: f64) -> Self {
        let spin = Placement { part, board: 0, offset: DVec2::ZERO, turn };
        let seen = |p: &[DVec2]| -> Vec<DVec2> { p.iter().map(|p| spin.point(p.extend(0.0)).truncate()).collect() };
        let span = |p: &[DVec2]| bounds(p).unwrap_or((DVec2::ZERO, DVec2::ZERO));
        let chains = |p: &[DVec2]| [Chains::over_y(p), Chains::over_x(p)];
        let piece = seen(&goods.piece[part as usize]);
        let raw = seen(&goods.cleared[part as usize]);
        let cleared = inflate(&raw, goods.gap);
        let (low, high) = match goods.inside {
            Bounds::Cleared => span(&raw),
            Bounds::Piece => span(&piece),
        };
        let (cleared_low, cleared_high) = span(&cleared);
        let (piece, cleared) = (chains(&piece), chains(&cleared));
        Self { part, turn, low, high, cleared_low, cleared_high, piece, cleared }
    }
}

/// A placed good.
#[derive(Clone, Copy)]
struct Put {
    good: usize,
    board: u32,
    at: DVec2,
}

/// One way of filling the boards.
struct Way<'a> {
    goods: &'a [Good],
    /// Axis along the rows: 0 is x, 1 is y.
    along: usize,
    lo: DVec2,
    hi: DVec2,
    puts: Vec<Put>,
    boards: u32,
    /// Used extent of the last board across the rows, as a share of the usable board.
    last_used: f64,
    /// Of the current board: where its puts and its current row start.
    board_start: usize,
    row_start: usize,
    /// Finished rows of the current board by stretches of the row axis: puts that reach into each stretch.
    shelves: Vec<Vec<usize>>,
    shelf_width: f64,
}

impl<'a> Way<'a> {
    fn new(goods: &'a [Good], along: usize, lo: DVec2, hi: DVec2) -> Self {
        let extent = |g: &Good| g.cleared_high[along] - g.cleared_low[along];
        let mean = goods.iter().map(extent).sum::<f64>() / goods.len().max(1) as f64;
        let count = ((hi - lo)[along] / mean.max(ROUNDING)).ceil().clamp(1.0, 4096.0) as usize;
        Self {
            goods,
            along,
            lo,
            hi,
            puts: Vec::with_capacity(goods.len()),
            boards: 0,
            last_used: 0.0,
            board_start: 0,
            row_start: 0,
            shelves: vec![Vec::new(); count],
            shelf_width: (hi - lo)[along] / count as f64,
        }
    }

    /// Boards, then used extent of the last one.
    fn score(&self) -> (u32, f64) {
        (self.boards, self.last_used)
    }

    /// Fills boards row by row; `None` when cancelled.
    fn fill(mut self, choices: &[Range<usize>], sort: Sort, tick: &(dyn Fn() -> bool + Sync)) -> Option<Self> {
        let axis = if sort == Sort::Along { self.along } else { 1 - self.along };
        let extent = |c: &Range<usize>| self.goods[c.start].high[axis] - self.goods[c.start].low[axis];
        let mut order: Vec<(f64, &Range<usize>)> = choices.iter().map(|c| (extent(c), c)).collect();
        if sort != Sort::Given {
            order.sort_by(|a, b| b.0.total_cmp(&a.0));
        }
        self.boards = u32::from(!order.is_empty());
        for (_, choice) in order {
            if !tick() {
                return None;
            }
            let (good, at) = loop {
                if let Some(found) = self.best_place(choice.clone()) {
                    break found;
                }
                if self.row_start < self.puts.len() {
                    self.end_row();
                } else {
                    // Not even at the start of a new row, all rows counted: this board is full. An empty board has
                    // room for every choice.
                    self.end_board();
                }
            };
            self.puts.push(Put { good, board: self.boards - 1, at });
        }
        let across = 1 - self.along;
        let used = self.puts[self.board_start..].iter().map(|p| p.at[across] + self.goods[p.good].high[across]);
        self.last_used = (used.fold(0.0, f64::max) - self.lo[across]) / (self.hi - self.lo)[across];
        Some(self)
    }

    fn end_row(&mut self) {
        for put in self.row_start..self.puts.len() {
            let (p, g) = (&self.puts[put], &self.goods[self.puts[put].good]);
            let stretch = self.stretch(p.at[self.along] + g.cleared_low[self.along], g);
            for shelf in &mut self.shelves[stretch] {
                shelf.push(put);
            }
        }
        self.row_start = self.puts.len();
    }

    fn end_board(&mut self) {
        self.boards += 1;
        self.board_start = self.puts.len();
        self.row_start = self.puts.len();
        self.shelves.iter_mut().for_each(Vec::clear);
    }

    /// Shelves that a good whose cleared box starts at `from` reaches into.
    fn stretch(&self, from: f64, g: &Good) -> Range<usize> {
        let shelf = |s: f64| ((s - self.lo[self.along]) / self.shelf_width).floor().max(0.0) as usize;
        let last = self.shelves.len() - 1;
        let width = g.cleared_high[self.along] - g.cleared_low[self.along];
        shelf(from).min(last)..(shelf(from + width) + 1).min(last + 1)
    }

    /// The turn and place in the current row that ends first; `None` if the row or the board is full.
    fn best_place(&self, choice: Range<usize>) -> Option<(usize, DVec2)> {
        let (along, across) = (self.along, 1 - self.along);
        let mut best: Option<(f64, usize, DVec2)> = None;
        for good in choice {
            let g = &self.goods[good];
            let mut at = self.lo - g.low;
            // Pushing along the row may bring the part over higher ground, lifting or dropping it beside other parts of
            // the row. The push never goes back, so this ends; a part that has not settled by then starts a new row.
            for _ in 0..64 {
                at[along] = self.push_along_row(g, at);
                at[across] = self.drop_on_rows(g, at);
                let end = at[along] + g.high[along];
                let settled = self.push_along_row(g, at) <= at[along];
                if settled && (at + g.high).cmple(self.hi + ROUNDING).all() && best.is_none_or(|b| end < b.0) {
                    best = Some((end, good, at));
                }
                if settled || end > self.hi[along] + ROUNDING {
                    break;
                }
            }
        }
        best.map(|(_, good, at)| (good, at))
    }

    /// Where `g`, moved from `at` along the row, is beyond all parts of the current row.
    fn push_along_row(&self, g: &Good, at: DVec2) -> f64 {
        self.puts[self.row_start..].iter().rev().fold(at, |at, p| self.pushed(p, g, at, self.along))[self.along]
    }

    /// Where `g`, dropped at `at` from above, comes to lie on the finished rows.
    fn drop_on_rows(&self, g: &Good, at: DVec2) -> f64 {
        let across = 1 - self.along;
        let mut at = at;
        at[across] = self.lo[across] - g.low[across];
        for shelf in &self.shelves[self.stretch(at[self.along] + g.cleared_low[self.along], g)] {
            at = shelf.iter().rev().fold(at, |at, p| self.pushed(&self.puts[*p], g, at, across));
        }
        at[across]
    }

    /// `at`, moved along `axis` as little as possible so that `g` there lies beyond the placed good.
    fn pushed(&self, placed: &Put, g: &Good, mut at: DVec2, axis: usize) -> DVec2 {
        let p = &self.goods[placed.good];
        let across = 1 - axis;
        if placed.at[axis] + p.cleared_high[axis] <= at[axis] + g.cleared_low[axis]
            || placed.at[across] + p.cleared_high[across] <= at[across] + g.cleared_low[across]
            || placed.at[across] + p.cleared_low[across] >= at[across] + g.cleared_high[across]
        {
            return at;
        }
        for (stands, comes) in [(&p.piece, &g.cleared), (&p.cleared, &g.piece)] {
            let shift = clearance(&stands[axis].high, placed.at[across], &comes[axis].low, at[across]);
            at[axis] = shift.map_or(at[axis], |s| at[axis].max(placed.at[axis] + s));
        }
        at
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::check_layout;
    use crate::board::convex::{area, hull};
    use proptest::prelude::*;

    fn go(_: f64) -> bool {
        true
    }

    fn board(x: f64, y: f64, margin: f64) -> Board {
        Board { size: DVec2::new(x, y), thickness: 10.0, margin }
    }

    fn rectangle(x: f64, y: f64) -> Vec<DVec2> {
        vec![DVec2::ZERO, DVec2::new(x, 0.0), DVec2::new(x, y), DVec2::new(0.0, y)]
    }

    /// Goods of the given pieces, cleared by `by` around.
    fn goods(piece: Vec<Vec<DVec2>>, by: f64) -> Goods {
        let cleared = piece.iter().map(|p| inflate(p, by)).collect();
        Goods { gap: 0.0, ..Goods::new(piece, cleared) }
    }

    fn polygon() -> impl Strategy<Value = Vec<DVec2>> {
        let point = (-60.0..60.0f64, -40.0..40.0f64).prop_map(|(x, y)| DVec2::new(x, y));
        prop::collection::vec(point, 3..9).prop_map(|p| hull(&p)).prop_filter("has area", |p| area(p) > 10.0)
    }

    proptest! {
        #![proptest_config(ProptestConfig::with_cases(64))]

        #[test]
        fn layouts_are_valid_complete_and_repeatable(
            pieces in prop::collection::vec(polygon(), 1..60),
            by in 0.0..15.0f64,
            gap in 0.0..2.0f64,
            grain in prop::sample::select(vec![Grain::Directed, Grain::Axis, Grain::Free]),
            inside in prop::sample::select(vec![Bounds::Cleared, Bounds::Piece]),
            keep_order in any::<bool>(),
        ) {
            let n = pieces.len();
            let goods = Goods { grain, inside, gap, ..goods(pieces, by) };
            let packer = RowPacker { keep_order };
            let packed = packer.pack(&goods, &board(400.0, 500.0, 10.0), &go).unwrap();
            prop_assert!(packed.left_out.is_empty());
            prop_assert_eq!(check_layout(&packed.layout, inside, 1e-7), vec![]);
            let mut parts: Vec<u32> = packed.layout.placements.iter().map(|p| p.part).collect();
            if keep_order {
                prop_assert!(parts.is_sorted());
            }
            parts.sort_unstable();
            prop_assert_eq!(parts, (0..n as u32).collect::<Vec<_>>());
            let boards = packed.layout.placements.iter().map(|p| p.board);
            prop_assert!(boards.clone().is_sorted());
            prop_assert_eq!(boards.max().map(|b| b + 1), Some(packed.layout.boards));
            if grain == Grain::Directed {
                prop_assert!(packed.layout.placements.iter().all(|p| p.turn == 0.0));
            }
            prop_assert_eq!(packer.pack(&goods, &board(400.0, 500.0, 10.0), &go).unwrap(), packed);
        }
    }

    #[test]
    fn rectangles_that_fill_the_board_exactly_fit() {
        let pieces = vec![rectangle(100.0, 50.0); 12];
        let packed = RowPacker::default().pack(&goods(pieces, 0.0), &board(320.0, 220.0, 10.0), &go).unwrap();
        assert_eq!(packed.layout.boards, 1);
        // One more needs a second board: the current row counts.
        let pieces = vec![rectangle(100.0, 50.0); 13];
        let packed = RowPacker::default().pack(&goods(pieces, 0.0), &board(320.0, 220.0, 10.0), &go).unwrap();
        assert_eq!(packed.layout.boards, 2);
    }

    #[test]
    fn parts_share_the_space_of_their_tools() {
        // 100 wide, 10 mm cleared around: two pieces 10 mm apart, not 20.
        let packed = RowPacker::default()
            .pack(&goods(vec![rectangle(100.0, 50.0); 2], 10.0), &board(230.0, 70.0, 0.0), &go)
            .unwrap();
        assert_eq!(packed.layout.boards, 1);
        let [a, b] = packed.layout.placements[..] else { panic!() };
        assert!((b.offset.x - a.offset.x - 110.0).abs() < 1e-9);
    }

    #[test]
    fn slanted_neighbours_nest() {
        let slanted = vec![DVec2::ZERO, DVec2::new(60.0, 0.0), DVec2::new(110.0, 50.0), DVec2::new(50.0, 50.0)];
        let packed = RowPacker::default().pack(&goods(vec![slanted; 4], 0.0), &board(290.0, 50.0, 0.0), &go).unwrap();
        assert_eq!(packed.layout.boards, 1);
    }

    #[test]
    fn a_part_larger_than_the_board_is_named_and_the_others_packed() {
        let pieces = vec![rectangle(100.0, 50.0), rectangle(500.0, 50.0), Vec::new(), rectangle(30.0, 350.0)];
        let packed = RowPacker::default().pack(&goods(pieces.clone(), 5.0), &board(400.0, 320.0, 0.0), &go).unwrap();
        let placed: Vec<u32> = packed.layout.placements.iter().map(|p| p.part).collect();
        assert_eq!(placed, [0]);
        let named = |part, needed_x, needed_y| {
            let (usable_x, usable_y) = (400.0, 320.0);
            PackError::TooLarge { part, needed_x, needed_y, usable_x, usable_y }
        };
        assert_eq!(packed.left_out, [named(1, 510.0, 60.0), named(3, 40.0, 360.0)]);
        // Without grain the upright one may lie down.
        let free = Goods { grain: Grain::Free, ..goods(pieces, 5.0) };
        let packed = RowPacker::default().pack(&free, &board(400.0, 320.0, 0.0), &go).unwrap();
        assert_eq!((packed.layout.placements.len(), packed.left_out.len()), (2, 1));
    }

    #[test]
    fn bad_numbers_and_cancellation_are_errors() {
        let good = goods(vec![rectangle(10.0, 10.0)], 1.0);
        let pack = |g: &Goods, b: &Board| RowPacker::default().pack(g, b, &go).unwrap_err();
        assert!(matches!(pack(&good, &board(100.0, 100.0, 50.0)), PackError::NoArea { .. }));
        assert!(matches!(pack(&good, &board(f64::NAN, 100.0, 5.0)), PackError::NoArea { .. }));
        assert!(matches!(pack(&Goods { gap: -1.0, ..good.clone() }, &board(99.0, 99.0, 0.0)), PackError::Gap { .. }));
        let mut broken = good.clone();
        broken.cleared[0][1].y = f64::NAN;
        assert_eq!(pack(&broken, &board(99.0, 99.0, 0.0)), PackError::NotFinite { part: 0 });
        let stopped = RowPacker::default().pack(&good, &board(99.0, 99.0, 0.0), &|_| false);
        assert_eq!(stopped.unwrap_err(), PackError::Cancelled);
        let nothing = RowPacker::default().pack(&goods(Vec::new(), 0.0), &board(99.0, 99.0, 0.0), &go).unwrap();
        assert_eq!((nothing.layout.boards, nothing.layout.placements.len()), (0, 0));
    }
}
