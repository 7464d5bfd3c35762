//! Programs. JSON `{ "name", "board", "standing", "text" }`.

use crate::post::PostedProgram;
use serde_json::json;
use std::sync::Arc;
use tenon_engine::{Digester, Item, Json, pack, unpack};

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
    const FORMAT: u32 = 1;
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
    fn encode(&self, out: &mut Vec<u8>) -> bool {
        let (passed, why) = match &self.standing {
            Standing::Unproven => (false, None),
            Standing::Passed => (true, None),
            Standing::Failed(why) => (false, Some(&**why)),
        };
        pack(&(&*self.posted, passed, why), out)
    }
    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        let (posted, passed, why): (PostedProgram, bool, Option<&str>) = unpack(bytes)?;
        let standing = match why {
            Some(why) => Standing::Failed(why.into()),
            None if passed => Standing::Passed,
            None => Standing::Unproven,
        };
        Some(Self { posted: Arc::new(posted), standing })
    }
}
