//! A plugin's node type as the engine's: ports by their descriptors, and a run that hands values over.

use super::{Plugin, PluginError, fastener};
use crate::exchange;
use crate::value::{Plane, Point, Table, V, Vector};
use std::sync::{Arc, Mutex, PoisonError};
use tenon_engine::{Call, Column, Fail, Item, Json, Monitor, NodeType, Port, Text, Tree, Unit, stop};
use tenon_geometry::ifs::Curve;
use tenon_geometry::joint::FeatureSet;
use tenon_geometry::mesh::Mesh;
use tenon_geometry::panel::PanelSet;
use tenon_plugin::abi::plugin::{TENON_ITEM, TENON_LIST, TENON_TREE};
use tenon_plugin::abi::value::*;
use tenon_plugin::load::{EvaluateError, Message, PluginNode, PortInfo, Sink, Watch};
use tenon_plugin::value::Branch;

/// The engine's node type for node `index` of a plugin.
pub(super) fn node_type(plugin: &Arc<Plugin>, index: usize) -> Result<NodeType, PluginError> {
    let node = &plugin.nodes[index];
    let mut t = NodeType::new(node.id.clone(), node.version)
        .name(node.name.clone())
        .category(if node.category.is_empty() { "Plugins".to_owned() } else { node.category.clone() })
        .doc(node.doc.clone())
        .keywords(&node.keywords);
    if node.slow {
        t = t.slow();
    }
    let refused = |name: &str| {
        let (path, place) = (plugin.path.clone(), format!("{}.{name}", node.id));
        move |why| PluginError::Port { path, place, why }
    };
    if node.fastener {
        t = fastener::standard_inputs(t);
        for info in fastener::own_inputs(node).map_err(refused("head"))? {
            t = t.input(port(info).map_err(refused(&info.name))?);
        }
    } else {
        for info in &node.inputs {
            t = t.input(port(info).map_err(refused(&info.name))?);
        }
    }
    let plugin = plugin.clone();
    if node.fastener {
        return Ok(fastener::outputs(t).run(move |c| fastener::run(c, &plugin.nodes[index])));
    }
    for info in &node.outputs {
        t = t.output(typed(info));
    }
    Ok(t.run(move |c| run(c, &plugin.nodes[index])))
}

fn of<T: Item>(info: &PortInfo) -> Port {
    match info.access {
        TENON_ITEM => Port::item::<T>(info.name.clone()),
        TENON_LIST => Port::list::<T>(info.name.clone()),
        _ => Port::tree::<T>(info.name.clone()),
    }
}

/// Name, type, access and doc.
fn typed(info: &PortInfo) -> Port {
    let port = match info.kind {
        TENON_BOOLEAN => of::<bool>(info),
        TENON_INTEGER => of::<i64>(info),
        TENON_TEXT => of::<Text>(info),
        TENON_POINT => of::<Point>(info),
        TENON_VECTOR => of::<Vector>(info),
        TENON_PLANE => of::<Plane>(info),
        TENON_CURVE => of::<V<Curve>>(info),
        TENON_MESH => of::<V<Mesh>>(info),
        TENON_PANELS => of::<V<PanelSet>>(info),
        TENON_FEATURES => of::<V<FeatureSet>>(info),
        TENON_TABLE => of::<Table>(info),
        // The loader lets no other kind pass.
        _ => of::<f64>(info),
    };
    port.doc(info.doc.clone()).unit(unit(&info.unit).unwrap_or_default())
}

fn unit(sign: &str) -> Result<Unit, String> {
    let all = [Unit::Length, Unit::Angle, Unit::Area, Unit::Volume, Unit::Feed, Unit::Speed];
    match sign {
        "" => Ok(Unit::None),
        "pieces" => Ok(Unit::Count),
        sign => all.into_iter().find(|u| u.symbol() == sign).ok_or_else(|| {
            let known: Vec<&str> = all.iter().map(|u| u.symbol()).collect();
            format!("the unit \"{sign}\" is not known; there are {} and pieces", known.join(", "))
        }),
    }
}

/// The same with what only inputs have.
fn port(info: &PortInfo) -> Result<Port, String> {
    unit(&info.unit)?;
    let mut port = typed(info).choices(&info.choices);
    if let Some((min, max)) = info.range {
        port = port.range(min, max);
    }
    if !info.default_json.is_empty() {
        let default: Json = serde_json::from_str(&info.default_json)
            .map_err(|e| format!("its default \"{}\" is not JSON: {e}", info.default_json))?;
        port = port.default(default);
    }
    Ok(if info.optional { port.optional() } else { port })
}

/// What arrives at an input, as a tree.
pub(super) fn arriving(c: &Call<'_>, info: &PortInfo) -> Result<Tree, Fail> {
    Ok(match info.access {
        TENON_ITEM | TENON_LIST => {
            let column = c.column(&info.name)?;
            if info.optional && column.is_empty() { Tree::default() } else { Tree::column(column) }
        }
        _ => c.tree(&info.name).clone(),
    })
}

/// Collects what a plugin gives.
pub(super) struct Collected<'a> {
    /// Kinds of the outputs.
    outputs: &'a [PortInfo],
    inputs: &'a [Tree],
    pub values: Vec<Option<Tree>>,
    /// All that was set: also what was set again, and what was joined to one branch, lives until the evaluation is over.
    kept: Vec<Column>,
    messages: Vec<Message>,
}

impl Sink for Collected<'_> {
    fn keeps(&self) -> bool {
        true
    }

    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        // The plugin's stack lies between this and the engine: nothing may unwind through it.
        let tree = stop::caught(|| {
            let branches = exchange::columns(value)?;
            self.kept.extend(branches.iter().map(|(_, column)| column.clone()));
            Ok::<_, String>(Tree::from_branches(branches))
        });
        self.place(output, tree.ok_or("the evaluation was asked to stop")??)
    }

    fn forward(&mut self, output: u32, input: u32) -> Result<(), String> {
        let tree = self.inputs.get(input as usize).ok_or_else(|| format!("there is no input {input}"))?.clone();
        self.place(output, tree)
    }

    fn tell(&mut self, message: Message) {
        self.messages.push(message);
    }
}

impl<'a> Collected<'a> {
    /// Nothing yet for outputs of those kinds.
    pub fn new(outputs: &'a [PortInfo], inputs: &'a [Tree]) -> Self {
        Self { outputs, inputs, values: vec![None; outputs.len()], kept: Vec::new(), messages: Vec::new() }
    }

    fn place(&mut self, output: u32, tree: Tree) -> Result<(), String> {
        let found = self.outputs.get(output as usize).zip(self.values.get_mut(output as usize));
        let Some((info, place)) = found else { return Err("there is no such output".into()) };
        let wanted = typed(info);
        for (path, column) in tree.branches() {
            if column.type_name() != wanted.type_name() && !column.is_empty() {
                return Err(format!("it is declared as {}, but is {}", wanted.type_name(), column.type_name()));
            }
            if info.access == TENON_ITEM && column.len() != 1 {
                return Err(format!("it is declared as one item, but branch {path} has {}", column.len()));
            }
        }
        if info.access != TENON_TREE && tree.branches().len() != 1 {
            return Err(format!("it is declared as one list, but has {} branches", tree.branches().len()));
        }
        *place = Some(tree);
        Ok(())
    }
}

/// Evaluates a node of a plugin: its messages become diagnostics, its faults errors that name it.
pub(super) fn evaluate(
    c: &mut Call<'_>,
    node: &PluginNode,
    inputs: &[Vec<Branch<'_>>],
    sink: &mut Collected<'_>,
) -> Result<(), Fail> {
    let monitor: Monitor<'_> = c.monitor();
    // One evaluation may tell from one thread at a time only.
    let told = Mutex::new(());
    let progress = |fraction: f64| {
        let _one = told.lock().unwrap_or_else(PoisonError::into_inner);
        let _ = monitor.progress(fraction);
    };
    let watch = Watch { cancelled: &|| monitor.cancelled(), progress: &progress, refuse_buffer: None, room: None };
    let ended = node.evaluate(inputs, watch, sink);
    // It may have failed because it was cut short; whatever it says of that is not its own.
    stop::check();
    let mut messages = std::mem::take(&mut sink.messages);
    // The last error of a node that failed is its failure.
    let last = match ended {
        Err(EvaluateError::Failed) => messages.iter().rposition(|m| m.severity == TENON_ERROR),
        _ => None,
    };
    let last = last.map(|i| fail(messages.remove(i)).1);
    for message in messages {
        match fail(message) {
            (TENON_ERROR, fail) => c.report(fail),
            (TENON_NOTE, fail) => c.note(fail),
            (_, fail) => c.warn(fail),
        }
    }
    match ended {
        Ok(()) => Ok(()),
        Err(EvaluateError::Cancelled) => Err(Fail::cancelled()),
        Err(EvaluateError::Failed) => Err(last.unwrap_or_else(|| fault(node, "it failed without saying why"))),
        Err(EvaluateError::Fault(why)) => Err(fault(node, &why)),
        Err(EvaluateError::Died(why)) => {
            Err(Fail::new("plugin-died", format!("the plugin node \"{}\" died: {why}", node.id))
                .hint("the next evaluation starts it anew; `tenon plugin check` may find the fault"))
        }
    }
}

/// The plugin breaks its contract.
pub(super) fn fault(node: &PluginNode, why: &str) -> Fail {
    Fail::new("plugin-fault", format!("the plugin node \"{}\" is faulty: {why}", node.id))
        .hint("tell the plugin's maker; `tenon plugin info` names it")
}

fn fail(m: Message) -> (u32, Fail) {
    let mut fail = Fail::new(m.code, m.message);
    if let Some(hint) = m.hint {
        fail = fail.hint(hint);
    }
    if let Some(port) = m.port {
        fail = fail.port(port);
    }
    if let Some(item) = m.item {
        fail = fail.item(item);
    }
    (m.severity, fail)
}

fn run(c: &mut Call<'_>, node: &PluginNode) -> Result<(), Fail> {
    let trees = node.inputs.iter().map(|info| arriving(c, info)).collect::<Result<Vec<Tree>, Fail>>()?;
    let inputs: Vec<Vec<Branch<'_>>> = trees.iter().map(exchange::branches).collect();
    let mut sink = Collected::new(&node.outputs, &trees);
    evaluate(c, node, &inputs, &mut sink)?;
    for (info, value) in node.outputs.iter().zip(sink.values) {
        let Some(tree) = value else {
            return Err(fault(node, &format!("it ended well without setting \"{}\"", info.name)));
        };
        match info.access {
            TENON_ITEM | TENON_LIST => {
                let first = tree.branches().first().map(|(_, column)| column.clone());
                let Some(column) = first else { continue };
                set_column(c, info, column)?;
            }
            _ => c.set_tree(&info.name, tree),
        }
    }
    Ok(())
}

/// Sets an output that is one item or one list.
fn set_column(c: &mut Call<'_>, info: &PortInfo, column: Column) -> Result<(), Fail> {
    if info.access == TENON_LIST {
        c.set_column(&info.name, column);
        return Ok(());
    }
    macro_rules! set {
        ($($kind:pat => $type:ty),*) => {
            match info.kind {
                $($kind => match column.get::<$type>(0) {
                    Some(item) => c.set(&info.name, item.clone()),
                    // A gap: the engine says that the output stays empty.
                    None => return Err(Fail::new("missing-output", format!("\"{}\" has no value", info.name))),
                },)*
            }
        };
    }
    set!(
        TENON_BOOLEAN => bool, TENON_INTEGER => i64, TENON_TEXT => Text, TENON_POINT => Point, TENON_VECTOR => Vector,
        TENON_PLANE => Plane, TENON_CURVE => V<Curve>, TENON_MESH => V<Mesh>, TENON_PANELS => V<PanelSet>,
        TENON_FEATURES => V<FeatureSet>, TENON_TABLE => Table, _ => f64
    );
    Ok(())
}

#[cfg(test)]
mod tests {
    use super::*;
    use crate::exchange::addresses::{HandsOver, arrays, samples};
    use std::borrow::Cow;
    use std::collections::BTreeMap;
    use std::sync::atomic::{AtomicBool, Ordering};
    use tenon_engine::{Control, Document, Node, Options, Registry, Session};
    use tenon_plugin::author;
    use tenon_plugin::value::{self as values, Items};

    fn output() -> PortInfo {
        PortInfo {
            name: "values".into(),
            doc: String::new(),
            kind: TENON_NUMBER,
            access: TENON_LIST,
            unit: String::new(),
            default_json: String::new(),
            range: None,
            choices: Vec::new(),
            optional: false,
        }
    }

    #[test]
    fn nothing_unwinds_through_a_plugin_that_gives_a_long_list_of_a_cancelled_evaluation() {
        let control = Control::default();
        let (flag, returned) = (control.cancel.clone(), Arc::new(AtomicBool::new(false)));
        let seen = returned.clone();
        let node = NodeType::new("given", 1).output(Port::list::<f64>("values")).run(move |_| {
            flag.store(true, Ordering::Relaxed);
            let (outputs, numbers) = ([output()], vec![1.0; 1 << 20]);
            let mut sink = Collected::new(&outputs, &[]);
            let told = sink.set(0, vec![Branch::root(Items::Number(Cow::Borrowed(&numbers)))]);
            seen.store(told.is_err() && sink.values == [None], Ordering::Relaxed);
            Ok(())
        });
        let mut registry = Registry::new();
        registry.register(node).unwrap();
        let mut document = Document::new();
        document.insert("n", Node::new("given")).unwrap();
        let mut session = Session::new(Arc::new(registry), document, Options::default());
        assert!(session.evaluate(&[], &control).cancelled);
        assert!(returned.load(Ordering::Relaxed), "the list was not refused, or the plugin never got to know");
    }

    /// Names and addresses of arrays.
    type Arrays = Vec<(&'static str, usize)>;

    /// What a plugin's node saw, by port: the arrays of its input and its buffers.
    static SEEN: Mutex<BTreeMap<String, [Arrays; 2]>> = Mutex::new(BTreeMap::new());

    fn buffer<'b, T: author::Element>(c: &'b author::Call<'_>, from: &[T]) -> Result<Cow<'b, [T]>, author::Fail> {
        let made = c.buffer::<T>(from.len())?;
        made.copy_from_slice(from);
        Ok((&*made).into())
    }

    /// The same items in buffers of the host.
    fn in_buffers<'b>(c: &'b author::Call<'_>, items: &Items<'_>) -> Result<Items<'b>, author::Fail> {
        Ok(match items {
            Items::Boolean(v) => Items::Boolean(buffer(c, v)?),
            Items::Integer(v) => Items::Integer(buffer(c, v)?),
            Items::Number(v) => Items::Number(buffer(c, v)?),
            Items::Point(v) => Items::Point(buffer(c, v)?),
            Items::Vector(v) => Items::Vector(buffer(c, v)?),
            Items::Plane(v) => Items::Plane(buffer(c, v)?),
            Items::Curve(v) => {
                let one = |x: &values::Curve<'_>| {
                    let (points, strip_start) = (buffer(c, &x.points)?, buffer(c, &x.strip_start)?);
                    Ok(values::Curve { points, strip_start, closed: x.closed })
                };
                Items::Curve(v.iter().map(one).collect::<Result<_, author::Fail>>()?)
            }
            Items::Mesh(v) => Items::Mesh(vec![values::Mesh {
                points: buffer(c, &v[0].points)?,
                face_start: buffer(c, &v[0].face_start)?,
                face_vertices: buffer(c, &v[0].face_vertices)?,
                addresses: buffer(c, &v[0].addresses)?,
            }]),
            Items::Panels(v) => Items::Panels(vec![values::Panels {
                thickness: v[0].thickness,
                corner_start: buffer(c, &v[0].corner_start)?,
                address: buffer(c, &v[0].address)?,
                normal: buffer(c, &v[0].normal)?,
                front: buffer(c, &v[0].front)?,
                vertex: buffer(c, &v[0].vertex)?,
                chamfer: buffer(c, &v[0].chamfer)?,
                neighbour: buffer(c, &v[0].neighbour)?,
                side: buffer(c, &v[0].side)?,
                back_start: buffer(c, &v[0].back_start)?,
                back_end: buffer(c, &v[0].back_end)?,
                voided: buffer(c, &v[0].voided)?,
            }]),
            Items::Table(v) => {
                let one = |a: &values::Attribute<'_>| {
                    let (name, items) = (a.name.clone().into_owned().into(), in_buffers(c, &a.items)?);
                    let valid = a.valid.as_ref().map(|v| buffer(c, v)).transpose()?;
                    Ok(values::Attribute { name, items, valid })
                };
                let attributes = v[0].attributes.iter().map(one).collect::<Result<_, author::Fail>>()?;
                Items::Table(vec![values::Table { rows: v[0].rows, attributes }])
            }
            _ => return Err(author::Fail::new("odd", "another type")),
        })
    }

    fn pass(c: &mut author::Call<'_>) -> Result<(), author::Fail> {
        for (port, _) in samples(&HandsOver) {
            c.fill(port, |c| {
                let given = c.tree(port)?;
                let made = in_buffers(c, c.items(port)?)?;
                let seen = [arrays(given), arrays(&[Branch::root(made.clone())])];
                SEEN.lock().unwrap().insert(port.to_owned(), seen);
                Ok(made)
            })?;
        }
        Ok(())
    }

    fn passing() -> NodeType {
        use author::Port as P;
        let ports = [P::boolean, P::integer, P::number, P::point, P::vector, P::plane, P::curve, P::mesh, P::panels];
        let ports = ports.into_iter().chain([P::table as fn(&'static str) -> P]);
        let node = author::Node::new("here.pass", 1).name("Pass").doc("Passes everything on.").run(pass);
        let node = ports.zip(samples(&HandsOver)).fold(node, |node, (port, (name, _))| {
            let port = port(name).list().doc("It.");
            node.input(port.clone()).output(port)
        });
        let plugin = Plugin::built_in(author::Plugin::new("here", "1.0.0").node(node)).unwrap();
        node_type(&Arc::new(plugin), 0).unwrap()
    }

    #[test]
    fn arrays_cross_a_plugin_in_rust_at_the_same_addresses() {
        let made: Vec<(&str, Column)> = samples(&HandsOver)
            .into_iter()
            .map(|(name, branch)| (name, exchange::tree(vec![branch]).unwrap().branches()[0].1.clone()))
            .collect();
        let ports = made.clone();
        let source = [
            Port::list::<bool>("boolean"),
            Port::list::<i64>("integer"),
            Port::list::<f64>("number"),
            Port::list::<Point>("point"),
            Port::list::<Vector>("vector"),
            Port::list::<Plane>("plane"),
            Port::list::<V<Curve>>("curve"),
            Port::list::<V<Mesh>>("mesh"),
            Port::list::<V<PanelSet>>("panels"),
            Port::list::<Table>("table"),
        ]
        .into_iter()
        .fold(NodeType::new("source", 1), NodeType::output)
        .run(move |c| {
            ports.iter().for_each(|(name, column)| c.set_column(name, column.clone()));
            Ok(())
        });
        let mut registry = Registry::new();
        crate::value::register(&mut registry);
        [source, passing()].into_iter().try_for_each(|node| registry.register(node)).unwrap();
        let wire = |(name, _): &(&str, Column)| format!(r#""{name}": {{ "from": ["a.{name}"] }}"#);
        let wires: Vec<String> = made.iter().map(wire).collect();
        let graph = format!(
            r#"{{ "format": "tenon", "version": 1, "units": "mm", "nodes": {{
            "a": {{ "type": "source" }}, "b": {{ "type": "here.pass", "inputs": {{ {} }} }} }} }}"#,
            wires.join(", ")
        );
        let document = Document::from_slice(graph.as_bytes()).unwrap();
        let mut session = Session::new(Arc::new(registry), document, Options::default());
        let outputs: Vec<String> = made.iter().map(|(name, _)| format!("b.{name}")).collect();
        let report = session.evaluate(&outputs.iter().map(String::as_str).collect::<Vec<_>>(), &Control::default());
        assert_eq!(report.diagnostics, []);
        let seen = SEEN.lock().unwrap();
        for (name, column) in &made {
            let arrays_at = |port: String| arrays(&exchange::branches(&session.value(&port).unwrap()));
            assert_eq!(arrays_at(format!("a.{name}")), seen[*name][0], "an input was copied");
            // What says which items are there may serve many outputs, so it is copied: one byte per item.
            let given = |mut all: Vec<(&'static str, usize)>| {
                all.retain(|(what, _)| *what != "attribute.valid");
                all
            };
            let come = arrays_at(format!("b.{name}"));
            assert_eq!(given(come), given(seen[*name][1].clone()), "an output was copied");
            assert_ne!(seen[*name][0], seen[*name][1]);
            assert_eq!(session.value(&format!("b.{name}")).unwrap().branches()[0].1, *column);
        }
    }

    #[test]
    fn a_fastener_that_declares_the_hosts_head_gets_one_port_of_it() {
        let fastener = |head: author::Port| {
            let node = author::Node::fastener("here.pin", 1).name("Pin").doc("Lays pins.").input(head.doc("Whose."));
            let plugin = author::Plugin::new("here", "1.0.0").node(node.run(|_| Ok(())));
            node_type(&Arc::new(Plugin::built_in(plugin).unwrap()), 0)
        };
        let node = fastener(author::Port::text("head")).unwrap();
        let heads: Vec<_> = node.inputs().iter().filter(|p| p.name() == "head").collect();
        assert_eq!(heads.len(), 1);
        assert!(fastener(author::Port::number("head")).is_err_and(|e| e.to_string().contains("here.pin.head")));
    }

    /// Branches of one path are joined to a list of its own.
    #[test]
    fn what_was_joined_is_there_until_the_evaluation_is_over() {
        let (outputs, halves) = ([output()], [vec![1.0; 16], vec![2.0; 16]]);
        let places = halves.each_ref().map(|half| half.as_ptr());
        let mut sink = Collected::new(&outputs, &[]);
        sink.set(0, halves.map(|half| Branch::root(Items::Number(Cow::Owned(half)))).into()).unwrap();
        assert_eq!(sink.values, [Some(Tree::list([[1.0; 16], [2.0; 16]].concat()))]);
        let own: Vec<Vec<f64>> = (0..32).map(|i| vec![f64::from(i); 16]).collect();
        assert!(own.iter().all(|own| !places.contains(&own.as_ptr())));
    }

    /// What the engine has no use for, a list of one item and what was set before it was set again, is not let go while the
    /// plugin works: its own memory would come to lie there, and be refused.
    #[test]
    fn a_plugins_own_memory_never_lies_where_a_buffer_was() {
        fn set_own(c: &mut author::Call<'_>, port: &str, count: usize) -> Result<(), author::Fail> {
            let own: Vec<Vec<f64>> = (0..32).map(|i| vec![f64::from(i); count]).collect();
            own.iter().try_for_each(|own| c.set_items(port, Items::Number(own.into())))
        }
        fn fill(c: &mut author::Call<'_>, port: &str, count: usize) -> Result<(), author::Fail> {
            c.fill(port, |c| {
                let numbers = c.buffer::<f64>(count)?;
                numbers.fill(7.5);
                Ok(Items::Number((&*numbers).into()))
            })
        }
        let output = |name| author::Port::number(name).list().doc("Numbers.");
        let node = author::Node::new("here.again", 1).name("Again").doc("Sets its outputs again and again.");
        let node = node.output(output("first")).output(output("second")).run(|c| {
            (0..8).try_for_each(|_| fill(c, "first", 1))?;
            set_own(c, "second", 1)?;
            (0..8).try_for_each(|_| fill(c, "second", 16))?;
            set_own(c, "first", 16)
        });
        let plugin = Plugin::built_in(author::Plugin::new("here", "1.0.0").node(node)).unwrap();
        let mut registry = Registry::new();
        registry.register(node_type(&Arc::new(plugin), 0).unwrap()).unwrap();
        let mut document = Document::new();
        document.insert("n", Node::new("here.again")).unwrap();
        let mut session = Session::new(Arc::new(registry), document, Options::default());
        let report = session.evaluate(&["n.first", "n.second"], &Control::default());
        assert_eq!(report.diagnostics, []);
        for (port, value) in [("n.first", 31.0), ("n.second", 7.5)] {
            assert_eq!(session.value(port).unwrap(), Tree::column(Column::new(vec![value; 16])));
        }
    }
}
