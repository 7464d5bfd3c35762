//! Looking at what stands at an input: the value that its node would see.

use super::gather;
use super::session::Session;
use crate::diagnostic::{Diagnostic, Severity};
use crate::value::Tree;

impl Session {
    /// The outputs (`node.port`) that must be evaluated before [`Session::input`] can tell the value at the input
    /// `name` (`node.port` or an interface input); none where a literal or a default stands.
    ///
    /// # Errors
    /// If there is no such input; says which name comes nearest.
    pub fn sources(&self, name: &str) -> Result<Vec<String>, Diagnostic> {
        let (n, p) = self.find_port(name)?;
        let slot = self.plan.slot(n, p);
        let address = |slot: &u32| {
            let node = self.plan.output_node[*slot as usize] as usize;
            let port = (*slot - self.plan.nodes[node].outputs) as usize;
            let name = self.plan.node_type(node).and_then(|t| t.outputs.get(port)).map_or("", |p| p.name());
            format!("{}.{name}", &self.plan.ids[node])
        };
        Ok(self.plan.wires(&slot).0.iter().map(address).collect())
    }

    /// `node.port` of everything that writers give, in order of nodes; those inside clusters too.
    #[must_use]
    pub fn writers(&self) -> Vec<String> {
        let writers =
            (0..self.plan.nodes.len()).filter_map(|n| Some((n, self.plan.node_type(n)?))).filter(|(_, t)| t.writer);
        writers
            .flat_map(|(n, t)| t.outputs.iter().map(move |p| format!("{}.{}", &self.plan.ids[n], p.name())))
            .collect()
    }

    /// The value that the node would see at the input `name`: wires joined, converted and shaped, else the literal,
    /// else the default. `None` if the port has none of them, or if one of its sources has no value.
    ///
    /// # Errors
    /// If there is no such input, or what arrives cannot be turned into what the port takes.
    pub fn input(&self, name: &str) -> Result<Option<Tree>, Diagnostic> {
        let (n, p) = self.find_port(name)?;
        if self.plan.wires(&self.plan.slot(n, p)).0.iter().any(|s| self.values[*s as usize].tree().is_none()) {
            return Ok(None);
        }
        let tree = gather::tree(&self.plan, &self.registry, n, p, &self.values, &mut Vec::new());
        tree.map(|t| t.map(std::borrow::Cow::into_owned)).map_err(|fail| fail.at(Severity::Error, &self.plan.ids[n]))
    }

    /// Node and port of an input; an interface input stands for the first port that it is bound to.
    fn find_port(&self, name: &str) -> Result<(usize, usize), Diagnostic> {
        let bound = self.document.inputs.get(name).and_then(|input| input.ports.first());
        self.plan.find_input(bound.map_or(name, String::as_str))
    }
}

#[cfg(test)]
mod tests {
    use crate::*;
    use std::sync::Arc;

    #[test]
    fn an_input_shows_its_wire_its_literal_or_its_default() {
        let mut registry = Registry::new();
        let node = NodeType::new("double", 1)
            .input(Port::list::<f64>("x").default(3.0))
            .output(Port::list::<f64>("y"))
            .run(|call| {
                let twice: Vec<f64> = call.list::<f64>("x")?.iter().map(|v| 2.0 * v).collect();
                call.set_list("y", twice);
                Ok(())
            });
        registry.register(node).unwrap();
        let mut document = Document::new();
        document.insert("a", Node::new("double")).unwrap();
        document.insert("b", Node::new("double").param("x", 5.0)).unwrap();
        document.insert("c", Node::new("double").wire("x", "a.y").wire("x", "b.y")).unwrap();
        let mut session = Session::new(Arc::new(registry), document, Options::default());
        let number = |s: &Session, name| s.input(name).unwrap().map(|t| t.to_json()["branches"]["{0}"].clone());
        assert_eq!(number(&session, "a.x"), Some(serde_json::json!([3.0])));
        assert_eq!(number(&session, "b.x"), Some(serde_json::json!([5.0])));
        assert_eq!(number(&session, "c.x"), None);
        let sources = session.sources("c.x").unwrap();
        assert_eq!(sources, ["a.y", "b.y"]);
        session.evaluate(&["a.y", "b.y"], &Control::default());
        assert_eq!(number(&session, "c.x"), Some(serde_json::json!([6.0, 10.0])));
        assert!(session.input("c.z").is_err() && session.input("z").is_err());
    }
}
