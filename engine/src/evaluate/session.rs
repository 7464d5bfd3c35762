//! A session: one document being worked on. Set inputs, evaluate, read values and files.

use super::cache::Memo;
use super::commit::Spare;
use super::matching::Matching;
use super::queue::Queue;
use super::report::Events;
use super::state::{NodeRun, Status, Told, Value};
use super::store::{Store, StoreFault};
use crate::diagnostic::{Diagnostic, Severity, did_you_mean};
use crate::document::model::{Document, InterfaceInput, Node, NodeState, split_port};
use crate::document::operations::Operation;
use crate::plan::Plan;
use crate::plan::address::Places;
use crate::registry::Registry;
use crate::value::digest::Packed;
use crate::value::{Column, File, Json, Tree};
use smallvec::SmallVec;
use std::borrow::Cow;
use std::collections::BTreeMap;
use std::sync::{Arc, Mutex, OnceLock};

/// What the program around the engine provides.
pub trait Host: Send + Sync {
    /// Content of a file that a node names.
    ///
    /// # Errors
    /// Whatever keeps it from being read; the node that named it fails with this text.
    fn read(&self, path: &str) -> std::io::Result<Arc<[u8]>>;
}

/// A host without files.
#[derive(Clone, Copy, Debug, Default)]
pub struct NoHost;

impl Host for NoHost {
    fn read(&self, _: &str) -> std::io::Result<Arc<[u8]>> {
        Err(std::io::Error::new(std::io::ErrorKind::Unsupported, "this program reads no files"))
    }
}

/// How a session works; none of it changes results.
#[derive(Clone)]
pub struct Options {
    /// Threads of the pool; 0: as many as the machine has.
    pub threads: usize,
    /// Memory for remembered results.
    pub cache_bytes: usize,
    /// Where files come from.
    pub host: Arc<dyn Host>,
    /// Where results outlive the process, if anywhere.
    pub store: Option<Arc<dyn Store>>,
}

impl Default for Options {
    fn default() -> Self {
        Self { threads: 0, cache_bytes: 1 << 30, host: Arc::new(NoHost), store: None }
    }
}

/// One document being worked on.
pub struct Session {
    pub(crate) registry: Arc<Registry>,
    pub(crate) document: Document,
    pub(crate) options: Options,
    pub(crate) plan: Plan,
    pub(crate) nodes: Vec<NodeRun>,
    /// By output slot.
    pub(crate) values: Vec<Value>,
    pub(crate) memo: Memo,
    pub(crate) queue: Queue,
    pub(crate) dirty: Vec<u32>,
    /// Nodes that have something to say, or did not run.
    pub(crate) told: BTreeMap<u32, Told>,
    /// What `needed` was computed for.
    pub(crate) goals: Option<Vec<u32>>,
    /// The targets that the goals were found for, if all of them are known, with node and output index.
    pub(crate) asked: Option<Vec<(String, (usize, usize))>>,
    /// Some value was dropped at some time, so goals may lack theirs.
    pub(crate) evicted: bool,
    /// Nodes with file inputs: their files are looked at in every evaluation.
    pub(crate) readers: Vec<u32>,
    /// Mean nanoseconds per run by node type of the plan; 0: not known yet.
    pub(crate) costs: Vec<f64>,
    /// Values that the document does not know, by node and port.
    pub(crate) given: BTreeMap<(String, String), Tree>,
    /// Another number for every plan.
    pub(crate) stamp: u64,
    /// What went wrong with the store in this evaluation, with the node that it was about.
    pub(crate) faults: Mutex<Vec<(u32, StoreFault)>>,
    /// Of a type whose nodes are cheap: some result was so large that it is remembered all the same.
    pub(crate) remembered: Vec<bool>,
    pub(crate) events: Events,
    /// Nodes that the last evaluation looked at.
    pub(crate) last_size: usize,
    /// Room that the last evaluation has left.
    pub(super) spare: Spare,
    pool: OnceLock<Option<rayon::ThreadPool>>,
}

/// So many names are compared before they are looked up.
const FEW: usize = 8;

/// Literals by node and port; `None`: none any more.
pub(super) type Literals = SmallVec<[(usize, usize, Option<Tree>); 1]>;

/// Whether every number of a value lies in its interface input's range, whatever unit it was written in.
pub(crate) fn check_range(name: &str, input: &InterfaceInput, tree: &Tree) -> Result<(), Diagnostic> {
    let number = |c: &Column, i: usize| c.get::<f64>(i).copied().or_else(|| c.get::<i64>(i).map(|v| *v as f64));
    let mut numbers = tree.branches().iter().flat_map(|(_, c)| (0..c.len()).filter_map(move |i| number(c, i)));
    let outside = |v: &f64| input.min.is_some_and(|min| *v < min) || input.max.is_some_and(|max| *v > max);
    let Some(v) = numbers.find(outside) else { return Ok(()) };
    let unit = input.unit.as_deref().map(|u| format!(" {u}")).unwrap_or_default();
    let end = |v: Option<f64>| v.map_or_else(|| "anything".to_owned(), |v| v.to_string());
    let message = format!("{name} = {v}{unit} is outside {} to {}{unit}", end(input.min), end(input.max));
    Err(Diagnostic::error("out-of-range", message))
}

/// Nothing is called `name` that a value could be given.
pub(crate) fn no_input(document: &Document, name: &str) -> Diagnostic {
    let hint = did_you_mean(name, document.inputs.keys().map(String::as_str));
    let names: Vec<&str> = document.inputs.keys().map(String::as_str).collect();
    let hint = hint.or_else(|| (!names.is_empty()).then(|| format!("there are {}", names.join(", "))));
    Diagnostic::error("unknown-name", format!("the graph has no input \"{name}\"")).maybe_hint(hint)
}

/// What an operation renames, from and to, in that order: by name, or, as taking such a step back does, by taking a node away
/// and putting the same at another id.
fn renames(operation: &Operation, document: &Document) -> Vec<(String, String)> {
    let mut all = Vec::new();
    let mut gone: Vec<(&str, &Node)> = Vec::new();
    let mut put: BTreeMap<&str, &Node> = BTreeMap::new();
    for part in operation.parts() {
        match part {
            Operation::Rename { from, to } => all.push((from.clone(), to.clone())),
            Operation::PutNode { id, node: None } => {
                gone.extend(put.remove(id.as_str()).or_else(|| document.nodes.get(id)).map(|node| (id.as_str(), node)));
            }
            Operation::PutNode { id, node: Some(node) } => {
                // Its wires may go by other names now.
                let same = |n: &Node| (&n.type_name, n.state, &n.params) == (&node.type_name, node.state, &node.params);
                if let Some(at) = gone.iter().position(|(_, n)| same(n)) {
                    all.push((gone.remove(at).0.to_owned(), id.clone()));
                }
                put.insert(id, node);
            }
            _ => {}
        }
    }
    all
}

/// The id that a node had before nodes were renamed in that order, none if it was not there. What is within an instance
/// follows it.
fn former<'a>(id: &'a str, renames: &'a [(String, String)]) -> Option<Cow<'a, str>> {
    let now = id.split('/').next().unwrap_or(id);
    let mut first = now;
    for (from, to) in renames.iter().rev() {
        if first == to {
            first = from;
        } else if first == from {
            return None;
        }
    }
    Some(if first == now { Cow::Borrowed(id) } else { Cow::Owned(format!("{first}{}", &id[now.len()..])) })
}

impl Session {
    /// A session; nothing runs yet. What is wrong with the document shows in [`Document::validate`] and in reports.
    /// Nodes of older versions are migrated. O(nodes + wires).
    #[must_use]
    pub fn new(registry: Arc<Registry>, mut document: Document, options: Options) -> Self {
        document.read_links(&*options.host);
        let told = document.migrate(&registry);
        document.pack(&registry);
        let mut plan = Plan::compile(&document, &registry);
        plan.add(told);
        let mut session = Self {
            queue: Queue::new(0, 0),
            nodes: Vec::new(),
            values: Vec::new(),
            dirty: Vec::new(),
            told: BTreeMap::new(),
            goals: None,
            asked: None,
            evicted: false,
            readers: Vec::new(),
            costs: Vec::new(),
            remembered: Vec::new(),
            given: BTreeMap::new(),
            registry,
            document,
            options,
            memo: Memo::default(),
            stamp: 0,
            last_size: 0,
            spare: Spare::default(),
            faults: Mutex::default(),
            events: Events::new(plan.ids.clone()),
            plan,
            pool: OnceLock::new(),
        };
        session.reset();
        session
    }

    fn reset(&mut self) {
        self.stamp += 1;
        let count = self.plan.nodes.len();
        self.queue = Queue::new(self.plan.levels, count);
        self.nodes = vec![NodeRun { dirty: true, ..NodeRun::default() }; count];
        self.values = vec![Value::Nothing; self.plan.output_node.len()];
        self.dirty = (0..count as u32).collect();
        self.told.clear();
        self.goals = None;
        self.asked = None;
        self.readers = (0..count as u32).filter(|n| self.plan.nodes[*n as usize].has_files).collect();
        self.costs = vec![0.0; self.plan.types.len()];
        self.remembered = vec![false; self.plan.types.len()];
    }

    /// The document as it stands, parameters set so far included.
    #[must_use]
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The registry.
    #[must_use]
    pub fn registry(&self) -> &Arc<Registry> {
        &self.registry
    }

    /// Exchanges the document; what nodes had last and remembered results stay, so only what is new runs, and frozen nodes
    /// keep their outputs.
    /// O(nodes + wires).
    pub fn replace(&mut self, document: Document) {
        self.replace_renamed(document, &[]);
    }

    /// As [`Session::replace`]; nodes that were given other ids keep what they had. O(nodes × renames + wires).
    fn replace_renamed(&mut self, mut document: Document, renames: &[(String, String)]) {
        document.read_links(&*self.options.host);
        let told = document.migrate(&self.registry);
        let mut plan = Plan::compile(&document, &self.registry);
        plan.add(told);
        let old_plan = std::mem::replace(&mut self.plan, plan);
        self.events.renumber(self.plan.ids.clone());
        self.document = document;
        let (old_nodes, mut old_values) = (std::mem::take(&mut self.nodes), std::mem::take(&mut self.values));
        let mut old_told = std::mem::take(&mut self.told);
        self.reset();
        self.place_all_given();
        for n in 0..self.plan.nodes.len() {
            let Some(o) = former(&self.plan.ids[n], renames).and_then(|id| old_plan.find(&id)) else { continue };
            let (new, old) = (&self.plan.nodes[n], &old_plan.nodes[o]);
            let same = self.plan.node_type(n).zip(old_plan.node_type(o)).is_some_and(|(a, b)| a.digest == b.digest);
            // What it had last stays if it is frozen now or later, and holds as long as what comes in is the same. Without
            // a key it was bypassed: then it has nothing of its own.
            let run = &old_nodes[o];
            if same && run.present && run.status == Status::Good && run.key != Packed::default() {
                for i in 0..new.output_count as usize {
                    let value = std::mem::take(&mut old_values[old.outputs as usize + i]);
                    self.values[new.outputs as usize + i] = value;
                }
                self.nodes[n] = NodeRun { dirty: true, ..*run };
                if let Some(told) = old_told.remove(&(o as u32)) {
                    self.told.insert(n as u32, told);
                }
            }
        }
    }

    /// Looks again at the files that clusters are linked from; true if one of them has changed, so that the plan was made
    /// anew. O(bytes of linked files), and as [`Session::replace`] if so.
    pub fn refresh_links(&mut self) -> bool {
        let before = self.document.linked.clone();
        self.document.read_links(&*self.options.host);
        let changed = before.differs(&self.document.linked);
        if changed {
            let document = std::mem::take(&mut self.document);
            self.replace(document);
        }
        changed
    }

    /// Sets an interface input or a parameter (`node.port`); `null` brings the default back. Nothing runs yet, so many
    /// can be set at once.
    ///
    /// # Errors
    /// If there is no such name, the port has a wire, or the value is not accepted; then nothing has changed.
    pub fn set(&mut self, name: &str, value: Json) -> Result<(), Diagnostic> {
        let mut addresses: SmallVec<[Cow<'_, str>; 1]> = SmallVec::new();
        if let Some(input) = self.document.inputs.get(name) {
            addresses.extend(input.ports.iter().cloned().map(Cow::Owned));
        } else if name.contains('.') {
            addresses.push(Cow::Borrowed(name));
        } else {
            return Err(no_input(&self.document, name));
        }
        let params = || addresses.iter().map(|address| split_port(address).unwrap_or((address, "")));
        let mut trees = Literals::new();
        for (address, (id, port)) in addresses.iter().zip(params()) {
            let found = self.plan.find_inputs(address)?;
            if self.plan.has_instances() && !self.document.nodes.contains_key(id) {
                return Err(self.inside_cluster(id, port));
            }
            for (n, p) in found {
                let id = &self.plan.ids[n];
                if self.plan.slot(n, p).is_wired() {
                    let message = format!("{id}.{port} has a wire, which overrules a value");
                    return Err(Diagnostic::error("wired-input", message).at(id).port(port));
                }
                trees.push((n, p, self.checked(name, n, p, &value)?));
            }
        }
        // Without its value, what stands inside a cluster counts again: that only the definition knows.
        let anew = value.is_null() && params().any(|(id, _)| self.plan.is_instance(id));
        for (id, port) in params() {
            if !self.given.is_empty() {
                self.given.remove(&(id.to_owned(), port.to_owned()));
            }
            let Some(node) = self.document.node_mut(id) else { continue };
            if value.is_null() {
                node.params.remove(port);
            } else if let Some(old) = node.params.get_mut(port) {
                *old = value.clone().into();
            } else {
                node.params.insert(port, value.clone());
            }
        }
        if anew {
            let document = std::mem::take(&mut self.document);
            self.replace(document);
            return Ok(());
        }
        self.place(trees, &value);
        Ok(())
    }

    /// What a value stands for at a port; none for `null`.
    fn checked(&self, name: &str, n: usize, p: usize, value: &Json) -> Result<Option<Tree>, Diagnostic> {
        if value.is_null() {
            return Ok(None);
        }
        let tree = self.plan.literal(&self.document, n, p, value);
        let tree = tree.map_err(|fail| fail.at(Severity::Error, &self.plan.ids[n]))?;
        if let Some(input) = self.document.inputs.get(name) {
            check_range(name, input, &tree)?;
        }
        Ok(Some(tree))
    }

    /// Puts one literal at ports, and formulas that depend on it.
    pub(super) fn place(&mut self, trees: Literals, value: &Json) {
        let places: Places = trees.iter().map(|(n, p, _)| (*n, *p)).collect();
        for (n, p, tree) in trees {
            self.plan.set_literal(n, p, tree);
            self.plan.note_formula(n, p, value);
            self.mark_dirty(n as u32);
        }
        for n in self.plan.renew_formulas(&self.document, &places) {
            self.mark_dirty(n);
        }
    }

    fn inside_cluster(&self, id: &str, port: &str) -> Diagnostic {
        let message = format!("{id}.{port} is inside a cluster, whose instances share what stands in it");
        let hint = match self.plan.entrance(id, port) {
            Some(outer) => format!("set {outer}"),
            None => "make it an input of the cluster, or change the cluster itself".into(),
        };
        Diagnostic::error("inside-cluster", message).at(id).port(port).hint(hint)
    }

    /// Changes the document; many operations go in one [`Operation::All`]. Nothing runs yet, and what was computed and is
    /// still valid stays. Gives the operation that takes the change back. Positions, remarks and groups cost O(log n),
    /// parameters O(log n) each, the rest O(nodes + wires).
    ///
    /// # Errors
    /// If an operation is refused; then nothing has changed.
    pub fn edit(&mut self, operation: &Operation) -> Result<Operation, Diagnostic> {
        let renames = renames(operation, &self.document);
        let inverse = operation.apply(&mut self.document)?;
        self.forget_given(operation);
        use Operation as O;
        let silent = |o: &Operation| {
            matches!(
                o,
                O::Move { .. }
                    | O::SetLook { .. }
                    | O::SetNote { .. }
                    | O::SetForeign { .. }
                    | O::SetGroup { .. }
                    | O::SetEntry { .. }
            )
        };
        let seen = |o: &&Operation| match o {
            O::InCluster { operation, .. } => !operation.parts().all(silent),
            o => !silent(o),
        };
        let params = operation.parts().filter(seen).map(|o| match o {
            Operation::SetParam { node, port, value } => {
                self.literals(node, port, value.as_ref()).map(|l| (l, value.clone().unwrap_or_default()))
            }
            _ => None,
        });
        match params.collect::<Option<Vec<_>>>() {
            Some(params) => {
                for (trees, value) in params {
                    self.place(trees, &value);
                }
            }
            None => {
                let document = std::mem::take(&mut self.document);
                self.replace_renamed(document, &renames);
            }
        }
        Ok(inverse)
    }

    /// Where a parameter goes and what it is, if it can be set without compiling the plan anew.
    fn literals(&self, node: &str, port: &str, value: Option<&Json>) -> Option<Literals> {
        if value.is_none() && self.plan.is_instance(node) {
            return None;
        }
        let places = self.plan.find_inputs(&format!("{node}.{port}")).ok()?;
        let one = |(n, p): (usize, usize)| {
            let wired = self.plan.slot(n, p).is_wired();
            let tree = value.map(|v| self.plan.node_type(n)?.inputs[p].literal(v).ok());
            if wired || tree == Some(None) { None } else { Some((n, p, tree.flatten())) }
        };
        places.into_iter().map(one).collect()
    }

    pub(crate) fn mark_dirty(&mut self, n: u32) {
        let node = &mut self.nodes[n as usize];
        if !node.dirty {
            node.dirty = true;
            self.dirty.push(n);
        }
    }

    /// Node and output index of an interface output or `node.port`.
    pub(crate) fn find_value(&self, name: &str) -> Result<(usize, usize), Diagnostic> {
        if let Some(output) = self.document.outputs.get(name) {
            return self.plan.find_output(&output.port);
        }
        if name.contains('.') {
            return self.plan.find_output(name);
        }
        let hint = did_you_mean(name, self.document.outputs.keys().map(String::as_str));
        let names: Vec<&str> = self.document.outputs.keys().map(String::as_str).collect();
        let hint = hint.or_else(|| (!names.is_empty()).then(|| format!("there are {}", names.join(", "))));
        Err(Diagnostic::error("unknown-name", format!("the graph has no output \"{name}\"")).maybe_hint(hint))
    }

    /// Whether `name` is an interface output or the `node.port` of an output.
    ///
    /// # Errors
    /// Says what is not known and which name comes nearest.
    pub fn knows(&self, name: &str) -> Result<(), Diagnostic> {
        self.find_value(name).map(|_| ())
    }

    /// The value of an interface output or of `node.port` as the last evaluation left it; `None` if it was not asked for, failed
    /// or was dropped from memory.
    #[must_use]
    pub fn value(&self, name: &str) -> Option<Tree> {
        // What is read is nearly always what was asked for, and little was.
        let mut asked = self.asked.iter().flatten().take(FEW);
        let found = asked.find(|(asked, _)| asked == name).map(|(_, place)| *place);
        let (n, o) = found.or_else(|| self.find_value(name).ok())?;
        let run = &self.nodes[n];
        // Nobody has asked for it, and it may be out of date.
        if run.dirty && !run.needed && self.plan.nodes[n].state != NodeState::Frozen {
            return None;
        }
        self.values[self.plan.nodes[n].outputs as usize + o].tree().cloned()
    }

    /// The files that the writers made in the last evaluation, with the `node.port` that made them, in order of node
    /// ids. Writers that were not asked for, failed or are out of date are left out.
    #[must_use]
    pub fn files(&self) -> Vec<(String, File)> {
        let mut files = Vec::new();
        for (n, run) in self.nodes.iter().enumerate() {
            let Some(t) = self.plan.node_type(n).filter(|t| t.writer) else { continue };
            if run.status != Status::Good || run.dirty {
                continue;
            }
            for (o, port) in t.outputs.iter().enumerate() {
                let Some(tree) = self.values[self.plan.nodes[n].outputs as usize + o].tree() else { continue };
                for (_, column) in tree.branches() {
                    let found = (0..column.len()).filter_map(|i| column.get::<File>(i));
                    files.extend(found.map(|f| (format!("{}.{}", &self.plan.ids[n], port.name), f.clone())));
                }
            }
        }
        files
    }

    /// Takes the log of everything since it was last taken.
    pub fn take_events(&mut self) -> Events {
        self.events.take()
    }

    /// Keeps remembered results within so many bytes from the next evaluation on, instead of [`Options::cache_bytes`].
    /// Neither counts what cheap nodes, frozen nodes and targets have at their outputs.
    pub fn limit_cache(&mut self, bytes: usize) {
        self.options.cache_bytes = bytes;
    }

    /// Bytes of remembered results.
    #[must_use]
    pub fn cache_bytes(&self) -> usize {
        self.memo.bytes
    }

    /// How lists of different lengths meet at a node, as the plan has it.
    #[must_use]
    pub fn matching(&self, node: &str) -> Option<Matching> {
        self.plan.find(node).map(|n| self.plan.nodes[n].matching)
    }

    /// The session's thread pool; `None` if the system gives no threads.
    pub(crate) fn pool(&self) -> Option<&rayon::ThreadPool> {
        self.pool
            .get_or_init(|| rayon::ThreadPoolBuilder::new().num_threads(self.options.threads).build().ok())
            .as_ref()
    }
}
