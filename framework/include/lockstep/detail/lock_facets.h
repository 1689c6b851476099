// SPDX-License-Identifier: BSD-3-Clause
// Facets of joints: optional interfaces in addition to the rows.
#pragma once

#include <concepts>
#include <span>
#include <string>
#include <vector>

#include <lockstep/author/law.h>
#include <lockstep/author/mask.h>
#include <lockstep/body.h>
#include <lockstep/detail/markers.h>
#include <lockstep/detail/rows.h>
#include <lockstep/state.h>

namespace lockstep {

// Facets: optional interfaces of a joint in addition to its rows. Lock has an accessor for each, which returns null; a
// class with the facet derives from it and overrides the accessor to return `this`:
//
//   class Thread : public Lock, public Observable {
//    public:
//     const Observable* observable() const override { return this; }
//     ...

class Lock;
/// Joints of one type, pattern, row count and slot count, gathered by one call.
using Group = std::span<const Lock* const>;

/// A number that a joint or a force reports: a channel of the recorder, or the coordinate of a drive.
struct Quantity {
  std::string name,  ///< last word of the channel: "angle", "rz"
      unit;          ///< "m", "rad/s"; "" for none
  std::string help{};  ///< what it is and its positive sense, for lists of channels
};

/// Facet of a joint with laws of time: of its drives, of its rows, of its markers.
class LOCKSTEP_API Driven {
 public:
  /// Number of drives, each of which has exactly one row: LinkRow::drive.
  virtual int n_drives() const { return 0; }
  /// The coordinate that drive d moves: name ("rz") and unit ("rad", "m").
  virtual Quantity drive(int) const { return {}; }
  /// Appends the times in (t0, t1) when one of its laws jumps.
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const = 0;
  /// Which of its laws throws or is not finite at time t, in words; "" when none does.
  virtual std::string diagnose(double t) const = 0;

 protected:
  ~Driven() = default;
};

/// A drive: a law on a coordinate that the mask leaves free. It adds exactly one row.
struct Drive {
  Axis axis = Axis::rz;   ///< the coordinate
  LawPtr<MotionLaw> law;  ///< its value, m or rad, or its speed, m/s or rad/s
  bool speed = false;     ///< whether the law is the speed; the coordinate is then integrated in State::s
  int state = 0;          ///< of a speed: which of the joint's states
};

/// Whether a motion along or about this axis stays in the plane with this normal, of length 1; both in S axes.
LOCKSTEP_API bool axis_stays_in_plane(Axis axis, const Vec3& normal);

/// The laws of a lock: the pose of P imposed on the rows of the mask, and its drives.
struct LOCKSTEP_API ImposedMotion {
  LawPtr<TranslationLaw> move{};  ///< p(t), or null
  LawPtr<RotationLaw> turn{};     ///< q_D(t), or null
  std::vector<Drive> drives{};    ///< on free axes
  bool hold = false;              ///< P keeps its pose against S at closing, which is in the joint's states

  bool empty() const { return !move && !turn && drives.empty() && !hold; }  ///< whether there is none
  /// Whether all of them declare that they stay in the plane with this normal, of length 1, S axes.
  bool stays_in_plane(const Vec3& normal) const;
  /// p and its rates: by `move` and the drives along axes. `s`: the integrated states of the joint.
  ImposedTranslation translation(double t, std::span<const double> s) const;
  /// q_D and its rates: by `turn` and the drive about an axis.
  ImposedRotation rotation(double t, std::span<const double> s) const;
};

/// Facet of a joint of one pair of markers that holds coordinates by a mask and takes laws on held and on free ones.
/// Laws are given before the system is set up: `move`, `turn`, `drive` and `drive_speed` throw ModelError afterwards.
class LOCKSTEP_API Jointed {
 public:
  virtual Mask mask() const = 0;    ///< rows of the joint itself
  virtual Mask rows() const = 0;    ///< the same with those of the drives
  virtual bool turned() const = 0;  ///< whether `turn()` imposed a law
  /// After setup: whether laws act on it: imposed ones, drives, or those of its markers.
  virtual bool has_laws() const = 0;
  virtual const ImposedMotion& imposed() const = 0;  ///< the laws of the lock itself
  /// Imposes p(t), S axes, m: the position of P on the rows x y z. Throws ModelError: the mask has none of them.
  virtual void move(LawPtr<TranslationLaw> law) = 0;
  /// Imposes q_D(t): the orientation of P relative to S. Throws ModelError: the mask has none of e1 e2 e3.
  virtual void turn(LawPtr<RotationLaw> law) = 0;
  /// Adds a row that moves a free coordinate by a law, m or rad. Throws ModelError: the mask holds the axis, or it is
  /// driven already; no law; a rotation while the other two rotations are not both held, which has no fixed axis.
  virtual void drive(Axis axis, LawPtr<MotionLaw> law) = 0;
  /// The same with a law of the speed, m/s or rad/s. The coordinate begins at its value at the start and is integrated.
  virtual void drive_speed(Axis axis, LawPtr<MotionLaw> law) = 0;
  /// Locks the present pose: each time an event activates the joint, P keeps its pose against S at that time on the
  /// rows of the mask. A joint that is active at the start holds the pose of its bodies' homes. It takes no other laws;
  /// setup throws ModelError if it has some.
  virtual void hold() = 0;

 protected:
  ~Jointed() = default;
};

/// Facet of a joint with integrated states: numbers in State::s, from Lock::first_state() on.
class LOCKSTEP_API Stateful {
 public:
  virtual int n_states() const = 0;                                         ///< number of states
  virtual void start_states(std::span<double> s) const = 0;                 ///< writes them at the start
  virtual void state_rates(const Inputs&, std::span<double> sd) const = 0;  ///< writes d/dt of them
  /// Writes them when an event activates the joint: a driven coordinate continues from its present value. Default:
  /// leaves them.
  virtual void engage(const Inputs&, std::span<double>) const {}

 protected:
  ~Stateful() = default;
};

/// Facet of a joint or force with a memory: numbers in State::z, from first_memory() on, constant during a step. Such a
/// joint keeps a mechanism out of joint coordinates, whose steps are too long for a memory.
class LOCKSTEP_API Remembering {
 public:
  virtual int n_memory() const = 0;                                        ///< length of the memory
  virtual void start_memory(std::span<double> z) const = 0;                ///< writes it at the start
  virtual void accept_step(const Inputs&, std::span<double> z) const = 0;  ///< updates it after an accepted step

 protected:
  ~Remembering() = default;
};

/// Facet of a joint that can gather its rows in the plane of a planar mechanism. All other joints take them from
/// gather().
class LOCKSTEP_API Planar {
 public:
  /// Prepares for this plane; called after setup(). False: the joint declines, and gather() is used. Throws ModelError:
  /// the joint cannot be in this plane.
  virtual bool setup_plane(Plane) = 0;
  virtual RowLayout planar_layout() const { return RowLayout::planar; }  ///< planar or pair
  /// As Lock::gather, for the rows in the plane, in their order.
  virtual void gather_plane(Group, const Inputs&, RowSpan) const = 0;

 protected:
  ~Planar() = default;
};

/// Facet of a joint with a formula for its geometric stiffness. For all other joints implicit methods take central
/// differences (difference_tangent).
class LOCKSTEP_API TangentFormula {
 public:
  /// Adds K = d(Jh^T lambda)/d(dx, dth), lambda (one per row of this joint) and time fixed; conventions of TangentSum.
  virtual void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const = 0;

 protected:
  ~TangentFormula() = default;
};

/// Facet of a joint or force with additional recorder channels.
class LOCKSTEP_API Observable {
 public:
  virtual std::vector<Quantity> quantities() const = 0;     ///< name and unit of each channel
  virtual double quantity(int k, const Inputs&) const = 0;  ///< present value of quantities()[k], in its unit

 protected:
  ~Observable() = default;
};

/// A function of an object that returns its facet.
template <class Facet, class Owner>
using Accessor = const Facet* (Owner::*)() const;
/// Whether T overrides the accessor of each of these facets that it derives from: without it the facet would never be
/// found. Root: the class that declares the accessors.
template <class T, class Root, class... Facet, class... Owner>
constexpr bool facets_are_found(Accessor<Facet, Owner>...) {
  return !((std::derived_from<T, Facet> && std::same_as<Owner, Root>) || ...);
}

}  // namespace lockstep
