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
    String::from_utf8(out).unwrap()
}

/// What a plugin defines, which cbindgen cannot know.
const ENTRY: &str = r#"
#if defined(_WIN32)
#define TENON_EXPORT __declspec(dllexport)
#else
#define TENON_EXPORT __attribute__((visibility("default")))
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
