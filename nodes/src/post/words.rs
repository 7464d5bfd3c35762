//! A machine's dialect: which words a program is written with. Part of the machine file, beside the geometry.

use serde::{Deserialize, Serialize};

/// The words of a control. Templates may hold `{tool}`, `{speed}`, `{feed}` and `{safe}`, each where it has a meaning.
#[derive(Clone, Debug, Default, PartialEq, Serialize, Deserialize)]
pub struct Words {
    /// File name extension, without the dot.
    pub extension: String,
    /// Lines that open a program; `{safe}` is the safe height as programmed.
    pub program_start: Vec<String>,
    /// Lines that close a program; `{safe}` as above.
    pub program_end: Vec<String>,
    /// Lines that change the tool: `{tool}` its number, `{speed}` its spindle speed.
    pub tool_change: Vec<String>,
    /// Word of a rapid move.
    pub rapid: String,
    /// Word of a move at feed.
    pub feed: String,
    /// Word of a feed rate; `{feed}` in mm/min.
    pub feed_rate: String,
    /// What opens and what closes a comment; the second may be empty where a comment runs to the end of the line.
    pub comment: [String; 2],
    /// Decimals of lengths, mm.
    pub length_decimals: u32,
    /// Decimals of angles, degrees.
    pub angle_decimals: u32,
    /// Whether words that have not changed are left out.
    pub modal: bool,
}

/// Which `{…}` a template may hold, by field.
const PLACES: [(&str, &[&str]); 4] = [
    ("program_start", &["{safe}"]),
    ("program_end", &["{safe}"]),
    ("tool_change", &["{tool}", "{speed}", "{safe}"]),
    ("feed_rate", &["{feed}"]),
];

impl Words {
    /// Checks that decimals are usable, templates hold only what they may, and comments can be closed. Returns the
    /// field at fault and what is wrong with it.
    ///
    /// # Errors
    /// `(field, problem)`.
    pub fn check(&self) -> Result<(), (String, String)> {
        for (name, value) in [("length_decimals", self.length_decimals), ("angle_decimals", self.angle_decimals)] {
            if value > 9 {
                return Err((name.into(), format!("{value} is more than 9 decimals")));
            }
        }
        for (name, value) in [("rapid", &self.rapid), ("feed", &self.feed), ("comment", &self.comment[0])] {
            if value.is_empty() {
                return Err((name.into(), "must not be empty".into()));
            }
        }
        if self.extension.is_empty() || !self.extension.chars().all(|c| c.is_ascii_alphanumeric()) {
            return Err(("extension".into(), format!("\"{}\" must be letters and digits", self.extension)));
        }
        let feed_rate = std::slice::from_ref(&self.feed_rate);
        let lines: [&[String]; 4] = [&self.program_start, &self.program_end, &self.tool_change, feed_rate];
        for ((field, places), lines) in PLACES.iter().zip(lines) {
            for line in lines {
                let rest = places.iter().fold(line.clone(), |l, p| l.replace(p, ""));
                if rest.contains(['{', '}']) {
                    return Err(((*field).into(), format!("\"{line}\" may hold {} only", places.join(", "))));
                }
                if line.contains(['\n', '\r']) {
                    return Err(((*field).into(), "one line per entry".into()));
                }
            }
        }
        for (field, lines, place) in
            [("tool_change", self.tool_change.as_slice(), "{tool}"), ("feed_rate", feed_rate, "{feed}")]
        {
            if !lines.iter().any(|l| l.contains(place)) {
                return Err((field.into(), format!("must hold {place}")));
            }
        }
        Ok(())
    }
}
