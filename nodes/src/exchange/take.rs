//! Values of the contract as the engine's trees. Arrays that changed hands become the engine's without a copy; what the
//! geometry relies on is checked.

use crate::value::{Point, Table, V, Vector};
use bytemuck::{Pod, cast_vec};
use std::any::Any;
use std::borrow::Cow;
use std::sync::Arc;
use tenon_engine::{Column, Item, Path, Text, Tree, stop};
use tenon_geometry::ifs::Curve;
use tenon_geometry::joint::{Feature, FeatureSet, Hardware, Machining};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::{EdgeRef, PanelSet, Side};
use tenon_geometry::{DVec3, Plane};
use tenon_plugin::abi::value::{tenon_edge, tenon_plane, tenon_vec3};
use tenon_plugin::value as c;

/// A tree of what crossed. O(size) for the digest; numbers, points and the arrays of meshes and panel sets are copied
/// only if they are borrowed.
///
/// # Errors
/// Says what the geometry could not work with: curves that are none, normals that are not units.
pub fn tree(branches: Vec<c::Branch<'_>>) -> Result<Tree, String> {
    let all = branches.into_iter().map(|b| Ok((Path::new(b.path.to_vec()), column(b.items, b.valid.as_deref())?)));
    Ok(Tree::from_branches(all.collect::<Result<_, String>>()?))
}

/// The same of arrays that somebody else owns and that stay as they are while `owner` lives. Numbers, integers, points
/// and vectors without gaps are shared with it; all else is copied. O(size) for the digest.
///
/// # Errors
/// As [`tree`].
pub fn lent_tree(branches: Vec<c::Branch<'static>>, owner: &Arc<dyn Any + Send + Sync>) -> Result<Tree, String> {
    let all = branches.into_iter().map(|b| {
        let path = Path::new(b.path.to_vec());
        let column = match (&b.items, &b.valid) {
            (c::Items::Number(Cow::Borrowed(v)), None) => {
                finite(v.iter().copied(), None)?;
                lent::<f64>(v, owner)
            }
            (c::Items::Integer(Cow::Borrowed(v)), None) => lent::<i64>(v, owner),
            (c::Items::Point(Cow::Borrowed(v)), None) => {
                finite(v.iter().map(|p| p.x + p.y + p.z), None)?;
                lent::<Point>(bytemuck::cast_slice(v), owner)
            }
            (c::Items::Vector(Cow::Borrowed(v)), None) => {
                finite(v.iter().map(|p| p.x + p.y + p.z), None)?;
                lent::<Vector>(bytemuck::cast_slice(v), owner)
            }
            _ => column(b.items, b.valid.as_deref())?,
        };
        Ok((path, column))
    });
    Ok(Tree::from_branches(all.collect::<Result<_, String>>()?))
}

/// Items and who owns them.
struct Lent<T: 'static> {
    items: &'static [T],
    _owner: Arc<dyn Any + Send + Sync>,
}

impl<T> AsRef<[T]> for Lent<T> {
    fn as_ref(&self) -> &[T] {
        self.items
    }
}

fn lent<T: Item>(items: &'static [T], owner: &Arc<dyn Any + Send + Sync>) -> Column {
    match items {
        [one] => Column::single(one.clone()),
        items => Column::lent(Lent { items, _owner: owner.clone() }),
    }
}

/// Items with gaps where `valid` says so.
fn gaps<T: Item>(items: Vec<T>, valid: Option<&[bool]>) -> Column {
    match valid {
        None => Column::new(items),
        Some(valid) => Column::with_gaps(items.into_iter().zip(valid).map(|(item, ok)| ok.then_some(item)).collect()),
    }
}

/// An array as one of our type of the same form.
fn array<A: Pod, B: Pod>(items: Cow<'_, [A]>) -> Vec<B> {
    match items {
        Cow::Owned(v) => cast_vec(v),
        Cow::Borrowed(v) => bytemuck::cast_slice(v).to_vec(),
    }
}

fn shared<A, B>(items: Vec<A>, valid: Option<&[bool]>, f: impl Fn(A) -> Result<B, String>) -> Result<Column, String>
where
    V<B>: Item,
{
    let made: Result<Vec<V<B>>, String> = items
        .into_iter()
        .enumerate()
        // What stands in a gap is not looked at, but has to be read.
        .map(|(i, item)| f(item).map(V::new).map_err(|why| format!("item {i}: {why}")))
        .collect();
    Ok(gaps(made?, valid))
}

fn column(items: c::Items<'_>, valid: Option<&[bool]>) -> Result<Column, String> {
    Ok(match items {
        c::Items::Boolean(v) => gaps(v.into_owned(), valid),
        c::Items::Integer(v) => gaps(v.into_owned(), valid),
        c::Items::Number(v) => {
            finite(v.iter().copied(), valid)?;
            gaps(v.into_owned(), valid)
        }
        c::Items::Text(v) => gaps(v.iter().map(|t| Text::from(&**t)).collect(), valid),
        c::Items::Point(v) => {
            finite(v.iter().map(|p| p.x + p.y + p.z), valid)?;
            gaps(array::<_, Point>(v), valid)
        }
        c::Items::Vector(v) => {
            finite(v.iter().map(|p| p.x + p.y + p.z), valid)?;
            gaps(array::<_, Vector>(v), valid)
        }
        c::Items::Plane(v) => shared(v.into_owned(), valid, plane)?,
        c::Items::Curve(v) => shared(v, valid, curve)?,
        c::Items::Mesh(v) => shared(v, valid, |m| {
            Ok(Mesh {
                points: array(m.points),
                face_start: m.face_start.into_owned(),
                face_vertices: m.face_vertices.into_owned(),
                addresses: array(m.addresses),
            })
        })?,
        c::Items::Panels(v) => shared(v, valid, panels)?,
        c::Items::Features(v) => shared(v, valid, features)?,
        c::Items::Table(v) => {
            let made = v.into_iter().enumerate().map(|(i, t)| table(t).map_err(|why| format!("item {i}: {why}")));
            gaps(made.collect::<Result<Vec<Table>, String>>()?, valid)
        }
        c::Items::Opaque { count: 0, .. } => Column::new::<f64>(Vec::new()),
        c::Items::File(_) | c::Items::Edges(_) | c::Items::Opaque { .. } => {
            return Err("files, edges and types that do not cross cannot be set".into());
        }
    })
}

fn finite(numbers: impl Iterator<Item = f64>, valid: Option<&[bool]>) -> Result<(), String> {
    let good = |i: usize| valid.is_none_or(|v| v.get(i).copied().unwrap_or(false));
    match numbers.enumerate().find(|(i, v)| !v.is_finite() && good(*i)) {
        Some((i, _)) => Err(format!("item {i} is not finite")),
        None => Ok(()),
    }
}

fn table(t: c::Table<'_>) -> Result<Table, String> {
    let add = |table: Table, a: c::Attribute<'_>| {
        let column = column(a.items, a.valid.as_deref()).map_err(|why| format!("attribute \"{}\": {why}", a.name))?;
        table.with(&a.name, column)
    };
    t.attributes.into_iter().try_fold(Table::new(t.rows), add)
}

fn plane(p: tenon_plane) -> Result<Plane, String> {
    let plane: Plane = bytemuck::cast(p);
    if !(is_unit(plane.normal) && plane.offset.is_finite()) {
        return Err(format!(
            "a plane's normal has length {}, not 1, or its offset is not finite",
            plane.normal.length()
        ));
    }
    Ok(plane)
}

fn is_unit(v: DVec3) -> bool {
    (v.length() - 1.0).abs() < 1e-6
}

fn curve(v: c::Curve<'_>) -> Result<Curve, String> {
    Curve::strips_of(array(v.points), v.strip_start.into_owned(), v.closed).map_err(|e| e.to_string())
}

pub(crate) fn panels(p: c::Panels<'_>) -> Result<PanelSet, String> {
    if p.thickness <= 0.0 {
        return Err(format!("a panel set of thickness {} mm", p.thickness));
    }
    let set = PanelSet {
        thickness: p.thickness,
        address: array(p.address),
        normal: array(p.normal),
        corner_start: p.corner_start.into_owned(),
        front: array(p.front),
        vertex: p.vertex.into_owned(),
        chamfer: array(p.chamfer),
        neighbour: p.neighbour.iter().map(|n| neighbour(*n)).collect(),
        side: p.side.iter().map(|s| bytemuck::checked::try_cast(*s).unwrap_or(Side::Other)).collect(),
        back_start: array(p.back_start),
        back_end: array(p.back_end),
        voided: p.voided.into_owned(),
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

fn neighbour(n: tenon_edge) -> Option<EdgeRef> {
    (n != tenon_edge::NONE).then_some(EdgeRef { panel: n.panel, edge: n.edge })
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
        n if n >= least => Ok(array::<_, DVec3>(points)),
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
