//! The engine beside salsa and beside the plain engine that one writes first (petgraph, topological sort, hash map):
//! the same graphs, the same edits, one process, one allocator. Prints one line of JSON per measured number;
//! `cargo xtask bench engine` runs this and puts ours beside theirs.

mod graph;
mod heap;
mod ours;
mod plain;
mod salsa_peer;

use graph::{Graph, Shape};
use serde_json::json;
use std::time::{Duration, Instant};

#[global_allocator]
static ALLOCATOR: heap::Counting = heap::Counting;

/// What every engine can do.
trait Engine {
    /// Sets the number of the first node.
    fn set(&mut self, value: f64);
    /// Brings the last node up to date and gives its number.
    fn evaluate(&mut self) -> f64;
}

/// salsa calls itself once per node of a chain; ours and the plain engine would do with 2 MiB.
const STACK: usize = 4 << 30;
/// salsa has no answer to a chain that is longer than its stack.
const LARGEST_FOR_PEERS: usize = 100_000;
/// How often the engines take turns, and up to which size.
const TURNS: usize = 5;
const LARGEST_FOR_TURNS: usize = 10_000;
/// How long one figure of one engine is measured each time.
const PATIENCE: Duration = Duration::from_millis(300);

fn main() {
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let large = std::thread::Builder::new().stack_size(STACK);
    let run = move || {
        for size in sizes {
            for shape in [Shape::Chain, Shape::Fan] {
                compare(&Graph::new(shape, size));
            }
        }
        ours::small_stack();
        ours::items();
        ours::load();
        ours::threads();
    };
    let done = large.spawn(run).expect("a thread").join();
    if done.is_err() {
        std::process::exit(1);
    }
}

fn print(engine: &str, case: &str, size: usize, value: f64) {
    println!("{}", json!({"engine": engine, "case": case, "size": size, "value": value}));
}

/// The least of some runs: what the machine's other work adds is not the engine's.
fn least(rounds: usize, run: impl FnMut(usize) -> f64) -> f64 {
    (0..rounds).map(run).fold(f64::INFINITY, f64::min)
}

/// ... of as many as fit into [`PATIENCE`], and of three at least.
fn least_in_time(run: impl FnMut(usize) -> f64) -> f64 {
    let start = Instant::now();
    (0..).take_while(|i| *i < 3 || start.elapsed() < PATIENCE).map(run).fold(f64::INFINITY, f64::min)
}

/// The engines one after another, and again: on a machine that others use as well, each is measured at several times.
fn compare(graph: &Graph) {
    let turns = if graph.nodes.len() <= LARGEST_FOR_TURNS { TURNS } else { 1 };
    let peers = graph.nodes.len() <= LARGEST_FOR_PEERS;
    let mut best: [Option<Figures>; 3] = [None; 3];
    for _ in 0..turns {
        let [ours, salsa, plain] = &mut best;
        keep(ours, measure("tenon", graph, || ours::Ours::new(ours::document(graph), 1)));
        if peers {
            keep(salsa, measure("salsa 0.28", graph, || salsa_peer::Salsa::new(graph)));
            keep(plain, measure("petgraph, plain", graph, || plain::Plain::new(graph)));
        }
    }
    for (name, figures) in ["tenon", "salsa 0.28", "petgraph, plain"].into_iter().zip(best) {
        let Some(Figures { cut, full, bytes }) = figures else { continue };
        for (case, value) in [("cut_off", cut), ("full", full), ("bytes", bytes)] {
            print(name, &format!("{}_{case}", graph.shape.name()), graph.nodes.len(), value);
        }
    }
}

fn keep(best: &mut Option<Figures>, new: Figures) {
    let least = |old: Figures| Figures { cut: old.cut.min(new.cut), full: old.full.min(new.full), bytes: new.bytes };
    *best = Some(best.map_or(new, least));
}

fn micros(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() * 1e6
}

/// What an engine takes: microseconds, microseconds, bytes per node.
#[derive(Clone, Copy)]
struct Figures {
    cut: f64,
    full: f64,
    bytes: f64,
}

/// Cut-off: the source changes, the quantiser behind it does not. Full: every node changes.
fn measure<E: Engine>(name: &str, graph: &Graph, make: impl Fn() -> E) -> Figures {
    let shape = graph.shape.name();
    let mut fresh = make();
    assert_eq!(fresh.evaluate(), graph.expected(graph::FIRST), "{name} is wrong on a fresh {shape}");
    drop(fresh);
    let mut engine = None;
    let bytes = heap::grown(|| {
        let mut e = make();
        e.evaluate();
        engine = Some(e);
    });
    let mut engine = engine.expect("it was made");
    let cut = least_in_time(|i| {
        micros(|| {
            engine.set(graph::FIRST + 1.0 + (i % 400) as f64);
            engine.evaluate();
        })
    });
    let mut last = 0.0;
    let full = least_in_time(|i| {
        last = 1e6 + 7000.0 * i as f64;
        micros(|| {
            engine.set(last);
            engine.evaluate();
        })
    });
    assert_eq!(engine.evaluate(), graph.expected(last), "{name} is wrong on an edited {shape}");
    Figures { cut, full, bytes: bytes as f64 / graph.nodes.len() as f64 }
}
