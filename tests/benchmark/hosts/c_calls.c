/* SPDX-License-Identifier: BSD-3-Clause */
/* What the C host costs: a call, and runs with a law, a joint and a force in C against the same with built-in types.
   CPU times, medians of 9; in pairs, so that the speed of the machine cancels.

       cmake --build build/release --target benchmark_c_calls && build/release/bin/benchmarks/c_calls */
#include <lockstep/c.h>
#include <math.h>
#include <stdio.h>
#include <stdlib.h>
#include <string.h>
#include <time.h>

enum { rounds = 9 };

static double seconds(void) { return (double)clock() / CLOCKS_PER_SEC; }

static int smaller(const void* a, const void* b) {
  const double x = *(const double*)a, y = *(const double*)b;
  return (x > y) - (x < y);
}
static double median(double* of) {
  qsort(of, rounds, sizeof of[0], smaller);
  return of[rounds / 2];
}

static void done(const void* handle, int code) {
  if (code == LOCKSTEP_DONE) return;
  fprintf(stderr, "%s: %s\n", lockstep_code_name(code), lockstep_error_text(handle));
  exit(1);
}

/* -- types in C, with the meaning of built-in ones; `user` counts their calls */
static int sine(void* user, const double* p, double t, double* y) {
  const double a = p[0], w = p[1];
  ++*(long*)user;
  y[0] = a * sin(w * t), y[1] = a * w * cos(w * t), y[2] = -w * w * y[0];
  return 0;
}
static int distance(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  int i;
  ++*(long*)user;
  f[0] = -p[0] * p[0];
  for (i = 0; i < 3; ++i) f[0] += y[i] * y[i], g[i] = 2 * y[i], h[9 * i] = 2;
  return 0;
}
static int spring(void* user, const double* p, double t, const double P[13], const double S[13], double out[9]) {
  double d[3], length;
  int i;
  (void)t;
  ++*(long*)user;
  for (i = 0; i < 3; ++i) d[i] = S[i] - P[i];
  length = sqrt(d[0] * d[0] + d[1] * d[1] + d[2] * d[2]);
  for (i = 0; i < 3; ++i) out[i] = p[0] * (length - p[1]) * d[i] / length;
  out[6] = p[0] * (length - p[1]) * (length - p[1]) / 2;
  return 0;
}

/* A ball on a link of 1 m, or on a spring, or with a motor: 20 000 steps of rk4. */
static const char* const ball =
    "{\"lockstep\": 1, \"gravity\": [0, -9.81, 0], \"bodies\": [{\"name\": \"b\", \"sphere\": {\"mass\": 1, \"radius\":"
    " 0.1}, \"position\": [1, 0, 0]}], %s, \"run\": {\"integrator\": \"rk4\", \"step\": 1e-3, \"until\": 20, "
    "\"output\":"
    " 20, \"record\": [\"b.y\"]}}";

static lockstep_run* open_ball(lockstep_registry* registry, const char* with) {
  char scene[1024];
  lockstep_run* run = NULL;
  snprintf(scene, sizeof scene, ball, with);
  done(run, lockstep_open_text(registry, scene, NULL, NULL, &run));
  return run;
}

static double run_ball(lockstep_registry* registry, const char* with) {
  lockstep_run* const run = open_ball(registry, with);
  const double begin = seconds();
  double spent;
  done(run, lockstep_run_to_end(run));
  spent = seconds() - begin;
  done(run, lockstep_free(run));
  return spent;
}

static void types(void) {
  static const struct {
    const char *what, *mine, *theirs;
  } cases[] = {
      {"law sine",
       "\"forces\": [{\"name\": \"M\", \"type\": \"torque_motor\", \"p\": \"b\", \"s\": \"ground\", \"at\": [1, 0, 0],"
       " \"torque\": {\"type\": \"c_sine\", \"amplitude\": 0.1, \"omega\": 3}}]",
       "\"forces\": [{\"name\": \"M\", \"type\": \"torque_motor\", \"p\": \"b\", \"s\": \"ground\", \"at\": [1, 0, 0],"
       " \"torque\": {\"type\": \"sine\", \"amplitude\": 0.1, \"omega\": 3}}]"},
      {"joint distance",
       "\"joints\": [{\"name\": \"A\", \"type\": \"c_distance\", \"p\": \"b\", \"s\": \"ground\", \"at_p\": [1, 0, 0],"
       " \"at_s\": [0, 0, 0], \"length\": 1}]",
       "\"joints\": [{\"name\": \"A\", \"type\": \"distance\", \"p\": \"b\", \"s\": \"ground\", \"at_p\": [1, 0, 0],"
       " \"at_s\": [0, 0, 0], \"length\": 1}]"},
      {"force spring_damper",
       "\"forces\": [{\"name\": \"F\", \"type\": \"c_spring\", \"p\": \"b\", \"s\": \"ground\", \"at_p\": [1, 0, 0],"
       " \"at_s\": [0, 0, 0], \"stiffness\": 100, \"free\": 0.9}]",
       "\"forces\": [{\"name\": \"F\", \"type\": \"spring_damper\", \"p\": \"b\", \"s\": \"ground\", \"at_p\": [1, 0, "
       "0],"
       " \"at_s\": [0, 0, 0], \"stiffness\": 100, \"damping\": 0, \"free_length\": 0.9}]"}};
  lockstep_registry* registry = NULL;
  long calls = 0;
  size_t k;
  done(registry, lockstep_new_registry(&registry));
  done(registry, lockstep_add_law(registry, "c_sine", "amplitude omega", sine, NULL, &calls, NULL));
  done(registry, lockstep_add_joint(registry, "c_distance", "length", 1, NULL, distance, &calls, NULL));
  done(registry, lockstep_add_force(registry, "c_spring", "stiffness free", spring, &calls, NULL));
  printf("%-22s %10s %10s %12s %14s\n", "a type in C", "run, ms", "built in", "run over it", "ns more a call");
  for (k = 0; k < sizeof cases / sizeof cases[0]; ++k) {
    double mine[rounds], theirs[rounds], ratio[rounds], more[rounds];
    int i;
    for (i = 0; i < rounds; ++i) {
      calls = 0;
      mine[i] = run_ball(registry, cases[k].mine), theirs[i] = run_ball(registry, cases[k].theirs);
      ratio[i] = mine[i] / theirs[i], more[i] = 1e9 * (mine[i] - theirs[i]) / (double)calls;
    }
    printf("%-22s %10.1f %10.1f %12.2f %14.0f\n", cases[k].what, 1e3 * median(mine), 1e3 * median(theirs),
           median(ratio), median(more));
  }
  done(registry, lockstep_free(registry));
}

/* -- calls */
typedef int (*call)(lockstep_run* run, lockstep_state* state);
static double x;
static int read_time(lockstep_run* run, lockstep_state* state) { return (void)state, lockstep_time(run, &x); }
static int set_input(lockstep_run* run, lockstep_state* state) { return (void)state, lockstep_set_input(run, 0, x); }
static int read_last(lockstep_run* run, lockstep_state* state) { return (void)state, lockstep_last(run, 1, &x); }
static int read_body(lockstep_run* run, lockstep_state* state) {
  double pose[7];
  return (void)run, lockstep_body(state, "b", pose, NULL);
}
static int copy_state(lockstep_run* run, lockstep_state* state) {
  lockstep_state* copy = NULL;
  const int code = lockstep_get_state(run, &copy);
  return (void)state, code != 0 ? code : lockstep_free(copy);
}

static void calls(void) {
  static const struct {
    const char* what;
    call make;
  } all[] = {{"lockstep_time", read_time},
             {"lockstep_set_input", set_input},
             {"lockstep_last", read_last},
             {"lockstep_body", read_body},
             {"lockstep_get_state, _free", copy_state}};
  enum { n = 100000 };
  lockstep_run* const run =
      open_ball(NULL,
                "\"forces\": [{\"name\": \"M\", \"type\": \"torque_motor\", \"p\": \"b\", \"s\": \"ground\", \"at\":"
                " [1, 0, 0], \"torque\": {\"type\": \"input\", \"name\": \"u\"}}]");
  lockstep_state* state = NULL;
  size_t k;
  done(run, lockstep_advance(run, 0.1));
  done(run, lockstep_get_state(run, &state));
  printf("%-26s %6s\n", "a call", "ns");
  for (k = 0; k < sizeof all / sizeof all[0]; ++k) {
    double ns[rounds];
    int i, j;
    for (i = 0; i < rounds; ++i) {
      const double begin = seconds();
      for (j = 0; j < n; ++j) done(run, all[k].make(run, state));
      ns[i] = 1e9 * (seconds() - begin) / n;
    }
    printf("%-26s %6.0f\n", all[k].what, median(ns));
  }
  done(state, lockstep_free(state));
  done(run, lockstep_free(run));
}

int main(void) {
  calls();
  types();
  return 0;
}
