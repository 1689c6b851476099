// SPDX-License-Identifier: BSD-3-Clause
// Applied forces: the base classes, and a force from a function.
#pragma once

#include <concepts>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include <lockstep/author/lock.h>
#include <lockstep/detail/markers.h>
#include <lockstep/detail/rows.h>
#include <lockstep/error.h>

namespace lockstep {

// Reacting: the facet of a force that depends on the reactions of joints, as friction does.

class Force;
class Params;
struct Attachment;

/// The friction that can act at rest: a force or a moment along some directions, up to a limit.
struct Grip {
  std::string what,         ///< "sliding", "turning"
      unit;                 ///< of `most`: "N", "N m"
  double most = 0;          ///< the largest size of it
  std::vector<VecX> along;  ///< the load of one unit along each of its directions, which are perpendicular: 6 per slot,
                            ///< N (world) and N m (slot axes)
};

/// The facet of a force that depends on the reactions of joints. Such a force derives from it, and Force::reacting()
/// returns `this`. Its load is added to that of apply(). The solution is found by iteration, so the force as a function
/// of the reactions must be a contraction, as friction with a coefficient well below one is.
class LOCKSTEP_API Reacting {
 public:
  /// `self` is the force that derives from this.
  explicit Reacting(const Force& self) : self_(&self) {}

  /// The joints whose reactions it reads. Asked before setup(), because these joints are not merged into slots.
  virtual std::vector<const Lock*> reads() const = 0;
  /// Adds what it exerts at these reactions, on top of apply().
  virtual void react(const Inputs&, const Reactions&, WrenchSum&) const = 0;
  /// Power that react() takes out, W, not negative; default 0.
  virtual double friction_loss(const Inputs&, const Reactions&) const { return 0; }
  /// The friction that can act at rest under these reactions; react() is smooth and zero there. Default: nothing.
  virtual std::vector<Grip> grips(const Inputs&, const Reactions&) const { return {}; }
  /// Adds K and D of react() with the multipliers fixed; conventions of TangentSum. Default: central differences.
  virtual void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const;
  /// Recorder channels of the force, whether they depend on reactions or not; used in place of Observable's. Default:
  /// none.
  virtual std::vector<Quantity> quantities() const { return {}; }
  /// Value of channel k of quantities().
  virtual double reacting_quantity(int, const Inputs&, const Reactions&) const { return 0; }

 protected:
  ~Reacting() = default;

 private:
  const Force* self_;
};

// Force: exerts wrenches and constrains nothing. It adds to a sum and never changes the bodies.

/// A law that a force reads.
struct ForceLaw {
  std::string what,         ///< "torque", "law", "laws_x": as its key
      unit;                 ///< of its value: "N m"
  LawPtr<MotionLaw> law{};  ///< not null
};

/// An applied force. A class of force has to define type(), markers(), setup() and apply(); all else has a default or
/// belongs to a facet.
class LOCKSTEP_API Force {
 public:
  /// The name is unique among the names of the system.
  explicit Force(std::string name);
  virtual ~Force();
  Force(const Force&) = delete;
  Force& operator=(const Force&) = delete;

  const std::string& name() const { return name_; }  ///< name in the system
  /// Name of its type, "spring_damper"; for messages.
  virtual std::string_view type() const = 0;
  /// Origin of its type: "built in", a plugin's name, or "" for a class of the host.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }  ///< set by the registry

  // -- description
  /// The markers at which it acts; for slots, messages and checks.
  virtual std::vector<const Marker*> markers() const = 0;
  /// Appends the times in (t0, t1), s, when one of its laws jumps. Default: none.
  virtual void breakpoints(double /*t0*/, double /*t1*/, std::vector<double>& /*out*/) const {}
  /// Which of its laws throws or is not finite at time t, s, in words; "" when none is. Default: "". As
  /// Driven::diagnose.
  virtual std::string diagnose(double /*t*/) const { return {}; }

  /// The laws that it reads, for accounts. Default: none.
  virtual std::vector<ForceLaw> laws() const { return {}; }
  /// Whether it keeps a mechanism that moves in this plane there, at any time and in any position: its forces are in
  /// the plane, without lever arms along the normal, and its moments along the normal. After setup. Default: false,
  /// unknown, which keeps the mechanism in space.
  virtual bool stays_in_plane(Plane) const { return false; }

  // -- setup: called when the bodies have their slots
  /// Prepares the evaluation; throws ModelError for a mechanism in which the force cannot act.
  virtual void setup() = 0;
  /// Asks for the angles that it counts, and keeps the references; called after setup(). Default: none.
  virtual void count_angles(AngleCounter&) {}

  // -- evaluation
  /// Adds the wrenches on the slots to `out`. Within a step the same inputs give the same wrenches; between two calls of a
  /// run other data that it reads may change (ControlInput).
  virtual void apply(const Inputs&, WrenchSum& out) const = 0;
  /// Adds K = -df/d(dx, dth) and D = -df/d(v, w) to `out`; conventions of TangentSum. Only implicit methods ask for it.
  /// Default: central differences of apply() over the slots of the markers.
  virtual void tangent(const Inputs&, TangentSum& out) const;
  /// Potential energy, J; asked only while energy is recorded; default 0.
  virtual double potential(const Inputs&) const { return 0; }
  /// Power that dampers take out, W, not negative; default 0.
  virtual double dissipation(const Inputs&) const { return 0; }
  /// Power that laws and motors put in, W: what the force gives to the bodies beyond -dV/dt and the dampers. The energy
  /// balance relies on it. Default 0.
  virtual double supply(const Inputs&) const { return 0; }

  // -- facets: null without it; a class with the facet derives from it and returns `this`
  virtual const Observable* observable() const { return nullptr; }    ///< recorder channels of the force
  virtual const Remembering* remembering() const { return nullptr; }  ///< numbers in State::z
  virtual const Reacting* reacting() const { return nullptr; }        ///< it depends on the reactions of joints

  /// How many numbers of State::z are its own.
  int n_own_memory() const { return remembering() ? remembering()->n_memory() : 0; }
  int first_memory() const { return first_memory_; }  ///< index of the first of them; set by System::setup
  /// Moving slots of its markers, each once; set by System::setup.
  const std::vector<int>& slots() const { return slots_; }
  void place(int first_memory);  ///< called by System::setup

  // -- switched by events
  /// Lets events switch it on and off (Event::activate, deactivate), which takes one more number of State::z. `on`:
  /// whether it acts at the start. To be called before System::setup.
  void set_switched(bool on) { switched_ = true, on_at_start_ = on; }
  bool is_switched() const { return switched_; }       ///< whether events may switch it
  bool acts_at_start() const { return on_at_start_; }  ///< whether it acts at the start
  /// Index in State::z of whether it acts (1) or not (0); -1: it always acts. Set by System::setup.
  int switch_memory() const { return switch_memory_; }
  /// Whether it acts at these inputs.
  bool acts(const Inputs& in) const {
    return switch_memory_ < 0 || in.z[static_cast<std::size_t>(switch_memory_)] != 0;
  }

 private:
  std::string name_, origin_;
  int first_memory_ = 0, switch_memory_ = -1;
  bool switched_ = false, on_at_start_ = true;
  std::vector<int> slots_;
};

/// Does not compile for a force whose facets would not be found.
template <class F>
void check_force_facets() {
  if constexpr (std::derived_from<F, Force>)
    static_assert(facets_are_found<F, Force>(&F::observable, &F::remembering, &F::reacting),
                  "a force that derives from a facet (Observable, Remembering, Reacting) overrides its accessor to "
                  "return this");
}

// MarkerForce: common part of the forces between markers: P, perhaps S, their folded frames, and checks of parameters.

/// A force on one marker P, or between two, P and S.
class LOCKSTEP_API MarkerForce : public Force {
 public:
  /// Throws ModelError for a marker without a body, or P and S on one body.
  MarkerForce(std::string name, Marker& p, Marker* s);
  ~MarkerForce() override;

  std::vector<const Marker*> markers() const override;
  /// Appends those of the markers' laws and of all laws given to add_law().
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// Examines the same laws.
  std::string diagnose(double t) const override;
  /// Those given to add_law().
  std::vector<ForceLaw> laws() const override { return laws_; }
  /// Folds the markers into their slots. Derived classes that override it call it.
  void setup() override;

  const Marker& p() const { return *p_; }  ///< marker P
  const Marker* s() const { return s_; }   ///< marker S; nullptr: nothing takes the reaction

 protected:
  // Each throws ParameterError "force 'name': key is value; must be ...".
  /// Throws ParameterError with `key` and `problem` unless `ok`.
  void require(bool ok, const char* key, const std::string& problem) const;
  /// Throws ParameterError unless `value` is finite.
  void require_finite(const char* key, double value) const;
  /// Throws ParameterError unless all components are finite.
  void require_finite(const char* key, const Vec3& value) const;
  /// Throws ParameterError unless `value` is finite and not negative.
  void require_not_negative(const char* key, double value) const;

  /// Throws ModelError when the marker is on a particle, which cannot rotate; `does`: "rotates", for example.
  void require_turning(const Marker& m, const char* does) const;

  /// Whether the laws of the markers keep a planar mechanism in this plane and, for a force (`pushes`), their origins and
  /// the centres of mass are at one height: stays_in_plane() of a force along lines between or through them.
  bool markers_stay_in(Plane, bool pushes = true) const;
  /// Whether a force at P has no lever arm along the normal of the plane on the bodies of P and S.
  bool has_no_arms(Plane) const;
  /// For breakpoints(), diagnose() and laws(); null is ignored. `what`: its key; `unit`: of its value.
  void add_law(const LawPtr<MotionLaw>& law, std::string what = "law", std::string unit = {});
  /// Value of a law at time t, s; 0 without a law.
  static double value(const LawPtr<MotionLaw>& law, double t) { return law ? law->at(t).y : 0.0; }

  MarkerFrame P_,  ///< P folded into its slot by setup()
      S_;          ///< S folded into its slot by setup(); the ground's origin when there is no S

 private:
  const Marker* p_;
  const Marker* s_;
  std::vector<ForceLaw> laws_;
};

/// Marker P of a attachment, for makers. Throws SceneError when there is none.
LOCKSTEP_API Marker& p_of(const Attachment&, const Params&);
/// Marker S of a attachment, for makers. Throws SceneError when there is none.
LOCKSTEP_API Marker& s_of(const Attachment&, const Params&);
/// Whether the attachment has a marker S.
LOCKSTEP_API bool has_s(const Attachment&);

struct ForceAccount;

// FormulaForce: a force between markers from one formula.

/// A force between markers from one formula: F derives from FormulaForce<F> and has act(ends, load), as described in
/// namespace formula (include formula.h to write one). Wrench, tangent and energies come from it. The first of F's
/// quantities() are those that act() shows; one more at the end, "power", is the power given to the two bodies, W.
template <class F>
class FormulaForce : public MarkerForce, public Observable {
 public:
  using MarkerForce::MarkerForce;

  /// The wrench of the formula.
  void apply(const Inputs& in, WrenchSum& out) const override;
  /// The derivatives of the formula, on jets.
  void tangent(const Inputs& in, TangentSum& out) const override;
  /// The energies that the formula stores, J.
  double potential(const Inputs& in) const override;
  /// The powers that it dissipates, W.
  double dissipation(const Inputs& in) const override;
  /// The powers that it and the markers' laws supply, W.
  double supply(const Inputs& in) const override;
  const Observable* observable() const override { return this; }  ///< this
  /// None, for forces without channels; a class that shows quantities overrides it.
  std::vector<Quantity> quantities() const override { return {}; }
  /// The k-th number that the formula shows; after the last one, the power.
  double quantity(int k, const Inputs& in) const override;
  /// Slots whose motions act() reads besides those of its markers, each once. Default: none; F hides it.
  std::span<const int> also_reads() const { return {}; }

 private:
  auto act() const;
  ForceAccount account(const Inputs& in) const;
};

// FunctionForce: a force from a function.

/// A force from a function of time, motions and states:
///
///     sys.add(function_force("drag", {&tip}, [&tip](const Inputs& in, WrenchSum& out) {
///       const MarkerInWorld M = in_world(MarkerFrame(tip), in);
///       out.force(tip.body->slot, -0.3 * M.v.norm() * M.v, M.x);
///     }));
///
/// Between two calls of a run a host may change data that the functions read, best as a ControlInput
/// (System::add_input), which checkpoints save: the next step begins with it, with any method. Within a step the same
/// `in` must give the same result, and the functions change only `out`. `potential` (J) and `dissipation` (W, not
/// negative) enter the energies; without them they are zero.
class LOCKSTEP_API FunctionForce final : public Force {
 public:
  using Apply = std::function<void(const Inputs&, WrenchSum&)>;  ///< adds wrenches to a sum
  using Energy = std::function<double(const Inputs&)>;           ///< an energy, J, or a power, W

  /// `markers`: those at which it acts. Throws ModelError for no function, or a marker that is null or without a body.
  FunctionForce(std::string name, std::vector<const Marker*> markers, Apply apply, Energy potential = {},
                Energy dissipation = {});

  std::string_view type() const override { return "function_force"; }
  std::vector<const Marker*> markers() const override { return markers_; }
  /// Appends those of the markers' laws.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { apply_(in, out); }
  double potential(const Inputs& in) const override { return potential_ ? potential_(in) : 0.0; }
  double dissipation(const Inputs& in) const override { return dissipation_ ? dissipation_(in) : 0.0; }

 private:
  std::vector<const Marker*> markers_;
  Apply apply_;
  Energy potential_, dissipation_;
};

/// A FunctionForce, for System::add.
LOCKSTEP_API std::unique_ptr<FunctionForce> function_force(std::string name, std::vector<const Marker*> markers,
                                                           FunctionForce::Apply apply,
                                                           FunctionForce::Energy potential = {},
                                                           FunctionForce::Energy dissipation = {});

}  // namespace lockstep
