// Applied forces: the base classes, and a force from a function.
#pragma once

#include <array>
#include <concepts>
#include <functional>
#include <memory>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include <lockstep/error.h>
#include <lockstep/export.h>
#include <lockstep/jet.h>
#include <lockstep/lock.h>
#include <lockstep/params.h>
#include <lockstep/relative.h>
#include <lockstep/rows.h>

namespace lockstep {

// Formulas of forces: what a force does, said once on any scalar; its wrench, its tangent and its powers follow.
//
//   template <class T, class Load>
//   void act(const Ends<T>& at, Load& load) const {
//     const Vec3T<T> d = at.P.x() - at.S.x();
//     load.force(-k_ * d, at.P.x(), at.S.x());
//     load.stores(0.5 * k_ * d.dot(d));
//   }
//
// Numbers (T = double) give the wrench, jets the tangent (9.13), (9.14). A load takes
//
//   force(F, x)           force F (world, N) on P's body at the point x (world, m), -F on S's body at the same point
//   force(F, x_P, x_S)    the same with a point of its own on S's body, on the line of F
//   torque(M)             torque M (world, N m) on P's body, -M on S's
//   stores(V)             potential energy, J
//   dissipates(D)         power that dampers take out, W, not negative
//   supplies(P)           power that the force's own laws put in at the markers, W
//   shows(a, b, ...)      the force's quantities(), in their order: numbers and vectors
//
// and uses what it needs of it; the rest costs nothing. Markers that move on their bodies by laws put in what the bodies
// get beyond what the markers get: that is added to supply by itself.


/// The two markers of a force at one instant. Without an S it is the ground's origin.
template <class T>
struct Ends {
  MarkerOn<T> P, S;
  double t;                   ///< s
  std::span<const double> z;  ///< the mechanism's memory, State::z
};

/// A number with its derivatives on the pose of one slot, dx dth, or on its velocity, v w: three each, turns and angular
/// velocities in slot axes.
using SlotJet = Jet<6, double, NoMotion>;

/// What a force does to its two bodies at one instant, and where its power goes.
struct ForceAccount {
  double power = 0;        ///< W, given to the two bodies
  double potential = 0;    ///< J
  double dissipation = 0;  ///< W
  double supply = 0;       ///< W, put in by laws: those of the force and those that move its markers
  std::array<double, 16> shown{};
  int n_shown = 0;
};

namespace formula {

/// Takes what a formula says and does nothing with it.
template <class T>
struct Silent {
  void stores(const T&) {}
  void dissipates(const T&) {}
  void supplies(const T&) {}
  template <class... Values>
  void shows(const Values&...) {}
};

/// Collects the wrench that a formula exerts.
struct WrenchLoad : Silent<double> {
  const WrenchSum& sum;
  int P, S;
  WrenchLoad(const WrenchSum& to, int p, int s) : sum(to), P(p), S(s) {}

  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    sum.force(P, F, x_P);
    sum.force(S, -F, x_S);
  }
  void torque(const Vec3& M) {
    sum.torque(P, M);
    sum.torque(S, -M);
  }
};

/// Collects the energies and quantities of a formula.
struct AccountLoad : ForceAccount {
  const Ends<double>& at;
  explicit AccountLoad(const Ends<double>& ends) : at(ends) {}

  void force(const Vec3& F, const Vec3& x) { force(F, x, x); }
  void force(const Vec3& F, const Vec3& x_P, const Vec3& x_S) {
    const auto marker_velocity = [](const MarkerOn<double>& m, const Vec3& x) -> Vec3 {
      return m.v() + cross(m.w(), Vec3(x - m.x()));
    };
    give(F.dot(at.P.slot_velocity(x_P) - at.S.slot_velocity(x_S)),
         F.dot(marker_velocity(at.P, x_P) - marker_velocity(at.S, x_S)));
  }
  void torque(const Vec3& M) { give(M.dot(at.P.slot_rate() - at.S.slot_rate()), M.dot(at.P.w() - at.S.w())); }
  void stores(double V) { potential += V; }
  void dissipates(double D) { dissipation += D; }
  void supplies(double W) { supply += W; }
  template <class... Values>
  void shows(const Values&... values) {
    (show(values), ...);
  }

 private:
  void give(double to_bodies, double to_markers) { power += to_bodies, supply += to_bodies - to_markers; }
  void show(double value) { shown.at(static_cast<std::size_t>(n_shown++)) = value; }
  void show(const Vec3& value) {
    for (const double x : value) show(x);
  }
};

/// The wrenches on both slots in the coordinates of the equations of motion, with what they vary by.
struct LOCKSTEP_API TangentLoad : Silent<SlotJet> {
  using Vec = Vec3T<SlotJet>;
  const Ends<SlotJet>& at;
  Vec F[2], M[2];  // of P and S: world; about the slot's origin, slot axes
  explicit TangentLoad(const Ends<SlotJet>& ends);

  void force(const Vec& f, const Vec& x) { force(f, x, x); }
  void force(const Vec& f, const Vec& x_P, const Vec& x_S);
  void torque(const Vec& m);
  /// Minus the derivatives of the wrench on P's slot (i = 0) or S's: a load enters the equations of motion so.
  Mat6 rows(int i) const;
};

/// The motion of a slot with its derivatives on its own pose or velocity, or with none.
enum class Vary { nothing, pose, velocity };
LOCKSTEP_API MotionT<SlotJet> varied(const Motion&, Vary);

inline Ends<double> ends(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in) {
  return {{in.slot(P.slot), P.at(in.t)}, {in.slot(S.slot), S.at(in.t)}, in.t, in.z};
}

/// Adds the wrench of act(ends, load).
template <class Act>
void apply(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, WrenchSum& out) {
  WrenchLoad load(out, P.slot, S.slot);
  act(ends(P, S, in), load);
}

template <class Act>
ForceAccount account(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act) {
  const Ends<double> at = ends(P, S, in);
  AccountLoad load(at);
  act(at, load);
  return load;
}

/// Adds K and D of act(ends, load): two passes over the formula for each slot that moves, its pose and its velocity.
template <class Act>
void tangent(const MarkerFrame& P, const MarkerFrame& S, const Inputs& in, const Act& act, TangentSum& out) {
  const MarkerMotion m_P = P.at(in.t), m_S = S.at(in.t);
  for (const bool of_P : {true, false})
    for (const Vary what : {Vary::pose, Vary::velocity}) {
      const int column = of_P ? P.slot : S.slot;
      if (column == kGround) continue;
      const MotionT<SlotJet> O_P = varied(in.slot(P.slot), of_P ? what : Vary::nothing),
                             O_S = varied(in.slot(S.slot), of_P ? Vary::nothing : what);
      const Ends<SlotJet> at{{O_P, m_P}, {O_S, m_S}, in.t, in.z};
      TangentLoad load(at);
      act(at, load);
      for (int i = 0; i < 2; ++i) {
        const int row = i == 0 ? P.slot : S.slot;
        if (what == Vary::pose)
          out.add_K(row, column, load.rows(i));
        else
          out.add_D(row, column, load.rows(i));
      }
    }
}

}  // namespace formula

// Effort: what a motor or an applied load gives between two markers, a force or a torque; all that differs between them.


enum class Effort {
  force,   ///< N, on P's body at the origin of P, the opposite on S's body at the same point; works on its velocity
  torque,  ///< N m, on P's body, the opposite on S's; works on the angular velocity
};

/// "force" or "torque": the key in scenes and the word in messages and channels.
inline const char* word(Effort e) { return e == Effort::force ? "force" : "torque"; }
inline const char* unit(Effort e) { return e == Effort::force ? "N" : "N m"; }

/// Puts the effort f (world axes) between the bodies.
template <class T, class Load>
void exert(Effort e, const Vec3T<T>& f, const Ends<T>& at, Load& load) {
  if (e == Effort::force)
    load.force(f, at.P.x());
  else
    load.torque(f);
}

/// Velocity of the origin of P, m/s, or angular velocity of P, rad/s, as seen from S; world axes.
template <class T>
Vec3T<T> rate_from_s(Effort e, const Ends<T>& at) {
  if (e == Effort::torque) return at.P.w() - at.S.w();
  return at.P.v() - at.S.v() - cross(at.S.w(), Vec3T<T>(at.P.x() - at.S.x()));
}


// Reacting: the facet of a force that depends on the present reactions of links, as friction does.


class Force;

/// A force that has it derives from it and lets Force::reacting() return `this`. What it does goes on top of apply(). The
/// solution is found by iteration: its change with the reactions has to be a contraction, as friction with a coefficient
/// well below one is.
class LOCKSTEP_API Reacting {
 public:
  explicit Reacting(const Force& self) : self_(&self) {}

  /// The links it reads. Known before setup(): these links are not merged into bodies.
  virtual std::vector<const Lock*> reads() const = 0;
  /// What it adds to apply() at these reactions.
  virtual void react(const Inputs&, const Reactions&, WrenchSum&) const = 0;
  virtual double friction_loss(const Inputs&, const Reactions&) const { return 0; }  ///< W taken out by react(), >= 0
  /// K and D of react() with the multipliers fixed; conventions of TangentSum. Default: central differences.
  virtual void react_tangent(const Inputs&, const Reactions&, TangentSum& out) const;
  /// Recorder channels, those that read reactions and those that do not; they stand in for Observable's.
  virtual std::vector<Quantity> quantities() const { return {}; }
  virtual double reacting_quantity(int, const Inputs&, const Reactions&) const { return 0; }

 protected:
  ~Reacting() = default;

 private:
  const Force* self_;
};


// Force: what pushes without holding. It writes into a sum, never into the bodies.


/// Four questions make a force: type(), markers(), setup() and apply(). The others have defaults, or belong to a facet.
class LOCKSTEP_API Force {
 public:
  explicit Force(std::string name);
  virtual ~Force();
  Force(const Force&) = delete;
  Force& operator=(const Force&) = delete;

  const std::string& name() const { return name_; }
  virtual std::string_view type() const = 0;
  /// Who brought its class: "built in", a plugin's name, or "" for a class of the host's own. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }

  // -- description
  virtual std::vector<const Marker*> markers() const = 0;  ///< those it acts at, for messages and checks
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
  /// Which of its laws throws or is not finite at time t, in words; "" when none is. As Driven::diagnose of a link.
  virtual std::string diagnose(double t) const;

  // -- setup: called once the bodies have their slots
  virtual void setup() = 0;

  // -- evaluation
  virtual void apply(const Inputs&, WrenchSum& out) const = 0;
  /// K = -df/d(dx, dth) and D = -df/d(v, w); conventions of TangentSum. Asked by implicit methods only. Default:
  /// central differences of the force's own apply() over the slots of its markers, for forces that bring no formula.
  virtual void tangent(const Inputs&, TangentSum& out) const;
  virtual double potential(const Inputs&) const;    ///< J; asked only while energy is recorded; default 0
  virtual double dissipation(const Inputs&) const;  ///< W taken out by dampers, >= 0; default 0
  /// W put in by laws and motors: what the force gives to the bodies beyond -dV/dt and the dampers; default 0. The
  /// energy balance rests on it.
  virtual double supply(const Inputs&) const;

  // -- facets; null: it has not. A class with the facet derives from it and returns `this`.
  virtual const Observable* observable() const { return nullptr; }    ///< recorder channels of its own
  virtual const Remembering* remembering() const { return nullptr; }  ///< numbers in State::z, such as counted turns
  virtual const Reacting* reacting() const { return nullptr; }        ///< it depends on the reactions of links

  int n_own_memory() const { return remembering() ? remembering()->n_memory() : 0; }
  int first_memory() const { return first_memory_; }
  const std::vector<int>& slots() const { return slots_; }  ///< moving slots of its markers, each once
  void place(int first_memory);                             ///< called by System::setup

 private:
  std::string name_, origin_;
  int first_memory_ = 0;
  std::vector<int> slots_;
};

/// Whether F overrides the accessor of each facet that it derives from: a facet without it would never be found.
template <class F>
constexpr bool force_facets_are_found() {
  const auto found = []<class Facet>(auto accessor, std::type_identity<Facet>) {
    return !std::derived_from<F, Facet> || !std::same_as<decltype(accessor), const Facet* (Force::*)() const>;
  };
  return found(&F::observable, std::type_identity<Observable>{}) &&
         found(&F::remembering, std::type_identity<Remembering>{}) &&
         found(&F::reacting, std::type_identity<Reacting>{});
}

template <class F>
void check_force_facets() {
  if constexpr (std::derived_from<F, Force>)
    static_assert(force_facets_are_found<F>(),
                  "a force that derives from a facet (Observable, Remembering, Reacting) overrides its accessor to "
                  "return this");
}


// MarkerForce: what the forces between markers share: P, perhaps S, their folded frames, and the checks of parameters.


/// A force on one marker, or between two.
class LOCKSTEP_API MarkerForce : public Force {
 public:
  /// Throws ModelError: a marker without a body, or P and S on one body.
  MarkerForce(std::string name, Marker& p, Marker* s);
  ~MarkerForce() override;

  std::vector<const Marker*> markers() const override;
  /// Of the markers' laws and of all laws that were handed to `add_law`.
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;
  /// The same laws.
  std::string diagnose(double t) const override;
  /// Folds the markers into their slots.
  void setup() override;

  const Marker& p() const { return *p_; }
  const Marker* s() const { return s_; }  ///< nullptr: nothing takes the reaction

 protected:
  // All throw ParameterError "force 'name': key is value; must be ...".
  void require(bool ok, const char* key, const std::string& problem) const;
  void require_finite(const char* key, double value) const;
  void require_finite(const char* key, const Vec3& value) const;
  void require_not_negative(const char* key, double value) const;

  /// Throws ModelError when the marker is on a particle, which takes no torque; `does` says what would turn it.
  void require_turning(const Marker& m, const char* does) const;

  void add_law(const LawPtr<MotionLaw>& law);  ///< null is no law
  static double value(const LawPtr<MotionLaw>& law, double t) { return law ? law->at(t).y : 0.0; }

  MarkerFrame P_, S_;  ///< made by setup(); S_ is the ground's origin when there is no S

 private:
  const Marker* p_;
  const Marker* s_;
  std::vector<LawPtr<MotionLaw>> laws_;
};

/// The markers of a site, for makers. Throw SceneError when there is none.
LOCKSTEP_API Marker& p_of(const Site&, const Params&);
LOCKSTEP_API Marker& s_of(const Site&, const Params&);
/// Whether the site has an S.
LOCKSTEP_API bool has_s(const Site&);


// FormulaForce: a force between markers from one formula; see formula.h for how to write it.


/// F derives from FormulaForce<F> and has act(ends, load). Wrench, tangent and energies come from it; of quantities() the
/// first are those that act() shows, and one more, called "power", is what the force gives to its two bodies, W.
template <class F>
class FormulaForce : public MarkerForce, public Observable {
 public:
  using MarkerForce::MarkerForce;

  void apply(const Inputs& in, WrenchSum& out) const override { formula::apply(P_, S_, in, act(), out); }
  void tangent(const Inputs& in, TangentSum& out) const override { formula::tangent(P_, S_, in, act(), out); }
  double potential(const Inputs& in) const override { return account(in).potential; }
  double dissipation(const Inputs& in) const override { return account(in).dissipation; }
  double supply(const Inputs& in) const override { return account(in).supply; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override { return {}; }
  double quantity(int k, const Inputs& in) const override {
    const ForceAccount all = account(in);
    return k < all.n_shown ? all.shown[static_cast<std::size_t>(k)] : all.power;
  }

 private:
  auto act() const {
    return [this](const auto& at, auto& load) { static_cast<const F&>(*this).act(at, load); };
  }
  ForceAccount account(const Inputs& in) const { return formula::account(P_, S_, in, act()); }
};


// FunctionForce: a force that is a function of the user's.


/// Any force as a function of time, motions and states:
///
///   sys.add(function_force("drag", {&tip}, [&tip](const Inputs& in, WrenchSum& out) {
///     const MarkerInWorld M = in_world(MarkerFrame(tip), in);
///     out.force(tip.body->slot, -0.3 * M.v.norm() * M.v, M.x);
///   }));
///
/// The functions may not change anything but `out`, and the same inputs give the same result. `potential` (J) and
/// `dissipation` (W, not negative) enter the energies; left out, they are zero.
class LOCKSTEP_API FunctionForce final : public Force {
 public:
  using Apply = std::function<void(const Inputs&, WrenchSum&)>;
  using Energy = std::function<double(const Inputs&)>;

  /// `markers`: those it acts at, for messages and checks. Throws ModelError: no function, or a marker without a body.
  FunctionForce(std::string name, std::vector<const Marker*> markers, Apply apply, Energy potential = {},
                Energy dissipation = {});

  std::string_view type() const override { return "function_force"; }
  std::vector<const Marker*> markers() const override { return markers_; }
  void breakpoints(double t0, double t1, std::vector<double>& out) const override;  ///< of the markers' laws
  void setup() override {}
  void apply(const Inputs& in, WrenchSum& out) const override { apply_(in, out); }
  double potential(const Inputs& in) const override { return potential_ ? potential_(in) : 0.0; }
  double dissipation(const Inputs& in) const override { return dissipation_ ? dissipation_(in) : 0.0; }

 private:
  std::vector<const Marker*> markers_;
  Apply apply_;
  Energy potential_, dissipation_;
};

LOCKSTEP_API std::unique_ptr<FunctionForce> function_force(std::string name, std::vector<const Marker*> markers,
                                                           FunctionForce::Apply apply,
                                                           FunctionForce::Energy potential = {},
                                                           FunctionForce::Energy dissipation = {});

}  // namespace lockstep
