//! Inputs to try nodes with: what a node would get in a small graph, and what it would get on a bad day.

use crate::abi::value::*;
use crate::load::{PluginNode, PortInfo};
use crate::value::{Attribute, Branch, Curve, Feature, Features, Items, Machining, Mesh, Panels, Table};
use serde_json::Value;
use std::f64::consts::PI;

/// What one evaluation gets.
pub(super) type Inputs = Vec<Vec<Branch<'static>>>;

/// A kind of day.
#[derive(Clone, Copy, Debug, PartialEq)]
pub(super) enum Day {
    /// Defaults, and small clean geometry.
    Good,
    /// Other numbers, other geometry.
    Other,
    /// Every number the smallest that its port accepts.
    Smallest,
    /// Every number the largest.
    Largest,
    /// Numbers that are not.
    NotANumber,
    /// Numbers near the end of what there is.
    Huge,
    /// Zeros and geometry without extent.
    Degenerate,
    /// Lists, meshes and panel sets with nothing in them.
    Empty,
    /// Optional inputs without value.
    Sparse,
    /// The choice of that number, and texts of all sorts.
    Choice(usize),
}

/// The inputs of a node on such a day.
pub(super) fn inputs(node: &PluginNode, day: Day) -> Inputs {
    let mut all = Vec::new();
    if node.fastener {
        let (panels, edges) = pair_of_panels(day);
        all.push(vec![Branch::root(Items::Panels(vec![panels]))]);
        all.push(vec![Branch::root(Items::Edges(edges.into()))]);
        let up = if matches!(day, Day::Other | Day::Choice(1)) { "front" } else { "back" };
        all.push(vec![Branch::root(Items::Text(vec![up.into()]))]);
    }
    all.extend(node.inputs.iter().map(|port| {
        if port.optional && day == Day::Sparse { Vec::new() } else { vec![Branch::root(items(port, day))] }
    }));
    all
}

fn number(port: &PortInfo, day: Day) -> f64 {
    let (min, max) = port.range.unwrap_or((-1e9, 1e9));
    let default = serde_json::from_str::<Value>(&port.default_json).ok().and_then(|v| v.as_f64());
    let default = default.unwrap_or_else(|| 1f64.clamp(min, max));
    match day {
        Day::Other => (default + 0.25 * (max - default).min(10.0)).clamp(min, max),
        Day::Smallest => min,
        Day::Largest => max,
        Day::NotANumber => f64::NAN,
        // A host keeps numbers in their ranges; without one there is no end.
        Day::Huge => port.range.map_or(1e300, |_| max),
        Day::Degenerate => 0f64.clamp(min, max),
        _ => default,
    }
}

fn items(port: &PortInfo, day: Day) -> Items<'static> {
    let count = match (port.access, day) {
        (0, _) => 1,
        (_, Day::Empty) => 0,
        _ => 3,
    };
    let x = number(port, day);
    let v = |x: f64, y: f64, z: f64| tenon_vec3 { x, y, z };
    let far = match day {
        Day::Huge => 1e300,
        Day::NotANumber => f64::NAN,
        Day::Degenerate => 0.0,
        Day::Other => 250.0,
        _ => 100.0,
    };
    match port.kind {
        TENON_BOOLEAN => Items::Boolean(vec![day == Day::Other; count].into()),
        TENON_INTEGER => Items::Integer(
            vec![if x.is_finite() { x.round() } else { port.range.map_or(0.0, |r| r.0) } as i64; count].into(),
        ),
        TENON_NUMBER => Items::Number(vec![x; count].into()),
        TENON_TEXT => Items::Text(vec![text(port, day).into(); count]),
        TENON_POINT => Items::Point(vec![v(far, 0.0, far); count].into()),
        TENON_VECTOR => Items::Vector(vec![v(0.0, 0.0, if day == Day::Degenerate { 0.0 } else { far }); count].into()),
        TENON_PLANE => Items::Plane(vec![tenon_plane { normal: v(0.0, 0.0, 1.0), offset: far }; count].into()),
        TENON_CURVE => Items::Curve(vec![curve(far); count]),
        TENON_MESH => Items::Mesh(vec![if day == Day::Empty { no_mesh() } else { mesh(far) }; count]),
        TENON_PANELS => Items::Panels(vec![pair_of_panels(day).0; count]),
        TENON_TABLE => Items::Table(vec![table(day, far); count]),
        _ => Items::Features(vec![features(day); count]),
    }
}

fn text(port: &PortInfo, day: Day) -> String {
    let default = serde_json::from_str::<Value>(&port.default_json).ok().and_then(|v| v.as_str().map(str::to_owned));
    match day {
        Day::Choice(i) if !port.choices.is_empty() => port.choices[i % port.choices.len()].clone(),
        _ if !port.choices.is_empty() => default.unwrap_or_else(|| port.choices[0].clone()),
        Day::Empty | Day::Choice(0) => String::new(),
        Day::Choice(1) => "Ägäis \u{1f332} \0 \r\n".into(),
        Day::Huge | Day::Choice(_) => "long ".repeat(200_000),
        _ => default.unwrap_or_else(|| "text".into()),
    }
}

fn curve(far: f64) -> Curve<'static> {
    let points = [[0.0, 0.0], [far, 0.0], [far, far]];
    let points: Vec<tenon_vec4> = points.iter().map(|p| tenon_vec4 { x: p[0], y: p[1], z: 0.0, w: 1.0 }).collect();
    Curve { points: points.into(), strip_start: vec![0, 3].into(), closed: false }
}

fn no_mesh() -> Mesh<'static> {
    Mesh { face_start: vec![0].into(), ..Mesh::default() }
}

fn mesh(far: f64) -> Mesh<'static> {
    let grid = (0..9).map(|i| tenon_vec3 { x: f64::from(i % 3) * far, y: f64::from(i / 3) * far, z: 0.0 }).collect();
    let quad = |i: u32| [i, i + 1, i + 4, i + 3];
    let address = |i: u32| tenon_address { patch: 0, row: i / 2, column: i % 2 };
    Mesh {
        points: std::borrow::Cow::Owned(grid),
        face_start: vec![0, 4, 8, 12, 16].into(),
        face_vertices: [0, 1, 3, 4].into_iter().flat_map(quad).collect(),
        addresses: (0..4).map(address).collect(),
    }
}

/// Two panels side by side in the plane Z = 0, and the edges that a fastener is asked for: the shared one, and for
/// other days the border too.
fn pair_of_panels(day: Day) -> (Panels<'static>, Vec<tenon_edge_pair>) {
    let thickness = if day == Day::Other { 18.0 } else { 10.0 };
    let (wide, long) = match day {
        Day::Empty => return (Panels { thickness, corner_start: vec![0].into(), ..Panels::default() }, Vec::new()),
        Day::Degenerate => (0.001, 0.001),
        Day::Huge => (1e9, 1e9),
        Day::Other => (350.0, 500.0),
        _ => (300.0, 400.0),
    };
    let v = |x: f64, y: f64, z: f64| tenon_vec3 { x, y, z };
    let mut p = Panels { thickness, corner_start: vec![0, 4, 8].into(), ..Panels::default() };
    for panel in 0..2u32 {
        let x = f64::from(panel) * wide;
        let corners = [[x, 0.0], [x + wide, 0.0], [x + wide, long], [x, long]];
        let normals = [v(0.0, -1.0, 0.0), v(1.0, 0.0, 0.0), v(0.0, 1.0, 0.0), v(-1.0, 0.0, 0.0)];
        p.address.to_mut().push(tenon_address { patch: 0, row: 0, column: panel });
        p.normal.to_mut().push(v(0.0, 0.0, 1.0));
        for k in 0..4 {
            let (a, b) = (corners[k], corners[(k + 1) % 4]);
            p.front.to_mut().push(v(a[0], a[1], 0.0));
            p.back_start.to_mut().push(v(a[0], a[1], -thickness));
            p.back_end.to_mut().push(v(b[0], b[1], -thickness));
            p.vertex.to_mut().push([[0, 1, 4, 3], [1, 2, 5, 4]][panel as usize][k]);
            let offset = normals[k].x * a[0] + normals[k].y * a[1];
            p.chamfer.to_mut().push(tenon_plane { normal: normals[k], offset });
            p.side.to_mut().push(k as u8);
            p.voided.to_mut().push(false);
            p.neighbour.to_mut().push(match (panel, k) {
                (0, 1) => tenon_edge { panel: 1, edge: 3 },
                (1, 3) => tenon_edge { panel: 0, edge: 1 },
                _ => tenon_edge::NONE,
            });
        }
    }
    let shared = tenon_edge_pair {
        first: tenon_edge { panel: 0, edge: 1 },
        second: tenon_edge { panel: 1, edge: 3 },
        start: v(wide, 0.0, 0.0),
        end: v(wide, long, 0.0),
        angle: PI,
    };
    let border = tenon_edge_pair {
        first: tenon_edge { panel: 0, edge: 0 },
        second: tenon_edge::NONE,
        start: v(0.0, 0.0, 0.0),
        end: v(wide, 0.0, 0.0),
        angle: 0.0,
    };
    (p, if day == Day::Good { vec![shared] } else { vec![border, shared] })
}

fn table(day: Day, far: f64) -> Table<'static> {
    let rows = if day == Day::Empty { 0 } else { 3 };
    let numbers = vec![far; rows];
    let names = (0..rows).map(|i| format!("row {i}").into()).collect();
    let attribute = |name: &'static str, items| Attribute { name: name.into(), items, valid: None };
    let gaps =
        Attribute { valid: Some(vec![false; rows].into()), ..attribute("gaps", Items::Integer(vec![0; rows].into())) };
    let attributes =
        vec![attribute("length", Items::Number(numbers.into())), attribute("name", Items::Text(names)), gaps];
    Table { rows, attributes }
}

fn features(day: Day) -> Features<'static> {
    if day == Day::Empty {
        return Features::default();
    }
    let machining = Machining::Drill {
        entry: tenon_vec3 { x: 50.0, y: 50.0, z: 0.0 },
        axis: tenon_vec3 { x: 0.0, y: 0.0, z: -1.0 },
        depth: 5.0,
        diameter: 3.0,
    };
    let drill = Feature { panel: 0, edge: Some(1), joint: Some(0), by_hand: false, purpose: "screw".into(), machining };
    Features { features: vec![drill], hardware: vec![("Screw 3 x 10".into(), 1)] }
}
