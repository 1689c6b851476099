/* SPDX-License-Identifier: BSD-3-Clause */
/* Runs against closed forms, and against the program to the last bit. */
#include "check.h"

static const double pi = 3.14159265358979323846;

/* A rod of 1 m and 1 kg that falls from the horizontal: the energy is zero, w^2 = 3 g sin(fall) / L, and the swing is
   symmetric about the lowest position. */
static void pendulum(void) {
  lockstep_run* run = run_of(
      NULL,
      "{'lockstep': 1, 'gravity': [0, -9.81, 0], 'parameters': {'length': '1 m'},"
      " 'bodies': [{'name': 'rod', 'rod': {'mass': 1, 'from': [0, 0, 0], 'to': ['=length', 0, 0], 'radius': 1e-6}}],"
      " 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'rod', 's': 'ground', 'at': [0, 0, 0]}],"
      " 'run': {'until': 2, 'output': 0.05, 'tolerance': 1e-11, 'record': ['A.rz', 'energy.total']}}");
  const char *name = NULL, *unit = NULL, *json = NULL, *text = NULL;
  double extremes[4], t = -1;
  int n = 0, right = 0, k;
  int64_t m = 0;
  const double *angle, *speed, *energy, *time;
  CHECK(lockstep_extremes(run, 1, extremes) == LOCKSTEP_USAGE);
  DONE(run, lockstep_record(run, "rod.omega_world_z", "w"));
  CHECK(lockstep_record(run, "rod.omega", NULL) == LOCKSTEP_MODEL);
  CHECK(strstr(lockstep_error_text(run), "rod.omega") != NULL);
  DONE(run, lockstep_run_to_end(run));
  CHECK(lockstep_record(run, "rod.x", NULL) == LOCKSTEP_MODEL); /* the run has begun */
  DONE(run, lockstep_table(run, &n, &m));
  CHECK(n == 4 && m == 41);
  DONE(run, lockstep_column(run, 3, &name, &unit));
  CHECK(strcmp(name, "w") == 0 && strcmp(unit, "rad/s") == 0);
  time = values(run, "t"), angle = values(run, "A.rz"), speed = values(run, "w"), energy = values(run, "energy.total");
  for (k = 0; k < (int)m; ++k) {
    CHECK_NEAR(time[k], 0.05 * k, 1e-12);
    CHECK_NEAR(speed[k] * speed[k], 3 * 9.81 * sin(-angle[k]), 1e-7);
    CHECK_NEAR(energy[k], energy[0], 1e-8);
  }
  DONE(run, lockstep_extremes(run, column(run, "A.rz"), extremes));
  CHECK_NEAR(extremes[0], -pi, 1e-5 * pi); /* a hundred-thousandth of the range */
  CHECK_NEAR(extremes[2], 0, 1e-7);
  DONE(run, lockstep_extremes(run, column(run, "w"), extremes));
  CHECK_NEAR(extremes[0], -sqrt(3 * 9.81), 2e-5 * sqrt(3 * 9.81)); /* at the lowest position, halfway to the turn */
  CHECK(lockstep_extremes(run, 0, extremes) == LOCKSTEP_USAGE);
  DONE(run, lockstep_verdict(run, &right));
  CHECK(right == 1);
  DONE(run, lockstep_report(run, &json));
  CHECK(strstr(json, "\"energy\": \"conserved\"") != NULL);
  DONE(run, lockstep_time(run, &t));
  CHECK_NEAR(t, 2, 0);
  DONE(run, lockstep_findings(run, &n));
  DONE(run, lockstep_finding(run, -1, &text, &json));
  CHECK(json[0] == '[' && strlen(text) < 1000);
  CHECK(lockstep_finding(run, n, &text, &json) == LOCKSTEP_USAGE);
  DONE(run, lockstep_channels(run, &json));
  CHECK(strstr(json, "\"A.rz\"") != NULL);
  CHECK(lockstep_run_until(run, 1) == LOCKSTEP_MODEL); /* the past */
  CHECK(lockstep_error_code(run) == LOCKSTEP_MODEL);
  CHECK(strstr(lockstep_error_json(run), "\"kind\": \"model\"") != NULL);
  DONE(run, lockstep_free(run));
}

/* A slider-crank with a steady crank: x = r cos wt + sqrt(l^2 - r^2 sin^2 wt). */
static void slider_crank(void) {
  const double r = 0.2, l = 0.6, w = 2 * pi;
  int k;
  const double *t, *x;
  lockstep_run* run =
      run_of(NULL,
             "{'lockstep': 1, 'bodies': [{'name': 'crank', 'rod': {'mass': 1, 'from': [0, 0, 0], 'to': [0.2, 0, 0]}},"
             " {'name': 'coupler', 'rod': {'mass': 2, 'from': [0.2, 0, 0], 'to': [0.8, 0, 0]}},"
             " {'name': 'piston', 'box': {'mass': 1, 'size': [0.1, 0.06, 0.06]}, 'position': [0.8, 0, 0]}],"
             " 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'crank', 's': 'ground', 'at': [0, 0, 0],"
             "   'drive': {'axis': 'rz', 'law': {'type': 'ramp', 'slope': '60 rpm'}}},"
             " {'name': 'B', 'type': 'revolute', 'p': 'coupler', 's': 'crank', 'at': [0.2, 0, 0]},"
             " {'name': 'C', 'type': 'revolute', 'p': 'piston', 's': 'coupler', 'at': [0.8, 0, 0]},"
             " {'name': 'guide', 'type': 'prismatic', 'p': 'piston', 's': 'ground', 'at': [0.8, 0, 0], 'axis': 'x'}],"
             " 'run': {'until': 1, 'output': 0.01, 'tolerance': 1e-10, 'record': ['piston.x']}}");
  DONE(run, lockstep_run_until(run, 0.5));
  DONE(run, lockstep_run_to_end(run));
  t = values(run, "t"), x = values(run, "piston.x");
  for (k = 0; k < (int)rows(run); ++k)
    CHECK_NEAR(x[k], r * cos(w * t[k]) + sqrt(l * l - pow(r * sin(w * t[k]), 2)), 1e-8);
  CHECK(rows(run) == 101);
  DONE(run, lockstep_free(run));
}

/* The table of a sample scene with other values against the file that the program writes, digit by digit. */
static void same_as_program(void) {
  char command[4096], scene[1024], csv[1024], line[65536];
  lockstep_run* run = NULL;
  FILE* file;
  int64_t row = 0, n = 0;
  int columns = 0, k;
  snprintf(scene, sizeof scene, "%s/four_bar.json", scenes);
  snprintf(csv, sizeof csv, "%s/c_four_bar.csv", output);
  snprintf(command, sizeof command, "'%.1000s' run '%s' --set 'crank=0.12 m' --record '%s' --quiet", program, scene,
           csv);
  CHECK(system(command) == 0);
  DONE(run, lockstep_open(NULL, scene, "crank=0.12 m\n", &run));
  DONE(run, lockstep_run_to_end(run));
  DONE(run, lockstep_table(run, &columns, &n));
  file = fopen(csv, "r");
  CHECK(file != NULL);
  if (file == NULL) return;
  CHECK(fgets(line, sizeof line, file) != NULL); /* names and units */
  while (fgets(line, sizeof line, file) != NULL) {
    char* at = line;
    for (k = 0; k < columns; ++k) {
      const double* all = NULL;
      const double number = strtod(at, &at);
      DONE(run, lockstep_values(run, k, &all, NULL));
      CHECK(row < n && all[row] == number);
      CHECK(*at == (k + 1 < columns ? ',' : '\n'));
      ++at;
    }
    ++row;
  }
  CHECK(row == n && n > 10 && columns > 2);
  fclose(file);
  DONE(run, lockstep_free(run));
}

/* A wheel on a motor whose torque is an input: J w' = u. The moment of inertia of the disc is m r^2 / 2 = 0.5 kg m^2. */
static void inputs(void) {
  const char* const scene =
      "{'lockstep': 1, 'bodies': [{'name': 'wheel', 'cylinder': {'mass': 1, 'radius': 1, 'length': 0.1}}],"
      " 'joints': [{'name': 'A', 'type': 'revolute', 'p': 'wheel', 's': 'ground', 'at': [0, 0, 0]}],"
      " 'forces': [{'name': 'motor', 'type': 'torque_motor', 'p': 'wheel', 's': 'ground', 'at': [0, 0, 0],"
      "   'torque': {'type': 'input', 'name': 'u', 'value': '2 N m'}}],"
      " 'run': {'until': 3, 'output': 0.5, 'tolerance': 1e-9, 'record': ['A.rz', 'A.omega_z', 'u.value']}}";
  lockstep_run *run = run_of(NULL, scene), *same = run_of(NULL, scene);
  const char *name = NULL, *unit = NULL, *json = NULL;
  double value = 0;
  const double* m = NULL;
  int n = 0, index = -1, r = 0, c = 0, i;
  DONE(run, lockstep_inputs(run, &n));
  CHECK(n == 1);
  DONE(run, lockstep_input(run, 0, &name, &unit, &value));
  CHECK(strcmp(name, "u") == 0 && strcmp(unit, "") == 0 && value == 2);
  DONE(run, lockstep_input_index(run, "u", &index));
  CHECK(index == 0);
  CHECK(lockstep_input_index(run, "v", &index) == LOCKSTEP_MODEL);
  CHECK(lockstep_set_input(run, 1, 0) == LOCKSTEP_USAGE);
  CHECK(lockstep_set_input(run, 0, NAN) == LOCKSTEP_MODEL);
  CHECK(lockstep_matrix(run, 'A', &m, &r, &c) == LOCKSTEP_USAGE);
  for (i = 0; i < 2; ++i) {
    lockstep_run* const each = i == 0 ? run : same;
    DONE(each, lockstep_run_until(each, 1)); /* w = 4 t */
    CHECK_NEAR(last(each, "A.omega_z"), 4, 1e-9);
    if (i == 0) { /* x = (angle, speed), y = (angle, speed, u): x' = [0 1; 0 0] x + [0; 1/J] u */
      DONE(run, lockstep_linearize(run, NULL, 1, NULL));
      DONE(run, lockstep_matrix(run, 'A', &m, &r, &c));
      CHECK(r == 2 && c == 2);
      CHECK_NEAR(m[1], 1, 1e-9);
      CHECK_NEAR(m[0] + m[2] + m[3], 0, 1e-9);
      DONE(run, lockstep_matrix(run, 'B', &m, &r, &c));
      CHECK(r == 2 && c == 1);
      CHECK_NEAR(m[0], 0, 1e-9);
      CHECK_NEAR(m[1], 2, 1e-7);
      DONE(run, lockstep_matrix(run, 'C', &m, &r, &c));
      CHECK(r == 3 && c == 2);
      CHECK_NEAR(m[0], 1, 1e-7);
      CHECK_NEAR(m[3], 1, 1e-7);
      DONE(run, lockstep_matrix(run, 'D', &m, &r, &c));
      CHECK(r == 3 && c == 1);
      DONE(run, lockstep_signals(run, &json));
      CHECK(strstr(json, "\"inputs\": [{\"name\": \"u\", \"unit\": \"\"}]") != NULL);
      CHECK(lockstep_linearize(run, "A.rz\nt", 1, NULL) == LOCKSTEP_USAGE);
      CHECK(lockstep_linearize(run, "A.ry", 1, NULL) == LOCKSTEP_MODEL);
      CHECK(lockstep_linearize(run, NULL, 0, NULL) == LOCKSTEP_MODEL); /* it accelerates */
      DONE(run, lockstep_linearize(run, "A.omega_z\n", 1, NULL));
      DONE(run, lockstep_matrix(run, 'C', &m, &r, &c));
      CHECK(r == 1 && c == 2);
      CHECK_NEAR(m[1], 1, 1e-7);
      CHECK(lockstep_matrix(run, 'E', &m, &r, &c) == LOCKSTEP_USAGE);
    }
    DONE(each, lockstep_set_input(each, 0, -2));
    DONE(each, lockstep_advance(each, 1));
    DONE(each, lockstep_run_to_end(each)); /* w = 4 - 4 (t - 1) */
    CHECK_NEAR(last(each, "A.omega_z"), -4, 1e-9);
    CHECK_NEAR(last(each, "A.rz"), 2, 1e-9);
  }
  CHECK(rows(run) == rows(same));
  for (i = 0; i < (int)rows(run); ++i) CHECK(values(run, "A.rz")[i] == values(same, "A.rz")[i]);
  DONE(run, lockstep_free(run));
  DONE(same, lockstep_free(same));
}

/* Errors of a scene have their place. */
static void scene_errors(void) {
  lockstep_run* run = NULL;
  CHECK(lockstep_open_text(NULL, quoted("{'lockstep': 1,\n 'bodies': [{'name': 'rod', 'mass': '1 m'}]}"), "typed.json",
                           NULL, &run) == LOCKSTEP_SCENE);
  CHECK(run != NULL && lockstep_error_code(run) == LOCKSTEP_SCENE);
  CHECK(strstr(lockstep_error_text(run), "typed.json:2") != NULL);
  CHECK(strstr(lockstep_error_json(run), "\"line\": 2") != NULL);
  CHECK(strstr(lockstep_error_json(run), "\"t\": null") != NULL);
  CHECK(lockstep_run_to_end(run) == LOCKSTEP_CLOSED);
  DONE(run, lockstep_free(run));
  CHECK(lockstep_open(NULL, "no/such/scene.json", NULL, &run) == LOCKSTEP_FILE);
  DONE(run, lockstep_free(run));
  CHECK(lockstep_open_text(NULL, quoted("{'lockstep': 1, 'requires': ['no_such_plugin']}"), NULL, NULL, &run) ==
        LOCKSTEP_PLUGIN);
  DONE(run, lockstep_free(run));
  CHECK(lockstep_open_text(NULL, quoted("{'lockstep': 1, 'bodies': [{'name': 'b', 'mass': 1, 'inertia': [1, 1, 1]}]}"),
                           NULL, "bodies.c.mass=2", &run) != LOCKSTEP_DONE);
  CHECK(strstr(lockstep_error_text(run), "bodies.c.mass") != NULL);
  DONE(run, lockstep_free(run));
}

void test_results(void) {
  CHECK(strlen(lockstep_version()) >= 5);
  pendulum();
  slider_crank();
  same_as_program();
  inputs();
  scene_errors();
}
