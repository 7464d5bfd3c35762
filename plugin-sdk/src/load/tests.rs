//! What can be tried without a library, under miri too: a plugin made here, loaded from its descriptor.

use super::*;
use crate::abi::layout::{FIELDS, LAYOUT};
use crate::author;
use crate::from_c::text;
use crate::value::*;
use std::borrow::Cow;
use std::sync::Mutex;

/// Gives its list back in a buffer's place and as it is, with a warning, after asking from another thread.
fn back(c: &mut author::Call<'_>) -> Result<(), author::Fail> {
    c.progress(0.5)?;
    c.warn(&author::Fail::new("odd", "an odd thing").port("list").item(1));
    let tree = c.tree("list")?.to_vec();
    c.set("copy", &tree)?;
    c.forward("same", "list")
}

fn loaded(kind: fn(&'static str) -> author::Port) -> Plugin {
    let list = |name| kind(name).list().doc("Values.");
    let node = author::Node::new("here.back", 3)
        .name("Back")
        .doc("Gives back what it gets.")
        .input(list("list"))
        .output(list("copy"))
        .output(list("same"))
        .migrate(2, |from, node| if node == "bad" { Err(format!("not from {from}")) } else { Ok(node.to_uppercase()) })
        .run(back);
    let plugin = author::Plugin::new("here", "1.0.0").vendor("Us").doc("Tests.").node(node);
    // SAFETY: the descriptor was made here and lives for ever.
    unsafe { Plugin::read(plugin.leak(), "here".into()) }.unwrap()
}

/// What came, as text that tells every bit.
#[derive(Default)]
struct Came(Vec<String>);

impl Sink for Came {
    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        self.0.push(format!("set {output} {value:?}"));
        Ok(())
    }
    fn forward(&mut self, output: u32, input: u32) -> Result<(), String> {
        self.0.push(format!("forward {output} {input}"));
        Ok(())
    }
    fn tell(&mut self, message: Message) {
        self.0.push(format!("{} at {:?} {:?}", message.code, message.port, message.item));
    }
}

fn vec3(x: f64) -> tenon_vec3 {
    tenon_vec3 { x, y: 2.0, z: -1.0 }
}

/// How a port of a kind is made, and items for it.
type Sample = (fn(&'static str) -> author::Port, Items<'static>);

fn all() -> Vec<Sample> {
    let drill = Machining::Drill { entry: vec3(1.0), axis: vec3(0.0), depth: 5.0, diameter: 3.0 };
    let pocket = Machining::Pocket { outline: vec![vec3(1.0); 3].into(), axis: vec3(0.0), depth: 5.0 };
    let feature =
        |machining, edge| Feature { panel: 0, edge, joint: Some(4), by_hand: true, purpose: "screw".into(), machining };
    let features = vec![feature(drill, None), feature(pocket, Some(1))];
    let attribute = |name: &'static str, items| Attribute { name: name.into(), items, valid: None };
    let table = Table {
        rows: 2,
        attributes: vec![
            attribute("length", Items::Number(vec![1.5, 2.5].into())),
            Attribute {
                valid: Some(vec![true, false].into()),
                ..attribute("name", Items::Text(vec!["a".into(), "".into()]))
            },
        ],
    };
    let mesh = Mesh {
        points: vec![vec3(0.0), vec3(1.0), vec3(2.0)].into(),
        face_start: vec![0, 3].into(),
        face_vertices: vec![0, 1, 2].into(),
        addresses: Cow::Borrowed(&[]),
    };
    let curve = Curve {
        points: vec![tenon_vec4 { x: 1.0, y: 2.0, z: 3.0, w: 1.0 }; 2].into(),
        strip_start: vec![0, 2].into(),
        closed: false,
    };
    vec![
        (author::Port::boolean, Items::Boolean(vec![true, false].into())),
        (author::Port::integer, Items::Integer(vec![i64::MIN, 7].into())),
        (author::Port::number, Items::Number(vec![0.1, f64::MAX].into())),
        (author::Port::text, Items::Text(vec!["".into(), "Ä\0\u{1f332}".into()])),
        (author::Port::point, Items::Point(vec![vec3(1.0), vec3(3.0)].into())),
        (author::Port::vector, Items::Vector(vec![vec3(1.0), vec3(3.0)].into())),
        (author::Port::plane, Items::Plane(vec![tenon_plane { normal: vec3(0.0), offset: 3.0 }; 2].into())),
        (author::Port::curve, Items::Curve(vec![curve; 2])),
        (author::Port::mesh, Items::Mesh(vec![mesh; 2])),
        (author::Port::features, Items::Features(vec![Features { features, hardware: vec![("Screw".into(), 2)] }; 2])),
        (author::Port::table, Items::Table(vec![table; 2])),
    ]
}

#[test]
fn every_type_crosses_both_ways() {
    for (kind, items) in all() {
        let plugin = loaded(kind);
        let branch = Branch { path: Cow::Borrowed(&[2, -1]), items, valid: Some(vec![true, false].into()) };
        let (inputs, mut came, heard) = ([vec![branch]], Came::default(), Mutex::new(Vec::new()));
        let watch = Watch {
            cancelled: &|| false,
            progress: &|fraction| heard.lock().unwrap().push(fraction),
            refuse_buffer: None,
            room: None,
        };
        plugin.nodes[0].evaluate(&inputs, watch, &mut came).unwrap();
        let value = format!("set 0 {:?}", inputs[0]);
        assert_eq!(came.0, ["odd at Some(\"list\") Some(1)".to_owned(), value, "forward 1 0".to_owned()]);
        assert_eq!(heard.into_inner().unwrap(), [0.5]);
    }
}

#[test]
fn a_cancelled_evaluation_ends_so() {
    let plugin = loaded(author::Port::number);
    let watch = Watch { cancelled: &|| true, progress: &|_| (), refuse_buffer: None, room: None };
    let ended =
        plugin.nodes[0].evaluate(&[vec![Branch::root(Items::Number(vec![1.0].into()))]], watch, &mut Came::default());
    assert_eq!(ended, Err(EvaluateError::Cancelled));
}

#[test]
fn steps_from_version_to_version() {
    let plugin = loaded(author::Port::number);
    let node = &plugin.nodes[0];
    assert_eq!((node.migrate_from, node.version), (2, 3));
    assert_eq!(node.migrate(2, "good"), Ok("GOOD".into()));
    assert_eq!(node.migrate(2, "bad"), Err("not from 2".into()));
}

/// Other threads ask while and after it works, as plugins' own threads may.
#[test]
fn other_threads_may_ask_and_are_late_afterwards() {
    struct Far(*const tenon_call);
    // SAFETY: what it leads to is there for ever and any thread may ask by it.
    unsafe impl Send for Far {}
    static FAR: Mutex<Option<Far>> = Mutex::new(None);
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        *FAR.lock().unwrap() = Some(Far(call));
        let far = Far(call);
        let ask = move || {
            let far = far;
            // SAFETY: the call is under way.
            (unsafe { ((*far.0).cancelled)(far.0) }, unsafe { ((*far.0).forward)(far.0, 0, 0) })
        };
        // To ask is allowed, to set is not.
        assert_eq!(std::thread::spawn(ask).join().unwrap(), (0, TENON_BAD_ARGUMENT));
        TENON_OK
    }
    let mut plugin = loaded(author::Port::number);
    plugin.nodes[0].body = Body::Here { evaluate, migrate: None, data: std::ptr::null_mut() };
    let watch = Watch { cancelled: &|| false, progress: &|_| (), refuse_buffer: None, room: None };
    let ended = plugin.nodes[0].evaluate(&[Vec::new()], watch, &mut Came::default());
    assert!(matches!(ended, Err(EvaluateError::Fault(why)) if why.contains("calls back from a thread")));
    let (before, far) = (late_calls(), FAR.lock().unwrap().take().unwrap());
    let late = std::thread::spawn(move || {
        let far = far;
        // SAFETY: slots are never freed.
        unsafe { ((*far.0).cancelled)(far.0) }
    });
    assert_eq!(late.join().unwrap(), 1);
    assert!(late_calls() > before);
}

fn of(node: author::Node) -> Result<Plugin, LoadFault> {
    let (port, doc) = (author::Port::number("x").doc("A number."), "Does something.");
    Plugin::built_in(author::Plugin::new("here", "1.0.0").node(node.name("Node").doc(doc).input(port)))
}

const QUIET: Watch<'static> = Watch { cancelled: &|| false, progress: &|_| (), refuse_buffer: None, room: None };

/// A layout as a plugin would carry it that was built from a changed source: one field lies elsewhere, or is new.
fn read_with(change: impl Fn(&mut tenon_field)) -> Result<Plugin, LoadFault> {
    let (mut fields, mut plugin) = (Vec::new(), *described());
    for f in FIELDS {
        let (of, name) = (tenon_str::of(f.of), tenon_str::of(f.name));
        let mut field = tenon_field { of, name, offset: f.offset, bytes: f.bytes };
        change(&mut field);
        fields.push(field);
    }
    let layout = tenon_layout { digest: LAYOUT.digest ^ 1, fields: fields.as_ptr(), ..LAYOUT };
    plugin.layout = &raw const layout;
    // SAFETY: a descriptor whose pointers are good until it was read.
    unsafe { Plugin::read(&raw const plugin, "here".into()) }
}

fn number_node() -> author::Node {
    let output = author::Port::number("y").doc("A number.");
    author::Node::new("here.node", 1).output(output).run(|c| c.set_number("y", c.number("x")?))
}

fn described() -> &'static tenon_plugin {
    let input = author::Port::number("x").doc("A number.");
    author::Plugin::new("here", "1.0.0").node(number_node().name("Node").doc("Does something.").input(input)).leak()
}

/// The struct and the field that an entry is about.
fn is(field: &tenon_field, of: &str, name: &str) -> bool {
    // SAFETY: texts made of our own names.
    unsafe { text(field.of, "of") == Ok(of) && text(field.name, "name") == Ok(name) }
}

#[test]
fn a_plugin_that_was_laid_out_otherwise_is_refused_by_the_field() {
    let refused = |of: &str, name: &str, offset: u32, bytes: u32| {
        let moved = read_with(|f| {
            if is(f, of, name) {
                (f.offset, f.bytes) = (f.offset + offset, f.bytes + bytes);
            }
        });
        moved.unwrap_err().to_string()
    };
    let told = refused("tenon_feature", "depth", 4, 0);
    let lines: Vec<&str> = told.lines().collect();
    assert_eq!(lines[0], "tenon_feature.depth is 8 bytes after 100 in the plugin and 8 bytes after 96 in this program");
    assert!(lines[1].starts_with("build it anew") && lines[1].contains("plugin-sdk"), "{told}");
    assert_eq!(lines.len(), 2);
    assert!(refused("tenon_mesh", "flags", 0, 4).starts_with("tenon_mesh.flags is 8 bytes after 4 in the plugin"));
    assert!(
        refused("tenon_vec3", "", 0, 8).starts_with("tenon_vec3 has 32 bytes in the plugin and 24 in this program")
    );
}

#[test]
fn a_field_of_another_type_is_refused_where_it_is_as_large() {
    let told = |of: &str, name: &str, number: u32| {
        let other = read_with(|f| {
            if is(f, of, &format!("{name}: type")) {
                f.offset ^= number;
            }
        });
        other.map(drop).map_err(|e| e.to_string())
    };
    let why = told("tenon_feature", "depth", 1).unwrap_err();
    assert!(why.starts_with("tenon_feature.depth has another type in the plugin than in this program\n"), "{why}");
    assert!(told("tenon_call", "set", 1).unwrap_err().starts_with("tenon_call.set has another type"));
    assert_eq!(told("tenon_call", "set", 0), Ok(()));
    // Numbers tell apart what is equally large, and functions by what they take and give.
    let number = |of: &str, name: &str| {
        let entry = FIELDS.iter().find(|f| f.of == of && f.name.strip_suffix(": type") == Some(name)).unwrap();
        (entry.offset, entry.bytes)
    };
    let kinds = [
        ("tenon_feature", "depth"),
        ("tenon_column", "count"),
        ("tenon_column", "items"),
        ("tenon_column", "valid"),
        ("tenon_node_type", "data"),
        ("tenon_call", "set"),
        ("tenon_call", "forward"),
        ("tenon_call", "tell"),
        ("tenon_call", "progress"),
    ];
    let numbers: std::collections::BTreeSet<_> = kinds.iter().map(|(of, name)| number(of, name)).collect();
    assert_eq!(numbers.len(), kinds.len());
    assert_eq!(number("tenon_column", "count"), number("tenon_tree", "branch_count"));
    // The same in every build: FNV-1a of "f64".
    assert_eq!(number("tenon_feature", "depth"), (F64 as u32, (F64 >> 32) as u32));
}

/// FNV-1a of "f64".
const F64: u64 = 0xdd74_4c18_ff7e_a1ab;

#[test]
fn a_layout_that_only_grew_is_taken() {
    assert!(read_with(|_| ()).is_ok());
    // A field, and a struct, that we do not know yet; and one of ours that the plugin does not know yet.
    let new = |of: &str, name: &str| {
        read_with(|f| {
            if is(f, of, name) {
                (f.name, f.offset) = (tenon_str::of("more"), 1000);
            }
        })
    };
    assert!(new("tenon_node_type", "migrate").is_ok());
    assert!(new("tenon_layout", "").is_ok());
    // And none at all, as in C.
    let plugin = tenon_plugin { layout: std::ptr::null(), ..*described() };
    // SAFETY: a descriptor made by the author layer.
    assert!(unsafe { Plugin::read(&raw const plugin, "here".into()) }.is_ok());
}

#[test]
fn a_layout_that_cannot_be_read_is_refused() {
    let spoilt = |layout: tenon_layout| {
        let plugin = tenon_plugin { layout: &raw const layout, ..*described() };
        // SAFETY: a descriptor whose pointers are good until it was read.
        unsafe { Plugin::read(&raw const plugin, "here".into()) }.unwrap_err().to_string()
    };
    let other = tenon_layout { digest: 0, ..LAYOUT };
    assert!(spoilt(tenon_layout { size: 8, ..other }).contains("the size of tenon_layout is 8"));
    for wrong in [
        tenon_layout { fields: std::ptr::null(), ..other },
        tenon_layout { field_stride: 8, ..other },
        tenon_layout { field_count: u64::MAX, ..other },
    ] {
        assert!(spoilt(wrong).contains("fields at"), "{wrong:?}");
    }
}

#[test]
fn the_digest_is_what_the_header_says() {
    let mut hash = 0xcbf2_9ce4_8422_2325_u64;
    for f in FIELDS {
        let words =
            [f.of.as_bytes(), &[0], f.name.as_bytes(), &[0], &f.offset.to_le_bytes(), &f.bytes.to_le_bytes()].concat();
        words.iter().for_each(|b| hash = (hash ^ u64::from(*b)).wrapping_mul(0x100_0000_01b3));
    }
    assert_eq!(LAYOUT.digest, hash);
    assert!(FIELDS.len() > 150);
}

#[test]
fn trees_notes_and_questions_in_rust() {
    let node = author::Node::new("here.tree", 1)
        .name("Tree")
        .doc("Turns branches round.")
        .input(author::Port::number("tree").tree().doc("Branches."))
        .output(author::Port::number("turned").tree().doc("The same from the end."))
        .run(|c| {
            if c.cancelled() {
                return Err(author::Fail::cancelled());
            }
            c.note(&author::Fail::new("turned", "they were turned round").port("tree"));
            let turned: Vec<Branch<'_>> = c.tree("tree")?.iter().rev().cloned().collect();
            c.set("turned", &turned)
        });
    let plugin = Plugin::built_in(author::Plugin::new("here", "1.0.0").node(node)).unwrap();
    let node = &plugin.nodes[0];
    assert_eq!((node.inputs[0].access, node.outputs[0].access), (TENON_TREE, TENON_TREE));
    let branch = |path: &'static [i32], x: f64| Branch {
        path: Cow::Borrowed(path),
        items: Items::Number(vec![x].into()),
        valid: None,
    };
    let (inputs, mut came) = ([vec![branch(&[0, 1], 1.0), branch(&[0, 7], 2.0)]], Came::default());
    node.evaluate(&inputs, QUIET, &mut came).unwrap();
    let turned = vec![inputs[0][1].clone(), inputs[0][0].clone()];
    assert_eq!(came.0, ["turned at Some(\"tree\") None".to_owned(), format!("set 0 {turned:?}")]);
    let stop = Watch { cancelled: &|| true, ..QUIET };
    assert_eq!(node.evaluate(&inputs, stop, &mut Came::default()), Err(EvaluateError::Cancelled));
}

/// Whether what comes is owned, which means that it was not copied: a buffer changed hands.
#[derive(Default)]
struct Owned(Vec<bool>);

impl Sink for Owned {
    fn keeps(&self) -> bool {
        true
    }
    fn set(&mut self, _: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        let cows = |c: &Curve<'_>| [matches!(c.points, Cow::Owned(_)), matches!(c.strip_start, Cow::Owned(_))];
        for branch in &value {
            match &branch.items {
                Items::Number(v) => self.0.push(matches!(v, Cow::Owned(_))),
                Items::Curve(v) => self.0.extend(v.iter().flat_map(cows)),
                _ => return Err("another value".into()),
            }
        }
        Ok(())
    }
    fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
        Err("nothing is forwarded".into())
    }
    fn tell(&mut self, message: Message) {
        assert_eq!(message.code, "no-memory");
    }
}

#[test]
fn buffers_go_over_without_a_copy_from_rust_too() {
    let node = number_node().run(|c| {
        c.fill("y", |c| {
            let numbers = c.buffer::<f64>(3)?;
            assert_eq!(numbers, [0.0; 3]);
            numbers[1] = c.number("x")?;
            Ok(Items::Number((&*numbers).into()))
        })?;
        c.fill("y", |c| {
            let (points, starts) = (c.buffer::<tenon_vec4>(4)?, c.buffer::<u32>(3)?);
            (starts[1], starts[2]) = (2, 4);
            let curve = Curve { points: (&*points).into(), strip_start: (&*starts).into(), closed: false };
            Ok(Items::Curve(vec![curve]))
        })
    });
    let (plugin, inputs) = (of(node).unwrap(), [vec![Branch::root(Items::Number(vec![5.0].into()))]]);
    let mut came = Owned::default();
    plugin.nodes[0].evaluate(&inputs, QUIET, &mut came).unwrap();
    assert_eq!(came.0, [true; 3]);
    for k in 0..3 {
        let watch = Watch { refuse_buffer: Some(k), ..QUIET };
        assert_eq!(plugin.nodes[0].evaluate(&inputs, watch, &mut Owned::default()), Err(EvaluateError::Failed));
    }
}

#[test]
fn a_buffer_can_be_given_once() {
    let node = number_node().run(|c| {
        c.fill("y", |c| {
            let points = &*c.buffer::<tenon_vec4>(4)?;
            let curve = |points| Curve { points: Cow::Borrowed(points), strip_start: vec![0, 2].into(), closed: false };
            // The second lies in the first, which may be gone when it is read.
            Ok(Items::Curve(vec![Curve { strip_start: vec![0, 4].into(), ..curve(points) }, curve(&points[1..3])]))
        })
    });
    let (plugin, inputs) = (of(node).unwrap(), [vec![Branch::root(Items::Number(vec![5.0].into()))]]);
    let ended = plugin.nodes[0].evaluate(&inputs, QUIET, &mut Deaf);
    assert_eq!(ended, Err(EvaluateError::Fault("output 0: two arrays share memory of one buffer".into())));
}

type Evaluate = unsafe extern "C" fn(*mut c_void, *const tenon_call, *const tenon_tree, u32) -> i32;

/// A column as a plugin in C gives it, by raw pointers.
fn column_raw(kind: tenon_kind, items: *const c_void, count: u64, valid: *const u8) -> tenon_column {
    let stride = match kind {
        TENON_BOOLEAN => 1,
        TENON_TEXT => size_of::<tenon_str>(),
        TENON_CURVE => size_of::<tenon_curve>(),
        TENON_FEATURES => size_of::<tenon_features>(),
        TENON_EDGES => size_of::<tenon_edge_pair>(),
        _ => 8,
    };
    let (size, type_name) = (size_of::<tenon_column>() as u32, tenon_str::of(""));
    tenon_column { size, kind, type_name, items, count, stride: stride as u64, valid }
}

fn branch_raw(column: tenon_column) -> tenon_branch {
    tenon_branch { path: std::ptr::null(), path_count: 0, column }
}

fn set_branches(call: *const tenon_call, output: u32, branches: *const tenon_branch, branch_count: u64) -> i32 {
    let (size, branch_stride) = (size_of::<tenon_tree>() as u32, size_of::<tenon_branch>() as u32);
    let tree = tenon_tree { size, branch_stride, branches, branch_count };
    // SAFETY: the call is under way, and the value lives through it.
    unsafe { ((*call).set)(call, output, &raw const tree) }
}

/// One column at `{0}`.
fn set_column(call: *const tenon_call, output: u32, column: tenon_column) -> i32 {
    let branch = branch_raw(column);
    set_branches(call, output, &raw const branch, 1)
}

/// Three items at `{0}`.
fn set_raw(call: *const tenon_call, output: u32, kind: tenon_kind, items: *const c_void, valid: *const u8) -> i32 {
    set_column(call, output, column_raw(kind, items, 3, valid))
}

fn set_numbers(call: *const tenon_call, items: *const c_void, count: u64) -> i32 {
    set_column(call, 0, column_raw(TENON_NUMBER, items, count, std::ptr::null()))
}

fn buffer_of(call: *const tenon_call, element: tenon_element, count: u64) -> *mut c_void {
    // SAFETY: the call is under way.
    unsafe { ((*call).buffer)(call, element, count) }
}

fn buffer_raw(call: *const tenon_call, element: tenon_element) -> *mut c_void {
    buffer_of(call, element, 3)
}

fn run_raw(evaluate: Evaluate) -> (Result<(), EvaluateError>, Vec<String>) {
    let mut came = Came::default();
    (run_raw_with(evaluate, &mut came), came.0)
}

fn run_raw_with(evaluate: Evaluate, sink: &mut dyn Sink) -> Result<(), EvaluateError> {
    run_raw_watched(evaluate, QUIET, sink)
}

/// Memory that somebody else has.
fn room(bytes: u64) -> Option<std::ptr::NonNull<u8>> {
    let words: &mut [u64] = vec![0; bytes.div_ceil(8) as usize].leak();
    std::ptr::NonNull::new(words.as_mut_ptr().cast())
}

fn run_raw_watched(evaluate: Evaluate, watch: Watch<'_>, sink: &mut dyn Sink) -> Result<(), EvaluateError> {
    let mut plugin = loaded(author::Port::number);
    plugin.nodes[0].body = Body::Here { evaluate, migrate: None, data: std::ptr::null_mut() };
    plugin.nodes[0].evaluate(&[Vec::new()], watch, sink)
}

#[test]
fn one_valid_serves_many_outputs() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let valid = buffer_raw(call, TENON_U8).cast::<u8>();
        // SAFETY: three bytes of the host.
        unsafe { valid.copy_from([1_u8, 0, 1].as_ptr(), 3) };
        (0..2)
            .map(|output| set_raw(call, output, TENON_NUMBER, buffer_raw(call, TENON_F64), valid))
            .find(|status| *status != TENON_OK)
            .unwrap_or(TENON_OK)
    }
    let (ended, came) = run_raw(evaluate);
    assert_eq!(ended, Ok(()));
    assert_eq!(came.len(), 2);
    assert!(came.iter().all(|c| c.contains("[true, false, true]")), "{came:?}");
}

#[test]
fn a_buffer_of_two_outputs_is_refused_and_not_read_again() {
    unsafe extern "C" fn numbers(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let buffer = buffer_raw(call, TENON_F64);
        let none = std::ptr::null();
        assert_eq!(set_raw(call, 0, TENON_NUMBER, buffer, none), TENON_OK);
        // The whole of it, and from its middle.
        assert_eq!(set_raw(call, 1, TENON_NUMBER, buffer, none), TENON_BAD_TYPE);
        assert_eq!(set_raw(call, 1, TENON_NUMBER, buffer.wrapping_byte_add(8), none), TENON_BAD_TYPE);
        TENON_OK
    }
    unsafe extern "C" fn truths(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let buffer = buffer_raw(call, TENON_U8);
        assert_eq!(set_raw(call, 0, TENON_BOOLEAN, buffer, std::ptr::null()), TENON_OK);
        assert_eq!(set_raw(call, 1, TENON_NUMBER, buffer_raw(call, TENON_F64), buffer.cast()), TENON_BAD_TYPE);
        TENON_OK
    }
    let fault = || Err(EvaluateError::Fault("output 1: two arrays share memory of one buffer".into()));
    for evaluate in [numbers, truths] as [Evaluate; 2] {
        let (ended, came) = run_raw(evaluate);
        assert_eq!(ended, fault());
        assert_eq!(came.len(), 1, "{came:?}");
        // Also where the sink has what was given.
        assert_eq!(run_raw_with(evaluate, &mut Forgetful), fault());
        // And where somebody else has the memory, as beside a plugin in its own process.
        let mut came = Came::default();
        assert_eq!(run_raw_watched(evaluate, Watch { room: Some(&room), ..QUIET }, &mut came), fault());
        assert_eq!(came.0.len(), 1, "{:?}", came.0);
    }
}

/// Keeps what comes, for ever, but lets go at once what the host lets go.
struct Forgetful;

impl Sink for Forgetful {
    fn keeps(&self) -> bool {
        true
    }
    fn set(&mut self, _: u32, value: Vec<Branch<'_>>) -> Result<(), String> {
        for mut branch in value {
            if let (Items::Curve(curves), Some(valid)) = (&mut branch.items, &branch.valid) {
                let mut valid = valid.iter();
                curves.retain(|_| valid.next() == Some(&true));
            }
            if branch.items.len() > 1 || !matches!(branch.items, Items::Number(_)) {
                std::mem::forget(branch);
            }
        }
        Ok(())
    }
    fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
        Ok(())
    }
    fn tell(&mut self, _: Message) {}
}

/// Whether many arrays of the plugin's own are accepted, all there at once, so that one of them lies wherever memory of as
/// many numbers was freed before.
fn own_are_accepted<const N: usize>(call: *const tenon_call) -> bool {
    let own: Vec<Box<[f64; N]>> = (0..32).map(|i| Box::new([f64::from(i); N])).collect();
    own.iter().all(|own| set_numbers(call, own.as_ptr().cast(), N as u64) == TENON_OK)
}

#[test]
fn what_the_host_lets_go_stays_in_its_buffer() {
    unsafe extern "C" fn single(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        for _ in 0..3 {
            let one = buffer_of(call, TENON_F64, 1);
            assert_eq!(set_numbers(call, one, 1), TENON_OK);
        }
        assert!(own_are_accepted::<1>(call));
        TENON_OK
    }
    unsafe extern "C" fn gap(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let curve = || tenon_curve {
            size: size_of::<tenon_curve>() as u32,
            closed: 0,
            points: buffer_of(call, TENON_VEC4, 4).cast(),
            point_count: 4,
            strip_start: std::ptr::null(),
            strip_count: 0,
        };
        let (curves, valid) = ([curve(), curve()], [1_u8, 0]);
        let column = column_raw(TENON_CURVE, curves.as_ptr().cast(), 2, valid.as_ptr());
        assert_eq!(set_column(call, 0, column), TENON_OK);
        assert!(own_are_accepted::<16>(call));
        // Both were given all the same.
        let again = column_raw(TENON_NUMBER, curves[1].points.cast(), 16, std::ptr::null());
        set_column(call, 0, again)
    }
    unsafe extern "C" fn truths(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let column = column_raw(TENON_BOOLEAN, buffer_of(call, TENON_U8, 128), 128, std::ptr::null());
        assert_eq!(set_column(call, 0, column), TENON_OK);
        assert!(own_are_accepted::<16>(call));
        TENON_OK
    }
    assert_eq!(run_raw_with(single, &mut Forgetful), Ok(()));
    assert_eq!(run_raw_with(truths, &mut Forgetful), Ok(()));
    let fault = "output 0: two arrays share memory of one buffer".to_owned();
    assert_eq!(run_raw_with(gap, &mut Forgetful), Err(EvaluateError::Fault(fault)));
}

#[test]
fn a_part_of_a_buffer_is_copied_and_leaves_it_to_the_plugin() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let numbers = buffer_of(call, TENON_F64, 4);
        for (first, count) in [(1.5, 2), (2.5, 3), (3.5, 4)] {
            // SAFETY: four numbers of the host.
            unsafe { numbers.cast::<f64>().write(first) };
            assert_eq!(set_numbers(call, numbers, count), TENON_OK);
        }
        assert_eq!(set_numbers(call, buffer_of(call, TENON_F64, 4), 5), TENON_BAD_TYPE);
        TENON_OK
    }
    let (ended, came) = run_raw(evaluate);
    let fault = "output 0: numbers: 5 is impossible: longer than its buffer".to_owned();
    assert_eq!(ended, Err(EvaluateError::Fault(fault)));
    assert_eq!(came.len(), 3);
    let first = [("1.5, 0.0]", 0), ("2.5, 0.0, 0.0]", 1), ("3.5, 0.0, 0.0, 0.0]", 2)];
    assert!(first.iter().all(|(told, i)| came[*i].contains(told)), "{came:?}");
    // Copied also where somebody else has the memory, which the plugin may write to yet: only the whole is shown as it lies.
    let mut came = Owned::default();
    run_raw_watched(evaluate, Watch { room: Some(&room), ..QUIET }, &mut came).unwrap_err();
    assert_eq!(came.0, [true, true, false]);
}

#[test]
fn the_line_of_what_has_none_is_not_read() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let line = buffer_raw(call, TENON_VEC3);
        for kind in [TENON_DRILL, TENON_SLOT, TENON_ENGRAVING, TENON_CONTOUR] {
            let (none, at) = (tenon_str { ptr: std::ptr::null(), len: 0 }, tenon_vec3::default());
            let (size, line, line_count) = (size_of::<tenon_feature>() as u32, line.cast(), 3);
            let (panel, edge, joint, by_hand, depth, width) = (0, TENON_NONE, TENON_NONE, 0, 1.0, 1.0);
            let (to, axis, text, purpose) = (at, at, none, none);
            let feature = tenon_feature {
                size,
                kind,
                panel,
                edge,
                joint,
                by_hand,
                at,
                to,
                axis,
                depth,
                width,
                line,
                line_count,
                text,
                purpose,
            };
            let features = tenon_features {
                size: size_of::<tenon_features>() as u32,
                feature_stride: size,
                features: &raw const feature,
                feature_count: 1,
                hardware: std::ptr::null(),
                hardware_count: 0,
            };
            let column = column_raw(TENON_FEATURES, (&raw const features).cast(), 1, std::ptr::null());
            assert_eq!(set_column(call, 0, column), TENON_OK, "{kind}");
        }
        set_raw(call, 0, TENON_POINT, line, std::ptr::null())
    }
    let (ended, came) = run_raw(evaluate);
    assert!(matches!(ended, Err(EvaluateError::Fault(why)) if why.contains("stride")));
    assert_eq!(came.len(), 4);
}

/// The bytes of a `valid` as they were when it was given, though its buffer becomes truth values in place afterwards.
#[test]
fn a_valid_may_be_given_as_truth_values_after_that() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let bytes = buffer_raw(call, TENON_U8).cast::<u8>();
        // SAFETY: three bytes of the host.
        unsafe { bytes.copy_from([1_u8, 0, 1].as_ptr(), 3) };
        let branches = [
            branch_raw(column_raw(TENON_NUMBER, buffer_raw(call, TENON_F64), 3, bytes)),
            branch_raw(column_raw(TENON_BOOLEAN, bytes.cast(), 3, std::ptr::null())),
        ];
        set_branches(call, 0, branches.as_ptr(), 2)
    }
    struct Both(usize);
    impl Sink for Both {
        fn keeps(&self) -> bool {
            true
        }
        fn set(&mut self, _: u32, mut value: Vec<Branch<'_>>) -> Result<(), String> {
            let (Some(last), Some(first)) = (value.pop(), value.pop()) else { return Err("no two".into()) };
            let Items::Boolean(truths) = last.items else { return Err("no truth values".into()) };
            assert!(matches!(&truths, Cow::Owned(v) if *v == [true, false, true]));
            // Written where they lie.
            assert_eq!(truths.into_owned().iter_mut().map(|truth| *truth = false).count(), 3);
            assert_eq!(first.valid.as_deref(), Some(&[true, false, true][..]));
            self.0 += 1;
            Ok(())
        }
        fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
            Ok(())
        }
        fn tell(&mut self, _: Message) {}
    }
    let mut both = Both(0);
    assert_eq!((run_raw_with(evaluate, &mut both), both.0), (Ok(()), 1));
}

#[test]
fn whatever_lies_in_a_given_buffer_is_refused() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let given = buffer_of(call, TENON_F64, 32);
        assert_eq!(set_numbers(call, given, 32), TENON_OK);
        let none = std::ptr::null();
        let here = tenon_str { ptr: given.cast(), len: 3 };
        let (one, number) = ([here], 1.0_f64);
        let numbers = column_raw(TENON_NUMBER, (&raw const number).cast(), 1, none);
        let texts = column_raw(TENON_TEXT, one.as_ptr().cast(), 1, none);
        let hardware = tenon_features {
            size: size_of::<tenon_features>() as u32,
            feature_stride: size_of::<tenon_feature>() as u32,
            features: std::ptr::null(),
            feature_count: 0,
            hardware: given.cast(),
            hardware_count: 2,
        };
        let features = tenon_features { features: given.cast(), feature_count: 1, hardware_count: 0, ..hardware };
        let struct_at = |of: *const tenon_features| branch_raw(column_raw(TENON_FEATURES, of.cast(), 1, none));
        let in_it = [
            tenon_branch { path: given.cast(), path_count: 2, ..branch_raw(numbers) },
            branch_raw(tenon_column { valid: given.cast(), ..numbers }),
            branch_raw(texts),
            branch_raw(column_raw(TENON_TEXT, given, 2, none)),
            branch_raw(column_raw(TENON_EDGES, given, 1, none)),
            branch_raw(column_raw(TENON_CURVE, given, 1, none)),
            struct_at(&raw const hardware),
            struct_at(&raw const features),
            branch_raw(tenon_column { type_name: here, ..column_raw(TENON_OPAQUE, none.cast(), 1, none) }),
        ];
        for (i, branch) in in_it.iter().enumerate() {
            assert_eq!(set_branches(call, 1, branch, 1), TENON_BAD_TYPE, "{i}");
        }
        assert_eq!(set_branches(call, 1, given.cast(), 1), TENON_BAD_TYPE);
        // The last of it alone.
        assert_eq!(set_numbers(call, given.wrapping_byte_add(31 * 8), 1), TENON_BAD_TYPE);
        let empty = tenon_str { ptr: std::ptr::null(), len: 0 };
        let (size, severity, item) = (size_of::<tenon_message>() as u32, TENON_NOTE, u64::MAX);
        let message = tenon_message { size, severity, code: empty, message: here, hint: empty, port: empty, item };
        // SAFETY: the call is under way.
        assert_eq!(unsafe { ((*call).tell)(call, &raw const message) }, TENON_BAD_ARGUMENT);
        TENON_OK
    }
    let (ended, came) = run_raw(evaluate);
    assert_eq!(ended, Err(EvaluateError::Fault("output 1: two arrays share memory of one buffer".into())));
    assert_eq!(came.len(), 1, "{came:?}");
}

/// What was given is let go by the host at once here, so that its place may be that of the next.
#[test]
fn the_place_of_a_buffer_that_is_gone_may_be_that_of_another() {
    unsafe extern "C" fn evaluate(_: *mut c_void, call: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        let set = |_| set_raw(call, 0, TENON_NUMBER, buffer_raw(call, TENON_F64), std::ptr::null());
        (0..100).map(set).find(|status| *status != TENON_OK).unwrap_or(TENON_OK)
    }
    let mut came = Owned::default();
    let ended = run_raw_with(evaluate, &mut came);
    assert_eq!((ended, came.0), (Ok(()), vec![true; 100]));
}

#[test]
fn without_memory_is_an_error_that_the_host_tells() {
    unsafe extern "C" fn evaluate(_: *mut c_void, _: *const tenon_call, _: *const tenon_tree, _: u32) -> i32 {
        TENON_NO_MEMORY
    }
    let (ended, came) = run_raw(evaluate);
    assert_eq!((ended, came), (Err(EvaluateError::Failed), vec!["no-memory at None None".to_owned()]));
}

#[test]
fn a_panic_of_a_plugin_in_rust_is_the_nodes_error() {
    #[derive(Default)]
    struct Words(String);
    impl Sink for Words {
        fn set(&mut self, _: u32, _: Vec<Branch<'_>>) -> Result<(), String> {
            Ok(())
        }
        fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
            Ok(())
        }
        fn tell(&mut self, message: Message) {
            self.0 = format!("{}: {}", message.code, message.message);
        }
    }
    let step = |_: u32, _: &str| -> Result<String, String> { panic!("no step") };
    let plugin = of(number_node().migrate(0, step).run(|_| panic!("no {}", "run"))).unwrap();
    let mut words = Words::default();
    let ended = plugin.nodes[0].evaluate(&[vec![Branch::root(Items::Number(vec![5.0].into()))]], QUIET, &mut words);
    assert_eq!(ended, Err(EvaluateError::Failed));
    assert_eq!(words.0, "plugin-panic: the plugin has a fault: no run");
    assert_eq!(plugin.nodes[0].migrate(0, "{}"), Err("the plugin has a fault: no step".into()));
}

mod panics {
    crate::export!(made);
    fn made() -> crate::author::Plugin {
        panic!("no plugin")
    }
    pub fn entry() -> *const crate::abi::plugin::tenon_plugin {
        tenon_plugin_v1()
    }
}

#[test]
fn a_panic_while_a_plugin_describes_itself_is_no_plugin() {
    assert!(panics::entry().is_null());
    // SAFETY: NULL is what the contract has for it.
    let refused = unsafe { Plugin::read(panics::entry(), "here".into()) }.unwrap_err();
    assert!(refused.to_string().contains("gave 0x0"), "{refused}");
}

/// Takes whatever comes.
struct Deaf;

impl Sink for Deaf {
    fn set(&mut self, _: u32, _: Vec<Branch<'_>>) -> Result<(), String> {
        Ok(())
    }
    fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
        Ok(())
    }
    fn tell(&mut self, _: Message) {}
}
