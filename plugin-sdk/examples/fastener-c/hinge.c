/* A fastener in C: hinges along edges. Each hinge is screwed to the face that lies up on the machine, beside the edge:
   two pilot holes in either panel. See README.md; the contract is in tenon_plugin.h. */
#include "tenon_plugin.h"
#include <math.h>
#include <string.h>

#define TEXT(s) {s, sizeof(s) - 1}
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

typedef tenon_vec3 vec;

static vec add(vec a, vec b, double scale) {
    vec sum = {a.x + scale * b.x, a.y + scale * b.y, a.z + scale * b.z};
    return sum;
}
static double dot(vec a, vec b) { return a.x * b.x + a.y * b.y + a.z * b.z; }
static vec cross(vec a, vec b) {
    vec c = {a.y * b.z - a.z * b.y, a.z * b.x - a.x * b.z, a.x * b.y - a.y * b.x};
    return c;
}
static vec unit(vec a) {
    double length = sqrt(dot(a, a));
    vec zero = {0, 0, 0};
    return length > 0 ? add(zero, a, 1 / length) : zero;
}

static double number(const tenon_tree *tree) { return *(const double *)tree->branches[0].column.items; }

static tenon_status fail(const tenon_call *call, const char *code, const char *message, const char *port) {
    tenon_message m = {sizeof m, TENON_ERROR, {code, strlen(code)}, {message, strlen(message)}, {NULL, 0},
                       {port, strlen(port)}, UINT64_MAX};
    call->tell(call, &m);
    return TENON_FAILED;
}

/* The edge of one panel on the face that lies up: from, to, the face's normal, and the direction into the panel. */
typedef struct face_edge {
    vec from, to, normal, inward;
} face_edge;

static face_edge edge_on(const tenon_panels *p, tenon_edge e, int back) {
    uint32_t first = p->corner_start[e.panel], count = p->corner_start[e.panel + 1] - first;
    uint32_t k = first + e.edge, next = first + (e.edge + 1) % count;
    face_edge f;
    f.from = back ? p->back_start[k] : p->front[k];
    f.to = back ? p->back_end[k] : p->front[next];
    f.normal = p->normal[e.panel];
    f.inward = unit(cross(f.normal, add(f.to, f.from, -1)));
    if (back) {
        vec zero = {0, 0, 0};
        f.normal = add(zero, f.normal, -1);
    }
    return f;
}

enum { PANELS, EDGES, UP, SPACING, SETBACK, GAUGE, DEPTH, DIAMETER, INPUTS };

static tenon_status evaluate(void *data, const tenon_call *call, const tenon_tree *in, uint32_t count) {
    (void)data;
    if (count != INPUTS) return TENON_BAD_ARGUMENT;
    const tenon_panels *panels = in[PANELS].branches[0].column.items;
    const tenon_edge_pair *edges = in[EDGES].branches[0].column.items;
    uint64_t edge_count = in[EDGES].branches[0].column.count;
    tenon_str up = *(const tenon_str *)in[UP].branches[0].column.items;
    int back = up.len == 4 && memcmp(up.ptr, "back", 4) == 0;
    double spacing = number(&in[SPACING]), setback = number(&in[SETBACK]), gauge = number(&in[GAUGE]);
    double depth = number(&in[DEPTH]), diameter = number(&in[DIAMETER]);
    if (depth >= panels->thickness) return fail(call, "hinge-too-deep", "the holes would go through the panel", "depth");

    /* How many hinges, and room for their holes: two in either panel. */
    uint64_t hinges = 0;
    for (uint64_t i = 0; i < edge_count; i++) {
        vec d = add(edges[i].end, edges[i].start, -1);
        hinges += (uint64_t)fmax(1, floor(sqrt(dot(d, d)) / spacing));
    }
    /* A feature is a struct of its own, so the room is taken from a buffer of bytes, which the host frees. */
    tenon_feature *features = call->buffer(call, TENON_F64, (hinges * 4 + 1) * (sizeof(tenon_feature) / sizeof(double) + 1));
    if (features == NULL) return TENON_NO_MEMORY;
    uint64_t made = 0, laid = 0;
    uint32_t joint = 0;
    for (uint64_t i = 0; i < edge_count; i++) {
        if (call->cancelled(call)) return TENON_CANCELLED;
        if (edges[i].second.panel == TENON_NONE) continue; /* nothing to hinge to */
        vec d = add(edges[i].end, edges[i].start, -1);
        double length = sqrt(dot(d, d));
        uint64_t n = (uint64_t)fmax(1, floor(length / spacing));
        for (uint64_t h = 0; h < n; h++) {
            double t = (h + 0.5) / n;
            for (int side = 0; side < 2; side++) {
                tenon_edge e = side ? edges[i].second : edges[i].first;
                face_edge f = edge_on(panels, e, back);
                /* The neighbour's edge runs the other way. */
                vec at = add(f.from, add(f.to, f.from, -1), side ? 1 - t : t);
                vec along = unit(add(f.to, f.from, -1)), zero = {0, 0, 0};
                for (int hole = -1; hole <= 1; hole += 2) {
                    tenon_feature x;
                    memset(&x, 0, sizeof x);
                    x.size = sizeof x;
                    x.kind = TENON_DRILL;
                    x.panel = e.panel;
                    x.edge = e.edge;
                    x.joint = joint;
                    x.at = add(add(at, f.inward, setback), along, hole * gauge / 2);
                    x.axis = add(zero, f.normal, -1);
                    x.depth = depth;
                    x.width = diameter;
                    x.purpose.ptr = "hinge";
                    x.purpose.len = 5;
                    features[made++] = x;
                }
            }
            joint++;
            laid++;
        }
    }
    tenon_hardware hardware[] = {{TEXT("Butt hinge 40 x 40"), laid}, {TEXT("Screw 3 x 10"), 4 * laid}};
    tenon_features all = {sizeof all, sizeof(tenon_feature), features, made, hardware, laid > 0 ? COUNT(hardware) : 0};
    tenon_branch branch;
    memset(&branch, 0, sizeof branch);
    branch.column.size = sizeof branch.column;
    branch.column.kind = TENON_FEATURES;
    branch.column.items = &all;
    branch.column.count = 1;
    branch.column.stride = sizeof all;
    tenon_tree tree = {sizeof tree, sizeof branch, &branch, 1};
    return call->set(call, 0, &tree) == TENON_OK ? TENON_OK : TENON_FAILED;
}

#define MM(name, doc, value, least, most)                                                                                \
    {sizeof(tenon_port), TENON_RANGE, TENON_NUMBER, TENON_ITEM, TEXT(name), TEXT(doc), TEXT("mm"), TEXT(value), least,   \
     most, NULL, 0}

static const tenon_port inputs[] = {
    MM("spacing", "One hinge for every so much of an edge, and one at least.", "200", 20, 1e4),
    MM("setback", "Distance of the holes from the edge.", "14", 1, 1e3),
    MM("gauge", "Distance between the two holes of a leaf.", "25", 1, 1e3),
    MM("depth", "Depth of the holes.", "7", 1, 100),
    MM("diameter", "Diameter of the holes.", "3", 1, 20),
};

static const tenon_node_type nodes[] = {{
    .size = sizeof(tenon_node_type),
    .flags = TENON_PURE | TENON_FASTENER,
    .id = TEXT("hinges.butt_hinge"),
    .version = 1,
    .input_count = COUNT(inputs),
    .inputs = inputs,
    .port_stride = sizeof(tenon_port),
    .name = TEXT("Butt hinge"),
    .category = TEXT("Joint"),
    .doc = TEXT("Hinges along edges, screwed to the face that lies up on the machine: two pilot holes in either panel."),
    .keywords = TEXT("hinge, folding, fastener"),
    .evaluate = evaluate,
}};

static const tenon_plugin plugin = {
    .magic = TENON_PLUGIN_MAGIC,
    .size = sizeof(tenon_plugin),
    .abi_major = TENON_PLUGIN_MAJOR,
    .abi_minor = TENON_PLUGIN_MINOR,
    .id = TEXT("hinges"),
    .version = TEXT("1.0.0"),
    .vendor = TEXT("Tenon's examples"),
    .doc = TEXT("Hinges between panels."),
    .nodes = nodes,
    .node_count = COUNT(nodes),
    .node_stride = sizeof(tenon_node_type),
};

TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
const tenon_plugin *tenon_plugin_v1(void) { return &plugin; }
