// Tenon in other programs. Generated from the Rust source; do not edit.
//
// Rules
// - Functions that can fail give NULL when all is well, otherwise a tenon_error that the caller frees. What they were
//   to write is then not written. TENON_BAD_ARGUMENT: an argument of the call is wrong. TENON_FAILED: what was asked for
//   cannot be done; the message says why. TENON_INTERNAL: the library has a fault. TENON_CANCELLED is a result's alone.
// - Handles (tenon_engine, tenon_graph, tenon_job, tenon_result, tenon_sweep, tenon_text, tenon_error) are freed by their
//   own function, each once and in any order. A handle that was freed or is of another kind is an error, not a crash.
// - Every function may be called from any thread. What waits: tenon_graph_evaluate for the evaluations of its graph that
//   were asked for before and for its own, tenon_job_wait for a job, tenon_job_free for the callbacks of one, tenon_sweep_row
//   for other calls with its sweep and for its own evaluation, tenon_result_preview while it makes one. Nothing else does.
// - Arguments are read during the call and may go when it returns, but for callbacks with their context and what
//   tenon_graph_share is given.
// - Texts given in are NUL-terminated UTF-8 unless a length is asked for. Texts given out are tenon_str: not terminated.
// - Structs begin with their size. Who makes a struct sets it; later versions add fields at the end only.
// - Nothing is freed across: what a handle gives is good until that handle is freed, and is read-only.
// - No function throws or aborts, and callbacks must not throw.
// - Pointers that are NULL or misaligned, lengths that cannot be, texts that are not UTF-8, offsets and indices that lead
//   outside are errors of the call, which then has changed nothing.
// What this contract cannot prevent: reading a result's arrays after it was freed, changing or freeing shared arrays before
// they are released, and pointers that are neither NULL nor good: lengths that promise more than is there, texts without
// their NUL, structs whose size says more than they are. Nor memory that runs out, a stack that overflows, and a plugin in
// this process that crashes: they end the process. tenon_handle_count tells what was never freed.

#ifndef TENON_H
#define TENON_H

#include <stdbool.h>
#include <stdint.h>
#include "tenon_value.h"

// Node types and settings. Free it with `tenon_engine_free`; graphs that were loaded with it live on.
typedef struct tenon_engine tenon_engine;

// Why a call failed. Functions that can fail give NULL when all is well, otherwise one of these, which the caller
// frees with `tenon_error_free`.
typedef struct tenon_error tenon_error;

// One graph being worked on. Free it with `tenon_graph_free`. Any thread may call with it. Evaluations of one graph run
// one after another, each of the graph as it was when it was asked for; setting, editing and saving never wait for them.
typedef struct tenon_graph tenon_graph;

// An evaluation on a thread of its own. Free it with `tenon_job_free`, before or after it has ended.
typedef struct tenon_job tenon_job;

// What an evaluation came to. Free it with `tenon_result_free`; what was read from it is good until then, also when the
// graph and the engine are gone.
typedef struct tenon_result tenon_result;

// Evaluates rows of sweeps one after another and keeps what they have in common. Free it with `tenon_sweep_free`. Calls
// with the same one wait for one another.
typedef struct tenon_sweep tenon_sweep;

// A text made for the caller, who frees it with `tenon_text_free`.
typedef struct tenon_text tenon_text;

// Settings of an engine. Set `size` to `sizeof(tenon_engine_config)` and the rest to 0 for the defaults.
typedef struct tenon_engine_config {
  // Bytes of this struct.
  uint32_t size;
  // Threads per graph; 0: as many as the machine has. Results do not depend on it.
  uint32_t threads;
  // Memory for remembered results per graph, bytes; 0: 1 GiB.
  uint64_t cache_bytes;
  // Paths of plugins to load, NUL-terminated UTF-8; one that is refused is an error.
  const char *const *plugins;
  // Number of `plugins`.
  uint64_t plugin_count;
  // 1: also load the plugins in the folders of `TENON_PLUGIN_PATH` and in the user's folder; those that are refused
  // are left out, and graphs that need them say so.
  uint32_t search;
  // 0.
  uint32_t flags;
  // Absolute paths of folders whose plugins are loaded, before those of `search`, NUL-terminated UTF-8; those that are
  // refused are left out, and graphs that need them say so. Since 1.1, as all that follows.
  const char *const *folders;
  // Number of `folders`.
  uint64_t folder_count;
  // Ids of plugins that run in processes of their own whatever a graph says, NUL-terminated UTF-8; `all`: each.
  const char *const *isolate;
  // Number of `isolate`.
  uint64_t isolate_count;
} tenon_engine_config;

// What is called when arrays that a host shares are free again.
typedef void (*tenon_release)(void *context);

// What an interface lists: its inputs or its outputs.
typedef uint32_t tenon_side_of_graph;

// How to evaluate. Set `size` to `sizeof(tenon_evaluate_options)` and the rest to 0 or NULL for the defaults.
typedef struct tenon_evaluate_options {
  // Bytes of this struct.
  uint32_t size;
  // 0.
  uint32_t flags;
  // Given to `progress` and `done` as it is.
  void *context;
  // Called at most about 30 times a second with the fraction done, 0 to 1, and the node at work, from threads of the
  // library, one call at a time. Giving 0 cancels. It must return soon and must not throw. It may call the library, but
  // what would wait for the evaluation that it stands in is refused.
  int32_t (*progress)(void *context, double fraction, tenon_str node);
  // For `tenon_graph_start` only: called once with the status of the result (or of the error) when the job has ended,
  // also when it was cancelled, from the job's own thread, after the last `progress`; not after `tenon_job_free` has
  // returned. It may call the library, take the result and free the job. It must not throw.
  void (*done)(void *context, tenon_status status);
} tenon_evaluate_options;

// What can be picked: a panel, a face, a curve or a point, and where it stands in the output.
typedef struct tenon_part {
  // Item in its branch.
  uint64_t item;
  // Branch of the output's tree.
  uint32_t branch;
  // Panel or face in the item; 0 for what has none.
  uint32_t element;
  // Its address; `TENON_NONE` three times for what has none.
  tenon_address address;
  // 0.
  uint32_t flags;
} tenon_part;

// An output as buffers for a viewport. Good until the result is freed; read-only. Faces have vertices of their own, so
// that their edges stay sharp; triangles are counter-clockwise seen from outside.
typedef struct tenon_preview {
  // Bytes of this struct; set it before the call.
  uint32_t size;
  // 0.
  uint32_t flags;
  // The node that made the output.
  tenon_str node;
  // Its port.
  tenon_str port;
  // Add it to a position to get the place in space, mm. Positions are about it, so that single precision is enough.
  tenon_vec3 origin;
  // Smallest coordinates in space, mm.
  tenon_vec3 low;
  // Largest coordinates in space, mm.
  tenon_vec3 high;
  // Three per vertex: x, y, z about the origin, mm.
  const float *positions;
  // Three per vertex: unit normal; 0 for vertices of lines and points.
  const float *normals;
  // One per vertex: its part.
  const uint32_t *vertex_parts;
  // Number of vertices.
  uint64_t vertex_count;
  // Three vertices per triangle.
  const uint32_t *triangles;
  // Number of triangles.
  uint64_t triangle_count;
  // Two vertices per line.
  const uint32_t *lines;
  // Number of lines.
  uint64_t line_count;
  // One vertex per point.
  const uint32_t *points;
  // Number of points.
  uint64_t point_count;
  // What can be picked.
  const struct tenon_part *parts;
  // Number of parts.
  uint64_t part_count;
} tenon_preview;

// What is wrong, and where. Texts are good until the result is freed; what is not known is empty.
typedef struct tenon_diagnostic {
  // Bytes of this struct; set it before the call.
  uint32_t size;
  // `TENON_NOTE`, `TENON_WARNING`, `TENON_ERROR`.
  tenon_severity severity;
  // A stable name in kebab-case.
  tenon_str code;
  // A sentence for people.
  tenon_str message;
  // What would fix it.
  tenon_str hint;
  // Node.
  tenon_str node;
  // Port of the node.
  tenon_str port;
  // Index of the item, or UINT64_MAX.
  uint64_t item;
} tenon_diagnostic;

// One node in an evaluation. Texts are good until the result is freed.
typedef struct tenon_node_report {
  // Bytes of this struct; set it before the call.
  uint32_t size;
  // 0.
  uint32_t flags;
  // What happened to it: "executed", "cut-off" (its inputs are the same as before), "memo" (its result was
  // remembered), "blocked", "failed", "frozen", "disabled"; later versions may add words.
  tenon_str happened;
  // Its id.
  tenon_str node;
  // Its node type.
  tenon_str type_name;
  // Time that it ran, ns.
  uint64_t nanoseconds;
  // Bytes of its outputs.
  uint64_t bytes;
} tenon_node_report;

// Inputs.
#define TENON_INPUTS 0

// Outputs.
#define TENON_OUTPUTS 1

#ifdef __cplusplus
extern "C" {
#endif // __cplusplus

// Version of this interface: major in the upper 16 bits, minor in the lower. Another major does not fit; a greater
// minor only adds. [any thread]
uint32_t tenon_version(void);

// Makes an engine with every built-in node type and those of plugins. `config` may be NULL. All plugins are loaded here,
// in this process unless `isolate` or the variable `TENON_PLUGIN_ISOLATION` says otherwise, so that their node types are
// known; where they are evaluated each graph says. Fails if an argument is wrong or a plugin of `plugins` is refused.
// [any thread]
struct tenon_error *tenon_engine_new(const struct tenon_engine_config *config,
                                     struct tenon_engine **out);

// Frees an engine. NULL and engines that were freed before do nothing. [any thread]
void tenon_engine_free(struct tenon_engine *engine);

// Describes a node type as JSON: name, doc, ports with type, unit, range and default; all node types as a list if
// `type_name` is NULL. Fails if there is no such node type. [any thread]
struct tenon_error *tenon_engine_describe(const struct tenon_engine *engine,
                                          const char *type_name,
                                          struct tenon_text **out);

// The kind of error, `TENON_BAD_ARGUMENT` and so on; `TENON_OK` for NULL. [any thread]
tenon_status tenon_error_status(const struct tenon_error *error);

// A sentence for people, good until the error is freed; empty for NULL. [any thread]
tenon_str tenon_error_message(const struct tenon_error *error);

// The node concerned, good until the error is freed; empty if there is none. [any thread]
tenon_str tenon_error_node(const struct tenon_error *error);

// Frees an error. NULL and errors that were freed before do nothing. [any thread]
void tenon_error_free(struct tenon_error *error);

// Number of handles of all kinds that were given and not freed yet: 0 at the end of a host that frees everything.
// [any thread]
uint64_t tenon_handle_count(void);

// Gives an interface input or a parameter (`node.port`) a value in memory: numbers, points, curves, meshes, panel sets
// and so on, a list or a tree with paths. Set `size` of every struct in it; `type_name` of columns is not read. Everything
// is copied, so the caller may change or free it after the call. It stands until the input is set otherwise; as it has no
// written form `tenon_graph_save` writes what the graph's text said before. Fails, with nothing changed, if the name is not
// known, the port has a wire or takes other types, or the value is not accepted. [any thread]
struct tenon_error *tenon_graph_give(struct tenon_graph *graph,
                                     const char *name,
                                     const tenon_tree *tree);

// The same without copying large arrays: the library reads where they are the items of lists of truth values, integers,
// numbers, points, vectors and planes, every array of curves, meshes and panel sets, the columns of tables, and what says
// which items are gaps. Structs, texts, features, lists of one such item, and bytes other than 0 and 1 that stand for truth
// values are copied. The arrays must stay as they are, unchanged, until `release(context)` is called, once: when the graph and
// all results that hold them have let go, or already in this call if all was copied. It is called from any thread, must not
// throw, and must not call the library. `release` may be NULL for arrays that live as long as the program. Fails as
// `tenon_graph_give` does; then `release` is not called. [any thread]
struct tenon_error *tenon_graph_share(struct tenon_graph *graph,
                                      const char *name,
                                      const tenon_tree *tree,
                                      tenon_release release,
                                      void *context);

// Loads a graph from the `length` bytes of a `*.tenon.json` file. `folder` is where files that nodes name are looked
// for; with NULL there are none. What it requires of plugins holds for it: versions, processes of their own, limits. Nodes
// that nobody knows or whose plugin is missing are kept as they stand, and evaluation tells what to install. Fails if the
// text is no graph, with line and column. [any thread]
struct tenon_error *tenon_graph_load(const struct tenon_engine *engine,
                                     const char *json,
                                     uint64_t length,
                                     const char *folder,
                                     struct tenon_graph **out);

// Frees a graph; results that it gave live on, and evaluations under way go on to their end. NULL and graphs that were
// freed before do nothing. [any thread]
void tenon_graph_free(struct tenon_graph *graph);

// The graph as text in the canonical form, with all values set so far. Fails if the graph is none. [any thread]
struct tenon_error *tenon_graph_save(const struct tenon_graph *graph,
                                     struct tenon_text **out);

// Gives an interface input or a parameter (`node.port`) the value that the JSON text says; `null` brings the default
// back. Nothing is evaluated, so many can be set at once; the same value as before costs nothing later. Fails, with
// nothing changed, if the name is not known, the port has a wire, or the value is not accepted. [any thread]
struct tenon_error *tenon_graph_set(struct tenon_graph *graph,
                                    const char *name,
                                    const char *json);

// The same with a number. Fails as that does, and if the number is not finite. [any thread]
struct tenon_error *tenon_graph_set_number(struct tenon_graph *graph, const char *name, double value);

// Adds a node. Fails if the id is taken or has a dot in it. A type that nobody knows is accepted: evaluation then says that
// it is missing. [any thread]
struct tenon_error *tenon_graph_add_node(struct tenon_graph *graph,
                                         const char *id,
                                         const char *type_name);

// Removes a node and the wires from it. Fails if there is no such node. [any thread]
struct tenon_error *tenon_graph_remove_node(struct tenon_graph *graph, const char *id);

// Wires `from` (`node.port`) to the input `port` of `node`, behind the wires that it has. Fails if one of the nodes is not
// there, `from` is no `node.port` or the wire is there already. What the wire's ends are is not looked at here: evaluation
// says what does not fit. [any thread]
struct tenon_error *tenon_graph_connect(struct tenon_graph *graph,
                                        const char *from,
                                        const char *node,
                                        const char *port);

// Takes a wire away. Fails if there is no such wire. [any thread]
struct tenon_error *tenon_graph_disconnect(struct tenon_graph *graph,
                                           const char *from,
                                           const char *node,
                                           const char *port);

// Describes the interface as JSON: a list of objects in order of their names, each with `name`, `ports` (`node.port`), `doc`,
// `unit`, `type` and `access` ("item", "list", "tree"); inputs besides with `min`, `max`, `choices` (the texts accepted; none:
// any), `default` and `value` (what is set, as a graph file says it). What the interface does not say is that of the first
// port behind it. What is not known is null. Fails if `side` is neither of the two. [any thread]
struct tenon_error *tenon_graph_interface(const struct tenon_graph *graph,
                                          tenon_side_of_graph side,
                                          struct tenon_text **out);

// Evaluates `count` outputs, each an interface output or `node.port`; with `count` 0 every interface output and every
// node that makes files. Only what changed runs. Waits until it is done, behind the evaluations that were asked for
// before. The result holds what the outputs come to for the graph as it stood at the call and stays as it is whatever
// happens to the graph later; the caller frees it. That nodes failed is no error of this call: the result says it. Fails if
// an argument is wrong. [any thread]
struct tenon_error *tenon_graph_evaluate(struct tenon_graph *graph,
                                         const char *const *outputs,
                                         uint64_t count,
                                         const struct tenon_evaluate_options *options,
                                         struct tenon_result **out);

// Starts the same on a thread of its own and returns at once. The job is of the graph as it stands at this call: what is
// set and edited from then on is for later evaluations. Jobs of one graph run one after another. A host that follows a
// slider cancels the job before and starts the next. Fails if an argument is wrong or the system gives no thread
// (`TENON_FAILED`); then no callback comes. [any thread]
struct tenon_error *tenon_graph_start(struct tenon_graph *graph,
                                      const char *const *outputs,
                                      uint64_t count,
                                      const struct tenon_evaluate_options *options,
                                      struct tenon_job **out);

// Waits for a job, `milliseconds` at most: 0 only looks, UINT64_MAX waits as long as it takes. Writes a result, which the
// caller frees, or NULL if the job has not ended by then. Every call after its end gives the result again. Fails if the
// job is none, if its own callback would wait for it, or, with `TENON_INTERNAL`, if the evaluation met a fault of the
// library. [any thread]
struct tenon_error *tenon_job_wait(const struct tenon_job *job,
                                   uint64_t milliseconds,
                                   struct tenon_result **out);

// How far a job is, 0 to 1; 1 when it has ended, NaN for what is no job. [any thread]
double tenon_job_progress(const struct tenon_job *job);

// Asks a job to stop: if it has not ended by itself its result says that it was cancelled. [any thread]
void tenon_job_cancel(const struct tenon_job *job);

// Frees a job; one that has not ended is cancelled. When this returns no callback of it runs or comes any more, except
// where it is called from one of them. Results live on. NULL and jobs that were freed before do nothing. [any thread]
void tenon_job_free(struct tenon_job *job);

// Stops the evaluations of this graph that run or wait for their turn: their results say that they were cancelled, and
// the graph is as it was before. [any thread, also while the graph is evaluated]
void tenon_graph_cancel(const struct tenon_graph *graph);

// Fills `out` with what an output looks like: panels as solids, meshes, polygons, curves and points; of other types
// there is nothing to see, which is no error. Made at the first call for an output and kept with the result. Set
// `out->size` before. Fails if there is no such output. [any thread]
struct tenon_error *tenon_result_preview(const struct tenon_result *result,
                                         const char *name,
                                         struct tenon_preview *out);

// Frees a result and with it everything that was read from it. NULL and results that were freed before do nothing.
// [any thread]
void tenon_result_free(struct tenon_result *result);

// `TENON_OK`, `TENON_FAILED` if a diagnostic is an error, or `TENON_CANCELLED`; `TENON_BAD_ARGUMENT` for what is no result.
// [any thread]
tenon_status tenon_result_status(const struct tenon_result *result);

// Fills `out` with an output that was asked for. Nothing is copied; the arrays are read-only and good until the result
// is freed. Set `out->size` before. Fails if there is no such output. [any thread]
struct tenon_error *tenon_result_output(const struct tenon_result *result,
                                        const char *name,
                                        tenon_tree *out);

// An output as JSON, for types that do not cross as C structs and for looking at values. Fails if there is no such output
// or it was not asked for. [any thread]
struct tenon_error *tenon_result_json(const struct tenon_result *result,
                                      const char *name,
                                      struct tenon_text **out);

// Number of diagnostics; 0 for a result that is no result. [any thread]
uint64_t tenon_result_diagnostic_count(const struct tenon_result *result);

// Fills `out` with diagnostic `index`. Set `out->size` before. Fails if there are not so many. [any thread]
struct tenon_error *tenon_result_diagnostic(const struct tenon_result *result,
                                            uint64_t index,
                                            struct tenon_diagnostic *out);

// Number of nodes that were looked at. [any thread]
uint64_t tenon_result_node_count(const struct tenon_result *result);

// Fills `out` with node `index`, in order of evaluation. Set `out->size` before. Fails if there are not so many.
// [any thread]
struct tenon_error *tenon_result_node(const struct tenon_result *result,
                                      uint64_t index,
                                      struct tenon_node_report *out);

// Makes one with an engine's node types and settings. Fails if the engine is none. [any thread]
struct tenon_error *tenon_sweep_new(const struct tenon_engine *engine, struct tenon_sweep **out);

// Frees one. NULL and those that were freed before do nothing. [any thread]
void tenon_sweep_free(struct tenon_sweep *sweep);

// Evaluates a row, a line of a plan that `tenon sweep plan` has made and that lies in `folder`, and writes its result as
// `results/KEY` whole or not at all, as `tenon sweep run-row` does; a result that is there and whole is left as it is.
// Writes its `result.json`, or NULL if `progress` has cancelled. Many processes and machines may do so in one folder. Fails
// if the line is no row, the graph is another than when it was planned, an input refuses a value or the result cannot be
// written; that nodes failed stands in the result. [any thread]
struct tenon_error *tenon_sweep_row(struct tenon_sweep *sweep,
                                    const char *line,
                                    const char *folder,
                                    const char *results,
                                    const struct tenon_evaluate_options *options,
                                    struct tenon_text **out);

// The text, good until it is freed; empty for NULL or a freed one. [any thread]
tenon_str tenon_text_get(const struct tenon_text *text);

// Frees a text. NULL and texts that were freed before do nothing. [any thread]
void tenon_text_free(struct tenon_text *text);

#ifdef __cplusplus
}  // extern "C"
#endif  // __cplusplus

#endif  /* TENON_H */
