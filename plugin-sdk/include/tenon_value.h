// Values of Tenon as they cross to plugins and hosts. Lengths are mm, angles radians.
// Generated from the Rust source; do not edit.

#ifndef TENON_VALUE_H
#define TENON_VALUE_H

#include <stdbool.h>
#include <stdint.h>

// No panel, edge or joint.
#define TENON_NONE 4294967295

// What a function came to: `TENON_OK`, `TENON_CANCELLED` or an error, which is negative.
typedef int32_t tenon_status;

// How bad a diagnostic is.
typedef uint32_t tenon_severity;

// What the items of a column are; each constant names the C type of one item.
typedef uint32_t tenon_kind;

// The grid side of an edge: `TENON_SIDE_*`.
typedef uint8_t tenon_side;

// What a feature is: `TENON_DRILL` and so on.
typedef uint32_t tenon_machining;

// UTF-8 text of `len` bytes, not NUL-terminated. `ptr` may be NULL when `len` is 0.
typedef struct tenon_str {
  // First byte.
  const char *ptr;
  // Number of bytes.
  uint64_t len;
} tenon_str;

// Three coordinates, mm where they are lengths.
typedef struct tenon_vec3 {
  // X.
  double x;
  // Y.
  double y;
  // Z.
  double z;
} tenon_vec3;

// A homogeneous point: the place in space is (x / w, y / w, z / w), w > 0. Plain polylines have w = 1.
typedef struct tenon_vec4 {
  // W times X.
  double x;
  // W times Y.
  double y;
  // W times Z.
  double z;
  // Weight.
  double w;
} tenon_vec4;

// An oriented plane, `normal . p = offset`; `normal` has length 1.
typedef struct tenon_plane {
  // Unit normal.
  struct tenon_vec3 normal;
  // Signed distance of the origin's foot point along the normal, mm.
  double offset;
} tenon_plane;

// Where a face or panel stands: row from the bottom, column from the left, both from 0.
typedef struct tenon_address {
  // Grid patch, 0 on a plain grid.
  uint32_t patch;
  // Row.
  uint32_t row;
  // Column.
  uint32_t column;
} tenon_address;

// One edge of one panel; both are `TENON_NONE` where there is none.
typedef struct tenon_edge {
  // Panel index.
  uint32_t panel;
  // Edge index in the panel, from 0.
  uint32_t edge;
} tenon_edge;

// A curve: one polyline, or several strips.
typedef struct tenon_curve {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // 1 if the last point is joined to the first (then there is one strip).
  uint32_t closed;
  // Points of all strips in drawing order.
  const struct tenon_vec4 *points;
  // Number of points.
  uint64_t point_count;
  // First point of each strip, then `point_count`: `strip_count + 1` entries. NULL means one strip.
  const uint32_t *strip_start;
  // Number of strips.
  uint64_t strip_count;
} tenon_curve;

// A polygon mesh; loops are counter-clockwise seen from the front.
typedef struct tenon_mesh {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // 0.
  uint32_t flags;
  // Vertices, mm.
  const struct tenon_vec3 *points;
  // Number of vertices.
  uint64_t point_count;
  // Where each face's loop starts in `face_vertices`, then its end: `face_count + 1` entries.
  const uint32_t *face_start;
  // Number of faces.
  uint64_t face_count;
  // Vertex indices of all loops.
  const uint32_t *face_vertices;
  // Number of entries in `face_vertices`.
  uint64_t face_vertex_count;
  // One per face; NULL if the mesh is not ordered.
  const struct tenon_address *addresses;
} tenon_mesh;

// Panels as columns. Per-corner columns, equally per-edge ones, are indexed by `corner_start[panel] + k`: edge k runs
// from corner k to corner k + 1. A panel that could not be made has no corners and stays at its index.
typedef struct tenon_panels {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // 0.
  uint32_t flags;
  // Thickness of every panel, mm.
  double thickness;
  // Number of panels, failed ones included.
  uint64_t panel_count;
  // Number of corners of all panels.
  uint64_t corner_count;
  // First corner of each panel, then `corner_count`: `panel_count + 1` entries.
  const uint32_t *corner_start;
  // Per panel.
  const struct tenon_address *address;
  // Per panel: unit normal of the front face, away from the wood.
  const struct tenon_vec3 *normal;
  // Per corner: on the front face, counter-clockwise seen from the front, mm.
  const struct tenon_vec3 *front;
  // Per corner: its vertex in the mesh.
  const uint32_t *vertex;
  // Per edge: its chamfer's plane, normal away from the wood.
  const struct tenon_plane *chamfer;
  // Per edge: the edge across it, or `TENON_NONE` at the border and beside failed panels.
  const struct tenon_edge *neighbour;
  // Per edge: `TENON_SIDE_*`.
  const uint8_t *side;
  // Per edge: where it starts on the back face, mm.
  const struct tenon_vec3 *back_start;
  // Per edge: where it ends on the back face, mm.
  const struct tenon_vec3 *back_end;
  // Per corner: 1 if the node is voided there.
  const uint8_t *voided;
} tenon_panels;

// One machining feature on one panel, in the coordinates of the panels. What a kind does not name is 0, NULL or empty.
typedef struct tenon_feature {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // `TENON_DRILL` and so on.
  tenon_machining kind;
  // Panel index.
  uint32_t panel;
  // Edge that it belongs to, or `TENON_NONE`.
  uint32_t edge;
  // Number shared by the features that must meet in space, or `TENON_NONE`.
  uint32_t joint;
  // 1: it is made by hand, because the machine cannot.
  uint32_t by_hand;
  // Entry, start or origin, mm.
  struct tenon_vec3 at;
  // End of a slot, mm; reading direction of an engraving.
  struct tenon_vec3 to;
  // Unit direction into the wood.
  struct tenon_vec3 axis;
  // Depth along `axis`, mm.
  double depth;
  // Diameter, width or glyph height, mm.
  double width;
  // Outline or line, mm.
  const struct tenon_vec3 *line;
  // Points of `line`.
  uint64_t line_count;
  // Text of an engraving.
  struct tenon_str text;
  // What it is for, in a few words: "toe screw", "hinge".
  struct tenon_str purpose;
} tenon_feature;

// Purchased parts by name.
typedef struct tenon_hardware {
  // Trade name with size, as on the piece list.
  struct tenon_str name;
  // How many.
  uint64_t count;
} tenon_hardware;

// Features of a panel set, ordered by panel, and the hardware that they take.
typedef struct tenon_features {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // Bytes from one feature to the next.
  uint32_t feature_stride;
  // Features.
  const struct tenon_feature *features;
  // Number of features.
  uint64_t feature_count;
  // Hardware.
  const struct tenon_hardware *hardware;
  // Number of entries in `hardware`.
  uint64_t hardware_count;
} tenon_features;

// A file that the graph made and that the host may write.
typedef struct tenon_file {
  // Name relative to an output folder.
  struct tenon_str name;
  // Content.
  const uint8_t *bytes;
  // Number of bytes.
  uint64_t byte_count;
  // Why it must not get its name unless a person insists; empty: it may.
  struct tenon_str withheld;
} tenon_file;

// An edge that a fastener is asked to join, seen from the panel that comes first (it holds a screw's head).
typedef struct tenon_edge_pair {
  // The first panel's edge.
  struct tenon_edge first;
  // The second panel's edge; `TENON_NONE` at the border.
  struct tenon_edge second;
  // Where the edge starts on the first panel's front face, mm.
  struct tenon_vec3 start;
  // Where it ends.
  struct tenon_vec3 end;
  // Angle between the two panels' wood, radians; pi where they lie in one plane, 0 at the border.
  double angle;
} tenon_edge_pair;

// Items of one type. Gaps, which items that failed upstream leave, keep their index.
typedef struct tenon_column {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // `TENON_NUMBER` and so on.
  tenon_kind kind;
  // Name of the type in graph files.
  struct tenon_str type_name;
  // The items, `stride` bytes apart; NULL if there are none or the kind is `TENON_OPAQUE`. What stands in a gap means
  // nothing, but lengths and pointers in it must be good.
  const void *items;
  // Number of items, gaps included.
  uint64_t count;
  // Bytes from one item to the next.
  uint64_t stride;
  // Per item 1, or 0 for a gap; NULL if there are no gaps.
  const uint8_t *valid;
} tenon_column;

// One attribute of every row of a table.
typedef struct tenon_attribute {
  // Its name, once in a table.
  struct tenon_str name;
  // One item per row: of a kind up to `TENON_PLANE`, or `TENON_OPAQUE`.
  struct tenon_column column;
} tenon_attribute;

// A table of attributes: columns of as many rows, each under a name. Since 1.1.
typedef struct tenon_table {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // Bytes from one attribute to the next.
  uint32_t attribute_stride;
  // Number of rows.
  uint64_t row_count;
  // Attributes.
  const struct tenon_attribute *attributes;
  // Number of attributes.
  uint64_t attribute_count;
} tenon_table;

// A column and where it hangs in its tree.
typedef struct tenon_branch {
  // Its path; NULL means {0}.
  const int32_t *path;
  // Steps of the path.
  uint64_t path_count;
  // Its items.
  struct tenon_column column;
} tenon_branch;

// What flows on a wire: branches sorted by path. A single item is one branch of one item. Trees lie side by side, so
// that this struct alone never grows, though its branches may.
typedef struct tenon_tree {
  // Bytes of this struct as its maker knows it.
  uint32_t size;
  // Bytes from one branch to the next.
  uint32_t branch_stride;
  // Branches.
  const struct tenon_branch *branches;
  // Number of branches.
  uint64_t branch_count;
} tenon_tree;

// All is well.
#define TENON_OK 0

// It stopped because it was asked to.
#define TENON_CANCELLED 1

// An argument is NULL, misaligned, out of range or not UTF-8.
#define TENON_BAD_ARGUMENT -1

// A value is not of the type that stands here.
#define TENON_BAD_TYPE -2

// The computation failed; diagnostics say why.
#define TENON_FAILED -3

// No memory.
#define TENON_NO_MEMORY -4

// This version does not do that.
#define TENON_UNSUPPORTED -5

// A fault of the program itself, such as a panic that was caught.
#define TENON_INTERNAL -6

// Worth knowing.
#define TENON_NOTE 0

// The result stands but may not be what was meant.
#define TENON_WARNING 1

// Something is missing from the result.
#define TENON_ERROR 2

// No items, so no type.
#define TENON_NOTHING 0

// `uint8_t`, 0 or 1.
#define TENON_BOOLEAN 1

// `int64_t`.
#define TENON_INTEGER 2

// `double`.
#define TENON_NUMBER 3

// `tenon_str`.
#define TENON_TEXT 4

// `tenon_vec3`, mm.
#define TENON_POINT 5

// `tenon_vec3`.
#define TENON_VECTOR 6

// `tenon_plane`.
#define TENON_PLANE 7

// `tenon_curve`.
#define TENON_CURVE 8

// `tenon_mesh`.
#define TENON_MESH 9

// `tenon_panels`.
#define TENON_PANELS 10

// `tenon_features`.
#define TENON_FEATURES 11

// `tenon_file`.
#define TENON_FILE 12

// `tenon_edge_pair`: edges selected for a fastener.
#define TENON_EDGES 13

// `tenon_table`. Since 1.1.
#define TENON_TABLE 14

// A type that does not cross: `items` is NULL, `type_name` says what it is.
#define TENON_OPAQUE 65536

// Towards the row below.
#define TENON_SIDE_BOTTOM 0

// Towards the next column.
#define TENON_SIDE_RIGHT 1

// Towards the row above.
#define TENON_SIDE_TOP 2

// Towards the column before.
#define TENON_SIDE_LEFT 3

// The mesh is no grid.
#define TENON_SIDE_OTHER 4

// A round hole: `at` its entry, `axis`, `depth`, `width` its diameter.
#define TENON_DRILL 0

// A slot of rectangular section: floor line `at` to `to`, `axis`, `width`, `depth`.
#define TENON_SLOT 1

// A pocket with flat floor: outline `line` on the surface, counter-clockwise seen against `axis`; `depth`.
#define TENON_POCKET 2

// A cut through along the polyline `line` on the surface; `axis`.
#define TENON_CONTOUR 3

// `text` in single strokes: `at` lower left, `to` unit reading direction, `axis`, `width` glyph height, `depth`.
#define TENON_ENGRAVING 4

#endif  /* TENON_VALUE_H */
