//! Opening, saving, and what must not be lost.

use crate::common::{Window, folder, graph, root};
use eframe::egui::{Key, Modifiers};

#[test]
fn a_graph_is_saved_as_it_was_and_its_layout_beside_it() {
    let dir = folder("save");
    let original = root().join("graphs/quad-mesh/quad-mesh.tenon.json");
    let copy = dir.join("copy.tenon.json");
    std::fs::copy(&original, &copy).unwrap();
    std::fs::copy(root().join("graphs/quad-mesh/canopy.obj"), dir.join("canopy.obj")).unwrap();
    let mut w = Window::open(Some(&copy));
    assert_eq!(w.app().model.results.counts().0, 0, "{:?}", w.app().model.results.diagnostics);
    w.key(Modifiers::COMMAND, Key::S);
    assert_eq!(std::fs::read(&copy).unwrap(), std::fs::read(&original).unwrap());
    let layout = std::fs::read_to_string(dir.join("copy.layout.json")).unwrap();
    assert!(layout.contains("\"thicken\""), "{layout}");
    let places = |w: &Window| w.harness.state().model.document().layout_to_string();
    let before = places(&w);
    let again = Window::open(Some(&copy));
    assert_eq!(places(&again), before);
}

#[test]
fn a_file_that_is_no_graph_leaves_everything_as_it_was() {
    let mut w = Window::open(None);
    let bad = graph("bad", "{ \"format\": \"tenon\", ");
    w.app().open(&bad);
    w.steps(2);
    let message = w.app().model.message.clone().unwrap().message;
    assert!(message.contains("was not opened") && message.contains("line 1"), "{message}");
    assert_eq!(std::fs::read_to_string(&bad).unwrap(), "{ \"format\": \"tenon\", ");
    assert_eq!(w.app().model.path(), None, "what could not be read is never written over");
}
