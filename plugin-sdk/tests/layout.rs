//! Where fields lie on systems that no test runs on: worked out from the headers, held to what the compiler says here, and,
//! where there is clang, to what it says for each target.

use super::golden::{same_elsewhere, worked_out};
use std::path::Path;

#[test]
fn the_layout_of_other_targets_is_what_was_frozen() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let include = root.join("include");
    let layout = worked_out(&[], &["tenon_value.h", "tenon_plugin.h"].map(|name| include.join(name)));
    same_elsewhere(&layout, "tenon_plugin.h", &[&include], &root.join("tests"));
}
