/* A plugin that gives what cannot be, one fault per number, and nodes of older versions. The tests name what is said. */
#include "tenon_plugin.h"
#include <string.h>

#define TEXT(s) {s, sizeof(s) - 1}

static tenon_status evaluate(void *data, const tenon_call *call, const tenon_tree *in, uint32_t count) {
    (void)data, (void)count;
    int fault = (int)*(const double *)in[0].branches[0].column.items;
    double numbers[4] = {1, 2, 3, 4};
    tenon_str bad_text[] = {TEXT("\xff\xfe")};
    tenon_vec3 corners[3] = {{0, 0, 0}, {1, 0, 0}, {0, 1, 0}};
    uint32_t starts[] = {0, 3}, falls[] = {0, 4}, three[] = {0, 1, 2}, far[] = {0, 1, 9};
    tenon_mesh mesh = {sizeof mesh, 0, corners, 3, starts, 1, three, 3, NULL};
    tenon_feature feature;
    memset(&feature, 0, sizeof feature);
    feature.size = sizeof feature;
    feature.kind = 9;
    tenon_features features = {sizeof features, sizeof feature, &feature, 1, NULL, 0};
    tenon_branch branch;
    memset(&branch, 0, sizeof branch);
    branch.column.size = sizeof branch.column;
    branch.column.kind = TENON_NUMBER;
    branch.column.items = numbers;
    branch.column.count = 1;
    branch.column.stride = sizeof(double);
    tenon_tree tree = {sizeof tree, sizeof branch, &branch, 1};
    const tenon_tree *value = &tree;
    uint32_t output = 0;
    switch (fault) {
    case 1: branch.column.items = NULL; break;
    case 2: branch.column.items = (const char *)numbers + 1; break;
    case 3: branch.column.count = UINT64_C(1) << 60; branch.column.stride = 8; break;
    case 4: branch.column.stride = 4; break;
    case 5: branch.column.kind = 99; break;
    case 6: branch.column.kind = TENON_TEXT; branch.column.items = bad_text; branch.column.stride = sizeof(tenon_str); break;
    case 7: tree.size = 0; break;
    case 8: tree.branch_stride = 3; break;
    case 9: tree.branches = NULL; break;
    case 10: value = NULL; break;
    case 11: value = (const tenon_tree *)(uintptr_t)((uintptr_t)value + 1); break;
    case 12: output = 7; break;
    case 13: branch.column.kind = TENON_MESH; branch.column.items = &mesh; branch.column.stride = sizeof mesh; mesh.face_start = falls; break;
    case 14: branch.column.kind = TENON_MESH; branch.column.items = &mesh; branch.column.stride = sizeof mesh; mesh.face_vertices = far; break;
    case 15: branch.column.kind = TENON_FEATURES; branch.column.items = &features; branch.column.stride = sizeof features; break;
    case 16: call->tell(call, NULL); break;
    case 17: call->forward(call, 0, 5); return TENON_OK;
    case 18: call->tell(call, (const tenon_message *)(uintptr_t)((uintptr_t)numbers + 4)); break;
    case 19: return -77;
    case 20: branch.path = (const int32_t *)(uintptr_t)((uintptr_t)three + 1); branch.path_count = 1; break;
    case 21: call->buffer(call, 99, 1) ? (void)0 : (void)(value = NULL); break;
    case 22: branch.column.valid = NULL; branch.column.kind = TENON_NOTHING; break;
    default: break;
    }
    return call->set(call, output, value) == TENON_OK ? TENON_OK : TENON_FAILED;
}

/* From version 1 to 2 the input "old" became "x"; from 2 to 3 nothing changed, but what is stuck stays. */
static tenon_status migrate(void *data, uint32_t from, tenon_str node, void (*give)(void *, tenon_str), void *to) {
    char text[4096];
    tenon_str new = {text, 0};
    (void)data;
    if (node.len >= sizeof text) return TENON_FAILED;
    for (uint64_t i = 0; i < node.len; i++) {
        if (from == 1 && node.len - i >= 5 && memcmp(node.ptr + i, "\"old\"", 5) == 0) {
            memcpy(text + new.len, "\"x\"", 3);
            new.len += 3;
            i += 4;
        } else if (node.len - i >= 5 && memcmp(node.ptr + i, "stuck", 5) == 0) {
            tenon_str why = TEXT("it is stuck");
            give(to, why);
            return TENON_FAILED;
        } else {
            text[new.len++] = node.ptr[i];
        }
    }
    give(to, new);
    return TENON_OK;
}

/* A table as it is, with its rows numbered. */
static tenon_status number_rows(void *data, const tenon_call *call, const tenon_tree *in, uint32_t count) {
    const tenon_table *table = in[0].branches[0].column.items;
    tenon_attribute attributes[8];
    tenon_str name = TEXT("row");
    (void)data, (void)count;
    if (table->attribute_count > 7) return TENON_FAILED;
    for (uint64_t i = 0; i < table->attribute_count; i++)
        attributes[i] = *(const tenon_attribute *)((const char *)table->attributes + i * table->attribute_stride);
    int64_t *rows = call->buffer(call, TENON_I64, table->row_count);
    if (rows == NULL) return TENON_NO_MEMORY;
    for (uint64_t i = 0; i < table->row_count; i++) rows[i] = (int64_t)i;
    tenon_column column = {sizeof column, TENON_INTEGER, TEXT("integer"), rows, table->row_count, 8, NULL};
    attributes[table->attribute_count].name = name;
    attributes[table->attribute_count].column = column;
    tenon_table out = {sizeof out, sizeof(tenon_attribute), table->row_count, attributes, table->attribute_count + 1};
    tenon_branch branch;
    memset(&branch, 0, sizeof branch);
    branch.column.size = sizeof branch.column;
    branch.column.kind = TENON_TABLE;
    branch.column.items = &out;
    branch.column.count = 1;
    branch.column.stride = sizeof out;
    tenon_tree tree = {sizeof tree, sizeof branch, &branch, 1};
    return call->set(call, 0, &tree) == TENON_OK ? TENON_OK : TENON_FAILED;
}

static const tenon_port tables[] = {
    {sizeof(tenon_port), 0, TENON_TABLE, TENON_ITEM, TEXT("table"), TEXT("A table."), TEXT(""), TEXT(""), 0, 0, NULL, 0}};
static const tenon_port inputs[] = {
    {sizeof(tenon_port), 0, TENON_NUMBER, TENON_ITEM, TEXT("x"), TEXT("Which fault."), TEXT(""), TEXT("0"), 0, 0, NULL, 0}};
static const tenon_port outputs[] = {
    {sizeof(tenon_port), 0, TENON_NUMBER, TENON_ITEM, TEXT("y"), TEXT("A number."), TEXT(""), TEXT(""), 0, 0, NULL, 0}};
static const tenon_node_type nodes[] = {{.size = sizeof(tenon_node_type),
                                         .flags = TENON_PURE,
                                         .id = TEXT("faulty.value"),
                                         .version = 3,
                                         .input_count = 1,
                                         .inputs = inputs,
                                         .outputs = outputs,
                                         .output_count = 1,
                                         .port_stride = sizeof(tenon_port),
                                         .name = TEXT("Value"),
                                         .category = TEXT("Faults"),
                                         .doc = TEXT("Gives what cannot be."),
                                         .evaluate = evaluate,
                                         .migrate = migrate,
                                         .migrate_from = 1},
                                        {.size = sizeof(tenon_node_type),
                                         .flags = TENON_PURE,
                                         .id = TEXT("faulty.number_rows"),
                                         .version = 1,
                                         .input_count = 1,
                                         .inputs = tables,
                                         .outputs = tables,
                                         .output_count = 1,
                                         .port_stride = sizeof(tenon_port),
                                         .name = TEXT("Number rows"),
                                         .category = TEXT("Tables"),
                                         .doc = TEXT("Numbers the rows of a table."),
                                         .evaluate = number_rows}};
static const tenon_plugin plugin = {TENON_PLUGIN_MAGIC, sizeof(tenon_plugin), TENON_PLUGIN_MAJOR, TENON_PLUGIN_MINOR,
                                    TEXT("faulty"), TEXT("1.0.0"), TEXT("Tests"), TEXT("Faults."), nodes, 2,
                                    sizeof(tenon_node_type), NULL};
TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
const tenon_plugin *tenon_plugin_v1(void) { return &plugin; }
