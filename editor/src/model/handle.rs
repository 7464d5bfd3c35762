//! Points that can be taken by hand in the viewport: point nodes, and points that stand as literals at an input.

use super::catalog::{Catalog, PortInfo};
use super::param::number;
use tenon_engine::{Document, Json, Literal, Node, Operation};
use tenon_geometry::DVec3;
use tenon_geometry::ifs::{Move, Preset, Scheme, Tie, homogeneous};

/// Where a point stands in the document.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum Place {
    /// In the parameters x, y and z of a node.
    Coordinates,
    /// In a list of points, or alone.
    Literal {
        /// The input.
        port: String,
        /// Its number in the list; none for a point alone.
        index: Option<usize>,
    },
    /// A subdivision point of an iterated curve, by its number from 0.
    Subdivision(usize),
}

/// A point that can be moved.
#[derive(Clone, Debug, PartialEq)]
pub struct Handle {
    /// The node that it belongs to.
    pub node: String,
    /// Where it stands there.
    pub place: Place,
    /// Where it is, mm.
    pub at: DVec3,
    /// Which of x, y, z can be set; the others come by wire or from a formula.
    pub free: [bool; 3],
}

impl Handle {
    /// What it is called.
    #[must_use]
    pub fn label(&self) -> String {
        match &self.place {
            Place::Coordinates => self.node.clone(),
            Place::Literal { port, index: None } => format!("{}.{port}", self.node),
            Place::Literal { port, index: Some(i) } => format!("{}.{port} {}", self.node, i + 1),
            Place::Subdivision(i) => format!("{} s{}", self.node, i + 1),
        }
    }

    /// Whether this is the same point of the document, wherever it is now.
    #[must_use]
    pub fn same(&self, other: &Self) -> bool {
        self.node == other.node && self.place == other.place
    }

    /// The operation that moves it; coordinates that are not free stay. Places are rounded to a hundredth of a millimetre,
    /// as a hand cannot mean more. `None` if the document has no such point any more.
    #[must_use]
    pub fn move_to(&self, to: DVec3, document: &Document) -> Option<Operation> {
        let node = document.nodes().get(&self.node)?;
        let to = (to * 100.0).round() / 100.0;
        let set = |port: &str, value: Json| Operation::SetParam {
            node: self.node.clone(),
            port: port.into(),
            value: Some(value),
        };
        match &self.place {
            Place::Coordinates => {
                let axes = ["x", "y", "z"].into_iter().zip(to.to_array()).zip(self.at.to_array()).zip(self.free);
                let changed = axes.filter(|(((_, new), old), free)| *free && new != old);
                Some(Operation::All(changed.map(|(((axis, new), _), _)| set(axis, number(new))).collect()))
            }
            Place::Literal { port, index } => {
                let mut value = node.params.get(port)?.to_json();
                let point = match index {
                    Some(i) => value.get_mut(*i)?,
                    None => &mut value,
                };
                *point = to.to_array().into_iter().map(number).collect();
                Some(set(port, value))
            }
            Place::Subdivision(i) => {
                let list = |port: &str| {
                    let value = node.params.get(port).map(Literal::to_json);
                    value.as_ref().and_then(Json::as_array).cloned().unwrap_or_default()
                };
                let (mut places, mut numbers) = (list("subdivision_points"), list("subdivision_numbers"));
                let to: Json = to.to_array().into_iter().map(number).collect();
                let there = match numbers.is_empty() {
                    // All of them are given, or none.
                    true => Some(*i).filter(|i| *i < places.len()),
                    false => numbers.iter().position(|n| n.as_u64() == Some(*i as u64 + 1)),
                };
                match there.and_then(|at| places.get_mut(at)) {
                    Some(place) => *place = to,
                    None => {
                        places.push(to);
                        numbers.push((*i + 1).into());
                    }
                }
                let numbers = (!numbers.is_empty()).then(|| set("subdivision_numbers", numbers.into_iter().collect()));
                let places = set("subdivision_points", places.into_iter().collect());
                Some(Operation::All(std::iter::once(places).chain(numbers).collect()))
            }
        }
    }
}

/// The weight of a control point of a curve; none for points that have none, or whose weights come by wire.
#[must_use]
pub fn weight(handle: &Handle, document: &Document, catalog: &Catalog) -> Option<f64> {
    let Place::Literal { port, index: Some(i) } = &handle.place else { return None };
    let node = document.nodes().get(&handle.node).filter(|_| port == "points")?;
    let wired = node.inputs.get("weights").is_some_and(|w| !w.from.is_empty());
    let has = catalog.get(&node.type_name)?.inputs.iter().any(|p| p.name == "weights");
    let set = node.params.get("weights").map(Literal::to_json);
    let own = set.as_ref().and_then(|w| w.get(*i)).and_then(Json::as_f64);
    (has && !wired).then(|| own.unwrap_or(1.0))
}

/// The operation that gives a control point a weight; the others keep theirs.
#[must_use]
pub fn set_weight(handle: &Handle, weight: f64, document: &Document) -> Option<Operation> {
    let Place::Literal { port, index: Some(i) } = &handle.place else { return None };
    let node = document.nodes().get(&handle.node)?;
    let count = node.params.get(port)?.to_json().as_array()?.len();
    let set = node.params.get("weights").map(Literal::to_json);
    let own = |k: usize| set.as_ref().and_then(|w| w.get(k)).and_then(Json::as_f64).unwrap_or(1.0);
    let weight = ((weight * 1000.0).round() / 1000.0).clamp(1e-3, 1e3);
    let all: Vec<f64> = (0..count).map(|k| if k == *i { weight } else { own(k) }).collect();
    let plain = all.iter().all(|w| *w == 1.0);
    let value = (!plain).then(|| all.into_iter().map(number).collect());
    Some(Operation::SetParam { node: handle.node.clone(), port: "weights".into(), value })
}

/// The subdivision points of an iterated curve whose scheme and control points stand in the document, as far as a hand can
/// move them: those that are control points are left out.
fn subdivision(id: &str, node: &Node) -> Option<Vec<Handle>> {
    let json = |port: &str| node.params.get(port).map(Literal::to_json);
    let wired = |port: &str| node.inputs.get(port).is_some_and(|w| !w.from.is_empty());
    let others = ["points", "weights", "preset", "degree", "columns", "controls"];
    if others.into_iter().chain(["subdivision_points", "subdivision_numbers"]).any(wired) {
        return None;
    }
    let points: Vec<DVec3> = json("points")?.as_array()?.iter().map(xyz).collect::<Option<_>>()?;
    let weights = json("weights");
    let weight = |i: usize| weights.as_ref().and_then(|w| w.get(i)).and_then(Json::as_f64).unwrap_or(1.0);
    let control: Vec<_> = points.iter().enumerate().map(|(i, p)| homogeneous(*p, weight(i))).collect();
    let degree = json("degree").and_then(|d| d.as_u64()).filter(|d| *d > 0);
    let degree = degree.unwrap_or(points.len().saturating_sub(1).max(1) as u64).min(1000) as u32;
    let preset = json("preset");
    let scheme = match preset.as_ref().map_or(Some("bezier"), Json::as_str)? {
        "custom" => {
            let columns: Vec<f64> = json("columns")?.as_array()?.iter().map(Json::as_f64).collect::<Option<_>>()?;
            let controls = json("controls").and_then(|c| c.as_u64()).filter(|c| *c > 0);
            Scheme::custom(controls.unwrap_or(points.len() as u64) as usize, columns).ok()?
        }
        name => Scheme::preset(Preset::from_name(name, degree)?).ok()?,
    };
    if scheme.control_count() != control.len() {
        return None;
    }
    // What was moved stands in the document; the others follow the scheme.
    let (places, numbers) = (json("subdivision_points"), json("subdivision_numbers"));
    let moved = |i: usize| -> Option<DVec3> {
        let at = match &numbers {
            Some(n) => n.as_array()?.iter().position(|n| n.as_u64() == Some(i as u64 + 1))?,
            None => i,
        };
        xyz(places.as_ref()?.get(at)?)
    };
    let moves: Vec<Move> =
        (0..scheme.ties().len()).filter_map(|i| Some(Move { point: i, position: moved(i)?, weight: None })).collect();
    let scheme = scheme.moved(&control, &moves, 1e-6).unwrap_or(scheme);
    let all = scheme.subdivision_points(&control).ok()?;
    let free = |i: usize| matches!(scheme.ties().get(i), Some(Tie::Class { .. }));
    let places = all.into_iter().enumerate().filter(|(i, _)| free(*i)).map(|(i, p)| (i, p.truncate() / p.w));
    let mut found: Vec<Handle> = Vec::new();
    for (i, at) in places.filter(|(_, p)| p.is_finite()) {
        // Points that lie on one another are one to the hand.
        if found.iter().all(|h| h.at.distance(at) > 1e-6) {
            found.push(Handle { node: id.to_owned(), place: Place::Subdivision(i), at, free: [true; 3] });
        }
    }
    Some(found)
}

fn xyz(json: &Json) -> Option<DVec3> {
    let list = json.as_array().filter(|l| (2..=3).contains(&l.len()))?;
    let mut p = [0.0; 3];
    for (slot, value) in p.iter_mut().zip(list) {
        *slot = value.as_f64()?;
    }
    Some(DVec3::from_array(p))
}

/// All points of a document that can be moved, in order of node ids. O(nodes + points).
#[must_use]
pub fn handles(document: &Document, catalog: &Catalog) -> Vec<Handle> {
    let mut found = Vec::new();
    for (id, node) in document.nodes() {
        let Some(info) = catalog.get(&node.type_name) else { continue };
        if node.type_name == "point" {
            let coordinate = |axis: &str| {
                let set = node.params.get(axis).map_or(Some(0.0), Literal::as_f64);
                let free = node.inputs.get(axis).is_none_or(|w| w.from.is_empty()) && set.is_some();
                (set.unwrap_or(0.0), free)
            };
            let axes = ["x", "y", "z"].map(coordinate);
            // A coordinate that comes by wire is not known here, so the point could not be shown where it is.
            if axes.iter().all(|a| a.1) {
                let at = DVec3::from_array(axes.map(|a| a.0));
                found.push(Handle { node: id.clone(), place: Place::Coordinates, at, free: axes.map(|a| a.1) });
            }
        }
        if node.type_name == "ifs_curve" {
            found.extend(subdivision(id, node).into_iter().flatten());
        }
        let direct = |p: &&PortInfo| p.type_name == "point" && p.name != "subdivision_points";
        for port in info.inputs.iter().filter(direct) {
            let wired = node.inputs.get(&port.name).is_some_and(|w| !w.from.is_empty());
            let Some(value) = node.params.get(&port.name).filter(|_| !wired).map(Literal::json) else { continue };
            let mut add = |index, at| {
                let place = Place::Literal { port: port.name.clone(), index };
                found.push(Handle { node: id.clone(), place, at, free: [true; 3] });
            };
            if let Some(at) = xyz(&value) {
                add(None, at);
            } else {
                let list = value.as_array().into_iter().flatten().enumerate();
                list.filter_map(|(i, p)| xyz(p).map(|p| (i, p))).for_each(|(i, p)| add(Some(i), p));
            }
        }
    }
    found
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn subdivision_points_are_moved_by_number_and_weights_kept_in_order() {
        let catalog = Catalog::new(&tenon_nodes::registry());
        let mut d = document();
        let middle = handles(&d, &catalog).remove(0);
        middle.move_to(DVec3::new(0.25, 0.5, 0.75), &d).unwrap().apply(&mut d).unwrap();
        let set = |d: &Document, port: &str| d.nodes()["c"].params.get(port).map(Literal::to_json);
        assert_eq!(set(&d, "subdivision_points"), Some(json!([[0.25, 0.5, 0.75]])));
        assert_eq!(set(&d, "subdivision_numbers"), Some(json!([2])));
        let again = handles(&d, &catalog).remove(0);
        assert!(again.same(&middle) && again.at.distance(DVec3::new(0.25, 0.5, 0.75)) < 1e-9, "{}", again.at);
        again.move_to(DVec3::new(2.0, 1.0, 0.0), &d).unwrap().apply(&mut d).unwrap();
        assert_eq!(set(&d, "subdivision_points"), Some(json!([[2, 1, 0]])));

        let point = handles(&d, &catalog).into_iter().find(|h| h.label() == "c.points 2").unwrap();
        assert_eq!(weight(&point, &d, &catalog), Some(1.0));
        set_weight(&point, 2.5, &d).unwrap().apply(&mut d).unwrap();
        assert_eq!(set(&d, "weights"), Some(json!([1, 2.5])));
        set_weight(&point, 1.0, &d).unwrap().apply(&mut d).unwrap();
        assert_eq!(set(&d, "weights"), None, "weights of 1 need not stand in the file");
    }

    fn document() -> Document {
        let mut d = Document::new();
        d.insert("c", Node::new("ifs_curve").param("points", json!([[0, 0], [1, 2, 3]]))).unwrap();
        d.insert("p", Node::new("point").param("x", 5)).unwrap();
        d.insert("q", Node::new("point").wire("x", "n.value")).unwrap();
        d
    }

    #[test]
    fn points_are_found_and_moved_where_they_stand() {
        let catalog = Catalog::new(&tenon_nodes::registry());
        let mut d = document();
        let all = handles(&d, &catalog);
        let labels: Vec<String> = all.iter().map(Handle::label).collect();
        assert_eq!(labels, ["c s2", "c.points 1", "c.points 2", "p"]);
        assert_eq!(all[0].at, DVec3::new(0.5, 1.0, 1.5), "the middle of a line");
        all[1].move_to(DVec3::new(1.234, 5.0, -7.0), &d).unwrap().apply(&mut d).unwrap();
        all[3].move_to(DVec3::new(6.0, 0.5, 0.0), &d).unwrap().apply(&mut d).unwrap();
        let set = |id: &str, port: &str| d.nodes()[id].params.get(port).map(Literal::to_json);
        assert_eq!(set("c", "points"), Some(json!([[1.23, 5, -7], [1, 2, 3]])));
        assert_eq!(["x", "y", "z"].map(|axis| set("p", axis)), [Some(json!(6)), Some(json!(0.5)), None]);
    }
}
