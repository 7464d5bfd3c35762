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
use std::time::Instant;

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

fn main() {
    let sizes: Vec<usize> = std::env::args().skip(1).filter_map(|a| a.parse().ok()).collect();
    let large = std::thread::Builder::new().stack_size(STACK);
    let run = move || {
        for size in sizes {
            for shape in [Shape::Chain, Shape::Fan] {
                let graph = Graph::new(shape, size);
                measure("tenon", &graph, || ours::Ours::new(ours::document(&graph), 1));
                if size <= LARGEST_FOR_PEERS {
                    measure("salsa 0.28", &graph, || salsa_peer::Salsa::new(&graph));
                    measure("petgraph, plain", &graph, || plain::Plain::new(&graph));
                }
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
fn least(rounds: usize, mut run: impl FnMut(usize) -> f64) -> f64 {
    (0..rounds).map(&mut run).fold(f64::INFINITY, f64::min)
}

fn micros(run: impl FnOnce()) -> f64 {
    let start = Instant::now();
    run();
    start.elapsed().as_secs_f64() * 1e6
}

/// Cut-off: the source changes, the quantiser behind it does not. Full: every node changes.
fn measure<E: Engine>(name: &str, graph: &Graph, make: impl Fn() -> E) {
    let (size, shape) = (graph.nodes.len(), graph.shape.name());
    let mut fresh = make();
    assert_eq!(fresh.evaluate(), graph.expected(graph::FIRST), "{name} is wrong on a fresh {shape}");
    drop(fresh);
    let mut engine = None;
    let bytes = heap::grown(|| {
        let mut e = make();
        e.evaluate();
        engine = Some(e);
    });
    let Some(mut engine) = engine else { return };
    let rounds = (2_000_000 / size).clamp(3, 200);
    let cut = least(rounds.max(50), |i| {
        micros(|| {
            engine.set(graph::FIRST + 1.0 + (i % 400) as f64);
            engine.evaluate();
        })
    });
    let mut last = 0.0;
    let full = least(rounds, |i| {
        last = 1e6 + 7000.0 * i as f64;
        micros(|| {
            engine.set(last);
            engine.evaluate();
        })
    });
    assert_eq!(engine.evaluate(), graph.expected(last), "{name} is wrong on an edited {shape}");
    print(name, &format!("{shape}_cut_off"), size, cut);
    print(name, &format!("{shape}_full"), size, full);
    print(name, &format!("{shape}_bytes"), size, bytes as f64 / size as f64);
}
