//! The suite `abi`: what it costs to cross the boundary to a plugin, in this process and to one of its own. The peers are
//! what no contract can beat: a plain function pointer and memcpy. The plugin is `benches/abi/nodes.c`; `host` is the other
//! boundary.

use super::figure::Figure;
use std::hint::black_box;
use std::path::{Path, PathBuf};
use std::process::Command;
use std::time::Instant;
use tenon_plugin::abi::value::tenon_vec3;
use tenon_plugin::apart::{self, Limits, Program};
use tenon_plugin::load::{Message, Plugin, PluginNode, Sink, Views, Watch};
use tenon_plugin::value::{Branch, Items};

/// Points that cross at once.
const POINTS: usize = 10_000_000;

/// A case's name and what measures it.
type Case = (&'static str, fn() -> Result<Figure, String>);

/// Every case.
const CASES: &[Case] = &[
    ("call", || calls("call", "nothing", Some(10.0))),
    ("number", || calls("number", "number", None)),
    ("call_back", call_back),
    ("points", points),
    ("apart_number", apart_number),
    ("apart_points", apart_points),
    ("host", super::host::round_trip),
];

/// Measures the named cases, or all.
pub fn run(names: &[&str]) -> Result<(), String> {
    if let Some(strange) = names.iter().find(|n| CASES.iter().all(|(case, _)| case != *n)) {
        let known: Vec<&str> = CASES.iter().map(|(case, _)| *case).collect();
        return Err(format!("there is no case {strange}: there are {}", known.join(", ")));
    }
    let wanted = CASES.iter().filter(|(case, _)| names.is_empty() || names.contains(case));
    wanted.map(|(_, measure)| measure()).try_for_each(|figure| figure.map(|f| f.print()))
}

/// Compiles the plugin.
fn library() -> Result<PathBuf, String> {
    let library = super::super::root().join("target/bench-abi.so");
    let done = Command::new("cc")
        .args(["-std=c11", "-O2", "-shared", "-fPIC", "-I"])
        .arg(super::super::root().join("plugin-sdk/include"))
        .arg(super::super::root().join("benches/abi/nodes.c"))
        .arg("-o")
        .arg(&library)
        .output()
        .map_err(|e| format!("cc cannot be called: {e}"))?;
    if done.status.success() { Ok(library) } else { Err(String::from_utf8_lossy(&done.stderr).into_owned()) }
}

fn here() -> Result<Plugin, String> {
    Plugin::load(&library()?).map_err(|e| e.to_string())
}

/// The plugin in processes of this program, which then serves (see [`serve`]).
fn elsewhere() -> Result<Plugin, String> {
    let path = std::env::current_exe().map_err(|e| e.to_string())?;
    let program = Program { path, arguments: vec!["bench-plugin-host".into()] };
    apart::start(&library()?, &program, Limits::default()).map_err(|e| e.to_string())
}

/// A plugin's process.
pub fn serve(library: &str, memory: &str) -> Result<(), String> {
    let memory = memory.parse().map_err(|_| "no memory is said".to_owned())?;
    match apart::serve(Path::new(library), memory)? {}
}

fn node<'a>(plugin: &'a Plugin, name: &str) -> Result<&'a PluginNode, String> {
    let id = format!("abi.{name}");
    plugin.nodes.iter().find(|n| n.id == id).ok_or_else(|| format!("there is no {id}"))
}

/// Keeps what comes.
#[derive(Default)]
struct Kept {
    number: f64,
    points: Vec<tenon_vec3>,
}

impl Sink for Kept {
    fn keeps(&self) -> bool {
        true
    }
    fn set(&mut self, _: u32, mut value: Vec<Branch<'_>>) -> Result<(), String> {
        match value.pop().map(|b| b.items) {
            Some(Items::Number(v)) => self.number = v.first().copied().unwrap_or(f64::NAN),
            Some(Items::Point(v)) => self.points = v.into_owned(),
            _ => return Err("another value".into()),
        }
        Ok(())
    }
    fn forward(&mut self, _: u32, _: u32) -> Result<(), String> {
        Err("nothing is forwarded".into())
    }
    fn tell(&mut self, _: Message) {}
}

const WATCH: Watch<'static> = Watch { cancelled: &|| false, progress: &|_| (), refuse_buffer: None, room: None };

fn evaluate(node: &PluginNode, items: Items<'_>) -> Result<Kept, String> {
    let mut kept = Kept::default();
    node.evaluate(&[vec![Branch::root(items)]], WATCH, &mut kept).map_err(|e| format!("{e:?}"))?;
    Ok(kept)
}

/// Nanoseconds per run: the least of ten series.
fn nanoseconds(runs: u32, mut run: impl FnMut() -> Result<(), String>) -> Result<f64, String> {
    let mut least = f64::INFINITY;
    for _ in 0..10 {
        let start = Instant::now();
        (0..runs).try_for_each(|_| run())?;
        least = least.min(start.elapsed().as_secs_f64() * 1e9 / f64::from(runs));
    }
    Ok(least)
}

/// What a call by a plain pointer costs.
fn plain() -> Result<f64, String> {
    extern "C" fn next(x: f64) -> f64 {
        x + 1.0
    }
    let mut x = 0.0;
    nanoseconds(1_000_000, || {
        let f: extern "C" fn(f64) -> f64 = black_box(next);
        x = f(black_box(x));
        Ok(())
    })
}

fn figure(case: &'static str, size: u64, ours: f64, unit: &'static str, target: Option<f64>) -> Figure {
    Figure { suite: "abi", case, size, ours, unit, peer: None, theirs: None, target }
}

fn calls(case: &'static str, name: &str, target: Option<f64>) -> Result<Figure, String> {
    let plugin = here()?;
    let node = node(&plugin, name)?;
    let (inputs, mut kept) = ([vec![Branch::root(Items::Number(vec![1.0].into()))]], Kept::default());
    let views = Views::new(&inputs);
    let ours = nanoseconds(100_000, || node.evaluate_views(&views, WATCH, &mut kept).map_err(|e| format!("{e:?}")))?;
    Ok(Figure {
        peer: Some("plain function pointer".into()),
        theirs: Some(plain()?),
        ..figure(case, 1, ours, "ns", target)
    })
}

fn call_back() -> Result<Figure, String> {
    const TIMES: f64 = 1e6;
    let plugin = here()?;
    let node = node(&plugin, "polls")?;
    let ours = nanoseconds(1, || match evaluate(node, Items::Number(vec![TIMES].into()))?.number {
        TIMES => Ok(()),
        other => Err(format!("it asked {other} times")),
    })?;
    let peer = Some("plain function pointer".into());
    Ok(Figure { peer, theirs: Some(plain()?), ..figure("call_back", 1, ours / TIMES, "ns", Some(10.0)) })
}

/// Least milliseconds of a copy of the points, into memory that is there.
fn memcpy(points: &[tenon_vec3]) -> Result<f64, String> {
    let mut copy = points.to_vec();
    let copied = nanoseconds(1, || {
        copy.copy_from_slice(black_box(points));
        black_box(&mut copy);
        Ok(())
    })?;
    Ok(copied / 1e6)
}

fn many() -> Vec<tenon_vec3> {
    (0..POINTS).map(|i| tenon_vec3 { x: i as f64, y: 0.5, z: -1.0 }).collect()
}

/// In and out at once; that nothing is copied is seen by the addresses. The time in which the host gives zeroed memory
/// is the allocator's and is told apart.
fn points() -> Result<Figure, String> {
    let plugin = here()?;
    let (node, points) = (node(&plugin, "points")?, many());
    let (mut least, mut memory) = (f64::INFINITY, f64::INFINITY);
    for _ in 0..10 {
        let start = Instant::now();
        let kept = evaluate(node, Items::Point((&points).into()))?;
        let took = start.elapsed().as_secs_f64() * 1e3;
        let seen = kept.points.first().copied().unwrap_or_default();
        (least, memory) = (least.min(took - seen.z), memory.min(seen.z));
        let address = |v: &[tenon_vec3]| v.as_ptr().addr() as f64;
        if (seen.x, seen.y, kept.points.len()) != (address(&points), address(&kept.points), POINTS) {
            return Err("the points were copied".into());
        }
    }
    figure("buffer", POINTS as u64, memory, "ms", None).print();
    let theirs = Some(memcpy(&points)?);
    Ok(Figure {
        peer: Some("memcpy, one way".into()),
        theirs,
        ..figure("points", POINTS as u64, least, "ms", Some(1.0))
    })
}

fn apart_number() -> Result<Figure, String> {
    let plugin = elsewhere()?;
    let node = node(&plugin, "number")?;
    let ours = nanoseconds(2_000, || match evaluate(node, Items::Number(vec![1.0].into()))?.number {
        2.0 => Ok(()),
        other => Err(format!("it gave {other}")),
    })?;
    let peer = Some("plain function pointer".into());
    Ok(Figure { peer, theirs: Some(plain()? / 1e3), ..figure("apart_number", 1, ours / 1e3, "µs", Some(50.0)) })
}

/// In through shared memory, and as many out.
fn apart_points() -> Result<Figure, String> {
    let plugin = elsewhere()?;
    let (node, points) = (node(&plugin, "points")?, many());
    let ours = nanoseconds(1, || match evaluate(node, Items::Point((&points).into()))?.points.len() {
        POINTS => Ok(()),
        other => Err(format!("{other} points came")),
    })?;
    // 2 GB/s, both ways added up.
    let target = 2.0 * size_of_val(points.as_slice()) as f64 / 2e9 * 1e3;
    let theirs = Some(2.0 * memcpy(&points)?);
    let peer = Some("memcpy, both ways".into());
    Ok(Figure { peer, theirs, ..figure("apart_points", POINTS as u64, ours / 1e6, "ms", Some(target)) })
}
