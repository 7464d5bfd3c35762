//! What the program says: diagnostics for people on stderr, results on stdout.

use std::collections::HashMap;
use std::io::{self, IsTerminal, Write};
use tenon_engine::{Diagnostic, Json, Severity};
use tenon_nodes::host::sweep::SweepError;

/// Why the program ends with exit code 2: the call or a file is wrong.
#[derive(Debug)]
pub struct Wrong {
    /// Name of the kind of fault, kebab-case.
    pub code: &'static str,
    /// One sentence.
    pub message: String,
    /// What would help.
    pub hint: Option<String>,
    /// What the engine says about it.
    pub diagnostics: Vec<Diagnostic>,
}

impl Wrong {
    /// A fault with its sentence.
    pub fn new(code: &'static str, message: impl Into<String>) -> Self {
        Self { code, message: message.into(), hint: None, diagnostics: Vec::new() }
    }

    /// Adds what would help.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into());
        self
    }

    /// Adds the engine's reasons.
    #[must_use]
    pub fn because(mut self, diagnostics: Vec<Diagnostic>) -> Self {
        self.diagnostics = diagnostics;
        self
    }

    /// As JSON: `{"ok": false, "error": {code, message, hint}, "diagnostics": []}`.
    pub fn to_json(&self) -> Json {
        serde_json::json!({
            "ok": false,
            "error": { "code": self.code, "message": self.message, "hint": self.hint },
            "diagnostics": to_json(&self.diagnostics),
        })
    }
}

impl From<crate::output::WriteError> for Wrong {
    fn from(error: crate::output::WriteError) -> Self {
        Self::new(error.code(), error.to_string())
    }
}

impl From<crate::graph::GraphError> for Wrong {
    fn from(error: crate::graph::GraphError) -> Self {
        let wrong = Self { hint: error.hint(), ..Self::new(error.code(), error.to_string()) };
        match error {
            crate::graph::GraphError::NotAGraph { because, .. } => wrong.because(because),
            _ => wrong,
        }
    }
}

impl From<SweepError> for Wrong {
    fn from(error: SweepError) -> Self {
        match error {
            SweepError::Graph(error) => error.into(),
            error => {
                let wrong = Self { hint: error.hint(), ..Self::new(error.code(), error.to_string()) };
                match error {
                    SweepError::Refused { because, .. } => wrong.because(vec![*because]),
                    _ => wrong,
                }
            }
        }
    }
}

/// Diagnostics as a JSON array.
pub fn to_json(diagnostics: &[Diagnostic]) -> Json {
    diagnostics.iter().map(|d| serde_json::to_value(d).unwrap_or(Json::Null)).collect()
}

/// How many diagnostics of one kind from one node are printed; all of them are in the report.
const ALIKE: usize = 8;

/// Writes for people on stderr, coloured where stderr is a terminal that shows colours.
pub struct Voice {
    colour: bool,
}

impl Voice {
    /// Colours only on terminals, never with `NO_COLOR`.
    pub fn new() -> Self {
        let dumb = std::env::var_os("TERM").is_some_and(|t| t == "dumb");
        Self { colour: io::stderr().is_terminal() && std::env::var_os("NO_COLOR").is_none() && !dumb }
    }

    fn paint(&self, ansi: &str, text: &str) -> String {
        if self.colour { format!("\x1b[{ansi}m{text}\x1b[0m") } else { text.to_owned() }
    }

    /// Prints a diagnostic: severity and code, message; where; what would help.
    fn diagnostic(&self, d: &Diagnostic, out: &mut String) {
        let (ansi, word) = match d.severity {
            Severity::Error => ("1;31", "error"),
            Severity::Warning => ("1;33", "warning"),
            Severity::Note => ("1;36", "note"),
        };
        out.push_str(&format!("{}: {}\n", self.paint(ansi, &format!("{word}[{}]", d.code)), d.message));
        let mut place = Vec::new();
        match (&d.node, &d.port) {
            (Some(node), Some(port)) => place.push(format!("{node}.{port}")),
            (Some(node), None) => place.push(node.to_string()),
            (None, Some(port)) => place.push(port.to_string()),
            (None, None) => {}
        }
        place.extend(d.item.map(|i| format!("item {i}")));
        if !place.is_empty() {
            out.push_str(&format!("  {} {}\n", self.paint("1;34", "at"), place.join(", ")));
        }
        if let Some(hint) = &d.hint {
            out.push_str(&format!("  {} {hint}\n", self.paint("1;34", "help:")));
        }
    }

    /// Prints diagnostics; of many that differ only in their item, the first few and how many more there are, and in
    /// one line the nodes that are blocked by what failed.
    pub fn diagnostics(&self, all: &[Diagnostic]) {
        let (blocked, all): (Vec<_>, Vec<_>) = all.iter().partition(|d| d.code == "blocked" && d.node.is_some());
        let mut alike: HashMap<(Option<String>, String), usize> = HashMap::new();
        let mut order = Vec::new();
        let mut text = String::new();
        for d in all {
            let key = (d.node.as_ref().map(ToString::to_string), d.code.to_string());
            let seen = alike.entry(key.clone()).or_insert(0);
            *seen += 1;
            if *seen <= ALIKE {
                self.diagnostic(d, &mut text);
            } else if *seen == ALIKE + 1 {
                order.push(key);
            }
        }
        if !blocked.is_empty() {
            let mut names: Vec<&str> = blocked.iter().filter_map(|d| d.node.as_deref()).collect();
            names.dedup();
            text.push_str(&format!(
                "{}: not run for lack of input: {}\n",
                self.paint("1;36", "note[blocked]"),
                names.join(", ")
            ));
        }
        for key in order {
            let more = alike.get(&key).map_or(0, |n| n - ALIKE);
            let node = key.0.as_deref().unwrap_or("the graph");
            text.push_str(&format!("  … and {more} more {} from {node}; --report FILE has them all\n", key.1));
        }
        self.raw(&text);
    }

    /// Prints why the call failed.
    pub fn wrong(&self, wrong: &Wrong) {
        self.raw(&format!("{}: {}\n", self.paint("1;31", "error"), wrong.message));
        self.diagnostics(&wrong.diagnostics);
        if let Some(hint) = &wrong.hint {
            self.raw(&format!("  {} {hint}\n", self.paint("1;34", "help:")));
        }
    }

    /// Prints a line of progress or result for people.
    pub fn say(&self, text: &str) {
        self.raw(&format!("{text}\n"));
    }

    /// Nobody reading is no reason to fail.
    fn raw(&self, text: &str) {
        let _ = io::stderr().write_all(text.as_bytes());
    }
}

/// Prints a result on stdout. A reader that has left (`tenon nodes | head`) is no error.
pub fn print(text: &str) -> Result<(), Wrong> {
    let mut out = io::stdout().lock();
    match out.write_all(text.as_bytes()).and_then(|()| out.flush()) {
        Err(error) if error.kind() != io::ErrorKind::BrokenPipe => {
            Err(Wrong::new("unwritable", format!("standard output cannot be written: {error}")))
        }
        _ => Ok(()),
    }
}

/// Prints a JSON value on stdout, indented.
pub fn print_json(value: &Json) -> Result<(), Wrong> {
    print(&format!("{value:#}\n"))
}
