#include "framework/dynamics/solvers/schur_solver.h"

#include <Eigen/Cholesky>
#include <algorithm>
#include <cassert>
#include <cmath>

#include "framework/dynamics/solvers/schur_passes.h"
#include "framework/dynamics/solvers/stop_rule.h"
#include "framework/foundation/support/error.h"

namespace lockstep {

namespace {

constexpr double kEps = 1e-9;         // proximal term, relative; trees have none
constexpr double kSmallPivot = 1e-6;  // counted as redundant or singular
constexpr std::size_t kPad = 8;       // numbers behind an array that a pack may read beyond its end

}  // namespace

class SchurFactorization final : public Factorization {
 public:
  explicit SchurFactorization(const KktPattern&);
  void compute(const Kkt&) override;
  SolveReport solve(const Kkt&, const VecX& f, const VecX& c, VecX& a, VecX& lambda) override;
  void complete(SolveReport&) override;

 private:
  schur::Plan plan;
  Plane plane;
  int width = 6;  // velocities of a slot
  int stride_a = 6, stride_inverse = 8;
  int velocity(int k) const { return plane ? plane.velocity(k) : k; }
  schur::Numbers z;
  Aligned<double> A, Y, x, c, scale, diagonal, pivot, E, r, lambda, a, inverse, mass, given;
  std::vector<RowKind> kind;  // of every number of x
  bool masses_known = false;
  const RowTable* rows = nullptr;  // that the matrix was computed from, and their revision then
  long revision = -1;
  int n_small = 0, n_small_usual = 0;
  std::array<double, 3> largest{};  // scale by kind

  void size(const KktPattern&);
  void read_masses(const Kkt&);
  void free_motion(const VecX& f);
  void raise_floors();
  double energy_f = 0;    // largest f . M^-1 f of a slot
  Aligned<double> kinds;  // of Numbers::kind
  void count_small_pivots();
  void unload(const KktPattern&, VecX& a_out, VecX& lambda_out) const;
  template <class Visit>
  void for_each_row(Visit&& visit) const;
  void find_worst();
  std::vector<double> relative;  // pivots, when asked
  double worst = 0, before = 0;
  int worst_row = -1;
};

TypeInfo SchurSolver::info() {
  return {"schur", "Schur complement on the graph of the links: any topology and size, the default", {}};
}
std::unique_ptr<LinearSolver> SchurSolver::make(const Params&) { return std::make_unique<SchurSolver>(); }

// visit(number of the row in the table, its place in x, kind)
template <class Visit>
void SchurFactorization::for_each_row(Visit&& visit) const {
  for (const schur::Node& node : plan.nodes)
    if (node.link >= 0)
      for (int k = 0; k < node.m; ++k) {
        const std::size_t at = node.x + static_cast<std::size_t>(k);
        visit(node.first_row + k, at, static_cast<std::size_t>(kind[at]));
      }
}

void SchurFactorization::size(const KktPattern& pattern) {
  for (Aligned<double>* v : {&x, &c, &scale, &diagonal, &pivot, &E, &r, &lambda}) v->assign(plan.size_x + kPad, 0.0);
  A.assign(plan.size_A + kPad, 0.0);
  Y.assign(plan.size_Y + kPad, 0.0);
  const auto n = static_cast<std::size_t>(plan.n_slots);
  a.assign(static_cast<std::size_t>(stride_a) * n + kPad, 0.0);
  inverse.assign(static_cast<std::size_t>(stride_inverse) * n, 0.0);
  mass.assign(10 * n, 0.0);
  given.assign(static_cast<std::size_t>(plan.n_rows) + kPad, 0.0);
  kind.assign(plan.size_x, RowKind::function);
  for (const schur::Node& node : plan.nodes)
    if (node.link >= 0)
      for (int k = 0; k < node.m; ++k)
        kind[node.x + static_cast<std::size_t>(k)] =
            pattern.rows->entries[static_cast<std::size_t>(node.link)].kind[static_cast<std::size_t>(k)];
  kinds.assign(3 * plan.size_x + kPad, 0.0);
  for (const schur::Node& node : plan.nodes)
    for (int k = 0; node.link >= 0 && k < node.m; ++k) {
      const std::size_t at = node.x + static_cast<std::size_t>(k);
      kinds[3 * node.x + static_cast<std::size_t>(node.ld()) * static_cast<std::size_t>(kind[at]) +
            static_cast<std::size_t>(k)] = 1.0;
    }
  z.kind = kinds.data();
  z.A = A.data(), z.Y = Y.data(), z.x = x.data(), z.c = c.data(), z.scale = scale.data();
  z.diagonal = diagonal.data(), z.pivot = pivot.data(), z.E = E.data(), z.r = r.data(), z.a = a.data();
  z.inverse = inverse.data(), z.mass = mass.data();
  z.eps = plan.tree ? 0.0 : kEps;
}

SchurFactorization::SchurFactorization(const KktPattern& pattern) {
  assert(pattern.rows);  // reads_rows()
  plan = schur::make_plan(*pattern.rows, pattern.n_slots(), bool(pattern.plane));
  plane = pattern.plane;
  width = plane ? 3 : 6;
  stride_a = plane ? schur::Planar::a : schur::Spatial::a;
  stride_inverse = plane ? schur::Planar::inverse : schur::Spatial::inverse;
  size(pattern);
  n_small_usual = pattern.m;
}

void SchurFactorization::read_masses(const Kkt& kkt) {
  for (std::size_t k = 0; k < kkt.masses.size(); ++k) {
    const SlotMass& s = kkt.masses[k];
    double *I = inverse.data() + static_cast<std::size_t>(stride_inverse) * k, *M = mass.data() + 10 * k;
    I[0] = 1.0 / s.m;
    M[0] = s.m;
    if (plane) {
      M[1] = s.J(plane.n, plane.n);
      I[1] = s.particle ? 0.0 : 1.0 / M[1];
    } else if (!s.particle) {  // a particle does not turn: J^-1 = 0
      const Mat3 Jinv = s.J.llt().solve(Mat3::Identity());
      I[1] = Jinv(0, 0), I[2] = Jinv(0, 1), I[3] = Jinv(0, 2), I[4] = Jinv(1, 1), I[5] = Jinv(1, 2), I[6] = Jinv(2, 2);
      for (int i = 0; i < 9; ++i) M[1 + i] = s.J(i / 3, i % 3);
    }
  }
  for (const int h : plan.hubs) {  // a hub that is a particle: an inertia so large that it does not turn
    double* M = mass.data() + 10 * plan.nodes[static_cast<std::size_t>(h)].hub_slot;
    for (int i = 0; i < (plane ? 1 : 3); ++i)
      if (M[1 + 4 * i] == 0) M[1 + 4 * i] = 1e30 * M[0];
  }
  masses_known = true;
}

void SchurFactorization::compute(const Kkt& kkt) {
  if (!masses_known) read_masses(kkt);
  rows = kkt.pattern.rows;
  revision = rows->revision();
  z.rows = rows->data();
  schur::fill(plan, z);
  schur::factor(plan, z);
  if (!plan.tree) count_small_pivots();
}

void SchurFactorization::count_small_pivots() {
  n_small = 0;
  for_each_row([&](int, std::size_t at, std::size_t) { n_small += pivot[at] < kSmallPivot * diagonal[at] ? 1 : 0; });
  n_small_usual = std::min(n_small_usual, n_small);
}

/// Residual of the last solution; the smallest relative pivot, and the smallest beyond the n0 usual ones.
void SchurFactorization::complete(SolveReport& report) {
  find_worst();
  report.residual = worst;
  report.worst_row = worst_row;
  relative.clear();
  for_each_row([&](int, std::size_t at, std::size_t) { relative.push_back(pivot[at] / diagonal[at]); });
  if (relative.empty()) return;
  const auto begin = relative.begin();
  report.smallest_pivot = *std::min_element(begin, relative.end());
  const auto n0 = plan.tree ? 0 : n_small_usual;
  if (n0 >= static_cast<int>(relative.size())) return;
  std::nth_element(begin, begin + n0, relative.end());
  report.detector = relative[static_cast<std::size_t>(n0)];
}

// a_f = M^-1 f
void SchurFactorization::free_motion(const VecX& f) {
  energy_f = 0;
  if (plane) {
    const int i = plane.i(), j = plane.j(), n = 3 + plane.n;
    for (int k = 0; k < plan.n_slots; ++k) {
      const double *I = inverse.data() + schur::Planar::inverse * k, *F = f.data() + 6 * k;
      double* out = a.data() + schur::Planar::a * k;
      out[0] = I[0] * F[i], out[1] = I[0] * F[j], out[2] = I[1] * F[n];
      energy_f = std::max(energy_f, out[0] * F[i] + out[1] * F[j] + out[2] * F[n]);
    }
    return;
  }
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *I = inverse.data() + schur::Spatial::inverse * k, *F = f.data() + 6 * k;
    double* out = a.data() + schur::Spatial::a * k;
    out[0] = I[0] * F[0], out[1] = I[0] * F[1], out[2] = I[0] * F[2];
    out[3] = I[1] * F[3] + I[2] * F[4] + I[3] * F[5];
    out[4] = I[2] * F[3] + I[4] * F[4] + I[5] * F[5];
    out[5] = I[3] * F[3] + I[5] * F[4] + I[6] * F[5];
    double e = 0;
    for (int i = 0; i < 6; ++i) e += out[i] * F[i];
    energy_f = std::max(energy_f, e);
  }
}

void SchurFactorization::find_worst() {
  worst = 0, worst_row = -1;
  for_each_row([&](int row, std::size_t at, std::size_t k) {
    const double res = std::abs(r[at]), q = res == 0 ? 0.0 : res / std::max(scale[at], z.floors[k]);
    if (worst_row >= 0 && (q <= worst || std::isnan(worst))) return;
    worst = q, worst_row = row;
  });
}

// What rounding of other units can leave in a row that has no scale of its own (see StopRule): by Cauchy and Schwarz
// |J_j a| <= sqrt(S_jj) sqrt(a . M a).
void SchurFactorization::raise_floors() {
  double most = 0;
  for (int k = 0; k < plan.n_slots; ++k) {
    const double *M = mass.data() + 10 * k, *v = a.data() + stride_a * k;
    if (plane) {
      most = std::max(most, M[0] * (v[0] * v[0] + v[1] * v[1]) + M[1] * v[2] * v[2]);
      continue;
    }
    const double linear = M[0] * (v[0] * v[0] + v[1] * v[1] + v[2] * v[2]);
    double turn = 0;  // w . J w
    for (int i = 0; i < 3; ++i)
      for (int j = 0; j < 3; ++j) turn += v[3 + i] * M[1 + 3 * i + j] * v[3 + j];
    most = std::max(most, linear + turn);
  }
  most += energy_f;
  std::array<double, 3> S{};
  for (const schur::Node& node : plan.nodes)
    for (int k = 0; node.link >= 0 && k < node.m; ++k) {
      const std::size_t at = node.x + static_cast<std::size_t>(k);
      double& largest_S = S[static_cast<std::size_t>(kind[at])];
      largest_S = std::max(largest_S, diagonal[at]);
    }
  for (std::size_t k = 0; k < 3; ++k) z.floors[k] = kScaleFloor * std::max(largest[k], std::sqrt(S[k] * most));
}

void SchurFactorization::unload(const KktPattern& pattern, VecX& a_out, VecX& lambda_out) const {
  a_out.resize(6 * plan.n_slots);
  lambda_out.resize(pattern.m);
  if (plane) {
    a_out.setZero();
    for (int k = 0; k < plan.n_slots; ++k)
      for (int i = 0; i < 3; ++i) a_out[6 * k + velocity(i)] = a[static_cast<std::size_t>(schur::Planar::a * k + i)];
  } else {
    std::copy(a.begin(), a.begin() + a_out.size(), a_out.data());
  }
  for (const schur::Node& node : plan.nodes) {
    if (node.link < 0) continue;
    const double* l = lambda.data() + node.x;
    double* out = lambda_out.data() + node.first_row;
    int k = 0;
    const int n = n_turned(node.layout);
    for (; k < n; ++k) {  // back into the link's axes
      const double* R = z.rows + node.R + static_cast<std::size_t>(k * node.ld());
      out[k] = R[0] * l[0] + R[1] * l[1];
      if (n == 3) out[k] += R[2] * l[2];
    }
    for (; k < node.m; ++k) out[k] = l[k];
  }
}

SolveReport SchurFactorization::solve(const Kkt& kkt, const VecX& f, const VecX& c_in, VecX& a_out, VecX& lambda_out) {
  z.rows = kkt.pattern.rows->data();
  std::copy(c_in.data(), c_in.data() + c_in.size(), given.data());
  free_motion(f);
  schur::start(plan, given.data(), z);
  for (const int h : plan.hubs) {
    const schur::Node& node = plan.nodes[static_cast<std::size_t>(h)];
    for (int i = 0; i < node.m; ++i) x[node.x + static_cast<std::size_t>(i)] = -f[6 * node.hub_slot + velocity(i)];
  }
  largest = {};
  for_each_row([&](int, std::size_t at, std::size_t k) { largest[k] = std::max(largest[k], scale[at]); });

  SolveReport report;
  schur::solve(plan, z);
  schur::apply(plan, x.data(), z);
  std::copy(x.begin(), x.end(), lambda.begin());
  const auto correct = [&] {  // lambda += (S + E)^-1 r
    schur::solve(plan, z);
    schur::apply(plan, x.data(), z);
    for (std::size_t i = 0; i < plan.size_x; ++i) lambda[i] += x[i];
    ++report.corrections;
  };
  if (z.eps > 0) {  // the plain solve leaves r = E lambda: no need to look
    for (std::size_t i = 0; i < plan.size_x; ++i) x[i] = E[i] * lambda[i];
    correct();
  }
  if (kkt.pattern.rows != rows || rows->revision() != revision) {  // the rows of the factor are gone: the caller iterates
    unload(kkt.pattern, a_out, lambda_out);
    return report;
  }
  for (std::size_t k = 0; k < 3; ++k) z.floors[k] = kScaleFloor * largest[k];
  bool energy = false;
  const auto finished = [&] {
    schur::residual(plan, z);
    if (schur::within(plan, kRowTolerance, z)) return true;
    if (energy) return false;
    raise_floors(), energy = true;
    return schur::within(plan, kRowTolerance, z);
  };
  bool met = finished();
  if (!met) find_worst();
  while (!met && report.corrections < kMaxCorrections) {
    before = worst;
    std::copy(r.begin(), r.end(), x.begin());
    for (const int h : plan.hubs)
      for (int i = 0; i < width; ++i)
        x[plan.nodes[static_cast<std::size_t>(h)].x + static_cast<std::size_t>(i)] = 0;
    correct();
    met = finished();
    find_worst();
  }
  if (!met) {
    report.residual = worst;
    report.worst_row = worst_row;
    if (plan.tree) n_small_usual = 0, count_small_pivots();
    // Contradictory rows are dependent always; a small pivot beyond the usual ones tells a singular place, to be
    // passed.
    report.contradictory = worst > kContradiction && worst > 0.5 * before && n_small <= n_small_usual;
  }
  unload(kkt.pattern, a_out, lambda_out);
  return report;
}

std::unique_ptr<Factorization> SchurSolver::analyse(const KktPattern& pattern) const {
  return std::make_unique<SchurFactorization>(pattern);
}

}  // namespace lockstep
