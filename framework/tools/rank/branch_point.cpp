// SPDX-License-Identifier: BSD-3-Clause
#include "framework/tools/rank/branch_point.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>
#include <random>

#include <lockstep/error.h>
#include "framework/dynamics/evaluate/row_space.h"
#include "framework/dynamics/solvers/graph.h"
#include "framework/foundation/math/decompositions.h"
#include "framework/foundation/math/limits.h"
#include "framework/tools/rank/doubts.h"
#include "framework/tools/rank/loop_rows.h"
#include "framework/tools/rank/motion_words.h"
#include "framework/tools/rank/stopping_form.h"

namespace lockstep {

namespace {

constexpr int kMostMotions = 3;  // with more of them branches are no lines
constexpr double kIn = 1e-5;     // pivot of rows of length 1: in the position
constexpr double kSameLine = 1e-3;

// Whether laws move the rows.
bool is_driven(const Evaluation& e, const std::vector<int>& rows) {
  VecX Ct = VecX::Zero(e.rows().n_rows), of_part = Ct;
  e.velocity_residual(VecX::Zero(6 * e.system().n_slots()), Ct);
  of_part(rows) = Ct(rows);
  return !(e.norm(of_part) <= kNegligible);
}

// Forms that stop motions, in 1/length. Combinations at random span what all combinations do: as many as there are
// different forms.
std::vector<MatX> stopping_forms(const Evaluation& e, const LoopRows& rows, const MatX& N, const MatX& W) {
  const Eigen::Index p = std::min<Eigen::Index>(N.cols(), kMostMotions), n = std::min(W.cols(), p * (p + 1) / 2);
  std::minstd_rand random(1);
  std::normal_distribution<double> normal;
  std::vector<MatX> forms;
  for (Eigen::Index k = 0; k < n; ++k) {
    VecX w = VecX::Zero(e.rows().n_rows);
    w(rows.numbers) =
        W.cols() == n ? VecX(W.col(k)) : VecX(W * VecX::NullaryExpr(W.cols(), [&] { return normal(random); }));
    if (std::optional<MatX> G = stopping_form(e, rows.at, N, w)) forms.push_back(*G * e.system().length());
  }
  return forms;
}

// Unit vectors c with c . G c = 0 for all G, up to their sign: Newton's method from many directions.
std::vector<VecX> common_zeros(const std::vector<MatX>& forms, Eigen::Index p) {
  constexpr int kStarts = 200, kRounds = 60;
  std::minstd_rand random(1);
  std::normal_distribution<double> normal;
  std::vector<VecX> found;
  MatX slopes(static_cast<Eigen::Index>(forms.size()) + 1, p);
  VecX values(slopes.rows());
  for (int start = 0; start < kStarts; ++start) {
    VecX c = VecX::NullaryExpr(p, [&] { return normal(random); }).normalized();
    double size = HUGE_VAL;
    for (int round = 0; round < kRounds; ++round) {
      for (std::size_t k = 0; k < forms.size(); ++k) {
        const VecX Gc = forms[k] * c;
        slopes.row(static_cast<Eigen::Index>(k)) = 2 * Gc.transpose(), values[static_cast<Eigen::Index>(k)] = c.dot(Gc);
      }
      slopes.bottomRows(1) = c.transpose(), values[values.size() - 1] = 0;
      size = values.lpNorm<Eigen::Infinity>();
      if (size <= kNegligible) break;
      c -= least_norm(slopes, values);
      c.normalize();
    }
    if (!(size <= kSlight)) continue;
    const bool known =
        std::ranges::any_of(found, [&](const VecX& other) { return 1 - std::abs(c.dot(other)) < kSameLine; });
    if (!known) found.push_back(c);
  }
  return found;
}

}  // namespace

BranchPoint branch_point(Dynamics& dynamics, const State& given) try {
  BranchPoint out;
  const State state = dynamics.in_slots(given);
  const System& system = dynamics.system();
  if (!has_loops(system, state.modes)) return out;
  const Evaluation& e = dynamics.gather_rows(state);
  const std::vector<std::vector<int>> loops =
      closed_loops(system, e.rows());  // any motion of them moves the rest along
  std::vector<int> entries;
  for (const std::vector<int>& loop : loops) entries.insert(entries.end(), loop.begin(), loop.end());
  const LoopRows rows(system, e.rows(), entries);
  if (rows.n() == 0 || rows.n() > kDenseRows) return out;
  const RowSpace space(rows.at.rows_in_lengths(e.rows(), entries));
  out.slots.assign(system.n_slots(), false);
  for (const int place : rows.at.places()) out.slots[place / 6] = true;
  out.nearness = space.smallest_singular_value(space.rank(kIn));
  const MatX N = space.free(kIn);
  out.motions = static_cast<int>(N.cols());
  const MatX W = space.circuits(kIn);
  int k = 0;
  for (const std::vector<int>& loop : loops) {
    std::vector<std::string> drives, joints;  // of the loop, of its circuits
    for (const int entry : loop)
      for (int own = 0; own < e.rows().entries[entry].m; ++own, ++k) {
        const NamedRow row(system, e.rows(), rows.numbers[k]);
        if (row.moves()) drives.push_back(row.drive());
        if (W.cols() > 0 && W.row(k).norm() > kSlight) add_name(row.link->name(), joints);
      }
    if (joints.empty() || drives.empty()) continue;
    out.drives.insert(out.drives.end(), drives.begin(), drives.end());
    out.joints.insert(out.joints.end(), joints.begin(), joints.end());
  }
  if (out.drives.empty() && is_driven(e, rows.numbers)) return {};
  out.known = true;
  std::vector<MatX> forms = stopping_forms(e, rows, N, W);
  double strongest = 0;
  for (MatX& G : forms) {
    const double size = G.cwiseAbs().maxCoeff();
    strongest = std::max(strongest, size), G /= size;
  }
  out.singular = !forms.empty();
  if (!out.singular || out.motions > kMostMotions || !out.drives.empty()) return out;
  const std::vector<VecX> lines = common_zeros(forms, out.motions);
  out.all = lines.size() <= (out.motions == 2 ? 2u : 4u);  // more are a surface of them
  for (const VecX& c : lines) {
    if (!out.all) break;
    VecX motion = rows.at.motion_of(N * c);
    motion /= motion_size(system, motion);
    out.tangents.push_back(std::move(motion));
  }
  const double size = motion_size(system, rows.at.motion_of(N.rowwise().sum()));
  out.locked = out.motions == 1 && lines.empty() && strongest > kIn * size * size;
  return out;
} catch (const Error&) {  // not known if other velocities cannot be evaluated
  return {};
}

std::string BranchPoint::text(Dynamics& dynamics, const State& given) const {
  if (!singular) return {};
  if (!drives.empty())
    return fmt::format("with {} prescribed, the loop of joints {} may continue in several ways, or not at all",
                       first_of(drives), first_of(joints));
  const State state = dynamics.in_slots(given);
  const std::string count = fmt::format("{} instantaneous degree{} of freedom", motions, motions == 1 ? "" : "s");
  if (!all) return count + ", with more branches than can be listed";
  if (tangents.empty()) return count + ", but no finite motion: the mechanism is locked";
  std::string words =
      count + (tangents.size() == 1 ? ", one branch: " : fmt::format(", {} branches: ", tangents.size()));
  const Inputs& in = dynamics.inputs(state);
  for (std::size_t k = 0; k < tangents.size(); ++k)
    words += (k > 0 ? "; or " : "") + motion_words(dynamics.system(), in, tangents[k]);
  return words;
}

bool BranchPoint::moves(const VecX& v) const {
  for (Eigen::Index i = 0; i < v.size(); ++i)
    if (v[i] != 0 && slots[i / 6]) return true;
  return false;
}

double BranchPoint::off_branches(const System& system, const VecX& v) const {
  const auto as_lengths = [&](VecX x) {
    for (Eigen::Index i = 0; i < x.size(); ++i) {
      if (!slots[i / 6]) x[i] = 0;
      if (i % 6 >= 3) x[i] *= system.length();
    }
    return x;
  };
  const VecX moving = as_lengths(v);
  double least = moving.norm() > 0 ? 1 : 0;
  for (const VecX& tangent : tangents) {
    const VecX along = as_lengths(tangent).normalized();
    least = std::min(least, (moving - along.dot(moving) * along).norm() / moving.norm());
  }
  return least;
}

}  // namespace lockstep
