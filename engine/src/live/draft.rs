//! A document that is changed while somebody else evaluates an older state of it: what changes are refused, and which
//! operations a new value comes to.

use crate::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::document::model::{Document, split_port};
use crate::document::operations::Operation;
use crate::evaluate::gather::convert;
use crate::evaluate::given::Given;
use crate::evaluate::session::{Host, check_range, no_input};
use crate::port::Port;
use crate::registry::Registry;
use crate::value::{Json, Tree};
use std::sync::Arc;

/// The editing half of a session: it holds a document and refuses what the session would, so that whoever edits never
/// waits for an evaluation. What it accepts is given to the session later, in the same order.
pub struct Draft {
    registry: Arc<Registry>,
    host: Arc<dyn Host>,
    document: Document,
}

impl Draft {
    /// A draft of a document that a session over the same registry and host has migrated already
    /// ([`crate::Session::document`]).
    #[must_use]
    pub fn new(registry: Arc<Registry>, host: Arc<dyn Host>, document: Document) -> Self {
        Self { registry, host, document }
    }

    /// The document as it stands.
    #[must_use]
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The registry.
    #[must_use]
    pub fn registry(&self) -> &Arc<Registry> {
        &self.registry
    }

    /// Changes the document and gives the operation that takes the change back. As costly as the operation.
    ///
    /// # Errors
    /// If the operation is refused; then nothing has changed.
    pub fn apply(&mut self, operation: &Operation) -> Result<Operation, Diagnostic> {
        let inverse = operation.apply(&mut self.document)?;
        // The session does the same when it sees new nodes.
        use Operation as O;
        if operation.parts().any(|o| matches!(o, O::SetCluster { .. })) {
            self.document.read_links(&*self.host);
        }
        let adds =
            |o: &O| matches!(o, O::AddNode { .. } | O::PutNode { .. } | O::SetCluster { .. } | O::InCluster { .. });
        if operation.parts().any(adds) {
            self.document.migrate(&self.registry);
        }
        Ok(inverse)
    }

    /// The operations that make the document what `document` is. O(n).
    #[must_use]
    pub fn steps_to(&self, mut document: Document) -> Vec<Operation> {
        document.migrate(&self.registry);
        self.document.diff(&document)
    }

    /// The operations that give interface inputs and parameters (`node.port`) new values; `null` brings a default back.
    /// Nothing has changed yet.
    ///
    /// # Errors
    /// If there is no such name, a port has a wire, or a value is not accepted. Formulas are computed later: what is wrong
    /// with one stands in the report.
    pub fn settings<'a>(
        &self,
        values: impl IntoIterator<Item = (&'a str, Json)>,
    ) -> Result<Vec<Operation>, Diagnostic> {
        let mut all = Vec::new();
        for (name, value) in values {
            let interface = self.document.inputs.get(name);
            for (id, port_name, port) in self.places(name)? {
                let names = port.names_in(&value);
                let is_formula = !names.is_empty() && names.iter().all(|name| self.document.inputs.contains_key(name));
                if !value.is_null() && !is_formula {
                    let tree = port.literal(&value).map_err(|fail| fail.at(Severity::Error, id))?;
                    if let Some(input) = interface {
                        check_range(name, input, &tree)?;
                    }
                }
                let value = (!value.is_null()).then(|| value.clone());
                all.push(Operation::SetParam { node: id.to_owned(), port: port_name.to_owned(), value });
            }
        }
        Ok(all)
    }

    /// What gives an interface input or a parameter (`node.port`) a value that has no written form, such as a mesh:
    /// for [`crate::Session::give`]. Items are converted as on a wire. O(items).
    ///
    /// # Errors
    /// If there is no such name, a port has a wire, or does not take such items.
    pub fn given(&self, name: &str, tree: &Tree) -> Result<Vec<Given>, Diagnostic> {
        let interface = self.document.inputs.get(name);
        let one = |(id, port_name, port): (&str, &str, &Port)| {
            let mut reports = Vec::new();
            let tree = convert(tree, port, &self.registry, &mut reports);
            let tree = tree.map_err(|fail| fail.at(Severity::Error, id))?.into_owned();
            let bad = tree.branches().iter().flat_map(|(_, column)| port.check(column).told);
            if let Some(fail) = reports.into_iter().map(|(_, fail)| fail).chain(bad).next() {
                return Err(fail.at(Severity::Error, id));
            }
            if let Some(input) = interface {
                check_range(name, input, &tree)?;
            }
            Ok(Given { node: id.to_owned(), port: port_name.to_owned(), tree })
        };
        self.places(name)?.into_iter().map(one).collect()
    }

    /// The ports without wires that a name stands for.
    fn places<'a>(&'a self, name: &'a str) -> Result<Vec<(&'a str, &'a str, &'a Port)>, Diagnostic> {
        let addresses: Vec<&str> = match self.document.inputs.get(name) {
            Some(input) => input.ports.iter().map(String::as_str).collect(),
            None if name.contains('.') => vec![name],
            None => return Err(no_input(&self.document, name)),
        };
        addresses.into_iter().map(|address| self.place(address)).collect()
    }

    fn place<'a>(&'a self, address: &'a str) -> Result<(&'a str, &'a str, &'a Port), Diagnostic> {
        let Some((id, port_name)) = split_port(address) else {
            return Err(Diagnostic::error("bad-address", format!("\"{address}\" is not of the form node.port")));
        };
        let Some(node) = self.document.nodes.get(id) else {
            let hint = did_you_mean(id, self.document.nodes.keys().take(10_000).map(String::as_str));
            let message = format!("there is no node \"{id}\"");
            return Err(Diagnostic::error("unknown-name", message).maybe_hint(hint));
        };
        let Some(port) = self.document.input_port(&self.registry, address) else {
            let t = self.registry.get(&node.type_name);
            if t.is_none() && node.cluster().is_none() {
                let message = format!("the type of node \"{id}\" is not known");
                return Err(Diagnostic::error("unknown-node", message).at(id));
            }
            let hint = t.and_then(|t| did_you_mean(port_name, t.inputs().iter().map(|p| p.name())));
            let message = format!("\"{}\" has no input \"{port_name}\"", node.type_name);
            return Err(Diagnostic::error("unknown-port", message).at(id).port(port_name).maybe_hint(hint));
        };
        if node.inputs.get(port_name).is_some_and(|wires| !wires.from.is_empty()) {
            let message = format!("{address} has a wire, which overrules a value");
            return Err(Diagnostic::error("wired-input", message).at(id).port(port_name));
        }
        Ok((id, port_name, port))
    }
}
