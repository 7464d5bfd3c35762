//! Values of the contract as the engine's trees. Arrays that changed hands, or that somebody lends, become the engine's without
//! a copy; what the geometry relies on is checked.

use crate::value::{Plane, Point, Table, V, Vector};
use bytemuck::{Pod, cast_vec};
use std::borrow::Cow;
use tenon_engine::{Column, Item, Path, Text, Tree, stop};
use tenon_geometry::DVec3;
use tenon_geometry::ifs::Curve;
use tenon_geometry::joint::{Feature, FeatureSet, Hardware, Machining};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::{PanelSet, Side};
use tenon_geometry::shared::{Owner, Shared};
use tenon_plugin::abi::value::{tenon_plane, tenon_vec3};
use tenon_plugin::value as c;

/// A tree of what crossed. O(size) for the digest; arrays are copied only if they are borrowed.
///
/// # Errors
/// Says what the geometry could not work with: curves that are none, normals that are not units.
pub fn tree(branches: Vec<c::Branch<'_>>) -> Result<Tree, String> {
    columns(branches).map(Tree::from_branches)
}

/// The branches of that tree, those of one path not yet joined.
pub(crate) fn columns(branches: Vec<c::Branch<'_>>) -> Result<Vec<(Path, Column)>, String> {
    columns_of(branches, &Copies)
}

/// The same of arrays that somebody else owns and that stay as they are while `owner` lives. Those of numbers, truth values,
/// points, vectors, planes, curves, meshes and panel sets, which items are gaps, and the columns of tables are read where they
/// lie; texts, features and single items are copied, and so are bytes that stand for truth values or sides and are none. O(size)
/// for the digest.
///
/// # Errors
/// As [`tree`].
pub fn lent_tree(branches: Vec<c::Branch<'static>>, owner: &Owner) -> Result<Tree, String> {
    columns_of(branches, &Lease(owner)).map(Tree::from_branches)
}

/// What becomes of borrowed arrays.
trait Keep<'a> {
    fn keep<T: Clone>(&self, items: &'a [T]) -> Kept<T>;
}

/// They are copied.
struct Copies;

/// They are shared with their owner.
struct Lease<'o>(&'o Owner);

/// An array that may stay.
enum Kept<T: 'static> {
    Own(Vec<T>),
    Lent(Shared<T>),
}

impl<'a> Keep<'a> for Copies {
    fn keep<T: Clone>(&self, items: &'a [T]) -> Kept<T> {
        Kept::Own(items.to_vec())
    }
}

impl Keep<'static> for Lease<'_> {
    fn keep<T: Clone>(&self, items: &'static [T]) -> Kept<T> {
        Kept::Lent(Shared::lent(items, self.0.clone()))
    }
}

impl<T> From<Kept<T>> for Shared<T> {
    fn from(kept: Kept<T>) -> Self {
        match kept {
            Kept::Own(items) => items.into(),
            Kept::Lent(items) => items,
        }
    }
}

fn columns_of<'a>(branches: Vec<c::Branch<'a>>, keep: &impl Keep<'a>) -> Result<Vec<(Path, Column)>, String> {
    let one = |b: c::Branch<'a>| Ok((Path::new(b.path.to_vec()), column(b.items, b.valid, keep)?));
    branches.into_iter().map(one).collect()
}

/// Which items are there; `None`: all are.
type Valid<'a> = Option<Cow<'a, [bool]>>;

fn is_there(valid: &Valid<'_>, i: usize) -> bool {
    valid.as_ref().is_none_or(|v| v.get(i).copied().unwrap_or(false))
}

/// An array as one of our type of the same form.
fn array<'a, A: Pod, B: Pod>(items: Cow<'a, [A]>, keep: &impl Keep<'a>) -> Kept<B> {
    match items {
        Cow::Owned(v) => Kept::Own(cast_vec(v)),
        Cow::Borrowed(v) => keep.keep(bytemuck::cast_slice(v)),
    }
}

fn truths<'a>(items: Cow<'a, [bool]>, keep: &impl Keep<'a>) -> Kept<bool> {
    match items {
        Cow::Owned(v) => Kept::Own(v),
        Cow::Borrowed(v) => keep.keep(v),
    }
}

/// A column of an array that may stay.
fn kept<'a, T: Item>(items: Kept<T>, valid: Valid<'a>, keep: &impl Keep<'a>) -> Column {
    let valid = valid.map(|v| truths(v, keep));
    match (items, valid) {
        (Kept::Own(items), None) => Column::new(items),
        (Kept::Own(items), Some(Kept::Own(valid))) => Column::with_valid(items, valid),
        (Kept::Lent(items), None) => Column::lent(items),
        (items, Some(valid)) => Column::lent_with_gaps(Shared::from(items), Shared::from(valid)),
    }
}

/// A column of items that were made one by one.
fn made<A, B: Item>(items: Vec<A>, valid: Valid<'_>, make: impl Fn(A) -> Result<B, String>) -> Result<Column, String> {
    let make = |(i, item)| match is_there(&valid, i) {
        true => make(item).map(Some).map_err(|why| format!("item {i}: {why}")),
        false => Ok(None),
    };
    let made: Vec<Option<B>> = items.into_iter().enumerate().map(make).collect::<Result<_, _>>()?;
    Ok(Column::with_gaps(made))
}

fn column<'a>(items: c::Items<'a>, valid: Valid<'a>, keep: &impl Keep<'a>) -> Result<Column, String> {
    Ok(match items {
        c::Items::Boolean(v) => kept(truths(v, keep), valid, keep),
        c::Items::Integer(v) => kept::<i64>(array(v, keep), valid, keep),
        c::Items::Number(v) => {
            finite(v.iter().copied(), &valid)?;
            kept::<f64>(array(v, keep), valid, keep)
        }
        c::Items::Text(v) => made(v, valid, |t| Ok(Text::from(&*t)))?,
        c::Items::Point(v) => {
            finite(v.iter().map(|p| p.x + p.y + p.z), &valid)?;
            kept::<Point>(array(v, keep), valid, keep)
        }
        c::Items::Vector(v) => {
            finite(v.iter().map(|p| p.x + p.y + p.z), &valid)?;
            kept::<Vector>(array(v, keep), valid, keep)
        }
        c::Items::Plane(v) => {
            let mut there = v.iter().enumerate().filter(|(i, _)| is_there(&valid, *i));
            there.try_for_each(|(i, p)| plane(*p).map_err(|why| format!("item {i}: {why}")))?;
            kept::<Plane>(array(v, keep), valid, keep)
        }
        c::Items::Curve(v) => made(v, valid, |x| curve(x, keep).map(V::new))?,
        c::Items::Mesh(v) => made(v, valid, |x| Ok(V::new(mesh(x, keep))))?,
        c::Items::Panels(v) => made(v, valid, |x| panel_set(x, keep).map(V::new))?,
        c::Items::Features(v) => made(v, valid, |x| features(x).map(V::new))?,
        c::Items::Table(v) => made(v, valid, |x| table(x, keep))?,
        c::Items::Opaque { count: 0, .. } => Column::new::<f64>(Vec::new()),
        c::Items::File(_) | c::Items::Edges(_) | c::Items::Opaque { .. } => {
            return Err("files, edges and types that do not cross cannot be set".into());
        }
    })
}

fn finite(numbers: impl Iterator<Item = f64>, valid: &Valid<'_>) -> Result<(), String> {
    match numbers.enumerate().find(|(i, v)| !v.is_finite() && is_there(valid, *i)) {
        Some((i, _)) => Err(format!("item {i} is not finite")),
        None => Ok(()),
    }
}

fn table<'a>(t: c::Table<'a>, keep: &impl Keep<'a>) -> Result<Table, String> {
    let add = |table: Table, a: c::Attribute<'a>| {
        let column = column(a.items, a.valid, keep).map_err(|why| format!("attribute \"{}\": {why}", a.name))?;
        table.with(&a.name, column)
    };
    t.attributes.into_iter().try_fold(Table::new(t.rows), add)
}

fn plane(p: tenon_plane) -> Result<(), String> {
    let plane: tenon_geometry::Plane = bytemuck::cast(p);
    if !(is_unit(plane.normal) && plane.offset.is_finite()) {
        return Err(format!(
            "a plane's normal has length {}, not 1, or its offset is not finite",
            plane.normal.length()
        ));
    }
    Ok(())
}

fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() < 1e-6
}

fn curve<'a>(v: c::Curve<'a>, keep: &impl Keep<'a>) -> Result<Curve, String> {
    Curve::strips_of(array(v.points, keep), array(v.strip_start, keep), v.closed).map_err(|e| e.to_string())
}

fn mesh<'a>(m: c::Mesh<'a>, keep: &impl Keep<'a>) -> Mesh {
    Mesh {
        points: array(m.points, keep).into(),
        face_start: array(m.face_start, keep).into(),
        face_vertices: array(m.face_vertices, keep).into(),
        addresses: array(m.addresses, keep).into(),
    }
}

/// A panel set of borrowed arrays, which are copied.
pub(crate) fn panels(p: c::Panels<'_>) -> Result<PanelSet, String> {
    panel_set(p, &Copies)
}

fn panel_set<'a>(p: c::Panels<'a>, keep: &impl Keep<'a>) -> Result<PanelSet, String> {
    if p.thickness <= 0.0 {
        return Err(format!("a panel set of thickness {} mm", p.thickness));
    }
    let set = PanelSet {
        thickness: p.thickness,
        address: array(p.address, keep).into(),
        normal: array(p.normal, keep).into(),
        corner_start: array(p.corner_start, keep).into(),
        front: array(p.front, keep).into(),
        vertex: array(p.vertex, keep).into(),
        chamfer: array(p.chamfer, keep).into(),
        neighbour: array(p.neighbour, keep).into(),
        side: sides(p.side, keep).into(),
        back_start: array(p.back_start, keep).into(),
        back_end: array(p.back_end, keep).into(),
        voided: truths(p.voided, keep).into(),
    };
    for i in 0..set.len() {
        if (1..3).contains(&set.corners(i).len()) {
            return Err(format!(
                "panel {i} has {} corners; 3 or more make a panel, 0 a failed one",
                set.corners(i).len()
            ));
        }
        if set.is_valid(i) && !is_unit(set.normal[i]) {
            return Err(format!("the normal of panel {i} has length {}, not 1", set.normal[i].length()));
        }
    }
    if let Some(k) = set.chamfer.iter().position(|c| !is_unit(c.normal)) {
        return Err(format!(
            "the chamfer of edge {k} has a normal of length {}, not 1",
            set.chamfer[k].normal.length()
        ));
    }
    Ok(set)
}

/// What is no side is one of no grid.
fn sides<'a>(sides: Cow<'a, [u8]>, keep: &impl Keep<'a>) -> Kept<Side> {
    let side = |s: u8| bytemuck::checked::try_cast(s).unwrap_or(Side::Other);
    match sides {
        // In place: both are one byte.
        Cow::Owned(v) => Kept::Own(v.into_iter().map(side).collect()),
        Cow::Borrowed(v) => match bytemuck::checked::try_cast_slice(v) {
            Ok(sides) => keep.keep(sides),
            Err(_) => Kept::Own(v.iter().map(|s| side(*s)).collect()),
        },
    }
}

fn features(f: c::Features<'_>) -> Result<FeatureSet, String> {
    let mut set = FeatureSet::default();
    for (i, f) in f.features.into_iter().enumerate() {
        if i.is_multiple_of(64) {
            stop::check();
        }
        let by_hand = f.by_hand;
        let f = feature(f).map_err(|why| format!("feature {i}: {why}"))?;
        if by_hand { set.by_hand.push(f) } else { set.features.push(f) }
    }
    set.features.sort_by_key(|f| f.panel);
    set.by_hand.sort_by_key(|f| f.panel);
    set.hardware = f.hardware.into_iter().map(|(name, count)| Hardware { name: name.into_owned(), count }).collect();
    Ok(set)
}

fn feature(f: c::Feature<'_>) -> Result<Feature, String> {
    let v = |p: tenon_vec3| -> DVec3 { bytemuck::cast(p) };
    let axis = |a: tenon_vec3| match v(a) {
        a if is_unit(a) => Ok(a),
        a => Err(format!("its axis has length {}, not 1", a.length())),
    };
    let positive = |what: &str, x: f64| match x > 0.0 {
        true => Ok(x),
        false => Err(format!("its {what} is {x} mm; it must be more than 0")),
    };
    let line = |points: Cow<'_, [tenon_vec3]>, least: usize| match points.len() {
        n if n >= least => Ok(match points {
            Cow::Owned(points) => cast_vec(points),
            Cow::Borrowed(points) => bytemuck::cast_slice(points).to_vec(),
        }),
        n => Err(format!("it has {n} points; {least} are the least")),
    };
    let machining = match f.machining {
        c::Machining::Drill { entry, axis: a, depth, diameter } => Machining::Drill {
            entry: v(entry),
            axis: axis(a)?,
            depth: positive("depth", depth)?,
            diameter: positive("diameter", diameter)?,
        },
        c::Machining::Slot { from, to, axis: a, width, depth } => Machining::Slot {
            from: v(from),
            to: v(to),
            axis: axis(a)?,
            width: positive("width", width)?,
            depth: positive("depth", depth)?,
        },
        c::Machining::Pocket { outline, axis: a, depth } => {
            Machining::Pocket { outline: line(outline, 3)?, axis: axis(a)?, depth: positive("depth", depth)? }
        }
        c::Machining::Contour { line: l, axis: a } => Machining::Contour { line: line(l, 2)?, axis: axis(a)? },
        c::Machining::Engraving { origin, along, axis: a, height, depth, text } => Machining::Engraving {
            origin: v(origin),
            along: axis(along)?,
            axis: axis(a)?,
            height: positive("height", height)?,
            depth: positive("depth", depth)?,
            text: text.into_owned(),
        },
    };
    let purpose = f.purpose.into_owned().into();
    Ok(Feature { panel: f.panel, edge: f.edge, joint: f.joint, purpose, machining })
}
