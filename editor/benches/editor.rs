//! `cargo xtask bench editor`: what the window costs, without a screen. One JSON line per figure.

use eframe::egui::{Context, vec2};
use egui_kittest::Harness;
use serde_json::json;
use std::path::Path;
use std::time::{Duration, Instant};
use tenon_editor::app::App;
use tenon_editor::model::Model;
use tenon_engine::Operation;

#[global_allocator]
static ALLOCATOR: mimalloc::MiMalloc = mimalloc::MiMalloc;

fn print(case: &str, size: usize, ours: f64, unit: &str, target: f64) {
    let round = |x: f64| (x * 1e3).round() / 1e3;
    let line =
        json!({ "suite": "editor", "case": case, "size": size, "ours": round(ours), "unit": unit, "target": target });
    println!("{line}");
}

fn median(mut times: Vec<Duration>) -> f64 {
    times.sort();
    times.get(times.len() / 2).map_or(f64::NAN, |t| t.as_secs_f64() * 1e3)
}

fn open(graph: Option<&Path>) -> Harness<'static, App> {
    let builder = Harness::builder().with_size(vec2(1440.0, 900.0)).with_max_steps(64);
    builder.build_eframe(|cc| App::new(cc, graph).expect("a thread for evaluation"))
}

fn settle(harness: &mut Harness<'static, App>) {
    harness.run_steps(2);
    while !harness.state().model.settled() {
        std::thread::sleep(Duration::from_millis(2));
        harness.step();
    }
    harness.run_steps(3);
}

/// One frame: all of the window's code, and the triangles that it comes to.
fn frame(harness: &mut Harness<'static, App>) -> Duration {
    let start = Instant::now();
    harness.step();
    let ctx: Context = harness.ctx.clone();
    let shapes = harness.output().shapes.clone();
    let triangles = ctx.tessellate(shapes, 1.0);
    let time = start.elapsed();
    drop(triangles);
    time
}

/// Frames of a canvas of so many nodes, all of them seen, while one is dragged: so nothing can be left out.
fn frames(count: usize) {
    let mut harness = open(None);
    let model = &mut harness.state_mut().model;
    let mut all = Vec::new();
    let side = (count as f64).sqrt().ceil() as usize;
    for i in 0..count {
        let at = Some([(i % side) as f64 * 260.0, (i / side) as f64 * 160.0]);
        let mut node = tenon_engine::Node::new("point").param("x", i as f64);
        if i > 0 {
            node = node.wire("y", format!("p{}.value", i - 1));
        }
        if i % 2 == 0 {
            node = tenon_engine::Node::new("number").param("value", i as f64);
        }
        all.push(Operation::AddNode { id: format!("p{i}"), node: Box::new(node) });
        all.push(Operation::Move { node: format!("p{i}"), to: at });
    }
    model.apply(Operation::All(all)).expect("the nodes are new");
    harness.state_mut().canvas.show_all();
    settle(&mut harness);
    let times = (0..60).map(|_| frame(&mut harness)).collect();
    let target = if count <= 200 { 6.0 } else { 16.0 };
    print("frame", count, median(times), "ms", target);
    let times = (0..30).map(|i| {
        let value = Some(f64::from(i).into());
        let set = Operation::SetParam { node: "p0".into(), port: "value".into(), value };
        harness.state_mut().model.apply(set).expect("a number takes a number");
        frame(&mut harness)
    });
    print("frame while sliding", count, median(times.collect()), "ms", target);
}

/// From a moved control point to panels that can be drawn.
fn drag(graph: &Path) {
    let mut model = Model::new(|| {}).expect("a thread for evaluation");
    model.open(graph).expect("the graph is there");
    let wait = |model: &mut Model, done: &dyn Fn(&Model) -> bool| {
        while !done(model) {
            std::thread::sleep(Duration::from_micros(200));
            model.poll();
        }
    };
    wait(&mut model, &|m| m.settled());
    let mut times = Vec::new();
    for i in 0..30 {
        let before = model.results.drawings["thicken.panels"].digest;
        let points = json!([[0, 0, 0], [900, 0, 1500 + i], [3600, 0, 1500], [4500, 0, 0]]);
        let start = Instant::now();
        let set = Operation::SetParam { node: "arc".into(), port: "points".into(), value: Some(points) };
        model.apply(set).expect("a curve takes points");
        if i > 0 {
            wait(&mut model, &|m| m.results.drawings["thicken.panels"].digest != before);
            times.push(start.elapsed());
        }
    }
    print("drag of a control point", 256, median(times), "ms", 60.0);
}

fn resident() -> Option<f64> {
    let status = std::fs::read_to_string("/proc/self/status").ok()?;
    let line = status.lines().find(|l| l.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}

fn main() {
    let graph = Path::new(env!("CARGO_MANIFEST_DIR")).join("../graphs/shell-256");
    let start = Instant::now();
    let mut harness = open(Some(&graph));
    frame(&mut harness);
    print("start to first frame, without a screen", 256, start.elapsed().as_secs_f64() * 1e3, "ms", 1000.0);
    settle(&mut harness);
    if let Some(mb) = resident() {
        print("memory, without a screen", 256, mb, "MB", 300.0);
    }
    drop(harness);
    frames(200);
    frames(2000);
    drag(&graph);
}
