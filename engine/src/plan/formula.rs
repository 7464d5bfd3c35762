//! Parameters that are formulas over interface inputs: of the whole graph, or of the cluster that they stand in. An input
//! of the graph is a plain value; one of a cluster may be a formula that stands outside of it. So formulas are computed
//! from the outside inwards, and no circle can arise: changing an input renews the formulas that name it.

use super::{Plan, Slot};
use crate::diagnostic::{Fail, Severity, did_you_mean};
use crate::document::model::{Document, InterfaceInput};
use crate::expression::{Expression, Quantity};
use crate::value::{Json, Tree};
use std::collections::BTreeMap;

/// A parameter to be computed.
pub(super) struct Formula {
    /// The interface inputs in it.
    pub names: Vec<String>,
    /// As it is written.
    pub json: Json,
    /// Path of the instance in whose cluster it stands; empty for the graph itself.
    pub scope: Box<str>,
}

impl Plan {
    /// Computes every formula. O(formulas × log nodes).
    pub(super) fn compute_formulas(&mut self, document: &Document) {
        for (n, p) in self.formulas_inwards() {
            self.renew_formula(document, n as usize, p as usize);
        }
    }

    /// All formulas, the outer ones first.
    fn formulas_inwards(&self) -> Vec<(u32, u32)> {
        let mut places: Vec<(u32, (u32, u32))> =
            self.formulas.iter().map(|(place, f)| (self.depth(&f.scope), *place)).collect();
        places.sort_unstable();
        places.into_iter().map(|(_, place)| place).collect()
    }

    fn depth(&self, scope: &str) -> u32 {
        self.instances.get(scope).map_or(0, |instance| instance.depth)
    }

    /// The interface inputs that formulas of a scope may name.
    fn inputs<'a>(&'a self, document: &'a Document, scope: &str) -> &'a BTreeMap<String, InterfaceInput> {
        self.instances.get(scope).map_or(&document.inputs, |instance| &instance.interface.inputs)
    }

    /// `node.port` in a scope as an address of the plan.
    fn inside(scope: &str, address: &str) -> String {
        if scope.is_empty() { address.to_owned() } else { format!("{scope}/{address}") }
    }

    /// What a literal of the graph itself stands for at a port, formulas computed from the interface inputs as they are.
    pub(crate) fn literal(&self, document: &Document, n: usize, p: usize, json: &Json) -> Result<Tree, Fail> {
        self.literal_in(document, "", n, p, json)
    }

    fn literal_in(&self, document: &Document, scope: &str, n: usize, p: usize, json: &Json) -> Result<Tree, Fail> {
        let Some(port) = self.node_type(n).and_then(|t| t.inputs.get(p)) else {
            return Err(Fail::new("unknown-port", "there is no such input"));
        };
        port.literal_with(json, &|name| match self.input_of(document, scope, n, p) {
            Some(own) => {
                Err(format!("interface input \"{own}\" is set here, and inputs cannot be computed from inputs"))
            }
            None => self.input_number(document, scope, name),
        })
    }

    /// The interface input of that scope that sets this parameter.
    fn input_of<'a>(&'a self, document: &'a Document, scope: &str, n: usize, p: usize) -> Option<&'a str> {
        let sets =
            |address: &String| self.find_inputs(&Self::inside(scope, address)).is_ok_and(|all| all.contains(&(n, p)));
        let mut inputs = self.inputs(document, scope).iter();
        inputs.find(|(_, input)| input.ports.iter().any(sets)).map(|(name, _)| name.as_str())
    }

    /// The one number that an interface input stands for, with the unit of its first port; if that has none, with the unit
    /// that the interface gives it.
    fn input_number(&self, document: &Document, scope: &str, name: &str) -> Result<Quantity, String> {
        let inputs = self.inputs(document, scope);
        let Some(input) = inputs.get(name) else {
            let unit = Quantity::unit(name).map(|_| format!("a unit stands after a number: 1 {name}"));
            let hint = unit.or_else(|| did_you_mean(name, inputs.keys().map(String::as_str)));
            let hint = hint.map(|h| format!(" ({h})")).unwrap_or_default();
            return Err(format!("expected a number or an input's name; there is no input \"{name}\"{hint}"));
        };
        let place = input.ports.first().map(|address| self.find_input(&Self::inside(scope, address)));
        let Some(Ok((n, p))) = place else { return Err(format!("input \"{name}\" leads nowhere")) };
        let place = (n as u32, p as u32);
        let faulty = |(port, _): &(Option<u32>, _)| *port == Some(place.1);
        // A formula from further outside has been computed before.
        let open = self.formulas.get(&place).is_some_and(|f| self.depth(&f.scope) >= self.depth(scope));
        if open || self.errors.get(&place.0).is_some_and(|e| e.iter().any(faulty)) {
            return Err(format!("the value of input \"{name}\" is not accepted"));
        }
        let Some(t) = self.node_type(n) else { return Err(format!("input \"{name}\" leads nowhere")) };
        let tree = match self.slot(n, p) {
            Slot::Literal(l) => self.literals.get(l as usize),
            Slot::Default => t.defaults.get(p).and_then(Option::as_ref),
            Slot::Missing => return Err(format!("input \"{name}\" has no value yet")),
            Slot::Wire(_) | Slot::Wires(_) => return Err(format!("input \"{name}\" is overruled by a wire")),
        };
        let number = tree
            .filter(|tree| tree.len() == 1)
            .and_then(|tree| tree.first::<f64>().copied().or_else(|| tree.first::<i64>().map(|v| *v as f64)));
        let Some(value) = number else {
            let found = tree.map_or_else(String::new, |tree| format!(", but {}", tree.summary()));
            return Err(format!("input \"{name}\" is not one number{found}"));
        };
        let dimension = t.inputs[p].unit.dimension();
        let declared = input.unit.as_deref().and_then(Quantity::unit).filter(|_| dimension.is_plain());
        Ok(match declared {
            Some(unit) => Quantity { value: value * unit.value, ..unit },
            None => Quantity { value, dimension },
        })
    }

    /// True if the value at a port is computed by a formula that stands in the cluster of that instance.
    pub(crate) fn is_formula_of(&self, n: usize, p: usize, instance: &str) -> bool {
        let wired = self.slot(n, p).is_wired();
        !wired && self.formulas.get(&(n as u32, p as u32)).is_some_and(|f| &*f.scope == instance)
    }

    /// The literal at a port.
    pub(crate) fn value_at(&self, n: usize, p: usize) -> Option<&Tree> {
        match self.slot(n, p) {
            Slot::Literal(l) => self.literals.get(l as usize),
            _ => None,
        }
    }

    /// What stands for an input of an instance's cluster in formulas of the graph around it: the formula that the instance
    /// gives, or else its number with its unit.
    pub(crate) fn input_text(&self, document: &Document, instance: &str, name: &str) -> Result<String, String> {
        let number = self.input_number(document, instance, name)?;
        let input = self.inputs(document, instance).get(name).and_then(|input| input.ports.first());
        let place = input.and_then(|address| self.find_input(&Self::inside(instance, address)).ok());
        let outer = place.and_then(|(n, p)| self.formulas.get(&(n as u32, p as u32))).filter(|f| f.scope.is_empty());
        if let Some(text) = outer.and_then(|f| f.json.as_str()) {
            let formula = Expression::parse(text).map_err(|e| e.to_string())?;
            let value = formula.evaluate(&|name| self.input_number(document, "", name)).map_err(|e| e.to_string())?;
            if value.dimension == number.dimension {
                return Ok(format!("({text})"));
            }
            return Ok(format!("(({text}) * 1 {})", number.dimension));
        }
        let sign = if number.dimension.is_plain() { String::new() } else { format!(" {}", number.dimension) };
        Ok(format!("({:?}{sign})", number.value))
    }

    /// Remembers which inputs a parameter names that was newly set from outside of all clusters.
    pub(crate) fn note_formula(&mut self, n: usize, p: usize, json: &Json) {
        let port = self.node_type(n).and_then(|t| t.inputs.get(p));
        // Only texts are formulas.
        let may_be = !json.is_number() && !json.is_boolean();
        let names = port.filter(|_| may_be).map(|port| port.names_in(json)).unwrap_or_default();
        if names.is_empty() {
            self.formulas.remove(&(n as u32, p as u32));
        } else {
            let formula = Formula { names, json: json.clone(), scope: "".into() };
            self.formulas.insert((n as u32, p as u32), formula);
        }
    }

    /// Computes the formulas anew that name an interface input set at one of these places; gives the nodes of which a
    /// parameter is now another. O(formulas × names × log nodes).
    pub(crate) fn renew_formulas(&mut self, document: &Document, places: &[(usize, usize)]) -> Vec<u32> {
        if self.formulas.is_empty() {
            return Vec::new();
        }
        let (mut changed, mut nodes) = (places.to_vec(), Vec::new());
        for (n, p) in self.formulas_inwards() {
            let Some(formula) = self.formulas.get(&(n, p)) else { continue };
            let inputs = self.inputs(document, &formula.scope);
            let first = |name: &String| {
                let address = inputs.get(name)?.ports.first()?;
                self.find_input(&Self::inside(&formula.scope, address)).ok()
            };
            let stale = formula.names.iter().filter_map(first).any(|place| changed.contains(&place));
            if stale && self.renew_formula(document, n as usize, p as usize) {
                changed.push((n as usize, p as usize));
                nodes.push(n);
            }
        }
        nodes
    }

    /// Computes one formula; true if the parameter is now another than before. What cannot be computed is an error of
    /// the node, and goes when it can.
    fn renew_formula(&mut self, document: &Document, n: usize, p: usize) -> bool {
        let Some(id) = self.ids.get(n).map(str::to_owned) else { return false };
        let formula = self.formulas.get(&(n as u32, p as u32));
        let (Some(formula), false) = (formula, self.slot(n, p).is_wired()) else { return false };
        match self.literal_in(document, &formula.scope, n, p, &formula.json) {
            Ok(tree) => {
                let same = match self.slot(n, p) {
                    Slot::Literal(l) => self.literals.get(l as usize).is_some_and(|old| old.digest() == tree.digest()),
                    _ => false,
                };
                if !same {
                    self.set_literal(n, p, Some(tree));
                }
                !same
            }
            Err(fail) => {
                self.set_literal(n, p, None);
                self.error(n, Some(p as u32), fail.at(Severity::Error, &id));
                true
            }
        }
    }
}
