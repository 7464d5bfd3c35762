//! What is wrong with a graph, before anything runs.

use super::model::Document;
use crate::diagnostic::Diagnostic;
use crate::plan::Plan;
use crate::registry::Registry;

impl Document {
    /// Everything that keeps the graph or parts of it from running: unknown nodes and ports, cycles by name, wires
    /// between types that do not fit, parameters that their port does not accept, inputs without value. O(nodes + wires).
    #[must_use]
    pub fn validate(&self, registry: &Registry) -> Vec<Diagnostic> {
        // What is judged is what would run: nodes of older versions after their migrations.
        let plan = if self.needs_migration(registry) {
            let mut document = self.clone();
            let told = document.migrate(registry);
            let mut plan = Plan::compile(&document, registry);
            plan.add(told);
            plan
        } else {
            Plan::compile(self, registry)
        };
        let mut all = plan.general.clone();
        for n in 0..plan.nodes.len() {
            all.extend(plan.errors(n).cloned());
            if plan.is_sound(n) {
                all.extend(plan.missing(n).map(|port| plan.missing_diagnostic(n, port)));
            }
        }
        all
    }
}
