//! Safe values as C values: views that borrow the arrays and own only the small structs around them. Making a pointer
//! needs no `unsafe`; reading it is the other side's business.

use crate::abi::value::*;
use crate::value::{Attribute, Branch, Curve, Feature, Features, File, Items, Machining, Mesh, Panels, Table};
use std::ffi::c_void;
use std::marker::PhantomData;

/// A tree as the other side reads it. Its pointers stay where they are when this is moved, and are good as long as it
/// and what it was made of live.
#[derive(Debug)]
pub struct CTree<'a> {
    tree: tenon_tree,
    _branches: Vec<tenon_branch>,
    _items: Vec<Structs>,
    _from: PhantomData<&'a ()>,
}

// SAFETY: a view holds pointers to memory that it owns or borrows for 'a, and nobody writes there while it lives.
unsafe impl Send for CTree<'_> {}
// SAFETY: see above; sharing it shares only reading.
unsafe impl Sync for CTree<'_> {}

/// The arrays of one feature set.
type FeatureArrays = (Vec<tenon_feature>, Vec<tenon_hardware>);

/// The structs around borrowed arrays.
#[derive(Debug)]
#[expect(dead_code, reason = "kept alive for the pointers into them")]
enum Structs {
    None,
    Texts(Vec<tenon_str>),
    Curves(Vec<tenon_curve>),
    Meshes(Vec<tenon_mesh>),
    Panels(Vec<tenon_panels>),
    Features(Vec<tenon_features>, Vec<FeatureArrays>),
    Files(Vec<tenon_file>),
    Tables(Vec<tenon_table>, Vec<(Vec<tenon_attribute>, Vec<Structs>)>),
}

/// Bytes of a struct, as its first field says it.
const fn size<T>() -> u32 {
    size_of::<T>() as u32
}

fn some<T>(items: &[T]) -> *const T {
    if items.is_empty() { std::ptr::null() } else { items.as_ptr() }
}

impl<'a> CTree<'a> {
    /// A view of branches. O(branches), plus O(items) for texts, curves, meshes, panel sets, features and files; never
    /// copies what they hold.
    #[must_use]
    pub fn new(branches: &'a [Branch<'a>]) -> Self {
        let mut items = Vec::with_capacity(branches.len());
        let branches: Vec<tenon_branch> = branches
            .iter()
            .map(|b| {
                let (mut column, structs) = column(&b.items);
                items.push(structs);
                column.valid = b.valid.as_ref().map_or(std::ptr::null(), |v| v.as_ptr().cast());
                tenon_branch { path: b.path.as_ptr(), path_count: b.path.len() as u64, column }
            })
            .collect();
        let tree = tenon_tree {
            size: size::<tenon_tree>(),
            branch_stride: size::<tenon_branch>(),
            branches: some(&branches),
            branch_count: branches.len() as u64,
        };
        Self { tree, _branches: branches, _items: items, _from: PhantomData }
    }

    /// The C struct; its pointers are good as long as `self`.
    #[must_use]
    pub fn get(&self) -> tenon_tree {
        self.tree
    }
}

fn plain<T>(kind: tenon_kind, name: &str, items: &[T]) -> tenon_column {
    tenon_column {
        size: size::<tenon_column>(),
        kind,
        type_name: tenon_str::of(name),
        items: some(items).cast::<c_void>(),
        count: items.len() as u64,
        stride: size_of::<T>() as u64,
        valid: std::ptr::null(),
    }
}

fn column(items: &Items<'_>) -> (tenon_column, Structs) {
    let simple = match items {
        Items::Boolean(v) => plain(TENON_BOOLEAN, "boolean", v),
        Items::Integer(v) => plain(TENON_INTEGER, "integer", v),
        Items::Number(v) => plain(TENON_NUMBER, "number", v),
        Items::Point(v) => plain(TENON_POINT, "point", v),
        Items::Vector(v) => plain(TENON_VECTOR, "vector", v),
        Items::Plane(v) => plain(TENON_PLANE, "plane", v),
        Items::Edges(v) => plain(TENON_EDGES, "edges", v),
        Items::Opaque { type_name, count } => {
            tenon_column { count: *count as u64, ..plain::<u8>(TENON_OPAQUE, type_name, &[]) }
        }
        Items::Text(v) => {
            let all: Vec<tenon_str> = v.iter().map(|t| tenon_str::of(t)).collect();
            return (plain(TENON_TEXT, "text", &all), Structs::Texts(all));
        }
        Items::Curve(v) => {
            let all: Vec<tenon_curve> = v.iter().map(curve).collect();
            return (plain(TENON_CURVE, "curve", &all), Structs::Curves(all));
        }
        Items::Mesh(v) => {
            let all: Vec<tenon_mesh> = v.iter().map(mesh).collect();
            return (plain(TENON_MESH, "mesh", &all), Structs::Meshes(all));
        }
        Items::Panels(v) => {
            let all: Vec<tenon_panels> = v.iter().map(panels).collect();
            return (plain(TENON_PANELS, "panels", &all), Structs::Panels(all));
        }
        Items::Features(v) => {
            let kept: Vec<_> = v.iter().map(feature_arrays).collect();
            let all: Vec<tenon_features> = kept.iter().map(|(f, h)| features(f, h)).collect();
            return (plain(TENON_FEATURES, "features", &all), Structs::Features(all, kept));
        }
        Items::Table(v) => {
            let kept: Vec<_> = v.iter().map(attributes).collect();
            let table = |(t, (attributes, _)): (&Table<'_>, &(Vec<tenon_attribute>, _))| tenon_table {
                size: size::<tenon_table>(),
                attribute_stride: size::<tenon_attribute>(),
                row_count: t.rows as u64,
                attributes: some(attributes),
                attribute_count: attributes.len() as u64,
            };
            let all: Vec<tenon_table> = v.iter().zip(&kept).map(table).collect();
            return (plain(TENON_TABLE, "table", &all), Structs::Tables(all, kept));
        }
        Items::File(v) => {
            let all: Vec<tenon_file> = v.iter().map(file).collect();
            return (plain(TENON_FILE, "file", &all), Structs::Files(all));
        }
    };
    (simple, Structs::None)
}

fn attributes(t: &Table<'_>) -> (Vec<tenon_attribute>, Vec<Structs>) {
    let mut kept = Vec::with_capacity(t.attributes.len());
    let attribute = |a: &Attribute<'_>| {
        let (mut column, structs) = column(&a.items);
        kept.push(structs);
        column.valid = a.valid.as_ref().map_or(std::ptr::null(), |v| v.as_ptr().cast());
        tenon_attribute { name: tenon_str::of(&a.name), column }
    };
    (t.attributes.iter().map(attribute).collect(), kept)
}

fn curve(c: &Curve<'_>) -> tenon_curve {
    tenon_curve {
        size: size::<tenon_curve>(),
        closed: u32::from(c.closed),
        points: some(&c.points),
        point_count: c.points.len() as u64,
        strip_start: some(&c.strip_start),
        strip_count: c.strip_start.len().saturating_sub(1) as u64,
    }
}

fn mesh(m: &Mesh<'_>) -> tenon_mesh {
    tenon_mesh {
        size: size::<tenon_mesh>(),
        flags: 0,
        points: some(&m.points),
        point_count: m.points.len() as u64,
        face_start: some(&m.face_start),
        face_count: m.face_start.len().saturating_sub(1) as u64,
        face_vertices: some(&m.face_vertices),
        face_vertex_count: m.face_vertices.len() as u64,
        addresses: some(&m.addresses),
    }
}

fn panels(p: &Panels<'_>) -> tenon_panels {
    tenon_panels {
        size: size::<tenon_panels>(),
        flags: 0,
        thickness: p.thickness,
        panel_count: p.len() as u64,
        corner_count: p.front.len() as u64,
        corner_start: some(&p.corner_start),
        address: some(&p.address),
        normal: some(&p.normal),
        front: some(&p.front),
        vertex: some(&p.vertex),
        chamfer: some(&p.chamfer),
        neighbour: some(&p.neighbour),
        side: some(&p.side),
        back_start: some(&p.back_start),
        back_end: some(&p.back_end),
        voided: some(&p.voided).cast(),
    }
}

fn feature_arrays(f: &Features<'_>) -> FeatureArrays {
    let hardware = f.hardware.iter().map(|(name, count)| tenon_hardware { name: tenon_str::of(name), count: *count });
    (f.features.iter().map(feature).collect(), hardware.collect())
}

fn features(features: &[tenon_feature], hardware: &[tenon_hardware]) -> tenon_features {
    tenon_features {
        size: size::<tenon_features>(),
        feature_stride: size::<tenon_feature>(),
        features: some(features),
        feature_count: features.len() as u64,
        hardware: some(hardware),
        hardware_count: hardware.len() as u64,
    }
}

fn feature(f: &Feature<'_>) -> tenon_feature {
    let mut c = tenon_feature {
        size: size::<tenon_feature>(),
        kind: TENON_DRILL,
        panel: f.panel,
        edge: f.edge.unwrap_or(TENON_NONE),
        joint: f.joint.unwrap_or(TENON_NONE),
        by_hand: u32::from(f.by_hand),
        at: tenon_vec3::default(),
        to: tenon_vec3::default(),
        axis: tenon_vec3::default(),
        depth: 0.0,
        width: 0.0,
        line: std::ptr::null(),
        line_count: 0,
        text: tenon_str { ptr: std::ptr::null(), len: 0 },
        purpose: tenon_str::of(&f.purpose),
    };
    match &f.machining {
        Machining::Drill { entry, axis, depth, diameter } => {
            (c.at, c.axis, c.depth, c.width) = (*entry, *axis, *depth, *diameter);
        }
        Machining::Slot { from, to, axis, width, depth } => {
            (c.kind, c.at, c.to, c.axis, c.width, c.depth) = (TENON_SLOT, *from, *to, *axis, *width, *depth);
        }
        Machining::Pocket { outline, axis, depth } => {
            (c.kind, c.axis, c.depth) = (TENON_POCKET, *axis, *depth);
            (c.line, c.line_count) = (some(outline), outline.len() as u64);
        }
        Machining::Contour { line, axis } => {
            (c.kind, c.axis) = (TENON_CONTOUR, *axis);
            (c.line, c.line_count) = (some(line), line.len() as u64);
        }
        Machining::Engraving { origin, along, axis, height, depth, text } => {
            (c.kind, c.at, c.to, c.axis) = (TENON_ENGRAVING, *origin, *along, *axis);
            (c.width, c.depth, c.text) = (*height, *depth, tenon_str::of(text));
        }
    }
    c
}

fn file(f: &File<'_>) -> tenon_file {
    tenon_file {
        name: tenon_str::of(&f.name),
        bytes: some(&f.bytes),
        byte_count: f.bytes.len() as u64,
        withheld: f.withheld.as_deref().map_or(tenon_str { ptr: std::ptr::null(), len: 0 }, tenon_str::of),
    }
}
