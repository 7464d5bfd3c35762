//! `tenon plugin new`: the source of a plugin to begin with, made of the examples.

use crate::End;
use crate::args::PluginNewArgs;
use crate::words::{Wrong, print};
use std::path::Path;

const C: &str = include_str!("../../plugin-sdk/examples/fastener-c/hinge.c");
const RUST: &str = include_str!("../../plugin-sdk/examples/curve-rust/src/lib.rs");
const VALUE_HEADER: &str = include_str!("../../plugin-sdk/include/tenon_value.h");
const PLUGIN_HEADER: &str = include_str!("../../plugin-sdk/include/tenon_plugin.h");

/// Writes the folder; nothing that is there is touched.
pub fn new(args: &PluginNewArgs) -> Result<End, Wrong> {
    let name = &args.name;
    let good = name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_');
    if !good || !name.starts_with(|c: char| c.is_ascii_lowercase()) {
        let message = format!("\"{name}\" cannot be a plugin's id");
        return Err(
            Wrong::new("bad-name", message).hint("lower case letters, digits and _, a letter first: acme_hinges")
        );
    }
    let files: Vec<(String, String)> = if args.c {
        let build = format!("cc -std=c11 -shared -fPIC {name}.c -o {name}.so -lm");
        vec![
            (format!("{name}.c"), C.replace("\"hinges", &format!("\"{name}"))),
            ("tenon_value.h".into(), VALUE_HEADER.into()),
            ("tenon_plugin.h".into(), PLUGIN_HEADER.into()),
            ("README.md".into(), readme(name, &build, &format!("{name}.so"))),
        ]
    } else {
        let library = format!("target/release/lib{name}.so");
        let manifest = format!(
            "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n\
             [dependencies]\n# The folder plugin-sdk of Tenon's source.\ntenon-plugin = {{ path = \"../plugin-sdk\" }}\n\n\
             [workspace]\n"
        );
        let source = RUST.replace("\"curves", &format!("\"{name}")).replace("See README.md.", "");
        vec![
            ("Cargo.toml".into(), manifest),
            ("src/lib.rs".into(), source),
            ("README.md".into(), readme(name, "cargo build --release", &library)),
        ]
    };
    let folder = Path::new(name);
    if folder.exists() {
        return Err(Wrong::new("exists", format!("{name} is there already")));
    }
    let unwritable = |e: std::io::Error| Wrong::new("unwritable", format!("{name}: {e}"));
    for (file, text) in &files {
        let place = folder.join(file);
        std::fs::create_dir_all(place.parent().unwrap_or(folder)).map_err(unwritable)?;
        std::fs::write(place, text).map_err(unwritable)?;
    }
    print(&format!("made {name}/: {name}/README.md says how to go on\n"))?;
    Ok(End::Done)
}

fn readme(name: &str, build: &str, library: &str) -> String {
    format!(
        "# {name}\n\nA plugin of Tenon. Build it, look at it, test it:\n\n    {build}\n    tenon plugin info ./{library}\n    \
         tenon plugin check ./{library}\n\nUse it in a graph with `--plugin ./{library}`, or put the library into the folder \
         that `tenon plugin\nlist` names. Change the description and the function in the source, and raise the node's \
         version\nwhenever the same inputs begin to give other outputs.\n"
    )
}
