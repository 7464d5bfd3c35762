//! `planarize`: vertices move until faces are planar.

use super::mesh_fail;
use crate::value::V;
use tenon_engine::{Call, Fail, NodeType, Port, Unit};
use tenon_geometry::mesh::Mesh;
use tenon_geometry::planar::{PlanaritySummary, PlanarizeError, PlanarizeParams, Planarized, Rim, planarize};

/// Growth of the greatest fold that is told as crumpling, degrees.
const CRUMPLED: f64 = 10.0;

pub(super) fn node() -> NodeType {
    let d = PlanarizeParams::default();
    let mut node = NodeType::new("planarize", 1)
        .name("Planarize")
        .category("Mesh")
        .doc(
            "Moves vertices as little as it can until every face is planar to the threshold. No vertex travels farther than \
             reach edge lengths and no face folds over. (000 §8.3, solved as said in the book)",
        )
        .keywords(&["planar quads", "flatten", "PQ mesh", "guided projection"])
        .slow()
        .input(Port::item::<V<Mesh>>("mesh").doc("The mesh."))
        .input(Port::list::<i64>("region").optional().doc("Faces to make planar; without any: all."))
        .input(Port::item::<f64>("threshold").unit(Unit::Length).range(1e-9, 1e3).default(d.threshold).doc("A face is planar when no corner is farther than this from the plane of the other three."))
        .input(Port::item::<i64>("iterations").unit(Unit::Count).range(0.0, 1e5).default(d.iterations).doc("Greatest number of steps."))
        .input(Port::item::<f64>("closeness").range(0.0, 1e6).default(d.closeness).doc("Weight of staying where the vertices are."))
        .input(Port::item::<f64>("fairness").range(0.0, 1e6).default(d.fairness).doc("Weight of giving way smoothly."))
        .input(Port::item::<bool>("fixed_border").default(false).doc("Whether vertices on the mesh's border stay."))
        .input(Port::item::<bool>("fixed_rim").default(true).doc("Whether vertices that the region shares with other faces stay."))
        .input(Port::list::<i64>("fixed").optional().doc("Further vertices that stay."))
        .input(Port::item::<f64>("reach").range(1e-6, 100.0).default(d.reach).doc("No vertex moves farther than this many times the mean length of its edges."))
        .output(Port::item::<V<Mesh>>("mesh").doc("The planar mesh."))
        .output(Port::item::<bool>("reached").doc("Whether every face of the region is planar to the threshold."))
        .output(Port::list::<f64>("deviation").unit(Unit::Length).doc("Per face: greatest distance of a corner from the plane of the other three."))
        .output(Port::item::<f64>("moved_max").unit(Unit::Length).doc("How far the vertex that moved most has moved."))
        .output(Port::item::<f64>("moved_rms").unit(Unit::Length).doc("Root mean square of all moves."))
        .output(Port::item::<f64>("moved_edges").unit(Unit::Ratio).doc("Greatest move over the length of the vertex' edges."))
        .output(Port::item::<i64>("steps").unit(Unit::Count).doc("Steps taken."));
    for (when, word) in [("before", "given"), ("after", "planarized")] {
        node = node
            .output(
                Port::item::<f64>(format!("fold_{when}"))
                    .unit(Unit::Angle)
                    .doc(format!("Greatest angle between neighbouring faces, {word}.")),
            )
            .output(
                Port::item::<f64>(format!("corner_{when}"))
                    .unit(Unit::Length)
                    .doc(format!("Greatest distance of a corner from the plane of the other three, {word}.")),
            )
            .output(
                Port::item::<f64>(format!("cosine_{when}"))
                    .unit(Unit::Ratio)
                    .doc(format!("Least planarity min(p1, p2) of the thesis, 1 is planar, {word}.")),
            )
            .output(
                Port::item::<f64>(format!("diagonal_{when}"))
                    .unit(Unit::Ratio)
                    .doc(format!("Greatest distance of diagonals over their mean length, {word}.")),
            )
            .output(
                Port::item::<f64>(format!("fit_{when}"))
                    .unit(Unit::Length)
                    .doc(format!("Greatest distance of a corner from the fitted plane, {word}.")),
            );
    }
    node.run(run)
}

fn run(c: &mut Call) -> Result<(), Fail> {
    let rim = |fixed: bool| if fixed { Rim::Fixed } else { Rim::Free };
    let region = indices(c, "region")?;
    let params = PlanarizeParams {
        region: Some(region).filter(|r| !r.is_empty()),
        rim: rim(c.boolean("fixed_rim")?),
        border: rim(c.boolean("fixed_border")?),
        fixed: indices(c, "fixed")?,
        threshold: c.number("threshold")?,
        iterations: c.integer("iterations")? as u32,
        closeness: c.number("closeness")?,
        fairness: c.number("fairness")?,
        reach: c.number("reach")?,
    };
    let monitor = c.monitor();
    let p = planarize(c.item::<V<Mesh>>("mesh")?, &params, &|f| monitor.progress(f)).map_err(|e| planarize_fail(&e))?;
    if !p.reached {
        c.warn(not_reached(&p, &params));
    }
    let (before, after) = (p.fold_before.to_degrees(), p.fold_after.to_degrees());
    if after > before + CRUMPLED {
        let message =
            format!("planarity was won by tilting faces: neighbours fold by up to {after:.1}°, by {before:.1}° before");
        c.warn(Fail::new("crumpled", message).port("reach").hint("allow a larger reach, or planarize a coarser mesh"));
    }
    c.set("fold_before", before);
    c.set("fold_after", after);
    for (when, summary) in [("before", p.before.summary()), ("after", p.after.summary())] {
        set_summary(c, when, &summary);
    }
    c.set("reached", p.reached);
    c.set("moved_max", p.moved_max);
    c.set("moved_rms", p.moved_rms);
    c.set("moved_edges", p.moved_edges);
    c.set("steps", i64::from(p.iterations));
    c.set_list("deviation", p.after.corner);
    c.set("mesh", V::new(p.mesh));
    Ok(())
}

fn set_summary(c: &mut Call, when: &str, s: &PlanaritySummary) {
    c.set(&format!("corner_{when}"), s.corner_max);
    c.set(&format!("cosine_{when}"), s.cosine_min);
    c.set(&format!("diagonal_{when}"), s.diagonal_max);
    c.set(&format!("fit_{when}"), s.fit_max);
}

fn not_reached(p: &Planarized, params: &PlanarizeParams) -> Fail {
    let message = format!(
        "face {} is still {:.6} mm out of plane after {} steps, {} mm are asked for; vertices moved up to {:.3} of {} edge lengths",
        p.worst_face, p.deviation, p.iterations, params.threshold, p.moved_edges, params.reach
    );
    Fail::new("not-planar-yet", message)
        .port("threshold")
        .item(p.worst_face as usize)
        .hint("allow a larger reach or more iterations, or free the border")
}

fn indices(c: &Call, port: &str) -> Result<Vec<u32>, Fail> {
    let index = |i: &i64| {
        u32::try_from(*i).map_err(|_| Fail::new("out-of-range", format!("{i} is no index")).port(port.to_string()))
    };
    c.list::<i64>(port)?.iter().map(index).collect()
}

fn planarize_fail(error: &PlanarizeError) -> Fail {
    match error {
        PlanarizeError::Cancelled => Fail::cancelled(),
        PlanarizeError::Mesh(e) => mesh_fail(e),
        PlanarizeError::NoArea { face } => {
            Fail::new("face-no-area", error.to_string()).port("mesh").item(*face as usize)
        }
        PlanarizeError::NoSuch { .. } => Fail::new("no-such-index", error.to_string()),
        PlanarizeError::BadParameter { name, .. } => Fail::new("out-of-range", error.to_string()).port(*name),
    }
}
