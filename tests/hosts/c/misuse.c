/* SPDX-License-Identifier: BSD-3-Clause */
/* Every function with null, with what is no handle, and in the wrong order: a code, never a crash. */
#include "check.h"

static int law(void* user, const double* p, double t, double* y) {
  (void)user, (void)p;
  y[0] = t, y[1] = 1, y[2] = 0;
  return 0;
}
static int joint(void* user, const double* p, const double y[8], double* f, double* g, double* h) {
  (void)user, (void)p, (void)h;
  f[0] = y[0], g[0] = 1;
  return 0;
}
static int force(void* user, const double* p, double t, const double P[13], const double S[13], double out[9]) {
  (void)user, (void)p, (void)t, (void)P, (void)S, (void)out;
  return 0;
}
static int step(void* user, const double* p, lockstep_state* state, double h) {
  (void)user, (void)p;
  return lockstep_move(state, h, NULL, 0);
}

static int row(void* user, const double* numbers, int count) {
  (void)user, (void)numbers, (void)count;
  return 0;
}

/* The numbers of the codes never change. */
_Static_assert(LOCKSTEP_DONE == 0 && LOCKSTEP_OTHER == 1 && LOCKSTEP_MODEL == 2 && LOCKSTEP_ASSEMBLY == 3 &&
                   LOCKSTEP_SOLVE == 4 && LOCKSTEP_STEP == 5 && LOCKSTEP_NON_FINITE == 6 && LOCKSTEP_PLUGIN == 7 &&
                   LOCKSTEP_SCENE == 8 && LOCKSTEP_FILE == 9 && LOCKSTEP_USER_CODE == 10 && LOCKSTEP_USAGE == 11 &&
                   LOCKSTEP_INTERRUPTED == 12 && LOCKSTEP_MEMORY == 13 && LOCKSTEP_NULL == 14 &&
                   LOCKSTEP_CLOSED == 15 && LOCKSTEP_BUSY == 16 && LOCKSTEP_STOP == -1,
               "codes");

/* All functions of a handle, which is `handle` if that is not null; each has to return `code`. */
#define SAME(call) CHECK((call) == code)

static void of_a_registry(lockstep_registry* r, int code) {
  const char* text = NULL;
  int n = 0;
  SAME(lockstep_load_plugin(r, "bump"));
  SAME(lockstep_types(r, &text));
  SAME(lockstep_add_law(r, "l", NULL, law, NULL, NULL, NULL));
  SAME(lockstep_add_joint(r, "j", NULL, 1, NULL, joint, NULL, NULL));
  SAME(lockstep_add_force(r, "f", NULL, force, NULL, NULL));
  SAME(lockstep_add_integrator(r, "i", NULL, 1, step, NULL, NULL));
  SAME(lockstep_check_type(r, "law", "sine", NULL, &n, &text));
  CHECK(text == NULL);
}

static void of_a_run(lockstep_run* r, lockstep_state* state, int code) {
  const char* text = NULL;
  const double* numbers = NULL;
  lockstep_state* made = NULL;
  double x = 0, four[4];
  int n = 0;
  int64_t m = 0;
  SAME(lockstep_channels(r, &text));
  SAME(lockstep_record(r, "energy.total", NULL));
  SAME(lockstep_inputs(r, &n));
  SAME(lockstep_input(r, 0, &text, &text, &x));
  SAME(lockstep_input_index(r, "u", &n));
  SAME(lockstep_set_input(r, 0, 1));
  SAME(lockstep_run_to_end(r));
  SAME(lockstep_run_until(r, 1));
  SAME(lockstep_advance(r, 1));
  SAME(lockstep_step(r, 0, &x));
  SAME(lockstep_time(r, &x));
  SAME(lockstep_switch(r, "A", 1));
  SAME(lockstep_save(r, "file"));
  SAME(lockstep_load(r, "file"));
  SAME(lockstep_table(r, &n, &m));
  SAME(lockstep_column(r, 0, &text, &text));
  SAME(lockstep_column_index(r, "t", &n));
  SAME(lockstep_values(r, 0, &numbers, &m));
  SAME(lockstep_last(r, 0, &x));
  SAME(lockstep_extremes(r, 1, four));
  SAME(lockstep_verdict(r, &n));
  SAME(lockstep_report(r, &text));
  SAME(lockstep_findings(r, &n));
  SAME(lockstep_finding(r, -1, &text, &text));
  SAME(lockstep_linearize(r, NULL, 1, NULL));
  SAME(lockstep_matrix(r, 'A', &numbers, &n, &n));
  SAME(lockstep_signals(r, &text));
  SAME(lockstep_on_step(r, NULL, NULL, NULL));
  SAME(lockstep_on_row(r, NULL, 0, NULL, NULL));
  SAME(lockstep_add_event(r, "e", NULL, NULL, 1, 0, 1, NULL, NULL, NULL));
  SAME(lockstep_get_state(r, &made));
  SAME(lockstep_set_state(r, state));
  CHECK(text == NULL && numbers == NULL && made == NULL);
}

static void of_a_state(lockstep_state* s, int code) {
  double x[16] = {0, 0, 0, 1, 0, 0, 0};
  int n = 0;
  SAME(lockstep_body(s, "b", x, x + 7));
  SAME(lockstep_set_body(s, "b", x, NULL));
  SAME(lockstep_sizes(s, x, &n, &n, &n));
  SAME(lockstep_numbers(s, x, 13));
  SAME(lockstep_set_numbers(s, 0, x, 13));
  SAME(lockstep_rates(s, x, 13));
  SAME(lockstep_move(s, 0, NULL, 0));
  SAME(lockstep_project(s, x));
}

/* Of a live handle: every pointer that must not be null is. */
static void null_arguments(lockstep_registry* r, lockstep_run* run, lockstep_state* s) {
  const int code = LOCKSTEP_NULL;
  SAME(lockstep_new_registry(NULL));
  SAME(lockstep_load_plugin(r, NULL));
  SAME(lockstep_types(r, NULL));
  SAME(lockstep_add_law(r, NULL, NULL, law, NULL, NULL, NULL));
  SAME(lockstep_add_law(r, "l", NULL, NULL, NULL, NULL, NULL));
  SAME(lockstep_add_joint(r, "j", NULL, 1, NULL, NULL, NULL, NULL));
  SAME(lockstep_add_force(r, "f", NULL, NULL, NULL, NULL));
  SAME(lockstep_add_integrator(r, "i", NULL, 1, NULL, NULL, NULL));
  SAME(lockstep_check_type(r, NULL, "sine", NULL, NULL, NULL));
  SAME(lockstep_check_type(r, "law", NULL, NULL, NULL, NULL));
  SAME(lockstep_open(r, "file", NULL, NULL));
  SAME(lockstep_open_text(r, "{}", NULL, NULL, NULL));
  SAME(lockstep_channels(run, NULL));
  SAME(lockstep_record(run, NULL, NULL));
  SAME(lockstep_inputs(run, NULL));
  SAME(lockstep_input_index(run, NULL, NULL));
  SAME(lockstep_input_index(run, "u", NULL));
  SAME(lockstep_switch(run, NULL, 1));
  SAME(lockstep_save(run, NULL));
  SAME(lockstep_load(run, NULL));
  SAME(lockstep_time(run, NULL));
  SAME(lockstep_column_index(run, NULL, NULL));
  SAME(lockstep_column_index(run, "t", NULL));
  SAME(lockstep_values(run, 0, NULL, NULL));
  SAME(lockstep_verdict(run, NULL));
  SAME(lockstep_report(run, NULL));
  SAME(lockstep_findings(run, NULL));
  SAME(lockstep_get_state(run, NULL));
  SAME(lockstep_set_state(run, NULL));
  SAME(lockstep_body(s, NULL, NULL, NULL));
  SAME(lockstep_set_body(s, NULL, NULL, NULL));
  SAME(lockstep_numbers(s, NULL, 13));
  SAME(lockstep_set_numbers(s, 0, NULL, 13));
  SAME(lockstep_rates(s, NULL, 13));
  DONE(run, lockstep_input(run, 0, NULL, NULL, NULL)); /* results that are not wanted */
  DONE(run, lockstep_table(run, NULL, NULL));
  DONE(run, lockstep_column(run, 0, NULL, NULL));
  DONE(run, lockstep_finding(run, -1, NULL, NULL));
  DONE(s, lockstep_sizes(s, NULL, NULL, NULL, NULL));
  DONE(s, lockstep_body(s, "b", NULL, NULL));
  DONE(s, lockstep_project(s, NULL));
}

/* Texts that are not UTF-8: each function names the argument and the byte. */
static const char* const latin =
    "ab\xe9"
    "d";
#define LATIN(handle, name, call) CHECK(is_error(handle, call, LOCKSTEP_USAGE, "\"" name "\"", "byte 2", "0xe9", NULL))

static void texts(lockstep_registry* r, lockstep_run* run, lockstep_state* s, const char* scene) {
  char path[1024];
  FILE* file;
  lockstep_run* made = NULL;
  LATIN(r, "name", lockstep_load_plugin(r, latin));
  LATIN(r, "type", lockstep_add_law(r, latin, NULL, law, NULL, NULL, NULL));
  LATIN(r, "keys", lockstep_add_law(r, "l", latin, law, NULL, NULL, NULL));
  LATIN(r, "mask", lockstep_add_joint(r, "j", NULL, 1, latin, joint, NULL, NULL));
  LATIN(r, "kind", lockstep_check_type(r, latin, "sine", NULL, NULL, NULL));
  LATIN(r, "type", lockstep_check_type(r, "law", latin, NULL, NULL, NULL));
  LATIN(r, "keys", lockstep_check_type(r, "law", "sine", latin, NULL, NULL));
  LATIN(run, "channel", lockstep_record(run, latin, NULL));
  LATIN(run, "name", lockstep_record(run, "b.x", latin));
  LATIN(run, "name", lockstep_input_index(run, latin, (int[1]){0}));
  LATIN(run, "name", lockstep_column_index(run, latin, (int[1]){0}));
  LATIN(run, "name", lockstep_add_event(run, latin, NULL, NULL, 0.5, 0, 1, NULL, NULL, NULL));
  LATIN(run, "channel", lockstep_add_event(run, "e", latin, NULL, 0.5, 0, 1, NULL, NULL, NULL));
  LATIN(run, "name", lockstep_switch(run, latin, 1));
  LATIN(run, "file", lockstep_save(run, latin));
  LATIN(run, "file", lockstep_load(run, latin));
  LATIN(run, "outputs", lockstep_linearize(run, latin, 1, NULL));
  LATIN(s, "name", lockstep_body(s, latin, NULL, NULL));
  LATIN(made, "file", lockstep_open(NULL, latin, NULL, &made));
  DONE(made, lockstep_free(made));
  LATIN(made, "scene", lockstep_open_text(NULL, latin, NULL, NULL, &made));
  DONE(made, lockstep_free(made));
  LATIN(made, "name", lockstep_open_text(NULL, quoted(scene), latin, NULL, &made));
  DONE(made, lockstep_free(made));
  LATIN(made, "set", lockstep_open_text(NULL, quoted(scene), NULL, latin, &made));
  DONE(made, lockstep_free(made));
  snprintf(path, sizeof path, "%s/c_latin.json", output); /* the text of an error quotes the file */
  CHECK((file = fopen(path, "w")) != NULL && fputs("{\"lockstep\": 1, \"title\": \"", file) >= 0 &&
        fputs(latin, file) >= 0 && fputs("\"}", file) >= 0 && fclose(file) == 0);
  CHECK(is_error(made, lockstep_open(NULL, path, NULL, &made), LOCKSTEP_SCENE, "UTF-8", NULL));
  CHECK(is_utf8(lockstep_error_json(made)));
  DONE(made, lockstep_free(made));
  DONE(r, lockstep_add_law(r,
                           "gr\xc3\xb6\xc3\x9f"
                           "e",
                           "\xce\xb1=1", law, NULL, NULL, NULL)); /* other alphabets */
}

/* Names of types and keys: words that scenes do not use. */
static void words(lockstep_registry* r) {
  const char* const none[] = {"", "1a", "a b", "a-b", "a.b", "a[1]", "\"a\"", "a\nb", "a=1"};
  const struct {
    const char *keys, *key, *rule;
  } wrong[] = {{"=3", "key \"\"", "word"},        {"a 1b", "key \"1b\"", "word"},   {"x[0]=1", "key \"x[0]\"", "word"},
               {"a-b", "key \"a-b\"", "word"},    {"a b a", "key \"a\"", "taken"},  {"type", "key \"type\"", "taken"},
               {"a=", "key \"a\"", "number"},     {"a=nan", "key \"a\"", "number"}, {"a=1e999", "key \"a\"", "number"},
               {"a=true", "key \"a\"", "number"}, {"a=1=2", "key \"a\"", "1=2"}};
  const char* const of_scenes[] = {"name", "p", "s", "at"};
  size_t i;
  for (i = 0; i < sizeof none / sizeof none[0]; ++i)
    CHECK(
        is_error(r, lockstep_add_law(r, none[i], NULL, law, NULL, NULL, NULL), LOCKSTEP_USAGE, none[i], "word", NULL));
  for (i = 0; i < sizeof wrong / sizeof wrong[0]; ++i)
    CHECK(is_error(r, lockstep_add_law(r, "named", wrong[i].keys, law, NULL, NULL, NULL), LOCKSTEP_USAGE, "\"named\"",
                   wrong[i].key, wrong[i].rule, NULL));
  for (i = 0; i < sizeof of_scenes / sizeof of_scenes[0]; ++i) {
    CHECK(is_error(r, lockstep_add_force(r, "named", of_scenes[i], force, NULL, NULL), LOCKSTEP_USAGE, "taken", NULL));
    CHECK(is_error(r, lockstep_add_joint(r, "named", of_scenes[i], 1, NULL, joint, NULL, NULL), LOCKSTEP_USAGE, "taken",
                   NULL));
  }
  CHECK(is_error(r, lockstep_add_law(r, "sine", NULL, law, NULL, NULL, NULL), LOCKSTEP_PLUGIN, "'sine'", NULL));
}

/* Numbers that have few values. */
static void limits(lockstep_registry* r, lockstep_run* run) {
  const int orders[] = {0, -1, 1000};
  int i;
  for (i = 0; i < 3; ++i) {
    char is[32];
    snprintf(is, sizeof is, "order is %d; must be 1 to", orders[i]);
    CHECK(is_error(r, lockstep_add_integrator(r, "i", NULL, orders[i], step, NULL, NULL), LOCKSTEP_USAGE, is, NULL));
  }
  CHECK(is_error(r, lockstep_add_joint(r, "j", NULL, 4, NULL, joint, NULL, NULL), LOCKSTEP_USAGE,
                 "rows is 4; must be 1 to 3", NULL));
  CHECK(is_error(run, lockstep_add_event(run, "e", "b.x", NULL, 0, 0, 7, NULL, NULL, NULL), LOCKSTEP_USAGE,
                 "once is 7; must be 0 to 1", NULL));
  CHECK(is_error(run, lockstep_add_event(run, "e", "b.x", NULL, 0, -2, 1, NULL, NULL, NULL), LOCKSTEP_USAGE,
                 "crossing is -2; must be -1 to 1", NULL));
  CHECK(is_error(run, lockstep_add_event(run, "e", "b.x", NULL, NAN, 0, 1, NULL, NULL, NULL), LOCKSTEP_USAGE, "nan",
                 NULL));
  CHECK(is_error(run, lockstep_linearize(run, NULL, 1, (const double[3]){0, NAN, 0}), LOCKSTEP_USAGE,
                 "spin[1] is nan; must be finite", NULL));
  CHECK(is_error(run, lockstep_switch(run, "F", 2), LOCKSTEP_USAGE, "active is 2; must be 0 to 1", NULL));
  CHECK(is_error(run, lockstep_linearize(run, NULL, -1, NULL), LOCKSTEP_USAGE, "frozen is -1; must be 0 to 1", NULL));
  CHECK(is_error(run, lockstep_on_row(run, row, 3, NULL, NULL), LOCKSTEP_USAGE, "keep is 3; must be 0 to 1", NULL));
  CHECK(is_error(run, lockstep_finding(run, 0, NULL, NULL), LOCKSTEP_USAGE, "index of a finding is 0; there is none",
                 NULL));
}

void test_misuse(void) {
  const char* const scene =
      "{'lockstep': 1, 'bodies': [{'name': 'b', 'mass': 1, 'inertia': [1, 1, 1]}], 'forces': [{'name': 'F',"
      " 'type': 'applied_force', 'p': 'b', 'at': [0, 0, 0], 'direction': 'x', 'law': {'type': 'input', 'name': 'u'}}],"
      " 'run': {'until': 1}}";
  double mine[64];
  lockstep_registry* registry = NULL;
  lockstep_run *run, *failed = NULL, *other = NULL;
  lockstep_state* state = NULL;
  void* garbage[3];
  int i;
  DONE(registry, lockstep_new_registry(&registry));
  run = run_of(registry, scene);
  CHECK(lockstep_matrix(run, 'A', NULL, NULL, NULL) == LOCKSTEP_USAGE); /* before what it needs */
  CHECK(lockstep_signals(run, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_last(run, 0, mine) == LOCKSTEP_USAGE);
  CHECK(lockstep_column(run, -1, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_column(run, 99, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_advance(run, -1) == LOCKSTEP_MODEL);
  CHECK(lockstep_run_until(run, NAN) != LOCKSTEP_DONE);
  CHECK(lockstep_step(run, -1, NULL) != LOCKSTEP_DONE);
  DONE(run, lockstep_get_state(run, &state));
  null_arguments(registry, run, state);
  texts(registry, run, state, scene);
  words(registry);
  limits(registry, run);
  CHECK(lockstep_check_type(registry, "body", "sine", NULL, NULL, NULL) == LOCKSTEP_USAGE);
  CHECK(lockstep_check_type(registry, "law", "no", NULL, NULL, NULL) == LOCKSTEP_SCENE);
  CHECK(lockstep_check_type(registry, "law", "sine", "{", NULL, NULL) == LOCKSTEP_SCENE);
  CHECK(lockstep_load_plugin(registry, "no_such_plugin") == LOCKSTEP_PLUGIN);
  CHECK(lockstep_open_text(NULL, "", NULL, NULL, &failed) == LOCKSTEP_SCENE);
  CHECK(lockstep_open_text((lockstep_registry*)(void*)run, quoted(scene), NULL, NULL, &other) == LOCKSTEP_CLOSED);
  DONE(other, lockstep_free(other));

  of_a_registry(NULL, LOCKSTEP_NULL);
  of_a_run(NULL, NULL, LOCKSTEP_NULL);
  of_a_state(NULL, LOCKSTEP_NULL);
  CHECK(lockstep_free(NULL) == LOCKSTEP_DONE);
  CHECK(lockstep_error_code(NULL) == LOCKSTEP_CLOSED && strcmp(lockstep_error_json(NULL), "{}") == 0);
  garbage[0] = mine, garbage[1] = (void*)(uintptr_t)1, garbage[2] = failed;
  for (i = 0; i < 3; ++i) {
    of_a_registry(garbage[i], LOCKSTEP_CLOSED);
    of_a_run(garbage[i], state, LOCKSTEP_CLOSED);
    of_a_state(garbage[i], LOCKSTEP_CLOSED);
  }
  of_a_registry((void*)run, LOCKSTEP_CLOSED); /* handles of another kind */
  of_a_run((void*)registry, state, LOCKSTEP_CLOSED);
  of_a_state((void*)run, LOCKSTEP_CLOSED);
  CHECK(lockstep_set_state(run, (void*)registry) == LOCKSTEP_CLOSED);
  CHECK(lockstep_error_code(failed) == LOCKSTEP_SCENE);
  CHECK(strlen(lockstep_error_text(failed)) > 10);
  DONE(failed, lockstep_free(failed));

  DONE(registry, lockstep_free(registry)); /* the run outlives its registry, the state its run */
  DONE(run, lockstep_run_to_end(run));
  DONE(run, lockstep_free(run));
  DONE(state, lockstep_project(state, NULL));
  DONE(state, lockstep_free(state));
  of_a_registry(registry, LOCKSTEP_CLOSED); /* freed, and again */
  of_a_run(run, state, LOCKSTEP_CLOSED);
  of_a_state(state, LOCKSTEP_CLOSED);
  for (i = 0; i < 2; ++i) {
    CHECK(lockstep_free(registry) == LOCKSTEP_CLOSED);
    CHECK(lockstep_free(run) == LOCKSTEP_CLOSED);
    CHECK(lockstep_free(state) == LOCKSTEP_CLOSED);
    CHECK(lockstep_free(mine) == LOCKSTEP_CLOSED);
  }
  CHECK(lockstep_error_code(run) == LOCKSTEP_CLOSED && strlen(lockstep_error_text(run)) > 10);
  CHECK(strcmp(lockstep_code_name(LOCKSTEP_BUSY), "busy") == 0 && strcmp(lockstep_code_name(-3), "") == 0);
}
