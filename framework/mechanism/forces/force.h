// Force: what pushes without holding. It writes into a sum, never into the bodies.
#pragma once

#include <concepts>
#include <span>
#include <string>
#include <string_view>
#include <type_traits>
#include <vector>

#include "framework/foundation/support/export.h"
#include "framework/mechanism/forces/reacting.h"
#include "framework/mechanism/lock/facets.h"
#include "framework/mechanism/rows/sums.h"
#include "framework/mechanism/rows/tangent.h"

namespace lockstep {

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

}  // namespace lockstep
