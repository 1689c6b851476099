/* SPDX-License-Identifier: BSD-3-Clause */
/* Two threads on two handles, and on one. */
#define _GNU_SOURCE
#include <dlfcn.h>
#include <pthread.h>

#include "check.h"

static const char* const pendulum =
    "{'lockstep': 1, 'gravity': [0, -9.81, 0],"
    " 'bodies': [{'name': 'rod', 'rod': {'mass': 1, 'from': [0, 0, 0], 'to': [1, 0, 0]}}],"
    " 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'rod', 's': 'ground', 'at': [0, 0, 0]}],"
    " 'forces': [{'name': 'F', 'type': 'drag', 'p': 'rod', 'at': [1, 0, 0], 'c': 0.1}],"
    " 'run': {'until': 2, 'output': 0.01, 'tolerance': 1e-9, 'record': ['A.rz']}}";

static int drag(void* user, const double* p, double t, const double P[13], const double S[13], double out[9]) {
  int i;
  (void)user, (void)t, (void)S;
  for (i = 0; i < 3; ++i) out[i] = -p[0] * P[7 + i], out[7] += p[0] * P[7 + i] * P[7 + i];
  return 0;
}

/* -- two handles: equal to the last bit */
static void* run_all(void* handle) { return (void*)(intptr_t)lockstep_run_to_end(handle); }

static void two_handles(lockstep_registry* registry) {
  lockstep_run* run[3];
  pthread_t thread[2];
  int i, k;
  for (i = 0; i < 3; ++i) run[i] = run_of(registry, pendulum);
  for (i = 0; i < 2; ++i) CHECK(pthread_create(&thread[i], NULL, run_all, run[i]) == 0);
  for (i = 0; i < 2; ++i) {
    void* code = NULL;
    CHECK(pthread_join(thread[i], &code) == 0);
    CHECK((intptr_t)code == LOCKSTEP_DONE);
  }
  DONE(run[2], lockstep_run_to_end(run[2]));
  for (i = 0; i < 2; ++i)
    for (k = 0; k < 201; ++k) CHECK(values(run[i], "A.rz")[k] == values(run[2], "A.rz")[k]);
  for (i = 0; i < 3; ++i) DONE(run[i], lockstep_free(run[i]));
}

/* -- one handle: every call returns done or busy, and at most one is in progress */
struct shared {
  lockstep_run* run;
  int done, busy, other;
};
static void* call_often(void* of) {
  struct shared* const s = of;
  int i;
  for (i = 0; i < 2000; ++i) {
    double x = 0;
    int n = 0;
    const int codes[] = {lockstep_advance(s->run, 1e-3), lockstep_time(s->run, &x), lockstep_findings(s->run, &n),
                         lockstep_error_code(s->run) == LOCKSTEP_BUSY ? LOCKSTEP_BUSY : LOCKSTEP_DONE};
    size_t k;
    for (k = 0; k < sizeof codes / sizeof codes[0]; ++k) {
      s->done += codes[k] == LOCKSTEP_DONE;
      s->busy += codes[k] == LOCKSTEP_BUSY;
      s->other += codes[k] != LOCKSTEP_DONE && codes[k] != LOCKSTEP_BUSY;
    }
  }
  return NULL;
}

static void one_handle(lockstep_registry* registry) {
  lockstep_run* const run = run_of(registry, pendulum);
  struct shared each[2] = {{run, 0, 0, 0}, {run, 0, 0, 0}};
  pthread_t thread[2];
  int i;
  for (i = 0; i < 2; ++i) CHECK(pthread_create(&thread[i], NULL, call_often, &each[i]) == 0);
  for (i = 0; i < 2; ++i) CHECK(pthread_join(thread[i], NULL) == 0);
  CHECK(each[0].other == 0 && each[1].other == 0 && each[0].done + each[1].done > 0);
  DONE(run, lockstep_free(run));
}

/* A thread frees and reads errors while the other one is inside a callback of the run: it is told to wait. */
struct inside {
  lockstep_run* run;
  pthread_t thread;
  int started;
  intptr_t codes[2];
};
static void* free_it(void* of) {
  struct inside* const s = of;
  s->codes[0] = lockstep_free(s->run), s->codes[1] = lockstep_error_code(s->run);
  return NULL;
}
static int from_inside(void* user, const lockstep_state* state) {
  struct inside* const s = user;
  (void)state;
  if (s->started++ > 0) return 0;
  CHECK(pthread_create(&s->thread, NULL, free_it, s) == 0);
  CHECK(pthread_join(s->thread, NULL) == 0);
  return 0;
}

/* Another thread frees the run after a call has looked the handle up, before it holds the run: the call finds that, and
   calls nothing back. The table of handles is left by an unlock, where this frees the run in place of the other thread. */
static _Thread_local lockstep_run* freed_at_unlock = NULL;
static int frees = 0, late = 0;
extern int __interceptor_pthread_mutex_unlock(pthread_mutex_t*) __attribute__((weak)); /* of a thread sanitizer */
int pthread_mutex_unlock(pthread_mutex_t* mutex) {
  static int (*unlock)(pthread_mutex_t*) = NULL;
  lockstep_run* const run = freed_at_unlock;
  int code;
  if (unlock == NULL) unlock = __interceptor_pthread_mutex_unlock;
  if (unlock == NULL) *(void**)&unlock = dlsym(RTLD_NEXT, "pthread_mutex_unlock");
  code = unlock(mutex);
  freed_at_unlock = NULL;
  if (run != NULL) frees += lockstep_free(run) == LOCKSTEP_DONE;
  return code;
}
static int watched(void* user, const double* p, double t, double* y) {
  (void)user, (void)p;
  late += frees > 0;
  y[0] = t, y[1] = 1, y[2] = 0;
  return 0;
}
static void free_before_hold(lockstep_registry* registry) {
  lockstep_run* run;
  double t = 0;
  DONE(registry, lockstep_add_law(registry, "watched", NULL, watched, NULL, NULL, NULL));
  run = run_of(registry,
               "{'lockstep': 1, 'bodies': [{'name': 'b', 'mass': 1, 'inertia': [1, 1, 1]}], 'forces': [{'name': 'F',"
               " 'type': 'applied_force', 'p': 'b', 'at': [0, 0, 0], 'direction': 'x', 'law': {'type': 'watched'}}],"
               " 'run': {'until': 1}}");
  DONE(run, lockstep_time(run, &t));
  freed_at_unlock = run;
  CHECK(lockstep_advance(run, 0.1) == LOCKSTEP_CLOSED);
  CHECK(frees == 1 && late == 0);
  CHECK(lockstep_free(run) == LOCKSTEP_CLOSED);
}

void test_threads(void) {
  lockstep_registry* registry = NULL;
  struct inside in = {NULL, 0, 0, {0, 0}};
  DONE(registry, lockstep_new_registry(&registry));
  DONE(registry, lockstep_add_force(registry, "drag", "c", drag, NULL, NULL));
  two_handles(registry);
  one_handle(registry);
  in.run = run_of(registry, pendulum);
  DONE(in.run, lockstep_on_step(in.run, from_inside, &in, NULL));
  DONE(in.run, lockstep_run_until(in.run, 0.1));
  CHECK(in.codes[0] == LOCKSTEP_BUSY && in.codes[1] == LOCKSTEP_BUSY);
  DONE(in.run, lockstep_free(in.run));
  free_before_hold(registry);
  DONE(registry, lockstep_free(registry));
}
