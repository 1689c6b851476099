/* SPDX-License-Identifier: BSD-3-Clause */
/* A pendulum from C: a scene, its run, a column of its table. */
#include <lockstep/c.h>
#include <stdio.h>

static const char *const scene =
    "{\"lockstep\": 1, \"gravity\": [0, -9.81, 0],"
    " \"bodies\": [{\"name\": \"rod\", \"rod\": {\"mass\": 1, \"from\": [0, 0, 0], \"to\": [1, 0, 0]}}],"
    " \"joints\": [{\"name\": \"A\", \"type\": \"revolute\", \"p\": \"rod\", \"s\": \"ground\", \"at\": [0, 0, 0]}],"
    " \"run\": {\"until\": 2, \"output\": 0.1, \"tolerance\": 1e-9, \"record\": [\"A.rz\", \"energy.total\"]}}";

int main(void) {
  lockstep_run *run;
  const double *t = NULL, *angle = NULL;
  int64_t rows = 0, i;
  if (lockstep_open_text(NULL, scene, NULL, NULL, &run) || lockstep_run_to_end(run) ||
      lockstep_values(run, 0, &t, &rows) || lockstep_values(run, 1, &angle, NULL))
    fprintf(stderr, "error: %s\n", lockstep_error_text(run));
  for (i = 0; i < rows; ++i) printf("%4.1f s %10.6f rad\n", t[i], angle[i]);
  lockstep_free(run);
  return rows == 21 ? 0 : 1;
}
