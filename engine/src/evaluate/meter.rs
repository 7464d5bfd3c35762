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
}

impl Meter<'_> {
    pub fn show(&self, node: &str, weight: f64, fraction: f64) {
        let (Some(tell), Ok(mut state)) = (self.tell, self.state.lock()) else { return };
        let now = Instant::now();
        if state.last.is_some_and(|t| now - t < Duration::from_millis(33)) {
            return;
        }
        let fraction = ((state.done + weight * fraction) / state.total.max(1.0)).min(1.0).max(state.shown);
        (state.shown, state.last) = (fraction, Some(now));
        drop(state);
        tell(&Progress { fraction, node: node.into() });
    }

    pub fn finish(&self, weight: f64) {
        if self.tell.is_some()
            && let Ok(mut state) = self.state.lock()
        {
            state.done += weight;
        }
    }
}
