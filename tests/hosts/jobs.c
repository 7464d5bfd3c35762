/* Evaluations on threads of their own: started, waited for, heard of, cancelled, overtaken by edits, freed early.
     jobs GRAPH.tenon.json */
#include "check.h"
#include <pthread.h>
#include <sched.h>

typedef struct {
    pthread_mutex_t lock;
    int heard, ended;
    tenon_status status;
    tenon_graph *graph;
    tenon_job *job;
} heard_of;

static int32_t hear(void *context, double fraction, tenon_str node) {
    heard_of *h = context;
    CHECK(fraction >= 0.0 && fraction <= 1.0 && node.len > 0);
    pthread_mutex_lock(&h->lock);
    h->heard++;
    pthread_mutex_unlock(&h->lock);
    /* Editing in a callback is allowed, waiting for oneself is refused. */
    must(tenon_graph_set_number(h->graph, "thickness", 20.0));
    tenon_result *result;
    refused(tenon_graph_evaluate(h->graph, NULL, 0, NULL, &result), TENON_BAD_ARGUMENT, "tenon_graph_start");
    return 1;
}

static void ended(void *context, tenon_status status) {
    heard_of *h = context;
    tenon_result *result = NULL;
    must(tenon_job_wait(h->job, 0, &result));
    CHECK(result != NULL && tenon_result_status(result) == status);
    tenon_result_free(result);
    pthread_mutex_lock(&h->lock);
    h->ended++;
    h->status = status;
    pthread_mutex_unlock(&h->lock);
}

static void ended_and_freed(void *context, tenon_status status) {
    heard_of *h = context;
    pthread_mutex_lock(&h->lock);
    h->status = status;
    pthread_mutex_unlock(&h->lock);
    tenon_job_free(h->job);
    pthread_mutex_lock(&h->lock);
    h->ended++;
    pthread_mutex_unlock(&h->lock);
}

static int32_t hear_and_free(void *context, double fraction, tenon_str node) {
    heard_of *h = context;
    (void)fraction, (void)node;
    pthread_mutex_lock(&h->lock);
    int is_first = h->heard++ == 0;
    pthread_mutex_unlock(&h->lock);
    if (is_first) {
        tenon_job_free(h->job);
        pthread_mutex_lock(&h->lock);
        CHECK(h->ended == 1);
        pthread_mutex_unlock(&h->lock);
    }
    return 1;
}

static double thickness_of(tenon_job *job) {
    tenon_result *result = NULL;
    must(tenon_job_wait(job, UINT64_MAX, &result));
    CHECK(result != NULL && tenon_result_status(result) == TENON_OK);
    double thickness = panels_of(result)->thickness;
    tenon_result_free(result);
    return thickness;
}

int main(int argc, char **argv) {
    CHECK(argc == 2);
    uint64_t length;
    char *json = read_all(argv[1], &length);
    tenon_engine *engine;
    must(tenon_engine_new(NULL, &engine));
    tenon_graph *graph;
    must(tenon_graph_load(engine, json, length, NULL, &graph));
    const char *wanted[] = {"panels"};
    heard_of h = {.lock = PTHREAD_MUTEX_INITIALIZER, .graph = graph};

    /* A job is of the graph as it was when it began: edits in its callbacks are for the next one. */
    tenon_evaluate_options options = {.size = sizeof options, .context = &h, .progress = hear, .done = ended};
    must(tenon_graph_start(graph, wanted, 1, &options, &h.job));
    CHECK(thickness_of(h.job) == 10.0);
    CHECK(tenon_job_progress(h.job) == 1.0);
    tenon_job_free(h.job); /* waits for `ended` */
    CHECK(h.heard > 0 && h.ended == 1 && h.status == TENON_OK);
    tenon_job_free(h.job);

    /* Many at once, each with the value that stood when it was started. */
    tenon_job *jobs[8];
    for (int i = 0; i < 8; i++) {
        must(tenon_graph_set_number(graph, "thickness", 5.0 + i));
        must(tenon_graph_start(graph, wanted, 1, NULL, &jobs[i]));
    }
    must(tenon_graph_set_number(graph, "thickness", 18.0));
    for (int i = 7; i >= 0; i--) CHECK(thickness_of(jobs[i]) == 5.0 + i);
    for (int i = 0; i < 8; i++) tenon_job_free(jobs[i]);

    /* A blocking evaluation has its turn among them, and what was set last. */
    tenon_result *result;
    must(tenon_graph_evaluate(graph, wanted, 1, NULL, &result));
    CHECK(panels_of(result)->thickness == 18.0);
    tenon_result_free(result);

    /* Cancelled while it waits: the one behind it still gets every edit. */
    tenon_job *first, *second, *third;
    must(tenon_graph_set(graph, "arc.points", "[[0, 0, 0], [900, 0, 1600], [3600, 0, 1500], [4500, 0, 0]]"));
    must(tenon_graph_start(graph, wanted, 1, NULL, &first));
    must(tenon_graph_set_number(graph, "thickness", 11.0));
    must(tenon_graph_start(graph, wanted, 1, NULL, &second));
    must(tenon_graph_set(graph, "iterations", "3"));
    must(tenon_graph_start(graph, wanted, 1, NULL, &third));
    tenon_job_cancel(second);
    must(tenon_job_wait(second, UINT64_MAX, &result));
    /* It may have ended before it was told. */
    CHECK(tenon_result_status(result) == TENON_CANCELLED || tenon_result_status(result) == TENON_OK);
    tenon_result_free(result);
    must(tenon_job_wait(third, UINT64_MAX, &result));
    CHECK(panels_of(result)->thickness == 11.0 && panels_of(result)->panel_count == 64);
    tenon_result_free(result);
    tenon_job_free(third), tenon_job_free(second), tenon_job_free(first);

    /* Stopped by the graph, and freed before it has ended; nothing comes after the free. */
    must(tenon_graph_set(graph, "iterations", "4"));
    must(tenon_graph_set_number(graph, "thickness", 13.0));
    h.ended = 0, options.progress = NULL;
    must(tenon_graph_start(graph, wanted, 1, &options, &h.job));
    tenon_graph_cancel(graph);
    tenon_job_free(h.job);
    CHECK(h.ended == 1);
    must(tenon_graph_evaluate(graph, wanted, 1, NULL, &result));
    CHECK(tenon_result_status(result) == TENON_OK && panels_of(result)->thickness == 13.0);
    tenon_result_free(result);

    /* Freed by its own callback. */
    h.ended = 0, options.done = ended_and_freed;
    must(tenon_graph_start(graph, wanted, 1, &options, &h.job));
    for (int done = 0; !done;) {
        pthread_mutex_lock(&h.lock);
        done = h.ended;
        pthread_mutex_unlock(&h.lock);
        /* The callback may wait for this thread's turn, as under valgrind. */
        sched_yield();
    }

    /* A job that waits for its turn, freed in a callback of the one before it: it is over when the free returns. */
    h.ended = 0, h.heard = 0, options.done = ended, options.progress = NULL;
    tenon_evaluate_options freeing = {.size = sizeof freeing, .context = &h, .progress = hear_and_free};
    must(tenon_graph_set_number(graph, "thickness", 17.0));
    pthread_mutex_lock(&h.lock); /* the callback does not begin before the second job is there */
    must(tenon_graph_start(graph, wanted, 1, &freeing, &first));
    must(tenon_graph_start(graph, wanted, 1, &options, &h.job));
    pthread_mutex_unlock(&h.lock);
    must(tenon_job_wait(first, UINT64_MAX, &result));
    CHECK(panels_of(result)->thickness == 17.0 && h.ended == 1 && h.status == TENON_CANCELLED);
    tenon_result_free(result);
    tenon_job_free(first);

    /* Looked at without waiting, the graph freed before the job. */
    must(tenon_graph_set_number(graph, "thickness", 14.0));
    must(tenon_graph_start(graph, wanted, 1, NULL, &first));
    must(tenon_job_wait(first, 0, &result));
    if (result != NULL) tenon_result_free(result);
    tenon_graph_free(graph);
    CHECK(thickness_of(first) == 14.0);
    tenon_job_free(first);

    /* What a host gets wrong. */
    refused(tenon_job_wait(first, 0, &result), TENON_BAD_ARGUMENT, "freed");
    refused(tenon_job_wait((tenon_job *)engine, 0, &result), TENON_BAD_ARGUMENT, "of kind engine");
    refused(tenon_job_wait(NULL, 0, &result), TENON_BAD_ARGUMENT, "the job is NULL");
    refused(tenon_graph_start(graph, wanted, 1, NULL, &first), TENON_BAD_ARGUMENT, "freed");
    CHECK(isnan(tenon_job_progress(first)));
    tenon_engine_free(engine);
    CHECK(tenon_handle_count() == 0);
    free(json);
    puts("jobs are in order");
    return 0;
}
