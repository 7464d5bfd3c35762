//! One measured figure, printed as one line of JSON.

use serde_json::json;
use std::time::{Duration, Instant};

/// A figure: what was measured, of what size, and what it is compared with.
pub struct Figure {
    /// The suite, such as "chain".
    pub suite: &'static str,
    /// The case within the suite.
    pub case: &'static str,
    /// Its size, such as the number of panels.
    pub size: u64,
    /// What was measured.
    pub ours: f64,
    /// Its unit.
    pub unit: &'static str,
    /// The name of the peer, if there is one.
    pub peer: Option<String>,
    /// What the peer needs, in the same unit.
    pub theirs: Option<f64>,
    /// What is aimed at, in the same unit; for cases compared with their own smallest size, the greatest ratio.
    pub target: Option<f64>,
}

impl Figure {
    /// Prints the figure; `ratio` is ours over theirs: below 1, ours is better.
    pub fn print(&self) {
        let round = |x: f64| (x * 1e4).round() / 1e4;
        let ratio = self.theirs.filter(|t| *t > 0.0).map(|t| round(self.ours / t));
        println!(
            "{}",
            json!({
                "suite": self.suite, "case": self.case, "size": self.size,
                "ours": round(self.ours), "unit": self.unit,
                "peer": self.peer, "theirs": self.theirs.map(round), "ratio": ratio, "target": self.target,
            })
        );
    }
}

/// The median time of `rounds` runs, milliseconds. What `prepare` makes is not in the time, nor is its dropping.
pub fn median_ms<T, U>(
    rounds: usize,
    mut prepare: impl FnMut(usize) -> Result<T, String>,
    mut run: impl FnMut(&mut T) -> Result<U, String>,
) -> Result<f64, String> {
    let mut times: Vec<Duration> = Vec::with_capacity(rounds);
    for round in 0..rounds {
        let mut state = prepare(round)?;
        let start = Instant::now();
        let result = run(&mut state)?;
        times.push(start.elapsed());
        drop(result);
    }
    times.sort();
    Ok(times.get(rounds / 2).map_or(f64::NAN, |t| t.as_secs_f64() * 1e3))
}
