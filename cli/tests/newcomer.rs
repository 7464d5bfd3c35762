//! The READMEs of the examples, followed to the letter in an empty folder: their commands are run, their graphs saved, what
//! is to be brought into a graph is brought in.

use crate::plugin::root;
use crate::tenon::Folder;
use serde_json::Value;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::sync::{Mutex, MutexGuard, PoisonError};

/// The code blocks of a text: language and content.
fn blocks(text: &str) -> Vec<(&str, &str)> {
    let fenced = text.split("\n```").skip(1).step_by(2);
    fenced.map(|block| block.split_once('\n').unwrap()).collect()
}

/// What has keys on both sides is merged, everything else replaced, as a person would who brings new lines in.
fn bring_in(graph: &mut Value, news: &Value) {
    match (graph, news) {
        (Value::Object(graph), Value::Object(news)) => {
            for (key, value) in news {
                // Wires are written as a whole.
                match graph.get_mut(key).filter(|_| value.get("from").is_none()) {
                    Some(there) => bring_in(there, value),
                    None => drop(graph.insert(key.clone(), value.clone())),
                }
            }
        }
        (graph, news) => *graph = news.clone(),
    }
}

/// Somebody who follows a text.
struct Newcomer {
    folder: Folder,
    /// Where they stand, as `cd` leaves it.
    place: PathBuf,
    output: String,
    /// All of them call their plugin the same and build it in one place.
    _alone: MutexGuard<'static, ()>,
}

impl Newcomer {
    fn new() -> Self {
        static ALONE: Mutex<()> = Mutex::new(());
        let alone = ALONE.lock().unwrap_or_else(PoisonError::into_inner);
        let folder = Folder::new();
        Self { place: folder.0.clone(), folder, output: String::new(), _alone: alone }
    }

    /// Runs commands as a shell does, and ends at the first that fails.
    #[track_caller]
    fn run(&mut self, commands: &str) {
        // One target for all, so that what they have in common is built once; it stands where cargo would have put it.
        let target = Path::new(env!("CARGO_TARGET_TMPDIR")).join("newcomer");
        let program = Path::new(env!("CARGO_BIN_EXE_tenon")).parent().unwrap();
        let linked = commands.replace("cargo build", "mkdir -p \"$TARGET\"; ln -sfn \"$TARGET\" target; cargo build");
        let done = Command::new("bash")
            .args(["-euc", &format!("{linked}\npwd > \"$HOME/place\"")])
            .current_dir(&self.place)
            .env("PATH", format!("{}:{}", program.display(), std::env::var("PATH").unwrap()))
            .env("TENON", root())
            .env("TARGET", &target)
            // Rust's tools keep their things where they are; a plugin must be found by its name only.
            .env("CARGO_HOME", std::env::var("CARGO_HOME").unwrap_or_else(|_| home(".cargo")))
            .env("RUSTUP_HOME", std::env::var("RUSTUP_HOME").unwrap_or_else(|_| home(".rustup")))
            .env("HOME", &self.folder.0)
            .env("XDG_DATA_HOME", self.folder.0.join("data"))
            .env("CARGO_NET_OFFLINE", "true")
            .env_remove("CARGO_TARGET_DIR")
            .env_remove("TENON_PLUGIN_PATH")
            .output()
            .unwrap();
        self.output = String::from_utf8_lossy(&done.stdout).into_owned();
        assert!(done.status.success(), "{commands}\n{}\n{}", self.output, String::from_utf8_lossy(&done.stderr));
        self.place = self.folder.read("place").trim().into();
    }

    /// Follows a README to its end. A graph in full is saved under the name that stands before it; one that is none is
    /// brought into the graph that was copied.
    #[track_caller]
    fn follow(&mut self, text: &str) {
        for (language, content) in blocks(text) {
            match language {
                "bash" => self.run(content),
                "json" => {
                    let json: Value = serde_json::from_str(content).unwrap();
                    if json["format"] == "tenon" {
                        let before = &text[..text.find(content).unwrap()];
                        let name = before.rsplit('`').find(|word| word.ends_with(".tenon.json")).unwrap();
                        std::fs::write(self.place.join(name), content).unwrap();
                    } else {
                        let file = self.place.join("shell.tenon.json");
                        let mut graph: Value = serde_json::from_slice(&std::fs::read(&file).unwrap()).unwrap();
                        bring_in(&mut graph, &json);
                        std::fs::write(&file, graph.to_string()).unwrap();
                    }
                }
                other => panic!("nobody can follow a block of {other}"),
            }
        }
    }
}

fn home(name: &str) -> String {
    Path::new(&std::env::var("HOME").unwrap()).join(name).display().to_string()
}

fn readme(example: &str) -> String {
    std::fs::read_to_string(root().join("plugin-sdk/examples").join(example).join("README.md")).unwrap()
}

/// Follows an example's README, then that of the plugin which it made, which begins where the commands have led.
#[track_caller]
fn fastener(example: &str, hardware: &str) {
    let mut newcomer = Newcomer::new();
    newcomer.follow(&readme(example));
    // The last command shows the row of the list of hardware; those before it tell of times.
    let row = |newcomer: &Newcomer| newcomer.output.lines().last().unwrap_or_default().to_owned();
    let first = row(&newcomer);
    assert!(first.contains(hardware), "{first}");
    // All the way: programs, and the proof that says that they are good.
    let out = newcomer.place.join("out");
    let names: Vec<String> =
        std::fs::read_dir(&out).unwrap().map(|e| e.unwrap().file_name().to_string_lossy().into_owned()).collect();
    assert!(names.iter().any(|n| n.ends_with(".ngc")) && !names.iter().any(|n| n.contains("unproven")), "{names:?}");
    let own = std::fs::read_to_string(newcomer.place.join("README.md")).unwrap();
    std::fs::remove_dir_all(&out).unwrap();
    newcomer.follow(&own);
    assert_eq!(row(&newcomer), first);
}

#[test]
fn a_fastener_in_rust_by_its_readme_alone() {
    fastener("fastener-rust", "Cam connector 8");
}

#[test]
fn a_fastener_in_c_by_its_readme_alone() {
    fastener("fastener-c", "Butt hinge 40 x 40");
}

#[test]
fn a_curve_in_rust_by_its_readme_alone() {
    let mut newcomer = Newcomer::new();
    newcomer.follow(&readme("curve-rust"));
    let mesh: Value = serde_json::from_str(&newcomer.output).unwrap();
    assert_eq!(mesh["branches"]["{0}"][0]["faces"].as_array().map(Vec::len), Some(32 * 8), "{mesh}");
}

#[test]
fn the_sdk_is_found_or_named() {
    let folder = Folder::new();
    let sdk = root().join("plugin-sdk").display().to_string();
    folder.tenon(&["plugin", "new", "named", "--curve", "--sdk", &sdk]).code(0);
    assert!(folder.read("named/Cargo.toml").contains(&format!("path = \"{sdk}\"")));
    assert!(folder.read("named/src/lib.rs").contains("\"named.helix\""));
    folder
        .tenon(&["plugin", "new", "lost", "--sdk", "."])
        .code(2)
        .says(&["not the folder of the plugin SDK", "share/tenon/plugin-sdk"]);
    assert!(!folder.0.join("lost").exists());
    // Beside the program, as it is installed, also through a link.
    let program = folder.0.join("there/bin/tenon");
    std::fs::create_dir_all(program.parent().unwrap()).unwrap();
    std::fs::copy(env!("CARGO_BIN_EXE_tenon"), &program).unwrap();
    folder.write("there/share/tenon/plugin-sdk/Cargo.toml", "[package]\nname = \"tenon-plugin\"\n");
    let new = |name: &str| {
        let done = Command::new(&program).args(["plugin", "new", name]).current_dir(&folder.0).output().unwrap();
        (done.status.success(), String::from_utf8_lossy(&done.stderr).into_owned())
    };
    assert!(new("beside").0);
    let place = folder.0.canonicalize().unwrap().join("there/share/tenon/plugin-sdk");
    assert!(folder.read("beside/Cargo.toml").contains(&place.display().to_string()));
    std::fs::remove_dir_all(folder.0.join("there/share")).unwrap();
    let (good, told) = new("alone");
    assert!(!good && told.contains("does not lie where") && told.contains("--sdk"), "{told}");
}
