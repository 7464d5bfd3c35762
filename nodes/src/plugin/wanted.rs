//! What is asked of plugins before they are loaded: which versions a graph requires, and which of them are to run in
//! processes of their own.

use std::collections::BTreeMap;
use std::env;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tenon_engine::Json;
use tenon_plugin::apart::{self, Limits, Program};
use tenon_plugin::load::{LoadError, LoadFault, Plugin};

/// The variable that says which plugins run in processes of their own, whatever graphs say: `all`, or ids between commas.
pub const POLICY: &str = "TENON_PLUGIN_ISOLATION";

/// The variable that names the program `tenon`, for hosts that are another program.
pub const HOST: &str = "TENON_PLUGIN_HOST";

/// What a graph's `requires` says of one plugin: a range of versions, or that and more.
#[derive(Clone, Debug)]
pub(super) struct Need {
    pub version: semver::VersionReq,
    apart: bool,
    limits: Limits,
}

impl Need {
    /// Reads `">=1, <2"` or `{ "version": ">=1, <2", "isolation": "process", "timeout_s": 60, "memory_mib": 4096 }`.
    pub(super) fn read(json: &Json) -> Result<Self, String> {
        let range = |text: &str| {
            let wrong = |e| format!("\"{text}\" is no range of versions, such as \">=1.2, <2\": {e}");
            semver::VersionReq::parse(text).map_err(wrong)
        };
        let mut need = Self { version: semver::VersionReq::STAR, apart: false, limits: Limits::default() };
        let map = match json {
            Json::String(text) => return Ok(Self { version: range(text)?, ..need }),
            Json::Object(map) => map,
            other => return Err(format!("{other} is no range of versions, such as \">=1.2, <2\"")),
        };
        let number = |key: &str, value: &Json, most: f64| match value.as_f64().filter(|x| *x > 0.0 && *x <= most) {
            Some(x) => Ok(x),
            None => Err(format!("{key} is {value}; it is a number above 0 and at most {most}")),
        };
        for (key, value) in map {
            match (key.as_str(), value.as_str()) {
                ("version", Some(text)) => need.version = range(text)?,
                ("isolation", Some("process")) => need.apart = true,
                ("isolation", Some("none")) => need.apart = false,
                ("isolation", _) => return Err(format!("isolation is {value}; it is \"process\" or \"none\"")),
                ("timeout_s", _) => need.limits.time = Duration::from_secs_f64(number(key, value, 1e6)?),
                ("memory_mib", _) => need.limits.memory = (number(key, value, 1e6)? * 1_048_576.0) as u64,
                _ => {
                    return Err(format!(
                        "\"{key}\": {value} is not known; there are version, isolation, timeout_s, memory_mib"
                    ));
                }
            }
        }
        Ok(need)
    }
}

/// What is asked of plugins.
#[derive(Clone, Debug, Default)]
pub struct Wanted {
    /// By plugin id; words are what is wrong with what the graph says.
    pub(super) needs: BTreeMap<String, Result<Need, String>>,
    /// Ids of plugins that are to run apart; `all` means each.
    apart: Vec<String>,
    /// The program that becomes their processes.
    host: Option<PathBuf>,
}

impl Wanted {
    /// What a graph's `requires` says, and ids of plugins that are to run in processes of their own; `all` means each.
    /// What [`POLICY`] says holds besides.
    #[must_use]
    pub fn new(requires: &BTreeMap<String, Json>, apart: &[String]) -> Self {
        let policy = env::var(POLICY).unwrap_or_default();
        let policy = policy.split(',').map(str::trim).filter(|id| !id.is_empty()).map(str::to_owned);
        Self {
            needs: requires.iter().map(|(id, json)| (id.clone(), Need::read(json))).collect(),
            apart: apart.iter().cloned().chain(policy).collect(),
            host: None,
        }
    }

    /// The same with another program than `tenon` for processes of plugins, which is called in the same way:
    /// `PROGRAM plugin host LIBRARY BYTES`. What [`HOST`] names goes before it.
    #[must_use]
    pub fn hosted_by(mut self, program: Option<PathBuf>) -> Self {
        self.host = program;
        self
    }

    /// The limits of a plugin that is to run apart.
    fn apart(&self, id: &str) -> Option<Limits> {
        let need = self.needs.get(id).and_then(|need| need.as_ref().ok());
        let asked = need.is_some_and(|n| n.apart) || self.apart.iter().any(|a| a == id || a == "all");
        asked.then(|| need.map_or_else(Limits::default, |n| n.limits))
    }

    /// Loads a library, here or in a process of its own. Where any plugin runs apart, every library is first asked there
    /// which one it is: to ask it here would be to run it here.
    pub(super) fn load(&self, path: &Path) -> Result<Plugin, LoadError> {
        if self.apart.is_empty() && !self.needs.values().flatten().any(|need| need.apart) {
            return Plugin::load(path);
        }
        let program = program(self.host.as_ref())
            .map_err(|why| LoadError { path: path.to_owned(), why: LoadFault::Process(why) })?;
        let asked = apart::start(path, &program, Limits::default())?;
        match self.apart(&asked.id) {
            None => Plugin::load(path),
            Some(limits) if limits == Limits::default() => Ok(asked),
            Some(limits) => apart::start(path, &program, limits),
        }
    }
}

/// The program `tenon`: what [`HOST`] names, what the host said, this program if it is that, or what stands beside it.
fn program(host: Option<&PathBuf>) -> Result<Program, String> {
    let named = env::var_os(HOST).map(PathBuf::from).filter(|p| p.is_absolute());
    let this = env::current_exe().ok();
    let beside = this.as_ref().map(|this| match this.file_stem().is_some_and(|name| name == "tenon") {
        true => this.clone(),
        false => this.with_file_name(format!("tenon{}", env::consts::EXE_SUFFIX)),
    });
    let path = named.or(host.cloned()).or(beside).filter(|path| path.is_file());
    let path = path.ok_or_else(|| {
        format!("to run it in a process of its own, the program tenon is needed, beside this one or named by {HOST}")
    })?;
    Ok(Program { path, arguments: vec!["plugin".into(), "host".into()] })
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn needs_are_read_or_refused_by_name() {
        let need = Need::read(&json!({ "version": ">=1", "isolation": "process", "timeout_s": 0.5, "memory_mib": 64 }));
        let need = need.unwrap();
        assert!(need.apart && need.limits == Limits { time: Duration::from_millis(500), memory: 64 << 20 });
        assert!(!Need::read(&json!(">=1, <2")).unwrap().apart);
        for (json, told) in [
            (json!("new"), "range of versions"),
            (json!(7), "range of versions"),
            (json!({ "isolation": "thread" }), "\"process\" or \"none\""),
            (json!({ "timeout_s": 0 }), "timeout_s is 0"),
            (json!({ "memory_mib": "much" }), "memory_mib is \"much\""),
            (json!({ "colour": "red" }), "\"colour\""),
        ] {
            assert!(Need::read(&json).unwrap_err().contains(told), "{json}");
        }
    }

    #[test]
    fn who_runs_apart_follows_from_graph_and_call() {
        let requires = BTreeMap::from([
            ("a".to_owned(), json!({ "isolation": "process", "timeout_s": 1 })),
            ("b".to_owned(), json!("*")),
        ]);
        let wanted = Wanted::new(&requires, &["c".to_owned()]);
        assert_eq!(wanted.apart("a").map(|l| l.time), Some(Duration::from_secs(1)));
        assert!(wanted.apart("b").is_none() && wanted.apart("c").is_some());
        assert!(Wanted::new(&requires, &["all".to_owned()]).apart("b").is_some());
    }
}
