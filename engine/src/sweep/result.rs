//! What a row came to, as JSON that tells whether it is whole.

use crate::value::{Json, digest_bytes};

const SEAL: &str = "checksum";

fn checksum(result: &Json) -> String {
    format!("{:032x}", digest_bytes(result.to_string().as_bytes()))
}

/// Adds to a result the checksum of all that stands in it, under `checksum`. O(text).
#[must_use]
pub fn seal(mut result: Json) -> Json {
    if let Some(object) = result.as_object_mut() {
        object.remove(SEAL);
    }
    let sum = checksum(&result);
    if let Some(object) = result.as_object_mut() {
        object.insert(SEAL.to_owned(), sum.into());
    }
    result
}

/// The result that a text holds, if it is one that was sealed and nothing in it has changed since. White space between
/// its parts does not count. O(text).
#[must_use]
pub fn unseal(text: &[u8]) -> Option<Json> {
    let sealed: Json = serde_json::from_slice(text).ok()?;
    let mut bare = sealed.clone();
    let sum = bare.as_object_mut()?.remove(SEAL)?;
    (sum.as_str()? == checksum(&bare)).then_some(sealed)
}

#[cfg(test)]
mod tests {
    use super::*;
    use serde_json::json;

    #[test]
    fn a_sealed_result_is_read_whole_or_not_at_all() {
        let sealed = seal(json!({"key": "k", "values": {"area": 0.1, "n": 3}, "note": "a \"b\""}));
        let text = format!("{sealed:#}\n");
        assert_eq!(unseal(text.as_bytes()), Some(sealed.clone()));
        assert_eq!(seal(sealed.clone()), sealed);
        // Whatever single byte is another one: damaged, or the same value (white space).
        for i in 0..text.len() {
            let mut damaged = text.clone().into_bytes();
            damaged[i] ^= 1;
            assert!(unseal(&damaged).is_none_or(|r| r == sealed), "byte {i}");
            assert_eq!(unseal(&text.as_bytes()[..i]).filter(|r| *r != sealed), None, "cut off at {i}");
        }
        assert_eq!(unseal(b"{\"key\": \"k\"}"), None, "a result without a seal");
    }
}
