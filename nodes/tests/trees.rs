//! Lists and trees as users of Grasshopper know them, numbers and texts.

use crate::common::{run, run_on, shell, told, wire};
use serde_json::{Value, json};
use std::collections::HashMap;
use tenon_engine::Report;

/// Runs one node of that type, fed by wires from `series` (0, 1, … `n` − 1) at `port`.
fn fed(node: &str, port: &str, n: usize, params: &Value) -> Value {
    json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": {
        "source": { "type": "series", "v": 1, "params": { "count": n } },
        "x": { "type": node, "v": 1, "params": params, "inputs": { port: wire("source.numbers") } },
    } })
}

fn of(graph: &Value, target: &str) -> (Value, Report) {
    let (session, report) = run(graph, &[target]);
    (session.value(target).map_or(Value::Null, |t| t.to_json()["branches"].clone()), report)
}

/// The branches of a target; nothing may have gone wrong.
#[track_caller]
fn branches(graph: &Value, target: &str) -> Value {
    let (value, report) = of(graph, target);
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    value
}

fn nodes(nodes: &Value) -> Value {
    json!({ "format": "tenon", "version": 1, "units": "mm", "nodes": nodes })
}

#[test]
fn list_item_takes_places_and_wraps_when_told() {
    let graph = |params| fed("list_item", "list", 4, &params);
    assert_eq!(branches(&graph(json!({})), "x.items"), json!({"{0}": [0.0]}));
    assert_eq!(branches(&graph(json!({"index": [3, 1, 1]})), "x.items"), json!({"{0}": [3.0, 1.0, 1.0]}));
    assert_eq!(branches(&graph(json!({"index": [-1, 4], "wrap": true})), "x.items"), json!({"{0}": [3.0, 0.0]}));
    let (value, report) = of(&graph(json!({"index": [2, 4, 0]})), "x.items");
    assert_eq!(value, json!({"{0}": [2.0, null, 0.0]}));
    assert_eq!(told(&report, "no-such-item").item, Some(1));
}

#[test]
fn sublist_holds_both_ends() {
    let graph = |params| fed("sublist", "list", 5, &params);
    assert_eq!(branches(&graph(json!({"from": 1, "to": 3})), "x.items"), json!({"{0}": [1.0, 2.0, 3.0]}));
    assert_eq!(branches(&graph(json!({"from": 3, "to": 1})), "x.items"), json!({"{0}": [3.0, 2.0, 1.0]}));
    assert_eq!(
        branches(&graph(json!({"from": -2, "to": 1_000_000_000_000i64})), "x.index"),
        json!({"{0}": [0, 1, 2, 3, 4]})
    );
    assert_eq!(
        branches(&graph(json!({"from": -1, "to": 1, "wrap": true})), "x.items"),
        json!({"{0}": [4.0, 0.0, 1.0]})
    );
    let (_, report) = of(&graph(json!({"from": i64::MIN, "to": i64::MAX, "wrap": true})), "x.items");
    told(&report, "too-many-items");
}

#[test]
fn shift_goes_round_or_drops() {
    for (by, wrap, expected) in [
        (1, true, json!([1.0, 2.0, 3.0, 0.0])),
        (-1, true, json!([3.0, 0.0, 1.0, 2.0])),
        (6, true, json!([2.0, 3.0, 0.0, 1.0])),
        (1, false, json!([1.0, 2.0, 3.0])),
        (-3, false, json!([0.0])),
        (9, false, json!([])),
        (i64::MIN, false, json!([])),
    ] {
        let graph = fed("shift", "list", 4, &json!({ "by": by, "wrap": wrap }));
        assert_eq!(branches(&graph, "x.items"), json!({ "{0}": expected }), "{by} {wrap}");
    }
    assert_eq!(branches(&fed("shift", "list", 0, &json!({})), "x.items"), json!({"{0}": []}));
}

#[test]
fn dispatch_repeats_its_pattern() {
    let both = |params: Value| {
        let graph = fed("dispatch", "list", 5, &params);
        (branches(&graph, "x.a")["{0}"].clone(), branches(&graph, "x.b")["{0}"].clone())
    };
    assert_eq!(both(json!({})), (json!([0.0, 2.0, 4.0]), json!([1.0, 3.0])));
    assert_eq!(both(json!({"pattern": [true, true, false]})), (json!([0.0, 1.0, 3.0, 4.0]), json!([2.0])));
    assert_eq!(both(json!({"pattern": [false]})), (json!([]), json!([0.0, 1.0, 2.0, 3.0, 4.0])));
    told(&of(&fed("dispatch", "list", 5, &json!({"pattern": []})), "x.a").1, "empty-list");
}

#[test]
fn partition_leaves_the_remainder_and_repeats_sizes() {
    let graph = |sizes| fed("partition", "tree", 7, &json!({ "sizes": sizes }));
    assert_eq!(
        branches(&graph(json!([3])), "x.tree"),
        json!({"{0;0}": [0.0, 1.0, 2.0], "{0;1}": [3.0, 4.0, 5.0], "{0;2}": [6.0]})
    );
    assert_eq!(
        branches(&graph(json!([1, 2])), "x.tree"),
        json!({"{0;0}": [0.0], "{0;1}": [1.0, 2.0], "{0;2}": [3.0], "{0;3}": [4.0, 5.0], "{0;4}": [6.0]})
    );
    told(&of(&graph(json!([2, 0])), "x.tree").1, "out-of-range");
    told(&of(&graph(json!([])), "x.tree").1, "no-size");
}

#[test]
fn every_branch_is_cut_shifted_and_picked_on_its_own() {
    let graph = nodes(&json!({
        "source": { "type": "series", "v": 1, "params": { "count": 6 } },
        "rows": { "type": "partition", "v": 1, "params": { "sizes": [3] }, "inputs": { "tree": wire("source.numbers") } },
        "again": { "type": "partition", "v": 1, "params": { "sizes": [2] }, "inputs": { "tree": wire("rows.tree") } },
        "shift": { "type": "shift", "v": 1, "inputs": { "list": wire("rows.tree") } },
        "item": { "type": "list_item", "v": 1, "params": { "index": [2] }, "inputs": { "list": wire("rows.tree") } },
        "flat": { "type": "flatten", "v": 1, "inputs": { "tree": wire("rows.tree") } },
        "graft": { "type": "graft", "v": 1, "inputs": { "tree": wire("item.items") } },
        "simple": { "type": "simplify", "v": 1, "inputs": { "tree": wire("rows.tree") } },
        "back": { "type": "reverse", "v": 1, "inputs": { "tree": wire("rows.tree") } },
    }));
    for (target, expected) in [
        ("again.tree", json!({"{0;0;0}": [0.0, 1.0], "{0;0;1}": [2.0], "{0;1;0}": [3.0, 4.0], "{0;1;1}": [5.0]})),
        ("shift.items", json!({"{0;0}": [1.0, 2.0, 0.0], "{0;1}": [4.0, 5.0, 3.0]})),
        ("item.items", json!({"{0;0}": [2.0], "{0;1}": [5.0]})),
        ("flat.tree", json!({"{0}": [0.0, 1.0, 2.0, 3.0, 4.0, 5.0]})),
        ("graft.tree", json!({"{0;0;0}": [2.0], "{0;1;0}": [5.0]})),
        ("simple.tree", json!({"{0}": [0.0, 1.0, 2.0], "{1}": [3.0, 4.0, 5.0]})),
        ("back.tree", json!({"{0;0}": [2.0, 1.0, 0.0], "{0;1}": [5.0, 4.0, 3.0]})),
    ] {
        assert_eq!(branches(&graph, target), expected, "{target}");
    }
}

#[test]
fn merge_joins_equal_paths_and_entwine_keeps_inputs_apart() {
    let graph = |flatten: bool| {
        nodes(&json!({
            "p": { "type": "series", "v": 1, "params": { "count": 2 } },
            "q": { "type": "series", "v": 1, "params": { "start": 10, "count": 2 } },
            "t": { "type": "text", "v": 1, "params": { "value": "oak" } },
            "grafted": { "type": "graft", "v": 1, "inputs": { "tree": wire("q.numbers") } },
            "merge": { "type": "merge", "v": 1, "inputs": { "trees": { "from": ["p.numbers", "grafted.tree", "q.numbers"] } } },
            "mixed": { "type": "merge", "v": 1, "inputs": { "trees": { "from": ["p.numbers", "t.value"] } } },
            "entwine": { "type": "entwine", "v": 1, "params": { "flatten": flatten },
                "inputs": { "a": wire("p.numbers"), "c": wire("grafted.tree"), "d": wire("t.value") } },
        }))
    };
    assert_eq!(
        branches(&graph(true), "merge.tree"),
        json!({"{0}": [0.0, 1.0, 10.0, 11.0], "{0;0}": [10.0], "{0;1}": [11.0]})
    );
    assert_eq!(
        branches(&graph(true), "entwine.tree"),
        json!({"{0;0}": [0.0, 1.0], "{0;2}": [10.0, 11.0], "{0;3}": ["oak"]})
    );
    assert_eq!(
        branches(&graph(false), "entwine.tree"),
        json!({"{0;0;0}": [0.0, 1.0], "{0;2;0;0}": [10.0], "{0;2;0;1}": [11.0], "{0;3;0}": ["oak"]})
    );
    told(&of(&graph(true), "mixed.tree").1, "mixed-types");
    let twice = nodes(&json!({
        "p": { "type": "series", "v": 1, "params": { "count": 1 } },
        "t": { "type": "text", "v": 1, "params": { "value": "oak" } },
        "apart": { "type": "entwine", "v": 1, "inputs": { "a": wire("p.numbers"), "b": wire("t.value") } },
        "flat": { "type": "flatten", "v": 1, "inputs": { "tree": wire("apart.tree") } },
    }));
    assert!(told(&of(&twice, "flat.tree").1, "mixed-types").message.contains("number and text"));
}

#[test]
fn wires_match_longest_shortest_and_cross() {
    let graph = |rule: &str, templates: usize| {
        nodes(
            &json!({ "x": { "type": "format", "v": 1, "match": rule, "params": { "template": vec!["{a}{b}"; templates] },
            "inputs": { "a": wire("a.items"), "b": wire("b.items") } },
            "a": { "type": "list", "v": 1, "params": { "items": ["A", "B", "C"] } },
            "b": { "type": "list", "v": 1, "params": { "items": [1, 2] } } }),
        )
    };
    for (rule, templates, expected) in [
        ("longest", 1, json!(["A1", "B2", "C2"])),
        ("shortest", 3, json!(["A1", "B2"])),
        // Every port counts, that of the single template as well.
        ("shortest", 1, json!(["A1"])),
        ("cross", 1, json!(["A1", "A2", "B1", "B2", "C1", "C2"])),
    ] {
        assert_eq!(branches(&graph(rule, templates), "x.text"), json!({ "{0}": expected }), "{rule} {templates}");
    }
}

#[test]
fn cross_reference_pairs_like_cross_matching() {
    let pairs = |rule: &str| {
        let graph = nodes(&json!({
            "x": { "type": "cross_reference", "v": 1, "params": { "a": ["A", "B", "C"], "b": [0, 1], "pairs": rule } },
            "t": { "type": "format", "v": 1, "params": { "template": "{a}{b}" }, "inputs": { "a": wire("x.a"), "b": wire("x.b") } },
        }));
        branches(&graph, "t.text")["{0}"].clone()
    };
    assert_eq!(pairs("all"), json!(["A0", "A1", "B0", "B1", "C0", "C1"]));
    assert_eq!(pairs("same"), json!(["A0", "B1"]));
    assert_eq!(pairs("other"), json!(["A1", "B0", "C0", "C1"]));
    assert_eq!(pairs("lower"), json!(["A0", "B0", "B1", "C0", "C1"]));
    assert_eq!(pairs("below"), json!(["B0", "C0", "C1"]));
    assert_eq!(pairs("upper"), json!(["A0", "A1", "B1"]));
    assert_eq!(pairs("above"), json!(["A1"]));
}

#[test]
fn sort_is_stable_and_takes_values_along() {
    let graph = |descending: bool| {
        nodes(&json!({ "x": { "type": "sort", "v": 1, "params": {
            "keys": [2.5, 1.0, 2.5, null, -3.0], "values": ["a", "b", "c", "d", "e"], "descending": descending } } }))
    };
    assert_eq!(branches(&graph(false), "x.keys"), json!({"{0}": [-3.0, 1.0, 2.5, 2.5, null]}));
    assert_eq!(branches(&graph(false), "x.values"), json!({"{0}": ["e", "b", "a", "c", "d"]}));
    assert_eq!(branches(&graph(true), "x.values"), json!({"{0}": ["a", "c", "b", "e", "d"]}));
    assert_eq!(branches(&graph(true), "x.index"), json!({"{0}": [0, 2, 1, 4, 3]}));
    let alone = nodes(&json!({ "x": { "type": "sort", "v": 1, "params": { "keys": ["b", "a"] } } }));
    assert_eq!(branches(&alone, "x.keys"), json!({"{0}": ["a", "b"]}));
    let short = nodes(&json!({ "x": { "type": "sort", "v": 1, "params": { "keys": [1, 2], "values": [1] } } }));
    told(&of(&short, "x.values").1, "lengths-differ");
}

#[test]
fn remap_meets_both_ends_and_converts_integers() {
    let graph = nodes(&json!({
        "n": { "type": "integer", "v": 1, "params": { "value": [0, 3, 10, 12] } },
        "x": { "type": "remap", "v": 1, "params": { "from_end": 10, "to_start": 0.3, "to_end": 0.1 }, "inputs": { "value": wire("n.value") } },
    }));
    let mapped = branches(&graph, "x.mapped")["{0}"].clone();
    assert_eq!((&mapped[0], &mapped[2]), (&json!(0.3), &json!(0.1)));
    assert!((mapped[1].as_f64().unwrap() - 0.24).abs() < 1e-12 && (mapped[3].as_f64().unwrap() - 0.06).abs() < 1e-12);
    assert_eq!(branches(&graph, "x.clipped")["{0}"][3], json!(0.1));
    let empty = nodes(&json!({ "x": { "type": "remap", "v": 1, "params": { "value": 1, "from_end": 0 } } }));
    told(&of(&empty, "x.mapped").1, "empty-interval");
}

#[test]
fn points_and_vectors_are_taken_for_each_other() {
    let graph = nodes(&json!({
        "p": { "type": "point", "v": 1, "params": { "z": 2 } },
        "v": { "type": "vector", "v": 1, "params": { "z": 5 } },
        "plane": { "type": "plane", "v": 1, "inputs": { "origin": wire("v.vector"), "normal": wire("p.point") } },
    }));
    assert_eq!(
        branches(&graph, "plane.plane"),
        json!({"{0}": [{"origin": [0.0, 0.0, 5.0], "normal": [0.0, 0.0, 1.0]}]})
    );
}

#[test]
fn random_is_the_stated_generator() {
    let graph = |seed: i64, count: i64| {
        let params = json!({ "seed": seed, "count": count, "start": -10, "end": 10 });
        branches(&nodes(&json!({ "x": { "type": "random", "v": 1, "params": params } })), "x.numbers")["{0}"].clone()
    };
    // SplitMix64 from 1234567 begins with 6457827717110365317.
    let first = (6_457_827_717_110_365_317u64 >> 11) as f64 / 9_007_199_254_740_992.0;
    assert_eq!(graph(1_234_567, 1), json!([-10.0 + 20.0 * first]));
    let (short, long) = (graph(7, 5), graph(7, 400));
    let long = long.as_array().unwrap();
    assert_eq!(short.as_array().unwrap()[..], long[..5]);
    assert!(long.iter().all(|x| (-10.0..10.0).contains(&x.as_f64().unwrap())));
    assert_ne!(graph(8, 5), short);
}

#[test]
fn statistics_leave_out_what_failed_and_say_so() {
    let graph = nodes(&json!({ "x": { "type": "statistics", "v": 1, "params": { "numbers": [4, null, 1, 7] } } }));
    for (port, expected) in [
        ("count", json!(3)),
        ("missing", json!(1)),
        ("sum", json!(12.0)),
        ("mean", json!(4.0)),
        ("median", json!(4.0)),
        ("min", json!(1.0)),
        ("max", json!(7.0)),
    ] {
        assert_eq!(branches(&graph, &format!("x.{port}")), json!({ "{0}": [expected] }), "{port}");
    }
    told(
        &of(&nodes(&json!({ "x": { "type": "statistics", "v": 1, "params": { "numbers": [] } } })), "x.sum").1,
        "empty-list",
    );
}

#[test]
fn format_fills_item_by_item_and_names_bad_templates() {
    let graph = |template: &str| fed("format", "a", 3, &json!({ "template": template }));
    assert_eq!(branches(&graph("board {a:02}"), "x.text"), json!({"{0}": ["board 00", "board 01", "board 02"]}));
    assert!(told(&of(&graph("{b}"), "x.text").1, "bad-template").message.contains("{b}"));
}

#[test]
fn mesh_curve_and_panels_come_apart() {
    let mut graph = shell();
    for (name, port, source) in [
        ("explode_mesh", "mesh", "surface.mesh"),
        ("explode_curve", "curve", "arc.curve"),
        ("explode_panels", "panels", "thicken.panels"),
    ] {
        graph["nodes"][name] = json!({ "type": name, "v": 1, "inputs": { port: wire(source) } });
    }
    let targets = [
        "explode_mesh.points",
        "explode_mesh.corners",
        "explode_mesh.faces",
        "explode_curve.points",
        "explode_curve.weights",
        "explode_panels.corners",
        "explode_panels.addresses",
        "explode_panels.thickness",
        "surface.mesh",
    ];
    let (session, report) = run_on(&graph, &targets, 2, HashMap::new());
    assert!(!report.has_errors(), "{:#?}", report.diagnostics);
    let get = |target: &str| session.value(target).unwrap().to_json()["branches"].clone();
    let mesh = get("surface.mesh")["{0}"][0].clone();
    assert_eq!(get("explode_mesh.points")["{0}"], mesh["points"]);
    assert_eq!(get("explode_mesh.faces")["{15}"], mesh["faces"][15]);
    let place = mesh["faces"][6][2].as_u64().unwrap() as usize;
    assert_eq!(get("explode_mesh.corners")["{6}"][2], mesh["points"][place]);
    assert_eq!(get("explode_mesh.corners").as_object().unwrap().len(), 16);
    let arc = get("explode_curve.points");
    assert_eq!(arc["{0}"].as_array().unwrap().len(), 5);
    assert_eq!((&arc["{0}"][0], &arc["{0}"][4]), (&json!([0.0, 0.0, 0.0]), &json!([800.0, 0.0, 0.0])));
    assert_eq!(get("explode_panels.addresses")["{0}"].as_array().unwrap().len(), 16);
    assert_eq!(get("explode_panels.corners")["{3}"].as_array().unwrap().len(), 4);
    assert_eq!(get("explode_panels.thickness"), json!({"{0}": [10.0]}));
}

#[test]
fn a_slider_gives_what_lies_between_its_ends_in_millimetres() {
    let graph = |params| nodes(&json!({ "x": { "type": "slider", "v": 1, "params": params } }));
    assert_eq!(branches(&graph(json!({})), "x.value"), json!({"{0}": [5.0]}));
    assert_eq!(branches(&graph(json!({"value": 2, "unit": "cm"})), "x.value"), json!({"{0}": [20.0]}));
    let (value, report) = of(&graph(json!({"value": 12})), "x.value");
    assert!(value.is_null() || value == json!({"{0}": [null]}), "{value}");
    assert!(told(&report, "bad-parameter").hint.as_deref().is_some_and(|h| h.ends_with("10")));
    let whole = |params| nodes(&json!({ "x": { "type": "integer_slider", "v": 1, "params": params } }));
    assert_eq!(branches(&whole(json!({"value": 7})), "x.value"), json!({"{0}": [7]}));
    told(&of(&whole(json!({"value": -1})), "x.value").1, "bad-parameter");
    told(&of(&graph(json!({"unit": "apples"})), "x.value").1, "bad-parameter");
    told(&of(&graph(json!({"min": 6, "max": 4})), "x.value").1, "bad-parameter");
}

#[test]
fn a_value_list_gives_the_chosen_entry() {
    let graph = |params| nodes(&json!({ "x": { "type": "value_list", "v": 1, "params": params } }));
    let thick = |chosen| json!({"names": ["thin", "thick"], "values": [6.5, 18.0], "chosen": chosen});
    assert_eq!(branches(&graph(json!({})), "x.value"), json!({"{0}": [1]}));
    assert_eq!(branches(&graph(thick("thick")), "x.value"), json!({"{0}": [18.0]}));
    let texts = json!({"names": ["a", "b"], "values": ["oak", "beech"], "chosen": "b"});
    assert_eq!(branches(&graph(texts), "x.value"), json!({"{0}": ["beech"]}));
    assert!(
        told(&of(&graph(thick("fat")), "x.value").1, "no-such-entry")
            .hint
            .as_deref()
            .is_some_and(|h| h == "thin, thick")
    );
    told(&of(&graph(json!({"names": ["a"], "values": [1, 2]})), "x.value").1, "lengths-differ");
}

#[test]
fn a_text_panel_passes_on_what_it_shows() {
    let graph = fed("text_panel", "data", 3, &json!({}));
    assert_eq!(branches(&graph, "x.data"), json!({"{0}": [0.0, 1.0, 2.0]}));
}
