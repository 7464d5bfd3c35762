//! The layout drawing as plain polygons in board frames: what DXF, SVG and JSON write, each in its own words.

use tenon_engine::stop::{self, Stoppable};
use tenon_geometry::board::{Board, Layout, PartSet, Placement, Up};
use tenon_geometry::joint::{Feature, Machining};
use tenon_geometry::{DAffine3, DVec2, DVec3};

/// Why a layout cannot be drawn.
#[derive(Clone, Debug, PartialEq, Eq, thiserror::Error)]
pub enum DrawingError {
    /// The layout was made for other parts.
    #[error("the layout is for {layout} parts, but {parts} parts were given: wire both from the same map node")]
    OtherParts {
        /// Parts given.
        parts: usize,
        /// Parts that the layout knows.
        layout: usize,
    },
    /// A placement names a part or a board that is not there.
    #[error("placement {placement} puts part {part} on board {board}, but there are {parts} parts and {boards} boards")]
    NoSuchPlace {
        /// Index of the placement.
        placement: usize,
        /// Part it names.
        part: u32,
        /// Board it names.
        board: u32,
        /// Parts given.
        parts: usize,
        /// Boards of the layout.
        boards: u32,
    },
    /// A feature belongs to no part.
    #[error("feature {feature} belongs to part {part}, but there are {parts} parts")]
    NoSuchPart {
        /// Index of the feature.
        feature: usize,
        /// Part it names.
        part: u32,
        /// Parts given.
        parts: usize,
    },
}

/// A layout ready to be drawn; every coordinate is in its board's frame, mm.
#[derive(Clone, Debug, PartialEq)]
pub struct Drawing {
    /// The board, the same for all.
    pub board: Board,
    /// How many boards.
    pub boards: u32,
    /// Placed pieces in machining order.
    pub pieces: Vec<DrawnPiece>,
}

/// A placed piece.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnPiece {
    /// Part index.
    pub part: u32,
    /// Model → part frame.
    pub frame: DAffine3,
    /// Where it lies: part frame → board frame.
    pub placement: Placement,
    /// Address.
    pub address: String,
    /// Outline of the upper face, counter-clockwise.
    pub upper: Vec<DVec2>,
    /// Outline of the lower face, counter-clockwise.
    pub lower: Vec<DVec2>,
    /// Work-piece outline `P_i`.
    pub piece: Vec<DVec2>,
    /// Cleared outline `C_i`.
    pub cleared: Vec<DVec2>,
    /// Drilled holes.
    pub holes: Vec<DrawnHole>,
    /// Slots, pockets and inner contours as polygons.
    pub cuts: Vec<Vec<DVec2>>,
    /// The address, as large as fits in the middle of the upper face.
    pub label: DrawnText,
    /// Engraved texts where they stand.
    pub engraved: Vec<DrawnText>,
}

/// A hole seen from above.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct DrawnHole {
    /// Where its axis enters.
    pub mouth: DVec2,
    /// Where its axis ends.
    pub tip: DVec2,
    /// Diameter, mm.
    pub diameter: f64,
}

/// A line of text.
#[derive(Clone, Debug, PartialEq)]
pub struct DrawnText {
    /// Lower left corner.
    pub origin: DVec2,
    /// Reading direction, radians from +X.
    pub turn: f64,
    /// Height of capitals, mm.
    pub height: f64,
    /// The text.
    pub text: String,
}

/// Width of a character over its height, as assumed where text must fit.
pub(super) const CHARACTER: f64 = 0.65;

/// Puts all parts of a layout into board frames. Cost O(corners + features).
///
/// # Errors
/// [`DrawingError`] when layout and parts do not belong together.
pub fn draw(parts: &PartSet, layout: &Layout) -> Result<Drawing, DrawingError> {
    let n = parts.panels.len();
    for known in [layout.piece.len(), layout.cleared.len(), parts.frame.len()] {
        if known != n {
            return Err(DrawingError::OtherParts { parts: n, layout: known });
        }
    }
    let features = by_part(&parts.features.features, n)?;
    let mut pieces = Vec::with_capacity(layout.placements.len());
    for (placement, p) in layout.placements.iter().enumerate() {
        stop::check();
        if p.part as usize >= n || p.board >= layout.boards {
            let (part, board) = (p.part, p.board);
            return Err(DrawingError::NoSuchPlace { placement, part, board, parts: n, boards: layout.boards });
        }
        pieces.push(piece(parts, layout, p, &features[p.part as usize]));
    }
    Ok(Drawing { board: layout.board, boards: layout.boards, pieces })
}

/// Features of each part, in their order.
pub(super) fn by_part(features: &[Feature], parts: usize) -> Result<Vec<Vec<&Feature>>, DrawingError> {
    let mut rows = vec![Vec::new(); parts];
    for (feature, f) in features.iter().enumerate().stoppable() {
        let Some(row) = rows.get_mut(f.panel as usize) else {
            return Err(DrawingError::NoSuchPart { feature, part: f.panel, parts });
        };
        row.push(f);
    }
    Ok(rows)
}

fn piece(parts: &PartSet, layout: &Layout, place: &Placement, features: &[&Feature]) -> DrawnPiece {
    let i = place.part as usize;
    let at = |p: DVec3| place.point(p).truncate();
    let outline = |line: &[DVec2]| line.iter().map(|p| at(p.extend(0.0))).collect::<Vec<_>>();
    let front = parts.panels.front[parts.panels.corners(i)].iter().map(|&p| at(p)).collect();
    let back = parts.panels.corners(i).flat_map(|c| [parts.panels.back_start[c], parts.panels.back_end[c]]).map(at);
    let back = without_repeats(back.collect());
    let (upper, lower) = if parts.up == Up::Front { (front, back) } else { (back, front) };
    let (upper, lower) = (counter_clockwise(upper), counter_clockwise(lower));
    let address = parts.panels.address[i].to_string();
    let (mut holes, mut cuts, mut engraved) = (Vec::new(), Vec::new(), Vec::new());
    for f in features {
        match &f.machining {
            Machining::Drill { entry, axis, depth, diameter } => {
                holes.push(DrawnHole { mouth: at(*entry), tip: at(*entry + *axis * *depth), diameter: *diameter });
            }
            Machining::Slot { from, to, axis, width, .. } => {
                let across = (*to - *from).cross(*axis).normalize_or_zero() * (0.5 * width);
                cuts.push([*from - across, *to - across, *to + across, *from + across].map(at).to_vec());
            }
            Machining::Pocket { outline, .. } => cuts.push(outline.iter().map(|&p| at(p)).collect()),
            Machining::Contour { line, .. } => cuts.push(line.iter().map(|&p| at(p)).collect()),
            Machining::Engraving { origin, along, height, text, .. } => {
                let d = place.vector(*along);
                engraved.push(DrawnText {
                    origin: at(*origin),
                    turn: d.y.atan2(d.x),
                    height: *height,
                    text: text.clone(),
                });
            }
        }
    }
    let label = middle_text(&upper, &address);
    let (piece, cleared) = (outline(&layout.piece[i]), outline(&layout.cleared[i]));
    let (part, placement, frame) = (place.part, *place, parts.frame[i]);
    DrawnPiece { part, frame, placement, address, upper, lower, piece, cleared, holes, cuts, label, engraved }
}

fn without_repeats(mut line: Vec<DVec2>) -> Vec<DVec2> {
    line.dedup();
    if line.len() > 1 && line.first() == line.last() {
        line.pop();
    }
    line
}

fn counter_clockwise(mut line: Vec<DVec2>) -> Vec<DVec2> {
    if signed_area(&line) < 0.0 {
        line.reverse();
    }
    line
}

/// Area of a polygon, positive when counter-clockwise, mm².
pub(super) fn signed_area(line: &[DVec2]) -> f64 {
    let Some(&o) = line.first() else { return 0.0 };
    0.5 * line.windows(2).skip(1).map(|w| (w[0] - o).perp_dot(w[1] - o)).sum::<f64>()
}

/// The text in the middle of a convex outline, read along its longest edge and from below or from the right.
fn middle_text(outline: &[DVec2], text: &str) -> DrawnText {
    let n = outline.len();
    if n == 0 {
        return DrawnText { origin: DVec2::ZERO, turn: 0.0, height: 1.0, text: text.to_owned() };
    }
    let middle = outline.iter().sum::<DVec2>() / n as f64;
    let edge = |k: usize| outline[(k + 1) % n] - outline[k];
    let longest = (1..n).fold(0, |best, k| if edge(k).length() > edge(best).length() { k } else { best });
    let along = edge(longest).normalize_or(DVec2::X);
    let along = if along.x < -1e-9 || (along.x < 1e-9 && along.y < 0.0) { -along } else { along };
    let clear = (0..n)
        .map(|k| edge(k).normalize_or_zero().perp_dot(middle - outline[k]))
        .fold(f64::INFINITY, f64::min)
        .max(0.0);
    let width = CHARACTER * text.len().max(1) as f64;
    // The text's half diagonal stays inside the largest circle about the middle.
    let height = (1.8 * clear / width.hypot(1.0)).clamp(1.0, 40.0);
    let origin = middle - along * (0.5 * width * height) - along.perp() * (0.5 * height);
    DrawnText { origin, turn: along.y.atan2(along.x), height, text: text.to_owned() }
}

#[cfg(test)]
mod tests {
    use super::super::fixture;
    use super::*;

    #[test]
    fn outlines_stand_in_the_board_frame() {
        let drawing = draw(&fixture::parts(), &fixture::layout()).unwrap();
        let [first, second] = &drawing.pieces[..] else { panic!("two pieces") };
        assert_eq!(first.upper[2], DVec2::new(260.0, 130.0));
        // The voided corner makes the lower face a pentagon; its own panel 2 has none.
        assert_eq!((first.lower.len(), second.lower.len()), (5, 4));
        // A quarter turn takes (200, 0) to (0, 200).
        assert!(second.upper[1].distance(DVec2::new(150.0, 240.0)) < 1e-12);
        assert!(signed_area(&second.upper) > 0.0 && signed_area(&second.lower) > 0.0);
        let depth = 14.0 * 0.5_f64.sqrt();
        assert!(first.holes[0].tip.distance(DVec2::new(140.0, 55.0 - depth)) < 1e-12);
        assert_eq!(first.engraved[0].text, "3.0");
        // Along the longest edge, which stands upright on the second board: read from the right.
        assert!((second.label.turn - std::f64::consts::FRAC_PI_2).abs() < 1e-12);
    }

    #[test]
    fn back_up_changes_the_faces_over() {
        let mut parts = fixture::parts();
        parts.up = Up::Back;
        let drawing = draw(&parts, &fixture::layout()).unwrap();
        assert_eq!((drawing.pieces[0].upper.len(), drawing.pieces[0].lower.len()), (5, 4));
    }

    #[test]
    fn parts_and_layout_of_different_runs_are_refused() {
        let (parts, layout) = (fixture::parts(), fixture::layout());
        let mut fewer = layout.clone();
        fewer.piece.pop();
        assert_eq!(draw(&parts, &fewer), Err(DrawingError::OtherParts { parts: 3, layout: 2 }));
        let mut wrong = layout.clone();
        wrong.placements[1].part = 7;
        assert!(matches!(draw(&parts, &wrong), Err(DrawingError::NoSuchPlace { placement: 1, part: 7, .. })));
        wrong.placements[1].part = 2;
        wrong.placements[1].board = 2;
        assert!(matches!(draw(&parts, &wrong), Err(DrawingError::NoSuchPlace { board: 2, boards: 2, .. })));
        let mut strange = parts.clone();
        strange.features.features[1].panel = 3;
        assert_eq!(draw(&strange, &layout), Err(DrawingError::NoSuchPart { feature: 1, part: 3, parts: 3 }));
    }
}
