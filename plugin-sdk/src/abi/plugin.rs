//! What a plugin exports and what it is given. From this file `include/tenon_plugin.h` is generated.

use super::value::{tenon_kind, tenon_severity, tenon_status, tenon_str, tenon_tree};
use std::ffi::c_void;

/// `tenon_plugin.magic`: a library that exports the symbol by chance has something else there.
pub const TENON_PLUGIN_MAGIC: u32 = 0x4E4E_4554;
/// Major version of this contract. Another major does not fit.
pub const TENON_PLUGIN_MAJOR: u32 = 1;
/// Minor version of this contract. A greater minor only adds fields at the ends of structs.
pub const TENON_PLUGIN_MINOR: u32 = 2;

/// How a node sees what arrives at a port.
pub type tenon_access = u32;
/// One item at a time: the tree has one branch of one item. The host iterates.
pub const TENON_ITEM: tenon_access = 0;
/// One list at a time: the tree has one branch.
pub const TENON_LIST: tenon_access = 1;
/// Everything at once.
pub const TENON_TREE: tenon_access = 2;

/// The port may stay without a value: its tree then has no branches.
pub const TENON_OPTIONAL: u32 = 1;
/// `min` and `max` count.
pub const TENON_RANGE: u32 = 2;

/// One input or output. Every parameter is an input with a default.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_port {
    /// Bytes of this struct as the plugin knows it.
    pub size: u32,
    /// `TENON_OPTIONAL`, `TENON_RANGE`, added up.
    pub flags: u32,
    /// What its items are: `TENON_BOOLEAN` to `TENON_FEATURES`, or `TENON_TABLE`.
    pub kind: tenon_kind,
    /// How the node sees it.
    pub access: tenon_access,
    /// Its name in graph files: lower case letters, digits and `_`.
    pub name: tenon_str,
    /// What it means.
    pub doc: tenon_str,
    /// What its numbers measure: "mm", "deg", "mm2", "mm3", "mm/min", "rev/min", "pieces", or empty. Angles arrive in
    /// degrees.
    pub unit: tenon_str,
    /// The literal used without wire and parameter, as JSON; empty: there is none.
    pub default_json: tenon_str,
    /// Smallest number accepted, with `TENON_RANGE`; the host sees to it.
    pub min: f64,
    /// Largest number accepted, with `TENON_RANGE`; the host sees to it.
    pub max: f64,
    /// The texts accepted; NULL: any.
    pub choices: *const tenon_str,
    /// Number of `choices`.
    pub choice_count: u64,
}

/// What a plugin has to say about its input.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_message {
    /// Bytes of this struct as the plugin knows it.
    pub size: u32,
    /// `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
    pub severity: tenon_severity,
    /// A stable name in kebab-case, such as "edge-too-short".
    pub code: tenon_str,
    /// A sentence for people: what, how far off.
    pub message: tenon_str,
    /// What would fix it; may be empty.
    pub hint: tenon_str,
    /// Name of the input concerned; may be empty.
    pub port: tenon_str,
    /// Index of the item concerned, or UINT64_MAX.
    pub item: u64,
}

/// What the numbers in a buffer are.
pub type tenon_element = u32;
/// `uint8_t`.
pub const TENON_U8: tenon_element = 0;
/// `uint32_t`.
pub const TENON_U32: tenon_element = 1;
/// `int64_t`.
pub const TENON_I64: tenon_element = 2;
/// `double`.
pub const TENON_F64: tenon_element = 3;
/// `tenon_vec3`.
pub const TENON_VEC3: tenon_element = 4;
/// `tenon_vec4`.
pub const TENON_VEC4: tenon_element = 5;
/// `tenon_plane`.
pub const TENON_PLANES: tenon_element = 6;
/// `tenon_edge`.
pub const TENON_EDGE_REFS: tenon_element = 7;
/// `tenon_address`.
pub const TENON_ADDRESSES: tenon_element = 8;

/// One evaluation, given to `evaluate` and good until it returns. Its functions are called from the thread that
/// `evaluate` runs on, except `cancelled`, which any thread may call meanwhile. On another thread `tell`, `set` and
/// `forward` give `TENON_BAD_ARGUMENT` and `buffer` NULL; `progress` does nothing.
#[repr(C)]
pub struct tenon_call {
    /// Bytes of this struct as the host knows it.
    pub size: u32,
    /// 0.
    pub flags: u32,
    /// The host's.
    pub host: *mut c_void,
    /// 1: stop and return `TENON_CANCELLED`; 0: go on. To be asked at least every 10 ms; it costs nothing. After evaluate
    /// has returned it gives 1. [any thread while evaluate runs]
    pub cancelled: unsafe extern "C" fn(call: *const tenon_call) -> i32,
    /// Tells the fraction done, 0 to 1, as often as it is known; it should not fall. What is not finite is not heard, and
    /// it cannot fail. [thread of evaluate]
    pub progress: unsafe extern "C" fn(call: *const tenon_call, fraction: f64),
    /// Says something about the input. An error without `TENON_FAILED` as the result means that part is missing. Notes
    /// (`TENON_NOTE`) are the log: a plugin has no other. The message stays the plugin's; its texts are copied before this
    /// returns. `TENON_BAD_ARGUMENT` if it is NULL, short or not UTF-8, which is told as the plugin's fault.
    /// [thread of evaluate]
    pub tell: unsafe extern "C" fn(call: *const tenon_call, message: *const tenon_message) -> tenon_status,
    /// Memory of the host for `count` elements, zeroed, which may stand in any array of a value given to `set`. An array of
    /// those elements that is the buffer from its first to its last goes over to the host without a copy, and must not be
    /// written or given after that. A part of a buffer is copied, and so is `valid`, so that one may stand in any number of
    /// columns and outputs. It is the host's, which frees it after evaluate has returned, also if it was not given to
    /// `set`. NULL: there is no memory, or no such element. [thread of evaluate]
    pub buffer: unsafe extern "C" fn(call: *const tenon_call, element: tenon_element, count: u64) -> *mut c_void,
    /// Sets an output. Arrays that are not buffers are copied before it returns. Fails if the output is not there, the
    /// type is another than declared, or the value has faults: lengths, indices, texts that are not UTF-8, a buffer given
    /// twice, in one output or in two: `TENON_BAD_TYPE`, told as the plugin's fault. Set twice, the last counts.
    /// [thread of evaluate]
    pub set: unsafe extern "C" fn(call: *const tenon_call, output: u32, value: *const tenon_tree) -> tenon_status,
    /// Sets an output to what arrived at an input, as it is: nothing is copied. Both by their index in the descriptor (for
    /// a fastener, as evaluate counts them). `TENON_BAD_ARGUMENT` if one of them is not there or their types differ, told
    /// as the plugin's fault. [thread of evaluate]
    pub forward: unsafe extern "C" fn(call: *const tenon_call, output: u32, input: u32) -> tenon_status,
}

/// Takes a text, which it copies before it returns and which stays the plugin's; `to` is what the host gave with it. The
/// last text counts; one that is not UTF-8 is told as the plugin's fault. [thread of migrate, while it runs]
pub type tenon_give = unsafe extern "C" fn(to: *mut c_void, text: tenon_str);

/// The node does nothing but its function of the inputs; without it the plugin is refused. (Room for later.)
pub const TENON_PURE: u32 = 1;
/// It takes long enough to be worth a thread.
pub const TENON_SLOW: u32 = 2;
/// It is a fastener: the host makes the node around it (see `tenon_node_type.evaluate`).
pub const TENON_FASTENER: u32 = 4;

/// A node type. Everything in it stays as it is while the library is loaded.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_node_type {
    /// Bytes of this struct as the plugin knows it.
    pub size: u32,
    /// `TENON_PURE` and others, added up.
    pub flags: u32,
    /// Its name in graph files, beginning with the plugin's id: "acme.hinge".
    pub id: tenon_str,
    /// Raise it whenever the same inputs begin to give other outputs. At least 1.
    pub version: u32,
    /// Inputs, in the order in which `evaluate` gets them.
    pub input_count: u32,
    /// Inputs.
    pub inputs: *const tenon_port,
    /// Outputs.
    pub outputs: *const tenon_port,
    /// Number of outputs.
    pub output_count: u32,
    /// Bytes from one port to the next: sizeof(tenon_port).
    pub port_stride: u32,
    /// Name for people.
    pub name: tenon_str,
    /// Where a palette shows it.
    pub category: tenon_str,
    /// What it does.
    pub doc: tenon_str,
    /// Other words to find it by, separated by commas.
    pub keywords: tenon_str,
    /// The plugin's, given back to `evaluate`; may be NULL. It must be fit to be used by many threads at once.
    pub data: *mut c_void,
    /// Computes the outputs. Called by any thread, by several at once. Inputs are read-only and good until it returns.
    /// Gives `TENON_OK`, `TENON_CANCELLED`, `TENON_FAILED` after telling why, or `TENON_NO_MEMORY`, for which the host
    /// itself tells an error. The same inputs must give the same outputs, byte for byte. Inputs and `call` are the host's,
    /// `data` the plugin's. Any other status, and a function of `call` used by another thread, are told as the plugin's
    /// fault. [any thread]
    ///
    /// For a fastener, `inputs[0]` is the panel set (`TENON_PANELS`), `inputs[1]` the edges selected for it
    /// (`TENON_EDGES`, each once, in order), `inputs[2]` the face that lies up on the machine (`TENON_TEXT`: "front" or
    /// "back"), and the declared inputs follow from 3. Output 0 is its features
    /// (`TENON_FEATURES`) for both sides of each edge, with joint numbers from 0, and the hardware; declared outputs
    /// are not allowed. The host selects the edges, takes out features that lie outside their panel or belong to an edge that
    /// was not selected (to a panel without one, if they name no edge), with an error each, and checks the rest against the
    /// machine.
    ///
    /// Since 1.2 a fastener may declare an input called "head", one text: the host's own, by which panel of an edge is the
    /// first: "lower address", "higher address" or "alternate". The edges come ordered by it, by turns from edge to edge;
    /// a fastener that sees it may take turns along each edge instead.
    pub evaluate: Option<
        unsafe extern "C" fn(
            data: *mut c_void,
            call: *const tenon_call,
            inputs: *const tenon_tree,
            input_count: u32,
        ) -> tenon_status,
    >,
    /// Since 1.1: brings a node that was saved at version `from` to version `from + 1`. `node` is the node as it stands in
    /// the file, one JSON object (`type`, `v`, `params`, `inputs` …); `type` has to stay, `v` is set by the host. It gives
    /// the new object by `give(to, text)`, which copies it, and `TENON_OK`; or a sentence that says why that cannot be
    /// done, and `TENON_FAILED`. Called before the node is evaluated; the same text must give the same text. `node` is the
    /// host's. May be NULL. [any thread]
    pub migrate: Option<
        unsafe extern "C" fn(
            data: *mut c_void,
            from: u32,
            node: tenon_str,
            give: tenon_give,
            to: *mut c_void,
        ) -> tenon_status,
    >,
    /// Since 1.1: the oldest version that `migrate` takes. It is asked for every version from this to the one before
    /// `version`.
    pub migrate_from: u32,
    /// 0.
    pub reserved: u32,
}

/// Where a field lies, as its maker's compiler laid it out. Since 1.2.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_field {
    /// The struct.
    pub of: tenon_str,
    /// The field; empty: the whole struct, of those that never grow. A name that ends with ": type" tells the field's type:
    /// `offset` and `bytes` are the lower and the upper half of a number that stands for it.
    pub name: tenon_str,
    /// Bytes before it.
    pub offset: u32,
    /// Its bytes; 0: it may grow.
    pub bytes: u32,
}

/// Where every field of this contract lies, as its maker's compiler laid it out. Since 1.2.
#[repr(C)]
#[derive(Clone, Copy, Debug)]
pub struct tenon_layout {
    /// Bytes of this struct as the plugin knows it.
    pub size: u32,
    /// Bytes from one field to the next: sizeof(tenon_field).
    pub field_stride: u32,
    /// FNV-1a, 64 bits, of the fields: names ended by a zero each, then offset and bytes, least byte first.
    pub digest: u64,
    /// Fields.
    pub fields: *const tenon_field,
    /// Number of fields.
    pub field_count: u64,
}

/// A plugin: what its library gives through `const tenon_plugin *tenon_plugin_v1(void)`, the one symbol that it exports.
/// Everything in it stays as it is while the library is loaded; libraries are never unloaded.
#[repr(C)]
#[derive(Clone, Copy)]
pub struct tenon_plugin {
    /// `TENON_PLUGIN_MAGIC`.
    pub magic: u32,
    /// Bytes of this struct as the plugin knows it.
    pub size: u32,
    /// `TENON_PLUGIN_MAJOR`.
    pub abi_major: u32,
    /// `TENON_PLUGIN_MINOR`.
    pub abi_minor: u32,
    /// Its name in graph files: lower case letters, digits and `_`.
    pub id: tenon_str,
    /// Its version: "1.2.0".
    pub version: tenon_str,
    /// Who made it.
    pub vendor: tenon_str,
    /// What it is for.
    pub doc: tenon_str,
    /// Node types, one after the other.
    pub nodes: *const tenon_node_type,
    /// Number of node types.
    pub node_count: u32,
    /// Bytes from one node type to the next: sizeof(tenon_node_type).
    pub node_stride: u32,
    /// Since 1.2: how the plugin was laid out; the host refuses it if a field that both know lies elsewhere. Plugins in C,
    /// which are compiled from this header, leave it NULL; those made by the Rust layer have it.
    pub layout: *const tenon_layout,
}

/// The function that a plugin exports under the name `tenon_plugin_v1`. Called whenever a program looks at the library, before
/// anything else, often more than once: it gives the same descriptor each time, quickly, and changes nothing. What it gives
/// is the plugin's and stays for ever. NULL: the plugin cannot be used, and is refused. [any thread]
pub type tenon_plugin_entry = Option<unsafe extern "C" fn() -> *const tenon_plugin>;

// SAFETY: descriptors are constant and their pointers lead to constants, as the contract asks.
unsafe impl Sync for tenon_plugin {}
// SAFETY: see above.
unsafe impl Send for tenon_plugin {}
// SAFETY: see above; `data` must be fit for many threads.
unsafe impl Sync for tenon_node_type {}
// SAFETY: see above.
unsafe impl Send for tenon_node_type {}
// SAFETY: see above.
unsafe impl Sync for tenon_field {}
// SAFETY: see above.
unsafe impl Sync for tenon_layout {}
// SAFETY: see above.
unsafe impl Sync for tenon_port {}
// SAFETY: see above.
unsafe impl Send for tenon_port {}

/// Name of the symbol that a plugin exports.
pub const SYMBOL: &str = "tenon_plugin_v1";
