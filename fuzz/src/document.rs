//! A graph file: read or refused with words; what is read is written and read back the same, and differences rebuild it.

use super::registry;
use tenon_engine::{Document, Options, Session};

/// Longest file that is looked at.
const LONGEST: usize = 1 << 20;

fn load(text: &str) -> Document {
    Document::from_slice(text.as_bytes()).unwrap_or_else(|e| panic!("what was written is not read: {e:?}\n{text}"))
}

pub fn check(bytes: &[u8]) {
    let mut blank = Document::new();
    let read = blank.read_layout(bytes);
    assert!(read.is_ok() || blank == Document::new());
    let document = match Document::from_slice_with_limit(bytes, LONGEST) {
        Ok(document) => document,
        Err(errors) => {
            assert!(!errors.is_empty() && errors.iter().all(|e| !e.message.is_empty()));
            return;
        }
    };
    for told in document.validate(registry()) {
        assert!(!told.to_string().is_empty());
    }
    let text = document.to_string_canonical();
    let again = load(&text);
    assert_eq!(again, document);
    assert_eq!(again.to_string_canonical(), text);

    let kept = document.to_string_canonical_for(registry());
    let again = load(&kept);
    assert_eq!(again, document);
    assert_eq!(again.to_string_canonical_for(registry()), kept);

    assert!(document.diff(&document).is_empty());
    let mut built = Document::new();
    for operation in built.diff(&document) {
        operation.apply(&mut built).unwrap_or_else(|e| panic!("a difference is refused: {e}"));
    }
    assert_eq!(built.to_string_canonical_for(registry()), kept);
    let mut emptied = document.clone();
    for operation in document.diff(&Document::new()) {
        operation.apply(&mut emptied).unwrap_or_else(|e| panic!("a difference is refused: {e}"));
    }
    assert_eq!(emptied.to_string_canonical_for(registry()), Document::new().to_string_canonical());

    // Compiled, not run: that is the target `nodes`.
    let session = Session::new(registry().clone(), document, Options { threads: 1, ..Options::default() });
    for name in session.document().outputs.keys() {
        assert!(session.value(name).is_none());
    }
}
