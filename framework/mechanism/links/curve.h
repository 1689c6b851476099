// Links 'point_on_curve' and 'path_follower': P stays on a space curve c(s), fixed to S.
#pragma once

#include <memory>
#include <string>

#include "framework/mechanism/lock/phi_lock.h"
#include "framework/mechanism/params/site.h"

namespace lockstep {

/// A curve c(s) in S axes and the frame in which the present step sees it: the tangent t and two normals n1, n2 at the
/// last accepted s. P lies in the plane normal to t where t . c(s) = t . rho, which gives s(rho) with both derivatives
/// from c, c_s and c_ss alone:
///
///   s_rho = t / (t . c_s)          s_rho,rho = - (t . c_ss) / (t . c_s)^3  t t^T
///   phi_i = n_i . (rho - c(s))
///
/// (7.6) would take s as a massless unknown of its own; this needs none and is exact on and off the path. The normals
/// are carried along the curve from step to step; reactions in axes do not depend on them.
class LOCKSTEP_API CurvePoint {
 public:
  CurvePoint() = default;
  CurvePoint(LawPtr<TranslationLaw> path, double near) : path_(std::move(path)), near_(near) {}
  const LawPtr<TranslationLaw>& path() const { return path_; }

  struct Frame {
    Vec3 t, n1, n2;
  };
  /// From what was remembered.
  Frame frame(const double* memory) const;
  /// The s of the plane normal to t through rho, by Newton's method from `s`; NaN when there is none near.
  double in_plane(const Vec3& t, const Vec3& rho, double s) const;
  /// The s of the point nearest to rho, searched from `s`; NaN when there is none.
  double nearest(const Vec3& rho, double s) const;

  /// s on jets, with the curve at it.
  template <class T>
  T parameter(const LockCoords<T>& y, const Frame& f, TranslationValue& at) const {
    const T tau = f.t[0] * y.x + f.t[1] * y.y + f.t[2] * y.z;
    const double s = in_plane(f.t, Vec3(y.x.v, y.y.v, y.z.v), expected(y));
    at = path_->at(s);
    const double c1 = f.t.dot(at.v);
    return jet_detail::chain(tau, s, 1 / c1, -f.t.dot(at.a) / (c1 * c1 * c1));
  }
  /// phi_i on jets.
  template <class T>
  T offset(const LockCoords<T>& y, const Vec3& n, const T& s, const TranslationValue& at) const {
    return n[0] * y.x + n[1] * y.y + n[2] * y.z - jet_detail::chain(s, n.dot(at.x), n.dot(at.v), n.dot(at.a));
  }

  // -- memory: s, its rate, the instant; n1
  static constexpr int kMemory = 6;
  void initialise(const std::string& link, const LockCoords<Time>& y) const;
  void reset(std::span<double> z, const LockCoords<Time>& y) const;
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const;

 private:
  Vec3 normal(double s, const Vec3& like) const;
  template <class T>
  static double expected(const LockCoords<T>& y) {
    return y.memory[0] + y.memory[1] * (y.t.v - y.memory[2]);
  }
  LawPtr<TranslationLaw> path_;
  double near_ = 0;
};

/// phi_1, phi_2: distances of P from the curve along its two normals, m.
struct OnCurve {
  CurvePoint curve;
  static constexpr int kRows = 2;
  static constexpr Reads kReads = Reads::translation;
  static constexpr RowKind kKind = RowKind::translation;
  static constexpr int kMemory = CurvePoint::kMemory;
  static constexpr std::array<const char*, 2> kNames = {"normal1", "normal2"};

  template <class T>
  std::array<T, 2> operator()(const LockCoords<T>& y) const {
    const CurvePoint::Frame f = curve.frame(y.memory);
    TranslationValue at;
    const T s = curve.parameter(y, f, at);
    return {curve.offset(y, f.n1, s, at), curve.offset(y, f.n2, s, at)};
  }
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

/// The same, and the axes of P turned with the path: e = q(s)' r, three rows vec(e) = 0.
struct OnPath {
  CurvePoint curve;
  LawPtr<RotationLaw> turn;
  static constexpr int kRows = 5;
  static constexpr Reads kReads = Reads::both;
  static constexpr RowKind kKind = RowKind::function;
  static constexpr int kMemory = CurvePoint::kMemory;
  static constexpr std::array<const char*, 5> kNames = {"normal1", "normal2", "turn1", "turn2", "turn3"};

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
  void initialise(const std::string& link, const LockCoords<Time>& y) const { curve.initialise(link, y); }
  void reset(std::span<double> z, const LockCoords<Time>& y) const { curve.reset(z, y); }
  void accept_step(std::span<double> z, const LockCoords<Time>& y) const { curve.accept_step(z, y); }
};

/// Free: moving along the curve, all turns. A closed curve is a law that repeats.
class LOCKSTEP_API PointOnCurve final : public PhiLock<OnCurve>, public Observable {
 public:
  /// `path`: c(s) in S axes, m, of any parameter s on which it moves without a halt; `near`: an s near which P begins.
  PointOnCurve(std::string name, Marker& p, Marker& s, LawPtr<TranslationLaw> path, double near = 0);
  std::string_view type() const override { return "point_on_curve"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< s, rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

/// Free: moving along the curve. The axes of P are those of S turned by q(s).
class LOCKSTEP_API PathFollower final : public PhiLock<OnPath>, public Observable {
 public:
  struct Options {
    LawPtr<TranslationLaw> path;  ///< c(s) in S axes, m, of any parameter s on which it moves without a halt
    LawPtr<RotationLaw> turn;     ///< q(s) in S axes
    double near = 0;              ///< an s near which P begins
  };
  /// Throws ModelError: a path or a turn that is missing.
  PathFollower(std::string name, Marker& p, Marker& s, Options options);
  std::string_view type() const override { return "path_follower"; }
  const Observable* observable() const override { return this; }
  std::vector<Quantity> quantities() const override;  ///< s, rate
  double quantity(int k, const Inputs&) const override;
  static TypeInfo info();
  static std::unique_ptr<Lock> make(const Site&, const Params&);
};

}  // namespace lockstep
