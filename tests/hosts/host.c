/* A host in C: loads a graph, moves a control point a hundred times, reads the panels in place, and tries the calls
   that a host gets wrong. Prints what it found; ends with 1 at the first thing that is not as it should be.
     host GRAPH.tenon.json     (the environment's MOVES: how often the point is moved) */
#include "check.h"

static int32_t hear(void *context, double fraction, tenon_str node) {
    CHECK(fraction >= 0.0 && fraction <= 1.0 && node.len > 0);
    ++*(int *)context;
    return 1;
}

static int32_t stop(void *context, double fraction, tenon_str node) {
    (void)context, (void)fraction, (void)node;
    return 0;
}

int main(int argc, char **argv) {
    CHECK(argc == 2);
    CHECK(tenon_version() >> 16 == 1 && (tenon_version() & 0xffff) >= 1);
    uint64_t length;
    char *json = read_all(argv[1], &length);
    tenon_engine_config config = {.size = sizeof config, .threads = 2};
    tenon_engine *engine;
    must(tenon_engine_new(&config, &engine));
    tenon_graph *graph;
    must(tenon_graph_load(engine, json, length, NULL, &graph));

    /* What there is to set and to ask for. */
    tenon_text *text_of;
    must(tenon_engine_describe(engine, "thicken", &text_of));
    says(text_of, "\"type\":\"thicken\"");
    refused(tenon_engine_describe(engine, "thiken", &text_of), TENON_BAD_ARGUMENT, "did you mean \"thicken\"");
    must(tenon_engine_describe(engine, NULL, &text_of));
    says(text_of, "\"type\":\"vector_sum\"");
    must(tenon_graph_interface(graph, TENON_INPUTS, &text_of));
    says(text_of, "\"name\":\"thickness\"");
    must(tenon_graph_interface(graph, TENON_INPUTS, &text_of));
    says(text_of, "\"type\":\"number\",\"access\":\"item\",\"min\":4.0,\"max\":30.0,\"choices\":[],\"default\":");
    must(tenon_graph_interface(graph, TENON_OUTPUTS, &text_of));
    says(text_of, "\"type\":\"panels\",\"access\":\"item\"");
    refused(tenon_graph_interface(graph, 2, &text_of), TENON_BAD_ARGUMENT, "TENON_OUTPUTS");

    /* Evaluate, and read the panels. */
    const char *wanted[] = {"panels", "net_area"};
    int heard = 0;
    tenon_evaluate_options options = {.size = sizeof options, .context = &heard, .progress = hear};
    tenon_result *first;
    must(tenon_graph_evaluate(graph, wanted, 2, &options, &first));
    CHECK(tenon_result_status(first) == TENON_OK && heard > 0);
    const tenon_panels *panels = panels_of(first);
    CHECK(panels->panel_count == 256 && panels->thickness == 10.0);
    uint64_t inner = 0;
    for (uint64_t i = 0; i < panels->corner_count; i++) inner += panels->neighbour[i].panel != TENON_NONE;
    CHECK(inner == 2 * (2 * 16 * 15));
    tenon_tree area = {.size = sizeof area};
    must(tenon_result_output(first, "net_area", &area));
    CHECK(area.branches[0].column.kind == TENON_NUMBER && *(const double *)area.branches[0].column.items > 1e6);
    must(tenon_result_json(first, "net_area", &text_of));
    says(text_of, "\"number\"");
    refused(tenon_result_json(first, "boards", &text_of), TENON_BAD_ARGUMENT, "not asked for");

    /* Where the time went, and the memory. */
    uint64_t nodes = tenon_result_node_count(first), time = 0, largest = 0;
    CHECK(nodes > 5);
    for (uint64_t i = 0; i < nodes; i++) {
        tenon_node_report node = {.size = sizeof node};
        must(tenon_result_node(first, i, &node));
        CHECK(node.node.len > 0 && node.type_name.len > 0);
        CHECK(node.happened.len == 8 && memcmp(node.happened.ptr, "executed", 8) == 0);
        time += node.nanoseconds;
        largest = node.bytes > largest ? node.bytes : largest;
    }
    CHECK(time > 1000 && time < UINT64_C(600000000000));
    CHECK(largest >= panels->corner_count * 3 * sizeof(tenon_vec3));
    tenon_node_report none = {.size = sizeof none};
    refused(tenon_result_node(first, nodes, &none), TENON_BAD_ARGUMENT, "node");
    printf("%d panels, highest point at %.1f mm\n", (int)panels->panel_count, highest(panels));

    /* Move a control point: what was read before stays as it was. */
    const char *text = getenv("MOVES");
    int moves = text != NULL ? atoi(text) : 100;
    double before = highest(panels);
    double last = before;
    for (int i = 1; i <= moves; i++) {
        char points[200];
        snprintf(points, sizeof points, "[[0, 0, 0], [900, 0, %d], [3600, 0, 1500], [4500, 0, 0]]", 1500 + i);
        must(tenon_graph_set(graph, "arc.points", points));
        tenon_result *result;
        must(tenon_graph_evaluate(graph, wanted, 1, NULL, &result));
        CHECK(tenon_result_status(result) == TENON_OK);
        double now = highest(panels_of(result));
        CHECK(now > last);
        last = now;
        tenon_result_free(result);
    }
    CHECK(highest(panels) == before);

    /* What happened to each node. */
    tenon_result *again;
    must(tenon_graph_evaluate(graph, wanted, 1, NULL, &again));
    CHECK(tenon_result_node_count(again) == 0); /* nothing changed, nothing ran */
    tenon_result_free(again);

    /* Cancelled: publishes nothing. */
    must(tenon_graph_set_number(graph, "thickness", 12.0));
    options.progress = stop;
    must(tenon_graph_evaluate(graph, wanted, 1, &options, &again));
    CHECK(tenon_result_status(again) == TENON_CANCELLED);
    tenon_tree tree = {.size = sizeof tree};
    refused(tenon_result_output(again, "panels", &tree), TENON_BAD_ARGUMENT, "panels");
    tenon_result_free(again);

    /* Edit: a node more, wired, and read. */
    must(tenon_graph_add_node(graph, "doubled", "expression"));
    must(tenon_graph_set(graph, "doubled.formula", "\"x * 2\""));
    must(tenon_graph_connect(graph, "thicken.area", "doubled", "x"));
    const char *doubled[] = {"doubled.value"};
    must(tenon_graph_evaluate(graph, doubled, 1, NULL, &again));
    CHECK(tenon_result_status(again) == TENON_OK);
    must(tenon_result_output(again, "doubled.value", &tree));
    tenon_result_free(again);
    must(tenon_graph_disconnect(graph, "thicken.area", "doubled", "x"));
    refused(tenon_graph_disconnect(graph, "thicken.area", "doubled", "x"), TENON_FAILED, "doubled");
    must(tenon_graph_set(graph, "doubled.x", "21"));
    must(tenon_graph_evaluate(graph, doubled, 1, NULL, &again));
    must(tenon_result_output(again, "doubled.value", &tree));
    CHECK(*(const double *)tree.branches[0].column.items == 42.0);
    tenon_result_free(again);
    must(tenon_graph_remove_node(graph, "doubled"));

    /* What a host gets wrong. */
    refused(tenon_graph_set(graph, "thicknes", "12"), TENON_FAILED, "did you mean \"thickness\"");
    refused(tenon_graph_set_number(graph, "thickness", 500.0), TENON_FAILED, "4 to 30");
    refused(tenon_graph_set_number(graph, "thickness", NAN), TENON_BAD_ARGUMENT, "finite");
    refused(tenon_graph_set(graph, "thickness", "12,"), TENON_BAD_ARGUMENT, "json");
    refused(tenon_graph_set(graph, NULL, "12"), TENON_BAD_ARGUMENT, "name is NULL");
    refused(tenon_graph_set(graph, "\xff\xfe", "12"), TENON_BAD_ARGUMENT, "UTF-8");
    refused(tenon_graph_set((tenon_graph *)engine, "thickness", "12"), TENON_BAD_ARGUMENT, "of kind engine");
    refused(tenon_graph_set((tenon_graph *)&heard, "thickness", "12"), TENON_BAD_ARGUMENT, "never given");
    refused(tenon_graph_load(engine, "{", 1, NULL, &graph), TENON_FAILED, "line 1");
    refused(tenon_graph_load(engine, NULL, 10, NULL, &graph), TENON_BAD_ARGUMENT, "json is NULL");
    refused(tenon_graph_load(engine, json, UINT64_MAX, NULL, &graph), TENON_BAD_ARGUMENT, "impossible");
    refused(tenon_result_output(first, "boards", &tree), TENON_BAD_ARGUMENT, "not asked for");
    tree.size = 0;
    refused(tenon_result_output(first, "panels", &tree), TENON_BAD_ARGUMENT, "sizeof");

    /* A host of an older, shorter version of a struct gets what fits. */
    tenon_tree shorter;
    memset(&shorter, 0x55, sizeof shorter);
    shorter.size = 16;
    must(tenon_result_output(first, "panels", &shorter));
    CHECK(shorter.size == 16 && shorter.branches != NULL && shorter.branch_count == UINT64_C(0x5555555555555555));

    /* Save, free early, read late. */
    tenon_text *saved;
    must(tenon_graph_save(graph, &saved));
    CHECK(tenon_text_get(saved).len > 1000);
    tenon_graph_free(graph);
    tenon_engine_free(engine);
    CHECK(highest(panels) == before);
    refused(tenon_graph_set(graph, "thickness", "12"), TENON_BAD_ARGUMENT, "freed");
    tenon_graph_free(graph);
    tenon_text_free(saved);
    tenon_result_free(first);
    CHECK(tenon_result_status(first) == TENON_BAD_ARGUMENT);
    CHECK(tenon_handle_count() == 0);
    free(json);
    return 0;
}
