// Plugins of Tenon: shared libraries that bring node types. This header is the contract.
//
// A plugin exports one symbol:
//     TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
// It is declared at the end of this file, in C++ as a plain symbol.
// Rules
// - Every struct begins with its size, set by its maker to sizeof at its compile time. Structs grow at the end only.
// - Descriptors stay as they are while the library is loaded, and it is loaded for ever.
// - Inputs are borrowed until evaluate returns, and read-only. Outputs are copied by the host, or lie in buffers of the
//   host and change hands. Nothing is freed across.
// - Nothing may be thrown across: a C++ plugin catches everything in evaluate. Nobody calls exit or abort.
// - evaluate is called by any thread, by several at once, and depends on nothing but its inputs.
// - Lengths are mm. Angles at ports are degrees, inside values radians.
// What this contract cannot prevent: a plugin runs inside the host's process and can do there whatever it wants; a
// pointer that leads nowhere ends the host. tenon_call is not to be used after evaluate returned: the host then
// answers with errors, as long as the library asks through the same struct.
// Generated from the Rust source; do not edit.

#ifndef TENON_PLUGIN_H
#define TENON_PLUGIN_H

#include <stdbool.h>
#include <stdint.h>
#include "tenon_value.h"

#if defined(_WIN32)
#define TENON_EXPORT __declspec(dllexport)
#else
#define TENON_EXPORT __attribute__((visibility("default")))
#endif


// `tenon_plugin.magic`: a library that exports the symbol by chance has something else there.
#define TENON_PLUGIN_MAGIC 1313752404

// Major version of this contract. Another major does not fit.
#define TENON_PLUGIN_MAJOR 1

// Minor version of this contract. A greater minor only adds fields at the ends of structs.
#define TENON_PLUGIN_MINOR 2

// The port may stay without a value: its tree then has no branches.
#define TENON_OPTIONAL 1

// `min` and `max` count.
#define TENON_RANGE 2

// The node does nothing but its function of the inputs; without it the plugin is refused. (Room for later.)
#define TENON_PURE 1

// It takes long enough to be worth a thread.
#define TENON_SLOW 2

// It is a fastener: the host makes the node around it (see `tenon_node_type.evaluate`).
#define TENON_FASTENER 4

// How a node sees what arrives at a port.
typedef uint32_t tenon_access;

// What the numbers in a buffer are.
typedef uint32_t tenon_element;

// One input or output. Every parameter is an input with a default.
typedef struct tenon_port {
  // Bytes of this struct as the plugin knows it.
  uint32_t size;
  // `TENON_OPTIONAL`, `TENON_RANGE`, added up.
  uint32_t flags;
  // What its items are: `TENON_BOOLEAN` to `TENON_FEATURES`, or `TENON_TABLE`.
  tenon_kind kind;
  // How the node sees it.
  tenon_access access;
  // Its name in graph files: lower case letters, digits and `_`.
  tenon_str name;
  // What it means.
  tenon_str doc;
  // What its numbers measure: "mm", "deg", "mm2", "mm3", "mm/min", "rev/min", "pieces", or empty. Angles arrive in
  // degrees.
  tenon_str unit;
  // The literal used without wire and parameter, as JSON; empty: there is none.
  tenon_str default_json;
  // Smallest number accepted, with `TENON_RANGE`; the host sees to it.
  double min;
  // Largest number accepted, with `TENON_RANGE`; the host sees to it.
  double max;
  // The texts accepted; NULL: any.
  const tenon_str *choices;
  // Number of `choices`.
  uint64_t choice_count;
} tenon_port;

// What a plugin has to say about its input.
typedef struct tenon_message {
  // Bytes of this struct as the plugin knows it.
  uint32_t size;
  // `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
  tenon_severity severity;
  // A stable name in kebab-case, such as "edge-too-short".
  tenon_str code;
  // A sentence for people: what, how far off.
  tenon_str message;
  // What would fix it; may be empty.
  tenon_str hint;
  // Name of the input concerned; may be empty.
  tenon_str port;
  // Index of the item concerned, or UINT64_MAX.
  uint64_t item;
} tenon_message;

// One evaluation, given to `evaluate` and good until it returns. Its functions are called from the thread that
// `evaluate` runs on, except `cancelled`, which any thread may call meanwhile. On another thread `tell`, `set` and
// `forward` give `TENON_BAD_ARGUMENT` and `buffer` NULL; `progress` does nothing.
typedef struct tenon_call {
  // Bytes of this struct as the host knows it.
  uint32_t size;
  // 0.
  uint32_t flags;
  // The host's.
  void *host;
  // 1: stop and return `TENON_CANCELLED`; 0: go on. To be asked at least every 10 ms; it costs nothing. After evaluate
  // has returned it gives 1. [any thread while evaluate runs]
  int32_t (*cancelled)(const struct tenon_call *call);
  // Tells the fraction done, 0 to 1, as often as it is known; it should not fall. What is not finite is not heard, and
  // it cannot fail. [thread of evaluate]
  void (*progress)(const struct tenon_call *call, double fraction);
  // Says something about the input. An error without `TENON_FAILED` as the result means that part is missing. Notes
  // (`TENON_NOTE`) are the log: a plugin has no other. The message stays the plugin's; its texts are copied before this
  // returns. `TENON_BAD_ARGUMENT` if it is NULL, short or not UTF-8, which is told as the plugin's fault.
  // [thread of evaluate]
  tenon_status (*tell)(const struct tenon_call *call, const struct tenon_message *message);
  // Memory of the host for `count` elements, zeroed, which may stand in any array of a value given to `set`. An array of
  // those elements that is the buffer from its first to its last goes over to the host without a copy, and must not be
  // written or given after that. A part of a buffer is copied, and so is `valid`, so that one may stand in any number of
  // columns and outputs. It is the host's, which frees it after evaluate has returned, also if it was not given to
  // `set`. NULL: there is no memory, or no such element. [thread of evaluate]
  void *(*buffer)(const struct tenon_call *call, tenon_element element, uint64_t count);
  // Sets an output. Arrays that are not buffers are copied before it returns. Fails if the output is not there, the
  // type is another than declared, or the value has faults: lengths, indices, texts that are not UTF-8, a buffer given
  // twice, in one output or in two: `TENON_BAD_TYPE`, told as the plugin's fault. Set twice, the last counts.
  // [thread of evaluate]
  tenon_status (*set)(const struct tenon_call *call, uint32_t output, const tenon_tree *value);
  // Sets an output to what arrived at an input, as it is: nothing is copied. Both by their index in the descriptor (for
  // a fastener, as evaluate counts them). `TENON_BAD_ARGUMENT` if one of them is not there or their types differ, told
  // as the plugin's fault. [thread of evaluate]
  tenon_status (*forward)(const struct tenon_call *call, uint32_t output, uint32_t input);
} tenon_call;

// Takes a text, which it copies before it returns and which stays the plugin's; `to` is what the host gave with it. The
// last text counts; one that is not UTF-8 is told as the plugin's fault. [thread of migrate, while it runs]
typedef void (*tenon_give)(void *to, tenon_str text);

// A node type. Everything in it stays as it is while the library is loaded.
typedef struct tenon_node_type {
  // Bytes of this struct as the plugin knows it.
  uint32_t size;
  // `TENON_PURE` and others, added up.
  uint32_t flags;
  // Its name in graph files, beginning with the plugin's id: "acme.hinge".
  tenon_str id;
  // Raise it whenever the same inputs begin to give other outputs. At least 1.
  uint32_t version;
  // Inputs, in the order in which `evaluate` gets them.
  uint32_t input_count;
  // Inputs.
  const struct tenon_port *inputs;
  // Outputs.
  const struct tenon_port *outputs;
  // Number of outputs.
  uint32_t output_count;
  // Bytes from one port to the next: sizeof(tenon_port).
  uint32_t port_stride;
  // Name for people.
  tenon_str name;
  // Where a palette shows it.
  tenon_str category;
  // What it does.
  tenon_str doc;
  // Other words to find it by, separated by commas.
  tenon_str keywords;
  // The plugin's, given back to `evaluate`; may be NULL. It must be fit to be used by many threads at once.
  void *data;
  // Computes the outputs. Called by any thread, by several at once. Inputs are read-only and good until it returns.
  // Gives `TENON_OK`, `TENON_CANCELLED`, `TENON_FAILED` after telling why, or `TENON_NO_MEMORY`, for which the host
  // itself tells an error. The same inputs must give the same outputs, byte for byte. Inputs and `call` are the host's,
  // `data` the plugin's. Any other status, and a function of `call` used by another thread, are told as the plugin's
  // fault. [any thread]
  //
  // For a fastener, `inputs[0]` is the panel set (`TENON_PANELS`), `inputs[1]` the edges selected for it
  // (`TENON_EDGES`, each once, in order), `inputs[2]` the face that lies up on the machine (`TENON_TEXT`: "front" or
  // "back"), and the declared inputs follow from 3. Output 0 is its features
  // (`TENON_FEATURES`) for both sides of each edge, with joint numbers from 0, and the hardware; declared outputs
  // are not allowed. The host selects the edges, takes out features that lie outside their panel or belong to an edge that
  // was not selected (to a panel without one, if they name no edge), with an error each, and checks the rest against the
  // machine.
  //
  // Since 1.2 a fastener may declare an input called "head", one text: the host's own, by which panel of an edge is the
  // first: "lower address", "higher address" or "alternate". The edges come ordered by it, by turns from edge to edge;
  // a fastener that sees it may take turns along each edge instead.
  tenon_status (*evaluate)(void *data,
                           const struct tenon_call *call,
                           const tenon_tree *inputs,
                           uint32_t input_count);
  // Since 1.1: brings a node that was saved at version `from` to version `from + 1`. `node` is the node as it stands in
  // the file, one JSON object (`type`, `v`, `params`, `inputs` …); `type` has to stay, `v` is set by the host. It gives
  // the new object by `give(to, text)`, which copies it, and `TENON_OK`; or a sentence that says why that cannot be
  // done, and `TENON_FAILED`. Called before the node is evaluated; the same text must give the same text. `node` is the
  // host's. May be NULL. [any thread]
  tenon_status (*migrate)(void *data, uint32_t from, tenon_str node, tenon_give give, void *to);
  // Since 1.1: the oldest version that `migrate` takes. It is asked for every version from this to the one before
  // `version`.
  uint32_t migrate_from;
  // 0.
  uint32_t reserved;
} tenon_node_type;

// Where a field lies, as its maker's compiler laid it out. Since 1.2.
typedef struct tenon_field {
  // The struct.
  tenon_str of;
  // The field; empty: the whole struct, of those that never grow. A name that ends with ": type" tells the field's type:
  // `offset` and `bytes` are the lower and the upper half of a number that stands for it.
  tenon_str name;
  // Bytes before it.
  uint32_t offset;
  // Its bytes; 0: it may grow.
  uint32_t bytes;
} tenon_field;

// Where every field of this contract lies, as its maker's compiler laid it out. Since 1.2.
typedef struct tenon_layout {
  // Bytes of this struct as the plugin knows it.
  uint32_t size;
  // Bytes from one field to the next: sizeof(tenon_field).
  uint32_t field_stride;
  // FNV-1a, 64 bits, of the fields: names ended by a zero each, then offset and bytes, least byte first.
  uint64_t digest;
  // Fields.
  const struct tenon_field *fields;
  // Number of fields.
  uint64_t field_count;
} tenon_layout;

// A plugin: what its library gives through `const tenon_plugin *tenon_plugin_v1(void)`, the one symbol that it exports.
// Everything in it stays as it is while the library is loaded; libraries are never unloaded.
typedef struct tenon_plugin {
  // `TENON_PLUGIN_MAGIC`.
  uint32_t magic;
  // Bytes of this struct as the plugin knows it.
  uint32_t size;
  // `TENON_PLUGIN_MAJOR`.
  uint32_t abi_major;
  // `TENON_PLUGIN_MINOR`.
  uint32_t abi_minor;
  // Its name in graph files: lower case letters, digits and `_`.
  tenon_str id;
  // Its version: "1.2.0".
  tenon_str version;
  // Who made it.
  tenon_str vendor;
  // What it is for.
  tenon_str doc;
  // Node types, one after the other.
  const struct tenon_node_type *nodes;
  // Number of node types.
  uint32_t node_count;
  // Bytes from one node type to the next: sizeof(tenon_node_type).
  uint32_t node_stride;
  // Since 1.2: how the plugin was laid out; the host refuses it if a field that both know lies elsewhere. Plugins in C,
  // which are compiled from this header, leave it NULL; those made by the Rust layer have it.
  const struct tenon_layout *layout;
} tenon_plugin;

// The function that a plugin exports under the name `tenon_plugin_v1`. Called whenever a program looks at the library, before
// anything else, often more than once: it gives the same descriptor each time, quickly, and changes nothing. What it gives
// is the plugin's and stays for ever. NULL: the plugin cannot be used, and is refused. [any thread]
typedef const struct tenon_plugin *(*tenon_plugin_entry)(void);

// One item at a time: the tree has one branch of one item. The host iterates.
#define TENON_ITEM 0

// One list at a time: the tree has one branch.
#define TENON_LIST 1

// Everything at once.
#define TENON_TREE 2

// `uint8_t`.
#define TENON_U8 0

// `uint32_t`.
#define TENON_U32 1

// `int64_t`.
#define TENON_I64 2

// `double`.
#define TENON_F64 3

// `tenon_vec3`.
#define TENON_VEC3 4

// `tenon_vec4`.
#define TENON_VEC4 5

// `tenon_plane`.
#define TENON_PLANES 6

// `tenon_edge`.
#define TENON_EDGE_REFS 7

// `tenon_address`.
#define TENON_ADDRESSES 8

#ifdef __cplusplus
extern "C" {
#endif

// The one symbol that a plugin exports and defines; see `tenon_plugin_entry`. [any thread]
TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);

#ifdef __cplusplus
}
#endif

#endif  /* TENON_PLUGIN_H */
