/* Plugins in a host: a graph without its plugin, with it named and in a folder, of another version, and in a process of its
   own in which it crashes, hangs and begins anew.
     plugins GRAPH.tenon.json     (the environment: HINGES and DOOMED, two libraries; FOLDER, one that holds the first;
                                   TENON_PLUGIN_HOST, the program tenon: without it no process is started) */
#define _POSIX_C_SOURCE 200112L
#include "check.h"

static const char HINGED[] =
    "{\"format\": \"tenon\", \"version\": 1, \"units\": \"mm\", \"requires\": {\"hinges\": \"%s\"}, \"nodes\": {"
    " \"sum\": {\"type\": \"expression\", \"params\": {\"formula\": \"1 + 1\"}},"
    " \"order\": {\"type\": \"order_faces\"},"
    " \"thicken\": {\"type\": \"thicken\", \"inputs\": {\"mesh\": {\"from\": [\"order.mesh\"]}}},"
    " \"hinges\": {\"type\": \"hinges.butt_hinge\", \"params\": {\"spacing\": 40},"
    "   \"inputs\": {\"panels\": {\"from\": [\"thicken.panels\"]}}}}}";

static const char DYING[] =
    "{\"format\": \"tenon\", \"version\": 1, \"units\": \"mm\", \"requires\": {\"misbehaving\": %s}, \"nodes\": {"
    " \"doomed\": {\"type\": \"misbehaving.doomed\"},"
    " \"beside\": {\"type\": \"misbehaving.trusting\", \"params\": {\"x\": 3}}}}";

static tenon_graph *load(tenon_engine *engine, const char *json) {
    tenon_graph *graph;
    must(tenon_graph_load(engine, json, strlen(json), NULL, &graph));
    return graph;
}

static tenon_graph *load_with(tenon_engine *engine, const char *form, const char *need) {
    char json[1000];
    CHECK(snprintf(json, sizeof json, form, need) < (int)sizeof json);
    return load(engine, json);
}

/* Two panels that meet at an edge of 100 mm. */
static void give_mesh(tenon_graph *graph) {
    tenon_vec3 points[6] = {{0, 0, 0}, {200, 0, 0}, {400, 0, 50}, {0, 100, 0}, {200, 100, 0}, {400, 100, 50}};
    uint32_t start[3] = {0, 4, 8}, vertices[8] = {0, 1, 4, 3, 1, 2, 5, 4};
    tenon_mesh mesh = {.size = sizeof mesh, .points = points, .point_count = 6, .face_start = start, .face_count = 2,
                       .face_vertices = vertices, .face_vertex_count = 8};
    tenon_branch branch = {.column = {.size = sizeof(tenon_column), .kind = TENON_MESH, .items = &mesh, .count = 1,
                                      .stride = sizeof mesh}};
    tenon_tree tree = {.size = sizeof tree, .branch_stride = sizeof branch, .branches = &branch, .branch_count = 1};
    must(tenon_graph_give(graph, "order.mesh", &tree));
}

static tenon_result *evaluate(tenon_graph *graph, const char *first, const char *second) {
    const char *wanted[] = {first, second};
    tenon_result *result;
    must(tenon_graph_evaluate(graph, wanted, (first != NULL) + (second != NULL), NULL, &result));
    return result;
}

static double number(const tenon_result *result, const char *name) {
    tenon_tree tree = {.size = sizeof tree};
    must(tenon_result_output(result, name, &tree));
    CHECK(tree.branches[0].column.kind == TENON_NUMBER && tree.branches[0].column.count == 1);
    return *(const double *)tree.branches[0].column.items;
}

/* Whether a diagnostic has that code and node and says `part` in its message or hint. */
static int told(const tenon_result *result, const char *code, const char *node, const char *part) {
    for (uint64_t i = 0; i < tenon_result_diagnostic_count(result); i++) {
        tenon_diagnostic d = {.size = sizeof d};
        must(tenon_result_diagnostic(result, i, &d));
        char text[2000];
        snprintf(text, sizeof text, "%.*s|%.*s|%.*s %.*s", (int)d.code.len, d.code.ptr, (int)d.node.len, d.node.ptr,
                 (int)d.message.len, d.message.ptr, (int)d.hint.len, d.hint.ptr);
        char begin[100];
        snprintf(begin, sizeof begin, "%s|%s|", code, node);
        if (strncmp(text, begin, strlen(begin)) == 0 && strstr(text, part) != NULL) return 1;
        fprintf(stderr, "told: %s\n", text);
    }
    return 0;
}

static char *save(tenon_graph *graph) {
    tenon_text *saved;
    must(tenon_graph_save(graph, &saved));
    tenon_str text = tenon_text_get(saved);
    char *copy = malloc((size_t)text.len + 1);
    CHECK(copy != NULL);
    memcpy(copy, text.ptr, (size_t)text.len);
    copy[text.len] = 0;
    tenon_text_free(saved);
    return copy;
}

static uint64_t hinges_of(tenon_graph *graph) {
    give_mesh(graph);
    tenon_result *result = evaluate(graph, "hinges.features", NULL);
    CHECK(tenon_result_status(result) == TENON_OK);
    tenon_tree tree = {.size = sizeof tree};
    must(tenon_result_output(result, "hinges.features", &tree));
    CHECK(tree.branches[0].column.kind == TENON_FEATURES);
    const tenon_features *features = tree.branches[0].column.items;
    CHECK(features->hardware_count == 2 && features->feature_count == 4 * features->hardware[0].count);
    uint64_t count = features->hardware[0].count;
    tenon_result_free(result);
    return count;
}

/* Without, with, in a folder, of another version. */
static void there_and_not(const char *hinges, const char *folder) {
    const char *libraries[] = {hinges}, *folders[] = {folder}, *relative[] = {"plugins"};
    tenon_engine_config config = {.size = sizeof config, .plugins = libraries, .plugin_count = 1};
    tenon_engine *with, *without, *inside;
    must(tenon_engine_new(&config, &with));
    must(tenon_engine_new(NULL, &without));
    config = (tenon_engine_config){.size = sizeof config, .folders = folders, .folder_count = 1};
    must(tenon_engine_new(&config, &inside));

    tenon_graph *graph = load_with(with, HINGED, ">=1, <2");
    CHECK(hinges_of(graph) == 2);
    char *text = save(graph);
    tenon_graph_free(graph);

    /* What is missing blocks its nodes, says what to install, and stays in the file as it was. */
    graph = load(without, text);
    give_mesh(graph);
    tenon_result *result = evaluate(graph, "sum.value", "thicken.panels");
    CHECK(number(result, "sum.value") == 2.0 && tenon_result_status(result) == TENON_FAILED);
    CHECK(told(result, "missing-plugin", "", "needs the plugin hinges >=1, <2, which is not there put its library into"));
    tenon_tree tree = {.size = sizeof tree};
    must(tenon_result_output(result, "thicken.panels", &tree));
    tenon_result_free(result);
    result = evaluate(graph, NULL, NULL);
    CHECK(told(result, "unknown-node", "hinges", "needs the plugin hinges"));
    tenon_result_free(result);
    char *again = save(graph);
    CHECK(strcmp(text, again) == 0);
    tenon_graph_free(graph);

    graph = load(inside, again);
    CHECK(hinges_of(graph) == 2);
    tenon_graph_free(graph);
    graph = load_with(with, HINGED, ">=2");
    result = evaluate(graph, "sum.value", NULL);
    CHECK(number(result, "sum.value") == 2.0);
    CHECK(told(result, "missing-plugin", "", "what is there is 1.0.0"));
    tenon_result_free(result);
    tenon_graph_free(graph);
    /* An engine's graphs are apart: the next one has its plugin again. */
    graph = load_with(with, HINGED, ">=1, <2");
    CHECK(hinges_of(graph) == 2);
    tenon_graph_free(graph);

    /* A host that was built before there were folders. */
    tenon_engine *older;
    config = (tenon_engine_config){.size = 40, .folders = relative, .folder_count = UINT64_MAX};
    must(tenon_engine_new(&config, &older));
    config.size = sizeof config;
    refused(tenon_engine_new(&config, &older), TENON_BAD_ARGUMENT, "2^20");
    config.folder_count = 1;
    refused(tenon_engine_new(&config, &older), TENON_BAD_ARGUMENT, "plugins is not an absolute path");
    config = (tenon_engine_config){.size = sizeof config, .isolate_count = 1};
    refused(tenon_engine_new(&config, &older), TENON_BAD_ARGUMENT, "isolate is NULL");
    tenon_engine_free(older), tenon_engine_free(inside), tenon_engine_free(without), tenon_engine_free(with);
    free(text), free(again);
}

#if defined(__linux__)
/* However it dies, this process lives, the rest is evaluated, and the next evaluation starts it anew. */
static void dies(tenon_engine *engine, const char *need) {
    tenon_graph *graph = load_with(engine, DYING, need);
    double deaths[] = {101, 103};
    const char *words[] = {"signal 11", "did not answer and told no progress for 2 s"};
    /* Only what the graph says has this limit. */
    int last = strstr(need, "timeout") != NULL ? 2 : 1;
    for (int i = 0; i < last; i++) {
        must(tenon_graph_set_number(graph, "doomed.x", deaths[i]));
        tenon_result *result = evaluate(graph, "doomed.y", "beside.y");
        CHECK(tenon_result_status(result) == TENON_FAILED && number(result, "beside.y") == 3.0);
        CHECK(told(result, "plugin-died", "doomed", words[i]));
        tenon_result_free(result);
        must(tenon_graph_set_number(graph, "doomed.x", 2.0 + i));
        result = evaluate(graph, "doomed.y", NULL);
        CHECK(tenon_result_status(result) == TENON_OK && number(result, "doomed.y") == 2.0 + i);
        tenon_result_free(result);
    }
    tenon_graph_free(graph);
}

static void apart(const char *doomed) {
    const char *libraries[] = {doomed}, *ids[] = {"misbehaving"};
    tenon_engine_config config = {.size = sizeof config, .plugins = libraries, .plugin_count = 1};
    tenon_engine *engine, *isolating;
    must(tenon_engine_new(&config, &engine));
    if (getenv("TENON_PLUGIN_HOST") != NULL) {
        dies(engine, "{\"isolation\": \"process\", \"timeout_s\": 2}");
        config.isolate = ids, config.isolate_count = 1;
        must(tenon_engine_new(&config, &isolating));
        dies(isolating, "\"*\"");
        tenon_engine_free(isolating);
        CHECK(unsetenv("TENON_PLUGIN_HOST") == 0);
    }

    /* Without the program that makes the processes the plugin does not run here instead. */
    tenon_graph *graph = load_with(engine, DYING, "{\"isolation\": \"process\"}");
    tenon_result *result = evaluate(graph, NULL, NULL);
    CHECK(told(result, "unknown-node", "doomed", "the program tenon is needed"));
    tenon_result_free(result);
    tenon_graph_free(graph);
    tenon_engine_free(engine);
}
#endif

int main(void) {
    const char *hinges = getenv("HINGES"), *folder = getenv("FOLDER"), *doomed = getenv("DOOMED");
    CHECK(hinges != NULL && folder != NULL && doomed != NULL);
    there_and_not(hinges, folder);
#if defined(__linux__)
    apart(doomed);
#endif
    CHECK(tenon_handle_count() == 0);
    puts("plugins are where they should be");
    return 0;
}
