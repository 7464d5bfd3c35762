//! Formulas and units: a finite quantity or a fault with its column, alone and as a parameter.

use super::registry;
use std::sync::LazyLock;
use tenon_engine::{Document, Expression, Node, Options, Quantity, Session};

fn measured(value: f64, unit: &str) -> Result<Quantity, String> {
    Quantity::unit(unit).map(|u| Quantity { value, ..u }).ok_or_else(|| format!("{unit} is no unit"))
}

pub fn check(bytes: &[u8]) {
    let Ok(text) = std::str::from_utf8(bytes) else { return };
    if let Some(unit) = Quantity::unit(text) {
        assert!(unit.value.is_finite() && unit.value > 0.0, "{text}: {unit:?}");
    }
    let number = |name: &str| match name.len() % 5 {
        0 => Err(format!("no {name}")),
        1 => Ok(Quantity::plain(3.0)),
        2 => measured(12.0, "mm"),
        3 => measured(-0.0, "deg"),
        _ => measured(1e308, "mm2"),
    };
    match Expression::parse(text) {
        Ok(expression) => {
            assert!(expression.names().iter().all(|n| text.contains(n.as_str())));
            match expression.evaluate(&number) {
                Ok(q) => {
                    assert!(q.value.is_finite(), "{text}: {q:?}");
                    assert!(q.dimension.is_plain() || !q.dimension.to_string().is_empty(), "{q:?}");
                    let again = expression.evaluate(&number).map(|q| q.value.to_bits());
                    assert_eq!(again.ok(), Some(q.value.to_bits()));
                }
                Err(e) => assert!(e.to_string().starts_with("column "), "{e}"),
            }
        }
        Err(e) => assert!(e.to_string().starts_with("column "), "{e}"),
    }
    as_parameter(text);
}

/// The same text at ports with and without a unit, where names are those of interface inputs.
fn as_parameter(text: &str) {
    static GRAPH: LazyLock<Document> = LazyLock::new(|| {
        let text = br#"{"format": "tenon", "interface": {"inputs": {"a": {"port": "n.value"}, "t": {"port": "p.thickness"}}},
            "nodes": {"n": {"type": "number"}, "m": {"type": "number"}, "p": {"type": "thicken"}, "s": {"type": "series"}}}"#;
        Document::from_slice(text).unwrap_or_default()
    });
    let options = Options { threads: 1, ..Options::default() };
    let mut session = Session::new(registry().clone(), GRAPH.clone(), options);
    for port in ["n.value", "m.value", "p.thickness", "p.bottom_angle", "s.count", "a", "t"] {
        let before = session.document().to_string_canonical();
        if let Err(refused) = session.set(port, text.into()) {
            assert!(!refused.message.is_empty());
            assert_eq!(
                session.document().to_string_canonical(),
                before,
                "{port} = {text} was refused and changed something"
            );
        }
    }
    let document = session.document().clone();
    let _ = document.validate(registry());
    // A file may hold what setting refuses.
    let mut document = GRAPH.clone();
    let _ = document.insert("m", Node::new("number").param("value", text));
    let _ = document.insert("p", Node::new("thicken").param("thickness", text));
    let told = document.validate(registry());
    assert!(told.iter().all(|d| !d.message.is_empty()));
}
