//! `tenon plugin new`: the source of a plugin to begin with, made of the examples.

use crate::End;
use crate::args::PluginNewArgs;
use crate::words::{Wrong, print};
use std::env::consts::{DLL_EXTENSION, DLL_PREFIX, DLL_SUFFIX};
use std::path::{Path, PathBuf};
use tenon_engine::Json;

const VALUE_HEADER: &str = include_str!("../../plugin-sdk/include/tenon_value.h");
const PLUGIN_HEADER: &str = include_str!("../../plugin-sdk/include/tenon_plugin.h");

/// What a new plugin is made of.
struct Example {
    /// Its id, which the new one's takes the place of.
    id: &'static str,
    source: &'static str,
    /// From its second headline on it is the new one's too, there called `acme`.
    readme: &'static str,
}

const C: Example = Example {
    id: "hinges",
    source: include_str!("../../plugin-sdk/examples/fastener-c/hinge.c"),
    readme: include_str!("../../plugin-sdk/examples/fastener-c/README.md"),
};
const FASTENER: Example = Example {
    id: "cams",
    source: include_str!("../../plugin-sdk/examples/fastener-rust/src/lib.rs"),
    readme: include_str!("../../plugin-sdk/examples/fastener-rust/README.md"),
};
const CURVE: Example = Example {
    id: "curves",
    source: include_str!("../../plugin-sdk/examples/curve-rust/src/lib.rs"),
    readme: include_str!("../../plugin-sdk/examples/curve-rust/README.md"),
};

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
        let library = format!("{name}.{DLL_EXTENSION}");
        let build = format!("cc -std=c11 -shared -fPIC {name}.c -o {library} -lm");
        vec![
            (format!("{name}.c"), C.source(name)),
            ("tenon_value.h".into(), VALUE_HEADER.into()),
            ("tenon_plugin.h".into(), PLUGIN_HEADER.into()),
            ("README.md".into(), C.readme(name, &build, &format!("./{library}"))),
        ]
    } else {
        let example = if args.curve { &CURVE } else { &FASTENER };
        let library = format!("target/release/{DLL_PREFIX}{name}{DLL_SUFFIX}");
        vec![
            ("Cargo.toml".into(), manifest(name, &sdk(args.sdk.as_deref())?)),
            ("src/lib.rs".into(), example.source(name)),
            ("README.md".into(), example.readme(name, "cargo build --release", &library)),
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

impl Example {
    fn source(&self, name: &str) -> String {
        self.source.replace(&format!("\"{}", self.id), &format!("\"{name}"))
    }

    fn readme(&self, name: &str, build: &str, library: &str) -> String {
        let rest = self.readme.find("\n## ").map_or("", |at| &self.readme[at..]);
        let rest = rest.replace("libacme.so", &format!("{DLL_PREFIX}acme{DLL_SUFFIX}"));
        let rest = rest.replace("acme.so", &format!("acme.{DLL_EXTENSION}")).replace("acme", name);
        format!(
            "# {name}\n\nA plugin of Tenon. Build it, look at it, test it:\n\n```bash\n{build}\ntenon plugin info {library}\n\
             tenon plugin check {library}\n```\n{rest}"
        )
    }
}

fn manifest(name: &str, sdk: &Path) -> String {
    // A JSON text is a TOML text too.
    let path = Json::from(sdk.display().to_string());
    format!(
        "[package]\nname = \"{name}\"\nversion = \"0.1.0\"\nedition = \"2024\"\n\n[lib]\ncrate-type = [\"cdylib\"]\n\n\
         [dependencies]\n# The SDK of the Tenon that is installed here.\ntenon-plugin = {{ path = {path} }}\n\n[workspace]\n"
    )
}

/// The folder of the SDK: the one named, else `share/tenon/plugin-sdk` beside the folder of this program, or `plugin-sdk` in
/// the source that it was built in.
fn sdk(named: Option<&Path>) -> Result<PathBuf, Wrong> {
    let is_sdk = |folder: &PathBuf| {
        let manifest = std::fs::read_to_string(folder.join("Cargo.toml"));
        manifest.is_ok_and(|text| text.contains("name = \"tenon-plugin\""))
    };
    let hint = "--sdk names it: share/tenon/plugin-sdk where Tenon is installed, plugin-sdk in its source";
    if let Some(named) = named {
        let folder = named.canonicalize().ok().filter(is_sdk);
        let message = || format!("{} is not the folder of the plugin SDK", named.display());
        return folder.ok_or_else(|| Wrong::new("no-sdk", message()).hint(hint));
    }
    let program = std::env::current_exe().and_then(|p| p.canonicalize()).unwrap_or_default();
    let places =
        program.ancestors().skip(1).take(4).flat_map(|f| [f.join("share/tenon/plugin-sdk"), f.join("plugin-sdk")]);
    let found = places.into_iter().find(is_sdk);
    found.ok_or_else(|| Wrong::new("no-sdk", "the plugin SDK does not lie where this program does").hint(hint))
}
