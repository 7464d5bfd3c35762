//! The short way for cheap nodes. One that costs less than looking after it (arithmetic on single numbers) runs where it is
//! found: no job, no memo, no clock of its own.

use super::commit::{Evaluation, SMALL};
use super::gather;
use super::matching::Arg;
use super::meter::Meter;
use super::report::{Event, Happened, Row, Seen};
use super::session::Session;
use super::simple::{SIMPLE_PORTS, Simple, run_args, run_simple};
use super::state::{NodeRun, Status, Value};
use crate::call::Monitor;
use crate::document::model::NodeState;
use crate::plan::Slot;
use crate::registry::NodeType;
use crate::value::Tree;
use smallvec::SmallVec;
use std::sync::Arc;
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::time::{Duration, Instant};

/// So many cheap nodes share one reading of the clock.
const BATCH: usize = 64;

/// What comes to a node that takes nothing but single numbers.
type Numbers<'a> = SmallVec<[Arg<'a>; SIMPLE_PORTS]>;

impl Session {
    /// Deals with a cheap node to which nothing special happens; false if it has to go the long way. What it decides depends
    /// on types and data alone, so the log is the same however long anything takes.
    pub(super) fn run_quick(
        &mut self,
        n: u32,
        e: &mut Evaluation,
        cancel: &Arc<AtomicBool>,
        meter: &Meter<'_>,
    ) -> bool {
        let i = n as usize;
        if !self.may_be_quick(i) {
            return false;
        }
        let made = AtomicU64::new(0);
        let monitor = Monitor { cancel, report: None, made: &made, span: (0.0, 1.0) };
        let Some((key, simple)) = self.try_quick(i, monitor) else { return false };
        let Some(simple) = simple else {
            self.nodes[i].dirty = false;
            self.note(n, Happened::CutOff, Duration::ZERO, e);
            self.events.push(Event::CutOff(n));
            return true;
        };
        if cancel.load(Ordering::Relaxed) {
            return true;
        }
        let outcome = match simple {
            Simple::Number(v) => {
                self.put_number(n, key, v, e);
                if e.reports.len() - e.settled >= BATCH {
                    self.settle(e, meter);
                }
                return true;
            }
            Simple::Outcome(outcome) => *outcome,
        };
        let small = outcome.outputs.iter().map(Tree::bytes).sum::<usize>() <= SMALL;
        if outcome.failed || outcome.cancelled || !outcome.reports.is_empty() || !small {
            self.settle(e, meter);
            self.commit(n, key, outcome, Duration::ZERO, e);
            return true;
        }
        self.events.push(Event::Executed(n));
        let mut outputs = outcome.outputs.into_iter();
        if !self.publish_each(n, NodeRun::new(key, Status::Good), None, |_| outputs.next().into(), e) {
            self.events.push(Event::CutOff(n));
        }
        self.note(n, Happened::Executed, Duration::ZERO, e);
        if e.reports.len() - e.settled >= BATCH {
            self.settle(e, meter);
        }
        true
    }

    /// The key of what comes to a node, and what it makes of it, or nothing if that is what it ran with last. `None`: it has
    /// to go the long way.
    #[inline]
    fn try_quick(&self, i: usize, monitor: Monitor<'_>) -> Option<(u128, Option<Simple>)> {
        let t = self.plan.node_type(i)?;
        let run = &self.nodes[i];
        let has_run = |key: u128| run.key == key.into() && run.present && run.status == Status::Good;
        let mut args = SmallVec::new();
        if let Some(key) = self.numbers(i, t, &mut args) {
            return Some((key, (!has_run(key)).then(|| run_args(t, &args, None, monitor))));
        }
        if !self.is_small(i, t) {
            return None;
        }
        let key = gather::key(&self.plan, i, &self.values, &[]);
        if has_run(key) {
            return Some((key, None));
        }
        let simple = run_simple(t, gather::simple(&self.plan, t, i, &self.values), monitor)?;
        Some((key, Some(simple)))
    }

    /// Gathers what comes to a node if it is nothing but single numbers that its ports accept; gives the key that they make.
    #[inline]
    fn numbers<'a>(&'a self, i: usize, t: &'a NodeType, args: &mut Numbers<'a>) -> Option<u128> {
        let bounds = t.numbers.as_deref()?;
        let mut key = gather::key_of(t, self.plan.nodes[i].matching);
        for (slot, (p, (min, max))) in self.plan.node_slots(i).iter().zip(bounds.iter().enumerate()) {
            let tree = match slot {
                Slot::Default => t.defaults.get(p)?.as_ref()?,
                Slot::Literal(l) => self.plan.literals.get(*l as usize)?,
                // What is in memory is good.
                Slot::Wire(source) => self.values[*source as usize].tree()?,
                Slot::Missing | Slot::Wires(_) => return None,
            };
            let (column, v) = tree.number_column()?;
            if !(v >= *min && v <= *max) {
                return None;
            }
            key.feed_number(v);
            args.push(Arg::One(column));
        }
        Some(key.finish())
    }

    /// As [`Session::publish`] and [`Session::note`] with a number.
    fn put_number(&mut self, n: u32, key: u128, v: f64, e: &mut Evaluation) {
        let node_type = self.plan.nodes[n as usize].node_type;
        self.events.push(Event::Executed(n));
        if !self.publish_each(n, NodeRun::new(key, Status::Good), None, |_| Value::number(v), e) {
            self.events.push(Event::CutOff(n));
        }
        let (bytes, digest) = (Value::number(v).bytes(), Seen::Number(v));
        e.reports.push(Row { node: n, node_type, time: 0.0, happened: Happened::Executed, bytes, digest });
    }

    /// A cheap node that nothing keeps from running.
    #[inline]
    fn may_be_quick(&self, i: usize) -> bool {
        let node = &self.plan.nodes[i];
        let on = node.state == NodeState::On && !node.has_files && self.plan.is_sound(i);
        on && self.plan.node_type(i).is_some_and(|t| t.cheap) && !self.remembered[node.node_type as usize]
    }

    /// Everything that a node needs is there, and little of it.
    fn is_small(&self, i: usize, t: &NodeType) -> bool {
        let mut bytes = 0;
        for (slot, port) in self.plan.node_slots(i).iter().zip(&t.inputs) {
            match slot {
                Slot::Missing if !port.optional => return false,
                Slot::Missing | Slot::Default => {}
                Slot::Literal(l) => bytes += self.plan.literals[*l as usize].bytes(),
                Slot::Wire(_) | Slot::Wires(_) => {
                    for source in self.plan.wires(slot).0 {
                        let run = &self.nodes[self.plan.output_node[*source as usize] as usize];
                        let Some(tree) = self.values[*source as usize].tree() else { return false };
                        bytes += tree.bytes();
                        if run.status != Status::Good || !run.present || bytes > SMALL {
                            return false;
                        }
                    }
                }
            }
        }
        bytes <= SMALL
    }

    /// An evaluation that is no longer small is likely to become as large as the last one.
    fn make_room(&mut self, e: &mut Evaluation) {
        let more = self.last_size.saturating_sub(e.reports.len());
        if e.reports.len() >= BATCH && e.reports.capacity() < self.last_size {
            e.reports.reserve_exact(more);
            e.undo.reserve_exact(more);
            e.undo_runs.reserve_exact(more);
            e.undo_outputs.reserve_exact(more);
            self.events.reserve(more);
        }
    }

    /// Shares the time since the clock was last read among the cheap nodes that ran since.
    pub(super) fn settle(&mut self, e: &mut Evaluation, meter: &Meter<'_>) {
        let from = std::mem::replace(&mut e.settled, e.reports.len());
        let ran = |row: &&mut Row| row.happened == Happened::Executed;
        let count = e.reports[from..].iter_mut().filter(ran).count();
        if count == 0 {
            return;
        }
        self.make_room(e);
        let now = Instant::now();
        let time = (now - std::mem::replace(&mut e.clock, now)) / count as u32;
        let time = time.as_nanos() as f64;
        for row in e.reports[from..].iter_mut().filter(ran) {
            row.time = time as f32;
            if meter.tell.is_some() {
                meter.finish(self.weight(row.node as usize));
            }
            self.learn(row.node_type, time);
        }
        if let Some(last) = e.reports.last() {
            meter.show(&self.plan.ids[last.node as usize], 0.0, 0.0);
        }
    }
}

#[cfg(test)]
mod tests {
    use crate::*;
    use std::sync::Arc;
    use std::time::Duration;

    #[test]
    fn cheap_nodes_leave_the_time_of_others_alone() {
        let port = || Port::item::<f64>("x").default(1.0);
        let pass = |c: &mut Call<'_>| {
            let x = c.number("x")?;
            c.set("x", x);
            Ok(())
        };
        let nap = Duration::from_millis(5);
        let slow = move |c: &mut Call<'_>| {
            std::thread::sleep(nap);
            pass(c)
        };
        let mut registry = Registry::new();
        let cheap = NodeType::new("cheap", 1).cheap().input(port()).output(Port::item::<f64>("x")).run(pass);
        let slow = NodeType::new("slow", 1).slow().input(port()).output(Port::item::<f64>("x")).run(slow);
        registry.register(cheap).and_then(|()| registry.register(slow)).unwrap();
        let mut document = Document::new();
        document.insert("a", Node::new("cheap")).unwrap();
        document.insert("b", Node::new("slow").wire("x", "a.x")).unwrap();
        for (id, from) in [("c", "b.x"), ("d", "c.x"), ("e", "d.x")] {
            document.insert(id, Node::new("cheap").wire("x", from)).unwrap();
        }
        let mut session = Session::new(Arc::new(registry), document, Options::default());
        let report = session.evaluate(&["e.x"], &Control::default());
        let time = |id: &str| report.node(id).map(|n| n.time).unwrap();
        assert!(time("b") >= nap, "{:?}", time("b"));
        assert!(["a", "c", "d", "e"].iter().all(|id| time(id) > Duration::ZERO));
    }
}
