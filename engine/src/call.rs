//! What a node sees while it runs: its inputs for one lane, places for its outputs, progress and cancellation.

use crate::diagnostic::{Fail, Severity};
use crate::evaluate::matching::{Arg, Lanes};
use crate::evaluate::output::Output;
use crate::port::{Access, Port};
use crate::registry::NodeType;
use crate::stop::Stoppable;
use crate::value::{Column, Item, Text, Tree};
use std::sync::atomic::{AtomicBool, AtomicU64, Ordering};
use std::sync::{Arc, OnceLock};

/// The most items that one run of a node makes out of few, all lanes together, and the most lanes that it runs: more would
/// fill the memory and is more likely a slip than a wish.
pub const MOST_ITEMS: usize = 50_000_000;

/// The lists of a node would not fit.
pub(crate) fn too_many(count: u64) -> Fail {
    let message = format!("the lists that this node makes would come to {count} items; the most is {MOST_ITEMS}");
    Fail::new("too-many-items", message).hint("make shorter lists, or match them by longest instead of cross")
}

/// Says how far a node is and whether it should stop; a plain copy, fit for closures that run on many threads.
#[derive(Clone, Copy)]
pub struct Monitor<'a> {
    pub(crate) cancel: &'a Arc<AtomicBool>,
    pub(crate) report: Option<&'a (dyn Fn(f64) + Sync)>,
    /// Items that all lanes of the node have said that they make.
    pub(crate) made: &'a AtomicU64,
    /// Share of the node's work that earlier lanes have done, and that this lane is.
    pub(crate) span: (f64, f64),
}

impl Monitor<'_> {
    /// Tells the fraction done, 0 to 1; false: stop and return [`Fail::cancelled`].
    #[must_use]
    pub fn progress(&self, fraction: f64) -> bool {
        if let Some(report) = self.report {
            report(self.span.0 + self.span.1 * fraction.clamp(0.0, 1.0));
        }
        !self.cancelled()
    }

    /// True if the node should stop.
    #[must_use]
    pub fn cancelled(&self) -> bool {
        self.cancel.load(Ordering::Relaxed)
    }
}

/// One run of a node: on one lane, if it has item ports.
pub struct Call<'a> {
    pub(crate) node_type: &'a NodeType,
    pub(crate) args: &'a [Arg<'a>],
    pub(crate) lanes: Lanes,
    pub(crate) lane: usize,
    /// The first lane that `outputs` has room for.
    pub(crate) first_lane: usize,
    pub(crate) outputs: &'a mut [Output],
    pub(crate) reports: &'a mut Vec<(Severity, Fail)>,
    pub(crate) monitor: Monitor<'a>,
    pub(crate) bug: Option<Fail>,
}

fn bug(node_type: &NodeType, message: String) -> Fail {
    Fail::new("node-bug", format!("the node type \"{}\" is faulty: {message}", node_type.type_name))
}

impl<'a> Call<'a> {
    #[inline]
    fn arg(&self, port: &str) -> Result<&'a Arg<'a>, Fail> {
        let index = self.node_type.input_index(port);
        index.and_then(|i| self.args.get(i)).ok_or_else(|| bug(self.node_type, format!("it has no input \"{port}\"")))
    }

    fn missing(port: &str) -> Fail {
        Fail::new("missing-input", format!("\"{port}\" has no value")).port(port)
    }

    fn wrong<T: Item>(&self, port: &str, found: &str) -> Fail {
        bug(self.node_type, format!("it asks \"{port}\" for {}, which brings {found}", T::TYPE))
    }

    /// The item at `port`.
    ///
    /// # Errors
    /// If an optional port has no value, or the node asks for another type than it declared.
    #[inline]
    pub fn item<T: Item>(&self, port: &str) -> Result<&'a T, Fail> {
        let (column, i) = match self.arg(port)? {
            Arg::One(column) => (column, 0),
            Arg::Item(column, rule) => (column, self.lanes.index(self.lane, rule)),
            Arg::Missing => return Err(Self::missing(port)),
            Arg::List(column) => return column.get(0).ok_or_else(|| Self::missing(port)),
            Arg::Tree(tree) => return tree.first().ok_or_else(|| Self::missing(port)),
        };
        column.get(i).ok_or_else(|| {
            if column.slice::<T>().is_none() { self.wrong::<T>(port, column.type_name()) } else { Self::missing(port) }
        })
    }

    /// The item at `port`, if it has a value.
    #[must_use]
    pub fn optional<T: Item>(&self, port: &str) -> Option<&'a T> {
        self.item(port).ok()
    }

    /// The number at `port`.
    ///
    /// # Errors
    /// As [`Call::item`].
    #[inline]
    pub fn number(&self, port: &str) -> Result<f64, Fail> {
        self.item::<f64>(port).copied()
    }

    /// The integer at `port`.
    ///
    /// # Errors
    /// As [`Call::item`].
    pub fn integer(&self, port: &str) -> Result<i64, Fail> {
        self.item::<i64>(port).copied()
    }

    /// The truth value at `port`.
    ///
    /// # Errors
    /// As [`Call::item`].
    pub fn boolean(&self, port: &str) -> Result<bool, Fail> {
        self.item::<bool>(port).copied()
    }

    /// The text at `port`.
    ///
    /// # Errors
    /// As [`Call::item`].
    pub fn text(&self, port: &str) -> Result<&'a str, Fail> {
        self.item::<Text>(port).map(|t| &*t.0)
    }

    /// The branch at `port` with its gaps; empty if an optional port has no value.
    ///
    /// # Errors
    /// If the node has no such port.
    pub fn column(&self, port: &str) -> Result<Column, Fail> {
        match self.arg(port)? {
            Arg::One(column) | Arg::List(column) => Ok((*column).clone()),
            Arg::Item(column, rule) => Ok(column.pick(&[Some(self.lanes.index(self.lane, rule))])),
            Arg::Missing => Ok((self.empty(port))()),
            Arg::Tree(tree) => Ok(tree.branches().first().map_or_else(|| (self.empty(port))(), |(_, c)| c.clone())),
        }
    }

    fn empty(&self, port: &str) -> fn() -> Column {
        let found = self.node_type.input_index(port).and_then(|i| self.node_type.inputs.get(i));
        found.map_or(|| Column::new::<f64>(Vec::new()), |p| p.item_type.empty)
    }

    /// The list at `port`; empty if an optional port has no value.
    ///
    /// # Errors
    /// If there is a gap in it (a failed item upstream), or the node asks for another type than it declared.
    pub fn list<T: Item>(&self, port: &str) -> Result<&'a [T], Fail> {
        let column = match self.arg(port)? {
            Arg::Missing => return Ok(&[]),
            Arg::List(column) => column,
            Arg::One(_) | Arg::Item(..) | Arg::Tree(_) => {
                return Err(bug(self.node_type, format!("\"{port}\" is not a list port")));
            }
        };
        if let Some(gap) = column.has_gaps().then(|| (0..column.len()).find(|i| !column.is_valid(*i))).flatten() {
            let message = format!("item {gap} of \"{port}\" is missing because it failed upstream");
            return Err(Fail::new("list-gap", message).port(port).item(gap));
        }
        column.slice().ok_or_else(|| self.wrong::<T>(port, column.type_name()))
    }

    /// The list at `port` with `None` at gaps; empty if an optional port has no value.
    #[must_use]
    pub fn list_gaps<T: Item>(&self, port: &str) -> Vec<Option<&'a T>> {
        match self.arg(port) {
            Ok(Arg::List(column)) => (0..column.len()).stoppable().map(|i| column.get(i)).collect(),
            _ => Vec::new(),
        }
    }

    /// The tree at `port`; empty if an optional port has no value.
    #[must_use]
    pub fn tree(&self, port: &str) -> &'a Tree {
        static NOTHING: OnceLock<Tree> = OnceLock::new();
        match self.arg(port) {
            Ok(Arg::Tree(tree)) => tree,
            _ => NOTHING.get_or_init(Tree::default),
        }
    }

    /// Content of the file whose path is at `port`.
    ///
    /// # Errors
    /// If the host could not read it.
    pub fn file(&self, port: &str) -> Result<Arc<[u8]>, Fail> {
        let Arg::Item(column, rule) = self.arg(port)? else { return Err(Self::missing(port)) };
        let index = self.lanes.index(self.lane, rule);
        match rule.files.and_then(|f| f.get(index)) {
            Some(Ok(bytes)) => Ok(bytes.clone()),
            Some(Err(why)) => {
                let path = column.get::<Text>(index).map(|t| t.0.to_string()).unwrap_or_default();
                Err(Fail::new("unreadable-file", format!("cannot read \"{path}\": {why}")).port(port))
            }
            None => Err(bug(self.node_type, format!("\"{port}\" is not a file port"))),
        }
    }

    /// Index of an output that takes items of type `T`; anything else is the node's fault and told as such.
    #[inline]
    fn output_of<T: Item>(&mut self, port: &str) -> Option<(usize, Access)> {
        let (i, declared) = self.any_output(port)?;
        if declared.item_type.id.is_some_and(|id| id != std::any::TypeId::of::<T>()) {
            let message = format!("it sets \"{port}\" to {}, but declared {}", T::TYPE, declared.item_type.name);
            self.bug = Some(bug(self.node_type, message));
            return None;
        }
        Some((i, declared.access))
    }

    #[inline]
    fn any_output(&mut self, port: &str) -> Option<(usize, &'a Port)> {
        let node_type = self.node_type;
        let found = node_type.output_index(port).and_then(|i| Some((i, node_type.outputs.get(i)?)));
        if found.is_none() {
            self.bug = Some(bug(node_type, format!("it has no output \"{port}\"")));
        }
        found
    }

    #[inline]
    fn put(&mut self, output: usize, put: impl FnOnce(&mut Output, usize)) {
        let lane = self.lane - self.first_lane;
        if let Some(output) = self.outputs.get_mut(output) {
            put(output, lane);
        }
    }

    /// Sets an output to one item; a list output to a list of one.
    #[inline]
    pub fn set<T: Item>(&mut self, port: &str, value: T) {
        match self.output_of::<T>(port) {
            Some((i, Access::Item)) => self.put(i, |o, lane| o.set_item(lane, value)),
            Some((i, _)) => self.put(i, |o, lane| o.set_list(lane, Column::single(value))),
            None => {}
        }
    }

    /// Sets an output to a list; with several lanes each lane's list becomes a branch.
    pub fn set_list<T: Item>(&mut self, port: &str, values: Vec<T>) {
        if let Some((i, _)) = self.output_of::<T>(port) {
            self.put(i, |o, lane| o.set_list(lane, Column::new(values)));
        }
    }

    /// Sets an output to a list in which `None` is a gap.
    pub fn set_list_gaps<T: Item>(&mut self, port: &str, values: Vec<Option<T>>) {
        if let Some((i, _)) = self.output_of::<T>(port) {
            self.put(i, |o, lane| o.set_list(lane, Column::with_gaps(values)));
        }
    }

    /// Sets an output to a column of any type.
    pub fn set_column(&mut self, port: &str, column: Column) {
        if let Some((i, _)) = self.any_output(port) {
            self.put(i, |o, lane| o.set_list(lane, column));
        }
    }

    /// Sets an output to a whole tree; with several lanes each lane's paths are grafted under the lane's index.
    pub fn set_tree(&mut self, port: &str, tree: Tree) {
        if let Some((i, _)) = self.any_output(port) {
            self.put(i, |o, lane| o.set_tree(lane, tree));
        }
    }

    /// To be called before a list is made that may be much longer than what came in: it will have `count` items.
    ///
    /// # Errors
    /// If that is more than [`MOST_ITEMS`], in this lane or with what other lanes of the node have asked for; then the
    /// node as a whole fails, whichever lane came last.
    pub fn reserve(&self, count: usize) -> Result<(), Fail> {
        let count = count as u64;
        let before = self.monitor.made.fetch_add(count, Ordering::Relaxed);
        if before.saturating_add(count) <= MOST_ITEMS as u64 { Ok(()) } else { Err(too_many(count)) }
    }

    fn lane_index(&self) -> Option<usize> {
        (self.lanes.count > 1).then_some(self.lane)
    }

    /// Reports an error and goes on.
    pub fn report(&mut self, fail: Fail) {
        let lane = self.lane_index();
        self.reports.push((Severity::Error, fail.item_or(lane)));
    }

    /// Reports a warning and goes on.
    pub fn warn(&mut self, fail: Fail) {
        let lane = self.lane_index();
        self.reports.push((Severity::Warning, fail.item_or(lane)));
    }

    /// Reports a note and goes on.
    pub fn note(&mut self, fail: Fail) {
        let lane = self.lane_index();
        self.reports.push((Severity::Note, fail.item_or(lane)));
    }

    /// Tells the fraction done, 0 to 1; false: stop and return [`Fail::cancelled`].
    #[must_use]
    pub fn progress(&self, fraction: f64) -> bool {
        self.monitor.progress(fraction)
    }

    /// True if the node should stop.
    #[must_use]
    pub fn cancelled(&self) -> bool {
        self.monitor.cancelled()
    }

    /// Progress and cancellation as a copy that closures can hold.
    #[must_use]
    pub fn monitor(&self) -> Monitor<'a> {
        self.monitor
    }
}
