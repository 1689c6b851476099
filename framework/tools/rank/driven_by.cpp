// SPDX-License-Identifier: BSD-3-Clause
// Whether laws alone determine the motion: which coordinates to drive, which drives to release.
#include <lockstep/kinematics.h>

#include <spdlog/fmt/fmt.h>

#include <algorithm>

#include <lockstep/analysis.h>
#include <lockstep/author/lock.h>
#include <lockstep/text.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/simulate/start_rows.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/rank/loop_rows.h"
#include "framework/tools/rank/motion_words.h"

namespace lockstep {
namespace {

/// A coordinate of a joint that its mask leaves free.
struct FreeCoordinate {
  const Lock* link;
  Axis axis;
  std::string name() const { return link->name() + "." + std::string(to_string(axis)); }
  /// Of the body that it belongs to most: P's, or S's if P is fixed.
  int slot() const {
    const auto [p, s] = link->pairs().front();
    return p->body->slot != kGround ? p->body->slot : s->body->slot;
  }
};

std::vector<FreeCoordinate> free_coordinates(const System& system, const State& state) {
  std::vector<FreeCoordinate> all;
  for (const auto& link : system.links()) {
    const Jointed* joint = link->jointed();
    if (joint == nullptr || !state.modes[link->number()]) continue;
    for (const Axis axis : {Axis::x, Axis::y, Axis::z, Axis::rx, Axis::ry, Axis::rz})
      if (!overlaps(joint->rows(), row_of(axis))) all.push_back({link.get(), axis});
  }
  return all;
}

/// Rates of these coordinates in each free motion; rotations as lengths.
MatX rates_in(const std::vector<FreeCoordinate>& coordinates, Dynamics& dynamics, const State& state,
              const Unknowns& unknowns, const MatX& motions) {
  MatX out(static_cast<Eigen::Index>(coordinates.size()), motions.cols());
  for (Eigen::Index i = 0; i < out.rows(); ++i) {
    const FreeCoordinate& c = coordinates[i];
    const double unit = is_rotation(c.axis) ? dynamics.system().length() : 1.0;
    const VecX rate = coordinate_row(dynamics, state, *c.link, c.axis).of_rate;
    out.row(i) = unit * unknowns.forces_in(rate).transpose() * motions;
  }
  return out;
}

}  // namespace

std::string DriveReport::text() const {
  std::string text;
  if (freedoms > 0) {
    text = fmt::format("{} free motion{} not driven", freedoms, freedoms == 1 ? " is" : "s are");
    for (std::size_t i = 0; i < std::min<std::size_t>(free.size(), 4); ++i) text += (i > 0 ? "; " : ": ") + free[i];
    if (free.size() > 4) text += "; ...";
    text += to_drive.empty() ? ". Constrain or drive them" : ". Drive " + text::join(to_drive) + ", for example";
  }
  for (const std::vector<std::string>& set : too_many)
    text +=
        (text.empty() ? "" : ". ") +
        (set.size() > 1 ? "the drives " + text::join(set) + " prescribe the same degree of freedom: remove one of them"
                        : "the joints already determine what drive " + set.front() + " prescribes: remove it");
  return text;
}

DriveReport driven_by(Dynamics& dynamics, const State& state) {
  const System& system = dynamics.system();
  DriveReport report;
  report.freedoms = mobility(dynamics, state).freedoms;
  const Evaluation& e = dynamics.gather_rows(state);
  for (const std::vector<int>& entries : loops_of(system, e.rows())) {
    const LoopRows loop(system, e.rows(), entries);
    for (const DependentRows& set : Dependencies(loop.Jt).sets) {
      std::vector<std::string> drives;
      for (const int row : set.rows)
        if (std::string drive = NamedRow(system, e.rows(), loop.numbers[row]).drive(); !drive.empty())
          drives.push_back(std::move(drive));
      if (set.too_many > 0 && !drives.empty()) report.too_many.push_back(std::move(drives));
    }
  }
  if (report.freedoms == 0 || system.n_velocities() > kDenseUnknowns) return report;

  const Unknowns unknowns(system);
  const MatX N = free_motions(e);
  const std::vector<FreeCoordinate> coordinates = free_coordinates(system, state);
  const MatX rates = rates_in(coordinates, dynamics, state, unknowns, N);
  // The first coordinates that are independent, in the order of the links; by each of them alone the mechanism moves.
  // Those that no motion changes are locked.
  MatX chosen(0, N.cols());
  std::vector<int> leaders;
  for (std::size_t i = 0; i < coordinates.size() && chosen.rows() < N.cols(); ++i) {
    if (!(rates.row(static_cast<Eigen::Index>(i)).norm() > kSlight)) continue;
    MatX more(chosen.rows() + 1, N.cols());
    more << chosen, rates.row(static_cast<Eigen::Index>(i));
    if (const PivotedQr qr(more.transpose()); qr.rank(kSlight * qr.pivot(0)) < more.rows()) continue;
    chosen = more;
    report.to_drive.push_back(coordinates[i].name());
    leaders.push_back(coordinates[i].slot());
  }
  MatX motions = N;
  PivotedLu lu;
  if (chosen.rows() == N.cols() && lu.compute(chosen.transpose()))  // which it is, by its rank
    for (auto row : motions.rowwise()) row = lu.solution(row.transpose()).transpose();
  const Inputs& in = dynamics.inputs(state);
  for (Eigen::Index k = 0; k < motions.cols(); ++k) {
    const VecX motion = unknowns.motion_of(motions.col(k));
    const int leader = chosen.rows() == N.cols() ? leaders[k] : kGround;
    report.free.push_back(leader == kGround ? motion_words(system, in, motion)
                                            : led_motion_words(system, in, motion, leader));
  }
  return report;
}

}  // namespace lockstep
