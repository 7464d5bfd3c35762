//! Where every field of every struct of `tenon.h` lies: a change breaks hosts that were built.
//! `TENON_WRITE_HEADERS=1 cargo test -p tenon-capi` writes the snapshot anew; only lines at a struct's end may be new.

use std::collections::BTreeMap;
use std::path::Path;
use std::process::Command;

/// A program that prints sizes and offsets of all structs of a header.
fn program(header: &str) -> String {
    let mut program = String::from("#include <stddef.h>\n#include <stdio.h>\n#include \"tenon.h\"\nint main(void) {\n");
    let mut name = String::new();
    for line in header.lines().map(str::trim) {
        if let Some(rest) = line.strip_prefix("typedef struct ").and_then(|rest| rest.strip_suffix(" {")) {
            name = rest.to_owned();
            program += &format!("printf(\"{name} %zu\\n\", sizeof({name}));\n");
        } else if line.starts_with('}') {
            name.clear();
        } else if !name.is_empty() && !line.starts_with("//") && line.ends_with(';') {
            let field = match line.split_once("(*") {
                Some((_, rest)) => rest.split(')').next().unwrap(),
                None => line.trim_end_matches(';').rsplit([' ', '*']).next().unwrap(),
            };
            program += &format!("printf(\"  {field} %zu\\n\", offsetof({name}, {field}));\n");
        }
    }
    program + "return 0; }\n"
}

#[test]
fn structs_lie_as_they_did() {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (source, binary) = (folder.join("layout.c"), folder.join("layout"));
    std::fs::write(&source, program(&std::fs::read_to_string(root.join("include/tenon.h")).unwrap())).unwrap();
    let mut compiler = Command::new("cc");
    compiler.arg("-I").arg(root.join("include")).arg("-I").arg(root.join("../plugin-sdk/include"));
    let done = compiler.arg(&source).arg("-o").arg(&binary).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let out = String::from_utf8(Command::new(&binary).output().unwrap().stdout).unwrap();
    assert!(out.lines().count() > 50, "{out}");
    let place = root.join(format!("tests/layout-{}-{}.txt", std::env::consts::ARCH, std::env::consts::OS));
    if std::env::var_os("TENON_WRITE_HEADERS").is_some() {
        std::fs::write(&place, &out).unwrap();
    }
    let there = std::fs::read_to_string(&place).unwrap_or_default();
    assert!(there == out, "{} is not what the header says:\n{out}", place.display());
}

/// Every field of version 1.0 lies where it lay, and structs only grew. That file is never written anew.
#[test]
fn later_versions_only_grow() {
    let read = |name: &str| {
        let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("tests").join(name);
        std::fs::read_to_string(&place).unwrap()
    };
    let fields = |text: &str| {
        let (mut all, mut name) = (BTreeMap::new(), String::new());
        for line in text.lines() {
            let (what, number) = line.trim().split_once(' ').unwrap();
            if !line.starts_with(' ') {
                name = what.to_owned();
            }
            all.insert((name.clone(), line.starts_with(' ').then(|| what.to_owned())), number.parse::<u64>().unwrap());
        }
        all
    };
    let (first, today) = (fields(&read("layout-1.0-x86_64-linux.txt")), fields(&read("layout-x86_64-linux.txt")));
    assert_eq!(first.len(), 57);
    for ((name, field), was) in first {
        let is = today[&(name.clone(), field.clone())];
        assert!(if field.is_some() { is == was } else { is >= was }, "{name} {field:?}: {was} became {is}");
    }
}
