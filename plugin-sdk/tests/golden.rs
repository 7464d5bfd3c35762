//! What the tests of all our headers share: files that are what the source says, and where the fields of structs lie.

use std::collections::BTreeMap;
use std::fmt::Write;
use std::path::{Path, PathBuf};
use std::process::Command;

/// Fails unless the file at `place` is `text`; with `TENON_WRITE_HEADERS` it is made so first.
#[track_caller]
pub fn compare(place: &Path, text: &str) {
    if std::env::var_os("TENON_WRITE_HEADERS").is_some() {
        std::fs::write(place, text).unwrap();
    }
    let there = std::fs::read_to_string(place).unwrap_or_default();
    assert!(
        there == text,
        "{} is not what the source says: TENON_WRITE_HEADERS=1 cargo test writes it",
        place.display()
    );
}

/// Name and type of a field, from its line in a header.
fn field(line: &str) -> Option<(&str, &str)> {
    if let Some((_, rest)) = line.split_once("(*") {
        return Some((rest.split(')').next()?, "*"));
    }
    // The end of a function pointer over several lines is none.
    let line = line.strip_suffix(';').filter(|line| !line.ends_with(')'))?;
    let (kind, name) = line.rsplit_once([' ', '*'])?;
    let pointer = line.contains('*');
    Some((name, if pointer { "*" } else { kind.trim_start_matches("struct ").trim() }))
}

/// A line of a header that tells of structs.
pub enum Line<'a> {
    /// A struct of that name begins.
    Struct(&'a str),
    /// It ends.
    End,
    /// A field of that name and type; pointers are of type `*`.
    Field(&'a str, &'a str),
    /// Anything outside of structs.
    Other(&'a str),
}

/// The lines of a header without its comments.
pub fn lines(header: &str) -> impl Iterator<Item = Line<'_>> {
    let mut inside = false;
    header.lines().map(str::trim).filter(|line| !line.starts_with("//")).filter_map(move |line| {
        if let Some(name) = line.strip_prefix("typedef struct ").and_then(|rest| rest.strip_suffix(" {")) {
            inside = true;
            Some(Line::Struct(name))
        } else if !inside {
            Some(Line::Other(line))
        } else if line.starts_with('}') {
            inside = false;
            Some(Line::End)
        } else {
            field(line).map(|(name, kind)| Line::Field(name, kind))
        }
    })
}

/// Where every field of every struct of some headers lies, as the compiler of this machine says: a line with its size for
/// each struct, and for each field one with its offset. They lie in `folders[0]`; others may be included from the rest.
#[track_caller]
pub fn measured(headers: &[&str], folders: &[&Path]) -> String {
    let mut program = String::from("#include <stddef.h>\n#include <stdio.h>\n");
    headers.iter().for_each(|name| program += &format!("#include \"{name}\"\n"));
    program += "int main(void) {\n";
    for header in headers {
        let mut of = "";
        let text = std::fs::read_to_string(folders[0].join(header)).unwrap();
        for line in lines(&text) {
            match line {
                Line::Struct(name) => {
                    of = name;
                    program += &format!("printf(\"{name} %zu\\n\", sizeof({name}));\n");
                }
                Line::Field(name, _) => {
                    program += &format!("printf(\"  {name} %zu\\n\", offsetof({of}, {name}));\n");
                }
                Line::End | Line::Other(_) => (),
            }
        }
    }
    program += "return 0; }\n";
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    // The folder is that of all test programs.
    let name = format!("layout-{}", headers[0]);
    let (source, binary) = (folder.join(format!("{name}.c")), folder.join(name));
    std::fs::write(&source, program).unwrap();
    let mut compiler = Command::new("cc");
    for folder in folders {
        compiler.arg("-I").arg(folder);
    }
    let done = compiler.arg(&source).arg("-o").arg(&binary).output().unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    String::from_utf8(Command::new(&binary).output().unwrap().stdout).unwrap()
}

/// Fails unless every field of an older layout lies in today's where it lay, and structs only grew. Gives how many lines the
/// older has.
#[track_caller]
pub fn only_grew(older: &Path, today: &Path) -> usize {
    let read = |place: &Path| {
        let (mut all, mut of) = (BTreeMap::new(), String::new());
        for line in std::fs::read_to_string(place).unwrap().lines() {
            let (what, number) = line.trim().split_once(' ').unwrap();
            if !line.starts_with(' ') {
                of = what.to_owned();
            }
            all.insert((of.clone(), line.starts_with(' ').then(|| what.to_owned())), number.parse::<u64>().unwrap());
        }
        all
    };
    let (older, today) = (read(older), read(today));
    for ((of, field), was) in &older {
        let is = &today[&(of.clone(), field.clone())];
        assert!(if field.is_some() { is == was } else { is >= was }, "{of} {field:?}: {was} became {is}");
    }
    older.len()
}

/// Our name of a target that no test runs on, and clang's.
pub const TARGETS: [(&str, &str); 4] = [
    ("aarch64-linux", "aarch64-unknown-linux-gnu"),
    ("aarch64-macos", "aarch64-apple-macos11"),
    ("x86_64-macos", "x86_64-apple-macos11"),
    ("x86_64-windows", "x86_64-pc-windows-msvc"),
];

/// Every struct and field of headers as [`measured`] has them, worked out by the rules that all our targets share: pointers
/// of 8 bytes, every field at a multiple of its own alignment. Those of `known`, which they include, are left out.
pub fn worked_out(known: &[PathBuf], headers: &[PathBuf]) -> String {
    let numbers = [
        ("uint8_t", 1),
        ("uint32_t", 4),
        ("int32_t", 4),
        ("uint64_t", 8),
        ("int64_t", 8),
        ("float", 4),
        ("double", 8),
        ("*", 8),
    ];
    // Size and alignment by type.
    let mut types: BTreeMap<String, (u64, u64)> =
        numbers.iter().map(|(n, size)| ((*n).to_owned(), (*size, *size))).collect();
    let mut out = String::new();
    for header in known.iter().chain(headers) {
        if header == &headers[0] {
            out.clear();
        }
        let text = std::fs::read_to_string(header).unwrap();
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
                    let function = line.split_once("(*").and_then(|(_, rest)| rest.split(')').next());
                    types.extend(function.map(|name| (name.to_owned(), (8, 8))));
                    let known = alias.and_then(|(kind, name)| Some((name, *types.get(kind)?)));
                    types.extend(known.map(|(name, known)| (name.to_owned(), known)));
                }
            }
        }
    }
    out
}

/// The same as assertions about a header, for a compiler.
fn assertions(layout: &str, header: &str) -> String {
    let (mut out, mut name) = (format!("#include <stddef.h>\n#include \"{header}\"\n"), "");
    for line in layout.lines() {
        let (what, number) = line.trim().split_once(' ').unwrap();
        let place = if line.starts_with(' ') { format!("offsetof({name}, {what})") } else { format!("sizeof({what})") };
        name = if line.starts_with(' ') { name } else { what };
        writeln!(out, "_Static_assert({place} == {number}, \"{name} {what}\");").unwrap();
    }
    out
}

/// Fails unless a layout that was worked out is what the compiler says here (`layout-x86_64-linux.txt` in `snapshots`), what
/// the snapshot of each other target says, and, where there is clang, what that says for each.
#[track_caller]
pub fn same_elsewhere(layout: &str, header: &str, folders: &[&Path], snapshots: &Path) {
    assert_eq!(layout, std::fs::read_to_string(snapshots.join("layout-x86_64-linux.txt")).unwrap());
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join(format!("layout-elsewhere-{header}.c"));
    std::fs::write(&source, assertions(layout, header)).unwrap();
    let accepts = |compiler: &str, more: &[String]| {
        let mut command = Command::new(compiler);
        command.args(["-std=c11", "-ffreestanding", "-fsyntax-only"]).args(more);
        for folder in folders {
            command.arg("-I").arg(folder);
        }
        command.arg(&source).output()
    };
    let done = accepts("cc", &[]).unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    for (target, triple) in TARGETS {
        compare(&snapshots.join(format!("layout-{target}.txt")), layout);
        if let Ok(done) = accepts("clang", &[format!("--target={triple}")]) {
            assert!(done.status.success(), "{target}: {}", String::from_utf8_lossy(&done.stderr));
        }
    }
}
