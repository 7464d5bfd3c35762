//! The plugin's side in safe Rust: a node is a plain function plus a description.
//!
//! ```ignore
//! fn plugin() -> Plugin {
//!     Plugin::new("acme", "1.0.0").node(
//!         Node::new("acme.twice", 1).name("Twice").doc("Doubles a number.")
//!             .input(Port::number("value").doc("The number."))
//!             .output(Port::number("result").doc("Twice the number."))
//!             .run(|c| c.set_number("result", 2.0 * c.number("value")?)),
//!     )
//! }
//! tenon_plugin::export!(plugin);
//! ```

use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::from_c::{Buffers, Reader};
use crate::to_c::CTree;
use crate::value::{Branch, Curve, Features, Items, Mesh, Panels};
use std::any::Any;
use std::borrow::Cow;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why a node fails: what, how far off, and what would work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fail {
    code: Cow<'static, str>,
    message: String,
    hint: String,
    port: String,
    item: u64,
    cancelled: bool,
}

impl Fail {
    /// `code` in kebab-case, `message` a sentence for people.
    #[must_use]
    pub fn new(code: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        let (code, message) = (code.into(), message.into());
        Self { code, message, hint: String::new(), port: String::new(), item: u64::MAX, cancelled: false }
    }

    /// The host asked to stop.
    #[must_use]
    pub fn cancelled() -> Self {
        Self { cancelled: true, ..Self::new("cancelled", "cancelled") }
    }

    /// Says what would fix it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Names the input concerned.
    #[must_use]
    pub fn port(mut self, port: impl Into<String>) -> Self {
        self.port = port.into();
        self
    }

    /// Names the item concerned: a panel, a face.
    #[must_use]
    pub fn item(mut self, item: usize) -> Self {
        self.item = item as u64;
        self
    }
}

/// One input or output.
#[derive(Clone, Debug)]
pub struct Port {
    kind: tenon_kind,
    access: tenon_access,
    flags: u32,
    name: &'static str,
    doc: &'static str,
    unit: &'static str,
    default_json: String,
    range: (f64, f64),
    choices: Vec<&'static str>,
}

macro_rules! kinds {
    ($($name:ident $kind:ident $what:literal;)*) => { $(
        #[doc = concat!("A port for one ", $what, ".")]
        #[must_use]
        pub fn $name(name: &'static str) -> Self {
            Self::of($kind, name)
        }
    )* };
}

impl Port {
    fn of(kind: tenon_kind, name: &'static str) -> Self {
        let choices = Vec::new();
        Self {
            kind,
            access: TENON_ITEM,
            flags: 0,
            name,
            doc: "",
            unit: "",
            default_json: String::new(),
            range: (0.0, 0.0),
            choices,
        }
    }

    kinds! {
        boolean TENON_BOOLEAN "truth value"; integer TENON_INTEGER "whole number"; number TENON_NUMBER "number";
        text TENON_TEXT "text"; point TENON_POINT "point"; vector TENON_VECTOR "vector"; plane TENON_PLANE "plane";
        curve TENON_CURVE "curve"; mesh TENON_MESH "mesh"; panels TENON_PANELS "panel set";
        features TENON_FEATURES "feature set";
    }

    /// Sees one list at a time instead.
    #[must_use]
    pub fn list(mut self) -> Self {
        self.access = TENON_LIST;
        self
    }

    /// What it means.
    #[must_use]
    pub fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// What its numbers measure: "mm", "deg" and so on, see `tenon_port.unit`.
    #[must_use]
    pub fn unit(mut self, unit: &'static str) -> Self {
        self.unit = unit;
        self
    }

    /// Smallest and largest number accepted.
    #[must_use]
    pub fn range(mut self, min: f64, max: f64) -> Self {
        self.range = (min, max);
        self.flags |= TENON_RANGE;
        self
    }

    /// The literal used without wire and parameter, as JSON: `"12"`, `"\"left\""`.
    #[must_use]
    pub fn default(mut self, json: impl ToString) -> Self {
        self.default_json = json.to_string();
        self
    }

    /// The texts accepted.
    #[must_use]
    pub fn choices(mut self, choices: &[&'static str]) -> Self {
        self.choices = choices.to_vec();
        self
    }

    /// The node runs without it.
    #[must_use]
    pub fn optional(mut self) -> Self {
        self.flags |= TENON_OPTIONAL;
        self
    }

    fn leak(self) -> tenon_port {
        let choices: Vec<tenon_str> = self.choices.iter().map(|c| tenon_str::of(c)).collect();
        let choices: &'static [tenon_str] = choices.leak();
        tenon_port {
            size: size_of::<tenon_port>() as u32,
            flags: self.flags,
            kind: self.kind,
            access: self.access,
            name: tenon_str::of(self.name),
            doc: tenon_str::of(self.doc),
            unit: tenon_str::of(self.unit),
            default_json: tenon_str::of(self.default_json.leak()),
            min: self.range.0,
            max: self.range.1,
            choices: choices.as_ptr(),
            choice_count: choices.len() as u64,
        }
    }
}

type Run = fn(&mut Call<'_>) -> Result<(), Fail>;

/// A node type.
#[derive(Clone, Debug)]
pub struct Node {
    id: &'static str,
    version: u32,
    flags: u32,
    name: &'static str,
    category: &'static str,
    doc: &'static str,
    keywords: &'static str,
    inputs: Vec<Port>,
    outputs: Vec<Port>,
    run: Option<Run>,
}

impl Node {
    /// A node type; `id` begins with the plugin's id and a dot. Raise `version` when the same inputs begin to give other
    /// outputs.
    #[must_use]
    pub fn new(id: &'static str, version: u32) -> Self {
        let (inputs, outputs) = (Vec::new(), Vec::new());
        Self {
            id,
            version,
            flags: TENON_PURE,
            name: "",
            category: "Plugins",
            doc: "",
            keywords: "",
            inputs,
            outputs,
            run: None,
        }
    }

    /// A fastener: `run` finds the panels by [`Call::panels`] at "panels", the edges by [`Call::edges`], the face that
    /// lies up by [`Call::text`] at "up" ("front" or "back"), its own inputs by name, and gives its features by [`Call::set_features`] at "features".
    #[must_use]
    pub fn fastener(id: &'static str, version: u32) -> Self {
        Self { flags: TENON_PURE | TENON_FASTENER, category: "Joint", ..Self::new(id, version) }
    }

    /// Name for people.
    #[must_use]
    pub fn name(mut self, name: &'static str) -> Self {
        self.name = name;
        self
    }

    /// Where a palette shows it.
    #[must_use]
    pub fn category(mut self, category: &'static str) -> Self {
        self.category = category;
        self
    }

    /// What it does.
    #[must_use]
    pub fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// Other words to find it by, separated by commas.
    #[must_use]
    pub fn keywords(mut self, keywords: &'static str) -> Self {
        self.keywords = keywords;
        self
    }

    /// Worth a thread of its own.
    #[must_use]
    pub fn slow(mut self) -> Self {
        self.flags |= TENON_SLOW;
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

    /// What it does: the same inputs must give the same outputs.
    #[must_use]
    pub fn run(mut self, run: Run) -> Self {
        self.run = Some(run);
        self
    }

    fn leak(self) -> tenon_node_type {
        let (inputs, outputs) = self.port_names();
        let data = self.run.map_or(std::ptr::null_mut(), |run| {
            std::ptr::from_mut(Box::leak(Box::new(Running { run, inputs, outputs }))).cast::<c_void>()
        });
        let inputs: Vec<tenon_port> = self.inputs.into_iter().map(Port::leak).collect();
        let outputs: Vec<tenon_port> = self.outputs.into_iter().map(Port::leak).collect();
        let (inputs, outputs): (&'static [tenon_port], &'static [tenon_port]) = (inputs.leak(), outputs.leak());
        tenon_node_type {
            size: size_of::<tenon_node_type>() as u32,
            flags: self.flags,
            id: tenon_str::of(self.id),
            version: self.version,
            input_count: inputs.len() as u32,
            inputs: inputs.as_ptr(),
            outputs: outputs.as_ptr(),
            output_count: outputs.len() as u32,
            port_stride: size_of::<tenon_port>() as u32,
            name: tenon_str::of(self.name),
            category: tenon_str::of(self.category),
            doc: tenon_str::of(self.doc),
            keywords: tenon_str::of(self.keywords),
            data,
            evaluate: self.run.map(|_| evaluate as _),
        }
    }

    /// What the trees given to `evaluate` and taken by `set` are called.
    fn port_names(&self) -> (Vec<&'static str>, Vec<&'static str>) {
        let fastener = self.flags & TENON_FASTENER != 0;
        let mut inputs = if fastener { vec!["panels", "edges", "up"] } else { Vec::new() };
        inputs.extend(self.inputs.iter().map(|p| p.name));
        let mut outputs: Vec<&str> = if fastener { vec!["features"] } else { Vec::new() };
        outputs.extend(self.outputs.iter().map(|p| p.name));
        (inputs, outputs)
    }
}

/// A plugin: what a library brings.
#[derive(Clone, Debug)]
pub struct Plugin {
    id: &'static str,
    version: &'static str,
    vendor: &'static str,
    doc: &'static str,
    nodes: Vec<Node>,
}

impl Plugin {
    /// A plugin without nodes. `id`: lower case letters, digits and `_`; `version`: "1.2.0".
    #[must_use]
    pub fn new(id: &'static str, version: &'static str) -> Self {
        Self { id, version, vendor: "", doc: "", nodes: Vec::new() }
    }

    /// Who made it.
    #[must_use]
    pub fn vendor(mut self, vendor: &'static str) -> Self {
        self.vendor = vendor;
        self
    }

    /// What it is for.
    #[must_use]
    pub fn doc(mut self, doc: &'static str) -> Self {
        self.doc = doc;
        self
    }

    /// Adds a node type.
    #[must_use]
    pub fn node(mut self, node: Node) -> Self {
        self.nodes.push(node);
        self
    }

    /// The C descriptor, kept for ever.
    #[doc(hidden)]
    #[must_use]
    pub fn leak(self) -> &'static tenon_plugin {
        let nodes: Vec<tenon_node_type> = self.nodes.into_iter().map(Node::leak).collect();
        let nodes: &'static [tenon_node_type] = nodes.leak();
        Box::leak(Box::new(tenon_plugin {
            magic: TENON_PLUGIN_MAGIC,
            size: size_of::<tenon_plugin>() as u32,
            abi_major: TENON_PLUGIN_MAJOR,
            abi_minor: TENON_PLUGIN_MINOR,
            id: tenon_str::of(self.id),
            version: tenon_str::of(self.version),
            vendor: tenon_str::of(self.vendor),
            doc: tenon_str::of(self.doc),
            nodes: nodes.as_ptr(),
            node_count: nodes.len() as u32,
            node_stride: size_of::<tenon_node_type>() as u32,
        }))
    }
}

/// Exports the plugin that a function `fn() -> tenon_plugin::author::Plugin` describes.
#[macro_export]
macro_rules! export {
    ($plugin:path) => {
        /// The one symbol of a plugin; see `tenon_plugin.h`.
        #[unsafe(no_mangle)]
        pub extern "C" fn tenon_plugin_v1() -> *const $crate::abi::plugin::tenon_plugin {
            static PLUGIN: ::std::sync::OnceLock<Option<&'static $crate::abi::plugin::tenon_plugin>> =
                ::std::sync::OnceLock::new();
            let made = PLUGIN.get_or_init(|| ::std::panic::catch_unwind(|| $plugin().leak()).ok());
            made.map_or(::std::ptr::null(), ::std::ptr::from_ref)
        }
    };
}

/// What `data` leads to.
struct Running {
    run: Run,
    inputs: Vec<&'static str>,
    outputs: Vec<&'static str>,
}

/// The function of every node made here: reads the inputs, runs the plain function, catches its panics.
unsafe extern "C" fn evaluate(
    data: *mut c_void,
    call: *const tenon_call,
    inputs: *const tenon_tree,
    count: u32,
) -> tenon_status {
    // SAFETY: the descriptor says `data` and this function together, and it is never freed.
    let Some(node) = (unsafe { data.cast::<Running>().as_ref() }) else { return TENON_BAD_ARGUMENT };
    // SAFETY: the host's call lives through this one.
    let Some(call) = (unsafe { call.as_ref() }) else { return TENON_BAD_ARGUMENT };
    if (call.size as usize) < size_of::<tenon_call>()
        || count as usize != node.inputs.len()
        || inputs.is_null() && count > 0
    {
        return TENON_BAD_ARGUMENT;
    }
    let body = || {
        let mut buffers = Buffers::default();
        let mut values = Vec::with_capacity(count as usize);
        for i in 0..count as usize {
            let mut reader = Reader { buffers: &mut buffers };
            // SAFETY: the host gives as many trees as it says, good until we return.
            let tree = unsafe { reader.tree(inputs.add(i)) };
            values.push(tree.map_err(|e| Fail::new("host-fault", format!("input {}: {e}", node.inputs[i])))?);
        }
        let mut call = Call { raw: call, node, inputs: values };
        (node.run)(&mut call)
    };
    let fail = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return TENON_OK,
        Ok(Err(fail)) if fail.cancelled => return TENON_CANCELLED,
        Ok(Err(fail)) => fail,
        Err(panic) => Fail::new("plugin-panic", format!("the plugin has a fault: {}", words(&*panic))),
    };
    tell(call, TENON_ERROR, &fail);
    TENON_FAILED
}

fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without words")
}

fn tell(call: &tenon_call, severity: tenon_severity, fail: &Fail) {
    let message = tenon_message {
        size: size_of::<tenon_message>() as u32,
        severity,
        code: tenon_str::of(&fail.code),
        message: tenon_str::of(&fail.message),
        hint: tenon_str::of(&fail.hint),
        port: tenon_str::of(&fail.port),
        item: fail.item,
    };
    // SAFETY: the host's function, with the host's call and a message that lives through it.
    unsafe { (call.tell)(call, &raw const message) };
}

/// One run of a node: its inputs by name, places for its outputs, progress and cancellation.
pub struct Call<'a> {
    raw: &'a tenon_call,
    node: &'a Running,
    inputs: Vec<Vec<Branch<'a>>>,
}

macro_rules! items {
    ($($name:ident $variant:ident $type:ty, $what:literal;)*) => { $(
        #[doc = concat!("The ", $what, " at `port`.")]
        ///
        /// # Errors
        /// If it has no value, or the node declared another type.
        pub fn $name(&self, port: &str) -> Result<$type, Fail> {
            match self.items(port)? {
                Items::$variant(v) => v.first().cloned().ok_or_else(|| missing(port)),
                _ => Err(other(port, $what)),
            }
        }
    )* };
}

fn missing(port: &str) -> Fail {
    Fail::new("missing-input", format!("\"{port}\" has no value")).port(port)
}

fn other(port: &str, what: &str) -> Fail {
    Fail::new("plugin-fault", format!("it asks \"{port}\" for a {what}, but declared something else")).port(port)
}

impl<'a> Call<'a> {
    /// The branches at an input; none if it is optional and has no value.
    ///
    /// # Errors
    /// If the node has no such input.
    pub fn tree(&self, port: &str) -> Result<&[Branch<'a>], Fail> {
        let index = self.node.inputs.iter().position(|name| *name == port);
        let found = index.and_then(|i| self.inputs.get(i)).map(Vec::as_slice);
        found.ok_or_else(|| Fail::new("plugin-fault", format!("it has no input \"{port}\"")))
    }

    /// The items of the first branch at an input.
    ///
    /// # Errors
    /// If there is no value or no such input.
    pub fn items(&self, port: &str) -> Result<&Items<'a>, Fail> {
        self.tree(port)?.first().map(|b| &b.items).ok_or_else(|| missing(port))
    }

    items! {
        boolean Boolean bool, "truth value"; integer Integer i64, "whole number"; number Number f64, "number";
        text Text Cow<'a, str>, "text"; point Point tenon_vec3, "point"; vector Vector tenon_vec3, "vector";
        plane Plane tenon_plane, "plane"; curve Curve Curve<'a>, "curve"; mesh Mesh Mesh<'a>, "mesh";
        panels Panels Panels<'a>, "panel set"; features Features Features<'a>, "feature set";
    }

    /// The edges that a fastener is to join.
    ///
    /// # Errors
    /// If the node is no fastener.
    pub fn edges(&self) -> Result<&[tenon_edge_pair], Fail> {
        match self.items("edges")? {
            Items::Edges(edges) => Ok(edges),
            _ => Err(other("edges", "list of edges")),
        }
    }

    /// Tells the fraction done, 0 to 1; an error means: pass it on, the host asked to stop.
    ///
    /// # Errors
    /// [`Fail::cancelled`].
    pub fn progress(&self, fraction: f64) -> Result<(), Fail> {
        // SAFETY: the host's functions, with the host's call.
        let stop = unsafe {
            (self.raw.progress)(self.raw, fraction);
            (self.raw.cancelled)(self.raw)
        };
        if stop == 0 { Ok(()) } else { Err(Fail::cancelled()) }
    }

    /// Says that part of the result is missing, and goes on.
    pub fn error(&self, fail: &Fail) {
        tell(self.raw, TENON_ERROR, fail);
    }

    /// Warns, and goes on.
    pub fn warn(&self, fail: &Fail) {
        tell(self.raw, TENON_WARNING, fail);
    }

    /// Sets an output to a tree.
    ///
    /// # Errors
    /// If there is no such output, or the host refuses the value; it then says why.
    pub fn set(&mut self, port: &str, value: &[Branch<'_>]) -> Result<(), Fail> {
        let output = self.output(port)?;
        let view = CTree::new(value);
        let tree = view.get();
        // SAFETY: the host's function, with the host's call and a value that lives through it.
        let status = unsafe { (self.raw.set)(self.raw, output, &raw const tree) };
        if status == TENON_OK { Ok(()) } else { Err(Fail::new("plugin-fault", format!("\"{port}\" was refused"))) }
    }

    fn output(&self, port: &str) -> Result<u32, Fail> {
        let index = self.node.outputs.iter().position(|name| *name == port);
        index.map(|i| i as u32).ok_or_else(|| Fail::new("plugin-fault", format!("it has no output \"{port}\"")))
    }

    /// Sets an output to a list of items, which goes to `{0}`.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_items(&mut self, port: &str, items: Items<'_>) -> Result<(), Fail> {
        self.set(port, &[Branch::root(items)])
    }

    /// Sets an output to a number.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_number(&mut self, port: &str, value: f64) -> Result<(), Fail> {
        self.set_items(port, Items::Number(vec![value].into()))
    }

    /// Sets an output to a curve.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_curve(&mut self, port: &str, value: Curve<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Curve(vec![value]))
    }

    /// Sets an output to a mesh.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_mesh(&mut self, port: &str, value: Mesh<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Mesh(vec![value]))
    }

    /// Sets an output to features and hardware.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_features(&mut self, port: &str, value: Features<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Features(vec![value]))
    }

    /// Sets an output to what arrived at an input, as it is.
    ///
    /// # Errors
    /// If one of them is not there, or their types differ.
    pub fn forward(&mut self, output: &str, input: &str) -> Result<(), Fail> {
        let o = self.output(output)?;
        let index = self.node.inputs.iter().position(|name| *name == input);
        let i = index.ok_or_else(|| Fail::new("plugin-fault", format!("it has no input \"{input}\"")))?;
        // SAFETY: the host's function, with the host's call.
        let status = unsafe { (self.raw.forward)(self.raw, o, i as u32) };
        if status == TENON_OK { Ok(()) } else { Err(Fail::new("plugin-fault", format!("\"{output}\" was refused"))) }
    }
}
