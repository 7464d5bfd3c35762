//! Where fields lie on systems that no test runs on: worked out from the headers by the rules that all our targets share
//! (pointers of 8 bytes, every field at a multiple of its own alignment), held to what the compiler says here, and, where
//! there is clang, to what it says for each target.

use super::golden::{Line, compare, lines};
use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::Path;
use std::process::Command;

/// Our name of a target, and clang's.
const TARGETS: [(&str, &str); 4] = [
    ("aarch64-linux", "aarch64-unknown-linux-gnu"),
    ("aarch64-macos", "aarch64-apple-macos11"),
    ("x86_64-macos", "x86_64-apple-macos11"),
    ("x86_64-windows", "x86_64-pc-windows-msvc"),
];

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

/// Every struct and field as `tests/layout-*.txt` has them.
fn worked_out() -> String {
    let numbers =
        [("uint8_t", 1), ("uint32_t", 4), ("int32_t", 4), ("uint64_t", 8), ("int64_t", 8), ("double", 8), ("*", 8)];
    // Size and alignment by type.
    let mut types: BTreeMap<String, (u64, u64)> =
        numbers.iter().map(|(n, size)| ((*n).to_owned(), (*size, *size))).collect();
    let mut out = String::new();
    for header in ["tenon_value.h", "tenon_plugin.h"] {
        let text = std::fs::read_to_string(root().join("include").join(header)).unwrap();
        let (mut of, mut fields, mut end, mut most) = ("", String::new(), 0_u64, 1);
        for line in lines(&text) {
            match line {
                Line::Struct(name) => (of, fields, end, most) = (name, String::new(), 0, 1),
                Line::End => {
                    let size = end.next_multiple_of(most);
                    write!(out, "{of} {size}\n{fields}").unwrap();
                    types.insert(of.to_owned(), (size, most));
                }
                Line::Field(name, kind) => {
                    let (size, align) = *types.get(kind).unwrap_or_else(|| panic!("{of}.{name} is a {kind}"));
                    let at = end.next_multiple_of(align);
                    writeln!(fields, "  {name} {at}").unwrap();
                    (end, most) = (at + size, most.max(align));
                }
                Line::Other(line) => {
                    let alias = line.strip_prefix("typedef ").and_then(|r| r.strip_suffix(';')?.split_once(' '));
                    let known = alias.and_then(|(kind, name)| Some((name, *types.get(kind)?)));
                    types.extend(known.map(|(name, known)| (name.to_owned(), known)));
                }
            }
        }
    }
    out
}

/// The same as assertions for a compiler.
fn assertions(layout: &str) -> String {
    let (mut out, mut name) = (String::from("#include <stddef.h>\n#include \"tenon_plugin.h\"\n"), "");
    for line in layout.lines() {
        let (what, number) = line.trim().split_once(' ').unwrap();
        let place = if line.starts_with(' ') { format!("offsetof({name}, {what})") } else { format!("sizeof({what})") };
        name = if line.starts_with(' ') { name } else { what };
        writeln!(out, "_Static_assert({place} == {number}, \"{name} {what}\");").unwrap();
    }
    out
}

#[test]
fn the_layout_of_other_targets_is_what_was_frozen() {
    let layout = worked_out();
    // What the compiler says of this machine, which is one of those with the same rules.
    let here = std::fs::read_to_string(root().join("tests/layout-x86_64-linux.txt")).unwrap();
    assert_eq!(layout, here);
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join("layout-elsewhere.c");
    std::fs::write(&source, assertions(&layout)).unwrap();
    let accepts = |compiler: &str, more: &[&str]| {
        let mut command = Command::new(compiler);
        command.args(["-std=c11", "-ffreestanding", "-fsyntax-only", "-I"]).arg(root().join("include"));
        command.args(more).arg(&source).output()
    };
    let done = accepts("cc", &[]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    for (target, triple) in TARGETS {
        compare(&root().join(format!("tests/layout-{target}.txt")), &layout);
        if let Ok(done) = accepts("clang", &[&format!("--target={triple}")]) {
            assert!(done.status.success(), "{target}: {}", String::from_utf8_lossy(&done.stderr));
        }
    }
}
