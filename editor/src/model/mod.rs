//! What the window works on, without any window: the document with its history, what is selected, what the evaluation
//! found. Every change of the document is an operation of the engine's and goes through [`Model::apply`].

pub mod arrange;
pub mod catalog;
pub mod cut;
pub mod file;
pub mod handle;
pub mod keep;
pub mod param;
pub mod results;
pub mod worker;

use catalog::Catalog;
use results::Results;
use std::collections::BTreeSet;
use std::path::{Path, PathBuf};
use std::sync::Arc;
use tenon_engine::{
    Diagnostic, Document, History, Literal, Name, NoHost, Node, NodeState, Operation, OuterWires, Registry,
};
use worker::{Update, Worker};

/// One graph being worked on.
pub struct Model {
    /// All node types, the document's clusters among them.
    pub catalog: Catalog,
    registry: Arc<Registry>,
    document: Document,
    history: History,
    worker: Worker,
    /// What the evaluation found.
    pub results: Results,
    /// Ids of the selected nodes.
    pub selection: BTreeSet<String>,
    /// Nodes whose preview was switched by hand, with what it was switched to.
    previews: std::collections::BTreeMap<String, bool>,
    shown: Vec<String>,
    path: Option<PathBuf>,
    /// Counts changes of the document.
    revision: u64,
    /// Canonical text and layout as they were last read or written.
    saved: (String, String),
    /// The revision that `unsaved` was found for, and what was found.
    compared: (u64, bool),
    keeper: keep::Keeper,
    /// Where unsaved work without a file and the list of recent graphs are kept; none: nowhere.
    pub state: Option<PathBuf>,
    /// What went wrong last, for people.
    pub message: Option<Diagnostic>,
}

impl Model {
    /// An empty graph; `wake` is called from another thread whenever there is something new to [`Model::poll`].
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let registry = Arc::new(tenon_nodes::registry());
        let mut model = Self {
            catalog: Catalog::new(&registry),
            worker: Worker::start(registry.clone(), wake)?,
            registry,
            document: Document::new(),
            history: History::default(),
            results: Results::default(),
            selection: BTreeSet::new(),
            previews: std::collections::BTreeMap::new(),
            shown: Vec::new(),
            path: None,
            revision: 0,
            saved: (String::new(), String::new()),
            compared: (0, false),
            keeper: keep::Keeper::default(),
            state: None,
            message: None,
        };
        model.take(Document::new(), None);
        Ok(model)
    }

    /// The document.
    #[must_use]
    pub fn document(&self) -> &Document {
        &self.document
    }

    /// The graph's file, once it has one.
    #[must_use]
    pub fn path(&self) -> Option<&Path> {
        self.path.as_deref()
    }

    /// A number that changes with every change of the document.
    #[must_use]
    pub fn revision(&self) -> u64 {
        self.revision
    }

    /// Opens a graph file, or the only graph of a folder.
    ///
    /// # Errors
    /// What keeps it from being read; then the graph that was open stays.
    pub fn open(&mut self, path: &Path) -> Result<(), Vec<Diagnostic>> {
        let path = file::find(path).map_err(|d| vec![d])?;
        let (document, told) = file::load(&path)?;
        self.message = told.into_iter().next();
        self.take(document, Some(path));
        self.remember();
        Ok(())
    }

    /// Begins an empty graph.
    pub fn clear(&mut self) {
        self.take(Document::new(), None);
    }

    fn take(&mut self, mut document: Document, path: Option<PathBuf>) {
        self.saved = (document.to_string_canonical_for(&self.registry), document.layout_to_string());
        // The session migrates its copy in the same way, and tells what fails.
        document.migrate(&self.registry);
        let folder = path.as_deref().and_then(Path::parent).map(Path::to_owned);
        let host: Arc<dyn tenon_engine::Host> = match folder {
            Some(folder) => Arc::new(file::Folder(folder)),
            None => Arc::new(NoHost),
        };
        document.read_links(&*host);
        self.catalog.take_clusters(&document, &self.registry);
        self.path = path;
        self.document = document;
        self.history = History::default();
        self.selection.clear();
        self.previews.clear();
        self.results = Results::default();
        self.revision += 1;
        // What is shown goes first: asked for afterwards it would stop what has just begun.
        self.shown = Vec::new();
        self.show();
        self.worker.open(self.document.clone(), host);
        self.note_file();
    }

    /// Writes the graph and its layout; to `path` from now on, if one is given.
    ///
    /// # Errors
    /// If there is no path yet, or a file cannot be written.
    pub fn save(&mut self, path: Option<&Path>) -> Result<(), Diagnostic> {
        let Some(path) = path.map(Path::to_owned).or_else(|| self.path.clone()) else {
            return Err(Diagnostic::error("no-path", "the graph has no file yet").hint("save it under a name"));
        };
        let texts = (self.document.to_string_canonical_for(&self.registry), self.document.layout_to_string());
        let layout = file::layout_path(&path);
        for (path, text) in [(&path, &texts.0), (&layout, &texts.1)] {
            file::write_whole(path, text.as_bytes())
                .map_err(|e| Diagnostic::error("unwritable", format!("{} cannot be written: {e}", path.display())))?;
        }
        self.forget_kept();
        let moved = self.path.as_deref().and_then(Path::parent) != path.parent();
        self.saved = texts;
        self.compared = (self.revision, false);
        self.path = Some(path.clone());
        self.note_file();
        self.remember();
        if moved {
            // Files that nodes name lie elsewhere now.
            let folder = path.parent().map(Path::to_owned).unwrap_or_default();
            self.worker.open(self.document.clone(), Arc::new(file::Folder(folder)));
            self.worker.show(self.shown.clone());
        }
        Ok(())
    }

    /// Whether the document differs from its file. O(document) after a change, else O(1).
    pub fn unsaved(&mut self) -> bool {
        if self.compared.0 != self.revision {
            let differs = self.document.to_string_canonical_for(&self.registry) != self.saved.0
                || self.document.layout_to_string() != self.saved.1;
            self.compared = (self.revision, differs);
        }
        self.compared.1
    }

    /// Puts nodes without a place where `places` says, which is no step of the history.
    pub fn place(&mut self, places: impl IntoIterator<Item = (String, [f64; 2])>) {
        let before = self.document.layout_to_string();
        for (node, to) in places {
            // It is refused only for nodes that are not there.
            let _ = Operation::Move { node, to: Some(to) }.apply(&mut self.document);
        }
        if self.saved.1 == before {
            self.saved.1 = self.document.layout_to_string();
        }
        self.revision += 1;
    }

    /// Changes the document as one step.
    ///
    /// # Errors
    /// If the operation is refused; then nothing has changed.
    pub fn apply(&mut self, operation: Operation) -> Result<(), Diagnostic> {
        let inverse = operation.apply(&mut self.document)?;
        self.history.record(inverse);
        self.changed(operation);
        Ok(())
    }

    /// Changes the document as one step; a refusal is told in [`Model::message`]. False if it was refused.
    pub fn edit(&mut self, operation: Operation) -> bool {
        match self.apply(operation) {
            Ok(()) => true,
            Err(refused) => {
                self.message = Some(refused);
                false
            }
        }
    }

    fn changed(&mut self, operation: Operation) {
        self.revision += 1;
        self.message = None;
        if worker::touches_clusters(&operation) {
            self.catalog.take_clusters(&self.document, &self.registry);
        }
        self.selection.retain(|id| self.document.nodes().contains_key(id));
        self.worker.edit(operation);
        self.show();
    }

    /// From here to [`Model::end`] all changes are one step.
    pub fn begin(&mut self) {
        self.history.begin();
    }

    /// Ends what [`Model::begin`] began.
    pub fn end(&mut self) {
        self.history.commit();
    }

    /// Takes the last step back; false if there is none.
    pub fn undo(&mut self) -> bool {
        self.step(|history, apply| history.undo_by(apply))
    }

    /// Does the step again that was taken back last; false if there is none.
    pub fn redo(&mut self) -> bool {
        self.step(|history, apply| history.redo_by(apply))
    }

    fn step(
        &mut self,
        by: impl FnOnce(
            &mut History,
            &mut dyn FnMut(&Operation) -> Result<Operation, Diagnostic>,
        ) -> Result<bool, Diagnostic>,
    ) -> bool {
        let (mut done, document) = (None, &mut self.document);
        let result = by(&mut self.history, &mut |operation| {
            let inverse = operation.apply(document)?;
            done = Some(operation.clone());
            Ok(inverse)
        });
        if let Err(refused) = &result {
            self.message = Some(refused.clone());
        }
        if let Some(done) = done {
            self.changed(done);
        }
        result.unwrap_or(false)
    }

    /// Steps that can be taken back, and steps that can be done again.
    #[must_use]
    pub fn steps(&self) -> (usize, usize) {
        self.history.steps()
    }

    /// Takes what the evaluation has to tell; true if something is new.
    pub fn poll(&mut self) -> bool {
        let mut news = false;
        while let Some(update) = self.worker.poll() {
            news = true;
            if let Update::Lost(diagnostic) = &update {
                debug_assert!(false, "the session refused what the document took: {diagnostic}");
                let folder = self.path.as_deref().and_then(Path::parent).map(Path::to_owned).unwrap_or_default();
                self.worker.open(self.document.clone(), Arc::new(file::Folder(folder)));
            }
            self.results.take(update);
        }
        news
    }

    /// Whether what the evaluation found is of the document as it stands.
    #[must_use]
    pub fn settled(&self) -> bool {
        self.results.settled(self.worker.revision())
    }

    /// Stops the evaluation; what was found before stays.
    pub fn cancel(&self) -> bool {
        self.worker.cancel()
    }

    /// Evaluates once more: after it was stopped, or when files that nodes read have changed.
    pub fn again(&mut self) {
        self.worker.again();
    }

    /// Whether the viewport shows what a node makes. Until somebody says otherwise: meshes only where nothing follows,
    /// since what follows is made of them; everything else that can be seen always.
    #[must_use]
    pub fn previews(&self, id: &str) -> bool {
        self.previews.get(id).copied().unwrap_or(true)
    }

    /// Shows or hides what a node makes.
    pub fn set_preview(&mut self, id: &str, show: bool) {
        self.previews.insert(id.to_owned(), show);
        self.show();
    }

    /// Tells the worker what the viewport shows, if that has changed. O(nodes + wires).
    fn show(&mut self) {
        let mut followed = BTreeSet::new();
        for node in self.document.nodes().values() {
            followed.extend(node.inputs.values().flat_map(|w| w.from.iter().map(Name::as_str)));
        }
        let mut shown = Vec::new();
        for (id, node) in self.document.nodes() {
            let Some(info) = self.catalog.get(&node.type_name) else { continue };
            if node.state == NodeState::Disabled || !self.previews(id) {
                continue;
            }
            for (o, port) in info.outputs.iter().enumerate() {
                let address = format!("{id}.{}", port.name);
                // The points of a curve are seen by the curve.
                let first = info.outputs.iter().position(|p| crate::scene::VISIBLE.contains(&p.type_name.as_str()));
                let by_hand = self.previews.contains_key(id);
                let covered = port.type_name == "mesh" && followed.contains(address.as_str()) && !by_hand;
                if first == Some(o) && !covered {
                    shown.push(address);
                }
            }
        }
        if shown != self.shown {
            self.shown.clone_from(&shown);
            self.worker.show(shown);
        }
    }

    /// An id that no node has, made from the name of a type: `point`, `point-2` …
    #[must_use]
    pub fn free_id(&self, type_name: &str) -> String {
        let stem = type_name.strip_prefix("cluster:").unwrap_or(type_name).replace(['.', '/'], "_");
        let taken = |id: &str| self.document.nodes().contains_key(id);
        if !taken(&stem) {
            return stem;
        }
        (2u64..).map(|n| format!("{stem}-{n}")).find(|id| !taken(id)).unwrap_or(stem)
    }

    /// The operation that adds a node of a type at a place, and the id that it gets.
    #[must_use]
    pub fn new_node(&self, type_name: &str, at: [f64; 2]) -> (String, Operation) {
        let id = self.free_id(type_name);
        let mut node = Node::new(type_name);
        node.version = self.catalog.get(type_name).map_or(1, |t| t.version);
        let add = Operation::AddNode { id: id.clone(), node: Box::new(node) };
        let put = Operation::Move { node: id.clone(), to: Some(at.map(f64::round)) };
        (id, Operation::All(vec![add, put]))
    }

    /// The operation that brings a wire from an output to an input: at an input for single items it takes the place of
    /// the one that was there, at one for lists it comes last.
    #[must_use]
    pub fn new_wire(&self, from: &str, node: &str, port: &str) -> Operation {
        let connect = Operation::Connect { node: node.into(), port: port.into(), from: from.into(), at: None };
        let there = self.document.nodes().get(node).and_then(|n| n.inputs.get(port)).map_or(&[][..], |w| &w.from);
        let info = self.document.nodes().get(node).map(|n| self.catalog.of(n));
        let single = info.and_then(|t| t.inputs.iter().find(|p| p.name == port).map(|p| p.access))
            == Some(tenon_engine::Access::Item);
        if !single || there.is_empty() {
            return connect;
        }
        let gone =
            there.iter().map(|f| Operation::Disconnect { node: node.into(), port: port.into(), from: f.to_string() });
        Operation::All(gone.chain([connect]).collect())
    }

    /// The selected nodes as the text of a graph, for the clipboard; `None` if nothing is selected.
    #[must_use]
    pub fn copy(&self) -> Option<String> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let fragment = self.document.copy(&ids).ok().filter(|_| !ids.is_empty())?;
        let mut text = fragment.to_string_canonical();
        // The layout follows the graph in the same text, as a second value.
        text.push_str(&fragment.layout_to_string());
        Some(text)
    }

    /// Puts copied nodes into the graph, moved by `offset`, and selects them.
    ///
    /// # Errors
    /// If the text is no graph, or what it says is refused.
    pub fn paste(&mut self, text: &str, offset: [f64; 2]) -> Result<(), Diagnostic> {
        let (graph, layout) = split_layout(text);
        let mut fragment = Document::from_slice(graph.as_bytes()).map_err(|all| {
            let first = all.into_iter().next().map_or_else(String::new, |d| d.message);
            Diagnostic::error("no-graph", format!("what was copied is no graph: {first}"))
        })?;
        if !layout.is_empty() {
            fragment.read_layout(layout.as_bytes())?;
        }
        self.insert(&fragment, OuterWires::Keep, offset)
    }

    fn insert(&mut self, fragment: &Document, outer: OuterWires, offset: [f64; 2]) -> Result<(), Diagnostic> {
        let paste = self.document.paste(fragment, outer, offset);
        self.apply(paste.operation)?;
        self.selection = paste.ids.into_values().collect();
        Ok(())
    }

    /// Puts copies of the selected nodes beside them and selects those.
    ///
    /// # Errors
    /// If the document refuses them.
    pub fn duplicate(&mut self, offset: [f64; 2]) -> Result<(), Diagnostic> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let fragment = self.document.copy(&ids)?;
        self.insert(&fragment, OuterWires::Keep, offset)
    }

    /// Removes the selected nodes with their wires.
    pub fn delete_selection(&mut self) {
        let all = self.selection.iter().map(|id| Operation::RemoveNode { id: id.clone() }).collect();
        if !self.selection.is_empty() {
            self.edit(Operation::All(all));
        }
    }

    /// Makes a cluster of the selected nodes, with one instance in their place, and selects that.
    ///
    /// # Errors
    /// If a port takes wires both from selected nodes and from others.
    pub fn gather(&mut self) -> Result<(), Diagnostic> {
        let ids: Vec<&str> = self.selection.iter().map(String::as_str).collect();
        let places: Vec<[f64; 2]> = ids.iter().filter_map(|id| self.document.position(id)).collect();
        let taken = |n: &str| self.document.clusters.contains_key(n) || self.document.nodes().contains_key(n);
        let name = (1u64..).map(|n| format!("cluster-{n}")).find(|n| !taken(n)).unwrap_or_default();
        let gather = self.document.gather(&ids, &name, &name)?;
        let middle = [0, 1].map(|k| (places.iter().map(|p| p[k]).sum::<f64>() / places.len().max(1) as f64).round());
        let put = Operation::Move { node: name.clone(), to: Some(middle) };
        self.apply(Operation::All(vec![gather, put]))?;
        self.selection = [name].into();
        Ok(())
    }

    /// Puts the nodes of a cluster in the place of one of its instances and selects them.
    ///
    /// # Errors
    /// If it is no instance, or its definition cannot be used.
    pub fn explode(&mut self, instance: &str) -> Result<(), Diagnostic> {
        let paste = self.document.explode(instance, &self.registry)?;
        self.apply(paste.operation)?;
        self.selection = paste.ids.into_values().collect();
        Ok(())
    }

    /// What a node's parameter is set to.
    #[must_use]
    pub fn param(&self, id: &str, port: &str) -> Option<tenon_engine::Json> {
        self.document.nodes().get(id)?.params.get(port).map(Literal::to_json)
    }
}

/// A graph's text and its layout's, which may follow it in one text.
fn split_layout(text: &str) -> (&str, &str) {
    match text.rfind("{\n  \"format\": \"tenon-layout\"") {
        Some(at) => text.split_at(at),
        None => (text, ""),
    }
}
