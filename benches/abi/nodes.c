/* Node types that do nearly nothing, so that what they cost is the contract: measured by `cargo xtask bench abi`. */
#define _DEFAULT_SOURCE
#include "tenon_plugin.h"
#include <string.h>
#include <time.h>

#define TEXT(s) {s, sizeof(s) - 1}

static tenon_status give(const tenon_call *call, tenon_kind kind, const void *items, uint64_t count, uint64_t stride) {
    tenon_branch branch;
    memset(&branch, 0, sizeof branch);
    branch.column.size = sizeof branch.column;
    branch.column.kind = kind;
    branch.column.items = items;
    branch.column.count = count;
    branch.column.stride = stride;
    tenon_tree tree = {sizeof tree, sizeof branch, &branch, 1};
    return call->set(call, 0, &tree);
}

#define EVALUATE(name)                                                                                                   \
    static tenon_status name(void *data, const tenon_call *call, const tenon_tree *in, uint32_t count)

/* Nothing at all: the call alone. */
EVALUATE(nothing) {
    (void)data, (void)call, (void)in, (void)count;
    return TENON_OK;
}
/* A number in, a number out. */
EVALUATE(number) {
    (void)data, (void)count;
    double y = *(const double *)in[0].branches[0].column.items + 1;
    return give(call, TENON_NUMBER, &y, 1, sizeof y);
}
/* Asks as often as the number says whether it is to stop. */
EVALUATE(polls) {
    (void)data, (void)count;
    double times = *(const double *)in[0].branches[0].column.items;
    double asked = 0;
    while (asked < times && !call->cancelled(call)) asked++;
    return give(call, TENON_NUMBER, &asked, 1, sizeof asked);
}
static double milliseconds(void) {
    struct timespec now;
    clock_gettime(CLOCK_MONOTONIC, &now);
    return now.tv_sec * 1e3 + now.tv_nsec / 1e6;
}
/* Points in, as many out: a buffer of which nothing is written but the first point: the input's address, the buffer's,
   and how long the host took to give it, ms. */
EVALUATE(points) {
    (void)data, (void)count;
    const tenon_column *points = &in[0].branches[0].column;
    double start = milliseconds();
    tenon_vec3 *out = call->buffer(call, TENON_VEC3, points->count);
    if (out == NULL) return TENON_NO_MEMORY;
    tenon_vec3 seen = {(double)(uintptr_t)points->items, (double)(uintptr_t)out, milliseconds() - start};
    out[0] = seen;
    return give(call, TENON_POINT, out, points->count, sizeof *out);
}

#define PORT(kind, access, name) {sizeof(tenon_port), 0, kind, access, TEXT(name), TEXT("A value."), TEXT(""), TEXT(""), 0, 0, NULL, 0}
static const tenon_port numbers[] = {PORT(TENON_NUMBER, TENON_ITEM, "x")};
static const tenon_port lists[] = {PORT(TENON_POINT, TENON_LIST, "x")};

#define TYPE(function, ports)                                                                                            \
    {.size = sizeof(tenon_node_type), .flags = TENON_PURE, .id = TEXT("abi." #function), .version = 1, .input_count = 1, \
     .inputs = ports, .outputs = ports, .output_count = 1, .port_stride = sizeof(tenon_port), .name = TEXT(#function),   \
     .category = TEXT("Bench"), .doc = TEXT("Nearly nothing."), .keywords = TEXT(""), .evaluate = function}
static const tenon_node_type nodes[] = {TYPE(nothing, numbers), TYPE(number, numbers), TYPE(polls, numbers), TYPE(points, lists)};

static const tenon_plugin plugin = {TENON_PLUGIN_MAGIC, sizeof(tenon_plugin), TENON_PLUGIN_MAJOR, TENON_PLUGIN_MINOR,
                                    TEXT("abi"), TEXT("1.0.0"), TEXT("Tenon"), TEXT("What the contract costs."), nodes, 4,
                                    sizeof(tenon_node_type), NULL};

TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
const tenon_plugin *tenon_plugin_v1(void) { return &plugin; }
