//! What the window's own code costs, without drawing: all of a frame's code and the triangles that it comes to.

use crate::{fill, median, open, print, settle, shell};
use eframe::egui::Context;
use egui_kittest::Harness;
use serde_json::json;
use std::time::{Duration, Instant};
use tenon_editor::app::App;
use tenon_editor::model::Model;
use tenon_engine::Operation;

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
    print("frame, logic", count, median(times), "ms", Some(target(count)));
    let times = (0..30).map(|i| {
        let value = Some(f64::from(i).into());
        let set = Operation::SetParam { node: "p0".into(), port: "value".into(), value };
        harness.state_mut().model.apply(set).expect("a number takes a number");
        frame(&mut harness)
    });
    print("frame while sliding, logic", count, median(times.collect()), "ms", Some(target(count)));
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
    print("drag of a control point, logic", 256, median(times), "ms", Some(60.0));
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
    drag();
}
