//! Large arrays cross without a copy, both ways: they come out at the addresses at which they went in.

use super::{branches, lent_tree, tree};
use std::borrow::Cow;
use std::sync::Arc;
use tenon_geometry::shared::Owner;
use tenon_plugin::abi::value::*;
use tenon_plugin::value::{Attribute, Branch, Curve, Items, Mesh, Panels, Table};

/// Every array of the branches that grows with what they hold: its name and its address.
pub(crate) fn arrays(branches: &[Branch<'_>]) -> Vec<(&'static str, usize)> {
    let mut all = Vec::new();
    for b in branches {
        of_items(&b.items, &mut all);
        all.extend(b.valid.as_ref().map(|v| ("valid", v.as_ptr().addr())));
    }
    all
}

fn of_items(items: &Items<'_>, all: &mut Vec<(&'static str, usize)>) {
    match items {
        Items::Boolean(v) => all.push(("truth values", v.as_ptr().addr())),
        Items::Integer(v) => all.push(("integers", v.as_ptr().addr())),
        Items::Number(v) => all.push(("numbers", v.as_ptr().addr())),
        Items::Point(v) => all.push(("points", v.as_ptr().addr())),
        Items::Vector(v) => all.push(("vectors", v.as_ptr().addr())),
        Items::Plane(v) => all.push(("planes", v.as_ptr().addr())),
        Items::Curve(v) => v.iter().for_each(|c| {
            all.extend([("curve.points", c.points.as_ptr().addr()), ("strip_start", c.strip_start.as_ptr().addr())]);
        }),
        Items::Mesh(v) => v.iter().for_each(|m| {
            all.extend([("mesh.points", m.points.as_ptr().addr()), ("face_start", m.face_start.as_ptr().addr())]);
            all.push(("face_vertices", m.face_vertices.as_ptr().addr()));
            all.push(("mesh.addresses", m.addresses.as_ptr().addr()));
        }),
        Items::Panels(v) => v.iter().for_each(|p| {
            all.extend([("corner_start", p.corner_start.as_ptr().addr()), ("address", p.address.as_ptr().addr())]);
            all.extend([("normal", p.normal.as_ptr().addr()), ("front", p.front.as_ptr().addr())]);
            all.extend([("vertex", p.vertex.as_ptr().addr()), ("chamfer", p.chamfer.as_ptr().addr())]);
            all.extend([("neighbour", p.neighbour.as_ptr().addr()), ("side", p.side.as_ptr().addr())]);
            all.extend([("back_start", p.back_start.as_ptr().addr()), ("back_end", p.back_end.as_ptr().addr())]);
            all.push(("voided", p.voided.as_ptr().addr()));
        }),
        Items::Table(v) => v.iter().flat_map(|t| &t.attributes).for_each(|a| {
            of_items(&a.items, all);
            all.extend(a.valid.as_ref().map(|v| ("attribute.valid", v.as_ptr().addr())));
        }),
        _ => (),
    }
}

/// Who has the arrays of a sample.
pub(crate) trait Hold {
    fn hold<T: Clone>(&self, items: Vec<T>) -> Cow<'static, [T]>;
}

/// They change hands.
pub(crate) struct HandsOver;

/// They stay for ever.
struct Lends;

impl Hold for HandsOver {
    fn hold<T: Clone>(&self, items: Vec<T>) -> Cow<'static, [T]> {
        Cow::Owned(items)
    }
}

impl Hold for Lends {
    fn hold<T: Clone>(&self, items: Vec<T>) -> Cow<'static, [T]> {
        Cow::Borrowed(items.leak())
    }
}

/// A list of every type whose arrays may be large, by the name of its type.
pub(crate) fn samples(by: &impl Hold) -> Vec<(&'static str, Branch<'static>)> {
    let v = |x: f64, y: f64, z: f64| tenon_vec3 { x, y, z };
    let up = v(0.0, 0.0, 1.0);
    let plane = |offset| tenon_plane { normal: up, offset };
    let address = |column| tenon_address { patch: 0, row: 0, column };
    let points = vec![v(0.0, 0.0, 0.0), v(1.0, 0.0, 0.0), v(1.0, 1.0, 0.0), v(0.0, 1.0, 0.0)];
    let weighed = points.iter().map(|p| tenon_vec4 { x: p.x, y: p.y, z: p.z, w: 1.0 }).collect();
    let curve = Curve { points: by.hold(weighed), strip_start: by.hold(vec![0, 2, 4]), closed: false };
    let mesh = Mesh {
        points: by.hold(points.clone()),
        face_start: by.hold(vec![0, 4]),
        face_vertices: by.hold(vec![0, 1, 2, 3]),
        addresses: by.hold(vec![address(7)]),
    };
    let panels = Panels {
        thickness: 10.0,
        corner_start: by.hold(vec![0, 4, 4]),
        address: by.hold(vec![address(0), address(1)]),
        normal: by.hold(vec![up, v(0.0, 0.0, 0.0)]),
        front: by.hold(points.clone()),
        vertex: by.hold(vec![0, 1, 2, 3]),
        chamfer: by.hold(vec![plane(0.5); 4]),
        neighbour: by.hold(vec![
            tenon_edge { panel: 0, edge: 2 },
            tenon_edge::NONE,
            tenon_edge::NONE,
            tenon_edge::NONE,
        ]),
        side: by.hold(vec![TENON_SIDE_BOTTOM, TENON_SIDE_RIGHT, TENON_SIDE_TOP, TENON_SIDE_OTHER]),
        back_start: by.hold(points.clone()),
        back_end: by.hold(points.clone()),
        voided: by.hold(vec![false, true, false, false]),
    };
    let length = Items::Number(by.hold(vec![1.5, f64::NAN, 2.5]));
    let attributes = vec![
        Attribute { name: "length".into(), items: length, valid: Some(by.hold(vec![true, false, true])) },
        Attribute { name: "place".into(), items: Items::Point(by.hold(points[..3].to_vec())), valid: None },
    ];
    [
        ("boolean", Items::Boolean(by.hold(vec![true, false]))),
        ("integer", Items::Integer(by.hold(vec![3, -4]))),
        ("number", Items::Number(by.hold(vec![0.5, -1.0]))),
        ("point", Items::Point(by.hold(points.clone()))),
        ("vector", Items::Vector(by.hold(points))),
        ("plane", Items::Plane(by.hold(vec![plane(1.0), plane(2.0)]))),
        ("curve", Items::Curve(vec![curve.clone(), curve])),
        ("mesh", Items::Mesh(vec![mesh])),
        ("panels", Items::Panels(vec![panels])),
        ("table", Items::Table(vec![Table { rows: 3, attributes }])),
    ]
    .map(|(name, items)| (name, Branch::root(items)))
    .into()
}

/// Lists with gaps, in which stands what no item could be.
fn with_gaps(by: &impl Hold) -> Vec<Branch<'static>> {
    let nothing = f64::NAN;
    let hole = tenon_vec3 { x: nothing, y: nothing, z: nothing };
    let there = tenon_vec3 { x: 0.0, y: 0.0, z: 1.0 };
    let planes = vec![tenon_plane { normal: there, offset: 3.0 }, tenon_plane { normal: hole, offset: nothing }];
    [
        Items::Boolean(by.hold(vec![true, true])),
        Items::Integer(by.hold(vec![3, i64::MIN])),
        Items::Number(by.hold(vec![0.5, nothing])),
        Items::Point(by.hold(vec![there, hole])),
        Items::Vector(by.hold(vec![there, hole])),
        Items::Plane(by.hold(planes)),
    ]
    .map(|items| Branch { valid: Some(by.hold(vec![true, false])), ..Branch::root(items) })
    .into()
}

fn all(by: &impl Hold) -> Vec<Branch<'static>> {
    samples(by).into_iter().map(|(_, branch)| branch).chain(with_gaps(by)).collect()
}

#[test]
fn arrays_that_are_lent_are_read_where_they_lie_until_they_are_let_go() {
    for branch in all(&Lends) {
        let given = [branch];
        let owner: Owner = Arc::new(());
        let lent = lent_tree(given.to_vec(), &owner).unwrap();
        let left = Arc::downgrade(&owner);
        drop(owner);
        assert_eq!(arrays(&branches(&lent)), arrays(&given), "{given:?}");
        // NaN in gaps is not equal to itself.
        assert_eq!(format!("{:?}", branches(&lent)), format!("{given:?}"));
        assert!(left.upgrade().is_some());
        drop(lent);
        assert!(left.upgrade().is_none(), "somebody holds {given:?}");
    }
}

#[test]
fn arrays_that_change_hands_stay_where_they_are() {
    for branch in all(&HandsOver) {
        let (before, told) = (arrays(std::slice::from_ref(&branch)), format!("{:?}", [&branch]));
        let taken = tree(vec![branch]).unwrap();
        assert_eq!((arrays(&branches(&taken)), format!("{:?}", branches(&taken))), (before, told));
    }
}

#[test]
fn borrowed_arrays_are_copied() {
    for branch in all(&Lends) {
        let before = arrays(std::slice::from_ref(&branch));
        let taken = tree(vec![branch]).unwrap();
        let after = arrays(&branches(&taken));
        assert_eq!(before.len(), after.len());
        assert!(before.iter().zip(&after).all(|(a, b)| a != b), "{before:?} {after:?}");
    }
}

#[test]
fn bytes_that_are_no_sides_become_those_of_no_grid() {
    for by_owner in [true, false] {
        let (_, mut branch) = samples(&HandsOver).remove(8);
        let Items::Panels(panels) = &mut branch.items else { panic!("{branch:?}") };
        panels[0].side = if by_owner { Cow::Borrowed(&[0, 9, 2, 255]) } else { Cow::Owned(vec![0, 9, 2, 255]) };
        let owner: Owner = Arc::new(());
        let taken = lent_tree(vec![branch], &owner).unwrap();
        let Items::Panels(panels) = branches(&taken).remove(0).items else { panic!("no panels") };
        assert_eq!(*panels[0].side, [0, TENON_SIDE_OTHER, 2, TENON_SIDE_OTHER]);
    }
}
