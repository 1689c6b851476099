// SPDX-License-Identifier: BSD-3-Clause
// Checks for authors of joints, laws, forces and integrators.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/author/integrator.h>
#include <lockstep/author/law.h>
#include <lockstep/author/lock.h>
#include <lockstep/author/params.h>
#include <lockstep/author/registry.h>
#include <lockstep/system.h>

namespace lockstep {

// The report of a check. Each finding describes what is wrong and where to look for the cause.

/// Range of the checks. States are drawn about the start of the system; equal seeds draw equal states.
struct CheckOptions {
  std::uint64_t seed = 1;  ///< of the random numbers
  int states = 8;          ///< number of random states; for laws, 8 times for each of them
  double from = 0,         ///< beginning of the checked time, s
      to = 2;              ///< end of that time, s
  double reach = 0.3;      ///< largest displacement along each axis from the start, over the distance between bodies
  double turn = 0.5;       ///< largest rotation of a body from the start about each axis, rad
  int pairs = 1;           ///< marker pairs of a type that is made from a registry, 1 to 3
};

/// One fault that a check found.
struct CheckFinding {
  std::string what;  ///< the entry, its value, and what it should be
  std::string look;  ///< where to look for the cause
};

/// The findings of one check: only the worst of each kind.
class LOCKSTEP_API CheckReport {
 public:
  /// `subject`: the checked object, "joint 'cam' (cam_follower)". `seed`: of the random numbers.
  CheckReport(std::string subject, std::uint64_t seed) : subject_(std::move(subject)), seed_(seed) {}

  bool ok() const { return findings_.empty(); }  ///< whether there are no findings
  /// The report, one item per line: the subject with "no findings" and the accuracy, or the findings, twenty at most;
  /// then the notes.
  std::string text() const;

  const std::string& subject() const { return subject_; }                  ///< the checked object
  std::uint64_t seed() const { return seed_; }                             ///< of the random numbers
  const std::vector<CheckFinding>& findings() const { return findings_; }  ///< in the order in which they were found
  const std::vector<std::string>& notes() const { return notes_; }         ///< no faults: measurements, omitted checks
  long comparisons() const { return n_comparisons_; }               ///< number of comparisons made
  double accuracy() const { return accuracy_; }  ///< largest relative error of a difference that was compared with

  // -- for checks
  /// Adds a finding; of findings with the same key (kind and entry) the one with the largest `weight` stays.
  void add(const std::string& key, CheckFinding, double weight = 0);
  void note(std::string words);  ///< adds a note, unless one has the same words in front of " at "
  /// Counts a comparison with a difference whose relative error is `error`.
  void compared(double error);
  /// Adds all findings, notes and comparisons of another report.
  void take(const CheckReport&);

 private:
  struct Key {
    std::string key;
    double weight;
  };
  std::string subject_;
  std::uint64_t seed_;
  std::vector<CheckFinding> findings_;
  std::vector<Key> keys_;
  std::vector<std::string> notes_;
  long n_comparisons_ = 0, n_omitted_ = 0;
  double accuracy_ = 0;
};

/// What the comparison of a wrong number with the right one suggests: ", so it has the wrong sign", ", so it is half
/// the value: a factor of 2 is missing"; "" if it suggests nothing.
LOCKSTEP_API std::string likeness(double is, double should_be);

// check_force: compares the power, energies and tangent that a force reports with its load on the bodies.

/// Checks a force of a system, at random states about the start:
///
///     power f.v = -dV/dt - dissipation() + supply(),   dissipation() >= 0,
///     K = -df/d(x, rotation) and D = -df/d(v, w) of tangent() (9.13)
///
/// by differences whose error estimate is the tolerance. It also checks that all numbers are finite, and the same in a
/// second call and for a quaternion of the other sign; that it acts only on bodies of its markers(); its memory, and
/// revolutions about z of S; that it does not jump in time except at breakpoints(). A force that reads
/// reactions gets random ones, and react(), friction_loss() and react_tangent() are checked together with apply() and
/// the others. Throws ModelError if the force is not in the system, and what System::setup throws.
LOCKSTEP_API CheckReport check_force(System&, const Force&, const CheckOptions& options = {});

/// Checks a registered type of force, made from `params` in small systems: between moving bodies, with either side on
/// the ground, with markers that move by laws. Throws what the maker throws in the first of them; an error in a later
/// one becomes a note.
LOCKSTEP_API CheckReport check_force(const Registry&, const std::string& type, const Params& params = {},
                                     const CheckOptions& options = {});

// check_integrator: measures a method's order on motions with closed forms, and tests what the step loop requires.

using IntegratorMaker = std::function<std::unique_ptr<Integrator>()>;  ///< makes an integrator; must not return null

/// Checks an integrator on a free top (it rotates about its angular momentum and about its axis at steady rates) and on
/// a pendulum of large amplitude on a hinge (elliptic functions; rows, projection, a force with memory):
///
/// - order: the error against the step, halved from coarse to fine; of adaptive methods against the mean step, and the
///   error against the tolerance (slope one)
/// - steps are at most h long; time and report agree; memory and joints do not change; quaternions have length one;
///   C = 0 if the dynamics projects
/// - a step that throws leaves the state unchanged
/// - two runs are equal, also after a second begin(); save() and restore() take steps back and make a checkpoint
/// - dense(): its ends and its order
///
/// Of `options` only the seed is used, for the report. Throws ModelError if the maker returns null, and what it throws.
LOCKSTEP_API CheckReport check_integrator(const IntegratorMaker&, const CheckOptions& options = {});

/// Checks a registered type of integrator, made from `params`. Throws what the maker throws.
LOCKSTEP_API CheckReport check_integrator(const Registry&, const std::string& type, const Params& params = {},
                                          const CheckOptions& options = {});

// check_law: compares a law's derivatives with differences of its values, and finds jumps that it does not report.

/// Checks a scalar law between options.from and options.to; give the time over which it varies. At 8 options.states
/// random times away from its breakpoints each derivative is compared with differences of order 8 of the level before
/// it, whose error estimate is the tolerance. It also checks that all numbers are finite, and the same in a second
/// call, and reports the times of jumps outside of breakpoints(), and jumps there of which at(t) has the new value too
/// late, and motions that begin or end outside of breakpoints(); such a slow change is only noted, and so is a listed
/// jump of y. An exception of the law is a finding. `name`: for messages, or "". Throws ModelError if the times are not
/// in order.
LOCKSTEP_API CheckReport check_law(const MotionLaw&, const CheckOptions& options = {}, const std::string& name = {});
/// The same for a translation law: x, v and a.
LOCKSTEP_API CheckReport check_law(const TranslationLaw&, const CheckOptions& options = {},
                                   const std::string& name = {});
/// The same for a rotation law, with w = 2 q' qd and a = wd in the axes of the moved frame; q must have length one.
LOCKSTEP_API CheckReport check_law(const RotationLaw&, const CheckOptions& options = {}, const std::string& name = {});

// check_lock: compares the derivatives that a joint reports with differences of its constraint.

/// Checks a joint of a system, at random states about the start, also off the constraints:
///
/// - the derivatives of its function, if it is made of one; the others follow from these
/// - each entry of Jh with dC/d(x, rotation)
/// - Ct with dC/dt at a fixed pose
/// - Qhat with -Cdd of a motion without accelerations (4.14)
/// - tangent() with d(Jh^T lambda)/d(x, rotation) (9.4)
///
/// by differences of order 8 whose error estimate is the tolerance (Qhat: second differences, about 1e-8). It also
/// checks rows, names and kinds; that every number of the rows is written and nothing else; that all numbers are
/// finite, and the same in a second call and for a quaternion of the other sign; that slots() is complete; groups; its
/// memory, and revolutions about z of S; that it does not jump in time except at breakpoints(); that each row removes a
/// degree of freedom. A jump or a corner of its function is a finding if it is on the constraint between two
/// consecutive states; some are missed. So is an exception of the joint. Only rows in space are checked, not
/// gather_plane(). Throws ModelError if the joint is not in the system, and what System::setup throws.
LOCKSTEP_API CheckReport check_lock(System&, const Lock&, const CheckOptions& options = {});

/// Checks a registered type of joint, made from `params` in small systems: between moving bodies, with either side on
/// the ground, with markers that move by laws. Throws what the maker throws in the first of them; an error in a later
/// one becomes a note.
LOCKSTEP_API CheckReport check_lock(const Registry&, const std::string& type, const Params& params = {},
                                    const CheckOptions& options = {});

}  // namespace lockstep
