//! What lies under a place of the canvas.

use super::shape::{HEADER, Row, Shapes};
use eframe::egui::Pos2;
use std::collections::BTreeSet;

/// What lies there; nodes, outputs and inputs by number.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Hit {
    /// Nothing.
    Nothing,
    /// A node, but none of its rows that take the pointer.
    Node(usize),
    /// An output's dot.
    Output(usize, usize),
    /// An input's dot.
    Input(usize, usize),
    /// The value of an input; the row's number comes last.
    Value(usize, usize, usize),
    /// The row that folds and unfolds.
    More(usize),
}

impl Hit {
    /// The node that it belongs to.
    pub fn node(self) -> Option<usize> {
        match self {
            Self::Nothing => None,
            Self::Node(n) | Self::Output(n, _) | Self::Input(n, _) | Self::Value(n, _, _) | Self::More(n) => Some(n),
        }
    }
}

/// Finds it. Selected nodes lie on top, later ones above earlier ones. O(nodes).
pub fn hit(shapes: &Shapes, at: Pos2, selection: &BTreeSet<String>, zoom: f32) -> Hit {
    let reach = (9.0 / zoom.max(0.6)).min(14.0);
    let mut best = Hit::Nothing;
    for top in [false, true] {
        for (n, shape) in shapes.nodes.iter().enumerate() {
            if selection.contains(&shape.id) != top || !shape.rect.expand(reach).contains(at) {
                continue;
            }
            let rows = || shape.rows.iter().enumerate();
            let dot = rows().find_map(|(_, row)| match row {
                Row::Output(o) => (shape.output(*o).distance(at) < reach).then_some(Hit::Output(n, *o)),
                Row::Input(i, _) => (shape.input(*i).distance(at) < reach).then_some(Hit::Input(n, *i)),
                Row::More(_) => None,
            });
            if let Some(dot) = dot {
                best = dot;
            } else if shape.rect.contains(at) {
                let row = rows().find(|(r, _)| at.y > shape.rect.top() + HEADER && shape.row_rect(*r).contains(at));
                best = match row {
                    Some((_, Row::More(_))) => Hit::More(n),
                    Some((r, Row::Input(i, Some(_)))) => Hit::Value(n, *i, r),
                    _ => Hit::Node(n),
                };
            }
        }
    }
    best
}
