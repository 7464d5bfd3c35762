//! Evaluates the rows of a sweep one after another, so that what they have in common is computed once, and so that no row
//! depends on the one before it.

use super::row::{Row, document_digest};
use crate::diagnostic::Diagnostic;
use crate::document::{Document, NodeState};
use crate::evaluate::report::{Control, Report};
use crate::evaluate::session::{Host, Options, Session};
use crate::registry::Registry;
use crate::value::{Json, digest_bytes};
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, PoisonError};

/// Types of which values stand in a result; of the others only their digest and one line.
const PLAIN: [&str; 4] = ["number", "integer", "boolean", "text"];

/// Hands files on and remembers which, with their digests.
struct Recorder {
    host: Arc<dyn Host>,
    seen: Mutex<BTreeMap<String, Option<u128>>>,
}

impl Host for Recorder {
    fn read(&self, path: &str) -> std::io::Result<Arc<[u8]>> {
        let read = self.host.read(path);
        let digest = read.as_ref().ok().map(|bytes| digest_bytes(bytes));
        self.seen.lock().unwrap_or_else(PoisonError::into_inner).insert(path.to_owned(), digest);
        read
    }
}

/// A session that evaluates row after row of one graph.
pub struct RowEvaluator {
    document: Document,
    digest: u128,
    session: Session,
    options: Options,
    recorder: Arc<Recorder>,
    links: BTreeMap<String, Option<u128>>,
    names: Vec<String>,
    registry: Arc<Registry>,
}

impl RowEvaluator {
    /// For the rows of `document`, whose linked files are read now. Nothing runs yet.
    #[must_use]
    pub fn new(registry: Arc<Registry>, mut document: Document, options: Options) -> Self {
        let recorder = Arc::new(Recorder { host: options.host.clone(), seen: Mutex::default() });
        let options = Options { host: recorder.clone(), ..options };
        document.read_links(&*recorder);
        let links = std::mem::take(&mut *recorder.seen.lock().unwrap_or_else(PoisonError::into_inner));
        let digest = document_digest(&document, &registry);
        let session = Session::new(registry.clone(), document.clone(), options.clone());
        Self { document, digest, session, options, recorder, links, names: Vec::new(), registry }
    }

    /// Whether a row was planned for this graph, by a program of this version.
    #[must_use]
    pub fn takes(&self, row: &Row) -> bool {
        row.is_of(self.digest)
    }

    /// Evaluates a row: every output and every file. Its report, which may say that it was cancelled.
    ///
    /// # Errors
    /// A value that an input refuses.
    pub fn evaluate(&mut self, row: &Row, control: &Control<'_>) -> Result<Report, Diagnostic> {
        let names: Vec<String> = row.set.keys().cloned().collect();
        if self.document.nodes().values().any(|node| node.state == NodeState::Frozen) {
            // A frozen node keeps what the row before has given it; a row's result must not depend on that.
            self.session = Session::new(self.registry.clone(), self.document.clone(), self.options.clone());
        } else if self.names != names {
            // Inputs that only the row before has set go back to what the graph says.
            self.session.replace(self.document.clone());
            self.names = names;
        }
        for (name, value) in &row.set {
            self.session.set(name, value.clone())?;
        }
        self.recorder.seen.lock().unwrap_or_else(PoisonError::into_inner).clear();
        Ok(self.session.evaluate(&[], control))
    }

    /// The session, to read values and files of the row that was evaluated last.
    #[must_use]
    pub fn session(&self) -> &Session {
        &self.session
    }

    /// What the row that was evaluated last came to: each interface output as `{"type", "digest", "summary"}`, numbers,
    /// booleans and texts with their `value`; null without one.
    #[must_use]
    pub fn values(&self) -> Json {
        let of = |name: &String| {
            self.session.value(name).map_or(Json::Null, |tree| {
                let digest = format!("{:032x}", tree.digest());
                let mut value =
                    serde_json::json!({ "type": tree.type_name(), "digest": digest, "summary": tree.summary() });
                if PLAIN.contains(&tree.type_name()) {
                    value["value"] = tree.to_json();
                }
                value
            })
        };
        Json::Object(self.session.document().outputs.keys().map(|name| (name.clone(), of(name))).collect())
    }

    /// The files that the row that was evaluated last has read and those that clusters are linked from, by name, with
    /// their digests; null for one that could not be read.
    #[must_use]
    pub fn inputs(&self) -> Json {
        let seen = self.recorder.seen.lock().unwrap_or_else(PoisonError::into_inner);
        let files = self.links.iter().chain(seen.iter());
        let all = files.map(|(path, digest)| (path.clone(), digest.map(|d| format!("{d:032x}")).into()));
        Json::Object(all.collect())
    }
}
