//! What a hand does with nodes on the canvas, as operations: new nodes and wires, copies, clusters, groups.

use super::arrange;
use super::param::{self, Typed, round_step};
use super::{Model, split_layout};
use std::collections::{BTreeSet, HashMap};
use tenon_engine::{
    Diagnostic, Document, InterfaceInput, InterfaceOutput, Json, Literal, Look, Node, NodeState, Operation, OuterWires,
    Table,
};

impl Model {
    /// An id that no node has, made from the name of a type: `point`, `point-2` …
    #[must_use]
    pub fn free_id(&self, type_name: &str) -> String {
        let stem = type_name.strip_prefix("cluster:").unwrap_or(type_name).replace(['.', '/'], "_");
        let taken = |id: &str| self.document().nodes().contains_key(id);
        if !taken(&stem) {
            return stem;
        }
        (2u64..).map(|n| format!("{stem}-{n}")).find(|id| !taken(id)).unwrap_or(stem)
    }

    /// The operation that adds a node of a type at a place, and the id that it gets.
    #[must_use]
    pub fn new_node(&self, type_name: &str, at: [f64; 2]) -> (String, Operation) {
        let id = self.free_id(type_name);
        let mut node = Node::new(type_name);
        node.version = self.catalog.get(type_name).map_or(1, |t| t.version);
        let add = Operation::AddNode { id: id.clone(), node: Box::new(node) };
        let put = Operation::Move { node: id.clone(), to: Some(at.map(f64::round)) };
        (id, Operation::All(vec![add, put]))
    }

    /// The operation that brings a wire from an output to an input: at an input for single items it takes the place of
    /// the one that was there, at one for lists it comes last.
    #[must_use]
    pub fn new_wire(&self, from: &str, node: &str, port: &str) -> Operation {
        let connect = Operation::Connect { node: node.into(), port: port.into(), from: from.into(), at: None };
        let there = self.document().nodes().get(node).and_then(|n| n.inputs.get(port)).map_or(&[][..], |w| &w.from);
        let info = self.document().nodes().get(node).map(|n| self.catalog.of(n));
        let single = info.and_then(|t| t.inputs.iter().find(|p| p.name == port).map(|p| p.access))
            == Some(tenon_engine::Access::Item);
        if !single || there.is_empty() {
            return connect;
        }
        let gone =
            there.iter().map(|f| Operation::Disconnect { node: node.into(), port: port.into(), from: f.to_string() });
        Operation::All(gone.chain([connect]).collect())
    }

    /// The selected nodes as the text of a graph, for the clipboard; `None` if nothing is selected.
    pub fn copy(&mut self) -> Option<String> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let fragment = self.scope().copy(&ids).ok().filter(|_| !ids.is_empty())?;
        let mut text = fragment.to_string_canonical();
        // The layout follows the graph in the same text, as a second value.
        text.push_str(&fragment.layout_to_string());
        self.copied = Some((text.clone(), self.here_it_is()));
        Some(text)
    }

    /// Which canvas this is: that of a graph since it was opened, or of one of its clusters.
    fn here_it_is(&self) -> (u64, Option<String>) {
        (self.opened, self.inside.last().map(|e| e.cluster.clone()))
    }

    /// Puts copied nodes into the graph and selects them: their middle at a place of the canvas, else beside where they were.
    /// Wires from nodes that were not copied stay where they were copied; elsewhere nodes of the same name are other ones.
    ///
    /// # Errors
    /// If the text is no graph, or what it says is refused.
    pub fn paste(&mut self, text: &str, at: Option<[f64; 2]>) -> Result<(), Diagnostic> {
        let (graph, layout) = split_layout(text);
        let mut fragment = Document::from_slice(graph.as_bytes()).map_err(|all| {
            let first = all.into_iter().next().map_or_else(String::new, |d| d.message);
            Diagnostic::error("no-graph", format!("what was copied is no graph: {first}"))
        })?;
        if !layout.is_empty() {
            fragment.read_layout(layout.as_bytes())?;
        }
        let offset = at.and_then(|at| offset_to(&fragment, at)).unwrap_or([40.0, 40.0]);
        let here = self.copied.as_ref().is_some_and(|(copied, from)| copied == text && *from == self.here_it_is());
        self.insert(&fragment, if here { OuterWires::Keep } else { OuterWires::Drop }, offset)
    }

    /// Puts a piece of another graph at a place of the canvas and selects it; nodes without a place are put in columns there.
    ///
    /// # Errors
    /// If the document refuses it.
    pub fn insert_at(&mut self, piece: &Document, at: [f64; 2]) -> Result<(), Diagnostic> {
        let mut piece = piece.clone();
        let homeless: Vec<String> = piece.nodes().keys().filter(|id| piece.position(id).is_none()).cloned().collect();
        let places = arrange::arrange(&piece, |_| [190.0, 120.0]);
        for (node, to) in places.into_iter().filter(|(id, _)| homeless.contains(id)) {
            Operation::Move { node, to: Some(to) }.apply(&mut piece)?;
        }
        let offset = offset_to(&piece, at).unwrap_or_default();
        self.insert(&piece, OuterWires::Drop, offset)
    }

    /// Puts a fragment into what stands on the canvas and selects it.
    ///
    /// # Errors
    /// If the document refuses it.
    pub fn insert(&mut self, fragment: &Document, outer: OuterWires, offset: [f64; 2]) -> Result<(), Diagnostic> {
        let paste = self.scope().paste(fragment, outer, offset);
        self.apply(paste.operation)?;
        self.selection = paste.ids.into_values().collect();
        Ok(())
    }

    /// Puts copies of the selected nodes beside them and selects those.
    ///
    /// # Errors
    /// If the document refuses them.
    pub fn duplicate(&mut self, offset: [f64; 2]) -> Result<(), Diagnostic> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let fragment = self.scope().copy(&ids)?;
        self.insert(&fragment, OuterWires::Keep, offset)
    }

    /// Moves the selected nodes by so much.
    pub fn nudge(&mut self, by: [f64; 2]) {
        let moves = self.selection.iter().map(|id| {
            let [x, y] = self.position(id).unwrap_or_default();
            Operation::Move { node: id.clone(), to: Some([x + by[0], y + by[1]]) }
        });
        let moves: Vec<Operation> = moves.collect();
        if !moves.is_empty() {
            self.edit(Operation::All(moves));
        }
    }

    /// Selects, besides what is, all nodes that it is made of, or all that follow from it. O(nodes + wires).
    pub fn select_along(&mut self, follow: bool) {
        let mut next: HashMap<&str, Vec<&str>> = HashMap::new();
        for (id, node) in self.document().nodes() {
            for source in node.inputs.values().flat_map(|w| &w.from).filter_map(|f| f.split_once('.')) {
                let (a, b) = if follow { (source.0, id.as_str()) } else { (id.as_str(), source.0) };
                next.entry(a).or_default().push(b);
            }
        }
        let mut open: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let mut all: BTreeSet<&str> = open.iter().copied().collect();
        while let Some(id) = open.pop() {
            let more = next.get(id).into_iter().flatten().filter(|n| self.document().nodes().contains_key(**n));
            open.extend(more.copied().filter(|n| all.insert(n)));
        }
        self.selection = all.into_iter().map(str::to_owned).collect();
    }

    /// Removes the selected nodes with their wires.
    pub fn delete_selection(&mut self) {
        let all = self.selection.iter().map(|id| Operation::RemoveNode { id: id.clone() }).collect();
        if !self.selection.is_empty() {
            self.edit(Operation::All(all));
        }
    }

    /// Makes a cluster of the selected nodes, with one instance in their place, and selects that.
    ///
    /// # Errors
    /// If a port takes wires both from selected nodes and from others.
    pub fn gather(&mut self) -> Result<(), Diagnostic> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let places: Vec<[f64; 2]> = ids.iter().filter_map(|id| self.document().position(id)).collect();
        let scope = self.scope();
        let taken = |n: &str| scope.clusters.contains_key(n) || scope.nodes().contains_key(n);
        let name = (1u64..).map(|n| format!("cluster-{n}")).find(|n| !taken(n)).unwrap_or_default();
        let gather = scope.gather(&ids, &name, &name)?;
        drop(scope);
        let middle = [0, 1].map(|k| (places.iter().map(|p| p[k]).sum::<f64>() / places.len().max(1) as f64).round());
        let put = Operation::Move { node: name.clone(), to: Some(middle) };
        self.apply(Operation::All(vec![gather, put]))?;
        self.selection = [name].into();
        Ok(())
    }

    /// Puts the nodes of a cluster in the place of one of its instances and selects them.
    ///
    /// # Errors
    /// If it is no instance, or its definition cannot be used.
    pub fn explode(&mut self, instance: &str) -> Result<(), Diagnostic> {
        let paste = self.scope().explode(instance, &self.registry)?;
        self.apply(paste.operation)?;
        self.selection = paste.ids.into_values().collect();
        Ok(())
    }

    /// What a node's parameter is set to.
    #[must_use]
    pub fn param(&self, id: &str, port: &str) -> Option<Json> {
        self.document().nodes().get(id)?.params.get(port).map(Literal::to_json)
    }

    /// Shows what the selected nodes make, or hides it if all of them are shown, as one step.
    pub fn toggle_preview(&mut self) {
        let show = !self.selection.iter().all(|id| self.previews(id));
        let look = |id: &String| Look { shown: Some(show), ..self.document().look(id) };
        let all = self.selection.iter().map(|id| Operation::SetLook { node: id.clone(), look: look(id) });
        let all: Vec<Operation> = all.collect();
        if !all.is_empty() {
            self.edit(Operation::All(all));
        }
    }

    /// Lets a node show all its inputs, or only those that say something, if it shows all.
    pub fn fold(&mut self, id: &str) {
        let look = self.document().look(id);
        self.edit(Operation::SetLook { node: id.to_owned(), look: Look { open: !look.open, ..look } });
    }

    /// Brings the selected nodes into a state, or back to running if all of them are in it.
    pub fn toggle_state(&mut self, state: NodeState) {
        let nodes = self.document().nodes();
        let all = self.selection.iter().filter_map(|id| Some((id, nodes.get(id)?.state)));
        let now: Vec<(String, NodeState)> = all.map(|(id, s)| (id.clone(), s)).collect();
        let to = if now.iter().all(|(_, s)| *s == state) { NodeState::On } else { state };
        let set = |(node, _)| Operation::SetState { node, state: to };
        if !now.is_empty() {
            self.edit(Operation::All(now.into_iter().map(set).collect()));
        }
    }

    /// A name of an interface input or output that is not taken, made from that of a port.
    #[must_use]
    pub fn free_name(&self, port: &str) -> String {
        let taken = |n: &str| self.document().inputs.contains_key(n) || self.document().outputs.contains_key(n);
        if !taken(port) {
            return port.to_owned();
        }
        (2u64..).map(|n| format!("{port}_{n}")).find(|n| !taken(n)).unwrap_or_default()
    }

    /// The operation that makes a port an input or output of the graph (or of the cluster that is worked on), or takes that
    /// back if it is one.
    #[must_use]
    pub fn toggle_exposed(&self, node: &str, port: &str, output: bool) -> Operation {
        let address = format!("{node}.{port}");
        let document = self.document();
        if output {
            let there = document.outputs.iter().find(|(_, o)| o.port == address).map(|(n, _)| n.clone());
            let mut bound = InterfaceOutput::default();
            (bound.port, bound.unit) = (address, None);
            return match there {
                Some(name) => Operation::SetOutput { name, output: None },
                None => Operation::SetOutput { name: self.free_name(port), output: Some(bound) },
            };
        }
        match document.inputs.iter().find(|(_, i)| i.ports.contains(&address)) {
            Some((name, input)) => {
                let mut input = input.clone();
                input.ports.retain(|p| *p != address);
                Operation::SetInput { name: name.clone(), input: Some(input).filter(|i| !i.ports.is_empty()) }
            }
            None => {
                let there = document.nodes().get(node);
                let info =
                    there.and_then(|n| Some((n, self.catalog.of(n).inputs.iter().find(|p| p.name == port)?.clone())));
                let info = info.map(|(n, p)| param::at(n, &p, None));
                let mut input = InterfaceInput::default();
                input.ports = vec![address];
                if let Some(info) = info {
                    // What a person has set for the node goes on to be so; the port's own range needs no saying.
                    (input.min, input.max) = info.range.filter(|_| info.chosen).unzip();
                    input.unit = Some(info.unit).filter(|u| !u.is_empty());
                }
                // A value that is only called value is known by its node.
                let generic = port == "value" && self.trail().is_empty();
                let name = self.free_name(if generic { node } else { port });
                Operation::SetInput { name, input: Some(input) }
            }
        }
    }

    /// The operation that makes a slider of a `number` or `integer` node, with ends around its value; wires stay. None if it
    /// is neither, or something comes to it by wire.
    #[must_use]
    pub fn number_to_slider(&self, id: &str) -> Option<Operation> {
        let node = self.document().nodes().get(id)?;
        let whole = node.type_name == "integer";
        let value = node.params.get("value").map_or(Some(5.0), |v| v.json().as_f64())?;
        if !(whole || node.type_name == "number") || node.inputs.get("value").is_some_and(|w| !w.from.is_empty()) {
            return None;
        }
        let mut typed = Typed::read(&value.to_string())?;
        if !whole {
            typed.slider.step = typed.slider.step.min(0.1);
        }
        let mut slider = Node::new(typed.type_name());
        for (port, value) in typed.params() {
            slider.params.insert(port, Literal::from(value));
        }
        (slider.state, slider.more, slider.matching) = (node.state, node.more.clone(), node.matching);
        Some(Operation::PutNode { id: id.to_owned(), node: Some(Box::new(slider)) })
    }

    /// The operation that puts a slider before an input that takes numbers, with the value that stands there. None if it takes
    /// none, or has a wire.
    #[must_use]
    pub fn slider_before(&self, id: &str, port: &str, at: [f64; 2]) -> Option<Operation> {
        let node = self.document().nodes().get(id)?;
        let info = self.catalog.of(node).inputs.iter().find(|p| p.name == port)?.clone();
        let wired = node.inputs.get(port).is_some_and(|w| !w.from.is_empty());
        let whole = info.type_name == "integer";
        if wired || !(whole || info.type_name == "number") {
            return None;
        }
        let info = param::at(node, &info, None);
        let value = self.param(id, port).or(info.default).and_then(|v| v.as_f64()).unwrap_or(5.0);
        let mut typed = Typed::read(&value.to_string())?;
        if let Some((min, max)) =
            info.range.filter(|(min, max)| max - min <= param::WIDEST && (*min..=*max).contains(&value))
        {
            (typed.slider.min, typed.slider.max) = (min, max);
        }
        if !whole {
            typed.slider.step = typed.slider.step.min(round_step((typed.slider.max - typed.slider.min) / 200.0));
        }
        let (slider, add) = self.new_node(typed.type_name(), at);
        let set = |(port, value): (&str, Json)| Operation::SetParam {
            node: slider.clone(),
            port: port.to_owned(),
            value: Some(value),
        };
        let mut all = vec![add];
        all.extend(typed.params().into_iter().map(set));
        all.push(self.new_wire(&format!("{slider}.value"), id, port));
        Some(Operation::All(all))
    }

    /// The operation that changes one key of a group; none takes it away. O(group).
    #[must_use]
    pub fn set_in_group(&self, group: &str, key: &str, value: Option<Json>) -> Operation {
        let mut entry = self.document().groups.get(group).cloned().unwrap_or_default();
        if let Some(object) = entry.as_object_mut() {
            match value {
                Some(value) => drop(object.insert(key.to_owned(), value)),
                None => drop(object.remove(key)),
            }
        }
        Operation::SetEntry { table: Table::Groups, key: group.to_owned(), value: Some(entry) }
    }

    /// The operation that puts a reroute point into a wire.
    #[must_use]
    pub fn reroute(&self, from: &str, node: &str, port: &str, at: [f64; 2]) -> Operation {
        let (id, add) = self.new_node("reroute", at);
        let wires = self.document().nodes().get(node).and_then(|n| n.inputs.get(port));
        let place = wires.and_then(|w| w.from.iter().position(|f| f.as_str() == from));
        let (node, port) = (node.to_owned(), port.to_owned());
        let gone = Operation::Disconnect { node: node.clone(), port: port.clone(), from: from.to_owned() };
        let to = Operation::Connect { node: id.clone(), port: "value".into(), from: from.to_owned(), at: None };
        let on = Operation::Connect { node, port, from: format!("{id}.value"), at: place };
        Operation::All(vec![add, gone, to, on])
    }
}

/// How far a fragment has to be moved, on the grid, so that its middle is at a place; none if no node of it has a place.
fn offset_to(fragment: &Document, at: [f64; 2]) -> Option<[f64; 2]> {
    let places: Vec<[f64; 2]> = fragment.nodes().keys().filter_map(|id| fragment.position(id)).collect();
    let middle = |k: usize| {
        let all = || places.iter().map(|p| p[k]);
        let (low, high) = (all().fold(f64::INFINITY, f64::min), all().fold(f64::NEG_INFINITY, f64::max));
        (low + high) / 2.0
    };
    (!places.is_empty()).then(|| [0, 1].map(|k| ((at[k] - middle(k)) / 10.0).round() * 10.0))
}
