//! The value of a parameter as the file says it: JSON, in 24 bytes where serde's own value takes 72.

use super::fields::Name;
use crate::value::Json;
use serde_json::Number;
use std::borrow::Cow;

/// A JSON value of a parameter. Most are numbers and short texts, which take no memory of their own.
#[derive(Clone, Debug, PartialEq)]
pub struct Literal(Kind);

#[derive(Clone, Debug, PartialEq)]
enum Kind {
    Null,
    Boolean(bool),
    Number(Number),
    Text(Name),
    Other(Box<Json>),
}

impl Literal {
    /// The number, if it is one.
    #[must_use]
    pub fn as_f64(&self) -> Option<f64> {
        match &self.0 {
            Kind::Number(n) => n.as_f64(),
            _ => None,
        }
    }

    /// The whole number, if it is one.
    #[must_use]
    pub fn as_i64(&self) -> Option<i64> {
        match &self.0 {
            Kind::Number(n) => n.as_i64(),
            _ => None,
        }
    }

    /// The text, if it is one.
    #[must_use]
    pub fn as_str(&self) -> Option<&str> {
        match &self.0 {
            Kind::Text(text) => Some(text),
            _ => None,
        }
    }

    /// As serde's value; lists and objects are lent. O(length of the text).
    #[must_use]
    pub fn json(&self) -> Cow<'_, Json> {
        Cow::Owned(match &self.0 {
            Kind::Null => Json::Null,
            Kind::Boolean(v) => Json::Bool(*v),
            Kind::Number(n) => Json::Number(n.clone()),
            Kind::Text(text) => Json::from(text.as_str()),
            Kind::Other(json) => return Cow::Borrowed(json),
        })
    }

    /// As serde's value. O(n).
    #[must_use]
    pub fn to_json(&self) -> Json {
        self.json().into_owned()
    }

    /// The list or object, if it is one.
    pub(crate) fn nested(&self) -> Option<&Json> {
        match &self.0 {
            Kind::Other(json) => Some(json),
            _ => None,
        }
    }
}

impl From<Json> for Literal {
    fn from(json: Json) -> Self {
        Self(match json {
            Json::Null => Kind::Null,
            Json::Bool(v) => Kind::Boolean(v),
            Json::Number(n) => Kind::Number(n),
            Json::String(text) => Kind::Text(text.into()),
            other => Kind::Other(Box::new(other)),
        })
    }
}

impl PartialEq<Json> for Literal {
    fn eq(&self, other: &Json) -> bool {
        match (&self.0, other) {
            (Kind::Null, Json::Null) => true,
            (Kind::Boolean(a), Json::Bool(b)) => a == b,
            (Kind::Number(a), Json::Number(b)) => a == b,
            (Kind::Text(a), Json::String(b)) => a == b,
            (Kind::Other(a), b) => **a == *b,
            _ => false,
        }
    }
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn every_kind_comes_back() {
        let all = [
            json!(null),
            json!(true),
            json!(1),
            json!(-0.0),
            json!(1e300),
            json!(u64::MAX),
            json!("a"),
            json!("far more than fifteen bytes of text"),
            json!([1, [2]]),
            json!({"b": 1, "a": 2}),
        ];
        for json in &all {
            let literal = Literal::from(json.clone());
            assert_eq!(literal.to_json().to_string(), json.to_string());
            assert!(all.iter().all(|other| (literal == *other) == std::ptr::eq(json, other)));
        }
        assert!(size_of::<Literal>() <= 24);
    }
}
