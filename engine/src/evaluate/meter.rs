//! Progress: the fraction of the expected cost that is done.

use super::report::Progress;
use std::sync::Mutex;
use std::time::{Duration, Instant};

/// Fraction done by expected cost, told at most 30 times a second.
pub(crate) struct Meter<'a> {
    pub tell: Option<&'a (dyn Fn(&Progress) + Sync)>,
    pub state: Mutex<MeterState>,
}

pub(crate) struct MeterState {
    pub total: f64,
    pub done: f64,
    pub shown: f64,
    pub last: Option<Instant>,
    /// When the work ahead was last counted, and how long that took.
    pub counted: Option<(Instant, Duration)>,
}

/// Progress is told this often at most.
const OFTEN: Duration = Duration::from_millis(33);

impl Meter<'_> {
    pub fn show(&self, node: &str, weight: f64, fraction: f64) {
        let (Some(tell), Ok(mut state)) = (self.tell, self.state.lock()) else { return };
        let now = Instant::now();
        if state.last.is_some_and(|t| now - t < OFTEN) {
            return;
        }
        let fraction = ((state.done + weight * fraction) / state.total.max(1.0)).min(1.0).max(state.shown);
        (state.shown, state.last) = (fraction, Some(now));
        drop(state);
        tell(&Progress { fraction, node: node.into() });
    }

    /// Counts the work ahead anew: of what was expected, much may have been remembered or cut off. Not every time, so that
    /// counting takes no time worth speaking of.
    pub fn recount(&self, expected: impl FnOnce() -> f64) {
        let (true, Ok(mut state)) = (self.tell.is_some(), self.state.lock()) else { return };
        let start = Instant::now();
        if state.counted.is_some_and(|(at, took)| start - at < OFTEN.max(20 * took)) {
            return;
        }
        state.total = state.done + expected();
        state.counted = Some((start, start.elapsed()));
    }

    pub fn finish(&self, weight: f64) {
        if self.tell.is_some()
            && let Ok(mut state) = self.state.lock()
        {
            state.done += weight;
        }
    }
}
