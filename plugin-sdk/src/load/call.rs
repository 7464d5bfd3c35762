//! One evaluation: what the plugin is given to call back with, and where its answers go.

use super::{Body, PluginNode};
use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::from_c::{Buffers, Reader, element_size, text};
use crate::sound::BadValue;
use crate::to_c::CTree;
use crate::value::Branch;
use std::cell::{Cell, UnsafeCell};
use std::ffi::c_void;
use std::ptr::NonNull;
use std::sync::atomic::{AtomicBool, AtomicPtr, AtomicU64, AtomicUsize, Ordering};
use std::sync::{Mutex, PoisonError};

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
    watch: Watch<'a>,
    /// A thread called back that may not.
    stray: AtomicBool,
    own: UnsafeCell<Own<'a>>,
}

/// What only the thread that evaluates touches.
struct Own<'a> {
    sink: &'a mut dyn Sink,
    buffers: Buffers,
    /// Buffers asked for so far.
    asked: u64,
    fault: Option<String>,
}

/// Where a `tenon_call` leads. Slots are used again and never freed, so that a plugin that calls back after its
/// evaluation meets a closed door and not freed memory.
struct Slot {
    call: tenon_call,
    /// The thread that evaluates, see [`here`]; 0: none does.
    owner: AtomicUsize,
    running: AtomicPtr<Running<'static>>,
    /// Other threads that look at `running`: it must stay as long.
    visitors: AtomicUsize,
}

// SAFETY: `call` never changes; the rest is atomic, and what `running` leads to is guarded by `own` and `visit`.
unsafe impl Sync for Slot {}
// SAFETY: see above.
unsafe impl Send for Slot {}

static LATE: AtomicU64 = AtomicU64::new(0);

/// Number of calls that plugins made after their evaluation had ended; each was refused.
#[must_use]
pub fn late_calls() -> u64 {
    LATE.load(Ordering::Relaxed)
}

/// Free slots of threads that ended.
static FREE: Mutex<Vec<&'static Slot>> = Mutex::new(Vec::new());

/// The free slot of a thread.
struct Spare(Cell<Option<&'static Slot>>);

impl Drop for Spare {
    fn drop(&mut self) {
        FREE.lock().unwrap_or_else(PoisonError::into_inner).extend(self.0.take());
    }
}

thread_local! {
    static SPARE: Spare = const { Spare(Cell::new(None)) };
    static HERE: u8 = const { 0 };
}

/// A number that no other thread has while this one lives.
fn here() -> usize {
    HERE.with(|here| std::ptr::from_ref(here).addr())
}

impl Slot {
    fn take() -> &'static Self {
        let spare = SPARE.try_with(|spare| spare.0.take()).ok().flatten();
        spare.or_else(|| FREE.lock().unwrap_or_else(PoisonError::into_inner).pop()).unwrap_or_else(Self::leak)
    }

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
        let (owner, running) = (AtomicUsize::new(0), AtomicPtr::default());
        let slot = Box::into_raw(Box::new(Self { call, owner, running, visitors: AtomicUsize::new(0) }));
        // SAFETY: it is never freed, and nobody else has it yet.
        unsafe {
            (*slot).call.host = slot.cast();
            &*slot
        }
    }

    /// What the thread that evaluates may do; other threads get `otherwise`.
    fn own<R>(&self, otherwise: R, f: impl FnOnce(&Watch<'static>, &mut Own<'static>) -> R) -> R {
        if self.owner.load(Ordering::Relaxed) == here() {
            // SAFETY: an evaluation of this very thread is under way, so it is there; only this thread comes here, and
            // what it does does not call back.
            unsafe {
                let running = &*self.running.load(Ordering::Relaxed);
                return f(&running.watch, &mut *running.own.get());
            }
        }
        self.visit(otherwise, |running, otherwise| {
            running.stray.store(true, Ordering::Relaxed);
            otherwise
        })
    }

    /// What any thread may do while an evaluation is under way; afterwards it is late and gets `otherwise`.
    fn visit<R>(&self, otherwise: R, f: impl FnOnce(&Running<'static>, R) -> R) -> R {
        self.visitors.fetch_add(1, Ordering::SeqCst);
        // SAFETY: [`Slot::close`] waits for visitors after it has taken the pointer away, so what is seen here stays.
        let running = unsafe { self.running.load(Ordering::SeqCst).as_ref() };
        let done = match running {
            Some(running) => f(running, otherwise),
            None => {
                LATE.fetch_add(1, Ordering::Relaxed);
                otherwise
            }
        };
        self.visitors.fetch_sub(1, Ordering::SeqCst);
        done
    }

    fn open(&self, running: &Running<'_>) {
        self.running.store(std::ptr::from_ref(running).cast_mut().cast(), Ordering::Release);
        self.owner.store(here(), Ordering::Relaxed);
    }

    fn close(&'static self) {
        self.owner.store(0, Ordering::Relaxed);
        self.running.store(std::ptr::null_mut(), Ordering::SeqCst);
        while self.visitors.load(Ordering::SeqCst) != 0 {
            std::thread::yield_now();
        }
        let kept = SPARE.try_with(|spare| spare.0.replace(Some(self))).unwrap_or(Some(self));
        if let Some(other) = kept {
            FREE.lock().unwrap_or_else(PoisonError::into_inner).push(other);
        }
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
    if slot.owner.load(Ordering::Relaxed) == here() {
        return slot.own(1, |watch, _| i32::from((watch.cancelled)()));
    }
    slot.visit(1, |running, _| i32::from((running.watch.cancelled)()))
}

unsafe extern "C" fn progress(call: *const tenon_call, fraction: f64) {
    // SAFETY: the plugin hands back what it was given.
    if let Some(slot) = unsafe { slot(call) }
        && fraction.is_finite()
    {
        slot.own((), |watch, _| (watch.progress)(fraction.clamp(0.0, 1.0)));
    }
}

unsafe extern "C" fn tell(call: *const tenon_call, message: *const tenon_message) -> tenon_status {
    // SAFETY: the plugin hands back what it was given.
    let Some(slot) = (unsafe { slot(call) }) else { return TENON_BAD_ARGUMENT };
    slot.own(TENON_BAD_ARGUMENT, |_, r| {
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
    slot.own(std::ptr::null_mut(), |watch, r| {
        r.asked += 1;
        match watch.room {
            _ if watch.refuse_buffer == Some(r.asked - 1) => std::ptr::null_mut(),
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
    slot.own(TENON_BAD_ARGUMENT, |_, r| {
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
    slot.own(TENON_BAD_ARGUMENT, |_, r| match r.sink.forward(output, input) {
        Ok(()) => TENON_OK,
        Err(why) => {
            r.fault.get_or_insert_with(|| format!("output {output}: {why}"));
            TENON_BAD_ARGUMENT
        }
    })
}

/// Inputs as a plugin reads them.
pub struct Views<'a> {
    inputs: &'a [Vec<Branch<'a>>],
    trees: Vec<tenon_tree>,
    _views: Vec<CTree<'a>>,
}

impl<'a> Views<'a> {
    /// Views of `inputs`. O(branches), plus O(items) for curves, meshes and the like.
    #[must_use]
    pub fn new(inputs: &'a [Vec<Branch<'a>>]) -> Self {
        let views: Vec<CTree<'_>> = inputs.iter().map(|branches| CTree::new(branches)).collect();
        Self { inputs, trees: views.iter().map(CTree::get).collect(), _views: views }
    }

    /// The trees, to be laid out otherwise by the checks.
    pub(crate) fn trees(&mut self) -> &mut [tenon_tree] {
        &mut self.trees
    }
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
        match &self.body {
            Body::Here { .. } => self.evaluate_views(&Views::new(inputs), watch, sink),
            Body::Apart(processes, index) => processes.evaluate(*index, inputs, watch, sink),
        }
    }

    /// The same for inputs that are views already: some ten nanoseconds besides what the plugin does.
    ///
    /// # Errors
    /// As [`PluginNode::evaluate`].
    pub fn evaluate_views(
        &self,
        inputs: &Views<'_>,
        watch: Watch<'_>,
        sink: &mut dyn Sink,
    ) -> Result<(), EvaluateError> {
        let (evaluate, data) = match &self.body {
            Body::Here { evaluate, data, .. } => (*evaluate, *data),
            Body::Apart(processes, index) => return processes.evaluate(*index, inputs.inputs, watch, sink),
        };
        let own = Own { sink, buffers: Buffers::default(), asked: 0, fault: None };
        let running = Running { watch, stray: AtomicBool::new(false), own: UnsafeCell::new(own) };
        let (slot, trees) = (Slot::take(), &inputs.trees);
        slot.open(&running);
        // SAFETY: the plugin was loaded and never goes; inputs and call live through the call; it does not unwind, says
        // the contract.
        let status = unsafe { evaluate(data, &raw const slot.call, trees.as_ptr(), trees.len() as u32) };
        slot.close();
        let stray =
            running.stray.into_inner().then(|| "it calls back from a thread that evaluate does not run on".into());
        match (status, running.own.into_inner().fault.or(stray)) {
            (TENON_CANCELLED, _) if (watch.cancelled)() => Err(EvaluateError::Cancelled),
            (_, Some(fault)) => Err(EvaluateError::Fault(fault)),
            (TENON_OK, None) => Ok(()),
            (TENON_CANCELLED, None) => Err(EvaluateError::Fault("it gave up although nobody asked it to".into())),
            (TENON_FAILED, None) => Err(EvaluateError::Failed),
            (other, None) => Err(EvaluateError::Fault(format!("evaluate gave the status {other}"))),
        }
    }
}
