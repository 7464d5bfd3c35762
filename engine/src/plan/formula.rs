//! Parameters that are formulas over interface inputs. An interface input itself is a plain value, so no chain of formulas
//! and no cycle can arise: changing an input renews the formulas that name it, and nothing further.

use super::{Plan, Slot};
use crate::diagnostic::{Fail, Severity, did_you_mean};
use crate::document::model::Document;
use crate::expression::Quantity;
use crate::value::{Json, Tree};

impl Plan {
    /// Computes every formula of the document. O(formulas × log nodes).
    pub(super) fn compute_formulas(&mut self, document: &Document) {
        let places: Vec<(u32, u32)> = self.formulas.keys().copied().collect();
        for (n, p) in places {
            self.renew_formula(document, n as usize, p as usize);
        }
    }

    /// What a parameter's literal stands for, formulas computed from the interface inputs as they are.
    pub(crate) fn literal(&self, document: &Document, n: usize, p: usize, json: &Json) -> Result<Tree, Fail> {
        let Some(port) = self.node_type(n).and_then(|t| t.inputs.get(p)) else {
            return Err(Fail::new("unknown-port", "there is no such input"));
        };
        port.literal_with(json, &|name| match self.input_of(document, n, p) {
            Some(own) => {
                Err(format!("interface input \"{own}\" is set here, and inputs cannot be computed from inputs"))
            }
            None => self.input_number(document, name),
        })
    }

    /// The interface input that sets this parameter.
    fn input_of<'a>(&self, document: &'a Document, n: usize, p: usize) -> Option<&'a str> {
        let sets = |address: &String| self.find_input(address).is_ok_and(|place| place == (n, p));
        document.inputs.iter().find(|(_, input)| input.ports.iter().any(sets)).map(|(name, _)| name.as_str())
    }

    /// The one number that an interface input stands for, with the unit of its first port; if that has none, with the unit
    /// that the interface gives it.
    fn input_number(&self, document: &Document, name: &str) -> Result<Quantity, String> {
        let Some(input) = document.inputs.get(name) else {
            let unit = Quantity::unit(name).map(|_| format!("a unit stands after a number: 1 {name}"));
            let hint = unit.or_else(|| did_you_mean(name, document.inputs.keys().map(String::as_str)));
            let hint = hint.map(|h| format!(" ({h})")).unwrap_or_default();
            return Err(format!("expected a number or an input's name; there is no input \"{name}\"{hint}"));
        };
        let place = input.ports.first().map(|address| self.find_input(address));
        let Some(Ok((n, p))) = place else { return Err(format!("input \"{name}\" leads nowhere")) };
        let place = (n as u32, p as u32);
        let faulty = |(port, _): &(Option<u32>, _)| *port == Some(place.1);
        if self.formulas.contains_key(&place) || self.errors.get(&place.0).is_some_and(|e| e.iter().any(faulty)) {
            return Err(format!("the value of input \"{name}\" is not accepted"));
        }
        let Some(t) = self.node_type(n) else { return Err(format!("input \"{name}\" leads nowhere")) };
        let tree = match self.slot(n, p) {
            Slot::Literal(l) => self.literals.get(l as usize),
            Slot::Default => t.defaults.get(p).and_then(Option::as_ref),
            Slot::Missing => return Err(format!("input \"{name}\" has no value yet")),
            Slot::Wires { .. } => return Err(format!("input \"{name}\" is overruled by a wire")),
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

    /// Remembers which inputs a newly set parameter names.
    pub(crate) fn note_formula(&mut self, n: usize, p: usize, json: &Json) {
        let port = self.node_type(n).and_then(|t| t.inputs.get(p));
        let names = port.map(|port| port.names_in(json)).unwrap_or_default();
        if names.is_empty() {
            self.formulas.remove(&(n as u32, p as u32));
        } else {
            self.formulas.insert((n as u32, p as u32), names);
        }
    }

    /// Computes the formulas anew that name an interface input set at one of these places; gives the nodes of which a
    /// parameter is now another. O(inputs × log nodes + formulas).
    pub(crate) fn renew_formulas(&mut self, document: &Document, places: &[(usize, usize)]) -> Vec<u32> {
        if self.formulas.is_empty() {
            return Vec::new();
        }
        let set = |address: &String| self.find_input(address).is_ok_and(|place| places.contains(&place));
        let changed = document.inputs.iter().filter(|(_, input)| input.ports.first().is_some_and(set));
        let changed: Vec<&String> = changed.map(|(name, _)| name).collect();
        let stale = self.formulas.iter().filter(|(_, names)| names.iter().any(|name| changed.contains(&name)));
        let stale: Vec<(u32, u32)> = stale.map(|(place, _)| *place).collect();
        let renewed = stale.into_iter().filter(|(n, p)| self.renew_formula(document, *n as usize, *p as usize));
        renewed.map(|(n, _)| n).collect()
    }

    /// Computes one formula; true if the parameter is now another than before. What cannot be computed is an error of
    /// the node, and goes when it can.
    fn renew_formula(&mut self, document: &Document, n: usize, p: usize) -> bool {
        let Some(t) = self.node_type(n).cloned() else { return false };
        let Some(id) = self.ids.get(n).cloned() else { return false };
        let json = document.nodes.get(&*id).and_then(|node| node.params.get(t.inputs[p].name()));
        let (Some(json), false) = (json, matches!(self.slot(n, p), Slot::Wires { .. })) else { return false };
        match self.literal(document, n, p, json) {
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
