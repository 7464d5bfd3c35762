//! Node types and the registry: which nodes, item types and conversions there are.

use crate::call::Call;
use crate::diagnostic::{Diagnostic, Fail};
use crate::evaluate::simple::SIMPLE_PORTS;
use crate::port::{Access, ItemType, Port};
use crate::value::{Column, Digester, File, Item, Json, Text, Tree};
use std::any::TypeId;
use std::borrow::Cow;
use std::collections::{BTreeMap, BTreeSet, HashMap};
use std::sync::Arc;

type Run = Arc<dyn Fn(&mut Call<'_>) -> Result<(), Fail> + Send + Sync>;

/// What a node does and how it is described; a plain function plus its ports.
#[derive(Clone)]
pub struct NodeType {
    pub(crate) type_name: Arc<str>,
    pub(crate) version: u32,
    title: Cow<'static, str>,
    category: Cow<'static, str>,
    doc: Cow<'static, str>,
    keywords: Vec<Cow<'static, str>>,
    pub(crate) inputs: Vec<Port>,
    pub(crate) outputs: Vec<Port>,
    pub(crate) writer: bool,
    pub(crate) slow: bool,
    pub(crate) cheap: bool,
    pub(crate) run: Option<Run>,
    /// Filled by the registry: the trees of the inputs' defaults.
    pub(crate) defaults: Vec<Option<Tree>>,
    /// Filled by the registry: digest of name and version, the start of every cache key.
    pub(crate) digest: u128,
    /// Of what brings it; 0: this program.
    pub(crate) build: u128,
    /// Filled by the registry if single numbers are all that comes in, and one thing comes out: the bounds of each.
    pub(crate) numbers: Option<Box<[(f64, f64)]>>,
}

/// Nodes ask for their ports by name whenever they run, and few names begin alike.
#[inline]
fn same(a: &str, b: &str) -> bool {
    // A length and a first byte tell most names apart, and of one letter there is no more to compare: no call.
    a.len() == b.len() && a.as_bytes().first() == b.as_bytes().first() && (a.len() <= 1 || a == b)
}

impl NodeType {
    /// A node type; raise `version` whenever the same inputs begin to give other outputs.
    #[must_use]
    pub fn new(type_name: impl Into<Arc<str>>, version: u32) -> Self {
        let type_name = type_name.into();
        Self {
            title: Cow::Owned(type_name.to_string()),
            type_name,
            version,
            category: Cow::Borrowed(""),
            doc: Cow::Borrowed(""),
            keywords: Vec::new(),
            inputs: Vec::new(),
            outputs: Vec::new(),
            writer: false,
            slow: false,
            cheap: false,
            run: None,
            defaults: Vec::new(),
            digest: 0,
            build: 0,
            numbers: None,
        }
    }

    /// What else its results may depend on, such as the digest of the library that brings it: another build of the same
    /// version finds none of the results that were remembered or kept of this one.
    #[must_use]
    pub fn build(mut self, digest: u128) -> Self {
        self.build = digest;
        self
    }

    /// Name for people.
    #[must_use]
    pub fn name(mut self, name: impl Into<Cow<'static, str>>) -> Self {
        self.title = name.into();
        self
    }

    /// Where a palette shows it.
    #[must_use]
    pub fn category(mut self, category: impl Into<Cow<'static, str>>) -> Self {
        self.category = category.into();
        self
    }

    /// What it does.
    #[must_use]
    pub fn doc(mut self, doc: impl Into<Cow<'static, str>>) -> Self {
        self.doc = doc.into();
        self
    }

    /// Other words to find it by.
    #[must_use]
    pub fn keywords<S: Into<Cow<'static, str>> + Clone>(mut self, keywords: &[S]) -> Self {
        self.keywords = keywords.iter().cloned().map(Into::into).collect();
        self
    }

    /// Adds an input.
    #[must_use]
    pub fn input(mut self, port: Port) -> Self {
        self.inputs.push(port);
        self
    }

    /// Adds an output.
    #[must_use]
    pub fn output(mut self, port: Port) -> Self {
        self.outputs.push(port);
        self
    }

    /// Its `file` outputs are written by the host.
    #[must_use]
    pub fn writer(mut self) -> Self {
        self.writer = true;
        self
    }

    /// Worth a task of its own on the thread pool.
    #[must_use]
    pub fn slow(mut self) -> Self {
        self.slow = true;
        self
    }

    /// Costs less than remembering what it gives, as arithmetic does: small results are not remembered, it runs again.
    #[must_use]
    pub fn cheap(mut self) -> Self {
        self.cheap = true;
        self
    }

    /// What it does. Must be pure: the same inputs give the same outputs.
    #[must_use]
    pub fn run(mut self, run: impl Fn(&mut Call<'_>) -> Result<(), Fail> + Send + Sync + 'static) -> Self {
        self.run = Some(Arc::new(run));
        self
    }

    /// Its name in the file.
    #[must_use]
    pub fn type_name(&self) -> &str {
        &self.type_name
    }

    /// Its version.
    #[must_use]
    pub fn version(&self) -> u32 {
        self.version
    }

    /// Name for people.
    #[must_use]
    pub fn title(&self) -> &str {
        &self.title
    }

    /// Where a palette shows it.
    #[must_use]
    pub fn category_name(&self) -> &str {
        &self.category
    }

    /// Its inputs.
    #[must_use]
    pub fn inputs(&self) -> &[Port] {
        &self.inputs
    }

    /// Its outputs.
    #[must_use]
    pub fn outputs(&self) -> &[Port] {
        &self.outputs
    }

    /// True if the host writes its files.
    #[must_use]
    pub fn is_writer(&self) -> bool {
        self.writer
    }

    #[inline]
    pub(crate) fn input_index(&self, name: &str) -> Option<usize> {
        self.inputs.iter().position(|p| same(&p.name, name))
    }

    #[inline]
    pub(crate) fn output_index(&self, name: &str) -> Option<usize> {
        self.outputs.iter().position(|p| same(&p.name, name))
    }

    /// The same with narrower ranges at some inputs (by name), as the interface of a cluster gives them. Equal ranges give
    /// equal digests, so instances share what is remembered. Ranges that would leave nothing are given back.
    pub(crate) fn narrowed<'a>(&self, ranges: &[(&'a str, f64, f64)]) -> (Self, Vec<&'a str>) {
        let (mut narrow, mut empty) = (self.clone(), Vec::new());
        let mut d = Digester::new();
        d.u128(self.digest);
        for (name, min, max) in ranges {
            let Some(port) = narrow.inputs.iter_mut().find(|p| p.name == *name && p.is_numeric()) else { continue };
            let own = port.range.unwrap_or((f64::MIN, f64::MAX));
            let (min, max) = (min.max(own.0), max.min(own.1));
            if min > max {
                empty.push(*name);
                continue;
            }
            port.range = Some((min, max));
            d.str(name);
            d.u64(min.to_bits());
            d.u64(max.to_bits());
        }
        narrow.digest = d.finish();
        (narrow, empty)
    }

    /// The node type as documented JSON (`tenon nodes --json`).
    #[must_use]
    pub fn describe(&self) -> Json {
        serde_json::json!({
            "type": &*self.type_name,
            "version": self.version,
            "name": self.title,
            "category": self.category,
            "doc": self.doc,
            "keywords": self.keywords,
            "inputs": self.inputs.iter().map(Port::describe).collect::<Vec<_>>(),
            "outputs": self.outputs.iter().map(Port::describe).collect::<Vec<_>>(),
            "writer": self.writer,
            "slow": self.slow,
        })
    }
}

impl std::fmt::Debug for NodeType {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{} v{}", self.type_name, self.version)
    }
}

/// Why a node type was not registered.
#[derive(Debug, thiserror::Error, PartialEq, Eq)]
pub enum RegistryError {
    /// The name is taken.
    #[error("node type \"{0}\" is registered twice")]
    Duplicate(String),
    /// Two inputs or two outputs share a name.
    #[error("node type \"{node}\" has the port \"{port}\" twice")]
    DuplicatePort {
        /// Node type.
        node: String,
        /// Port.
        port: String,
    },
    /// A default is not accepted by its own port.
    #[error("node type \"{node}\": the default of \"{port}\" is not accepted: {why}")]
    BadDefault {
        /// Node type.
        node: String,
        /// Port.
        port: String,
        /// Why not.
        why: String,
    },
    /// `run` was never called.
    #[error("node type \"{0}\" has no function to run")]
    NoRun(String),
    /// A migration of no known type, from a version that has one, or from one that the type has not left behind.
    #[error(
        "node type \"{node}\": no migration from version {from}: unknown type, a second one, or not older than the type"
    )]
    Migration {
        /// Node type.
        node: String,
        /// The version that it starts from.
        from: u32,
    },
    /// A port marked as a file is not a text item.
    #[error("node type \"{node}\": the file port \"{port}\" must be a text item")]
    FilePort {
        /// Node type.
        node: String,
        /// Port.
        port: String,
    },
}

/// A column turned into another type; items that could not be turned are gaps and named.
pub(crate) type Convert = Arc<dyn Fn(&Column) -> (Column, Vec<(usize, String)>) + Send + Sync>;

/// A node of the file, as JSON, made into one of the next version.
pub(crate) type Migration = Box<dyn Fn(Json) -> Result<Json, String> + Send + Sync>;

/// What a wire turns into what by itself.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord)]
pub struct Conversion {
    /// What comes in: an item type, or `item` of any type.
    pub from: &'static str,
    /// What the port takes: an item type, or `list` of the same type.
    pub to: &'static str,
}

/// Node types, item types, conversions and migrations.
#[derive(Default)]
pub struct Registry {
    nodes: BTreeMap<Arc<str>, Arc<NodeType>>,
    types: BTreeMap<&'static str, ItemType>,
    conversions: HashMap<(TypeId, TypeId), Convert>,
    /// By node type and the version that it starts from.
    migrations: BTreeMap<Arc<str>, BTreeMap<u32, Migration>>,
    conversion_names: BTreeSet<Conversion>,
    /// What is not there, by what names of its node types begin with before their dot.
    absent: BTreeMap<String, Diagnostic>,
}

impl Registry {
    /// The engine's own types and the conversion integer → number; no nodes.
    #[must_use]
    pub fn new() -> Self {
        let mut r = Self::default();
        r.register_type::<f64>();
        r.register_type::<i64>();
        r.register_type::<bool>();
        r.register_type::<Text>();
        r.register_type::<File>();
        r.register_conversion::<i64, f64>(|v| Ok(*v as f64));
        r
    }

    /// Makes an item type known by name.
    pub fn register_type<T: Item>(&mut self) {
        self.types.insert(T::TYPE, ItemType::of::<T>());
    }

    /// A column without items of the type of that name.
    pub(crate) fn empty_column(&self, type_name: &str) -> Option<Column> {
        self.types.get(type_name).map(|t| (t.empty)())
    }

    /// Names of all item types.
    pub fn type_names(&self) -> impl Iterator<Item = &'static str> {
        self.types.keys().copied()
    }

    /// A port for items of the type of that name, or of `any` type; none if there is no such type.
    #[must_use]
    pub fn port(&self, name: &str, type_name: &str, access: Access) -> Option<Port> {
        let name = name.to_owned();
        if type_name == "any" {
            return Some(Port::any(name, access));
        }
        self.types.get(type_name).map(|t| Port::new(name, *t, access))
    }

    /// Lets a wire from `A` to `B` turn each item; an item that cannot be turned becomes a gap with an error.
    pub fn register_conversion<A: Item, B: Item>(&mut self, convert: fn(&A) -> Result<B, String>) {
        let convert: Convert = Arc::new(move |column: &Column| {
            let mut errors = Vec::new();
            let items = (0..column.len())
                .map(|i| match convert(column.get::<A>(i)?) {
                    Ok(item) => Some(item),
                    Err(why) => {
                        errors.push((i, why));
                        None
                    }
                })
                .collect();
            (Column::with_gaps::<B>(items), errors)
        });
        self.conversions.insert((TypeId::of::<A>(), TypeId::of::<B>()), convert);
        self.conversion_names.insert(Conversion { from: A::TYPE, to: B::TYPE });
    }

    /// Every implicit conversion, by name: the registered ones, and that an item of any type is a list of one to a list
    /// port. There is no other.
    #[must_use]
    pub fn conversions(&self) -> Vec<Conversion> {
        let mut all: BTreeSet<Conversion> = self.conversion_names.clone();
        all.insert(Conversion { from: "item", to: "list" });
        all.into_iter().collect()
    }

    pub(crate) fn conversion(&self, from: TypeId, to: TypeId) -> Option<&Convert> {
        self.conversions.get(&(from, to))
    }

    /// Adds a node type.
    ///
    /// # Errors
    /// If the name is taken, a port is there twice, a default is not accepted by its port, or there is nothing to run.
    pub fn register(&mut self, mut node: NodeType) -> Result<(), RegistryError> {
        let name = node.type_name.to_string();
        if self.nodes.contains_key(&node.type_name) {
            return Err(RegistryError::Duplicate(name));
        }
        if node.run.is_none() {
            return Err(RegistryError::NoRun(name));
        }
        for ports in [&node.inputs, &node.outputs] {
            for (i, port) in ports.iter().enumerate() {
                if ports[..i].iter().any(|p| p.name == port.name) {
                    return Err(RegistryError::DuplicatePort { node: name, port: port.name.to_string() });
                }
            }
        }
        for port in &node.inputs {
            if port.file && (port.item_type.id != Some(TypeId::of::<Text>()) || port.access != crate::Access::Item) {
                return Err(RegistryError::FilePort { node: name, port: port.name.to_string() });
            }
            let default = port.default.as_ref().map(|d| port.literal(d)).transpose();
            node.defaults.push(default.map_err(|why| RegistryError::BadDefault {
                node: name.clone(),
                port: port.name.to_string(),
                why: why.to_string(),
            })?);
        }
        let mut d = Digester::new();
        d.str(&node.type_name);
        d.u32(node.version);
        if node.build != 0 {
            d.u128(node.build);
        }
        node.digest = d.finish();
        let bounds: Option<Box<[_]>> = node.inputs.iter().map(Port::number_bounds).collect();
        node.numbers = bounds.filter(|b| b.len() <= SIMPLE_PORTS && node.outputs.len() == 1);
        self.nodes.insert(node.type_name.clone(), Arc::new(node));
        Ok(())
    }

    /// Says how a node of version `from` becomes one of version `from + 1`. `step` gets the node as it stands in the file
    /// (`type`, `v`, `params`, `inputs` …) and must be pure; `v` is set by the engine, `type` has to stay. What fails is told
    /// with the step's own words. The node type has to be registered before.
    ///
    /// # Errors
    /// If there is no such node type, a step from that version is there already, or the type's own version is not newer.
    pub fn register_migration(
        &mut self,
        type_name: &str,
        from: u32,
        step: impl Fn(Json) -> Result<Json, String> + Send + Sync + 'static,
    ) -> Result<(), RegistryError> {
        let wrong = || RegistryError::Migration { node: type_name.to_owned(), from };
        let node = self.nodes.get(type_name).filter(|t| from < t.version).ok_or_else(wrong)?;
        let steps = self.migrations.entry(node.type_name.clone()).or_default();
        if steps.contains_key(&from) {
            return Err(wrong());
        }
        steps.insert(from, Box::new(step));
        Ok(())
    }

    pub(crate) fn migration(&self, type_name: &str, from: u32) -> Option<&Migration> {
        self.migrations.get(type_name)?.get(&from)
    }

    /// Node type and starting version of every migration, in order; each should have a file before and a file after it
    /// among the tests.
    pub fn migrations(&self) -> impl Iterator<Item = (&str, u32)> {
        self.migrations.iter().flat_map(|(name, steps)| steps.keys().map(move |from| (&**name, *from)))
    }

    /// Says why node types whose names begin with `prefix` and a dot are not there. Every graph that is validated or
    /// evaluated is told, and nodes of such types pass on the hint.
    pub fn register_absent(&mut self, prefix: impl Into<String>, why: Diagnostic) {
        self.absent.insert(prefix.into(), why);
    }

    /// What is not there, by prefix.
    pub(crate) fn absent(&self) -> &BTreeMap<String, Diagnostic> {
        &self.absent
    }

    /// The node type of that name.
    #[must_use]
    pub fn get(&self, type_name: &str) -> Option<&Arc<NodeType>> {
        self.nodes.get(type_name)
    }

    /// All node types by name.
    pub fn iter(&self) -> impl Iterator<Item = &Arc<NodeType>> {
        self.nodes.values()
    }
}

impl std::fmt::Debug for Registry {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.debug_set().entries(self.nodes.keys()).finish()
    }
}

#[cfg(test)]
mod tests {
    use super::*;

    fn node(name: &str) -> NodeType {
        NodeType::new(name, 1).run(|_| Ok(()))
    }

    #[test]
    fn refuses_what_would_surprise_later() {
        let mut r = Registry::new();
        assert_eq!(r.register(node("a")), Ok(()));
        assert_eq!(r.register(node("a")), Err(RegistryError::Duplicate("a".into())));
        assert_eq!(r.register(NodeType::new("b", 1)), Err(RegistryError::NoRun("b".into())));
        let twice = node("c").input(Port::item::<f64>("x")).input(Port::item::<f64>("x"));
        assert!(matches!(r.register(twice), Err(RegistryError::DuplicatePort { .. })));
        let default = node("d").input(Port::item::<f64>("x").range(0.0, 1.0).default(2.0));
        assert!(matches!(r.register(default), Err(RegistryError::BadDefault { .. })));
    }
}
