//! Bringing selected nodes into line, or at equal distances.

use super::shape::Shapes;
use crate::model::Model;
use eframe::egui::Rect;
use tenon_engine::Operation;

/// How nodes are aligned.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Align {
    /// Left edges under one another.
    Left,
    /// Right edges under one another.
    Right,
    /// Upper edges beside one another.
    Top,
    /// Lower edges beside one another.
    Bottom,
    /// Middles under one another.
    Centre,
    /// Middles beside one another.
    Middle,
    /// Equal room between nodes from left to right.
    Across,
    /// Equal room between nodes from top to bottom.
    Down,
}

/// All ways with their names.
pub const ALL: [(&str, Align); 8] = [
    ("Left edges", Align::Left),
    ("Right edges", Align::Right),
    ("Upper edges", Align::Top),
    ("Lower edges", Align::Bottom),
    ("Centres under one another", Align::Centre),
    ("Centres beside one another", Align::Middle),
    ("Distribute across", Align::Across),
    ("Distribute down", Align::Down),
];

/// The operation that does it with the selected nodes; none if nothing would move.
pub fn align(model: &Model, shapes: &Shapes, how: Align) -> Option<Operation> {
    let chosen: Vec<(&str, Rect)> =
        model.selection.iter().filter_map(|id| Some((id.as_str(), shapes.nodes.get(shapes.find(id)?)?.rect))).collect();
    let places = places(&chosen.iter().map(|c| c.1).collect::<Vec<_>>(), how);
    let moves = chosen.iter().zip(places).filter(|((_, rect), to)| [rect.left(), rect.top()] != *to);
    let moves: Vec<Operation> = moves
        .map(|((id, _), to)| Operation::Move { node: (*id).to_owned(), to: Some(to.map(|v| f64::from(v.round()))) })
        .collect();
    (!moves.is_empty()).then_some(Operation::All(moves))
}

/// Upper left corners after aligning, in the order of the rectangles.
fn places(rects: &[Rect], how: Align) -> Vec<[f32; 2]> {
    let left = rects.iter().map(Rect::left).fold(f32::INFINITY, f32::min);
    let right = rects.iter().map(Rect::right).fold(f32::NEG_INFINITY, f32::max);
    let top = rects.iter().map(Rect::top).fold(f32::INFINITY, f32::min);
    let bottom = rects.iter().map(Rect::bottom).fold(f32::NEG_INFINITY, f32::max);
    let (across, down) = ((left + right) / 2.0, (top + bottom) / 2.0);
    let mut places: Vec<[f32; 2]> = rects.iter().map(|r| [r.left(), r.top()]).collect();
    match how {
        Align::Left => places.iter_mut().for_each(|p| p[0] = left),
        Align::Right => places.iter_mut().zip(rects).for_each(|(p, r)| p[0] = right - r.width()),
        Align::Top => places.iter_mut().for_each(|p| p[1] = top),
        Align::Bottom => places.iter_mut().zip(rects).for_each(|(p, r)| p[1] = bottom - r.height()),
        Align::Centre => places.iter_mut().zip(rects).for_each(|(p, r)| p[0] = across - r.width() / 2.0),
        Align::Middle => places.iter_mut().zip(rects).for_each(|(p, r)| p[1] = down - r.height() / 2.0),
        Align::Across => distribute(rects, &mut places, 0, Rect::width),
        Align::Down => distribute(rects, &mut places, 1, Rect::height),
    }
    places
}

/// The first and the last stay; between the others there is equal room, however large they are.
fn distribute(rects: &[Rect], places: &mut [[f32; 2]], axis: usize, size: impl Fn(&Rect) -> f32) {
    let mut order: Vec<usize> = (0..rects.len()).collect();
    order.sort_by(|a, b| places[*a][axis].total_cmp(&places[*b][axis]).then(a.cmp(b)));
    let (Some(&first), Some(&last)) = (order.first(), order.last()) else { return };
    let room = places[last][axis] + size(&rects[last]) - places[first][axis];
    let gap = (room - rects.iter().map(&size).sum::<f32>()) / (rects.len().max(2) - 1) as f32;
    let mut at = places[first][axis];
    for i in order {
        places[i][axis] = at;
        at += size(&rects[i]) + gap;
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use eframe::egui::{pos2, vec2};

    #[test]
    fn nodes_come_into_line_and_at_equal_distances() {
        let rects = [(0.0, 0.0, 10.0), (12.0, 5.0, 30.0), (90.0, 3.0, 10.0)];
        let rects = rects.map(|(x, y, w)| Rect::from_min_size(pos2(x, y), vec2(w, 8.0)));
        assert_eq!(places(&rects, Align::Left).iter().map(|p| p[0]).collect::<Vec<_>>(), [0.0, 0.0, 0.0]);
        assert_eq!(places(&rects, Align::Right).iter().map(|p| p[0]).collect::<Vec<_>>(), [90.0, 70.0, 90.0]);
        assert_eq!(places(&rects, Align::Bottom).iter().map(|p| p[1]).collect::<Vec<_>>(), [5.0, 5.0, 5.0]);
        assert_eq!(places(&rects, Align::Centre).iter().map(|p| p[0]).collect::<Vec<_>>(), [45.0, 35.0, 45.0]);
        assert_eq!(places(&rects, Align::Middle).iter().map(|p| p[1]).collect::<Vec<_>>(), [2.5, 2.5, 2.5]);
        assert_eq!(places(&rects, Align::Across).iter().map(|p| p[0]).collect::<Vec<_>>(), [0.0, 35.0, 90.0]);
        assert!(places(&[], Align::Down).is_empty());
    }
}
