/* SPDX-License-Identifier: BSD-3-Clause */
/** @file
    lockstep from C: runs of scenes, and types written in C, by opaque handles, plain numbers and UTF-8. */
#ifndef LOCKSTEP_C_H
#define LOCKSTEP_C_H

#include <stdint.h>

/** Before a function of the library. */
#if defined(__GNUC__)
#define LOCKSTEP_C_API __attribute__((visibility("default")))
#else
#define LOCKSTEP_C_API
#endif

#ifdef __cplusplus
extern "C" {
#endif

/* Handles. A registry holds types by name, a run is a scene with its results, a state is where the bodies of a run are.
   Each is freed by lockstep_free(). All units are SI: m, kg, s, rad, N. Quaternions have their scalar part first.

   A function returns a code, 0 if it was done, and writes its results where pointers point. After another code results
   are not written, and the handle keeps the error: lockstep_error_text(handle). What a pointer of a result points to
   belongs to the handle and stays valid until the next call with it. A text is UTF-8 and ends with a zero byte;
   LOCKSTEP_USAGE: an argument is not UTF-8.

   Threads: different handles may be used in different threads at the same time. A call with a handle that is in use,
   in another thread or because this is one of its callbacks, returns LOCKSTEP_BUSY. After lockstep_free() has returned
   0, calls with the handle that come later in other threads return LOCKSTEP_CLOSED, and call nothing back. */

typedef struct lockstep_registry lockstep_registry; /**< types by name */
typedef struct lockstep_run lockstep_run;           /**< the run of a scene */
typedef struct lockstep_state lockstep_state;       /**< a state of a run */

/** Codes. Those up to 12 are the kinds of <lockstep/error.h>, and their numbers never change. */
enum {
  LOCKSTEP_DONE = 0,         /**< no error */
  LOCKSTEP_OTHER = 1,        /**< an error of none of these kinds */
  LOCKSTEP_MODEL = 2,        /**< an impossible mechanism or an unknown name */
  LOCKSTEP_ASSEMBLY = 3,     /**< a start that cannot be brought onto the constraints */
  LOCKSTEP_SOLVE = 4,        /**< equations of motion without a solution */
  LOCKSTEP_STEP = 5,         /**< a step that could not be made */
  LOCKSTEP_NON_FINITE = 6,   /**< a NaN or an infinity */
  LOCKSTEP_PLUGIN = 7,       /**< a plugin that cannot be loaded, a type that cannot be registered */
  LOCKSTEP_SCENE = 8,        /**< a scene that cannot be understood */
  LOCKSTEP_FILE = 9,         /**< a file that cannot be read or written */
  LOCKSTEP_USER_CODE = 10,   /**< a callback or a plugin failed */
  LOCKSTEP_USAGE = 11,       /**< an argument out of range, or a call at the wrong time */
  LOCKSTEP_INTERRUPTED = 12, /**< interrupted on request */
  LOCKSTEP_MEMORY = 13,      /**< no memory was left */
  LOCKSTEP_NULL = 14,        /**< a pointer that must point to something is null */
  LOCKSTEP_CLOSED = 15,      /**< not a handle of this kind, one that was freed, or one that could not be made */
  LOCKSTEP_BUSY = 16         /**< the handle is in use; its error stays as it was */
};

/** An observer that returns this ends the run after the present step; that is no error. */
enum { LOCKSTEP_STOP = -1 };

/** The name of a code, "scene"; "" for another number. */
LOCKSTEP_C_API const char* lockstep_code_name(int code);
/** The version of the library, "0.2.0". */
LOCKSTEP_C_API const char* lockstep_version(void);

/** Frees a handle; null is ignored. LOCKSTEP_CLOSED: it was freed before. LOCKSTEP_BUSY: it is in use, and stays. */
LOCKSTEP_C_API int lockstep_free(void* handle);

/* -- errors, of a handle of any kind; valid until the next call with the handle. These functions return no code. */

/** The code of the last call with this handle that failed; 0: none did. Of what is no handle LOCKSTEP_CLOSED. */
LOCKSTEP_C_API int lockstep_error_code(const void* handle);
/** Its sentence: what is wrong, in what, and what to do next; "" if there is none. Never null. */
LOCKSTEP_C_API const char* lockstep_error_text(const void* handle);
/** All its data as a JSON object, "{}" if there is none: code, kind, text, thing {kind, name, type, origin}, key, value,
    problem, advice, file, line, column (from 1; 0: from no file), and t, s (null: not during a run). */
LOCKSTEP_C_API const char* lockstep_error_json(const void* handle);

/* -- registries */

/** A registry of the types that come with lockstep. */
LOCKSTEP_C_API int lockstep_new_registry(lockstep_registry** made);
/** Loads a plugin by its name or path, and adds its types. Never pass on a path that came from a scene. */
LOCKSTEP_C_API int lockstep_load_plugin(lockstep_registry* registry, const char* name);
/** All types as a JSON object: "links" (joints), "laws", "forces", "integrators", "solvers", each a list of objects with
    name, shelf, help, origin, keys and example, as `lockstep list --json` prints them. */
LOCKSTEP_C_API int lockstep_types(lockstep_registry* registry, const char** json);

/* -- types in C. A scene names such a type: {"type": "my_law", "amplitude": "20 mm"}.

   `keys`: the keys that scenes may give, as words with or without a default: "amplitude omega=2 phase=0". A key without
   a default must be given. Values are numbers, or quantities with units, which are converted to SI; null: no keys.
   Callbacks receive `user` and `p`, the values in the order of `keys`. Names of types and keys have letters, digits
   and _, and begin with a letter. Keys that scenes give to all joints or forces, as "type", "name" and "p", are taken.

   A callback returns 0. If it returns another number, the run ends with LOCKSTEP_USER_CODE and the name of the object:
   return lockstep_fail("message"). It may be called in several threads if several runs use the type, must give
   the same results for the same arguments within a step, and must not leave by longjmp or by an exception.

   `free_user`: called with `user` when neither the registry, nor a run of it, nor a state that was copied from such a
   run exists any more, also if the function fails; null: nothing is called. LOCKSTEP_PLUGIN: the type's name is taken.
   LOCKSTEP_USAGE: names and keys that break these rules. */

/** Frees the user data of callbacks. */
typedef void (*lockstep_free_user)(void* user);

/** Keeps the message of the callback in progress in this thread, and returns LOCKSTEP_USER_CODE, for it to return.
    Without a callback in progress nothing is kept. */
LOCKSTEP_C_API int lockstep_fail(const char* message);

/** A law at time t, s: writes y[0] the value, y[1] and y[2] its first and second derivative by time, in the unit of what
    the law drives. */
typedef int (*lockstep_law)(void* user, const double* p, double t, double* y);
/** Writes the first time after t, s, at which y or a derivative jumps; leaves *next at its infinity if there is none. A
    NaN, a time that is not after t, and more than 1e7 jumps in the time that is looked through are errors. */
typedef int (*lockstep_next_break)(void* user, const double* p, double t, double* next);
/** Adds a type of scalar law. `next_break`: null if the law is smooth. */
LOCKSTEP_C_API int lockstep_add_law(lockstep_registry* registry, const char* type, const char* keys, lockstep_law law,
                                    lockstep_next_break next_break, void* user, lockstep_free_user free_user);

/** A joint's functions of y, which are held at zero. y: x, y, z of P in the axes of S, m; e0, e1, e2, e3, the quaternion
    of P relative to S; the time t, s. For each of `rows` functions it writes its value f[r], its derivatives by the eight
    variables g[8 r + i], and its second derivatives h[64 r + 8 i + k], symmetric. All are zero before the call. */
typedef int (*lockstep_joint)(void* user, const double* p, const double y[8], double* f, double* g, double* h);
/** Adds a type of joint between P and S, with 1 to 3 functions. `mask`: further constraints, words of x y z e1 e2 e3, as
    of the type "lock"; null: none. Each row must have a derivative that is not zero where it is met. */
LOCKSTEP_C_API int lockstep_add_joint(lockstep_registry* registry, const char* type, const char* keys, int rows,
                                      const char* mask, lockstep_joint joint, void* user, lockstep_free_user free_user);

/** A force at time t, s. P and S have 13 numbers each: origin x[3] (m), quaternion q[4], velocity v[3] (m/s) and angular
    velocity w[3] (rad/s) of the marker, all in world axes; without a marker S those of the ground. It writes `out`, 9
    numbers, zero before the call: the force on P's body at the origin of P [3] (N, world), the moment [3] (N m, world);
    the potential energy (J), the power that is dissipated (W, not negative) and the power that is supplied (W). The
    opposite force and moment act on S's body at the same point. */
typedef int (*lockstep_force)(void* user, const double* p, double t, const double P[13], const double S[13],
                              double out[9]);
/** Adds a type of force between P and S, or on P alone. */
LOCKSTEP_C_API int lockstep_add_force(lockstep_registry* registry, const char* type, const char* keys,
                                      lockstep_force force, void* user, lockstep_free_user free_user);

/** One step of h, s: moves the state, by lockstep_rates() and lockstep_set_numbers() or lockstep_move(). The library then
    puts its end onto the constraints. The method keeps no history from step to step. */
typedef int (*lockstep_integrator)(void* user, const double* p, lockstep_state* state, double h);
/** Adds an integrator with fixed steps, of this order, 1 to 53. */
LOCKSTEP_C_API int lockstep_add_integrator(lockstep_registry* registry, const char* type, const char* keys, int order,
                                           lockstep_integrator step, void* user, lockstep_free_user free_user);

/** Checks a type as `lockstep` checks its own: derivatives, powers and orders against differences, jumps, rows.
    `kind`: "law", "joint", "force" or "integrator"; `keys`: its keys as a JSON object, null: none. Writes the number of
    findings, and the report as text. */
LOCKSTEP_C_API int lockstep_check_type(lockstep_registry* registry, const char* kind, const char* type,
                                       const char* keys, int* findings, const char** report);

/* -- runs. `registry`: null for the types that come with lockstep; it may be freed before the run. `set`: values of the
   scene, one "NAME=VALUE" a line, as of `lockstep run --set`: "crank=0.12 m\nrun.until=2 s"; null: none. Plugins that the
   scene requires are loaded. A run that cannot be made is a handle too, which keeps the error; free it. */

/** The run of a scene file. */
LOCKSTEP_C_API int lockstep_open(lockstep_registry* registry, const char* file, const char* set, lockstep_run** made);
/** The run of a scene that is a JSON text. `name`: its name in messages; null: "scene". */
LOCKSTEP_C_API int lockstep_open_text(lockstep_registry* registry, const char* scene, const char* name, const char* set,
                                      lockstep_run** made);

/** The channels that can be recorded, as a JSON list of objects with name, unit and help. */
LOCKSTEP_C_API int lockstep_channels(lockstep_run* run, const char** json);
/** Adds a column of a channel, or of a formula of channels, "=norm(A.force_on_p_world)". `name`: of the column; null: the
    channel's. LOCKSTEP_MODEL: an unknown channel, a name that is taken, a run that has begun. */
LOCKSTEP_C_API int lockstep_record(lockstep_run* run, const char* channel, const char* name);

/* Inputs are numbers that a host sets between the steps. A law of the scene reads one: {"type": "input", "name":
   "torque", "value": 0}; laws with the same name read the same input. The column "torque.value" records it. */

/** The number of inputs. */
LOCKSTEP_C_API int lockstep_inputs(lockstep_run* run, int* count);
/** Name, unit and value of an input, 0 <= index < count. Any of the results may be null. */
LOCKSTEP_C_API int lockstep_input(lockstep_run* run, int index, const char** name, const char** unit, double* value);
/** The index of the input with this name. LOCKSTEP_MODEL: there is none. */
LOCKSTEP_C_API int lockstep_input_index(lockstep_run* run, const char* name, int* index);
/** Sets an input from the next step on. */
LOCKSTEP_C_API int lockstep_set_input(lockstep_run* run, int index, double value);

/* The first of these calls begins the run; columns cannot be added afterwards. After an error the run stands at its last
   step, its rows stay, and it may be continued. */

/** Runs to the end that the scene gives ("until"). */
LOCKSTEP_C_API int lockstep_run_to_end(lockstep_run* run);
/** Runs to the time t, s. */
LOCKSTEP_C_API int lockstep_run_until(lockstep_run* run, double t);
/** Runs on by exactly h, s, in as many steps as that takes. */
LOCKSTEP_C_API int lockstep_advance(lockstep_run* run, double h);
/** Makes one step of at most h, s (0: that of the method). `made`: its length, s, or null. */
LOCKSTEP_C_API int lockstep_step(lockstep_run* run, double h, double* made);
/** The time, s; begins the run. */
LOCKSTEP_C_API int lockstep_time(lockstep_run* run, double* t);
/** Activates (1) or deactivates (0) a joint, a force or an event; begins the run. */
LOCKSTEP_C_API int lockstep_switch(lockstep_run* run, const char* name, int active);
/** Writes the run to a checkpoint, a file. */
LOCKSTEP_C_API int lockstep_save(lockstep_run* run, const char* file);
/** Continues from a checkpoint of a run of the same scene, values, columns, events and callbacks. */
LOCKSTEP_C_API int lockstep_load(lockstep_run* run, const char* file);

/* -- the table. Column 0 is the time, s. */

/** The number of columns and of rows. Either result may be null. */
LOCKSTEP_C_API int lockstep_table(lockstep_run* run, int* columns, int64_t* rows);
/** Name and unit of a column, 0 <= index < columns. Either result may be null. */
LOCKSTEP_C_API int lockstep_column(lockstep_run* run, int index, const char** name, const char** unit);
/** The index of the column with this name. LOCKSTEP_MODEL: there is none. */
LOCKSTEP_C_API int lockstep_column_index(lockstep_run* run, const char* name, int* index);
/** The values of a column, one a row, without a copy; a formula may give NaN or infinities. The pointer is valid until the
    next call that runs, sets a state, loads a checkpoint or frees the run. */
LOCKSTEP_C_API int lockstep_values(lockstep_run* run, int index, const double** values, int64_t* rows);
/** The value in the last row. LOCKSTEP_USAGE: there is no row. */
LOCKSTEP_C_API int lockstep_last(lockstep_run* run, int index, double* value);
/** Extremes of a column over the whole motion, also between rows: out[0] the least value and out[1] its time, s; out[2]
    the largest and out[3] its time, s. LOCKSTEP_USAGE: the run has not begun, or the column is the time. */
LOCKSTEP_C_API int lockstep_extremes(lockstep_run* run, int index, double out[4]);

/* -- the verdict */

/** Writes 1 if energy and constraints were kept and no finding says that the result is wrong, else 0. It is about the steps
    that were made: calls that failed do not change it. */
LOCKSTEP_C_API int lockstep_verdict(lockstep_run* run, int* right);
/** The run as a JSON object: t, steps, rejected, largest_violation, impacts, stopped, stopped_by, right, energy
    (verdict), imbalance (relative). */
LOCKSTEP_C_API int lockstep_report(lockstep_run* run, const char** json);
/** The number of findings so far, about the scene, its start and its run. */
LOCKSTEP_C_API int lockstep_findings(lockstep_run* run, int* count);
/** A finding, 0 <= index < count: its text, and its JSON, the same fields as those of `lockstep run --json`. With index -1
    the texts of all, one a line, and a JSON list. Either result may be null. */
LOCKSTEP_C_API int lockstep_finding(lockstep_run* run, int index, const char** text, const char** json);

/* -- linearisation: x' = A x + B u, y = C x + D u about the present state. u: the inputs of the run; y: columns. */

/** Linearises. `outputs`: names of columns, one a line; null: all without the time. `frozen`: 1 accepts a state that is
    neither an equilibrium nor a steady rotation. `spin`: angular velocity of the axes that rotate with the mechanism,
    rad/s, world, 3 numbers; null: found from the state. */
LOCKSTEP_C_API int lockstep_linearize(lockstep_run* run, const char* outputs, int frozen, const double* spin);
/** A matrix of the last linearisation, row by row. `which`: 'A', 'B', 'C' or 'D'. LOCKSTEP_USAGE: there is none. */
LOCKSTEP_C_API int lockstep_matrix(lockstep_run* run, int which, const double** values, int* rows, int* columns);
/** Its signals as a JSON object: states, inputs, outputs (lists of name and unit), and accuracy of B, C and D. */
LOCKSTEP_C_API int lockstep_signals(lockstep_run* run, const char** json);

/* -- callbacks of a run. Each receives `user`, and a state that is valid during the call. A result other than 0 is an
   error, as above; LOCKSTEP_STOP of an observer is none. */

/** Called after each step. */
typedef int (*lockstep_observer)(void* user, const lockstep_state* state);
/** Sets the callback that is called after each step, in place of an earlier one; null: none. Begins the run. */
LOCKSTEP_C_API int lockstep_on_step(lockstep_run* run, lockstep_observer observer, void* user,
                                    lockstep_free_user free_user);
/** Called with each new row of the table: `count` numbers, the time first. */
typedef int (*lockstep_row)(void* user, const double* row, int count);
/** Sets the callback that is called with each new row; null: none. `keep`: 1 if the table keeps the rows too. */
LOCKSTEP_C_API int lockstep_on_row(lockstep_run* run, lockstep_row row, int keep, void* user,
                                   lockstep_free_user free_user);
/** Writes the value of a condition at a state. */
typedef int (*lockstep_condition)(void* user, const lockstep_state* state, double* value);
/** Acts at an event; may change the state. To end a run at an event, add one without an action. */
typedef int (*lockstep_action)(void* user, lockstep_state* state);
/** Adds an event; begins the run. With `channel` it happens if the channel crosses `value`; with `condition` if that
    crosses `value`; with neither at the time `value`, s. `crossing`: 1 rising, -1 falling, 0 either. `once`: 0 at every
    crossing, 1 at the first. `action`: null ends the run there. */
LOCKSTEP_C_API int lockstep_add_event(lockstep_run* run, const char* name, const char* channel,
                                      lockstep_condition condition, double value, int crossing, int once,
                                      lockstep_action action, void* user, lockstep_free_user free_user);

/* -- states */

/** A copy of the present state; begins the run. It keeps the run's mechanism, with its callbacks, until it is freed. */
LOCKSTEP_C_API int lockstep_get_state(lockstep_run* run, lockstep_state** made);
/** Begins a new run from this state, which is assembled unless the scene forbids it. */
LOCKSTEP_C_API int lockstep_set_state(lockstep_run* run, lockstep_state* state);
/** Pose of a body's frame: origin (m, world) and quaternion, 7 numbers; twist: velocity of the origin (m/s, world) and
    angular velocity (rad/s, body axes), 6 numbers. Either result may be null. */
LOCKSTEP_C_API int lockstep_body(const lockstep_state* state, const char* name, double* pose, double* twist);
/** Sets them; null: it stays. LOCKSTEP_USAGE: a state that may be read only, a quaternion without a length. Functions that
    change a state leave it as it was if they fail. */
LOCKSTEP_C_API int lockstep_set_body(lockstep_state* state, const char* name, const double* pose, const double* twist);
/** Time, s, and sizes of a state: n_q (7 per group of bodies that move as one), n_v (6 per group) and n_s (other
    integrated states). Any of the results may be null. */
LOCKSTEP_C_API int lockstep_sizes(const lockstep_state* state, double* t, int* n_q, int* n_v, int* n_s);
/** Its numbers: q (centre of mass, m, world, and quaternion), v (m/s, world, and rad/s, axes of the group), then s.
    `size`: n_q + n_v + n_s. */
LOCKSTEP_C_API int lockstep_numbers(const lockstep_state* state, double* numbers, int size);
/** Sets the time, s, and the numbers. LOCKSTEP_USAGE: a state that may be read only, another size, a quaternion without a
    length. */
LOCKSTEP_C_API int lockstep_set_numbers(lockstep_state* state, double t, const double* numbers, int size);
/* The next three evaluate the mechanism: for states of lockstep_get_state() and of integrators. LOCKSTEP_NON_FINITE: a
   result is not finite; the text names the body. */
/** The rates of the numbers, n_q + n_v + n_s, by the equations of motion. */
LOCKSTEP_C_API int lockstep_rates(const lockstep_state* state, double* rates, int size);
/** Moves the poses by h, s, along the velocities `v`, n_v numbers (null: those of the state), with unit quaternions. */
LOCKSTEP_C_API int lockstep_move(lockstep_state* state, double h, const double* v, int size);
/** Moves a state onto the constraints: positions, then velocities. `violation`: what is left, m, or null. */
LOCKSTEP_C_API int lockstep_project(lockstep_state* state, double* violation);

#ifdef __cplusplus
}
#endif

#endif
