//! Errors are values: what went wrong, where, and where it can be said, what would fix it.

mod codes;

pub use codes::{CODES, Code};

use serde::{Deserialize, Serialize};
use std::borrow::Cow;

/// How bad it is.
#[derive(Clone, Copy, Debug, PartialEq, Eq, PartialOrd, Ord, Serialize, Deserialize)]
#[serde(rename_all = "lowercase")]
pub enum Severity {
    /// Worth knowing; nothing is wrong.
    Note,
    /// The result stands, but may not be what was meant.
    Warning,
    /// Something is missing from the result.
    Error,
}

impl Severity {
    /// `"error"`, `"warning"` or `"note"`.
    #[must_use]
    pub fn as_str(self) -> &'static str {
        match self {
            Self::Note => "note",
            Self::Warning => "warning",
            Self::Error => "error",
        }
    }
}

/// A diagnostic with its place.
#[derive(Clone, Debug, PartialEq, Eq, Serialize)]
pub struct Diagnostic {
    /// How bad it is.
    pub severity: Severity,
    /// A stable name in kebab-case, such as `unknown-port`.
    pub code: Cow<'static, str>,
    /// A sentence for people.
    pub message: String,
    /// Id of the node in the document.
    pub node: Option<Box<str>>,
    /// Port of that node.
    pub port: Option<Box<str>>,
    /// Index of the item.
    pub item: Option<usize>,
    /// What would fix it.
    pub hint: Option<Box<str>>,
}

impl Diagnostic {
    /// An error without a place.
    #[must_use]
    pub fn error(code: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self {
            severity: Severity::Error,
            code: code.into(),
            message: message.into(),
            node: None,
            port: None,
            item: None,
            hint: None,
        }
    }

    /// The same with another severity.
    #[must_use]
    pub fn with_severity(mut self, severity: Severity) -> Self {
        self.severity = severity;
        self
    }

    /// Names the node.
    #[must_use]
    pub fn at(mut self, node: impl Into<String>) -> Self {
        self.node = Some(node.into().into_boxed_str());
        self
    }

    /// Names the port.
    #[must_use]
    pub fn port(mut self, port: impl Into<String>) -> Self {
        self.port = Some(port.into().into_boxed_str());
        self
    }

    /// Says what would fix it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = Some(hint.into().into_boxed_str());
        self
    }

    /// Says what would fix it, if that is known.
    #[must_use]
    pub(crate) fn maybe_hint(mut self, hint: Option<String>) -> Self {
        self.hint = hint.map(Into::into).or(self.hint);
        self
    }
}

impl std::fmt::Display for Diagnostic {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        write!(f, "{}[{}]", self.severity.as_str(), self.code)?;
        if let Some(node) = &self.node {
            write!(f, " {node}")?;
            if let Some(port) = &self.port {
                write!(f, ".{port}")?;
            }
        } else if let Some(port) = &self.port {
            write!(f, " {port}")?;
        }
        if let Some(item) = self.item {
            write!(f, " item {item}")?;
        }
        write!(f, ": {}", self.message)?;
        if let Some(hint) = &self.hint {
            write!(f, " ({hint})")?;
        }
        Ok(())
    }
}

impl std::error::Error for Diagnostic {}

/// A diagnostic without its place, as nodes make them; the engine adds node and item.
#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
pub struct Fail(Box<Body>);

#[derive(Clone, Debug, PartialEq, Eq, Serialize, Deserialize)]
struct Body {
    code: Cow<'static, str>,
    message: String,
    port: Option<Box<str>>,
    item: Option<usize>,
    hint: Option<Box<str>>,
}

pub(crate) const CANCELLED: &str = "cancelled";

impl Fail {
    /// `code` in kebab-case, `message` a sentence for people.
    #[must_use]
    pub fn new(code: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        Self(Box::new(Body { code: code.into(), message: message.into(), port: None, item: None, hint: None }))
    }

    /// The computation stopped because it was asked to.
    #[must_use]
    pub fn cancelled() -> Self {
        Self::new(CANCELLED, "cancelled")
    }

    /// True for [`Fail::cancelled`].
    #[must_use]
    pub fn is_cancelled(&self) -> bool {
        self.0.code == CANCELLED
    }

    /// Names the port.
    #[must_use]
    pub fn port(mut self, port: impl Into<String>) -> Self {
        self.0.port = Some(port.into().into_boxed_str());
        self
    }

    /// Names the item inside the value (a face, a panel); without it the engine puts the lane's index.
    #[must_use]
    pub fn item(mut self, item: usize) -> Self {
        self.0.item = Some(item);
        self
    }

    /// Says what would fix it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.0.hint = Some(hint.into().into_boxed_str());
        self
    }

    /// The stable name.
    #[must_use]
    pub fn code(&self) -> &str {
        &self.0.code
    }

    /// The sentence for people.
    #[must_use]
    pub fn message(&self) -> &str {
        &self.0.message
    }

    pub(crate) fn item_or(mut self, lane: Option<usize>) -> Self {
        self.0.item = self.0.item.or(lane);
        self
    }

    pub(crate) fn at(&self, severity: Severity, node: &str) -> Diagnostic {
        let b = &*self.0;
        Diagnostic {
            severity,
            code: b.code.clone(),
            message: b.message.clone(),
            node: Some(node.into()),
            port: b.port.clone(),
            item: b.item,
            hint: b.hint.clone(),
        }
    }
}

impl std::fmt::Display for Fail {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0.message)
    }
}

impl std::error::Error for Fail {}

/// The candidate nearest to `name` if it is near enough to be a slip of the pen. O(candidates × length²).
#[must_use]
pub fn nearest<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<&'a str> {
    let short: Vec<char> = name.chars().take(64).flat_map(char::to_lowercase).collect();
    let limit = (short.len() / 3).max(1) + 1;
    candidates
        .into_iter()
        .filter_map(|c| {
            let other: Vec<char> = c.chars().take(64).flat_map(char::to_lowercase).collect();
            let d = if other.len().abs_diff(short.len()) > limit && !c.contains(name) && !name.contains(c) {
                return None;
            } else if short.len() >= 3 && c.contains(name) {
                1
            } else {
                edit_distance(&short, &other)
            };
            (d <= limit).then_some((d, c))
        })
        .min()
        .map(|(_, c)| c)
}

fn edit_distance(a: &[char], b: &[char]) -> usize {
    let mut row: Vec<usize> = (0..=b.len()).collect();
    for (i, x) in a.iter().enumerate() {
        let mut diagonal = row[0];
        row[0] = i + 1;
        for (j, y) in b.iter().enumerate() {
            let substitute = diagonal + usize::from(x != y);
            diagonal = row[j + 1];
            row[j + 1] = substitute.min(row[j] + 1).min(diagonal + 1);
        }
    }
    row[b.len()]
}

/// "Did you mean …?" as a hint.
pub(crate) fn did_you_mean<'a>(name: &str, candidates: impl IntoIterator<Item = &'a str>) -> Option<String> {
    nearest(name, candidates).map(|n| format!("did you mean \"{n}\"?"))
}

#[cfg(test)]
mod tests {
    use super::*;

    #[test]
    fn nearest_name_finds_slips_and_refuses_strangers() {
        let names = ["thickness", "mesh", "features"];
        assert_eq!(nearest("thicknes", names), Some("thickness"));
        assert_eq!(nearest("mash", names), Some("mesh"));
        assert_eq!(nearest("zzzzzzzz", names), None);
    }
}
