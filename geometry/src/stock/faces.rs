//! What is left of a board as faces to be drawn.

use super::column::Column;
use super::removal::{Region, Stock};
use glam::DVec3;
use std::ops::Range;

/// A rectangle of the surface.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Face {
    /// Corners, counter-clockwise seen from outside, mm.
    pub corners: [DVec3; 4],
    /// Unit normal, out of the wood.
    pub normal: DVec3,
    /// A tool has made it; the others are those of the board.
    pub cut: bool,
}

/// Lines of a row that are the same, as far as they go.
#[derive(Clone, Copy, PartialEq)]
struct Run {
    from: usize,
    to: usize,
    column: Column,
}

impl Stock {
    /// The surface, as few rectangles as rows of equal lines give. O(lines).
    pub fn faces(&self, give: impl FnMut(Face)) {
        self.faces_in([[0, 0], self.count], give);
    }

    /// The surface of some lines; regions that cover the board give all of it, once. O(lines of the region).
    pub fn faces_in(&self, region: Region, mut give: impl FnMut(Face)) {
        let [w, h] = self.count;
        let [low, high] = [region[0], [region[1][0].min(w), region[1][1].min(h)]];
        self.level([low, high], &mut give);
        // Sides square to x, then to y: between a line and the next, runs of the same pair in one piece.
        let side = |x: isize, y: isize| {
            let inside = x >= 0 && y >= 0 && (x as usize) < w && (y as usize) < h;
            inside.then(|| self.column(x as usize, y as usize))
        };
        for (across, along) in [(0, 1), (1, 0)] {
            // The board's last side belongs to its last lines.
            let end = if high[across] == self.count[across] { high[across] + 1 } else { high[across] };
            for i in low[across] as isize..end as isize {
                let pair = |k: usize| match across {
                    0 => (side(i - 1, k as isize), side(i, k as isize)),
                    _ => (side(k as isize, i - 1), side(k as isize, i)),
                };
                let (first, inner) = (low[along], high[along]);
                if first >= inner {
                    continue;
                }
                let (mut from, mut now) = (first, pair(first));
                for k in first + 1..=inner {
                    let next = if k < inner { pair(k) } else { (None, None) };
                    if k == inner || next != now {
                        self.wall(across, i as f64, [from as f64, k as f64], now, &mut give);
                        (from, now) = (k, next);
                    }
                }
            }
        }
    }

    /// Upper and lower faces: runs of rows, as long as the next row has the same.
    fn level(&self, [low, high]: Region, give: &mut impl FnMut(Face)) {
        let mut open: Vec<(usize, Run)> = Vec::new();
        for y in low[1]..=high[1] {
            let row = if y < high[1] { self.runs(y, low[0]..high[0]) } else { Vec::new() };
            let mut next = Vec::with_capacity(row.len());
            let mut old = open.into_iter().peekable();
            for run in row {
                // Both are in order of x, so what does not go on is met on the way.
                while let Some((from, gone)) = old.next_if(|(_, o)| o.from < run.from) {
                    self.lids(from, y, gone, give);
                }
                match old.next_if(|(_, o)| *o == run) {
                    Some(same) => next.push(same),
                    None => {
                        if let Some((from, gone)) = old.next_if(|(_, o)| o.from == run.from) {
                            self.lids(from, y, gone, give);
                        }
                        next.push((y, run));
                    }
                }
            }
            old.for_each(|(from, gone)| self.lids(from, y, gone, give));
            open = next;
        }
    }

    fn runs(&self, y: usize, xs: Range<usize>) -> Vec<Run> {
        let start = y * self.count[0];
        let row = self.columns.get(start + xs.start..start + xs.end).unwrap_or(&[]);
        let mut runs: Vec<Run> = Vec::new();
        for (x, column) in xs.zip(row) {
            match runs.last_mut() {
                Some(run) if run.column == *column => run.to = x + 1,
                _ => runs.push(Run { from: x, to: x + 1, column: *column }),
            }
        }
        runs
    }

    fn lids(&self, from: usize, to: usize, run: Run, give: &mut impl FnMut(Face)) {
        let [a, b, c, d] = [run.from, run.to, from, to].map(|i| i as f64 * self.cell);
        for [low, high] in run.column.stretches() {
            let corners = |z: f64| [[a, c], [b, c], [b, d], [a, d]].map(|[x, y]| DVec3::new(x, y, z));
            give(Face { corners: corners(self.height(high)), normal: DVec3::Z, cut: high < u16::MAX });
            let mut under = corners(self.height(low));
            under.reverse();
            give(Face { corners: under, normal: -DVec3::Z, cut: low > 0 });
        }
    }

    /// The sides between two neighbours: where the one has wood and the other has none.
    fn wall(
        &self,
        across: usize,
        at: f64,
        [from, to]: [f64; 2],
        (before, after): (Option<Column>, Option<Column>),
        give: &mut impl FnMut(Face),
    ) {
        if before == after {
            return;
        }
        let cut = before.is_some() && after.is_some();
        let (at, from, to) = (at * self.cell, from * self.cell, to * self.cell);
        for (wood, air, sign) in [(before, after, 1.0), (after, before, -1.0)] {
            for [low, high] in wood.iter().flat_map(|c| c.stretches().collect::<Vec<_>>()) {
                let mut bare = Column::WHOLE;
                bare.cut(0, low);
                bare.cut(high, u16::MAX);
                for [a, b] in air.iter().flat_map(|c| c.stretches().collect::<Vec<_>>()) {
                    bare.cut(a, b);
                }
                for [a, b] in bare.stretches() {
                    let (a, b) = (self.height(a), self.height(b));
                    let flat = [[from, a], [to, a], [to, b], [from, b]];
                    let place = |[u, z]: [f64; 2]| {
                        if across == 0 { DVec3::new(at, u, z) } else { DVec3::new(u, at, z) }
                    };
                    let mut corners = flat.map(place);
                    // Along x the other way round is outside.
                    if (sign > 0.0) == (across == 1) {
                        corners.reverse();
                    }
                    let normal = if across == 0 { DVec3::X } else { DVec3::Y } * sign;
                    give(Face { corners, normal, cut });
                }
            }
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::board::Board;
    use crate::machine::{Pose, Revolved};
    use glam::DVec2;

    fn all(s: &Stock) -> Vec<Face> {
        let mut faces = Vec::new();
        s.faces(|f| faces.push(f));
        faces
    }

    fn volume(faces: &[Face]) -> f64 {
        // By the divergence theorem, from two triangles each.
        let triangle = |a: DVec3, b: DVec3, c: DVec3| a.dot(b.cross(c)) / 6.0;
        faces.iter().map(|f| f.corners).map(|[a, b, c, d]| triangle(a, b, c) + triangle(a, c, d)).sum()
    }

    #[test]
    fn a_whole_board_has_six_faces_and_a_cut_one_is_closed() {
        let board = Board { size: DVec2::new(100.0, 60.0), thickness: 10.0, margin: 0.0 };
        let mut s = Stock::new(&board, 6_000);
        let faces = all(&s);
        assert_eq!(faces.len(), 6);
        assert!(faces.iter().all(|f| !f.cut) && (volume(&faces) - 60_000.0).abs() < 1e-6);
        let mill = [Revolved { from: 0.0, to: 30.0, radius_from: 4.0, radius_to: 4.0 }];
        let axis = DVec3::new(0.4, 0.1, 1.0).normalize();
        let at = |x: f64, y: f64| Pose { tip: DVec3::new(x, y, -2.0), axis };
        s.cut(&mill, at(20.0, 20.0), at(70.0, 40.0));
        let faces = all(&s);
        let wood =
            |x: usize, y: usize| -> f64 { s.column(x, y).stretches().map(|[a, b]| s.height(b) - s.height(a)).sum() };
        let sum: f64 =
            (0..s.count[1]).flat_map(|y| (0..s.count[0]).map(move |x| (x, y))).map(|(x, y)| wood(x, y)).sum();
        assert!((volume(&faces) - sum * s.cell * s.cell).abs() < 1e-3, "{} {sum}", volume(&faces));
        let flux: DVec3 = faces.iter().map(|f| (f.corners[1] - f.corners[0]).cross(f.corners[3] - f.corners[0])).sum();
        assert!(flux.length() < 1e-6, "what is closed has no outward sum: {flux}");
        for f in &faces {
            let n = (f.corners[1] - f.corners[0]).cross(f.corners[3] - f.corners[0]);
            assert!(n.dot(f.normal) > 0.0, "{f:?}");
        }
        assert!(faces.iter().any(|f| f.cut) && faces.len() < 2_000);
        // In pieces it is the same surface.
        let mut pieces = Vec::new();
        for low in [[0, 0], [40, 0], [0, 25], [40, 25]] {
            let high = [if low[0] == 0 { 40 } else { s.count[0] }, if low[1] == 0 { 25 } else { s.count[1] }];
            s.faces_in([low, high], |f| pieces.push(f));
        }
        assert!((volume(&pieces) - volume(&faces)).abs() < 1e-3);
    }
}
