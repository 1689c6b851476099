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

struct SchurSolver::Work {
  schur::Plan plan;
  Plane plane;
  int width = 6;  // velocities of a slot
  int stride_a = 6, stride_inverse = 8;
  int velocity(int k) const { return plane ? plane.velocity(k) : k; }
  schur::Numbers z;
  Aligned<double> A, Y, x, c, scale, diagonal, pivot, E, r, lambda, a, inverse, mass, given;
  std::vector<RowKind> kind;  // of every number of x
  bool masses_known = false;
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

SchurSolver::SchurSolver() : work_(std::make_unique<Work>()) {}
SchurSolver::~SchurSolver() = default;

TypeInfo SchurSolver::info() {
  return {"schur", "Schur complement on the graph of the links: any topology and size, the default", {}};
}
std::unique_ptr<LinearSolver> SchurSolver::make(const Params&) { return std::make_unique<SchurSolver>(); }

// visit(number of the row in the table, its place in x, kind)
template <class Visit>
void SchurSolver::Work::for_each_row(Visit&& visit) const {
  for (const schur::Node& node : plan.nodes)
    if (node.link >= 0)
      for (int k = 0; k < node.m; ++k) {
        const std::size_t at = node.x + static_cast<std::size_t>(k);
        visit(node.first_row + k, at, static_cast<std::size_t>(kind[at]));
      }
}

void SchurSolver::Work::size(const KktPattern& pattern) {
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

void SchurSolver::analyse(const KktPattern& pattern) {
  assert(pattern.rows);  // reads_rows()
  Work& w = *work_;
  w.plan = schur::make_plan(*pattern.rows, pattern.n_slots(), bool(pattern.plane));
  w.plane = pattern.plane;
  w.width = w.plane ? 3 : 6;
  w.stride_a = w.plane ? schur::Planar::a : schur::Spatial::a;
  w.stride_inverse = w.plane ? schur::Planar::inverse : schur::Spatial::inverse;
  w.size(pattern);
  w.masses_known = false;
  w.n_small_usual = pattern.m;
}

void SchurSolver::Work::read_masses(const Kkt& kkt) {
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

void SchurSolver::factor(const Kkt& kkt) {
  Work& w = *work_;
  if (!w.masses_known) w.read_masses(kkt);
  w.z.rows = kkt.pattern.rows->data();
  schur::fill(w.plan, w.z);
  schur::factor(w.plan, w.z);
  if (!w.plan.tree) w.count_small_pivots();
}

void SchurSolver::Work::count_small_pivots() {
  n_small = 0;
  for_each_row([&](int, std::size_t at, std::size_t) { n_small += pivot[at] < kSmallPivot * diagonal[at] ? 1 : 0; });
  n_small_usual = std::min(n_small_usual, n_small);
}

/// Residual of the last solution; the smallest relative pivot, and the smallest beyond the n0 usual ones.
void SchurSolver::complete(SolveReport& report) const {
  Work& w = *work_;
  w.find_worst();
  report.residual = w.worst;
  report.worst_row = w.worst_row;
  w.relative.clear();
  w.for_each_row([&](int, std::size_t at, std::size_t) { w.relative.push_back(w.pivot[at] / w.diagonal[at]); });
  if (w.relative.empty()) return;
  const auto begin = w.relative.begin();
  report.smallest_pivot = *std::min_element(begin, w.relative.end());
  const auto n0 = w.plan.tree ? 0 : w.n_small_usual;
  if (n0 >= static_cast<int>(w.relative.size())) return;
  std::nth_element(begin, begin + n0, w.relative.end());
  report.detector = w.relative[static_cast<std::size_t>(n0)];
}

// a_f = M^-1 f
void SchurSolver::Work::free_motion(const VecX& f) {
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

void SchurSolver::Work::find_worst() {
  worst = 0, worst_row = -1;
  for_each_row([&](int row, std::size_t at, std::size_t k) {
    const double res = std::abs(r[at]), q = res == 0 ? 0.0 : res / std::max(scale[at], z.floors[k]);
    if (worst_row >= 0 && (q <= worst || std::isnan(worst))) return;
    worst = q, worst_row = row;
  });
}

// What rounding of other units can leave in a row that has no scale of its own (see StopRule): by Cauchy and Schwarz
// |J_j a| <= sqrt(S_jj) sqrt(a . M a).
void SchurSolver::Work::raise_floors() {
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

void SchurSolver::Work::unload(const KktPattern& pattern, VecX& a_out, VecX& lambda_out) const {
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

SolveReport SchurSolver::solve(const Kkt& kkt, const VecX& f, const VecX& c, VecX& a, VecX& lambda) {
  Work& w = *work_;
  std::copy(c.data(), c.data() + c.size(), w.given.data());
  w.free_motion(f);
  schur::start(w.plan, w.given.data(), w.z);
  for (const int h : w.plan.hubs) {
    const schur::Node& node = w.plan.nodes[static_cast<std::size_t>(h)];
    for (int i = 0; i < node.m; ++i) w.x[node.x + static_cast<std::size_t>(i)] = -f[6 * node.hub_slot + w.velocity(i)];
  }
  w.largest = {};
  w.for_each_row([&](int, std::size_t at, std::size_t k) { w.largest[k] = std::max(w.largest[k], w.scale[at]); });

  SolveReport report;
  schur::solve(w.plan, w.z);
  schur::apply(w.plan, w.x.data(), w.z);
  std::copy(w.x.begin(), w.x.end(), w.lambda.begin());
  const auto correct = [&] {  // lambda += (S + E)^-1 r
    schur::solve(w.plan, w.z);
    schur::apply(w.plan, w.x.data(), w.z);
    for (std::size_t i = 0; i < w.plan.size_x; ++i) w.lambda[i] += w.x[i];
    ++report.corrections;
  };
  if (w.z.eps > 0) {  // the plain solve leaves r = E lambda: no need to look
    for (std::size_t i = 0; i < w.plan.size_x; ++i) w.x[i] = w.E[i] * w.lambda[i];
    correct();
  }
  if (kkt.rows_moved) {  // the rows of the factor are gone: the caller iterates
    w.unload(kkt.pattern, a, lambda);
    return report;
  }
  for (std::size_t k = 0; k < 3; ++k) w.z.floors[k] = kScaleFloor * w.largest[k];
  bool energy = false;
  const auto finished = [&] {
    schur::residual(w.plan, w.z);
    if (schur::within(w.plan, kRowTolerance, w.z)) return true;
    if (energy) return false;
    w.raise_floors(), energy = true;
    return schur::within(w.plan, kRowTolerance, w.z);
  };
  bool met = finished();
  if (!met) w.find_worst();
  while (!met && report.corrections < kMaxCorrections) {
    w.before = w.worst;
    std::copy(w.r.begin(), w.r.end(), w.x.begin());
    for (const int h : w.plan.hubs)
      for (int i = 0; i < w.width; ++i)
        w.x[w.plan.nodes[static_cast<std::size_t>(h)].x + static_cast<std::size_t>(i)] = 0;
    correct();
    met = finished();
    w.find_worst();
  }
  if (!met) {
    report.residual = w.worst;
    report.worst_row = w.worst_row;
    if (w.plan.tree) w.n_small_usual = 0, w.count_small_pivots();
    // Contradictory rows are dependent always; a small pivot beyond the usual ones tells a singular place, to be
    // passed.
    report.contradictory = w.worst > kContradiction && w.worst > 0.5 * w.before && w.n_small <= w.n_small_usual;
  }
  w.unload(kkt.pattern, a, lambda);
  return report;
}

}  // namespace lockstep
