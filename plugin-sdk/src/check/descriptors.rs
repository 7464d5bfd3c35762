//! Checks of what a plugin says of itself.

use super::Check;
use crate::abi::plugin::TENON_ITEM;
use crate::abi::value::*;
use crate::load::{Plugin, PluginNode, PortInfo};
use serde_json::Value;
use std::time::{Duration, Instant};

/// A library that takes longer than this to look at slows down the start of every program.
const SCAN: Duration = Duration::from_secs(1);

/// What is wrong with ports, by node and port.
fn ports(plugin: &Plugin, wrong: impl Fn(&PortInfo) -> Option<String>) -> Vec<String> {
    let all = plugin.nodes.iter().flat_map(|n| n.inputs.iter().chain(&n.outputs).map(move |p| (n, p)));
    all.filter_map(|(n, p)| Some(format!("{}.{}: {}", n.id, p.name, wrong(p)?))).collect()
}

fn nodes(plugin: &Plugin, wrong: impl Fn(&PluginNode) -> Option<String>) -> Vec<String> {
    plugin.nodes.iter().filter_map(|n| Some(format!("{}: {}", n.id, wrong(n)?))).collect()
}

fn default(p: &PortInfo) -> Option<Value> {
    serde_json::from_str(&p.default_json).ok()
}

fn is_sentence(text: &str) -> bool {
    text.trim().len() >= 5 && text.trim_end().ends_with(['.', '!', '?'])
}

/// Whether a default is of its port's type; what only the host can judge passes.
fn fits(p: &PortInfo, value: &Value) -> bool {
    let one = |v: &Value| match p.kind {
        TENON_BOOLEAN => v.is_boolean(),
        TENON_INTEGER => v.as_f64().is_some_and(|x| x.fract() == 0.0) || v.is_string(),
        TENON_NUMBER => v.is_number() || v.is_string() || v.is_object(),
        TENON_TEXT => v.is_string(),
        _ => !v.is_null(),
    };
    match value {
        Value::Array(items) if p.access != TENON_ITEM => items.iter().all(one),
        one_value => one(one_value),
    }
}

fn same(a: &Plugin, b: &Plugin) -> bool {
    let text = |p: &Plugin| format!("{:?}", (&p.id, &p.version, &p.vendor, &p.doc, &p.nodes));
    text(a) == text(b)
}

pub(super) fn checks() -> Vec<Check> {
    vec![
        Check {
            name: "scans-quickly",
            about: "Looking at the library takes less than a second: programs do it whenever they start.",
            run: |p| {
                let scan = |_| {
                    let start = Instant::now();
                    drop(Plugin::load(&p.path));
                    start.elapsed()
                };
                let took = (0..3).map(scan).min().unwrap_or_default();
                if took < SCAN { Vec::new() } else { vec![format!("it took {} ms", took.as_millis())] }
            },
        },
        Check {
            name: "says-the-same-again",
            about: "Asked again, also from another thread, the library describes itself in the same words.",
            run: |p| {
                let here = Plugin::load(&p.path);
                let there = std::thread::scope(|s| s.spawn(|| Plugin::load(&p.path)).join());
                match (here, there) {
                    (Ok(a), Ok(Ok(b))) if same(p, &a) && same(p, &b) => Vec::new(),
                    _ => vec!["the second or third answer is another".into()],
                }
            },
        },
        Check {
            name: "version",
            about: "The plugin's version is of the form 1.2.3, so that graphs can ask for a range of versions.",
            run: |p| {
                let core = p.version.split(['-', '+']).next().unwrap_or_default();
                let numbers: Vec<&str> = core.split('.').collect();
                let good =
                    numbers.len() == 3 && numbers.iter().all(|n| n.parse::<u64>().is_ok_and(|v| v.to_string() == **n));
                if good { Vec::new() } else { vec![format!("it is \"{}\"", p.version)] }
            },
        },
        Check {
            name: "vendor-and-doc",
            about: "The plugin says who made it and what it is for, so that people know whom to ask.",
            run: |p| {
                let missing = [("vendor", p.vendor.trim().is_empty()), ("doc", !is_sentence(&p.doc))];
                missing
                    .into_iter()
                    .filter(|(_, m)| *m)
                    .map(|(what, _)| format!("its {what} is missing or no sentence"))
                    .collect()
            },
        },
        Check {
            name: "node-docs",
            about: "Every node type says in a sentence what it does.",
            run: |p| nodes(p, |n| (!is_sentence(&n.doc)).then(|| format!("its doc is \"{}\"", n.doc))),
        },
        Check {
            name: "node-names",
            about: "Every node type has a name for people, not longer than a node is wide, without space around it.",
            run: |p| {
                nodes(p, |n| {
                    let good = n.name.trim() == n.name && (1..=40).contains(&n.name.chars().count());
                    (!good).then(|| format!("its name is \"{}\"", n.name))
                })
            },
        },
        Check {
            name: "node-categories",
            about: "Every node type says where a palette shows it.",
            run: |p| nodes(p, |n| n.category.trim().is_empty().then(|| "it has no category".into())),
        },
        Check {
            name: "node-keywords",
            about: "Every node type can be found by other words than its name.",
            run: |p| nodes(p, |n| n.keywords.is_empty().then(|| "it has no keywords".into())),
        },
        Check {
            name: "port-docs",
            about: "Every port says in a sentence what it means.",
            run: |p| ports(p, |x| (!is_sentence(&x.doc)).then(|| format!("its doc is \"{}\"", x.doc))),
        },
        Check {
            name: "port-names",
            about: "No two inputs and no two outputs of a node type share a name, and fasteners leave the host's names alone.",
            run: |p| {
                nodes(p, |n| {
                    let host: &[&str] = match n.fastener {
                        true => &["panels", "edges", "head", "machine", "out_of_reach", "up"],
                        false => &[],
                    };
                    [&n.inputs, &n.outputs].into_iter().find_map(|list| {
                        let names = list.iter().map(|p| p.name.as_str());
                        let twice = names
                            .clone()
                            .enumerate()
                            .find(|(i, a)| host.contains(a) || names.clone().take(*i).any(|b| b == *a));
                        twice.map(|(_, name)| format!("\"{name}\" is there twice, or is the host's"))
                    })
                })
            },
        },
        Check {
            name: "ranges",
            about: "Ranges are finite, so that an editor can show a slider.",
            run: |p| {
                ports(p, |x| {
                    let (min, max) = x.range?;
                    (!(min.is_finite() && max.is_finite())).then(|| format!("its range is {min} to {max}"))
                })
            },
        },
        Check {
            name: "units",
            about: "Units are signs that the host knows, and stand at numbers only.",
            run: |p| {
                let known = ["", "mm", "deg", "mm2", "mm3", "mm/min", "rev/min", "pieces"];
                ports(p, |x| {
                    let number = matches!(x.kind, TENON_NUMBER | TENON_INTEGER) || x.unit.is_empty();
                    (!(known.contains(&x.unit.as_str()) && number)).then(|| format!("its unit is \"{}\"", x.unit))
                })
            },
        },
        Check {
            name: "choices",
            about: "Choices are texts of text ports, none empty and none twice.",
            run: |p| {
                ports(p, |x| {
                    let twice = |(i, c): (usize, &String)| c.is_empty() || x.choices[..i].contains(c);
                    let wrong =
                        !x.choices.is_empty() && (x.kind != TENON_TEXT || x.choices.iter().enumerate().any(twice));
                    wrong.then(|| format!("its choices are {:?}", x.choices))
                })
            },
        },
        Check {
            name: "defaults-are-json",
            about: "Defaults are JSON of the port's own type.",
            run: |p| {
                ports(p, |x| {
                    let wrong = !x.default_json.is_empty() && !default(x).is_some_and(|v| fits(x, &v));
                    wrong.then(|| format!("its default is {}", x.default_json))
                })
            },
        },
        Check {
            name: "defaults-are-accepted",
            about: "Defaults lie in their port's range and among its choices.",
            run: |p| {
                ports(p, |x| {
                    let value = default(x)?;
                    let outside = value.as_f64().zip(x.range).is_some_and(|(v, (min, max))| !(min..=max).contains(&v));
                    let strange =
                        !x.choices.is_empty() && !value.as_str().is_some_and(|v| x.choices.iter().any(|c| c == v));
                    (outside || strange).then(|| format!("its default is {value}"))
                })
            },
        },
    ]
}
