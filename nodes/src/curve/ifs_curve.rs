//! `ifs_curve`: a curve by iteration.

use super::{curve_fail, scheme};
use crate::value::{Point, SegmentNames, V};
use tenon_engine::{Call, Fail, NodeType, Port, Unit};
use tenon_geometry::ifs::{Curve, MAX_ITERATIONS, iterate, patches};

pub(super) fn node() -> NodeType {
    let node = NodeType::new("ifs_curve", 1)
        .name("Iterated curve")
        .category("Curve")
        .doc(
            "A curve made by iterating transformations of its control points: Bézier, B-spline, or a rough figure. \
             Moving a control point keeps the transformations; moving a subdivision point rewrites them. (000 §4, §5)",
        )
        .keywords(&["fractal", "bezier", "spline", "takagi", "koch", "levy", "dragon", "cantor", "IFS"])
        .input(
            Port::list::<Point>("points")
                .doc("Control points; several patches follow one another and share their ends."),
        )
        .input(Port::list::<f64>("weights").optional().doc("One weight per control point; without any all are 1."));
    scheme::ports(node, "")
        .input(
            Port::list::<Point>("subdivision_points")
                .optional()
                .doc("Places of subdivision points: of all, or of those named in subdivision_numbers."),
        )
        .input(
            Port::list::<i64>("subdivision_numbers")
                .optional()
                .doc("Which subdivision points are moved, counting from 1: s1 is the first column of T1."),
        )
        .input(
            Port::list::<f64>("germ")
                .optional()
                .doc("Columns of the germ in barycentric coordinates; without it the scheme's own."),
        )
        .input(
            Port::item::<i64>("iterations")
                .unit(Unit::Count)
                .range(0.0, f64::from(MAX_ITERATIONS))
                .default(4)
                .doc("How often the transformations are applied."),
        )
        .input(
            Port::item::<i64>("shared")
                .unit(Unit::Count)
                .range(-1.0, 1000.0)
                .default(-1)
                .doc("Control points that neighbouring patches share; -1: the scheme's own number."),
        )
        .input(Port::item::<bool>("closed").default(false).doc("Whether the control points go round."))
        .input(
            Port::item::<f64>("tolerance")
                .unit(Unit::Length)
                .range(0.0, 1e3)
                .default(1e-6)
                .doc("Distance within which patches meet and points are reached."),
        )
        .output(Port::item::<V<Curve>>("curve").doc("The curve in homogeneous coordinates."))
        .output(Port::list::<Point>("points").doc("Its points in space."))
        .output(
            Port::item::<V<SegmentNames>>("addresses")
                .doc("Names of its segments: the words of transformations that made them."),
        )
        .run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let control = scheme::control(c, "points", "weights")?;
    let tolerance = c.number("tolerance")?;
    let chosen = scheme::chosen(c, "", control.len())?;
    let mut scheme = scheme::moved(
        chosen.scheme,
        &control,
        c.list("subdivision_points")?,
        c.list("subdivision_numbers")?,
        tolerance,
    )?;
    let germ = c.list::<f64>("germ")?;
    if !germ.is_empty() {
        scheme = scheme.with_germ(germ.to_vec()).map_err(|e| scheme::scheme_fail(&e, "germ"))?;
    }
    let shared = usize::try_from(c.integer("shared")?).unwrap_or(chosen.shared);
    let patches =
        patches(&control, scheme.control_count(), shared, c.boolean("closed")?).map_err(|e| curve_fail(&e))?;
    let monitor = c.monitor();
    let curve = iterate(&scheme, &patches, c.integer("iterations")? as u32, tolerance, &|f| monitor.progress(f))
        .map_err(|e| curve_fail(&e))?;
    c.set_list("points", curve.projected().into_iter().map(Point).collect());
    c.set("addresses", V::new(SegmentNames { words: curve.words.clone(), count: curve.segment_count() }));
    c.set("curve", V::new(curve));
    Ok(())
}
