#include "framework/tools/check/lock_bench.h"

#include <spdlog/fmt/fmt.h>

#include <algorithm>
#include <cmath>

namespace lockstep {
namespace {

constexpr std::size_t kGuard = 64;  // numbers in front of and behind the rows
constexpr double kMark = -7.25e77;  // what stands there

}  // namespace

Place home_of(const System& system, double t) {
  const State state = system.start();
  Place p;
  p.t = t;
  system.motions(state, p.motions);
  p.s = state.s, p.z = state.z;
  return p;
}

Place drawn_about(const System& system, const Place& home, Draw& draw, double reach, double turn) {
  std::vector<int> slots;
  for (int k = 0; k < system.n_slots(); ++k) slots.push_back(k);
  const double L = slots.empty() ? 1.0 : std::max(Differences::distance(slots, home.in()), system.length());
  Place p = home;
  for (int k = 0; k < system.n_slots(); ++k) {
    Motion& O = p.slot(k);
    O.x += draw.vector(reach * L);
    O.v = draw.vector(L);
    const Quat q = draw.turn(turn);
    O.w = draw.vector(2.0);
    if (system.slot(k).freedoms == Freedoms::particle)
      O.w.setZero();
    else
      O.e = normalized(O.e * q), O.A = rotation(O.e);
  }
  return p;
}

void coast(const Place& from, double x, Place& to) {
  to = from;
  to.t += x;
  for (Motion& O : to.motions) {
    O.x += x * O.v;
    O.e = O.e * exponential(x * O.w);
    O.A = rotation(O.e);
  }
}

std::string velocity_name(const System& system, int slot, int k) {
  const std::string& body = system.body_of_slot(slot).name;
  const char axis = "xyz"[k % 3];
  return k < 3 ? fmt::format("the velocity of body '{}' along the world's {} axis", body, axis)
               : fmt::format("the angular velocity of body '{}' about its {} axis", body, axis);
}

std::string move_name(const System& system, int slot, int k) {
  const std::string& body = system.body_of_slot(slot).name;
  const char axis = "xyz"[k % 3];
  return k < 3 ? fmt::format("the translation of body '{}' along the world's {} axis", body, axis)
               : fmt::format("the turn of body '{}' about its {} axis", body, axis);
}

void LockBench::gather(const Place& place, Group links, double before) {
  const RowShape s = link_.shape();
  const std::size_t stride = RowSpan::stride(s), n_columns = s.size() / static_cast<std::size_t>(std::max(s.ld(), 1));
  n_lanes_ = links.size();
  numbers_.assign(2 * kGuard + n_lanes_ * stride, kMark);
  for (std::size_t lane = 0; lane < n_lanes_; ++lane) {
    double* block = numbers_.data() + kGuard + lane * stride;
    std::fill(block, block + stride, 0.0);
    for (std::size_t c = 0; c < n_columns; ++c) std::fill_n(block + c * static_cast<std::size_t>(s.ld()), s.m, before);
    if (n_turned(s.layout) > 0)  // the columns of R have three rows
      for (std::size_t c = 3; c < 3 + static_cast<std::size_t>(n_turned(s.layout)); ++c)
        std::fill_n(block + c * static_cast<std::size_t>(s.ld()) + 3, std::max(s.m - 3, 0), 0.0);
  }
  link_.gather(links, place.in(), RowSpan(numbers_.data() + kGuard, s));
  look_beside();
}

void LockBench::look_beside() {
  const RowShape s = link_.shape();
  const auto ld = static_cast<std::size_t>(s.ld()), m = static_cast<std::size_t>(s.m);
  const std::size_t stride = RowSpan::stride(s), end = kGuard + n_lanes_ * stride;
  wrote_padding_ = wrote_outside_ = false;
  for (std::size_t i = 0; i < numbers_.size(); ++i)
    if ((i < kGuard || i >= end) && numbers_[i] != kMark) wrote_outside_ = true;
  for (std::size_t lane = 0; lane < n_lanes_; ++lane)
    for (std::size_t i = 0; i < stride; ++i)
      if ((i >= s.size() || i % ld >= m) && numbers_[kGuard + lane * stride + i] != 0) wrote_padding_ = true;
}

void LockBench::read(std::size_t lane, LockRows& out) const {
  const RowShape s = link_.shape();
  const RowView block(numbers_.data() + kGuard + lane * RowSpan::stride(s), s);
  const SlotList slots = link_.slots();
  out.C.resize(s.m), out.Ct.resize(s.m), out.Qhat.resize(s.m);
  out.J.setZero(s.m, 6 * system_.n_slots());
  for (int k = 0; k < s.m; ++k) {
    out.C[k] = block.C(k), out.Ct[k] = block.Ct(k), out.Qhat[k] = block.Qhat(k);
    for (int i = 0; i < slots.n; ++i) {
      const auto r = block.J(i, k);
      for (int j = 0; j < 6; ++j) out.J(k, 6 * slots[i] + j) = r[static_cast<std::size_t>(j)];
    }
  }
}

void LockBench::rows(const Place& place, LockRows& out, double before) {
  const Lock* self = &link_;
  gather(place, Group(&self, 1), before);
  read(0, out);
}

void LockBench::rows_of_two(const Place& place, const Lock& other, LockRows& first, LockRows& second) {
  const Lock* both[2] = {&link_, &other};
  gather(place, Group(both, 2), 0);
  read(0, first), read(1, second);
}

// Gauss's rule with 5 points over the rates along the motion; s itself as far as its rate at the beginning takes it.
void LockBench::move_states(const Place& from, Place& to) const {
  const int n = link_.n_own_states();
  if (n == 0) return;
  const Stateful& own = *link_.stateful();
  constexpr double x[5] = {0.04691007703066800, 0.2307653449471585, 0.5, 0.7692346550528415, 0.9530899229693320};
  constexpr double w[5] = {0.1184634425280945, 0.2393143352496832, 0.2844444444444444, 0.2393143352496832,
                           0.1184634425280945};
  const double h = to.t - from.t;
  VecX rate(n), start(n), sum = VecX::Zero(n);
  const std::span<double> rates(rate.data(), static_cast<std::size_t>(n));
  own.state_rates(from.in(), rates);
  start = rate;
  Place on;
  for (int i = 0; i < 5; ++i) {
    coast(from, x[i] * h, on);
    on.s.segment(link_.first_state(), n) += x[i] * h * start;
    own.state_rates(on.in(), rates);
    sum += w[i] * rate;
  }
  to.s.segment(link_.first_state(), n) += h * sum;
}

}  // namespace lockstep
