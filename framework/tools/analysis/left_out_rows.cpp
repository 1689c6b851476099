#include "framework/tools/analysis/left_out_rows.h"

#include <algorithm>
#include <cmath>

#include <Eigen/Cholesky>

#include <lockstep/error.h>

namespace lockstep {
namespace {

constexpr double kStep = 0.05;    // rad
constexpr int kSteps = 6;         // along what the rows held
constexpr double kMoves = 1e-11;  // of a response: a row with less holds nothing that others do not hold

/// C of a row, in lengths.
double violation_of(const OwnRow& row, const Inputs& in, RowTable& room) {
  const RowShape shape = row.link->shape();
  const Lock* const link = row.link;
  link->gather(Group(&link, 1), in, room.spatial_span(shape));
  return std::abs(room.spatial(shape).C(row.own)) / row.length;
}

VecX momentum_of(const System& system, const VecX& v) {
  VecX out = v;
  for (int k = 0; k < system.n_slots(); ++k) {
    const Slot& s = system.slot(k);
    out.segment<3>(6 * k) = s.mass * v.segment<3>(6 * k);
    out.segment<3>(6 * k + 3) = s.J * v.segment<3>(6 * k + 3);
  }
  return out;
}

}  // namespace

bool are_few_rows(const System& system, const std::vector<bool>& modes) {
  constexpr int kFewRows = 300;
  RowTable table;
  system.lay_out(modes, table, true);
  return table.n_rows <= kFewRows;
}

void leave_out(System& system, const std::vector<OwnRow>& rows) {
  system.setup();
  for (const OwnRow& row : rows) system.leave_out(*row.link, system.left_out(*row.link) | 1U << row.own);
}

void take_back(System& system) {
  system.setup();
  for (const auto& link : system.links())
    if (system.left_out(*link) != 0) system.leave_out(*link, 0);
  if (system.held_down_to() > 0) system.hold_down_to(0);
  system.setup();
}

double LeftOutTrial::along(const OwnRow& row, const std::vector<OwnRow>& rows) {
  State at = start_;
  RowTable room;
  double most = 0;
  VecX way = allowed(at, row.J);
  if (size_of(way) <= kMoves * size_of(response_)) return 0;
  for (int k = 0; k < kSteps; ++k) {
    try {
      dynamics_.advance(at, kStep, way / size_of(way));
      dynamics_.project(at);
      const Inputs& in = dynamics_.gather_rows(at).inputs();
      for (const OwnRow& r : rows) most = std::max(most, violation_of(r, in, room));
      way = allowed(at, momentum_of(system_, way));
    } catch (const Error&) {
      return k > 1 ? most : HUGE_VAL;  // it comes to an end of its way
    }
    if (!(size_of(way) > 0)) return most;
  }
  return most;
}

// What a force moves, as the rows allow.
VecX LeftOutTrial::allowed(const State& state, const VecX& force) {
  const Evaluation& e = dynamics_.gather_rows(state);
  Factor& factor = dynamics_.factor(e);
  VecX a, lambda;
  factor.solve(e, force, VecX::Zero(e.rows().n_rows), a, lambda);
  response_ = a;
  response_.setZero();
  for (int k = 0; k < system_.n_slots(); ++k) {
    const Slot& s = system_.slot(k);
    response_.segment<3>(6 * k) = force.segment<3>(6 * k) / s.mass;
    if (s.freedoms == Freedoms::spatial)
      response_.segment<3>(6 * k + 3) = s.J.ldlt().solve(force.segment<3>(6 * k + 3));
  }
  return a;
}

double LeftOutTrial::size_of(const VecX& v) const {
  double most = 0;
  for (Eigen::Index i = 0; i < v.size(); i += 6)
    most = std::max({most, v.segment<3>(i).norm() / system_.length(), v.segment<3>(i + 3).norm()});
  return most;
}

}  // namespace lockstep
