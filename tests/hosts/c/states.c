/* SPDX-License-Identifier: BSD-3-Clause */
/* States out and in, single steps, switches and checkpoints. */
#include "check.h"

/* A double pendulum, whose joints need consistent poses and velocities. */
static const char* const chain =
    "{'lockstep': 1, 'gravity': [0, -9.81, 0],"
    " 'bodies': [{'name': 'a', 'rod': {'mass': 1, 'from': [0, 0, 0], 'to': [1, 0, 0]}},"
    " {'name': 'b', 'rod': {'mass': 1, 'from': [1, 0, 0], 'to': [2, 0, 0]}}],"
    " 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'a', 's': 'ground', 'at': [0, 0, 0]},"
    " {'name': 'B', 'type': 'revolute', 'p': 'b', 's': 'a', 'at': [1, 0, 0]}],"
    " 'forces': [{'name': 'push', 'type': 'applied_torque', 'p': 'b', 'at': [2, 0, 0], 'torque': [0, 0, 1], 'active': "
    "false}],"
    " 'run': {'until': 1, 'output': 0.1, 'tolerance': 1e-9, 'record': ['A.rz', 'B.rz', 'energy.total']}}";

static void same_tables(lockstep_run* a, lockstep_run* b, int64_t from) {
  int c;
  int64_t k;
  CHECK(rows(a) == rows(b));
  for (c = 0; c < 4; ++c)
    for (k = from; k < rows(a) && k < rows(b); ++k) {
      const double *x = NULL, *y = NULL;
      DONE(a, lockstep_values(a, c, &x, NULL));
      DONE(b, lockstep_values(b, c, &y, NULL));
      CHECK(x[k] == y[k]);
    }
}

static void states(void) {
  lockstep_run* run = run_of(NULL, chain);
  lockstep_state* state = NULL;
  double t = -1, y[64], rate[64], pose[7], twist[6], start[7], violation = 1, h = 0;
  int q = 0, v = 0, s = 0, n, i;
  DONE(run, lockstep_run_until(run, 0.4));
  DONE(run, lockstep_get_state(run, &state));
  DONE(state, lockstep_sizes(state, &t, &q, &v, &s));
  n = q + v + s;
  CHECK(t == 0.4 && q == 14 && v == 12 && n <= 64);
  DONE(state, lockstep_numbers(state, y, n));
  CHECK(lockstep_numbers(state, y, n - 1) == LOCKSTEP_USAGE);
  DONE(state, lockstep_body(state, "a", pose, twist));
  CHECK_NEAR(hypot(pose[3], pose[6]), 1, 1e-12);
  CHECK_NEAR(2 * atan2(pose[6], pose[3]), last(run, "A.rz"), 1e-9);
  CHECK_NEAR(pose[0], 0.5 * cos(last(run, "A.rz")), 1e-9);
  CHECK(lockstep_body(state, "c", pose, twist) == LOCKSTEP_MODEL);
  /* q' = v of the centre of mass; e' e = 0; the constraints hold */
  DONE(state, lockstep_rates(state, rate, n));
  for (i = 0; i < 3; ++i) CHECK_NEAR(rate[i], y[q + i], 1e-12);
  CHECK_NEAR(rate[3] * y[3] + rate[4] * y[4] + rate[5] * y[5] + rate[6] * y[6], 0, 1e-12);
  DONE(state, lockstep_project(state, &violation));
  CHECK_NEAR(violation, 0, 1e-9);
  /* a small move: x grows by h v */
  DONE(state, lockstep_move(state, 1e-3, NULL, 0));
  DONE(state, lockstep_numbers(state, rate, n));
  for (i = 0; i < 3; ++i) CHECK_NEAR(rate[i], y[i] + 1e-3 * y[q + i], 1e-12);
  CHECK(lockstep_move(state, 1e-3, y, 3) == LOCKSTEP_USAGE);
  y[0] = NAN;
  CHECK(lockstep_set_numbers(state, 0, y, n) == LOCKSTEP_USAGE);
  CHECK(strstr(lockstep_error_text(state), "numbers[0]") != NULL);
  /* from the vertical position at rest nothing moves */
  for (i = 0; i < 2; ++i) {
    const double down[7] = {0, -0.5 - i, 0, sqrt(0.5), 0, 0, -sqrt(0.5)}, rest[6] = {0, 0, 0, 0, 0, 0};
    DONE(state, lockstep_set_body(state, i == 0 ? "a" : "b", down, rest));
  }
  memset(start, 0, sizeof start);
  CHECK(lockstep_set_body(state, "a", start, NULL) == LOCKSTEP_USAGE); /* no quaternion */
  CHECK(lockstep_set_body(state, "ground", NULL, start) == LOCKSTEP_MODEL);
  DONE(run, lockstep_set_state(run, state));
  DONE(run, lockstep_step(run, 0.01, &h));
  CHECK(h > 0 && h <= 0.01);
  DONE(run, lockstep_advance(run, 0.2));
  DONE(state, lockstep_free(state));
  DONE(run, lockstep_get_state(run, &state));
  DONE(state, lockstep_body(state, "b", pose, twist));
  CHECK_NEAR(pose[0], 0, 1e-9);
  CHECK_NEAR(pose[1], -1.5, 1e-9);
  DONE(run, lockstep_free(run));
  DONE(state, lockstep_rates(state, rate, n)); /* a state outlives its run */
  DONE(state, lockstep_free(state));
  CHECK(lockstep_rates(state, rate, n) == LOCKSTEP_CLOSED);
}

/* What is not finite never comes back as done: the body is named, and the state stays as it was. */
static int of_length_zero(void* user, lockstep_state* state) {
  double y[64] = {0}, t = 0;
  int q = 0, v = 0, s = 0;
  (void)user;
  CHECK(lockstep_sizes(state, &t, &q, &v, &s) == 0);
  CHECK(is_error(state, lockstep_set_numbers(state, t, y, q + v + s), LOCKSTEP_USAGE, "'a'", "quaternion", NULL));
  return 0;
}

static void not_finite(void) {
  lockstep_run* run = run_of(NULL, chain);
  lockstep_state* state = NULL;
  double y[64], z[64], t = -1;
  const double far[7] = {1e308, 0, 0, 1, 0, 0, 0}, fast[6] = {1e200, 0, 0, 0, 1e300, 0}, small[7] = {0, 0, 0, 1e-200};
  int q = 0, v = 0, s = 0, n, i, k;
  DONE(run, lockstep_get_state(run, &state));
  DONE(state, lockstep_sizes(state, &t, &q, &v, &s));
  n = q + v + s;
  for (k = 0; k < 2; ++k) { /* the quaternion of "a", then of "b": zero, or so small that its square is */
    DONE(state, lockstep_numbers(state, y, n));
    for (i = 0; i < n; ++i) z[i] = y[i];
    for (i = 0; i < 4; ++i) z[7 * k + 3 + i] = k == 0 ? 0 : 1e-200;
    CHECK(is_error(state, lockstep_set_numbers(state, 1, z, n), LOCKSTEP_USAGE, k == 0 ? "'a'" : "'b'", "quaternion",
                   "above zero", NULL));
    DONE(state, lockstep_numbers(state, z, n));
    DONE(state, lockstep_sizes(state, &t, NULL, NULL, NULL));
    CHECK(t == 0 && memcmp(y, z, sizeof y[0] * (size_t)n) == 0);
  }
  CHECK(is_error(state, lockstep_set_body(state, "b", small, NULL), LOCKSTEP_USAGE, "'b'", "quaternion", NULL));
  for (i = 0; i < n; ++i) z[i] = 1e300;
  CHECK(is_error(state, lockstep_move(state, 1e300, z, v), LOCKSTEP_USAGE, "'a'", "quaternion", NULL));
  DONE(state, lockstep_set_body(state, "a", NULL, fast));
  CHECK(is_error(state, lockstep_rates(state, z, n), LOCKSTEP_NON_FINITE, NULL));
  CHECK(lockstep_set_body(state, "a", far, NULL) == LOCKSTEP_DONE);
  CHECK(is_error(state, lockstep_move(state, 1e300, NULL, 0), LOCKSTEP_USAGE, "'a'", NULL));
  DONE(state, lockstep_numbers(state, z, n));
  for (i = 0; i < n; ++i) CHECK(isfinite(z[i]));
  if (lockstep_project(state, &t) == LOCKSTEP_DONE) CHECK(isfinite(t));
  DONE(state, lockstep_numbers(state, z, n));
  for (i = 0; i < n; ++i) CHECK(isfinite(z[i]));
  DONE(state, lockstep_free(state));
  DONE(run, lockstep_add_event(run, "zero", NULL, NULL, 0.05, 0, 1, of_length_zero, NULL, NULL));
  DONE(run, lockstep_run_until(run, 0.1));
  DONE(run, lockstep_free(run));
}

/* A single step that fails is explained as a run is. */
static void causes(void) {
  const char* const too_long =
      "{'lockstep': 1, 'bodies': [{'name': 'b', 'sphere': {'mass': 1, 'radius': 0.1}, 'position': [0, 1.1, 0]}],"
      " 'forces': [{'name': 'F', 'type': 'spring_damper', 'p': 'b', 's': 'ground', 'at_p': [0, 1.1, 0],"
      " 'at_s': [0, 0, 0], 'stiffness': 1e8, 'free_length': 1}],"
      " 'run': {'until': 1, 'integrator': 'rk4', 'step': 0.01}}";
  lockstep_run *steps = run_of(NULL, too_long), *whole = run_of(NULL, too_long);
  int code = LOCKSTEP_DONE, k, again;
  for (again = 0; again < 2; ++again) {
    lockstep_state* start = NULL;
    DONE(steps, lockstep_get_state(steps, &start));
    for (k = 0; k < 1000 && code == LOCKSTEP_DONE; ++k) code = lockstep_step(steps, 0.01, NULL);
    /* sqrt(1e8) rad/s */
    CHECK(is_error(steps, code, LOCKSTEP_NON_FINITE, "the step of 0.01 s is too long", "1e+04 1/s", NULL));
    if (again == 0) DONE(steps, lockstep_set_state(steps, start));
    DONE(start, lockstep_free(start));
    code = LOCKSTEP_DONE;
  }
  CHECK(lockstep_run_until(whole, 1) == LOCKSTEP_NON_FINITE);
  CHECK(strcmp(lockstep_error_text(whole), lockstep_error_text(steps)) == 0);
  DONE(steps, lockstep_free(steps));
  DONE(whole, lockstep_free(whole));
}

static void checkpoints(void) {
  char file[1024];
  lockstep_run *whole = run_of(NULL, chain), *first = run_of(NULL, chain), *second = run_of(NULL, chain);
  snprintf(file, sizeof file, "%s/c_chain.checkpoint", output);
  DONE(whole, lockstep_run_until(whole, 0.5));
  DONE(whole, lockstep_run_to_end(whole));
  DONE(first, lockstep_run_until(first, 0.5));
  DONE(first, lockstep_save(first, file));
  DONE(second, lockstep_load(second, file));
  DONE(second, lockstep_run_to_end(second));
  same_tables(second, whole, 0);
  CHECK(lockstep_load(first, "no/such/file") == LOCKSTEP_FILE);
  CHECK(lockstep_save(first, "no/such/folder/file") == LOCKSTEP_FILE);
  DONE(whole, lockstep_free(whole));
  DONE(first, lockstep_free(first));
  DONE(second, lockstep_free(second));
}

/* A run is the same whether callbacks read its states or not. */
static int read_all(void* user, const lockstep_state* state) {
  double y[64], pose[7];
  int q = 0, v = 0, s = 0;
  CHECK(lockstep_sizes(state, NULL, &q, &v, &s) == 0 && q == 14 && v == 12);
  CHECK(lockstep_numbers(state, y, q + v + s) == 0);
  CHECK(lockstep_body(state, "a", pose, NULL) == 0);
  CHECK_NEAR(hypot(y[0], y[1]), 0.5, 1e-9); /* the centre of mass of "a", on its circle */
  CHECK_NEAR(pose[0], y[0], 1e-12);
  ++*(int*)user;
  return 0;
}
static int as_condition(void* user, const lockstep_state* state, double* value) {
  *value = 1;
  return read_all(user, state);
}

static void readers(void) {
  int steps = 0, looks = 0;
  lockstep_run *alone = run_of(NULL, chain), *read = run_of(NULL, chain), *event = run_of(NULL, chain);
  DONE(read, lockstep_on_step(read, read_all, &steps, NULL));
  DONE(event, lockstep_add_event(event, "never", NULL, as_condition, 0, 0, 1, NULL, &looks, NULL));
  DONE(alone, lockstep_run_until(alone, 0.5));
  DONE(read, lockstep_run_until(read, 0.5));
  DONE(event, lockstep_run_until(event, 0.5));
  DONE(read, lockstep_linearize(read, "A.rz\nB.rz", 1, NULL)); /* does not change it either */
  DONE(alone, lockstep_run_to_end(alone));
  DONE(read, lockstep_run_to_end(read));
  DONE(event, lockstep_run_to_end(event));
  CHECK(steps > 10 && looks > steps);
  same_tables(read, alone, 0);
  same_tables(event, alone, 0);
  DONE(alone, lockstep_free(alone));
  DONE(read, lockstep_free(read));
  DONE(event, lockstep_free(event));
}

static void switches(void) {
  lockstep_run *run = run_of(NULL, chain), *pushed = run_of(NULL, chain);
  DONE(pushed, lockstep_switch(pushed, "push", 1));
  CHECK(lockstep_switch(run, "pull", 1) == LOCKSTEP_MODEL);
  DONE(run, lockstep_run_to_end(run));
  DONE(pushed, lockstep_run_to_end(pushed));
  CHECK(fabs(last(run, "B.rz") - last(pushed, "B.rz")) > 0.1);
  DONE(run, lockstep_free(run));
  DONE(pushed, lockstep_free(pushed));
}

void test_states(void) {
  states();
  not_finite();
  causes();
  checkpoints();
  readers();
  switches();
}
