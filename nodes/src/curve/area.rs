//! `area`: what a polygon measures.

use crate::value::{Plane, Point, V};
use tenon_engine::{Fail, NodeType, Port, Unit};
use tenon_geometry::polygon::Polygon;

pub(super) fn node() -> NodeType {
    NodeType::new("area", 1)
        .name("Area")
        .category("Curve")
        .doc(
            "Area, circumference, centroid and plane of a polygon; a closed curve turns into one by itself. Parts of an \
             outline that crosses itself count with the sign of their turn.",
        )
        .keywords(&["polygon", "outline", "centroid", "perimeter", "circumference", "centre"])
        .input(Port::item::<V<Polygon>>("polygon").doc("The outline: a polygon or a closed curve."))
        .input(
            Port::item::<f64>("planar_within")
                .unit(Unit::Length)
                .range(0.0, 1e6)
                .default(0.01)
                .doc("Greatest distance of a corner from the polygon's plane."),
        )
        .output(Port::item::<f64>("area").unit(Unit::Area).doc("What it encloses."))
        .output(Port::item::<f64>("circumference").unit(Unit::Length).doc("Length of its edges."))
        .output(Port::item::<Point>("centroid").doc("Where a plate of this outline balances."))
        .output(Port::item::<Plane>("plane").doc("Its plane; the outline goes round its normal by the right-hand rule."))
        .run(|c| {
            let polygon = c.item::<V<Polygon>>("polygon")?;
            let (flatness, limit) = (polygon.flatness(), c.number("planar_within")?);
            if flatness > limit {
                let message =
                    format!("the polygon is not flat: a corner is {flatness:.3} mm from its plane, allowed are {limit} mm");
                return Err(Fail::new("polygon-not-flat", message)
                    .port("polygon")
                    .hint(format!("a planar_within of {:.3} mm would do", (flatness * 1e3).ceil() / 1e3)));
            }
            let (area, length, centroid) = (polygon.area(), polygon.circumference(), Point(polygon.centroid()));
            let plane = Plane(polygon.plane());
            c.set("area", area);
            c.set("circumference", length);
            c.set("centroid", centroid);
            c.set("plane", plane);
            Ok(())
        })
}
