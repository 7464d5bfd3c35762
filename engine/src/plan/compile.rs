//! A document compiled: nodes placed in order of their ids, literals parsed, wires followed to output slots.

use super::expand::{self, Flat, FlatNode, Given};
use super::formula::Formula;
use super::{Bundle, Plan, PlanNode, Slot, UNKNOWN};
use crate::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::document::link::join;
use crate::document::literal::Literal;
use crate::document::model::{Document, Wires};
use crate::evaluate::matching::Matching;
use crate::port::Port;
use crate::registry::{NodeType, Registry};
use crate::value::{Json, Tree};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::Arc;

/// A node type with narrower ranges: ports and the bits of both ends.
type Narrowed<'a> = (u32, Vec<(&'a str, u64, u64)>);

impl Plan {
    /// O(nodes + ports + wires), all clusters expanded; with clusters, times the logarithm.
    pub fn compile(document: &Document, registry: &Registry) -> Self {
        let flat = Flat::expand(document);
        let mut plan = Self {
            ids: Arc::new(flat.nodes.iter().map(|node| &node.path).collect()),
            nodes: Vec::with_capacity(flat.nodes.len()),
            types: Vec::new(),
            type_names: Arc::default(),
            slots: Vec::new(),
            wires: Vec::new(),
            output_node: Vec::new(),
            literals: Vec::new(),
            bundles: Vec::new(),
            successors: Vec::new(),
            levels: 0,
            errors: BTreeMap::new(),
            formulas: BTreeMap::new(),
            instances: BTreeMap::new(),
            strangers: Vec::new(),
            general: registry.absent().values().cloned().collect(),
        };
        plan.place_nodes(&flat, registry);
        plan.connect(&flat, registry);
        flat.finish(&mut plan);
        plan.type_names = Arc::new(plan.types.iter().map(|t| &t.type_name).collect());
        plan.order();
        plan.compute_formulas(document);
        plan.check_interface(document);
        // They grew by doubling; a plan stays as it is for long.
        plan.slots.shrink_to_fit();
        plan.bundles.shrink_to_fit();
        plan.wires.shrink_to_fit();
        plan.output_node.shrink_to_fit();
        plan.literals.shrink_to_fit();
        plan
    }

    fn place_nodes(&mut self, flat: &Flat<'_>, registry: &Registry) {
        let mut known: HashMap<&str, u32> = HashMap::new();
        let mut narrowed = HashMap::new();
        for (n, at) in flat.nodes.iter().enumerate() {
            let (id, node) = (&*at.path, at.node);
            let node_type = match known.get(node.type_name.as_str()) {
                Some(t) => *t,
                None => {
                    let t = registry.get(&node.type_name).map_or(UNKNOWN, |t| {
                        self.types.push(t.clone());
                        self.types.len() as u32 - 1
                    });
                    known.insert(&node.type_name, t);
                    t
                }
            };
            let node_type = self.narrow(node_type, flat, at, &mut narrowed);
            let (slots, outputs) = (self.slots.len() as u32, self.output_node.len() as u32);
            let mut output_count = 0;
            if let Some(t) = self.types.get(node_type as usize).cloned() {
                output_count = t.outputs.len() as u32;
                self.slots.extend(t.defaults.iter().map(|d| if d.is_some() { Slot::Default } else { Slot::Missing }));
                self.output_node.extend((0..output_count).map(|_| n as u32));
                if node.version > t.version {
                    let message = format!(
                        "written for version {} of \"{}\"; this program has version {}",
                        node.version, node.type_name, t.version
                    );
                    self.error(n, None, Diagnostic::error("newer-node", message).at(id));
                } else if node.version < t.version {
                    let message = format!(
                        "written for version {} of \"{}\"; version {} may give other results",
                        node.version, node.type_name, t.version
                    );
                    self.error(
                        n,
                        None,
                        Diagnostic::error("older-node", message).with_severity(Severity::Warning).at(id),
                    );
                }
            } else if let Some(problem) = &at.problem {
                self.error(n, None, Diagnostic::clone(problem));
            } else {
                let absent = node.type_name.split_once('.').and_then(|(prefix, _)| registry.absent().get(prefix));
                let hint = match absent {
                    Some(why) => Some(format!("{}: {}", why.message, why.hint.as_deref().unwrap_or_default())),
                    None => did_you_mean(&node.type_name, registry.iter().map(|t| &*t.type_name)),
                };
                let message = format!("no node type is called \"{}\"", node.type_name);
                self.error(n, None, Diagnostic::error("unknown-node", message).at(id).maybe_hint(hint));
            }
            let of_port = || node.inputs.values().find_map(|w| w.more.matching.filter(|m| *m != Matching::Longest));
            let has_files = self.types.get(node_type as usize).is_some_and(|t| t.inputs.iter().any(|p| p.file));
            self.nodes.push(PlanNode {
                node_type,
                slots,
                outputs,
                output_count,
                successors: 0,
                height: 0,
                matching: node.matching.or_else(of_port).unwrap_or_default(),
                state: at.state,
                has_files,
                sound: true,
            });
        }
        // Unknown nodes and nodes with errors so far are not sound; `error` could not yet mark the node under way.
        for (n, errors) in &self.errors {
            if errors.iter().any(|(_, d)| d.severity == Severity::Error) {
                self.nodes[*n as usize].sound = false;
            }
        }
    }

    /// The node type with the ranges of the clusters around the node; each combination once.
    fn narrow<'a>(
        &mut self,
        node_type: u32,
        flat: &Flat<'a>,
        at: &FlatNode<'a>,
        known: &mut HashMap<Narrowed<'a>, u32>,
    ) -> u32 {
        let ranges = flat.ranges(at);
        let Some(t) = self.types.get(node_type as usize).filter(|_| !ranges.is_empty()).cloned() else {
            return node_type;
        };
        let bits = ranges.iter().map(|(port, min, max)| (*port, min.to_bits(), max.to_bits())).collect();
        *known.entry((node_type, bits)).or_insert_with(|| {
            let (narrow, empty) = t.narrowed(&ranges);
            for port in empty {
                let message = format!("the range that the cluster gives \"{port}\" leaves nothing of the port's own");
                self.general.push(Diagnostic::error("empty-range", message).at(&*at.path).port(port));
            }
            self.types.push(Arc::new(narrow));
            self.types.len() as u32 - 1
        })
    }

    fn connect(&mut self, flat: &Flat<'_>, registry: &Registry) {
        let mut shared = HashMap::new();
        for (n, at) in flat.nodes.iter().enumerate() {
            let Some(t) = self.types.get(self.nodes[n].node_type as usize).cloned() else { continue };
            for (name, given) in flat.given(at) {
                let Some(p) = t.input_index(name) else {
                    self.unknown_input(n, &at.path, name, &t);
                    continue;
                };
                match given {
                    Given::Literal(literal, scope) => self.place_literal(flat, (n, p), literal, scope, &mut shared),
                    Given::Wires(wires, scope) => {
                        if at.node.matching.is_none()
                            && let Some(matching) = wires.more.matching.filter(|m| *m != Matching::Longest)
                            && self.nodes[n].matching == Matching::Longest
                        {
                            self.nodes[n].matching = matching;
                        }
                        self.place_wires((n, p), wires, scope, flat, registry);
                    }
                }
            }
        }
        self.find_successors();
    }

    /// Literals of definitions are parsed once for all instances.
    fn place_literal<'a>(
        &mut self,
        flat: &Flat<'a>,
        (n, p): (usize, usize),
        literal: &'a Literal,
        scope: u32,
        shared: &mut HashMap<(*const Literal, u32, usize), Tree>,
    ) {
        let t = self.types[self.nodes[n].node_type as usize].clone();
        let port = &t.inputs[p];
        let json = literal.json();
        let names = port.names_in(&json);
        if !names.is_empty() {
            // Computed when every literal that it may name is in its place.
            let scope = flat.scopes[scope as usize].path.trim_end_matches('/').into();
            self.formulas.insert((n as u32, p as u32), Formula { names, json: json.into_owned(), scope });
            return;
        }
        let key = (std::ptr::from_ref(literal), self.nodes[n].node_type, p);
        let known = if flat.nodes[n].scope == expand::ROOT { None } else { shared.get(&key).cloned() };
        let literal = known.map_or_else(|| port.literal(&in_folder(port, &json, flat.folder(scope))), Ok);
        match literal {
            Ok(tree) => {
                if flat.nodes[n].scope != expand::ROOT {
                    shared.insert(key, tree.clone());
                }
                self.slots[self.nodes[n].slots as usize + p] = Slot::Literal(self.literals.len() as u32);
                self.literals.push(tree);
            }
            Err(fail) => {
                let id = self.ids[n].to_owned();
                self.error(n, Some(p as u32), fail.at(Severity::Error, &id));
            }
        }
    }

    fn place_wires<'a>(
        &mut self,
        (n, p): (usize, usize),
        wires: &'a Wires,
        scope: u32,
        flat: &Flat<'a>,
        registry: &Registry,
    ) {
        let (t, id) = (self.types[self.nodes[n].node_type as usize].clone(), self.ids[n].to_owned());
        let port = &t.inputs[p];
        let from = self.wires.len() as u32;
        let mut seen = HashSet::new();
        for source in &wires.from {
            if wires.from.len() > 1 && !seen.insert(source) {
                let message = format!("the wire from {source} comes in twice");
                self.error(n, None, Diagnostic::error("duplicate-wire", message).at(&*id).port(port.name()));
                continue;
            }
            match self.source(flat, scope, source, registry, port, &id) {
                Ok(slot) => self.wires.push(slot),
                Err(Some(diagnostic)) => self.error(n, None, diagnostic.at(&*id).port(port.name())),
                // The source cannot be known: it says so itself and blocks this node.
                Err(None) => {
                    let stranger = flat.source(scope, source).ok().and_then(|(path, _)| self.find(&path));
                    self.strangers.extend(stranger.map(|s| (n as u32, s as u32)));
                    let message = format!("blocked: \"{}\" is of an unknown type", flat.path(scope, source));
                    let diagnostic = Diagnostic::error("blocked", message).with_severity(Severity::Note);
                    self.error(n, None, diagnostic.at(&*id).port(port.name()));
                    self.nodes[n].sound = false;
                }
            }
        }
        let to = self.wires.len() as u32;
        if to > from {
            let at = self.nodes[n].slots as usize + p;
            self.slots[at] = if to == from + 1
                && wires.more.tree.is_empty()
                && let Some(source) = self.wires.pop()
            {
                Slot::Wire(source)
            } else {
                self.bundles.push(Bundle { from, to, shape: wires.more.tree.clone() });
                Slot::Wires(self.bundles.len() as u32 - 1)
            };
            // The wire overrules the literal, so the literal's faults do not matter.
            self.mend(n, p as u32);
        }
    }

    fn unknown_input(&mut self, n: usize, id: &str, name: &str, t: &NodeType) {
        let hint = did_you_mean(name, t.inputs.iter().map(Port::name));
        let message = format!("\"{}\" has no input \"{name}\"", t.type_name);
        self.error(n, None, Diagnostic::error("unknown-port", message).at(id).port(name).maybe_hint(hint));
    }

    /// The output slot of `node.port`, if an input of this port can take it; `Err(None)`: its node is of an unknown type.
    fn source<'a>(
        &self,
        flat: &Flat<'a>,
        scope: u32,
        address: &'a str,
        registry: &Registry,
        port: &Port,
        id: &str,
    ) -> Result<u32, Option<Diagnostic>> {
        let (name, output) = flat.source(scope, address)?;
        let (name, address) = (&*name, flat.path(scope, address));
        let Some(n) = self.find(name) else {
            let hint = did_you_mean(name, self.ids.iter().take(10_000));
            let message = format!("the wire comes from \"{address}\", but there is no node \"{name}\"");
            return Err(Some(Diagnostic::error("unknown-source", message).maybe_hint(hint)));
        };
        let Some(t) = self.node_type(n) else { return Err(None) };
        let Some(o) = t.output_index(output) else {
            let hint = did_you_mean(output, t.outputs.iter().map(Port::name));
            let message = format!("\"{}\" ({name}) has no output \"{output}\"", t.type_name);
            return Err(Some(Diagnostic::error("unknown-port", message).maybe_hint(hint)));
        };
        let (from, to) = (&t.outputs[o].item_type, &port.item_type);
        let converts = || from.id.zip(to.id).is_some_and(|(a, b)| registry.conversion(a, b).is_some());
        if !to.accepts(from) && !converts() {
            let message = format!("{address} gives {}, but {id}.{} takes {}", from.name, port.name, to.name);
            return Err(Some(Diagnostic::error("wrong-type", message)));
        }
        Ok(self.nodes[n].outputs + o as u32)
    }
}

/// A literal of a file port as seen from the root: paths in a linked file are relative to that file's folder.
fn in_folder<'a>(port: &Port, json: &'a Json, folder: &str) -> std::borrow::Cow<'a, Json> {
    use std::borrow::Cow::{Borrowed, Owned};
    let one = |path: &Json| path.as_str().map_or_else(|| path.clone(), |path| Json::from(join(folder, path)));
    match json {
        _ if folder.is_empty() || !port.file => Borrowed(json),
        Json::Array(paths) => Owned(paths.iter().map(one).collect()),
        path => Owned(one(path)),
    }
}
