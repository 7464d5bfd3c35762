//! The engine's trees as values of the contract. Nothing that grows with the number of points, corners or rows is copied;
//! texts and features, which hold texts, get a small struct each around what they hold.

use crate::value::{Plane, Point, Table, V, Vector};
use std::borrow::Cow;
use tenon_engine::{Column, File, Text, Tree};
use tenon_geometry::ifs::Curve;
use tenon_geometry::joint::{Feature, FeatureSet, Machining};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;
use tenon_plugin::abi::value::{tenon_plane, tenon_vec3};
use tenon_plugin::value as c;

/// A tree's branches as the other side sees them. O(branches), plus O(items) for texts, curves, meshes, panel sets, tables
/// and files, whatever they hold, and O(features) for feature sets.
#[must_use]
pub fn branches(tree: &Tree) -> Vec<c::Branch<'_>> {
    tree.branches().iter().map(|(path, column)| branch(path.steps(), column)).collect()
}

/// One column as a branch at `path`.
fn branch<'a>(path: &'a [i32], column: &'a Column) -> c::Branch<'a> {
    c::Branch { path: Cow::Borrowed(path), items: items(column), valid: valid(column) }
}

fn valid(column: &Column) -> Option<Cow<'_, [bool]>> {
    column.valid().map(Cow::Borrowed)
}

fn items(column: &Column) -> c::Items<'_> {
    if let Some(v) = column.slice::<f64>() {
        c::Items::Number(v.into())
    } else if let Some(v) = column.slice::<i64>() {
        c::Items::Integer(v.into())
    } else if let Some(v) = column.slice::<bool>() {
        c::Items::Boolean(v.into())
    } else if let Some(v) = column.slice::<Text>() {
        c::Items::Text(v.iter().map(|t| Cow::Borrowed(&*t.0)).collect())
    } else if let Some(v) = column.slice::<Point>() {
        c::Items::Point(bytemuck::cast_slice::<Point, tenon_vec3>(v).into())
    } else if let Some(v) = column.slice::<Vector>() {
        c::Items::Vector(bytemuck::cast_slice::<Vector, tenon_vec3>(v).into())
    } else if let Some(v) = column.slice::<Plane>() {
        c::Items::Plane(bytemuck::cast_slice::<Plane, tenon_plane>(v).into())
    } else if let Some(v) = column.slice::<V<Curve>>() {
        c::Items::Curve(v.iter().map(|x| curve(x)).collect())
    } else if let Some(v) = column.slice::<V<Mesh>>() {
        c::Items::Mesh(v.iter().map(|x| mesh(x)).collect())
    } else if let Some(v) = column.slice::<V<PanelSet>>() {
        c::Items::Panels(v.iter().map(|x| panels(x)).collect())
    } else if let Some(v) = column.slice::<V<FeatureSet>>() {
        c::Items::Features(v.iter().map(|x| features(x)).collect())
    } else if let Some(v) = column.slice::<Table>() {
        c::Items::Table(v.iter().map(table).collect())
    } else if let Some(v) = column.slice::<File>() {
        c::Items::File(v.iter().map(file).collect())
    } else {
        c::Items::Opaque { type_name: column.type_name().into(), count: column.len() }
    }
}

fn table(t: &Table) -> c::Table<'_> {
    let attributes = t.attributes().map(|(name, column)| c::Attribute {
        name: name.into(),
        items: items(column),
        valid: valid(column),
    });
    c::Table { rows: t.rows(), attributes: attributes.collect() }
}

fn curve(v: &Curve) -> c::Curve<'_> {
    c::Curve { points: bytemuck::cast_slice(&v.points).into(), strip_start: (&*v.strip_start).into(), closed: v.closed }
}

fn mesh(m: &Mesh) -> c::Mesh<'_> {
    c::Mesh {
        points: bytemuck::cast_slice(&m.points).into(),
        face_start: (&*m.face_start).into(),
        face_vertices: (&*m.face_vertices).into(),
        addresses: bytemuck::cast_slice(&m.addresses).into(),
    }
}

fn panels(p: &PanelSet) -> c::Panels<'_> {
    c::Panels {
        thickness: p.thickness,
        corner_start: (&*p.corner_start).into(),
        address: bytemuck::cast_slice(&p.address).into(),
        normal: bytemuck::cast_slice(&p.normal).into(),
        front: bytemuck::cast_slice(&p.front).into(),
        vertex: (&*p.vertex).into(),
        chamfer: bytemuck::cast_slice(&p.chamfer).into(),
        neighbour: bytemuck::cast_slice(&p.neighbour).into(),
        side: bytemuck::cast_slice(&p.side).into(),
        back_start: bytemuck::cast_slice(&p.back_start).into(),
        back_end: bytemuck::cast_slice(&p.back_end).into(),
        voided: (&*p.voided).into(),
    }
}

pub(crate) fn features(f: &FeatureSet) -> c::Features<'_> {
    let by_machine = f.features.iter().map(|x| feature(x, false));
    c::Features {
        features: by_machine.chain(f.by_hand.iter().map(|x| feature(x, true))).collect(),
        hardware: f.hardware.iter().map(|h| (Cow::Borrowed(&*h.name), h.count)).collect(),
    }
}

fn feature(f: &Feature, by_hand: bool) -> c::Feature<'_> {
    let v = |p: &tenon_geometry::DVec3| bytemuck::cast::<_, tenon_vec3>(*p);
    let machining = match &f.machining {
        Machining::Drill { entry, axis, depth, diameter } => {
            c::Machining::Drill { entry: v(entry), axis: v(axis), depth: *depth, diameter: *diameter }
        }
        Machining::Slot { from, to, axis, width, depth } => {
            c::Machining::Slot { from: v(from), to: v(to), axis: v(axis), width: *width, depth: *depth }
        }
        Machining::Pocket { outline, axis, depth } => {
            c::Machining::Pocket { outline: bytemuck::cast_slice(outline).into(), axis: v(axis), depth: *depth }
        }
        Machining::Contour { line, axis } => {
            c::Machining::Contour { line: bytemuck::cast_slice(line).into(), axis: v(axis) }
        }
        Machining::Engraving { origin, along, axis, height, depth, text } => c::Machining::Engraving {
            origin: v(origin),
            along: v(along),
            axis: v(axis),
            height: *height,
            depth: *depth,
            text: Cow::Borrowed(text),
        },
    };
    let purpose = Cow::Borrowed(&*f.purpose);
    c::Feature { panel: f.panel, edge: f.edge, joint: f.joint, by_hand, purpose, machining }
}

fn file(f: &File) -> c::File<'_> {
    c::File {
        name: Cow::Borrowed(&f.name),
        bytes: (&*f.bytes).into(),
        withheld: f.withheld.as_deref().map(Cow::Borrowed),
    }
}
