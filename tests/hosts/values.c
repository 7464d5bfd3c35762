/* Values in and out: arrays given by copy and shared, lists and trees, meshes, and buffers for a viewport; and the
   arguments that a host gets wrong.
     values GRAPH.tenon.json */
#include "check.h"

static int released;

static void release(void *context) {
    CHECK(context == &released);
    released++;
}

static const char GRAPH[] =
    "{\"format\": \"tenon\", \"version\": 1, \"units\": \"mm\", \"nodes\": {"
    " \"list\": {\"type\": \"list\"},"
    " \"half\": {\"type\": \"expression\", \"params\": {\"formula\": \"x / 2\"}},"
    " \"order\": {\"type\": \"order_faces\"},"
    " \"thicken\": {\"type\": \"thicken\", \"inputs\": {\"mesh\": {\"from\": [\"order.mesh\"]}}}}}";

/* A tree of one branch. */
#define TREE(branch) {.size = sizeof(tenon_tree), .branch_stride = sizeof(tenon_branch), .branches = (branch), .branch_count = 1}
#define COLUMN(kind_, type, array, n) \
    {.size = sizeof(tenon_column), .kind = (kind_), .items = (array), .count = (n), .stride = sizeof(type)}

static tenon_result *evaluate(tenon_graph *graph, const char *output) {
    tenon_result *result;
    must(tenon_graph_evaluate(graph, &output, 1, NULL, &result));
    if (tenon_result_status(result) != TENON_OK) {
        tenon_diagnostic d = {.size = sizeof d};
        must(tenon_result_diagnostic(result, 0, &d));
        fprintf(stderr, "%.*s: %.*s\n", (int)d.node.len, d.node.ptr, (int)d.message.len, d.message.ptr);
        exit(1);
    }
    return result;
}

static void arrays(tenon_graph *graph) {
    static double numbers[1000];
    for (int i = 0; i < 1000; i++) numbers[i] = i;
    tenon_branch branch = {.column = COLUMN(TENON_NUMBER, double, numbers, 1000)};
    tenon_tree tree = TREE(&branch), out = {.size = sizeof out};

    /* Copied: what the caller does with its array afterwards changes nothing. */
    must(tenon_graph_give(graph, "half.x", &tree));
    numbers[999] = -1.0;
    tenon_result *result = evaluate(graph, "half.value");
    must(tenon_result_output(result, "half.value", &out));
    CHECK(out.branches[0].column.count == 1000 && ((const double *)out.branches[0].column.items)[999] == 499.5);
    tenon_result_free(result);
    numbers[999] = 999.0;

    /* Shared: a list that goes through comes out at the same address. */
    must(tenon_graph_share(graph, "list.items", &tree, release, &released));
    CHECK(released == 0);
    result = evaluate(graph, "list.items");
    must(tenon_result_output(result, "list.items", &out));
    CHECK(out.branches[0].column.items == numbers);
    /* It lives as long as somebody looks at it. */
    must(tenon_graph_set(graph, "list.items", "[1]"));
    tenon_result *after = evaluate(graph, "list.items");
    tenon_result_free(after);
    CHECK(released == 0);
    tenon_result_free(result);

    /* Paths. */
    int32_t paths[2][2] = {{0, 1}, {3, 2}};
    tenon_branch branches[2] = {
        {.path = paths[1], .path_count = 2, .column = COLUMN(TENON_NUMBER, double, numbers, 2)},
        {.path = paths[0], .path_count = 2, .column = COLUMN(TENON_NUMBER, double, numbers + 2, 3)},
    };
    tree = (tenon_tree)TREE(branches);
    tree.branch_count = 2;
    must(tenon_graph_give(graph, "half.x", &tree));
    result = evaluate(graph, "half.value");
    must(tenon_result_output(result, "half.value", &out));
    CHECK(out.branch_count == 2 && out.branches[0].path[0] == 0 && out.branches[0].column.count == 3);
    CHECK(out.branches[1].path[0] == 3 && ((const double *)out.branches[1].column.items)[1] == 0.5);
    tenon_result_free(result);

    /* Gaps stay gaps. */
    uint8_t valid[3] = {1, 0, 1};
    branch.column.count = 3, branch.column.valid = valid;
    tree = (tenon_tree)TREE(&branch);
    must(tenon_graph_give(graph, "half.x", &tree));
    result = evaluate(graph, "half.value");
    must(tenon_result_output(result, "half.value", &out));
    CHECK(out.branches[0].column.count == 3 && out.branches[0].column.valid[0] == 1 && out.branches[0].column.valid[1] == 0);
    tenon_result_free(result);

    /* Integers where numbers are wanted are converted, so nothing is left to share. */
    int64_t integers[2] = {4, 6};
    tenon_branch whole = {.column = COLUMN(TENON_INTEGER, int64_t, integers, 2)};
    tree = (tenon_tree)TREE(&whole);
    int before = released;
    must(tenon_graph_share(graph, "half.x", &tree, release, &released));
    CHECK(released == before + 1);
    result = evaluate(graph, "half.value");
    must(tenon_result_output(result, "half.value", &out));
    CHECK(((const double *)out.branches[0].column.items)[1] == 3.0);
    tenon_result_free(result);
}

static void meshes(tenon_graph *graph) {
    tenon_vec3 points[6] = {{0, 0, 0}, {200, 0, 0}, {400, 0, 50}, {0, 100, 0}, {200, 100, 0}, {400, 100, 50}};
    uint32_t start[3] = {0, 4, 8}, vertices[8] = {0, 1, 4, 3, 1, 2, 5, 4};
    tenon_mesh mesh = {.size = sizeof mesh, .points = points, .point_count = 6, .face_start = start, .face_count = 2,
                       .face_vertices = vertices, .face_vertex_count = 8};
    tenon_branch branch = {.column = COLUMN(TENON_MESH, tenon_mesh, &mesh, 1)};
    tenon_tree tree = TREE(&branch);
    must(tenon_graph_give(graph, "order.mesh", &tree));
    tenon_result *result = evaluate(graph, "thicken.panels");
    tenon_tree out = {.size = sizeof out};
    must(tenon_result_output(result, "thicken.panels", &out));
    const tenon_panels *panels = out.branches[0].column.items;
    CHECK(panels->panel_count == 2 && panels->corner_count == 8);
    /* Every array per edge. */
    int inner = 0;
    for (int k = 0; k < 8; k++) {
        tenon_vec3 n = panels->chamfer[k].normal;
        CHECK(fabs(sqrt(n.x * n.x + n.y * n.y + n.z * n.z) - 1.0) < 1e-9);
        CHECK(panels->vertex[k] < 6 && panels->side[k] <= TENON_SIDE_OTHER && panels->voided[k] <= 1);
        CHECK(isfinite(panels->back_start[k].x) && isfinite(panels->back_end[k].z));
        inner += panels->neighbour[k].panel != TENON_NONE;
    }
    CHECK(inner == 2);

    /* For the viewport: two solids of six faces, made once. */
    tenon_preview seen = {.size = sizeof seen}, again = {.size = sizeof again};
    must(tenon_result_preview(result, "thicken.panels", &seen));
    must(tenon_result_preview(result, "thicken.panels", &again));
    CHECK(seen.positions == again.positions && seen.part_count == 2);
    CHECK(seen.triangle_count == 24 && seen.line_count == 24 && seen.vertex_count == 48 && seen.point_count == 0);
    CHECK(seen.node.len == 7 && memcmp(seen.node.ptr, "thicken", 7) == 0 && memcmp(seen.port.ptr, "panels", 6) == 0);
    CHECK(seen.parts[1].item == 0 && seen.parts[1].element == 1);
    double volume = 0;
    for (uint64_t t = 0; t < seen.triangle_count; t++) {
        const float *p[3];
        for (int k = 0; k < 3; k++) {
            uint32_t v = seen.triangles[3 * t + k];
            CHECK(v < seen.vertex_count && seen.vertex_parts[v] < seen.part_count);
            p[k] = seen.positions + 3 * v;
            const float *n = seen.normals + 3 * v;
            CHECK(fabs(n[0] * n[0] + n[1] * n[1] + n[2] * n[2] - 1.0) < 1e-5);
        }
        volume += p[0][0] * (double)(p[1][1] * p[2][2] - p[1][2] * p[2][1]) +
                  p[0][1] * (double)(p[1][2] * p[2][0] - p[1][0] * p[2][2]) +
                  p[0][2] * (double)(p[1][0] * p[2][1] - p[1][1] * p[2][0]);
    }
    volume /= 6.0;
    double area = 200.0 * 100.0 + hypot(200.0, 50.0) * 100.0;
    CHECK(fabs(volume / (area * panels->thickness) - 1.0) < 0.1);
    tenon_result_free(result);

    /* What is wrong with a mesh is said before anything runs. */
    vertices[7] = 6;
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "6 is not below 6");
    vertices[7] = 4, start[1] = 9;
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "face_start");
    start[1] = 4, points[2].y = NAN;
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "not finite");
    points[2].y = 0, mesh.points = NULL;
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "NULL");
    mesh.points = (const tenon_vec3 *)((const char *)points + 1);
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "misaligned");
    mesh.points = points, mesh.point_count = UINT64_MAX / 4;
    refused(tenon_graph_give(graph, "order.mesh", &tree), TENON_BAD_ARGUMENT, "impossible");
}

/* Every array of what is shared comes out at the address at which it went in. */
static void shared(tenon_engine *engine) {
    tenon_graph *graph;
    int before = released;
    must(tenon_graph_load(engine, GRAPH, sizeof GRAPH - 1, NULL, &graph));
    static tenon_vec3 points[4] = {{0, 0, 0}, {100, 0, 0}, {100, 100, 0}, {0, 100, 0}};
    static tenon_vec4 line[4] = {{0, 0, 0, 1}, {1, 0, 0, 1}, {1, 1, 0, 1}, {0, 1, 0, 1}};
    static tenon_address addresses[1] = {{0, 2, 3}};
    static uint32_t strips[3] = {0, 2, 4}, start[2] = {0, 4}, vertices[4] = {0, 1, 2, 3};
    static tenon_plane planes[4] = {{{0, 0, 1}, 0}, {{0, 0, 1}, 5}, {{0, 1, 0}, 5}, {{1, 0, 0}, 5}};
    static tenon_edge none[4] = {{TENON_NONE, TENON_NONE}, {TENON_NONE, TENON_NONE}, {TENON_NONE, TENON_NONE},
                                 {TENON_NONE, TENON_NONE}};
    static uint8_t sides[4] = {0, 1, 2, 3}, voided[4] = {0, 0, 1, 0}, valid[4] = {1, 0, 1, 1};
    tenon_curve curve = {.size = sizeof curve, .points = line, .point_count = 4, .strip_start = strips, .strip_count = 2};
    tenon_mesh mesh = {.size = sizeof mesh, .points = points, .point_count = 4, .face_start = start, .face_count = 1,
                       .face_vertices = vertices, .face_vertex_count = 4, .addresses = addresses};
    tenon_panels panels = {.size = sizeof panels, .thickness = 10, .panel_count = 1, .corner_count = 4,
                           .corner_start = start, .address = addresses, .normal = &planes[0].normal, .front = points,
                           .vertex = vertices, .chamfer = planes, .neighbour = none, .side = sides,
                           .back_start = points, .back_end = points, .voided = voided};
    tenon_branch branches[5] = {
        {.column = COLUMN(TENON_CURVE, tenon_curve, &curve, 1)}, {.column = COLUMN(TENON_MESH, tenon_mesh, &mesh, 1)},
        {.column = COLUMN(TENON_PANELS, tenon_panels, &panels, 1)}, {.column = COLUMN(TENON_POINT, tenon_vec3, points, 4)},
        {.column = COLUMN(TENON_PLANE, tenon_plane, planes, 4)},
    };
    branches[3].column.valid = valid;
    for (int i = 0; i < 5; i++) {
        tenon_tree tree = TREE(&branches[i]), out = {.size = sizeof out};
        must(tenon_graph_share(graph, "list.items", &tree, release, &released));
        tenon_result *result = evaluate(graph, "list.items");
        must(tenon_result_output(result, "list.items", &out));
        const tenon_column *column = &out.branches[0].column;
        CHECK(column->kind == branches[i].column.kind && column->valid == branches[i].column.valid);
        if (i == 0) {
            const tenon_curve *c = column->items;
            CHECK(c->points == line && c->strip_start == strips && c->strip_count == 2);
        } else if (i == 1) {
            const tenon_mesh *m = column->items;
            CHECK(m->points == points && m->face_start == start && m->face_vertices == vertices);
            CHECK(m->addresses == addresses);
        } else if (i == 2) {
            const tenon_panels *p = column->items;
            CHECK(p->corner_start == start && p->address == addresses && p->normal == &planes[0].normal);
            CHECK(p->front == points && p->vertex == vertices && p->chamfer == planes && p->neighbour == none);
            CHECK(p->side == sides && p->back_start == points && p->back_end == points && p->voided == voided);
        } else {
            CHECK(column->items == branches[i].column.items);
        }
        CHECK(released < before + i + 1);
        tenon_result_free(result);
    }
    tenon_graph_free(graph);
    CHECK(released == before + 5);
}

static void wrong(tenon_graph *graph, const char *shell) {
    double number = 1.0;
    tenon_branch branch = {.column = COLUMN(TENON_NUMBER, double, &number, 1)};
    tenon_tree tree = TREE(&branch);
    int before = released;
    refused(tenon_graph_share(graph, "half.nothing", &tree, release, &released), TENON_FAILED, "nothing");
    refused(tenon_graph_share(graph, "order.mesh", &tree, release, &released), TENON_FAILED, "takes mesh");
    refused(tenon_graph_give(graph, "thicken.mesh", &tree), TENON_FAILED, "wire");
    refused(tenon_graph_give(graph, "half.x", NULL), TENON_BAD_ARGUMENT, "NULL");
    tree.size = 4;
    refused(tenon_graph_give(graph, "half.x", &tree), TENON_BAD_ARGUMENT, "sizeof");
    tree.size = sizeof tree, branch.column.kind = 999;
    refused(tenon_graph_give(graph, "half.x", &tree), TENON_BAD_ARGUMENT, "999");
    branch.column.kind = TENON_NUMBER, branch.column.stride = 4;
    refused(tenon_graph_give(graph, "half.x", &tree), TENON_BAD_ARGUMENT, "stride");
    tenon_str text = {.ptr = "\xff", .len = 1};
    tenon_branch texts = {.column = COLUMN(TENON_TEXT, tenon_str, &text, 1)};
    tree.branches = &texts;
    refused(tenon_graph_give(graph, "half.x", &tree), TENON_BAD_ARGUMENT, "UTF-8");
    number = NAN, branch.column.stride = 8, tree.branches = &branch;
    refused(tenon_graph_give(graph, "half.x", &tree), TENON_BAD_ARGUMENT, "not finite");
    CHECK(released == before); /* what was refused is not released */

    /* Outputs and structs. */
    tenon_result *result = evaluate(graph, "list.items");
    tenon_preview seen = {.size = sizeof seen};
    must(tenon_result_preview(result, "list.items", &seen));
    CHECK(seen.vertex_count == 0 && seen.positions == NULL);
    refused(tenon_result_preview(result, "nothing", &seen), TENON_BAD_ARGUMENT, "nothing");
    refused(tenon_result_preview(result, "list.items", NULL), TENON_BAD_ARGUMENT, "NULL");
    refused(tenon_result_preview(result, "list.items", (tenon_preview *)((char *)&seen + 1)), TENON_BAD_ARGUMENT, "misaligned");
    tenon_result_free(result);
    refused(tenon_result_preview(result, "list.items", &seen), TENON_BAD_ARGUMENT, "freed");
    const char *names[] = {"list.items", NULL};
    refused(tenon_graph_evaluate(graph, names, 2, NULL, &result), TENON_BAD_ARGUMENT, "outputs[1] is NULL");
    refused(tenon_graph_evaluate(graph, names, UINT64_MAX, NULL, &result), TENON_BAD_ARGUMENT, "2^20");
    refused(tenon_graph_evaluate(graph, NULL, 1, NULL, &result), TENON_BAD_ARGUMENT, "NULL");
    refused(tenon_graph_evaluate(graph, names, 1, NULL, NULL), TENON_BAD_ARGUMENT, "out is NULL");
    tenon_evaluate_options options = {.size = 4};
    refused(tenon_graph_evaluate(graph, names, 1, &options, &result), TENON_BAD_ARGUMENT, "sizeof");
    (void)shell;
}

int main(int argc, char **argv) {
    CHECK(argc == 2);
    uint64_t length;
    char *json = read_all(argv[1], &length);
    tenon_engine *engine;
    must(tenon_engine_new(NULL, &engine));
    tenon_graph *graph;
    must(tenon_graph_load(engine, GRAPH, sizeof GRAPH - 1, NULL, &graph));
    arrays(graph);
    meshes(graph);
    shared(engine);
    wrong(graph, argv[1]);

    /* Sharing with a graph that goes first. */
    static double numbers[2] = {1.0, 2.0};
    tenon_branch branch = {.column = COLUMN(TENON_NUMBER, double, numbers, 2)};
    tenon_tree tree = TREE(&branch);
    int before = released;
    must(tenon_graph_share(graph, "list.items", &tree, release, &released));
    tenon_result *result = evaluate(graph, "list.items");
    CHECK(released == before);
    tenon_graph_free(graph);
    tenon_engine_free(engine);
    CHECK(released == before + 1); /* what the graph remembered of before; this one is still held */
    tenon_result_free(result);
    CHECK(released == before + 2);

    /* The whole shell for the viewport. */
    must(tenon_engine_new(NULL, &engine));
    must(tenon_graph_load(engine, json, length, NULL, &graph));
    result = evaluate(graph, "panels");
    tenon_preview seen = {.size = sizeof seen};
    must(tenon_result_preview(result, "panels", &seen));
    CHECK(seen.part_count == 256 && seen.parts[255].address.row == 15 && seen.parts[255].address.column == 15);
    CHECK(seen.high.z > seen.low.z && seen.node.len > 0);
    printf("%d triangles for %d panels\n", (int)seen.triangle_count, (int)seen.part_count);
    tenon_result_free(result);
    tenon_graph_free(graph);
    tenon_engine_free(engine);
    CHECK(tenon_handle_count() == 0);
    free(json);
    return 0;
}
