//! What fuzzers hold the readers of foreign bytes to: one file per target, each with one function that takes any bytes and
//! panics if a promise is broken. The ordinary tests replay `corpus/` through the same functions.

pub mod bytes;
pub mod document;
pub mod expression;
pub mod machine;
pub mod mesh;
pub mod nodes;
pub mod operations;
pub mod program;

use std::sync::{Arc, LazyLock};
use tenon_engine::{Registry, Report};

/// A check: takes any bytes, panics if a promise is broken.
pub type Check = fn(&[u8]);

/// Every target by the name of its folder under `corpus/`.
pub const TARGETS: [(&str, Check); 7] = [
    ("document", document::check),
    ("expression", expression::check),
    ("operations", operations::check),
    ("nodes", nodes::check),
    ("program", program::check),
    ("mesh", mesh::check),
    ("machine", machine::check),
];

/// Every built-in node, registered once.
pub fn registry() -> &'static Arc<Registry> {
    static REGISTRY: LazyLock<Arc<Registry>> = LazyLock::new(|| Arc::new(tenon_nodes::registry()));
    &REGISTRY
}

/// Refuses diagnostics that only a fault of ours can cause.
fn check_report(report: &Report) {
    for d in &report.diagnostics {
        assert!(!matches!(&*d.code, "panic" | "node-bug" | "engine-fault" | "gave-up"), "{d}");
        assert!(!d.message.is_empty(), "{d:?}");
    }
}
