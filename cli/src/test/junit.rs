//! The outcomes of `tenon test` as JUnit XML, which CI servers read: a suite per graph, a case per expectation.

use super::Tested;
use std::fmt::Write;

/// The whole report.
pub fn report(all: &[Tested]) -> String {
    let mut out = String::from("<?xml version=\"1.0\" encoding=\"UTF-8\"?>\n<testsuites name=\"tenon\">\n");
    for tested in all {
        suite(tested, &mut out);
    }
    out.push_str("</testsuites>\n");
    out
}

fn suite(tested: &Tested, out: &mut String) {
    let graph = escape(&tested.graph.display().to_string());
    let time = tested.elapsed.as_secs_f64();
    let (tests, failures, errors) = match &tested.result {
        Ok(all) => (all.len(), all.iter().filter(|o| !o.failures.is_empty()).count(), 0),
        Err(_) => (1, 0, 1),
    };
    let _ = writeln!(
        out,
        "  <testsuite name=\"{graph}\" tests=\"{tests}\" failures=\"{failures}\" errors=\"{errors}\" time=\"{time:.3}\">"
    );
    match &tested.result {
        Ok(all) => {
            for outcome in all {
                let name = escape(&outcome.name);
                let _ = write!(out, "    <testcase classname=\"{graph}\" name=\"{name}\"");
                match outcome.failures.as_slice() {
                    [] => out.push_str("/>\n"),
                    [first, ..] => {
                        let (first, all) = (escape(first), escape(&outcome.failures.join("\n")));
                        let _ = writeln!(out, "><failure message=\"{first}\">{all}</failure></testcase>");
                    }
                }
            }
        }
        Err(wrong) => {
            let lines: Vec<&str> = wrong.diagnostics.iter().map(|d| &*d.message).collect();
            let (message, more) = (escape(&wrong.message), escape(&lines.join("\n")));
            let _ = writeln!(
                out,
                "    <testcase classname=\"{graph}\" name=\"evaluation\"><error message=\"{message}\">{more}</error></testcase>"
            );
        }
    }
    out.push_str("  </testsuite>\n");
}

/// Text for XML 1.0, in which most control characters cannot stand at all.
pub fn escape(text: &str) -> String {
    let mut out = String::with_capacity(text.len());
    for c in text.chars() {
        match c {
            '&' => out.push_str("&amp;"),
            '<' => out.push_str("&lt;"),
            '>' => out.push_str("&gt;"),
            '"' => out.push_str("&quot;"),
            '\n' | '\t' => out.push(c),
            c if c.is_control() || c == '\u{fffe}' || c == '\u{ffff}' => out.push('\u{fffd}'),
            c => out.push(c),
        }
    }
    out
}

#[cfg(test)]
mod tests {
    #[test]
    fn nothing_breaks_out_of_the_xml() {
        assert_eq!(super::escape("a<b>&\"c\"\u{0}\n"), "a&lt;b&gt;&amp;&quot;c&quot;\u{fffd}\n");
    }
}
