/* SPDX-License-Identifier: BSD-3-Clause */
/* A carriage on a rail that is a parabola: the rail is a joint in C, the wind a law in C, and a controller at 100 Hz keeps
   the carriage at its place by an input of the scene. */
#include <lockstep/c.h>
#include <math.h>
#include <stdio.h>

/* The rail, y = k x^2, with its first and second derivatives; variables x y z e0 e1 e2 e3 t. */
static int rail(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  const double k = p[0];
  (void)user;
  f[0] = y[1] - k * y[0] * y[0];
  g[0] = -2 * k * y[0], g[1] = 1;
  h[0] = -2 * k;
  return 0;
}

/* The wind, N: it rises like 1 - exp(-t/T) up to the force p[0], with the time constant p[1]. */
static int wind(void* user, const double* p, double t, double* y) {
  const double e = exp(-t / p[1]);
  (void)user;
  y[0] = p[0] * (1 - e), y[1] = p[0] / p[1] * e, y[2] = -p[0] / (p[1] * p[1]) * e;
  return 0;
}

static const char* const scene =
    "{\"lockstep\": 1, \"gravity\": [0, -9.81, 0],"
    " \"bodies\": [{\"name\": \"carriage\", \"sphere\": {\"mass\": 2, \"radius\": 0.1}, \"position\": [0.5, 0.25, 0]}],"
    " \"joints\": [{\"name\": \"rail\", \"type\": \"parabola\", \"k\": 1, \"p\": \"carriage\", \"s\": \"ground\","
    "   \"at_p\": [0.5, 0.25, 0], \"at_s\": [0, 0, 0]}],"
    " \"forces\": ["
    "  {\"name\": \"wind\", \"type\": \"applied_force\", \"p\": \"carriage\", \"at\": [0.5, 0.25, 0], \"direction\": "
    "\"x\","
    "   \"law\": {\"type\": \"gust\", \"force\": \"3 N\", \"time\": \"200 ms\"}},"
    "  {\"name\": \"motor\", \"type\": \"applied_force\", \"p\": \"carriage\", \"at\": [0.5, 0.25, 0], \"direction\": "
    "\"x\","
    "   \"law\": {\"type\": \"input\", \"name\": \"push\"}}],"
    " \"run\": {\"tolerance\": 1e-8, \"output\": 0.1, \"record\": [\"carriage.x\", \"carriage.y\", \"push.value\"]}}";

static int simulate(lockstep_registry* registry, lockstep_run** run) {
  const double wanted = 0.3, period = 0.01;
  double sum = 0, x = 0, before = 0.5, push;
  int k, code;
  if ((code = lockstep_add_joint(registry, "parabola", "k", 1, "z e1 e2 e3", rail, NULL, NULL)) != 0 ||
      (code = lockstep_add_law(registry, "gust", "force time", wind, NULL, NULL, NULL)) != 0)
    return code;
  if ((code = lockstep_open_text(registry, scene, "carriage", NULL, run)) != 0) return code;
  for (k = 0; k < 1500; ++k) { /* 15 s */
    lockstep_state* state = NULL;
    double pose[7];
    if ((code = lockstep_get_state(*run, &state)) != 0) return code;
    code = lockstep_body(state, "carriage", pose, NULL);
    lockstep_free(state);
    if (code != 0) return code;
    x = pose[0];
    sum += period * (wanted - x);
    push = 40 * (wanted - x) + 40 * sum - 20 * (x - before) / period;
    before = x;
    if ((code = lockstep_set_input(*run, 0, push)) != 0 || (code = lockstep_advance(*run, period)) != 0) return code;
  }
  return 0;
}

int main(void) {
  lockstep_registry* registry = NULL;
  lockstep_run* run = NULL;
  double x = 0, y = 0, push = 0;
  /* at rest gravity, the wind and the motor balance along the slope: push + wind = m g dy/dx = 2 * 9.81 * 2 x */
  const double wanted = 0.3, balance = 2 * 9.81 * 2 * 0.3 - 3;
  int right;
  if (lockstep_new_registry(&registry) || simulate(registry, &run) || lockstep_last(run, 1, &x) ||
      lockstep_last(run, 2, &y) || lockstep_last(run, 3, &push))
    fprintf(stderr, "error: %s\n", lockstep_error_text(run != NULL ? (void*)run : (void*)registry));
  printf("x = %.6f m (wanted %.6f m), y = %.6f m, push = %.4f N (at rest %.4f N)\n", x, wanted, y, push, balance);
  right = fabs(x - wanted) < 1e-3 && fabs(y - x * x) < 1e-6 && fabs(push - balance) < 0.02;
  lockstep_free(run);
  lockstep_free(registry);
  return right ? 0 : 1;
}
