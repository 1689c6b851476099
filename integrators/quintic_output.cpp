// SPDX-License-Identifier: BSD-3-Clause
#include <lockstep/integrators.h>

#include <array>

namespace lockstep {

namespace {

using HermiteWeights = std::array<double, 6>;  // of p, h p', h^2 p'' at the beginning, then at the end

HermiteWeights values(double x) {
  const double x2 = x * x, x3 = x2 * x, x4 = x3 * x, x5 = x4 * x;
  return {1 - 10 * x3 + 15 * x4 - 6 * x5, x - 6 * x3 + 8 * x4 - 3 * x5, 0.5 * (x2 - 3 * x3 + 3 * x4 - x5),
          10 * x3 - 15 * x4 + 6 * x5,     -4 * x3 + 7 * x4 - 3 * x5,    0.5 * (x3 - 2 * x4 + x5)};
}

HermiteWeights slopes(double x) {
  const double x2 = x * x, x3 = x2 * x, x4 = x3 * x;
  return {-30 * x2 + 60 * x3 - 30 * x4, 1 - 18 * x2 + 32 * x3 - 15 * x4, x - 4.5 * x2 + 6 * x3 - 2.5 * x4,
          30 * x2 - 60 * x3 + 30 * x4,  -12 * x2 + 28 * x3 - 15 * x4,    1.5 * x2 - 4 * x3 + 2.5 * x4};
}

// Value, first and second derivative at one end, of 3 or 4 numbers each.
template <class V>
struct End {
  V p, d, dd;
};
template <class V>
V blend(const HermiteWeights& w, double h, const End<V>& a, const End<V>& b) {
  return w[0] * a.p + (w[1] * h) * a.d + (w[2] * h * h) * a.dd + w[3] * b.p + (w[4] * h) * b.d + (w[5] * h * h) * b.dd;
}

End<Vec3> place_of(const State& y, const VecX& vd, Eigen::Index k) {
  return {y.q.segment<3>(7 * k), y.v.segment<3>(6 * k), vd.segment<3>(6 * k)};
}

// (1.8), (1.9)
End<Vec4> turn_of(const State& y, const VecX& vd, Eigen::Index k) {
  const Quat e = Quat::from(y.q.segment<4>(7 * k + 3));
  const Vec3 w = y.v.segment<3>(6 * k + 3), al = vd.segment<3>(6 * k + 3);
  return {e.coefficients(), rate(e, w).coefficients(), second_rate(e, w, al).coefficients()};
}

}  // namespace

void QuinticOutput::begin(const State& y) {
  a_ = b_ = y;
  vd_a_ = vd_b_ = VecX::Zero(y.v.size());
  sd_a_ = sd_b_ = VecX::Zero(y.s.size());
  h_ = 0;
}

void QuinticOutput::set(const State& a, const VecX& vd_a, const VecX& sd_a, const State& b, const VecX& vd_b,
                        const VecX& sd_b) {
  a_ = a, b_ = b;
  vd_a_ = vd_a, vd_b_ = vd_b;
  sd_a_ = sd_a, sd_b_ = sd_b;
  h_ = b.t - a.t;
}

bool QuinticOutput::at(double t, State& out) const {
  if (a_.q.size() == 0) return false;
  out = a_;
  if (h_ == 0) return t == a_.t;
  const double x = (t - a_.t) / h_;
  const HermiteWeights w = values(x), d = slopes(x);
  for (Eigen::Index k = 0; 6 * k < a_.v.size(); ++k) {
    const End<Vec3> xa = place_of(a_, vd_a_, k), xb = place_of(b_, vd_b_, k);
    out.q.segment<3>(7 * k) = blend(w, h_, xa, xb);
    out.v.segment<3>(6 * k) = blend(d, h_, xa, xb) / h_;
    const End<Vec4> ea = turn_of(a_, vd_a_, k), eb = turn_of(b_, vd_b_, k);
    const Vec4 e = blend(w, h_, ea, eb), ed = blend(d, h_, ea, eb) / h_;
    out.q.segment<4>(7 * k + 3) = e.normalized();  // w = 2 vec(conj(e) e')/|e|^2, however |e| varies
    out.v.segment<3>(6 * k + 3) = 2 / e.squaredNorm() * (conjugate(Quat::from(e)) * Quat::from(ed)).vec();
  }
  const double x2 = x * x, x3 = x2 * x;
  out.s = (1 - 3 * x2 + 2 * x3) * a_.s + (h_ * (x - 2 * x2 + x3)) * sd_a_ + (3 * x2 - 2 * x3) * b_.s +
          (h_ * (x3 - x2)) * sd_b_;
  out.t = t;
  return true;
}

}  // namespace lockstep
