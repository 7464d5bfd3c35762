//! Rules for fasteners along edges: which edges, which fastener, how far apart (000 §6.4).

use super::issue::FastenerError;
use crate::board::Up;
use glam::DVec3;
use std::f64::consts::{FRAC_PI_2, FRAC_PI_4, PI};

/// Which edges a rule is for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum EdgeSelection {
    /// All edges.
    All,
    /// Edges between two panels.
    Inner,
    /// Edges without a neighbour.
    Border,
    /// Inner edges that run along the rows: bottom and top sides.
    AlongRows,
    /// Inner edges that run across the rows: left and right sides.
    AcrossRows,
}

/// Which of the two panels of an edge is the first: it holds the screw's head and the first of two depths.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Head {
    /// The panel of the lower address.
    LowerAddress,
    /// The panel of the higher address.
    HigherAddress,
    /// By turns along the edge, the lower address first.
    Alternate,
}

/// Direction of a pin, from the first panel to the second.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Direction {
    /// Perpendicular to the shared chamfer.
    ChamferNormal,
    /// In the plane normal to the edge, at this angle (radians, within ±π/2) to the first panel's face; positive: sinking
    /// from the front towards the back.
    Section(f64),
    /// Along a given vector of any length; it is turned to point from the first panel to the second.
    Given(DVec3),
}

/// Length of the fasteners to be bought.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum ToeLength {
    /// This one, mm; where it would leave the wood, none is laid.
    Given(f64),
    /// The longest trade length that the hole takes.
    Longest,
}

/// What is put into the holes.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum PinKind {
    /// A screw; the holes are pilots.
    Screw,
    /// A hard-wood dowel.
    Dowel,
}

/// A fastener driven from the face of one panel obliquely through the chamfer into the neighbour. A straight hole through
/// both chamfers can be drilled from one side in both panels only where they fold towards that side; this one always.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Toe {
    /// What it is.
    pub kind: PinKind,
    /// The face from which it is driven: the one that lies up on the machine.
    pub up: Up,
    /// Angle between fastener and face in the plane normal to the edge, radians, 0 to π/2.
    pub angle: f64,
    /// Diameter of the hole, mm.
    pub hole: f64,
    /// Wanted depth of the hole in the neighbour, mm; made shallower where the cover asks for it.
    pub bite: f64,
    /// The least depth in the neighbour, mm.
    pub least_bite: f64,
    /// Diameter of the fastener, mm.
    pub diameter: f64,
    /// Length of the fastener.
    pub length: ToeLength,
}

/// A straight fastener in matched blind holes of both chamfers.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct Pin {
    /// What it is.
    pub kind: PinKind,
    /// Diameter of the holes, mm.
    pub hole: f64,
    /// Depth of the holes in the first and in the second panel, mm.
    pub depth: [f64; 2],
    /// Direction.
    pub direction: Direction,
    /// Diameter of the fastener, mm.
    pub diameter: f64,
    /// Length of the fastener, mm; at most the sum of both depths.
    pub length: f64,
}

/// A kind of fastener with its measures.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Fastener {
    /// Obliquely from a face, also in thin boards.
    Toe(Toe),
    /// Screw or dowel through the chamfer.
    Pin(Pin),
}

/// Height of the fastener line on the chamfer.
#[derive(Clone, Copy, Debug, PartialEq)]
pub enum Height {
    /// b of `a·v + b·v'`: 0 on the front edge, 1 on the back edge.
    At(f64),
    /// Per edge where the holes keep as much wood towards the front as towards the back (for toe screws: their mouths in
    /// the chamfer). On leaning chamfers this allows deeper holes than mid-height.
    Balanced,
}

/// What is done with an edge too short for two fasteners.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum ShortEdge {
    /// One fastener in the middle.
    Middle,
    /// None.
    Nothing,
}

/// A rule for fasteners along edges.
#[derive(Clone, Copy, Debug, PartialEq)]
pub struct FastenerRule {
    /// Which edges.
    pub edges: EdgeSelection,
    /// Which fastener.
    pub fastener: Fastener,
    /// Which panel is the first.
    pub head: Head,
    /// Height of the fastener line on the chamfer.
    pub height: Height,
    /// Distance of the outermost fasteners from the ends of their line, `d_b`, mm.
    pub end_distance: f64,
    /// Greatest spacing, mm.
    pub spacing: f64,
    /// Least spacing: an edge that leaves less for two is short, mm.
    pub least_spacing: f64,
    /// What is done with a short edge.
    pub short_edge: ShortEdge,
    /// Least wood that remains between a hole and any face that it does not go through, and between two holes, mm.
    pub cover: f64,
    /// Full angle of the drill's point, radians; π for a flat tip.
    pub point_angle: f64,
    /// Least angle between fastener and chamfer, radians.
    pub least_crossing: f64,
}

impl FastenerRule {
    fn new(fastener: Fastener) -> Self {
        Self {
            edges: EdgeSelection::Inner,
            fastener,
            head: Head::LowerAddress,
            height: Height::At(0.5),
            end_distance: 40.0,
            spacing: 150.0,
            least_spacing: 20.0,
            short_edge: ShortEdge::Middle,
            cover: 1.0,
            point_angle: 118f64.to_radians(),
            least_crossing: 15f64.to_radians(),
        }
    }

    /// Toe screws on inner edges for thin boards: 3 mm pilots at 45° to the `up` face, by turns from both panels.
    #[must_use]
    pub fn toe_screws(up: Up) -> Self {
        let screw = Toe {
            kind: PinKind::Screw,
            up,
            angle: FRAC_PI_4,
            hole: 3.0,
            bite: 20.0,
            least_bite: 2.0,
            diameter: 3.5,
            length: ToeLength::Longest,
        };
        Self { head: Head::Alternate, ..Self::new(Fastener::Toe(screw)) }
    }

    /// Dowels of 6 mm on inner edges, driven at 45° to the `up` face, by turns from both panels, as long as fits.
    #[must_use]
    pub fn toe_dowels(up: Up) -> Self {
        let dowel = Toe {
            kind: PinKind::Dowel,
            up,
            angle: FRAC_PI_4,
            hole: 6.0,
            bite: 25.0,
            least_bite: 6.0,
            diameter: 6.0,
            length: ToeLength::Longest,
        };
        Self { head: Head::Alternate, cover: 2.0, ..Self::new(Fastener::Toe(dowel)) }
    }

    /// Screws 5 × 60 perpendicular to the chamfer with 3 mm pilots, 30 mm deep in both panels.
    #[must_use]
    pub fn screws() -> Self {
        Self::new(Fastener::Pin(Pin {
            kind: PinKind::Screw,
            hole: 3.0,
            depth: [30.0, 30.0],
            direction: Direction::ChamferNormal,
            diameter: 5.0,
            length: 60.0,
        }))
    }

    /// Dowels 6 × 40 in holes 21 mm deep in both panels.
    #[must_use]
    pub fn dowels(direction: Direction) -> Self {
        let pin = Pin { kind: PinKind::Dowel, hole: 6.0, depth: [21.0, 21.0], direction, diameter: 6.0, length: 40.0 };
        Self { cover: 2.0, ..Self::new(Fastener::Pin(pin)) }
    }

    /// Diameter of the holes, mm.
    #[must_use]
    pub fn hole(&self) -> f64 {
        match self.fastener {
            Fastener::Toe(t) => t.hole,
            Fastener::Pin(p) => p.hole,
        }
    }

    pub(super) fn check(&self) -> Result<(), FastenerError> {
        let mut lengths = vec![
            ("spacing", self.spacing),
            ("hole diameter", self.hole()),
            ("end distance", self.end_distance),
            ("least spacing", self.least_spacing),
            ("cover", self.cover),
        ];
        let zero_is_fine = ["end distance", "least spacing", "cover", "least bite"];
        let mut angles = vec![
            ("point angle", self.point_angle, [0.0, PI]),
            ("least crossing angle", self.least_crossing, [0.0, FRAC_PI_2]),
        ];
        match self.fastener {
            Fastener::Toe(t) => {
                lengths.extend([("bite", t.bite), ("least bite", t.least_bite), ("diameter", t.diameter)]);
                if let ToeLength::Given(length) = t.length {
                    lengths.push(("length", length));
                }
                angles.push(("toe angle", t.angle, [0.0, FRAC_PI_2]));
            }
            Fastener::Pin(p) => {
                lengths.extend([("depth", p.depth[0]), ("depth", p.depth[1])]);
                lengths.extend([("diameter", p.diameter), ("length", p.length)]);
                match p.direction {
                    Direction::Section(angle) => angles.push(("direction", angle, [-FRAC_PI_2, FRAC_PI_2])),
                    Direction::Given(v) if v.try_normalize().is_none() => {
                        return Err(FastenerError::Parameter {
                            name: "direction",
                            value: v.length(),
                            range: "a vector that is not zero",
                        });
                    }
                    _ => {}
                }
                if p.length > p.depth[0] + p.depth[1] {
                    return Err(FastenerError::PinTooLong { length: p.length, depth: p.depth });
                }
            }
        }
        for (name, value) in lengths {
            if !value.is_finite() || value < 0.0 || (value == 0.0 && !zero_is_fine.contains(&name)) {
                return Err(FastenerError::Parameter { name, value, range: "a positive number of millimetres" });
            }
        }
        for (name, value, [min, max]) in angles {
            let flat = name == "point angle" && value == PI;
            let within = value > min && value < max;
            if !flat && !within {
                return Err(FastenerError::Angle { name, value, min, max });
            }
        }
        if let Height::At(value) = self.height
            && !(0.0..=1.0).contains(&value)
        {
            let range = "between 0 (front edge) and 1 (back edge)";
            return Err(FastenerError::Parameter { name: "height", value, range });
        }
        Ok(())
    }
}
