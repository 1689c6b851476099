/* SPDX-License-Identifier: BSD-3-Clause */
/* The C of the page from_c.md, in the work tree: its program, and what its functions do. */
#include <math.h>
#define main page_main
#include "page_blocks.c" /* written from the page by CMake */
#undef main

static int failed = 0;
#define CHECK(what) ((what) ? (void)0 : (void)(failed = 1, printf("line %d: not so: %s\n", __LINE__, #what)))

static const char* const carriage =
    "{\"lockstep\": 1, \"gravity\": [0, -9.81, 0],"
    " \"bodies\": [{\"name\": \"carriage\", \"sphere\": {\"mass\": 2, \"radius\": 0.1}, \"position\": [0.5, 0.25, 0]}],"
    " \"joints\": [{\"name\": \"rail\", \"type\": \"parabola\", \"k\": 1, \"p\": \"carriage\", \"s\": \"ground\","
    "   \"at_p\": [0.5, 0.25, 0], \"at_s\": [0, 0, 0]}],"
    " \"forces\": ["
    "  {\"name\": \"wind\", \"type\": \"applied_force\", \"p\": \"carriage\", \"at\": [0.5, 0.25, 0], \"direction\": \"x\","
    "   \"law\": {\"type\": \"gust\", \"force\": \"3 N\", \"time\": \"200 ms\"}},"
    "  {\"name\": \"motor\", \"type\": \"applied_force\", \"p\": \"carriage\", \"at\": [0.5, 0.25, 0], \"direction\": \"x\","
    "   \"law\": {\"type\": \"input\", \"name\": \"push\"}}],"
    " \"run\": {\"tolerance\": 1e-8, \"output\": 0.1, \"record\": [\"carriage.x\", \"carriage.y\"]}}";
static const char* const ball =
    "{\"lockstep\": 1, \"gravity\": [0, -10, 0],"
    " \"bodies\": [{\"name\": \"ball\", \"sphere\": {\"mass\": 1, \"radius\": 0.1}, \"position\": [0, 5, 0]}],"
    " \"run\": {\"until\": 2, \"output\": 1, \"record\": [\"ball.y\"]}}";

int main(void) {
  lockstep_registry* registry = NULL;
  lockstep_run* run = NULL;
  double x = 0, y = 0;
  CHECK(page_main() == 0);
  CHECK(print_report("samples/scenes/four_bar.json") == 0);
  CHECK(print_report("samples/scenes/none.json") == 1);
  CHECK(lockstep_new_registry(&registry) == 0 && add_types(registry) == 0);
  CHECK(lockstep_open_text(registry, carriage, NULL, NULL, &run) == 0);
  CHECK(control(run, 500) == 0); /* comes to rest where 40 (0.3 - x) + 3 = 2 * 9.81 * 2 x */
  CHECK(lockstep_last(run, 1, &x) == 0 && lockstep_last(run, 2, &y) == 0);
  CHECK(fabs(x - 15 / (40 + 4 * 9.81)) < 1e-3 && fabs(y - x * x) < 1e-6);
  CHECK(lockstep_free(run) == 0);
  CHECK(lockstep_open_text(NULL, ball, NULL, NULL, &run) == 0 && add_floor(run) == 0);
  CHECK(lockstep_run_to_end(run) == 0 && lockstep_last(run, 1, &y) == 0);
  CHECK(fabs(y - 5) < 1e-6); /* it bounces at t = 1 s */
  CHECK(lockstep_free(run) == 0 && lockstep_free(registry) == 0);
  return failed;
}
