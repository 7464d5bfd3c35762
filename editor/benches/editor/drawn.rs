//! What is drawn, by the adapter that there is: here mostly Mesa's, so that times are those of the processor. A frame is
//! also read back here, which a real window need not do.

use crate::logic::{self, target};
use crate::{fill, median, open_drawn, print, print_times, settle, shell};
use eframe::egui_wgpu::{RenderState, ScreenDescriptor};
use eframe::wgpu;
use egui_kittest::Harness;
use serde_json::json;
use std::time::{Duration, Instant};
use tenon_editor::app::App;
use tenon_engine::Operation;

fn picture(harness: &mut Harness<'static, App>) -> Vec<u8> {
    harness.render().expect("an adapter, if only Mesa's").into_raw()
}

/// One frame, drawn and read back.
fn frame(harness: &mut Harness<'static, App>) -> Duration {
    let start = Instant::now();
    harness.step();
    picture(harness);
    start.elapsed()
}

fn set(harness: &mut Harness<'static, App>, node: &str, port: &str, value: serde_json::Value) {
    let set = Operation::SetParam { node: node.into(), port: port.into(), value: Some(value) };
    harness.state_mut().model.apply(set).expect("the input takes it");
}

fn frames(count: usize) {
    let (mut harness, _) = open_drawn(None);
    fill(&mut harness, count);
    let times = (0..20).map(|_| frame(&mut harness)).collect();
    print("frame, drawn and read back", count, median(times), "ms", None);
    // With the viewport beside the canvas, but nothing drawn: what the processor has to do for a card.
    let times = (0..30).map(|_| logic::frame(&mut harness));
    print_times("frame with the viewport, not drawn", count, times.collect(), Some(target(count)));
}

/// How many frames pass from the one that takes new panels to the first picture that shows them.
fn frames_until_seen() {
    let (mut harness, _) = open_drawn(Some(&shell()));
    settle(&mut harness);
    let mut most = 0;
    for i in 1..8 {
        let points = json!([[0, 0, 0], [900, 0, 1500 + 40 * i], [3600, 0, 1500], [4500, 0, 0]]);
        set(&mut harness, "arc", "points", points);
        let panels = |h: &Harness<'static, App>| h.state().model.results.drawings["thicken.panels"].digest;
        let old = panels(&harness);
        // The point itself is seen to move at once.
        harness.step();
        let mut before = picture(&mut harness);
        while panels(&harness) == old {
            before = picture(&mut harness);
            std::thread::sleep(Duration::from_millis(1));
            harness.step();
        }
        let mut frames = 1;
        while picture(&mut harness) == before && frames < 100 {
            harness.step();
            frames += 1;
        }
        most = most.max(frames);
        settle(&mut harness);
    }
    print("frames until new panels are seen", 256, f64::from(most), "frames", Some(2.0));
}

/// Brings what a frame needs to the adapter, as the window does before it draws, and waits until it is there. The drawing itself
/// is left out.
fn bring(harness: &mut Harness<'static, App>, card: &RenderState) -> Duration {
    let shapes = harness.output().shapes.clone();
    let primitives = harness.ctx.tessellate(shapes, 1.0);
    let screen = ScreenDescriptor { size_in_pixels: [1440, 900], pixels_per_point: 1.0 };
    let mut encoder = card.device.create_command_encoder(&wgpu::CommandEncoderDescriptor::default());
    let start = Instant::now();
    card.renderer.write().update_buffers(&card.device, &card.queue, &mut encoder, &primitives, &screen);
    card.queue.submit([]);
    let waited = card.device.poll(wgpu::PollType::wait_indefinitely());
    waited.expect("the adapter is there");
    start.elapsed()
}

/// What a hundred thousand panels cost on their way to the adapter, once: they stay there.
pub fn panels() {
    let (mut harness, card) = open_drawn(Some(&shell()));
    let model = &mut harness.state_mut().model;
    model.selection = model.document().nodes().keys().cloned().collect();
    for keep in ["arc", "fold_1", "fold_2", "fold_3", "folds", "surface", "thicken"] {
        model.selection.remove(keep);
    }
    model.delete_selection();
    settle(&mut harness);
    bring(&mut harness, &card);
    set(&mut harness, "arc", "iterations", json!(9));
    set(&mut harness, "folds", "iterations", json!(8));
    let there = |h: &Harness<'static, App>| h.state().model.results.drawings["thicken.panels"].parts.len();
    while there(&harness) < 100_000 {
        std::thread::sleep(Duration::from_millis(5));
        harness.step();
    }
    let panels = there(&harness);
    let tree = harness.state().model.results.values["thicken.panels"].clone();
    let times = (0..5).map(|_| {
        let start = Instant::now();
        let drawing = tenon_editor::scene::draw(&tree).expect("panels are seen");
        let time = start.elapsed();
        assert_eq!(drawing.parts.len(), panels);
        time
    });
    print("panels made into triangles and edges", panels, median(times.collect()), "ms", None);
    let first = bring(&mut harness, &card).as_secs_f64() * 1e3;
    harness.step();
    let again = bring(&mut harness, &card).as_secs_f64() * 1e3;
    print("panels brought to the adapter", panels, first, "ms", Some(100.0));
    print("the same panels in the next frame", panels, again, "ms", None);
}

pub fn figures() {
    frames(200);
    frames(2000);
    frames_until_seen();
}
