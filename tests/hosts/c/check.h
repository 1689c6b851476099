/* SPDX-License-Identifier: BSD-3-Clause */
/* What the tests of lockstep from C share: checks, scenes with single quotes, a value of a column. */
#ifndef LOCKSTEP_TESTS_HOSTS_C_CHECK_H
#define LOCKSTEP_TESTS_HOSTS_C_CHECK_H

#include <lockstep/c.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>

extern int failures, checks;
extern const char *program, *scenes, *output; /* lockstep, samples/scenes, a folder for files */

#define CHECK(what) \
  (++checks, (what) ? (void)0 : (void)(++failures, printf("%s:%d: not so: %s\n", __FILE__, __LINE__, #what)))
#define CHECK_NEAR(a, b, by) check_near(__FILE__, __LINE__, #a, (a), (b), (by))
/* A call that has to succeed; of handle `h` the error is printed. */
#define DONE(h, call) check_done(__FILE__, __LINE__, #call, (call), (h))

void check_near(const char* file, int line, const char* what, double is, double should_be, double by);
void check_done(const char* file, int line, const char* what, int code, const void* handle);
/* The text with " in place of ', in one of a few static places. */
const char* quoted(const char* text);
/* The run of a scene with ' in place of ", by a registry or null. */
lockstep_run* run_of(lockstep_registry* registry, const char* scene);
int column(lockstep_run* run, const char* name);
double last(lockstep_run* run, const char* name);
const double* values(lockstep_run* run, const char* name);
/* Whether the error of the handle has this code, and all these words (to a null) in its text. */
int is_error(const void* handle, int code, int expected, const char* words, ...);
int is_utf8(const char* text);
int64_t rows(lockstep_run* run);

void test_results(void);
void test_types(void);
void test_callbacks(void);
void test_states(void);
void test_misuse(void);
void test_threads(void);
void test_random(void);

#endif
