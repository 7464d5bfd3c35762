//! `include/tenon.h` says what the Rust source says. `TENON_WRITE_HEADERS=1 cargo test -p tenon-capi` writes it anew.

use std::path::Path;

fn header() -> String {
    let root = Path::new(env!("CARGO_MANIFEST_DIR"));
    let config = cbindgen::Config {
        language: cbindgen::Language::C,
        cpp_compat: true,
        usize_is_size_t: true,
        no_includes: true,
        sys_includes: ["stdbool.h", "stdint.h"].map(str::to_owned).to_vec(),
        includes: vec!["tenon_value.h".to_owned()],
        include_guard: Some("TENON_H".to_owned()),
        documentation_style: cbindgen::DocumentationStyle::C99,
        style: cbindgen::Style::Both,
        header: Some(include_str!("header.txt").trim_end().to_owned()),
        line_length: 110,
        ..cbindgen::Config::default()
    };
    let mut builder = cbindgen::Builder::new().with_config(config);
    for file in ["error", "text", "engine", "graph", "result", "lib"] {
        builder = builder.with_src(root.join(format!("src/{file}.rs")));
    }
    let mut out = Vec::new();
    builder.generate().unwrap().write(&mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn the_header_is_what_the_source_says() {
    let place = Path::new(env!("CARGO_MANIFEST_DIR")).join("include/tenon.h");
    let text = header();
    if std::env::var_os("TENON_WRITE_HEADERS").is_some() {
        std::fs::write(&place, &text).unwrap();
    }
    let there = std::fs::read_to_string(&place).unwrap_or_default();
    assert!(
        there == text,
        "{} is not what the source says: TENON_WRITE_HEADERS=1 cargo test writes it",
        place.display()
    );
}
