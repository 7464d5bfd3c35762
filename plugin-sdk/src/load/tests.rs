//! What can be tried without a library, under miri too: a plugin made here, loaded from its descriptor.

use super::*;
use crate::author;
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
