//! The plugin SDK as it is installed: sources and examples, and a manifest that needs no workspace around it.

use crate::dist::{copy_all, write};
use crate::root;
use std::fs;
use std::path::Path;

/// Lays the SDK out in `place`.
pub fn lay_out(place: &Path) -> Result<(), String> {
    let from = root().join("plugin-sdk");
    for folder in ["src", "include", "examples"] {
        copy_all(&from.join(folder), &place.join(folder))?;
    }
    let read = |file: &Path| fs::read_to_string(file).map_err(|e| format!("{}: {e}", file.display()));
    let manifest = alone(&read(&from.join("Cargo.toml"))?, &read(&root().join("Cargo.toml"))?)?;
    write(&place.join("Cargo.toml"), &manifest)
}

/// A member's manifest with everything in it that it takes from its workspace, and without its tests. It is the workspace of
/// the examples.
fn alone(member: &str, workspace: &str) -> Result<String, String> {
    let mut out = String::new();
    let (mut table, mut kept) = ("", true);
    for line in member.lines() {
        if let Some(name) = line.strip_prefix('[') {
            table = name.trim_matches(['[', ']']);
            kept = !matches!(table, "test" | "dev-dependencies");
        }
        if !kept || line.starts_with("autotests") || line == TESTS {
            continue;
        }
        out += &match line.split_once(" = ") {
            Some((key, value)) if line.contains("workspace = true") => {
                let key = key.trim_end_matches(".workspace");
                let from = if table == "package" { "[workspace.package]" } else { "[workspace.dependencies]" };
                merged(key, value, said(workspace, from, key)?)
            }
            _ => line.to_owned(),
        };
        out.push('\n');
    }
    Ok(out.trim_end().to_owned() + "\n\n[workspace]\nresolver = \"3\"\nmembers = [\"examples/*-rust\"]\n")
}

/// The remark over what is left out.
const TESTS: &str = "# One test binary with a module per subject: links once.";

/// What a table of the workspace's manifest says of a key.
fn said<'a>(workspace: &'a str, table: &str, key: &str) -> Result<&'a str, String> {
    let of_table =
        workspace.lines().skip_while(|line| *line != table).skip(1).take_while(|line| !line.starts_with('['));
    let found = of_table.filter_map(|line| line.split_once(" = ")).find(|(name, _)| *name == key);
    found.map(|(_, value)| value).ok_or_else(|| format!("{table} says nothing of {key}"))
}

/// A key's line: what the workspace says of it, and what the member says besides.
fn merged(key: &str, member: &str, workspace: &str) -> String {
    let inside = |text: &str| text.trim_start_matches('{').trim_end_matches('}').trim().to_owned();
    let more: Vec<String> = match member.starts_with('{') {
        true => inside(member).split(", ").filter(|part| *part != "workspace = true").map(str::to_owned).collect(),
        false => Vec::new(),
    };
    if more.is_empty() {
        return format!("{key} = {workspace}");
    }
    let first = if workspace.starts_with('{') { inside(workspace) } else { format!("version = {workspace}") };
    format!("{key} = {{ {first}, {} }}", more.join(", "))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn a_manifest_stands_alone() {
        let workspace = "[workspace.package]\nversion = \"0.1.0\"\n\n[workspace.dependencies]\n# Words.\nlibc = \"0.2\"\n\
                         glam = { version = \"1\", features = [\"std\", \"f64\"] }\n\n[profile.dev]\nversion = \"9\"\n";
        let member = "[package]\nname = \"it\"\nversion.workspace = true\nautotests = false\n\n[[test]]\nname = \"main\"\n\n\
                      [dependencies]\nlibc = { workspace = true, optional = true }\nglam.workspace = true\n\n\
                      [dev-dependencies]\nlibc.workspace = true\n";
        let made = "[package]\nname = \"it\"\nversion = \"0.1.0\"\n\n[dependencies]\nlibc = { version = \"0.2\", optional = true }\n\
                    glam = { version = \"1\", features = [\"std\", \"f64\"] }\n\n[workspace]\nresolver = \"3\"\n\
                    members = [\"examples/*-rust\"]\n";
        assert_eq!(alone(member, workspace).unwrap(), made);
        assert!(alone("[dependencies]\nserde.workspace = true\n", workspace).unwrap_err().contains("nothing of serde"));
    }

    #[test]
    fn the_sdk_takes_nothing_from_its_workspace() {
        let read = |name: &str| fs::read_to_string(root().join(name)).unwrap();
        let made = alone(&read("plugin-sdk/Cargo.toml"), &read("Cargo.toml")).unwrap();
        assert!(!made.contains("workspace = true") && !made.contains("cbindgen"), "{made}");
        for line in ["edition = \"2024\"", "thiserror = \"2\"", "libloading = { version = \"0.9\", optional = true }"] {
            assert!(made.lines().any(|l| l == line), "{line}:\n{made}");
        }
    }
}
