//! Values without pointers: what safe code on both sides of the boundary works with. Arrays are borrowed from whoever
//! owns them, or owned when they were made in a buffer that changed hands.

use crate::abi::value::{tenon_address, tenon_edge, tenon_edge_pair, tenon_plane, tenon_vec3, tenon_vec4};
use std::borrow::Cow;

/// A branch of a tree.
#[derive(Clone, Debug, PartialEq)]
pub struct Branch<'a> {
    /// Where it hangs; `[0]` for a single list.
    pub path: Cow<'a, [i32]>,
    /// Its items.
    pub items: Items<'a>,
    /// Per item whether it is there; `None`: all are.
    pub valid: Option<Cow<'a, [bool]>>,
}

impl<'a> Branch<'a> {
    /// Items at `{0}`, without gaps.
    #[must_use]
    pub fn root(items: Items<'a>) -> Self {
        Self { path: Cow::Borrowed(&[0]), items, valid: None }
    }
}

/// Items of one type.
#[derive(Clone, Debug, PartialEq)]
pub enum Items<'a> {
    /// Truth values.
    Boolean(Cow<'a, [bool]>),
    /// Whole numbers.
    Integer(Cow<'a, [i64]>),
    /// Numbers.
    Number(Cow<'a, [f64]>),
    /// Texts.
    Text(Vec<Cow<'a, str>>),
    /// Points, mm.
    Point(Cow<'a, [tenon_vec3]>),
    /// Vectors.
    Vector(Cow<'a, [tenon_vec3]>),
    /// Planes.
    Plane(Cow<'a, [tenon_plane]>),
    /// Curves.
    Curve(Vec<Curve<'a>>),
    /// Meshes.
    Mesh(Vec<Mesh<'a>>),
    /// Panel sets.
    Panels(Vec<Panels<'a>>),
    /// Feature sets.
    Features(Vec<Features<'a>>),
    /// Files.
    File(Vec<File<'a>>),
    /// Tables of attributes.
    Table(Vec<Table<'a>>),
    /// Edges selected for a fastener.
    Edges(Cow<'a, [tenon_edge_pair]>),
    /// Items of a type that does not cross.
    Opaque {
        /// Its name.
        type_name: Cow<'a, str>,
        /// How many there are.
        count: usize,
    },
}

impl Items<'_> {
    /// Number of items.
    #[must_use]
    pub fn len(&self) -> usize {
        match self {
            Self::Boolean(v) => v.len(),
            Self::Integer(v) => v.len(),
            Self::Number(v) => v.len(),
            Self::Text(v) => v.len(),
            Self::Point(v) | Self::Vector(v) => v.len(),
            Self::Plane(v) => v.len(),
            Self::Curve(v) => v.len(),
            Self::Mesh(v) => v.len(),
            Self::Panels(v) => v.len(),
            Self::Features(v) => v.len(),
            Self::File(v) => v.len(),
            Self::Table(v) => v.len(),
            Self::Edges(v) => v.len(),
            Self::Opaque { count, .. } => *count,
        }
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }
}

/// A polyline in homogeneous coordinates, or several.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Curve<'a> {
    /// Points of all strips.
    pub points: Cow<'a, [tenon_vec4]>,
    /// First point of each strip, then the number of points.
    pub strip_start: Cow<'a, [u32]>,
    /// Whether the last point is joined to the first.
    pub closed: bool,
}

/// A polygon mesh; see `tenon_mesh`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Mesh<'a> {
    /// Vertices, mm.
    pub points: Cow<'a, [tenon_vec3]>,
    /// Where each face's loop starts, then the end.
    pub face_start: Cow<'a, [u32]>,
    /// Vertex indices of all loops.
    pub face_vertices: Cow<'a, [u32]>,
    /// One per face, or none.
    pub addresses: Cow<'a, [tenon_address]>,
}

/// A panel set; see `tenon_panels`.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Panels<'a> {
    /// Thickness, mm.
    pub thickness: f64,
    /// First corner of each panel, then the number of corners.
    pub corner_start: Cow<'a, [u32]>,
    /// Per panel.
    pub address: Cow<'a, [tenon_address]>,
    /// Per panel: unit normal of the front face.
    pub normal: Cow<'a, [tenon_vec3]>,
    /// Per corner.
    pub front: Cow<'a, [tenon_vec3]>,
    /// Per corner: vertex of the mesh.
    pub vertex: Cow<'a, [u32]>,
    /// Per edge.
    pub chamfer: Cow<'a, [tenon_plane]>,
    /// Per edge; `tenon_edge::NONE` at the border.
    pub neighbour: Cow<'a, [tenon_edge]>,
    /// Per edge: `TENON_SIDE_*`.
    pub side: Cow<'a, [u8]>,
    /// Per edge: start on the back.
    pub back_start: Cow<'a, [tenon_vec3]>,
    /// Per edge: end on the back.
    pub back_end: Cow<'a, [tenon_vec3]>,
    /// Per corner: whether the node is voided.
    pub voided: Cow<'a, [bool]>,
}

impl Panels<'_> {
    /// Number of panels, failed ones included.
    #[must_use]
    pub fn len(&self) -> usize {
        self.corner_start.len().saturating_sub(1)
    }

    /// Whether there are none.
    #[must_use]
    pub fn is_empty(&self) -> bool {
        self.len() == 0
    }

    /// Range of the corners and edges of a panel; empty for a failed panel and past the end.
    #[must_use]
    pub fn corners(&self, panel: usize) -> std::ops::Range<usize> {
        match (self.corner_start.get(panel), self.corner_start.get(panel + 1)) {
            (Some(start), Some(end)) => *start as usize..*end as usize,
            _ => 0..0,
        }
    }
}

/// The shape of a feature; see the `TENON_DRILL` family.
#[derive(Clone, Debug, PartialEq)]
pub enum Machining<'a> {
    /// A round hole from `entry` along `axis`.
    Drill {
        /// Where its axis enters the panel.
        entry: tenon_vec3,
        /// Unit direction into the wood.
        axis: tenon_vec3,
        /// Depth along the axis, mm.
        depth: f64,
        /// Diameter, mm.
        diameter: f64,
    },
    /// A slot of rectangular section.
    Slot {
        /// Start of the floor line.
        from: tenon_vec3,
        /// End of the floor line.
        to: tenon_vec3,
        /// Unit direction into the wood.
        axis: tenon_vec3,
        /// Width, mm.
        width: f64,
        /// Depth, mm.
        depth: f64,
    },
    /// A pocket with flat floor.
    Pocket {
        /// Outline on the surface, counter-clockwise seen against `axis`.
        outline: Cow<'a, [tenon_vec3]>,
        /// Unit direction into the wood.
        axis: tenon_vec3,
        /// Depth, mm.
        depth: f64,
    },
    /// A cut through along a polyline.
    Contour {
        /// The line on the surface.
        line: Cow<'a, [tenon_vec3]>,
        /// Unit direction into the wood.
        axis: tenon_vec3,
    },
    /// Text in single strokes.
    Engraving {
        /// Lower left corner of the first glyph.
        origin: tenon_vec3,
        /// Unit reading direction.
        along: tenon_vec3,
        /// Unit direction into the wood.
        axis: tenon_vec3,
        /// Glyph height, mm.
        height: f64,
        /// Depth, mm.
        depth: f64,
        /// The text.
        text: Cow<'a, str>,
    },
}

/// One feature on one panel.
#[derive(Clone, Debug, PartialEq)]
pub struct Feature<'a> {
    /// Panel index.
    pub panel: u32,
    /// Edge that it belongs to.
    pub edge: Option<u32>,
    /// Number shared by features that must meet in space.
    pub joint: Option<u32>,
    /// Made by hand because the machine cannot.
    pub by_hand: bool,
    /// What it is for.
    pub purpose: Cow<'a, str>,
    /// Its shape.
    pub machining: Machining<'a>,
}

/// Features and the hardware that they take.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Features<'a> {
    /// Features.
    pub features: Vec<Feature<'a>>,
    /// Purchased parts: name and count.
    pub hardware: Vec<(Cow<'a, str>, u64)>,
}

/// Columns of as many rows, each under a name.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Table<'a> {
    /// Number of rows.
    pub rows: usize,
    /// Attributes, in order; no name twice.
    pub attributes: Vec<Attribute<'a>>,
}

impl<'a> Table<'a> {
    /// The attribute of that name. O(attributes).
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Attribute<'a>> {
        self.attributes.iter().find(|a| a.name == name)
    }
}

/// One attribute of every row of a table.
#[derive(Clone, Debug, PartialEq)]
pub struct Attribute<'a> {
    /// Its name.
    pub name: Cow<'a, str>,
    /// One item per row: truth values, numbers, texts, points, vectors or planes.
    pub items: Items<'a>,
    /// Per row whether it is there; `None`: all are.
    pub valid: Option<Cow<'a, [bool]>>,
}

/// A file that the graph made.
#[derive(Clone, Debug, PartialEq)]
pub struct File<'a> {
    /// Name relative to an output folder.
    pub name: Cow<'a, str>,
    /// Content.
    pub bytes: Cow<'a, [u8]>,
    /// Why it must not get its name unless a person insists.
    pub withheld: Option<Cow<'a, str>>,
}
