//! Programs. JSON `{ "name", "board", "standing", "text" }`.

use crate::post::PostedProgram;
use serde_json::json;
use std::sync::Arc;
use tenon_engine::{Digester, Item, Json};

/// What is known of a program's proof.
#[derive(Clone, Debug, Default, PartialEq)]
pub enum Standing {
    /// Nobody has proven it.
    #[default]
    Unproven,
    /// It passed.
    Passed,
    /// It failed, for this reason first.
    Failed(Arc<str>),
}

/// A machine program with its standing.
#[derive(Clone, Debug, Default, PartialEq)]
pub struct Program {
    /// Name and text.
    pub posted: Arc<PostedProgram>,
    /// What is known of its proof.
    pub standing: Standing,
}

impl Standing {
    /// Why the program must not get its final name; `None` if it passed.
    #[must_use]
    pub fn withheld(&self) -> Option<Arc<str>> {
        match self {
            Self::Passed => None,
            Self::Unproven => Some("the program has not been proven".into()),
            Self::Failed(why) => Some(format!("the proof failed: {why}").into()),
        }
    }
}

impl Item for Program {
    const TYPE: &'static str = "program";
    fn digest(&self, d: &mut Digester) {
        d.str(&self.posted.name);
        d.str(&self.posted.extension);
        d.u32(self.posted.board);
        d.str(&self.posted.text);
        d.str(&self.standing.withheld().unwrap_or_default());
    }
    fn heap_bytes(&self) -> usize {
        self.posted.text.len() + self.posted.name.len()
    }
    fn to_json(&self) -> Json {
        json!({
            "name": self.posted.file_name(),
            "board": self.posted.board,
            "standing": match &self.standing {
                Standing::Unproven => "unproven",
                Standing::Passed => "passed",
                Standing::Failed(_) => "failed",
            },
            "text": self.posted.text,
        })
    }
    fn summary(&self) -> String {
        format!("{}, {} lines", self.posted.file_name(), self.posted.text.lines().count())
    }
}
