//! Starts the binary in a folder of its own.

use std::path::PathBuf;
use std::process::{Command, Output};
use std::sync::atomic::{AtomicU32, Ordering};

/// A graph of numbers: `n` feeds `twice` (a series of two), the interface sets `n` and shows both.
pub const NUMBERS: &str = r#"{
  "format": "tenon",
  "version": 1,
  "units": "mm",
  "interface": {
    "inputs": {"thickness": {"port": "n.value", "doc": "a number"}},
    "outputs": {"numbers": {"port": "pair.numbers"}}
  },
  "nodes": {
    "n": {"type": "number", "v": 1, "params": {"value": 10}},
    "pair": {"type": "series", "v": 1, "params": {"count": 2}, "inputs": {"start": {"from": ["n.value"]}}},
    "label": {"type": "text", "v": 1, "params": {"value": "a"}}
  }
}
"#;

/// A graph whose one branch fails (a series that leaves the numbers) and whose other branch works.
pub const HALF_BROKEN: &str = r#"{
  "format": "tenon",
  "version": 1,
  "units": "mm",
  "interface": {"inputs": {}, "outputs": {"bad": {"port": "after.numbers"}, "good": {"port": "fine.value"}}},
  "nodes": {
    "after": {"type": "series", "v": 1, "params": {"count": 3}, "inputs": {"start": {"from": ["broken.numbers"]}}},
    "broken": {"type": "series", "v": 1, "params": {"start": 1e308, "step": 1e308, "count": 3}},
    "fine": {"type": "number", "v": 1, "params": {"value": 1}}
  }
}
"#;

/// A folder of its own that goes away at the end.
pub struct Folder(pub PathBuf);

impl Folder {
    /// An empty folder.
    pub fn new() -> Self {
        static COUNT: AtomicU32 = AtomicU32::new(0);
        let n = COUNT.fetch_add(1, Ordering::Relaxed);
        let path = std::env::temp_dir().join(format!("tenon-cli-{}-{n}", std::process::id()));
        let _ = std::fs::remove_dir_all(&path);
        std::fs::create_dir_all(&path).unwrap();
        Self(path)
    }

    /// A folder with one file.
    pub fn with(name: &str, text: impl AsRef<[u8]>) -> Self {
        let folder = Self::new();
        folder.write(name, text);
        folder
    }

    /// Adds a file.
    pub fn write(&self, name: &str, text: impl AsRef<[u8]>) {
        let path = self.0.join(name);
        std::fs::create_dir_all(path.parent().unwrap()).unwrap();
        std::fs::write(path, text).unwrap();
    }

    /// A file's text.
    pub fn read(&self, name: &str) -> String {
        std::fs::read_to_string(self.0.join(name)).unwrap()
    }

    /// Every file below, sorted.
    pub fn files(&self) -> Vec<String> {
        let mut names = Vec::new();
        let mut folders = vec![self.0.clone()];
        while let Some(folder) = folders.pop() {
            for entry in std::fs::read_dir(folder).unwrap() {
                let path = entry.unwrap().path();
                if path.is_dir() {
                    folders.push(path);
                } else {
                    names.push(path.strip_prefix(&self.0).unwrap().to_str().unwrap().to_owned());
                }
            }
        }
        names.sort();
        names
    }

    /// Runs `tenon ARGS` here.
    pub fn tenon(&self, args: &[&str]) -> Ended {
        let output = Command::new(env!("CARGO_BIN_EXE_tenon")).args(args).current_dir(&self.0).output().unwrap();
        Ended::from(output)
    }
}

impl Drop for Folder {
    fn drop(&mut self) {
        let _ = std::fs::remove_dir_all(&self.0);
    }
}

/// The path of a graph that is shipped with the source.
pub fn shipped(name: &str) -> String {
    let path = std::path::Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs").join(name);
    path.to_str().unwrap().to_owned()
}

/// The only branch of a printed tree.
pub fn list(tree: &serde_json::Value) -> serde_json::Value {
    tree["branches"]["{0}"].clone()
}

/// How a call ended.
#[derive(Debug)]
pub struct Ended {
    /// Exit code; -1 if it was killed.
    pub code: i32,
    pub stdout: String,
    pub stderr: String,
}

impl From<Output> for Ended {
    fn from(o: Output) -> Self {
        let text = |bytes| String::from_utf8(bytes).unwrap();
        documented(&String::from_utf8_lossy(&o.stderr));
        Self { code: o.status.code().unwrap_or(-1), stdout: text(o.stdout), stderr: text(o.stderr) }
    }
}

/// Whatever a test does: no code may be said that the book does not explain.
fn documented(stderr: &str) {
    const BOOK: &str = include_str!("../../docs/diagnostics.md");
    for said in ["error[", "warning[", "note["] {
        for code in stderr.split(said).skip(1).filter_map(|rest| rest.split_once(']')).map(|(code, _)| code) {
            assert!(BOOK.contains(&format!("| `{code}` |")), "docs/diagnostics.md does not explain {code}:\n{stderr}");
        }
    }
}

impl Ended {
    /// Expects this exit code.
    #[track_caller]
    pub fn code(self, code: i32) -> Self {
        assert_eq!(self.code, code, "{self:#?}");
        self
    }

    /// Expects these words on stderr.
    #[track_caller]
    pub fn says(self, words: &[&str]) -> Self {
        for word in words {
            assert!(self.stderr.contains(word), "no {word:?} in {self:#?}");
        }
        self
    }

    /// Standard output as JSON.
    #[track_caller]
    pub fn json(&self) -> serde_json::Value {
        serde_json::from_str(&self.stdout).unwrap_or_else(|e| panic!("{e}: {self:#?}"))
    }
}
