//! The progress bar of long runs: on terminals only, and only once a run has turned out to be long.

use indicatif::{ProgressBar, ProgressDrawTarget, ProgressStyle};
use std::io::IsTerminal;
use std::sync::OnceLock;
use std::time::{Duration, Instant};

/// A run shorter than this shows no bar.
const PATIENCE: Duration = Duration::from_millis(300);

/// The bar's steps.
const STEPS: u64 = 1000;

/// A bar that appears after a while.
pub struct Bar {
    started: Instant,
    terminal: bool,
    bar: OnceLock<ProgressBar>,
}

impl Bar {
    /// Starts the clock. `quiet` keeps the bar away even on terminals.
    pub fn new(quiet: bool) -> Self {
        Self { started: Instant::now(), terminal: !quiet && std::io::stderr().is_terminal(), bar: OnceLock::new() }
    }

    /// Shows that `fraction` of the work is done and what is being worked on.
    pub fn show(&self, fraction: f64, what: &str) {
        if !self.terminal || self.started.elapsed() < PATIENCE {
            return;
        }
        let bar = self.bar.get_or_init(|| {
            let bar = ProgressBar::with_draw_target(Some(STEPS), ProgressDrawTarget::stderr_with_hz(30));
            // The template is a constant that the tests draw.
            if let Ok(style) = ProgressStyle::with_template(TEMPLATE) {
                bar.set_style(style);
            }
            bar
        });
        bar.set_position((fraction.clamp(0.0, 1.0) * STEPS as f64) as u64);
        if bar.message() != what {
            bar.set_message(what.to_owned());
        }
    }

    /// Takes the bar off the terminal.
    pub fn clear(&self) {
        if let Some(bar) = self.bar.get() {
            bar.finish_and_clear();
        }
    }
}

const TEMPLATE: &str = "{bar:32} {percent:>3}% {elapsed_precise} {wide_msg}";

#[cfg(test)]
mod tests {
    #[test]
    fn the_template_is_valid() {
        indicatif::ProgressStyle::with_template(super::TEMPLATE).unwrap();
    }
}
