//! Descriptions in safe Rust: ports, node types and the plugin, and the C descriptors that are made of them.

use super::call::{Call, Fail, Running, evaluate, migrate};
use crate::abi::layout::LAYOUT;
use crate::abi::plugin::*;
use crate::abi::value::*;
use std::ffi::c_void;

/// Builder methods that keep one text each.
macro_rules! texts {
    ($($name:ident $doc:literal;)*) => { $(
        #[doc = $doc]
        #[must_use]
        pub fn $name(mut self, $name: &'static str) -> Self {
            self.$name = $name;
            self
        }
    )* };
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
        features TENON_FEATURES "feature set"; table TENON_TABLE "table of attributes";
    }

    /// Sees one list at a time instead.
    #[must_use]
    pub fn list(mut self) -> Self {
        self.access = TENON_LIST;
        self
    }

    /// Sees everything at once instead: all branches, with [`Call::tree`], given by [`Call::set`].
    #[must_use]
    pub fn tree(mut self) -> Self {
        self.access = TENON_TREE;
        self
    }

    texts! {
        doc "What it means.";
        unit "What its numbers measure: \"mm\", \"deg\" and so on, see `tenon_port.unit`.";
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

/// A step: the version that a node was saved at, and the node as JSON; gives the node of the next version, or says why not.
pub(super) type Migrate = fn(u32, &str) -> Result<String, String>;

pub(super) type Run = fn(&mut Call<'_>) -> Result<(), Fail>;

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
    migrate: Option<(u32, Migrate)>,
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
            migrate: None,
        }
    }

    /// A fastener: `run` finds the panels by [`Call::panels`] at "panels", the edges by [`Call::edges`], the face that
    /// lies up by [`Call::text`] at "up" ("front" or "back"), its
    /// own inputs by name, and gives its features by [`Call::set_features`] at "features". One that declares a text "head"
    /// gets by it which of an edge's panels is to be the first; see `tenon_node_type.evaluate`.
    #[must_use]
    pub fn fastener(id: &'static str, version: u32) -> Self {
        Self { flags: TENON_PURE | TENON_FASTENER, category: "Joint", ..Self::new(id, version) }
    }

    texts! {
        name "Name for people.";
        category "Where a palette shows it.";
        doc "What it does.";
        keywords "Other words to find it by, separated by commas.";
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

    /// Brings nodes that were saved at `from` or later, one version at a time, to today's. A step gets the version that it
    /// starts from and the node as it stands in the file (JSON: `type`, `v`, `params`, `inputs` …), and gives it as the
    /// next version wants it, or says why that cannot be done. `type` has to stay, `v` is set by the host.
    #[must_use]
    pub fn migrate(mut self, from: u32, step: fn(u32, &str) -> Result<String, String>) -> Self {
        self.migrate = Some((from, step));
        self
    }

    fn leak(self) -> tenon_node_type {
        let (inputs, outputs) = self.port_names();
        let data = self.run.map_or(std::ptr::null_mut(), |run| {
            std::ptr::from_mut(Box::leak(Box::new(Running {
                run,
                migrate: self.migrate.map(|m| m.1),
                inputs,
                outputs,
            })))
            .cast::<c_void>()
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
            migrate: self.migrate.map(|_| migrate as _),
            migrate_from: self.migrate.map_or(0, |m| m.0),
            reserved: 0,
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

    texts! {
        vendor "Who made it.";
        doc "What it is for.";
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
            layout: &raw const LAYOUT,
        }))
    }
}
