// Facets: what a link may have beside its rows. Lock has an accessor for each that returns null; a class with the facet
// derives from it and lets the accessor return `this`:
//
//   class Thread : public Lock, public Observable {
//    public:
//     const Observable* observable() const override { return this; }
//     ...
#pragma once

#include <span>
#include <string>
#include <vector>

#include "framework/foundation/support/export.h"
#include "framework/mechanism/lock/mask.h"
#include "framework/mechanism/model/inputs.h"
#include "framework/mechanism/model/motion_law.h"
#include "framework/mechanism/rows/rows.h"
#include "framework/mechanism/rows/tangent.h"

namespace lockstep {

class Lock;
/// Links of one type and one pattern, gathered by one call.
using Group = std::span<const Lock* const>;

/// A number that a link or a force reports beyond what every one has: name and unit of a recorder channel.
struct Quantity {
  std::string name, unit;
};

/// A link with laws of time: of its drives, of its rows, of its markers.
class LOCKSTEP_API Driven {
 public:
  /// Drives, each with exactly one row: LinkRow::drive.
  virtual int n_drives() const { return 0; }
  virtual Quantity drive(int) const { return {}; }  ///< name ("rz") and unit (rad, m) of drive d
  /// Instants in (t0, t1) where one of its laws jumps.
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const = 0;
  /// Which of its laws is not finite at time t, in words; "" when none is (then the link itself made the NaN).
  virtual std::string diagnose(double t) const = 0;

 protected:
  ~Driven() = default;
};

/// A link of one pair of markers that holds coordinates by a mask and takes laws on held and on free ones. Laws are
/// given before the system is set up.
class LOCKSTEP_API Jointed {
 public:
  virtual Mask mask() const = 0;    ///< the joint's own rows
  virtual Mask rows() const = 0;    ///< with the drives'
  virtual bool turned() const = 0;  ///< whether turn() imposed a law
  virtual void move(LawPtr<TranslationLaw> law) = 0;
  virtual void turn(LawPtr<RotationLaw> law) = 0;
  virtual void drive(Axis axis, LawPtr<MotionLaw> law) = 0;
  virtual void drive_speed(Axis axis, LawPtr<MotionLaw> law) = 0;

 protected:
  ~Jointed() = default;
};

/// A link that integrates states of its own: numbers in State::s, from Lock::first_state().
class LOCKSTEP_API Stateful {
 public:
  virtual int n_states() const = 0;
  virtual void start_states(std::span<double> s) const = 0;
  virtual void state_rates(const Inputs&, std::span<double> sd) const = 0;
  /// Its states when it comes into force in this pose (an event): a driven speed begins where the mechanism is.
  virtual void engage(const Inputs&, std::span<double>) const {}

 protected:
  ~Stateful() = default;
};

/// A link that remembers: numbers in State::z, from Lock::first_memory(), constant during a step.
class LOCKSTEP_API Remembering {
 public:
  virtual int n_memory() const = 0;
  virtual void start_memory(std::span<double> z) const = 0;
  virtual void accept_step(const Inputs&, std::span<double> z) const = 0;  ///< updates them after an accepted step

 protected:
  ~Remembering() = default;
};

/// A link that gathers its rows in the plane of a planar mechanism itself. Without it, or where it declines, they are
/// taken from gather().
class LOCKSTEP_API Planar {
 public:
  virtual bool setup_plane(Plane) = 0;                                   ///< after setup(); false: it declines
  virtual RowLayout planar_layout() const { return RowLayout::planar; }  ///< or pair
  /// As Lock::gather, for the rows that lie in the plane, in their order.
  virtual void gather_plane(Group, const Inputs&, RowSpan) const = 0;

 protected:
  ~Planar() = default;
};

/// A link that has a formula for its geometric stiffness. Without it, implicit methods take central differences
/// (difference_tangent).
class LOCKSTEP_API TangentFormula {
 public:
  /// K = d(Jh^T lambda)/d(dx, dth) with lambda (one per row of this link) and time fixed; conventions of TangentSum.
  virtual void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const = 0;

 protected:
  ~TangentFormula() = default;
};

/// A link with recorder channels of its own.
class LOCKSTEP_API Observable {
 public:
  virtual std::vector<Quantity> quantities() const = 0;
  virtual double quantity(int k, const Inputs&) const = 0;

 protected:
  ~Observable() = default;
};

}  // namespace lockstep
