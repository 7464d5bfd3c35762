//! From ports to a scheme and its control polygons, shared by curves and tensor products.

use super::curve_fail;
use crate::value::Point;
use tenon_engine::{Fail, NodeType, Port, Text, Unit};
use tenon_geometry::DVec4;
use tenon_geometry::ifs::{MAX_DEGREE, Move, Preset, Scheme, SchemeError, homogeneous};

/// Names of the presets as ports offer them, `custom` last.
pub(super) fn choices() -> Vec<&'static str> {
    Preset::NAMES.into_iter().chain(["custom"]).collect()
}

/// Adds the ports that choose a scheme; `suffix` tells directions apart.
pub(super) fn ports(node: NodeType, suffix: &str) -> NodeType {
    node.input(
        Port::item::<Text>(format!("preset{suffix}"))
            .choices(&choices())
            .default("bezier")
            .doc("The scheme: a named one, or custom columns."),
    )
    .input(
        Port::item::<i64>(format!("degree{suffix}"))
            .range(0.0, f64::from(MAX_DEGREE))
            .default(0)
            .doc("Degree of a Bézier patch; 0: one less than the number of points, a single patch."),
    )
    .input(
        Port::list::<f64>(format!("columns{suffix}"))
            .optional()
            .doc("Columns of a custom scheme, T1 first, column after column, each with one entry per control point."),
    )
    .input(
        Port::item::<i64>(format!("controls{suffix}"))
            .unit(Unit::Count)
            .range(0.0, 1000.0)
            .default(0)
            .doc("Control points of one patch of a custom scheme; 0: as many as there are points."),
    )
}

/// A scheme, the points that neighbouring patches share, and the ports that asked for it.
pub(super) struct Chosen {
    pub scheme: Scheme,
    pub shared: usize,
}

/// The scheme that the ports `preset`, `degree`, `columns`, `controls` ask for with `count` control points in all.
pub(super) fn chosen(c: &tenon_engine::Call, suffix: &str, count: usize) -> Result<Chosen, Fail> {
    let port = |name: &str| format!("{name}{suffix}");
    let name = c.text(&port("preset"))?;
    if name == "custom" {
        let controls = match c.integer(&port("controls"))? {
            0 => count,
            m => m as usize,
        };
        let columns = c.list::<f64>(&port("columns"))?.to_vec();
        let scheme = Scheme::custom(controls, columns).map_err(|e| scheme_fail(&e, &port("columns")))?;
        return Ok(Chosen { scheme, shared: 1 });
    }
    let degree = match c.integer(&port("degree"))? {
        0 => count.saturating_sub(1).clamp(1, u32::MAX as usize) as u32,
        d => d as u32,
    };
    let preset = Preset::from_name(name, degree)
        .ok_or_else(|| Fail::new("not-a-choice", format!("there is no scheme \"{name}\"")).port(port("preset")))?;
    let scheme = Scheme::preset(preset).map_err(|e| scheme_fail(&e, &port("degree")))?;
    Ok(Chosen { scheme, shared: preset.shared_count() })
}

/// Points with their weights; all weights are 1 when none are given.
pub(super) fn control(c: &tenon_engine::Call, points: &str, weights: &str) -> Result<Vec<DVec4>, Fail> {
    let (p, w) = (c.list::<Point>(points)?, c.list::<f64>(weights)?);
    if !w.is_empty() && w.len() != p.len() {
        return Err(Fail::new(
            "weight-count",
            format!("{} weights for {} points; give one each, or none", w.len(), p.len()),
        )
        .port(weights.to_string()));
    }
    Ok(p.iter().enumerate().map(|(i, p)| homogeneous(p.0, w.get(i).copied().unwrap_or(1.0))).collect())
}

/// `scheme` with the subdivision points that were moved on the first patch.
pub(super) fn moved(
    scheme: Scheme,
    control: &[DVec4],
    places: &[Point],
    numbers: &[i64],
    tolerance: f64,
) -> Result<Scheme, Fail> {
    let all = scheme.transformation_count() * scheme.control_count();
    let fail = |text: String| Fail::new("subdivision-points", text).port("subdivision_points");
    let moves: Vec<Move> = if numbers.is_empty() {
        if places.is_empty() {
            return Ok(scheme);
        }
        if places.len() != all {
            return Err(fail(format!("{} subdivision points were given; this scheme has {all}", places.len()))
                .hint("name the points that you move in subdivision_numbers"));
        }
        places.iter().enumerate().map(|(i, p)| Move { point: i, position: p.0, weight: None }).collect()
    } else {
        if places.len() != numbers.len() {
            return Err(fail(format!("{} places for {} numbers of subdivision points", places.len(), numbers.len())));
        }
        let mut moves = Vec::with_capacity(places.len());
        for (place, number) in places.iter().zip(numbers) {
            let point = usize::try_from(*number).ok().filter(|n| (1..=all).contains(n));
            let point = point.ok_or_else(|| {
                fail(format!("there is no subdivision point s{number}; they are s1 to s{all}"))
                    .port("subdivision_numbers")
            })?;
            moves.push(Move { point: point - 1, position: place.0, weight: None });
        }
        moves
    };
    let m = scheme.control_count();
    let first = control.get(..m).ok_or_else(|| {
        curve_fail(&tenon_geometry::ifs::CurveError::ControlCount { patch: 0, given: control.len(), needed: m })
    })?;
    scheme.moved(first, &moves, tolerance).map_err(|e| scheme_fail(&e, "subdivision_points"))
}

pub(super) fn scheme_fail(error: &SchemeError, port: &str) -> Fail {
    let code = match error {
        SchemeError::Unreachable { .. } => "subdivision-point-unreachable",
        _ => "scheme-wrong",
    };
    Fail::new(code, error.to_string()).port(port.to_string())
}
