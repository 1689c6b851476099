/* SPDX-License-Identifier: BSD-3-Clause */
/* Types in C against the built-in ones of the same meaning, and against closed forms. */
#include "check.h"

/* -- a law */

/* y = a sin(w t + phase) */
static int sine(void* user, const double* p, double t, double* y) {
  const double a = p[0], w = p[1], u = w * t + p[2];
  ++*(int*)user;
  y[0] = a * sin(u), y[1] = a * w * cos(u), y[2] = -a * w * w * sin(u);
  return 0;
}

static const char* const slider =
    "{'lockstep': 1, 'bodies': [{'name': 'b', 'box': {'mass': 2, 'size': [1, 1, 1]}}],"
    " 'joints': [{'name': 'A', 'type': 'prismatic', 'p': 'b', 's': 'ground', 'at': [0, 0, 0], 'axis': 'z',"
    "   'drive': {'axis': 'z', 'law': %s}}],"
    " 'run': {'until': 1, 'output': 0.125, 'tolerance': 1e-10, 'record': ['b.z', 'A.drive.force_on_p_link_z']}}";

static lockstep_run* driven(lockstep_registry* registry, const char* law) {
  char scene[2048];
  snprintf(scene, sizeof scene, slider, law);
  return run_of(registry, scene);
}

static void law(lockstep_registry* registry) {
  int called = 0, findings = -1, k;
  const char* report = NULL;
  lockstep_run *mine, *theirs;
  DONE(registry, lockstep_add_law(registry, "my_sine", "amplitude omega phase=0.5", sine, NULL, &called, NULL));
  CHECK(lockstep_add_law(registry, "my_sine", NULL, sine, NULL, NULL, NULL) == LOCKSTEP_PLUGIN);
  DONE(registry,
       lockstep_check_type(registry, "law", "my_sine", "{\"amplitude\": 0.2, \"omega\": 3}", &findings, &report));
  CHECK(findings == 0);
  mine = driven(registry, "{'type': 'my_sine', 'amplitude': '200 mm', 'omega': 3}");
  theirs = driven(NULL, "{'type': 'sine', 'amplitude': 0.2, 'omega': 3, 'phase': 0.5}");
  DONE(mine, lockstep_run_to_end(mine));
  DONE(theirs, lockstep_run_to_end(theirs));
  CHECK(called > 10 && rows(mine) == 9);
  for (k = 0; k < (int)rows(mine); ++k) {
    CHECK_NEAR(values(mine, "b.z")[k], values(theirs, "b.z")[k], 1e-12);
    CHECK_NEAR(values(mine, "b.z")[k], 0.2 * sin(3 * 0.125 * k + 0.5), 1e-9);
    CHECK_NEAR(values(mine, "A.drive.force_on_p_link_z")[k], -2 * 9 * values(mine, "b.z")[k], 1e-7);
  }
  DONE(mine, lockstep_free(mine));
  DONE(theirs, lockstep_free(theirs));
  mine = NULL; /* a key that is missing */
  CHECK(
      lockstep_open_text(registry,
                         quoted("{'lockstep': 1, 'bodies': [{'name': 'b', 'mass': 1, 'inertia': [1, 1, 1]}],"
                                " 'joints': [{'name': 'A', 'type': 'prismatic', 'p': 'b', 's': 'ground',"
                                " 'at': [0, 0, 0], 'drive': {'axis': 'z', 'law': {'type': 'my_sine', 'omega': 1}}}]}"),
                         NULL, NULL, &mine) == LOCKSTEP_SCENE);
  CHECK(strstr(lockstep_error_text(mine), "amplitude") != NULL);
  DONE(mine, lockstep_free(mine));
}

/* -- jumps of a law: y = t for t < 1/3 and between 2/3 and 1, else constant; a rate that jumps at each third */
static int thirds(void* user, const double* p, double t, double* y) {
  const double third = p[0], part = t / third;
  (void)user;
  y[0] = part < 1 ? t : part < 2 ? third : t - third, y[1] = part < 1 || part >= 2, y[2] = 0;
  return 0;
}
static int next_third(void* user, const double* p, double t, double* next) {
  (void)user;
  if (t < p[0])
    *next = p[0];
  else if (t < 2 * p[0])
    *next = 2 * p[0];
  return 0;
}

static void jumps(lockstep_registry* registry) {
  int findings = -1;
  const char* report = NULL;
  DONE(registry, lockstep_add_law(registry, "thirds", "third=0.3", thirds, next_third, NULL, NULL));
  DONE(registry, lockstep_add_law(registry, "silent_thirds", "third=0.3", thirds, NULL, NULL, NULL));
  DONE(registry, lockstep_check_type(registry, "law", "thirds", NULL, &findings, &report));
  CHECK(findings == 0);
  DONE(registry, lockstep_check_type(registry, "law", "silent_thirds", NULL, &findings, &report));
  CHECK(findings > 0);
}

/* Breaks that lead nowhere: no time, a time that is not later, more than can be kept. p[0] chooses. */
static int constant(void* user, const double* p, double t, double* y) {
  (void)user, (void)p, (void)t;
  y[0] = 1, y[1] = y[2] = 0;
  return 0;
}
static int next_wrong(void* user, const double* p, double t, double* next) {
  const double all[] = {NAN, t, t - 1, -INFINITY, t + 1e-9, INFINITY};
  *next = all[(int)p[0]];
  ++*(int*)user;
  return 0;
}

static void wrong_jumps(lockstep_registry* registry) {
  const char* const words[] = {"nan", "0 s after 0 s", "-1 s", "-inf", "more than"};
  int calls = 0, k;
  DONE(registry, lockstep_add_law(registry, "wrong_breaks", "which", constant, next_wrong, &calls, NULL));
  for (k = 0; k < 6; ++k) {
    char law[100];
    lockstep_run* run;
    snprintf(law, sizeof law, "{'type': 'wrong_breaks', 'which': %d}", k);
    run = driven(registry, law);
    calls = 0;
    if (k == 5)
      DONE(run, lockstep_run_to_end(run));
    else
      CHECK(is_error(run, lockstep_run_to_end(run), LOCKSTEP_USER_CODE, "'A'", "next_break", words[k], NULL));
    CHECK(calls > 0 && calls < 100000000);
    DONE(run, lockstep_free(run));
  }
}

/* -- joints */

/* x^2 + y^2 = r^2 */
static int circle(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  (void)user;
  f[0] = y[0] * y[0] + y[1] * y[1] - p[0] * p[0];
  g[0] = 2 * y[0], g[1] = 2 * y[1];
  h[0] = 2, h[8 + 1] = 2;
  return 0;
}
/* the same with a wrong second derivative */
static int wrong_circle(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  circle(user, p, y, f, g, h);
  h[0] = 1;
  return 0;
}
/* two rows, one of which moves in time: x = a sin t, 2 (e0 e3 + e1 e2) = 0.3 t x */
static int moving(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  const double t = y[7];
  (void)user;
  f[0] = y[0] - p[0] * sin(t), g[0] = 1, g[7] = -p[0] * cos(t), h[8 * 7 + 7] = p[0] * sin(t);
  f[1] = 2 * (y[3] * y[6] + y[4] * y[5]) - 0.3 * t * y[0];
  g += 8, h += 64;
  g[0] = -0.3 * t, g[3] = 2 * y[6], g[6] = 2 * y[3], g[4] = 2 * y[5], g[5] = 2 * y[4], g[7] = -0.3 * y[0];
  h[8 * 3 + 6] = h[8 * 6 + 3] = h[8 * 4 + 5] = h[8 * 5 + 4] = 2, h[7] = h[8 * 7] = -0.3;
  return 0;
}

static const char* const held =
    "{'lockstep': 1, 'gravity': [0, -9.81, 0],"
    " 'bodies': [{'name': 'b', 'box': {'mass': 2, 'size': [0.1, 0.2, 0.3]}, 'position': [1, 0, 0]}],"
    " 'joints': [{'name': 'A', 'p': 'b', 's': 'ground', 'at_p': [1, 0, 0], 'at_s': [0, 0, 0], %s}],"
    " 'run': {'until': 1, 'output': 0.125, 'integrator': '%s', 'tolerance': 1e-10,"
    "   'record': ['b.x', 'b.y', 'b.angle_z', 'energy.total', 'A.force_on_p_world_x']}}";

static lockstep_run* held_by(lockstep_registry* registry, const char* joint, const char* method) {
  char scene[2048];
  snprintf(scene, sizeof scene, held, joint, method);
  return run_of(registry, scene);
}

static void compare(lockstep_run* mine, lockstep_run* theirs, double by) {
  int n = 0, c, k;
  DONE(mine, lockstep_run_to_end(mine));
  DONE(theirs, lockstep_run_to_end(theirs));
  DONE(mine, lockstep_table(mine, &n, NULL));
  CHECK(rows(mine) == 9 && rows(theirs) == 9);
  for (c = 0; c < n; ++c)
    for (k = 0; k < (int)rows(mine); ++k) {
      const double *a = NULL, *b = NULL;
      DONE(mine, lockstep_values(mine, c, &a, NULL));
      DONE(theirs, lockstep_values(theirs, c, &b, NULL));
      CHECK_NEAR(a[k], b[k], by * (1 + fabs(b[k])));
    }
}

static void joint(lockstep_registry* registry) {
  int findings = -1, k;
  const char *report = NULL, *const methods[] = {"dopri5", "radau5"};
  DONE(registry, lockstep_add_joint(registry, "circle", "radius", 1, "z e1 e2 e3", circle, NULL, NULL));
  DONE(registry, lockstep_add_joint(registry, "wrong_circle", "radius=1", 1, "z e1 e2 e3", wrong_circle, NULL, NULL));
  DONE(registry, lockstep_add_joint(registry, "moving", "a", 2, "z e1", moving, NULL, NULL));
  CHECK(lockstep_add_joint(registry, "four", NULL, 4, NULL, circle, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_add_joint(registry, "mask", NULL, 1, "q", circle, NULL, NULL) == LOCKSTEP_MODEL);
  DONE(registry, lockstep_check_type(registry, "joint", "circle", "{\"radius\": 1}", &findings, &report));
  CHECK(findings == 0);
  DONE(registry, lockstep_check_type(registry, "joint", "moving", "{\"a\": 0.2}", &findings, &report));
  CHECK(findings == 0);
  if (findings != 0) puts(report);
  DONE(registry, lockstep_check_type(registry, "joint", "wrong_circle", NULL, &findings, &report));
  CHECK(findings > 0);
  for (k = 0; k < 2; ++k) { /* of explicit and implicit methods, which read the second derivatives */
    lockstep_run* mine = held_by(registry, "'type': 'circle', 'radius': '1 m'", methods[k]);
    lockstep_run* theirs =
        held_by(NULL, "'type': 'function', 'phi': '=x^2 + y^2 - (1 m)^2', 'mask': 'z e1 e2 e3'", methods[k]);
    int i;
    compare(mine, theirs, 1e-9);
    for (i = 0; i < (int)rows(mine);
         ++i) /* a point on a circle that falls from rest: v^2 = 2 g (-y), y on the circle */
      CHECK_NEAR(hypot(values(mine, "b.x")[i], values(mine, "b.y")[i]), 1, 1e-9);
    DONE(mine, lockstep_free(mine));
    DONE(theirs, lockstep_free(theirs));
    mine = held_by(registry, "'type': 'moving', 'a': 0.2", methods[k]);
    theirs = held_by(NULL,
                     "'type': 'function', 'phi': ['=x - 0.2 m*sin(t/(1 s))', '=2*(e0*e3 + e1*e2) - 0.3*t*x/(1 m s)'],"
                     " 'mask': 'z e1'",
                     methods[k]);
    compare(mine, theirs, 1e-8);
    DONE(mine, lockstep_free(mine));
    DONE(theirs, lockstep_free(theirs));
  }
}

/* -- a force: a spring and damper on the line from P to S, with energies */
static int spring(void* user, const double* p, double t, const double P[13], const double S[13], double out[9]) {
  double d[3], length = 0, rate = 0, pull;
  int i;
  (void)user, (void)t;
  for (i = 0; i < 3; ++i) d[i] = S[i] - P[i], length += d[i] * d[i];
  length = sqrt(length);
  for (i = 0; i < 3; ++i) d[i] /= length, rate += d[i] * (S[7 + i] - P[7 + i]);
  pull = p[0] * (length - p[2]) + p[1] * rate;
  for (i = 0; i < 3; ++i) out[i] = pull * d[i];
  out[6] = 0.5 * p[0] * (length - p[2]) * (length - p[2]), out[7] = p[1] * rate * rate;
  return 0;
}

static lockstep_run* sprung(lockstep_registry* registry, const char* force) {
  char scene[2048];
  snprintf(scene, sizeof scene,
           "{'lockstep': 1, 'gravity': [0, -9.81, 0], 'bodies': ["
           " {'name': 'a', 'box': {'mass': 2, 'size': [0.1, 0.2, 0.3]}, 'position': [1, 0, 0]},"
           " {'name': 'b', 'box': {'mass': 1, 'size': [0.2, 0.1, 0.1]}, 'position': [2, 0.2, 0.1]}],"
           " 'joints': [{'name': 'A', 'type': 'spherical', 'p': 'a', 's': 'ground', 'at': [0, 0, 0]}],"
           " 'forces': [{'name': 'F', %s, 'p': 'b', 's': 'a', 'at_p': [2, 0.2, 0.2], 'at_s': [1.1, 0.1, 0]}],"
           " 'run': {'until': 1, 'output': 0.125, 'tolerance': 1e-10,"
           "   'record': ['a.x', 'a.y', 'b.x', 'b.y', 'b.z', 'energy.total', 'energy.dissipated']}}",
           force);
  return run_of(registry, scene);
}

static void force(lockstep_registry* registry) {
  int findings = -1;
  const char* report = NULL;
  lockstep_run *mine, *theirs;
  DONE(registry, lockstep_add_force(registry, "my_spring", "stiffness damping=0, length=0", spring, NULL, NULL));
  DONE(registry,
       lockstep_check_type(registry, "force", "my_spring", "{\"stiffness\": 100, \"damping\": 3}", &findings, &report));
  CHECK(findings == 0);
  if (findings != 0) puts(report);
  mine = sprung(registry, "'type': 'my_spring', 'stiffness': 100, 'damping': 3, 'length': '0.5 m'");
  theirs = sprung(NULL, "'type': 'spring_damper', 'stiffness': 100, 'damping': 3, 'free_length': 0.5");
  compare(mine, theirs, 1e-8);
  DONE(mine, lockstep_free(mine));
  DONE(theirs, lockstep_free(theirs));
}

/* -- an integrator: Runge and Kutta's method of order 4 on the numbers of the state */
static int runge_kutta(void* user, const double* p, lockstep_state* state, double h) {
  double y[64], k[4][64], at[64], t = 0;
  const double c[] = {0, 0.5, 0.5, 1}, b[] = {1. / 6, 1. / 3, 1. / 3, 1. / 6};
  int q = 0, v = 0, s = 0, n, i, j;
  (void)user, (void)p;
  if (lockstep_sizes(state, &t, &q, &v, &s) != 0) return lockstep_fail("no sizes");
  n = q + v + s;
  if (n > 64 || lockstep_numbers(state, y, n) != 0) return lockstep_fail("no numbers");
  for (j = 0; j < 4; ++j) {
    for (i = 0; i < n; ++i) at[i] = y[i] + (j > 0 ? h * c[j] * k[j - 1][i] : 0);
    if (lockstep_set_numbers(state, t + c[j] * h, at, n) != 0 || lockstep_rates(state, k[j], n) != 0)
      return lockstep_fail(lockstep_error_text(state));
  }
  for (i = 0; i < n; ++i)
    for (j = 0; j < 4; ++j) y[i] += h * b[j] * k[j][i];
  return lockstep_set_numbers(state, t + h, y, n);
}
/* the explicit method of Euler, with the poses along the end velocities */
static int euler(void* user, const double* p, lockstep_state* state, double h) {
  double y[64], rate[64], t = 0;
  int q = 0, v = 0, s = 0, i;
  (void)user, (void)p;
  lockstep_sizes(state, &t, &q, &v, &s);
  lockstep_numbers(state, y, q + v + s);
  if (lockstep_rates(state, rate, q + v + s) != 0) return lockstep_fail(lockstep_error_text(state));
  for (i = q; i < q + v + s; ++i) y[i] += h * rate[i];
  lockstep_set_numbers(state, t, y, q + v + s);
  return lockstep_move(state, h, NULL, 0);
}

static int fails_at_once(void* user, const double* p, lockstep_state* state, double h) {
  (void)user, (void)p;
  return lockstep_move(state, h, &h, 1);
}
static int latin(void* user, const double* p, lockstep_state* state, double h) {
  (void)user, (void)p, (void)state, (void)h;
  return lockstep_fail("\xe9 is not UTF-8");
}

/* The error of an integrator names it; a message in another encoding comes back as UTF-8. */
static void failures_of_integrators(lockstep_registry* registry) {
  const char* const scene =
      "{'lockstep': 1, 'bodies': [{'name': 'b', 'mass': 1, 'inertia': [1, 1, 1]}],"
      " 'run': {'until': 1, 'step': 0.1, 'integrator': '%s'}}";
  const char *const names[] = {"fails_at_once", "latin"}, *const words[] = {"usage", "is not UTF-8"};
  int k;
  DONE(registry, lockstep_add_integrator(registry, names[0], NULL, 1, fails_at_once, NULL, NULL));
  DONE(registry, lockstep_add_integrator(registry, names[1], NULL, 1, latin, NULL, NULL));
  for (k = 0; k < 2; ++k) {
    char text[400];
    lockstep_run* run;
    snprintf(text, sizeof text, scene, names[k]);
    run = run_of(registry, text);
    CHECK(is_error(run, lockstep_run_to_end(run), LOCKSTEP_USER_CODE, names[k], words[k], NULL));
    DONE(run, lockstep_free(run));
  }
}

static void integrator(lockstep_registry* registry) {
  const char* report = NULL;
  int findings = -1, k;
  char mine_too[1200];
  lockstep_run *mine, *theirs;
  const char* const scene =
      "{'lockstep': 1, 'gravity': [0, -9.81, 0],"
      " 'bodies': [{'name': 'b', 'box': {'mass': 2, 'size': [0.1, 0.2, 0.3]}, 'position': [1, 0, 0]}],"
      " 'joints': [{'name': 'A', 'type': 'spherical', 'p': 'b', 's': 'ground', 'at': [0, 0, 0.1]}],"
      " 'run': {'until': 1, 'output': 0.125, 'step': 0.0078125, 'integrator': '%s', 'formulation': 'omega',"
      "   'record': ['b.x', 'b.y', 'b.z']}}";
  DONE(registry, lockstep_add_integrator(registry, "my_rk4", NULL, 4, runge_kutta, NULL, NULL));
  DONE(registry, lockstep_add_integrator(registry, "my_euler", NULL, 1, euler, NULL, NULL));
  CHECK(lockstep_add_integrator(registry, "none", NULL, 0, euler, NULL, NULL) == LOCKSTEP_USAGE);
  DONE(registry, lockstep_check_type(registry, "integrator", "my_rk4", NULL, &findings, &report));
  CHECK(findings == 0);
  if (findings != 0) puts(report);
  DONE(registry, lockstep_check_type(registry, "integrator", "my_euler", NULL, &findings, &report));
  CHECK(findings == 0);
  if (findings != 0) puts(report);
  snprintf(mine_too, sizeof mine_too, scene, "my_rk4");
  mine = run_of(registry, mine_too);
  snprintf(mine_too, sizeof mine_too, scene, "rk4");
  theirs = run_of(NULL, mine_too);
  DONE(mine, lockstep_run_to_end(mine));
  DONE(theirs, lockstep_run_to_end(theirs));
  for (k = 0; k < 9; ++k) CHECK_NEAR(values(mine, "b.y")[k], values(theirs, "b.y")[k], 1e-11);
  DONE(mine, lockstep_free(mine));
  DONE(theirs, lockstep_free(theirs));
}

/* -- failures, and the life of user data */
static int breaks_at(void* user, const double* p, double t, double* y) {
  (void)user;
  y[0] = t, y[1] = 1, y[2] = 0;
  return t > p[0] ? lockstep_fail("the table is empty") : 0;
}
static int silent(void* user, const double* p, double t, double* y) {
  y[0] = t, y[1] = 1, y[2] = 0;
  (void)user, (void)p;
  return t > 0.5 ? 7 : 0;
}
static int undefined(void* user, const double* p, double t, double* y) {
  (void)user, (void)p;
  y[0] = t, y[1] = 1, y[2] = t > 0.5 ? NAN : 0;
  return 0;
}
static void count_free(void* user) { ++*(int*)user; }

static void failures_of_code(lockstep_registry* registry) {
  int freed = 0, more = 0;
  lockstep_run* run;
  DONE(registry, lockstep_add_law(registry, "breaks", "at=0.5", breaks_at, NULL, &freed, count_free));
  DONE(registry, lockstep_add_law(registry, "silent", NULL, silent, NULL, NULL, NULL));
  DONE(registry, lockstep_add_law(registry, "undefined", NULL, undefined, NULL, NULL, NULL));
  CHECK(lockstep_add_law(registry, "breaks", NULL, breaks_at, NULL, &more, count_free) == LOCKSTEP_PLUGIN);
  CHECK(more == 1);
  CHECK(lockstep_add_law(registry, "x", "a b=c", breaks_at, NULL, &more, count_free) != LOCKSTEP_DONE);
  CHECK(more == 2);
  CHECK(lockstep_add_law(registry, "x", NULL, NULL, NULL, &more, count_free) == LOCKSTEP_NULL);
  CHECK(more == 3);
  CHECK(lockstep_add_law(NULL, "x", NULL, silent, NULL, &more, count_free) == LOCKSTEP_NULL);
  CHECK(more == 4);
  run = driven(registry, "{'type': 'breaks'}");
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_USER_CODE);
  CHECK(strstr(lockstep_error_text(run), "the table is empty") != NULL);
  CHECK(strstr(lockstep_error_text(run), "'A'") != NULL);
  CHECK(strstr(lockstep_error_json(run), "\"name\": \"A\"") != NULL);
  CHECK(rows(run) >= 1 && values(run, "t")[0] == 0); /* what was computed stays */
  DONE(run, lockstep_free(run));
  CHECK(freed == 0);
  run = driven(registry, "{'type': 'silent'}");
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_USER_CODE);
  CHECK(strstr(lockstep_error_text(run), "7") != NULL);
  DONE(run, lockstep_free(run));
  run = driven(registry, "{'type': 'undefined'}");
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_NON_FINITE);
  DONE(run, lockstep_free(run));
  run = driven(registry, "{'type': 'breaks', 'at': 5}");
  DONE(registry, lockstep_free(registry)); /* the run goes on without it */
  CHECK(freed == 0);
  DONE(run, lockstep_run_to_end(run));
  CHECK_NEAR(last(run, "b.z"), 1, 1e-9);
  DONE(run, lockstep_free(run));
  CHECK(freed == 1);
}

void test_types(void) {
  lockstep_registry* registry = NULL;
  const char* json = NULL;
  DONE(registry, lockstep_new_registry(&registry));
  law(registry);
  jumps(registry);
  wrong_jumps(registry);
  joint(registry);
  force(registry);
  integrator(registry);
  failures_of_integrators(registry);
  DONE(registry, lockstep_types(registry, &json));
  CHECK(strstr(json, "\"my_sine\"") != NULL && strstr(json, "\"revolute\"") != NULL &&
        strstr(json, "\"input\"") != NULL);
  failures_of_code(registry);
}
