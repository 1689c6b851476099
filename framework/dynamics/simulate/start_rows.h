// SPDX-License-Identifier: BSD-3-Clause
// What a start has to meet, linear at one state after another: rows of links, coordinates, poses. Internal to assembly.
#pragma once

#include <limits>
#include <string>
#include <vector>

#include <lockstep/assembly.h>
#include <lockstep/detail/kernel.h>
#include <lockstep/dynamics.h>

namespace lockstep {

/// One coordinate of a link: of P relative to S, along or about an axis of S.
struct CoordinateRow {
  double value = 0;  ///< m; or rad, in [-pi, pi]: the turn about that axis as TurnAngle has it
  double rate = 0;   ///< of P against S along or about the axis, m/s or rad/s
  VecX of_rate;      ///< derivative of the rate by the velocities, 6 a slot
  VecX of_value;     ///< derivative of the value by displacements and turns, 6 a slot
};
LOCKSTEP_API CoordinateRow coordinate_row(Dynamics&, const State&, const Lock& link, Axis axis);
/// The link of that name. Throws ModelError, naming the axis, if it has no pair of markers.
const Lock& paired_link(const System&, const std::string& name, Axis axis);

/// A value that a start asks for, by a drive or a coordinate (AssemblyOptions).
struct StartTarget {
  const Lock* link;
  Axis axis;
  double asked;                                             ///< m or rad
  double weight = std::numeric_limits<double>::infinity();  ///< infinite: exact
  int drive = -1;                                           ///< number of the drive in its link; -1: a coordinate
  double near = 0;                                          ///< the same, on the branch nearest to the poses given
  double now = 0;                                           ///< the value with its revolutions, m or rad
  double led = 0;                                           ///< the value for the present, m or rad

  bool turns() const { return is_rotation(axis); }
  bool exact() const { return std::isinf(weight); }
  std::string name() const;  ///< "A.rz"
  std::string who() const;   ///< "drive A.rz", "start by A.rz"
  /// Value at this state, on the branch nearest to `about`.
  double value(Dynamics&, const State&, double about) const;
};

/// Drives of places and angles in force, then coordinates. Throws ModelError for a coordinate without a meaning.
std::vector<StartTarget> targets_of(const System&, const State&, const AssemblyOptions&);
/// The branch of an angle nearest to another, rad.
double nearest_branch(double angle, double about);
inline double degrees(double angle) { return angle * 180 / kPi; }

/// Rows c(x) = 0.
class StartRows {
 public:
  virtual ~StartRows() = default;
  /// Linearises at this state. Returns how far off it is, m.
  virtual double look(const State&) = 0;
  /// The least step that solves the linear rows in the sense of least squares: 6 a slot, m (world) and rad (slot axes).
  virtual VecX step() = 0;
};

/// All rows of links in force, of any number of bodies; least by the masses.
class LinkRows final : public StartRows {
 public:
  explicit LinkRows(Dynamics& dynamics) : dynamics_(dynamics) {}
  double look(const State&) override;
  VecX step() override;
  const Evaluation& evaluation() const { return *now_; }
  const VecX& residuals() const { return C_; }

 private:
  Dynamics& dynamics_;
  const Evaluation* now_ = nullptr;
  VecX C_, Cd_;
};

/// Rows of links, poses and coordinates by weights; the targets of drives replace the drives' rows. Rotations count as
/// displacements at L = System::length(). Solved densely.
class TargetRows final : public StartRows {
 public:
  static constexpr int kMostUnknowns = 1500;  // a dense decomposition of them takes a second

  /// `given`: the poses that count. Throws ModelError for a weight without a meaning.
  TargetRows(Dynamics&, const State& given, const AssemblyOptions&, std::vector<StartTarget>& targets);
  double look(const State&) override;
  VecX step() override;
  /// Which targets are met exactly: none counts at all, those of infinite weight, or all.
  enum class Held : unsigned char { none, exact, all };
  void hold(Held held) { held_ = held; }
  /// Of the state looked at, over all that is not exact: sum of w d^2.
  double cost() const { return r_.squaredNorm(); }
  /// The step along what is exact to where the linear cost is least; empty if nothing is free.
  VecX downhill() const;
  /// What is asked for exactly and not met, in words.
  std::string missed(int rounds) const;

 private:
  void take_links(const Evaluation&);
  void take_poses(const State&);
  void take_targets(const State&);
  void add(const VecX& row, double off, double weight);
  bool is_led(const Lock&, int drive) const;
  VecX to_slots(const VecX& d) const { return scale_.cwiseProduct(d); }

  Dynamics& dynamics_;
  const System& system_;
  State given_;
  const AssemblyOptions& options_;
  std::vector<StartTarget>& targets_;
  Held held_ = Held::exact;
  int n_;
  double length_;
  VecX weights_;  // of the slots' poses
  VecX scale_;    // of the unknowns, which are lengths; 0: not free
  MatX E_, S_;    // of what is exact, and of what is asked for by weights
  VecX c_, r_;    // what is left of them
  Eigen::Index exact_ = 0, soft_ = 0;
  double links_ = 0, off_ = 0;  // m
  std::string worst_;
};

}  // namespace lockstep
