/* SPDX-License-Identifier: BSD-3-Clause */
/* Events, observers and rows: a ball of 1 kg that falls from 5 m, y = 5 - g t^2 / 2. */
#include "check.h"

static const double g = 10;
static const char* const ball =
    "{'lockstep': 1, 'gravity': [0, -10, 0], 'bodies': [{'name': 'ball', 'sphere': {'mass': 1, 'radius': 0.1},"
    " 'position': [0, 5, 0]}], 'run': {'until': 4, 'output': 0.1, 'tolerance': 1e-10, 'record': ['ball.y', "
    "'ball.vy']}}";

static int height(void* user, const lockstep_state* state, double* value) {
  double pose[7];
  (void)user;
  if (lockstep_body(state, "ball", pose, NULL) != 0) return lockstep_fail(lockstep_error_text(state));
  *value = pose[1];
  return 0;
}

static int bounce(void* user, lockstep_state* state) {
  double twist[6];
  ++*(int*)user;
  if (lockstep_body(state, "ball", NULL, twist) != 0) return 1;
  twist[1] = -twist[1];
  return lockstep_set_body(state, "ball", NULL, twist);
}
static int late(void* user, lockstep_state* state) {
  double t, y[13];
  (void)user;
  CHECK(lockstep_sizes(state, &t, NULL, NULL, NULL) == 0);
  CHECK(lockstep_numbers(state, y, 13) == 0);
  CHECK(lockstep_rates(state, y, 13) == LOCKSTEP_USAGE);
  CHECK(lockstep_set_numbers(state, t + 1, y, 13) == LOCKSTEP_USAGE);
  CHECK(strstr(lockstep_error_text(state), "time") != NULL);
  return lockstep_fail("too late");
}
static void count_free(void* user) { ++*(int*)user; }

/* It bounces at t = 1 and 3 without loss: y = 5 again at t = 2. */
static void events(void) {
  int bounces = 0, freed = 0;
  lockstep_run* run = run_of(NULL, ball);
  DONE(run, lockstep_add_event(run, "floor", NULL, height, 0, -1, 0, bounce, &bounces, NULL));
  CHECK(lockstep_add_event(run, "late", NULL, NULL, 3.5, 0, 1, late, &freed, count_free) == LOCKSTEP_DONE);
  CHECK(lockstep_add_event(run, "both", "ball.y", height, 0, 0, 1, NULL, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_add_event(run, "crossing", "ball.y", NULL, 0, 2, 1, NULL, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_add_event(run, "none", "ball.nothing", NULL, 0, 0, 1, NULL, NULL, NULL) == LOCKSTEP_MODEL);
  CHECK(lockstep_add_event(run, NULL, "ball.y", NULL, 0, 0, 1, NULL, NULL, NULL) == LOCKSTEP_NULL);
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_USER_CODE);
  CHECK(strstr(lockstep_error_text(run), "too late") != NULL && strstr(lockstep_error_text(run), "late") != NULL);
  CHECK(bounces == 2);
  CHECK_NEAR(values(run, "ball.y")[20], 5, 1e-8);
  CHECK_NEAR(values(run, "ball.vy")[15], g * 0.5, 1e-8);
  CHECK_NEAR(last(run, "ball.y"), 5 - 0.5 * g * 1 + g * 0.5 - 0.5 * g * 0.25 + 0, 1e-8);
  DONE(run, lockstep_free(run));
  CHECK(freed == 1);

  run = run_of(NULL, ball); /* the run ends where the channel crosses 3.75 m, at t = 0.5 */
  DONE(run, lockstep_add_event(run, "ends", "ball.y", NULL, 3.75, -1, 1, NULL, NULL, NULL));
  DONE(run, lockstep_run_to_end(run));
  {
    double t = 0;
    const char* json = NULL;
    DONE(run, lockstep_time(run, &t));
    CHECK_NEAR(t, 0.5, 1e-8);
    DONE(run, lockstep_report(run, &json));
    CHECK(strstr(json, "\"stopped_by\": \"ends\"") != NULL);
  }
  DONE(run, lockstep_free(run));
}

/* -- observers */
struct watch {
  lockstep_run* run;
  int steps, rows, busy;
  double sum;
  lockstep_state* kept;
};
static int watch_step(void* user, const lockstep_state* state) {
  struct watch* const w = user;
  double t = 0, pose[7];
  lockstep_state* other = NULL;
  ++w->steps;
  w->kept = (lockstep_state*)(uintptr_t)state;
  CHECK(lockstep_sizes(state, &t, NULL, NULL, NULL) == 0);
  CHECK(lockstep_body(state, "ball", pose, NULL) == 0);
  CHECK_NEAR(pose[1], 5 - 0.5 * g * t * t, 1e-8);
  /* its own run is in use, whatever is called */
  w->busy += lockstep_advance(w->run, 1) == LOCKSTEP_BUSY;
  w->busy += lockstep_free(w->run) == LOCKSTEP_BUSY;
  w->busy += lockstep_get_state(w->run, &other) == LOCKSTEP_BUSY && other == NULL;
  w->busy += lockstep_error_code(w->run) == LOCKSTEP_BUSY;
  CHECK(lockstep_set_body(w->kept, "ball", pose, NULL) == LOCKSTEP_USAGE); /* read only */
  CHECK(lockstep_rates(state, pose, 7) == LOCKSTEP_USAGE);
  return t >= 0.6 ? LOCKSTEP_STOP : 0;
}
static int watch_row(void* user, const double* row, int count) {
  struct watch* const w = user;
  CHECK(count == 3);
  CHECK_NEAR(row[1], 5 - 0.5 * g * row[0] * row[0], 1e-8);
  ++w->rows, w->sum += row[1];
  return 0;
}
static int fails(void* user, const double* row, int count) {
  (void)user, (void)count;
  return row[0] > 0.25 ? lockstep_fail("the disk is full") : 0;
}

static void observers(void) {
  struct watch w = {NULL, 0, 0, 0, 0, NULL};
  double t = 0;
  int freed = 0;
  lockstep_run* run = w.run = run_of(NULL, ball);
  DONE(run, lockstep_on_row(run, watch_row, 0, &w, NULL));
  DONE(run, lockstep_on_step(run, watch_step, &w, NULL));
  DONE(run, lockstep_run_to_end(run));
  DONE(run, lockstep_time(run, &t));
  CHECK(t >= 0.6 && t < 4);
  CHECK(w.steps > 0 && w.busy == 4 * w.steps);
  CHECK(w.rows >= 7 && rows(run) == 0);                                   /* the table keeps none */
  CHECK(lockstep_sizes(w.kept, &t, NULL, NULL, NULL) == LOCKSTEP_CLOSED); /* after the call */
  DONE(run, lockstep_on_step(run, NULL, &freed, count_free));             /* no observer: user data is freed at once */
  CHECK(freed == 1);
  DONE(run, lockstep_on_row(run, NULL, 0, NULL, NULL));
  DONE(run, lockstep_run_until(run, t + 1));
  CHECK(rows(run) > 0);
  DONE(run, lockstep_free(run));

  run = run_of(NULL, ball);
  DONE(run, lockstep_on_row(run, fails, 1, NULL, NULL));
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_USER_CODE);
  CHECK(strstr(lockstep_error_text(run), "the disk is full") != NULL);
  DONE(run, lockstep_free(run));
}

/* A run inside a callback of another one, with another handle. */
static int nested(void* user, const double* row, int count) {
  lockstep_run* run = run_of(NULL, ball);
  (void)count;
  DONE(run, lockstep_run_until(run, row[0]));
  CHECK_NEAR(last(run, "ball.y"), row[1], 1e-9);
  ++*(int*)user;
  return lockstep_free(run);
}

void test_callbacks(void) {
  int calls = 0;
  lockstep_run* run;
  CHECK(lockstep_fail("no callback is in progress") == LOCKSTEP_USER_CODE);
  events();
  observers();
  run = run_of(NULL, ball);
  DONE(run, lockstep_on_row(run, nested, 0, &calls, NULL));
  DONE(run, lockstep_run_until(run, 0.3));
  CHECK(calls == 4);
  DONE(run, lockstep_free(run));
}
