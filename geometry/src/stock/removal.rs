//! Taking away what a tool sweeps.

use super::column::Column;
use crate::board::Board;
use crate::machine::{Pose, Revolved};
use glam::{DVec2, DVec3};

/// Most lines along a side of the board.
const MOST: f64 = 4096.0;

/// A rectangle of lines: the first in x and y, and those after the last.
pub type Region = [[usize; 2]; 2];

/// A board as vertical lines `cell` apart, each in the middle of a square of that size.
#[derive(Clone, Debug, PartialEq)]
pub struct Stock {
    /// Distance between lines, mm.
    pub cell: f64,
    /// Number of lines in x and y.
    pub count: [usize; 2],
    /// Thickness of the board, mm.
    pub thickness: f64,
    pub(super) columns: Vec<Column>,
}

impl Stock {
    /// A whole board with about so many lines. O(lines).
    #[must_use]
    pub fn new(board: &Board, lines: usize) -> Self {
        let size = board.size.max(DVec2::splat(1.0));
        let cell = (size.x * size.y / lines.max(1) as f64).sqrt().max(size.max_element() / MOST);
        let count = (size / cell).ceil().max(DVec2::ONE).to_array().map(|n| n as usize);
        let columns = vec![Column::WHOLE; count[0] * count[1]];
        Self { cell, count, thickness: board.thickness.max(1e-6), columns }
    }

    /// A line.
    #[must_use]
    pub fn column(&self, x: usize, y: usize) -> Column {
        self.columns.get(y * self.count[0] + x).copied().filter(|_| x < self.count[0]).unwrap_or(Column::WHOLE)
    }

    /// Height of what is seen from above at a place, mm; 0 where nothing is left or the board ends.
    #[must_use]
    pub fn top(&self, at: DVec2) -> f64 {
        let place = (at / self.cell).floor();
        if place.min_element() < 0.0 || place.x >= self.count[0] as f64 || place.y >= self.count[1] as f64 {
            return 0.0;
        }
        self.column(place.x as usize, place.y as usize).top().map_or(0.0, |t| self.height(t))
    }

    /// A height of a [`Column`] in mm.
    #[must_use]
    pub fn height(&self, at: u16) -> f64 {
        f64::from(at) / f64::from(u16::MAX) * self.thickness
    }

    /// The lines that are not whole, with their numbers: all that must be kept to come back to this. O(lines).
    #[must_use]
    pub fn touched(&self) -> Vec<(u32, Column)> {
        let all = self.columns.iter().enumerate().filter(|(_, c)| **c != Column::WHOLE);
        all.map(|(i, c)| (i as u32, *c)).collect()
    }

    /// Comes back to what [`Stock::touched`] gave of a stock of the same board. O(lines).
    pub fn come_back(&mut self, touched: &[(u32, Column)]) {
        self.columns.fill(Column::WHOLE);
        for (i, column) in touched {
            if let Some(slot) = self.columns.get_mut(*i as usize) {
                *slot = *column;
            }
        }
    }

    /// Takes away what a cutter sweeps on a straight move, and tells where something was changed. The move is taken as poses
    /// less than a cell apart; a cutter thinner than a cell leaves a groove as wide as one. O(length / cell × lines under the
    /// cutter).
    pub fn cut(&mut self, cutter: &[Revolved], from: Pose, to: Pose) -> Option<Region> {
        let widest = cutter.iter().map(|p| p.radius_from.max(p.radius_to)).fold(0.0, f64::max);
        let long = cutter.iter().map(|p| p.to).fold(0.0, f64::max);
        let by = to.tip - from.tip;
        let along = by.dot(from.axis);
        let aside = (by - from.axis * along).length();
        let turn = from.axis.angle_between(to.axis) * long;
        let steps = (aside / (0.7 * self.cell)).max(along.abs() / (0.5 * long).max(0.1)).max(turn / self.cell);
        let steps = steps.ceil().clamp(1.0, 1e5) as usize;
        let wider = (0.6 * self.cell - widest).max(0.0);
        let mut changed: Option<Region> = None;
        for i in 0..=steps {
            let t = i as f64 / steps as f64;
            let pose = Pose { tip: from.tip.lerp(to.tip, t), axis: from.axis.lerp(to.axis, t).normalize_or(DVec3::Z) };
            let bitten = self.bite(cutter, wider, pose);
            changed = match (changed, bitten) {
                (Some([a, b]), Some([c, d])) => {
                    Some([[a[0].min(c[0]), a[1].min(c[1])], [b[0].max(d[0]), b[1].max(d[1])]])
                }
                (a, b) => a.or(b),
            };
        }
        changed
    }

    /// Takes away what a cutter fills where it stands.
    fn bite(&mut self, cutter: &[Revolved], wider: f64, pose: Pose) -> Option<Region> {
        let (low, high) = self.under(cutter, wider, pose)?;
        let mut changed: Option<Region> = None;
        for y in low[1]..high[1] {
            for x in low[0]..high[0] {
                let place = DVec2::new(x as f64 + 0.5, y as f64 + 0.5) * self.cell;
                let mut filled: Option<[f64; 2]> = None;
                for piece in cutter {
                    let Some([a, b]) = stretch(piece, wider, pose, place) else { continue };
                    filled = Some(filled.map_or([a, b], |[c, d]| [a.min(c), b.max(d)]));
                }
                let Some([a, b]) = filled else { continue };
                let unit = |z: f64| (z / self.thickness * f64::from(u16::MAX)).round().clamp(0.0, 65535.0) as u16;
                if self.columns[y * self.count[0] + x].cut(unit(a), unit(b)) {
                    let [c, d] = changed.get_or_insert([[x, y], [x + 1, y + 1]]);
                    *c = [c[0].min(x), c[1].min(y)];
                    *d = [d[0].max(x + 1), d[1].max(y + 1)];
                }
            }
        }
        changed
    }

    /// The lines that a cutter may meet within the board; none if it is above or beside it.
    fn under(&self, cutter: &[Revolved], wider: f64, pose: Pose) -> Option<([usize; 2], [usize; 2])> {
        let a = pose.axis;
        let side = (1.0 - a.z * a.z).max(0.0).sqrt();
        let (mut low, mut high) = (DVec2::INFINITY, DVec2::NEG_INFINITY);
        for piece in cutter {
            let r = piece.radius_from.max(piece.radius_to) + wider;
            // Only what stands at heights of the board counts.
            let (mut from, mut to) = (piece.from, piece.to);
            if a.z > 0.05 {
                from = from.max((-r * side - pose.tip.z) / a.z);
                to = to.min((self.thickness + r * side - pose.tip.z) / a.z);
            }
            if from > to {
                continue;
            }
            let extent = DVec2::new((1.0 - a.x * a.x).max(0.0), (1.0 - a.y * a.y).max(0.0)).map(f64::sqrt) * r;
            for h in [from, to] {
                let p = (pose.tip + a * h).truncate();
                (low, high) = (low.min(p - extent), high.max(p + extent));
            }
        }
        let most = DVec2::new(self.count[0] as f64, self.count[1] as f64);
        let (low, high) = ((low / self.cell).floor().max(DVec2::ZERO), (high / self.cell).ceil().min(most));
        let met = low.cmplt(high).all();
        met.then(|| (low.to_array().map(|c| c as usize), high.to_array().map(|c| c as usize)))
    }
}

/// From where to where a piece of a cutter fills the vertical line through a place; it is convex, so that is one stretch.
fn stretch(piece: &Revolved, wider: f64, pose: Pose, place: DVec2) -> Option<[f64; 2]> {
    let (a, w) = (pose.axis, place.extend(0.0) - pose.tip);
    let along = w.dot(a);
    // Between the planes at both ends …
    let (mut low, mut high) = (f64::NEG_INFINITY, f64::INFINITY);
    if a.z.abs() < 1e-9 {
        if along < piece.from || along > piece.to {
            return None;
        }
    } else {
        let ends = [(piece.from - along) / a.z, (piece.to - along) / a.z];
        (low, high) = (ends[0].min(ends[1]), ends[0].max(ends[1]));
    }
    // … and inside the cone: distance² − radius² = c₂ z² + 2 c₁ z + c₀ ≤ 0.
    let slope = (piece.radius_to - piece.radius_from) / (piece.to - piece.from).max(1e-9);
    let radius = piece.radius_from + wider + slope * (along - piece.from);
    let c2 = 1.0 - a.z * a.z * (1.0 + slope * slope);
    let c1 = w.z - along * a.z - radius * slope * a.z;
    let c0 = w.length_squared() - along * along - radius * radius;
    let inside = |z: f64| (c2 * z + 2.0 * c1) * z + c0 <= 0.0;
    let mut roots = [f64::NAN; 2];
    if c2.abs() < 1e-12 {
        if c1.abs() > 1e-12 {
            roots[0] = -0.5 * c0 / c1;
        }
    } else {
        let root = (c1 * c1 - c2 * c0).sqrt();
        roots = [(-c1 - root) / c2, (-c1 + root) / c2];
        roots.sort_by(f64::total_cmp);
    }
    let mut found: Option<[f64; 2]> = None;
    let mut from = low;
    for to in roots.into_iter().filter(|r| *r > low && *r < high).chain([high]) {
        let middle = match (from.is_finite(), to.is_finite()) {
            (true, true) => 0.5 * (from + to),
            (true, false) => from + 1.0,
            (false, true) => to - 1.0,
            (false, false) => 0.0,
        };
        if inside(middle) {
            found = Some([found.map_or(from, |f| f[0]), to]);
        }
        from = to;
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use std::f64::consts::PI;

    fn board() -> Board {
        Board { size: DVec2::new(100.0, 60.0), thickness: 10.0, margin: 0.0 }
    }

    fn mill(radius: f64) -> Vec<Revolved> {
        vec![Revolved { from: 0.0, to: 30.0, radius_from: radius, radius_to: radius }]
    }

    fn pose(x: f64, y: f64, z: f64) -> Pose {
        Pose { tip: DVec3::new(x, y, z), axis: DVec3::Z }
    }

    /// Wood that is gone, mm³.
    fn gone(s: &Stock) -> f64 {
        let wood = |c: Column| c.stretches().map(|[a, b]| s.height(b) - s.height(a)).sum::<f64>();
        s.columns.iter().map(|c| s.thickness - wood(*c)).sum::<f64>() * s.cell * s.cell
    }

    #[test]
    fn a_groove_is_as_wide_and_deep_as_the_mill_cuts_it() {
        let mut s = Stock::new(&board(), 240_000);
        let changed = s.cut(&mill(4.0), pose(20.0, 30.0, 6.0), pose(80.0, 30.0, 6.0)).unwrap();
        // Its width is counted in cells.
        let exact = 4.0 * (60.0 * 8.0 + PI * 16.0);
        assert!((gone(&s) - exact).abs() < s.cell / 8.0 * exact, "{} {exact}", gone(&s));
        assert!((s.top(DVec2::new(50.0, 33.5)) - 6.0).abs() < 1e-3 && s.top(DVec2::new(50.0, 34.5)) == 10.0);
        assert_eq!(s.top(DVec2::new(-1.0, 5.0)), 0.0);
        let [low, high] = changed.map(|c| c.map(|i| i as f64 * s.cell));
        assert!((low[0] - 16.0).abs() < 0.5 && (high[0] - 84.0).abs() < 0.5 && (high[1] - 34.0).abs() < 0.5);
        // Above the board, and once more along the same way, nothing changes.
        assert_eq!(s.cut(&mill(4.0), pose(20.0, 30.0, 10.0), pose(80.0, 30.0, 10.0)), None);
        assert_eq!(s.cut(&mill(4.0), pose(20.0, 30.0, 6.0), pose(80.0, 30.0, 6.0)), None);
    }

    #[test]
    fn a_leaning_mill_undercuts_and_leaves_what_is_above() {
        let mut s = Stock::new(&board(), 60_000);
        let axis = DVec3::new(1.0, 0.0, 1.0).normalize();
        let at = |y: f64| Pose { tip: DVec3::new(40.0, y, -3.0), axis };
        s.cut(&mill(2.0), at(10.0), at(50.0));
        // The mill's middle is at x = 43 + z: there the wood is gone and above and below it stays.
        let c = s.column((48.0 / s.cell) as usize, (30.0 / s.cell) as usize);
        let left: Vec<[f64; 2]> = c.stretches().map(|s2| s2.map(|h| s.height(h))).collect();
        let half = 2.0 * 2f64.sqrt();
        assert_eq!(left.len(), 2, "{left:?}");
        assert!((left[0][0] - (5.0 + half)).abs() < 0.4 && (left[1][1] - (5.0 - half)).abs() < 0.4, "{left:?}");
    }

    #[test]
    fn drills_leave_their_point_and_thin_tools_a_groove_of_one_cell() {
        let mut s = Stock::new(&board(), 60_000);
        let drill = [
            Revolved { from: 0.0, to: 3.0, radius_from: 0.0, radius_to: 3.0 },
            Revolved { from: 3.0, to: 30.0, radius_from: 3.0, radius_to: 3.0 },
        ];
        s.cut(&drill, pose(50.0, 30.0, 20.0), pose(50.0, 30.0, 2.0));
        let exact = PI * 9.0 * (1.0 + 5.0);
        assert!((gone(&s) - exact).abs() < 0.05 * exact, "{} {exact}", gone(&s));
        let mut s = Stock::new(&board(), 6_000);
        let needle = [Revolved { from: 0.0, to: 5.0, radius_from: 0.0, radius_to: 0.1 }];
        assert!(s.cut(&needle, pose(10.0, 30.2, 9.0), pose(90.0, 30.2, 9.0)).is_some());
        assert!((0..80).all(|x| s.top(DVec2::new(f64::from(x) + 10.5, 30.4)) < 9.8));
    }

    #[test]
    fn what_was_kept_brings_the_board_back() {
        let mut s = Stock::new(&board(), 6_000);
        s.cut(&mill(4.0), pose(20.0, 30.0, 6.0), pose(80.0, 30.0, 6.0));
        let (kept, before) = (s.touched(), s.clone());
        assert!(kept.len() < s.columns.len() / 4);
        s.cut(&mill(4.0), pose(20.0, 10.0, 0.0), pose(80.0, 50.0, 0.0));
        assert_ne!(s, before);
        s.come_back(&kept);
        assert_eq!(s, before);
    }
}
