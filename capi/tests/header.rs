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
    // cbindgen follows the modules of `lib.rs` from there.
    let builder = cbindgen::Builder::new().with_config(config).with_src(root.join("src/lib.rs"));
    let mut out = Vec::new();
    builder.generate().unwrap().write(&mut out);
    String::from_utf8(out).unwrap()
}

#[test]
fn the_header_is_what_the_source_says() {
    super::golden::compare(&Path::new(env!("CARGO_MANIFEST_DIR")).join("include/tenon.h"), &header());
}

#[test]
fn every_function_is_declared_once_and_says_which_threads_may_call_it() {
    let text = header();
    let mut seen = std::collections::BTreeSet::new();
    let mut comment = String::new();
    let mut failing = 0;
    for line in text.lines() {
        if let Some(words) = line.strip_prefix("// ") {
            comment = format!("{comment}{words} ");
            continue;
        }
        // A declaration begins at the left and has its name before the first parenthesis.
        let name = line.split_once('(').filter(|_| !line.starts_with(' ')).map(|(before, _)| before);
        if let Some(name) = name.and_then(|n| n.rsplit([' ', '*']).next()).filter(|n| n.starts_with("tenon_")) {
            assert!(seen.insert(name.to_owned()), "{name} is declared twice");
            let fails = line.starts_with("struct tenon_error *");
            // Who says that it is the same as another fails as that does.
            let told = comment.contains("Fails if") || comment.contains("Fails, ") || comment.contains("Fails as");
            assert!(!fails || told, "{name} does not say when it fails: {comment}");
            failing += u32::from(fails);
            assert!(comment.contains(" thread"), "{name} does not say which thread may call it: {comment}");
        }
        comment.clear();
    }
    assert!(failing > 15, "only {failing} functions that can fail were found");
    assert!(seen.len() > 30, "only {} functions were found", seen.len());
}
