//! Inputs and outputs of the graph, or of the cluster that is worked on, as a person sets them: names, ends, units, words, order.

use super::Model;
use tenon_engine::{Diagnostic, InterfaceInput, InterfaceOutput, Operation};

impl Model {
    fn cluster_here(&self) -> Option<&str> {
        self.trail().last().map(|e| e.cluster.as_str())
    }

    /// Gives an input of the interface another name; formulas and instances follow.
    ///
    /// # Errors
    /// If the name is taken or cannot be one.
    pub fn rename_input(&mut self, from: &str, to: &str) -> Result<(), Diagnostic> {
        let operation = self.whole().rename_input(self.cluster_here(), from, to, &self.registry)?;
        self.check_inside(&operation)?;
        self.apply_to_whole(operation)
    }

    /// Gives an output of the interface another name; instances follow.
    ///
    /// # Errors
    /// If the name is taken or cannot be one.
    pub fn rename_output(&mut self, from: &str, to: &str) -> Result<(), Diagnostic> {
        let operation = self.whole().rename_output(self.cluster_here(), from, to)?;
        self.check_inside(&operation)?;
        self.apply_to_whole(operation)
    }

    /// Changes what is said of an input of the interface; false if that is refused.
    pub fn change_input(&mut self, name: &str, change: impl FnOnce(&mut InterfaceInput)) -> bool {
        let Some(mut input) = self.document().inputs.get(name).cloned() else { return false };
        change(&mut input);
        self.edit(Operation::SetInput { name: name.to_owned(), input: Some(input) })
    }

    /// Changes what is said of an output of the interface; false if that is refused.
    pub fn change_output(&mut self, name: &str, change: impl FnOnce(&mut InterfaceOutput)) -> bool {
        let Some(mut output) = self.document().outputs.get(name).cloned() else { return false };
        change(&mut output);
        self.edit(Operation::SetOutput { name: name.to_owned(), output: Some(output) })
    }

    /// Moves an input of the interface before the one above it.
    pub fn raise_input(&mut self, name: &str) {
        let all = self.document().inputs_in_order();
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        let set = raised(&names, name).into_iter().filter_map(|(order, name)| {
            let mut input = self.document().inputs.get(&name)?.clone();
            let changes = input.order.replace(order) != Some(order);
            changes.then_some(Operation::SetInput { name, input: Some(input) })
        });
        let set: Vec<Operation> = set.collect();
        self.edit(Operation::All(set));
    }

    /// Moves an output of the interface before the one above it.
    pub fn raise_output(&mut self, name: &str) {
        let all = self.document().outputs_in_order();
        let names: Vec<&str> = all.iter().map(|(name, _)| *name).collect();
        let set = raised(&names, name).into_iter().filter_map(|(order, name)| {
            let mut output = self.document().outputs.get(&name)?.clone();
            let changes = output.order.replace(order) != Some(order);
            changes.then_some(Operation::SetOutput { name, output: Some(output) })
        });
        let set: Vec<Operation> = set.collect();
        self.edit(Operation::All(set));
    }
}

/// Places of all names after one has gone up by one.
fn raised(names: &[&str], name: &str) -> Vec<(i64, String)> {
    let mut names: Vec<String> = names.iter().map(|n| (*n).to_owned()).collect();
    if let Some(i) = names.iter().position(|n| n == name).filter(|i| *i > 0) {
        names.swap(i - 1, i);
    }
    (0i64..).zip(names).collect()
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn the_first_stays_and_others_go_up() {
        let names = |up| raised(&["a", "b", "c"], up).into_iter().map(|(_, n)| n).collect::<Vec<_>>();
        assert_eq!(names("a"), ["a", "b", "c"]);
        assert_eq!(names("c"), ["a", "c", "b"]);
    }
}
