//! Results: outputs read in place, diagnostics, what happened to each node.

use crate::error::{Failure, guard, guard_or, tenon_error};
use crate::handle;
use crate::preview::Drawn;
use crate::read;
use crate::text::{self, tenon_text};
use ::tenon_engine::{Json, Report, Session, Severity, Tree, nearest};
use std::collections::BTreeMap;
use std::ffi::c_char;
use std::sync::OnceLock;
use tenon_plugin::CTree;
use tenon_plugin::abi::value::{
    TENON_BAD_ARGUMENT, TENON_CANCELLED, TENON_ERROR, TENON_FAILED, TENON_NOTE, TENON_OK, TENON_WARNING,
    tenon_severity, tenon_status, tenon_str, tenon_tree,
};
use tenon_plugin::value::Branch;

/// What an evaluation came to. Free it with `tenon_result_free`; what was read from it is good until then, also when the
/// graph and the engine are gone.
pub struct tenon_result {
    _opaque: [u8; 0],
}

/// What a `tenon_result` stands for.
pub struct Evaluated {
    outputs: BTreeMap<String, Output>,
    report: Report,
}

/// An output, and the C structs over it once somebody asked for them.
pub(crate) struct Output {
    // Before the tree that they point into, so that they are dropped first.
    view: OnceLock<View>,
    pub(crate) preview: OnceLock<Drawn>,
    /// `node.port`.
    pub(crate) source: String,
    pub(crate) tree: Tree,
}

struct View {
    c: CTree<'static>,
    // Not a boxed slice: one that moves takes the rights of pointers into it along.
    _branches: Vec<Branch<'static>>,
}

impl Output {
    fn view(&self) -> tenon_tree {
        let view = self.view.get_or_init(|| {
            let borrowed = tenon_nodes::exchange::branches(&self.tree);
            // SAFETY: what is borrowed lies in the tree's shared allocations or, as a lone number does, in the tree itself.
            // Neither changes nor moves: results stand behind an `Arc` before anybody can ask for a view, and the tree is
            // kept beside the view until the view is gone.
            let branches: Vec<Branch<'static>> = unsafe { std::mem::transmute::<Vec<Branch<'_>>, _>(borrowed) };
            // SAFETY: the branches are in an allocation of their own, which does not move with the vector and is kept
            // beside the view.
            let slice: &'static [Branch<'static>] =
                unsafe { std::slice::from_raw_parts(branches.as_ptr(), branches.len()) };
            View { c: CTree::new(slice), _branches: branches }
        });
        view.c.get()
    }
}

impl Evaluated {
    pub(crate) fn new(session: &Session, asked: &[&str], report: Report) -> Self {
        let names: Vec<String> = if asked.is_empty() {
            session.document().outputs.keys().cloned().collect()
        } else {
            asked.iter().map(|n| (*n).to_owned()).collect()
        };
        let outputs = names
            .into_iter()
            .filter(|_| !report.cancelled)
            .filter_map(|name| Some((session.value(&name)?, name)))
            .map(|(tree, name)| {
                let source = session.document().outputs.get(&name).map_or_else(|| name.clone(), |o| o.port.clone());
                (name, Output { view: OnceLock::new(), preview: OnceLock::new(), source, tree })
            })
            .collect();
        Self { outputs, report }
    }

    /// Of an evaluation that was cancelled before it began.
    pub(crate) fn cancelled() -> Self {
        Self { outputs: BTreeMap::new(), report: Report { cancelled: true, ..Report::default() } }
    }

    pub(crate) fn status(&self) -> tenon_status {
        match (self.report.cancelled, self.report.has_errors()) {
            (true, _) => TENON_CANCELLED,
            (false, true) => TENON_FAILED,
            (false, false) => TENON_OK,
        }
    }

    pub(crate) fn output(&self, name: &str) -> Result<&Output, Failure> {
        self.outputs.get(name).ok_or_else(|| {
            let near = nearest(name, self.outputs.keys().map(String::as_str));
            let hint = near.map(|n| format!("; did you mean \"{n}\"?")).unwrap_or_default();
            Failure::argument(format!("the result has no output \"{name}\": it was not asked for, or it failed{hint}"))
        })
    }
}

/// Frees a result and with it everything that was read from it. NULL and results that were freed before do nothing.
/// [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_result_free(result: *mut tenon_result) {
    guard_or((), || {
        handle::free(result);
        Ok(())
    });
}

/// `TENON_OK`, `TENON_FAILED` if a diagnostic is an error, or `TENON_CANCELLED`; `TENON_BAD_ARGUMENT` for what is no result.
/// [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_result_status(result: *const tenon_result) -> tenon_status {
    guard_or(TENON_BAD_ARGUMENT, || Ok(handle::result(result)?.status()))
}

/// Fills `out` with an output that was asked for. Nothing is copied; the arrays are read-only and good until the result
/// is freed. Set `out->size` before. Fails if there is no such output. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_result_output(
    result: *const tenon_result,
    name: *const c_char,
    out: *mut tenon_tree,
) -> *mut tenon_error {
    guard(|| {
        let result = handle::result(result)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        let tree = result.output(name)?.view();
        // SAFETY: the header asks for a struct whose size is set.
        unsafe { read::fill(out, tree, "out") }
    })
}

/// An output as JSON, for types that do not cross as C structs and for looking at values. Fails if there is no such output
/// or it was not asked for. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_result_json(
    result: *const tenon_result,
    name: *const c_char,
    out: *mut *mut tenon_text,
) -> *mut tenon_error {
    guard(|| {
        let out = read::place(out, "out")?;
        let result = handle::result(result)?;
        // SAFETY: the header asks for a NUL-terminated string.
        let name = unsafe { read::text(name, "name")? };
        let json: Json = result.output(name)?.tree.to_json();
        // SAFETY: not NULL and aligned; the caller vouches that a pointer can be written there.
        unsafe { out.write(text::give(json.to_string())) };
        Ok(())
    })
}

/// What is wrong, and where. Texts are good until the result is freed; what is not known is empty.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_diagnostic {
    /// Bytes of this struct; set it before the call.
    pub size: u32,
    /// `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
    pub severity: tenon_severity,
    /// A stable name in kebab-case.
    pub code: tenon_str,
    /// A sentence for people.
    pub message: tenon_str,
    /// What would fix it.
    pub hint: tenon_str,
    /// Node.
    pub node: tenon_str,
    /// Port of the node.
    pub port: tenon_str,
    /// Index of the item, or UINT64_MAX.
    pub item: u64,
}

// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_diagnostic {}
// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_tree {}

/// Number of diagnostics; 0 for a result that is no result. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_result_diagnostic_count(result: *const tenon_result) -> u64 {
    guard_or(0, || Ok(handle::result(result)?.report.diagnostics.len() as u64))
}

/// Fills `out` with diagnostic `index`. Set `out->size` before. Fails if there are not so many. [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_result_diagnostic(
    result: *const tenon_result,
    index: u64,
    out: *mut tenon_diagnostic,
) -> *mut tenon_error {
    guard(|| {
        let result = handle::result(result)?;
        let all = &result.report.diagnostics;
        let found = usize::try_from(index).ok().and_then(|i| all.get(i));
        let d = found.ok_or_else(|| Failure::argument(format!("diagnostic {index} of {}", all.len())))?;
        let text = |t: &Option<Box<str>>| tenon_str::of(t.as_deref().unwrap_or_default());
        let severity = match d.severity {
            Severity::Note => TENON_NOTE,
            Severity::Warning => TENON_WARNING,
            Severity::Error => TENON_ERROR,
        };
        let value = tenon_diagnostic {
            size: 0,
            severity,
            code: tenon_str::of(&d.code),
            message: tenon_str::of(&d.message),
            hint: text(&d.hint),
            node: text(&d.node),
            port: text(&d.port),
            item: d.item.map_or(u64::MAX, |i| i as u64),
        };
        // SAFETY: the header asks for a struct whose size is set.
        unsafe { read::fill(out, value, "out") }
    })
}

/// One node in an evaluation. Texts are good until the result is freed.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_node_report {
    /// Bytes of this struct; set it before the call.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// What happened to it: "executed", "cut-off" (its inputs are the same as before), "memo" (its result was
    /// remembered), "blocked", "failed", "frozen", "disabled"; later versions may add words.
    pub happened: tenon_str,
    /// Its id.
    pub node: tenon_str,
    /// Its node type.
    pub type_name: tenon_str,
    /// Time that it ran, ns.
    pub nanoseconds: u64,
    /// Bytes of its outputs.
    pub bytes: u64,
}

// SAFETY: plain data, size first.
unsafe impl read::Sized32 for tenon_node_report {}

/// Number of nodes that were looked at. [any thread]
#[unsafe(no_mangle)]
pub extern "C" fn tenon_result_node_count(result: *const tenon_result) -> u64 {
    guard_or(0, || Ok(handle::result(result)?.report.nodes.len() as u64))
}

/// Fills `out` with node `index`, in order of evaluation. Set `out->size` before. Fails if there are not so many.
/// [any thread]
#[unsafe(no_mangle)]
pub unsafe extern "C" fn tenon_result_node(
    result: *const tenon_result,
    index: u64,
    out: *mut tenon_node_report,
) -> *mut tenon_error {
    guard(|| {
        let result = handle::result(result)?;
        let all = &result.report.nodes;
        let found = usize::try_from(index).ok().and_then(|i| all.iter().nth(i));
        let n = found.ok_or_else(|| Failure::argument(format!("node {index} of {}", all.len())))?;
        let value = tenon_node_report {
            size: 0,
            flags: 0,
            happened: tenon_str::of(n.happened.as_str()),
            node: tenon_str::of(n.id),
            type_name: tenon_str::of(n.type_name),
            nanoseconds: u64::try_from(n.time.as_nanos()).unwrap_or(u64::MAX),
            bytes: n.bytes as u64,
        };
        // SAFETY: the header asks for a struct whose size is set.
        unsafe { read::fill(out, value, "out") }
    })
}
