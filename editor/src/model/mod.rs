//! What the window works on, without any window: the document with its history, what is selected, what the evaluation
//! found. Every change of the document is an operation of the engine's and goes through [`Model::apply`].

pub mod arrange;
pub mod arrives;
pub mod beside;
pub mod catalog;
pub mod critical;
pub mod cut;
mod edit;
mod export;
pub mod file;
pub mod handle;
pub mod inside;
mod interface;
pub mod keep;
pub mod param;
pub mod play;
pub mod plugins;
mod reach;
pub mod results;
pub mod salvage;
mod slot;
mod watch;
pub mod words;
pub mod worker;

use catalog::Catalog;
use inside::Entered;
use plugins::Plugins;
use results::Results;
use std::borrow::Cow;
use std::collections::{BTreeSet, HashMap};
use std::path::{Path, PathBuf};
use std::sync::Arc;
use std::time::{Duration, Instant};
use tenon_engine::{Diagnostic, Document, History, Host, Name, NoHost, NodeState, Operation, Registry};
use tenon_nodes::host::graph::{Files, GraphError};
use tenon_nodes::host::output;
use worker::{Update, Worker};

/// How often the document is compared with its file while it changes all the time.
const LOOK: Duration = Duration::from_millis(400);

/// One graph being worked on.
pub struct Model {
    /// All node types, the document's clusters among them.
    pub catalog: Catalog,
    registry: Arc<Registry>,
    plugins: Plugins,
    document: Document,
    inside: Vec<Entered>,
    history: History,
    worker: Worker,
    /// What the evaluation found.
    pub results: Results,
    typed: Option<Operation>,
    /// How many graphs were opened or begun.
    opened: u64,
    /// What was copied last, and on which canvas.
    copied: Option<(String, (u64, Option<String>))>,
    /// Ids of the selected nodes.
    pub selection: BTreeSet<String>,
    /// Where nodes stand that are only looked at: those of clusters of other files.
    places: HashMap<String, [f64; 2]>,
    shown: Vec<String>,
    path: Option<PathBuf>,
    /// Counts changes of the document.
    revision: u64,
    /// Canonical text and layout as they were last read or written.
    saved: (String, String),
    /// The revision that `unsaved` was found for, and what was found.
    compared: (u64, bool),
    /// When that was.
    compared_at: Option<Instant>,
    keeper: keep::Keeper,
    watch: watch::Watch,
    exporting: Option<export::Exporting>,
    /// Asks for a frame, from any thread.
    wake: Arc<dyn Fn() + Send + Sync>,
    /// Where unsaved work without a file and the list of recent graphs are kept; none: nowhere.
    pub state: Option<PathBuf>,
    /// What of the graph could not be read from its file.
    lost: Option<salvage::Lost>,
    /// What went wrong last, for people.
    pub message: Option<Diagnostic>,
    /// What was done last without being asked in so many words, for people.
    pub said: Option<String>,
    /// The node and its input that a file is to be chosen for.
    pub wanted_file: Option<(String, String)>,
}

impl Model {
    /// An empty graph; `wake` is called from another thread whenever there is something new to [`Model::poll`].
    ///
    /// # Errors
    /// If the system gives no thread.
    pub fn new(wake: impl Fn() + Send + Sync + 'static) -> std::io::Result<Self> {
        let registry = Arc::new(tenon_nodes::registry());
        let wake: Arc<dyn Fn() + Send + Sync> = Arc::new(wake);
        let (worker_wakes, watch_wakes) = (wake.clone(), wake.clone());
        let mut model = Self {
            catalog: Catalog::new(&registry),
            worker: Worker::start(registry.clone(), move || worker_wakes())?,
            watch: watch::Watch::start(move || watch_wakes())?,
            exporting: None,
            wake,
            registry,
            plugins: Plugins::default(),
            document: Document::new(),
            inside: Vec::new(),
            history: History::default(),
            results: Results::default(),
            typed: None,
            opened: 0,
            copied: None,
            selection: BTreeSet::new(),
            places: HashMap::new(),
            shown: Vec::new(),
            path: None,
            revision: 0,
            saved: (String::new(), String::new()),
            compared: (0, false),
            compared_at: None,
            keeper: keep::Keeper::default(),
            state: None,
            lost: None,
            message: None,
            said: None,
            wanted_file: None,
        };
        model.take(Document::new(), None);
        Ok(model)
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
    pub fn open(&mut self, path: &Path) -> Result<(), GraphError> {
        let path = file::find(path)?;
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
        self.load_if_others(&document.requires);
        self.saved = (document.to_string_canonical_for(&self.registry), document.layout_to_string());
        // The session migrates its copy in the same way, and tells what fails.
        document.migrate(&self.registry);
        self.path = path;
        let host = self.host();
        document.read_links(&*host);
        self.catalog.take_clusters(&document, &self.registry);
        self.document = document;
        self.lost = None;
        self.opened += 1;
        self.typed = None;
        self.inside.clear();
        self.history = History::default();
        self.selection.clear();
        self.places.clear();
        self.results = Results::default();
        self.revision += 1;
        // Nothing is known yet of the graph that was opened, whatever was found of the one before it.
        self.compared_at = None;
        // What is shown goes first: asked for afterwards it would stop what has just begun.
        self.shown = Vec::new();
        self.show();
        self.worker.look_inside(Vec::new());
        self.worker.open(self.registry.clone(), self.document.clone(), host);
        self.note_file(self.path.is_some());
    }

    /// Who reads the files that nodes name: from the graph's folder, once it has one.
    fn host(&self) -> Arc<dyn Host> {
        match &self.path {
            Some(path) => Arc::new(Files::new(path, Default::default())),
            None => Arc::new(NoHost),
        }
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
            output::write_whole(path, text.as_bytes()).map_err(|e| Diagnostic::error(e.code(), e.to_string()))?;
        }
        self.forget_kept();
        let moved = self.path.as_deref().and_then(Path::parent) != path.parent();
        self.saved = texts;
        self.compared = (self.revision, false);
        self.path = Some(path.clone());
        self.note_file(false);
        self.remember();
        if moved {
            // Files that nodes name lie elsewhere now.
            self.worker.open(self.registry.clone(), self.document.clone(), self.host());
            self.worker.show(self.shown.clone());
        }
        Ok(())
    }

    /// What is being typed and is not in the document yet: it is unsaved work, and kept as such. O(1).
    pub fn set_typed(&mut self, typed: Option<Operation>) {
        if self.typed != typed {
            self.typed = typed;
            self.revision += 1;
        }
    }

    /// The document as it will be when what is being typed is in it.
    fn with_typed(&self) -> Cow<'_, Document> {
        let Some(typed) = &self.typed else { return Cow::Borrowed(&self.document) };
        let mut document = self.document.clone();
        // It is refused if its node has gone meanwhile.
        let _ = self.here(typed.clone()).apply(&mut document);
        Cow::Owned(document)
    }

    /// Whether the document differs from its file. O(document) after a change, else O(1).
    pub fn unsaved(&mut self) -> bool {
        if self.typed.is_some() {
            return true;
        }
        if self.compared.0 != self.revision {
            let differs = self.document.to_string_canonical_for(&self.registry) != self.saved.0
                || self.document.layout_to_string() != self.saved.1;
            self.compared = (self.revision, differs);
            self.compared_at = Some(Instant::now());
        }
        self.compared.1
    }

    /// The same for views that ask at every frame: while changes follow one another, as when a slider is dragged, they count as
    /// unsaved without a look. O(1) then.
    pub fn seems_unsaved(&mut self) -> bool {
        let soon = self.compared_at.is_some_and(|at| at.elapsed() < LOOK);
        (self.compared.0 != self.revision && soon) || self.unsaved()
    }

    /// Puts nodes without a place where `places` says, which is no step of the history.
    pub fn place(&mut self, places: impl IntoIterator<Item = (String, [f64; 2])>) {
        if self.linked().is_some() {
            self.places.extend(places);
            self.revision += 1;
            return;
        }
        let as_saved = !self.unsaved();
        for (node, to) in places {
            // It is refused only for nodes that are not there.
            let _ = self.here(Operation::Move { node, to: Some(to) }).apply(&mut self.document);
        }
        if as_saved {
            self.saved.1 = self.document.layout_to_string();
        }
        // It differs from its file as much as before.
        if self.compared.0 == self.revision {
            self.compared.0 += 1;
        }
        self.revision += 1;
    }

    /// An operation on what stands on the canvas, as one on the whole graph.
    fn here(&self, operation: Operation) -> Operation {
        match self.inside.last() {
            Some(e) => operation.inside(&e.cluster),
            None => operation,
        }
    }

    /// Changes what stands on the canvas as one step.
    ///
    /// # Errors
    /// If the operation is refused, or what stands on the canvas is another file's; then nothing has changed.
    pub fn apply(&mut self, operation: Operation) -> Result<(), Diagnostic> {
        self.check_inside(&operation)?;
        self.apply_to_whole(self.here(operation))
    }

    /// Changes the whole graph as one step, whatever stands on the canvas.
    ///
    /// # Errors
    /// If the operation is refused; then nothing has changed.
    pub fn apply_to_whole(&mut self, operation: Operation) -> Result<(), Diagnostic> {
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
        self.said = None;
        if worker::touches_clusters(&operation) {
            self.leave_what_is_gone();
            self.catalog_for_here();
        }
        let mut selection = std::mem::take(&mut self.selection);
        selection.retain(|id| self.document().nodes().contains_key(id));
        self.selection = selection;
        // What is shown follows from everything but values: while a slider moves it stays.
        let values_only = operation.parts().all(|o| matches!(o, Operation::SetParam { .. } | Operation::Move { .. }));
        self.worker.edit(operation);
        if !values_only {
            self.results.forget_what_is_gone(self.worker.revision());
            self.show();
        }
    }

    /// From here to [`Model::end`] all changes are one step.
    pub fn begin(&mut self) {
        self.history.begin();
    }

    /// Ends what [`Model::begin`] began.
    pub fn end(&mut self) {
        self.history.commit();
    }

    /// Ends whatever [`Model::begin`] began and nothing has ended.
    pub fn end_all(&mut self) {
        while self.history.is_open() {
            self.history.commit();
        }
    }

    /// Ends what [`Model::begin`] began and takes back all that was done since, as if it had never been.
    pub fn abort(&mut self) {
        let back = self.history.abandon();
        if back.parts().next().is_none() {
            return;
        }
        match back.apply(&mut self.document) {
            Ok(_) => self.changed(back),
            Err(refused) => self.message = Some(refused),
        }
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

    /// Takes what the evaluation has to tell, and plugins that were loaded; true if something is new.
    pub fn poll(&mut self) -> bool {
        let mut news = self.take_plugins();
        while let Some(update) = self.worker.poll() {
            news = true;
            if let Update::Lost(diagnostic) = &update {
                debug_assert!(false, "the session refused what the document took: {diagnostic}");
                self.worker.open(self.registry.clone(), self.document.clone(), self.host());
            }
            self.results.take(update, &self.document);
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

    /// Whether the evaluation was stopped at a node of the canvas, or inside it, and was not begun anew.
    #[must_use]
    pub fn was_stopped_at(&self, id: &str) -> bool {
        let at = self.results.stopped_at.as_ref().filter(|_| self.settled());
        at.and_then(|path| self.local(path)) == Some(id)
    }

    /// Whether a node runs now.
    #[must_use]
    pub fn is_running(&self) -> bool {
        self.worker.is_running()
    }

    /// Evaluates once more: after it was stopped, or when files that nodes read have changed.
    pub fn again(&mut self) {
        self.worker.again();
    }

    /// Whether the viewport shows what a node makes. Until somebody says otherwise: meshes only where nothing follows,
    /// since what follows is made of them; everything else that can be seen always.
    #[must_use]
    pub fn previews(&self, id: &str) -> bool {
        self.document().look(id).shown.unwrap_or(true)
    }

    /// Tells the worker what the viewport shows, if that has changed. O(nodes + wires).
    fn show(&mut self) {
        let mut followed = BTreeSet::new();
        let document = self.document();
        for node in document.nodes().values() {
            followed.extend(node.inputs.values().flat_map(|w| w.from.iter().map(Name::as_str)));
        }
        let mut shown = Vec::new();
        for (id, node) in document.nodes() {
            let Some(info) = self.catalog.get(&node.type_name) else { continue };
            if node.state == NodeState::Disabled || !self.previews(id) {
                continue;
            }
            for (o, port) in info.outputs.iter().enumerate() {
                let address = format!("{id}.{}", port.name);
                // The points of a curve are seen by the curve.
                let first = info.outputs.iter().position(|p| crate::scene::VISIBLE.contains(&p.type_name.as_str()));
                let by_hand = document.look(id).shown.is_some();
                let covered = crate::scene::YIELDS.contains(&port.type_name.as_str())
                    && followed.contains(address.as_str())
                    && !by_hand;
                if first == Some(o) && !covered {
                    shown.push(format!("{}.{}", self.path_of(id), port.name));
                }
            }
        }
        if shown != self.shown {
            self.shown.clone_from(&shown);
            self.worker.show(shown);
        }
    }
}

/// A graph's text and its layout's, which may follow it in one text.
fn split_layout(text: &str) -> (&str, &str) {
    // Only the braces around a whole text stand at the start of a line.
    match text.rfind("\n}\n{\n") {
        Some(at) => text.split_at(at + 3),
        None => (text, ""),
    }
}
