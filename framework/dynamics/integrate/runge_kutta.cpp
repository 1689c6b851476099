// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/author/stepping.h>

#include <cmath>

#include <lockstep/error.h>
#include "framework/foundation/math/for_size.h"

namespace lockstep {

namespace {

// out = base + h sum_i w_i k_i (base null: from zero) over kWidth numbers of one part: one pass, the sums stay in
// registers.
template <int kWidth>
inline void add_block(const double* base, const StateRate* k, VecX StateRate::*part, double h, const Weights& w,
                      Eigen::Index at, double* out) {
  constexpr int kEven = kWidth / 2 * 2;  // in pairs, for which every processor has registers
  using Pairs = Eigen::Array<double, kEven, 1>;
  Pairs sum = Pairs::Zero();
  double last = 0;
  if (base) {
    sum = Eigen::Map<const Pairs>(base + at);
    if (kEven < kWidth) last = base[at + kEven];
  }
  for (std::size_t i = 0; i < w.n; ++i) {
    const double* ki = (k[w.stage[i]].*part).data() + at;
    const double hw = h * w.w[i];
    sum += hw * Eigen::Map<const Pairs>(ki);
    if (kEven < kWidth) last += hw * ki[kEven];
  }
  Eigen::Map<Pairs>(out + at) = sum;
  if (kEven < kWidth) out[at + kEven] = last;
}

// One part (q, v or s) of y + h sum_i w_i k_i: eight numbers at a time, then the rest in one block.
inline void add_part(const double* base, const StateRate* k, VecX StateRate::*part, double h, const Weights& w,
                     VecX& out) {
  const auto block = [&](auto width, Eigen::Index at) { add_block<width()>(base, k, part, h, w, at, out.data()); };
  Eigen::Index at = 0;
  for (; at + 8 <= out.size(); at += 8) block(std::integral_constant<int, 8>(), at);
  if (const auto rest = static_cast<int>(out.size() - at); rest > 0)
    for_size<1, 7>(rest, [&](auto width) { block(width, at); });
}

}  // namespace

Weights::Weights(const double* all, int n_all) {
  for (int i = 0; i < n_all; ++i) {
    if (all[i] == 0) continue;
    stage[n] = i;
    w[n++] = all[i];
  }
}

void Stages::begin(const Tableau& tableau, const State& y, bool watch) {
  tableau_ = tableau;
  watch_ = watch;
  a_.clear();
  for (int i = 0; i < tableau.n_all; ++i) a_.emplace_back(tableau.a + i * tableau.stride, i);
  b_ = Weights(tableau.b, tableau.n_stages);
  stage_ = y;
  k_.resize(tableau.n_all);
  for (StateRate& k : k_) k = sized_like(y);
  conditioning_.fill({});
}

bool Stages::evaluate(Dynamics& dynamics, const State& y, double h, int first, int last, StagesOn on) {
  if (y.z.size() > 0) stage_.z = y.z;
  for (int i = first; i < last; ++i) {
    const Weights& a = a_[i];
    const bool is_start = a.n == 0 && on == StagesOn::plain;  // Y_1 = y
    if (!is_start) combine(y, h, a, stage_), stage_.t = y.t + tableau_.c[i] * h;
    if (on == StagesOn::manifold && !dynamics.project(stage_, 0).converged) return false;
    const State& at = is_start ? y : stage_;
    StateRate& k = k_[i];
    if (!watch_) {
      dynamics.rates(at, k);
      continue;
    }
    const SolveReport solved = dynamics.rates_with_report(at, k);
    conditioning_[i] = {solved.detector, solved.smallest_pivot};
  }
  return true;
}

void Stages::put(int i, const StateRate& k) {
  const auto at = static_cast<std::size_t>(i);
  for (const auto part : {&StateRate::q, &StateRate::v, &StateRate::s, &StateRate::followed})
    if ((k.*part).size() != (k_[at].*part).size())
      throw ModelError("Stages::put: the rates have another size than those of begin(); create them by sized_like()");
  k_[at] = k;
  conditioning_[at] = {};
}

void Stages::combine(const State& y, double h, const Weights& w, State& out) const {
  add_part(y.q.data(), k_.data(), &StateRate::q, h, w, out.q);
  add_part(y.v.data(), k_.data(), &StateRate::v, h, w, out.v);
  add_part(y.s.data(), k_.data(), &StateRate::s, h, w, out.s);
  out.t = y.t + h;
}

void Stages::sum(double h, const Weights& w, StateRate& out) const {
  add_part(nullptr, k_.data(), &StateRate::q, h, w, out.q);
  add_part(nullptr, k_.data(), &StateRate::v, h, w, out.v);
  add_part(nullptr, k_.data(), &StateRate::s, h, w, out.s);
  add_part(nullptr, k_.data(), &StateRate::followed, h, w, out.followed);
}

ProjectReport project_end(Dynamics& dynamics, State& y, StagesOn on) {
  if (dynamics.options().stabilization.kind == Stabilization::Kind::project)
    return on == StagesOn::manifold ? dynamics.project(y, 0) : dynamics.project(y);
  ProjectReport report;
  dynamics.normalize(y);
  report.before = report.after = dynamics.violation(y);
  return report;
}

double combined_error(double e5, double e3) {
  if (e5 == 0) return 0;
  return std::isfinite(e5) && std::isfinite(e3) ? e5 * (e5 / std::hypot(e5, 0.1 * e3)) : HUGE_VAL;
}

void copy_motion(const State& in, State& out) {
  if (out.coordinates != in.coordinates) out.coordinates = in.coordinates;
  out.t = in.t;
  out.q = in.q;
  out.v = in.v;
  out.s = in.s;
}

void lead_angles(Dynamics& dynamics, const State& from, State& to) {
  const auto& angles = dynamics.system().counted_angles();
  const double h = to.t - from.t;
  for (const auto& angle : angles) to.s.segment<2>(angle->first()) = from.s.segment<2>(angle->first());
  for (const State* end : {&from, static_cast<const State*>(&to)}) {
    if (angles.empty()) return;
    const Inputs& in = dynamics.inputs(*end);
    for (const auto& angle : angles) to.s[angle->first()] += 0.5 * h * angle->rate(in);
  }
}

void take_motion(State& in, State& out) {
  if (out.coordinates != in.coordinates) out.coordinates = in.coordinates;
  out.t = in.t;
  out.q.swap(in.q);
  out.v.swap(in.v);
  out.s.swap(in.s);
}

}  // namespace lockstep
