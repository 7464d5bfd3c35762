//! Layout drawing as one SVG: boards side by side, pieces with addresses and holes, grain arrows, a title per board.

use super::blocks::Blocks;
use super::drawing::{Drawing, DrawnPiece, DrawnText, signed_area};
use super::dxf::board_origin;
use std::fmt::{Arguments, Write as _};
use tenon_geometry::DVec2;

/// Colours and line widths; widths are mm on the board.
const STYLE: &str = "\
.sheet{fill:#fbf7ef}\
.board{fill:#f0dfbf;stroke:#8a6d3b;stroke-width:3}\
.usable{fill:none;stroke:#8a6d3b;stroke-width:1.2;stroke-dasharray:14 10}\
.cleared{fill:#fff;fill-opacity:.35;stroke:#b9a47c;stroke-width:.8}\
.piece{fill:#c98f4e;fill-opacity:.85;stroke:none}\
.upper{fill:#e0ab6a;stroke:#5b3a14;stroke-width:1.6;stroke-linejoin:round}\
.lower{fill:none;stroke:#5b3a14;stroke-width:.8;stroke-dasharray:5 4}\
.cut{fill:none;stroke:#5b3a14;stroke-width:1}\
.hole{fill:#fff;stroke:#1f4e79;stroke-width:.7}\
.bore{stroke:#1f4e79;stroke-width:.7}\
.grain{stroke:#8a6d3b;stroke-width:4;fill:none;stroke-linecap:round;stroke-linejoin:round}\
text{font-family:Helvetica,Arial,sans-serif;fill:#33210b}\
.address{fill-opacity:.3}\
.engraved{fill:#1f4e79}";

/// Writes the drawing as SVG, 1 user unit = 1 mm, 2 decimals. Every board stands upright (Y up), named with its number
/// of pieces and the share of its area that they fill; `grain` is the grain's direction in the board, drawn as an arrow
/// beside the title where it is given. Cost O(corners + holes). Stops early, and what there is then is of no use, when
/// `go` says no.
#[must_use]
pub fn write_svg(drawing: &Drawing, grain: Option<DVec2>, go: &dyn Fn() -> bool) -> Vec<u8> {
    let size = drawing.board.size;
    let edge = 0.06 * size.x;
    let head = 0.09 * size.x;
    let right = board_origin(drawing, drawing.boards.saturating_sub(1)).x + size.x;
    let sheet = DVec2::new(right + 2.0 * edge, size.y + head + 2.0 * edge);
    let mut svg = Svg { text: Blocks::default(), origin: DVec2::new(edge, edge + head + size.y) };
    svg.put(format_args!(
        "<svg xmlns=\"http://www.w3.org/2000/svg\" viewBox=\"0 0 {0:.2} {1:.2}\" width=\"{0:.2}mm\" height=\"{1:.2}mm\">\
         \n<title>Layout on {2} boards {3} × {4} × {5} mm</title>\n<style>{STYLE}</style>\n\
         <rect class=\"sheet\" width=\"100%\" height=\"100%\"/>\n",
        sheet.x, sheet.y, drawing.boards, size.x, size.y, drawing.board.thickness,
    ));
    let base = svg.origin;
    let mut boards = vec![Vec::new(); drawing.boards as usize];
    for piece in drawing.pieces.iter().take_while(|_| go()) {
        if let Some(pieces) = boards.get_mut(piece.placement.board as usize) {
            pieces.push(piece);
        }
    }
    for (board, pieces) in boards.iter().enumerate() {
        svg.origin = base + board_origin(drawing, board as u32);
        svg.board(drawing, board, pieces, grain, go);
    }
    svg.text.push_str("</svg>\n");
    svg.text.into_bytes()
}

struct Svg {
    text: Blocks,
    /// Where the board's lower left corner lies on the sheet, whose Y points down.
    origin: DVec2,
}

impl Svg {
    fn put(&mut self, text: Arguments<'_>) {
        let _ = self.text.write_fmt(text);
    }

    fn at(&self, p: DVec2) -> DVec2 {
        DVec2::new(self.origin.x + p.x, self.origin.y - p.y)
    }

    fn board(
        &mut self,
        drawing: &Drawing,
        board: usize,
        pieces: &[&DrawnPiece],
        grain: Option<DVec2>,
        go: &dyn Fn() -> bool,
    ) {
        if !go() {
            return;
        }
        let (size, margin) = (drawing.board.size, drawing.board.margin);
        let used: f64 = pieces.iter().map(|p| signed_area(&p.piece).abs()).sum();
        let corners =
            |m: f64| [DVec2::splat(m), DVec2::new(size.x - m, m), size - DVec2::splat(m), DVec2::new(m, size.y - m)];
        self.put(format_args!("<g id=\"board-{}\">\n", board + 1));
        self.polygon("board", &corners(0.0));
        self.polygon("usable", &corners(margin));
        let height = 0.04 * size.x;
        self.label(
            "title",
            &DrawnText {
                origin: DVec2::new(0.0, size.y + 0.75 * height),
                turn: 0.0,
                height,
                text: format!(
                    "Board {} · {} {} · {:.0} % filled",
                    board + 1,
                    pieces.len(),
                    if pieces.len() == 1 { "piece" } else { "pieces" },
                    100.0 * used / (size.x * size.y).max(1e-9)
                ),
            },
        );
        if let Some(direction) = grain.and_then(DVec2::try_normalize) {
            self.grain(DVec2::new(size.x - 1.5 * height, size.y + 1.2 * height), direction, 1.2 * height);
        }
        for piece in pieces {
            self.polygon("cleared", &piece.cleared);
        }
        for piece in pieces.iter().take_while(|_| go()) {
            self.piece(piece);
        }
        self.text.push_str("</g>\n");
    }

    fn piece(&mut self, piece: &DrawnPiece) {
        self.put(format_args!("<g><title>{}</title>\n", escaped(&piece.address)));
        self.polygon("piece", &piece.piece);
        self.polygon("upper", &piece.upper);
        self.polygon("lower", &piece.lower);
        // Where the address is engraved it reads by itself; a second one would only lie over it.
        if piece.engraved.iter().all(|text| text.text != piece.address) {
            self.label("address", &piece.label);
        }
        for cut in &piece.cuts {
            self.polygon("cut", cut);
        }
        for hole in &piece.holes {
            let (m, t) = (self.at(hole.mouth), self.at(hole.tip));
            if m.distance(t) > 0.01 {
                self.put(format_args!(
                    "<line class=\"bore\" x1=\"{:.2}\" y1=\"{:.2}\" x2=\"{:.2}\" y2=\"{:.2}\"/>\n",
                    m.x, m.y, t.x, t.y
                ));
            }
            let r = 0.5 * hole.diameter;
            self.put(format_args!("<circle class=\"hole\" cx=\"{:.2}\" cy=\"{:.2}\" r=\"{r:.2}\"/>\n", m.x, m.y));
        }
        for text in &piece.engraved {
            self.label("engraved", text);
        }
        self.text.push_str("</g>\n");
    }

    fn polygon(&mut self, class: &str, line: &[DVec2]) {
        if line.len() < 2 {
            return;
        }
        self.put(format_args!("<polygon class=\"{class}\" points=\""));
        for (n, p) in line.iter().enumerate() {
            let p = self.at(*p);
            let space = if n == 0 { "" } else { " " };
            self.put(format_args!("{space}{:.2},{:.2}", p.x, p.y));
        }
        self.text.push_str("\"/>\n");
    }

    fn label(&mut self, class: &str, text: &DrawnText) {
        let p = self.at(text.origin);
        // Capitals of the usual faces are 0.72 of the font size.
        let size = text.height / 0.72;
        self.put(format_args!(
            "<text class=\"{class}\" transform=\"translate({:.2} {:.2}) rotate({:.3})\" font-size=\"{size:.2}\">{}</text>\n",
            p.x,
            p.y,
            0.0 - text.turn.to_degrees(),
            escaped(&text.text)
        ));
    }

    /// A double arrow, since grain has no sense.
    fn grain(&mut self, middle: DVec2, along: DVec2, length: f64) {
        let (barb, across) = (along * (0.22 * length), along.perp() * (0.13 * length));
        let (from, to) = (middle - along * (0.5 * length), middle + along * (0.5 * length));
        let [a, b, c, d, e, f] =
            [from + barb + across, from + barb - across, to - barb + across, to - barb - across, from, to]
                .map(|p| self.at(p));
        self.put(format_args!(
            "<path class=\"grain\" d=\"M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}M{:.2} {:.2}L{:.2} {:.2}L{:.2} {:.2}\
             M{:.2} {:.2}L{:.2} {:.2}\"><title>grain</title></path>\n",
            a.x, a.y, e.x, e.y, b.x, b.y, c.x, c.y, f.x, f.y, d.x, d.y, e.x, e.y, f.x, f.y
        ));
    }
}

fn escaped(text: &str) -> String {
    text.replace('&', "&amp;").replace('<', "&lt;").replace('>', "&gt;")
}

#[cfg(test)]
mod tests {
    use super::super::{draw, fixture};
    use super::*;

    #[test]
    fn shows_every_piece_on_its_board() {
        let drawing = draw(&fixture::parts(), &fixture::layout()).unwrap();
        let svg = String::from_utf8(write_svg(&drawing, Some(DVec2::Y), &|| true)).unwrap();
        let (one, two) = svg.split_once("id=\"board-2\"").unwrap();
        assert!(one.contains(">3.0</text>") && !one.contains(">3.2</text>") && two.contains(">3.2</text>"));
        assert_eq!(svg.matches("class=\"hole\"").count(), 2);
        assert_eq!(svg.matches("class=\"grain\"").count(), 2);
        assert_eq!(svg.matches("<g").count(), svg.matches("</g>").count());
        // 222 × 83 on 400 × 300.
        assert!(one.contains("Board 1 · 1 piece · 15 % filled"), "{one}");
        // The upper face's first corner: 24 mm edge + 40, and 24 + 36 head + 300 - 50 from the top.
        assert!(one.contains("class=\"upper\" points=\"64.00,310.00 "), "{one}");
        assert!(!write_svg(&drawing, None, &|| true).windows(5).any(|w| w == b"grain\""));
    }
}
