// SPDX-License-Identifier: BSD-3-Clause
// CountedAngle: an angle with its whole revolutions, as a state.
#pragma once

#include <cmath>
#include <memory>
#include <optional>
#include <span>
#include <string>
#include <utility>

#include <lockstep/detail/markers.h>
#include <lockstep/math.h>
#include <lockstep/state.h>

namespace lockstep {

/// An angle with its whole revolutions, as counted by a screw, a gear, a torsion spring, a stop or a column (theory,
/// (7.9)). A class defines the angle of a pose and its rate; all users of the same angle share one.
///
///     theta = phi + 2 pi n
///
/// Three numbers of State::s: phi, rad, within half a revolution at accepted steps; n, a whole number; and the largest
/// difference of the integrated phi from that of a pose, rad. phi is integrated with the motion and does not control
/// the step. Each accepted step replaces it by the pose's angle and moves whole revolutions from it to n. At the start
/// n = 0, unless a start or a drive requests another revolution (assemble()).
class LOCKSTEP_API CountedAngle {
 public:
  static constexpr int kStates = 3;               ///< how many numbers of State::s it has
  static constexpr double kInDoubt = kTwoPi / 4;  ///< rad; see doubt()

  /// All users of an angle of this name share one.
  explicit CountedAngle(std::string name) : name_(std::move(name)) {}
  virtual ~CountedAngle();
  CountedAngle(const CountedAngle&) = delete;
  CountedAngle& operator=(const CountedAngle&) = delete;

  const std::string& name() const { return name_; }  ///< as given
  int first() const { return first_; }               ///< where its numbers begin in State::s
  int number() const { return number_; }             ///< among those of its system
  /// Called by System::count and System::setup.
  void place(int number, int first) { number_ = number, first_ = first; }
  /// Whether active constraints depend on it: assembly then follows it from the poses given (assemble()).
  bool coupled() const { return coupled_; }
  void couple() { coupled_ = true; }  ///< declares that they do

  /// phi + 2 pi n, rad, as integrated: within half a revolution of value() if the step is short enough.
  double expected(std::span<const double> s) const { return at(s, 0) + kTwoPi * at(s, 1); }
  /// n; inside a step, where n may lie between two whole numbers, the nearest.
  double turns(std::span<const double> s) const { return std::round(at(s, 1)); }
  /// expected() less whole revolutions, rad.
  double rest(std::span<const double> s) const { return at(s, 0) + kTwoPi * (at(s, 1) - turns(s)); }
  /// The angle of the pose, rad, without whole revolutions.
  double of_pose(const Inputs&) const;
  /// The angle of the pose, rad, on the branch nearest to expected().
  double value(const Inputs&) const;
  /// Rate of the angle, rad/s; 0 if it has no value.
  double rate(const Inputs&) const;
  /// The largest difference of the integrated angle from that of a pose so far, rad. From kInDoubt on the count is in doubt:
  /// the motion came near a pose in which the angle has no value, or a step was far too long.
  double doubt(std::span<const double> s) const { return at(s, 2); }

  /// The rotation of a slot against another about an axis of the other; the whole angle if it is the only one.
  struct Turn {
    int slot,   ///< that rotates
        other;  ///< against which it rotates
    Vec3 axis;  ///< axes of the other slot, unit
  };
  /// That rotation; none if laws rotate a frame.
  virtual std::optional<Turn> turn() const { return {}; }

  /// Takes frames into their slots; called by System::setup.
  virtual void setup() = 0;
  /// Corrects its numbers in State::s at an accepted state.
  void accept(const Inputs&, VecX& s) const;
  /// Has the angle be the one of the pose on the branch nearest to `about`, rad: if poses come from no motion.
  void set(const Inputs&, double about, VecX& s) const;

 protected:
  virtual double angle(const Inputs&) const = 0;         ///< of a pose, on any branch, rad
  virtual double rate_of_pose(const Inputs&) const = 0;  ///< its rate, rad/s; 0 if it has no value

 private:
  double at(std::span<const double> s, int k) const { return s[static_cast<std::size_t>(first() + k)]; }

  std::string name_;
  int first_ = 0, number_ = 0;
  bool coupled_ = false;
};

/// The rotation of P about an axis of S.
///
///     theta = 2 atan2(ek, e0),  theta' = ( e0^2 wk + e0 (w x ev)k + ek w.ev ) / (e0^2 + ek^2),  e = q_S' q_2' q_1 q_P
///
/// w: angular velocity of P against S, S axes. It has no value if z_P = -z_S (of axis z).
class LOCKSTEP_API TurnAngle final : public CountedAngle {
 public:
  /// `axis`: 0, 1, 2 for x, y, z of S. The markers must outlive it.
  TurnAngle(const Marker& p, const Marker& s, int axis);
  /// The name of that angle.
  static std::string name_of(const Marker& p, const Marker& s, int axis);
  void setup() override;
  std::optional<Turn> turn() const override;

 protected:
  double angle(const Inputs&) const override;
  double rate_of_pose(const Inputs&) const override;

 private:
  Quat relative(const Inputs&) const;
  const Marker &p_, &s_;
  int axis_;
  MarkerFrame P_, S_;
};

/// The owner of the counted angles: a system.
class LOCKSTEP_API AngleCounter {
 public:
  /// The angle of that name, which stays valid; added if it does not exist yet.
  virtual CountedAngle& count(std::unique_ptr<CountedAngle>) = 0;
  /// The rotation of p about an axis (0, 1, 2) of s. `coupled`: CountedAngle::coupled.
  const CountedAngle& count(const Marker& p, const Marker& s, int axis, bool coupled = false);

 protected:
  ~AngleCounter() = default;
};

}  // namespace lockstep
