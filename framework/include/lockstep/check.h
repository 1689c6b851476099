// Checks for authors of links, laws, forces and integrators.
#pragma once

#include <cstdint>
#include <functional>
#include <memory>
#include <string>
#include <vector>

#include <lockstep/export.h>
#include <lockstep/integrator.h>
#include <lockstep/law.h>
#include <lockstep/lock.h>
#include <lockstep/params.h>
#include <lockstep/registry.h>
#include <lockstep/system.h>

namespace lockstep {

// What a check found: a value. Each finding says in words what is wrong and where to look.


/// Where the checks look. States are drawn about the start of the system; equal seeds draw equal states.
struct CheckOptions {
  std::uint64_t seed = 1;
  int states = 8;           ///< random states (laws: 8 instants for each)
  double from = 0, to = 2;  ///< the time that is looked at, s
  double reach = 0.3;       ///< moves of bodies from their places at the start, of the distance between them
  double turn = 0.5;        ///< turns from there, rad
  int pairs = 1;            ///< marker pairs of a type that is made from a registry
};

/// One thing that a check found, in words.
struct Finding {
  std::string what;  ///< the entry, what it is, and what it should be
  std::string look;  ///< where to look
};

/// The findings of one check, worst entry of each kind only.
class LOCKSTEP_API CheckReport {
 public:
  /// `subject`: "link 'cam' (cam_follower)".
  CheckReport(std::string subject, std::uint64_t seed) : subject_(std::move(subject)), seed_(seed) {}

  bool ok() const { return findings_.empty(); }
  /// The subject and "nothing found" or the findings, one a line; then how good the differences were and the notes.
  std::string text() const;

  const std::string& subject() const { return subject_; }
  std::uint64_t seed() const { return seed_; }
  const std::vector<Finding>& findings() const { return findings_; }
  const std::vector<std::string>& notes() const { return notes_; }  ///< no faults: what was measured, what was left out
  long comparisons() const { return n_comparisons_; }
  double accuracy() const { return accuracy_; }  ///< worst error of a difference, of the size of what was compared

  // -- for those who check
  /// Takes a finding; of those with one key (kind and entry) the one with the largest `weight` stays.
  void add(const std::string& key, Finding, double weight = 0);
  void note(std::string words);
  /// A comparison was made; its differences were good to `error` of the size.
  void compared(double error);
  /// All findings and notes of another report.
  void take(const CheckReport&);

 private:
  struct Key {
    std::string key;
    double weight;
  };
  std::string subject_;
  std::uint64_t seed_;
  std::vector<Finding> findings_;
  std::vector<Key> keys_;
  std::vector<std::string> notes_;
  long n_comparisons_ = 0;
  double accuracy_ = 0;
};

/// "; it has the wrong sign", "; it is half of that: ...": what a wrong number looks like beside the right one; "" when
/// nothing comes to mind.
LOCKSTEP_API std::string likeness(double is, double should_be);


// check_force: holds what a force says about itself - power, energies, tangent - against what it does to the bodies.


/// At random states about the start:
///
///   power f.v = -dV/dt - dissipation() + supply(),   dissipation() >= 0,   K = -df/d(x, turn) and D = -df/d(v, w) of
///   tangent() (9.13)
///
/// by differences whose own error estimate is the tolerance; and: numbers finite, the same when asked again and for a
/// quaternion of the other sign; no body pushed on which markers() has none; memory and full turns about z of S; jumps
/// in time outside of breakpoints(). A force that reads reactions gets drawn ones, and react(), friction_loss() and
/// react_tangent() are looked at with apply() and the others. The force has to be one of the system's. Throws
/// ModelError if not, and what setup() throws.
LOCKSTEP_API CheckReport check_force(System&, const Force&, const CheckOptions& options = {});

/// The same for a registered type, which is made from `params` in a small system of its own: between moving bodies,
/// with either side on the ground, with markers that move by laws. Throws what the maker throws;
/// what it refuses in the later ones is noted.
LOCKSTEP_API CheckReport check_force(const Registry&, const std::string& type, const Params& params = {},
                                     const CheckOptions& options = {});


// check_integrator: measures a method's order on motions with closed forms, and tries what the step loop relies on.


using IntegratorMaker = std::function<std::unique_ptr<Integrator>()>;

/// On a free top (it turns about its angular momentum and about its axis at steady rates) and a large pendulum on a
/// hinge (elliptic functions; rows, projection, a force with memory):
///
///   order: error against the step, halved from coarse to fine; adaptive methods: against the mean step, and the error
///   against the tolerance (slope one);   steps of at most h, time and report agree, memory and links left alone, unit
///   quaternions, C = 0 where the dynamics projects;   a step that throws leaves the state as it was;   two runs are
///   equal, a method begun anew too, after a rewind too; save() and restore() take a step back and make a checkpoint;
///   dense(): ends and order
///
/// `options`: its seed only.
LOCKSTEP_API CheckReport check_integrator(const IntegratorMaker&, const CheckOptions& options = {});

/// The same for a registered type. Throws what the maker throws.
LOCKSTEP_API CheckReport check_integrator(const Registry&, const std::string& type, const Params& params = {},
                                          const CheckOptions& options = {});


// check_law: holds a law's derivatives against differences of what it says, and looks for jumps that it does not tell.


/// Over options.from ... options.to, at 8 options.states random instants away from its breakpoints: numbers finite and
/// the same when asked again; the second level the derivative of the first and the third of the second (differences of
/// order 8, tolerance from their own error estimate); jumps outside of breakpoints(), named by their instant. Give the
/// time over which the law does something. `name` for messages; default: its type.
LOCKSTEP_API CheckReport check_law(const MotionLaw&, const CheckOptions& options = {}, const std::string& name = {});
LOCKSTEP_API CheckReport check_law(const TranslationLaw&, const CheckOptions& options = {},
                                   const std::string& name = {});
/// Also: q unit; w = 2 q' qd and a = wd in the moved frame's own axes.
LOCKSTEP_API CheckReport check_law(const RotationLaw&, const CheckOptions& options = {}, const std::string& name = {});


// check_lock: holds what a link says about itself against differences of its own constraint.


/// At random states about the start, off the constraints as well:
///
///   each entry of Jh against dC/d(x, turn),   Ct against dC/dt of the held pose,   Qhat against -Cdd of a motion
///   without accelerations (4.14),   tangent() against d(Jh^T lambda)/d(x, turn) (9.4)
///
/// by differences of order 8 whose own error estimate is the tolerance (Qhat: second differences, some 1e-8); and:
/// rows, names and kinds; every number written and none beside them; numbers finite, the same when asked again, the
/// same for a quaternion of the other sign; slots() complete; groups; memory and full turns about z of S; jumps in time
/// outside of breakpoints(). Rows in space only, not gather_plane(). The link has to be one of the system's. Throws
/// ModelError if not, and what setup() throws.
LOCKSTEP_API CheckReport check_lock(System&, const Lock&, const CheckOptions& options = {});

/// The same for a registered type, which is made from `params` between bodies of a small system of its own: both
/// moving, either side on the ground, markers that move by laws. Throws what the maker
/// throws; what it refuses in the later ones is noted.
LOCKSTEP_API CheckReport check_lock(const Registry&, const std::string& type, const Params& params = {},
                                    const CheckOptions& options = {});

}  // namespace lockstep
