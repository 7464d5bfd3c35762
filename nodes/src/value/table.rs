//! Tables of attributes. JSON: `{ "rows": 2, "attributes": { "length": [1.5, null], … } }`, attributes in their order.

use serde_json::json;
use std::sync::Arc;
use tenon_engine::{Column, Digester, Item, Json};

/// Columns of as many rows, each under a name; cloning it is free.
#[derive(Clone, Default)]
pub struct Table {
    rows: usize,
    attributes: Arc<[(Box<str>, Column)]>,
}

impl Table {
    /// A table of `rows` rows without attributes.
    #[must_use]
    pub fn new(rows: usize) -> Self {
        Self { rows, attributes: Arc::default() }
    }

    /// Number of rows.
    #[must_use]
    pub fn rows(&self) -> usize {
        self.rows
    }

    /// Attributes in order.
    pub fn attributes(&self) -> impl Iterator<Item = (&str, &Column)> {
        self.attributes.iter().map(|(name, column)| (&**name, column))
    }

    /// The attribute of that name. O(attributes).
    #[must_use]
    pub fn attribute(&self, name: &str) -> Option<&Column> {
        self.attributes().find(|(n, _)| *n == name).map(|(_, column)| column)
    }

    /// The table with an attribute more, or another in its place. O(attributes).
    ///
    /// # Errors
    /// If the attribute has not one item per row.
    pub fn with(&self, name: &str, column: Column) -> Result<Self, String> {
        if column.len() != self.rows {
            return Err(format!("{} items for a table of {} rows", column.len(), self.rows));
        }
        let mut attributes = self.attributes.to_vec();
        match attributes.iter_mut().find(|(n, _)| **n == *name) {
            Some(place) => place.1 = column,
            None => attributes.push((name.into(), column)),
        }
        Ok(Self { rows: self.rows, attributes: attributes.into() })
    }
}

impl Item for Table {
    const TYPE: &'static str = "table";
    fn digest(&self, d: &mut Digester) {
        d.u64(self.rows as u64);
        for (name, column) in self.attributes() {
            d.str(name);
            d.u128(column.digest());
        }
    }
    fn heap_bytes(&self) -> usize {
        self.attributes().map(|(name, column)| name.len() + column.bytes()).sum()
    }
    fn to_json(&self) -> Json {
        let attributes: serde_json::Map<String, Json> =
            self.attributes().map(|(name, column)| (name.to_owned(), column.to_json())).collect();
        json!({ "rows": self.rows, "attributes": attributes })
    }
    fn from_json(_: &Json) -> Result<Self, String> {
        Err("a table cannot be written in the file; wire one to this port".into())
    }
    fn summary(&self) -> String {
        let names: Vec<&str> = self.attributes().map(|(name, _)| name).collect();
        format!("{} rows: {}", self.rows, names.join(", "))
    }
}
