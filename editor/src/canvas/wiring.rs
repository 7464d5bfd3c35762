//! Wires by hand: drawn from a port, taken off, led to another port, let go over a node.

use super::Canvas;
use super::gesture::Gesture;
use super::hit::Hit;
use super::shape::{Row, Shape, Shapes};
use crate::model::Model;
use eframe::egui::{Pos2, Rect};
use tenon_engine::Operation;

/// The end of a wire that is being drawn.
#[derive(Clone, Debug, PartialEq)]
pub struct End {
    /// The node that it starts at.
    pub node: String,
    /// Its port there.
    pub port: String,
    /// Whether that is an output.
    pub output: bool,
    /// The type of that port.
    pub type_name: String,
}

impl End {
    /// Whether a wire from here can go to a port.
    pub fn fits(&self, shapes: &Shapes, model: &Model, shape: &Shape, output: bool, port: usize) -> bool {
        if output == self.output || shape.id == self.node || shapes.find(&self.node).is_none() {
            return false;
        }
        let there = if output { shape.outputs.get(port) } else { shape.inputs.get(port) };
        there.is_some_and(|p| match self.output {
            true => model.catalog.fits(&self.type_name, &p.type_name),
            false => model.catalog.fits(&p.type_name, &self.type_name),
        })
    }
}

impl Canvas {
    pub(super) fn end(&self, n: usize, port: usize, output: bool) -> End {
        let shape = &self.shapes.nodes[n];
        let info = if output { &shape.outputs[port] } else { &shape.inputs[port] };
        End { node: shape.id.clone(), port: info.name.clone(), output, type_name: info.type_name.clone() }
    }

    pub(super) fn wire_from(&self, n: usize, port: usize, output: bool) -> Gesture {
        Gesture::Wire(self.end(n, port, output))
    }

    /// Takes the last wire off an input, to be put elsewhere.
    pub(super) fn take_off(&self, n: usize, port: usize, model: &mut Model) -> Gesture {
        let wire = self.shapes.wires.iter().rev().find(|w| w.to == n && w.port == port);
        let Some((wire, (source, output))) = wire.and_then(|w| Some((w, w.source?))) else { return Gesture::Idle };
        let (node, port) = (self.shapes.nodes[n].id.clone(), self.shapes.nodes[n].inputs[port].name.clone());
        let gesture = Gesture::Taken(self.end(source, output, true));
        model.begin();
        model.edit(Operation::Disconnect { node, port, from: wire.from.clone() });
        gesture
    }

    /// A wire was let go over a node: it goes to the port there, or to the only one that fits.
    pub(super) fn drop_wire(&self, end: &End, hit: Hit, at: Pos2, area: Rect, model: &mut Model) {
        let Some(shape) = hit.node().map(|n| &self.shapes.nodes[n]) else { return };
        // Nobody pointed at this port, so it is told which one it was.
        let mut told = None;
        let mut named = |port: Option<usize>| {
            told = port;
            port
        };
        let there = match hit {
            Hit::Output(_, o) if !end.output => Some(o),
            Hit::Input(_, i) | Hit::Value(_, i, _) if end.output => Some(i),
            _ => {
                // Anywhere on a row counts as its port.
                let p = self.view.to_canvas(area, at);
                let row =
                    shape.rows.iter().enumerate().find(|(r, _)| shape.row_rect(*r).contains(p)).map(|(_, row)| row);
                match row {
                    Some(Row::Input(i, _)) if end.output => Some(*i),
                    Some(Row::Output(o)) if !end.output => Some(*o),
                    _ => named(self.best(end, shape, model)),
                }
            }
        };
        let Some(port) = there else { return };
        if !end.fits(&self.shapes, model, shape, !end.output, port) {
            let there = if end.output { &shape.inputs[port] } else { &shape.outputs[port] };
            let (gives, takes) =
                if end.output { (&end.type_name, &there.type_name) } else { (&there.type_name, &end.type_name) };
            let message = format!("a wire cannot go there: it brings {gives}, the input takes {takes}");
            model.message = Some(tenon_engine::Diagnostic::error("wrong-type", message));
            return;
        }
        let operation = match end.output {
            true => model.new_wire(&format!("{}.{}", end.node, end.port), &shape.id, &shape.inputs[port].name),
            false => model.new_wire(&format!("{}.{}", shape.id, shape.outputs[port].name), &end.node, &end.port),
        };
        let address = told.and_then(|p| Some(if end.output { shape.inputs.get(p)? } else { shape.outputs.get(p)? }));
        let address = address.map(|p| format!("{}.{}", shape.id, p.name));
        if model.edit(operation) {
            model.said = address.map(|address| format!("the wire goes to {address}, which suits it best"));
        }
    }

    /// The port of a node that a wire does best with, if it can go to one.
    fn best(&self, end: &End, shape: &Shape, model: &Model) -> Option<usize> {
        if shape.id == end.node {
            return None;
        }
        let ports = if end.output { &shape.inputs } else { &shape.outputs };
        let node = model.document().nodes().get(&shape.id)?;
        let waits = |p: usize| {
            let wires = ports.get(p).and_then(|p| node.inputs.get(&p.name));
            !end.output || wires.is_none_or(|w| w.from.is_empty())
        };
        model.catalog.best(&end.type_name, end.output, ports, waits)
    }

    /// The operation that leads all wires of one port to another port of the same side; none if they cannot go there.
    pub(super) fn rewire(&self, end: &End, hit: Hit, model: &Model) -> Option<Operation> {
        let shape = self.shapes.nodes.get(hit.node()?)?;
        let there = match hit {
            Hit::Output(_, o) if end.output => shape.outputs.get(o)?,
            Hit::Input(_, i) | Hit::Value(_, i, _) if !end.output => shape.inputs.get(i)?,
            _ => return None,
        };
        if shape.id == end.node && there.name == end.port {
            return None;
        }
        let nodes = model.document().nodes();
        if !end.output {
            let wires = nodes.get(&end.node)?.inputs.get(&end.port)?.clone();
            let gone = Operation::PutWires { node: end.node.clone(), port: end.port.clone(), wires: None };
            let sources: Vec<String> = wires.from.iter().map(ToString::to_string).collect();
            let single = there.access == tenon_engine::Access::Item;
            let mut all = vec![gone];
            if single || nodes.get(&shape.id)?.inputs.get(&there.name).is_none() {
                let (node, port) = (shape.id.clone(), there.name.clone());
                all.push(Operation::PutWires { node, port, wires: Some(wires) });
            } else {
                let known = nodes.get(&shape.id)?.inputs.get(&there.name)?;
                let new = sources.into_iter().filter(|s| !known.from.iter().any(|f| f.as_str() == s));
                all.extend(new.map(|from| Operation::Connect {
                    node: shape.id.clone(),
                    port: there.name.clone(),
                    from,
                    at: None,
                }));
            }
            return Some(Operation::All(all));
        }
        let (from, to) = (format!("{}.{}", end.node, end.port), format!("{}.{}", shape.id, there.name));
        let mut all = Vec::new();
        for (id, node) in nodes {
            for (port, wires) in &node.inputs {
                let Some(at) = wires.from.iter().position(|f| f.as_str() == from) else { continue };
                let (node, port) = (id.clone(), port.to_string());
                all.push(Operation::Disconnect { node: node.clone(), port: port.clone(), from: from.clone() });
                if !wires.from.iter().any(|f| f.as_str() == to) {
                    all.push(Operation::Connect { node, port, from: to.clone(), at: Some(at) });
                }
            }
        }
        (!all.is_empty()).then_some(Operation::All(all))
    }

    /// Puts a reroute point into a wire.
    pub(super) fn reroute(&self, wire: usize, at: [f64; 2], model: &mut Model) {
        let Some(wire) = self.shapes.wires.get(wire) else { return };
        let to = &self.shapes.nodes[wire.to];
        let operation = model.reroute(&wire.from, &to.id, &to.inputs[wire.port].name, at);
        model.edit(operation);
    }
}
