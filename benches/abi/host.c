/* What a host pays for one round trip: set one number, evaluate a chain of ten nodes that all depend on it, read the
   outcome. Beside it the same ten steps through plain function pointers, which no engine can beat.
     host ROUNDS     prints two numbers: median nanoseconds of a round trip, and of the plain calls */
#include "tenon.h"
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

#define NODES 10

static void must(tenon_error *error) {
    if (error != NULL) {
        tenon_str message = tenon_error_message(error);
        fprintf(stderr, "%.*s\n", (int)message.len, message.ptr);
        exit(1);
    }
}

static double now(void) {
    struct timespec t;
    clock_gettime(CLOCK_MONOTONIC, &t);
    return (double)t.tv_sec * 1e9 + (double)t.tv_nsec;
}

static int by_size(const void *a, const void *b) {
    double x = *(const double *)a, y = *(const double *)b;
    return (x > y) - (x < y);
}

static double median(double *times, int count) {
    qsort(times, (size_t)count, sizeof *times, by_size);
    return times[count / 2];
}

static double one_more(double x) { return x + 1.0; }

int main(int argc, char **argv) {
    int rounds = argc > 1 ? atoi(argv[1]) : 0;
    double *times = rounds > 0 ? malloc((size_t)rounds * sizeof *times) : NULL;
    if (times == NULL) return 2;

    char json[4000] = "{\"format\": \"tenon\", \"version\": 1, \"units\": \"mm\", \"nodes\": {";
    for (int i = 0; i < NODES; i++) {
        char node[300], wire[100] = "";
        if (i > 0) snprintf(wire, sizeof wire, ", \"inputs\": {\"x\": {\"from\": [\"n%d.value\"]}}", i - 1);
        snprintf(node, sizeof node, "%s\"n%d\": {\"type\": \"expression\", \"params\": {\"formula\": \"x + 1\"}%s}",
                 i > 0 ? ", " : "", i, wire);
        strcat(json, node);
    }
    strcat(json, "}}");

    tenon_engine *engine;
    tenon_graph *graph;
    must(tenon_engine_new(NULL, &engine));
    must(tenon_graph_load(engine, json, strlen(json), NULL, &graph));
    const char *outputs[] = {"n9.value"};
    for (int i = 0; i < rounds; i++) {
        double start = now();
        tenon_result *result;
        must(tenon_graph_set_number(graph, "n0.x", i));
        must(tenon_graph_evaluate(graph, outputs, 1, NULL, &result));
        tenon_tree tree = {.size = sizeof tree};
        must(tenon_result_output(result, outputs[0], &tree));
        double value = *(const double *)tree.branches[0].column.items;
        tenon_result_free(result);
        times[i] = now() - start;
        if (value != i + NODES) {
            fprintf(stderr, "%d gives %f\n", i, value);
            return 1;
        }
    }
    double ours = median(times, rounds);

    double (*volatile step)(double) = one_more;
    for (int i = 0; i < rounds; i++) {
        double start = now(), value = i;
        /* A hundred times, since the clock is coarser than ten calls. */
        for (int k = 0; k < 100; k++) {
            value = i;
            for (int n = 0; n < NODES; n++) value = step(value);
        }
        times[i] = (now() - start) / 100.0;
        if (value != i + NODES) return 1;
    }
    printf("%.1f %.1f\n", ours, median(times, rounds));
    tenon_graph_free(graph);
    tenon_engine_free(engine);
    free(times);
    return tenon_handle_count() == 0 ? 0 : 1;
}
