// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/solvers.h>

#include <algorithm>
#include <cmath>

#include <lockstep/author/memory.h>
#include <lockstep/body.h>
#include "framework/dynamics/solvers/conjugate.h"
#include "framework/dynamics/solvers/schur_passes.h"
#include "framework/dynamics/solvers/stop_rule.h"

namespace lockstep {

namespace {

constexpr std::size_t kPad = 8;  // numbers after an array, since a pack may read beyond its end

/// Out = B v of one slot, with B its masses or their inverses; returns v . B v.
template <class X>
LOCKSTEP_INLINE double slot_mass_times(const double* B, const double* v, double* out) {
  double sum = 0;
  for (int i = 0; i < X::nv; ++i) out[i] = B[0] * v[i];
  for (int i = 0; i < X::nw; ++i) {
    double& t = out[X::nv + i] = B[X::I[i][0]] * v[X::nv];
    for (int k = 1; k < X::nw; ++k) t += B[X::I[i][k]] * v[X::nv + k];
  }
  for (int i = 0; i < X::n; ++i) sum += v[i] * out[i];
  return sum;
}

}  // namespace

class SchurFactorization : public Factorization {
 public:
  explicit SchurFactorization(const KktPattern&);

  void compute(const Kkt& kkt) override {
    if (!masses_known_) read_masses(kkt);
    rows_ = kkt.pattern.rows;
    redundant_ = plan_.tree ? 0 : kkt.redundant;
    revision_ = rows_->revision();
    z_.rows = rows_->data();
    schur::fill(plan_, z_);
    schur::factor(plan_, z_);
  }

  SolveReport solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override {
    z_.rows = kkt.pattern.rows->data();
    start(f, c);
    SolveReport report = solve_with(kkt);
    unload(a, lambda);
    return report;
  }

  /// Adds the residual of the last solution, and the pivots.
  void complete(SolveReport& report) override {
    find_worst();
    report.residual = worst_;
    report.worst_row = worst_row_;
    watch_.see(redundant_, [&](auto&& row) {
      for (const Row& r : order_) row(1.0 / p_[r.at], diagonal_[r.at]);
    });
    watch_.report(report);
  }

  // The least eigenvalue of S relative to s but those of redundant rows. The factor is then that of another E.
  double least_regular() {
    const double least = least_eigenvalue();
    v_ = p_;
    z_.eps *= 2;
    schur::fill(plan_, z_);
    schur::factor(plan_, z_);
    z_.eps /= 2;
    // det(S + 2 E)/det(S + E) has a factor 2 of each redundant direction, and (x + 2 eps)/(x + eps) of an eigenvalue x
    double ln_ratio = -redundant_ * std::log(2.0);
    for (std::size_t i = 0; i < p_.size(); ++i) ln_ratio += p_[i] == 0 ? 0 : std::log(v_[i] / p_[i]);
    const double ratio = std::exp(ln_ratio);
    return std::max(ratio * ratio > 2 ? z_.eps * (2 - ratio) / (ratio - 1) : least, 0.0);
  }

 private:
  void read_masses(const Kkt& kkt) {
    const int stride = plane_ ? schur::Planar::mass : schur::Spatial::mass;
    double lightest = HUGE_VAL, heaviest = 0;
    for (int k = 0; k < plan_.n_slots; ++k) {
      const SlotMass& slot = kkt.masses[k];
      lightest = std::min(lightest, slot.m), heaviest = std::max(heaviest, slot.m);
      BodyMass(slot.m, slot.J, slot.particle, plane_).write_packed(&mass_[stride * k], &inverse_[stride * k]);
    }
    for (const int h : plan_.hubs) {  // a hub that is a particle: an inertia so large that it does not turn
      double* M = &mass_[stride * plan_.nodes[h].hub_slot];
      for (int i = 0; i < (plane_ ? 1 : 3); ++i)
        if (double& J = M[schur::Spatial::I[i][i]]; J == 0) J = 1e30 * M[0];
    }
    gradients_.set(z_.eps, lightest / heaviest);
    masses_known_ = true;
  }

  // a_f = M^-1 f
  template <class X>
  void free_motion(const VecX& f) {
    energy_f_ = 0;
    for (int s = 0; s < plan_.n_slots; ++s) {
      double F[X::n];
      for (int i = 0; i < X::n; ++i) F[i] = f[6 * s + (X::n == 6 ? i : velocity_[i])];
      energy_f_ = std::max(energy_f_, slot_mass_times<X>(&inverse_[X::mass * s], F, &a_[X::a * s]));
    }
  }

  void start(const VecX& f, const VecX& c) {
    std::copy(c.data(), c.data() + c.size(), given_.data());
    plane_ ? free_motion<schur::Planar>(f) : free_motion<schur::Spatial>(f);
    schur::start(plan_, given_.data(), z_);
    for (const int h : plan_.hubs) {
      const schur::Node& node = plan_.nodes[h];
      for (int i = 0; i < node.m; ++i) x_[node.x + i] = -f[6 * node.hub_slot + velocity_[i]];
    }
    largest_ = largest_of(scale_);
    for (std::size_t k = 0; k < 3; ++k) floors_[k] = residual_floor(largest_[k]);
  }

  SolveReport solve_with(const Kkt& kkt) {
    SolveReport report;
    schur::solve(plan_, z_);
    schur::apply(plan_, x_.data(), z_);
    lambda_ = x_;
    if (z_.eps > 0) {  // the plain solution leaves r = E lambda: no need to measure it
      for (std::size_t i = 0; i < plan_.size_x; ++i) x_[i] = E_[i] * lambda_[i];
      correct();
      ++report.corrections;
    }
    // the rows have changed since the factor: the caller iterates
    if (kkt.pattern.rows != rows_ || rows_->revision() != revision_) return report;

    bool raised = false;
    const auto measure = [&] { schur::residual(plan_, z_); };
    const auto within = [&] { return schur::rows_met(plan_, kRowTolerance, z_); };
    const auto raise = [&] {
      if (raised) return false;
      plane_ ? raise_floors<schur::Planar>() : raise_floors<schur::Spatial>();
      return raised = true;
    };
    const auto corrected = [&] {
      find_worst(), before_ = worst_;
      std::copy(r_.begin(), r_.end(), x_.begin());
      for (const int h : plan_.hubs) std::fill_n(&x_[plan_.nodes[h].x], plan_.nodes[h].m, 0.0);
      correct();
    };
    if (refine(report.corrections, measure, within, raise, corrected)) return report;
    find_worst();
    if (gradients_.needed() || worst_ < kFalling * before_) {
      if (conjugate(report.corrections, measure)) return report;
      before_ = gradients_.refused() ? 0 : HUGE_VAL;  // what is left stays, or was not solved for to the end
    }
    SchurFactorization::complete(report);
    report.contradictory = watch_.contradictory(worst_, before_);
    return report;
  }

  // lambda += (S + E)^-1 x
  void correct() {
    schur::solve(plan_, z_);
    schur::apply(plan_, x_.data(), z_);
    for (std::size_t i = 0; i < plan_.size_x; ++i) lambda_[i] += x_[i];
  }

  // The least eigenvalue of S relative to s but those of redundant rows, zero, from above: it falls as the square of the
  // distance to a singular configuration in any frame, where pivots of redundant rows may be larger. With E = eps s and
  // B = (S + E)^-1 E, which keeps redundant directions and little of others, of any motion a:
  //
  //     v = (1 - B) (S + E)^-1 J a,   x = B v,   x'S x/(x's x) = eps x'E(v - x)/(x'E x)
  //
  // A v of which B keeps much is not redundant, but close to the singular configuration. In it such a v is zero.
  double least_eigenvalue() {
    const auto n = static_cast<Eigen::Index>(plan_.size_x);
    Eigen::Map<VecX> x(x_.data(), n), v(v_.data(), n), E(E_.data(), n);
    schur::residual(plan_, z_);  // nothing was solved: a is that of the constructor, and c = 0
    x_ = r_;
    schur::solve(plan_, z_);
    v = x;
    const auto times_B = [&] { x = E.cwiseProduct(v), schur::solve(plan_, z_); };
    const auto square = [&](const auto& y) { return y.dot(E.cwiseProduct(y)); };
    times_B();
    if (square(x) < kSmallPivot * square(v)) v -= x, times_B();
    return square(x) > 0 ? z_.eps * x.dot(E.cwiseProduct(v - x)) / square(x) : HUGE_VAL;
  }

  template <class Measure>
  bool conjugate(int& corrections, Measure&& measure) {
    const auto spread = [&](const VecX& v, double factor) {
      std::ranges::fill(x_, 0.0);
      for (std::size_t k = 0; k < order_.size(); ++k) x_[order_[k].at] = factor * v[static_cast<Eigen::Index>(k)];
    };
    const auto gather = [&](const Aligned<double>& from, VecX& v) {
      for (std::size_t k = 0; k < order_.size(); ++k) v[static_cast<Eigen::Index>(k)] = from[order_[k].at];
    };
    const auto solve = [&](const VecX& r, VecX& z) {
      spread(r, 1.0);
      schur::solve(plan_, z_);
      gather(x_, z);
    };
    const auto step = [&](const VecX& p, double length) {
      spread(p, length);
      schur::apply(plan_, x_.data(), z_);
      for (const Row& r : order_) lambda_[r.at] += x_[r.at];
      measure();
    };
    const auto worst = [&] { return find_worst(), worst_ / kRowTolerance; };
    return gradients_.iterate(
        corrections, [&](VecX& r) { gather(r_, r); }, solve, step, worst);
  }

  template <class X>
  void raise_floors() {
    double energy = 0, force[X::n];
    for (int s = 0; s < plan_.n_slots; ++s)
      energy = std::max(energy, slot_mass_times<X>(&mass_[X::mass * s], &a_[X::a * s], force));
    const std::array<double, 3> S = largest_of(diagonal_);
    for (std::size_t k = 0; k < 3; ++k) floors_[k] = residual_floor(largest_[k], S[k], energy_f_ + energy);
  }

  /// The largest value of the rows of each kind.
  std::array<double, 3> largest_of(const Aligned<double>& values) const {
    std::array<double, 3> largest{};
    for (const Row& r : order_) largest[r.kind] = std::max(largest[r.kind], values[r.at]);
    return largest;
  }

  void find_worst() {
    worst_ = 0, worst_row_ = -1;
    for (const Row& row : order_) {
      const double r = std::abs(r_[row.at]), q = r == 0 ? 0.0 : r / std::max(scale_[row.at], floors_[row.kind]);
      if (worst_row_ >= 0 && (q <= worst_ || std::isnan(worst_))) continue;
      worst_ = q, worst_row_ = row.row;
    }
  }

  void unload(VecX& a_out, VecX& lambda_out) const {
    a_out.resize(6 * plan_.n_slots);
    if (plane_) {
      a_out.setZero();
      for (int s = 0; s < plan_.n_slots; ++s)
        for (int i = 0; i < 3; ++i) a_out[6 * s + velocity_[i]] = a_[schur::Planar::a * s + i];
    } else {
      std::copy_n(a_.begin(), a_out.size(), a_out.begin());
    }
    lambda_out.resize(plan_.n_rows);
    for (const schur::Node& node : plan_.nodes) {
      if (node.link < 0) continue;
      const double* l = lambda_.data() + node.x;
      double* out = lambda_out.data() + node.first_row;
      for (int k = 0; k < node.m; ++k) out[k] = l[k];
      for (int k = 0; k < node.n_turned; ++k) {  // back into the link's axes
        const double* R = z_.rows + node.R + k * node.ld();
        out[k] = R[0] * l[0] + R[1] * l[1];
        if (node.n_turned == 3) out[k] += R[2] * l[2];
      }
    }
  }

  struct Row {
    int row;               // number in the table
    std::size_t at, kind;  // place in x, RowKind
  };
  schur::Plan plan_;
  Plane plane_;
  std::array<int, 6> velocity_{};  // of a slot's six, of each unknown
  schur::Numbers z_;
  Aligned<double> A_, Y_, x_, c_, scale_, diagonal_, p_, E_, r_, lambda_, a_, inverse_, mass_, given_, kinds_, v_;
  const RowTable* rows_ = nullptr;  // that the matrix was computed from, with their revision
  long revision_ = -1;
  bool masses_known_ = false;
  int redundant_ = Kkt::kUnknown;               // of the rows that the matrix was computed from
  double energy_f_ = 0;                         // largest f . M^-1 f of a slot
  std::array<double, 3> largest_{}, floors_{};  // scale and residual floor by kind
  PivotWatch watch_;
  ConjugateGradients gradients_;
  std::vector<Row> order_;         // in the order of elimination
  double worst_ = 0, before_ = 0;  // relative residual, and that before the last correction
  int worst_row_ = -1;
};

SchurFactorization::SchurFactorization(const KktPattern& pattern)
    : plan_(schur::make_plan(*pattern.rows, pattern.n_slots(), bool(pattern.plane))),
      plane_(pattern.plane),
      velocity_(unknown_velocities(pattern.plane)) {
  for (Aligned<double>* v : {&x_, &c_, &scale_, &diagonal_, &p_, &E_, &r_, &lambda_, &v_})
    v->assign(plan_.size_x + kPad, 0.0);
  A_.assign(plan_.size_A + kPad, 0.0);
  Y_.assign(plan_.size_Y + kPad, 0.0);
  a_.assign((plane_ ? schur::Planar::a : schur::Spatial::a) * pattern.n_slots() + kPad, 0.0);
  for (Aligned<double>* v : {&inverse_, &mass_})
    v->assign((plane_ ? schur::Planar::mass : schur::Spatial::mass) * pattern.n_slots(), 0.0);
  given_.assign(plan_.n_rows + kPad, 0.0);
  kinds_.assign(3 * plan_.size_x + kPad, 0.0);
  for (const schur::Node& node : plan_.nodes)
    for (int k = 0; node.link >= 0 && k < node.m; ++k) {
      const auto kind = static_cast<std::size_t>(node.kinds.of(k));
      order_.push_back({node.first_row + k, node.x + k, kind});
      kinds_[3 * node.x + node.ld() * kind + k] = 1.0;
    }
  z_.A = A_.data(), z_.Y = Y_.data(), z_.x = x_.data(), z_.c = c_.data(), z_.scale = scale_.data();
  z_.diagonal = diagonal_.data(), z_.p = p_.data(), z_.E = E_.data(), z_.r = r_.data(), z_.a = a_.data();
  z_.inverse = inverse_.data(), z_.mass = mass_.data(), z_.kind = kinds_.data(), z_.floors = floors_.data();
  z_.eps = plan_.tree ? 0.0 : kClosureProximal;
  watch_.begin(pattern.m);
  gradients_.size(pattern.m);
  for (std::size_t i = 0; i < a_.size(); ++i) a_[i] = std::cos(1.0 + 2.3 * static_cast<double>(i));
}

/// Completes a report by the detector alone.
class Detector final : public SchurFactorization {
 public:
  using SchurFactorization::SchurFactorization;
  void complete(SolveReport& report) override { report.detector = least_regular(); }
};

std::unique_ptr<Factorization> make_detector(const KktPattern& pattern) { return std::make_unique<Detector>(pattern); }

TypeInfo SchurSolver::info() {
  return {"schur", "Schur complement on the graph of the joints: any topology and size, the default", {}};
}
std::unique_ptr<LinearSolver> SchurSolver::make(const Params&) { return std::make_unique<SchurSolver>(); }

std::unique_ptr<Factorization> SchurSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<SchurFactorization>(pattern);
}

}  // namespace lockstep
