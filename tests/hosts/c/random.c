/* SPDX-License-Identifier: BSD-3-Clause */
/* Random calls in random order on random handles, null, freed and of the wrong kind, in two threads: always a code. */
#include <pthread.h>

#include "check.h"

static const char* const scene =
    "{'lockstep': 1, 'gravity': [0, -9.81, 0], 'bodies': [{'name': 'b', 'rod': {'mass': 1, 'from': [0, 0, 0],"
    " 'to': [1, 0, 0]}}], 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'b', 's': 'ground', 'at': [0, 0, 0]}],"
    " 'forces': [{'name': 'm', 'type': 'torque_motor', 'p': 'b', 's': 'ground', 'at': [0, 0, 0],"
    " 'torque': {'type': '%s', %s}}], 'run': {'until': 0.02, 'record': ['A.rz', 'energy.total']}}";

enum { places = 5 };
struct calls {
  unsigned long seed;
  char file[1100], built_in[1024], mine[1024];
  void* handle[places];
  long made, done, wrong;
};

static unsigned draw(struct calls* c, unsigned below) {
  c->seed = (c->seed * 1103515245UL + 12345UL) & 0x7fffffffUL;
  return (unsigned)(c->seed >> 8) % below;
}
static int law(void* user, const double* p, double t, double* y) {
  (void)user;
  y[0] = p[0] * t, y[1] = p[0], y[2] = 0;
  return t > 0.015 ? lockstep_fail("late") : 0;
}
static int observe(void* user, const lockstep_state* state) {
  struct calls* const c = user;
  double pose[7];
  const int code = lockstep_body(state, "b", pose, NULL);
  (void)lockstep_advance(c->handle[draw(c, places)], 1e-4); /* its own run, or another one */
  return draw(c, 8) == 0 ? LOCKSTEP_STOP : code;
}
static int act(void* user, lockstep_state* state) {
  (void)user;
  return draw(user, 4) == 0 ? 3 : lockstep_set_body(state, "b", NULL, NULL);
}

static int one_call(struct calls* c) {
  void** const place = &c->handle[draw(c, places)];
  void* const h = *place;
  double numbers[64] = {0};
  const double* values = NULL;
  const char* text = NULL;
  int n = 0, k = (int)draw(c, 5) - 1;
  int64_t m = 0;
  switch (draw(c, 40)) {
    case 0:
      return lockstep_free(h);
    case 1:
      *place = NULL;
      lockstep_free(h);
      return lockstep_new_registry((lockstep_registry**)place);
    case 2:
      *place = NULL;
      lockstep_free(h);
      return lockstep_open_text(NULL, c->built_in, NULL, NULL, (lockstep_run**)place);
    case 3:
      *place = NULL;
      lockstep_free(h);
      return lockstep_open_text(c->handle[draw(c, places)], c->mine, NULL, NULL, (lockstep_run**)place);
    case 4:
      *place = NULL;
      lockstep_free(h);
      return lockstep_get_state(c->handle[draw(c, places)], (lockstep_state**)place);
    case 5:
      return lockstep_add_law(h, "mine", "a", law, NULL, NULL, NULL);
    case 6:
      return lockstep_types(h, &text);
    case 7:
      return lockstep_record(h, k > 1 ? "b.x" : "b.nothing", NULL);
    case 8:
      return lockstep_set_input(h, k, k);
    case 9:
      return lockstep_input(h, k, &text, &text, numbers);
    case 10:
      return lockstep_run_to_end(h);
    case 11:
      return lockstep_run_until(h, 0.01 * k);
    case 12:
      return lockstep_advance(h, 0.001 * k);
    case 13:
      return lockstep_step(h, 0.001 * k, numbers);
    case 14:
      return lockstep_time(h, k > 0 ? numbers : NULL);
    case 15:
      return lockstep_switch(h, "m", k > 1);
    case 16:
      return lockstep_save(h, c->file);
    case 17:
      return lockstep_load(h, c->file);
    case 18:
      return lockstep_values(h, k, &values, &m);
    case 19:
      return lockstep_last(h, k, numbers);
    case 20:
      return lockstep_extremes(h, k, numbers);
    case 21:
      return lockstep_verdict(h, &n);
    case 22:
      return lockstep_report(h, &text);
    case 23:
      return lockstep_finding(h, k, &text, &text);
    case 24:
      return lockstep_linearize(h, k > 1 ? "A.rz" : NULL, k > 0, NULL);
    case 25:
      return lockstep_matrix(h, 'A' + k, &values, &n, &n);
    case 26:
      return lockstep_signals(h, &text);
    case 27:
      return lockstep_on_step(h, k > 0 ? observe : NULL, c, NULL);
    case 28:
      return lockstep_add_event(h, "e", k > 1 ? "A.rz" : NULL, NULL, 0.001 * k, k, 1, k > 2 ? act : NULL, c, NULL);
    case 29:
      return lockstep_set_state(h, c->handle[draw(c, places)]);
    case 30:
      return lockstep_body(h, k > 0 ? "b" : "c", numbers, numbers + 7);
    case 31:
      return lockstep_set_body(h, "b", k > 0 ? numbers : NULL, numbers + 7);
    case 32:
      return lockstep_numbers(h, numbers, 13 + k);
    case 33:
      return lockstep_set_numbers(h, 0.001 * k, numbers, 13);
    case 34:
      return lockstep_rates(h, numbers, 13 + (int)draw(c, 8));
    case 35:
      return lockstep_move(h, 1e-3 * k, NULL, 0);
    case 36:
      return lockstep_project(h, numbers);
    case 37:
      return lockstep_sizes(h, numbers, &n, &n, &n);
    case 38:
      return (int)strlen(lockstep_error_text(h)) * 0;
    default:
      return lockstep_findings(h, &n);
  }
}

static void* call_all(void* of) {
  struct calls* const c = of;
  int i;
  for (i = 0; i < 4000; ++i) {
    const int code = one_call(c);
    ++c->made, c->done += code == LOCKSTEP_DONE;
    c->wrong += code < LOCKSTEP_DONE || code > LOCKSTEP_BUSY;
  }
  for (i = 0; i < places; ++i) lockstep_free(c->handle[i]);
  return NULL;
}

void test_random(void) {
  static struct calls all[2];
  pthread_t thread[2];
  int i;
  for (i = 0; i < 2; ++i) {
    char text[1024];
    all[i].seed = 7 + (unsigned long)i;
    snprintf(all[i].file, sizeof all[i].file, "%s/c_random_%d.checkpoint", output, i);
    snprintf(text, sizeof text, scene, "input", "'name': 'u'");
    strcpy(all[i].built_in, quoted(text));
    snprintf(text, sizeof text, scene, "mine", "'a': 1");
    strcpy(all[i].mine, quoted(text));
  }
  for (i = 0; i < 2; ++i) CHECK(pthread_create(&thread[i], NULL, call_all, &all[i]) == 0);
  for (i = 0; i < 2; ++i) {
    CHECK(pthread_join(thread[i], NULL) == 0);
    printf("%ld calls, %ld done\n", all[i].made, all[i].done);
    CHECK(all[i].wrong == 0 && all[i].made == 4000 && all[i].done > 400);
  }
}
