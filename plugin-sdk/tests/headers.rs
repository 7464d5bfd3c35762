//! The C headers say what the Rust source says. `TENON_WRITE_HEADERS=1 cargo test -p tenon-plugin` writes them anew.

use super::golden::{compare, measured, only_grew};
use std::path::Path;

/// One header from one source file.
fn header(source: &str, name: &str, about: &str, includes: &[&str]) -> String {
    let mut config = cbindgen::Config {
        language: cbindgen::Language::C,
        cpp_compat: true,
        usize_is_size_t: true,
        no_includes: true,
        sys_includes: ["stdbool.h", "stdint.h"].map(str::to_owned).to_vec(),
        includes: includes.iter().map(|i| (*i).to_owned()).collect(),
        include_guard: Some(format!("{}_H", name.to_uppercase())),
        documentation_style: cbindgen::DocumentationStyle::C99,
        style: cbindgen::Style::Both,
        header: Some(format!("// {about}\n// Generated from the Rust source; do not edit.")),
        after_includes: (name == "tenon_plugin").then(|| ENTRY.to_owned()),
        line_length: 110,
        ..cbindgen::Config::default()
    };
    // Structs that no function of this file names are still part of the contract.
    let text = std::fs::read_to_string(root().join(source)).unwrap();
    let named = |line: &str| {
        line.strip_prefix("pub struct ").map(|rest| rest.split([' ', '<', '(']).next().unwrap().to_owned())
    };
    config.export.include = text.lines().filter_map(named).collect();
    let aliases =
        text.lines().filter_map(|l| l.strip_prefix("pub type ")).map(|l| l.split(' ').next().unwrap().to_owned());
    config.export.include.extend(aliases);
    let bindings = cbindgen::Builder::new().with_config(config).with_src(root().join(source)).generate().unwrap();
    let mut out = Vec::new();
    bindings.write(&mut out);
    let out = String::from_utf8(out).unwrap();
    let trailer = if name == "tenon_plugin" { SYMBOL } else { "" };
    let (declarations, guard) = out.split_at(out.rfind("#endif").unwrap());
    format!("{declarations}{trailer}{guard}")
}

/// What a plugin defines, which cbindgen cannot know.
const ENTRY: &str = r#"
#if defined(_WIN32)
#define TENON_EXPORT __declspec(dllexport)
#else
#define TENON_EXPORT __attribute__((visibility("default")))
#endif
"#;

/// The symbol, for the linker the same in C and in C++.
const SYMBOL: &str = r#"#ifdef __cplusplus
extern "C" {
#endif

// The one symbol that a plugin exports and defines; see `tenon_plugin_entry`. [any thread]
TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);

#ifdef __cplusplus
}
#endif

"#;

fn root() -> &'static Path {
    Path::new(env!("CARGO_MANIFEST_DIR"))
}

#[test]
fn the_header_of_values_is_what_the_source_says() {
    let about = "Values of Tenon as they cross to plugins and hosts. Lengths are mm, angles radians.";
    compare(&root().join("include/tenon_value.h"), &header("src/abi/value.rs", "tenon_value", about, &[]));
}

#[test]
fn the_header_of_plugins_is_what_the_source_says() {
    let about = include_str!("plugin_header.txt").trim_end();
    compare(
        &root().join("include/tenon_plugin.h"),
        &header("src/abi/plugin.rs", "tenon_plugin", about, &["tenon_value.h"]),
    );
}

#[test]
fn the_headers_are_strict_c11_and_cpp17() {
    for name in ["tenon_value.h", "tenon_plugin.h"] {
        for (compiler, language, standard) in [("cc", "c", "-std=c11"), ("c++", "c++", "-std=c++17")] {
            let done = std::process::Command::new(compiler)
                .args([standard, "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-x", language])
                .arg(root().join("include").join(name))
                .output()
                .unwrap();
            assert!(done.status.success(), "{name}, {compiler}: {}", String::from_utf8_lossy(&done.stderr));
        }
    }
}

/// Function pointers of the header with the comments before them.
fn functions(header: &str) -> Vec<(String, String)> {
    let (mut all, mut comment) = (Vec::new(), String::new());
    for line in header.lines().map(str::trim) {
        if let Some(words) = line.strip_prefix("//") {
            comment = format!("{comment}{words}");
            continue;
        }
        if let Some((_, rest)) = line.split_once("(*") {
            all.push((rest.split(')').next().unwrap().to_owned(), std::mem::take(&mut comment)));
        }
        comment.clear();
    }
    all
}

#[test]
fn every_function_says_which_thread_may_call_it() {
    let functions = functions(&std::fs::read_to_string(root().join("include/tenon_plugin.h")).unwrap());
    let names: Vec<&str> = functions.iter().map(|f| f.0.as_str()).collect();
    let all = ["cancelled", "progress", "tell", "buffer", "set", "forward", "tenon_give", "evaluate", "migrate"];
    assert!(all.iter().chain(&["tenon_plugin_entry"]).all(|f| names.contains(f)), "{names:?}");
    assert_eq!(names.len(), all.len() + 1, "{names:?}");
    for (name, comment) in &functions {
        let tags = ["[any thread]", "[any thread while evaluate runs]", "[thread of evaluate]"];
        let known =
            tags.iter().any(|tag| comment.contains(tag)) || comment.contains("[thread of migrate, while it runs]");
        assert!(known, "{name} does not say which thread may call it: {comment}");
    }
}

/// Every field of version 1.0 lies where it lay, and structs only grew. That file is never written anew.
#[test]
fn later_versions_only_grow() {
    let tests = root().join("tests");
    let fields = only_grew(&tests.join("layout-1.0-x86_64-linux.txt"), &tests.join("layout-x86_64-linux.txt"));
    assert!(fields > 100, "{fields}");
}

/// Where every field of every struct of the contract lies. A change here breaks every plugin and host that was built.
#[test]
fn the_layout_is_what_was_frozen() {
    let out = measured(&["tenon_value.h", "tenon_plugin.h"], &[&root().join("include")]);
    assert!(out.lines().count() > 100, "{out}");
    compare(&root().join(format!("tests/layout-{}-{}.txt", std::env::consts::ARCH, std::env::consts::OS)), &out);
}

/// A plugin in C++17 as the header alone makes it: the symbol is plain, and its constants are good in C++ too.
#[test]
#[cfg(all(unix, feature = "host"))]
fn a_plugin_in_cpp17_is_compiled_and_loaded() {
    const SOURCE: &str = r#"
#include "tenon_plugin.h"
#include <new>

static_assert(TENON_NONE == 0xFFFFFFFFu && TENON_OPAQUE == 65536 && TENON_INTERNAL < 0, "constants");

static tenon_str text(const char *from) {
  uint64_t length = 0;
  while (from[length] != 0) ++length;
  return tenon_str{from, length};
}

static tenon_status evaluate(void *, const tenon_call *call, const tenon_tree *, uint32_t) noexcept {
  try {
    auto *number = static_cast<double *>(call->buffer(call, TENON_F64, 1));
    if (number == nullptr) return TENON_NO_MEMORY;
    *number = 7;
    tenon_column column{};
    column.size = sizeof column;
    column.kind = TENON_NUMBER;
    column.items = number;
    column.count = 1;
    column.stride = sizeof *number;
    tenon_branch branch{nullptr, 0, column};
    tenon_tree tree{sizeof tree, sizeof branch, &branch, 1};
    return call->set(call, 0, &tree);
  } catch (const std::bad_alloc &) {
    return TENON_NO_MEMORY;
  }
}

const tenon_plugin *tenon_plugin_v1() {
  static tenon_port output{};
  output.size = sizeof output;
  output.kind = TENON_NUMBER;
  output.access = TENON_ITEM;
  output.name = text("seven");
  output.doc = text("The number seven.");
  static tenon_node_type node{};
  node.size = sizeof node;
  node.flags = TENON_PURE;
  node.id = text("modern.seven");
  node.version = 1;
  node.outputs = &output;
  node.output_count = 1;
  node.port_stride = sizeof output;
  node.name = text("Seven");
  node.category = text("Numbers");
  node.doc = text("Gives seven.");
  node.evaluate = evaluate;
  static tenon_plugin plugin{};
  plugin.magic = TENON_PLUGIN_MAGIC;
  plugin.size = sizeof plugin;
  plugin.abi_major = TENON_PLUGIN_MAJOR;
  plugin.abi_minor = TENON_PLUGIN_MINOR;
  plugin.id = text("modern");
  plugin.version = text("1.0.0");
  plugin.nodes = &node;
  plugin.node_count = 1;
  plugin.node_stride = sizeof node;
  return &plugin;
}
"#;
    let folder = Path::new(env!("CARGO_TARGET_TMPDIR"));
    let (source, library) =
        (folder.join("modern.cpp"), folder.join("modern").with_extension(std::env::consts::DLL_EXTENSION));
    std::fs::write(&source, SOURCE).unwrap();
    let done = std::process::Command::new("c++")
        .args([
            "-std=c++17",
            "-Wall",
            "-Wextra",
            "-Wpedantic",
            "-Werror",
            "-shared",
            "-fPIC",
            "-fvisibility=hidden",
            "-I",
        ])
        .arg(root().join("include"))
        .arg(&source)
        .arg("-o")
        .arg(&library)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
    let plugin = tenon_plugin::load::Plugin::load(&library).unwrap();
    assert_eq!((&*plugin.id, &*plugin.nodes[0].id), ("modern", "modern.seven"));
}

/// What is a macro of the header is good in C++ too: a compound literal, say, is not.
#[test]
fn every_constant_of_the_headers_can_be_used_in_cpp17() {
    let mut program = String::from("#include \"tenon_plugin.h\"\n");
    let mut count = 0;
    for name in ["tenon_value.h", "tenon_plugin.h"] {
        for line in std::fs::read_to_string(root().join("include").join(name)).unwrap().lines() {
            let constant = line.strip_prefix("#define ").and_then(|rest| rest.split_once(' '));
            if let Some((constant, _)) = constant.filter(|(constant, _)| *constant != "TENON_EXPORT") {
                program += &format!("static const auto use_{count} = {constant};\n");
                program += &format!("void take_{count}();\nvoid take_{count}() {{ (void)use_{count}; }}\n");
                count += 1;
            }
        }
    }
    assert!(count > 50, "{count}");
    let source = Path::new(env!("CARGO_TARGET_TMPDIR")).join("constants.cpp");
    std::fs::write(&source, program).unwrap();
    let done = std::process::Command::new("c++")
        .args(["-std=c++17", "-Wall", "-Wextra", "-Wpedantic", "-Werror", "-fsyntax-only", "-I"])
        .arg(root().join("include"))
        .arg(&source)
        .output()
        .unwrap();
    assert!(done.status.success(), "{}", String::from_utf8_lossy(&done.stderr));
}

/// The book says what the version of the header brought.
#[test]
fn the_newest_version_in_the_book_is_that_of_the_header() {
    let book = std::fs::read_to_string(root().join("../docs/plugins.md")).unwrap();
    let rows = book.lines().skip_while(|line| *line != "| version | what is new |").skip(2);
    let newest = rows.take_while(|line| line.starts_with('|')).last().unwrap().split('|').nth(1).unwrap().trim();
    let header = std::fs::read_to_string(root().join("include/tenon_plugin.h")).unwrap();
    let number = |name: &str| {
        let define = format!("#define TENON_PLUGIN_{name} ");
        header.lines().find_map(|line| line.strip_prefix(&define)).unwrap().to_owned()
    };
    assert_eq!(newest, format!("{}.{}", number("MAJOR"), number("MINOR")));
}
