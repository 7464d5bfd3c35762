//! The built-in fasteners go through the contract that plugins have: nothing is lost on the way.

use crate::common::*;
use serde_json::json;
use tenon_geometry::board::Up;
use tenon_geometry::joint::{
    Direction, EdgeSelection, Fastener, FastenerRule, FeatureSet, Head, Pin, PinKind, lay_fasteners,
};
use tenon_geometry::panel::PanelSet;
use tenon_nodes::value::V;

#[test]
fn the_built_in_fastener_gives_what_the_geometry_lays_to_the_bit() {
    let heads = [
        ("lower address", Head::LowerAddress),
        ("higher address", Head::HigherAddress),
        ("alternate", Head::Alternate),
    ];
    let edges =
        [("all", EdgeSelection::All), ("inner", EdgeSelection::Inner), ("along rows", EdgeSelection::AlongRows)];
    let toe = FastenerRule::toe_screws(Up::Back);
    let pin = Pin {
        kind: PinKind::Dowel,
        hole: 3.0,
        depth: [4.0; 2],
        direction: Direction::Given([0.0, 1.0, 0.5].into()),
        diameter: 3.0,
        length: 8.0,
    };
    let pin = FastenerRule { fastener: Fastener::Pin(pin), ..toe };
    let (screw, dowel) = (
        json!({}),
        json!({ "kind": "dowel", "direction": "given", "vector": [0, 1, 0.5], "depth": 4, "diameter": 3, "length": 8 }),
    );
    let mut laid = 0;
    for ((head, h), (selected, e)) in heads.iter().flat_map(|h| edges.iter().map(move |e| (h, e))) {
        for (rule, params) in [(toe, &screw), (pin, &dowel)] {
            let mut graph = shell();
            let mut params = params.clone();
            (params["head"], params["edges"]) = (json!(head), json!(selected));
            graph["nodes"]["screws"] =
                json!({ "type": "detail", "v": 1, "params": params, "inputs": { "panels": wire("thicken.panels") } });
            let (session, report) = run(&graph, &["screws.features", "screws.count"]);
            let panels = session.value("thicken.panels").unwrap().first::<V<PanelSet>>().unwrap().clone();
            let (wanted, issues) = lay_fasteners(&panels, &FastenerRule { head: *h, edges: *e, ..rule }).unwrap();
            let features = session.value("screws.features").unwrap().first::<V<FeatureSet>>().unwrap().clone();
            assert_eq!(format!("{:?}", *features), format!("{wanted:?}"), "{head}, {selected}");
            let count: u64 = wanted.hardware.iter().map(|h| h.count).sum();
            assert_eq!(session.value("screws.count").unwrap().first::<i64>(), Some(&(count as i64)));
            // Each issue is told, in order, in the geometry's words, with the panel that it is about.
            let told: Vec<_> = report.diagnostics.iter().filter(|d| d.node.as_deref() == Some("screws")).collect();
            assert_eq!(told.len(), issues.len());
            for (d, issue) in told.iter().zip(&issues) {
                assert!(d.message.starts_with(&issue.to_string()), "{}", d.message);
                assert_eq!(d.item, Some(issue.place().0 as usize));
            }
            laid += wanted.features.len();
        }
    }
    assert!(laid > 500, "{laid}");
}

#[test]
fn a_rule_that_no_edge_can_follow_fails_in_the_words_of_the_geometry() {
    let mut graph = shell();
    graph["nodes"]["screws"]["params"] = json!({ "spacing": 0 });
    let (_, report) = run(&graph, &["screws.features"]);
    assert!(told(&report, "bad-parameter").message.starts_with("spacing is 0"), "{:?}", report.diagnostics);
}
