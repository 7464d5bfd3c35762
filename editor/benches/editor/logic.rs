//! What the window's own code costs, without drawing: all of a frame's code and the triangles that it comes to.

use crate::{fill, open, print, print_times, settle, shell};
use eframe::egui::Context;
use egui_kittest::Harness;
use serde_json::json;
use std::time::{Duration, Instant};
use tenon_editor::app::App;
use tenon_editor::model::Model;
use tenon_editor::panels::Tab;
use tenon_engine::{Node, Operation};

/// One frame: all of the window's code, and the triangles that it comes to.
pub fn frame(harness: &mut Harness<'static, App>) -> Duration {
    let start = Instant::now();
    harness.step();
    let ctx: Context = harness.ctx.clone();
    let shapes = harness.output().shapes.clone();
    let triangles = ctx.tessellate(shapes, 1.0);
    let time = start.elapsed();
    drop(triangles);
    time
}

/// The target of a frame of so many nodes, ms.
pub fn target(count: usize) -> f64 {
    if count <= 200 { 6.0 } else { 16.0 }
}

fn frames(count: usize) {
    let mut harness = open(None);
    fill(&mut harness, count);
    let times = (0..60).map(|_| frame(&mut harness)).collect();
    print_times("frame, logic", count, times, Some(target(count)));
    // The same with the panels below the canvas.
    for (tab, case) in [(Tab::Problems, "frame with problems"), (Tab::Profile, "frame with the profile")] {
        harness.state_mut().lower.tab = Some(tab);
        harness.run_steps(3);
        let times = (0..30).map(|_| frame(&mut harness)).collect();
        print_times(case, count, times, Some(target(count)));
    }
    harness.state_mut().lower.tab = None;
    harness.run_steps(3);
    let times = (0..30).map(|i| {
        let value = Some(f64::from(i).into());
        let set = Operation::SetParam { node: "p0".into(), port: "value".into(), value };
        harness.state_mut().model.apply(set).expect("a number takes a number");
        frame(&mut harness)
    });
    print_times("frame while sliding, logic", count, times.collect(), Some(target(count)));
}

/// From a moved control point to panels that can be drawn: without any window, since frames wait for no evaluation.
fn drag() {
    let mut model = Model::new(|| {}).expect("a thread for evaluation");
    model.open(&shell()).expect("the graph is there");
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
    print_times("drag of a control point, logic", 256, times, Some(60.0));
}

/// A million rows, as a table.
fn rows() {
    let mut harness = open(None);
    let series = Node::new("series").param("count", 1_000_000);
    let add = Operation::AddNode { id: "s".into(), node: Box::new(series) };
    harness.state_mut().model.apply(add).expect("it is the first node");
    harness.state_mut().model.selection = ["s".to_owned()].into();
    harness.state_mut().lower.tab = Some(Tab::Data);
    settle(&mut harness);
    let times = (0..30).map(|_| frame(&mut harness)).collect();
    print_times("frame with a table of data", 1_000_000, times, Some(16.0));
}

/// Memory of this process, MB.
pub fn resident(process: &str) -> Option<f64> {
    let status = std::fs::read_to_string(format!("/proc/{process}/status")).ok()?;
    let line = status.lines().find(|l| l.starts_with("VmRSS:"))?;
    line.split_whitespace().nth(1)?.parse::<f64>().ok().map(|kb| kb / 1024.0)
}

pub fn figures() {
    let start = Instant::now();
    let mut harness = open(Some(&shell()));
    frame(&mut harness);
    print("start to first frame, logic", 256, start.elapsed().as_secs_f64() * 1e3, "ms", Some(1000.0));
    settle(&mut harness);
    if let Some(mb) = resident("self") {
        print("memory, logic", 256, mb, "MB", Some(300.0));
    }
    drop(harness);
    frames(200);
    frames(2000);
    rows();
    drag();
}
