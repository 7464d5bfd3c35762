//! The node types of the model test. Every call of a node is counted under its type and its tag, and one of them can be
//! made to raise the cancel flag.

use serde_json::json;
use std::collections::BTreeMap;
use std::sync::atomic::{AtomicBool, Ordering};
use std::sync::{Arc, Mutex, OnceLock, PoisonError};
use std::time::Duration;
use tenon_engine::*;

/// Type and tag: nodes with a tag of their own can be told apart, nodes without share results.
pub type Who = (String, i64);

/// What ran, and when to cancel.
#[derive(Default)]
pub struct Calls(Mutex<Inner>, bool);

#[derive(Default)]
struct Inner {
    by: BTreeMap<Who, usize>,
    total: usize,
    /// At that call the flag goes up.
    cancel: Option<(usize, Arc<AtomicBool>)>,
}

impl Calls {
    fn note(&self, type_name: &str, tag: i64) {
        let mut inner = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        *inner.by.entry((type_name.to_owned(), tag)).or_default() += 1;
        inner.total += 1;
        if let Some((at, flag)) = &inner.cancel
            && inner.total >= *at
        {
            flag.store(true, Ordering::Relaxed);
        }
        drop(inner);
        if self.1 {
            std::thread::sleep(Duration::from_micros(20));
        }
    }

    /// Of nodes that take long enough for something to happen meanwhile.
    pub fn slow() -> Self {
        Self(Mutex::default(), true)
    }

    /// Calls since it was last begun.
    pub fn total(&self) -> usize {
        self.0.lock().unwrap_or_else(PoisonError::into_inner).total
    }

    /// Begins to count anew.
    pub fn begin(&self, cancel: Option<(usize, Arc<AtomicBool>)>) {
        *self.0.lock().unwrap_or_else(PoisonError::into_inner) = Inner { cancel, ..Inner::default() };
    }

    /// Calls since then.
    pub fn take(&self) -> BTreeMap<Who, usize> {
        std::mem::take(&mut self.0.lock().unwrap_or_else(PoisonError::into_inner).by)
    }
}

/// The files that the nodes read.
#[derive(Default)]
pub struct Disk(pub Mutex<BTreeMap<String, Vec<u8>>>);

impl Host for Disk {
    fn read(&self, path: &str) -> std::io::Result<Arc<[u8]>> {
        let files = self.0.lock().unwrap_or_else(PoisonError::into_inner);
        files.get(path).map(|b| Arc::from(b.as_slice())).ok_or_else(|| std::io::ErrorKind::NotFound.into())
    }
}

/// Name, inputs that can be wired, outputs: what scripts choose from. All but the texts are numbers or integers.
pub const TYPES: [(&str, &[&str], &[&str]); 20] = [
    ("number", &["value"], &["value"]),
    ("add", &["a", "b"], &["sum"]),
    ("add", &["a", "b"], &["sum"]),
    ("grid", &["a", "b"], &["sum"]),
    ("floor", &["a"], &["value"]),
    ("negate", &["a"], &["value"]),
    ("root", &["a"], &["value"]),
    ("warn", &["a"], &["value"]),
    ("series", &["count", "from"], &["values"]),
    ("series", &["count", "from"], &["values"]),
    ("sum", &["values"], &["sum"]),
    ("count", &["values"], &["count"]),
    ("pass", &["in"], &["out"]),
    ("split", &["values"], &["low", "high"]),
    ("maybe", &["a"], &["value"]),
    ("thick", &["t"], &["t"]),
    ("patient", &["a"], &["value"]),
    ("panic", &["a"], &["value"]),
    ("read", &["path"], &["size"]),
    ("write", &["size"], &["file"]),
];

/// The file from which clusters are linked.
pub const LIBRARY: &str = "library.tenon.json";

/// What stands in it.
pub fn library(b: f64) -> Vec<u8> {
    json!({
        "format": "tenon", "version": 1, "units": "mm",
        "interface": {"inputs": {"x": {"port": "one.a"}}, "outputs": {"y": {"port": "two.value"}}},
        "nodes": {
            "one": {"type": "add", "v": 1, "params": {"b": b}},
            "two": {"type": "floor", "v": 1, "inputs": {"a": {"from": ["one.sum"]}}},
        },
    })
    .to_string()
    .into_bytes()
}

/// Inputs that can be wired and outputs of a node type or a cluster.
pub fn ports_of(document: &Document, type_name: &str) -> (Vec<String>, Vec<String>) {
    let own = |names: &[&str]| names.iter().map(|n| (*n).to_owned()).collect();
    if let Some((_, inputs, outputs)) = TYPES.iter().find(|t| t.0 == type_name) {
        return (own(inputs), own(outputs));
    }
    match type_name.strip_prefix("cluster:").and_then(|name| document.clusters.get(name)) {
        Some(Cluster::Here(body)) => (body.inputs.keys().cloned().collect(), body.outputs.keys().cloned().collect()),
        Some(Cluster::File(_)) => (own(&["x"]), own(&["y"])),
        None => (Vec::new(), Vec::new()),
    }
}

/// A registry that counts for nobody.
pub fn plain() -> Arc<Registry> {
    static PLAIN: OnceLock<Arc<Registry>> = OnceLock::new();
    PLAIN.get_or_init(|| registry(&Arc::new(Calls::default()), Vec::new())).clone()
}

type Run = fn(&mut Call<'_>) -> Result<(), Fail>;

fn types() -> Vec<(NodeType, Run)> {
    let number = |n: &'static str| Port::item::<f64>(n);
    let simple =
        |name: &'static str, run: Run| (NodeType::new(name, 1).input(number("a")).output(number("value")), run);
    let mut all: Vec<(NodeType, Run)> = vec![
        simple("floor", |c| set(c, "value", c.number("a")?.floor())),
        simple("root", |c| match c.number("a")? {
            a if a < 0.0 => Err(Fail::new("negative", format!("{a} has no root")).port("a").hint("use 0 or more")),
            a => set(c, "value", a.sqrt()),
        }),
        simple("warn", |c| {
            let a = c.number("a")?;
            if a > 3.0 {
                c.warn(Fail::new("large", format!("{a} is large")));
            }
            set(c, "value", a + 100.0)
        }),
        simple(
            "patient",
            |c| if c.cancelled() { Err(Fail::cancelled()) } else { set(c, "value", c.number("a")? * 2.0) },
        ),
        simple("panic", |c| {
            let a = c.number("a")?;
            // Like a panic that nobody catches inside the node, without words on the terminal.
            if a == 13.0 {
                std::panic::resume_unwind(Box::new("thirteen"));
            }
            set(c, "value", a)
        }),
    ];
    all.push((NodeType::new("number", 1).input(number("value").default(0.0)).output(number("value")), |c| {
        set(c, "value", c.number("value")?)
    }));
    all.push((NodeType::new("add", 1).input(number("a")).input(number("b").default(1)).output(number("sum")), |c| {
        set(c, "sum", c.number("a")? + c.number("b")?)
    }));
    let lists =
        NodeType::new("grid", 1).input(number("a").default(vec![1, 2, 3])).input(number("b").default(vec![10, 20]));
    all.push((lists.output(number("sum")), |c| set(c, "sum", c.number("a")? + c.number("b")?)));
    all.push((NodeType::new("negate", 1).input(number("a").default(4)).output(number("value")).cheap(), |c| {
        set(c, "value", -c.number("a")?)
    }));
    let count = Port::item::<i64>("count").range(0.0, 6.0).default(3);
    let series = NodeType::new("series", 1).input(count).input(number("from").default(0.0));
    all.push((series.output(Port::list::<f64>("values")).slow(), |c| {
        let (n, from) = (c.integer("count")?, c.number("from")?);
        c.set_list("values", (0..n).map(|i| from + i as f64).collect());
        Ok(())
    }));
    let values = || Port::list::<f64>("values");
    all.push((NodeType::new("sum", 1).input(values()).output(number("sum")), |c| {
        set(c, "sum", c.list::<f64>("values")?.iter().sum())
    }));
    all.push((NodeType::new("count", 1).input(Port::tree::<f64>("values")).output(Port::item::<i64>("count")), |c| {
        let n = c.tree("values").len() as i64;
        c.set("count", n);
        Ok(())
    }));
    all.push((
        NodeType::new("pass", 1).input(Port::any("in", Access::Tree)).output(Port::any("out", Access::Tree)),
        |c| {
            let tree = c.tree("in").clone();
            c.set_tree("out", tree);
            Ok(())
        },
    ));
    let low_high =
        NodeType::new("split", 1).input(values()).output(Port::list::<f64>("low")).output(Port::list::<f64>("high"));
    all.push((low_high, |c| {
        let (low, high) = c.list::<f64>("values")?.iter().partition(|v| **v < 2.0);
        c.set_list::<f64>("low", low);
        c.set_list::<f64>("high", high);
        Ok(())
    }));
    all.push((NodeType::new("maybe", 1).input(number("a").optional()).output(number("value")), |c| {
        set(c, "value", c.optional::<f64>("a").copied().unwrap_or(-1.0))
    }));
    let thick = number("t").unit(Unit::Length).range(0.1, 500.0).default(10.0);
    all.push((NodeType::new("thick", 1).input(thick).output(number("t")), |c| set(c, "t", c.number("t")?)));
    let path = Port::item::<Text>("path").file().default("a.txt");
    all.push((NodeType::new("read", 1).input(path).output(Port::item::<i64>("size")), |c| {
        let size = c.file("path")?.len() as i64;
        c.set("size", size);
        Ok(())
    }));
    let name = Port::item::<Text>("name").default("a.txt");
    let write = NodeType::new("write", 1).input(name).input(Port::item::<i64>("size").default(2));
    all.push((write.output(Port::item::<File>("file")).writer(), |c| {
        let (name, size) = (c.text("name")?, usize::try_from(c.integer("size")?).unwrap_or(0));
        let file = File { name: name.into(), bytes: vec![b'x'; size].into(), withheld: None };
        c.set("file", file);
        Ok(())
    }));
    all
}

fn set(c: &mut Call<'_>, port: &str, value: f64) -> Result<(), Fail> {
    c.set(port, value);
    Ok(())
}

/// All of them, counting into `calls`, and `more`.
pub fn registry(calls: &Arc<Calls>, more: Vec<NodeType>) -> Arc<Registry> {
    let mut registry = Registry::new();
    for (node, run) in types() {
        let (calls, name) = (calls.clone(), node.type_name().to_owned());
        // As a tree the tag has no part in matching.
        let node = node.input(Port::tree::<i64>("tag").default(0)).run(move |c| {
            calls.note(&name, c.tree("tag").first::<i64>().copied().unwrap_or(0));
            run(c)
        });
        registry.register(node).expect("test nodes are sound");
    }
    for node in more {
        registry.register(node).expect("test nodes are sound");
    }
    Arc::new(registry)
}
