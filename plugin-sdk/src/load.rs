//! The host's side: loads a plugin, reads its descriptors into values of its own, and calls its nodes. A library is
//! trusted code: once loaded it can do what the program can do. Libraries are never unloaded.

use crate::abi::plugin::*;
use crate::abi::value::*;
use crate::from_c::{BadValue, Buffers, Reader, text};
use crate::to_c::CTree;
use crate::value::Branch;
use std::ffi::c_void;
use std::path::{Path, PathBuf};
use std::sync::atomic::{AtomicU64, Ordering};
use std::sync::{Mutex, PoisonError};
use std::thread::ThreadId;

/// Why a plugin was not loaded.
#[derive(Debug, thiserror::Error)]
#[error("{}: {why}", .path.display())]
pub struct LoadError {
    /// The library.
    pub path: PathBuf,
    /// What is wrong with it.
    pub why: LoadFault,
}

/// What is wrong with a library.
#[derive(Debug, thiserror::Error)]
pub enum LoadFault {
    /// The system does not load it.
    #[error("cannot be loaded: {0}")]
    System(String),
    /// It is no plugin.
    #[error("is no plugin of Tenon: it does not export {SYMBOL}")]
    NoSymbol,
    /// The symbol leads to something else.
    #[error("{0}")]
    NotAPlugin(String),
    /// It was made for another contract.
    #[error(
        "was made for version {found} of the plugin contract, this program has version {TENON_PLUGIN_MAJOR}: {}",
        if *found > TENON_PLUGIN_MAJOR { "a newer Tenon loads it" } else { "build it with the plugin-sdk of this Tenon" }
    )]
    Version {
        /// Its major version.
        found: u32,
    },
    /// A descriptor is wrong.
    #[error("{place}: {why}")]
    Descriptor {
        /// Which.
        place: String,
        /// What is wrong.
        why: String,
    },
}

/// A port of a plugin's node.
#[derive(Clone, Debug)]
pub struct PortInfo {
    /// Name.
    pub name: String,
    /// What it means.
    pub doc: String,
    /// `TENON_NUMBER` and so on.
    pub kind: tenon_kind,
    /// `TENON_ITEM` and so on.
    pub access: tenon_access,
    /// Sign of the unit; may be empty.
    pub unit: String,
    /// Default literal as JSON; may be empty.
    pub default_json: String,
    /// Smallest and largest number.
    pub range: Option<(f64, f64)>,
    /// Texts accepted; none: any.
    pub choices: Vec<String>,
    /// It may stay without a value.
    pub optional: bool,
}

/// A node type of a plugin.
#[derive(Debug)]
pub struct PluginNode {
    /// Name in graph files.
    pub id: String,
    /// Version.
    pub version: u32,
    /// Name for people.
    pub name: String,
    /// Where a palette shows it.
    pub category: String,
    /// What it does.
    pub doc: String,
    /// Other words to find it by.
    pub keywords: Vec<String>,
    /// Inputs.
    pub inputs: Vec<PortInfo>,
    /// Outputs.
    pub outputs: Vec<PortInfo>,
    /// Worth a thread of its own.
    pub slow: bool,
    /// The host makes the node around it.
    pub fastener: bool,
    evaluate: unsafe extern "C" fn(*mut c_void, *const tenon_call, *const tenon_tree, u32) -> tenon_status,
    data: *mut c_void,
}

// SAFETY: the contract asks that `data` may be used by many threads at once.
unsafe impl Send for PluginNode {}
// SAFETY: see above.
unsafe impl Sync for PluginNode {}

/// A loaded plugin.
#[derive(Debug)]
pub struct Plugin {
    /// Where it lies.
    pub path: PathBuf,
    /// Name in graph files.
    pub id: String,
    /// Version.
    pub version: String,
    /// Who made it.
    pub vendor: String,
    /// What it is for.
    pub doc: String,
    /// Its node types.
    pub nodes: Vec<PluginNode>,
}

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
}

/// Reads descriptors; every fault names its place.
struct Descriptors {
    place: String,
}

impl Descriptors {
    fn fault(&self, why: impl ToString) -> LoadFault {
        LoadFault::Descriptor { place: self.place.clone(), why: why.to_string() }
    }

    /// # Safety
    /// The text is as the contract says.
    unsafe fn text(&self, t: tenon_str, what: &'static str) -> Result<String, LoadFault> {
        if t.len > 1 << 20 {
            return Err(self.fault(format!("{what} is longer than 1 MiB")));
        }
        // SAFETY: as the caller vouches.
        unsafe { text(t, what) }.map(str::to_owned).map_err(|e| self.fault(e))
    }

    /// # Safety
    /// The port is as the contract says.
    unsafe fn port(&mut self, p: &tenon_port, node: &str, output: bool) -> Result<PortInfo, LoadFault> {
        self.place = node.to_owned();
        // SAFETY: as the caller vouches.
        let name = unsafe { self.text(p.name, "the name of a port")? };
        if !is_name(&name) {
            return Err(self.fault(format!("a port is called \"{name}\"; names are lower case letters, digits and _")));
        }
        self.place = format!("{node}.{name}");
        if !(TENON_BOOLEAN..=TENON_FEATURES).contains(&p.kind) {
            return Err(self.fault(format!("its kind is {}, which no port can have", p.kind)));
        }
        if p.access > TENON_TREE {
            return Err(self.fault(format!("its access is {}, which is not known", p.access)));
        }
        let range = (p.flags & TENON_RANGE != 0).then_some((p.min, p.max));
        if let Some((min, max)) = range
            && !(min <= max && matches!(p.kind, TENON_NUMBER | TENON_INTEGER))
        {
            return Err(self.fault(format!("the range {min} to {max} is empty or not of numbers")));
        }
        let mut choices = Vec::new();
        if p.choice_count > 0 {
            if p.choices.is_null() || p.choice_count > 1000 {
                return Err(self.fault(format!("{} choices at {:p}", p.choice_count, p.choices)));
            }
            for i in 0..p.choice_count as usize {
                // SAFETY: not NULL, and as the caller vouches.
                choices.push(unsafe { self.text(*p.choices.add(i), "a choice")? });
            }
        }
        // SAFETY: as the caller vouches.
        let (doc, unit, default_json) = unsafe {
            (self.text(p.doc, "doc")?, self.text(p.unit, "unit")?, self.text(p.default_json, "default_json")?)
        };
        if doc.is_empty() {
            return Err(self.fault("it has no doc"));
        }
        if output && (!default_json.is_empty() || range.is_some() || p.flags & TENON_OPTIONAL != 0) {
            return Err(self.fault("an output has no default and no range and is not optional"));
        }
        Ok(PortInfo {
            name,
            doc,
            kind: p.kind,
            access: p.access,
            unit,
            default_json,
            range,
            choices,
            optional: p.flags & TENON_OPTIONAL != 0,
        })
    }

    /// # Safety
    /// The node type is as the contract says.
    unsafe fn node(&mut self, n: &tenon_node_type, plugin: &str) -> Result<PluginNode, LoadFault> {
        // SAFETY: as the caller vouches.
        let id = unsafe { self.text(n.id, "the id of a node type")? };
        self.place = format!("node type \"{id}\"");
        let short = id.strip_prefix(plugin).and_then(|rest| rest.strip_prefix('.'));
        if !short.is_some_and(is_name) {
            return Err(
                self.fault(format!("its id must be \"{plugin}.\" and a name of lower case letters, digits and _"))
            );
        }
        let Some(evaluate) = n.evaluate else { return Err(self.fault("evaluate is NULL")) };
        if n.version == 0 {
            return Err(self.fault("its version is 0; versions begin with 1"));
        }
        if n.flags & TENON_PURE == 0 {
            return Err(self.fault("TENON_PURE is not set: only functions of their inputs can be nodes"));
        }
        let fastener = n.flags & TENON_FASTENER != 0;
        if fastener == (n.output_count > 0) {
            return Err(self.fault(if fastener { "a fastener declares no outputs" } else { "it has no outputs" }));
        }
        let mut lists = [Vec::new(), Vec::new()];
        for (list, (ports, count, output)) in
            lists.iter_mut().zip([(n.inputs, n.input_count, false), (n.outputs, n.output_count, true)])
        {
            if count > 256 || (count > 0 && (ports.is_null() || !ports.is_aligned())) {
                return Err(self.fault(format!("{count} ports at {ports:p}")));
            }
            if count > 0 && (n.port_stride as usize) < size_of::<tenon_port>() {
                return Err(self.fault(format!("port_stride is {}; set it to sizeof(tenon_port)", n.port_stride)));
            }
            for i in 0..count as usize {
                // SAFETY: not NULL, and as the caller vouches.
                let port = unsafe { *ports.byte_add(i * n.port_stride as usize) };
                // SAFETY: as the caller vouches.
                list.push(unsafe { self.port(&port, &id, output)? });
            }
        }
        let [inputs, outputs] = lists;
        self.place = format!("node type \"{id}\"");
        // SAFETY: as the caller vouches.
        let (name, category, doc, keywords) = unsafe {
            (
                self.text(n.name, "name")?,
                self.text(n.category, "category")?,
                self.text(n.doc, "doc")?,
                self.text(n.keywords, "keywords")?,
            )
        };
        if name.is_empty() || doc.is_empty() {
            return Err(self.fault("it has no name or no doc"));
        }
        Ok(PluginNode {
            id,
            version: n.version,
            name,
            category,
            doc,
            keywords: keywords.split(',').map(str::trim).filter(|k| !k.is_empty()).map(str::to_owned).collect(),
            inputs,
            outputs,
            slow: n.flags & TENON_SLOW != 0,
            fastener,
            evaluate,
            data: n.data,
        })
    }
}

fn is_name(name: &str) -> bool {
    !name.is_empty() && name.bytes().all(|b| b.is_ascii_lowercase() || b.is_ascii_digit() || b == b'_')
}

impl Plugin {
    /// Loads a library and reads what it says of itself. Its initialisers run; nothing is evaluated.
    ///
    /// # Errors
    /// Says what is wrong with it, and for descriptors, which.
    pub fn load(path: &Path) -> Result<Self, LoadError> {
        let fail = |why| LoadError { path: path.to_owned(), why };
        // An absolute path, so that the system does not search for it.
        let full = path.canonicalize().map_err(|e| fail(LoadFault::System(e.to_string())))?;
        // SAFETY: the library's initialisers run. The user named the library or its folder, which is the trust that
        // plugins need.
        let library = unsafe { libloading::Library::new(&full) };
        let library = library.map_err(|e| fail(LoadFault::System(e.to_string())))?;
        // SAFETY: a symbol of this name is a function of this type, says the contract.
        let entry = unsafe { library.get::<unsafe extern "C" fn() -> *const tenon_plugin>(SYMBOL.as_bytes()) };
        let entry = entry.map(|symbol| *symbol).map_err(|_| fail(LoadFault::NoSymbol))?;
        // Functions and descriptors are used for ever.
        std::mem::forget(library);
        // SAFETY: the contract: no arguments, and it gives a descriptor.
        let plugin = unsafe { entry() };
        // SAFETY: it comes from the entry.
        unsafe { Self::read(plugin, full) }.map_err(fail)
    }

    /// Reads a descriptor.
    ///
    /// # Safety
    /// It is NULL or as the contract says.
    unsafe fn read(plugin: *const tenon_plugin, path: PathBuf) -> Result<Self, LoadFault> {
        if plugin.is_null() || !plugin.is_aligned() {
            return Err(LoadFault::NotAPlugin(format!("{SYMBOL} gave {plugin:p}")));
        }
        // SAFETY: the first four numbers are there in every version.
        let [magic, size, major] = unsafe { [(*plugin).magic, (*plugin).size, (*plugin).abi_major] };
        if magic != TENON_PLUGIN_MAGIC {
            return Err(LoadFault::NotAPlugin(format!("{SYMBOL} gave no plugin: its magic number is {magic:#x}")));
        }
        if major != TENON_PLUGIN_MAJOR {
            return Err(LoadFault::Version { found: major });
        }
        if (size as usize) < size_of::<tenon_plugin>() {
            return Err(LoadFault::NotAPlugin(format!("its size is {size}; set it to sizeof(tenon_plugin)")));
        }
        // SAFETY: it is as large as this version of the struct.
        let p = unsafe { *plugin };
        let mut descriptors = Descriptors { place: "the plugin".into() };
        // SAFETY: as the caller vouches.
        let (id, version, vendor, doc) = unsafe {
            (
                descriptors.text(p.id, "id")?,
                descriptors.text(p.version, "version")?,
                descriptors.text(p.vendor, "vendor")?,
                descriptors.text(p.doc, "doc")?,
            )
        };
        if !is_name(&id) {
            return Err(descriptors.fault(format!("its id is \"{id}\"; ids are lower case letters, digits and _")));
        }
        if p.node_count == 0 || p.node_count > 10_000 || p.nodes.is_null() || !p.nodes.is_aligned() {
            return Err(descriptors.fault(format!("{} node types at {:p}", p.node_count, p.nodes)));
        }
        if (p.node_stride as usize) < size_of::<tenon_node_type>() {
            let why = format!("node_stride is {}; set it to sizeof(tenon_node_type)", p.node_stride);
            return Err(descriptors.fault(why));
        }
        let mut nodes: Vec<PluginNode> = Vec::new();
        for i in 0..p.node_count as usize {
            // SAFETY: not NULL, and as the caller vouches.
            let node = unsafe { *p.nodes.byte_add(i * p.node_stride as usize) };
            // SAFETY: as the caller vouches.
            let node = unsafe { descriptors.node(&node, &id)? };
            if nodes.iter().any(|n| n.id == node.id) {
                return Err(descriptors.fault("there are two of it"));
            }
            nodes.push(node);
        }
        Ok(Self { path, id, version, vendor, doc, nodes })
    }
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
        if r.watch.refuse_buffer == Some(r.asked - 1) { std::ptr::null_mut() } else { r.buffers.make(element, count) }
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
        let status = unsafe { (self.evaluate)(self.data, &raw const slot.call, trees.as_ptr(), trees.len() as u32) };
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
