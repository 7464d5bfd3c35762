//! Point, vector, plane.

use crate::value::{Plane, Point, Vector};
use tenon_engine::{Fail, NodeType, Port, Unit};
use tenon_geometry::DVec3;

pub(super) fn nodes() -> Vec<NodeType> {
    vec![point(), vector(), plane()]
}

fn coordinates(node: NodeType) -> NodeType {
    node.input(Port::item::<f64>("x").unit(Unit::Length).default(0.0).doc("X, mm."))
        .input(Port::item::<f64>("y").unit(Unit::Length).default(0.0).doc("Y, mm."))
        .input(Port::item::<f64>("z").unit(Unit::Length).default(0.0).doc("Z, mm."))
}

fn xyz(c: &tenon_engine::Call) -> Result<DVec3, Fail> {
    Ok(DVec3::new(c.number("x")?, c.number("y")?, c.number("z")?))
}

fn point() -> NodeType {
    coordinates(NodeType::new("point", 1).name("Point").category("Parameters"))
        .doc("A point from its three coordinates.")
        .keywords(&["xyz", "construct point"])
        .output(Port::item::<Point>("point").doc("The point."))
        .run(|c| {
            let p = xyz(c)?;
            c.set("point", Point(p));
            Ok(())
        })
}

fn vector() -> NodeType {
    coordinates(NodeType::new("vector", 1).name("Vector").category("Parameters"))
        .doc("A vector from its three components.")
        .keywords(&["xyz", "direction"])
        .output(Port::item::<Vector>("vector").doc("The vector."))
        .run(|c| {
            let v = xyz(c)?;
            c.set("vector", Vector(v));
            Ok(())
        })
}

fn plane() -> NodeType {
    NodeType::new("plane", 1)
        .name("Plane")
        .category("Parameters")
        .doc("A plane through a point, square to a vector.")
        .keywords(&["limit plane", "ground"])
        .input(Port::item::<Point>("origin").default([0.0, 0.0, 0.0]).doc("A point of the plane, mm."))
        .input(Port::item::<Vector>("normal").default([0.0, 0.0, 1.0]).doc("Square to the plane; any length but 0."))
        .output(Port::item::<Plane>("plane").doc("The plane."))
        .run(|c| {
            let normal = c.item::<Vector>("normal")?.0.try_normalize();
            let normal = normal.ok_or_else(|| {
                Fail::new("zero-vector", "the normal of a plane must not be the zero vector").port("normal")
            })?;
            let plane = Plane(tenon_geometry::Plane::through(c.item::<Point>("origin")?.0, normal));
            c.set("plane", plane);
            Ok(())
        })
}
