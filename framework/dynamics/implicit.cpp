#include "framework/dynamics/implicit.h"

#include <Eigen/Cholesky>
#include <Eigen/LU>
#include <algorithm>
#include <cmath>

#include "framework/support/error.h"

namespace lockstep {
namespace {

constexpr double kProximal = 1e-8;  // eps, of the row's scale (numerics page, sections 4, 5)
constexpr int kCorrections = 3;

template <class T>
using Vec = Eigen::Matrix<T, Eigen::Dynamic, 1>;
template <class T>
using Mat = Eigen::Matrix<T, Eigen::Dynamic, Eigen::Dynamic>;

}  // namespace

struct NewtonMatrix::Work {
  // what was gathered
  const System* system = nullptr;
  TangentSum tangents;
  long description = -1, pattern = -1;  // revisions of the system and of the tangents that were laid out
  std::vector<int> width, first;        // of each slot: unknowns and the first of them
  std::vector<RowEntry> entries;        // as laid out
  std::vector<double> J;                // 6 a slot and row, entry after entry
  VecX s;                               // scale of each row, for the proximal term
  int n = 0, m = 0;

  /// One factor and the matrix that it is the factor of.
  template <class T>
  struct Factor {
    Mat<T> A;  // without the proximal term
    Eigen::PartialPivLU<Mat<T>> lu;
    Vec<T> b, x, d, residual;
    VecX size;  // of the terms of each row
  };
  Factor<double> real;
  Factor<Complex> complex;

  bool same_links(const RowTable& rows) const;
  void lay_out(const RowTable& rows);
  void copy_rows(const RowTable& rows);
  void add_inertia(const Inputs& in);
  void update_scales();
  template <class Visit>
  void for_each_row(Visit&& visit) const;
  template <class T>
  void assemble(T a, T b, T c, Factor<T>& half) const;
  template <class T>
  void factor(T a, T b, T c, Factor<T>& half) const;
  template <class T>
  SolveReport solve(Factor<T>& half, const Vec<T>& f, const Vec<T>& r, Vec<T>& x, Vec<T>& l) const;
  template <class T>
  double largest_row_residual(const Factor<T>& half, SolveReport& report) const;
};

bool NewtonMatrix::Work::same_links(const RowTable& rows) const {
  return std::equal(entries.begin(), entries.end(), rows.entries.begin(), rows.entries.end(),
                    [](const RowEntry& a, const RowEntry& b) { return a.link == b.link && a.m == b.m; });
}

void NewtonMatrix::Work::lay_out(const RowTable& rows) {
  width.clear(), first.clear();
  n = 0;
  for (int k = 0; k < system->n_slots(); ++k) {
    width.push_back(system->body_of_slot(k).freedoms == Freedoms::particle ? 3 : 6);
    first.push_back(n);
    n += width.back();
  }
  entries = rows.entries;
  m = rows.n_rows;
  std::size_t size = 0;
  for (const RowEntry& e : entries) size += static_cast<std::size_t>(6 * e.m * e.slots.n);
  J.assign(size, 0.0);
  s.setZero(m);
}

// visit(row, slot, its six numbers)
template <class Visit>
void NewtonMatrix::Work::for_each_row(Visit&& visit) const {
  const double* r = J.data();
  for (const RowEntry& e : entries)
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k, r += 6) visit(e.first_row + k, e.slots[i], r);
}

void NewtonMatrix::Work::copy_rows(const RowTable& rows) {
  double* out = J.data();
  for (const RowEntry& e : rows.entries) {
    const RowBlock block = rows.block(e);
    for (int i = 0; i < e.slots.n; ++i)
      for (int k = 0; k < e.m; ++k, out += 6) {
        const auto r = block.J(i, k);
        std::copy(&r[0], &r[0] + 6, out);
      }
  }
}

// (9.16) d(w x J w)/dw = w~ J - (J w)~
void NewtonMatrix::Work::add_inertia(const Inputs& in) {
  for (int k = 0; k < system->n_slots(); ++k) {
    Mat3 D = Mat3::Zero();
    if (width[static_cast<std::size_t>(k)] == 6) {
      const Mat3& inertia = system->body_of_slot(k).mass.J;
      const Vec3& w = in.slot(k).w;
      D = skew(w) * inertia - skew(Vec3(inertia * w));
    }
    tangents.add_D(k, Half::turn, k, Half::turn, D);
  }
}

// As Kkt::update_scales(): the mean of the diagonal of J M^-1 J^T over the link's rows of one kind.
void NewtonMatrix::Work::update_scales() {
  s.setZero();
  for_each_row([&](int row, int slot, const double* r) {
    const auto& body = system->body_of_slot(slot).mass;
    const Eigen::Map<const Vec3> v(r), w(r + 3);
    s[row] += v.squaredNorm() / body.mass;
    if (width[static_cast<std::size_t>(slot)] == 6) s[row] += w.dot(body.J.llt().solve(Vec3(w)));
  });
  for (const RowEntry& e : entries)
    for (const RowKind kind : {RowKind::translation, RowKind::rotation}) {
      double sum = 0;
      int rows = 0;
      for (int k = 0; k < e.m; ++k)
        if (e.kind[static_cast<std::size_t>(k)] == kind) sum += s[e.first_row + k], ++rows;
      for (int k = 0; k < e.m; ++k)
        if (e.kind[static_cast<std::size_t>(k)] == kind) s[e.first_row + k] = sum / rows;
    }
  for (double& x : s)
    if (!(x > 0)) x = 1;
}

template <class T>
void NewtonMatrix::Work::assemble(T a, T b, T c, Factor<T>& half) const {
  half.A.setZero(n + m, n + m);
  for (int k = 0; k < system->n_slots(); ++k) {
    const auto& body = system->body_of_slot(k).mass;
    const int at = first[static_cast<std::size_t>(k)];
    half.A.diagonal().segment(at, 3).array() += a * body.mass;
    if (width[static_cast<std::size_t>(k)] == 6) half.A.template block<3, 3>(at + 3, at + 3) += a * body.J;
  }
  for (std::size_t p = 0; p < tangents.pairs().size(); ++p) {
    const auto row = static_cast<std::size_t>(tangents.pairs()[p].row),
               column = static_cast<std::size_t>(tangents.pairs()[p].column);
    const int wr = width[row], wc = width[column];
    half.A.block(first[row], first[column], wr, wc) +=
        b * tangents.D(p).topLeftCorner(wr, wc) + c * tangents.K(p).topLeftCorner(wr, wc);
  }
  for_each_row([&](int row, int slot, const double* r) {
    const auto k = static_cast<std::size_t>(slot);
    for (int j = 0; j < width[k]; ++j) half.A(n + row, first[k] + j) = half.A(first[k] + j, n + row) = r[j];
  });
}

template <class T>
void NewtonMatrix::Work::factor(T a, T b, T c, Factor<T>& half) const {
  assemble(a, b, c, half);
  // The Schur complement of the rows is s/a where the mass rules; so is the proximal term.
  const double size = std::abs(a) > 0 ? std::abs(a) : 1.0;
  Mat<T> with_E = half.A;
  with_E.diagonal().tail(m) -= (kProximal / size * s).template cast<T>();
  half.lu.compute(with_E);
  if (n + m > 0 && !half.lu.matrixLU().diagonal().allFinite())
    throw SolveError("the matrix of the implicit step is not finite; make the step smaller");
}

/// |r - J x| against the row's own terms; a row without terms is measured by the largest of its kind.
template <class T>
double NewtonMatrix::Work::largest_row_residual(const Factor<T>& half, SolveReport& report) const {
  double largest_size[3] = {0, 0, 0}, worst = 0;
  for (const RowEntry& e : entries)
    for (int k = 0; k < e.m; ++k) {
      double& size = largest_size[static_cast<int>(e.kind[static_cast<std::size_t>(k)])];
      size = std::max(size, half.size[e.first_row + k]);
    }
  for (const RowEntry& e : entries)
    for (int k = 0; k < e.m; ++k) {
      const int row = e.first_row + k;
      const double scale =
          std::max(half.size[row], 1e-3 * largest_size[static_cast<int>(e.kind[static_cast<std::size_t>(k)])]);
      const double x = scale > 0 ? std::abs(half.residual[n + row]) / scale : 0.0;
      if (x > worst || std::isnan(x)) worst = x, report.worst_row = row;
    }
  return worst;
}

template <class T>
SolveReport NewtonMatrix::Work::solve(Factor<T>& half, const Vec<T>& f, const Vec<T>& r, Vec<T>& x, Vec<T>& l) const {
  SolveReport report;
  half.b.resize(n + m);
  for (std::size_t k = 0; k < width.size(); ++k)
    half.b.segment(first[k], width[k]) = f.segment(6 * static_cast<int>(k), width[k]);
  half.b.tail(m) = r;
  half.x.setZero(n + m);
  half.residual = half.b;
  double before = std::numeric_limits<double>::infinity();
  for (int round = 0;; ++round) {
    half.d = half.lu.solve(half.residual);
    half.x += half.d;
    half.residual = half.b - half.A * half.x;
    half.size = half.b.tail(m).cwiseAbs() + half.A.bottomLeftCorner(m, n).cwiseAbs() * half.x.head(n).cwiseAbs();
    report.residual = largest_row_residual(half, report);
    report.corrections = round;
    const bool stalled = report.residual > 0.5 * before;
    if (report.residual <= 1e-12 || round == kCorrections || stalled) break;
    before = report.residual;
  }
  report.contradictory = report.residual > 1e-2;
  x.setZero(6 * static_cast<int>(width.size()));
  for (std::size_t k = 0; k < width.size(); ++k)
    x.segment(6 * static_cast<int>(k), width[k]) = half.x.segment(first[k], width[k]);
  l = half.x.tail(m);
  return report;
}

NewtonMatrix::NewtonMatrix() : work_(std::make_unique<Work>()) {}
NewtonMatrix::~NewtonMatrix() = default;

void NewtonMatrix::gather(const Dynamics& dynamics, const VecX& lambda) {
  Work& w = *work_;
  const System& system = dynamics.system();
  const RowTable& rows = dynamics.rows();
  if (w.system != &system || w.description != system.revision() || !w.same_links(rows)) {
    w.system = &system;
    w.description = system.revision();
    w.tangents.lay_out(system.n_slots());
    w.lay_out(rows);
  }
  w.copy_rows(rows);
  w.update_scales();
  w.tangents.clear();
  const Inputs& in = dynamics.inputs();
  w.add_inertia(in);
  for (const RowEntry& e : rows.entries)
    system.links()[static_cast<std::size_t>(e.link)]->tangent(
        in, {lambda.data() + e.first_row, static_cast<std::size_t>(e.m)}, w.tangents);
  for (const auto& force : system.forces()) force->tangent(in, w.tangents);
  w.pattern = w.tangents.revision();
}

void NewtonMatrix::factor(double a, double b, double c) { work_->factor(a, b, c, work_->real); }
void NewtonMatrix::factor(Complex a, Complex b, Complex c) { work_->factor(a, b, c, work_->complex); }
SolveReport NewtonMatrix::solve(const VecX& f, const VecX& r, VecX& x, VecX& l) {
  return work_->solve(work_->real, f, r, x, l);
}
SolveReport NewtonMatrix::solve(const VecXc& f, const VecXc& r, VecXc& x, VecXc& l) {
  return work_->solve(work_->complex, f, r, x, l);
}

void NewtonMatrix::add_M_times(const VecX& x, VecX& y) const {
  for (int k = 0; k < work_->system->n_slots(); ++k) {
    const auto& body = work_->system->body_of_slot(k).mass;
    y.segment<3>(6 * k) += body.mass * x.segment<3>(6 * k);
    if (work_->width[static_cast<std::size_t>(k)] == 6) y.segment<3>(6 * k + 3) += body.J * x.segment<3>(6 * k + 3);
  }
}
void NewtonMatrix::add_D_times(const VecX& x, VecX& y) const {
  const TangentSum& sum = work_->tangents;
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    y.segment<6>(6 * sum.pairs()[p].row) += sum.D(p) * x.segment<6>(6 * sum.pairs()[p].column);
}
void NewtonMatrix::add_K_times(const VecX& x, VecX& y) const {
  const TangentSum& sum = work_->tangents;
  for (std::size_t p = 0; p < sum.pairs().size(); ++p)
    y.segment<6>(6 * sum.pairs()[p].row) += sum.K(p) * x.segment<6>(6 * sum.pairs()[p].column);
}
void NewtonMatrix::add_J_times(const VecX& x, VecX& y) const {
  work_->for_each_row(
      [&](int row, int slot, const double* r) { y[row] += Eigen::Map<const Vec6>(r).dot(x.segment<6>(6 * slot)); });
}
void NewtonMatrix::add_Jt_times(const VecX& l, VecX& y) const {
  work_->for_each_row(
      [&](int row, int slot, const double* r) { y.segment<6>(6 * slot) += l[row] * Eigen::Map<const Vec6>(r); });
}
const TangentSum& NewtonMatrix::tangents() const { return work_->tangents; }

}  // namespace lockstep
