//! One evaluation: what the plugin is given to call back with, and where its answers go.

use super::{Body, PluginNode};
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::from_c::{Buffers, Reader, element_size, text};
use crate::sound::BadValue;
use crate::to_c::CTree;
use crate::value::Branch;
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

/// Something that a plugin said about its input.
#[derive(Clone, Debug, PartialEq, Eq)]
pub struct Message {
    /// `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
    pub severity: tenon_severity,
    /// Stable name.
    pub code: String,
    /// Sentence for people.
    pub message: String,
    /// What would fix it.
    pub hint: Option<String>,
    /// Input concerned.
    pub port: Option<String>,
    /// Item concerned.
    pub item: Option<usize>,
}

/// What the caller of a node does with what comes.
pub trait Sink {
    /// Takes the value of an output.
    ///
    /// # Errors
    /// Says why it is not accepted.
    fn set(&mut self, output: u32, value: Vec<Branch<'_>>) -> Result<(), String>;
    /// Takes an input's value as an output's.
    ///
    /// # Errors
    /// Says why it cannot be.
    fn forward(&mut self, output: u32, input: u32) -> Result<(), String>;
    /// Takes a message.
    fn tell(&mut self, message: Message);
}

/// How an evaluation hears of its host.
#[derive(Clone, Copy)]
pub struct Watch<'a> {
    /// Whether it should stop.
    pub cancelled: &'a (dyn Fn() -> bool + Sync),
    /// Takes the fraction done.
    pub progress: &'a (dyn Fn(f64) + Sync),
    /// The buffer that is refused as if there were no memory, from 0; for tests of plugins.
    pub refuse_buffer: Option<u64>,
    /// Where buffers are made, by their bytes, zeroed and aligned to 8; none: they are the host's own.
    pub room: Option<&'a dyn Fn(u64) -> Option<NonNull<u8>>>,
}

/// How an evaluation ended otherwise than well.
#[derive(Clone, Debug, PartialEq, Eq)]
pub enum EvaluateError {
    /// It stopped because it was asked to.
    Cancelled,
    /// It failed; messages say why.
    Failed,
    /// The plugin breaks the contract.
    Fault(String),
    /// The plugin's own process ended, or had to be ended.
    Died(String),
}

/// One evaluation, as the callbacks see it.
struct Running<'a> {
    sink: &'a mut dyn Sink,
    watch: Watch<'a>,
    buffers: Buffers,
    /// Buffers asked for so far.
    asked: u64,
    thread: ThreadId,
    fault: Option<String>,
}

/// Where a `tenon_call` leads. Slots are used again and never freed, so that a plugin that calls back after its
/// evaluation meets a closed door and not freed memory.
struct Slot {
    call: tenon_call,
    running: Mutex<*mut Running<'static>>,
}

// SAFETY: the pointer is only followed under the lock, by the thread that put it there, or for `cancelled`.
unsafe impl Sync for Slot {}
// SAFETY: see above.
unsafe impl Send for Slot {}

static LATE: AtomicU64 = AtomicU64::new(0);

/// Number of calls that plugins made after their evaluation had ended; each was refused.
#[must_use]
pub fn late_calls() -> u64 {
    LATE.load(Ordering::Relaxed)
}

static FREE: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

impl Slot {
    fn leak() -> &'static Self {
        let call = tenon_call {
            size: size_of::<tenon_call>() as u32,
            flags: 0,
            host: std::ptr::null_mut(),
            cancelled,
            progress,
            tell,
            buffer,
            set,
            forward,
        };
        let slot: *mut Self = Box::leak(Box::new(Self { call, running: Mutex::new(std::ptr::null_mut()) }));
        // SAFETY: it was just leaked, and nobody else has it yet.
        unsafe {
            (*slot).call.host = slot.cast();
            &*slot
        }
    }

    fn with<R>(&self, otherwise: R, same_thread: bool, f: impl FnOnce(&mut Running<'static>) -> R) -> R {
        let running = self.running.lock().unwrap_or_else(PoisonError::into_inner);
        let pointer = *running;
        if pointer.is_null() {
            LATE.fetch_add(1, Ordering::Relaxed);
            return otherwise;
        }
        // SAFETY: it is put here for the time of an evaluation and taken away under the same lock.
        let running = unsafe { &mut *pointer };
        if same_thread && running.thread != std::thread::current().id() {
            let fault = "it calls back from a thread that evaluate does not run on";
            running.fault.get_or_insert_with(|| fault.to_owned());
            return otherwise;
        }
        f(running)
    }
}

/// The slot of a call; `None` for NULL.
unsafe fn slot<'a>(call: *const tenon_call) -> Option<&'a Slot> {
    if call.is_null() || !call.is_aligned() {
        return None;
    }
    // SAFETY: a call that the host gave; its slot is never freed.
    unsafe { (*call).host.cast::<Slot>().as_ref() }
}

unsafe extern "C" fn cancelled(call: *const tenon_call) -> i32 {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return 1 };
    slot.with(1, false, |r| i32::from((r.watch.cancelled)()))
}

unsafe extern "C" fn progress(call: *const tenon_call, fraction: f64) {
    // SAFETY: the plugin hands back what it was given.
    if let Some(slot) = unsafe { slot(call) }
        && fraction.is_finite()
    {
        slot.with((), true, |r| (r.watch.progress)(fraction.clamp(0.0, 1.0)));
    }
}

unsafe extern "C" fn tell(call: *const tenon_call, message: *const tenon_message) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return TENON_BAD_ARGUMENT };
    slot.with(TENON_BAD_ARGUMENT, true, |r| {
        // SAFETY: the contract: NULL or a message.
        match unsafe { read_message(message) } {
            Ok(message) => {
                r.sink.tell(message);
                TENON_OK
            }
            Err(why) => {
                r.fault.get_or_insert_with(|| format!("tell: {why}"));
                TENON_BAD_ARGUMENT
            }
        }
    })
}

/// # Safety
/// It is NULL or a message as the contract says.
unsafe fn read_message(message: *const tenon_message) -> Result<Message, BadValue> {
    if message.is_null() {
        return Err(BadValue::Null("message"));
    }
    if !message.is_aligned() {
        return Err(BadValue::Misaligned("message"));
    }
    // SAFETY: the size comes first.
    let size = unsafe { (*message).size };
    if (size as usize) < size_of::<tenon_message>() {
        return Err(BadValue::Length {
            what: "message.size",
            found: size.into(),
            hint: "; set it to sizeof(tenon_message)",
        });
    }
    // SAFETY: it is as large as this version of the struct.
    let m = unsafe { *message };
    // SAFETY: as the caller vouches.
    let [code, words, hint, port] = unsafe {
        [
            text(m.code, "message.code")?,
            text(m.message, "message.message")?,
            text(m.hint, "message.hint")?,
            text(m.port, "message.port")?,
        ]
    };
    let some = |t: &str| (!t.is_empty()).then(|| t.to_owned());
    Ok(Message {
        severity: m.severity.min(TENON_ERROR),
        code: if code.is_empty() { "plugin" } else { code }.to_owned(),
        message: words.to_owned(),
        hint: some(hint),
        port: some(port),
        item: usize::try_from(m.item).ok().filter(|i| *i != usize::MAX),
    })
}

unsafe extern "C" fn buffer(call: *const tenon_call, element: tenon_element, count: u64) -> *mut c_void {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return std::ptr::null_mut() };
    slot.with(std::ptr::null_mut(), true, |r| {
        r.asked += 1;
        match r.watch.room {
            _ if r.watch.refuse_buffer == Some(r.asked - 1) => std::ptr::null_mut(),
            Some(room) => {
                let bytes = element_size(element).and_then(|size| size.checked_mul(count.max(1)));
                bytes.and_then(room).map_or(std::ptr::null_mut(), |place| place.as_ptr().cast())
            }
            None => r.buffers.make(element, count),
        }
    })
}

unsafe extern "C" fn set(call: *const tenon_call, output: u32, value: *const tenon_tree) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return TENON_BAD_ARGUMENT };
    slot.with(TENON_BAD_ARGUMENT, true, |r| {
        let mut reader = Reader { buffers: &mut r.buffers };
        // SAFETY: the contract: NULL or a value whose pointers are good until we return.
        let read = unsafe { reader.tree(value) }.map_err(|e| e.to_string());
        match read.and_then(|branches| r.sink.set(output, branches)) {
            Ok(()) => TENON_OK,
            Err(why) => {
                r.fault.get_or_insert_with(|| format!("output {output}: {why}"));
                TENON_BAD_TYPE
            }
        }
    })
}

unsafe extern "C" fn forward(call: *const tenon_call, output: u32, input: u32) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return TENON_BAD_ARGUMENT };
    slot.with(TENON_BAD_ARGUMENT, true, |r| match r.sink.forward(output, input) {
        Ok(()) => TENON_OK,
        Err(why) => {
            r.fault.get_or_insert_with(|| format!("output {output}: {why}"));
            TENON_BAD_ARGUMENT
        }
    })
}

impl PluginNode {
    /// Evaluates it on this thread. O(inputs) besides what the plugin does; large arrays are not copied.
    ///
    /// # Errors
    /// If it was cancelled, failed, or breaks the contract.
    pub fn evaluate(
        &self,
        inputs: &[Vec<Branch<'_>>],
        watch: Watch<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), EvaluateError> {
        let (evaluate, data) = match &self.body {
            Body::Here { evaluate, data } => (*evaluate, *data),
            Body::Apart(processes, index) => return processes.evaluate(*index, inputs, watch, sink),
        };
        let views: Vec<CTree<'_>> = inputs.iter().map(|branches| CTree::new(branches)).collect();
        let trees: Vec<tenon_tree> = views.iter().map(CTree::get).collect();
        let mut running = Running {
            sink,
            watch,
            buffers: Buffers::default(),
            asked: 0,
            thread: std::thread::current().id(),
            fault: None,
        };
        let slot = FREE.lock().unwrap_or_else(PoisonError::into_inner).pop();
        let slot = slot.unwrap_or_else(Slot::leak);
        *slot.running.lock().unwrap_or_else(PoisonError::into_inner) = (&raw mut running).cast();
        // SAFETY: the plugin was loaded and never goes; inputs and call live through the call; it does not unwind, says
        // the contract.
        let status = unsafe { evaluate(data, &raw const slot.call, trees.as_ptr(), trees.len() as u32) };
        *slot.running.lock().unwrap_or_else(PoisonError::into_inner) = std::ptr::null_mut();
        FREE.lock().unwrap_or_else(PoisonError::into_inner).push(slot);
        match (status, running.fault) {
            (TENON_CANCELLED, _) if (watch.cancelled)() => Err(EvaluateError::Cancelled),
            (_, Some(fault)) => Err(EvaluateError::Fault(fault)),
            (TENON_OK, None) => Ok(()),
            (TENON_CANCELLED, None) => Err(EvaluateError::Fault("it gave up although nobody asked it to".into())),
            (TENON_FAILED, None) => Err(EvaluateError::Failed),
            (other, None) => Err(EvaluateError::Fault(format!("evaluate gave the status {other}"))),
        }
    }
}
