//! Where every field of every struct of `tenon.h` lies: a change breaks hosts that were built.
//! `TENON_WRITE_HEADERS=1 cargo test -p tenon-capi` writes the snapshot anew; only lines at a struct's end may be new.

use super::golden::{compare, measured, only_grew, same_elsewhere, worked_out};
use std::path::Path;

#[test]
fn structs_lie_as_they_did() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let out = measured(&["tenon.h"], &[&root.join("include"), &root.join("../plugin-sdk/include")]);
    assert!(out.lines().count() > 50, "{out}");
    compare(&root.join(format!("tests/layout-{}-{}.txt", std::env::consts::ARCH, std::env::consts::OS)), &out);
}

/// Every field of version 1.0 lies where it lay, and structs only grew. That file is never written anew.
#[test]
fn later_versions_only_grow() {
    let tests = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests");
    let older = only_grew(&tests.join("layout-1.0-x86_64-linux.txt"), &tests.join("layout-x86_64-linux.txt"));
    assert_eq!(older, 57);
}

/// The same where no test runs.
#[test]
fn structs_lie_the_same_on_other_targets() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folders = [root.join("include"), root.join("../plugin-sdk/include")];
    let layout = worked_out(&[folders[1].join("tenon_value.h")], &[folders[0].join("tenon.h")]);
    same_elsewhere(&layout, "tenon.h", &[&folders[0], &folders[1]], &root.join("tests"));
}
