/* SPDX-License-Identifier: BSD-3-Clause */
/* A pendulum from C: the run of a scene, and two columns of its table. */
#include <lockstep/c.h>
#include <stdio.h>

int main(int argc, char** argv) {
  const char* const scene = argc > 1 ? argv[1] : "samples/scenes/pendulum.json";
  const double *t = NULL, *angle = NULL;
  int64_t rows = 0, i;
  int index = 0, right = 0;
  lockstep_run* run = NULL;
  if (lockstep_open(NULL, scene, "length=1 m\nrun.until=2 s", &run) || lockstep_run_to_end(run) ||
      lockstep_column_index(run, "hinge.rz", &index) || lockstep_values(run, index, &angle, &rows) ||
      lockstep_values(run, 0, &t, NULL) || lockstep_verdict(run, &right))
    fprintf(stderr, "error: %s\n", lockstep_error_text(run));
  for (i = 0; i < rows; i += 10) printf("%4.1f s %10.6f rad\n", t[i], angle[i]);
  lockstep_free(run);
  return right && rows == 101 ? 0 : 1;
}
