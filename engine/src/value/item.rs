//! What can travel on wires: the `Item` trait and the engine's own item types.

use super::digest::Digester;
use super::pack::{pack, unpack};
use std::sync::Arc;

/// JSON as the file, the reports and the command line speak it.
pub type Json = serde_json::Value;

/// One item type that can travel on wires.
///
/// `Default` fills the place of a gap; it is never shown to a node.
pub trait Item: Clone + Default + Send + Sync + 'static {
    /// The type's name in the file, in reports and in messages.
    const TYPE: &'static str;

    /// Version of what [`Item::encode`] writes, to be raised with every change of it. 0: items of this type are not kept
    /// outside of memory, so that every process computes results with them anew.
    const FORMAT: u32 = 0;

    /// Feeds everything that makes two items different.
    fn digest(&self, d: &mut Digester);

    /// Feeds many items; types that are plain numbers may do it faster than one by one.
    fn digest_all(items: &[Self], d: &mut Digester) {
        for item in items {
            item.digest(d);
        }
    }

    /// Bytes on the heap that this item owns, beyond `size_of`.
    fn heap_bytes(&self) -> usize {
        0
    }

    /// Appends at least one byte, of which [`Item::decode`] makes the same item, floats bit for bit. False: this item
    /// cannot be kept.
    fn encode(&self, _out: &mut Vec<u8>) -> bool {
        false
    }

    /// Takes one item off the front of `bytes`; `None` if there is none. The bytes may be anything: no panic, and no more
    /// memory than in proportion to their number.
    fn decode(_bytes: &mut &[u8]) -> Option<Self> {
        None
    }

    /// The documented JSON of the type.
    fn to_json(&self) -> Json;

    /// The item that a literal in the file stands for.
    ///
    /// # Errors
    /// A sentence for people that says what would be accepted.
    fn from_json(_: &Json) -> Result<Self, String> {
        Err(format!("a {} cannot be written as a literal; connect a wire", Self::TYPE))
    }

    /// One line for people.
    fn summary(&self) -> String {
        let text = self.to_json().to_string();
        if text.chars().count() > 80 { text.chars().take(79).chain(['…']).collect() } else { text }
    }
}

impl Item for f64 {
    const TYPE: &'static str = "number";
    const FORMAT: u32 = 1;

    fn digest(&self, d: &mut Digester) {
        d.f64(*self);
    }

    fn digest_all(items: &[Self], d: &mut Digester) {
        d.f64s_raw(items);
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        out.extend_from_slice(&self.to_le_bytes());
        true
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        bytes.split_off(..8)?.try_into().ok().map(Self::from_le_bytes)
    }

    /// A JSON number; NaN and infinities, which JSON lacks, as text.
    fn to_json(&self) -> Json {
        serde_json::Number::from_f64(*self).map_or_else(|| Json::String(self.to_string()), Json::Number)
    }

    fn from_json(json: &Json) -> Result<Self, String> {
        match json.as_f64() {
            Some(v) if v.is_finite() => Ok(v),
            Some(v) => Err(format!("{v} is not a finite number")),
            None => Err(format!("expected a number, found {}", kind_of(json))),
        }
    }
}

impl Item for i64 {
    const TYPE: &'static str = "integer";
    const FORMAT: u32 = 1;

    fn digest(&self, d: &mut Digester) {
        d.i64(*self);
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        out.extend_from_slice(&self.to_le_bytes());
        true
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        bytes.split_off(..8)?.try_into().ok().map(Self::from_le_bytes)
    }

    fn to_json(&self) -> Json {
        Json::from(*self)
    }

    /// A whole number; `3.0` counts as 3.
    fn from_json(json: &Json) -> Result<Self, String> {
        if let Some(v) = json.as_i64() {
            return Ok(v);
        }
        match json.as_f64() {
            // Beyond 2^53 a float no longer says which whole number was meant.
            Some(v) if v.fract() == 0.0 && v.abs() <= 9_007_199_254_740_992.0 => Ok(v as i64),
            Some(v) => Err(format!("expected a whole number, found {v}")),
            None => Err(format!("expected a whole number, found {}", kind_of(json))),
        }
    }
}

impl Item for bool {
    const TYPE: &'static str = "boolean";
    const FORMAT: u32 = 1;

    fn digest(&self, d: &mut Digester) {
        d.bool(*self);
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        pack(self, out)
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        unpack(bytes)
    }

    fn to_json(&self) -> Json {
        Json::Bool(*self)
    }

    fn from_json(json: &Json) -> Result<Self, String> {
        json.as_bool().ok_or_else(|| format!("expected true or false, found {}", kind_of(json)))
    }
}

/// A piece of text.
#[derive(Clone, Debug, PartialEq, Eq, PartialOrd, Ord, Hash)]
pub struct Text(pub Arc<str>);

impl Default for Text {
    fn default() -> Self {
        Self(Arc::from(""))
    }
}

impl From<&str> for Text {
    fn from(s: &str) -> Self {
        Self(Arc::from(s))
    }
}

impl From<String> for Text {
    fn from(s: String) -> Self {
        Self(Arc::from(s))
    }
}

impl std::fmt::Display for Text {
    fn fmt(&self, f: &mut std::fmt::Formatter<'_>) -> std::fmt::Result {
        f.write_str(&self.0)
    }
}

impl Item for Text {
    const TYPE: &'static str = "text";
    const FORMAT: u32 = 1;

    fn digest(&self, d: &mut Digester) {
        d.str(&self.0);
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        pack(&*self.0, out)
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        unpack::<&str>(bytes).map(Self::from)
    }

    fn heap_bytes(&self) -> usize {
        self.0.len()
    }

    fn to_json(&self) -> Json {
        Json::from(&*self.0)
    }

    fn from_json(json: &Json) -> Result<Self, String> {
        json.as_str().map(Self::from).ok_or_else(|| format!("expected text, found {}", kind_of(json)))
    }
}

/// What a writer node makes: named bytes that the host writes, whole or not at all.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct File {
    /// File name relative to the output folder.
    pub name: Arc<str>,
    /// Content.
    pub bytes: Arc<[u8]>,
    /// Why the host must not give it its final name unless the user insists.
    pub withheld: Option<Arc<str>>,
}

impl Default for File {
    fn default() -> Self {
        Self { name: Arc::from(""), bytes: Arc::from([]), withheld: None }
    }
}

impl Item for File {
    const TYPE: &'static str = "file";
    const FORMAT: u32 = 1;

    fn digest(&self, d: &mut Digester) {
        d.str(&self.name);
        d.bytes(&self.bytes);
        match &self.withheld {
            None => d.bool(false),
            Some(why) => {
                d.bool(true);
                d.str(why);
            }
        }
    }

    fn encode(&self, out: &mut Vec<u8>) -> bool {
        let head = pack(&(&*self.name, self.withheld.as_deref(), self.bytes.len() as u64), out);
        out.extend_from_slice(&self.bytes);
        head
    }

    fn decode(bytes: &mut &[u8]) -> Option<Self> {
        let (name, withheld, len): (&str, Option<&str>, u64) = unpack(bytes)?;
        let content = bytes.split_off(..usize::try_from(len).ok()?)?;
        Some(Self { name: name.into(), bytes: content.into(), withheld: withheld.map(Arc::from) })
    }

    fn heap_bytes(&self) -> usize {
        self.name.len() + self.bytes.len() + self.withheld.as_ref().map_or(0, |w| w.len())
    }

    /// `{"name", "bytes": count, "digest": hex, "withheld": reason or null}`; the content itself goes to disk, not to JSON.
    fn to_json(&self) -> Json {
        serde_json::json!({
            "name": &*self.name,
            "bytes": self.bytes.len(),
            "digest": format!("{:032x}", super::digest::digest_bytes(&self.bytes)),
            "withheld": self.withheld.as_deref(),
        })
    }

    fn summary(&self) -> String {
        format!("{} ({} bytes)", self.name, self.bytes.len())
    }
}

/// What a JSON value is, in words for messages.
pub(crate) fn kind_of(json: &Json) -> String {
    match json {
        Json::Null => "null".into(),
        Json::Bool(b) => b.to_string(),
        Json::Number(n) => format!("the number {n}"),
        Json::String(s) => format!("the text \"{}\"", s.chars().take(40).collect::<String>()),
        Json::Array(a) => format!("a list of {}", a.len()),
        Json::Object(_) => "an object".into(),
    }
}
