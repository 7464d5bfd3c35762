//! A small registry of nodes to test with, and shortcuts.

use serde_json::json;
use std::sync::Arc;
use tenon_engine::*;

pub fn registry() -> Arc<Registry> {
    let mut r = Registry::new();
    let number = |n: &'static str| Port::item::<f64>(n);
    let nodes = [
        NodeType::new("number", 1).input(number("value").default(0.0)).output(number("value")).run(|c| {
            let v = c.number("value")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("add", 1).input(number("a")).input(number("b").default(0)).output(number("sum")).run(|c| {
            let sum = c.number("a")? + c.number("b")?;
            c.set("sum", sum);
            Ok(())
        }),
        NodeType::new("floor", 1).input(number("a")).output(number("value")).run(|c| {
            let v = c.number("a")?.floor();
            c.set("value", v);
            Ok(())
        }),
        // Fails below zero: one bad item among good ones.
        NodeType::new("root", 1).input(number("a")).output(number("value")).run(|c| {
            let a = c.number("a")?;
            if a < 0.0 {
                return Err(Fail::new("negative", format!("{a} has no root")).port("a").hint("use 0 or more"));
            }
            c.set("value", a.sqrt());
            Ok(())
        }),
        NodeType::new("reciprocal", 1).input(number("a")).output(number("value")).run(|c| {
            let v = 1.0 / c.number("a")?;
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("series", 1)
            .input(Port::item::<i64>("count").range(0.0, 1e7).default(3))
            .input(number("from").default(0.0))
            .output(Port::list::<f64>("values"))
            .slow()
            .run(|c| {
                let (n, from) = (c.integer("count")?, c.number("from")?);
                c.set_list("values", (0..n).map(|i| from + i as f64).collect());
                Ok(())
            }),
        NodeType::new("sum", 1).input(Port::list::<f64>("values")).output(number("sum")).run(|c| {
            let sum: f64 = c.list::<f64>("values")?.iter().sum();
            c.set("sum", sum);
            Ok(())
        }),
        NodeType::new("count", 1).input(Port::tree::<f64>("values")).output(Port::item::<i64>("count")).run(|c| {
            let n = c.tree("values").len() as i64;
            c.set("count", n);
            Ok(())
        }),
        NodeType::new("text", 1)
            .input(Port::item::<Text>("value").choices(&["square", "plane"]).default("square"))
            .output(Port::item::<Text>("text"))
            .run(|c| {
                let t = Text::from(c.text("value")?);
                c.set("text", t);
                Ok(())
            }),
        NodeType::new("thick", 1)
            .input(number("t").unit(Unit::Length).range(0.1, 500.0).default(10.0))
            .output(number("t"))
            .run(|c| {
                let t = c.number("t")?;
                c.set("t", t);
                Ok(())
            }),
        NodeType::new("read", 1).input(Port::item::<Text>("path").file()).output(Port::item::<i64>("size")).run(|c| {
            let size = c.file("path")?.len() as i64;
            c.set("size", size);
            Ok(())
        }),
        NodeType::new("write", 1)
            .input(Port::item::<Text>("name").default("a.txt"))
            .input(Port::item::<i64>("size"))
            .output(Port::item::<File>("file"))
            .writer()
            .run(|c| {
                let (name, size) = (c.text("name")?, c.integer("size")?);
                let bytes = vec![b'x'; usize::try_from(size).unwrap_or(0)];
                c.set("file", File { name: name.into(), bytes: bytes.into(), withheld: None });
                Ok(())
            }),
        NodeType::new("panic", 1).input(number("a").default(1.0)).output(number("value")).run(|c| {
            assert!(c.number("a").is_ok_and(|a| a < 0.0), "the sky fell");
            c.set("value", 1.0);
            Ok(())
        }),
        NodeType::new("sleep", 1).input(number("ms").default(1000)).output(number("ms")).slow().run(|c| {
            let ms = c.number("ms")?;
            // By steps, so that a busy machine makes it longer and leaves nothing out.
            for step in 0..ms as u64 {
                if !c.progress(step as f64 / ms) {
                    return Err(Fail::cancelled());
                }
                std::thread::sleep(std::time::Duration::from_millis(1));
            }
            c.set("ms", ms);
            Ok(())
        }),
        NodeType::new("maybe", 1).input(number("a").optional()).output(number("value")).run(|c| {
            let v = c.optional::<f64>("a").copied().unwrap_or(-1.0);
            c.set("value", v);
            Ok(())
        }),
        NodeType::new("pass", 1).input(Port::any("in", Access::Tree)).output(Port::any("out", Access::Tree)).run(|c| {
            let t = c.tree("in").clone();
            c.set_tree("out", t);
            Ok(())
        }),
    ];
    for node in nodes {
        r.register(node).expect("test nodes are sound");
    }
    Arc::new(r)
}

pub fn document(nodes: Json) -> Document {
    let text = json!({"format": "tenon", "version": 1, "units": "mm", "nodes": nodes}).to_string();
    Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("{e:?}"))
}

pub fn session(nodes: Json) -> Session {
    Session::new(registry(), document(nodes), Options::default())
}

pub fn evaluate(s: &mut Session, targets: &[&str]) -> Report {
    s.evaluate(targets, &Control::default())
}

/// The items of the only branch.
pub fn items(s: &Session, name: &str) -> Json {
    let json = s.value(name).map(|t| t.to_json()["branches"].clone());
    match json {
        Some(Json::Object(o)) if o.len() == 1 => o["{0}"].clone(),
        Some(other) => other,
        None => Json::Null,
    }
}

/// The log as text, one event after another.
pub fn log(s: &mut Session) -> String {
    s.take_events().iter().map(|event| event.to_string()).collect::<Vec<_>>().join(", ")
}

pub fn lines(report: &Report) -> Vec<String> {
    report.diagnostics.iter().map(ToString::to_string).collect()
}
