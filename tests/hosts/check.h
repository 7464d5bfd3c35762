/* What the hosts in C share: checks that end the program, errors in words, reading panels in place. */
#ifndef CHECK_H
#define CHECK_H

#include "tenon.h"
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

#define CHECK(condition)                                                                                                 \
    do {                                                                                                                 \
        if (!(condition)) {                                                                                              \
            fprintf(stderr, "%s:%d: %s\n", __FILE__, __LINE__, #condition);                                              \
            exit(1);                                                                                                     \
        }                                                                                                                \
    } while (0)

static inline void must(tenon_error *error) {
    if (error != NULL) {
        tenon_str message = tenon_error_message(error);
        fprintf(stderr, "error %d: %.*s\n", (int)tenon_error_status(error), (int)message.len, message.ptr);
        exit(1);
    }
}

/* The call must fail with that status and words that hold `part`. */
static inline void refused(tenon_error *error, tenon_status status, const char *part) {
    if (error == NULL) {
        fprintf(stderr, "not refused, although \"%s\"\n", part);
        exit(1);
    }
    CHECK(tenon_error_status(error) == status);
    tenon_str message = tenon_error_message(error);
    char text[1000] = {0};
    memcpy(text, message.ptr, message.len < sizeof text ? (size_t)message.len : sizeof text - 1);
    if (strstr(text, part) == NULL) {
        fprintf(stderr, "\"%s\" does not say \"%s\"\n", text, part);
        exit(1);
    }
    tenon_error_free(error);
    tenon_error_free(error); /* a second time does nothing */
}

/* A text that the library made must hold `part`; frees it. */
static inline void says(tenon_text *text, const char *part) {
    tenon_str given = tenon_text_get(text);
    char *copy = malloc((size_t)given.len + 1);
    CHECK(copy != NULL);
    memcpy(copy, given.ptr, (size_t)given.len);
    copy[given.len] = 0;
    if (strstr(copy, part) == NULL) {
        fprintf(stderr, "\"%.2000s\" does not say \"%s\"\n", copy, part);
        exit(1);
    }
    free(copy);
    tenon_text_free(text);
}

static inline char *read_all(const char *path, uint64_t *length) {
    FILE *file = fopen(path, "rb");
    CHECK(file != NULL);
    CHECK(fseek(file, 0, SEEK_END) == 0);
    long size = ftell(file);
    CHECK(size > 0 && fseek(file, 0, SEEK_SET) == 0);
    char *text = malloc((size_t)size);
    CHECK(text != NULL && fread(text, 1, (size_t)size, file) == (size_t)size);
    fclose(file);
    *length = (uint64_t)size;
    return text;
}

/* The panels of a result, read in place. */
static inline const tenon_panels *panels_of(const tenon_result *result) {
    tenon_tree tree = {.size = sizeof tree};
    must(tenon_result_output(result, "panels", &tree));
    CHECK(tree.branch_count == 1 && tree.branches[0].column.kind == TENON_PANELS);
    CHECK(tree.branches[0].column.count == 1 && tree.branches[0].column.valid == NULL);
    const tenon_panels *panels = tree.branches[0].column.items;
    CHECK(panels->corner_start[panels->panel_count] == panels->corner_count);
    return panels;
}

static inline double highest(const tenon_panels *panels) {
    double z = -INFINITY;
    for (uint64_t i = 0; i < panels->corner_count; i++) {
        CHECK(isfinite(panels->front[i].x) && isfinite(panels->front[i].y) && isfinite(panels->front[i].z));
        z = fmax(z, panels->front[i].z);
    }
    return z;
}

#endif
