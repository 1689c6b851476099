// SPDX-License-Identifier: BSD-3-Clause
// Functions of points and bodies on a space curve.
#pragma once

#include <array>
#include <span>
#include <string>
#include <utility>

#include <lockstep/author/phi.h>

namespace lockstep {

/// A curve c(s) in S axes, seen during a step from a fixed frame: the tangent t and two normals n1, n2 at the last
/// accepted s. The s of a position rho is that where t . c(s) = t . rho. Its first and second derivatives follow from
/// c, c_s and c_ss alone:
///
///   s_rho = t / (t . c_s)          s_rho,rho = - (t . c_ss) / (t . c_s)^3  t t^T
///   phi_i = n_i . (rho - c(s))
///
/// (7.6) takes s as an additional massless unknown; this needs none, and is exact on and off the path. The normals are
/// carried along the curve from step to step; the force and the moment on a body do not depend on them.
class CurvePoint {
 public:
  CurvePoint() = default;
  /// `path`: c(s), S axes, m; `near`: an s near which P begins.
  CurvePoint(LawPtr<TranslationLaw> path, double near) : path_(std::move(path)), near_(near) {}
  const LawPtr<TranslationLaw>& path() const { return path_; }  ///< the curve

  /// Three unit vectors, normal to each other, in S axes.
  struct Frame {
    Vec3 t,  ///< tangent
        n1,  ///< first normal
        n2;  ///< second normal
  };
  /// The frame of the present step, from the memory.
  Frame frame(const double* memory) const;
  /// The s where t . c(s) = t . rho, by Newton's method from `s`; NaN: it finds none.
  double in_plane(const Vec3& t, const Vec3& rho, double s) const;
  /// The s of the point of the curve nearest to rho, searched from `s`; NaN: it finds none.
  double nearest(const Vec3& rho, double s) const;

  /// s of the position y, with its derivatives; puts the curve there into `at`.
  template <class T>
  T parameter(const LockCoords<T>& y, const Frame& f, TranslationValue& at) const {
    const T tau = f.t[0] * y.x + f.t[1] * y.y + f.t[2] * y.z;
    const double s = in_plane(f.t, Vec3(y.x.v, y.y.v, y.z.v), expected(y));
    at = path_->at(s);
    const double c1 = f.t.dot(at.v);
    return jet_detail::chain(tau, s, 1 / c1, -f.t.dot(at.a) / (c1 * c1 * c1));
  }
  /// phi_i of the normal n, m, with its derivatives.
  template <class T>
  T offset(const LockCoords<T>& y, const Vec3& n, const T& s, const TranslationValue& at) const {
    return n[0] * y.x + n[1] * y.y + n[2] * y.z - jet_detail::chain(s, n.dot(at.x), n.dot(at.v), n.dot(at.a));
  }

  // -- memory
  static constexpr int kMemory = 6;  ///< s, its rate, the instant; n1
  /// Throws ModelError, naming `link`: a search from `near` finds no point of the curve nearest to P.
  void initialise(const std::string& link, const LockCoords<Time>& y) const;
  void reset(std::span<double> z, const LockCoords<Time>& y) const;        ///< from the nearest point at the start
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;  ///< from the nearest point now

 private:
  Vec3 normal(double s, const Vec3& like) const;
  template <class T>
  static double expected(const LockCoords<T>& y) {
    return y.memory[0] + y.memory[1] * (y.t.v - y.memory[2]);
  }
  LawPtr<TranslationLaw> path_;
  double near_ = 0;
};

/// What OnCurve and OnPath have in common.
struct CurveFunction : PhiHooks {
  CurvePoint curve;                                                ///< the curve
  explicit CurveFunction(CurvePoint on) : curve(std::move(on)) {}  ///< on this curve
  void initialise(const std::string& link, PhiCoords y) override { curve.initialise(link, y[0]); }
  void reset(std::span<double> z, PhiCoords y) const override { curve.reset(z, y[0]); }
  void accept_step(std::span<double> z, PhiCoords y) const override { curve.accept_step(z, y[0]); }
};

/// phi_1, phi_2: distances of P from the curve along its two normals, m.
struct OnCurve final : CurveFunction {
  using CurveFunction::CurveFunction;
  static constexpr PhiSpec spec{.rows = 2,
                                .reads = Reads::translation,
                                .kind = RowKind::translation,
                                .memory = CurvePoint::kMemory,
                                .names = {"normal1", "normal2"}};

  /// phi_1, phi_2.
  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at)};
  }
};

/// phi_1, phi_2 as in OnCurve, then vec(e) with e = q(s)' r: the axes of P turn with the path.
struct OnPath final : CurveFunction {
  LawPtr<RotationLaw> turn;  ///< q(s), axes of P -> axes of S
  OnPath(CurvePoint on, LawPtr<RotationLaw> by) : CurveFunction(std::move(on)), turn(std::move(by)) {}  ///< of these
  static constexpr PhiSpec spec{
      .rows = 5, .memory = CurvePoint::kMemory, .names = {"normal1", "normal2", "turn1", "turn2", "turn3"}};

  /// phi_1, phi_2, m; vec(e).
  template <class T>
  std::array<T, 5> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    // q' = (1/2) q w,  q'' = (1/2) q (a - |w|^2/2)   (1.9)
    const RotationValue q = turn->at(s.v);
    const Vec4 q0 = q.q.coefficients(), q1 = rate(q.q, q.w).coefficients(),
               q2 = rate(q.q, q.a).coefficients() - 0.25 * q.w.squaredNorm() * q0;
    const auto c = [&](int k) { return jet_detail::chain(s, q0[k], q1[k], q2[k]); };
    const T a = c(0), bx = c(1), by = c(2), bz = c(3);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at),
            a * y.e1 - bx * y.e0 - by * y.e3 + bz * y.e2,  // vec( (a, -b) (e0, e1 e2 e3) )
            a * y.e2 - by * y.e0 - bz * y.e1 + bx * y.e3, a * y.e3 - bz * y.e0 - bx * y.e2 + by * y.e1};
  }
};

}  // namespace lockstep
