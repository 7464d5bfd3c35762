//! What lies under a place of the canvas.

use super::groups;
use super::shape::{HEADER, Kind, Row, Shapes};
use eframe::egui::epaint::CubicBezierShape;
use eframe::egui::{Color32, Pos2, Rect, Stroke, vec2};
use std::collections::BTreeSet;
use tenon_engine::Document;

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
    /// A wire, by its number.
    Wire(usize),
    /// The title of a group, by its number.
    Group(usize),
}

impl Hit {
    /// The node that it belongs to.
    pub fn node(self) -> Option<usize> {
        match self {
            Self::Nothing | Self::Wire(_) | Self::Group(_) => None,
            Self::Node(n) | Self::Output(n, _) | Self::Input(n, _) | Self::Value(n, _, _) | Self::More(n) => Some(n),
        }
    }
}

/// Finds it. Selected nodes lie on top, later ones above earlier ones; wires and groups lie below. O(nodes + wires).
pub fn hit(shapes: &Shapes, document: &Document, at: Pos2, selection: &BTreeSet<String>, zoom: f32) -> Hit {
    let node = node(shapes, at, selection, zoom);
    if node != Hit::Nothing {
        return node;
    }
    if let Some(wire) = wire(shapes, at, (5.0 / zoom).clamp(3.0, 14.0)) {
        return Hit::Wire(wire);
    }
    groups::at(document, shapes, at).map_or(Hit::Nothing, Hit::Group)
}

/// How far wires reach out of their ends before they turn, canvas points.
pub fn reach(a: Pos2, b: Pos2) -> f32 {
    ((b.x - a.x).abs() * 0.5).max((b.y - a.y).abs() * 0.25).clamp(18.0, 240.0)
}

/// The wire that runs by a place.
fn wire(shapes: &Shapes, at: Pos2, near: f32) -> Option<usize> {
    shapes.wires.iter().position(|wire| {
        let Some((n, o)) = wire.source else { return false };
        let (a, b) = (shapes.nodes[n].output(o), shapes.nodes[wire.to].input(wire.port));
        let reach = reach(a, b);
        if !Rect::from_two_pos(a, b).expand2(vec2(reach * 0.3 + near, near)).contains(at) {
            return false;
        }
        let points = [a, a + vec2(reach, 0.0), b - vec2(reach, 0.0), b];
        let curve = CubicBezierShape::from_points_stroke(points, false, Color32::TRANSPARENT, Stroke::NONE);
        let line = curve.flatten(Some(2.0));
        line.windows(2).any(|w| {
            let (along, off) = (w[1] - w[0], at - w[0]);
            let t = (off.dot(along) / along.length_sq().max(1e-9)).clamp(0.0, 1.0);
            (off - along * t).length() < near
        })
    })
}

fn node(shapes: &Shapes, at: Pos2, selection: &BTreeSet<String>, zoom: f32) -> Hit {
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
            } else if shape.rect.contains(at) && shape.kind != Kind::Node {
                best = Hit::Node(n);
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
