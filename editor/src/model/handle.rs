//! Points that can be taken by hand in the viewport: point nodes, and points that stand as literals at an input.

use super::catalog::Catalog;
use super::param::number;
use tenon_engine::{Document, Json, Literal, Operation};
use tenon_geometry::DVec3;

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
        }
    }
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
        for port in info.inputs.iter().filter(|p| p.type_name == "point") {
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
    use tenon_engine::Node;

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
        assert_eq!(labels, ["c.points 1", "c.points 2", "p"]);
        all[0].move_to(DVec3::new(1.234, 5.0, -7.0), &d).unwrap().apply(&mut d).unwrap();
        all[2].move_to(DVec3::new(6.0, 0.5, 0.0), &d).unwrap().apply(&mut d).unwrap();
        let set = |id: &str, port: &str| d.nodes()[id].params.get(port).map(Literal::to_json);
        assert_eq!(set("c", "points"), Some(json!([[1.23, 5, -7], [1, 2, 3]])));
        assert_eq!(["x", "y", "z"].map(|axis| set("p", axis)), [Some(json!(6)), Some(json!(0.5)), None]);
    }
}
