#include "framework/tools/batch/batch.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cmath>

#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/mechanism/lock/marker_lock.h"

namespace lockstep::lanes {
namespace {

constexpr double kEps = 1e-9;  // proximal term, relative; trees have none
constexpr std::size_t kL = kLanes;

void put_number(Aligned<double>& to, std::size_t at, int lane, double value) {
  to[kL * at + static_cast<std::size_t>(lane)] = value;
}
template <class M>
void put_numbers(Aligned<double>& to, std::size_t at, int lane, const M& values) {
  for (Eigen::Index i = 0; i < values.size(); ++i)
    put_number(to, at + static_cast<std::size_t>(i), lane, values.data()[i]);
}
void put_matrix(Aligned<double>& to, std::size_t at, int lane, const Mat3& A) {
  put_numbers(to, at, lane, Mat3(A.transpose()));  // row after row
}
void put_symmetric(Aligned<double>& to, std::size_t at, int lane, const Mat3& J) {
  const double six[] = {J(0, 0), J(0, 1), J(0, 2), J(1, 1), J(1, 2), J(2, 2)};
  for (std::size_t i = 0; i < 6; ++i) put_number(to, at + i, lane, six[i]);
}

}  // namespace

Batch::Batch(std::span<System* const> systems, int first, const CopiesOptions& options)
    : n_(static_cast<int>(systems.size())),
      first_(first),
      stabilization_(options.stabilization),
      pass_(lanes::passes(options.instructions)) {
  for (std::size_t l = 0; l < kL; ++l) systems_[l] = systems[l < systems.size() ? l : 0];
  plan_ = make_plan(*systems_[0]);
  const auto size = [](std::size_t packs, Aligned<double>& v) { return v.assign(kL * packs, 0.0), v.data(); };
  const auto n = static_cast<std::size_t>(plan_.n_slots);
  z_.mass = size(mass::size * n, mass_), z_.gravity = size(3, gravity_);
  z_.frames = size(plan_.size_frames, frames_), z_.law = size(plan_.size_law, law_);
  z_.body = size(body::size * (n + 1), body_), z_.af = size(6 * n, af_), z_.a = size(6 * n, a_);
  z_.J = size(plan_.size_J, J_), z_.Y = size(plan_.size_Y, Y_), z_.A = size(plan_.size_A, A_);
  const std::size_t x = plan_.size_x;
  z_.x = size(x, x_), z_.c = size(x, c_), z_.scale = size(x, scale_), z_.diagonal = size(x, diagonal_);
  z_.E = size(x, E_), z_.lambda = size(x, lambda_), z_.r = size(x, r_), z_.C = size(x, C_), z_.Ct = size(x, Ct_);
  size(x, Cd_), size(1, length_), size(6 * n, wrench_);
  z_.eps = plan_.tree ? 0.0 : kEps;
  motions_.resize(n + 1);
  wrench_of_one_.setZero(6 * plan_.n_slots);
  rates_of_one_.setZero(plan_.n_states);
  for (std::size_t l = 0; l < kL; ++l) {
    states_[l].setZero(plan_.n_states);
    memory_[l] = systems_[l]->start().z;
    has_forces_ = has_forces_ || !systems_[l]->forces().empty();
    length_[l] = systems_[l]->length();
  }
  if (has_forces_) z_.wrench = wrench_.data();
  fill_masses();
  fill_frames();
}

void Batch::fill_masses() {
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems_[static_cast<std::size_t>(l)];
    put_numbers(gravity_, 0, l, system.gravity());
    for (int k = 0; k < plan_.n_slots; ++k) {
      const Slot& s = system.slot(k);
      const std::size_t at = mass::size * static_cast<std::size_t>(k);
      put_number(mass_, at + mass::inverse, l, 1.0 / s.mass);
      put_number(mass_, at + mass::m, l, s.mass);
      if (s.freedoms == Freedoms::particle) continue;  // does not turn: J^-1 = 0
      put_symmetric(mass_, at + mass::Jinv, l, s.J.llt().solve(Mat3::Identity()));
      put_symmetric(mass_, at + mass::J, l, s.J);
    }
    const std::size_t ground = body::size * static_cast<std::size_t>(plan_.n_slots);
    put_matrix(body_, ground + body::A, l, Mat3::Identity());
    put_number(body_, ground + body::e, l, 1.0);
  }
}

void Batch::fill_frames() {
  for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
    Node& node = plan_.nodes[k];
    has_laws_ = has_laws_ || node.moved || node.turn == Turn::law;
    for (int l = 0; l < kLanes; ++l) {
      const auto& lock = static_cast<const MarkerLock&>(
          *systems_[static_cast<std::size_t>(l)]->links()[static_cast<std::size_t>(plan_.link[k])]);
      const MarkerFrame P(lock.p()), S(lock.s());
      if (node.turn == Turn::parallel && !(P.parallel() && S.parallel())) node.turn = Turn::plain;
      put_numbers(frames_, node.frames + frames::uP, l, P.u0), put_numbers(frames_, node.frames + frames::uS, l, S.u0);
      put_numbers(frames_, node.frames + frames::qP, l, P.q0.coefficients());
      put_numbers(frames_, node.frames + frames::qS, l, S.q0.coefficients());
      put_matrix(frames_, node.frames + frames::AP, l, P.A0), put_matrix(frames_, node.frames + frames::AS, l, S.A0);
    }
  }
}

// ------------------------------------------------------------------------------------------------ lanes and states

void Batch::put(int lane, const State& state, double* y) const {
  double* to = y + lane;
  for (const VecX* part : {&state.q, &state.v, &state.s})
    for (Eigen::Index i = 0; i < part->size(); ++i, to += kLanes) *to = (*part)[i];
}
void Batch::get(int lane, const double* y, State& state) const {
  const double* from = y + lane;
  for (VecX* part : {&state.q, &state.v, &state.s})
    for (Eigen::Index i = 0; i < part->size(); ++i, from += kLanes) (*part)[i] = *from;
}
void Batch::get(int lane, const double* rate, StateRate& out) const {
  const double* from = rate + lane;
  for (VecX* part : {&out.q, &out.v, &out.s})
    for (Eigen::Index i = 0; i < part->size(); ++i, from += kLanes) (*part)[i] = *from;
}

// What the laws of one copy see; the motions are those of its forces, when it has any.
Inputs Batch::inputs(int lane, const double* y, double t) {
  VecX& s = states_[static_cast<std::size_t>(lane)];
  const VecX& z = memory_[static_cast<std::size_t>(lane)];
  for (Eigen::Index i = 0; i < s.size(); ++i)
    s[i] = y[kL * (plan_.s_at() + static_cast<std::size_t>(i)) + static_cast<std::size_t>(lane)];
  Inputs in;
  in.t = t;
  in.motions = motions_;
  in.s = {s.data(), static_cast<std::size_t>(s.size())};
  in.z = {z.data(), static_cast<std::size_t>(z.size())};
  return in;
}

void Batch::fill_laws(const double* y, const Numbers8& t) {
  if (!has_laws_) return;
  for (int l = 0; l < kLanes; ++l) {
    const Inputs in = inputs(l, y, t[static_cast<std::size_t>(l)]);
    for (std::size_t k = 0; k < plan_.nodes.size(); ++k) {
      const Node& node = plan_.nodes[k];
      if (!node.moved && node.turn != Turn::law) continue;
      const auto& lock = static_cast<const MarkerLock&>(
          *systems_[static_cast<std::size_t>(l)]->links()[static_cast<std::size_t>(plan_.link[k])]);
      if (node.moved) {
        const ImposedTranslation D = lock.imposed_translation(in);
        put_numbers(law_, node.law + law::p, l, D.p), put_numbers(law_, node.law + law::pd, l, D.pd);
        put_numbers(law_, node.law + law::pdd, l, D.pdd);
      }
      if (node.turn != Turn::law) continue;
      const ImposedRotation D = lock.imposed_rotation(in);
      put_numbers(law_, node.law + law::q, l, D.q.coefficients()), put_matrix(law_, node.law + law::A, l, D.A);
      put_numbers(law_, node.law + law::w, l, D.w), put_numbers(law_, node.law + law::a, l, D.a);
    }
  }
}

// Forces know one mechanism: they are applied copy by copy.
void Batch::fill_wrench(const double* y, const Numbers8& t) {
  if (!has_forces_) return;
  for (int l = 0; l < kLanes; ++l) {
    const System& system = *systems_[static_cast<std::size_t>(l)];
    wrench_of_one_.setZero();
    if (l < n_ && !system.forces().empty()) {
      for (int k = 0; k < plan_.n_slots; ++k) {
        Motion& O = motions_[static_cast<std::size_t>(k + 1)];
        const double* b = body_.data() + kL * body::size * static_cast<std::size_t>(k) + l;
        const auto at = [&](std::size_t i) { return b[kL * i]; };
        for (std::size_t i = 0; i < 3; ++i) {
          const auto r = static_cast<Eigen::Index>(i);
          O.x[r] = at(body::x + i), O.v[r] = at(body::v + i), O.w[r] = at(body::w + i);
          for (std::size_t j = 0; j < 3; ++j) O.A(r, static_cast<Eigen::Index>(j)) = at(body::A + 3 * i + j);
        }
        O.e = {at(body::e), at(body::e + 1), at(body::e + 2), at(body::e + 3)};
      }
      const Inputs in = inputs(l, y, t[static_cast<std::size_t>(l)]);
      WrenchSum sum(in.motions, wrench_of_one_);
      for (const auto& force : system.forces()) force->apply(in, sum);
    }
    put_numbers(wrench_, 0, l, wrench_of_one_);
  }
}

void Batch::state_rates(const double* y, const Numbers8& t, double* rate) {
  if (plan_.n_states == 0) return;
  for (int l = 0; l < kLanes; ++l) {
    const Inputs in = inputs(l, y, t[static_cast<std::size_t>(l)]);
    rates_of_one_.setZero();
    for (const int k : plan_.link) {
      const Lock& link = *systems_[static_cast<std::size_t>(l)]->links()[static_cast<std::size_t>(k)];
      if (link.n_states() > 0)
        link.state_rates(in, {rates_of_one_.data() + link.first_state(), static_cast<std::size_t>(link.n_states())});
    }
    for (Eigen::Index i = 0; i < rates_of_one_.size(); ++i)
      rate[kL * (plan_.s_at() + static_cast<std::size_t>(i)) + static_cast<std::size_t>(l)] = rates_of_one_[i];
  }
}

// ------------------------------------------------------------------------------------------------------ evaluation

Flags8 Batch::evaluate(const double* y, const Numbers8& t, double* rate) {
  z_.y = y;
  pass_.see_bodies(plan_, z_);
  fill_laws(y, t);
  fill_wrench(y, t);
  pass_.free_motion(plan_, z_);
  pass_.accelerate_rows(plan_, z_);
  pass_.factor_and_solve(plan_, z_);
  pass_.apply(plan_, z_);
  if (z_.eps > 0) {  // the plain solution leaves r = E lambda: no need to look
    pass_.shift(plan_, z_);
    pass_.solve(plan_, z_);
    pass_.apply(plan_, z_);
  }
  const Flags8 unmet = check_rows();
  pass_.rates(plan_, z_, rate);
  state_rates(y, t, rate);
  return unmet;
}

bool Batch::any_unmet(const double* floors) {
  pass_.unmet(plan_, z_, floors, kRowTolerance, unmet_.data());
  return std::any_of(unmet_.begin(), unmet_.begin() + n_, [](double x) { return x != 0; });
}

// The stop rule of the solver `schur`, copy by copy; corrections are made for all copies while one needs them.
Flags8 Batch::check_rows() {
  double* floors = scratch_.data();  // two packs
  pass_.largest_scales(plan_, z_, floors);
  Numbers8 largest_t, largest_r;
  std::copy_n(floors, kL, largest_t.begin()), std::copy_n(floors + kL, kL, largest_r.begin());
  for (std::size_t i = 0; i < 2 * kL; ++i) floors[i] *= kScaleFloor;
  bool energy = false;
  const auto met = [&] {
    pass_.residual(plan_, z_);
    if (!any_unmet(floors)) return true;
    if (energy) return false;
    pass_.energies(plan_, z_, floors);
    energy = true;
    for (std::size_t l = 0; l < kL; ++l) {
      const double most = floors[2 * kL + l];
      floors[l] = kScaleFloor * std::max(largest_t[l], std::sqrt(floors[l] * most));
      floors[kL + l] = kScaleFloor * std::max(largest_r[l], std::sqrt(floors[kL + l] * most));
    }
    return !any_unmet(floors);
  };
  bool all = met();
  for (int round = z_.eps > 0 ? 1 : 0; !all && round < kMaxCorrections; ++round) {
    std::copy(r_.begin(), r_.end(), x_.begin());
    pass_.solve(plan_, z_);
    pass_.apply(plan_, z_);
    all = met();
  }
  Flags8 out{};
  for (std::size_t l = 0; l < kL; ++l) out[l] = unmet_[l] != 0;
  return out;
}

}  // namespace lockstep::lanes
