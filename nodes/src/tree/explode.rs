//! Takes a mesh, a curve or panels apart into lists and trees; the first step of every path is the face, strip or panel.

use crate::value::{Point, V, Vector};
use tenon_engine::stop::{Pending, Stoppable};
use tenon_engine::{Column, Item, NodeType, Path, Port, Text, Tree, Unit};
use tenon_geometry::ifs::Curve;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![mesh(), curve(), panels()]
}

fn node(id: &'static str, name: &'static str, doc: &'static str) -> NodeType {
    NodeType::new(id, 1).name(name).category("Trees").doc(doc).keywords(&["deconstruct", "explode", "parts"])
}

/// A branch per element.
fn branches<T: Item>(count: usize, items: impl Fn(usize) -> Vec<Option<T>>) -> Tree {
    let branch = |i: usize| (Path::new(vec![i32::try_from(i).unwrap_or(i32::MAX)]), Column::with_gaps(items(i)));
    let mut all = Pending::new(Vec::with_capacity(count));
    all.extend((0..count).stoppable().map(branch));
    Tree::from_branches(all.take())
}

fn mesh() -> NodeType {
    node("explode_mesh", "Explode mesh", "The points, faces and addresses of a mesh.")
        .input(Port::item::<V<Mesh>>("mesh").doc("The mesh."))
        .output(Port::list::<Point>("points").doc("Its vertices, mm."))
        .output(Port::tree::<i64>("faces").doc("Per face a branch with the places of its corners among the points."))
        .output(Port::tree::<Point>("corners").doc("Per face a branch with its corners, mm."))
        .output(Port::list::<Text>("addresses").doc("One per face once the mesh is in order; empty before."))
        .run(|c| {
            let mesh = c.item::<V<Mesh>>("mesh")?;
            let n = mesh.face_count();
            c.set_list("points", mesh.points.iter().stoppable().map(|p| Point(*p)).collect());
            c.set_tree("faces", branches(n, |f| mesh.face(f).iter().map(|v| Some(i64::from(*v))).collect()));
            let corner = |v: &u32| mesh.points.get(*v as usize).map(|p| Point(*p));
            c.set_tree("corners", branches(n, |f| mesh.face(f).iter().map(corner).collect()));
            c.set_list("addresses", mesh.addresses.iter().stoppable().map(|a| Text::from(a.to_string())).collect());
            Ok(())
        })
}

fn curve() -> NodeType {
    node("explode_curve", "Explode curve", "The points of a curve, strip by strip, and their weights.")
        .input(Port::item::<V<Curve>>("curve").doc("The curve."))
        .output(Port::tree::<Point>("points").doc("Per strip a branch with its points in space, mm."))
        .output(Port::tree::<f64>("weights").doc("Per strip a branch with the points' weights."))
        .output(Port::item::<bool>("closed").doc("Whether its last point is joined to its first."))
        .run(|c| {
            let curve = c.item::<V<Curve>>("curve")?;
            let (points, strips) = (curve.projected(), curve.strips().collect::<Vec<_>>());
            let in_strip = |s: usize| points[strips[s].clone()].iter().map(|p| Some(Point(*p))).collect();
            c.set_tree("points", branches(strips.len(), in_strip));
            let weights = |s: usize| curve.points[strips[s].clone()].iter().map(|p| Some(p.w)).collect();
            c.set_tree("weights", branches(strips.len(), weights));
            c.set("closed", curve.closed);
            Ok(())
        })
}

fn panels() -> NodeType {
    node(
        "explode_panels",
        "Explode panels",
        "What each panel of a set is. A panel that could not be made keeps its place: an empty branch, a gap in the lists.",
    )
    .input(Port::item::<V<PanelSet>>("panels").doc("The panels."))
    .output(Port::list::<Text>("addresses").doc("Address per panel."))
    .output(Port::list::<Vector>("normals").doc("Unit normal of the front per panel, away from the wood."))
    .output(Port::tree::<Point>("corners").doc("Per panel a branch with the corners of its front, mm."))
    .output(Port::tree::<i64>("neighbours").doc("Per panel a branch with the panel across each edge; a gap on the border."))
    .output(Port::item::<f64>("thickness").unit(Unit::Length).doc("Thickness of all of them, mm."))
    .run(|c| {
        let set = c.item::<V<PanelSet>>("panels")?;
        let made = |i: &usize| set.is_valid(*i);
        let each = || (0..set.len()).stoppable().map(|i| Some(i).filter(made));
        c.set_list_gaps("addresses", each().map(|i| i.map(|i| Text::from(set.address[i].to_string()))).collect());
        c.set_list_gaps("normals", each().map(|i| i.map(|i| Vector(set.normal[i]))).collect());
        let corners = |i: usize| set.corners(i).map(|k| Some(Point(set.front[k]))).collect();
        c.set_tree("corners", branches(set.len(), corners));
        let across = |i: usize| set.corners(i).map(|k| set.neighbour[k].get().map(|n| i64::from(n.panel))).collect();
        c.set_tree("neighbours", branches(set.len(), across));
        c.set("thickness", set.thickness);
        Ok(())
    })
}
