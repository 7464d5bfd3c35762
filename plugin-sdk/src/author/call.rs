//! One run of a node made here: its inputs by name, places for its outputs, its failure.

use super::Element;
use super::describe::{Migrate, Run};
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::buffers::Buffers;
use crate::from_c::{Reader, text};
use crate::to_c::CTree;
use crate::value::{Branch, Curve, Features, Items, Mesh, Panels, Table};
use std::any::Any;
use std::borrow::Cow;
use std::ffi::c_void;
use std::panic::{AssertUnwindSafe, catch_unwind};

/// Why a node fails: what, how far off, and what would work.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Fail {
    code: Cow<'static, str>,
    message: String,
    hint: String,
    port: String,
    item: u64,
    cancelled: bool,
}

impl Fail {
    /// `code` in kebab-case, `message` a sentence for people.
    #[must_use]
    pub fn new(code: impl Into<Cow<'static, str>>, message: impl Into<String>) -> Self {
        let (code, message) = (code.into(), message.into());
        Self { code, message, hint: String::new(), port: String::new(), item: u64::MAX, cancelled: false }
    }

    /// The host asked to stop.
    #[must_use]
    pub fn cancelled() -> Self {
        Self { cancelled: true, ..Self::new("cancelled", "cancelled") }
    }

    /// Says what would fix it.
    #[must_use]
    pub fn hint(mut self, hint: impl Into<String>) -> Self {
        self.hint = hint.into();
        self
    }

    /// Names the input concerned.
    #[must_use]
    pub fn port(mut self, port: impl Into<String>) -> Self {
        self.port = port.into();
        self
    }

    /// Names the item concerned: a panel, a face.
    #[must_use]
    pub fn item(mut self, item: usize) -> Self {
        self.item = item as u64;
        self
    }
}

/// What `data` leads to.
pub(super) struct Running {
    pub run: Run,
    pub migrate: Option<Migrate>,
    pub inputs: Vec<&'static str>,
    pub outputs: Vec<&'static str>,
}

/// The function of every node made here: reads the inputs, runs the plain function, catches its panics.
pub(super) unsafe extern "C" fn evaluate(
    data: *mut c_void,
    call: *const tenon_call,
    inputs: *const tenon_tree,
    count: u32,
) -> tenon_status {
    // SAFETY: the descriptor says `data` and this function together, and it is never freed.
    let Some(node) = (unsafe { data.cast::<Running>().as_ref() }) else { return TENON_BAD_ARGUMENT };
    // SAFETY: the host's call lives through this one.
    let Some(call) = (unsafe { call.as_ref() }) else { return TENON_BAD_ARGUMENT };
    if (call.size as usize) < size_of::<tenon_call>()
        || count as usize != node.inputs.len()
        || inputs.is_null() && count > 0
    {
        return TENON_BAD_ARGUMENT;
    }
    let body = || {
        let mut buffers = Buffers::default();
        let mut values = Vec::with_capacity(count as usize);
        for i in 0..count as usize {
            // SAFETY: the host gives as many trees as it says, good until we return.
            let tree = unsafe { Reader::new(&mut buffers, false).tree(inputs.add(i)) };
            values.push(tree.map_err(|e| Fail::new("host-fault", format!("input {}: {e}", node.inputs[i])))?);
        }
        let mut call = Call { raw: call, node, inputs: values };
        (node.run)(&mut call)
    };
    let fail = match catch_unwind(AssertUnwindSafe(body)) {
        Ok(Ok(())) => return TENON_OK,
        Ok(Err(fail)) if fail.cancelled => return TENON_CANCELLED,
        Ok(Err(fail)) => fail,
        Err(panic) => Fail::new("plugin-panic", format!("the plugin has a fault: {}", words(&*panic))),
    };
    tell(call, TENON_ERROR, &fail);
    TENON_FAILED
}

/// The step of every node made here that has one.
pub(super) unsafe extern "C" fn migrate(
    data: *mut c_void,
    from: u32,
    node: tenon_str,
    give: tenon_give,
    to: *mut c_void,
) -> tenon_status {
    // SAFETY: the descriptor says `data` and this function together, and it is never freed.
    let step = unsafe { data.cast::<Running>().as_ref() }.and_then(|running| running.migrate);
    let Some(step) = step else { return TENON_UNSUPPORTED };
    // SAFETY: the host's text lives through the call.
    let Ok(node) = (unsafe { text(node, "node") }) else { return TENON_BAD_ARGUMENT };
    let done = catch_unwind(|| step(from, node));
    let done = done.unwrap_or_else(|panic| Err(format!("the plugin has a fault: {}", words(&*panic))));
    let (status, told) = match done {
        Ok(text) => (TENON_OK, text),
        Err(why) => (TENON_FAILED, why),
    };
    // SAFETY: the host's function with the host's place; it copies the text.
    unsafe { give(to, tenon_str::of(&told)) };
    status
}

fn words(panic: &(dyn Any + Send)) -> &str {
    let text = panic.downcast_ref::<String>().map(String::as_str);
    text.or_else(|| panic.downcast_ref::<&str>().copied()).unwrap_or("a panic without words")
}

fn tell(call: &tenon_call, severity: tenon_severity, fail: &Fail) {
    let message = tenon_message {
        size: size_of::<tenon_message>() as u32,
        severity,
        code: tenon_str::of(&fail.code),
        message: tenon_str::of(&fail.message),
        hint: tenon_str::of(&fail.hint),
        port: tenon_str::of(&fail.port),
        item: fail.item,
    };
    // SAFETY: the host's function, with the host's call and a message that lives through it.
    unsafe { (call.tell)(call, &raw const message) };
}

/// One run of a node: its inputs by name, places for its outputs, progress and cancellation.
pub struct Call<'a> {
    raw: &'a tenon_call,
    node: &'a Running,
    inputs: Vec<Vec<Branch<'a>>>,
}

macro_rules! items {
    ($($name:ident $variant:ident $type:ty, $what:literal;)*) => { $(
        #[doc = concat!("The ", $what, " at `port`.")]
        ///
        /// # Errors
        /// If it has no value, or the node declared another type.
        pub fn $name(&self, port: &str) -> Result<$type, Fail> {
            match self.items(port)? {
                Items::$variant(v) => v.first().cloned().ok_or_else(|| missing(port)),
                _ => Err(other(port, $what)),
            }
        }
    )* };
}

fn missing(port: &str) -> Fail {
    Fail::new("missing-input", format!("\"{port}\" has no value")).port(port)
}

fn other(port: &str, what: &str) -> Fail {
    Fail::new("plugin-fault", format!("it asks \"{port}\" for a {what}, but declared something else")).port(port)
}

impl<'a> Call<'a> {
    /// The branches at an input; none if it is optional and has no value.
    ///
    /// # Errors
    /// If the node has no such input.
    pub fn tree(&self, port: &str) -> Result<&[Branch<'a>], Fail> {
        let index = self.node.inputs.iter().position(|name| *name == port);
        let found = index.and_then(|i| self.inputs.get(i)).map(Vec::as_slice);
        found.ok_or_else(|| Fail::new("plugin-fault", format!("it has no input \"{port}\"")))
    }

    /// The items of the first branch at an input.
    ///
    /// # Errors
    /// If there is no value or no such input.
    pub fn items(&self, port: &str) -> Result<&Items<'a>, Fail> {
        self.tree(port)?.first().map(|b| &b.items).ok_or_else(|| missing(port))
    }

    items! {
        boolean Boolean bool, "truth value"; integer Integer i64, "whole number"; number Number f64, "number";
        text Text Cow<'a, str>, "text"; point Point tenon_vec3, "point"; vector Vector tenon_vec3, "vector";
        plane Plane tenon_plane, "plane"; curve Curve Curve<'a>, "curve"; mesh Mesh Mesh<'a>, "mesh";
        panels Panels Panels<'a>, "panel set"; features Features Features<'a>, "feature set";
        table Table Table<'a>, "table";
    }

    /// The edges that a fastener is to join.
    ///
    /// # Errors
    /// If the node is no fastener.
    pub fn edges(&self) -> Result<&[tenon_edge_pair], Fail> {
        match self.items("edges")? {
            Items::Edges(edges) => Ok(edges),
            _ => Err(other("edges", "list of edges")),
        }
    }

    /// Tells the fraction done, 0 to 1; an error means: pass it on, the host asked to stop.
    ///
    /// # Errors
    /// [`Fail::cancelled`].
    pub fn progress(&self, fraction: f64) -> Result<(), Fail> {
        // SAFETY: the host's function, with the host's call.
        unsafe { (self.raw.progress)(self.raw, fraction) };
        if self.cancelled() { Err(Fail::cancelled()) } else { Ok(()) }
    }

    /// Whether the host asked to stop: then give [`Fail::cancelled`]. To be asked at least every 10 ms; it costs nothing.
    #[must_use]
    pub fn cancelled(&self) -> bool {
        // SAFETY: the host's function, with the host's call.
        unsafe { (self.raw.cancelled)(self.raw) != 0 }
    }

    /// Says something worth knowing, and goes on.
    pub fn note(&self, fail: &Fail) {
        tell(self.raw, TENON_NOTE, fail);
    }

    /// Says that part of the result is missing, and goes on.
    pub fn error(&self, fail: &Fail) {
        tell(self.raw, TENON_ERROR, fail);
    }

    /// Warns, and goes on.
    pub fn warn(&self, fail: &Fail) {
        tell(self.raw, TENON_WARNING, fail);
    }

    /// Memory of the host for `count` numbers, points and so on, all zero: what is written there goes over without a copy.
    /// To be asked for in [`Call::fill`]; elsewhere it is lost, as nothing can be set while it is held.
    ///
    /// # Errors
    /// If there is no memory.
    #[expect(clippy::mut_from_ref, reason = "every call gives other memory")]
    pub fn buffer<T: Element>(&self, count: usize) -> Result<&mut [T], Fail> {
        // SAFETY: the host's function, with the host's call.
        let at = unsafe { (self.raw.buffer)(self.raw, T::ELEMENT, count as u64) }.cast::<T>();
        if at.is_null() {
            let bytes = count.saturating_mul(size_of::<T>());
            return Err(Fail::new("no-memory", format!("there is no memory for {bytes} bytes")));
        }
        // SAFETY: the host gives as many zeroed elements, which nobody else knows of. They stay until they are given over,
        // and for that this borrow has to end; or until evaluate returns, which our borrower does not outlive.
        Ok(unsafe { std::slice::from_raw_parts_mut(at, count) })
    }

    /// Sets an output to items of which arrays are [`Call::buffer`]s: those go over without a copy.
    ///
    /// ```ignore
    /// c.fill("points", |c| {
    ///     let points = c.buffer::<tenon_vec3>(1000)?;
    ///     points[0].x = 1.0;
    ///     Ok(Items::Point((&*points).into()))
    /// })
    /// ```
    ///
    /// # Errors
    /// As [`Call::set`], and what `make` gives.
    // `make` works for every lifetime, so nothing that it borrows from the call is known outside: a buffer that was given
    // over cannot be written to, or read, afterwards.
    pub fn fill(
        &mut self,
        port: &str,
        make: impl for<'b> FnOnce(&'b Self) -> Result<Items<'b>, Fail>,
    ) -> Result<(), Fail> {
        let items = make(self)?;
        self.give(port, &[Branch::root(items)])
    }

    /// Sets an output to a tree.
    ///
    /// # Errors
    /// If there is no such output, or the host refuses the value; it then says why.
    pub fn set(&mut self, port: &str, value: &[Branch<'_>]) -> Result<(), Fail> {
        self.give(port, value)
    }

    fn give(&self, port: &str, value: &[Branch<'_>]) -> Result<(), Fail> {
        let output = self.output(port)?;
        let view = CTree::new(value);
        let tree = view.get();
        // SAFETY: the host's function, with the host's call and a value that lives through it.
        let status = unsafe { (self.raw.set)(self.raw, output, &raw const tree) };
        if status == TENON_OK { Ok(()) } else { Err(Fail::new("plugin-fault", format!("\"{port}\" was refused"))) }
    }

    fn output(&self, port: &str) -> Result<u32, Fail> {
        let index = self.node.outputs.iter().position(|name| *name == port);
        index.map(|i| i as u32).ok_or_else(|| Fail::new("plugin-fault", format!("it has no output \"{port}\"")))
    }

    /// Sets an output to a list of items, which goes to `{0}`.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_items(&mut self, port: &str, items: Items<'_>) -> Result<(), Fail> {
        self.set(port, &[Branch::root(items)])
    }

    /// Sets an output to a number.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_number(&mut self, port: &str, value: f64) -> Result<(), Fail> {
        self.set_items(port, Items::Number(vec![value].into()))
    }

    /// Sets an output to a curve.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_curve(&mut self, port: &str, value: Curve<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Curve(vec![value]))
    }

    /// Sets an output to a mesh.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_mesh(&mut self, port: &str, value: Mesh<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Mesh(vec![value]))
    }

    /// Sets an output to features and hardware.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_features(&mut self, port: &str, value: Features<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Features(vec![value]))
    }

    /// Sets an output to a table.
    ///
    /// # Errors
    /// As [`Call::set`].
    pub fn set_table(&mut self, port: &str, value: Table<'_>) -> Result<(), Fail> {
        self.set_items(port, Items::Table(vec![value]))
    }

    /// Sets an output to what arrived at an input, as it is.
    ///
    /// # Errors
    /// If one of them is not there, or their types differ.
    pub fn forward(&mut self, output: &str, input: &str) -> Result<(), Fail> {
        let o = self.output(output)?;
        let index = self.node.inputs.iter().position(|name| *name == input);
        let i = index.ok_or_else(|| Fail::new("plugin-fault", format!("it has no input \"{input}\"")))?;
        // SAFETY: the host's function, with the host's call.
        let status = unsafe { (self.raw.forward)(self.raw, o, i as u32) };
        if status == TENON_OK { Ok(()) } else { Err(Fail::new("plugin-fault", format!("\"{output}\" was refused"))) }
    }
}
