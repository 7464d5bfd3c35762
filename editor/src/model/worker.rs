//! Evaluation beside the window. One thread holds the session; edits go to it in order, and what it finds comes back in
//! updates. First comes what the viewport shows, then everything else; a new edit stops the second, never the window.

use super::inside::Entered;
use super::{cut, reach};
use crate::scene::{self, Drawing};
use std::collections::{BTreeMap, HashMap, HashSet};
use std::sync::atomic::{AtomicBool, AtomicU64, AtomicUsize, Ordering};
use std::sync::mpsc::{Receiver, Sender, channel};
use std::sync::{Arc, Mutex, PoisonError};
use std::time::{Duration, Instant};
use tenon_engine::{
    Control, Diagnostic, Document, File, Host, Node, NodeType, Operation, Options, Progress, Registry, Report, Session,
    Tree,
};

/// What is shown may take this long before a new edit stops it.
const PATIENCE: Duration = Duration::from_millis(500);

/// How long the end of the window waits for that of the evaluation.
const FAREWELL: Duration = Duration::from_millis(100);

/// Memory for remembered results, bytes.
const CACHE: usize = 1 << 30;

/// What an evaluation was for.
#[derive(Clone, Copy, Debug, PartialEq, Eq)]
pub enum Stage {
    /// What the viewport shows.
    Shown,
    /// The whole graph.
    All,
}

enum Request {
    Open(Arc<Registry>, Box<Document>, Arc<dyn Host>),
    Edit(Operation),
    Show(Vec<String>),
    Inside(Vec<Entered>),
    Again,
}

/// What the thread tells.
pub enum Update {
    /// How far the evaluation is.
    Progress(Progress),
    /// An evaluation ended.
    Done(Box<Done>),
    /// An edit was refused that the document had taken: the document must be sent anew.
    Lost(Diagnostic),
}

/// An evaluation that ended.
pub struct Done {
    /// What it was for.
    pub stage: Stage,
    /// How many requests it knew of.
    pub revision: u64,
    /// The engine's report.
    pub report: Report,
    /// What keeps the graph from running as it stands.
    pub faults: Vec<Diagnostic>,
    /// All values in memory, by `node.port`.
    pub values: HashMap<String, Tree>,
    /// What the viewport shows, by `node.port`.
    pub drawings: BTreeMap<String, Arc<Drawing>>,
    /// The files that writers made, with the `node.port` that made them.
    pub files: Vec<(String, File)>,
}

struct Running {
    stage: Stage,
    since: Instant,
    cancel: Arc<AtomicBool>,
}

#[derive(Default)]
struct Shared {
    pending: AtomicUsize,
    /// Nothing is evaluated until there are more requests than these.
    stopped_at: AtomicU64,
    running: Mutex<Option<Running>>,
}

impl Shared {
    fn running(&self) -> std::sync::MutexGuard<'_, Option<Running>> {
        self.running.lock().unwrap_or_else(PoisonError::into_inner)
    }
}

/// The thread that evaluates. It is told to end when this is dropped.
pub struct Worker {
    requests: Option<Sender<Request>>,
    updates: Receiver<Update>,
    shared: Arc<Shared>,
    sent: u64,
    thread: Option<std::thread::JoinHandle<()>>,
}

impl Worker {
    /// Starts the thread with an empty document; `wake` is called from it whenever there is an update.
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn start(registry: Arc<Registry>, wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let (requests, inbox) = channel();
        let (outbox, updates) = channel();
        let shared = Arc::new(Shared::default());
        let thread = std::thread::Builder::new().name("evaluation".into()).spawn({
            let shared = shared.clone();
            move || {
                let tell = Tell { outbox, wake: Box::new(wake) };
                Evaluator {
                    registry,
                    inbox,
                    tell,
                    shared,
                    shown: Vec::new(),
                    inside: Vec::new(),
                    known: HashMap::new(),
                    outputs: HashMap::new(),
                    seen: 0,
                }
                .run();
            }
        })?;
        Ok(Self { requests: Some(requests), updates, shared, sent: 0, thread: Some(thread) })
    }

    /// Takes another document; files that nodes name come from `host`.
    pub fn open(&mut self, registry: Arc<Registry>, document: Document, host: Arc<dyn Host>) {
        self.send(Request::Open(registry, Box::new(document), host));
    }

    /// Says whose inside is looked at, from the outside, so that its values are told too.
    pub fn look_inside(&mut self, inside: Vec<Entered>) {
        self.send(Request::Inside(inside));
    }

    /// Changes the document.
    pub fn edit(&mut self, operation: Operation) {
        self.send(Request::Edit(operation));
    }

    /// Says which outputs (`node.port`) the viewport shows.
    pub fn show(&mut self, outputs: Vec<String>) {
        self.send(Request::Show(outputs));
    }

    /// Evaluates once more, as after a cancelled run or a changed file.
    pub fn again(&mut self) {
        self.send(Request::Again);
    }

    fn send(&mut self, request: Request) {
        self.sent += 1;
        // Held until the request is sent: an evaluation that begins with it waits, and so is not taken for an older one.
        let running = self.shared.running();
        self.shared.pending.fetch_add(1, Ordering::SeqCst);
        if let Some(requests) = &self.requests {
            // It fails only if the thread has ended, which is told by `alive`.
            let _ = requests.send(request);
        }
        if let Some(running) = &*running
            && (running.stage == Stage::All || running.since.elapsed() > PATIENCE)
        {
            running.cancel.store(true, Ordering::Relaxed);
        }
    }

    /// Stops what runs now and what was asked for; false if nothing runs.
    pub fn cancel(&self) -> bool {
        self.shared.stopped_at.store(self.sent, Ordering::SeqCst);
        let running = self.shared.running();
        running.iter().for_each(|r| r.cancel.store(true, Ordering::Relaxed));
        running.is_some()
    }

    /// Whether an evaluation runs now.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.shared.running().is_some()
    }

    /// Requests sent so far; an update with this revision knows all of them.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.sent
    }

    /// The next update, if there is one; never waits.
    pub fn poll(&self) -> Option<Update> {
        self.updates.try_recv().ok()
    }
}

impl Drop for Worker {
    fn drop(&mut self) {
        self.requests = None;
        self.cancel();
        // A node that does not look whether it is to stop must not hold the window: it ends when it is done, or with the
        // program.
        let until = Instant::now() + FAREWELL;
        while self.thread.as_ref().is_some_and(|t| !t.is_finished()) && Instant::now() < until {
            std::thread::sleep(Duration::from_millis(1));
        }
    }
}

struct Tell {
    outbox: Sender<Update>,
    wake: Box<dyn Fn() + Send + Sync>,
}

impl Tell {
    fn tell(&self, update: Update) {
        // Nobody listens any more once the window is closed.
        let _ = self.outbox.send(update);
        (self.wake)();
    }
}

struct Evaluator {
    registry: Arc<Registry>,
    inbox: Receiver<Request>,
    tell: Tell,
    shared: Arc<Shared>,
    shown: Vec<String>,
    inside: Vec<Entered>,
    /// Drawings by digest of what they show, so that what did not change is not drawn anew.
    known: HashMap<u128, Arc<Drawing>>,
    /// Outputs of clusters, by the type of their instances.
    outputs: HashMap<String, Vec<String>>,
    seen: u64,
}

impl Evaluator {
    fn run(mut self) {
        let mut session = Session::new(self.registry.clone(), Document::new(), Options::default());
        while let Ok(request) = self.inbox.recv() {
            self.take(&mut session, request);
            while let Ok(request) = self.inbox.try_recv() {
                self.take(&mut session, request);
            }
            if self.is_stopped() {
                self.tell_stopped(&session);
                continue;
            }
            let shown: Vec<String> = self.shown.iter().filter(|s| session.knows(s).is_ok()).cloned().collect();
            let stopped = !shown.is_empty() && self.evaluate(&mut session, Stage::Shown, &shown);
            if !stopped && !self.is_stopped() && self.shared.pending.load(Ordering::SeqCst) == 0 {
                let ends = self.ends(&session);
                self.evaluate(&mut session, Stage::All, &ends);
            } else if self.is_stopped() {
                self.tell_stopped(&session);
            }
        }
    }

    /// Whether somebody has stopped all that was asked for.
    fn is_stopped(&self) -> bool {
        self.seen <= self.shared.stopped_at.load(Ordering::SeqCst)
    }

    /// Tells that nothing more will come until something is asked for.
    fn tell_stopped(&mut self, session: &Session) {
        let report = Report { cancelled: true, ..Report::default() };
        let (faults, files) = (Vec::new(), Vec::new());
        let (values, drawings) = (self.values(session), self.draw(session));
        let (stage, revision) = (Stage::All, self.seen);
        self.tell.tell(Update::Done(Box::new(Done { stage, revision, report, faults, values, drawings, files })));
    }

    fn take(&mut self, session: &mut Session, request: Request) {
        self.shared.pending.fetch_sub(1, Ordering::SeqCst);
        self.seen += 1;
        match request {
            Request::Open(registry, document, host) => {
                self.registry = registry;
                let options = Options { cache_bytes: CACHE, host, ..Options::default() };
                *session = Session::new(self.registry.clone(), *document, options);
                self.known.clear();
                self.outputs.clear();
            }
            Request::Edit(operation) => {
                if touches_clusters(&operation) {
                    self.outputs.clear();
                }
                if let Err(diagnostic) = session.edit(&operation) {
                    self.tell.tell(Update::Lost(diagnostic));
                }
            }
            Request::Show(shown) => self.shown = shown,
            Request::Inside(inside) => self.inside = inside,
            Request::Again => {}
        }
    }

    /// True if it was stopped.
    fn evaluate(&mut self, session: &mut Session, stage: Stage, targets: &[String]) -> bool {
        let cancel = Arc::new(AtomicBool::new(false));
        *self.shared.running() = Some(Running { stage, since: Instant::now(), cancel: cancel.clone() });
        // A request that came before this could be stopped has not stopped it.
        let overtaken = stage == Stage::All && self.shared.pending.load(Ordering::SeqCst) > 0;
        let targets: Vec<&str> = targets.iter().map(String::as_str).collect();
        let report = if overtaken || targets.is_empty() {
            Report { cancelled: overtaken, ..Report::default() }
        } else {
            let progress = |p: &Progress| self.tell.tell(Update::Progress(p.clone()));
            session.evaluate(&targets, &Control { cancel, on_progress: Some(&progress) })
        };
        *self.shared.running() = None;
        session.take_events();
        let stopped = report.cancelled;
        let faults = if stage == Stage::All { session.document().validate(&self.registry) } else { Vec::new() };
        let (values, drawings) = (self.values(session), self.draw(session));
        let files = if stage == Stage::All { session.files() } else { Vec::new() };
        let done = Done { stage, revision: self.seen, report, faults, values, drawings, files };
        self.tell.tell(Update::Done(Box::new(done)));
        stopped
    }

    fn draw(&mut self, session: &Session) -> BTreeMap<String, Arc<Drawing>> {
        let mut drawings = BTreeMap::new();
        let mut known = HashMap::new();
        for address in &self.shown {
            let Some(tree) = session.value(address) else { continue };
            let drawing = self.known.get(&tree.digest()).cloned().or_else(|| scene::draw(&tree).map(Arc::new));
            if let Some(drawing) = drawing {
                known.insert(tree.digest(), drawing.clone());
                drawings.insert(address.clone(), drawing);
            }
        }
        self.known = known;
        drawings
    }

    /// Names of a node's outputs; of an instance those of its cluster.
    fn outputs(&mut self, session: &Session, node: &Node) -> Vec<String> {
        let names = |t: &NodeType| t.outputs().iter().map(|p| p.name().to_owned()).collect();
        if let Some(known) = session.registry().get(&node.type_name) {
            return names(known);
        }
        let Some(cluster) = node.cluster() else { return Vec::new() };
        if let Some(known) = self.outputs.get(node.type_name.as_str()) {
            return known.clone();
        }
        let found = session.document().cluster_type(cluster, &self.registry);
        let found = found.map_or_else(|_| Vec::new(), |t| names(&t));
        self.outputs.insert(node.type_name.to_string(), found.clone());
        found
    }

    /// Outputs of all nodes that nothing follows: with them, all nodes are brought up to date. Of an instance all outputs,
    /// since not all that is in it need stand behind the first, and what tells what the machine makes behind none of them.
    fn ends(&mut self, session: &Session) -> Vec<String> {
        let nodes = session.document().nodes();
        let mut inner = HashSet::new();
        for node in nodes.values() {
            for (_, wires) in &node.inputs {
                inner.extend(wires.from.iter().filter_map(|f| f.split_once('.')).map(|(id, _)| id));
            }
        }
        let mut ends = Vec::new();
        for (id, node) in nodes {
            let most = if node.cluster().is_some() { usize::MAX } else { 1 };
            if most == 1 && inner.contains(id.as_str()) {
                continue;
            }
            ends.extend(self.outputs(session, node).iter().take(most).map(|port| format!("{id}.{port}")));
        }
        ends.extend(
            reach::inside(session.document(), &self.registry, &cut::ASKED)
                .iter()
                .filter(|o| session.knows(o).is_ok())
                .cloned(),
        );
        ends
    }

    fn values(&mut self, session: &Session) -> HashMap<String, Tree> {
        let (mut values, inside) = (HashMap::new(), self.inside.clone());
        let mut take = |prefix: &str, nodes: &BTreeMap<String, Node>| {
            for (id, node) in nodes {
                for port in self.outputs(session, node) {
                    let address = format!("{prefix}{id}.{port}");
                    if let Some(tree) = session.value(&address) {
                        values.insert(address, tree);
                    }
                }
            }
        };
        take("", session.document().nodes());
        let body = session.document().definition(inside.iter().map(|e| e.cluster.as_str()));
        if let (Some(last), Some((body, _))) = (inside.last(), body) {
            take(&format!("{}/", last.path), body.nodes());
        }
        // What the machine makes is looked at wherever it is made.
        for address in reach::inside(session.document(), &self.registry, &cut::ASKED).iter() {
            if let Some(tree) = session.value(address) {
                values.insert(address.clone(), tree);
            }
        }
        values
    }
}

/// Whether an operation may change what clusters look like.
pub(super) fn touches_clusters(operation: &Operation) -> bool {
    operation.parts().any(|o| matches!(o, Operation::SetCluster { .. } | Operation::InCluster { .. }))
}

#[cfg(test)]
mod tests {
    use super::*;
    use tenon_engine::{NoHost, Port};

    #[test]
    fn the_end_of_the_window_waits_for_no_node() {
        let mut registry = tenon_nodes::registry();
        let (begun, begins) = channel();
        let begun = Mutex::new(begun);
        // It never looks whether it is to stop.
        let deaf = NodeType::new("deaf", 1).input(Port::item::<f64>("a").default(0.0)).output(Port::item::<f64>("b"));
        let deaf = deaf.slow().run(move |c| {
            let _ = begun.lock().unwrap_or_else(PoisonError::into_inner).send(());
            std::thread::sleep(Duration::from_secs(20));
            c.set("b", 1.0);
            Ok(())
        });
        registry.register(deaf).unwrap();
        let registry = Arc::new(registry);
        let mut document = Document::new();
        Operation::AddNode { id: "n".into(), node: Box::new(Node::new("deaf")) }.apply(&mut document).unwrap();
        let mut worker = Worker::start(registry.clone(), || {}).unwrap();
        worker.open(registry, document, Arc::new(NoHost));
        begins.recv_timeout(Duration::from_secs(10)).unwrap();
        let start = Instant::now();
        drop(worker);
        assert!(start.elapsed() < Duration::from_secs(5), "{:?}", start.elapsed());
    }
}
