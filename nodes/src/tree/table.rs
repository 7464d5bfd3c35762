//! Tables of attributes: made column by column, and asked for one.

use crate::value::Table;
use tenon_engine::{Access, Fail, NodeType, Port, Text};

pub(super) fn nodes() -> Vec<NodeType> {
    vec![set_attribute(), attribute()]
}

fn set_attribute() -> NodeType {
    NodeType::new("set_attribute", 1)
        .name("Set attribute")
        .category("Trees")
        .doc("A table with an attribute more: a value per row under a name. Without a table it begins one.")
        .keywords(&["table", "data", "dictionary", "column"])
        .input(Port::item::<Table>("table").optional().doc("The table; without one, a new one of as many rows."))
        .input(Port::item::<Text>("name").doc("The attribute's name; one of that name is replaced."))
        .input(Port::any("values", Access::List).doc("A value per row."))
        .output(Port::item::<Table>("table").doc("The table with it."))
        .run(|c| {
            let (name, values) = (c.text("name")?.to_owned(), c.column("values")?);
            if name.is_empty() {
                return Err(Fail::new("no-attribute", "an attribute needs a name").port("name"));
            }
            let table = c.optional::<Table>("table").cloned().unwrap_or_else(|| Table::new(values.len()));
            let table = table.with(&name, values).map_err(|why| Fail::new("attribute-length", why).port("values"))?;
            c.set("table", table);
            Ok(())
        })
}

fn attribute() -> NodeType {
    NodeType::new("attribute", 1)
        .name("Attribute")
        .category("Trees")
        .doc("The values of one attribute of a table, a value per row.")
        .keywords(&["table", "data", "dictionary", "column"])
        .input(Port::item::<Table>("table").doc("The table."))
        .input(Port::item::<Text>("name").doc("The attribute's name."))
        .output(Port::any("values", Access::List).doc("Its values."))
        .run(|c| {
            let (table, name) = (c.item::<Table>("table")?, c.text("name")?);
            let Some(column) = table.attribute(name) else {
                let names: Vec<&str> = table.attributes().map(|(name, _)| name).collect();
                let fail = Fail::new("no-attribute", format!("the table has no attribute \"{name}\"")).port("name");
                return Err(fail.hint(format!("it has {}", names.join(", "))));
            };
            let column = column.clone();
            c.set_column("values", column);
            Ok(())
        })
}
