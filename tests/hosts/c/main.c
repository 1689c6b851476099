/* SPDX-License-Identifier: BSD-3-Clause */
/* test_c CASE PROGRAM SCENES OUTPUT */
#include <stdarg.h>

#include "check.h"

int failures = 0, checks = 0;
const char *program, *scenes, *output;

void check_near(const char* file, int line, const char* what, double is, double should_be, double by) {
  ++checks;
  if (fabs(is - should_be) <= by) return;
  ++failures;
  printf("%s:%d: %s is %.17g; should be %.17g within %g\n", file, line, what, is, should_be, by);
}

void check_done(const char* file, int line, const char* what, int code, const void* handle) {
  ++checks;
  if (code == LOCKSTEP_DONE) return;
  ++failures;
  printf("%s:%d: %s: %s: %s\n", file, line, what, lockstep_code_name(code), lockstep_error_text(handle));
}

const char* quoted(const char* text) {
  static char place[4][4096];
  static int next = 0;
  char* const to = place[next = (next + 1) % 4];
  size_t i = 0;
  for (; text[i] != 0 && i + 1 < sizeof place[0]; ++i) to[i] = text[i] == '\'' ? '"' : text[i];
  to[i] = 0;
  return to;
}

lockstep_run* run_of(lockstep_registry* registry, const char* scene) {
  lockstep_run* run = NULL;
  DONE(run, lockstep_open_text(registry, quoted(scene), "test", NULL, &run));
  return run;
}

int column(lockstep_run* run, const char* name) {
  int k = -1;
  DONE(run, lockstep_column_index(run, name, &k));
  return k;
}

double last(lockstep_run* run, const char* name) {
  double value = NAN;
  DONE(run, lockstep_last(run, column(run, name), &value));
  return value;
}

const double* values(lockstep_run* run, const char* name) {
  const double* all = NULL;
  DONE(run, lockstep_values(run, column(run, name), &all, NULL));
  return all;
}

int is_error(const void* handle, int code, int expected, const char* words, ...) {
  const char *text = lockstep_error_text(handle), *word;
  va_list more;
  int good = code == expected && lockstep_error_code(handle) == expected && is_utf8(text);
  va_start(more, words);
  for (word = words; word != NULL; word = va_arg(more, const char*)) good = good && strstr(text, word) != NULL;
  va_end(more);
  if (!good) printf("%d instead of %d: %s\n", code, expected, text);
  return good;
}

int is_utf8(const char* text) {
  const unsigned char* p = (const unsigned char*)text;
  while (*p != 0) {
    int more = *p < 0x80 ? 0 : *p >> 5 == 6 ? 1 : *p >> 4 == 14 ? 2 : *p >> 3 == 30 ? 3 : -1;
    if (more < 0) return 0;
    for (++p; more > 0; --more, ++p)
      if ((*p & 0xc0) != 0x80) return 0;
  }
  return 1;
}

int64_t rows(lockstep_run* run) {
  int64_t n = -1;
  DONE(run, lockstep_table(run, NULL, &n));
  return n;
}

int main(int argc, char** argv) {
  const struct {
    const char* name;
    void (*test)(void);
  } cases[] = {{"results", test_results}, {"types", test_types},   {"callbacks", test_callbacks},
               {"states", test_states},   {"misuse", test_misuse}, {"threads", test_threads},
               {"random", test_random}};
  size_t i;
  if (argc < 5) return 2;
  program = argv[2], scenes = argv[3], output = argv[4];
  for (i = 0; i < sizeof cases / sizeof cases[0]; ++i)
    if (strcmp(argv[1], cases[i].name) == 0) {
      cases[i].test();
      printf("%d checks, %d failed\n", checks, failures);
      return checks == 0 || failures != 0;
    }
  printf("there is no case %s\n", argv[1]);
  return 2;
}
