/* What a plugin must not do, one node type per misdeed, so that `tenon plugin check` has something to find. Each node has
   one input "x" and one output "y", and the comment before it names the checks that it fails. */
#define _DEFAULT_SOURCE
#include "tenon_plugin.h"
#include <pthread.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>
#include <unistd.h>

#define TEXT(s) {s, sizeof(s) - 1}
#define COUNT(a) (sizeof(a) / sizeof((a)[0]))

static double number(const tenon_tree *in) { return *(const double *)in[0].branches[0].column.items; }

static tenon_status give_as(const tenon_call *call, tenon_kind kind, const void *items) {
    tenon_branch branch;
    memset(&branch, 0, sizeof branch);
    branch.column.size = sizeof branch.column;
    branch.column.kind = kind;
    branch.column.items = items;
    branch.column.count = 1;
    branch.column.stride = 8;
    tenon_tree tree = {sizeof tree, sizeof branch, &branch, 1};
    return call->set(call, 0, &tree);
}
static tenon_status give(const tenon_call *call, double y) { return give_as(call, TENON_NUMBER, &y); }

#define EVALUATE(name)                                                                                                   \
    static tenon_status name(void *data, const tenon_call *call, const tenon_tree *in, uint32_t count)
#define UNUSED (void)data, (void)call, (void)in, (void)count

/* same-again, same-after-others, same-in-another-instance, same-on-many-threads, older-host, newer-host */
EVALUATE(forgetful) {
    static double sum;
    UNUSED;
    return give(call, sum += number(in) + 1);
}
/* finite-outputs */
EVALUATE(divider) {
    UNUSED;
    return give(call, 1 / (number(in) * 0));
}
/* sets-every-output */
EVALUATE(lazy) {
    UNUSED;
    return TENON_OK;
}
/* computes, explains-failures */
EVALUATE(silent) {
    UNUSED;
    return TENON_FAILED;
}
/* stops-at-once, stops-midway */
EVALUATE(deaf) {
    UNUSED;
    /* Only for its largest number, so that the other checks do not take long. */
    clock_t end = clock() + CLOCKS_PER_SEC / 6;
    while (number(in) == 10 && clock() < end) continue;
    return give(call, number(in));
}
/* leaves-inputs-alone */
EVALUATE(scribbler) {
    UNUSED;
    double before = number(in);
    *(double *)(uintptr_t)in[0].branches[0].column.items = before + 1;
    return give(call, before);
}
/* leaves-inputs-alone */
EVALUATE(furtive) {
    volatile double *x = (volatile double *)(uintptr_t)in[0].branches[0].column.items;
    double before = *x;
    UNUSED;
    /* Afterwards it is as it was. */
    *x = before + 1;
    *x = before;
    return give(call, before);
}
/* sets-what-it-declares */
EVALUATE(liar) {
    UNUSED;
    int64_t whole = 1;
    return give_as(call, TENON_INTEGER, &whole);
}
/* progress-rises */
EVALUATE(backwards) {
    UNUSED;
    call->progress(call, 0.9);
    call->progress(call, 0.1);
    return give(call, number(in));
}
/* leaves-the-process-alone */
EVALUATE(wanderer) {
    UNUSED;
    return chdir("/") == 0 ? give(call, number(in)) : TENON_FAILED;
}
/* messages-are-for-people */
EVALUATE(mumbler) {
    UNUSED;
    tenon_message message = {sizeof message, TENON_NOTE, TEXT("Some Code"), TEXT(" "), {NULL, 0}, TEXT("nowhere"), 0};
    call->tell(call, &message);
    return give(call, number(in));
}
/* lives-without-memory */
EVALUATE(trusting) {
    UNUSED;
    double *buffer = call->buffer(call, TENON_F64, 1);
    *(volatile double *)buffer = number(in);
    return give_as(call, TENON_NUMBER, buffer);
}
/* huge-numbers */
EVALUATE(fragile) {
    UNUSED;
    if (number(in) > 1e100) *(volatile int *)(uintptr_t)8 = 1;
    return give(call, number(in));
}
/* keeps-quiet-afterwards */
static void *haunt(void *call) {
    usleep(20000);
    ((const tenon_call *)call)->cancelled(call);
    return NULL;
}
EVALUATE(haunting) {
    pthread_t thread;
    UNUSED;
    if (pthread_create(&thread, NULL, haunt, (void *)(uintptr_t)call) == 0) pthread_detach(thread);
    return give(call, number(in));
}
/* newer-host */
EVALUATE(shortsighted) {
    const tenon_curve *curves = in[0].branches[0].column.items;
    double points = 0;
    UNUSED;
    /* Not by the stride. */
    for (uint64_t i = 0; i < in[0].branches[0].column.count; i++) points += (double)(curves[i].point_count % 1000);
    return give(call, points);
}
/* newer-host */
EVALUATE(strict) {
    UNUSED;
    return call->size == sizeof(tenon_call) && in->size == sizeof(tenon_tree) &&
                   in->branches->column.size == sizeof(tenon_column)
               ? give(call, number(in))
               : TENON_FAILED;
}
/* older-host */
EVALUATE(presumptuous) {
    /* What a later version has there, without a look at call->size. */
    uint64_t later = *(const volatile uint64_t *)(call + 1);
    UNUSED, (void)later;
    return give(call, number(in));
}
/* brings-nodes-forward, old-nodes-that-are-none */
static tenon_status forgetting(void *data, uint32_t from, tenon_str node, void (*tell)(void *, tenon_str), void *to) {
    tenon_str nothing = TEXT(""), list = TEXT("[]");
    (void)data, (void)from;
    tell(to, node.len > 2 && node.ptr[0] == '{' ? list : nothing);
    return node.len > 2 ? TENON_OK : TENON_FAILED;
}
EVALUATE(outdated) {
    UNUSED;
    return give(call, number(in));
}
/* No check: it waits for numbers that checks do not try, and is there for processes of their own to contain. */
static void *tell_elsewhere(void *call) {
    tenon_message message = {sizeof message, TENON_NOTE, TEXT("elsewhere"), TEXT("Hello."), {NULL, 0}, {NULL, 0}, 0};
    ((const tenon_call *)call)->tell(call, &message);
    return NULL;
}
EVALUATE(doomed) {
    double x = number(in);
    pthread_t thread;
    UNUSED;
    if (x == 101) *(volatile int *)(uintptr_t)8 = 1;
    if (x == 102) abort();
    while (x == 103) continue;
    while (x == 104) {
        /* Touched, so that it is taken. Nobody looks whether there is any, as usual. */
        char *more = malloc(1 << 24);
        memset(more, 1, 1 << 24);
    }
    if (x == 105) exit(3);
    if (x == 106 && pthread_create(&thread, NULL, tell_elsewhere, (void *)(uintptr_t)call) == 0)
        pthread_join(thread, NULL);
    if (x == 107) {
        close(3), close(4), close(5), close(6);
        for (;;) pause();
    }
    while (x == 108 && !call->cancelled(call)) continue;
    if (x == 108) return TENON_CANCELLED;
    while (x == 109) call->progress(call, 0.5);
    if (x == 110) {
        /* One buffer for two values. */
        double *buffer = call->buffer(call, TENON_F64, 1);
        return give_as(call, TENON_NUMBER, buffer) == TENON_OK ? give_as(call, TENON_NUMBER, buffer) : TENON_OK;
    }
    return give(call, x);
}
/* calls-from-its-own-thread */
EVALUATE(straying) {
    pthread_t thread;
    UNUSED;
    if (pthread_create(&thread, NULL, tell_elsewhere, (void *)(uintptr_t)call) == 0) pthread_join(thread, NULL);
    return give(call, number(in));
}
#ifndef LOADABLE
/* node-docs, port-docs, defaults-are-accepted: see its description */
EVALUATE(hasty) {
    UNUSED;
    return give(call, number(in));
}
#endif

#define INPUT(doc, value)                                                                                                \
    {sizeof(tenon_port), TENON_RANGE, TENON_NUMBER, TENON_ITEM, TEXT("x"), TEXT(doc), TEXT(""), TEXT(value), 0, 10, NULL, 0}
static const tenon_port inputs[] = {INPUT("A number.", "1")};
#ifndef LOADABLE
static const tenon_port careless[] = {INPUT("number", "11")};
#endif
static const tenon_port boundless[] = {
    {sizeof(tenon_port), 0, TENON_NUMBER, TENON_ITEM, TEXT("x"), TEXT("A number."), TEXT(""), TEXT("1"), 0, 0, NULL, 0}};
static const tenon_port curves[] = {
    {sizeof(tenon_port), 0, TENON_CURVE, TENON_LIST, TEXT("x"), TEXT("Curves."), TEXT(""), TEXT(""), 0, 0, NULL, 0}};
static const tenon_port outputs[] = {
    {sizeof(tenon_port), 0, TENON_NUMBER, TENON_ITEM, TEXT("y"), TEXT("A number."), TEXT(""), TEXT(""), 0, 0, NULL, 0}};

#define TYPE(function, words, ports)                                                                                     \
    {sizeof(tenon_node_type), TENON_PURE, TEXT("misbehaving." #function), 1, 1, ports, outputs, 1, sizeof(tenon_port),   \
     TEXT(#function), TEXT("Misdeeds"), TEXT(words), TEXT("misdeed"), NULL, function, NULL, 0, 0}

static const tenon_node_type nodes[] = {
    TYPE(forgetful, "Adds to what it had.", inputs),
    TYPE(divider, "Divides by nothing.", inputs),
    TYPE(lazy, "Gives nothing.", inputs),
    TYPE(silent, "Fails without a word.", inputs),
    TYPE(deaf, "Does not stop.", inputs),
    TYPE(scribbler, "Writes to its input.", inputs),
    TYPE(furtive, "Writes to its input and undoes it.", inputs),
    TYPE(liar, "Gives what it did not declare.", inputs),
    TYPE(backwards, "Gets further from its end.", inputs),
    TYPE(wanderer, "Leaves the working directory.", inputs),
    TYPE(mumbler, "Says nothing that helps.", inputs),
    TYPE(trusting, "Takes memory for granted.", inputs),
    TYPE(fragile, "Crashes.", boundless),
    TYPE(haunting, "Calls back when it is too late.", inputs),
    TYPE(shortsighted, "Goes its own way from curve to curve.", curves),
    TYPE(strict, "Takes structs of one size only.", inputs),
    TYPE(presumptuous, "Reads what only later versions have.", inputs),
    {sizeof(tenon_node_type), TENON_PURE, TEXT("misbehaving.outdated"), 2, 1, inputs, outputs, 1, sizeof(tenon_port),
     TEXT("outdated"), TEXT("Misdeeds"), TEXT("Loses its older self."), TEXT("misdeed"), NULL, outdated, forgetting, 1, 0},
    TYPE(doomed, "Dies by some numbers.", boundless),
    TYPE(straying, "Speaks through others.", inputs),
#ifndef LOADABLE /* A graph's host refuses the whole library for its default. */
    TYPE(hasty, "no sentence", careless),
#endif
};

/* version */
static const tenon_plugin plugin = {TENON_PLUGIN_MAGIC, sizeof(tenon_plugin), TENON_PLUGIN_MAJOR, TENON_PLUGIN_MINOR,
                                    TEXT("misbehaving"), TEXT("one"), TEXT("Tenon's examples"),
                                    TEXT("Misbehaves on purpose."), nodes, COUNT(nodes), sizeof(tenon_node_type), NULL};

TENON_EXPORT const tenon_plugin *tenon_plugin_v1(void);
const tenon_plugin *tenon_plugin_v1(void) {
#ifdef LATE /* It does not say who it is before there is such a file. */
    while (access(LATE, F_OK) != 0) usleep(10000);
#endif
    return &plugin;
}
