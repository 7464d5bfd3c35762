//! `cargo xtask bench editor`: what the window costs. `logic` is without drawing, `drawn` with the software adapter, `real` a
//! window on a screen of its own where Xvfb is installed, `panels` many panels; all of them if none is named. One JSON line
//! per figure.

mod drawn;
mod logic;
mod real;

use eframe::egui::vec2;
use eframe::egui_wgpu::RenderState;
use egui_kittest::Harness;
use serde_json::json;
use std::path::{Path, PathBuf};
use std::time::Duration;
use tenon_editor::app::App;
use tenon_engine::{Node, Operation};

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn print(case: &str, size: usize, ours: f64, unit: &str, target: Option<f64>) {
    let round = |x: f64| (x * 1e3).round() / 1e3;
    let line =
        json!({ "suite": "editor", "case": case, "size": size, "ours": round(ours), "unit": unit, "target": target });
    println!("{line}");
}

/// Prints the median of some times, and the worst.
fn print_times(case: &str, size: usize, times: Vec<Duration>, target: Option<f64>) {
    let ms = |t: Duration| (t.as_secs_f64() * 1e6).round() / 1e3;
    let worst = times.iter().max().map(|t| ms(*t));
    let ours = (median(times) * 1e3).round() / 1e3;
    let line = json!({
        "suite": "editor", "case": case, "size": size, "ours": ours, "worst": worst, "unit": "ms", "target": target
    });
    println!("{line}");
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times.get(times.len() / 2).map_or(f64::NAN, |t| t.as_secs_f64() * 1e3)
}

/// A copy of the shell of 256 panels, beside which a window may leave what it wants.
fn shell() -> PathBuf {
    let from = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/shell-256/shell-256.tenon.json");
    let to = folder().join("shell-256.tenon.json");
    std::fs::copy(from, &to).expect("the example is there");
    to
}

/// A folder that is removed in the end.
fn folder() -> PathBuf {
    let folder = std::env::temp_dir().join(format!("tenon-bench-{}", std::process::id()));
    std::fs::create_dir_all(&folder).expect("there is room for files");
    folder
}

/// A window without a screen, as large as the real one is at first; without an adapter, and so without the viewport.
fn open(graph: Option<&Path>) -> Harness<'static, App> {
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_max_steps(64);
    builder.build_eframe(|cc| App::new(cc, graph).expect("a thread for evaluation"))
}

/// The same with the adapter that there is.
fn open_drawn(graph: Option<&Path>) -> (Harness<'static, App>, RenderState) {
    let mut card = None;
    let mut setup = egui_kittest::wgpu::default_wgpu_setup();
    tenon_editor::viewport::write_directly(&mut setup);
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_max_steps(64).wgpu_setup(setup);
    let harness = builder.build_eframe(|cc| {
        card = cc.wgpu_render_state.clone();
        App::new(cc, graph).expect("a thread for evaluation")
    });
    (harness, card.expect("an adapter, if only Mesa's"))
}

fn settle(harness: &mut Harness<'static, App>) {
    harness.run_steps(2);
    while !harness.state().model.settled() {
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
    harness.run_steps(3);
}

/// Fills the canvas with so many nodes, all of them seen: points with all three inputs wired, the numbers that they are made of, and
/// every tenth a node of a type that nobody knows, so that there is much to complain of.
fn fill(harness: &mut Harness<'static, App>, count: usize) {
    let side = (count as f64).sqrt().ceil() as usize;
    let mut all = Vec::new();
    for i in 0..count {
        let mut node = match i {
            _ if i % 10 == 9 => Node::new("nobody.knows"),
            _ if i % 2 == 0 => Node::new("number").param("value", i as f64),
            _ => Node::new("point"),
        };
        if i % 2 == 1 {
            for (port, back) in [("x", 1), ("y", 3), ("z", 5)] {
                node = node.wire(port, format!("p{}.value", i.saturating_sub(back)));
            }
        }
        let at = Some([(i % side) as f64 * 260.0, (i / side) as f64 * 160.0]);
        all.push(Operation::AddNode { id: format!("p{i}"), node: Box::new(node) });
        all.push(Operation::Move { node: format!("p{i}"), to: at });
    }
    let state = harness.state_mut();
    state.model.apply(Operation::All(all)).expect("the nodes are new");
    state.canvas.show_all();
    settle(harness);
    assert!(harness.state().model.results.counts().0 >= count / 10);
}

fn main() {
    let cases: Vec<String> = std::env::args().skip(1).filter(|a| !a.starts_with('-')).collect();
    let all: [(&str, fn()); 4] =
        [("real", real::figures), ("logic", logic::figures), ("drawn", drawn::figures), ("panels", drawn::panels)];
    for (name, figures) in all {
        if cases.is_empty() || cases.iter().any(|c| c == name) {
            figures();
        }
    }
    // Whatever is left of it, the system clears away.
    let _ = std::fs::remove_dir_all(folder());
}
