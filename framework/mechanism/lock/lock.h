// Lock: the root of all links. A link is what the user touches; a lock is the constraint it is made of.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "framework/mechanism/rows/rows.h"
#include "framework/mechanism/rows/tangent.h"
#include "framework/mechanism/model/inputs.h"
#include "framework/mechanism/model/marker.h"
#include "framework/foundation/support/export.h"

namespace lockstep {

class Lock;
/// Links of one type and one pattern, gathered by one call.
using Group = std::span<const Lock* const>;

/// A number that a link or a force can tell about itself beyond what every link has: name and unit of a recorder
/// channel.
struct Quantity {
  std::string name, unit;
};

/// A link with one row that may push and cannot pull: C >= 0 in place of C = 0. It is out of force until C falls to
/// zero; then the simulation gives the impact, and where that leaves no speed worth an impact, the link holds until it
/// would have to pull.
struct OneSided {
  double restitution = 0;    ///< speed of C after an impact to that before it, 0 to 1
  double rest_speed = 1e-3;  ///< impacts that leave less end at rest, m/s (rad/s)
  bool below = false;        ///< C <= 0 is free in place of C >= 0 (a rope: the distance may be less than its length)
  double sign() const { return below ? -1.0 : 1.0; }
};

class LOCKSTEP_API Lock {
 public:
  explicit Lock(std::string name);
  virtual ~Lock();
  Lock(const Lock&) = delete;
  Lock& operator=(const Lock&) = delete;

  const std::string& name() const { return name_; }
  virtual std::string_view type() const = 0;  ///< "revolute": the name in files, logs and errors
  /// Who brought its class: "built in", a plugin's name, or "" for a class of the host's own. Set by the registry.
  const std::string& origin() const { return origin_; }
  void set_origin(std::string origin) { origin_ = std::move(origin); }

  // -- description
  /// Marker pairs, P before S; the first is the one whose P carries the reaction in the recorder.
  virtual std::vector<std::pair<const Marker*, const Marker*>> pairs() const = 0;
  virtual int row_count() const = 0;  ///< rows while the link is active; constant between two setups
  virtual RowKind row_kind(int k) const = 0;
  virtual std::string row_name(int k) const = 0;  ///< "x", "e1", "phi": for messages and channels
  virtual int drive_row(int k) const;             ///< number of the drive that row k belongs to; -1: the joint itself
  virtual int n_drives() const;
  virtual Quantity drive(int d) const;  ///< name ("rz") and unit (rad, m) of drive d
  /// Instants in (t0, t1) where one of its laws jumps.
  virtual void breakpoints(double t0, double t1, std::vector<double>& out) const;
  /// Which of its laws is not finite at time t, in words; "" when none is (then the link itself made the NaN).
  virtual std::string blame(double t) const;
  virtual std::vector<Quantity> quantities() const;
  virtual double quantity(int k, const Inputs&) const;

  /// Whether it holds its two bodies to each other for ever, nothing moving: then they may be merged into one slot.
  virtual bool bolts() const { return false; }

  // -- setup: called once the bodies have their slots
  virtual void setup() = 0;            ///< folds markers into slots; throws ModelError naming the link
  virtual SlotList slots() const = 0;  ///< whose columns its rows touch
  /// Links with equal dynamic type, pattern, row count and slot count make a group. `pattern` packs whatever a kernel
  /// is chosen by: mask, laws present, parallel markers, grounded sides.
  virtual unsigned pattern() const { return 0; }
  /// How its jacobians are kept (mechanism/rows/rows.h), and for a triple the sign of its first slot: +1 where that is P's body.
  virtual RowLayout layout() const { return RowLayout::dense; }
  virtual double row_sign() const { return 1; }
  /// For a planar mechanism, after setup(): whether the link gathers its rows in the plane itself, by gather_plane; if
  /// not, they are taken from gather(). Then how they are kept: planar, or pair.
  virtual bool setup_plane(Plane) { return false; }
  virtual RowLayout planar_layout() const { return RowLayout::planar; }

  // -- evaluation
  /// Rows of all links of one group at the same inputs: C, Ct, Qhat and the jacobians; every number is written.
  virtual void gather(Group, const Inputs&, RowSpan out) const = 0;
  /// The same for the rows that lie in the plane, in their order, if setup_plane() said so.
  virtual void gather_plane(Group, const Inputs&, RowSpan) const {}
  /// K = d(Jh^T lambda)/d(dx, dth) with lambda (one a row of this link) and time fixed; conventions of TangentSum.
  /// Asked by implicit methods only. Default: central differences of the link's own gather(), good to some 1e-9 of K,
  /// for links that bring no formula; moves of 6e-6 of the distance between its bodies, turns of 6e-6 rad.
  virtual void tangent(const Inputs&, std::span<const double> lambda, TangentSum& out) const;

  // -- what the link integrates or remembers
  virtual int n_states() const { return 0; }  ///< in State::s, from first_state()
  virtual void start_states(std::span<double> s) const;
  virtual void state_rates(const Inputs&, std::span<double> sd) const;
  /// Its states when it comes into force in this pose (an event): a driven speed begins where the mechanism is.
  virtual void engage(const Inputs&, std::span<double> s) const;
  virtual int n_memory() const { return 0; }  ///< in State::z, from first_memory()
  virtual void start_memory(std::span<double> z) const;
  virtual void accept(const Inputs&, std::span<double> z) const;  ///< after an accepted step

  int number() const { return number_; }  ///< in the system; index of its bit in State::modes
  int first_state() const { return first_state_; }
  int first_memory() const { return first_memory_; }
  /// Of a one-sided link: one more number in State::z, kept by the simulation: J lost in its impacts.
  int impact_memory() const { return first_memory_ + n_memory(); }
  void place(int number, int first_state, int first_memory);  ///< called by System::setup

  bool active_at_start = true;
  std::optional<OneSided> one_sided;  ///< set it before the system's setup; asks for exactly one row

 private:
  std::string name_, origin_;
  int number_ = -1, first_state_ = 0, first_memory_ = 0;
};

}  // namespace lockstep
