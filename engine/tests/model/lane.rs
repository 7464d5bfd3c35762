//! One session that goes through a script, with what it must not forget. Lanes differ in threads and in memory for the cache.

use super::oracle::{Came, Expected, Last, concerns, expected};
use super::script::Step;
use super::world::{Calls, Disk, LIBRARY, Who, library, ports_of, registry};
use std::collections::BTreeMap;
use std::sync::Arc;
use std::sync::atomic::AtomicBool;
use tenon_engine::*;

/// What a lane is.
#[derive(Clone, Copy, Debug)]
pub struct Kind {
    pub threads: usize,
    pub cache_bytes: usize,
}

impl Kind {
    fn keeps_everything(self) -> bool {
        self.cache_bytes > 1 << 20
    }
}

pub struct Lane {
    pub kind: Kind,
    session: Session,
    calls: Arc<Calls>,
    disk: Arc<Disk>,
    history: History,
    /// Outputs of nodes as the last evaluation that looked at them left them.
    last: BTreeMap<String, Last>,
    /// Evaluations that were compared, and those that could not be.
    pub compared: usize,
    pub skipped: usize,
    /// Results that were dropped, and evaluations that were cancelled.
    pub evicted: usize,
    pub cancelled: usize,
}

macro_rules! ensure {
    ($condition:expr, $($words:tt)+) => {
        if !$condition {
            return Err(format!($($words)+));
        }
    };
}

/// The tag of a node, which may be within instances.
fn tag(document: &Document, id: &str) -> i64 {
    // Clusters stand at the top, however deep their instances are.
    let (clusters, mut document) = (&document.clusters, document);
    let mut steps = id.split('/').peekable();
    while let Some(step) = steps.next() {
        let Some(node) = document.nodes().get(step) else { break };
        match node.cluster().and_then(|name| clusters.get(name)) {
            Some(Cluster::Here(body)) if steps.peek().is_some() => document = body,
            _ => return node.params.get("tag").and_then(Literal::as_i64).unwrap_or(0),
        }
    }
    0
}

impl Lane {
    pub fn new(kind: Kind) -> Self {
        let (calls, disk) = (Arc::new(Calls::default()), Arc::new(Disk::default()));
        let options =
            Options { threads: kind.threads, cache_bytes: kind.cache_bytes, host: disk.clone(), ..Options::default() };
        let session = Session::new(registry(&calls, Vec::new()), Document::new(), options);
        let (history, last) = (History::with_limit(0), BTreeMap::new());
        Self { kind, session, calls, disk, history, last, compared: 0, skipped: 0, evicted: 0, cancelled: 0 }
    }

    /// Takes a step; gives the log of an evaluation.
    pub fn step(&mut self, step: &Step) -> Result<Option<Events>, String> {
        match step {
            Step::Edit(operation) => self.edit(operation)?,
            Step::Paste(ids) => {
                let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
                let document = self.session.document();
                if let Ok(fragment) = document.copy(&ids) {
                    let paste = document.paste(&fragment, OuterWires::Keep, [0.0, 0.0]).operation;
                    self.edit(&paste)?;
                }
            }
            Step::Set(name, value) => {
                let before = self.session.document().clone();
                match self.session.set(name, value.clone()) {
                    Ok(()) => {
                        let back = Operation::All(self.session.document().diff(&before));
                        self.history.record(back);
                    }
                    Err(refused) => ensure!(*self.session.document() == before, "{refused}, but something has changed"),
                }
            }
            Step::Reload => {
                let (document, layout) = (self.session.document(), self.session.document().layout_to_string());
                let text = document.to_string_canonical_for(self.session.registry());
                let mut again = Document::from_slice(text.as_bytes()).map_err(|e| format!("{e:?}"))?;
                again.read_layout(layout.as_bytes()).map_err(|e| e.to_string())?;
                ensure!(again == *document, "what was written is read as something else");
                self.session.replace(again);
                self.forget();
            }
            Step::Room(bytes) => {
                if !self.kind.keeps_everything() {
                    self.session.limit_cache(*bytes);
                }
            }
            Step::Begin => self.history.begin(),
            Step::Commit => self.history.commit(),
            Step::Undo => {
                let session = &mut self.session;
                let undone = self.history.undo_by(|step| session.edit(step));
                undone.map_err(|e| format!("what was done cannot be taken back: {e}"))?;
                self.forget();
            }
            Step::Redo => {
                let session = &mut self.session;
                let redone = self.history.redo_by(|step| session.edit(step));
                redone.map_err(|e| format!("what was taken back cannot be done again: {e}"))?;
                self.forget();
            }
            Step::File(name, content) => {
                let mut files = self.disk.0.lock().map_err(|e| e.to_string())?;
                match content {
                    Some(n) => files.insert(name.clone(), vec![b'.'; *n]),
                    None => files.remove(name),
                };
            }
            Step::Gather(ids, name, instance) => {
                let ids: Vec<&str> = ids.iter().map(String::as_str).collect();
                if let Ok(operation) = self.session.document().gather(&ids, name, instance) {
                    self.edit(&operation)?;
                }
            }
            Step::Explode(id) => {
                if let Ok(paste) = self.session.document().explode(id, self.session.registry()) {
                    self.edit(&paste.operation)?;
                }
            }
            Step::Library(b) => {
                let mut files = self.disk.0.lock().map_err(|e| e.to_string())?;
                match b {
                    Some(b) => files.insert(LIBRARY.into(), library(*b)),
                    None => files.remove(LIBRARY),
                };
                drop(files);
                self.session.refresh_links();
                self.forget();
            }
            Step::Evaluate(targets) => return self.evaluate(targets, None).map(Some),
            Step::Cancel(after, targets) => return self.evaluate(targets, Some(*after)).map(Some),
        }
        Ok(None)
    }

    fn edit(&mut self, operation: &Operation) -> Result<(), String> {
        let before = self.session.document().clone();
        let mut mirror = before.clone();
        let wanted = operation.apply(&mut mirror);
        match self.session.edit(operation) {
            Ok(inverse) => {
                ensure!(
                    wanted.is_ok() && *self.session.document() == mirror,
                    "the session's document went another way"
                );
                let mut back = mirror;
                inverse.apply(&mut back).map_err(|e| format!("it cannot be taken back: {e}"))?;
                ensure!(back.to_string_canonical() == before.to_string_canonical(), "it is not taken back whole");
                self.history.record(inverse);
            }
            Err(refused) => {
                ensure!(wanted.is_err() && *self.session.document() == before, "{refused}, but something has changed");
            }
        }
        self.forget();
        Ok(())
    }

    /// Nodes that are gone, or are something else now, have no last outputs; neither have those whose outputs were dropped from
    /// memory before they were frozen.
    fn forget(&mut self) {
        self.follow();
        let (session, kind) = (&self.session, self.kind);
        self.last.retain(|id, last| {
            let Some(node) = session.document().nodes().get(id) else { return false };
            let there = || {
                let t = session.registry().get(&node.type_name);
                t.is_some_and(|t| t.outputs().iter().all(|p| session.value(&format!("{id}.{}", p.name())).is_some()))
            };
            let dropped = !kind.keeps_everything() && node.state == NodeState::Frozen && !there();
            node.type_name == last.type_name && !dropped
        });
    }

    /// What a node had last goes with it when it is renamed: a frozen node under a new id may have just that.
    fn follow(&mut self) {
        let nodes = self.session.document().nodes();
        let gone: Vec<Last> =
            self.last.iter().filter(|(id, _)| !nodes.contains_key(*id)).map(|(_, l)| l.clone()).collect();
        for (id, node) in nodes.iter().filter(|(_, n)| n.state == NodeState::Frozen) {
            if self.last.contains_key(id) {
                continue;
            }
            let ports = ports_of(self.session.document(), &node.type_name).1;
            let has: Option<Vec<Tree>> = ports.iter().map(|p| self.session.value(&format!("{id}.{p}"))).collect();
            let same = |l: &&Last| *l.type_name == *node.type_name && has.as_ref() == Some(&l.outputs);
            if let Some(last) = gone.iter().find(same) {
                self.last.insert(id.clone(), last.clone());
            }
        }
    }

    fn evaluate(&mut self, targets: &[String], cancel_at: Option<usize>) -> Result<Events, String> {
        let names: Vec<&str> = targets.iter().map(String::as_str).collect();
        let flag = Arc::new(AtomicBool::new(false));
        self.calls.begin(cancel_at.map(|at| (at, flag.clone())));
        self.session.take_events();
        let before: Vec<Option<u128>> = self.all_values();
        let report = self.session.evaluate(&names, &Control { cancel: flag, ..Control::default() });
        let (calls, events) = (self.calls.take(), self.session.take_events());
        self.evicted += events.iter().filter(|e| matches!(e, Event::Evicted(_))).count();
        if report.cancelled {
            self.cancelled += 1;
            ensure!(report.nodes.is_empty(), "a cancelled evaluation reports nodes");
            // What nobody asks for is looked at again if a cancelled evaluation was near it; until then it is not shown.
            let same = |(a, b): (&Option<u128>, &Option<u128>)| a == b || a.is_none();
            ensure!(self.all_values().iter().zip(&before).all(same), "a cancelled evaluation has changed a value");
            return Ok(events);
        }
        let Some(expected) = expected(self.session.document(), &self.last, targets, &self.disk) else {
            self.skipped += 1;
            // What is kept and what is not cannot be told any more.
            self.resume(targets)?;
            return Ok(events);
        };
        self.compared += 1;
        self.compare(&expected, &report, targets)?;
        self.judge_claims(&expected, &report, &calls, &events)?;
        self.remember(&expected);
        if self.kind.keeps_everything() {
            self.calls.begin(None);
            let again = self.session.evaluate(&names, &Control::default());
            let calls = self.calls.take();
            ensure!(calls.is_empty(), "nothing has changed, and still this ran: {calls:?}");
            ensure!(again.diagnostics == report.diagnostics, "diagnostics of the same evaluation differ");
            self.session.take_events();
        }
        Ok(events)
    }

    /// Goes on with a session of its own after an evaluation about which nothing can be said.
    fn resume(&mut self, targets: &[String]) -> Result<(), String> {
        let document = self.session.document().clone();
        let options = Options {
            threads: self.kind.threads,
            cache_bytes: self.kind.cache_bytes,
            host: self.disk.clone(),
            ..Options::default()
        };
        self.session = Session::new(registry(&self.calls, Vec::new()), document, options);
        self.last.clear();
        self.evaluate(targets, None).map(|_| ())
    }

    fn all_values(&self) -> Vec<Option<u128>> {
        let document = self.session.document();
        let ports = document.nodes().iter().map(|(id, n)| (id, ports_of(document, &n.type_name).1));
        ports
            .flat_map(|(id, ports)| ports.into_iter().map(move |p| format!("{id}.{p}")))
            .map(|name| self.session.value(&name).map(|t| t.digest()))
            .collect()
    }

    fn compare(&self, expected: &Expected, report: &Report, targets: &[String]) -> Result<(), String> {
        let told: Vec<String> =
            report.diagnostics.iter().filter(|d| concerns(d, &expected.held)).map(ToString::to_string).collect();
        ensure!(told == expected.diagnostics, "it tells\n  {told:#?}\nfresh\n  {:#?}", expected.diagnostics);
        for (id, Came { type_name, happened, outputs, .. }) in &expected.nodes {
            let Some(t) = self.session.registry().get(type_name) else { continue };
            for (port, tree) in t.outputs().iter().zip(outputs) {
                let name = format!("{id}.{}", port.name());
                let found = self.session.value(&name);
                let may_be_dropped = !self.kind.keeps_everything() && !targets.contains(&name);
                ensure!(
                    found.is_some() == tree.is_some() || (found.is_none() && may_be_dropped),
                    "{name} has {}, fresh {} ({happened:?})",
                    if found.is_some() { "a value" } else { "none" },
                    if tree.is_some() { "has one" } else { "has none" }
                );
                if let (Some(found), Some(tree)) = (found, tree) {
                    // By content, not by digest alone: the digest may be what is wrong.
                    let same = found.digest() == tree.digest() && found.to_json() == tree.to_json();
                    ensure!(same, "{name} is {found:?}, fresh {tree:?}");
                }
            }
        }
        let files = |all: &[(String, File)]| -> Vec<String> { all.iter().map(|(n, f)| format!("{n} {f:?}")).collect() };
        let (found, fresh) = (files(&self.session.files()), files(&expected.files));
        ensure!(!targets.is_empty() || found == fresh, "the files are {found:?}, fresh {fresh:?}");
        Ok(())
    }

    /// No event claims less work than happened, and none that something ran which did not.
    fn judge_claims(
        &self,
        expected: &Expected,
        report: &Report,
        calls: &BTreeMap<Who, usize>,
        events: &Events,
    ) -> Result<(), String> {
        let document = self.session.document();
        let ran = |e: Event<&str>, id: &str| matches!(e, Event::Executed(n) | Event::Failed(n) if n == id);
        let mut groups: BTreeMap<Who, Vec<&String>> = BTreeMap::new();
        for (id, came) in &expected.nodes {
            groups.entry((came.type_name.clone(), tag(document, id))).or_default().push(id);
        }
        for (who, count) in calls {
            let nodes = groups.get(who).ok_or_else(|| format!("{who:?} ran and is not there"))?;
            let claimed = nodes.iter().any(|id| events.iter().any(|e| ran(e, id)));
            ensure!(
                claimed,
                "{who:?} ran {count} times, but the log says of none of {nodes:?} that it ran: {events:?}"
            );
            let runs = |id: &&&String| {
                let happened = |n: &NodeReport<'_>| matches!(n.happened, Happened::Executed | Happened::Failed);
                report.nodes.iter().filter(|n| n.id == id.as_str()).filter(happened).count()
            };
            // One item of an output is one call; of nodes that fail, or have several items fail, that is not known.
            let most: usize =
                nodes.iter().map(|id| runs(&id) * self.lanes(expected, id)).fold(0, usize::saturating_add);
            ensure!(*count <= most, "{who:?} ran {count} times, the report accounts for {most}: {:?}", report.nodes);
        }
        for node in report.nodes.iter() {
            let executed = events.iter().filter(|e| matches!(e, Event::Executed(n) if *n == node.id)).count();
            let reported = report.nodes.iter().filter(|n| n.id == node.id && n.happened == Happened::Executed).count();
            ensure!(
                executed == reported,
                "{}: {executed} times executed in the log, {reported} in the report",
                node.id
            );
            let Some(Came { outputs, digest, .. }) = expected.nodes.get(node.id) else {
                return Err(format!("{} was looked at and is not needed", node.id));
            };
            if node.happened == Happened::Executed {
                ensure!(node.digest == *digest, "the report has another digest for {} than a fresh one", node.id);
                let made = outputs
                    .iter()
                    .flatten()
                    .any(|t| t.branches().iter().any(|(_, c)| (0..c.len()).any(|i| c.is_valid(i))));
                let who = (node.type_name.to_string(), tag(document, node.id));
                ensure!(!made || calls.contains_key(&who), "{} is said to have run, and did not", node.id);
            }
        }
        Ok(())
    }

    /// The most calls that one run of a node can make; where every output is a single item, that is one.
    fn lanes(&self, expected: &Expected, id: &str) -> usize {
        let Some(Came { happened: Happened::Executed, type_name, outputs, .. }) = expected.nodes.get(id) else {
            return usize::MAX / 64;
        };
        if ["series", "split", "pass"].contains(&type_name.as_str()) {
            return usize::MAX / 64;
        }
        outputs.iter().flatten().map(Tree::len).max().unwrap_or(0)
    }

    fn remember(&mut self, expected: &Expected) {
        for (id, Came { happened, outputs, .. }) in &expected.nodes {
            if expected.held.contains(id) {
                continue;
            }
            let Some(node) = self.session.document().nodes().get(id) else { continue };
            // What a bypassed node passes on is not its own.
            let own = *happened != Happened::Bypassed && !outputs.is_empty();
            match outputs.iter().cloned().collect::<Option<Vec<Tree>>>().filter(|_| own) {
                Some(outputs) => self.last.insert(id.clone(), Last { type_name: node.type_name.to_string(), outputs }),
                None => self.last.remove(id),
            };
        }
    }

    /// Takes everything back and asks for every node by itself.
    pub fn finish(&mut self) -> Result<(), String> {
        let ids: Vec<String> = self.session.document().nodes().keys().cloned().collect();
        for id in ids {
            let document = self.session.document();
            let ports = document.nodes().get(&id).map(|n| ports_of(document, &n.type_name).1).unwrap_or_default();
            if let Some(port) = ports.first() {
                self.evaluate(&[format!("{id}.{port}")], None).map_err(|e| format!("asked for {id}: {e}"))?;
            }
        }
        loop {
            let session = &mut self.session;
            match self.history.undo_by(|step| session.edit(step)) {
                Ok(true) => {}
                Ok(false) => break,
                Err(e) => return Err(format!("at the end, what was done cannot be taken back: {e}")),
            }
        }
        let (left, empty) = (self.session.document().to_string_canonical(), Document::new().to_string_canonical());
        ensure!(left == empty, "with everything taken back there is still\n{left}");
        Ok(())
    }
}
